"""Inverse kinematics of the PUMA: eight branches, their names, limits, singularities and what is out of reach."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from helpers.places import ROOT
from hypothesis import given, settings
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.kinematics import IkBatch, rtb_names
from puma_septic.kinematics._chain import chain_to
from puma_septic.kinematics._puma_branches import CONFIGURATIONS, branch_values, puma_geometry
from puma_septic.paper import PAPER

TURN = 2.0 * np.pi
# T(qn): the eight solutions and whether they are inside MATLAB's joint limits (modulo a turn), by
# roboticstoolbox-python 1.4.4 (Puma560.ikine_a), named as there and as in MATLAB's ikine6s.
T_QN = {
    ("lun", "luf"): ([2.648561, 2.356194, 0.093956, -0.609033, -0.97435, -2.768193], True),
    ("luf", "lun"): ([2.648561, 2.356194, 0.093956, 2.532559, 0.97435, 0.3734], True),
    ("ldn", "ldf"): ([2.648561, -2.30806, -3.141593, -2.467326, -0.86039, -0.480468], False),
    ("ldf", "ldn"): ([2.648561, -2.30806, -3.141593, 0.674266, 0.86039, 2.661125], False),
    ("run", "ruf"): ([0, 0.785398, -3.141593, -3.141593, -0.785398, 3.141593], False),
    ("ruf", "run"): ([0, 0.785398, -3.141593, 0, 0.785398, 0], True),
    ("rdn", "rdf"): ([0, -0.833533, 0.093956, 0, -0.831219, 0], False),
    ("rdf", "rdn"): ([0, -0.833533, 0.093956, 3.141593, 0.831219, -3.141593], False),
}
QN = [0, np.pi / 4, np.pi, 0, np.pi / 4, 0]
STRAIGHT = -np.arctan2(0.4318, 0.0203)  # q3 of the straight elbow
# q3 with which, at q2 = 1, V = a2 c2 + a3 c23 - d4 s23 = 0
OVERHEAD = np.arcsin(0.4318 * np.cos(1.0) / np.hypot(0.4318, 0.0203)) + np.arctan2(0.0203, 0.4318) - 1.0

angles = st.lists(st.floats(-np.pi, np.pi), min_size=6, max_size=6).map(np.array)


@pytest.fixture(scope="module")
def wrist() -> ps.Robot:
    return ps.load_robot(tool="wrist_center")


def wrapped(difference: np.ndarray) -> np.ndarray:
    return (difference + np.pi) % TURN - np.pi


def apart(q: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference modulo a turn."""
    return float(np.abs(wrapped(q - expected)).max())


def test_all_eight_branches_of_the_oracle(wrist: ps.Robot, reference: Path) -> None:
    """200 poses by roboticstoolbox-python 1.4.4; near singular poses its own rounding grows to some 1e-11."""
    with np.load(reference / "puma560_oracle.npz") as file:
        poses, expected, meta = file["fkine"], file["ik"], json.loads(str(file["meta"]))
    found = ps.inverse_kinematics_batch(wrist, poses)
    python_names = [rtb_names(name)[0] for name in found.configurations]
    order = [python_names.index(name) for name in meta["ik_config_order"]]
    assert found.reachable.all()
    assert apart(found.q[:, order], expected) < 1e-10
    reached = ps.forward_kinematics(wrist, found.q.reshape(-1, 6)).reshape(200, 8, 4, 4)
    # 1e-12 is where polishing begins; the residual reported is the one measured from outside.
    off = np.abs(reached - poses[:, None]).max(axis=(2, 3))
    assert off.max() < 1e-12
    np.testing.assert_allclose(found.residual, off, rtol=0, atol=1e-14)


@pytest.mark.parametrize("tool", ["wrist_center", "flange"])
def test_branches_of_t_qn(tool: str) -> None:
    robot = ps.load_robot(tool=tool)
    solutions = ps.inverse_kinematics(robot, ps.forward_kinematics(robot, QN))
    assert {rtb_names(name) for name in solutions.configurations} == set(T_QN)
    for k, name in enumerate(solutions.configurations):
        expected, inside = T_QN[rtb_names(name)]
        assert apart(solutions.q[k], np.array(expected)) < 1e-6  # printed to six decimals
        assert bool(solutions.within_limits[k]) is inside, name


@pytest.mark.parametrize(("point", "expected"), list(zip(PAPER.points, PAPER.table_1, strict=True)))
def test_table_1_of_the_paper(wrist: ps.Robot, point: list[float], expected: list[float]) -> None:
    pose = np.eye(4)
    pose[:3, 3] = point + np.array([0, 0, 0.67183])
    solutions = ps.inverse_kinematics(wrist, pose)
    assert apart(solutions.select("right-down-flip"), np.array(expected)) < 5e-5  # printed to four decimals
    assert not solutions.within_limits[solutions.configurations.index("right-down-flip")]


def test_parameters_are_read_from_the_model() -> None:
    """Armstrong, Khatib and Burdick's arm has d4 = 0.4331."""
    robot = ps.load_robot(parameters="akb", tool="wrist_center")
    geometry = puma_geometry(chain_to(robot))
    assert geometry is not None
    lengths = (geometry.a2, geometry.a3, geometry.d3, geometry.d4)
    np.testing.assert_allclose(lengths, (0.4318, 0.0203, 0.15005, 0.4331), rtol=0, atol=1e-15)
    q = [0.4, 1.1, -2.0, 0.3, 0.8, -1.0]
    solutions = ps.inverse_kinematics(robot, ps.forward_kinematics(robot, q))
    assert solutions.residual.max() < 1e-14
    assert min(apart(row, np.array(q)) for row in solutions.q) < 1e-13


@settings(max_examples=100)
@given(q=angles)
def test_forward_of_inverse_is_identity(puma: ps.Robot, q: np.ndarray) -> None:
    """For any joint angles whatever, singular ones too: all eight branches, and q among them unless singular."""
    pose = ps.forward_kinematics(puma, q)
    solutions = ps.inverse_kinematics(puma, pose, q_near=q)
    assert len(solutions.q) == 8
    # 1e-12 is what the polish promises; the square root at a singular posture makes of it at most REACH_TOLERANCE.
    assert np.abs(ps.forward_kinematics(puma, solutions.q) - pose).max() < 1e-10
    values = np.abs(branch_values(puma_geometry(chain_to(puma)), q))  # type: ignore[arg-type]
    if values.min() > 1e-3:
        assert min(apart(row, q) for row in solutions.q) < 1e-10  # rounding over the distance to singular
        assert solutions.residual.max() < 1e-12


@settings(max_examples=50)
@given(q=angles)
def test_the_names_are_the_geometry(wrist: ps.Robot, q: np.ndarray) -> None:
    """Classified from the angles found, by formulas checked against 1,920 configurations of the toolbox."""
    for name, found in zip(
        CONFIGURATIONS, ps.inverse_kinematics(wrist, ps.forward_kinematics(wrist, q)).q, strict=True
    ):
        front = 0.4318 * np.cos(found[1]) + 0.0203 * np.cos(found[1] + found[2]) - 0.4318 * np.sin(found[1] + found[2])
        bent = np.sin(found[2] + np.arctan2(0.4318, 0.0203))
        if min(abs(front), abs(bent), abs(np.sin(found[4]))) < 1e-6:
            continue  # two names meet
        arm, elbow, wrist_name = name.split("-")
        assert arm == ("right" if front > 0 else "left")
        assert elbow == ("up" if front * bent < 0 else "down")
        assert wrist_name == ("noflip" if np.sin(found[4]) > 0 else "flip")


def test_batch_is_the_single_call_repeated(puma: ps.Robot, rng: np.random.Generator) -> None:
    q = rng.uniform(-np.pi, np.pi, (20, 6))
    poses = ps.forward_kinematics(puma, q)
    batch = ps.inverse_kinematics_batch(puma, poses, q_near=q)
    for k in range(20):
        one = ps.inverse_kinematics(puma, poses[k], q_near=q[k])
        np.testing.assert_allclose(batch.q[k], one.q, rtol=0, atol=1e-12)
        np.testing.assert_array_equal(batch.within_limits[k], one.within_limits)
    assert batch.out_of_reach.max() == 0.0
    times = 60  # 1,200 poses, more than are solved at once
    many = ps.inverse_kinematics_batch(puma, np.tile(poses, (times, 1, 1)), q_near=np.tile(q, (times, 1)))
    np.testing.assert_allclose(many.q, np.tile(batch.q, (times, 1, 1)), rtol=0, atol=1e-12)
    assert many.residual.shape == many.within_limits.shape == (1200, 8)


def test_whole_turns_are_chosen_within_the_limits(puma: ps.Robot) -> None:
    """Joint 3 has -225..45 deg: -200 deg is inside, 160 deg (which the formulas give) is not."""
    q = np.array([0.2, 0.5, np.deg2rad(-200), 0.1, 0.6, 0.3])
    solutions = ps.inverse_kinematics(puma, ps.forward_kinematics(puma, q))
    k = int(np.argmin([apart(row, q) for row in solutions.q]))
    np.testing.assert_allclose(solutions.q[k], q, rtol=0, atol=1e-12)
    assert solutions.within_limits[k]


def test_turns_near_a_given_configuration(puma: ps.Robot) -> None:
    """Joint 6 has +-266 deg, so that both 100 deg and -260 deg are inside."""
    q = np.array([0.2, 0.5, -2.0, 0.1, 0.6, np.deg2rad(100)])
    pose, other = ps.forward_kinematics(puma, q), q - [0, 0, 0, 0, 0, TURN]
    k = CONFIGURATIONS.index("right-up-noflip")
    np.testing.assert_allclose(ps.inverse_kinematics(puma, pose).q[k], q, rtol=0, atol=1e-12)
    np.testing.assert_allclose(ps.inverse_kinematics(puma, pose, q_near=other).q[k], other, rtol=0, atol=1e-12)


def test_the_turn_nearest_to_where_the_joint_stands_is_within_its_limits(puma: ps.Robot) -> None:
    """A joint of several turns once went to the middle of its range where the nearest turn was just beyond a limit."""
    limits = puma.limits.position.copy()
    limits[5] = [-20.0, 20.0]
    robot, k = puma.with_limits(position=limits), CONFIGURATIONS.index("right-up-noflip")
    q = np.array([0.2, 0.5, -2.0, 0.1, 0.6, 1.0])
    pose = ps.forward_kinematics(robot, q)
    for stands, turns in ((19.9, 3), (16.0, 2), (-19.9, -3), (60.0, 3), (-60.0, -3), (0.9, 0), (17.5, 3)):
        near = np.array([*q[:5], stands])
        found = ps.inverse_kinematics(robot, pose, q_near=near)
        assert found.q[k, 5] == pytest.approx(1.0 + turns * TURN, abs=1e-12), stands
        assert found.within_limits[k]


def test_out_of_limits_is_nearest_to_their_middle(puma: ps.Robot) -> None:
    low, high = puma.limits.position.T
    pose = ps.forward_kinematics(puma, QN)
    off_middle = np.abs(ps.inverse_kinematics(puma, pose).q - 0.5 * (low + high))
    assert off_middle.max() <= np.pi + 1e-12


@pytest.mark.parametrize(
    ("q", "singular"),
    [
        ([0.3, 0.4, -1.0, 0.7, 0.0, 0.2], "wrist"),
        ([0.3, 0.4, STRAIGHT, 0.7, 0.5, 0.2], "elbow"),
        ([0.3, 1.0, OVERHEAD, 0.7, 0.5, 0.2], "shoulder"),
    ],
)
def test_singular_poses_are_solved_and_reported(wrist: ps.Robot, q: list[float], singular: str) -> None:
    pose = ps.forward_kinematics(wrist, q)
    solutions = ps.inverse_kinematics(wrist, pose, q_near=q)
    k = int(np.argmin(np.abs(wrapped(solutions.q - q)).max(axis=1)))
    assert singular in solutions.singular[k]
    assert solutions.residual.max() < 1e-12
    # Rounding 1e-16 of the pose is 1e-8 in the angles where two branches meet.
    assert apart(solutions.q[k], np.array(q)) < 1e-7
    assert ps.inverse_kinematics(wrist, ps.forward_kinematics(wrist, [0.3, 1, -1, 0, 1, 0])).singular == ((),) * 8


def test_free_joint_of_the_singular_wrist(wrist: ps.Robot) -> None:
    """With q5 = 0 the pose gives q4 + q6 only: q4 is 0, or that of q_near."""
    pose = ps.forward_kinematics(wrist, [0.3, 0.4, -1.0, 0.7, 0.0, 0.2])
    free = ps.inverse_kinematics(wrist, pose).select("right-down-noflip")
    np.testing.assert_allclose(free[3:], [0.0, 0.0, 0.9], rtol=0, atol=1e-14)
    near = ps.inverse_kinematics(wrist, pose, q_near=[0, 0, 0, -0.5, 0, 0]).select("right-down-noflip")
    np.testing.assert_allclose(near[3:], [-0.5, 0.0, 1.4], rtol=0, atol=1e-14)


@pytest.mark.parametrize("sine", [1e-13, 1e-11, 1e-8, 1e-5, 1e-4, 1e-2])
def test_nearly_singular_wrist_keeps_the_pose(wrist: ps.Robot, sine: float) -> None:
    """Quotients of small numbers give q4 and q6 that do not fit together: 1e-16 / sin(q5) in the pose."""
    pose = ps.forward_kinematics(wrist, [0.3, 0.4, -1.0, 0.7, sine, 0.2])
    assert ps.inverse_kinematics(wrist, pose).residual.max() < 1e-12


def test_fully_stretched_is_still_in_reach(wrist: ps.Robot) -> None:
    """The wrist centre on the very edge, where rounding alone puts it outside."""
    q = np.zeros((50, 6))
    q[:, 0], q[:, 1], q[:, 2] = np.linspace(-2, 2, 50), np.linspace(0, 3, 50), STRAIGHT
    found = ps.inverse_kinematics_batch(wrist, ps.forward_kinematics(wrist, q))
    assert found.reachable.all()
    assert found.residual.max() < 1e-12
    assert found.singular[:, :, 1].all()


def test_too_far(puma: ps.Robot) -> None:
    """Reach from the shoulder: hypot(a2 + hypot(a3, d4), d3) = 0.877009 m."""
    pose = np.eye(4)
    pose[:3, 3] = [1.0, 1.0, 0.67183 + 0.05625]
    with pytest.raises(
        ps.NoSolution,
        match=r"out of reach by 0\.537205 m: its wrist centre is 1\.41421 m from the shoulder, the arm reaches"
        r" 0\.877009 m; the nearest q = .* leaves 0\.537205 m and .* rad",
    ) as caught:
        ps.inverse_kinematics(puma, pose)
    left = ps.forward_kinematics(puma, caught.value.q) - pose
    assert caught.value.residual == pytest.approx(np.sqrt(2) - np.hypot(0.4318 + np.hypot(0.0203, 0.4318), 0.15005))
    assert np.linalg.norm(left[:3, 3]) == pytest.approx(caught.value.residual, abs=1e-12)
    assert np.abs(left[:3, :3]).max() < 1e-12  # a spherical wrist keeps the orientation


def test_too_near_joint_1(puma: ps.Robot) -> None:
    pose = np.eye(4)
    pose[:3, 3] = [0.05, 0.0, 0.67183 + 0.05625 + 0.4]
    with pytest.raises(
        ps.NoSolution, match=r"by 0\.10005 m: its wrist centre is 0\.05 m from joint 1's axis.*0\.15005 m"
    ):
        ps.inverse_kinematics(puma, pose)


def test_the_nearest_point_is_nearest(wrist: ps.Robot, rng: np.random.Generator) -> None:
    """No configuration of 20,000 comes nearer than the one that is called nearest."""
    reached = ps.forward_kinematics(wrist, rng.uniform(-np.pi, np.pi, (20_000, 6)))[:, :3, 3]
    poses = np.tile(np.eye(4), (40, 1, 1))
    poses[:, :3, 3] = [0, 0, 0.67183] + rng.uniform(-1, 1, (40, 3)) * np.repeat([[1.2], [0.14]], 20, axis=0)
    found = ps.inverse_kinematics_batch(wrist, poses)
    gaps = np.linalg.norm(reached[:, None] - poses[:, :3, 3], axis=2).min(axis=0)
    assert not found.reachable.all()
    assert (found.out_of_reach <= gaps).all()
    assert np.isfinite(found.q).all()
    at = ps.forward_kinematics(wrist, found.q[:, 0])[:, :3, 3]
    np.testing.assert_allclose(np.linalg.norm(at - poses[:, :3, 3], axis=1), found.out_of_reach, rtol=0, atol=1e-12)


def test_a_slightly_different_model_is_polished(tmp_path: Path, puma: ps.Robot) -> None:
    """Right angles written with ten digits: still a PUMA, but the closed form is off by some 1e-10."""
    text = (ROOT / "urdf" / "puma560.urdf").read_text()
    assert "1.5707963267948966" in text
    path = tmp_path / "rounded.urdf"
    path.write_text(text.replace("1.5707963267948966", "1.5707963270"))
    robot = ps.load_robot(path, tool="flange")
    q = np.array([[0.4, 1.1, -2.0, 0.3, 0.8, -1.0], [0.0, 0.2, -1.0, -1.3, -0.8, 2.0]])
    found = ps.inverse_kinematics_batch(robot, ps.forward_kinematics(robot, q))
    assert found.residual.max() < 1e-12
    unpolished = ps.inverse_kinematics_batch(puma, ps.forward_kinematics(robot, q)).q[0, 0]
    assert np.abs(ps.forward_kinematics(robot, unpolished) - ps.forward_kinematics(robot, q[0])).max() > 1e-11


def test_joints_listed_in_another_order(tmp_path: Path, puma: ps.Robot) -> None:
    """Joint values stand in the order of the URDF's text, not of the chain."""
    text = (ROOT / "urdf" / "puma560.urdf").read_text()
    start, end = text.index('<joint name="joint2"'), text.index('<joint name="joint3"')
    close = text.index("</robot>")
    path = tmp_path / "reordered.urdf"
    path.write_text(text[:start] + text[end:close] + text[start:end] + text[close:])
    robot = ps.load_robot(path, tool="flange")
    assert robot.joint_names[-1] == "joint2"
    order = [puma.joint_names.index(name) for name in robot.joint_names]
    q = np.array([0.4, 1.1, -2.0, 0.3, 0.8, -1.0])
    pose = ps.forward_kinematics(robot, q[order])
    np.testing.assert_allclose(pose, ps.forward_kinematics(puma, q), rtol=0, atol=1e-15)
    found, expected = ps.inverse_kinematics(robot, pose, q_near=q[order]), ps.inverse_kinematics(puma, pose, q_near=q)
    np.testing.assert_allclose(found.q, expected.q[:, order], rtol=0, atol=1e-12)


def test_arrays_are_read_only_and_shapes_hold_for_no_pose(puma: ps.Robot) -> None:
    batch = ps.inverse_kinematics_batch(puma, np.empty((0, 4, 4)))
    assert isinstance(batch, IkBatch)
    assert batch.q.shape == (0, 8, 6)
    with pytest.raises(ValueError, match="read-only"):
        ps.inverse_kinematics(puma, ps.forward_kinematics(puma, QN)).q[0, 0] = 1.0


def test_bad_poses(puma: ps.Robot) -> None:
    pose = ps.forward_kinematics(puma, QN)
    with pytest.raises(ps.InputError, match=r"T_world_tool: shape \(3, 4\) is not \(4, 4\)"):
        ps.inverse_kinematics(puma, pose[:3])
    with pytest.raises(ps.InputError, match=r"T_world_tool\[1, 3\] = nan is not a finite number"):
        ps.inverse_kinematics(puma, np.where(np.arange(16).reshape(4, 4) == 7, np.nan, pose))
    with pytest.raises(ps.InputError, match=r"R\^T R differs from the identity by 0\.0201 \(at most 1e-09\); R = "):
        ps.inverse_kinematics(puma, pose * [[1.01], [1.01], [1.01], [1]])
    with pytest.raises(ps.InputError, match=r"R is a reflection \(det R = -1\)"):
        ps.inverse_kinematics(puma, pose @ np.diag([1, 1, -1, 1]))
    with pytest.raises(ps.InputError, match=r"last row \[0\.0, 0\.0, 0\.0, 2\.0\] .* must be \[0, 0, 0, 1\]"):
        ps.inverse_kinematics(puma, pose * [[1], [1], [1], [2]])
    poses = np.array([pose, pose @ np.diag([-1, 1, 1, 1])])
    with pytest.raises(ps.InputError, match=r"T_world_tool\[1\]: .*reflection"):
        ps.inverse_kinematics_batch(puma, poses)
    with pytest.raises(ps.InputError, match=r"q_near: 3 rows for 1 poses"):
        ps.inverse_kinematics_batch(puma, pose[None], q_near=np.zeros((3, 6)))


def test_a_pose_with_ten_digits_is_accepted_and_met(puma: ps.Robot) -> None:
    pose = ps.forward_kinematics(puma, [0.4, 1.1, -2.0, 0.3, 0.8, -1.0])
    solutions = ps.inverse_kinematics(puma, np.round(pose, 10))
    assert solutions.residual.max() < 1e-12  # against the nearest rigid transform
    assert np.abs(ps.forward_kinematics(puma, solutions.q) - pose).max() < 2e-10


def test_unknown_branch_lists_the_valid_ones(puma: ps.Robot) -> None:
    solutions = ps.inverse_kinematics(puma, ps.forward_kinematics(puma, QN))
    with pytest.raises(ps.InputError, match=r"unknown configuration 'lefty'; valid: 'right-up-noflip', "):
        solutions.select("lefty")
    with pytest.raises(ps.InputError, match=r"unknown configuration 'ldn'"):
        rtb_names("ldn")
