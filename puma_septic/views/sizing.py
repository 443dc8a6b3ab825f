"""A sizing's document as text, HTML and CSV."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape
from math import isnan, pi
from typing import Any, Final

from puma_septic.document import csv_text, numeric
from puma_septic.limit_check import LimitCheck, most_used_first
from puma_septic.views.checks import percent, read_checks
from puma_septic.views.tables import Cell, html_table, number, text_table

__all__ = ["checks_csv", "governing_rows", "hours", "html", "reserve_lines", "short_text", "text"]

Document = Mapping[str, Any]
Table = tuple[list[str], list[list[Cell]]]

_RPM: Final = 60 / (2 * pi)
# A cause computed as a difference is rounding where it is below this part of the sum of causes.
_ROUNDING: Final = 1e-12
_CAUSES: Final = ("gravity", "motion", "gears", "rotor", "friction")
_DEMANDS: Final = (
    "Load: at the gearbox's output. Causes: RMS at the joint. Torques in N m (prismatic joints: load in N), speeds in"
    " 1/min; work: mechanical, in J"
)
_ELECTRIC: Final = (
    "Electric side, at the motors' terminals: A, W and, over the cycle, J; winding: temperature rise in K; expected"
    " life of the gearbox in h"
)
_GOVERNING: Final = "Of each joint the limit that is used most; use: demand / limit; margin: 1 - use"
# A life beyond this, more than a century, is told as no number: the power law goes on where other causes end a gear.
_MOST_HOURS: Final = 1e6
# What is printed as 0.0 %.
_IDLE: Final = 5e-4
_CHECKS: Final = "use: utilisation, demand / limit; margin: 1 - use; ! marks a violated limit, ? a rule of thumb"


def short_text(document: Document) -> str:
    """The verdict, the limit that governs at each joint, what is lacking, and what more there is."""
    lines = [_head(document), "", text_table(*_governing_table(document)), _GOVERNING, ""]
    lacking = _lacking(document)
    lines += [f"Not known of the least that decides a drive: {'; '.join(lacking)}."] if lacking else []
    lines += [f"{line[0].upper()}{line[1:]}." for line in reserve_lines(document)]
    kinds = len({line.partition(":")[0] for line in document["not_assessed"]})
    lines += [f"Not assessed: {kinds} kinds of checks, of whose data too little is known."] if kinds else []
    lines += [f"Remark: {remark}." for remark in _remarks(document)]
    return "\n".join([*lines, "More: -v shows loads, the electric side, every check and what is not assessed."])


def text(document: Document) -> str:
    """Tables that a person reads: verdict, demands, use of every known limit, and what is not known."""
    lines = [_head(document)]
    for table, note in _tables(document):
        lines += ["", text_table(*table), note]
    for title, items in _lists(document).items():
        lines += ["", f"{title}:", *(f"  {item}" for item in items)]
    return "\n".join(lines)


def html(document: Document) -> str:
    """The same for a notebook; every text is escaped."""
    parts = [f"<p><strong>{escape(_head(document))}</strong></p>"]
    parts += [html_table(*table, caption=note) for table, note in _tables(document)]
    for title, items in _lists(document).items():
        parts.append(f"<p>{title}:</p><ul>{''.join(f'<li>{escape(item)}</li>' for item in items)}</ul>")
    return "\n".join(parts)


def hours(value: Any) -> str:
    """A life in hours."""
    life = numeric(value)
    return f"over {_MOST_HOURS:,.0f}" if life > _MOST_HOURS else number(life)


def governing_rows(document: Document) -> list[tuple[str, LimitCheck]]:
    """Each joint that has a known limit, with the one that it uses most: a rule of thumb is none."""
    rows: list[tuple[str, LimitCheck]] = []
    for joint in document["joints"]:
        limits = [check for check in read_checks(joint["checks"]) if check.kind != "rule of thumb"]
        if limits and all(name != joint["name"] for name, _ in rows):
            rows.append((joint["name"], most_used_first(limits)[0]))
    return rows


def checks_csv(document: Document) -> str:
    """One row for each joint and check, the most used limit of a joint first, in SI units."""
    headers = ["joint", "check", "demand", "limit", "unit", "time [s]", "utilisation", "margin", "kind", "source"]
    keys = ["joint", "quantity", "demand", "limit", "unit", "time", "utilisation", "margin", "kind", "source"]
    checks = _checks_of(document)
    return csv_text([headers, *([check[key] for key in keys] for check in checks)])


def _checks_of(document: Document) -> list[Any]:
    """Joint by joint, then those of the shared supply."""
    of_supply = [] if document["supply"] is None else document["supply"]["checks"]
    return [check for joint in document["joints"] for check in joint["checks"]] + of_supply


def reserve_lines(document: Document) -> list[str]:
    """What the drives could do more, where that was asked: a sentence each."""
    words = {
        "cycle_time": ("least cycle time by the drives alone", "s"),
        "payload": ("largest payload by the drives alone", "kg"),
    }
    lines = []
    for key, end in document.get("reserves", {}).items():
        name, unit = words[key]
        if "why_not" in end:
            lines.append(f"{name}: {end['why_not']}")
            continue
        beyond = "" if end["governing"] is None else f"; beyond it {LimitCheck.from_dict(end['governing'])}"
        lines.append(f"{name} {number(end['value'])} {unit}, to {100 * end['tolerance']:g} %{beyond}")
    return lines


def _head(document: Document) -> str:
    kind = "repeats" if document["is_periodic"] else "does not repeat"
    return (
        f"{document['robot']}, cycle of {document['steps']} steps, {document['duration']:g} s, {kind}:"
        f" {document['verdict']}"
    )


def _tables(document: Document) -> list[tuple[Table, str]]:
    """Demands, electric side, use of the limits, each with its note; the last two where something is known."""
    tables = [(_demand_table(document), _DEMANDS)]
    electric, checks = _electric_table(document), _check_table(document)
    if electric[1]:
        tables.append((electric, _ELECTRIC))
    tables += [(table, note) for table, note in (_supply_table(document), _compliance_table(document)) if table[1]]
    if checks[1]:
        tables.append((checks, _CHECKS + _folded(document)))
    return tables


def _supply_table(document: Document) -> tuple[Table, str]:
    """Of the supply that all drives share, where there is one."""
    supply = document["supply"]
    headers = ["supply", "peak", "at [s]", "mean", "current", "drawn", "returned", "exchanged", "braked"]
    keys = [
        "peak_drawn_power", "peak_drawn_power_time", "mean_drawn_power", "peak_current", "energy_drawn",
        "energy_returned", "energy_exchanged", "energy_braked",
    ]  # fmt: skip
    rows: list[list[Cell]] = [] if supply is None else [[supply["name"], *(numeric(supply[key]) for key in keys)]]
    note = "All drives together: powers in W, current in A, energies in J per cycle; exchanged: from joint to joint"
    return (headers, rows), note


def _compliance_table(document: Document) -> tuple[Table, str]:
    """Of gears whose stiffness or backlash is known."""
    found = document["compliance"]
    headers = ["arm", "wind-up [mm]", "backlash [mm]", "lowest frequency [Hz]"]
    rows: list[list[Cell]] = []
    if found is not None:
        millimetres = (1e3 * numeric(found[key]) for key in ("tool_windup", "tool_backlash"))
        rows = [[document["robot"], *millimetres, numeric(found["lowest_frequency"])]]
    return (headers, rows), "Elastic gears, at the tool, at its largest; the frequency with the motors held"


def _lists(document: Document) -> dict[str, list[str]]:
    lists = {
        "Reserves": reserve_lines(document),
        "Not known of the least that decides a drive": _lacking(document),
        "Not assessed": document["not_assessed"],
        "Remarks": _remarks(document),
    }
    return {title: lines for title, lines in lists.items() if lines}


def _lacking(document: Document) -> list[str]:
    """What is not known of the least, each once, with the joints of which it is not."""
    return _once(((", ".join(missing), joint) for joint, missing in document["lacking"].items()), document)


def _remarks(document: Document) -> list[str]:
    """Each once: what is said of a joint, with all joints of which it is said."""
    names = {joint["name"] for joint in document["joints"]}
    parts = [remark.partition(": ") for remark in document["remarks"]]
    of_joints = [(said, name) for name, _, said in parts if name in names]
    others = [remark for remark, (name, _, _) in zip(document["remarks"], parts, strict=True) if name not in names]
    return _once(of_joints, document) + others


def _once(pairs: Iterable[tuple[str, str]], document: Document) -> list[str]:
    joints: dict[str, list[str]] = {}
    for what, name in pairs:
        joints.setdefault(what, []).append(name)
    every = len({joint["name"] for joint in document["joints"]})
    return [
        f"{what} ({'all joints' if len(names) == every > 1 else ', '.join(names)})" for what, names in joints.items()
    ]


def _governing_table(document: Document) -> Table:
    """What governs at each joint, and in which load case where there are some."""
    cased = bool(document["load_cases"])
    headers = [
        "joint",
        "governing limit",
        "demand",
        "limit",
        "unit",
        *(["load case"] if cased else []),
        "use",
        "margin",
    ]
    rows: list[list[Cell]] = []
    for name, c in governing_rows(document):
        case = [c.case] if cased else []
        use, margin = percent(c.utilisation, 1), percent(c.margin, 1)
        rows.append([name, c.quantity, c.demand, c.limit, c.unit, *case, use, margin])
    return headers, rows


def _demand_table(document: Document) -> Table:
    headers = [
        *_case_header(document), "load peak", "average", *_CAUSES, "motor peak", "at [s]", "RMS", "speed peak", "mean",
        "work out", "in",
    ]  # fmt: skip
    return headers, [_demand_row(document, joint) for joint in document["joints"]]


def _case_header(document: Document) -> list[str]:
    return ["joint", "load case"] if document["load_cases"] else ["joint"]


def _names(document: Document, joint: Document) -> list[Cell]:
    return [joint["name"], joint.get("case", "")] if document["load_cases"] else [joint["name"]]


def _electric_table(document: Document) -> Table:
    """Of the joints whose currents are known."""
    headers = [
        *_case_header(document), "RMS current", "peak", "peak power", "mean", "drawn", "returned", "winding", "life",
    ]  # fmt: skip
    keys = [
        "rms_current", "peak_current", "peak_drawn_power", "mean_drawn_power", "energy_drawn", "energy_returned",
        "winding_temperature_rise",
    ]  # fmt: skip
    known = [joint for joint in document["joints"] if joint["rms_current"] is not None]
    rows = [
        [*_names(document, joint), *(numeric(joint[key]) for key in keys), hours(joint["expected_gearbox_life_hours"])]
        for joint in known
    ]
    return headers, rows


def _demand_row(document: Document, joint: Document) -> list[Cell]:
    value = {key: numeric(item) for key, item in joint.items() if key not in _NO_NUMBER}
    causes = {name: numeric(item) for name, item in joint["rms_by_cause"].items()}
    total = sum(causes.values())
    return [
        *_names(document, joint), value["peak_load_torque"], value["average_load_torque"],
        *(causes[name] if causes[name] > _ROUNDING * total else 0.0 for name in _CAUSES),
        value["peak_motor_torque"], f"{value['peak_motor_torque_time']:z.3f}", value["rms_motor_torque"],
        value["peak_motor_speed"] * _RPM, value["mean_motor_speed"] * _RPM, value["work_given"], value["work_returned"],
    ]  # fmt: skip


_NO_NUMBER: Final = ("name", "motor", "gearbox", "drive", "case", "rms_by_cause", "checks")


def _check_table(document: Document) -> Table:
    """Of the checks that use something of their limit."""
    cased = bool(document["load_cases"])
    headers = [
        "joint",
        "check",
        "demand",
        "limit",
        "unit",
        "at [s]",
        *(["load case"] if cased else []),
        "use",
        "margin",
        "",
    ]
    broken = {(check["joint"], check["quantity"]) for key in ("violations", "warnings") for check in document[key]}
    rows: list[list[Cell]] = []
    for c in _checks(document):
        if not _is_idle(c):
            when = "" if isnan(c.time) else f"{c.time:z.3f}"
            mark = ("?" if c.kind == "rule of thumb" else "") + ("!" if (c.joint, c.quantity) in broken else "")
            case = [c.case] if cased else []
            use, margin = percent(c.utilisation, 1), percent(c.margin, 1)
            rows.append([c.joint, c.quantity, c.demand, c.limit, c.unit, when, *case, use, margin, mark])
    return headers, rows


def _checks(document: Document) -> list[LimitCheck]:
    return list(read_checks(_checks_of(document)))


def _is_idle(check: LimitCheck) -> bool:
    """Whether a check uses 0.0 % of its limit, as it is printed."""
    return check.utilisation < _IDLE


def _folded(document: Document) -> str:
    count = sum(_is_idle(check) for check in _checks(document))
    return f"; {count} check{'s' if count > 1 else ''} at 0.0 % not shown" if count else ""
