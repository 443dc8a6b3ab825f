"""Double-S: seven phases of constant jerk under limits of velocity, acceleration and jerk."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.profiles._asynchronous import Phases, side_by_side
from puma_septic.profiles._info import BIAGIOTTI, ProfileInfo
from puma_septic.profiles._vias import Vias, boundary, checked_points, joint_labels, named
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_each, numbers

__all__ = ["DOUBLE_S", "double_s"]

DOUBLE_S = ProfileInfo(
    name="double_s",
    continuity="C2",
    inside="C2",
    needs="limits of velocity, acceleration and jerk (no times)",
    at_vias="stops",
    overshoots=False,
    source=f"{BIAGIOTTI}, 3.4",
)

# A duration is met to this part of it.
_SAME_DURATION = 1e-12
# The most that rounding was seen to shorten a phase by, doubled, in roundings of the whole duration; and the part of it
# below which that is more than 2e-11 of the phase.
_ROUNDINGS = 8
_SHORT = 1e-4
# A change of velocity below this part of the limit is rounding.
_NO_CHANGE = 1e-12
# A profile does not know which joints slide.
_UNITS = "(rad, or m if prismatic, and s)"


class _Bounds(NamedTuple):
    """One joint's limits."""

    velocity: float
    acceleration: float
    jerk: float


class _Plan(NamedTuple):
    """Lengths of the seven phases, and the changes of velocity of both ramps; of all joints, or of one."""

    lengths: Array
    up: Array
    down: Array


class _Move(NamedTuple):
    """One joint's way from (0, v0) to (h, v1), h >= 0, and the fastest motion's cruise velocity."""

    h: float
    v0: float
    v1: float
    bounds: _Bounds
    cruise: float


def double_s(
    points: ArrayLike,
    *,
    max_velocity: ArrayLike | None = None,
    max_acceleration: ArrayLike | None = None,
    max_jerk: ArrayLike | None = None,
    start_velocity: ArrayLike | None = None,
    end_velocity: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """The fastest motion of constant-jerk phases under limits, with a stop at each via and all joints in
    step.

    The velocity ramps up to a cruise velocity and down again, each ramp with jerk +-j_max and, if it lasts,
    constant acceleration a_max: a change of velocity dv takes ``dv/a_max + a_max/j_max``, or
    ``2 sqrt(dv/j_max)`` if that is reached before a_max, and covers its duration times the mean of both
    velocities. The cruise velocity is v_max, or the highest for which the ramps fit into the distance
    (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots). Each
    segment lasts as long as its slowest joint needs. The others are stretched in time, which lowers their
    velocity, acceleration and jerk; a joint that starts or ends in motion lowers its cruise velocity instead.
    The acceleration is continuous, the jerk a staircase.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    max_velocity, max_acceleration, max_jerk : array_like, shape () or (n_joints,)
        All needed, positive; rad/s, rad/s^2, rad/s^3.
    start_velocity, end_velocity : array_like, optional
        Shape () or (n_joints,), of the first and last point, rad/s; zero where not given.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        Whose times are those of the stops, from 0; with breaks where a phase of any joint begins.

    Raises
    ------
    InputError
        For limits that are missing or not positive; a start or end velocity above the limit; a segment too
        short for the change of velocity that is asked of it, or for slowing down to the duration of the other
        joints; a segment in which no joint moves.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.double_s([[0.0], [1.0]], max_velocity=2.0, max_acceleration=8.0, max_jerk=32.0)
    >>> float(move.duration), move.extrema(2).max.tolist()
    (1.0, [8.0])
    """
    q, names = checked_points("double_s", points), named(joint_names)
    labels = joint_labels(names, q.shape[1])
    given = (("max_velocity", max_velocity), ("max_acceleration", max_acceleration), ("max_jerk", max_jerk))
    units = [f"rad/s{power} (m/s{power} if prismatic)" for power in ("", "^2", "^3")]
    limits = [_limit(name, value, labels, unit) for (name, value), unit in zip(given, units, strict=True)]
    bounds = [_Bounds(*map(float, row)) for row in zip(*limits, strict=True)]
    velocities = np.zeros_like(q)
    velocities[0] = boundary("start_velocity", start_velocity, len(labels))
    velocities[-1] = boundary("end_velocity", end_velocity, len(labels))
    segments = [_segment(k, q[k : k + 2], velocities[k : k + 2], bounds, labels) for k in range(len(q) - 1)]
    phases = _timed(segments)
    _check_resolved(phases, segments, bounds, labels)
    vias = Vias.of("double_s", q, phases.starts[::7, 0], names)
    position = side_by_side(phases, _powers(vias, velocities, phases, segments))
    return vias.trajectory(position, start=velocities[0], end=velocities[-1])


def _limit(name: str, value: ArrayLike | None, labels: Sequence[str], unit: str) -> Array:
    """A positive limit for each joint."""
    if value is None:
        raise InputError(f"double_s needs {name}, in {unit}: it is the limits that determine its times")
    unknown = np.isnan(numbers(name, value))
    if unknown.any():
        which = labels if unknown.ndim == 0 else [label for label, one in zip(labels, unknown, strict=False) if one]
        whose = "all joints" if unknown.all() else ", ".join(which)
        raise InputError(f"double_s needs {name} in {unit}, which is unknown for {whose}")
    return checked_each(name, value, len(labels), labels=labels, above=0.0)


def _segment(k: int, points: Array, velocities: Array, bounds: Sequence[_Bounds], labels: Sequence[str]) -> _Plan:
    """The seven phases of each joint: lengths (7, n_joints), changes of velocity (n_joints,) along the movement."""
    h = np.diff(points, axis=0)[0]
    sign = np.where(h < 0, -1.0, 1.0)
    ways = zip(sign * h, *(sign * velocities), bounds, labels, strict=True)
    moves = [_fastest(x, v0, v1, limits, f"{label}, segment {k + 1}") for x, v0, v1, limits, label in ways]
    plans = [_plan(move, move.cruise) for move in moves]
    shortest = np.array([plan.lengths.sum() for plan in plans])
    duration = float(shortest.max())
    if duration == 0:
        raise InputError(f"segment {k + 1}: equal points leave it without duration")
    slowest = labels[int(np.argmax(shortest))]
    for j, move in enumerate(moves):
        plans[j] = _in_step(move, plans[j], duration, f"{labels[j]}, segment {k + 1}", slowest)
    lengths, up, down = zip(*plans, strict=True)
    return _Plan(np.stack(lengths, axis=1), sign * np.array(up), sign * np.array(down))


def _ramp_time(change: float, bounds: _Bounds) -> float:
    """Duration of a change of velocity."""
    size = abs(change)
    if size > bounds.acceleration**2 / bounds.jerk:
        return size / bounds.acceleration + bounds.acceleration / bounds.jerk
    return float(2 * np.sqrt(size / bounds.jerk))


def _ramp(change: float, bounds: _Bounds) -> list[float]:
    """Lengths of its three phases."""
    rise = min(bounds.acceleration / bounds.jerk, float(np.sqrt(abs(change) / bounds.jerk)))
    return [rise, max(_ramp_time(change, bounds) - 2 * rise, 0.0), rise]


def _ramp_distance(v0: float, cruise: float, v1: float, bounds: _Bounds) -> float:
    """Covered by both ramps."""
    up, down = _ramp_time(cruise - v0, bounds), _ramp_time(v1 - cruise, bounds)
    return (v0 + cruise) / 2 * up + (cruise + v1) / 2 * down


def _fastest(h: float, v0: float, v1: float, bounds: _Bounds, label: str) -> _Move:
    """The highest cruise velocity within the limit whose ramps fit into h >= 0."""
    for which, v in (("start_velocity", v0), ("end_velocity", v1)):
        if abs(v) > bounds.velocity:
            raise InputError(f"{label}: {which} of {abs(v):g} exceeds max_velocity = {bounds.velocity:g}")
    # Above this velocity the distance of the ramps grows with the cruise velocity.
    least = max(v0, v1, 0.0)
    needed = _ramp_distance(v0, least, v1, bounds)
    if needed > h * (1 + 1e-12):
        raise InputError(
            f"{label}: the velocity cannot change from {v0:g} to {v1:g} (along the movement) within {h:g}: with"
            f" max_acceleration = {bounds.acceleration:g} and max_jerk = {bounds.jerk:g} that takes {needed:g}"
            f" {_UNITS}; lower the velocities or raise the limits"
        )
    if needed >= h:
        return _Move(h, v0, v1, bounds, least)
    if _ramp_distance(v0, bounds.velocity, v1, bounds) <= h:
        return _Move(h, v0, v1, bounds, bounds.velocity)
    # The excess over `least` is sought, not the velocity: near `least` the ramps change like its square root.
    excess = _root(lambda x: _ramp_distance(v0, least + x, v1, bounds) - h, 0.0, bounds.velocity - least)
    return _Move(h, v0, v1, bounds, least + excess)


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    """A zero of f, not positive at `low` and positive at `high`, by bisection to the last digit."""
    while True:
        middle = (low + high) / 2
        if not low < middle < high:
            return low
        low, high = (low, middle) if f(middle) > 0 else (middle, high)


def _plan(move: _Move, cruise: float) -> _Plan:
    """The seven phases with this cruise velocity."""
    up, down = cruise - move.v0, move.v1 - cruise
    rest = move.h - _ramp_distance(move.v0, cruise, move.v1, move.bounds)
    # What rounding leaves between the ramps is no phase.
    coasting = rest / cruise if rest > 1e-12 * move.h else 0.0
    lengths = np.array([*_ramp(up, move.bounds), coasting, *_ramp(down, move.bounds)])
    return _Plan(lengths, np.asarray(up), np.asarray(down))


def _in_step(move: _Move, fastest: _Plan, duration: float, label: str, slowest: str) -> _Plan:
    """The phases of a motion that takes exactly `duration`, which is not less than that of the fastest."""
    total = float(fastest.lengths.sum())
    if move.v0 == move.v1 == 0:
        if move.h == 0:
            return _Plan(np.full(7, duration / 7), np.zeros(()), np.zeros(()))
        slower = duration / total
        return _Plan(fastest.lengths * slower, fastest.up / slower, fastest.down / slower)
    plan = fastest
    if duration - total > _SAME_DURATION * duration:
        plan = _plan(move, _slower_cruise(move, duration, label, slowest))
    return plan._replace(lengths=plan.lengths * (duration / plan.lengths.sum()))


def _slower_cruise(move: _Move, duration: float, label: str, slowest: str) -> float:
    """The cruise velocity with which the motion takes `duration`."""

    def left_over(cruise: float) -> tuple[float, float]:
        """Distance between the ramps, and what is missing to the duration."""
        distance = move.h - _ramp_distance(move.v0, cruise, move.v1, move.bounds)
        ramps = _ramp_time(cruise - move.v0, move.bounds) + _ramp_time(move.v1 - cruise, move.bounds)
        return distance, duration - ramps - distance / cruise

    def sign(cruise: float, without_room: float) -> float:
        distance, missing = left_over(cruise)
        return without_room if distance < 0 else missing

    # At exactly the velocities at the ends a ramp vanishes, like a square root, which bisection would miss by
    # 1e-8. Otherwise there may be two ranges of cruise velocities that leave room for the ramps, one down to
    # 0.
    slowest_tried = 1e-15 * move.cruise
    candidates = [
        move.v0,
        move.v1,
        _root(lambda v: sign(v, -1.0), slowest_tried, move.cruise),
        _root(lambda v: sign(v, 1.0), slowest_tried, move.cruise),
    ]
    for cruise, tolerance in zip(candidates, (1e-12, 1e-12, 1e-7, 1e-7), strict=True):
        if cruise > 0:
            distance, missing = left_over(cruise)
            if distance >= 0 and abs(missing) <= tolerance * duration:
                return cruise
    raise InputError(
        f"{label}: it cannot be slowed down to the {duration:g} s that {slowest} takes: from {move.v0:g} to {move.v1:g}"
        f" (along the movement) with max_acceleration = {move.bounds.acceleration:g} and max_jerk ="
        f" {move.bounds.jerk:g}, a way of {move.h:g} {_UNITS} leaves no room for it; lower its start or end velocity or"
        " raise its limits"
    )


def _timed(segments: Sequence[_Plan]) -> Phases:
    """All phases in a row, on common breaks.

    Rounding of the instants, and joints that turn round at the same one but for rounding, may shorten a phase by some
    roundings of the whole duration, and with it raise the jerk of a very short one beyond its limit: such a phase is
    made longer by as many.
    """
    lengths = np.stack([segment.lengths for segment in segments])
    total = lengths[:, :, 0].sum()
    ramps = lengths[:, [0, 2, 4, 6]]
    is_short = ((ramps > 0) & (ramps < _SHORT * total)).any(axis=(1, 2), keepdims=True)
    # In all joints alike: those that turn round together must do so to the last digit.
    lengths[:, [0, 2, 4, 6]] += _ROUNDINGS * np.spacing(total) * (is_short & (ramps > 0))
    durations = lengths.sum(axis=1).max(axis=1)
    ends = np.cumsum(durations)
    within = np.cumsum(lengths, axis=1)[:, :-1]
    starts = np.concatenate([np.zeros_like(within[:, :1]), within], axis=1)
    starts = np.minimum(starts, durations[:, None, None]) + (ends - durations)[:, None, None]
    n = lengths.shape[2]
    return Phases.from_starts(np.concatenate([starts.reshape(-1, n), np.full((1, n), ends[-1])]))


def _check_resolved(
    phases: Phases, segments: Sequence[_Plan], bounds: Sequence[_Bounds], labels: Sequence[str]
) -> None:
    """Refuse a ramp whose jerk would act for less than the resolution of time."""
    n = len(labels)
    kept = phases.lengths.reshape(-1, 7, n)
    changes = np.stack([[s.up, s.down] for s in segments])
    speeds = np.array([b.velocity for b in bounds])
    lost = (kept[:, [[0, 2], [4, 6]]] == 0).any(axis=2) & (np.abs(changes) > _NO_CHANGE * speeds)
    if lost.any():
        k, ramp, j = np.argwhere(lost)[0]
        length = segments[k].lengths[4 * ramp, j]
        end = phases.starts[-1, j]
        raise InputError(
            f"{labels[j]}, segment {k + 1}: with max_acceleration = {bounds[j].acceleration:g} and max_jerk ="
            f" {bounds[j].jerk:g} {_UNITS} its jerk acts for {length:g} s at t ="
            f" {phases.starts[7 * k + 4 * ramp, j]:.9g} s, which double precision does not resolve in a motion of"
            f" {end:g} s; lower max_jerk, or take profile trapezoidal, which has no limit of jerk"
        )


def _powers(vias: Vias, velocities: Array, phases: Phases, segments: Sequence[_Plan]) -> Array:
    """Powers of each phase's normalised time, shape (4, 7 segments, n_joints)."""
    h, v0, v1 = np.diff(vias.q, axis=0), velocities[:-1], velocities[1:]
    lengths = phases.lengths.reshape(len(segments), 7, -1).swapaxes(0, 1)
    up_area, up_mean = _shape_of_ramp(lengths[:3])
    down_area, down_mean = _shape_of_ramp(lengths[4:])
    # From rest to rest the lengths determine the cruise velocity, and with it both ramps.
    way = up_mean + lengths[3] + lengths[4:].sum(axis=0) - down_mean
    from_rest = (v0 == 0) & (v1 == 0)
    up = np.where(from_rest, h / way, np.stack([s.up for s in segments]))
    down = np.where(from_rest, -up, np.stack([s.down for s in segments]))
    rise, fall = (np.divide(x, a, out=np.zeros_like(x), where=a > 0) for x, a in ((up, up_area), (down, down_area)))
    none = np.zeros_like(rise)
    start = np.stack([none, rise, rise, none, none, fall, fall])
    end = np.stack([rise, rise, none, none, fall, fall, none])
    changes = (start + end) / 2 * lengths
    # Forward from the start and backward from the end, so that both are met exactly.
    forward, backward = np.cumsum(changes[:3], axis=0), np.cumsum(changes[:3:-1], axis=0)[::-1]
    v = np.concatenate([v0[None], v0 + forward, v1 - backward])
    moved = v * lengths + (2 * start + end) * lengths**2 / 6
    ahead, behind = np.cumsum(moved[:3], axis=0), np.cumsum(moved[:3:-1], axis=0)[::-1]
    q = np.concatenate([vias.q[None, :-1], vias.q[:-1] + ahead, vias.q[1:] - behind])
    powers = np.stack([q, v * lengths, start * lengths**2 / 2, (end - start) * lengths**2 / 6])
    return powers.swapaxes(1, 2).reshape(4, -1, vias.n_joints)


def _shape_of_ramp(lengths: Array) -> tuple[Array, Array]:
    """Integral over time of a ramp's acceleration that is 1 at its top, and that integral's own, relative to it."""
    rise, top, fall = lengths
    area = rise / 2 + top + fall / 2
    twice = rise**2 / 6 + rise / 2 * top + top**2 / 2 + (rise / 2 + top) * fall + fall**2 / 3
    return area, np.divide(twice, area, out=np.zeros_like(area), where=area > 0)
