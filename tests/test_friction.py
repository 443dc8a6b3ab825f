"""The friction law: known answers, what no friction can do, and the same torque from samples, motions and motors."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.arms import DRIVE, pendulum
from helpers.duty import paper_motion
from helpers.moves import POINTS, TIMES
from helpers.schemas import assert_documented
from hypothesis import given
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.friction import friction_function, friction_terms, loss_along
from puma_septic.piecewise import Piecewise

STICKY = ps.Friction(viscous=0.01, coulomb=[0.4, -0.5], static=[0.7, -0.6], stribeck_velocity=5.0)
# What the torque is fitted to, with a margin for the sum of several fits.
FITTED = 1e-10


@given(
    viscous=st.floats(0, 10),
    coulomb=st.tuples(st.floats(0, 10), st.floats(-10, 0)),
    speed=st.floats(0, 1e3),
    way=st.sampled_from([-1, 0, 1]),
)
def test_friction_never_drives_and_has_the_sign_of_travel(
    viscous: float, coulomb: tuple, speed: float, way: int
) -> None:
    friction = ps.Friction(viscous=viscous, coulomb=coulomb)
    assert way * friction.torque(way * speed, way) >= 0
    at_a_turn = float(friction.torque(0.0, way))
    assert at_a_turn == {1: coulomb[0], -1: coulomb[1], 0: 0.0}[way]
    # A velocity of rounding the wrong way does not turn the Coulomb part.
    assert float(friction.torque(-1e-17 * way, way)) == pytest.approx(at_a_turn, abs=1e-15)


def test_friction_beyond_the_gears_is_the_robot_s_own(puma: ps.Robot) -> None:
    """The robot computes the joint's friction from its actuators by itself: both ways agree, negative ratios too."""
    for j, actuator in enumerate(puma.actuators):
        law = ps.Friction(viscous=actuator.viscous_friction, coulomb=actuator.coulomb_friction)
        joint = law.reflected(actuator.gear_ratio).known
        assert joint.viscous == puma.viscous_friction[j]
        np.testing.assert_array_equal(joint.coulomb, puma.coulomb_friction[j])


def test_friction_along_a_motion_is_that_of_its_instants() -> None:
    friction = ps.Friction(viscous=0.1, coulomb=[0.4, -0.5])
    velocity = Piecewise.from_power([0.0, 1.0, 2.0, 3.0], [[[2.0], [0.0], [0.0]], [[-2.0], [0.0], [-3.0]]])
    moving = np.array([1.0, 0.0, -1.0])
    found = friction.along(velocity, moving)
    np.testing.assert_allclose(found(velocity.middles)[:, 0], friction.torque([1.0, 0.0, -1.5], moving), rtol=1e-15)
    assert found.jumps().sizes.ravel() == pytest.approx([-0.4, -0.5])


def test_what_is_unknown_of_friction_is_left_out() -> None:
    partly = ps.Friction(coulomb=[0.4, np.nan])
    assert not partly.is_known
    assert partly.torque([3.0, -3.0], [1, -1]).tolist() == [0.4, 0.0]
    with pytest.raises(ps.InputError, match="viscous = -1 N m s/rad must be at least 0"):
        ps.Friction(viscous=-1.0)
    with pytest.raises(ps.InputError, match=r"coulomb = \[0.4, 0.1\] N m: .* the second \(negative velocity\) <= 0"):
        ps.Friction(coulomb=[0.4, 0.1])


@pytest.mark.parametrize(
    ("given", "is_known"),
    [({}, False), ({"viscous": 0.0}, False), ({"coulomb": [0.0, 0.0]}, False),
     ({"viscous": 0.0, "coulomb": [0.0, np.nan]}, False), ({"viscous": 0.0, "coulomb": [0.0, 0.0]}, True)],
)  # fmt: skip
def test_friction_is_known_if_both_its_parts_are(given: dict, is_known: bool) -> None:
    assert ps.Friction(**given).is_known is is_known


def test_a_joint_that_is_said_to_move_by_half_has_half_its_dry_friction() -> None:
    """What a simulation makes of a velocity near zero."""
    law = replace(STICKY, viscous=0.0)
    assert law.torque([0.0, 0.0], [0.5, -0.25]).tolist() == pytest.approx([0.35, -0.15], rel=1e-15)


def test_static_friction_without_a_width_holds_at_rest_alone() -> None:
    law = ps.Friction(viscous=0.0, coulomb=[0.4, -0.5], static=[0.7, -0.6])
    assert (law.band.tolist(), law.excess.tolist(), law.is_linear) == ([0.7, -0.6], [0.0, 0.0], True)
    assert law.torque([0.0, -1.0], [1, -1]).tolist() == [0.4, -0.5]
    assert ps.Friction(coulomb=[0.4, np.nan]).band.tolist() == [0.4, 0.0]


# ---- Stribeck


def test_stribeck_friction_has_its_known_values() -> None:
    """Static at rest, the Coulomb level and 1/e of the excess at the Stribeck velocity, Coulomb's alone far beyond."""
    law = replace(STICKY, viscous=0.0)
    assert law.torque([0.0, 5.0, 50.0], [1, 1, 1]).tolist() == pytest.approx([0.7, 0.4 + 0.3 / np.e, 0.4], rel=1e-15)
    assert law.torque([0.0, -5.0, -50.0], [-1, -1, -1]).tolist() == pytest.approx(
        [-0.6, -0.5 - 0.1 / np.e, -0.5], rel=1e-15
    )
    assert law.torque(0.0, 0) == 0.0
    assert law.band.tolist() == [0.7, -0.6]
    assert not law.is_linear


@given(speed=st.floats(0, 100), way=st.sampled_from([-1, 1]), ratio=st.sampled_from([-50.0, 0.5, 100.0]))
def test_beyond_the_gears_the_same_power_is_lost(speed: float, way: int, ratio: float) -> None:
    """Two ways: the law of the joint, and that of the motor at the motor's speed times the ratio."""
    joint = STICKY.reflected(ratio).torque(way * speed, way)
    motor = STICKY.torque(way * speed * abs(ratio), way)
    assert joint == pytest.approx(motor * abs(ratio), rel=1e-13)


@given(width=st.floats(1e-3, 1e2))
def test_stribeck_friction_along_a_motion_is_that_of_its_instants(width: float) -> None:
    law = replace(STICKY, stribeck_velocity=width)
    velocity = ps.quintic_segments([[0.0], [2.0]], [0.0, 1.0]).derivative(1)
    found = law.along(velocity, np.array([1.0]))
    t = np.concatenate([np.linspace(0, 1, 1001), np.geomspace(1e-6, 1e-2, 50)])
    np.testing.assert_allclose(found(t), law.torque(velocity(t), np.ones((len(t), 1))), rtol=0, atol=FITTED)


def test_a_narrow_peak_between_samples_is_found() -> None:
    """A joint that slows down to 1e-4 rad/s, without turning, sticks for a hundredth of a second."""
    velocity = Piecewise.from_power([0.0, 2.0], [[[0.53**2 + 1e-4]], [[-2 * 0.53 * 2]], [[4.0]]])
    law = ps.Friction(viscous=0.0, coulomb=[1.0, -1.0], static=[3.0, -3.0], stribeck_velocity=1e-3)
    highest = law.along(velocity, np.array([1.0])).extrema()
    assert highest.max[0] == pytest.approx(1 + 2 * np.exp(-0.01), rel=1e-9)
    assert highest.t_max[0] == pytest.approx(0.53, abs=1e-9)


def test_static_friction_needs_a_coulomb_level_that_it_exceeds() -> None:
    for coulomb in ([0.4, np.nan], [0.4, -0.8]):
        with pytest.raises(ps.InputError, match="must be known in both directions and no smaller than Coulomb"):
            ps.Friction(coulomb=coulomb, static=[0.5, -0.5])
    with pytest.raises(ps.InputError, match="stribeck_velocity = 0 rad/s must be greater than 0"):
        ps.Friction(stribeck_velocity=0.0)
    with pytest.raises(ps.InputError, match=r"load_share = 1\.2 must be at most 1"):
        ps.Friction(load_share=1.2)
    with pytest.raises(ps.InputError, match=r"static = \[-0.5, -0.5\] N m: the first .* must be >= 0"):
        ps.Friction(coulomb=[0.0, 0.0], static=[-0.5, -0.5])


# ---- a robot with all of it


def arm(friction: ps.Friction) -> ps.Robot:
    """The PUMA with this law at each of its motors."""
    robot = ps.load_robot()
    return robot.with_drivetrains(replace(train, measured_friction=friction) for train in robot.drivetrains)


def last_sticks(robot: ps.Robot) -> ps.Robot:
    """The robot whose last joint alone has Stribeck friction, and in one direction only."""
    *others, last = robot.drivetrains
    friction = replace(
        last.measured_friction, static=last.measured_friction.coulomb * [3.0, 1.0], stribeck_velocity=20.0
    )
    return robot.with_drivetrains([*others, replace(last, measured_friction=friction)])


def geared() -> ps.Robot:
    """The PUMA with gears of a known efficiency, and motors with friction of their own."""
    motor = ps.Motor(rotor_inertia=2e-4, viscous_friction=1e-4, coulomb_friction=0.05)
    gears = [
        ps.Gearbox(ratio=train.gearbox.ratio, efficiency=0.8, backward_efficiency=0.6, inertia=1e-5)
        for train in ps.load_robot().drivetrains
    ]
    return ps.load_robot().with_drivetrains(ps.Drivetrain(motor=motor, gearbox=gear) for gear in gears)


ARMS = {
    "Stribeck": lambda: arm(STICKY),
    "load": lambda: arm(ps.Friction(viscous=1e-4, coulomb=[0.1, -0.2], load_share=0.1)),
    "both": lambda: arm(replace(STICKY, load_share=0.3)),
    "one joint": lambda: last_sticks(ps.load_robot()),
    "efficiency": geared,
}


@pytest.mark.parametrize("name", ARMS)
def test_the_torque_of_a_motion_is_that_of_its_instants(name: str) -> None:
    """Two ways: functions of time, split at reversals and changes of the load's sign, and plain samples."""
    robot, move = ARMS[name](), ps.septic(POINTS, TIMES)
    motion = ps.compute_motion(robot, move)
    # At the ends the velocity is 0, and its sign a matter of rounding.
    t = np.linspace(0, 9, 2003)[1:-1]
    state = [move(t, order) for order in range(3)]
    found, expected = motion.torque(t), ps.inverse_dynamics(robot, *state)
    near_a_turn = np.abs(state[1]) < 1e-6
    size = np.abs(expected).max(axis=0)
    assert (np.abs(found - expected)[~near_a_turn] < (FITTED * size * np.ones_like(t)[:, None])[~near_a_turn]).all()
    terms = motion.torque_terms
    np.testing.assert_allclose(terms.total(t), found, rtol=0, atol=FITTED * size.max())
    np.testing.assert_allclose(motion.coulomb(t), terms.coulomb(t), rtol=0, atol=FITTED * size.max())
    sampled = ps.torque_terms(robot, *state)
    np.testing.assert_allclose(sampled.total, expected, rtol=0, atol=1e-12 * size.max())


@pytest.mark.parametrize("name", ARMS)
def test_the_motors_of_a_robot_carry_its_torque(name: str) -> None:
    """Two ways: the assessment at the joint, and the sizing at the motor, through the gears."""
    motion = ps.compute_motion(ARMS[name](), ps.septic(POINTS, TIMES))
    sizing, assessment = ps.size(ps.Cycle(steps=[motion])), ps.assess(motion)
    ratios = np.array([train.ratio for train in sizing.drivetrains])
    for at_motor, at_joint in (("peak_torque", assessment.peak_torque), ("rms_torque", assessment.rms_torque)):
        values = [getattr(demands, at_motor) for demands in sizing.demands]
        sizes = np.array([getattr(value, "size", value) for value in values], dtype=float)
        np.testing.assert_allclose(sizes * ratios, at_joint, rtol=1e-9)


def test_gears_take_a_share_of_the_load(tmp_path: Path) -> None:
    """A pendulum held out: m g l (1 + share) on its way up, m g l (1 - share) down, m g l at rest."""
    drive = DRIVE.format(name="swing", ratio=100.0, rotor=0.0, viscous=0.0, positive=0.0, negative=0.0)
    robot = pendulum(tmp_path, drives=drive + "load_share = 0.1\n")
    up, down, rest = ps.inverse_dynamics(robot, [[np.pi / 2]] * 3, [[1.0], [-1.0], [0.0]], [[0.0]] * 3).ravel()
    lifted = ps.inverse_dynamics(robot, [np.pi / 2], [0.0], [0.0], friction=False).item()
    assert lifted == pytest.approx(2.0 * 9.81 * 0.5, rel=1e-13)
    assert up == pytest.approx(1.1 * lifted, rel=1e-13)
    assert down == pytest.approx(0.9 * lifted, rel=1e-13)
    assert rest == pytest.approx(lifted, rel=1e-13)


def test_loads_of_joints_at_rest_make_no_breaks() -> None:
    """Only the first joint moves, and its load changes sign once, in the middle."""
    robot = arm(ps.Friction(viscous=0.0, coulomb=[0.0, 0.0], load_share=0.5))
    motion = ps.compute_motion(robot, ps.quintic_segments([[0.0] * 6, [1.0, 0, 0, 0, 0, 0]], [0.0, 1.0]))
    np.testing.assert_allclose(motion.torque.breaks, [0.0, 0.5, 1.0], rtol=1e-12)


# ---- where it is kept


def test_an_actuator_is_the_short_form_of_a_drivetrain() -> None:
    """What the short form does not show, such as Stribeck friction, is not lost on the way through it."""
    robot = arm(replace(STICKY, load_share=0.1))
    again = robot.with_actuators(replace(actuator, rotor_inertia=1e-3) for actuator in robot.actuators)
    assert all(law.is_same(other) for law, other in zip(robot.friction, again.friction, strict=True))
    assert [train.motor.rotor_inertia for train in again.drivetrains] == [1e-3] * 6
    kept = geared().with_actuators(geared().actuators)
    np.testing.assert_array_equal(kept.transmission, geared().transmission)
    with pytest.raises(ps.InputError, match=r"measured_friction already contains .* gearbox.efficiency = 0.8"):
        replace(geared().actuators[0], viscous_friction=1.0)


def test_a_robot_that_knows_nothing_of_its_drives_carries_unknown_drivetrains(tmp_path: Path) -> None:
    (train,) = pendulum(tmp_path).drivetrains
    assert np.isnan([train.ratio, train.motor.rotor_inertia, train.friction.viscous]).all()
    assert not ps.Drivetrain().friction.is_known


def test_limits_of_a_motor_that_is_known_are_kept(puma: ps.Robot) -> None:
    trains = [replace(train, motor=replace(train.motor, max_speed=9.0), max_effort=7.0) for train in puma.drivetrains]
    own = ps.own_drivetrains(puma.with_drivetrains(trains))
    assert {(train.motor.max_speed, train.max_effort, train.motor.name) for train in own[:1]} == {
        (9.0, 7.0, "puma560 joint1")
    }


def test_the_actuator_file_has_the_optional_terms(tmp_path: Path) -> None:
    options = "static_friction = [0.7, -0.6]\nstribeck_velocity = 5.0\nload_share = 0.1\n"
    drive = DRIVE.format(name="swing", ratio=100.0, rotor=1e-4, viscous=0.01, positive=0.4, negative=-0.5)
    robot = pendulum(tmp_path, drives=drive + options)
    assert robot.drivetrains[0].friction.is_same(replace(STICKY, load_share=0.1))
    assert_documented(robot.to_dict())
    (joint,) = robot.to_dict()["joints"]
    assert joint["actuator"]["static_friction"] == [0.7, -0.6]
    assert joint["actuator"]["load_share"] == 0.1
    assert "static +, − [N m]" in robot._repr_html_()
    with pytest.raises(ps.ModelError, match=r"joint 'swing': static = \[0.3, -0.6\] N m with coulomb = \[0.4, -0.5\]"):
        pendulum(tmp_path, drives=drive + options.replace("0.7", "0.3"))
    with pytest.raises(ps.ModelError, match="joint 'swing' stribeck_velocity: expected a number, got 'slow'"):
        pendulum(tmp_path, drives=drive + "stribeck_velocity = 'slow'\n")


def test_static_friction_holds_what_coulomb_friction_would_let_slip(tmp_path: Path) -> None:
    """0.05 rad off its lowest point the pendulum needs 0.49 N m: within the static band, beyond Coulomb's."""
    drive = DRIVE.format(name="swing", ratio=1.0, rotor=0.0, viscous=0.0, positive=0.3, negative=-0.3)
    move = ps.quintic_segments([[0.0], [0.05]], [0.0, 1.0])
    slips = ps.assess(pendulum(tmp_path, drives=drive), move, dwell=1.0)
    held = ps.assess(pendulum(tmp_path, drives=drive + "static_friction = [0.6, -0.6]\n"), move, dwell=1.0)
    assert abs(slips.least_holding_torque[0]) == pytest.approx(abs(slips.holding_torque[0]) - 0.3)
    assert held.least_holding_torque[0] == 0.0
    assert any("swing [-0.6, 0.6]" in remark for remark in held.remarks)


def test_what_scales_a_motion_in_time_says_what_it_does_not_know() -> None:
    move = paper_motion().trajectory
    for friction in (STICKY, ps.Friction(viscous=0.0, coulomb=[0.1, -0.1], load_share=0.1)):
        robot = arm(friction).with_limits(effort=1.0, position=[[-9.0, 9.0]] * 6)
        with pytest.raises(ps.InputError, match=r"knows viscous and Coulomb friction alone; 'joint1', .* 'puma560'"):
            ps.least_stretch(robot, move)
        with pytest.raises(ps.InputError, match="least duration at which torque keeps its limits knows viscous"):
            ps.least_time(ps.septic, POINTS, TIMES, robot=robot, keep=["effort"], restarts=0)


def test_a_motor_without_a_gear_ratio_is_not_sized() -> None:
    """An unknown ratio is no error of the drivetrain, but its motor would have an unknown torque and win."""
    cycle = ps.Cycle(steps=[paper_motion()])
    trains = [*ps.load_drivetrains(cycle.robot)[:4], ps.Drivetrain(), ps.Drivetrain(gearbox=ps.Gearbox(efficiency=0.8))]
    with pytest.raises(ps.InputError, match=r"gear ratio of joint 'joint5', 'joint6' is not known"):
        ps.size(cycle, drivetrains=trains)
    with pytest.raises(ps.InputError, match="gearbox 'G': its ratio is required"):
        ps.Catalogue(motors=[ps.Motor(name="M")], gearboxes=[ps.Gearbox(name="G")])


def test_a_cycle_is_of_one_friction() -> None:
    """What differs in Stribeck friction alone is another arm."""
    robot, other = arm(STICKY), arm(replace(STICKY, stribeck_velocity=6.0))
    move = paper_motion().trajectory
    steps = [ps.compute_motion(robot, move), ps.compute_motion(other, ps.cycle.with_return(paper_motion()).trajectory)]
    with pytest.raises(ps.InputError, match=r"steps\[1\] has other drives"):
        ps.Cycle(steps=steps)


def test_pairs_with_stribeck_friction_are_assessed_in_full() -> None:
    """The bounds are of sums of features, which their torque is not: each is accepted as it is when sized alone."""
    cycle = ps.cycle.with_return(paper_motion(), dwell=0.5)
    own, joint = ps.load_drivetrains(cycle.robot)[1], "joint2"
    laws = [replace(own.measured_friction, static=np.array([k, -k]), stribeck_velocity=3.0) for k in (0.5, 5.0)]
    # All of the least set is known, so that each pair can be decided.
    motor = replace(own.motor, name="M", peak_torque=1.0, continuous_torque=1.0, max_speed=500.0)
    gearbox = replace(own.gearbox, name="G", max_average_torque=500.0, max_repeated_torque=500.0)
    for law, expected in zip(laws, (True, False), strict=True):
        pair = ps.drives.Pair(motor="M", gearbox="G", friction=law, max_effort=own.max_effort)
        catalogue = ps.Catalogue(motors=[motor], gearboxes=[gearbox], pairs=[pair])
        one = ps.size(cycle, catalogue=catalogue).joint(joint)
        trains = [catalogue.drivetrain(0, j) for j in range(6)]
        alone = ps.size(cycle, drivetrains=trains)
        violated = [check for check in alone.violations if check.joint == joint]
        assert (bool(one.is_feasible[0]), not violated) == (expected, expected)
        assert one.n_assessed == 1
        if violated:
            assert one.reasons[0] == violated[0].quantity


# ---- many joints at once, and small loads


def test_the_function_of_many_joints_is_the_sum_of_their_laws() -> None:
    """What a simulation asks at every step: with and without Stribeck's excess, dry friction, any friction at all."""
    viscous, dry = ps.Friction(viscous=0.7), ps.Friction(viscous=0.2, coulomb=[0.4, -0.5])
    v = np.array([[3.0, -0.3, 2.5], [-2.0, 0.0, -1.5]])
    ways = np.sign(v)
    for laws in ([STICKY, viscous, dry], [dry, viscous, dry], [viscous, viscous, viscous], [ps.Friction()] * 3):
        expected = np.column_stack([law.torque(v[:, j], ways[:, j]) for j, law in enumerate(laws)])
        np.testing.assert_allclose(friction_function(laws)(v, ways), expected, rtol=1e-14, atol=1e-16)
        np.testing.assert_allclose(sum(friction_terms(laws, v, ways).values()), expected, rtol=1e-14, atol=1e-16)
        assert [law.excess.shape for law in laws] == [(2,)] * 3


def test_a_load_of_millinewton_metres_is_lost_in_gears_as_any_other() -> None:
    """Rounding is judged by the load itself: 1e-9 N m that changes sign loses 10 % one way, 20 % the other."""
    transmission = np.array([[0.8, 1.0, 0.9]])
    load = Piecewise.from_power([0.0, 1.0], [[[-1e-9]], [[2e-9]]])
    found = loss_along(transmission, load, Piecewise.constant([1.0], 1.0))
    np.testing.assert_allclose(found([0.0, 0.25, 0.75, 1.0]).ravel(), [2e-10, 1e-10, -5e-11, -1e-10], rtol=1e-12)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_what_is_rounding_of_the_arm_s_largest_load_is_not_lost(size: float) -> None:
    """Of two joints the second carries what the fit of the first may leave: no load, no break; a little more is one."""
    transmission = np.array([[0.8, 1.0, 0.9]] * 2)
    for part, breaks in ((0.9e-11, [0.0, 1.0]), (1.1e-11, [0.0, 0.5, 1.0])):
        load = Piecewise.from_power([0.0, 1.0], [[[size, -part * size]], [[0.0, 2 * part * size]]])
        found = loss_along(transmission, load, Piecewise.constant([1.0, 1.0], 1.0))
        np.testing.assert_allclose(found.breaks, breaks, rtol=1e-12)
        np.testing.assert_allclose(
            found(1.0), [-0.1 * size, 0.0 if len(breaks) == 2 else -0.1 * part * size], rtol=1e-9
        )
