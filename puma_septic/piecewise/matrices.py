"""The constant matrices of Chebyshev series on [-1, 1], one of each kind per degree.

All follow from ``T_k(cos(theta)) = cos(k theta)``; see Trefethen, Approximation Theory and Approximation Practice.
Each is built once and shared, hence read-only.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from functools import wraps
from math import comb
from operator import mul
from typing import Any, Final, TypeVar, TypeVarTuple

import numpy as np
from numpy.polynomial import chebyshev

from puma_septic.validation import Array

__all__ = [
    "basis_at",
    "bernstein_eighths",
    "bernstein_halves",
    "coefficients_from_values",
    "derivative_matrix",
    "end_derivatives",
    "from_power_matrix",
    "gram_matrix",
    "grid",
    "integral_matrix",
    "kept",
    "nodes",
    "signs",
    "state_matrix",
    "tail",
    "to_bernstein_matrix",
    "to_power_matrix",
    "values_matrix",
]


# Of all matrices together. A task asks for 1 to 6 MB of them, and building some again takes less than 1 % of its time.
# Without a bound a process that meets ever other degrees grows by hundreds of MB.
_KEPT_BYTES: Final = 2_000_000
# Up to this many points, cosines are the faster way; measured at degrees 7 to 128.
_FEW = 64


_T = TypeVar("_T")
_Degrees = TypeVarTuple("_Degrees")
_kept: OrderedDict[tuple[Any, ...], tuple[Any, int]] = OrderedDict()  # the values and their bytes, used last at the end


def kept(build: Callable[[*_Degrees], _T]) -> Callable[[*_Degrees], _T]:
    """Build once what depends on degrees alone, and keep of all such what was used last, 2 MB together.

    A number of entries is no bound: a matrix grows with the square of its degree.

    Parameters
    ----------
    build : callable
        Of degrees by position; gives an array, or a tuple of them.

    Returns
    -------
    callable
    """

    @wraps(build)
    def get(*degrees: *_Degrees) -> _T:
        key = (build, *degrees)
        try:
            _kept.move_to_end(key)
            found: _T = _kept[key][0]
        except KeyError:  # or another thread has put it out just now
            found = build(*degrees)
            _kept[key] = found, _bytes(found)
            with suppress(KeyError):  # another thread has put out the last one
                while sum(size for _, size in list(_kept.values())) > _KEPT_BYTES:
                    _kept.popitem(last=False)
        return found

    return get


def _bytes(value: Any) -> int:
    return sum(map(_bytes, value)) if isinstance(value, tuple) else int(value.nbytes)


def _shared(array: Array) -> Array:
    array.setflags(write=False)
    return array


def basis_at(x: Array, degree: int) -> Array:
    """``T_k(x)`` for k = 0 ... degree, shape (degree + 1, ...); x must lie in [-1, 1], but for rounding.

    For few points by cosines; for many by ``T_m+j = 2 T_m T_j - T_m-j``, which doubles the known rows at each step.
    """
    if x.size <= _FEW:
        return np.asarray(
            np.cos(np.multiply.outer(np.arange(degree + 1.0), np.arccos(np.minimum(np.maximum(x, -1.0), 1.0))))
        )
    rows = np.empty((degree + 1, *x.shape))
    rows[0] = 1.0
    rows[1:2] = x
    known = 1
    while known < degree:
        more = min(known, degree - known)
        new = rows[known + 1 : known + more + 1]
        np.multiply(rows[1 : more + 1], 2 * rows[known], out=new)
        new -= rows[known - more : known][::-1]
        known += more
    return rows


@kept
def nodes(degree: int) -> Array:
    """The Chebyshev-Lobatto points in increasing order, both ends included, shape (degree + 1,)."""
    # sin keeps the points exactly symmetric about 0.
    return _shared(np.sin(np.pi * np.arange(-degree, degree + 1, 2) / (2 * degree)) if degree else np.zeros(1))


@kept
def values_matrix(degree: int, at_degree: int) -> Array:
    """Values at ``nodes(at_degree)`` of a series: shape (at_degree + 1, degree + 1)."""
    return _shared(np.asarray(chebyshev.chebvander(nodes(at_degree), degree), dtype=np.float64))


@kept
def coefficients_from_values(degree: int) -> Array:
    """Coefficients of the interpolant of values at ``nodes(degree)``: the type-I cosine transform as a matrix."""
    if degree == 0:
        return _shared(np.ones((1, 1)))
    matrix = values_matrix(degree, degree).T * (2.0 / degree)
    matrix = matrix.copy()
    matrix[:, [0, -1]] /= 2
    matrix[[0, -1], :] /= 2
    return _shared(matrix)


@kept
def derivative_matrix(degree: int) -> Array:
    """Coefficients of the derivative by x, shape (max(degree, 1), degree + 1)."""
    return _shared(np.asarray(chebyshev.chebder(np.eye(degree + 1))))


@kept
def state_matrix(degree: int, count: int) -> Array:
    """A series and its first `count` derivatives by x, stacked: ((count + 1) (degree + 1), degree + 1)."""
    one = np.zeros((degree + 1, degree + 1))
    one[: max(degree, 1)] = derivative_matrix(degree)
    return _shared(np.concatenate([np.linalg.matrix_power(one, k) for k in range(count + 1)]))


@kept
def integral_matrix(degree: int) -> Array:
    """Coefficients of the integral by x from -1, shape (degree + 2, degree + 1)."""
    return _shared(np.asarray(chebyshev.chebint(np.eye(degree + 1), lbnd=-1)))


@kept
def gram_matrix(degree: int) -> Array:
    """``G[i, j]``, the integral of ``T_i T_j`` over [-1, 1], so that the integral of f g is ``f @ G @ g``."""
    k = np.arange(degree + 1)
    total, difference = k[:, None] + k, k[:, None] - k
    even = total % 2 == 0
    matrix = np.zeros(even.shape)
    matrix[even] = 1 / (1 - total[even] ** 2.0) + 1 / (1 - difference[even] ** 2.0)
    return _shared(matrix)


@kept
def signs(degree: int) -> Array:
    """``T_k(-1) = (-1)^k``, shape (degree + 1,)."""
    return _shared(np.resize([1.0, -1.0], degree + 1))


def tail(series: Array) -> Array:
    """Largest coefficient of the last eighth of a series, at least of the last two, by component.

    Where it has fallen far enough the series is resolved: the one measure by which series are cut off.

    Parameters
    ----------
    series : ndarray, shape (degree + 1, ...)

    Returns
    -------
    ndarray, shape (...)
    """
    return np.asarray(np.abs(series[-max(2, len(series) // 8) :]).max(axis=0))


@kept
def end_derivatives(degree: int) -> Array:
    """``T_k^(r)(1) = prod (k^2 - i^2) / (2 i + 1)`` over i < r, for r = 0 to 3, shape (4, degree + 1).

    At -1 the signs are ``(-1)^(k + r)``.
    """
    k = np.arange(degree + 1.0)
    factors = [np.ones_like(k), *((k**2 - i**2) / (2 * i + 1) for i in range(3))]
    return _shared(np.cumprod(factors, axis=0))


@kept
def from_power_matrix(degree: int) -> Array:
    """Chebyshev coefficients in x of powers of ``s = (x + 1) / 2``, shape (degree + 1, degree + 1)."""
    matrix = np.zeros((degree + 1, degree + 1))
    power = np.ones(1)
    for k in range(degree + 1):
        matrix[: k + 1, k] = power
        power = np.asarray(chebyshev.chebmul(power, [0.5, 0.5]), dtype=np.float64)
    return _shared(matrix)


@kept
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


@kept
def grid(degree: int) -> Array:
    """Values of a series at `nodes` that over-sample it fourfold, at least 32 cells, shape (points, degree + 1)."""
    return values_matrix(degree, max(4 * degree, 32))


@kept
def to_bernstein_matrix(degree: int) -> Array:
    """Control values (coefficients in Bernstein's basis on [-1, 1]) of a series, shape (degree + 1, degree + 1).

    Power k of ``s = (x + 1) / 2`` has the control values ``C(i, k) / C(degree, k)``; summed as fractions, because
    powers cancel.
    """
    powers = to_power_matrix(degree).T.astype(int).tolist()
    rows = [[Fraction(comb(i, k), comb(degree, k)) for k in range(degree + 1)] for i in range(degree + 1)]
    return _shared(np.array([[float(sum(map(mul, row, power))) for power in powers] for row in rows]))


@kept
def bernstein_halves(degree: int) -> tuple[Array, Array]:
    """Control values on the lower and on the upper half, of those on the whole: de Casteljau's, as two matrices."""
    lower = np.array([[comb(row, k) / 2**row for k in range(degree + 1)] for row in range(degree + 1)])
    return _shared(lower), _shared(lower[::-1, ::-1].copy())


@kept
def bernstein_eighths(degree: int) -> Array:
    """Control values of a series on each eighth of [-1, 1], shape (8, degree + 1, degree + 1)."""
    parts = [to_bernstein_matrix(degree)]
    for _ in range(3):
        parts = [half @ part for part in parts for half in bernstein_halves(degree)]
    return _shared(np.array(parts))
