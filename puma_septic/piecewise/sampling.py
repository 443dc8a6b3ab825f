"""Samples of a function for drawing; no number that is reported is read off them."""

from __future__ import annotations

import numpy as np

from puma_septic.piecewise.function import Piecewise
from puma_septic.validation import Array

__all__ = ["sampled"]


def sampled(function: Piecewise, *, samples: int = 480, least: int = 16) -> tuple[Array, Array]:
    """Instants (k,) and values (k, m) to draw; each break occurs twice, with the values of both its sides.

    Parameters
    ----------
    function : Piecewise
    samples : int
        About so many over the span, evenly spaced on each interval.
    least : int
        On each interval, both its ends included.

    Examples
    --------
    >>> step = Piecewise(breaks=[0.0, 1.0, 2.0], coefficients=[[[0.0], [1.0]]])
    >>> t, values = sampled(step, samples=4, least=2)
    >>> t.tolist(), values[:, 0].tolist()
    ([0.0, 1.0, 1.0, 2.0], [0.0, 0.0, 1.0, 1.0])
    """
    counts = np.maximum(least, np.ceil(samples * np.diff(function.breaks) / function.duration)).astype(int)
    left, right = function.ends()
    times, values = [], []
    for i, count in enumerate(counts):
        t = np.linspace(function.breaks[i], function.breaks[i + 1], count)
        times.append(t)
        values.append(np.vstack([left[i], function(t[1:-1]), right[i]]))
    return np.concatenate(times), np.concatenate(values)
