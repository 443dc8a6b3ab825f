"""A document of stops as text, HTML and CSV: rows of a joint and a load, columns of extension and speed."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from math import isinf, isnan
from textwrap import wrap
from typing import Any, Final

from puma_septic.document import csv_text, numeric
from puma_septic.views.tables import Cell, html_table, text_table

__all__ = ["csv", "html", "text"]

Document = Mapping[str, Any]

_WIDTH: Final = 100
_NOTE: Final = (
    "Each joint moves alone; from the command to rest: ms, and rad (m) in brackets. Columns: share of the reach / of"
    " the speed."
)


def text(document: Document) -> str:
    """One table for all joints."""
    lines = [*wrap(_head(document), _WIDTH), "", text_table(*_table(document))]
    return "\n".join([*lines, *wrap(f"{_NOTE} {document['warning']}", _WIDTH)])


def html(document: Document) -> str:
    """The same as a page has it."""
    table = html_table(*_table(document))
    note = escape(f"{_NOTE} {document['warning']}")
    return f'<p>{escape(_head(document))}</p>\n<div class="scroll">{table}</div>\n<p>{note}</p>'


def csv(document: Document) -> str:
    """One line per stop."""
    keys = ["joint", "speed", "extension", "load", "duration", "angle", "others"]
    return csv_text([keys, *([row[key] for key in keys] for row in document["stops"])])


def _head(document: Document) -> str:
    speeds = ", ".join(f"{name} {numeric(value):.4g}" for name, value in document["full_speed"].items())
    return (
        f"Stops of category {document['category']} ({document['meaning']}), reaction time"
        f" {1e3 * document['reaction_time']:.4g} ms; full load {document['full_load']:g} kg, full reach"
        f" {document['reach']:.4g} m, full speed {speeds} rad/s (m/s)."
    )


def _table(document: Document) -> tuple[list[str], list[list[Cell]]]:
    stops = document["stops"]
    columns = list(dict.fromkeys((row["extension"], row["speed"]) for row in stops))
    cells = {(row["joint"], row["load"], row["extension"], row["speed"]): _cell(row) for row in stops}
    heads = list(dict.fromkeys((row["joint"], row["load"]) for row in stops))
    headers = ["joint", "load", *(f"{_percent(reach)}/{_percent(speed)}" for reach, speed in columns)]
    rows: list[list[Cell]] = [
        [joint, f"{_percent(load)} %", *(cells[joint, load, *column] for column in columns)] for joint, load in heads
    ]
    return headers, rows


def _percent(share: float) -> str:
    return f"{100 * share:z.0f}"


def _cell(row: Document) -> str:
    duration, angle = numeric(row["duration"]), numeric(row["angle"])
    if isnan(duration):
        return "none"
    return "not held" if isinf(duration) else f"{1e3 * duration:z.0f} ({angle:z.2f})"
