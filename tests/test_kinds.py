"""Another kind of value in place of one of ours is told at the door, by the argument's name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import puma_septic as ps
from puma_septic import paths
from puma_septic.limits import payload_duration_map
from puma_septic.validation import checked_kind, checked_list, checked_texts, checked_whole

PUMA = ps.load_robot()
Q = [0.0, 0.5, -2.5, 0.0, 0.7, 0.0]
MOVE = ps.quintic_segments([Q, [0.1] * 6], [0.0, 1.0], joint_names=PUMA.joint_names)
MOTION = ps.compute_motion(PUMA, MOVE)
RESULT = ps.assess(MOTION)
LINE = paths.line(ps.forward_kinematics(PUMA, Q), ps.forward_kinematics(PUMA, Q)[:3, 3] + [0.0, 0.0, 0.01])

ROBOTS: dict[str, Callable[[Any], Any]] = {
    "acceleration_limits": lambda x: ps.acceleration_limits(x),
    "assess": lambda x: ps.assess(x, MOVE),
    "assess_many": lambda x: ps.assess_many(x, [MOVE]),
    "check_trajectory": lambda x: ps.check_trajectory(x, MOVE),
    "compare": lambda x: ps.compare(x, [Q, Q], [0.0, 1.0]),
    "compute_motion": lambda x: ps.compute_motion(x, MOVE),
    "forward_dynamics": lambda x: ps.forward_dynamics(x, Q, Q, Q),
    "forward_kinematics": lambda x: ps.forward_kinematics(x, Q),
    "inverse_dynamics": lambda x: ps.inverse_dynamics(x, Q, Q, Q),
    "inverse_kinematics": lambda x: ps.inverse_kinematics(x, np.eye(4)),
    "inverse_kinematics_batch": lambda x: ps.inverse_kinematics_batch(x, np.eye(4)[None]),
    "jacobian": lambda x: ps.jacobian(x, Q),
    "load_drivetrains": lambda x: ps.load_drivetrains(x),
    "lowest_points": lambda x: ps.lowest_points(x, Q),
    "own_drivetrains": lambda x: ps.own_drivetrains(x),
    "payload_polygon": lambda x: ps.payload_polygon(x, [Q]),
    "tool_motion": lambda x: ps.tool_motion(x, Q, Q, Q),
    "torque_terms": lambda x: ps.torque_terms(x, Q, Q, Q),
    "worst_holding_torque": lambda x: ps.worst_holding_torque(x),
    "doctor.examine": lambda x: ps.doctor.examine(x),
    "doctor.doubts": lambda x: ps.doctor.doubts(x),
    "stiffness_for": lambda x: ps.vibration.stiffness_for(x, Q, 9.0),
    "with_drive_masses": lambda x: ps.sizing.with_drive_masses(x, [1.0] * 6),
    "tool_rates": lambda x: paths.tool_rates(x, MOVE),
    "follow": lambda x: paths.follow(x, LINE),
}
MOTIONS: dict[str, Callable[[Any], Any]] = {
    "duration_sweep": lambda x: ps.duration_sweep(x, [1.0]),
    "maximum_payload": lambda x: ps.maximum_payload(x),
    "minimum_duration": lambda x: ps.minimum_duration(x),
    "payload_duration_map": lambda x: payload_duration_map(x, [1.0], [1.0]),
    "payload_sweep": lambda x: ps.payload_sweep(x, [1.0]),
    "stop": lambda x: ps.stop(x, 0.5),
    "torque_uncertainty": lambda x: ps.torque_uncertainty(x),
    "way back": lambda x: ps.cycle.with_return(x),
    "payload_over_duration": lambda x: ps.payload_over_duration(x, [1.0]),
}
OTHERS: dict[str, Callable[[Any], Any]] = {
    "at_speed": lambda x: paths.at_speed(x, speed=1.0, acceleration=1.0),
    "trajectory of check_trajectory": lambda x: ps.check_trajectory(PUMA, x),
    "trajectories of assess_many": lambda x: ps.assess_many(PUMA, x),
    "residual_vibration": lambda x: ps.residual_vibration(x, 5.0),
    "steps": lambda x: ps.Cycle(steps=x),
    "size": lambda x: ps.size(x),
    "assess_cycle": lambda x: ps.assess_cycle(x),
    "drivetrain's motor": lambda x: ps.Drivetrain(motor=x),
    "drivetrain's gearbox": lambda x: ps.Drivetrain(gearbox=x),
    "drivetrain's drive": lambda x: ps.Drivetrain(drive=x),
    "limits": lambda x: PUMA.with_limits(x) if x is not None else PUMA.with_limits(1),
    "actuators": lambda x: PUMA.with_actuators(x),
    "drivetrains": lambda x: PUMA.with_drivetrains(x),
    "trajectories of judge_many": lambda x: ps.judge_many(PUMA, x),
    "fit_residual": lambda x: ps.fit_residual(x),
    "path of follow": lambda x: paths.follow(PUMA, x),
    "path of in_time": lambda x: paths.in_time(x, 1.0),
    "law": lambda x: paths.timed(paths.follow(PUMA, LINE), x),
    "way": lambda x: paths.timed(x, paths.in_time(LINE, 1.0)),
    "trajectory of tool_rates": lambda x: paths.tool_rates(PUMA, x),
    "shaper": lambda x: ps.vibration.shaped(MOVE, x),
    "trajectory of shaped": lambda x: ps.vibration.shaped(x, ps.vibration.input_shaper("zv", 9.0)),
    "nulling_durations": lambda x: ps.vibration.nulling_durations(x, 9.0, longest=1.0),
    "trajectories of execute": lambda x: ps.execute(PUMA, x) if x != {"a": 1} else ps.execute(PUMA, 1),
    "cycle of joint_load": lambda x: ps.sizing.joint_load(x, 0),
    "resolved": lambda x: ps.sizing.load_cases_of(x),
    "motors": lambda x: ps.Catalogue(motors=[x], gearboxes=[]),
    "position of a trajectory": lambda x: ps.Trajectory(position=x, points=[[0.0], [1.0]], times=[0.0, 1.0]),
    "motion that is written": lambda x: ps.write_joint_trajectory("never.yaml", x),
    "profile to be optimised": lambda x: ps.optimise_via_times(x, [Q, Q, Q], [0.0, 1.0, 2.0]),
    "what of a report": lambda x: ps.report_html(x),
    "what of a replay": lambda x: ps.replay_html(x),
}
PLACES: dict[str, Callable[[Any], Any]] = {
    "load_robot": lambda x: ps.load_robot(x),
    "load_task": lambda x: ps.load_task(x),
    "load_drivetrains": lambda x: ps.load_drivetrains(PUMA, x),
    "load_catalogue": lambda x: ps.load_catalogue(x, "g.csv"),
    "read_log": lambda x: ps.read_log(x),
    "read_joint_trajectory": lambda x: ps.read_joint_trajectory(x, PUMA),
    "package_dirs": lambda x: ps.load_robot(package_dirs=[x]),
    "actuators of load_robot": lambda x: ps.load_robot(actuators=x),
    "load_study": lambda x: ps.load_study(x),
    "write_report": lambda x: ps.write_report(x, RESULT),
    "write_replay": lambda x: ps.write_replay(x, MOTION),
    "write_joint_trajectory": lambda x: ps.write_joint_trajectory(x, MOVE),
}
LISTS: dict[str, Callable[[Any], Any]] = {
    "joint names of a trajectory": lambda x: ps.Trajectory(
        position=MOVE.position, points=MOVE.points, times=MOVE.times, joint_names=x
    ),
    "own": lambda x: ps.compare(PUMA, [Q, [0.1] * 6], [0.0, 1.0], own=x),
    "joints of a load case": lambda x: ps.sizing.LoadCase(name="c", cycle=ps.cycle.with_return(MOTION), joints=x),
    "joint_names": lambda x: ps.septic([[0.0]] * 4, [0.0, 1.0, 2.0, 3.0], joint_names=x),
    "names": lambda x: ps.assess_cycle(ps.cycle.with_return(MOTION), names=x),
    "allow": lambda x: ps.check_trajectory(PUMA, MOVE, allow=x),
    "labels": lambda x: ps.replay_html(MOTION, labels=x),
    "point_names": lambda x: ps.replay_html(MOTION, point_names=x),
    "notes": lambda x: ps.report_html(RESULT, notes=x),
    "units": lambda x: ps.read_log("none.csv", units=x),
}
STRANGE = [True, 3, 2.5, "x", object(), float("nan"), b"1", {"a": 1}]


@pytest.mark.parametrize("value", [None, *STRANGE], ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("name", [*ROBOTS, *MOTIONS, *OTHERS])
def test_what_is_none_of_ours_is_refused(name: str, value: Any) -> None:
    """Some 45 public functions answered True in place of a robot with "'bool' object has no attribute 'n_joints'"."""
    with pytest.raises(
        ps.InputError, match=r"expected|takes|made of|shows|not a|needed|needs|cannot be|steps\[0\]|at least one"
    ):
        (ROBOTS | MOTIONS | OTHERS)[name](value)


@pytest.mark.parametrize("value", [True, 1, 2.5, object(), b"1", ["a"]], ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("name", PLACES)
def test_a_number_is_no_path(name: str, value: Any) -> None:
    """`open` takes 1 for the standard output: `read_log(True)` read it and closed it."""
    with pytest.raises(ps.InputError, match=r"expected the path of a|expected a list"):
        PLACES[name](value)


@pytest.mark.parametrize("value", [True, 3, [1, 2], object()], ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("name", LISTS)
def test_what_is_no_list_of_texts_is_refused(name: str, value: Any) -> None:
    with pytest.raises(ps.InputError, match=r"expected|labels: "):
        LISTS[name](value)


def test_whole_numbers() -> None:
    assert checked_whole("n", np.int64(3), at_least=1) == 3
    for value in (3.0, True, "3", None, 0, 10, np.array([3])):
        with pytest.raises(ps.InputError, match=r"^n = .*: expected a whole number from 1 to 9$"):
            checked_whole("n", value, at_least=1, at_most=9)
    for degree in (3.0, True, "3", np.array(5.0, dtype=object), 4):
        with pytest.raises(ps.InputError, match=r"degree = .* is not one of 3, 5"):
            ps.profiles.bspline([[0.0], [1.0]], [0.0, 1.0], degree=degree)


@pytest.mark.parametrize("order", [1.0, "1", None, np.array([1.0]), np.array(1.0, dtype=object), 4, -1], ids=repr)
def test_an_order_is_one_of_four(order: Any) -> None:
    for ask in (MOVE.derivative, MOVE.extrema, MOVE.jumps, lambda order: MOVE(0.5, order)):
        with pytest.raises(ps.InputError, match="is not one of 0"):
            ask(order)


def test_kinds_lists_and_texts() -> None:
    assert checked_kind("robot", PUMA, ps.Robot) is PUMA
    with pytest.raises(ps.InputError, match=r"^payload: expected Payload or Wrench\(\.\.\.\), got 1$"):
        checked_kind("payload", 1, (ps.Payload, ps.Wrench))
    with pytest.raises(ps.InputError, match=r"^parameters: expected a text, got 3$"):
        ps.load_robot(parameters=3)  # type: ignore[arg-type]
    assert checked_list("x", iter((1, 2))) == (1, 2)
    assert checked_texts("x", None) == ()
    for value in ("ab", b"ab", 3):
        with pytest.raises(ps.InputError, match=r"^x: expected a list"):
            checked_texts("x", value)


COUNTS: dict[str, Callable[[Any], Any]] = {
    "samples": lambda x: ps.torque_uncertainty(MOTION, mass=0.1, samples=x),
    "starts": lambda x: ps.inverse_kinematics(PUMA, np.eye(4), starts=x),
    "restarts": lambda x: ps.optimise_via_times(ps.septic, [Q] * 4, [0.0, 1.0, 2.0, 3.0], restarts=x),
    "size": lambda x: ps.pareto_front(
        ps.profiles.cubic_spline, [Q, [0.1] * 6, Q], 2.0, objectives=("duration", "overshoot"), size=x
    ),
    "port": lambda x: ps.replay(MOTION, open_browser=False, port=x),
    "j": lambda x: ps.sizing.joint_load(ps.cycle.with_return(MOTION), x),
}  # fmt: skip


@pytest.mark.parametrize("value", [2.0, "3", -1, 10**400], ids=lambda one: str(one)[:9])
@pytest.mark.parametrize("name", COUNTS)
def test_a_count_is_a_whole_number_within_bounds(name: str, value: Any) -> None:
    """10**400 samples were NumPy's ValueError, 32.7 starts 32 of them."""
    with pytest.raises(ps.InputError, match=rf"^{name} = .*: expected a whole number from \d+ to \d+$"):
        COUNTS[name](value)


def test_a_generator_is_one() -> None:
    for call in (
        lambda: ps.torque_uncertainty(MOTION, mass=0.1, rng=0),  # type: ignore[arg-type]
        lambda: ps.inverse_kinematics(PUMA, np.eye(4), rng="x"),  # type: ignore[arg-type]
    ):
        with pytest.raises(ps.InputError, match=r"^rng: expected Generator\(\.\.\.\), got"):
            call()
