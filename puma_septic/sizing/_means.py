"""Means of a magnitude to a power that is no whole number, as roller bearings are rated by."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np

from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["weighted_power_mean"]

# Gauss points per interval: a magnitude that is zero at an interval's end grows from there as t^(10/3) or slower, which
# this many integrate to 1e-14.
_POINTS: Final = 64


@lru_cache(maxsize=1)
def _gauss() -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(_POINTS)


def weighted_power_mean(square: Piecewise, weight: Piecewise, exponent: float) -> float:
    """``(integral w |f|^p / integral w)^(1/p)`` of the f whose square is given; NaN where there is no weight.

    The square is split where it turns, so that f has its zeros at the ends of intervals.

    Parameters
    ----------
    square : Piecewise
        ``f^2``, not negative, rounding apart; one component.
    weight : Piecewise
        Not negative.
    exponent : float
        p, at least 1.

    Returns
    -------
    float
    """
    total = float(weight.integral()(weight.breaks[-1])[0])
    if not total > 0:
        return np.nan
    square = square.aligned_with(weight)
    square = square.split(square.derivative().roots()[0])
    weight = weight.aligned_with(square)
    square = square.aligned_with(weight)
    x, gauss = _gauss()
    lengths = square.lengths
    piece, points = np.repeat(np.arange(len(lengths)), _POINTS), np.tile(x, len(lengths))
    powers = np.maximum(square.at(piece, points)[:, 0], 0.0) ** (exponent / 2) * weight.at(piece, points)[:, 0]
    integral = float((powers.reshape(-1, _POINTS) @ gauss) @ lengths / 2)
    return float((max(integral, 0.0) / total) ** (1 / exponent))
