"""Use of every limit by many drive trains at once, between a lower and an upper bound."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.sizing.gearbox import expected_life
from puma_septic.sizing.grids import LoadGrid
from puma_septic.sizing.pairs import PairTable
from puma_septic.validation import Array

__all__ = ["Bounds", "utilisation_bounds"]

# Lower and upper bound of a demand, or of a utilisation, each of shape (n_pairs,); NaN: not assessed.
Bounds = tuple[Array, Array]

# What sums in another order may differ by.
_ROUNDING: Final = 1e-9
# Pairs at a time: their torques at all instants stay within a few megabytes.
_BLOCK: Final = 2048
# Instants at which torque is held against a curve over speed, for the lower bound.
_CURVE_INSTANTS: Final = 96


def utilisation_bounds(grid: LoadGrid, table: PairTable) -> dict[str, Bounds]:
    """Utilisation of each check that can reject, by the names of `assess_joint`.

    Of pairs whose torque is no sum of the features nothing is known before they are assessed in full.

    Returns
    -------
    dict of str to Bounds
    """
    n, speed, mean = table.ratio, table.ratio * grid.moments.peak_speed, table.ratio * grid.mean_speed
    rms = _rms(grid, table.coefficients)
    peak, power = _peaks(grid, table)
    k_t = table.motor("torque_constant")
    load = np.full(len(n), grid.peak_torque)
    bounds = {
        "actuator effort at the joint": _use(_times(peak, n), table.max_effort),
        "motor torque": _use(peak, table.motor("peak_torque")),
        "RMS motor torque at mean speed": _use(rms, _continuous_torque(table, mean)),
        "motor torque at speed": _torque_at_speed(grid, table, peak[1], speed),
        "voltage at torque and speed": _use(_voltage(grid, table), table.drive("bus_voltage")),
        "motor speed": _use(_exact(speed), table.motor("max_speed")),
        "motor power": _use(power, table.motor("peak_power")),
        "winding temperature rise": _winding(grid, table, rms[1]),
        "peak current": _use(_times(peak, 1 / k_t), table.drive("peak_current")),
        "RMS current": _use(_times(rms, 1 / k_t), table.drive("continuous_current")),
        **_electric(grid, table, rms[1], peak, power),
        "gearbox average torque": _use(_exact(n * 0 + grid.average_torque), table.gearbox("max_average_torque")),
        "gearbox repeated peak torque": _use(_exact(load), table.gearbox("max_repeated_torque")),
        "gearbox momentary peak torque": _use(
            _exact(n * 0 + table.place.momentary_torque), table.gearbox("max_momentary_torque")
        ),
        "gearbox average input speed": _use(_exact(mean), table.gearbox("max_average_input_speed")),
        "gearbox input speed": _use(_exact(speed), table.gearbox("max_input_speed")),
        "gearbox life": _use(_exact(n * 0 + table.place.required_life_hours), _life(grid, table)),
    }
    return {name: _opened(pair, table.is_linear) for name, pair in bounds.items()}


def _opened(bounds: Bounds, is_linear: NDArray[np.bool_]) -> Bounds:
    """Zero and infinity where the bounds do not hold; what is not assessed at all stays so."""
    low, high = bounds
    holds = is_linear | np.isnan(high)
    return np.where(holds, low, 0.0), np.where(holds, high, np.inf)


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


def _use(demand: Bounds, limit: Array) -> Bounds:
    """Demand over limit; a limit of zero is always too small."""
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = (np.where(limit == 0, np.inf, one / limit) for one in demand)
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


def _voltage(grid: LoadGrid, table: PairTable) -> Bounds:
    """Also a sum of the features, with more velocity in it."""
    k_t, resistance = table.motor("torque_constant"), table.motor("resistance")
    coefficients = table.coefficients * (resistance / k_t)[:, None]
    coefficients[:, 4] += k_t * table.ratio
    known = ~np.isnan(coefficients).any(axis=1)
    largest = np.full(len(coefficients), np.nan)
    largest[known] = _largest(coefficients[known], grid.torque_rows)
    return largest * (1 - _ROUNDING), largest * grid.excess + _slack(grid, table) * resistance / k_t


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
        curve = motor.peak_curve
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


def _winding(grid: LoadGrid, table: PairTable, rms: Array) -> Bounds:
    """Temperature rise of the winding: at least its mean without the growth of the resistance.

    At most that mean and the heat of one whole cycle in the winding alone (which is never colder than the
    housing), both with the growth at the peak itself, ``peak <= K (1 + copper (excess + peak))``.
    """
    share, total = np.full((2, len(rms)), np.nan)
    for motor, rows in table.by_motor():
        if len(motor.thermal_resistances) and not grid.load.why_not_periodic:
            capacity = motor.thermal_time_constants[0] / motor.thermal_resistances[0]
            total[rows] = motor.thermal_resistances.sum()
            share[rows] = total[rows] + grid.load.duration / capacity
    loss = rms**2 * table.motor("resistance") / table.motor("torque_constant") ** 2
    copper, ambient = table.motor("copper_coefficient"), table.place.ambient_celsius
    growth = 1 + copper * (ambient - table.motor("reference_celsius"))
    feedback = 1 - copper * share * loss * (1 + _ROUNDING)
    with np.errstate(divide="ignore", invalid="ignore"):
        high = np.where(feedback > 0, share * loss * growth * (1 + _ROUNDING) / feedback, np.inf)
    limit = np.maximum(table.motor("max_winding_celsius") - ambient, 0.0)
    return _use((total * loss * growth * (1 - 10 * _ROUNDING), high), limit)


def _electric(grid: LoadGrid, table: PairTable, rms: Array, peak: Bounds, power: Bounds) -> dict[str, Bounds]:
    """Power and energy at the terminals: mechanical power and copper loss, each bounded by itself."""
    n, c = table.ratio, table.coefficients
    heat = table.motor("resistance") / table.motor("torque_constant") ** 2
    net = n * (c @ grid.with_velocity) + heat * rms**2
    unknown, gone = np.where(np.isnan(heat), np.nan, 0.0), heat * rms**2
    rubbing = n * (c[:, 4] * grid.gram[4, 4] + c[:, 5] * grid.gram[5, 4] + c[:, 6] * grid.gram[6, 4])
    drawn = n * (c[:, 0] * grid.driving[0] + c[:, 1] * grid.driving[1]) + rubbing + gone
    back = n * (c[:, 0] * grid.driven[0] + c[:, 3] * grid.driven[1]) * (1 + _ROUNDING) + unknown
    runs_full = (net <= 10 * _ROUNDING * drawn) & (not grid.load.why_not_periodic)
    cycle = grid.load.duration
    no_resistor = np.isnan(table.drive("brake_resistor_power"))
    stored = np.where(runs_full, np.inf, back * cycle) + unknown
    return {
        "drawn electric power": _use((unknown, power[1] + heat * peak[1] ** 2), table.drive("peak_power")),
        "mean drawn electric power": _use(
            (np.maximum(net - 10 * _ROUNDING * drawn, 0.0), drawn * (1 + _ROUNDING)), table.drive("continuous_power")
        ),
        "returned electric power": _use((unknown, power[1] + unknown), table.drive("peak_regenerated_power")),
        "returned energy on the bus": _use(
            (unknown, stored), np.where(no_resistor, table.drive("storable_energy"), np.nan)
        ),
        "mean brake-resistor power": _use((unknown, back), table.drive("brake_resistor_power")),
    }


def _life(grid: LoadGrid, table: PairTable) -> Array:
    """Expected life, h; it depends on the gearbox alone."""
    torque = grid.average_torque if grid.load.moves else 0.0
    lives = [
        expected_life(
            gearbox.rated_life_hours,
            rated_torque=gearbox.rated_torque,
            rated_speed=gearbox.rated_speed,
            average_torque=torque,
            average_speed=abs(gearbox.ratio) * grid.mean_speed,
        )
        for gearbox in table.catalogue.gearboxes
    ]
    return np.array(lives)[table.catalogue.gearbox_index]
