"""What the columns of a catalogue mean: their units, and the value of a part that each one is."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple

from puma_septic.drives._gearbox import GEARBOX_UNITS
from puma_septic.drives._motor import MOTOR_UNITS

__all__ = [
    "CURRENCY",
    "CURVES_AT",
    "GEARBOX",
    "GEARBOX_FIELDS",
    "GEARBOX_TEXTS",
    "GEAR_KINDS",
    "MOTOR",
    "MOTOR_FIELDS",
    "MOTOR_TEXTS",
    "PAIR",
    "Column",
    "header_parts",
    "voltage_of",
    "with_voltages",
]

CURRENCY: Final = "a currency"
"""The unit of costs: any, which is not converted."""
_HEADER: Final = re.compile(r"^\s*([^\[\]]+?)\s*(?:\[([^\[\]]*)\])?\s*$")


class Column(NamedTuple):
    """A column's SI unit (None: text) and whether a file must have it."""

    unit: str | None = None
    is_needed: bool = False


# The first lines are those of the MGDB, a public database of motors and gearboxes, as its README gives them; the rest
# are additions. A column that no check uses is accepted all the same.
_MOTOR: Final[dict[str, Column]] = {
    "key": Column(None, True), "manufacturer": Column(), "ID": Column(), "type": Column(), "V": Column("V"),
    "k_t": Column("N m/A"), "R": Column("ohm"), "L": Column("H"), "mass": Column("kg", True),
    "inertia": Column("kg m^2", True), "omega_nl": Column("rad/s"), "I_nl": Column("A"), "I_nom": Column("A"),
    "max_int_torque": Column("N m", True), "max_int_speed": Column("rad/s"), "max_cont_speed": Column("rad/s"),
    "max_cont_power": Column("W"), "coulomb_friction": Column("N m"), "viscous_friction": Column("N m s/rad"),
    "Rth1": Column("K/W"), "Rth2": Column("K/W"),
    "max_cont_torque": Column("N m"), "max_int_power": Column("W"), "S1": Column("rad/s:N m"),
    "peak": Column("rad/s:N m"), "tau_w": Column("s"), "tau_h": Column("s"), "T_max": Column("degC"),
    "I_peak": Column("A"), "pole_pairs": Column(""), "current": Column(), "winding": Column(), "voltage": Column(),
    "max_inertia_ratio": Column(""), "cost": Column(CURRENCY), "rated_ambient_celsius": Column("degC"),
    "reference_celsius": Column("degC"), "copper_coefficient": Column("1/K"), "geared_share": Column(""),
    "altitude_curve": Column("m:"), "source": Column(),
}  # fmt: skip
_GEARBOX: Final[dict[str, Column]] = {
    "key": Column(None, True), "manufacturer": Column(), "ID": Column(), "type": Column(), "stages": Column(""),
    "ratio": Column("", True), "mass": Column("kg", True), "inertia": Column("kg m^2", True),
    "efficiency": Column("", True), "direction": Column(""), "max_int_torque": Column("N m"),
    "max_cont_torque": Column("N m"),
    "T_N": Column("N m"), "n_N": Column("rad/s"), "T_A": Column("N m"), "T_R": Column("N m"), "T_M": Column("N m"),
    "n_in_av": Column("rad/s"), "n_in_max": Column("rad/s"), "L_n": Column("h"), "stiffness": Column("N m/rad"),
    "life_basis": Column(), "K1": Column("N m/rad"), "K2": Column("N m/rad"), "K3": Column("N m/rad"),
    "T1": Column("N m"), "T2": Column("N m"), "no_load_torque": Column("N m"), "backdrive_efficiency": Column(""),
    "cost": Column(CURRENCY), "impact_curve": Column("1/h:"), "efficiency_map": Column("rad/s:N m:"),
    "bearing_offset": Column("m"), "source": Column(),
}  # fmt: skip
# Texts that are values of a part, by the same name.
MOTOR_TEXTS: Final = ("current", "winding", "voltage")
GEARBOX_TEXTS: Final = ("life_basis",)
# What catalogues call the types of gear whose makers have a rule of their own; any other type is text alone.
GEAR_KINDS: Final = {
    "strain wave": "strain wave", "harmonic": "strain wave", "harmonic drive": "strain wave",
    "cycloidal": "cycloidal", "rv": "cycloidal", "planetary": "planetary",
}  # fmt: skip
PAIR: Final[dict[str, Column]] = {
    "motor": Column(None, True), "gearbox": Column(None, True), "viscous_friction": Column("N m s/rad"),
    "coulomb_positive": Column("N m"), "coulomb_negative": Column("N m"), "max_effort": Column("N m"),
    "static_positive": Column("N m"), "static_negative": Column("N m"), "stribeck_velocity": Column("rad/s"),
    "load_share": Column(""), "source": Column(),
}  # fmt: skip
# The values of a part that the columns are, and those that no column of the database is, which have their own name.
_MOTOR_FIELDS: Final = {
    "inertia": "rotor_inertia", "k_t": "torque_constant", "R": "resistance", "mass": "mass", "cost": "cost",
    "coulomb_friction": "coulomb_friction", "viscous_friction": "viscous_friction", "max_int_torque": "peak_torque",
    "max_int_speed": "max_speed", "max_int_power": "peak_power", "T_max": "max_winding_celsius",
    "max_inertia_ratio": "max_inertia_ratio", "peak": "peak_curve", "S1": "continuous_curve",
    "max_cont_torque": "continuous_torque", "L": "inductance", "pole_pairs": "pole_pairs",
    "rated_ambient_celsius": "rated_ambient_celsius", "reference_celsius": "reference_celsius",
    "copper_coefficient": "copper_coefficient", "geared_share": "geared_share", "altitude_curve": "altitude_curve",
}  # fmt: skip
_GEARBOX_FIELDS: Final = {
    "ratio": "ratio", "mass": "mass", "inertia": "inertia", "efficiency": "efficiency", "cost": "cost",
    "backdrive_efficiency": "backward_efficiency", "no_load_torque": "no_load_torque", "T_N": "rated_torque",
    "n_N": "rated_speed", "L_n": "rated_life_hours", "max_cont_torque": "max_average_torque",
    "max_int_torque": "max_repeated_torque", "T_A": "max_average_torque", "T_R": "max_repeated_torque",
    "T_M": "max_momentary_torque", "n_in_av": "max_average_input_speed", "n_in_max": "max_input_speed",
    "impact_curve": "impact_curve", "efficiency_map": "efficiency_map", "bearing_offset": "bearing_offset",
}  # fmt: skip
MOTOR_FIELDS: Final = _MOTOR_FIELDS | {name: name for name in MOTOR_UNITS if name not in _MOTOR_FIELDS.values()}
GEARBOX_FIELDS: Final = _GEARBOX_FIELDS | {name: name for name in GEARBOX_UNITS if name not in _GEARBOX_FIELDS.values()}
MOTOR: Final = _MOTOR | {name: Column(MOTOR_UNITS[name]) for name in MOTOR_FIELDS if name not in _MOTOR_FIELDS}
GEARBOX: Final = _GEARBOX | {
    name: Column(GEARBOX_UNITS[name]) for name in GEARBOX_FIELDS if name not in _GEARBOX_FIELDS
}


def header_parts(text: str) -> tuple[str, str | None]:
    """Name and printed unit of a header cell such as ``inertia[kg cm^2]``; without brackets there is no unit.

    Returns
    -------
    str, str or None
    """
    match = _HEADER.match(text)
    return (text.strip(), None) if match is None else (match[1], match[2])


CURVES_AT: Final = {"peak": "peak_curves", "S1": "continuous_curves"}
"""Columns of curves, which may be there once for each of several bus voltages as well, "peak@48 V"."""
_AT_VOLTAGE: Final = re.compile(r"^(peak|S1) ?@ ?(\d+(?:\.\d+)?) ?V(?: ?DC)?$")


def voltage_of(name: str) -> tuple[str, float] | None:
    """The column that a column of one bus voltage belongs to, and the voltage, V; None for any other.

    Returns
    -------
    (str, float) or None

    Examples
    --------
    >>> voltage_of("S1@48 V"), voltage_of("S1")
    (('S1', 48.0), None)
    """
    match = _AT_VOLTAGE.match(name)
    return None if match is None else (match[1], float(match[2]))


def with_voltages(columns: Mapping[str, Column], names: Iterable[str]) -> dict[str, Column]:
    """The columns, and those of bus voltages among the names.

    Returns
    -------
    dict of str to Column
    """
    found = {name: at for name in names if (at := voltage_of(name)) is not None and at[0] in columns}
    return {**columns, **{name: columns[kind] for name, (kind, _) in found.items()}}
