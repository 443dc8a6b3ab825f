"""Friction has the sign of travel: nothing is decided by the rounding of a velocity."""

from __future__ import annotations

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.dynamics import smooth_torque
from puma_septic.piecewise.directions import REST_TIME, STILL, find_directions
from puma_septic.task import make_task
from puma_septic.validation import Array

BASE = np.array([0.0, 0.8, -2.5, 0.0, 0.4, 0.0])


def torque_with_sign(robot: ps.Robot, move: ps.Trajectory, sign: Array, samples: int = 8001) -> Array:
    """Torque of a motion whose friction has the given sign throughout, shape (samples, n_joints)."""
    t = np.linspace(move.breaks[0], move.breaks[-1], samples)
    friction = np.where(sign > 0, robot.coulomb_friction[:, 0], np.where(sign < 0, robot.coulomb_friction[:, 1], 0.0))
    return smooth_torque(robot, move(t), move(t, 1), move(t, 2)) + friction


@pytest.mark.parametrize("jerk", [1e1, 3e2, 1e3, 5e3, 1e4, 1e5, 1e6])
def test_double_s_never_pays_friction_backwards(puma: ps.Robot, jerk: float) -> None:
    """A last phase that ended with 1.7e-17 rad/s the wrong way turned Coulomb friction: peaks up to 420 % too high."""
    start, end = np.array([0.0, 1.0, -2.5, 0.0, 0.7, 0.0]), np.array([-1.0, 0.9, -2.6, 0.1, 0.5, 0.5])
    move = ps.profiles.double_s([start, end], max_velocity=1.5, max_acceleration=5, max_jerk=jerk)
    right = np.abs(torque_with_sign(puma, move, end - start)).max(axis=0)
    result = ps.assess(puma, move)
    # Samples miss a smooth peak by the square of their distance, and the steps of jerk, of 1e6 rad/s^3 at most, by it.
    np.testing.assert_allclose(result.peak_torque, right, rtol=2e-3)
    assert (result.peak_torque >= right * (1 - 1e-12)).all()
    if jerk == 5e3:
        # Independent recursive Newton-Euler with the sign of travel, joints 2 to 4.
        np.testing.assert_allclose(result.peak_torque[1:4], [26.20, 3.77, 1.02], atol=0.005)


def test_a_slow_joint_beside_its_stop_keeps_its_friction(puma: ps.Robot) -> None:
    """0.8 to -0.2 rad at limits 1, 1, 100: 53.81 N m was claimed at 1.4 ns before the end, and a limit of 45 broken."""
    points = np.tile(BASE, (2, 1))
    points[:, 1] = 0.8, -0.2
    move = ps.profiles.double_s(points, max_velocity=1.0, max_acceleration=1.0, max_jerk=100.0)
    result = ps.assess(puma.with_limits(effort=[56, 45, 52, 10, 10, 10]), move)
    assert result.peak_torque[1] == pytest.approx(37.4066, abs=5e-5)
    assert not [check for check in result.violations if check.quantity == "effort"]


def test_a_drive_that_starts_slowly_has_no_peak_of_a_friction_backwards(puma: ps.Robot) -> None:
    """52.24 N m were claimed of joint 2 of this Bezier curve, in the first microseconds; 45.1156 by an independent
    recursive Newton-Euler on two million samples."""
    points = [[-0.4, 0.9, -2.3, -0.3, 0.4, 0.2], [-0.3, 1.0, -2.2, -0.2, 0.8, -0.1], [0.1, 0.3, -2.1, -0.3, 0.2, 0.5],
              [0.4, 1.2, -2.3, 0.1, 0.1, 0.2], [-0.3, 0.6, -1.9, 0.5, 0.8, 0.4]]  # fmt: skip
    result = ps.assess(puma, ps.profiles.bezier(points, np.linspace(0, 2, 5)))
    assert result.peak_torque[1] == pytest.approx(45.1156, abs=5e-5)


def test_sizing_has_the_peaks_of_a_friction_forwards(puma: ps.Robot) -> None:
    """The motors inherited peaks of 44.59, 15.75 and 1.29 N m of joints 2 to 4; joints 2 and 3 need most to hold."""
    start, end = np.array([0.0, 1.0, -2.5, 0.0, 0.7, 0.0]), np.array([-1.0, 0.9, -2.6, 0.1, 0.5, 0.5])
    move = ps.compute_motion(
        puma, ps.profiles.double_s([start, end], max_velocity=1.5, max_acceleration=5, max_jerk=5000)
    )
    sizing = ps.size(ps.Cycle(steps=[move, ps.Dwell(duration=1.0)]), drivetrains=ps.load_drivetrains(puma))
    ratio = np.abs([drive.gear_ratio for drive in puma.actuators])
    held = np.abs(ps.inverse_dynamics(puma, end, np.zeros(6), np.zeros(6)))
    peaks = np.array([demand.peak_torque.size for demand in sizing.demands]) * ratio
    np.testing.assert_allclose(peaks[1:4], [held[1], held[2], 1.02], atol=0.005)


@pytest.mark.parametrize(
    ("sign", "peak", "rms", "energy"), [(1, 29.7806, 26.2897, 26.8614), (-1, 32.2850, 28.7847, 29.3659)]
)
def test_a_velocity_that_touches_zero_in_the_middle_keeps_its_sign(
    puma: ps.Robot, sign: int, peak: float, rms: float, energy: float
) -> None:
    """v ~ t^2 (4-t)^2 (t-2)^2: the sign of the whole piece was read where v is 0, and friction lost for all of it.

    Numbers by an independent recursive Newton-Euler.
    """
    v = np.polynomial.Polynomial([0.0, 0.0, 64.0, -96.0, 52.0, -12.0, 1.0])
    q = v.integ()
    times = np.array([0.0, 1.0, 3.0, 4.0])
    points = np.tile(BASE, (4, 1))
    points[:, 0] = sign * q(times) / q(4.0)
    result = ps.assess(puma, ps.septic(points, times))
    assert result.peak_torque[0] == pytest.approx(peak, abs=5e-5)
    assert result.rms_torque[0] == pytest.approx(rms, abs=5e-5)
    assert result.energy_in[0] == pytest.approx(energy, abs=5e-5)


def test_a_cubic_that_stops_in_the_middle_is_not_at_rest(puma: ps.Robot) -> None:
    """v = 3 (1 - 2 s)^2: 24.7 N m of friction were missing everywhere, and the joint was called still."""
    points, velocities = np.tile(BASE, (2, 1)), np.zeros((2, 6))
    points[1, 0], velocities[:, 0] = 1.0, 3.0
    motion = ps.compute_motion(puma, ps.profiles.cubic(points, [0.0, 1.0], velocities=velocities))
    assert motion.torque([0.2, 0.8])[:, 0] == pytest.approx([2.50381251, 59.49089151], abs=1e-7)
    assert motion.direction.coefficients[0, :, 0].tolist() == [1.0]


def test_a_joint_that_rests_but_for_rounding_rests(puma: ps.Robot) -> None:
    """Numeric inverse kinematics leaves 1e-13 rad at points that are equal: no friction is due for it."""
    points = np.tile(BASE, (4, 1))
    points[:, 0] = 0.0, 0.4, 0.9, 1.0
    points[:, 3] = 1e-13 * np.array([1.0, -2.0, 0.5, 1.0])
    exact = points.copy()
    exact[:, 3] = 0.0
    noisy, clean = (ps.assess(puma, ps.profiles.quintic_spline(p, [0, 1, 2, 3])) for p in (points, exact))
    np.testing.assert_allclose(noisy.rms_torque, clean.rms_torque, atol=1e-11)
    np.testing.assert_allclose(noisy.peak_torque, clean.peak_torque, atol=1e-11)
    assert not noisy.motion.direction.coefficients[0, :, 3].any()


@pytest.mark.parametrize("seed", range(20))
def test_nothing_jumps_when_an_input_changes_by_1e_12(puma: ps.Robot, seed: int) -> None:
    """Peaks, RMS and energies follow the input by its slope; a sign that flips would move them by Newton metres."""
    rng = np.random.default_rng(seed)
    points = BASE + rng.uniform(-0.6, 0.6, (4, 6))
    points[:, rng.integers(6)] = 0.3  # one joint rests
    points[2:, rng.integers(6)] = 0.1  # one rests in the last segment
    times = np.cumsum([0.0, *rng.uniform(0.4, 1.5, 3)])
    changed = points + rng.uniform(-1e-12, 1e-12, points.shape)
    for name in ("septic", "quintic_segments", "quintic_spline", "cycloidal", "quintic_spline"):
        one, other = (ps.assess(puma, getattr(ps.profiles, name)(p, times)) for p in (points, changed))
        for metric in ("peak_torque", "rms_torque", "energy_in", "energy_out", "peak_power"):
            np.testing.assert_allclose(
                getattr(other, metric), getattr(one, metric), atol=1e-8, rtol=1e-8, err_msg=f"{name} {metric}"
            )


def test_reversals_within_the_resolution_are_none() -> None:
    """A recorded signal ripples by less than its resolution; travel beyond that counts."""
    t = np.linspace(0.0, 2.0, 401)
    ripple = ps.Piecewise.fit(lambda t: (0.01 * t + 1e-4 * np.sin(300 * t))[:, None], t)
    turns = ripple.extrema_and_turns(1)[1]
    assert find_directions(ripple, turns, np.array([3e-4])).coefficients[0].tolist() == [[1.0]] * 400
    assert (find_directions(ripple, turns, np.array([0.0])).coefficients[0] == -1).any()


def test_a_recorded_rest_is_found_to_a_tenth_of_the_rest_time() -> None:
    rng = np.random.default_rng(0)
    t = np.arange(0.0, 4.0, 0.01)
    values = np.clip(t - 1.0, 0.0, 1.0) + rng.uniform(-5e-6, 5e-6, len(t))  # rests, moves from 1 to 2 s, rests
    powers = np.array([values[:-1], np.diff(values)])[:, :, None]
    signal = ps.Piecewise.from_power(t, powers)
    direction = find_directions(signal, signal.extrema_and_turns(1)[1], np.array([1e-4]))
    moving = direction.coefficients[0, :, 0] != 0
    start, end = direction.breaks[:-1][moving].min(), direction.breaks[1:][moving].max()
    assert start == pytest.approx(1.0, abs=REST_TIME / 10 + 0.01)
    assert end == pytest.approx(2.0, abs=REST_TIME / 10 + 0.01)
    assert direction.coefficients[0, moving, 0].tolist() == [1.0] * int(moving.sum())


@pytest.mark.parametrize(("wait", "resolution", "way"), [
    (5e-4, 0.0, 0.0), (1e-2, 0.0, 0.0), (5e-4, 1e-3, 1.0), (0.09, 1e-3, 1.0), (0.2, 1e-3, 0.0)])  # fmt: skip
def test_a_planned_wait_is_a_rest_and_equal_samples_are_not(wait: float, resolution: float, way: float) -> None:
    """A plan that is constant rests, however briefly; a log may repeat a sample while the arm moves on."""
    times = np.array([0.0, 1.0, 1.0 + wait, 2.0 + wait])
    signal = ps.Piecewise.from_power(times, [[[0.0], [1.0], [1.0]], [[1.0], [0.0], [1.0]]])
    direction = find_directions(signal, signal.extrema_and_turns(1)[1], np.array([resolution]))
    assert direction([0.5, 1.0 + wait / 2, 1.5 + wait]).ravel().tolist() == [1.0, way, 1.0]


def test_travel_at_the_resolution_of_any_motion_counts_as_rest() -> None:
    for size, expected in ((0.9 * STILL, 0.0), (1.1 * STILL, 1.0)):
        move = ps.quintic_segments([[0.3], [0.3 + size]], [0.0, 1.0])
        assert move.direction.coefficients[0].tolist() == [[expected]]


@pytest.mark.parametrize("origin", [1e5, 618085129.5458, 1.7e9])
def test_a_clock_far_from_zero_changes_nothing(puma: ps.Robot, origin: float) -> None:
    """Stamps since 1970 were refused, and the points and times blamed, which were fine."""
    points = np.array([[0.0, 0.6, -2.2, 0.0, 0.3, 0.0], [1.0, 1.2, -2.6, 0.2, 0.6, 0.1]])
    near, far = (ps.assess(puma, ps.profiles.quintic(points, [start, start + 3.0])) for start in (0.0, origin))
    for metric in ("peak_torque", "rms_torque", "peak_jerk", "energy_in"):
        np.testing.assert_allclose(getattr(far, metric), getattr(near, metric), rtol=1e-12)
    np.testing.assert_allclose(far.peak_torque_time - origin, near.peak_torque_time, atol=2.4e-7)  # the clock's digits


# ---- motions that start or end moving


def test_a_motion_that_starts_and_ends_moving_is_assessed_as_an_excerpt(puma: ps.Robot) -> None:
    """Every such motion was 'unbounded': the arm was taken to be at rest before and after it."""
    points = [BASE, BASE + 0.1, BASE + 0.2, BASE + 0.3]
    move = ps.septic(points, [0, 1, 2, 3], start_velocity=0.3, end_velocity=0.3)
    whole = ps.Trajectory(position=move.position, points=points, times=move.times)
    assert np.isinf(ps.assess(puma, whole).peak_torque).all()
    part = ps.assess(puma, whole.excerpt)
    samples = np.abs(part.motion.torque(np.linspace(0, 3, 30_001)))
    # Samples miss the side of a reversal that they do not fall on.
    np.testing.assert_allclose(part.peak_torque, samples.max(axis=0), rtol=1e-4)
    assert (part.peak_torque >= samples.max(axis=0) * (1 - 1e-12)).all()
    assert np.isfinite(part.peak_jerk).all()
    with pytest.raises(ps.InputError, match=r"dwell = 1 s: the motion ends moving \(rest_after=False\)"):
        ps.assess(puma, whole.excerpt, dwell=1.0)
    # What stops where it ends may be followed by a rest, of which it says nothing; so it is in a cycle.
    stops = ps.quintic_segments(points, [0, 1, 2, 3])
    rested = ps.assess(puma, stops.excerpt, dwell=1.0)
    np.testing.assert_allclose(rested.rms_torque, ps.assess(puma, stops, dwell=1.0).rms_torque, rtol=1e-14)
    cycle = ps.Cycle(steps=(ps.compute_motion(puma, stops.excerpt), ps.Dwell(duration=1.0)))
    np.testing.assert_allclose(rested.rms_torque, cycle.rms_torque, rtol=1e-12)
    with pytest.raises(ps.InputError, match="rest_before = 1: expected True or False"):
        ps.Trajectory(position=move.position, points=points, times=move.times, rest_before=1)  # type: ignore[arg-type]


def test_a_task_may_say_that_the_arm_is_moving_at_its_ends() -> None:
    document = {
        "name": "pass",
        "points": [{"joints": BASE.tolist()}, {"joints": (BASE + 0.3).tolist()}],
        "times": [0, 1],
        "profiles": ["linear"],
    }
    (struck,) = ps.assess_task(make_task(document))
    (free,) = ps.assess_task(make_task(document | {"rest_before": False, "rest_after": False}))
    assert np.isinf(struck.peak_torque).all()
    np.testing.assert_allclose(free.peak_velocity, 0.3, rtol=1e-12)
    assert np.isfinite(free.peak_torque).all()


# ---- rest counts


def test_a_dwell_counts_with_its_holding_torque() -> None:
    """A slow descent: friction helps while moving, so 47.096 N m; holding takes 49.039. RMS had it, the peak not."""
    puma = ps.load_robot().with_payload(ps.Payload(mass=2.5, com=(0, 0, 0.1)))
    points = np.tile([0.0, 0.2, -3.0, 0.0, 0.3, 0.0], (2, 1))
    points[1, 1] = -0.1
    move = ps.quintic_segments(points, [0.0, 6.0])
    moving, resting = ps.assess(puma, move), ps.assess(puma, move, dwell=60.0)
    held = ps.inverse_dynamics(puma, points[1], np.zeros(6), np.zeros(6))
    np.testing.assert_allclose(resting.holding_torque, held, rtol=1e-12, atol=1e-12)
    assert moving.peak_torque[1] == pytest.approx(47.096, abs=5e-4)
    assert abs(held[1]) == pytest.approx(49.039, abs=5e-4)
    assert resting.peak_torque[1] == pytest.approx(abs(held[1]))
    assert resting.peak_torque_time[1] == 6.0
    assert (resting.rms_torque <= resting.peak_torque).all()
    limited = puma.with_limits(effort=[56, abs(held[1]) * 0.98, 52, 10, 10, 10])
    assert [str(check)[:13] for check in ps.assess(limited, move, dwell=60.0).violations] == ["joint2 torque"]
    # Friction may carry its band: 13.6 N m upwards, 7.65 N m downwards at joint 2.
    positive, negative = puma.coulomb_friction[1]
    expected = held[1] - np.clip(held[1], -positive, -negative)
    assert resting.least_holding_torque[1] == pytest.approx(expected)
    assert any(f"joint2 {held[1]:.4g} ({expected:.4g})" in remark for remark in resting.remarks)
