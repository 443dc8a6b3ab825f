"""Trajectory: what is true of any joint-space motion."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import puma_septic as ps

Array = NDArray[np.float64]
seeds = st.integers(0, 10**6)
FAMILIES = ("septic", "lspb", "quintic_segments")


def random_points(seed: int, *, n: int = 3) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    return rng.uniform(-3, 3, (4, n)), rng.uniform(-5, 5) + np.array([0.0, *np.cumsum(rng.uniform(0.5, 3, 3))])


def make(family: str, points: Array, times: Array) -> ps.Trajectory:
    """A trajectory of the family through the points; lspb starts at 0, whatever the times."""
    if family == "lspb":
        durations = np.diff(times)
        return ps.lspb(points, durations=durations, blend_time=0.4 * durations.min())
    return {"septic": ps.septic, "quintic_segments": ps.quintic_segments}[family](points, times)


def from_powers(breaks: list[float], *pieces: list[float]) -> ps.Trajectory:
    """One joint; each piece by powers of the time since its break over its length."""
    degree = max(len(p) for p in pieces)
    powers = np.array([p + [0.0] * (degree - len(p)) for p in pieces]).T[:, :, None]
    position = ps.Piecewise.from_power(breaks, powers)
    return ps.Trajectory(position=position, points=position(breaks), times=np.array(breaks))


# --- making one ---------------------------------------------------------------------------------------


def test_a_jump_of_the_position_is_refused() -> None:
    with pytest.raises(ps.InputError, match=r"joint 1: position jumps by 0\.5 rad at t = 1 s; .*must be continuous"):
        from_powers([0.0, 1.0, 2.0], [0.0, 1.0], [1.5, 1.0])


def test_a_step_of_the_smallest_number_is_no_jump() -> None:
    """Of positions about 1e-320 the tolerance was zero, and a via of 5e-324 rad made them jump."""
    move = ps.quintic_segments([[0.0], [5e-324], [0.0]], [0.0, 1.0, 2.0])
    assert move.extrema(0).peak <= 1e-320


def test_a_jump_is_told_by_the_joint_s_name() -> None:
    position = ps.Piecewise(breaks=[0.0, 1.0, 2.0], coefficients=[[[1.0, 1.0], [1.0, 1.001]]])
    with pytest.raises(ps.InputError, match=r"joint 'elbow': position jumps by 0\.001 rad at t = 1 s"):
        ps.Trajectory(position=position, points=position([0.0]), times=[0.0], joint_names=("base", "elbow"))


def test_bad_arguments_are_refused() -> None:
    position = ps.Piecewise(breaks=[0.0, 1.0], coefficients=np.ones((1, 1, 2)))
    with pytest.raises(ps.InputError, match="joint_names: 1 names for 2 joints"):
        ps.Trajectory(position=position, points=[[1.0, 1.0]], times=[0.0], joint_names=("base",))
    with pytest.raises(ps.InputError, match=r"points: shape \(1, 3\) is not \(1, 2\)"):
        ps.Trajectory(position=position, points=[[1.0, 1.0, 1.0]], times=[0.0])
    with pytest.raises(ps.InputError, match=r"times\[0\] = 0 s is followed by 0 s"):
        ps.Trajectory(position=position, points=[[1.0, 1.0]] * 2, times=[0.0, 0.0])


def test_an_unknown_order_lists_the_valid_ones() -> None:
    move = ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0])
    for order in (4, -1, 0.5, None, "velocity"):
        message = r"order = .* is not one of 0 \(position\), 1 \(velocity\), 2 \(acceleration\), 3 \(jerk\)"
        for ask in (lambda k: move(0.5, order=k), move.derivative, move.extrema, move.jumps, move.unbounded, move.peak):
            with pytest.raises(ps.InputError, match=message):
                ask(order)  # type: ignore[operator]


def test_what_is_no_truth_value_is_no_rest() -> None:
    for name in ("rest_before", "rest_after"):
        with pytest.raises(ps.InputError, match=f"{name} = 1: expected True or False"):
            replace(ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0]), **{name: 1})


@pytest.mark.parametrize(("step", "is_refused"), [(1.9e-9, False), (2.1e-9, True)])
def test_a_position_may_jump_by_a_billionth_of_the_largest(step: float, is_refused: bool) -> None:
    """Of each joint: the second, which swings a million times farther, does not excuse the first."""
    powers = np.array([[[0.0, 0.0], [2.0 + step, 2e6]], [[2.0, 2e6], [0.0, 0.0]]])
    position = ps.Piecewise.from_power([0.0, 1.0, 2.0], powers)
    if is_refused:
        with pytest.raises(ps.InputError, match=r"joint 1: position jumps by 2.1e-09 rad at t = 1 s"):
            ps.Trajectory(position=position, points=position([0.0]), times=[0.0])
    else:
        assert ps.Trajectory(position=position, points=position([0.0]), times=[0.0]).n_joints == 2


def test_times_outside_the_span_are_refused() -> None:
    move = ps.quintic_segments([[0.0], [1.0]], [2.0, 3.0])
    for t in (1.999, 3.001, [2.5, 0.0], np.nan):
        with pytest.raises(ps.InputError, match=r"t = \S+ s is outside the span \[2, 3\] s"):
            move(t, order=1)


# --- evaluation -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("family", FAMILIES)
def test_shapes(family: str) -> None:
    move = make(family, *random_points(1, n=3))
    for order in range(4):
        assert move(move.breaks[0], order).shape == (3,)
        assert move(np.linspace(*move.breaks[[0, -1]], 7), order).shape == (7, 3)
    assert move.n_joints == 3
    assert move.duration == pytest.approx(move.times[-1] - move.times[0], rel=1e-15)
    assert move.profile == family


@pytest.mark.parametrize("family", FAMILIES)
@given(seed=seeds)
@hypothesis_settings(max_examples=15)
def test_derivatives_are_differences_of_the_position(family: str, seed: int) -> None:
    """Two ways: the series' derivative, and central differences of one order below."""
    move = make(family, *random_points(seed))
    h = 1e-5 * move.duration
    t = np.linspace(*move.breaks[[0, -1]], 40)[1:-1]
    t = t[np.abs(t[:, None] - move.breaks).min(axis=1) > 2 * h]
    for order in (1, 2, 3):
        differences = (move(t + h, order - 1) - move(t - h, order - 1)) / (2 * h)
        scale = np.abs(move(t, order)).max() + np.abs(differences).max()
        # h^2 / 6 of the derivative two orders up, which short blends make large, and rounding over h.
        np.testing.assert_allclose(differences, move(t, order), rtol=0, atol=1e-5 * scale)


@pytest.mark.parametrize("family", FAMILIES)
@given(seed=seeds)
@hypothesis_settings(max_examples=15)
def test_power_coefficients_are_the_function(family: str, seed: int) -> None:
    """Two ways: Chebyshev series in one call, and powers of t - breaks[i] one number at a time."""
    move = make(family, *random_points(seed))
    powers = move.power_coefficients()
    assert powers.shape[0] == len(move.breaks) - 1
    assert powers.shape[2] == 3
    for i, (left, right) in enumerate(zip(move.breaks[:-1], move.breaks[1:], strict=True)):
        for t in np.linspace(left, right, 5)[:-1]:
            for j in range(3):
                p = np.polynomial.Polynomial(powers[i, :, j])
                for order in range(4):
                    expected = p.deriv(order)(t - left) if order else p(t - left)
                    scale = 1 + np.abs(move.derivative(order).coefficients).sum(axis=0).max()
                    # Powers of degree 7 are ill conditioned: some 1e4 roundings.
                    assert move(t, order)[j] == pytest.approx(expected, abs=1e-11 * scale)


# --- peaks -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("family", FAMILIES)
@given(seed=seeds)
@example(seed=88160)  # the septic's ends before t = 0, where the instant before a break was one outside the span
@example(seed=999234)  # and the quintic's
@example(seed=316)  # lspb's jerk is largest just after a break, which samples at even steps passed by
@hypothesis_settings(max_examples=15)
def test_exact_peaks_against_dense_samples(family: str, seed: int) -> None:
    move = make(family, *random_points(seed))
    # From the right of each break to just before the next, by more than a rounding of the time since the start.
    before = move.breaks[1:] - 4 * np.spacing(np.abs(move.breaks).max() + move.duration)
    t = np.linspace(move.breaks[:-1], before, 5_001).ravel()
    for order in range(4):
        found, sampled = move.extrema(order), move(t, order)
        size = found.peak.max()
        # Samples miss a peak inside by curvature * step^2 / 8, at most 1.6e-5 of a septic by Markov's inequality.
        assert (found.max >= sampled.max(axis=0) - 1e-9 * size).all()
        assert (found.min <= sampled.min(axis=0) + 1e-9 * size).all()
        np.testing.assert_allclose(found.max, sampled.max(axis=0), rtol=0, atol=2e-5 * size)
        np.testing.assert_allclose(found.min, sampled.min(axis=0), rtol=0, atol=2e-5 * size)


@pytest.mark.parametrize("family", FAMILIES)
@given(seed=seeds, k=st.sampled_from([0.25, 0.5, 3.0, 17.0]))
@hypothesis_settings(max_examples=15)
def test_stretching_time_divides_the_derivatives(family: str, seed: int, k: float) -> None:
    """By k, k^2 and k^3, and moves their instants along."""
    points, times = random_points(seed)
    move, slow = make(family, points, times), make(family, points, k * times)
    for order in range(4):
        found, expected = slow.extrema(order), move.extrema(order)
        np.testing.assert_allclose(found.peak * k**order, expected.peak, rtol=1e-9)
        assert len(slow.jumps(max(order, 1)).times) == len(move.jumps(max(order, 1)).times)


@pytest.mark.parametrize("family", FAMILIES)
@given(seed=seeds, factor=st.sampled_from([-1.0, 1e-3, 4.0]), offset=st.sampled_from([0.0, -2.0, 50.0]))
@hypothesis_settings(max_examples=15)
def test_scaling_and_shifting_the_points_scales_and_shifts_the_motion(
    family: str, seed: int, factor: float, offset: float
) -> None:
    points, times = random_points(seed)
    move, other = make(family, points, times), make(family, factor * points + offset, times)
    t = np.linspace(*move.breaks[[0, -1]], 50)
    reach = np.abs(move.position.coefficients).sum(axis=0).max()
    atol = 1e-12 * (reach * abs(factor) + abs(offset))
    np.testing.assert_allclose(other(t), factor * move(t) + offset, rtol=0, atol=atol)
    # The offset's rounding, seen through a derivative over the shortest interval.
    steepness = 50 / np.diff(move.breaks).min()
    np.testing.assert_allclose(other(t, 1), factor * move(t, 1), rtol=0, atol=atol * steepness)


@pytest.mark.parametrize("family", FAMILIES)
@given(seed=seeds)
@hypothesis_settings(max_examples=10)
def test_a_motion_that_starts_later_is_the_same(family: str, seed: int) -> None:
    points, times = random_points(seed)
    times = times - times[0]
    early, late = make(family, points, times), make(family, points, times + 1000.0)
    shift = late.breaks[0] - early.breaks[0]
    t = np.linspace(0.0, times[-1], 30)
    np.testing.assert_allclose(late(np.clip(t + shift, *late.breaks[[0, -1]])), early(t), rtol=0, atol=1e-10)
    for order in (1, 2, 3):
        np.testing.assert_allclose(late.jumps(order).times, early.jumps(order).times + shift, rtol=0, atol=1e-9)
        np.testing.assert_allclose(late.extrema(order).t_max - shift, early.extrema(order).t_max, rtol=0, atol=1e-5)


@pytest.mark.parametrize("family", FAMILIES)
def test_a_joint_that_is_not_asked_to_move_is_exactly_still(family: str) -> None:
    """Its Coulomb friction depends on it: velocity noise would be a direction."""
    points, times = random_points(3, n=3)
    points[:, 1] = -3.1416
    move = make(family, points, times)
    t = np.linspace(*move.breaks[[0, -1]], 101)
    assert (move(t)[:, 1] == -3.1416).all()
    for order in (1, 2, 3):
        assert (move(t, order)[:, 1] == 0.0).all()
        assert move.extrema(order).peak[1] == 0.0
    assert len(move.derivative(1).roots()[1]) == 0
    assert (move.jumps(3).sizes[:, 1] == 0.0).all()


# --- steps -------------------------------------------------------------------------------------------------


def test_the_ends_are_held_against_rest() -> None:
    """Constant speed throughout: nothing steps inside, everything does at the ends."""
    line = from_powers([0.0, 2.0], [1.0, 6.0])
    jumps = line.jumps(1)
    assert jumps.times.tolist() == [0.0, 2.0]
    np.testing.assert_allclose(jumps.sizes.ravel(), [3.0, -3.0], rtol=1e-14)
    assert len(line.jumps(2).times) == 0


def test_steps_inside() -> None:
    """Speed 1, then 2, then back: position goes on, velocity steps at each break."""
    legs = from_powers([0.0, 1.0, 3.0, 4.0], [0.0, 1.0], [1.0, 4.0], [5.0, -5.0])
    np.testing.assert_allclose(legs.jumps(1).times, [0.0, 1.0, 3.0, 4.0])
    np.testing.assert_allclose(legs.jumps(1).sizes.ravel(), [1.0, 1.0, -7.0, 5.0], rtol=1e-13)
    with pytest.raises(ps.InputError, match="position of a trajectory never jumps; valid: 1, 2, 3"):
        legs.jumps(0)


def test_an_excerpt_need_not_start_and_end_at_rest() -> None:
    line = from_powers([0.0, 2.0], [1.0, 6.0])
    assert line.excerpt.jumps(1).times.tolist() == []
    assert replace(line, rest_before=False).jumps(1).times.tolist() == [2.0]
    assert replace(line, rest_after=False).jumps(1).times.tolist() == [0.0]


@pytest.mark.parametrize(("order", "part"), [(1, 1e-9), (2, 1e-7), (3, 1e-9)])
@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_how_small_a_step_is_one(order: int, part: float, factor: float) -> None:
    """A part of the largest velocity, acceleration (0.1 of it, as fits lose digits) or jerk of any joint: here 1e3."""
    powers = np.zeros((4, 2, 2))
    powers[order, 0, 1] = 1e3 / math.factorial(order)
    # The same power, one interval on.
    powers[: order + 1, 1, 1] = [math.comb(order, k) * powers[order, 0, 1] for k in range(order + 1)]
    powers[order, 1, 0] = 1e3 * part * factor / math.factorial(order)
    position = ps.Piecewise.from_power([0.0, 1.0, 2.0], powers)
    move = ps.Trajectory(position=position, points=position([0.0]), times=[0.0]).excerpt
    found = move.jumps(order)
    # The second joint's derivative is constant, 1e3, but rounded.
    assert found.times.tolist() == ([1.0] if factor > 1 else [])
    np.testing.assert_allclose(found.sizes.ravel(), [1e3 * part * factor, 0.0][: 2 * len(found.times)], rtol=1e-4)


def test_acceleration_steps_of_a_bang_bang_motion() -> None:
    """Half the way with acceleration 4 h / T^2, half with its negative (profiles of constant acceleration)."""
    bang = from_powers([0.0, 1.0, 2.0], [0.0, 0.0, 0.5], [0.5, 1.0, -0.5])
    assert len(bang.jumps(1).times) == 0
    np.testing.assert_allclose(bang.jumps(2).sizes.ravel(), [1.0, -2.0, 1.0], rtol=1e-13)
    np.testing.assert_allclose(bang.extrema(2).peak, [1.0], rtol=1e-14)


def test_what_is_unbounded() -> None:
    """A step of the velocity makes acceleration and jerk infinite, one of the acceleration the jerk."""
    rest = [0.0, 0.0, 0.0, 10.0, -15.0, 6.0]
    powers = np.zeros((6, 2, 3))
    powers[:, 0, 0] = rest
    powers[0, 1, 0] = 1.0
    powers[[0, 1], 0, 1], powers[[0, 1], 1, 1] = [0.0, 1.0], [1.0, 2.0]
    powers[2, 0, 2], powers[[0, 1, 2], 1, 2] = 0.5, [0.5, 1.0, -0.5]
    position = ps.Piecewise.from_power([5.0, 6.0, 7.0], powers)
    move = ps.Trajectory(position=position, points=position([5.0]), times=[5.0])
    np.testing.assert_array_equal(move.unbounded(1), [np.nan] * 3)
    np.testing.assert_array_equal(move.unbounded(2), [np.nan, 5.0, np.nan])
    np.testing.assert_array_equal(move.unbounded(3), [np.nan, 5.0, 5.0])
    peak, t_peak = move.peak(3)
    np.testing.assert_allclose(peak, [60.0, np.inf, np.inf], rtol=1e-12)
    assert t_peak.tolist() == [5.0, 5.0, 5.0]
    np.testing.assert_allclose(move.peak(2)[0], [5.7735, np.inf, 1.0], rtol=1e-5)


@pytest.mark.parametrize("family", ["septic", "quintic_segments", "lspb"])
@given(seed=seeds)
@hypothesis_settings(max_examples=25)
def test_rounding_is_no_step(family: str, seed: int) -> None:
    """All three are continuous to the acceleration, at the ends as well, however large the angles."""
    points, times = random_points(seed)
    move = make(family, 100 * points + 300, times)
    assert len(move.jumps(1).times) == 0
    assert len(move.jumps(2).times) == 0
    assert np.isnan(move.unbounded(3)).all()


@given(seed=seeds, part=st.sampled_from([1e-6, 1e-4, 1e-2]))
@hypothesis_settings(max_examples=10)
def test_a_small_step_is_one(seed: int, part: float) -> None:
    """A motion that is cut off before its end, and at rest after it, stops with a jerk of the arm."""
    points, times = random_points(seed, n=1)
    v = np.zeros((4, 1))
    v[-1] = part
    move = ps.quintic_segments(points, times, velocities=v)
    assert move.rest_before
    assert not move.rest_after
    jumps = replace(move, rest_after=True).jumps(1)
    assert jumps.times.tolist() == [times[-1]]
    np.testing.assert_allclose(jumps.sizes, [[-part]], rtol=1e-6)


def test_a_jerk_step_within_a_high_degree_on_a_short_interval_is_seen() -> None:
    """Once the bound grew with the degree's sixth power, whatever the coefficients: 7 rad/s^3 at degree 64 in 0.1 s."""
    series = 0.3 * 0.6 ** np.arange(65.0)
    smooth = ps.Piecewise(breaks=[0.0, 0.2], coefficients=series[:, None, None]).split([0.1])
    cubic = np.zeros((4, 2, 1))
    cubic[3, 1] = 5.0 / 6 * 0.1**3
    step = ps.Piecewise.from_power(smooth.breaks, cubic)
    for position, expected in ((smooth, []), (smooth + step, [0.1])):
        move = ps.Trajectory(position=position, points=position([0.0]), times=[0.0])
        jumps = move.jumps(3)
        inside = (jumps.times > 0) & (jumps.times < 0.2)
        assert jumps.times[inside].tolist() == expected
        # The noise that resampling leaves, measured 0.2.
        np.testing.assert_allclose(jumps.sizes[inside].ravel(), np.full(len(expected), 5.0), atol=0.4)


@pytest.mark.parametrize("name", ["bang_bang", "modified_sine", "bspline_control", "septic_spline"])
@given(seed=seeds, late=st.sampled_from([0.0, 30.0, 1e3]), length=st.sampled_from([1e-3, 1.0, 1e4]))
@hypothesis_settings(max_examples=15)
def test_rounding_is_no_step_however_late_or_short(name: str, seed: int, late: float, length: float) -> None:
    """What a profile promises to be continuous is, also for tiny moves far from zero."""
    rng = np.random.default_rng(seed)
    times = late + length * np.array([0.0, *np.cumsum(rng.uniform(0.3, 1.5, 5))])
    points = rng.uniform(-3, 3) + 10.0 ** rng.uniform(-6, 0) * rng.uniform(-1, 1, (6, 3))
    move = getattr(ps.profiles, name)(points, times)
    promised = next(info.continuity for info in ps.profiles.available() if info.name == name)
    for order in range(1, min(3, int(promised[1])) + 1):
        assert len(move.jumps(order).times) == 0


# --- beyond the points ------------------------------------------------------------------------------------------


def test_overshoot_is_the_excess_beyond_the_hull_of_the_points() -> None:
    parabola = ps.Piecewise.from_power([0.0, 2.0], np.array([[0.0, 0.0], [4.0, 1.0], [-4.0, 0.0]])[:, None, :])
    move = ps.Trajectory(position=parabola, points=[[0.0, 0.0], [0.0, 1.0]], times=[0.0, 2.0])
    np.testing.assert_allclose(move.overshoot, [1.0, 0.0], rtol=1e-14)
    wider = ps.Trajectory(position=parabola, points=[[0.25, 0.0], [0.75, 1.0]], times=[0.0, 2.0])
    np.testing.assert_allclose(wider.overshoot, [0.25, 0.0], rtol=1e-14)
    np.testing.assert_allclose(wider.via_miss, [0.75, 0.0], rtol=1e-14)


@pytest.mark.parametrize(("off", "counts"), [(0.9e-7, False), (1.2e-7, True)])
def test_a_miss_is_held_against_how_far_the_joint_is_from_zero(off: float, counts: bool) -> None:
    """At 1e6 rad, 1e-13 of it is rounding, however slow the joint is; beside it, at 1 rad, the same is a miss."""
    line = ps.Piecewise.from_power([0.0, 1.0], [[[1e6, 1.0]], [[1.0, 1.0]]])
    move = ps.Trajectory(position=line, points=[[1e6 + off, 1.0 + off], [1e6 + 1 - off, 2.0 - off]], times=[0.0, 1.0])
    for found in (move.via_miss, move.overshoot):
        # The clock of a double at 1e6 has steps of 1.2e-10.
        assert found == pytest.approx([off * counts, off], abs=1.3e-10)


@given(seed=seeds)
@hypothesis_settings(max_examples=20)
def test_what_visits_its_points_at_rest_misses_none_and_overshoots_none(seed: int) -> None:
    move = ps.quintic_segments(*random_points(seed))
    assert (move.overshoot == 0).all()
    assert (move.via_miss == 0).all()


@given(seed=seeds)
@hypothesis_settings(max_examples=20)
def test_a_septic_visits_its_points(seed: int) -> None:
    move = ps.septic(*random_points(seed))
    assert (move.via_miss < 1e-10).all()
    reach = move.extrema(0)
    excess = np.maximum(reach.max - move.points.max(axis=0), move.points.min(axis=0) - reach.min)
    np.testing.assert_allclose(move.overshoot, excess, rtol=0, atol=1e-12)


def test_what_is_kept_cannot_be_written_to() -> None:
    """Extrema are computed once and shared: a caller could once change the next one's answer."""
    move = ps.septic([[0.0], [0.5], [1.0], [1.5]], [0.0, 1.0, 2.0, 3.0])
    for array in (move.extrema(0).max, move.extrema(2).t_min, move.jumps(3).times, move.jumps(3).sizes):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_the_first_step_counts_whichever_way_it_goes() -> None:
    """Straight down from rest: the velocity steps at once, downwards, and back up at the end."""
    move = ps.profiles.linear([[1.0], [0.0]], [2.0, 5.0])
    assert move.unbounded(2).tolist() == [2.0]


def test_of_many_points_a_picture_marks_both_ends() -> None:
    points = np.linspace(0.0, 1.0, 101)[:, None]
    times, marked = ps.profiles.linear(points, np.arange(101.0)).marked
    assert (times.tolist(), marked.ravel().tolist()) == ([0.0, 100.0], [0.0, 1.0])
    times, marked = ps.profiles.linear(points[:100], np.arange(100.0)).marked
    assert (len(times), marked.ravel().tolist()) == (100, points[:100, 0].tolist())


@pytest.mark.parametrize("factor", [0.3, 1.0, 2.5])
def test_a_stretched_motion_has_what_a_search_of_its_own_finds(rng: np.random.Generator, factor: float) -> None:
    """Law: the extrema of derivative r are divided by the factor to the power r, and turns are where they were."""
    points = rng.uniform(-1, 1, (4, 3))
    points[:, 1] = 0.2  # at rest
    move = ps.septic(points, [5.0, 6.0, 8.0, 9.0])
    untouched = move.stretched(factor)
    assert not {"_searched", "direction"} & set(untouched.__dict__)
    assert move.direction.n_components == 3
    slower = move.stretched(factor)
    assert {"_searched", "direction"} <= set(slower.__dict__)
    for order in range(4):
        found, own = slower.extrema(order), untouched.extrema(order)
        for name in ("min", "max", "t_min", "t_max"):
            assert getattr(found, name) == pytest.approx(getattr(own, name), rel=1e-9, abs=1e-9), (order, name)
    assert slower.direction.breaks == pytest.approx(untouched.direction.breaks, abs=1e-8)
    assert (slower.direction.coefficients == untouched.direction.coefficients).all()
    assert slower.duration == pytest.approx(4 * factor)
    assert slower.times == pytest.approx(5.0 + factor * np.array([0.0, 1.0, 3.0, 4.0]), rel=1e-15)
    assert slower(slower.times) == pytest.approx(points, abs=1e-12)


@pytest.mark.parametrize("resolution", [0.0, 1e-3])
def test_a_stretched_motion_turns_where_it_did_whenever_it_starts(rng: np.random.Generator, resolution: float) -> None:
    """Its turns are times since the start; taken for times they lay before it, and friction lost all reversals."""
    move = replace(ps.septic(rng.uniform(-1, 1, (4, 3)), [1000.0, 1001.0, 1003.0, 1004.0]), resolution=resolution)
    expected = move.stretched(2.5).direction
    move.extrema(1)
    found = move.stretched(2.5).direction
    assert len(found.breaks) > 3
    assert found.breaks == pytest.approx(expected.breaks, abs=1e-6)
    assert (found.coefficients == expected.coefficients).all()


def test_a_stretched_recording_finds_its_rests_anew() -> None:
    """A joint that creeps through its resolution in 0.09 s does not rest; over twice that time it does."""
    move = replace(ps.profiles.linear([[0.0], [1.0], [1.0009], [2.0]], [0.0, 1.0, 1.09, 2.0]), resolution=1e-3)
    assert (move.direction.coefficients[0] == 1).all()
    slower = move.stretched(2.0)
    assert "direction" not in slower.__dict__
    assert slower.direction(2.09).tolist() == [0.0]


def test_a_stretched_motion_on_a_late_clock_has_its_instants_in_its_span() -> None:
    """Bug: one time in sixteen the last of `times`, a rounding behind the end, was refused as outside the span."""
    rng = np.random.default_rng(0)
    for _ in range(100):
        late, factor = 10 ** rng.uniform(0, 6), 10 ** rng.uniform(-1, 2)
        move = ps.quintic_segments([[0.0], [1.0], [0.5]], np.cumsum(rng.uniform(0.1, 2.0, 3))).shifted(late)
        assert move.extrema(1).max > 0
        slower = move.stretched(factor)
        np.testing.assert_allclose(slower(slower.times), move.points, atol=1e-6)
        np.testing.assert_array_equal(slower.times, slower.breaks)
        for order in (0, 1, 2, 3):
            slower(slower.peak(order)[1], order)


def test_what_is_no_number_moves_and_stretches_nothing_and_what_is_no_flag_is_no_rest() -> None:
    move = ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0])
    for wrong in ("a", True, np.nan, [1.0, 2.0]):
        with pytest.raises(ps.InputError, match="seconds"):
            move.shifted(wrong)  # type: ignore[arg-type]
    for wrong in ("a", True, 0.0, -1.0, np.nan):
        with pytest.raises(ps.InputError, match="factor"):
            move.stretched(wrong)  # type: ignore[arg-type]
    with pytest.raises(ps.InputError, match="before = 'no': expected True or False"):
        move.resting(before="no")  # type: ignore[arg-type]
    assert move.shifted(2.0).breaks.tolist() == [2.0, 3.0]
    assert (move.resting(after=False).rest_before, move.resting(after=False).rest_after) == (True, False)
