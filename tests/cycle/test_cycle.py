"""Duty cycles: joins, payload changes, dwells, and metrics over the whole."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.arms import DRIVE, link, load, pendulum
from helpers.arms import joint as joint_text
from helpers.duty import LOAD, paper_motion
from helpers.moves import POINTS, TIMES
from hypothesis import given, settings
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.piecewise import Piecewise

# Series are fitted to 1e-11 of each joint's largest torque; the rest is room.
EXACT = 1e-9


def rest_to_rest(robot: ps.Robot, start: float, end: float, duration: float = 1.0) -> ps.Motion:
    points = np.array([np.full(robot.n_joints, start), np.full(robot.n_joints, end)])
    return ps.compute_motion(robot, ps.quintic_segments(points, [0.0, duration]))


def steady(robot: ps.Robot, start: float, speed: float, duration: float) -> ps.Motion:
    """At constant speed from a start."""
    powers = [[[start]], [[speed * duration]]]
    times = np.array([0.0, duration])
    position = Piecewise.from_power(times, powers)
    return ps.compute_motion(robot, ps.Trajectory(position=position, points=position(times), times=times))


# ---- sequence


def test_a_cycle_is_its_steps_one_after_the_other() -> None:
    motion = paper_motion()
    cycle = ps.cycle.with_return(motion, dwell=0.5)
    np.testing.assert_allclose(cycle.starts, [0.0, 9.0, 9.5, 18.5, 19.0], rtol=1e-15)
    assert cycle.is_periodic
    t = np.linspace(0.0, 8.99, 50)
    np.testing.assert_allclose(cycle.trajectory(t), motion.trajectory(t), atol=1e-13)
    np.testing.assert_allclose(cycle.torque(t), motion.torque(t), rtol=EXACT, atol=1e-10)
    # The way back is the way there in reversed time: positions equal, velocities opposite.
    np.testing.assert_allclose(cycle.trajectory(18.5 - t[1:]), motion.trajectory(t[1:]), atol=1e-12)
    np.testing.assert_allclose(cycle.trajectory(18.5 - t[1:], 1), -motion.trajectory(t[1:], 1), atol=1e-11)


def test_load_torque_is_that_of_the_arm_without_drives() -> None:
    cycle = ps.cycle.with_return(paper_motion(loaded=True), dwell=0.5, robot_back=ps.load_robot())
    blank = (ps.robot.Actuator(),) * 6
    for robot, t in (
        (ps.load_robot().with_payload(LOAD), np.linspace(0.0, 9.49, 40)),
        (ps.load_robot(), np.linspace(9.5, 18.99, 40)),
    ):
        q, v, a = (cycle.trajectory(t, order) for order in range(3))
        expected = ps.inverse_dynamics(robot.with_actuators(blank), q, v, a)
        np.testing.assert_allclose(cycle.load_torque(t), expected, atol=EXACT * np.abs(expected).max())
        gravity = ps.inverse_dynamics(robot.with_actuators(blank), q, 0 * q, 0 * q)
        np.testing.assert_allclose(cycle.gravity_torque(t), gravity, atol=EXACT * np.abs(expected).max())
        inertia = np.array([np.diag(ps.dynamics.mass_matrix(robot.with_actuators(blank), row[None])[0]) for row in q])
        np.testing.assert_allclose(cycle.inertia(t), inertia, rtol=EXACT)


def test_dwells_hold_with_the_payload_before_and_a_brake_relieves_the_motors() -> None:
    loaded, robot = paper_motion(loaded=True), ps.load_robot()
    cycle = ps.Cycle(
        steps=[
            loaded,
            ps.Dwell(duration=1.0),
            ps.Dwell(duration=1.0, payload=ps.Payload(mass=0.0)),
            ps.Dwell(duration=1.0, holding_brake=True),
        ]
    )
    zero = np.zeros(6)
    with_load = ps.inverse_dynamics(robot.with_payload(LOAD), POINTS[-1], zero, zero)
    without = ps.inverse_dynamics(robot, POINTS[-1], zero, zero)
    assert abs(with_load[1] - without[1]) > 1.0
    np.testing.assert_allclose(cycle.torque([9.5, 10.5, 11.5]), [with_load, without, zero], atol=1e-12)
    # The gears carry the load also under the brake, which holds at the motor.
    np.testing.assert_allclose(cycle.load_torque(11.5), with_load, atol=1e-12)
    assert cycle.braked[-1]
    assert not cycle.braked[:-1].any()


def test_a_first_dwell_rests_where_the_next_motion_begins() -> None:
    cycle = ps.Cycle(steps=[ps.Dwell(duration=2.0), paper_motion(loaded=True)])
    np.testing.assert_allclose(cycle.trajectory(1.0), POINTS[0], atol=1e-12)
    assert cycle.robot.payload is LOAD


def test_motions_may_join_at_speed() -> None:
    robot = ps.load_robot()
    whole = ps.septic(POINTS, TIMES)
    halves = []
    for k, (a, b) in enumerate([(0.0, 4.5), (4.5, 9.0)]):
        times = np.array([a, b])
        position = whole.position.split([4.5])
        part = Piecewise(breaks=times, coefficients=position.coefficients[:, k : k + 1])
        halves.append(ps.compute_motion(robot, ps.Trajectory(position=part, points=part(times), times=times)))
    cycle = ps.Cycle(steps=halves)
    motion = paper_motion()
    np.testing.assert_allclose(cycle.rms_torque, ps.assess(motion).rms_torque, rtol=EXACT)
    assert np.isnan(cycle.unbounded).all()


# ---- what does not fit


def test_steps_that_do_not_join_are_refused_with_both_ends(puma: ps.Robot) -> None:
    there, elsewhere = rest_to_rest(puma, 0.0, 0.5), rest_to_rest(puma, 0.4, 0.0)
    message = (
        r"steps\[0\] \(quintic.*, 1 s\) and steps\[1\] \(quintic.*, 1 s\) do not join:"
        r" joint 'joint1' ends at position 0.5 rad, then starts at 0.4 rad; joint 'joint2'"
    )
    with pytest.raises(ps.InputError, match=message):
        ps.Cycle(steps=[there, elsewhere])


def test_a_dwell_needs_rest_before_it(tmp_path: Path) -> None:
    robot = pendulum(tmp_path)
    with pytest.raises(ps.InputError, match=r"joint 'swing' ends at velocity 0.25 rad/s, then starts at 0 rad/s"):
        ps.Cycle(steps=[steady(robot, 0.0, 0.25, 1.0), ps.Dwell(duration=1.0)])


def test_steps_must_be_steps_of_one_arm(puma: ps.Robot, tmp_path: Path) -> None:
    motion = paper_motion()
    with pytest.raises(ps.InputError, match="a cycle needs at least one motion"):
        ps.Cycle(steps=[ps.Dwell(duration=1.0)])
    with pytest.raises(ps.InputError, match=r"steps\[1\]: expected a Motion or a Dwell, got float"):
        ps.Cycle(steps=[motion, 1.0])
    with pytest.raises(ps.InputError, match=r"steps\[1\] moves joints swing, but steps\[0\] moves joint1"):
        ps.Cycle(steps=[motion, rest_to_rest(pendulum(tmp_path), 0.0, 1.0)])
    other = ps.load_robot(parameters="akb").with_actuators((ps.robot.Actuator(gear_ratio=1.0),) * 6)
    with pytest.raises(ps.InputError, match=r"steps\[1\] has other drives"):
        ps.Cycle(steps=[rest_to_rest(puma, 0.0, 1.0), rest_to_rest(other, 1.0, 0.0)])


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"duration": 0.0}, "dwell duration = 0 s must be greater than 0 s"),
        ({"duration": 1.0, "holding_brake": "yes"}, "holding_brake = 'yes': expected True or False"),
    ],
)
def test_a_dwell_that_cannot_be_is_refused(values: dict, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.Dwell(**values)


# ---- periodicity


def test_the_paper_s_move_alone_does_not_return_and_says_where_it_ends() -> None:
    cycle = ps.Cycle(steps=[paper_motion()])
    assert not cycle.is_periodic
    expected = "the cycle does not return to its start: joint 'joint1' ends at position -0.5716 rad, then starts at"
    assert cycle.why_not_periodic.startswith(expected)
    assert "'joint2'" not in cycle.why_not_periodic  # it is back at -0.7873
    np.testing.assert_allclose(cycle.rms_torque, ps.assess(paper_motion()).rms_torque, rtol=EXACT)


def test_a_whole_turn_of_a_joint_without_end_is_no_distance(tmp_path: Path) -> None:
    turn = rest_to_rest(pendulum(tmp_path, kind="continuous"), 0.3, 0.3 + 2 * np.pi)
    assert ps.Cycle(steps=[turn]).is_periodic
    turn = rest_to_rest(pendulum(tmp_path), 0.3, 0.3 + 2 * np.pi)
    assert not ps.Cycle(steps=[turn]).is_periodic


def test_a_velocity_that_steps_strikes_unless_the_cycle_goes_on_at_speed(tmp_path: Path) -> None:
    endless = steady(pendulum(tmp_path, kind="continuous"), 0.0, 2 * np.pi, 1.0)
    assert np.isnan(ps.Cycle(steps=[endless]).unbounded).all()
    struck = ps.Cycle(steps=[steady(pendulum(tmp_path), 0.0, 1.0, 1.0)])
    assert struck.unbounded.tolist() == [0.0]
    assert struck.rms_torque.tolist() == [np.inf]
    back = ps.Cycle(steps=[ps.compute_motion(pendulum(tmp_path), _zigzag())])
    assert back.unbounded.tolist() == [1.0]


def _zigzag() -> ps.Trajectory:
    """From rest along t^2 to 1 rad, there the velocity steps, and back to rest."""
    times = np.array([0.0, 1.0, 2.0])
    position = Piecewise.from_power(times, [[[0.0], [1.0]], [[0.0], [-2.0]], [[1.0], [1.0]]])
    return ps.Trajectory(position=position, points=position(times), times=times)


# ---- metrics


def test_mean_speed_is_travel_over_time(puma: ps.Robot) -> None:
    """Rest to rest the travel is the distance, whatever the profile."""
    cycle = ps.cycle.with_return(rest_to_rest(puma, 0.2, 1.0, 2.0), dwell=1.0)
    np.testing.assert_allclose(cycle.mean_speed, np.full(6, 2 * 0.8 / 6.0), rtol=1e-12)


@pytest.mark.slow
def test_metrics_of_the_paper_s_cycle_are_those_of_a_million_samples() -> None:
    """Midpoint sums, held to their own error: the change from half as many samples."""
    cycle = ps.cycle.with_return(paper_motion(loaded=True), dwell=0.5, robot_back=ps.load_robot())

    def sums(count: int) -> np.ndarray:
        t = (np.arange(count) + 0.5) * (cycle.duration / count)
        rms = np.sqrt((cycle.torque(t) ** 2).mean(axis=0))
        return np.concatenate([rms, np.abs(cycle.trajectory(t, 1)).mean(axis=0)])

    fine, coarse = sums(1_000_000), sums(500_000)
    # A sum misplaces each step of the torque by up to half a sample: ten steps cost 5e-6 at most, if all add up.
    error = 2 * np.abs(fine - coarse) + 5e-6 * np.abs(fine)
    assert (np.abs(np.concatenate([cycle.rms_torque, cycle.mean_speed]) - fine) <= error).all()


@settings(max_examples=15)
@given(dwell=st.floats(0.1, 10.0), travel=st.floats(0.05, 2.0), duration=st.floats(0.5, 5.0))
def test_a_dwell_adds_its_holding_torque_and_nothing_else(dwell: float, travel: float, duration: float) -> None:
    """Two ways: `assess` with a dwell, and a cycle with one."""
    motion = rest_to_rest(ps.load_robot(), 0.1, 0.1 + travel, duration)
    cycle = ps.Cycle(steps=[motion, ps.Dwell(duration=dwell)])
    expected = ps.assess(motion, dwell=dwell).rms_torque
    np.testing.assert_allclose(cycle.rms_torque, expected, rtol=EXACT, atol=EXACT)


def test_prismatic_joints_speak_of_metres(tmp_path: Path) -> None:
    body = '  <link name="base"/>\n' + link("sled", 2.0, [0, 0, 0], 0.01 * np.eye(3))
    robot = load(tmp_path, "slide", body + joint_text("slide", "prismatic", "base", "sled", [0, 0, 0], [1, 0, 0]))
    with pytest.raises(ps.InputError, match="joint 'slide' ends at position 1 m, then starts at 2 m"):
        ps.Cycle(steps=[rest_to_rest(robot, 0.0, 1.0), rest_to_rest(robot, 2.0, 3.0)])


# ---- one idea of rest


def test_a_dwell_is_the_same_rest_in_an_assessment_and_in_a_cycle() -> None:
    """Once each had its own root mean square: two ways to the same numbers, to rounding."""
    motion = paper_motion(loaded=True)
    assessment = ps.assess(motion, dwell=2.5)
    cycle = ps.Cycle(steps=[motion, ps.Dwell(duration=2.5)])
    np.testing.assert_allclose(cycle.rms_torque, assessment.rms_torque, rtol=1e-14)
    reach = cycle.torque.extrema()
    np.testing.assert_allclose(reach.peak, assessment.peak_torque, rtol=1e-14)
    np.testing.assert_allclose(reach.t_peak, assessment.peak_torque_time, rtol=0, atol=1e-12)
    held = cycle.torque(cycle.duration)
    np.testing.assert_allclose(held, assessment.holding_torque, rtol=1e-14)


def test_a_rest_that_takes_more_than_the_motion_is_the_peak_of_both(tmp_path: Path) -> None:
    """Friction that helps the arm down does not help to hold it: the peak is at the end, where the rest begins."""
    drive = DRIVE.format(name="swing", ratio=1.0, rotor=0.0, viscous=0.0, positive=0.0, negative=-3.0)
    robot = pendulum(tmp_path, drives=drive)
    motion = ps.compute_motion(robot, ps.quintic_segments([[1.0], [0.9]], [0.0, 4.0]))
    assessment = ps.assess(motion, dwell=1.0)
    cycle = ps.Cycle(steps=[motion, ps.Dwell(duration=1.0)])
    weight = 2.0 * 9.81 * 0.5 * np.sin(0.9)
    assert assessment.peak_torque[0] == pytest.approx(weight, rel=1e-12)
    assert assessment.peak_torque_time[0] == pytest.approx(4.0)
    assert cycle.torque.extrema().peak[0] == pytest.approx(weight, rel=1e-12)


def test_what_a_log_does_not_resolve_is_no_motion_in_a_cycle_either() -> None:
    """The dead band of a recorded motion was once lost on its way into a cycle, and in the way back."""
    motion = paper_motion()
    noisy = replace(motion.trajectory, resolution=[1e-3, 2e-3, 0.0, 0.0, 0.0, 0.0], rest_before=False)
    cycle = ps.cycle.with_return(ps.compute_motion(motion.robot, noisy), dwell=0.5)
    assert cycle.trajectory.resolution.tolist() == [1e-3, 2e-3, 0.0, 0.0, 0.0, 0.0]
    back = cycle.steps[2].trajectory
    assert back.resolution.tolist() == noisy.resolution.tolist()
    assert (back.rest_before, back.rest_after) == (True, False)
    assert (cycle.trajectory.rest_before, cycle.trajectory.rest_after) == (False, True)
    there = ps.Cycle(steps=[ps.compute_motion(motion.robot, noisy)])
    assert (there.trajectory.rest_before, there.trajectory.rest_after) == (False, True)
