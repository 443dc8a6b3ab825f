"""Where the samples of all joints show no motion, whatever a spline makes of them."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from puma_septic.piecewise.directions import REST_TIME
from puma_septic.validation import Array

__all__ = ["find_rests"]

# Samples in REST_TIME that a rest is judged by.
_FEWEST: Final = 8
# Means differ by so many of their standard deviations once in two million normal draws.
_SIGMAS: Final = 5.0
# A rest is so many times as long as a turn may be hidden in the noise.
_LONGER: Final = 2.0
# The range of m normal draws is 2 sqrt(2 log m) standard deviations, give or take.
_GIVE: Final = 2.5


def find_rests(t: Array, q: Array, noise: Array, step: Array) -> NDArray[np.int64]:
    """First and last samples (k, 2) of the spans in which no joint moves beyond its noise, for `REST_TIME` or longer.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Increasing, s.
    q : ndarray, shape (n, n_joints)
    noise, step : ndarray, shape (n_joints,)
        Standard deviation of a sample, and step of the encoder.
    """
    count = int(np.ceil(REST_TIME / np.median(np.diff(t))))
    if not _FEWEST <= count <= len(t):
        return np.empty((0, 2), dtype=np.int64)
    half = count // 2
    # Of the windows of so many samples that begin at each.
    centre = slice(half, half + len(t) - count + 1)
    reach = (maximum_filter1d(q, count, axis=0) - minimum_filter1d(q, count, axis=0))[centre]
    sums = np.concatenate([np.zeros((1, q.shape[1])), np.cumsum(q - q[0], axis=0)])
    means = (sums[half:] - sums[:-half]) / half
    drift = np.abs(means[half : half + len(reach)] - means[: len(reach)])
    rounding = 1e-14 * np.abs(q).max(axis=0)
    spread = 2 * noise * (np.sqrt(2 * np.log(count)) + _GIVE) + step + rounding
    quiet = (reach <= spread) & (drift <= _SIGMAS * noise * np.sqrt(2 / half) + step / 2 + rounding)
    flags = np.concatenate([[False], quiet.all(axis=1), [False]])
    first, last = np.flatnonzero(flags[1:] & ~flags[:-1]), np.flatnonzero(flags[:-1] & ~flags[1:])
    spans = np.column_stack([first, last + count - 2])
    spans = spans[
        t[spans[:, 1]] - t[spans[:, 0]] >= _hidden(means[::half], half * float(np.median(np.diff(t))), spread)
    ]
    allowed = _SIGMAS * noise / np.sqrt(half) + step / 2 + rounding
    steady = [bool((np.ptp(means[a : b - half + 2 : half], axis=0) <= 2 * allowed).all()) for a, b in spans]
    return np.asarray(spans[np.array(steady, dtype=np.bool_)], dtype=np.int64)


def _hidden(means: Array, apart: float, spread: Array) -> float:
    """For how long noise may hide a turn with the motion's largest acceleration, in the joint that shows it best, s.

    It travels by ``a d^2 / 8`` in the time d; the means of samples are `apart` seconds apart.
    """
    if len(means) < 3:
        return np.inf
    acceleration = np.abs(np.diff(means, 2, axis=0)).max(axis=0) / apart**2
    return float(_LONGER * np.sqrt(8 * spread / np.maximum(acceleration, np.finfo(float).tiny)).min())
