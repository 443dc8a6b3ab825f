"""What many drive trains at once need, each demand between a lower and an upper bound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.drives import Gearbox
from puma_septic.sizing._bearing import BearingLoad, bearing_load
from puma_septic.sizing._bounds import (
    ROUNDING,
    Bounds,
    average_by_gearbox,
    bounds_of_cool_voltage,
    bounds_of_electric,
    bounds_of_peaks,
    bounds_of_rms,
    bounds_of_temperature_rise,
    bounds_of_torque_at_speed,
    bounds_of_warm_voltage,
    bounds_of_winding_growth,
    continuous_limit,
    exactly,
    expected_lives,
    scaled,
)
from puma_septic.sizing._brake import holding_torque, standing_torque
from puma_septic.sizing._gearbox import (
    allowed_rare_peaks,
)
from puma_septic.sizing._load_features import LoadGrid
from puma_septic.sizing._pair_features import PairTable
from puma_septic.validation import Array

__all__ = ["PairDemands", "PeakBounds"]


class PeakBounds(NamedTuple):
    """Peaks of the motor's torque, mechanical power, voltage with a cool winding and without reactance, and curve."""

    torque: Bounds
    power: Bounds
    voltage: Bounds
    at_speed: Bounds

    def at(self, places: NDArray[np.bool_]) -> PeakBounds:
        """Those of some pairs."""
        return PeakBounds(*((low[places], high[places]) for low, high in self))


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PairDemands:
    """`Demands` of many drive trains at once, each between a lower and an upper bound, and limits, by the same names.

    Computed when first asked for and kept (the cache needs a ``__dict__``, hence no slots).

    Attributes
    ----------
    grid : LoadGrid
    table : PairTable
    momentary_torque_at_joint : float
        Of a collision or emergency stop.
    shared : PeakBounds or None
        Peaks in all load cases at once, in place of those in this one: what counts is the largest of all.
    """

    grid: LoadGrid
    table: PairTable
    momentary_torque_at_joint: float = np.nan
    shared: PeakBounds | None = None

    def limit(self, part: str, name: str) -> Array:
        """A value of each pair's motor, gearbox or drive.

        Returns
        -------
        ndarray, shape (n_pairs,)
        """
        return np.asarray(getattr(self.table, part)(name))

    @cached_property
    def _torque_and_power(self) -> tuple[Bounds, Bounds]:
        if self.shared is not None:
            return self.shared.torque, self.shared.power
        return bounds_of_peaks(self.grid, self.table)

    @property
    def peak_torque(self) -> Bounds:
        """Of the motor."""
        return self._torque_and_power[0]

    @property
    def peak_power(self) -> Bounds:
        """Mechanical, of the motor."""
        return self._torque_and_power[1]

    @property
    def peak_effort(self) -> Bounds:
        """Of the motor, referred to the joint."""
        return scaled(self.peak_torque, self.table.ratio * self.table.stage_reduction)

    @property
    def peak_force(self) -> Bounds:
        """On the stage of a sliding joint."""
        slide = self.grid.load.slide
        return self._same(np.nan if slide is None else float(slide.torque.extrema().peak[0]))

    @property
    def peak_stage_speed(self) -> Bounds:
        """Of the stage's input."""
        return self._same(self.grid.moments.peak_speed)

    @property
    def max_effort(self) -> Array:
        """Limit of `peak_effort`."""
        return self.table.max_effort

    @cached_property
    def rms_torque(self) -> Bounds:
        """Of the motor."""
        return bounds_of_rms(self.grid, self.table.coefficients)

    @property
    def continuous_torque(self) -> Array:
        """Limit of `rms_torque`."""
        return continuous_limit(self.table, self.table.ratio * self.grid.mean_speed) * self.table.continuous_share

    @property
    def torque_at_speed(self) -> Bounds:
        """As a share of the curve."""
        if self.shared is not None:
            return self.shared.at_speed
        return bounds_of_torque_at_speed(self.grid, self.table, self.peak_torque[1], self._top_speed)

    @property
    def torque_at_speed_limit(self) -> Array:
        """All of the curve."""
        return np.ones(len(self.table.ratio))

    @property
    def peak_voltage(self) -> Bounds:
        """At the motor's terminals."""
        base = bounds_of_cool_voltage(self.grid, self.table) if self.shared is None else self.shared.voltage
        return bounds_of_warm_voltage(
            self.table, base, self._winding_growth[1], self.peak_torque[1], self.peak_power[1]
        )

    @cached_property
    def _winding_growth(self) -> Bounds:
        return bounds_of_winding_growth(self.table, self.peak_temperature_rise)

    @property
    def _top_speed(self) -> Array:
        return self.table.ratio * self.grid.moments.peak_speed

    @property
    def peak_speed(self) -> Bounds:
        """Of the motor."""
        return exactly(self._top_speed)

    @property
    def mean_speed(self) -> Bounds:
        """Of the motor."""
        return exactly(self.table.ratio * self.grid.mean_speed)

    @cached_property
    def peak_temperature_rise(self) -> Bounds:
        """Of the winding."""
        return self._opened(self._rise)

    @cached_property
    def _rise(self) -> Bounds:
        """Of the winding, without field weakening."""
        return bounds_of_temperature_rise(self.grid, self.table, self.rms_torque[1])

    def _opened(self, bounds: Bounds) -> Bounds:
        """Without an upper bound where the winding may run away, or a weakened field takes current of its own."""
        is_open = self.table.weakens_field | np.isinf(self._rise[1])
        return bounds[0], np.where(is_open & ~np.isnan(bounds[1]), np.inf, bounds[1])

    @property
    def mean_temperature_rise(self) -> Bounds:
        """Of the winding, at least."""
        motor, place = self.table.motor, self.table.place
        ampere = motor("torque_constant") / motor("dc_torque_constant")
        growth = 1 + motor("copper_coefficient") * (place.ambient_celsius - motor("reference_celsius"))
        heating = self.bare_thermal_resistance * motor("dc_resistance") * growth * ampere**2
        low, high = ((heating * current**2) for current in self.rms_current)
        return low * (1 - 10 * ROUNDING), high * (1 + 10 * ROUNDING)

    @property
    def bare_thermal_resistance(self) -> Array:
        """Of each motor whose time constants are not known, K/W; NaN of the others, and where nothing repeats."""
        resistances = np.full(len(self.table.ratio), np.nan)
        for motor, rows in [] if self.grid.load.why_not_periodic else self.table.by_motor():
            if len(motor.thermal_resistances) and not len(motor.thermal_time_constants):
                resistances[rows] = motor.thermal_resistances.sum()
        return resistances

    @property
    def max_temperature_rise(self) -> Array:
        """Limit of `peak_temperature_rise`."""
        return np.maximum(self.table.motor("max_winding_celsius") - self.table.place.ambient_celsius, 0.0)

    @property
    def peak_current(self) -> Bounds:
        """Of the motor."""
        return self._opened(scaled(self.peak_torque, 1 / self.table.motor("torque_constant")))

    @property
    def rms_current(self) -> Bounds:
        """Of the motor."""
        return self._opened(scaled(self.rms_torque, 1 / self.table.motor("torque_constant")))

    @cached_property
    def _electric(self) -> dict[str, Bounds]:
        found = bounds_of_electric(
            self.grid, self.table, self._winding_growth, self.rms_torque[1], self.peak_torque, self.peak_power
        )
        return {name: self._opened(bounds) for name, bounds in found.items()}

    @property
    def peak_drawn_power(self) -> Bounds:
        """Electric."""
        return self._electric["peak drawn"]

    @property
    def mean_drawn_power(self) -> Bounds:
        """Electric."""
        return self._electric["mean drawn"]

    @property
    def peak_returned_power(self) -> Bounds:
        """Electric."""
        return self._electric["peak returned"]

    @property
    def stored_energy(self) -> Bounds:
        """On the bus."""
        return self._electric["stored"]

    @property
    def mean_braked_power(self) -> Bounds:
        """In the brake resistor."""
        return self._electric["mean braked"]

    @property
    def peaks(self) -> PeakBounds:
        """The peaks that take the longest to compute."""
        voltage = exactly(np.full(len(self.table.ratio), np.nan))
        if not np.isnan(self.limit("drive", "bus_voltage")).all():
            voltage = bounds_of_cool_voltage(self.grid, self.table)
        return PeakBounds(self.peak_torque, self.peak_power, voltage, self.torque_at_speed)

    def _same(self, demand: float) -> Bounds:
        """One number for all pairs."""
        return exactly(np.full(len(self.table.ratio), demand))

    @cached_property
    def _average_by_gearbox(self) -> Array:
        return average_by_gearbox(self.grid, self.table)

    @property
    def average_load_torque(self) -> Bounds:
        """At the gearbox's output."""
        return exactly(self._average_by_gearbox[self.table.gearbox_index])

    @property
    def repeated_torque(self) -> Bounds:
        """At the gearbox's output."""
        gearboxes, cycle = self.table.catalogue.gearboxes, self.grid.load.duration
        factors = np.array([gearbox.impact_factor(cycle) for gearbox in gearboxes])
        return exactly(self.grid.peak_torque * factors[self.table.gearbox_index])

    @property
    def peak_load_torque(self) -> Bounds:
        """At the gearbox's output."""
        return self._same(self.grid.peak_torque)

    @property
    def momentary_torque(self) -> Bounds:
        """At the gearbox's output."""
        return self._same(self.momentary_torque_at_joint)

    @property
    def load_inertia_ratio(self) -> Bounds:
        """Of the load, gears included, to the rotor."""
        load = self.grid.inertia / self.table.ratio**2 + np.nan_to_num(self.table.gearbox("inertia"))
        brake = np.nan_to_num(self.table.motor("brake_inertia")) if self.table.place.with_brake else 0.0
        with np.errstate(divide="ignore"):
            return exactly(load / (self.table.motor("rotor_inertia") + brake))

    @property
    def max_inertia_ratio(self) -> Array:
        """Limit of `load_inertia_ratio`."""
        return np.full(len(self.table.ratio), self.table.place.max_inertia_ratio)

    @property
    def required_life_hours(self) -> Bounds:
        """Of the gearbox."""
        return self._same(self.table.place.required_life_hours)

    @property
    def assured_life_hours(self) -> Array:
        """Of the gearbox."""
        return expected_lives(self.grid, self.table)

    def _of_bearing(self, value: Callable[[BearingLoad, Gearbox], float]) -> Array:
        """A value of each gearbox's bearing, NaN at a joint that slides."""
        loads = ((bearing_load(self.grid.load, gearbox), gearbox) for gearbox in self.table.catalogue.gearboxes)
        found = [np.nan if bearing is None else value(bearing, gearbox) for bearing, gearbox in loads]
        return np.array(found)[self.table.gearbox_index]

    @property
    def peak_tilting_moment(self) -> Bounds:
        """On the output bearing."""
        return exactly(self._of_bearing(lambda bearing, _: bearing.peak_tilting[0]))

    @property
    def peak_axial_force(self) -> Bounds:
        """On the output bearing."""
        return exactly(self._of_bearing(lambda bearing, _: bearing.peak_axial[0]))

    @property
    def peak_radial_force(self) -> Bounds:
        """On the output bearing."""
        return exactly(self._of_bearing(lambda bearing, _: bearing.peak_radial[0]))

    @property
    def safe_static_load(self) -> Bounds:
        """On the output bearing."""
        return exactly(self._of_bearing(BearingLoad.safe_static_load))

    @property
    def bearing_life_hours(self) -> Array:
        """Of the output bearing."""
        return self._of_bearing(BearingLoad.life_hours)

    @property
    def standing_torque(self) -> Bounds:
        """Of the motor at rest, where the gears lose nothing."""
        return exactly(self._standing_load / self.table.ratio)

    @cached_property
    def _standing_load(self) -> float:
        return standing_torque(self.grid.load, 1.0)[0]

    @property
    def stands_loaded(self) -> Array:
        """1 where the motor holds a load at standstill, else NaN."""
        return np.full(len(self.table.ratio), 1.0 if self._standing_load > 0 else np.nan)

    @property
    def max_standing_torque(self) -> Array:
        """Limit of `standing_torque`."""
        return self.table.motor("standstill_torque") * self.table.continuous_share

    @property
    def braked(self) -> Array:
        """1 where a brake is used, else NaN."""
        uses = self.table.place.with_brake or bool(self.grid.load.braked.any())
        return np.full(len(self.table.ratio), 1.0 if uses else np.nan)

    @property
    def unbraked(self) -> Array:
        """The other way round."""
        return np.where(np.isnan(self.braked), 1.0, np.nan)

    @property
    def holding_torque(self) -> Bounds:
        """That the brake must hold."""
        return exactly(holding_torque(self.grid.load, 1.0)[0] / self.table.ratio)

    @property
    def brake_stop_energy(self) -> Bounds:
        """Known from the full assessment alone."""
        return self._open(~np.isnan(self.table.motor("brake_torque")))

    @property
    def brake_wear(self) -> Bounds:
        """Known from the full assessment alone."""
        known = ~np.isnan(self.table.motor("brake_torque")) & ~np.isnan(self.table.place.emergency_stops)
        return self._open(known)

    def _open(self, known: NDArray[np.bool_]) -> Bounds:
        """No bounds: what is known is assessed in full."""
        return np.where(known, 0.0, np.nan), np.where(known, np.inf, np.nan)

    @property
    def emergency_stops(self) -> Bounds:
        """Of the gearbox."""
        return self._same(self.table.place.emergency_stops)

    @property
    def allowed_emergency_stops(self) -> Array:
        """Of the gearbox."""
        peak, place = self.grid.moments.peak_speed, self.table.place
        counts = [
            allowed_rare_peaks(gearbox, input_speed=abs(gearbox.ratio) * peak, duration=place.emergency_duration)
            for gearbox in self.table.catalogue.gearboxes
        ]
        return np.array(counts)[self.table.gearbox_index]
