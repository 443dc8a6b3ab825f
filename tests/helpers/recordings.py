"""A motion of the PUMA with known torque, and logs of it as machines write them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import puma_septic as ps
from puma_septic.trajectory import Trajectory

Array = NDArray[np.float64]

POINTS = np.array([
    [0.0, 0.6, -2.2, 0.0, 0.3, 0.0],
    [0.4, 1.2, -2.6, 0.2, 0.6, 0.1],
    [1.5, 1.2, -2.6, 0.3, 0.6, 0.5],
    [1.9, 0.6, -2.2, 0.0, 0.3, 0.0],
])  # fmt: skip
MOVE = ps.profiles.quintic_spline(POINTS, [0.0, 1.2, 2.4, 3.6])
# Of a 17-bit encoder at the joint, rad.
ENCODER_STEP = 2 * np.pi / 2**17


def recorded(
    move: Trajectory,
    rate: float,
    *,
    noise: float = 0.0,
    jitter: float = 0.0,
    step: float = 0.0,
    rest: float = 0.0,
    seed: int = 0,
) -> tuple[Array, Array]:
    """Stamps and positions of a motion, with rests around it.

    `noise` is white, rad; `jitter` the range of the stamps as part of the step of time; `step` that of an encoder.
    """
    rng = np.random.default_rng(seed)
    duration = move.duration + 2 * rest
    n = round(duration * rate) + 1
    t = np.linspace(0.0, duration, n)
    q = move(np.clip(t - rest, 0.0, move.duration))
    stamps = t.copy()
    stamps[1:-1] += jitter * rng.uniform(-0.5, 0.5, n - 2) / rate
    q = q + noise * rng.standard_normal(q.shape)
    return stamps, np.round(q / step) * step if step else q


def true_torque(robot: ps.Robot, move: Trajectory, rest: float = 0.0) -> tuple[Array, Array]:
    """Peak and RMS torque of a motion with rests around it, in which the arm is held without friction."""
    assessment, zero = ps.assess(robot, move), np.zeros(robot.n_joints)
    held = np.array([ps.inverse_dynamics(robot, move(t), zero, zero) for t in move.breaks[[0, -1]]])
    square = assessment.rms_torque**2 * move.duration + rest * (held**2).sum(axis=0)
    peak = np.vstack([assessment.peak_torque, np.abs(held)]).max(axis=0) if rest else assessment.peak_torque
    return peak, np.sqrt(square / (move.duration + 2 * rest))
