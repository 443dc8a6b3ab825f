"""From a text file to rows of cells: separators, decimal commas, comments, empty lines."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Final, NamedTuple, final

from puma_septic.errors import InputError
from puma_septic.logs._columns import is_unit

__all__ = ["Cells", "Row", "read_cells"]

_COMMENTS: Final = ("#", "%", "//")
_NAMES: Final = {";": "';'", "\t": "tabs", " ": "blanks"}


class Row(NamedTuple):
    """A row as an editor counts it, and its cells."""

    line: int
    cells: list[str]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Cells:
    """A file's header, the units below it (empty where there are none), its rows, and what was decided."""

    header: Row
    units: list[str]
    rows: list[Row]
    notes: tuple[str, ...]


def read_cells(path: str | PathLike[str]) -> Cells:
    """Split a file into cells.

    Raises
    ------
    InputError
        For a file that cannot be read, or has no header.
    """
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            lines = file.read().splitlines()
    except FileNotFoundError as error:
        raise InputError(f"{path}: this CSV file does not exist") from error
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a CSV file: {error}") from error
    comments = sum(line.lstrip().startswith(_COMMENTS) for line in lines)
    plain = [line for line in lines if line.strip() and not line.lstrip().startswith(_COMMENTS)]
    separator = _separator(plain[0] if plain else "")
    rows = _rows(path, lines, separator)
    if not rows:
        raise InputError(f"{path}: the file is empty; a header t, <joint>, ... and at least two rows are needed")
    comma = separator != "," and not any("." in cell for row in rows[1:] for cell in row.cells)
    comma = comma and any("," in cell for row in rows[1:] for cell in row.cells)
    if comma:
        rows[1:] = [Row(row.line, [cell.replace(",", ".") for cell in row.cells]) for row in rows[1:]]
    rows = _without_empty_column(rows)
    has_units = len(rows) > 1 and all(is_unit(cell) or not cell.strip() for cell in rows[1].cells)
    return Cells(
        header=Row(rows[0].line, [cell.strip() for cell in rows[0].cells]),
        units=rows[1].cells if has_units else [],
        rows=rows[2:] if has_units else rows[1:],
        notes=_notes(separator, comma=comma, comments=comments, empty=_empty_inside(lines)),
    )


def _separator(header: str) -> str:
    return next((separator for separator in (";", "\t", ",") if separator in header), " ")


def _rows(path: str | PathLike[str], lines: Sequence[str], separator: str) -> list[Row]:
    """Rows with something in them; comments count as lines."""

    def told() -> Iterator[str]:
        for line in lines:
            yield "" if line.lstrip().startswith(_COMMENTS) else line

    if separator == " ":
        return [Row(k + 1, cells) for k, line in enumerate(told()) if (cells := line.split())]
    try:
        reader = csv.reader(told(), delimiter=separator, strict=True, skipinitialspace=True)
        return [Row(reader.line_num, cells) for cells in reader if "".join(cells).strip()]
    except csv.Error as error:
        raise InputError(f"{path}: cannot be read as a CSV file: {error}") from error


def _without_empty_column(rows: list[Row]) -> list[Row]:
    """Rows without what a separator at the end of every line makes."""
    if len(rows) < 2 or any(row.cells[-1].strip() for row in rows[1:]):
        return rows
    width = len(rows[0].cells) - (not rows[0].cells[-1].strip())
    if any(len(row.cells) != width + 1 for row in rows[1:]):
        return rows
    return [Row(row.line, row.cells[:width]) for row in rows]


def _empty_inside(lines: Sequence[str]) -> int:
    filled = [k for k, line in enumerate(lines) if line.strip()]
    return sum(not line.strip() for line in lines[: filled[-1]]) if filled else 0


def _notes(separator: str, *, comma: bool, comments: int, empty: int) -> tuple[str, ...]:
    def counted(count: int, what: str) -> Iterable[str]:
        return [f"{count} {what}{'s' if count > 1 else ''}"] if count else []

    parts = [
        *([f"separator {_NAMES[separator]}"] if separator != "," else []),
        *(["decimal comma"] if comma else []),
        *counted(comments, "comment line"),
        *counted(empty, "empty line"),
    ]
    return (", ".join(parts),) if parts else ()
