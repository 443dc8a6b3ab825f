"""The document of a planned trajectory's check as text: the verdict first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any, Final

from puma_septic.limit_check import LimitCheck
from puma_septic.quantities import COMMON, QUANTITIES
from puma_septic.views.checks import read_checks, verdict
from puma_septic.views.tables import Cell, number, text_table

__all__ = ["text"]

Document = Mapping[str, Any]

# Codes that all joints tend to share.
_SHARED: Final = ("limit_unknown", "drive_unknown", "unbounded_acceleration", "unbounded_jerk", "unbounded_effort")
_BY_QUANTITY: Final = ("limit_unknown", "drive_unknown")


def text(document: Document) -> str:
    """Verdict, reasons, the worst margin of each joint and quantity, and notes."""
    margins, cell = read_checks(document["margins"]), read_checks(document["cell_margins"])
    parts = [
        _verdict_line(document, [*margins, *cell]),
        "\n".join(_reason_lines(document["reasons"])),
        _margin_table(margins) if margins else "",
        "\n".join(f"{margin}" for margin in cell),
        "\n".join(f"note: {note}" for note in document["notes"]),
    ]
    return "\n\n".join(part for part in parts if part)


def _verdict_line(document: Document, margins: Sequence[LimitCheck]) -> str:
    counting = [reason for reason in document["reasons"] if not reason["allowed"]]
    if not counting:
        worst = max(margins, key=lambda check: check.utilisation, default=None)
        return verdict((document["verdict"], ""), (), worst)
    count = f"{len(counting)} reason{'s' if len(counting) > 1 else ''}"
    return f"{document['verdict']}, {count}; the worst: {counting[0]['message']}"


def _reason_lines(reasons: Sequence[Document]) -> list[str]:
    """One line each; what is said of many joints in the same words shares one."""
    groups: dict[tuple[str, str | None, bool], list[Document]] = {}
    for k, reason in enumerate(reasons):
        own = reason["code"] if reason["code"] in _SHARED else f"{reason['code']} {k}"
        groups.setdefault((own, reason["quantity"], reason["allowed"]), []).append(reason)
    return [f"  {_together(group)}{' (allowed)' if group[0]['allowed'] else ''}" for group in groups.values()]


def _together(reasons: Sequence[Document]) -> str:
    first = reasons[0]
    if len(reasons) == 1:
        return f"{first['code']}: {first['message']}"
    kind = f":{first['quantity']}" if first["code"] in _BY_QUANTITY else ""
    times = [reason["time"] for reason in reasons if reason["time"] is not None]
    when = f", first at {min(times):.4g} s" if times else ""
    return f"{first['code']}{kind} of {', '.join(reason['joint'] for reason in reasons)}{when}"


def _margin_table(margins: Sequence[LimitCheck]) -> str:
    """The worst margin of each joint and quantity, and when."""
    found = {(margin.joint, margin.quantity): margin for margin in margins}
    joints = list(dict.fromkeys(margin.joint for margin in margins))
    shown = [name for name in QUANTITIES if name in COMMON or any(margin.quantity == name for margin in margins)]
    headers = ["joint", *(QUANTITIES[name].label for name in shown)]
    rows: list[list[Cell]] = [[joint, *(_cell(found.get((joint, name))) for name in shown)] for joint in joints]
    note = "Worst margin and its instant: what is left of the limit; for positions the distance to the nearer bound"
    return f"{text_table(headers, rows)}\n{note}"


def _cell(margin: LimitCheck | None) -> str:
    if margin is None:
        return "unknown"
    mark = " !" if margin.is_violated else ""
    share = f"{100 * margin.margin:z.1f} %" if isfinite(margin.margin) else "none"
    size = f"{number(margin.margin, 3)} {margin.unit}" if margin.is_range else share
    return f"{size} at {margin.time:z.3f} s{mark}"
