"""The largest torque that holds an arm anywhere in a box of poses."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import pi
from typing import Final, final

import numpy as np

from puma_septic.document import card, one_line
from puma_septic.dynamics import check_inertia, check_uncoupled, rigid_torque
from puma_septic.robot import Payload, Robot
from puma_septic.validation import Array, checked_kind, checked_number, read_only
from puma_septic.worst_case._polynomials import fitted
from puma_septic.worst_case._region import Region, acting_joints, certified_minimum, checked_region, random_poses

__all__ = ["WorstHolding", "holding_poses", "worst_holding_torque"]

_STARTS: Final = 24
_SWEEPS: Final = 12
_MOST_BOXES: Final = 60_000


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class WorstHolding:
    """The largest torque, by joint, that holds the arm at rest in a region, without the help of friction.

    Attributes
    ----------
    robot : Robot
    region : ndarray, shape (n_joints, 2)
        rad (m).
    attained : ndarray, shape (n_joints,)
        Magnitude at the worst pose found, N m (N).
    poses : ndarray, shape (n_joints, n_joints)
        That pose of each joint, one a row, rad (m).
    bound : ndarray, shape (n_joints,)
        Magnitude that no pose of the region exceeds, N m (N).
    """

    robot: Robot
    region: Array
    attained: Array
    poses: Array
    bound: Array

    def __post_init__(self) -> None:
        for name in ("region", "attained", "poses", "bound"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def __repr__(self) -> str:
        return one_line("WorstHolding", self._facts())

    def _repr_html_(self) -> str:
        return card("WorstHolding", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "robot": self.robot.name,
            "attained": [float(f"{value:.4g}") for value in self.attained],
            "bound": [float(f"{value:.4g}") for value in self.bound],
        }


def worst_holding_torque(
    robot: Robot, *, payload: Payload | None = None, region: Region | None = None, gap: float = 1e-3
) -> WorstHolding:
    """The largest holding torque of each joint over a box of poses, with a certified bound.

    Gravity's torque, and that of a wrench, is affine in ``(cos q_k, sin q_k)`` of each joint. An arc lies in the
    triangle of its ends and the point where their tangents meet, so over a box the torque is nowhere larger than at
    the corners of these triangles; boxes are halved, the largest bound first. The pose found is improved joint by
    joint, which is exact: ``A + B cos q_k + C sin q_k``.

    Parameters
    ----------
    robot : Robot
    payload : Payload, optional
        Instead of the robot's own.
    region : mapping of str to (float, float), optional
        Bounds of some joints, rad (m); the position limits of the others.
    gap : float
        Relative difference of bound and pose found to stop at.

    Returns
    -------
    WorstHolding

    Raises
    ------
    InputError
        For invalid bounds.
    ModelError
        If a moving part has no inertia, or more joints act together than can be bounded.

    Examples
    --------
    >>> import puma_septic as ps
    >>> worst = ps.worst_holding_torque(ps.load_robot(), region={"joint2": (-0.5, 0.5)}, gap=0.01)
    >>> worst.attained.round(2).tolist()
    [0.0, 46.02, 8.78, 0.03, 0.03, 0.0]
    """
    checked_number("gap", gap, above=0.0)
    checked_kind("robot", robot, Robot)
    carrying = robot if payload is None else robot.with_payload(payload)
    check_inertia(carrying)
    check_uncoupled(carrying, "the certified holding torque")
    bounds = checked_region(carrying, region)
    poses = holding_poses(carrying, bounds)
    attained = np.abs(np.diagonal(_at_rest(carrying, poses)))
    scale = float(attained.max(initial=0.0))
    goals = attained * (1 + gap) + 1e-3 * gap * scale  # the second term for what is rounding, such as an upright axis's
    bound = np.array([_bound(carrying, bounds, joint, (goal, scale)) for joint, goal in enumerate(goals)])
    return WorstHolding(robot=carrying, region=bounds, attained=attained, poses=poses, bound=bound)


def holding_poses(robot: Robot, bounds: Array, *, starts: int = _STARTS) -> Array:
    """For each joint the pose of the box, as far as found, in which it holds most, shape (n_joints, n_joints).

    From the worst of random poses one joint after the other is put where the torque is largest, until nothing moves.
    """
    random = random_poses(bounds, 1000)
    sizes = np.abs(_at_rest(robot, random))
    return np.array(
        [_climbed(robot, bounds, j, random[np.argsort(-sizes[:, j])[:starts]]) for j in range(robot.n_joints)]
    )


def _at_rest(robot: Robot, q: Array) -> Array:
    rest = np.zeros_like(q)
    return rigid_torque(robot, q, rest, rest)


def _climbed(robot: Robot, bounds: Array, joint: int, starts: Array) -> Array:
    q, size = starts.copy(), np.zeros(len(starts))
    for _ in range(_SWEEPS):
        for k in sorted(acting_joints(robot, joint)):
            q, reached = _best_along(robot, bounds, (joint, k), q)
        if (reached <= size * (1 + 1e-12)).all():
            break
        size = reached
    best: Array = q[int(np.argmax(reached))]
    return best


def _best_along(robot: Robot, bounds: Array, which: tuple[int, int], q: Array) -> tuple[Array, Array]:
    """Each pose with one joint where the torque of another is largest, and that torque."""
    joint, k = which
    low, high = bounds[k]
    candidates = [np.full(len(q), low), np.full(len(q), high), q[:, k]]
    if not robot.is_prismatic[k]:
        a, b, c = _torques(robot, joint, k, q, [np.full(len(q), angle) for angle in (0.0, 0.5 * pi, pi)])
        crest = np.arctan2(b - 0.5 * (a + c), 0.5 * (a - c))  # A + B cos + C sin, from three angles
        for extreme in (crest, crest + pi):
            turned = low + np.mod(extreme - low, 2 * pi)
            candidates.append(np.where(turned <= high, turned, q[:, k]))
    sizes = np.abs(_torques(robot, joint, k, q, candidates))
    chosen = np.argmax(sizes, axis=0)
    moved, rows = q.copy(), np.arange(len(q))
    moved[:, k] = np.array(candidates)[chosen, rows]
    return moved, sizes[chosen, rows]


def _torques(robot: Robot, joint: int, k: int, q: Array, values: list[Array]) -> Array:
    """Torque of a joint at rest with another at each of these values, shape (len(values), n)."""
    poses = np.repeat(q[None], len(values), axis=0)
    poses[:, :, k] = values
    return _at_rest(robot, poses.reshape(-1, q.shape[1]))[:, joint].reshape(len(values), -1)


def _bound(robot: Robot, bounds: Array, joint: int, goal: tuple[float, float]) -> float:
    """A magnitude that is not exceeded; of the goal its value and the arm's largest torque."""
    acting = acting_joints(robot, joint)
    polynomial = fitted(
        lambda q: _at_rest(robot, q)[:, joint : joint + 1],
        bounds,
        tuple(robot.is_prismatic),
        degrees=[1 if j in acting else 0 for j in range(robot.n_joints)],
        scale=goal[1],
    )
    least = partial(_least, float(polynomial.remainder[0]))
    return -certified_minimum(polynomial, bounds, least, goal=-goal[0], at_most=_MOST_BOXES)


def _least(rest: float, values: Array) -> Array:
    """Minus the largest magnitude."""
    return np.asarray(-np.abs(values[:, :, 0]).max(axis=1) - rest)
