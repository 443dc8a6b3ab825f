"""Splines the plain way: one dense system, in floating point or in exact fractions."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import perm
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

Array = NDArray[np.float64]


def dense_rest_spline(t: Array, q: Array, order: int) -> Array:
    """Chebyshev coefficients (2 order + 2, n, m) of the spline from rest to rest through all points.

    The system that the profiles once solved: value and derivatives in each segment's own normalised time, equations
    scaled to size one, one step of refinement in extended precision.
    """
    degree, n = 2 * order + 1, len(t) - 1
    size, lengths = degree + 1, np.diff(t)
    rows, values = [], []

    def row(segment: int, k: int, x: float) -> Array:
        full = np.zeros(n * size)
        derivative = chebyshev.chebder(np.eye(size), k) if k else np.eye(size)
        full[segment * size : (segment + 1) * size] = chebyshev.chebval(x, derivative) * (2 / lengths[segment]) ** k
        return full

    for i in range(n + 1):
        rows.append(row(i, 0, -1.0) if i < n else row(n - 1, 0, 1.0))
        values.append(q[i] - q[0])
    for k in range(1, order + 1):
        rows += [row(0, k, -1.0), row(n - 1, k, 1.0)]
        values += [np.zeros(q.shape[1])] * 2
    for i in range(1, n):
        for k in range(degree):
            rows.append(row(i - 1, k, 1.0) - row(i, k, -1.0))
            values.append(np.zeros(q.shape[1]))
    matrix, right = np.array(rows), np.array(values)
    scale = np.abs(matrix).max(axis=1, keepdims=True)
    matrix, right = matrix / scale, right / scale
    solution = np.linalg.solve(matrix, right)
    left_over = (right - matrix.astype(np.longdouble) @ solution).astype(np.float64)
    series = (solution + np.linalg.solve(matrix, left_over)).reshape(n, size, -1).transpose(1, 0, 2)
    series[0] += q[0]
    return series


def exact_rest_spline(t: Sequence[float], q: Sequence[float], order: int, at: Sequence[float]) -> Array:
    """Values of the same spline by Gaussian elimination of fractions, which has no rounding."""
    degree, n = 2 * order + 1, len(t) - 1
    size = degree + 1
    times, points = [Fraction(x) for x in t], [Fraction(x) for x in q]

    def row(segment: int, k: int, instant: Fraction) -> list[Fraction]:
        s = instant - times[segment]
        full = [Fraction(0)] * (n * size)
        for power in range(k, size):
            full[segment * size + power] = perm(power, k) * s ** (power - k)
        return full

    table: list[list[Fraction]] = []
    for i in range(n + 1):
        table.append([*row(min(i, n - 1), 0, times[i]), points[i]])
    for k in range(1, order + 1):
        table += [[*row(0, k, times[0]), Fraction(0)], [*row(n - 1, k, times[-1]), Fraction(0)]]
    for i in range(1, n):
        for k in range(degree):
            before, after = row(i - 1, k, times[i]), row(i, k, times[i])
            table.append([*(a - b for a, b in zip(before, after, strict=True)), Fraction(0)])
    powers = _solved(table)
    values = []
    for instant in at:
        i = min(int(np.searchsorted(t, instant, side="right")) - 1, n - 1)
        s = Fraction(instant) - times[i]
        values.append(float(sum(powers[i * size + k] * s**k for k in range(size))))
    return np.array(values)


def _solved(table: list[list[Fraction]]) -> list[Any]:
    n = len(table)
    for column in range(n):
        pivot = next(i for i in range(column, n) if table[i][column])
        table[column], table[pivot] = table[pivot], table[column]
        top = [x / table[column][column] for x in table[column]]
        table[column] = top
        for i in range(n):
            factor = table[i][column]
            if i != column and factor:
                table[i] = [x - factor * y if y else x for x, y in zip(table[i], top, strict=True)]
    return [line[-1] for line in table]
