"""A second way to the verdicts of a selection: sums over samples of each load case, every formula written anew.

Of the package only the load at the joint is taken (torque without drives, velocity, acceleration, inertia), sampled at
midpoints. Nothing of its drive trains, checks, bounds or series is used.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

import puma_septic as ps
from puma_septic.validation import Array

# Midpoints of a cycle: sums are right to a millionth.
SAMPLES = 6000
# A pair this close to a limit is left to the exact series.
TOO_CLOSE = 2e-3


@dataclass(frozen=True, eq=False)
class Sampled:
    """One joint in one load case."""

    case: ps.sizing.LoadCase
    joint: int

    @cached_property
    def t(self) -> Array:
        duration = self.case.cycle.duration
        return (np.arange(SAMPLES) + 0.5) * duration / SAMPLES

    @cached_property
    def load(self) -> tuple[Array, Array, Array, Array]:
        """Torque, velocity, acceleration and whether a brake holds, at the samples."""
        cycle, j = self.case.cycle, self.joint
        torque = cycle.load_torque(self.t)[:, j]
        v, a = (cycle.trajectory(self.t, order=k)[:, j] for k in (1, 2))
        scale = np.abs(cycle.load_torque(self.t)).max()
        torque = np.where(np.abs(torque) < 1e-12 * scale, 0.0, torque)
        still = np.abs(v) < 1e-9
        interval = np.searchsorted(cycle.load_torque.breaks[1:-1], self.t)
        return torque, np.where(still, 0.0, v), np.where(still, 0.0, a), cycle.braked[interval]

    @cached_property
    def inertia(self) -> float:
        return float(self.case.cycle.inertia(self.t)[:, self.joint].max())


def utilisations(sampled: Sampled, catalogue: ps.Catalogue, place: ps.Drivetrain) -> dict[str, Array]:
    """Of each check by every pair; NaN where it is not known."""
    torque, v, a, braked = sampled.load
    m = {
        name: np.array([getattr(motor, name) for motor in catalogue.motors])[catalogue.motor_index]
        for name in (
            "rotor_inertia", "viscous_friction", "coulomb_friction", "torque_constant", "resistance", "peak_torque",
            "continuous_torque", "max_speed", "peak_power", "max_winding_celsius", "copper_coefficient",
            "reference_celsius",
        )
    }  # fmt: skip
    g = {
        name: np.array([getattr(gear, name) for gear in catalogue.gearboxes])[catalogue.gearbox_index]
        for name in (
            "ratio", "efficiency", "backward_efficiency", "inertia", "no_load_torque", "rated_torque", "rated_speed",
            "rated_life_hours", "max_average_torque", "max_repeated_torque", "max_momentary_torque",
            "max_average_input_speed", "max_input_speed",
        )
    }  # fmt: skip
    drive, n = place.drive, np.abs(g["ratio"])[:, None]
    forward = np.where(np.isnan(g["efficiency"]), 1.0, g["efficiency"])
    backward = np.where(np.isnan(g["backward_efficiency"]), forward, g["backward_efficiency"])
    backward = np.where(np.isnan(g["efficiency"]), 1.0, backward)
    power = torque * v
    passed = np.where(power > 0, 1 / forward[:, None], np.where(power < 0, backward[:, None], 1.0))
    coulomb = np.nan_to_num(m["coulomb_friction"]) + np.nan_to_num(g["no_load_torque"])
    inertia = np.nan_to_num(m["rotor_inertia"]) + np.nan_to_num(g["inertia"])
    motor = (
        inertia[:, None] * n * a
        + passed * torque / n * ~braked
        + np.nan_to_num(m["viscous_friction"])[:, None] * n * v
        + coulomb[:, None] * np.sign(v)
    )
    speed = n * v
    k_t, resistance = m["torque_constant"][:, None], m["resistance"][:, None]
    peak, rms = np.abs(motor).max(axis=1), np.sqrt((motor**2).mean(axis=1))
    top, mean = np.abs(speed).max(axis=1), np.abs(speed).mean(axis=1)
    if sampled.case.cycle.is_periodic:
        rise, warmth = _rise(motor, catalogue, place.ambient_celsius, sampled)
        # As warm as the winding is in the steady cycle, where that is known; else as its sheet has it.
        excess = place.ambient_celsius - m["reference_celsius"][:, None] + warmth
        resistance = resistance * np.where(np.isnan(warmth), 1.0, 1 + m["copper_coefficient"][:, None] * excess)
    else:
        rise = np.nan
    electric = motor * speed + resistance * (motor / k_t) ** 2
    moving = np.abs(v).sum() > 0
    average = (np.abs(v) * np.abs(torque) ** 3).sum() / np.abs(v).sum() if moving else np.nan
    average = average ** (1 / 3)
    largest = np.abs(torque).max()
    momentary = np.fmax(place.momentary_torque, largest if sampled.case.is_rare else np.nan)
    limits = {
        "motor torque": (peak, m["peak_torque"]),
        "RMS motor torque at mean speed": (rms, _continuous(catalogue, mean)),
        "motor torque at speed": (_at_speed(catalogue, motor, speed), 1.0),
        "voltage at torque and speed": (
            np.abs(resistance * motor / k_t + k_t * speed).max(axis=1), _voltage(catalogue, place)
        ),
        "motor speed": (top, m["max_speed"]),
        "motor power": (np.abs(motor * speed).max(axis=1), m["peak_power"]),
        "winding temperature rise": (rise, np.maximum(m["max_winding_celsius"] - place.ambient_celsius, 0.0)),
        "load inertia over rotor inertia": (
            (sampled.inertia / n[:, 0] ** 2 + np.nan_to_num(g["inertia"])) / m["rotor_inertia"], place.max_inertia_ratio
        ),
        "peak current": (peak / k_t[:, 0], drive.peak_current),
        "RMS current": (rms / k_t[:, 0], drive.continuous_current),
        "drawn electric power": (np.maximum(electric.max(axis=1), 0.0), drive.peak_power),
        "mean drawn electric power": (np.maximum(electric, 0.0).mean(axis=1), drive.continuous_power),
        "returned electric power": (np.maximum(-electric.min(axis=1), 0.0), drive.peak_regenerated_power),
        "gearbox average torque": (average, g["max_average_torque"]),
        "gearbox repeated peak torque": (largest, g["max_repeated_torque"]),
        "gearbox momentary peak torque": (momentary, g["max_momentary_torque"]),
        "gearbox average input speed": (mean, g["max_average_input_speed"]),
        "gearbox input speed": (top, g["max_input_speed"]),
    }  # fmt: skip
    with np.errstate(divide="ignore", invalid="ignore"):
        uses = {name: np.broadcast_to(demand / limit, (len(peak),)) for name, (demand, limit) in limits.items()}
        load = average if moving else 0.0
        life = g["rated_life_hours"] * (g["rated_speed"] / mean) * (g["rated_torque"] / load) ** 3
    if sampled.case.is_rare:
        uses = {name: use for name, use in uses.items() if name in ps.sizing._load_cases.RARE_CHECKS}
    return uses | {"life": life}


def _voltage(catalogue: ps.Catalogue, place: ps.Drivetrain) -> Array:
    own = np.array([drive.bus_voltage for drive in catalogue.drives or [ps.Drive()] * len(catalogue.motors)])
    return np.where(np.isnan(place.drive.bus_voltage), own, place.drive.bus_voltage)[catalogue.motor_index]


def _continuous(catalogue: ps.Catalogue, mean: Array) -> Array:
    limits = []
    for k, i in enumerate(catalogue.motor_index.tolist()):
        motor = catalogue.motors[i]
        curve = motor.continuous_curve
        limits.append(np.interp(mean[k], *curve.T, right=0.0) if len(curve) else motor.continuous_torque)
    return np.array(limits)


def _at_speed(catalogue: ps.Catalogue, motor: Array, speed: Array) -> Array:
    uses = []
    for k, i in enumerate(catalogue.motor_index.tolist()):
        curve = catalogue.motors[i].peak_curve
        with np.errstate(divide="ignore", invalid="ignore"):
            limit = np.interp(np.abs(speed[k]), *curve.T, right=0.0) if len(curve) else np.nan
            uses.append(np.max(np.abs(motor[k]) / limit))
    return np.array(uses)


def _rise(motor: Array, catalogue: ps.Catalogue, ambient: float, sampled: Sampled) -> tuple[Array, Array]:
    """Winding temperature of the steady cycle over ambient, by Crank-Nicolson steps: the highest, and at the samples.

    Infinite, and NaN at the samples, where it runs away.
    """
    dt = sampled.case.cycle.duration / SAMPLES
    rises, warmth = np.full(len(motor), np.nan), np.full(motor.shape, np.nan)
    for nodes in (1, 2):
        rows = [
            k
            for k, i in enumerate(catalogue.motor_index.tolist())
            if len(catalogue.motors[i].thermal_resistances) == nodes
        ]
        if rows:
            parts = [catalogue.motors[i] for i in catalogue.motor_index[rows].tolist()]
            rises[rows], warmth[rows] = _steady(motor[rows], parts, ambient, dt)
    return rises, warmth


def _steady(motor: Array, parts: list[ps.Motor], ambient: float, dt: float) -> tuple[Array, Array]:
    resistances = np.array([part.thermal_resistances for part in parts])
    capacities = np.array([part.thermal_time_constants for part in parts]) / resistances
    n, nodes = resistances.shape
    loss = motor**2 * np.array([part.resistance / part.torque_constant**2 for part in parts])[:, None]
    copper = np.array([part.copper_coefficient for part in parts])
    excess = ambient - np.array([part.reference_celsius for part in parts])
    conduction = np.zeros((n, nodes, nodes))
    for i in range(nodes):
        for first, second in ((i, i + 1),):
            conduction[:, first, first] -= 1 / resistances[:, i]
            if second < nodes:
                conduction[:, first, second] += 1 / resistances[:, i]
                conduction[:, second, first] += 1 / resistances[:, i]
                conduction[:, second, second] -= 1 / resistances[:, i]
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


def stresses(
    cases: tuple[ps.sizing.LoadCase, ...],
    j: int,
    catalogue: ps.Catalogue,
    place: ps.Drivetrain,
    margins: dict[str, float],
) -> Array:
    """Of each pair the largest use over what may be used, in all cases; 0 where nothing is known."""
    concerned = [case for case in cases if not case.joints or case.cycle.joint_names[j] in case.joints]
    shares = np.array([case.share for case in concerned]) / sum(case.share for case in cases)
    worst = np.zeros(catalogue.n_pairs)
    used = np.zeros(catalogue.n_pairs)
    for case, share in zip(concerned, shares, strict=True):
        uses = utilisations(Sampled(case, j), catalogue, place)
        life = uses.pop("life")
        if share:
            used = used + share / life
        for name, use in uses.items():
            worst = np.fmax(worst, use / (1 - margins.get(name, margins.get("all", 0.0))))
    allowed = 1 - margins.get("gearbox life", margins.get("all", 0.0))
    return np.fmax(worst, place.required_life_hours * used / allowed)


def lacks(catalogue: ps.Catalogue) -> Array:
    """Whether each pair lacks one of the least set, by its definition in words."""
    poor_motor = [
        np.isnan(m.rotor_inertia)
        or (np.isnan(m.continuous_torque) and not len(m.continuous_curve))
        or (np.isnan(m.peak_torque) and not len(m.peak_curve))
        or (np.isnan(m.max_speed) and not len(m.peak_curve))
        for m in catalogue.motors
    ]
    poor_gear = [
        np.isnan([g.max_average_torque, g.max_repeated_torque, g.efficiency]).any() for g in catalogue.gearboxes
    ]
    return np.array(poor_motor)[catalogue.motor_index] | np.array(poor_gear)[catalogue.gearbox_index]
