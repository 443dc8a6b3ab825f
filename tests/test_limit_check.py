"""One tolerance in every verdict: what is at its limit is kept, in assessments, test suites and sizing alike."""

from __future__ import annotations

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.assessment import limit_checks
from puma_septic.limit_check import AT_LIMIT, LimitCheck
from puma_septic.testing import assert_feasible

HOME = [0.3, -0.5, 0.2, 0.1, 0.4, -0.3]


def sized(demand: float) -> bool:
    check = LimitCheck.of_magnitude(
        joint="joint1",
        quantity="motor torque",
        demand=demand,
        limit=1.0,
        unit="N m",
        time=0.0,
        kind="physics",
        source="test",
    )
    return not check.is_violated


@pytest.mark.parametrize(("share", "is_kept"), [(0.5, True), (1.5, False)])
def test_every_verdict_has_the_same_tolerance(puma: ps.Robot, share: float, is_kept: bool) -> None:
    """Assessment and sizing were strict to 1e-12, profiles reach their limits to 2e-10, optimisers stopped at 1e-6."""
    move = ps.quintic_segments([HOME, [q + 0.5 for q in HOME]], [0.0, 2.0])
    beyond = 1 + share * AT_LIMIT
    highest = ps.assess(puma, move).position.max
    bounds = np.stack([np.full(6, -np.pi), highest - share * AT_LIMIT], axis=1)
    for robot in (
        # 15/8 d/T and 10/sqrt(3) d/T^2: peaks of the rest-to-rest quintic.
        puma.with_limits(velocity=15 / 8 * 0.5 / 2 / beyond),
        puma.with_limits(acceleration=10 / np.sqrt(3) * 0.5 / 4 / beyond),
        puma.with_limits(position=bounds),
    ):
        assessment = ps.assess(robot, move)
        assert assessment.is_feasible == is_kept
        if is_kept:
            assert_feasible(assessment)
        else:
            with pytest.raises(AssertionError, match="6 limits are not kept"):
                assert_feasible(assessment)
    assert sized(beyond) == is_kept


def test_double_s_at_the_limits_of_the_robot_keeps_them(puma: ps.Robot) -> None:
    """Its rounding, up to 2e-10 of a limit, made 57 of 200 such motions 'infeasible': 'jerk 193 is 100 % of 193'."""
    reach, rng = puma.limits.position, np.random.default_rng(0)
    for _ in range(20):
        limits = {
            "velocity": rng.uniform(0.5, 3.0, 6).round(2),
            "acceleration": rng.uniform(1.0, 20.0, 6).round(1),
            "jerk": rng.uniform(10.0, 300.0, 6).round(),
        }
        points = rng.uniform(reach[:, 0], reach[:, 1], (20, 6)).round(2)
        move = ps.profiles.double_s(points, **{f"max_{name}": limit for name, limit in limits.items()})
        demands = {name: move.peak(order) for order, name in enumerate(limits, start=1)}
        checks = limit_checks(puma.with_limits(**limits), move.extrema(0), demands)
        assert [str(check) for check in checks if check.is_violated and check.quantity != "position"] == []
