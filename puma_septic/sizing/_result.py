"""Sizing: a duty cycle, the drive trains that are to do it, and what their limits say to that."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, final

import numpy as np

from puma_septic.cycle import Cycle
from puma_septic.doctor import doubts
from puma_septic.document import SCHEMAS, plain
from puma_septic.drives import Drivetrain
from puma_septic.limit_check import LimitCheck, most_used_first
from puma_septic.robot import own_drivetrains
from puma_septic.sizing._checks import NotAssessed, Outcome, assess_joint
from puma_septic.sizing._demands import Demands
from puma_septic.sizing._drivetrains import GivenDrivetrains, checked_cycle, checked_drivetrains, checked_ratios
from puma_septic.sizing._loads import joint_load, motor_load
from puma_septic.sizing._positions import position_remarks
from puma_septic.validation import Array, checked_choice, checked_number
from puma_septic.views import sizing as view
from puma_septic.views.checks import verdict

__all__ = ["MotorLoadProfile", "Sizing", "size"]

_RPM = 60 / (2 * np.pi)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MotorLoadProfile:
    """One motor's load as samples, the form that the design tools of motor makers read.

    Attributes
    ----------
    joint : str
    time : ndarray, shape (n,)
        s. Reversals, changes between motoring and braking and the ends of steps are among them; where the torque steps,
        the value after the step.
    speed_rpm, torque : ndarray, shape (n,)
        1/min and N m at the shaft, in the joint's direction.
    """

    joint: str
    time: Array
    speed_rpm: Array
    torque: Array


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Sizing:
    """A duty cycle checked against drive trains; made by `size`.

    Attributes
    ----------
    cycle : Cycle
    drivetrains : tuple of Drivetrain
        One per joint.
    demands : tuple of Demands
        One per joint: every number behind the checks, with the functions of time to draw.
    """

    cycle: Cycle
    drivetrains: tuple[Drivetrain, ...]
    demands: tuple[Demands, ...]

    @cached_property
    def _outcomes(self) -> tuple[Outcome, ...]:
        return tuple(outcome for demands in self.demands for outcome in assess_joint(demands))

    @property
    def checks(self) -> tuple[LimitCheck, ...]:
        """Every known limit checked against its demand, joint by joint."""
        return tuple(outcome for outcome in self._outcomes if isinstance(outcome, LimitCheck))

    def joint_checks(self, joint: str) -> tuple[LimitCheck, ...]:
        """The checks of one joint, the most used limit first."""
        name = checked_choice("joint", joint, self.cycle.joint_names)
        return most_used_first(c for c in self.checks if c.joint == name)

    @property
    def violations(self) -> tuple[LimitCheck, ...]:
        """The limits that are violated, the worst first; rules of thumb are in `warnings`."""
        return self._violated(thumb=False)

    @property
    def warnings(self) -> tuple[LimitCheck, ...]:
        """The rules of thumb that are not kept: unusual, but no reason to reject."""
        return self._violated(thumb=True)

    def _violated(self, *, thumb: bool) -> tuple[LimitCheck, ...]:
        return most_used_first(c for c in self.checks if c.is_violated and (c.kind == "rule of thumb") == thumb)

    @property
    def governing(self) -> LimitCheck | None:
        """The governing limit, the one of highest utilisation, rules of thumb apart; None where none is known."""
        binding = most_used_first(check for check in self.checks if check.kind != "rule of thumb")
        return binding[0] if binding else None

    @property
    def verdict(self) -> str:
        """One sentence: strong enough or undersized, and the governing limit."""
        if not self.violations and not self.is_feasible:
            return "undersized: a velocity steps, which takes unbounded torque"
        return verdict(("strong enough", "undersized"), self.violations, self.governing)

    @property
    def is_feasible(self) -> bool:
        """Whether no known limit is violated and no unbounded torque is needed (as a step in velocity would)."""
        return not self.violations and bool(np.isnan(self.cycle.unbounded).all())

    @property
    def not_assessed(self) -> tuple[str, ...]:
        """Checks that could not be made, and torques left out, with the reason and the joints concerned."""
        joints: dict[str, list[str]] = {}
        for demands in self.demands:
            for what in demands.train.left_out:
                joints.setdefault(f"unknown and left out of the torque: {what}", []).append(demands.load.joint)
        for outcome in self._outcomes:
            if isinstance(outcome, NotAssessed):
                joints.setdefault(f"{outcome.quantity}: {outcome.reason}", []).append(outcome.joint)
        everything = len(self.demands)
        return tuple(
            f"{line} (all joints)" if len(names) == everything else f"{line} ({', '.join(names)})"
            for line, names in joints.items()
        )

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a reader must know to read the numbers right."""
        lines = [self.cycle.why_not_periodic] if self.cycle.why_not_periodic else []
        for demands in self.demands:
            lines += [f"{demands.load.joint}: {assumption}" for assumption in demands.train.assumptions]
        lines += [*doubts(self.cycle.robot), *position_remarks(self.cycle)]
        return (*lines, "at rest, static friction may carry load; it is taken as 0 and the gears as lossless")

    def motor_load_profile(self, joint: str, *, step: float = 0.01) -> MotorLoadProfile:
        """One motor's load as samples, for the design tools of motor makers.

        Parameters
        ----------
        joint : str
        step : float
            Longest time between samples, s.
        """
        motor = self.demands[self.cycle.joint_names.index(checked_choice("joint", joint, self.cycle.joint_names))].motor
        step = checked_number("step", step, unit="s", above=0.0)
        breaks = motor.torque.breaks
        counts = np.maximum(1, np.ceil(np.diff(breaks) / step - 1e-9)).astype(int)
        parts = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(breaks[:-1], breaks[1:], counts, strict=True)]
        time = np.concatenate([*parts, breaks[-1:]])
        return MotorLoadProfile(
            joint=joint, time=time, speed_rpm=motor.speed(time)[:, 0] * _RPM, torque=motor.torque(time)[:, 0]
        )

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document; SI units unless a name says otherwise, "unbounded" for infinity, null for unknown."""
        cycle = self.cycle
        return {
            "schema": SCHEMAS["sizing"],
            "robot": cycle.robot.name,
            "steps": len(cycle.steps),
            "duration": cycle.duration,
            "is_periodic": cycle.is_periodic,
            "verdict": self.verdict,
            "is_feasible": self.is_feasible,
            "joints": [self._joint_document(demands) for demands in self.demands],
            "violations": [check.to_dict() for check in self.violations],
            "warnings": [check.to_dict() for check in self.warnings],
            "governing": None if self.governing is None else self.governing.to_dict(),
            "not_assessed": list(self.not_assessed),
            "remarks": list(self.remarks),
        }

    def _joint_document(self, demands: Demands) -> dict[str, Any]:
        train = demands.train
        return {
            "name": demands.load.joint,
            "motor": train.motor.name,
            "gearbox": train.gearbox.name,
            "drive": train.drive.name,
            **plain(_numbers(demands)),
            "rms_by_cause": plain(demands.rms_by_cause),
            "checks": [check.to_dict() for check in self.joint_checks(demands.load.joint)],
        }

    def __str__(self) -> str:
        return view.text(self.to_dict())

    def _repr_html_(self) -> str:
        return view.html(self.to_dict())


def _numbers(d: Demands) -> dict[str, float]:
    """What a document has of each joint."""
    given, returned = d.work
    drawn, fed_back = d.electric_energy
    return {
        "peak_load_torque": d.peak_load_torque.size,
        "peak_load_torque_time": d.peak_load_torque.time,
        "average_load_torque": d.average_load_torque,
        "peak_motor_torque": d.peak_torque.size,
        "peak_motor_torque_time": d.peak_torque.time,
        "rms_motor_torque": d.rms_torque,
        "peak_motor_speed": d.peak_speed.size,
        "mean_motor_speed": d.mean_speed,
        "peak_motor_power": d.peak_power.size,
        "work_given": given,
        "work_returned": returned,
        "peak_current": d.peak_current.size,
        "rms_current": d.rms_current,
        "energy_drawn": drawn,
        "energy_returned": fed_back,
        "energy_braked": d.regeneration.braked,
        "winding_temperature_rise": d.peak_temperature_rise.size,
        "inertia_ratio": d.inertia_ratio.size,
        "expected_gearbox_life_hours": d.expected_life_hours,
    }


def size(cycle: Cycle, *, drivetrains: GivenDrivetrains | None = None) -> Sizing:
    """Hold a duty cycle against the drive trains that are to do it.

    The drive trains replace the robot's own: their rotors, friction and efficiency come in, the robot's are left out.

    Parameters
    ----------
    cycle : Cycle
    drivetrains : sequence of Drivetrain, or mapping of str to Drivetrain, optional
        One per joint, in the robot's order or by joint name; by default the robot's own, as far as its actuators and
        limits tell.

    Returns
    -------
    Sizing
        A violated limit is part of the answer, not an error; what is unknown is listed as not assessed.

    Raises
    ------
    InputError
        If there is not one drive train for each joint.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> there = ps.compute_motion(robot, ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0]))
    >>> sizing = size(ps.cycle.with_return(there, dwell=1.0))
    >>> sizing.is_feasible, sizing.governing.joint
    (True, 'joint2')
    """
    checked_cycle(cycle)
    given = own_drivetrains(cycle.robot) if drivetrains is None else checked_drivetrains(cycle, drivetrains)
    trains = checked_ratios(cycle, given)
    loads = [joint_load(cycle, j) for j in range(len(trains))]
    return Sizing(
        cycle=cycle,
        drivetrains=trains,
        demands=tuple(
            Demands(load=load, train=train, motor=motor_load(load, train))
            for load, train in zip(loads, trains, strict=True)
        ),
    )
