"""Double-S: limits, boundary values, optimality, synchronisation, and requests that cannot be met."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import puma_septic as ps
from puma_septic.errors import InputError
from puma_septic.limit_check import AT_LIMIT
from puma_septic.profiles import double_s

Array = NDArray[np.float64]
LIMITS = {"max_velocity": 2.0, "max_acceleration": 3.0, "max_jerk": 8.0}

sizes = st.floats(0.2, 5.0)


@st.composite
def stops(draw: st.DrawFn) -> tuple[Array, dict[str, Array]]:
    """Four to six points of three joints, the second still, and each joint's limits."""
    k = draw(st.integers(4, 6))
    rows = draw(st.lists(st.tuples(st.floats(-3, 3), st.just(0.7), st.floats(-3, 3)), min_size=k, max_size=k))
    points = np.array(rows)
    assume((np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-3).all())
    limits = {name: np.array(draw(st.tuples(sizes, sizes, sizes))) for name in LIMITS}
    return points, limits


def test_seven_phases_of_a_long_move() -> None:
    # By hand: tj = a/j = 3/8, Ta = v/a + a/j = 2/3 + 3/8, cruise (h - v Ta) / v.
    move = double_s([[0.0], [5.0]], **LIMITS)
    ta = 2 / 3 + 3 / 8
    cruise = (5 - 2 * ta) / 2
    expected = np.cumsum([0, 3 / 8, ta - 6 / 8, 3 / 8, cruise, 3 / 8, ta - 6 / 8, 3 / 8])
    assert move.breaks == pytest.approx(expected, rel=1e-14)
    assert [move.extrema(k).peak[0] for k in (1, 2, 3)] == pytest.approx([2, 3, 8], rel=1e-13)


def test_short_move_without_constant_acceleration() -> None:
    # Four phases of tj with h = 2 j tj^3 (Biagiotti and Melchiorri, section 3.4), as long as j tj <= a.
    tj = 0.3
    move = double_s([[0.0], [2 * 8 * tj**3]], **LIMITS)
    assert move.breaks == pytest.approx(np.arange(5) * tj, rel=1e-12)


def test_velocity_may_differ_at_both_ends() -> None:
    move = double_s([[0.0], [5.0]], start_velocity=1.0, end_velocity=-0.5, **LIMITS)
    end = move.duration
    assert move(0.0, order=1) == pytest.approx([1.0], abs=1e-13)
    assert move(end, order=1) == pytest.approx([-0.5], abs=1e-13)
    assert move(end) == pytest.approx([5.0], abs=1e-13)
    # Ramps: dv = 1 < a^2/j takes 2 sqrt(1/8), dv = 2.5 takes 5/6 + 3/8; what is left is cruised at 2 rad/s.
    up, down = 2 * np.sqrt(1 / 8), 5 / 6 + 3 / 8
    assert end == pytest.approx(up + down + (5 - 1.5 * up - 0.75 * down) / 2, rel=1e-14)


@given(stops())
@settings(max_examples=40)
def test_stops_at_all_points_within_limits_and_at_one_of_them(task: tuple[Array, dict[str, Array]]) -> None:
    points, limits = task
    move = double_s(points, **limits)
    assert move.via_miss.max() < 1e-11
    assert np.abs(move(move.times, order=1)).max() < 1e-10
    assert np.abs(move(move.times, order=2)).max() < 1e-9
    for order, limit in enumerate(limits.values(), start=1):
        # Rounding of the jerk of phases that last a millisecond.
        assert (move.extrema(order).peak <= limit * (1 + 1e-6)).all()
    assert len(move.jumps(1).times) == len(move.jumps(2).times) == 0
    assert (move.overshoot < 1e-11).all()
    assert not move.position.coefficients[1:, :, 1].any()
    for left, right in zip(move.times, move.times[1:], strict=False):
        # Time-optimal: in each segment one joint has full jerk.
        inside = (move.breaks[:-1] >= left) & (move.breaks[:-1] < right)
        jerk = np.abs(move.derivative(3).coefficients[0, inside]).max(axis=0)
        assert (jerk / limits["max_jerk"]).max() == pytest.approx(1.0, abs=1e-6)


@given(stops(), st.floats(0.3, 3.0))
@settings(max_examples=20)
@pytest.mark.slow
def test_limits_over_powers_of_k_stretch_time_by_k(task: tuple[Array, dict[str, Array]], k: float) -> None:
    points, limits = task
    move = double_s(points, **limits)
    slower = double_s(points, **{name: limit / k**n for n, (name, limit) in enumerate(limits.items(), start=1)})
    assert slower.times == pytest.approx(k * move.times, rel=1e-12)
    t = np.linspace(0, move.duration, 60)
    assert np.abs(slower(np.minimum(k * t, slower.duration)) - move(t)).max() < 1e-10


@given(stops(), st.floats(0.3, 3.0), st.sampled_from([-1.0, 1.0]), st.floats(-3, 3))
@settings(max_examples=20)
def test_points_and_limits_scaled_scale_the_motion(
    task: tuple[Array, dict[str, Array]], factor: float, sign: float, shift: float
) -> None:
    points, limits = task
    move = double_s(points, **limits)
    other = double_s(sign * factor * points + shift, **{name: factor * limit for name, limit in limits.items()})
    t = np.linspace(0, min(move.duration, other.duration), 60)
    assert other.duration == pytest.approx(move.duration, rel=1e-9)
    assert np.abs(other(t) - (sign * factor * move(t) + shift)).max() < 1e-8


rounded = st.floats(-1, 1).map(lambda x: round(x, 6))


@given(st.lists(st.tuples(rounded, rounded, rounded), min_size=1, max_size=3))
@settings(max_examples=60)
def test_general_end_velocities_are_met_or_refused_with_a_reason(
    joints: list[tuple[float, float, float]],
) -> None:
    h, v0, v1 = np.array(joints).T * [[3.0], [1.0], [1.0]]
    points = np.stack([np.zeros_like(h), h])
    reason = ""
    try:
        move = double_s(points, start_velocity=v0, end_velocity=v1, **LIMITS)
    except InputError as error:
        reason = str(error)
    if reason:
        reasons = ("the velocity cannot change from", "it cannot be slowed down", "leave it without duration")
        assert any(known in reason for known in reasons)
        return
    ends = move.breaks[[0, -1]]
    assert np.abs(move(ends) - points).max() < 1e-9
    assert np.abs(move(ends, order=1) - [v0, v1]).max() < 1e-9
    assert np.abs(move(ends, order=2)).max() < 1e-8
    assert len(move.jumps(2).times) == 0
    for order, limit in enumerate(LIMITS.values(), start=1):
        assert (move.extrema(order).peak <= limit * (1 + 1e-6)).all()


def test_a_joint_that_starts_at_speed_slows_down_to_keep_in_step() -> None:
    """Joint 2 would be there first: it lowers its cruise velocity, down to the end velocities and below."""
    move = double_s([[0.0, 0.0], [6.0, 2.0]], start_velocity=[0.0, 0.9], end_velocity=[0.0, 0.9], **LIMITS)
    assert move(move.duration) == pytest.approx([6.0, 2.0], abs=1e-12)
    assert move(move.duration, order=1) == pytest.approx([0.0, 0.9], abs=1e-12)
    assert move(move.duration / 2, order=1)[1] < 0.9


def test_constant_velocity_is_kept_where_it_just_fits() -> None:
    """Bisection would miss it by 1e-8: near it, ramps last as long as the square root of what they change."""
    slow = double_s([[0.0], [6.0]], **LIMITS).duration
    move = double_s([[0.0, 0.0], [6.0, slow * 0.5]], start_velocity=[0, 0.5], end_velocity=[0, 0.5], **LIMITS)
    assert move.extrema(1).peak[1] == pytest.approx(0.5, abs=1e-12)
    assert move.extrema(2).peak[1] < 1e-9


@pytest.mark.parametrize(
    ("seconds", "is_possible"), [(2.7, True), (2.8, False), (3.7, False), (3.8, True), (20.0, True)]
)
def test_between_slow_and_fast_ways_there_may_be_no_duration(seconds: float, is_possible: bool) -> None:
    """By hand: from 1 to 1 rad/s with a jerk of 1 rad/s^3, both ramps by way of a cruise at c take 4 sqrt(1 - c) s and
    2 (1 + c) sqrt(1 - c) rad, at most 2.18. Of 2.1 rad they leave a way for c below 0.1181 and above 0.5275: so it
    takes 3.756 s or longer, or 2.750 s or less, and nothing between, whatever another joint takes.
    """
    other = seconds - 2e-3  # at 1 rad/s, but for v / a + a / j of its limits
    limits = {"max_velocity": [1.5, 1.0], "max_acceleration": [2.0, 1e3], "max_jerk": [1.0, 1e6]}
    moving = {"start_velocity": [1.0, 0.0], "end_velocity": [1.0, 0.0]}
    if not is_possible:
        with pytest.raises(
            InputError, match=rf"joint 1, .* slowed down to the {seconds} s that joint 2 takes: .* 2\.1 "
        ):
            double_s([[0.0, 0.0], [2.1, other]], **limits, **moving)
        return
    move = double_s([[0.0, 0.0], [2.1, other]], **limits, **moving)
    assert move.duration == pytest.approx(seconds, rel=1e-12)
    assert move([0.0, seconds], 1)[:, 0] == pytest.approx([1.0, 1.0], rel=1e-9)
    assert move(seconds)[0] == pytest.approx(2.1, rel=1e-12)
    assert move.extrema(3).peak[0] <= 1.0 + 1e-9
    assert move.extrema(1).min[0] > 0


def test_infeasible_requests_are_explained() -> None:
    points = [[0.0, 0.0], [0.1, 2.0]]
    with pytest.raises(InputError, match=r"joint 'elbow', segment 1: start_velocity of 3 exceeds max_velocity = 2"):
        double_s(points, start_velocity=[0.0, 3.0], joint_names=("waist", "elbow"), **LIMITS)
    # A change of 1 rad/s takes 2 sqrt(1/8) s at a mean of 0.5 rad/s.
    with pytest.raises(
        InputError,
        match=r"joint 1, segment 1: .* cannot change from 0 to 1 .* within 0.1: .*takes 0.353553 .rad, or m",
    ):
        double_s(points, end_velocity=1.0, **LIMITS)
    with pytest.raises(
        InputError, match=r"joint 2, segment 1: it cannot be slowed down to the 4.\d+ s that joint 1 takes"
    ):
        double_s([[0.0, 0.0], [6.0, 0.9]], start_velocity=[0, 1.5], end_velocity=[0, 1.5], **LIMITS)
    with pytest.raises(InputError, match="segment 2: equal points leave it without duration"):
        double_s([[0.0], [1.0], [1.0]], **LIMITS)


def test_missing_limits_are_named() -> None:
    points = [[0.0, 0.0], [1.0, 1.0]]
    for name, power in (("max_velocity", ""), ("max_acceleration", r"\^2"), ("max_jerk", r"\^3")):
        with pytest.raises(
            InputError, match=rf"double_s needs {name}, in rad/s{power} \(m/s{power} if prismatic\): it"
        ):
            double_s(points, **{key: value for key, value in LIMITS.items() if key != name})
        with pytest.raises(InputError, match=rf"double_s needs {name} in .*, which is unknown for joint 2"):
            double_s(points, **{**LIMITS, name: [1.0, np.nan]})
        with pytest.raises(InputError, match=rf"^{name} = 0 must be greater than 0"):
            double_s(points, **{**LIMITS, name: 0.0})
    with pytest.raises(InputError, match=r"double_s needs max_jerk in .*, which is unknown for all joints"):
        double_s(points, **{**LIMITS, "max_jerk": [np.nan, np.nan]}, joint_names=["a", "b"])
    with pytest.raises(InputError, match="double_s needs at least 2 points, got 1"):
        double_s(points[:1], **LIMITS)
    with pytest.raises(InputError, match=r"max_jerk: .*"):
        double_s(points, **{**LIMITS, "max_jerk": [1.0, 2.0, 3.0]})


def wide_limits(rng: np.random.Generator, decades: float) -> dict[str, Array]:
    jerk = 10 ** rng.uniform(1, decades, 6)
    return {
        "max_velocity": rng.uniform(0.5, 3, 6), "max_acceleration": rng.uniform(1, 20, 6), "max_jerk": jerk,
    }  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("count", [2, 5, 20])
@pytest.mark.parametrize(("smallest", "decades"), [(0, 2.5), (-3, 2.5), (-3, 6), (-9, 6)])
def test_limits_are_kept_to_rounding_at_any_scale(
    count: int, smallest: float, decades: float, rng: np.random.Generator
) -> None:
    """At a robot's own limits 57 of 200 motions through 20 points were judged infeasible by up to 2e-10, 1e-9 at three
    decades of scale, and at ten decades the motion was wrong by percents, in silence.

    A phase of constant jerk far shorter than the motion is shortened by rounding of its instants, and made longer by
    as much.
    """
    for _ in range(25):
        limits = wide_limits(rng, decades)
        points = rng.uniform(-2, 2, (count, 6)).round(2) * 10 ** rng.uniform(smallest, 0, (count, 6))
        move = double_s(points, **limits)
        for order, limit in enumerate(limits.values(), start=1):
            assert (move.extrema(order).peak <= limit * (1 + AT_LIMIT / 100)).all()
        assert len(move.jumps(1).times) == len(move.jumps(2).times) == 0
        assert not move.via_miss.any()


def test_at_the_robots_own_limits_it_is_feasible(rng: np.random.Generator) -> None:
    robot = ps.load_robot()
    for _ in range(3):
        limits = wide_limits(rng, 2.5)
        kept = robot.with_limits(effort=np.nan, **{name[4:]: value for name, value in limits.items()})
        low, high = robot.limits.position.T
        points = rng.uniform(low, high, (8, 6)).round(2).clip(low, high)
        assert ps.assess(kept, double_s(points, **limits)).is_feasible


@pytest.mark.parametrize("max_jerk", [1e6, 1e7, 1e9, 1e12])
def test_no_limit_of_jerk_written_as_a_big_number(max_jerk: float) -> None:
    """The move is that of a trapezoid of velocity, later by the time that the jerk needs."""
    points = [[0, 0.6, -2.2, 0, 0.3, 0], [0.3, 0.7, -2.3, 0.1, 0.4, 0.1]]
    move = double_s(points, max_velocity=1, max_acceleration=5, max_jerk=max_jerk)
    # 0.3 rad with 1 rad/s and 5 rad/s^2: 0.3 + 1/5 s, and a/j for the jerk (by hand).
    assert move.duration == pytest.approx(0.5 + 5 / max_jerk, rel=1e-11)
    assert (move.extrema(2).peak <= 5 * (1 + 1e-12)).all()
    assert (move.extrema(3).peak <= max_jerk * (1 + 1e-12)).all()
    assert len(move.jumps(2).times) == 0


def test_a_jerk_that_double_precision_does_not_resolve_is_refused() -> None:
    with pytest.raises(
        InputError,
        match=r"joint 'waist', segment 1: with max_acceleration = 5 and max_jerk = 1e\+14 .* its jerk acts for 5e-14 s"
        r" at t = 0 s, which double precision does not resolve in a motion of 0.5 s; lower max_jerk, or take profile",
    ):
        double_s([[0.0], [0.3]], max_velocity=1, max_acceleration=5, max_jerk=1e14, joint_names=["waist"])


@pytest.mark.parametrize("max_jerk", [1e6, 1e7, 1e8, 1e9, 1e10])
def test_without_a_limit_of_jerk_the_torque_is_that_of_constant_accelerations(max_jerk: float) -> None:
    """Refused at 1e7 ("points and times meant?"); later joint 3 was charged no friction for its last nanoseconds, in
    which it is slow because it stops, and its peak was 9.19 instead of 3.55 N m.

    Not the move in which all joints blend as long as the quickest, 0.2 s: there joint 2 reaches 0.33 instead of
    0.4 rad/s and takes 61.04 instead of 63.08 N m. Both numbers are confirmed by an independent recursive Newton-Euler
    from the DH table with friction of the sign of travel, on 400,001 samples.
    """
    points = np.array([[0, 0.6, -2.2, 0, 0.3, 0], [0.3, 0.7, -2.3, 0.1, 0.4, 0.1]])
    robot = ps.load_robot()
    move = double_s(points, max_velocity=1, max_acceleration=5, max_jerk=max_jerk)
    # By hand: joint 1 accelerates with 5 rad/s^2 for 0.2 s, cruises and stops in 0.5 s; the others need no cruise and
    # are stretched to it, with 4 h/T^2 for half of it.
    breaks = np.array([0.0, 0.2, 0.25, 0.3, 0.5])
    acceleration = np.array([[5.0, 1.6], [0.0, 1.6], [0.0, -1.6], [-5.0, -1.6]])
    velocity = np.concatenate([[[0.0, 0.0]], np.cumsum(acceleration * np.diff(breaks)[:, None], axis=0)])
    h = np.diff(breaks)[:, None]
    powers = np.stack([np.zeros((4, 2)), velocity[:-1] * h, acceleration * h**2 / 2])
    powers[0, 1:] = np.cumsum(powers[1] + powers[2], axis=0)[:-1]
    along = powers[:, :, [0, 1, 1, 1, 1, 1]] * np.sign(np.diff(points, axis=0)[0])
    along[0] += points[0]
    limit = ps.Trajectory(
        position=ps.Piecewise.from_power(breaks, along), points=points, times=breaks[[0, -1]], profile="bang_bang"
    )
    expected = ps.assess(robot, limit).peak_torque
    assert expected[:3] == pytest.approx([50.7612, 63.0848, 3.5526], abs=1e-4)
    # What the jerk takes is of the order of its time, 5 us of 0.5 s at most.
    np.testing.assert_allclose(ps.assess(robot, move).peak_torque, expected, rtol=1e-4, atol=1e-4)
    together = ps.profiles.trapezoidal(points, breaks[[0, -1]], blend_time=0.2)
    assert ps.assess(robot, together).peak_torque[:3] == pytest.approx([50.6863, 61.0353, 3.5722], abs=1e-4)
