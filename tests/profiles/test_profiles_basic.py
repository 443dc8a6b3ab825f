"""The three profiles of the paper's comparison: septic, lspb (Corke's mstraj), three quintics."""

from __future__ import annotations

import json
import tomllib

import numpy as np
import pytest
from helpers.places import REFERENCE
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import puma_septic as ps

Array = NDArray[np.float64]
PAPER = tomllib.loads((REFERENCE / "paper.toml").read_text())
MSTRAJ = json.loads((REFERENCE / "mstraj_rtb.json").read_text())
POINTS, TIMES = np.array(PAPER["table_1"]["angles"]), np.array(PAPER["task"]["times"])
WORKED_OUT = PAPER["worked_out"]["septic"]
seeds = st.integers(0, 10**6)


@pytest.fixture(scope="module")
def paper_septic() -> ps.Trajectory:
    return ps.septic(POINTS, TIMES)


# --- septic ---------------------------------------------------------------------------------------------


def test_all_48_digits_of_table_2(paper_septic: ps.Trajectory) -> None:
    """Printed to four decimals: half a unit of the last is rounding."""
    coefficients = paper_septic.power_coefficients()
    assert coefficients.shape == (1, 8, 6)
    np.testing.assert_allclose(coefficients[0], PAPER["table_2"]["coefficients"], rtol=0, atol=5e-5)


def test_table_2_needs_the_paper_s_times() -> None:
    """No other assignment of times gives the table; equal segments do not."""
    other = ps.septic(POINTS, [0.0, 3.0, 6.0, 9.0]).power_coefficients()[0]
    assert np.abs(other - PAPER["table_2"]["coefficients"]).max() > 0.01


@pytest.mark.parametrize("joint", [1, 5])
def test_coefficients_in_full(paper_septic: ps.Trajectory, joint: int) -> None:
    expected = WORKED_OUT[f"joint_{joint}_coefficients"]
    # Nine decimals are given, five digits of the last coefficient.
    np.testing.assert_allclose(paper_septic.power_coefficients()[0, :, joint - 1], expected, rtol=0, atol=6e-10)


def test_joints_1_and_5_of_the_paper_s_septic(paper_septic: ps.Trajectory) -> None:
    """profiles.md's digits: four decimals of a peak, three of a jerk at an end."""
    peaks = [paper_septic.extrema(order).peak for order in (1, 2, 3)]
    names = ("max_velocity", "max_acceleration", "max_jerk")
    np.testing.assert_allclose([p[0] for p in peaks], [WORKED_OUT[n] for n in names], rtol=0, atol=5e-5)
    np.testing.assert_allclose([p[4] for p in peaks], [WORKED_OUT[f"joint_5_{n}"] for n in names], rtol=0, atol=5e-5)
    jerk = paper_septic.derivative(3)
    assert jerk.inner(jerk)[0] == pytest.approx(WORKED_OUT["jerk_squared_integral"], abs=5e-5)
    acceleration = paper_septic.derivative(2)
    assert np.sqrt(acceleration.inner(acceleration)[0] / 9) == pytest.approx(0.3450, abs=5e-5)
    at_ends = jerk([0.0, 9.0])
    np.testing.assert_allclose(np.abs(at_ends[:, 0]), WORKED_OUT["jerk_at_ends"], rtol=0, atol=5e-4)
    np.testing.assert_allclose(at_ends[:, 4], WORKED_OUT["joint_5_jerk_at_ends"], rtol=0, atol=5e-4)
    np.testing.assert_allclose(paper_septic.jumps(3).times, [0.0, 9.0])
    np.testing.assert_allclose(paper_septic.jumps(3).sizes, at_ends * [[1.0], [-1.0]], rtol=0, atol=1e-12)


def test_overshoot_of_the_paper_s_septic(paper_septic: ps.Trajectory) -> None:
    """Claim 6 of the paper has it the wrong way round: it is the septic that overshoots."""
    reach = paper_septic.extrema(0)
    assert reach.max[0] == pytest.approx(WORKED_OUT["largest"]["value"], abs=5e-5)
    assert reach.t_max[0] == pytest.approx(WORKED_OUT["largest"]["time"], abs=5e-3)
    assert reach.min[0] == pytest.approx(WORKED_OUT["least"]["value"], abs=5e-5)
    assert reach.t_min[0] == pytest.approx(WORKED_OUT["least"]["time"], abs=5e-3)
    assert paper_septic.overshoot[0] == pytest.approx(WORKED_OUT["overshoot"], abs=5e-5)
    assert paper_septic.overshoot[4] == pytest.approx(WORKED_OUT["joint_5_overshoot"], abs=5e-4)


def test_the_printed_coefficients_end_a_hundred_turns_away(paper_septic: ps.Trajectory) -> None:
    """t^7 rounded to four decimals, times 9^7: the table cannot be used as printed."""
    printed = np.polynomial.polynomial.polyval(9.0, np.array(PAPER["table_2"]["coefficients"]))
    assert printed[0] == pytest.approx(257.9, abs=0.05)
    assert paper_septic(9.0)[0] == pytest.approx(-0.5716, abs=1e-13)


@given(seed=seeds)
@hypothesis_settings(max_examples=40)
def test_septic_meets_all_eight_conditions(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-3, 3, (4, 3))
    times = rng.uniform(-9, 9) + np.array([0.0, *np.cumsum(rng.uniform(0.3, 4, 3))])
    v0, v1, a0, a1 = rng.uniform(-2, 2, (4, 3))
    move = ps.septic(points, times, start_velocity=v0, end_velocity=v1, start_acceleration=a0, end_acceleration=a1)
    reach = np.abs(move.position.coefficients).sum(axis=0).max()
    np.testing.assert_allclose(move(times), points, rtol=0, atol=1e-11 * reach)
    # Second derivatives at the ends: 49^2 / 3 roundings over the half time squared.
    np.testing.assert_allclose(move(times[[0, 3]], 1), [v0, v1], rtol=0, atol=1e-10 * reach)
    np.testing.assert_allclose(move(times[[0, 3]], 2), [a0, a1], rtol=0, atol=1e-9 * reach)
    assert move.position.degree == 7
    assert len(move.breaks) == 2


@given(seed=seeds)
@hypothesis_settings(max_examples=20)
def test_septic_is_the_8_by_8_system_of_equation_14(seed: int) -> None:
    """Two ways: powers of t, one joint at a time, as the paper writes it down."""
    rng = np.random.default_rng(seed)
    points, times = rng.uniform(-3, 3, (4, 2)), np.array([0.0, *np.cumsum(rng.uniform(0.5, 2, 3))])
    k = np.arange(8.0)
    rows = [t**k for t in times]
    for t in times[[0, 3]]:
        rows.append(np.where(k >= 1, k * t ** np.maximum(k - 1, 0), 0.0))
        rows.append(np.where(k >= 2, k * (k - 1) * t ** np.maximum(k - 2, 0), 0.0))
    move = ps.septic(points, times)
    t = np.linspace(0.0, times[-1], 20)
    for j in range(2):
        solved = np.linalg.solve(np.array(rows), np.concatenate([points[:, j], np.zeros(4)]))
        expected = np.polynomial.polynomial.polyval(t, solved)
        # The condition number of this form is up to 1e7.
        np.testing.assert_allclose(move(t)[:, j], expected, rtol=0, atol=1e-7 * (1 + np.abs(expected).max()))


def test_a_boundary_value_may_be_one_number_for_all_joints() -> None:
    move = ps.septic(POINTS, TIMES, start_velocity=0.1, end_acceleration=[0.0, 0.1, 0.2, 0.3, 0.4, 0.5])
    np.testing.assert_allclose(move(0.0, 1), 0.1, rtol=0, atol=1e-13)
    np.testing.assert_allclose(move(9.0, 2), [0.0, 0.1, 0.2, 0.3, 0.4, 0.5], rtol=0, atol=1e-13)


def test_septic_with_a_via_close_to_an_end() -> None:
    """Ill conditioned, and solved all the same: at worst the digits of the via's distance are lost."""
    points = np.array([[0.0], [1e-9], [0.5], [1.0]])
    move = ps.septic(points, [0.0, 1e-3, 0.5, 1.0])
    np.testing.assert_allclose(move(move.times), points, rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("points", "times", "message"),
    [
        (POINTS[:3], TIMES[:3], "septic needs exactly 4 points, got 3"),
        (np.vstack([POINTS, POINTS[:1]]), [0, 1, 2, 3, 4], "septic needs exactly 4 points, got 5"),
        (POINTS, TIMES[:3], "times: 3 times for 4 points; one for each is needed"),
        (POINTS, [0, 2, 2, 9], r"times: must increase strictly, but times\[1\] = 2 s is followed by 2 s"),
        (POINTS, [0, 6, 2, 9], r"times\[1\] = 6 s is followed by 2 s"),
        (POINTS, [0, 2, np.nan, 9], r"times\[2\] = nan s is not a finite number"),
        (
            POINTS,
            [0, 1e-200, 1, 2],
            r"times\[0\] = 0 s and times\[1\] = 1e-200 s are too close to each other",
        ),
        (POINTS, "0 2 6 9", r"times: expected numbers of shape \(n,\), got '0 2 6 9'"),
        (np.where(POINTS == 2.57, np.nan, POINTS), TIMES, r"points\[0, 0\] = nan is not a finite number"),
        (np.where(POINTS == 2.57, np.inf, POINTS), TIMES, r"points\[0, 0\] = inf is not a finite number"),
        (POINTS[0], TIMES, r"points: shape \(6,\) is not \(n, m\)"),
        (POINTS[None], TIMES, r"points: shape \(1, 4, 6\) is not \(n, m\)"),
        (np.zeros((4, 0)), TIMES, "at least one joint"),
        ([[0.0], [1.0, 2.0], [0.0], [0.0]], TIMES, r"points: expected numbers of shape \(n, m\)"),
        ([["0"], ["1"], ["2"], ["3"]], TIMES, "points: expected numbers"),
    ],
)
def test_septic_refuses(points: object, times: object, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.septic(points, times)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("start_velocity", [0.0, 1.0], r"start_velocity: shape \(2,\) is not \(6,\)"),
        ("end_velocity", np.nan, r"end_velocity = nan is not a finite number"),
        ("start_acceleration", [0, 0, 0, np.inf, 0, 0], r"start_acceleration\[3\] = inf is not a finite"),
        ("end_acceleration", "0", r"end_acceleration: expected numbers .* got '0'"),
        ("joint_names", ("a", "b"), "joint_names: 2 names for 6 joints"),
        ("joint_names", "abcdef", "joint_names: expected one name per joint, got the single string 'abcdef'"),
    ],
)
def test_septic_refuses_bad_options(name: str, value: object, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.septic(POINTS, TIMES, **{name: value})  # type: ignore[arg-type]


# --- lspb ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("run", sorted(MSTRAJ))
def test_lspb_is_mstraj(run: str) -> None:
    """Row i of RTB's table is the position at t[i] + dt: it stamps its rows one step early.

    Its durations and blends are multiples of dt here, so that its rounding changes nothing.
    """
    reference = MSTRAJ[run]
    move = ps.lspb(reference["viapoints"], durations=reference["tsegment"], blend_time=reference["tacc"])
    t = np.minimum(np.array(reference["t"]) + reference["dt"], move.duration)
    assert move.duration == 9.0
    np.testing.assert_allclose(move(t), reference["q"], rtol=0, atol=1e-12)


def random_lspb(seed: int, *, n: int = 2) -> tuple[Array, Array, float]:
    rng = np.random.default_rng(seed)
    durations = rng.uniform(1.0, 3.0, 3)
    return rng.uniform(-3, 3, (4, n)), durations, float(rng.uniform(0.1, 1.0))


@given(seed=seeds)
@hypothesis_settings(max_examples=30)
def test_closed_forms_of_lspb(seed: int) -> None:
    """Of the definition: an interior blend is a quartic, the first and last are quintics from and to rest."""
    points, durations, tacc = random_lspb(seed, n=1)
    move, tb = ps.lspb(points, durations=durations, blend_time=tacc), tacc / 2
    v = np.diff(points[:, 0]) / durations
    dv, vias = np.diff(v), move.times
    for via, step, point in zip(vias[1:-1], dv, points[1:-1, 0], strict=True):
        miss = move(via)[0] - point
        assert miss == pytest.approx(3 / 32 * tacc * step, abs=1e-12)
        assert move(via, 2)[0] == pytest.approx(1.5 * step / tacc, rel=1e-9)
        assert move(via - tb, 3)[0] == pytest.approx(6 * step / tacc**2, rel=1e-6)
        just_before_the_end = via + tb * (1 - 1e-9)
        assert move(just_before_the_end, 3)[0] == pytest.approx(-6 * step / tacc**2, rel=1e-6)
    # Between the blends the line itself; all joints, all the way.
    for k in range(3):
        line = np.linspace(vias[k] + tb * 1.0001, vias[k + 1] - tb * 1.0001, 5)
        np.testing.assert_allclose(move(line)[:, 0], points[k, 0] + v[k] * (line - vias[k]), rtol=0, atol=1e-12)
        assert np.abs(move(line, 2)).max() < 1e-9
    assert move.via_miss[0] == pytest.approx(3 / 32 * tacc * np.abs(dv).max(), abs=1e-12)
    assert move.overshoot[0] == 0.0


def test_first_and_last_blend_overspeed() -> None:
    """To 1.512 v, with 3.940 v / tb and 36 v / tb^2."""
    move = ps.lspb([[0.0], [1.0]], durations=[1.0], blend_time=0.4)
    assert move.extrema(1).max[0] == pytest.approx(1.512, rel=1e-12)
    # The root of a quadratic: 3.940 to the digits given.
    assert move.extrema(2).peak[0] * 0.2 == pytest.approx(3.940, abs=5e-4)
    assert move.extrema(3).peak[0] * 0.2**2 == pytest.approx(36.0, rel=1e-9)


@given(seed=seeds)
@hypothesis_settings(max_examples=30)
def test_lspb_is_continuous_starts_and_ends_at_rest_and_stays_inside_the_hull(seed: int) -> None:
    points, durations, tacc = random_lspb(seed)
    move = ps.lspb(points, durations=durations, blend_time=tacc)
    ends = move.breaks[[0, -1]]
    np.testing.assert_allclose(move(ends), points[[0, -1]], rtol=0, atol=1e-13)
    for order in (1, 2):
        assert len(move.jumps(order).times) == 0
        np.testing.assert_allclose(move(ends, order), 0.0, rtol=0, atol=1e-10)
    assert (move.overshoot == 0).all()
    assert move.duration == pytest.approx(durations.sum(), rel=1e-15)
    assert len(move.breaks) == 8


def test_without_blends_the_velocity_steps() -> None:
    move = ps.lspb(POINTS, durations=[2, 4, 3], blend_time=0)
    np.testing.assert_allclose(move(TIMES), POINTS, rtol=0, atol=1e-14)
    assert move.jumps(1).times.tolist() == [0.0, 2.0, 6.0, 9.0]
    v = np.diff(POINTS, axis=0) / [[2], [4], [3]]
    expected = np.diff(np.vstack([np.zeros(6), v, np.zeros(6)]), axis=0)
    np.testing.assert_allclose(move.jumps(1).sizes, expected, rtol=0, atol=1e-13)
    assert np.isfinite(move.unbounded(2)[[0, 1, 2, 4, 5]]).all()
    assert np.isnan(move.unbounded(2)[3])


@pytest.mark.parametrize("length", [1.0, 0.3, 1 / 3, 7.1])
def test_blends_that_take_all_of_a_segment_meet_in_its_middle(length: float) -> None:
    points = [[0.0], [1.0], [0.5], [2.0]]
    move = ps.lspb(points, durations=[length] * 3, blend_time=length)
    # First half blend, two whole ones, last half blend; no lines between.
    assert len(move.breaks) == 5
    np.testing.assert_allclose(move(length / 2), [0.5], rtol=0, atol=1e-13)
    assert len(move.jumps(1).times) == 0
    assert len(move.jumps(2).times) == 0


def test_lengths_that_differ_by_rounding_are_equal() -> None:
    """0.1 * 3 is 0.30000000000000004, and no longer than 0.3."""
    move = ps.lspb([[0.0], [1.0], [0.0]], durations=[0.3, 0.3], blend_time=0.1 * 3)
    assert len(move.breaks) == 4
    assert len(move.jumps(2).times) == 0


def mstraj_durations(points: Array, max_velocity: Array, tacc: float) -> list[float]:
    """Corke's rule, segment by segment, without the rounding to dt."""
    result = []
    for k in range(1, len(points)):
        blend = tacc / 2 if k == 1 else tacc
        slowest = max(blend + abs(points[k][j] - points[k - 1][j]) / max_velocity[j] for j in range(len(points[k])))
        result.append(max(2 * tacc, slowest))
    return result


@given(seed=seeds)
@hypothesis_settings(max_examples=20)
def test_durations_from_the_greatest_speed(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, limit, tacc = rng.uniform(-3, 3, (5, 3)), rng.uniform(0.2, 3.0, 3), float(rng.uniform(0.05, 2.0))
    move = ps.lspb(points, max_velocity=limit, blend_time=tacc)
    np.testing.assert_allclose(np.diff(move.times), mstraj_durations(points, limit, tacc), rtol=1e-13)
    # Held on the lines, and exceeded by half in the first and last blend at most.
    assert (move.extrema(1).peak <= 1.5121 * limit).all()
    one = ps.lspb(points, max_velocity=0.5, blend_time=tacc)
    np.testing.assert_allclose(np.diff(one.times), mstraj_durations(points, np.full(3, 0.5), tacc), rtol=1e-13)


def test_equal_points_and_a_speed_limit_take_two_blends() -> None:
    move = ps.lspb([[1.0], [1.0]], max_velocity=1.0, blend_time=0.5)
    assert move.duration == 1.0
    assert move.extrema(1).peak[0] == 0.0


@pytest.mark.parametrize(
    ("points", "options", "message"),
    [
        (POINTS, {"blend_time": 1}, "either durations or max_velocity; neither is given"),
        (POINTS, {"durations": [2, 4, 3], "max_velocity": 1, "blend_time": 1}, "max_velocity; both are given"),
        (
            POINTS,
            {"durations": [2, 4, 3], "blend_time": 2.5},
            r"blend_time = 2\.5 s is longer than segment 1 \(point 0 to 1\), which takes 2 s",
        ),
        (POINTS, {"durations": [2, 0.5, 3], "blend_time": 1}, r"longer than segment 2 \(point 1 to 2\)"),
        (POINTS, {"durations": [2, 4], "blend_time": 1}, r"durations: shape \(2,\) is not \(3,\)"),
        (POINTS, {"durations": [2, 0, 3], "blend_time": 0}, r"durations\[1\] = 0 s must be greater than 0 s"),
        (POINTS, {"durations": [2, -4, 3], "blend_time": 0}, r"durations\[1\] = -4 s must be greater than 0 s"),
        (POINTS, {"durations": [2, np.nan, 3], "blend_time": 1}, r"durations\[1\] = nan s is not a finite number"),
        (POINTS, {"durations": 3, "blend_time": 1}, r"durations: shape \(\) is not \(3,\)"),
        (POINTS, {"durations": [2, 4, 3], "blend_time": -1}, r"blend_time = -1 s must be at least 0 s"),
        (POINTS, {"durations": [2, 4, 3], "blend_time": np.nan}, r"blend_time = nan s is not a finite number"),
        (POINTS, {"durations": [2, 4, 3], "blend_time": "1"}, r"blend_time: expected a number in s, got '1'"),
        (POINTS, {"durations": [2, 4, 3], "blend_time": None}, r"blend_time: expected a number in s, got None"),
        (POINTS, {"max_velocity": 0, "blend_time": 1}, r"max_velocity = 0 must be greater than 0"),
        (POINTS, {"max_velocity": [1, 1, 1, 1, -1, 1], "blend_time": 1}, r"max_velocity\[4\] = -1 must"),
        (POINTS, {"max_velocity": [1, 1], "blend_time": 1}, r"max_velocity: shape \(2,\) is not \(6,\)"),
        (POINTS, {"max_velocity": np.inf, "blend_time": 1}, "max_velocity = inf is not a finite number"),
        ([[1.0], [1.0]], {"max_velocity": 1, "blend_time": 0}, "segment 1: equal points and no blend"),
        (POINTS[:1], {"durations": [], "blend_time": 1}, "lspb needs at least 2 points, got 1"),
        ([[0.0], [np.nan]], {"durations": [1], "blend_time": 0}, r"points\[1, 0\] = nan is"),
        ([0.0, 1.0], {"durations": [1], "blend_time": 0}, r"points: shape \(2,\) is not \(n, m\)"),
    ],
)
def test_lspb_refuses(points: object, options: dict[str, object], message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.lspb(points, **options)  # type: ignore[arg-type]


# --- quintic segments
# -------------------------------------------------------------------------------------------


def test_normalised_quintic() -> None:
    """3-4-5: C_v = 15/8, C_a = 10/sqrt(3), C_j = 60; RMS 1.19523, 4.14039, sqrt(720)."""
    h, T = 1.7, 2.5
    move = ps.quintic_segments([[0.3], [0.3 + h]], [1.0, 1.0 + T])
    peaks = [move.extrema(k).peak[0] * T**k / h for k in (1, 2, 3)]
    np.testing.assert_allclose(peaks, [15 / 8, 10 / np.sqrt(3), 60.0], rtol=1e-12)
    rms = [np.sqrt(f.inner(f)[0] / T) * T**k / h for k in (1, 2, 3) for f in [move.derivative(k)]]
    # Five decimals are printed; 720 is Flash and Hogan's.
    np.testing.assert_allclose(rms, [1.19523, 4.14039, np.sqrt(720)], rtol=0, atol=5e-6)
    power = (move.derivative(1) * move.derivative(2)).extrema().peak[0] * T**3 / h**2
    assert power == pytest.approx(6.69427, abs=5e-6)


def test_three_quintics_of_the_paper_s_task() -> None:
    """Joint 1, to the printed digits; the peak jerk, 2.94525, is half a unit from them."""
    move, expected = ps.quintic_segments(POINTS, TIMES), PAPER["worked_out"]["quintic_segments"]
    for order, name in ((1, "max_velocity"), (2, "max_acceleration"), (3, "max_jerk")):
        assert move.extrema(order).peak[0] == pytest.approx(expected[name], abs=5e-5 * (1 + 1e-9))
    jerk = move.derivative(3)
    assert jerk.inner(jerk)[0] == pytest.approx(6.9396, abs=5e-5)
    assert move.overshoot.tolist() == [0.0] * 6
    np.testing.assert_allclose(move(TIMES, 1), 0.0, rtol=0, atol=1e-14)


@given(seed=seeds)
@hypothesis_settings(max_examples=40)
def test_quintics_meet_given_velocities_and_accelerations(seed: int) -> None:
    rng = np.random.default_rng(seed)
    k = int(rng.integers(2, 7))
    points, v, a = rng.uniform(-3, 3, (3, k, 2))
    times = rng.uniform(-9, 9) + np.cumsum(rng.uniform(0.3, 4, k))
    move = ps.quintic_segments(points, times, velocities=v, accelerations=a)
    reach = np.abs(move.position.coefficients).sum(axis=0).max()
    np.testing.assert_allclose(move(times), points, rtol=0, atol=1e-13 * reach)
    np.testing.assert_allclose(move(times, 1), v, rtol=0, atol=1e-12 * reach)
    np.testing.assert_allclose(move(times, 2), a, rtol=0, atol=1e-10 * reach)
    # What steps is rest at the ends, and the jerk anywhere. Breaks are the start plus times since then, rounded.
    for order in (1, 2):
        steps = move.jumps(order).times
        assert np.abs(steps[:, None] - times[[0, -1]]).min(axis=1).max(initial=0.0) <= np.spacing(20.0)


def test_velocities_alone_leave_accelerations_zero() -> None:
    move = ps.quintic_segments(POINTS, TIMES, velocities=np.ones((4, 6)))
    np.testing.assert_allclose(move(TIMES, 1), 1.0, rtol=0, atol=1e-13)
    np.testing.assert_allclose(move(TIMES, 2), 0.0, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("points", "times", "options", "message"),
    [
        (POINTS[:1], [0.0], {}, "quintic_segments needs at least 2 points, got 1"),
        (POINTS, [0, 1, 2], {}, "times: 3 times for 4 points"),
        (POINTS, [0, 1, 1, 2], {}, r"times\[1\] = 1 s is followed by 1 s"),
        (POINTS, TIMES, {"velocities": np.zeros((3, 6))}, r"velocities: shape \(3, 6\) is not \(4, 6\)"),
        (POINTS, TIMES, {"velocities": 0.0}, r"velocities: shape \(\) is not \(4, 6\)"),
        (POINTS, TIMES, {"accelerations": np.full((4, 6), np.nan)}, r"accelerations\[0, 0\] = nan is"),
        (POINTS, TIMES, {"joint_names": ["a"] * 5}, "joint_names: 5 names for 6 joints"),
    ],
)
def test_quintic_segments_refuse(points: Array, times: object, options: dict[str, object], message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.quintic_segments(points, times, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("make", [ps.septic, ps.quintic_segments])
def test_points_and_times_are_kept(make) -> None:  # type: ignore[no-untyped-def]
    points = POINTS.copy()
    move = make(points, TIMES, joint_names=list("abcdef"))
    points[:] = 0.0
    np.testing.assert_array_equal(move.points, POINTS)
    np.testing.assert_array_equal(move.times, TIMES)
    assert move.joint_names == ("a", "b", "c", "d", "e", "f")
