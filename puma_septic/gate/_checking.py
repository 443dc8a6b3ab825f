"""A planned trajectory held against everything that may speak against it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.assessment import Assessment, LimitCheck, assess
from puma_septic.document import card, one_line
from puma_septic.gate._reasons import DRIVE_VALUES, Reason, checked_allowances, verdict_of
from puma_septic.limits import AT_REST
from puma_septic.paths import ToolLimits
from puma_septic.quantities import MAGNITUDES, QUANTITIES
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array, checked_kind, checked_number
from puma_septic.views import gate

__all__ = ["START_TOLERANCE", "TrajectoryCheck", "check_trajectory"]

START_TOLERANCE: Final = 0.01
"""rad (m): MoveIt's allowed_start_tolerance (trajectory_execution_manager.cpp, allowed_start_tolerance_ = 0.01)."""


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class TrajectoryCheck:
    """The verdict on a trajectory; made by `check_trajectory`.

    Attributes
    ----------
    assessment : Assessment or None
        The motion checked against its limits; None where the trajectory cannot be read.
    margins : tuple of LimitCheck
        For each joint and quantity with a known limit the worst margin and its instant; of a demand that is unbounded
        at steps, that of its finite part.
    reasons : tuple of Reason
        What speaks against it, the worst first; what is allowed last.
    notes : tuple of str
        What was taken for granted.
    cell_margins : tuple of LimitCheck
        Of the tool's limits and the floor, where there are some.
    """

    assessment: Assessment | None
    margins: tuple[LimitCheck, ...]
    reasons: tuple[Reason, ...]
    notes: tuple[str, ...] = ()
    cell_margins: tuple[LimitCheck, ...] = ()

    @property
    def verdict(self) -> str:
        """The answer: "ok", "undecided" (something is not known), or "violated"."""
        return verdict_of(self.reasons)

    @property
    def is_ok(self) -> bool:
        """Whether nothing that counts speaks against it."""
        return self.verdict == "ok"

    @property
    def worst(self) -> LimitCheck | None:
        """The governing limit, None where none is known."""
        return max((*self.margins, *self.cell_margins), key=lambda check: check.utilisation, default=None)

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document; numbers in SI units, "unbounded" for infinity, null for what is not known.

        Returns
        -------
        dict
        """
        return {
            "verdict": self.verdict,
            "reasons": [reason.to_dict() for reason in self.reasons],
            "margins": [margin.to_dict() for margin in self.margins],
            "cell_margins": [margin.to_dict() for margin in self.cell_margins],
            "notes": list(self.notes),
        }

    def __str__(self) -> str:
        return gate.text(self.to_dict())

    def __repr__(self) -> str:
        return one_line("TrajectoryCheck", self._facts())

    def _repr_html_(self) -> str:
        return card("TrajectoryCheck", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "verdict": self.verdict,
            "reasons": len(self.reasons),
            "worst": "none" if self.worst is None else str(self.worst),
        }


def check_trajectory(
    robot: Robot,
    trajectory: Trajectory,
    *,
    start: ArrayLike | None = None,
    start_tolerance: float = START_TOLERANCE,
    allow: Iterable[str] = (),
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
) -> TrajectoryCheck:
    """Whether a planned trajectory may go to the robot; closed where something is not known.

    Position, velocity, acceleration, jerk and torque are checked against the robot's limits at every instant, between
    the points too (see `assess`); the first position against `start`; both ends against rest. A limit that the robot
    does not have, and drive values that are missing, leave it "undecided". A step of velocity, as of straight lines,
    needs an infinite acceleration and torque; allowed, what is finite between the steps is checked against the limits.

    Parameters
    ----------
    robot : Robot
    trajectory : Trajectory
    start : array_like, shape (n_joints,), optional
        Where the arm stands, rad (m). Of continuous joints any turn.
    start_tolerance : float
        Greatest distance of any joint from there, rad (m).
    allow : iterable of str
        Reasons that are told but do not count: codes out of "limit_unknown", "drive_unknown", "torque_unknown",
        "doubtful", "unbounded_acceleration", "unbounded_jerk", "unbounded_effort", "moving_start", "moving_end"; the
        first two also for one quantity, such as "limit_unknown:jerk" or "drive_unknown:rotor_inertia".
    floor, tool_limits : optional
        What the cell asks: as `assess` takes them.

    Returns
    -------
    TrajectoryCheck

    Raises
    ------
    InputError
        For a trajectory that is not the robot's, a misspelt reason, or a start of the wrong shape.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0], joint_names=robot.joint_names)
    >>> check = ps.check_trajectory(robot, move)
    >>> check.verdict, sorted({(reason.code, reason.quantity) for reason in check.reasons})
    ('undecided', [('limit_unknown', 'acceleration'), ('limit_unknown', 'jerk')])
    >>> ps.check_trajectory(robot, move, allow=["limit_unknown"]).verdict
    'ok'
    """
    checked_kind("robot", robot, Robot)
    checked_kind("trajectory", trajectory, Trajectory)
    allowed = checked_allowances(allow, tuple(QUANTITIES))
    tolerance = checked_number("start_tolerance", start_tolerance, unit="rad", at_least=0.0)
    place = None if start is None else checked_array("start", start, (robot.n_joints,), unit="rad")
    judged, moving, notes = _ends(robot, trajectory, allowed)
    reasons = [*moving, *_unknown(robot, allowed)]
    if place is not None:
        reasons += _start_mismatch(robot, trajectory, place, tolerance)
    reasons += _unknown_torques(robot, allowed)
    assessment = assess(robot, judged, floor=floor, tool_limits=tool_limits)
    reasons += _doubts(assessment, allowed)
    margins = []
    for check in assessment.checks:
        finite = check if np.isfinite(check.demand) else _finite_part(robot, judged, assessment, check)
        if finite is not check:
            reasons.append(_unbounded(check, allowed))
        if not np.isnan(finite.limit):
            margins.append(finite)
            if finite.is_violated:
                reasons.append(_violation(f"{finite.quantity}_limit", finite))
    height = () if assessment.floor_check is None else (assessment.floor_check,)
    for code, checks in (("tool_limit", assessment.tool_checks), ("below_floor", height)):
        reasons += [_violation(code, check) for check in checks if check.is_violated]
    return TrajectoryCheck(
        assessment=assessment,
        margins=tuple(margins),
        reasons=_sorted(reasons),
        notes=notes,
        cell_margins=(*assessment.tool_checks, *height),
    )


def _unknown_torques(robot: Robot, allowed: frozenset[str]) -> list[Reason]:
    """The joints whose torque cannot be computed, one reason each."""
    return [
        Reason(
            code="torque_unknown",
            message=f"{joint}: the URDF has no usable inertia for what it moves, so its torque is not known",
            allowed="torque_unknown" in allowed,
            joint=joint,
            quantity="effort",
        )
        for joint in robot.missing_inertia
    ]


def _sorted(reasons: list[Reason]) -> tuple[Reason, ...]:
    """The worst first: by verdict, then by how far beyond its limit; what is allowed last."""

    def rank(reason: Reason) -> tuple[bool, bool, float]:
        unbounded = math.isinf(reason.demand) or not reason.limit
        excess = math.inf if unbounded else abs(reason.demand / reason.limit)
        return reason.allowed, reason.verdict == "undecided", -(0.0 if math.isnan(excess) else excess)

    return tuple(sorted(reasons, key=rank))


def _ends(
    robot: Robot, trajectory: Trajectory, allowed: frozenset[str]
) -> tuple[Trajectory, list[Reason], tuple[str, ...]]:
    """The trajectory without the steps at its ends that count for rest or are allowed; reasons; notes."""
    rest = {"start": trajectory.rest_before, "end": trajectory.rest_after}
    steps = trajectory.jumps(1).times
    reasons, notes = [], []
    for end, instant in (("start", trajectory.breaks[0]), ("end", trajectory.breaks[-1])):
        speed = np.abs(trajectory(instant, 1))
        j = int(np.argmax(speed))
        if not rest[end] or not speed[j]:
            continue
        if speed[j] > AT_REST:
            reason = _moving(robot, f"moving_{end}", j, float(instant), float(speed[j]), allowed)
            reasons.append(reason)
            rest[end] = not reason.allowed
        elif instant in steps:
            notes.append(f"velocities up to {speed[j]:.2g} at the {end} are taken for rest, as the controller does")
            rest[end] = False
    return replace(trajectory, rest_before=rest["start"], rest_after=rest["end"]), reasons, tuple(notes)


def _moving(robot: Robot, code: str, j: int, time: float, speed: float, allowed: frozenset[str]) -> Reason:
    joint, unit = robot.joint_names[j], QUANTITIES["velocity"].unit(robot.is_prismatic[j])
    verb = "begins" if code == "moving_start" else "ends"
    text = f"the motion {verb} with {joint} at {speed:.4g} {unit}, not at rest"
    return Reason(
        code=code, message=text, allowed=code in allowed, joint=joint, quantity="velocity", time=time,
        demand=speed, limit=0.0, unit=unit,
    )  # fmt: skip


def _unknown(robot: Robot, allowed: frozenset[str]) -> list[Reason]:
    """Limits and drive values that the robot does not have, one reason each and joint."""
    limits = robot.limits
    missing = {
        "position": np.isnan(limits.position).any(axis=1) & ~robot.is_continuous,
        **{name: np.isnan(getattr(limits, name)) for name in limits.quantities if name in MAGNITUDES},
    }
    reasons = [
        _missing("limit_unknown", robot.joint_names[j], quantity, f"no {quantity} limit", allowed)
        for quantity, mask in missing.items()
        for j in np.flatnonzero(mask)
    ]
    for joint, actuator in zip(robot.joint_names, robot.actuators, strict=True):
        values: tuple[ArrayLike, ...] = (actuator.armature, actuator.viscous_friction, actuator.coulomb_friction)
        reasons += [
            _missing("drive_unknown", joint, name, f"{name.replace('_', ' ')} unknown", allowed)
            for name, value in zip(DRIVE_VALUES, values, strict=True)
            if np.isnan(value).any()
        ]
    return reasons


def _doubts(assessment: Assessment, allowed: frozenset[str]) -> list[Reason]:
    """What leaves the motion itself unknown: the noise and the units of a recorded one, the units of a planned one."""
    return [Reason(code="doubtful", message=doubt, allowed="doubtful" in allowed) for doubt in assessment.undecided]


def _missing(code: str, joint: str, quantity: str, text: str, allowed: frozenset[str]) -> Reason:
    return Reason(
        code=code,
        message=f"{joint}: {text}",
        allowed=bool(allowed & {code, f"{code}:{quantity}"}),
        joint=joint,
        quantity=quantity,
    )


def _start_mismatch(robot: Robot, trajectory: Trajectory, start: Array, tolerance: float) -> list[Reason]:
    first = trajectory(trajectory.breaks[0])
    apart = first - start
    apart = np.where(robot.is_continuous, np.remainder(apart + math.pi, math.tau) - math.pi, apart)
    reasons = []
    for j in np.flatnonzero(np.abs(apart) > tolerance):
        unit = QUANTITIES["position"].unit(robot.is_prismatic[j])
        text = (
            f"{robot.joint_names[j]} starts at {first[j]:.6g} {unit}, {abs(apart[j]):.4g} {unit} from the start state's"
            f" {start[j]:.6g}; allowed are {tolerance:g}"
        )
        reasons.append(
            Reason(
                code="start_mismatch", message=text, joint=robot.joint_names[j], quantity="position",
                time=float(trajectory.breaks[0]), demand=float(abs(apart[j])), limit=tolerance, unit=unit,
            )
        )  # fmt: skip
    return reasons


def _finite_part(robot: Robot, trajectory: Trajectory, assessment: Assessment, check: LimitCheck) -> LimitCheck:
    """The check of what is demanded between the steps."""
    quantity, j = QUANTITIES[check.quantity], robot.joint_names.index(check.joint)
    function = trajectory.derivative(quantity.order)
    if quantity.signal == "torque":
        function = assessment.motion.signal(check.quantity)
    extrema = function.extrema()
    return LimitCheck.of_magnitude(
        joint=check.joint,
        quantity=check.quantity,
        demand=float(extrema.peak[j]),
        limit=check.limit,
        unit=check.unit,
        time=float(extrema.t_peak[j]),
    )


def _unbounded(check: LimitCheck, allowed: frozenset[str]) -> Reason:
    code = f"unbounded_{check.quantity}"
    return Reason(
        code=code, message=str(check), allowed=code in allowed, joint=check.joint, quantity=check.quantity,
        time=check.time, demand=check.demand, limit=check.limit, unit=check.unit,
    )  # fmt: skip


def _violation(code: str, check: LimitCheck) -> Reason:
    return Reason(
        code=code, message=str(check), joint=check.joint, quantity=check.quantity,
        time=check.time, demand=check.demand, limit=check.limit, unit=check.unit,
    )  # fmt: skip
