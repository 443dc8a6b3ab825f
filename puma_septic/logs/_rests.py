"""Where a log shows no motion, and whether its arm rests where it begins and ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_interp_spline
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from puma_septic.logs._smoothing import even_knots, smooth_joint
from puma_septic.logs._spline import DEGREE, end_slopes, interpolated
from puma_septic.piecewise.directions import REST_TIME
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["Ends", "EndsRule", "ends_of", "find_rests", "stops"]


def stops(trajectory: Trajectory) -> tuple[Array, Array]:
    """Instants (k,) and positions (k, n_joints) of both ends and of the middles of rests of all joints between them.

    Rests shorter than REST_TIME / 2 do not count; what is rest and what slow motion is the trajectory's resolution.
    """
    direction = trajectory.direction
    still = np.concatenate([[False], ~direction.coefficients[0].any(axis=1), [False]])
    starts, ends = np.flatnonzero(still[1:] & ~still[:-1]), np.flatnonzero(~still[1:] & still[:-1])
    spans = np.column_stack([direction.breaks[starts], direction.breaks[ends]])
    first, last = trajectory.breaks[[0, -1]]
    inner = (spans[:, 0] > first) & (spans[:, 1] < last) & (np.diff(spans, axis=1)[:, 0] >= REST_TIME / 2)
    times = np.concatenate([[first], spans[inner].mean(axis=1), [last]])
    return times, trajectory(times)


# Samples in REST_TIME that a rest is judged by.
_FEWEST: Final = 8
# Means differ by so many of their standard deviations once in two million normal draws.
_SIGMAS: Final = 5.0
# A rest is so many times as long as a turn may be hidden in the noise.
_LONGER: Final = 2.0
# The range of m normal draws is 2 sqrt(2 log m) standard deviations, give or take.
_GIVE: Final = 2.5


def find_rests(t: Array, q: Array, noise: Array, step: Array) -> NDArray[np.int64]:
    """First and last samples (k, 2) of the spans in which no joint moves beyond its noise, for `REST_TIME` or longer.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Increasing, s.
    q : ndarray, shape (n, n_joints)
    noise, step : ndarray, shape (n_joints,)
        Standard deviation of a sample, and step of the encoder.
    """
    count = int(np.ceil(REST_TIME / np.median(np.diff(t))))
    if not _FEWEST <= count <= len(t):
        return np.empty((0, 2), dtype=np.int64)
    half = count // 2
    # Of the windows of so many samples that begin at each.
    centre = slice(half, half + len(t) - count + 1)
    reach = (maximum_filter1d(q, count, axis=0) - minimum_filter1d(q, count, axis=0))[centre]
    sums = np.concatenate([np.zeros((1, q.shape[1])), np.cumsum(q - q[0], axis=0)])
    means = (sums[half:] - sums[:-half]) / half
    drift = np.abs(means[half : half + len(reach)] - means[: len(reach)])
    rounding = 1e-14 * np.abs(q).max(axis=0)
    spread = 2 * noise * (np.sqrt(2 * np.log(count)) + _GIVE) + step + rounding
    quiet = (reach <= spread) & (drift <= _SIGMAS * noise * np.sqrt(2 / half) + step / 2 + rounding)
    flags = np.concatenate([[False], quiet.all(axis=1), [False]])
    first, last = np.flatnonzero(flags[1:] & ~flags[:-1]), np.flatnonzero(flags[:-1] & ~flags[1:])
    spans = np.column_stack([first, last + count - 2])
    spans = spans[
        t[spans[:, 1]] - t[spans[:, 0]] >= _hidden(means[::half], half * float(np.median(np.diff(t))), spread)
    ]
    allowed = _SIGMAS * noise / np.sqrt(half) + step / 2 + rounding
    steady = [bool((np.ptp(means[a : b - half + 2 : half], axis=0) <= 2 * allowed).all()) for a, b in spans]
    return np.asarray(spans[np.array(steady, dtype=np.bool_)], dtype=np.int64)


def _hidden(means: Array, apart: float, spread: Array) -> float:
    """For how long noise may hide a turn with the motion's largest acceleration, in the joint that shows it best, s.

    It travels by ``a d^2 / 8`` in the time d; the means of samples are `apart` seconds apart.
    """
    if len(means) < 3:
        return np.inf
    acceleration = np.abs(np.diff(means, 2, axis=0)).max(axis=0) / apart**2
    return float(_LONGER * np.sqrt(8 * spread / np.maximum(acceleration, np.finfo(float).tiny)).min())


EndsRule = Literal["auto", "rest", "moving"]
# A value counts as zero within this many standard deviations: once in 16,000 normal draws it is not.
_END_SIGMAS: Final = 4.0
# And where it is this part of what the peak acceleration makes in one step: a quintic spline through 20 samples of a
# smooth move gets as much wrong beside an end.
_PART: Final = 0.02
# Of few samples a cubic spline differs by about what a quintic one misses; on 9 to 31 samples of a septic by a third.
_COARSE: Final = 3.0
# Where noise hides velocities of this part of the largest, more samples must be looked at.
_HIDDEN: Final = 0.05
# The influence of a sample on the spline fades by 0.43 from row to row.
_WINDOW: Final = 64
_FEWEST_SAMPLES: Final = 8
_DRAWS: Final = 32


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Ends:
    """Velocity and acceleration where a log begins and ends; zero where the samples do not tell them from zero.

    Attributes
    ----------
    slopes : ndarray, shape (2, 2, n_joints)
        Of start and end: velocity, acceleration.
    """

    slopes: Array

    @property
    def rests(self) -> tuple[bool, bool]:
        """Whether all joints are at rest at the start, and at the end."""
        return not self.slopes[0, 0].any(), not self.slopes[1, 0].any()

    def orders(self, j: int) -> tuple[int, int]:
        """How many derivatives of a joint, from the first, are zero at the start and at the end: 0, 1 or 2."""
        start, end = (0 if v else 1 if a else 2 for v, a in self.slopes[:, :, j])
        return start, end


def ends_of(t: Array, q: Array, noise: Array, step: Array, rule: EndsRule = "auto") -> Ends:
    """Whether a log begins and ends at rest, from the samples.

    Parameters
    ----------
    t : ndarray, shape (n,)
        From 0, s.
    q : ndarray, shape (n, n_joints)
    noise : ndarray, shape (n_joints,)
        Standard deviation of a sample.
    step : ndarray, shape (n_joints,)
        Of the encoders: beside a rest many samples have one value, and no average sees between two.
    rule : {"auto", "rest", "moving"}
        Look at the samples; or take both ends for rest, or neither. Fewer than eight samples are taken for rest.
    """
    if rule == "rest" or (rule == "auto" and len(t) < _FEWEST_SAMPLES) or len(t) < _FEWEST - 1:
        return Ends(slopes=np.zeros((2, 2, q.shape[1])))
    slopes, noisy, missed = _from_interpolation(t, q, noise)
    fastest = np.abs(np.diff(q, axis=0) / np.diff(t)[:, None]).max(axis=0)
    hidden = noisy[:, 0].max(axis=0) > _HIDDEN * fastest
    if hidden.any():
        seen = (slopes, noisy, missed), _from_smoothing(t, q, step, hidden)
        slopes, noisy, missed = (np.where(hidden, smooth, plain) for plain, smooth in zip(*seen, strict=True))
    zero = np.abs(slopes) <= np.maximum(noisy, missed)
    # What is at rest has a zero velocity first; an acceleration counts as zero only then.
    zero[:, 1] &= zero[:, 0]
    if rule == "moving":
        zero[:] = False
    return Ends(slopes=np.where(zero, 0.0, slopes))


def _from_interpolation(t: Array, q: Array, noise: Array) -> tuple[Array, Array, Array]:
    """Slopes at both ends of the spline without conditions, what noise makes of them, and what it misses."""
    rng = np.random.default_rng(0)
    apart = float(np.median(np.diff(t)))
    slopes, noisy, missed = (np.empty((2, 2, q.shape[1])) for _ in range(3))
    for end, part in ((0, slice(None, _WINDOW)), (1, slice(-_WINDOW, None))):
        times = t[part] - t[part][0]
        spline = interpolated(times, q[part])
        slopes[end] = end_slopes(spline)[end]
        draws = end_slopes(interpolated(times, rng.standard_normal((len(times), _DRAWS))))[end]
        noisy[end] = _END_SIGMAS * np.sqrt((draws**2).mean(axis=1))[:, None] * noise
        coarse = _COARSE * np.abs(end_slopes(make_interp_spline(times, q[part], k=3))[end] - slopes[end])
        missed[end] = np.maximum(coarse, _truncated(np.abs(spline(times, nu=2)).max(axis=0), apart))
    return slopes, noisy, missed


def _truncated(accelerations: Array, apart: float) -> Array:
    """Velocity and acceleration that count as none, of the peak accelerations and the step of time, (2, n_joints)."""
    return _PART * np.stack([accelerations * apart, accelerations])


def _from_smoothing(t: Array, q: Array, steps: Array, wanted: NDArray[np.bool_]) -> tuple[Array, Array, Array]:
    """The same of the smoothing spline of the wanted joints; it averages over many samples."""
    rng = np.random.default_rng(0)
    knots = even_knots(t)
    breaks = np.unique(knots)
    slopes, noisy, missed = (np.zeros((2, 2, q.shape[1])) for _ in range(3))
    for j in np.flatnonzero(wanted):
        fit = smooth_joint(t, q[:, j], knots, weights=np.ones(len(t)))
        spline = BSpline(knots, fit.coefficients, DEGREE)
        slopes[:, :, j] = end_slopes(spline)
        draws = end_slopes(BSpline(knots, fit.draws(_DRAWS, rng), DEGREE))
        between = steps[j] / breaks[1] ** np.array([1.0, 2.0])
        noisy[:, :, j] = _END_SIGMAS * np.sqrt((draws**2).mean(axis=2)) + between
        missed[:, :, j] = _truncated(np.abs(spline(breaks, nu=2)).max(), float(breaks[1]))
    return slopes, noisy, missed
