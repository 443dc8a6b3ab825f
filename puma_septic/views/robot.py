"""A robot's document as HTML."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from math import isnan
from typing import Any, Final

from puma_septic.document import numeric
from puma_septic.quantities import QUANTITIES, typeset
from puma_septic.views.tables import Cell, html_table

__all__ = ["html"]

Document = Mapping[str, Any]

# The columns of the drives, those of optional terms where a joint has them.
_DRIVE: Final = {
    "gear_ratio": "gear ratio",
    "rotor_inertia": "rotor inertia [kg m²]",
    "viscous_friction": "viscous [N m s/rad]",
    "coulomb_friction": "Coulomb +, − [N m]",
    "static_friction": "static +, − [N m]",
    "stribeck_velocity": "Stribeck velocity [rad/s]",
    "load_share": "load share",
}


def html(document: Document) -> str:
    """Joints, limits and drives with their sources, for a notebook; every text is escaped."""
    joints = document["joints"]
    load = "" if document["payload"] is None else f", payload {document['payload']['mass']:g} kg"
    head = f"{document['name']}: {len(joints)} joints, tool {document['tool']!r}{load}"
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
        return "unbounded" if joint["is_continuous"] else " to ".join(map(_known, joint["limits"][name]))
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
