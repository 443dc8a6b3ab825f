"""What accelerations, speeds and a pose ask of each joint, against its torque limit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations
from typing import final

import numpy as np

from puma_septic.dynamics import rigid_torque
from puma_septic.robot import Robot
from puma_septic.validation import Array, read_only
from puma_septic.worst_case._polynomials import PosePolynomial

__all__ = ["Demand"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Demand:
    """Accelerations and speeds, as magnitudes, of an arm.

    Attributes
    ----------
    robot : Robot
    speeds, accelerations : ndarray, shape (n_joints,)
        rad/s and rad/s^2 (m/s and m/s^2).
    """

    robot: Robot
    speeds: Array
    accelerations: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "speeds", read_only(self.speeds))
        object.__setattr__(self, "accelerations", read_only(self.accelerations))

    def scaled(self, accelerations: Array) -> Demand:
        """The same with other accelerations."""
        return replace(self, accelerations=accelerations)

    @property
    def friction(self) -> Array:
        """The most that friction can take: its band at rest and viscous friction at full speed, N m, (n_joints,)."""
        laws = [law.known for law in self.robot.friction]
        dry = np.array([float(np.abs(law.band).max()) for law in laws])
        return np.asarray(dry + self.robot.viscous_friction * self.speeds)

    def parts(self, q: Array, row: int | slice = slice(None)) -> Array:
        """Torques by cause, each in N m: gravity's (and a wrench's), that of each joint's acceleration, then Coriolis'.

        Their signs are free, so the demand is the sum of their magnitudes.

        Returns
        -------
        ndarray, shape (n, n_parts) for one row, else (n, n_joints, n_parts)
        """
        still = np.zeros_like(q)
        gravity = rigid_torque(self.robot, q, still, still)
        own = [rigid_torque(self.robot, q, still, still + a) - gravity for a in np.diag(self.accelerations)]
        parts = [gravity, *own, *self._coriolis(q, gravity)]
        return np.stack([part[:, row] for part in parts], axis=-1)

    def _coriolis(self, q: Array, gravity: Array) -> list[Array]:
        """Torque of each joint's speed alone, and of each pair beyond that."""
        still = np.zeros_like(q)
        fast = {j: row for j, row in enumerate(np.diag(self.speeds)) if row.any()}
        alone = {j: rigid_torque(self.robot, q, still + v, still) - gravity for j, v in fast.items()}
        pairs = [
            rigid_torque(self.robot, q, still + fast[j] + fast[k], still) - gravity - alone[j] - alone[k]
            for j, k in combinations(fast, 2)
        ]
        return [*alone.values(), *pairs]

    def factors(self, q: Array) -> Array:
        """What the accelerations may be multiplied by at each pose, by joint; infinite without a torque limit.

        Returns
        -------
        ndarray, shape (n, n_joints)
            Negative where the arm cannot be held.
        """
        parts = self.parts(q)
        return self._factors(np.abs(parts) @ self._causes(parts.shape[-1]), slice(None))

    def least_factor(self, row: int, polynomial: PosePolynomial, values: Array) -> Array:
        """The least factor over control values of one row's parts, shape (n, n_control_points, n_parts)."""
        causes = self._causes(len(polynomial.remainder))
        demands = np.abs(values) @ causes[list(polynomial.quantities)] + polynomial.remainder @ causes
        return np.asarray(self._factors(demands, row).min(axis=1))

    def _causes(self, count: int) -> Array:
        """Which of so many parts the accelerations ask for and which not, shape (count, 2)."""
        is_inertia = (np.arange(count) >= 1) & (np.arange(count) <= self.robot.n_joints)
        return np.column_stack([is_inertia, ~is_inertia]).astype(float)

    def _factors(self, demands: Array, row: int | slice) -> Array:
        """Of demands by cause, shape (..., 2)."""
        inertia, others = demands[..., 0], demands[..., 1]
        effort = np.where(np.isnan(self.robot.limits.effort), np.inf, self.robot.limits.effort)
        left = (effort - self.friction)[row] - others
        return np.asarray(np.divide(left, inertia, out=np.full_like(left, np.inf), where=inertia > 0))
