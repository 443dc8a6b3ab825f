"""`assert_feasible`: what it lets pass, what it stops, and what its message tells."""

from __future__ import annotations

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.testing import assert_feasible

# From rest to rest in T along h (10 s^3 - 15 s^4 + 6 s^5), s = t / T: steepest at s = 1/2, with 15 h / (8 T).
_TRAVEL, _TIME = 0.8, 2.0
_PEAK_VELOCITY = 15 * _TRAVEL / (8 * _TIME)  # 0.75 rad/s


@pytest.fixture(scope="module")
def motion(puma: ps.Robot) -> ps.Motion:
    """Joint 1 turns, the others hold; the velocity limit is the only one that is known."""
    unknown = np.full(6, np.nan)
    limits = ps.Limits(
        position=np.full((6, 2), np.nan),
        velocity=[1.0, *unknown[1:]],
        acceleration=unknown,
        jerk=unknown,
        effort=unknown,
    )
    points = [np.zeros(6), [_TRAVEL, 0, 0, 0, 0, 0]]
    return ps.compute_motion(puma.with_limits(limits), ps.quintic_segments(points, [0.0, _TIME]))


def _assess(motion: ps.Motion, **limits: object) -> ps.Assessment:
    """The same motion against other limits."""
    return ps.assess(motion.robot.with_limits(**limits), motion.trajectory)


def test_a_kept_limit_passes_with_just_the_margin_that_is_left(motion: ps.Motion) -> None:
    """0.75 rad/s of 1 rad/s leave 25 %, and binary fractions of it must not decide."""
    assert pytest.approx(0.75) == _PEAK_VELOCITY
    assessment = ps.assess(motion)
    assert_feasible(assessment)
    assert_feasible(assessment, 0.25)
    with pytest.raises(AssertionError, match="1 limit is not kept with 26 % to spare"):
        assert_feasible(assessment, margin=0.26)


def test_the_message_is_a_table_of_joint_demand_limit_and_margin(motion: ps.Motion) -> None:
    assessment = _assess(motion, velocity=[0.5] + [np.nan] * 5)
    with pytest.raises(AssertionError) as failure:
        assert_feasible(assessment)
    headline, header, _, row, *rest = str(failure.value).splitlines()
    assert headline == "1 limit is not kept:"
    assert header.split() == ["joint", "quantity", "demand", "limit", "unit", "t", "[s]", "margin"]
    assert row.split() == ["joint1", "velocity", "0.7500", "0.5000", "rad/s", "1.000", "-50.0", "%"]
    assert any(line.startswith("not assessed: effort limit") for line in rest)


def test_a_position_beyond_its_bound_fails_and_one_close_to_it_does_not(motion: ps.Motion) -> None:
    """A distance in rad is no share of a limit, so the margin does not apply to it."""
    close, beyond = np.full((6, 2), np.nan), np.full((6, 2), np.nan)
    close[0], beyond[0] = (-1.0, _TRAVEL + 0.01), (-1.0, _TRAVEL - 0.3)
    assert_feasible(_assess(motion, position=close), margin=0.25)
    with pytest.raises(AssertionError, match=r"joint1 +position +0\.8000 +0\.5000 +rad +2\.000 +-0\.3"):
        assert_feasible(_assess(motion, position=beyond))


def test_an_unknown_limit_does_not_fail(motion: ps.Motion) -> None:
    assessment = _assess(motion, velocity=np.nan)
    assert assessment.checks == ()
    assert_feasible(assessment, margin=1.0)


@pytest.mark.parametrize("ignore", ["joint1", "velocity", ("joint1", "velocity")])
def test_what_is_ignored_may_fail(motion: ps.Motion, ignore: str | tuple[str, str]) -> None:
    assessment = _assess(motion, velocity=[0.5] + [np.nan] * 5)
    assert not assessment.is_feasible
    assert_feasible(assessment, ignore=[ignore])


@pytest.mark.parametrize("ignore", ["joint2", "effort", ("joint1", "effort"), ("joint2", "velocity")])
def test_ignoring_something_else_does_not_help(motion: ps.Motion, ignore: str | tuple[str, str]) -> None:
    with pytest.raises(AssertionError, match="1 limit is not kept"):
        assert_feasible(_assess(motion, velocity=[0.5] + [np.nan] * 5), ignore=[ignore])


def test_an_unbounded_acceleration_fails_without_any_limit(puma: ps.Robot, motion: ps.Motion) -> None:
    """No arm starts at 1 rad/s from one instant to the next."""
    times = np.array([0.0, 1.0])
    points = np.array([np.zeros(6), np.eye(6)[0]])
    line = ps.Piecewise.fit(lambda t: np.outer(t, np.eye(6)[0]), times)
    trajectory = ps.Trajectory(position=line, points=points, times=times)
    assessment = ps.assess(puma.with_limits(motion.robot.limits).with_limits(velocity=np.nan), trajectory)
    assert not assessment.is_feasible
    with pytest.raises(AssertionError, match=r"joint1 +acceleration +unbounded +unknown +rad/s\^2 .* none"):
        assert_feasible(assessment)
    assert_feasible(assessment, ignore=["acceleration", "effort"])


@pytest.mark.parametrize(
    ("ignore", "message"),
    [
        (["elbw"], "unknown joint or quantity in ignore 'elbw'; valid: 'joint1'.*'effort'"),
        ([("joint9", "effort")], "unknown joint in ignore 'joint9'; valid: 'joint1'"),
        ([("joint1", "torque")], "unknown quantity in ignore 'torque'; valid: 'position'"),
        ([("joint1",)], r"ignore: expected a joint, a quantity or a pair .*, got \('joint1',\)"),
        ([1], "ignore: expected a joint, a quantity or a pair .*, got 1"),
        ("effort", r"ignore: expected a list of names, got the text 'effort'; write \['effort'\]"),
    ],
)
def test_a_misspelt_ignore_is_refused(motion: ps.Motion, ignore, message: str) -> None:
    """Otherwise the author believes that something is ignored which is not."""
    with pytest.raises(ps.InputError, match=message):
        assert_feasible(ps.assess(motion), ignore=ignore)


@pytest.mark.parametrize(
    ("margin", "message"),
    [
        (-0.1, "margin = -0.1 must be at least 0"),
        (20, "margin = 20 must be at most 1"),
        (np.nan, "not a finite"),
    ],
)
def test_a_margin_is_a_share(motion: ps.Motion, margin: float, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        assert_feasible(ps.assess(motion), margin)


def test_what_the_cell_asks_is_no_quantity_of_the_joints(motion: ps.Motion) -> None:
    """`ignore=["jerk"]` let the tool's jerk go, and a joint's name the floor where that joint was the lowest part."""
    tool = ps.paths.ToolLimits(jerk=0.1)
    judged = ps.assess(motion, tool_limits=tool, floor=2.0)
    lowest = judged.lowest.part
    with pytest.raises(AssertionError, match=r"2 limits are not kept"):
        assert_feasible(judged, ignore=["jerk", "acceleration", lowest])
    with pytest.raises(AssertionError, match=r"1 limit is not kept"):
        assert_feasible(judged, ignore=["height"])
    assert_feasible(judged, ignore=["tool", "height"])
    assert_feasible(judged, ignore=[("tool", "jerk"), "height"])
    with pytest.raises(ps.InputError, match="quantity in ignore"):
        assert_feasible(judged, ignore=[("tool", "effort")])


def test_a_cycle_is_judged_as_a_whole(motion: ps.Motion) -> None:
    """A cycle ended in an AttributeError."""
    cycle = ps.assess_cycle(ps.cycle.with_return(motion, dwell=0.5))
    assert_feasible(cycle, margin=0.25)
    with pytest.raises(AssertionError, match="1 limit is not kept with 30 % to spare"):
        assert_feasible(cycle, margin=0.3)
    with pytest.raises(ps.InputError, match="assessment"):
        assert_feasible(motion)  # type: ignore[arg-type]
