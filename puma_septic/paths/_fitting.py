"""From positions whose three derivatives are known to series that keep the digits of all four."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from puma_septic.errors import PumaSepticError
from puma_septic.piecewise import Piecewise, matrices
from puma_septic.validation import Array

__all__ = ["fit_state"]

# Values (4, k, m) of a function and its derivatives, of pieces (k,), at points (k,) in [-1, 1] of them.
Sampler = Callable[[NDArray[np.int64], Array], Array]

_DEGREE = 24
# What the series may differ by from the values at the nodes: of the position in rad (m); of each derivative as a part
# of its largest value on the interval. Near a singularity an inverse Jacobian costs three digits of sixteen an order.
_TOLERANCES = np.array([1e-12, 1e-11, 1e-10, 1e-9])
# Beside that, the floor of a derivative that is nearly zero: a part of the largest on the whole span, and what
# changes the derivatives below it by this part over the interval.
_FLOOR = 1e-13
# And the rounding of the argument, in m or s, times the next derivative: what a pose near a singularity leaves open of
# its joint positions is seen at the tool as no more than this.
_ROUNDING = 2e-14
# More intervals than this at once are noise.
_MOST = 4096
# What bisection must not fall below, as a part of its piece.
_SMALLEST = 2.0**-24


def fit_state(sample: Sampler, offsets: Array, refusal: Callable[[float], PumaSepticError]) -> Piecewise:
    r"""The series of a function from its third derivative, integrated from exact starts on every interval.

    Differentiating a fit loses digits, integrating does not: so the third derivative is interpolated at 25 Chebyshev
    points, and integrated three times from the values at the interval's left end. An interval is accepted where the
    result agrees with the exact function and its derivatives at all points, and the last coefficients of the third have
    fallen; otherwise it is bisected.

    Parameters
    ----------
    sample : callable
        ``sample(piece, x)`` with shapes (k,) returns (4, k, m).
    offsets : ndarray, shape (n + 1,)
        Ends of the pieces, from 0.
    refusal : callable
        The error for the place at which the function is not smooth.

    Returns
    -------
    Piecewise

    Raises
    ------
    PumaSepticError
        `refusal`'s, where bisection does not help: the function is not smooth there.
    """
    piece = np.arange(len(offsets) - 1)
    left, right = np.full(len(piece), -1.0), np.full(len(piece), 1.0)
    done: list[tuple[float, Array]] = []
    scale = np.zeros(4)
    while len(piece):
        inside = (left * (1 - matrices.nodes(_DEGREE)[:, None]) + right * (1 + matrices.nodes(_DEGREE)[:, None])) / 2
        values = sample(np.tile(piece, _DEGREE + 1), inside.ravel())
        values = values.reshape(4, _DEGREE + 1, len(piece), -1)
        lengths = (right - left) / 2 * (offsets[piece + 1] - offsets[piece])
        scale = np.maximum(scale, np.abs(values).max(axis=(1, 2, 3)))
        series = _integrated(values, lengths)
        good = _agrees(series, values, lengths, scale)
        starts = offsets[piece] + (left + 1) / 2 * (offsets[piece + 1] - offsets[piece])
        done += zip(starts[good].tolist(), np.moveaxis(series[:, good], 1, 0), strict=True)
        piece, left, right = piece[~good], left[~good], right[~good]
        if len(piece) and ((right - left).min() / 2 < _SMALLEST or len(piece) > _MOST):
            raise refusal(float(starts[~good][np.argmin(right - left)]))
        middle = (left + right) / 2
        piece = np.concatenate([piece, piece])
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
    done.sort(key=lambda item: item[0])
    breaks = np.array([*(start for start, _ in done), offsets[-1]])
    return Piecewise(breaks=breaks, coefficients=np.stack([part for _, part in done], axis=1)).trimmed(0.0)


def _integrated(values: Array, lengths: Array) -> Array:
    """Series (degree + 4, n, m) of the third derivative's values, integrated from the starts of the others."""
    series = np.tensordot(matrices.coefficients_from_values(_DEGREE), values[3], 1)
    for order in (2, 1, 0):
        integral = np.tensordot(matrices.integral_matrix(len(series) - 1), series, 1)
        series = integral * (lengths[:, None] / 2)
        series[0] += values[order, 0]
    return np.asarray(series)


def _agrees(series: Array, values: Array, lengths: Array, scale: Array) -> NDArray[np.bool_]:
    """Whether position, first and second derivative agree at the nodes, and the third has converged, shape (n,)."""
    good, derivative = np.ones(len(lengths), dtype=np.bool_), series
    sizes = np.abs(values).max(axis=(1, 3))
    nexts = np.append(sizes[1:], [sizes[3] ** 2 / np.maximum(sizes[2], np.finfo(np.float64).tiny)], axis=0)
    change = np.zeros(len(lengths))
    for order in range(4):
        if order:
            matrix = matrices.derivative_matrix(len(derivative) - 1)
            derivative = np.tensordot(matrix, derivative, 1) * (2 / lengths[:, None])
        if order < 3:
            error = np.tensordot(matrices.values_matrix(len(derivative) - 1, _DEGREE), derivative, 1) - values[order]
        else:
            error = derivative[-3:]
        largest = sizes[order] if order else np.maximum(sizes[0], 1.0)
        allowed = _TOLERANCES[order] * largest + _ROUNDING * nexts[order]
        if order:
            change = np.maximum(sizes[order], change / lengths)
            allowed += _FLOOR * (scale[order] + change)
        good &= np.abs(error).max(axis=(0, 2)) <= allowed
    return good
