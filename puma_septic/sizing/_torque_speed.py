"""How much of a limit that depends on speed a motor uses, along the whole cycle."""

from __future__ import annotations

from typing import Final

import numpy as np

from puma_septic.piecewise import Piecewise
from puma_septic.sizing._loads import MotorLoad
from puma_septic.validation import Array

__all__ = ["largest_ratio", "torque_at_speed"]

# The iteration converges superlinearly; far fewer steps are ever needed.
_MOST_STEPS: Final = 60
_CONVERGED: Final = 1e-14


def torque_at_speed(motor: MotorLoad, curve: Array) -> tuple[float, float, float, float]:
    """Where a motor comes closest to, or farthest beyond, a curve of torque over speed.

    Parameters
    ----------
    motor : MotorLoad
    curve : ndarray, shape (k, 2)
        At least two rows (speed, torque) from speed 0, straight between them; nothing beyond the last.

    Returns
    -------
    utilisation, torque, limit, time : float
        The largest ``abs(torque) / curve(abs(speed))`` over the cycle, with both its terms and its instant. A speed
        beyond the curve's end, or one at which the curve is zero, is an infinite utilisation.
    """
    speeds = curve[:, 0]
    size = motor.speed.by_interval(motor.direction)
    constants = [Piecewise.constant([speed], size.duration, start=size.start) for speed in speeds[1:]]
    shifted = [(size - constant).roots()[0] for constant in constants]
    size = size.split(np.concatenate(shifted))
    fastest = size.extrema()
    if fastest.max[0] > speeds[-1] * (1 + 1e-12):
        time = float(fastest.t_max[0])
        return np.inf, float(abs(motor.torque(time)[0])), 0.0, time
    middles = size(size.middles)[:, 0]
    k = np.clip(np.searchsorted(speeds, middles, side="right") - 1, 0, len(curve) - 2)
    slopes = np.diff(curve[:, 1]) / np.diff(speeds)
    limit = size.by_interval(slopes[k]) + size.stepwise((curve[k, 1] - slopes[k] * speeds[k])[:, None])
    return largest_ratio(motor.torque, limit)


def largest_ratio(f: Piecewise, g: Piecewise) -> tuple[float, float, float, float]:
    """The largest ``abs(f) / g`` over the span for a g that should be positive; ratio, abs(f), g and instant.

    The maximum u of a ratio is where ``max(abs(f) - u g) = 0``. Each step takes the instant of that maximum and the
    ratio there as the next u (Dinkelbach's iteration), which rises to it superlinearly. A g that
    reaches zero gives an infinite ratio.
    """
    lowest = g.extrema()
    if not lowest.min[0] > 0:
        time = float(lowest.t_min[0])
        return np.inf, float(abs(f(time)[0])), float(lowest.min[0]), time
    best = (0.0, 0.0, float(lowest.min[0]), float(g.breaks[0]))
    for _ in range(_MOST_STEPS):
        found = max((_ratio_at(f, g, time) for time in _instants(f, g, best[0])), key=lambda item: item[0])
        if not found[0] > best[0] * (1 + _CONVERGED):
            break
        best = found
    return best


def _instants(f: Piecewise, g: Piecewise, ratio: float) -> tuple[float, float]:
    """Where ``f - ratio g`` and ``-f - ratio g`` are largest."""
    above, below = (f - g * ratio).extrema(), (f + g * ratio).extrema()
    return float(above.t_max[0]), float(below.t_min[0])


def _ratio_at(f: Piecewise, g: Piecewise, time: float) -> tuple[float, float, float, float]:
    """Ratio at an instant, the larger one-sided value where it steps."""
    pairs = [(abs(a), b) for a, b in zip(_beside(f, time), _beside(g, time), strict=True)]
    size, limit = max(pairs, key=lambda pair: pair[0] / pair[1])
    return size / limit, size, limit, time


def _beside(f: Piecewise, time: float) -> tuple[float, float]:
    """Left-hand and right-hand value at an instant, equal inside an interval and at the ends."""
    right = float(f(time)[0])
    at = np.flatnonzero(f.breaks == time)
    if not len(at) or at[0] in (0, len(f.breaks) - 1):
        return right, right
    return float(f.ends()[1][at[0] - 1, 0]), right
