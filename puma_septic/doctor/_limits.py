"""Limits as placeholders, in other units, or below what the arm's own weight asks for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi
from typing import Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.doctor._finding import Finding, Severity
from puma_septic.dynamics import inverse_dynamics
from puma_septic.quantities import QUANTITIES
from puma_septic.robot import Robot
from puma_septic.validation import Array
from puma_septic.worst_case import checked_region, holding_poses

__all__ = ["limit_findings"]

Flags = NDArray[np.bool_]

# rad/s: small SCARA and delta wrists turn at 2000 to 3000 deg/s at most, 52 rad/s; m/s for what slides.
_FASTEST, _FASTEST_SLIDE = 53.0, 20.0
# rad/s, of the median joint: 2000 deg/s, where the quickest industrial arms have some 700 and legs (Unitree's, by
# example-robot-data) 30 rad/s; the slowest arms have 40 deg/s.
_FASTEST_MEDIAN: Final = 35.0
# rad/s (m/s): 0.6 deg/s.
_SLOWEST: Final = 0.01
# rad, m: beyond two turns; no arm's axis is longer.
_WIDEST, _LONGEST = 4 * pi, 20.0
# rad (m).
_NARROW: Final = 0.01
# From which the worst pose of each joint is sought, of an arm of six.
_STARTS: Final = 24
# Joints from which on equal limits are no chance.
_FEW: Final = 4
# Joints one behind another that no maker gives the same torque: legs have three, and fingers four, of one motor.
_CHAIN: Final = 5


def limit_findings(robot: Robot) -> Iterator[Finding]:
    """What is odd in the limits."""
    yield from _efforts(robot)
    yield from _weight(robot)
    yield from _velocities(robot)
    yield from _positions(robot)


def _efforts(robot: Robot) -> Iterator[Finding]:
    effort = robot.limits.effort
    yield from _listed(robot, "no_effort", "no effort limit (or 0)", np.isnan(effort))
    # A force of 1000 N is nothing special, a torque of 1000 N m is.
    suspects = _is_placeholder(effort, 1e3) & ~robot.is_prismatic
    yield from _listed(robot, "effort_placeholder", "effort limit, a placeholder?", suspects, effort)
    if _all_equal(effort) and _longest_chain(robot) >= _CHAIN:
        message = f"all {len(effort)} joints have the same effort limit, {effort[0]:.4g} N m: a placeholder?"
        yield Finding(code="effort_equal", severity="doubtful", parts=robot.joint_names, message=message)


def _weight(robot: Robot) -> Iterator[Finding]:
    """Effort limits against the arm's own weight at the worst pose found, without payload."""
    slides_without_end = robot.is_prismatic & np.isnan(robot.limits.position).any(axis=1)
    if robot.missing_inertia or slides_without_end.any():
        return
    bare = robot.with_payload(None).with_wrench(None)
    # A humanoid's fingers need fewer starts than an arm: the work grows with the square of the joints.
    poses = holding_poses(bare, checked_region(bare, None), starts=max(3, _STARTS * 6 // robot.n_joints))
    rest = np.zeros_like(poses)
    needed = np.abs(np.diagonal(inverse_dynamics(bare, poses, rest, rest)))
    effort = robot.limits.effort
    weak = effort < needed
    if weak.any():
        texts = [
            f"{name} {limit:.4g} of {need:.4g} {_unit(robot, 'effort', j)}"
            for j, (name, limit, need) in enumerate(zip(robot.joint_names, effort, needed, strict=True))
            if weak[j]
        ]
        message = f"effort limit below what holds the arm's own weight at its worst pose: {', '.join(texts)}"
        parts = tuple(name for name, is_weak in zip(robot.joint_names, weak, strict=True) if is_weak)
        yield Finding(code="effort_below_weight", severity="doubtful", parts=parts, message=message)


def _velocities(robot: Robot) -> Iterator[Finding]:
    velocity = robot.limits.velocity
    turning = velocity[~robot.is_prismatic & ~np.isnan(velocity)]
    is_quick = len(turning) > 0 and float(np.median(turning)) > _FASTEST_MEDIAN
    fastest = np.where(robot.is_prismatic, _FASTEST_SLIDE, _FASTEST_MEDIAN if is_quick else _FASTEST)
    yield from _listed(robot, "no_velocity", "no velocity limit (or 0)", np.isnan(velocity))
    yield from _listed(robot, "velocity_high", "velocity limit (degrees per second?)", velocity > fastest, velocity)
    yield from _listed(robot, "velocity_low", "velocity limit, next to standstill", velocity < _SLOWEST, velocity)
    same = _all_equal(velocity) and _is_placeholder(velocity[:1], 10.0)[0]
    # One joint alone may well have 1 rad/s, as the second of Franka's FR3.
    ones = (velocity == 1.0) & ((velocity == 1.0).sum() >= 0.5 * len(velocity))
    suspects = np.full(len(velocity), True) if same else ones
    suspects &= velocity <= fastest  # the others are told above
    yield from _listed(robot, "velocity_placeholder", "velocity limit, a placeholder?", suspects, velocity)


def _positions(robot: Robot) -> Iterator[Finding]:
    position = robot.limits.position
    unknown = np.isnan(position).any(axis=1) & ~robot.is_continuous
    yield from _listed(robot, "no_position", "no position limits", unknown)
    widest = np.where(robot.is_prismatic, _LONGEST, _WIDEST)
    largest = np.abs(position).max(axis=1)
    yield from _listed(
        robot, "position_degrees", "position limit (degrees, millimetres or a placeholder?)", largest > widest, largest
    )
    width = position[:, 1] - position[:, 0]
    yield from _listed(robot, "position_narrow", "range next to nothing", width < _NARROW, width)


def _is_placeholder(values: Array, least: float) -> Flags:
    """Exactly 1, or a power of ten from `least` on."""
    large = np.log10(np.where(values >= least, values, 2.0))  # False for NaN
    return np.asarray((values == 1) | (large == np.round(large)))


def _all_equal(values: Array) -> bool:
    return len(values) >= _FEW and bool((values == values[0]).all())


def _longest_chain(robot: Robot) -> int:
    """Moving joints one behind another, at most."""
    return max(len(support) for support in robot.model.supports) - 1


def _unit(robot: Robot, quantity: str, j: int) -> str:
    return QUANTITIES[quantity].unit(robot.is_prismatic[j])


def _listed(robot: Robot, code: str, what: str, which: Flags, values: Array | None = None) -> Iterator[Finding]:
    """One finding for these joints, with their values; without values they are missing."""
    chosen: Sequence[int] = [int(j) for j in np.flatnonzero(which)]
    if not chosen:
        return
    severity: Severity = "missing" if values is None else "doubtful"
    quantity = code.partition("_")[0]
    texts = [
        robot.joint_names[j] + ("" if values is None else f" {values[j]:.6g} {_unit(robot, quantity, j)}")
        for j in chosen
    ]
    yield Finding(
        code=code,
        severity=severity,
        parts=tuple(robot.joint_names[j] for j in chosen),
        message=f"{what}: {', '.join(texts)}",
    )
