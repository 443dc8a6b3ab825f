"""A cycle's document as text and HTML."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any, Final

from puma_septic.document import numeric
from puma_septic.limit_check import LimitCheck
from puma_septic.views import assessment
from puma_septic.views.checks import used
from puma_septic.views.tables import Cell, html_table, text_table

__all__ = ["head", "html", "steps_html", "steps_text", "text"]

Document = Mapping[str, Any]

_HEADERS: Final = ("step", "at [s]", "lasts [s]", "carries [kg]", "tool [m/s]", "verdict", "governing limit")


def text(document: Document) -> str:
    """The verdict, the steps in order, and the motion that governs in full."""
    first = document["motions"][0]
    parts = [head(document), steps_text(document), f"Most used: {first['name']}", assessment.text(first["assessment"])]
    return "\n\n".join(parts)


def html(document: Document) -> str:
    """The verdict and the steps in order, for a notebook; every text is escaped."""
    return f"<p><strong>{escape(head(document))}</strong></p>\n{steps_html(document)}"


def head(document: Document) -> str:
    """One line."""
    again = ", then again" if document["is_periodic"] else ""
    return f"{document['robot']}, cycle of {document['duration']:.4g} s{again}: {document['verdict']}"


def steps_text(document: Document) -> str:
    """One row for each step."""
    return text_table(_HEADERS, _rows(document))


def steps_html(document: Document) -> str:
    """The same as a page has it."""
    table = html_table(_HEADERS, _rows(document), caption="The steps of the cycle, each with what the arm carries")
    return f'<div class="scroll">{table}</div>'


def _rows(document: Document) -> list[list[Cell]]:
    rows: list[list[Cell]] = []
    for step in document["steps"]:
        governing = "" if step["governing"] is None else _use(LimitCheck.from_dict(step["governing"]))
        verdict = {None: "", True: "feasible", False: "infeasible"}[step["is_feasible"]]
        speed = f"{numeric(step['tool_speed']):.3g}" if step["is_feasible"] is not None else ""
        times = (f"{step['start']:z.3f}", f"{step['duration']:z.3f}")
        rows.append([step["name"], *times, f"{step['payload_mass']:g}", speed, verdict, governing])
    return rows


def _use(check: LimitCheck) -> str:
    return f"{check.joint} {check.label} {used(check)}"
