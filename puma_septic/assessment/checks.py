"""Demands held against limits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from puma_septic.checks import Array
from puma_septic.limit_check import AT_LIMIT
from puma_septic.piecewise import Extrema
from puma_septic.robot import Robot

__all__ = ["QUANTITIES", "UNITS", "LimitCheck", "limit_checks", "unknown_values"]

QUANTITIES: Final = ("position", "velocity", "acceleration", "jerk", "effort")
UNITS: Final = {
    "position": ("rad", "m"),
    "velocity": ("rad/s", "m/s"),
    "acceleration": ("rad/s^2", "m/s^2"),
    "jerk": ("rad/s^3", "m/s^3"),
    "effort": ("N m", "N"),
}
# No arm can follow these where they are infinite, whatever its limits; an infinite jerk it smooths.
_IMPOSSIBLE: Final = ("acceleration", "effort")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LimitCheck:
    """One demand of one joint held against one limit.

    Attributes
    ----------
    joint : str
    quantity : str
        "position", "velocity", "acceleration", "jerk" or "effort".
    demand : float
        The magnitude asked for, infinite where unbounded; for positions the extreme position.
    limit : float
        The magnitude allowed; for positions the bound nearest to being broken. NaN where it is not known and the
        demand, an infinite acceleration or effort, exceeds whatever it is.
    unit : str
    time : float
        Instant of the demand, s.
    margin : float
        ``1 - demand / limit``, ``-inf`` for an infinite demand; for positions the distance to the bound in rad (or m).
        Negative where violated.
    utilisation : float
        ``demand / limit``; for positions the distance from the middle of the range over half the range (where only one
        bound is known: 0 within it, infinite beyond).
    """

    joint: str
    quantity: str
    demand: float
    limit: float
    unit: str
    time: float
    margin: float
    utilisation: float

    @property
    def is_violated(self) -> bool:
        """Whether the demand exceeds the limit by more than `limit_check.AT_LIMIT`."""
        return not self.margin >= -AT_LIMIT

    @property
    def limit_text(self) -> str:
        """The limit in words."""
        return "whatever the limit" if np.isnan(self.limit) else f"limit {self.limit:.4g} {self.unit}"

    def __str__(self) -> str:
        if np.isinf(self.demand):
            return f"{self.joint} {self.quantity} unbounded at t = {self.time:.4g} s, {self.limit_text}"
        what = f"{self.joint} {self.quantity} {self.demand:.4g} {self.unit} at t = {self.time:.4g} s"
        if self.quantity == "position":
            side = "beyond" if self.is_violated else "from"
            return f"{what} is {abs(self.margin):.4g} {self.unit} {side} its bound {self.limit:.4g} {self.unit}"
        return f"{what} is {100 * self.utilisation:.4g} % of {self.limit:.4g} {self.unit}"


def limit_checks(robot: Robot, position: Extrema, demands: Mapping[str, tuple[Array, Array]]) -> tuple[LimitCheck, ...]:
    """Every demand whose limit is known or that no arm can meet, joint by joint.

    `demands` maps a quantity to magnitudes and instants.
    """
    checks = []
    for j, joint in enumerate(robot.joint_names):
        if not np.isnan(robot.limits.position[j]).all():
            checks.append(_position_check(robot, j, position))
        for quantity, (demand, time) in demands.items():
            limit = float(getattr(robot.limits, quantity)[j])
            impossible = quantity in _IMPOSSIBLE and np.isinf(demand[j])
            if impossible or not np.isnan(limit):
                utilisation = np.inf if impossible else float(demand[j]) / limit
                checks.append(
                    LimitCheck(
                        joint=joint,
                        quantity=quantity,
                        demand=float(demand[j]),
                        limit=limit,
                        unit=UNITS[quantity][int(robot.is_prismatic[j])],
                        time=float(time[j]),
                        margin=1 - utilisation,
                        utilisation=utilisation,
                    )
                )
    return tuple(checks)


def _position_check(robot: Robot, j: int, position: Extrema) -> LimitCheck:
    """The bound that a joint comes nearest to, or exceeds most."""
    lower, upper = robot.limits.position[j]
    below, above = position.min[j] - lower, upper - position.max[j]
    at_lower = np.isnan(above) or below < above
    demand, time, limit, margin = (
        (position.min[j], position.t_min[j], lower, below)
        if at_lower
        else (position.max[j], position.t_max[j], upper, above)
    )
    utilisation = abs(demand - (lower + upper) / 2) / ((upper - lower) / 2)
    if np.isnan(utilisation):
        utilisation = 0.0 if margin >= -AT_LIMIT else np.inf
    return LimitCheck(
        joint=robot.joint_names[j],
        quantity="position",
        demand=float(demand),
        limit=float(limit),
        unit=UNITS["position"][int(robot.is_prismatic[j])],
        time=float(time),
        margin=float(margin),
        utilisation=float(utilisation),
    )


def unknown_values(robot: Robot) -> tuple[str, ...]:
    """What cannot be assessed because it is not known, one line per quantity with the joints concerned."""
    limits, actuators = robot.limits, robot.actuators
    # A continuous joint has no position limit to know.
    unknown: dict[str, Any] = {
        "position limit": np.isnan(limits.position).any(axis=1) & ~robot.is_continuous,
        "velocity limit": np.isnan(limits.velocity),
        "acceleration limit": np.isnan(limits.acceleration),
        "jerk limit": np.isnan(limits.jerk),
        "effort limit": np.isnan(limits.effort),
        "rotor inertia (its torque is left out)": np.isnan([actuator.armature for actuator in actuators]),
        "viscous friction (its torque is left out)": np.isnan([actuator.viscous_friction for actuator in actuators]),
        "Coulomb friction (its torque is left out)": np.isnan(
            [actuator.coulomb_friction for actuator in actuators]
        ).any(axis=1),
    }
    lines = []
    for what, mask in unknown.items():
        if mask.any():
            joints = [name for name, missing in zip(robot.joint_names, mask, strict=True) if missing]
            lines.append(f"{what}: unknown for {'all joints' if mask.all() else ', '.join(joints)}")
    return tuple(lines)
