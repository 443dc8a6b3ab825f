"""What the columns of a catalogue mean: their units, and the value of a part that each one is."""

from __future__ import annotations

import re
from math import pi
from typing import Final, NamedTuple

from puma_septic.drives._parts import GEARBOX_UNITS, MOTOR_UNITS

__all__ = ["GEARBOX", "GEARBOX_FIELDS", "MOTOR", "MOTOR_FIELDS", "PAIR", "Column", "parsed_header"]

# Unit in SI, then those understood and how many SI units each is; spaces, points and stars inside do not count.
_UNITS: Final[dict[str, dict[str, float]]] = {
    "": {"": 1.0, "%": 0.01},
    "kg": {"kg": 1.0, "g": 1e-3},
    "kg m^2": {"kgm^2": 1.0, "kgcm^2": 1e-4, "gcm^2": 1e-7},
    "N m": {"Nm": 1.0, "mNm": 1e-3},
    "N m/A": {"Nm/A": 1.0, "mNm/A": 1e-3},
    "N m s/rad": {"Nms/rad": 1.0, "Nms": 1.0, "mNms": 1e-3},
    "N m/rad": {"Nm/rad": 1.0},
    "rad/s": {"rad/s": 1.0, "rpm": 2 * pi / 60, "1/min": 2 * pi / 60},
    "A": {"A": 1.0, "mA": 1e-3},
    "V": {"V": 1.0},
    "ohm": {"ohm": 1.0, "mohm": 1e-3},
    "H": {"H": 1.0, "mH": 1e-3},
    "W": {"W": 1.0, "kW": 1e3},
    "K/W": {"K/W": 1.0},
    "s": {"s": 1.0, "min": 60.0},
    "h": {"h": 1.0},
    "degC": {"degC": 1.0},
    "rad/s:N m": {"rad/s:Nm": 1.0, "rpm:Nm": 2 * pi / 60},  # of the speeds
}
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
    "I_peak": Column("A"), "pole_pairs": Column(""), "max_inertia_ratio": Column(""), "cost": Column(""),
    "source": Column(),
}  # fmt: skip
_GEARBOX: Final[dict[str, Column]] = {
    "key": Column(None, True), "manufacturer": Column(), "ID": Column(), "type": Column(), "stages": Column(""),
    "ratio": Column("", True), "mass": Column("kg", True), "inertia": Column("kg m^2", True),
    "efficiency": Column("", True), "direction": Column(""), "max_int_torque": Column("N m"),
    "max_cont_torque": Column("N m"),
    "T_N": Column("N m"), "n_N": Column("rad/s"), "T_A": Column("N m"), "T_R": Column("N m"), "T_M": Column("N m"),
    "n_in_av": Column("rad/s"), "n_in_max": Column("rad/s"), "L_n": Column("h"), "stiffness": Column("N m/rad"),
    "no_load_torque": Column("N m"), "backdrive_efficiency": Column(""), "cost": Column(""), "source": Column(),
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
    "max_cont_torque": "continuous_torque",
}  # fmt: skip
_GEARBOX_FIELDS: Final = {
    "ratio": "ratio", "mass": "mass", "inertia": "inertia", "efficiency": "efficiency", "cost": "cost",
    "backdrive_efficiency": "backward_efficiency", "no_load_torque": "no_load_torque", "T_N": "rated_torque",
    "n_N": "rated_speed", "L_n": "rated_life_hours", "max_cont_torque": "max_average_torque",
    "max_int_torque": "max_repeated_torque", "T_A": "max_average_torque", "T_R": "max_repeated_torque",
    "T_M": "max_momentary_torque", "n_in_av": "max_average_input_speed", "n_in_max": "max_input_speed",
}  # fmt: skip
MOTOR_FIELDS: Final = _MOTOR_FIELDS | {name: name for name in MOTOR_UNITS if name not in _MOTOR_FIELDS.values()}
GEARBOX_FIELDS: Final = _GEARBOX_FIELDS | {name: name for name in GEARBOX_UNITS if name not in _GEARBOX_FIELDS.values()}
MOTOR: Final = _MOTOR | {name: Column(MOTOR_UNITS[name]) for name in MOTOR_FIELDS if name not in _MOTOR_FIELDS}
GEARBOX: Final = _GEARBOX | {
    name: Column(GEARBOX_UNITS[name]) for name in GEARBOX_FIELDS if name not in _GEARBOX_FIELDS
}


def parsed_header(text: str, columns: dict[str, Column]) -> tuple[str, float]:
    """Name and size of the unit of a header cell such as ``inertia[kg cm^2]``; without brackets the unit is SI.

    Raises
    ------
    ValueError
        For a name or unit that is not known, with the valid ones.
    """
    match = _HEADER.match(text)
    name = match[1] if match else text
    if match is None or name not in columns:
        raise ValueError(f"unknown column {text!r}; valid: {', '.join(columns)}")
    unit, given = columns[name].unit, match[2]
    if given is None:
        return name, 1.0
    plain = re.sub(r"[ .*·]", "", given).replace("²", "^2").replace("m2", "m^2").replace("Ω", "ohm").replace("°", "deg")
    if unit is None or plain not in _UNITS[unit]:
        valid = "none, it is text" if unit is None else ", ".join(known or "none" for known in _UNITS[unit])
        raise ValueError(f"column {name!r}: unknown unit {given!r}; valid: {valid}")
    return name, _UNITS[unit][plain]
