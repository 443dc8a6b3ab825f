"""Motions whose samples come with their velocities, as planners give them: a quintic for each step."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import solve_banded

from puma_septic.logs._rests import EndsRule
from puma_septic.profiles import quintic
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array

__all__ = ["has_velocities", "through_slopes"]

# Velocities that differ by this part of the joint's largest are one: splines through a hundred samples miss less.
_SAME: Final = 1e-6


def has_velocities(fitted: Trajectory, v: Array) -> bool:
    """Whether a trajectory has these velocities at its times, but for what a spline through many samples misses."""
    return bool((np.abs(fitted(fitted.times, 1) - v) <= _SAME * np.abs(v).max(axis=0)).all())


def through_slopes(alone: Trajectory, v: Array, a: ArrayLike | None, ends: EndsRule) -> Trajectory:
    """Quintics through positions, velocities and, where given, accelerations; it moves at its ends where v says so."""
    q = alone.points
    accelerations = _smooth_jerk(alone.times, q, v) if a is None else checked_array("a", a, q.shape)
    still = np.abs(v[[0, -1]]) <= _SAME * np.abs(v).max(axis=0)
    rests = {"auto": still.all(axis=1), "rest": (True, True), "moving": (False, False)}[ends]
    return Trajectory(
        position=quintic(q, alone.times, velocities=v, accelerations=accelerations).position,
        points=q,
        times=alone.times,
        profile="fit_trajectory",
        joint_names=alone.joint_names,
        rest_before=bool(rests[0]),
        rest_after=bool(rests[1]),
    )


def _smooth_jerk(t: Array, q: Array, v: Array) -> Array:
    """The accelerations that make the jerk of quintics through q and v continuous; zero at both ends.

    On a step of T with slope m = (q1 - q0)/T, the quintic's jerk at its start is
    ``(60 m - 36 v0 - 24 v1)/T^2 - (9 a0 - 3 a1)/T`` and at its end
    ``(60 m - 24 v0 - 36 v1)/T^2 - (3 a0 - 9 a1)/T``: a tridiagonal system.
    """
    if len(t) == 2:
        return np.zeros_like(q)
    T = np.diff(t)[:, None]
    slope = np.diff(q, axis=0) / T
    start = (60 * slope - 36 * v[:-1] - 24 * v[1:]) / T**2
    end = (60 * slope - 24 * v[:-1] - 36 * v[1:]) / T**2
    bands = np.zeros((3, len(t) - 2))
    bands[1] = 9 * (1 / T[:-1] + 1 / T[1:])[:, 0]
    bands[0, 1:] = bands[2, :-1] = -3 / T[1:-1, 0]
    rest = np.zeros((1, q.shape[1]))
    return np.concatenate([rest, solve_banded((1, 1), bands, start[1:] - end[:-1]), rest])
