"""Which conditions a pose is held to: all six, the position, the position and the tool's axis, or any of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.errors import InputError
from puma_septic.kinematics._chain import cross
from puma_septic.kinematics._poses import pose_errors
from puma_septic.validation import Array, checked_choice

__all__ = ["CONDITIONS", "Conditions", "checked_conditions", "condition_errors", "condition_rows", "told"]

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
    values = tuple(constrain)
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
