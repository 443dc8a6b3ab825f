"""Catalogues of motors, gearboxes and pairs: parts have the numbers of their rows; some catalogues are sized with."""

from __future__ import annotations

import csv
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np

import puma_septic as ps
from campaign.moves import ROOT, cycle
from campaign.mutation import NAMES, Rng, chosen, mangled_bytes, mutated_text
from campaign.plain import check_answer, plain_number, same

_FOLDER: Final = ROOT / "puma_septic" / "catalogues"
_CELLS: Final = (
    "0:0.5; 300:0.4", "0:0.5|300:0.4", "0:0.5; 300", "300:0.4; 0:0.5", "0:nan", "0.5 kg cm^2", "0.5 furlong", "1,5",
    "-", "N/A", "1e150", "1e-150", "=1+1", "＝1+1", "@SUM(A1)", "\x1b[2J", "*", '"', '""', '"a,b"', "1e400", "1/0",
    "0:" * 400, "strain wave",
)  # fmt: skip
_UNITS: Final = (
    "[kg]",
    "[g cm^2]",
    "[lb in]",
    "[oz-in]",
    "[rpm]",
    "[furlong]",
    "[]",
    "[N m/A_rms]",
    "[%]",
    "[degC]",
    "[degF]",
)
# The built-in files' own columns in SI, whose cells are numbers.
_OWN: Final = {"motors": ("mass[kg]", "mass"), "gearboxes": ("ratio", "ratio")}


@cache
def _texts(kind: str) -> tuple[str, ...]:
    paths = [_FOLDER / f"{name}_{kind}.csv" for name in ("example", "puma560")]
    sheets = [ROOT / "docs" / "howto" / "data_sheets.csv"] if kind == "motors" else []
    return tuple(path.read_text(encoding="utf-8") for path in [*paths, *sheets] if path.is_file())


def maker(kind: str) -> Callable[[Rng], bytes]:
    def make(rng: Rng) -> bytes:
        lines = chosen(rng, _texts(kind)).split("\n")
        kept = lines[:3] + [line for line in lines[3:] if rng.random() < 0.4]
        text = "\n".join(kept)
        if rng.random() < 0.12:
            return mangled_bytes(rng, text.encode())
        return mutated_text(rng, text, (_cell, _unit, _separator)).encode("utf-8", "surrogatepass")

    return make


def checker(kind: str) -> Callable[[Path], None]:
    """With the built-in files of the other kinds; one in thirty is sized."""

    def check(path: Path) -> None:
        name = "puma560" if kind == "pairs" else "example"
        files = {part: _FOLDER / f"{name}_{part}.csv" for part in ("motors", "gearboxes")}
        catalogue = ps.load_catalogue(**{**files, kind: path})
        if kind in _OWN:
            parts = catalogue.motors if kind == "motors" else catalogue.gearboxes
            _check_rows(path.read_text(encoding="utf-8-sig"), _OWN[kind], parts)
        if zlib.crc32(path.read_bytes()) % 30 == 0:
            check_answer(ps.size(cycle(), catalogue=catalogue, keep=2))

    return check


def _check_rows(text: str, column: tuple[str, str], parts: tuple[ps.Motor | ps.Gearbox, ...]) -> None:
    """Of each part that is read, one number in SI must be the cell's, where a plain reader finds it."""
    head, attribute = column
    rows = [row for row in csv.reader(text.splitlines()) if row and not row[0].startswith("#")]
    if not rows or "key" not in rows[0] or rows[0].count(head) != 1 or rows[0].count("key") != 1:
        return
    key, place = rows[0].index("key"), rows[0].index(head)
    said: dict[str, list[float]] = {}  # of a key that is there twice one row is refused
    for row in rows[1:]:
        if len(row) == len(rows[0]):
            said.setdefault(row[key].strip(), []).append(plain_number(row[place]))
    for part in parts:
        values = said.get(part.name, [np.nan])
        if not np.isnan(values).any() and getattr(part, attribute) not in values:
            same(f"{attribute} of a part", getattr(part, attribute), values[0], tolerance=1e-15)


def _in_cell(rng: Rng, text: str, change: Callable[[str], str], *, head: bool = False) -> str:
    lines = text.split("\n")
    rows = [k for k, line in enumerate(lines) if line and not line.startswith("#")]
    if not rows:
        return text
    k = rows[0] if head else rows[int(rng.integers(len(rows)))]
    cells = lines[k].split(",")
    place = int(rng.integers(len(cells)))
    cells[place] = change(cells[place])
    lines[k] = ",".join(cells)
    return "\n".join(lines)


def _cell(rng: Rng, text: str) -> str:
    values = _CELLS if rng.random() < 0.8 else NAMES
    return _in_cell(rng, text, lambda _: chosen(rng, values))


def _unit(rng: Rng, text: str) -> str:
    return _in_cell(rng, text, lambda cell: cell.split("[")[0] + chosen(rng, _UNITS), head=True)


def _separator(rng: Rng, text: str) -> str:
    return text.replace(",", chosen(rng, (";", "\t", "|", ",,"))) if rng.random() < 0.3 else _cell(rng, text)
