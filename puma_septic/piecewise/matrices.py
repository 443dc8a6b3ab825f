"""The constant matrices of Chebyshev series on [-1, 1], one of each kind per degree.

All follow from ``T_k(cos(theta)) = cos(k theta)``; see Trefethen, Approximation Theory and Approximation Practice,
chapters 2-3 (nodes, coefficients) and 19 (integrals). Each is built once and shared, hence read-only.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from puma_septic.checks import Array

__all__ = [
    "basis_at",
    "coefficients_from_values",
    "derivative_matrix",
    "from_power_matrix",
    "gram_matrix",
    "grid",
    "integral_matrix",
    "nodes",
    "signs",
    "to_power_matrix",
    "values_matrix",
]


def _shared(array: Array) -> Array:
    array.setflags(write=False)
    return array


def basis_at(x: Array, degree: int) -> Array:
    """``T_k(x)`` for k = 0 ... degree, shape (..., degree + 1); x must lie in [-1, 1]."""
    return np.cos(np.arccos(x)[..., None] * np.arange(degree + 1))


@lru_cache(maxsize=256)
def nodes(degree: int) -> Array:
    """The Chebyshev-Lobatto points in increasing order, both ends included, shape (degree + 1,)."""
    # sin keeps the points exactly symmetric about 0.
    return _shared(np.sin(np.pi * np.arange(-degree, degree + 1, 2) / (2 * degree)) if degree else np.zeros(1))


@lru_cache(maxsize=256)
def values_matrix(degree: int, at_degree: int) -> Array:
    """Values at ``nodes(at_degree)`` of a series: shape (at_degree + 1, degree + 1)."""
    return _shared(np.asarray(chebyshev.chebvander(nodes(at_degree), degree)))


@lru_cache(maxsize=256)
def coefficients_from_values(degree: int) -> Array:
    """Coefficients of the interpolant of values at ``nodes(degree)``: the type-I cosine transform as a matrix."""
    if degree == 0:
        return _shared(np.ones((1, 1)))
    matrix = values_matrix(degree, degree).T * (2.0 / degree)
    matrix = matrix.copy()
    matrix[:, [0, -1]] /= 2
    matrix[[0, -1], :] /= 2
    return _shared(matrix)


@lru_cache(maxsize=256)
def derivative_matrix(degree: int) -> Array:
    """Coefficients of the derivative by x, shape (max(degree, 1), degree + 1)."""
    return _shared(np.asarray(chebyshev.chebder(np.eye(degree + 1))))


@lru_cache(maxsize=256)
def integral_matrix(degree: int) -> Array:
    """Coefficients of the integral by x from -1, shape (degree + 2, degree + 1)."""
    return _shared(np.asarray(chebyshev.chebint(np.eye(degree + 1), lbnd=-1)))


@lru_cache(maxsize=256)
def gram_matrix(degree: int) -> Array:
    """``G[i, j]``, the integral of ``T_i T_j`` over [-1, 1], so that the integral of f g is ``f @ G @ g``."""
    k = np.arange(degree + 1)
    total, difference = k[:, None] + k, k[:, None] - k
    even = total % 2 == 0
    matrix = np.zeros(even.shape)
    matrix[even] = 1 / (1 - total[even] ** 2.0) + 1 / (1 - difference[even] ** 2.0)
    return _shared(matrix)


@lru_cache(maxsize=256)
def signs(degree: int) -> Array:
    """``T_k(-1) = (-1)^k``, shape (degree + 1,)."""
    return _shared((-1.0) ** np.arange(degree + 1))


@lru_cache(maxsize=256)
def from_power_matrix(degree: int) -> Array:
    """Chebyshev coefficients in x of powers of ``s = (x + 1) / 2``, shape (degree + 1, degree + 1)."""
    matrix = np.zeros((degree + 1, degree + 1))
    power = np.ones(1)
    for k in range(degree + 1):
        matrix[: k + 1, k] = power
        power = chebyshev.chebmul(power, [0.5, 0.5])
    return _shared(matrix)


@lru_cache(maxsize=256)
def to_power_matrix(degree: int) -> Array:
    """Powers of ``s = (x + 1) / 2`` of Chebyshev coefficients in x: the inverse of `from_power_matrix`.

    ``T_k(2 s - 1)`` has integer coefficients, so the recursion ``T_k+1 = (4 s - 2) T_k - T_k-1`` is exact.
    """
    matrix = np.eye(degree + 1)
    if degree:
        matrix[:2, 1] = -1.0, 2.0
    for k in range(1, degree):
        matrix[:, k + 1] = -2 * matrix[:, k] - matrix[:, k - 1]
        matrix[1:, k + 1] += 4 * matrix[:-1, k]
    return _shared(matrix)


@lru_cache(maxsize=256)
def grid(degree: int) -> tuple[Array, Array]:
    """Points that over-sample a series twofold, and the basis there; at least 32 cells for the low degrees."""
    count = max(2 * degree, 32)
    return nodes(count), values_matrix(degree, count)
