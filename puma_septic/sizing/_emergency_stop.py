"""Emergency stops along the path: what they ask of each joint at the instant that is worst for it.

An arm that slows down evenly from full speed to rest within T stays on its path, ``q(s(t))`` with ``s' = 1 - t / T``.
The torque is ``M q' s'' + s'^2 (M q'' + c(q, q')) + g``, with ``s'' = -1 / T``: between the ends of the stop, linear in
``s'^2``. So the worst instant to begin is where ``|tau - M q' / T|`` is largest.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from puma_septic.cycle import Cycle
from puma_septic.dynamics import inverse_dynamics
from puma_septic.motion import Motion, compute_motion
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Actuator, Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["stopped", "worst_stops"]


def worst_stops(motion: Motion, stop_time: float) -> Iterator[tuple[str, float, Cycle]]:
    """Each joint with its worst instant, s, and the stop from there as a cycle.

    Returns
    -------
    iterator of (str, float, Cycle)
    """
    bare = motion.robot.with_actuators((Actuator(),) * motion.robot.n_joints)
    torque = compute_motion(bare, motion.trajectory).torque
    found = (torque - _momentum(bare, motion.trajectory) * (1 / stop_time)).extrema()
    for joint, instant in zip(motion.robot.joint_names, found.t_peak.tolist(), strict=True):
        trajectory = stopped(motion.trajectory, instant, stop_time)
        yield joint, instant, Cycle(steps=(compute_motion(motion.robot, trajectory),))


def _momentum(bare: Robot, trajectory: Trajectory) -> Piecewise:
    """``M(q) q'``: the torque of an acceleration as large as the velocity, without gravity."""
    n = bare.n_joints
    velocity = trajectory.derivative(1)
    both = Piecewise.concatenate([trajectory.position.aligned_with(velocity), velocity])

    def momentum(values: Array) -> Array:
        q, v = values[:, :n], values[:, n:]
        rest = np.zeros_like(v)
        moved, held = (inverse_dynamics(bare, q, rest, a, friction=False) for a in (v, rest))
        return np.asarray(moved - held)

    return both.mapped(momentum)


def stopped(trajectory: Trajectory, instant: float, stop_time: float) -> Trajectory:
    """The trajectory's path from an instant on, slowing down evenly to rest within a time.

    Where the motion ends before, the arm rests there.

    Returns
    -------
    Trajectory
    """
    end = trajectory.breaks[-1]

    def along(t: Array) -> Array:
        return np.asarray(trajectory(np.minimum(instant + t - t**2 / (2 * stop_time), end)))

    passed = trajectory.breaks[(trajectory.breaks > instant) & (trajectory.breaks <= instant + stop_time / 2)]
    # s = t - t^2 / 2T at each break of the motion; a root below the square root's rounding is the stop's own end.
    share = 1 - np.sqrt(np.maximum(1 - 2 * (passed - instant) / stop_time, 0.0))
    inner = (stop_time * share)[(share > 1e-6) & (share < 1 - 1e-6)]
    breaks = np.concatenate([[0.0], inner, [stop_time]])
    return Trajectory(
        position=Piecewise.fit(along, breaks),
        points=along(np.array([0.0, stop_time])),
        times=np.array([0.0, stop_time]),
        profile=f"stop from {instant:.4g} s",
        joint_names=trajectory.joint_names,
        rest_before=False,
    )
