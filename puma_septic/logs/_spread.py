"""What the noise of the samples leaves unknown of a fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from scipy.interpolate import BSpline

from puma_septic.logs._smoothing import Smoothed
from puma_septic.logs._spline import as_spline, end_slopes, interpolated
from puma_septic.validation import Array

__all__ = ["Spread", "noise_doubts"]

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


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Spread:
    """A spline, and the deviations from it that the samples do not rule out.

    Attributes
    ----------
    spline : BSpline
        From time 0, values of shape (..., n_joints).
    noise : ndarray, shape (n_joints,)
        Standard deviation of the noise of a sample, rad (m).
    parts : tuple of Smoothed
        One for each joint where the spline does not pass through the samples, else empty.
    between : float or ndarray, shape (n_joints,)
        By how much a spline through the samples may miss the motion between them, rad (m).
    is_regularised : bool
        Whether the smoothness was chosen by likelihood, so that little noise is left in the spline itself.
    """

    spline: BSpline
    noise: Array
    parts: tuple[Smoothed, ...]
    between: Array | float = 0.0
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
        t, n = np.unique(self.spline.t), len(self.noise)
        noise = (rng.standard_normal((len(t), n, count)) * self.noise[:, None]).reshape(len(t), -1)
        # Where the log moves at an end, its slopes there are as unsure as the noise makes them.
        sizes = np.stack([np.abs(self.spline(t, nu=order)).max(axis=0) for order in (1, 2)])
        known = np.repeat(np.abs(end_slopes(self.spline)) <= _ZERO * sizes, count, axis=2)
        ends = np.zeros(known.shape) if known.all() else np.where(known, 0.0, end_slopes(interpolated(t, noise)))
        spline = interpolated(t, noise, ends)
        return BSpline(spline.t, spline.c.reshape(-1, n, count), spline.k)

    def deviation(self, order: int) -> Array:
        """RMS over time of the deviations of the derivative of an order, shape (n_joints,)."""
        values = self.draws(_DRAWS)(self._middles, nu=order)
        return np.asarray(np.sqrt((values**2).mean(axis=(0, 2))))

    def rms(self, order: int) -> Array:
        """RMS over time of the spline's derivative of an order, shape (n_joints,)."""
        return np.asarray(np.sqrt((self.spline(self._middles, nu=order) ** 2).mean(axis=0)))

    @property
    def _middles(self) -> Array:
        breaks = np.unique(self.spline.t)
        return np.asarray((breaks[:-1] + breaks[1:]) / 2)

    @property
    def travel_at_rest(self) -> Array:
        """Travel of the spline that may be none of the joint, rad (m), shape (n_joints,)."""
        noise = _OF_DEVIATIONS * self.deviation(0) if self.parts else _OF_SAMPLES * self.noise
        return np.asarray(np.maximum(noise, self.between))


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
