"""Samples of a function for drawing; no number that is reported is read off them."""

from __future__ import annotations

import numpy as np

from puma_septic.piecewise._piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["sampled"]

# More intervals than this, as a recorded motion has, are not drawn one by one; a screen has fewer columns.
_MOST_INTERVALS = 500
_THINNED = 1500
# Of these, steps that are seen in a picture are drawn upright: this part of the range, the largest of them.
_SEEN = 1e-3
_MOST_STEPS = 200


def sampled(function: Piecewise, *, samples: int = 480, least: int = 16) -> tuple[Array, Array]:
    """Instants (k,) and values (k, m) to draw; each break occurs twice, with the values of both its sides.

    Parameters
    ----------
    function : Piecewise
    samples : int
        About this many over the span, evenly spaced on each interval.
    least : int
        On each interval, both its ends included. A function of more than 500 intervals has 1,500 instants in all, and
        the two sides of its visible steps.

    Examples
    --------
    >>> step = Piecewise(breaks=[0.0, 1.0, 2.0], coefficients=[[[0.0], [1.0]]])
    >>> t, values = sampled(step, samples=4, least=2)
    >>> t.tolist(), values[:, 0].tolist()
    ([0.0, 1.0, 1.0, 2.0], [0.0, 0.0, 1.0, 1.0])
    """
    if len(function.lengths) > _MOST_INTERVALS:
        return _thinned(function)
    counts = np.maximum(least, np.ceil(samples * np.diff(function.breaks) / function.duration)).astype(int)
    left, right = function.ends()
    times, values = [], []
    for i, count in enumerate(counts):
        t = np.linspace(function.breaks[i], function.breaks[i + 1], count)
        times.append(t)
        values.append(np.vstack([left[i], function(t[1:-1]), right[i]]))
    return np.concatenate(times), np.concatenate(values)


def _thinned(function: Piecewise) -> tuple[Array, Array]:
    """Evenly spaced instants, and both sides of the largest steps."""
    left, right = function.ends()
    even = np.linspace(function.breaks[0], function.breaks[-1], _THINNED)
    values = function(even)
    steps = np.abs(left[1:] - right[:-1]) / np.maximum(np.ptp(values, axis=0), np.finfo(float).tiny)
    sizes = steps.max(axis=1)
    chosen = np.argsort(-sizes, kind="stable")[:_MOST_STEPS]
    chosen = chosen[sizes[chosen] > _SEEN]
    at = function.breaks[1:-1][chosen]
    # The side before a step comes first, and an even instant that coincides with it last.
    order = np.argsort(np.concatenate([at, at, even]), kind="stable")
    return (
        np.concatenate([at, at, even])[order],
        np.concatenate([right[:-1][chosen], left[1:][chosen], values])[order],
    )
