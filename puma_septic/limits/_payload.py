"""How much a motion can carry: the masses at which it keeps its limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.assessment import Assessment, assess
from puma_septic.document import SCHEMAS, card, one_line, plain
from puma_septic.errors import InputError, NoSolution
from puma_septic.limit_check import LimitCheck, most_used_first
from puma_septic.limits._demands import Demand
from puma_septic.limits._drives import CurveDemand, drive_checks, load_demands
from puma_septic.limits._dwell import dwell_checks, dwell_demands
from puma_septic.limits._feasible import Certificate, Constraint, feasible_values
from puma_septic.limits._stretching import load_torque, rate_torque
from puma_septic.motion import Motion, compute_motion
from puma_septic.paths import TOOL, ToolLimits
from puma_septic.piecewise import Piecewise
from puma_septic.quantities import QUANTITIES
from puma_septic.robot import Payload, Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array, checked_kind, frozen, read_only
from puma_septic.views import limits as view

__all__ = ["Load", "MaximumPayload", "maximum_payload"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Load:
    """The shape of a payload whose mass is asked for, at the tool.

    Parameters
    ----------
    com : array_like, shape (3,)
        Centre of mass in the tool frame, m; at every mass.
    gyration : array_like, shape (3, 3)
        Inertia about the centre of mass per kg, m^2: zero, a point mass, by default.
    """

    com: Array
    gyration: Array

    def of(self, mass: float) -> Payload | None:
        """The payload of a mass in kg; None of 0."""
        return Payload(mass=mass, com=self.com, inertia=self.gyration * mass) if mass else None

    @property
    def per_kg(self) -> Array:
        """The ten parameters of 1 kg; see `puma_septic.dynamics.payload_torque`."""
        c = self.com
        about_origin = self.gyration + (c @ c) * np.eye(3) - np.outer(c, c)
        return frozen(np.array([1.0, *c, *about_origin[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]]))


def checked_load(robot: Robot, com: ArrayLike | None, gyration: ArrayLike | None) -> Load:
    """The load whose mass is asked for: by default that which the robot carries, else a point at the tool."""
    carried = robot.payload
    if com is None:
        com = np.zeros(3) if carried is None else carried.com
        if gyration is None and carried is not None and carried.mass:
            gyration = carried.inertia / carried.mass
    load = Load(
        com=checked_array("com", com, (3,), unit="m"),
        gyration=checked_array("gyration", np.zeros((3, 3)) if gyration is None else gyration, (3, 3), unit="m^2"),
    )
    load.of(1.0)  # refuses a gyration that no body has
    return load


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MaximumPayload:
    """The masses that a motion can carry; made by `maximum_payload`.

    Attributes
    ----------
    motion : Motion
        What was asked about; its payload does not count.
    load : Load
    mass : float
        The most that can be carried, kg.
    feasible : ndarray, shape (1, 2)
        The interval of masses, kg. It may exclude 0: an arm may need a load that helps it.
    assessment : Assessment
        In full, at `mass`.
    checks : tuple of LimitCheck
        All that was held there, those of the motors too, positions apart, the most used first.
    certificate : {"proved", "resolved", "undecided"}
        Limits are linear in the mass, so that what holds at both ends holds between them.
    """

    motion: Motion
    load: Load
    mass: float
    feasible: Array
    assessment: Assessment
    checks: tuple[LimitCheck, ...]
    certificate: Certificate

    @property
    def payload(self) -> Payload | None:
        """The heaviest payload; None where that is nothing at all."""
        return self.load.of(self.mass)

    @property
    def governing(self) -> LimitCheck:
        """The limit that a heavier payload would break, with joint and instant."""
        return next(check for check in self.checks if check.quantity not in _NOT_OF_MASS)

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document; masses in kg.

        Returns
        -------
        dict
        """
        trajectory = self.motion.trajectory
        return {
            "schema": SCHEMAS["maximum-payload"],
            "profile": trajectory.profile,
            "duration": trajectory.duration,
            "com": plain(self.load.com),
            "gyration": plain(self.load.gyration),
            "mass": self.mass,
            "feasible": plain(self.feasible),
            "governing": self.governing.to_dict(),
            "certificate": self.certificate,
            "is_feasible": self.assessment.is_feasible,
            "not_assessed": list(self.assessment.not_assessed),
        }

    def __str__(self) -> str:
        return view.payload_text(self.to_dict())

    def __repr__(self) -> str:
        return one_line("MaximumPayload", self._facts())

    def _repr_html_(self) -> str:
        return card("MaximumPayload", self._facts())

    def _facts(self) -> dict[str, object]:
        return {"robot": self.motion.robot.name, "mass": f"{self.mass:.6g} kg", "governing": str(self.governing)}


# What a payload does not change.
_NOT_OF_MASS = ("velocity", "acceleration", "jerk", "motor speed")


def maximum_payload(
    motion: Motion,
    *,
    com: ArrayLike | None = None,
    gyration: ArrayLike | None = None,
    dwell: float = 0.0,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
) -> MaximumPayload:
    """How heavy a payload may become on a motion as it is, and which masses keep its limits at all.

    The torque is affine in the mass of a body of given shape, ``tau_0 + m tau_1``, and so are its rate, the motor's
    torque, current, power and voltage: each instant allows an interval of masses, and so do all. It is found
    exactly, and the heaviest payload assessed in full.

    Parameters
    ----------
    motion : Motion
        What its robot carries is replaced.
    com : array_like, shape (3,), optional
        Centre of mass in the tool frame, m; by default that of the robot's payload, else the tool's origin.
    gyration : array_like, shape (3, 3), optional
        Inertia about the centre of mass per kg, m^2; by default that of the robot's payload, of which com is not given,
        else a point mass.
    dwell : float
        Rest at the last point, s: its holding torque must keep the limits, too.
    floor : float, optional
        Height above the base that the arm must stay above, m: no mass helps where it does not.
    tool_limits : ToolLimits, optional
        What the tool may do at most: no mass helps where it does more.

    Returns
    -------
    MaximumPayload

    Raises
    ------
    InputError
        For friction that is not viscous plus constant, a gyration that no body has, or where no known limit bears
        the mass.
    NoSolution
        Where no mass keeps the limits, with what breaks them.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 1.0])
    >>> heaviest = ps.maximum_payload(ps.compute_motion(ps.load_robot(), move), com=[0, 0, 0.1])
    >>> round(heaviest.mass, 3), heaviest.governing.joint, heaviest.governing.quantity
    (4.596, 'joint2', 'effort')
    """
    load = checked_load(checked_kind("motion", motion, Motion).robot, com, gyration)
    robot, trajectory = motion.robot, motion.trajectory
    bare = motion if robot.payload is None else compute_motion(robot.with_payload(None), trajectory)
    first = assess(bare, dwell=dwell, floor=floor, tool_limits=tool_limits)
    _refuse_what_no_mass_mends(first)
    demands = [*mass_demands(first.motion, load), *dwell_demands(first.motion, dwell, per_kg=load.per_kg)]
    feasible = feasible_values(demands)
    if not len(feasible.intervals):
        raise _no_mass(first, demands)
    least, most = feasible.intervals[0].tolist()
    if np.isinf(most):
        raise InputError("no joint with a known limit bears the payload: any mass will do")
    loaded = compute_motion(robot.with_payload(load.of(most)), trajectory)
    answer = assess(loaded, dwell=dwell, floor=floor, tool_limits=tool_limits)
    checks = [check for check in answer.all_checks if not check.is_range]
    return MaximumPayload(
        motion=motion,
        load=load,
        mass=most,
        feasible=read_only([[least, most]]),
        assessment=answer,
        checks=most_used_first([*checks, *drive_checks(answer.motion), *dwell_checks(answer.motion, dwell)]),
        certificate=feasible.certificate if answer.is_feasible else "undecided",
    )


def _refuse_what_no_mass_mends(first: Assessment) -> None:
    """What does not depend on the mass and is violated."""
    checks = [*first.all_checks, *drive_checks(first.motion)]
    for check in checks:
        fixed = check.is_range or check.joint == TOOL or check.quantity in _NOT_OF_MASS or np.isinf(check.demand)
        if fixed and check.is_violated:
            raise NoSolution(
                f"no payload keeps the limits: {check}, whatever is carried",
                residual=abs(check.margin),
                q=first.motion.trajectory(check.time),
            )


def mass_demands(motion: Motion, load: Load) -> list[Demand | CurveDemand]:
    """What an unloaded motion demands as a function of the mass that it will carry."""
    robot = motion.robot
    torque, added = rate_torque(motion), load_torque(robot, motion.trajectory, load.per_kg)
    return mass_demands_at(robot, motion.trajectory, (torque.at(1.0), torque.coulomb, added.at(1.0)), 1.0)


def mass_demands_at(
    robot: Robot, trajectory: Trajectory, parts: tuple[Piecewise, Piecewise, Piecewise], rate: float
) -> list[Demand | CurveDemand]:
    """The same at some rate, from the torque without load, its Coulomb part, and what each kg adds."""
    bare, coulomb, added = parts
    known = robot.knows_torque
    demands: list[Demand | CurveDemand | None] = [
        Demand.of("effort", (bare, added), np.where(known, robot.limits.effort, np.nan))
    ]
    smooth = bare - coulomb
    for name in robot.limits.quantities:
        row = QUANTITIES[name]
        if row.is_torque_derivative:
            for _ in range(row.order):
                smooth, added = smooth.derivative() * rate, added.derivative() * rate
            demands.append(Demand.of(name, (smooth, added), np.where(known, getattr(robot.limits, name), np.nan)))
    demands += load_demands(robot, trajectory, bare, parts[2], rate)
    return [demand for demand in demands if demand is not None]


def _no_mass(first: Assessment, demands: Sequence[Constraint]) -> NoSolution:
    """Which limits leave no mass: without any payload, the one used most."""
    motors = [*drive_checks(first.motion), *dwell_checks(first.motion, first.dwell)]
    worst = most_used_first([*first.checks, *motors])[0]
    return NoSolution(
        f"no payload keeps the limits: without any, {worst}, and no mass that mends this keeps the others"
        f" ({', '.join(dict.fromkeys(demand.quantity for demand in demands))})",
        residual=abs(worst.margin),
        q=first.motion.trajectory(worst.time),
    )
