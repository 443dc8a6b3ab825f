"""What a motion demands of each joint."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypedDict, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.dynamics import mass_matrix
from puma_septic.motion import Motion
from puma_septic.piecewise import Jumps, Piecewise
from puma_septic.quantities import MOTION, Quantity
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["JointMetrics", "PowerMetrics", "coulomb_steps", "derivative_peak", "joint_metrics", "power_metrics"]

# Joints whose mass matrix entry is below this part of the geometric mean of both diagonal ones are not coupled.
_COUPLED = 1e-12
# Power and work below this part of the arm's largest are rounding: its sign would be told as energy that flows back.
_NO_WORK = 1e-12


class JointMetrics(TypedDict):
    """Peaks, instants and root mean squares, each of shape (n_joints,); see `Assessment` for their meaning.

    Torques are NaN for joints whose torque is not known.
    """

    peak_velocity: Array
    peak_velocity_time: Array
    peak_acceleration: Array
    peak_acceleration_time: Array
    peak_jerk: Array
    peak_jerk_time: Array
    peak_torque: Array
    peak_torque_time: Array
    peak_torque_sign: Array
    rms_velocity: Array
    rms_acceleration: Array
    rms_jerk: Array
    rms_torque: Array


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PowerMetrics:
    """Mechanical power and energy of each joint, shape (n_joints,); see `Assessment`."""

    peak_power: Array
    peak_regenerated_power: Array
    energy_in: Array
    energy_out: Array


def joint_metrics(motion: Motion, dwell: float) -> JointMetrics:
    """Peaks from extrema, root mean squares over motion and dwell; infinite where a lower derivative steps."""
    trajectory = motion.trajectory
    cycle = trajectory.duration + dwell
    (v, t_v), (a, t_a), (j, t_j) = (trajectory.peak(order) for order in (1, 2, 3))
    rms = np.sqrt(trajectory.state.inner(trajectory.state) / cycle).reshape(4, -1)[1:]
    rms_v, rms_a, rms_j = np.where(np.isinf([v, a, j]), np.inf, rms)
    whole = _with_rest(motion, dwell)
    torque, known = whole.extrema(), motion.robot.knows_torque
    peak_torque_time = torque.t_peak
    impulse_time, impulse_sign = first_impulses(motion)
    is_impulsive = ~np.isnan(impulse_time)
    # The extreme that is named by its instant; a constant has both at once.
    constant = torque.t_min == torque.t_max
    negative = np.where(constant, torque.min < 0, peak_torque_time == torque.t_min)
    metrics = JointMetrics(
        peak_velocity=v,
        peak_velocity_time=t_v,
        peak_acceleration=a,
        peak_acceleration_time=t_a,
        peak_jerk=j,
        peak_jerk_time=t_j,
        peak_torque=_where_known(known, np.where(is_impulsive, np.inf, torque.peak)),
        peak_torque_time=_where_known(known, np.where(is_impulsive, impulse_time, peak_torque_time)),
        peak_torque_sign=np.where(is_impulsive, impulse_sign, np.where(negative, -1.0, 1.0)),
        rms_velocity=rms_v,
        rms_acceleration=rms_a,
        rms_jerk=rms_j,
        rms_torque=_where_known(known, np.where(is_impulsive, np.inf, whole.rms())),
    )
    _freeze(metrics.values())
    return metrics


def _where_known(known: NDArray[np.bool_], values: Array) -> Array:
    """NaN for the joints whose torque is not known."""
    return np.where(known, values, np.nan)


def _with_rest(motion: Motion, dwell: float) -> Piecewise:
    """Torque over motion and dwell. Friction may help while the arm moves; what holds it at rest may be more."""
    if not dwell:
        return motion.torque
    return Piecewise.sequence([motion.torque, motion.rest(dwell).torque]).shifted(motion.torque.start)


def _freeze(arrays: Iterable[object]) -> None:
    """Forbid writing to arrays that this module has just made."""
    for array in arrays:
        assert isinstance(array, np.ndarray)
        array.setflags(write=False)


def first_impulses(motion: Motion) -> tuple[Array, Array]:
    """When each joint's torque is first unbounded, s, and with which sign; NaN and 0 where never. Shape (n_joints,).

    A step dv of the velocity takes the impulse ``M(q) dv``: it strikes every joint that is coupled to one that steps.
    """
    return impulses(motion.robot, motion.trajectory, motion.trajectory.jumps(1))


def derivative_peak(motion: Motion, quantity: Quantity) -> tuple[Array, Array]:
    """Largest magnitude of a derivative of the torque and its instant, each of shape (n_joints,).

    It is infinite, from the first step on, where the torque steps or is unbounded: a step of the acceleration da
    makes it step by ``M(q) da`` at every joint that is coupled to one that steps. The steps of Coulomb friction are
    left out, see `Motion.signal`.
    """
    extrema = motion.signal(quantity.name).extrema()
    steps = [
        impulses(motion.robot, motion.trajectory, motion.trajectory.jumps(order))[0]
        for order in range(1, min(quantity.order + 2, len(MOTION)))
    ]
    first, known = np.fmin.reduce(steps), motion.robot.knows_torque
    peak, time = np.where(np.isnan(first), extrema.peak, np.inf), np.where(np.isnan(first), extrema.t_peak, first)
    return _where_known(known, peak), _where_known(known, time)


def coulomb_steps(motion: Motion) -> Array:
    """Largest step of each joint's Coulomb friction where it starts, stops or reverses, N m (N), shape (n_joints,)."""
    left, right = motion.coulomb.ends()
    rest = np.zeros((1, motion.robot.n_joints))
    before, after = np.concatenate([rest, right]), np.concatenate([left, rest])
    inside = slice(0 if motion.trajectory.rest_before else 1, None if motion.trajectory.rest_after else -1)
    return np.asarray(np.abs(after - before)[inside].max(axis=0, initial=0.0))


def impulses(robot: Robot, trajectory: Trajectory, jumps: Jumps) -> tuple[Array, Array]:
    """`first_impulses` of the given steps of velocity alone."""
    times, signs = np.full(robot.n_joints, np.nan), np.zeros(robot.n_joints)
    if not len(jumps.times):
        return times, signs
    inertia = mass_matrix(robot, trajectory(jumps.times))
    own = np.sqrt(np.diagonal(inertia, axis1=1, axis2=2))
    coupled = np.abs(inertia) > _COUPLED * own[:, :, None] * own[:, None, :]
    impulse = np.einsum("kij,kj->ki", np.where(coupled, inertia, 0.0), jumps.sizes)
    for time, size in zip(jumps.times, impulse, strict=True):
        new = np.isnan(times) & (size != 0)
        times[new], signs[new] = time, np.sign(size[new])
    return times, signs


def power_metrics(motion: Motion) -> PowerMetrics:
    """Peaks of the power, and its integral over the parts where it is positive and where it is negative.

    The work of a step in velocity is not in the energies: it depends on how a real drive would smooth it.
    """
    power = motion.power
    extrema = power.extrema()
    # Between these instants no joint's power changes sign.
    instants = np.unique(np.concatenate([power.breaks, *power.roots()]))
    work = np.diff(power.integral()(instants), axis=0)
    work[np.abs(work) <= _NO_WORK * np.abs(work).sum(axis=0).max()] = 0.0
    least = _NO_WORK * extrema.peak.max()
    up, down = (np.where(size > least, size, 0.0) for size in (extrema.max, -extrema.min))
    is_impulsive = ~np.isnan(first_impulses(motion)[0])
    known = motion.robot.knows_torque
    metrics = PowerMetrics(
        peak_power=_where_known(known, np.where(is_impulsive, np.inf, up)),
        peak_regenerated_power=_where_known(known, np.where(is_impulsive, np.inf, down)),
        energy_in=_where_known(known, np.maximum(work, 0.0).sum(axis=0)),
        energy_out=_where_known(known, np.maximum(-work, 0.0).sum(axis=0)),
    )
    _freeze(getattr(metrics, name) for name in metrics.__slots__)
    return metrics
