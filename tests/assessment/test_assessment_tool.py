"""The tool's speed and height, and how near an arm comes to its singular postures."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from helpers.arms import branched_arm, joint, link, load, panda, ur5
from helpers.moves import PROFILES, paper_move, parabolic_blends, random_move
from helpers.sampled import between, refined_extrema, refined_peak

import puma_septic as ps
from puma_septic.assessment import ToolMetrics
from puma_septic.kinematics._singularity import singularity_distances, singularity_names

# The squares of speed and acceleration are fitted to 1e-11 of their largest value.
EXACT = 1e-9


@cache
def wrist() -> ps.Robot:
    return ps.load_robot(tool="wrist_center")


def metrics(robot: ps.Robot, trajectory: ps.Trajectory) -> ToolMetrics:
    return ps.assess(robot, trajectory).tool


def assert_as_sampled(robot: ps.Robot, trajectory: ps.Trajectory) -> None:
    tool = metrics(robot, trajectory)

    def sizes(t: np.ndarray) -> np.ndarray:
        moved = ps.tool_motion(robot, *(trajectory(t, order) for order in range(3)))
        vectors = (moved.velocity, moved.acceleration)
        return np.column_stack([*(np.linalg.norm(x, axis=1) for x in vectors), moved.position[:, 2]])

    speed, acceleration, _ = refined_peak(sizes, trajectory.breaks)
    low, high = (extreme[2] for extreme in refined_extrema(sizes, trajectory.breaks))
    np.testing.assert_allclose([tool.peak_speed, tool.peak_acceleration], [speed, acceleration], rtol=EXACT)
    np.testing.assert_allclose(tool.height_range, [low, high], rtol=0, atol=1e-10)
    times = np.array([tool.peak_speed_time, *tool.height_times])
    at = sizes(times)
    np.testing.assert_allclose([at[0, 0], at[1, 2], at[2, 2]], [speed, low, high], rtol=0, atol=1e-8)
    beside = np.clip(tool.peak_acceleration_time + np.array([-1e-10, 0, 1e-10]), *trajectory.breaks[[0, -1]])
    assert sizes(beside)[:, 1].max() == pytest.approx(acceleration, rel=1e-7)


@pytest.mark.parametrize("profile", PROFILES)
def test_speed_acceleration_and_height_are_those_of_refined_samples(profile: str) -> None:
    assert_as_sampled(ps.load_robot(), paper_move(profile))


@pytest.mark.parametrize("seed", range(3))
def test_random_arms_and_moves_are_as_sampled(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    arm = branched_arm(tmp_path, rng, 5)
    assert_as_sampled(arm, random_move(rng, 5))


def test_the_paper_s_septic_lifts_the_tool_27_cm_above_the_transfer_height() -> None:
    """z = 0.573 m from the shoulder, whose height is 0.67183 m, where 0.3 m was asked for."""
    low, high = metrics(wrist(), paper_move("septic")).height_range
    assert high == pytest.approx(0.573 + 0.67183, abs=6e-4)
    # Take and place: -0.5 m from the shoulder, to the digits of Table 1.
    assert low == pytest.approx(-0.5 + 0.67183, abs=1e-4)


def test_the_paper_s_septic_passes_the_shoulder_and_the_wrist_singularity_twice_each() -> None:
    """Known by sampling: shoulder at about 3.649 and 4.179 s, wrist at about 2.471 and 5.449 s, elbow never."""
    reports = {report.kind: report for report in metrics(wrist(), paper_move("septic")).singularities}
    assert tuple(reports) == ("shoulder", "elbow", "wrist")
    np.testing.assert_allclose(reports["shoulder"].crossings, [3.649, 4.179], atol=6e-4)
    np.testing.assert_allclose(reports["wrist"].crossings, [2.471, 5.449], atol=6e-4)
    np.testing.assert_allclose(paper_move("septic")(reports["wrist"].crossings)[:, 4], 0.0, atol=1e-12)
    assert reports["shoulder"].least_distance == 0.0
    assert reports["shoulder"].time == reports["shoulder"].crossings[0]
    assert len(reports["elbow"].crossings) == 0
    # The least distance is met where the samples have it.
    t = between(paper_move("septic").breaks, 20_001).ravel()
    sampled = np.abs(singularity_distances(wrist(), paper_move("septic")(t)))
    assert reports["elbow"].least_distance == pytest.approx(sampled[:, 1].min(), rel=1e-6)
    assert reports["elbow"].time == pytest.approx(t[sampled[:, 1].argmin()], abs=1e-3)


def test_the_three_measures_of_a_puma_are_the_factors_of_its_determinant(rng: np.random.Generator) -> None:
    """``det J = +- a2 hypot(a3, d4) front sin(elbow) sin(q5)`` at the wrist centre (Paul and Zhang's lengths)."""
    q = rng.uniform(-3, 3, (100, 6))
    determinant = np.linalg.det(ps.jacobian(wrist(), q))
    product = singularity_distances(wrist(), q).prod(axis=1)
    lengths = 0.4318 * np.hypot(0.0203, 0.4318)
    np.testing.assert_allclose(np.abs(determinant), lengths * np.abs(product), rtol=1e-9, atol=1e-12)
    assert len(set(np.sign(determinant * product))) == 1


def test_what_is_measured_depends_on_the_arm(tmp_path: Path) -> None:
    assert singularity_names(ps.load_robot()) == ("shoulder", "elbow", "wrist")
    assert singularity_names(ur5()) == ("determinant",)
    assert singularity_names(panda()) == ("manipulability",)
    assert singularity_names(branched_arm(tmp_path, np.random.default_rng(0), 4)) == ("manipulability",)


def test_a_jaw_makes_no_arm_singular(tmp_path: Path) -> None:
    """An SO-ARM101 (five joints and a jaw) was "singular" for every motion: the jaw moves the tool nowhere, so that all
    six columns have no determinant. The inverse kinematics, which leaves the jaw out, said otherwise."""
    axes = ([0, 0, 1], [0, 1, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1])
    names = [*(f"l{k}" for k in range(5)), "jaw"]
    parents = ["base", *names[:4], "l4"]
    body = '  <link name="base"/>\n' + "".join(link(name, 0.5, [0, 0, 0.1], np.eye(3) * 1e-3) for name in names)
    for k, (parent, name, axis) in enumerate(zip(parents, names, axes, strict=True)):
        body += joint(f"j{k}" if name != "jaw" else "grip", "revolute", parent, name, [0.02, 0.01, 0.1], axis)
    robot = load(tmp_path, "so_arm", body, tool="l4")
    q = np.array([0.2, 0.5, -0.9, 0.4, 0.6, 0.3])
    carrying = ps.jacobian(robot, q)[:, robot.joint_names.index("j0") :][:, :5]
    assert singularity_names(robot) == ("manipulability",)
    # Yoshikawa's manipulability is the product of the singular values (Yoshikawa 1985).
    expected = np.linalg.svd(carrying, compute_uv=False).prod() ** 2
    assert singularity_distances(robot, q[None])[0, 0] == pytest.approx(expected, rel=1e-12)
    assert expected > 1e-9
    (report,) = metrics(robot, ps.quintic_segments([q, q + 0.1], [0.0, 1.0])).singularities
    assert report.least_distance > 0
    assert len(report.crossings) == 0
    assert not ps.inverse_kinematics(robot, ps.forward_kinematics(robot, q), q_near=q).singular[0]


@pytest.mark.parametrize("joint", [2, 4])  # elbow straight, wrist aligned
def test_a_ur5_is_seen_to_cross_where_its_determinant_changes_sign(joint: int) -> None:
    start, end = np.full((2, 6), 0.7)
    start[joint], end[joint] = -0.5, 0.5
    (report,) = metrics(ur5(), ps.quintic_segments([start, end], [0.0, 2.0])).singularities
    np.testing.assert_allclose(report.crossings, [1.0], atol=1e-9)
    assert (report.kind, report.least_distance) == ("determinant", 0.0)


def test_the_manipulability_of_a_redundant_arm_is_that_of_samples() -> None:
    move = random_move(np.random.default_rng(3), 7)
    (report,) = metrics(panda(), move).singularities

    def manipulability(t: np.ndarray) -> np.ndarray:
        jacobians = ps.jacobian(panda(), move(t))
        return np.linalg.det(jacobians @ jacobians.transpose(0, 2, 1))[:, None]

    (low,), (high,) = refined_extrema(manipulability, move.breaks)
    # It is fitted to 1e-11 of its largest value.
    assert report.least_distance == pytest.approx(low, abs=1e-10 * high)
    assert low > 1e-10 * high
    assert len(report.crossings) == 0


# ---- zeros that are not plain crossings


def wrist_angle(*factors: tuple[float, int], scale: float = 0.1, offset: float = 0.0) -> ps.Trajectory:
    """Joint 5 as ``offset + scale prod (t - t_k)^n_k`` on [0, 3] s; the other joints well away from singularity."""
    power = np.polynomial.polynomial.polyfromroots([t / 3 for t, n in factors for _ in range(n)]) * scale
    power[0] += offset
    powers = np.zeros((len(power), 1, 6))
    powers[0, 0] = [0.1, -0.7, -0.6, 0.3, 0.0, 0.2]
    powers[:, 0, 4] = power
    position = ps.Piecewise.from_power([0.0, 3.0], powers)
    return ps.Trajectory(position=position, points=position([0.0, 3.0]), times=np.array([0.0, 3.0]))


def wrist_report(trajectory: ps.Trajectory):  # type: ignore[no-untyped-def]
    return metrics(wrist(), trajectory).singularities[2]


def test_a_singularity_that_is_touched_is_reported_at_each_touch() -> None:
    """sin(q5) has double zeros at 1 and 2.5 s and no sign change; only the first was reported once."""
    report = wrist_report(wrist_angle((1.0, 2), (2.5, 2)))
    np.testing.assert_allclose(report.crossings, [1.0, 2.5], atol=1e-3)  # where 1e-9 is reached
    assert report.least_distance == 0.0


def test_crossing_and_touching_are_both_found() -> None:
    report = wrist_report(wrist_angle((0.5, 1), (2.0, 2)))
    np.testing.assert_allclose(report.crossings, [0.5, 2.0], atol=1e-3)


def test_a_near_miss_is_none() -> None:
    report = wrist_report(wrist_angle((1.0, 2), offset=1e-6))
    assert len(report.crossings) == 0
    assert report.least_distance == pytest.approx(1e-6, rel=1e-6)
    assert report.time == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("noise", [0.0, 1e-17, 2e-16])
def test_an_arm_that_stays_singular_is_reported_once(noise: float) -> None:
    """sin(q5) is rounding throughout; its sign changes were once dozens of crossings, or none at all."""
    report = wrist_report(wrist_angle((0.3, 1), (1.1, 1), (2.2, 1), scale=noise))
    np.testing.assert_array_equal(report.crossings, [0.0])
    assert (report.least_distance, report.time) == (0.0, 0.0)


def test_a_ur5_that_stays_singular_is_reported_once() -> None:
    """Its determinant is then noise of 1e-18 m^3, which changes sign all the time."""
    start, end = np.array([[0.1, -1.0, 0.5, 0.3, 0.0, 0.2], [1.0, -0.5, 1.0, 0.9, 0.0, 1.2]])
    (report,) = metrics(ur5(), ps.quintic_segments([start, end], [0.0, 2.0])).singularities
    np.testing.assert_array_equal(report.crossings, [0.0])


@pytest.mark.parametrize(("swing", "crossings"), [(0.4, [1.0]), (0.0, [0.0])])
def test_a_redundant_arm_s_measure_touches_zero(swing: float, crossings: list[float]) -> None:
    """A panda is singular with joints 2 and 4 at 0; det(J J^T) is fitted to 1e-11 of its largest value, not to zero."""
    start, end = np.array([[0.3, -swing, 0.5, -swing, 0.6, 1.2, 0.2], [0.9, swing, -0.5, swing, 1.6, 0.8, 1.2]])
    (report,) = metrics(panda(), ps.quintic_segments([start, end], [0.0, 2.0])).singularities
    np.testing.assert_allclose(report.crossings, crossings, atol=1e-3)
    assert report.least_distance == 0.0


def test_waiting_in_a_singularity_is_one_visit() -> None:
    """Joint 5 comes to zero at 1 s and waits there until 2 s; at rest the last milliseconds are already within 1e-9."""
    points = np.array([[0.1, -0.7, -0.6, 0.3, q5, 0.2] for q5 in (0.5, 0.0, 0.0, 0.5)])
    report = wrist_report(ps.quintic_segments(points, [0.0, 1.0, 2.0, 3.0]))
    np.testing.assert_allclose(report.crossings, [1.0], atol=2e-3)


# ---- unbounded


def test_the_tool_s_acceleration_is_unbounded_where_a_joint_s_velocity_steps() -> None:
    move = ps.lspb(paper_move("septic").points, durations=[2.0, 4.0, 3.0], blend_time=0.0)
    tool = metrics(wrist(), move)
    assert tool.peak_acceleration == np.inf
    assert tool.peak_acceleration_time == 0.0
    assert 0 < tool.peak_speed < np.inf
    assert "acceleration unbounded" in str(ps.assess(wrist(), move))


def test_a_step_in_acceleration_is_a_peak_from_one_side() -> None:
    points = np.array([[0.0] * 6, [1.0, 0, 0, 0, 0, 0]])
    move = parabolic_blends(np.array([0.0, 3.0]), points, 1.0)
    assert_as_sampled(ps.load_robot(), move)
