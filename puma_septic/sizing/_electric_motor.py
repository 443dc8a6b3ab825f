"""A motor's currents, winding temperature, voltage and power over a cycle, each with the winding as warm as it is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from puma_septic.drives import Drivetrain
from puma_septic.errors import NoSolution, PumaSepticError
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._loads import JointLoad, MotorLoad
from puma_septic.sizing._thermal import steady_cycle, thermal_equation
from puma_septic.sizing._winding import Regeneration, Winding, electric_power, energies, regeneration
from puma_septic.validation import Array, frozen

__all__ = ["ElectricMotor"]


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class ElectricMotor:
    """The equivalent direct-current motor of a drive train (see `Motor`) over a cycle.

    Computed when first asked for and kept (the cache needs a ``__dict__``, hence no slots).

    Attributes
    ----------
    load : JointLoad
    train : Drivetrain
    motor : MotorLoad
    """

    load: JointLoad
    train: Drivetrain
    motor: MotorLoad

    @property
    def is_known(self) -> bool:
        """Whether torque constant and resistance are known, without which there is no voltage and no loss."""
        motor = self.train.motor
        return not np.isnan(motor.torque_constant * motor.resistance)

    @property
    def is_unbounded(self) -> bool:
        """Whether a velocity steps, or the winding runs away."""
        return not np.isnan(self.load.unbounded) or self.runs_away

    @property
    def runs_away(self) -> bool:
        """Whether each cycle adds more heat than it loses, as the resistance grows."""
        return not self.why_no_temperature and self.temperature_rise is None and bool(np.isnan(self.load.unbounded))

    @cached_property
    def current(self) -> Piecewise:
        """That makes the torque, A, signed."""
        return self.motor.torque * (1 / self.train.motor.dc_torque_constant)

    @property
    def weakens_field(self) -> bool:
        """Whether the drive may weaken the field, and all that this takes is known."""
        motor = self.train.motor
        return self.is_known and motor.reactance_constant > 0 and motor.max_field_current > 0

    @property
    def _max_field_current(self) -> float:
        return self.train.motor.max_field_current / self._printed

    @cached_property
    def current_squared(self) -> Piecewise:
        """Of torque and weakened field together, A^2; the field's with the winding at its highest temperature."""
        square = self.current * self.current
        voltage = self.train.drive.bus_voltage
        if not self.weakens_field or np.isnan(voltage):
            return square
        field = self._winding(self._resistance_at(self.train.motor.max_winding_celsius)).field_current(
            voltage, self._max_field_current
        )
        return square + field * field

    @cached_property
    def why_no_temperature(self) -> str:
        """What hinders the steady winding temperature; empty where nothing does."""
        return self._why_no_steady_state or self._steady_temperature[1]

    @cached_property
    def _why_no_steady_state(self) -> str:
        """What is not known, or that the cycle does not repeat."""
        motor = self.train.motor
        needs = {
            "the motor's torque constant": np.isnan(motor.torque_constant),
            "the motor's resistance": np.isnan(motor.resistance),
            "its thermal resistances and time constants": not len(motor.thermal_time_constants),
        }
        if missing := [name for name, lacks in needs.items() if lacks]:
            return f"needs {', '.join(missing)}"
        return f"no steady temperature: {self.load.why_not_periodic}" if self.load.why_not_periodic else ""

    @property
    def temperature_rise(self) -> Piecewise | None:
        """Of each thermal node over ambient in the steady cycle, the winding first, K.

        None where it is not known, or where there is no steady state: `why_no_temperature` tells which.
        """
        return self._steady_temperature[0]

    @cached_property
    def _steady_temperature(self) -> tuple[Piecewise | None, str]:
        """The rise, and what hinders it; neither where it runs away or the torque is unbounded."""
        motor = self.train.motor
        if self._why_no_steady_state or not np.isnan(self.load.unbounded):
            return None, self._why_no_steady_state
        equation = thermal_equation(
            self.current_squared * motor.dc_resistance,
            motor.thermal_resistances,
            motor.thermal_time_constants,
            copper=motor.copper_coefficient,
            excess=self.train.ambient_celsius - motor.reference_celsius,
        )
        try:
            return steady_cycle(*equation), ""
        except NoSolution:
            return None, ""
        except PumaSepticError as error:
            return None, str(error)

    @cached_property
    def resistance(self) -> Piecewise:
        """Of the winding, ohm: as warm as it is in the steady cycle, else as the sheet has it."""
        motor, rise = self.train.motor, self.temperature_rise
        if rise is None:
            return self._resistance_at(motor.reference_celsius)
        cool = motor.dc_resistance * (
            1 + motor.copper_coefficient * (self.train.ambient_celsius - motor.reference_celsius)
        )
        one = rise.stepwise(np.full((len(rise.lengths), 1), cool))
        return rise[0] * (motor.dc_resistance * motor.copper_coefficient) + one

    def _resistance_at(self, celsius: float) -> Piecewise:
        motor = self.train.motor
        excess = float(np.nan_to_num(celsius - motor.reference_celsius))
        torque = self.motor.torque
        return Piecewise.constant(
            [motor.dc_resistance * (1 + motor.copper_coefficient * excess)], torque.duration, start=torque.start
        )

    def _winding(self, resistance: Piecewise) -> Winding:
        motor = self.train.motor
        return Winding(
            current=self.current,
            speed=self.motor.speed,
            resistance=resistance,
            back_emf=motor.back_emf,
            reactance=motor.reactance_constant,
        )

    @cached_property
    def peak_voltage(self) -> tuple[float, float]:
        """At the terminals, V, and its instant, s; the least that the drive's weakening of the field makes possible."""
        winding = self._winding(self.resistance)
        if not winding.reactance:
            found = winding.voltage.extrema()
            return float(found.peak[0]), float(found.t_peak[0])
        squared = (
            winding.least_voltage_squared(self._max_field_current) if self.weakens_field else winding.voltage_squared
        )
        found = squared.extrema()
        return float(np.sqrt(max(found.max[0], 0.0))), float(found.t_max[0])

    @cached_property
    def power(self) -> Piecewise:
        """At the motor's terminals, W."""
        return electric_power(self.motor.power, self.current_squared, self.resistance)

    @cached_property
    def flows(self) -> Array | None:
        """Energy of each stretch in which it is drawn (positive) or returned, J; None where unknown."""
        return frozen(energies(self.power)) if self.is_known else None

    @cached_property
    def regeneration(self) -> Regeneration:
        """What the bus must take up or burn; a bus of unknown capacity is taken to have none."""
        if self.flows is None:
            return Regeneration(stored=np.nan, braked=np.nan)
        if self.is_unbounded:
            return Regeneration(stored=np.inf, braked=np.inf)
        storable = float(np.nan_to_num(self.train.drive.storable_energy))
        return regeneration(self.flows, storable=storable, periodic=not self.load.why_not_periodic)

    @property
    def bare_thermal_resistance(self) -> float:
        """Of a motor whose time constants are not known, K/W; NaN of any other, and where the cycle does not repeat."""
        motor = self.train.motor
        is_bare = len(motor.thermal_resistances) and not len(motor.thermal_time_constants)
        return float(motor.thermal_resistances.sum()) if is_bare and not self.load.why_not_periodic else np.nan

    def mean_temperature_rise(self, rms_current: float) -> float:
        """Of the winding over ambient at least, K: that of the winding at ambient temperature, which warms no more.

        In the steady cycle as much heat leaves as comes in, whatever the time constants.

        Parameters
        ----------
        rms_current : float
            In the measure of the motor's sheet, A.
        """
        motor = self.train.motor
        current = rms_current * motor.torque_constant / motor.dc_torque_constant
        growth = 1 + motor.copper_coefficient * (self.train.ambient_celsius - motor.reference_celsius)
        return self.bare_thermal_resistance * motor.dc_resistance * growth * current**2

    @cached_property
    def peak_current(self) -> tuple[float, float]:
        """In the measure of the motor's sheet, A, and its instant, s."""
        found = self.current_squared.extrema()
        return float(np.sqrt(max(found.max[0], 0.0))) * self._printed, float(found.t_max[0])

    @cached_property
    def rms_current(self) -> float:
        """In the measure of the motor's sheet, A."""
        mean = self.current_squared.integral()(self.current_squared.breaks[-1])[0] / self.current_squared.duration
        return float(np.sqrt(max(mean, 0.0))) * self._printed

    @property
    def _printed(self) -> float:
        """Amperes on the sheet per ampere of the equivalent direct-current motor."""
        motor = self.train.motor
        return motor.dc_torque_constant / motor.torque_constant
