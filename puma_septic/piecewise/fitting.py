"""From a smooth function to its Chebyshev series: raise the degree, then bisect."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from puma_septic.checks import Array
from puma_septic.errors import PumaSepticError
from puma_septic.piecewise import matrices

__all__ = ["fit_series"]

# Nested node sets: each holds the one before, so that raising the degree asks only for the nodes between.
_DEGREES = (16, 32, 64, 128)
# Bisection stops here: an interval this small, relative to the span, means that the function is not smooth.
_SMALLEST = 2.0**-20
# A few roundings of the largest component: what is below it in a small component is noise of the sum it came from.
_ROUNDING = 64 * np.finfo(np.float64).eps


def fit_series(f: Callable[[Array], Array], breaks: Array, tolerance: float) -> tuple[Array, Array]:
    """Breaks and coefficients (degree + 1, n, m) of `f`; see `Piecewise.fit`."""
    pending = np.column_stack([breaks[:-1], breaks[1:]])
    done: list[tuple[Array, Array]] = []
    scale = np.zeros(1)
    while len(pending):
        values = _sample(f, pending, matrices.nodes(_DEGREES[0]))
        for degree in _DEGREES:
            if degree != _DEGREES[0]:
                values = _refined(f, pending, values, degree)
            scale = np.maximum(scale, np.abs(values).max(axis=(0, 1)))
            series = np.tensordot(matrices.coefficients_from_values(degree), values, 1)
            good = _converged(series, scale, tolerance)
            done += [(pending[i], series[:, i]) for i in np.flatnonzero(good)]
            pending, values = pending[~good], values[:, ~good]
            if not len(pending):
                break
        pending = _bisected(pending, breaks, values)
    return _joined(done, scale)


def _sample(f: Callable[[Array], Array], intervals: Array, x: Array) -> Array:
    """Values at the points x of every interval, shape (len(x), n, m), in one call."""
    left, right = intervals.T
    # Written so that x = -1 and x = 1 give the ends exactly.
    times = (left * (1 - x)[:, None] + right * (1 + x)[:, None]) / 2
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


def _converged(series: Array, scale: Array, tolerance: float) -> Array:
    """Whether each interval's tail, judged per component, has fallen below the tolerance, shape (n,)."""
    tail = np.abs(series[-max(2, len(series) // 8) :]).max(axis=0)
    bound = np.maximum(tolerance * scale, _ROUNDING * scale.max())
    return np.asarray((tail <= bound).all(axis=1))


def _bisected(intervals: Array, breaks: Array, values: Array) -> Array:
    """Each interval as two; an interval too small for that is an error."""
    if len(intervals) and (small := np.diff(intervals).min() / (breaks[-1] - breaks[0])) < _SMALLEST:
        k = int(np.argmin(np.diff(intervals)[:, 0]))
        component = int(np.argmax(np.ptp(values[:, k], axis=0)))
        raise PumaSepticError(
            f"no Chebyshev series converges on [{intervals[k, 0]:.9g}, {intervals[k, 1]:.9g}] s (component {component};"
            f" {small:.1e} of the span): the function is not smooth there and needs a break"
        )
    middle = intervals.mean(axis=1)
    halves = [np.column_stack([intervals[:, 0], middle]), np.column_stack([middle, intervals[:, 1]])]
    return np.concatenate(halves)


def _joined(done: list[tuple[Array, Array]], scale: Array) -> tuple[Array, Array]:
    """The intervals in order, padded to one degree and cut where all that follows is below rounding."""
    done.sort(key=lambda item: float(item[0][0]))
    coefficients = np.zeros((max(len(series) for _, series in done), len(done), len(scale)))
    for i, (_, series) in enumerate(done):
        coefficients[: len(series), i] = series
    below = np.abs(coefficients) <= np.finfo(np.float64).eps / 4 * scale
    kept = np.flatnonzero(~below.all(axis=(1, 2)))
    breaks = np.array([interval[0] for interval, _ in done] + [done[-1][0][1]])
    return breaks, coefficients[: (kept[-1] + 1 if len(kept) else 1)]
