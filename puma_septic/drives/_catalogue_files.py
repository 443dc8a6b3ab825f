"""Catalogues from CSV files; every complaint names file, row and column."""

from __future__ import annotations

import fnmatch
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from puma_septic.drives._catalogue import Catalogue, Pair
from puma_septic.drives._columns import (
    CURVES_AT,
    GEAR_KINDS,
    GEARBOX,
    GEARBOX_FIELDS,
    GEARBOX_TEXTS,
    MOTOR,
    MOTOR_FIELDS,
    MOTOR_TEXTS,
    PAIR,
    Column,
    voltage_of,
)
from puma_septic.drives._drive import Drive
from puma_septic.drives._gearbox import Gearbox
from puma_septic.drives._motor import Motor
from puma_septic.drives._table_file import Row, raw_rows, read_table
from puma_septic.drives._units import current_measure
from puma_septic.errors import InputError
from puma_septic.files import checked_path
from puma_septic.friction import Friction
from puma_septic.validation import checked_choice

__all__ = ["BUILT_IN", "built_in_catalogue", "load_catalogue"]

BUILT_IN: Final = ("example", "puma560")
# Numbers that no check uses yet.
_UNUSED: Final = ("omega_nl", "max_cont_power", "stages")
# Thermal resistance and time constant of each node, from the winding outwards.
_NODES: Final = (("Rth1", "tau_w"), ("Rth2", "tau_h"))
_FRICTION_FIELDS: Final = {
    "coulomb_positive": "coulomb", "coulomb_negative": "coulomb", "viscous_friction": "viscous",
    "stribeck_velocity": "stribeck_velocity", "load_share": "load_share", "static_positive": "static",
    "static_negative": "static",
}  # fmt: skip


def load_catalogue(motors: str | Path, gearboxes: str | Path, pairs: str | Path | None = None) -> Catalogue:
    """Read a catalogue from CSV files.

    A header is a column's name, with its unit in brackets where that is not SI: ``inertia[kg cm^2]``; a cell may have
    one of its own: ``0.5 kg cm^2``. Any unit that data sheets print is understood. Cells are separated by commas, or by
    semicolons or tabs, and then numbers may have decimal commas. Lines that begin with # are remarks. An empty cell (or
    nan, inf, -, N/A) is a value that is not known. Curves are written as ``speed:torque`` pairs with semicolons or
    bars between them: ``0:0.5; 300:0.4``. A row that cannot be read is left out and listed in `Catalogue.refused`; what
    stands in an unknown column is kept in `Catalogue.other`, and the column listed in `Catalogue.unused`.

    Parameters
    ----------
    motors : str or Path
        Columns key, mass, inertia, max_int_torque and any of the others of the MGDB and these: max_cont_torque (else
        ``k_t I_nom``), S1, peak, max_int_power, tau_w, tau_h, T_max, I_peak (of the motor; ``k_t I_peak`` is the peak
        torque where none is given), I_nl (``k_t I_nl`` is the Coulomb friction where none is given),
        max_inertia_ratio, cost. V is the bus voltage where the joint has no drive. S1 and peak may be there
        once for each of several bus voltages: "peak@48 V". current, winding and voltage are the
        measures of k_t and currents, of R and L, and of voltage_constant, see `Motor`; without them those of a motor
        with direct current. ``k_t[Nm/A_rms]`` tells the first by its unit. Any other number of `Motor` by its name.
        Rth1 with tau_w is a winding in one node; with Rth2 and tau_h as well, in two; without all time constants the
        resistances tell the mean temperature at least.
    gearboxes : str or Path
        Columns key, ratio, mass, inertia (at the input), efficiency and any of the others of the MGDB and these: T_N,
        n_N, L_n, T_A (else max_cont_torque), T_R (else max_int_torque), T_M, n_in_av, n_in_max, no_load_torque,
        backdrive_efficiency, life_basis, K1, K2, K3 with T1, T2 (else stiffness), cost, and any other number of
        `Gearbox` by its name; curves and maps are written as other curves, ``speed:torque:efficiency``. The type
        "strain wave", "cycloidal" or "planetary" tells whose rules hold. Speeds are the input's.
    pairs : str or Path, optional
        Columns motor and gearbox (their keys), and what is measured of both together: viscous_friction,
        coulomb_positive, coulomb_negative and the optional terms of `Friction`, static_positive, static_negative,
        stribeck_velocity, load_share (at the motor, through the gears), max_effort (at the joint). Or, as the MGDB has
        it, without a header: a motor and the gearboxes that fit it, in which * stands for any letters. Without the
        file every motor fits every gearbox.

    Returns
    -------
    Catalogue

    Raises
    ------
    InputError
        With file, row and column: a missing column, an unknown unit of a column, or a file of which no row can be read.
    """
    files = [checked_path(one, "catalogue") for one in (motors, gearboxes, *([] if pairs is None else [pairs]))]
    found, cogs = _parts(files[0], MOTOR, _motor), _parts(files[1], GEARBOX, _gearbox)
    fitting, refused = (None, ()) if pairs is None else _pairs(files[2], found.parts, cogs.parts)
    both = (("motors", found), ("gearboxes", cogs))
    try:
        return Catalogue(
            motors=tuple(motor for motor, _ in found.parts.values()),
            gearboxes=tuple(gearbox for gearbox, _ in cogs.parts.values()),
            pairs=fitting,
            drives=tuple(Drive(bus_voltage=row.values.get("V", np.nan)) for _, row in found.parts.values()),
            unused=tuple(f"column {name} of the {kind}" for kind, read in both for name in read.unused),
            refused=(*found.refused, *cogs.refused, *refused),
            other={key: row.other for _, read in both for key, (_, row) in read.parts.items() if row.other},
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


class _Read(NamedTuple):
    """Parts by key with the rows that they come from, rows that were refused, and columns that no check uses."""

    parts: dict[str, tuple[Any, Row]]
    refused: tuple[str, ...]
    unused: tuple[str, ...]


def _parts(path: Path, columns: dict[str, Column], make: Callable[[Row, str], Any]) -> _Read:
    table = read_table(path, columns)
    parts: dict[str, tuple[Any, Row]] = {}
    refused = list(table.refused)
    for row in table.rows:
        try:
            parts[_new_key(row, parts)] = make(row, _source(row, path)), row
        except InputError as error:
            refused.append(str(error))
    if not parts:
        raise InputError(refused[0] if refused else f"{path}: no rows below the header")
    idle = [name for name in _UNUSED if any(name in row.values for _, row in parts.values())]
    return _Read(parts, tuple(refused), (*idle, *table.unknown))


def _new_key(row: Row, parts: Mapping[str, tuple[Any, Row]]) -> str:
    key = row.texts["key"]
    if not key:
        raise InputError(f"{row.where}, column 'key': the cell is empty")
    if key in parts:
        raise InputError(f"{row.where}, column 'key': {key!r} occurs twice, first in {parts[key][1].where}")
    return key


def _source(row: Row, path: Path) -> str:
    named = " ".join(filter(None, (row.texts.get("manufacturer"), row.texts.get("ID"))))
    return "; ".join(filter(None, (named, row.texts.get("source"), path.name)))


def _motor(row: Row, source: str) -> Motor:
    values, fields = row.values, _fields(row, MOTOR_FIELDS) | _texts(row, MOTOR_TEXTS) | _measured(row)
    k_t, current = values.get("k_t", np.nan), values.get("I_nom", np.nan)
    if "coulomb_friction" not in fields and "I_nl" in values:
        fields["coulomb_friction"] = k_t * values["I_nl"]
    if "peak_torque" not in fields and not np.isnan(k_t) and "I_peak" in values:
        fields["peak_torque"] = k_t * values["I_peak"]
    fields |= _curves_of_voltages(row)
    has_curve = not fields.keys().isdisjoint(("continuous_curve", "continuous_curves"))
    if has_curve and "continuous_torque" in fields:
        raise InputError(f"{row.where}, column 'S1': the row has max_cont_torque as well; give one of them")
    if not has_curve:
        torque = fields.pop("continuous_torque", k_t * current)
        if not np.isnan(torque) and "max_cont_speed" in values:
            fields["continuous_curve"] = [[0.0, torque], [values["max_cont_speed"], torque]]
        else:
            fields["continuous_torque"] = torque
    nodes = [(resistance, time) for resistance, time in _NODES if resistance in values]
    fields["thermal_resistances"] = [values[name] for name, _ in nodes]
    if all(time in values for _, time in nodes) and (not nodes or nodes[0] == _NODES[0]):
        fields["thermal_time_constants"] = [values[name] for _, name in nodes]
    motor: Motor = _made(Motor, {"name": row.texts["key"], "source": source}, fields, row, MOTOR_FIELDS)
    return motor


def _curves_of_voltages(row: Row) -> dict[str, list[tuple[float, Any]]]:
    """The curves of columns such as "peak@48 V"."""
    found: dict[str, list[tuple[float, Any]]] = {}
    for name, values in row.values.items():
        if (at := voltage_of(name)) is not None:
            found.setdefault(CURVES_AT[at[0]], []).append((at[1], values))
    return found


def _gearbox(row: Row, source: str) -> Gearbox:
    fields = _fields(row, GEARBOX_FIELDS) | _texts(row, GEARBOX_TEXTS)
    if "ratio" not in fields:
        raise InputError(f"{row.where}, column 'ratio': the cell is empty; the ratio is required")
    if (direction := row.values.get("direction", 1.0)) not in (1.0, -1.0):
        raise InputError(f"{row.where}, column 'direction': {direction:g} is neither 1 nor -1")
    fields["ratio"] *= direction
    fields["kind"] = GEAR_KINDS.get(row.texts["type"].lower(), "")
    if stiffness := [row.values[name] for name in ("K1", "K2", "K3") if name in row.values]:
        fields["stiffness"] = stiffness
        fields["stiffness_torques"] = [row.values[name] for name in ("T1", "T2") if name in row.values]
    elif "stiffness" in row.values:
        fields["stiffness"] = [row.values["stiffness"]]
    needed = {"name": row.texts["key"], "source": source, "ratio": 1.0}
    gearbox: Gearbox = _made(Gearbox, needed, fields, row, GEARBOX_FIELDS)
    return gearbox


def _fields(row: Row, names: Mapping[str, str]) -> dict[str, Any]:
    """The known values by field; of two columns for one field the later one in `names` counts."""
    return {field: row.values[column] for column, field in names.items() if column in row.values}


def _texts(row: Row, names: tuple[str, ...]) -> dict[str, str]:
    """The texts by field that are not empty."""
    return {name: row.texts[name] for name in names if row.texts[name]}


def _measured(row: Row) -> dict[str, str]:
    """The measure of a motor's currents, where the unit of k_t has it."""
    measure, told = current_measure(row.units.get("k_t", "")), row.texts["current"]
    if measure and told and told != measure:
        raise InputError(f"{row.where}, column 'current': {told!r}, but k_t is in {row.units['k_t']!r}")
    return {"current": measure} if measure else {}


def _made(kind: Any, needed: dict[str, Any], fields: dict[str, Any], row: Row, names: Mapping[str, str]) -> Any:
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


def _pairs(
    path: Path, motors: Mapping[str, Any], gearboxes: Mapping[str, Any]
) -> tuple[tuple[Pair, ...], tuple[str, ...]]:
    """The pairs, and the rows that were refused."""
    lines, _ = raw_rows(path)
    if lines and lines[0][1][0].strip() in motors:
        return _compatible(path, lines, motors, gearboxes)
    table = read_table(path, PAIR)
    pairs, refused = [], list(table.refused)
    for row in table.rows:
        try:
            pairs.append(_pair(row, motors, gearboxes))
        except InputError as error:
            refused.append(str(error))
    if refused and not pairs:
        raise InputError(refused[0])
    return tuple(pairs), tuple(refused)


def _compatible(
    path: Path, lines: list[tuple[int, list[str]]], motors: Mapping[str, Any], gearboxes: Mapping[str, Any]
) -> tuple[tuple[Pair, ...], tuple[str, ...]]:
    """A file of the MGDB: each line a motor and the gearboxes that fit it, * for any letters."""
    pairs: dict[tuple[str, str], None] = {}
    refused = []
    for number, cells in lines:
        motor, *fitting = (cell.strip() for cell in cells if cell.strip())
        if motor not in motors:
            refused.append(f"{path}, row {number}: no motor has the key {motor!r}")
            continue
        for key in fitting:
            found = fnmatch.filter(gearboxes, key) if "*" in key else [key] if key in gearboxes else []
            if not found:
                refused.append(f"{path}, row {number}: no gearbox has the key {key!r}")
            pairs |= dict.fromkeys((motor, gearbox) for gearbox in found)
    if not pairs:
        raise InputError(refused[0])
    return tuple(Pair(motor=motor, gearbox=gearbox) for motor, gearbox in pairs), tuple(refused)


def _pair(row: Row, motors: Mapping[str, Any], gearboxes: Mapping[str, Any]) -> Pair:
    for column, keys in (("motor", motors), ("gearbox", gearboxes)):
        if row.texts[column] not in keys:
            raise InputError(f"{row.where}, column {column!r}: no {column} has the key {row.texts[column]!r}")
    values = row.values
    friction = None
    if _FRICTION_FIELDS.keys() & values.keys():
        given: dict[str, Any] = {field: values.get(column, np.nan) for column, field in _FRICTION_FIELDS.items()}
        for level in ("coulomb", "static"):
            given[level] = [values.get(f"{level}_{side}", np.nan) for side in ("positive", "negative")]
        friction = _made(Friction, {"coulomb": given["coulomb"]}, given, row, _FRICTION_FIELDS)
    effort = values.get("max_effort", np.nan)
    if effort <= 0:
        raise InputError(f"{row.where}, column 'max_effort': {effort:g} N m must be greater than 0 N m")
    return Pair(motor=row.texts["motor"], gearbox=row.texts["gearbox"], friction=friction, max_effort=effort)
