"""Verdicts on many motions by certified bounds; the search for peaks only where a bound does not decide."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.batch._many import BLOCK, MAGNITUDES, are_plain, assess_many, check_trajectories, is_linear
from puma_septic.batch._metrics import acceleration_steps
from puma_septic.batch._stack import LEAST_DEGREE, Index, Part, Stack, refined, stacked
from puma_septic.document import card, one_line
from puma_septic.limit_check import AT_LIMIT
from puma_septic.piecewise import matrices
from puma_septic.piecewise.peaks import hidden, ranges
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_list

__all__ = ["ManyVerdicts", "judge_many"]

Flags = NDArray[np.bool_]
# Between points that are so many times as dense as the degree a range is at most 4 % wider on each side than at them.
_OVERSAMPLING: Final = 4
# Multiples of the least degree of the torque, one after the other while bounds do not decide.
_MULTIPLES: Final = (1, 2, 4)
# A bound has to keep so far away from a limit, relative to it: what rounding does to a series is far less.
_CLEAR: Final = 1e-9
# A joint is taken to move where it is faster than this part of the motion's fastest joint.
_MOVES: Final = 1e-6
# The last coefficients of a series that is resolved: they fall no further.
_TOLERANCE: Final = 1e-11


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ManyVerdicts:
    """Whether each of many motions keeps all known limits; made by `judge_many`.

    Attributes
    ----------
    robot : Robot
    is_feasible : ndarray of bool, shape (n,)
    certificate : ndarray of str, shape (n,)
        "proved": by values at points, and by bounds between them; "resolved": by the search for peaks; "undecided":
        the motion itself is in doubt.
    n_searched : int
        How many went to `assess_many`, because bounds did not decide.
    """

    robot: Robot
    is_feasible: Flags
    certificate: NDArray[np.str_]
    n_searched: int

    def __len__(self) -> int:
        return len(self.is_feasible)

    def __repr__(self) -> str:
        return one_line("ManyVerdicts", self._facts())

    def _repr_html_(self) -> str:
        return card("ManyVerdicts", self._facts())

    def _facts(self) -> dict[str, object]:
        facts = {"robot": self.robot.name, "motions": len(self), "feasible": int(np.sum(self.is_feasible))}
        return facts | {"searched": self.n_searched}


def judge_many(robot: Robot, trajectories: Iterable[Trajectory]) -> ManyVerdicts:
    """Verdicts on many motions of one robot, without their peaks.

    A value beyond a limit at some point proves that a motion is not feasible; a bound below all limits that it is. The
    torque is sampled at few points first, and its series is bounded between them with what it leaves out (see Notes).
    Motions near a limit go to `assess_many`, and so does what is not a plain planned motion.

    Parameters
    ----------
    robot : Robot
    trajectories : iterable of Trajectory
        Each with as many joints as the robot has.

    Returns
    -------
    ManyVerdicts

    Raises
    ------
    InputError
        As `assess_many`.

    Notes
    -----
    Between N + 1 Chebyshev points a series of degree n is at most ``(pi / N)^2 / 8 sum k^2 |c_k|`` beyond them. The
    torque has infinitely many coefficients; those beyond the last one are taken to fall at least as fast as those of
    the last quarter fall against the quarter before, and count twice because they also alias.

    Examples
    --------
    >>> import puma_septic as ps
    >>> moves = [ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, t]) for t in (0.5, 1.0, 2.0)]
    >>> verdicts = ps.judge_many(ps.load_robot(), moves)
    >>> verdicts.is_feasible.tolist(), verdicts.certificate.tolist()
    ([False, True, True], ['proved', 'proved', 'proved'])
    """
    given = checked_list("trajectories", trajectories)
    check_trajectories(robot, given)
    blocks = [_proved(robot, given[k : k + BLOCK]) for k in range(0, len(given), BLOCK)]
    kept, broken = (np.concatenate(part) for part in zip(*blocks, strict=True))
    certificate = np.full(len(given), "proved", dtype="<U9")
    open_ = np.flatnonzero(~(kept | broken))
    if len(open_):
        many = assess_many(robot, [given[k] for k in open_.tolist()])
        kept[open_], certificate[open_] = many.is_feasible, many.certificate
    for array in (kept, certificate):
        array.setflags(write=False)
    return ManyVerdicts(robot=robot, is_feasible=kept, certificate=certificate, n_searched=len(open_))


def _proved(robot: Robot, trajectories: Sequence[Trajectory]) -> tuple[Flags, Flags]:
    """Which motions are proved to keep all known limits, and which to break one."""
    kept, broken = np.zeros((2, len(trajectories)), dtype=np.bool_)
    some = np.flatnonzero(are_plain(trajectories) & is_linear(robot))
    if not len(some):
        return kept, broken
    stack = stacked([trajectories[k] for k in some.tolist()])
    verdict = _kinematic(robot, stack, len(some))
    broken[some] = verdict.broken
    known = np.where(robot.knows_torque, robot.limits.effort, np.nan)
    if np.isnan(known).all():
        kept[some] = verdict.kept
        return kept, broken
    left = np.flatnonzero(verdict.kept)
    if len(left):
        torque = _torque(robot, stack.of(left)[0], len(left), known)
        kept[some[left]], broken[some[left]] = torque
    return kept, broken


class _Verdict(NamedTuple):
    """Of each motion; neither where bounds do not decide."""

    kept: Flags
    broken: Flags


def _verdict(at_least: Array, at_most: Array, limit: Array, odd: Flags) -> _Verdict:
    """From magnitudes (n, k) that are taken and not exceeded; an unknown limit is NaN and decides nothing."""
    broken = (at_least > limit * (1 + 2 * AT_LIMIT)).any(axis=1) & ~odd
    return _Verdict(~(at_most > limit * (1 - _CLEAR)).any(axis=1) & ~odd, broken)


def _kinematic(robot: Robot, stack: Stack, n_motions: int) -> _Verdict:
    """By positions, velocities, accelerations and jerks."""
    size, n, orders, m = stack.state.shape
    inner, outer = ranges(stack.state.reshape(size, -1), _OVERSAMPLING)
    inner, outer = (_over_motions(one.reshape(2, n, orders, m), stack.owner, n_motions) for one in (inner, outer))
    at_least, at_most = (np.abs(one[:, :, 1:]).max(axis=0) for one in (inner, outer))
    odd, when = acceleration_steps(stack, n_motions, at_least[:, 0], at_least[:, 1])
    at_least[:, 2][np.isfinite(when)] = at_most[:, 2][np.isfinite(when)] = np.inf
    limit = np.concatenate([getattr(robot.limits, name) for name in MAGNITUDES[:3]])
    moved = _verdict(at_least.reshape(n_motions, -1), at_most.reshape(n_motions, -1), limit, odd)
    lower, upper = robot.limits.position.T
    inside = ~((outer[0, :, 0] < lower) | (outer[1, :, 0] > upper)).any(axis=1)
    beyond = (np.fmax(lower - inner[0, :, 0], inner[1, :, 0] - upper) > 2 * AT_LIMIT).any(axis=1)
    return _Verdict(moved.kept & inside, moved.broken | (beyond & ~odd))


def _over_motions(both: Array, owner: Index, n_motions: int) -> Array:
    """Least and greatest values (2, n, ...) of intervals as those of motions."""
    first = np.searchsorted(owner, np.arange(n_motions))
    return np.stack([np.minimum.reduceat(both[0], first), np.maximum.reduceat(both[1], first)])


def _torque(robot: Robot, stack: Stack, n_motions: int, limit: Array) -> _Verdict:
    """By the torque, at more points as long as bounds do not decide."""
    kept, broken = np.zeros((2, n_motions), dtype=np.bool_)
    motions, values, coarser = np.arange(n_motions), np.empty((0, len(stack.lengths), robot.n_joints)), 0
    for multiple in _MULTIPLES:
        values = refined(robot, stack, Part(multiple, np.arange(len(stack.lengths)), coarser, values))
        inner, outer = _torque_ranges(robot, stack, values, multiple)
        at_least, at_most = (_over_motions(one, stack.owner, len(motions)) for one in (inner, outer))
        found = _verdict(_taken(at_least), np.abs(at_most).max(axis=0), limit, np.zeros(len(motions), dtype=np.bool_))
        kept[motions], broken[motions] = found
        left = np.flatnonzero(~(found.kept | found.broken))
        if not len(left):
            break
        stack, intervals = stack.of(left)
        motions, values, coarser = motions[left], values[:, intervals], multiple
    return _Verdict(kept, broken)


def _taken(both: Array) -> Array:
    """The magnitude that is taken for sure by values between two bounds each: (least upper, greatest lower) ones."""
    return np.asarray(np.maximum(np.maximum(-both[0], both[1]), 0.0))


def _torque_ranges(robot: Robot, stack: Stack, values: Array, multiple: int) -> tuple[Array, Array]:
    """What the torque reaches for sure, and what it does not exceed: least and greatest, (2, n, n_joints) each."""
    degree = LEAST_DEGREE * multiple
    size, n, _, m = stack.state.shape
    series = (matrices.coefficients_from_values(degree) @ values.reshape(degree + 1, -1)).reshape(values.shape)
    scale = np.abs(values).max(axis=0)
    beyond = hidden(series.reshape(degree + 1, -1), degree).reshape(n, m) + _left_out(series, scale)
    positive, negative = robot.coulomb_friction.T
    outer = np.stack([values.min(axis=0) + np.minimum(negative, 0) - beyond, values.max(axis=0) + positive + beyond])
    velocity = (matrices.basis_at(matrices.nodes(degree), size - 1).T @ stack.state[:, :, 1].reshape(size, -1)).reshape(
        degree + 1, n, m
    )
    slow = _MOVES * np.abs(velocity).max(axis=(0, 2))[:, None]
    # Where a joint hardly moves its friction is anything between both.
    low = values + np.where(velocity > slow, positive, negative)
    high = values + np.where(velocity < -slow, negative, positive)
    return np.stack([high.min(axis=0), low.max(axis=0)]), outer


def _left_out(series: Array, scale: Array) -> Array:
    """A bound of the coefficients beyond the last one, twice; infinite where the last ones do not fall."""
    quarter = max(2, len(series) // 4)
    last = np.abs(series[-quarter:]).max(axis=0)
    before = np.abs(series[-2 * quarter : -quarter]).max(axis=0)
    fall = last / np.where(before > 0, before, 1.0)
    falls = fall < 0.5
    bound = np.where(falls, 2 * quarter * last / (1 - np.where(falls, fall, 0.0)), np.inf)
    floor = _TOLERANCE * scale.max(axis=1, keepdims=True)
    return np.where(last <= floor, 2 * quarter * floor, bound)
