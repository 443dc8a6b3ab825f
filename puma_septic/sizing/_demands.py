"""Demands: every number that a joint's cycle asks of its drive train."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, final

import numpy as np

from puma_septic.drives import Drivetrain
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._bearing import BearingLoad, bearing_load
from puma_septic.sizing._brake import holding_torque, standing_torque, stop_energy
from puma_septic.sizing._electric_motor import ElectricMotor
from puma_septic.sizing._gearbox import RULES, GearRule, allowed_rare_peaks, average_load_torque, expected_life, lives
from puma_septic.sizing._loads import JointLoad, MotorLoad, inertia_ratio, torque_by_cause
from puma_septic.sizing._torque_speed import torque_at_speed
from puma_septic.sizing._winding import Regeneration, both_signs, energies
from puma_septic.validation import Array, FrozenMap

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
        return average_load_torque(self.load, self.gear_rule.exponent)

    @property
    def gear_rule(self) -> GearRule:
        """Of the makers of this type of gear."""
        return RULES[self.train.gearbox.kind]

    @property
    def repeated_torque(self) -> Peak:
        """Peak at the gearbox's output as it counts where many come in an hour, N m, see `Gearbox.impact_factor`."""
        peak = self.peak_load_torque
        return Peak(peak.size * self.train.gearbox.impact_factor(self.load.duration), peak.time)

    @property
    def why_no_repeated_torque(self) -> str:
        """Why it is not known how the peaks of each cycle count; empty where it is."""
        if not np.isnan(self.repeated_torque.size):
            return ""
        rate = 3600 / self.load.duration
        return f"needs the planetary gearbox's impact factor, as {rate:.4g} cycles per hour are more than 1000"

    @cached_property
    def peak_torque(self) -> Peak:
        """Of the motor, N m."""
        return self._peak(self.motor.torque)

    @cached_property
    def peak_effort(self) -> Peak:
        """The same referred to the joint, N m (N)."""
        k = 1.0 if self.train.stage is None else self.train.stage.reduction
        return Peak(self.train.ratio * k * self.peak_torque.size, self.peak_torque.time)

    @property
    def peak_force(self) -> Peak:
        """On the stage of a sliding joint, N."""
        return _UNKNOWN if self.load.slide is None else self._peak(self.load.slide.torque)

    @property
    def peak_stage_speed(self) -> Peak:
        """Of the stage's input, rad/s."""
        found = self.load.velocity.extrema()
        return Peak(float(found.peak[0]), float(found.t_peak[0]))

    @property
    def max_effort(self) -> float:
        """Limit of `peak_effort`."""
        return self.train.max_effort

    @cached_property
    def rms_torque(self) -> float:
        """Of the motor over the whole cycle, N m."""
        return self.motor.rms_torque

    @cached_property
    def rms_by_cause(self) -> Mapping[str, float]:
        """Root mean squares at the joint, N m, see `torque_by_cause`."""
        parts = torque_by_cause(self.load, self.train, self.motor)
        return FrozenMap({name: float(f.rms()[0]) for name, f in parts.items()})

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
        return self.train.continuous_torque_at(self.mean_speed)

    @cached_property
    def _at_speed(self) -> tuple[Peak, float]:
        """Torque and limit where the motor comes closest to, or farthest beyond, its curve of torque over speed."""
        curve = self.train.peak_curve
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
        """Largest inertia of load and gears at the motor over the rotor's, its brake's with it."""
        return Peak(*inertia_ratio(self.load, self.train))

    @cached_property
    def electric(self) -> ElectricMotor:
        """Currents, winding temperature, voltage and power."""
        return ElectricMotor(load=self.load, train=self.train, motor=self.motor)

    @property
    def load_inertia_ratio(self) -> Peak:
        """`inertia_ratio`, held against the limit that is asked for."""
        return self.inertia_ratio

    @property
    def max_inertia_ratio(self) -> float:
        """Limit of `load_inertia_ratio`, where one is asked for."""
        return self.train.max_inertia_ratio

    @cached_property
    def peak_voltage(self) -> Peak:
        """At the terminals, the peak between two lines, V."""
        if not self.electric.is_known:
            return _UNKNOWN
        return self._unbounded or Peak(*self.electric.peak_voltage)

    @cached_property
    def peak_current(self) -> Peak:
        """In the measure of the motor's sheet, A."""
        if np.isnan(self.train.motor.torque_constant):
            return _UNKNOWN
        return self._unbounded or Peak(*self.electric.peak_current)

    @cached_property
    def rms_current(self) -> float:
        """In the measure of the motor's sheet, A."""
        if np.isnan(self.train.motor.torque_constant):
            return np.nan
        return np.inf if self._unbounded else self.electric.rms_current

    @property
    def _unbounded(self) -> Peak | None:
        """An infinite peak where a velocity steps or the winding runs away."""
        return Peak(np.inf, self.load.unbounded) if self.electric.is_unbounded else None

    @cached_property
    def peak_power(self) -> Peak:
        """Largest mechanical power of the motor in either direction, W."""
        return self._peak(self.motor.power)

    @property
    def electric_power(self) -> Piecewise | None:
        """At the motor's terminals, W; None where torque constant or resistance is unknown."""
        return self.electric.power if self.electric.is_known else None

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
        return both_signs(energies(self.motor.power))

    @property
    def electric_flows(self) -> Array | None:
        """Electric energy of each stretch in which it is drawn (positive) or returned, J; None where unknown."""
        return self.electric.flows

    @cached_property
    def electric_energy(self) -> tuple[float, float]:
        """Electric energy drawn and returned over the cycle, J."""
        return (np.nan, np.nan) if self.electric_flows is None else both_signs(self.electric_flows)

    @property
    def mean_drawn_power(self) -> float:
        """Electric power drawn, on average over the cycle, W."""
        return np.inf if self.electric.is_unbounded else self.electric_energy[0] / self.load.duration

    @property
    def regeneration(self) -> Regeneration:
        """What the bus must take up or burn; a bus of unknown capacity is taken to have none."""
        return self.electric.regeneration

    @property
    def stored_energy(self) -> float:
        """What the bus must take up, J."""
        return self.regeneration.stored

    @property
    def mean_braked_power(self) -> float:
        """What the brake resistor must burn, on average over the cycle, W."""
        return self.regeneration.braked / self.load.duration

    @property
    def why_no_temperature(self) -> str:
        """What hinders the steady winding temperature; empty where nothing does."""
        return self.electric.why_no_temperature

    @property
    def temperature_rise(self) -> Piecewise | None:
        """Of each thermal node over ambient in the steady cycle, the winding first, K; see `ElectricMotor`."""
        return self.electric.temperature_rise

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
    def bare_thermal_resistance(self) -> float:
        """Of a motor whose time constants are not known, K/W; NaN of any other, and where the cycle does not repeat."""
        return self.electric.bare_thermal_resistance

    @property
    def mean_temperature_rise(self) -> float:
        """Of the winding over ambient at least, K, see `ElectricMotor.mean_temperature_rise`."""
        return self.electric.mean_temperature_rise(self.rms_current)

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
    def bearing(self) -> BearingLoad | None:
        """What the bearing at the gearbox's output carries; None for a joint that slides."""
        return bearing_load(self.load, self.train.gearbox)

    @property
    def peak_tilting_moment(self) -> Peak:
        """On the bearing, N m."""
        return self._of_bearing("peak_tilting")

    @property
    def peak_axial_force(self) -> Peak:
        """On the bearing, N."""
        return self._of_bearing("peak_axial")

    @property
    def peak_radial_force(self) -> Peak:
        """On the bearing, N."""
        return self._of_bearing("peak_radial")

    def _of_bearing(self, name: str) -> Peak:
        if self.bearing is None:
            return _UNKNOWN
        if not np.isnan(self.load.unbounded):
            return Peak(np.inf, self.load.unbounded)
        return Peak(*getattr(self.bearing, name))

    @property
    def safe_static_load(self) -> float:
        """Static equivalent load of the bearing with the safety of normal operation, N."""
        return np.nan if self.bearing is None else self.bearing.safe_static_load(self.train.gearbox)

    @property
    def bearing_life_hours(self) -> float:
        """L10 of the bearing, h."""
        return np.nan if self.bearing is None else self.bearing.life_hours(self.train.gearbox)

    @property
    def standing_torque(self) -> Peak:
        """Of the motor while its joint stands without a brake, N m."""
        return Peak(*standing_torque(self.load, self.train.ratio))

    @property
    def stands_loaded(self) -> float:
        """1 where the motor holds a load at standstill, NaN where it never does."""
        return 1.0 if self.standing_torque.size > 0 else np.nan

    @property
    def max_standing_torque(self) -> float:
        """Limit of `standing_torque`, where ambient and altitude leave less."""
        return self.train.motor.standstill_torque * self.train.continuous_share

    @property
    def braked(self) -> float:
        """1 where a holding brake is used or taken with the motor, NaN where nobody asks for one."""
        return 1.0 if self.train.with_brake or self.load.braked.any() else np.nan

    @property
    def unbraked(self) -> float:
        """The other way round."""
        return np.nan if self.braked == 1 else 1.0

    @property
    def why_no_bearing(self) -> str:
        """Why nothing is known of the output bearing's load; empty where it is."""
        knows = self.load.cycle is not None and not self.load.is_prismatic and self.load.slide is None
        return "" if knows else "the joint slides, or its arm is not known"

    @property
    def holding_torque(self) -> Peak:
        """That the brake must hold, N m at the motor."""
        return Peak(*holding_torque(self.load, self.train.ratio))

    @property
    def brake_stop_energy(self) -> float:
        """Of one emergency stop by the brake, J."""
        return np.inf if not np.isnan(self.load.unbounded) else stop_energy(self.load, self.train)

    @property
    def brake_wear(self) -> float:
        """Energy of all emergency stops, J."""
        return self.brake_stop_energy * self.train.emergency_stops

    @property
    def emergency_stops(self) -> float:
        """How many momentary peaks are to be borne."""
        return self.train.emergency_stops

    @property
    def allowed_emergency_stops(self) -> float:
        """How many the gearbox bears, each at the motor's highest speed."""
        return allowed_rare_peaks(
            self.train.gearbox, input_speed=self.peak_speed.size, duration=self.train.emergency_duration
        )

    @property
    def expected_lives(self) -> tuple[float, float]:
        """L10 and L50 of the gearbox, h; NaN where the basis of its rated life is not known."""
        return lives(self.train.gearbox, self.expected_life_hours)

    @property
    def assured_life_hours(self) -> float:
        """What a required life is held against, h: L10 where it is known, else the life in the sheet's own measure."""
        first = self.expected_lives[0]
        return self.expected_life_hours if np.isnan(first) else first

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
            exponent=self.gear_rule.exponent,
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
        if self._unbounded:
            return self._unbounded
        found = (power * sign).extrema()
        return Peak(max(float(found.max[0]), 0.0), float(found.t_max[0]))
