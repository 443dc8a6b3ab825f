"""Peaks and root mean squares of many combinations at once."""

import numpy as np
import pytest

from puma_septic.piecewise import Piecewise
from puma_septic.piecewise.combinations import Combinations


def random_parts(rng: np.random.Generator, degree: int, n: int, count: int, m: int) -> list[Piecewise]:
    breaks = np.concatenate([[3.0], 3.0 + np.cumsum(rng.uniform(0.2, 2.0, n))])
    decay = 0.8 ** np.arange(degree + 1)[:, None, None]
    return [Piecewise(breaks=breaks, coefficients=decay * rng.normal(size=(degree + 1, n, m))) for _ in range(count)]


@pytest.mark.parametrize(("degree", "n"), [(0, 1), (3, 1), (9, 4), (60, 1), (60, 3)])
def test_peaks_and_rms_are_those_of_each_combination_alone(rng: np.random.Generator, degree: int, n: int) -> None:
    """Two ways: `extrema` and `rms` of the sum itself, which isolate roots by Bernstein's form."""
    parts = random_parts(rng, degree, n, 3, 2)
    steps = Piecewise(breaks=parts[0].breaks, coefficients=rng.normal(size=(1, n, 2)))
    cuts = parts[0].start + rng.uniform(0, 1, 5) * parts[0].duration
    steps = steps.split(cuts)
    steps = steps.stepwise(rng.normal(size=(len(steps.lengths), 2)))
    weights = rng.normal(size=(40, 3))
    many = Combinations(parts=parts, steps=steps)
    peak, time = many.peaks(weights)
    rms = many.rms(weights)
    for w, p, t, r in zip(weights, peak, time, rms, strict=True):
        alone = parts[0] * float(w[0]) + parts[1] * float(w[1]) + parts[2] * float(w[2]) + steps
        # What the Taylor series leaves out of a series that decays by 0.8 only, see `_ORDER`.
        assert p == pytest.approx(alone.extrema().peak, rel=1e-9)
        assert r == pytest.approx(alone.rms(), rel=1e-12)
        for j in range(2):
            inside = parts[0].start < t[j] < parts[0].start + parts[0].duration
            beside = [alone(np.clip(t[j] + d, *parts[0].breaks[[0, -1]]))[j] for d in (-1e-9, 0.0, 1e-9)]
            assert not inside or max(np.abs(beside)) == pytest.approx(p[j], rel=1e-6)


def test_without_steps_a_chebyshev_polynomial_peaks_at_one() -> None:
    """Known answer: T_n has the magnitude 1 at n + 1 points, ends included."""
    series = np.zeros((21, 1, 1))
    series[20] = 1.0
    many = Combinations(parts=[Piecewise(breaks=[0.0, 1.0], coefficients=series)])
    peak, time = many.peaks(np.array([[2.0], [-3.0], [0.0]]))
    assert peak.ravel() == pytest.approx([2.0, 3.0, 0.0], rel=1e-14)
    assert ((time >= 0) & (time <= 1)).all()
    # The mean square of T_n over [-1, 1] is 1/2 - 1 / (2 (4 n^2 - 1)).
    assert many.rms(np.ones((1, 1)))[0, 0] == pytest.approx(np.sqrt(0.5 - 0.5 / (4 * 400 - 1)), rel=1e-14)
