"""Rows to text and HTML: strings only."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from html import escape
from typing import Final

from tabulate import tabulate

from puma_septic.errors import InputError
from puma_septic.quantities import typeset

__all__ = ["Cell", "html_table", "number", "text_table"]

Cell = str | int | float

# How a reader is told that a demand has no bound and that a number is not known.
_UNBOUNDED, _UNKNOWN = "unbounded", "unknown"
# Outside these magnitudes the power of ten is written out.
_PLAIN_FROM, _PLAIN_BELOW = 1e-4, 1e7
# A cell that stands at the right: a number, a percentage, a number with the share of a limit behind it.
_NUMBER: Final = re.compile(r"[-±]?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?: %)?(?: \(\d* ?%?!?\)| !)?")
_WORDS: Final = ("", "--", "none", "not known", _UNBOUNDED, _UNKNOWN)
_FILLED: Final = re.compile(r" +(?=</t[dh]>)|(?<=\">) +")


def number(value: float, digits: int = 4) -> str:
    """Write a number with at least the given number of significant digits, never cutting its integer part.

    Examples
    --------
    >>> [number(value) for value in (0.5, 12345.6, -1.23456e-9, 0.0)]
    ['0.5000', '12346', '-1.235e-09', '0']
    >>> [number(float(value)) for value in ("inf", "-inf", "nan")]
    ['unbounded', '-unbounded', 'unknown']
    """
    if math.isnan(value):
        return _UNKNOWN
    if math.isinf(value):
        return _UNBOUNDED if value > 0 else f"-{_UNBOUNDED}"
    if value == 0:
        return "0"
    scientific = f"{value:.{digits - 1}e}"
    if not _PLAIN_FROM <= abs(value) < _PLAIN_BELOW:
        return scientific
    exponent = int(scientific.partition("e")[2])  # after rounding: 9.9996 is 10.00
    return f"{value:z.{max(0, digits - 1 - exponent)}f}"


def text_table(headers: Sequence[str], rows: Sequence[Sequence[Cell]]) -> str:
    """Lay out rows as plain text, columns of numbers to the right.

    Floats are written by `number`; a string is left as it is.

    Raises
    ------
    InputError
        If a row has not one cell per header.

    Examples
    --------
    >>> print(text_table(["joint", "peak [N m]"], [["elbow", 81.25], ["wrist", float("inf")]]))
    joint      peak [N m]
    -------  ------------
    elbow           81.25
    wrist       unbounded
    """
    return _table(headers, rows, "simple")


def html_table(headers: Sequence[str], rows: Sequence[Sequence[Cell]], *, caption: str | None = None) -> str:
    """Lay out rows as an HTML table, columns of numbers to the right; every string is escaped.

    Powers of units are set as in print, and a percentage stays with its sign; numbers stay as a spreadsheet reads them.

    Raises
    ------
    InputError
        If a row has not one cell per header.
    """
    cells = [[_text(cell).replace(" %", "\u00a0%") for cell in row] for row in rows]
    # tabulate fills cells up to the width of their column.
    table = _FILLED.sub("", _table([typeset(head) for head in headers], cells, "html"))
    if caption is None:
        return table
    return table.replace("<table>", f"<table>\n<caption>{escape(caption)}</caption>", 1)


def _table(headers: Sequence[str], rows: Sequence[Sequence[Cell]], layout: str) -> str:
    for k, row in enumerate(rows):
        if len(row) != len(headers):
            raise InputError(f"row {k}: {len(row)} cells for {len(headers)} columns")
    texts = [[_text(cell) for cell in row] for row in rows]
    columns = zip(*texts, strict=True) if texts else ([] for _ in headers)
    sides = ["right" if column and all(map(_is_number, column)) else "left" for column in columns]
    # tabulate 0.9 knows no columns where there are no rows.
    return str(tabulate(texts, headers, tablefmt=layout, colalign=sides if rows else (), disable_numparse=True))


def _text(cell: Cell) -> str:
    return number(cell) if isinstance(cell, float) else str(cell)


def _is_number(text: str) -> bool:
    plain = text.replace("\u00a0", " ").strip()
    return plain in _WORDS or plain.removeprefix("-") in _WORDS or _NUMBER.fullmatch(plain) is not None
