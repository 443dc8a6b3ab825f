"""Whether the points of a planned motion are in the unit that they are taken for."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory

__all__ = ["unit_doubts"]

# Two turns of a revolute joint outside its bounds, rad: a plan that misses its bounds misses them by less.
_BEYOND_BOUNDS: Final = 4 * np.pi
# More than three turns, rad, where no bounds are known: what arms with cables inside do not do.
_MOST_TURNED: Final = 20.0


def unit_doubts(robot: Robot, trajectory: Trajectory) -> tuple[str, ...]:
    """Ask whether points far out of a revolute joint's bounds are degrees; the joint farthest out is named.

    Points are judged, not what a profile swings between them. A continuous joint may turn as far as it likes.
    """
    lower, upper = robot.limits.position.T
    least, greatest = trajectory.points.min(axis=0), trajectory.points.max(axis=0)
    reach = np.maximum(greatest, -least)
    outside: NDArray[np.bool_] = (least < lower) | (greatest > upper)
    unbounded = np.isnan(lower) & np.isnan(upper)
    odd: NDArray[np.bool_] = (outside & (reach > _BEYOND_BOUNDS)) | (unbounded & (reach > _MOST_TURNED))
    odd &= ~(robot.is_prismatic | robot.is_continuous)
    if not odd.any():
        return ()
    j = int(np.argmax(np.where(odd, reach, 0.0)))
    bounds = "" if unbounded[j] else f", its bounds are [{lower[j]:.3g}, {upper[j]:.3g}] rad"
    return (
        f"points in degrees? {robot.joint_names[j]} reaches {reach[j]:.4g} rad, {reach[j] / (2 * np.pi):.3g} turns"
        f"{bounds}; {reach[j]:.4g} deg would be {np.radians(reach[j]):.3g} rad, and a"
        " task file takes them as joints_deg",
    )
