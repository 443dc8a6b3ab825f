"""Forward kinematics, Jacobian, the motion of the tool, and how low the arm hangs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.kinematics._chain import chain_to, checked_joint_values, cross, end_frame, frames
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_kind, n_dimensions, read_only

__all__ = [
    "LowestPoints",
    "ToolMotion",
    "forward_kinematics",
    "height_parts",
    "heights",
    "jacobian",
    "lowest_points",
    "tool_derivatives",
    "tool_motion",
]

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


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ToolMotion:
    """How the tool moves, in world axes; each array has shape (3,) or (n, 3), like the joint values given.

    Attributes
    ----------
    position, velocity, acceleration : ndarray
        Of the tool's origin: m, m/s, m/s^2 (the classical acceleration of that point).
    angular_velocity, angular_acceleration : ndarray
        rad/s, rad/s^2.
    """

    position: Array
    velocity: Array
    acceleration: Array
    angular_velocity: Array
    angular_acceleration: Array


def forward_kinematics(robot: Robot, q: ArrayLike, *, frame: str | None = None) -> Array:
    r"""Pose of the tool, or of another frame, in the world.

    The chain product :math:`T = \prod_k P_k J_k(q_k) \cdot P_{end}` over the joints that carry the frame,
    with constant placements :math:`P` and one rotation about, or shift along, each joint's axis.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (n_joints,) or (n, n_joints)
        Joint positions in rad (m for prismatic joints).
    frame : str, optional
        Name of a frame of the model; the robot's tool by default.

    Returns
    -------
    ndarray, shape (4, 4) or (n, 4, 4)
        T_world_frame, lengths in m.

    Raises
    ------
    InputError
        For a wrong shape, a value that is not finite, or an unknown frame (the valid ones are listed).

    Examples
    --------
    >>> import puma_septic as ps
    >>> ps.forward_kinematics(ps.load_robot(), [0, 0, 0, 0, 0, 0], frame="wrist_center")[:3, 3].round(5)
    array([ 0.4521 , -0.15005,  1.10363])
    """
    values = checked_joint_values(robot, "q", q)
    if frame is not None:
        checked_kind("frame", frame, str)
    columns = end_frame(chain_to(robot, frame), values.T)
    pose = np.zeros((len(values), 4, 4))
    pose[:, :3] = columns.transpose(2, 1, 0)
    pose[:, 3, 3] = 1.0
    return pose if n_dimensions(q) == 2 else pose[0]


def jacobian(robot: Robot, q: ArrayLike) -> Array:
    r"""Jacobian of the tool: linear over angular velocity, in world axes, at the tool's origin.

    Column k is :math:`[z_k \times (p - p_k);\ z_k]` for a revolute joint and :math:`[z_k;\ 0]` for a
    prismatic one; a joint that does not carry the tool has a column of zeros. It is Pinocchio's
    ``LOCAL_WORLD_ALIGNED`` and the Robotics Toolbox's ``jacob0``.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (n_joints,) or (n, n_joints)
        Joint positions in rad (m for prismatic joints).

    Returns
    -------
    ndarray, shape (6, n_joints) or (n, 6, n_joints)
        m/rad over rad/rad (1 over 0 for prismatic joints).

    Raises
    ------
    InputError
        For a wrong shape or a value that is not finite.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot(tool="wrist_center")
    >>> ps.jacobian(robot, [0, 0, 0, 0, 0, 0])[:2, 0].round(5)
    array([0.15005, 0.4521 ])
    """
    values = checked_joint_values(robot, "q", q)
    columns = jacobian_columns(robot, values.T)
    return columns if n_dimensions(q) == 2 else columns[0]


def jacobian_columns(robot: Robot, q: Array) -> Array:
    """The Jacobian, shape (n, 6, n_joints), for joint values already checked, shape (n_joints, n)."""
    return end_and_jacobian(robot, q)[1]


def end_and_jacobian(robot: Robot, q: Array) -> tuple[Array, Array]:
    """The tool's frame, shape (4, 3, n), and the Jacobian, shape (n, 6, n_joints), by one walk along the chain."""
    chain = chain_to(robot)
    each = np.zeros((len(chain.columns), 6, q.shape[1]))
    frame = np.eye(4, 3)[:, :, None]
    for k, frame in enumerate(frames(chain, q)):
        each[k, :3], each[k, 3:] = frame[3], frame[2]
    end = np.broadcast_to((chain.end.T @ frame.reshape(4, -1)).reshape(frame.shape), (4, 3, q.shape[1]))
    origin = end[3]
    for k, slides in enumerate(chain.prismatic):
        linear, axis = each[k, :3], each[k, 3:]
        if slides:
            linear[...], axis[...] = axis, 0.0
        else:
            linear[...] = cross(axis, origin - linear)
    columns = np.zeros((robot.n_joints, 6, q.shape[1]))
    if chain.is_coupled:
        np.add.at(columns, chain.columns, each * np.array(chain.factors)[:, None, None])
    else:
        columns[chain.columns] = each
    return end, np.ascontiguousarray(columns.transpose(2, 1, 0))


def tool_motion(robot: Robot, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> ToolMotion:
    r"""Position, velocity and acceleration of the tool.

    The outward recursion over the joints: with the lever r from one joint's origin to the next,

    .. math:: \dot p \mathrel{+}= \omega \times r,\quad
              \ddot p \mathrel{+}= \dot\omega \times r + \omega \times (\omega \times r)

    and at a revolute joint :math:`\dot\omega \mathrel{+}= z a + \omega \times z v`, then
    :math:`\omega \mathrel{+}= z v` (a prismatic one adds :math:`z a + 2 \omega \times z v` and :math:`z v`
    to the motion of the origin).

    Parameters
    ----------
    robot : Robot
    q, v, a : array_like, shape (n_joints,) or (n, n_joints)
        Joint positions, velocities and accelerations: rad, rad/s, rad/s^2 (m ... for prismatic joints).

    Returns
    -------
    ToolMotion

    Raises
    ------
    InputError
        For shapes that are wrong or differ, or a value that is not finite.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot(tool="wrist_center")
    >>> ps.tool_motion(robot, [0] * 6, [1, 0, 0, 0, 0, 0], [0] * 6).velocity.round(5)
    array([0.15005, 0.4521 , 0.     ])
    """
    values = [checked_joint_values(robot, name, x).T for name, x in (("q", q), ("v", v), ("a", a))]
    if not np.shape(q) == np.shape(v) == np.shape(a):
        raise InputError(f"q, v, a: shapes {np.shape(q)}, {np.shape(v)}, {np.shape(a)} differ")
    position, linear, angular = tool_derivatives(robot, values[0], values[1:])
    moved = [x.T if n_dimensions(q) == 2 else x[:, 0] for x in (position, *linear, *angular)]
    return ToolMotion(
        position=moved[0],
        velocity=moved[1],
        acceleration=moved[2],
        angular_velocity=moved[3],
        angular_acceleration=moved[4],
    )


def tool_derivatives(robot: Robot, q: Array, rates: Sequence[Array]) -> tuple[Array, list[Array], list[Array]]:
    r"""Derivatives of the tool's position and turning, of as many orders as there are rates of the joints.

    With :math:`x^{(k+1)} = \sum_i \binom{k}{i} \omega^{(i)} \times x^{(k-i)}` for every vector x that turns with
    a link, levers and axes, the recursion of `tool_motion` holds for any order: a revolute joint adds
    :math:`(z \dot q)^{(k)}` to the turning, a prismatic one :math:`(z q)^{(k)} - z^{(k)} q` to the motion.

    Parameters
    ----------
    robot : Robot
    q : ndarray, shape (n_joints, n)
    rates : sequence of ndarray
        Velocity, acceleration, jerk and so on of the joints, each of shape (n_joints, n).

    Returns
    -------
    position : ndarray, shape (3, n)
    linear : list of ndarray, each (3, n)
        Velocity, acceleration, ... of the tool's origin, in world axes.
    angular : list of ndarray, each (3, n)
        Angular velocity and its derivatives.
    """
    chain, orders = chain_to(robot), range(len(rates))
    origin, frame = np.zeros((3, q.shape[1])), np.eye(4, 3)[:, :, None]
    linear = [np.zeros((3, q.shape[1])) for _ in orders]
    angular = [np.zeros((3, q.shape[1])) for _ in orders]
    joints = zip(chain.columns, chain.factors, chain.prismatic, frames(chain, q), strict=True)
    for column, factor, slides, frame in joints:
        lever = frame[3] - origin
        origin = origin + lever
        # Lever and axis turn with the same link: together they cost little more than one of them.
        turned = _turning(np.stack([lever, np.broadcast_to(frame[2], lever.shape)], axis=1), angular)
        levers, axis = [both[:, 0] for both in turned], [both[:, 1] for both in turned]
        added = [
            sum(comb(k + slides, i) * axis[i] * (factor * rates[k - i][column]) for i in range(k + 1)) for k in orders
        ]
        for k in orders:
            linear[k] = linear[k] + levers[k + 1] + (added[k] if slides else 0.0)
            angular[k] = angular[k] + (0.0 if slides else added[k])
    lever = np.tensordot(chain.end[:, 3], frame, axes=1) - origin
    levers = _turning(lever, angular)
    return origin + lever, [linear[k] + levers[k + 1] for k in orders], angular


def _turning(vector: Array, angular: Sequence[Array]) -> list[Array]:
    """The vector of a body and its derivatives, one more than there are of the body's turning."""
    derivatives = [np.array(vector)]
    spins = [spin if vector.ndim == 2 else spin[:, None] for spin in angular]
    for k in range(len(angular)):
        total = cross(spins[0], derivatives[k])
        for i in range(1, k + 1):
            term = cross(spins[i], derivatives[k - i])
            total += term if i == k else comb(k, i) * term
        derivatives.append(total)
    return derivatives
