"""What the rest after a motion asks for: the torque that holds the arm, at any speed of the motion before it."""

from __future__ import annotations

import numpy as np

from puma_septic.dynamics import payload_torque
from puma_septic.limit_check import LimitCheck
from puma_septic.limits._demands import Demand
from puma_septic.limits._drives import standstill_limits
from puma_septic.motion import Motion
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["added_holding_torque", "dwell_checks", "dwell_demands"]


def added_holding_torque(motion: Motion, per_kg: Array) -> Array:
    """What each kg of a payload adds to the torque that holds the arm at the last point, N m (N), shape (n_joints,).

    Returns
    -------
    ndarray
    """
    rest = np.zeros((1, motion.robot.n_joints))
    return np.asarray(payload_torque(motion.robot, per_kg)(_end(motion)[None], rest, rest)[0])


def dwell_demands(motion: Motion, dwell: float, *, per_kg: Array | None = None) -> list[Demand]:
    """Holding torque against the limits of joints and motors, the same at any rate; of so many kg of a payload too.

    Parameters
    ----------
    motion : Motion
    dwell : float
        s; none where it is 0.
    per_kg : ndarray, shape (10,), optional
        A payload of 1 kg, see `puma_septic.dynamics.payload_torque`; the demands are then functions of its mass.

    Returns
    -------
    list of Demand
    """
    if not dwell:
        return []
    end = float(motion.trajectory.breaks[-1])
    hold = Piecewise.constant(motion.rest(dwell).holding_torque, dwell, start=end)
    added = None if per_kg is None else Piecewise.constant(added_holding_torque(motion, per_kg), dwell, start=end)
    robot = motion.robot
    rows = [("effort", np.ones(robot.n_joints), np.where(robot.knows_torque, robot.limits.effort, np.nan))]
    rows += [(quantity, factor, limit) for quantity, _, factor, limit in standstill_limits(robot)]
    demands = [
        Demand.of(quantity, (hold * factor, None if added is None else added * factor), limit)
        for quantity, factor, limit in rows
    ]
    return [demand for demand in demands if demand is not None]


def dwell_checks(motion: Motion, dwell: float) -> list[LimitCheck]:
    """What the motors are asked for in the rest, held against what they bear; the joints' own limits are assessed."""
    if not dwell:
        return []
    robot, size = motion.robot, np.abs(motion.rest(dwell).holding_torque)
    return [
        LimitCheck.of_magnitude(
            joint=robot.joint_names[j], quantity=quantity, unit=unit, demand=float(size[j] * factor[j]),
            limit=float(limit[j]), time=float(motion.trajectory.breaks[-1]), kind="physics",
            source=robot.drivetrains[j].motor.source,
        )
        for quantity, unit, factor, limit in standstill_limits(robot)
        for j in np.flatnonzero(~np.isnan(limit)).tolist()
    ]  # fmt: skip


def _end(motion: Motion) -> Array:
    return motion.trajectory(motion.trajectory.breaks[-1])
