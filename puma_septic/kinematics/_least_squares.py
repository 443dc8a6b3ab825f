"""Damped least squares for any arm, for many starts or poses at once."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.kinematics._chain import Chain, chain_to, end_frame
from puma_septic.kinematics._forward import end_and_jacobian, jacobian_columns
from puma_septic.kinematics._poses import CONDITIONS, Conditions, condition_errors, condition_rows
from puma_septic.kinematics._wrapping import resting, wrapped
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = [
    "SOLVED",
    "distinct",
    "end_errors",
    "is_singular",
    "is_solved",
    "levenberg_marquardt",
    "solve_from_starts",
]

# The step is quadratic near an answer; what is left at this size is the rounding of forward kinematics.
CONVERGED = 1e-14
# An answer leaves less than this over (m, rad).
SOLVED = 1e-10
# Steps in which the squared error must fall to half: near an answer each step does more, even where two meet.
_PATIENCE: Final = 6
# How often answers are seeds for others.
_ROUNDS: Final = 3
# Smallest singular value of the Jacobian below which a posture is called singular.
SINGULAR = 1e-6


def levenberg_marquardt(
    robot: Robot,
    target: Array,
    q: Array,
    *,
    bounds: Array | None = None,
    conditions: Conditions = CONDITIONS["pose"],
    damping: float = 1e-2,
    converged: float = CONVERGED,
    iterations: int = 100,
) -> tuple[Array, Array]:
    r"""Move joint positions until the tool stands on its target.

    Each step solves :math:`(J^T J + \lambda I)\,\delta = J^T e`, with :math:`\lambda` divided by ten after a
    step that brings the tool nearer and multiplied by four after one that does not and is taken back
    (Marquardt 1963). A start that does not halve its squared error in six steps is stuck and given up.

    Parameters
    ----------
    target : ndarray, shape (4, 3, n) or (4, 3, 1)
        Poses, as `checked_poses` returns them.
    q : ndarray, shape (n, n_joints)
        Starts.
    bounds : ndarray, shape (2, n_joints), optional
        Lowest and highest joint positions; each step is cut back to them.
    conditions : tuple of bool
        Which of the pose's conditions count.
    damping : float
        The first one.
    converged : float
        What may be left, m or rad.

    Returns
    -------
    q : ndarray, shape (n, n_joints)
    errors : ndarray, shape (n, k)
        What is left of the k conditions, m over rad.
    """
    target = np.broadcast_to(target, (4, 3, len(q)))
    q, (errors, matrix) = q.copy(), _errors_and_slopes(robot, target, q, conditions)
    dampings = np.full(len(q), damping)
    active = np.arange(len(q))
    before = np.full(len(q), np.inf)
    for step in range(iterations):
        if step % _PATIENCE == 0:
            left = (errors**2).sum(axis=1)
            active, before = active[left[active] < 0.5 * before[active]], left
        active = active[(np.abs(errors[active]).max(axis=1) > converged) & (dampings[active] < 1e9)]
        if not len(active):
            break
        there = target[:, :, active]
        trial = q[active] + _steps(matrix[active], errors[active], dampings[active])
        if bounds is not None:
            trial = np.clip(trial, *bounds)
        trial_errors, slopes = _errors_and_slopes(robot, there, trial, conditions)
        nearer = (trial_errors**2).sum(axis=1) < (errors[active] ** 2).sum(axis=1)
        better = active[nearer]
        q[better], errors[better], matrix[better] = trial[nearer], trial_errors[nearer], slopes[nearer]
        dampings[active] *= np.where(nearer, 0.1, 4.0)
    return q, errors


def end_errors(chain: Chain, target: Array, q: Array, conditions: Conditions = CONDITIONS["pose"]) -> Array:
    """What separates the chain's end from its target, shape (n, k): m over rad."""
    return condition_errors(target, end_frame(chain, q.T), conditions)


def _errors_and_slopes(robot: Robot, target: Array, q: Array, conditions: Conditions) -> tuple[Array, Array]:
    """What separates the tool from its target, and the Jacobian of that, shape (n, k, n_joints)."""
    end, columns = end_and_jacobian(robot, q.T)
    return condition_errors(target, end, conditions), condition_rows(target, columns, conditions)


def _steps(matrix: Array, errors: Array, damping: Array) -> Array:
    """Damped Gauss-Newton steps, shape (n, n_joints), for Jacobians of shape (n, k, n_joints)."""
    transposed = matrix.transpose(0, 2, 1)
    normal = transposed @ matrix
    diagonal = np.arange(matrix.shape[2])
    # The floor keeps a joint that moves nothing, and a singular arm, solvable.
    normal[:, diagonal, diagonal] += np.maximum(damping, 1e-15)[:, None]
    return np.asarray(np.linalg.solve(normal, transposed @ errors[:, :, None])[:, :, 0])


def solve_from_starts(
    robot: Robot,
    target: Array,
    near: Array | None,
    *,
    starts: int,
    rng: np.random.Generator,
    conditions: Conditions = CONDITIONS["pose"],
) -> tuple[Array, Array, int]:
    """Joint positions, shape (m, n_joints), what they leave over, shape (m, k), and how many starts were tried.

    Distinct answers where there are any, else where each start ended. Steps stay within the position limits; where no
    start leads to an answer, the same is tried without limits. Each answer found is a seed for others: the wrist
    turned over, the arm turned back, the elbow bent the other way.
    """
    first = _starts(robot, near, count=starts, rng=rng)
    bounds = _bounds(robot)
    q, errors = levenberg_marquardt(robot, target, first, bounds=bounds, conditions=conditions)
    tried = len(q)
    if not is_solved(errors).any():
        free_q, free_errors = levenberg_marquardt(robot, target, first, conditions=conditions)
        q, errors, tried = np.concatenate((q, free_q)), np.concatenate((errors, free_errors)), 2 * tried
        if not is_solved(errors).any():
            return _wrapped(robot, q, near), errors, tried
    q, errors = _distinct_answers(robot, _wrapped(robot, q, near), errors)
    fresh = q
    for _ in range(_ROUNDS if starts > 1 and all(conditions) else 0):
        seeds = _mirrored(robot, fresh, near)
        if not len(seeds):
            break
        more, left = levenberg_marquardt(robot, target, seeds, bounds=bounds, conditions=conditions)
        known, tried = len(q), tried + len(seeds)
        more, left = np.concatenate((q, _wrapped(robot, more, near))), np.concatenate((errors, left))
        q, errors = _distinct_answers(robot, more, left)
        fresh = q[known:]
    return q, errors, tried


def _bounds(robot: Robot) -> Array:
    """Lowest and highest joint positions, shape (2, n_joints); infinite for an angle that has a turn between them.

    Such an angle is brought within its limits by whole turns, and a step that may pass a limit gets stuck less.
    """
    low, high = robot.limits.position.T
    turns = ~robot.is_prismatic & (high - low >= 2.0 * np.pi)
    return np.stack((np.where(np.isnan(low) | turns, -np.inf, low), np.where(np.isnan(high) | turns, np.inf, high)))


def is_solved(errors: Array) -> NDArray[np.bool_]:
    """Whether what is left over is no more than rounding, shape (m,)."""
    return np.asarray(np.abs(errors).max(axis=1) <= SOLVED)


def _distinct_answers(robot: Robot, q: Array, errors: Array) -> tuple[Array, Array]:
    q, errors = q[is_solved(errors)], errors[is_solved(errors)]
    kept = distinct(robot, q)
    return q[kept], errors[kept]


def _mirrored(robot: Robot, q: Array, near: Array | None) -> Array:
    """Seeds from answers, for six revolute joints of which the last three are a wrist: shape (3 m, n_joints)."""
    chain = chain_to(robot)
    columns = chain.columns
    if len(columns) != 6 or any(chain.prismatic) or chain.is_coupled:
        return q[:0]
    wrist, back, elbow = q.copy(), q.copy(), q.copy()
    wrist[:, columns[-3:]] = q[:, columns[-3:]] * (1.0, -1.0, 1.0) + (np.pi, 0.0, -np.pi)
    back[:, columns[:3]] = q[:, columns[:3]] * (1.0, -1.0, 1.0) + (np.pi, 0.0, 0.0)
    elbow[:, columns[2]] *= -1.0
    return _wrapped(robot, np.concatenate((wrist, back, elbow)), near)


def _wrapped(robot: Robot, q: Array, near: Array | None) -> Array:
    """The rows with whole turns that bring them within the limits, near `near`."""
    angles, moved = _angles(robot), q.copy()
    moved[:, angles] = wrapped(robot, q[:, angles].T, angles, near).T
    return moved


def distinct(robot: Robot, q: Array, tolerance: float = 1e-5) -> NDArray[np.int64]:
    """Indices of the rows of q that differ from all before them, angles compared modulo a turn."""
    angles = _angles(robot)
    kept: list[int] = []
    for k, row in enumerate(q):
        gap = np.abs(q[kept] - row)
        gap[:, angles] = np.abs((gap[:, angles] + np.pi) % (2.0 * np.pi) - np.pi)
        if not (gap.max(axis=1, initial=0.0) < tolerance).any():
            kept.append(k)
    return np.array(kept, dtype=np.int64)


def is_singular(robot: Robot, target: Array, q: Array, conditions: Conditions) -> NDArray[np.bool_]:
    """Whether the Jacobian of the joints that carry the tool loses rank, shape (n,), for q (n, n_joints)."""
    columns = jacobian_columns(robot, q.T)[:, :, chain_to(robot).driving]
    matrix = condition_rows(np.broadcast_to(target, (4, 3, len(q))), columns, conditions)
    return np.asarray(np.linalg.svd(matrix, compute_uv=False)[:, -1] < SINGULAR)


def _starts(robot: Robot, near: Array | None, *, count: int, rng: np.random.Generator) -> Array:
    """Starts within the limits, shape (count, n_joints): `near` (else mid-range) first, the others random.

    Joints that do not carry the tool stay where the first start has them. An angle without limits, or with
    more than a turn, is drawn from one turn.
    """
    low, high = robot.limits.position.T
    unknown = np.isnan(low + high)
    middle = np.where(unknown, 0.0, 0.5 * (low + high))
    half = np.minimum(np.where(unknown, np.pi, 0.5 * (high - low)), np.pi)
    starts = np.tile(resting(robot, near), (count, 1))
    columns = chain_to(robot).driving
    starts[1:, columns] = (middle + half * rng.uniform(-1.0, 1.0, (count - 1, robot.n_joints)))[:, columns]
    return starts


def _angles(robot: Robot) -> NDArray[np.int64]:
    """Indices of the joints that turn and carry the tool, but for those that others mimic: a turn counts of them."""
    chain = chain_to(robot)
    if chain.is_coupled:
        masters = [robot.joint_index(mimic.master) for mimic in robot.mimics.values()]
        return np.setdiff1d(chain.driving[~robot.is_prismatic[chain.driving]], masters)
    return np.asarray(chain.columns[~np.array(chain.prismatic, dtype=bool)])
