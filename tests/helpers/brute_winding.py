"""The electric side of a sampled motor: current, winding temperature, voltage, power and what the bus keeps, anew."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from puma_septic.validation import Array

# A sinusoidal current of one ampere, effective or peak, heats three phases by this many times the resistance between
# two lines; of direct current by once.
HEAT = {"dc": 1.0, "rms": 1.5, "peak": 0.75}
LINES = {"line-line": 1.0, "phase": 2.0}
# The largest voltage between two lines per printed volt.
LARGEST = {"peak line-line": 1.0, "rms line-line": 2**0.5, "peak phase": 3**0.5, "rms phase": 6**0.5}


class Electric(NamedTuple):
    """By pair; voltage, current (as the sheet counts it) and power at the samples too; J in one cycle."""

    voltage: Array
    current: Array
    power: Array
    rise: Array
    mean_rise: Array
    stored: Array
    braked: Array


def electric(d: Any) -> Electric:
    m, ambient, load = d.motor, d.place.ambient_celsius, d.load
    per_ampere = np.sqrt([HEAT[kind] for kind in m.current.tolist()])
    resistance = m.resistance * np.array([LINES[kind] for kind in m.winding.tolist()])
    current = d.torque / m.torque_constant[:, None]
    cold = (current * per_ampere[:, None]) ** 2 * resistance[:, None]
    growth = 1 + m.copper_coefficient * (ambient - m.reference_celsius)
    rise, warmth = np.full(len(d.n), np.nan), np.full(cold.shape, np.nan)
    mean_rise = np.full(len(d.n), np.nan)
    if load.repeats:
        rise, warmth = _rises(cold, m.parts, ambient, load.step)
        bare = [
            sum(one.thermal_resistances) if len(one.thermal_resistances) > len(one.thermal_time_constants) else np.nan
            for one in m.parts
        ]
        mean_rise = np.array(bare) * growth * cold.mean(axis=1)
    warm = np.where(np.isnan(warmth), 1.0, growth[:, None] + m.copper_coefficient[:, None] * warmth)
    power = d.torque * d.speed + cold * warm
    stored, braked = _bus(power, load, d.place.drive)
    voltage = _voltage(d, per_ampere, resistance[:, None] * warm)
    return Electric(voltage, np.abs(current), power, rise, mean_rise, stored, braked)


def _voltage(d: Any, per_ampere: Array, resistance: Array) -> Array:
    """Peak between two lines: along the torque's current, and a quarter turn off by the reactance."""
    m = d.motor
    emf = m.torque_constant / per_ampere
    stated = m.voltage_constant * np.array([LARGEST[kind] for kind in m.voltage.tolist()])
    emf = np.where(np.isnan(stated), emf, stated)
    current = d.torque * (per_ampere / m.torque_constant)[:, None]
    lines = np.array([LINES[kind] for kind in m.winding.tolist()])
    reactance = np.nan_to_num(m.pole_pairs * m.inductance * lines)
    along = resistance * current + emf[:, None] * d.speed
    return np.hypot(along, np.nan_to_num(reactance[:, None] * d.speed * current))


def _bus(power: Array, load: Any, drive: Any) -> tuple[Array, Array]:
    """The most that a bus without bound would keep, and what goes into the resistor of one with a bound."""
    room = float(np.nan_to_num(drive.storable_energy))
    flows = power * load.step
    net = flows.sum(axis=1)
    never_empty = load.repeats & (-net > 1e-9 * np.abs(flows).sum(axis=1))
    stored = _filled(flows, _filled(flows, 0.0, np.inf)[0] if load.repeats else 0.0, np.inf)[1]
    stored = np.where(never_empty, np.inf, stored)
    start = np.where(never_empty, room, 0.0)
    if load.repeats:
        start = _filled(flows, start, room)[0]
    braked = _filled(flows, start, room)[2]
    unknown = np.isnan(net)
    return np.where(unknown, np.nan, stored), np.where(unknown, np.nan, braked)


def _filled(flows: Array, start: Array | float, room: float) -> tuple[Array, Array, Array]:
    """Charge at the end, its largest, and what did not fit."""
    charge = np.broadcast_to(start, len(flows)).copy()
    most, lost = charge.copy(), np.zeros(len(flows))
    for flow in flows.T:
        charge = np.maximum(charge - flow, 0.0)
        lost += np.maximum(charge - room, 0.0)
        charge = np.minimum(charge, room)
        most = np.maximum(most, charge)
    return charge, most, lost


def _rises(cold: Array, motors: list[Any], ambient: float, step: float) -> tuple[Array, Array]:
    """Winding temperature of the steady cycle over ambient, by Crank-Nicolson steps: the highest, and at the samples.

    Infinite, and NaN at the samples, where it runs away.
    """
    rises, warmth = np.full(len(cold), np.nan), np.full(cold.shape, np.nan)
    for nodes in (1, 2):
        rows = [k for k, one in enumerate(motors) if len(one.thermal_time_constants) == nodes]
        if rows:
            rises[rows], warmth[rows] = _steady(cold[rows], [motors[k] for k in rows], ambient, step)
    return rises, warmth


def _steady(loss: Array, parts: list[Any], ambient: float, dt: float) -> tuple[Array, Array]:
    resistances = np.array([part.thermal_resistances for part in parts])
    capacities = np.array([part.thermal_time_constants for part in parts]) / resistances
    n, nodes = resistances.shape
    copper = np.array([part.copper_coefficient for part in parts])
    excess = ambient - np.array([part.reference_celsius for part in parts])
    conduction = np.zeros((n, nodes, nodes))
    for i in range(nodes):
        conduction[:, i, i] -= 1 / resistances[:, i]
        if i + 1 < nodes:
            conduction[:, i, i + 1] += 1 / resistances[:, i]
            conduction[:, i + 1, i] += 1 / resistances[:, i]
            conduction[:, i + 1, i + 1] -= 1 / resistances[:, i]
    identity = np.eye(nodes)
    state, offset = np.broadcast_to(identity, (n, nodes, nodes)).copy(), np.zeros((n, nodes, 1))
    steps = []
    for k in range(loss.shape[1]):
        a = conduction.copy()
        a[:, 0, 0] += copper * loss[:, k]
        a /= capacities[:, :, None]
        heat = np.zeros((n, nodes, 1))
        heat[:, 0, 0] = loss[:, k] * (1 + copper * excess) / capacities[:, 0]
        left = np.linalg.inv(identity - a * dt / 2)
        steps.append((left @ (identity + a * dt / 2), left @ (heat * dt)))
        state, offset = steps[-1][0] @ state, steps[-1][0] @ offset + steps[-1][1]
    runs_away = np.abs(np.linalg.eigvals(np.nan_to_num(state))).max(axis=1) >= 1
    solvable = np.where(runs_away[:, None, None], 0.0, state)
    now = np.linalg.solve(identity - np.nan_to_num(solvable), offset)
    highest = now[:, 0, 0]
    at_samples = np.empty((n, len(steps)))
    for k, (matrix, shift) in enumerate(steps):
        before, now = now, matrix @ now + shift
        at_samples[:, k] = (before + now)[:, 0, 0] / 2
        highest = np.maximum(highest, now[:, 0, 0])
    unknown = np.isnan(state).any(axis=(1, 2))
    at_samples[unknown | runs_away] = np.nan
    return np.where(unknown, np.nan, np.where(runs_away, np.inf, highest)), at_samples
