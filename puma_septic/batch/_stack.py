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

__all__ = ["LEAST_DEGREE", "Index", "Part", "Runs", "Stack", "fit_torque", "refined", "runs", "stacked"]

Index = NDArray[np.int64]
# Degrees are multiples of this one, whose points are among those of each; what none resolves is left to the single
# assessment, which also bisects.
LEAST_DEGREE: Final = 22
_MULTIPLES: Final = (2, 3, 4, 6, 8)
# The degree at which a series is resolved is about 86 + 9 log10 of its last coefficients at the least one, measured on
# septics of PUMA and Panda through points within 0.3 to 2 rad. Seven eighths of a multiple have to reach that far.
_RESOLVED_BELOW: Final = (-5.5, -3.3, -1.2, 2.0)
_TOLERANCE: Final = 1e-11
# As a motion alone has it: a hundredth of what the torque is fitted to.
_NEGLIGIBLE: Final = 1e-13
# Series are searched with those of the same degree; of few degrees, so that many are searched at once.
_STEP_OF_DEGREES: Final = 16
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


class Part(NamedTuple):
    """Intervals to be sampled at a multiple of the least degree, with their values at a coarser one."""

    multiple: int
    intervals: Index
    coarser: int
    values: Array


def fit_torque(robot: Robot, stack: Stack, n_motions: int) -> tuple[Array, Index, int]:
    """The smooth torque (degree + 1, n, n_joints), degrees of the motions (0: none resolves one), number of samples.

    A motion's degree is that of what is not negligible in its series, of a few common ones.
    """
    n, m = len(stack.lengths), robot.n_joints
    largest = np.zeros((LEAST_DEGREE * _MULTIPLES[-1] + 1, n, m))
    scale, degrees, used = np.zeros((n_motions, m)), np.zeros(n_motions, dtype=np.int64), 0
    unresolved = np.zeros(n_motions, dtype=np.bool_)
    work = [Part(1, np.arange(n), 0, np.empty((0, n, m)))]
    while work:
        part = work.pop()
        owner, values = stack.owner[part.intervals], refined(robot, stack, part)
        used += values[:, :, 0].size - part.values[:, :, 0].size
        np.maximum.at(scale, owner, np.abs(values).max(axis=0))
        series = matrices.coefficients_from_values(len(values) - 1) @ values.reshape(len(values), -1)
        series, own = series.reshape(values.shape), scale[owner]
        own = np.maximum(own, _ROUNDING / _TOLERANCE * own.max(axis=1, keepdims=True))
        excess = np.max(matrices.tail(series) / np.where(own > 0, own, 1.0), axis=1)
        good = excess <= _TOLERANCE
        largest[: len(series), part.intervals[good]] = series[:, good]
        np.maximum.at(degrees, owner[good], _common_degree(series[:, good], _NEGLIGIBLE * own[good]))
        following = _following(part.multiple, excess)
        unresolved[owner[~good & (following == 0)]] = True
        for multiple in np.unique(following[~good & (following > 0)]).tolist():
            some = np.flatnonzero(~good & (following == multiple))
            work.append(Part(multiple, part.intervals[some], part.multiple, values[:, some]))
    return largest, np.where(unresolved, 0, degrees), used


def _following(multiple: int, excess: Array) -> Index:
    """The multiple at which each series is to be resolved, by the last coefficients of this one; 0 for none."""
    if multiple > 1:
        return np.full(len(excess), 2 * multiple if 2 * multiple <= _MULTIPLES[-1] else 0)
    with np.errstate(divide="ignore"):
        return np.asarray(_MULTIPLES)[np.searchsorted(_RESOLVED_BELOW, np.log10(excess))]


def refined(robot: Robot, stack: Stack, part: Part) -> Array:
    """Torque at all points of a part, (degree + 1, n, n_joints): every so many of them are known."""
    points = matrices.nodes(LEAST_DEGREE * part.multiple)
    is_new = np.ones(len(points), dtype=np.bool_)
    if part.coarser:
        is_new[:: part.multiple // part.coarser] = False
    values = np.empty((len(points), *part.values.shape[1:]))
    values[is_new] = _sampled(robot, stack.state[:, part.intervals, :3], points[is_new])
    values[~is_new] = part.values
    return values


def _common_degree(series: Array, negligible: Array) -> Index:
    """Of what is not negligible in each interval's series (degree + 1, n, m), up to the next common degree."""
    kept = np.any(np.abs(series) > negligible, axis=2)
    last = np.where(np.any(kept, axis=0), len(series) - 1 - kept[::-1].argmax(axis=0), 1)
    return np.asarray(np.minimum(-(-last // _STEP_OF_DEGREES) * _STEP_OF_DEGREES, len(series) - 1))


def _sampled(robot: Robot, state: Array, x: Array) -> Array:
    """Torque at points of some intervals, (points, n, n_joints)."""
    size, n, _, m = state.shape
    values = matrices.basis_at(x, size - 1).T @ state.reshape(size, -1)
    q, v, a = np.moveaxis(values.reshape(len(x) * n, 3, m), 1, 0)
    return smooth_torque(robot, q, v, a).reshape(len(x), n, m)


class Runs(NamedTuple):
    """What follows from the runs between two turns of each joint.

    Attributes
    ----------
    friction : Steps
        Coulomb friction as a step function; columns are interval by interval, then joint.
    reach : ndarray, shape (2, n_motions, n_joints)
        Least and greatest positions.
    odd : ndarray of bool, shape (n_motions,)
        Motions for the single assessment.
    """

    friction: Steps
    reach: Array
    odd: NDArray[np.bool_]


def runs(robot: Robot, stack: Stack, n_motions: int) -> Runs:
    """Where the joints turn, and what they reach there."""
    size, n, _, m = stack.state.shape
    position, velocity = (stack.state[:, :, k].reshape(size, -1) for k in (0, 1))
    column, x = sign_changes(velocity[: max(size - 1, 1)])
    order = np.lexsort((x, column))
    column, x = column[order], x[order]
    at = (matrices.basis_at(x, size - 1) * position[:, column]).sum(axis=0)
    # Positions at the ends of all runs, column by column.
    columns = np.arange(n * m)
    place = np.stack([np.searchsorted(column, columns), np.searchsorted(column, columns, side="right")], axis=1)
    both_ends = np.stack([matrices.signs(size - 1) @ position, position.sum(axis=0)], axis=1)
    q = np.insert(at, place.ravel(), both_ends.ravel())
    ends = np.repeat(columns, np.diff(place, axis=1)[:, 0] + 2)
    is_inside = ends[1:] == ends[:-1]
    travel, run_column = np.diff(q)[is_inside], ends[1:][is_inside]
    is_still = np.abs(position[1:]).sum(axis=0)[run_column] == 0
    levels = robot.coulomb_friction[run_column % m]
    level = np.where(travel > 0, levels[:, 0], levels[:, 1]) * ~is_still
    odd = np.zeros(n_motions, dtype=np.bool_)
    odd[stack.owner[run_column[(np.abs(travel) < _TRAVEL) & ~is_still] // m]] = True
    is_first = np.diff(run_column, prepend=-1) != 0
    steps = Steps(first=level[is_first], column=column, x=x, level=level[~is_first])
    return Runs(steps, _reach(q, stack.owner[ends // m] * m + ends % m, n_motions, m), odd)


def _reach(q: Array, group: Index, n_motions: int, m: int) -> Array:
    low, high = np.full((2, n_motions * m), [[np.inf], [-np.inf]])
    np.minimum.at(low, group, q)
    np.maximum.at(high, group, q)
    return np.stack([low, high]).reshape(2, n_motions, m)
