"""How low an arm hangs: the lowest of its joints and its tool."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.kinematics._chain import chain_to, checked_joint_values, frames
from puma_septic.robot import Robot
from puma_septic.validation import Array, read_only

__all__ = ["LowestPoints", "lowest_points"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LowestPoints:
    """The lowest point of an arm in each of n configurations.

    Attributes
    ----------
    height : ndarray, shape (n,)
        Above the world's origin, where the arm stands, against gravity (along z without gravity), m.
    parts : tuple of str, length n
        The joint, or the tool frame, that is lowest.
    """

    height: Array
    parts: tuple[str, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "height", read_only(self.height))


def lowest_points(robot: Robot, q: ArrayLike) -> LowestPoints:
    """How low the origins of the moving joints and the tool are; what is around them may be lower.

    The first joint's origin never moves and does not count, nor do joints that do not carry the tool.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (n_joints,) or (n, n_joints)
        Joint positions in rad (m for prismatic joints).

    Returns
    -------
    LowestPoints

    Raises
    ------
    InputError
        For a wrong shape, or a value that is not finite.

    Examples
    --------
    >>> import puma_septic as ps
    >>> lowest = lowest_points(ps.load_robot(), [0, -0.9, 0, 0, 0, 0])
    >>> lowest.height.round(4).tolist(), lowest.parts
    ([0.3177], ('joint4',))
    """
    values = checked_joint_values(robot, "q", q)
    chain = chain_to(robot)
    gravity = np.asarray(robot.model.gravity.linear, dtype=float)
    size = float(np.linalg.norm(gravity))
    up = -gravity / size if size else np.array([0.0, 0.0, 1.0])
    names, heights, frame = [], [], np.eye(4, 3)[:, :, None]
    for column, frame in zip(chain.columns, frames(chain, values.T), strict=True):
        names.append(robot.joint_names[column])
        heights.append(up @ np.broadcast_to(frame[3], (3, len(values))))
    tool = np.tensordot(chain.end[:, 3], frame, axes=1)
    names, heights = [*names[1:], robot.tool], [*heights[1:], up @ np.broadcast_to(tool, (3, len(values)))]
    which = np.argmin(heights, axis=0)
    return LowestPoints(height=np.min(heights, axis=0), parts=tuple(names[k] for k in which))
