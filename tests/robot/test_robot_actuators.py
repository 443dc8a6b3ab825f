"""Actuator files: named sets, what they change, and what is refused in them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.urdf_texts import ARM, DRIVES, load, replaced

import puma_septic as ps

NAN = float("nan")


def test_default_set_gives_drives_limits_and_tool(tmp_path: Path) -> None:
    robot = load(tmp_path, ARM, DRIVES)
    shoulder, elbow = robot.actuators
    assert (shoulder.gear_ratio, shoulder.rotor_inertia, shoulder.viscous_friction) == (-100.0, 1e-4, 1e-3)
    assert shoulder.coulomb_friction.tolist() == [0.02, -0.03]
    assert shoulder.source == "catalogue"
    assert elbow.rotor_inertia == pytest.approx(0.5 / 50.0**2, rel=1e-15)  # armature = Jm G^2
    assert np.isnan(elbow.viscous_friction)
    assert robot.armature == pytest.approx([1.0, 0.5], rel=1e-15)
    assert robot.tool == "tip"
    assert robot.notes[:2] == ("parameters 'new': catalogue", "bearings run in")


def test_limit_set_replaces_the_urdfs_and_leaves_the_rest_unknown(tmp_path: Path) -> None:
    robot = load(tmp_path, replaced('effort="50"', 'effort="0"'), DRIVES)
    limits = robot.limits
    assert not any("the URDF gives no effort" in note for note in robot.notes)
    np.testing.assert_array_equal(limits.effort, [40.0, NAN])
    np.testing.assert_array_equal(limits.velocity, [NAN, NAN])
    assert limits.position.tolist() == [[-2.0, 2.0], [-1.0, 1.0]]  # the first is the URDF's
    assert limits.source == "amplifier: amplifier"


def test_file_without_limit_sets_leaves_the_urdfs(tmp_path: Path) -> None:
    text = DRIVES[: DRIVES.index("[limits")].replace('default_limits = "amplifier"', "")
    limits = load(tmp_path, ARM, text).limits
    assert limits.effort.tolist() == [50.0, 20.0]
    assert limits.velocity.tolist() == [3.0, 4.0]


def test_overrides_move_the_centre_of_mass_and_the_joint(tmp_path: Path) -> None:
    robot = load(tmp_path, ARM, DRIVES, parameters="worn")
    assert robot.model.inertias[2].lever.tolist() == [0.0, 0.0, 0.25]
    assert robot.model.jointPlacements[2].translation.tolist() == [0.0, 0.0, 0.45]
    assert robot.model.inertias[1].lever.tolist() == [0.0, 0.0, 0.2]


def test_without_file_drives_are_unknown_and_limits_the_urdfs(tmp_path: Path) -> None:
    robot = load(tmp_path)
    assert all(np.isnan(actuator.gear_ratio) for actuator in robot.actuators)
    assert robot.armature.tolist() == [0.0, 0.0]
    assert any("rotor inertia and friction are unknown, not in the torques" in note for note in robot.notes)
    assert robot.limits.effort.tolist() == [50.0, 20.0]
    assert np.isnan([*robot.limits.acceleration, *robot.limits.jerk]).all()


def test_names_that_no_file_has(tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match=r"unknown parameters of arm\.toml 'old'; valid: 'new', 'worn'"):
        load(tmp_path, ARM, DRIVES, parameters="old")
    with pytest.raises(ps.InputError, match=r"unknown limits of arm\.toml 'akb'; valid: 'amplifier'"):
        load(tmp_path, ARM, DRIVES, limits="akb")
    with pytest.raises(ps.InputError, match="parameters 'rtb': there are no named sets without an actuator file"):
        load(tmp_path, parameters="rtb")
    with pytest.raises(ps.InputError, match="limits 'akb': there are no named sets without an actuator file"):
        load(tmp_path, limits="akb")
    with pytest.raises(ps.ModelError, match=r"none\.toml: this actuator file does not exist"):
        load(tmp_path, actuators=tmp_path / "none.toml")


FAULTS = {
    "unknown joint": (
        "new.joints.elbow",
        "new.joints.wrist",
        "unknown joint 'wrist'; valid: shoulder, elbow",
    ),
    "unknown limit joint": (
        "{ shoulder = 40.0",
        "{ wrist = 40.0",
        "effort: unknown joint 'wrist'; valid: shoulder",
    ),
    "unknown key": (
        "viscous_friction",
        "viscous",
        "joint 'shoulder': unknown key 'viscous'; valid: gear_ratio",
    ),
    "unknown top key": ("schema = 1", "schema = 1\nscheme = 2", "unknown key 'scheme'; valid: schema"),
    "unknown link": (
        "links.fore",
        "links.four",
        r"arm\.toml: unknown link 'four'; valid: base, upper, fore, tip",
    ),
    "schema": ("schema = 1", "schema = 2", "schema = 2, expected schema = 1"),
    "other robot": ('robot = "arm"', 'robot = "leg"', "written for robot 'leg', but the URDF's is 'arm'"),
    "gear ratio 0": ("gear_ratio = -100.0", "gear_ratio = 0", "joint 'shoulder': gear_ratio = 0"),
    "both inertias": (
        "rotor_inertia = 1e-4",
        "rotor_inertia = 1e-4\narmature = 1",
        r"rotor_inertia \(motor side\) and armature \(joint side\) are given; one of them is meant",
    ),
    "nothing": (DRIVES[DRIVES.index("default_parameters") :], "", "neither drives nor limits"),
    "half a body": ("links.fore]\ncom = [0.0, 0.0, 0.25]", "links.tip]\nmass = 1.0", "needed too"),
    "no body": ("com = [0.0, 0.0, 0.25]", "mass = -1.0", r"links.fore: mass = -1 kg must be at least 0"),
    "negative inertia": (
        "1e-4",
        "-1e-4",
        r"joint 'shoulder': rotor_inertia = -0.0001 kg m\^2 must be at least 0",
    ),
    "nan": ("armature = 0.5", "armature = nan", "joint 'elbow' armature = nan is not a finite number"),
    "boolean": (
        "armature = 0.5",
        "armature = true",
        "joint 'elbow' armature: expected a number, got True",
    ),
    "text": ("armature = 0.5", 'armature = "0.5"', "expected a number, got '0.5'"),
    "friction sign": ("[0.02, -0.03]", "[0.02, 0.03]", r"coulomb_friction = \[0.02, 0.03\] N m: the first"),
    "friction shape": ("[0.02, -0.03]", "[0.02]", r"shape \(1,\) is not \(2,\)"),
    "limit 0": (
        "{ shoulder = 40.0",
        "{ shoulder = 0",
        r"\[limits.amplifier\]: effort limit\[0\] = 0 must be greater than 0",
    ),
    "swapped": ("[-1.0, 1.0]", "[1.0, -1.0]", r"lower bound 1 is not below upper -1"),
    "default": (
        'default_parameters = "new"',
        'default_parameters = "x"',
        "default_parameters = 'x' is not among",
    ),
    "duplicate": (
        "gear_ratio = 50.0\n",
        "gear_ratio = 50.0\ngear_ratio = 51.0\n",
        "not valid TOML: Cannot overwrite",
    ),
    "syntax": ("schema = 1", "schema 1", "not valid TOML"),
    "deep": ("schema = 1", "schema = 1\n" + "a." * 40 + "b = 1", "more than 16 dotted parts"),
    "nested": ("schema = 1", "schema = 1\na = " + "[" * 5000, "not valid TOML"),
    "size": ("schema = 1", "schema = 1 #" + "x" * 64_000, "larger than 0.064 MB"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_refuses_what_does_not_describe_the_arm(tmp_path: Path, fault: str) -> None:
    old, new, message = FAULTS[fault]
    parameters = "worn" if fault in ("unknown link", "half a body", "no body") else None
    with pytest.raises(ps.ModelError, match=message):
        load(tmp_path, ARM, replaced(old, new, DRIVES), parameters=parameters)


@pytest.mark.parametrize("limits", ["corke", "akb", "benchmark"])
@pytest.mark.parametrize("parameters", ["rtb", "akb"])
def test_pumas_sets_load(parameters: str, limits: str) -> None:
    robot = ps.load_robot("puma560", parameters=parameters, limits=limits)
    assert any(note.startswith(f"parameters '{parameters}'") for note in robot.notes)
    assert robot.limits.source.startswith(f"{limits}: ")
    assert np.isnan(robot.limits.jerk).all() == (limits != "benchmark")


def test_pumas_akb_set_moves_link_4_and_the_wrist(puma: ps.Robot) -> None:
    """AKB 1986: d4 = 0.4331 m (table A1), link 4's mass 19 mm on the elbow's side; RTB: 0.4318 m, beyond."""
    akb = ps.load_robot(parameters="akb")
    assert akb.model.jointPlacements[5].translation.tolist() == [0.0, 0.0, 0.4331]
    assert akb.model.inertias[4].lever == pytest.approx([0.0, 0.0, 0.4141], rel=1e-15)
    assert puma.model.jointPlacements[5].translation.tolist() == [0.0, 0.0, 0.4318]
    assert puma.model.inertias[4].lever == pytest.approx([0.0, 0.0, 0.4508], rel=1e-15)
    assert puma.bare_model.inertias[5].mass == akb.bare_model.inertias[5].mass


def test_a_joint_of_the_puma_can_be_locked() -> None:
    """The actuator file of the whole arm was once refused, because it names the joint that no longer moves."""
    robot = ps.load_robot(locked={"joint2": 0.3, "joint6": 0.0})
    whole = ps.load_robot()
    assert robot.joint_names == ("joint1", "joint3", "joint4", "joint5")
    kept = [0, 2, 3, 4]
    np.testing.assert_array_equal(robot.limits.effort, whole.limits.effort[kept])
    np.testing.assert_array_equal(robot.armature, whole.armature[kept])
    q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, 4))
    full = np.zeros((3, 6))
    full[:, kept] = q, v, a
    full[0, 1] = 0.3
    expected = ps.inverse_dynamics(whole, *full)[kept]
    # Rounding of the locked joints' rotations: some roundings of 40 N m.
    np.testing.assert_allclose(ps.inverse_dynamics(robot, q, v, a), expected, rtol=0, atol=1e-12)


def test_what_a_file_does_not_tell_is_unknown(tmp_path: Path) -> None:
    """Limits alone, one joint alone, a rotor without its gears: each was refused."""
    limits = "schema = 1\n[limits.own]\neffort = { shoulder = 40.0 }\n"
    robot = load(tmp_path, ARM, limits)
    assert robot.limits.effort[0] == 40.0
    assert np.isnan([actuator.gear_ratio for actuator in robot.actuators]).all()
    part = DRIVES.replace("[parameters.new.joints.elbow]\ngear_ratio = 50.0\narmature = 0.5\n", "")
    part = part.replace("gear_ratio = -100.0\n", "", 1)
    shoulder, elbow = load(tmp_path, ARM, part).actuators
    assert (shoulder.rotor_inertia, np.isnan(shoulder.gear_ratio)) == (1e-4, True)
    assert np.isnan([shoulder.armature, elbow.armature]).all()
    lines = ps.assess(load(tmp_path, ARM, part), ps.profiles.quintic([[0.0, 0.0], [0.3, 0.3]], [0.0, 1.0])).not_assessed
    assert "rotor inertia (its torque is left out): unknown for all joints" in lines


def test_an_armature_without_gear_ratio_counts_at_the_joint(tmp_path: Path) -> None:
    drives = DRIVES.replace("gear_ratio = 50.0\n", "")
    robot = load(tmp_path, ARM, drives)
    assert robot.armature == pytest.approx([1.0, 0.5], rel=1e-15)
    assert robot.actuators[1].armature == 0.5


DYNAMICS = '<dynamics damping="0.5" friction="1.5" rotor_inertia="0.1"/></joint>'
TRANSMISSION = """<transmission name="t"><type>transmission_interface/SimpleTransmission</type>
<joint name="elbow"><hardwareInterface>EffortJointInterface</hardwareInterface></joint>
<actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator></transmission></robot>"""


def test_what_a_urdf_tells_of_its_drives(tmp_path: Path) -> None:
    """Damping and friction are at the joint (URDF specification), as is RaiSim's rotor_inertia."""
    text = replaced("</robot>", TRANSMISSION, replaced("</joint>", DYNAMICS))
    robot = load(tmp_path, text)
    assert robot.armature.tolist() == [0.1, 0.0]
    assert (robot.friction[0].viscous, robot.friction[0].coulomb.tolist()) == (0.5, [1.5, -1.5])
    assert np.isnan(robot.actuators[0].gear_ratio)
    assert robot.actuators[1].gear_ratio == 50.0
    for what, joint in (("friction", "shoulder"), ("rotor inertia", "shoulder"), ("gear ratio", "elbow")):
        assert any(note.startswith(f"{what} from the URDF") and note.endswith(joint) for note in robot.notes)
    q, v, a = np.array([0.3, 0.2]), np.array([2.0, 1.0]), np.array([3.0, 1.0])
    added = ps.inverse_dynamics(robot, q, v, a) - ps.inverse_dynamics(load(tmp_path), q, v, a)
    assert added == pytest.approx([0.5 * 2.0 + 1.5 + 0.1 * 3.0, 0.0], abs=1e-13)  # rounding of 30 N m


@pytest.mark.parametrize(
    ("printed", "ratio"), [("1", np.nan), ("1.0", np.nan), ("0", np.nan), ("2", 2.0), ("-3", -3.0)]
)
def test_a_reduction_of_one_is_none_that_is_known(tmp_path: Path, printed: str, ratio: float) -> None:
    """Files that do not tell it have a 1 there."""
    robot = load(tmp_path, replaced("</robot>", TRANSMISSION.replace(">50<", f">{printed}<")))
    np.testing.assert_equal(robot.actuators[1].gear_ratio, ratio)


def test_with_a_gear_ratio_what_is_known_at_the_joint_is_the_motors(tmp_path: Path) -> None:
    """Sizing asks the motor's side, where friction that is known at the joint alone would be left out."""
    text = replaced("</robot>", TRANSMISSION.replace("elbow", "shoulder"), replaced("</joint>", DYNAMICS))
    robot = load(tmp_path, text)
    shoulder = robot.actuators[0]
    assert (shoulder.gear_ratio, shoulder.rotor_inertia) == (50.0, pytest.approx(0.1 / 50**2, rel=1e-15))
    assert shoulder.viscous_friction == pytest.approx(0.5 / 50**2, rel=1e-15)
    assert shoulder.coulomb_friction.tolist() == pytest.approx([1.5 / 50, -1.5 / 50], rel=1e-15)
    assert robot.armature[0] == pytest.approx(0.1, rel=1e-15)
    assert robot.friction[0].coulomb.tolist() == pytest.approx([1.5, -1.5], rel=1e-15)


def test_drakes_rotor_and_gears(tmp_path: Path) -> None:
    drake = TRANSMISSION.replace(
        "<mechanicalReduction>50</mechanicalReduction>",
        '<drake:rotor_inertia value="2e-4"/><drake:gear_ratio value="100"/>',
    )
    text = replaced("</robot>", drake).replace('name="arm"', 'name="arm" xmlns:drake="http://drake.mit.edu"')
    assert load(tmp_path, text).armature == pytest.approx([0.0, 2.0], rel=1e-15)


def test_the_actuator_file_goes_before_the_urdf(tmp_path: Path) -> None:
    text = replaced("</joint>", DYNAMICS)
    assert load(tmp_path, text, DRIVES).armature == pytest.approx([1.0, 0.5], rel=1e-15)


BODY = """schema = 1
[parameters.measured]
source = "weighed"
[parameters.measured.links.fore]
mass = 3.0
com = [0.0, 0.0, 0.2]
inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.05]]
"""


def test_masses_in_the_actuator_file_or_from_the_caller_repair_the_urdf(tmp_path: Path) -> None:
    """Half of all public arm files have no inertia; `links.com` alone could not supply it."""
    bare = ARM[: ARM.rindex("<inertial>")] + ARM[ARM.rindex("</inertial>") + len("</inertial>") :]
    q, v, a = [0.3, -0.4], [1.0, 2.0], [3.0, -4.0]
    expected = ps.inverse_dynamics(load(tmp_path), q, v, a)
    body = ps.Payload(mass=3.0, com=(0.0, 0.0, 0.2), inertia=np.diag([0.1, 0.1, 0.05]))
    assert load(tmp_path, bare).missing_inertia == ("elbow",)
    for robot in (load(tmp_path, bare, BODY), load(tmp_path, bare, links={"fore": body})):
        assert robot.missing_inertia == ()
        assert ps.inverse_dynamics(robot, q, v, a) == pytest.approx(expected, rel=1e-15)
    with pytest.raises(ps.ModelError, match="links: unknown link 'hand'; valid: base, upper, fore, tip"):
        load(tmp_path, links={"hand": body})
