"""The quickest motion along a path under limits of the jerk too, by copp-py."""

from __future__ import annotations

from importlib import import_module
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline, make_interp_spline

from puma_septic.dynamics import inverse_dynamics
from puma_septic.errors import InputError, NoSolution
from puma_septic.piecewise import Piecewise, matrices
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

# Its own type information leaves out what its modules hold.
copp_py: Any
try:
    copp_py = import_module("copp_py")
except ImportError:
    copp_py = None

__all__ = ["jerk_limited"]

# Samples of the path's length.
_SAMPLES: Final = 20_001
# The jerk is linearised about the solution before; from the fourth on the duration changes by less than 1e-6.
_ROUNDS: Final = 4
# A path of degree 5 of a length of degree 5 in time.
_DEGREE: Final = 25


def jerk_limited(robot: Robot, trajectory: Trajectory, points: int) -> tuple[Trajectory, float]:
    """The motion, and how far its path is from the given one at most, rad (m).

    Convex-objective path parameterisation of third order (package copp-py: Wang, He, Lin, Hu). The limits hold at
    `points` stations, dry friction comes off the torque's limits. Between stations the length is a quintic of time with
    copp's positions, speeds and accelerations at both ends, so that the acceleration is continuous.

    Raises
    ------
    InputError
        Where copp-py is not installed.
    NoSolution
        Where it finds no motion.
    """
    if copp_py is None:
        raise InputError("under jerk limits the reference needs copp-py: python -m pip install 'puma-septic[optimum]'")
    length, times = _stations(trajectory, points)
    path = make_interp_spline(length, trajectory(times), k=5)
    try:
        profile = _solved(robot, length, path)
        instants = np.asarray(copp_py.interpolation.s_to_t_topp3(length, profile, 0.0)[1])
    except copp_py.CoppError as error:
        reason = f"copp finds no motion along this path from rest to rest: {error}"
        raise NoSolution(reason, residual=np.inf, q=trajectory.points[0]) from error
    speed = np.sqrt(np.maximum(profile.a, 0.0))
    middles = (length[1:] + length[:-1]) / 2
    between, known = _lengths(trajectory)
    deviation = np.abs(path(middles) - trajectory(np.interp(middles, known, between))).max()
    return _composed(trajectory, path, length, instants, speed, np.asarray(profile.b)), float(deviation)


def _lengths(trajectory: Trajectory) -> tuple[Array, Array]:
    """Instants, and the length of the joint path up to them."""
    t = np.linspace(float(trajectory.breaks[0]), float(trajectory.breaks[-1]), _SAMPLES)
    length = CubicSpline(t, np.linalg.norm(trajectory(t, 1), axis=1)).antiderivative()(t)
    return t, np.maximum.accumulate(length - length[0])


def _stations(trajectory: Trajectory, points: int) -> tuple[Array, Array]:
    """Lengths, nearly evenly spaced, and the instants at which the given motion has them."""
    t, length = _lengths(trajectory)
    some = np.unique(np.searchsorted(length, np.linspace(0.0, length[-1], points)).clip(0, _SAMPLES - 1))
    some[-1] = _SAMPLES - 1
    return length[some], t[some]


def _solved(robot: Robot, length: Array, path: Any) -> Any:
    """Squares of the speed and accelerations along the path; first without the jerk, to have where to linearise it."""
    topp2, topp3 = copp_py.solver.topp2_ra, copp_py.solver.topp3_socp
    held = _held(robot, length, path)
    problem = topp2.Problem(held.constraints, idx_s_interval=(0, len(length) - 1), a_boundary=(0.0, 0.0))
    about: dict[str, Any] = {"a_linearization": topp2.solve(problem, topp2.Options())}
    limit = robot.limits.jerk
    held.add_jerk_limits(limit, -limit, start_idx_s=0, length=len(length))
    for _ in range(_ROUNDS):
        profile = topp3.solve(topp3.Problem(held.constraints, **about))
        about = {"a_linearization": profile.a, "b_linearization": profile.b}
    return profile


class _Torque:
    """Inverse dynamics without friction, as copp asks for it, one state at a time."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def inverse_dynamics(self, q: ArrayLike, dq: ArrayLike, ddq: ArrayLike) -> Array:
        return inverse_dynamics(self._robot, q, dq, ddq, friction=False)


def _held(robot: Robot, length: Array, path: Any) -> Any:
    """The path at all stations with the limits of velocity, acceleration and torque."""
    limits, count = robot.limits, len(length)
    held = copp_py.Robot(robot.n_joints, capacity=count)
    held.set_inverse_dynamics(_Torque(robot))
    held.append_s(length)
    position, first, second, third = (path(length, order) for order in range(4))
    held.set_q(position, first, second, 0, dddq=third)
    held.add_velocity_limits(limits.velocity, -limits.velocity, start_idx_s=0, length=count)
    if not np.isnan(limits.acceleration).any():
        held.add_acceleration_limits(limits.acceleration, -limits.acceleration, start_idx_s=0, length=count)
    effort = limits.effort - np.abs(robot.coulomb_friction).max(axis=1)
    held.add_torque_limits(effort, -effort, start_idx_s=0, length=count)
    return held


def _composed(
    given: Trajectory, path: Any, length: Array, times: Array, speed: Array, acceleration: Array
) -> Trajectory:
    """The path of the length in time, which has these values at these times."""
    step = np.diff(times)
    rise = np.diff(length)
    start, end = speed[:-1] * step, speed[1:] * step
    bend, last = acceleration[:-1] * step**2 / 2, acceleration[1:] * step**2 / 2
    # Hermite's quintic by powers of the share of the step.
    gap, slope, curve = rise - start - bend, end - start - 2 * bend, last - bend
    powers = [
        length[:-1],
        start,
        bend,
        10 * gap - 4 * slope + curve,
        -15 * gap + 7 * slope - 2 * curve,
        6 * gap - 3 * slope + curve,
    ]
    share = (matrices.nodes(_DEGREE)[:, None] + 1) / 2
    at = sum(power * share**k for k, power in enumerate(powers))
    # Of the path's piece between two stations, also where rounding ends beyond it.
    at = np.clip(at, length[:-1], length[1:])
    values = path(at.ravel()).reshape(_DEGREE + 1, -1)
    series = (matrices.coefficients_from_values(_DEGREE) @ values).reshape(_DEGREE + 1, len(step), given.n_joints)
    return Trajectory(
        position=Piecewise(breaks=times, coefficients=series),
        points=np.stack([given.points[0], given.points[-1]]),
        times=times[[0, -1]],
        profile=f"time-optimal ({given.profile})",
        joint_names=given.joint_names,
    )
