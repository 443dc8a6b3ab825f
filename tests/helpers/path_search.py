"""Whether an arm can follow a path at all, by small steps of Newton's method: no series, no branches."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import puma_septic as ps
from puma_septic.kinematics import pose_errors
from puma_septic.validation import Array

# A way ends where steps of this part of the path still do not do: the arm would turn without bound.
_SMALLEST = 2.0**-26
_LARGEST = 1.0 / 256
# Of one step, in rad; more may be another branch.
_TURN = 0.05
_ON_PATH = 1e-10


class Way(NamedTuple):
    """How far a posture was led, as a part of the path, and the least and greatest position of each joint."""

    reached: float
    least: Array
    greatest: Array


def led(robot: ps.Robot, path: ps.paths.Path, q: Array) -> Way:
    """The posture led along the path, the least change of all joints at each step."""
    share, step, least, greatest = 0.0, _LARGEST, q.copy(), q.copy()
    while share < 1.0:
        ahead = min(share + step, 1.0)
        moved = _corrected(robot, path.frames(ahead * path.length), q)
        if moved is None or np.abs(moved - q).max() > _TURN:
            step /= 2
            if step < _SMALLEST:
                break
            continue
        share, q, step = ahead, moved, min(2 * step, _LARGEST)
        least, greatest = np.minimum(least, q), np.maximum(greatest, q)
    return Way(share, least, greatest)


def fits(robot: ps.Robot, way: Way) -> bool:
    """Whether whole turns bring all of the way within the limits, to the slack that the package allows."""
    low, high = robot.limits.position.T
    turns = np.ceil((low - 1e-9 - way.least) / (2 * np.pi))
    unbounded = np.isnan(low)
    inside = way.greatest + 2 * np.pi * turns <= high + 1e-9
    return bool((unbounded | inside).all())


def _corrected(robot: ps.Robot, pose: Array, q: Array) -> Array | None:
    for _ in range(12):
        frames = [one[None, :3].transpose(2, 1, 0) for one in (pose, ps.forward_kinematics(robot, q))]
        error = pose_errors(*frames)[0]
        if np.abs(error).max() <= _ON_PATH:
            return q
        jacobian = ps.jacobian(robot, q)
        change, _, rank, _ = np.linalg.lstsq(jacobian, error, rcond=1e-13)
        if rank < 6 or not np.abs(change).max() < 0.5:
            return None
        q = q + change
    return None
