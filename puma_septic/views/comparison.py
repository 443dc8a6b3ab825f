"""A comparison's document as text, HTML and CSV."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from math import fsum, isnan, sqrt
from typing import Any, Final

from puma_septic.document import csv_text, numeric
from puma_septic.limit_check import HEIGHT, LimitCheck, most_used_first
from puma_septic.views.checks import percent, read_checks
from puma_septic.views.tables import html_table, number, text_table
from puma_septic.views.units import SI, Units

__all__ = ["csv", "html", "short_text", "text"]

Document = Mapping[str, Any]

# Of the short table: what a reader chooses by.
_HEADS: Final = ("profile", "limits", "at vias", "torque", "jerk [{}/s^3]", "jerk^2 dt [{}^2/s^5]", "overshoot [{}]")
_MOTION: Final = (
    ("peak_velocity", "peak v [{}/s]"),
    ("rms_velocity", "rms v [{}/s]"),
    ("peak_acceleration", "peak a [{}/s^2]"),
    ("rms_acceleration", "rms a [{}/s^2]"),
    ("peak_jerk", "peak jerk [{}/s^3]"),
    ("rms_jerk", "rms jerk [{}/s^3]"),
    ("end_jerk", "end jerk [{}/s^3]"),
)
_NOTE: Final = (
    "The largest among the joints, of jerk^2 the integral over all of them; torque: the largest share of a limit;"
    " limits: those that are violated, with the number of joints."
)
_UNKNOWN: Final = "not known"
_GAP: Final = {"least_duration": "least [s]", "ratio": "gap"}
_GAP_NOTE: Final = (
    " least: how quick the profile can be under all limits; gap: that over the quickest motion along its path."
)
_BRIEF: Final = {"position": "pos", "velocity": "vel", "acceleration": "acc"}
# Rows of the short table, and those of the task beside them.
_SHOWN: Final = 12


def short_text(document: Document) -> str:
    """The advice, the profiles that meet the points and keep the limits, and the task's own."""
    good = [row["name"] for row in _ranked(document) if row["is_feasible"] and not _miss(row) and not row["undecided"]]
    shown = dict.fromkeys([*(good or document["ranking"])[:_SHOWN], *document["own"]])
    names = [name for name in document["ranking"] if name in shown]
    others = len(document["profiles"]) - len(names)
    lines = [_advice(document), "", text_table(*_choice_table(document, names)), _NOTE + _starred(document)]
    undecided = list(dict.fromkeys(doubt for row in document["profiles"] for doubt in row["undecided"]))
    lines += ["", *(f"Undecided: {doubt}" for doubt in undecided)] if undecided else []
    unknown = document["not_assessed"]
    lines += ["", f"Not assessed: {'; '.join(unknown)}"] if unknown else [""]
    left = len(document["unsuitable"])
    more = f"{others} more profile{'s' if others != 1 else ''}, " if others else ""
    lines.append(f"More: -v shows {more}peaks and root mean squares, and why {left} do not suit.")
    return "\n".join(lines)


def text(document: Document) -> str:
    """The advice, two tables of all profiles and what must be said beside them."""
    names = document["ranking"]
    lines = [
        _advice(document),
        "",
        text_table(*_choice_table(document, names)),
        _NOTE + _starred(document),
        "",
        text_table(*_motion_table(document)),
        "Of the joint with the largest; end: at start or end; class with the rest before and after.",
    ]
    for title, remarks in _remarks(document).items():
        lines += ["", title, *(f"  {remark}" for remark in remarks)]
    return "\n".join(lines)


def html(document: Document, units: Units = SI) -> str:
    """The same for a notebook or a page."""
    parts = [
        f"<p><strong>{escape(units.prose(document['advice']))}</strong></p>",
        _boxed(html_table(*units.table(*_choice_table(document, document["ranking"])))),
        f"<p>{escape(_NOTE + _starred(document))}</p>",
        _boxed(html_table(*units.table(*_motion_table(document)))),
        "<p>Of the joint with the largest; end: at start or end; class with the rest before and after.</p>",
    ]
    for title, remarks in _remarks(document).items():
        items = "".join(f"<li>{escape(units.prose(remark))}</li>" for remark in remarks)
        parts.append(f"<p>{escape(title)}</p><ul>{items}</ul>")
    return "\n".join(parts)


def _boxed(table: str) -> str:
    return f'<div class="scroll" style="overflow-x:auto">{table}</div>'


def csv(document: Document) -> str:
    """One line per profile and joint, after a line for all joints together."""
    metrics = list(document["profiles"][0]["overall"])
    gaps = [*_GAP] if "gap" in document["profiles"][0] else []
    rows = [["profile", "pareto_optimal", "continuity", "duration", "is_feasible", *gaps, "joint", *metrics, "notes"]]
    for row in document["profiles"]:
        head = [
            row["name"], row["name"] in document["pareto_optimal"], row["continuity"], row["duration"],
            row["is_feasible"], *(numeric(row["gap"][key]) for key in gaps),
        ]  # fmt: skip
        rows.append([*head, "all", *row["overall"].values(), "; ".join(row["notes"])])
        for j, joint in enumerate(document["joint_names"]):
            rows.append([*head, joint, *(values[j] for values in row["joints"].values()), ""])
    return csv_text(rows)


def _advice(document: Document) -> str:
    return str(document["advice"])


def _starred(document: Document) -> str:
    names = ", ".join(objective["name"] for objective in document["objectives"])
    gap = _GAP_NOTE if "gap" in document["profiles"][0] else ""
    return (
        f"{gap} * Pareto-optimal among those through all points: none is at least as good in all of {names}, and better"
        " in one."
    )


def _ranked(document: Document) -> list[Document]:
    rows = {row["name"]: row for row in document["profiles"]}
    return [rows[name] for name in document["ranking"]]


def _miss(row: Document) -> float:
    return numeric(row["overall"]["via_miss"])


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
        "No gap:": [
            f"{row['name']}: {row['gap']['reason']}"
            for row in document["profiles"]
            if "gap" in row and row["gap"]["reason"]
        ],
        "Left out:": [f"{name}: {reason}" for name, reason in document["unsuitable"].items()],
    }
    return {title: texts for title, texts in remarks.items() if texts}


def _choice_table(document: Document, names: Sequence[str]) -> tuple[list[str], list[list[str]]]:
    """What a reader chooses by, without the columns of torque where no joint's torque is known."""
    rows = [row for row in _ranked(document) if row["name"] in names]
    knows = any(not isnan(numeric(peak)) for row in rows for peak in row["joints"]["peak_torque"])
    heads = [head.format(_unit(document)) for head in _HEADS if knows or head != "torque"]
    table = []
    for row in rows:
        overall = row["overall"]
        measures = (overall["peak_jerk"], overall["integral_of_squared_jerk"], overall["overshoot"])
        torque = [_torque(row, document["joint_names"])] if knows else []
        table.append([
            row["name"] + (" *" if row["name"] in document["pareto_optimal"] else ""),
            "undecided" if row["undecided"] else _violated(read_checks(row["checks"])),
            _at_vias(row, has_vias=len(document["times"]) > 2),
            *torque,
            *(_short(numeric(value)) for value in measures),
            *([_short(numeric(overall["energy_in"]))] if knows else []),
            *([_short(numeric(row["gap"][key])) for key in _GAP] if "gap" in row else []),
        ])  # fmt: skip
    gaps = list(_GAP.values()) if "gap" in rows[0] else []
    return [*heads, *(["energy [J]"] if knows else []), *gaps], table


def _motion_table(document: Document) -> tuple[list[str], list[list[str]]]:
    unit, torque = _unit(document), "N m" if _unit(document) == "rad" else "N m or N"
    rows = _ranked(document)
    # Profiles on the task's own times take the same, which the head tells.
    timed = len({round(row["duration"], 9) for row in rows}) > 1
    heads = [
        "profile", "class", *(["time [s]"] if timed else []), *(head.format(unit) for _, head in _MOTION),
        f"rms torque [{torque}]",
    ]  # fmt: skip
    table = [
        [
            row["name"],
            row["continuity"],
            *([f"{row['duration']:.4g}"] if timed else []),
            *(_short(numeric(row["overall"][key])) for key, _ in _MOTION),
            _short(sqrt(fsum(numeric(value) ** 2 for value in row["joints"]["rms_torque"]))),
        ]
        for row in rows
    ]
    return heads, table


def _unit(document: Document) -> str:
    """Of the position."""
    return str(document["position_unit"])


def _at_vias(row: Document, *, has_vias: bool) -> str:
    if miss := _miss(row):
        return f"misses by {miss:.2g}"
    if not has_vias:
        return "no vias"
    return "stops" if row["stops_at_vias"] else "passes"


def _torque(row: Document, joint_names: list[str]) -> str:
    checks = [check for check in read_checks(row["checks"]) if check.quantity == "effort"]
    if not checks:
        peaks = [numeric(value) for value in row["joints"]["peak_torque"]]
        known = {name: peak for name, peak in zip(joint_names, peaks, strict=True) if not isnan(peak)}
        return f"{max(known, key=known.__getitem__)} {_short(max(known.values()))}" if known else _UNKNOWN
    worst = max(checks, key=lambda check: check.utilisation)
    return percent(worst.utilisation, 1)


def _violated(checks: tuple[LimitCheck, ...]) -> str:
    """How often each quantity is violated, the one that is violated most first; what the cell asks, by its name."""
    violated = [check for check in most_used_first(checks) if check.is_violated]
    named = ["floor" if one.quantity == HEIGHT else f"tool {one.label}" * (one.joint == "tool") for one in violated]
    of_joints = [check.label for check, name in zip(violated, named, strict=True) if not name]
    counts = [f"{_BRIEF.get(name, name)} {of_joints.count(name)}" for name in dict.fromkeys(of_joints)]
    return ", ".join([*(name for name in named if name), *counts]) or "kept"


def _short(value: float) -> str:
    return _UNKNOWN if isnan(value) else number(value)
