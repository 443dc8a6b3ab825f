"""Demands: every number that a joint's cycle asks of its drive train."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, final

import numpy as np

from puma_septic.drives import Drivetrain
from puma_septic.errors import NoSolution, PumaSepticError
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._electrical import Regeneration, electric_power, energies, regeneration
from puma_septic.sizing._gearbox import average_load_torque, expected_life
from puma_septic.sizing._loads import JointLoad, MotorLoad
from puma_septic.sizing._thermal import steady_cycle, thermal_equation
from puma_septic.sizing._torque_speed import torque_at_speed, voltage
from puma_septic.validation import Array

__all__ = ["Demands", "Peak"]


class Peak(NamedTuple):
    """A largest magnitude and its instant, s."""

    size: float
    time: float


_UNKNOWN = Peak(np.nan, np.nan)


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Demands:
    """What a cycle asks of one joint's drive train; NaN where a value of the drive train that it needs is unknown.

    Computed when first asked for and kept (the cache needs a ``__dict__``, hence no slots). A velocity that steps makes
    torques and powers infinite.

    Attributes
    ----------
    load : JointLoad
    train : Drivetrain
    motor : MotorLoad
    """

    load: JointLoad
    train: Drivetrain
    motor: MotorLoad

    @cached_property
    def peak_load_torque(self) -> Peak:
        """At the gearbox's output, N m."""
        return self._peak(self.load.torque)

    @cached_property
    def average_load_torque(self) -> float:
        """Cubic mean weighted by speed at the gearbox's output, N m; NaN where the joint never moves."""
        return average_load_torque(self.load)

    @cached_property
    def peak_torque(self) -> Peak:
        """Of the motor, N m."""
        return self._peak(self.motor.torque)

    @cached_property
    def peak_effort(self) -> Peak:
        """The same referred to the joint, N m (N)."""
        return Peak(self.train.ratio * self.peak_torque.size, self.peak_torque.time)

    @property
    def max_effort(self) -> float:
        """Limit of `peak_effort`."""
        return self.train.max_effort

    @cached_property
    def rms_torque(self) -> float:
        """Of the motor over the whole cycle, N m."""
        return self.motor.rms_torque

    @cached_property
    def rms_by_cause(self) -> dict[str, float]:
        """Root mean squares at the joint, N m: gravity and motion of the links, rotor, friction."""
        ratio = self.train.ratio
        parts = {
            "gravity": self.load.gravity,
            "motion": self.load.torque - self.load.gravity,
            "rotor": self.motor.parts["rotor"] * ratio,
            "friction": self.motor.parts["friction"] * ratio,
        }
        return {name: float(f.rms()[0]) for name, f in parts.items()}

    @cached_property
    def peak_speed(self) -> Peak:
        """Of the motor, rad/s."""
        found = self.motor.speed.extrema()
        return Peak(float(found.peak[0]), float(found.t_peak[0]))

    @cached_property
    def mean_speed(self) -> float:
        """Mean magnitude of the motor's speed over the whole cycle, rad/s."""
        return self.motor.mean_speed

    @property
    def continuous_torque(self) -> float:
        """Limit of `rms_torque`: of the S1 curve where there is one."""
        return self.train.motor.continuous_torque_at(self.mean_speed)

    @cached_property
    def _at_speed(self) -> tuple[Peak, float]:
        """Torque and limit where the motor comes closest to, or farthest beyond, its curve of torque over speed."""
        curve = self.train.motor.peak_curve
        if not len(curve):
            return _UNKNOWN, np.nan
        if not np.isnan(self.load.unbounded):
            return self.peak_torque, float(curve[0, 1])
        _, size, limit, time = torque_at_speed(self.motor, curve)
        return Peak(size, time), limit

    @property
    def torque_at_speed(self) -> Peak:
        """Of the motor where it uses most of its curve of torque over speed, N m."""
        return self._at_speed[0]

    @property
    def torque_at_speed_limit(self) -> float:
        """The curve there."""
        return self._at_speed[1]

    @cached_property
    def inertia_ratio(self) -> Peak:
        """Largest inertia of the load at the motor over that of rotor and gear input."""
        if np.isnan(self.train.motor.rotor_inertia) or not self.train.inertia > 0:
            return _UNKNOWN
        found = self.load.inertia.extrema()
        return Peak(float(found.max[0]) / self.train.reflected_inertia, float(found.t_max[0]))

    @cached_property
    def load_inertia_ratio(self) -> Peak:
        """Largest inertia of the load at the motor, with that of the gears, over the rotor's alone.

        So the makers of motors count, as Yaskawa, Sigma-V manual E-V-MD, p. 2-5: ``J_L = J_L1 + J_B + J_G``.
        """
        rotor = self.train.motor.rotor_inertia
        if not rotor > 0:
            return _UNKNOWN
        found = self.load.inertia.extrema()
        gears = float(np.nan_to_num(self.train.gearbox.inertia))
        return Peak((float(found.max[0]) / self.train.ratio**2 + gears) / rotor, float(found.t_max[0]))

    @property
    def max_inertia_ratio(self) -> float:
        """Limit of `load_inertia_ratio`, where one is asked for."""
        return self.train.max_inertia_ratio

    @cached_property
    def peak_voltage(self) -> Peak:
        """At the terminals of the equivalent direct-current motor, V."""
        motor = self.train.motor
        if np.isnan(motor.torque_constant) or np.isnan(motor.resistance):
            return _UNKNOWN
        return self._peak(voltage(self.motor, motor.torque_constant, motor.resistance))

    @cached_property
    def peak_current(self) -> Peak:
        """A."""
        return Peak(self.peak_torque.size / self.train.motor.torque_constant, self.peak_torque.time)

    @cached_property
    def rms_current(self) -> float:
        """A."""
        return self.rms_torque / self.train.motor.torque_constant

    @cached_property
    def peak_power(self) -> Peak:
        """Largest mechanical power of the motor in either direction, W."""
        return self._peak(self.motor.power)

    @cached_property
    def electric_power(self) -> Piecewise | None:
        """At the motor's terminals, W; None where torque constant or resistance is unknown."""
        motor = self.train.motor
        if np.isnan(motor.torque_constant) or np.isnan(motor.resistance):
            return None
        return electric_power(
            self.motor.torque, self.motor.speed, torque_constant=motor.torque_constant, resistance=motor.resistance
        )

    @cached_property
    def peak_drawn_power(self) -> Peak:
        """Largest electric power that the motor draws, W."""
        return self._one_sided(self.electric_power, 1.0)

    @cached_property
    def peak_returned_power(self) -> Peak:
        """Largest electric power that the motor returns, W, as a magnitude."""
        return self._one_sided(self.electric_power, -1.0)

    @cached_property
    def work(self) -> tuple[float, float]:
        """Mechanical energy that the motor gives and takes back over the cycle, J."""
        return _both_signs(energies(self.motor.power))

    @cached_property
    def electric_flows(self) -> Array | None:
        """Electric energy of each stretch in which it is drawn (positive) or returned, J; None where unknown."""
        return None if self.electric_power is None else energies(self.electric_power)

    @cached_property
    def electric_energy(self) -> tuple[float, float]:
        """Electric energy drawn and returned over the cycle, J."""
        return (np.nan, np.nan) if self.electric_flows is None else _both_signs(self.electric_flows)

    @property
    def mean_drawn_power(self) -> float:
        """Electric power drawn, on average over the cycle, W."""
        return self.electric_energy[0] / self.load.duration if np.isnan(self.load.unbounded) else np.inf

    @cached_property
    def regeneration(self) -> Regeneration:
        """What the bus must take up or burn; a bus of unknown capacity is taken to have none."""
        if self.electric_flows is None:
            return Regeneration(stored=np.nan, braked=np.nan)
        if not np.isnan(self.load.unbounded):
            return Regeneration(stored=np.inf, braked=np.inf)
        storable = float(np.nan_to_num(self.train.drive.storable_energy))
        return regeneration(self.electric_flows, storable=storable, periodic=not self.load.why_not_periodic)

    @property
    def stored_energy(self) -> float:
        """What the bus must take up, J."""
        return self.regeneration.stored

    @property
    def mean_braked_power(self) -> float:
        """What the brake resistor must burn, on average over the cycle, W."""
        return self.regeneration.braked / self.load.duration

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
            "its thermal resistances and time constants": not len(motor.thermal_resistances),
        }
        if missing := [name for name, lacks in needs.items() if lacks]:
            return f"needs {', '.join(missing)}"
        return f"no steady temperature: {self.load.why_not_periodic}" if self.load.why_not_periodic else ""

    @cached_property
    def temperature_rise(self) -> Piecewise | None:
        """Of each thermal node over ambient in the steady cycle, the winding first, K.

        None where it is not known, or where there is no steady state: `peak_temperature_rise` tells which.
        """
        return self._steady_temperature[0]

    @cached_property
    def _steady_temperature(self) -> tuple[Piecewise | None, str]:
        """The rise, and what hinders it; neither where it runs away or the torque is unbounded."""
        motor = self.train.motor
        if self._why_no_steady_state or not np.isnan(self.load.unbounded):
            return None, self._why_no_steady_state
        torque = self.motor.torque
        equation = thermal_equation(
            torque * torque * (motor.resistance / motor.torque_constant**2),
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
    def peak_temperature_rise(self) -> Peak:
        """Of the winding over ambient in the steady cycle, K; infinite where it runs away."""
        if self.why_no_temperature:
            return _UNKNOWN
        if self.temperature_rise is None:
            return Peak(np.inf, np.nan)
        found = self.temperature_rise.extrema()
        return Peak(float(found.max[0]), float(found.t_max[0]))

    @property
    def max_temperature_rise(self) -> float:
        """Limit of `peak_temperature_rise`, over ambient so that the utilisation knows no zero of the scale, K."""
        return float(np.maximum(self.train.motor.max_winding_celsius - self.train.ambient_celsius, 0.0))

    @property
    def why_no_average(self) -> str:
        """Why there is no average torque of the gears; empty where there is one."""
        return "the joint never moves" if np.isnan(self.average_load_torque) else ""

    @property
    def momentary_torque(self) -> float:
        """Of a collision or emergency stop at the gearbox's output, N m (N)."""
        return self.train.momentary_torque

    @property
    def required_life_hours(self) -> float:
        """That the gearbox is to last."""
        return self.train.required_life_hours

    @cached_property
    def expected_life_hours(self) -> float:
        """Of the gearbox, at this cycle's average torque and mean input speed."""
        gearbox = self.train.gearbox
        average = self.average_load_torque if self.load.moves else 0.0
        return expected_life(
            gearbox.rated_life_hours,
            rated_torque=gearbox.rated_torque,
            rated_speed=gearbox.rated_speed,
            average_torque=average,
            average_speed=self.mean_speed,
        )

    def _peak(self, f: Piecewise) -> Peak:
        """Largest magnitude, infinite where the torque is unbounded."""
        if not np.isnan(self.load.unbounded):
            return Peak(np.inf, self.load.unbounded)
        found = f.extrema()
        return Peak(float(found.peak[0]), float(found.t_peak[0]))

    def _one_sided(self, power: Piecewise | None, sign: float) -> Peak:
        if power is None:
            return _UNKNOWN
        if not np.isnan(self.load.unbounded):
            return Peak(np.inf, self.load.unbounded)
        found = (power * sign).extrema()
        return Peak(max(float(found.max[0]), 0.0), float(found.t_max[0]))


def _both_signs(flows: Array) -> tuple[float, float]:
    return float(np.maximum(flows, 0.0).sum()), float(np.maximum(-flows, 0.0).sum())
