"""Holding still where a joint holds most: the stretched arm as a load case."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from puma_septic.cycle import Cycle
from puma_septic.motion import compute_motion
from puma_septic.profiles import quintic_segments
from puma_septic.robot import Robot
from puma_septic.worst_case import worst_holding_torque

__all__ = ["worst_poses"]

# A joint that holds less than this part of the largest torque, as one about an upright axis, has no worst pose.
_HOLDS: Final = 1e-3
_GAP: Final = 0.05


def worst_poses(robot: Robot, duration: float) -> Iterator[tuple[str, Cycle]]:
    """Each joint that gravity loads, and the arm held where that joint holds most within its limits.

    Returns
    -------
    iterator of (str, Cycle)
    """
    worst = worst_holding_torque(robot, gap=_GAP)
    for joint, pose, torque in zip(robot.joint_names, worst.poses, worst.attained, strict=True):
        if torque > _HOLDS * worst.attained.max():
            still = quintic_segments(np.array([pose, pose]), [0.0, duration], joint_names=robot.joint_names)
            yield joint, Cycle(steps=(compute_motion(robot, still),))
