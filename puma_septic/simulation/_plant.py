"""The arm as it moves under torques: rigid, or with elastic gears, with the friction law made smooth at rest.

A state has the shape (n_parts, n_rows, n_joints): position and velocity of the links, the work of the actuators,
what friction and a wrench take; of an elastic arm also position and velocity of the motors, at the joint.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.dynamics import acceleration_function, mass_matrix, potential_energy, rigid_torque
from puma_septic.errors import InputError
from puma_septic.friction import friction_function
from puma_septic.robot import Actuator, Robot
from puma_septic.simulation._elasticity import ElasticJoints
from puma_septic.validation import Array, checked_kind

__all__ = ["LOSS", "POSITION", "VELOCITY", "WORK", "Plant"]

POSITION, VELOCITY, WORK, LOSS, _MOTOR, _MOTOR_VELOCITY = range(6)
# The largest product of a rate and the step with which RK4 follows a decay well: e^-1.5 is met within 8 %.
_WELL: Final = 1.5


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Plant:
    """Several arms of one kind, one a row.

    Attributes
    ----------
    robot : Robot
    links : Robot
        The same without rotors and friction.
    rest_speed : float
        rad/s (m/s) over which dry friction rises from 0.
    elastic : tuple of ElasticJoints, or empty
        One a row.
    stiffness, damping : ndarray, shape (n_rows, n_joints)
        Theirs; empty of a rigid arm.
    acceleration, friction : callable
        Of the links under torques, and of the joints by velocity and way.
    """

    robot: Robot
    links: Robot
    rest_speed: float
    elastic: tuple[ElasticJoints, ...]
    stiffness: Array
    damping: Array
    acceleration: Callable[[Array, Array, Array], Array]
    friction: Callable[[Array, Array], Array]

    @classmethod
    def of(cls, robot: Robot, elastic: tuple[ElasticJoints, ...], rest_speed: float) -> Plant:
        """The plant, where the robot is known well enough."""
        if robot.has_losses:
            raise InputError(
                f"a simulation knows no gears that lose a part of their load, as robot {robot.name!r} has: what they"
                " lose depends on the acceleration"
            )
        if elastic and not (robot.armature > 0).all():
            names = [name for name, inertia in zip(robot.joint_names, robot.armature, strict=True) if not inertia > 0]
            raise InputError(
                f"elastic joints need the rotor's inertia of every joint; it is not known of {', '.join(names)}"
            )
        for one in elastic:
            if len(checked_kind("elastic", one, ElasticJoints).stiffness) != robot.n_joints:
                raise InputError(
                    f"elastic joints: {len(one.stiffness)} given, robot {robot.name!r} has {robot.n_joints}"
                )
        links = robot.with_actuators([Actuator()] * robot.n_joints) if elastic else robot
        return cls(
            robot=robot,
            links=links,
            rest_speed=rest_speed,
            elastic=elastic,
            stiffness=np.array([one.stiffness for one in elastic]),
            damping=np.array([one.damping for one in elastic]),
            acceleration=acceleration_function(links),
            friction=friction_function(robot.friction),
        )

    @property
    def motor(self) -> slice:
        """Where a state has position and velocity of the motors, which a controller sees."""
        return slice(_MOTOR, _MOTOR_VELOCITY + 1) if self.elastic else slice(POSITION, VELOCITY + 1)

    def state(self, q: Array, v: Array) -> Array:
        """The state at a posture and velocity, shape (n_rows, n_joints) each; elastic gears carry the weight."""
        nothing = np.zeros_like(q)
        parts = [q, v, nothing, nothing]
        if self.elastic:
            weight = rigid_torque(self.links, q, nothing, nothing)
            parts += [q + weight / self.stiffness, v]
        return np.stack(parts)

    def slope(self, state: Array, tau: Array) -> Array:
        """The derivative of the state under actuator torques, shape (n_rows, n_joints)."""
        return self._elastic_slope(state, tau) if self.elastic else self._rigid_slope(state, tau)

    def _rigid_slope(self, state: Array, tau: Array) -> Array:
        q, v = state[POSITION], state[VELOCITY]
        friction = self.friction(v, np.tanh(v / self.rest_speed))
        result = np.empty_like(state)
        result[POSITION] = v
        result[VELOCITY] = self.acceleration(q, v, tau - friction)
        self._account(result, tau, v, friction * v + self._wrench_power(q, v))
        return result

    def _elastic_slope(self, state: Array, tau: Array) -> Array:
        q, v, motor, motor_v = state[POSITION], state[VELOCITY], state[_MOTOR], state[_MOTOR_VELOCITY]
        damped = self.damping * (motor_v - v)
        spring = self.stiffness * (motor - q) + damped
        friction = self.friction(motor_v, np.tanh(motor_v / self.rest_speed))
        result = np.empty_like(state)
        result[POSITION] = v
        result[VELOCITY] = self.acceleration(q, v, spring)
        result[_MOTOR] = motor_v
        result[_MOTOR_VELOCITY] = (tau - spring - friction) / self.robot.armature
        taken = friction * motor_v + damped * (motor_v - v) + self._wrench_power(q, v)
        self._account(result, tau, motor_v, taken)
        return result

    def _account(self, result: Array, tau: Array, v: Array, taken: Array) -> None:
        result[WORK] = tau * v
        result[LOSS] = taken

    def _wrench_power(self, q: Array, v: Array) -> Array | float:
        """What the tool does to the world."""
        if self.robot.wrench is None:
            return 0.0
        rest = np.zeros_like(q)
        free = self.robot.with_wrench(None)
        return np.asarray((rigid_torque(self.robot, q, rest, rest) - rigid_torque(free, q, rest, rest)) * v)

    def largest_step(self, q: Array) -> float:
        """The step with which the fastest decay or swing in a posture, shape (n_joints,), is followed well, s."""
        mobility = np.diagonal(np.linalg.inv(mass_matrix(self.links, q[None])[0]))
        inverse_rotor = 1 / self.robot.armature if self.elastic else mobility
        band = np.abs([law.band for law in self.robot.friction]).max(axis=1) / self.rest_speed
        rates = [float(((band + self.robot.viscous_friction) * inverse_rotor).max())]
        for one in self.elastic:
            both = mobility + inverse_rotor
            rates += [float(np.sqrt(one.stiffness * both).max()), float((one.damping * both).max())]
        return float(_WELL / max(rates)) if max(rates) > 0 else np.inf

    def energy(self, states: Array) -> Array:
        """Kinetic, potential and elastic energy of states (n, n_parts, n_joints) of one row, J, shape (n, 3)."""
        q, v = states[:, POSITION], states[:, VELOCITY]
        rest = np.zeros_like(q)
        free = self.links.with_wrench(None)
        moved = rigid_torque(free, q, rest, v) - rigid_torque(free, q, rest, rest)  # M(q) v
        kinetic = (moved * v).sum(axis=1) / 2
        elastic = np.zeros(len(q))
        if self.elastic:
            motor, motor_v = states[:, _MOTOR], states[:, _MOTOR_VELOCITY]
            kinetic = kinetic + (self.robot.armature * motor_v**2).sum(axis=1) / 2
            elastic = (self.elastic[0].stiffness * (motor - q) ** 2).sum(axis=1) / 2
        return np.column_stack([kinetic, potential_energy(free, q), elastic])
