"""The box of joint positions that a worst case is sought in, and best-first bisection of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi
from typing import Final

import numpy as np

from puma_septic.errors import InputError
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_array, read_only
from puma_septic.worst_case._polynomials import WIDEST, PosePolynomial

__all__ = ["Region", "acting_joints", "certified_minimum", "checked_region", "random_poses"]

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


# Control values held in memory at once, and boxes halved in one round.
_AT_ONCE: Final = 500_000
_ROUND: Final = 256


def certified_minimum(
    polynomial: PosePolynomial,
    region: Array,
    least: Callable[[Array], Array],
    *,
    goal: float,
    at_most: int,
) -> float:
    """A number that the function is nowhere below within the region; no larger than `goal` by construction.

    Parameters
    ----------
    polynomial : PosePolynomial
    region : ndarray, shape (n_joints, 2)
        rad (m).
    least : callable
        From control values, shape (n, n_control_points, n_quantities), to a lower bound of each box, shape (n,).
    goal : float
        Where to stop: a little less than a value that is attained.
    at_most : int
        Boxes to bound before giving up; the answer then holds all the same, further from the goal.
    """
    boxes = _pieces(polynomial, region)
    bounds = _bounded(polynomial, boxes, least)
    count = len(boxes)
    while count < at_most and polynomial.joints:
        order = np.argsort(bounds)[:_ROUND]
        worst = order[bounds[order] < goal]
        if not len(worst):
            break
        children = _halved(boxes[worst], polynomial.excess(boxes[worst]))
        kept = bounds < goal  # what lies above the goal is settled
        kept[worst] = False
        inherited = np.tile(bounds[worst], 2)
        found = np.maximum(inherited, _bounded(polynomial, children, least))
        boxes = np.concatenate([boxes[kept], children])
        bounds = np.concatenate([bounds[kept], found])
        count += len(children)
    return min(goal, float(bounds.min(initial=np.inf)))


def _pieces(polynomial: PosePolynomial, region: Array) -> Array:
    """The region cut into boxes whose arcs have control points, shape (n, k, 2)."""
    edges = []
    for j, slides in zip(polynomial.joints, polynomial.slides, strict=True):
        low, high = region[j]
        parts = 1 if slides else max(1, int(np.ceil((high - low) / WIDEST - 1e-9)))
        grid = np.linspace(low, high, parts + 1)
        edges.append(np.column_stack([grid[:-1], grid[1:]]))
    if not edges:
        return np.empty((1, 0, 2))
    index = np.indices([len(edge) for edge in edges]).reshape(len(edges), -1)
    return np.stack([edge[i] for edge, i in zip(edges, index, strict=True)], axis=1)


def _bounded(polynomial: PosePolynomial, boxes: Array, least: Callable[[Array], Array]) -> Array:
    size = int(np.prod(polynomial.coefficients.shape))
    step = max(1, _AT_ONCE // size)
    parts = [least(polynomial.control_values(boxes[k : k + step])) for k in range(0, len(boxes), step)]
    return np.concatenate(parts)


def _halved(boxes: Array, excess: Array) -> Array:
    """Both halves of each box, across the joint that blurs it most."""
    rows = np.arange(len(boxes))
    joint = np.argmax(excess, axis=1)
    middle = boxes[rows, joint].mean(axis=1)
    lower, upper = boxes.copy(), boxes.copy()
    lower[rows, joint, 1] = middle
    upper[rows, joint, 0] = middle
    return np.concatenate([lower, upper])
