"""Many motions at once: the numbers of single assessments."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.random import Generator

import puma_septic as ps
from puma_septic.batch import torque_spans

NAMES = [f"{kind}_{row}" for row in ("velocity", "acceleration", "jerk", "torque") for kind in ("peak", "rms")]


def septics(rng: Generator, count: int, reach: float = 1.0) -> list[ps.Trajectory]:
    return [ps.septic(points, [0.0, 3.0, 6.0, 9.0]) for points in rng.uniform(-reach, reach, (count, 4, 6))]


def assert_same(robot: ps.Robot, moves: list[ps.Trajectory]) -> int:
    """Each motion as `assess` has it, to what the torque is resolved to; how many of them went alone."""
    many = ps.assess_many(robot, moves)
    assert len(many) == len(moves)
    for k, move in enumerate(moves):
        one = ps.assess(robot, move)
        for name in NAMES:
            assert getattr(many, name)[k] == pytest.approx(getattr(one, name), rel=1e-9, nan_ok=True), name
        assert many.position_min[k] == pytest.approx(one.position.min, abs=1e-12)
        assert many.position_max[k] == pytest.approx(one.position.max, abs=1e-12)
        assert many.is_feasible[k] == one.is_feasible
        assert many.duration[k] == move.duration
        moved = max((c for c in one.checks if c.quantity != "position"), key=lambda c: c.utilisation)
        assert many.utilisation[k] == pytest.approx(moved.utilisation, rel=1e-9)
        assert robot.joint_names[many.governing_joint[k]] == moved.joint
        assert many.governing_quantity[k] == moved.quantity
    return many.n_alone


def test_random_septics(puma: ps.Robot, rng: Generator) -> None:
    assert assert_same(puma, septics(rng, 40)) <= 1


def test_a_payload_and_a_wrench_are_carried(puma: ps.Robot, rng: Generator) -> None:
    loaded = puma.with_payload(ps.Payload(mass=2.0, com=[0, 0, 0.1])).with_wrench(ps.Wrench(force=[1.0, 2.0, 3.0]))
    assert_same(loaded, septics(rng, 8))


def test_families_of_all_kinds_side_by_side(puma: ps.Robot, rng: Generator) -> None:
    """Splines, stops at each via, joints that rest, steps of acceleration (unbounded jerk) and of velocity."""
    points = rng.uniform(-0.7, 0.7, (4, 6))
    resting = points.copy()
    resting[:, 3] = 0.2
    times = [1.0, 2.5, 3.5, 5.0]
    families = ["septic_spline", "quintic_segments", "cycloidal", "cubic_spline", "trapezoidal", "linear", "septic"]
    moves = [
        ps.profiles.make(family, some, times, options={"blend_time": 0.3} if family == "trapezoidal" else None)
        for family in families
        for some in (points, resting)
    ]
    assert_same(puma, moves)


def test_what_one_fit_does_not_describe_goes_alone(puma: ps.Robot, rng: Generator) -> None:
    moves = septics(rng, 3)
    excerpt = moves[0].excerpt
    sticky = ps.Friction(viscous=1e-3, coulomb=[0.4, -0.4], static=[0.6, -0.6], stribeck_velocity=1.0)
    robot = puma.with_drivetrains([replace(train, measured_friction=sticky) for train in puma.drivetrains])
    assert ps.assess_many(puma, [excerpt, moves[1]]).n_alone == 1
    assert assert_same(robot, moves[:2]) == 2
    rated = puma.with_limits(torque_rate=np.full(6, 100.0))
    assert assert_same(rated, moves[:2]) == 2


def test_certificates_hold(puma: ps.Robot, rng: Generator) -> None:
    """Law: what is proved has the verdict of the assessment; near a limit a bound of some percent proves nothing."""
    moves = septics(rng, 60, 0.7)
    many = ps.assess_many(puma, moves)
    assert set(many.certificate) <= {"proved", "resolved"}
    assert (many.certificate == "proved").mean() > 0.5
    near = puma.with_limits(velocity=many.peak_velocity[0] * (1 + 1e-6))
    assert ps.assess_many(near, moves[:1]).certificate[0] == "resolved"
    degrees = ps.septic(np.degrees(moves[0].points), [0, 3, 6, 9.0])
    assert ps.assess_many(puma, [degrees]).certificate[0] == "undecided"
    assert not ps.assess_many(puma, [degrees]).is_feasible[0]


def test_blocks_do_not_show(puma: ps.Robot, rng: Generator) -> None:
    """More motions than one block holds, each the same as among few."""
    move = septics(rng, 1)
    many = ps.assess_many(puma, move * 1100)
    assert many.peak_torque / many.peak_torque[0] == pytest.approx(np.ones((1100, 6)), abs=1e-13)


def test_messages(puma: ps.Robot, rng: Generator) -> None:
    with pytest.raises(ps.InputError, match="trajectories: at least one is needed"):
        ps.assess_many(puma, [])
    with pytest.raises(ps.InputError, match=r"trajectories\[1\]: expected a Trajectory, got 3"):
        ps.assess_many(puma, [*septics(rng, 1), 3])  # type: ignore[list-item]
    two = ps.quintic_segments([[0.0, 0.0], [1.0, 1.0]], [0.0, 1.0])
    with pytest.raises(ps.InputError, match=r"trajectories\[0\] has the joints 2, robot 'puma560' has joint1"):
        ps.assess_many(puma, [two])


def test_torque_on_both_sides_of_zero(puma: ps.Robot, rng: Generator) -> None:
    """Two ways: the extrema of each motion's torque; what goes alone is left out."""
    moves = [*septics(rng, 20), septics(rng, 1)[0].excerpt]
    points = rng.uniform(-0.7, 0.7, (4, 6))
    moves.append(ps.profiles.make("quintic_spline", points, [1.0, 2.5, 3.5, 5.0]))
    for move, found in zip(moves, torque_spans(puma, moves), strict=True):
        if move is moves[20]:
            assert found is None
            continue
        assert found is not None
        ends, rms = found
        extrema = ps.compute_motion(puma, move).torque.extrema()
        scale = np.maximum(extrema.max, -extrema.min)
        assert np.abs(ends - [extrema.min, extrema.max]).max(axis=0) / scale == pytest.approx(np.zeros(6), abs=1e-10)
        assert rms == pytest.approx(ps.assess(puma, move).rms_torque, rel=1e-9)
    assert torque_spans(puma, []) == []
