"""Acceleration limits as text and as MoveIt's file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import floor, isnan, log10
from typing import Any

from puma_septic.document import numeric
from puma_septic.views.tables import Cell, number, text_table

__all__ = ["moveit", "text"]

Document = Mapping[str, Any]


def text(document: Document) -> str:
    """A table by joint, and where the guaranteed ones are governed."""
    levels = [f"{100 * (1 - level):.3g} % of poses" for level in document["quantiles"]]
    headers = ["joint", "guaranteed", "not beyond", *levels, "unit", "effort limit"]
    rows: list[list[Cell]] = [_row(joint) for joint in document["joints"]]
    pose = ", ".join(f"{joint['name']} {joint['pose']:.4g}" for joint in document["joints"])
    speeds = [joint["speeds"] for joint in document["joints"]]
    state = f"at speeds up to {', '.join(f'{speed:.4g}' for speed in speeds)} rad/s (m/s)" if any(speeds) else "at rest"
    unknown = document["not_assessed"]
    lines = [
        f"Accelerations that the torque limits of {document['robot']} allow at every pose of the region, {state}",
        text_table(headers, rows),
        f"governing: {document['governing_joint']}, at {pose}; certified to {_percent(document['gap'])}",
    ]
    if unknown:
        lines.append(f"not assessed, without a torque limit: {', '.join(unknown)}")
    return "\n".join(lines)


def moveit(document: Document, velocity: Sequence[float]) -> str:
    """MoveIt's ``joint_limits.yaml``."""
    lines = ["joint_limits:"]
    for joint, speed in zip(document["joints"], velocity, strict=True):
        known = not isnan(speed)
        lines.append(f"  {_quoted(joint['name'])}:")
        lines.append(f"    has_velocity_limits: {'true' if known else 'false'}")
        if known:
            lines.append(f"    max_velocity: {float(speed)!r}")
        lines.append("    has_acceleration_limits: true")
        lines.append(f"    max_acceleration: {_down(joint['guaranteed'])!r}")
    return "\n".join(lines) + "\n"


def _row(joint: Document) -> list[Cell]:
    unit = "m/s^2" if joint["is_prismatic"] else "rad/s^2"
    effort = f"{number(numeric(joint['effort']))} {'N' if joint['is_prismatic'] else 'N m'}"
    return [joint["name"], joint["guaranteed"], joint["attained"], *joint["typical"], unit, effort]


def _percent(gap: float | str) -> str:
    return f"{100 * numeric(gap):.2g} %"


def _down(value: float) -> float:
    """Rounded down to six digits, so that what is guaranteed stays so."""
    step = 10.0 ** (floor(log10(value)) - 5)
    return float(f"{floor(value / step) * step:.6g}")


def _quoted(name: str) -> str:
    """As a YAML key; a name with other than plain characters in quotes."""
    plain = name.replace("_", "").isalnum() and not name[0].isdigit()
    return name if plain else "'" + name.replace("'", "''") + "'"
