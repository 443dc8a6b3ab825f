"""Poses at the door: rigid transforms, and how far two of them are apart."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.kinematics._chain import cross
from puma_septic.validation import Array, checked_array

__all__ = ["checked_poses", "pose_errors"]

# A rotation typed or stored with ten digits passes and is then made orthonormal; one with fewer digits would
# leave it open which pose is meant.
RIGIDITY = 1e-9


def checked_poses(name: str, poses: ArrayLike) -> Array:
    """Return rigid transforms as (4, 3, n): each rotation's three columns and the position, in world
    coordinates.

    A rotation that is orthonormal to 1e-9 is replaced by the nearest one that is so to rounding.

    Raises
    ------
    InputError
        For a wrong shape, a value that is not finite, a last row other than 0 0 0 1, a rotation part that is
        not orthonormal to 1e-9, or a reflection; with the value that is wrong.
    """
    array = checked_array(name, poses, (None, 4, 4))
    frame = np.ascontiguousarray(array[:, :3].transpose(2, 1, 0))
    rotation = frame[:3]
    lengths = (rotation * rotation).sum(axis=1) - 1.0
    angles = (rotation * rotation[[1, 2, 0]]).sum(axis=1)
    defect = max(np.abs(lengths).max(initial=0.0), np.abs(angles).max(initial=0.0))
    determinants = (cross(frame[0], frame[1]) * frame[2]).sum(axis=0)
    last_row = np.abs(array[:, 3] - (0.0, 0.0, 0.0, 1.0)).max(initial=0.0)
    if not (defect <= RIGIDITY and last_row <= RIGIDITY and (determinants > 0.0).all()):
        raise InputError(_first_fault(name, array))
    if defect > 1e-14:
        # One Newton step towards the polar factor: an error of 1e-9 becomes one of 1e-18.
        given = array[:, :3, :3]
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


def _first_fault(name: str, poses: Array) -> str:
    """What is wrong with the first pose that is not rigid."""
    for k, pose in enumerate(poses):
        label = f"{name}[{k}]" if len(poses) > 1 else name
        rotation, last = pose[:3, :3], pose[3]
        if np.abs(last - (0, 0, 0, 1)).max() > RIGIDITY:
            return f"{label}: last row {last.tolist()} of a rigid transform must be [0, 0, 0, 1]"
        defect = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
        determinant = float(np.linalg.det(rotation))
        if defect > RIGIDITY:
            problem = f"R^T R differs from the identity by {defect:.3g} (at most {RIGIDITY:g})"
            return f"{label}: not a rigid transform: {problem}; R = {rotation.tolist()}"
        if determinant < 0.0:
            return f"{label}: not a rigid transform: R is a reflection (det R = {determinant:.6g})"
    return f"{name}: not rigid transforms"
