"""A simulated arm under a controller: what must hold of a perfect model, of energy, of steps, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from helpers.arms import joint, link, load, panda, ur5
from helpers.places import KINOVA

import puma_septic as ps
from puma_septic.dynamics import acceleration_function
from puma_septic.simulation import LAWS, METRICS, Gains, simulate_all

CONTINUOUS = ps.Controller(law="computed_torque", rate=np.inf)


@cache
def move(duration: float = 0.4) -> ps.Trajectory:
    """Some rad by all joints, well within the limits of torque."""
    return ps.quintic_segments([[0.0] * 6, [0.1, -0.1, 0.1, 0.1, -0.1, 0.2]], [0.0, duration])


@cache
def smooth_arm() -> ps.Robot:
    """The PUMA without friction and torque limits."""
    puma = ps.load_robot()
    rotors = [ps.Actuator(gear_ratio=one.gear_ratio, rotor_inertia=one.rotor_inertia) for one in puma.actuators]
    return puma.with_actuators(rotors).with_limits(effort=np.nan)


def continuous() -> ps.Robot:
    return ps.load_robot(KINOVA, locked="others")


@cache
def followed(law: str, **options: Any) -> ps.Simulation:
    return ps.simulate(ps.load_robot(), move(), controller=ps.Controller(law=law, **options), settle=0.1)


def test_a_perfect_model_leaves_no_error() -> None:
    """Computed torque at each stage, no friction, no saturation: the integrator's error alone, 1e-6 rad at most."""
    result = ps.simulate(smooth_arm(), move(), controller=CONTINUOUS, settle=0.1)
    assert np.abs(result.error).max() < 1e-8


def test_a_sampled_controller_has_an_error_and_it_is_reported() -> None:
    """Torques held for 1 ms lag half a period; the error is proportional to it."""
    slow, fast = (
        ps.simulate(smooth_arm(), move(), controller=ps.Controller(rate=rate), settle=0.0).metrics.peak_error.max()
        for rate in (500.0, 1000.0)
    )
    assert 1e-6 < fast < 1e-3
    assert slow == pytest.approx(2 * fast, rel=0.05)


def test_energy_is_kept_without_friction_and_input() -> None:
    """The PUMA, let go and falling: 1e-8 of the peak kinetic energy at most."""
    result = ps.simulate(smooth_arm(), move(), controller="none", settle=0.4)
    energy = result.energy
    assert energy.kinetic.max() > 10
    assert np.abs(energy.drift).max() < 1e-8 * energy.kinetic.max()
    assert energy.work == pytest.approx(0)
    assert energy.taken == pytest.approx(0)


def test_the_integrator_is_of_order_4() -> None:
    """Half the step leaves a sixteenth of the error of an arm that falls."""
    free = ps.Controller(law="none", rate=np.inf)
    ends = [
        ps.simulate(smooth_arm(), move(), controller=free, settle=0.4, step=step).q[-1]
        for step in (0.02, 0.01, 0.005, 0.00125)
    ]
    errors = [np.abs(end - ends[-1]).max() for end in ends[:3]]
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.3)
    assert errors[1] / errors[2] == pytest.approx(16, rel=0.3)


@pytest.mark.parametrize("payload", [None, ps.Payload(mass=2.0, com=(0.0, 0.0, 0.1))])
def test_forward_dynamics_is_the_inverse_of_assessed_torques(puma: ps.Robot, payload: ps.Payload | None) -> None:
    robot = puma.with_payload(payload).with_wrench(ps.Wrench(force=(5.0, -3.0, 10.0), torque=(0.1, 0.0, 0.2)))
    motion = ps.compute_motion(robot, move())
    t = np.linspace(0.05, 0.35, 40)
    q, v, a = (move()(t, order) for order in range(3))
    assert ps.forward_dynamics(robot, q, v, motion.torque(t)) == pytest.approx(a, abs=1e-9)
    model, data = puma.model, puma.model.createData()
    bare = ps.inverse_dynamics(puma, q, v, a, friction=False)
    by_hand = np.array([pin.aba(model, data, *row).copy() for row in zip(q, v, bare, strict=True)])
    assert by_hand == pytest.approx(a, abs=1e-9)


@pytest.mark.parametrize("arm", [ur5, panda, continuous])
def test_forward_dynamics_of_other_arms(arm: Callable[[], ps.Robot], rng: np.random.Generator) -> None:
    """Seven joints, and continuous ones, which Pinocchio keeps as cosine and sine; also as a simulation calls it."""
    robot = arm()
    q, v, a = rng.uniform(-1.0, 1.0, (3, 5, robot.n_joints))
    tau = ps.inverse_dynamics(robot, q, v, a, friction=False)
    assert ps.forward_dynamics(robot, q, v, tau, friction=False) == pytest.approx(a, abs=1e-9)
    for rows in (slice(0, 1), slice(0, 5)):
        assert acceleration_function(robot)(q[rows], v[rows], tau[rows]) == pytest.approx(a[rows], abs=1e-9)


@pytest.mark.parametrize("law", [law for law in LAWS if law != "none"])
@pytest.mark.slow
def test_half_the_step_changes_no_metric(law: str) -> None:
    """By 1 %, or 1e-9 rad."""
    one, other = (
        followed(law).metrics,
        ps.simulate(ps.load_robot(), move(), controller=law, settle=0.1, step=followed(law).step / 2).metrics,
    )
    for name in METRICS:
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=0.01, abs=1e-9), name


def test_what_a_law_knows_shows_in_its_error() -> None:
    """Gravity, then the whole of the planned torque: each leaves less."""
    errors = [followed(law).metrics.tool_rms_error for law in ("pd", "pd_gravity", "feedforward", "computed_torque")]
    assert errors[0] > errors[1] > 10 * errors[2]
    assert errors[3] < 1e-4
    assert followed("pid").metrics.end_error.max() < followed("pd").metrics.end_error.max() / 3


def test_the_regularisation_of_friction_is_measured() -> None:
    """An arm that would stick creeps: half the speed of regularisation, about half of the difference it makes."""
    by_speed = [
        ps.simulate(ps.load_robot(), move(), controller="pd", settle=0.1, rest_speed=speed).metrics.rms_error
        for speed in (2e-2, 1e-2, 5e-3)
    ]
    first, second = (np.abs(by_speed[k] - by_speed[k + 1]).max() for k in (0, 1))
    assert second < 0.75 * first
    assert first < 0.05 * by_speed[-1].max()


def test_stribeck_friction_makes_an_arm_stick(puma: ps.Robot) -> None:
    """More friction at low speed leaves a larger error at the end of a slow motion."""
    sticky = []
    for train in puma.drivetrains:
        law = train.friction
        sticky.append(replace(train, measured_friction=replace(law, static=1.5 * law.coulomb, stribeck_velocity=1.0)))
    one = followed("pd_gravity").metrics.rms_error
    other = ps.simulate(puma.with_drivetrains(sticky), move(), controller="pd_gravity", settle=0.1).metrics.rms_error
    assert (other > one).all()


def test_saturation_is_measured_and_ends_at_the_limit(puma: ps.Robot) -> None:
    weak = puma.with_limits(effort=0.5 * ps.assess(puma, move()).peak_torque)
    result = ps.simulate(weak, move(), controller="computed_torque", settle=0.1)
    assert result.metrics.saturation_time.max() > 0.01
    assert (np.abs(result.torque) <= weak.limits.effort).all()
    assert result.metrics.peak_error.max() > followed("computed_torque").metrics.peak_error.max()


def test_a_payload_that_the_controller_does_not_know(puma: ps.Robot) -> None:
    loaded = puma.with_payload(ps.Payload(mass=2.5))
    knowing = ps.simulate(loaded, move(), controller="computed_torque", settle=0.1)
    ignorant = ps.simulate(loaded, move(), controller=ps.Controller(model=puma), settle=0.1)
    assert ignorant.metrics.tool_rms_error > 100 * knowing.metrics.tool_rms_error
    akb = ps.simulate(
        ps.load_robot(parameters="akb").with_limits(effort=np.nan),
        move(),
        controller=ps.Controller(law="feedforward", model=puma),
        settle=0.1,
    )
    assert akb.metrics.peak_error.max() > 1e-3


def test_encoders_filters_and_delays_cost_accuracy() -> None:
    plain = followed("feedforward").metrics
    coarse = followed("feedforward", encoder_resolution=1e-4, velocity_filter=50.0).metrics
    late = followed("feedforward", delay=0.005).metrics
    assert coarse.chattering.max() > plain.chattering.max() + 1
    assert late.rms_error.max() > plain.rms_error.max()


def test_the_same_inputs_give_the_same_samples_alone_or_side_by_side(puma: ps.Robot) -> None:
    """To the last bit if asked for again; side by side another of Pinocchio's functions rounds differently."""
    shorter = move(0.3)
    alone = [ps.simulate(puma, one, controller="pd_gravity", settle=0.1) for one in (move(), shorter)]
    again = ps.simulate(puma, move(), controller="pd_gravity", settle=0.1)
    assert np.array_equal(again.q, alone[0].q)
    assert np.array_equal(again.torque, alone[0].torque)
    beside = simulate_all(puma, [move(), shorter], controller="pd_gravity", settle=0.1)
    for one, other in zip(alone, beside, strict=True):
        assert other.q == pytest.approx(one.q, abs=1e-11)
        assert other.torque == pytest.approx(one.torque, abs=1e-6)
        assert one.settle == pytest.approx(0.1)


def test_rows_have_the_gains_of_their_own_first_points(puma: ps.Robot) -> None:
    """Once all rows had those of the first one, so that an arm tracked otherwise beside another than alone."""
    folded = np.add(move().points, [0.0, -0.4, 0.6, 0.0, 0.5, 0.0])
    other = ps.quintic_segments(folded, [0.0, 0.4])
    alone = ps.simulate(puma, other, controller="pd", settle=0.0)
    beside = simulate_all(puma, [move(), other], controller="pd", settle=0.0)[1]
    assert beside.q == pytest.approx(alone.q, abs=1e-11)


def test_unstable_gains_diverge_and_the_part_until_then_is_kept(puma: ps.Robot) -> None:
    """Gains of 1e6 at 100 Hz: reported with time, joint and value, not raised."""
    wild = Gains(np.full(6, 1e6), np.full(6, 1e5), np.zeros(6))
    result = ps.simulate(
        puma.with_limits(effort=np.nan), move(), controller=ps.Controller(law="pd", rate=100.0, gains=wild)
    )
    lost = result.divergence
    assert lost is not None
    assert lost.joint in puma.joint_names
    assert abs(lost.error) > np.pi
    assert 0 < len(result.t) == round(lost.time * 100)
    assert result.to_dict()["run"]["metrics"]["peak_error"] is None
    assert f"Diverged at t = {lost.time:.4g} s: joint {lost.joint!r} is" in str(result)


def test_an_arm_beside_one_that_diverges_goes_on(puma: ps.Robot) -> None:
    weak = puma.with_payload(ps.Payload(mass=20.0))
    far = ps.quintic_segments([[0.0] * 6, [6.0] * 6], [0.0, 1.2])
    still = ps.quintic_segments([[0.0, np.pi / 2, -np.pi / 2, 0.0, 0.0, 0.0]] * 2, [0.0, 1.2])
    fallen, standing = simulate_all(weak, [far, still], controller="computed_torque", settle=0.0)
    assert fallen.has_diverged
    assert standing.t[-1] == pytest.approx(1.2)


def test_elastic_gears_swing_at_their_frequency_after_the_end() -> None:
    """A joint on its own spring: 12 Hz by the period between zero crossings of its deflection."""
    robot = smooth_arm()
    elastic = ps.ElasticJoints.of_frequency(robot, move().points[1], 12.0, damping_ratio=0.0)
    quick = ps.quintic_segments([[0.0] * 6, [0.0, 0.0, 0.1, 0.0, 0.0, 0.0]], [0.0, 0.1])
    elastic = ps.ElasticJoints.of_frequency(robot, quick.points[1], 12.0, damping_ratio=0.0)
    stiff = replace(elastic, stiffness=elastic.stiffness * [1, 1, 1, 100, 100, 100])
    result = ps.simulate(robot, quick, controller="computed_torque", elastic=stiff, settle=0.4)
    assert result.metrics.residual_vibration[2] > 1e-4
    assert np.abs(result.energy.drift).max() < 1e-6 * result.energy.kinetic.max()
    deflection = (result.q - result.motor_q)[result.t > 0.1, 2]
    deflection = deflection - deflection.mean()
    crossings = np.flatnonzero(np.diff(np.sign(deflection)))
    frequency = (len(crossings) - 1) / 2 / ((crossings[-1] - crossings[0]) / result.rate)
    modes = ps.vibration.natural_frequencies(robot, quick.points[1], stiff.stiffness)
    assert frequency == pytest.approx(modes[np.argmin(np.abs(modes - 12))], rel=0.25)


def test_joints_that_mimic_have_the_accelerations_of_their_torques(tmp_path: Path) -> None:
    """Pinocchio's articulated-body algorithm knows no mimics; the composite-rigid-body algorithm adds to what its data
    hold, so that a second posture would have the inertia of the first one too."""
    body = np.diag([0.02, 0.02, 0.01])
    text = "".join(link(name, 2.0, [0.0, 0.05, 0.15], body) for name in ("base", "one", "two"))
    text += joint("j1", "revolute", "base", "one", [0, 0, 0.3], [0, 1, 0])
    follower = joint("j2", "revolute", "one", "two", [0, 0, 0.3], [0, 1, 0])
    text += follower.replace("</joint>", '<mimic joint="j1" multiplier="-0.5"/></joint>')
    arm = load(tmp_path, "coupled", text)
    q, v, a = np.array([[[0.3], [-0.4]], [[1.0], [2.0]], [[3.0], [-5.0]]])
    assert arm.mimics
    assert ps.forward_dynamics(arm, q, v, ps.inverse_dynamics(arm, q, v, a)) == pytest.approx(a, abs=1e-9)
    swing = ps.quintic_segments([[0.0], [0.5]], [0.0, 0.5])
    result = ps.simulate(arm, swing, controller=CONTINUOUS, settle=0.0, step=2e-3)
    assert np.abs(result.error).max() < 1e-8


def test_bad_input(puma: ps.Robot) -> None:
    lossy = puma.with_drivetrains(
        [replace(train, measured_friction=replace(train.friction, load_share=0.2)) for train in puma.drivetrains]
    )
    springs = ps.ElasticJoints(stiffness=[1e3], damping=[0.0])
    six = ps.ElasticJoints(stiffness=[1e3] * 6, damping=[0.0] * 6)
    unknown_rotors = puma.with_actuators([ps.Actuator()] * 6)
    for wrong, message in (
        (lambda: ps.simulate(puma, move(), controller="pdd"), r"unknown controller 'pdd'; valid: 'none', 'pd', .*"),
        (lambda: ps.simulate(puma, move(), controller=3), r"expected a Controller or one of 'none', .* got 3"),
        (
            lambda: ps.simulate(puma, move(), controller=ps.Controller(rate=333.0)),
            r"rate = 333 Hz: the motion of 0.4 s is 133.2 control periods, .* 332.5 Hz and 335 Hz divide it",
        ),
        (
            lambda: ps.simulate(puma, move(), controller=ps.Controller(rate=1000.0, delay=0.0015)),
            r"delay = 0.0015 s is 1.5 control periods of 0.001 s; it must be a whole number",
        ),
        (lambda: ps.Controller(rate=np.inf, delay=0.001), r"has no delay, encoder or filter; give it a rate"),
        (lambda: ps.Controller(bandwidth=0.0), r"bandwidth = 0 Hz must be greater than 0"),
        (lambda: ps.Controller(encoder_resolution=-1e-4), r"encoder_resolution = -0.0001 rad must be at least 0"),
        (lambda: ps.Controller(model="puma"), r"model: expected a Robot, got str"),
        (lambda: simulate_all(puma, []), r"a simulation needs at least one trajectory"),
        (
            lambda: ps.simulate(puma, move(), controller=ps.Controller(gains=Gains([1.0], [1.0], [0.0]))),
            r"proportional gain: shape \(1,\) is not \(6,\)",
        ),
        (
            lambda: ps.simulate(puma, move(), controller=ps.Controller(bandwidth=[1.0, 2.0])),
            r"bandwidth: 2 values given, robot 'puma560' has 6 joints",
        ),
        (lambda: ps.simulate(puma, move(), step=0.01), r"step = 0.01 s: friction at rest or the springs need at most"),
        (lambda: ps.simulate(puma, move(), settle=-1.0), r"settle = -1 s must be at least 0 s"),
        (lambda: ps.simulate(lossy, move()), r"knows no gears that lose a part of their load"),
        (lambda: ps.simulate(puma, move(), elastic=springs), r"elastic joints: 1 given, robot 'puma560' has 6"),
        (
            lambda: ps.simulate(unknown_rotors, move(), elastic=six),
            r"need the rotor's inertia of every joint; .* joint1",
        ),
        (
            lambda: ps.ElasticJoints(stiffness=[1e3, -5.0], damping=[0.0, 0.0]),
            r"stiffness\[1\] = -5 N m/rad must be greater than 0",
        ),
        (
            lambda: ps.ElasticJoints(stiffness=[1e3], damping=[-1.0]),
            r"damping\[0\] = -1 N m s/rad must be at least 0",
        ),
        (
            lambda: ps.forward_dynamics(lossy, [0.0] * 6, [0.0] * 6, [0.0] * 6),
            r"forward dynamics knows no gears that lose a part of their load",
        ),
        (
            lambda: ps.simulate(puma, ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0])),
            r"the trajectory has 1 joints, robot 'puma560' has 6",
        ),
        (
            lambda: ps.simulate(puma, move(), controller=ps.Controller(model=ps.load_robot("ur5"))),
            "the controller's model 'ur5.*' has the joints shoulder_pan_joint, .*, the arm 'puma560' joint1, ",
        ),
        (
            lambda: simulate_all(puma, [move()], elastic=2 * [ps.ElasticJoints(stiffness=[1e3], damping=[1.0])]),
            "elastic: 2 given for 1 trajectories",
        ),
    ):
        with pytest.raises(ps.InputError, match=message):
            wrong()
