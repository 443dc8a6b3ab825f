"""Peaks and root mean squares of a stack of motions."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from puma_septic.batch._stack import Index, Stack, fit_torque, runs
from puma_septic.piecewise import matrices
from puma_septic.piecewise.peaks import Peaks, Steps, find_peaks, ranges
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["Metrics", "TorqueSpan", "acceleration_steps", "metrics_of", "torque_span"]


# A step below this part of the motion's largest velocity or acceleration is none, from the other on it is one; between
# them the single assessment decides.
_NO_STEP: Final = 1e-10
_STEP: Final = 1e-5


class Metrics(NamedTuple):
    """Of each motion and joint, (n_motions, n_joints), by quantity; times since the start of each motion, s.

    `bounds` are certified; of the position on both sides, (2, n_motions, n_joints).

    `odd` marks motions whose numbers do not hold: they are for the single assessment.
    """

    peaks: dict[str, Array]
    times: dict[str, Array]
    bounds: dict[str, Array]
    rms: dict[str, Array]
    reach: Array
    odd: NDArray[np.bool_]
    n_samples: int


def metrics_of(robot: Robot, stack: Stack, n_motions: int) -> Metrics:
    """Kinematic peaks and those of the torque with Coulomb friction, exactly."""
    m = robot.n_joints
    duration = np.bincount(stack.owner, weights=stack.lengths, minlength=n_motions)
    turned, kinematic = runs(robot, stack, n_motions), _kinematic(stack, n_motions)
    smooth, degrees, n_samples = fit_torque(robot, stack, n_motions)
    torque, torque_times, torque_bound, torque_squares = np.zeros((4, n_motions, m))
    odd = (degrees == 0) | turned.odd
    # Each degree apart: the longest series would make the others as long.
    for degree in np.unique(degrees[~odd]).tolist():
        motions = np.flatnonzero(degrees == degree)
        some, pieces = stack.of(motions)
        found = _torque(some, len(motions), smooth[: degree + 1, pieces], _of(turned.friction, pieces, m))
        for target, values in zip((torque, torque_times, torque_bound, torque_squares), found, strict=True):
            target[motions] = values
    peaks = {name: one.size.reshape(-1, m) for name, one in kinematic.items()}
    times = {name: _times(one, stack, m) for name, one in kinematic.items()}
    limits = {name: one.bound.reshape(-1, m) for name, one in kinematic.items()}
    squares = {name: _squares(stack.state[:, :, k], stack, n_motions) for k, name in enumerate(kinematic, start=1)}
    squares["effort"] = torque_squares
    unclear, when = acceleration_steps(stack, n_motions, peaks["velocity"], peaks["acceleration"])
    stepped = np.isfinite(when)
    # A step of the acceleration makes the jerk infinite.
    peaks["jerk"][stepped], squares["jerk"][stepped], times["jerk"][stepped] = np.inf, np.inf, when[stepped]
    odd |= unclear
    return Metrics(
        peaks=peaks | {"effort": torque},
        times=times | {"effort": torque_times},
        bounds=limits | {"effort": torque_bound, "position": _swing(stack, n_motions)},
        rms={name: np.sqrt(np.maximum(total, 0.0) / duration[:, None]) for name, total in squares.items()},
        reach=turned.reach,
        odd=odd,
        n_samples=n_samples,
    )


class TorqueSpan(NamedTuple):
    """Of each motion and joint: least and greatest torque, (2, n_motions, n_joints), and its root mean square."""

    ends: Array
    rms: Array
    odd: NDArray[np.bool_]


def torque_span(robot: Robot, stack: Stack, n_motions: int) -> TorqueSpan:
    """The torque on both sides of zero, as an optimiser needs it; `odd` as of `Metrics`."""
    m = robot.n_joints
    turned = runs(robot, stack, n_motions)
    smooth, degrees, _ = fit_torque(robot, stack, n_motions)
    ends, squares = np.zeros((2, n_motions, m)), np.zeros((n_motions, m))
    for degree in np.unique(degrees[degrees > 0]).tolist():
        motions = np.flatnonzero(degrees == degree)
        some, pieces = stack.of(motions)
        series, friction = smooth[: degree + 1, pieces].reshape(degree + 1, -1), _of(turned.friction, pieces, m)
        # Beyond what any joint takes in magnitude, the largest magnitude is the greatest value.
        beyond = 2 * float(np.abs(series).sum(axis=0).max() + np.abs(robot.coulomb_friction).max())
        for side, sign in enumerate((-1.0, 1.0)):
            shifted = sign * series
            shifted[0] += beyond
            steps = Steps(
                first=sign * friction.first, column=friction.column, x=friction.x, level=sign * friction.level
            )
            found = find_peaks(shifted, _groups(some, m), len(motions) * m, steps)
            ends[side, motions] = sign * (found.size.reshape(-1, m) - beyond)
        squares[motions] = _torque_squares(series, friction, some, len(motions), m)
    duration = np.bincount(stack.owner, weights=stack.lengths, minlength=n_motions)
    return TorqueSpan(ends, np.sqrt(np.maximum(squares, 0.0) / duration[:, None]), (degrees == 0) | turned.odd)


def _of(steps: Steps, pieces: Index, m: int) -> Steps:
    """The steps of some intervals, numbered anew."""
    columns = (pieces[:, None] * m + np.arange(m)).ravel()
    number = np.full(len(steps.first), -1)
    number[columns] = np.arange(len(columns))
    some = np.flatnonzero(number[steps.column] >= 0)
    return Steps(
        first=steps.first[columns], column=number[steps.column[some]], x=steps.x[some], level=steps.level[some]
    )


def _torque(stack: Stack, n_motions: int, smooth: Array, friction: Steps) -> tuple[Array, ...]:
    """Peak, time, bound and the integral of the square from the smooth torque (degree + 1, n, n_joints)."""
    m = smooth.shape[2]
    series = smooth.reshape(len(smooth), -1)
    found = find_peaks(series, _groups(stack, m), n_motions * m, friction)
    return (
        found.size.reshape(-1, m),
        _times(found, stack, m),
        found.bound.reshape(-1, m),
        _torque_squares(series, friction, stack, n_motions, m),
    )


def _groups(stack: Stack, m: int) -> Index:
    return (stack.owner[:, None] * m + np.arange(m)).ravel()


def _kinematic(stack: Stack, n_motions: int) -> dict[str, Peaks]:
    """Peaks of velocity, acceleration and jerk."""
    size, n, _, m = stack.state.shape
    series = stack.state[: max(size - 1, 1), :, 1:].transpose(0, 2, 1, 3).reshape(max(size - 1, 1), -1)
    count = n_motions * m
    groups = (_groups(stack, m) + np.arange(0, 3 * count, count)[:, None]).ravel()
    found = find_peaks(series, groups, 3 * count)
    return {name: _part(found, k, count, n * m) for k, name in enumerate(("velocity", "acceleration", "jerk"))}


def _swing(stack: Stack, n_motions: int) -> Array:
    """Certified bounds of the positions on both sides."""
    size, n, _, m = stack.state.shape
    outer = ranges(stack.state[:, :, 0].reshape(size, -1))[1].reshape(2, n, m)
    first = np.searchsorted(stack.owner, np.arange(n_motions))
    return np.stack([np.minimum.reduceat(outer[0], first), np.maximum.reduceat(outer[1], first)])


def acceleration_steps(
    stack: Stack, n_motions: int, velocity: Array, acceleration: Array
) -> tuple[NDArray[np.bool_], Array]:
    """Motions with a step of velocity, or a doubtful one, and when each acceleration first steps (inf: never).

    Steps count relative to the largest `velocity` and `acceleration`, (n_motions, n_joints).
    """
    size, m = len(stack.state), stack.state.shape[3]
    left, right = (np.tensordot(signs, stack.state, 1) for signs in (matrices.signs(size - 1), np.ones(size)))
    first, last = (np.append(True, np.diff(stack.owner) != 0), np.append(np.diff(stack.owner) != 0, True))
    before = np.where(first[:, None, None], 0.0, np.concatenate([right[:1], right[:-1]]))
    gaps = np.concatenate([left - before, np.where(last[:, None, None], -right, 0.0)])[:, 1:3]
    owner = np.concatenate([stack.owner] * 2)
    at = np.concatenate([stack.start, stack.start + stack.lengths])
    largest = np.stack([velocity.max(axis=1), acceleration.max(axis=1)], axis=1)[owner]
    share = np.abs(gaps) / np.where(largest > 0, largest, 1.0)[:, :, None]
    odd = np.zeros(n_motions, dtype=np.bool_)
    odd[
        owner[(share[:, 0] > _NO_STEP).any(axis=1) | ((share[:, 1] > _NO_STEP) & (share[:, 1] < _STEP)).any(axis=1)]
    ] = True
    step, joint = np.nonzero(share[:, 1] >= _STEP)
    when = np.full((n_motions, m), np.inf)
    np.minimum.at(when, (owner[step], joint), at[step])
    return odd, when


def _part(found: Peaks, k: int, count: int, columns: int) -> Peaks:
    some = slice(k * count, (k + 1) * count)
    return Peaks(
        size=found.size[some],
        column=found.column[some] - k * columns,
        x=found.x[some],
        at_points=found.at_points[some],
        bound=found.bound[some],
    )


def _times(found: Peaks, stack: Stack, m: int) -> Array:
    piece = found.column // m
    return np.asarray((stack.start[piece] + stack.lengths[piece] * (found.x + 1) / 2).reshape(-1, m))


def _squares(series: Array, stack: Stack, n_motions: int) -> Array:
    """Integrals of the squares of series (degree + 1, n, m) over each motion, (n_motions, m)."""
    weighted = (matrices.gram_matrix(len(series) - 1) @ series.reshape(len(series), -1)).reshape(series.shape)
    return _summed((series * weighted).sum(axis=0) * (stack.lengths / 2)[:, None], stack.owner, n_motions)


def _summed(values: Array, owner: Index, n_motions: int) -> Array:
    total = np.zeros((n_motions, values.shape[1]))
    np.add.at(total, owner, values)
    return total


def _torque_squares(series: Array, steps: Steps, stack: Stack, n_motions: int, m: int) -> Array:
    """The same of series with steps: of ``(f + c)^2`` on each run of a level c, ``f^2 + 2 c f + c^2``."""
    smooth = _squares(series.reshape(len(series), -1, m), stack, n_motions)
    integral = matrices.integral_matrix(len(series) - 1) @ series
    # With levels as first + steps: the integral from a step to the end counts with the step's size.
    at = (matrices.basis_at(steps.x, len(integral) - 1) * integral[:, steps.column]).sum(axis=0)
    total, before = integral.sum(axis=0), steps.before
    mixed = steps.first * total
    np.add.at(mixed, steps.column, (steps.level - before) * (total[steps.column] - at))
    square = 2 * steps.first**2
    np.add.at(square, steps.column, (steps.level**2 - before**2) * (1 - steps.x))
    added = (2 * mixed + square).reshape(-1, m) * (stack.lengths / 2)[:, None]
    return smooth + _summed(added, stack.owner, n_motions)
