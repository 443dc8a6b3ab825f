"""Control laws: the torque that a controller commands from what it is to follow and what it measures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

import numpy as np

from puma_septic.dynamics import rigid_torque
from puma_septic.friction import friction_terms
from puma_septic.robot import Robot
from puma_septic.simulation._controller import Gains
from puma_septic.simulation._reference import Reference
from puma_septic.validation import Array

__all__ = ["TORQUE", "ControlLaw", "planned_torque", "smooth_friction"]

ControlLaw = Callable[[Robot, Gains, Reference, Array, Array, Array], Array]
"""Torque (n_rows, n_joints) by model, gains, reference, planned torque, and measured position and velocity."""


def smooth_friction(robot: Robot, v: Array, rest_speed: float) -> Array:
    """The friction law with its step at rest made smooth: the way is ``tanh(v / rest_speed)``."""
    terms = friction_terms(robot.friction, v, np.tanh(v / rest_speed))
    return terms["viscous"] + terms["coulomb"]


def planned_torque(model: Robot, reference: Reference, rest_speed: float) -> Array:
    """What the planned motion needs by the controller's model, shape of the reference."""
    q, v, a = (values.reshape(-1, values.shape[-1]) for values in reference)
    return (rigid_torque(model, q, v, a) + smooth_friction(model, v, rest_speed)).reshape(reference.q.shape)


def _none(_model: Robot, _gains: Gains, want: Reference, _planned: Array, _q: Array, _v: Array) -> Array:
    return np.zeros_like(want.q)


def _pd(_model: Robot, gains: Gains, want: Reference, _planned: Array, q: Array, v: Array) -> Array:
    return gains.proportional * (want.q - q) + gains.derivative * (want.v - v)


def _pd_gravity(model: Robot, gains: Gains, want: Reference, planned: Array, q: Array, v: Array) -> Array:
    rest = np.zeros_like(q)
    return _pd(model, gains, want, planned, q, v) + rigid_torque(model, q, rest, rest)


def _feedforward(model: Robot, gains: Gains, want: Reference, planned: Array, q: Array, v: Array) -> Array:
    return _pd(model, gains, want, planned, q, v) + planned


def _computed_torque(model: Robot, gains: Gains, want: Reference, planned: Array, q: Array, v: Array) -> Array:
    """`planned` is the friction of the planned velocity alone."""
    return rigid_torque(model, q, v, want.a + _pd(model, gains, want, planned, q, v)) + planned


TORQUE: Final[Mapping[str, ControlLaw]] = MappingProxyType(
    {
        "none": _none,
        "pd": _pd,
        "pid": _pd,  # the integral is added where it is kept
        "pd_gravity": _pd_gravity,
        "feedforward": _feedforward,
        "computed_torque": _computed_torque,
    }
)
"""The torque of each law of `LAWS`."""
