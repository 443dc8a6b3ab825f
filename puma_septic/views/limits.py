"""How fast and how heavy, as text and CSV."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from math import inf
from typing import Any, Final

from puma_septic.document import csv_text, numeric
from puma_septic.limit_check import LimitCheck
from puma_septic.views.tables import Cell, html_table, number, text_table

__all__ = ["csv", "duration_text", "html", "intervals_text", "payload_text", "sentence", "text"]

Document = Mapping[str, Any]


_HEADERS: Final = ("profile", "as given [s]", "least duration [s]", "what stops it", "payload [kg]", "what stops it")


def sentence(document: Document) -> str:
    """Which profile can be quickest, which carries most at its own duration, and what stops them."""
    quick = [one for one in document["profiles"] if one["fastest"] is not None and not one["fastest"]["reason"]]
    strong = [one for one in document["profiles"] if one["heaviest"] is not None]
    said = "No profile has a duration from which on every longer one is feasible."
    if quick:
        best = min(quick, key=lambda one: numeric(one["fastest"]["duration"]))
        fast = best["fastest"]
        said = (
            f"Quickest: {best['label']} in {number(fast['duration'])} s instead of {number(best['duration'])} s;"
            f" {_stopper(fast['governing'])} stops it."
        )
    if not strong and any(map(_bears_any, document["profiles"])):
        return f"{said} No known limit bears the payload."
    if not strong:
        return f"{said} None keeps the limits with any payload at its own duration."
    best = max(strong, key=lambda one: numeric(one["heaviest"]["mass"]))
    heavy = best["heaviest"]
    return (
        f"{said} Most payload at its own duration: {best['label']}, {number(numeric(heavy['mass']), 3)} kg;"
        f" {_stopper(heavy['governing'])} stops it."
    )


def text(document: Document) -> str:
    """How fast, how heavy and what stops it: a sentence, a row for each profile, and its reasons below."""
    rows = [_row(one) for one in document["profiles"]]
    lines = [f"{document['task']}: how fast, how heavy", "", sentence(document), "", text_table(_HEADERS, rows), ""]
    for one in document["profiles"]:
        lines += [f"{one['label']}: {note}" for note in _notes(one)]
    unknown = _unknown(document)
    return "\n".join([*lines, *([f"Not assessed: {'; '.join(unknown)}"] if unknown else [])]).rstrip()


def html(document: Document) -> str:
    """The table and its reasons as a page has them; every text is escaped."""
    table = html_table(_HEADERS, [_row(one) for one in document["profiles"]], caption="How fast, how heavy")
    notes = [f"{one['label']}: {note}" for one in document["profiles"] for note in _notes(one)]
    notes += [f"Not assessed: {line}" for line in document.get("not_assessed", ())]
    items = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return table + (f"<ul>{items}</ul>" if notes else "")


def _unknown(document: Document) -> list[str]:
    of_profiles = (line for one in document["profiles"] for line in _not_assessed(one))
    return list(dict.fromkeys([*of_profiles, *document.get("not_assessed", ())]))


def _row(one: Document) -> list[Cell]:
    fast, heavy = one["fastest"], one["heaviest"]
    return [
        one["label"],
        number(one["duration"]),
        "none" if fast is None or fast["reason"] else number(fast["duration"], 5),
        "" if fast is None or fast["reason"] else _stopper(fast["governing"]),
        number(heavy["mass"], 5) if heavy is not None else "any" if _bears_any(one) else "none",
        "" if heavy is None else _stopper(heavy["governing"]),
    ]


def _bears_any(one: Document) -> bool:
    """Whether no known limit bears the payload, at no duration."""
    return any(numeric(most) == inf for _, most in one["masses"])


def _stopper(check: Document) -> str:
    one = LimitCheck.from_dict(check)
    return f"{one.joint} {one.label} at {one.time:.4g} s"


def _notes(one: Document) -> list[str]:
    """What the table has no room for."""
    notes = [reason for reason in (one["why_not_fastest"], one["why_not_heaviest"]) if reason]
    fast, heavy = one["fastest"], one["heaviest"]
    if fast is not None and (fast["reason"] or len(fast["feasible"]) > 1):
        notes.append(f"feasible durations: {intervals_text(fast['feasible'], 's')}")
        notes += [fast["reason"]] if fast["reason"] else []
    if heavy is not None and heavy["feasible"][0][0]:
        notes.append(f"feasible payloads: {intervals_text(heavy['feasible'], 'kg')}")
    if "reference" in one:
        notes.append(_reference(one["reference"]))
    certificates = {answer["certificate"] for answer in (fast, heavy) if answer is not None} - {"proved"}
    return [*notes, *(f"{certificate}, not proved" for certificate in sorted(certificates))]


def _reference(found: Document) -> str:
    """How far the profile is from the quickest motion along its path."""
    if found["reason"]:
        return f"no reference: {found['reason']}"
    excess = ""
    if found["excess"] is not None:
        excess = f", which breaks a limit: {LimitCheck.from_dict(found['excess'])}"
    return (
        f"gap {number(numeric(found['gap']), 4)}: along the same path the optimum takes"
        f" {number(found['certified_duration'], 5)} s ({number(found['duration'], 5)} s by {found['solver']}{excess})"
    )


def _not_assessed(one: Document) -> list[str]:
    return [
        line for answer in (one["fastest"], one["heaviest"]) if answer is not None for line in answer["not_assessed"]
    ]


def csv(document: Document) -> str:
    """Least and largest mass over the duration, a row for each profile and duration."""
    rows = [
        [one["label"], duration, *masses]
        for one in document["profiles"]
        for duration, masses in zip(one["durations"], one["masses"], strict=True)
    ]
    return csv_text([["profile", "duration [s]", "least payload [kg]", "largest payload [kg]"], *rows])


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
