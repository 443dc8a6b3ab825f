"""Which way a function travels: the sign of its change between two reversals, never that of its slope at a point."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise.function import Piecewise
from puma_septic.validation import Array

__all__ = ["REST_TIME", "STILL", "find_directions"]

STILL: Final = 1e-9
"""Travel that is none in any motion, rad or m: below what the finest encoders resolve (32 bits a turn: 1.5e-9 rad),
above what numeric inverse kinematics and the arithmetic of profiles leave."""
REST_TIME: Final = 0.1
"""A recorded joint that stays within its resolution for this long is at rest, s. It moves by less than ten resolutions
a second; near a reversal or an end a joint that accelerates is this slow for a shorter time."""
# While a joint rests it creeps slower than this many times STILL over the whole motion.
_CREEP: Final = 10.0
# Nor does it accelerate: at its acceleration it would travel by less than this many times STILL in the whole motion.
_STEADY: Final = 1000.0
# Samples within REST_TIME: rests are found to a tenth of it.
_SAMPLES: Final = 10


def find_directions(position: Piecewise, resolution: Array) -> Piecewise:
    """The direction of each component, +1, -1 or 0, as a function that is constant between its breaks.

    Turning points are extrema of the position between which it travels by more than its resolution (at least `STILL`);
    smaller reversals are none. Between two turning points the direction is the sign of the travel. It is 0

    - throughout, where a component never travels by more than its resolution;
    - on an interval over which it creeps by less than `STILL`, slower than `STILL` tenfold in the whole motion, and
      does not accelerate;
    - where a resolution is given: wherever it stays within that for `REST_TIME` or longer.

    Parameters
    ----------
    position : Piecewise
    resolution : ndarray, shape (m,)
        In the unit of the position; 0 for a planned motion.
    """
    function = position.from_zero()
    m = function.n_components
    roots = function.derivative().roots(noise=0.0)
    turned = [_turning_points(function[j], roots[j], max(STILL, float(resolution[j]))) for j in range(m)]
    rests = [_recorded_rests(function[j], float(resolution[j])) for j in range(m)]
    times = np.concatenate([function.breaks, *(times for times, _ in turned), *(np.ravel(spans) for spans in rests)])
    unit = Piecewise.constant(np.ones(m), function.duration).split(times)
    values = np.empty((len(unit.middles), m))
    for j, (reversals, signs) in enumerate(turned):
        values[:, j] = signs[np.searchsorted(reversals, unit.middles)]
        for first, last in rests[j]:
            values[(unit.middles > first) & (unit.middles < last), j] = 0.0
    values[_creeping(function)[np.searchsorted(function.breaks[1:-1], unit.middles)]] = 0.0
    return unit.by_interval(values).shifted(position.start)


def _turning_points(position: Piecewise, roots: Array, allowed: float) -> tuple[Array, Array]:
    """Times (k,) of the turning points of the only component, and the signs (k + 1,) between them.

    A turn is an extremum from which the position comes back by more than `allowed`.
    """
    times = np.unique(np.concatenate([position.breaks, roots]))
    values = position(times)[:, 0]
    # Only local extrema and the ends can turn.
    steps = np.sign(np.diff(values))
    moving = np.flatnonzero(steps)
    inner = moving[1:][steps[moving[1:]] != steps[moving[:-1]]]
    turns: list[int] = []
    low = high = extreme = 0
    sign = 0.0
    for k in [*inner.tolist(), len(values) - 1]:
        if sign == 0.0:
            low, high = (k if values[k] < values[low] else low), (k if values[k] > values[high] else high)
            if values[high] - values[low] > allowed:
                sign, extreme = np.sign(high - low), k
        elif sign * (values[k] - values[extreme]) >= 0:
            extreme = k
        elif sign * (values[extreme] - values[k]) > allowed:
            turns.append(extreme)
            sign, extreme = -sign, k
    alternating = (-1.0) ** np.arange(len(turns) + 1)
    return times[turns], sign * alternating[-1] * alternating


def _recorded_rests(position: Piecewise, resolution: float) -> Array:
    """Starts and ends (k, 2) of the spans in which the only component stays within its resolution long enough."""
    count = int(position.duration / REST_TIME * _SAMPLES) + 1
    if not resolution or count <= _SAMPLES:
        return np.empty((0, 2))
    times = np.linspace(0.0, position.duration, count)
    windows = np.lib.stride_tricks.sliding_window_view(position(times)[:, 0], _SAMPLES + 1)
    quiet = np.concatenate([[False], windows.max(axis=1) - windows.min(axis=1) <= resolution, [False]])
    first, last = np.flatnonzero(quiet[1:] & ~quiet[:-1]), np.flatnonzero(quiet[:-1] & ~quiet[1:])
    return np.column_stack([times[first], times[np.minimum(last - 1 + _SAMPLES, count - 1)]])


def _creeping(position: Piecewise) -> NDArray[np.bool_]:
    """Whether each component is at rest but for rounding on each interval, shape (n, m).

    A short interval in which it comes to rest is none: there it is slow, but accelerates.
    """
    travel = 2 * np.abs(position.coefficients[1:]).sum(axis=0)
    part = np.minimum(1.0, _CREEP * position.lengths / position.duration)
    acceleration = np.abs(position.derivative().derivative().coefficients).sum(axis=0)
    steady = acceleration * position.duration**2 <= _STEADY * STILL
    return np.asarray((travel <= STILL * part[:, None]) & steady)
