"""What every profile promises, for any points and times: ends, vias, continuity, scaling, and joints that
stay still."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from puma_septic import profiles as p
from puma_septic.trajectory import Trajectory

Array = NDArray[np.float64]
Make = Callable[[Array, Array], Trajectory]


@dataclass(frozen=True)
class Case:
    """One profile with everything but points and times chosen."""

    name: str
    make: Make
    continuity: int
    at_vias: str
    exactly_four: bool = False


def shortest(times: Array) -> float:
    return float(np.diff(times).min())


def lspb(points: Array, times: Array) -> Trajectory:
    return p.lspb(points, durations=np.diff(times), blend_time=0.5 * shortest(times))


def trapezoidal(points: Array, times: Array) -> Trajectory:
    return p.trapezoidal(points, times, blend_time=0.5 * shortest(times))


def blends(degree: int) -> Make:
    return lambda points, times: p.polynomial_blends(points, times, blend_time=0.5 * shortest(times), degree=degree)


def ordinary(name: str) -> Make:
    return lambda points, times: getattr(p, name)(points, times)


CASES = [
    Case("linear", ordinary("linear"), 0, "passes"),
    Case("bang_bang", ordinary("bang_bang"), 1, "stops"),
    Case("trapezoidal", trapezoidal, 1, "misses"),
    Case("cubic", ordinary("cubic"), 1, "stops"),
    Case("harmonic", ordinary("harmonic"), 1, "stops"),
    Case("cubic_spline", ordinary("cubic_spline"), 1, "passes"),
    Case("cubic_spline_free_knots", ordinary("cubic_spline_free_knots"), 2, "passes"),
    Case("cycloidal", ordinary("cycloidal"), 2, "stops"),
    Case("modified_trapezoidal", ordinary("modified_trapezoidal"), 2, "stops"),
    Case("modified_sine", ordinary("modified_sine"), 2, "stops"),
    Case("lspb", lspb, 2, "misses"),
    Case("polynomial_blends", blends(5), 2, "misses"),
    Case("polynomial_blends degree 7", blends(7), 3, "misses"),
    Case("poly_434", ordinary("poly_434"), 2, "passes", exactly_four=True),
    Case("poly_353", ordinary("poly_353"), 2, "passes", exactly_four=True),
    Case("quintic", ordinary("quintic"), 2, "stops"),
    Case("quintic_segments", ordinary("quintic_segments"), 2, "stops"),
    Case("quintic_spline", ordinary("quintic_spline"), 2, "passes"),
    Case("septic", ordinary("septic"), 2, "passes", exactly_four=True),
    Case("single_polynomial", ordinary("single_polynomial"), 2, "passes"),
    Case("bezier", ordinary("bezier"), 2, "misses"),
    Case("classic_septic", ordinary("classic_septic"), 3, "stops"),
    Case("trigonometric_spline", ordinary("trigonometric_spline"), 3, "stops"),
    Case("septic_spline", ordinary("septic_spline"), 3, "passes"),
    Case("bspline", ordinary("bspline"), 3, "passes"),
    Case("bspline degree 3", lambda q, t: p.bspline(q, t, degree=3), 2, "passes"),
    Case("bspline_control", ordinary("bspline_control"), 3, "misses"),
    Case("bspline_control degree 3", lambda q, t: p.bspline_control(q, t, degree=3), 2, "misses"),
]
STILL = 1  # the joint that does not move
# What a via is missed by, in units of blend time times change of velocity (parabola, quartic, sextic blend).
MISS = {"trapezoidal": 1 / 8, "polynomial_blends": 3 / 32, "polynomial_blends degree 7": 5 / 64, "lspb": 3 / 32}


@st.composite
def tasks(draw: st.DrawFn, exactly_four: bool = False) -> tuple[Array, Array]:
    """Four to six points of three joints at uneven times; the second joint stays still."""
    k = 4 if exactly_four else draw(st.integers(4, 6))
    numbers = st.floats(-3, 3).map(lambda x: round(x, 6))
    points = np.array(draw(st.lists(st.tuples(numbers, st.just(draw(numbers)), numbers), min_size=k, max_size=k)))
    steps = draw(st.lists(st.floats(0.3, 2.0), min_size=k - 1, max_size=k - 1))
    return points, draw(st.floats(-5, 5)) + np.concatenate([[0.0], np.cumsum(steps)])


def scale(points: Array) -> float:
    """Rounding is relative to the largest position; a spline swings a few times farther than its points."""
    return 1.0 + float(np.abs(points).max())


def each(function: Callable[[Case, st.DataObject], None]) -> object:
    # Twelve examples a profile find a wrong coefficient at once, and keep the file to a few seconds.
    limited = settings(max_examples=12)(given(data=st.data())(function))
    return pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)(limited)


@each
def test_it_starts_and_ends_at_rest_at_the_points(case: Case, data: st.DataObject) -> None:
    points, times = data.draw(tasks(case.exactly_four))
    move = case.make(points, times)
    ends = move.breaks[[0, -1]]
    assert np.abs(move(ends) - points[[0, -1]]).max() < 1e-12 * scale(points)
    for order in range(1, case.continuity + 1):
        # Rounding of a polynomial of degree up to 9 on segments down to 0.15 s, per derivative.
        assert np.abs(move(ends, order)).max() < 1e-13 * 30.0**order * scale(points)


@each
def test_it_is_as_continuous_as_it_says_and_not_more(case: Case, data: st.DataObject) -> None:
    points, times = data.draw(tasks(case.exactly_four))
    move = case.make(points, times)
    for order in range(1, case.continuity + 1):
        assert len(move.jumps(order).times) == 0
    if case.continuity < 3 and (np.abs(np.diff(points[:, 0])) > 0.1).all():
        assert len(move.jumps(case.continuity + 1).times) > 0


@each
def test_vias(case: Case, data: st.DataObject) -> None:
    points, times = data.draw(tasks(case.exactly_four))
    move = case.make(points, times)
    at = times - times[0] + move.breaks[0]
    misses = move(np.minimum(at, move.breaks[-1])) - points
    if case.at_vias == "misses":
        assert (move.overshoot <= 1e-12 * scale(points)).all()
    else:
        assert np.abs(misses).max() < 1e-11 * scale(points)
    if case.at_vias == "stops":
        assert np.abs(move(times, order=1)).max() < 1e-10 * scale(points)
        assert (move.overshoot <= 1e-12 * scale(points)).all()
    if case.name in MISS:
        b = 0.5 * shortest(times)
        inside = np.diff(times)[:, None].copy()
        if case.name != "lspb":
            # The first and the last blend lie inside their segments and take half their length from the line.
            inside[[0, -1]] -= b / 2
        dv = np.diff(np.diff(points, axis=0) / inside, axis=0)
        assert np.abs(misses[1:-1] - MISS[case.name] * b * dv).max() < 1e-12 * scale(points)


@each
def test_a_joint_whose_points_are_equal_is_still(case: Case, data: st.DataObject) -> None:
    points, times = data.draw(tasks(case.exactly_four))
    move = case.make(points, times)
    assert not move.position.coefficients[1:, :, STILL].any()
    assert (move.position.coefficients[0, :, STILL] == points[0, STILL]).all()
    # So is an arm of which none moves.
    stays = case.make(np.repeat(points[:1], len(points), axis=0), times)
    assert not stays.position.coefficients[1:].any()
    assert stays.duration == pytest.approx(move.duration, rel=1e-14)


@each
def test_positions_scaled_and_shifted_give_the_motion_scaled_and_shifted(case: Case, data: st.DataObject) -> None:
    points, times = data.draw(tasks(case.exactly_four))
    factor, shift = data.draw(st.floats(0.2, 5)) * data.draw(st.sampled_from([-1, 1])), data.draw(st.floats(-3, 3))
    move, other = case.make(points, times), case.make(factor * points + shift, times)
    t = np.linspace(move.breaks[0], move.breaks[-1], 50)
    # Overshoot of up to some hundred times the points' distance, for the splines.
    size = 1e-11 * (1 + np.abs(other(t)).max() + abs(shift) + scale(factor * points))
    assert np.abs(other(t) - (factor * move(t) + shift)).max() < size


@each
def test_time_stretched_by_k_divides_derivatives_by_its_powers(case: Case, data: st.DataObject) -> None:
    points, times = data.draw(tasks(case.exactly_four))
    k = data.draw(st.floats(0.3, 3))
    move, slower = case.make(points, times), case.make(points, k * times)
    # Between the breaks, which rounding may put on either side.
    x = np.concatenate([np.linspace(a, b, 7)[1:-1] for a, b in zip(move.breaks, move.breaks[1:], strict=False)])
    stretched = slower.breaks[0] + k * (x - move.breaks[0])
    for order in range(4):
        v = move(x, order)
        assert np.abs(slower(stretched, order) * k**order - v).max() < 1e-12 * 30**order * (
            scale(points) + np.abs(move(x)).max()
        )


def test_every_profile_has_its_case_and_its_entry_in_the_catalogue() -> None:
    covered = {case.name.split(" ")[0]: case for case in reversed(CASES)}
    information = {info.name: info for info in p.available()}
    # double_s has limits instead of times, and laws of its own.
    assert information.keys() == covered.keys() | {"double_s"}
    for name, case in covered.items():
        assert int(information[name].continuity[1:]) >= case.continuity
        assert case.continuity in (3, int(information[name].continuity[1:]))
        assert information[name].at_vias == case.at_vias
