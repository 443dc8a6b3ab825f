"""Planned motions side by side: the intervals of all on one axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from puma_septic.dynamics import smooth_torque
from puma_septic.piecewise import matrices, sign_changes
from puma_septic.piecewise.peaks import Steps
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["FrictionSteps", "Index", "Stack", "fit_torque", "friction_steps", "stacked"]

Index = NDArray[np.int64]
# Nested degrees; what no degree resolves is left to the single assessment, which also bisects.
_DEGREES: Final = (22, 44, 88, 176)
_TOLERANCE: Final = 1e-11
_ROUNDING: Final = 64 * np.finfo(np.float64).eps
# A run between two turns, or a joint, that travels less than this is left to the single assessment: it may be rest, as
# travel below `STILL` is.
_TRAVEL: Final = 2e-9


class Stack(NamedTuple):
    """Intervals of all motions, in order.

    Attributes
    ----------
    state : ndarray, shape (degree + 1, n, 4, n_joints)
        Position, velocity, acceleration and jerk of each interval.
    lengths : ndarray, shape (n,)
        s.
    owner : ndarray of int, shape (n,)
        The motion of each.
    start : ndarray, shape (n,)
        Since the start of its motion, s.
    """

    state: Array
    lengths: Array
    owner: Index
    start: Array

    def of(self, motions: Index) -> tuple[Stack, Index]:
        """Some of the motions, numbered anew, and their intervals."""
        number = np.full(int(self.owner[-1]) + 1, -1)
        number[motions] = np.arange(len(motions))
        some = np.flatnonzero(number[self.owner] >= 0)
        return Stack(self.state[:, some], self.lengths[some], number[self.owner[some]], self.start[some]), some


def stacked(trajectories: Sequence[Trajectory]) -> Stack:
    """All intervals, padded to one degree."""
    degree = max(one.position.degree for one in trajectories)
    offsets = [one.position.offsets for one in trajectories]
    counts = [len(one) - 1 for one in offsets]
    n, m = sum(counts), trajectories[0].n_joints
    series = np.zeros((degree + 1, n, m))
    first = 0
    for one, count in zip(trajectories, counts, strict=True):
        coefficients = one.position.coefficients
        series[: len(coefficients), first : first + count] = coefficients
        first += count
    start, end = (np.concatenate([one[some] for one in offsets]) for some in (slice(-1), slice(1, None)))
    lengths = end - start
    state = (matrices.state_matrix(degree, 3) @ series.reshape(degree + 1, -1)).reshape(4, degree + 1, n, m)
    scale = (2 / lengths) ** np.arange(4)[:, None]
    return Stack(
        state=np.ascontiguousarray((state * scale[:, None, :, None]).transpose(1, 2, 0, 3)),
        lengths=lengths,
        owner=np.repeat(np.arange(len(counts)), counts),
        start=start,
    )


def fit_torque(robot: Robot, stack: Stack, n_motions: int) -> tuple[Array, Index, int]:
    """The smooth torque (degree + 1, n, n_joints), degrees of the motions (0: none resolves one), number of samples."""
    n, m = len(stack.lengths), robot.n_joints
    largest = np.zeros((_DEGREES[-1] + 1, n, m))
    pending, values, used = np.arange(n), np.empty((0, n, m)), 0
    scale, degrees = np.zeros((n_motions, m)), np.zeros(n_motions, dtype=np.int64)
    for degree in _DEGREES:
        every = matrices.nodes(degree)
        new = every if not len(values) else every[1::2]
        sampled = _sampled(robot, stack.state[:, pending, :3], new)
        used += len(new) * len(pending)
        values = sampled if not len(values) else _merged(values, sampled)
        np.maximum.at(scale, stack.owner[pending], np.abs(values).max(axis=0))
        series = matrices.coefficients_from_values(degree) @ values.reshape(degree + 1, -1)
        series = series.reshape(values.shape)
        tail = np.abs(series[-max(2, len(series) // 8) :]).max(axis=0)
        own = scale[stack.owner[pending]]
        small = tail <= np.maximum(_TOLERANCE * own, _ROUNDING * own.max(axis=1, keepdims=True))
        good = small.all(axis=1)
        largest[: degree + 1, pending[good]] = series[:, good]
        np.maximum.at(degrees, stack.owner[pending[good]], degree)
        pending, values = pending[~good], values[:, ~good]
        if not len(pending):
            break
    degrees[stack.owner[pending]] = 0
    return largest, degrees, used


def _merged(coarse: Array, between: Array) -> Array:
    finer = np.empty((len(coarse) + len(between), *coarse.shape[1:]))
    finer[::2], finer[1::2] = coarse, between
    return finer


def _sampled(robot: Robot, state: Array, x: Array) -> Array:
    """Torque at points of some intervals, (points, n, n_joints)."""
    size, n, _, m = state.shape
    values = matrices.basis_at(x, size - 1).T @ state.reshape(size, -1)
    q, v, a = np.moveaxis(values.reshape(len(x) * n, 3, m), 1, 0)
    return smooth_torque(robot, q, v, a).reshape(len(x), n, m)


class FrictionSteps(NamedTuple):
    """Coulomb friction of each interval and joint as a step function; motions for the single assessment."""

    steps: Steps
    odd: NDArray[np.bool_]


def friction_steps(robot: Robot, stack: Stack, n_motions: int) -> FrictionSteps:
    """Columns are interval by interval, then joint."""
    size, n, _, m = stack.state.shape
    position, velocity = (stack.state[:, :, k].reshape(size, -1) for k in (0, 1))
    column, x = sign_changes(velocity)
    order = np.lexsort((x, column))
    column, x = column[order], x[order]
    left = matrices.signs(size - 1) @ position
    right = position.sum(axis=0)
    at = (matrices.basis_at(x, size - 1) * position[:, column]).sum(axis=0)
    # Positions at the ends of all runs, column by column.
    columns = np.concatenate([np.arange(n * m), column, np.arange(n * m)])
    place = np.concatenate([np.full(n * m, -1.0), x, np.ones(n * m)])
    q = np.concatenate([left, at, right])
    order = np.lexsort((place, columns))
    columns, q = columns[order], q[order]
    inside = columns[1:] == columns[:-1]
    travel, run_column = np.diff(q)[inside], columns[1:][inside]
    still = np.abs(position[1:]).sum(axis=0) == 0
    levels = robot.coulomb_friction[run_column % m]
    level = np.where(travel > 0, levels[:, 0], levels[:, 1]) * ~still[run_column]
    odd_run = (np.abs(travel) < _TRAVEL) & ~still[run_column]
    odd = np.zeros(n_motions, dtype=np.bool_)
    odd[stack.owner[run_column[odd_run] // m]] = True
    is_first = np.append(True, run_column[1:] != run_column[:-1])
    return FrictionSteps(
        steps=Steps(first=level[is_first], column=column, x=x, size=np.diff(level)[~is_first[1:]]), odd=odd
    )
