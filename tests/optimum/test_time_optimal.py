"""The time-optimal reference along the same path."""

from __future__ import annotations

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.optimum import _jerk_limited

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


def test_a_straight_line_under_jerk_limits_is_the_double_s(puma: ps.Robot) -> None:
    """Known answer: under constant limits of velocity, acceleration and jerk the quickest line is the double S."""
    limits = {"velocity": np.full(6, 0.8), "acceleration": np.full(6, 4.0), "jerk": np.full(6, 40.0)}
    robot = puma.with_limits(**limits, effort=np.full(6, 1e6))
    motion = ps.compute_motion(robot, ps.quintic_segments(MOVE, [0.0, 2.0]))
    reference = ps.time_optimal(motion)
    double_s = ps.within_limits("double_s", MOVE, max_velocity=0.8, max_acceleration=4.0, max_jerk=40.0)
    assert reference.solver == "copp-py"
    assert reference.duration == pytest.approx(double_s.duration, rel=1e-2)
    assert double_s.duration * (1 - 1e-9) <= reference.certified.duration < 1.03 * double_s.duration
    assert reference.certified.assessment.is_feasible
    assert reference.path_deviation < 1e-9


def test_the_reference_keeps_the_jerk_along_a_curved_path(puma: ps.Robot) -> None:
    """Slower than without the jerk's limit, quicker than the profile; as found it breaks the limits by little."""
    vias = [[0.3, -0.4, 0.5, 0.2, 0.1, 0.3], [0.6, -0.5, 0.2, 0.5, 0.3, 0.1]]
    move = ps.septic([[0.0] * 6, *vias, [0.2, -0.1, 0.7, 0.1, 0.6, 0.0]], [0.0, 3.0, 6.0, 9.0])
    free = puma.with_limits(acceleration=np.full(6, 8.0))
    held = free.with_limits(jerk=np.full(6, 40.0))
    without, within = (ps.time_optimal(ps.compute_motion(robot, move)) for robot in (free, held))
    assert (without.solver, within.solver) == ("toppra", "copp-py")
    assert without.certified.duration < within.certified.duration < within.given.duration
    assert within.certified.assessment.is_feasible
    assert np.abs(within.certified.assessment.peak_jerk / 40.0).max() <= 1 + 1e-9
    assert within.excess is not None
    assert within.excess.utilisation < 1.05
    assert within.path_deviation < 1e-4
    assert within.to_dict()["solver"] == "copp-py"


def test_without_copp_the_remedy_is_told(puma: ps.Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_jerk_limited, "copp_py", None)
    robot = puma.with_limits(jerk=np.full(6, 40.0))
    with pytest.raises(ps.InputError, match=r"needs copp-py: python -m pip install 'puma-septic\[optimum\]'"):
        ps.time_optimal(ps.compute_motion(robot, ps.quintic_segments(MOVE, [0.0, 2.0])))
