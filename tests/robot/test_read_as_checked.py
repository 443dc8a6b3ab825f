"""What is checked of a URDF is what Pinocchio computes with, to the last bit, and it is looked at once more."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from helpers.arms import joint, link
from helpers.arms import load as load_arm
from helpers.urdf_texts import INERTIA, INERTIAL, load, replaced

import puma_septic as ps
from puma_septic.dynamics import mass_matrix
from puma_septic.robot import _loading

NUMBERS = {
    "inertia": (INERTIA, INERTIA.replace('izz="0.05"', 'izz="{}"'), "0.05"),
    "first of the inertia": (INERTIA, INERTIA.replace('ixx="0.1"', 'ixx="{}"'), "0.1"),
    "mass": ('<mass value="3"/>', '<mass value="{}"/>', "3"),
    "centre": ('<origin xyz="0 0 0.2"/>', '<origin xyz="0 0 {}"/>', "0.2"),
    "place": ('<origin xyz="0 0 0.4"/>', '<origin xyz="0 0 {}"/>', "0.4"),
    "axis": ('<axis xyz="0 1 0"/>', '<axis xyz="0 1 {}"/>', "0"),
}
BLANKS = [" ", "\t", "\n", "\u00a0", "\u2003", "  \t"]


def torque(robot: ps.Robot) -> list[float]:
    return ps.inverse_dynamics(robot, [0.3, -0.4], [1.0, 2.0], [3.0, -4.0]).tolist()


@pytest.mark.parametrize("blank", BLANKS, ids=[repr(blank) for blank in BLANKS])
@pytest.mark.parametrize("where", NUMBERS)
def test_blanks_around_a_number_change_nothing(where: str, blank: str, tmp_path: Path) -> None:
    """izz="0.05 " made Pinocchio's reader drop the whole tensor without a word: a torque of -1.86 for -1.56 N m."""
    old, new, number = NUMBERS[where]
    expected = torque(load(tmp_path))
    assert torque(load(tmp_path, replaced(old, new.format(number + blank)))) == expected
    assert torque(load(tmp_path, replaced(old, new.format(blank + number + blank)))) == expected


def test_digits_reach_pinocchio_as_they_are_read(tmp_path: Path) -> None:
    """1/3 in 17 digits, with a sign and in powers of ten; each is one double."""
    for text in ("0.33333333333333331", "+0.33333333333333331", "3.3333333333333331e-1", "33.333333333333331E-2"):
        robot = load(tmp_path, replaced('<mass value="3"/>', f'<mass value="{text}"/>'))
        assert robot.bare_model.inertias[1].mass == float("0.33333333333333331")


def test_a_material_of_the_robot_with_a_wrong_colour_is_left_out(tmp_path: Path) -> None:
    """Shapes whose material is named are drawn all the same."""
    colour = '<material name="orange"><color rgba="1.0 --1 0.04 1.0"/></material>'
    robot = load(tmp_path, replaced('<link name="base"/>', f'{colour}<link name="base"/>'))
    assert any("rgba='1.0 --1 0.04 1.0'" in note and "material is left out" in note for note in robot.notes)
    assert torque(robot) == torque(load(tmp_path))


LIES: dict[str, tuple[Callable[[pin.Model], None], str]] = {
    "mass": (lambda model: setattr(model.inertias[1], "mass", 2.0), "a mass .* 2 instead of 3 "),
    "centre": (
        lambda model: setattr(model.inertias[2], "lever", np.array([0.0, 0.1, 0.2])),
        "of the body of joint 'elbow' Pinocchio reads a centre of mass .* 0.3 instead of 0 ",
    ),
    "inertia": (
        lambda model: setattr(model.inertias[1], "inertia", np.zeros((3, 3))),
        "of the body of joint 'shoulder' Pinocchio reads an inertia .* 0.12 instead of 0.22 ",
    ),
    "joints": (
        lambda model: model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "third"),
        r"Pinocchio reads the joints \['shoulder', 'elbow', 'third'\], the text has \['shoulder', 'elbow'\]",
    ),
    "base": (lambda model: setattr(model.inertias[0], "mass", 1.0), "of the body of the base .* 1 instead of 0 "),
}


@pytest.mark.parametrize("lie", LIES)
def test_what_pinocchio_reads_otherwise_is_refused(lie: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Masses alone were compared, and their sum alone: an inertia that was lost went through."""
    real = pin.buildModelFromXML

    def lying(*arguments: object, **options: object) -> pin.Model:
        model = real(*arguments, **options)
        LIES[lie][0](model)
        return model

    monkeypatch.setattr(_loading.pin, "buildModelFromXML", lying)
    with pytest.raises(ps.ModelError, match=LIES[lie][1]):
        load(tmp_path)


def test_what_pinocchio_refuses_or_does_not_know_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refusing(*_arguments: object, **_options: object) -> pin.Model:
        raise ValueError("The error message\n")

    monkeypatch.setattr(_loading.pin, "buildModelFromXML", refusing)
    with pytest.raises(ps.ModelError, match=r"arm\.urdf: Pinocchio refuses this URDF: The error message$"):
        load(tmp_path)
    monkeypatch.delattr(_loading.pin, "buildModelFromXML")
    with pytest.raises(ps.ModelError, match=r"is another package called pinocchio; .* --force-reinstall pin$"):
        load(tmp_path)


def test_bodies_that_are_fixed_to_others_are_compared_where_they_are(tmp_path: Path) -> None:
    """A chain of turned and shifted links, some of them locked: each body's moments are those of its links."""
    text = replaced('<link name="tip"/>', f'<link name="tip">{INERTIAL}</link>')
    text = replaced('<origin xyz="0 0 0.3"/>', '<origin xyz="0.1 0.2 0.3" rpy="0.4 -0.5 0.6"/>', text)
    text = replaced('<origin xyz="0 0 0.2"/>', '<origin xyz="0.01 0 0.2" rpy="1 2 3"/>', text, count=-1)
    locked = load(tmp_path, text, locked={"elbow": 0.7})
    free = load(tmp_path, text)
    q, v, a = [0.3, 0.7], [1.0, 0.0], [2.0, 0.0]
    expected = ps.inverse_dynamics(free, q, v, a)[0]
    assert ps.inverse_dynamics(locked, q[:1], v[:1], a[:1])[0] == pytest.approx(expected, rel=1e-12)


def test_a_locked_slide_is_shifted_along_its_own_axis(tmp_path: Path) -> None:
    """The axis is that of the joint's frame, which the origin's angles turn."""
    text = replaced('name="elbow" type="revolute"', 'name="elbow" type="prismatic"')
    text = replaced('<origin xyz="0 0 0.4"/>', '<origin xyz="0 0 0.4" rpy="0.5 0.3 -0.7"/>', text)
    text = replaced('<axis xyz="0 1 0"/>', '<axis xyz="0.6 0 0.8"/>', text, count=2)
    free, locked = load(tmp_path, text), load(tmp_path, text, locked={"elbow": 0.9})
    expected = ps.forward_kinematics(free, [0.3, 0.9], frame="tip")
    np.testing.assert_allclose(ps.forward_kinematics(locked, [0.3], frame="tip"), expected, atol=1e-14)


@pytest.mark.parametrize(("moment", "usable"), [(-4e-5, True), (-1e-3, False), (-4e-3, False)])
def test_a_negative_moment_is_one_of_printed_digits_or_none(moment: float, usable: bool, tmp_path: Path) -> None:
    """Up to a thousandth of the largest, 0.1 kg m^2: a body of which a part of 1 % is negative is none."""
    robot = load(tmp_path, replaced('izz="0.05"', f'izz="{moment}"', count=1))
    assert ("upper" not in robot.unusable_inertia) is usable


# ---- where Pinocchio's own composite-rigid-body algorithm errs


def branching(*, mimicking: bool) -> str:
    """A joint b that mimics its parent a, and two branches that both hang on b."""
    body = np.diag([0.02, 0.02, 0.01])
    tag = '<mimic joint="a" multiplier="0.5" offset="0.2"/></joint>' if mimicking else "</joint>"
    return (
        "".join(link(name, 2.0, [0.0, 0.05, 0.15], body) for name in ("base", "l1", "l2", "l3", "l4"))
        + joint("a", "revolute", "base", "l1", [0, 0, 0.3], [0, 1, 0])
        + joint("b", "revolute", "l1", "l2", [0, 0, 0.3], [0, 1, 0]).replace("</joint>", tag)
        + joint("c", "revolute", "l2", "l3", [0, 0, 0.3], [1, 0, 0])
        + joint("d", "revolute", "l2", "l4", [0.1, 0, 0.3], [0, 0, 1])
    )


def test_the_inertia_of_branches_behind_a_mimicking_joint(tmp_path: Path) -> None:
    """By `crba` of pin 4.1.0 the coupling of the second branch was off by two thirds; the full model says otherwise."""
    robot = load_arm(tmp_path, "arm", branching(mimicking=True))
    full = load_arm(tmp_path, "full", branching(mimicking=False))
    assert robot.missing_inertia == ()
    rng = np.random.default_rng(560)
    q = rng.uniform(-1.5, 1.5, (20, 3))
    coupled = np.array([[1.0, 0, 0], [0.5, 0, 0], [0, 1.0, 0], [0, 0, 1.0]])  # a, b, c, d by a, c, d
    expected = coupled.T @ mass_matrix(full, q @ coupled.T + [0, 0.2, 0, 0]) @ coupled
    np.testing.assert_allclose(mass_matrix(robot, q), expected, rtol=1e-12, atol=1e-13)


def test_forward_dynamics_behind_a_mimicking_joint_undoes_inverse_dynamics(tmp_path: Path) -> None:
    robot = load_arm(tmp_path, "arm", branching(mimicking=True))
    q, v, a = [0.3, -0.5, 0.8], [1.0, 2.0, -1.0], [0.5, -2.0, 3.0]
    tau = ps.inverse_dynamics(robot, q, v, a, friction=False)
    np.testing.assert_allclose(ps.forward_dynamics(robot, q, v, tau, friction=False), a, rtol=1e-10)
