"""For which values of a parameter a motion keeps its limits: all of them, exactly.

In ``1/x`` of its time, or carrying x kg, a motion demands at each instant of each joint a polynomial of x. Each instant
rules out the x at which its own demand is too large, intervals between roots; what is left by some instants contains
what is left by all. At the ends of what is left the exact peaks are looked for, and the instants of those beyond their
limit are added, until there is none: the exchange method of semi-infinite programming (Hettich and Kortanek, SIAM
Review 35, 1993). Nothing feasible is ever ruled out.

That nothing inside is violated either is proved by Bernstein's form in x: a polynomial lies below the largest of its
control values, each of which is a series of time with an exact peak. Parts of which this does not hold are halved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, Protocol, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.limits._demands import Demand, Rows
from puma_septic.validation import Array

__all__ = ["Certificate", "Constraint", "Feasible", "feasible_values"]

Certificate = Literal["proved", "resolved", "undecided"]

# The exchange ends where no peak is beyond this.
_CLOSE: Final = 3e-12
_MOST_ROUNDS: Final = 60
_MOST_HALVINGS: Final = 12
# Parts that are examined at once when a proof is tried; beyond that it is given up.
_MOST_PARTS: Final = 64
# What is left between two values that are ruled out is none where it is narrower than this part of them.
_NARROW: Final = 1e-11
# Nothing that moves or is carried is told apart beyond this.
_UNBOUNDED: Final = 1e7
# Where nothing can be proved, values inside each interval that are examined.
_SCANNED: Final = (np.arange(8) + 0.5) / 8


class Constraint(Protocol):
    """What is held at every instant and value of the parameter; a `Demand`, or what is no polynomial."""

    @property
    def quantity(self) -> str:
        """Of `LimitCheck`."""

    @property
    def joints(self) -> NDArray[np.int64]:
        """Joints concerned, shape (m,)."""

    def first_instants(self) -> Array:
        """Instants to begin with."""

    def rows(self, times: Array) -> Rows:
        """What must hold at some instants."""

    def peaks(self, x: Array) -> tuple[Array, Array]:
        """Largest share of the limit over time at some values x, and its instant, each of shape (len(x), m)."""


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Feasible:
    """The values of a parameter at which every demand keeps its limit.

    Attributes
    ----------
    intervals : ndarray, shape (k, 2)
        Closed, ascending, apart; the last may end at infinity.
    certificate : {"proved", "resolved", "undecided"}
        Whether nothing inside them is violated is proved; or found so at their ends and at many instants; or open,
        because the search ended early.
    """

    intervals: Array
    certificate: Certificate


def feasible_values(demands: Sequence[Constraint], highest: float = np.inf) -> Feasible:
    """All x from 0 to `highest` at which no demand exceeds its limit at any instant.

    Returns
    -------
    Feasible
    """
    rows = [demand.rows(demand.first_instants()) for demand in demands]
    bounded = min(highest, min((row.bound() for row in rows), default=np.inf), _UNBOUNDED)
    proved: Certificate = "undecided"
    intervals = np.array([[0.0, bounded]])
    for _ in range(_MOST_ROUNDS):
        intervals = _left(rows, intervals)
        if not len(intervals):
            proved = "proved"
            break
        new = _beyond(demands, intervals.ravel())
        if new is None:
            new, proved = _examined(demands, intervals)
        if new is None:
            break
        rows = [demand.rows(times) for demand, times in zip(demands, new, strict=True)]
    if np.isinf(highest) and len(intervals) and bounded >= _UNBOUNDED and intervals[-1, 1] == bounded:
        intervals[-1, 1] = np.inf
    return Feasible(intervals=intervals, certificate=proved)


def _left(rows: Sequence[Rows], intervals: Array) -> Array:
    """What the demands at some instants leave of the intervals."""
    if not len(intervals):
        return intervals
    highest = float(intervals[-1, 1])
    out = [np.array([[-1.0, 0.0], [highest, highest + 1.0]])]
    out += [np.column_stack([intervals[:-1, 1], intervals[1:, 0]])]
    if intervals[0, 0] > 0:
        out.append(np.array([[-1.0, intervals[0, 0]]]))
    out += [_positive(row, highest) for row in rows]
    ruled_out = np.concatenate(out)
    ruled_out = ruled_out[np.argsort(ruled_out[:, 0], kind="stable")]
    reach = np.maximum.accumulate(ruled_out[:, 1])[:-1]
    following = ruled_out[1:, 0]
    open_ = following - reach > _NARROW * following
    return np.column_stack([reach[open_], following[open_]])


def _positive(rows: Rows, highest: float) -> Array:
    """Where in [0, highest] the polynomials of some rows are positive, as intervals (k, 2)."""
    polynomials, (low, high) = rows.polynomials, np.minimum(rows.windows, highest).T
    # Only where its positive terms outweigh the others can it be.
    reach = highest ** np.arange(polynomials.shape[1])
    may = (np.maximum(polynomials * reach, 0.0).sum(axis=1) > -np.minimum(polynomials[:, 0], 0.0)) & (low < high)
    if not may.any():
        return np.empty((0, 2))
    polynomials, low, high = polynomials[may], low[may, None], high[may, None]
    edges = np.hstack([low, np.clip(_roots(polynomials, highest), low, high), high])
    edges.sort(axis=1)
    middles = (edges[:, :-1] + edges[:, 1:]) / 2
    positive = (_value(polynomials, middles) > 0) & (edges[:, 1:] > edges[:, :-1])
    return np.column_stack([edges[:, :-1][positive], edges[:, 1:][positive]])


def _value(polynomials: Array, x: Array) -> Array:
    """Of each polynomial (n, powers) at its own points (n, k)."""
    result = np.zeros_like(x)
    for column in polynomials.T[::-1]:
        result = result * x + column[:, None]
    return result


def _roots(polynomials: Array, none: float) -> Array:
    """Real roots of polynomials (n, powers) of degree 1 to 3, shape (n, powers - 1); `none` where there are fewer."""
    degree = polynomials.shape[1] - 1
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if degree == 1:
            roots = -polynomials[:, :1] / polynomials[:, 1:]
        elif degree == 2:
            c, b, a = polynomials.T
            # Two forms of the quadratic formula: neither root loses digits where the other is far.
            half = -(b + np.copysign(np.sqrt(b**2 - 4 * a * c), b)) / 2
            roots = np.column_stack([half / a, c / half])
        else:
            roots = _cubic_roots(polynomials)
    return np.where(np.isfinite(roots), roots, none)


def _cubic_roots(polynomials: Array) -> Array:
    """By eigenvalues of companion matrices of the reversed polynomial, so that a small leading term does no harm."""
    n, size = len(polynomials), polynomials.shape[1] - 1
    companion = np.zeros((n, size, size))
    companion[:, np.arange(1, size), np.arange(size - 1)] = 1.0
    lead = np.where(polynomials[:, 0] == 0, np.finfo(float).tiny, polynomials[:, 0])
    companion[:, 0] = -polynomials[:, 1:] / lead[:, None]
    values = np.linalg.eigvals(companion)
    real = np.abs(values.imag) <= 1e-7 * np.abs(values)
    x = np.where(real & (values.real != 0), 1 / values.real, np.nan)
    derivative = polynomials[:, 1:] * np.arange(1, size + 1)
    for _ in range(2):
        step = _value(polynomials, x) / _value(derivative, x)
        x = np.where(np.abs(step) < 1e-3 * np.abs(x), x - step, x)
    return np.asarray(x)


def _beyond(demands: Sequence[Constraint], x: Array) -> list[Array] | None:
    """Instants of peaks that exceed their limits at any of some values x, of each demand; None where none does."""
    found, any_ = [], False
    for demand in demands:
        share, times = demand.peaks(x)
        over = share > 1 + _CLOSE
        any_ |= bool(over.any())
        found.append(np.unique(times[over]))
    return found if any_ else None


def _examined(demands: Sequence[Constraint], intervals: Array) -> tuple[list[Array] | None, Certificate]:
    """Instants at which something inside the intervals is violated, or how sure it is that nothing is."""
    polynomial = [demand for demand in demands if isinstance(demand, Demand)]
    if len(polynomial) < len(demands):
        inside = intervals[:, :1] + np.diff(intervals, axis=1) * _SCANNED
        if (found := _beyond(demands, inside.ravel())) is not None:
            return found, "undecided"
        return None, "resolved"
    parts = intervals
    for _ in range(_MOST_HALVINGS):
        if not len(parts):
            return None, "proved"
        if len(parts) > _MOST_PARTS:
            break
        open_: NDArray[np.bool_] = np.zeros(len(parts), dtype=np.bool_)
        violated = []
        for demand in polynomial:
            share, times = demand.control_peaks(parts)
            over = share > 1 + _CLOSE
            violated.append(np.unique(times[:, [0, -1]][over[:, [0, -1]]]))
            open_ |= over.any(axis=(1, 2))
        if any(len(times) for times in violated):
            return violated, "undecided"
        left, right = parts[open_].T
        middle = (left + right) / 2
        parts = np.concatenate([np.column_stack([left, middle]), np.column_stack([middle, right])])
    return None, "resolved"
