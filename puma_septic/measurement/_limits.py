"""Limits that a recorded motion may keep or break: what its samples leave unknown is more than the margin."""

from __future__ import annotations

from typing import Final

import numpy as np

from puma_septic.logs import LogFit
from puma_septic.measurement._band import TorqueBand
from puma_septic.motion import Motion
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["limit_doubts"]

_SIGMAS: Final = 4.0
_UNITS: Final = {"velocity": "rad/s", "acceleration": "rad/s^2", "jerk": "rad/s^3", "torque": "N m"}
_SLIDING: Final = {"velocity": "m/s", "acceleration": "m/s^2", "jerk": "m/s^3", "torque": "N"}


def limit_doubts(motion: Motion, fit: LogFit, band: TorqueBand) -> tuple[str, ...]:
    """Why no verdict is possible: limits that lie within what the samples leave unknown of the peak.

    Of the torque that is its band; of velocity, acceleration and jerk four standard deviations of the fit, and what it
    may miss between the samples.
    """
    robot, trajectory = motion.robot, motion.trajectory
    limits = robot.limits
    known = {1: ("velocity", limits.velocity), 2: ("acceleration", limits.acceleration), 3: ("jerk", limits.jerk)}
    cause = "noise" if fit.noise.any() else "samples"
    found = []
    for order, (quantity, bounds) in known.items():
        if np.isnan(bounds).all():
            continue
        peak, off = trajectory.peak(order)[0], _SIGMAS * fit.spread.deviation(order) + fit.spread.missed(order)
        found += _within(robot, quantity, np.array([peak - off, peak + off]), bounds, cause)
    return (*found, *_within(robot, "torque", band.peak, limits.effort, cause))


def _within(robot: Robot, quantity: str, peaks: Array, limits: Array, cause: str) -> list[str]:
    """Joints whose limit is neither surely kept nor surely violated; an unknown limit is not in question."""
    found = []
    for j, (least, greatest) in enumerate(peaks.T):
        if least <= limits[j] < greatest:
            unit = (_SLIDING if robot.is_prismatic[j] else _UNITS)[quantity]
            found.append(
                f"{cause}: the peak {quantity} of joint {robot.joint_names[j]!r} is between {least:.4g} and"
                f" {greatest:.4g} {unit}, its limit is {limits[j]:.4g} {unit}"
            )
    return found
