"""What a cell asks of any motion, a floor and limits of the tool, is held by every question that has a verdict.

It was held by `assess` alone: `optimise`, `limits`, `study` and `check` called motions feasible that `assess` refused.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

import puma_septic as ps
from puma_septic.cli import main
from puma_septic.limit_check import most_used_first
from puma_septic.paths import ToolLimits
from puma_septic.testing import assert_trajectory_ok

# The arm turns down from 0.2 to -0.5 and up to 0.3 rad about the shoulder while it turns about the base.
POINTS = np.array([[0.0, 0.2, -1.6, 0.0, 0.3, 0.0], [0.5, -0.5, -1.6, 0.0, 0.3, 0.0], [1.0, 0.3, -1.6, 0.0, 0.3, 0.0]])
TIMES = [0.0, 1.0, 2.0]


@pytest.fixture(scope="module")
def motion(puma: ps.Robot) -> ps.Motion:
    return ps.compute_motion(puma, ps.profiles.quintic_spline(POINTS, TIMES))


def _speed(motion: ps.Motion) -> float:
    return float(ps.paths.tool_rates(motion.robot, motion.trajectory).peak("speed")[0])


def test_a_limit_of_the_tool_bounds_the_duration(motion: ps.Motion) -> None:
    """Speed goes with 1/T: half the speed of the quickest motion takes twice its time, and is used to 100 %."""
    free = ps.minimum_duration(motion)
    quickest = _speed(free.assessment.motion)
    held = ps.minimum_duration(motion, tool_limits=ToolLimits(speed=quickest / 2, source="test"))
    assert held.duration == pytest.approx(2 * free.duration, rel=1e-9)
    assert (held.governing.joint, held.governing.quantity) == ("tool", "speed")
    assert held.governing.utilisation == pytest.approx(1, abs=1e-9)
    assert held.assessment.is_feasible


def test_the_tool_s_acceleration_and_jerk_scale_as_those_of_joints(motion: ps.Motion) -> None:
    rates = ps.paths.tool_rates(motion.robot, motion.trajectory)
    limits = ToolLimits(
        acceleration=rates.peak("acceleration")[0] / 9, angular_speed=rates.peak("angular speed")[0] / 2
    )
    assert rates.needed_stretch(limits) == pytest.approx(3.0, rel=1e-12)
    shares = rates.shares(limits, [1.0, 1 / 3])
    np.testing.assert_allclose(shares["acceleration"], [9.0, 1.0], rtol=1e-12)
    np.testing.assert_allclose(shares["angular speed"], [2.0, 2 / 3], rtol=1e-12)
    assert ps.minimum_duration(motion, tool_limits=limits).duration == pytest.approx(3 * 2.0, rel=1e-9)


def test_no_duration_and_no_mass_lifts_the_arm_above_a_floor(motion: ps.Motion) -> None:
    lowest = ps.assess(motion).lowest.height
    for question in (ps.minimum_duration, ps.maximum_payload):
        with pytest.raises(ps.NoSolution, match="below the floor"):
            question(motion, floor=lowest + 1e-3)
        assert question(motion, floor=lowest - 1e-3).assessment.is_feasible


def test_no_mass_slows_the_tool(motion: ps.Motion) -> None:
    with pytest.raises(ps.NoSolution, match=r"tool speed .* whatever is carried"):
        ps.maximum_payload(motion, tool_limits=ToolLimits(speed=_speed(motion) * 0.99))
    assert ps.maximum_payload(motion, tool_limits=ToolLimits(speed=_speed(motion))).mass > 0


def test_a_comparison_calls_no_profile_feasible_that_its_tool_limits_refuse(puma: ps.Robot) -> None:
    names = ["quintic", "quintic_spline"]
    free = ps.compare(puma, POINTS, TIMES, profiles=names)
    speeds = {row.name: _speed(row.assessment.motion) for row in free.profiles}
    assert all(row.assessment.is_feasible for row in free.profiles)
    limit = np.mean(list(speeds.values()))
    held = ps.compare(puma, POINTS, TIMES, profiles=names, tool_limits=ToolLimits(speed=float(limit)))
    for row in held.profiles:
        assert row.assessment.is_feasible == (speeds[row.name] <= limit)


def test_the_gate_lets_nothing_pass_that_breaks_the_cell_s_rules(motion: ps.Motion, tmp_path: Path) -> None:
    """Just below the speed of the motion, and just above its lowest point; at them it passes."""
    robot, move = motion.robot, motion.trajectory
    speed, lowest = _speed(motion), ps.assess(motion).lowest
    held = {"floor": lowest.height - 1e-9, "tool_limits": ToolLimits(speed=speed, source="cell")}
    fits = ps.check_trajectory(robot, move, allow=["limit_unknown"], **held)
    assert fits.verdict == "ok"
    assert [check.quantity for check in fits.cell_margins] == ["speed", "height"]
    assert fits.worst is not None
    assert (fits.worst.joint, fits.worst.quantity) == ("tool", "speed")
    broken = {"floor": lowest.height + 1e-3, "tool_limits": ToolLimits(speed=speed * 0.99, source="cell")}
    refused = ps.check_trajectory(robot, move, allow=["limit_unknown"], **broken)
    assert refused.verdict == "violated"
    found = {(one.code, one.joint, one.quantity) for one in refused.reasons if not one.allowed}
    assert found == {("tool_limit", "tool", "speed"), ("below_floor", lowest.part, "height")}
    assert "below the floor" in str(refused)
    named = ps.profiles.quintic_spline(POINTS, TIMES, joint_names=robot.joint_names)
    file = ps.write_joint_trajectory(tmp_path / "plan.yaml", named)
    assert_trajectory_ok(file, robot, allow=["limit_unknown"], floor=lowest.height - 1e-6)
    with pytest.raises(AssertionError, match="below_floor: "):
        assert_trajectory_ok(file, robot, allow=["limit_unknown"], floor=broken["floor"])


def test_a_stretch_slows_the_tool_and_lifts_no_arm(motion: ps.Motion) -> None:
    robot, move = motion.robot, motion.trajectory
    stretch = ps.least_stretch(robot, move, tool_limits=ToolLimits(speed=_speed(motion) / 3))
    assert stretch.factor == pytest.approx(3, rel=1e-9)
    assert stretch.governing is not None
    assert (stretch.governing.joint, stretch.governing.quantity) == ("tool", "speed")
    with pytest.raises(ps.NoSolution, match="below the floor"):
        ps.least_stretch(robot, move, floor=ps.assess(motion).lowest.height + 1e-3)
    jerk = ToolLimits(jerk=1.0)
    with pytest.raises(ps.NoSolution, match="a step remains a step"):
        ps.least_stretch(robot, ps.profiles.trapezoidal(POINTS[:2], TIMES[:2], blend_time=0.3), tool_limits=jerk)


LEANING = np.array(
    [[0.0, 0.2, -1.6, 0.0, 0.3, 0.0], [0.5, -0.45, -1.6, 0.0, 0.3, 0.0], [1.2, -0.4, -1.6, 0.0, 0.3, 0.0]]
)


@pytest.mark.parametrize(
    "rule", [{"floor": 0.2335}, {"tool_limits": ToolLimits(speed=1.07)}], ids=lambda rule: next(iter(rule))
)
def test_an_optimum_keeps_what_the_cell_asks(puma: ps.Robot, rule: dict[str, Any]) -> None:
    """By samples, too: the least peak jerk at 1.05 s comes down to 0.215 m and to 1.10 m/s."""
    common: dict[str, Any] = {"robot": puma, "objective": "peak_jerk", "restarts": 0}
    make, times = ps.profiles.quintic_spline, [0.0, 1.1, 2.0]
    free = ps.optimise_via_times(make, LEANING, times, **common)
    assert not ps.assess(puma, free.trajectory, **rule).is_feasible
    held = ps.optimise_via_times(make, LEANING, times, **common, **rule)
    assert held.verdict is not None
    assert held.verdict.is_feasible
    assert held.verdict.respected == (("floor",) if "floor" in rule else ("tool",))
    assert held.value > free.value * (1 + 1e-6)
    t = np.linspace(0.0, 2.0, 20_001)
    tool = ps.forward_kinematics(puma, held.trajectory(t))[:, :3, 3]
    if "floor" in rule:
        lowest = ps.lowest_points(puma, held.trajectory(t)).height.min()
        assert lowest == pytest.approx(rule["floor"], abs=1e-6)
    else:
        speeds = np.linalg.norm(np.diff(tool, axis=0), axis=1) / np.diff(t)
        assert speeds.max() == pytest.approx(rule["tool_limits"].speed, rel=1e-5)


def test_a_floor_above_the_points_is_no_constraint_that_times_can_keep(puma: ps.Robot) -> None:
    with pytest.raises(ps.NoSolution, match="no via times were found that keep the constraints"):
        ps.optimise_via_times(
            ps.profiles.quintic_spline, POINTS, TIMES, robot=puma, floor=2.0, restarts=0, objective="peak_jerk"
        )
    with pytest.raises(ps.InputError, match="need the robot"):
        ps.optimise_via_times(ps.profiles.quintic_spline, POINTS, TIMES, floor=0.0)


@pytest.mark.slow
def test_the_least_time_keeps_the_tool_s_speed(puma: ps.Robot) -> None:
    common: dict[str, Any] = {"robot": puma, "keep": ("velocity", "acceleration"), "restarts": 0}
    make = ps.profiles.quintic_spline
    free = ps.least_time(make, POINTS, 1.0, **common)
    limit = 0.5 * float(ps.paths.tool_rates(puma, free.trajectory).peak("speed")[0])
    held = ps.least_time(make, POINTS, 1.0, tool_limits=ToolLimits(speed=limit), **common)
    speed = float(ps.paths.tool_rates(puma, held.trajectory).peak("speed")[0])
    assert speed <= limit * (1 + 1e-9)
    assert speed == pytest.approx(limit, rel=1e-6)
    assert 1.5 * free.duration < held.duration <= 2 * free.duration * (1 + 1e-9)
    assert held.verdict is not None
    assert held.verdict.is_feasible
    alone = ps.least_time(make, POINTS, 1.0, robot=puma, keep=(), restarts=0, tool_limits=ToolLimits(speed=limit))
    assert alone.duration == pytest.approx(held.duration, rel=1e-6)  # the tool alone governs


TASK = """
name: cell
robot: {source: puma560}
points:
  - {joints: [0.0, 0.2, -1.6, 0.0, 0.3, 0.0]}
  - {joints: [0.5, -0.5, -1.6, 0.0, 0.3, 0.0]}
  - {joints: [1.0, 0.3, -1.6, 0.0, 0.3, 0.0]}
times: [0, 1, 2]
profiles: [quintic_spline]
"""
BROKEN = {"floor: 0.3": "floor", "tool_limits: {speed: 0.3, source: the cell}": "tool"}


@pytest.mark.parametrize("rule", BROKEN)
@pytest.mark.parametrize(
    "command",
    [
        ["assess"],
        ["compare", "--profile", "quintic_spline"],
        pytest.param(["optimise", "--objective", "peak_jerk", "--restarts", "0"], marks=pytest.mark.slow),
        ["limits"],
    ],
    ids=lambda command: command[0],
)
def test_every_command_holds_a_task_to_its_cell(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: list[str], rule: str
) -> None:
    """Exit code 0 without the rule, another with it; `limits` slows down for the tool, and no speed mends a floor."""
    file = tmp_path / "task.yaml"
    file.write_text(TASK)
    verb, *options = command
    assert main([verb, str(file), *options]) == 0
    capsys.readouterr()
    file.write_text(TASK + rule)
    code = main([verb, str(file), *options])
    told = capsys.readouterr()
    if verb == "limits" and BROKEN[rule] == "tool":
        assert code == 0
    elif verb != "compare":  # which shows what it compares
        assert code in (1, 2)
    assert BROKEN[rule] in told.out + told.err


@pytest.mark.parametrize("rule", BROKEN)
def test_a_study_holds_its_cases_to_the_cell(tmp_path: Path, rule: str) -> None:
    file = tmp_path / "task.yaml"
    file.write_text(TASK + rule)
    axes = {"duration": {"from": 1.0, "to": 16.0, "count": 5}, "payload": [0.0, 1.0]}
    ps.run_study(ps.make_study({"task": str(file), "axes": axes}), tmp_path / "s", workers=1)
    chunks = sorted((tmp_path / "s" / "chunks").glob("*.parquet"))
    rows = [row for chunk in chunks for row in pq.read_table(chunk).to_pylist()]
    task = ps.load_task(file)
    resolved = ps.resolve_task(task)
    kept = set()
    for row in rows:
        mass = row["axis:payload"]
        robot = resolved.robot.with_payload(ps.Payload(mass=mass) if mass else None)
        move = ps.limits.stretched(resolved.trajectories[0], row["axis:duration"] / 2.0)
        one = ps.assess(robot, move, floor=task.floor, tool_limits=resolved.tool_limits)
        assert bool(row["feasible"]) == one.is_feasible
        moved = most_used_first(check for check in one.all_checks if not check.is_range)[0]
        assert (row["governing_joint"], row["governing_quantity"]) == (moved.joint, moved.quantity)
        assert row["utilisation"] == pytest.approx(moved.utilisation, rel=1e-9)
        kept.add(one.is_feasible)
    assert kept == ({False} if task.floor else {True, False})


def test_the_document_of_an_optimum_names_its_rules(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "task.yaml"
    file.write_text(TASK + "tool_limits: {speed: 3.0}\nfloor: -1.0\n")
    assert main(["optimise", str(file), "--objective", "peak_jerk", "--restarts", "0", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["limits"]["respected"] == ["tool", "floor"]


def test_limits_of_the_tool_are_not_left_out_without_a_robot() -> None:
    """`least_time` without a robot took them and did not keep them."""
    with pytest.raises(ps.InputError, match="a floor and limits of the tool need the robot"):
        ps.least_time(ps.profiles.quintic_spline, POINTS, 1.0, max_velocity=1.0, tool_limits=ToolLimits(speed=0.1))


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ({"floor": np.nan}, "floor = nan m is not a finite number"),
        ({"tool_limits": 0.25}, "tool_limits: expected ToolLimits"),
    ],
    ids=["floor", "tool"],
)
def test_rules_that_are_none_are_refused_before_the_search(puma: ps.Robot, rule: dict[str, Any], message: str) -> None:
    for search in (ps.optimise_via_times, ps.least_time):
        with pytest.raises(ps.InputError, match=message):
            search(ps.profiles.quintic_spline, POINTS, TIMES, robot=puma, restarts=0, **rule)


def test_a_gap_under_limits_of_the_tool_is_no_number(puma: ps.Robot) -> None:
    """The reference does not know them: a gap over it would say that a profile wastes what the cell forbids."""

    def reference(_: ps.Motion) -> Any:
        raise AssertionError("not to be asked")

    limits = ToolLimits(speed=2.0)
    found = ps.compare(puma, POINTS, TIMES, profiles=["quintic"], tool_limits=limits, reference=reference)
    gap = found["quintic"].gap
    assert gap is not None
    assert gap.reason == "the reference knows no limits of the tool"
    assert np.isnan(gap.ratio)
