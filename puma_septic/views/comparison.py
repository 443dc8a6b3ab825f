"""A comparison's document as text, HTML and CSV."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from math import fsum, isinf, isnan, sqrt
from textwrap import wrap
from typing import Any, Final

from puma_septic.document import csv_text, numeric
from puma_septic.limit_check import LimitCheck, most_used_first
from puma_septic.views.checks import read_checks
from puma_septic.views.tables import Cell, html_table, text_table

__all__ = ["csv", "html", "text"]

Document = Mapping[str, Any]

_WIDTH: Final = 100
_MOTION_HEADERS: Final = ("profile", "class", "v", "rms", "a", "rms", "jerk", "rms", "j^2 dt", "end")
_MOTION: Final = (
    "peak_velocity", "rms_velocity", "peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk",
    "integral_of_squared_jerk", "end_jerk",
)  # fmt: skip
_ARM_HEADERS: Final = ("profile", "time", "at vias", "over", "peak torque", "rms", "energy", "violated")
_OF_TORQUE: Final = ("peak torque", "rms", "energy")
_ARM_NOTE: Final = (
    "Over: largest excess beyond the hull of the points, rad. Peak torque as a share of its limit, of the joint that"
    " uses most of it (in N m where no limit is known); rms: root of the joints' summed mean square torques, N m;"
    " energy that the actuators put in, J; violated: limits by quantity, with the number of joints."
)
_UNKNOWN: Final = "not known"
_BRIEF: Final = {"position": "pos", "velocity": "vel", "acceleration": "acc"}


def text(document: Document) -> str:
    """Two tables and what must be said beside them, within 100 columns."""
    lines = [
        text_table(_MOTION_HEADERS, _motion_rows(document)),
        *wrap(_motion_note(document), _WIDTH),
        "",
        text_table(*_arm_table(document, "\n")),
        *wrap(_ARM_NOTE, _WIDTH),
    ]
    for title, remarks in _remarks(document).items():
        lines += ["", title]
        for remark in remarks:
            lines += wrap(remark, _WIDTH, initial_indent="  ", subsequent_indent="    ")
    return "\n".join(lines)


def html(document: Document) -> str:
    """The same for a notebook."""
    parts = [
        html_table(_MOTION_HEADERS, _motion_rows(document)),
        f"<p>{escape(_motion_note(document))}</p>",
        html_table(*_arm_table(document, ", ")),
        f"<p>{escape(_ARM_NOTE)}</p>",
    ]
    for title, remarks in _remarks(document).items():
        items = "".join(f"<li>{escape(remark)}</li>" for remark in remarks)
        parts.append(f"<p>{escape(title)}</p><ul>{items}</ul>")
    return "\n".join(parts)


def csv(document: Document) -> str:
    """One line per profile and joint, after a line for all joints together."""
    metrics = list(document["profiles"][0]["overall"])
    rows = [["profile", "pareto_optimal", "continuity", "duration", "is_feasible", "joint", *metrics, "notes"]]
    for row in document["profiles"]:
        head = [
            row["name"], row["name"] in document["pareto_optimal"], row["continuity"], row["duration"],
            row["is_feasible"],
        ]  # fmt: skip
        rows.append([*head, "all", *row["overall"].values(), "; ".join(row["notes"])])
        for j, joint in enumerate(document["joint_names"]):
            rows.append([*head, joint, *(values[j] for values in row["joints"].values()), ""])
    return csv_text(rows)


def _motion_note(document: Document) -> str:
    names = ", ".join(objective["name"] for objective in document["objectives"])
    return (
        "Largest peak and largest root mean square among the joints, rad and s; j^2 dt: integral of jerk^2 summed"
        " over them; end: jerk at the ends; class with the rest before and after; -- is unbounded. * Pareto-optimal:"
        f" no other profile is at least as good in all of {names}, and better in one."
    )


def _remarks(document: Document) -> dict[str, list[str]]:
    """What stands below the tables: what leaves a verdict open, singular postures and profiles left out."""
    crossing: dict[str, list[str]] = {}
    for row in document["profiles"]:
        if row["singularities_crossed"]:
            kinds = ", ".join(f"{kind} {count} times" for kind, count in row["singularities_crossed"].items())
            crossing.setdefault(kinds, []).append(row["name"])
    remarks = {
        "Undecided:": list(dict.fromkeys(doubt for row in document["profiles"] for doubt in row["undecided"])),
        "Doubtful data, which all of this rests on:": document["doubts"],
        "Not assessed:": document["not_assessed"],
        "Singular postures crossed:": [f"{kinds}: {', '.join(names)}" for kinds, names in crossing.items()],
        "Left out:": [f"{name}: {reason}" for name, reason in document["unsuitable"].items()],
    }
    return {title: texts for title, texts in remarks.items() if texts}


def _motion_rows(document: Document) -> list[list[Cell]]:
    return [
        [
            row["name"],
            row["continuity"] + (" *" if row["name"] in document["pareto_optimal"] else ""),
            *(_short(numeric(row["overall"][key])) for key in _MOTION),
        ]
        for row in document["profiles"]
    ]


def _arm_table(document: Document, separator: str) -> tuple[list[str], list[list[Cell]]]:
    """Headers and rows, without the columns of torque where no joint's torque is known."""
    rows = _arm_rows(document, separator)
    if any(numeric(peak) == numeric(peak) for row in document["profiles"] for peak in row["joints"]["peak_torque"]):
        return list(_ARM_HEADERS), rows
    kept = [k for k, header in enumerate(_ARM_HEADERS) if header not in _OF_TORQUE]
    return [_ARM_HEADERS[k] for k in kept], [[row[k] for k in kept] for row in rows]


def _arm_rows(document: Document, separator: str) -> list[list[Cell]]:
    return [
        [
            row["name"],
            f"{row['duration']:.4g}",
            _at_vias(row),
            _short(numeric(row["overall"]["overshoot"])),
            _torque(row, document["joint_names"]),
            _short(sqrt(fsum(numeric(value) ** 2 for value in row["joints"]["rms_torque"]))),
            _short(numeric(row["overall"]["energy_in"])),
            _violated(read_checks(row["checks"]), separator),
        ]
        for row in document["profiles"]
    ]


def _at_vias(row: Document) -> str:
    miss = numeric(row["overall"]["via_miss"])
    if miss:
        return f"misses by {miss:.2g}"
    return "stops" if row["stops_at_vias"] else "passes"


def _torque(row: Document, joint_names: list[str]) -> str:
    checks = [check for check in read_checks(row["checks"]) if check.quantity == "effort"]
    if not checks:
        peaks = [numeric(value) for value in row["joints"]["peak_torque"]]
        known = {name: peak for name, peak in zip(joint_names, peaks, strict=True) if not isnan(peak)}
        return f"{max(known, key=known.__getitem__)} {_short(max(known.values()))}" if known else _UNKNOWN
    worst = max(checks, key=lambda check: check.utilisation)
    share = "--" if isinf(worst.utilisation) else f"{100 * worst.utilisation:.1f} %"
    return f"{worst.joint} {share}"


def _violated(checks: tuple[LimitCheck, ...], separator: str) -> str:
    """How often each quantity is violated, the one that is violated most first."""
    quantities = [check.label for check in most_used_first(checks) if check.is_violated]
    counts = {name: quantities.count(name) for name in dict.fromkeys(quantities)}
    return separator.join(f"{_BRIEF.get(name, name)} {count}" for name, count in counts.items()) or "none"


def _short(value: float) -> str:
    if isnan(value):
        return _UNKNOWN
    return "--" if isinf(value) else f"{value:.4g}" if value >= 1 else f"{value:.3g}"
