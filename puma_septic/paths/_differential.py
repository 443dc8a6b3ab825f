"""Joint rates that follow a path: the differential kinematics to the third order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from puma_septic.kinematics import chain_to, forward_kinematics, jacobian, pose_errors, tool_derivatives
from puma_septic.paths._path import PathRates
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["Follower"]

# A singular value of the Jacobian below this part of the largest of an arm anywhere counts for its rank as zero.
_RANK = 1e-6
# Newton doubles the digits with each step; from a closed form or a tracked guess two are enough, from afar a few more.
_STEPS = 8
# A few roundings of a pose: near a singularity each of them is many of a joint.
_CONVERGED = 2e-15


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Follower:
    """How an arm's joints answer to what the tool is to do.

    Attributes
    ----------
    robot : Robot
    conditions : int
        6 for the pose, 3 for the position alone.
    rank : int
        Of the Jacobian in general postures, at most the number of joints that carry the tool.
    """

    robot: Robot
    conditions: int
    rank: int

    @classmethod
    def of(cls, robot: Robot, conditions: int) -> Follower:
        """With the rank of general postures, which a start may lie apart from."""
        rng = np.random.default_rng(0)
        q = rng.uniform(-1.0, 1.0, (4, robot.n_joints))
        matrices = jacobian(robot, q)[:, :conditions][:, :, np.unique(chain_to(robot).columns)]
        sizes = np.linalg.svd(matrices, compute_uv=False)
        return cls(robot=robot, conditions=conditions, rank=int((sizes > _RANK * sizes.max()).sum(axis=1).max()))

    @property
    def is_redundant(self) -> bool:
        """Whether the arm has joints to spare for the conditions."""
        return len(np.unique(chain_to(self.robot).columns)) > self.rank

    def inverse(self, q: Array) -> tuple[Array, Array]:
        """Least-norm, least-squares inverses of the Jacobian, (n, n_joints, conditions), and its singular value that
        matters, (n,): the smallest, at least its order of magnitude; zero where there is no inverse.
        """
        columns = np.unique(chain_to(self.robot).columns)
        matrix = jacobian(self.robot, q)[:, : self.conditions][:, :, columns]
        result = np.zeros((len(q), q.shape[1], self.conditions))
        if matrix.shape[1] == matrix.shape[2] == self.rank:
            determinants = np.linalg.det(matrix)
            matrix[determinants == 0] = np.eye(self.rank)
            inverses = np.linalg.inv(matrix)
            size = 1 / np.linalg.norm(inverses, axis=(1, 2))
            size[determinants == 0] = 0.0
        else:
            u, sizes, vt = np.linalg.svd(matrix, full_matrices=False)
            u, sizes, vt = u[..., : self.rank], sizes[:, : self.rank], vt[:, : self.rank]
            size = sizes[:, -1]
            safe = np.maximum(sizes, np.finfo(np.float64).tiny)
            inverses = (vt.transpose(0, 2, 1) / safe[:, None]) @ u.transpose(0, 2, 1)
        result[:, columns] = inverses
        return result, size

    def errors(self, q: Array, poses: Array) -> Array:
        """What separates the tool from its poses, (n, conditions): m over rad."""
        frames = [pose[:, :3].transpose(2, 1, 0) for pose in (poses, forward_kinematics(self.robot, q))]
        return pose_errors(*frames)[:, : self.conditions]

    def polished(self, q: Array, poses: Array) -> tuple[Array, Array]:
        """Joint positions moved onto their poses by Newton's method, and what is left over, (n,)."""
        errors = self.errors(q, poses)
        for _ in range(_STEPS):
            if np.abs(errors).max() <= _CONVERGED:
                break
            inverse, _ = self.inverse(q)
            moved = q + (inverse @ errors[:, :, None])[:, :, 0]
            left = self.errors(moved, poses)
            better = np.abs(left).max(axis=1) < 0.5 * np.abs(errors).max(axis=1)
            if not better.any():
                break
            q, errors = np.where(better[:, None], moved, q), np.where(better[:, None], left, errors)
        return q, np.abs(errors).max(axis=1)

    def targets(self, rates: PathRates) -> Array:
        """Derivatives of the tool's motion that count, (3, n, conditions)."""
        return np.concatenate([rates.linear, rates.angular], axis=2)[:, :, : self.conditions]

    def rates(self, q: Array, rates: PathRates) -> tuple[Array, Array]:
        r"""Derivatives of the joint positions by distance, (3, n, n_joints), and the singular value that matters.

        From order to order :math:`q^{(k)} = J^{-1}(x^{(k)} - b_k)`, with b what the tool's motion has of order k from
        the lower orders alone.
        """
        inverse, size = self.inverse(q)
        targets = self.targets(rates)
        known: list[Array] = []
        for order in range(3):
            wanted = targets[order]
            if order:
                _, linear, angular = tool_derivatives(self.robot, q.T, [*known, np.zeros(q.T.shape)])
                wanted = wanted - np.concatenate([linear[order], angular[order]])[: self.conditions].T
            known.append((inverse @ wanted[:, :, None])[:, :, 0].T)
        return np.stack(known).transpose(0, 2, 1), size
