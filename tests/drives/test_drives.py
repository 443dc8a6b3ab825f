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


def test_an_efficiency_with_the_no_load_torque_in_it_leaves_the_rest_for_the_load() -> None:
    """1 / 0.5 - 10 * 0.1 / 1 = 1: all that is lost at 1 N m is lost without load, whichever way it turns."""
    for ratio in (10.0, -10.0):
        assert ps.Gearbox(**MEASURED | {"ratio": ratio, "no_load_torque": 0.1}).load_efficiency == 1.0  # type: ignore[arg-type]
        assert ps.Gearbox(**MEASURED | {"ratio": ratio, "no_load_torque": 0.0}).load_efficiency == 0.5  # type: ignore[arg-type]


def test_wind_up_goes_with_the_torque_range_by_range() -> None:
    gearbox = ps.Gearbox(stiffness=[1.0, 2.0, 4.0], stiffness_torques=[1.0, 3.0])
    assert [gearbox.torsion(torque) for torque in (0.5, 2.0, 7.0, -7.0)] == [0.5, 1.5, 3.0, -3.0]
    assert ps.Gearbox(stiffness=[2.0]).torsion(-3.0) == -1.5


def test_peaks_of_a_planetary_gear_count_once_up_to_a_thousand_cycles_an_hour() -> None:
    planetary = ps.Gearbox(kind="planetary")
    assert planetary.impact_factor(3.6) == 1.0
    assert np.isnan(planetary.impact_factor(3.5))
    rising = ps.Gearbox(kind="planetary", impact_curve=[[600.0, 1.5], [1200.0, 2.0]])
    assert [rising.impact_factor(3600 / rate) for rate in (60, 900, 1200)] == pytest.approx([1.5, 1.75, 2.0])
    assert np.isnan(rising.impact_factor(3600 / 1300))


# ---- what no part is

CURVE = [[0.0, 1.0], [9.0, 0.5]]
MEASURED = {"ratio": 10.0, "efficiency": 0.5, "efficiency_torque": 1.0}


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
        ({"thermal_resistances": [1, 0]}, r"thermal_resistances\[1\] = 0 K/W must be greater than 0 K/W"),
        ({"thermal_resistances": [1, 2], "thermal_time_constants": [3]}, "2 thermal_resistances and 1 thermal_time"),
        ({"peak_curve": [[0, 0], [20, 1]]}, r"peak_curve: torques \[0.0, 1.0\] N m must be >= 0, the first one > 0"),
        ({"peak_curve": CURVE, "peak_curves": [(48, CURVE)]}, r"give peak_curve \(any bus voltage\) or peak_curves"),
        ({"peak_curves": [(0, CURVE)]}, "bus voltage of peak_curves = 0 V must be greater than 0"),
        ({"continuous_torque": 1.0, "continuous_curves": [(48, CURVE)]}, "continuous_torque .* or continuous_curves"),
        ({"altitude_curve": [[-1, 1], [9, 0.9]]}, r"altitude_curve: \[-1.0, 9.0\] m must increase strictly from 0 m"),
        ({"altitude_curve": [[9, 1], [9, 0.9]]}, r"altitude_curve: \[9.0, 9.0\] m must increase strictly"),
        ({"altitude_curve": [[0, 1.01], [9, 0.9]]}, r"shares \[1.01, 0.9\] must be above 0 and at most 1"),
        ({"altitude_curve": [[0, 1], [9, 0]]}, r"shares \[1.0, 0.0\] must be above 0"),
        ({"copper_coefficient": -0.1}, "copper_coefficient = -0.1 1/K must be at least 0"),
        ({"geared_share": 1.1}, "geared_share = 1.1 must be at most 1"),
        ({"winding": "delta"}, "winding 'delta'; valid: 'line-line', 'phase'"),
        ({"source": 5}, "source: expected text, got 5"),
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
        ({"stiffness": [0.0]}, r"stiffness\[0\] = 0 N m/rad must be greater than 0 N m/rad"),
        (
            {"stiffness": [1, 2, 3], "stiffness_torques": [-1, 2]},
            r"stiffness_torques\[0\] = -1 N m must be greater than 0 N m",
        ),
        ({"stiffness": [1, 2]}, "expected one stiffness, or K1, K2, K3 with rising torques T1, T2"),
        ({"stiffness": [1], "stiffness_torques": [1, 2]}, "expected one stiffness, or K1"),
        ({"stiffness": [1, 2, 3], "stiffness_torques": [2, 2]}, "expected one stiffness, or K1"),
        ({"impact_curve": [[9, 1], [9, 2]]}, r"impact_curve: rows \[\[9.0, 1.0\], \[9.0, 2.0\]\] must rise"),
        ({"impact_curve": [[9, 2], [10, 1]]}, r"impact_curve: rows .* must rise"),
        ({"impact_curve": [[-1, 1], [9, 2]]}, r"impact_curve: the first row \[-1.0, 1.0\] must have 0 cycles or more"),
        ({"impact_curve": [[0, 0.9], [9, 2]]}, r"impact_curve: the first row \[0.0, 0.9\] .* a factor >= 1"),
        ({"efficiency_map": [[0, 1, 0.5]]}, "at least two torques, got 1 rows for 1 speeds and 1 torques"),
        ({"efficiency_map": [[0, 1, 0.5], [0, 2, 0.5], [9, 1, 0.5]]}, "got 3 rows for 2 speeds and 2 torques"),
        ({"efficiency_map": [[0, 1, 0.5], [0, 2, 0.5], [9, 1, 0.5], [9, 1, 0.6]]}, "got 4 rows for 2 speeds and 2 tor"),
        ({"efficiency_map": [[-1, 1, 0.5], [-1, 2, 0.5]]}, "speeds must be >= 0, torques above 0"),
        ({"efficiency_map": [[0, 0, 0.5], [0, 2, 0.5]]}, "speeds must be >= 0, torques above 0"),
        ({"efficiency_map": [[0, 1, 0.0], [0, 2, 0.5]]}, "efficiencies above 0 and at most 1"),
        ({"efficiency_map": [[0, 1, 0.5], [0, 2, 1.01]]}, "efficiencies above 0 and at most 1"),
        # 1 / 0.5 - 10 * 0.1 / 1 = 1: all that is lost is lost without load; more cannot be.
        (MEASURED | {"no_load_torque": 0.11}, "no_load_torque = 0.11 N m is more than all .* 0.5 at 1 N m loses"),
        (MEASURED, "tells efficiency and no_load_torque apart: it needs both, and the ratio"),
        (MEASURED | {"no_load_torque": 0.1, "ratio": np.nan}, "it needs both, and the ratio"),
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
    own = ps.own_drivetrains(puma)[1].motor.source
    assert own
    assert motors[1].source.startswith(f"{own}; ")
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
