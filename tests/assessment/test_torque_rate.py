"""The torque's rate as a limit like any other: where it is known it is held, where not nothing is said of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.arms import DRIVE, pendulum
from helpers.urdf_texts import ARM, DRIVES, load

import puma_septic as ps
from puma_septic.dynamics import mass_matrix
from puma_septic.task import make_task
from puma_septic.viewer._animation import flags_of

VIAS = [[0.0, 0.8, -0.3, 0.1, 0.4, 0.0], [0.5, 0.3, 0.2, 0.4, -0.2, 0.6], [1.2, 0.9, -0.4, 0.0, 0.5, 1.0]]


def test_without_gravity_it_is_inertia_times_jerk(tmp_path: Path) -> None:
    """Of a shoulder that moves alone: the mass matrix does not depend on its own angle."""
    path = tmp_path / "arm.urdf"
    path.write_text(ARM, encoding="utf-8")
    robot = ps.load_robot(path, gravity=(0.0, 0.0, 0.0)).with_limits(torque_rate=200.0)
    assessment = ps.assess(robot, ps.quintic_segments([[0.0, 0.6], [0.5, 0.6]], [0.0, 1.0]))
    size, time = assessment.peak("torque_rate")
    inertia = mass_matrix(robot, np.array([[0.0, 0.6]]))[0, :, 0]
    # 60 d/T^3: jerk of the rest-to-rest quintic at its ends; the torque is resolved to 1e-11, its slope to less.
    assert size == pytest.approx(inertia * 60 * 0.5, rel=1e-8)
    assert time.tolist() == [0.0, 0.0]
    check = next(one for one in assessment.checks if (one.joint, one.quantity) == ("shoulder", "torque_rate"))
    assert (check.unit, check.limit, check.label) == ("N m/s", 200.0, "torque rate")
    assert check.utilisation == pytest.approx(inertia[0] * 30 / 200, rel=1e-8)


def test_against_differences_of_the_torque(puma: ps.Robot) -> None:
    motion = ps.compute_motion(puma, ps.profiles.quintic_spline(VIAS, [0.0, 0.6, 1.5]))
    breaks = motion.torque.breaks
    t, h = (breaks[:-1] + breaks[1:]) / 2, 1e-5 * np.diff(breaks)

    def smooth(instants: np.ndarray) -> np.ndarray:
        q, v, a = (motion.trajectory(instants, order) for order in range(3))
        terms = ps.torque_terms(puma, q, v, a)
        return terms.total - terms.coulomb

    slopes = (smooth(t + h) - smooth(t - h)) / (2 * h)[:, None]
    # The difference leaves h^2 and the torque's roundings over h: some 1e-8 of the largest slope.
    assert motion.signal("torque_rate")(t) == pytest.approx(slopes, rel=1e-6, abs=1e-5)


def test_it_is_infinite_where_the_acceleration_steps(puma: ps.Robot) -> None:
    robot = puma.with_limits(torque_rate=1000.0)
    assessment = ps.assess(robot, ps.profiles.cubic_spline(VIAS, [0.0, 0.6, 1.5]))
    size, time = assessment.peak("torque_rate")
    assert np.isinf(size).all()
    assert (time == 0).all()  # from rest to an acceleration
    assert "joint1 torque rate unbounded at t = 0 s, limit 1000 N m/s" in map(str, assessment.violations)
    flags = [flag for flag in flags_of(assessment) if "torque rate" in flag.text]
    assert flags[0].text == "joint1 torque rate unbounded at t = 0 s, limit 1000 N m/s"
    # A step of the velocity between two constant ones: no step of the acceleration tells of it.
    assert np.isinf(ps.assess(robot, ps.profiles.linear(VIAS, [0.0, 0.6, 1.5])).peak("torque_rate")[0]).all()


def test_friction_steps_are_left_out_and_told(puma: ps.Robot) -> None:
    """A maker's limit is one of commands without friction, and no real joint's friction steps."""
    move = ps.profiles.quintic_spline(VIAS, [0.0, 0.6, 1.5])
    bare = puma.with_actuators(
        tuple(
            ps.Actuator(
                gear_ratio=one.gear_ratio, rotor_inertia=one.rotor_inertia, viscous_friction=one.viscous_friction
            )
            for one in puma.actuators
        )
    )
    rates = [ps.assess(robot.with_limits(torque_rate=1e3), move).peak("torque_rate")[0] for robot in (puma, bare)]
    assert rates[0] == pytest.approx(rates[1], rel=1e-9)
    remark = ps.assess(puma.with_limits(torque_rate=1e3), move).remarks[-1]
    # Corke's friction of joint 1 at the joint: 62.6 * (0.395 + 0.435) N m where it reverses, which it does not here;
    # 62.6 * 0.395 = 24.7 N m where it starts.
    assert "the torque rate is that of the torque without Coulomb friction" in remark
    assert "by up to (N m): joint1 24.7" in remark


@pytest.mark.parametrize(
    ("powers", "rests", "step"),
    [
        ([0.0, 2.0, -2.0], False, "3"),  # reverses half-way: all of the band
        ([0.0, 1.0, -0.25], False, None),  # an excerpt that never stops but at its end, and starts moving
        ([0.0, 1.0, -0.25], True, "2"),
        ([0.0, -1.0, 0.25], True, "1"),
    ],
)
def test_what_friction_steps_by(tmp_path: Path, powers: list[float], rests: bool, step: str | None) -> None:
    """2 N m forwards and 1 N m backwards at the joint; of an excerpt nothing is known beyond its ends."""
    drives = DRIVE.format(name="swing", ratio=100.0, rotor=0.0, viscous=0.0, positive=0.02, negative=-0.01)
    position = ps.Piecewise.from_power([0.0, 2.0], np.reshape(powers, (3, 1, 1)))
    move = ps.Trajectory(
        position=position, points=position([0.0, 2.0]), times=[0.0, 2.0], rest_before=rests, rest_after=rests
    )
    robot = pendulum(tmp_path, drives=drives).with_limits(torque_rate=1e3)
    told = [remark for remark in ps.assess(robot, move).remarks if "Coulomb friction, which steps" in remark]
    assert [remark.rpartition(": ")[2] for remark in told] == ([] if step is None else [f"swing {step}"])


def test_where_no_limit_is_known_nothing_is_said(puma: ps.Robot) -> None:
    assessment = ps.assess(puma, ps.profiles.quintic_spline(VIAS, [0.0, 0.6, 1.5]))
    assert "torque_rate" not in assessment.margins
    assert not any("torque" in line and "rate" in line for line in (*assessment.not_assessed, *assessment.remarks))
    assert "torque rate" not in str(assessment) + assessment._repr_html_() + puma._repr_html_()
    assert np.isfinite(assessment.peak("torque_rate")[0]).all()  # who asks is told


def test_where_it_is_known_of_some_joints_the_others_are_named(puma: ps.Robot) -> None:
    robot = puma.with_limits(torque_rate=[1e3, 1e3, 1e3, np.nan, np.nan, np.nan])
    assessment = ps.assess(robot, ps.profiles.quintic_spline(VIAS, [0.0, 0.6, 1.5]))
    assert "torque_rate limit: unknown for joint4, joint5, joint6" in assessment.not_assessed
    assert [check.joint for check in assessment.checks if check.quantity == "torque_rate"] == list(puma.joint_names[:3])
    assert "torque rate" in str(assessment)
    assert "torque_rate [N m/s]" in robot._repr_html_()


def test_from_an_actuator_file(tmp_path: Path) -> None:
    robot = load(tmp_path, ARM, DRIVES + "torque_rate = { elbow = 500.0 }\n")
    np.testing.assert_array_equal(robot.limits.torque_rate, [np.nan, 500.0])


def test_from_a_task() -> None:
    resolved = ps.resolve_task(
        make_task(
            {
                "name": "rate",
                "points": [{"joints": point} for point in VIAS],
                "times": [0.0, 0.6, 1.5],
                "profiles": ["quintic_spline"],
                "limits": {"torque_rate": 250.0},
            }
        )
    )
    assert resolved.robot.limits.torque_rate.tolist() == [250.0] * 6


def test_the_gate_holds_it(puma: ps.Robot) -> None:
    move = ps.profiles.quintic_spline(VIAS, [0.0, 0.6, 1.5], joint_names=puma.joint_names)
    check = ps.check_trajectory(puma.with_limits(torque_rate=50.0), move, allow=["limit_unknown"])
    assert check.verdict == "violated"
    assert "torque_rate_limit" in {reason.code for reason in check.reasons}


def test_refused_limits(puma: ps.Robot) -> None:
    with pytest.raises(ps.InputError, match=r"torque_rate limit\[0\] = -1 must be greater than 0"):
        puma.with_limits(torque_rate=-1.0)
    with pytest.raises(ps.InputError, match=r"unknown limit 'torque'; valid: .*'effort', 'torque_rate'"):
        puma.with_limits(torque=1.0)


@pytest.mark.parametrize("limit", [30.0, 300.0])
def test_the_least_stretch_keeps_it_and_no_shorter_one_does(puma: ps.Robot, limit: float) -> None:
    robot = puma.with_limits(torque_rate=limit)
    move = ps.profiles.quintic(VIAS, [0.0, 0.6, 1.5])
    stretch = ps.least_stretch(robot, move)
    assert stretch.governing.quantity == "torque_rate"
    assert stretch.assessment.is_feasible
    shorter = ps.profiles.quintic(VIAS, np.array([0.0, 0.6, 1.5]) * stretch.factor * 0.999)
    assert [check.quantity for check in ps.assess(robot, shorter).violations] == ["torque_rate"]


def test_least_time_names_it_where_it_is_not_held(puma: ps.Robot) -> None:
    """Its search keeps what scales with time or is quadratic in speed; this is neither, so it is told, not kept."""
    robot = puma.with_limits(torque_rate=300.0)
    result = ps.least_time(ps.profiles.quintic, VIAS, [0.0, 0.6, 1.5], robot=robot, restarts=0)
    assert not result.is_feasible
    assert "not held: torque_rate (joint2 at" in str(result)
    with pytest.raises(ps.InputError, match=r"least time cannot keep the torque_rate limit; valid: position, velocity"):
        ps.least_time(ps.profiles.quintic, VIAS, [0.0, 0.6, 1.5], robot=robot, keep=["torque_rate"])


def test_via_times_keep_it(puma: ps.Robot) -> None:
    robot = puma.with_limits(torque_rate=235.0)
    start = ps.profiles.quintic_spline(VIAS, [0.0, 0.6, 1.5])
    assert not ps.assess(robot, start).is_feasible
    result = ps.optimise_via_times(
        ps.profiles.quintic_spline, VIAS, [0.0, 0.6, 1.5], robot=robot, keep=["torque_rate"], restarts=0
    )
    found = ps.assess(robot, result.trajectory)
    assert not [check for check in found.violations if check.quantity == "torque_rate"]
