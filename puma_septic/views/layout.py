"""Text laid out for a terminal: prose broken at its words, tables that are too wide set anew, no line beyond the width.

What is laid out is text as the views write it: tables have a rule of dashes below their head, and prose may have been
broken at 100 columns already.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, zip_longest
from textwrap import wrap
from typing import Final, final

__all__ = ["WIDTH", "Table", "laid_out"]

# Of text that nobody has laid out for a width: a page of a terminal, a mail, a listing.
WIDTH: Final = 100
_RULE: Final = re.compile(r"-+(?:  -+)+")
_GAP: Final = "  "
# The least a column of words is squeezed to.
_LEAST: Final = 12
_JOINED: Final = "\N{NO-BREAK SPACE}"
# A heading within dashes, which takes what room there is.
_HEADING: Final = re.compile(r"(-+ .*? )-+")
# Prose that was broken at 100 columns, some of it with an indent that was not counted.
_BROKEN_AT: Final = 112


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Table:
    """A head and rows of cells; a cell may have several lines."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    right: tuple[bool, ...]

    def widths(self, head_widths: Sequence[int] | None = None) -> list[int]:
        """Of each column, its head broken at its words unless widths for it are given."""
        heads = head_widths or [max(map(len, title.split() or [""])) for title in self.head]
        return [
            max(width, *(len(line) for row in self.rows for line in row[k].split("\n")), 1)
            for k, width in enumerate(heads)
        ]

    def text(self, widths: Sequence[int]) -> str:
        """Head, rule and rows; heads and cells that are wider than their column are broken at their words."""
        heads = self._lines([wrap(title, width) for title, width in zip(self.head, widths, strict=True)], widths, True)
        rule = _GAP.join("-" * width for width in widths)
        rows = [line for row in self.rows for line in self._lines(_broken(row, widths), widths, False)]
        return "\n".join([*heads, rule, *rows])

    def _lines(self, cells: Sequence[list[str]], widths: Sequence[int], at_foot: bool) -> list[str]:
        height = max(map(len, cells))
        padded = [[""] * (height - len(cell)) + cell if at_foot else cell for cell in cells]
        return [
            _GAP.join(
                text.rjust(width) if right else text.ljust(width)
                for text, width, right in zip(line, widths, self.right, strict=True)
            ).rstrip()
            for line in zip_longest(*padded, fillvalue="")
        ]


def laid_out(text: str, width: int = WIDTH, *, change: Callable[[Table], Table] = lambda table: table) -> str:
    """Text within a width: prose broken at its words, tables set anew where they are wider.

    A table that is too wide has its heads and then its columns of words broken; where that does not do, it is continued
    below, each part with the first column. A word that is longer than a line, such as a path, stays whole.

    Parameters
    ----------
    text : str
    width : int
        Columns.
    change : callable
        What becomes of each table before it is laid out.

    Returns
    -------
    str

    Examples
    --------
    >>> print(laid_out("a sentence of several words", 15))
    a sentence of
      several words
    >>> wide = "joint      peak torque [N m]  remark" + chr(10) + "-----  -----------------  ------" + chr(10)
    >>> print(laid_out(wide.replace("joint    ", "joint") + "elbow              81.25  high", 24))
             peak
           torque
    joint   [N m]  remark
    -----  ------  ------
    elbow   81.25  high
    """
    lines = text.split("\n")
    parts: list[str] = []
    k = 0
    while k < len(lines):
        found = _table_at(lines, k)
        if found is None:
            end = _paragraph_end(lines, k) if width < WIDTH else k + 1
            parts += _prose(lines[k:end], width)
            k = end
            continue
        end, table = found
        changed = change(table)
        fits = changed is table and max(map(len, lines[k:end])) <= width
        parts += lines[k:end] if fits else _set_anew(changed, width).split("\n")
        k = end
    return "\n".join(parts)


def _prose(lines: Sequence[str], width: int) -> list[str]:
    """One paragraph; as it is where it fits."""
    if len(lines) == 1 and (heading := _HEADING.fullmatch(lines[0])):
        return [heading[1].ljust(min(width, len(lines[0])), "-")]
    if len(lines) == 1 and len(lines[0]) <= width:
        return list(lines)
    start = lines[0][: len(lines[0]) - len(lines[0].lstrip())]
    words = " ".join(line.strip() for line in lines)
    further = start if len(lines) > 1 and not lines[1].startswith(f"{start} ") else f"{start}  "
    return wrap(
        words,
        width,
        initial_indent=start,
        subsequent_indent=further,
        break_long_words=False,
        break_on_hyphens=False,
    ) or [""]


def _paragraph_end(lines: Sequence[str], k: int) -> int:
    """Where a paragraph that was broken at 100 columns ends: at the first line that had room for the next word."""
    end = k + 1
    while end < len(lines) and lines[end - 1].strip() and lines[end].strip() and not _table_at(lines, end):
        first = lines[end].split()[0]
        if not WIDTH - len(first) <= len(lines[end - 1]) <= _BROKEN_AT or _HEADING.fullmatch(lines[end]):
            break
        end += 1
    return end


def _table_at(lines: Sequence[str], k: int) -> tuple[int, Table] | None:
    """The table whose head begins in a line, and where it ends."""
    at = next((n for n in range(k + 1, min(k + 5, len(lines))) if _RULE.fullmatch(lines[n])), None)
    if at is None:
        return None
    spans = [match.span() for match in re.finditer("-+", lines[at])]
    if not all(_is_row(line, spans) for line in lines[k:at]):
        return None
    end = at + 1
    while end < len(lines) and lines[end].strip() and _is_row(lines[end], spans):
        end += 1
    heads, body = lines[k:at], lines[at + 1 : end]
    right = tuple(_is_right(body, span) for span in spans)
    rows: list[list[str]] = []
    for line in body:
        cells = _cells(line, spans)
        if rows and not cells[0] and any(cells):  # a further line of the row above
            rows[-1] = ["\n".join(filter(None, pair)) for pair in zip(rows[-1], cells, strict=True)]
        else:
            rows.append(cells)
    head = tuple(
        " ".join(filter(None, column)) for column in zip(*(_cells(line, spans) for line in heads), strict=True)
    )
    return end, Table(head=head, rows=tuple(map(tuple, rows)), right=right)


def _is_row(line: str, spans: Sequence[tuple[int, int]]) -> bool:
    """Whether nothing stands between the columns; the last one may be open."""
    gaps = [(one[1], other[0]) for one, other in pairwise(spans)]
    fits = all(not line[start:end].strip() for start, end in gaps) and len(line) <= spans[-1][1]
    is_note = len(line) <= spans[0][1] and line.endswith(".")  # a short sentence below the table
    return bool(line.strip()) and fits and not is_note


def _cells(line: str, spans: Sequence[tuple[int, int]]) -> list[str]:
    return [line[start:end].strip() for start, end in spans]


def _is_right(body: Sequence[str], span: tuple[int, int]) -> bool:
    """Whether cells end at the column's edge and do not all begin at its start."""
    texts = [line[span[0] : span[1]].ljust(span[1] - span[0]) for line in body]
    filled = [text for text in texts if text.strip()]
    return bool(filled) and all(text[-1] != " " for text in filled) and any(text[0] == " " for text in filled)


def _set_anew(table: Table, width: int) -> str:
    widths = table.widths()
    squeezed = _squeezed(table, widths, width)
    if _total(squeezed) <= width:
        return table.text(squeezed)
    parts = []
    for columns in _blocks(squeezed, width):
        part = replace(
            table,
            head=tuple(table.head[k] for k in columns),
            rows=tuple(tuple(row[k] for k in columns) for row in table.rows),
            right=tuple(table.right[k] for k in columns),
        )
        parts.append(part.text([min(squeezed[k], width) for k in columns]))
    return "\n\n".join(parts)


def _squeezed(table: Table, widths: Sequence[int], width: int) -> list[int]:
    """Columns of words made narrower, the widest first, as far as it takes and their words allow."""
    made = list(widths)
    least = [
        made[k]
        if right or k == 0
        else max(
            _LEAST, *(len(word) for row in table.rows for word in row[k].replace(" %", _JOINED + "%").split(" ")), 1
        )
        for k, right in enumerate(table.right)
    ]
    while _total(made) > width:
        k = max(range(len(made)), key=lambda k: made[k] - least[k])
        if made[k] <= least[k]:
            break
        made[k] -= 1
    return made


def _blocks(widths: Sequence[int], width: int) -> list[list[int]]:
    """Columns that go together below each other, the first one in each."""
    blocks = [[0]]
    for k in range(1, len(widths)):
        if len(blocks[-1]) > 1 and _total([widths[n] for n in (*blocks[-1], k)]) > width:
            blocks.append([0])
        blocks[-1].append(k)
    return blocks


def _broken(row: Sequence[str], widths: Sequence[int]) -> list[list[str]]:
    return [
        [part.replace(_JOINED, " ") for line in cell.split("\n") for part in _parts(line, width)]
        for cell, width in zip(row, widths, strict=True)
    ]


def _parts(cell: str, width: int) -> list[str]:
    """Lines of a cell; a percentage stays with its sign."""
    return wrap(cell.replace(" %", f"{_JOINED}%"), width, break_on_hyphens=False) or [""]


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + len(_GAP) * (len(widths) - 1)
