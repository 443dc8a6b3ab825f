"""Tasks from the literature: their data, and what comes out of them.

Times and durations here are our own results, kept so that a change shows; they are no published ones.
"""

from __future__ import annotations

import numpy as np
import pytest

import puma_septic as ps
from puma_septic import profiles
from puma_septic.optimisation import LeastTime

# Lin, Chang, Luh 1983, degrees: one row for each joint; limits in deg/s, deg/s^2, deg/s^3.
LIN_CHANG_LUH = [
    [10, 60, 75, 130, 110, 100, -10, -50],
    [15, 25, 30, -45, -55, -70, -10, 10],
    [45, 180, 200, 120, 15, -10, 100, 50],
    [5, 20, 60, 110, 20, 60, -100, -30],
    [10, 30, -40, -60, 10, 50, -40, 10],
    [6, 40, 80, 70, -10, 10, 30, 20],
]
LIN_LIMITS = ([100, 95, 100, 150, 130, 110], [45, 40, 75, 70, 90, 80], [60, 60, 55, 70, 75, 70])
# Gasparetto, Zanotto 2008, likewise.
GASPARETTO = [
    [-10, 60, 20, 55],
    [20, 50, 120, 35],
    [15, 100, -10, 30],
    [150, 100, 40, 10],
    [30, 110, 90, 70],
    [120, 60, 100, 25],
]
GASPARETTO_LIMITS = ([100, 95, 100, 150, 130, 110], [60, 60, 75, 70, 90, 80], [60, 66, 85, 70, 75, 70])


@pytest.mark.parametrize(
    ("name", "points", "limits"),
    [("lin-chang-luh", LIN_CHANG_LUH, LIN_LIMITS), ("gasparetto-zanotto", GASPARETTO, GASPARETTO_LIMITS)],
)
def test_task_files_hold_the_published_numbers(
    name: str, points: list[list[int]], limits: tuple[list[int], ...]
) -> None:
    resolved = ps.resolve_task(ps.load_task(name))
    np.testing.assert_allclose(np.rad2deg(resolved.points), np.transpose(points), rtol=1e-14, atol=1e-14)
    of_robot = resolved.robot.limits
    for have, want in zip((of_robot.velocity, of_robot.acceleration, of_robot.jerk), limits, strict=True):
        np.testing.assert_allclose(np.rad2deg(have), want, rtol=1e-14)
    assert all(assessment.is_feasible for assessment in ps.assess_task(resolved))


def fastest(name: str, profile: str, free: tuple[str, ...] = (), restarts: int = 0) -> LeastTime:
    resolved = ps.resolve_task(ps.load_task(name))
    limits = resolved.robot.limits
    return ps.least_time(
        getattr(profiles, profile),
        resolved.points,
        resolved.times,
        max_velocity=limits.velocity,
        max_acceleration=limits.acceleration,
        max_jerk=limits.jerk,
        free=free,
        restarts=restarts,
    )


# Our own results, s; a local optimum may be left for a better one, but not by much: all searches from random times end
# within 1e-6 of them.
@pytest.mark.parametrize(
    ("name", "profile", "free", "duration"),
    [
        ("lin-chang-luh", "cubic_spline_free_knots", ("free_knots",), 17.8360),
        ("lin-chang-luh", "quintic_spline", (), 18.7157),
        ("gasparetto-zanotto", "cubic_spline_free_knots", ("free_knots",), 8.5310),
        ("gasparetto-zanotto", "quintic_spline", (), 9.7106),
    ],
)
@pytest.mark.slow
def test_least_times_are_feasible_by_exact_extrema(
    name: str, profile: str, free: tuple[str, ...], duration: float
) -> None:
    result = fastest(name, profile, free)
    limits = ps.resolve_task(ps.load_task(name)).robot.limits
    for order, limit in ((1, limits.velocity), (2, limits.acceleration), (3, limits.jerk)):
        assert (result.trajectory.peak(order)[0] <= limit * (1 + 1e-12)).all()
    assert result.is_feasible
    assert result.duration == pytest.approx(duration, abs=5e-5)
    assert result.trajectory.via_miss.max() == 0
    if profile == "cubic_spline_free_knots" and name == "lin-chang-luh":
        assert result.duration < 18.0


def test_least_time_is_feasible_by_samples_of_the_power_coefficients_too() -> None:
    """The same verdict from plain powers of time, without any code of ours that searches for extrema."""
    result = fastest("lin-chang-luh", "cubic_spline_free_knots", ("free_knots",))
    powers, breaks = result.trajectory.power_coefficients(), result.trajectory.breaks
    lengths = np.diff(breaks)[:, None]
    # A cubic: the jerk is constant, the acceleration linear, the velocity's extremes are where the acceleration is 0.
    jerk = 6 * powers[:, 3]
    start, end = 2 * powers[:, 2], 2 * powers[:, 2] + jerk * lengths
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = np.clip(np.nan_to_num(-start / jerk), 0.0, lengths)
    at = [np.zeros_like(zero), zero, np.broadcast_to(lengths, zero.shape)]
    velocity = np.max([np.abs(powers[:, 1] + start * t + jerk * t**2 / 2) for t in at], axis=0)
    limits = np.deg2rad(np.array(LIN_LIMITS, dtype=float))
    for peak, limit in zip((velocity, np.maximum(np.abs(start), np.abs(end)), np.abs(jerk)), limits, strict=True):
        # Powers lose a few digits against the series.
        assert (peak <= limit * (1 + 1e-10)).all()


@pytest.mark.slow
def test_free_knots_and_free_proportions_both_save_time() -> None:
    free = fastest("lin-chang-luh", "cubic_spline_free_knots", ("free_knots",))
    middle = fastest("lin-chang-luh", "cubic_spline_free_knots")
    assert free.duration < middle.duration < middle.start.duration


def test_williams_two_cubics() -> None:
    """Williams 2013, degrees: 30 + 170 t^2 - 68.89 t^3, then 180 + 45 s - 140 s^2 + 55.56 s^3."""
    resolved = ps.resolve_task(ps.load_task("williams"))
    spline = resolved.trajectories[0]
    powers = np.rad2deg(spline.power_coefficients()[:, :, 5])
    np.testing.assert_allclose(powers, [[30, 0, 170, -68.89], [180, 45, -140, 55.56]], rtol=0, atol=5e-3)
    # Velocity and acceleration meet at the via.
    np.testing.assert_allclose(spline.jumps(2).times, [0.0, 3.0])
