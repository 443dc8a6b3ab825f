"""Holding brakes and emergency stops: whether a brake holds, and what a stop along the path costs and asks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from puma_septic.cycle import Cycle
from puma_septic.drives import Drivetrain
from puma_septic.dynamics import inverse_dynamics
from puma_septic.motion import Motion, compute_motion
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Actuator, Robot
from puma_septic.sizing._loads import JointLoad
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["holding_torque", "standing_torque", "stop_energy", "worst_stops"]


def holding_torque(load: JointLoad, ratio: float) -> tuple[float, float]:
    """Largest torque that gravity, payload and wrench have at the motor in any posture of the cycle, and its instant.

    N m and s. The gears are taken as lossless, as what they lose of a load that hangs cannot be counted on.

    Returns
    -------
    tuple of float
    """
    found = load.gravity.extrema()
    return float(found.peak[0]) / ratio, float(found.t_peak[0])


def standing_torque(load: JointLoad, ratio: float) -> tuple[float, float]:
    """Largest torque at the motor while its joint stands without a brake, N m, and its instant, s.

    At rest the gears lose nothing.

    Returns
    -------
    tuple of float
    """
    found = load.torque.by_interval((load.velocity_sign == 0) & ~load.braked).extrema()
    return float(found.peak[0]) / ratio, float(found.t_peak[0])


def stop_energy(load: JointLoad, train: Drivetrain) -> float:
    """What the brake turns into heat when it stops the joint at the worst instant, J; infinite where it cannot.

    ``J w^2 / 2  T_b / (T_b - T_l)``: the kinetic energy of the joint alone at its largest, and the work of the load
    that goes on driving, at its largest, against the brake's torque (NORD, "Projektierung", W_B; Tsubakimoto, "Brake
    life and braking distance calculation formula").

    Returns
    -------
    float
    """
    moved = load.velocity * load.velocity
    own = train.inertia * train.ratio**2
    energy = 0.5 * float(((load.inertia * moved) + moved * own).extrema().max[0])
    brake, driving = train.motor.brake_torque, holding_torque(load, train.ratio)[0]
    if np.isnan(brake):
        return np.nan
    return energy * brake / (brake - driving) if brake > driving else np.inf


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
        trajectory = _stopped(motion.trajectory, instant, stop_time)
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


def _stopped(trajectory: Trajectory, instant: float, stop_time: float) -> Trajectory:
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
