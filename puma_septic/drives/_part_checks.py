"""What every part of a drive train is held to when it is made."""

from __future__ import annotations

import reprlib
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.validation import Array, checked_array

__all__ = [
    "ABSOLUTE_ZERO_CELSIUS",
    "BACKWARD_SHARE",
    "NOT_NEGATIVE",
    "POSITIVE",
    "SHARE",
    "check_texts",
    "checked_curve",
    "checked_impacts",
    "checked_map",
    "checked_shares",
    "no_curve",
]

ABSOLUTE_ZERO_CELSIUS: Final = -273.15  # by the definition of the scale

POSITIVE: Final = {"above": 0.0}
NOT_NEGATIVE: Final = {"at_least": 0.0}
SHARE: Final = {"above": 0.0, "at_most": 1.0}
BACKWARD_SHARE: Final = {"at_least": 0.0, "at_most": 1.0}


def check_texts(part: object) -> None:
    for name in ("name", "source"):
        value = getattr(part, name)
        if not isinstance(value, str):
            raise InputError(f"{name}: expected text, got {reprlib.repr(value)}")


def checked_curve(name: str, given: ArrayLike) -> Array:
    """A curve as an array of (speed, torque) rows: speeds from 0 upwards, torques not negative."""
    curve = _rows(name, given)
    if len(curve):
        if len(curve) == 1:
            raise InputError(f"{name}: a curve needs at least two (speed, torque) rows, got {curve.tolist()}")
        if curve[0, 0] != 0:
            raise InputError(f"{name}: the first speed is {curve[0, 0]:g} rad/s; a curve must start at 0 rad/s")
        if not (np.diff(curve[:, 0]) > 0).all():
            raise InputError(f"{name}: speeds {curve[:, 0].tolist()} rad/s must increase strictly")
        if not ((curve[:, 1] >= 0).all() and curve[0, 1] > 0):
            raise InputError(f"{name}: torques {curve[:, 1].tolist()} N m must be >= 0, the first one > 0")
    return curve


def checked_shares(name: str, given: ArrayLike, *, unit: str, at_most: float = 1.0) -> Array:
    """A curve as an array of rows (place, share): places from 0 upwards, shares above 0."""
    curve = _rows(name, given)
    if len(curve):
        if not ((np.diff(curve[:, 0]) > 0).all() and curve[0, 0] >= 0):
            raise InputError(f"{name}: {curve[:, 0].tolist()} {unit} must increase strictly from 0 {unit} or more")
        if not ((curve[:, 1] > 0) & (curve[:, 1] <= at_most)).all():
            raise InputError(f"{name}: shares {curve[:, 1].tolist()} must be above 0 and at most {at_most:g}")
    return curve


def checked_impacts(given: ArrayLike) -> Array:
    """A curve as an array of rows (cycles per hour, factor): both rise, and the factor is at least 1."""
    curve = _rows("impact_curve", given)
    if len(curve) and not ((np.diff(curve, axis=0) >= 0).all() and (np.diff(curve[:, 0]) > 0).all()):
        raise InputError(f"impact_curve: rows {curve.tolist()} must rise")
    if len(curve) and not (curve[0, 0] >= 0 and curve[0, 1] >= 1):
        raise InputError(
            f"impact_curve: the first row {curve[0].tolist()} must have 0 cycles or more and a factor >= 1"
        )
    return curve


def checked_map(given: ArrayLike) -> Array:
    """A map as an array of rows (speed, torque, efficiency), sorted: a full grid of at least two torques."""
    is_empty = isinstance(given, Sequence) and not given
    rows = checked_array("efficiency_map", np.empty((0, 3)) if is_empty else given, (None, 3))
    if not len(rows):
        return rows
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    speeds, torques = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    grid = np.stack(np.meshgrid(speeds, torques, indexing="ij"), axis=-1).reshape(-1, 2)
    if len(torques) < 2 or len(grid) != len(rows) or (grid != rows[:, :2]).any():
        raise InputError(
            "efficiency_map: expected one row for each speed with each of at least two torques, got"
            f" {len(rows)} rows for {len(speeds)} speeds and {len(torques)} torques"
        )
    if not (speeds[0] >= 0 and torques[0] > 0 and (rows[:, 2] > 0).all() and (rows[:, 2] <= 1).all()):
        raise InputError("efficiency_map: speeds must be >= 0, torques above 0, efficiencies above 0 and at most 1")
    return rows


def _rows(name: str, given: ArrayLike) -> Array:
    is_empty = isinstance(given, Sequence) and not given
    return checked_array(name, np.empty((0, 2)) if is_empty else given, (None, 2))


def no_curve() -> Array:
    return np.empty((0, 2))
