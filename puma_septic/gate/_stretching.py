"""The least uniform stretch of time by which a planned trajectory keeps its limits, and the message that it becomes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, Final, final

from puma_septic.assessment import Assessment, LimitCheck
from puma_septic.dynamics import check_inertia
from puma_septic.errors import NoSolution
from puma_septic.gate._checking import TrajectoryCheck, check_trajectory
from puma_septic.limits import assessed_at, feasible_rates
from puma_septic.motion import compute_motion
from puma_septic.paths import ToolLimits
from puma_septic.robot import Robot
from puma_septic.ros import JointTrajectoryMessage, PlannedTrajectory, interpolated
from puma_septic.trajectory import Trajectory

__all__ = ["Fixed", "Stretch", "fixed", "least_stretch"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Stretch:
    """A trajectory that keeps its limits by taking longer; made by `least_stretch`.

    Attributes
    ----------
    factor : float
        Its duration over the original one, at least 1.
    trajectory : Trajectory
    assessment : Assessment
        It keeps every known limit.
    governing : LimitCheck or None
        The limit that a shorter motion would break; None where nothing has to be stretched.
    """

    factor: float
    trajectory: Trajectory
    assessment: Assessment
    governing: LimitCheck | None


def least_stretch(
    robot: Robot, trajectory: Trajectory, *, floor: float | None = None, tool_limits: ToolLimits | None = None
) -> Stretch:
    """The least uniform stretch of time, 1 or more, by which a motion from rest to rest keeps all known limits.

    The largest of the rates that `minimum_duration` finds, up to 1: a longer motion need not be feasible. The result is
    assessed in full.

    Parameters
    ----------
    robot : Robot
    trajectory : Trajectory
    floor, tool_limits : optional
        What the cell asks: as `assess` takes them.

    Returns
    -------
    Stretch

    Raises
    ------
    InputError
        For friction that is not viscous plus constant: its torque is no polynomial of the rate.
    NoSolution
        Where no stretch helps: a position beyond its bound, a step of velocity or, under a jerk limit, of
        acceleration, a torque that gravity and friction alone break, or a motion that starts or ends moving. The
        message says which and where; `q` is the posture there.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5, -0.5, 0.5, 0.5, 0.5, 0.5]], [0.0, 0.4])
    >>> stretch = ps.least_stretch(robot, move)
    >>> stretch.assessment.is_feasible, round(stretch.factor, 3), stretch.governing.quantity
    (True, 1.607, 'effort')
    """
    motion = compute_motion(robot, trajectory)
    first = assessed_at(motion, 1.0, floor=floor, tool_limits=tool_limits)
    if first.keeps_limits:
        return Stretch(factor=1.0, trajectory=trajectory, assessment=first.assessment, governing=None)
    rates = feasible_rates(motion, first.assessment, highest=1.0)
    if not len(rates.feasible.intervals):
        raise rates.nothing_helps()
    answer = assessed_at(motion, float(rates.feasible.intervals[-1, 1]), floor=floor, tool_limits=tool_limits)
    if not answer.keeps_limits:
        check = answer.checks[0]
        raise NoSolution(
            f"no stretch of time helps: {check}", residual=abs(check.margin), q=answer.trajectory(check.time)
        )
    return Stretch(
        factor=1 / answer.rate,
        trajectory=answer.trajectory,
        assessment=answer.assessment,
        governing=next(iter(answer.checks), None),
    )


# A message holds whole nanoseconds: between points a millisecond apart that is 1e-6 of a velocity. What rounding breaks
# gets this much more time; the last is half of the 0.1 % by which the stretch is told to be least.
_MORE: Final = (0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 5e-4)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Fixed:
    """A message that breaks no limit.

    Attributes
    ----------
    message : JointTrajectoryMessage
    factor : float
        Its duration over that of the original.
    check : TrajectoryCheck
        Of what the controller makes of it.
    governing : LimitCheck or None
        The limit that a shorter motion would break; None where the original is kept.
    """

    message: JointTrajectoryMessage
    factor: float
    check: TrajectoryCheck
    governing: LimitCheck | None


def fixed(
    robot: Robot,
    planned: PlannedTrajectory,
    *,
    allow: Iterable[str] = (),
    effort: bool = False,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
) -> Fixed:
    """The least uniform stretch of a planned trajectory that holds, as a message, checked as it will be read.

    Parameters
    ----------
    robot : Robot
    planned : PlannedTrajectory
    allow, floor, tool_limits : optional
        As for `check_trajectory`.
    effort : bool
        Fill the effort fields with the torque at the points; a controller without an effort interface rejects them.

    Returns
    -------
    Fixed

    Raises
    ------
    NoSolution
        Where no stretch helps, with the reason.
    ModelError
        For effort of an arm whose torque is not known.
    """
    held: dict[str, Any] = {"allow": tuple(allow), "floor": floor, "tool_limits": tool_limits}
    if effort:
        check_inertia(robot)
    before = check_trajectory(robot, planned.trajectory, **held)
    # What the check takes for rest at the ends is no step to be stretched.
    judged = planned.trajectory if before.assessment is None else before.assessment.motion.trajectory
    stretch = least_stretch(robot, judged, floor=floor, tool_limits=tool_limits)
    for more in _MORE:
        factor = stretch.factor * (1 + more)
        message = planned.message if factor == 1 else planned.message.stretched(factor)
        trajectory = interpolated(message, planned.start, robot.is_continuous)
        check = check_trajectory(robot, trajectory, **held)
        if check.verdict != "violated":
            break
    else:
        raise NoSolution(
            f"the stretched motion, rounded to the message's nanoseconds, does not hold: {check.reasons[0].message}",
            residual=abs(check.reasons[0].demand - check.reasons[0].limit),
            q=trajectory(trajectory.breaks[0]),
        )
    if effort and check.assessment is not None:
        message = replace(message, effort=check.assessment.motion.torque(message.times))
    return Fixed(message=message, factor=factor, check=check, governing=stretch.governing)
