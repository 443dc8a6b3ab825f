"""Extrema and sign changes of Chebyshev series, without eigenvalues, by bounds that hold everywhere between samples.

A series of low degree is looked at as it is; a longer one cell by cell, cells being the intervals between neighbours
of an over-sampled grid of Chebyshev-Lobatto points, ``x = cos(theta)``. By theta a series is a trigonometric polynomial
whose second derivative is at most ``sum k^2 |c_k|``, so that between two neighbours of M + 1 points it stays within
``(pi / M)^2 / 8`` times that of the straight line that joins them. A cell that cannot hold what is asked for by this
bound is not looked into.

In what is left, sign changes (of the series, or of its derivative for extrema) are isolated by Descartes' rule in
Bernstein's form: a polynomial changes its sign at most as often as its control values do, and exactly once where they
do once (Farouki 2012, The Bernstein polynomial basis: a centennial retrospective, CAGD 29, 379-419). A part with more
is halved by de Casteljau's subdivision until its control values are rounding, which has no sign. So no sign change and
no extremum is missed, however crowded, but for ripples within the rounding of the series.

Columns of the arrays below are the series of one interval and component each: interval by interval, then component.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise import matrices
from puma_septic.piecewise._results import EQUAL
from puma_septic.validation import Array

__all__ = ["find_extrema", "find_sign_changes", "sign_changes"]

Index = NDArray[np.int64]
Flags = NDArray[np.bool_]
_EPS = np.finfo(np.float64).eps
# Values that differ by less than EQUAL and are at most this part of an interval apart are of one peak: a motion that
# ends without acceleration and jerk is that near to its last position for some thousandths of its time.
_AROUND = 1e-2
# Values that differ by less than this part of the sum of |coefficients| are equal to rounding.
_ROUNDING = 64 * _EPS
# From where the chord of its bracket is zero, Newton needs three to five steps in all but a few of a thousand cases.
_NEWTON_STEPS = 6
# Newton within a bracket; bisection takes over where it leaves it, and 60 halvings exhaust a double.
_STEPS = 60
# A step of this part of the bracket is the last: Newton converges quadratically, what remains is rounding.
_LAST_STEP = 1e-9
# Degree up to which a series is taken as a whole, and of what stands for a longer one within a cell: a cell is at most
# pi / 4 of the shortest ripple's angle, so what is left out is below 2 (pi / 16)^11 / 11!, 1e-15 of the largest value.
_LOCAL = 10
# Control values of degree 10 are known to this many roundings of the sum of |coefficients|: Bernstein's form of T_10
# has values up to 733.
_CONTROL_ROUNDING = 1024 * _EPS
# Halvings after which sign changes are one: 1e-9 of the interval, closer than rounding tells double zeros apart.
_HALVINGS = 30
_EIGHTHS = np.linspace(-1.0, 1.0, 9)
# Values that are held at once: 16 MB.
_BLOCK = 1 << 21


def find_extrema(
    breaks: Array, coefficients: Array, turning: int = 0
) -> tuple[tuple[Array, Array], tuple[Array, Array], tuple[Array, ...]]:
    """((minima, their times), (maxima, their times), turns); of equal values, the first.

    Minima, maxima and their times have the shape (m,). `turns` are, for each of the first components, `turning` of
    them, the times inside the intervals at which its slope changes its sign: all, not those of extrema alone.
    """
    _, n, m = coefficients.shape
    series = coefficients.reshape(-1, n * m)
    size = np.abs(coefficients)
    total = size.sum(axis=0)
    scale = total.max(axis=0)
    equal = EQUAL * scale
    left, right = (matrices.signs(len(series) - 1) @ series).reshape(n, m), coefficients.sum(axis=0)
    low, high = np.minimum(left, right).min(axis=0), np.maximum(left, right).max(axis=0)
    ends = np.arange(n * m)
    found = [(ends, np.full(n * m, -1.0), left.ravel()), (ends, np.full(n * m, 1.0), right.ravel())]
    middle, spread = coefficients[0], total - size[0]
    wanted = (middle + spread > high - equal) | (middle - spread < low + equal) | (np.arange(m) < turning)
    slopes = matrices.derivative_matrix(len(series) - 1) @ series
    turning_at, turns = [np.empty(0, dtype=np.int64)], [np.empty(0)]
    for block in _blocks(np.flatnonzero(wanted.ravel() & _may_change_sign(slopes)), len(series) - 1):
        some = (series[:, block], slopes[:, block])
        candidates = _candidates(*some, block % m, low - _ROUNDING * scale, high + _ROUNDING * scale, turning)
        found += [(block[column], x, value) for column, x, value in candidates]
        if turning:
            at, x, _ = found[-1]
            turning_at.append(at % m)
            turns.append(_times(breaks, at // m, x))
    at, x, value = (np.concatenate(part) for part in zip(*found, strict=True))
    component, times = np.concatenate(turning_at), np.concatenate(turns)
    turned = tuple(times[component == j] for j in range(turning))
    places = (at % m, _times(breaks, at // m, x))
    around = _AROUND * float(np.diff(breaks).max())
    (least, t_least), greatest = (_highest(*places, signed, scale, around) for signed in (-value, value))
    return (-least, t_least), greatest, turned


def _highest(j: Index, times: Array, values: Array, total: Array, around: float) -> tuple[Array, Array]:
    """Maxima, and their times, of values of components j at times, of which all occur; `total` is their scale.

    Of peaks that are equal the first, and of what is `around` it the first that is the highest to rounding.
    """
    first, time = np.full((2, len(total)), np.inf)
    high, top = np.full((2, len(total)), -np.inf)
    np.maximum.at(high, j, values)
    equal = values >= (high - EQUAL * total)[j]
    j, times, values = j[equal], times[equal], values[equal]
    np.minimum.at(first, j, times)
    there = times <= (first + around)[j]
    np.maximum.at(top, j[there], values[there])
    there &= values >= (top - _ROUNDING * total)[j]
    np.minimum.at(time, j[there], times[there])
    return high, time


def find_sign_changes(breaks: Array, coefficients: Array) -> tuple[Array, ...]:
    """Times of the sign changes inside the intervals, one sorted array per component."""
    _, n, m = coefficients.shape
    series = coefficients.reshape(-1, n * m)
    column, x = sign_changes(series)
    joint, roots = column % m, _times(breaks, column // m, x)
    return tuple(np.sort(roots[joint == j]) for j in range(m))


def sign_changes(series: Array) -> tuple[Index, Array]:
    """Column and x of every sign change of many series (degree + 1, c) inside (-1, 1)."""
    columns = np.flatnonzero(_may_change_sign(series))
    at, places = [np.empty(0, dtype=np.int64)], [np.empty(0)]
    for block in _blocks(columns, len(series) - 1):
        some = series[:, block]
        cells = _eighths(some) if len(some) <= _LOCAL + 1 else _cells_with_zeros(some)
        column, x = _sign_changes(some, cells)
        at.append(block[column])
        places.append(x)
    return np.concatenate(at), np.concatenate(places)


def _may_change_sign(series: Array) -> Flags:
    """Whether the other coefficients of each column outweigh the first."""
    size = np.abs(series)
    total = size.sum(axis=0)
    may: Flags = (2 * size[0] <= total) & (total > 0)
    return may


def _blocks(columns: Index, degree: int) -> Iterator[Index]:
    """Columns in blocks whose control values or grid fit into memory."""
    count = max(1, _BLOCK // (_LOCAL + 1 if degree <= _LOCAL else len(matrices.grid(degree))))
    return (columns[k : k + count] for k in range(0, len(columns), count))


class _Cells(NamedTuple):
    """Parts [left, right] of [-1, 1] of some columns, with the control values (degree + 1, k) of the series there."""

    column: Index
    left: Array
    right: Array
    control: Array

    def some(self, which: Flags | Index) -> _Cells:
        return _Cells(self.column[which], self.left[which], self.right[which], self.control[:, which])

    def ends(self, which: Flags | Index | slice) -> _Cells:
        """Some of them, with no more than the values at both ends."""
        return _Cells(
            self.column[which], self.left[which], self.right[which], self.control[:: len(self.control) - 1, which]
        )

    def halves(self) -> _Cells:
        """Each as two, by de Casteljau's subdivision."""
        middle = (self.left + self.right) / 2
        lower, upper = matrices.bernstein_halves(len(self.control) - 1)
        return _Cells(
            np.concatenate([self.column] * 2),
            np.concatenate([self.left, middle]),
            np.concatenate([middle, self.right]),
            np.concatenate([lower @ self.control, upper @ self.control], axis=1),
        )


def _eighths(series: Array) -> _Cells:
    """Each column of a low degree in eight cells."""
    parts = matrices.bernstein_eighths(len(series) - 1) @ series
    number = np.arange(8 * series.shape[1])
    column, part = number // 8, number % 8
    return _Cells(column, _EIGHTHS[part], _EIGHTHS[part + 1], parts.transpose(1, 2, 0).reshape(len(series), -1))


def _cells_of(series: Array, column: Index, k: Index, grid: int) -> _Cells:
    """Cells k of a grid of that many points: the polynomial of degree `_LOCAL` that stands for the series there."""
    nodes = matrices.nodes(grid - 1)
    left, right = nodes[k], nodes[k + 1]
    x = ((1 - matrices.nodes(_LOCAL)[:, None]) * left + (1 + matrices.nodes(_LOCAL)[:, None]) * right) / 2
    values, step = np.empty_like(x), max(1, _BLOCK // (len(series) * len(x)))
    for start in range(0, len(column), step):
        some = slice(start, start + step)
        basis = matrices.basis_at(x[:, some], len(series) - 1)
        values[:, some] = (basis * series[:, None, column[some]]).sum(axis=0)
    to_control = matrices.to_bernstein_matrix(_LOCAL) @ matrices.coefficients_from_values(_LOCAL)
    return _Cells(column, left, right, to_control @ values)


def _hidden(series: Array, grid: int) -> Array:
    """How far each column may rise above, or fall below, its values at both ends of a cell of a grid of that many."""
    step = np.pi / (grid - 1)
    return np.asarray(np.arange(len(series)) ** 2 @ np.abs(series) * (step**2 / 8))


def _may_vanish(series: Array, values: Array) -> Flags:
    """Whether each cell of the grid on which a series has these values may hold a zero, (cells, columns)."""
    # A value beyond what is hidden has the sign of its neighbours, or theirs is beyond it on the other side.
    hidden = _hidden(series, len(values))
    up, down = values > hidden, values < -hidden
    return ~((up[:-1] & up[1:]) | (down[:-1] & down[1:]))


def _cells_with_zeros(series: Array) -> _Cells:
    """The cells of the grid that may hold a zero."""
    values = matrices.grid(len(series) - 1) @ series
    column, k = np.nonzero(_may_vanish(series, values).T)
    return _cells_of(series, column, k, len(values))


def _candidates(
    series: Array, slopes: Array, j: Index, low: Array, high: Array, turning: int
) -> Iterator[tuple[Index, Array, Array]]:
    """(column, x, value) of points that may be extreme: those of the grid, if there is one, then the turning points.

    Column i belongs to component j[i] with these bounds; of components below `turning` all turning points.
    """
    if len(slopes) <= _LOCAL + 1:
        cells = _eighths(slopes)
    else:
        values = matrices.grid(len(series) - 1) @ series
        low, high = low.copy(), high.copy()
        np.minimum.at(low, j, values.min(axis=0))
        np.maximum.at(high, j, values.max(axis=0))
        hidden = _hidden(series, len(values))
        extreme = (values > high[j] - hidden) | (values < low[j] + hidden)
        wanted = extreme[:-1] | extreme[1:]
        if turning:
            at_grid = matrices.values_matrix(len(slopes) - 1, len(values) - 1) @ slopes
            wanted |= _may_vanish(slopes, at_grid) & (j < turning)
        column, k = np.nonzero(wanted.T)
        cells = _cells_of(slopes, column, k, len(values))
        yield column, cells.left, values[k, column]
    column, x = _sign_changes(slopes, cells)
    yield column, x, _values_at(series[:, column], x)


def _sign_changes(series: Array, cells: _Cells) -> tuple[Index, Array]:
    """Column and x of each sign change in the cells; what is rounding of a series has no sign."""
    if len(series) < 2 or not len(cells.column):
        return np.empty(0, dtype=np.int64), np.empty(0)
    cells, before, after = _isolated(cells, _CONTROL_ROUNDING * np.abs(series).sum(axis=0))
    inside = np.flatnonzero(before != after)
    column, bracket = cells.column[inside], np.array([cells.left[inside], cells.right[inside]])
    at_ends, sign = cells.control[:, inside], np.array([before[inside], after[inside]])
    values = np.where(at_ends * sign > 0, at_ends, sign)
    first, second = _across(cells, before, after)
    if len(first):
        middle = (cells.left + cells.right) / 2
        column = np.concatenate([column, cells.column[first]])
        bracket = np.concatenate([bracket, [middle[first], middle[second]]], axis=1)
        values = np.concatenate([values, [after[first], before[second]]], axis=1)
    return column, _zeros(series[:, column], bracket, values)


def _across(cells: _Cells, before: Array, after: Array) -> tuple[Index, Index]:
    """Pairs of cells between which a sign changes, across others of the same column that are rounding.

    Rounding has no sign: it changes between the last part that has one and the next, if they are not far apart.
    """
    joined = (cells.column[1:] == cells.column[:-1]) & (cells.left[1:] == cells.right[:-1])
    if not (joined & (after[:-1] != before[1:])).any():
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    run, signed = np.cumsum(np.append(True, ~joined)), np.flatnonzero(after)
    first, second = signed[:-1], signed[1:]
    across = (run[first] == run[second]) & (after[first] != before[second])
    return first[across], second[across]


def _isolated(cells: _Cells, noise: Array) -> tuple[_Cells, Array, Array]:
    """Cells with at most one sign change, in order, and the signs with which each begins and ends; 0 for rounding.

    Of their control values those at both ends are left.
    """
    done: list[tuple[_Cells, Array, Array]] = []
    for halving in range(_HALVINGS + 1):
        least = noise[cells.column]
        positive, negative = (cells.control > least).any(axis=0), (cells.control < -least).any(axis=0)
        after = np.subtract(positive, negative, dtype=np.float64)
        before = after.copy()
        mixed = np.flatnonzero(positive & negative)
        changes, last, sure = _changes(cells.control[:, mixed], least[mixed])
        before[mixed], after[mixed] = np.where(changes % 2, -last, last), last
        # Between ends that have a sign one change is one; beside a touched zero a control value may overshoot.
        crowded = mixed[~((changes == 1) & sure)]
        if not len(crowded) or halving == _HALVINGS:
            done.append((cells.ends(slice(None)), before, after))
            break
        few = np.ones(len(after), dtype=np.bool_)
        few[crowded] = False
        done.append((cells.ends(few), before[few], after[few]))
        cells = cells.some(crowded).halves()
    if len(done) == 1:
        return done[0]
    cells = _Cells(*(np.concatenate(field, axis=-1) for field in zip(*(part for part, *_ in done), strict=True)))
    order = np.lexsort((cells.left, cells.column))
    before, after = (np.concatenate([ends[k] for _, *ends in done])[order] for k in (0, 1))
    return cells.some(order), before, after


def _changes(control: Array, noise: Array) -> tuple[Index, Array, Flags]:
    """How often the control values of each cell change sign, the last sign, and whether both ends have one."""
    signs = np.subtract(control > noise, control < -noise, dtype=np.float64)
    sure = (signs[0] != 0) & (signs[-1] != 0)
    if not signs.all():
        # Each control value has the sign of the last one, up to it, that has a sign.
        known = np.maximum.accumulate(np.where(signs != 0, np.arange(len(signs))[:, None], 0), axis=0)
        signs = signs[known, np.arange(signs.shape[1])]
    return np.count_nonzero(signs[1:] * signs[:-1] < 0, axis=0), signs[-1], sure


def _zeros(series: Array, bracket: Array, values: Array) -> Array:
    """The only zero of each series (column) in its bracket (2, k), from values of opposite sign (2, k) at its ends.

    Newton's method from where the chord is zero; where that does not converge within the bracket, Newton and bisection.
    """
    if not series.shape[1]:
        return np.empty(0)
    both = (matrices.state_matrix(len(series) - 1, 1) @ series).reshape(2, *series.shape)
    left, right = bracket
    x = (left * values[1] - right * values[0]) / (values[1] - values[0])
    x = np.minimum(np.maximum(x, left), right)
    near = _LAST_STEP * (right - left)
    places, moving = x, np.arange(len(x))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # a slope of zero is left to bisection
        for _ in range(_NEWTON_STEPS):
            value, slope = _value_and_slope(both, x)
            step = value / slope
            x = np.minimum(np.maximum(x - step, left), right)
            found = np.abs(step) <= near
            places[moving] = x
            if found.all():
                break
            on = np.flatnonzero(~found)
            # Nearly all are found in three steps: the others go on alone.
            if 2 * len(on) < len(moving):
                moving, both, x, left, right, near = moving[on], both[:, :, on], x[on], left[on], right[on], near[on]
                on = np.arange(len(on))
        else:
            places[moving[on]] = _bisected(both[:, :, on], left[on], right[on], values[1, moving[on]] > 0)
    return np.asarray(places)


def _value_and_slope(both: Array, x: Array) -> Array:
    """Of series and their derivatives (2, degree + 1, k), each at its own point, shape (2, k)."""
    return np.asarray((both * matrices.basis_at(x, both.shape[1] - 1)).sum(axis=1))


def _bisected(both: Array, left: Array, right: Array, rising: Flags) -> Array:
    """The zeros, by Newton's method within brackets that shrink, and bisection where it leaves them."""
    noise, near = _EPS * np.abs(both[0]).sum(axis=0), _LAST_STEP * (right - left)
    x = (left + right) / 2
    for _ in range(_STEPS):
        value, slope = _value_and_slope(both, x)
        beyond = (value > 0) == rising
        left, right = np.where(beyond, left, x), np.where(beyond, x, right)
        newton = x - value / slope
        following = np.where((newton >= left) & (newton <= right), newton, (left + right) / 2)
        following = np.where(np.abs(value) <= noise, x, following)
        moving = np.abs(following - x) > near
        x = following
        if not moving.any():
            break
    return np.asarray(x)


def _values_at(series: Array, x: Array) -> Array:
    """Value of each series (column) at its own point."""
    return np.asarray((matrices.basis_at(x, len(series) - 1) * series).sum(axis=0))


def _times(breaks: Array, piece: Index, x: Array) -> Array:
    """Times of points x in [-1, 1] of the given intervals; the ends come out exactly."""
    return np.asarray((breaks[piece] * (1 - x) + breaks[piece + 1] * (1 + x)) / 2)
