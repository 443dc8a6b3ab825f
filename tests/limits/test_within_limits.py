"""Profiles from limits alone."""

import numpy as np
import pytest

import puma_septic as ps

POINTS = [[0.0, 0.0], [1.0, 0.2], [0.5, -0.8]]


def test_a_trapezoid_by_hand() -> None:
    """1 rad at 1 rad/s and 2 rad/s^2 takes 1/1 + 1/2 s, at 4 rad/s the speed is not reached: 2 sqrt(1/2) s."""
    assert ps.within_limits("trapezoidal", [[0.0], [1.0]], max_velocity=1, max_acceleration=2).duration == 1.5
    short = ps.within_limits("trapezoidal", [[0.0], [1.0]], max_velocity=4, max_acceleration=2)
    assert short.duration == pytest.approx(2 * np.sqrt(0.5), rel=1e-15)
    assert len(short.breaks) == 3


def test_a_trapezoid_keeps_every_limit_and_reaches_one_on_each_segment() -> None:
    velocity, acceleration = np.array([1.0, 0.7]), np.array([3.0, 2.0])
    move = ps.within_limits("trapezoidal", POINTS, max_velocity=velocity, max_acceleration=acceleration)
    assert move(move.times) == pytest.approx(np.array(POINTS), abs=1e-14)
    assert move(move.times, 1) == pytest.approx(np.zeros((3, 2)), abs=1e-14)
    for order, limit in ((1, velocity), (2, acceleration)):
        assert (move.peak(order)[0] <= limit * (1 + 1e-12)).all()
        assert (move.peak(order)[0] / limit).max() == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("family", ["septic_spline", "quintic_segments", "single_polynomial"])
def test_a_family_with_times_is_scaled_to_its_limits(family: str) -> None:
    limits = {"max_velocity": 2.0, "max_acceleration": [4.0, 3.0], "max_jerk": 30.0}
    move = ps.within_limits(family, POINTS, **limits, proportions=[1.0, 1.2])
    used = [(move.peak(k)[0] / limit).max() for k, limit in enumerate(limits.values(), start=1)]
    assert max(used) == pytest.approx(1, rel=1e-12)
    assert np.diff(move.times)[1] / np.diff(move.times)[0] == pytest.approx(1.2)


@pytest.mark.parametrize("family", ["harmonic", "cubic"])
def test_a_jerk_that_is_unbounded_but_not_limited_is_no_matter(family: str) -> None:
    """Bug: infinite over infinite was a RuntimeWarning. Law: limits times k, k^2 are kept in a k-th of the time."""
    one, other = (
        ps.within_limits(family, POINTS, max_velocity=2.0 * k, max_acceleration=4.0 * k**2) for k in (1.0, 3.0)
    )
    used = [float((one.peak(1)[0] / 2.0).max()), float((one.peak(2)[0] / 4.0).max())]
    assert max(used) == pytest.approx(1, rel=1e-12)
    assert other.duration == pytest.approx(one.duration / 3.0, rel=1e-12)


def test_double_s_is_the_profile_of_that_name() -> None:
    limits = {"max_velocity": 2.0, "max_acceleration": 8.0, "max_jerk": 32.0}
    assert ps.within_limits("double_s", [[0.0], [1.0]], **limits).duration == pytest.approx(1.0)


def test_messages() -> None:
    with pytest.raises(ps.InputError, match="trapezoidal from limits alone needs max_acceleration"):
        ps.within_limits("trapezoidal", POINTS, max_velocity=1.0)
    with pytest.raises(ps.InputError, match="its acceleration steps, so that no duration keeps max_jerk"):
        ps.within_limits("trapezoidal", POINTS, max_velocity=1.0, max_acceleration=1.0, max_jerk=1.0)
    with pytest.raises(ps.InputError, match="cubic: its jerk is unbounded, so that no duration keeps max_jerk"):
        ps.within_limits("cubic", POINTS, max_jerk=1.0)
    with pytest.raises(ps.InputError, match="septic_spline from limits alone needs max_velocity, max_acc"):
        ps.within_limits("septic_spline", POINTS)
    with pytest.raises(ps.InputError, match="max_velocity = -1 rad/s must be greater than 0 rad/s"):
        ps.within_limits("quintic", POINTS, max_velocity=-1.0)
    with pytest.raises(ps.InputError, match="all points are the same"):
        ps.within_limits("quintic", [[0.0], [0.0]], max_velocity=1.0)
    with pytest.raises(ps.InputError, match=r"proportions\[1\] = 0 must be greater than 0; two neighbouring points"):
        ps.within_limits("quintic", [[0.0], [1.0], [1.0]], max_velocity=1.0)
