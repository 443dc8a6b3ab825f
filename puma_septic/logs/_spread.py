"""What the noise of the samples leaves unknown of a fit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, final

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from puma_septic.logs._breaks import Break
from puma_septic.logs._smoothing import Smoothed
from puma_septic.logs._spline import DEGREE, as_spline, end_slopes, interpolated
from puma_septic.validation import Array

__all__ = ["Spread", "noise_doubts", "sample_doubts", "sample_remarks", "through", "unresolved", "velocity_step_doubts"]

# Travel of a joint at rest, in standard deviations: of a sample where the spline passes through the samples, of the
# spline's own deviations where it is smoothed.
_OF_SAMPLES: Final = 8.0
_OF_DEVIATIONS: Final = 4.0
# Noise spoils the jerk where it makes this part of its RMS value; jitter of stamps makes up to three times what is
# estimated, as it acts where the arm is fast.
_SPOILT: Final = 0.3
_DRAWS: Final = 8
# What is set to zero comes out of the spline's arithmetic as this part of the largest.
_ZERO: Final = 1e-9
# Samples in which a coarser spline is worth a comparison.
_FEWEST: Final = 7
_CUBIC: Final = 3
# Times the error that the observed order of convergence tells.
_CAUTION: Final = 4.0
_TINY: Final = float(np.finfo(float).tiny)
# Below what rounding leaves there is nothing to be seen.
_ROUNDING: Final = 1e-14
# What the samples leave unknown of the acceleration's peak: told from the first part of it on, no verdict from the
# other.
_TOLD, _TOO_MUCH = 1e-4, 0.05
# A joint whose acceleration is this part of the largest matters no more by what is unknown of it.
_SLIGHT: Final = 1e-3


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Spread:
    """A spline, and the deviations from it that the samples do not rule out.

    Attributes
    ----------
    spline : BSpline
        From time 0, values of shape (..., n_joints).
    times : ndarray, shape (k,)
        Of the samples that it was made from, s.
    noise : ndarray, shape (n_joints,)
        Standard deviation of the noise of a sample, rad (m).
    parts : tuple of Smoothed
        One for each joint where the spline does not pass through the samples, else empty.
    breaks : tuple
        Of each joint, where derivatives of a spline through the samples step.
    coarse : tuple of BSpline
        Splines through every other, and every fourth of the samples, with the same breaks; empty where there are too
        few, or where the spline does not pass through the samples.
    is_regularised : bool
        Whether the smoothness was chosen by likelihood, so that little noise is left in the spline itself.
    """

    spline: BSpline
    times: Array
    noise: Array
    parts: tuple[Smoothed, ...]
    breaks: tuple[tuple[Break, ...], ...] = ()
    coarse: tuple[BSpline, ...] = ()
    is_regularised: bool = False

    def draws(self, count: int, *, seed: int = 0) -> BSpline:
        """Deviations from the spline, values of shape (..., n_joints, count).

        Of a spline through the samples: what their noise makes of it. Of a smoothed one: draws from the distribution
        of the motion given the samples, with its prior of a jerk that is white noise; their spread holds noise and
        bias (Nychka, J. Am. Stat. Assoc. 83, 1988).
        """
        rng = np.random.default_rng(seed)
        if self.parts:
            return as_spline(self.spline.t, [part.draws(count, rng) for part in self.parts])
        t, n = self.times, len(self.noise)
        noise = rng.standard_normal((len(t), n, count)) * self.noise[:, None]
        # Where the log moves at an end, its slopes there are as unsure as the noise makes them.
        sizes = np.stack([np.abs(self.spline(t, nu=order)).max(axis=0) for order in (1, 2)])
        known = np.abs(end_slopes(self.spline)) <= _ZERO * sizes
        ends = np.zeros((2, 2, n, count))
        if not known.all():
            ends[~known] = end_slopes(interpolated(t, noise, None, self.breaks))[~known]
        return interpolated(t, noise, ends, self.breaks)

    def deviation(self, order: int) -> Array:
        """RMS over time of the deviations of the derivative of an order, shape (n_joints,)."""
        if not self.noise.any():
            return np.zeros(len(self.noise))
        values = self.draws(_DRAWS)(self._middles, nu=order)
        return np.asarray(np.sqrt((values**2).mean(axis=(0, 2))))

    def rms(self, order: int) -> Array:
        """RMS over time of the spline's derivative of an order, shape (n_joints,)."""
        return np.asarray(np.sqrt((self.spline(self._middles, nu=order) ** 2).mean(axis=0)))

    @property
    def _middles(self) -> Array:
        breaks = np.unique(self.spline.t)
        return np.asarray((breaks[:-1] + breaks[1:]) / 2)

    def missed(self, order: int) -> Array:
        """By how much the peak of a derivative may be missed between the samples, (n_joints,); see `unresolved`."""
        if self.parts:
            return np.zeros(len(self.noise))
        return unresolved(*(spline(self.instants, nu=order) for spline in (self.spline, *self.coarse)), order=order)

    @property
    def instants(self) -> Array:
        """Two within each interval, s: what swings from sample to sample is seen there."""
        breaks = np.unique(self.spline.t)
        return np.sort(np.concatenate([breaks[:-1] + part * np.diff(breaks) for part in (0.25, 0.75)]))

    @property
    def travel_at_rest(self) -> Array:
        """Travel of the spline that may be none of the joint, rad (m), shape (n_joints,): both its ends may be off."""
        noise = _OF_DEVIATIONS * self.deviation(0) if self.parts else _OF_SAMPLES * self.noise
        return np.asarray(np.maximum(noise, 2 * self.between))

    @property
    def between(self) -> Array:
        """By how much a spline through the samples may miss the motion between them, rad (m), shape (n_joints,)."""
        return self.missed(0) if self.coarse else np.zeros(len(self.noise))


def through(
    t: Array, q: Array, noise: Array, ends: Array, breaks: tuple[tuple[Break, ...], ...], stride: int = 1
) -> Spread:
    """The spline through every so many of the samples, and those through fewer by which it is judged.

    Parameters
    ----------
    ends : ndarray, shape (2, 2, n_joints)
        Velocity and acceleration at the start, and at the end.
    """

    def every(step: int) -> BSpline:
        some = np.append(np.arange(0, len(t) - 1, step), len(t) - 1)
        return interpolated(t[some], q[some], ends, breaks)

    spline = every(stride)
    coarse = tuple(every(stride * step) for step in (2, 4) if len(t) >= _FEWEST * stride * step)
    if not coarse and len(t) > _CUBIC:
        coarse = (make_interp_spline(t, q, k=_CUBIC),)
    return Spread(spline=spline, times=t[::stride], noise=noise, parts=(), breaks=breaks, coarse=coarse)


def largest(values: Array) -> Array:
    """Largest magnitude of each column."""
    return np.asarray(np.abs(values).max(axis=0))


def unresolved(fine: Array, *coarse: Array, order: int = 2, size: Callable[[Array], Array] = largest) -> Array:
    """What a value from all samples may miss, of values (k, n) from all, every other and every fourth: shape (n,).

    With p the observed order of convergence, a fine value misses by ``1 / (2^p - 1)`` of what it differs by from the
    next; four times that is taken, but no more than the difference. Infinite where nothing can be held against it.

    The derivative of an order (2 for torque, which has the acceleration in it) of a quintic spline converges with
    ``p = 6 - order`` at most. Where it seems to be quicker by far, the coarsest spline fails elsewhere, such as where
    steps are close to each other, and tells nothing of the finer two: their difference is taken.
    """
    if not coarse:
        return np.full(fine.shape[1], np.inf)
    first, *more = (size(one - other) for one, other in pairwise((fine, *coarse)))
    seen = np.maximum(0.0, first - _ROUNDING * largest(fine))
    if not more:
        return seen
    ratio = first / np.maximum(more[0], _TINY)
    ratio = np.where(ratio < 0.5 ** (DEGREE + 1 - order) / 2, 1.0, ratio)
    return seen * np.minimum(1.0, _CAUTION * ratio)


def sample_doubts(spread: Spread, labels: Sequence[str]) -> tuple[str, ...]:
    """Why clean samples give no verdict: too little is known between them. Of noisy ones the noise tells it."""
    return () if spread.noise.any() else _between(spread, labels, _TOO_MUCH, np.inf)


def sample_remarks(spread: Spread, labels: Sequence[str]) -> tuple[str, ...]:
    """What the samples leave unknown between them, where it is more than one in 10,000 and gives no doubt."""
    return _between(spread, labels, _TOLD, _TOO_MUCH)


def _between(spread: Spread, labels: Sequence[str], least: float, most: float) -> tuple[str, ...]:
    """The joint of whose acceleration the largest part, from `least` to `most`, is not known between the samples."""
    if spread.parts:
        return ()
    peak = largest(spread.spline(spread.instants, nu=2))
    part = spread.missed(2) / np.maximum(peak, _SLIGHT * peak.max(initial=_TINY))
    j = int(np.argmax(part))
    if not least < part[j] <= most:
        return ()
    known = f"only to {part[j]:.2g} of its peak" if np.isfinite(part[j]) else "not at all, as they are too few"
    return (f"samples: between them the acceleration of {labels[j]} is known {known}",)


def velocity_step_doubts(spread: Spread, labels: Sequence[str]) -> tuple[str, ...]:
    """Whether a velocity really steps, or changes within one step of time, the samples cannot tell."""
    steps = [
        (one.time, label) for some, label in zip(spread.breaks, labels, strict=False) for one in some if one.order == 1
    ]
    if not steps:
        return ()
    time, label = min(steps)
    return (
        f"a step of velocity? {label} changes its velocity within one step of time at {time:.6g} s: the acceleration"
        " there is not known",
    )


def noise_doubts(spread: Spread, labels: Sequence[str]) -> tuple[str, ...]:
    """That the jerk is mostly noise, where it is."""
    if spread.is_regularised or not spread.noise.any():
        return ()
    noise, whole = spread.deviation(3), spread.rms(3)
    bad = np.flatnonzero(noise > _SPOILT * whole)
    if not len(bad):
        return ()
    j = int(bad[np.argmax(noise[bad] / np.maximum(whole[bad], np.finfo(float).tiny))])
    return (
        f"noise: the jerk is mostly noise ({labels[j]}: {noise[j]:.2g} of {whole[j]:.2g} rad/s^3 RMS; a sample is off"
        f" by {spread.noise[j]:.2g} rad); smoothing by 'auto' takes it out and tells what is left unknown",
    )
