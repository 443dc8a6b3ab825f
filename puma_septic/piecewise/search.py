"""Extrema and sign changes of Chebyshev series: bracket on an over-sampled grid, polish by Newton.

The grid's values and slopes come from one matrix product each. A cell can hold an extremum only where the slope
changes sign; only cells that can beat the best grid value are polished.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from puma_septic.checks import Array
from puma_septic.piecewise import matrices

__all__ = ["find_extrema", "find_sign_changes"]

Index = NDArray[np.int64]
# A value below this part of the sum of |coefficients| is rounding, and has no sign.
_ROUNDING = 64 * np.finfo(np.float64).eps
# Newton from a cell of a twofold grid converges in three or four steps; the others serve bisection of flat cells.
_NEWTON_STEPS = 60


def find_extrema(breaks: Array, coefficients: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """((minima, their times), (maxima, their times)), each of shape (m,)."""
    values, slopes = _on_grid(coefficients)
    x, m = matrices.grid(len(coefficients) - 1)[0], coefficients.shape[2]
    # Intervals first, then points: time increases, and argmax finds the earliest of equals.
    in_time = values.transpose(1, 0, 2).reshape(-1, m)
    at = np.concatenate([in_time.argmin(axis=0), in_time.argmax(axis=0)])
    component = np.tile(np.arange(m), 2)
    flip = np.repeat([-1.0, 1.0], m)
    best = flip * in_time[at, component]
    piece, point = np.divmod(at, len(x))
    where = x[point]
    cells = np.concatenate([_promising(flip[s] * values, flip[s] * slopes, x, best[s]) for s in (slice(m), slice(m, None))])
    if len(cells):
        polished_x, polished = _critical_points(coefficients, cells)
        slots = cells[:, 2] + np.where(slopes[tuple(cells.T)] > 0, m, 0)
        for slot, i, candidate, value in zip(slots, cells[:, 1], polished_x, flip[slots] * polished, strict=True):
            if value > best[slot]:
                best[slot], piece[slot], where[slot] = value, i, candidate
    times = _times(breaks, piece, where)
    return (-best[:m], times[:m]), (best[m:], times[m:])


def _on_grid(coefficients: Array) -> tuple[Array, Array]:
    """Values and slopes by x at the grid of each interval, each of shape (points, n, m)."""
    degree = len(coefficients) - 1
    basis = matrices.grid(degree)[1]
    flat = coefficients.reshape(degree + 1, -1)
    slopes = basis[:, : max(degree, 1)] @ (matrices.derivative_matrix(degree) @ flat)
    shape = (len(basis), *coefficients.shape[1:])
    return (basis @ flat).reshape(shape), slopes.reshape(shape)


def _promising(values: Array, slopes: Array, x: Array, best: Array) -> Index:
    """Cells (k, 3) of (grid cell, interval, component) that hold a maximum which may exceed the best grid value."""
    cells = np.argwhere((slopes[:-1] > 0) & (slopes[1:] < 0))
    k, i, j = cells.T
    width = x[k + 1] - x[k]
    # Where the curve is concave it lies below both tangents; their sum leaves room where it is not quite.
    bound = np.maximum(values[k, i, j], values[k + 1, i, j]) + (slopes[k, i, j] - slopes[k + 1, i, j]) * width / 2
    return cells[bound > best[j]]


def _critical_points(coefficients: Array, cells: Index) -> tuple[Array, Array]:
    """Critical points, and the values there, in cells (k, 3) of (grid cell, interval, component)."""
    degree = len(coefficients) - 1
    k, i, j = cells.T
    x = matrices.grid(degree)[0]
    series = coefficients[:, i, j].T
    critical = _zeros(series @ matrices.derivative_matrix(degree).T, x[k], x[k + 1])
    return critical, np.einsum("kd,kd->k", matrices.basis_at(critical, degree), series)


def _zeros(series: Array, left: Array, right: Array) -> Array:
    """The zero of each series (row) between two points across which it changes sign: safeguarded Newton."""
    degree = series.shape[1] - 1
    derivative = series @ matrices.derivative_matrix(degree).T
    rising = np.einsum("kd,kd->k", matrices.basis_at(right, degree), series) > 0
    x = (left + right) / 2
    for _ in range(_NEWTON_STEPS):
        basis = matrices.basis_at(x, degree)
        value = np.einsum("kd,kd->k", basis, series)
        gradient = np.einsum("kd,kd->k", basis[:, : derivative.shape[1]], derivative)
        beyond = (value > 0) == rising
        left, right = np.where(beyond, left, x), np.where(beyond, x, right)
        gradient[gradient == 0] = np.inf
        newton = x - value / gradient
        inside = (newton >= left) & (newton <= right)
        step = np.where(inside, newton, (left + right) / 2) - x
        x = x + step
        if (np.abs(step) < 4e-16).all() or not (right - left > 4e-16).any():
            break
    return x


def find_sign_changes(breaks: Array, coefficients: Array) -> tuple[Array, ...]:
    """Times of the sign changes inside the intervals, one sorted array per component."""
    m = coefficients.shape[2]
    if len(coefficients) == 1:
        return tuple(np.empty(0) for _ in range(m))
    values, slopes = _on_grid(coefficients)
    noise = _ROUNDING * np.abs(coefficients).sum(axis=0)
    sign = np.where(np.abs(values) <= noise, 0.0, np.sign(values))
    brackets = np.concatenate([_between_grid_points(sign), _around_zero_points(sign)])
    x = matrices.grid(len(coefficients) - 1)[0]
    left, right, cell = x[brackets[:, 0]], x[brackets[:, 1]], brackets[:, 2:]
    dips, bottoms = _dips(coefficients, values, slopes, sign)
    if len(dips):
        left = np.concatenate([left, x[dips[:, 0]], bottoms])
        right = np.concatenate([right, bottoms, x[dips[:, 0] + 1]])
        cell = np.concatenate([cell, dips[:, 1:], dips[:, 1:]])
    if not len(left):
        return tuple(np.empty(0) for _ in range(m))
    roots = _times(breaks, cell[:, 0], _zeros(coefficients[:, cell[:, 0], cell[:, 1]].T, left, right))
    return tuple(np.sort(roots[cell[:, 1] == j]) for j in range(m))


def _between_grid_points(sign: Array) -> Index:
    """Neighbouring grid points of opposite sign, rows (left, right, interval, component)."""
    cells = np.argwhere(sign[:-1] * sign[1:] < 0)
    return np.column_stack([cells[:, 0], cells[:, 0] + 1, cells[:, 1], cells[:, 2]])


def _around_zero_points(sign: Array) -> Index:
    """Runs of grid points that are zero to rounding, between points of opposite sign; rows as above.

    A run at an interval's end, as of a double zero at rest, is between nothing and is left out.
    """
    rows = []
    for k, i, j in np.argwhere((sign[1:] == 0) & (sign[:-1] != 0)):
        after = np.flatnonzero(sign[k + 1 :, i, j])
        if len(after) and sign[k + 1 + after[0], i, j] * sign[k, i, j] < 0:
            rows.append([k, k + 1 + after[0], i, j])
    return np.array(rows, dtype=np.int64).reshape(-1, 4)


def _dips(coefficients: Array, values: Array, slopes: Array, sign: Array) -> tuple[Index, Array]:
    """Cells in which a component dips through zero and back, and the bottom of each dip."""
    x = matrices.grid(len(coefficients) - 1)[0]
    turning = (sign[:-1] * slopes[:-1] < 0) & (sign[1:] * slopes[1:] > 0) & (sign[:-1] * sign[1:] > 0)
    cells = np.argwhere(turning)
    if len(cells):
        k, i, j = cells.T
        deepest = np.maximum(np.abs(slopes[k, i, j]), np.abs(slopes[k + 1, i, j])) * (x[k + 1] - x[k])
        cells = cells[np.minimum(np.abs(values[k, i, j]), np.abs(values[k + 1, i, j])) < deepest]
    if not len(cells):
        return cells, np.empty(0)
    bottoms, depths = _critical_points(coefficients, cells)
    k, i, j = cells.T
    through = depths * sign[k, i, j] < -_ROUNDING * np.abs(coefficients[:, i, j]).sum(axis=0)
    return cells[through], bottoms[through]


def _times(breaks: Array, piece: Index, x: Array) -> Array:
    """Times of points x in [-1, 1] of the given intervals; the ends come out exactly."""
    return (breaks[piece] * (1 - x) + breaks[piece + 1] * (1 + x)) / 2
