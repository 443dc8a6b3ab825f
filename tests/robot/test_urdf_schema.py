"""The form of a URDF: which numbers each attribute has, what must be there, what may be there once, and how much."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from helpers.urdf_texts import INERTIA, INERTIAL, load, replaced, told

LIMIT = '<limit lower="-2" upper="2" effort="50" velocity="3"/>'
TIP, AXIS = '<link name="tip"/>', '<axis xyz="0 1 0"/>'
BALL = '<geometry><sphere radius="1"/></geometry>'


def in_tip(markup: str) -> str:
    """The arm with more in its last link."""
    return replaced(TIP, f'<link name="tip">{markup}</link>')


def in_shoulder(markup: str) -> str:
    """The arm with more in its first joint."""
    return replaced(AXIS, AXIS + markup)


def shape(markup: str) -> str:
    return in_tip(f"<visual><geometry>{markup}</geometry></visual>")


def tensor(markup: str) -> str:
    return in_tip(f'<inertial><mass value="1"/>{INERTIA.replace("/>", f" {markup}/>")}</inertial>')


def entry(name: str) -> Callable[[str], str]:
    """The arm whose tensor has one entry in another way."""
    return lambda markup: replaced(f'{name}="0{".1" if name == "ixx" else ""}"', markup)


# By attribute: how many numbers (ros.org/wiki/urdf/XML and ros/urdfdom #212, #235, #238; others as public robots have
# them), and the arm that has it.
NUMBERS: list[tuple[str, int, Callable[[str], str]]] = [
    ("size", 3, lambda given: shape(f"<box {given}/>")),
    ("radius", 1, lambda given: shape(f"<sphere {given}/>")),
    ("radius", 1, lambda given: shape(f'<cylinder length="1" {given}/>')),
    ("length", 1, lambda given: shape(f'<cylinder radius="1" {given}/>')),
    ("radius", 1, lambda given: shape(f'<capsule length="1" {given}/>')),
    ("length", 1, lambda given: shape(f'<capsule radius="1" {given}/>')),
    ("scale", 3, lambda given: shape(f'<mesh filename="a.stl" {given}/>')),
    ("rgba", 4, lambda given: in_tip(f'<visual>{BALL}<material name="m"><color {given}/></material></visual>')),
    *((name, n, lambda given: in_tip(f"<visual><origin {given}/>{BALL}</visual>"))
      for name, n in {"xyz": 3, "rpy": 3, "quat_xyzw": 4}.items()),
    *((name, 3, lambda given: in_tip(f'<inertial><origin {given}/><mass value="1"/>{INERTIA}</inertial>'))
      for name in ("xyz", "rpy")),
    ("value", 1, lambda given: in_tip(f"<inertial><mass {given}/>{INERTIA}</inertial>")),
    ("ixx", 1, entry("ixx")), ("ixy", 1, entry("ixy")), ("ixz", 1, entry("ixz")), ("iyz", 1, entry("iyz")),
    *((name, 1, tensor) for name in ("iyx", "izx", "izy")),
    ("xyz", 3, lambda given: replaced(AXIS, f"<axis {given}/>")),
    ("rpy", 3, lambda given: replaced(AXIS, f'<axis xyz="0 1 0" {given}/>')),
    *((name, 1, lambda given: replaced(LIMIT, f"<limit {given}/>"))
      for name in ("lower", "upper", "effort", "velocity")),
    *((name, 1, lambda given: replaced(LIMIT, LIMIT.replace("/>", f" {given}/>")))
      for name in ("acceleration", "deceleration", "jerk", "command_effort", "current", "gear_velocity")),
    *((name, 1, lambda given: in_shoulder(f"<dynamics {given}/>"))
      for name in ("damping", "friction", "rotor_inertia", "armature", "D", "K", "mu_coulomb", "mu_viscous")),
    *((name, 1, lambda given: in_shoulder(f"<safety_controller {given}/>"))
      for name in ("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity")),
    *((name, 1, lambda given: in_shoulder(f"<calibration {given}/>"))
      for name in ("rising", "falling", "reference_position")),
    *((name, 1, lambda given: in_shoulder(f'<mimic joint="elbow" {given}/>')) for name in ("multiplier", "offset")),
]  # fmt: skip


@pytest.mark.parametrize(("name", "count", "arm"), NUMBERS)
def test_each_value_has_its_count_of_numbers(tmp_path: Path, name: str, count: int, arm: Callable[[str], str]) -> None:
    """One number too many, and one too few, is told, whatever depends on it; the right count is not."""
    expected = "expected one number" if count == 1 else f"expected {count} numbers with spaces between"
    for n in (count - 1, count, count + 1):
        value = " ".join(["1"] * n)
        assert (f"{name}={value!r}: {expected}" in told(tmp_path, arm(f'{name}="{value}"'))) == (n != count)


MAY_BE_ONCE = [
    ('<mass value="3"/>', "mass"), (INERTIA, "inertia"), ('<origin xyz="0 0 0.2"/>', "origin"),
    (INERTIAL, "inertial"), (AXIS, "axis"), ('<parent link="base"/>', "parent"),
    ('<child link="upper"/>', "child"), ('<origin xyz="0 0 0.5"/>', "origin"), (LIMIT, "limit"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "element"), MAY_BE_ONCE)
def test_what_may_be_there_once_is_not_there_twice(tmp_path: Path, old: str, element: str) -> None:
    assert f"has <{element}> twice" in told(tmp_path, replaced(old, old + old))


@pytest.mark.parametrize(
    ("markup", "element"),
    [
        ('<dynamics damping="1"/>', "dynamics"), ('<mimic joint="elbow"/>', "mimic"),
        ('<safety_controller k_velocity="1"/>', "safety_controller"), ('<calibration rising="1"/>', "calibration"),
    ],
)  # fmt: skip
def test_a_joint_has_one_of_each(tmp_path: Path, markup: str, element: str) -> None:
    assert f"<joint> has <{element}> twice" not in told(tmp_path, in_shoulder(markup))
    assert f"<joint> has <{element}> twice" in told(tmp_path, in_shoulder(markup + markup))


@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_a_link_has_any_number_of_shapes_of_one_geometry_each(tmp_path: Path, kind: str) -> None:
    one, other = f"<{kind}>{BALL}</{kind}>", f"<{kind}>{BALL}{BALL}</{kind}>"
    assert "twice" not in told(tmp_path, in_tip(3 * one))
    assert f"<{kind}> has <geometry> twice" in told(tmp_path, in_tip(other))
    assert f"<{kind}> has <origin> twice" in told(tmp_path, in_tip(f"<{kind}>{'<origin/>' * 2}{BALL}</{kind}>"))


@pytest.mark.parametrize("name", ["color", "texture"])
def test_a_material_has_one_of_each(tmp_path: Path, name: str) -> None:
    value = {"color": '<color rgba="1 1 1 1"/>', "texture": '<texture filename="a.png"/>'}[name]
    for n in (1, 2):
        text = in_tip(f'<visual>{BALL}<material name="m">{value * n}</material></visual>')
        assert (f"<material> has <{name}> twice" in told(tmp_path, text)) == (n == 2)


@pytest.mark.parametrize(
    ("arm", "message"),
    [
        (in_tip("<visual/>"), "<geometry> is missing; this shape is left out"),
        (in_tip("<collision/>"), "<geometry> is missing; this shape is left out"),
        (in_tip("<inertial/>"), "<mass> is missing; this inertia is not used"),
        (in_tip('<inertial><mass value="1"/></inertial>'), "<inertia> is missing; this inertia is not used"),
        (replaced('<parent link="base"/>', ""), "<parent> is missing"),
        (replaced('<child link="upper"/>', ""), "<child> is missing"),
        (replaced(' type="fixed"', ""), "attribute 'type' is missing"),
        (replaced(' link="base"', ""), "attribute 'link' is missing"),
        (replaced(' link="upper"', ""), "attribute 'link' is missing"),
        (replaced(AXIS, "<axis/>"), "attribute 'xyz' is missing"),
        (replaced('<mass value="3"/>', "<mass/>"), "attribute 'value' is missing; this inertia is not used"),
        *((replaced(f'{name}="0', f'data-{k}="0'), f"attribute {name!r} is missing; this inertia is not used")
          for k, name in enumerate(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))),
        (in_shoulder("<mimic/>"), "attribute 'joint' is missing"),
        (shape("<box/>"), "attribute 'size' is missing; this shape is left out"),
        (shape("<sphere/>"), "attribute 'radius' is missing; this shape is left out"),
        (shape('<cylinder length="1"/>'), "attribute 'radius' is missing; this shape is left out"),
        (shape('<cylinder radius="1"/>'), "attribute 'length' is missing; this shape is left out"),
        (shape("<mesh/>"), "attribute 'filename' is missing; this shape is left out"),
        (in_tip(f"<visual>{BALL}<material/></visual>"), "attribute 'name' is missing; this shape is left out"),
        (in_tip(f'<visual>{BALL}<material name="m"><color/></material></visual>'),
         "attribute 'rgba' is missing; this shape is left out"),
        (shape("<plane/>"), "expected exactly one of <box>, <cylinder>, <sphere>, <mesh>; this shape is left out"),
        (shape('<sphere radius="1"/><box size="1 1 1"/>'), "expected exactly one of <box>"),
        (shape('<capsule radius="1" length="2"/>'), "a <capsule> cannot be drawn; this shape is left out"),
    ],
)  # fmt: skip
def test_what_must_be_there_is_told_with_what_it_costs(tmp_path: Path, arm: str, message: str) -> None:
    assert message in told(tmp_path, arm)


@pytest.mark.parametrize(
    ("arm", "allowed", "refused", "message"),
    [
        (lambda n: replaced('"elbow"', f'"{"e" * n}"'), 200, 201, "name must have at most 200 printable characters"),
        (lambda x: replaced('xyz="0 0 0.5"', f'xyz="0 0 {x}"'), 1000, 1000.1, "farther than 1000 m"),
        (lambda x: replaced('xyz="0 0 0.5"', f'xyz="0 {x} 0"'), -1000, -1000.1, "farther than 1000 m"),
        (lambda x: replaced('<mass value="3"/>', f'<mass value="{x}"/>'), 1e6, 1.001e6, "more than 1e+06 kg"),
        (lambda x: replaced('<mass value="3"/>', f'<mass value="{x}"/>'), 0.5, -0.5, "a mass cannot be negative"),
        (lambda x: replaced('lower="-2"', f'lower="{x}"'), -12.56, -12.57, "beyond 4 pi rad; degrees?"),
        (lambda x: replaced(AXIS, f'<axis xyz="0 {x} 0"/>'), 2e-6, 1e-6, "has no direction"),
        (lambda x: replaced(AXIS, f'<axis xyz="0 {x} 0"/>'), 9e5, 1e6, "has no direction"),
        (lambda x: shape(f'<sphere radius="{x}"/>'), 1e-9, 0, "m must be positive; this shape is left out"),
    ],
)
def test_bounds_of_what_an_arm_can_be(
    tmp_path: Path, arm: Callable[[float], str], allowed: float, refused: float, message: str
) -> None:
    assert message not in told(tmp_path, arm(allowed))
    assert message in told(tmp_path, arm(refused))


@pytest.mark.parametrize(
    ("name", "arm"),
    [
        *((name, lambda given: in_shoulder(f"<dynamics {given}/>"))
          for name in ("damping", "friction", "rotor_inertia", "armature")),
        *((name, lambda given: replaced(LIMIT, f'<limit lower="-2" upper="2" {given}/>'))
          for name in ("effort", "velocity", "acceleration", "deceleration", "jerk")),
    ],
)  # fmt: skip
def test_what_cannot_be_negative(tmp_path: Path, name: str, arm: Callable[[str], str]) -> None:
    """Zero can be; what is negative is left out alone."""
    assert "cannot be negative" not in told(tmp_path, arm(f'{name}="0"'))
    assert f"{name}='-1' cannot be negative" in told(tmp_path, arm(f'{name}="-1"'))


def test_as_many_links_and_joints_as_are_allowed(tmp_path: Path) -> None:
    """64 moving joints, 200 links and a chain of 100 joints; one more is refused, see test_robot_urdf."""
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    links = "".join(f'<link name="l{i}">{INERTIAL}</link>' for i in range(200))
    joints = "".join(
        f'<joint name="j{i}" type="{"revolute" if i < 64 else "fixed"}"><parent link="l{i if i < 100 else 0}"/>'
        f'<child link="l{i + 1}"/>{limit if i < 64 else ""}</joint>'
        for i in range(199)
    )
    assert load(tmp_path, f'<robot name="large">{links}{joints}</robot>', tool="l100").n_joints == 64
