"""How fast and how heavy, as text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from puma_septic.document import numeric
from puma_septic.limit_check import LimitCheck
from puma_septic.views.tables import number

__all__ = ["duration_text", "intervals_text", "payload_text"]

Document = Mapping[str, Any]


def duration_text(document: Document) -> str:
    """The least duration and what stops it."""
    spans = intervals_text(document["feasible"], "s")
    lines = []
    if document["reason"]:
        lines += [f"No duration from which every longer one is feasible: {document['reason']}"]
    else:
        lines += [f"Least duration {number(document['duration'], 6)} s ({document['profile']})"]
    lines += [
        f"feasible: {spans} ({document['certificate']})",
        f"what stops it: {LimitCheck.from_dict(document['governing'])}",
    ]
    return "\n".join([*lines, *(f"not assessed: {line}" for line in document["not_assessed"])])


def payload_text(document: Document) -> str:
    """The heaviest payload and what stops it."""
    com = ", ".join(f"{value:g}" for value in document["com"])
    lines = [
        f"Heaviest payload {number(document['mass'], 6)} kg, its centre at ({com}) m of the tool frame",
        f"feasible: {intervals_text(document['feasible'], 'kg')} ({document['certificate']})",
        f"what stops it: {LimitCheck.from_dict(document['governing'])}",
    ]
    return "\n".join([*lines, *(f"not assessed: {line}" for line in document["not_assessed"])])


def intervals_text(intervals: Iterable[Sequence[float | str]], unit: str) -> str:
    """Closed intervals in words."""
    spans = []
    for low, high in intervals:
        least = number(numeric(low), 6)
        spans.append(
            f"from {least} {unit}" if isinstance(high, str) else f"{least} to {number(numeric(high), 6)} {unit}"
        )
    return "; ".join(spans) if spans else "none"
