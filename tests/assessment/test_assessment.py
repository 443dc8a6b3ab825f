"""What a motion demands of each joint, and what the limits say to it."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from helpers.arms import DRIVE, joint, link, load, pendulum, ur5
from helpers.moves import PROFILES, paper_move, parabolic_blends
from helpers.sampled import quadrature, refined_extrema, refined_peak, reversals, torque_with_friction

import puma_septic as ps
from puma_septic.dynamics import mass_matrix

# Extrema of polynomials are exact to rounding; of the torque to 1e-11 of its largest value.
EXACT = 1e-9
DWELL = 1.5
UNKNOWN = np.full(6, np.nan)
NO_LIMITS = ps.Limits(
    position=np.full((6, 2), np.nan), velocity=UNKNOWN, acceleration=UNKNOWN, jerk=UNKNOWN, effort=UNKNOWN
)


@cache
def assessed(profile: str) -> ps.Assessment:
    return ps.assess(ps.load_robot(), paper_move(profile), dwell=DWELL)


# ---- each field against samples


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize(("order", "name"), [(1, "velocity"), (2, "acceleration"), (3, "jerk")])
def test_peaks_and_means_of_the_motion_are_those_of_refined_samples(profile: str, order: int, name: str) -> None:
    trajectory, result = paper_move(profile), assessed(profile)

    def values(t: np.ndarray) -> np.ndarray:
        return trajectory(t, order)

    peak = getattr(result, f"peak_{name}")
    np.testing.assert_allclose(peak, refined_peak(values, trajectory.breaks), rtol=EXACT, atol=1e-12)
    rms = np.sqrt(quadrature(lambda t: values(t) ** 2, trajectory.breaks) / (9 + DWELL))
    np.testing.assert_allclose(getattr(result, f"rms_{name}"), rms, rtol=EXACT, atol=1e-12)
    # The instant may be a step, of which one side is meant.
    times = getattr(result, f"peak_{name}_time")
    for j, t in enumerate(times):
        beside = values(np.clip([t - 1e-10, t, t + 1e-10], 0, 9))[:, j]
        assert np.abs(beside).max() == pytest.approx(peak[j], rel=1e-8, abs=1e-12)


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.slow
def test_torque_power_and_energy_are_those_of_refined_samples(puma: ps.Robot, profile: str) -> None:
    trajectory, result = paper_move(profile), assessed(profile)
    torque, breaks = torque_with_friction(puma, trajectory)

    def power(t: np.ndarray) -> np.ndarray:
        return torque(t) * trajectory(t, 1)

    low, high = refined_extrema(torque, breaks)
    np.testing.assert_allclose(result.peak_torque, np.maximum(-low, high), rtol=EXACT)
    np.testing.assert_array_equal(result.peak_torque_sign, np.where(-low > high, -1, 1))
    low, high = refined_extrema(power, breaks)
    np.testing.assert_allclose(result.peak_power, np.maximum(high, 0), rtol=EXACT, atol=1e-9)
    np.testing.assert_allclose(result.peak_regenerated_power, np.maximum(-low, 0), rtol=EXACT, atol=1e-9)
    finer = np.union1d(breaks, reversals(power, breaks))
    for name, sign in (("energy_in", 1), ("energy_out", -1)):
        energy = quadrature(lambda t, sign=sign: np.maximum(sign * power(t), 0), finer)
        np.testing.assert_allclose(getattr(result, name), energy, rtol=1e-8, atol=1e-8)
    for j, t in enumerate(result.peak_torque_time):
        beside = torque(np.clip([t - 1e-10, t, t + 1e-10], 0, 9))[:, j] * result.peak_torque_sign[j]
        assert beside.max() == pytest.approx(result.peak_torque[j], rel=1e-8)


@pytest.mark.parametrize("profile", PROFILES)
def test_dwell_counts_in_the_mean_with_the_torque_that_holds_the_arm(puma: ps.Robot, profile: str) -> None:
    """A cycle's thermal mean without its dwell was once reported: it is wrong in either direction (sizing rule 4)."""
    torque, breaks = torque_with_friction(puma, paper_move(profile))
    holding = ps.inverse_dynamics(puma, paper_move(profile)(9.0), np.zeros(6), np.zeros(6))
    square = quadrature(lambda t: torque(t) ** 2, breaks) + holding**2 * DWELL
    np.testing.assert_allclose(assessed(profile).rms_torque, np.sqrt(square / (9 + DWELL)), rtol=EXACT)
    rms = ps.assess(puma, paper_move(profile)).rms_torque
    np.testing.assert_allclose(rms**2 * 9 + holding**2 * DWELL, square, rtol=EXACT)


def test_position_range_and_overshoot() -> None:
    """Joint 1 of the paper's septic goes to 2.6193 rad at 1.43 s and -0.7805 rad at 6.92 s, past 2.57 and -0.5716."""
    result = assessed("septic")
    np.testing.assert_allclose(result.position.max[0], 2.6193, atol=6e-5)
    np.testing.assert_allclose(result.position.min[0], -0.7805, atol=6e-5)
    np.testing.assert_allclose([result.position.t_max[0], result.position.t_min[0]], [1.43, 6.92], atol=6e-3)
    np.testing.assert_allclose(result.overshoot[0], -0.5716 - result.position.min[0], rtol=1e-12)
    # Joint 5: 1.590 rad past -0.6026.
    np.testing.assert_allclose(result.overshoot[4], 1.590, atol=6e-4)
    assert result.overshoot[3] == 0.0


# ---- closed forms


def test_a_weightless_pendulum_has_the_numbers_of_the_3_4_5_polynomial(tmp_path: Path) -> None:
    """C_v = 1.875, C_a = 10 / sqrt 3, C_j = 60; mean squares 10/7, 120/7, 720 (Biagiotti, Melchiorri; exact integrals).

    Inertia m l^2 = 0.5 kg m^2 and rotor 100^2 * 5e-5 = 0.5: torque is 1 kg m^2 times the acceleration, and the thermal
    mean over a cycle with dwell is ``J h / T^2 sqrt(120/7) sqrt(T / (T + dwell))``.
    """
    drives = DRIVE.format(name="swing", ratio=100.0, rotor=5e-5, viscous=0.0, positive=0.0, negative=0.0)
    arm = pendulum(tmp_path, drives=drives, gravity=(0.0, 0.0, 0.0))
    h, T, dwell = 1.2, 2.0, 3.0
    result = ps.assess(arm, ps.quintic_segments([[0.3], [0.3 + h]], [0.0, T]), dwell=dwell)
    share = np.sqrt(T / (T + dwell))
    expected = {
        "peak_velocity": 1.875 * h / T,
        "peak_acceleration": 10 / np.sqrt(3) * h / T**2,
        "peak_jerk": 60 * h / T**3,
        "peak_torque": 10 / np.sqrt(3) * h / T**2,
        "rms_velocity": np.sqrt(10 / 7) * h / T * share,
        "rms_acceleration": np.sqrt(120 / 7) * h / T**2 * share,
        "rms_jerk": np.sqrt(720) * h / T**3 * share,
        "rms_torque": np.sqrt(120 / 7) * h / T**2 * share,
        # All that is put in while speeding up comes back: J v^2 / 2 at the fastest.
        "energy_in": 0.5 * (1.875 * h / T) ** 2,
        "energy_out": 0.5 * (1.875 * h / T) ** 2,
        "peak_power": 6.69427 * h**2 / T**3,
        "peak_regenerated_power": 6.69427 * h**2 / T**3,
    }
    for name, value in expected.items():
        np.testing.assert_allclose(getattr(result, name)[0], value, rtol=1e-6 if "power" in name else 1e-12)
    # Both extremes are equally large; the instant and the sign are those of one of them.
    early = result.peak_torque_sign[0] > 0
    assert result.peak_torque_time[0] == pytest.approx(T * (3 - np.sqrt(3) * (1 if early else -1)) / 6, rel=1e-7)


def test_a_slow_pendulum_is_all_gravity(tmp_path: Path) -> None:
    """m g l = 9.81 N m at the horizontal, and lifting 2 kg by 0.5 m takes 9.81 J; friction takes its own on top."""
    arm = pendulum(tmp_path)
    slow = ps.quintic_segments([[0.0], [np.pi / 2]], [0.0, 1e4])
    result = ps.assess(arm, slow, dwell=1e9)
    np.testing.assert_allclose(result.peak_torque, 9.81, rtol=1e-9)
    np.testing.assert_allclose(result.energy_in, 9.81, rtol=1e-9)
    np.testing.assert_allclose(result.energy_out, 0.0, atol=1e-12)
    # Held at the horizontal for nearly the whole cycle; the move itself counts 1e4 of 1e9 s.
    np.testing.assert_allclose(result.rms_torque, 9.81, rtol=1e-5)
    drives = DRIVE.format(name="swing", ratio=100.0, rotor=0.0, viscous=3e-3, positive=0.02, negative=-0.01)
    rubbing = ps.assess(pendulum(tmp_path, drives=drives), ps.quintic_segments([[0.0], [np.pi / 2]], [0.0, 50.0]))
    viscous = 3e-3 * 100**2 * (10 / 7) * (np.pi / 2) ** 2 / 50
    np.testing.assert_allclose(rubbing.energy_in - rubbing.energy_out, 9.81 + 2 * np.pi / 2 + viscous, rtol=1e-9)


# ---- limits


def one_joint(arm: ps.Robot, **limits: float | list[float]) -> ps.Robot:
    """The arm with these limits and no others, for all joints."""
    n = arm.n_joints
    position = np.broadcast_to(limits.pop("position", [np.nan, np.nan]), (n, 2))
    rest = {name: np.full(n, limits.get(name, np.nan)) for name in ("velocity", "acceleration", "jerk", "effort")}
    return arm.with_limits(ps.Limits(position=position, **rest))


@pytest.fixture
def swing(tmp_path: Path) -> tuple[ps.Robot, ps.Trajectory]:
    return pendulum(tmp_path), ps.quintic_segments([[0.0], [1.0]], [0.0, 2.0])


def test_a_limit_that_is_exactly_met_is_kept_and_one_a_millionth_lower_is_not(
    swing: tuple[ps.Robot, ps.Trajectory],
) -> None:
    arm, move = swing
    free = ps.assess(arm, move)
    demands = {
        "velocity": free.peak_velocity[0],
        "acceleration": free.peak_acceleration[0],
        "jerk": free.peak_jerk[0],
        "effort": free.peak_torque[0],
    }
    for quantity, demand in demands.items():
        assert ps.assess(one_joint(arm, **{quantity: demand}), move).is_feasible, quantity
        broken = ps.assess(one_joint(arm, **{quantity: demand * (1 - 1e-6)}), move)
        assert not broken.is_feasible, quantity
        assert [check.quantity for check in broken.violations] == [quantity]
        assert broken.margins[quantity][0] == pytest.approx(-1e-6, rel=1e-3)
    assert ps.assess(one_joint(arm, position=[0.0, 1.0]), move).is_feasible
    assert not ps.assess(one_joint(arm, position=[0.0, 1 - 1e-6]), move).is_feasible
    assert not ps.assess(one_joint(arm, position=[1e-6, 1.0]), move).is_feasible


@pytest.mark.parametrize(
    ("bounds", "limit", "demand", "margin", "utilisation"),
    [
        ([-1.0, 1.5], 1.5, 1.0, 0.5, 0.6),  # nearer to the upper bound: middle 0.25, half range 1.25
        ([-0.25, 3.0], -0.25, 0.0, 0.25, 1.375 / 1.625),
        ([-1.0, 0.5], 0.5, 1.0, -0.5, 1.25 / 0.75),
        ([0.25, 5.0], 0.25, 0.0, -0.25, 2.625 / 2.375),
        ([0.1, 0.5], 0.5, 1.0, -0.5, 0.7 / 0.2),  # both broken: the one by more
        ([np.nan, 1.5], 1.5, 1.0, 0.5, 0.0),  # one bound is known: no range to be a part of
        ([0.25, np.nan], 0.25, 0.0, -0.25, np.inf),
    ],
)
def test_position_margin_is_the_distance_to_the_nearest_bound(
    swing: tuple[ps.Robot, ps.Trajectory], bounds, limit, demand, margin, utilisation
) -> None:  # type: ignore[no-untyped-def]
    """A joint with one known bound was once not checked at all."""
    arm, move = swing
    result = ps.assess(one_joint(arm, position=bounds), move)
    (check,) = result.checks
    np.testing.assert_allclose(
        [check.limit, check.demand, check.margin, check.utilisation], [limit, demand, margin, utilisation], atol=1e-13
    )
    assert result.margins["position"][0] == check.margin
    assert result.is_feasible == (margin > 0) == (not check.is_violated)
    assert check.time == (0.0 if demand == 0.0 else pytest.approx(2.0))
    assert ("beyond its bound" in str(check)) == (margin < 0)
    assert any("position" in line for line in result.not_assessed) == bool(np.isnan(bounds).any())


def test_violations_come_worst_first_and_the_governing_limit_is_the_one_used_most(puma: ps.Robot) -> None:
    tight = puma.with_limits(velocity=[1.0, 0.5, 0.6, 1.0, 0.4, 1.0], effort=30.0)
    result = ps.assess(tight, paper_move("septic"))
    used = [check.utilisation for check in result.violations]
    assert used == sorted(used, reverse=True)
    assert len(used) == len(result.violations) > 5
    assert result.worst is result.violations[0]
    assert result.worst.utilisation == max(check.utilisation for check in result.checks)
    assert (result.worst.joint, result.worst.quantity) == ("joint5", "velocity")
    for check in result.checks:
        j = puma.joint_names.index(check.joint)
        assert result.margins[check.quantity][j] == check.margin
        assert check.is_violated == (check.margin < 0)
        if check.quantity != "position":
            assert check.margin == pytest.approx(1 - check.demand / check.limit, rel=1e-14)


def test_a_feasible_motion_names_the_limit_it_uses_most(puma: ps.Robot) -> None:
    result = ps.assess(puma, ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0]))
    assert result.is_feasible
    assert result.violations == ()
    assert result.worst is not None
    assert str(result).splitlines()[0].endswith(f"feasible; governing limit: {result.worst}")


def test_what_is_unknown_is_listed_and_never_makes_a_motion_infeasible(puma: ps.Robot) -> None:
    """With NaN, ``any(demand > limit)`` is false and ``not all(demand <= limit)`` is true: neither will do."""
    unknown = puma.with_limits(NO_LIMITS).with_actuators([ps.Actuator()] * 6)
    result = ps.assess(unknown, ps.septic(np.arange(24.0).reshape(4, 6) / 2, [0, 0.1, 0.2, 0.3]))
    assert result.is_feasible
    assert result.worst is None
    assert result.checks == ()
    assert all(np.isnan(values).all() for values in result.margins.values())
    assert [line.split(":")[0].split(" (")[0] for line in result.not_assessed] == [
        "position limit", "velocity limit", "acceleration limit", "jerk limit", "effort limit",
        "rotor inertia", "viscous friction", "Coulomb friction",
    ]  # fmt: skip
    assert all("unknown for all joints" in line for line in result.not_assessed)
    assert "feasible" in str(result)


def test_only_the_joints_concerned_are_listed(puma: ps.Robot) -> None:
    some = puma.with_limits(velocity=[1, np.nan, 1, np.nan, 1, 1], acceleration=1.0, jerk=1.0)
    result = ps.assess(some, paper_move("septic"))
    assert result.not_assessed == ("velocity limit: unknown for joint2, joint4",)
    assert np.isnan(result.margins["velocity"]).tolist() == [False, True, False, True, False, False]


def test_a_continuous_joint_has_no_position_limit_to_be_unknown(tmp_path: Path) -> None:
    result = ps.assess(pendulum(tmp_path, kind="continuous"), ps.quintic_segments([[0.0], [50.0]], [0, 60]))
    assert not any("position" in line for line in result.not_assessed)
    assert np.isnan(result.margins["position"]).all()


# ---- unbounded demands


def twins(folder: Path, masses: tuple[float, float] = (1.0, 2.0)) -> ps.Robot:
    """Two pendulums on one base: the mass matrix is diagonal."""
    body = '<link name="base"/>'
    for k, mass in enumerate(masses):
        body += link(f"bob{k}", mass, [0.0, 0.0, -0.5], np.zeros((3, 3)))
        body += joint(f"swing{k}", "revolute", "base", f"bob{k}", [k, 0, 0], [0, 1, 0])
    return load(folder, "twins", body)


def test_a_step_in_velocity_is_infeasible_even_where_no_limit_is_known(puma: ps.Robot) -> None:
    unknown = puma.with_limits(NO_LIMITS)
    move = ps.lspb([[0.0] * 6, [0.3] * 6], durations=[2.0], blend_time=0.0)
    result = ps.assess(unknown, move, dwell=1.0)
    assert not result.is_feasible
    assert {check.quantity for check in result.violations} == {"acceleration", "effort"}
    assert len(result.violations) == 12
    assert "joint1 acceleration unbounded at t = 0 s, whatever the limit" in str(result)
    assert result.to_dict()["violations"][0]["limit"] is None
    for name in ("acceleration", "jerk", "torque"):
        assert np.isinf(getattr(result, f"peak_{name}")).all()
        assert np.isinf(getattr(result, f"rms_{name}")).all()
    np.testing.assert_allclose(result.peak_velocity, 0.15)
    assert np.isinf(result.peak_power).all()
    assert "infeasible, 12 limits violated" in str(result)
    limited = ps.assess(puma.with_limits(acceleration=5.0), move)
    assert {check.quantity for check in limited.violations} == {"acceleration", "effort"}
    assert limited.margins["acceleration"].tolist() == [-np.inf] * 6
    assert "joint1 acceleration unbounded at t = 0 s, limit 5 rad/s^2" in str(limited)


def test_a_step_in_velocity_strikes_only_the_joints_that_feel_it(tmp_path: Path) -> None:
    """Each joint is struck at its own first blow and with its sign: the second rests until 1 s."""
    move = ps.lspb([[0, 0], [1, 0], [1, -1]], durations=[1.0, 1.0], blend_time=0.0)
    result = ps.assess(twins(tmp_path), move)
    assert np.isinf(result.peak_torque).all()
    np.testing.assert_array_equal(result.peak_torque_time, [0.0, 1.0])
    np.testing.assert_array_equal(result.peak_torque_sign, [1.0, -1.0])
    one = ps.assess(twins(tmp_path), ps.lspb([[0, 0], [1, 0]], durations=[1.0], blend_time=0.0))
    np.testing.assert_array_equal(np.isinf(one.peak_torque), [True, False])
    np.testing.assert_array_equal(np.isinf(one.rms_torque), [True, False])
    np.testing.assert_array_equal(np.isinf(one.peak_power), [True, False])
    np.testing.assert_array_equal(np.isinf(one.peak_acceleration), [True, False])
    assert not one.is_feasible


def test_a_light_blow_beside_a_heavy_neighbour_strikes_it_not(tmp_path: Path) -> None:
    """The impulse was once the difference of two torques with gravity: its rounding struck other joints."""
    arm = twins(tmp_path, masses=(1e-3, 1e6))
    points = [[0.0, 0.8], [1e-7, 0.8]]
    result = ps.assess(arm, ps.lspb(points, durations=[1.0], blend_time=0.0))
    np.testing.assert_array_equal(np.isinf(result.peak_torque), [True, False])


def test_a_coupling_that_is_rounding_is_none(tmp_path: Path) -> None:
    """A pendulum that swings through the axis of a turntable does not turn it; its mass matrix has 1e-17 there."""
    body = '<link name="base"/>' + link("table", 1.0, [0, 0, 0], 0.1 * np.eye(3))
    body += link("bob", 2.0, [0.1, 0.0, -0.5], 0.01 * np.eye(3))
    body += joint("turn", "revolute", "base", "table", [0, 0, 0], [0, 0, 1], [0.4, 0.5, 0.6])
    body += joint(
        "swing", "revolute", "table", "bob", [0.2 * np.cos(0.3), 0.2 * np.sin(0.3), 0], [0, 1, 0], [0, 0, 0.3]
    )
    arm = load(tmp_path, "turntable", body)
    move = ps.lspb([[0.7, 0.1], [0.7, 1.1]], durations=[1.0], blend_time=0.0)
    assert 0 < abs(mass_matrix(arm, move([0.0, 1.0]))[:, 0, 1]).max() < 1e-15
    np.testing.assert_array_equal(np.isinf(ps.assess(arm, move).peak_torque), [False, True])


def test_a_step_in_acceleration_leaves_only_the_jerk_unbounded(tmp_path: Path) -> None:
    move = parabolic_blends(np.array([0.0, 3.0]), np.array([[0.0], [1.0]]), 1.0)
    arm = pendulum(tmp_path)
    result = ps.assess(arm, move)
    assert result.peak_jerk.tolist() == [np.inf]
    assert result.rms_jerk.tolist() == [np.inf]
    assert result.peak_jerk_time.tolist() == [0.0]
    np.testing.assert_allclose(result.peak_acceleration, 0.5, rtol=1e-12)
    assert np.isfinite(result.peak_torque).all()
    assert result.is_feasible
    assert not ps.assess(one_joint(arm, jerk=1e9), move).is_feasible


# ---- documents


def cases() -> dict[str, ps.Assessment]:
    puma = ps.load_robot()
    jumping = ps.lspb([[0.0] * 6, [0.3] * 6], durations=[2.0], blend_time=0.0)
    return {
        "paper": assessed("septic"),
        "unbounded": ps.assess(puma, jumping),
        "unknown": ps.assess(ur5(), ps.quintic_segments([[0.1] * 6, [0.5] * 6], [0, 2])),
        "one bound": ps.assess(puma.with_limits(position=[[1.0, np.nan]] * 6), paper_move("lspb")),
    }


@pytest.mark.parametrize("case", ["paper", "unbounded", "unknown", "one bound"])
def test_the_document_is_json_without_nan_or_infinity(case: str) -> None:
    result = cases()[case]
    document = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    assert document["is_feasible"] is result.is_feasible
    assert document["schema"] == "puma-septic/assessment/1"
    names = [entry["name"] for entry in document["joints"]]
    assert tuple(names) == result.motion.robot.joint_names
    for j, entry in enumerate(document["joints"]):
        expected = result.peak_torque[j]
        assert entry["peak_torque"] == ("unbounded" if np.isinf(expected) else expected)
        for quantity, margins in result.margins.items():
            written = entry["margins"][quantity]
            assert (written is None) == bool(np.isnan(margins[j]))
    assert len(document["violations"]) == len(result.violations)
    assert document["not_assessed"] == list(result.not_assessed)


@pytest.mark.parametrize("case", ["paper", "unbounded", "unknown", "one bound"])
def test_the_table_tells_verdict_violations_and_what_is_unknown(case: str) -> None:
    result = cases()[case]
    text = str(result)
    assert result.to_dict()["verdict"] in text.splitlines()[0]
    assert text.splitlines()[0].startswith(f"{result.motion.robot.name}, {result.motion.trajectory.profile}")
    for line in (*map(str, result.violations), *result.not_assessed, *result.remarks, *result.motion.robot.joint_names):
        assert line in text
    assert " nan" not in text
    assert "inf %" not in text
    assert max(map(len, text.split("Tool")[0].splitlines())) < 200


def test_the_paper_s_verdict_is_infeasible_by_joints_4_5_and_2() -> None:
    """Table 1 puts q4 at -180 deg (limit -110), q5 at -114 (limit -100), q2 at -45.11 (limit -45)."""
    result = assessed("septic")
    assert not result.is_feasible
    assert [(check.joint, check.quantity) for check in result.violations] == [
        ("joint4", "position"), ("joint5", "position"), ("joint2", "position"),
    ]  # fmt: skip
    np.testing.assert_allclose(
        result.margins["position"][[3, 4, 1]],
        [-3.1416 + np.deg2rad(110), -1.9895 + np.deg2rad(100), -0.7873 + np.pi / 4],
        atol=1e-12,
    )
    np.testing.assert_allclose(result.margins["effort"], 1 - result.peak_torque / [56, 97, 52, 10, 10, 10], rtol=1e-14)


# ---- remarks, values, arguments


def test_static_friction_is_named_for_the_joints_that_rest(puma: ps.Robot) -> None:
    (remark,) = [r for r in ps.assess(puma, paper_move("septic")).remarks if "static friction" in r]
    # Joint 4 alone rests: 76.0364 * 0.0112 and 76.0364 * 0.0169 N m.
    assert remark.endswith(": joint4 [-1.29, 0.852]")
    remark, holding = [r for r in assessed("septic").remarks if "static friction" in r]
    assert all(name in remark for name in puma.joint_names)
    assert holding.startswith("holding torque of the dwell without static friction, which counts here, and with all")
    (remark,) = [r for r in ps.assess(puma, paper_move("quintic_segments")).remarks if "static friction" in r]
    assert all(name in remark for name in puma.joint_names)
    unknown = ps.assess(puma.with_actuators([ps.Actuator()] * 6), paper_move("septic"), dwell=1.0)
    assert not any("static friction" in r for r in unknown.remarks)


def test_remarks_of_a_sliding_joint_do_not_call_its_force_a_torque(tmp_path: Path) -> None:
    """Bug: what friction holds of a joint that slides was told in N m alone."""
    drives = DRIVE.format(name="swing", ratio=100.0, rotor=0.0, viscous=0.0, positive=0.02, negative=-0.01)
    slide = pendulum(tmp_path, kind="prismatic", drives=drives)
    remarks = ps.assess(slide, ps.quintic_segments([[0.0], [0.5]], [0, 2]), dwell=1.0).remarks
    assert sum("(N m or N)" in one for one in remarks) == 2


def test_what_a_dwell_takes_is_told_without_and_with_the_help_of_friction(tmp_path: Path) -> None:
    """2 kg at 0.5 m need 9.81 N m at the horizontal, and fall backwards, against which friction has 100 * 0.01 N m."""
    drives = DRIVE.format(name="swing", ratio=100.0, rotor=0.0, viscous=0.0, positive=0.02, negative=-0.01)
    arm = pendulum(tmp_path, drives=drives)
    *_, remark = ps.assess(arm, ps.quintic_segments([[0.0], [np.pi / 2]], [0, 2]), dwell=1.0).remarks
    assert remark.endswith("and with all its help (N m): swing 9.81 (8.81)")
    # Upright again nothing is held, whatever rounding leaves of it.
    *_, remark = ps.assess(arm, ps.quintic_segments([[0.0], [np.pi]], [0, 2]), dwell=1.0).remarks
    assert remark.endswith(": swing 0 (0)")


def test_what_is_computed_late_is_computed_once() -> None:
    result = ps.assess(ps.load_robot(), paper_move("septic"))
    for name in ("tool", "checks", "position"):
        assert getattr(result, name) is getattr(result, name)
    assert result.energy_in is result.energy_in


def test_no_array_of_a_result_can_be_written_to() -> None:
    """A frozen value's arrays were writable: one user's unit conversion in place changed the next one's verdict."""
    result = assessed("septic")
    for name in (
        "peak_velocity", "peak_acceleration_time", "peak_jerk", "peak_torque", "rms_torque", "peak_torque_sign",
        "peak_power", "energy_in",
    ):  # fmt: skip
        with pytest.raises(ValueError, match="read-only"):
            getattr(result, name)[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        result.motion.still[0, 0] = True


def test_a_motion_and_a_robot_with_a_trajectory_give_the_same(puma: ps.Robot) -> None:
    one = ps.assess(ps.compute_motion(puma, paper_move("lspb")), dwell=1.0)
    two = ps.assess(puma, paper_move("lspb"), dwell=1.0)
    assert one.to_dict() == two.to_dict()


def test_arguments_that_do_not_belong_together_are_refused(puma: ps.Robot) -> None:
    motion = ps.compute_motion(puma, paper_move("septic"))
    for arguments in ((puma,), (motion, paper_move("septic")), (paper_move("septic"), puma)):
        with pytest.raises(ps.InputError, match="either a motion, or a robot and a trajectory"):
            ps.assess(*arguments)
    with pytest.raises(ps.InputError, match=r"dwell = -1 s must be at least 0 s"):
        ps.assess(motion, dwell=-1.0)
    with pytest.raises(ps.InputError, match="dwell"):
        ps.assess(motion, dwell=float("nan"))
    with pytest.raises(ps.InputError, match=r"tool_limits: expected paths.ToolLimits, got 0.25"):
        ps.assess(motion, tool_limits=0.25)  # type: ignore[arg-type]
    with pytest.raises(ps.InputError, match=r"unknown quantity 'position'; valid: 'velocity', 'acceleration'"):
        ps.assess(motion).peak("position")


def test_a_rest_behind_a_motion_that_ends_moving_is_refused_with_the_fastest_joint(tmp_path: Path) -> None:
    """Joint 1 stops at 1 s, which is an answer; what moves at the end cannot rest there."""
    move = ps.profiles.linear([[0.0, 0.0], [1.0, 0.5], [1.25, -0.5]], [0.0, 1.0, 2.0])
    with pytest.raises(ps.InputError, match=r"dwell = 0.5 s: the motion ends moving .* joint 2 has -1 rad/s there"):
        ps.assess(twins(tmp_path), replace(move, rest_after=False), dwell=0.5)
    stops = ps.profiles.linear([[0.0, 0.0], [1.0, 0.5], [1.0, 0.5]], [0.0, 1.0, 2.0])
    assert ps.assess(twins(tmp_path), replace(stops, rest_after=False), dwell=0.5).dwell == 0.5


def test_what_a_notebook_shows_is_the_document() -> None:
    result = assessed("septic")
    shown = "<Assessment: robot puma560, profile septic, duration 9 s, verdict infeasible, 3 limits violated; the "
    assert repr(result).startswith(shown)
    assert f"{result.verdict}</strong>" in result._repr_html_()
    table = result.to_dataframe()
    assert list(table.index) == list(result.motion.robot.joint_names)
    assert "checks" not in table
    np.testing.assert_array_equal(table["peak_torque"], result.peak_torque)


# ---- points in another unit


def test_points_that_look_like_degrees_are_questioned(puma: ps.Robot) -> None:
    """Joint 1 planned to 90 "rad" had a verdict of torque and not a word of the unit."""
    move = ps.quintic_segments([[0, 45, -90, 0, 10, 0], [90, 30, -80, 10, 20, 0]], [0, 2])
    result = ps.assess(puma, move)
    assert not result.is_feasible
    assert result.verdict.startswith("undecided: points in degrees? joint1 reaches 90 rad, 14.3 turns, its bounds are")
    assert result.verdict.endswith("90 deg would be 1.57 rad, and a task file takes them as joints_deg")
    assert result.to_dict()["undecided"] == list(result.undecided)


def test_points_within_bounds_or_a_little_beyond_are_not_taken_for_degrees(puma: ps.Robot) -> None:
    """A violated bound is an answer; a joint whose bounds say so may turn as far as it likes."""
    beyond = ps.quintic_segments([[0.0] * 6, [3.5] * 6], [0, 5])
    assert ps.assess(puma, beyond).verdict.startswith("infeasible")
    far = ps.quintic_segments([[0.0] * 6, [0.0] * 5 + [90.0]], [0, 500])
    assert ps.assess(puma, far).undecided
    bounds = [[-100.0, 100.0]] * 6
    assert not ps.assess(puma.with_limits(position=bounds), far).undecided


def test_what_rounding_leaves_of_a_joint_at_rest_is_shown_as_zero(puma: ps.Robot) -> None:
    """Numeric inverse kinematics left 1e-12 rad in a joint at rest: "2.242e-12 rad/s" stood in the table as a speed."""
    move = ps.quintic_segments([[0.0, 0.6, -2.2, 0.0, 0.3, 0.0], [0.4, 1.2, -2.6, 0.0, 0.6, -1e-12]], [0, 1])
    result = ps.assess(puma, move)
    rows = [line for line in str(result).splitlines() if line.startswith("joint6")]
    assert not any("e-1" in row for row in rows)
    assert re.search(r" 0 \(0 %\) +0 +0$", rows[0])
    assert result.to_dict()["joints"][5]["peak_velocity"] == pytest.approx(1.875e-12)  # the document has what it is


def test_a_motion_that_swings_wildly_is_told_in_short(puma: ps.Robot) -> None:
    """A septic to 90 s in place of 9 swings over thousands of radians. Its text had a line of 100,000 characters, the
    energies between 30,000 changes of sign took gigabytes. Without friction the work is the change of energy: none.
    """
    first, second = [2.5, 0.2, -1.8, 0.0, 1.6, 0.5], [2.5, 0.3, -1.9, 0.0, 1.6, 0.5]
    far = [-0.6, 0.3, -1.9, 0.0, 1.5, -2.6]
    smooth = [replace(one, viscous_friction=0.0, coulomb_friction=(0.0, 0.0)) for one in puma.actuators]
    move = ps.septic([first, second, far, first], [0.0, 2.0, 6.0, 60.0])
    wild = ps.assess(puma.with_actuators(smooth), move)
    text = str(wild)
    assert max(map(len, text.splitlines())) < 1000
    assert re.search(r"crossed \d{2,} times, first at", text)
    net = float((wild.energy_in - wild.energy_out).sum())
    assert abs(net) <= 1e-9 * float(wild.energy_in.sum())
