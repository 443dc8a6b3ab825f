"""Poses at the door: rigid transforms, and how far two of them are apart."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.checks import Array, checked_array
from puma_septic.errors import InputError

__all__ = ["checked_poses", "pose_errors"]

# A rotation typed or stored with ten digits passes and is then made orthonormal; one with fewer digits would leave
# it open which pose is meant.
RIGIDITY = 1e-9


def checked_poses(name: str, poses: ArrayLike) -> Array:
    """Return rigid transforms as (4, 3, n): each rotation's three columns and the position, in world coordinates.

    A rotation that is orthonormal to 1e-9 is replaced by the nearest one that is so to rounding.

    Raises
    ------
    InputError
        For a wrong shape, a value that is not finite, a last row other than 0 0 0 1, a rotation part that is not
        orthonormal to 1e-9, or a reflection; with the value that is wrong.
    """
    array = checked_array(name, poses, (None, 4, 4))
    frame = np.ascontiguousarray(array[:, :3].transpose(2, 1, 0))
    x, y, z, _ = frame
    defects = np.stack(
        (
            _dot(x, x) - 1.0,
            _dot(y, y) - 1.0,
            _dot(z, z) - 1.0,
            _dot(x, y),
            _dot(y, z),
            _dot(z, x),
            x[1] * y[2] - x[2] * y[1] - z[0],
        )
    )
    defect = np.abs(defects).max(axis=0, initial=0.0)
    proper = (defect <= RIGIDITY) & (np.abs(array[:, 3] - (0, 0, 0, 1)).max(axis=1, initial=0.0) <= RIGIDITY)
    if not proper.all():
        k = int(np.argmin(proper))
        raise InputError(f"{name}{f'[{k}]' if len(array) > 1 else ''}: {_why_not_rigid(array[k])}")
    if defect.max(initial=0.0) > 1e-14:
        rotation = array[:, :3, :3]
        # One Newton step towards the polar factor: an error of 1e-9 becomes one of 1e-18.
        rotation = 1.5 * rotation - 0.5 * rotation @ (rotation.transpose(0, 2, 1) @ rotation)
        frame[:3] = rotation.transpose(2, 1, 0)
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


def _dot(a: Array, b: Array) -> Array:
    product: Array = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


def _why_not_rigid(pose: Array) -> str:
    if np.abs(pose[3] - (0, 0, 0, 1)).max() > RIGIDITY:
        return f"last row {pose[3].tolist()} of a rigid transform must be [0, 0, 0, 1]"
    rotation = pose[:3, :3]
    defect = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
    if defect > RIGIDITY:
        return (
            f"not a rigid transform: R^T R differs from the identity by {defect:.3g} (at most {RIGIDITY:g});"
            f" R = {rotation.tolist()}"
        )
    return f"not a rigid transform: det R = {np.linalg.det(rotation):.6g} is a reflection; R = {rotation.tolist()}"
