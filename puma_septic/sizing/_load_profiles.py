"""Loads as samples, for the design tools of motor makers."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import final

import numpy as np

from puma_septic.sizing._loads import JointLoad, MotorLoad
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_number

__all__ = ["LoadProfile", "MotorLoadProfile", "sampled_load", "sampled_motor"]

_RPM = 60 / (2 * np.pi)
# A torque that differs on the two sides of an instant by less than this part of its largest does not step there.
_STEP = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MotorLoadProfile:
    """One motor's load as samples, the form that the design tools of motor makers read.

    Attributes
    ----------
    joint : str
    time : ndarray, shape (n,)
        s. Reversals, changes between motoring and braking and the ends of steps are among them; where the torque steps,
        the value after the step.
    speed_rpm, torque : ndarray, shape (n,)
        1/min and N m at the shaft, in the joint's direction.
    """

    joint: str
    time: Array
    speed_rpm: Array
    torque: Array


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoadProfile:
    """One joint's load at the gearbox's output as samples, without rotor, gears and friction.

    The form in which the tools of motor makers ask for a load, which add their own motor and gears to it.

    Attributes
    ----------
    joint : str
    is_prismatic : bool
        Then m, m/s, N and kg.
    time : ndarray, shape (n,)
        s. Reversals and the ends of steps are among them; where the torque steps, one instant is there twice, before
        and after.
    position, speed, torque, inertia : ndarray, shape (n,)
        rad, rad/s, N m, and ``M_jj`` in kg m^2.
    """

    joint: str
    is_prismatic: bool
    time: Array
    position: Array
    speed: Array
    torque: Array
    inertia: Array


def sampled_motor(joint: str, motor: MotorLoad, *, step: float) -> MotorLoadProfile:
    """A motor's torque and speed at most `step` seconds apart.

    Returns
    -------
    MotorLoadProfile
    """
    step = checked_number("step", step, unit="s", above=0.0)
    breaks = motor.torque.breaks
    counts = np.maximum(1, np.ceil(np.diff(breaks) / step - 1e-9)).astype(int)
    parts = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(breaks[:-1], breaks[1:], counts, strict=True)]
    time = np.concatenate([*parts, breaks[-1:]])
    return MotorLoadProfile(
        joint=joint, time=time, speed_rpm=motor.speed(time)[:, 0] * _RPM, torque=motor.torque(time)[:, 0]
    )


def sampled_load(load: JointLoad, trajectory: Trajectory, j: int, *, step: float) -> LoadProfile:
    """The load of joint j of a trajectory at most `step` seconds apart, with both values where its torque steps.

    Returns
    -------
    LoadProfile
    """
    step = checked_number("step", step, unit="s", above=0.0)
    left, right = load.torque.ends()
    parts = []
    for k, (start, end) in enumerate(pairwise(load.torque.breaks.tolist())):
        inner = np.linspace(start, end, max(1, int(np.ceil((end - start) / step - 1e-9))) + 1)[1:-1]
        torque = [left[k, 0], *load.torque(inner)[:, 0], right[k, 0]]
        parts.append(np.column_stack([[start, *inner, end], torque]))
    time, torques = np.concatenate(parts).T
    steps = np.abs(np.diff(torques)) > _STEP * np.abs(torques).max()
    is_new = np.append(True, (np.diff(time) > 0) | steps)
    time, torques = time[is_new], torques[is_new]
    return LoadProfile(
        joint=load.joint,
        is_prismatic=load.is_prismatic,
        time=time,
        position=trajectory(time)[:, j],
        speed=load.velocity(time)[:, 0],
        torque=torques,
        inertia=load.inertia(time)[:, 0],
    )
