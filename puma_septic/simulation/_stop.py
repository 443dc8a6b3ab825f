"""Stops of a motion: how long they take and how far the arm goes. A prediction, not a safety function."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.document import card, one_line
from puma_septic.dynamics import check_inertia
from puma_septic.errors import InputError, NoSolution
from puma_septic.kinematics import forward_kinematics
from puma_septic.motion import Motion, compute_motion
from puma_septic.robot import Robot
from puma_septic.simulation._stop_categories import brake, path_of, slow_down, stopping_trajectory
from puma_septic.validation import (
    Array,
    checked_choice,
    checked_each,
    checked_kind,
    checked_number,
    read_only,
)

__all__ = [
    "CATEGORIES",
    "NOT_A_SAFETY_FUNCTION",
    "Stop",
    "WorstStop",
    "checked_brakes",
    "known_limits",
    "stop",
    "worst_stop",
]

CATEGORIES: Final = {
    0: "power off at once, brakes after their reaction time",
    1: "controlled, along the path at the torque limits",
}
"""Categories of IEC 60204-1 that are predicted; of category 1, the power goes off once the arm is at rest."""

NOT_A_SAFETY_FUNCTION: Final = (
    "A prediction from a model, not a safety function: distances for a safeguard are measured on the machine"
    " (ISO 10218-1, ISO 13855)."
)

# What the deceleration leaves of the torque limits, so that the full assessment keeps them: tried in turn.
_MARGINS: Final = (5e-4, 2e-3, 8e-3, 3e-2)
# The places of the tool that its displacement is taken from.
_PLACES: Final = 101


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Stop:
    """How an arm comes to rest from an instant of a motion; not a safety function.

    Attributes
    ----------
    motion : Motion
        What is stopped.
    t : float
        When the stop is commanded, on the motion's clock, s.
    category : int
        One of `CATEGORIES`.
    reaction_time : float
        s; until then a controlled stop goes on as planned, and brakes do not grip.
    duration : float
        From the command to rest, s; infinite where the arm still moves 5 s later under its brakes.
    times, q : ndarray, shapes (k,) and (k, n_joints)
        Samples from the command on, s since it, rad (m).
    stopping : Motion or None
        The motion of a controlled stop after the reaction time, whose torque is that of the full assessment.
    """

    motion: Motion
    t: float
    category: int
    reaction_time: float
    duration: float
    times: Array
    q: Array
    stopping: Motion | None

    @cached_property
    def distance(self) -> Array:
        """The largest displacement of each joint from where it is at the command, rad (m), shape (n_joints,)."""
        return np.asarray(np.abs(self.q - self.q[0]).max(axis=0))

    @cached_property
    def tool_distance(self) -> float:
        """The largest displacement of the tool from where it is at the command, m."""
        return _tool_distance(self.motion.robot, self.q)

    def __repr__(self) -> str:
        return one_line("Stop", self._facts())

    def _repr_html_(self) -> str:
        return card("Stop", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "category": self.category,
            "at": f"{self.t:.4g} s",
            "duration": f"{self.duration:.4g} s",
            "tool": f"{1e3 * self.tool_distance:.3g} mm",
            "note": NOT_A_SAFETY_FUNCTION,
        }

    def __str__(self) -> str:
        joints = ", ".join(
            f"{name} {value:.3g}" for name, value in zip(self.motion.robot.joint_names, self.distance, strict=True)
        )
        took = "does not hold" if np.isinf(self.duration) else f"{1e3 * self.duration:.4g} ms"
        return (
            f"Stop of category {self.category} at {self.t:.4g} s: {took}; joints {joints} rad (m); tool"
            f" {1e3 * self.tool_distance:.3g} mm. {NOT_A_SAFETY_FUNCTION}"
        )


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class WorstStop:
    """Stops from many instants of a motion, samples of it: how long each takes and how far it goes.

    Attributes
    ----------
    times : ndarray, shape (k,)
        When each is commanded, s.
    durations : ndarray, shape (k,)
        s; infinite where brakes do not hold, NaN where the torque limits allow no stop on the path.
    distances : ndarray, shape (k, n_joints)
        rad (m).
    tool_distances : ndarray, shape (k,)
        m.
    """

    times: Array
    durations: Array
    distances: Array
    tool_distances: Array

    @property
    def longest(self) -> tuple[float, float]:
        """The instant of the longest stop, and its duration, s."""
        k = int(np.nanargmax(self.durations))
        return float(self.times[k]), float(self.durations[k])

    @property
    def farthest(self) -> tuple[Array, Array]:
        """For each joint the instant of its largest displacement, and that, shapes (n_joints,)."""
        k = np.nanargmax(self.distances, axis=0)
        return self.times[k], np.take_along_axis(self.distances, k[None], axis=0)[0]


def stop(
    motion: Motion,
    t: float,
    *,
    category: int = 1,
    brake_torque: ArrayLike | None = None,
    reaction_time: float | None = None,
) -> Stop:
    """Stop a motion at an instant, and measure time and distance.

    Category 1 brakes along the path as hard as the torque limits allow; its torque is assessed in full and holds them.
    Category 0 takes the power off: after the reaction time brakes hold against each joint's motion, the arm's friction
    helps from the beginning. It is a prediction, not a safety function.

    Parameters
    ----------
    motion : Motion
        Made by `compute_motion`.
    t : float
        When, on the motion's clock, s.
    category : {0, 1}
    brake_torque : array_like, shape (n_joints,)
        Of category 0, at the joints, N m (N), at least 0; no robot description has it.
    reaction_time : float
        s. Of category 0 needed, of category 1 by default 0.

    Returns
    -------
    Stop

    Raises
    ------
    InputError
        For an instant outside the motion, an unknown category, brakes without data, or joints without a torque limit.
    NoSolution
        If the torque limits allow no stop along the path from there, as where the motion breaks them.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> motion = ps.compute_motion(robot, ps.quintic_segments([[0.0] * 6, [1.0] * 6], [0.0, 1.5]))
    >>> controlled = ps.stop(motion, 0.75)
    >>> braked = ps.stop(motion, 0.75, category=0, brake_torque=[50.0] * 6, reaction_time=0.02)
    >>> 0.03 < controlled.duration < 0.05, bool(braked.distance[0] > 0.01)
    (True, True)
    """
    checked_kind("motion", motion, Motion)
    if not isinstance(category, int) or category not in CATEGORIES or isinstance(category, bool):
        known = "; ".join(f"{number}: {meaning}" for number, meaning in CATEGORIES.items())
        raise InputError(f"category = {category!r}: unknown; {known}")
    first, last = motion.trajectory.breaks[[0, -1]]
    t = checked_number("t", t, unit="s", at_least=float(first), at_most=float(last))
    check_inertia(motion.robot)
    if category == 0:
        return _braked(motion, t, *checked_brakes(motion.robot, brake_torque, reaction_time))
    if brake_torque is not None:
        raise InputError("brake_torque goes with category=0; a controlled stop is made by the motors")
    reaction = checked_number("reaction_time", 0.0 if reaction_time is None else reaction_time, unit="s", at_least=0.0)
    return _controlled(motion, t, reaction)


def worst_stop(
    motion: Motion,
    *,
    category: int = 1,
    brake_torque: ArrayLike | None = None,
    reaction_time: float | None = None,
    instants: int = 101,
) -> WorstStop:
    """Stops from equidistant instants of a motion, all at once: which is the longest, and which goes farthest.

    Parameters
    ----------
    motion : Motion
    category, brake_torque, reaction_time
        As of `stop`.
    instants : int
        How many, from the start to the end.

    Returns
    -------
    WorstStop

    Raises
    ------
    InputError
        As `stop`.
    """
    robot, trajectory = motion.robot, motion.trajectory
    count = int(checked_number("instants", instants, at_least=2))
    first, last = (float(end) for end in trajectory.breaks[[0, -1]])
    times = np.linspace(first, last, count)
    check_inertia(robot)
    if checked_choice("category", str(category), [str(one) for one in CATEGORIES]) == "0":
        torque, reaction = checked_brakes(robot, brake_torque, reaction_time)
        made = brake(robot, trajectory(times), trajectory(times, 1), torque, reaction)
        durations, visited = made.durations, made.q
    else:
        reaction = checked_number("reaction_time", reaction_time or 0.0, unit="s", at_least=0.0)
        begun = np.minimum(times - first + reaction, trajectory.duration)
        path = path_of(trajectory)
        slowing = slow_down(robot, path, begun, known_limits(robot) * (1 - _MARGINS[0]))
        left = np.minimum(slowing.lengths.sum(axis=0), trajectory.duration - begun)
        durations = np.where(slowing.is_possible, reaction + left, np.nan)
        visited = np.array([path(s)[0] for s in [times - first, *slowing.s]])
    distances = np.abs(visited - visited[0]).max(axis=0)
    distances[np.isnan(durations)] = np.nan
    return WorstStop(
        times=read_only(times),
        durations=read_only(durations),
        distances=read_only(distances),
        tool_distances=read_only([_tool_distance(robot, visited[:, k]) for k in range(count)]),
    )


def checked_brakes(robot: Robot, brake_torque: ArrayLike | None, reaction_time: float | None) -> tuple[Array, float]:
    """Torque and reaction time of the brakes, which nobody can guess."""
    missing = [
        name for name, value in (("brake_torque", brake_torque), ("reaction_time", reaction_time)) if value is None
    ]
    if brake_torque is None or reaction_time is None:
        raise InputError(
            f"a stop of category 0 needs {' and '.join(missing)}: the torque of each joint's brake, N m at the joint,"
            " and the time until they grip, s; no robot description has them"
        )
    labels = [f"joint {name!r}" for name in robot.joint_names]
    torque = checked_each("brake_torque", brake_torque, robot.n_joints, unit="N m", labels=labels, at_least=0.0)
    return torque, checked_number("reaction_time", reaction_time, unit="s", at_least=0.0)


def known_limits(robot: Robot) -> Array:
    """The torque limits; a controlled stop needs one of every joint."""
    unknown = np.isnan(robot.limits.effort)
    if unknown.any():
        names = ", ".join(np.array(robot.joint_names)[unknown])
        raise InputError(f"a controlled stop needs the torque limit of every joint; not known of {names}")
    return robot.limits.effort


def _braked(motion: Motion, t: float, torque: Array, reaction: float) -> Stop:
    trajectory = motion.trajectory
    made = brake(motion.robot, trajectory(t)[None], trajectory(t, 1)[None], torque, reaction)
    return Stop(
        motion=motion,
        t=t,
        category=0,
        reaction_time=reaction,
        duration=float(made.durations[0]),
        times=read_only(made.t),
        q=read_only(made.q[:, 0]),
        stopping=None,
    )


def _controlled(motion: Motion, t: float, reaction: float) -> Stop:
    """As planned until the reaction time has passed, then down; the margin to the limits grows until they are held."""
    robot, trajectory = motion.robot, motion.trajectory
    limits, (start, end) = known_limits(robot), trajectory.breaks[[0, -1]].tolist()
    begun = min(t + reaction, end)
    before = trajectory(np.linspace(t, begun, _PLACES)) if begun > t else trajectory(t)[None]
    times = np.linspace(0.0, begun - t, _PLACES) if begun > t else np.zeros(1)
    if begun == end or not np.abs(trajectory(begun, 1)).max() > 0:
        return _stop_of(motion, t, reaction, times, before, None)
    for margin in _MARGINS:
        slowing = slow_down(robot, path_of(trajectory), np.array([begun - start]), limits * (1 - margin))
        if not slowing.is_possible[0]:
            break
        if slowing.s[-1, 0] >= trajectory.duration:  # the motion ends before, as planned
            after = np.linspace(begun, end, _PLACES)[1:]
            times, q = np.concatenate([times, after - t]), np.concatenate([before, trajectory(after)])
            return _stop_of(motion, t, reaction, times, q, None)
        stopping = compute_motion(robot, stopping_trajectory(trajectory, slowing, 0, t))
        if (stopping.torque.extrema().peak <= limits).all():
            after = np.linspace(0.0, stopping.trajectory.duration, _PLACES)[1:]
            times = np.concatenate([times, begun - t + after])
            return _stop_of(motion, t, reaction, times, np.concatenate([before, stopping.trajectory(after)]), stopping)
    raise NoSolution(
        f"no stop along the path at t = {t:.4g} s keeps the torque limits"
        f"{_broken(motion, begun, limits)}; category 0 leaves the path",
        residual=float(np.abs(trajectory(begun, 1)).max()),
        q=trajectory(begun),
    )


def _broken(motion: Motion, t: float, limits: Array) -> str:
    """Which joint breaks its limit there as planned."""
    over = np.abs(motion.torque(t)) / limits
    j = int(np.argmax(over))
    if not over[j] > 1:
        return ""
    return f": as planned joint {motion.robot.joint_names[j]!r} is at {100 * over[j]:.4g} % of its own"


def _stop_of(motion: Motion, t: float, reaction: float, times: Array, q: Array, stopping: Motion | None) -> Stop:
    return Stop(
        motion=motion,
        t=t,
        category=1,
        reaction_time=reaction,
        duration=float(times[-1]),
        times=read_only(times),
        q=read_only(q),
        stopping=stopping,
    )


def _tool_distance(robot: Robot, q: Array) -> float:
    some = q[np.unique(np.linspace(0, len(q) - 1, min(len(q), _PLACES)).astype(int))]
    places = forward_kinematics(robot, some)[:, :3, 3]
    return float(np.linalg.norm(places - places[0], axis=1).max())
