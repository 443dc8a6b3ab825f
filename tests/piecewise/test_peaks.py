"""Largest magnitudes of many series at once, with and without steps; certified bounds."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import chebyshev

from puma_septic.piecewise import Piecewise
from puma_septic.piecewise.peaks import Steps, bounds, find_peaks, hidden, ranges


def decaying(rng: np.random.Generator, degree: int, count: int) -> np.ndarray:
    """Series such as a fit leaves: their last coefficients are 1e-11 of the first."""
    decay = 10.0 ** (-11 * np.arange(degree + 1) / max(degree, 1))
    return decay[:, None] * rng.normal(size=(degree + 1, count))


@pytest.mark.parametrize("degree", [0, 1, 6, 7, 40, 80])
def test_peaks_are_those_that_isolated_roots_give(rng: np.random.Generator, degree: int) -> None:
    """Two ways: `Piecewise.extrema`, which isolates roots by Bernstein's form."""
    series = rng.normal(size=(degree + 1, 300)) if degree <= 7 else decaying(rng, degree, 300)
    found = find_peaks(series, np.arange(300), 300)
    exact = Piecewise(breaks=[-1.0, 1.0], coefficients=series[:, None]).extrema()
    assert found.size == pytest.approx(exact.peak, rel=1e-11)
    at = np.abs([chebyshev.chebval(x, column) for x, column in zip(found.x, series.T, strict=True)])
    assert at == pytest.approx(found.size, rel=1e-9)
    assert (found.size <= found.bound * (1 + 1e-14)).all()
    assert (found.at_points <= found.size).all()


def test_a_group_has_the_peak_of_its_largest_series(rng: np.random.Generator) -> None:
    series, group = decaying(rng, 30, 90), np.repeat(np.arange(30), 3)
    found = find_peaks(series, group, 30)
    alone = find_peaks(series, np.arange(90), 90)
    assert found.size == pytest.approx(alone.size.reshape(30, 3).max(axis=1), rel=1e-14)
    assert (found.column // 3 == np.arange(30)).all()


def test_steps_are_seen_from_both_sides(rng: np.random.Generator) -> None:
    """Two ways: the same functions as `Piecewise`, split at their steps."""
    series, count = decaying(rng, 30, 60), rng.integers(0, 5, 60)
    column = np.repeat(np.arange(60), count)
    x = np.concatenate([np.sort(rng.uniform(-0.999, 0.999, k)) for k in count])
    steps = Steps(first=rng.normal(size=60), column=column, x=x, level=rng.normal(size=len(x)))
    found = find_peaks(series, np.arange(60), 60, steps)
    for j in range(60):
        inside = column == j
        levels = np.concatenate([steps.first[j : j + 1], steps.level[inside]])
        smooth = Piecewise(breaks=[-1.0, 1.0], coefficients=series[:, j : j + 1, None]).split(x[inside])
        assert found.size[j] == pytest.approx((smooth + smooth.stepwise(levels[:, None])).extrema().peak[0], rel=1e-11)


@pytest.mark.parametrize(("slope", "sign"), [(3.0, 1.0), (-3.0, 1.0), (3.0, -1.0)])
def test_a_saw_peaks_beside_a_tooth_s_step(rng: np.random.Generator, slope: float, sign: float) -> None:
    """Known answer: of teeth of nearly one height the highest is missed by points; it stands beside a step."""
    count, teeth = 200, 6
    x = np.sort(rng.uniform(-0.99, 0.99, (count, teeth)), axis=1)
    ends = np.column_stack([np.full(count, -1.0), x, np.full(count, 1.0)])
    heights = 1.0 + rng.uniform(0, 0.02, (count, teeth + 1))
    # Each tooth has its height at its upper end.
    level = heights - slope * (ends[:, 1:] if slope > 0 else ends[:, :-1])
    series = sign * np.array([np.zeros(count), np.full(count, slope)])
    level *= sign
    steps = Steps(first=level[:, 0], column=np.repeat(np.arange(count), teeth), x=x.ravel(), level=level[:, 1:].ravel())
    low = heights - abs(slope) * np.diff(ends, axis=1)
    found = find_peaks(series, np.arange(count), count, steps)
    assert found.size == pytest.approx(np.maximum(heights, np.abs(low)).max(axis=1), rel=1e-12)
    # As a group of ten, too: what is known of one must not hide the tooth of another.
    group = find_peaks(series, np.arange(count) // 10, count // 10, steps)
    assert group.size == pytest.approx(found.size.reshape(-1, 10).max(axis=1), rel=1e-14)


@pytest.mark.parametrize("m", [2, 8, 64])
def test_the_range_of_chebyshev_polynomials_and_its_bounds(m: int) -> None:
    """``3 + 2 T_4`` goes from 1 to 5; its bounds are 1 / cos(pi / (2 m)) times as far from the middle."""
    series = np.array([[3.0, 7.0], *np.zeros((3, 2)), [2.0, 0.0]])
    inner, outer = ranges(series, m)
    assert inner == pytest.approx(np.array([[1.0, 7.0], [5.0, 7.0]]), rel=1e-13)
    beyond = 2 / np.cos(np.pi / (2 * m))
    assert outer == pytest.approx(np.array([[3 - beyond, 7.0], [3 + beyond, 7.0]]), rel=1e-13)
    for constant in ranges(series[:1], m):
        assert constant.tolist() == [[3.0, 7.0]] * 2


@pytest.mark.parametrize("m", [2, 8, 64])
def test_the_bound_is_attained_by_chebyshev_polynomials(m: int) -> None:
    """Ehlich and Zeller 1964: of all polynomials with magnitude 1 at the zeros of T_mn the largest is that one.

    At Lobatto points, which hold both ends, T_n itself is 1: the extremal one is T_n on a range that is wider by
    1 / cos(pi / (2 m)) in angle, so that the bound is never exceeded and nearly reached.
    """
    lower, upper = bounds(np.eye(8)[:, 7:], m)
    assert lower[0] == pytest.approx(1, rel=1e-13)
    assert upper[0] == pytest.approx(1 / np.cos(np.pi / (2 * m)), rel=1e-13)


@pytest.mark.parametrize("degree", [7, 20, 40])
def test_bounds_of_peaks_are_as_close_as_their_proofs(degree: int) -> None:
    """The lesser of Ehlich and Zeller's, on 32 cells or as many as the degree, and n^2 h^2 / 8 above T_n's points."""
    cells = max(degree, 32)
    series = np.eye(degree + 1)[:, degree:]
    above = degree**2 * (np.pi / cells) ** 2 / 8
    assert hidden(series, cells) == pytest.approx([above], rel=1e-14)
    found = find_peaks(series, np.zeros(1, dtype=int), 1)
    zeller = 1 / np.cos(np.pi * degree / (2 * cells)) if degree < cells else np.inf
    # T_n is 1 at both ends, which are points.
    assert found.bound == pytest.approx([min(1 + above, zeller)], rel=1e-12)
    # A step apart, what is hidden alone is proved.
    steps = Steps(first=np.ones(1), column=np.zeros(1, dtype=int), x=np.array([0.5]), level=np.ones(1))
    assert find_peaks(series, np.zeros(1, dtype=int), 1, steps).bound == pytest.approx([2 + above], rel=1e-12)


def test_ten_thousand_random_series_never_exceed_their_bounds(rng: np.random.Generator) -> None:
    for degree in (1, 5, 16):
        series = rng.normal(size=(degree + 1, 10_000 // 3))
        peak = find_peaks(series, np.arange(series.shape[1]), series.shape[1]).size
        for m in (2, 8):
            lower, upper = bounds(series, m)
            assert (peak <= upper * (1 + 1e-14)).all()
            assert (lower <= peak * (1 + 1e-14)).all()
            outer = ranges(series, m)[1]
            assert (peak <= np.abs(outer).max(axis=0) * (1 + 1e-14)).all()
