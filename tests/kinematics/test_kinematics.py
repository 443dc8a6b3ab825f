"""Forward kinematics, Jacobian and tool motion: against the oracle, Pinocchio and differences."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from helpers.arms import BRANCHED, EXAMPLES
from helpers.urdf_texts import load

import puma_septic as ps


@pytest.fixture(params=["puma", "ur5", "panda", "kinova", "branched"])
def arm(request: pytest.FixtureRequest, tmp_path: Path) -> ps.Robot:
    """Arms of all kinds of joints."""
    if request.param == "puma":
        return ps.load_robot()
    if request.param == "branched":
        path = tmp_path / "branched.urdf"
        path.write_text(BRANCHED)
        return ps.load_robot(path, tool="e")
    locked = {"panda_finger_joint1": 0.04, "panda_finger_joint2": 0.04} if request.param == "panda" else {}
    return ps.load_robot(EXAMPLES[request.param], locked=locked)


@pytest.fixture(scope="module")
def oracle(reference: Path) -> dict[str, np.ndarray]:
    with np.load(reference / "puma560_oracle.npz") as file:
        return {name: file[name] for name in ("q", "qd", "qdd", "fkine", "jacob0", "jacob0_dot")}


@pytest.fixture(scope="module")
def wrist() -> ps.Robot:
    return ps.load_robot(tool="wrist_center")


def test_puma_agrees_with_the_oracle(wrist: ps.Robot, oracle: dict[str, np.ndarray]) -> None:
    """200 configurations by roboticstoolbox-python 1.4.4; both sides round at 1e-15."""
    np.testing.assert_allclose(ps.forward_kinematics(wrist, oracle["q"]), oracle["fkine"], rtol=0, atol=1e-12)
    np.testing.assert_allclose(ps.jacobian(wrist, oracle["q"]), oracle["jacob0"], rtol=0, atol=1e-12)


def test_tool_motion_is_the_jacobians(wrist: ps.Robot, oracle: dict[str, np.ndarray]) -> None:
    """p' = J v and p'' = J a + J' v with the oracle's own matrices; entries up to 10."""
    motion = ps.tool_motion(wrist, oracle["q"], oracle["qd"], oracle["qdd"])
    rates = np.einsum("nij,nj->ni", oracle["jacob0"], oracle["qd"])
    changes = np.einsum("nij,nj->ni", oracle["jacob0"], oracle["qdd"])
    changes += np.einsum("nij,nj->ni", oracle["jacob0_dot"], oracle["qd"])
    np.testing.assert_allclose(motion.position, oracle["fkine"][:, :3, 3], rtol=0, atol=1e-12)
    np.testing.assert_allclose(np.hstack((motion.velocity, motion.angular_velocity)), rates, rtol=0, atol=1e-12)
    found = np.hstack((motion.acceleration, motion.angular_acceleration))
    np.testing.assert_allclose(found, changes, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("q", "position"),
    [
        # roboticstoolbox-python 1.4.4, models/DH/Puma560.py, d1 = 26.45 in
        ([0, 0, 0, 0, 0, 0], [0.4521, -0.15005, 1.10363]),
        ([0, np.pi / 2, -np.pi / 2, 0, 0, 0], [0.0203, -0.15005, 1.53543]),
        ([0, 0, -np.pi / 2, 0, 0, 0], [0.8636, -0.15005, 0.65153]),
    ],
)
def test_named_poses(wrist: ps.Robot, q: list[float], position: list[float]) -> None:
    pose = ps.forward_kinematics(wrist, q)
    np.testing.assert_allclose(pose[:3, 3], position, rtol=0, atol=1e-15)


def test_frames_of_the_puma(puma: ps.Robot) -> None:
    """The flange is 0.05625 m (Corke 1996) beyond the wrist centre; the shoulder does not move with any joint."""
    q = [0.3, -0.4, 0.5, -0.6, 0.7, -0.8]
    flange = ps.forward_kinematics(puma, q)
    centre = ps.forward_kinematics(puma, q, frame="wrist_center")
    np.testing.assert_allclose(flange[:3, 3], centre[:3, 3] + 0.05625 * centre[:3, 2], rtol=0, atol=1e-15)
    shoulder = ps.forward_kinematics(puma, [q, q], frame="shoulder_base")
    np.testing.assert_array_equal(shoulder[:, :3, 3], [[0, 0, 0.67183]] * 2)


def test_agrees_with_pinocchio(arm: ps.Robot, rng: np.random.Generator) -> None:
    """Every frame of every arm; two sums of products in different order, entries up to 2."""
    q = rng.uniform(-3, 3, (20, arm.n_joints))
    data = arm.model.createData()
    frames = {f.name: arm.model.getFrameId(f.name, f.type) for f in arm.model.frames if f.type == pin.FrameType.BODY}
    poses = {name: ps.forward_kinematics(arm, q, frame=name) for name in frames}
    jacobians = ps.jacobian(arm, q)
    for k, configuration in enumerate(arm.configurations(q)):
        pin.framesForwardKinematics(arm.model, data, configuration)
        for name, index in frames.items():
            np.testing.assert_allclose(poses[name][k], data.oMf[index].homogeneous, rtol=0, atol=2e-14)
        expected = pin.computeFrameJacobian(
            arm.model, data, configuration, arm.tool_id, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )
        np.testing.assert_allclose(jacobians[k], arm.from_tangents(expected), rtol=0, atol=2e-14)


def test_tool_motion_agrees_with_pinocchio(arm: ps.Robot, rng: np.random.Generator) -> None:
    q, v, a = rng.uniform(-2, 2, (3, 10, arm.n_joints))
    motion = ps.tool_motion(arm, q, v, a)
    data = arm.model.createData()
    world = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    rates, changes = arm.tangents(v), arm.tangents(a)
    for k, configuration in enumerate(arm.configurations(q)):
        pin.forwardKinematics(arm.model, data, configuration, rates[k], changes[k])
        velocity = pin.getFrameVelocity(arm.model, data, arm.tool_id, world)
        acceleration = pin.getFrameClassicalAcceleration(arm.model, data, arm.tool_id, world)
        pairs = [
            (motion.velocity, velocity.linear),
            (motion.angular_velocity, velocity.angular),
            (motion.acceleration, acceleration.linear),
            (motion.angular_acceleration, acceleration.angular),
        ]
        for found, expected in pairs:  # entries up to 100
            np.testing.assert_allclose(found[k], expected, rtol=0, atol=1e-12)


def test_one_configuration_is_a_row_of_many(arm: ps.Robot, rng: np.random.Generator) -> None:
    q, v, a = rng.uniform(-2, 2, (3, 5, arm.n_joints))
    many, motion = ps.jacobian(arm, q), ps.tool_motion(arm, q, v, a)
    for k in range(5):
        np.testing.assert_allclose(ps.jacobian(arm, q[k]), many[k], rtol=0, atol=1e-14)
        pose = ps.forward_kinematics(arm, q)[k]
        np.testing.assert_allclose(ps.forward_kinematics(arm, q[k]), pose, rtol=0, atol=1e-14)
        one = ps.tool_motion(arm, q[k], v[k], a[k])
        np.testing.assert_allclose(one.acceleration, motion.acceleration[k], rtol=0, atol=1e-12)


def test_a_joint_on_another_branch_does_not_move_the_tool(tmp_path: Path) -> None:
    robot = load(tmp_path, BRANCHED, tool="e")
    column = robot.joint_index("aside")
    assert not ps.jacobian(robot, np.full(5, 0.4))[:, column].any()
    with_tool_aside = robot.with_tool("side")
    assert ps.jacobian(with_tool_aside, np.full(5, 0.4))[:, column].any()


def test_no_configurations_give_no_poses(puma: ps.Robot) -> None:
    assert ps.forward_kinematics(puma, np.empty((0, 6))).shape == (0, 4, 4)
    assert ps.jacobian(puma, np.empty((0, 6))).shape == (0, 6, 6)


def test_messages(puma: ps.Robot) -> None:
    with pytest.raises(ps.InputError, match=r"unknown frame 'hand'; valid: .*'wrist_center'"):
        ps.forward_kinematics(puma, np.zeros(6), frame="hand")
    with pytest.raises(ps.InputError, match=r"q: shape \(5,\) is not \(6,\): .*joint1, joint2"):
        ps.forward_kinematics(puma, np.zeros(5))
    with pytest.raises(ps.InputError, match=r"q: shape \(2, 2, 6\)"):
        ps.jacobian(puma, np.zeros((2, 2, 6)))
    q = np.zeros((3, 6))
    q[1, 2] = np.nan
    with pytest.raises(ps.InputError, match=r"joint 'joint3': q\[1, 2\] = nan is not a finite number"):
        ps.forward_kinematics(puma, q)
    with pytest.raises(ps.InputError, match=r"shapes \(6,\), \(1, 6\), \(6,\) differ"):
        ps.tool_motion(puma, np.zeros(6), np.zeros((1, 6)), np.zeros(6))
