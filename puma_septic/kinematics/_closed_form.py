"""From poses to the eight branches of an arm that has a closed form: solved, wrapped, verified, polished."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import final

import numpy as np
from numpy.typing import NDArray

from puma_septic.kinematics._chain import chain_to, end_frame
from puma_septic.kinematics._least_squares import SOLVED, levenberg_marquardt
from puma_septic.kinematics._puma_branches import (
    CONFIGURATIONS,
    JOINT_OF_ROW,
    PumaGeometry,
    branches,
    by_joint,
    into_reach,
    puma_geometry,
)
from puma_septic.kinematics._six_axes import SixAxes, six_axes
from puma_septic.kinematics._six_axis_branches import six_axis_branches
from puma_septic.kinematics._wrapping import resting, wrapped
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = [
    "Branches",
    "ClosedForm",
    "closed_form",
    "configurations",
    "is_puma",
    "solve_branches",
    "solve_in_blocks",
    "why_out_of_reach",
]

# A PUMA's lengths, or those of another arm with a closed form.
ClosedForm = PumaGeometry | SixAxes

# Poses of which the wrist centre lies this far out of reach, in m, are taken for rounded ones of the fully
# stretched arm or the closest one.
REACH_TOLERANCE = 1e-10
# A closed-form answer further off than this (m, rad) is polished by Newton steps.
POLISHED = 1e-12
# Branch values (m, 1, 1) below this are called singular: they go with the root of the pose's error, so that
# a pose given to 1e-12 does not tell such a branch from the one that it meets there.
SINGULAR = 1e-6
# Damping of the first Newton step there: what an error of 1e-5 moves a joint near a singularity stays below 5e-3 rad,
# so that no branch jumps to another; and most steps, which few branches need.
POLISH_DAMPING, POLISH_STEPS = 1e-6, 100
# Room (m^2, 1, 1) that rounding may take from branches that meet.
ROUNDED_ROOM = 1e-10
# An arm this far from its pattern (m, rad) is on it, to the rounding of its file's numbers.
ON_PATTERN = 1e-12
# Numbers in a block of memory that is asked for and freed untouched, 16 MB. Until a block of some size has been freed
# once, glibc returns smaller ones to the system each time and faults them in again at the next call: 1,000 poses then
# take 10 ms instead of 3. It is a hint to the allocator for the whole process, which keeps that much at most.
KEPT_NUMBERS = 1 << 21
# Poses solved at once: more would take memory and bring no speed.
BLOCK = 1000


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Branches:
    """All branches for n poses.

    `q` has shape (n, 8, n_joints), `residual` (n, 8), `singular` (n, 8, 3), `distance` out of reach (n,), `exists`
    (n, 8). `is_complete` (n,): whether these are certainly all.
    """

    q: Array
    residual: Array
    singular: NDArray[np.bool_]
    distance: Array
    exists: NDArray[np.bool_]
    is_complete: NDArray[np.bool_]


@lru_cache(maxsize=32)
def closed_form(robot: Robot) -> ClosedForm | None:
    """What the closed form needs of an arm; None where there is none, so that starts have to be tried."""
    chain = chain_to(robot)
    return puma_geometry(chain) or six_axes(chain)


def is_puma(robot: Robot) -> bool:
    """Whether the arm has a PUMA's joints, whatever its lengths: names in Corke's toolbox are for these."""
    return isinstance(closed_form(robot), PumaGeometry)


def has_closed_form(robot: Robot) -> bool:
    """Whether inverse kinematics finds all branches by name, for six revolute joints of a known pattern."""
    return closed_form(robot) is not None


def configurations(form: ClosedForm) -> tuple[str, ...]:
    """Names of the eight branches."""
    return CONFIGURATIONS if isinstance(form, PumaGeometry) else form.configurations


def solve_in_blocks(robot: Robot, form: ClosedForm, target: Array, q_near: Array | None) -> Branches:
    """`solve_branches` for any number of poses, in blocks that keep memory small."""
    n = target.shape[2]
    if n <= BLOCK:
        return solve_branches(robot, form, target, q_near)
    parts = []
    for start in range(0, n, BLOCK):
        piece = slice(start, start + BLOCK)
        near = q_near[piece] if q_near is not None and len(q_near) == n else q_near
        parts.append(solve_branches(robot, form, target[:, :, piece], near))
    return Branches(
        q=np.concatenate([part.q for part in parts]),
        residual=np.concatenate([part.residual for part in parts]),
        singular=np.concatenate([part.singular for part in parts]),
        distance=np.concatenate([part.distance for part in parts]),
        exists=np.concatenate([part.exists for part in parts]),
        is_complete=np.concatenate([part.is_complete for part in parts]),
    )


def solve_branches(robot: Robot, form: ClosedForm, target: Array, q_near: Array | None) -> Branches:
    """Solve for poses of shape (4, 3, n); `q_near` has shape (1, n_joints) or (n, n_joints)."""
    np.empty(KEPT_NUMBERS)
    if isinstance(form, PumaGeometry):
        return _puma_branches(robot, form, target, q_near)
    return _six_axis_branches(robot, form, target, q_near)


def _puma_branches(robot: Robot, geometry: PumaGeometry, target: Array, q_near: Array | None) -> Branches:
    """All eight, or none where the wrist centre is out of reach."""
    columns = chain_to(robot).columns
    wrist = _from_shoulder(geometry, target)
    wrist[3], distance = into_reach(geometry, wrist[3])
    near = None if q_near is None else q_near.T
    rows, singular_distances = branches(geometry, wrist, 0.0 if near is None else near[columns[3]])
    angles = by_joint(wrapped(robot, rows, columns[JOINT_OF_ROW], near))
    residual = _residual(robot, target, angles)
    n = target.shape[2]
    q = np.empty((robot.n_joints, 2, 2, 2, n))
    if len(columns) < robot.n_joints:
        q[...] = resting(robot, near).reshape(robot.n_joints, 1, 1, 1, -1)
    for column, angle in zip(columns, angles, strict=True):
        q[column] = angle
    flat = q.reshape(robot.n_joints, 8, n)
    rough = (residual > POLISHED) & (distance <= REACH_TOLERANCE)
    if rough.any():
        flat[:, rough], residual[rough] = _polished(robot, target, flat, rough)
    singular = np.empty((3, 2, 2, 2, n), dtype=bool)
    for k, value in enumerate(singular_distances):
        singular[k] = value < SINGULAR
    reachable = distance <= REACH_TOLERANCE
    return Branches(
        q=flat.transpose(2, 1, 0),
        residual=residual.T,
        singular=singular.reshape(3, 8, n).transpose(2, 1, 0),
        distance=distance,
        exists=np.broadcast_to(reachable[:, None], (n, 8)),
        is_complete=np.ones(n, dtype=bool),
    )


def _six_axis_branches(robot: Robot, arm: SixAxes, target: Array, q_near: Array | None) -> Branches:
    """Those of the eight that exist, each where its name stands; for the others, the angles that come nearest."""
    columns, n = chain_to(robot).columns, target.shape[2]
    near = None if q_near is None else np.tile(q_near.T, (1, 8 if len(q_near) == n else 1))
    found = six_axis_branches(arm, target, None if q_near is None else q_near.T[columns])
    q = np.empty((robot.n_joints, 8, n))
    if len(columns) < robot.n_joints:
        q[...] = resting(robot, None if q_near is None else q_near.T).reshape(robot.n_joints, 1, -1)
    q[columns] = wrapped(robot, found.q.reshape(6, -1), columns, near).reshape(6, 8, n)
    room = found.room.reshape(3, 8, n)
    slack = ROUNDED_ROOM + arm.doubt[:, None, None]
    possible = (room >= -slack).all(axis=0)
    off = end_frame(chain_to(robot), q) - target[:, :, None]
    residual = np.abs(off).max(axis=(0, 1))
    distance = np.linalg.norm(off[3], axis=0).min(axis=0)
    rough = possible & (residual > POLISHED)
    if rough.any():
        q[:, rough], residual[rough] = _polished(robot, target, q, rough)
    exists = possible & (residual <= SOLVED)
    # A branch that should be there has been found; where two may meet, an arm off its pattern leaves it open.
    doubtful = (possible & ~exists & (room >= slack).all(axis=0)).any(axis=0)
    if arm.deviation > ON_PATTERN:
        doubtful |= (np.abs(room) < slack).any(axis=(0, 1))
    return Branches(
        q=q.transpose(2, 1, 0),
        residual=residual.T,
        singular=(np.abs(room) < SINGULAR**2).transpose(2, 1, 0),
        distance=np.where(exists.any(axis=0), 0.0, distance),
        exists=exists.T,
        is_complete=~doubtful,
    )


def why_out_of_reach(geometry: PumaGeometry, target: Array) -> str:
    """Where the wrist centre of one pose, shape (4, 3, 1), is and where it could be."""
    x, y, z = _from_shoulder(geometry, target)[3, :, 0]
    radius, distance = np.hypot(x, y), np.sqrt(x * x + y * y + z * z)
    if distance > geometry.reach:
        return f"its wrist centre is {distance:.6g} m from the shoulder, the arm reaches {geometry.reach:.6g} m"
    if radius < abs(geometry.d3):
        return (
            f"its wrist centre is {radius:.6g} m from joint 1's axis, the shoulder's offset keeps it at least"
            f" {abs(geometry.d3):.6g} m away"
        )
    return f"its wrist centre is {distance:.6g} m from the shoulder, nearer than the folded arm comes"


def _from_shoulder(geometry: PumaGeometry, target: Array) -> Array:
    """The last joint's frame seen from the shoulder, shape (4, 3, n), for a tool on its target."""
    to_wrist = np.linalg.inv(geometry.end)
    rotation, shoulder = geometry.base[:3, :3], geometry.base[:3, 3]
    frame = (to_wrist.T @ target.reshape(4, -1)).reshape(target.shape)
    frame[3] -= shoulder[:, None]
    return np.asarray(np.matmul(rotation.T, frame))


def _residual(robot: Robot, target: Array, angles: list[Array]) -> Array:
    """Largest entry of ``|T(q) - T|``, shape (8, n), by the chain product over the tree of branches.

    A flipped wrist (q4 + pi, -q5, q6 + pi) is the same rotation as the one that it is flipped from, so that
    one of the two is multiplied out.
    """
    chain = chain_to(robot)
    unflipped = [np.zeros((1, 1, 1))] * robot.n_joints
    for column, angle in zip(chain.columns, angles, strict=True):
        unflipped[column] = angle[:, :, 0]
    off = end_frame(chain, unflipped)
    off -= target[:, :, None, None]
    worst = np.abs(off, out=off).max(axis=(0, 1))
    return np.repeat(worst[:, :, None], 2, axis=2).reshape(8, target.shape[2])


def _polished(robot: Robot, target: Array, q: Array, rough: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Newton steps (with little damping) on the branches marked in `rough`, shape (8, n)."""
    _, pose = np.nonzero(rough)
    better, _ = levenberg_marquardt(
        robot,
        target[:, :, pose],
        q[:, rough].T,
        damping=POLISH_DAMPING,
        converged=0.1 * POLISHED,
        iterations=POLISH_STEPS,
    )
    off = end_frame(chain_to(robot), better.T) - target[:, :, pose]
    return better.T, np.abs(off).reshape(12, -1).max(axis=0)
