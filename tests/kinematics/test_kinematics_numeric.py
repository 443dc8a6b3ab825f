"""Inverse kinematics of any arm: what holds with a closed form and without, by damped least squares."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.arms import BRANCHED, EXAMPLES, joint, link
from helpers.arms import load as load_arm
from helpers.six_axis_arms import KR5, QUARTER, standard
from helpers.six_axis_arms import arm as six_axis_arm
from helpers.urdf_texts import load

import puma_septic as ps
from puma_septic.kinematics._chain import chain_to
from puma_septic.kinematics._least_squares import distinct, is_solved, levenberg_marquardt
from puma_septic.kinematics._poses import checked_poses, pose_errors
from puma_septic.kinematics._puma_branches import puma_geometry

FINGERS = {"panda_finger_joint1": 0.04, "panda_finger_joint2": 0.04}


@pytest.fixture(params=["ur5", "panda", "kinova"])
def arm(request: pytest.FixtureRequest) -> ps.Robot:
    return ps.load_robot(EXAMPLES[request.param], locked=FINGERS if request.param == "panda" else {})


def within(robot: ps.Robot, q: np.ndarray) -> np.ndarray:
    low, high = robot.limits.position.T
    return ~((q < low) | (q > high)).any(axis=1)


def random_q(robot: ps.Robot, rng: np.random.Generator, count: int) -> np.ndarray:
    low, high = np.nan_to_num(robot.limits.position.T, nan=0.0)
    low, high = np.where(low == high, -np.pi, low), np.where(low == high, np.pi, high)
    return rng.uniform(low, high, (count, robot.n_joints))


def test_forward_of_inverse_is_identity(arm: ps.Robot, rng: np.random.Generator) -> None:
    assert puma_geometry(chain_to(arm)) is None
    for q in random_q(arm, rng, 4):
        pose = ps.forward_kinematics(arm, q)
        solutions = ps.inverse_kinematics(arm, pose)
        assert len(solutions.q) >= 1
        assert len(solutions.q) == len(solutions.configurations) == len(solutions.singular)
        # What counts as solved; Newton's last step leaves rounding.
        assert np.abs(ps.forward_kinematics(arm, solutions.q) - pose).max() < 1e-10
        assert solutions.residual.max() < 1e-10
        np.testing.assert_array_equal(solutions.within_limits, within(arm, solutions.q))
        assert solutions.within_limits.any()  # q itself is within the limits, so that an answer there exists


def test_equal_calls_give_equal_answers(arm: ps.Robot, rng: np.random.Generator) -> None:
    pose = ps.forward_kinematics(arm, random_q(arm, rng, 1)[0])
    first, second = ps.inverse_kinematics(arm, pose), ps.inverse_kinematics(arm, pose)
    np.testing.assert_array_equal(first.q, second.q)
    seeded = [ps.inverse_kinematics(arm, pose, rng=np.random.default_rng(7)).q for _ in range(2)]
    np.testing.assert_array_equal(*seeded)


def test_q_near_is_among_the_answers(arm: ps.Robot, rng: np.random.Generator) -> None:
    """Without a closed form there is no step to take from the answer itself, in this turn and no other."""
    q = random_q(arm, rng, 1)[0]
    solutions = ps.inverse_kinematics(arm, ps.forward_kinematics(arm, q), q_near=q, starts=1)
    # Close to where two branches meet, a closed form's rounding grows by the inverse of the distance.
    assert np.abs(solutions.q - q).max(axis=1).min() < 1e-9
    if not solutions.is_complete:
        assert len(solutions.q) == 1


def test_limits_are_left_only_where_they_must(tmp_path: Path) -> None:
    """The elbow, limited to 2.5 rad, is bent by 2.8: no answer within the limits, one without."""
    robot = load(tmp_path)
    solutions = ps.inverse_kinematics(robot, ps.forward_kinematics(robot, [0.3, 2.8]))
    np.testing.assert_allclose(solutions.q, [[0.3, 2.8]], rtol=0, atol=1e-9)
    assert not solutions.within_limits.any()


def test_arm_with_a_prismatic_joint_and_a_side_branch(tmp_path: Path) -> None:
    """The joint on the side branch stays at mid-range, or where `q_near` has it."""
    robot = load(tmp_path, BRANCHED, tool="e")
    aside, q = robot.joint_index("aside"), np.array([0.4, -0.3, 1.2, 0.8, -0.5])
    pose = ps.forward_kinematics(robot, q)
    solutions = ps.inverse_kinematics(robot, pose)
    assert np.abs(ps.forward_kinematics(robot, solutions.q) - pose).max() < 1e-10
    assert not solutions.q[:, aside].any()
    near = ps.inverse_kinematics(robot, pose, q_near=q)
    np.testing.assert_allclose(near.q[0], q, rtol=0, atol=1e-9)
    assert (near.q[:, aside] == q[aside]).all()


def test_singular_posture_is_reported() -> None:
    """A panda with all joints at zero: axes 1, 3 and 5 are one line."""
    robot = ps.load_robot(EXAMPLES["panda"], locked=FINGERS)
    q = np.zeros(7)
    solutions = ps.inverse_kinematics(robot, ps.forward_kinematics(robot, q), q_near=q, starts=1)
    assert solutions.singular == (("jacobian",),)


def offset_wrist(folder: Path) -> ps.Robot:
    """A KUKA KR 5's arm with 80 mm between axes 5 and 6."""
    rows = [*KR5[:4], (0.08, KR5[4][1], 0.0), KR5[5]]
    return six_axis_arm(folder, "offset", standard(rows))


def test_what_is_found_from_starts_says_so(tmp_path: Path, rng: np.random.Generator) -> None:
    """`assess` once said "all N branches" of what 32 starts had happened to find."""
    robot = offset_wrist(tmp_path)
    pose = ps.forward_kinematics(robot, rng.uniform(-2, 2, 6))
    solutions = ps.inverse_kinematics(robot, pose)
    assert not solutions.is_complete
    assert solutions.starts > 32
    assert solutions.extent == f"{len(solutions.q)} solutions found from {solutions.starts} starts"
    one = ps.inverse_kinematics(robot, pose, q_near=solutions.q[0], starts=1)
    assert one.extent == "1 solution found from 1 start"


def test_mirror_images_find_what_starts_miss(tmp_path: Path, rng: np.random.Generator) -> None:
    """Eight random starts alone find fewer than with the mirror images of what they find."""
    robot = offset_wrist(tmp_path)
    poses = ps.forward_kinematics(robot, rng.uniform(-2, 2, (6, 6)))
    mirrored = sum(len(ps.inverse_kinematics(robot, pose, starts=8).q) for pose in poses)
    plain = 0
    for pose in poses:
        starts = np.random.default_rng(0).uniform(-np.pi, np.pi, (8, 6))
        q, errors = levenberg_marquardt(robot, checked_poses("T", pose[None]), starts)
        plain += len(distinct(robot, q[is_solved(errors)]))
    assert mirrored > 1.3 * plain


def test_out_of_reach(arm: ps.Robot) -> None:
    pose = np.eye(4)
    pose[:3, 3] = [0.0, 3.0, 0.5]
    with pytest.raises(
        ps.NoSolution, match=r"no joint positions found .* attempts; the nearest q = .* m and .* rad"
    ) as caught:
        ps.inverse_kinematics(arm, pose)
    left = ps.forward_kinematics(arm, caught.value.q)[:3, 3] - pose[:3, 3]
    assert 1.0 < np.linalg.norm(left) <= caught.value.residual + 1e-12


def test_pose_errors_are_rotation_vectors(rng: np.random.Generator) -> None:
    """Against Rodrigues' formula, up to half a turn, where the axis is lost but not the size."""
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    for angle in (0.0, 1e-9, 0.3, 2.0, 3.1, np.pi):
        target = np.eye(4)
        target[:3, :3] = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
        found = pose_errors(checked_poses("T", target[None]), checked_poses("T", np.eye(4)[None]))[0]
        assert not found[:3].any()
        if angle < np.pi:
            np.testing.assert_allclose(found[3:], angle * axis, rtol=0, atol=1e-13)
        assert np.linalg.norm(found[3:]) == pytest.approx(angle, abs=1e-13)


def test_batch_is_for_closed_forms_only(tmp_path: Path) -> None:
    with pytest.raises(ps.ModelError, match=r"neither a spherical wrist nor three parallel axes.*call inverse_kinemat"):
        ps.inverse_kinematics_batch(offset_wrist(tmp_path), np.eye(4)[None])
    with pytest.raises(ps.InputError, match=r"starts = 0: expected a whole number from 1 to 10000"):
        ps.inverse_kinematics(ps.load_robot(EXAMPLES["ur5"]), np.eye(4), starts=0)


def test_a_tool_that_no_joint_carries_has_no_joint_positions(tmp_path: Path) -> None:
    """A gripper alone, whose tool is its palm, was an IndexError."""
    robot = load(tmp_path, tool="base")
    with pytest.raises(ps.ModelError, match=r"no joint of 'arm' carries the tool 'base': choose another frame"):
        ps.inverse_kinematics(robot, np.eye(4))


# ---- some of the conditions


def five_axes(folder: Path) -> ps.Robot:
    """A KUKA KR 5's arm without its axis 4, and then without axis 6: the tool's axis stays in the arm's plane."""
    places = standard(KR5)
    return six_axis_arm(folder, "five", [*places[:3], ([0.12, 0, 0], [-QUARTER, 0, 0]), *places[4:6], places[6]][:6])


def test_position_alone(tmp_path: Path, rng: np.random.Generator) -> None:
    """Three joints that place a point: the turn follows."""
    robot = six_axis_arm(tmp_path, "three", [*standard(KR5)[:3], ([0.62, 0, 0], [0, 0, 0])])
    for q in rng.uniform(-2, 2, (3, 3)):
        pose = ps.forward_kinematics(robot, q)
        pose[:3, :3] = np.eye(3)
        solutions = ps.inverse_kinematics(robot, pose, constrain="position")
        reached = ps.forward_kinematics(robot, solutions.q)
        np.testing.assert_allclose(reached[:, :3, 3] - pose[:3, 3], 0.0, rtol=0, atol=1e-10)
        assert np.abs((solutions.q - q + np.pi) % (2 * np.pi) - np.pi).max(axis=1).min() < 1e-8
        assert solutions.residual.max() < 1e-10
        with pytest.raises(
            ps.NoSolution,
            match=r"3 joints cannot meet 6 conditions but by chance: give fewer \(constrain='position', or six truth",
        ):
            ps.inverse_kinematics(robot, pose)


def test_position_and_axis(tmp_path: Path, rng: np.random.Generator) -> None:
    """Five joints: the tool's z axis points where it should, the turn about it is what it is."""
    robot = five_axes(tmp_path)
    assert robot.n_joints == 5
    for q in rng.uniform(-1.5, 1.5, (3, 5)):
        pose = ps.forward_kinematics(robot, q)
        c, s = np.cos(1.0), np.sin(1.0)
        pose[:3, :3] = pose[:3, :3] @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
        solutions = ps.inverse_kinematics(robot, pose, constrain="axis")
        reached = ps.forward_kinematics(robot, solutions.q)
        np.testing.assert_allclose(reached[:, :3, 2:] - pose[:3, 2:], 0.0, rtol=0, atol=1e-10)


def test_masked_pose_of_a_scara(tmp_path: Path) -> None:
    """Four joints, x, y and z and the turn about z: what a SCARA's controller takes."""
    body = '<link name="base"/>' + "".join(link(f"l{k}", 1.0, [0, 0, 0], 0.01 * np.eye(3)) for k in range(1, 5))
    up = [0.0, 0.0, 1.0]
    body += joint("j1", "revolute", "base", "l1", [0, 0, 0.4], up) + joint(
        "j2", "revolute", "l1", "l2", [0.3, 0, 0], up
    )
    body += joint("j3", "prismatic", "l2", "l3", [0.25, 0, 0], up) + joint("j4", "revolute", "l3", "l4", [0, 0, 0], up)
    robot = load_arm(tmp_path, "scara", body, tool="l4")
    q = np.array([0.4, 0.9, -0.1, 0.7])
    pose = ps.forward_kinematics(robot, q)
    tilted = pose.copy()
    tilt = 0.01  # as a table that is not quite level asks for
    tilted[:3, :3] = tilted[:3, :3] @ [[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]]
    found = ps.inverse_kinematics(robot, pose)  # upright the six conditions can be met
    assert len(found.q) == 2
    with pytest.raises(ps.NoSolution, match=r"4 joints cannot meet 6 conditions.*constrain='position', or six truth"):
        ps.inverse_kinematics(robot, tilted)
    mask = [True, True, True, False, False, True]
    masked = ps.inverse_kinematics(robot, pose, constrain=mask)
    assert np.abs(masked.q - q).max(axis=1).min() < 1e-9
    assert ps.inverse_kinematics(robot, tilted, constrain=mask).residual.max() < 1e-10


@pytest.mark.parametrize(
    ("constrain", "message"),
    [
        ("orientation", r"unknown constrain 'orientation'; valid: 'pose', 'position', 'axis'"),
        ([True] * 5, r"constrain: expected 'pose', .* or six truth values, .*turn about z .*; got \[True"),
        ([False] * 6, r"at least one of them True"),
        ([1, 1, 1, 0, 0, 0], r"six truth values"),
    ],
)
def test_unknown_conditions_are_refused(constrain: object, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.inverse_kinematics(ps.load_robot(), np.eye(4), constrain=constrain)  # type: ignore[arg-type]


# ---- poses with few decimals


def test_a_rotation_copied_with_four_decimals_is_taken_within_a_stated_tolerance() -> None:
    """It was refused without a word of how to have it taken; the nearest rotation is its polar factor."""
    robot = ps.load_robot()
    pose = ps.forward_kinematics(robot, [0.4, 1.1, -2.0, 0.3, 0.8, -1.0])
    rough = np.round(pose, 4)
    with pytest.raises(
        ps.InputError, match=r"R\^T R differs from .* by .*few decimals, tolerance=\de-0\d takes the near"
    ):
        ps.inverse_kinematics(robot, rough)
    solutions = ps.inverse_kinematics(robot, rough, tolerance=2e-4)
    rotation = ps.forward_kinematics(robot, solutions.q[0])[:3, :3]
    left, _, right = np.linalg.svd(rough[:3, :3])
    np.testing.assert_allclose(rotation, left @ right, rtol=0, atol=1e-12)
    batch = ps.inverse_kinematics_batch(robot, rough[None], tolerance=2e-4)
    np.testing.assert_allclose(batch.q[0], solutions.q, rtol=0, atol=1e-12)
    with pytest.raises(ps.InputError, match=r"differs from the identity by \S+ \(at most 1e-06\)"):
        ps.inverse_kinematics(robot, rough, tolerance=1e-6)
    with pytest.raises(ps.InputError, match=r"tolerance = -1 must be at least 0"):
        ps.inverse_kinematics(robot, pose, tolerance=-1.0)
