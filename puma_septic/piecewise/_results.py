"""What a function of time is asked for: its extrema and its steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.validation import Array, frozen

__all__ = ["EQUAL", "Extrema", "Jumps"]

# Values that differ by less than this part are one: where a torque comes back, and on a processor of another kind, it
# differs by some hundred roundings.
EQUAL: Final = 1e-12


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Extrema:
    """Least and greatest values of each component, and when each is first reached.

    Attributes
    ----------
    min, max : ndarray, shape (m,)
    t_min, t_max : ndarray, shape (m,)
    """

    min: Array
    max: Array
    t_min: Array
    t_max: Array

    def __post_init__(self) -> None:
        # Kept by what they describe, which writing to them would falsify.
        for array in (self.min, self.max, self.t_min, self.t_max):
            frozen(array)

    @property
    def peak(self) -> Array:
        """Largest magnitude, shape (m,)."""
        return frozen(np.maximum(np.abs(self.min), np.abs(self.max)))

    @property
    def t_peak(self) -> Array:
        """Instant of the largest magnitude, the first where minimum and maximum are equal to rounding, shape (m,)."""
        down, up = np.abs(self.min), np.abs(self.max)
        first = np.minimum(self.t_min, self.t_max)
        return frozen(np.where(np.abs(down - up) <= EQUAL * up, first, np.where(down > up, self.t_min, self.t_max)))


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Jumps:
    """Steps of a function.

    Attributes
    ----------
    times : ndarray, shape (k,)
        s.
    sizes : ndarray, shape (k, m)
        Value after the instant less value before it.
    """

    times: Array
    sizes: Array

    def __post_init__(self) -> None:
        for array in (self.times, self.sizes):
            frozen(array)
