"""The parts of a drive train as a data sheet has them; NaN (for curves: no rows) means unknown."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, final

import numpy as np

from puma_septic.errors import InputError
from puma_septic.validation import Array, checked_array, checked_number

__all__ = ["ABSOLUTE_ZERO_CELSIUS", "GEARBOX_UNITS", "MOTOR_UNITS", "Drive", "Gearbox", "Motor"]

ABSOLUTE_ZERO_CELSIUS: Final = -273.15  # by the definition of the scale
# Resistivity of copper, per K at 20 degrees Celsius: the customary value; some data sheets print 0.0039.
_COPPER_COEFFICIENT: Final = 0.00393
_COPPER_REFERENCE_CELSIUS: Final = 20.0

_POSITIVE: Final = {"above": 0.0}
_NOT_NEGATIVE: Final = {"at_least": 0.0}
_SHARE: Final = {"above": 0.0, "at_most": 1.0}
_BACKWARD_SHARE: Final = {"at_least": 0.0, "at_most": 1.0}
# Values of the parts, with their units.
_MOTOR_POSITIVE: Final = {
    "torque_constant": "N m/A", "peak_torque": "N m", "continuous_torque": "N m", "max_speed": "rad/s",
    "peak_power": "W", "max_inertia_ratio": "",
}  # fmt: skip
_MOTOR_NOT_NEGATIVE: Final = {
    "rotor_inertia": "kg m^2", "viscous_friction": "N m s/rad", "coulomb_friction": "N m", "resistance": "ohm",
    "mass": "kg", "cost": "",
}  # fmt: skip
_GEARBOX_POSITIVE: Final = {
    "rated_torque": "N m", "rated_speed": "rad/s", "rated_life_hours": "h", "max_average_torque": "N m",
    "max_repeated_torque": "N m", "max_momentary_torque": "N m", "max_average_input_speed": "rad/s",
    "max_input_speed": "rad/s",
}  # fmt: skip
_GEARBOX_NOT_NEGATIVE: Final = {"inertia": "kg m^2", "no_load_torque": "N m", "mass": "kg", "cost": ""}
MOTOR_UNITS: Final = _MOTOR_POSITIVE | _MOTOR_NOT_NEGATIVE
GEARBOX_UNITS: Final = _GEARBOX_POSITIVE | _GEARBOX_NOT_NEGATIVE


def _check(part: object, units: Mapping[str, str], bounds: Mapping[str, float]) -> None:
    """Hold every field named in `units` to the bounds, unless it is unknown, and store it as a float."""
    for name, unit in units.items():
        value = getattr(part, name)
        if not (isinstance(value, (float, np.floating)) and np.isnan(value)):
            object.__setattr__(part, name, checked_number(name, value, unit=unit, **bounds))


def _check_texts(part: object) -> None:
    for name in ("name", "source"):
        value = getattr(part, name)
        if not isinstance(value, str):
            raise InputError(f"{name}: expected text, got {reprlib.repr(value)}")


def _check_curve(part: object, name: str) -> None:
    """Store a curve as an array of (speed, torque) rows: speeds from 0 upwards, torques not negative."""
    given = getattr(part, name)
    is_empty = isinstance(given, Sequence) and not given
    curve = checked_array(name, np.empty((0, 2)) if is_empty else given, (None, 2))
    if len(curve):
        if len(curve) == 1:
            raise InputError(f"{name}: a curve needs at least two (speed, torque) rows, got {curve.tolist()}")
        if curve[0, 0] != 0:
            raise InputError(f"{name}: the first speed is {curve[0, 0]:g} rad/s; a curve must start at 0 rad/s")
        if not (np.diff(curve[:, 0]) > 0).all():
            raise InputError(f"{name}: speeds {curve[:, 0].tolist()} rad/s must increase strictly")
        if not ((curve[:, 1] >= 0).all() and curve[0, 1] > 0):
            raise InputError(f"{name}: torques {curve[:, 1].tolist()} N m must be >= 0, the first one > 0")
    object.__setattr__(part, name, curve)


def _no_curve() -> Array:
    return np.empty((0, 2))


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Motor:
    """A motor, all values at its shaft.

    Torque constant and resistance are those of the equivalent direct-current motor, ``torque = torque_constant
    current``, ``voltage = resistance current + torque_constant speed`` and ``loss = resistance current^2``, with the
    current in the same measure (peak or effective) as the drive's limits.

    Parameters
    ----------
    name : str
    rotor_inertia : float
        kg m^2.
    viscous_friction, coulomb_friction : float
        The motor's own, without gears: N m s/rad and N m.
    torque_constant : float
        N m/A.
    resistance : float
        Ohm at `reference_celsius`.
    peak_torque : float
        N m, for a short time.
    peak_curve : array_like, shape (k, 2)
        Torque that motor and drive can give for a short time over the speed: rows (rad/s, N m) from speed 0, straight
        between them; beyond the last speed there is none. It holds in all four quadrants.
    continuous_torque : float
        N m at any speed (duty S1).
    continuous_curve : array_like, shape (k, 2)
        The same over the speed (S1 curve), instead of `continuous_torque`; rows as in `peak_curve`.
    max_speed : float
        rad/s.
    peak_power : float
        Mechanical, at the shaft, W.
    max_winding_celsius : float
        Highest temperature that the winding may have, degrees Celsius.
    thermal_resistances, thermal_time_constants : array_like, shape (1,) or (2,)
        K/W and s, from the winding outwards: one node (winding to ambient) or two (winding to housing, housing to
        ambient). The heat capacity of node i is ``thermal_time_constants[i] / thermal_resistances[i]``. Empty: unknown.
    copper_coefficient : float
        Relative growth of the resistance per K, referred to `reference_celsius`; 0 for a constant resistance.
    reference_celsius : float
        Temperature at which `resistance` holds, degrees Celsius.
    max_inertia_ratio : float
        Largest ratio of load inertia to motor inertia that its maker recommends. A rule of thumb, not physics.
    mass, cost : float
        kg, and any currency.
    source : str
        Where the numbers come from.

    Raises
    ------
    InputError
        For a value that no motor has, with its name, unit and bound.

    Examples
    --------
    >>> motor = Motor(rotor_inertia=2e-4, peak_torque=0.9, continuous_curve=[[0, 0.5], [300, 0.4]])
    >>> motor.continuous_torque_at(150.0)
    0.45
    """

    name: str = ""
    rotor_inertia: float = np.nan
    viscous_friction: float = np.nan
    coulomb_friction: float = np.nan
    torque_constant: float = np.nan
    resistance: float = np.nan
    peak_torque: float = np.nan
    peak_curve: Array = field(default_factory=_no_curve)
    continuous_torque: float = np.nan
    continuous_curve: Array = field(default_factory=_no_curve)
    max_speed: float = np.nan
    peak_power: float = np.nan
    max_winding_celsius: float = np.nan
    thermal_resistances: Array = field(default_factory=lambda: np.empty(0))
    thermal_time_constants: Array = field(default_factory=lambda: np.empty(0))
    copper_coefficient: float = _COPPER_COEFFICIENT
    reference_celsius: float = _COPPER_REFERENCE_CELSIUS
    max_inertia_ratio: float = np.nan
    mass: float = np.nan
    cost: float = np.nan
    source: str = ""

    def __post_init__(self) -> None:
        _check_texts(self)
        _check(self, _MOTOR_POSITIVE, _POSITIVE)
        _check(self, _MOTOR_NOT_NEGATIVE, _NOT_NEGATIVE)
        _check(self, {"max_winding_celsius": "degrees Celsius"}, {"above": ABSOLUTE_ZERO_CELSIUS})
        checked_number("copper_coefficient", self.copper_coefficient, unit="1/K", at_least=0.0)
        checked_number("reference_celsius", self.reference_celsius, unit="degrees Celsius", above=ABSOLUTE_ZERO_CELSIUS)
        for name in ("peak_curve", "continuous_curve"):
            _check_curve(self, name)
        if len(self.continuous_curve) and not np.isnan(self.continuous_torque):
            raise InputError("give continuous_torque (any speed) or continuous_curve, not both")
        self._check_thermal()

    def _check_thermal(self) -> None:
        for name, unit in (("thermal_resistances", "K/W"), ("thermal_time_constants", "s")):
            values = checked_array(name, getattr(self, name), (None,), unit=unit)
            if len(values) > 2 or not (values > 0).all():
                raise InputError(f"{name} = {values.tolist()} {unit}: expected one or two positive numbers")
            object.__setattr__(self, name, values)
        if len(self.thermal_resistances) != len(self.thermal_time_constants):
            raise InputError(
                f"{len(self.thermal_resistances)} thermal_resistances and {len(self.thermal_time_constants)}"
                " thermal_time_constants: expected one of each per node"
            )

    def continuous_torque_at(self, speed: float) -> float:
        """Continuous torque at a speed in rad/s: 0 beyond the end of the S1 curve, NaN where unknown."""
        if len(self.continuous_curve):
            return float(np.interp(abs(speed), self.continuous_curve[:, 0], self.continuous_curve[:, 1], right=0.0))
        return self.continuous_torque


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Gearbox:
    """A gearbox; torques at its output, speeds and inertia at its input.

    Parameters
    ----------
    ratio : float
        Motor turns per joint turn (rad/m for a prismatic joint), negative where the motor turns the other way; 1 for a
        direct drive; NaN: unknown. Motor quantities are counted in the joint's direction, so only its magnitude enters
        them.
    name : str
    efficiency : float
        Output power over input power where the motor drives, above 0 and up to 1.
    backward_efficiency : float
        Input power over output power where the load drives, 0 (self-locking) to 1; as `efficiency` where unknown.
    inertia : float
        At the input, kg m^2.
    no_load_torque : float
        At the input, N m, against the motion at any speed.
    rated_torque, rated_speed, rated_life_hours : float
        Torque (N m) and input speed (rad/s) at which the life (h) is stated.
    max_average_torque : float
        Limit of the average torque, N m.
    max_repeated_torque, max_momentary_torque : float
        Limits of the peaks of each cycle and of rare ones (collision, emergency stop), N m.
    max_average_input_speed, max_input_speed : float
        rad/s.
    mass, cost : float
        kg, and any currency.
    source : str
        Where the numbers come from.
    """

    ratio: float = np.nan
    name: str = ""
    efficiency: float = np.nan
    backward_efficiency: float = np.nan
    inertia: float = np.nan
    no_load_torque: float = np.nan
    rated_torque: float = np.nan
    rated_speed: float = np.nan
    rated_life_hours: float = np.nan
    max_average_torque: float = np.nan
    max_repeated_torque: float = np.nan
    max_momentary_torque: float = np.nan
    max_average_input_speed: float = np.nan
    max_input_speed: float = np.nan
    mass: float = np.nan
    cost: float = np.nan
    source: str = ""

    def __post_init__(self) -> None:
        _check_texts(self)
        _check(self, {"ratio": ""}, {})
        if self.ratio == 0:
            raise InputError("gear ratio = 0: the ratio of motor speed to joint speed cannot be zero")
        _check(self, _GEARBOX_POSITIVE, _POSITIVE)
        _check(self, _GEARBOX_NOT_NEGATIVE, _NOT_NEGATIVE)
        _check(self, {"efficiency": ""}, _SHARE)
        _check(self, {"backward_efficiency": ""}, _BACKWARD_SHARE)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Drive:
    """The electronics that feed one motor.

    Parameters
    ----------
    name : str
    bus_voltage : float
        V that reach the motor's terminals at most.
    continuous_current, peak_current : float
        A, in the measure of the motor's torque constant.
    continuous_power, peak_power : float
        Electric power that it can deliver to the motor, on average and at most, W.
    peak_regenerated_power : float
        Electric power that it can take back at most, W; with a brake resistor ``chopper voltage^2 / resistance``.
    storable_energy : float
        J that its bus takes up before the voltage is too high, ``capacitance (V_max^2 - V_nominal^2) / 2``. Each
        joint's bus stands alone: energy that joints could share is not counted.
    brake_resistor_power : float
        W that its brake resistor bears continuously; unknown also where there is none.
    mass, cost : float
        kg, and any currency.
    source : str
        Where the numbers come from.
    """

    name: str = ""
    bus_voltage: float = np.nan
    continuous_current: float = np.nan
    peak_current: float = np.nan
    continuous_power: float = np.nan
    peak_power: float = np.nan
    peak_regenerated_power: float = np.nan
    storable_energy: float = np.nan
    brake_resistor_power: float = np.nan
    mass: float = np.nan
    cost: float = np.nan
    source: str = ""

    def __post_init__(self) -> None:
        _check_texts(self)
        positive = {
            "bus_voltage": "V", "continuous_current": "A", "peak_current": "A", "continuous_power": "W",
            "peak_power": "W", "peak_regenerated_power": "W", "brake_resistor_power": "W",
        }  # fmt: skip
        _check(self, positive, _POSITIVE)
        _check(self, {"storable_energy": "J", "mass": "kg", "cost": ""}, _NOT_NEGATIVE)
