"""Joints whose phases begin at different times, on common breaks."""

from __future__ import annotations

from dataclasses import dataclass
from math import comb
from typing import final

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["Phases", "side_by_side"]

# Resolution of time: phases that begin within this part of the duration of each other begin together, and a shorter
# phase is left out. Piecewise tells times apart down to 1e-13 of the duration.
SAME_TIME = 4e-13


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Phases:
    """When each joint's phases begin, on breaks that all joints share.

    A profile computes its phases from `lengths`, which are those that the breaks leave after merging and rounding: what
    is continuous from phase to phase then stays so to the last digit, however short a phase is.

    Attributes
    ----------
    breaks : ndarray, shape (m + 1,)
        Strictly increasing, from 0, s.
    index : ndarray of int, shape (n + 1, n_joints)
        Which break each phase of each joint begins at; the last row is the end.
    """

    breaks: Array
    index: NDArray[np.int64]

    @classmethod
    def from_starts(cls, starts: Array) -> Phases:
        """From nominal times, shape (n + 1, n_joints), non-decreasing; all joints begin at 0 and end together."""
        instants = np.unique(starts)
        new = np.append(True, np.diff(instants) > SAME_TIME * instants[-1])
        breaks = instants[new]
        breaks[-1] = instants[-1]
        number = np.cumsum(new) - 1
        return cls(breaks=breaks, index=number[np.searchsorted(instants, starts)])

    @property
    def starts(self) -> Array:
        """When each phase begins, and the end, shape (n + 1, n_joints), s."""
        return self.breaks[self.index]

    @property
    def lengths(self) -> Array:
        """How long each phase lasts, shape (n, n_joints), s; 0 for one that is shorter than the resolution."""
        return np.diff(self.starts, axis=0)


def side_by_side(phases: Phases, powers: Array) -> Piecewise:
    """Joint j follows ``sum_k powers[k, i, j] s^k`` in its phase i, s from 0 to 1.

    Phases of no length are left out.

    Parameters
    ----------
    phases : Phases
    powers : ndarray, shape (degree + 1, n, n_joints)

    Returns
    -------
    Piecewise
    """
    breaks, index = phases.breaks, phases.index
    # The phase of each joint that each interval lies in, and where in it.
    interval = np.arange(len(breaks) - 1)
    phase = np.stack([np.searchsorted(own, interval, side="right") - 1 for own in index.T], axis=1)
    joint = np.arange(index.shape[1])
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
