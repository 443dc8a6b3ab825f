"""The least uniform stretch of time by which a planned trajectory keeps its limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from puma_septic.assessment import Assessment, LimitCheck
from puma_septic.errors import NoSolution
from puma_septic.limits import assessed_at, feasible_rates
from puma_septic.motion import compute_motion
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory

__all__ = ["Stretch", "least_stretch"]


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


def least_stretch(robot: Robot, trajectory: Trajectory) -> Stretch:
    """The least uniform stretch of time, 1 or more, by which a motion from rest to rest keeps all known limits.

    The largest of the rates that `minimum_duration` finds, up to 1: a longer motion need not be feasible. The result is
    assessed in full.

    Parameters
    ----------
    robot : Robot
    trajectory : Trajectory

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
    first = assessed_at(motion, 1.0)
    if first.keeps_limits:
        return Stretch(factor=1.0, trajectory=trajectory, assessment=first.assessment, governing=None)
    rates = feasible_rates(motion, first.assessment, highest=1.0)
    if not len(rates.feasible.intervals):
        raise rates.nothing_helps()
    answer = assessed_at(motion, float(rates.feasible.intervals[-1, 1]))
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
