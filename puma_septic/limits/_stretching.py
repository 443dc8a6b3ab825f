"""A motion stretched in time, and its torque as a polynomial of the rate.

A motion that takes k times as long passes the same positions with velocities divided by k, accelerations by k^2 and
jerks by k^3. With the rate u = 1/k the torque of each joint at each place on the path is ``S + V u + D u^2``: S
gravity, Coulomb friction and wrench, V viscous friction, D inertia and Coriolis. Less speed is no remedy for S, and not
always a help: an arm that brakes on its way up carries less than one that stands.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import final

import numpy as np

from puma_septic.dynamics import check_plain_friction, payload_torque, rigid_torque
from puma_septic.motion import Motion
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_number

__all__ = [
    "LoadTorque",
    "RateTorque",
    "load_torque",
    "rate_torque",
    "split_torque",
    "stretched",
]


def stretched(trajectory: Trajectory, factor: float) -> Trajectory:
    """The same motion, `factor` times as long, from the same instant.

    Returns
    -------
    Trajectory
    """
    return trajectory.stretched(checked_number("factor", factor, above=0.0))


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RateTorque:
    """The torque ``S + V u + D u^2`` of a motion at the rate u, over its original time.

    Attributes
    ----------
    still, viscous, inertial : Piecewise
        S, V and D, on the same breaks.
    coulomb : Piecewise
        The part of S that steps.
    """

    still: Piecewise
    viscous: Piecewise
    inertial: Piecewise
    coulomb: Piecewise

    def at(self, rate: float) -> Piecewise:
        """The torque at a rate."""
        return self.still + self.viscous * rate + self.inertial * rate**2


def rate_torque(motion: Motion) -> RateTorque:
    """S, V and D of a motion whose friction is viscous plus constant."""
    robot, n = motion.robot, motion.robot.n_joints
    check_plain_friction(robot, "the torque of a motion at another speed")
    rigid = split_torque(motion.trajectory, partial(rigid_torque, robot))
    still = rigid[:n] + motion.coulomb
    return RateTorque(
        still=still,
        viscous=(motion.trajectory.derivative(1) * robot.viscous_friction).aligned_with(still),
        inertial=rigid[n:].aligned_with(still),
        coulomb=motion.coulomb.aligned_with(still),
    )


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoadTorque:
    """What each kg of a payload adds at the rate u, ``S + D u^2``, over the motion's original time."""

    still: Piecewise
    inertial: Piecewise

    def at(self, rate: float) -> Piecewise:
        """Per kg, at a rate."""
        return self.still + self.inertial * rate**2


def load_torque(robot: Robot, trajectory: Trajectory, per_kg: Array) -> LoadTorque:
    """Of a payload with these ten parameters per kg; see `payload_torque`."""
    parts = split_torque(trajectory, payload_torque(robot, per_kg))
    n = robot.n_joints
    return LoadTorque(still=parts[:n], inertial=parts[n:])


def split_torque(trajectory: Trajectory, torque: Callable[[Array, Array, Array], Array]) -> Piecewise:
    """The torque at rest in each posture, and what the motion adds to it, side by side."""
    n = trajectory.n_joints

    def split(state: Array) -> Array:
        q, v, a = (state[:, k * n : (k + 1) * n] for k in range(3))
        rest = np.zeros_like(q)
        still = torque(q, rest, rest)
        return np.concatenate([still, torque(q, v, a) - still], axis=1)

    return trajectory.state.mapped(split)
