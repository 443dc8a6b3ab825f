"""Colours of the replay: by utilisation, by motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.pictures import profile_line
from puma_septic.validation import Array

__all__ = ["NEUTRAL", "UTILISATION", "as_hex", "colour_at", "profile_colour"]

# From rest over half to the limit: a light grey as arms are painted, yellow, red. No profile has any of the three, so
# that no link is taken for a ghost; they differ for eyes that confuse red and green, and the page writes every number
# beside its colour.
UTILISATION: Final = ((0.84, 0.86, 0.88), (0.97, 0.80, 0.16), (0.78, 0.06, 0.14))
# A link whose effort limit is not known, and the base, which carries no joint.
NEUTRAL: Final = (0.42, 0.45, 0.49)


def colour_at(stops: Sequence[Sequence[float]], x: ArrayLike) -> Array:
    """Red, green and blue (0 to 1) at x, shape (n,), on evenly spaced stops; beyond 0 and 1 the ends.

    Where x is not known (NaN), `NEUTRAL`.
    """
    values = np.asarray(x, dtype=np.float64)
    where = np.linspace(0.0, 1.0, len(stops))
    mixed = np.stack([np.interp(values, where, channel) for channel in zip(*stops, strict=True)], axis=-1)
    return np.where(np.isnan(values)[..., None], NEUTRAL, mixed)


def as_hex(colour: Sequence[float]) -> str:
    """A colour as a page writes it.

    Examples
    --------
    >>> as_hex((1.0, 0.5, 0.0))
    '#ff8000'
    """
    return "#" + "".join(f"{round(255 * channel):02x}" for channel in colour)


def profile_colour(k: int) -> tuple[float, ...]:
    """Red, green and blue (0 to 1) of the k-th motion: the colour of its curves in all charts.

    Examples
    --------
    >>> as_hex(profile_colour(0))
    '#0072b2'
    """
    return tuple(channel / 255 for channel in bytes.fromhex(profile_line(k).hue.light[1:]))
