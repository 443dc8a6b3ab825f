"""Bounds of what many drive trains at once need, from sums of the load's features."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.sizing._gearbox import (
    RULES,
    average_load_torque,
    expected_life,
    lives,
)
from puma_septic.sizing._load_features import LoadGrid
from puma_septic.sizing._pair_features import PairTable
from puma_septic.validation import Array

__all__ = [
    "ROUNDING",
    "Bounds",
    "average_by_gearbox",
    "bounds_of_cool_voltage",
    "bounds_of_electric",
    "bounds_of_peaks",
    "bounds_of_rms",
    "bounds_of_temperature_rise",
    "bounds_of_torque_at_speed",
    "bounds_of_warm_voltage",
    "bounds_of_winding_growth",
    "continuous_limit",
    "exactly",
    "expected_lives",
    "scaled",
    "utilisation",
]

# Lower and upper bound of a demand, or of a utilisation, each of shape (n_pairs,); NaN: not assessed.
Bounds = tuple[Array, Array]

# What sums in another order may differ by.
ROUNDING: Final = 1e-9
# Pairs at a time: their torques at all instants stay within a few megabytes.
_BLOCK: Final = 2048
# Instants at which torque is checked against a curve over speed, for the lower bound.
_CURVE_INSTANTS: Final = 96


def exactly(demand: Array) -> Bounds:
    return demand * (1 - ROUNDING), demand * (1 + ROUNDING)


def bounds_of_rms(grid: LoadGrid, coefficients: Array) -> Bounds:
    """Root of the quadratic form, with the rounding of its terms, which may cancel."""
    square = np.einsum("pi,pi->p", coefficients @ grid.gram, coefficients)
    rounding = 1e-13 * np.einsum("pi,pi->p", np.abs(coefficients) @ np.abs(grid.gram), np.abs(coefficients))
    low, high = np.sqrt(np.maximum(square - rounding, 0.0)), np.sqrt(np.maximum(square, 0.0) + rounding)
    return low * (1 - ROUNDING), high * (1 + ROUNDING)


def scaled(bounds: Bounds, factor: Array) -> Bounds:
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


def bounds_of_peaks(grid: LoadGrid, table: PairTable) -> tuple[Bounds, Bounds]:
    """Largest torque and largest mechanical power."""
    n, slack = table.ratio, _slack(grid, table)
    torque = _largest(table.coefficients, grid.torque_rows)
    power = _largest(table.coefficients, grid.power_rows * grid.power_speeds[:, None]) * n
    return (torque * (1 - ROUNDING), torque * grid.excess + slack), (
        power * (1 - ROUNDING), power * grid.excess + slack * n * grid.moments.peak_speed
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


def bounds_of_winding_growth(table: PairTable, rise: Bounds) -> Bounds:
    """Of the resistance over the printed one; 1 where no temperature is known."""
    copper = table.motor("copper_coefficient")
    cool = 1 + copper * (table.place.ambient_celsius - table.motor("reference_celsius"))
    known = ~np.isnan(rise[1])
    with np.errstate(invalid="ignore"):
        warm = cool + np.where(copper > 0, copper * rise[1], 0.0)
    return np.where(known, cool, 1.0) * (1 - ROUNDING), np.where(known, warm, 1.0) * (1 + ROUNDING)


def _coolest(table: PairTable) -> Array:
    """Growth of the resistance over the printed one that no load goes below: at the ambient, or none."""
    cool = 1 + table.motor("copper_coefficient") * (table.place.ambient_celsius - table.motor("reference_celsius"))
    return np.asarray(np.minimum(cool, 1.0) * (1 - ROUNDING))


def bounds_of_cool_voltage(grid: LoadGrid, table: PairTable) -> Bounds:
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
    return low * (1 - ROUNDING), largest * grid.excess + _slack(grid, table) * resistance / k_t


def _largest_at(coefficients: Array, rows: Array) -> tuple[Array, NDArray[np.int64]]:
    """The value of largest magnitude among the instants, for each pair, and its row."""
    value, at = np.empty(len(coefficients)), np.empty(len(coefficients), dtype=np.int64)
    for start in range(0, len(coefficients), _BLOCK):
        values = coefficients[start : start + _BLOCK] @ rows.T
        own = np.abs(values).argmax(axis=1)
        at[start : start + _BLOCK] = own
        value[start : start + _BLOCK] = values[np.arange(len(own)), own]
    return value, at


def bounds_of_warm_voltage(
    table: PairTable, base: Bounds, growth: Array, peak_torque: Array, peak_power: Array
) -> Bounds:
    """What the winding's warmth and its reactance add at most.

    The drop over the reactance is at right angles to the other, ``X speed i``, at most X times the peak power over k_t.
    """
    k_t, resistance = table.motor("dc_torque_constant"), table.motor("dc_resistance")
    with np.errstate(invalid="ignore"):
        warmth = np.where(resistance > 0, resistance * (growth - _coolest(table)) / k_t * peak_torque, 0.0 * k_t)
    across = table.motor("reactance_constant") * peak_power / k_t
    high = np.hypot(base[1] + warmth, across) * (1 + ROUNDING)
    return np.where(table.weakens_field, 0.0 * base[0], base[0]), high


def continuous_limit(table: PairTable, mean_speed: Array) -> Array:
    """Of the S1 curve where there is one."""
    limit = table.motor("continuous_torque")
    for motor, rows in table.by_motor():
        curve = motor.continuous_curve_at(table.bus_voltage(rows))
        if len(curve):
            limit[rows] = np.interp(mean_speed[rows], curve[:, 0], curve[:, 1], right=0.0)
    return limit


def bounds_of_torque_at_speed(grid: LoadGrid, table: PairTable, highest: Array, top_speed: Array) -> Bounds:
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
        low[own] = np.nan_to_num(ratios, nan=0.0, posinf=np.inf).max(axis=1) * (1 - ROUNDING)
        low[own[top_speed[own] > end * (1 + ROUNDING)]] = np.inf
        high[own] = np.where(top_speed[own] > end * (1 - ROUNDING), np.inf, np.nan_to_num(above, nan=np.inf))
    return low, high


def bounds_of_temperature_rise(grid: LoadGrid, table: PairTable, rms: Array) -> Bounds:
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
    feedback = 1 - copper * share * loss * (1 + ROUNDING)
    with np.errstate(divide="ignore", invalid="ignore"):
        high = np.where(feedback <= 0, np.inf, share * loss * growth * (1 + ROUNDING) / feedback)
    return total * loss * growth * (1 - 10 * ROUNDING), high


def bounds_of_electric(
    grid: LoadGrid, table: PairTable, growth: Bounds, rms: Array, peak: Bounds, power: Bounds
) -> dict[str, Bounds]:
    """Power and energy at the terminals: mechanical power and copper loss, each bounded by itself."""
    n, c = table.ratio, table.coefficients
    heat = table.motor("dc_resistance") / table.motor("dc_torque_constant") ** 2
    unknown = np.where(np.isnan(heat), np.nan, 0.0)
    with np.errstate(invalid="ignore"):
        cold, hot = heat * growth[0], np.where(heat > 0, heat * growth[1], heat)
    net = n * (c @ grid.with_velocity) + cold * rms**2 * (1 - 10 * ROUNDING)
    rubbing = n * (c[:, 4] * grid.gram[4, 4] + c[:, 5] * grid.gram[5, 4] + c[:, 6] * grid.gram[6, 4])
    working = n * (c[:, 0] * grid.driving[0] + c[:, 1] * grid.driving[1]) + rubbing
    drawn = working + hot * rms**2
    back = n * (c[:, 0] * grid.driven[0] + c[:, 3] * grid.driven[1]) * (1 + ROUNDING) + unknown
    slack = 10 * ROUNDING * (working + cold * rms**2)
    runs_full = (net <= slack) & (not grid.load.why_not_periodic)
    stored = np.where(runs_full, np.inf, back * grid.load.duration) + unknown
    return {
        "peak drawn": (unknown, power[1] + hot * peak[1] ** 2),
        "mean drawn": (np.maximum(net - slack, 0.0), drawn * (1 + ROUNDING)),
        "peak returned": (unknown, power[1] + unknown),
        "stored": (unknown, stored),
        "mean braked": (unknown, back),
    }


def average_by_gearbox(grid: LoadGrid, table: PairTable) -> Array:
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
    averages = average_by_gearbox(grid, table).tolist()
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
