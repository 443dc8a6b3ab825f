"""Compare profiles on the same points."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.assessment import Assessment
from puma_septic.comparison._advice import make_profiles
from puma_septic.comparison._comparison import ComparedProfile, Comparison, Gap, Reference
from puma_septic.errors import InputError, NoSolution
from puma_septic.limit_check import AT_LIMIT
from puma_septic.motion import Motion
from puma_septic.objectives import Candidate, checked_objectives
from puma_septic.paths import ToolLimits
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import checked_array, checked_kind, checked_number, checked_texts, checked_times

__all__ = ["compare"]


def compare(
    robot: Robot,
    points: ArrayLike,
    times: ArrayLike,
    *,
    profiles: Sequence[str] | None = None,
    options: Mapping[str, Mapping[str, Any]] | None = None,
    beside: Mapping[str, Trajectory] | None = None,
    dwell: float = 0.0,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
    rest_before: bool = True,
    rest_after: bool = True,
    objectives: Sequence[str] = ("integral_of_squared_jerk", "overshoot", "via_miss"),
    own: Sequence[str] = (),
    reference: Callable[[Motion], Reference] | None = None,
) -> Comparison:
    """Run all suitable profiles through the same points and measure each exactly.

    Parameters
    ----------
    robot : Robot
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s. A profile that finds its own times (`double_s`) takes the robot's limits instead.
    profiles : sequence of str, optional
        Names out of `puma_septic.profiles.available`; all by default.
    options : mapping, optional
        Profile name to keyword arguments of its function. Where a blend time is needed and not given, it is half
        the shortest segment.
    beside : mapping, optional
        Other motions of the robot to be measured with them, such as a recorded one, by name.
    dwell : float
        Rest after the motion, in the root mean squares, s.
    floor : float, optional
        Height above the base that the arm must stay above, m.
    tool_limits : ToolLimits, optional
        What the tool may do at most.
    rest_before, rest_after : bool
        Whether the arm is at rest before the points and after them; of profiles alone, what stands `beside` them knows.
    objectives : sequence of str
        By which Pareto-optimal profiles are marked, and by the first of which the advice is given; names as in
        `puma_septic.objectives.OBJECTIVES`.
    own : sequence of str
        Profiles that are always shown and drawn, such as those of a task; of two that give the same motion it is
        these that stay.
    reference : callable, optional
        Of the motion of each profile, such as `puma_septic.time_optimal` (some seconds each): the quickest motion along
        the same path under the same limits, for the *gap*, what the profile's time law costs.

    Returns
    -------
    Comparison
        With advice which one to take; profiles that do not suit are listed with the reason.

    Raises
    ------
    InputError
        For points or times that are not valid, an unknown profile or objective, or if no profile suits.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = [[0.0] * 6, [0.5] * 6, [1.0] * 6]
    >>> result = compare(ps.load_robot(), move, [0.0, 1.0, 2.0], profiles=["quintic", "quintic_spline"])
    >>> [(row.name, row.stops_at_vias) for row in result.profiles]
    [('quintic', True), ('quintic_spline', False)]
    """
    n_joints = checked_kind("robot", robot, Robot).n_joints
    vias = checked_array("points", points, (None, n_joints), unit="rad")
    if len(vias) < 2:
        raise InputError(f"a comparison needs at least 2 points, got {len(vias)}")
    instants = checked_times("times", times, len(vias))
    dwell = checked_number("dwell", dwell, unit="s", at_least=0.0)
    chosen = checked_objectives(objectives)
    names = None if profiles is None else checked_texts("profiles", profiles)
    given = {} if options is None else checked_kind("options", options, Mapping)
    made, unsuitable = make_profiles(robot, vias, instants, names=names, options=given, own=checked_texts("own", own))
    made = {name: one.resting(before=rest_before, after=rest_after) for name, one in made.items()}
    others = {} if beside is None else checked_kind("beside", beside, Mapping)
    made = {**{name: checked_kind(f"beside {name!r}", one, Trajectory) for name, one in others.items()}, **made}
    if not made:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in unsuitable.items())
        raise InputError(f"no profile suits these points and times: {reasons}")
    candidates = {
        name: Candidate(trajectory=trajectory, robot=robot, dwell=dwell, floor=floor, tool_limits=tool_limits)
        for name, trajectory in made.items()
    }
    rows = tuple(
        ComparedProfile(
            name=name,
            assessment=candidate.assessment,
            objectives={objective.name: objective.value(candidate) for objective in chosen},
            gap=None if reference is None else _gap(candidate, reference),
        )
        for name, candidate in candidates.items()
    )
    shown = tuple(name for name in dict.fromkeys([*(beside or {}), *own]) if name in made)
    return Comparison(points=vias, times=instants, profiles=rows, unsuitable=unsuitable, objectives=chosen, own=shown)


def _hopeless(assessment: Assessment) -> str:
    """What a reference does not know and no duration mends, the floor and the rest after the motion; else empty."""
    floor = assessment.floor_check
    if floor is not None and floor.is_violated:
        return f"{floor}; that is violated at any speed"
    if not assessment.dwell:
        return ""
    robot, hold = assessment.motion.robot, np.abs(assessment.holding_torque)
    beyond = np.flatnonzero(hold > robot.limits.effort * (1 + AT_LIMIT))
    names = ", ".join(robot.joint_names[j] for j in beyond)
    return f"the rest after the motion takes more than the effort limit of {names}" if names else ""


def _gap(candidate: Candidate, reference: Callable[[Motion], Reference]) -> Gap:
    if candidate.tool_limits is not None:
        return Gap(reason="the reference knows no limits of the tool")
    if why := _hopeless(candidate.assessment):
        return Gap(reason=f"no stretch of time helps: {why}")
    try:
        found = reference(candidate.motion)
    except (InputError, NoSolution) as error:
        return Gap(reason=str(error))
    return Gap(least_duration=found.given.duration, reference_duration=found.certified.duration)
