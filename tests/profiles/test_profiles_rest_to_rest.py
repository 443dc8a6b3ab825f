"""The named laws from rest to rest, the trigonometric spline and the blends, against their formulas."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

from puma_septic import profiles
from puma_septic.errors import InputError

Array = NDArray[np.float64]
S = np.linspace(0.0, 1.0, 101)
PI = np.pi

# Positions by the textbooks' formulas (Biagiotti and Melchiorri, 2.1.2, 2.2; cycloidal, harmonic), s in [0,
# 1].
FORMULAS: dict[str, Callable[[Array], Array]] = {
    "bang_bang": lambda s: np.where(s < 0.5, 2 * s**2, 1 - 2 * (1 - s) ** 2),
    "cycloidal": lambda s: s - np.sin(2 * PI * s) / (2 * PI),
    "harmonic": lambda s: (1 - np.cos(PI * s)) / 2,
    # Norton's polynomial-trigonometric pieces of the modified sine, chapter 3.
    "modified_sine": lambda s: np.select(
        [s < 1 / 8, s < 7 / 8],
        [
            (PI * s - np.sin(4 * PI * s) / 4) / (4 + PI),
            (2 + PI * s - 9 / 4 * np.sin((4 * PI * s + PI) / 3)) / (4 + PI),
        ],
        (4 + PI * s - np.sin(4 * PI * s) / 4) / (4 + PI),
    ),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_law_is_its_formula(name: str) -> None:
    move = getattr(profiles, name)([[0.0], [1.0]], [0.0, 1.0])
    assert np.abs(move(S)[:, 0] - FORMULAS[name](S)).max() < 2e-15


def test_modified_trapezoidal_by_quadrature_of_its_acceleration() -> None:
    move = profiles.modified_trapezoidal([[0.0], [1.0]], [0.0, 1.0])
    peak = 8 * PI / (2 + PI)
    pieces = [
        lambda s: peak * np.sin(4 * PI * s),
        lambda s: peak + 0 * s,
        lambda s: peak * np.cos(4 * PI * (s - 3 / 8)),
        lambda s: -peak + 0 * s,
        lambda s: -peak * np.cos(4 * PI * (s - 7 / 8)),
    ]
    x, w = np.polynomial.legendre.leggauss(20)
    edges, v, q = np.array([0, 1, 3, 5, 7, 8]) / 8, 0.0, 0.0
    for a, left, right in zip(pieces, edges, edges[1:], strict=False):
        s, weight = (left + right) / 2 + (right - left) / 2 * x, (right - left) / 2 * w
        assert np.abs(move(s, order=2)[:, 0] - a(s)).max() < 1e-13
        q += v * (right - left) + float(weight @ (a(s) * (right - s)))
        v += float(weight @ a(s))
        assert abs(move(right)[0] - q) < 1e-14
    assert abs(q - 1) < 1e-14


def trigonometric_row(theta: float, order: int, angle: float) -> list[float]:
    """1, cos and sin of k theta (k = 1 ... 3), sin 4 (theta - angle/2), differentiated."""
    turn = order * PI / 2
    row = [float(order == 0)]
    for k in (1, 2, 3):
        row += [k**order * np.cos(k * theta + turn), k**order * np.sin(k * theta + turn)]
    return [*row, 4**order * np.sin(4 * (theta - angle / 2) + turn)]


@pytest.mark.parametrize("angle", [0.8, 2.0, PI])
def test_trigonometric_spline_solves_schoenbergs_system(angle: float, rng: np.random.Generator) -> None:
    """Second way: the eight conditions in the basis of Simon and Isik, possible where the angle is not
    small."""
    T = 1.3
    values = rng.normal(size=(4, 2, 1))  # q, v, a, j at both ends
    move = profiles.trigonometric_spline(
        values[0], [0.0, T], angle=angle, velocities=values[1], accelerations=values[2], jerks=values[3]
    )
    system = [trigonometric_row(theta, k, angle) for theta in (0.0, angle) for k in range(4)]
    right = [values[k, end, 0] * (T / angle) ** k for end in (0, 1) for k in range(4)]
    coefficients = np.linalg.solve(system, right)
    for t in np.linspace(0, T, 9):
        for k in range(4):
            expected = trigonometric_row(t / T * angle, k, angle) @ coefficients * (angle / T) ** k
            # The condition number of that system at 0.8 rad is 1e8.
            assert abs(move(t, k)[0] - expected) < 1e-7


def test_trigonometric_spline_of_a_tiny_angle_is_the_classic_septic(rng: np.random.Generator) -> None:
    points, t = rng.normal(size=(4, 2)), [0.0, 0.7, 2.0, 2.6]
    given = {"velocities": rng.normal(size=(4, 2)), "jerks": rng.normal(size=(4, 2))}
    one = profiles.trigonometric_spline(points, t, angle=1e-6, **given)
    other = profiles.classic_septic(points, t, **given)
    grid = np.linspace(0, 2.6, 60)
    for order in range(4):
        # The difference is of second order in the angle; the rest is rounding of three derivatives on 0.6 s.
        assert np.abs(one(grid, order) - other(grid, order)).max() < 1e-13 * 20**order


@pytest.mark.parametrize("angle", [0.0, -1.0, 3.2])
def test_trigonometric_spline_refuses_an_angle_out_of_range(angle: float) -> None:
    with pytest.raises(InputError, match=rf"angle = {angle:g} rad is outside \]0, pi\] rad: beyond pi"):
        profiles.trigonometric_spline([[0.0], [1.0]], [0.0, 1.0], angle=angle)


def test_trapezoidal_between_two_points_by_cruise_velocity() -> None:
    # Biagiotti and Melchiorri, section 3.2: Ta = (q0 - q1 + v_c T) / v_c, a = v_c / Ta; each joint its own.
    points, T = np.array([[0.0, 1.0, 2.0], [1.0, -1.0, 2.0]]), 2.0
    move = profiles.trapezoidal(points, [0.0, T], cruise_velocity=[0.6, 1.6, 1.0])
    ta = T - np.array([1.0, 2.0]) / [0.6, 1.6]
    assert move.extrema(1).peak == pytest.approx([0.6, 1.6, 0.0])
    assert move.extrema(2).peak == pytest.approx([0.6 / ta[0], 1.6 / ta[1], 0.0])
    assert not move.position.coefficients[1:, :, 2].any()


@pytest.mark.parametrize(("blends", "message"), [
    (-0.1, r" = -0\.1 s"), (0.0, " = 0 s"), ([0.1, 0.2, -0.2], r"\[2\] = -0\.2 s")])  # fmt: skip
def test_a_blend_takes_time(blends: ArrayLike, message: str) -> None:
    for make in (profiles.trapezoidal, profiles.polynomial_blends):
        with pytest.raises(InputError, match=f"blend_time{message} must be greater than 0 s; without blends"):
            make([[0.0], [1.0], [3.0]], [0.0, 1.0, 2.0], blend_time=blends)


def test_an_arm_that_stays_where_it_is_needs_no_cruise_velocity() -> None:
    """Whatever it is told: nothing moves, nothing overlaps, and it takes its time."""
    move = profiles.trapezoidal([[0.5, -1.0]] * 2, [1.0, 3.0], cruise_velocity=[0.3, 9.0])
    assert (move.breaks[[0, -1]].tolist(), move.extrema(0).min.tolist()) == ([1.0, 3.0], [0.5, -1.0])
    assert not move.position.coefficients[1:].any()


@given(
    v=st.floats(1.001, 2.0),
    T=st.floats(0.5, 5.0),
    h=st.floats(0.1, 3.0),
)
@settings(max_examples=30)
def test_blend_time_and_cruise_velocity_are_two_names_of_one_motion(v: float, T: float, h: float) -> None:
    one = profiles.trapezoidal([[0.0], [h]], [0.0, T], cruise_velocity=v * h / T)
    other = profiles.trapezoidal([[0.0], [h]], [0.0, T], blend_time=T - T / v)
    t = np.linspace(0, T, 40)
    assert np.abs(one(t) - other(t)).max() < 1e-12 * h


def test_blends_of_different_length_at_each_point(rng: np.random.Generator) -> None:
    points, times, b = rng.normal(size=(4, 2)), np.array([0.0, 1.0, 3.0, 3.5]), np.array([0.2, 0.5, 0.3, 0.2])
    for degree, part in ((3, 1 / 8), (5, 3 / 32), (7, 5 / 64), (9, 35 / 512)):
        move = profiles.polynomial_blends(points, times, blend_time=b, degree=degree)
        dv = np.diff(np.diff(points, axis=0) / np.array([[0.9], [2.0], [0.4]]), axis=0)
        assert np.abs(move(times)[1:3] - points[1:3] - part * b[1:3, None] * dv).max() < 1e-13
        # The class is half of the degree less one.
        assert next((k for k in (1, 2, 3) if len(move.jumps(k).times)), 4) == min((degree + 1) / 2, 4)


def test_quintic_blends_between_interior_lines_are_those_of_mstraj(rng: np.random.Generator) -> None:
    """Another implementation: `lspb` blends around the vias with the same quartic; only the ends differ."""
    points = rng.normal(size=(5, 2))
    points[1], points[3] = points[0], points[4]
    times = np.array([0.0, 1.0, 2.5, 4.0, 5.0])
    one = profiles.polynomial_blends(points, times, blend_time=0.6)
    other = profiles.lspb(points, durations=np.diff(times), blend_time=0.6)
    t = np.linspace(0, 5, 101)
    assert np.abs(one(t) - other(t)).max() < 1e-13


def test_blends_refuse() -> None:
    points, times = [[0.0], [1.0], [3.0]], [0.0, 1.0, 2.0]
    with pytest.raises(InputError, match=r"blends at points 0 and 1, of 0.8 s and 0.8 s, overlap by 0.2 s"):
        profiles.trapezoidal(points, times, blend_time=0.8)
    with pytest.raises(InputError, match="either blend_time or cruise_velocity; neither is given"):
        profiles.trapezoidal(points, times)
    with pytest.raises(InputError, match="either blend_time or cruise_velocity; both are given"):
        profiles.trapezoidal(points, times, blend_time=0.1, cruise_velocity=1.0)
    with pytest.raises(InputError, match="cruise_velocity needs exactly 2 points, got 3"):
        profiles.trapezoidal(points, times, cruise_velocity=1.0)
    for speed in (1.0, 2.5):
        with pytest.raises(InputError, match=r"joint 'waist': cruise_velocity = .* more than h/T = 1 and at most 2"):
            profiles.trapezoidal(points[:2], times[:2], cruise_velocity=speed, joint_names=("waist",))
    with pytest.raises(InputError, match=r"blend_time\[1\] = 0 s must be greater than 0 s; without blends"):
        profiles.polynomial_blends(points, times, blend_time=[0.1, 0.0, 0.1])
    with pytest.raises(InputError, match=r"degree = 4 is not one of 3, 5, 7, 9"):
        profiles.polynomial_blends(points, times, blend_time=0.1, degree=4)
