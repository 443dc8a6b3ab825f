"""What a cycle asks of one joint's drive train: at the gearbox's output, in the gears, and at the motor."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import wraps
from typing import Final, TypeVar, final
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from puma_septic.cycle import Cycle
from puma_septic.drives import Drivetrain, Gearbox
from puma_septic.errors import InputError
from puma_septic.friction import ROUNDING, resolved
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array, checked_kind, checked_whole, freeze_fields

__all__ = [
    "JointLoad",
    "MotorLoad",
    "gear_loss",
    "gearbox_load",
    "inertia_ratio",
    "joint_load",
    "kept_by_load",
    "motor_load",
    "torque_by_cause",
]

_T = TypeVar("_T")


def gear_loss(gearbox: Gearbox, torque: Piecewise, speed: Piecewise, direction: Array) -> Piecewise:
    """Torque at the input against the motion, N m, by the gearbox's efficiency map; signed as the motion.

    Beyond the map's largest torque its last lines go on; beyond its speeds the nearest one holds.

    Parameters
    ----------
    gearbox : Gearbox
    torque : Piecewise
        At the output, N m, of one sign on each interval.
    speed : Piecewise
        At the input, rad/s, on the same intervals.
    direction : ndarray, shape (n_intervals,)
        Sign of the motion on each, 0 at rest.

    Returns
    -------
    Piecewise
    """
    speeds, torques, losses = _grid(gearbox)
    load, pace = torque.by_interval(torque.signs()[:, 0]), speed.by_interval(direction)
    split = load.split(np.concatenate([*_crossings(load, torques[1:-1]), *_crossings(pace, speeds)]))
    load, pace = split, pace.aligned_with(split)
    way = direction[np.searchsorted(torque.breaks[1:-1], split.middles)]
    flat, by_load, by_pace, by_both = _cells(load, pace, speeds, torques, losses)
    loss = load.stepwise(flat[:, None]) + load.by_interval(by_load) + pace.by_interval(by_pace)
    return (loss + (load * pace).by_interval(by_both)).by_interval(way)


def _grid(gearbox: Gearbox) -> tuple[Array, Array, Array]:
    """Speeds, torques from 0, and the loss at each, shape (n_speeds, n_torques)."""
    rows = gearbox.efficiency_map
    speeds, torques = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    efficiency = rows[:, 2].reshape(len(speeds), len(torques))
    losses = torques / abs(gearbox.ratio) * (1 / efficiency - 1)
    slope = (losses[:, 1] - losses[:, 0]) / (torques[1] - torques[0])
    idle = np.maximum(losses[:, 0] - slope * torques[0], 0.0)
    return speeds, np.concatenate([[0.0], torques]), np.column_stack([idle, losses])


def _crossings(f: Piecewise, values: Array) -> list[Array]:
    """When a function passes each of the values."""
    levels = (Piecewise.constant([value], f.duration, start=f.start) for value in values.tolist())
    return [(f - level).roots()[0] for level in levels]


def _cells(
    load: Piecewise, pace: Piecewise, speeds: Array, torques: Array, losses: Array
) -> tuple[Array, Array, Array, Array]:
    """``a, b, c, d`` of ``a + b load + c pace + d load pace`` on each interval, bilinear in its cell of the grid."""
    at_load, at_pace = load(load.middles)[:, 0], pace(pace.middles)[:, 0]
    j = np.clip(np.searchsorted(torques, at_load, side="right") - 1, 0, len(torques) - 2)
    steps = np.diff(losses, axis=1) / np.diff(torques)
    # Along the torque, at each speed: value at load 0 of the cell's line, and its slope.
    slope, start = steps[:, j], losses[:, j] - steps[:, j] * torques[j]
    i = np.searchsorted(speeds, at_pace, side="right") - 1
    below, above = np.clip(i, 0, len(speeds) - 1), np.clip(i + 1, 0, len(speeds) - 1)
    k = np.arange(len(at_load))
    width = np.where(above > below, speeds[above] - speeds[below], 1.0)
    by_pace, by_both = (start[above, k] - start[below, k]) / width, (slope[above, k] - slope[below, k]) / width
    flat, by_load = start[below, k] - by_pace * speeds[below], slope[below, k] - by_both * speeds[below]
    return flat, by_load, by_pace, by_both


@final
@dataclass(frozen=True, slots=True, weakref_slot=True, eq=False, kw_only=True)
class JointLoad:
    """One joint over a cycle, without its drive.

    All functions have one component; torque, velocity and acceleration share their breaks. A torque that is rounding
    beside the arm's largest is exactly 0, and so are velocity and acceleration at rest.

    Attributes
    ----------
    joint : str
    is_prismatic : bool
        Then torques are forces in N, speeds in m/s and inertias masses in kg.
    torque : Piecewise
        What the gearbox's output carries, N m: links, payload, wrench; no rotor, no friction.
    gravity : Piecewise
        Its part at rest in the same posture, payload and wrench included; its breaks are its own.
    velocity, acceleration : Piecewise
        rad/s, rad/s^2.
    velocity_sign, power_sign : ndarray, shape (n_intervals,)
        Sign of the velocity and of ``torque * velocity`` on each interval, 0 at rest: neither changes inside one.
    braked : ndarray of bool, shape (n_intervals,)
        Whether a brake at the motor carries the load instead of the motor.
    inertia : Piecewise
        Inertia that the joint moves alone, ``M_jj`` without rotors, kg m^2; its breaks are its own.
    unbounded : float
        When the torque is first unbounded because a velocity steps, s; NaN: never.
    why_not_periodic : str
        Empty for a cycle that returns to its start.
    cycle : Cycle or None
        That it is a part of, and its number there: what the whole arm does to the joint.
    slide : JointLoad or None
        Of the gearbox behind a stage: the load of the sliding joint itself.
    """

    joint: str
    is_prismatic: bool
    torque: Piecewise
    gravity: Piecewise
    velocity: Piecewise
    acceleration: Piecewise
    velocity_sign: Array
    power_sign: Array
    braked: NDArray[np.bool_]
    inertia: Piecewise
    unbounded: float
    why_not_periodic: str
    cycle: Cycle | None = field(default=None, repr=False)
    number: int = 0
    slide: JointLoad | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        freeze_fields(self)

    @property
    def duration(self) -> float:
        """Of the cycle, s."""
        return self.torque.duration

    @property
    def speed(self) -> Piecewise:
        """Magnitude of the velocity."""
        return self.velocity.by_interval(self.velocity_sign)

    @property
    def mean_speed(self) -> float:
        """Mean magnitude of the velocity, rests included."""
        return float(self.speed.integral()(self.speed.breaks[-1])[0]) / self.duration

    @property
    def moves(self) -> bool:
        """Whether the joint does anything but rest."""
        return bool(self.velocity_sign.any())


def kept_by_load(compute: Callable[[JointLoad, float], _T]) -> Callable[[JointLoad, float], _T]:
    """Compute once what many gearboxes ask of one load, and keep it as long as the load lives, which holds its motions.

    Parameters
    ----------
    compute : callable
        Of a load and a number; its answer must not hold the load.

    Returns
    -------
    callable
    """
    kept: WeakKeyDictionary[JointLoad, dict[float, _T]] = WeakKeyDictionary()

    @wraps(compute)
    def get(load: JointLoad, number: float) -> _T:
        answers = kept.setdefault(load, {})
        if number not in answers:
            answers[number] = compute(load, number)
        return answers[number]

    return get


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MotorLoad:
    """The motor's side of a joint, in the joint's direction whatever the sign of the gear ratio.

    Attributes
    ----------
    torque : Piecewise
        N m at the shaft's magnetic side: rotor inertia and the motor's friction are in it. 0 under a brake.
    speed : Piecewise
        rad/s, signed.
    direction : ndarray, shape (n_intervals,)
        Sign of the speed on each interval, 0 at rest.
    parts : mapping of str to Piecewise
        "load" (through the gears, with their efficiency), "rotor" (with the gears' input inertia) and "friction"; they
        sum to `torque`.
    unbounded : float
        When the torque is first unbounded, s; NaN: never.
    """

    torque: Piecewise
    speed: Piecewise
    direction: Array
    parts: Mapping[str, Piecewise]
    unbounded: float

    def __post_init__(self) -> None:
        freeze_fields(self)

    @property
    def power(self) -> Piecewise:
        """Mechanical power ``torque * speed``, W, positive where the motor drives."""
        return self.torque * self.speed

    @property
    def duration(self) -> float:
        """Of the cycle, s."""
        return self.torque.duration

    @property
    def rms_torque(self) -> float:
        """Root mean square over the cycle, rests included, N m; infinite where the torque is."""
        if not np.isnan(self.unbounded):
            return np.inf
        return float(self.torque.rms()[0])

    @property
    def mean_speed(self) -> float:
        """Mean magnitude of the speed, rests included, rad/s."""
        speed = self.speed.by_interval(self.direction)
        return float(speed.integral()(speed.breaks[-1])[0]) / self.duration


def joint_load(cycle: Cycle, j: int) -> JointLoad:
    """What a cycle asks of joint j, split where its velocity or its power changes sign.

    Where the joint rests is the cycle's word, by its travel; what its velocity and acceleration have there is rounding.
    """
    checked_whole("j", j, at_least=0, at_most=len(checked_kind("cycle", cycle, Cycle).joint_names) - 1)
    rounding = ROUNDING * cycle.load_torque.bounds().max()
    torque = resolved(cycle.load_torque[j], rounding).split_at_roots()
    interval = np.searchsorted(cycle.load_torque.breaks[1:-1], torque.middles)
    direction = cycle.velocity_sign[interval, j]
    velocity, acceleration = (
        cycle.trajectory.derivative(order)[j].aligned_with(torque).by_interval(np.abs(direction)) for order in (1, 2)
    )
    return JointLoad(
        joint=cycle.joint_names[j],
        is_prismatic=bool(cycle.robot.is_prismatic[j]),
        torque=torque,
        velocity=velocity,
        acceleration=acceleration,
        velocity_sign=direction,
        power_sign=direction * torque.signs()[:, 0],
        braked=cycle.braked[interval],
        gravity=resolved(cycle.gravity_torque[j], rounding),
        inertia=cycle.inertia[j],
        unbounded=float(cycle.unbounded[j]),
        why_not_periodic=cycle.why_not_periodic,
        cycle=cycle,
        number=j,
    )


def gearbox_load(load: JointLoad, train: Drivetrain) -> JointLoad:
    """The load that a drive train's gearbox turns: that of the joint, or of the stage of a sliding joint.

    With the stage's reduction k, ``torque = transmission F / k + sign(v) friction / k + inertia k a`` at ``k v``.

    Returns
    -------
    JointLoad

    Raises
    ------
    InputError
        For a gearbox with ratings in N m at a sliding joint without a stage, or a stage at a joint that turns.
    """
    stage = train.stage
    if stage is None:
        _refuse_ratings(load, train)
        return load
    if not load.is_prismatic:
        raise InputError(f"joint {load.joint!r} turns: it takes no {stage.kind}, which is for a sliding joint")
    k = stage.reduction
    passed = load.torque.by_interval(stage.transmission[load.power_sign.astype(int) + 1] / k)
    acceleration = load.acceleration * k
    friction = load.torque.stepwise((load.velocity_sign * float(np.nan_to_num(stage.friction_force)) / k)[:, None])
    inertia = float(np.nan_to_num(stage.inertia))
    torque = (passed + acceleration * inertia + friction).split_at_roots()
    interval = np.searchsorted(load.torque.breaks[1:-1], torque.middles)
    direction = load.velocity_sign[interval]
    own = load.inertia * (1 / k**2)
    return replace(
        load,
        is_prismatic=False,
        torque=torque,
        velocity=(load.velocity * k).aligned_with(torque),
        acceleration=acceleration.aligned_with(torque),
        velocity_sign=direction,
        power_sign=direction * torque.signs()[:, 0],
        braked=load.braked[interval],
        gravity=load.gravity * (1 / k),
        inertia=own + own.stepwise(np.full((len(own.lengths), 1), inertia)),
        slide=load,
    )


_RATINGS: Final = ("rated_torque", "max_average_torque", "max_repeated_torque", "max_momentary_torque")


def _refuse_ratings(load: JointLoad, train: Drivetrain) -> None:
    """A force in N held against a rating in N m once gave "203.8 N is 83.89 % of 243 N", and "strong enough"."""
    known = [name for name in _RATINGS if not np.isnan(getattr(train.gearbox, name))]
    if load.is_prismatic and known:
        raise InputError(
            f"joint {load.joint!r} slides, but its gearbox turns: {known[0]} = {getattr(train.gearbox, known[0]):g} N m"
            " is no limit of a force; give the stage between them, LinearStage(kind='screw', 'rack' or 'belt', ...)"
        )


def motor_load(load: JointLoad, train: Drivetrain) -> MotorLoad:
    """What the motor of a drive train sees of a joint's load; see `Drivetrain` for the equation."""
    n = train.ratio
    passed = train.transmission[load.power_sign.astype(int) + 1] / n
    speed = load.velocity * n
    through = load.torque.by_interval(passed * ~load.braked)
    if len(train.gearbox.efficiency_map):
        through = through + gear_loss(train.gearbox, load.torque, speed, load.velocity_sign)
    parts = {
        "load": through,
        "rotor": load.acceleration * (train.inertia * n),
        "friction": train.friction.along(speed, load.velocity_sign),
    }
    return MotorLoad(
        torque=parts["load"] + parts["rotor"] + parts["friction"],
        speed=speed,
        direction=load.velocity_sign,
        parts=parts,
        unbounded=load.unbounded,
    )


def torque_by_cause(load: JointLoad, train: Drivetrain, motor: MotorLoad) -> dict[str, Piecewise]:
    """Parts of the motor's torque at the gearbox's output, N m; they sum to it where no brake carries the load.

    "gravity" and "motion" of the links, as if all gears were lossless; "gears", what their efficiency (and a stage's)
    takes or, where the load drives, gives; "rotor", with all that turns with it; "friction".

    Returns
    -------
    dict of str to Piecewise
    """
    lossless, turning, rubbing = load.torque, load.torque * 0.0, load.torque * 0.0
    if train.stage is not None and load.slide is not None:
        k = train.stage.reduction
        lossless = (load.slide.torque * (1 / k)).aligned_with(load.torque)
        turning = load.acceleration * float(np.nan_to_num(train.stage.inertia))
        friction = float(np.nan_to_num(train.stage.friction_force)) / k
        rubbing = load.torque.stepwise((load.velocity_sign * friction)[:, None])
    carried = (lossless + turning + rubbing).by_interval(~load.braked)
    return {
        "gravity": load.gravity,
        "motion": lossless - load.gravity,
        "gears": motor.parts["load"] * train.ratio - carried,
        "rotor": motor.parts["rotor"] * train.ratio + turning,
        "friction": motor.parts["friction"] * train.ratio + rubbing,
    }


def inertia_ratio(load: JointLoad, train: Drivetrain) -> tuple[float, float]:
    """Largest inertia of load and gears at the motor over the rotor's, its brake's with it, and its instant, s.

    So the makers of motors count, as Yaskawa, Sigma-V manual E-V-MD, p. 2-5: ``J_L = J_L1 + J_B + J_G``. An unknown
    inertia of the brake counts as 0, as in the torque: the ratio is then no smaller than the true one. NaN where the
    rotor's is not known.

    Returns
    -------
    tuple of float
    """
    rotor = train.motor.rotor_inertia + float(np.nan_to_num(train.brake_inertia))
    if not rotor > 0:
        return np.nan, np.nan
    found = load.inertia.extrema()
    driven = float(found.max[0]) / train.ratio**2 + float(np.nan_to_num(train.gearbox.inertia))
    return driven / rotor, float(found.t_max[0])
