"""The bearing at a gearbox's output: the whole wrench of the inverse dynamics, against formulas that know none."""

from __future__ import annotations

import gc
import weakref
from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from helpers.duty import paper_motion

import puma_septic as ps
from puma_septic.dynamics import joint_wrenches
from puma_septic.sizing._gearbox import average_load_torque, weighted_power_mean

# What the fit of the wrench leaves of the torque's own.
FITTED = 1e-9
# A sum over two hundred thousand samples.
SAMPLED = 1e-6


@cache
def cycle() -> ps.Cycle:
    return ps.cycle.with_return(paper_motion(loaded=True), dwell=1.0)


def bearing(joint: int, **gearbox: float) -> ps.sizing.BearingLoad:
    found = ps.sizing.bearing_load(ps.sizing.joint_load(cycle(), joint), ps.Gearbox(ratio=1.0, **gearbox))
    assert found is not None
    return found


def test_the_wrench_along_the_axis_is_the_load_torque() -> None:
    t = np.linspace(0, cycle().duration, 501)
    wrench, torque = cycle().joint_wrench(t).reshape(len(t), 6, 6), cycle().load_torque(t)
    assert wrench[:, :, 5] == pytest.approx(torque, abs=FITTED * np.abs(torque).max())


@pytest.mark.parametrize("axes", ["world", "tool"])
def test_the_wrench_at_the_tool_reaches_every_joint(axes: str) -> None:
    """J^T w is the component along each axis."""
    robot = ps.load_robot().with_wrench(ps.Wrench(force=(30.0, -20.0, 10.0), torque=(1.0, 2.0, -3.0), axes=axes))
    rng = np.random.default_rng(5)
    q, v, a = rng.uniform(-1, 1, (3, 4, 6))
    expected = ps.inverse_dynamics(robot, q, v, a, friction=False) - robot.armature * a
    assert joint_wrenches(robot, q, v, a)[:, :, 5] == pytest.approx(expected, abs=1e-11)


def test_at_rest_the_base_s_bearing_carries_the_weights_at_their_levers() -> None:
    """The audit's case in small: the shoulder's pan needs no torque at all to hold, but carries all of the tilt."""
    robot = ps.load_robot("ur5").with_payload(ps.Payload(mass=5.0))
    q = np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0])
    wrench = joint_wrenches(robot, q[None], np.zeros((1, 6)), np.zeros((1, 6)))[0, 0]
    model, data = robot.model, robot.model.createData()
    pin.centerOfMass(model, data, q)
    mass = pin.computeTotalMass(model)
    lever = np.hypot(*data.com[0][:2])
    assert wrench[5] == pytest.approx(0.0, abs=1e-9)
    assert np.hypot(wrench[3], wrench[4]) == pytest.approx(mass * 9.81 * lever, rel=1e-9)
    assert abs(wrench[2]) == pytest.approx(mass * 9.81, rel=1e-9)
    # Stretched with 5 kg: a CSG-14 unit's 41 N m of tilt are less than half of it.
    assert np.hypot(wrench[3], wrench[4]) > 83


def test_a_pan_of_little_torque_and_much_tilt() -> None:
    """UR5 with 5 kg, 12 cycles a minute: the pan needs 11 N m of torque and carries some 80 N m of tilt.

    On the audit's own path it was 83 N m, and a CSG-14 unit that bears 41 N m was "strong enough".
    """
    robot = ps.load_robot("ur5").with_payload(ps.Payload(mass=5.0))
    turn = ps.quintic_segments([[0.0, -1.0, 1.2, -1.8, 0.0, 0.0], [1.2, -1.0, 1.2, -1.8, 0.0, 0.0]], [0.0, 1.8])
    found = ps.cycle.with_return(ps.compute_motion(robot, turn), dwell=0.7)
    assert 60 / found.duration == pytest.approx(12.0)
    load = ps.sizing.joint_load(found, 0)
    one = ps.sizing.bearing_load(load, ps.Gearbox(ratio=1.0))
    assert one is not None
    assert round(load.torque.extrema().peak[0]) == 11
    assert round(one.peak_tilting[0]) == 81


@pytest.mark.parametrize("joint", [0, 1, 2])
def test_peaks_and_means_against_samples(joint: int) -> None:
    one = bearing(joint)
    n = 200_000
    t = (np.arange(n) + 0.5) * cycle().duration / n
    speed = np.abs(cycle().trajectory(t, 1)[:, joint])
    wrench = cycle().joint_wrench(t)[:, 6 * joint : 6 * joint + 6]
    axial, radial, tilting = np.abs(wrench[:, 2]), np.hypot(*wrench[:, :2].T), np.hypot(*wrench[:, 3:5].T)
    for peak, sampled in ((one.peak_axial, axial), (one.peak_radial, radial), (one.peak_tilting, tilting)):
        assert peak[0] == pytest.approx(sampled.max(), rel=SAMPLED)
    expected = [((speed * f ** (10 / 3)).sum() / speed.sum()) ** 0.3 for f in (axial, radial, tilting)]
    assert one.mean_loads == pytest.approx(expected, rel=SAMPLED)


def test_an_offset_moves_the_point_that_moments_are_about() -> None:
    """At rest the moment about a point d along the axis is that about the origin less ``d axis x F``."""
    t = np.linspace(0, cycle().duration, 50)
    wrench = cycle().joint_wrench(t)[:, 6:12]
    axis = np.array([0.0, 0.0, 1.0])
    moved = wrench[:, 3:] - 0.12 * np.cross(axis, wrench[:, :3])
    squared = bearing(1, bearing_offset=0.12).tilting_squared(t)[:, 0]
    assert squared == pytest.approx(moved[:, 0] ** 2 + moved[:, 1] ** 2, rel=1e-9)


def test_mean_to_the_ten_thirds_of_a_ramp() -> None:
    """``|t|`` from -1 to 1 at constant speed: ``(1 / (p + 1))^(1/p)``, its zero in the middle of the interval."""
    square = ps.Piecewise.from_power([-1.0, 1.0], [[[1.0]], [[-4.0]], [[4.0]]])
    one = ps.Piecewise.constant([2.0], 2.0, start=-1.0)
    assert weighted_power_mean(square, one, 10 / 3) == pytest.approx((3 / 13) ** 0.3, rel=1e-13)
    assert np.isnan(weighted_power_mean(square, one * 0.0, 10 / 3))


def test_the_published_rating_of_a_crossed_roller_bearing() -> None:
    """FHA-25C (Harmonic Drive, FHA manual p. 20): C = 18 000 N, dp = 96.2 mm, R = 18 mm.

    By hand after equations (5) to (7): 100 kg of axial load and 200 N radial at 0.1 m from the flange, 10 1/min.
    """
    axial, radial = 980.0, 200.0
    tilting = radial * (0.1 + 0.018)
    across = 200 + 2 * 23.6 / 0.0962
    assert axial / across < 1.5
    load = ps.sizing.equivalent_load(axial, radial, tilting, diameter=0.0962)
    assert load == pytest.approx(across + 0.45 * 980, rel=1e-12)
    life = ps.sizing.bearing_life(18000.0, equivalent=load, mean_speed=10 * 2 * np.pi / 60)
    assert life == pytest.approx(1e6 / (60 * 10) * (18000 / (1.5 * load)) ** (10 / 3), rel=1e-12)
    # Beyond a ratio of 1.5 both count by 0.67.
    assert ps.sizing.equivalent_load(980.0, 100.0, 0.0, diameter=0.1) == pytest.approx(0.67 * 1080, rel=1e-12)


def test_checks_of_the_output_bearing() -> None:
    gearbox = ps.Gearbox(
        ratio=100.0, max_tilting_moment=41.0, max_axial_force=1e4, max_radial_force=1e3, bearing_static_load=2e4,
        bearing_dynamic_load=1e4, bearing_diameter=0.08,
    )  # fmt: skip
    trains = [ps.Drivetrain(gearbox=gearbox, required_life_hours=2e4) for _ in range(6)]
    sizing = ps.size(cycle(), drivetrains=trains)
    checks = {check.quantity: check for check in sizing.joint_checks("joint1")}
    one = bearing(0)
    assert checks["output bearing tilting moment"].demand == one.peak_tilting[0]
    assert checks["output bearing tilting moment"].is_violated
    assert checks["output bearing axial force"].demand == one.peak_axial[0]
    assert checks["output bearing radial force"].demand == one.peak_radial[0]
    static = one.peak_radial[0] + 2 * one.peak_tilting[0] / 0.08 + 0.44 * one.peak_axial[0]
    assert checks["output bearing static load"].demand == pytest.approx(1.5 * static, rel=1e-12)
    load = ps.sizing.equivalent_load(*one.mean_loads, diameter=0.08)
    speed = ps.sizing.joint_load(cycle(), 0).mean_speed
    assert checks["output bearing life"].limit == pytest.approx(
        ps.sizing.bearing_life(1e4, equivalent=load, mean_speed=speed), rel=1e-12
    )
    assert {check.kind for name, check in checks.items() if "bearing" in name} == {"vendor procedure"}
    bare = ps.size(cycle(), drivetrains=[ps.Drivetrain(gearbox=ps.Gearbox(ratio=1.0))] * 6)
    for name in ("tilting moment", "axial force", "radial force", "static load", "life"):
        assert any(f"output bearing {name}: needs" in line for line in bare.not_assessed)


def test_what_is_kept_of_a_load_does_not_keep_it() -> None:
    """A process that sized arms held the last 64 loads, and with each the motions of its cycle."""
    load, gearbox = ps.sizing.joint_load(cycle(), 1), ps.Gearbox(ratio=1.0)
    first = ps.sizing.bearing_load(load, gearbox), average_load_torque(load, 10 / 3)
    assert (ps.sizing.bearing_load(load, gearbox), average_load_torque(load, 10 / 3)) == first
    held = weakref.ref(load)
    del load
    gc.collect()
    assert held() is None
