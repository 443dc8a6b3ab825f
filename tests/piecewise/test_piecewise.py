"""Piecewise: fit, evaluation, calculus, sign changes, extrema."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial, chebyshev
from numpy.typing import NDArray

import puma_septic as ps
from puma_septic.piecewise import Piecewise, matrices, sampled
from puma_septic.piecewise._search import _hidden

Array = NDArray[np.float64]


def random_series(seed: int, *, degree: int = 7, n: int = 3, m: int = 2, decay: float = 0.8) -> Piecewise:
    """Coefficients that fall as those of a smooth function do, on uneven intervals that do not start at 0."""
    rng = np.random.default_rng(seed)
    breaks = rng.uniform(-3, 3) + np.concatenate([[0.0], np.cumsum(rng.uniform(0.2, 2.0, n))])
    coefficients = rng.normal(size=(degree + 1, n, m)) * decay ** np.arange(degree + 1)[:, None, None]
    return Piecewise(breaks=breaks, coefficients=coefficients)


def times_in(f: Piecewise, k: int = 400) -> Array:
    return np.linspace(f.breaks[0], f.breaks[-1], k)


def by_hand(f: Piecewise, t: float) -> Array:
    """The definition in the class docstring, one number at a time."""
    i = min(int(np.sum(f.breaks[1:-1] <= t)), len(f.breaks) - 2)
    left, right = f.breaks[i], f.breaks[i + 1]
    x = (2 * t - left - right) / (right - left)
    return np.array([chebyshev.chebval(x, f.coefficients[:, i, j]) for j in range(f.n_components)])


seeds = st.integers(0, 10**6)


# --- making one -----------------------------------------------------------------------------------


def test_arrays_are_copied_and_read_only() -> None:
    breaks, coefficients = np.array([0.0, 1.0]), np.ones((2, 1, 1))
    f = Piecewise(breaks=breaks, coefficients=coefficients)
    coefficients[:] = 7.0
    breaks[1] = 9.0
    assert f(1.0) == 2.0
    with pytest.raises(ValueError, match="read-only"):
        f.coefficients[0] = 0.0
    with pytest.raises(ValueError, match="read-only"):
        f.derivative().coefficients[0] = 0.0


@pytest.mark.parametrize(
    ("breaks", "coefficients", "message"),
    [
        ([0.0], np.ones((1, 1, 1)), "breaks: at least 2 times are needed, got 1"),
        ([0.0, 1.0, 1.0], np.ones((1, 2, 1)), r"breaks\[1\] = 1 s is followed by 1 s"),
        ([0.0, np.nan], np.ones((1, 1, 1)), r"breaks\[1\] = nan s is not a finite number"),
        ([0.0, 1.0], np.ones((1, 2, 1)), r"coefficients: shape \(1, 2, 1\) is not \(n, 1, m\)"),
        ([0.0, 1.0], np.ones((1, 1)), r"coefficients: shape \(1, 1\)"),
        ([0.0, 1.0], np.full((1, 1, 1), np.inf), "coefficients.* = inf is not a finite number"),
        ([0.0, 1.0], np.ones((0, 1, 1)), "at least one"),
        ([0.0, 1.0], np.ones((1, 1, 0)), "at least one"),
    ],
)
def test_bad_arrays_are_refused(breaks: list[float], coefficients: Array, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        Piecewise(breaks=np.array(breaks), coefficients=coefficients)


@given(seeds)
@hypothesis_settings(max_examples=20)
def test_from_power_and_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    powers, breaks = rng.normal(size=(8, 2, 3)), [1.0, 2.5, 2.75]
    f = Piecewise.from_power(breaks, powers)
    for i, t in ((0, 1.7), (1, 2.6)):
        s = (t - breaks[i]) / (breaks[i + 1] - breaks[i])
        # Eight terms of order 1: a few roundings each.
        np.testing.assert_allclose(f(t), np.polynomial.polynomial.polyval(s, powers[:, i]), rtol=0, atol=1e-13)
    lengths = np.diff(breaks)[:, None, None] ** np.arange(8)[:, None]
    # The conversion to powers and back has a condition number of 1e5 at degree 7.
    np.testing.assert_allclose(f.power_coefficients() * lengths, powers.swapaxes(0, 1), rtol=0, atol=1e-10)


# --- fit ------------------------------------------------------------------------------------------


def counted(f):  # type: ignore[no-untyped-def]
    """The function, and the list of times at which it has been asked."""
    asked: list[float] = []

    def wrapper(t: Array) -> Array:
        asked.extend(t.tolist())
        return np.asarray(f(t))

    return wrapper, asked


def test_fit_reproduces_smooth_functions() -> None:
    def f(t: Array) -> Array:
        return np.stack([np.sin(7 * t), np.exp(-t), 1 / (1 + 5 * (t - 1) ** 2)], axis=1)

    g = Piecewise.fit(f, [0.0, 2.0])
    t = times_in(g)
    # The tail is below 1e-11 of each component's largest value; the sum of the tail is a few times that.
    np.testing.assert_allclose(g(t), f(t), rtol=0, atol=3e-11)


def test_fit_judges_the_tail_of_each_component_on_its_own() -> None:
    """A wrist's torque is a millionth of the shoulder's, and its peak is asked for as exactly."""

    def f(t: Array) -> Array:
        return np.stack([1e3 * np.sin(t), 1e-6 / (1 + 4 * t**2), 1e-6 * np.cos(20 * t)], axis=1)

    g = Piecewise.fit(f, [-1.0, 1.0])
    t = times_in(g)
    np.testing.assert_allclose(g(t)[:, 1:], f(t)[:, 1:], rtol=0, atol=1e-6 * 3e-11)


def test_fit_accepts_noise_that_is_rounding_of_the_largest_component() -> None:
    """A torque that is zero in theory comes out as the rounding of the others; no degree makes its tail fall."""
    rng = np.random.default_rng(0)

    def f(t: Array) -> Array:
        return np.stack([50 * np.sin(t), 1e-15 * rng.normal(size=len(t))], axis=1)

    g, asked = counted(f)
    fitted = Piecewise.fit(g, [0.0, 1.0, 2.0])
    assert np.abs(fitted.extrema().peak[1]) < 1e-14
    assert fitted.degree < 16
    # Without a search for what is not there: a few dozen nodes an interval.
    assert len(asked) < 140


def test_fit_of_constants_and_zeros_is_exact() -> None:
    g = Piecewise.fit(lambda t: np.stack([0 * t, 0 * t + 0.1, t], axis=1), [0.0, 1.0, 3.0])
    assert (g.coefficients[:, :, 0] == 0).all()
    assert g.degree == 1
    np.testing.assert_allclose(g.coefficients[0, :, 1], 0.1, rtol=1e-15)
    zero = Piecewise.fit(lambda t: np.zeros((len(t), 2)), [0.0, 1.0])
    assert zero.degree == 0
    assert (zero(0.5) == 0).all()


def test_fit_is_exact_for_polynomials() -> None:
    p = Polynomial([0.3, -2.0, 1.0, 0.0, 0.5, 0.0, -0.25, 0.125])
    g = Piecewise.fit(lambda t: p(t)[:, None], [0.0, 2.0])
    assert g.degree == 7
    t = times_in(g)
    np.testing.assert_allclose(g(t)[:, 0], p(t), rtol=0, atol=1e-13)


def test_fit_asks_only_for_new_nodes() -> None:
    """Node sets are nested: degree 48 costs the 25 nodes of degree 24 and the 24 between them."""
    g, asked = counted(lambda t: np.sin(12 * t)[:, None])
    Piecewise.fit(g, [0.0, 2.0])
    assert len(asked) == len(set(asked))
    assert len(asked) == 49


def test_fit_stays_inside_the_span_and_asks_on_the_right_side_of_breaks() -> None:
    """A function that steps at a break has the right-hand value there; the left interval must not see it."""
    g, asked = counted(lambda t: np.where(t < 1.0, t, t + 5.0)[:, None])
    f = Piecewise.fit(g, [0.1, 1.0, 1.3])
    assert min(asked) >= 0.1
    assert max(asked) <= 1.3
    np.testing.assert_allclose(f.jumps().sizes, [[5.0]], rtol=1e-13)
    assert f.degree == 1


def test_fit_does_not_mind_a_kink_at_a_break() -> None:
    g, asked = counted(lambda t: np.abs(t - 0.7)[:, None])
    f = Piecewise.fit(g, [0.0, 0.7, 2.0])
    assert len(asked) == 2 * 25
    np.testing.assert_allclose(f([0.2, 0.7, 1.7])[:, 0], [0.5, 0.0, 1.0], rtol=0, atol=1e-15)


def test_fit_bisects_a_wild_function() -> None:
    def f(t: Array) -> Array:
        return np.stack([np.sin(300 * t), 1 / (1e-4 + (t - 0.3) ** 2)], axis=1)

    g = Piecewise.fit(f, [0.0, 1.0])
    assert len(g.breaks) > 2
    t = np.random.default_rng(1).uniform(0, 1, 3000)
    # sin(300 t) near t = 1 is itself good to 300 roundings.
    np.testing.assert_allclose(g(t) / [1, 1e4], f(t) / [1, 1e4], rtol=0, atol=3e-11)


@pytest.mark.parametrize(
    ("f", "where"),
    [
        (lambda t: np.abs(t - 1 / 3), r"\[0\.3333\d+, 0\.3333\d+\] s"),
        (lambda t: np.sign(t - 0.3), r"\[0\.(29999|3000)\d+, 0\.3\d*\] s"),
        (lambda t: np.sqrt(t), r"\[0, \d\.\d+e-0\d\] s"),
    ],
)
def test_fit_refuses_what_is_not_smooth_and_says_where(f, where: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ps.PumaSepticError, match=where + r" \(component 1; .*not smooth there and needs a break"):
        Piecewise.fit(lambda t: np.stack([t, f(t)], axis=1), [0.0, 1.0])


def test_fit_gives_up_on_a_function_that_is_smooth_nowhere() -> None:
    rng = np.random.default_rng(0)
    g, asked = counted(lambda t: rng.normal(size=(len(t), 1)))
    with pytest.raises(ps.PumaSepticError, match="not smooth"):
        Piecewise.fit(g, [0.0, 1.0])
    # The cap of 200,000 samples is looked at after each round, which can double them.
    assert len(asked) < 400_000


def test_fit_refuses_nan_and_says_when() -> None:
    with pytest.raises(ps.PumaSepticError, match="not finite at t = 1 s"):
        Piecewise.fit(lambda t: np.where(t < 1, 0.0, np.nan)[:, None], [0.0, 1.0, 2.0])


@pytest.mark.parametrize("breaks", [[], [1.0], [1.0, 0.0]])
def test_fit_refuses_bad_breaks(breaks: list[float]) -> None:
    with pytest.raises(ps.InputError, match="breaks"):
        Piecewise.fit(lambda t: t[:, None], breaks)


# --- evaluation -----------------------------------------------------------------------------------


@given(seeds, st.sampled_from([0, 1, 3, 7, 33, 100]))
@hypothesis_settings(max_examples=30)
def test_values_are_the_definition(seed: int, degree: int) -> None:
    f = random_series(seed, degree=degree, n=4)
    rng = np.random.default_rng(seed)
    t = rng.uniform(f.breaks[0], f.breaks[-1], 150)  # in no order
    expected = np.array([by_hand(f, s) for s in t])
    # Two evaluations of sums of coefficients of order 1, some degree^2 roundings near the ends.
    np.testing.assert_allclose(f(t), expected, rtol=0, atol=1e-12)
    np.testing.assert_allclose(f(t[0]), expected[0], rtol=0, atol=1e-12)


@pytest.mark.parametrize("degree", [1, 6, 16, 64, 128])
def test_basis_is_the_textbook_recursion(degree: int) -> None:
    """Few points go through cosines, many through doubling; both are T_k+1 = 2 x T_k - T_k-1."""
    x = np.sin(np.linspace(-np.pi / 2, np.pi / 2, 301))
    for points in (x[::6], x):
        # cos(k arccos x) loses k roundings of an angle up to pi.
        np.testing.assert_allclose(
            matrices.basis_at(points, degree), chebyshev.chebvander(points, degree).T, rtol=0, atol=2e-13
        )


def test_shapes_follow_the_times() -> None:
    f = random_series(1, m=3)
    t = f.breaks[0]
    assert f(t).shape == (3,)
    assert f([t]).shape == (1, 3)
    assert f([]).shape == (0, 3)
    assert f(np.full((2, 5), t)).shape == (2, 5, 3)


def test_value_at_a_break_is_the_right_hand_one_and_at_the_end_the_left_hand_one() -> None:
    steps = Piecewise(breaks=[0.0, 1.0, 2.0, 3.0], coefficients=[[[1.0], [2.0], [3.0]]])
    assert steps([0.0, 1.0, 2.0, 3.0]).ravel().tolist() == [1.0, 2.0, 3.0, 3.0]
    assert steps(np.nextafter([1.0, 2.0], 0)).ravel().tolist() == [1.0, 2.0]


@given(seeds)
@hypothesis_settings(max_examples=20)
def test_ends_are_the_one_sided_values(seed: int) -> None:
    f = random_series(seed)
    left, right = f.ends()
    # A time is rounded, and the slope makes a value of it; 1e-14 is the rounding of eight terms of about 1.
    slopes = np.abs(f.derivative().ends())
    rounding = slopes * np.spacing(np.abs(f.breaks).max()) + 1e-14
    assert (np.abs(left - f(f.breaks[:-1])) <= rounding[0]).all()
    assert (np.abs(right[-1] - f(f.breaks[-1])) <= rounding[1, -1]).all()
    jumps = f.jumps()
    np.testing.assert_array_equal(jumps.times, f.breaks[1:-1])
    np.testing.assert_allclose(jumps.sizes, left[1:] - right[:-1], rtol=0, atol=0)


@pytest.mark.parametrize("t", [-1e-9, 2.1, np.nan, np.inf, [0.5, 7.0, 0.2]])
def test_times_outside_the_span_are_refused(t: float) -> None:
    f = Piecewise(breaks=[0.0, 2.0], coefficients=[[[1.0]]])
    with pytest.raises(ps.InputError, match=r"t = \S+ s is outside the span \[0, 2\] s"):
        f(t)


# --- calculus -------------------------------------------------------------------------------------


@given(seeds)
@hypothesis_settings(max_examples=20)
def test_derivative_and_integral_are_inverse(seed: int) -> None:
    f = random_series(seed)
    t = times_in(f)
    F = f.integral()
    np.testing.assert_allclose(F.derivative()(t), f(t), rtol=0, atol=1e-12)
    np.testing.assert_allclose(F(f.breaks[0]), 0.0, rtol=0, atol=1e-14)
    np.testing.assert_allclose(F.jumps().sizes, 0.0, rtol=0, atol=1e-13)
    # The other way round, the steps are lost.
    steps = np.cumsum(np.vstack([np.zeros(2), f.jumps().sizes]), axis=0)
    piece = np.searchsorted(f.breaks[1:-1], t, side="right")
    back = f.derivative().integral()(t) + steps[piece] + f(f.breaks[0])
    np.testing.assert_allclose(back, f(t), rtol=0, atol=1e-12)


def test_derivative_of_a_constant_is_zero() -> None:
    f = Piecewise(breaks=[0.0, 2.0], coefficients=[[[3.0]]]).derivative()
    assert f.degree == 0
    assert f(1.0) == 0.0
    assert f.derivative()(1.0) == 0.0


def test_integral_of_a_sine() -> None:
    F = Piecewise.fit(lambda t: np.sin(t)[:, None], [0.0, 1.0, 4.0]).integral()
    t = times_in(F)
    np.testing.assert_allclose(F(t)[:, 0], 1 - np.cos(t), rtol=0, atol=1e-11)


@given(seeds)
@hypothesis_settings(max_examples=20)
def test_inner_is_the_integral_of_the_product(seed: int) -> None:
    f = random_series(seed, degree=7)
    g = Piecewise(breaks=f.breaks[[0, -1]], coefficients=np.random.default_rng(seed).normal(size=(4, 1, 2)))
    expected = (f * g).integral()(f.breaks[-1])
    np.testing.assert_allclose(f.inner(g), expected, rtol=0, atol=1e-12)
    np.testing.assert_allclose(g.inner(f), expected, rtol=0, atol=1e-12)
    assert (f.inner(f) > 0).all()


@given(seeds)
@hypothesis_settings(max_examples=20)
def test_sum_difference_and_product_across_different_breaks(seed: int) -> None:
    f, g = random_series(seed, n=3, degree=5), random_series(seed + 1, n=4, degree=9)
    span = f.breaks[[0, -1]]
    inner = span[0] + np.cumsum([0.1, 0.4, 0.3]) * (span[1] - span[0])
    g = Piecewise(breaks=[span[0], *inner, span[1]], coefficients=g.coefficients)
    t = times_in(f)
    # Values of order 10, product of order 100.
    np.testing.assert_allclose((f + g)(t), f(t) + g(t), rtol=0, atol=1e-12)
    np.testing.assert_allclose((g - f)(t), g(t) - f(t), rtol=0, atol=1e-12)
    np.testing.assert_allclose((f * g)(t), f(t) * g(t), rtol=0, atol=2e-11)
    np.testing.assert_allclose((f * [2.0, -3.0])(t), f(t) * [2.0, -3.0], rtol=0, atol=1e-12)
    np.testing.assert_allclose((-0.5 * f)(t), f(t) * -0.5, rtol=0, atol=1e-12)
    np.testing.assert_allclose((np.array([2.0, 1.0]) * f)(t), f(t) * [2.0, 1.0], rtol=0, atol=1e-12)


def test_combinations_that_make_no_sense_are_refused() -> None:
    f = random_series(1, m=2)
    with pytest.raises(ps.InputError, match="their spans differ"):
        f + random_series(2, m=2)
    with pytest.raises(ps.InputError, match="2 and 3 components"):
        f * Piecewise(breaks=f.breaks, coefficients=np.ones((1, 3, 3)))
    with pytest.raises(ps.InputError, match="2 and 1 components"):
        f - Piecewise(breaks=f.breaks, coefficients=np.ones((1, 3, 1)))
    with pytest.raises(ps.InputError, match=r"factor: shape \(3,\) is not \(2,\)"):
        f * [1.0, 2.0, 3.0]
    with pytest.raises(ps.InputError, match="factor = nan is not a finite number"):
        f * np.nan
    with pytest.raises(ps.InputError, match=r"constant: shape \(3,\) is not \(2,\)"):
        f + np.ones(3)


def test_concatenate_puts_components_side_by_side() -> None:
    f = random_series(1, m=2, degree=7)
    both = Piecewise.concatenate([f, f.derivative(), f])
    t = times_in(f)
    np.testing.assert_allclose(both(t), np.hstack([f(t), f.derivative()(t), f(t)]), rtol=0, atol=1e-13)
    with pytest.raises(ps.InputError, match="share their breaks"):
        Piecewise.concatenate([f, random_series(2)])


@given(seeds, st.sampled_from([0.25, 1.0, 3.0]), st.sampled_from([0.0, -7.5, 1e3]))
@hypothesis_settings(max_examples=20)
def test_functions_are_moved_stretched_and_reversed_in_time(seed: int, factor: float, late: float) -> None:
    """What each docstring says, at times inside the intervals: a reversed step has its other side on the right."""
    f = random_series(seed)
    s = (np.linspace(0, 1, 41)[1:-1] * f.lengths[:, None] + f.offsets[:-1, None]).ravel()
    values = f.at_offsets(s)
    np.testing.assert_allclose(f.shifted(late)(f.start + late + s), values, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(f.from_zero()(s), values)
    np.testing.assert_allclose(f.stretched(factor)(f.start + factor * s), values, rtol=0, atol=1e-11)
    np.testing.assert_allclose(f.reversed()(f.duration - s), values, rtol=0, atol=1e-11)
    starts = [g.start for g in (f.shifted(late), f.from_zero(), f.stretched(factor), f.reversed())]
    assert starts == [f.start + late, 0.0, f.start, 0.0]
    assert f.stretched(factor).duration == pytest.approx(factor * f.duration, rel=1e-15)


@pytest.mark.parametrize("late", [0.0, 100.0, 1e4, 1.7e9])
def test_on_a_late_clock_a_break_is_no_new_one_beside_itself(late: float) -> None:
    """Bug: 1e4 + 0.7 - 1e4 is not 0.7: split(f.breaks) made intervals of 1e-12 s, and equal spans seemed to differ."""
    f, g = (
        Piecewise.fit(lambda t: np.column_stack([t, t**2]), b).shifted(late) for b in ([0, 0.7, 2.4], [0, 1.1, 2.4])
    )
    assert f.split(f.breaks) is f
    assert len(f.split(g.breaks).lengths) == 3
    both = Piecewise.joined([f, g])
    assert (len(both.lengths), both.n_components, both.start) == (3, 4, late)
    np.testing.assert_allclose(both.at_offsets(np.array([0.3, 2.0])), [[0.3, 0.09] * 2, [2.0, 4.0] * 2], atol=1e-13)
    level = Piecewise.constant([1.0, 1.0], f.duration, start=f.start)
    np.testing.assert_allclose((f - level).at_offsets(np.array([1.0])), 0.0, atol=1e-13)


@given(seeds)
@hypothesis_settings(max_examples=20)
def test_one_function_after_the_other_is_each_in_its_time(seed: int) -> None:
    functions = [random_series(seed, degree=3, n=2), random_series(seed + 1, degree=8, n=1), random_series(seed, n=3)]
    whole, start = Piecewise.sequence(functions), 0.0
    assert whole.duration == pytest.approx(sum(f.duration for f in functions), rel=1e-15)
    assert (whole.start, len(whole.lengths)) == (0.0, 6)
    for f in functions:
        s = np.linspace(0, f.duration, 50)[1:-1]
        np.testing.assert_allclose(whole(start + s), f.at_offsets(s), rtol=0, atol=1e-11)
        start += f.duration


def test_constants_steps_and_factors_by_interval() -> None:
    held = Piecewise.constant([2.0, -3.0], 4.0, start=1.0)
    assert (held.start, held.duration, held([1.0, 5.0]).tolist()) == (1.0, 4.0, [[2.0, -3.0]] * 2)
    f = Piecewise.from_power([0.0, 1.0, 3.0], [[[0.0, 1.0], [2.0, 5.0]], [[2.0, 1.0], [0.0, 1.0]]])
    assert f.middles.tolist() == [0.5, 2.0]
    assert f.stepwise([[7.0], [8.0]])([0.5, 2.0]).ravel().tolist() == [7.0, 8.0]
    assert f.by_interval([2.0, -1.0])([0.5, 2.0]).tolist() == [[2.0, 3.0], [-2.0, -5.5]]
    assert f.by_interval([[2.0, 0.0], [0.0, 1.0]])([0.5, 2.0]).tolist() == [[2.0, 0.0], [0.0, 5.5]]
    for values, shape in (([[7.0]], r"\(1, 1\)"), ([7.0, 8.0], r"\(2,\)")):
        with pytest.raises(ps.InputError, match=rf"values: shape {shape} is not \(2, p\), a row for each interval"):
            f.stepwise(values)


def test_the_last_coefficients_are_left_out_where_they_are_small_in_every_component() -> None:
    """Each is held against the largest of its own component, on all intervals."""
    series = np.zeros((6, 2, 2))
    series[0], series[2, 1], series[3, 0, 1] = [[1.0, 1e6], [100.0, 1e6]], [8e-8, 0.0], 0.5e-3
    f = Piecewise(breaks=[0.0, 1.0, 2.0], coefficients=series)
    assert [f.trimmed(part).degree for part in (0.0, 4e-10, 6e-10, 9e-10)] == [3, 3, 2, 0]
    assert (f * 0.0).trimmed(1e-3).degree == 0
    np.testing.assert_array_equal(f.trimmed(6e-10).coefficients, series[:3])


def test_mean_squares_and_spans_of_a_sine() -> None:
    """Its mean square over whole periods is a half; it is positive on every other half period."""
    sine = Piecewise.fit(lambda t: np.stack([np.sin(t), 3 * np.sin(t)], axis=1), [np.pi / 2, 4.0, 4.5 * np.pi])
    np.testing.assert_allclose(sine.rms(), [np.sqrt(0.5), 3 * np.sqrt(0.5)], rtol=1e-12)
    first, last = sine[0].positive_spans()
    np.testing.assert_allclose(first, [np.pi / 2, 2 * np.pi, 4 * np.pi], rtol=1e-12)
    np.testing.assert_allclose(last, [np.pi, 3 * np.pi, 4.5 * np.pi], rtol=1e-12)
    with pytest.raises(ps.InputError, match="positive_spans: one component is needed, the function has 2"):
        sine.positive_spans()


# --- split ----------------------------------------------------------------------------------------


@given(seeds)
@hypothesis_settings(max_examples=20)
def test_components_are_chosen_repeated_and_combined(seed: int) -> None:
    """Verbs for what callers did to coefficients by hand: choose, repeat, combine and move components."""
    rng = np.random.default_rng(seed)
    f = Piecewise(breaks=[0.0, 0.5, 2.0], coefficients=rng.normal(size=(5, 2, 3)))
    t, matrix, constant = rng.uniform(0, 2, 20), rng.normal(size=(3, 2)), rng.normal(size=3)
    np.testing.assert_array_equal(f[-1].coefficients, f.coefficients[:, :, 2:])
    np.testing.assert_array_equal(f[[0, 0, 2]].coefficients, f.coefficients[:, :, [0, 0, 2]])
    np.testing.assert_allclose(f.combined(matrix)(t), f(t) @ matrix, rtol=0, atol=1e-13)
    np.testing.assert_allclose((f + constant)(t), f(t) + constant, rtol=0, atol=1e-14)
    np.testing.assert_allclose((constant + f - 2.0)(t), constant + f(t) - 2.0, rtol=0, atol=1e-14)
    assert (np.abs(f(t)) <= f.bounds()[np.searchsorted([0.5], t, side="right")]).all()
    with pytest.raises(ps.InputError, match="matrix: shape"):
        f.combined(np.ones((2, 2)))


@given(seeds, st.lists(st.floats(0.0, 1.0), max_size=8), st.sampled_from([0, 3, 20, 64]))
@hypothesis_settings(max_examples=40)
def test_split_leaves_the_function_unchanged(seed: int, parts: list[float], degree: int) -> None:
    f = random_series(seed, degree=degree)
    times = f.breaks[0] + np.array(parts) * f.duration
    g = f.split(times)
    t = times_in(f)
    np.testing.assert_allclose(g(t), f(t), rtol=0, atol=1e-12)
    assert set(f.breaks) <= set(g.breaks)
    assert (np.diff(g.breaks) > 0).all()
    # Each time is a break, to 1e-13 of the span and the rounding of the clock.
    allowed = 1.01e-13 * f.duration + 4e-16 * np.abs(f.breaks).max()
    assert all(np.abs(g.breaks - s).min() <= allowed for s in times)


def test_breaks_are_those_of_the_other_function_also_where_two_are_one_to_rounding() -> None:
    """A cycle's torque may have two breaks within rounding; the velocity aligned with it had one, and sizing ended."""
    near = float(np.nextafter(np.nextafter(1.0, 2.0), 2.0))
    other = Piecewise(breaks=[0.0, 1.0, near, 2.0, 3.0], coefficients=np.zeros((1, 4, 1)))
    f = random_series(3, n=2, degree=5)
    f = Piecewise(breaks=[0.0, near, 3.0], coefficients=f.coefficients[:, :, :1])
    aligned = f.aligned_with(other)
    np.testing.assert_array_equal(aligned.breaks, other.breaks)
    t = np.linspace(0.0, 3.0, 50)
    np.testing.assert_allclose(aligned(t), f(t), rtol=0, atol=1e-12)


def test_split_leaves_out_what_changes_nothing() -> None:
    f = random_series(3)
    close = f.breaks[1] * (1 + 1e-15)
    g = f.split([f.breaks[0] - 1, f.breaks[0], f.breaks[1], close, f.breaks[-1], f.breaks[-1] + 1])
    np.testing.assert_array_equal(g.breaks, f.breaks)
    twins = f.split([f.breaks[0] + 0.1, f.breaks[0] + 0.1 + 1e-16, f.breaks[0] + 0.1])
    assert len(twins.breaks) == len(f.breaks) + 1
    with pytest.raises(ps.InputError, match=r"times\[1\] = nan s is not a finite number"):
        f.split([f.breaks[0], np.nan])


def test_split_keeps_a_zero_exactly_zero() -> None:
    """A joint at rest stays at rest: its sign must not come from rounding."""
    coefficients = np.random.default_rng(0).normal(size=(8, 1, 3))
    coefficients[:, :, 1] = 0.0
    g = Piecewise(breaks=[0.0, 9.0], coefficients=coefficients).split([1.0, 2.5, 7.1])
    assert (g.coefficients[:, :, 1] == 0).all()
    assert (g.signs()[:, 1] == 0).all()


# --- sign changes ------------------------------------------------------------------------------------


def eigenvalue_roots(series: Array, left: float, right: float) -> Array:
    """Real roots inside [left, right] as NumPy's companion matrix finds them."""
    x = chebyshev.chebroots(series)
    x = np.sort(x[np.abs(x.imag) < 1e-12].real)
    return (left * (1 - x) + right * (1 + x))[np.abs(x) <= 1] / 2


def one_component(roots: list[float], *, breaks: tuple[float, float] = (0.0, 9.0), at: float = 1.0) -> Piecewise:
    """A polynomial of t with the given roots, scaled to have values of order `at`."""
    s = Polynomial.fromroots((np.array(roots) - breaks[0]) / (breaks[1] - breaks[0]))
    return Piecewise.from_power(breaks, at * s.coef[:, None, None])


@given(seeds, st.integers(1, 9))
@hypothesis_settings(max_examples=150)
def test_roots_are_those_of_the_companion_matrix(seed: int, degree: int) -> None:
    f = random_series(seed, degree=degree, n=3, m=3, decay=1.0)
    for j, found in enumerate(f.roots()):
        pieces = zip(f.breaks[:-1], f.breaks[1:], f.coefficients[:, :, j].T, strict=True)
        expected = np.concatenate([eigenvalue_roots(c, left, right) for left, right, c in pieces])
        # A root moves by rounding over slope; random ones are simple.
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("degree", [32, 64, 128])
def test_roots_of_long_series(degree: int) -> None:
    for seed in range(5):
        f = random_series(seed, degree=degree, n=1, m=1, decay=1.0)
        expected = eigenvalue_roots(f.coefficients[:, 0, 0], *f.breaks)
        assert len(expected) > degree / 4
        np.testing.assert_allclose(f.roots()[0], expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("gap", [0.3, 3e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("at", [0.0, 0.5, 3.3, 4.5, 8.6])
def test_two_roots_in_one_cell_are_both_found(at: float, gap: float) -> None:
    f = one_component([at, at + gap, 12.0, -4.0])
    # A pair at distance d moves by rounding / d.
    expected = [at, at + gap] if at else [gap]
    np.testing.assert_allclose(f.roots()[0], expected, rtol=0, atol=1e-13 / gap)


@pytest.mark.parametrize("at", [0.0, 0.4, 4.5, 7.2, 9.0])
def test_a_double_zero_is_no_sign_change(at: float) -> None:
    f = one_component([at, at, -2.0, 11.0])
    assert len(f.roots()[0]) == 0
    assert len(f.split([4.0]).roots()[0]) == 0


@pytest.mark.parametrize("at", [0.4, 4.5, 7.2])
def test_a_triple_zero_is_one(at: float) -> None:
    # Rounding blurs a triple zero to its third root, 1e-5 of the span.
    np.testing.assert_allclose(one_component([at] * 3).roots()[0], [at], rtol=0, atol=2e-4)


def test_a_zero_at_a_grid_point_is_found() -> None:
    np.testing.assert_allclose(one_component([4.5]).roots()[0], [4.5], rtol=1e-14)
    assert one_component([4.5], at=1e-200).roots()[0] == pytest.approx([4.5])


def test_a_sign_change_at_a_break_or_end_needs_no_root() -> None:
    assert len(one_component([0.0]).roots()[0]) == 0
    assert len(one_component([9.0]).roots()[0]) == 0
    assert len(one_component([4.5]).split([4.5]).roots()[0]) == 0
    step = Piecewise(breaks=[0.0, 1.0, 2.0], coefficients=[[[1.0], [-1.0]]])
    assert len(step.roots()[0]) == 0


def test_a_component_at_rest_has_no_roots_and_no_sign() -> None:
    coefficients = np.zeros((4, 2, 2))
    coefficients[:, 1, 0] = [0.0, 1.0, 0.0, 0.0]
    f = Piecewise(breaks=[0.0, 1.0, 2.0], coefficients=coefficients)
    first, second = f.roots()
    np.testing.assert_allclose(first, [1.5], rtol=1e-15)
    assert len(second) == 0
    assert f.split(first).signs().tolist() == [[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0]]


@given(seeds)
@hypothesis_settings(max_examples=50)
def test_signs_hold_between_roots(seed: int) -> None:
    f = random_series(seed, degree=9, n=3, m=2, decay=1.0)
    g = f.split(np.concatenate(f.roots()))
    t = times_in(g, 2000)
    piece = np.searchsorted(g.breaks[1:-1], t, side="right")
    values = g(t)
    wrong = (np.sign(values) != g.signs()[piece]) & (np.abs(values) > 1e-11)
    assert not wrong.any()


def test_septic_velocity_has_no_root_next_to_its_ends() -> None:
    """Root finders return 8.9999995 s for the double zero at 9 s, and the sign beyond it is wrong.

    Joint 1 of the paper: velocity is zero twice at each end, and reverses at 1.43 s and 6.92 s.
    """
    move = ps.septic([[2.57], [2.57], [-0.5716], [-0.5716]], [0.0, 2.0, 6.0, 9.0])
    velocity = move.derivative(1)
    np.testing.assert_allclose(velocity.roots()[0], [1.43, 6.92], rtol=0, atol=5e-3)
    assert velocity.split(velocity.roots()[0]).signs().ravel().tolist() == [1.0, -1.0, 1.0]


# --- extrema ------------------------------------------------------------------------------------------


def eigenvalue_extrema(f: Piecewise, j: int) -> tuple[float, float]:
    """Least and greatest value at the ends and at all critical points of all intervals."""
    candidates = [*f.ends()[0][:, j], *f.ends()[1][:, j]]
    for c in f.coefficients[:, :, j].T:
        x = chebyshev.chebroots(chebyshev.chebder(c)) if len(c) > 2 else np.zeros(0)
        candidates += list(chebyshev.chebval(np.clip(x.real, -1, 1), c))
    return min(candidates), max(candidates)


def check_extrema(f: Piecewise, tolerance: float) -> None:
    found = f.extrema()
    for j in range(f.n_components):
        low, high = eigenvalue_extrema(f, j)
        assert found.min[j] == pytest.approx(low, abs=tolerance)
        assert found.max[j] == pytest.approx(high, abs=tolerance)
    # A time stamp's own rounding, by a steep slope, may exceed the extremum by more.
    at_times = f(times_in(f, 3000))
    loose = max(tolerance, 1e-11)
    assert (found.min - loose <= at_times).all()
    assert (at_times <= found.max + loose).all()


@given(seeds, st.integers(0, 9), st.sampled_from([0.4, 0.8, 1.0]))
@hypothesis_settings(max_examples=300)
def test_extrema_are_those_of_the_companion_matrix(seed: int, degree: int, decay: float) -> None:
    # Ten coefficients of order 1: a few roundings.
    check_extrema(random_series(seed, degree=degree, n=3, m=3, decay=decay), 3e-14)


@pytest.mark.parametrize("degree", [32, 64, 128])
def test_extrema_of_long_series(degree: int) -> None:
    for seed in range(5):
        # cos(k arccos x) loses k roundings of an angle up to pi, in each of the terms.
        check_extrema(random_series(seed, degree=degree, n=2, m=2, decay=0.97), 1e-11)


@given(
    st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=5),
    st.floats(-0.98, 0.98),
    st.sampled_from([0.2, 0.1, 0.05, 0.02, 0.01, 0.003]),
)
@hypothesis_settings(max_examples=200)
def test_extrema_crowded_into_one_cell(offsets: list[float], at: float, size: float) -> None:
    """Several critical points between two grid points: the grid sees one slope change or none.

    What is lost is the depth of the wrinkle between them: its size to the fourth power, and no more than a cell's.
    """
    slope = chebyshev.chebfromroots(np.clip(at + size * np.array(offsets), -1, 1))
    series = chebyshev.chebint(slope / np.abs(slope).sum())
    f = Piecewise(breaks=[-1.0, 1.0], coefficients=series[:, None, None] * [[[1.0, -1.0]]])
    check_extrema(f, min(size**4, 1e-6))


@given(seeds)
@hypothesis_settings(max_examples=50)
def test_extrema_are_taken_where_they_say(seed: int) -> None:
    f = random_series(seed, degree=8, n=4, m=3)
    # Steps apart, the value at the instant is the extremum; just beside the instant where the step is.
    found, width = f.extrema(), 1e-12
    for j, (value, t) in [
        *enumerate(zip(found.min, found.t_min, strict=True)),
        *enumerate(zip(found.max, found.t_max, strict=True)),
    ]:
        beside = np.clip([t - width, t, t + width], *f.breaks[[0, -1]])
        assert np.abs(f(beside)[:, j] - value).min() < 1e-9


def test_extrema_count_both_sides_of_a_step() -> None:
    saw = Piecewise.from_power([0.0, 1.0, 2.0], [[[0.0], [-5.0]], [[3.0], [1.0]]])
    found = saw.extrema()
    assert (found.max, found.t_max) == (3.0, 1.0)
    assert (found.min, found.t_min) == (-5.0, 1.0)
    assert (found.peak, found.t_peak) == (5.0, 1.0)


def test_of_equal_extrema_the_first_is_named() -> None:
    """Equal to rounding, that is: a repeated cycle reaches the same peak with another last digit each time."""
    swing = Piecewise.fit(lambda t: np.stack([np.sin(t), -np.cos(t)], axis=1), np.linspace(0.0, 20 * np.pi, 6))
    found = swing.extrema()
    # sin(t) at rounding from its peak: t is good to the square root of it.
    np.testing.assert_allclose(found.t_max, [np.pi / 2, np.pi], rtol=0, atol=1e-6)
    np.testing.assert_allclose(found.t_min, [3 * np.pi / 2, 0.0], rtol=0, atol=1e-6)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_rounding_of_another_processor_names_no_other_peak(sign: float) -> None:
    """The way back of the paper's cycle has the same torque but for 70 roundings, on whose side the kernels differ."""
    humps = Piecewise.from_power([0.0, 1.0, 2.0], np.multiply.outer([0.0, 4.0, -4.0], [[1.0], [sign * (1 + 2e-13)]]))
    found = humps.extrema()
    assert (found.peak, found.t_peak) == (pytest.approx(1.0, rel=1e-12), pytest.approx(0.5, abs=1e-12))


def test_a_plateau_is_reached_at_its_start() -> None:
    ramp_plateau = Piecewise.from_power([0.0, 1.0, 2.0, 3.0], [[[0.0], [2.0], [2.0]], [[2.0], [0.0], [-2.0]]])
    found = ramp_plateau.extrema()
    assert (found.max, found.t_max) == (2.0, 1.0)
    assert (found.min, found.t_min) == (0.0, 0.0)
    still = Piecewise(breaks=[1.0, 2.0, 3.0], coefficients=np.full((1, 2, 1), 0.1)).extrema()
    assert (still.min, still.max, still.t_min, still.t_max, still.t_peak) == (0.1, 0.1, 1.0, 1.0, 1.0)


def test_extrema_of_a_component_beside_a_large_one() -> None:
    f = Piecewise.fit(lambda t: np.stack([1e6 * np.cos(t), 1e-3 * np.sin(3 * t)], axis=1), [0.0, 2.0])
    np.testing.assert_allclose(f.extrema().max, [1e6, 1e-3], rtol=1e-11)


@given(seeds)
@hypothesis_settings(max_examples=30)
def test_extrema_turn_over_with_the_function(seed: int) -> None:
    f = random_series(seed, degree=9, decay=1.0)
    up, down = f.extrema(), (f * -1.0).extrema()
    np.testing.assert_allclose(down.max, -up.min, rtol=0, atol=1e-14)
    np.testing.assert_allclose(down.t_max, up.t_min, rtol=0, atol=1e-12)
    np.testing.assert_allclose(down.peak, up.peak, rtol=0, atol=1e-14)


def test_derivatives_side_by_side_are_the_derivatives() -> None:
    f = Piecewise.fit(lambda t: np.stack([np.sin(3 * t), t**3], axis=1), [0.0, 1.0, 2.5])
    state = f.with_derivatives(2)
    first, second = f.derivative(), f.derivative().derivative()
    t = times_in(f)
    np.testing.assert_allclose(state(t), np.concatenate([f(t), first(t), second(t)], axis=1), rtol=0, atol=1e-10)
    # A polynomial's highest derivatives are exactly what they are, zero included.
    constant = Piecewise.from_power([0.0, 2.0], [[[3.0]]]).with_derivatives(3)
    assert constant(1.0).tolist() == [3.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize("degree", [5, 40])
def test_the_search_for_extrema_finds_all_turns_of_the_first_components(degree: int) -> None:
    """They are the sign changes of the slope, also where the component is far from its extrema; of the others none."""
    rng = np.random.default_rng(degree)
    breaks = np.array([2.0, 3.0, 3.5, 7.0])
    f = Piecewise(breaks=breaks, coefficients=rng.normal(size=(degree + 1, 3, 4)) * [1.0, 1e-6, 1e3, 1.0])
    extrema, turns = f.extrema_and_turns(2)
    for found, expected in zip(turns, f.derivative().roots()[:2], strict=True):
        np.testing.assert_allclose(np.sort(2.0 + found), expected, rtol=1e-12)
    # The series is evaluated at other points at once, and rounded otherwise.
    np.testing.assert_allclose([extrema.min, extrema.t_max], [f.extrema().min, f.extrema().t_max], rtol=1e-13)


def test_the_tail_of_a_series_is_its_last_eighth_and_at_least_two() -> None:
    """One measure for fits and for the solver of winding temperatures."""
    series = np.arange(17.0)[:, None] * [1.0, -2.0]
    assert matrices.tail(series).tolist() == [16.0, 32.0]
    series[15:] = 0.0
    assert matrices.tail(series).tolist() == [0.0, 0.0]
    assert matrices.tail(np.array([[3.0], [2.0], [1.0]])).tolist() == [2.0]


def test_samples_for_drawing_are_shared_by_the_intervals_lengths() -> None:
    """Of 400 samples a quarter of the span has 100, and a sliver of it the least."""
    f = Piecewise(breaks=[0.0, 1.0, 3.996, 4.0], coefficients=np.zeros((2, 3, 1)))
    t, values = sampled(f, samples=400, least=16)
    assert (np.count_nonzero(t < 0.9999), np.count_nonzero(t > 3.9961)) == (99, 15)
    assert len(t) == len(values) == 100 + 300 + 16


@pytest.mark.parametrize("n", [2, 8, 20])
def test_what_a_cell_may_hide_is_bounded_and_hardly_more(n: int) -> None:
    """In a cell of width h, cos(n theta) rises ``1 - cos(n h / 2)`` above both ends: n^2 h^2 / 8, but for h^4."""
    grid = n * 41 // 2 + 1  # 20 and a half cells to each half wave: a crest lies in the middle of one
    theta = np.pi * np.arange(grid) / (grid - 1)
    series = np.zeros((n + 1, 1))
    series[n] = 1.0
    crest = np.abs(np.cos(n * (theta[:-1] + theta[1:]) / 2))
    ends = np.abs(np.cos(n * theta))
    rise = (crest - np.maximum(ends[:-1], ends[1:])).max()
    hidden = float(_hidden(series, grid)[0])
    assert rise <= hidden <= 1.01 * rise
