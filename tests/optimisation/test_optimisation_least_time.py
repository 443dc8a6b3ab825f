"""Least time under all limits: effort and position held or named, windows of durations, two points."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.arms import DRIVE, pendulum

import puma_septic as ps
from puma_septic import profiles
from puma_septic.optimisation import LeastTime
from puma_septic.optimisation._search import Problem, search
from puma_septic.validation import Array

HOME = np.array([0.3, -0.5, 0.2, 0.1, 0.4, -0.3])
# A first user's job: four points in joint space, 2.5 kg or 5 kg at the flange.
HEAVY = [
    [0.0, 0.6, -2.2, 0.0, 0.3, 0.0],
    [0.4, 1.2, -2.6, 0.0, 0.6, 0.0],
    [1.5, 1.2, -2.6, 0.0, 0.6, 0.0],
    [1.9, 0.6, -2.2, 0.0, 0.3, 0.0],
]
HEAVY_TIMES = [0.0, 0.9, 2.1, 3.0]


def loaded(puma: ps.Robot, mass: float) -> ps.Robot:
    return puma.with_payload(ps.Payload(mass=mass, com=(0.0, 0.0, 0.1)))


def only_effort(arm: ps.Robot, limit: float) -> ps.Robot:
    unknown = np.full(arm.n_joints, np.nan)
    position = np.full((arm.n_joints, 2), np.nan)
    limits = ps.Limits(
        position=position, velocity=unknown, acceleration=unknown, jerk=unknown, effort=np.full(arm.n_joints, limit)
    )
    return arm.with_limits(limits)


def test_effort_is_held_by_default(puma: ps.Robot) -> None:
    """'feasible: yes' was said of a least time whose own motion took 109.7 % of joint 2's torque."""
    robot = loaded(puma, 2.5)
    result = ps.least_time(ps.septic, HEAVY, HEAVY_TIMES, robot=robot, restarts=0)
    assessment = ps.assess(robot, ps.septic(HEAVY, result.trajectory.times))
    assert result.is_feasible
    assert assessment.is_feasible
    # Effort binds, so that the least time is longer than that of the velocities alone.
    assert result.verdict.used("effort").max() == pytest.approx(1.0, abs=1e-6)
    quicker = ps.least_time(ps.septic, HEAVY, HEAVY_TIMES, robot=robot, keep=["velocity"], restarts=0)
    assert quicker.duration < result.duration
    assert "limits respected: position, velocity, effort" in result.statement
    assert "jerk limit (unknown for all joints)" in result.statement
    assert max(map(len, str(result).splitlines())) <= 100


@pytest.mark.slow
def test_the_motion_begins_at_the_first_time(puma: ps.Robot) -> None:
    """Bug: of times that begin at 100 s the first was scaled with the rest, and the least time began at 56 s."""
    given = np.array(HEAVY_TIMES)
    one, late = (
        ps.least_time(ps.profiles.cubic_spline_free_knots, HEAVY, times, robot=puma, free=["free_knots"], restarts=0)
        for times in (given, given + 100.0)
    )
    assert one.start is not None
    assert late.start is not None
    np.testing.assert_allclose(late.trajectory.times, one.trajectory.times + 100.0, rtol=1e-9)
    np.testing.assert_allclose(late.trajectory.breaks, one.trajectory.breaks + 100.0, rtol=1e-9)
    np.testing.assert_allclose(late.start.times, one.start.times + 100.0, rtol=1e-9)
    assert late.verdict is not None
    assert min(check.time for check in late.verdict.checks) >= 100.0


def test_limits_that_are_not_respected_make_it_infeasible_and_are_named(puma: ps.Robot) -> None:
    result = ps.least_time(ps.septic, HEAVY, HEAVY_TIMES, robot=loaded(puma, 2.5), keep=["velocity"], restarts=0)
    assert not result.is_feasible
    worst = ps.assess(loaded(puma, 2.5), result.trajectory).violations[0]
    assert (worst.joint, worst.quantity) == ("joint2", "effort")
    assert f"not held: effort (joint2 at {100 * worst.utilisation:.1f} %" in result.statement
    assert "feasible by exact extrema: no" in result.statement
    document = result.to_dict()
    assert document["is_feasible"] is False
    assert document["limits"]["respected"] == ["velocity"]
    assert document["utilisation"]["effort"][1] == pytest.approx(worst.utilisation, rel=1e-12)


def test_weight_that_no_duration_holds_is_named_with_joint_value_and_limit(puma: ps.Robot) -> None:
    """5 kg: to set out, joint 2 needs its weight and Coulomb friction, 98.5 N m of 97 N m, in any time."""
    robot = loaded(puma, 5.0)
    message = r"effort limit of joint 'joint2': .* weight and Coulomb friction take \S+ N m at .*; the limit is 97 N m"
    with pytest.raises(ps.NoSolution, match=message) as caught:
        ps.least_time(profiles.quintic, HEAVY[:2], 1.0, robot=robot)
    rest = np.zeros(6)
    weight = ps.inverse_dynamics(robot, HEAVY[0], rest, rest)[1]
    slow = ps.inverse_dynamics(robot, HEAVY[0], np.sign(np.array(HEAVY[1]) - HEAVY[0]) * 1e-9, rest)[1]
    assert slow > weight > 0
    assert caught.value.residual >= slow / 97 - 1 - 1e-9


@pytest.fixture
def raised(tmp_path: Path) -> tuple[ps.Robot, Array]:
    """A point mass that is decelerated where its weight is largest: 2 kg at 0.5 m from 10 to 130 degrees."""
    return pendulum(tmp_path), np.deg2rad([[10.0], [130.0]])


def test_a_slower_motion_may_break_what_a_quicker_one_keeps(raised: tuple[ps.Robot, Array]) -> None:
    """The weight is 9.81 N m at 90 degrees; 9.4 N m hold only while the deceleration there takes off the rest."""
    arm, points = raised
    robot = only_effort(arm, 9.4)
    result = ps.least_time(profiles.quintic, points, 1.0, robot=robot)
    assert result.is_feasible

    def is_kept(duration: float) -> bool:
        return ps.assess(robot, profiles.quintic(points, [0.0, duration])).is_feasible

    kept = np.array([is_kept(duration) for duration in np.linspace(0.3, 6.0, 115)])
    edges = np.flatnonzero(np.diff(kept))
    assert len(edges) == 2  # infeasible, feasible, infeasible for good: no bisection from a slow motion finds it
    assert not kept[-1]
    assert is_kept(result.duration)
    assert not is_kept(result.duration * (1 - 1e-6))
    low, high = np.linspace(0.3, 6.0, 115)[[edges[0], edges[0] + 1]]
    assert low < result.duration <= high


def test_a_window_that_closes_is_no_solution(raised: tuple[ps.Robot, Array]) -> None:
    arm, points = raised
    with pytest.raises(ps.NoSolution, match=r"'swing': .* take 9.81 N m at 59.1 % of it; the limit is 9 N m"):
        ps.least_time(profiles.quintic, points, 1.0, robot=only_effort(arm, 9.0))


def test_a_dwell_must_be_held_too(tmp_path: Path) -> None:
    """Friction of 3 N m helps on the way down; at rest at 50 degrees the weight takes 9.81 sin 50 = 7.515 N m alone."""
    drive = DRIVE.format(name="swing", ratio=1.0, rotor=0.0, viscous=0.0, positive=3.0, negative=-3.0)
    robot, points = only_effort(pendulum(tmp_path, drives=drive), 7.0), np.deg2rad([[60.0], [50.0]])
    assert ps.least_time(profiles.quintic, points, 1.0, robot=robot).is_feasible
    with pytest.raises(ps.NoSolution, match=r"swing torque 7\.515 N m at .* of 7 N m"):
        ps.least_time(profiles.quintic, points, 1.0, robot=robot, dwell=1.0)


def test_two_points_have_one_duration(puma: ps.Robot) -> None:
    """Two points were refused. The rest-to-rest quintic's peak velocity is 15/8 of the mean one."""
    points = [[0, 0.6, -2.2, 0, 0.3, 0], [1.0, 1.2, -2.6, 0.2, 0.6, 0.1]]
    result = ps.least_time(profiles.quintic, points, 1.0, robot=puma)
    limit = puma.limits.velocity
    governed = 15 / 8 * np.max(np.abs(np.diff(points, axis=0)[0]) / limit)
    assert result.duration == pytest.approx(governed, rel=1e-11)  # its torque stays below its limits
    assert ps.assess(puma, result.trajectory).is_feasible
    assert len(result.ends) == 1
    with pytest.raises(ps.InputError, match="a motion needs two points: got 1"):
        ps.least_time(profiles.quintic, points[:1], 1.0, robot=puma)


@pytest.mark.slow
def test_positions_are_held_by_the_proportions() -> None:
    """Without a bound the septic swings beyond its points, in proportions that position limits then rule out."""
    resolved = ps.resolve_task(ps.load_task("paper-turned"))
    swinging = ps.least_time(ps.septic, resolved.points, 9.0, robot=resolved.robot, keep=["velocity"], restarts=0)
    position = np.stack([swinging.trajectory.extrema(0).min + 0.05, swinging.trajectory.extrema(0).max - 0.05], axis=1)
    inside = (position[:, 0] < resolved.points.min(axis=0)) & (position[:, 1] > resolved.points.max(axis=0))
    robot = resolved.robot.with_limits(position=np.where(inside[:, None], position, np.nan))
    assert inside.any()
    held = ps.least_time(ps.septic, resolved.points, 9.0, robot=robot, restarts=0)
    assert held.is_feasible
    assert ps.assess(robot, held.trajectory).is_feasible
    assert held.duration > swinging.duration
    bound = ps.least_time(
        ps.septic, resolved.points, 9.0, robot=robot, keep=["velocity"], max_overshoot=0.5, restarts=0
    )
    assert bound.trajectory.overshoot.max() <= 0.5 + 1e-9


@pytest.mark.slow
def test_points_beyond_a_position_limit_are_named() -> None:
    resolved = ps.resolve_task(ps.load_task("paper"))
    with pytest.raises(ps.NoSolution, match=r"joint5 position -1.9\d+ rad at t = .* beyond its bound -1.745 rad"):
        ps.least_time(ps.septic, resolved.points, 9.0, robot=resolved.robot, restarts=0)


def test_nothing_that_bounds_the_duration_is_refused(puma: ps.Robot) -> None:
    still = [HOME, HOME]
    with pytest.raises(ps.InputError, match="no joint with a limit moves: any time is long enough"):
        ps.least_time(profiles.quintic, still, 1.0, robot=puma, keep=["effort"])
    with pytest.raises(ps.InputError, match="without a limit there is no least time"):
        ps.least_time(profiles.quintic, still, 1.0, robot=only_effort(puma, np.nan))
    with pytest.raises(ps.InputError, match="profile linear takes unbounded torque, whatever the times"):
        ps.least_time(profiles.linear, [HOME, HOME + 0.5], 1.0, robot=puma, keep=["effort"])


def tight(puma: ps.Robot, seed: int) -> tuple[ps.Robot, LeastTime]:
    """A random move whose velocity limits are out of reach: torque binds, and at times positions."""
    rng = np.random.default_rng(seed)
    make = (ps.septic, profiles.quintic_spline, profiles.septic_spline, profiles.quintic)[rng.integers(4)]
    points = HOME + rng.uniform(-0.6, 0.6, (4, 6))
    slow = ps.assess(puma, make(points, np.linspace(0.0, 30.0, 4)))
    room = np.stack([points.min(axis=0) - 0.5, points.max(axis=0) + 0.5], axis=1)
    robot = puma.with_limits(effort=rng.uniform(1.1, 1.6) * slow.peak_torque, velocity=20.0, position=room)
    return robot, ps.least_time(make, points, 1.0, robot=robot, restarts=0)


def is_least_and_kept(puma: ps.Robot, seed: int) -> None:
    """The motion keeps all limits by an assessment from outside, and effort no longer in 0.1 % less."""
    robot, result = tight(puma, seed)
    assert ps.assess(robot, result.trajectory).is_feasible
    assert result.is_feasible
    assert result.start is None or result.duration <= result.start.duration * (1 + 1e-9)
    position = result.trajectory.position
    shorter = ps.Trajectory(
        position=type(position)(breaks=position.breaks * 0.999, coefficients=position.coefficients),
        points=result.trajectory.points,
        times=result.trajectory.times * 0.999,
        profile="stretched",
    )
    assert not ps.assess(robot, shorter).is_feasible


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_random_least_times_pass_assess_and_are_least(puma: ps.Robot, seed: int) -> None:
    is_least_and_kept(puma, seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3, 40))
def test_more_random_least_times_pass_assess_and_are_least(puma: ps.Robot, seed: int) -> None:
    is_least_and_kept(puma, seed)


def test_what_is_refused_is_never_the_best() -> None:
    """Where nothing kept the constraints, a refused trajectory counted as keeping them, and its error was told."""

    def evaluate(x: Array) -> tuple[Array, Array]:
        if x[0] > 0.5:
            raise ps.InputError("too far")
        return 1.0 - x, np.ones(1)

    found = search(Problem(evaluate=evaluate, lower=-np.ones(1), upper=np.ones(1)), np.zeros(1))
    assert found.x[0] <= 0.5
    assert found.excess == 1.0


def test_a_search_ends_with_the_best_that_it_has_seen() -> None:
    """With free velocities of six joints and effort to keep, a search went on for minutes."""

    def evaluate(x: Array) -> tuple[Array, Array]:
        return np.array([100 * (x[1] - x[0] ** 2) ** 2 + (1 - x[0]) ** 2]), np.zeros(0)

    start, reach = np.array([-1.2, 1.0]), np.array([5.0, 5.0])
    problem = Problem(evaluate=evaluate, lower=-reach, upper=reach)  # Rosenbrock's valley, least at (1, 1)
    whole, some = search(problem, start), search(replace(problem, most=60), start)
    assert not whole.is_cut
    assert whole.value < 1e-7
    assert some.is_cut
    assert some.n_evaluations == 60 < whole.n_evaluations
    assert whole.value < some.value < evaluate(start)[0][0]
    assert some.value == evaluate(some.x)[0][0]


@pytest.mark.slow
def test_least_time_with_free_velocities_ends_and_says_what_is_not_proved(puma: ps.Robot) -> None:
    robot = loaded(puma, 2.5)
    result = ps.least_time(profiles.cubic, HEAVY, [0, 0.9, 2.1, 3.0], robot=robot, free=["velocities"], restarts=0)
    assert result.n_cut > 0
    assert "the best verified motion of" in result.statement
    assert "ended by the number of evaluations, not yet converged; no proof that none is quicker" in result.statement
    assert result.is_feasible
    assert ps.assess(robot, result.trajectory).is_feasible
    assert result.start is not None
    assert result.duration < result.start.duration
