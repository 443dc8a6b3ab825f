"""Double-S: seven phases of constant jerk under limits of velocity, acceleration and jerk."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.checks import Array
from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.profiles._asynchronous import side_by_side
from puma_septic.profiles._vias import boundary, checked_points, joint_labels, named
from puma_septic.trajectory import Trajectory

__all__ = ["double_s"]

# A duration is met to this part of it.
_SAME_DURATION = 1e-12


class _Bounds(NamedTuple):
    """One joint's limits."""

    velocity: float
    acceleration: float
    jerk: float


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
    vias = checked_points("double_s", points)
    n, names = vias.shape[1], named(joint_names)
    labels = joint_labels(names, n)
    given = (("max_velocity", max_velocity), ("max_acceleration", max_acceleration), ("max_jerk", max_jerk))
    units = ("rad/s", "rad/s^2", "rad/s^3")
    limits = [_limit(name, value, labels, unit) for (name, value), unit in zip(given, units, strict=True)]
    bounds = [_Bounds(*map(float, row)) for row in zip(*limits, strict=True)]
    velocities = np.zeros_like(vias)
    velocities[0] = boundary("start_velocity", start_velocity, n, "rad/s")
    velocities[-1] = boundary("end_velocity", end_velocity, n, "rad/s")
    segments = [_segment(k, vias[k : k + 2], velocities[k : k + 2], bounds, labels) for k in range(len(vias) - 1)]
    times = np.concatenate([[0.0], np.cumsum([lengths.sum(axis=0)[0] for lengths, _ in segments])])
    return Trajectory(
        position=_joined(vias, velocities, times, segments),
        points=vias,
        times=times,
        profile="double_s",
        joint_names=names,
    )


def _limit(name: str, value: ArrayLike | None, labels: Sequence[str], unit: str) -> Array:
    """A positive limit for each joint."""
    if value is None:
        raise InputError(f"double_s needs {name}, in {unit}: it is the limits that determine its times")
    unknown = np.isnan(np.asarray(value, dtype=np.float64))
    if unknown.any():
        which = labels if unknown.ndim == 0 else [label for label, one in zip(labels, unknown, strict=False) if one]
        raise InputError(f"{', '.join(which)}: {name} is unknown (nan), but double_s needs it, in {unit}")
    limit = boundary(name, value, len(labels), unit)
    if not (limit > 0).all():
        j = int(np.argmax(~(limit > 0)))
        raise InputError(f"{labels[j]}: {name} = {limit[j]:g} {unit} must be positive")
    return limit


def _segment(
    k: int, points: Array, velocities: Array, bounds: Sequence[_Bounds], labels: Sequence[str]
) -> tuple[Array, Array]:
    """Lengths (s) and jerks (rad/s^3) of the seven phases of each joint, each of shape (7, n_joints)."""
    h = np.diff(points, axis=0)[0]
    sign = np.where(h < 0, -1.0, 1.0)
    ways = zip(sign * h, *(sign * velocities), bounds, labels, strict=True)
    moves = [_fastest(x, v0, v1, limits, f"{label}, segment {k + 1}") for x, v0, v1, limits, label in ways]
    phases = [_phases(move, move.cruise) for move in moves]
    shortest = np.array([lengths.sum() for lengths, _ in phases])
    duration = float(shortest.max())
    if duration == 0:
        raise InputError(f"segment {k + 1}: equal points leave it without duration")
    slowest = labels[int(np.argmax(shortest))]
    for j, move in enumerate(moves):
        phases[j] = _in_step(move, phases[j], duration, f"{labels[j]}, segment {k + 1}", slowest)
    lengths, jerks = (np.stack(arrays, axis=1) for arrays in zip(*phases, strict=True))
    return lengths, jerks * sign


def _ramp_time(change: float, bounds: _Bounds) -> float:
    """Duration of a change of velocity."""
    size = abs(change)
    if size > bounds.acceleration**2 / bounds.jerk:
        return size / bounds.acceleration + bounds.acceleration / bounds.jerk
    return float(2 * np.sqrt(size / bounds.jerk))


def _ramp(change: float, bounds: _Bounds) -> tuple[list[float], list[float]]:
    """Lengths and jerks of its three phases."""
    rise = min(bounds.acceleration / bounds.jerk, float(np.sqrt(abs(change) / bounds.jerk)))
    jerk = bounds.jerk if change > 0 else -bounds.jerk
    return [rise, max(_ramp_time(change, bounds) - 2 * rise, 0.0), rise], [jerk, 0.0, -jerk]


def _ramp_distance(v0: float, cruise: float, v1: float, bounds: _Bounds) -> float:
    """Covered by both ramps."""
    up, down = _ramp_time(cruise - v0, bounds), _ramp_time(v1 - cruise, bounds)
    return (v0 + cruise) / 2 * up + (cruise + v1) / 2 * down


def _fastest(h: float, v0: float, v1: float, bounds: _Bounds, label: str) -> _Move:
    """The highest cruise velocity within the limit whose ramps fit into h >= 0."""
    for which, v in (("start_velocity", v0), ("end_velocity", v1)):
        if abs(v) > bounds.velocity:
            raise InputError(f"{label}: {which} of {abs(v):g} rad/s exceeds max_velocity = {bounds.velocity:g} rad/s")
    # Above this velocity the distance of the ramps grows with the cruise velocity.
    least = max(v0, v1, 0.0)
    needed = _ramp_distance(v0, least, v1, bounds)
    if needed > h * (1 + 1e-12):
        raise InputError(
            f"{label}: the velocity cannot change from {v0:g} to {v1:g} rad/s (along the movement) within"
            f" {h:g} rad: with max_acceleration = {bounds.acceleration:g} rad/s^2 and max_jerk ="
            f" {bounds.jerk:g} rad/s^3 that takes {needed:g} rad; lower the velocities or raise the limits"
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


def _phases(move: _Move, cruise: float) -> tuple[Array, Array]:
    """Lengths and jerks of the seven phases with this cruise velocity."""
    up, up_jerk = _ramp(cruise - move.v0, move.bounds)
    down, down_jerk = _ramp(move.v1 - cruise, move.bounds)
    rest = move.h - _ramp_distance(move.v0, cruise, move.v1, move.bounds)
    # What rounding leaves between the ramps is no phase.
    coasting = rest / cruise if rest > 1e-12 * move.h else 0.0
    return np.array([*up, coasting, *down]), np.array([*up_jerk, 0.0, *down_jerk])


def _in_step(
    move: _Move, fastest: tuple[Array, Array], duration: float, label: str, slowest: str
) -> tuple[Array, Array]:
    """The phases of a motion that takes exactly `duration`, which is not less than that of the fastest."""
    lengths, jerks = fastest
    total = float(lengths.sum())
    if move.v0 == move.v1 == 0:
        if move.h == 0:
            return np.full(7, duration / 7), np.zeros(7)
        return lengths * (duration / total), jerks * (total / duration) ** 3
    if duration - total > _SAME_DURATION * duration:
        lengths, jerks = _phases(move, _slower_cruise(move, duration, label, slowest))
    return lengths * (duration / lengths.sum()), jerks


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
        f"{label}: it cannot be slowed down to the {duration:g} s that {slowest} takes: from {move.v0:g} to"
        f" {move.v1:g} rad/s (along the movement) with max_acceleration = {move.bounds.acceleration:g}"
        f" rad/s^2 and max_jerk = {move.bounds.jerk:g} rad/s^3, {move.h:g} rad leave no room for it; lower its"
        " start or end velocity or raise its limits"
    )


def _joined(points: Array, velocities: Array, times: Array, segments: Sequence[tuple[Array, Array]]) -> Piecewise:
    """All phases as powers of their own normalised time, from the states that the jerks lead to."""
    starts, powers = [], []
    for k, (lengths, jerks) in enumerate(segments):
        q, v, a = points[k], velocities[k], np.zeros(points.shape[1])
        starts.append(times[k] + np.concatenate([np.zeros((1, len(q))), np.cumsum(lengths, axis=0)[:-1]]))
        for T, j in zip(lengths, jerks, strict=True):
            powers.append([q, v * T, a * T**2 / 2, j * T**3 / 6])
            q, v, a = q + v * T + a * T**2 / 2 + j * T**3 / 6, v + a * T + j * T**2 / 2, a + j * T
    starts.append(np.full((1, points.shape[1]), times[-1]))
    return side_by_side(np.concatenate(starts), np.moveaxis(np.array(powers), 1, 0))
