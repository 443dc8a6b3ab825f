"""Where a recorded motion stops."""

from __future__ import annotations

import numpy as np

from puma_septic.piecewise.directions import REST_TIME
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["stops"]


def stops(trajectory: Trajectory) -> tuple[Array, Array]:
    """Instants (k,) and positions (k, n_joints) of both ends and of the middles of rests of all joints between them.

    Rests shorter than REST_TIME / 2 do not count; what is rest and what slow motion is the trajectory's resolution.
    """
    direction = trajectory.direction
    still = np.concatenate([[False], ~direction.coefficients[0].any(axis=1), [False]])
    starts, ends = np.flatnonzero(still[1:] & ~still[:-1]), np.flatnonzero(~still[1:] & still[:-1])
    spans = np.column_stack([direction.breaks[starts], direction.breaks[ends]])
    first, last = trajectory.breaks[[0, -1]]
    inner = (spans[:, 0] > first) & (spans[:, 1] < last) & (np.diff(spans, axis=1)[:, 0] >= REST_TIME / 2)
    times = np.concatenate([[first], spans[inner].mean(axis=1), [last]])
    return times, trajectory(times)
