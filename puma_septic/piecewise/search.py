"""Extrema and sign changes of Chebyshev series: bracket on an over-sampled grid, polish by Newton.

The grid's values and slopes come from one matrix product. A cell, the interval between two grid points, is looked
into only where it can hold what is asked for. Arrays over the grid are addressed by flat indices: point by point,
then interval, then component.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from puma_septic.checks import Array
from puma_septic.piecewise import matrices

__all__ = ["find_extrema", "find_sign_changes"]

Index = NDArray[np.int64]
Flags = NDArray[np.bool_]
# A value below this part of the sum of |coefficients| is rounding, and has no sign.
_ROUNDING = 64 * np.finfo(np.float64).eps
# Newton from a cell of a twofold grid converges in two to four steps; what has not is bracketed and bisected as well.
_NEWTON_STEPS = 6
_BISECTION_STEPS = 60
# Newton converges quadratically: after a step of this part of the cell, what remains is rounding.
_LAST_STEP = 1e-9


def find_extrema(breaks: Array, coefficients: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """((minima, their times), (maxima, their times)), each of shape (m,); of values equal to rounding, the first.

    Critical points so crowded that several share a cell, at most 1/40 of the interval wide, are taken for one.
    """
    _, n, m = coefficients.shape
    values, slopes = _on_grid(coefficients)
    low, high = values.reshape(-1, m).min(axis=0), values.reshape(-1, m).max(axis=0)
    equal = _ROUNDING * np.abs(coefficients).sum(axis=0).max(axis=0)
    at, x = _critical_points(coefficients, values, slopes, low - equal, high + equal)
    found = _values_at(coefficients.reshape(-1, n * m)[:, at % (n * m)], x)
    np.minimum.at(low, at % m, found)
    np.maximum.at(high, at % m, found)
    # The grid's points that are extreme, and those found: the first of them.
    extreme = np.flatnonzero((values <= np.tile(low + equal, n)) | (values >= np.tile(high - equal, n)))
    value = np.concatenate([found, values.take(extreme)])
    at, x = np.concatenate([at, extreme]), np.concatenate([x, matrices.nodes(len(values) - 1)[extreme // (n * m)]])
    times, j = _times(breaks, at // m % n, x), at % m
    t_low, t_high = np.full((2, m), np.inf)
    np.minimum.at(t_low, j, np.where(value <= (low + equal)[j], times, np.inf))
    np.minimum.at(t_high, j, np.where(value >= (high - equal)[j], times, np.inf))
    return (low, t_low), (high, t_high)


def _on_grid(coefficients: Array) -> tuple[Array, Array]:
    """Values and slopes by x at the grid of each interval, each of shape (points, n * m)."""
    both = matrices.grid(len(coefficients) - 1) @ coefficients.reshape(len(coefficients), -1)
    return both[: len(both) // 2], both[len(both) // 2 :]


def _critical_points(coefficients: Array, values: Array, slopes: Array, low: Array, high: Array) -> tuple[Index, Array]:
    """Flat indices (k,) of cells with an extremum that may lie beyond the bounds, and its x."""
    columns, m = values.shape[1], len(low)
    rising = slopes > 0
    at = np.flatnonzero(rising[:-1] != rising[1:])
    v, s = _at_both_ends(values, at), _at_both_ends(slopes, at)
    x = matrices.nodes(len(values) - 1)
    k, j = at // columns, at % m
    # Between the tangents at both ends, with room to spare where the curve is not convex.
    room = (np.abs(s[0]) + np.abs(s[1])) * (x[k + 1] - x[k]) / 2
    wanted = (np.maximum(v[0], v[1]) + room > high[j]) | (np.minimum(v[0], v[1]) - room < low[j])
    at, k = at[wanted], k[wanted]
    series = coefficients.reshape(len(coefficients), -1)[:, at % columns]
    slope_series = matrices.derivative_matrix(len(series) - 1) @ series
    # A slope that is rounding at an end, as at rest, is zero there, not inside; the grid has the value.
    inside = np.abs(s[:, wanted]).min(axis=0) > _ROUNDING * np.abs(slope_series).sum(axis=0)
    at, k, s = at[inside], k[inside], s[:, wanted][:, inside]
    return at, _zeros(slope_series[:, inside], np.array([x[k], x[k + 1]]), s)


def _at_both_ends(values: Array, at: Index) -> Array:
    """Values at both ends of cells with the given flat indices, shape (2, k)."""
    return np.array([values.take(at), values.take(at + values.shape[1])])


def _zeros(series: Array, cell: Array, ends: Array) -> Array:
    """The zero of each series (column) in a cell (2, k), at the ends of which the values `ends` differ in sign."""
    if not series.shape[1]:
        return np.empty(0)
    slope_series = matrices.derivative_matrix(len(series) - 1) @ series
    width = cell[1] - cell[0]
    x = cell[0] - width * ends[0] / (ends[1] - ends[0])
    # An end that is a zero itself is not the one that is looked for, but would attract Newton.
    unsure = np.minimum(np.abs(ends[0]), np.abs(ends[1])) <= _ROUNDING * np.abs(series).sum(axis=0)
    for _ in range(_NEWTON_STEPS):
        value, slope = _value_and_slope(series, slope_series, x)
        step = value / slope
        x = np.minimum(np.maximum(x - step, cell[0]), cell[1])
        moving = np.abs(step) > _LAST_STEP * width
        if not moving.any():
            break
    unsure |= moving
    if unsure.any():
        some = (series[:, unsure], slope_series[:, unsure], cell[:, unsure])
        x[unsure] = _bisected_zeros(*some, ends[1, unsure] > 0)
    return np.asarray(x)


def _bisected_zeros(series: Array, slope_series: Array, cell: Array, rising: Flags) -> Array:
    """As `_zeros`, by Newton within a bracket that every step narrows; bisection where Newton leaves it."""
    noise = _ROUNDING / 16 * np.abs(series).sum(axis=0)
    left, right = cell
    x = (left + right) / 2
    for _ in range(_BISECTION_STEPS):
        value, slope = _value_and_slope(series, slope_series, x)
        beyond = (value > 0) == rising
        left, right = np.where(beyond, left, x), np.where(beyond, x, right)
        newton = x - value / slope
        following = np.where((newton > left) & (newton < right), newton, (left + right) / 2)
        found = np.abs(value) <= noise
        x = np.where(found, x, following)
        if found.all():
            break
    return np.asarray(x)


def _value_and_slope(series: Array, slope_series: Array, x: Array) -> tuple[Array, Array]:
    """Value and slope of each series (column) at its own point; a slope of zero is made a tiny one."""
    basis = matrices.basis_at(x, len(series) - 1)
    slope = (basis[: len(slope_series)] * slope_series).sum(axis=0)
    slope[slope == 0] = np.finfo(np.float64).tiny ** 0.5
    return (basis * series).sum(axis=0), slope


def _values_at(series: Array, x: Array) -> Array:
    """Value of each series (column) at its own point."""
    return np.asarray(np.einsum("dk,dk->k", matrices.basis_at(x, len(series) - 1), series))


def find_sign_changes(breaks: Array, coefficients: Array) -> tuple[Array, ...]:
    """Times of the sign changes inside the intervals, one sorted array per component."""
    _, n, m = coefficients.shape
    series = coefficients.reshape(len(coefficients), -1)
    values, slopes = _on_grid(coefficients)
    values, sign = _with_signs(values, slopes, _ROUNDING * np.abs(series).sum(axis=0))
    columns, x = n * m, matrices.nodes(len(values) - 1)
    product = sign[:-1] * sign[1:]
    first = np.flatnonzero(product < 0)
    first, last = np.concatenate([np.array([first, first + columns]), _around_zeros(sign)], axis=1)
    dips, bottoms, depths = _dips(series, values, slopes, sign, product)
    cell, after = x[dips // columns], dips + columns
    at = np.concatenate([first, dips, dips])
    left = np.concatenate([x[first // columns], cell, bottoms])
    right = np.concatenate([x[last // columns], bottoms, x[after // columns]])
    at_left = np.concatenate([values.take(first), values.take(dips), depths])
    at_right = np.concatenate([values.take(last), depths, values.take(after)])
    zeros = _zeros(series[:, at % columns], np.array([left, right]), np.array([at_left, at_right]))
    roots = _times(breaks, at // m % n, zeros)
    return tuple(np.sort(roots[at % m == j]) for j in range(m))


def _with_signs(values: Array, slopes: Array, noise: Array) -> tuple[Array, Array]:
    """Values at the grid, and their signs, 0 where a value is rounding.

    Where the slope there tells a crossing from a double zero, the point is taken as just beyond the crossing (before
    it, if it is the last), so that a second root next to it is seen.
    """
    sign = np.sign(values) * (np.abs(values) > noise)
    zero = np.flatnonzero(sign == 0)
    if not len(zero):
        return values, sign
    last, columns = len(values) - 1, values.shape[1]
    k, j = zero // columns, zero % columns
    before, after = np.maximum(k - 1, 0), np.minimum(k + 1, last)
    x = matrices.nodes(last)
    slope, width, noise = slopes[k, j], x[after] - x[before], noise[j]
    bend = np.abs(slopes[after, j] - slopes[before, j]) / width
    # A parabola with this slope and curvature, through zero here, is as deep as slope^2 / (2 bend).
    crosses = (slope**2 > 4 * noise * bend) & (np.abs(slope) * width > 4 * noise)
    sign[k, j] = np.where(crosses, np.where(k == last, -1.0, 1.0) * np.sign(slope), 0.0)
    values[k, j] = sign[k, j] * noise
    return values, sign


def _around_zeros(sign: Array) -> Index:
    """First and last point, as flat indices (2, k), of runs that are zero to rounding but for ends of opposite sign.

    A run at an interval's end, as of a double zero at rest, is between nothing and is left out.
    """
    columns = sign.shape[1]
    runs = []
    if sign[1:-1].all():
        return np.empty((2, 0), dtype=np.int64)
    for k, column in np.argwhere((sign[1:] == 0) & (sign[:-1] != 0)):
        after = np.flatnonzero(sign[k + 1 :, column])
        if len(after) and sign[k + 1 + after[0], column] * sign[k, column] < 0:
            runs.append([k * columns + column, (k + 1 + after[0]) * columns + column])
    return np.array(runs, dtype=np.int64).reshape(-1, 2).T


def _dips(series: Array, values: Array, slopes: Array, sign: Array, product: Array) -> tuple[Index, Array, Array]:
    """Cells in which a component dips through zero and back: flat index, x of the bottom, value there."""
    outwards = sign * slopes
    at = np.flatnonzero((outwards[:-1] < 0) & (outwards[1:] > 0) & (product > 0))
    x, columns = matrices.nodes(len(values) - 1), values.shape[1]
    cell = x[np.array([at, at + columns]) // columns]
    (a, b), (p, q) = np.abs(_at_both_ends(values, at)), np.abs(_at_both_ends(slopes, at))
    # Where the curve is convex it lies beyond its tangents, which meet at this over (p + q); half is left for where
    # it is not quite.
    lowest = a * q + b * p - p * q * (cell[1] - cell[0])
    near = lowest < np.minimum(a, b) * (p + q) / 2
    at, cell = at[near], cell[:, near]
    if not len(at):
        return at, np.empty(0), np.empty(0)
    some = series[:, at % columns]
    bottoms = _zeros(matrices.derivative_matrix(len(some) - 1) @ some, cell, _at_both_ends(slopes, at))
    depths = _values_at(some, bottoms)
    through = depths * sign.take(at) < -_ROUNDING * np.abs(some).sum(axis=0)
    return at[through], bottoms[through], depths[through]


def _times(breaks: Array, piece: Index, x: Array) -> Array:
    """Times of points x in [-1, 1] of the given intervals; the ends come out exactly."""
    return (breaks[piece] * (1 - x) + breaks[piece + 1] * (1 + x)) / 2
