"""Sizing as a whole: the PUMA's cycle against samples, closed forms on a real arm, published limits, the report."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from helpers.arms import DRIVE, joint, link, load
from helpers.duty import LOAD, paper_motion
from hypothesis import given, settings
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._torque_speed import torque_at_speed

# Series are fitted to 1e-11 of each joint's largest torque; the rest is room.
EXACT = 1e-9
SAMPLES = 1_000_000

# Invented parts, strong enough or not: only their numbers matter here.
CURVE = np.array([[0.0, 1.5], [40.0, 1.4], [90.0, 0.5], [120.0, 0.1]])
MOTOR = ps.Motor(
    rotor_inertia=3e-4,
    coulomb_friction=0.02,
    viscous_friction=2e-4,
    torque_constant=0.2,
    resistance=1.3,
    peak_curve=CURVE,
    continuous_torque=0.6,
    max_winding_celsius=130.0,
    thermal_resistances=[0.8, 1.1],
    thermal_time_constants=[12.0, 300.0],
)
GEARBOX = ps.Gearbox(ratio=-80.0, efficiency=0.75, backward_efficiency=0.6, inertia=1e-4, no_load_torque=0.01)


@cache
def paper_cycle() -> ps.Cycle:
    """There with 2.5 kg, back with nothing, half a second at either end."""
    return ps.cycle.with_return(paper_motion(loaded=True), dwell=0.5, robot_back=ps.load_robot())


@cache
def candidate(motor: ps.Motor = MOTOR) -> ps.Sizing:
    drive = ps.Drive(storable_energy=5.0)
    train = ps.Drivetrain(motor=motor, gearbox=GEARBOX, drive=drive, ambient_celsius=30.0)
    return ps.size(paper_cycle(), drivetrains=[train] * 6)


# The samples have one resistance; how it grows with the winding's own temperature is tested with the electric motor.
COLD = replace(MOTOR, max_winding_celsius=np.nan, thermal_resistances=[], thermal_time_constants=[])
ELECTRIC = ("drawn", "returned", "peak_drawn_power", "peak_returned_power", "peak_voltage")


# ---- two ways: a million samples


@cache
def sampled(count: int) -> dict[str, np.ndarray]:
    """Metrics of joints 1 to 3 by midpoint sums in plain NumPy, from inverse dynamics alone, shape (3,) each."""
    cycle, blank = paper_cycle(), (ps.robot.Actuator(),) * 6
    dt = cycle.duration / count
    t = (np.arange(count) + 0.5) * dt
    q, v, a = (cycle.trajectory(t, order) for order in range(3))
    bare = ps.load_robot().with_actuators(blank)
    loaded = t < 9.5
    tau = np.concatenate(
        [
            ps.inverse_dynamics(bare.with_payload(LOAD), q[loaded], v[loaded], a[loaded]),
            ps.inverse_dynamics(bare, q[~loaded], v[~loaded], a[~loaded]),
        ]
    )[:, :3]
    moving = ((t < 9.0) | ((t >= 9.5) & (t < 18.5)))[:, None]
    v, a = np.where(moving, v[:, :3], 0.0), a[:, :3]
    n, power = 80.0, tau * v
    passed = np.where(power > 0, 1 / 0.75, np.where(power < 0, 0.6, 1.0))
    motor = 4e-4 * n * a + tau * passed / n + 2e-4 * n * v + 0.03 * np.sign(v)
    electric = motor * n * v + 1.3 * (motor / 0.2) ** 2
    # The curve's limit, and none beyond its end.
    use = np.abs(motor) / np.interp(np.abs(n * v), *CURVE.T)
    return {
        "rms_torque": np.sqrt((motor**2).mean(axis=0)),
        "mean_speed": np.abs(n * v).mean(axis=0),
        "average_load_torque": ((np.abs(v) * np.abs(tau) ** 3).sum(axis=0) / np.abs(v).sum(axis=0)) ** (1 / 3),
        "drawn": np.maximum(electric, 0).sum(axis=0) * dt,
        "returned": np.maximum(-electric, 0).sum(axis=0) * dt,
        "given": np.maximum(motor * n * v, 0).sum(axis=0) * dt,
        "peak_torque": np.abs(motor).max(axis=0),
        "peak_speed": np.abs(n * v).max(axis=0),
        "peak_power": np.abs(motor * n * v).max(axis=0),
        "peak_drawn_power": electric.max(axis=0),
        "peak_returned_power": (-electric).max(axis=0),
        "peak_voltage": np.abs(1.3 / 0.2 * motor + 0.2 * n * v).max(axis=0),
        "peak_load_torque": np.abs(tau).max(axis=0),
        "use": use.max(axis=0),
    }


def exact(name: str) -> np.ndarray:
    demands = (candidate(COLD) if name in ELECTRIC else candidate()).demands[:3]
    if name in ("drawn", "returned"):
        return np.array([d.electric_energy[name == "returned"] for d in demands])
    if name == "given":
        return np.array([d.work[0] for d in demands])
    if name == "use":
        return np.array([torque_at_speed(d.motor, CURVE)[0] for d in demands])
    values = [getattr(d, name) for d in demands]
    return np.array([value.size if isinstance(value, ps.sizing.Peak) else value for value in values])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rms_torque", "mean_speed", "average_load_torque", "drawn", "returned", "given"])
def test_means_are_those_of_a_million_samples(name: str) -> None:
    """Held to the samples' own error: the change from half as many, and half a sample at each of some twenty steps."""
    fine, coarse = sampled(SAMPLES)[name], sampled(SAMPLES // 2)[name]
    np.testing.assert_array_less(np.abs(exact(name) - fine), 2 * np.abs(fine - coarse) + 1e-5 * np.abs(fine))


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "peak_torque", "peak_speed", "peak_power", "peak_drawn_power", "peak_returned_power", "peak_voltage",
        "peak_load_torque", "use",
    ],
)  # fmt: skip
def test_peaks_are_those_of_a_million_samples_or_just_above(name: str) -> None:
    """A sample misses a peak at an end by half a step: 1e-5 s of a function that takes 0.1 s to change by itself."""
    found, reference = exact(name), sampled(SAMPLES)[name]
    assert (found >= reference * (1 - EXACT)).all()
    assert (found <= reference * (1 + 1e-4)).all()


# ---- closed forms on a real arm


def turntable(folder: Path, inertia: float, coulomb: float, rotor: float = 0.0) -> ps.Robot:
    """A vertical axis: gravity has no say. The drive's own friction is what is called a load here."""
    body = '  <link name="base"/>\n' + link("disc", 1.0, [0.0, 0.0, 0.0], inertia * np.eye(3))
    drives = DRIVE.format(name="turn", ratio=1.0, rotor=rotor, viscous=0.0, positive=coulomb, negative=-coulomb)
    return load(folder, "turntable", body + joint("turn", "revolute", "base", "disc", [0, 0, 0], [0, 0, 1]), drives)


def test_rms_of_a_trapezoid_in_thirds(tmp_path: Path) -> None:
    """``((J a)^2 2/3 T + tau_c^2 T) / (T + t_p)``: T = 3 s, J = 0.5 kg m^2, tau_c = 0.3 N m, t_p = 1 s."""
    robot, a, times = turntable(tmp_path, 0.5, 0.3), 0.8, np.array([0.0, 1.0, 2.0, 3.0])
    powers = [[[0.0], [a / 2], [1.5 * a]], [[0.0], [a], [a]], [[a / 2], [0.0], [-a / 2]]]
    position = Piecewise.from_power(times, powers)
    move = ps.Trajectory(position=position, points=position(times), times=times)
    cycle = ps.Cycle(steps=[ps.compute_motion(robot, move), ps.Dwell(duration=1.0)])
    expected = np.sqrt(((0.5 * a) ** 2 * 2 / 3 * 3.0 + 0.3**2 * 3.0) / 4.0)
    demands = ps.size(cycle).demands[0]
    assert demands.rms_torque == pytest.approx(expected, rel=1e-11)
    assert demands.peak_torque.size == pytest.approx(0.5 * a + 0.3, rel=1e-11)


def test_rms_of_pure_inertia_under_a_quintic(tmp_path: Path) -> None:
    """``J (h / T^2) C sqrt(T / (T + t_p))`` with C = sqrt(120 / 7) of the quintic; links and rotor together."""
    robot = turntable(tmp_path, 0.5, 0.0, rotor=0.25)
    move = ps.quintic_segments([[0.2], [1.4]], [0.0, 1.5])
    cycle = ps.Cycle(steps=[ps.compute_motion(robot, move), ps.Dwell(duration=0.5)])
    expected = 0.75 * 1.2 / 1.5**2 * np.sqrt(120 / 7) * np.sqrt(1.5 / 2.0)
    demands = ps.size(cycle).demands[0]
    assert demands.rms_torque == pytest.approx(expected, rel=1e-11)
    # The load alone, and the inertia ratio, know nothing of the rotor.
    assert demands.peak_load_torque.size == pytest.approx(0.5 * 1.2 / 1.5**2 * 10 / np.sqrt(3), rel=1e-11)
    assert demands.inertia_ratio.size == pytest.approx(2.0, rel=1e-11)


# ---- own drives, and laws


def test_own_drives_ask_for_the_torque_of_the_assessment(puma: ps.Robot) -> None:
    """Two ways: the motors' torque times the ratio is the actuators' torque at the joint."""
    motion = paper_motion()
    sizing, assessment = ps.size(ps.Cycle(steps=[motion])), ps.assess(motion)
    ratios = np.array([train.ratio for train in sizing.drivetrains])
    peaks = np.array([d.peak_torque.size for d in sizing.demands]) * ratios
    np.testing.assert_allclose(peaks, assessment.peak_torque, rtol=EXACT, atol=1e-10)
    np.testing.assert_allclose(
        np.array([d.rms_torque for d in sizing.demands]) * ratios, assessment.rms_torque, rtol=EXACT, atol=1e-10
    )
    assert [d.load.joint for d in sizing.demands] == list(puma.joint_names)


def test_the_robot_s_own_rotors_and_friction_do_not_load_a_candidate() -> None:
    """The same arm with other drives of its own gives a candidate the same load."""
    other = ps.load_robot()
    heavy = tuple(replace(each, rotor_inertia=1e-3, coulomb_friction=[1.0, -1.0]) for each in other.actuators)
    move = paper_motion().trajectory
    train = [ps.Drivetrain(motor=MOTOR, gearbox=GEARBOX)] * 6
    rms = [
        [d.rms_torque for d in ps.size(ps.Cycle(steps=[ps.compute_motion(robot, move)]), drivetrains=train).demands]
        for robot in (other, other.with_actuators(heavy))
    ]
    np.testing.assert_allclose(rms[0], rms[1], rtol=1e-13)


@settings(max_examples=20)
@given(first=st.floats(1e-5, 1e-3), second=st.floats(1e-5, 1e-3), part=st.floats(0.0, 1.0))
def test_motor_torque_is_affine_in_the_reflected_inertia(first: float, second: float, part: float) -> None:
    """What makes a catalogue search cheap."""
    joint_load = candidate().demands[1].load

    def torque(rotor: float) -> np.ndarray:
        train = ps.Drivetrain(motor=replace(MOTOR, rotor_inertia=rotor), gearbox=GEARBOX)
        return ps.sizing.motor_load(joint_load, train).torque(np.linspace(0.0, 19.0, 400))

    mixed = torque(part * first + (1 - part) * second)
    np.testing.assert_allclose(mixed, part * torque(first) + (1 - part) * torque(second), atol=1e-13)


def test_energy_is_given_to_losses_alone_over_a_cycle_that_repeats_with_one_load() -> None:
    """Rotor and load give back what they take: the motor's net work is what gears and friction lose."""
    motion = paper_motion()
    train = ps.Drivetrain(motor=MOTOR, gearbox=GEARBOX)
    sizing = ps.size(ps.cycle.with_return(motion, dwell=0.5), drivetrains=[train] * 6)
    for d in sizing.demands[:3]:
        given, returned = d.work
        load_power = d.load.torque * d.load.velocity
        split = np.diff(load_power.integral()(load_power.breaks)[:, 0])
        gears = np.where(split > 0, split * (1 / 0.75 - 1), -split * (1 - 0.6)).sum()
        speed = d.motor.speed
        friction = 2e-4 * speed.inner(speed)[0] + 0.03 * d.mean_speed * d.load.duration
        assert given - returned == pytest.approx(gears + friction, rel=1e-8)


def test_the_optimal_ratio_of_a_real_load_is_where_its_rms_torque_is_least() -> None:
    """Friction apart and at efficiency 1, against the full computation on both sides of it."""
    motor = ps.Motor(rotor_inertia=2e-4)
    moments = ps.sizing.load_moments(candidate().demands[1].load)
    best = moments.optimal_ratio(2e-4)

    def rms(ratio: float) -> float:
        train = ps.Drivetrain(motor=motor, gearbox=ps.Gearbox(ratio=ratio))
        return ps.sizing.motor_load(candidate().demands[1].load, train).rms_torque

    assert rms(best) < min(rms(0.99 * best), rms(1.01 * best))


# ---- the paper's task


@pytest.mark.parametrize(
    ("limits", "use"), [("corke", [56, 97, 52, 10, 10, 10]), ("akb", [97.6, 186.4, 89.4, 24.2, 20.1, 21.3])]
)
def test_both_published_limit_sets_pass_the_paper_s_task(limits: str, use: list[float]) -> None:
    """Amplifier limits at the joint, N m: Corke 1996, table 2.17; Armstrong, Khatib, Burdick 1986, table 7."""
    robot = ps.load_robot(limits=limits)
    motion = ps.compute_motion(robot, paper_motion().trajectory)
    sizing = ps.size(ps.cycle.with_return(motion), drivetrains=ps.load_drivetrains(robot))
    efforts = [check for check in sizing.checks if check.quantity == "actuator effort at the joint"]
    np.testing.assert_array_equal([check.limit for check in efforts], use)
    back = ps.assess(ps.compute_motion(robot, sizing.cycle.steps[1].trajectory))
    peak = np.maximum(ps.assess(motion).peak_torque, back.peak_torque)
    np.testing.assert_allclose([check.demand for check in efforts], peak, rtol=EXACT, atol=1e-10)
    assert sizing.is_feasible
    # 9 s is slow: the dearest of Corke's limits is joint 2's, at two thirds; AKB's are twice as wide.
    worst = max(efforts, key=lambda check: check.utilisation)
    assert worst.utilisation == pytest.approx({"corke": 63.49 / 97, "akb": 33.58 / 97.6}[limits], rel=1e-3)


def test_joint_1_is_friction_and_joint_2_gravity() -> None:
    first, second = (d.rms_by_cause for d in ps.size(ps.cycle.with_return(paper_motion())).demands[:2])
    assert first["friction"] > 20 * max(first["gravity"], first["motion"], first["rotor"])
    assert second["gravity"] > 2 * max(second["friction"], second["motion"], second["rotor"])


# ---- the report


def test_the_verdict_names_the_governing_limit_and_a_broken_one() -> None:
    weak = replace(candidate().drivetrains[0], motor=replace(MOTOR, continuous_torque=0.1, max_inertia_ratio=0.5))
    sizing = ps.size(paper_cycle(), drivetrains=[weak, *candidate().drivetrains[1:]])
    assert not sizing.is_feasible
    assert sizing.violations[0] == sizing.governing
    assert all(check.kind != "rule of thumb" for check in sizing.violations)
    assert [check.quantity for check in sizing.warnings] == ["inertia ratio"]
    text = str(sizing)
    assert text.startswith("puma560, cycle of 4 steps, 19 s, repeats: undersized")
    assert "RMS motor torque at mean speed" in text
    assert "motor torque: needs the motor's peak torque (all joints)" in text
    assert sizing.joint_checks("joint1")[0].utilisation >= sizing.joint_checks("joint1")[-1].utilisation


def test_a_rule_of_thumb_alone_rejects_nothing() -> None:
    train = ps.Drivetrain(motor=ps.Motor(rotor_inertia=1e-5, max_inertia_ratio=0.1), gearbox=ps.Gearbox(ratio=50.0))
    sizing = ps.size(paper_cycle(), drivetrains=[train] * 6)
    assert sizing.warnings
    assert sizing.is_feasible
    assert sizing.governing is None


def test_a_cycle_that_does_not_return_says_so_and_has_no_temperature() -> None:
    sizing = ps.size(ps.Cycle(steps=[paper_motion()]), drivetrains=candidate().drivetrains)
    assert np.isfinite(sizing.demands[0].rms_torque)
    assert any("does not return to its start" in remark for remark in sizing.remarks)
    assert any(line.startswith("winding temperature rise: no steady temperature") for line in sizing.not_assessed)
    assert "does not repeat" in str(sizing).splitlines()[0]


def test_winding_temperature_of_a_real_cycle_returns_to_itself_and_balances() -> None:
    """Over a steady cycle the heat through the housing is the heat lost in the winding."""
    for d in candidate().demands[:3]:
        rise = d.temperature_rise
        assert rise is not None
        np.testing.assert_allclose(rise(0.0), rise(19.0), rtol=1e-10)
        outward = rise.integral()(19.0)[1] / 1.1
        i2r = d.motor.torque * d.motor.torque * (1.3 / 0.2**2)
        winding = Piecewise(breaks=rise.breaks, coefficients=rise.coefficients[:, :, :1])
        growth = winding * MOTOR.copper_coefficient
        lost = i2r.integral()(19.0)[0] * (1 + MOTOR.copper_coefficient * (30.0 - 20.0)) + i2r.inner(growth)[0]
        assert outward == pytest.approx(lost, rel=1e-9)


def test_the_document_is_json_and_tells_unbounded_from_unknown() -> None:
    document = json.loads(json.dumps(candidate().to_dict(), allow_nan=False))
    assert document["schema"] == "puma-septic/sizing/1"
    first = document["joints"][0]
    assert first["rms_motor_torque"] == candidate().demands[0].rms_torque
    assert first["expected_gearbox_life_hours"] is None
    assert {"quantity", "utilisation", "margin", "kind", "source"} <= set(first["checks"][0])


def test_the_motor_load_profile_holds_reversals_and_the_motor_s_own_values() -> None:
    profile = candidate().motor_load_profile("joint2", step=0.05)
    motor = candidate().demands[1].motor
    assert (np.diff(profile.time) > 0).all()
    assert np.diff(profile.time).max() <= 0.05 * (1 + 1e-9)
    assert np.isin(motor.torque.breaks, profile.time).all()
    np.testing.assert_allclose(profile.speed_rpm, motor.speed(profile.time)[:, 0] * 30 / np.pi, rtol=1e-13)
    np.testing.assert_array_equal(profile.torque, motor.torque(profile.time)[:, 0])


# ---- what does not fit


def test_wrong_numbers_and_kinds_of_things_are_refused() -> None:
    with pytest.raises(ps.InputError, match="5 drivetrains for 6 joints: expected one for each of joint1"):
        ps.size(paper_cycle(), drivetrains=candidate().drivetrains[:5])
    with pytest.raises(ps.InputError, match="size takes a Cycle or a sequence of LoadCase, got Motion"):
        ps.size(paper_motion())  # type: ignore[arg-type]
    with pytest.raises(ps.InputError, match="unknown joint 'elbow'; valid: 'joint1'"):
        candidate().motor_load_profile("elbow")
    with pytest.raises(ps.InputError, match="step = 0 s must be greater than 0 s"):
        candidate().motor_load_profile("joint1", step=0.0)


def test_drive_trains_by_joint_name_are_those_in_the_robot_s_order() -> None:
    """A mapping once ended in an AttributeError: its keys were taken for the drive trains."""
    trains = candidate().drivetrains
    named = dict(reversed(list(zip(paper_cycle().joint_names, trains, strict=True))))
    assert ps.size(paper_cycle(), drivetrains=named).drivetrains == trains


def test_drive_trains_of_a_wrong_kind_are_refused() -> None:
    cycle, trains = paper_cycle(), candidate().drivetrains
    named = dict(zip(cycle.joint_names, trains, strict=True))
    with pytest.raises(ps.InputError, match="or a mapping by joint name, got one Drivetrain"):
        ps.size(cycle, drivetrains=trains[0])  # type: ignore[call-overload]
    with pytest.raises(ps.InputError, match="joint 'joint1' has a Motor; joint 'joint3' has a NoneType"):
        ps.size(cycle, drivetrains=[trains[0].motor, trains[1], None, *trains[3:]])  # type: ignore[list-item]
    del named["joint2"]
    with pytest.raises(
        ps.InputError, match="no drivetrain for 'joint2'; unknown joint 'elbow', 5; expected one for each"
    ):
        ps.size(cycle, drivetrains={**named, "elbow": trains[1], 5: trains[0]})  # type: ignore[dict-item]
    catalogue = ps.built_in_catalogue("puma560")
    with pytest.raises(ps.InputError, match="got one Drivetrain"):
        ps.size(cycle, catalogue=catalogue, drivetrains=trains[0])  # type: ignore[call-overload]


def test_a_motion_beyond_the_joints_positions_is_told_whatever_the_drives() -> None:
    """The paper's move cannot be made by the arm; its drives were once called strong enough without a word of that."""
    told = "whatever the drives, the motion itself violates the position limits of joint2, joint4, joint5"
    sizing = ps.size(paper_cycle())
    assert told in sizing.remarks
    assert told in ps.size(paper_cycle(), catalogue=ps.built_in_catalogue("puma560")).remarks
    robot = paper_motion().robot
    inside = ps.compute_motion(robot, ps.profiles.quintic([[0.0] * 6, [0.5] * 6], [0.0, 2.0]))
    assert not any("whatever the drives" in line for line in ps.size(ps.Cycle(steps=[inside])).remarks)
