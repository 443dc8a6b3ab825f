"""A second way to the verdicts of a selection: sums over samples of each load case, every formula written anew.

Of the package only the load at the joint is taken (torque without drives, gravity's part, wrench, velocity,
acceleration, inertia), sampled at midpoints. Nothing of its drive trains, checks, bounds or series is used.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import puma_septic as ps
from helpers.brute_winding import Electric, electric
from puma_septic.validation import Array

# Midpoints of a cycle: sums are right to a millionth.
SAMPLES = 6000
# A pair this close to a limit is left to the exact series.
TOO_CLOSE = 2e-3


@dataclass(frozen=True, eq=False)
class Load:
    """What one joint's gearbox turns in one load case, at the samples; of a sliding joint behind its stage."""

    torque: Array
    gravity: Array
    v: Array
    a: Array
    braked: Array
    inertia: Array
    wrench: Array
    step: float
    repeats: bool
    duration: float
    slides: bool
    force: float = np.nan

    @property
    def moves(self) -> bool:
        return bool(np.abs(self.v).sum() > 0)

    def mean(self, exponent: float, values: Array) -> float:
        """Weighted by speed."""
        weight = np.abs(self.v)
        return float(((weight * np.abs(values) ** exponent).sum() / weight.sum()) ** (1 / exponent))


def sampled(case: ps.sizing.LoadCase, j: int, stage: Any) -> Load:
    cycle = case.cycle
    t = (np.arange(SAMPLES) + 0.5) * cycle.duration / SAMPLES
    torque, gravity = cycle.load_torque(t)[:, j], cycle.gravity_torque(t)[:, j]
    scale = np.abs(cycle.load_torque(t)).max()
    torque, gravity = (np.where(np.abs(f) < 1e-12 * scale, 0.0, f) for f in (torque, gravity))
    v, a = (cycle.trajectory(t, order=k)[:, j] for k in (1, 2))
    still = np.abs(v) < 1e-9
    found = Load(
        torque=torque, gravity=gravity, v=np.where(still, 0.0, v), a=np.where(still, 0.0, a),
        braked=cycle.braked[np.searchsorted(cycle.load_torque.breaks[1:-1], t)], inertia=cycle.inertia(t)[:, j],
        wrench=cycle.joint_wrench(t)[:, 6 * j : 6 * j + 6], step=cycle.duration / SAMPLES,
        repeats=cycle.is_periodic, duration=cycle.duration, slides=bool(cycle.robot.is_prismatic[j]),
    )  # fmt: skip
    return found if stage is None else behind(found, stage)


def behind(load: Load, stage: Any) -> Load:
    """Seen through a screw: force times lead over two pi, with its losses, friction and inertia."""
    k = 2 * np.pi / stage.travel_per_turn
    forward = stage.efficiency if stage.efficiency > 0 else 1.0
    told = not np.isnan(stage.backward_efficiency * stage.efficiency)
    backward = stage.backward_efficiency if told else forward
    power = load.torque * load.v
    factor = np.where(power > 0, 1 / forward, np.where(power < 0, backward, 1.0))
    own = np.nan_to_num(stage.inertia)
    rubbing = np.nan_to_num(stage.friction_force) * np.sign(load.v)
    return replace(
        load, torque=(factor * load.torque + rubbing) / k + own * k * load.a, v=load.v * k, a=load.a * k,
        gravity=load.gravity / k, inertia=load.inertia / k**2 + own, force=float(np.abs(load.torque).max()),
    )  # fmt: skip


class Columns:
    """Values of the motors, or gearboxes, of all pairs."""

    def __init__(self, parts: Sequence[object], index: Array) -> None:
        self.parts = [parts[i] for i in index.tolist()]

    def __getattr__(self, name: str) -> Array:
        return np.array([getattr(part, name) for part in self.parts])

    def __call__(self, rule: Any) -> Array:
        return np.array([rule(part) for part in self.parts], dtype=float)


@dataclass(frozen=True, eq=False)
class Driven:
    """All pairs of a catalogue at a place under a load: the motors' torques at the samples."""

    load: Load
    motor: Columns
    gear: Columns
    place: ps.Drivetrain
    volts: Array
    n: Array
    torque: Array

    @property
    def speed(self) -> Array:
        return self.n[:, None] * self.load.v


def driven(load: Load, catalogue: ps.Catalogue, place: ps.Drivetrain) -> Driven:
    m, g = Columns(catalogue.motors, catalogue.motor_index), Columns(catalogue.gearboxes, catalogue.gearbox_index)
    n, brake = np.abs(g.ratio), np.nan_to_num(m.brake_inertia) * place.with_brake
    inertia = np.nan_to_num(m.rotor_inertia) + brake + np.nan_to_num(g.inertia)
    power = load.torque * load.v
    forward = g(_load_efficiency)
    backward = np.where(np.isnan(g.backward_efficiency) | np.isnan(g.efficiency), forward, g.backward_efficiency)
    passed = np.where(power > 0, 1 / forward[:, None], np.where(power < 0, backward[:, None], 1.0))
    coulomb = np.nan_to_num(m.coulomb_friction) + np.nan_to_num(g.no_load_torque)
    mapped = np.array([_map_loss(part, load) for part in g.parts])
    torque = (
        (inertia * n)[:, None] * load.a
        + passed * load.torque / n[:, None] * ~load.braked
        + (np.nan_to_num(m.viscous_friction) * n)[:, None] * load.v
        + (coulomb[:, None] + mapped) * np.sign(load.v)
    )
    own = np.array([drive.bus_voltage for drive in catalogue.drives or [ps.Drive()] * len(catalogue.motors)])
    volts = np.where(np.isnan(place.drive.bus_voltage), own, place.drive.bus_voltage)[catalogue.motor_index]
    return Driven(load, m, g, place, volts, n, torque)


def _load_efficiency(gear: Any) -> float:
    """Of the load alone; 1 where unknown, or in a map."""
    if np.isnan(gear.efficiency):
        return 1.0
    if np.isnan(gear.efficiency_torque):
        return float(gear.efficiency)
    driving = gear.efficiency_torque / (abs(gear.ratio) * gear.efficiency)
    return float(gear.efficiency_torque / abs(gear.ratio) / (driving - gear.no_load_torque))


def _map_loss(gear: Any, load: Load) -> Array:
    """By the map, at the input: linear in the torque between its columns, and in the speed between its rows."""
    if not len(gear.efficiency_map):
        return np.zeros(SAMPLES)
    n = abs(gear.ratio)
    torque, speed = np.abs(load.torque), np.abs(n * load.v)
    lines, speeds = [], sorted(set(gear.efficiency_map[:, 0]))
    for one in speeds:
        rows = gear.efficiency_map[gear.efficiency_map[:, 0] == one]
        loads, lost = rows[:, 1], rows[:, 1] / n * (1 / rows[:, 2] - 1)
        slope = (lost[1] - lost[0]) / (loads[1] - loads[0])
        loads, lost = np.append(0.0, loads), np.append(max(lost[0] - slope * loads[0], 0.0), lost)
        last = (lost[-1] - lost[-2]) / (loads[-1] - loads[-2])
        lines.append(np.interp(torque, loads, lost) + last * np.maximum(torque - loads[-1], 0.0))
    if len(speeds) == 1:
        return np.asarray(lines[0])
    at = np.clip(np.searchsorted(speeds, speed) - 1, 0, len(speeds) - 2)
    low, high = np.array(speeds)[at], np.array(speeds)[at + 1]
    share = np.clip((speed - low) / (high - low), 0.0, 1.0)
    every, k = np.array(lines), np.arange(SAMPLES)
    return np.asarray((1 - share) * every[at, k] + share * every[at + 1, k])


def utilisations(
    case: ps.sizing.LoadCase, load: Load, catalogue: ps.Catalogue, place: ps.Drivetrain
) -> dict[str, Array]:
    """Of each check by every pair; NaN where it is not known."""
    d = driven(load, catalogue, place)
    e = electric(d)
    with np.errstate(divide="ignore", invalid="ignore"):
        limits = {
            **_of_motor(d),
            **_of_winding(d, e),
            **_of_gears(d, case),
            **_of_bearing(d),
            **_of_brake(d),
            **_of_stage(d),
        }
        uses = {name: np.broadcast_to(demand / limit, (len(d.n),)) for name, (demand, limit) in limits.items()}
        # Nothing is left of a limit of zero.
        for name, (demand, limit) in limits.items():
            uses[name] = np.where((limit == 0) & ~np.isnan(demand), np.inf, uses[name])
        life = d.gear(lambda gear: _life(load, gear))
    if case.is_rare:
        uses = {name: use for name, use in uses.items() if name in ps.sizing._load_cases.RARE_CHECKS}
    return uses | {"life": life}


Limits = dict[str, tuple[Any, Any]]


def _of_motor(d: Driven) -> Limits:
    m, load, place = d.motor, d.load, d.place
    size = np.abs(d.torque)
    left = np.array([_left(motor, place, n) for motor, n in zip(m.parts, d.n.tolist(), strict=True)])
    holds = np.abs(load.torque[(load.v == 0) & ~load.braked]).max(initial=0.0)
    mean = np.abs(d.speed).mean(axis=1)
    continuous = [
        np.interp(w, *curve.T, right=0.0) if len(curve := _curve(motor, "continuous", v)) else motor.continuous_torque
        for motor, w, v in zip(m.parts, mean, d.volts, strict=True)
    ]
    brake = np.nan_to_num(m.brake_inertia) * place.with_brake
    return {
        "motor torque": (size.max(axis=1), m.peak_torque),
        "RMS motor torque at mean speed": (np.sqrt((d.torque**2).mean(axis=1)), np.array(continuous) * left),
        "motor torque at speed": (np.array([_at_speed(d, k) for k in range(len(d.n))]), 1.0),
        "motor speed": (np.abs(d.speed).max(axis=1), m.max_speed),
        "motor power": (np.abs(d.torque * d.speed).max(axis=1), m.peak_power),
        "motor torque at standstill": (holds / d.n if holds else np.nan, m.standstill_torque * left),
        "load inertia over rotor inertia": (
            (load.inertia.max() / d.n**2 + np.nan_to_num(d.gear.inertia)) / (m.rotor_inertia + brake),
            place.max_inertia_ratio,
        ),
    }  # fmt: skip


def _left(motor: Any, place: ps.Drivetrain, n: float) -> float:
    """Of the continuous torque, by ambient, altitude and gearbox; what is not known takes nothing off."""
    rated = 40.0 if np.isnan(motor.rated_ambient_celsius) else motor.rated_ambient_celsius
    hotter = place.ambient_celsius - rated
    share = 1.0
    if hotter > 0:
        room = max(motor.max_winding_celsius - place.ambient_celsius, 0.0)
        share = np.sqrt(room / (motor.max_winding_celsius - rated))
        if not np.isnan(motor.ambient_derating):
            share = max(0.0, 1 - motor.ambient_derating * hotter)
    high = 1.0 if place.altitude <= 1000 else np.nan
    if len(motor.altitude_curve):
        high = np.interp(place.altitude, *motor.altitude_curve.T, left=1.0, right=np.nan)
    own = 1.0 if np.isnan(motor.geared_share) or n == 1 else motor.geared_share
    return float(np.nan_to_num(share * high, nan=1.0) * own)


def _curve(motor: Any, kind: str, volts: float) -> Array:
    """The one of the highest voltage within the bus's, below all the lowest; none at an unknown voltage."""
    several = getattr(motor, f"{kind}_curves")
    if not several or np.isnan(volts):
        return np.asarray(getattr(motor, f"{kind}_curve"))
    reached = [curve for own, curve in several if own <= volts]
    return np.asarray(reached[-1] if reached else several[0][1])


def _at_speed(d: Driven, k: int) -> float:
    curve = _curve(d.motor.parts[k], "peak", d.volts[k])
    if not len(curve):
        return np.nan
    limit = np.interp(np.abs(d.speed[k]), *curve.T, right=0.0)
    return float(np.max(np.abs(d.torque[k]) / limit))


def _of_winding(d: Driven, e: Electric) -> Limits:
    m, drive, duration = d.motor, d.place.drive, d.load.duration
    room = np.maximum(m.max_winding_celsius - d.place.ambient_celsius, 0.0)
    no_resistor = np.isnan(drive.brake_resistor_power)
    demands: Limits = {
        "voltage at torque and speed": (e.voltage.max(axis=1), d.volts),
        "winding temperature rise": (e.rise, room),
        "mean winding temperature rise": (e.mean_rise, room),
        "peak current": (e.current.max(axis=1), drive.peak_current),
        "RMS current": (np.sqrt((e.current**2).mean(axis=1)), drive.continuous_current),
        "drawn electric power": (np.maximum(e.power.max(axis=1), 0.0), drive.peak_power),
        "mean drawn electric power": (np.maximum(e.power, 0.0).mean(axis=1), drive.continuous_power),
        "returned electric power": (np.maximum(-e.power.min(axis=1), 0.0), drive.peak_regenerated_power),
        "returned energy on the bus": (e.stored, drive.storable_energy if no_resistor else np.nan),
        "mean brake-resistor power": (e.braked / duration, drive.brake_resistor_power),
    }  # fmt: skip
    # A winding that runs away has no steady state: whatever is known of it is beyond every limit.
    away = np.isinf(e.rise)
    return {name: (np.where(away & ~np.isnan(one), np.inf, one), bound) for name, (one, bound) in demands.items()}


EXPONENTS = {"": 3.0, "strain wave": 3.0, "cycloidal": 10 / 3, "planetary": 3.0}


def _of_gears(d: Driven, case: ps.sizing.LoadCase) -> Limits:
    g, load, place = d.gear, d.load, d.place
    largest, top = np.abs(load.torque).max(), np.abs(d.speed).max(axis=1)
    average = [load.mean(EXPONENTS[kind], load.torque) if load.moves else np.nan for kind in g.kind.tolist()]
    impact = g(lambda gear: impact_factor(gear, load.duration))
    return {
        "gearbox average torque": (np.array(average), g.max_average_torque),
        "gearbox repeated peak torque": (largest * impact, g.max_repeated_torque),
        "gearbox momentary peak torque": (
            np.fmax(place.momentary_torque, largest if case.is_rare else np.nan), g.max_momentary_torque
        ),
        "gearbox momentary peaks": (place.emergency_stops, _rare_peaks(g, top, place.emergency_duration)),
        "gearbox average input speed": (np.abs(d.speed).mean(axis=1), g.max_average_input_speed),
        "gearbox input speed": (top, g.max_input_speed),
    }  # fmt: skip


def impact_factor(gear: Any, duration: float) -> float:
    """Of a planetary gear beyond a thousand cycles an hour."""
    if gear.kind != "planetary":
        return 1.0
    an_hour = 3600 / duration
    if len(gear.impact_curve):
        return float(np.interp(an_hour, *gear.impact_curve.T, right=np.nan))
    return 1.0 if an_hour <= 1000 else np.nan


def _rare_peaks(gear: Columns, top: Array, duration: float) -> Array:
    """A thousand of a planetary gear; of a strain wave gear ten thousand over twice the turns in one."""
    turns = top / (2 * np.pi) * duration
    wave = np.where(turns > 0, np.minimum(1e4 / (2 * turns), 1e4), np.nan)
    return np.select([gear.kind == "planetary", gear.kind == "cycloidal"], [1e3, np.nan], wave)


def _life(load: Load, gear: Any) -> float:
    """L10; an L50 of a strain wave gear is five times as long."""
    p = EXPONENTS[gear.kind]
    average = load.mean(p, load.torque) if load.moves else 0.0
    slower = gear.rated_speed / (abs(gear.ratio) * np.abs(load.v).mean())
    life = gear.rated_life_hours * slower * np.divide(gear.rated_torque, average) ** p
    halved = gear.life_basis == "L50" and gear.kind in ("", "strain wave")
    return float(life / 5 if halved else life)


def _of_bearing(d: Driven) -> Limits:
    """Crossed roller bearings, by Harmonic Drive's procedure."""
    g, load, asked = d.gear, d.load, d.place.required_life_hours
    if load.slides:
        return {}
    radial, axial = np.hypot(*load.wrench[:, :2].T), np.abs(load.wrench[:, 2])
    offset = g.bearing_offset[:, None]
    first, second = load.wrench[:, 3] + offset * load.wrench[:, 1], load.wrench[:, 4] - offset * load.wrench[:, 0]
    tilt, diameter = np.hypot(first, second), g.bearing_diameter
    static = 1.5 * (radial.max() + 2 * tilt.max(axis=1) / diameter + 0.44 * axial.max())
    if load.moves:
        fa, fr = load.mean(10 / 3, axial), load.mean(10 / 3, radial)
        across = fr + 2 * np.array([load.mean(10 / 3, one) for one in tilt]) / diameter
        equivalent = np.where(fa <= 1.5 * across, across + 0.45 * fa, 0.67 * (across + fa))
        turns = np.abs(load.v).mean() / (2 * np.pi) * 3600
        life = 1e6 / turns * (g.bearing_dynamic_load / (1.5 * equivalent)) ** (10 / 3)
    else:
        life = np.where(np.isnan(g.bearing_dynamic_load * diameter), np.nan, np.inf)
    return {
        "output bearing tilting moment": (tilt.max(axis=1), g.max_tilting_moment),
        "output bearing axial force": (axial.max(), g.max_axial_force),
        "output bearing radial force": (radial.max(), g.max_radial_force),
        "output bearing static load": (static, g.bearing_static_load),
        "output bearing life": (asked, life),
    }


def _of_brake(d: Driven) -> Limits:
    m, load, place = d.motor, d.load, d.place
    if not place.with_brake:
        return {}
    held = np.abs(load.gravity).max() / d.n
    inertia = np.nan_to_num(m.rotor_inertia) + np.nan_to_num(m.brake_inertia) + np.nan_to_num(d.gear.inertia)
    moving = 0.5 * (load.inertia + (inertia * d.n**2)[:, None]) * load.v**2
    energy = np.where(m.brake_torque > held, moving.max(axis=1) * m.brake_torque / (m.brake_torque - held), np.inf)
    energy = np.where(np.isnan(m.brake_torque), np.nan, energy)
    return {
        "holding brake torque": (held, m.brake_torque),
        "holding brake energy of a stop": (energy, m.brake_stop_energy),
        "holding brake wear": (energy * place.emergency_stops, m.brake_total_energy),
    }


def _of_stage(d: Driven) -> Limits:
    stage = d.place.stage
    if stage is None:
        return {}
    return {
        "stage force": (d.load.force, stage.max_force), "stage speed": (np.abs(d.load.v).max(), stage.max_speed)
    }  # fmt: skip


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
    worst, used = np.zeros((2, catalogue.n_pairs))
    for case, share in zip(concerned, shares, strict=True):
        uses = utilisations(case, sampled(case, j, place.stage), catalogue, place)
        life = uses.pop("life")
        if share:
            used = used + share / life
        for name, use in uses.items():
            worst = np.fmax(worst, use / (1 - margins.get(name, margins.get("all", 0.0))))
    allowed = 1 - margins.get("gearbox life", margins.get("all", 0.0))
    return np.fmax(worst, place.required_life_hours * used / allowed)


def lacks(catalogue: ps.Catalogue, place: ps.Drivetrain, cycle: float) -> Array:
    """Whether each pair lacks one of the least set, by its definition in words; `cycle` is the shortest, s."""
    own = catalogue.drives or [ps.Drive()] * len(catalogue.motors)
    volts = [drive.bus_voltage if np.isnan(place.drive.bus_voltage) else place.drive.bus_voltage for drive in own]
    motors = np.array([_poor_motor(m, place, v) for m, v in zip(catalogue.motors, volts, strict=True)])
    gears = np.array([_poor_gear(gear, place, cycle) for gear in catalogue.gearboxes])
    return motors[catalogue.motor_index] | gears[catalogue.gearbox_index]


def _poor_motor(m: ps.Motor, place: ps.Drivetrain, volts: float) -> bool:
    has_peak = len(m.peak_curve) > 0 or len(m.peak_curves) > 0
    has_continuous = len(m.continuous_curve) > 0 or len(m.continuous_curves) > 0
    rated = 40.0 if np.isnan(m.rated_ambient_celsius) else m.rated_ambient_celsius
    is_hot = place.ambient_celsius > rated and np.isnan(m.ambient_derating) and np.isnan(m.max_winding_celsius)
    end = m.altitude_curve[-1, 0] if len(m.altitude_curve) else 1000.0
    below = any(len(curves) > 0 and not volts >= curves[0][0] for curves in (m.peak_curves, m.continuous_curves))
    return bool(
        np.isnan(m.rotor_inertia)
        or (np.isnan(m.continuous_torque) and not has_continuous)
        or (np.isnan(m.peak_torque) and not has_peak)
        or (np.isnan(m.max_speed) and not has_peak)
        or is_hot
        or place.altitude > end
        or below
    )


def _poor_gear(g: ps.Gearbox, place: ps.Drivetrain, cycle: float) -> bool:
    untold = np.isnan([g.rated_life_hours, g.rated_torque, g.rated_speed]).any() and place.required_life_hours > 0
    has_losses = len(g.efficiency_map) > 0 or not np.isnan(g.efficiency)
    bare = np.isnan([g.max_average_torque, g.max_repeated_torque]).any() or not has_losses
    return bool(bare or untold or np.isnan(impact_factor(g, cycle)))
