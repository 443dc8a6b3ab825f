"""Whole turns: the same arm posture, but not the same side of a joint limit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["resting", "within", "wrapped"]

TURN = 2.0 * np.pi
# Rounding of a joint position that stands on its limit, in rad or m.
LIMIT_SLACK = 1e-9


def wrapped(robot: Robot, angles: Array, joints: NDArray[np.int64], near: Array | None) -> Array:
    """The angles plus whole turns: nearest to `near` within the limits, or to their middle where it is not given.

    An angle that no number of turns brings within the limits is nearest to their middle. Without limits the middle is
    `near`, or 0.

    Parameters
    ----------
    angles : ndarray, shape (m, n)
    joints : ndarray of int, shape (m,)
        Which joint each row belongs to.
    near : ndarray, shape (n_joints,) or (n_joints, n), optional

    Returns
    -------
    ndarray, shape (m, n)
    """
    low, high = robot.limits.position[joints].T[:, :, None]
    close = None if near is None else near.reshape(len(near), -1)[joints]
    middle = np.where(np.isnan(low + high), 0.0 if close is None else close, 0.5 * (low + high))
    central: Array = angles - TURN * np.rint((angles - middle) * (1.0 / TURN))
    if close is None:
        return central
    # From the turn nearest to where the joint stands, one back into the limits if it is beyond them: the next one is
    # the nearest that may be within them.
    closest = angles - TURN * np.rint((angles - close) * (1.0 / TURN))
    closest = closest - TURN * np.ceil(np.nan_to_num(closest - high - LIMIT_SLACK).clip(min=0.0) * (1.0 / TURN))
    closest = closest + TURN * np.ceil(np.nan_to_num(low - LIMIT_SLACK - closest).clip(min=0.0) * (1.0 / TURN))
    return np.where((closest < low - LIMIT_SLACK) | (closest > high + LIMIT_SLACK), central, closest)


def within(robot: Robot, q: Array) -> NDArray[np.bool_]:
    """Whether all joints are within their limits, shape (...,), for q (..., n_joints); unknown ones pass."""
    low, high = robot.limits.position.T
    outside = (q < low - LIMIT_SLACK) | (q > high + LIMIT_SLACK)
    return np.asarray(~outside.any(axis=-1))


def resting(robot: Robot, near: Array | None) -> Array:
    """Where a joint that does not carry the tool stays: `near`, else mid-range, else 0; (n_joints, ...)."""
    return np.nan_to_num(robot.limits.position.mean(axis=1)) if near is None else near
