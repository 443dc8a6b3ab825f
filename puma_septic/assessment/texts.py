"""An assessment as a document for machines and as a table for people."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from puma_septic.assessment.checks import QUANTITIES, LimitCheck
from puma_septic.tables import Cell, html_table, text_table

if TYPE_CHECKING:  # the value that these texts describe stands one file up in this room
    from puma_septic.assessment.result import Assessment

__all__ = ["SCHEMA", "assessment_document", "assessment_html", "assessment_tables", "assessment_text", "verdict"]

# Whatever changes in the layout of the document changes this.
SCHEMA: Final = "puma-septic/assessment/1"

_PER_JOINT: Final = (
    "peak_velocity", "peak_velocity_time", "peak_acceleration", "peak_acceleration_time", "peak_jerk", "peak_jerk_time",
    "peak_torque", "peak_torque_time", "peak_torque_sign", "rms_velocity", "rms_acceleration", "rms_jerk", "rms_torque",
    "holding_torque", "least_holding_torque", "peak_power", "peak_regenerated_power", "energy_in", "energy_out",
    "overshoot",
)  # fmt: skip
_TOOL: Final = (
    "peak_speed", "peak_speed_time", "peak_acceleration", "peak_acceleration_time", "height_range", "height_times",
)  # fmt: skip


def verdict(assessment: Assessment) -> str:
    """One sentence: feasible or not, and the limit that governs."""
    worst = assessment.worst
    if assessment.is_feasible:
        return "feasible" if worst is None else f"feasible; the limit used most: {worst}"
    count = len(assessment.violations)
    return f"infeasible, {count} limit{'s' if count > 1 else ''} broken; the worst: {assessment.violations[0]}"


def assessment_text(assessment: Assessment) -> str:
    """A table that a person reads, with verdict, violations and what is not known."""
    robot, trajectory = assessment.motion.robot, assessment.motion.trajectory
    rest = f", then {assessment.dwell:g} s at rest" if assessment.dwell else ""
    lines = [
        f"{robot.name}, {trajectory.profile}, {trajectory.duration:g} s{rest}: {verdict(assessment)}",
        "",
        _joint_table(assessment),
        "",
        _tool_text(assessment),
    ]
    if assessment.violations:
        lines += ["", "Limits broken:", *(f"  {check}" for check in assessment.violations)]
    if assessment.not_assessed:
        lines += ["", "Not assessed:", *(f"  {line}" for line in assessment.not_assessed)]
    if assessment.remarks:
        lines += ["", "Remarks:", *(f"  {line}" for line in assessment.remarks)]
    return "\n".join(lines)


def assessment_html(assessment: Assessment) -> str:
    """Verdict, tables and what is not known, for a notebook; every text is escaped."""
    robot, trajectory = assessment.motion.robot, assessment.motion.trajectory
    head = f"{robot.name}, {trajectory.profile}, {trajectory.duration:g} s: {verdict(assessment)}"
    lists = (
        ("Limits broken", [str(check) for check in assessment.violations]),
        ("Not assessed", assessment.not_assessed),
        ("Remarks", assessment.remarks),
    )
    texts = [f"{title}: {'; '.join(lines)}" for title, lines in lists if lines]
    return "\n".join(
        [
            f"<p><strong>{escape(head)}</strong></p>",
            assessment_tables(assessment),
            *(f"<p>{escape(text)}</p>" for text in [_tool_text(assessment), *texts]),
        ]
    )


def assessment_tables(assessment: Assessment) -> str:
    """What each joint does and needs, and what is left of its limits, as HTML tables in the boxes that scroll."""
    motion, effort = _joint_rows(assessment)
    units = ("rad", "", "", "", "")
    margins = [
        [
            joint,
            *(_margin(assessment.margins[quantity][j], unit) for quantity, unit in zip(QUANTITIES, units, strict=True)),
        ]
        for j, joint in enumerate(assessment.motion.robot.joint_names)
    ]
    tables = (
        html_table(_MOTION, motion, caption=f"Peaks, and use of the limit. {_units(assessment)}"),
        html_table(_EFFORT, effort, caption="Torque and energy, over the motion and its dwell"),
        html_table(
            ["joint", *QUANTITIES[:-1], "torque"],
            margins,
            caption="Margins: what is left of the limit; for positions the distance to the nearer bound",
        ),
    )
    return "\n".join(f'<div class="scroll" style="overflow-x:auto">{table}</div>' for table in tables)


_MOTION: Final = ("joint", "position", "velocity", "acceleration", "jerk")
_EFFORT: Final = ("joint", "torque", "at [s]", "rms torque", "energy in", "energy out")


def _margin(value: float, unit: str) -> str:
    if np.isnan(value):
        return "not known"
    if np.isinf(value):
        return "none"
    return f"{value:.3g} {unit}" if unit else f"{100 * value:.0f} %"


def _joint_table(assessment: Assessment) -> str:
    """What each joint does and what it needs, in two tables, so that each fits on a page."""
    motion, effort = _joint_rows(assessment)
    note = f"{_units(assessment)}; (use of the limit; ! marks a broken one)"
    return "\n\n".join([text_table(_MOTION, motion), text_table(_EFFORT, effort)]) + "\n" + note


def _units(assessment: Assessment) -> str:
    units = "Peaks in rad, rad/s, rad/s^2, rad/s^3, N m; energies in J"
    return f"{units} (sliding joints: m and N)" if assessment.motion.robot.is_prismatic.any() else units


def _joint_rows(assessment: Assessment) -> tuple[list[list[Cell]], list[list[Cell]]]:
    motion: list[list[Cell]] = []
    effort: list[list[Cell]] = []
    checks = {(check.joint, check.quantity): check for check in assessment.checks}
    extremes = zip(assessment.position.min, assessment.position.max, strict=True)
    for j, (joint, (low, high)) in enumerate(zip(assessment.motion.robot.joint_names, extremes, strict=True)):
        cell = [checks.get((joint, quantity)) for quantity in QUANTITIES]
        motion.append([
            joint,
            f"{low:.3f} .. {high:.3f}{_percent(cell[0])}",
            _size(assessment.peak_velocity[j], cell[1]),
            _size(assessment.peak_acceleration[j], cell[2]),
            _size(assessment.peak_jerk[j], cell[3]),
        ])  # fmt: skip
        effort.append([
            joint,
            _size(assessment.peak_torque[j] * assessment.peak_torque_sign[j], cell[4]),
            f"{assessment.peak_torque_time[j]:.3f}",
            _size(assessment.rms_torque[j], None),
            _size(assessment.energy_in[j], None),
            _size(assessment.energy_out[j], None),
        ])  # fmt: skip
    return motion, effort


def _percent(check: LimitCheck | None) -> str:
    if check is None:
        return ""
    if np.isinf(check.utilisation):
        return " (!)"
    mark = "!" if check.is_violated else ""
    return f" ({100 * check.utilisation:.0f} %{mark})"


def _size(value: float, check: LimitCheck | None) -> str:
    return ("unbounded" if np.isinf(value) else f"{value:.4g}") + _percent(check)


def _tool_text(assessment: Assessment) -> str:
    tool = assessment.tool
    bounded = np.isfinite(tool.peak_acceleration)
    acceleration = f"acceleration up to {tool.peak_acceleration:.3f} m/s^2" if bounded else "acceleration unbounded"
    parts = [
        f"Tool {assessment.motion.robot.tool!r}: speed up to {tool.peak_speed:.3f} m/s at {tool.peak_speed_time:.3f} s,"
        f" {acceleration}, height {tool.height_range[0]:.3f} to {tool.height_range[1]:.3f} m"
    ]
    for report in tool.singularities:
        if len(report.crossings):
            times = ", ".join(f"{time:.3f}" for time in report.crossings)
            parts.append(f"Singularity {report.kind!r}: crossed at {times} s")
    return "\n".join(parts)


def assessment_document(assessment: Assessment) -> dict[str, Any]:
    """The document of `Assessment.to_dict`."""
    robot, trajectory, tool = assessment.motion.robot, assessment.motion.trajectory, assessment.tool
    names = robot.joint_names
    return {
        "schema": SCHEMA,
        "robot": robot.name,
        "tool_frame": robot.tool,
        "profile": trajectory.profile,
        "duration": trajectory.duration,
        "dwell": assessment.dwell,
        "verdict": verdict(assessment),
        "is_feasible": assessment.is_feasible,
        "joints": [
            {
                "name": name,
                "position_min": plain(assessment.position.min[j]),
                "position_max": plain(assessment.position.max[j]),
                **{key: plain(getattr(assessment, key)[j]) for key in _PER_JOINT},
                "margins": {quantity: plain(values[j]) for quantity, values in assessment.margins.items()},
            }
            for j, name in enumerate(names)
        ],
        "tool": {key: plain(getattr(tool, key)) for key in _TOOL},
        "singularities": [
            {
                "kind": report.kind,
                "least_distance": plain(report.least_distance),
                "time": plain(report.time),
                "crossings": plain(report.crossings),
            }
            for report in tool.singularities
        ],
        "violations": [_check_document(check) for check in assessment.violations],
        "governing": None if assessment.worst is None else _check_document(assessment.worst),
        "not_assessed": list(assessment.not_assessed),
        "remarks": list(assessment.remarks),
        "n_evaluations": assessment.motion.n_evaluations,
    }


def _check_document(check: LimitCheck) -> dict[str, Any]:
    keys = ("joint", "quantity", "demand", "limit", "unit", "time", "margin", "utilisation")
    return {key: plain(getattr(check, key)) for key in keys}


def plain(value: Any) -> Any:
    """A number or array as JSON has it: infinity as "unbounded", what is not known as null."""
    if isinstance(value, str):
        return value
    if isinstance(value, (np.ndarray, tuple, list)):
        return [plain(item) for item in value]
    number = float(value)
    if np.isnan(number):
        return None
    if np.isinf(number):
        return "unbounded" if number > 0 else "-unbounded"
    return number
