"""Joints whose phases begin at different times, on common breaks."""

from __future__ import annotations

from math import comb

import numpy as np

from puma_septic.checks import Array
from puma_septic.piecewise import Piecewise

__all__ = ["side_by_side"]

# Phases that begin within this part of the largest time of each other begin together; Piecewise tells times
# apart down to 1e-13.
_SAME_TIME = 4e-13


def side_by_side(starts: Array, powers: Array) -> Piecewise:
    """Joint j follows ``sum_k powers[k, i, j] s^k`` from ``starts[i, j]`` to ``starts[i + 1, j]``, s in [0,
    1].

    Phases of no length are left out.

    Parameters
    ----------
    starts : ndarray, shape (n + 1, n_joints)
        Non-decreasing; all joints begin and end together.
    powers : ndarray, shape (degree + 1, n, n_joints)
    """
    instants = np.unique(starts)
    new = np.append(True, np.diff(instants) > _SAME_TIME * np.abs(instants).max())
    number = np.cumsum(new) - 1
    breaks = instants[new]
    breaks[-1] = instants[-1]
    index = number[np.searchsorted(instants, starts)]
    # The phase of each joint that each interval lies in, and where in it.
    interval = np.arange(len(breaks) - 1)
    phase = np.stack([np.searchsorted(own, interval, side="right") - 1 for own in index.T], axis=1)
    joint = np.arange(starts.shape[1])
    left, right = breaks[index[phase, joint]], breaks[index[phase + 1, joint]]
    return Piecewise.from_power(
        breaks,
        _parts(
            powers[:, phase, joint],
            (breaks[:-1, None] - left) / (right - left),
            np.diff(breaks)[:, None] / (right - left),
        ),
    )


def _parts(powers: Array, offset: Array, ratio: Array) -> Array:
    """Powers of u of ``sum_k powers[k] (offset + ratio u)^k``.

    Unlike resampling, this keeps the digits of a small highest power beside a large constant.
    """
    parts = np.zeros_like(powers)
    for k in range(len(powers)):
        for n in range(k, len(powers)):
            parts[k] += comb(n, k) * powers[n] * offset ** (n - k)
        parts[k] *= ratio**k
    return parts
