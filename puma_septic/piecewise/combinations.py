"""Peaks and root mean squares of very many linear combinations of the same few functions.

Each combination is a trigonometric polynomial of theta, ``x = cos(theta)``, on each interval. All are evaluated by one
matrix product at the same points, twice as many as the degree; as the second derivative is at most ``sum k^2 |c_k|``,
no value between two points is farther above both than ``step^2 / 8`` times that. Only local maxima that can be the
largest by this bound are climbed, by the Taylor series between two points. A maximum is found where the slope changes
its sign between two points; more than one between them, a quarter of the shortest ripple apart, count as one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import Final, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise._piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["Combinations"]

# Points of an interval over its degree. With a step of pi / (2 degree) the Taylor series of order 13 leaves out less
# than (pi / 4)^14 / 14! of the coefficients, 4e-13.
_OVERSAMPLED: Final = 2
_LEAST_POINTS: Final = 16
_ORDER: Final = 13
# Newton's method within brackets; the value at a maximum is known to the square of the last step.
_MOST_STEPS: Final = 30
_LAST_STEP: Final = 1e-7
# Values that are held at once: 32 MB.
_BLOCK: Final = 1 << 19


class _Rows(NamedTuple):
    """Points at which combinations are evaluated, in order; both sides of each step.

    values, slopes : of each part at each point, by theta, (rows, parts, m).
    taylor : their derivatives over factorials, half-way to the following point, (order + 1, rows, parts, m).
    steps : what is added, (rows, m).
    segment : points of one have nothing between them but smoothness.
    """

    piece: NDArray[np.int64]
    theta: Array
    segment: NDArray[np.int64]
    values: Array
    slopes: Array
    taylor: Array
    steps: Array
    hidden: Array


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Combinations:
    """Functions of m components whose linear combinations are asked for.

    What is computed once for all is kept (the cache needs a ``__dict__``, hence no slots).

    Attributes
    ----------
    parts : sequence of Piecewise
        Smooth between breaks, which they share.
    steps : Piecewise or None
        Constant between its breaks, among which are those of the parts; it is added to each combination.
    """

    parts: Sequence[Piecewise]
    steps: Piecewise | None = None

    @cached_property
    def _series(self) -> Array:
        """All parts, (degree + 1, n, parts, m)."""
        size = max(part.degree for part in self.parts) + 1
        padded = [np.pad(part.coefficients, ((0, size - part.degree - 1), (0, 0), (0, 0))) for part in self.parts]
        return np.stack(padded, axis=2)

    @cached_property
    def _rows(self) -> _Rows:
        series, whole = self._series, self.parts[0]
        pieces = [self._points(i) for i in range(series.shape[1])]
        piece = np.concatenate([np.full(len(theta), i) for i, (theta, *_) in enumerate(pieces)])
        counts = np.cumsum([0, *(int(segment[-1]) + 1 for _, segment, _ in pieces)])
        k = np.arange(len(series))

        def derivative(order: int, theta: Array, i: int) -> Array:
            basis = np.cos(np.multiply.outer(theta, k) + order * np.pi / 2) * (k**order / factorial(order))
            return np.tensordot(basis, series[:, i], axes=(1, 0))

        values, slopes, taylor = [], [], []
        for i, (theta, *_) in enumerate(pieces):
            middles = (theta + np.append(theta[1:], theta[-1])) / 2
            values.append(derivative(0, theta, i))
            slopes.append(derivative(1, theta, i))
            taylor.append(np.stack([derivative(order, middles, i) for order in range(_ORDER + 1)]))
        steps = [levels for *_, levels in pieces]
        widest = [np.abs(np.diff(theta)).max() for theta, *_ in pieces]
        bends = np.tensordot(k**2.0, np.abs(series), axes=(0, 0))
        assert whole.n_components == series.shape[3]
        return _Rows(
            piece=piece,
            theta=np.concatenate([theta for theta, *_ in pieces]),
            segment=np.concatenate([segment + first for (_, segment, _), first in zip(pieces, counts, strict=False)]),
            values=np.concatenate(values),
            slopes=np.concatenate(slopes),
            taylor=np.concatenate(taylor, axis=1),
            steps=np.concatenate(steps),
            hidden=(bends * (np.array(widest) ** 2 / 8)[:, None, None]).max(axis=0),
        )

    def _points(self, i: int) -> tuple[Array, NDArray[np.int64], Array]:
        """Angles of interval i from its start, the segment of each, and the step function there."""
        size = np.abs(self._series[:, i]).max(axis=(1, 2))
        degree = int(np.flatnonzero(size)[-1]) if size.any() else 0
        theta = np.linspace(np.pi, 0.0, max(_OVERSAMPLED * degree, _LEAST_POINTS) + 1)
        m = self.parts[0].n_components
        if self.steps is None:
            return theta, np.zeros(len(theta), dtype=np.int64), np.zeros((len(theta), m))
        left, right = self.parts[0].offsets[i : i + 2]
        inside = (self.steps.offsets > left) & (self.steps.offsets < right)
        cuts = np.arccos(np.clip((2 * self.steps.offsets[inside] - left - right) / (right - left), -1.0, 1.0))
        segment = np.searchsorted(-cuts, -theta, side="right")
        theta = np.concatenate([theta, cuts, cuts])
        segment = np.concatenate([segment, np.arange(len(cuts)), np.arange(len(cuts)) + 1])
        order = np.lexsort((-theta, segment))
        first = int(np.searchsorted(self.steps.offsets, left, side="left"))
        values = self.steps.coefficients[0, first : first + len(cuts) + 1]
        return theta[order], segment[order], values[segment[order]]

    def peaks(self, weights: Array) -> tuple[Array, Array]:
        """Largest magnitude of each combination and its instant, weights (f, parts); each of shape (f, m)."""
        rows, m = self._rows, self.parts[0].n_components
        count = max(1, _BLOCK // (len(rows.theta) * m))
        found = [self._block(weights[k : k + count]) for k in range(0, len(weights), count)]
        peak, piece, theta = (np.concatenate(field) for field in zip(*found, strict=True))
        offsets, x = self.parts[0].offsets, np.cos(theta)
        times = (offsets[piece] * (1 - x) + offsets[piece + 1] * (1 + x)) / 2
        return peak, self.parts[0].start + times

    def _block(self, weights: Array) -> tuple[Array, NDArray[np.int64], Array]:
        rows, (f, m) = self._rows, (len(weights), self.parts[0].n_components)
        values = np.tensordot(rows.values, weights, axes=(1, 1))  # (rows, m, f)
        values += rows.steps[:, :, None]
        size = np.abs(values)
        top = size.argmax(axis=0)
        best = np.take_along_axis(size, top[None], axis=0)[0]
        least = best - (np.abs(weights) @ rows.hidden.reshape(weights.shape[1], -1)).T.reshape(m, f)
        near = size >= least
        row, j, case = self._rising(np.flatnonzero(near[:-1] | near[1:]), values, weights)
        climbed, angle = self._climbed(row, j, case, weights, np.sign(values[row, j, case]))
        row, j, case = (
            np.append(*pair) for pair in ((top, row), (np.indices((m, f))[0], j), (np.indices((m, f))[1], case))
        )
        climbed, angle = np.append(best, climbed), np.append(rows.theta[top], angle)
        order = np.lexsort((climbed, case, j))
        last = np.flatnonzero(np.append((np.diff(j[order]) != 0) | (np.diff(case[order]) != 0), True))
        chosen = order[last]
        shape = (m, f)
        return (
            climbed[chosen].reshape(shape).T,
            rows.piece[row[chosen]].reshape(shape).T,
            angle[chosen].reshape(shape).T,
        )

    def _rising(
        self, cells: NDArray[np.int64], values: Array, weights: Array
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """(row, component, case) of those points, of some, from which the magnitude rises towards the following one, to
        fall before it: there is a maximum between them.
        """
        rows = self._rows
        row, j, case = np.unravel_index(cells, values.shape)
        joined = rows.segment[row + 1] == rows.segment[row]
        row, j, case = row[joined], j[joined], case[joined]
        side, own = np.sign(values[row, j, case]), weights[case]
        # The angle falls from a point to the following one. At both ends of an interval any slope by angle is zero.
        rises = np.einsum("cp,cp->c", rows.slopes[row, :, j], own) * side < 0
        rises |= rows.theta[row] == np.pi
        falls = np.einsum("cp,cp->c", rows.slopes[row + 1, :, j], own) * side > 0
        falls |= rows.theta[row + 1] == 0
        return row[rises & falls], j[rises & falls], case[rises & falls]

    def _climbed(
        self, row: NDArray[np.int64], j: NDArray[np.int64], case: NDArray[np.int64], weights: Array, sign: Array
    ) -> tuple[Array, Array]:
        """The maximum of magnitude between each of some points and the following one, and its angle."""
        rows = self._rows
        series = np.einsum("qcp,cp->qc", rows.taylor[:, row, :, j].transpose(1, 0, 2), weights[case]) * sign
        series[0] += rows.steps[row, j] * sign
        high = (rows.theta[row] - rows.theta[row + 1]) / 2
        low = -high
        delta, near = np.zeros(len(row)), _LAST_STEP * (high - low)
        for _ in range(_MOST_STEPS):
            _, slope, bend = _taylor(series, delta)
            low, high = np.where(slope > 0, delta, low), np.where(slope > 0, high, delta)
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = delta - slope / bend
            inside = (bend < 0) & (newton >= low) & (newton <= high)
            following = np.where(inside, newton, (low + high) / 2)
            moved = np.abs(following - delta)
            delta = following
            if (moved <= near).all():
                break
        return _taylor(series, delta)[0], (rows.theta[row] + rows.theta[row + 1]) / 2 + delta

    @cached_property
    def _gram(self) -> tuple[Array, Array, Array]:
        """Integrals of products of the parts (parts, parts, m), of parts and steps, and of the steps' square."""
        parts = self.parts
        both = np.array([[one.inner(other) for other in parts] for one in parts])
        if self.steps is None:
            m = parts[0].n_components
            return both, np.zeros((len(parts), m)), np.zeros(m)
        return both, np.array([part.inner(self.steps) for part in parts]), self.steps.inner(self.steps)

    def rms(self, weights: Array) -> Array:
        """Root mean square over the span of each combination, shape (f, m)."""
        both, mixed, square = self._gram
        total = np.einsum("fp,pqm,fq->fm", weights, both, weights, optimize=True) + 2 * weights @ mixed + square
        return np.asarray(np.sqrt(np.maximum(total, 0.0) / self.parts[0].duration))


def _taylor(series: Array, delta: Array) -> tuple[Array, Array, Array]:
    """Value, first and second derivative of each column at its own point."""
    value, slope, bend = series[-1], np.zeros_like(delta), np.zeros_like(delta)
    for coefficient in series[-2::-1]:
        bend = bend * delta + 2 * slope
        slope = slope * delta + value
        value = value * delta + coefficient
    return value, slope, bend
