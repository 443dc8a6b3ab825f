"""The eight closed-form branches of an arm of `six_axes`, for many poses at once, by Paden-Kahan subproblems."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.kinematics._chain import cos_sin, cross
from puma_septic.kinematics._six_axes import SixAxes
from puma_septic.validation import Array

__all__ = [
    "six_axis_branches",
]


def _dot(a: Array, b: Array) -> Array:
    """Scalar product along the first axis."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def _turned(axis: Array, angle: Array, vector: Array) -> Array:
    """The vector turned about the axis (Rodrigues): ``c v + s (k x v) + (1 - c) (k . v) k``."""
    vector = _fitted(vector, angle)
    c, s = cos_sin(angle)
    across = cross(_fitted(axis, angle), vector)
    return np.asarray(c * vector + s * across + (1.0 - c) * _dot(axis, vector) * _fitted(axis, angle))


def _angle_from_to(axis: Array, start: Array, end: Array) -> Array:
    """Subproblem 1: the angle about the axis from one vector to another, seen along the axis.

    Both are first taken across the axis: what remains of vectors close to it would drown in the digits of a difference.
    """
    across, beside = (cross(_fitted(axis, vector[0]), vector) for vector in (start, end))
    return np.asarray(np.arctan2(_dot(across, end), _dot(across, beside)))


def _angles_at_height(
    axis: Array, direction: Array, start: Array, height: Array, doubt: float = 0.0
) -> tuple[Array, Array, Array]:
    r"""Subproblem 4: the angles at which the vector, turned about the axis, has this height along a direction.

    :math:`d \cdot R(k, \theta)\, p = h` has the answers ``centre + opening`` and ``centre - opening``. At the first
    one the height falls with the angle: :math:`d \cdot (k \times R p) \le 0`.

    Parameters
    ----------
    doubt : float
        Error of the room. An opening that it may close or open is given as wide as it may be, so that Newton steps
        from both answers end at two if there are two.

    Returns
    -------
    centre, opening : ndarray
        rad. For a height out of reach the opening is 0 or half a turn: the angle that comes nearest.
    room : ndarray
        ``(sin(opening) l)^2`` with l the length of the vector across the axis, times that of the direction; negative
        where there is no answer.
    """
    along = _dot(direction, axis) * _dot(axis, start)
    cosine = _dot(direction, start) - along
    sine = _dot(direction, cross(_fitted(axis, start[0]), start))
    length = np.hypot(cosine, sine)
    rest = height - along
    room = (length - rest) * (length + rest)
    opening = np.arctan2(np.sqrt(np.where(np.abs(room) < doubt, doubt, np.maximum(room, 0.0))), rest)
    return np.arctan2(sine, cosine), opening, np.asarray(room)


def _fitted(vector: Array, like: Array) -> Array:
    """A constant vector, shape (3,), with as many axes as what it meets."""
    return vector.reshape(3, *(1,) * np.ndim(like)) if vector.ndim == 1 else vector


# Below this square of sin(wrist), the pose says nothing about the free joint that is more than rounding: where axis 5
# is at right angles to 4 and 6, and elsewhere, where the sine is a difference of numbers of order one.
_FREE_RIGHT: Final = 1e-24
_FREE: Final = 1e-15
_RIGHT: Final = 1e-12
_FIRST: Final = np.array([1.0, -1.0])
_ARM, _ELBOW, _WRIST = _FIRST.reshape(2, 1, 1, 1), _FIRST.reshape(1, 2, 1, 1), _FIRST.reshape(1, 1, 2, 1)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _SixAxisBranches:
    """Joint angles, shape (6, 2, 2, 2, n), not yet wrapped, and the room at shoulder, elbow and wrist, (3, 2, 2, 2, n).

    Room is 0 where two branches meet, and negative where the pose has neither of them and the angles are the ones that
    come nearest. At the shoulder it is the square of the wrist centre's way ahead of axis 1 (m^2), at the elbow and the
    wrist the squared sine of their angle.
    """

    q: Array
    room: Array


def six_axis_branches(arm: SixAxes, target: Array, q_near: Array | None) -> _SixAxisBranches:
    """Solve for the tool's poses, shape (4, 3, n); `q_near`, (6, 1) or (6, n), is for a joint left free."""
    motion = (arm.undo.T @ target.reshape(4, -1)).reshape(target.shape)
    near = np.zeros((6, 1)) if q_near is None else q_near
    solve = _spherical if arm.kind == "spherical wrist" else _parallel
    angles, rooms = solve(arm, motion, near)
    shape = (2, 2, 2, target.shape[2])
    return _SixAxisBranches(
        q=np.stack([np.broadcast_to(angle, shape) for angle in angles]),
        room=np.stack([np.broadcast_to(room, shape) for room in rooms]),
    )


def _spherical(arm: SixAxes, motion: Array, near: Array) -> tuple[list[Array], list[Array]]:
    """Joints 1 to 3 bring the wrist centre to its place; joints 4 to 6 turn what is left to turn."""
    _, normal, _, h4, h5, h6 = arm.axes
    q1, placed, at_shoulder = _first_joint(arm, motion)
    q2, q3, at_elbow = _elbow(arm, placed)
    swing = q2 + (arm.axes[2] @ normal) * q3

    def left(vector: Array) -> Array:
        """What the wrist has to make of a vector."""
        return _turned(normal, -swing, _after_first(arm, q1, motion, vector))

    ahead = left(h6)
    q5, at_wrist, free = _wrist(arm, h4, ahead, 1.0)
    q4 = np.where(free, near[3], _angle_from_to(h4, _turned(h5, q5, h6), ahead))
    beside = _perpendicular(h6)
    q6 = _angle_from_to(h6, beside, _turned(h5, -q5, _turned(h4, -q4, left(beside))))
    return [q1, q2, q3, q4, q5, q6], [at_shoulder, at_elbow, at_wrist]


def _parallel(arm: SixAxes, motion: Array, near: Array) -> tuple[list[Array], list[Array]]:
    """Joint 1 sets the wrist centre's distance along axis 2; then joint 5, the sum of 2 to 4, 6, and the triangle."""
    _, normal, _, h4, h5, h6 = arm.axes
    third, fourth = arm.axes[2] @ normal, h4 @ normal
    q1, placed, at_shoulder = _first_joint(arm, motion)
    ahead = _after_first(arm, q1, motion, h6)
    q5, at_wrist, free = _wrist(arm, normal, ahead, float(fourth))
    total = _angle_from_to(normal, _turned(h5, q5, h6), ahead)
    beside = _perpendicular(h6)
    q6 = _angle_from_to(h6, beside, _turned(h5, -q5, _turned(normal, -total, _after_first(arm, q1, motion, beside))))
    if free.any():  # axes 4 and 6 are parallel: joint 6 stays near, and the sum follows
        q6, across = np.where(free, near[5], q6), _perpendicular(normal)
        unturned = _turned(h6, -q6, _turned(h5, -q5, across))
        total = np.where(free, _angle_from_to(normal, across, _after_first(arm, q1, motion, unturned)), total)
    q2, q3, at_elbow = _elbow(arm, placed - _turned(normal, total, arm.hand))
    return [q1, q2, q3, fourth * (total - q2 - third * q3), q5, q6], [at_shoulder, at_elbow, at_wrist]


def _first_joint(arm: SixAxes, motion: Array) -> tuple[Array, Array, Array]:
    """Joint 1, the wrist centre from the shoulder as it is before joint 1 turns, and the room."""
    h1, normal = arm.axes[:2]
    centre = motion[3] + np.tensordot(arm.centre, motion[:3], axes=1) - arm.base[:, None]
    centre = centre[:, None, None, None]
    middle, opening, room = _angles_at_height(h1, normal, centre, np.array(arm.offset), arm.doubt[0])
    back = middle + arm.forward * _ARM * opening
    return -back, _turned(h1, back, centre) - arm.shoulder.reshape(3, 1, 1, 1, 1), room


def _after_first(arm: SixAxes, q1: Array, motion: Array, vector: Array) -> Array:
    """What the joints after the first make of a vector: ``R1^T R v``."""
    if vector.ndim == 1:
        moved = np.tensordot(vector, motion[:3], axes=1)[:, None, None, None]
    else:
        moved = sum(vector[k] * motion[k][:, None, None, None] for k in range(3))
    return _turned(arm.axes[0], -q1, moved)


def _elbow(arm: SixAxes, reach: Array) -> tuple[Array, Array, Array]:
    """Joints 2 and 3 for a way from the shoulder, and the room: the triangle of upper arm and forearm."""
    normal, h3 = arm.axes[1:3]
    reach = reach - _dot(normal, reach) * normal.reshape(3, 1, 1, 1, 1)
    height = 0.5 * (_dot(reach, reach) - arm.upper @ arm.upper - arm.fore @ arm.fore)
    size = float(arm.upper @ arm.upper * (arm.fore @ arm.fore))
    fore = arm.fore.reshape(3, 1, 1, 1, 1)
    middle, opening, room = _angles_at_height(h3, arm.upper, fore, height, arm.doubt[1] * size)
    q3 = middle + arm.elbow * (h3 @ normal) * _ARM * _ELBOW * opening
    spread = arm.upper.reshape(3, 1, 1, 1, 1) + _turned(h3, q3, arm.fore)
    return _angle_from_to(normal, spread, reach), q3, room / size


def _wrist(arm: SixAxes, before: Array, ahead: Array, sign: float) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Joint 5, which sets the angle between axes 4 and 6, the room, and whether these are in line.

    `before` is axis 4's direction, `ahead` where axis 6 has to point; noflip is ``(h4 x h6) . h5 >= 0``.
    """
    h5, h6 = arm.axes[4:]
    height = _dot(before, ahead)
    middle, opening, room = _angles_at_height(h5, before, h6.reshape(3, 1, 1, 1, 1), height)
    tiny = _FREE
    if max(abs(before @ h5), abs(h5 @ h6)) < _RIGHT:  # the sine itself, which keeps its digits where it is small
        across = cross(before.reshape(3, 1, 1, 1, 1), ahead)
        room, tiny = _dot(across, across), _FREE_RIGHT
        opening = np.arctan2(np.sqrt(room), height)
    return middle + sign * _WRIST * opening, room, np.abs(room) < tiny


def _perpendicular(vector: Array) -> Array:
    """A unit vector at right angles."""
    other = np.eye(3)[np.argmin(np.abs(vector))]
    across = np.cross(vector, other)
    return np.asarray(across / np.linalg.norm(across))
