"""A sizing as a document for machines and as tables for people."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from puma_septic.assessment.texts import plain
from puma_septic.sizing.demands import Demands
from puma_septic.sizing.outcome import SizingCheck
from puma_septic.tables import Cell, html_table, text_table

if TYPE_CHECKING:  # the value that these texts describe stands one file up in this room
    from puma_septic.sizing.result import Sizing

__all__ = ["SCHEMA", "sizing_document", "sizing_html", "sizing_text", "verdict"]

# Whatever changes in the layout of the document changes this.
SCHEMA: Final = "puma-septic/sizing/1"
_RPM: Final = 60 / (2 * np.pi)
_ROUNDING: Final = 1e-12


def verdict(sizing: Sizing) -> str:
    """One sentence: strong enough or not, and the limit that governs."""
    governing = sizing.governing
    if sizing.is_feasible:
        return "strong enough" if governing is None else f"strong enough; the limit used most: {governing}"
    if not sizing.violations:
        return "not strong enough: a velocity steps, which takes unbounded torque"
    count = len(sizing.violations)
    return f"not strong enough, {count} limit{'s' if count > 1 else ''} broken; the worst: {sizing.violations[0]}"


def sizing_text(sizing: Sizing) -> str:
    """Tables that a person reads: verdict, demands, use of every known limit, and what is not known."""
    lines = [_head(sizing), "", text_table(*_demand_table(sizing)), _DEMANDS]
    if sizing.checks:
        lines += ["", text_table(*_check_table(sizing)), _CHECKS]
    if sizing.not_assessed:
        lines += ["", "Not assessed:", *(f"  {line}" for line in sizing.not_assessed)]
    lines += ["", "Remarks:", *(f"  {line}" for line in sizing.remarks)]
    return "\n".join(lines)


def sizing_html(sizing: Sizing) -> str:
    """The same for a notebook; every text is escaped."""
    parts = [f"<p><strong>{escape(_head(sizing))}</strong></p>", html_table(*_demand_table(sizing), caption=_DEMANDS)]
    if sizing.checks:
        parts.append(html_table(*_check_table(sizing), caption=_CHECKS))
    lists = (("Not assessed", sizing.not_assessed), ("Remarks", sizing.remarks))
    parts += [f"<p>{title}: {escape('; '.join(lines))}</p>" for title, lines in lists if lines]
    return "\n".join(parts)


_DEMANDS: Final = (
    "Load: at the gearbox's output. Causes: RMS at the joint. Torques in N m (sliding joints: load in N), speeds in"
    " 1/min; work: mechanical, in J"
)
_CHECKS: Final = "margin = 1 - demand / limit; ! marks a broken limit, ? a rule of thumb"


def _head(sizing: Sizing) -> str:
    cycle = sizing.cycle
    kind = "repeats" if cycle.is_periodic else "does not repeat"
    return f"{cycle.robot.name}, cycle of {len(cycle.steps)} steps, {cycle.duration:g} s, {kind}: {verdict(sizing)}"


def _demand_table(sizing: Sizing) -> tuple[list[str], list[list[Cell]]]:
    headers = [
        "joint", "load peak", "average", "gravity", "motion", "rotor", "friction", "motor peak", "at [s]", "RMS",
        "speed peak", "mean", "work out", "in",
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    for d in sizing.demands:
        total = sum(d.rms_by_cause.values())
        # What is left of a difference is not a cause.
        cause = {name: value if value > _ROUNDING * total else 0.0 for name, value in d.rms_by_cause.items()}
        given, returned = d.work
        rows.append([
            d.load.joint, d.peak_load_torque.size, d.average_load_torque, cause["gravity"], cause["motion"],
            cause["rotor"], cause["friction"], d.peak_torque.size, f"{d.peak_torque.time:.3f}", d.rms_torque,
            d.peak_speed.size * _RPM, d.mean_speed * _RPM, given, returned,
        ])  # fmt: skip
    return headers, rows


def _check_table(sizing: Sizing) -> tuple[list[str], list[list[Cell]]]:
    headers = ["joint", "check", "demand", "limit", "unit", "at [s]", "use", "margin", ""]
    rows: list[list[Cell]] = []
    for joint in sizing.cycle.joint_names:
        for c in sizing.joint_checks(joint):
            when = "" if np.isnan(c.time) else f"{c.time:.3f}"
            use, margin = (_percent(value) for value in (c.utilisation, c.margin))
            rows.append([c.joint, c.quantity, c.demand, c.limit, c.unit, when, use, margin, _mark(c)])
    return headers, rows


def _mark(check: SizingCheck) -> str:
    return ("?" if check.kind == "rule of thumb" else "") + ("!" if check.is_violated else "")


def _percent(value: float) -> str:
    return "unbounded" if np.isinf(value) else f"{100 * value:.1f} %"


def sizing_document(sizing: Sizing) -> dict[str, Any]:
    """The document of `Sizing.to_dict`."""
    cycle = sizing.cycle
    return {
        "schema": SCHEMA,
        "robot": cycle.robot.name,
        "duration": cycle.duration,
        "is_periodic": cycle.is_periodic,
        "verdict": verdict(sizing),
        "is_feasible": sizing.is_feasible,
        "joints": [_joint_document(sizing, demands) for demands in sizing.demands],
        "violations": [check_document(check) for check in sizing.violations],
        "warnings": [check_document(check) for check in sizing.warnings],
        "governing": None if sizing.governing is None else check_document(sizing.governing),
        "not_assessed": list(sizing.not_assessed),
        "remarks": list(sizing.remarks),
    }


def _joint_document(sizing: Sizing, d: Demands) -> dict[str, Any]:
    given, returned = d.work
    drawn, fed_back = d.electric_energy
    numbers = {
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
    return {
        "name": d.load.joint,
        "motor": d.train.motor.name,
        "gearbox": d.train.gearbox.name,
        "drive": d.train.drive.name,
        **{name: plain(value) for name, value in numbers.items()},
        "rms_by_cause": {name: plain(value) for name, value in d.rms_by_cause.items()},
        "checks": [check_document(check) for check in sizing.joint_checks(d.load.joint)],
    }


def check_document(check: SizingCheck) -> dict[str, Any]:
    """A check as JSON has it."""
    keys = ("joint", "quantity", "demand", "limit", "unit", "time", "utilisation", "margin", "kind", "source")
    return {key: plain(getattr(check, key)) for key in keys}
