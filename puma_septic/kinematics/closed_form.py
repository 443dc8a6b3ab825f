"""From poses to all eight branches of a PUMA: solved, wrapped to the limits, verified, and polished where needed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from puma_septic.checks import Array
from puma_septic.kinematics.chain import chain_to, end_frame
from puma_septic.kinematics.numeric import levenberg_marquardt
from puma_septic.kinematics.puma import PumaGeometry, branches, into_reach
from puma_septic.robot import Robot

__all__ = ["Branches", "solve_branches", "within", "wrapped"]

# Poses of which the wrist centre lies this far out of reach, in m, are taken for rounded ones of the fully stretched
# arm or the closest one.
REACH_TOLERANCE = 1e-10
# A closed-form answer further off than this (m, rad) is polished by Newton steps.
POLISHED = 1e-12
# Branch values (m, 1, 1) below this are called singular: they go with the root of the pose's error, so that a pose
# given to 1e-12 does not tell such a branch from the one that it meets there.
SINGULAR = 1e-6
# Rounding of an angle that stands on its limit, in rad.
LIMIT_SLACK = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Branches:
    """All branches for n poses; `q` (n, 8, 6), `residual` (n, 8), `singular` (n, 8, 3), `distance` (n,) out of reach."""

    q: Array
    residual: Array
    singular: NDArray[np.bool_]
    distance: Array


def solve_branches(robot: Robot, geometry: PumaGeometry, target: Array, q_near: Array | None) -> Branches:
    """Solve for poses of shape (4, 3, n); `q_near` has shape (6,) or (n, 6)."""
    wrist = _from_shoulder(geometry, target)
    wrist[3], distance = into_reach(geometry, wrist[3])
    near = None if q_near is None else np.moveaxis(q_near, -1, 0)
    angles, distances = branches(geometry, wrist, 0.0 if near is None else near[3])
    angles = [wrapped(robot, k, angle, None if near is None else near[k]) for k, angle in enumerate(angles)]
    residual = _residual(robot, target, angles)
    n = target.shape[2]
    q = np.empty((6, 2, 2, 2, n))
    for k, angle in enumerate(angles):
        q[k] = angle
    flat = q.reshape(6, 8, n)
    rough = (residual > POLISHED) & (distance <= REACH_TOLERANCE)
    if rough.any():
        flat[:, rough], residual[rough] = _polished(robot, target, flat, rough)
    singular = np.empty((3, 2, 2, 2, n), dtype=bool)
    for k, value in enumerate(distances):
        singular[k] = value < SINGULAR
    return Branches(
        q=flat.transpose(2, 1, 0),
        residual=residual.T,
        singular=singular.reshape(3, 8, n).transpose(2, 1, 0),
        distance=distance,
    )


def wrapped(robot: Robot, joint: int, angle: Array, near: Array | None) -> Array:
    """The angle plus whole turns: nearest to the middle of the limits, or to `near` if that is within them.

    The turn nearest to the middle is within the limits if any is. An unknown limit has its middle at `near`, or 0.
    """
    low, high = robot.limits.position[joint]
    turn = 2.0 * np.pi
    if np.isnan(low):
        middle = np.zeros(()) if near is None else near
        return angle - turn * np.rint((angle - middle) / turn)
    middle = 0.5 * (low + high)
    central: Array = angle - turn * np.rint((angle - middle) * (1.0 / turn))
    if near is None:
        return central
    close = angle - turn * np.rint((angle - near) / turn)
    return np.where((close >= low) & (close <= high), close, central)


def within(robot: Robot, q: Array) -> NDArray[np.bool_]:
    """Whether all joints are within their limits, shape (...,), for q of shape (..., n_joints); unknown ones pass."""
    low, high = robot.limits.position.T
    outside = (q < low - LIMIT_SLACK) | (q > high + LIMIT_SLACK)
    return ~outside.any(axis=-1)


def _from_shoulder(geometry: PumaGeometry, target: Array) -> Array:
    """The last joint's frame seen from the shoulder, shape (4, 3, n), for a tool on its target."""
    to_wrist = np.linalg.inv(geometry.end)
    rotation, shoulder = geometry.base[:3, :3], geometry.base[:3, 3]
    frame = (to_wrist.T @ target.reshape(4, -1)).reshape(target.shape)
    frame[3] -= shoulder[:, None]
    return np.matmul(rotation.T, frame)


def _residual(robot: Robot, target: Array, angles: list[Array]) -> Array:
    """Largest entry of ``|T(q) - T|``, shape (8, n), by the chain product over the tree of branches.

    A flipped wrist (q4 + pi, -q5, q6 + pi) is the same rotation as the one that it is flipped from, so that one of the
    two is multiplied out.
    """
    unflipped = [angle[:, :, 0] for angle in angles]
    off = end_frame(chain_to(robot), unflipped)
    off -= target[:, :, None, None]
    worst = np.abs(off, out=off).reshape(12, 2, 2, 1, -1).max(axis=0)
    return np.repeat(worst, 2, axis=2).reshape(8, -1)


def _polished(robot: Robot, target: Array, q: Array, rough: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Newton steps (with next to no damping) on the branches marked in `rough`, shape (8, n)."""
    _, pose = np.nonzero(rough)
    better, _ = levenberg_marquardt(robot, target[:, :, pose], q[:, rough].T, iterations=8)
    off = end_frame(chain_to(robot), better.T) - target[:, :, pose]
    return better.T, np.abs(off).reshape(12, -1).max(axis=0)
