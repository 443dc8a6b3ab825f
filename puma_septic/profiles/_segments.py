"""Polynomials of given degrees, joined smoothly, from linear conditions on their values."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from puma_septic.checks import Array
from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise

__all__ = ["Condition", "at_ends", "solve_segments", "through"]

# (time in s, order of the derivative, value of shape (n_joints,))
Condition = tuple[float, int, Array]
# Parts of an equation: (segment, its coefficients' factors).
_Row = list[tuple[int, Array]]
# Largest correction by refinement, relative to the movement, that leaves positions right to 1e-9: refinement
# does not see the rounding of the times themselves, which was measured (against rational arithmetic) to cost
# up to 60 times more.
_ALLOWED_DOUBT = 1e-11


def through(times: Array, points: Array, order: int = 0) -> list[Condition]:
    """Conditions that a derivative (by default the position) takes the given rows at the given times."""
    return [(float(t), order, row) for t, row in zip(times, points, strict=True)]


def at_ends(times: Array, order: int, start: Array, end: Array) -> list[Condition]:
    """Conditions on one derivative at the first and the last time."""
    return [(float(times[0]), order, start), (float(times[-1]), order, end)]


def solve_segments(
    breaks: Array, degrees: Sequence[int], continuity: int, conditions: Sequence[Condition]
) -> Piecewise:
    """The piecewise polynomial of these degrees that meets all conditions.

    At each interior break all derivatives up to order `continuity` are continuous. With the conditions this
    must give as many equations as there are coefficients, ``sum(degrees) + len(degrees)``; the first
    condition is a position. The unknowns are Chebyshev coefficients of each segment's own normalised time and
    every equation is scaled to size one, so that neither the unit of time nor uneven segments spoil the
    digits. Positions are taken relative to the first one: the coefficients of a joint that does not move come
    out exactly zero. One dense system, solved by LU: meant for up to a few hundred segments.

    Parameters
    ----------
    breaks : ndarray, shape (n + 1,)
    degrees : sequence of int, length n
    continuity : int
    conditions : sequence of Condition
        At a break or inside a segment, any order.

    Raises
    ------
    InputError
        Where the degree is so high or the times are so uneven that rounding spoils the solution.
    """
    lengths = np.diff(breaks)
    first = np.concatenate([[0], np.cumsum(np.asarray(degrees) + 1)])
    origin = conditions[0][2]
    rows = _condition_rows(breaks, degrees, conditions) + _continuity_rows(lengths, degrees, continuity)
    equations = np.zeros((len(rows), first[-1]))
    for equation, row in zip(equations, rows, strict=True):
        for i, part in row:
            equation[first[i] : first[i + 1]] = part
    values = np.zeros((len(rows), len(origin)))
    for k, (_, order, value) in enumerate(conditions):
        values[k] = value if order else value - origin
    solution, doubt = _solved(equations, values)
    if doubt > _ALLOWED_DOUBT:
        raise InputError(
            f"degree {max(degrees)} with segments of {lengths.min():g} s to {lengths.max():g} s is too"
            f" ill-conditioned: refining the solution changes it by {doubt:.1e} of the movement, but at most"
            f" {_ALLOWED_DOUBT:g} lets positions hold to 1e-9; use a lower degree, fewer points in one"
            " polynomial or more even times"
        )
    series = np.zeros((max(degrees) + 1, len(lengths), len(origin)))
    for i, degree in enumerate(degrees):
        series[: degree + 1, i] = solution[first[i] : first[i + 1]]
    series[0] += origin
    return Piecewise(breaks=breaks, coefficients=series)


def _condition_rows(breaks: Array, degrees: Sequence[int], conditions: Sequence[Condition]) -> list[_Row]:
    """A derivative by time at a time; at a break, of the segment that begins there."""
    rows: list[_Row] = []
    for t, order, _ in conditions:
        i = int(np.searchsorted(breaks[1:-1], t, side="right"))
        half = (breaks[i + 1] - breaks[i]) / 2
        row = _derivative_row(degrees[i], order, float((t - breaks[i]) / half - 1))
        rows.append([(i, row / half**order)])
    return rows


def _continuity_rows(lengths: Array, degrees: Sequence[int], continuity: int) -> list[_Row]:
    """The derivatives of neighbours at their break differ by zero."""
    rows: list[_Row] = []
    for i in range(1, len(lengths)):
        shorter = min(lengths[i - 1], lengths[i])
        for order in range(continuity + 1):
            before, after = (shorter / lengths[i - 1]) ** order, (shorter / lengths[i]) ** order
            left = -before * _derivative_row(degrees[i - 1], order, 1.0)
            rows.append([(i - 1, left), (i, after * _derivative_row(degrees[i], order, -1.0))])
    return rows


def _solved(equations: Array, values: Array) -> tuple[Array, float]:
    """The solution, and how far refinement changed it, relative to the largest value asked for.

    Each equation is scaled to largest coefficient one. One step of iterative refinement, its residual in
    extended precision, corrects the solution by about its error (Higham, Accuracy and Stability of Numerical
    Algorithms, 12.1).
    """
    scale = np.abs(equations).max(axis=1, keepdims=True)
    matrix, right = equations / scale, values / scale
    solution = np.linalg.solve(matrix, right)
    residual = right - matrix.astype(np.longdouble) @ solution.astype(np.longdouble)
    correction = np.linalg.solve(matrix, residual.astype(np.float64))
    largest = np.abs(right).max(axis=0)
    doubt = np.abs(correction).max(axis=0) / np.where(largest > 0, largest, 1.0)
    return np.asarray(solution + correction), float(doubt.max())


@lru_cache(maxsize=1024)
def _derivative_row(degree: int, order: int, x: float) -> Array:
    """Derivatives by x of T_0 ... T_degree at x, shape (degree + 1,); exact at both ends."""
    k = np.arange(degree + 1.0)
    if abs(x) == 1.0:
        # T_k^(r)(1) = prod (k^2 - i^2) / (2 i + 1) over i < r; at -1 with alternating signs.
        row = np.ones(degree + 1)
        for i in range(order):
            row *= (k**2 - i**2) / (2 * i + 1)
        row = row if x > 0 else row * (-1.0) ** (np.arange(degree + 1) + order)
    else:
        row = np.asarray(chebyshev.chebval(x, chebyshev.chebder(np.eye(degree + 1), order)))
    row.setflags(write=False)
    return row
