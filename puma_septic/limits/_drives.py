"""What motors bear whose gears lose nothing: their torque is the joint's over the ratio, their speed its times that."""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.drives import Drivetrain
from puma_septic.limit_check import LimitCheck
from puma_septic.limits._demands import AT, Demand, Rows, values_beside
from puma_septic.limits._stretching import RateTorque
from puma_septic.motion import Motion
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.sizing import MotorLoad, torque_at_speed
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["CurveDemand", "drive_checks", "drive_demands", "highest_motor_rate", "load_demands", "standstill_limits"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Linear:
    """A limit of ``torque_factor tau + speed_factor v`` of a joint, as sizing calls it."""

    quantity: str
    unit: str
    torque_factor: Callable[[Drivetrain], float]
    speed_factor: Callable[[Drivetrain], float]
    limit: Callable[[Drivetrain], float]

    def of(self, robot: Robot) -> tuple[Array, Array, Array]:
        """Factor of the torque, of the velocity, and limit of each joint; NaN where one of them is not known."""
        rows = [(self.torque_factor(one), self.speed_factor(one), self.limit(one)) for one in robot.drivetrains]
        torque, speed, limit = np.array(rows).T
        known = ~np.isnan(torque + speed) & (robot.knows_torque | (torque == 0))
        return np.nan_to_num(torque), np.nan_to_num(speed), np.where(known, limit, np.nan)


_LINEAR: Final = (
    _Linear(
        quantity="motor torque", unit="N m", torque_factor=lambda train: 1 / train.ratio, speed_factor=lambda _: 0.0,
        limit=lambda train: train.motor.peak_torque,
    ),
    _Linear(
        quantity="peak current", unit="A", torque_factor=lambda train: 1 / train.ratio / train.motor.torque_constant,
        speed_factor=lambda _: 0.0, limit=lambda train: train.drive.peak_current,
    ),
    _Linear(
        quantity="voltage at torque and speed", unit="V",
        torque_factor=lambda train: train.motor.dc_resistance / train.motor.dc_torque_constant / train.ratio,
        speed_factor=lambda train: train.motor.back_emf * train.ratio,
        limit=lambda train: train.drive.bus_voltage,
    ),
)  # fmt: skip


def _max_motor_speed(train: Drivetrain) -> float:
    """The least of what motor and gears allow and where the motor's curve ends, rad/s; NaN where none is known."""
    curve = train.peak_curve
    ends = [train.motor.max_speed, train.gearbox.max_input_speed, curve[-1, 0] if len(curve) else np.nan]
    return float(np.fmin.reduce(ends))


def _speed_limits(robot: Robot) -> tuple[Array, Array]:
    """Ratios and speed limits of the motors; NaN where not known."""
    ratio = np.array([train.ratio for train in robot.drivetrains])
    limit = np.array([_max_motor_speed(train) for train in robot.drivetrains])
    return ratio, np.where(np.isnan(ratio), np.nan, limit)


def _power_limits(robot: Robot) -> Array:
    limit = np.array([train.motor.peak_power for train in robot.drivetrains])
    return np.where(robot.knows_torque, limit, np.nan)


def _curved(robot: Robot) -> dict[int, Drivetrain]:
    """Drivetrains with a curve of torque over speed by joint, where ratio and torque are known."""
    return {
        j: train
        for j, (train, known) in enumerate(zip(robot.drivetrains, robot.knows_torque, strict=True))
        if len(train.peak_curve) and known and not np.isnan(train.ratio)
    }


def highest_motor_rate(robot: Robot, peak_velocity: Array) -> float:
    """The largest rate at which no motor is too fast."""
    ratio, limit = _speed_limits(robot)
    with np.errstate(divide="ignore"):
        return float(np.fmin.reduce(limit / (ratio * peak_velocity), initial=np.inf))


def drive_demands(motion: Motion, torque: RateTorque) -> list[Demand | CurveDemand]:
    """What the motors are asked for, as polynomials of the rate."""
    robot, v = motion.robot, motion.trajectory.derivative(1)
    demands: list[Demand | CurveDemand | None] = []
    for row in _LINEAR:
        of_torque, of_speed, limit = row.of(robot)
        parts = (torque.still * of_torque, torque.viscous * of_torque + v * of_speed, torque.inertial * of_torque)
        demands.append(Demand.of(row.quantity, parts, limit))
    power = _power_limits(robot)
    if not np.isnan(power).all():
        parts = (torque.still * v, torque.viscous * v, torque.inertial * v)
        demands.append(Demand.of("motor power", (None, *parts), power))
    whole = (torque.still, torque.viscous, torque.inertial)
    demands += [CurveDemand.of(motion.trajectory, j, train, whole, 1) for j, train in _curved(robot).items()]
    return [demand for demand in demands if demand is not None]


def load_demands(
    robot: Robot, trajectory: Trajectory, bare: Piecewise, added: Piecewise, rate: float
) -> list[Demand | CurveDemand]:
    """What the motors are asked for, as functions of the mass: of the torque without it, and what each kg adds."""
    v = trajectory.derivative(1) * rate
    demands: list[Demand | CurveDemand | None] = []
    for row in _LINEAR:
        of_torque, of_speed, limit = row.of(robot)
        demands.append(Demand.of(row.quantity, (bare * of_torque + v * of_speed, added * of_torque), limit))
    power = _power_limits(robot)
    if not np.isnan(power).all():
        demands.append(Demand.of("motor power", (bare * v, added * v), power))
    demands += [CurveDemand.of(trajectory, j, train, (bare, added), 0, rate) for j, train in _curved(robot).items()]
    return [demand for demand in demands if demand is not None]


def standstill_limits(robot: Robot) -> list[tuple[str, str, Array, Array]]:
    """What motors at rest are held to: quantity, unit, factor of the joint torque and limit of each joint."""
    rows = [(row.quantity, row.unit, *row.of(robot)[::2]) for row in _LINEAR]
    factor, limit = np.zeros(robot.n_joints), np.full(robot.n_joints, np.nan)
    for j, train in _curved(robot).items():
        factor[j], limit[j] = 1 / train.ratio, np.interp(0.0, *train.peak_curve.T)
    return [*rows, ("motor torque at speed", "N m", factor, limit)]


def drive_checks(motion: Motion) -> tuple[LimitCheck, ...]:
    """What the motors are asked for by a motion, held against what they bear, joint by joint."""
    robot, checks = motion.robot, []

    def check(j: int, quantity: str, unit: str, demand: float, limit: float, time: float) -> None:
        name = robot.joint_names[j]
        checks.append(
            LimitCheck.of_magnitude(
                joint=name, quantity=quantity, unit=unit, demand=demand, limit=limit, time=time, kind="physics",
                source=robot.drivetrains[j].motor.source,
            )
        )  # fmt: skip

    def check_peaks(quantity: str, unit: str, function: Callable[[], Piecewise], limit: Array) -> None:
        known = np.flatnonzero(~np.isnan(limit)).tolist()
        if not known:
            return
        found = function().extrema()
        for j in known:
            check(j, quantity, unit, float(found.peak[j]), float(limit[j]), float(found.t_peak[j]))

    v = motion.trajectory.derivative(1)
    for row in _LINEAR:
        of_torque, of_speed, limit = row.of(robot)
        check_peaks(row.quantity, row.unit, partial(_combined, motion, of_torque, of_speed), limit)
    ratio, fastest = _speed_limits(robot)
    check_peaks("motor speed", "rad/s", lambda: v * np.nan_to_num(ratio), fastest)
    check_peaks("motor power", "W", lambda: motion.power, _power_limits(robot))
    for j, train in _curved(robot).items():
        motor = _motor(motion.torque[j], v[j], motion.direction[j], train.ratio)
        _, size, bound, time = torque_at_speed(motor, train.peak_curve)
        check(j, "motor torque at speed", "N m", size, bound, time)
    return tuple(checks)


def _combined(motion: Motion, of_torque: Array, of_speed: Array) -> Piecewise:
    return motion.torque * of_torque + motion.trajectory.derivative(1) * of_speed


def _motor(torque: Piecewise, velocity: Piecewise, direction: Piecewise, ratio: float) -> MotorLoad:
    """The motor of one joint, from functions of that joint alone."""
    aligned = torque.aligned_with(direction)
    return MotorLoad(
        torque=aligned * (1 / ratio),
        speed=velocity.aligned_with(aligned) * ratio,
        direction=direction.aligned_with(aligned).coefficients[0, :, 0],
        parts={},
        unbounded=np.nan,
    )


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class CurveDemand:
    """The torque of one motor beside its curve of torque over speed, straight between its points."""

    trajectory: Trajectory
    joint: int
    ratio: float
    curve: Array
    parts: tuple[Piecewise, ...]
    speed_power: int
    rate: float
    demand: Demand

    @classmethod
    def of(
        cls,
        trajectory: Trajectory,
        joint: int,
        train: Drivetrain,
        parts: Sequence[Piecewise],
        speed_power: int,
        rate: float = 1.0,
    ) -> CurveDemand:
        """From the parts of the joint torques by power of x, and the power with which speeds go."""
        own = tuple(part[joint] for part in parts)
        motor = [part * (1 / train.ratio) for part in own]
        speed = trajectory.derivative(1)[joint] * (train.ratio * rate)
        demand = Demand.of("motor torque at speed", [*motor, speed], np.ones(1))
        assert demand is not None
        return cls(
            trajectory=trajectory,
            joint=joint,
            ratio=train.ratio,
            curve=train.peak_curve,
            parts=own,
            speed_power=speed_power,
            rate=rate,
            demand=demand,
        )

    @property
    def quantity(self) -> str:
        """Of `LimitCheck`."""
        return self.demand.quantity

    @property
    def joints(self) -> NDArray[np.int64]:
        """The joint."""
        return np.array([self.joint])

    def first_instants(self) -> Array:
        """As `Demand`."""
        return self.demand.first_instants()

    def rows(self, times: Array) -> Rows:
        """What must hold at some instants: on each part of the curve a line, at the x that lie on it."""
        values = values_beside(self.demand.shape, times)
        torque, speed = values[:, :-1], np.maximum(np.abs(values[:, -1]), np.finfo(float).tiny)
        polynomials, windows = [], []
        for (left, high), (right, low) in zip(self.curve[:-1], self.curve[1:], strict=True):
            slope = (low - high) / (right - left)
            line = np.zeros_like(torque)
            line[:, 0] = high - slope * left + AT * self.curve[0, 1]
            line[:, self.speed_power] += slope * speed
            window = np.stack([left / speed, right / speed], axis=1)
            if not self.speed_power:
                window = np.where((window[:, :1] <= 1) & (window[:, 1:] >= 1), [[0.0, np.inf]], 0.0)
            for sign in (1.0, -1.0):
                polynomials.append(sign * torque - line)
                windows.append(window)
        return Rows(np.concatenate(polynomials), np.concatenate(windows))

    def peaks(self, x: Array) -> tuple[Array, Array]:
        """As `Demand`."""
        share, times = np.array([self._peak(value) for value in x.tolist()]).T[:, :, None]
        return share, times

    def _peak(self, x: float) -> tuple[float, float]:
        """Largest share of the curve at x, and its instant."""
        torque = functools.reduce(operator.add, (part * x**k for k, part in enumerate(self.parts)))
        speed = x**self.speed_power
        if not speed:
            peak = torque.extrema()
            return float(peak.peak[0]) / self.ratio / float(self.curve[0, 1]), float(peak.t_peak[0])
        velocity = self.trajectory.derivative(1)[self.joint] * (speed * self.rate)
        motor = _motor(torque, velocity, self.trajectory.direction[self.joint], self.ratio)
        ratio, _, _, time = torque_at_speed(motor, self.curve)
        return ratio, time
