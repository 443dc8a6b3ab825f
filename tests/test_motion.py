"""Torque and power along a trajectory: exact peaks, root mean squares, steps, and the traps on the way."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from helpers.arms import branched_arm, joint, link, load, panda, pendulum, ur5
from helpers.moves import POINTS, PROFILES, TIMES, paper_move, parabolic_blends, random_move
from helpers.sampled import quadrature, refined_peak, reversals, torque_with_friction
from hypothesis import given, settings
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.dynamics import TERMS
from puma_septic.motion import joined
from puma_septic.validation import Array

# What a motion promises: the fit stops at 1e-11 of each joint's largest torque, the rest is room.
EXACT = 1e-9


def rms_torque(motion: ps.Motion) -> Array:
    return np.sqrt(motion.torque.inner(motion.torque) / motion.trajectory.duration)


def assert_exact(motion: ps.Motion, *, count: int, panels: int) -> None:
    """Peak and RMS torque of every joint against samples refined locally and Gauss quadrature.

    A joint whose torque is below the rounding of the largest one's, as where gravity does not act on it, is held to
    that rounding: its torque is a difference of the others'.
    """
    torque, breaks = torque_with_friction(motion.robot, motion.trajectory)
    peak = refined_peak(torque, breaks, count)
    rms = np.sqrt(quadrature(lambda t: torque(t) ** 2, breaks, panels) / motion.trajectory.duration)
    rounding = 1e-13 * peak.max()
    assert (np.abs(motion.torque.extrema().peak - peak) <= EXACT * peak + rounding).all()
    assert (np.abs(rms_torque(motion) - rms) <= EXACT * rms + rounding).all()


# ---- exactness


@pytest.mark.parametrize(("profile", "evaluations"), [("septic", 200), ("lspb", 800), ("quintic_segments", 800)])
def test_peak_and_rms_torque_of_the_paper_s_move_are_exact(puma: ps.Robot, profile: str, evaluations: int) -> None:
    motion = ps.compute_motion(puma, paper_move(profile))
    assert motion.n_evaluations <= evaluations
    # A million samples of the septic's whole; as dense on the others, which have more intervals.
    assert_exact(motion, count=200_000 if profile == "septic" else 20_000, panels=200)


@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(k, marks=pytest.mark.slow) for k in range(3, 10))])
def test_random_moves_of_random_branched_arms_are_exact(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    arm = branched_arm(tmp_path, rng, int(rng.integers(2, 9)))
    for _ in range(5):
        assert_exact(ps.compute_motion(arm, random_move(rng, arm.n_joints)), count=1000, panels=30)


@pytest.mark.parametrize("make", [ur5, panda])
def test_random_moves_of_ur5_and_panda_are_exact(make) -> None:  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(7)
    arm = make()
    # Neither file knows the drives; friction is made up, so that reversals count.
    drives = [ps.Actuator(gear_ratio=100.0, rotor_inertia=5e-5, viscous_friction=1e-4, coulomb_friction=[0.01, -0.02])]
    arm = arm.with_actuators(drives * arm.n_joints)
    for _ in range(8):
        assert_exact(ps.compute_motion(arm, random_move(rng, arm.n_joints)), count=1000, panels=30)


def test_the_torque_is_the_inverse_dynamics_at_every_instant(puma: ps.Robot) -> None:
    loaded = puma.with_payload(ps.Payload(mass=2.5, com=[0, 0, 0.1])).with_wrench(
        ps.Wrench(force=[5, 0, -3], torque=[0, 1, 0], axes="tool")
    )
    for profile in ("septic", "lspb", "quintic_segments"):
        trajectory = paper_move(profile)
        motion = ps.compute_motion(loaded, trajectory)
        t = np.random.default_rng(1).uniform(*trajectory.breaks[[0, -1]], 3000)
        expected = ps.inverse_dynamics(loaded, *(trajectory(t, order) for order in range(3)))
        np.testing.assert_allclose(motion.torque(t), expected, rtol=0, atol=1e-8)


# ---- the traps of friction


def test_double_zeros_of_the_velocity_at_both_ends_are_no_reversals(puma: ps.Robot) -> None:
    """A root finder on the velocity of the paper's septic returned 8.9999995 s as a reversal, with a wrong sign after.

    Position, velocity and acceleration are given at both ends, so the velocity has a double zero there.
    """
    motion = ps.compute_motion(puma, paper_move("septic"))
    # Joints 1 and 6 reverse once near each end of the turn, 2, 3 and 5 once at the middle.
    inner = motion.torque.breaks[1:-1]
    found = reversals(lambda t: paper_move("septic")(t, 1)[:, [0, 1, 2, 4, 5]], TIMES[[0, -1]])
    np.testing.assert_allclose(inner, found, rtol=0, atol=1e-9)
    assert inner.min() > 1.0
    assert inner.max() < 8.0
    # Just inside both ends every moving joint has the friction of its direction.
    for t, later in ((1e-6, 0.05), (9 - 1e-6, 9 - 0.05)):
        sign = np.sign(paper_move("septic")(later, 1))
        np.testing.assert_array_equal(
            motion.torque_terms.coulomb(t), np.where(sign > 0, *puma.coulomb_friction.T) * (sign != 0)
        )


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("noise", [0.0, 1e-16, 4.4e-16])
def test_a_joint_whose_points_agree_to_rounding_is_still(puma: ps.Robot, profile: str, noise: float) -> None:
    """Joint 4 rests at -pi on the paper's move; inverse kinematics gives -pi and its neighbours, in some order.

    Sampled differences of 4e-16 rad made its Coulomb friction chatter between 0.85 and -1.29 N m.
    """
    points = POINTS.copy()
    points[:, 3] = -np.pi + noise * np.array([0.0, 1.0, -1.0, 1.0])
    make = {
        "septic": lambda: ps.septic(points, TIMES),
        "lspb": lambda: ps.lspb(points, durations=np.diff(TIMES), blend_time=1.0),
        "quintic_segments": lambda: ps.quintic_segments(points, TIMES),
    }[profile]
    motion = ps.compute_motion(puma, make())
    assert motion.still[:, 3].all()
    assert not motion.still[:, 0].all()
    np.testing.assert_array_equal(motion.torque_terms.coulomb.coefficients[:, :, 3], 0.0)
    assert motion.torque.extrema().peak[3] < 0.01


def test_a_joint_that_rests_between_two_moves_is_still_there_only(puma: ps.Robot) -> None:
    """On the paper's quintic segments joints 2, 3 and 5 wait from 2 to 6 s, joints 1 and 6 before and after."""
    motion = ps.compute_motion(puma, paper_move("quintic_segments"))
    np.testing.assert_array_equal(motion.torque.breaks, TIMES)
    waits = np.zeros((3, 6), dtype=bool)
    waits[[0, 2], 0] = waits[[0, 2], 5] = waits[1, [1, 2, 4]] = waits[:, 3] = True
    np.testing.assert_array_equal(motion.still, waits)
    coulomb = motion.torque_terms.coulomb
    np.testing.assert_array_equal(coulomb(1.0)[[0, 3, 5]], 0.0)
    np.testing.assert_array_equal(coulomb(4.0)[[1, 2, 3, 4]], 0.0)
    np.testing.assert_allclose(coulomb(4.0)[[0, 5]], puma.coulomb_friction[[0, 5], 1], rtol=1e-15)


def test_friction_has_the_sign_of_mid_interval_beside_every_reversal(puma: ps.Robot) -> None:
    """Where a reversal falls between two times, the sign was once taken at the split itself, where it is rounding."""
    motion = ps.compute_motion(puma, paper_move("septic"))
    coulomb = motion.torque_terms.coulomb
    for t in motion.torque.breaks[1:-1]:
        for side in (t - 1e-9, t + 1e-9):
            speed = paper_move("septic")(side, 1)
            speed[3] = 0.0
            expected = ps.torque_terms(puma, POINTS[0], speed, np.zeros(6)).coulomb
            np.testing.assert_allclose(coulomb(side), expected, rtol=1e-15)


def test_a_peak_may_stand_on_one_side_of_a_reversal(tmp_path: Path) -> None:
    """Slowing down before a reversal, friction helps; the supremum is the left-hand limit, which no sample reaches.

    A pendulum lifted to the horizontal and lowered again: at the top gravity takes m g l = 9.81 N m, friction adds 5
    before it and takes 5 off after it; the motion is so slow that nothing else counts.
    """
    drives = "[parameters.test.joints.swing]\ngear_ratio = 100.0\nrotor_inertia = 0.0\nviscous_friction = 0.0\n"
    arm = pendulum(tmp_path, drives=drives + "coulomb_friction = [0.05, -0.05]\n")
    move = ps.quintic_segments([[0.0], [np.pi / 2], [0.0]], [0.0, 1e5, 2e5])
    extrema = ps.compute_motion(arm, move).torque.extrema()
    # Acceleration is 5.77 h / T^2 = 9e-10 rad/s^2, times 0.5 kg m^2; it is zero at the top.
    np.testing.assert_allclose([extrema.max[0], extrema.t_max[0]], [9.81 + 5, 1e5], rtol=1e-9)


def test_a_tiny_torque_is_as_exact_as_a_large_one(puma: ps.Robot) -> None:
    """The fit once stopped when its tail was small beside joint 2's 60 N m; joint 6's 1e-5 N m was then noise."""
    bare = [ps.Actuator()] * 6
    motion = ps.compute_motion(puma.with_actuators(bare), paper_move("septic"))
    torque, breaks = torque_with_friction(motion.robot, motion.trajectory)
    peak = refined_peak(torque, breaks, 20_000)
    assert peak.min() < 1e-4 * peak.max()
    np.testing.assert_allclose(motion.torque.extrema().peak, peak, rtol=EXACT)


# ---- steps


def test_a_step_in_acceleration_makes_the_torque_step_and_the_jerk_infinite(tmp_path: Path) -> None:
    """Blends of 1 s to 0.5 rad/s on a weightless pendulum: m l^2 a = 0.5 * 0.5 N m, then none, then its negative."""
    arm = pendulum(tmp_path, gravity=(0.0, 0.0, 0.0))
    move = parabolic_blends(np.array([0.0, 3.0]), np.array([[0.0], [1.0]]), 1.0)
    motion = ps.compute_motion(arm, move)
    np.testing.assert_allclose(motion.torque([0.5, 1.5, 2.5])[:, 0], [0.25, 0.0, -0.25], rtol=0, atol=1e-14)
    np.testing.assert_allclose(motion.torque.jumps().sizes[:, 0], [-0.25, -0.25], rtol=1e-12)
    assert move.peak(3)[0].tolist() == [np.inf]
    assert_exact(motion, count=100, panels=2)


# ---- laws


@settings(max_examples=8)
@given(seed=st.integers(0, 2**32 - 1), mass=st.floats(0, 5))
def test_work_without_friction_is_the_change_of_energy(seed: int, mass: float) -> None:
    """Rest to rest the kinetic energy is nothing; half way it is half v M v, rotors included."""
    rng = np.random.default_rng(seed)
    drives = [
        ps.Actuator(gear_ratio=x.gear_ratio, rotor_inertia=x.rotor_inertia, viscous_friction=0, coulomb_friction=[0, 0])
        for x in ps.load_robot().actuators
    ]
    robot = ps.load_robot().with_actuators(drives).with_payload(ps.Payload(mass=mass, com=[0, 0.1, 0.2]))
    trajectory = random_move(rng, 6)
    motion = ps.compute_motion(robot, trajectory)
    t = trajectory.breaks[0] + trajectory.duration * rng.uniform(0.1, 1)
    q, v = trajectory([trajectory.breaks[0], t]), trajectory([trajectory.breaks[0], t], 1)
    # Pinocchio's own kinetic energy with rotors by hand, whatever it thinks of armatures.
    model = robot.model.copy()
    model.armature = np.zeros(6)
    energy = [
        pin.computeKineticEnergy(model, model.createData(), *state)
        + pin.computePotentialEnergy(model, model.createData(), state[0])
        + 0.5 * robot.armature @ state[1] ** 2
        for state in zip(q, v, strict=True)
    ]
    work = motion.power.integral()(t).sum()
    assert work == pytest.approx(energy[1] - energy[0], abs=1e-8 * max(1.0, np.abs(energy).max()))


@settings(max_examples=8)
@given(stretch=st.floats(1.1, 10))
def test_stretching_time_divides_the_dynamic_torque_by_its_square(stretch: float) -> None:
    """``tau(k) = g + (tau - g) / k^2`` without friction (Hollerbach 1984), and viscous friction falls as 1/k."""
    robot = ps.load_robot()
    slow = ps.compute_motion(robot, ps.septic(POINTS, TIMES * stretch)).torque_terms
    fast = ps.compute_motion(robot, paper_move("septic")).torque_terms
    t = np.linspace(0, 9, 40)
    for name, power in {"gravity": 0, "coulomb": 0, "viscous": 1, "inertia": 2, "coriolis": 2, "rotor": 2}.items():
        before, after = getattr(fast, name)(t[1:-1]), getattr(slow, name)(stretch * t[1:-1])
        np.testing.assert_allclose(after, before / stretch**power, rtol=0, atol=1e-8)


def test_the_split_sums_to_the_torque_on_the_whole_span(puma: ps.Robot) -> None:
    robot = puma.with_payload(ps.Payload(mass=1.0)).with_wrench(ps.Wrench(force=[1, 2, 3], torque=[0, 0, 1]))
    motion = ps.compute_motion(robot, paper_move("lspb"))
    terms = motion.torque_terms
    t = np.linspace(0, 9, 500)
    np.testing.assert_allclose(sum(getattr(terms, name)(t) for name in TERMS), motion.torque(t), rtol=0, atol=1e-8)
    np.testing.assert_allclose(terms.total(t), motion.torque(t), rtol=0, atol=1e-8)


def test_power_is_torque_times_velocity(puma: ps.Robot) -> None:
    motion = ps.compute_motion(puma, paper_move("lspb"))
    t = np.linspace(0, 9, 501)
    np.testing.assert_allclose(motion.power(t), motion.torque(t) * paper_move("lspb")(t, 1), rtol=0, atol=1e-11)


def test_a_payload_changes_its_own_term_and_no_other(puma: ps.Robot) -> None:
    empty, loaded = (
        ps.compute_motion(robot, paper_move("septic")).torque_terms
        for robot in (puma, puma.with_payload(ps.Payload(mass=2.5, com=[0, 0, 0.1])))
    )
    t = np.linspace(0, 9, 50)
    for name in TERMS:
        same = np.allclose(getattr(empty, name)(t), getattr(loaded, name)(t), rtol=0, atol=1e-9)
        assert same == (name != "payload"), name


@pytest.mark.parametrize("profile", PROFILES)
def test_no_coefficients_are_carried_that_nobody_could_tell(puma: ps.Robot, profile: str) -> None:
    """Between reversals the torque needs fewer than the fit over all of them."""
    torque = ps.compute_motion(puma, paper_move(profile)).torque
    assert torque.trimmed(1e-13).degree == torque.degree


def test_the_same_motion_twice_is_the_same_to_the_last_bit(puma: ps.Robot) -> None:
    one, two = (ps.compute_motion(puma, paper_move("lspb")) for _ in range(2))
    np.testing.assert_array_equal(one.torque.coefficients, two.torque.coefficients)


def test_motions_one_after_the_other_keep_their_own_loads(puma: ps.Robot) -> None:
    """Out with 2 kg, back without: each half has the torque, terms and direction of its own motion."""
    out = ps.quintic_segments(POINTS[[0, 3]], [5.0, 7.0])
    back = ps.quintic_segments(POINTS[[3, 0]], [1.0, 4.0])
    one = ps.compute_motion(puma.with_payload(ps.Payload(mass=2.0, com=[0, 0, 0.1])), out)
    two = ps.compute_motion(puma, back)
    both = joined([one, two], ps.quintic_segments(POINTS[[0, 3, 0]], [0.0, 2.0, 5.0]))
    t = np.linspace(0.01, 1.99, 40)
    for name in ("torque", "coulomb", "direction"):
        for part, start, late in ((one, 5.0, 0.0), (two, 1.0, 2.0)):
            expected = getattr(part, name)(t + start)
            np.testing.assert_allclose(getattr(both, name)(t + late), expected, rtol=0, atol=1e-9)
    for name in TERMS:
        terms = getattr(both.torque_terms, name)
        np.testing.assert_allclose(terms(t), getattr(one.torque_terms, name)(t + 5.0), rtol=0, atol=1e-9)
        np.testing.assert_allclose(terms(t + 2.0), getattr(two.torque_terms, name)(t + 1.0), rtol=0, atol=1e-9)
    assert both.n_evaluations == one.n_evaluations + two.n_evaluations
    assert both.robot.payload is one.robot.payload
    assert both.parts == (one, two)


def test_an_arm_at_rest_holds_its_weight_and_a_brake_does_it_for_the_motors(tmp_path: Path) -> None:
    """A pendulum stopped at the horizontal: m g l = 9.81 N m by the motor, and none by it under a brake."""
    motion = ps.compute_motion(pendulum(tmp_path), ps.quintic_segments([[0.0], [np.pi / 2]], [3.0, 4.0]))
    rest = motion.rest(2.5)
    assert (rest.duration, rest.torque.duration, rest.is_braked) == (2.5, 2.5, False)
    assert rest.position(1.0) == pytest.approx([np.pi / 2], rel=1e-15)
    assert rest.holding_torque == pytest.approx([9.81], rel=1e-14)
    for held, torque in ((rest, 9.81), (replace(rest, is_braked=True), 0.0)):
        assert (held.load(1.0)[0], held.torque(1.0)[0]) == pytest.approx((9.81, torque), rel=1e-14)


def test_signals_are_what_their_names_say(puma: ps.Robot) -> None:
    """The torque's rate is that of the torque without dry friction, which steps."""
    motion, t = ps.compute_motion(puma, paper_move("septic")), np.linspace(0.1, 8.9, 50)
    for order, name in enumerate(("position", "velocity", "acceleration", "jerk")):
        np.testing.assert_array_equal(motion.signal(name)(t), motion.trajectory(t, order))
    assert motion.signal("effort") is motion.torque
    h = 1e-4
    around = [(motion.torque - motion.coulomb)(t + side) for side in (-h, h)]
    expected = (around[1] - around[0]) / (2 * h)
    np.testing.assert_allclose(motion.signal("torque_rate")(t), expected, rtol=0, atol=1e-5)
    with pytest.raises(ps.InputError, match="unknown quantity 'force'; valid: 'position', 'velocity'"):
        motion.signal("force")


# ---- what is refused


def test_joints_that_do_not_match_are_named(puma: ps.Robot) -> None:
    with pytest.raises(ps.InputError, match=r"trajectory has 2 joints, robot 'puma560' has 6: joint1, joint2"):
        ps.compute_motion(puma, ps.quintic_segments([[0, 0], [1, 1]], [0, 1]))
    swapped = ("joint2", "joint1", *puma.joint_names[2:])
    message = "joints joint2, joint1.*are not those of robot 'puma560', joint1, joint2.*order"
    with pytest.raises(ps.InputError, match=message):
        ps.compute_motion(puma, ps.septic(POINTS, TIMES, joint_names=swapped))
    assert ps.compute_motion(puma, ps.septic(POINTS, TIMES, joint_names=puma.joint_names)).n_evaluations > 0


def test_a_robot_and_a_trajectory_are_needed_in_this_order() -> None:
    move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 1.0])
    with pytest.raises(ps.InputError, match="a robot and a trajectory are needed, got Trajectory and Robot"):
        ps.compute_motion(move, ps.load_robot())  # type: ignore[arg-type]


@pytest.mark.parametrize(("lifted", "message"), [(1e3, r"'swing' swings from -1e\+07 to 0 rad"),
                                                 (2e7, r"'lift' swings from 5 to 2e\+07 m")])  # fmt: skip
def test_the_joint_that_swings_most_is_named_with_its_unit(tmp_path: Path, lifted: float, message: str) -> None:
    """A pendulum on a lift: the lift moves up, the pendulum to angles below zero."""
    body = '<link name="base"/>' + link("cabin", 3.0, [0.0, 0.0, 0.0], np.zeros((3, 3)))
    body += link("bob", 2.0, [0.5, 0.0, 0.0], np.zeros((3, 3)))
    body += joint("lift", "prismatic", "base", "cabin", [0, 0, 0], [0, 0, 1])
    body += joint("swing", "continuous", "cabin", "bob", [0, 0, 0], [0, 1, 0])
    move = ps.quintic_segments([[5.0, 0.0], [lifted, -1e7]], [0.0, 3.0])
    with pytest.raises(ps.InputError, match=rf"cannot be resolved: joint {message} in 3 s; check the points and"):
        ps.compute_motion(load(tmp_path, "lifted", body), move)


def test_a_swing_whose_torque_cannot_be_resolved_is_named() -> None:
    """1.6 million turns in 3 s: it was once said not to be smooth, and to need a break."""
    move = ps.quintic_segments([[0.0] * 6, [1e7] * 6], [0.0, 3.0])
    with pytest.raises(ps.InputError, match=r"cannot be resolved: joint 'joint\d' swings from 0 to 1e\+07 rad in 3 s"):
        ps.compute_motion(ps.load_robot(), move)
