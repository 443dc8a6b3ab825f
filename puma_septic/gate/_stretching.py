"""The least uniform stretch of time by which a trajectory keeps its limits.

A motion that takes k times as long passes the same positions with velocities divided by k, accelerations by k^2 and
jerks by k^3. With u = 1/k the torque of each joint at each place on the path is ``S + V u + D u^2``: S gravity,
Coulomb friction and wrench, V viscous friction, D inertia and Coriolis. Less speed is no remedy for S, and not always a
help: an arm that brakes on its way up carries less than one that stands.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from puma_septic.assessment import Assessment, LimitCheck, assess
from puma_septic.dynamics import check_plain_friction, smooth_torque
from puma_septic.errors import NoSolution
from puma_septic.gate._reasons import AT_REST
from puma_septic.limit_check import AT_LIMIT
from puma_septic.motion import Motion, compute_motion
from puma_septic.piecewise import Piecewise
from puma_septic.quantities import COMMON, QUANTITIES
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_number

__all__ = ["Stretch", "least_stretch", "stretched"]

# The exchange ends where no exact peak is beyond its limit by more than this part of what a verdict lets pass.
_CLOSE: Final = 0.25 * AT_LIMIT
# A derivative of a series that is fitted to 1e-11 has lost some digits: so much of its limit is left on purpose.
_DERIVATIVE_SPARE: Final = 1e-7
_MOST_EXCHANGES: Final = 50
# Instants on each interval that the exchange starts from.
_FIRST_NODES: Final = np.linspace(0.0, 1.0, 13)[1:-1]
_NEVER_SLOWER: Final = 1e6


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Stretch:
    """A trajectory that keeps its limits by taking longer; made by `least_stretch`.

    Attributes
    ----------
    factor : float
        Its duration over the original one, at least 1.
    trajectory : Trajectory
    assessment : Assessment
        It keeps every known limit.
    governing : LimitCheck or None
        The limit that a shorter motion would break; None where nothing has to be stretched.
    """

    factor: float
    trajectory: Trajectory
    assessment: Assessment
    governing: LimitCheck | None


def least_stretch(robot: Robot, trajectory: Trajectory) -> Stretch:
    """The least uniform stretch of time, 1 or more, by which a motion from rest to rest keeps all known limits.

    Velocity, acceleration and jerk give their factors ``d/l, (d/l)^(1/2), (d/l)^(1/3)`` at once. The torque is a
    polynomial of degree 2 in 1/k at each instant; the largest 1/k that a set of instants allows is exact, and the
    instants of the exact peaks there are added until none is beyond its limit (the exchange method of semi-infinite
    programming, Hettich and Kortanek, SIAM Review 35, 1993). The torque's rate at u is
    the derivative of that polynomial times u, brought within its limit by bisection. The result is assessed in full.

    Parameters
    ----------
    robot : Robot
    trajectory : Trajectory

    Returns
    -------
    Stretch

    Raises
    ------
    InputError
        For friction that is not viscous plus constant: its torque is no such polynomial.
    NoSolution
        Where no stretch helps: a position beyond its bound, a step of velocity or, under a jerk limit, of
        acceleration, a torque that gravity and friction alone break, or a motion that starts or ends moving. The
        message says which and where; `q` is the posture there.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5, -0.5, 0.5, 0.5, 0.5, 0.5]], [0.0, 0.4])
    >>> stretch = ps.least_stretch(robot, move)
    >>> stretch.assessment.is_feasible, round(stretch.factor, 3), stretch.governing.quantity
    (True, 1.607, 'effort')
    """
    motion = compute_motion(robot, trajectory)
    first = assess(motion)
    if not first.violations:
        return Stretch(factor=1.0, trajectory=trajectory, assessment=first, governing=None)
    check_plain_friction(robot, "the least stretch that keeps a torque limit")
    _refuse_hopeless(first)
    u = _rate_of_torque_derivatives(motion, _largest_rate(motion, _kinematic_rate(first)))
    slower = stretched(trajectory, 1 / u)
    result = assess(robot, slower)
    if result.violations:
        raise _no_solution(result, result.violations[0], "is violated at any speed")
    return Stretch(factor=1 / u, trajectory=slower, assessment=result, governing=_governing(result))


def _governing(assessment: Assessment) -> LimitCheck | None:
    """The governing limit, positions apart, which no stretch changes."""
    slowed = [check for check in assessment.checks if check.quantity != "position"]
    return max(slowed, key=lambda check: check.utilisation, default=None)


def stretched(trajectory: Trajectory, factor: float) -> Trajectory:
    """The same motion, `factor` times as long, from the same instant.

    Returns
    -------
    Trajectory
    """
    k = checked_number("factor", factor, above=0.0)
    start = trajectory.breaks[0]
    return replace(trajectory, position=trajectory.position.stretched(k), times=start + (trajectory.times - start) * k)


def _refuse_hopeless(assessment: Assessment) -> None:
    trajectory = assessment.motion.trajectory
    speed = float(np.abs(trajectory(trajectory.breaks[[0, -1]], 1)).max())
    if speed > AT_REST:
        raise NoSolution(
            "no stretch keeps the velocity with which the motion starts or ends; give one from rest to rest",
            residual=speed,
            q=trajectory(trajectory.breaks[0]),
        )
    for check in assessment.violations:
        if check.quantity == "position":
            raise _no_solution(assessment, check, "is violated at any speed")
        if np.isinf(check.demand):
            raise _no_solution(assessment, check, "needs another motion: a step remains a step")


def _no_solution(assessment: Assessment, check: LimitCheck, why: str) -> NoSolution:
    q = assessment.motion.trajectory(check.time)
    return NoSolution(f"no stretch of time helps: {check}; that {why}", residual=abs(check.margin), q=q)


def _kinematic_rate(assessment: Assessment) -> float:
    """The largest u = 1/k, at most 1, that velocity, acceleration and jerk limits allow."""
    limits, u = assessment.motion.robot.limits, 1.0
    for order, quantity in enumerate(("velocity", "acceleration", "jerk"), start=1):
        demand, limit = getattr(assessment, f"peak_{quantity}"), getattr(limits, quantity)
        over = demand > limit
        u = min([u, *(limit[over] / demand[over]) ** (1 / order)])
    return float(u)


def _largest_rate(motion: Motion, u: float) -> float:
    """The largest rate, at most u, at which every torque is within its limit, by exchange."""
    limit = motion.robot.limits.effort
    known = ~np.isnan(limit)
    parts = _parts(motion)
    rows = _first_rows(parts)
    for _ in range(_MOST_EXCHANGES):
        u = _largest_allowed(rows[:, :, known], limit[known], u, motion)
        torque = _at_rate(parts, u)
        extrema = torque.extrema()
        over = known & (extrema.peak > limit * (1 + _CLOSE))
        if not over.any():
            return u
        times = np.unique(np.concatenate([extrema.t_min[over], extrema.t_max[over]]))
        rows = np.concatenate([rows, np.stack([part(times) for part in parts], axis=1)])
    raise _static(motion, "is not held by any rate that was tried")


def _rate_of_torque_derivatives(motion: Motion, u: float) -> float:
    """The rate, at most u, to which a limited derivative of the torque lets the motion come: by bisection.

    Over the slower time the derivative is ``u^r`` times that of ``S + V u + D u^2``, which vanishes with u.
    """
    limits = motion.robot.limits
    rows = [QUANTITIES[name] for name in limits.quantities if name not in COMMON]
    if not rows:
        return u
    parts = _parts(motion)

    def is_kept(rate: float) -> bool:
        torque = _at_rate(parts, rate)
        used = [_derivative_peak(torque, rate, row.order) / getattr(limits, row.name) for row in rows]
        return bool(np.nanmax(used) <= 1 - _DERIVATIVE_SPARE)

    if is_kept(u):
        return u
    low, high = 0.0, u
    while high - low > _DERIVATIVE_SPARE * high:
        middle = (low + high) / 2
        low, high = (middle, high) if is_kept(middle) else (low, middle)
    return low


def _derivative_peak(torque: Piecewise, rate: float, order: int) -> Array:
    for _ in range(order):
        torque = torque.derivative()
    return torque.extrema().peak * rate**order


def _parts(motion: Motion) -> tuple[Piecewise, Piecewise, Piecewise]:
    """S, V and D of the torque ``S + V u + D u^2`` as functions of the original time."""
    robot, n = motion.robot, motion.robot.n_joints

    def split(state: Array) -> Array:
        q, v, a = (state[:, k * n : (k + 1) * n] for k in range(3))
        rest = np.zeros_like(q)
        still = smooth_torque(robot, q, rest, rest)
        forth, back = smooth_torque(robot, q, v, a), smooth_torque(robot, q, -v, a)
        return np.concatenate([still, (forth - back) / 2, (forth + back) / 2 - still], axis=1)

    fitted = motion.trajectory.state.mapped(split)
    S, V, D = (fitted[k * n : (k + 1) * n] for k in range(3))
    both = S + motion.torque_terms.coulomb
    return both, V.aligned_with(both), D.aligned_with(both)


def _at_rate(parts: tuple[Piecewise, Piecewise, Piecewise], u: float) -> Piecewise:
    """The torque at rate u, over the original time."""
    S, V, D = parts
    return S + V * u + D * u**2


def _first_rows(parts: tuple[Piecewise, Piecewise, Piecewise]) -> Array:
    """S, V and D at instants all over the motion, both sides of each break included, shape (k, 3, n_joints)."""
    breaks = parts[0].breaks
    inside = (breaks[:-1, None] + np.diff(breaks)[:, None] * _FIRST_NODES).ravel()
    values = [np.concatenate([part(inside), *part.ends()]) for part in parts]
    return np.stack(values, axis=1)


def _largest_allowed(rows: Array, limit: Array, u: float, motion: Motion) -> float:
    """The largest rate, at most u, at which all rows are within the limits: from each excess to its lower end."""
    S, V, D = (rows[:, k].ravel() for k in range(3))
    L = np.broadcast_to(limit, rows[:, 0].shape).ravel()
    # Each side of each limit is a polynomial a u^2 + b u + c that must not be positive.
    a, b, c = np.concatenate([D, -D]), np.concatenate([V, -V]), np.concatenate([S - L, -S - L])
    tolerance = 1e-12 * np.concatenate([L, L])
    while u > 1 / _NEVER_SLOWER:
        over = (a * u + b) * u + c > tolerance
        if not over.any():
            return u
        u = min(u * (1 - 1e-15), float(_lower_roots(a[over], b[over], c[over], u).min()))
    raise _static(motion, "is violated by gravity and friction alone")


def _lower_roots(a: Array, b: Array, c: Array, u: float) -> Array:
    """The largest root in (0, u) of each polynomial that is positive at u; 0 where it stays positive."""
    discriminant = b**2 - 4 * a * c
    root = np.sqrt(np.maximum(discriminant, 0.0))
    # The stable pair of roots of a quadratic: q/a and c/q.
    q = -(b + np.where(b >= 0, root, -root)) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        both = np.array([q / a, c / q])
    inside = (discriminant >= 0) & np.isfinite(both) & (both > 0) & (both < u)
    return np.asarray(np.where(inside, both, 0.0).max(axis=0))


def _static(motion: Motion, why: str) -> NoSolution:
    """The joint whose torque without motion is the largest share of its limit."""
    torque = _at_rate(_parts(motion), 0.0)
    extrema = torque.extrema()
    share = np.nan_to_num(extrema.peak / motion.robot.limits.effort)
    j = int(np.argmax(share))
    robot, time = motion.robot, float(extrema.t_peak[j])
    unit = "N" if robot.is_prismatic[j] else "N m"
    return NoSolution(
        f"no stretch of time helps: {robot.joint_names[j]} needs {extrema.peak[j]:.4g} {unit} at t = {time:.4g} s at"
        f" any speed, its limit is {robot.limits.effort[j]:.4g} {unit}: that {why}",
        residual=float(extrema.peak[j] - robot.limits.effort[j]),
        q=motion.trajectory(time),
    )
