"""Demands checked against the limits of a robot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from puma_septic.limit_check import LimitCheck
from puma_septic.piecewise import Extrema
from puma_septic.quantities import MAGNITUDES, QUANTITIES
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["limit_checks", "unknown_values"]


def limit_checks(robot: Robot, position: Extrema, demands: Mapping[str, tuple[Array, Array]]) -> tuple[LimitCheck, ...]:
    """Every demand whose limit is known or that no arm can meet, joint by joint.

    `demands` maps a quantity to magnitudes and instants; a demand that is not known (NaN) is checked against nothing.
    """
    checks = []
    for j in range(robot.n_joints):
        if not np.isnan(robot.limits.position[j]).all():
            checks.append(_position_check(robot, j, position))
        for name, (demand, time) in demands.items():
            limit = float(getattr(robot.limits, name)[j])
            if np.isnan(demand[j]):
                continue
            if not np.isnan(limit) or (QUANTITIES[name].is_hard and np.isinf(demand[j])):
                checks.append(
                    LimitCheck.of_magnitude(
                        joint=robot.joint_names[j],
                        quantity=name,
                        demand=float(demand[j]),
                        limit=limit,
                        unit=QUANTITIES[name].unit(robot.is_prismatic[j]),
                        time=float(time[j]),
                        source=robot.limits.source,
                    )
                )
    return tuple(checks)


def _position_check(robot: Robot, j: int, position: Extrema) -> LimitCheck:
    lower, upper = robot.limits.position[j].tolist()
    return LimitCheck.of_position(
        joint=robot.joint_names[j],
        bounds=(lower, upper),
        reach=(float(position.min[j]), float(position.max[j])),
        times=(float(position.t_min[j]), float(position.t_max[j])),
        unit=QUANTITIES["position"].unit(robot.is_prismatic[j]),
        source=robot.limits.source,
    )


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
