"""The branches of the inverse kinematics along a task's points, wrapped the short way, against the limits."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.errors import InputError, NoSolution
from puma_septic.kinematics import IkSolutions, LowestPoints, inverse_kinematics, lowest_points
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_choice, read_only

__all__ = [
    "Branch",
    "Posed",
    "Waypoint",
    "are_all_branches",
    "best_branch",
    "branches_through",
    "ranked_branches",
]

# An angle this far beyond its limit stands on it, to rounding, rad.
_SLACK: Final = 1e-9
# One rad beyond a limit weighs more than any travel within them.
_EXCESS_WEIGHT: Final = 1e6
# Among ways of the same length the one with the fewest added turns.
_TURN_WEIGHT: Final = 1e-9
_MOST_TURNS: Final = 1000  # of a cable drum; each is a candidate
_TURN: Final = 2 * np.pi
# Starts of the damped least squares at poses after the first, of which the first start is the point before.
_STARTS_NEAR: Final = 4
_ONLY: Final = "only"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Posed:
    """A pose of the tool with all its solutions.

    Attributes
    ----------
    T_world_tool : ndarray, shape (4, 4)
    solutions : IkSolutions
    constrain : str
        Which of its conditions count, as `inverse_kinematics` has it.
    """

    T_world_tool: Array
    solutions: IkSolutions
    constrain: str = "pose"


# Joint positions (n_joints,), or a pose.
Waypoint = Array | Posed


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Branch:
    """One way through the points.

    Attributes
    ----------
    configuration : str
        Name of the inverse kinematics' branch.
    q : ndarray, shape (k, n_joints)
        rad (m), each joint going the short way within its limits.
    excess : ndarray, shape (k, n_joints)
        How far each is beyond its limits, 0 within them, rad (m).
    lowest : LowestPoints
        How low the arm is at each point.
    """

    configuration: str
    q: Array
    excess: Array
    lowest: LowestPoints

    def __post_init__(self) -> None:
        for name in ("q", "excess"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    @property
    def travel(self) -> float:
        """Sum of all joints' ways from point to point, rad (m)."""
        return float(np.abs(np.diff(self.q, axis=0)).sum())

    @property
    def is_within_limits(self) -> bool:
        """Whether all points are within all known limits."""
        return not self.excess.any()

    def depth(self, floor: float) -> float:
        """How far the arm is below a floor of this height at its lowest point, m; 0 above it."""
        return max(0.0, floor - float(self.lowest.height.min()) - _SLACK)


def branches_through(robot: Robot, waypoints: Sequence[Waypoint]) -> tuple[Branch, ...]:
    """Every way through the waypoints, one for each solution of the first pose.

    An arm with a closed form keeps the branch at every pose that has it. Elsewhere solutions have no names that hold
    from pose to pose: the one nearest to the point before is taken.
    """
    first = next((point for point in waypoints if isinstance(point, Posed)), None)
    names = (_ONLY,) if first is None else first.solutions.configurations
    is_free = np.array([isinstance(point, Posed) for point in waypoints])
    result = []
    for k, name in enumerate(names):
        q: list[Array] = []
        for point in waypoints:
            q.append(_positions(robot, point, name, k, q[-1] if is_free[: len(q)].any() else None))
        way = _short_way(robot, np.array(q), is_free)
        lowest = lowest_points(robot, way)
        result.append(Branch(configuration=name, q=way, excess=_excess(robot, way), lowest=lowest))
    return tuple(result)


def are_all_branches(waypoints: Sequence[Waypoint]) -> bool:
    """Whether `branches_through` has every branch of every pose among its ways."""
    posed = [point.solutions for point in waypoints if isinstance(point, Posed)]
    return all(one.is_complete and set(one.configurations) <= set(posed[0].configurations) for one in posed)


def best_branch(branches: Sequence[Branch], wanted: str, floor: float | None = None) -> Branch:
    """The named branch; for "auto" the one within limits that travels least, else the one least beyond them.

    With a floor, those that stay above it come before all others.

    Raises
    ------
    InputError
        For a name that is not among them, with those that are.
    """
    return ranked_branches(branches, wanted, floor)[0]


def ranked_branches(branches: Sequence[Branch], wanted: str, floor: float | None = None) -> tuple[Branch, ...]:
    """The named branch alone; for "auto" all, as `best_branch` prefers them."""
    if wanted != "auto":
        names = [branch.configuration for branch in branches]
        return (branches[names.index(checked_choice("branch", wanted, [*names, "auto"]))],)

    def rank(branch: Branch) -> tuple[bool, float, float, float]:
        depth = 0.0 if floor is None else branch.depth(floor)
        return depth > 0.0, float(branch.excess.sum()), depth, branch.travel

    return tuple(sorted(branches, key=rank))


def _positions(robot: Robot, point: Waypoint, name: str, first: int, before: Array | None) -> Array:
    """Joint positions at a waypoint in the branch of this name; `before` is None up to the first pose.

    `first` is the branch's index among the first pose's solutions.
    """
    if not isinstance(point, Posed):
        return point
    solutions = point.solutions
    if before is None:
        return read_only(solutions.q[first])
    if not solutions.starts and name in solutions.configurations:
        return read_only(solutions.select(name))
    if solutions.starts:
        with suppress(NoSolution):  # then the solutions that are known have to do
            solutions = inverse_kinematics(
                robot, point.T_world_tool, constrain=point.constrain, q_near=before, starts=_STARTS_NEAR
            )
    gap = np.abs(solutions.q - before)
    gap = np.where(robot.is_prismatic, gap, np.minimum(gap % _TURN, -gap % _TURN))
    return read_only(solutions.q[np.argmin(gap.sum(axis=1) + _EXCESS_WEIGHT * ~solutions.within_limits)])


def _excess(robot: Robot, q: Array) -> Array:
    """How far positions of shape (..., n_joints) are beyond the limits; an unknown limit is not exceeded."""
    low, high = robot.limits.position.T
    beyond = np.fmax(np.fmax(low - q, q - high), 0.0)
    return np.where(beyond > _SLACK, beyond, 0.0)


def _short_way(robot: Robot, q: Array, is_free: NDArray[np.bool_]) -> Array:
    """Add whole turns to the free rows of q, (k, n_joints): each joint within limits, then travelling least.

    Dynamic programming, joint by joint: with limits of more than a turn, the nearest angle at one point can
    be the wrong one for the next. The candidates at each point are the turn nearest to the point before and as many
    on both sides of it as may be needed.
    """
    movable = is_free[:, None] & ~robot.is_prismatic
    nearest = _unwound(q, movable)
    extra = _furthest(robot, q, nearest)
    turns = nearest + np.array(sorted(range(-extra, extra + 1), key=lambda n: (abs(n), n)))[:, None, None]
    choices = q + _TURN * turns
    cost = _EXCESS_WEIGHT * _excess(robot, choices) + _TURN_WEIGHT * np.abs(turns)
    cost = np.where(movable | (turns == 0), cost, np.inf)
    joints = np.arange(q.shape[1])
    total, came_from = cost[:, 0], []
    for k in range(1, len(q)):
        step = total[:, None] + np.abs(choices[None, :, k] - choices[:, None, k - 1])  # (from, to, joint)
        came_from.append(step.argmin(axis=0))
        total = step.min(axis=0) + cost[:, k]
    chosen = [total.argmin(axis=0)]
    for before in reversed(came_from):
        chosen.append(before[chosen[-1], joints])
    return np.array([choices[index, k, joints] for k, index in enumerate(reversed(chosen))])


def _unwound(q: Array, movable: NDArray[np.bool_]) -> Array:
    """Whole turns that bring each movable angle nearest to the one before it, shape (k, n_joints)."""
    turns = np.zeros_like(q)
    for k in range(1, len(q)):
        before = q[k - 1] + _TURN * turns[k - 1]
        turns[k] = np.where(movable[k], np.rint((before - q[k]) / _TURN), 0.0)
    return turns


def _furthest(robot: Robot, q: Array, nearest: Array) -> int:
    """How many turns from the nearest the best may be: as many as lead to a given point, or back into the limits."""
    way = q + _TURN * nearest
    gaps = np.where(robot.is_prismatic, 0.0, np.abs(np.diff(way, axis=0)))
    beyond = np.where(robot.is_prismatic, 0.0, _excess(robot, way))
    count = max(gaps.max(initial=0.0), beyond.max()) / _TURN
    if not count <= _MOST_TURNS:
        raise InputError(
            f"points: a joint would turn {count:.3g} times from one to the next; at most {_MOST_TURNS} times"
        )
    return 1 + int(np.ceil(count))
