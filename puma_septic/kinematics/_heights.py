"""How low an arm hangs: the lowest of its joints and its tool."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.kinematics._chain import chain_to, checked_joint_values, frames
from puma_septic.robot import Robot
from puma_septic.validation import Array, read_only

__all__ = ["LowestPoints", "height_parts", "heights", "lowest_points"]

# m; parts this near to the lowest are as low.
_SAME: Final = 1e-9


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
    each = heights(robot, checked_joint_values(robot, "q", q))
    least = each.min(axis=1)
    # Of parts in one place, such as the joints of a wrist, the first, whatever rounding says.
    which = np.argmax(each <= least[:, None] + _SAME, axis=1)
    names = height_parts(robot)
    return LowestPoints(height=least, parts=tuple(names[k] for k in which))


def height_parts(robot: Robot) -> tuple[str, ...]:
    """What `heights` is of: the joints that carry the tool, but for the first, and the tool frame."""
    return (*(robot.joint_names[column] for column in chain_to(robot).columns[1:]), robot.tool)


def heights(robot: Robot, q: Array) -> Array:
    """Heights of `height_parts` above the world's origin, m, shape (n, n_parts), for q of shape (n, n_joints)."""
    chain = chain_to(robot)
    gravity = np.asarray(robot.model.gravity.linear, dtype=float)
    size = float(np.linalg.norm(gravity))
    up = -gravity / size if size else np.array([0.0, 0.0, 1.0])
    rows, frame = [], np.eye(4, 3)[:, :, None]
    for frame in frames(chain, q.T):
        rows.append(up @ np.broadcast_to(frame[3], (3, len(q))))
    tool = np.tensordot(chain.end[:, 3], frame, axes=1)
    return np.column_stack([*rows[1:], up @ np.broadcast_to(tool, (3, len(q)))])
