"""Which way a function travels: the sign of its change between two reversals, never that of its slope at a point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise._piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["REST_TIME", "STILL", "find_directions"]

STILL: Final = 1e-9
"""Travel that counts as rest in any motion, rad or m: below what the finest encoders resolve (32 bits a turn:
1.5e-9 rad), above what numeric inverse kinematics and the arithmetic of profiles leave."""
REST_TIME: Final = 0.1
"""A recorded joint that stays within its resolution for this long is at rest, s. It moves by less than ten resolutions
a second; near a reversal or an end a joint that accelerates is this slow for a shorter time."""
# While a joint rests it creeps slower than this many times STILL over the whole motion,
_CREEP: Final = 10.0
# and for longer than this, s, a step of a servo loop: the first microsecond of a move under a high jerk is no rest.
_BRIEF: Final = 1e-3
# An acceleration steps where its sides differ by this part of the largest; splines are smooth to rounding.
_STEP: Final = 1e-3
# Samples within REST_TIME: rests are found to a tenth of it.
_SAMPLES: Final = 10


def find_directions(position: Piecewise, turns: Sequence[Array], resolution: Array) -> Piecewise:
    """The direction of each component, +1, -1 or 0, as a function that is constant between its breaks.

    Turning points are extrema of the position between which it travels by more than its resolution (at least `STILL`);
    smaller reversals do not count. Between two turning points the direction is the sign of the travel. It is 0

    - throughout, where a component never travels by more than its resolution;
    - on an interval on which it is constant, or where it creeps, slower than `STILL` tenfold in the whole motion, for a
      millisecond or longer; where a resolution is given, for `REST_TIME` or longer;
    - where a resolution is given: wherever it stays within that for `REST_TIME` or longer, less the time for which
      a motion that begins or ends there is hidden.

    Parameters
    ----------
    position : Piecewise
    turns : sequence of ndarray
        When each component turns inside an interval, s from the start; see `Piecewise.extrema_and_turns`.
    resolution : ndarray, shape (m,)
        In the unit of the position; 0 for a planned motion.
    """
    function = position.from_zero()
    turned = _turned(function, turns, np.maximum(STILL, resolution).tolist())
    recorded = np.flatnonzero(resolution).tolist()
    rests = [_recorded_rests(function[j], float(resolution[j])) for j in recorded]
    for j, (seen, real) in zip(recorded, rests, strict=True):
        when = _at_steps(function[j], turned[j][0], float(resolution[j]))
        for (first, last), rest in zip(seen, real, strict=True):
            # A joint that turns while it seems to rest has turned when it sets out.
            when = np.where((first <= when) & (when <= last), when.clip(*rest), when)
        turned[j] = when, turned[j][1]
    unit = function.stepwise(np.ones((len(function.lengths), 1)))
    unit = unit.split(np.concatenate([*(when for when, _ in turned), *(real.ravel() for _, real in rests)]))
    middles = unit.middles
    directions = np.array([signs[when.searchsorted(middles)] for when, signs in turned]).T.copy()
    for j, (_, real) in zip(recorded, rests, strict=True):
        for first, last in real:
            directions[(middles > first) & (middles < last), j] = 0.0
    brief = np.where(resolution > 0, REST_TIME, _BRIEF)
    directions[_creeping(function, brief)[function.offsets[1:-1].searchsorted(middles)]] = 0.0
    return unit.stepwise(directions).shifted(position.start)


def _turned(function: Piecewise, turns: Sequence[Array], allowed: Sequence[float]) -> list[tuple[Array, Array]]:
    """The turning points of each component, at its own extrema or at breaks: beside them a position is as large."""
    times = np.concatenate([function.offsets, *turns])
    owner = np.repeat(np.arange(len(turns) + 1), [len(function.offsets), *map(len, turns)])
    order = np.argsort(times, kind="stable")
    times, owner = times[order], owner[order]
    values = function.at_offsets(times)
    found = []
    for j, least in enumerate(allowed):
        own = (owner == 0) | (owner == j + 1)
        found.append(_turning_points(times[own], values[own, j].tolist(), least))
    return found


def _turning_points(times: Array, at: list[float], allowed: float) -> tuple[Array, Array]:
    """Times (k,) of the turning points of a component with the values `at` these times, and the signs (k + 1,) between.

    A turn is an extremum from which the position comes back by more than `allowed`.
    """
    turns: list[int] = []
    low = high = extreme = 0
    sign = 0.0
    for k, value in enumerate(at):
        if sign == 0.0:
            low, high = (k if value < at[low] else low), (k if value > at[high] else high)
            if at[high] - at[low] > allowed:
                sign, extreme = (1.0 if high > low else -1.0), k
        elif sign * (value - at[extreme]) >= 0:
            extreme = k
        elif sign * (at[extreme] - value) > allowed:
            turns.append(extreme)
            sign, extreme = -sign, k
    alternating = (-1.0) ** np.arange(len(turns) + 1)
    return times[turns], sign * alternating[-1] * alternating


def _at_steps(position: Piecewise, when: Array, resolution: float) -> Array:
    """Turning points of a recorded motion; at a step of its acceleration where the resolution tells no difference.

    Friction of the wrong sign right after such a step would make a peak that nobody feels.
    """
    acceleration = position.derivative().derivative()
    steps = np.abs(acceleration.jumps().sizes[:, 0]) > _STEP * np.abs(acceleration.ends()).max()
    if not steps.any():
        return when
    stepping = position.offsets[1:-1][steps]
    nearest = stepping[np.abs(when[:, None] - stepping).argmin(axis=1)]
    apart = np.abs(position.at_offsets(nearest) - position.at_offsets(when))[:, 0]
    return np.where(apart <= resolution, nearest, when)


def _recorded_rests(position: Piecewise, resolution: float) -> tuple[Array, Array]:
    """Where the only component stays within its resolution for long enough, and where it rests then: spans (k, 2)."""
    count = int(position.duration / REST_TIME * _SAMPLES) + 1
    if not resolution or count <= _SAMPLES:
        return np.empty((0, 2)), np.empty((0, 2))
    times = np.linspace(0.0, position.duration, count)
    windows = np.lib.stride_tricks.sliding_window_view(position(times)[:, 0], _SAMPLES + 1)
    quiet = np.concatenate([[False], windows.max(axis=1) - windows.min(axis=1) <= resolution, [False]])
    first, last = np.flatnonzero(quiet[1:] & ~quiet[:-1]), np.flatnonzero(quiet[:-1] & ~quiet[1:])
    seen = np.column_stack([times[first], times[np.minimum(last - 1 + _SAMPLES, count - 1)]])
    ends = zip(seen.T, (-1.0, 1.0), strict=True)
    real = np.column_stack([_rest_ends(position, instants, way, resolution) for instants, way in ends])
    rests = real[:, 0] < real[:, 1]
    return seen[rests], real[rests]


def _rest_ends(position: Piecewise, seen: Array, way: float, resolution: float) -> Array:
    """When rests really end (`way` 1) or begin (-1), of which motion beyond the resolution is seen from `seen` on.

    A joint that sets out with a constant jerk takes as long to move by its resolution as from there to eight times it.
    One that turns meanwhile ripples.
    """
    t = seen + way * REST_TIME * np.linspace(-1.0, 2.0, 30 * _SAMPLES + 1)[:, None]
    inside = np.clip(t, 0.0, position.duration)
    travel = np.abs(position(inside.ravel())[:, 0].reshape(inside.shape) - position(inside[0])[:, 0])
    beyond = [travel > part * resolution for part in (1.0, 8.0)]
    one, eight = (np.maximum(flags.argmax(axis=0) - 1, 0) for flags in beyond)
    rows, columns = np.arange(len(t) - 1)[:, None], np.arange(len(seen))
    ripples = ((np.diff(travel, axis=0) < 0) & (rows >= one) & (rows < eight)).any(axis=0)
    return np.where(beyond[1].any(axis=0) & ~ripples, 2 * t[one, columns] - t[eight, columns], seen)


def _creeping(position: Piecewise, brief: Array) -> NDArray[np.bool_]:
    """Whether each component is at rest but for rounding on each interval, shape (n, m).

    A short interval in which it comes to rest, at most as long as `brief`, does not count: there it is slow, but
    brakes. In a recorded motion that holds for samples that are equal to the last digit too.
    """
    travel = 2 * np.abs(position.coefficients[1:]).sum(axis=0)
    creeping = travel <= STILL * np.minimum(1.0, _CREEP * position.lengths / position.duration)[:, None]
    still: NDArray[np.bool_] = (travel == 0) & (brief < REST_TIME)
    if (creeping == still).all():
        return still
    # From the end of the last interval that moves to the start of the next.
    ends, starts = (
        np.where(creeping, rest, own[:, None])
        for rest, own in ((0.0, position.offsets[1:]), (position.duration, position.offsets[:-1]))
    )
    since, until = np.maximum.accumulate(ends, axis=0), np.minimum.accumulate(starts[::-1], axis=0)[::-1]
    return np.asarray((creeping & (until - since >= brief)) | still)
