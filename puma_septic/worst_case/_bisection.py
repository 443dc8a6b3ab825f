"""The least value of a function over a box, bounded from below by best-first bisection."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from puma_septic.validation import Array
from puma_septic.worst_case._polynomials import WIDEST, PosePolynomial

__all__ = ["certified_minimum"]

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
