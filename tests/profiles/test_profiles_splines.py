"""Splines and polynomials through the points: known answers, minimality, a second way, messages."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from helpers.dense_splines import dense_rest_spline, exact_rest_spline
from numpy.typing import NDArray
from scipy.interpolate import BPoly, BSpline, CubicSpline, make_interp_spline

from puma_septic import profiles
from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.trajectory import Trajectory

Array = NDArray[np.float64]
TIMES = np.array([0.0, 0.7, 1.9, 2.4, 4.0])


@pytest.fixture
def points(rng: np.random.Generator) -> Array:
    return rng.normal(size=(5, 3))


def cost(move: Trajectory, order: int) -> Array:
    f = move.derivative(order) if order < 4 else move.derivative(3).derivative()
    return f.inner(f)


@pytest.mark.parametrize(("name", "most"), [("single_polynomial", 200), ("bezier", 1000)])
def test_as_many_points_as_are_promised(name: str, most: int) -> None:
    """And none more; times that crowd at both ends, as Chebyshev's, are those that rounding bears."""
    times = 1 - np.cos(np.pi * np.arange(most + 1) / most)
    points = np.sin(3 * times)[:, None]
    with pytest.raises(InputError, match=f"{name} takes at most {most} points, got {most + 1}"):
        getattr(profiles, name)(points, times)
    move = getattr(profiles, name)(points[:-1], 1 - np.cos(np.pi * np.arange(most) / (most - 1)))
    assert len(move.points) == most


def test_two_cubics_of_williams() -> None:
    # Williams 2013: 30 -> 180 -> 120 deg at 0, 1.5, 3 s; coefficients printed to two decimals.
    move = profiles.cubic_spline([[30.0], [180.0], [120.0]], [0.0, 1.5, 3.0])
    powers = move.power_coefficients()[:, :, 0]
    assert np.abs(powers - [[30, 0, 170, -68.89], [180, 45, -140, 55.56]]).max() < 0.005


def test_classic_septic_has_the_coefficients_of_the_closed_form(rng: np.random.Generator) -> None:
    # Biagiotti and Melchiorri, section 2.1.5.
    T = 1.7
    (q0, q1), (v0, v1), (a0, a1), (j0, j1) = rng.normal(size=(4, 2))
    move = profiles.classic_septic(
        [[q0], [q1]], [0, T], velocities=[[v0], [v1]], accelerations=[[a0], [a1]], jerks=[[j0], [j1]]
    )
    h = q1 - q0
    expected = [
        q0,
        v0,
        a0 / 2,
        j0 / 6,
        (210 * h - T * (120 * v0 + 90 * v1) - T**2 * (30 * a0 - 15 * a1) - T**3 * (4 * j0 + j1)) / (6 * T**4),
        (-168 * h + T * (90 * v0 + 78 * v1) + T**2 * (20 * a0 - 14 * a1) + T**3 * (2 * j0 + j1)) / (2 * T**5),
        (420 * h - T * (216 * v0 + 204 * v1) - T**2 * (45 * a0 - 39 * a1) - T**3 * (4 * j0 + 3 * j1)) / (6 * T**6),
        (-120 * h + 60 * T * (v0 + v1) + 12 * T**2 * (a0 - a1) + T**3 * (j0 + j1)) / (6 * T**7),
    ]
    # Coefficients of up to 100, through one change of basis.
    assert np.abs(move.power_coefficients()[0, :, 0] - expected).max() < 1e-11


@pytest.mark.parametrize(("name", "orders"), [("cubic", 1), ("quintic", 2), ("classic_septic", 3)])
def test_given_derivatives_at_the_points_agree_with_scipy(
    name: str, orders: int, points: Array, rng: np.random.Generator
) -> None:
    names = ("velocities", "accelerations", "jerks")[:orders]
    known = {key: rng.normal(size=points.shape) for key in names}
    move = getattr(profiles, name)(points, TIMES, **known)
    twin = BPoly.from_derivatives(TIMES, np.stack([points, *known.values()], axis=1))
    t = np.linspace(0, 4, 333)[:-1]
    for order in range(4):
        assert np.abs(move(t, order) - twin(t, nu=order)).max() < 1e-10
    for order, values in enumerate(known.values(), start=1):
        assert np.abs(move(TIMES, order) - values).max() < 1e-12 * 100**order


def test_cubic_spline_with_given_end_velocities_agrees_with_scipy(points: Array) -> None:
    move = profiles.cubic_spline(points, TIMES, start_velocity=0.5, end_velocity=[1.0, 0.0, -1.0])
    ends = ((1, np.full(3, 0.5)), (1, np.array([1.0, 0.0, -1.0])))
    t = np.linspace(0, 4, 333)
    assert np.abs(move(t) - CubicSpline(TIMES, points, bc_type=ends)(t)).max() < 1e-13


@pytest.mark.parametrize(("name", "degree"), [("quintic_spline", 5), ("septic_spline", 7)])
def test_splines_are_continuous_to_their_class_inside(name: str, degree: int, points: Array) -> None:
    """C4 and C6: derivatives beyond the jerk are not a Trajectory's, so they are measured on the function."""
    f: Piecewise = getattr(profiles, name)(points, TIMES).position
    for order in range(degree):
        # Derivatives grow like the shortest segment's (0.5 s) inverse, and so does rounding.
        assert np.abs(f.jumps().sizes).max() < 1e-13 * 60.0**order, order
        f = f.derivative()
    assert np.abs(f.jumps().sizes).max() > 1.0


@pytest.mark.parametrize(("name", "order"), [("cubic_spline", 2), ("quintic_spline", 3), ("septic_spline", 4)])
def test_splines_minimise_their_integral(name: str, order: int, points: Array) -> None:
    """Any admissible change raises the cost: one that vanishes at all points, with as many derivatives at the
    ends."""
    best: Trajectory = getattr(profiles, name)(points, TIMES)
    t = best.position.breaks
    roots = np.concatenate([np.repeat(t[[0, -1]], order), t[1:-1]])
    bump = Piecewise.fit(lambda x: np.prod(x[:, None] - roots, axis=1)[:, None] * np.ones(3), t)
    for size in (0.01, -0.01):
        changed = Trajectory(position=best.position + bump * size, points=points, times=TIMES)
        assert changed.via_miss.max() < 1e-12
        assert (cost(changed, order) > cost(best, order)).all()


def test_free_knots_give_rest_with_a_staircase_of_jerk(points: Array) -> None:
    move = profiles.cubic_spline_free_knots(points, TIMES, free_knots=[0.2, 3.0])
    assert move.breaks.tolist() == [0.0, 0.2, 0.7, 1.9, 2.4, 3.0, 4.0]
    jerk = move.derivative(3)
    assert jerk.degree == 0 or not jerk.coefficients[1:].any()
    assert np.abs(move([0.0, 4.0], order=2)).max() < 1e-12
    # A second way: SciPy on the same knots, with the positions at the free knots that make rest possible.
    knots = move.breaks
    rest = [(1, np.zeros(3)), (2, np.zeros(3))]
    full = np.concatenate([[0.0] * 4, [0.2, 0.7, 1.9, 2.4, 3.0], [4.0] * 4])
    twin = make_interp_spline(TIMES, points, k=3, t=full, bc_type=(rest, rest))
    grid = np.linspace(0, 4, 200)
    assert np.abs(move(grid) - twin(grid)).max() < 1e-12
    assert len(knots) == 7


def test_poly_353_satisfies_its_conditions_and_differs_from_434(rng: np.random.Generator) -> None:
    points, times = rng.normal(size=(4, 2)), [0.0, 1.0, 1.5, 3.0]
    one, other = profiles.poly_353(points, times), profiles.poly_434(points, times)
    powers = one.power_coefficients()
    # Degrees 3, 5, 3: what is above them is rounding of the change of basis.
    assert np.abs(powers[[0, 2], 4:]).max() < 1e-12
    assert np.abs(powers[1, 5]).min() > 1e-3
    assert np.abs(one(np.linspace(0, 3, 50)) - other(np.linspace(0, 3, 50))).max() > 1e-2


def newton_exactly(points: Array, times: Array, at: Array) -> Array:
    """The polynomial through the points with v = a = 0 at both ends, by divided differences of fractions."""
    z = [Fraction(float(t)) for t in (times[0], times[0], *times, times[-1], times[-1])]
    column = [Fraction(float(q)) for q in (points[0], points[0], *points, points[-1], points[-1])]
    top = [column[0]]
    for k in range(1, len(z)):
        column = [
            Fraction(0) if z[i + k] == z[i] else (column[i + 1] - column[i]) / (z[i + k] - z[i])
            for i in range(len(z) - k)
        ]
        top.append(column[0])
    values = []
    for t in at:
        value = top[-1]
        for k in range(len(z) - 2, -1, -1):
            value = value * (Fraction(float(t)) - z[k]) + top[k]
        values.append(float(value))
    return np.array(values)


@pytest.mark.parametrize("k", [4, 8, 16, 24])
def test_single_polynomial_is_right_to_1e9_of_the_movement(k: int, rng: np.random.Generator) -> None:
    """Against rational arithmetic, which has no rounding."""
    times, points = np.concatenate([[0.0], np.cumsum(rng.uniform(0.8, 1.2, k - 1))]), rng.normal(size=k)
    move = profiles.single_polynomial(points[:, None], times)
    assert move.position.degree == k + 3
    at = np.linspace(0, times[-1], 41)
    assert np.abs(move(at)[:, 0] - newton_exactly(points, times, at)).max() < 1e-9 * np.ptp(points)


def test_single_polynomial_of_four_points_is_the_septic(rng: np.random.Generator) -> None:
    points, times = rng.normal(size=(4, 6)), [0.0, 2.0, 6.0, 9.0]
    ends = {"start_velocity": 0.1, "end_velocity": -0.2, "start_acceleration": 0.3, "end_acceleration": -0.4}
    one, other = profiles.single_polynomial(points, times, **ends), profiles.septic(points, times, **ends)
    assert np.abs(one.position.coefficients - other.position.coefficients).max() < 1e-13


def test_single_polynomial_refuses_a_degree_that_rounding_spoils(rng: np.random.Generator) -> None:
    with pytest.raises(InputError, match=r"degree 48 .* too ill-conditioned: .* at most 1e-09 is allowed; use a lower"):
        profiles.single_polynomial(rng.normal(size=(45, 1)), np.linspace(0, 9, 45))


SPLINES = [("cubic_spline", 1), ("quintic_spline", 2), ("septic_spline", 3)]


@pytest.mark.parametrize(("name", "order"), SPLINES)
def test_the_banded_system_gives_what_the_dense_one_gave(name: str, order: int, rng: np.random.Generator) -> None:
    """Through 1000 vias the dense system took two minutes and 2 GB; the plain way is kept as the reference."""
    for n in (2, 3, 8, 50):
        times, points = np.concatenate([[0.0], np.cumsum(rng.uniform(0.3, 3.0, n - 1))]), rng.normal(size=(n, 3))
        move = getattr(profiles, name)(points, times)
        assert np.abs(move.position.coefficients - dense_rest_spline(times, points, order)).max() < 1e-12


@pytest.mark.parametrize(
    "name", ["cubic_spline", "quintic_spline", "septic_spline", "bspline", "cubic_spline_free_knots"]
)
def test_ten_thousand_vias(name: str, rng: np.random.Generator) -> None:
    """About 0.3 s; as a dense system of 60,000 equations it would fill 29 GB."""
    times, points = np.cumsum(rng.uniform(0.5, 1.5, 10_000)), rng.normal(size=(10_000, 2))
    move = getattr(profiles, name)(points, times)
    assert not move.via_miss.any()
    assert len(move.jumps(2).times) == (2 if name == "cubic_spline" else 0)


@pytest.mark.parametrize(("name", "order"), SPLINES)
@pytest.mark.parametrize("ratio", [30.0, 100.0, 1000.0])
def test_uneven_segments_are_solved_to_the_last_digits(
    name: str, order: int, ratio: float, rng: np.random.Generator
) -> None:
    """`quintic_spline` was refused at segments of 1 to 100, `septic_spline` at 1 to 30, with all digits right."""
    for lengths in ([1, 1 / ratio, 1, 1], [ratio, 1, 1, ratio], [1, 3, ratio, 30]):
        times = np.concatenate([[0.0], np.cumsum(lengths)])
        for points in (rng.normal(size=5), np.sin(2 * times / times[-1])):
            if name == "septic_spline" and ratio == 1000 and lengths[0] == 1 and lengths[1] == 3:
                continue  # swings 1e8 times beyond its points, so that they would not be met to 1e-9
            at = np.concatenate([np.linspace(0, times[-1], 15), times])
            exact = exact_rest_spline(times.tolist(), points.tolist(), order, at.tolist())
            move = getattr(profiles, name)(points[:, None], times)
            assert np.abs(move(at)[:, 0] - exact).max() < 4e-15 * np.abs(exact).max()


UNEVEN = [[0, 1, 2, 1e3], [0, 1, 2, 1e4], [0, 0.001, 10, 10.001], [0, 1, 2, 1e5], [0, 1, 2, 1e17], [0, 1e-200, 1, 2]]


@pytest.mark.parametrize("times", UNEVEN)
@pytest.mark.parametrize("name", ["septic", "single_polynomial"])
def test_one_polynomial_that_would_miss_its_points_is_refused(name: str, times: list[float]) -> None:
    """`septic` missed them in silence, by 1.2e-7 rad at a ratio of 1000 and by half a radian at 1e5.

    The reason is told: the intervals and their ratio.
    """
    with pytest.raises(
        InputError, match=r"times: degree 7 with segments of .* a ratio of .* is too ill-conditioned|too close"
    ):
        getattr(profiles, name)([[0.0], [0.5], [1.0], [0.2]], times)


@pytest.mark.parametrize("name", [info.name for info in profiles.available() if info.needs.startswith("times")])
@pytest.mark.parametrize("times", UNEVEN)
def test_uneven_times_are_met_or_refused_with_a_reason(name: str, times: list[float]) -> None:
    """A singular matrix once left `single_polynomial` and `bspline` as NumPy's error."""
    blended = name in ("trapezoidal", "polynomial_blends")
    more = {"blend_time": min(np.diff(times)) / 2} if blended else {}
    points = np.array([[0.0], [0.5], [1.0], [0.2]])
    reason = ""
    try:
        move = getattr(profiles, name)(points, times, **more)
    except InputError as error:
        reason = str(error)
    if reason:
        assert "too ill-conditioned" in reason or "too close" in reason
    elif next(info for info in profiles.available() if info.name == name).at_vias != "misses":
        assert np.abs(move(times) - points).max() < 1e-9


def test_rounding_of_a_wide_swing_is_no_miss(rng: np.random.Generator) -> None:
    """One in 150 "missed a via" by 5e-13 rad: a rounding of a polynomial that swings 1000 rad between them."""
    for _ in range(60):
        k = int(rng.integers(2, 22))
        points, times = rng.normal(size=(k, 2)).round(2), np.cumsum(rng.uniform(0.3, 2.0, k))
        for name in ("single_polynomial", "bspline"):
            assert not getattr(profiles, name)(points, times).via_miss.any()


@pytest.mark.parametrize("name", ["bspline", "cubic_spline_free_knots", "septic_spline"])
def test_the_points_that_are_too_close_are_named_not_the_knots(name: str) -> None:
    """Knots that are averages of times are even: "segments of 0.4 s to 0.4 s, a ratio of 1" was said of a B-spline."""
    message = r"segments of 1e-09 s \(segment 2, 1 s after the start\) to 1 s, a ratio of 1e\+09"
    with pytest.raises(InputError, match=message):
        getattr(profiles, name)([[0.0], [0.5], [1.0], [0.2]], [0, 1, 1 + 1e-9, 2])


def test_bezier_stays_within_its_hull_to_rounding(rng: np.random.Generator) -> None:
    """With 24 points it "overshot" by 6e-13 rad, rounding of a jerk that is 27^3 times as large."""
    for _ in range(60):
        k = int(rng.integers(2, 25))
        move = profiles.bezier(rng.normal(size=(k, 3)).round(2), np.cumsum(rng.uniform(0.3, 2.0, k)))
        assert not move.overshoot.any()
        assert len(move.jumps(1).times) == len(move.jumps(2).times) == 0


def test_splines_refuse_times_that_rounding_spoils() -> None:
    with pytest.raises(InputError, match=r"segments of 1e-07 s .segment 2, 1 s after the start. to 1 s, .* ill-cond"):
        profiles.septic_spline([[0.0], [1.0], [0.5], [2.0]], [0.0, 1.0, 1.0 + 1e-7, 2.0])


@pytest.mark.parametrize("name", [info.name for info in profiles.available() if info.name != "double_s"])
def test_bad_points_and_times(name: str) -> None:
    """What every profile with given times refuses at its door, named."""
    make = getattr(profiles, name)
    blended = name in ("trapezoidal", "polynomial_blends")
    more: dict[str, object] = {"blend_time": 0.1} if blended else {}
    good = [[0.0], [1.0], [2.0], [3.0]]
    if name == "lspb":

        def make(points: object, times: Array) -> Trajectory:  # type: ignore[no-redef]
            return profiles.lspb(points, durations=np.diff(times), blend_time=0.1)  # type: ignore[arg-type]

        equal = r"durations\[1\] = 0 s must be greater than 0 s"
    else:
        equal = r"times: must increase strictly, but times\[1\] = 1 s is followed by 1 s"
    with pytest.raises(InputError, match=f"{name} needs (at least|exactly) [234] points, got 1"):
        make([[0.0]], np.zeros(1), **more)
    with pytest.raises(InputError, match=equal):
        make(good, np.array([0.0, 1.0, 1.0, 2.0]), **more)
    with pytest.raises(InputError, match=r"points\[1, 0\] = nan"):
        make([[0.0], [np.nan], [2.0], [3.0]], np.arange(4.0), **more)
    with pytest.raises(InputError, match=r"joint_names: 2 names for 1 joints"):
        getattr(profiles, "quintic" if name == "lspb" else name)(good, np.arange(4.0), **more, joint_names=("a", "b"))


def test_other_refusals() -> None:
    points, times = [[0.0], [1.0], [2.0]], [0.0, 1.0, 2.0]
    with pytest.raises(InputError, match="cubic_spline_free_knots needs at least 3 points, got 2"):
        profiles.cubic_spline_free_knots(points[:2], times[:2])
    with pytest.raises(
        InputError, match=r"free_knots\[1\] = 0.5 s must lie inside the last segment, between 1 and 2 s"
    ):
        profiles.cubic_spline_free_knots(points, times, free_knots=[0.5, 0.5])
    with pytest.raises(InputError, match="poly_434 needs exactly 4 points, got 3"):
        profiles.poly_434(points, times)
    with pytest.raises(InputError, match=r"velocities: shape \(2, 1\) is not \(3, 1\)"):
        profiles.cubic(points, times, velocities=[[0.0], [0.0]])
    with pytest.raises(InputError, match=r"degree = 4 is not one of 3, 5"):
        profiles.bspline(points, times, degree=4)


@pytest.mark.parametrize("degree", [3, 5])
def test_bspline_agrees_with_scipy_on_averaged_knots(degree: int, points: Array) -> None:
    move = profiles.bspline(points, TIMES, degree=degree)
    rest = [(k, np.zeros(3)) for k in range(1, 3 if degree == 3 else 4)]
    sites = np.concatenate([[TIMES[0]] * len(rest), TIMES, [TIMES[-1]] * len(rest)])
    inner = np.array([sites[i : i + degree].mean() for i in range(1, len(sites) - degree)])
    knots = np.concatenate([[TIMES[0]] * (degree + 1), inner, [TIMES[-1]] * (degree + 1)])
    twin = make_interp_spline(TIMES, points, k=degree, t=knots, bc_type=(rest, rest))
    t = np.linspace(0, 4, 321)[1:-1]
    for order in range(4):
        assert np.abs(move(t, order) - twin(t, nu=order)).max() < 1e-12 * 60**order


@pytest.mark.parametrize("degree", [3, 5])
def test_bspline_control_agrees_with_scipy(degree: int, points: Array) -> None:
    move = profiles.bspline_control(points, TIMES, degree=degree)
    further = degree - 1
    control = np.concatenate([points[[0] * further], points, points[[-1] * further]])
    knots = np.concatenate([[TIMES[0]] * degree, move.breaks, [TIMES[-1]] * degree])
    twin = BSpline(knots, control, degree)
    t = np.linspace(0, 4, 321)[1:-1]
    for order in range(4):
        assert np.abs(move(t, order) - twin(t, nu=order)).max() < 1e-12 * 60**order


def test_cubic_control_polygon_misses_a_via_by_a_sixth_of_its_second_difference(rng: np.random.Generator) -> None:
    """Uniform knots, far from the ends: q(t_i) = (P_i-1 + 4 P_i + P_i+1) / 6 (de Boor)."""
    points = rng.normal(size=(9, 2))
    move = profiles.bspline_control(points, np.arange(9.0), degree=3)
    middle = np.arange(3.0, 6.0)
    expected = np.array([points[i - 1] + points[i + 1] - 2 * points[i] for i in (3, 4, 5)]) / 6
    assert np.abs(move(middle) - points[3:6] - expected).max() < 1e-13


def test_bezier_agrees_with_bernstein_and_with_the_quintic(points: Array) -> None:
    move = profiles.bezier(points, TIMES)
    control = np.concatenate([points[[0, 0]], points, points[[-1, -1]]])
    twin = BPoly(control[:, None], [0.0, 4.0])
    t = np.linspace(0, 4, 100)
    for order in range(4):
        assert np.abs(move(t, order) - twin(t, nu=order)).max() < 1e-11
    two = profiles.bezier(points[:2], [0.0, 2.0]).position.coefficients
    assert np.abs(two - profiles.quintic(points[:2], [0.0, 2.0]).position.coefficients).max() < 1e-14


def test_every_profile_that_is_listed_is_a_function() -> None:
    """A submodule of the same name would hide it."""
    for info in profiles.available():
        assert callable(getattr(profiles, info.name))
    assert set(profiles.__all__) >= {info.name for info in profiles.available()}
