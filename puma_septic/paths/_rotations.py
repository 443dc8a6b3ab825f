"""Turns about axes, and the shortest turn between two orientations."""

from __future__ import annotations

import numpy as np

from puma_septic.errors import InputError
from puma_septic.validation import Array

__all__ = ["shortest_turn", "turn_between", "turned"]

# A turn this close to half a turn, in rad, has no axis to nine digits.
_AMBIGUOUS = 1e-7


def turned(axis: Array, angle: Array, vectors: Array) -> Array:
    """Vectors (..., 3) turned about unit axes (..., 3) by angles (...,): Rodrigues' formula."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    along = (axis * vectors).sum(axis=-1)[..., None]
    return np.asarray(c * vectors + s * np.cross(axis, vectors) + (1 - c) * along * axis)


def turn_between(start: Array, end: Array) -> tuple[Array, float]:
    """Unit axis in the world, zeros where there is no turn, and angle in [0, pi] of ``end start^T``."""
    relative = end @ start.T
    twice = np.array(
        [relative[2, 1] - relative[1, 2], relative[0, 2] - relative[2, 0], relative[1, 0] - relative[0, 1]]
    )
    sine = float(np.linalg.norm(twice)) / 2
    # Between -1 and 3; the tangent of both keeps all digits at small angles and at half a turn.
    angle = float(np.arctan2(sine, (np.trace(relative) - 1) / 2))
    return (twice / (2 * sine) if sine > 0 else np.zeros(3)), angle


def shortest_turn(start: Array, end: Array, what: str) -> tuple[Array, float]:
    """`turn_between`, along the geodesic; half a turn, whose axis nothing tells, is refused."""
    axis, angle = turn_between(start, end)
    if angle > np.pi - _AMBIGUOUS:
        raise InputError(
            f"{what}: the orientations are half a turn apart (180 deg), so that the way round is ambiguous: give"
            f" turn_axis, near {_half_turn_axis(start, end)} or its opposite"
        )
    return axis, angle


def about(start: Array, end: Array, axis: Array, what: str) -> tuple[Array, float]:
    """The turn from start to end about the given world axis, angle in (-pi, pi]."""
    unit = axis / np.linalg.norm(axis)
    found, angle = turn_between(start, end)
    if angle > np.pi - _AMBIGUOUS:
        found = _half_turn_axis(start, end)
    if angle > _AMBIGUOUS and np.linalg.norm(np.cross(found, unit)) > 1e-6:
        raise InputError(
            f"{what}: turn_axis = {axis.tolist()} does not turn one orientation into the other; their axis is"
            f" {found.round(6).tolist()}"
        )
    side = 1.0 if found @ unit >= 0 else -1.0
    # The axis that the orientations have, to their own digits, on the side that was given.
    return side * found, side * side * angle if angle <= np.pi - _AMBIGUOUS else angle


def _half_turn_axis(start: Array, end: Array) -> Array:
    """Axis of a half turn: the column of ``R + 1 = 2 n n^T`` that is longest."""
    outer = (end @ start.T + np.eye(3)) / 2
    column = outer[:, int(np.argmax(np.diag(outer)))]
    return np.asarray(column / np.linalg.norm(column))
