"""From a smooth function to its Chebyshev series: raise the degree, then bisect."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from puma_septic.errors import PumaSepticError
from puma_septic.piecewise import matrices
from puma_septic.validation import Array

__all__ = ["Intervals", "fit_series"]

# Nested node sets: each holds the one before, so that raising the degree asks only for the nodes between.
_DEGREES = (12, 24, 48, 96)
# A round costs more than the samples of one interval, and less than those of many.
_FEW = 64
# Bisection stops here: a part this small of an interval means that the function is not smooth.
_SMALLEST = 2.0**-20
# And here: noise everywhere would be bisected everywhere. A thousand times what the wildest torque has needed.
_MOST_SAMPLES = 200_000
# A few roundings of the largest component: what is below it in a small component may be noise of the sum it came from.
_ROUNDING = 64 * np.finfo(np.float64).eps
# Trailing coefficients below this part of what the tolerance allows are not worth carrying along.
_TRIM = 0.01


class Intervals(NamedTuple):
    """Parts [left, right] of [-1, 1] of the intervals `piece`."""

    piece: NDArray[np.int64]
    left: Array
    right: Array

    @property
    def are_whole(self) -> bool:
        """Whether none is less than all of its piece."""
        return bool((self.right - self.left == 2).all())

    def points(self, x: Array) -> Array:
        """The points x of each of them, as points of its piece, shape (n, len(x))."""
        return (self.left[:, None] * (1 - x) + self.right[:, None] * (1 + x)) / 2

    def some(self, which: NDArray[np.bool_]) -> Intervals:
        """Those."""
        return Intervals(self.piece[which], self.left[which], self.right[which])

    def starts(self, offsets: Array) -> Array:
        """Where they begin, s; whole intervals at the given offsets, to the last bit."""
        here, following = offsets[self.piece], offsets[self.piece + 1]
        return (here * (1 - self.left) + following * (1 + self.left)) / 2


Sampler = Callable[[Intervals, Array], Array]


def fit_series(sample: Sampler, offsets: Array, tolerance: float, *, start: float = 0.0) -> tuple[Array, Array]:
    """Breaks, from the first, and coefficients (degree + 1, n, m) of what `sample(intervals, x)` gives.

    `sample` is called with n intervals and points x (k,) in [-1, 1] of each, and returns values (k, n, m); `start` is
    for messages alone. See `Piecewise.fit`.
    """
    piece = np.arange(len(offsets) - 1)
    pending = Intervals(piece, np.full(len(piece), -1.0), np.full(len(piece), 1.0))
    done: list[tuple[float, Array]] = []
    scale, noisy = np.zeros(1), np.zeros(1, dtype=np.bool_)
    n_samples = 0
    while len(pending.piece):
        count = len(pending.piece)
        degrees = _DEGREES[2:] if count == 1 else _DEGREES[1:] if count < _FEW else _DEGREES
        values = sample(pending, matrices.nodes(degrees[0]))
        for degree in degrees:
            if degree != degrees[0]:
                values = _refined(sample, pending, values, degree)
            scale = np.maximum(scale, np.abs(values).max(axis=(0, 1)))
            series = matrices.coefficients_from_values(degree) @ values.reshape(degree + 1, -1)
            series = series.reshape(values.shape)
            small, noise = _converged(series, scale, tolerance)
            good: NDArray[np.bool_] = np.all(small | noise, axis=1)
            noisy = noisy | (noise & ~small)[good].any(axis=0)
            done += zip(pending.some(good).starts(offsets).tolist(), series[:, good].transpose(1, 0, 2), strict=True)
            n_samples += len(values) * int(np.count_nonzero(good))
            pending, values, series = pending.some(~good), values[:, ~good], series[:, ~good]
            if not len(pending.piece):
                break
        n_samples += len(values) * len(pending.piece)
        if len(pending.piece):
            pending = _bisected(pending, start + offsets, series, scale, n_samples)
    # A component that has been taken for noise must not carry it along.
    negligible = np.where(noisy, _ROUNDING * scale.max(), _TRIM * tolerance * scale)
    starts, coefficients = _joined(done, negligible)
    return np.append(starts, offsets[-1]), coefficients


def _refined(sample: Sampler, intervals: Intervals, values: Array, degree: int) -> Array:
    """Values at twice as many nodes, of which only the new ones are computed."""
    finer = np.empty((degree + 1, *values.shape[1:]))
    finer[::2] = values
    finer[1::2] = sample(intervals, matrices.nodes(degree)[1::2])
    return finer


def _converged(series: Array, scale: Array, tolerance: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether each tail has fallen below the tolerance, and whether it stays at the rounding, of shape (n, m)."""
    tail = matrices.tail(series)
    noise = tail <= _ROUNDING * scale.max()
    if len(series) <= _DEGREES[-1]:
        # Only what has stopped to fall is noise; a small component may have digits below the others' rounding.
        noise &= tail >= 0.1 * np.abs(series[len(series) // 2 :]).max(axis=0)
    return tail <= tolerance * scale, noise


def _bisected(intervals: Intervals, breaks: Array, series: Array, scale: Array, n_samples: int) -> Intervals:
    """Each interval as two; an interval too small for that, or too many of them, is an error."""
    parts = (intervals.right - intervals.left) / 2
    if (small := parts.min()) < _SMALLEST or n_samples > _MOST_SAMPLES:
        k = int(np.argmin(parts))
        component = int(np.argmax(matrices.tail(series)[k] / np.maximum(scale, np.finfo(np.float64).tiny)))
        left, right = breaks[intervals.piece[k]], breaks[intervals.piece[k] + 1]
        first, last = (((1 - x) * left + (1 + x) * right) / 2 for x in (intervals.left[k], intervals.right[k]))
        raise PumaSepticError(
            f"no Chebyshev series converges on [{first:.9g}, {last:.9g}] s (component {component}; {small:.1e} of the"
            f" interval, {n_samples} samples): the function is not smooth there and needs a break"
        )
    middle = (intervals.left + intervals.right) / 2
    return Intervals(
        np.concatenate([intervals.piece] * 2),
        np.concatenate([intervals.left, middle]),
        np.concatenate([middle, intervals.right]),
    )


def _joined(done: list[tuple[float, Array]], negligible: Array) -> tuple[Array, Array]:
    """The intervals' starts in order, and their series padded to one degree and cut where all is negligible."""
    done.sort(key=lambda item: item[0])
    coefficients = np.zeros((max(len(series) for _, series in done), len(done), len(negligible)))
    for i, (_, series) in enumerate(done):
        coefficients[: len(series), i] = series
    kept = np.flatnonzero((np.abs(coefficients) > negligible).any(axis=(1, 2)))
    return np.array([start for start, _ in done]), coefficients[: (kept[-1] + 1 if len(kept) else 1)]
