"""Inverse kinematics of other arms, by damped least squares."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.arms import BRANCHED, EXAMPLES
from helpers.urdf_texts import load

import puma_septic as ps
from puma_septic.kinematics._chain import chain_to
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
        assert solutions.within_limits[0]  # q itself is within the limits, so that an answer there exists


def test_ur5_has_eight_branches() -> None:
    """A general pose of a UR arm has up to eight solutions (Hawkins 2013); more starts find them all, once each."""
    robot = ps.load_robot(EXAMPLES["ur5"])
    pose = ps.forward_kinematics(robot, [0.5, -1.2, 1.4, -0.6, 1.1, 0.3])
    solutions = ps.inverse_kinematics(robot, pose, starts=200)
    assert len(solutions.q) == 8
    assert solutions.configurations[-1] == "solution-8"
    assert solutions.singular == ((),) * 8


def test_equal_calls_give_equal_answers(arm: ps.Robot, rng: np.random.Generator) -> None:
    pose = ps.forward_kinematics(arm, random_q(arm, rng, 1)[0])
    first, second = ps.inverse_kinematics(arm, pose), ps.inverse_kinematics(arm, pose)
    np.testing.assert_array_equal(first.q, second.q)
    seeded = [ps.inverse_kinematics(arm, pose, rng=np.random.default_rng(7)).q for _ in range(2)]
    np.testing.assert_array_equal(*seeded)


def test_starts_from_q_near(arm: ps.Robot, rng: np.random.Generator) -> None:
    """From the answer itself there is no step to take, in this turn and no other."""
    q = random_q(arm, rng, 1)[0]
    solutions = ps.inverse_kinematics(arm, ps.forward_kinematics(arm, q), q_near=q, starts=1)
    np.testing.assert_allclose(solutions.q, [q], rtol=0, atol=1e-12)


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
    """A UR5 with q5 = 0: axes 4 and 6 are parallel."""
    robot = ps.load_robot(EXAMPLES["ur5"])
    q = np.array([0.5, -1.2, 1.4, -0.6, 0.0, 0.3])
    solutions = ps.inverse_kinematics(robot, ps.forward_kinematics(robot, q), q_near=q)
    assert solutions.singular[0] == ("jacobian",)


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


def test_batch_is_for_pumas_only() -> None:
    with pytest.raises(ps.ModelError, match=r"does not have a PUMA's joints.*call inverse_kinematics for each pose"):
        ps.inverse_kinematics_batch(ps.load_robot(EXAMPLES["ur5"]), np.eye(4)[None])
    with pytest.raises(ps.InputError, match=r"starts = 0 must be at least 1"):
        ps.inverse_kinematics(ps.load_robot(EXAMPLES["ur5"]), np.eye(4), starts=0)
