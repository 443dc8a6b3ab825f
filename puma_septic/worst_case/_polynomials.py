"""Polynomials in the cosines and sines of joint angles, and their hull over a box of poses.

What gravity and inertia ask of a joint is such a polynomial, of degree 1 (gravity) or 2 (inertia) in
``(cos q_k, sin q_k)`` of each joint, in ``q_k`` itself where the joint slides.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import product
from math import pi
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.errors import ModelError
from puma_septic.validation import Array

__all__ = ["WIDEST", "PosePolynomial", "fitted"]

WIDEST: Final = 2 * pi / 3
"""rad; an arc is held by its control points where it is shorter than pi: here they stay within twice its radius."""

# Of the largest value: a fit that misses fresh poses by more is of something that is no such polynomial.
_MISFIT: Final = 1e-8
# Of the sum of all quantities: joints that add no more are left out, and their share is added to the bound.
_NEGLIGIBLE: Final = 2e-4
# The same of whole quantities, such as the Coriolis torque of two wrist joints at a shoulder.
_NEGLIGIBLE_QUANTITIES: Final = 1e-3
# 3^12 poses are half a million, a second or so.
_LARGEST: Final = 600_000


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PosePolynomial:
    """Several quantities as one polynomial of the pose.

    Attributes
    ----------
    joints : tuple of int, length k
        The joints that it depends on.
    slides : tuple of bool, length k
    quantities : tuple of int, length n
        Those that it is of; the others are a part of the remainder alone.
    coefficients : ndarray, shape (n, d_1, ..., d_k)
        For 1, cos q, sin q, cos 2q, sin 2q of a joint that turns, for 1, x, x^2 of one that slides, as far as its
        degree goes.
    remainder : ndarray, shape (n_quantities,)
        What joints and quantities that are left out can add to a magnitude; of all quantities.
    """

    joints: tuple[int, ...]
    slides: tuple[bool, ...]
    quantities: tuple[int, ...]
    coefficients: Array
    remainder: Array

    @property
    def sizes(self) -> tuple[int, ...]:
        """Number of control points along each joint: as many as coefficients."""
        return tuple(self.coefficients.shape[1:])

    def control_values(self, boxes: Array) -> Array:
        """Values whose convex hull holds those of every pose of each box, without the remainder.

        Parameters
        ----------
        boxes : ndarray, shape (n, k, 2)
            Bounds by joint of `joints`, rad (m); an arc shorter than pi.

        Returns
        -------
        ndarray, shape (n, n_control_points, len(quantities))
            An arc is a rational Bezier curve with positive weights, on which a polynomial of degree d is one of
            degree 2d, a convex combination of its control values (Farin, Curves and Surfaces for CAGD, 5th ed.,
            section 13); with several joints, of the products.
        """
        count = len(boxes)
        values = np.broadcast_to(self.coefficients, (count, *self.coefficients.shape))
        for k in reversed(range(len(self.joints))):
            matrix = _control_matrix(boxes[:, k], self.sizes[k], self.slides[k])
            rows = values.reshape(count, -1, self.sizes[k]) @ matrix.transpose(0, 2, 1)
            # The control points go to the front, so that the next joint's coefficients come last.
            values = rows.transpose(0, 2, 1).reshape(count, -1)
        return values.reshape(count, -1, self.coefficients.shape[0])

    def excess(self, boxes: Array) -> Array:
        """How far the control values may lie off the values because of each joint, shape (n, k): where to bisect."""
        sizes = np.abs(self.coefficients).sum(axis=0)
        shares = np.array(
            [np.take(sizes, range(1, size), axis=k).sum() for k, size in enumerate(self.sizes)]
        )  # what is constant along a joint is no reason to halve it
        width = boxes[:, :, 1] - boxes[:, :, 0]
        turning = 1 - np.cos(0.5 * width)
        sliding = np.where(np.array(self.sizes) > 2, width**2, 0.0)
        return np.asarray(shares * np.where(self.slides, sliding, turning))


def fitted(
    function: Callable[[Array], Array],
    region: Array,
    slides: Sequence[bool],
    *,
    degrees: Sequence[int],
    scale: float,
) -> PosePolynomial:
    """The polynomial that a function of the pose is.

    Parameters
    ----------
    function : callable
        Of q, shape (n, n_joints); returns shape (n, n_quantities), all in one unit.
    region : ndarray, shape (n_joints, 2)
        Where a prismatic joint is sampled.
    slides : sequence of bool, length n_joints
    degrees : sequence of int, length n_joints
        0, 1 or 2 of each joint; 0 where nothing depends on it.
    scale : float
        Largest value of the whole arm; what is rounding is measured by it.

    Raises
    ------
    ModelError
        If the function is no such polynomial, as with joints that follow others, or has too many coefficients.
    """
    joints = [j for j, degree in enumerate(degrees) if degree]
    nodes = [_nodes(region[j], degrees[j], slides[j]) for j in joints]
    sizes = [len(node) for node in nodes]
    if np.prod(sizes, dtype=float) > _LARGEST:
        raise ModelError(f"no certified bound: {len(joints)} joints act together, more than can be bounded at once")
    q = np.repeat(np.mean(region, axis=1)[None], int(np.prod(sizes)), axis=0)
    q[:, joints] = np.array(list(product(*nodes))).reshape(-1, len(joints))
    values = function(q)
    tensor = values.T.reshape(-1, *sizes)
    for axis, (j, node) in enumerate(zip(joints, nodes, strict=True), start=1):
        inverse = np.linalg.inv(_basis(node, len(node), slides[j]))
        tensor = np.moveaxis(np.tensordot(inverse, tensor, axes=(1, axis)), 0, axis)
    _check_fit(function, region, slides, (joints, tensor, scale))
    return _reduced(joints, slides, tensor, region)


def _nodes(bounds: Array, degree: int, slides: bool) -> Array:
    if slides:
        return np.asarray(np.linspace(bounds[0], bounds[1], degree + 1), dtype=np.float64)
    return np.arange(2.0 * degree + 1) * (2 * pi / (2 * degree + 1))


def _basis(x: Array, size: int, slides: bool) -> Array:
    """Values of the basis, shape (n, size)."""
    if slides:
        powers: Array = x[:, None] ** np.arange(size)
        return powers
    columns = [np.ones(len(x)), np.cos(x), np.sin(x), np.cos(2 * x), np.sin(2 * x)]
    return np.asarray(np.stack(columns[:size], axis=-1), dtype=np.float64)


def _check_fit(
    function: Callable[[Array], Array], region: Array, slides: Sequence[bool], fit: tuple[list[int], Array, float]
) -> None:
    joints, tensor, scale = fit
    q = np.random.default_rng(0).uniform(region[:, 0], region[:, 1], (16, len(region)))
    expected = function(q)
    for row, value in zip(q, expected, strict=True):
        got = tensor
        for j, size in zip(reversed(joints), reversed(tensor.shape[1:]), strict=True):
            got = got @ _basis(row[j : j + 1], size, slides[j])[0]
        if not (np.abs(got - value) <= _MISFIT * max(scale, float(np.abs(expected).max()))).all():
            raise ModelError("no certified bound: the torques are no polynomial of the joints' cosines and sines")


def _reduced(joints: list[int], slides: Sequence[bool], tensor: Array, region: Array) -> PosePolynomial:
    """Without quantities, joints and degrees that add next to nothing; what they could add is the remainder."""
    largest = [
        np.abs(_basis(np.abs(region[j]), size, True)).max(axis=0) if slides[j] else np.ones(size)
        for j, size in zip(joints, tensor.shape[1:], strict=True)
    ]
    remainder, chosen = _chosen(np.abs(tensor) * reduce(np.multiply.outer, largest, np.ones(())))
    tensor = tensor[chosen]
    kept = list(joints)
    for j in joints:
        axis = 1 + kept.index(j)
        for size in (1, 2 if slides[j] else 3):
            weight: Array = reduce(np.multiply.outer, [largest[joints.index(k)] for k in kept])
            sizes = np.abs(tensor) * weight
            cut = np.take(sizes, range(min(size, tensor.shape[axis]), tensor.shape[axis]), axis=axis)
            share = cut.reshape(len(tensor), -1).sum(axis=1)
            # Each of n joints may add a share of what is allowed, so that together they stay below it.
            if (share <= _NEGLIGIBLE / len(joints) * sizes.sum()).all():
                tensor = np.take(tensor, range(min(size, tensor.shape[axis])), axis=axis)
                largest[joints.index(j)] = largest[joints.index(j)][: tensor.shape[axis]]
                remainder[chosen] += share
                break
        if tensor.shape[axis] == 1:
            tensor = np.squeeze(tensor, axis)
            kept.remove(j)
    return PosePolynomial(
        joints=tuple(kept),
        slides=tuple(bool(slides[j]) for j in kept),
        quantities=tuple(chosen.tolist()),
        coefficients=tensor,
        remainder=remainder,
    )


def _chosen(sizes: Array) -> tuple[Array, NDArray[np.int64]]:
    """What the quantities add that are left out, 0 for the others, and which are kept: at least the largest."""
    totals = sizes.reshape(len(sizes), -1).sum(axis=1)
    order = np.argsort(totals, kind="stable")
    is_small = np.cumsum(totals[order]) <= _NEGLIGIBLE_QUANTITIES * totals.sum()
    dropped = order[:-1][is_small[:-1]]
    remainder = np.zeros(len(totals))
    remainder[dropped] = totals[dropped]
    return remainder, np.setdiff1d(np.arange(len(totals)), dropped)


def _control_matrix(bounds: Array, size: int, slides: bool) -> Array:
    """From coefficients to control values of each interval, shape (n, size, size)."""
    low, high = bounds[:, 0], bounds[:, 1]
    if slides:
        one = np.ones_like(low)
        rows = [[one, low, low**2], [one, high, high**2]]
        if size == 3:
            rows.insert(1, [one, 0.5 * (low + high), low * high])
        return np.array([row[:size] for row in rows]).transpose(2, 0, 1)
    middle, weight = 0.5 * (low + high), np.cos(0.5 * (high - low))
    ends = [_basis(low, size, slides), _basis(high, size, slides)]
    centre = _basis(middle, size, slides)
    apex = centre / weight[:, None]
    apex[:, 0] = 1.0
    if size == 3:
        return np.stack([ends[0], apex, ends[1]], axis=1)
    return np.stack([ends[0], *_inner_rows(low, high, middle, weight), ends[1]], axis=1)


def _inner_rows(low: Array, high: Array, middle: Array, weight: Array) -> list[Array]:
    """The three inner control points of a polynomial of degree 2 on an arc, from its polar form.

    With vertices P0, P1 (where the tangents of the ends meet), P2 and weight w, the quartic's inner control values are
    f(P0, P1), (2 w^2 f(P1, P1) + f(P0, P2)) / (2 w^2 + 1) and f(P1, P2).
    """

    def polar(a: Array, b: Array, scale_a: Array, scale_b: Array) -> Array:
        both = scale_a * scale_b
        return np.stack(
            [
                np.ones_like(a),
                0.5 * (np.cos(a) * scale_a + np.cos(b) * scale_b),
                0.5 * (np.sin(a) * scale_a + np.sin(b) * scale_b),
                np.cos(a + b) * both,
                np.sin(a + b) * both,
            ],
            axis=-1,
        )

    one, far = np.ones_like(low), 1 / weight
    square = 2 * (weight**2)[:, None]
    inner = (square * polar(middle, middle, far, far) + polar(low, high, one, one)) / (square + 1)
    return [polar(low, middle, one, far), inner, polar(middle, high, far, one)]
