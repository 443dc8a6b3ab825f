"""A sizing's document as text, HTML and CSV."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from math import isnan, pi
from typing import Any, Final

from puma_septic.document import csv_text, numeric
from puma_septic.limit_check import LimitCheck
from puma_septic.views.checks import percent, read_checks
from puma_septic.views.tables import Cell, html_table, text_table

__all__ = ["checks_csv", "html", "text"]

Document = Mapping[str, Any]

_RPM: Final = 60 / (2 * pi)
# A cause computed as a difference is rounding where it is below this part of the sum of causes.
_ROUNDING: Final = 1e-12
_CAUSES: Final = ("gravity", "motion", "rotor", "friction")
_DEMANDS: Final = (
    "Load: at the gearbox's output. Causes: RMS at the joint. Torques in N m (prismatic joints: load in N), speeds in"
    " 1/min; work: mechanical, in J"
)
_CHECKS: Final = "use: utilisation, demand / limit; margin: 1 - use; ! marks a violated limit, ? a rule of thumb"


def text(document: Document) -> str:
    """Tables that a person reads: verdict, demands, use of every known limit, and what is not known."""
    lines = [_head(document), "", text_table(*_demand_table(document)), _DEMANDS]
    headers, rows = _check_table(document)
    if rows:
        lines += ["", text_table(headers, rows), _CHECKS]
    for title, items in _lists(document).items():
        lines += ["", f"{title}:", *(f"  {item}" for item in items)]
    return "\n".join(lines)


def html(document: Document) -> str:
    """The same for a notebook; every text is escaped."""
    parts = [
        f"<p><strong>{escape(_head(document))}</strong></p>",
        html_table(*_demand_table(document), caption=_DEMANDS),
    ]
    headers, rows = _check_table(document)
    if rows:
        parts.append(html_table(headers, rows, caption=_CHECKS))
    parts += [f"<p>{title}: {escape('; '.join(items))}</p>" for title, items in _lists(document).items()]
    return "\n".join(parts)


def checks_csv(document: Document) -> str:
    """One row for each joint and check, the most used limit of a joint first, in SI units."""
    headers = ["joint", "check", "demand", "limit", "unit", "time [s]", "utilisation", "margin", "kind", "source"]
    keys = ["joint", "quantity", "demand", "limit", "unit", "time", "utilisation", "margin", "kind", "source"]
    checks = [check for joint in document["joints"] for check in joint["checks"]]
    return csv_text([headers, *([check[key] for key in keys] for check in checks)])


def _head(document: Document) -> str:
    kind = "repeats" if document["is_periodic"] else "does not repeat"
    return (
        f"{document['robot']}, cycle of {document['steps']} steps, {document['duration']:g} s, {kind}:"
        f" {document['verdict']}"
    )


def _lists(document: Document) -> dict[str, list[str]]:
    lists = {"Not assessed": document["not_assessed"], "Remarks": document["remarks"]}
    return {title: lines for title, lines in lists.items() if lines}


def _demand_table(document: Document) -> tuple[list[str], list[list[Cell]]]:
    headers = [
        "joint", "load peak", "average", *_CAUSES, "motor peak", "at [s]", "RMS", "speed peak", "mean", "work out", "in"
    ]  # fmt: skip
    return headers, [_demand_row(joint) for joint in document["joints"]]


def _demand_row(joint: Document) -> list[Cell]:
    value = {key: numeric(item) for key, item in joint.items() if key not in _NO_NUMBER}
    causes = {name: numeric(item) for name, item in joint["rms_by_cause"].items()}
    total = sum(causes.values())
    return [
        joint["name"], value["peak_load_torque"], value["average_load_torque"],
        *(causes[name] if causes[name] > _ROUNDING * total else 0.0 for name in _CAUSES),
        value["peak_motor_torque"], f"{value['peak_motor_torque_time']:.3f}", value["rms_motor_torque"],
        value["peak_motor_speed"] * _RPM, value["mean_motor_speed"] * _RPM, value["work_given"], value["work_returned"],
    ]  # fmt: skip


_NO_NUMBER: Final = ("name", "motor", "gearbox", "drive", "rms_by_cause", "checks")


def _check_table(document: Document) -> tuple[list[str], list[list[Cell]]]:
    headers = ["joint", "check", "demand", "limit", "unit", "at [s]", "use", "margin", ""]
    rows: list[list[Cell]] = []
    for joint in document["joints"]:
        for c in read_checks(joint["checks"]):
            when = "" if isnan(c.time) else f"{c.time:.3f}"
            use, margin = percent(c.utilisation, 1), percent(c.margin, 1)
            rows.append([c.joint, c.quantity, c.demand, c.limit, c.unit, when, use, margin, _mark(c)])
    return headers, rows


def _mark(check: LimitCheck) -> str:
    return ("?" if check.kind == "rule of thumb" else "") + ("!" if check.is_violated else "")
