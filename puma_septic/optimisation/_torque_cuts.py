"""The least duration at which torque keeps its limits, for a motion that is only stretched in time.

At relative time s a motion of duration T takes the torque ``a(s) / T^2 + b(s) / T + d(s)``: inertia and Coriolis,
viscous friction, and what no duration changes (weight, wrench, Coulomb friction). It is not monotone in T: inertia may
offset weight, so that a slower motion may exceed a limit that a quicker one keeps. Hence no bisection: each instant
rules out the rates 1/T at which its own torque is too large, two intervals of a quadratic each, and the largest rate
that no instant rules out is taken. Where the motion made at that rate still exceeds a limit between those instants, the
instant of its peak is added. No rate that is kept is ever ruled out, so the end is the least duration there is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.dynamics import check_plain_friction, smooth_torque
from puma_septic.errors import InputError, NoSolution
from puma_septic.friction import friction_terms
from puma_septic.motion import Motion
from puma_septic.objectives import Candidate
from puma_septic.optimisation._search import KEPT
from puma_septic.validation import Array

__all__ = ["TorqueCuts", "least_duration", "torque_cuts"]

# Instants in the inside of each interval of the torque; both ends count as well, each from its own side.
_INSIDE: Final = np.sin(np.arange(1, 12) * np.pi / 24) ** 2
# Cuts are drawn this part below the limit: torque is resolved to 1e-11, so that what is found keeps the limit itself.
_CUT: Final = 1 - KEPT / 2
# A torque beyond its cut by no more than this is at it: some hundred roundings of the quadratic's terms.
_ROUNDING: Final = 1e-13
# It converges as Newton's method does; seldom more than five rounds are needed.
_ROUNDS: Final = 50


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class TorqueCuts:
    """Torque as a share of its limit at some instants, ``a r^2 + b r + d`` at the rate ``r = 1/T``.

    Attributes
    ----------
    a, b, d : ndarray, shape (n, n_joints)
        NaN where the limit is not known.
    """

    a: Array
    b: Array
    d: Array

    def joined(self, other: TorqueCuts) -> TorqueCuts:
        """The instants of both."""
        pairs = ((self.a, other.a), (self.b, other.b), (self.d, other.d))
        a, b, d = (np.concatenate(pair) for pair in pairs)
        return TorqueCuts(a=a, b=b, d=d)

    def largest_rate(self, highest: float) -> float:
        """The largest rate, up to `highest`, that no instant rules out; 0 where all are, infinite without a bound."""
        roots = self._roots()
        # Beyond its last root a torque is too large, and without a root it is so at every rate or at none.
        last = np.where(np.isfinite(roots), roots, 0.0).max(axis=0)
        bound = np.where(last > 0, last, np.where(np.abs(self.d) > _CUT, 0.0, np.inf))
        rate = min(highest, float(bound.min()))
        while 0 < rate < np.inf:
            ruled_out = np.abs((self.a * rate + self.b) * rate + self.d) > _CUT + _ROUNDING
            if not ruled_out.any():
                break
            # Down to its next root, each of these instants rules out every rate.
            rate = float(np.where(roots < rate, roots, 0.0).max(axis=0)[ruled_out].min())
        return rate

    def _roots(self) -> Array:
        """Positive rates at which the torque is at its cut, of either sign, shape (4, n, n_joints); else infinite."""
        found = []
        with np.errstate(divide="ignore", invalid="ignore"):
            for cut in (_CUT, -_CUT):
                c = self.d - cut
                # Two forms of the quadratic formula: neither root loses digits where the other is far.
                half = -(self.b + np.copysign(np.sqrt(self.b**2 - 4 * self.a * c), self.b)) / 2
                found += [half / self.a, c / half]
        roots = np.stack(found)
        return np.where(np.isfinite(roots) & (roots > 0), roots, np.inf)


def torque_cuts(motion: Motion) -> TorqueCuts:
    """Cuts at the ends of each interval, at instants inside, and at each joint's peaks."""
    robot, torque, n = motion.robot, motion.torque, motion.robot.n_joints
    state, breaks = motion.trajectory.state, torque.breaks
    left, right = state.aligned_with(torque).ends()
    reach = torque.extrema()
    times = np.outer(1 - _INSIDE, breaks[:-1]) + np.outer(_INSIDE, breaks[1:])
    inside = np.concatenate([times.ravel(), reach.t_min, reach.t_max])
    pieces = np.arange(len(breaks) - 1)
    piece = np.concatenate([pieces, pieces, np.searchsorted(breaks[1:-1], inside, side="right")])
    rows = np.concatenate([left, right, state(inside)])
    q, v, a = rows[:, :n], rows[:, n : 2 * n], rows[:, 2 * n : 3 * n]
    rest = np.zeros_like(q)
    weight, viscous = smooth_torque(robot, q, rest, rest), robot.viscous_friction * v
    inertial = smooth_torque(robot, q, v, a) - viscous - weight
    limit, duration = robot.limits.effort, motion.trajectory.duration
    return TorqueCuts(
        a=inertial * duration**2 / limit,
        b=viscous * duration / limit,
        d=(weight + _coulomb(motion)[piece]) / limit,
    )


def _coulomb(motion: Motion) -> Array:
    """Coulomb friction on each interval of the torque, shape (n_intervals, n_joints)."""
    ways = motion.direction.coefficients[0]
    return friction_terms(motion.robot.friction, 0 * ways, ways)["coulomb"]


def least_duration(made: Callable[[float], Candidate], shortest: float) -> Candidate:
    """The quickest motion, from a shortest duration on, whose torque keeps its limits.

    Parameters
    ----------
    made : callable
        The motion of a given duration in s, stretched from any other.
    shortest : float
        s; 0 where nothing but torque bounds the duration.

    Raises
    ------
    InputError
        If no limit bounds the duration, or for friction that is not viscous plus constant.
    NoSolution
        If no duration keeps them, with the joint whose weight and Coulomb friction alone exceed its limit.
    """
    candidate = made(shortest or 1.0)
    if shortest and _is_kept(candidate):
        return candidate
    check_plain_friction(candidate.motion.robot, "the least duration at which torque keeps its limits")
    cuts, rate = torque_cuts(candidate.motion), 1 / shortest if shortest else np.inf
    for _ in range(_ROUNDS):
        rate = cuts.largest_rate(rate)
        if rate == 0:
            raise _never(candidate.motion)
        if np.isinf(rate):
            raise InputError("no joint with a limit moves: any time is long enough")
        candidate = made(1 / rate)
        if _is_kept(candidate):
            return candidate
        cuts = cuts.joined(torque_cuts(candidate.motion))
    raise InputError(f"profile {candidate.trajectory.profile} does not scale with its times: its torque differs")


def _is_kept(candidate: Candidate) -> bool:
    motion = candidate.motion
    share = motion.torque.extrema().peak / motion.robot.limits.effort
    return bool(np.nanmax(share) <= 1 + KEPT)


def _never(motion: Motion) -> NoSolution:
    """Why no duration keeps the limits: the largest torque of an endlessly slow motion."""
    robot, trajectory = motion.robot, motion.trajectory
    weight = trajectory.position.mapped(lambda q: smooth_torque(robot, q, 0 * q, 0 * q))
    slow = (weight + motion.direction.stepwise(_coulomb(motion))).extrema()
    share = np.nan_to_num(slow.peak / robot.limits.effort)
    j = int(share.argmax())
    unit = "N" if robot.is_prismatic[j] else "N m"
    when = (slow.t_peak[j] - trajectory.breaks[0]) / trajectory.duration
    return NoSolution(
        f"no duration keeps the effort limit of joint {robot.joint_names[j]!r}: however slow the motion, weight and"
        f" Coulomb friction take {slow.peak[j]:.4g} {unit} at {100 * when:.3g} % of it; the limit is"
        f" {robot.limits.effort[j]:.4g} {unit}",
        residual=float(share[j] - 1),
        q=trajectory(slow.t_peak[j]),
    )
