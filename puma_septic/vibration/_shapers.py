"""Input shapers: a motion as a sum of delayed copies of itself that leaves no vibration at a mode."""

from __future__ import annotations

import functools
import operator
from dataclasses import dataclass, replace
from math import comb
from typing import Final, final

import numpy as np

from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array, checked_choice, checked_kind, checked_number, checked_times
from puma_septic.vibration._spectrum import checked_damping

__all__ = ["SHAPERS", "Shaper", "input_shaper", "shaped"]

SHAPERS: Final = {"zv": 1, "zvd": 2, "zvdd": 3}
"""Input shapers by name, and how many half periods each lengthens a motion by."""

# Weights that sum to 1 keep the end point; this much is rounding.
_SUM: Final = 1e-12


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Shaper:
    """Weights and delays of the copies that a motion is made into.

    Parameters
    ----------
    weights : array_like, shape (k,)
        Positive, with the sum 1, so that the shaped motion stays within the hull of the original and ends there.
    delays : array_like, shape (k,)
        s, increasing, the first 0.
    name : str

    Raises
    ------
    InputError
        For weights or delays that are not so.
    """

    weights: Array
    delays: Array
    name: str = "shaper"

    def __post_init__(self) -> None:
        checked_kind("name", self.name, str)
        object.__setattr__(self, "delays", checked_times("delays", self.delays))
        object.__setattr__(self, "weights", checked_array("weights", self.weights, (len(self.delays),), above=0.0))
        if abs(self.weights.sum() - 1) > _SUM:
            raise InputError(f"weights = {self.weights.tolist()}: their sum must be 1")
        if len(self.delays) == 0 or self.delays[0] != 0:
            raise InputError(f"delays = {self.delays.tolist()} s: the first must be 0")


def input_shaper(name: str, frequency: float, *, damping: float = 0.0) -> Shaper:
    """The zero-vibration shaper for a mode, and its more robust versions.

    With ``K = exp(-damping pi / sqrt(1 - damping^2))`` and the damped half period ``d``, ZV has the weights 1 and K at
    0 and d, over their sum (Smith's posicast, 1957). ZVD, with 1, 2 K, K^2 at 0, d, 2 d, also makes the derivative of
    the residual vibration by the frequency zero, and ZVDD, with 1, 3 K, 3 K^2, K^3, the second one (Singer, Seering,
    "Preshaping command inputs to reduce system vibration", J. Dyn. Sys., Meas., Control 112 (1), 1990, pp. 76-82).

    Parameters
    ----------
    name : {"zv", "zvd", "zvdd"}
    frequency : float
        Natural frequency of the undamped mode, Hz.
    damping : float
        Its damping ratio, from 0 to below 1.

    Returns
    -------
    Shaper

    Raises
    ------
    InputError
        For an unknown name, or a frequency or damping ratio out of range.

    Examples
    --------
    >>> zvd = input_shaper("zvd", 5.0)
    >>> zvd.weights.tolist(), zvd.delays.tolist()
    ([0.25, 0.5, 0.25], [0.0, 0.1, 0.2])
    """
    count = SHAPERS[checked_choice("shaper", name, SHAPERS)]
    hertz = checked_number("frequency", frequency, unit="Hz", above=0.0)
    damping = checked_damping(damping)
    root = np.sqrt(1 - damping**2)
    decay = np.exp(-damping * np.pi / root)
    weights = np.array([comb(count, k) * decay**k for k in range(count + 1)]) / (1 + decay) ** count
    return Shaper(weights=weights, delays=np.arange(count + 1) * 0.5 / (hertz * root), name=f"{name} {hertz:g} Hz")


def shaped(trajectory: Trajectory, shaper: Shaper) -> Trajectory:
    """A motion through an input shaper: the weighted sum of its delayed copies, exactly.

    ``q(t) = sum_k weights[k] q_0(t - delays[k])``, where q_0 stays at its first point before and at its last point
    after the motion. It is a `Trajectory` like any other, so that its torque and limits are exact. Every oscillation is
    weighted likewise: what two shapers null, both do one after the other. Between its ends it does not visit the points
    of the original.

    Parameters
    ----------
    trajectory : Trajectory
        From rest to rest.
    shaper : Shaper

    Returns
    -------
    Trajectory
        Longer by the last delay, its points the first and the last.

    Raises
    ------
    InputError
        For a motion that begins or ends moving.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0], [1.0]], [0.0, 0.5])
    >>> gentle = shaped(move, input_shaper("zv", 5.0))
    >>> gentle.duration, bool(ps.residual_vibration(gentle, 5.0)[0] < 1e-15)
    (0.6, True)
    """
    checked_kind("shaper", shaper, Shaper)
    if not (checked_kind("trajectory", trajectory, Trajectory).rest_before and trajectory.rest_after):
        raise InputError("an input shaper needs a motion from rest to rest; this one is an excerpt")
    position = trajectory.position
    total = float(shaper.delays[-1])
    copies = (
        _delayed(position, float(delay), total) * float(weight)
        for weight, delay in zip(shaper.weights, shaper.delays, strict=True)
    )
    function = functools.reduce(operator.add, copies).shifted(position.start)
    left, right = position.ends()
    return replace(
        trajectory,
        position=function,
        points=np.array([left[0], right[-1]]),
        times=function.breaks[[0, -1]],
        profile=f"{trajectory.profile}, {shaper.name}",
    )


def _delayed(position: Piecewise, delay: float, total: float) -> Piecewise:
    """The motion after a rest of `delay`, followed by one that fills up the duration to `total` beyond its own."""
    left, right = position.ends()
    parts = [Piecewise.constant(left[0], delay)] if delay else []
    parts.append(position)
    return Piecewise.sequence([*parts, *([Piecewise.constant(right[-1], total - delay)] if total > delay else [])])
