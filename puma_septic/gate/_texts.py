"""A check as a document for machines and as lines for people."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from puma_septic.assessment import LimitCheck
from puma_septic.document import plain
from puma_septic.gate._reasons import Reason
from puma_septic.quantities import QUANTITIES
from puma_septic.views.tables import Cell, number, text_table

if TYPE_CHECKING:  # the value that these texts describe stands one file up in this room
    from puma_septic.gate._checking import TrajectoryCheck

__all__ = ["check_document", "check_text", "reason_document", "reason_lines"]

_MARGIN_KEYS = ("joint", "quantity", "demand", "limit", "unit", "time", "margin", "utilisation")
# Codes that all joints tend to share.
_SHARED = ("limit_unknown", "drive_unknown", "unbounded_acceleration", "unbounded_jerk", "unbounded_effort")
_REASON_NUMBERS = ("time", "demand", "limit")


def check_document(check: TrajectoryCheck) -> dict[str, Any]:
    """The document of `TrajectoryCheck.to_dict`."""
    return {
        "verdict": check.verdict,
        "reasons": [reason_document(reason) for reason in check.reasons],
        "margins": [{key: plain(getattr(margin, key)) for key in _MARGIN_KEYS} for margin in check.margins],
        "notes": list(check.notes),
    }


def reason_document(reason: Reason) -> dict[str, Any]:
    """One reason with all its fields."""
    return {
        "code": reason.code,
        "verdict": reason.verdict,
        "allowed": reason.allowed,
        "joint": reason.joint,
        "quantity": reason.quantity,
        **{key: plain(getattr(reason, key)) for key in _REASON_NUMBERS},
        "unit": reason.unit or None,
        "message": reason.message,
    }


def check_text(check: TrajectoryCheck) -> str:
    """Verdict first, then reasons, the worst margin of each joint and quantity, and notes."""
    parts = [verdict_line(check), "\n".join(reason_lines(check.reasons))]
    if check.margins:
        parts.append(_margin_table(check))
    parts.append("\n".join(f"note: {note}" for note in check.notes))
    return "\n\n".join(part for part in parts if part)


def verdict_line(check: TrajectoryCheck) -> str:
    """The verdict in one line."""
    counting = [reason for reason in check.reasons if not reason.allowed]
    if not counting:
        worst = check.worst
        return "ok" if worst is None else f"ok; the limit used most: {worst}"
    count = f"{len(counting)} reason{'s' if len(counting) > 1 else ''}"
    return f"{check.verdict}, {count}; the worst: {counting[0].message}"


def reason_lines(reasons: Iterable[Reason]) -> list[str]:
    """One line each; what is said of many joints in the same words shares one."""
    lines: dict[tuple[str, str | None, bool], list[Reason]] = {}
    for k, reason in enumerate(reasons):
        own = reason.code if reason.code in _SHARED else f"{reason.code} {k}"
        lines.setdefault((own, reason.quantity, reason.allowed), []).append(reason)
    return [f"  {together[0] if len(together) == 1 else _together(together)}" for together in lines.values()]


def _together(reasons: list[Reason]) -> str:
    first = reasons[0]
    joints = ", ".join(str(reason.joint) for reason in reasons)
    when = "" if np.isnan(first.time) else f", first at {min(reason.time for reason in reasons):.4g} s"
    kind = "" if first.code.startswith("unbounded") else f":{first.quantity}"
    return f"{first.code}{kind} of {joints}{when}{' (allowed)' if first.allowed else ''}"


def _margin_table(check: TrajectoryCheck) -> str:
    """The worst margin of each joint and quantity, and when."""
    found = {(margin.joint, margin.quantity): margin for margin in check.margins}
    joints = list(dict.fromkeys(margin.joint for margin in check.margins))
    rows: list[list[Cell]] = [
        [joint, *(_cell(found.get((joint, quantity))) for quantity in QUANTITIES)] for joint in joints
    ]
    note = "Worst margin and its instant: what is left of the limit; for positions the distance to the nearer bound"
    return f"{text_table(['joint', *QUANTITIES], rows)}\n{note}"


def _cell(margin: LimitCheck | None) -> str:
    if margin is None:
        return "unknown"
    mark = " !" if margin.is_violated else ""
    size = f"{number(margin.margin, 3)} {margin.unit}" if margin.quantity == "position" else _share(margin.margin)
    return f"{size} at {margin.time:.3f} s{mark}"


def _share(margin: float) -> str:
    return f"{100 * margin:.1f} %" if np.isfinite(margin) else "none"
