"""How noisy samples are: estimated from themselves."""

from __future__ import annotations

from math import factorial
from typing import Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.special import ndtri

from puma_septic.validation import Array

__all__ = ["encoder_step", "sample_noise"]

# Orders of the divided differences: below, a motion is not yet gone; above, rounding of the weights grows.
_ORDERS: Final = range(4, 11)
_FEWEST: Final = 20
# Where one order more still lowers the estimate by this, it is the motion that is seen, not noise.
_FALLING: Final = 0.7
# So many steps of the acceleration, each in as many windows as one has samples, count for nothing; what stands out in
# more than a tenth of many windows does, such as jitter or rows that were averaged unevenly.
_STEPS: Final = 20
_MOST_COMMON: Final = 0.9
# An encoder steps by whole multiples of its step, to this part of it.
_WHOLE: Final = 0.02
# A few changes fall on multiples of the smallest by chance.
_FEWEST_COUNTS: Final = 3
_MOST_STEPS: Final = 1_000_000.0
# Windows looked at: more do not sharpen the estimate.
_MOST_WINDOWS: Final = 50_000


def sample_noise(t: Array, q: Array) -> Array:
    """Standard deviation of the noise of each joint's samples, rad, shape (n_joints,); 0 where none is seen.

    The divided difference of order d is zero for a polynomial of lower degree; scaled to unit sum of squared weights
    it is the noise of one sample. The least estimate of the orders 4 to 10 is taken, each from a quantile over windows,
    between the median and 0.9, that 20 steps of the acceleration do not reach. Windows over which a joint stands still
    exactly tell nothing.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Increasing, s.
    q : ndarray, shape (n, n_joints)
        rad (m).
    """
    if len(t) < _FEWEST:
        return np.zeros(q.shape[1])
    # Shape (n_orders, n_joints).
    sizes = np.array([_typical_differences(t, q, order) for order in _ORDERS])
    best = np.argmin(sizes, axis=0)
    still_falling = (best == len(sizes) - 1) & (sizes[-1] < _FALLING * sizes[-2])
    noise = np.where(still_falling, 0.0, sizes.min(axis=0))
    # What rounding of the samples themselves makes is no noise.
    floor = 8 * np.finfo(float).eps * np.abs(q).max(axis=0)
    return np.where(noise > floor, noise, 0.0)


def _typical_differences(t: Array, q: Array, order: int) -> list[float]:
    """The typical divided difference of each joint over the windows in which it moves; the weights are for all."""
    stride = max(1, len(t) // _MOST_WINDOWS)
    times = sliding_window_view(t, order + 1)[::stride]
    # In units of the window, so that no weight overflows.
    x = (times - times[:, :1]) / (times[:, -1:] - times[:, :1])
    gaps = x[:, :, None] - x[:, None, :] + np.eye(order + 1)
    weights = 1 / (gaps.prod(axis=2) * factorial(order))
    weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    changed = np.diff(q, axis=0) != 0
    moving = np.asarray(sliding_window_view(changed, order, axis=0)[::stride].any(axis=2))
    return [
        _typical(weights[moves], sliding_window_view(column, order + 1)[::stride][moves])
        for column, moves in zip(q.T, moving.T, strict=True)
    ]


def _typical(weights: Array, values: Array) -> float:
    if not len(values):
        return 0.0
    differences = np.einsum("ij,ij->i", weights, values - values[:, :1])
    level = float(np.clip(1 - _STEPS * values.shape[1] / len(differences), 0.5, _MOST_COMMON))
    return float(np.quantile(np.abs(differences), level) / ndtri((1 + level) / 2))


def encoder_step(q: Array) -> Array:
    """The step of which all changes of a joint are whole multiples, rad, shape (n_joints,); 0 where there is none.

    Only steps that an encoder has are looked for: such as some row changes by a single one.
    """
    return np.array([_step(column) for column in q.T])


def _step(q: Array) -> float:
    changes = np.abs(np.diff(q))
    # Written digits blur a step; what is below any encoder's is their rounding.
    changes = np.unique(changes[changes > 1e-12])
    if len(changes) < 3:
        return 0.0
    step = float(changes[0])
    if changes[-1] / step > _MOST_STEPS:
        return 0.0
    # The smallest change is blurred by rounding: sharpened on changes of more and more steps.
    for reach in (3.0, 30.0, 300.0, _MOST_STEPS):
        some = changes[changes <= reach * step]
        counts = np.maximum(1, np.round(some / step))
        step = float((some @ counts) / (counts @ counts))
    counts = np.round(changes / step)
    even = np.abs(changes / step - counts).max() <= _WHOLE
    return step if even and counts.min() == 1 and len(np.unique(counts)) >= _FEWEST_COUNTS else 0.0
