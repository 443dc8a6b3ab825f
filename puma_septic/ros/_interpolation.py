"""What joint_trajectory_controller does between the points of a JointTrajectory, as an exact Trajectory.

Source: ros2_controllers, joint_trajectory_controller/src/trajectory.cpp, ``Trajectory::sample`` and
``interpolate_between_points`` (the same from Humble to 6.9), interpolation_method "splines", the default: between two
points that both have velocities and accelerations a quintic, with velocities alone a cubic, else a straight line.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.ros._faults import Fault
from puma_septic.ros._message import JointState, JointTrajectoryMessage
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_kind

__all__ = ["in_robot_order", "interpolated", "spline_powers", "unwrapped_start"]

_NS = 1e9
# A fixed joint's column may move by this much, rad, and still be a standstill: rounding of what a driver reports.
_STILL = 1e-9


def in_robot_order(
    message: JointTrajectoryMessage, robot: Robot, faults: list[Fault]
) -> tuple[JointTrajectoryMessage, tuple[str, ...]]:
    """The message with the robot's joints in the robot's order, and what to know of the columns left out.

    A joint that the robot holds fixed may be in the message if it stands still there. A joint of the robot that is
    missing, or one that the robot does not have, is a fault.
    """
    notes = []
    fixed = checked_kind("robot", robot, Robot).fixed_joint_names
    for k, name in enumerate(message.joint_names):
        if name in fixed:
            column = message.positions[:, k]
            if np.ptp(column) > _STILL:
                text = f"joint {name!r} is fixed in robot {robot.name!r}, but moves by {np.ptp(column):.4g} here"
                faults.append(Fault(code="unknown_joint", message=text, joint=name))
            notes.append(f"joint {name!r} is fixed in the robot; its column, {column[0]:.4g} throughout, is not used")
        elif name not in robot.joint_names:
            text = f"robot {robot.name!r} has no joint {name!r}; it has {', '.join(robot.joint_names)}"
            faults.append(Fault(code="unknown_joint", message=text, joint=name))
    for name in robot.joint_names:
        if name not in message.joint_names:
            text = f"joint {name!r} of robot {robot.name!r} is missing; a part of the joints is not assessed"
            faults.append(Fault(code="missing_joint", message=text, joint=name))
    order = [message.joint_names.index(name) for name in robot.joint_names if name in message.joint_names]
    ordered = replace(
        message,
        joint_names=tuple(message.joint_names[k] for k in order),
        positions=message.positions[:, order],
        velocities=message.velocities[:, order],
        accelerations=message.accelerations[:, order],
        effort=message.effort[:, order],
    )
    return ordered, tuple(notes)


def unwrapped_start(message: JointTrajectoryMessage, start: JointState, is_continuous: NDArray[np.bool_]) -> Array:
    """Position at which the state `start` leads into the message's first point: of continuous joints the nearest turn.

    `start` must have the message's joints in its order. The controller does this where it wraps angles, as it does for
    continuous joints (``wraparound_joint``).
    """
    turns = np.round((message.positions[0] - start.position) / math.tau)
    return np.asarray(start.position + np.where(is_continuous, turns * math.tau, 0.0))


def interpolated(
    message: JointTrajectoryMessage, start: JointState | None, is_continuous: NDArray[np.bool_]
) -> Trajectory:
    """The motion that the controller makes of a message whose joints are the robot's, in its order.

    Where the first point is later than 0 and a start is given, the motion begins there at 0, with the spline that
    the first point asks for: velocities that the start does not have are 0, accelerations always are, since a
    JointState has none. Without a start it begins at the first point, at its time.

    Parameters
    ----------
    message : JointTrajectoryMessage
    start : JointState or None
        Joints in the message's order.
    is_continuous : ndarray of bool, shape (n_joints,)
        Joints that reach the first point by the nearest turn.

    Returns
    -------
    Trajectory
    """
    bridged, rest_before = message, True
    if start is not None and message.nanoseconds[0] > 0:
        bridged = _bridged(message, start, is_continuous)
        rest_before = not (message.has("velocities")[0] and start.velocity.any())
    lengths = np.diff(bridged.nanoseconds)[:, None] / _NS
    powers = spline_powers(bridged.positions, bridged.velocities, bridged.accelerations, lengths)
    return Trajectory(
        position=Piecewise.from_power(bridged.times, powers),
        points=bridged.positions,
        times=bridged.times,
        profile="joint_trajectory",
        joint_names=message.joint_names,
        rest_before=rest_before,
    )


def _bridged(
    message: JointTrajectoryMessage, start: JointState, is_continuous: NDArray[np.bool_]
) -> JointTrajectoryMessage:
    """The message with the start as its first point, at 0."""
    absent = np.full_like(start.velocity, np.nan)
    velocity = start.velocity if message.has("velocities")[0] else absent
    acceleration = np.zeros_like(absent) if message.has("accelerations")[0] else absent
    return replace(
        message,
        nanoseconds=np.concatenate([[0], message.nanoseconds]),
        positions=np.vstack([unwrapped_start(message, start, is_continuous), message.positions]),
        velocities=np.vstack([velocity, message.velocities]),
        accelerations=np.vstack([acceleration, message.accelerations]),
        effort=np.vstack([absent, message.effort]),
    )


def spline_powers(p: Array, v: Array, a: Array, T: Array) -> Array:
    """What the controller interpolates between points, as coefficients of powers of s = t/T on each interval.

    Parameters
    ----------
    p, v, a : ndarray, shape (n, n_joints)
        Positions, velocities and accelerations; NaN in the rows that do not have them.
    T : ndarray, shape (n - 1, 1)
        Lengths of the intervals, s.

    Returns
    -------
    ndarray, shape (degree + 1, n - 1, n_joints)
    """
    # One NaN in a row is NaN in its sum.
    has_v, has_a = (np.isfinite(x[:-1].sum(axis=1) + x[1:].sum(axis=1)) for x in (v, a))
    h = p[1:] - p[:-1]
    powers = np.zeros((6, *h.shape))
    powers[0], powers[1] = p[:-1], h
    cubic, quintic = np.flatnonzero(has_v & ~has_a), np.flatnonzero(has_v & has_a)
    powers[1:4, cubic] = _cubic(h[cubic], v[cubic] * T[cubic], v[cubic + 1] * T[cubic])
    powers[1:, quintic] = _quintic(
        h[quintic], *(x[i] * T[quintic] ** k for k, x in ((1, v), (2, a)) for i in (quintic, quintic + 1))
    )
    degree = 5 if len(quintic) else 3 if len(cubic) else 1
    return powers[: degree + 1]


def _cubic(h: Array, v0: Array, v1: Array) -> Array:
    """Powers 1 to 3, from the travel and from the end velocities times T."""
    return np.stack([v0, 3 * h - 2 * v0 - v1, -2 * h + v0 + v1])


def _quintic(h: Array, v0: Array, v1: Array, a0: Array, a1: Array) -> Array:
    """Powers 1 to 5; accelerations times T^2."""
    return np.stack(
        [
            v0,
            a0 / 2,
            10 * h - 6 * v0 - 4 * v1 - 1.5 * a0 + a1 / 2,
            -15 * h + 8 * v0 + 7 * v1 + 1.5 * a0 - a1,
            6 * h - 3 * (v0 + v1) - (a0 - a1) / 2,
        ]
    )
