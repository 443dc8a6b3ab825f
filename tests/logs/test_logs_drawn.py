"""What is drawn of a motion with thousands of samples: enough for a screen, and every step that is seen."""

from __future__ import annotations

import numpy as np
import pytest
from helpers.recordings import MOVE, recorded

import puma_septic as ps
from puma_septic.piecewise import Piecewise, sampled


def test_many_intervals_are_drawn_by_even_instants_and_their_steps() -> None:
    """Eight points on each of 3,600 intervals made reports of 36 MB."""
    breaks = np.linspace(0.0, 1.0, 2001)
    values = np.sin(3 * breaks[:-1]) + (breaks[:-1] >= 0.5)
    t, drawn = sampled(Piecewise(breaks=breaks, coefficients=values[None, :, None]))
    assert len(t) <= 2000
    assert (np.diff(t) >= 0).all()
    at = np.flatnonzero(t == 0.5)
    assert drawn[at[0], 0] == pytest.approx(np.sin(3 * breaks[999]))
    assert drawn[at[-1], 0] == pytest.approx(np.sin(1.5) + 1)


def test_the_samples_of_a_log_are_not_marked_one_by_one() -> None:
    t, q = recorded(MOVE, 100)
    fitted = ps.fit_trajectory(t, q)
    times, points = fitted.marked
    assert times.tolist() == [0.0, 3.6]
    assert (points == q[[0, -1]]).all()
    assert len(MOVE.marked[0]) == 4
