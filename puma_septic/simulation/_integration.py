"""The loop of a simulation: a controller that samples, and a plant integrated between its samples.

The integrator is the classical Runge-Kutta method of order 4 at a fixed step; where torques are held between samples,
each of these falls on a step, so that the order is kept. Rows are simulated side by side, each at its own step.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.robot import Robot
from puma_septic.simulation._controller import (
    TORQUE,
    Controller,
    Gains,
    Reference,
    planned_torque,
    references,
    smooth_friction,
)
from puma_septic.simulation._plant import POSITION, Plant
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["Divergence", "Record", "Schedule", "run"]

# A joint that is half a turn (or 1 m) off its plan follows nothing any more.
_LOST: Final = {False: np.pi, True: 1.0}


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Divergence:
    """A joint that left its plan for good.

    Attributes
    ----------
    time : float
        s since the start of the motion.
    joint : str
    error : float
        Measured less planned position, rad (m); infinite where it is no number any more.
    """

    time: float
    joint: str
    error: float


class Schedule(NamedTuple):
    """When the controller samples: in `counts` periods of length `periods` (n_rows,), each of `parts` steps."""

    periods: Array
    counts: NDArray[np.int64]
    parts: int


class Record(NamedTuple):
    """What is kept of one row, a sample per control period (per step of a continuous controller).

    Shapes (n,), (n, n_parts, n_joints), and (n, n_joints): the torque from each sample on, before and after saturation.
    """

    t: Array
    states: Array
    commanded: Array
    applied: Array
    divergence: Divergence | None


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Commander:
    """A controller on a schedule: keeps what it measured, its integral, and torques that are still on their way."""

    controller: Controller
    model: Robot
    gains: Gains
    limits: Array
    rest_speed: float

    def planned(self, want: Reference) -> Array:
        """What its law adds to the feedback at each instant of a reference."""
        if self.controller.law == "feedforward":
            return planned_torque(self.model, want, self.rest_speed)
        if self.controller.law == "computed_torque":
            return smooth_friction(self.model, want.v, self.rest_speed)
        return np.zeros_like(want.q)

    def torque(self, want: Reference, planned: Array, q: Array, v: Array, integral: Array) -> Array:
        """Before saturation."""
        feedback = TORQUE[self.controller.law](self.model, self.gains, want, planned, q, v)
        return feedback + integral if self.integrates else feedback

    @property
    def integrates(self) -> bool:
        """Whether its law has an integral."""
        return self.controller.law == "pid"


def run(
    plant: Plant, commander: Commander, trajectories: Sequence[Trajectory], schedule: Schedule, state: Array
) -> list[Record]:
    """Simulate all rows to the end of their schedules, or until they diverge."""
    total = int(schedule.counts.max())
    n_rows, n = state.shape[1:]
    states = np.empty((total + 1, *state.shape))
    commanded, applied = np.empty((total + 1, n_rows, n)), np.empty((total + 1, n_rows, n))
    want = references(trajectories, np.arange(total + 1)[:, None] * schedule.periods)
    begun = _continuous if commander.controller.is_continuous else _discrete
    advance = begun(plant, commander, trajectories, schedule, want)
    lost: dict[int, _Loss] = {}
    # An arm that moves freely has no plan to leave.
    is_free, slides = commander.controller.law == "none", plant.robot.is_prismatic
    far = np.full(n, np.finfo(float).max) if is_free else np.where(slides, _LOST[True], _LOST[False])
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(total + 1):
            _note_lost(state, want.q[k], plant, schedule, lost, k, far)
            if len(lost) == n_rows:
                break
            states[k] = state
            state, commanded[k], applied[k] = advance(k, state)
    records = []
    for row, period in enumerate(schedule.periods):
        loss = lost.get(row)
        count = int(schedule.counts[row]) + 1 if loss is None else loss.sample
        records.append(
            Record(
                t=np.arange(count) * period,
                states=states[:count, :, row].copy(),
                commanded=commanded[:count, row].copy(),
                applied=applied[:count, row].copy(),
                divergence=None if loss is None else loss.divergence,
            )
        )
    return records


class _Loss(NamedTuple):
    sample: int
    divergence: Divergence


def _note_lost(
    state: Array, want: Array, plant: Plant, schedule: Schedule, lost: dict[int, _Loss], k: int, far: Array
) -> None:
    """Note rows that diverge, and put them where they should be, so that the others go on."""
    robot = plant.robot
    error = state[plant.motor.start] - want
    is_sound = np.abs(error) <= far  # no number is within anything
    if is_sound.all():
        return
    for row in np.flatnonzero(~is_sound.all(axis=1)).tolist():
        size = np.where(np.isfinite(error[row]), np.abs(error[row]) / far, np.inf)
        size = np.where(is_sound[row], -1.0, size)
        j = int(np.argmax(size))
        value = float(error[row, j]) if np.isfinite(error[row, j]) else np.inf
        divergence = Divergence(time=float(k * schedule.periods[row]), joint=robot.joint_names[j], error=value)
        lost.setdefault(row, _Loss(k, divergence))
        state[:, row] = 0.0
        state[POSITION, row] = state[plant.motor.start, row] = want[row]


Advance = Callable[[int, Array], tuple[Array, Array, Array]]


def _discrete(
    plant: Plant, commander: Commander, _trajectories: Sequence[Trajectory], schedule: Schedule, want: Reference
) -> Advance:
    """A controller that measures at each period and holds its torque over it."""
    controller, limits = commander.controller, commander.limits
    planned = commander.planned(want)
    periods = schedule.periods[:, None]
    step = periods / schedule.parts
    resolution = np.asarray(controller.encoder_resolution, dtype=np.float64)
    is_quantised, estimates = bool(resolution.any()), controller.estimates_velocity
    smoothing = 1 - np.exp(-2 * np.pi * controller.velocity_filter * periods)
    waiting = [np.zeros_like(want.q[0])] * controller.delayed_periods(float(schedule.periods[0]))
    before: Array | None = None
    speed = want.v[0].copy()
    integral = np.zeros_like(want.q[0])

    def advance(k: int, state: Array) -> tuple[Array, Array, Array]:
        nonlocal before, speed, integral
        q, v = state[plant.motor]
        if is_quantised:
            q = np.where(resolution > 0, np.round(q / np.where(resolution > 0, resolution, 1.0)) * resolution, q)
        if estimates:
            raw = speed if before is None else (q - before) / periods
            speed = speed + smoothing * (raw - speed)
            before, v = q, speed
        command = commander.torque(want.at(k), planned[k], q, v, integral)
        waiting.append(command)
        due = waiting.pop(0)
        tau = np.minimum(np.maximum(due, -limits), limits)
        if commander.integrates:  # but not where the actuator is at its limit
            integral = integral + np.where(tau == due, commander.gains.integral * (want.q[k] - q) * periods, 0.0)
        for _ in range(schedule.parts):
            state = _rk4(plant, state, step, (tau, tau, tau))
        return state, due, tau

    return advance


def _continuous(
    plant: Plant, commander: Commander, trajectories: Sequence[Trajectory], schedule: Schedule, want: Reference
) -> Advance:
    """A controller that is evaluated at each stage of the integrator; its integral grows from step to step."""
    limits = commander.limits
    step = schedule.periods[:, None]
    instants = np.arange(len(want.q))[:, None] * schedule.periods
    middle = references(trajectories, instants + schedule.periods / 2)
    end = references(trajectories, instants + schedule.periods, from_left=True)
    added = [commander.planned(one) for one in (want, middle, end)]
    integral = np.zeros_like(want.q[0])

    def advance(k: int, state: Array) -> tuple[Array, Array, Array]:
        nonlocal integral

        def torque(stage: int, at: Array) -> Array:
            q, v = at[plant.motor]
            return commander.torque((want, middle, end)[stage].at(k), added[stage][k], q, v, integral)

        def applied(stage: int, at: Array) -> Array:
            return np.minimum(np.maximum(torque(stage, at), -limits), limits)

        command = torque(0, state)
        q = state[plant.motor][0]
        new = _rk4_closed(plant, state, step, applied)
        middle_error = (want.q[k] - q + end.q[k] - new[plant.motor][0]) / 2
        integral = integral + commander.gains.integral * middle_error * step
        return new, command, np.clip(command, -limits, limits)

    return advance


def _rk4(plant: Plant, state: Array, step: Array, torques: tuple[Array, Array, Array]) -> Array:
    return _rk4_closed(plant, state, step, lambda stage, _: torques[stage])


def _rk4_closed(plant: Plant, state: Array, step: Array, torque: Callable[[int, Array], Array]) -> Array:
    """One step of the classical Runge-Kutta method, with the torque at its start, middle and end."""
    one = plant.slope(state, torque(0, state))
    at = state + step / 2 * one
    two = plant.slope(at, torque(1, at))
    at = state + step / 2 * two
    three = plant.slope(at, torque(1, at))
    at = state + step * three
    four = plant.slope(at, torque(2, at))
    two += three
    two *= 2
    one += four
    one += two
    return np.asarray(state + step / 6 * one)
