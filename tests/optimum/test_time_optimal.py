"""The time-optimal reference along the same path."""

from __future__ import annotations

import numpy as np
import pytest

import puma_septic as ps

MOVE = [[0.0] * 6, [0.5, -0.4, 0.3, 0.2, 0.1, 0.4]]


def test_a_straight_line_under_velocity_and_acceleration_limits_is_the_trapezoid(puma: ps.Robot) -> None:
    """Known answer: under constant limits the quickest motion along a straight line is the trapezoid, 1/V + V/A."""
    limits = {"velocity": np.full(6, 1.0), "acceleration": np.full(6, 4.0), "effort": np.full(6, 1e6)}
    robot = puma.with_limits(**limits)
    motion = ps.compute_motion(robot, ps.quintic_segments(MOVE, [0.0, 2.0]))
    reference = ps.time_optimal(motion, points=401)
    trapezoid = ps.within_limits("trapezoidal", MOVE, max_velocity=1.0, max_acceleration=4.0)
    assert reference.duration == pytest.approx(trapezoid.duration, rel=2e-3)
    assert reference.certified.duration == pytest.approx(trapezoid.duration, rel=2e-2)
    assert reference.gap > 1.2


def test_what_toppra_leaves_out_is_told_and_mended(puma: ps.Robot) -> None:
    """Viscous friction is no part of its torque: at its limits the exact torque is beyond them, certified it is not."""
    robot = puma.with_limits(velocity=np.full(6, 50.0))
    vias = [[0.3, -0.4, 0.5, 0.2, 0.1, 0.3], [0.6, -0.5, 0.2, 0.5, 0.3, 0.1]]
    move = ps.septic([[0.0] * 6, *vias, [0.2, -0.1, 0.7, 0.1, 0.6, 0.0]], [0.0, 3.0, 6.0, 9.0])
    reference = ps.time_optimal(ps.compute_motion(robot, move))
    assert reference.excess is not None
    assert reference.excess.quantity == "effort"
    assert reference.excess.utilisation > 1.01
    assert reference.certified.assessment.is_feasible
    assert reference.duration < reference.certified.duration < reference.given.duration
    assert reference.path_deviation < 1e-3
    assert reference.trajectory(reference.trajectory.breaks[[0, -1]]) == pytest.approx(move.points[[0, -1]], abs=1e-6)
    assert "certified" in str(reference)
    assert reference.to_dict()["gap"] == reference.gap


def test_messages(puma: ps.Robot) -> None:
    motion = ps.compute_motion(puma.with_limits(velocity=np.full(6, np.nan)), ps.quintic_segments(MOVE, [0.0, 2.0]))
    with pytest.raises(ps.InputError, match="the reference needs every joint's velocity limit"):
        ps.time_optimal(motion)
    with pytest.raises(ps.InputError, match="points = 3"):
        ps.time_optimal(motion, points=3)
