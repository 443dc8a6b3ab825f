"""From a smooth function to its Chebyshev series: raise the degree, then bisect."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from puma_septic.checks import Array
from puma_septic.errors import PumaSepticError
from puma_septic.piecewise import matrices

__all__ = ["fit_series"]

# Nested node sets: each holds the one before, so that raising the degree asks only for the nodes between.
_DEGREES = (24, 48, 96)
# Bisection stops here: an interval this small, relative to the span, means that the function is not smooth.
_SMALLEST = 2.0**-20
# And here: noise everywhere would be bisected everywhere. A thousand times what the wildest torque has needed.
_MOST_SAMPLES = 200_000
# A few roundings of the largest component: what is below it in a small component may be noise of the sum it came from.
_ROUNDING = 64 * np.finfo(np.float64).eps
# Trailing coefficients below this part of what the tolerance allows are not worth carrying along.
_TRIM = 0.01


def fit_series(f: Callable[[Array], Array], breaks: Array, tolerance: float) -> tuple[Array, Array]:
    """Breaks and coefficients (degree + 1, n, m) of `f`; see `Piecewise.fit`."""
    pending = np.column_stack([breaks[:-1], breaks[1:]])
    done: list[tuple[Array, Array]] = []
    scale, noisy = np.zeros(1), np.zeros(1, dtype=np.bool_)
    n_samples = 0
    while len(pending):
        # A round costs more than the samples of a single interval.
        degrees = _DEGREES[1:] if len(pending) == 1 else _DEGREES
        values = _sample(f, pending, matrices.nodes(degrees[0]))
        for degree in degrees:
            if degree != degrees[0]:
                values = _refined(f, pending, values, degree)
            scale = np.maximum(scale, np.abs(values).max(axis=(0, 1)))
            series = np.tensordot(matrices.coefficients_from_values(degree), values, 1)
            small, noise = _converged(series, scale, tolerance)
            good = (small | noise).all(axis=1)
            noisy = noisy | (noise & ~small)[good].any(axis=0)
            done += [(pending[i], series[:, i]) for i in np.flatnonzero(good)]
            n_samples += len(values) * int(good.sum())
            pending, values, series = pending[~good], values[:, ~good], series[:, ~good]
            if not len(pending):
                break
        n_samples += len(values) * len(pending)
        if len(pending):
            pending = _bisected(pending, breaks, series, scale, n_samples)
    # A component that has been taken for noise must not carry it along.
    return _joined(done, np.where(noisy, _ROUNDING * scale.max(), _TRIM * tolerance * scale))


def _sample(f: Callable[[Array], Array], intervals: Array, x: Array) -> Array:
    """Values at the points x of every interval, shape (len(x), n, m), in one call."""
    left, right = intervals.T
    times = (left * (1 - x)[:, None] + right * (1 + x)[:, None]) / 2
    # f may step at a break and has the right-hand value there: the last instant of the interval is the one before.
    times = np.clip(times, left, np.nextafter(right, left))
    values = np.asarray(f(times.T.ravel()))
    if not np.isfinite(values).all():
        k = int(np.argwhere(~np.isfinite(values))[0, 0])
        raise PumaSepticError(f"the function to be fitted is not finite at t = {times.T.ravel()[k]:.9g} s")
    return np.moveaxis(values.reshape(len(intervals), len(x), -1), 0, 1)


def _refined(f: Callable[[Array], Array], intervals: Array, values: Array, degree: int) -> Array:
    """Values at twice as many nodes, of which only the new ones are computed."""
    finer = np.empty((degree + 1, *values.shape[1:]))
    finer[::2] = values
    finer[1::2] = _sample(f, intervals, matrices.nodes(degree)[1::2])
    return finer


def _tail(series: Array) -> Array:
    """Largest coefficient of the last eighth, of each interval and component, shape (n, m)."""
    return np.asarray(np.abs(series[-max(2, len(series) // 8) :]).max(axis=0))


def _converged(series: Array, scale: Array, tolerance: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether each tail has fallen below the tolerance, and whether it stays at the rounding, of shape (n, m)."""
    tail = _tail(series)
    noise = tail <= _ROUNDING * scale.max()
    if len(series) <= _DEGREES[-1]:
        # Only what has stopped to fall is noise; a small component may have digits below the others' rounding.
        noise &= tail >= 0.1 * np.abs(series[len(series) // 2 :]).max(axis=0)
    return tail <= tolerance * scale, noise


def _bisected(intervals: Array, breaks: Array, series: Array, scale: Array, n_samples: int) -> Array:
    """Each interval as two; an interval too small for that, or too many of them, is an error."""
    lengths = np.diff(intervals)[:, 0]
    if (small := lengths.min() / (breaks[-1] - breaks[0])) < _SMALLEST or n_samples > _MOST_SAMPLES:
        k = int(np.argmin(lengths))
        component = int(np.argmax(_tail(series)[k] / np.maximum(scale, np.finfo(np.float64).tiny)))
        raise PumaSepticError(
            f"no Chebyshev series converges on [{intervals[k, 0]:.9g}, {intervals[k, 1]:.9g}] s (component {component};"
            f" {small:.1e} of the span, {n_samples} samples): the function is not smooth there and needs a break"
        )
    middle = intervals.mean(axis=1)
    halves = [np.column_stack([intervals[:, 0], middle]), np.column_stack([middle, intervals[:, 1]])]
    return np.concatenate(halves)


def _joined(done: list[tuple[Array, Array]], negligible: Array) -> tuple[Array, Array]:
    """The intervals in order, padded to one degree and cut where all that follows is negligible."""
    done.sort(key=lambda item: float(item[0][0]))
    coefficients = np.zeros((max(len(series) for _, series in done), len(done), len(negligible)))
    for i, (_, series) in enumerate(done):
        coefficients[: len(series), i] = series
    kept = np.flatnonzero((np.abs(coefficients) > negligible).any(axis=(1, 2)))
    breaks = np.array([interval[0] for interval, _ in done] + [done[-1][0][1]])
    return breaks, coefficients[: (kept[-1] + 1 if len(kept) else 1)]
