"""What all profiles share: points and times checked once, clocks that begin anywhere, rest where none is denied."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic import profiles
from puma_septic.errors import InputError

POINTS = np.array([[0.0, 0.6], [0.3, 0.7], [0.5, 0.2], [0.9, 0.9]])
TIMES = np.array([0.0, 1.0, 2.5, 3.0])
TIMED = [info.name for info in profiles.available() if info.name not in ("double_s", "lspb")]


def made(name: str, times: np.ndarray) -> ps.Trajectory:
    options = {"blend_time": 0.2} if name in ("trapezoidal", "polynomial_blends") else {}
    trajectory: ps.Trajectory = getattr(profiles, name)(POINTS, times, **options)
    return trajectory


@pytest.mark.parametrize("name", TIMED)
@pytest.mark.parametrize("origin", [2.0**20, 2.0**30 + 0.5, -(2.0**30), -3.0])  # the last ends at 0
def test_a_clock_that_begins_anywhere_changes_no_digit(name: str, origin: float) -> None:
    """Stamps since 1970 (about 2^30 s), as every bag of ROS has, once spoilt the jerk and then the verdict.

    Origins and times are multiples of 1/2 s, so that their sums are exact and the motions must be the same to the bit.
    """
    here, there = made(name, TIMES), made(name, TIMES + origin)
    np.testing.assert_array_equal(there.position.offsets, here.position.offsets)
    np.testing.assert_array_equal(there.position.coefficients, here.position.coefficients)
    np.testing.assert_array_equal(there.breaks[[0, -1]], TIMES[[0, -1]] + origin)
    for order in (1, 2, 3):
        np.testing.assert_array_equal(there.extrema(order).peak, here.extrema(order).peak)


@given(st.floats(-9, 9), st.lists(st.floats(0.01, 5), min_size=3, max_size=3))
@settings(max_examples=200)
def test_the_trajectory_has_a_value_at_each_given_time(start: float, lengths: list[float]) -> None:
    """The end is the start plus a duration, rounded: one in twenty ended a rounding before the time that was given."""
    times = start + np.cumsum([0.0, *lengths])
    move = profiles.linear(POINTS, times)
    np.testing.assert_allclose(move(times), POINTS, rtol=0, atol=1e-13)
    assert not move.via_miss.any()
    with pytest.raises(InputError, match="outside the span"):
        move(times[-1] + 1e-9)


def test_times_that_fall_together_beside_the_start_are_named() -> None:
    with pytest.raises(InputError, match=r"times\[1\] = 1e-20 s and times\[2\] = 2e-20 s are too close to each"):
        profiles.linear([[0.0], [1.0], [2.0], [3.0]], [-1.0, 1e-20, 2e-20, 1.0])


@pytest.mark.parametrize(
    ("name", "given_ends", "rest"),
    [
        ("septic", {}, (True, True)),
        ("septic", {"start_velocity": 0.3}, (False, True)),
        ("septic", {"end_acceleration": [0.0, 0.1]}, (True, False)),
        ("single_polynomial", {"end_velocity": 0.3, "start_acceleration": 0.1}, (False, False)),
        ("cubic_spline", {"end_velocity": [0.0, 0.1]}, (True, False)),
        ("cubic_spline", {"start_velocity": 0.0}, (True, True)),
        ("quintic", {"velocities": [[0, 0], [1, 0], [0, 1], [0, 0.5]]}, (True, False)),
        ("quintic_segments", {"accelerations": [[0, 1], [0, 0], [0, 0], [0, 0]]}, (False, True)),
        ("classic_septic", {"velocities": [[1, 0], [1, 0], [0, 1], [0, 0.5]]}, (False, False)),
        ("classic_septic", {"jerks": [[1, 0], [1, 0], [0, 1], [0, 0.5]]}, (True, True)),
        ("trigonometric_spline", {"accelerations": [[1, 0], [1, 0], [0, 1], [0, 0]]}, (False, True)),
    ],
)
def test_rest_is_assumed_where_no_velocity_denies_it(
    name: str, given_ends: dict[str, object], rest: tuple[bool, bool]
) -> None:
    """What starts or ends moving was held against rest, and its torque called unbounded."""
    move = getattr(profiles, name)(POINTS, TIMES, **given_ends)
    assert (move.rest_before, move.rest_after) == rest


def test_double_s_that_starts_moving_is_not_at_rest_before() -> None:
    move = profiles.double_s([[0.0], [2.0]], max_velocity=1, max_acceleration=2, max_jerk=9, start_velocity=0.5)
    assert (move.rest_before, move.rest_after) == (False, True)
    assert len(move.jumps(1).times) == 0


def test_a_motion_that_starts_and_ends_moving_has_finite_torque() -> None:
    """As sampled: 26.7 and 55.5 N m at joints 1 and 2, at the ends; once "unbounded" everywhere."""
    points = [[0, 0.6, -2.2, 0, 0.3, 0], [0.3, 0.7, -2.1, 0, 0.3, 0], [0.6, 0.8, -2.0, 0, 0.3, 0]]
    move = ps.septic([*points, [0.9, 0.9, -1.9, 0, 0.3, 0]], [0, 1, 2, 3], start_velocity=0.3, end_velocity=0.3)
    assessment = ps.assess(ps.load_robot(), move)
    sampled = np.abs(assessment.motion.torque(np.linspace(0, 3, 3001))).max(axis=0)
    # A peak beside a reversal lies up to one sample away.
    np.testing.assert_allclose(assessment.peak_torque, sampled, rtol=1e-4)
    assert assessment.peak_torque[:2] == pytest.approx([26.7, 55.5], abs=0.05)


def test_no_unit_is_claimed_for_a_joint_that_may_slide() -> None:
    """A gantry was told of rad/s."""
    with pytest.raises(InputError) as refusal:
        profiles.trapezoidal([[0, 0], [1, 0.5]], [0, 1], cruise_velocity=0.5, joint_names=["x", "y"])
    assert str(refusal.value).startswith(
        "joint 'x': cruise_velocity = 0.5 must be more than h/T = 1 and at most 2 h/T = 2"
    )
    assert str(refusal.value).endswith("(rad and rad/s; m and m/s if prismatic)")
    with pytest.raises(InputError, match=r"points\[0, 0\] = nan is not a finite number"):
        profiles.linear([[np.nan]] * 2, [0, 1])
