"""Damped least squares for any arm, for many starts or poses at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from puma_septic.kinematics._chain import Chain, chain_to, end_frame
from puma_septic.kinematics._forward import jacobian_columns
from puma_septic.kinematics._poses import pose_errors
from puma_septic.kinematics._wrapping import resting, wrapped
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["SOLVED", "distinct", "end_errors", "is_singular", "levenberg_marquardt", "solve_from_starts"]

# The step is quadratic near an answer; what is left at this size is the rounding of forward kinematics.
CONVERGED = 1e-14
# An answer leaves less than this over (m, rad).
SOLVED = 1e-10
# Smallest singular value of the Jacobian below which a posture is called singular.
SINGULAR = 1e-6


def levenberg_marquardt(
    robot: Robot, target: Array, q: Array, *, bounds: Array | None = None, iterations: int = 100
) -> tuple[Array, Array]:
    r"""Move joint positions until the tool stands on its target.

    Each step solves :math:`(J^T J + \lambda I)\,\delta = J^T e`, with :math:`\lambda` divided by ten after a
    step that brings the tool nearer and multiplied by four after one that does not and is taken back
    (Marquardt 1963).

    Parameters
    ----------
    target : ndarray, shape (4, 3, n) or (4, 3, 1)
        Poses, as `checked_poses` returns them.
    q : ndarray, shape (n, n_joints)
        Starts.
    bounds : ndarray, shape (2, n_joints), optional
        Lowest and highest joint positions; each step is cut back to them.

    Returns
    -------
    q : ndarray, shape (n, n_joints)
    errors : ndarray, shape (n, 6)
        What is left, m over rad.
    """
    target = np.broadcast_to(target, (4, 3, len(q)))
    q, errors = q.copy(), end_errors(chain_to(robot), target, q)
    damping = np.full(len(q), 1e-2)
    active = np.arange(len(q))
    for _ in range(iterations):
        active = active[(np.abs(errors[active]).max(axis=1) > CONVERGED) & (damping[active] < 1e9)]
        if not len(active):
            break
        trial = q[active] + _steps(robot, q[active], errors[active], damping[active])
        if bounds is not None:
            trial = np.clip(trial, *bounds)
        trial_errors = end_errors(chain_to(robot), target[:, :, active], trial)
        nearer = (trial_errors**2).sum(axis=1) < (errors[active] ** 2).sum(axis=1)
        better = active[nearer]
        q[better], errors[better] = trial[nearer], trial_errors[nearer]
        damping[active] *= np.where(nearer, 0.1, 4.0)
    return q, errors


def end_errors(chain: Chain, target: Array, q: Array) -> Array:
    """What separates the chain's end from its target, shape (n, 6): m over rad."""
    return pose_errors(target, end_frame(chain, q.T))


def _steps(robot: Robot, q: Array, errors: Array, damping: Array) -> Array:
    """Damped Gauss-Newton steps, shape (n, n_joints)."""
    matrix = jacobian_columns(robot, q.T)
    transposed = matrix.transpose(0, 2, 1)
    normal = transposed @ matrix
    diagonal = np.arange(robot.n_joints)
    # The floor keeps a joint that moves nothing, and a singular arm, solvable.
    normal[:, diagonal, diagonal] += np.maximum(damping, 1e-15)[:, None]
    return np.asarray(np.linalg.solve(normal, transposed @ errors[:, :, None])[:, :, 0])


def solve_from_starts(
    robot: Robot, target: Array, near: Array | None, *, starts: int, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Answers, shape (m, n_joints), and what they leave over, shape (m, 6), from several starts for one pose.

    Steps stay within the position limits; where no start leads to an answer, the same is tried without
    limits, and both are returned.
    """
    first = _starts(robot, near, count=starts, rng=rng)
    low, high = robot.limits.position.T
    bounds = np.stack((np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)))
    q, errors = levenberg_marquardt(robot, target, first, bounds=bounds)
    if not (np.abs(errors).max(axis=1) <= SOLVED).any():
        free_q, free_errors = levenberg_marquardt(robot, target, first)
        q, errors = np.concatenate((q, free_q)), np.concatenate((errors, free_errors))
    angles = _angles(robot)
    q[:, angles] = wrapped(robot, q[:, angles].T, angles, near).T
    return q, errors


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


def is_singular(robot: Robot, q: Array) -> NDArray[np.bool_]:
    """Whether the Jacobian of the joints that carry the tool loses rank, shape (n,), for q (n, n_joints)."""
    matrix = jacobian_columns(robot, q.T)[:, :, chain_to(robot).columns]
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
    columns = chain_to(robot).columns
    starts[1:, columns] = (middle + half * rng.uniform(-1.0, 1.0, (count - 1, robot.n_joints)))[:, columns]
    return starts


def _angles(robot: Robot) -> NDArray[np.int64]:
    """Indices of the joints that turn and carry the tool."""
    chain = chain_to(robot)
    return np.asarray(chain.columns[~np.array(chain.prismatic, dtype=bool)])
