"""The quickest motion along the path of another one, by toppra or copp-py, assessed exactly and certified."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from puma_septic.assessment import Assessment, assess
from puma_septic.document import plain
from puma_septic.dynamics import check_inertia, inverse_dynamics
from puma_septic.errors import InputError, NoSolution
from puma_septic.limit_check import LimitCheck
from puma_septic.limits import MinimumDuration, minimum_duration
from puma_septic.motion import Motion, compute_motion
from puma_septic.optimum._jerk_limited import jerk_limited
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

try:
    import toppra
    from toppra import algorithm, constraint
except ImportError as error:
    raise InputError("the reference needs toppra: python -m pip install 'puma-septic[optimum]'") from error

__all__ = ["TimeOptimal", "time_optimal"]

# Samples of the path's length; the path is then a spline through far fewer points.
_SAMPLES: Final = 20_001
_POINTS: Final = 201
_POINTS_3: Final = 101
# A quintic spline has six points.
_LEAST_POINTS: Final = 6


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class TimeOptimal:
    """What `time_optimal` found.

    Attributes
    ----------
    given : MinimumDuration
        The motion that was asked about, as quick as its limits let it be.
    trajectory : Trajectory
        toppra's, exactly: constant acceleration along the path between its grid points; under jerk limits copp-py's.
    assessment : Assessment
        What it demands everywhere, not at grid points alone, and with viscous friction, which both leave out.
    certified : MinimumDuration
        The same stretched until it keeps every limit; but that of the jerk where not every joint's is known, which its
        steps of the acceleration break.
    path_deviation : float
        Largest distance of any joint between the given path and the spline that it follows, rad (m).
    """

    given: MinimumDuration
    trajectory: Trajectory
    assessment: Assessment
    certified: MinimumDuration
    path_deviation: float

    @property
    def solver(self) -> str:
        """The package that found it."""
        return "copp-py" if _is_jerk_known(self.given.motion.robot) else "toppra"

    @property
    def duration(self) -> float:
        """Of the motion as it was found, s."""
        return self.trajectory.duration

    @property
    def gap(self) -> float:
        """Least duration of the given motion over that of the certified reference: what its profile costs."""
        return self.given.duration / self.certified.duration

    @property
    def excess(self) -> LimitCheck | None:
        """The limit that it breaks most, positions and unbounded jerk apart; None where it keeps all."""
        broken = (check for check in self.assessment.violations if check.quantity != "position")
        return next((check for check in broken if check.quantity != "jerk" or np.isfinite(check.utilisation)), None)

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document.

        Returns
        -------
        dict
        """
        return {
            "solver": self.solver,
            "duration": self.duration,
            "certified_duration": self.certified.duration,
            "gap": plain(self.gap),
            "excess": None if self.excess is None else self.excess.to_dict(),
            "path_deviation": self.path_deviation,
        }

    def __str__(self) -> str:
        broken = "keeps its limits" if self.excess is None else f"breaks {self.excess}"
        return (
            f"along the same path: {self.duration:.4g} s by {self.solver}, which {broken} exactly assessed; certified"
            f" {self.certified.duration:.4g} s; {self.given.trajectory.profile} takes {self.given.duration:.4g} s,"
            f" {self.gap:.3g} times as long"
        )


def time_optimal(motion: Motion, *, points: int | None = None) -> TimeOptimal:
    """The quickest motion along the path of another one under velocity, acceleration, jerk and torque limits.

    By time-optimal path parameterisation (Pham and Pham, A new approach to time-optimal path parameterization based on
    reachability analysis, IEEE Trans. Robotics 34, 2018; package toppra), which holds limits at grid points and knows
    dry friction alone; where every joint's jerk limit is known, of third order (package copp-py). The answer is made a
    trajectory exactly, assessed, and stretched until it keeps its limits everywhere.

    Parameters
    ----------
    motion : Motion
        From rest to rest.
    points : int, optional
        Of the path's spline and of the grid; 201, under jerk limits 101.

    Returns
    -------
    TimeOptimal

    Raises
    ------
    InputError
        Where a velocity or torque limit is not known, or as `minimum_duration`.
    NoSolution
        Where no motion is found, or as `minimum_duration`.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5, -0.4, 0.3, 0.2, 0.1, 0.4]], [0.0, 2.0])
    >>> reference = ps.time_optimal(ps.compute_motion(ps.load_robot(), move))
    >>> reference.certified.assessment.is_feasible, bool(reference.gap > 1.2)
    (True, True)
    """
    robot, trajectory = motion.robot, motion.trajectory
    check_inertia(robot)
    has_jerk = _is_jerk_known(robot)
    points = (_POINTS_3 if has_jerk else _POINTS) if points is None else points
    if isinstance(points, bool) or points < _LEAST_POINTS:
        raise InputError(f"points = {points}: expected a whole number from {_LEAST_POINTS}")
    for name in ("velocity", "effort"):
        if np.isnan(getattr(robot.limits, name)).any():
            raise InputError(f"the reference needs every joint's {name} limit")
    given = minimum_duration(motion)
    optimal, deviation = (jerk_limited if has_jerk else _by_toppra)(robot, trajectory, points)
    held = robot if has_jerk else robot.with_limits(jerk=np.full(robot.n_joints, np.nan))
    return TimeOptimal(
        given=given,
        trajectory=optimal,
        assessment=assess(compute_motion(robot, optimal)),
        certified=minimum_duration(compute_motion(held, optimal)),
        path_deviation=deviation,
    )


def _is_jerk_known(robot: Robot) -> bool:
    return not np.isnan(robot.limits.jerk).any()


def _by_toppra(robot: Robot, trajectory: Trajectory, points: int) -> tuple[Trajectory, float]:
    """The motion, and how far its path is from the given one at most."""
    length, q = _path(trajectory, points)
    path = toppra.SplineInterpolator(length, q)
    speed = _speeds(robot, path, length, q[0])
    middles = (length[1:] + length[:-1]) / 2
    deviation = float(np.abs(path(middles) - _at_length(trajectory, middles)).max())
    return _trajectory(trajectory, path, length, speed), deviation


def _lengths(trajectory: Trajectory) -> tuple[Array, Array]:
    """Instants, and the length of the joint path up to them."""
    t = np.linspace(float(trajectory.breaks[0]), float(trajectory.breaks[-1]), _SAMPLES)
    speed = np.linalg.norm(trajectory(t, 1), axis=1)
    steps = (speed[1:] + speed[:-1]) / 2 * np.diff(t)
    return t, np.concatenate([[0.0], np.cumsum(steps)])


def _at_length(trajectory: Trajectory, length: Array) -> Array:
    t, known = _lengths(trajectory)
    return trajectory(np.interp(length, known, t))


def _path(trajectory: Trajectory, points: int) -> tuple[Array, Array]:
    """Lengths, evenly spaced, and positions there: the derivative by length never vanishes, that by time does."""
    total = _lengths(trajectory)[1][-1]
    length = np.linspace(0.0, total, points)
    return length, _at_length(trajectory, length)


def _speeds(robot: Robot, path: Any, length: Array, q: Array) -> Array:
    """Speeds along the path at its grid points."""
    limits = robot.limits

    def torque(q: Array, v: Array, a: Array) -> Array:
        return inverse_dynamics(robot, q, v, a, friction=False)

    held = [
        constraint.JointVelocityConstraint(np.stack([-limits.velocity, limits.velocity], axis=1)),
        constraint.JointTorqueConstraint(
            torque,
            np.stack([-limits.effort, limits.effort], axis=1),
            np.abs(robot.coulomb_friction).max(axis=1),
            discretization_scheme=constraint.DiscretizationType.Interpolation,
        ),
    ]
    if not np.isnan(limits.acceleration).any():
        box = np.stack([-limits.acceleration, limits.acceleration], axis=1)
        held.append(constraint.JointAccelerationConstraint(box))
    instance = algorithm.TOPPRA(held, path, gridpoints=length, solver_wrapper="seidel")
    _, speed, _ = instance.compute_parameterization(0.0, 0.0)
    if speed is None or not np.isfinite(speed).all():
        raise NoSolution("toppra finds no motion along this path from rest to rest", residual=np.inf, q=q)
    return np.asarray(speed)


def _trajectory(given: Trajectory, path: Any, length: Array, speed: Array) -> Trajectory:
    """Between grid points the acceleration along the path is constant and the path cubic: degree 6 in time."""
    step = np.diff(length)
    times = 2 * step / (speed[1:] + speed[:-1])
    # The path's powers of the length on each interval, and the length's share of its step, a s + b s^2, s from 0 to 1.
    cubic = path.cspl.c[::-1] * step[:, None] ** np.arange(4)[:, None, None]
    linear, square = speed[:-1] * times / step, 1 - speed[:-1] * times / step
    powers = np.zeros((7, len(step), given.n_joints))
    share = np.zeros((7, len(step)))
    share[0] = 1.0
    for row in cubic:
        powers += share[:, :, None] * row
        following = np.zeros_like(share)
        following[1:] += share[:-1] * linear
        following[2:] += share[:-2] * square
        share = following
    breaks = np.concatenate([[0.0], np.cumsum(times)])
    return Trajectory(
        position=Piecewise.from_power(breaks, powers),
        points=np.stack([given.points[0], given.points[-1]]),
        times=breaks[[0, -1]],
        profile=f"time-optimal ({given.profile})",
        joint_names=given.joint_names,
    )
