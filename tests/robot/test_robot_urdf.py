"""URDFs that Pinocchio takes wrongly, drops in part, crashes on or refuses without a reason."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from helpers.urdf_texts import ARM, DRIVES, INERTIA, INERTIAL, load, replaced, told
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import puma_septic as ps

SHOULDER_LIMIT = 'lower="-2" upper="2" effort="50" velocity="3"'
LOOP = """<joint name="third" type="revolute"><parent link="base"/><child link="fore"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
CYCLE = """<link name="a"/><link name="b"/>
<joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>
<joint name="ba" type="fixed"><parent link="b"/><child link="a"/></joint></robot>"""

# Pinocchio 4.1.0 builds each of these without an exception: without the inertia, without a joint, with 0 for
# what is misspelt, with two drives for one, or with a singular mass matrix.
ACCEPTED_WRONG = {
    "mass xacro": (
        '<mass value="3"/>',
        '<mass value="${m}"/>',
        r"'\$\{m\}' is a xacro expression; expand it first: .*xacrodoc",
    ),
    "mass misspelt": (
        '<mass value="3"/>',
        '<mass valeu="3"/>',
        "unknown attribute valeu='3'; valid: value; did you mean 'value'",
    ),
    "inertial misspelt": (INERTIAL, INERTIAL.replace("inertial", "innertial"), "did you mean <inertial>"),
    "inertial capital": (INERTIAL, INERTIAL.replace("inertial", "Inertial"), "did you mean <inertial>"),
    "axis twice": (
        '<axis xyz="0 1 0"/>',
        '<axis xyz="0 1 0"/><axis xyz="1 0 0"/>',
        r"<axis> twice \(lines 8 and 8",
    ),
    "axis zero": ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>', "<axis> of joint 'shoulder': .*no direction"),
    "axis misspelt": (
        '<axis xyz="0 1 0"/>',
        '<axis xzy="0 1 0"/>',
        "unknown attribute xzy='0 1 0'; valid: xyz",
    ),
    "origin misspelt": ('<origin xyz="0 0 0.5"/>', '<origin xzy="0 0 0.5"/>', "unknown attribute xzy"),
    "origin far": ('<origin xyz="0 0 0.5"/>', '<origin xyz="0 0 1e308"/>', "farther than 1000 m"),
    "lower misspelt": ('lower="-2"', 'lover="-2"', "unknown attribute lover='-2'; valid: lower"),
    "limits swapped": (
        SHOULDER_LIMIT,
        'lower="2" upper="-2" effort="1" velocity="1"',
        "lower=2 must be less than",
    ),
    "limit twice": ("</joint>", f"<limit {SHOULDER_LIMIT}/></joint>", "<limit> twice"),
    "two parents": ("</robot>", LOOP, "'third'.*already the child of joint 'elbow' in line 11; closed loops"),
    "cycle": ("</robot>", CYCLE, "links a, b form a loop that is not connected to the base"),
    "floating": (
        '"shoulder" type="revolute"',
        '"shoulder" type="floating"',
        "floating.*only arms on a fixed base",
    ),
    "planar": ('"shoulder" type="revolute"', '"shoulder" type="planar"', "planar.*only arms on a fixed base"),
    "joint name empty": ('name="elbow"', 'name=""', "<joint> '': name is empty"),
    "joint name universe": ('name="elbow"', 'name="universe"', "'universe' is Pinocchio's name"),
    "joint name long": ('name="elbow"', f'name="{"e" * 201}"', "at most 200 printable characters"),
    "joint name control": ('name="elbow"', 'name="el&#10;bow"', "printable characters"),
    "namespace tag": ("</robot>", "<xacro:arm/></robot>", "<xacro:arm>: this is a xacro source; expand it first"),
}

# Pinocchio refuses these, with one sentence for all causes and the reason on the C library's standard error.
REFUSED_WITHOUT_REASON = {
    "version": ('<robot name="arm">', '<robot name="arm" version="2.0">', "version='2.0' is not supported"),
    "truncated": ("</robot>", "", "line 17, column 0: not well-formed XML: no element found"),
    "trailing": ("</robot>", "</robot>x", "not well-formed XML: junk after document element"),
    "entity": ('value="3"', 'value="&three;"', "not well-formed XML: undefined entity"),
    "nul": ('value="3"', 'value="\0"', "not well-formed XML"),
    "duplicate attribute": ('<mass value="3"/>', '<mass value="3" value="4"/>', "XML: duplicate attribute"),
    "duplicate link": (
        '<link name="tip"/>',
        '<link name="upper"/>',
        "line 6, <link> 'upper': .*link in line 4",
    ),
    "duplicate joint": ('name="elbow"', 'name="shoulder"', "line 11, <joint> 'shoulder': .*joint in line 7"),
    "two roots": (
        "</robot>",
        '<link name="loose"/></robot>',
        r"2 links are child of no joint \(base, loose\)",
    ),
    "self": ('<parent link="fore"/>', '<parent link="tip"/>', "links tip form a loop"),
    "no root": ('<parent link="base"/>', '<parent link="tip"/>', "links upper, fore, tip form a loop"),
    "unknown link": (
        '<parent link="fore"/>',
        '<parent link="for"/>',
        "'mount': its parent link 'for' is not defined",
    ),
    "no child": ('<child link="tip"/>', "", "<joint> 'mount': <child> is missing"),
    "type": (
        'type="fixed"',
        'type="Fixed"',
        "type='Fixed' is unknown; valid: revolute, continuous, prismatic, fixed",
    ),
    "axis two": ('<axis xyz="0 1 0"/>', '<axis xyz="0 1"/>', "xyz='0 1': expected 3 numbers"),
    "doctype": ("<robot", '<!DOCTYPE r [<!ENTITY a "b">]><robot', "DOCTYPE.* is not allowed"),
}


@pytest.mark.parametrize("fault", ACCEPTED_WRONG)
def test_refuses_what_pinocchio_accepts_wrongly(tmp_path: Path, fault: str) -> None:
    old, new, message = ACCEPTED_WRONG[fault]
    with pytest.raises(ps.ModelError, match=message) as caught:
        load(tmp_path, replaced(old, new))
    assert "arm.urdf" in str(caught.value)


@pytest.mark.parametrize("fault", REFUSED_WITHOUT_REASON)
def test_names_the_reason_that_pinocchio_keeps_to_itself(
    tmp_path: Path, fault: str, capfd: pytest.CaptureFixture[str]
) -> None:
    old, new, message = REFUSED_WITHOUT_REASON[fault]
    with pytest.raises(ps.ModelError, match=message):
        load(tmp_path, replaced(old, new))
    assert capfd.readouterr().err == ""  # Pinocchio, which writes there, was not reached


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "this URDF is empty"),
        (b"  \n", "this URDF is empty"),
        (b"hello", "not well-formed XML"),
        (b"<html></html>", "the root of a URDF is <robot>"),
        (b"<sdf/>", "this is an SDF file"),
        (b'<robot name="r"/>', "no <link>"),
        (b'<robot name="r"><link name="only"/></robot>', "no joint moves"),
        (ARM.replace("elbow", "él").encode("latin-1"), "line 11: this URDF is not UTF-8 text"),
        (b"\x00\xff" * 10, "not UTF-8"),
        (b" " * 5_000_001, "larger than 5 MB"),
        (b"<robot>" * 500, "more than 100 nested elements"),
    ],
)
def test_refuses_a_file_that_is_no_urdf(tmp_path: Path, content: bytes, message: str) -> None:
    with pytest.raises(ps.ModelError, match=message):
        load(tmp_path, content)


def test_missing_file_directory_text_and_unknown_name(tmp_path: Path) -> None:
    with pytest.raises(ps.ModelError, match=r"none\.urdf: this URDF does not exist"):
        ps.load_robot(tmp_path / "none.urdf")
    with pytest.raises(ps.ModelError, match="this URDF is not a file"):
        ps.load_robot(tmp_path)
    with pytest.raises(ps.InputError, match=r"XML text; write it to a \.urdf file"):
        ps.load_robot(ARM)
    with pytest.raises(
        ps.InputError, match=r"unknown robot 'puma'; valid: 'puma560', .*'ur5'.*, or the path of a \.urdf"
    ):
        ps.load_robot("puma")
    with pytest.raises(ps.ModelError, match="cannot be read: File name too long"):
        ps.load_robot("x" * 5000 + ".urdf")


def chain(n: int, kind: str) -> str:
    """A chain of n joints."""
    links = "".join(f'<link name="l{i}">{INERTIAL}</link>' for i in range(n + 1))
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    joints = "".join(
        f'<joint name="j{i}" type="{kind}"><parent link="l{i}"/><child link="l{i + 1}"/>{limit}</joint>'
        for i in range(n)
    )
    return f'<robot name="chain">{links}{joints}</robot>'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (chain(65, "revolute"), "65 moving joints; at most 64"),
        (chain(200, "revolute"), "201 links; at most 200"),
        (
            replaced('"j0" type="fixed"', '"j0" type="revolute"', chain(101, "fixed")),
            "a chain of 101 joints; at most 100",
        ),
    ],
)
def test_caps_what_would_exhaust_memory_or_crash(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ps.ModelError, match=message):
        load(tmp_path, text)


@pytest.mark.parametrize(
    ("old", "new", "note"),
    [
        ('<axis xyz="0 1 0"/>', "", "joint 'shoulder': no <axis>, so the URDF's default"),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 2 0"/>', "joint 'shoulder': axis '0 2 0' has length 2"),
        ('<origin xyz="0 0 0.5"/>', '<origin rpy="90 0 0"/>', "joint 'shoulder': rpy='90 0 0'.*degrees"),
        ('lower="-2"', 'lower="-180"', "joint 'shoulder': limits -180 to 2 rad .*degrees"),
        ('effort="50"', 'effort="0"', "joint 'shoulder': the URDF gives no effort limit"),
        ('izz="0.05"', 'izz="0.3"', r"link 'upper': principal moments 0.1 \+ 0.1 < 0.3"),
        ("</robot>", "<gazebo/></robot>", "URDF elements not used: <gazebo>"),
        (INERTIAL, "", "link 'upper': moves, but the URDF has no inertia for it"),
        ('"shoulder" type="revolute"', '"shoulder" type="continuous"', "'shoulder': continuous.* not used"),
    ],
)
def test_notes_what_is_odd_but_usable(tmp_path: Path, old: str, new: str, note: str) -> None:
    robot = load(tmp_path, replaced(old, new))
    assert any(re.search(note, text) for text in robot.notes)
    assert not any(re.search(note, text) for text in load(tmp_path).notes)


MESHLESS = '<link name="tip"><visual>{}</visual></link>'
# Each stops only the answers that depend on it, which the last word names, and is told with its place.
STOPS_A_PART = {
    "mass nan": ('<mass value="3"/>', '<mass value="nan"/>', "of link 'upper': value='nan'.*not a finite", "torque"),
    "mass inf": ('<mass value="3"/>', '<mass value="inf"/>', "'inf' is not a finite number", "torque"),
    "mass overflow": ('<mass value="3"/>', '<mass value="1e400"/>', "'1e400' is not a finite number", "torque"),
    "mass word": ('<mass value="3"/>', '<mass value="heavy"/>', "'heavy' is not a finite number", "torque"),
    "mass comma": ('<mass value="3"/>', '<mass value="1,5"/>', "'1,5' is not a finite number", "torque"),
    "mass unit": ('<mass value="3"/>', '<mass value="1.5kg"/>', "'1.5kg' is not a finite number", "torque"),
    "mass hex": ('<mass value="3"/>', '<mass value="0x10"/>', "'0x10' is not a finite number", "torque"),
    "mass underscore": ('<mass value="3"/>', '<mass value="1_000"/>', "'1_000' is not a finite number", "torque"),
    "mass missing": ('<mass value="3"/>', "", "<inertial> of link 'upper': <mass> is missing", "torque"),
    "mass huge": ('<mass value="3"/>', '<mass value="1e300"/>', r"value='1e300': more than 1e\+06 kg", "torque"),
    "mass negative": ('<mass value="3"/>', '<mass value="-3"/>', "value='-3': a mass cannot be negative", "torque"),
    "tensor huge": ('izz="0.05"', 'izz="1e300"', r"principal moment 1e\+300 kg m\^2", "torque"),
    "tensor nan": ('ixx="0.1"', 'ixx="nan"', "<inertia> of link 'upper': ixx='nan'", "torque"),
    "tensor missing": (INERTIA, "", "<inertia> is missing", "torque"),
    "tensor attribute": ('izz="0.05"', 'izx="0.05"', "attribute 'izz' is missing", "torque"),
    "tensor asymmetric": ('izz="0.05"', 'izz="0.05" izx="0.01"', "izx='0.01' is not ixz='0'", "torque"),
    "tensor negative": ('izz="0.05"', 'izz="-0.05"', "moments -0.05, 0.1, 0.1.*none may be negative", "torque"),
    "inertial twice": (INERTIAL, INERTIAL * 2, "<inertial> twice", "torque"),
    "effort negative": ('effort="50"', 'effort="-50"', "<limit> of joint 'shoulder': effort='-50' cannot be", "effort"),
    "effort missing": ('effort="50"', "", "'shoulder': the URDF gives no effort limit", "effort"),
    "effort zero": ('effort="50"', 'effort="0"', "'shoulder': the URDF gives no effort limit", "effort"),
    "velocity negative": ('velocity="3"', 'velocity="-3"', "velocity='-3' cannot be negative", "velocity"),
    "upper arabic": ('upper="2"', 'upper="٢"', "<limit> of joint 'shoulder': upper='٢'", "position"),
    "lower missing": ('lower="-2"', "", "'shoulder': the URDF gives no position limits", "position"),
    "no limit": (f"<limit {SHOULDER_LIMIT}/>", "", "'shoulder': the URDF gives no position limits", "position"),
    "all zero": (
        SHOULDER_LIMIT, 'lower="0" upper="0" effort="0" velocity="0"', "gives lower = 0 and upper = 0", "position",
    ),
    "friction": ("</joint>", '<dynamics friction="-1"/></joint>', "friction='-1' cannot be negative", "friction"),
    "sphere negative": (
        '<link name="tip"/>', MESHLESS.format('<geometry><sphere radius="-1"/></geometry>'),
        "<sphere> of link 'tip': radius='-1' m must be positive", "shape",
    ),
    "box zero": (
        '<link name="tip"/>', MESHLESS.format('<geometry><box size="0 0 0"/></geometry>'), "size='0 0 0' m must be",
        "shape",
    ),
    "visual nan": (
        '<link name="tip"/>', MESHLESS.format('<origin xyz="nan 0 0"/><geometry><sphere radius="1"/></geometry>'),
        "<origin> of link 'tip': xyz='nan 0 0'", "shape",
    ),
    "capsule": (
        '<link name="tip"/>', MESHLESS.format('<geometry><capsule radius="1" length="1"/></geometry>'),
        "a <capsule> cannot be drawn", "shape",
    ),
    "geometry empty": (
        '<link name="tip"/>', MESHLESS.format("<geometry/>"), "exactly one of <box>, <cylinder>, <sphere>, <mesh>",
        "shape",
    ),
    "no geometry": ('<link name="tip"/>', MESHLESS.format(""), "<geometry> is missing", "shape"),
}  # fmt: skip


@pytest.mark.parametrize("fault", STOPS_A_PART)
def test_a_fault_stops_what_depends_on_it_and_is_named(tmp_path: Path, fault: str) -> None:
    """Once each of them stopped the whole robot, though forward kinematics and most limits need none of it."""
    old, new, message, touched = STOPS_A_PART[fault]
    robot = load(tmp_path, replaced(old, new))
    assert any(re.search(message, note) for note in robot.notes)
    assert ps.forward_kinematics(robot, [0.0, 0.0])[2, 3] == pytest.approx(1.2, rel=1e-15)  # 0.5 + 0.4 + 0.3
    result = ps.assess(robot, ps.profiles.quintic([[0.0, 0.0], [0.3, 0.3]], [0.0, 1.0]))
    unknown = {
        "torque": np.isnan(result.peak_torque).tolist() == [True, False],
        "shape": robot.visual_model.ngeoms == 0,
        "friction": np.isnan([law.coulomb for law in robot.friction]).all(),
    }
    limit = np.isnan(getattr(robot.limits, touched, robot.limits.jerk)[0]).any()
    assert unknown.get(touched, bool(limit))
    assert any("shoulder" in line or "all joints" in line for line in result.not_assessed)
    if touched != "torque":
        assert robot.missing_inertia == ()


def test_everything_wrong_is_told_at_once(tmp_path: Path) -> None:
    """A file with five faults once took five rounds."""
    text = replaced('xyz="0 0 0.5"', 'xyz="0 0"')
    text = replaced('"fixed"', '"Fixed"', text)
    text = replaced('<link name="tip"/>', '<link name="tip"/><link name="tip"/><lnik name="x"/>', text)
    text = replaced('<axis xyz="0 1 0"/>', '<axis xzy="0 1 0"/>', text)
    with pytest.raises(ps.ModelError) as caught:
        load(tmp_path, text)
    message = str(caught.value)
    assert "arm.urdf: 5 faults:" in message
    for part in (
        "line 6, <link> 'tip': this name is already taken", "line 6, <lnik> 'x': unknown element; did you mean <link>?",
        "line 8, <origin> of joint 'shoulder': xyz='0 0': expected 3 numbers", "did you mean 'xyz'?",
        "line 15, <joint> 'mount': type='Fixed' is unknown",
    ):  # fmt: skip
        assert part in message


@pytest.mark.parametrize(("angle", "is_odd"), [("6.28", False), ("-6.28", False), ("6.29", True), ("-90", True)])
def test_an_angle_beyond_a_turn_is_questioned(tmp_path: Path, angle: str, is_odd: bool) -> None:
    text = told(tmp_path, replaced('xyz="0 0 0.5"', f'xyz="0 0 0.5" rpy="0 {angle} 0"'))
    assert (f"joint 'shoulder': rpy='0 {angle} 0' is beyond 2 pi rad; degrees?" in text) == is_odd


def test_five_megabytes_are_read(tmp_path: Path) -> None:
    """One byte more is refused, see above."""
    assert load(tmp_path, ARM + " " * (5_000_000 - len(ARM))).joint_names == ("shoulder", "elbow")


@pytest.mark.parametrize("faults", [20, 25])
def test_of_many_faults_twenty_are_told(tmp_path: Path, faults: int) -> None:
    odd = "".join(f'<lnik name="l{k}"/>' for k in range(faults))
    with pytest.raises(ps.ModelError) as caught:
        load(tmp_path, replaced('<link name="tip"/>', '<link name="tip"/>' + odd))
    head, *told = str(caught.value).splitlines()
    assert head.endswith(f"arm.urdf: {faults} faults:")
    assert [line.split()[0] for line in told[:20]] == [f"({k})" for k in range(1, 21)]
    assert told[20:] == (["  and 5 more"] if faults == 25 else [])


@pytest.mark.parametrize(("deceleration", "used"), [("5.5", None), ("4.5", "4.5"), ("6.5", "5.5")])
def test_of_acceleration_and_deceleration_the_smaller_limits(
    tmp_path: Path, deceleration: str, used: str | None
) -> None:
    limits = f'{SHOULDER_LIMIT} acceleration="5.5" deceleration="{deceleration}"'
    robot = load(tmp_path, replaced(SHOULDER_LIMIT, limits))
    assert robot.limits.acceleration[0] == float(used or 5.5)
    told = [note for note in robot.notes if "deceleration" in note]
    note = f"joint 'shoulder': of acceleration and deceleration the smaller is its limit, {used}"
    assert told == ([] if used is None else [note])


def test_swapped_limits_are_refused_unless_the_actuator_file_has_them(tmp_path: Path) -> None:
    """load_robot failed before the file that repairs it was read; a locked joint has no limits to break."""
    text = replaced(SHOULDER_LIMIT, 'lower="2" upper="-2" effort="50" velocity="3"')
    with pytest.raises(ps.ModelError, match=r"line 9, <limit> of joint 'shoulder': lower=2 must be less.*swapped\?"):
        load(tmp_path, text)
    assert load(tmp_path, text, locked={"shoulder": 0.5}).joint_names == ("elbow",)
    drives = "schema = 1\n[limits.own]\nposition = { shoulder = [-2.0, 2.0] }\n"
    assert load(tmp_path, text, drives).limits.position.tolist() == [[-2.0, 2.0], [-2.5, 2.5]]


def test_limits_of_version_1_2_and_vendors(tmp_path: Path) -> None:
    """ros/urdfdom #212: acceleration, deceleration and jerk; Drake writes them in a namespace of its own."""
    text = replaced('velocity="3"', 'velocity="3" acceleration="10" deceleration="8" jerk="200"')
    limits = load(tmp_path, text).limits
    np.testing.assert_array_equal(limits.acceleration, [8.0, np.nan])
    np.testing.assert_array_equal(limits.jerk, [200.0, np.nan])
    assert limits.source == "arm.urdf"
    foreign = replaced('name="arm"', 'name="arm" xmlns:drake="http://drake.mit.edu"')
    foreign = replaced('velocity="3"', 'velocity="3" drake:acceleration="10"', foreign)
    assert load(tmp_path, foreign).limits.acceleration[0] == 10.0
    other = load(tmp_path, foreign.replace("drake:acceleration", "drake:effort"))  # no limit that the format lacked
    assert other.limits.effort[0] == 50.0
    assert "URDF attributes not used: <limit drake:effort>" in other.notes
    elsewhere = load(
        tmp_path, foreign.replace("<axis ", '<axis drake:jerk="x" ').replace(" drake:acceleration", " jerk")
    )
    assert elsewhere.limits.jerk[0] == 10.0
    assert "URDF attributes not used: <axis drake:jerk>" in elsewhere.notes
    parent = load(tmp_path, foreign.replace("<parent ", '<parent drake:jerk="x" '))
    assert "URDF attributes not used: <parent drake:jerk>" in parent.notes


def test_a_misspelt_soft_limit_stops_nothing(tmp_path: Path) -> None:
    """Kinova's own Gen3 lite has soft_upper and soft_lower: no number rests on them."""
    text = replaced("</joint>", '<safety_controller soft_upper="0" soft_lower="0" k_velocity="0"/></joint>')
    robot = load(tmp_path, text)
    assert robot.limits.position.tolist() == load(tmp_path).limits.position.tolist()
    assert any("soft_upper" in note for note in robot.notes)


def test_minus_zero_is_zero_in_a_tensor_written_in_full(tmp_path: Path) -> None:
    """Kinova's Movo: iyx='0.000000' and ixy='-0.000000' left the link without inertia."""
    robot = load(tmp_path, replaced('izz="0.05"', 'izz="0.05" iyx="-0.000" izx="0e0" izy="0.0"'))
    assert robot.knows_torque.all()


def test_soft_limits_are_told_and_taken_on_request(tmp_path: Path) -> None:
    """They were dropped without a word."""
    soft = '<safety_controller k_velocity="20" soft_lower_limit="-0.5" soft_upper_limit="0.5"/></joint>'
    text = replaced("</joint>", soft)
    robot = load(tmp_path, text)
    assert robot.limits.position[0].tolist() == [-2.0, 2.0]
    assert any("'shoulder': its safety controller has soft limits -0.5 to 0.5" in note for note in robot.notes)
    assert load(tmp_path, text, limits="soft").limits.position.tolist() == [[-0.5, 0.5], [-2.5, 2.5]]
    for lower, upper, is_told in ((-2, 2, False), (-3, 3, False), (-1, 2, True), (-2, 1, True)):
        text = replaced("</joint>", soft.replace('"-0.5"', f'"{lower}"').replace('"0.5"', f'"{upper}"'))
        assert any("safety controller" in note for note in load(tmp_path, text).notes) == is_told


@pytest.mark.parametrize(
    ("old", "new", "note"),
    [
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0" rpy="0 0 0"/>', "rpy='0 0 0' of its axis is not used"),
        ("</joint>", '<dynamics spring_stiffness="1"/></joint>', "attributes not used: <dynamics spring_stiffness>"),
        ('izz="0.05"', 'izz="0.05" iyx="0" izx="0" izy="0"', ""),
        ('<link name="base"/>', '<xacro:property name="w" value="0.2"/><link name="base"/>', "<xacro:property>"),
        (
            '<link name="base"/>', f'<link name="base">{INERTIAL.replace("0.05", "-0.05")}</link>',
            "none may be negative; the link never moves",
        ),
        ('izz="0.05"', 'izz="-1e-6"', "the least below 0 by rounding; used as they are"),
        ('"0 0 0.5"', '"0 0 0.5" quat_xyzw="0 0 0 1"', "quat_xyzw='0 0 0 1' is used"),
        (
            '<link name="tip"/>',
            MESHLESS.format('<geometry><sphere radius="1"/></geometry><material name="a"/><material name="b"/>'),
            "<material> twice.*this material is left out",
        ),
    ],
)  # fmt: skip
def test_what_means_nothing_for_the_arm_stops_nothing(tmp_path: Path, old: str, new: str, note: str) -> None:
    """Each stopped public arm files: all Kawasaki, Stretch, Gen3 lite, IRB 4600, Elephant, TIAGo's antenna."""
    text = replaced(old, new).replace(
        '<robot name="arm">', '<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">'
    )
    robot = load(tmp_path, text)
    assert any(re.search(note, text) for text in robot.notes)
    assert robot.missing_inertia == ()
    q, v, a = [0.3, -0.4], [1.0, 2.0], [3.0, -4.0]
    # The mass of the base and a rounded moment do not change the torque by more than the rounding itself.
    expected = ps.inverse_dynamics(load(tmp_path, ARM.replace('izz="0.05"', 'izz="0"')), q, v, a)
    assert ps.inverse_dynamics(robot, q, v, a) == pytest.approx(expected, rel=1e-12)


def test_an_axis_that_is_turned_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ps.ModelError, match="rpy='0 0 1': an axis is turned by its xyz alone"):
        load(tmp_path, replaced('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0" rpy="0 0 1"/>'))


def test_a_quaternion_turns_as_its_angles_do(tmp_path: Path) -> None:
    """URDF 1.1: quat_xyzw instead of rpy."""
    half = np.sqrt(0.5)
    turned = load(tmp_path, replaced('"0 0 0.5"', f'"0 0 0.5" quat_xyzw="{half} 0 0 {half}"'))
    angles = load(tmp_path, replaced('"0 0 0.5"', f'"0 0 0.5" rpy="{np.pi / 2} 0 0"'))
    q = [0.3, 0.4]
    assert ps.forward_kinematics(turned, q) == pytest.approx(ps.forward_kinematics(angles, q), abs=1e-15)
    with pytest.raises(ps.ModelError, match=r"<origin> of joint 'shoulder': quat_xyzw='0 0 0 2': its norm is 2"):
        load(tmp_path, replaced('"0 0 0.5"', '"0 0 0.5" quat_xyzw="0 0 0 2"'))


def test_an_encoding_that_nobody_knows_is_named(tmp_path: Path) -> None:
    text = ARM.replace("?>", ' encoding="klingon"?>', 1)
    with pytest.raises(ps.ModelError, match=r"line 1: this URDF's encoding is not known: .*klingon; save it as UTF-8"):
        load(tmp_path, text)


@pytest.mark.parametrize("encoding", ["ISO-8859-1", "UTF-16"])
def test_a_declared_encoding_is_read(tmp_path: Path, encoding: str) -> None:
    text = ARM.replace("?>", f' encoding="{encoding}"?><!-- Größe -->', 1)
    assert load(tmp_path, text.encode(encoding)).joint_names == ("shoulder", "elbow")


def test_what_stands_before_the_declaration_is_named(tmp_path: Path) -> None:
    with pytest.raises(ps.ModelError, match=r"remove what stands before <\?xml"):
        load(tmp_path, "\n" + ARM)


def test_a_robot_without_a_name_is_called_as_its_file(tmp_path: Path) -> None:
    """Pinocchio refuses it; no number depends on the name."""
    robot = load(tmp_path, replaced(' name="arm"', ""))
    assert robot.name == "arm"
    assert any("<robot>: attribute 'name' is missing; called 'arm'" in note for note in robot.notes)


def test_a_byte_order_mark_is_no_fault(tmp_path: Path) -> None:
    assert load(tmp_path, b"\xef\xbb\xbf" + ARM.encode()).joint_names == ("shoulder", "elbow")


def test_axis_length_does_not_change_the_torque(tmp_path: Path) -> None:
    q, v, a = np.array([0.3, -0.4]), np.array([1.0, 2.0]), np.array([3.0, -4.0])
    unit = ps.inverse_dynamics(load(tmp_path), q, v, a)
    double = ps.inverse_dynamics(load(tmp_path, ARM.replace("0 1 0", "0 2 0")), q, v, a)
    assert double == pytest.approx(unit, rel=1e-14)  # rounding of the normalisation


def test_names_are_kept_verbatim(tmp_path: Path) -> None:
    """Escaping is the work of whoever writes HTML or CSV; the model must not change a name."""
    name = "<script>alert(1)</script> & 'é' \U0001f916"
    escaped = name.replace("&", "&amp;").replace("<", "&lt;")
    robot = load(tmp_path, ARM.replace('"arm"', f'"{escaped}"').replace('"elbow"', f'"{escaped}"'))
    assert robot.name == name
    assert robot.joint_names == ("shoulder", name)
    assert robot.model.names[2] == name


def test_joints_are_in_file_order_though_pinocchio_sorts_siblings(tmp_path: Path) -> None:
    branch = """<link name="other"/>
    <joint name="zz" type="continuous"><parent link="base"/><child link="other"/></joint>
    <joint name="shoulder" """
    text = replaced('<joint name="shoulder" ', branch).replace(
        '<link name="other"/>', f'<link name="other">{INERTIAL}</link>'
    )
    robot = load(tmp_path, text)
    assert robot.joint_names == ("zz", "shoulder", "elbow")
    assert list(robot.model.names) == ["universe", "shoulder", "elbow", "zz"]


def test_without_inertia_kinematics_work_and_torque_is_refused(tmp_path: Path) -> None:
    robot = load(tmp_path, ARM.replace(INERTIAL, ""))
    assert robot.missing_inertia == ("shoulder", "elbow")
    assert ps.forward_kinematics(robot, [0.0, 0.0])[2, 3] == pytest.approx(1.2, rel=1e-15)  # 0.5 + 0.4 + 0.3
    with pytest.raises(ps.ModelError, match=r"'shoulder'.*'elbow'"):
        ps.inverse_dynamics(robot, [0.0, 0.0], [0.0, 0.0], [0.0, 0.0])


def test_only_the_joints_that_carry_nothing_are_missing(tmp_path: Path) -> None:
    text = ARM.replace(INERTIAL, "", 2).replace('<link name="upper">', f'<link name="upper">{INERTIAL}')
    assert load(tmp_path, text).missing_inertia == ("elbow",)


def test_no_torque_with_a_mass_matrix_that_is_not_positive_definite(tmp_path: Path) -> None:
    """Two joints on one axis with nothing between them; rotors tell them apart, so with them it is."""
    text = replaced(INERTIAL, "", replaced('<origin xyz="0 0 0.4"/>', ""))
    robot = load(tmp_path, text)
    assert robot.missing_inertia == ("shoulder", "elbow")
    assert any("the joint-space inertia is not positive definite" in note for note in robot.notes)
    assert load(tmp_path, text, DRIVES).missing_inertia == ()


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_whatever_is_typed_wrong_is_refused_or_read_in_full(tmp_path: Path, data: st.DataObject) -> None:
    """A character replaced anywhere: a ModelError, or a model with every mass and a usable mass matrix."""
    position = data.draw(st.integers(0, len(ARM) - 1))
    character = data.draw(st.sampled_from(list("0123456789.-+eE \"'<>/=xyzabn&é\n")))
    text = ARM[:position] + character + ARM[position + 1 :]
    try:
        robot = load(tmp_path, text)
    except ps.ModelError:
        return
    told = " ".join(robot.notes)
    if "inertia is not used" in told:
        assert robot.missing_inertia
    else:
        masses = [float(x) for x in re.findall(r'mass\s+value="([^"]*)"', text)]
        assert sum(body.mass for body in robot.model.inertias) == pytest.approx(sum(masses), rel=1e-12)
    assert robot.model.nv == 2
    if not robot.missing_inertia:
        mass_matrix = pin.crba(robot.model, robot.model.createData(), pin.neutral(robot.model))
        assert np.linalg.eigvalsh(mass_matrix, UPLO="U")[0] > 0
