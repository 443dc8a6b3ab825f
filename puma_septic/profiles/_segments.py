"""Polynomials of given degrees, joined smoothly, from linear conditions on their values."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise, matrices
from puma_septic.validation import Array, read_only

__all__ = [
    "ALLOWED_DOUBT",
    "Condition",
    "at_ends",
    "ill_conditioned",
    "refined",
    "solve_segments",
    "through",
]

_EPS = np.finfo(np.float64).eps
# Largest uncertainty of a position, relative to the movement, with which a polynomial is made.
ALLOWED_DOUBT = 1e-9
# A first correction of this part leaves, after it, nothing to correct.
_CONVERGED = 1e-11
_REFINEMENTS = 10
_CHUNK = 2048


class Condition(NamedTuple):
    """A derivative takes the given rows, shape (k, n_joints), at the given times, shape (k,)."""

    times: Array
    order: int
    values: Array


class _Equations(NamedTuple):
    """One equation a row: factors (N, 2 (degree + 1)) of the coefficients of segment `first` and of the next one."""

    first: NDArray[np.int64]
    factors: NDArray[np.longdouble]

    def times(self, coefficients: Array) -> NDArray[np.longdouble]:
        """The left-hand sides for coefficients (n (degree + 1), m)."""
        width = self.factors.shape[1]
        padded = np.concatenate([coefficients, np.zeros_like(coefficients[: width // 2])])
        columns = (width // 2) * self.first[:, None] + np.arange(width)
        total = np.empty((len(columns), coefficients.shape[1]), dtype=np.longdouble)
        # In chunks: what is gathered at once would be larger than all coefficients.
        for start in range(0, len(columns), _CHUNK):
            rows = slice(start, start + _CHUNK)
            np.einsum("rk,rkm->rm", self.factors[rows], padded[columns[rows]], out=total[rows])
        return total


def through(times: Array, points: Array, order: int = 0) -> list[Condition]:
    """Conditions that a derivative (by default the position) takes the given rows at the given times."""
    return [Condition(times, order, points)]


def at_ends(times: Array, order: int, start: Array, end: Array) -> list[Condition]:
    """Conditions on one derivative at the first and the last time."""
    return [Condition(times[[0, -1]], order, np.stack([start, end]))]


def solve_segments(
    breaks: Array, degrees: Sequence[int], continuity: int, conditions: Sequence[Condition]
) -> Piecewise:
    """The piecewise polynomial of these degrees that meets all conditions.

    At each interior break all derivatives up to order `continuity` are continuous. With the conditions this must give
    as many equations as there are coefficients, ``sum(degrees) + len(degrees)``; the first condition is that of the
    points. The unknowns are Chebyshev coefficients of each segment's own normalised time and every equation is scaled
    to size one, so that neither the unit of time nor uneven segments spoil the digits. Positions are taken relative to
    the first one: the coefficients of a joint that does not move come out exactly zero. In the order of their times the
    equations form a band, so that time and memory grow with the number of segments.

    Parameters
    ----------
    breaks : ndarray, shape (n + 1,)
    degrees : sequence of int, length n
    continuity : int
    conditions : sequence of Condition
        At a break or inside a segment, any order.

    Returns
    -------
    Piecewise

    Raises
    ------
    InputError
        Where the degree is so high or the times are so uneven that rounding spoils the solution.
    """
    lengths, degree = np.diff(breaks), max(degrees)
    if not (lengths > 0).all():  # knots that are averages of times may round to the same
        raise ill_conditioned(degree, conditions[0].times, np.inf)
    origin = conditions[0].values[0]
    groups = [_condition_rows(breaks, degree, conditions), _continuity_rows(breaks, degree, continuity)]
    if min(degrees) < degree:
        groups.append(_degree_rows(breaks, np.asarray(degrees)))
    instants, first, factors = (np.concatenate(parts) for parts in zip(*groups, strict=True))
    values = np.zeros((len(instants), len(origin)))
    given = np.concatenate([c.values - (0.0 if c.order else origin) for c in conditions])
    values[: len(given)] = given
    order = np.argsort(instants, kind="stable")
    scale = np.abs(factors).max(axis=1, keepdims=True)
    equations, right = _Equations(first[order], (factors / scale)[order]), (values / scale)[order]
    solution, doubt = refined(_factorised(equations), equations.times, right.astype(np.float64))
    if not doubt <= ALLOWED_DOUBT:
        raise ill_conditioned(degree, conditions[0].times, doubt)
    series = solution.reshape(len(lengths), degree + 1, len(origin)).transpose(1, 0, 2)
    series[0] += origin
    return Piecewise(breaks=breaks, coefficients=series)


def refined(
    solve: Callable[[Array], Array], product: Callable[[Array], NDArray[np.longdouble]], right: Array
) -> tuple[Array, float]:
    """The solution of a linear system for polynomials' coefficients, and how far it is off, relative to the movement.

    Iterative refinement: with the residual in extended precision, each correction is smaller than the one before by
    the condition number times a rounding, until rounding of the residual is all that it corrects (Higham, Accuracy and
    Stability of Numerical Algorithms, 12.1). What the solution is off by is the correction that got no smaller, and a
    rounding of all coefficients, which is much where the polynomials swing far beyond their points.

    Parameters
    ----------
    solve : callable
        The solution in double precision for a right-hand side, shape (N, m).
    product : callable
        The left-hand sides of a solution, in extended precision.
    right : ndarray, shape (N, m)

    Returns
    -------
    solution : ndarray, shape (N, m)
    doubt : float
    """
    solution = solve(right)
    before = np.abs(solution).max(axis=0)
    for _ in range(_REFINEMENTS):
        correction = solve((right - product(solution)).astype(np.float64))
        off = np.abs(correction).max(axis=0)
        if (off <= _CONVERGED * before).all():
            solution = solution + correction
            off = off * _CONVERGED
            break
        if not (off <= before / 4).all():
            break
        solution, before = solution + correction, off
    off = off + _EPS * np.abs(solution).sum(axis=0)
    # A joint that stays where it is has coefficients that are exactly zero.
    return solution, float((off / np.maximum(np.abs(right).max(axis=0), np.finfo(np.float64).tiny)).max())


def ill_conditioned(degree: int, t: Array, doubt: float) -> InputError:
    """What to say where rounding leaves positions uncertain by `doubt`, relative to the movement."""
    lengths = np.diff(t)
    short, longest = int(np.argmin(lengths)), lengths.max()
    with np.errstate(divide="ignore"):
        ratio = longest / lengths[short]
    size = f"{doubt:.1e} of the movement" if np.isfinite(doubt) else "more than all of the movement"
    return InputError(
        f"times: degree {degree} with segments of {lengths[short]:g} s (segment {short + 1}, {t[short]:.9g} s after the"
        f" start) to {longest:g} s, a ratio of {ratio:.3g}, is too ill-conditioned: rounding"
        f" leaves positions uncertain by {size}, but at most {ALLOWED_DOUBT:g} is allowed; use a lower degree, fewer"
        " points in one polynomial or more even times"
    )


_Rows = tuple[Array, NDArray[np.int64], NDArray[np.longdouble]]


def _condition_rows(breaks: Array, degree: int, conditions: Sequence[Condition]) -> _Rows:
    """A derivative by time at a time; at a break, of the segment that begins there."""
    times = np.concatenate([c.times for c in conditions])
    i = breaks[1:-1].searchsorted(times, side="right")
    left = breaks[i].astype(np.longdouble)
    length = breaks[i + 1] - left
    rows = np.zeros((len(times), 2 * degree + 2), dtype=np.longdouble)
    rows[:, : degree + 1] = chebyshev.chebvander(2 * (times - left) / length - 1, degree)
    end = 0
    for count, order in ((len(c.times), c.order) for c in conditions):
        at, end = slice(end, end + count), end + count
        if order:
            rows[at, : degree + 1] = rows[at, : degree + 1] @ _derivative(degree, order)
            rows[at] *= (2 / length[at, None]) ** order
    return times, i, rows


def _continuity_rows(breaks: Array, degree: int, continuity: int) -> _Rows:
    """The derivatives of neighbours at their break differ by zero."""
    lengths = np.diff(breaks.astype(np.longdouble))
    shorter = np.minimum(lengths[:-1], lengths[1:])[:, None, None]
    orders = np.arange(continuity + 1)[:, None]
    end, start = _ends(degree, continuity)
    before = (shorter / lengths[:-1, None, None]) ** orders * -end
    after = (shorter / lengths[1:, None, None]) ** orders * start
    rows = np.concatenate([before, after], axis=2).reshape(-1, 2 * degree + 2)
    i = np.arange(len(lengths) - 1)
    return np.repeat(breaks[1:-1], continuity + 1), np.repeat(i, continuity + 1), rows


def _degree_rows(breaks: Array, degrees: NDArray[np.int64]) -> _Rows:
    """The coefficients beyond a segment's own degree are zero."""
    top = int(degrees.max())
    i, k = np.nonzero(np.arange(top + 1) > degrees[:, None])
    rows = np.zeros((len(i), 2 * top + 2), dtype=np.longdouble)
    rows[np.arange(len(i)), k] = 1.0
    return (breaks[i] + breaks[i + 1]) / 2, i, rows


def _derivative(degree: int, order: int) -> Array:
    """The matrix that takes a series to that of its derivative by x; integers, hence exact."""
    return matrices.state_matrix(degree, order)[order * (degree + 1) :]


@lru_cache(maxsize=64)
def _ends(degree: int, continuity: int) -> tuple[Array, Array]:
    """Derivatives 0 ... continuity by x of T_0 ... T_degree at x = 1 and -1, each (continuity + 1, degree + 1)."""
    k, r = np.arange(degree + 1.0), np.arange(continuity + 1)[:, None]
    end = np.cumprod(np.concatenate([np.ones((1, degree + 1)), (k**2 - r**2) / (2 * r + 1)]), axis=0)[:-1]
    return read_only(end), read_only(end * (-1.0) ** (k + r))


def _factorised(equations: _Equations) -> Callable[[Array], Array]:
    """Solver of the banded system by LU with partial pivoting, LAPACK's gbtrf and gbtrs."""
    # SciPy takes as long to load as NumPy; most profiles do without it.
    from scipy.linalg import lapack

    row, k = np.nonzero(equations.factors)
    column = equations.first[row] * (equations.factors.shape[1] // 2) + k
    below, above = max(int((row - column).max()), 0), max(int((column - row).max()), 0)
    bands = np.zeros((2 * below + above + 1, len(equations.first)), order="F")
    bands[below + above + row - column, column] = equations.factors[row, k]
    factors, pivots, info = lapack.dgbtrf(bands, below, above, overwrite_ab=True)

    def solve(right: Array) -> Array:
        if info:  # singular
            return np.full_like(right, np.nan)
        return np.asarray(lapack.dgbtrs(factors, below, above, right, pivots)[0])

    return solve
