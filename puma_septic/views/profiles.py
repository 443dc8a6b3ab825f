"""Profiles of one task side by side: one row of a table for each assessment's document, and one sentence for all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from puma_septic.document import numeric
from puma_septic.limit_check import HEIGHT, LimitCheck
from puma_septic.views.checks import percent, read_checks, used
from puma_septic.views.tables import Cell, html_table, number, text_table
from puma_septic.views.units import SI, Units

__all__ = ["doubts_text", "html", "sentence", "text"]

Document = Mapping[str, Any]

# Behind a verdict that rests on doubtful data.
_DOUBTFUL: Final = "(?)"
# Below a micrometre or a millionth of a radian nothing overshoots: what rounding or a simulation left.
_NO_OVERSHOOT: Final = 1e-6
_HEADERS: Final = ("profile", "verdict", "governing limit", "velocity", "torque")


def text(documents: Sequence[Document], labels: Sequence[str]) -> str:
    """One row for each profile."""
    rows = [_row(document, label) for label, document in zip(labels, documents, strict=True)]
    return text_table(_heads(documents, "^3"), rows)


def doubts_text(documents: Sequence[Document]) -> str:
    """What the verdicts that the table marks rest on; empty where nothing is doubtful."""
    found = dict.fromkeys(doubt for document in documents for doubt in document["doubts"])
    return f"{_DOUBTFUL} The verdict rests on doubtful data: {'; '.join(found)}." if found else ""


def html(documents: Sequence[Document], labels: Sequence[str], units: Units = SI) -> str:
    """The same as a page has it."""
    rows = [_row(document, label) for label, document in zip(labels, documents, strict=True)]
    caption = "Profiles side by side: the largest among the joints, velocity and torque in per cent of their limits"
    texts = [[number(cell) if isinstance(cell, float) else str(cell) for cell in row] for row in rows]
    table = html_table(*units.table(_heads(documents, "³"), texts), caption=caption)
    return f'<div class="scroll">{table}</div>'


def sentence(documents: Sequence[Document], labels: Sequence[str]) -> str:
    """Which profiles are feasible, and the joint, limit and instant that govern; or what leaves it open."""
    doubts = [doubt for document in documents for doubt in document["undecided"]]
    if doubts:
        return f"Undecided: {'; '.join(dict.fromkeys(doubts))}."
    good = [label for label, document in zip(labels, documents, strict=True) if document["is_feasible"]]
    pairs = [(check, label) for label, one in zip(labels, documents, strict=True) for check in _checks(one)]
    if not pairs:
        return f"{_which(good, labels)}; no limit of this robot is known."
    # Of profiles that share the worst, such as a point's position, the first: rounding does not choose.
    check, label = max(pairs, key=lambda pair: float(f"{pair[0].utilisation:.9g}"))
    whose = f" ({label})" if len(labels) > 1 else ""
    return f"{_which(good, labels)}; governing: {check}{whose}."


def _heads(documents: Sequence[Document], cube: str) -> list[str]:
    """With the unit of the position, of both kinds where an arm has both."""
    slides = {joint["is_prismatic"] for joint in documents[0]["joints"]}
    unit = " or ".join("m" if one else "rad" for one in sorted(slides))
    jerk = " or ".join(f"{'m' if one else 'rad'}/s{cube}" for one in sorted(slides))
    return [*_HEADERS, f"jerk [{jerk}]", f"overshoot [{unit}]"]


def _row(document: Document, label: str) -> list[Cell]:
    governing = "none known"
    if document["governing"] is not None:
        worst = LimitCheck.from_dict(document["governing"])
        governing = f"{worst.joint} {worst.label} {used(worst)}"
    overshoot = max(numeric(joint["overshoot"]) for joint in document["joints"])
    return [
        label,
        _verdict(document),
        governing,
        _most(document, "velocity"),
        _most(document, "effort"),
        max(numeric(joint["peak_jerk"]) for joint in document["joints"]),
        0.0 if overshoot < _NO_OVERSHOOT else overshoot,
    ]


def _verdict(document: Document) -> str:
    if document["undecided"]:
        return "undecided"
    word = "feasible" if document["is_feasible"] else "infeasible"
    return f"{word} {_DOUBTFUL}" if document["doubts"] else word


def _checks(document: Document) -> list[LimitCheck]:
    groups = [joint["checks"] for joint in document["joints"]] + [document["tool"].get("checks", [])]
    floor = [check for check in read_checks(document["violations"]) if check.quantity == HEIGHT]
    return [*(check for group in groups for check in read_checks(group)), *floor]


def _most(document: Document, quantity: str) -> str:
    shares = [check.utilisation for check in _checks(document) if check.quantity == quantity]
    return percent(max(shares)) if shares else "not known"


def _which(good: Sequence[str], labels: Sequence[str]) -> str:
    if len(labels) == 1:
        return f"{labels[0]} {'keeps every known limit' if good else 'does not keep the limits'}"
    if len(good) == len(labels):
        return f"All {len(labels)} profiles keep every known limit"
    if not good:
        return f"None of the {len(labels)} profiles keeps the limits"
    others = [label for label in labels if label not in good]
    return f"{', '.join(good)} keep{'s' if len(good) == 1 else ''} every known limit, {', '.join(others)} not"
