"""What many drive trains at once ask for, between a lower and an upper bound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.drives import Gearbox
from puma_septic.sizing._bearing import BearingLoad, bearing_load
from puma_septic.sizing._brake import holding_torque
from puma_septic.sizing._gearbox import (
    RULES,
    allowed_rare_peaks,
    average_load_torque,
    expected_life,
    impact_factor,
    lives,
)
from puma_septic.sizing._load_features import LoadGrid
from puma_septic.sizing._pair_features import PairTable
from puma_septic.validation import Array

__all__ = ["Bounds", "PairDemands", "PeakBounds", "expected_lives", "utilisation"]

# Lower and upper bound of a demand, or of a utilisation, each of shape (n_pairs,); NaN: not assessed.
Bounds = tuple[Array, Array]

# What sums in another order may differ by.
_ROUNDING: Final = 1e-9
# Pairs at a time: their torques at all instants stay within a few megabytes.
_BLOCK: Final = 2048
# Instants at which torque is checked against a curve over speed, for the lower bound.
_CURVE_INSTANTS: Final = 96


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
        return _peaks(self.grid, self.table)

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
        return _times(self.peak_torque, self.table.ratio * self.table.stage_reduction)

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
        return _rms(self.grid, self.table.coefficients)

    @property
    def continuous_torque(self) -> Array:
        """Limit of `rms_torque`."""
        return _continuous_torque(self.table, self.table.ratio * self.grid.mean_speed) * self.table.continuous_share

    @property
    def torque_at_speed(self) -> Bounds:
        """As a share of the curve."""
        if self.shared is not None:
            return self.shared.at_speed
        return _torque_at_speed(self.grid, self.table, self.peak_torque[1], self._top_speed)

    @property
    def torque_at_speed_limit(self) -> Array:
        """All of the curve."""
        return np.ones(len(self.table.ratio))

    @property
    def peak_voltage(self) -> Bounds:
        """At the motor's terminals."""
        base = _cool_voltage(self.grid, self.table) if self.shared is None else self.shared.voltage
        return _warm_voltage(self.table, base, self._winding_growth[1], self.peak_torque[1], self.peak_power[1])

    @cached_property
    def _winding_growth(self) -> Bounds:
        return _winding_growth(self.table, self.peak_temperature_rise)

    @property
    def _top_speed(self) -> Array:
        return self.table.ratio * self.grid.moments.peak_speed

    @property
    def peak_speed(self) -> Bounds:
        """Of the motor."""
        return _exact(self._top_speed)

    @property
    def mean_speed(self) -> Bounds:
        """Of the motor."""
        return _exact(self.table.ratio * self.grid.mean_speed)

    @cached_property
    def peak_temperature_rise(self) -> Bounds:
        """Of the winding."""
        return self._with_field(_temperature_rise(self.grid, self.table, self.rms_torque[1]))

    def _with_field(self, bounds: Bounds) -> Bounds:
        """Without an upper bound where the drive may weaken the field, whose current adds to the torque's."""
        return bounds[0], np.where(self.table.weakens_field & ~np.isnan(bounds[1]), np.inf, bounds[1])

    @property
    def mean_temperature_rise(self) -> Bounds:
        """Of the winding, at least."""
        motor, place = self.table.motor, self.table.place
        ampere = motor("torque_constant") / motor("dc_torque_constant")
        growth = 1 + motor("copper_coefficient") * (place.ambient_celsius - motor("reference_celsius"))
        heating = self.bare_thermal_resistance * motor("dc_resistance") * growth * ampere**2
        low, high = ((heating * current**2) for current in self.rms_current)
        return low * (1 - 10 * _ROUNDING), high * (1 + 10 * _ROUNDING)

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
        return self._with_field(_times(self.peak_torque, 1 / self.table.motor("torque_constant")))

    @property
    def rms_current(self) -> Bounds:
        """Of the motor."""
        return self._with_field(_times(self.rms_torque, 1 / self.table.motor("torque_constant")))

    @cached_property
    def _electric(self) -> dict[str, Bounds]:
        found = _electric(
            self.grid, self.table, self._winding_growth, self.rms_torque[1], self.peak_torque, self.peak_power
        )
        return {name: self._with_field(bounds) for name, bounds in found.items()}

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
        voltage = _cool_voltage(self.grid, self.table)
        return PeakBounds(self.peak_torque, self.peak_power, voltage, self.torque_at_speed)

    def _same(self, demand: float) -> Bounds:
        """One number for all pairs."""
        return _exact(np.full(len(self.table.ratio), demand))

    @cached_property
    def _average_by_gearbox(self) -> Array:
        return _average_by_gearbox(self.grid, self.table)

    @property
    def average_load_torque(self) -> Bounds:
        """At the gearbox's output."""
        return _exact(self._average_by_gearbox[self.table.gearbox_index])

    @property
    def repeated_torque(self) -> Bounds:
        """At the gearbox's output."""
        gearboxes, cycle = self.table.catalogue.gearboxes, self.grid.load.duration
        factors = np.array([impact_factor(gearbox, cycle) for gearbox in gearboxes])
        return _exact(self.grid.peak_torque * factors[self.table.gearbox_index])

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
        brake = self.table.motor("brake_inertia") if self.table.place.with_brake else 0.0
        with np.errstate(divide="ignore"):
            return _exact(load / (self.table.motor("rotor_inertia") + brake))

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
        return _exact(self._of_bearing(lambda bearing, _: bearing.peak_tilting[0]))

    @property
    def peak_axial_force(self) -> Bounds:
        """On the output bearing."""
        return _exact(self._of_bearing(lambda bearing, _: bearing.peak_axial[0]))

    @property
    def peak_radial_force(self) -> Bounds:
        """On the output bearing."""
        return _exact(self._of_bearing(lambda bearing, _: bearing.peak_radial[0]))

    @property
    def safe_static_load(self) -> Bounds:
        """On the output bearing."""
        return _exact(self._of_bearing(BearingLoad.safe_static_load))

    @property
    def bearing_life_hours(self) -> Array:
        """Of the output bearing."""
        return self._of_bearing(BearingLoad.life_hours)

    @property
    def standing_torque(self) -> Bounds:
        """Of the motor at rest, where the gears lose nothing."""
        load = self.grid.load
        stands = (load.velocity_sign == 0) & ~load.braked
        return _exact(float(load.torque.by_interval(stands).extrema().peak[0]) / self.table.ratio)

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
        return _exact(holding_torque(self.grid.load, 1.0)[0] / self.table.ratio)

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


def _exact(demand: Array) -> Bounds:
    return demand * (1 - _ROUNDING), demand * (1 + _ROUNDING)


def _rms(grid: LoadGrid, coefficients: Array) -> Bounds:
    """Root of the quadratic form, with the rounding of its terms, which may cancel."""
    square = np.einsum("pi,pi->p", coefficients @ grid.gram, coefficients)
    rounding = 1e-13 * np.einsum("pi,pi->p", np.abs(coefficients) @ np.abs(grid.gram), np.abs(coefficients))
    low, high = np.sqrt(np.maximum(square - rounding, 0.0)), np.sqrt(np.maximum(square, 0.0) + rounding)
    return low * (1 - _ROUNDING), high * (1 + _ROUNDING)


def _times(bounds: Bounds, factor: Array) -> Bounds:
    return bounds[0] * factor, bounds[1] * factor


def utilisation(demand: Bounds, limit: Array, table: PairTable) -> Bounds:
    """Demand over limit; a limit of zero is always too small, and what is not known not assessed.

    Of pairs whose torque is no sum of the features nothing is known before they are assessed in full.

    Returns
    -------
    Bounds
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = (np.where(limit == 0, np.inf, one / limit) for one in demand)
    low, high = np.where(table.is_linear, low, 0.0), np.where(table.is_linear, high, np.inf)
    unknown = np.isnan(limit) | np.isnan(demand[0])
    return np.where(unknown, np.nan, low), np.where(unknown, np.nan, high)


def _peaks(grid: LoadGrid, table: PairTable) -> tuple[Bounds, Bounds]:
    """Largest torque and largest mechanical power."""
    n, slack = table.ratio, _slack(grid, table)
    torque = _largest(table.coefficients, grid.torque_rows)
    power = _largest(table.coefficients, grid.power_rows * grid.power_speeds[:, None]) * n
    return (torque * (1 - _ROUNDING), torque * grid.excess + slack), (
        power * (1 - _ROUNDING), power * grid.excess + slack * n * grid.moments.peak_speed
    )  # fmt: skip


def _slack(grid: LoadGrid, table: PairTable) -> Array:
    """What the remainder of the load's torque is at the motor at most."""
    return np.asarray(table.coefficients[:, 1:4].max(axis=1) * grid.remainder)


def _largest(coefficients: Array, rows: Array) -> Array:
    """Largest magnitude among the instants, for each pair."""
    largest = np.empty(len(coefficients))
    for start in range(0, len(coefficients), _BLOCK):
        values = coefficients[start : start + _BLOCK] @ rows.T
        largest[start : start + _BLOCK] = np.maximum(values.max(axis=1), -values.min(axis=1))
    return largest


def _winding_growth(table: PairTable, rise: Bounds) -> Bounds:
    """Of the resistance over the printed one; 1 where no temperature is known."""
    copper = table.motor("copper_coefficient")
    cool = 1 + copper * (table.place.ambient_celsius - table.motor("reference_celsius"))
    known = ~np.isnan(rise[1])
    with np.errstate(invalid="ignore"):
        warm = cool + np.where(copper > 0, copper * rise[1], 0.0)
    return np.where(known, cool, 1.0) * (1 - _ROUNDING), np.where(known, warm, 1.0) * (1 + _ROUNDING)


def _coolest(table: PairTable) -> Array:
    """Growth of the resistance over the printed one that no load goes below: at the ambient, or none."""
    cool = 1 + table.motor("copper_coefficient") * (table.place.ambient_celsius - table.motor("reference_celsius"))
    return np.asarray(np.minimum(cool, 1.0) * (1 - _ROUNDING))


def _cool_voltage(grid: LoadGrid, table: PairTable) -> Bounds:
    """Also a sum of the features, with more velocity in it; with the coolest winding and without reactance.

    Where current and voltage have one sign a warmer winding needs more; elsewhere it may need any less.
    """
    k_t, resistance = table.motor("dc_torque_constant"), table.motor("dc_resistance") * _coolest(table)
    coefficients = table.coefficients * (resistance / k_t)[:, None]
    coefficients[:, 4] += table.motor("back_emf") * table.ratio
    known = ~np.isnan(coefficients).any(axis=1)
    largest, low = np.full((2, len(coefficients)), np.nan)
    found, at = _largest_at(coefficients[known], grid.torque_rows)
    current = np.einsum("pi,pi->p", table.coefficients[known], grid.torque_rows[at])
    largest[known], low[known] = np.abs(found), np.where(current * found >= 0, np.abs(found), 0.0)
    return low * (1 - _ROUNDING), largest * grid.excess + _slack(grid, table) * resistance / k_t


def _largest_at(coefficients: Array, rows: Array) -> tuple[Array, NDArray[np.int64]]:
    """The value of largest magnitude among the instants, for each pair, and its row."""
    value, at = np.empty(len(coefficients)), np.empty(len(coefficients), dtype=np.int64)
    for start in range(0, len(coefficients), _BLOCK):
        values = coefficients[start : start + _BLOCK] @ rows.T
        own = np.abs(values).argmax(axis=1)
        at[start : start + _BLOCK] = own
        value[start : start + _BLOCK] = values[np.arange(len(own)), own]
    return value, at


def _warm_voltage(table: PairTable, base: Bounds, growth: Array, peak_torque: Array, peak_power: Array) -> Bounds:
    """What the winding's warmth and its reactance add at most.

    The drop over the reactance is at right angles to the other, ``X speed i``, at most X times the peak power over k_t.
    """
    k_t, resistance = table.motor("dc_torque_constant"), table.motor("dc_resistance")
    with np.errstate(invalid="ignore"):
        warmth = np.where(resistance > 0, resistance * (growth - _coolest(table)) / k_t * peak_torque, 0.0 * k_t)
    across = table.motor("reactance_constant") * peak_power / k_t
    high = np.hypot(base[1] + warmth, across) * (1 + _ROUNDING)
    return np.where(table.weakens_field, 0.0 * base[0], base[0]), high


def _continuous_torque(table: PairTable, mean_speed: Array) -> Array:
    """Of the S1 curve where there is one."""
    limit = table.motor("continuous_torque")
    for motor, rows in table.by_motor():
        speeds, torques = motor.continuous_curve.T
        if len(speeds):
            limit[rows] = np.interp(mean_speed[rows], speeds, torques, right=0.0)
    return limit


def _torque_at_speed(grid: LoadGrid, table: PairTable, highest: Array, top_speed: Array) -> Bounds:
    """From below at some instants; from above by the curve's least torque up to the highest speed."""
    low, high = np.full((2, len(top_speed)), np.nan)
    rows = np.vstack([grid.torque_rows, grid.power_rows])
    rows = rows[:: -(-len(rows) // _CURVE_INSTANTS)]
    for motor, own in table.by_motor():
        curve = motor.peak_curve_at(table.bus_voltage(own))
        if not len(curve):
            continue
        end = curve[-1, 0]
        speeds = np.minimum(np.abs(rows[:, 4]) * table.ratio[own, None], end)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = np.abs(table.coefficients[own] @ rows.T) / np.interp(speeds, *curve.T)
            least = np.minimum.accumulate(curve[:, 1])[np.searchsorted(curve[:, 0], top_speed[own], side="right") - 1]
            above = highest[own] / np.minimum(least, np.interp(top_speed[own], *curve.T))
        low[own] = np.nan_to_num(ratios, nan=0.0, posinf=np.inf).max(axis=1) * (1 - _ROUNDING)
        low[own[top_speed[own] > end * (1 + _ROUNDING)]] = np.inf
        high[own] = np.where(top_speed[own] > end * (1 - _ROUNDING), np.inf, np.nan_to_num(above, nan=np.inf))
    return low, high


def _temperature_rise(grid: LoadGrid, table: PairTable, rms: Array) -> Bounds:
    """Temperature rise of the winding: at least its mean without the growth of the resistance.

    At most that mean and the heat of one whole cycle in the winding alone (which is never colder than the
    housing), both with the growth at the peak itself, ``peak <= K (1 + copper (excess + peak))``.
    """
    share, total = np.full((2, len(rms)), np.nan)
    for motor, rows in table.by_motor():
        if len(motor.thermal_time_constants) and not grid.load.why_not_periodic:
            capacity = motor.thermal_time_constants[0] / motor.thermal_resistances[0]
            total[rows] = motor.thermal_resistances.sum()
            share[rows] = total[rows] + grid.load.duration / capacity
    loss = rms**2 * table.motor("dc_resistance") / table.motor("dc_torque_constant") ** 2
    copper, ambient = table.motor("copper_coefficient"), table.place.ambient_celsius
    growth = 1 + copper * (ambient - table.motor("reference_celsius"))
    feedback = 1 - copper * share * loss * (1 + _ROUNDING)
    with np.errstate(divide="ignore", invalid="ignore"):
        high = np.where(feedback > 0, share * loss * growth * (1 + _ROUNDING) / feedback, np.inf)
    return total * loss * growth * (1 - 10 * _ROUNDING), high


def _electric(
    grid: LoadGrid, table: PairTable, growth: Bounds, rms: Array, peak: Bounds, power: Bounds
) -> dict[str, Bounds]:
    """Power and energy at the terminals: mechanical power and copper loss, each bounded by itself."""
    n, c = table.ratio, table.coefficients
    heat = table.motor("dc_resistance") / table.motor("dc_torque_constant") ** 2
    unknown = np.where(np.isnan(heat), np.nan, 0.0)
    with np.errstate(invalid="ignore"):
        cold, hot = heat * growth[0], np.where(heat > 0, heat * growth[1], heat)
    net = n * (c @ grid.with_velocity) + cold * rms**2 * (1 - 10 * _ROUNDING)
    rubbing = n * (c[:, 4] * grid.gram[4, 4] + c[:, 5] * grid.gram[5, 4] + c[:, 6] * grid.gram[6, 4])
    working = n * (c[:, 0] * grid.driving[0] + c[:, 1] * grid.driving[1]) + rubbing
    drawn = working + hot * rms**2
    back = n * (c[:, 0] * grid.driven[0] + c[:, 3] * grid.driven[1]) * (1 + _ROUNDING) + unknown
    slack = 10 * _ROUNDING * (working + cold * rms**2)
    runs_full = (net <= slack) & (not grid.load.why_not_periodic)
    stored = np.where(runs_full, np.inf, back * grid.load.duration) + unknown
    return {
        "peak drawn": (unknown, power[1] + hot * peak[1] ** 2),
        "mean drawn": (np.maximum(net - slack, 0.0), drawn * (1 + _ROUNDING)),
        "peak returned": (unknown, power[1] + unknown),
        "stored": (unknown, stored),
        "mean braked": (unknown, back),
    }


def _average_by_gearbox(grid: LoadGrid, table: PairTable) -> Array:
    """Average torque at each gearbox's output, by the exponent of its kind."""
    gearboxes = table.catalogue.gearboxes
    exponents = np.array([RULES[gearbox.kind].exponent for gearbox in gearboxes])
    own = RULES[""].exponent
    found = {p: average_load_torque(grid.load, p) for p in np.unique(exponents).tolist() if p != own}
    found[own] = grid.average_torque
    return np.array([found[p] for p in exponents.tolist()])


def expected_lives(grid: LoadGrid, table: PairTable) -> Array:
    """Life of each pair's gearbox that a required one is held against, h; it depends on the gearbox alone.

    Returns
    -------
    ndarray, shape (n_pairs,)
    """
    hours = []
    averages = _average_by_gearbox(grid, table).tolist()
    for gearbox, average in zip(table.catalogue.gearboxes, averages, strict=True):
        life = expected_life(
            gearbox.rated_life_hours,
            rated_torque=gearbox.rated_torque,
            rated_speed=gearbox.rated_speed,
            average_torque=average if grid.load.moves else 0.0,
            average_speed=abs(gearbox.ratio) * grid.mean_speed,
            exponent=RULES[gearbox.kind].exponent,
        )
        first = lives(gearbox, life)[0]
        hours.append(life if np.isnan(first) else first)
    return np.array(hours)[table.gearbox_index]
