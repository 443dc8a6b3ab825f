"""load_robot and Robot: any arm, its tool, its locked joints, its load, and that nothing changes it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from helpers.arms import pendulum
from helpers.places import KINOVA, PANDA, UR5
from helpers.urdf_texts import ARM, load, replaced

import puma_septic as ps
from puma_septic.quantities import MAGNITUDES

FINGERS = {"panda_finger_joint1": 0.04, "panda_finger_joint2": 0.04}
REST = [0.0, 0.0]


def test_ur5() -> None:
    robot = ps.load_robot(UR5)
    assert robot.n_joints == 6
    assert robot.joint_names[:3] == ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint")
    assert robot.limits.effort.tolist() == [150.0, 150.0, 150.0, 28.0, 28.0, 28.0]  # as its URDF has them
    assert robot.missing_meshes == ()
    assert any("tool frame 'tool0': named like one" in n for n in robot.notes)
    assert robot.visual_model.ngeoms == 7


def test_panda_with_locked_fingers_is_pinocchios_reduced_model() -> None:
    robot = ps.load_robot(PANDA, locked=FINGERS, tool="panda_hand_tcp")
    full = pin.buildModelFromUrdf(str(PANDA))
    q_full = pin.neutral(full)
    q_full[-2:] = 0.04
    reduced = pin.buildReducedModel(full, [full.getJointId(name) for name in FINGERS], q_full)
    rng = np.random.default_rng(7)
    for _ in range(5):
        q, v, a = rng.uniform(-1, 1, (3, 7))
        expected = pin.rnea(reduced, reduced.createData(), q, v, a)
        # the same bodies, added up in another order
        assert ps.inverse_dynamics(robot, q, v, a, friction=False) == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert robot.joint_names == tuple(f"panda_joint{i}" for i in range(1, 8))


def test_kinova_has_continuous_joints() -> None:
    robot = ps.load_robot(KINOVA)
    assert (robot.model.nq, robot.model.nv, robot.n_joints) == (9, 6, 6)
    assert np.isnan(robot.limits.position).any(axis=1).tolist() == [True, False, False, True, False, True]
    q = np.array([3.0, 2.0, 3.0, -3.0, 2.5, 6.0])
    turned = q + 2 * np.pi * np.array([1, 0, 0, -1, 0, 2])
    assert ps.forward_kinematics(robot, turned) == pytest.approx(ps.forward_kinematics(robot, q), abs=1e-14)


@pytest.mark.parametrize("origin", ['xyz="0 0 0.5" rpy="1 2 3"', 'rpy="1 2 3"', 'xyz="0 0 0.5"', ""])
def test_locked_revolute_joint_keeps_its_angle_and_its_inertia(tmp_path: Path, origin: str) -> None:
    text = replaced('<axis xyz="0 1 0"/>', '<axis xyz="0 3 4"/>', replaced('xyz="0 0 0.5"', origin))
    free, locked = load(tmp_path, text), load(tmp_path, text, locked={"shoulder": 0.7})
    assert locked.joint_names == ("elbow",)
    assert (free.fixed_joint_names, locked.fixed_joint_names) == (("mount",), ("shoulder", "mount"))
    assert ps.forward_kinematics(locked, [0.4]) == pytest.approx(ps.forward_kinematics(free, [0.7, 0.4]), abs=1e-15)
    expected = ps.inverse_dynamics(free, [0.7, 0.4], [0.0, 2.0], [0.0, 3.0])[1]
    assert ps.inverse_dynamics(locked, [0.4], [2.0], [3.0])[0] == pytest.approx(expected, rel=1e-13)


def test_locked_prismatic_joint_keeps_its_place(tmp_path: Path) -> None:
    text = replaced('"elbow" type="revolute"', '"elbow" type="prismatic"')
    free, locked = load(tmp_path, text), load(tmp_path, text, locked={"elbow": 0.15})
    expected = ps.forward_kinematics(free, [0.6, 0.15])
    assert ps.forward_kinematics(locked, [0.6]) == pytest.approx(expected, abs=1e-14)  # rounding


def test_what_cannot_be_locked(tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match="unknown joint to lock 'mount'; valid: 'shoulder', 'elbow'"):
        load(tmp_path, locked={"mount": 0.0})
    with pytest.raises(ps.InputError, match=r"locked\['elbow'\] = 3 is outside the joint's limits \[-2.5, 2.5\]"):
        load(tmp_path, locked={"elbow": 3.0})
    with pytest.raises(ps.InputError, match=r"locked\['elbow'\] = nan is not a finite number"):
        load(tmp_path, locked={"elbow": float("nan")})
    with pytest.raises(ps.ModelError, match="no joint moves"):
        load(tmp_path, locked={"elbow": 0.0, "shoulder": 0.0})


def test_arm_on_the_ceiling_carries_the_opposite_gravity_torque(puma: ps.Robot) -> None:
    q = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    ceiling = ps.load_robot(gravity=(0.0, 0.0, 9.81))
    up = ps.torque_terms(ceiling, q, np.zeros(6), np.zeros(6)).gravity
    assert up == pytest.approx(-ps.torque_terms(puma, q, np.zeros(6), np.zeros(6)).gravity, rel=1e-14)
    assert np.abs(up).max() > 10.0


def test_gravity_and_tool_are_checked(tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match=r"gravity: shape \(2,\) is not \(3,\)"):
        load(tmp_path, gravity=(0.0, 9.81))
    with pytest.raises(ps.InputError, match=r"unknown tool frame 'hand'; valid: 'base', 'upper', 'fore', 'tip'"):
        load(tmp_path, tool="hand")
    with pytest.raises(ps.InputError, match="unknown tool frame 'hand'"):
        load(tmp_path).with_tool("hand")


def test_a_name_shared_by_link_and_joint_means_the_link(tmp_path: Path) -> None:
    """Pinocchio's getFrameId raises for such a name."""
    text = ARM.replace('"tip"', '"shoulder"')
    robot = load(tmp_path, text, tool="shoulder")
    assert ps.forward_kinematics(robot, REST)[2, 3] == pytest.approx(1.2, rel=1e-15)  # 0.5 + 0.4 + 0.3


def test_payload_adds_its_weight_times_its_lever(tmp_path: Path) -> None:
    """At shoulder 90 degrees the arm is level: the point mass is 0.4 + 0.3 + 0.1 m from the shoulder."""
    robot = load(tmp_path)
    loaded = robot.with_payload(ps.Payload(mass=2.0, com=(0.0, 0.0, 0.1)))
    level = [np.pi / 2, 0.0]
    added = ps.inverse_dynamics(loaded, level, REST, REST) - ps.inverse_dynamics(robot, level, REST, REST)
    assert added == pytest.approx([-2.0 * 9.81 * 0.8, -2.0 * 9.81 * 0.4], rel=1e-13)
    assert ps.inverse_dynamics(loaded.with_payload(None), level, REST, REST).tolist() == (
        ps.inverse_dynamics(robot, level, REST, REST).tolist()
    )


def test_with_limits_replaces_the_named_ones(tmp_path: Path) -> None:
    robot = load(tmp_path)
    changed = robot.with_limits(jerk=100.0, effort=[1.0, float("nan")])
    assert changed.limits.jerk.tolist() == [100.0, 100.0]
    np.testing.assert_array_equal(changed.limits.effort, [1.0, float("nan")])
    assert changed.limits.velocity.tolist() == [3.0, 4.0]
    assert robot.limits.effort.tolist() == [50.0, 20.0]
    with pytest.raises(ps.InputError, match=r"velocity: shape \(3,\) is not \(2,\)"):
        robot.with_limits(velocity=[1.0, 2.0, 3.0])
    with pytest.raises(ps.InputError, match=r"jerk limit\[0\] = -1 must be greater than 0 \(NaN where unknown\)"):
        robot.with_limits(jerk=-1.0)
    with pytest.raises(ps.InputError, match=r"effort limit\[1\] = 0 must be greater than 0"):
        robot.with_limits(effort=[1.0, 0.0])


def test_nothing_is_written_to_the_model_of_another_robot(tmp_path: Path) -> None:
    robot = load(tmp_path)
    before = robot.model.copy(), robot.bare_model.copy()
    drive = ps.Actuator(gear_ratio=100.0, rotor_inertia=1e-4)
    changed = robot.with_payload(ps.Payload(mass=2.0)).with_actuators((drive, drive)).with_tool("fore")
    assert changed.model != robot.model
    assert changed.model.armature.tolist() == [1.0, 1.0]
    assert (robot.model, robot.bare_model) == before


def test_two_loads_are_the_same_robot(tmp_path: Path) -> None:
    one, two = load(tmp_path), load(tmp_path)
    assert one.model == two.model
    assert one.notes == two.notes


def test_notes_of_the_puma_name_its_unphysical_tensors(puma: ps.Robot) -> None:
    """As Corke's Robotics Toolbox has them, after Armstrong, Khatib, Burdick 1986.

    Link 1 is unmeasured but for Izz, link 3 has A + B < C.
    """
    assert "link 'link1': mass 0 with an inertia, used as it is" in puma.notes
    assert any(note.startswith("link 'link3': principal moments 0.0125 + 0.066 < 0.086") for note in puma.notes)
    assert puma.missing_inertia == ()


def test_only_values_of_our_own_kinds_are_taken() -> None:
    """A list in place of a Wrench was once taken, and failed only when a torque was asked for."""
    robot = ps.load_robot()
    with pytest.raises(ps.InputError, match=r"payload: expected Payload\(...\), got 2.5"):
        robot.with_payload(2.5)  # type: ignore[arg-type]
    with pytest.raises(ps.InputError, match=r"wrench: expected Wrench\(...\), got \[1, 2, 3\]"):
        robot.with_wrench([1, 2, 3])  # type: ignore[arg-type]
    with pytest.raises(ps.InputError, match=r"limits: expected Limits\(...\), got 5"):
        robot.with_limits(5)  # type: ignore[arg-type]
    with pytest.raises(ps.InputError, match=r"actuators: expected Actuator\(...\), got 1"):
        robot.with_actuators((1,) * 6)  # type: ignore[arg-type]
    for wrong in ("fast", True):
        with pytest.raises(ps.InputError, match="velocity: expected numbers"):
            robot.with_limits(velocity=wrong)  # type: ignore[arg-type]


def test_what_a_robot_knows_of_its_joints_cannot_be_written_to(tmp_path: Path) -> None:
    robot = load(tmp_path)
    for array in (robot.is_continuous, robot.is_prismatic, robot.limits.velocity, robot.limits.position):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = True


def test_what_is_given_by_joint_is_given_for_each(tmp_path: Path) -> None:
    robot, drive = load(tmp_path), ps.Actuator(gear_ratio=50.0)
    for n in (1, 3):
        with pytest.raises(ps.InputError, match=f"actuators: {n} given for 2 joints"):
            robot.with_actuators((drive,) * n)
        limits = ps.Limits(position=np.full((n, 2), np.nan), **dict.fromkeys(MAGNITUDES, np.full(n, 1.0)))
        with pytest.raises(ps.InputError, match=f"limits: given for {n} joints, the arm has 2"):
            robot.with_limits(limits)


@pytest.mark.parametrize(
    ("moments", "is_a_body"),
    [
        ([1.0, 1.0, 2.0], True),  # a thin plate: the largest is the sum of the other two
        ([1.0, 1.0, 2.0 + 1e-9], False),
        ([0.0, 1.0, 1.0], True),  # a thin rod
        ([-1e-9, 1.0, 1.0], False),
        ([0.0, 0.0, 0.0], True),
        ([0.0, 0.0, 1e-9], False),
    ],
)
def test_a_payload_s_inertia_is_that_of_a_body(moments: list[float], is_a_body: bool) -> None:
    """Principal moments are integrals of sums of squares: none is negative, none above the sum of the other two."""
    if is_a_body:
        assert ps.Payload(mass=1.0, inertia=np.diag(moments)).inertia.diagonal().tolist() == moments
    else:
        with pytest.raises(ps.InputError, match=r"inertia: principal moments .* are not those of a body"):
            ps.Payload(mass=1.0, inertia=np.diag(moments))


def test_a_payload_s_inertia_is_symmetric() -> None:
    skew = np.eye(3)
    skew[0, 1] = 1e-9
    with pytest.raises(ps.InputError, match="inertia: a payload's inertia matrix must be symmetric"):
        ps.Payload(mass=1.0, inertia=skew)


def test_parts_of_a_robot_are_one_line_each(tmp_path: Path) -> None:
    assert repr(ps.Payload(2.5)).startswith("<Payload: mass 2.5 kg, com [0, 0, 0] m, inertia [[0, 0, 0], ")
    wrench = ps.Wrench(force=[1, 2, 3], axes="world")
    assert repr(wrench) == "<Wrench: force [1, 2, 3] N, torque [0, 0, 0] N m, axes world>"
    assert repr(ps.Actuator(gear_ratio=50.0, source="sheet")) == "<Actuator: gear ratio 50, source sheet>"
    assert repr(load(tmp_path).limits).startswith(
        "<Limits: position [[-2, 2], [-2.5, 2.5]] rad, velocity [3, 4] rad/s, "
    )
    assert "<td>2.5 kg</td>" in ps.Payload(2.5)._repr_html_()


def test_a_robot_of_one_joint_has_a_document(tmp_path: Path) -> None:
    """Its Jacobian comes as a vector, on which the document once failed."""
    document = pendulum(tmp_path).to_dict()
    (joint,) = document["joints"]
    assert len(document["frames"]) == 2  # links; the frame of the joint is none
    assert joint["axis"] == [0.0, 1.0, 0.0]
    assert joint["origin"] == [0.0, 0.0, 1.0]
