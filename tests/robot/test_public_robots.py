"""The robots of example-robot-data: each loads for what its file can answer, as docs/robots.md says."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from helpers.places import DOCS, ROBOTS

import puma_septic as ps
from puma_septic.dynamics import rigid_torque
from puma_septic.robot import Mimic, named_robots
from puma_septic.robot._model import Robot
from puma_septic.validation import Array

FILES = sorted(ROBOTS.rglob("*.urdf"))
# Of 69 files these describe nothing that moves, nothing at all, or more joints than an arm has.
REFUSED = {
    "iris_simple.urdf": "no joint moves",
    "quadrotor_base.urdf": "no joint moves",
    "ur3.urdf": "no <link> in this URDF",
    "tiago_dual.urdf": "101 moving joints; at most 64",
}


def plain(path: Path, robot: Robot, q: Array, v: Array, a: Array) -> tuple[Array, Array]:
    """Torque and tool by Pinocchio alone: its model of all joints, followers written out as ``q = A u + b``."""
    model = pin.buildModelFromUrdf(str(path))
    names = list(model.names)[1:]
    A, b = np.zeros((model.nv, robot.n_joints)), np.zeros(model.nv)
    for name in names:
        mimic, row = robot.mimics.get(name, Mimic(master=name)), model.joints[model.getJointId(name)].idx_v
        A[row, robot.joint_index(mimic.master)], b[row] = mimic.multiplier, mimic.offset
    turned = pin.integrate(model, pin.neutral(model), A @ q + b)
    data = model.createData()
    tau = A.T @ pin.rnea(model, data, turned, A @ v, A @ a)
    pin.framesForwardKinematics(model, data, turned)
    return tau, data.oMf[model.getFrameId(robot.tool, pin.FrameType.BODY)].homogeneous


@pytest.mark.slow
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_public_robot_is_answered_as_far_as_its_file_allows(path: Path) -> None:
    """Torque equals plain Pinocchio's, of mimicking joints too, which 8 of these files have; so does the tool."""
    if path.name in REFUSED:
        with pytest.raises(ps.ModelError, match=REFUSED[path.name]):
            ps.load_robot(path)
        return
    robot = ps.load_robot(path)
    assert robot.model.nv == robot.n_joints
    q, v, a = np.random.default_rng(7).uniform(-1, 1, (3, robot.n_joints))
    torque, tool = plain(path, robot, q, v, a)
    known = robot.knows_torque
    own = rigid_torque(robot, q[None], v[None], a[None])[0] - robot.armature * a
    # Roundings of the whole arm's torque, of which a wrist has a small part.
    assert own[known] == pytest.approx(torque[known], rel=1e-12, abs=1e-12 * np.abs(torque).max())
    assert ps.forward_kinematics(robot, q) == pytest.approx(tool, abs=1e-14)
    move = ps.profiles.quintic([np.zeros(robot.n_joints), np.full(robot.n_joints, 0.1)], [0.0, 1.0])
    checks = ps.assess(robot, move).checks
    assert all(known[robot.joint_index(check.joint)] for check in checks if check.quantity == "effort")


def test_an_arm_of_too_many_joints_is_one_with_the_others_locked() -> None:
    robot = ps.load_robot("tiago_dual", locked="others")
    assert robot.n_joints == 8


def test_the_page_of_robots_is_what_they_are() -> None:
    """The table is generated: python docs/make_robots.py. Every fifth row is made again here."""
    script = runpy.run_path(str(DOCS / "make_robots.py"))
    text = (DOCS / "robots.md").read_text(encoding="utf-8")
    names = list(named_robots())
    assert all(f"\n| {name} | " in text for name in names)
    assert all(script["row"](name) in text for name in names[::5])


def test_robots_have_names() -> None:
    names = named_robots()
    assert len(names) == len(FILES)  # ur3.urdf, which is empty, has none; the PUMA has
    assert {"puma560", "ur5", "ur3", "panda", "anymal_b", "anymal_c", "so101"} <= set(names)
    assert names["ur3"].name == "ur3_robot.urdf"
    assert ps.load_robot("ur5").joint_names == ps.load_robot(names["ur5"]).joint_names


def test_a_file_in_the_current_folder_needs_no_slash(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """SolidWorks writes capitals; `./arm.URDF` was needed."""
    text = names["ur5"].read_text() if (names := named_robots()) else ""
    monkeypatch.chdir(tmp_path)
    for name in ("arm.URDF", "arm.xml", "arm"):
        (tmp_path / name).write_text(text)
        assert ps.load_robot(name).n_joints == 6
