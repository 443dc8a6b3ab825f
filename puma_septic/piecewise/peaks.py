"""Largest magnitudes of very many series at once, and certified bounds of them.

All series are evaluated at the same Chebyshev-Lobatto points, twice as many as the degree, by one matrix product.
Between two of them, a step apart in ``theta = arccos x``, a series of degree n is at most ``step^2 / 8 sum k^2 |c_k|``
above the larger of both values. Only cells that can hold the largest of all by this are climbed, by the Taylor series
at their middle. A maximum is found where the slope changes its sign within a cell; more than one there count as one.

For a series of degree n and its values at N + 1 of these points, N >= n, ``max |p| <= max |values| / cos(pi n / 2 N)``
(Ehlich and Zeller, Schwankung von Polynomen zwischen Gitterpunkten, Math. Zeitschrift 86, 1964, 41-44): no roots
needed, and attained by Chebyshev polynomials.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import cos, factorial, pi
from typing import Final, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise import matrices
from puma_septic.validation import Array

__all__ = ["Peaks", "Steps", "bounds", "find_peaks"]

Index = NDArray[np.int64]
# Of the first coefficients of a resolved series what the Taylor series leaves out is (pi / 8)^11 / 11! of a middle one.
_ORDER: Final = 10
_LEAST_POINTS: Final = 64
# Newton's method within brackets; the value at a maximum is known to the square of the last step.
_MOST_STEPS: Final = 30
_LAST_STEP: Final = 1e-7


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Steps:
    """A step function beside each series: its first level, and steps.

    Attributes
    ----------
    first : ndarray, shape (c,)
    column : ndarray of int, shape (k,)
        Of each step, in order; those of a column by x.
    x : ndarray, shape (k,)
        Inside (-1, 1).
    size : ndarray, shape (k,)
    """

    first: Array
    column: Index
    x: Array
    size: Array


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Peaks:
    """The largest magnitude of each group of series.

    Attributes
    ----------
    size : ndarray, shape (g,)
    column : ndarray of int, shape (g,)
        The series that has it.
    x : ndarray, shape (g,)
        Where, in [-1, 1].
    at_points : ndarray, shape (g,)
        The largest magnitude at the points and at steps alone.
    bound : ndarray, shape (g,)
        A certified bound of the magnitude: the lesser of what can be hidden between points and Ehlich and Zeller's.
    """

    size: Array
    column: Index
    x: Array
    at_points: Array
    bound: Array


def bounds(series: Array, oversampling: int = 8) -> tuple[Array, Array]:
    """The largest magnitude of each series (degree + 1, c) at ``oversampling degree + 1`` points, and a bound of all.

    Returns
    -------
    lower, upper : ndarray, shape (c,)
        The upper one is at most ``1 / cos(pi / (2 oversampling))`` times the lower: 2 % at 8, 0.03 % at 64.

    Examples
    --------
    >>> T_5 = np.eye(6)[:, 5:]
    >>> [float(value[0]) for value in bounds(T_5, 8)]
    [1.0, 1.0196...]
    """
    degree = len(series) - 1
    if not degree:
        size = np.abs(series[0])
        return size, size
    at_points = np.abs(matrices.values_matrix(degree, oversampling * degree) @ series).max(axis=0)
    return at_points, at_points / cos(pi / (2 * oversampling))


class _Grid(NamedTuple):
    """Angles from pi to 0; T_k and its slope by angle there, (points, degree + 1); its Taylor series half-way."""

    theta: Array
    values: Array
    slopes: Array
    taylor: Array


@lru_cache(maxsize=64)
def _grid(degree: int) -> _Grid:
    theta = np.linspace(pi, 0.0, max(2 * degree, _LEAST_POINTS) + 1)
    k = np.arange(degree + 1.0)
    middles = (theta[1:] + theta[:-1]) / 2
    between = np.multiply.outer(middles, k)
    taylor = [np.cos(between + order * pi / 2) * (k**order / factorial(order)) for order in range(_ORDER + 1)]
    angles = np.multiply.outer(theta, k)
    return _Grid(theta, np.cos(angles), -np.sin(angles) * k, np.stack(taylor, axis=1))


def find_peaks(series: Array, group: Index, count: int, steps: Steps | None = None) -> Peaks:
    """The largest magnitude within each group of series.

    Parameters
    ----------
    series : ndarray, shape (degree + 1, c)
    group : ndarray of int, shape (c,)
        From 0 to `count` - 1, each of which occurs.
    count : int
    steps : Steps, optional
        Added to the series.

    Returns
    -------
    Peaks
    """
    degree = len(series) - 1
    grid = _grid(degree)
    n_points, n_columns = len(grid.theta), series.shape[1]
    values = grid.values @ series
    if steps is not None:
        values += _levels(steps, grid, n_columns)
    size = np.abs(values)
    top = size.argmax(axis=0)
    best = size[top, np.arange(n_columns)]
    column, x, found = np.arange(n_columns), np.cos(grid.theta[top]), best
    if steps is not None and len(steps.column):
        beside = _beside(series, steps)
        column = np.concatenate([column, steps.column, steps.column])
        x, found = np.concatenate([x, steps.x, steps.x]), np.concatenate([found, *np.abs(beside)])
    at_points = np.zeros(count)
    np.maximum.at(at_points, group[column], found)
    hidden = (np.arange(degree + 1.0) ** 2 @ np.abs(series)) * ((pi / (n_points - 1)) ** 2 / 8)
    near = size >= (at_points[group] - hidden)
    cells = near[1:] | near[:-1]
    if steps is not None and len(steps.column):
        high = np.abs(beside).max(axis=0) >= (at_points[group] - hidden)[steps.column]
        cells[_cell_of(steps, grid)[high], steps.column[high]] = True
    cell, at = np.nonzero(cells)
    climbed_column, climbed_x, climbed = _climbed(series, values, cell, at, grid, steps)
    column, x = np.concatenate([column, climbed_column]), np.concatenate([x, climbed_x])
    found = np.concatenate([found, climbed])
    order = np.lexsort((found, group[column]))
    owners = group[column][order]
    last = order[np.flatnonzero(np.append(owners[1:] != owners[:-1], True))]
    most_hidden = np.zeros(count)
    np.maximum.at(most_hidden, group, hidden)
    bound = at_points + most_hidden
    if steps is None:
        bound = np.minimum(bound, at_points / cos(pi * degree / (2 * (n_points - 1))))
    return Peaks(size=found[last], column=column[last], x=x[last], at_points=at_points, bound=bound)


def _cell_of(steps: Steps, grid: _Grid) -> Index:
    """The cell of the grid in which each step is."""
    theta = np.arccos(steps.x)
    cell = np.searchsorted(-grid.theta, -theta, side="right") - 1
    return np.minimum(cell, len(grid.theta) - 2)


def _levels(steps: Steps, grid: _Grid, n_columns: int) -> Array:
    """The step function at each point of the grid: of a point at a step, the level after it."""
    rises = np.zeros((len(grid.theta), n_columns))
    rises[0] = steps.first
    np.add.at(rises, (_cell_of(steps, grid) + 1, steps.column), steps.size)
    return np.cumsum(rises, axis=0)


def _beside(series: Array, steps: Steps) -> Array:
    """Values on both sides of each step, shape (2, k)."""
    value = (matrices.basis_at(steps.x, len(series) - 1) * series[:, steps.column]).sum(axis=0)
    _, after = _levels_beside(steps)
    return np.stack([value + after - steps.size, value + after])


def _levels_beside(steps: Steps) -> tuple[Array, Array]:
    """Levels before and after each step."""
    total = np.cumsum(steps.size)
    first = np.flatnonzero(np.append(True, steps.column[1:] != steps.column[:-1]))
    start = np.repeat(total[first] - steps.size[first], np.diff(np.append(first, len(steps.column))))
    after = steps.first[steps.column] + total - start
    return after - steps.size, after


def _climbed(
    series: Array, values: Array, cell: Index, column: Index, grid: _Grid, steps: Steps | None
) -> tuple[Index, Array, Array]:
    """Column, x and magnitude of the maximum inside each cell, where there is one."""
    may = _may_hold_one(series, values, cell, column, grid)
    if steps is not None and len(steps.column):
        cut = np.zeros((len(grid.theta) - 1, series.shape[1]), dtype=np.bool_)
        cut[_cell_of(steps, grid), steps.column] = True
        may |= cut[cell, column]
    cell, column = cell[may], column[may]
    taylor = np.empty((_ORDER + 1, len(cell)))
    order = np.argsort(cell, kind="stable")
    cuts = np.flatnonzero(np.append(True, np.diff(cell[order]) != 0))
    for start, end in zip(cuts.tolist(), [*cuts[1:].tolist(), len(cell)], strict=True) if len(cell) else ():
        some = order[start:end]
        taylor[:, some] = grid.taylor[cell[some[0]]] @ series[:, column[some]]
    half = (grid.theta[0] - grid.theta[1]) / 2
    part = _Parts(np.arange(len(cell)), np.full(len(cell), -half), np.full(len(cell), half), values[cell, column])
    level = part.value - _taylor(taylor, part.high)[0]
    if steps is not None and len(steps.column):
        part, level = _split(part, level, cell, column, grid, steps)
    own = taylor[:, part.cell].copy()
    own[0] += level
    low, high = part.low, part.high
    side = np.sign(_taylor(own, (low + high) / 2)[0])
    own *= side
    # The angle falls from a point to the following one; at both ends of an interval any slope by angle is zero.
    rises, falls = _taylor(own, high)[1] < 0, _taylor(own, low)[1] > 0
    inside = (rises | (cell[part.cell] == 0)) & (falls | (cell[part.cell] == len(grid.theta) - 2)) & (high > low)
    own, low, high, cells = own[:, inside], low[inside], high[inside], part.cell[inside]
    delta = _highest(own, low, high)
    middle = (grid.theta[cell[cells]] + grid.theta[cell[cells] + 1]) / 2
    return column[cells], np.cos(middle + delta), np.abs(_taylor(own, delta)[0])


def _may_hold_one(series: Array, values: Array, cell: Index, column: Index, grid: _Grid) -> NDArray[np.bool_]:
    """Whether the magnitude rises from the start of each cell and falls to its end, were it smooth."""
    rows, side = np.ascontiguousarray(series.T)[column], np.sign(values[cell, column])
    # The angle falls from a point to the following one; at both ends of an interval any slope by angle is zero.
    rises = (np.einsum("ck,ck->c", grid.slopes[cell], rows) * side < 0) | (cell == 0)
    falls = (np.einsum("ck,ck->c", grid.slopes[cell + 1], rows) * side > 0) | (cell == len(grid.theta) - 2)
    return np.asarray(rises & falls)


class _Parts(NamedTuple):
    """Parts of cells, from angle `high` down to `low` beside the middle; the value at the start of the cell."""

    cell: Index
    low: Array
    high: Array
    value: Array


def _split(part: _Parts, level: Array, cell: Index, column: Index, grid: _Grid, steps: Steps) -> tuple[_Parts, Array]:
    """Cells cut at the steps inside them, and the level of each part."""
    # The cells are numbered as (cell, column) pairs in ascending order of that pair.
    n = len(grid.theta)
    key, wanted = cell * np.int64(1 << 40) + column, _cell_of(steps, grid) * np.int64(1 << 40) + steps.column
    place = np.searchsorted(key, wanted)
    there = (place < len(key)) & (key[np.minimum(place, len(key) - 1)] == wanted) if len(key) else np.zeros(0, bool)
    if not np.any(there):
        return part, level
    place = place[there]
    delta = np.arccos(steps.x[there]) - (grid.theta[cell[place]] + grid.theta[np.minimum(cell[place] + 1, n - 1)]) / 2
    delta = np.clip(delta, part.low[place], part.high[place])
    order = np.lexsort((-delta, place))
    place, delta, size = place[order], delta[order], steps.size[there][order]
    # Each step ends the part before it and starts the next one of its cell.
    first = np.append(True, place[1:] != place[:-1])
    last = np.append(first[1:], True)
    ends = np.where(last, part.low[place], np.append(delta[1:], 0.0))
    low = part.low.copy()
    low[place[first]] = delta[first]
    total = np.cumsum(size)
    since = np.flatnonzero(first)
    before = np.repeat(total[since] - size[since], np.diff(np.append(since, len(place))))
    added = level[place] + total - before
    return (
        _Parts(
            np.concatenate([part.cell, place]),
            np.concatenate([low, ends]),
            np.concatenate([part.high, delta]),
            np.concatenate([part.value, np.zeros(len(place))]),
        ),
        np.concatenate([level, added]),
    )


def _highest(series: Array, low: Array, high: Array) -> Array:
    """Where each Taylor series is highest between two places, by Newton's method within brackets."""
    found, moving = (low + high) / 2, np.arange(len(low))
    delta, near = found, _LAST_STEP * (high - low)
    for _ in range(_MOST_STEPS):
        _, slope, bend = _taylor(series, delta)
        low, high = np.where(slope > 0, delta, low), np.where(slope > 0, high, delta)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = delta - slope / bend
        following = np.where((bend < 0) & (newton >= low) & (newton <= high), newton, (low + high) / 2)
        left = np.abs(following - delta) > near
        found[moving] = following
        if not left.any():
            break
        # Nearly all are found in four steps: the others go on alone.
        moving, series, delta = moving[left], series[:, left], following[left]
        low, high, near = low[left], high[left], near[left]
    return np.asarray(found)


def _taylor(series: Array, delta: Array) -> tuple[Array, Array, Array]:
    """Value, first and second derivative of each column at its own place."""
    value, slope, bend = series[-1], np.zeros_like(delta), np.zeros_like(delta)
    for coefficient in series[-2::-1]:
        bend = bend * delta + 2 * slope
        slope = slope * delta + value
        value = value * delta + coefficient
    return value, slope, bend
