"""Demands checked against the limits of a robot; whether a motion's points are in the unit they are taken for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isinf, isnan
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.limit_check import LimitCheck
from puma_septic.piecewise import Extrema
from puma_septic.quantities import MAGNITUDES, QUANTITIES
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["limit_checks", "unit_doubts", "unknown_values"]


def limit_checks(robot: Robot, position: Extrema, demands: Mapping[str, tuple[Array, Array]]) -> tuple[LimitCheck, ...]:
    """Every demand whose limit is known or that no arm can meet, joint by joint.

    `demands` maps a quantity to magnitudes and instants; a demand that is not known (NaN) is checked against nothing.
    """
    limits, source, checks = robot.limits, robot.limits.source, []
    # As lists: numbers of an array cost more than all that is done with them here.
    rows = [(name, QUANTITIES[name], getattr(limits, name).tolist(), *_lists(demands[name])) for name in demands]
    bounds, reach = limits.position.tolist(), list(zip(*_lists((position.min, position.max)), strict=True))
    times = list(zip(*_lists((position.t_min, position.t_max)), strict=True))
    for j, (joint, is_prismatic) in enumerate(zip(robot.joint_names, robot.is_prismatic.tolist(), strict=True)):
        if not all(map(isnan, bounds[j])):
            unit = QUANTITIES["position"].unit(is_prismatic)
            checks.append(
                LimitCheck.of_position(
                    joint=joint, bounds=tuple(bounds[j]), reach=reach[j], times=times[j], unit=unit, source=source
                )
            )
        for name, row, limit, demand, time in rows:
            if isnan(demand[j]) or (isnan(limit[j]) and not (row.is_hard and isinf(demand[j]))):
                continue
            unit = row.unit(is_prismatic)
            checks.append(
                LimitCheck.of_magnitude(
                    joint=joint, quantity=name, demand=demand[j], limit=limit[j], unit=unit, time=time[j], source=source
                )
            )
    return tuple(checks)


def _lists(arrays: Iterable[Array]) -> list[Any]:
    return [array.tolist() for array in arrays]


def unknown_values(robot: Robot) -> tuple[str, ...]:
    """What cannot be assessed because it is not known, one line per quantity with the joints concerned."""
    limits, friction = robot.limits, robot.friction
    # A continuous joint has no position limit to know.
    unknown: dict[str, Any] = {
        "torque (the URDF has no usable inertia for what the joint moves)": ~robot.knows_torque,
        "position limit": np.isnan(limits.position).any(axis=1) & ~robot.is_continuous,
        **{f"{name} limit": np.isnan(getattr(limits, name)) for name in limits.quantities if name in MAGNITUDES},
        "rotor inertia (its torque is left out)": np.array([not train.knows_inertia for train in robot.drivetrains]),
        "viscous friction (its torque is left out)": np.isnan([law.viscous for law in friction]),
        "Coulomb friction (its torque is left out)": np.isnan([law.coulomb for law in friction]).any(axis=1),
    }
    lines = []
    for what, mask in unknown.items():
        if mask.any():
            joints = [name for name, missing in zip(robot.joint_names, mask, strict=True) if missing]
            lines.append(f"{what}: unknown for {'all joints' if mask.all() else ', '.join(joints)}")
    return tuple(lines)


# Two turns of a revolute joint outside its bounds, rad: a plan that misses its bounds misses them by less.
_BEYOND_BOUNDS: Final = 4 * np.pi
# More than three turns, rad, where no bounds are known: what arms with cables inside do not do.
_MOST_TURNED: Final = 20.0


def unit_doubts(robot: Robot, trajectory: Trajectory) -> tuple[str, ...]:
    """Ask whether points far out of a revolute joint's bounds are degrees; the joint farthest out is named.

    Points are judged, not what a profile swings between them. A continuous joint may turn as far as it likes.
    """
    lower, upper = robot.limits.position.T
    least, greatest = trajectory.points.min(axis=0), trajectory.points.max(axis=0)
    reach = np.maximum(greatest, -least)
    outside: NDArray[np.bool_] = (least < lower) | (greatest > upper)
    unbounded = np.isnan(lower) & np.isnan(upper)
    odd: NDArray[np.bool_] = (outside & (reach > _BEYOND_BOUNDS)) | (unbounded & (reach > _MOST_TURNED))
    odd &= ~(robot.is_prismatic | robot.is_continuous)
    if not odd.any():
        return ()
    j = int(np.argmax(np.where(odd, reach, 0.0)))
    bounds = "" if unbounded[j] else f", its bounds are [{lower[j]:.3g}, {upper[j]:.3g}] rad"
    return (
        f"points in degrees? {robot.joint_names[j]} reaches {reach[j]:.4g} rad, {reach[j] / (2 * np.pi):.3g} turns"
        f"{bounds}; {reach[j]:.4g} deg would be {np.radians(reach[j]):.3g} rad, and a"
        " task file takes them as joints_deg",
    )
