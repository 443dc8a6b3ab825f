"""How low an arm hangs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.arms import EXAMPLES
from helpers.six_axis_arms import arm

import puma_septic as ps


def test_the_lowest_of_joints_and_tool_by_forward_kinematics(tmp_path: Path, rng: np.random.Generator) -> None:
    """Joint k's origin is its link's; the first one never moves."""
    robot = arm(tmp_path, "ur10e")
    q = rng.uniform(-np.pi, np.pi, (50, 6))
    lowest = ps.lowest_points(robot, q)
    parts = {f"j{k}": f"l{k}" for k in range(2, 7)} | {"tool": "tool"}
    heights = {part: ps.forward_kinematics(robot, q, frame=frame)[:, 2, 3] for part, frame in parts.items()}
    np.testing.assert_allclose(lowest.height, np.min(list(heights.values()), axis=0), rtol=0, atol=1e-14)
    for k, part in enumerate(lowest.parts):
        assert heights[part][k] == pytest.approx(lowest.height[k], abs=1e-14)


def test_down_is_where_gravity_pulls(rng: np.random.Generator) -> None:
    """An arm on a wall: height is along the wall's normal or whatever else points up; without gravity it is z."""
    q = rng.uniform(-np.pi, np.pi, (5, 6))
    for gravity, up in (((0, 9.81, 0), (0, -1, 0)), ((0, 0, 0), (0, 0, 1))):
        robot = ps.load_robot(EXAMPLES["ur5"], gravity=gravity)
        names = ["upper_arm_link", "forearm_link", "wrist_1_link", "wrist_2_link", "wrist_3_link", "tool0"]
        heights = [ps.forward_kinematics(robot, q, frame=name)[:, :3, 3] @ up for name in names]
        np.testing.assert_allclose(ps.lowest_points(robot, q).height, np.min(heights, axis=0), rtol=0, atol=1e-14)


def test_one_configuration_and_bad_ones(puma: ps.Robot) -> None:
    lowest = ps.lowest_points(puma, np.zeros(6))
    assert lowest.height.shape == (1,)
    with pytest.raises(ValueError, match="read-only"):
        lowest.height[0] = 0.0
    with pytest.raises(ps.InputError, match=r"joint 'joint3': q\[2\] = nan is not a finite number"):
        ps.lowest_points(puma, [0, 0, np.nan, 0, 0, 0])
