"""Quintic splines through samples, or as near to them as their knots allow, and what noise makes of them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_interp_spline
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded
from scipy.sparse import csr_array

from puma_septic.logs._breaks import Break
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array

__all__ = [
    "DEGREE", "as_piecewise", "as_spline", "banded", "constant_between", "end_slopes", "interpolated", "knots_on",
    "least_squares", "merged_columns",
]  # fmt: skip

DEGREE: Final = 5
# Samples between two breaks that do not determine a piece by themselves.
_CLOSE: Final = 4
# Samples that a spline without conditions at its ends needs.
_FEWEST: Final = DEGREE + 2


def interpolated(t: Array, q: Array, ends: Array | None = None, breaks: Sequence[Sequence[Break]] = ()) -> BSpline:
    """The quintic spline through the samples.

    Parameters
    ----------
    t : ndarray, shape (n,)
        From 0, s.
    q : ndarray, shape (n, m, ...)
    ends : ndarray, shape (2, 2, m, ...), optional
        Velocity and acceleration at the start, and at the end; without, the third derivatives beside the first and
        last two inner samples are continuous ("not a knot").
    breaks : sequence, optional
        Of each of the m components, where its derivatives may step: knots of so many places there stand for those at
        the nearest samples.
    """
    if not any(breaks):
        return make_interp_spline(t, q, k=DEGREE, bc_type=_conditions(ends))
    splines = [_broken(t, q[:, j], None if ends is None else ends[:, :, j], some) for j, some in enumerate(breaks)]
    return _side_by_side(splines)


def _conditions(ends: Array | None) -> tuple[list[tuple[int, Array]], ...] | None:
    return None if ends is None else tuple([(1, end[0]), (2, end[1])] for end in ends)


def _broken(t: Array, q: Array, ends: Array | None, breaks: Sequence[Break]) -> BSpline:
    """The spline of one component; where its breaks leave too few samples, without them."""
    inner = t[3:-3] if ends is None else t[1:-1]
    kept, extra = np.ones(len(inner), np.bool_), []
    for k, one in enumerate(breaks):
        places = DEGREE + 1 - one.order
        # Of two breaks with few samples between, each takes the knots beyond: what is between is theirs to determine.
        usable = kept.copy()
        if k + 1 < len(breaks) and breaks[k + 1].gap - one.gap <= _CLOSE:
            usable &= inner <= one.time
        if k and one.gap - breaks[k - 1].gap <= _CLOSE:
            usable &= inner >= one.time
        near = np.argsort(np.where(usable, np.abs(inner - one.time), np.inf))[:places]
        kept[near] = False
        extra += [one.time] * places
    middle = np.sort(np.concatenate([inner[kept], extra]))
    knots = np.concatenate([np.repeat(t[0], DEGREE + 1), middle, np.repeat(t[-1], DEGREE + 1)])
    try:
        return make_interp_spline(t, q, k=DEGREE, t=knots, bc_type=_conditions(ends))
    except (ValueError, LinAlgError):
        return make_interp_spline(t, q, k=DEGREE, bc_type=_conditions(ends))


def _side_by_side(splines: Sequence[BSpline]) -> BSpline:
    """Splines of one component each as one spline on the knots of all."""
    counts: Counter[float] = Counter()
    for spline in splines:
        counts |= Counter(spline.t.tolist())
    wider = []
    for spline in splines:
        for knot, count in (counts - Counter(spline.t.tolist())).items():
            spline = spline.insert_knot(knot, count)
        wider.append(spline)
    return BSpline(wider[0].t, np.stack([spline.c for spline in wider], axis=1), DEGREE)


def end_slopes(spline: BSpline) -> Array:
    """Velocity and acceleration at the start, and at the end, shape (2, 2, ...)."""
    ends = [spline.t[0], spline.t[-1]]
    return np.stack([spline(ends, nu=order) for order in (1, 2)], axis=1)


def knots_on(breaks: Array) -> Array:
    """A knot at each break, the ends repeated."""
    return np.concatenate([np.repeat(breaks[0], DEGREE), breaks, np.repeat(breaks[-1], DEGREE)])


def merged_columns(p: int, rest: tuple[int, int]) -> NDArray[np.int64]:
    """Which free coefficient each of p B-spline coefficients is.

    Where the first `rest` derivatives are zero at an end, the first `rest` + 1 coefficients are equal there.
    """
    return np.clip(np.arange(p) - rest[0], 0, p - 1 - sum(rest))


def constant_between(merged: NDArray[np.int64], knots: Array, spans: Array) -> NDArray[np.int64]:
    """Which free coefficient each one is, where the spline is constant on spans (k, 2) between two knots too."""
    equal = np.diff(merged) == 0
    for start in spans[:, 0]:
        last = int(np.searchsorted(knots, start, side="right")) - 1
        equal[last - DEGREE : last] = True
    return np.concatenate([[0], np.cumsum(~equal)])


def least_squares(t: Array, q: Array, knots: Array, merged: NDArray[np.int64]) -> tuple[Array, Array]:
    """Coefficients (p, m) of the least-squares spline, and the banded Cholesky factor of its free normal equations."""
    p = len(knots) - DEGREE - 1
    basis = BSpline.design_matrix(t, knots, DEGREE) @ csr_array((np.ones(p), (np.arange(p), merged)))
    # The normal equations of B-splines are banded and well conditioned.
    factor = cholesky_banded(banded(basis.T @ basis))
    free = cho_solve_banded((factor, False), basis.T @ (q - q[0]))
    return free[merged] + q[0], factor


def banded(matrix: csr_array) -> Array:
    """The upper bands of a symmetric matrix as LAPACK has them."""
    bands = np.zeros((DEGREE + 1, matrix.shape[0]))
    for k in range(min(DEGREE + 1, matrix.shape[0])):
        bands[DEGREE - k, k:] = matrix.diagonal(k)
    return bands


def as_spline(knots: Array, coefficients: Sequence[Array]) -> BSpline:
    """One spline of the joints' coefficients, each (p,) or (p, k)."""
    return BSpline(knots, np.stack(coefficients, axis=1), DEGREE)


def as_piecewise(spline: BSpline, start: float, still: NDArray[np.bool_]) -> Piecewise:
    """A spline that begins at 0 as it is, begun at another instant; joints that stand still are exactly constant."""
    breaks = np.unique(spline.t)
    lengths = np.diff(breaks)[:, None]
    origin = spline.c[0]
    relative = BSpline(spline.t, np.where(still, 0.0, spline.c - origin), spline.k)
    # The Taylor series at the start of each interval is the whole polynomial.
    powers = np.stack([
        relative(breaks[:-1], nu=k) * lengths**k / math.factorial(k) for k in range(spline.k + 1)
    ])  # fmt: skip
    powers[0] += origin
    return Piecewise.from_power(breaks, powers).shifted(start)
