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
    "lacks a joint": (
        "[parameters.new.joints.elbow]\ngear_ratio = 50.0\narmature = 0.5\n",
        "",
        "joint 'elbow' of the URDF has no entry; given: shoulder",
    ),
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
        r"arm\.toml: unknown link \(with <inertial>\) 'four'; valid: upper, fore",
    ),
    "schema": ("schema = 1", "schema = 2", "schema = 2, expected schema = 1"),
    "other robot": ('robot = "arm"', 'robot = "leg"', "written for robot 'leg', but the URDF's is 'arm'"),
    "gear ratio 0": ("gear_ratio = -100.0", "gear_ratio = 0", "joint 'shoulder': gear_ratio = 0"),
    "no gear ratio": ("gear_ratio = -100.0\n", "", "joint 'shoulder': gear_ratio is missing"),
    "both inertias": (
        "rotor_inertia = 1e-4",
        "rotor_inertia = 1e-4\narmature = 1",
        "exactly one of rotor_inertia",
    ),
    "no inertia": ("rotor_inertia = 1e-4\n", "", "exactly one of rotor_inertia"),
    "negative inertia": (
        "1e-4",
        "-1e-4",
        r"joint 'shoulder': rotor_inertia = -0.0001 kg m\^2 must be at least 0",
    ),
    "nan": ("armature = 0.5", "armature = nan", "joint 'elbow' rotor inertia = nan is not a finite number"),
    "boolean": (
        "armature = 0.5",
        "armature = true",
        "joint 'elbow' rotor inertia: expected a number, got True",
    ),
    "text": ("armature = 0.5", 'armature = "0.5"', "expected a number, got '0.5'"),
    "friction sign": ("[0.02, -0.03]", "[0.02, 0.03]", r"coulomb_friction = \[0.02, 0.03\] N m: the first"),
    "friction shape": ("[0.02, -0.03]", "[0.02]", r"shape \(1,\) is not \(2,\)"),
    "limit 0": (
        "{ shoulder = 40.0",
        "{ shoulder = 0",
        r"\[limits.amplifier\]: effort limit\[0\] = 0 must be positive",
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
    parameters = "worn" if fault == "unknown link" else None
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
