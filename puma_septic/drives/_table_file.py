"""Tables of parts as spreadsheets write them: any delimiter, decimal commas, units in headers or cells."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple, final

from puma_septic.drives._columns import CURRENCY, Column, header_parts, with_voltages
from puma_septic.drives._units import si_size
from puma_septic.errors import InputError, did_you_mean, readable
from puma_septic.files import read_text

__all__ = ["PartTable", "Row", "raw_rows", "read_table"]

_MAX_BYTES: Final = 20_000_000
_DELIMITERS: Final = (",", ";", "\t")
# How data sheets, the MGDB and spreadsheets leave a cell open, in small letters.
_UNKNOWN: Final = frozenset(
    {"", "nan", "inf", "-", "--", "–", "—", "n/a", "na", "n.a.", "#n/a", "none", "null", "tbd", "t.b.d.", "?", "k.a."}
)
# Between the units of the columns of a curve, and between the numbers of one of its rows.
_BESIDE: Final = ":"
# A number, and behind it a unit or a tolerance.
_NUMBER: Final = re.compile(r"^([+-]?(?:[0-9][0-9' \u00a0\u202f.,]*|[.,][0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*)$")
_TOLERANCE: Final = re.compile(r"\s*(?:±|\+/-|\+-)\s*[\d.,]+\s*%?\s*$")
_RATIO: Final = re.compile(r"^\s*:\s*1$")
_AMBIGUOUS: Final = re.compile(r"^[+-]?[1-9]\d{0,2}[.]\d{3}$")  # thousands do not begin with 0


class Row(NamedTuple):
    """A row's texts, its known values in SI units by column, what stands in unknown columns, and where it is.

    `units` are the printed ones of the header.
    """

    texts: dict[str, str]
    values: dict[str, Any]
    other: dict[str, str]
    where: str
    units: dict[str, str]


class _Header(NamedTuple):
    """A column of the file: its name, its printed unit (None: none), and whether it is known."""

    name: str
    unit: str | None
    is_known: bool


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PartTable:
    """The rows of a file that could be read, the others with the reason, and columns that are not known."""

    rows: tuple[Row, ...]
    refused: tuple[str, ...]
    unknown: tuple[str, ...]


def read_table(path: Path, columns: Mapping[str, Column]) -> PartTable:
    """Read a table of parts; a row that cannot be read is told, and the others are there.

    Returns
    -------
    PartTable

    Raises
    ------
    InputError
        For a file without a header, or whose header lacks a column that must be there.
    """
    lines, has_commas = raw_rows(path)
    if not lines:
        raise InputError(f"{path}: no header; expected columns {', '.join(columns)}")
    number, cells = lines[0]
    columns = with_voltages(columns, [header_parts(cell.lstrip("\ufeff"))[0] for cell in cells])
    header = _header(f"{path}, row {number}", cells, columns)
    rows, refused = [], []
    for number, cells in lines[1:]:
        try:
            rows.append(_row(f"{path}, row {number}", cells, header, columns, has_commas))
        except InputError as error:
            refused.append(str(error))
    unknown = tuple(f"{one.name!r} (unknown{did_you_mean([one.name], columns)})" for one in header if not one.is_known)
    return PartTable(rows=tuple(rows), refused=tuple(refused), unknown=unknown)


def raw_rows(path: Path) -> tuple[list[tuple[int, list[str]]], bool]:
    """The lines with content, remarks left out, and whether numbers have decimal commas.

    Returns
    -------
    list of (int, list of str)
        Number of the line, and its cells.
    bool
    """
    text = read_text(path, what="catalogue", at_most=_MAX_BYTES)
    text = readable(text.replace("\r\n", "\n").replace("\r", "\n"))
    first = next((line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), "")
    outside = re.sub(r'"[^"]*"|\[[^\]]*\]', "", first)
    delimiter = max(_DELIMITERS, key=outside.count)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    try:
        lines = [(reader.line_num, cells) for cells in reader if _is_content(cells)]
    except csv.Error as error:
        raise InputError(f"{path}, row {reader.line_num}: not a CSV file: {error}") from error
    return lines, delimiter != ","


def _is_content(cells: list[str]) -> bool:
    return any(cell.strip() for cell in cells) and not cells[0].lstrip().startswith("#")


def _header(where: str, cells: list[str], columns: Mapping[str, Column]) -> list[_Header]:
    header = []
    for cell in cells:
        name, unit = header_parts(cell.lstrip("\ufeff"))
        is_known = name in columns
        if is_known and unit is not None:
            _checked_unit(where, name, unit, columns[name].unit)
        header.append(_Header(name, unit, is_known))
    names = [one.name for one in header]
    for name in columns:
        if names.count(name) > 1:
            raise InputError(f"{where}: column {name!r} occurs twice")
        if columns[name].is_needed and name not in names:
            meant = did_you_mean([name], [one.name for one in header if not one.is_known])
            raise InputError(f"{where}: column {name!r} is missing; the header has {', '.join(names)}{meant}")
    return header


def _checked_unit(where: str, name: str, unit: str, target: str | None) -> None:
    try:
        if target is None:
            raise ValueError(f"unknown unit {unit!r}; it is text and has none")
        _checked_size(unit, target)
    except ValueError as error:
        raise InputError(f"{where}: column {name!r}: {error}") from error


def _checked_size(unit: str, target: str) -> None:
    """Raise a ValueError for a unit that is none of the quantity."""
    if _BESIDE in target:
        _sizes(unit, target)
    else:
        _size(unit, target)


def _size(unit: str, target: str) -> float:
    if target == CURRENCY:
        if unit == "%":
            raise ValueError("unknown unit '%'; expected a currency")
        return 1.0
    return si_size(unit, target)


def _sizes(unit: str, target: str) -> list[float]:
    """Of each column of a curve."""
    units, targets = unit.split(_BESIDE), target.split(_BESIDE)
    if len(units) != len(targets):
        raise ValueError(f"unknown unit {unit!r}; expected those of {target}")
    return [si_size(*both) for both in zip(units, targets, strict=True)]


def _row(where: str, cells: list[str], header: list[_Header], columns: Mapping[str, Column], has_commas: bool) -> Row:
    if len(cells) > len(header) and any(cell.strip() for cell in cells[len(header) :]):
        raise InputError(f"{where}: {len(cells)} cells, but the header has {len(header)} columns")
    texts = {name: "" for name, column in columns.items() if column.unit is None}
    values: dict[str, Any] = {}
    other: dict[str, str] = {}
    for one, cell in zip(header, cells, strict=False):
        text = cell.strip()
        target = columns[one.name].unit if one.is_known else None
        if not one.is_known:
            if text:
                other[one.name if one.unit is None else f"{one.name}[{one.unit}]"] = text
        elif target is None:
            texts[one.name] = text
        elif text.lower() not in _UNKNOWN:
            try:
                values[one.name] = _value(text, one.unit, target, has_commas)
            except ValueError as error:
                told = f": {error}" if error.args else ""
                raise InputError(f"{where}, column {one.name!r}: {text!r} is not {_expected(target)}{told}") from error
    units = {one.name: one.unit for one in header if one.unit is not None}
    return Row(texts, values, other, where, units)


def _expected(target: str) -> str:
    return "a curve such as '0:0.5; 300:0.4'" if _BESIDE in target else "a number"


def _value(text: str, unit: str | None, target: str, has_commas: bool) -> Any:
    """A cell in SI units."""
    if _BESIDE in target:
        return _curve(text, _sizes(target if unit is None else unit, target), has_commas)
    match = _NUMBER.match(_TOLERANCE.sub("", text))
    if match is None:
        raise ValueError
    number, rest = _number(match[1], has_commas), match[2].strip()
    if target == "" and _RATIO.match(rest):
        return number
    printed = rest or unit  # a unit in the cell comes before that of the header
    return number if printed is None else number * _size(printed, target)


def _number(text: str, has_commas: bool) -> float:
    """A number with its thousands separators taken out.

    Raises
    ------
    ValueError
        Where a comma or point may be either.
    """
    plain = re.sub(r"['\u00a0\u202f ]", "", text)
    if not plain.isascii() or "_" in plain:  # float() would take 1_000, and the digits of any script
        raise ValueError("no number")
    if "," in plain and "." in plain:
        decimal = max(".,", key=plain.rindex)
        plain = plain.replace("," if decimal == "." else ".", "")
        return float(plain.replace(",", "."))
    if "," in plain:
        if not has_commas or plain.count(",") > 1:
            raise ValueError("a comma in a file with commas between its cells")
        return float(plain.replace(",", "."))
    if has_commas and _AMBIGUOUS.match(plain):
        raise ValueError("thousands or thousandths? write it without the point, or with a decimal comma")
    return float(plain)


def _curve(text: str, sizes: list[float], has_commas: bool) -> list[list[float]]:
    rows = [row.split(_BESIDE) for row in re.split(r"[;|]", text) if row.strip()]
    return [
        [_number(number.strip(), has_commas) * size for number, size in zip(row, sizes, strict=True)] for row in rows
    ]
