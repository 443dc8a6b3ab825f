"""A motor as a data sheet has it; NaN (for curves: no rows) means unknown."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, final

import numpy as np

from puma_septic.document import card, known, one_line
from puma_septic.drives._part_checks import (
    ABSOLUTE_ZERO_CELSIUS,
    NOT_NEGATIVE,
    POSITIVE,
    SHARE,
    check_texts,
    checked_curve,
    checked_shares,
    no_curve,
)
from puma_septic.errors import InputError
from puma_septic.validation import Array, checked_array, checked_choice, checked_number, store_numbers

__all__ = ["CURRENTS", "MOTOR_UNITS", "VOLTAGES", "WINDINGS", "Motor"]

# Resistivity of copper, per K at 20 degrees Celsius: the customary value; some data sheets print 0.0039.
_COPPER_COEFFICIENT: Final = 0.00393
_COPPER_REFERENCE_CELSIUS: Final = 20.0
# Ambient and altitude of motor ratings, where a sheet has no others (Kollmorgen, "Derating", kdn.kollmorgen.com: none
# is needed up to 1000 m and 40 degrees Celsius).
_RATED_AMBIENT_CELSIUS: Final = 40.0
_RATED_ALTITUDE: Final = 1000.0

# What a sheet prints, in terms of the equivalent direct-current motor, whose voltage is the peak between two lines and
# whose loss is R i^2 with the resistance between two lines. Three phases of a sinusoidal current I (effective) heat by
# 1.5 R I^2 and give k I: so i = sqrt(1.5) I. Kollmorgen prints N m/A r.m.s. and ohm between lines ("Motor Data
# Legend"), Beckhoff K_T,rms.
CURRENTS: Final = {"dc": 1.0, "rms": 1.5**0.5, "peak": 0.75**0.5}
"""Amperes of the equivalent direct-current motor per ampere printed."""
WINDINGS: Final = {"line-line": 1.0, "phase": 2.0}
"""Resistance (inductance) between two lines of a star per ohm (henry) printed."""
VOLTAGES: Final = {"peak line-line": 1.0, "rms line-line": 2**0.5, "peak phase": 3**0.5, "rms phase": 6**0.5}
"""Peak volts between two lines per volt printed."""

_POSITIVE_UNITS: Final = {
    "torque_constant": "N m/A", "peak_torque": "N m", "continuous_torque": "N m", "max_speed": "rad/s",
    "peak_power": "W", "max_inertia_ratio": "", "voltage_constant": "V s/rad", "pole_pairs": "",
    "standstill_torque": "N m", "brake_torque": "N m", "brake_stop_energy": "J", "brake_total_energy": "J",
}  # fmt: skip
_NOT_NEGATIVE_UNITS: Final = {
    "rotor_inertia": "kg m^2", "viscous_friction": "N m s/rad", "coulomb_friction": "N m", "resistance": "ohm",
    "mass": "kg", "cost": "", "inductance": "H", "max_field_current": "A", "ambient_derating": "1/K",
    "brake_inertia": "kg m^2",
}  # fmt: skip
MOTOR_UNITS: Final = _POSITIVE_UNITS | _NOT_NEGATIVE_UNITS


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Motor:
    """A motor, all values at its shaft.

    Torque constant, resistance and voltage constant are as the sheet prints them, with `current`, `winding` and
    `voltage` to tell in which measure. Heat and voltage follow from the equivalent direct-current motor, ``torque =
    dc_torque_constant i``, ``voltage = dc_resistance i + back_emf speed`` and ``loss = dc_resistance i^2``; of a motor
    with direct current the printed values are its own.

    Parameters
    ----------
    name : str
    rotor_inertia : float
        kg m^2.
    viscous_friction, coulomb_friction : float
        The motor's own, without gears: N m s/rad and N m.
    torque_constant : float
        N m/A, with the amperes of `current`.
    current : {"dc", "rms", "peak"}
        What an ampere of this sheet, and of the drive that feeds the motor, is: direct current (or block commutation),
        the effective value, or the peak, of a sinusoidal phase current.
    resistance : float
        Ohm at `reference_celsius`, between two lines or of a phase, see `winding`.
    winding : {"line-line", "phase"}
        What `resistance` and `inductance` are measured on; a phase of a star.
    voltage_constant : float
        V s/rad, in the measure of `voltage`; NaN: what follows from the torque constant, as power demands.
    voltage : {"peak line-line", "rms line-line", "peak phase", "rms phase"}
        What a volt of the voltage constant is; direct current: the first.
    inductance : float
        H, see `winding`.
    pole_pairs : float
    max_field_current : float
        The most current, in the measure of `current`, that may weaken the field; NaN or 0: the drive does not.
    peak_torque : float
        N m, for a short time.
    peak_curve : array_like, shape (k, 2)
        Torque that motor and drive can give for a short time over the speed: rows (rad/s, N m) from speed 0, straight
        between them; beyond the last speed there is none. It holds in all four quadrants.
    continuous_torque : float
        N m at any speed (duty S1).
    continuous_curve : array_like, shape (k, 2)
        The same over the speed (S1 curve), instead of `continuous_torque`; rows as in `peak_curve`.
    rated_ambient_celsius : float
        Ambient for which the continuous torque is stated, degrees Celsius; NaN: the sheet does not tell, and the
        customary 40 is taken.
    ambient_derating : float
        Share of the continuous torque that is lost per K above it; NaN: it follows from the winding's highest
        temperature.
    altitude_curve : array_like, shape (k, 2)
        Rows (m, share of the continuous torque), straight between them; 1 below the first. Empty: unknown above 1000 m.
    geared_share : float
        Share of the continuous torque that is left with a gearbox at the flange (Beckhoff, AM8100: down to 0.8); NaN:
        the sheet tells of none, and none is lost.
    standstill_torque : float
        N m that the motor may hold without end at standstill, where one phase carries the most; NaN: unknown.
    brake_torque, brake_inertia : float
        Of the holding brake in the motor: N m and kg m^2 that it adds to the rotor.
    brake_stop_energy, brake_total_energy : float
        J that it bears in one emergency stop, and in its life.
    peak_curves, continuous_curves : sequence of (float, array_like)
        Curves as `peak_curve` and `continuous_curve`, each with the bus voltage, V, at which it holds.
    max_speed : float
        rad/s.
    peak_power : float
        Mechanical, at the shaft, W.
    max_winding_celsius : float
        Highest temperature that the winding may have, degrees Celsius.
    thermal_resistances, thermal_time_constants : array_like, shape (1,) or (2,)
        K/W and s, from the winding outwards: one node (winding to ambient) or two (winding to housing, housing to
        ambient). The heat capacity of node i is ``thermal_time_constants[i] / thermal_resistances[i]``. Empty: unknown;
        the resistances alone tell how warm the winding is on average at least.
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
    current: str = "dc"
    resistance: float = np.nan
    winding: str = "line-line"
    voltage_constant: float = np.nan
    voltage: str = "peak line-line"
    inductance: float = np.nan
    pole_pairs: float = np.nan
    max_field_current: float = np.nan
    peak_torque: float = np.nan
    peak_curve: Array = field(default_factory=no_curve)
    continuous_torque: float = np.nan
    continuous_curve: Array = field(default_factory=no_curve)
    peak_curves: tuple[tuple[float, Array], ...] = ()
    continuous_curves: tuple[tuple[float, Array], ...] = ()
    rated_ambient_celsius: float = np.nan
    ambient_derating: float = np.nan
    altitude_curve: Array = field(default_factory=no_curve)
    geared_share: float = np.nan
    standstill_torque: float = np.nan
    brake_torque: float = np.nan
    brake_inertia: float = np.nan
    brake_stop_energy: float = np.nan
    brake_total_energy: float = np.nan
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
        check_texts(self)
        for name, valid in (("current", CURRENTS), ("winding", WINDINGS), ("voltage", VOLTAGES)):
            checked_choice(name, getattr(self, name), valid)
        store_numbers(self, _POSITIVE_UNITS, **POSITIVE)
        store_numbers(self, _NOT_NEGATIVE_UNITS, **NOT_NEGATIVE)
        store_numbers(self, {"geared_share": ""}, **SHARE)
        for name in ("max_winding_celsius", "reference_celsius", "rated_ambient_celsius"):
            store_numbers(self, {name: "degrees Celsius"}, above=ABSOLUTE_ZERO_CELSIUS)
        warmer = checked_number("copper_coefficient", self.copper_coefficient, unit="1/K", at_least=0.0)
        object.__setattr__(self, "copper_coefficient", warmer)
        self._check_curves()
        self._check_thermal()

    def _check_curves(self) -> None:
        for name in ("peak_curve", "continuous_curve"):
            object.__setattr__(self, name, checked_curve(name, getattr(self, name)))
            self._check_curves_of_voltages(name)
        for name in ("continuous_curve", "continuous_curves"):
            if len(getattr(self, name)) and not np.isnan(self.continuous_torque):
                raise InputError(f"give continuous_torque (any speed) or {name}, not both")
        object.__setattr__(self, "altitude_curve", checked_shares("altitude_curve", self.altitude_curve, unit="m"))

    def _check_curves_of_voltages(self, name: str) -> None:
        several = f"{name}s"
        curves = [
            (checked_number(f"bus voltage of {several}", volts, unit="V", above=0.0), checked_curve(several, rows))
            for volts, rows in getattr(self, several)
        ]
        if curves and len(getattr(self, name)):
            raise InputError(f"give {name} (any bus voltage) or {several}, not both")
        object.__setattr__(self, several, tuple(sorted(curves, key=lambda item: item[0])))

    def _check_thermal(self) -> None:
        for name, unit in (("thermal_resistances", "K/W"), ("thermal_time_constants", "s")):
            values = checked_array(name, getattr(self, name), (None,), unit=unit, above=0.0)
            if len(values) > 2:
                raise InputError(f"{name} = {values.tolist()} {unit}: expected one or two positive numbers")
            object.__setattr__(self, name, values)
        if len(self.thermal_time_constants) not in (0, len(self.thermal_resistances)):
            raise InputError(
                f"{len(self.thermal_resistances)} thermal_resistances and {len(self.thermal_time_constants)}"
                " thermal_time_constants: expected one of each per node"
            )

    def continuous_torque_at(self, speed: float, *, bus_voltage: float = np.nan) -> float:
        """Continuous torque at a speed in rad/s: 0 beyond the end of the S1 curve, NaN where unknown."""
        curve = self.continuous_curve_at(bus_voltage)
        if len(curve):
            return float(np.interp(abs(speed), curve[:, 0], curve[:, 1], right=0.0))
        return self.continuous_torque

    def peak_curve_at(self, bus_voltage: float) -> Array:
        """The curve of torque over speed at a bus voltage, V; no rows where there is none.

        Of several curves the one of the highest voltage that the bus reaches: at a higher voltage a motor can do no
        less. Below all of them it can do no more than the lowest one says, see `has_curves_at`.

        Returns
        -------
        ndarray, shape (k, 2)
        """
        return _curve_at(self.peak_curves, bus_voltage, self.peak_curve)

    def continuous_curve_at(self, bus_voltage: float) -> Array:
        """The S1 curve at a bus voltage, V, chosen likewise; no rows where there is none.

        Returns
        -------
        ndarray, shape (k, 2)
        """
        return _curve_at(self.continuous_curves, bus_voltage, self.continuous_curve)

    def has_curves_at(self, bus_voltage: float) -> bool:
        """Whether the bus reaches a voltage of each set of curves, or there are no sets."""
        return all(curves[0][0] <= bus_voltage for curves in (self.peak_curves, self.continuous_curves) if curves)

    def continuous_share(self, *, ambient_celsius: float, altitude: float = 0.0) -> float:
        """Share of the continuous torque that is left at an ambient and an altitude; NaN where it is not known.

        Above the rated ambient copper loss, and so the torque squared, goes with the temperature rise that is left,
        ``sqrt((T_max - T_ambient) / (T_max - T_rated))``, unless the sheet has a share per K; below it nothing is
        gained.

        Parameters
        ----------
        ambient_celsius : float
        altitude : float
            m above sea level.

        Returns
        -------
        float

        Notes
        -----
        Kollmorgen, "Motor derating due to high ambient temperatures" (kollmorgen.com, blog), and "Choose wisely",
        Machine Design (machinedesign.com/archive/choose-wisely), whose example loses 13 %:

        Examples
        --------
        >>> round(1 - Motor(max_winding_celsius=140.0).continuous_share(ambient_celsius=65.0), 2)
        0.13
        """
        return self._ambient_share(ambient_celsius) * self._altitude_share(altitude)

    def _ambient_share(self, ambient_celsius: float) -> float:
        rated = self.rated_ambient_celsius
        excess = ambient_celsius - (_RATED_AMBIENT_CELSIUS if np.isnan(rated) else rated)
        if excess <= 0:
            return 1.0
        if not np.isnan(self.ambient_derating):
            return max(0.0, 1.0 - self.ambient_derating * excess)
        left = self.max_winding_celsius - ambient_celsius
        return float(np.sqrt(np.maximum(left, 0.0) / (left + excess)))

    def _altitude_share(self, altitude: float) -> float:
        if len(self.altitude_curve):
            return float(
                np.interp(altitude, self.altitude_curve[:, 0], self.altitude_curve[:, 1], left=1.0, right=np.nan)
            )
        return 1.0 if altitude <= _RATED_ALTITUDE else np.nan

    @property
    def dc_torque_constant(self) -> float:
        """Of the equivalent direct-current motor, N m/A."""
        return float(self.torque_constant / CURRENTS[self.current])

    @property
    def dc_resistance(self) -> float:
        """Of the equivalent direct-current motor, ohm at `reference_celsius`."""
        return self.resistance * WINDINGS[self.winding]

    @property
    def back_emf(self) -> float:
        """Of the equivalent direct-current motor, V s/rad: by the voltage constant, else by the torque constant."""
        if np.isnan(self.voltage_constant):
            return self.dc_torque_constant
        return float(self.voltage_constant * VOLTAGES[self.voltage])

    @property
    def reactance_constant(self) -> float:
        """``pole_pairs inductance`` between two lines, V s/(rad A): times the speed the reactance; unknown is 0."""
        return float(np.nan_to_num(self.pole_pairs * self.inductance * WINDINGS[self.winding]))

    def __repr__(self) -> str:
        return one_line("Motor", self._facts())

    def _repr_html_(self) -> str:
        return card("Motor", self._facts())

    def _facts(self) -> dict[str, object]:
        return known(
            self,
            {
                "name": "",
                "rotor_inertia": "kg m^2",
                "peak_torque": "N m",
                "continuous_torque": "N m",
                "max_speed": "rad/s",
                "torque_constant": "N m/A",
                "resistance": "ohm",
                "mass": "kg",
                "cost": "",
                "source": "",
            },
        )


def _curve_at(curves: tuple[tuple[float, Array], ...], bus_voltage: float, any_voltage: Array) -> Array:
    if not curves or np.isnan(bus_voltage):
        return any_voltage
    return next((curve for volts, curve in reversed(curves) if volts <= bus_voltage), curves[0][1])
