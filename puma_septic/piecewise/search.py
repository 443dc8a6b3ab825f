"""Extrema and sign changes of Chebyshev series, without eigenvalues.

On Chebyshev-Lobatto points, ``x = cos(theta)``, a series of degree n is a trigonometric polynomial of theta. Its second
derivative is at most ``n^2 A`` where A bounds its magnitude (Bernstein), and at most ``sum k^2 |c_k|``, so between two
neighbours of M + 1 points it stays within that times ``(pi / M)^2 / 8`` of the straight line that joins them; and
``A <= max over the points / cos(n pi / (2 M))`` (Ehlich and Zeller 1964, Mathematische Zeitschrift 86, 41-44). A cell,
the interval between two neighbours, that cannot hold what is asked for by these bounds is not looked into. That is
proved, not sampled.

The same bounds on the first two derivatives by theta prove most of the other cells to be monotone, or to hold one
critical point. What is left is split at the zeros of the third, then second, then first derivative (each is monotone
between the zeros of the one above it), so that up to three critical points or four sign changes in one cell are told
apart. A cell is at most 1/10 of the interval and a quarter of the shortest ripple that the degree allows.

Columns of the arrays below are the series of one interval and component each: interval by interval, then component.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise import matrices
from puma_septic.validation import Array

__all__ = ["find_extrema", "find_sign_changes"]

Index = NDArray[np.int64]
Flags = NDArray[np.bool_]
# A value below this part of the sum of |coefficients| is rounding, and has no sign.
_ROUNDING = 64 * np.finfo(np.float64).eps
# Newton within a bracket; bisection takes over where it leaves it, and 60 halvings exhaust a double.
_STEPS = 60
# A step of this part of the bracket is the last: Newton converges quadratically, what remains is rounding.
_LAST_STEP = 1e-9
# Values on the grid that are held at once: 16 MB.
_BLOCK = 1 << 21


def find_extrema(breaks: Array, coefficients: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """((minima, their times), (maxima, their times)), each of shape (m,); of values equal to rounding, the first."""
    _, n, m = coefficients.shape
    series = coefficients.reshape(-1, n * m)
    size = np.abs(coefficients)
    equal = _ROUNDING * size.sum(axis=0).max(axis=0)
    left, right = np.tensordot(matrices.signs(len(series) - 1), coefficients, 1), coefficients.sum(axis=0)
    low, high = np.minimum(left, right).min(axis=0), np.maximum(left, right).max(axis=0)
    ends = np.arange(n * m)
    found = [(ends, np.full(n * m, -1.0), left.ravel()), (ends, np.full(n * m, 1.0), right.ravel())]
    spread = size[1:].sum(axis=0)
    columns = np.flatnonzero((coefficients[0] + spread > high - equal) | (coefficients[0] - spread < low + equal))
    for block in _blocks(columns, len(series) - 1):
        at, x, value = _candidates(series, block, low - equal, high + equal)
        np.minimum.at(low, at % m, value)
        np.maximum.at(high, at % m, value)
        found.append((at, x, value))
    at, x, value = (np.concatenate(part) for part in zip(*found, strict=True))
    extreme = (value <= (low + equal)[at % m]) | (value >= (high - equal)[at % m])
    at, x, value = at[extreme], x[extreme], value[extreme]
    times, j = _times(breaks, at // m, x), at % m
    t_low, t_high = np.full((2, m), np.inf)
    np.minimum.at(t_low, j, np.where(value <= (low + equal)[j], times, np.inf))
    np.minimum.at(t_high, j, np.where(value >= (high - equal)[j], times, np.inf))
    return (low, t_low), (high, t_high)


def find_sign_changes(breaks: Array, coefficients: Array, noise: Array | None = None) -> tuple[Array, ...]:
    """Times of the sign changes inside the intervals, one sorted array per component.

    Values within `noise`, shape (n, m), have no sign; by default that is each series' own rounding.
    """
    _, n, m = coefficients.shape
    series = coefficients.reshape(-1, n * m)
    size = np.abs(series)
    noise = _ROUNDING * size.sum(axis=0) if noise is None else noise.reshape(-1)
    columns = np.flatnonzero(size[0] <= size[1:].sum(axis=0))
    at, times = [np.empty(0, dtype=np.int64)], [np.empty(0)]
    for block in _blocks(columns, len(series) - 1):
        column, x = _sign_changes(series[:, block], noise[block])
        at.append(block[column])
        times.append(_times(breaks, block[column] // m, x))
    joint, roots = np.concatenate(at) % m, np.concatenate(times)
    return tuple(np.sort(roots[joint == j]) for j in range(m))


def _blocks(columns: Index, degree: int) -> Iterator[Index]:
    """Columns in blocks whose grid fits into memory."""
    count = max(1, _BLOCK // len(matrices.grid(degree)))
    return (columns[k : k + count] for k in range(0, len(columns), count))


def _hidden(series: Array, values: Array) -> Array:
    """How far each column may rise above, or fall below, its values at both ends of a cell of the grid."""
    degree, step = len(series) - 1, np.pi / (len(values) - 1)
    magnitude = np.abs(values).max(axis=0) / np.cos(degree * step / 2)
    curvature = np.arange(degree + 1.0) ** 2 @ np.abs(series)
    return np.asarray(np.minimum(degree**2 * magnitude, curvature) * (step**2 / 8))


def _candidates(series: Array, block: Index, low: Array, high: Array) -> tuple[Index, Array, Array]:
    """(column, x, value) of grid points and critical points that may lie beyond the bounds of their component."""
    m, some = len(low), series[:, block]
    values = matrices.grid(len(some) - 1) @ some
    j = block % m
    low, high = np.minimum(low, _least(values, j, m)), np.maximum(high, -_least(-values, j, m))
    hidden = _hidden(some, values)
    up, down = np.maximum(values[:-1], values[1:]), np.minimum(values[:-1], values[1:])
    k, column = np.nonzero((up > (high[j] - hidden)) | (down < (low[j] + hidden)))
    cell, points, value = _split_at_critical_points(some, column, k)
    return block[column[cell]], points, value


def _least(values: Array, j: Index, m: int) -> Array:
    """Least value of each component over its columns, shape (m,)."""
    least = np.full(m, np.inf)
    np.minimum.at(least, j, values.min(axis=0))
    return least


def _sign_changes(series: Array, noise: Array) -> tuple[Index, Array]:
    """Column and x of each sign change."""
    values = matrices.grid(len(series) - 1) @ series
    near = np.minimum(np.abs(values[:-1]), np.abs(values[1:])) <= _hidden(series, values)
    k, column = np.nonzero((near | (values[:-1] * values[1:] < 0)).T)[::-1]
    cell, points, value = _split_at_critical_points(series, column, k)
    column = column[cell]
    # Rounding has no sign: a sign changes between the last point that has one and the next, however far apart.
    signed = np.abs(value) > noise[column]
    column, points, value = column[signed], points[signed], value[signed]
    first = np.flatnonzero((column[1:] == column[:-1]) & (np.sign(value[1:]) != np.sign(value[:-1])))
    bracket = np.array([points[first], points[first + 1]])
    return column[first], _zeros(series[:, column[first]], bracket, np.array([value[first], value[first + 1]]))


def _split_at_critical_points(series: Array, column: Index, k: Index) -> tuple[Index, Array, Array]:
    """Cells k of the given columns, split where they stop being monotone: (number of the cell, x, value), in order."""
    monotone, single = _sorted_out(series, column, k)
    nodes = matrices.nodes(len(matrices.grid(len(series) - 1)) - 1)
    cell, x = np.repeat(np.arange(len(k)), 2), np.column_stack([nodes[k], nodes[k + 1]]).ravel()
    derivatives = [series]
    for _ in range(3):
        derivatives.append(matrices.derivative_matrix(len(derivatives[-1]) - 1) @ derivatives[-1])
    for order, skipped in ((3, monotone | single), (2, monotone | single), (1, monotone)):
        if skipped.all():
            continue
        some = np.flatnonzero(~skipped[cell])
        value = np.zeros(len(cell))
        value[some] = _values_at(derivatives[order][:, column[cell[some]]], x[some])
        between = np.flatnonzero((cell[1:] == cell[:-1]) & (value[:-1] * value[1:] < 0))
        bracket, ends = np.array([x[between], x[between + 1]]), np.array([value[between], value[between + 1]])
        zeros = _zeros(derivatives[order][:, column[cell[between]]], bracket, ends)
        x, cell = np.insert(x, between + 1, zeros), np.insert(cell, between + 1, cell[between])
    return cell, x, _values_at(series[:, column[cell]], x)


def _sorted_out(series: Array, column: Index, k: Index) -> tuple[Flags, Flags]:
    """Which cells certainly hold no critical point inside, and which certainly hold one: by theta, as in `_hidden`."""
    some, order = series[:, column], np.arange(len(series), dtype=np.float64)
    to_slopes, to_values = matrices.grid_slopes(len(series) - 1), matrices.grid(len(series) - 1)
    room = (np.pi / (len(to_values) - 1)) ** 2 / 8
    hidden_slope, hidden_bend = (room * (order**power @ np.abs(series))[column] for power in (3, 4))
    slope = np.array([np.einsum("kd,dk->k", to_slopes[end], some) for end in (k, k + 1)])
    bend = np.array([np.einsum("kd,dk->k", to_values[end], some * order[:, None] ** 2) for end in (k, k + 1)])
    turns = slope[0] * slope[1] < 0
    steep = ~turns & (np.abs(slope).min(axis=0) > hidden_slope)
    bent = (bend[0] * bend[1] > 0) & (np.abs(bend).min(axis=0) > hidden_bend)
    return steep | (bent & ~turns), bent & turns


def _zeros(series: Array, bracket: Array, ends: Array) -> Array:
    """The zero of each series (column) in its bracket (2, k), at whose ends its values `ends` differ in sign."""
    if not series.shape[1]:
        return np.empty(0)
    slope_series = matrices.derivative_matrix(len(series) - 1) @ series
    noise = _ROUNDING / 8 * np.abs(series).sum(axis=0)
    (left, right), rising = bracket, ends[1] > 0
    x = left + (right - left) * (ends[0] / (ends[0] - ends[1]))
    for _ in range(_STEPS):
        value, slope = _value_and_slope(series, slope_series, x)
        beyond = (value > 0) == rising
        left, right = np.where(beyond, left, x), np.where(beyond, x, right)
        newton = x - value / slope
        inside = (newton >= left) & (newton <= right)
        following = np.where(np.abs(value) <= noise, x, np.where(inside, newton, (left + right) / 2))
        moving = np.abs(following - x) > _LAST_STEP * (bracket[1] - bracket[0])
        x = following
        if not moving.any():
            break
    return np.asarray(x)


def _value_and_slope(series: Array, slope_series: Array, x: Array) -> tuple[Array, Array]:
    """Value and slope of each series (column) at its own point; a slope of zero is made a tiny one."""
    basis = matrices.basis_at(x, len(series) - 1)
    slope = np.einsum("dk,dk->k", basis[: len(slope_series)], slope_series)
    slope[slope == 0] = np.finfo(np.float64).tiny ** 0.5
    return np.einsum("dk,dk->k", basis, series), slope


def _values_at(series: Array, x: Array) -> Array:
    """Value of each series (column) at its own point."""
    return np.asarray(np.einsum("dk,dk->k", matrices.basis_at(x, len(series) - 1), series))


def _times(breaks: Array, piece: Index, x: Array) -> Array:
    """Times of points x in [-1, 1] of the given intervals; the ends come out exactly."""
    return np.asarray((breaks[piece] * (1 - x) + breaks[piece + 1] * (1 + x)) / 2)
