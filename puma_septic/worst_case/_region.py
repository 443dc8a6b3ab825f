"""The box of joint positions that a worst case is sought in."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi

import numpy as np

from puma_septic.errors import InputError
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_array, read_only

__all__ = ["Region", "acting_joints", "checked_region", "random_poses"]

Region = Mapping[str, tuple[float, float]]


def checked_region(robot: Robot, region: Region | None) -> Array:
    """Bounds of each joint, shape (n_joints, 2): those of `region`, the position limits of the joints that it lacks.

    A joint that turns and has no limits can be anywhere on its circle; more than a full turn is a full turn.

    Raises
    ------
    InputError
        For an unknown joint, bounds that are not in order, and a prismatic joint without bounds.
    """
    bounds = np.array(robot.limits.position)
    free = np.isnan(bounds).any(axis=1) & ~robot.is_prismatic
    bounds[free] = (-pi, pi)
    for name, given in (region or {}).items():
        low, high = checked_array(f"region[{name!r}]", given, (2,))
        if not low <= high:
            raise InputError(f"region[{name!r}] = [{low:g}, {high:g}]: the lower bound comes first")
        bounds[robot.joint_index(name)] = low, high
    unknown = [name for name, row in zip(robot.joint_names, bounds, strict=True) if np.isnan(row).any()]
    if unknown:
        names = ", ".join(map(repr, unknown))
        raise InputError(f"region: joint {names} slides and has no position limits; give its bounds in m")
    wide = ~robot.is_prismatic & (bounds[:, 1] - bounds[:, 0] > 2 * pi)
    middle = bounds[wide].mean(axis=1)
    bounds[wide] = np.column_stack([middle - pi, middle + pi])
    return read_only(bounds)


def random_poses(bounds: Array, count: int) -> Array:
    """Seeded poses of the box, shape (count, n_joints)."""
    return np.random.default_rng(560).uniform(bounds[:, 0], bounds[:, 1], (count, len(bounds)))


def acting_joints(robot: Robot, joint: int) -> set[int]:
    """The joints that the torque of a joint depends on: those that carry it, itself, and those that it carries."""
    model = robot.model
    index = model.getJointId(robot.joint_names[joint])
    names = {model.names[k] for k in (*model.supports[index], *model.subtrees[index]) if k}
    return {k for k, name in enumerate(robot.joint_names) if name in names}
