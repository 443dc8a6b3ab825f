"""An assessment's document as text, HTML and CSV."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from math import inf, isinf, isnan
from typing import Any, Final

from puma_septic.document import csv_text, numeric
from puma_septic.limit_check import LimitCheck
from puma_septic.quantities import MOTION, QUANTITIES, Quantity
from puma_septic.views.checks import read_checks
from puma_septic.views.tables import html_table, number, text_table
from puma_septic.views.units import SI, Units

__all__ = [
    "html",
    "joints_text",
    "listed",
    "lists",
    "lowest_text",
    "metrics_csv",
    "tables",
    "text",
]

Document = Mapping[str, Any]

# What is not known, which the list below the tables explains.
# Of a motion that swings wildly no more crossings are listed; the document has all.
_MOST_CROSSINGS: Final = 12
_UNKNOWN: Final = "--"
# Below this part of the largest of all joints a value is what rounding left, in tables.
_ROUNDING: Final = 1e-9
# What a row of the CSV file has no place for.
_NO_METRIC: Final = ("name", "is_prismatic", "checks", "margins")


def text(document: Document) -> str:
    """A table that a person reads, with verdict, violations and what is not known."""
    return "\n\n".join([joints_text(document), *listed(lists(document))])


def listed(lists: Mapping[str, Sequence[str]]) -> list[str]:
    """Each list with its title, the items indented; none of a list without items."""
    return ["\n".join([f"{title}:", *(f"  {item}" for item in items)]) for title, items in lists.items() if items]


def joints_text(document: Document) -> str:
    """The verdict and the tables of the joints, without the lists below them."""
    rest = f", then {document['dwell']:g} s at rest" if document["dwell"] else ""
    motion, effort = _joint_rows(document)
    note = "In parentheses: utilisation of the limit; ! marks a violation"
    return "\n".join([
        _head(document, rest),
        "",
        text_table(_motion_headers(document), motion),
        "",
        text_table(_effort_headers(document), effort),
        note,
        "",
        _tool_text(document),
    ])  # fmt: skip


def html(document: Document) -> str:
    """Verdict, tables and what is not known, for a notebook; every text is escaped."""
    texts = [f"{title}: {'; '.join(items)}" for title, items in lists(document).items()]
    return "\n".join(
        [
            f"<p><strong>{escape(_head(document))}</strong></p>",
            tables(document),
            *(f"<p>{escape(line)}</p>" for line in [_tool_text(document), *texts]),
        ]
    )


def tables(document: Document, units: Units = SI) -> str:
    """What each joint does and needs, and what is left of its limits, as HTML tables in the boxes that scroll."""
    motion, effort = _joint_rows(document)
    quantities = _quantities(document)
    margins = [[joint["name"], *(_margin(joint, quantity) for quantity in quantities)] for joint in document["joints"]]
    parts = (
        html_table(
            *units.table(_motion_headers(document), motion),
            caption="Peaks, and in parentheses utilisation of the limits",
        ),
        html_table(_effort_headers(document), effort, caption="Torque and energy, over the motion and its dwell"),
        html_table(
            ["joint", *(quantity.label for quantity in quantities)],
            [[units.prose(cell) for cell in row] for row in margins],
            caption="Margins: what is left of the limit; for positions the distance to the nearer bound",
        ),
    )
    return "\n".join(f'<div class="scroll" style="overflow-x:auto">{part}</div>' for part in parts)


def metrics_csv(assessed: Sequence[tuple[str, str, Document]]) -> str:
    """One row for each task, profile and joint, of the names of task and profile and a document."""
    rows = []
    for task, profile, document in assessed:
        for joint in document["joints"]:
            metrics = {key: value for key, value in joint.items() if key not in _NO_METRIC}
            margins = {f"margin {quantity}": value for quantity, value in joint["margins"].items()}
            rows.append({"task": task, "profile": profile, "joint": joint["name"], **metrics, **margins})
    headers = list(dict.fromkeys(key for row in rows for key in row))
    return csv_text([headers, *([row.get(key) for key in headers] for row in rows)])


def _head(document: Document, rest: str = "") -> str:
    return f"{document['robot']}, {document['profile']}, {document['duration']:g} s{rest}: {document['verdict']}"


def lowest_text(lowest: Document) -> str:
    """Which part of the arm comes how low, and when."""
    height = numeric(lowest["height"])
    side = "below" if height < 0 else "above"
    return f"{lowest['part']}, {abs(height):z.3f} m {side} the base at {numeric(lowest['time']):z.3f} s"


def lists(document: Document) -> dict[str, list[str]]:
    """What stands below the tables, where there is any."""
    found = {
        "Violated limits": [str(check) for check in read_checks(document["violations"])],
        "Not assessed": document["not_assessed"],
        "Remarks": document["remarks"],
    }
    return {title: lines for title, lines in found.items() if lines}


def _unit(document: Document, quantity: Quantity) -> str:
    """Of a column: that of all joints, or of both kinds."""
    return " or ".join(dict.fromkeys(quantity.unit(joint["is_prismatic"]) for joint in document["joints"]))


def _motion_headers(document: Document) -> list[str]:
    return ["joint", *(f"{name} [{_unit(document, QUANTITIES[name])}]" for name in MOTION)]


def _quantities(document: Document) -> list[Quantity]:
    """Those that the document has margins of."""
    return [QUANTITIES[name] for name in document["joints"][0]["margins"]]


def _further(document: Document) -> list[Quantity]:
    """What there is beside the motion and the torque, such as the torque's own rate."""
    return [quantity for quantity in _quantities(document) if quantity.signal != "position" and quantity.order]


def _effort_headers(document: Document) -> list[str]:
    further = [f"{quantity.label} [{_unit(document, quantity)}]" for quantity in _further(document)]
    effort = _unit(document, QUANTITIES["effort"])
    sides = ["energy in [J]", "energy out [J]"]
    return ["joint", f"torque [{effort}]", "at [s]", f"rms torque [{effort}]", *further, *sides]


def _joint_rows(document: Document) -> tuple[list[list[str]], list[list[str]]]:
    """What each joint does and what it needs, in two tables, so that each fits on a page."""
    motion: list[list[str]] = []
    effort: list[list[str]] = []
    further = _further(document)
    for joint in _without_rounding(document["joints"]):
        checks = {check.quantity: check for check in read_checks(joint["checks"])}
        motion.append([
            joint["name"],
            f"{joint['position_min']:z.3f} .. {joint['position_max']:z.3f}{_use(checks.get('position'))}",
            *(_size(joint[f"peak_{name}"], checks.get(name)) for name in MOTION[1:]),
        ])  # fmt: skip
        torque = numeric(joint["peak_torque"]) * joint["peak_torque_sign"] + 0.0  # no -0
        at = numeric(joint["peak_torque_time"])
        effort.append([
            joint["name"],
            _size(torque, checks.get("effort")),
            _UNKNOWN if isnan(at) else f"{at:z.3f}",
            _size(joint["rms_torque"], None),
            *(_size(joint[f"peak_{one.attribute}"], checks.get(one.name)) for one in further),
            _size(joint["energy_in"], None),
            _size(joint["energy_out"], None),
        ])  # fmt: skip
    return motion, effort


def _without_rounding(joints: Sequence[Document]) -> list[dict[str, Any]]:
    """The joints, with 0 for each peak, mean and energy that is nothing beside the largest of all joints."""
    cleaned = [dict(joint) for joint in joints]
    for key in (key for key in joints[0] if key.startswith(("peak_", "rms_", "energy_"))):
        sizes = [abs(numeric(joint[key])) for joint in joints]
        floor = _ROUNDING * max((size for size in sizes if size < inf), default=0.0)
        for joint, size in zip(cleaned, sizes, strict=True):
            joint[key] = 0.0 if size < floor else joint[key]
    return cleaned


def _size(value: float | str | None, check: LimitCheck | None) -> str:
    size = value if isinstance(value, float) else numeric(value)
    return ("unbounded" if isinf(size) else _UNKNOWN if isnan(size) else number(size)) + _use(check)


def _use(check: LimitCheck | None) -> str:
    if check is None:
        return ""
    if isinf(check.utilisation):
        return " (!)"
    mark = "!" if check.is_violated else ""
    return f" ({100 * check.utilisation:z.0f} %{mark})"


def _margin(joint: Document, quantity: Quantity) -> str:
    value = numeric(joint["margins"][quantity.name])
    if isnan(value):
        return "not known"
    if isinf(value):
        return "none"
    return (
        f"{number(value, 3)} {quantity.unit(joint['is_prismatic'])}" if quantity.is_range else f"{100 * value:z.0f} %"
    )


def _tool_text(document: Document) -> str:
    tool = document["tool"]
    acceleration, (low, high) = numeric(tool["peak_acceleration"]), tool["height_range"]
    reached = "acceleration unbounded" if isinf(acceleration) else f"acceleration up to {acceleration:z.3f} m/s^2"
    parts = [
        f"Tool {document['tool_frame']!r}: speed up to {tool['peak_speed']:z.3f} m/s at"
        f" {tool['peak_speed_time']:z.3f} s, {reached}, height {low:z.3f} to {high:z.3f} m"
    ]
    parts.append(f"Lowest point: {lowest_text(document['lowest'])}")
    if limits := read_checks(tool.get("checks", [])):
        parts.append(f"Limits of the tool: {'; '.join(_tool_use(check) for check in limits)}")
    for report in document["singularities"]:
        if crossings := report["crossings"]:
            times = ", ".join(f"{time:z.3f}" for time in crossings[:_MOST_CROSSINGS])
            often = f"{len(crossings)} times, first " if len(crossings) > _MOST_CROSSINGS else ""
            parts.append(f"Singularity {report['kind']!r}: crossed {often}at {times} s")
    return "\n".join(parts)


def _tool_use(check: LimitCheck) -> str:
    source = f" ({check.source})" if check.source else ""
    return f"{check.label} {_size(check.demand, check)} of {check.limit:.4g} {check.unit}{source}"
