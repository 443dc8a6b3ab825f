"""Sizing: a duty cycle, the drive trains that are to do it, and what their limits say to that."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import starmap
from typing import Any, final

import numpy as np

from puma_septic.cycle import Cycle
from puma_septic.doctor import doubts
from puma_septic.document import SCHEMAS, frame, one_line, plain
from puma_septic.drives import Drivetrain, lacking
from puma_septic.limit_check import LimitCheck, most_used_first
from puma_septic.motion import Motion
from puma_septic.robot import own_drivetrains
from puma_septic.sizing._candidates import governing_check
from puma_septic.sizing._checks import NotAssessed, Outcome
from puma_septic.sizing._compliance import Compliance, compliance
from puma_septic.sizing._conditions import Conditions
from puma_septic.sizing._demands import Demands
from puma_septic.sizing._drivetrains import GivenDrivetrains, checked_drivetrains, checked_ratios
from puma_septic.sizing._load_cases import (
    JointCase,
    LoadCase,
    joint_cases,
    life_of_mix,
    outcomes_of_cases,
    position_remarks,
    with_brakes,
    worst_outcome,
)
from puma_septic.sizing._load_profiles import LoadProfile, MotorLoadProfile, sampled_load, sampled_motor
from puma_septic.sizing._supply import SUPPLY, SupplyLoad, supply_load
from puma_septic.sizing._unknowns import unknowns
from puma_septic.validation import FrozenMap, checked_choice
from puma_septic.views import sizing as view
from puma_septic.views.checks import verdict

__all__ = ["Sizing", "case_document", "sized"]


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Sizing:
    """Load cases checked against drive trains; made by `size`.

    Attributes
    ----------
    load_cases : tuple of LoadCase
        One without a name where a cycle was given.
    drivetrains : tuple of Drivetrain
        One per joint, under the conditions.
    conditions : Conditions
    """

    load_cases: tuple[LoadCase, ...]
    drivetrains: tuple[Drivetrain, ...]
    conditions: Conditions
    _cases: tuple[tuple[JointCase, ...], ...] = field(repr=False)
    _demands: tuple[tuple[Demands, ...], ...] = field(repr=False)

    @property
    def cycle(self) -> Cycle:
        """Of the first load case."""
        return self.load_cases[0].cycle

    @cached_property
    def demands(self) -> tuple[Demands, ...]:
        """One per joint: every number behind the checks, with the functions of time to draw.

        Of several load cases that have a share of the time those of the one in which the joint uses most of a limit.
        """
        return tuple(every[self._telling_case(j)] for j, every in enumerate(self._demands))

    @property
    def mean_drawn_power(self) -> float:
        """Electric power that all motors draw, on average over the load cases with their shares, W; NaN: unknown."""
        pairs = [pair for both in zip(self._cases, self._demands, strict=True) for pair in zip(*both, strict=True)]
        return float(sum(case.share * demands.mean_drawn_power for case, demands in pairs if case.share))

    @property
    def telling_cases(self) -> tuple[str, ...]:
        """The load case of each of `demands`; "" where there is only one."""
        names = (cases[self._telling_case(j)].name for j, cases in enumerate(self._cases))
        return tuple(name if len(self.load_cases) > 1 else "" for name in names)

    def _telling_case(self, j: int) -> int:
        common = [case.name for case in self._cases[j] if case.share]
        checks = [c for c in self._joint_outcomes[j] if isinstance(c, LimitCheck) and c.case in common]
        governing = governing_check(most_used_first(checks), self.conditions)
        names = [case.name for case in self._cases[j]]
        return names.index(common[0] if governing is None else governing.case)

    @cached_property
    def _joint_outcomes(self) -> tuple[tuple[Outcome, ...], ...]:
        return tuple(starmap(outcomes_of_cases, zip(self._cases, self._demands, strict=True)))

    @cached_property
    def supply_loads(self) -> Mapping[str, SupplyLoad]:
        """What the drives ask of the supply that they share, by load case; empty where no supply is given.

        Of the load cases that concern all joints and are not rare.
        """
        supply = self.conditions.supply
        if supply is None:
            return FrozenMap({})
        common = [case.name for case in self.load_cases if not case.joints and not case.is_rare]
        of_joints = [
            {case.name: demands for case, demands in zip(cases, every, strict=True)}
            for cases, every in zip(self._cases, self._demands, strict=True)
        ]
        return FrozenMap({name: supply_load([demands[name] for demands in of_joints], supply) for name in common})

    @cached_property
    def compliance(self) -> Compliance:
        """How elastic the gears leave the arm, in the first load case."""
        return compliance(self.cycle, [every[0] for every in self._demands])

    @cached_property
    def _supply_outcomes(self) -> tuple[Outcome, ...]:
        found: dict[str, list[Outcome]] = {}
        for name, load in self.supply_loads.items():
            for outcome in load.outcomes:
                named = replace(outcome, case=name) if isinstance(outcome, LimitCheck) else outcome
                found.setdefault(outcome.quantity, []).append(named)
        return tuple(worst_outcome(outcomes) for outcomes in found.values())

    @property
    def _outcomes(self) -> tuple[Outcome, ...]:
        of_joints = tuple(outcome for outcomes in self._joint_outcomes for outcome in outcomes)
        return (*of_joints, *self._supply_outcomes)

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
        is_kept = self.conditions.is_kept
        return most_used_first(c for c in self.checks if not is_kept(c) and (c.kind == "rule of thumb") == thumb)

    @property
    def governing(self) -> LimitCheck | None:
        """The check with the least left of what may be used, rules of thumb apart; None where none is known."""
        return governing_check(most_used_first(self.checks), self.conditions)

    @property
    def lacking(self) -> Mapping[str, tuple[str, ...]]:
        """What of the least set (`LEAST_SET`) is not known, by joint; empty where all is."""
        repeated = (case.cycle.duration for case in self.load_cases if case.share and not case.is_rare)
        cycle, names = min(repeated, default=np.inf), zip(self.cycle.joint_names, self.drivetrains, strict=True)
        return FrozenMap({name: missing for name, train in names if (missing := lacking(train, cycle=cycle))})

    @property
    def verdict(self) -> str:
        """One sentence: strong enough (as far as is known, where something is `lacking`) or undersized, and why."""
        if not self.violations and not self.is_feasible:
            return "undersized: a velocity steps, which takes unbounded torque"
        enough = "strong enough as far as is known" if self.lacking else "strong enough"
        return verdict((enough, "undersized"), self.violations, self.governing)

    @property
    def is_feasible(self) -> bool:
        """Whether every known limit keeps its margin and no unbounded torque is needed (as a step in velocity would).

        Enough for a choice only where nothing is in `lacking`.
        """
        steady = all(np.isnan(case.cycle.unbounded).all() for case in self.load_cases)
        return not self.violations and bool(steady)

    @property
    def not_assessed(self) -> tuple[str, ...]:
        """Checks that could not be made, and torques left out, with the reason and the joints concerned."""
        joints: dict[str, list[str]] = {}
        for demands in self.demands:
            for line in unknowns(demands):
                joints.setdefault(line, []).append(demands.load.joint)
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
        common = [case.cycle.why_not_periodic for case in self.load_cases if not case.is_rare]
        lines = [why for why in dict.fromkeys(common) if why]
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
        return sampled_motor(joint, motor, step=step)

    def load_profile(self, joint: str, *, step: float = 0.01) -> LoadProfile:
        """One joint's load as samples, for the design tools of motor makers.

        Of several load cases the one of `demands`.

        Parameters
        ----------
        joint : str
        step : float
            Longest time between samples, s.
        """
        j = self.cycle.joint_names.index(checked_choice("joint", joint, self.cycle.joint_names))
        name = self.telling_cases[j]
        cycle = next(c.cycle for c in self.load_cases if c.name == name and (not c.joints or joint in c.joints))
        return sampled_load(self.demands[j].load, cycle.trajectory, j, step=step)

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
            "conditions": self.conditions.to_dict(),
            "load_cases": [case_document(case) for case in self.load_cases if case.name],
            "joints": [self._joint_document(j) for j in range(len(self.drivetrains))],
            "supply": self._supply_document(),
            "compliance": self._compliance_document(),
            "violations": [check.to_dict() for check in self.violations],
            "warnings": [check.to_dict() for check in self.warnings],
            "governing": None if self.governing is None else self.governing.to_dict(),
            "lacking": {name: list(missing) for name, missing in self.lacking.items()},
            "not_assessed": list(self.not_assessed),
            "remarks": list(self.remarks),
        }

    def _joint_document(self, j: int) -> dict[str, Any]:
        demands, case = self.demands[j], self.telling_cases[j]
        train = demands.train
        return {
            "name": demands.load.joint,
            "motor": train.motor.name,
            "gearbox": train.gearbox.name,
            "drive": train.drive.name,
            **({"case": case} if case else {}),
            **plain(_numbers(demands)),
            "expected_gearbox_life_hours": plain(life_of_mix(self._cases[j], self._demands[j])),
            "rms_by_cause": plain(demands.rms_by_cause),
            "checks": [check.to_dict() for check in self.joint_checks(demands.load.joint)],
        }

    def _supply_document(self) -> dict[str, Any] | None:
        """Of the load case with the largest peak; the checks are the worst of all."""
        if not self.supply_loads:
            return None
        name, load = max(self.supply_loads.items(), key=lambda item: np.nan_to_num(item[1].peak_drawn_power.size))
        checks = [check.to_dict() for check in self.checks if check.joint == SUPPLY]
        return {**load.to_dict(), **({"case": name} if name else {}), "checks": checks}

    def _compliance_document(self) -> dict[str, Any] | None:
        found = self.compliance
        known = len(found.unknown_stiffness) < len(found.joints) or len(found.unknown_backlash) < len(found.joints)
        return found.to_dict() if known else None

    def __str__(self) -> str:
        return view.text(self.to_dict())

    def _repr_html_(self) -> str:
        return view.html(self.to_dict())

    def __repr__(self) -> str:
        return one_line("Sizing", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "robot": self.cycle.robot.name,
            "steps": len(self.cycle.steps),
            "duration": f"{self.cycle.duration:g} s",
            "verdict": self.verdict,
        }

    def to_dataframe(self) -> Any:
        """The demands and checks as a pandas DataFrame, one row for each joint and check.

        Returns
        -------
        pandas.DataFrame
            In SI units; NaN where a number is not known.

        Raises
        ------
        ImportError
            Where pandas is not installed: ``python -m pip install 'puma-septic[pandas]'``.
        """
        return frame(check for joint in self.to_dict()["joints"] for check in joint["checks"])


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
        "peak_drawn_power": d.peak_drawn_power.size,
        "mean_drawn_power": d.mean_drawn_power,
        "peak_voltage": d.peak_voltage.size,
        "peak_tilting_moment": d.peak_tilting_moment.size,
        "output_bearing_life_hours": d.bearing_life_hours,
        "gearbox_life_l10_hours": d.expected_lives[0],
        "gearbox_life_l50_hours": d.expected_lives[1],
    }


def case_document(case: LoadCase) -> dict[str, Any]:
    """A load case in a document.

    Returns
    -------
    dict
    """
    return {
        "name": case.name,
        "share": case.share,
        "duration": case.cycle.duration,
        "payloads": [_payload(step) for step in case.cycle.steps if isinstance(step, Motion)],
        "joints": list(case.joints),
        "is_rare": case.is_rare,
        "note": case.note,
    }


def _payload(step: Motion) -> float:
    return 0.0 if step.robot.payload is None else float(step.robot.payload.mass)


def sized(
    cases: tuple[LoadCase, ...], *, drivetrains: GivenDrivetrains | None = None, conditions: Conditions | None = None
) -> Sizing:
    """Hold load cases against the drive trains that are to do them; see `size`.

    Returns
    -------
    Sizing
    """
    cycle, asked = cases[0].cycle, Conditions() if conditions is None else conditions
    given = own_drivetrains(cycle.robot) if drivetrains is None else checked_drivetrains(cycle, drivetrains)
    trains = asked.places(cycle.joint_names, checked_ratios(cycle, given))
    at_joints = tuple(joint_cases(cases, j) for j in range(len(trains)))
    trains = tuple(with_brakes(train, own) for train, own in zip(trains, at_joints, strict=True))
    own = tuple(
        tuple(case.through(train) for case in of_joint) for of_joint, train in zip(at_joints, trains, strict=True)
    )
    return Sizing(
        load_cases=cases,
        drivetrains=trains,
        conditions=asked,
        _cases=own,
        _demands=tuple(
            tuple(case.demands(train) for case in of_joint) for of_joint, train in zip(own, trains, strict=True)
        ),
    )
