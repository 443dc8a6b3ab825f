"""Values of a drive train: what a part may be, what is never counted twice, and the PUMA's own drives."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.arms import pendulum
from helpers.places import DOCS

import puma_septic as ps

GEARED = {"gearbox": ps.Gearbox(ratio=-50.0, efficiency=0.8, backward_efficiency=0.6, inertia=1e-4)}


# ---- the equation's constants


def test_a_drive_train_sums_what_is_known_of_inertia_and_friction() -> None:
    motor = ps.Motor(rotor_inertia=2e-4, viscous_friction=1e-3, coulomb_friction=0.02)
    train = ps.Drivetrain(motor=motor, gearbox=replace(GEARED["gearbox"], no_load_torque=0.03))
    assert train.ratio == 50.0
    assert train.inertia == pytest.approx(3e-4, rel=1e-15)
    assert train.reflected_inertia == pytest.approx(0.75, rel=1e-15)
    np.testing.assert_allclose(train.transmission, [0.6, 1.0, 1.25], rtol=1e-15)
    np.testing.assert_allclose(train.friction.coulomb, [0.05, -0.05], rtol=1e-15)
    assert train.friction.viscous == 1e-3
    assert train.left_out == train.assumptions == ()


def test_an_unknown_backward_efficiency_is_the_forward_one_and_said_so() -> None:
    train = ps.Drivetrain(
        motor=ps.Motor(rotor_inertia=1e-4), gearbox=ps.Gearbox(ratio=9.0, efficiency=0.9, inertia=0.0)
    )
    assert train.transmission[0] == 0.9
    assert train.assumptions == ("backward efficiency of the gears as forward: 0.9",)


def test_what_is_unknown_is_left_out_and_listed() -> None:
    """A motor's friction was once left out without a word."""
    train = ps.Drivetrain(motor=ps.Motor(), gearbox=ps.Gearbox(ratio=10.0))
    assert train.inertia == train.friction.known.viscous == 0.0
    assert not train.friction.is_known
    assert train.transmission.tolist() == [1.0, 1.0, 1.0]
    assert train.left_out == (
        "rotor inertia",
        "input inertia of the gears",
        "losses of the gears (neither efficiency nor measured friction)",
        "viscous friction of the motor",
        "Coulomb friction of the motor",
        "no-load torque of the gears",
    )


def test_measured_friction_keeps_both_of_its_signs() -> None:
    friction = ps.Friction(viscous=1e-3, coulomb=[0.395, -0.435])
    train = ps.Drivetrain(
        motor=ps.Motor(rotor_inertia=1e-4), gearbox=ps.Gearbox(ratio=60.0, inertia=0.0), measured_friction=friction
    )
    assert train.friction is friction
    assert train.transmission.tolist() == [1.0, 1.0, 1.0]
    assert train.left_out == ()


@pytest.mark.parametrize(
    ("motor", "gearbox", "twice"),
    [
        ({}, {"efficiency": 0.8}, "gearbox.efficiency = 0.8"),
        ({}, {"no_load_torque": 0.1}, "gearbox.no_load_torque = 0.1"),
        ({"coulomb_friction": 0.02}, {}, "motor.coulomb_friction = 0.02"),
    ],
)
def test_friction_measured_through_the_gears_excludes_their_losses(motor: dict, gearbox: dict, twice: str) -> None:
    with pytest.raises(ps.InputError, match=f"measured_friction already contains the losses.*{twice} is given too"):
        ps.Drivetrain(
            motor=ps.Motor(**motor),
            gearbox=ps.Gearbox(ratio=10.0, **gearbox),
            measured_friction=ps.Friction(viscous=1e-3, coulomb=[0.1, -0.1]),
        )


def test_continuous_torque_follows_the_s1_curve_and_ends_with_it() -> None:
    motor = ps.Motor(continuous_curve=[[0, 1.2], [100, 1.0], [300, 0.4]])
    assert motor.continuous_torque_at(-200.0) == pytest.approx(0.7, rel=1e-15)
    assert motor.continuous_torque_at(300.1) == 0.0
    assert ps.Motor(continuous_torque=0.5).continuous_torque_at(1e4) == 0.5
    assert np.isnan(ps.Motor().continuous_torque_at(0.0))


# ---- what no part is


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"rotor_inertia": -1e-4}, r"rotor_inertia = -0.0001 kg m\^2 must be at least 0"),
        ({"torque_constant": 0.0}, r"torque_constant = 0 N m/A must be greater than 0"),
        ({"peak_torque": "strong"}, r"peak_torque: expected a number in N m, got 'strong'"),
        ({"max_speed": np.inf}, r"max_speed = inf rad/s is not a finite number"),
        ({"peak_curve": [[0, 1]]}, r"peak_curve: a curve needs at least two \(speed, torque\) rows"),
        ({"peak_curve": [[10, 1], [20, 1]]}, r"peak_curve: the first speed is 10 rad/s; a curve must start at 0"),
        ({"peak_curve": [[0, 1], [20, 1], [20, 0]]}, r"speeds \[0.0, 20.0, 20.0\] rad/s must increase strictly"),
        ({"continuous_curve": [[0, 1], [20, -1]]}, r"continuous_curve: torques \[1.0, -1.0\] N m must be >= 0"),
        ({"continuous_torque": 1.0, "continuous_curve": [[0, 1], [9, 1]]}, "continuous_torque .* not both"),
        ({"thermal_time_constants": [1.0]}, "0 thermal_resistances and 1 thermal_time_constants"),
        ({"thermal_resistances": [1, 2, 3]}, "expected one or two positive numbers"),
        ({"max_winding_celsius": -300.0}, "max_winding_celsius = -300 degrees Celsius must be greater than -273.15"),
    ],
)  # fmt: skip
def test_a_motor_that_cannot_be_is_refused(values: dict, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.Motor(**values)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"ratio": 0.0}, "gear ratio = 0: the ratio of motor speed to joint speed cannot be zero"),
        ({"ratio": np.inf}, "ratio = inf is not a finite number"),
        ({"ratio": 10.0, "efficiency": 1.01}, "efficiency = 1.01 must be at most 1"),
        ({"ratio": 10.0, "efficiency": 0.0}, "efficiency = 0 must be greater than 0"),
        ({"ratio": 10.0, "backward_efficiency": -0.1}, "backward_efficiency = -0.1 must be at least 0"),
        ({"ratio": 10.0, "max_average_torque": -5.0}, "max_average_torque = -5 N m must be greater than 0"),
    ],
)
def test_a_gearbox_that_cannot_be_is_refused(values: dict, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.Gearbox(**values)


def test_a_drive_and_friction_that_cannot_be_are_refused() -> None:
    with pytest.raises(ps.InputError, match="bus_voltage = 0 V must be greater than 0"):
        ps.Drive(bus_voltage=0.0)
    with pytest.raises(ps.InputError, match=r"coulomb = \[-0.1, 0.1\] N m: the first .* must be >= 0"):
        ps.Friction(viscous=0.0, coulomb=[-0.1, 0.1])


# ---- the PUMA's own


def test_own_drives_tell_what_actuators_and_limits_tell(puma: ps.Robot) -> None:
    trains = ps.own_drivetrains(puma)
    np.testing.assert_allclose([train.reflected_inertia for train in trains], puma.armature, rtol=1e-15)
    np.testing.assert_array_equal([train.max_effort for train in trains], puma.limits.effort)
    # Corke 1996, table 2.21 times the toolbox's ratio: 1.51 rad/s * 107.815.
    assert trains[1].motor.max_speed == pytest.approx(162.80065, rel=1e-12)
    assert np.isnan(trains[1].motor.continuous_torque)


def test_the_puma_s_file_adds_published_values_with_their_source(puma: ps.Robot) -> None:
    """Corke 1996, table 2.18: 120, 163, 129, 406, 366, 440 rad/s; RVC, table 9.1: 0.228 N m/A at joint 2."""
    motors = [train.motor for train in ps.load_drivetrains(puma)]
    assert [motor.max_speed for motor in motors] == [120.0, 163.0, 129.0, 406.0, 366.0, 440.0]
    assert motors[1].torque_constant == 0.228
    assert "torque_constant: RVC, table 9.1" in motors[1].source
    assert np.isnan(motors[0].torque_constant)
    assert motors[1].rotor_inertia == 200e-6


def test_a_robot_without_gear_ratios_has_no_drives_to_tell_of(tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match="joint 'swing': its gear ratio is not known"):
        ps.own_drivetrains(pendulum(tmp_path))
    with pytest.raises(ps.InputError, match="joint 'swing': its gear ratio is not known"):
        ps.load_drivetrains(pendulum(tmp_path))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("schema = 2", r"expected schema = 1 and robot = 'puma560', got 2 and None"),
        ("schema = ", "not valid TOML"),
        ("[joints.elbow.motor]", "unknown joint 'elbow'; valid: joint1, joint2"),
        (
            '[joint.joint2.motor]\nmax_speed = { value = 1.0, source = "x" }',  # the s is missing; once left unread
            "drives.toml: unknown key 'joint'; valid: schema, robot, joints; did you mean 'joints'",
        ),
        ("schema = true\nrobot = 'puma560'", "expected schema = 1 and robot = 'puma560', got True and 'puma560'"),
        ("a." * 20 + "b = 1", "a key with more than 16 dotted parts is not allowed"),
        (
            "[joints.joint1.motor]\npeak_curve = { value = [[0, 1], [2]], source = 's' }",
            r"joint 'joint1', motor: peak_curve: expected numbers of shape \(n, 2\), got \[\[0, 1\], \[2\]\]",
        ),
        (
            "[joints.joint1.motor]\npeak_curve = { value = [1979-05-27, 1979-05-27], source = 's' }",
            r"peak_curve: expected numbers of shape \(n, 2\), got \[datetime.date",
        ),
        ("[joints.joint1.motor]\npeak_curve = { value = {}, source = 's' }", "peak_curve: expected numbers of shape"),
        ("[joints.joint1.motor]\nname = { value = nan, source = 's' }", "motor: name: expected text, got nan"),
        ("[joints.joint1.engine]", "joint 'joint1': unknown key 'engine'; valid: motor, gearbox, drive"),
        ("[joints.joint1.motor]\nrotor_inertia = 1", "motor: unknown key 'rotor_inertia'"),
        ("[joints.joint1.motor]\npeak_torque = 1", "motor peak_torque: expected a table, got 1"),
        ("[joints.joint1.motor]\npeak_torque = { value = 1.0 }", 'expected { value = ..., source = "..." }'),
        ('[joints.joint1.motor]\npeak_torque = { value = -1.0, source = "x" }', "peak_torque = -1 N m must be greater"),
    ],
)
def test_a_bad_drives_file_is_refused_with_its_place(puma: ps.Robot, tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "drives.toml"
    file.write_text(text if text.startswith("schema") else f'schema = 1\nrobot = "puma560"\n{text}\n')
    with pytest.raises(ps.ModelError, match=message):
        ps.load_drivetrains(puma, file)


def test_the_examples_of_the_docs_are_read(puma: ps.Robot, tmp_path: Path) -> None:
    """The page once showed an argument that does not exist, and nothing of the file that it speaks of."""
    page = (DOCS / "howto" / "motors.md").read_text(encoding="utf-8")
    (toml,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    file = tmp_path / "drives.toml"
    file.write_text(toml, encoding="utf-8")
    train = ps.load_drivetrains(puma, file)[1]
    assert (train.motor.peak_torque, train.gearbox.max_repeated_torque, train.drive.bus_voltage) == (1.5, 120.0, 40.0)
    assert "peak_torque: " in train.motor.source
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    names: dict = {"ps": ps}
    exec(compile(code, "motors.md", "exec"), names)
    assert names["train"].reflected_inertia == 2.0
