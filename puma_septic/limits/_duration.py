"""How fast a motion can go: the durations at which it keeps its limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from puma_septic.assessment import Assessment, assess
from puma_septic.document import SCHEMAS, card, one_line, plain
from puma_septic.errors import InputError, NoSolution
from puma_septic.limit_check import AT_LIMIT, LimitCheck, most_used_first
from puma_septic.limits._demands import Demand
from puma_septic.limits._drives import drive_checks, drive_demands, highest_motor_rate
from puma_septic.limits._dwell import dwell_checks, dwell_demands
from puma_septic.limits._feasible import Certificate, Constraint, Feasible, feasible_values
from puma_septic.limits._stretching import RateTorque, rate_torque, stretched
from puma_septic.motion import Motion, compute_motion
from puma_septic.paths import ToolLimits, tool_rates
from puma_septic.quantities import QUANTITIES
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, read_only
from puma_septic.views import limits as view

__all__ = [
    "AT_REST",
    "Answer",
    "FeasibleRates",
    "MinimumDuration",
    "assessed_at",
    "feasible_rates",
    "kinematic_rate",
    "minimum_duration",
]

AT_REST: Final = float(np.finfo(np.float32).eps)
"""A velocity at an end that counts for rest, rad/s (m/s): the epsilon of a float, as joint_trajectory_controller has it
(ros2_controllers, ``validate_trajectory_msg``)."""

# The derivative of a series that is fitted to 1e-11 has lost some digits: an answer that exceeds a limit by no more
# than this part is that much slower.
_ROUNDING: Final = 1e-6
_MOST_CORRECTIONS: Final = 5


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MinimumDuration:
    """The durations at which a motion, stretched or shortened in time, keeps its limits; made by `minimum_duration`.

    Attributes
    ----------
    motion : Motion
        What was asked about.
    duration : float
        The least from which on every longer one is feasible, s; infinite where there is none, see `reason`.
    feasible : ndarray, shape (k, 2)
        All intervals of feasible durations, s, ascending; the last ends at infinity unless there is a `reason`.
    assessment : Assessment
        In full, at `duration`; where that is infinite, at the least feasible one.
    checks : tuple of LimitCheck
        All that was held there, those of the motors too, positions apart, the most used first.
    certificate : {"proved", "resolved", "undecided"}
        Whether no violation inside the intervals is proved, or only none was found, or the search ended early.
    reason : str
        Why slowness does not help, empty where it does.
    """

    motion: Motion
    duration: float
    feasible: Array
    assessment: Assessment
    checks: tuple[LimitCheck, ...]
    certificate: Certificate
    reason: str = ""

    @property
    def trajectory(self) -> Trajectory:
        """The motion that was assessed."""
        return self.assessment.motion.trajectory

    @property
    def factor(self) -> float:
        """`duration` over that of the motion that was given."""
        return self.duration / self.motion.trajectory.duration

    @property
    def governing(self) -> LimitCheck:
        """The limit that a shorter motion would break."""
        return self.checks[0]

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document; durations in s.

        Returns
        -------
        dict
        """
        return {
            "schema": SCHEMAS["minimum-duration"],
            "profile": self.trajectory.profile,
            "given_duration": self.motion.trajectory.duration,
            "duration": plain(self.duration),
            "feasible": plain(self.feasible),
            "governing": self.governing.to_dict(),
            "certificate": self.certificate,
            "reason": self.reason,
            "is_feasible": self.assessment.is_feasible,
            "not_assessed": list(self.assessment.not_assessed),
        }

    def __str__(self) -> str:
        return view.duration_text(self.to_dict())

    def __repr__(self) -> str:
        return one_line("MinimumDuration", self._facts())

    def _repr_html_(self) -> str:
        return card("MinimumDuration", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "robot": self.motion.robot.name,
            "duration": f"{self.duration:.6g} s",
            "factor": f"{self.factor:.6g}",
            "governing": str(self.governing),
        }


def minimum_duration(
    motion: Motion, *, dwell: float = 0.0, floor: float | None = None, tool_limits: ToolLimits | None = None
) -> MinimumDuration:
    """How short a motion may become, stretched or shortened in time, and which durations keep its limits at all.

    Velocity, acceleration and jerk go with ``1/T``, ``1/T^2`` and ``1/T^3``. The torque at each place on the path is
    ``S + V u + D u^2`` at the rate ``u = T_given / T``: gravity and Coulomb friction, viscous friction, inertia. So
    torque, torque rate, and what the robot's drivetrains tell of their motors (torque, current, speed, power, voltage,
    torque over speed) are polynomials of u at each instant, and inertia may offset gravity: a slower motion may break
    what a faster one keeps. All is exact, see the page "How fast, how heavy"; the answer is assessed in full.

    Parameters
    ----------
    motion : Motion
        From rest to rest. Its own duration does not matter.
    dwell : float
        Rest at the last point, s, which no stretch changes: its holding torque must keep the limits, too.
    floor : float, optional
        Height above the base that the arm must stay above, m: no duration helps where it does not.
    tool_limits : ToolLimits, optional
        What the tool may do at most.

    Returns
    -------
    MinimumDuration

    Raises
    ------
    InputError
        For a motion that does not move, one that no known limit ever stops, or friction that is not viscous plus
        constant.
    NoSolution
        Where no duration keeps the limits; the message says which one, where and why.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> fastest = ps.minimum_duration(ps.compute_motion(ps.load_robot(), move))
    >>> round(fastest.duration, 4), fastest.governing.joint, fastest.governing.quantity, fastest.certificate
    (0.6209, 'joint2', 'velocity', 'proved')
    """
    first = assess(motion, dwell=dwell, floor=floor, tool_limits=tool_limits)
    rates = feasible_rates(motion, first)
    intervals = rates.feasible.intervals
    if not len(intervals):
        raise rates.nothing_helps()
    is_open = bool(intervals[0, 0] == 0)
    k = 0 if is_open else -1
    answer = assessed_at(motion, float(intervals[k, 1]), dwell=dwell, floor=floor, tool_limits=tool_limits)
    with np.errstate(divide="ignore"):
        durations = (motion.trajectory.duration / intervals)[::-1, ::-1]
    durations[-1 - k, 0] = answer.trajectory.duration
    return MinimumDuration(
        motion=motion,
        duration=answer.trajectory.duration if is_open else np.inf,
        feasible=read_only(durations),
        assessment=answer.assessment,
        checks=answer.checks,
        certificate=rates.feasible.certificate if answer.is_decided else "undecided",
        reason="" if is_open else rates.nothing_helps().args[0],
    )


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Answer:
    """A motion at some rate, assessed in full.

    Attributes
    ----------
    rate : float
    assessment : Assessment
    checks : tuple of LimitCheck
        Those of the motors too, positions apart, the most used first.
    """

    rate: float
    assessment: Assessment
    checks: tuple[LimitCheck, ...]

    @property
    def trajectory(self) -> Trajectory:
        """The motion at that rate."""
        return self.assessment.motion.trajectory

    @property
    def is_decided(self) -> bool:
        """Whether it keeps every known limit, and nothing puts the motion itself in doubt."""
        return self.keeps_limits and not self.assessment.undecided

    @property
    def keeps_limits(self) -> bool:
        """Whether it keeps every known limit."""
        return not self.assessment.violations and not any(check.is_violated for check in self.checks)


def assessed_at(
    motion: Motion,
    rate: float,
    *,
    dwell: float = 0.0,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
) -> Answer:
    """The motion at a rate, or at one below it by what rounding makes of the derivatives of its torque.

    Returns
    -------
    Answer
    """
    for _ in range(_MOST_CORRECTIONS):
        slower = motion if rate == 1 else compute_motion(motion.robot, stretched(motion.trajectory, 1 / rate))
        result = assess(slower, dwell=dwell, floor=floor, tool_limits=tool_limits)
        slowed = [check for check in result.all_checks if not check.is_range]
        motors = [*drive_checks(slower), *dwell_checks(slower, dwell)]
        answer = Answer(rate=rate, assessment=result, checks=most_used_first([*slowed, *motors]))
        excess = answer.checks[0].utilisation - 1
        if not AT_LIMIT < excess < _ROUNDING:
            break
        rate *= 1 - excess
    return answer


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class FeasibleRates:
    """The rates u at which a motion in ``1/u`` of its time keeps its limits."""

    motion: Motion
    constraints: tuple[Constraint, ...]
    feasible: Feasible

    def nothing_helps(self) -> NoSolution:
        """Why an endlessly slow motion does not keep the limits: what is used most without motion."""
        found = [(one, *(values[0] for values in one.peaks(np.zeros(1)))) for one in self.constraints]
        one, shares, times = max(found, key=lambda item: float(item[1].max()))
        k = int(np.argmax(shares))
        j, share, time = int(one.joints[k]), float(shares[k]), float(times[k])
        name, limits = self.motion.robot.joint_names[j], self.motion.robot.limits
        if one.quantity == "effort":
            limit, unit = float(limits.effort[j]), QUANTITIES["effort"].unit(self.motion.robot.is_prismatic[j])
            need, bound, excess = (
                f"{share * limit:.4g} {unit}",
                f", its limit is {limit:.4g} {unit}",
                (share - 1) * limit,
            )
        else:
            need, bound, excess = f"{100 * share:.4g} % of its limit of {one.quantity}", "", share - 1
        return NoSolution(
            f"no stretch of time helps: {name} needs {need} at t = {time:.4g} s at any speed{bound}: that is violated"
            " by gravity and friction alone",
            residual=excess,
            q=self.motion.trajectory(time),
        )


def feasible_rates(motion: Motion, first: Assessment, highest: float = np.inf) -> FeasibleRates:
    """All rates up to a highest one, from the assessment of the motion as it is.

    Raises
    ------
    InputError
        For a motion that no known limit ever stops, or friction that is not viscous plus constant.
    NoSolution
        For a position beyond its bounds, a step of what must not step, or a motion that starts or ends moving.
    """
    _refuse_hopeless(first)
    torque = rate_torque(motion)
    highest = min(highest, kinematic_rate(first), highest_motor_rate(motion.robot, first.peak_velocity))
    constraints: tuple[Constraint, ...] = (
        *_torque_demands(motion, torque),
        *drive_demands(motion, torque),
        *dwell_demands(motion, first.dwell),
    )
    feasible = feasible_values(constraints, highest)
    if len(feasible.intervals) and np.isinf(feasible.intervals[-1, 1]):
        raise InputError("the motion moves no joint that has a known limit: any duration is long enough")
    return FeasibleRates(motion=motion, constraints=constraints, feasible=feasible)


def _torque_demands(motion: Motion, torque: RateTorque) -> list[Demand]:
    robot = motion.robot
    limit = np.where(robot.knows_torque, robot.limits.effort, np.nan)
    demands = [Demand.of("effort", (torque.still, torque.viscous, torque.inertial), limit)]
    parts = (torque.still - torque.coulomb, torque.viscous, torque.inertial)
    for name in robot.limits.quantities:
        row = QUANTITIES[name]
        if not row.is_torque_derivative:
            continue
        for _ in range(row.order):
            parts = (parts[0].derivative(), parts[1].derivative(), parts[2].derivative())
        limit = np.where(robot.knows_torque, getattr(robot.limits, name), np.nan)
        demands.append(Demand.of(name, (*(None,) * row.order, *parts), limit))
    return [demand for demand in demands if demand is not None]


def kinematic_rate(assessment: Assessment) -> float:
    """The largest u that limits of velocity, acceleration and jerk allow, those of the tool too."""
    robot, trajectory, u = assessment.motion.robot, assessment.motion.trajectory, np.inf
    limits = robot.limits
    if assessment.tool_limits is not None:
        stretch = tool_rates(robot, trajectory).needed_stretch(assessment.tool_limits)
        u = 1 / stretch if stretch else np.inf
    for order, quantity in enumerate(("velocity", "acceleration", "jerk"), start=1):
        demand, limit = getattr(assessment, f"peak_{quantity}"), getattr(limits, quantity)
        with np.errstate(divide="ignore"):
            u = min(u, float(np.fmin.reduce((limit / demand) ** (1 / order), initial=np.inf)))
    return u


def _refuse_hopeless(assessment: Assessment) -> None:
    trajectory = assessment.motion.trajectory
    speed = float(np.abs(trajectory(trajectory.breaks[[0, -1]], 1)).max())
    if speed > AT_REST:
        raise NoSolution(
            "no stretch keeps the velocity with which the motion starts or ends; give one from rest to rest",
            residual=speed,
            q=trajectory(trajectory.breaks[0]),
        )
    for check in assessment.all_checks:
        if check.is_range and check.is_violated:
            raise _no_solution(assessment, check, "is violated at any speed")
        if np.isinf(check.demand):
            raise _no_solution(assessment, check, "needs another motion: a step remains a step")


def _no_solution(assessment: Assessment, check: LimitCheck, why: str) -> NoSolution:
    q = assessment.motion.trajectory(check.time)
    return NoSolution(f"no stretch of time helps: {check}; that {why}", residual=abs(check.margin), q=q)
