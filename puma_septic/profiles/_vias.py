"""What every profile checks at its door."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.checks import Array, checked_array, checked_times
from puma_septic.errors import InputError

__all__ = ["boundary", "checked_points", "checked_via_times", "joint_labels", "named"]


def checked_points(profile: str, points: ArrayLike, *, at_least: int = 2, exactly: int | None = None) -> Array:
    """Via points (k, n_joints) with as many rows as the profile needs."""
    array = checked_array("points", points, (None, None), unit="rad")
    if array.shape[1] == 0:
        raise InputError("points: at least one joint (column) is needed")
    if exactly is not None and len(array) != exactly:
        raise InputError(f"{profile} needs exactly {exactly} points, got {len(array)}")
    if len(array) < at_least:
        raise InputError(f"{profile} needs at least {at_least} points, got {len(array)}")
    return array


def checked_via_times(times: ArrayLike, points: Array) -> Array:
    """One strictly increasing time for each point, s."""
    array = checked_times("times", times)
    if len(array) != len(points):
        raise InputError(f"times: {len(array)} times for {len(points)} points; one for each is needed")
    return array


def boundary(name: str, value: ArrayLike | None, n_joints: int, unit: str) -> Array:
    """A boundary value per joint: None is zero, a scalar holds for all joints."""
    if value is None:
        return np.zeros(n_joints)
    if np.ndim(value) == 0:
        return np.full(n_joints, float(checked_array(name, value, (), unit=unit)))
    return checked_array(name, value, (n_joints,), unit=unit)


def named(joint_names: Sequence[str] | None) -> tuple[str, ...]:
    """Joint names as a tuple, empty where none are given."""
    if isinstance(joint_names, str):
        raise InputError(f"joint_names: expected one name per joint, got the single string {joint_names!r}")
    return tuple(joint_names or ())


def joint_labels(joint_names: Sequence[str], n_joints: int) -> list[str]:
    """By name, or by number from 1 where there are no names."""
    return [f"joint {name!r}" for name in joint_names] or [f"joint {j + 1}" for j in range(n_joints)]
