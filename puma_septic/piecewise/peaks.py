"""Largest magnitudes of very many series at once, and certified bounds of them.

All series are evaluated at the same Chebyshev-Lobatto points, as many as the degree needs, by one matrix product.
Between two of them, a step apart in ``theta = arccos x``, a series of degree n is at most ``step^2 / 8 sum k^2 |c_k|``
above the larger of both values. Only cells that can hold the largest of all by this are climbed, by the Taylor series
at their middle. A maximum is found where the slope changes its sign within a cell; more than one there count as one.

For a series of degree n and its values at N + 1 of these points, N >= n, ``max |p| <= max |values| / cos(pi n / 2 N)``
(Ehlich and Zeller, Schwankung von Polynomen zwischen Gitterpunkten, Math. Zeitschrift 86, 1964, 41-44): no roots
needed, and attained by Chebyshev polynomials.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, factorial, pi
from typing import Final, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise import matrices
from puma_septic.piecewise._results import EQUAL
from puma_septic.validation import Array

__all__ = ["Peaks", "Steps", "bounds", "find_peaks", "hidden", "ranges"]

Index = NDArray[np.int64]
Flags = NDArray[np.bool_]
# What the Taylor series leaves out is (pi / 4)^11 / 11! = 2e-9 of a middle coefficient, which of a resolved series is
# 1e-5 of the first; of a series of degree 7 on the least points 2e-13 of the last one.
_ORDER: Final = 10
_LEAST_POINTS: Final = 32
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
    level : ndarray, shape (k,)
        After each.
    """

    first: Array
    column: Index
    x: Array
    level: Array

    @property
    def before(self) -> Array:
        """The level before each."""
        return np.where(np.diff(self.column, prepend=-1) != 0, self.first[self.column], np.roll(self.level, 1))


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


def ranges(series: Array, oversampling: int = 8) -> tuple[Array, Array]:
    """Least and greatest of each series (degree + 1, c) at points, and certified bounds of both.

    As `bounds`, about the middle of what the points have.

    Returns
    -------
    inner, outer : ndarray, shape (2, c)
        Each side of `outer` is at most ``(1 / cos(pi / (2 oversampling)) - 1) / 2`` of the range beyond `inner`.

    Examples
    --------
    >>> inner, outer = ranges(np.array([[3.0], [0.0], [1.0]]))  # 3 + T_2
    >>> inner.ravel().tolist(), outer.ravel().round(3).tolist()
    ([2.0, 4.0], [1.98, 4.02])
    """
    degree = len(series) - 1
    if not degree:
        inner = np.stack([series[0]] * 2)
        return inner, inner
    values = matrices.values_matrix(degree, oversampling * degree) @ series
    inner = np.stack([values.min(axis=0), values.max(axis=0)])
    middle = inner.mean(axis=0)
    return inner, middle + (inner - middle) / cos(pi / (2 * oversampling))


def hidden(series: Array, cells: int) -> Array:
    """How far each series (degree + 1, c) can be beyond its values at ``cells + 1`` Chebyshev points, shape (c,)."""
    return np.asarray(np.arange(float(len(series))) ** 2 @ np.abs(series)) * ((pi / cells) ** 2 / 8)


class _Grid(NamedTuple):
    """Angles from pi to 0; T_k there, (degree + 1, points); its Taylor series half-way, (degree + 1, order + 1)."""

    theta: Array
    values: Array
    taylor: Array


@matrices.kept
def _grid(degree: int) -> _Grid:
    theta = np.linspace(pi, 0.0, max(degree, _LEAST_POINTS) + 1)
    k = np.arange(degree + 1.0)
    between = np.multiply.outer((theta[1:] + theta[:-1]) / 2, k)
    taylor = [np.cos(between + order * pi / 2) * (k**order / factorial(order)) for order in range(_ORDER + 1)]
    return _Grid(theta, np.cos(np.multiply.outer(k, theta)), np.stack(taylor, axis=2))


class _Sampled(NamedTuple):
    """Series as rows, (c, degree + 1), and with their steps at the points, (c, points); how much a cell may hide, (c,).

    Cells are numbered row by row, as are the steps'.
    """

    grid: _Grid
    rows: Array
    values: Array
    hidden: Array
    steps: Steps
    step_cell: Index

    @property
    def cells(self) -> int:
        """How many each row has."""
        return len(self.grid.theta) - 1


class _Found(NamedTuple):
    """Magnitudes, each with its series and its place."""

    column: Index
    x: Array
    size: Array


def find_peaks(series: Array, group: Index, count: int, steps: Steps | None = None) -> Peaks:
    """The largest magnitude within each group of series.

    Parameters
    ----------
    series : ndarray, shape (degree + 1, c)
        Resolved: beyond degree 16 the last coefficients are small, to 3e-6 of which the peaks are known.
    group : ndarray of int, shape (c,)
        From 0 to `count` - 1, each of which occurs.
    count : int
    steps : Steps, optional
        Added to the series.

    Returns
    -------
    Peaks
    """
    sampled = _sampled(series, steps)
    size = np.abs(sampled.values)
    top = size.argmax(axis=1)
    columns = np.arange(len(size))
    best = size[columns, top]
    known = _largest(best, group, count)
    beside, inside = _climbed(sampled, _cells(sampled, size, known[group]))
    known = np.maximum(known, _largest(beside.size, group[beside.column], count))
    found = [_Found(columns, np.cos(sampled.grid.theta[top]), best), beside, inside]
    bound = known + _largest(sampled.hidden, group, count)
    if steps is None:
        bound = np.minimum(bound, known / cos(pi * (len(series) - 1) / (2 * sampled.cells)))
    return _first_of_largest(_Found(*(np.concatenate(part) for part in zip(*found, strict=True))), group, known, bound)


def _largest(size: Array, group: Index, count: int) -> Array:
    largest = np.zeros(count)
    np.maximum.at(largest, group, size)
    return largest


def _first_of_largest(found: _Found, group: Index, at_points: Array, bound: Array) -> Peaks:
    """Of magnitudes that are equal, to rounding, the first one."""
    owner = group[found.column]
    largest = _largest(found.size, owner, len(at_points))
    equal = np.flatnonzero(found.size >= (largest * (1 - EQUAL))[owner])
    last_first = equal[np.lexsort((-found.x[equal], -found.column[equal]))]
    chosen = np.empty(len(at_points), dtype=np.int64)
    chosen[owner[last_first]] = last_first
    return Peaks(
        size=largest,
        column=found.column[chosen],
        x=found.x[chosen],
        at_points=at_points,
        bound=np.maximum(bound, largest),
    )


def _sampled(series: Array, steps: Steps | None) -> _Sampled:
    grid = _grid(len(series) - 1)
    rows = np.ascontiguousarray(series.T)
    values, between = rows @ grid.values, hidden(series, len(grid.theta) - 1)
    if steps is None:
        none, empty = np.empty(0, dtype=np.int64), np.empty(0)
        no_steps = Steps(first=np.zeros(len(rows)), column=none, x=empty, level=empty)
        return _Sampled(grid, rows, values, between, no_steps, none)
    cells = len(grid.theta) - 1
    place = np.searchsorted(-grid.theta, -np.arccos(steps.x), side="right") - 1
    cell = steps.column * cells + np.minimum(place, cells - 1)
    values += _levels(steps, cell, values.shape)
    return _Sampled(grid, rows, values, between, steps, cell)


def _levels(steps: Steps, cell: Index, shape: tuple[int, ...]) -> Array:
    """The step function at each point of the grid, as one repeated value from step to step."""
    columns, points = shape
    # Each row has one point more than cells: the point after a step is that of the following number.
    at = cell + steps.column + 1
    place = np.searchsorted(steps.column, np.arange(columns))
    starts = np.insert(at, place, np.arange(columns) * points)
    level = np.insert(steps.level, place, steps.first)
    return np.repeat(level, np.diff(starts, append=columns * points)).reshape(shape)


def _high_steps(sampled: _Sampled, known: Array) -> Index:
    """Steps beside which the largest magnitude may be.

    Before a step the smooth part has the level of the cell's first point, after it that of the last one; of several
    steps in a cell the others come on top.
    """
    steps, column, cell = sampled.steps, sampled.steps.column, sampled.step_cell
    if not len(column):
        return column
    first = np.flatnonzero(np.diff(cell, prepend=-1))
    size = steps.level - steps.before
    others = np.repeat(np.add.reduceat(np.abs(size), first), np.diff(first, append=len(cell))) - np.abs(size)
    flat = sampled.values.ravel()
    left, right = flat[cell + column], flat[cell + column + 1]
    upper = np.abs([left, right, left + size, right - size]).max(axis=0)
    return np.flatnonzero(upper + others + (sampled.hidden - known)[column] >= 0)


def _cells(sampled: _Sampled, size: Array, known: Array) -> Index:
    """Those within which the largest magnitude may be.

    Above the chord between two values a and b the series is at most a parabola of height `hidden`. Where a and b are
    four times as far apart, the sum is largest at one of them, and else it is at most
    ``(a + b) / 2 + hidden + (a - b)^2 / (16 hidden)``.
    """
    near = np.flatnonzero(np.maximum(size[:, 1:], size[:, :-1]) >= (known - sampled.hidden)[:, None])
    column = near // sampled.cells
    flat, hidden = size.ravel(), sampled.hidden[column]
    left, right = flat[near + column], flat[near + column + 1]
    apart = np.abs(left - right)
    may = (apart < 4 * hidden) & (16 * hidden * ((left + right) / 2 + hidden - known[column]) + apart**2 >= 0)
    high = _high_steps(sampled, known)
    if not len(high):
        return np.asarray(near[may])
    chosen = np.zeros(len(size) * sampled.cells, dtype=np.bool_)
    chosen[near[may]] = True
    chosen[sampled.step_cell[high]] = True
    return np.flatnonzero(chosen)


def _climbed(sampled: _Sampled, cells: Index) -> tuple[_Found, _Found]:
    """Magnitudes on both sides of steps, and the maximum inside each cell, or each part of one, where there is one."""
    column, cell = np.divmod(cells, sampled.cells)
    taylor, theta = _taylor_series(sampled, column, cell), sampled.grid.theta
    half, middle = (theta[0] - theta[1]) / 2, (theta[cell] + theta[cell + 1]) / 2
    level = sampled.values.ravel()[cells + column] - _taylor(taylor, np.full(len(cells), half))[0]
    part = _Parts(np.arange(len(cells)), np.full(len(cells), -half), np.full(len(cells), half))
    if len(sampled.steps.column):
        part, level = _split(part, level, cells, sampled)
    own = taylor[:, part.cell]
    own[0] += level

    def found(some: Index, delta: Array) -> _Found:
        at = part.cell[some]
        return _Found(column[at], np.cos(middle[at] + delta), np.abs(_taylor(own[:, some], delta)[0]))

    after, before = np.flatnonzero(part.high < half), np.flatnonzero(part.low > -half)
    ends = found(np.concatenate([after, before]), np.concatenate([part.high[after], part.low[before]]))
    own *= np.sign(_taylor(own, (part.low + part.high) / 2)[0])
    is_first, is_last = (cell == 0)[part.cell], (cell == sampled.cells - 1)[part.cell]
    at, inside = _highest(own, part, is_first & (part.high == half), is_last & (part.low == -half))
    return ends, found(inside, at)


def _taylor_series(sampled: _Sampled, column: Index, cell: Index) -> Array:
    """Of each series at the middle of its cell, (order + 1, cells); those of one cell by one product."""
    taylor = np.empty((len(cell), _ORDER + 1))
    order = np.argsort(cell, kind="stable")
    cuts = np.flatnonzero(np.diff(cell[order], prepend=-1)).tolist()
    for start, end in zip(cuts, [*cuts[1:], len(cell)], strict=True) if cuts else ():
        some = order[start:end]
        taylor[some] = sampled.rows[column[some]] @ sampled.grid.taylor[cell[some[0]]]
    return np.ascontiguousarray(taylor.T)


class _Parts(NamedTuple):
    """Parts of cells, from angle `high` down to `low` beside the middle."""

    cell: Index
    low: Array
    high: Array


def _split(part: _Parts, level: Array, cells: Index, sampled: _Sampled) -> tuple[_Parts, Array]:
    """Cells cut at the steps inside them, and the level of each part."""
    steps, theta = sampled.steps, sampled.grid.theta
    place = np.minimum(np.searchsorted(cells, sampled.step_cell), max(len(cells) - 1, 0))
    there = np.flatnonzero(cells[place] == sampled.step_cell) if len(cells) else place[:0]
    if not len(there):
        return part, level
    place, cell = place[there], sampled.step_cell[there] - steps.column[there] * sampled.cells
    delta = np.arccos(steps.x[there]) - (theta[cell] + theta[cell + 1]) / 2
    delta = np.clip(delta, part.low[place], part.high[place])
    # Each step ends the part before it and starts the next one of its cell.
    first = np.append(True, place[1:] != place[:-1])
    ends = np.where(np.append(first[1:], True), part.low[place], np.append(delta[1:], 0.0))
    low = part.low.copy()
    low[place[first]] = delta[first]
    before = np.repeat(steps.before[there][first], np.diff(np.flatnonzero(first), append=len(place)))
    parts = (
        np.concatenate([part.cell, place]),
        np.concatenate([low, ends]),
        np.concatenate([part.high, delta]),
    )
    return _Parts(*parts), np.concatenate([level, level[place] + steps.level[there] - before])


def _highest(series: Array, part: _Parts, is_first: Flags, is_last: Flags) -> tuple[Array, Index]:
    """Where each Taylor series is highest inside its part, and which parts hold such a place.

    The angle falls from a point to the following one. At both ends of an interval the slope by angle is zero: what
    rises from there bends upwards.
    """
    (_, start, bend), (_, end, last_bend) = _taylor(series, part.high), _taylor(series, part.low)
    rises = np.where(is_first, bend > 0, start < 0)
    falls = np.where(is_last, last_bend > 0, end > 0)
    inside = np.flatnonzero(rises & falls & (part.high > part.low))
    low, high, start, end = part.low[inside], part.high[inside], start[inside], end[inside]
    # Where the line between the slopes at both ends is zero.
    is_crossed = (end > 0) & (start < 0)
    share = np.where(is_crossed, end / np.where(is_crossed, end - start, 1.0), 0.5)
    return _climb(series[:, inside], low, high, low + share * (high - low)), inside


def _climb(series: Array, low: Array, high: Array, delta: Array) -> Array:
    """By Newton's method within brackets."""
    found, moving, near = delta, np.arange(len(low)), _LAST_STEP * (high - low)
    slopes = series[1:] * np.arange(1.0, len(series))[:, None]
    for _ in range(_MOST_STEPS):
        slope, bend = _value_and_slope(slopes, delta)
        up = slope > 0
        low, high = np.where(up, delta, low), np.where(up, high, delta)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = delta - slope / bend
        following = np.where((bend < 0) & (newton >= low) & (newton <= high), newton, (low + high) / 2)
        left = np.flatnonzero(np.abs(following - delta) > near)
        found[moving] = following
        if not len(left):
            break
        # Nearly all are found in a few steps: the others go on alone.
        moving, slopes, delta = moving[left], slopes[:, left], following[left]
        low, high, near = low[left], high[left], near[left]
    return np.asarray(found)


def _value_and_slope(series: Array, delta: Array) -> tuple[Array, Array]:
    """Of each power series (column) at its own place."""
    value, slope = series[-1] * delta, series[-1].copy()
    value += series[-2]
    for coefficient in series[-3::-1]:
        slope *= delta
        slope += value
        value *= delta
        value += coefficient
    return value, slope


def _taylor(series: Array, delta: Array) -> tuple[Array, Array, Array]:
    """Value, first and second derivative of each column at its own place."""
    value, slope, bend = series[-1], np.zeros_like(delta), np.zeros_like(delta)
    for coefficient in series[-2::-1]:
        bend = bend * delta + 2 * slope
        slope = slope * delta + value
        value = value * delta + coefficient
    return value, slope, bend
