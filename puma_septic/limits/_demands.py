"""What a motion demands of its joints as polynomials of a parameter, held against limits."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from math import comb
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["AT", "Demand", "Rows"]

AT: Final = 1e-12
"""A share of a limit that exceeds 1 by no more is at it: some hundred roundings of the terms of a demand."""

# Instants of each interval that are looked at first, as a multiple of the degree, and at least.
_OVERSAMPLED: Final = 2
_LEAST: Final = 12
# Of a motion with many intervals, so many instants in all.
_MOST_FIRST: Final = 4000


@final
@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Polynomials of x that must not be positive within a window of x each.

    Attributes
    ----------
    polynomials : ndarray, shape (n, powers)
        Ascending.
    windows : ndarray, shape (n, 2)
    """

    polynomials: Array
    windows: Array

    @classmethod
    def within(cls, shares: Array) -> Rows:
        """Shares of a limit, polynomials (n, powers), that must stay within -1 and 1."""
        both = np.concatenate([shares, -shares])
        both[:, 0] -= 1 + AT
        return cls(both, np.tile([0.0, np.inf], (len(both), 1)))

    def bound(self) -> float:
        """Some x beyond which one of them is positive, by the bound of all roots of Fujiwara (1916); else infinite."""
        open_ = np.isinf(self.windows[:, 1]) & (self.polynomials[:, -1] > 0)
        size = np.abs(self.polynomials[open_])
        top = size.shape[1] - 1
        roots = (size[:, :top] / size[:, top:]) ** (1 / np.arange(top, 0, -1))
        return float(2 * roots.max(axis=1, initial=0.0).min(initial=np.inf))


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Demand:
    """One quantity of some joints: at each instant ``sum_k parts[k] x^k``, as a share of the limit.

    Attributes
    ----------
    quantity : str
        Of `LimitCheck`.
    joints : ndarray of int, shape (m,)
        Those whose limit is known.
    shape : Piecewise
        The parts side by side, ``m powers`` components: power by power, then joint.
    n_powers : int
        Degree in x plus one, at least 2.
    """

    quantity: str
    joints: NDArray[np.int64]
    shape: Piecewise
    n_powers: int

    @classmethod
    def of(cls, quantity: str, parts: Sequence[Piecewise | None], limit: Array) -> Demand | None:
        """From the parts by power (None: zero), of all joints, and their limits; None where no limit is known."""
        joints = np.flatnonzero(~np.isnan(limit))
        if not len(joints):
            return None
        given = [part for part in parts if part is not None]
        whole = functools.reduce(Piecewise.aligned_with, given)
        size = max(part.degree for part in given) + 1
        series = np.zeros((size, len(whole.lengths), len(parts), len(joints)))
        for k, part in enumerate(parts):
            if part is not None:
                aligned = part.aligned_with(whole)
                series[: len(aligned.coefficients), :, k] = aligned.coefficients[:, :, joints] / limit[joints]
        shape = Piecewise(breaks=whole.breaks, coefficients=series.reshape(size, len(whole.lengths), -1))
        return cls(quantity=quantity, joints=joints, shape=shape, n_powers=len(parts))

    def first_instants(self) -> Array:
        """Chebyshev points all over the motion, and its breaks."""
        count = max(_LEAST, min(_OVERSAMPLED * self.shape.degree, _MOST_FIRST // len(self.shape.lengths)))
        x = np.sin(np.pi * (np.arange(count) + 0.5 - count / 2) / count)
        left, right = self.shape.breaks[:-1, None], self.shape.breaks[1:, None]
        return np.concatenate([((left * (1 - x) + right * (1 + x)) / 2).ravel(), self.shape.breaks])

    def rows(self, times: Array) -> Rows:
        """What must hold at some instants, on both sides of every break among them."""
        values = values_beside(self.shape, times)
        by_power = values.reshape(len(values), self.n_powers, len(self.joints))
        return Rows.within(by_power.transpose(0, 2, 1).reshape(-1, self.n_powers))

    def peaks(self, x: Array) -> tuple[Array, Array]:
        """Largest share over time at some values x, and its instant, each of shape (len(x), m)."""
        return self._peaks(x[:, None] ** np.arange(self.n_powers))

    def control_peaks(self, parts: Array) -> tuple[Array, Array]:
        """The same of the control values of Bernstein's form on parts (n, 2) of x, of shape (n, degree + 1, m).

        The demand at any x of a part is no larger than the largest of them; the first and the last are those of its
        ends.
        """
        weights = control_weights(parts, self.n_powers - 1)
        share, times = self._peaks(weights.reshape(-1, self.n_powers))
        return share.reshape(*weights.shape[:2], -1), times.reshape(*weights.shape[:2], -1)

    def _peaks(self, weights: Array) -> tuple[Array, Array]:
        """Largest magnitude over time of ``sum_k parts[k] weights[f, k]`` and its instant, each of shape (f, m)."""
        size, n, _ = self.shape.coefficients.shape
        series = self.shape.coefficients.reshape(size, n, self.n_powers, -1)
        combined = np.tensordot(series, weights, axes=(2, 1)).transpose(0, 1, 3, 2).reshape(size, n, -1)
        found = Piecewise(breaks=self.shape.breaks, coefficients=combined).extrema()
        return found.peak.reshape(len(weights), -1), found.t_peak.reshape(len(weights), -1)


def values_beside(function: Piecewise, times: Array) -> Array:
    """Values at some instants, on both sides of every break among them, shape (k, components)."""
    left, right = function.ends()
    breaks = function.breaks
    return np.concatenate([function(times), left[np.isin(breaks[:-1], times)], right[np.isin(breaks[1:], times)]])


def control_weights(parts: Array, degree: int) -> Array:
    """Weights of the powers of x in the control values of Bernstein's form on parts (n, 2): (n, degree + 1, powers).

    Control value i is the blossom at `degree` - i times the left end and i times the right one: of ``x^k`` their
    k-th elementary symmetric function over its number of terms (Farouki, CAGD 29, 2012, 379-419).
    """
    left, right = parts.T
    weights = np.zeros((len(parts), degree + 1, degree + 1))
    for i in range(degree + 1):
        for k in range(degree + 1):
            for r in range(max(0, k - (degree - i)), min(i, k) + 1):
                ways = comb(i, r) * comb(degree - i, k - r) / comb(degree, k)
                weights[:, i, k] += ways * right**r * left ** (k - r)
    return weights
