"""A robot's document as text and HTML."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from math import isnan
from textwrap import wrap
from typing import Any, Final

from puma_septic.document import numeric
from puma_septic.quantities import QUANTITIES, Quantity, typeset
from puma_septic.views.tables import Cell, html_table, text_table

__all__ = ["html", "short_text", "text"]

Document = Mapping[str, Any]

# The columns of the drives, those of optional terms where a joint has them.
# Decimals of a pose: below a micrometre and a millionth of a degree is what rounding left.
_PLACES: Final = 6
_DRIVE: Final = {
    "gear_ratio": "gear ratio",
    "rotor_inertia": "rotor inertia [kg m²]",
    "viscous_friction": "viscous [N m s/rad]",
    "coulomb_friction": "Coulomb +, − [N m]",
    "static_friction": "static +, − [N m]",
    "stribeck_velocity": "Stribeck velocity [rad/s]",
    "load_share": "load share",
}


def text(document: Document) -> str:
    """Joints, limits, masses, drives, frames and what must be known of them, within 100 columns or so."""
    joints = document["joints"]
    parts = [_head(document), text_table(*_joint_rows(document)), _mimic_text(document), _drive_text(joints)]
    parts.append(_listed("Frames", [", ".join(document["frames"])]))
    if "pose" in document:
        parts.append(_pose_text(document))
    parts.append(_listed("Not drawn", document["missing_meshes"]))
    parts.append(_listed("Notes", document["notes"]))
    return "\n\n".join(part for part in parts if part)


def short_text(document: Document) -> str:
    """Joints with their limits, the pose of the tool, and what more there is."""
    parts = [_head(document), text_table(*_joint_rows(document)), _mimic_text(document)]
    if "pose" in document:
        parts.append(_pose_text(document))
    parts.append(_listed("Not drawn", document["missing_meshes"]))
    count = len(document["notes"])
    notes = f" and {count} note{'s' if count > 1 else ''}" if count else ""
    parts.append(f"More: -v shows the drives, {len(document['frames'])} frames{notes}.")
    return "\n\n".join(part for part in parts if part)


def _head(document: Document) -> str:
    load = "" if document["payload"] is None else f", payload {document['payload']['mass']:g} kg"
    chosen = " (chosen; tool=... for another)" if document["tool_is_chosen"] else ""
    return f"{document['name']}: {len(document['joints'])} joints, tool {document['tool']!r}{chosen}{load}"


def _joint_rows(document: Document) -> tuple[list[str], list[list[Cell]]]:
    joints = document["joints"]
    quantities = [QUANTITIES[name] for name in joints[0]["limits"]]
    headers = ["joint", "type", *(_headed(quantity, joints) for quantity in quantities), "moves [kg]"]
    rows: list[list[Cell]] = [
        [joint["name"], _kind(joint), *(_limit(joint, one.name) for one in quantities), f"{joint['mass']:.4g}"]
        for joint in joints
    ]
    return headers, rows


def _headed(quantity: Quantity, joints: Sequence[Document]) -> str:
    """With the unit, where it is that of all joints."""
    units = {quantity.unit(joint["is_prismatic"]) for joint in joints}
    return f"{quantity.name} [{units.pop()}]" if len(units) == 1 else quantity.name


def _kind(joint: Document) -> str:
    return "prismatic" if joint["is_prismatic"] else "continuous" if joint["is_continuous"] else "revolute"


def _mimic_text(document: Document) -> str:
    lines = [
        f"{name} = {one['multiplier']:g} {one['master']}" + (f" + {one['offset']:g}" if one["offset"] else "")
        for name, one in document["mimics"].items()
    ]
    units = "Limits in rad, rad/s ... and N m (m, m/s ... and N where prismatic), from: "
    mimics = f"\nFollowing another: {'; '.join(lines)}" if lines else ""
    return f"{units}{document['limits_source']}{mimics}"


def _drive_text(joints: Sequence[Document]) -> str:
    if all(isnan(numeric(joint["actuator"][key])) for joint in joints for key in ("gear_ratio", "rotor_inertia")):
        return "Drives: gear ratios and rotor inertias unknown"
    columns = {key: title for key, title in _DRIVE.items() if any(key in joint["actuator"] for joint in joints)}
    rows: list[list[Cell]] = [
        [joint["name"], *(_values(joint["actuator"].get(key)) for key in columns)] for joint in joints
    ]
    return f"Drives, motor side:\n{text_table(['joint', *columns.values()], rows)}"


def _pose_text(document: Document) -> str:
    pose = document["pose"]
    at = ", ".join(f"{name} {value:g}" for name, value in pose["joints"].items() if value) or "all joints at 0"
    place, turn = (", ".join(f"{round(value, _PLACES):z.5g}" for value in pose[key]) for key in ("position", "rpy_deg"))
    return f"Tool at {at}:\n  position {place} m\n  roll, pitch, yaw {turn} degrees"


def _listed(title: str, items: Sequence[str]) -> str:
    lines = [line for item in items for line in wrap(item, 98, initial_indent="  ", subsequent_indent="    ")]
    return "\n".join([f"{title}:", *lines]) if lines else ""


def html(document: Document) -> str:
    """Joints, limits and drives with their sources, for a notebook; every text is escaped."""
    joints = document["joints"]
    head = _head(document)
    parts = [_joint_table(joints), _limit_table(document), _drive_table(joints)]
    boxes = [f'<div class="scroll" style="overflow-x:auto">{part}</div>' for part in parts]
    notes = f"<p>{escape('; '.join(document['notes']))}</p>" if document["notes"] else ""
    return "\n".join([f"<p><strong>{escape(head)}</strong></p>", *boxes, notes])


def _joint_table(joints: Sequence[Document]) -> str:
    rows: list[list[Cell]] = [
        [
            joint["name"],
            "prismatic" if joint["is_prismatic"] else "revolute",
            _triple(joint["origin"]),
            _triple(joint["axis"]),
        ]
        for joint in joints
    ]
    caption = "Joints, with all positions at zero, in the world"
    return html_table(["joint", "type", "origin x, y, z [m]", "axis x, y, z"], rows, caption=caption)


def _limit_table(document: Document) -> str:
    joints = document["joints"]
    quantities = [QUANTITIES[name] for name in joints[0]["limits"]]
    rows: list[list[Cell]] = [
        [joint["name"], *(_limit(joint, quantity.name) for quantity in quantities)] for joint in joints
    ]
    units = " (prismatic joints: m and N)" if any(joint["is_prismatic"] for joint in joints) else ""
    return html_table(
        ["joint", *(f"{quantity.name} [{typeset(quantity.units[0])}]" for quantity in quantities)],
        rows,
        caption=_sourced(f"Limits{units}", [document["limits_source"]]),
    )


def _limit(joint: Document, name: str) -> str:
    if name == "position":
        least, most = joint["limits"][name]
        if joint["is_continuous"]:
            return "unbounded"
        return f"±{_known(most)}" if least == -most else f"{_known(least)} to {_known(most)}"
    return _known(joint["limits"][name])


def _drive_table(joints: Sequence[Document]) -> str:
    keys = dict.fromkeys(key for joint in joints for key in joint["actuator"] if key != "source")
    columns = {key: _DRIVE.get(key, key.replace("_", " ")) for key in keys}
    rows: list[list[Cell]] = [
        [joint["name"], *(_values(joint["actuator"].get(key)) for key in columns)] for joint in joints
    ]
    return html_table(
        ["joint", *columns.values()],
        rows,
        caption=_sourced("Drives, motor side", (joint["actuator"]["source"] for joint in joints)),
    )


def _values(given: float | str | Sequence[float | str | None] | None) -> str:
    return ", ".join(map(_known, given if isinstance(given, list) else [given]))


def _triple(vector: Iterable[float]) -> str:
    # Rounding leaves -0, which adding 0 makes 0.
    return ", ".join(f"{round(value, 4) + 0.0:.4g}" for value in vector)


def _known(value: float | str | None) -> str:
    number = numeric(value)
    return "unknown" if isnan(number) else f"{number:.6g}"


def _sourced(what: str, sources: Iterable[str]) -> str:
    """A caption with the sources, each named once."""
    known = "; ".join(dict.fromkeys(source for source in sources if source))
    return what + (f", from: {known}" if known else "")
