"""What accelerations, speeds and a pose ask of each joint, against its torque limit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations
from typing import final

import numpy as np

from puma_septic.dynamics import rigid_torque
from puma_septic.robot import Robot
from puma_septic.validation import Array, read_only

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
        return self._factors(self.parts(q), np.zeros(1), slice(None))

    def least_factor(self, row: int, remainder: Array, values: Array) -> Array:
        """The least factor over control values, shape (n, n_control_points, n_parts), of one row."""
        return np.asarray(self._factors(values, remainder, row).min(axis=1))

    def _factors(self, parts: Array, remainder: Array, row: int | slice) -> Array:
        n = self.robot.n_joints
        sizes = np.abs(parts) + remainder
        inertia = sizes[..., 1 : 1 + n].sum(axis=-1)
        others = sizes[..., 0] + sizes[..., 1 + n :].sum(axis=-1)
        effort = np.where(np.isnan(self.robot.limits.effort), np.inf, self.robot.limits.effort)
        left = (effort - self.friction)[row] - others
        return np.asarray(np.divide(left, inertia, out=np.full_like(left, np.inf), where=inertia > 0))
