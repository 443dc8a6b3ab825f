"""Poses at the door: rigid transforms, how far two are apart, and which conditions a pose is held to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.errors import InputError
from puma_septic.kinematics._chain import cross
from puma_septic.validation import Array, checked_array, checked_choice, checked_list

__all__ = [
    "CONDITIONS",
    "RIGIDITY",
    "Conditions",
    "checked_conditions",
    "checked_poses",
    "condition_errors",
    "condition_rows",
    "pose_errors",
    "told",
]

# Position along, and turn about, the target's own x, y and z axes.
Conditions = tuple[bool, bool, bool, bool, bool, bool]
CONDITIONS: Final[dict[str, Conditions]] = {
    "pose": (True,) * 6,
    "position": (True, True, True, False, False, False),
    "axis": (True, True, True, True, True, False),
}
_X, _Y = np.eye(3)[:2, :, None]
_NAMES: Final = ("x", "y", "z", "turn about x", "turn about y", "turn about z")


def checked_conditions(constrain: str | Sequence[bool]) -> Conditions:
    """The six conditions that a word or six truth values stand for.

    Raises
    ------
    InputError
        For an unknown word, anything but six truth values, or none of them true.
    """
    if isinstance(constrain, str):
        return CONDITIONS[checked_choice("constrain", constrain, CONDITIONS)]
    values = checked_list("constrain", constrain)
    if len(values) != 6 or not all(isinstance(value, (bool, np.bool_)) for value in values) or not any(values):
        raise InputError(
            f"constrain: expected {', '.join(map(repr, CONDITIONS))}, or six truth values, at least one of them True,"
            f" for {', '.join(_NAMES)} (the target's axes); got {constrain!r}"
        )
    x, y, z, about_x, about_y, about_z = map(bool, values)
    return x, y, z, about_x, about_y, about_z


def told(conditions: Conditions) -> str:
    """The conditions in words."""
    return ", ".join(name for name, holds in zip(_NAMES, conditions, strict=True) if holds)


def condition_errors(target: Array, frame: Array, conditions: Conditions) -> Array:
    """What is left of the conditions, shape (n, k): m and rad, in world axes for a full pose, else in the target's."""
    errors = pose_errors(target, frame)
    if all(conditions):
        return errors
    free = [axis for axis in range(3) if not conditions[3 + axis]]
    if len(free) == 1:
        # Only where one axis points counts: the shortest turn that brings it there, however far about it the tool is.
        errors[:, 3:] = _shortest_turn(frame[free[0]], target[free[0]])
    return condition_rows(target, errors[:, :, None], conditions)[:, :, 0]


def condition_rows(target: Array, columns: Array, conditions: Conditions) -> Array:
    """Linear over angular columns, shape (n, 6, m) in world axes, as the conditions' rows, shape (n, k, m)."""
    if all(conditions):
        return columns
    into = np.ascontiguousarray(target[:3].transpose(2, 0, 1))
    rows = np.concatenate((into @ columns[:, :3], into @ columns[:, 3:]), axis=1)
    return np.asarray(rows[:, np.flatnonzero(conditions)])


def _shortest_turn(start: Array, end: Array) -> NDArray[np.float64]:
    """Rotation vectors, shape (n, 3), between directions of shape (3, n)."""
    across = cross(start, end)
    sine, cosine = np.linalg.norm(across, axis=0), (start * end).sum(axis=0)
    angle = np.arctan2(sine, cosine)
    # Opposite directions: any axis at right angles will do.
    other = cross(start, np.where(np.abs(start[0]) < 0.7, _X, _Y))
    axis = np.where(sine > 1e-12, across / np.maximum(sine, 1e-12), other / np.linalg.norm(other, axis=0))
    return np.asarray((axis * angle).T)


# A rotation typed or stored with ten digits passes and is then made orthonormal; one with fewer digits leaves it open
# which pose is meant, so that how few are accepted is the caller's to say.
RIGIDITY = 1e-9
# R^T R of a rotation with two decimals is off by at most this: three products of 0.005, twice.
_FEW_DECIMALS = 0.03
# Of one Newton step towards the polar factor: an error of 1e-9 becomes one of 1e-18. Further off it is computed.
_ONE_STEP = 1e-8


def checked_poses(name: str, poses: ArrayLike, *, tolerance: float = RIGIDITY) -> Array:
    """Return rigid transforms as (4, 3, n): each rotation's three columns and the position, in world
    coordinates.

    A rotation that is orthonormal to the tolerance is replaced by the nearest one that is so to rounding: its polar
    factor.

    Raises
    ------
    InputError
        For a wrong shape, a value that is not finite, a last row other than 0 0 0 1, a rotation part that is
        not orthonormal to the tolerance, or a reflection; with the value that is wrong.
    """
    array = checked_array(name, poses, (None, 4, 4))
    frame = np.ascontiguousarray(array[:, :3].transpose(2, 1, 0))
    rotation = frame[:3]
    if not (np.abs(rotation) <= 2.0).all():  # beyond any tolerance, and products of them may overflow
        raise InputError(_first_fault(name, array, tolerance))
    lengths = (rotation * rotation).sum(axis=1) - 1.0
    angles = (rotation * rotation[[1, 2, 0]]).sum(axis=1)
    defect = max(np.abs(lengths).max(initial=0.0), np.abs(angles).max(initial=0.0))
    determinants = (cross(frame[0], frame[1]) * frame[2]).sum(axis=0)
    last_row = np.abs(array[:, 3] - (0.0, 0.0, 0.0, 1.0)).max(initial=0.0)
    if not (defect <= tolerance and last_row <= RIGIDITY and (determinants > 0.0).all()):
        raise InputError(_first_fault(name, array, tolerance))
    given = array[:, :3, :3]
    if defect > _ONE_STEP:
        left, _, right = np.linalg.svd(given)
        frame[:3] = (left @ right).transpose(2, 1, 0)
    elif defect > 1e-14:
        improved = 1.5 * given - 0.5 * given @ (given.transpose(0, 2, 1) @ given)
        frame[:3] = improved.transpose(2, 1, 0)
    return frame


def pose_errors(target: Array, frame: Array) -> Array:
    """What turns and moves a frame onto its target, shape (n, 6): m over rad, in world axes.

    Both have shape (4, 3, n); the last three are the rotation vector (axis times angle) of ``R_target R^T``.
    """
    relative = np.einsum("kin,kjn->nij", target[:3], frame[:3])
    twice = np.stack(
        (
            relative[:, 2, 1] - relative[:, 1, 2],
            relative[:, 0, 2] - relative[:, 2, 0],
            relative[:, 1, 0] - relative[:, 0, 1],
        ),
        axis=1,
    )
    sine = 0.5 * np.linalg.norm(twice, axis=1)
    angle = np.arctan2(sine, 0.5 * (np.trace(relative, axis1=1, axis2=2) - 1.0))
    # At half a turn the axis is lost; the length stays pi, so that it is never taken for an answer.
    scale = np.where(sine > 1e-12, 0.5 * angle / np.maximum(sine, 1e-12), 0.5)
    turn = twice * scale[:, None]
    turn[(sine <= 1e-12) & (angle > 1.0)] = (np.pi, 0.0, 0.0)
    return np.concatenate(((target[3] - frame[3]).T, turn), axis=1)


def _first_fault(name: str, poses: Array, tolerance: float) -> str:
    """What is wrong with the first pose that is not rigid."""
    for k, pose in enumerate(poses):
        label = f"{name}[{k}]" if len(poses) > 1 else name
        rotation, last = pose[:3, :3], pose[3]
        if np.abs(last - (0, 0, 0, 1)).max() > RIGIDITY:
            return f"{label}: last row {last.tolist()} of a rigid transform must be [0, 0, 0, 1]"
        defect = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
        determinant = float(np.linalg.det(rotation))
        if defect > tolerance:
            problem = f"R^T R differs from the identity by {defect:.3g} (at most {tolerance:g})"
            return f"{label}: not a rigid transform: {problem}; R = {rotation.tolist()}{_remedy(defect, determinant)}"
        if determinant < 0.0:
            return f"{label}: not a rigid transform: R is a reflection (det R = {determinant:.6g})"
    return f"{name}: not rigid transforms"


def _remedy(defect: float, determinant: float) -> str:
    """What to do where a rotation has merely been written down with few decimals."""
    if determinant < 0.0 or defect > _FEW_DECIMALS:
        return ""
    return f"; if it was copied with few decimals, tolerance={2 * defect:.0e} takes the nearest rotation"
