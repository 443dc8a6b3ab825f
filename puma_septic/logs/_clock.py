"""Clocks: stamps that start anywhere, in any unit, with few digits."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from typing import Final

import numpy as np

from puma_septic.validation import Array

__all__ = ["even_stamps", "exact_stamps", "near_origin"]

# An origin that is further off than this many durations costs digits that the motion needs: at 1e3, 3 s sampled at
# 8 kHz keep eight digits of each step.
_FAR: Final = 1e3
# Fewer stamps than this fall on an even grid by chance.
_FEWEST: Final = 10
# A step of the even grid has at least this many units of the last digit; else any stamps would do.
_FINEST: Final = 2.0
# Stamps that are off by less of a step are even already.
_EVEN: Final = 1e-9


def exact_stamps(cells: Sequence[str], factor: float) -> tuple[Array, Decimal, float]:
    """Times since the first stamp in s, that stamp as it is written, and what one unit of the last digit is in s.

    Stamps since 1970 have more digits than a float holds: the difference is taken before they are rounded.

    Parameters
    ----------
    cells : sequence of str
        Finite numbers.
    factor : float
        Seconds in the unit of the stamps.

    Examples
    --------
    >>> exact_stamps(["1700000000.123456789", "1700000000.123456790"], 1.0)
    (array([0.e+00, 1.e-09]), Decimal('1700000000.123456789'), 1e-09)
    """
    stamps = [Decimal(cell) for cell in cells]
    first = stamps[0]
    since = np.array([float(stamp - first) for stamp in stamps])
    last_digit = min(int(stamp.as_tuple().exponent) for stamp in stamps)
    return since * factor, first, 10.0**last_digit * factor


def near_origin(first: float, duration: float) -> float:
    """What times are counted from: the clock's own zero where that is near, else the first stamp.

    Returns
    -------
    float
        The time of the first stamp, s: `first`, or 0 where that is more than 1,000 durations off.
    """
    return first if abs(first) <= _FAR * duration else 0.0


def even_stamps(t: Array, resolution: float) -> Array:
    """Evenly spaced times, where the stamps deviate from such by no more than their resolution; else `t` itself.

    Rows that are missing leave gaps on the same grid.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Increasing, s.
    resolution : float
        One unit of the last digit of a stamp, s.
    """
    if len(t) < _FEWEST:
        return t
    steps = np.diff(t)
    # The mean is the step unless rows are missing; then it is the usual one, if the digits resolve it.
    for step in (float(steps.mean()), float(np.median(steps))):
        even = _on_grid(t, step)
        # Cut or rounded digits are within one unit, whatever the grid's phase; the fitted grid is off by a little.
        if even is not None and np.ptp(t - even) <= 1.5 * resolution and steps.min() >= _FINEST * resolution:
            even += t[0] - even[0]
            return t if np.abs(t - even).max() <= _EVEN * step else even
    return t


def _on_grid(t: Array, step: float) -> Array | None:
    """The stamps at whole multiples of a step near the given one; None where two would share one."""
    for _ in range(2):
        count = np.round((t - t[0]) / step)
        if (np.diff(count) < 1).any():
            return None
        step, start = np.polyfit(count, t, 1)
    return np.asarray(start + step * count)
