"""What the noise of a log leaves unknown of the torque, and of the limits that it may keep or break."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from puma_septic.document import plain
from puma_septic.dynamics import rigid_torque, smooth_torque
from puma_septic.friction import friction_terms, loss
from puma_septic.logs import LogFit, unresolved
from puma_septic.motion import Motion
from puma_septic.piecewise.directions import REST_TIME
from puma_septic.robot import Robot
from puma_septic.validation import Array, read_only

__all__ = ["TorqueBand", "limit_doubts", "torque_band"]

# Instants at which torques are compared: the least and the most of them, and per second in between.
_LEAST, _MOST, _PER_SECOND = 600, 4000, 400.0
# Of the draws, this part deviates by less than the band; widened by what coverage on 200 logs of known motions needs.
_PART: Final = 0.98
_WIDENED: Final = 1.5
# A torque below this part of the arm's largest is slight.
_SLIGHT: Final = 1e-3
# The sums over the grid are this close to the integrals, relative.
_QUADRATURE: Final = 1e-3


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class TorqueBand:
    """Where the peak and the RMS torque of the recorded motion lie, with 95 % confidence for each joint.

    Attributes
    ----------
    peak, rms : ndarray, shape (2, n_joints)
        Least and greatest, N m (N); NaN for a joint whose torque is not known.
    """

    peak: Array
    rms: Array

    @property
    def relative_width(self) -> float:
        """Half the width of the widest band of a peak, as a part of it; slight joints count a 1000th of the largest."""
        least, greatest = self.peak
        finite = np.isfinite(greatest)
        if not finite.any():
            return 0.0
        scale = np.maximum(greatest, _SLIGHT * greatest[finite].max())
        half = (greatest - least)[finite] / 2
        return float((half / np.maximum(scale[finite], np.finfo(float).tiny)).max())

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document."""
        return {
            "confidence": 0.95,
            "peak_torque": {"least": plain(self.peak[0]), "greatest": plain(self.peak[1])},
            "rms_torque": {"least": plain(self.rms[0]), "greatest": plain(self.rms[1])},
        }


def torque_band(motion: Motion, fit: LogFit, *, draws: int = 48, seed: int = 0) -> TorqueBand:
    """The band of peak and RMS torque that the samples of a log leave.

    Motions that the samples do not rule out are drawn, and their torques compared with that of the fit. Of a fit that
    was smoothed by likelihood, the band of the peak is as wide as the peaks of the draws differ from it, to both sides;
    else a draw's largest deviation at any instant bounds it. Added is what friction does while it is not known for
    0.1 s whether a joint rests already, or still.

    Added too is what a spline through the samples may miss between them, by how it differs from those through every
    other and every fourth of them. A smoothed motion is taken to have no steps of its acceleration: a fit rounds and
    overshoots them.

    Parameters
    ----------
    motion : Motion
        Of ``fit.trajectory``.
    draws : int
        How many.
    seed : int
        Of the draws.

    Examples
    --------
    >>> import numpy as np
    >>> import puma_septic as ps
    >>> from puma_septic.logs import fit_samples
    >>> from puma_septic.measurement import torque_band
    >>> robot, t = ps.load_robot(), np.linspace(0.0, 2.0, 401)
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> noisy = move(t) + np.random.default_rng(0).normal(scale=1e-4, size=(401, 6))
    >>> fit = fit_samples(t, noisy, smoothing="auto")
    >>> band = torque_band(ps.compute_motion(robot, fit.trajectory), fit)
    >>> exact = ps.assess(robot, move).peak_torque
    >>> bool(((band.peak[0] <= exact) & (exact <= band.peak[1])).all())
    True
    """
    known = motion.robot.knows_torque
    peak, rms = (np.where(known, x, np.nan) for x in (motion.torque.extrema().peak, motion.torque.rms()))
    count = int(np.clip(_PER_SECOND * motion.trajectory.duration, _LEAST, _MOST))
    t = np.linspace(0.0, fit.spread.spline.t[-1], count)
    state = [fit.spread.spline(t, nu=order) for order in range(3)]
    rests = _rests(motion, t, state, _unsure(motion, fit))
    tau = smooth_torque(motion.robot, *state) + rests[0]
    peaks, squares = _deviations(motion.robot, fit, t, state, rests[0], draws=draws, seed=seed)
    around = [tau - rests[0] + friction for friction in rests]
    of_peaks = np.array([np.abs(one).max(axis=0) for one in around]) - np.abs(tau).max(axis=0)
    of_rms = np.array([_rms(one) for one in around]) - _rms(tau)
    if fit.noise.any():
        squares = squares + _QUADRATURE * rms
    between = _between_samples(motion, fit)
    peaks, squares = peaks + between[0], squares + between[1]
    return TorqueBand(
        peak=read_only([np.maximum(0.0, peak + of_peaks.min(axis=0) - peaks), peak + of_peaks.max(axis=0) + peaks]),
        rms=read_only([np.maximum(0.0, rms + of_rms.min(axis=0) - squares), rms + of_rms.max(axis=0) + squares]),
    )


def _between_samples(motion: Motion, fit: LogFit) -> tuple[Array | float, Array | float]:
    """By how much a spline through the samples may miss the peak and the RMS torque between them, each (n_joints,)."""
    spread = fit.spread
    if spread.parts:
        return 0.0, 0.0
    t = spread.instants
    sign = motion.trajectory.direction.from_zero()(t)

    def torque(spline: BSpline) -> Array:
        state = [spline(t, nu=order) for order in range(3)]
        return np.asarray(smooth_torque(motion.robot, *state) + _dry_friction(motion.robot, state, sign))

    tau = [torque(spline) for spline in (spread.spline, *spread.coarse)]
    return unresolved(*tau), unresolved(*tau, size=_rms)


def _deviations(
    robot: Robot, fit: LogFit, t: Array, state: list[Array], friction: Array, *, draws: int, seed: int
) -> tuple[Array, Array]:
    """By how much the peaks, and the RMS values, of the draws differ from those of the fit, each (n_joints,)."""
    spline = fit.spread.draws(draws, seed=seed)
    deviations = [spline(t, nu=order) for order in range(3)]
    tau = smooth_torque(robot, *state) + friction
    peaks, squares = [], []
    for k in range(draws):
        drawn = [one + off[..., k] for one, off in zip(state, deviations, strict=True)]
        other = smooth_torque(robot, *drawn) + friction
        if fit.spread.is_regularised:
            peaks.append(np.abs(np.abs(other).max(axis=0) - np.abs(tau).max(axis=0)))
            squares.append(np.abs(_rms(other) - _rms(tau)))
        else:
            peaks.append(np.abs(other - tau).max(axis=0))
            squares.append(_rms(other - tau))
    return _WIDENED * np.quantile(peaks, _PART, axis=0), _WIDENED * np.quantile(squares, _PART, axis=0)


def _unsure(motion: Motion, fit: LogFit) -> Array:
    """For how long it is not known at each end of a rest whether a joint rests, s, shape (n_joints,).

    At least REST_TIME where there is noise; and a joint that starts with the jerk j hides within the resolution
    r for ``cbrt(6 r / j)``.
    """
    jerk = np.maximum(fit.spread.rms(3), np.finfo(float).tiny)
    hidden = np.cbrt(6 * np.asarray(motion.trajectory.resolution) / jerk)
    least = np.where(fit.noise > 0, REST_TIME, 0.0)
    return np.asarray(np.clip(least / 2 + 1.5 * hidden, least, motion.trajectory.duration / 2))


def _rests(motion: Motion, t: Array, state: list[Array], unsure: Array) -> list[Array]:
    """Dry friction (n, n_joints) as the motion has it, and with rests shorter and longer at each end.

    The ends of a log that is at rest there belong to a rest.
    """
    trajectory = motion.trajectory
    direction = trajectory.direction.from_zero()(t)
    still = direction == 0
    moving = np.where(still, _nearest_direction(direction), direction)
    shorter, longer = np.empty_like(still), np.empty_like(still)
    for j, margin in enumerate(np.rint(unsure / (t[1] - t[0])).astype(int)):
        longer[:, j] = _grown(still[:, j], margin)
        longer[:margin, j] |= trajectory.rest_before
        longer[len(t) - margin :, j] |= trajectory.rest_after
        shorter[:, j] = ~_grown(~still[:, j], margin)
    signs = [direction, np.where(shorter, 0.0, moving), np.where(longer, 0.0, moving)]
    return [_dry_friction(motion.robot, state, sign) for sign in signs]


def _dry_friction(robot: Robot, state: list[Array], sign: Array) -> Array:
    """Friction and gear losses that depend on the way of travel, for signs of it, shape (n, n_joints)."""
    friction = friction_terms(robot.friction, state[1], sign)["coulomb"]
    if not robot.has_losses:
        return friction
    return friction + loss(robot.transmission, rigid_torque(robot, *state) - robot.armature * state[2], sign)


def _grown(flags: NDArray[np.bool_], margin: int) -> NDArray[np.bool_]:
    """Flags (n,), set also within the given number of rows of one that is set."""
    sums = np.cumsum(np.pad(flags, (margin + 1, margin)).astype(np.int64))
    return np.asarray(sums[2 * margin + 1 :] - sums[: -2 * margin - 1] > 0)


def _nearest_direction(direction: Array) -> Array:
    """For rows without a direction, that of the nearest row with one."""
    rows = np.arange(len(direction))
    filled = direction.copy()
    for j in range(direction.shape[1]):
        known = np.flatnonzero(direction[:, j])
        if len(known):
            after = np.clip(np.searchsorted(known, rows), 0, len(known) - 1)
            before = np.maximum(after - 1, 0)
            nearer = np.abs(known[before] - rows) < np.abs(known[after] - rows)
            filled[:, j] = direction[known[np.where(nearer, before, after)], j]
    return filled


def _rms(values: Array) -> Array:
    """Root mean square over evenly spaced instants, by the trapezoid rule."""
    weights = np.ones(len(values))
    weights[[0, -1]] = 0.5
    return np.asarray(np.sqrt(weights @ values**2 / weights.sum()))


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
