"""Screws, racks and belts of sliding joints: the makers' own examples, and what is refused without one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.arms import joint, link, load

import puma_septic as ps
from puma_septic.limit_check import LimitCheck
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._checks import assess_joint
from puma_septic.sizing._loads import torque_by_cause

# Closed forms: what differs is rounding.
EXACT = 1e-12


def slide_load(
    force: list[float], velocity: list[float], acceleration: list[float], breaks: list[float], **more: object
):
    """A sliding joint under forces, speeds and accelerations that are constant on intervals (speeds may be ramps)."""

    def steps(values: list[float]) -> Piecewise:
        return Piecewise(breaks=breaks, coefficients=np.array(values)[None, :, None])

    start, end = np.array(velocity[:-1]), np.array(velocity[1:])
    given = {
        "joint": "slide", "is_prismatic": True, "torque": steps(force), "gravity": steps([0.0] * len(force)),
        "velocity": Piecewise.from_power(breaks, np.stack([start, end - start])[..., None]),
        "acceleration": steps(acceleration), "velocity_sign": np.sign(start + end),
        "power_sign": np.sign(start + end) * np.sign(force), "braked": np.zeros(len(force), dtype=bool),
        "inertia": steps([0.0] * len(force)), "unbounded": np.nan, "why_not_periodic": "",
    }  # fmt: skip
    return ps.sizing.JointLoad(**(given | more))  # type: ignore[arg-type]


def test_the_published_load_torque_of_a_machine_tool_s_table() -> None:
    """FANUC, B-65262EN/03, p. 46: 612.5 N through a screw of 20 mm and 0.9, and 0.8 N m of friction: 3.0 N m."""
    force = 0.05 * (11760 + 490)
    assert force == 612.5
    stage = ps.LinearStage(kind="screw", travel_per_turn=0.020, efficiency=0.9, inertia=0.0)
    train = ps.Drivetrain(motor=ps.Motor(coulomb_friction=0.8), gearbox=ps.Gearbox(ratio=1.0), stage=stage)
    load = ps.sizing.gearbox_load(slide_load([force], [0.5, 0.5], [0.0], [0.0, 1.0]), train)
    motor = ps.sizing.motor_load(load, train)
    assert round(motor.torque(0.5)[0], 1) == 3.0
    assert motor.torque(0.5)[0] == pytest.approx(612.5 * 0.02 / (2 * np.pi * 0.9) + 0.8, rel=EXACT)
    assert load.torque(0.5)[0] == pytest.approx(612.5 * 0.02 / (2 * np.pi * 0.9), rel=EXACT)


def test_the_published_motor_torque_of_a_rack_behind_gears() -> None:
    """Siemens, SIMOVERT MASTERDRIVES MC compendium 6SE7087-6QX70 (AE), p. 11-28: 5.94 + 25.08 N m, 31.03 printed.

    179.2 N m to accelerate the load and 27.47 N m of running resistance through i = 10 with 0.9 of the rack and 0.95 of
    the gears; 0.914 N m for the gears themselves and the rotor of a 1FT6084-8AF7, both at 914 1/s^2 of the motor.
    """
    train = ps.Drivetrain(
        motor=ps.Motor(rotor_inertia=0.0065, peak_torque=65.0),
        gearbox=ps.Gearbox(ratio=10.0, efficiency=0.9 * 0.95, inertia=0.914 / 914),
    )
    load = slide_load([179.2 + 27.47], [0.0, 9.14], [91.4], [0.0, 0.1], is_prismatic=False)
    motor = ps.sizing.motor_load(load, train)
    assert round(motor.torque(0.05)[0], 2) == 31.03
    rotor = motor.parts["rotor"](0.05)[0] - 0.914
    assert round(rotor, 2) == 5.94
    assert motor.torque(0.05)[0] - rotor == pytest.approx(25.08, abs=0.01)  # they cut 25.086 short
    demands = ps.sizing.Demands(load=load, train=train, motor=motor)
    (check,) = [one for one in assess_joint(demands) if isinstance(one, LimitCheck) and one.quantity == "motor torque"]
    assert check.utilisation == pytest.approx(31.03 / 65, rel=1e-3)


def test_the_published_effective_torque_of_that_table() -> None:
    """FANUC, B-65262EN/03, p. 59: 83.2 N m for 0.08 s each way on 3.0 N m, 2.0 s of travel, 3.0 s of rest: 15.0 N m."""
    breaks = np.cumsum([0.0, 0.08, 2.0, 0.08, 3.0])
    torque = Piecewise(breaks=breaks, coefficients=np.array([83.2 + 3.0, 3.0, 3.0 - 83.2, 3.0])[None, :, None])
    zero = torque * 0.0
    motor = ps.sizing.MotorLoad(
        torque=torque, speed=zero, direction=np.zeros(4), parts={"load": torque}, unbounded=np.nan
    )
    assert round(motor.rms_torque, 1) == 15.0


def test_the_published_ball_screw_behind_a_gear() -> None:
    """Yaskawa, E-V-MD p. 2-5: 15 m/min, lead 10 mm, gear 1/2, 80 kg, mu 0.2, 0.9: 3000 1/min, 0.43 N m, 1.58e-4, 135 W.

    They multiply the rounded 0.43 by the speed; unrounded it is 136.1 W.
    """
    speed, mass = 15.0 / 60, 250.0
    force = 2 * 2 * np.pi * 0.9 * 0.43333 / 0.010
    stage = ps.LinearStage(kind="screw", travel_per_turn=0.010, efficiency=0.9)
    train = ps.Drivetrain(gearbox=ps.Gearbox(ratio=2.0), stage=stage)
    joint_load = slide_load([force], [speed, speed], [0.0], [0.0, 1.0], inertia=Piecewise.constant([mass], 1.0))
    load = ps.sizing.gearbox_load(joint_load, train)
    motor = ps.sizing.motor_load(load, train)
    assert round(motor.speed(0.5)[0] * 60 / (2 * np.pi)) == 3000
    assert round(motor.torque(0.5)[0], 2) == 0.43
    assert f"{load.inertia(0.5)[0] / 2**2:.2e}" == "1.58e-04"
    assert round(motor.power(0.5)[0], 1) == 136.1
    assert round(round(motor.torque(0.5)[0], 2) * 2 * np.pi * 50) == 135


def test_a_stage_by_hand() -> None:
    """Up at 2 m/s^2, steady, down braked by the motor: forces through 0.8 or 0.6, inertia and friction on top."""
    stage = ps.LinearStage(
        kind="rack", travel_per_turn=0.2, efficiency=0.8, backward_efficiency=0.6, inertia=0.01, friction_force=15.0
    )
    k = 2 * np.pi / 0.2
    force, acceleration = [120.0, 100.0, -60.0, 100.0], [2.0, 0.0, -2.0, 0.0]
    joint_load = slide_load(force, [0.0, 1.0, 1.0, 0.0, 0.0], acceleration, [0.0, 0.5, 1.0, 1.5, 2.0])
    load = ps.sizing.gearbox_load(joint_load, ps.Drivetrain(gearbox=ps.Gearbox(ratio=1.0), stage=stage))
    expected = [
        120 / 0.8 / k + 0.01 * 2 * k + 15 / k,
        100 / 0.8 / k + 15 / k,
        -60 * 0.6 / k - 0.01 * 2 * k + 15 / k,
        100 / k,  # at rest nothing is lost
    ]
    assert load.torque(load.torque.middles)[:, 0] == pytest.approx(expected, rel=EXACT)
    assert not load.is_prismatic
    assert load.slide is joint_load
    assert load.power_sign.tolist() == [1.0, 1.0, -1.0, 0.0]


@pytest.fixture
def lift(tmp_path: Path) -> ps.Cycle:
    """20 kg up and down 0.5 m, as in the audit."""
    body = link("base", 1.0, [0, 0, 0], np.eye(3)) + link("sled", 20.0, [0, 0, 0], np.eye(3))
    robot = load(tmp_path, "lift", body + joint("slide", "prismatic", "base", "sled", [0, 0, 0], [0, 0, 1]))
    up = ps.quintic_segments([[0.0], [0.5]], [0.0, 1.0])
    return ps.cycle.with_return(ps.compute_motion(robot, up), dwell=0.5)


def test_a_catalogue_of_gears_that_turn_is_refused_at_a_sliding_joint(lift: ps.Cycle) -> None:
    """Newtons against newton metres: "203.8 N is 83.89 % of 243 N" of average torque, and strong enough. Audited."""
    with pytest.raises(ps.InputError, match=r"joint 'slide' slides, but the catalogue's gearboxes turn.*LinearStage"):
        ps.size(lift, catalogue=ps.built_in_catalogue())
    rated = ps.Drivetrain(gearbox=ps.Gearbox(ratio=100.0, max_average_torque=243.0))
    with pytest.raises(ps.InputError, match="max_average_torque = 243 N m is no limit of a force"):
        ps.size(lift, drivetrains=[rated])
    # Without a rating there is nothing to confuse: rad/m, as a robot description has it.
    assert ps.size(lift, drivetrains=[ps.Drivetrain(gearbox=ps.Gearbox(ratio=600.0))]).is_feasible


def test_a_stage_is_refused_at_a_joint_that_turns() -> None:
    move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    cycle = ps.Cycle(steps=[ps.compute_motion(ps.load_robot(), move)])
    belt = ps.Drivetrain(gearbox=ps.Gearbox(ratio=5.0), stage=ps.LinearStage(kind="belt", travel_per_turn=0.1))
    with pytest.raises(ps.InputError, match="joint 'joint1' turns: it takes no belt"):
        ps.size(cycle, drivetrains=[belt] * 6)


def test_with_a_belt_the_gears_and_motors_of_a_catalogue_lift(lift: ps.Cycle) -> None:
    """Selection and full assessment agree, in N m at the gearbox and N at the belt."""
    stage = ps.LinearStage(
        kind="belt", travel_per_turn=0.8, efficiency=0.9, inertia=1e-4, friction_force=20.0, max_force=400.0,
        max_speed=100.0,
    )  # fmt: skip
    place = ps.Drivetrain(stage=stage)
    one = ps.size(lift, catalogue=ps.built_in_catalogue(), drivetrains=[place], keep=None).joint("slide")
    assert one.is_feasible.any()
    for k in range(0, one.catalogue.n_pairs, 7):
        train = one.catalogue.drivetrain(k, 0, [place])
        sizing = ps.size(lift, drivetrains=[train])
        assert one.is_feasible[k] == (not sizing.violations)
    checks = {check.quantity: check for check in one.kept[0].checks}
    assert checks["gearbox average torque"].unit == "N m"
    assert checks["stage force"].unit == "N"
    assert checks["stage force"].demand == pytest.approx(20 * (9.81 + 0.5 * 10 / np.sqrt(3)), rel=1e-9)
    assert checks["stage speed"].demand == pytest.approx(0.5 * 15 / 8 * 2 * np.pi / 0.8, rel=1e-9)


def test_an_effort_limit_of_a_sliding_joint_is_a_force(lift: ps.Cycle) -> None:
    stage = ps.LinearStage(kind="screw", travel_per_turn=0.01)
    train = ps.Drivetrain(gearbox=ps.Gearbox(ratio=2.0), stage=stage, max_effort=300.0)
    demands = ps.size(lift, drivetrains=[train]).demands[0]
    check = next(one for one in assess_joint(demands) if one.quantity == "actuator effort at the joint")
    assert isinstance(check, LimitCheck)
    assert check.unit == "N"
    # Lossless and massless: the force itself.
    assert check.demand == pytest.approx(20 * (9.81 + 0.5 * 10 / np.sqrt(3)), rel=1e-9)
    assert {"losses of the screw", "inertia of the screw", "friction of the screw"} <= set(train.left_out)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"kind": "chain", "travel_per_turn": 0.1}, "kind.*'chain'.*screw.*rack.*belt"),
        ({"kind": "screw", "travel_per_turn": 0.0}, "travel_per_turn = 0 m must be greater than 0 m"),
        ({"kind": "screw", "travel_per_turn": 0.1, "efficiency": 1.2}, "efficiency = 1.2"),
    ],
)
def test_what_no_stage_is_is_refused(values: dict, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.LinearStage(**values)


def test_the_causes_of_a_torque_sum_to_it() -> None:
    """Gravity, motion, rotor and friction were told, and not what the gears take: a tenth at a UR5's shoulder."""
    breaks = [0.0, 1.0, 2.0]
    slide = slide_load([400.0, -250.0], [0.1, 0.3, 0.1], [2.0, -2.0], breaks)
    stage = ps.LinearStage(
        kind="screw", travel_per_turn=0.02, efficiency=0.9, backward_efficiency=0.8, inertia=2e-5, friction_force=12.0
    )
    gearbox = ps.Gearbox(ratio=5.0, efficiency=0.8, backward_efficiency=0.7, inertia=1e-6, no_load_torque=0.02)
    motor = ps.Motor(rotor_inertia=3e-5, viscous_friction=1e-4, coulomb_friction=0.01)
    train = ps.Drivetrain(motor=motor, gearbox=gearbox, stage=stage)
    behind = ps.sizing.gearbox_load(slide, train)
    found = ps.sizing.motor_load(behind, train)
    parts = torque_by_cause(behind, train, found)
    k, t = 0.02 / (2 * np.pi), np.array([0.3, 1.6])
    whole = sum(part(t)[:, 0] for part in parts.values())
    assert whole == pytest.approx(5.0 * found.torque(t)[:, 0], rel=EXACT)
    # Forward 400 N k / 0.9 / 0.8 and the stage's friction and inertia, both through the gears.
    more = 12.0 * k + 2e-5 * 2.0 / k
    expected = (400.0 * k / 0.9 + more) / 0.8 - 400.0 * k - more
    assert parts["gears"](0.3)[0] == pytest.approx(expected, rel=EXACT)
    assert parts["friction"](0.3)[0] == pytest.approx(12.0 * k + 5.0 * (0.03 + 1e-4 * found.speed(0.3)[0]), rel=EXACT)
