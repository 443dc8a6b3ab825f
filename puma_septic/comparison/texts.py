"""A comparison as tables, a document and CSV."""

from __future__ import annotations

import csv
import io
from html import escape
from textwrap import wrap
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from puma_septic.assessment.texts import plain
from puma_septic.checks import Array
from puma_septic.tables import Cell, html_table, text_table

if TYPE_CHECKING:  # the values that these texts describe stand one file up in this room
    from puma_septic.comparison.result import ComparedProfile, Comparison

__all__ = ["SCHEMA", "comparison_csv", "comparison_document", "comparison_html", "comparison_text"]

SCHEMA: Final = "puma-septic/comparison/1"
WIDTH: Final = 100

_MOTION: Final = ("profile", "class", "v", "rms", "a", "rms", "jerk", "rms", "j^2 dt", "end")
_ARM: Final = ("profile", "time", "at vias", "over", "peak torque", "rms", "energy", "broken")
_PER_JOINT: Final = (
    "peak_velocity", "rms_velocity", "peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk",
    "integral_of_squared_jerk", "end_jerk", "overshoot", "via_miss", "peak_torque", "rms_torque", "energy_in",
    "energy_out",
)  # fmt: skip
_BRIEF: Final = {"position": "pos", "velocity": "vel", "acceleration": "acc"}
# How a column of the joints becomes one number.
_SUMMED: Final = ("integral_of_squared_jerk", "energy_in", "energy_out")


def per_joint(row: ComparedProfile) -> dict[str, Array]:
    """Every metric of a profile by joint, shape (n_joints,) each."""
    sources = (row, row.trajectory, row.assessment)
    return {name: getattr(next(s for s in sources if hasattr(s, name)), name) for name in _PER_JOINT}


def overall(row: ComparedProfile) -> dict[str, float]:
    """Each metric of the worst joint, integrals and energies summed."""
    return {name: float(values.sum() if name in _SUMMED else values.max()) for name, values in per_joint(row).items()}


def comparison_text(comparison: Comparison) -> str:
    """Two tables and what must be said beside them, within 100 columns."""
    lines = [
        text_table(_MOTION, [_motion_cells(comparison, row) for row in comparison.profiles]),
        *wrap(_motion_note(comparison), WIDTH),
        "",
        text_table(_ARM, [_arm_cells(row, "\n") for row in comparison.profiles]),
        *wrap(_ARM_NOTE, WIDTH),
    ]
    for title, remarks in _remarks(comparison).items():
        lines += ["", title]
        for remark in remarks:
            lines += wrap(remark, WIDTH, initial_indent="  ", subsequent_indent="    ")
    return "\n".join(lines)


def comparison_html(comparison: Comparison) -> str:
    """The same for a notebook."""
    parts = [
        html_table(_MOTION, [_motion_cells(comparison, row) for row in comparison.profiles]),
        f"<p>{escape(_motion_note(comparison))}</p>",
        html_table(_ARM, [_arm_cells(row, ", ") for row in comparison.profiles]),
        f"<p>{escape(_ARM_NOTE)}</p>",
    ]
    for title, remarks in _remarks(comparison).items():
        items = "".join(f"<li>{escape(remark)}</li>" for remark in remarks)
        parts.append(f"<p>{escape(title)}</p><ul>{items}</ul>")
    return "\n".join(parts)


_ARM_NOTE: Final = (
    "Over: largest excess beyond the hull of the points, rad. Peak torque as a share of its limit, of the joint that"
    " uses most of it (in N m where no limit is known); rms: root of the joints' summed mean square torques, N m;"
    " energy that the actuators put in, J; broken: limits by quantity, with the number of joints."
)


def _motion_note(comparison: Comparison) -> str:
    names = ", ".join(objective.name for objective in comparison.objectives)
    return (
        "Largest peak and largest root mean square among the joints, rad and s; j^2 dt: integral of jerk^2 summed"
        " over them; end: jerk at the ends; class with the rest before and after; -- is unbounded. * Pareto-optimal:"
        f" no other profile is at least as good in all of {names}, and better in one."
    )


def _remarks(comparison: Comparison) -> dict[str, list[str]]:
    """What stands below the tables: singular postures and profiles left out."""
    crossing: dict[str, list[str]] = {}
    for row in comparison.profiles:
        if row.singularities_crossed:
            kinds = ", ".join(f"{kind} {count} times" for kind, count in row.singularities_crossed.items())
            crossing.setdefault(kinds, []).append(row.name)
    remarks = {
        "Singular postures crossed:": [f"{kinds}: {', '.join(names)}" for kinds, names in crossing.items()],
        "Left out:": [f"{name}: {reason}" for name, reason in comparison.unsuitable.items()],
    }
    return {title: texts for title, texts in remarks.items() if texts}


def _motion_cells(comparison: Comparison, row: ComparedProfile) -> list[Cell]:
    worst = overall(row)
    mark = " *" if row.name in comparison.pareto_optimal else ""
    return [row.name, row.continuity + mark, *(_short(worst[key]) for key in _PER_JOINT[:8])]


def _arm_cells(row: ComparedProfile, separator: str) -> list[Cell]:
    assessment = row.assessment
    return [
        row.name,
        f"{row.duration:.4g}",
        _at_vias(row),
        _short(float(row.trajectory.overshoot.max())),
        _torque(row),
        _short(float(np.sqrt((assessment.rms_torque**2).sum()))),
        _short(float(assessment.energy_in.sum())),
        _broken(row, separator),
    ]


def _at_vias(row: ComparedProfile) -> str:
    if row.trajectory.via_miss.any():
        return f"misses by {row.trajectory.via_miss.max():.2g}"
    return "stops" if row.stops_at_vias else "passes"


def _torque(row: ComparedProfile) -> str:
    checks = [check for check in row.assessment.checks if check.quantity == "effort"]
    names = row.assessment.motion.robot.joint_names
    if not checks:
        peak = row.assessment.peak_torque
        return f"{names[int(peak.argmax())]} {_short(float(peak.max()))}"
    worst = max(checks, key=lambda check: check.utilisation)
    share = "--" if np.isinf(worst.utilisation) else f"{100 * worst.utilisation:.1f} %"
    return f"{worst.joint} {share}"


def _broken(row: ComparedProfile, separator: str) -> str:
    quantities = [check.quantity for check in row.assessment.violations]
    counts = {name: quantities.count(name) for name in dict.fromkeys(quantities)}
    return separator.join(f"{_BRIEF.get(name, name)} {count}" for name, count in counts.items()) or "none"


def _short(value: float) -> str:
    return "--" if np.isinf(value) else f"{value:.4g}" if value >= 1 else f"{value:.3g}"


def comparison_document(comparison: Comparison) -> dict[str, Any]:
    """The document of `Comparison.to_dict`."""
    robot = comparison.profiles[0].assessment.motion.robot
    return {
        "schema": SCHEMA,
        "robot": robot.name,
        "joint_names": list(robot.joint_names),
        "points": plain(comparison.points),
        "times": plain(comparison.times),
        "objectives": [{"name": one.name, "unit": one.unit, "meaning": one.meaning} for one in comparison.objectives],
        "pareto_optimal": list(comparison.pareto_optimal),
        "profiles": [_row_document(row) for row in comparison.profiles],
        "unsuitable": dict(comparison.unsuitable),
    }


def _row_document(row: ComparedProfile) -> dict[str, Any]:
    return {
        "name": row.name,
        "continuity": row.continuity,
        "duration": row.duration,
        "stops_at_vias": row.stops_at_vias,
        "objectives": {name: plain(value) for name, value in row.objectives.items()},
        "overall": {name: plain(value) for name, value in overall(row).items()},
        "joints": {name: plain(values) for name, values in per_joint(row).items()},
        "is_feasible": row.assessment.is_feasible,
        "violations": [str(check) for check in row.assessment.violations],
        "singularities_crossed": dict(row.singularities_crossed),
        "notes": list(row.notes),
    }


def comparison_csv(comparison: Comparison) -> str:
    """The text of `Comparison.to_csv`."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(
        ["profile", "pareto_optimal", "continuity", "duration", "is_feasible", "joint", *_PER_JOINT, "notes"]
    )
    for row in comparison.profiles:
        head = [
            row.name, row.name in comparison.pareto_optimal, row.continuity, row.duration, row.assessment.is_feasible,
        ]  # fmt: skip
        writer.writerow([*head, "all", *map(plain, overall(row).values()), "; ".join(row.notes)])
        columns = per_joint(row).values()
        for j, joint in enumerate(row.assessment.motion.robot.joint_names):
            writer.writerow([*head, joint, *(plain(values[j]) for values in columns), ""])
    return stream.getvalue()
