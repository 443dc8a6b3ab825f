"""The smoothing spline whose smoothness the samples themselves ask for: greatest restricted likelihood."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded, solve_banded
from scipy.optimize import minimize_scalar
from scipy.sparse import csr_array, diags_array

from puma_septic.logs._spline import DEGREE, banded, knots_on, merged_columns
from puma_septic.validation import Array

__all__ = ["Smoothed", "even_knots", "smooth_joint"]

# Knots that an arm's motion needs: a hundred in a second carry what moves at up to some 30 Hz; and 200 in all.
_KNOTS_PER_SECOND: Final = 100.0
_LEAST_KNOTS: Final = 200
_MOST_KNOTS: Final = 10_000
# Decades of the ratio of penalty to data that are searched.
_SEARCHED: Final = (-10.0, 14.0)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Smoothed:
    """A smoothed joint: B-spline coefficients, noise, and what the noise leaves unknown of the coefficients.

    Attributes
    ----------
    coefficients : ndarray, shape (p,)
    noise : float
        Standard deviation of a sample of weight 1, rad.
    factor : ndarray, shape (6, p')
        Upper banded Cholesky factor of the precision of the free coefficients over ``noise**-2``.
    merged : ndarray of int, shape (p,)
        Which free coefficient each coefficient is: the first (last) two are one where the joint comes to rest,
        three where its acceleration is zero there as well.
    """

    coefficients: Array
    noise: float
    factor: Array
    merged: NDArray[np.int64]

    def draws(self, count: int, rng: np.random.Generator) -> Array:
        """Deviations of the coefficients that the samples do not rule out, shape (p, count)."""
        z = rng.standard_normal((self.factor.shape[1], count))
        free = solve_banded((0, len(self.factor) - 1), self.factor, z)
        return np.asarray(self.noise * free[self.merged])


def even_knots(t: Array) -> Array:
    """The knots of the smoothing spline, ends repeated: even in time, at most one for two samples."""
    wanted = max(_LEAST_KNOTS, int(np.ceil(_KNOTS_PER_SECOND * (t[-1] - t[0]))))
    breaks = np.linspace(t[0], t[-1], max(1, min(wanted, _MOST_KNOTS, len(t) // 2)) + 1)
    return knots_on(breaks)


def smooth_joint(t: Array, q: Array, knots: Array, *, weights: Array, rest: tuple[int, int] = (0, 0)) -> Smoothed:
    r"""The penalised quintic spline of greatest restricted likelihood through one joint's samples.

    Minimises ``S = sum w (q - s(t))^2 + lambda sum j^2 dt`` over the B-spline coefficients of s, with j those of its
    jerk (a P-spline: Eilers and Marx, Statistical Science 11, 1996), where lambda makes the restricted likelihood
    greatest, that is ``(n - d) log S + log|G + lambda P| - (p - d) log lambda`` least (Wahba, Annals of Statistics 13,
    1985; it undersmooths less often than cross validation: Reiss and Ogden, J. R. Statist. Soc. B 71, 2009).

    Parameters
    ----------
    weights : ndarray, shape (n,)
        Of the samples, 1 for a plain one.
    rest : tuple of int
        Derivatives, from the first, that are zero at the start and at the end.
    """
    p = len(knots) - DEGREE - 1
    merged = merged_columns(p, rest)
    basis = BSpline.design_matrix(t, knots, DEGREE) @ csr_array((np.ones(p), (np.arange(p), merged)))
    size = basis.shape[1]
    jerk = _jerk(knots, merged)
    gram, penalty = banded(basis.T @ diags_array(weights) @ basis), banded(jerk.T @ jerk)
    offset = q[0]
    right = basis.T @ (weights * (q - offset))
    null = max(1, 3 - sum(rest))
    scale = gram[-1].mean() / penalty[-1].mean()

    def solved(decade: float) -> tuple[float, Array, Array, float]:
        ratio = scale * 10.0**decade
        try:
            factor = cholesky_banded(gram + ratio * penalty)
        except LinAlgError:
            return np.inf, right, gram, np.inf
        c = cho_solve_banded((factor, False), right)
        left = weights @ (q - offset - basis @ c) ** 2 + ratio * ((jerk @ c) ** 2).sum()
        left = max(left, np.finfo(float).tiny)
        determinant = 2 * np.log(factor[-1]).sum()
        criterion = (len(t) - null) * np.log(left) + determinant - (size - null) * np.log(ratio)
        return criterion, c, factor, left

    # The likelihood may have more than one hill.
    decades = np.arange(*_SEARCHED)
    near = decades[np.argmin([solved(decade)[0] for decade in decades])]
    best = minimize_scalar(lambda decade: solved(decade)[0], bounds=(near - 1, near + 1), method="bounded").x
    _, c, factor, left = solved(best)
    noise = float(np.sqrt(left / (len(t) - null)))
    return Smoothed(coefficients=c[merged] + offset, noise=noise, factor=factor, merged=merged)


def _jerk(knots: Array, merged: NDArray[np.int64]) -> csr_array:
    """The B-spline coefficients of the jerk, each times the root of its share of time, of the free coefficients."""
    p = len(merged)
    matrix = csr_array((np.ones(p), (np.arange(p), merged)))
    for order in range(3):
        degree = DEGREE - order
        inner = knots[order : len(knots) - order]
        rows = matrix.shape[0] - 1
        spans = inner[1 + degree : 1 + degree + rows] - inner[1 : 1 + rows]
        matrix = diags_array([-degree / spans, degree / spans], offsets=[0, 1], shape=(rows, rows + 1)) @ matrix
    inner = knots[3 : len(knots) - 3]
    shares = (inner[DEGREE - 2 :][: matrix.shape[0]] - inner[: matrix.shape[0]]) / (DEGREE - 2)
    return (diags_array(np.sqrt(shares)) @ matrix).tocsr()
