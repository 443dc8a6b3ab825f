"""The lowest point of an arm along its motion, and the floor, between the points too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.arms import EXAMPLES
from helpers.six_axis_arms import arm
from helpers.urdf_texts import load

import puma_septic as ps
from puma_septic.document import numeric
from puma_septic.task import assess_task, make_task, resolve_task
from puma_septic.viewer._animation import flags_of


def dipping(**options: float) -> ps.Assessment:
    """A UR5 whose shoulder swings to and fro through a cubic spline: the lowest point lies between the points."""
    points = [
        [0.0, -0.4, 0.3, 0, 0, 0],
        [0.6, -0.05, 0.3, 0, 0, 0],
        [1.1, -0.05, 0.3, 0, 0, 0],
        [2, -0.4, 0.3, 0, 0, 0],
    ]
    robot = ps.load_robot(EXAMPLES["ur5"])
    return ps.assess(robot, ps.profiles.cubic_spline(points, [0, 1, 2, 3]), **options)


def test_the_lowest_point_is_that_of_many_samples_and_lies_between_the_points() -> None:
    """Two ways: the extrema of the heights' series, and forward kinematics of every part on a grid of 15 us."""
    result = dipping()
    t = np.linspace(0, 3, 200_001)
    sampled = ps.lowest_points(result.motion.robot, result.motion.trajectory(t))
    k = int(np.argmin(sampled.height))
    # A grid misses a minimum by half its step's square times the curvature, some 1e-10 m here.
    assert result.lowest.height == pytest.approx(sampled.height[k], abs=1e-9)
    assert result.lowest.height <= sampled.height[k] + 1e-12
    assert result.lowest.time == pytest.approx(t[k], abs=2e-5)
    assert result.lowest.part == sampled.parts[k]
    at_points = ps.lowest_points(result.motion.robot, result.motion.trajectory([0.0, 1.0, 2.0, 3.0])).height.min()
    assert result.lowest.height < at_points - 1e-3


@pytest.mark.parametrize("seed", range(4))
def test_random_motions_of_another_arm(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = arm(tmp_path, "ur10e")
    move = ps.quintic_segments(rng.uniform(-np.pi, np.pi, (4, 6)), [0, 1, 2, 3])
    lowest = ps.assess(robot, move).lowest
    sampled = ps.lowest_points(robot, move(np.linspace(0, 3, 50_001)))
    assert lowest.height == pytest.approx(sampled.height.min(), abs=1e-7)
    assert lowest.height <= sampled.height.min() + 1e-11


def test_a_floor_that_only_the_way_between_the_points_breaks_is_a_violation() -> None:
    """It was checked at the points alone: a motion that dips below it in between was feasible."""
    free = dipping()
    at_points = ps.lowest_points(free.motion.robot, free.motion.trajectory([0.0, 1.0, 2.0, 3.0])).height.min()
    floor = 0.5 * (free.lowest.height + float(at_points))
    held = dipping(floor=floor)
    assert free.is_feasible
    assert not held.is_feasible
    assert held.violations == held.keeps()[-1:]
    check = held.violations[0]
    assert (check.joint, check.quantity, check.limit) == (free.lowest.part, "height", floor)
    assert check.margin == pytest.approx(free.lowest.height - floor)
    assert "below the floor at" in held.verdict
    assert "below the floor at" in str(held)
    assert held.to_dict()["lowest"]["floor"] == floor
    (flag,) = [flag for flag in flags_of(held) if flag.kind == "limit"]
    (span,) = flag.spans
    assert 1.0 < span[0] < free.lowest.time < span[1] < 2.0
    edges = ps.lowest_points(free.motion.robot, free.motion.trajectory(list(span))).height
    np.testing.assert_allclose(edges, floor, rtol=0, atol=1e-9)
    assert dipping(floor=free.lowest.height - 1e-6).is_feasible


def test_an_arm_that_hangs_below_its_base_is_remarked_and_with_a_floor_checked() -> None:
    robot = ps.load_robot(EXAMPLES["ur5"])
    move = ps.quintic_segments([[0, 0.6, 0.3, 0, 0, 0], [1, 0.6, 0.3, 0, 0, 0]], [0, 1])
    plain = ps.assess(robot, move)
    assert plain.is_feasible
    assert any("the arm hangs low: " in text and "m below the base, at" in text for text in plain.remarks)
    below = ps.assess(robot, move, floor=-1.0)
    assert below.is_feasible
    assert not any("hangs low" in text for text in below.remarks)
    assert not ps.assess(robot, move, floor=0.0).is_feasible
    with pytest.raises(ps.InputError, match="floor"):
        ps.assess(robot, move, floor=np.nan)


def test_how_low_an_arm_hangs_is_told(tmp_path: Path) -> None:
    """The shoulder is 0.5 m above the base, the tool 0.7 m from the shoulder; it hangs straight down half-way."""
    robot = load(tmp_path, tool="tip")
    move = ps.quintic_segments([[np.pi - 1, 0.0], [np.pi + 1, 0.0]], [0, 1])
    told = [remark for remark in ps.assess(robot, move).remarks if "hangs low" in remark]
    assert told == ["the arm hangs low: tip comes 0.2 m below the base, at 0.500 s; a floor would forbid it"]
    level = ps.quintic_segments([[np.pi / 2, 0.0], [1.0, 0.0]], [0, 1])
    assert not any("hangs low" in remark for remark in ps.assess(robot, level).remarks)


def test_a_tasks_floor_holds_along_its_motion() -> None:
    document = {
        "name": "dip",
        "robot": {"source": "ur5"},
        "points": [
            {"joints": row} for row in ([0, -0.4, 0.3, 0, 0, 0], [1, -0.05, 0.3, 0, 0, 0], [2, -0.4, 0.3, 0, 0, 0])
        ],
        "durations": [1, 1],
        "profiles": ["quintic_segments"],
    }
    (free,) = assess_task(resolve_task(make_task(document)))
    (held,) = assess_task(resolve_task(make_task({**document, "floor": free.lowest.height + 0.01})))
    assert numeric(held.to_dict()["violations"][0]["margin"]) == pytest.approx(-0.01)
    comparison = ps.compare(
        held.motion.robot, held.motion.trajectory.points, [0, 1, 2], profiles=["quintic_segments"], floor=held.floor
    )
    assert "below the floor" in comparison.to_dict()["profiles"][0]["violations"][0]


def test_the_tool_s_height_is_against_gravity_as_is_that_of_all_parts() -> None:
    """Bug: of an arm that hangs from the ceiling the tool's height range was that of z, with the opposite sign."""
    move = ps.quintic_segments([[0.0, 0.6, -2.2, 0.0, 0.3, 0.0], [0.4, 1.2, -2.6, 0.2, 0.6, 0.1]], [0.0, 1.0])
    standing, hanging, on_a_wall = (
        ps.assess(ps.load_robot(gravity=gravity), move).tool.height_range
        for gravity in ((0.0, 0.0, -9.81), (0.0, 0.0, 9.81), (9.81, 0.0, 0.0))
    )
    places = ps.forward_kinematics(ps.load_robot(), move(np.linspace(0.0, 1.0, 1001)))[:, :3, 3]
    assert standing == pytest.approx((places[:, 2].min(), places[:, 2].max()), abs=1e-5)
    assert hanging == pytest.approx((-standing[1], -standing[0]))
    assert on_a_wall == pytest.approx((-places[:, 0].max(), -places[:, 0].min()), abs=1e-5)
