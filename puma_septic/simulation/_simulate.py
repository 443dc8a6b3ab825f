"""Simulate an arm that follows a trajectory."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Final

import numpy as np

from puma_septic.dynamics import check_inertia
from puma_septic.errors import InputError
from puma_septic.motion import check_joints
from puma_septic.robot import Robot
from puma_septic.simulation._controller import Controller, Gains, controller_of, reference_at
from puma_septic.simulation._elasticity import ElasticJoints
from puma_septic.simulation._integration import Commander, Schedule, run
from puma_septic.simulation._plant import Plant
from puma_septic.simulation._simulation import Simulation
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_number

__all__ = ["LARGEST_STEP", "REST_SPEED", "simulate", "simulate_all"]

REST_SPEED: Final = 5e-3
"""Default speed over which dry friction rises at rest, rad/s (m/s): under a hundredth of what arms move at."""

LARGEST_STEP: Final = 5e-4
"""Default of the integrator's largest step, s."""


def simulate(
    robot: Robot,
    trajectory: Trajectory,
    *,
    controller: Controller | str = "computed_torque",
    elastic: ElasticJoints | None = None,
    settle: float = 0.5,
    step: float | None = None,
    rest_speed: float = REST_SPEED,
) -> Simulation:
    """Track a trajectory with the simulated arm, and measure how well.

    The arm has its rotors, friction, payload, wrench and gravity, and its torques end at its effort limits (no limit
    where one is not known). It starts on the plan and goes on for a while after the motion, told to stay at its last
    point. Dry friction, a step at rest, is made smooth: its way is ``tanh(v / rest_speed)``, so that an arm that should
    stick creeps at up to about `rest_speed`. The classical Runge-Kutta method integrates at a fixed step.
    The same inputs give the same samples.

    Parameters
    ----------
    robot : Robot
        The arm as it is; what the controller takes it for is ``controller.model``.
    trajectory : Trajectory
    controller : Controller or str
        Or the name of a law, see `LAWS`.
    elastic : ElasticJoints, optional
        Springs and dampers between motors and links; None: rigid. The controller sees the motors.
    settle : float
        How long to go on after the motion, s; rounded up to whole control periods.
    step : float, optional
        Largest step of the integrator, s; a control period is divided into equal steps. None: 0.5 ms, or less where
        friction or springs ask for it.
    rest_speed : float
        rad/s (m/s).

    Returns
    -------
    Simulation
        Where the arm leaves its plan for good, the part until then and its `Divergence`.

    Raises
    ------
    InputError
        If the joints do not match, a rate or delay does not fit the motion, a step is too large for friction or
        springs, or the gears lose a part of their load.
    ModelError
        If the robot description has no inertia for a moving part.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.2] * 6], [0.0, 0.5])
    >>> result = ps.simulate(ps.load_robot(), move, controller="pd_gravity", settle=0.1)
    >>> result.has_diverged, len(result.t)
    (False, 601)
    """
    return simulate_all(
        robot,
        [trajectory],
        controller=controller,
        elastic=None if elastic is None else [elastic],
        settle=settle,
        step=step,
        rest_speed=rest_speed,
    )[0]


def simulate_all(
    robot: Robot,
    trajectories: Sequence[Trajectory],
    *,
    controller: Controller | str = "computed_torque",
    elastic: Sequence[ElasticJoints] | None = None,
    settle: float = 0.5,
    step: float | None = None,
    rest_speed: float = REST_SPEED,
) -> tuple[Simulation, ...]:
    """Several trajectories under the same controller, each by itself, computed side by side.

    Parameters
    ----------
    robot : Robot
    trajectories : sequence of Trajectory
    elastic : sequence of ElasticJoints, optional
        One for each trajectory.
    controller, settle, step, rest_speed
        As in `simulate`.

    Returns
    -------
    tuple of Simulation

    Raises
    ------
    InputError, ModelError
        As `simulate`.
    """
    chosen = controller_of(controller)
    _check(robot, trajectories, chosen)
    settle = checked_number("settle", settle, unit="s", at_least=0.0)
    rest_speed = checked_number("rest_speed", rest_speed, unit="rad/s", above=0.0)
    springs = () if elastic is None else tuple(elastic)
    if springs and len(springs) != len(trajectories):
        raise InputError(f"elastic: {len(springs)} given for {len(trajectories)} trajectories")
    plant = Plant.of(robot, springs, rest_speed)
    q, v = _starts(trajectories)
    largest = _checked_step(step, min(plant.largest_step(row) for row in q))
    schedule = _schedule(trajectories, chosen, settle, largest)
    commander = _commander(robot, chosen, q, rest_speed)
    records = run(plant, commander, trajectories, schedule, plant.state(q, v))
    return tuple(
        Simulation(
            robot=robot,
            trajectory=trajectory,
            controller=chosen,
            elastic=springs[row] if springs else None,
            rate=np.inf if chosen.is_continuous else 1 / float(schedule.periods[row]),
            step=float(schedule.periods[row]) / schedule.parts,
            rest_speed=rest_speed,
            saved=record,
        )
        for row, (trajectory, record) in enumerate(zip(trajectories, records, strict=True))
    )


def _starts(trajectories: Sequence[Trajectory]) -> tuple[Array, Array]:
    """Where and how fast each row begins, shape (n_rows, n_joints): on its plan, at rest where that begins at rest."""
    starts = [reference_at(trajectory, np.zeros(1)) for trajectory in trajectories]
    moving = np.array([[not trajectory.rest_before] for trajectory in trajectories])
    return np.concatenate([start.q for start in starts]), moving * np.concatenate([start.v for start in starts])


def _commander(robot: Robot, controller: Controller, q: Array, rest_speed: float) -> Commander:
    """With the gains of each row's first point."""
    model = robot if controller.model is None else controller.model
    gains = [controller.gains_for(model, row) for row in q]
    return Commander(
        controller=controller,
        model=model,
        gains=Gains(*(np.stack(parts) for parts in zip(*gains, strict=True))),
        limits=np.where(np.isnan(robot.limits.effort), np.inf, robot.limits.effort),
        rest_speed=rest_speed,
    )


def _check(robot: Robot, trajectories: Sequence[Trajectory], controller: Controller) -> None:
    if not trajectories:
        raise InputError("a simulation needs at least one trajectory")
    for trajectory in trajectories:
        check_joints(robot, trajectory)
    check_inertia(robot)
    model = controller.model
    if model is not None and model.joint_names != robot.joint_names:
        raise InputError(
            f"the controller's model {model.name!r} has the joints {', '.join(model.joint_names)}, the arm"
            f" {robot.name!r} {', '.join(robot.joint_names)}"
        )
    for name in ("bandwidth", "encoder_resolution"):
        value = np.asarray(getattr(controller, name))
        if value.ndim and len(value) != robot.n_joints:
            raise InputError(f"{name}: {len(value)} values given, robot {robot.name!r} has {robot.n_joints} joints")


def _checked_step(step: float | None, stable: float) -> float:
    if step is None:
        return min(LARGEST_STEP, stable)
    largest = checked_number("step", step, unit="s", above=0.0)
    if largest > stable * (1 + 1e-9):
        raise InputError(
            f"step = {largest:g} s: friction at rest or the springs need at most {stable:.3g} s; a larger rest_speed"
            " needs less"
        )
    return largest


def _schedule(trajectories: Sequence[Trajectory], controller: Controller, settle: float, largest: float) -> Schedule:
    durations = np.array([trajectory.duration for trajectory in trajectories])
    if controller.is_continuous:
        counts = np.array([ceil(duration / largest * (1 - 1e-12)) for duration in durations])
        periods, parts = durations / counts, 1
    else:
        counts = np.array([controller.periods(duration) for duration in durations])
        periods = durations / counts
        parts = ceil(float(periods.max()) / largest * (1 - 1e-9))
        for period in periods:
            controller.delayed_periods(float(period))
    after = np.ceil(settle / periods * (1 - 1e-12)).astype(np.int64)
    return Schedule(periods=periods, counts=counts + after, parts=parts)
