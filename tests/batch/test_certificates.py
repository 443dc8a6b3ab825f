"""Certified bounds in interval arithmetic: no ball that covers a part of a motion lies beyond its bound."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb

import puma_septic as ps
from puma_septic.batch._metrics import metrics_of
from puma_septic.batch._stack import stacked
from puma_septic.piecewise.peaks import bounds, find_peaks

# Balls that cover [-1, 1]; a series of degree 6 varies little within one.
PARTS = 128


def enclosed(series: np.ndarray, x: arb) -> arb:
    """Clenshaw's recursion in ball arithmetic: contains every value of the series on the ball x."""
    after, following = arb(0), arb(0)
    for coefficient in series[:0:-1].tolist():
        after, following = arb(coefficient) + 2 * x * after - following, after
    return arb(float(series[0])) + x * after - following


@pytest.mark.slow
def test_a_hundred_motions_hold_no_counterexample(puma: ps.Robot, rng: np.random.Generator) -> None:
    moves = [ps.septic(points, [0.0, 3.0, 6.0, 9.0]) for points in rng.uniform(-1, 1, (100, 4, 6))]
    stack = stacked(moves)
    metrics = metrics_of(puma, stack, len(moves))
    balls = [arb((2 * k + 1) / PARTS - 1, 1 / PARTS) for k in range(PARTS)]
    for k in range(100):
        for order, name in ((1, "velocity"), (2, "acceleration")):
            for j in range(6):
                values = [abs(enclosed(stack.state[:, k, order, j], ball)) for ball in balls]
                bound, peak = metrics.bounds[name][k, j], metrics.peaks[name][k, j]
                assert not any(value > arb(bound) for value in values)
                assert bound <= 1.1 * peak
                # The peak itself lies in some ball, and none lies wholly above it.
                assert not any(value > arb(peak * (1 + 1e-14)) for value in values)
                assert any(value.overlaps(arb(peak, peak * 1e-12)) for value in values)


@pytest.mark.slow
def test_a_hundred_thousand_random_series_never_exceed_their_bounds(rng: np.random.Generator) -> None:
    for degree in (2, 3, 7, 16, 40):
        series = rng.normal(size=(degree + 1, 20_000))
        if degree > 16:  # resolved, as a fit leaves it
            series *= 10.0 ** (-11 * np.arange(degree + 1) / degree)[:, None]
        peak = find_peaks(series, np.arange(20_000), 20_000).size
        for m in (2, 8, 64):
            lower, upper = bounds(series, m)
            # What the Taylor series of a peak leaves out where the last coefficient is as large as the first.
            assert (lower <= peak * (1 + 1e-8)).all()
            assert (peak <= upper * (1 + 1e-14)).all()
            assert upper == pytest.approx(lower / np.cos(np.pi / (2 * m)), rel=1e-12)
