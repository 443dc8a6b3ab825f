"""Joint trajectories that hold the tool on a path."""

from __future__ import annotations

from pathlib import Path as File

import numpy as np
import pytest
from helpers import arms
from helpers.many_digits import derivatives
from helpers.urdf_texts import PLANAR

import puma_septic as ps
from puma_septic import paths
from puma_septic.errors import InputError, NoSolution
from puma_septic.validation import Array

# Middle of a line of 0.2 m on which the wrist centre passes 1 mm in front of the shoulder's singularity.
NEAR_SHOULDER = (
    [-0.0838, -0.4164, 2.4587, -0.659, -0.2611, 0.067],
    [-0.8073, -0.3894, 2.4053, -0.3439, 0.7917, 0.6306],
)


@pytest.fixture(scope="module")
def planar(tmp_path_factory: pytest.TempPathFactory) -> ps.Robot:
    file: File = tmp_path_factory.mktemp("planar") / "planar.urdf"
    file.write_text(PLANAR)
    return ps.load_robot(file, tool="tip")


def two_link(x: Array, y: Array) -> Array:
    """Joint positions of a planar arm with links of 1 m, elbow positive (Siciliano et al., Robotics, 2.12.1)."""
    elbow = np.arccos((x**2 + y**2 - 2) / 2)
    return np.stack([np.arctan2(y, x) - elbow / 2, elbow], axis=-1)


def random_path(rng: np.random.Generator, robot: ps.Robot, k: int) -> tuple[Array, paths.Path]:
    low, high = np.nan_to_num(robot.limits.position, nan=0.0).T
    q = low + (high - low) * rng.uniform(0.2, 0.8, robot.n_joints)
    start, turn = ps.forward_kinematics(robot, q), np.linalg.qr(rng.normal(size=(3, 3)))[0]
    away = turn[0] * rng.uniform(0.05, 0.3)
    end = start.copy()
    end[:3, 3] += away
    c, s = np.cos(0.5), np.sin(0.5)
    end[:3, :3] = start[:3, :3] @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return q, paths.arc(start, start[:3, 3] + away / 2 + 0.05 * turn[1], end) if k % 2 else paths.line(start, end)


def held_to(robot: ps.Robot, path: paths.Path, law: ps.Trajectory, move: ps.Trajectory, t: Array) -> float:
    wanted = path.frames(np.clip(law(t)[:, 0], 0, path.length))
    return float(np.abs(ps.forward_kinematics(robot, move(t)) - wanted).max())


def test_textbook_line_of_a_two_link_arm(planar: ps.Robot) -> None:
    """From (0, 0.5) to (1, -0.5) in 2 s at a cruise of 1 m/s: position, velocity, acceleration in closed form.

    Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control, 4.3, on links of 1 m.
    """
    start = np.eye(4)
    start[:3, 3] = [0, 0.5, 0]
    path = paths.line(start, [1, -0.5, 0])
    law = ps.profiles.trapezoidal([[0], [path.length]], [0, 2.0], cruise_velocity=1.0)
    move = ps.tool_move(planar, path, law, start=two_link(np.array(0.0), np.array(0.5)), constrain="position")
    # Times off the breaks, at which the acceleration steps.
    t = np.concatenate([np.linspace(a, b, 101)[1:-1] for a, b in zip(law.breaks[:-1], law.breaks[1:], strict=True)])
    s, v, a = (law(t, k) / np.sqrt(2) for k in range(3))
    x, y = s[:, 0], 0.5 - s[:, 0]
    q = two_link(x, y)
    np.testing.assert_allclose(move(t), q, atol=1e-12)
    # J and its derivative, of links of 1 m: p = (c1 + c12, s1 + s12).
    first, both = q[:, 0], q.sum(axis=1)
    j = np.array([[-np.sin(first) - np.sin(both), -np.sin(both)], [np.cos(first) + np.cos(both), np.cos(both)]])
    j = j.transpose(2, 0, 1)
    slope = np.array([1.0, -1.0])
    rate = np.linalg.solve(j, (v * slope)[..., None])[..., 0]
    spin, total = rate[:, :1], rate.sum(axis=1, keepdims=True)
    pull = -np.stack([np.cos(first), np.sin(first)], 1) * spin**2 - np.stack([np.cos(both), np.sin(both)], 1) * total**2
    bend = np.linalg.solve(j, (a * slope - pull)[..., None])[..., 0]
    np.testing.assert_allclose(move(t, 1), rate, atol=1e-12 * np.abs(rate).max())
    np.testing.assert_allclose(move(t, 2), bend, atol=1e-12 * np.abs(bend).max())


@pytest.mark.slow
@pytest.mark.parametrize(("arm", "count"), [("puma560", 16), ("ur5", 12), ("panda", 2)])
def test_the_tool_stays_on_its_path_between_nodes(arm: str, count: int) -> None:
    """To 1e-9 m and rad at random instants; a refusal is right where no dense sample search finds a way either."""
    robot = ps.load_robot() if arm == "puma560" else getattr(arms, arm)()
    rng, worst, solved, false = np.random.default_rng(7), 0.0, 0, 0
    for k in range(count):
        q, path = random_path(rng, robot, k)
        try:
            way = paths.follow(robot, path, start=q)
        except NoSolution:
            false += arm != "panda" and not refused_rightly(robot, path, q)
            continue
        law = paths.in_time(path, 2.0)
        worst = max(worst, held_to(robot, path, law, paths.timed(way, law), rng.uniform(0, 2, 2000)))
        solved += 1
    assert worst < 1e-9
    assert false == 0
    assert solved >= count / 3


def refused_rightly(robot: ps.Robot, path: paths.Path, q: Array) -> bool:
    """Whether the branch of `q`, on 3001 samples, ends, leaps by more than 0.3 rad, or leaves the limits."""
    found = ps.inverse_kinematics_batch(robot, path.frames(np.linspace(0, path.length, 3001)))
    k = int(np.argmin(np.abs(np.sin((found.q[0] - q) / 2)).max(axis=1) + 9 * ~found.exists[0]))
    steps = np.diff(found.q[:, k], axis=0)
    leaps = np.abs(steps - 2 * np.pi * np.rint(steps / (2 * np.pi))).max() > 0.3
    return bool(leaps or not found.exists[:, k].all() or not found.within_limits[:, k].all())


@pytest.mark.slow
def test_derivatives_against_fifty_digits() -> None:
    """Ten lines of the PUMA, two of them passing the shoulder's singularity at 1 mm: v and a to 1e-9, jerk to 1e-6."""
    robot, rng, lines = ps.load_robot(tool="wrist_center"), np.random.default_rng(11), []
    for q in NEAR_SHOULDER:
        pose = ps.forward_kinematics(robot, q)
        side = np.array([-pose[1, 3], pose[0, 3], 0]) / np.hypot(*pose[:2, 3])
        start = pose.copy()
        start[:3, 3] -= 0.1 * side
        lines.append(paths.follow(robot, paths.line(start, pose[:3, 3] + 0.1 * side)))
        assert 0.9e-3 < np.abs(lines[-1].singularity(np.linspace(0, 0.2, 2001))[:, 0]).min() < 1.1e-3
    while len(lines) < 10:
        q, path = random_path(rng, robot, 0)
        try:
            lines.append(paths.follow(robot, paths.line(path.frames(0.0), path.frames(path.length)[:3, 3])))
        except NoSolution:
            continue
    for way in lines:
        length = way.path.length
        move = paths.timed(way, paths.in_time(way.path, 2.0))
        start, direction = way.path.frames(0.0), way.path.rates(np.zeros(1, int), np.zeros(1)).linear[0, 0]
        peaks = [move.peak(order)[0].max() for order in range(4)]

        def law(t, length=length):  # type: ignore[no-untyped-def]
            return length * (t / 2) ** 3 * (10 - 15 * (t / 2) + 6 * (t / 2) ** 2)

        for t in (0.31, 0.99, 1.43):
            exact = derivatives(robot, start, direction, law, t, move(t))
            off = [np.abs(move(t, order) - exact[order]).max() / peaks[order] for order in range(4)]
            assert off[1] < 1e-9
            assert off[2] < 1e-9
            assert off[3] < 1e-6


def test_a_continuous_joint_is_unwound_over_three_turns(planar: ps.Robot) -> None:
    start = np.eye(4)
    start[:3, 3] = [1.2, 0, 0]
    path = paths.circle(start, centre=[0, 0, 0], axis=[0, 0, 1], angle=6 * np.pi)
    way = paths.follow(planar, path, start=two_link(np.array(1.2), np.array(0.0)), constrain="position")
    turned = way.position([0, path.length])
    np.testing.assert_allclose(turned[1] - turned[0], [6 * np.pi, 0], atol=1e-11)


def test_one_law_leads_round_corners_without_a_stop() -> None:
    robot = ps.load_robot()
    pose = ps.forward_kinematics(robot, [0, 0.5, -2.5, 0, 0.7, 0])
    poses = np.tile(pose, (4, 1, 1))
    poses[1:, :3, 3] += [[0, 0.2, 0], [0, 0.2, 0.2], [-0.1, 0.2, 0.2]]
    path = paths.polyline(poses, zone=0.04)
    law = paths.at_speed(path, speed=0.25, acceleration=1.0, jerk=10.0)
    move = ps.tool_move(robot, path, law)
    t = np.linspace(0, move.duration, 4001)
    assert held_to(robot, path, law, move, t) < 1e-9
    assert not move.jumps(1).times.size
    assert not move.jumps(2).times.size
    rates = paths.tool_rates(robot, move)
    speed = np.sqrt(np.maximum(rates.square("speed")(t)[:, 0], 0))
    np.testing.assert_allclose(speed, np.abs(law(t, 1)[:, 0]), atol=1e-6)
    assert rates.peak("speed")[0] == pytest.approx(0.25, abs=1e-9)
    assert rates.peak("angular speed")[0] < 1e-9
    speed_check, pull_check = rates.checks(
        paths.ToolLimits(speed=0.25, acceleration=1.0, source="manual reduced speed")
    )
    assert not speed_check.is_violated
    assert pull_check.is_violated  # the corners pull more than the law
    assert str(pull_check).startswith("tool acceleration")


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 10))])
def test_peak_torque_along_a_line_is_that_of_dense_samples_refined(seed: int) -> None:
    """Of random lines of the PUMA; the samples are taken again, 1,000 and 100,000 times as dense, about each peak."""
    robot, rng = ps.load_robot(), np.random.default_rng(seed)
    pose = ps.forward_kinematics(robot, [0, 0.5, -2.5, 0, 0.7, 0])
    path = paths.line(pose, pose[:3, 3] + rng.uniform([-0.1, 0.1, -0.1], [0.1, 0.3, 0.2]))
    move = ps.tool_move(robot, path, paths.in_time(path, 1.0))
    assessment = ps.assess(robot, move)
    peak, time = assessment.peak_torque, assessment.peak_torque_time
    for span in (0.5, 1e-3, 1e-5):
        for j in range(6):
            # Not at rest itself, where the sign of rounding would be that of friction.
            t = np.clip(time[j] + np.linspace(-span, span, 4001), 1e-3, 1 - 1e-3)
            sampled = np.abs(ps.inverse_dynamics(robot, move(t), move(t, 1), move(t, 2))[:, j]).max()
            assert sampled <= peak[j] * (1 + 1e-9)
    moving = (time > 0) & (time < 1)
    there = np.abs(np.diag(ps.inverse_dynamics(robot, *(move(time, order) for order in range(3)))))
    # Within: at a reversal the peak is one side's, by the sign of friction, and is held by the samples above alone.
    smooth = moving & (np.abs(np.diag(move(time, 1))) > 1e-9)
    np.testing.assert_allclose(there[smooth], peak[smooth], rtol=1e-9)
    assert smooth.sum() >= 3


def test_refusals_say_where_by_how_much_and_what_would_help(planar: ps.Robot) -> None:
    robot = ps.load_robot()
    pose = ps.forward_kinematics(robot, [0, 0.5, -2.5, 0, 0.7, 0])
    far = paths.line(pose, pose[:3, 3] + [2.0, 0, 0])
    with pytest.raises(NoSolution, match=r"out of reach by .* at s = .* m of 2 m, tool at \[.*no other branch"):
        paths.follow(robot, far)
    through = pose.copy()
    through[:3, 3] -= [0.6, 0, 0]
    with pytest.raises(NoSolution, match=r"'right-up-noflip': .*; (branches that reach all of it|no branch)"):
        paths.follow(robot, paths.line(pose, through), branch="right-up-noflip")
    with pytest.raises(InputError, match="unknown branch 'up'; valid: 'right-up-noflip'"):
        paths.follow(robot, paths.line(pose, through), branch="up")
    start = np.eye(4)
    start[:3, 3] = [0, 1.5, 0]
    out = paths.line(start, [0, 2.5, 0])
    with pytest.raises(NoSolution, match=r"at s = 0\.(49|5).*least singular value of the position's .* zero") as met:
        paths.follow(planar, out, start=two_link(np.array(0.0), np.array(1.5)), constrain="position")
    assert met.value.residual < 0.01  # it was the manipulability of the whole pose, which is 1 there
    held = ps.forward_kinematics(planar, [0.3, 0.9])
    with pytest.raises(
        NoSolution, match=r"leaves the path at s = .* m or rad off\).*'position' leaves the orientation"
    ):
        paths.follow(planar, paths.line(held, held[:3, 3] + [0.1, 0.2, 0]), start=[0.3, 0.9])
    with pytest.raises(InputError, match=r"planar has no closed form here, .* give start"):
        paths.follow(planar, out, constrain="position")
    short = paths.line(pose, pose[:3, 3] + [0, 0.1, 0])
    with pytest.raises(InputError, match=r"leads from 0 m to 1 m; the path needs 0 to 0\.1 m"):
        ps.tool_move(robot, short, ps.quintic_segments([[0.0], [1.0]], [0, 1.0]))
    with pytest.raises(InputError, match=r"leaves the path: it reaches from .* m to 0\.2 m of \[0, 0\.1\] m"):
        ps.tool_move(robot, short, ps.quintic_segments([[0.0], [0.2], [0.1]], [0, 1.0, 2.0]))
    with pytest.raises(InputError, match="law: 2 components; a law of time has one, the distance covered in m"):
        ps.tool_move(robot, short, ps.quintic_segments([[0.0, 0.0], [0.1, 0.1]], [0, 1.0]))
    with pytest.raises(InputError, match="branch = 'up': puma560 has no named branches here; give a start posture"):
        paths.follow(robot, short, branch="up", constrain="position")


def test_what_lies_between_the_first_places_is_seen() -> None:
    """A branch is looked at in 33 places; here it is lost, or one with another, in a thousandth of the path."""
    arm = ps.load_robot(tool="wrist_center")
    free = arm.with_limits(position=np.full((6, 2), [-7.0, 7.0]))
    # The first axis, shoulder and wrist centre's offset by Corke's table; reach is that of the stretched arm.
    reach, (x, y, z) = 0.4318 + np.hypot(0.0203, 0.4318), (0.0, -0.15005, 0.67183)
    start = ps.forward_kinematics(free, [0, 0.2, 0.3, 0.1, 0.8, 0.3])
    start[:3, 3] = [x + reach - 0.4 + 1e-5, y, z]
    round_ = paths.circle(start, centre=[x + reach - 0.2 + 1e-5, y, z], axis=[0, 1, 0], angle=6.0)
    with pytest.raises(NoSolution, match=r"the arm leaves the path at s = 0\.6[23]\d* m of 1\.2 m.* out of its reach"):
        paths.follow(free, round_, branch="left-down-noflip")
    ends = [ps.forward_kinematics(free, q) for q in ([0, 0.5, -2.5, 0, 0.3, 0], [0, 0.6, -2.6, 0, -0.3, 0])]
    with pytest.raises(
        NoSolution, match=r"meets a singularity at s = 0\.021.* \(wrist -?\d.*e-\d+, zero where singular"
    ):
        paths.follow(free, paths.line(*ends), branch="right-up-noflip")


def test_a_path_that_starts_at_the_stretched_elbow_is_refused() -> None:
    arm = ps.load_robot(tool="wrist_center").with_limits(position=np.full((6, 2), [-7.0, 7.0]))
    start = ps.forward_kinematics(arm, [0, 0, np.arctan2(0.0203, 0.4318) - np.pi / 2, 0.2, 0.8, 0.3])
    inwards = paths.line(start, start[:3, 3] - [0.2, 0, 0])
    with pytest.raises(NoSolution, match=r"meets a singularity at s = 0 m of 0\.2 m.* \(elbow .*, zero where singular"):
        paths.follow(arm, inwards, branch="right-up-noflip")
    with pytest.raises(InputError, match="trajectory: 1 joints, puma560 has 6"):
        paths.tool_rates(arm, ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0]))


def test_a_joint_limit_is_refused_with_joint_place_and_bound() -> None:
    robot = ps.load_robot()
    pose = ps.forward_kinematics(robot, [2.6, 0.5, -2.5, 0, 0.7, 0])
    axis = paths.circle(pose, centre=[0, 0, 0], axis=[0, 0, 1], angle=0.5, orientation="tangent")
    with pytest.raises(NoSolution, match=r"joint 'joint1': 2\.\d+ rad is outside \[-2.79253, 2.79253\] rad at s = "):
        paths.follow(robot, axis, branch="right-up-noflip")
    pose = ps.forward_kinematics(robot, [-0.2, 0.5, -2.5, 0, 0.7, 0])
    across = paths.line(pose, pose[:3, 3] + [0, 0.3, 0])
    inside = paths.follow(robot, across).position.extrema()
    bounds = np.array(robot.limits.position)
    bounds[1] = [-2.9, inside.max[1] - 1e-7]  # the joint's largest angle lies between the places looked at first
    assert 0 < inside.t_max[1] < across.length
    with pytest.raises(NoSolution, match=r"joint 'joint2': 0\.6\d+ rad is outside \[-2\.9, 0\.6"):
        paths.follow(robot.with_limits(position=bounds), across, branch="right-up-noflip")
