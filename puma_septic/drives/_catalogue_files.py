"""Catalogues from CSV files; every complaint names file, row and column."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from puma_septic.drives._catalogue import Catalogue, Pair
from puma_septic.drives._columns import GEARBOX, GEARBOX_FIELDS, MOTOR, MOTOR_FIELDS, PAIR, Column, parsed_header
from puma_septic.drives._parts import Drive, Gearbox, Motor
from puma_septic.errors import InputError
from puma_septic.files import decoded, read_bytes
from puma_septic.friction import Friction
from puma_septic.validation import checked_choice

__all__ = ["BUILT_IN", "built_in_catalogue", "load_catalogue"]

BUILT_IN: Final = ("example", "puma560")
_MAX_BYTES: Final = 20_000_000
_UNKNOWN: Final = ("", "nan", "inf")  # how the MGDB and spreadsheets leave a cell open
# Numbers that no check uses yet.
_UNUSED: Final = ("L", "omega_nl", "I_nl", "max_cont_power", "pole_pairs", "stages", "stiffness")
_FRICTION_FIELDS: Final = {
    "coulomb_positive": "coulomb", "coulomb_negative": "coulomb", "viscous_friction": "viscous",
    "stribeck_velocity": "stribeck_velocity", "load_share": "load_share", "static_positive": "static",
    "static_negative": "static",
}  # fmt: skip


class _Row(NamedTuple):
    """A row's texts and known values in SI units by column, and where it stands."""

    texts: dict[str, str]
    values: dict[str, Any]
    where: str


def load_catalogue(motors: str | Path, gearboxes: str | Path, pairs: str | Path | None = None) -> Catalogue:
    """Read a catalogue from CSV files.

    A header is a column's name, with its unit in brackets where that is not SI: ``inertia[kg cm^2]``. Lines that begin
    with # are remarks. An empty cell (or nan, inf) is a value that is not known. Curves are written as
    ``speed:torque`` pairs with semicolons between them: ``0:0.5; 300:0.4``.

    Parameters
    ----------
    motors : str or Path
        Columns key, mass, inertia, max_int_torque and any of the others of the MGDB and these: max_cont_torque (else
        ``k_t I_nom``), S1, peak, max_int_power, tau_w, tau_h, T_max, I_peak (of the motor; ``k_t I_peak`` is the peak
        torque where none is given), max_inertia_ratio, cost. V is the bus voltage where the joint has no drive.
        Rth1 with tau_w is a winding in one node; with Rth2 and tau_h as well, in two.
    gearboxes : str or Path
        Columns key, ratio, mass, inertia (at the input), efficiency and any of the others of the MGDB and these: T_N,
        n_N, L_n, T_A (else max_cont_torque), T_R (else max_int_torque), T_M, n_in_av, n_in_max, no_load_torque,
        backdrive_efficiency, cost. Speeds are the input's.
    pairs : str or Path, optional
        Columns motor and gearbox (their keys), and what is measured of both together: viscous_friction,
        coulomb_positive, coulomb_negative and the optional terms of `Friction`, static_positive, static_negative,
        stribeck_velocity, load_share (at the motor, through the gears), max_effort (at the joint). Without the file
        every motor fits every gearbox.

    Returns
    -------
    Catalogue

    Raises
    ------
    InputError
        With file, row and column: a missing or unknown column, an unknown unit, a cell that is no number or out of
        bounds, a key that occurs twice.
    """
    found = _parts(Path(motors), MOTOR, _motor)
    cogs = _parts(Path(gearboxes), GEARBOX, _gearbox)
    fitting = None if pairs is None else _pairs(Path(pairs), found, cogs)
    try:
        return Catalogue(
            motors=tuple(motor for motor, _ in found.values()),
            gearboxes=tuple(gearbox for gearbox, _ in cogs.values()),
            pairs=fitting,
            drives=tuple(Drive(bus_voltage=row.values.get("V", np.nan)) for _, row in found.values()),
            unused=tuple(
                f"column {name} of the {kind}"
                for kind, rows in (("motors", found), ("gearboxes", cogs))
                for name in _UNUSED
                if any(name in row.values for _, row in rows.values())
            ),
        )
    except InputError as error:
        raise InputError(f"{pairs or motors}: {error}") from error


def built_in_catalogue(name: str = "example") -> Catalogue:
    """A catalogue that comes with the package.

    Parameters
    ----------
    name : {"example", "puma560"}
        "example": invented parts, to try things out; nobody sells them. "puma560": the six drives of the PUMA 560 from
        published values, each motor with its own gears alone.

    Returns
    -------
    Catalogue

    Examples
    --------
    >>> built_in_catalogue("puma560").n_pairs
    6
    """
    checked_choice("catalogue", name, BUILT_IN)
    folder = Path(__file__).resolve().parents[1] / "catalogues"
    pairs = folder / f"{name}_pairs.csv"
    return load_catalogue(
        folder / f"{name}_motors.csv", folder / f"{name}_gearboxes.csv", pairs if pairs.is_file() else None
    )


def _parts(path: Path, columns: dict[str, Column], make: Callable[[_Row, str], Any]) -> dict[str, tuple[Any, _Row]]:
    """Parts by key, with the rows that they come from."""
    parts: dict[str, tuple[Any, _Row]] = {}
    for row in _rows(path, columns):
        key = row.texts["key"]
        if not key:
            raise InputError(f"{row.where}, column 'key': the cell is empty")
        if key in parts:
            raise InputError(f"{row.where}, column 'key': {key!r} occurs twice, first in {parts[key][1].where}")
        parts[key] = make(row, _source(row, path)), row
    if not parts:
        raise InputError(f"{path}: no rows below the header")
    return parts


def _source(row: _Row, path: Path) -> str:
    named = " ".join(filter(None, (row.texts.get("manufacturer"), row.texts.get("ID"))))
    return "; ".join(filter(None, (named, row.texts.get("source"), path.name)))


def _motor(row: _Row, source: str) -> Motor:
    values, fields = row.values, _fields(row, MOTOR_FIELDS)
    k_t, current = values.get("k_t", np.nan), values.get("I_nom", np.nan)
    if "peak_torque" not in fields and not np.isnan(k_t) and "I_peak" in values:
        fields["peak_torque"] = k_t * values["I_peak"]
    if "continuous_curve" in fields and "continuous_torque" in fields:
        raise InputError(f"{row.where}, column 'S1': the row has max_cont_torque as well; give one of them")
    if "continuous_curve" not in fields:
        torque = fields.pop("continuous_torque", k_t * current)
        if not np.isnan(torque) and "max_cont_speed" in values:
            fields["continuous_curve"] = [[0.0, torque], [values["max_cont_speed"], torque]]
        else:
            fields["continuous_torque"] = torque
    if {"Rth1", "tau_w"} <= values.keys() and ("Rth2" in values) == ("tau_h" in values):
        nodes = [("Rth1", "tau_w"), *([("Rth2", "tau_h")] if "Rth2" in values else [])]
        fields["thermal_resistances"] = [values[name] for name, _ in nodes]
        fields["thermal_time_constants"] = [values[name] for _, name in nodes]
    motor: Motor = _made(Motor, {"name": row.texts["key"], "source": source}, fields, row, MOTOR_FIELDS)
    return motor


def _gearbox(row: _Row, source: str) -> Gearbox:
    fields = _fields(row, GEARBOX_FIELDS)
    if "ratio" not in fields:
        raise InputError(f"{row.where}, column 'ratio': the cell is empty; the ratio is required")
    if (direction := row.values.get("direction", 1.0)) not in (1.0, -1.0):
        raise InputError(f"{row.where}, column 'direction': {direction:g} is neither 1 nor -1")
    fields["ratio"] *= direction
    needed = {"name": row.texts["key"], "source": source, "ratio": 1.0}
    gearbox: Gearbox = _made(Gearbox, needed, fields, row, GEARBOX_FIELDS)
    return gearbox


def _fields(row: _Row, names: Mapping[str, str]) -> dict[str, Any]:
    """The known values by field; of two columns for one field the later one in `names` counts."""
    return {field: row.values[column] for column, field in names.items() if column in row.values}


def _made(kind: Any, needed: dict[str, Any], fields: dict[str, Any], row: _Row, names: Mapping[str, str]) -> Any:
    """The part; where it refuses its values, the first that it refuses alone names the column."""
    try:
        return kind(**{**needed, **fields})
    except InputError as error:
        for column, field in names.items():
            if field in fields and column in row.values:
                try:
                    kind(**{**needed, field: fields[field]})
                except InputError as own:
                    raise InputError(f"{row.where}, column {column!r}: {own}") from own
        raise InputError(f"{row.where}: {error}") from error


def _pairs(path: Path, motors: dict[str, Any], gearboxes: dict[str, Any]) -> tuple[Pair, ...]:
    pairs = []
    for row in _rows(path, PAIR):
        for column, keys in (("motor", motors), ("gearbox", gearboxes)):
            if row.texts[column] not in keys:
                raise InputError(f"{row.where}, column {column!r}: no {column} has the key {row.texts[column]!r}")
        values = row.values
        friction = None
        if _FRICTION_FIELDS.keys() & values.keys():
            given = {field: values.get(column, np.nan) for column, field in _FRICTION_FIELDS.items()}
            for level in ("coulomb", "static"):
                given[level] = [values.get(f"{level}_{side}", np.nan) for side in ("positive", "negative")]
            friction = _made(Friction, {"coulomb": given["coulomb"]}, given, row, _FRICTION_FIELDS)
        effort = values.get("max_effort", np.nan)
        if effort <= 0:
            raise InputError(f"{row.where}, column 'max_effort': {effort:g} N m must be greater than 0 N m")
        pairs.append(Pair(motor=row.texts["motor"], gearbox=row.texts["gearbox"], friction=friction, max_effort=effort))
    return tuple(pairs)


def _rows(path: Path, columns: dict[str, Column]) -> Iterator[_Row]:
    """The rows below the header, remarks and empty lines left out."""
    text = decoded(read_bytes(path, what="catalogue", at_most=_MAX_BYTES), path)
    reader = csv.reader(io.StringIO(text, newline=""))
    try:
        lines = [(reader.line_num, cells) for cells in reader if _is_content(cells)]
    except csv.Error as error:
        raise InputError(f"{path}, row {reader.line_num}: not a CSV file: {error}") from error
    if not lines:
        raise InputError(f"{path}: no header; expected columns {', '.join(columns)}")
    header = _header(f"{path}, row {lines[0][0]}", lines[0][1], columns)
    for number, cells in lines[1:]:
        yield _row(f"{path}, row {number}", cells, header, columns)


def _is_content(cells: list[str]) -> bool:
    return any(cell.strip() for cell in cells) and not cells[0].lstrip().startswith("#")


def _header(where: str, cells: list[str], columns: dict[str, Column]) -> list[tuple[str, float]]:
    header: list[tuple[str, float]] = []
    for cell in cells:
        try:
            header.append(parsed_header(cell.lstrip("\ufeff"), columns))
        except ValueError as error:
            raise InputError(f"{where}: {error}") from error
    names = [name for name, _ in header]
    for name in columns:
        if names.count(name) > 1:
            raise InputError(f"{where}: column {name!r} occurs twice")
        if columns[name].is_needed and name not in names:
            raise InputError(f"{where}: column {name!r} is missing; the header has {', '.join(names)}")
    return header


def _row(where: str, cells: list[str], header: list[tuple[str, float]], columns: dict[str, Column]) -> _Row:
    if len(cells) > len(header) and any(cell.strip() for cell in cells[len(header) :]):
        raise InputError(f"{where}: {len(cells)} cells, but the header has {len(header)} columns")
    texts: dict[str, str] = {}
    values: dict[str, Any] = {}
    for (name, scale), cell in zip(header, cells, strict=False):
        unit, text = columns[name].unit, cell.strip()
        if unit is None:
            texts[name] = text
        elif text.lower() not in _UNKNOWN:
            try:
                values[name] = _curve(text, scale) if unit.startswith("rad/s:") else _number(text) * scale
            except ValueError as error:
                raise InputError(f"{where}, column {name!r}: {text!r} is not {_expected(unit)}") from error
    return _Row({**dict.fromkeys((n for n, c in columns.items() if c.unit is None), ""), **texts}, values, where)


def _expected(unit: str) -> str:
    return "a curve such as '0:0.5; 300:0.4'" if unit.startswith("rad/s:") else "a number"


def _number(text: str) -> float:
    return float(text.replace("_", "?"))  # Python reads 1_000


def _curve(text: str, scale: float) -> list[list[float]]:
    points = [[_number(number) for number in pair.split(":")] for pair in text.split(";") if pair.strip()]
    return [[speed * scale, torque] for speed, torque in points]
