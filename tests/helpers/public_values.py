"""One value of each public type, for tests that hold all of them to the same promises."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

import puma_septic as ps
from puma_septic.task import make_task, resolve_cycle

CYCLE = {
    "name": "there and back",
    "points": [
        {"name": "home", "joints": [0.0, 0.5, -2.5, 0.0, 0.7, 0.0]},
        {"name": "side", "joints": [0.3, 0.8, -2.5, 0.0, 0.7, 0.0]},
    ],
    "cycle": [
        {"to": "side", "duration": 1.0, "profile": "quintic"},
        {"dwell": 0.2},
        {"to": "home", "duration": 1.0, "profile": "quintic"},
    ],
}
VIAS = [[0.0] * 6, [0.4] * 6, [0.5] * 6]


@cache
def assessment() -> ps.Assessment:
    return ps.assess(ps.load_robot(), ps.profiles.quintic_spline(VIAS, [0.0, 1.0, 2.0]))


@cache
def cycle() -> ps.Cycle:
    return ps.cycle.with_return(assessment().motion, dwell=0.5)


@cache
def task() -> ps.ResolvedTask:
    return ps.resolve_task(ps.load_task("paper-turned"))


@cache
def whole_cycle() -> Any:
    return resolve_cycle(make_task(CYCLE))


def hop() -> ps.Trajectory:
    return ps.quintic_segments([[0.0] * 6, [0.02] * 6], [0.0, 0.1])


def pose() -> Any:
    return ps.forward_kinematics(ps.load_robot(), [0.3, 0.8, -2.9, 0.0, 0.7, 0.0])


# A maker of each public type; the reprs of errors are those of all exceptions.
VALUES: dict[str, Callable[[], Any]] = {
    "AccelerationLimits": lambda: ps.acceleration_limits(ps.load_robot(), gap=0.5),
    "Actuator": lambda: ps.load_robot().actuators[0],
    "Assessment": assessment,
    "Catalogue": lambda: ps.built_in_catalogue("example"),
    "Comparison": lambda: ps.compare(ps.load_robot(), VIAS, [0.0, 1.0, 2.0], profiles=["quintic", "linear"]),
    "Controller": lambda: ps.Controller(law="pd", rate=500.0),
    "Cycle": cycle,
    "CycleAssessment": lambda: ps.assess_cycle(cycle()),
    "Drive": lambda: ps.Drive(name="amplifier", bus_voltage=48.0),
    "Drivetrain": lambda: ps.own_drivetrains(ps.load_robot())[0],
    "Dwell": lambda: ps.Dwell(0.5),
    "ElasticJoints": lambda: ps.ElasticJoints.of_frequency(ps.load_robot(), [0.0] * 6, 12.0),
    "Execution": lambda: ps.execute(ps.load_robot(), {"quintic": hop()}, settle=0.0),
    "Friction": lambda: ps.Friction(viscous=0.1, coulomb=[0.3, -0.3]),
    "Gearbox": lambda: ps.Gearbox(ratio=100.0),
    "IkSolutions": lambda: ps.inverse_kinematics(ps.load_robot(), pose()),
    "LeastTime": lambda: ps.least_time(
        ps.profiles.cubic_spline, VIAS, [0.0, 1.0, 2.0], robot=ps.load_robot(), restarts=0
    ),
    "Limits": lambda: ps.load_robot().limits,
    "LinearStage": lambda: ps.LinearStage(kind="screw", travel_per_turn=0.01, efficiency=0.9),
    "ManyAssessments": lambda: ps.assess_many(ps.load_robot(), [hop()]),
    "ManyVerdicts": lambda: ps.judge_many(ps.load_robot(), [hop()]),
    "MaximumPayload": lambda: ps.maximum_payload(assessment().motion),
    "MinimumDuration": lambda: ps.minimum_duration(assessment().motion),
    "Motion": lambda: assessment().motion,
    "Motor": lambda: ps.Motor(name="<b>F60</b>", rotor_inertia=1e-4, peak_torque=3.0),
    "OptimisedTimes": lambda: ps.optimise_via_times(
        ps.profiles.quintic_spline, [[0.0], [0.4], [1.0]], [0.0, 1.0, 2.0], restarts=0
    ),
    "ParetoFront": lambda: ps.pareto_front(
        ps.profiles.quintic_spline,
        [[0.0], [0.4], [1.0]],
        [0.0, 1.0, 2.0],
        objectives=["integral_of_squared_jerk", "overshoot"],
        size=3,
    ),
    "PayloadPolygon": lambda: ps.payload_polygon(ps.load_robot(), [[0.0, 0.5, -2.5, 0.0, 0.7, 0.0]]),
    "Payload": lambda: ps.Payload(2.0),
    "Piecewise": lambda: assessment().motion.torque,
    "Replay": lambda: ps.replay(assessment(), open_browser=False),
    "ResolvedCycle": lambda: ps.resolve_cycle(ps.load_task("paper-straight")),
    "ResolvedTask": task,
    "Robot": ps.load_robot,
    "Selection": lambda: ps.size(cycle(), catalogue=ps.built_in_catalogue("example")),
    "Simulation": lambda: ps.simulate(ps.load_robot(), hop(), settle=0.0),
    "Sizing": lambda: ps.size(cycle()),
    "Supply": lambda: ps.Supply(name="48 V", bus_voltage=48.0),
    "Sweep": lambda: ps.duration_sweep(assessment().motion, [2.0, 3.0]),
    "Task": lambda: ps.load_task("paper"),
    "Trajectory": lambda: assessment().motion.trajectory,
    "TrajectoryCheck": lambda: ps.check_trajectory(ps.load_robot(), assessment().motion.trajectory),
    "WorstHolding": lambda: ps.worst_holding_torque(ps.load_robot()),
    "Wrench": lambda: ps.Wrench(force=[0.0, 0.0, 5.0]),
}
# Those that take more than a moment to make.
SLOW = ("Execution", "Simulation", "Selection", "Sizing", "ParetoFront", "Replay", "AccelerationLimits")
ONE_OF_EACH = [pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else []) for name in VALUES]
