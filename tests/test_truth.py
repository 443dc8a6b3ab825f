"""The whole chain against independent computation: peaks, means and work of random moves of every family; no jumps.

A few moves of each family run by default, 20 of each with ``python -m pytest -m slow``; 300 of each, and 10,000 changed
inputs, with ``-m study``.
"""

from __future__ import annotations

import numpy as np
import pytest
from helpers.random_moves import FAMILIES, make, random_move, random_points
from helpers.truth import truth
from numpy.polynomial import chebyshev

import puma_septic as ps
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array

# A joint's torque counts from this part of the arm's largest on: below it, rounding of the others shows.
LEAST = 1e-3


def assert_true(robot: ps.Robot, move: ps.Trajectory, name: str) -> None:
    """Peak, root mean square and net work of a move, to 1e-9; finite parts where a velocity steps."""
    expected, motion = truth(robot, move), ps.compute_motion(robot, move)
    result = ps.assess(motion)
    floor = LEAST * expected.peak.max()
    peak, rms = motion.torque.extrema().peak, motion.torque.rms()
    if np.isfinite(result.peak_torque).all():
        peak, rms = result.peak_torque, result.rms_torque
    else:
        assert move.profile.startswith("linear"), name
    for found, right in ((peak, expected.peak), (rms, expected.rms)):
        assert (np.abs(found - right) <= 1e-9 * np.maximum(right, floor)).all(), f"{name}: {found}, true {right}"
    work = result.energy_in - result.energy_out
    if np.isfinite(work).all():
        assert np.abs(work - expected.work).max() <= 1e-9 * (result.energy_in + result.energy_out).max() + 1e-15, name


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_random_moves_have_their_true_torque(puma: ps.Robot, family: str) -> None:
    assert_true(puma, random_move(family, np.random.default_rng([0, FAMILIES.index(family)])), "seed 0")


@pytest.mark.parametrize(
    "count", [pytest.param(20, marks=pytest.mark.slow), pytest.param(300, marks=pytest.mark.study)]
)
@pytest.mark.parametrize("family", FAMILIES)
def test_many_random_moves_have_their_true_torque(puma: ps.Robot, family: str, count: int) -> None:
    for seed in range(count):
        assert_true(puma, random_move(family, np.random.default_rng([seed, FAMILIES.index(family)])), f"seed {seed}")


# ---- an input changed by 1e-12

METRICS = ("peak_velocity", "peak_acceleration", "peak_jerk", "peak_torque", "rms_torque", "energy_in", "energy_out",
           "peak_power", "peak_regenerated_power")  # fmt: skip


# A torque is a series fitted to 1e-11 of its largest value, so two of them may differ by twice that; by how much what
# follows from it may differ, `_scale` says.
ROUNDING = 2e-11
STEP = 1e-12
# One-sided difference quotients are taken over this step: rounding is 1e-3 of a slope of one scale, and no joint that
# rests begins to move.
SLOPE_STEP = 1e-10


def changed(seed: int, puma: ps.Robot, by: float) -> ps.Assessment:
    """A random move whose points, durations or payload are changed by so much in a random direction."""
    family, what = FAMILIES[seed % len(FAMILIES)], seed // len(FAMILIES) % 3
    rng = np.random.default_rng([77, seed])
    count = 4 if family in ("septic", "poly_434", "poly_353") else int(rng.integers(3, 6))
    points = random_points(rng, count)
    durations = 10 ** rng.uniform(-1.2, 1.0) * rng.uniform(0.5, 2.0, count - 1)
    mass = 1.0
    if family == "double_s":
        points += np.linspace(0.0, 0.1, count)[:, None]  # no two points are equal
    if what == 0:
        points = points + by * rng.uniform(-1, 1, points.shape)
    elif what == 1:
        durations = durations * (1 + by * rng.uniform(-1, 1, durations.shape))
    else:
        mass += by
    robot = puma.with_payload(ps.Payload(mass=mass, com=(0, 0, 0.1)))
    return ps.assess(robot, make(family, points, durations, rng))


def jumps(seed: int, puma: ps.Robot) -> list[str]:
    """What moves by more than its slope: a bound of 1e-8 of a value was broken by the shortest and tiniest moves.

    Where more than rounding changes, the change over a hundred times the step, to both sides, is a hundred times as
    large. Where work changes its sign the slopes differ, by up to half as much again. Where a joint that stood begins
    to turn, it turns for a time that goes with the square root of the change: ten times as large. A jump would be as
    large over any step.
    """
    one, other = changed(seed, puma, 0.0), changed(seed, puma, STEP)
    sides: list[ps.Assessment] = []
    found = []
    for metric in METRICS:
        before, after = getattr(one, metric), getattr(other, metric)
        if (np.isfinite(before) != np.isfinite(after)).any():
            found.append(f"{metric} {before}, then {after}")
            continue
        finite, scale = np.isfinite(before), _scale(one, metric)
        change = np.abs(before[finite] - after[finite])
        rounding = ROUNDING * scale + _of_instants(one, metric)[finite]
        if (change > rounding).any():
            sides = sides or [changed(seed, puma, by) for by in (-SLOPE_STEP, SLOPE_STEP)]
            over = np.max([np.abs(getattr(side, metric)[finite] - before[finite]) for side in sides], axis=0)
            smooth = change <= 1.5 * over * STEP / SLOPE_STEP + rounding
            root = change <= 1.5 * over * np.sqrt(STEP / SLOPE_STEP)
            if not (smooth | root).all():
                found.append(f"{metric} {before} moves by {change}, over a hundred times the step by {over}")
    if [str(check)[:14] for check in one.violations] != [str(check)[:14] for check in other.violations]:
        found.append("the violations differ")
    return [f"seed {seed}, {one.motion.trajectory.profile}: {text}" for text in found]


def _scale(one: ps.Assessment, metric: str) -> float:
    """What `ROUNDING` is a part of, of the whole arm.

    Where torques differ by d at most, their root mean squares do so too, and powers by d times the velocity. The
    positive part of a power differs by no more than the power: its integral by d times the travel, which by the
    Cauchy-Schwarz inequality is at most the root mean square of the velocity times the duration.
    """
    torque = one.motion.torque.extrema().peak
    speed, mean = one.peak_velocity, one.motion.trajectory.duration * one.rms_velocity
    of_torque = {"rms_torque": torque, "peak_power": torque * speed, "peak_regenerated_power": torque * speed,
                 "energy_in": torque * mean, "energy_out": torque * mean}  # fmt: skip
    values = of_torque.get(metric, getattr(one, metric))
    return max(1.0, float(values[np.isfinite(values)].max(initial=0.0)))


def _of_instants(one: ps.Assessment, metric: str) -> Array:
    """What rounding of instants leaves of a jerk: a phase is as long as its ends are known, and the jerk goes with it.

    Accelerations rise within microseconds under the highest limits of jerk.
    """
    if metric != "peak_jerk":
        return np.zeros(6)
    breaks = one.motion.trajectory.breaks
    phase = breaks[1:-1].searchsorted(np.nan_to_num(one.peak_jerk_time), side="right")
    return np.asarray(4 * np.finfo(float).eps * breaks[-1] / np.diff(breaks)[phase] * one.peak_jerk)


@pytest.mark.parametrize("first", [0, 26])
def test_an_input_changed_by_1e_12_changes_nothing_that_is_told(puma: ps.Robot, first: int) -> None:
    assert [text for seed in range(first, first + 26) for text in jumps(seed, puma)] == []


@pytest.mark.parametrize("seed", [479, 6563, 7499, 11555])
def test_a_stop_that_becomes_a_turn_does_so_by_a_square_root(puma: ps.Robot, seed: int) -> None:
    """Where a joint that stood begins to creep, it turns in its blend for 1e-8 s to 1e-6 s: moves where that is seen.

    15,600 moves were how they were found; others may change by a root that is too small to be seen.
    """
    assert jumps(seed, puma) == []


@pytest.mark.parametrize("seed", [13270, 15532])
def test_a_jerk_of_microseconds_is_known_as_well_as_its_instants(puma: ps.Robot, seed: int) -> None:
    """Two of 15,600 moves in which it changes by 5e-11 of itself, whatever the step: 2.3 s are rounded by 4e-16 s."""
    assert jumps(seed, puma) == []


@pytest.mark.study
@pytest.mark.parametrize("first", range(0, 10_400, 1040))
def test_10_000_inputs_changed_by_1e_12_change_nothing_that_is_told(puma: ps.Robot, first: int) -> None:
    assert [text for seed in range(first, first + 1040) for text in jumps(seed, puma)] == []


# ---- crowded zeros and critical points


def crowded(rng: np.random.Generator) -> tuple[Array, Array]:
    """A series with 2 to 5 zeros close together, at the middle, beside ends and cell borders or anywhere, and zeros."""
    width = 10 ** rng.uniform(-3.0, -0.7)
    inside = 1 - width / 2 - 1e-3
    at = rng.choice([0.0, -inside, inside, 0.25, -0.5, np.cos(np.pi / 8), rng.uniform(-0.9, 0.9)])
    close = np.clip(at + width * rng.uniform(-0.5, 0.5, rng.integers(2, 6)), -0.999999, 0.999999)
    zeros = np.concatenate([close, rng.uniform(-1.5, 1.5, rng.integers(0, 4))])
    series = chebyshev.chebfromroots(zeros)
    if extra := int(rng.choice([0, 0, 20, 60, 110])):
        # Times a function that has no zero: sum of |coefficients| below the first.
        factor = rng.normal(size=extra) * 0.95 ** np.arange(extra)
        factor[0] = 1.2 * np.abs(factor).sum() + 1
        series = chebyshev.chebmul(series, factor)
    return series / np.abs(series).sum(), np.sort(zeros[np.abs(zeros) < 1])


@pytest.mark.parametrize("seed", range(300))
def test_no_zero_and_no_extremum_is_missed_however_crowded(seed: int) -> None:
    """Three sign changes within a cell of the former grid were seen as one, and peaks between them missed.

    An excursion between two zeros counts where it is above the rounding of the series, 2e-12 of its coefficients.
    """
    series, zeros = crowded(np.random.default_rng([8, seed]))
    edges = np.concatenate([[-1.0], zeros, [1.0]])
    between = np.linspace(edges[:-1], edges[1:], 41)
    if np.abs(chebyshev.chebval(between, series)).max(axis=0).min() > 2e-12:
        found = Piecewise(breaks=[-1.0, 1.0], coefficients=series[:, None, None]).roots()[0]
        assert len(found) == len(zeros)
    integral = chebyshev.chebint(series)
    extrema = Piecewise(breaks=[-1.0, 1.0], coefficients=integral[:, None, None]).extrema()
    candidates = chebyshev.chebval(edges, integral)
    rounding = 1e-14 * np.abs(integral).sum()
    assert extrema.max[0] == pytest.approx(candidates.max(), abs=rounding, rel=0)
    assert extrema.min[0] == pytest.approx(candidates.min(), abs=rounding, rel=0)


@pytest.mark.parametrize("at", [-1.0, -0.75, -0.3, 0.0, 0.1, 0.5, 1.0])
@pytest.mark.parametrize("degree", [0, 7, 30, 120])
def test_double_zeros_are_no_sign_change_and_triple_ones_are_one(at: float, degree: int) -> None:
    """At the middle, at borders of cells, at the ends and elsewhere; times a positive series of any degree."""
    factor = np.append(3.0, 0.9 ** np.arange(degree) * np.cos(np.arange(degree)) / 10)
    for power, expected in ((2, 0), (3, 1), (4, 0)):
        series = chebyshev.chebmul(chebyshev.chebfromroots([at] * power), factor)
        found = Piecewise(breaks=[-1.0, 1.0], coefficients=series[:, None, None]).roots()[0]
        assert len(found) == (expected if abs(at) < 1 else 0)
        # Rounding blurs a triple zero to its third root.
        np.testing.assert_allclose(found, [at] * len(found), rtol=0, atol=3e-4)


@pytest.mark.parametrize("root", [-0.9999, -0.95, -0.86, -0.3, 0.0, 0.86, 0.95, 0.9999])
def test_a_sign_change_beside_a_zero_at_an_end_is_found_where_it_is(root: float) -> None:
    """A velocity that is zero at rest and reverses soon after: Newton went to the zero at the end."""
    for ends in ([-1.0], [1.0], [-1.0, 1.0], [-1.0, -1.0, 1.0, 1.0]):
        series = chebyshev.chebfromroots([root, *ends])
        found = Piecewise(breaks=[-1.0, 1.0], coefficients=series[:, None, None]).roots()[0]
        # A root moves by rounding of the series over its slope there.
        slope = abs(chebyshev.chebval(root, chebyshev.chebder(series)))
        np.testing.assert_allclose(found, [root], rtol=0, atol=1e-15 * np.abs(series).sum() / slope)


# ---- a start under a high jerk, and what flows back


def test_the_first_microseconds_of_a_move_under_a_high_jerk_are_no_rest(puma: ps.Robot) -> None:
    """Travel of 1e-22 rad in the first phase was taken for rest: no friction there, and a peak that no one feels."""
    points = np.tile([0.0, 0.8, -2.5, 0.0, 0.4, 0.0], (2, 1))
    points[:, 1] = 0.8, 0.4  # down: friction helps
    move = ps.profiles.double_s(points, max_velocity=0.5, max_acceleration=0.2, max_jerk=1e6)
    assert move.position.lengths[0] < 1e-6
    assert (move.direction.coefficients[0, :, 1] == -1).all()
    assert_true(puma, move, "double_s")


def test_a_turn_at_a_via_is_at_the_via() -> None:
    """Beside a stop the velocity is below its rounding, and a root of it 1e-5 s away was taken for the turn."""
    points = np.tile([0.0, 0.8, -2.5, 0.0, 0.4, 0.0], (5, 1)) + np.outer([0, 0.3, 0.1, 0.47, -0.2], np.ones(6))
    times = [0.0, 1.7, 2.9, 4.4, 7.3]
    for name in ("quintic_segments", "classic_septic", "cycloidal", "cubic"):
        move = getattr(ps.profiles, name)(points, times)
        assert move.direction.breaks.tolist() == times, name


def test_a_joint_turns_at_its_own_turning_point(puma: ps.Robot) -> None:
    """Of two joints that turn 15 ns apart one took the time of the other: so near, its position is as large.

    Friction had the wrong sign for that long, and the root mean square of the torque was off by 2e-9.
    """
    move = random_move("bspline", np.random.default_rng([291, FAMILIES.index("bspline")]))
    assert_true(puma, move, "bspline")
    turns = [move.direction.breaks[1:-1][np.diff(move.direction.coefficients[0, :, j]) != 0] for j in (3, 5)]
    gaps = np.abs(turns[0][:, None] - turns[1])
    assert 1e-8 < gaps[gaps < 1e-6].min() < 3e-8


def test_what_flows_back_is_no_rounding(puma: ps.Robot) -> None:
    """1e-16 W of a joint that others shake was told as power that flows back; floors come from the whole arm."""
    points = np.tile([0.0, 0.8, -2.5, 0.0, 0.4, 0.0], (2, 1))
    points[:, 0] = 0.0, 0.5
    still = points.copy()
    still[1, 3:] += [0.0, 1e-12, 1e-12]
    for some in (points, still):
        result = ps.assess(puma, ps.quintic_segments(some, [0.0, 2.0]))
        assert result.peak_power[1:].tolist() == [0.0] * 5
        assert result.peak_regenerated_power[1:].tolist() == [0.0] * 5
        assert result.energy_out[1:].tolist() == [0.0] * 5


# ---- smooth motions given as a function, and limits that are met


@pytest.mark.parametrize(("rate", "duration"), [(5.0, 2.0), (5.0, 10.0), (20.0, 10.0), (5.0, 60.0), (20.0, 60.0)])
def test_a_smooth_motion_that_is_fitted_has_no_steps(puma: ps.Robot, rate: float, duration: float) -> None:
    """Joins of fitted pieces were steps of velocity: rounding of joints that rest made the torque infinite."""
    rest = np.array([0.0, 0.8, -2.5, 0.0, 0.4, 0.0])

    def swing(t: Array) -> Array:
        moving = 0.3 * np.sin(rate * t / 2) ** 2 * np.sin(np.pi * t / duration) ** 4
        return rest + moving[:, None] * np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0])

    ends = np.array([0.0, duration])
    move = ps.Trajectory(position=Piecewise.fit(swing, ends), points=swing(ends), times=ends)
    result = ps.assess(puma, move)
    assert not len(move.jumps(1).times)
    assert np.isfinite(result.peak_torque).all()
    t = np.linspace(0.0, duration, 200_001)
    # Second differences, good to the square of the step and to rounding over it.
    acceleration = np.abs(np.diff(swing(t)[:, 0], 2)).max() / t[1] ** 2
    assert result.peak_acceleration[0] == pytest.approx(acceleration, rel=1e-3)


def test_a_profile_made_at_its_limits_keeps_them(puma: ps.Robot) -> None:
    """57 of 200 moves of `double_s` at the arm's own limits broke them by 2e-10, and were infeasible."""
    rng, reach = np.random.default_rng(0), puma.limits.position
    for count in [2] * 10 + [5] * 10 + [20] * 10:
        v, a, j = rng.uniform(0.5, 3, 6).round(2), rng.uniform(1, 20, 6).round(1), rng.uniform(10, 300, 6).round()
        limited = puma.with_limits(position=np.full((6, 2), np.nan), effort=np.nan, velocity=v, acceleration=a, jerk=j)
        points = rng.uniform(reach[:, 0], reach[:, 1], (count, 6)).round(2)
        move = ps.profiles.double_s(points, max_velocity=v, max_acceleration=a, max_jerk=j)
        assert not ps.assess(limited, move).violations
