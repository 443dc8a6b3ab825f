"""What a gearbox is asked for at its output, by the procedure of its makers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.drives import Gearbox
from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._loads import JointLoad, kept_by_load
from puma_septic.validation import Array, checked_array, checked_number

__all__ = [
    "RULES",
    "GearRule",
    "allowed_momentary_peaks",
    "allowed_rare_peaks",
    "average_load_torque",
    "average_torque",
    "expected_life",
    "lives",
    "weighted_power_mean",
]

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


_WHOLE: Final = 3.0  # the exponent for which the mean is an integral of series
_MOMENTARY_PEAKS: Final = 1e4  # Harmonic Drive, engineering data HFUS-2A, p. 19
# Beckhoff, AG2400 operating instructions, data of TP010 to TP500 (infosys.beckhoff.com): "possible 1000 times during
# the service life".
_PLANETARY_STOPS: Final = 1e3
_HARMONIC: Final = "Harmonic Drive: engineering data HFUS-2A, p. 19"
_HARMONIC_LIFE: Final = "Harmonic Drive: engineering data CSD-2A, p. 20"
_BECKHOFF: Final = "Beckhoff: AG2400 operating instructions"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class GearRule:
    """How makers of one type of gear rate wear and rare peaks.

    Attributes
    ----------
    exponent : float
        Of the torque, in the average and in the life.
    average, peaks, life : str
        Sources of the average torque's rule, of the peaks' limits, and of the life's.
    median_life : float
        L50 over L10; NaN: not told.
    rare_peaks : float
        How many momentary peaks a gear bears; NaN: by another rule, or not told.
    """

    exponent: float
    average: str
    peaks: str
    life: str
    median_life: float = np.nan
    rare_peaks: float = np.nan


# Wave generator's bearing: Harmonic Drive CSD-2A, p. 20 (L10 about a fifth of L50). Cycloidal: the life is that of the
# crankshafts' roller bearings, whose exponent ISO 281 gives as 10/3. Planetary: makers state T_2N, T_2B and the
# emergency torque; the cubic mean is taken over from strain wave gears.
_STRAIN_WAVE: Final = GearRule(exponent=3.0, average=_HARMONIC, peaks=_HARMONIC, life=_HARMONIC_LIFE, median_life=5.0)
RULES: Final = {
    "": _STRAIN_WAVE,
    "strain wave": _STRAIN_WAVE,
    "cycloidal": GearRule(
        exponent=10 / 3, average="ISO 281, roller bearings (10/3)", peaks="data sheet",
        life="ISO 281, roller bearings (10/3)",
    ),
    "planetary": GearRule(
        exponent=3.0, average=f"{_BECKHOFF}, T_2N; cubic mean", peaks=f"{_BECKHOFF}, T_2B and T_2Em.stop",
        life="data sheet; cubic mean", rare_peaks=_PLANETARY_STOPS,
    ),
}  # fmt: skip
"""By the kind of a `Gearbox`."""


def average_torque(torques: ArrayLike, speeds: ArrayLike, durations: ArrayLike, *, exponent: float = 3.0) -> float:
    """Mean of the torque to a power, weighted by speed: ``(sum |n| |T|^p t / sum |n| t)^(1/p)``.

    Parameters
    ----------
    torques, speeds, durations : array_like, shape (k,)
        Of the parts of a tabulated cycle, at the gearbox's output: N m, any unit of speed, s. A rest drops out.
    exponent : float
        p: 3 for strain wave and planetary gears, 10/3 for cycloidal ones.

    Returns
    -------
    float
        N m.

    Raises
    ------
    InputError
        For different lengths, a negative duration, or a cycle in which nothing turns.

    Notes
    -----
    Harmonic Drive, engineering data HFUS-2A, p. 19. Their example, printed as 89 N m:

    Examples
    --------
    >>> average_torque([150, 82, 130, 0], [10, 20, 10, 0], [0.2, 3, 0.3, 0.2])
    89.387...
    """
    torque = checked_array("torques", torques, (None,), unit="N m")
    speed = checked_array("speeds", speeds, (len(torque),))
    duration = checked_array("durations", durations, (len(torque),), unit="s", at_least=0.0)
    travel = np.abs(speed) * duration
    if not travel.sum() > 0:
        raise InputError("nothing turns in this cycle: its average torque, weighted by speed, is not defined")
    power = checked_number("exponent", exponent, at_least=1.0)
    return float(((travel * np.abs(torque) ** power).sum() / travel.sum()) ** (1 / power))


def allowed_momentary_peaks(input_speed: float, duration: float) -> float:
    """How many momentary peaks a strain-wave gear bears: ``10^4 / (2 turns)``, turns of the input during one peak.

    Harmonic Drive, engineering data HFUS-2A, p. 19; at most 10^4.

    Parameters
    ----------
    input_speed : float
        rad/s.
    duration : float
        Of one peak, s.

    Examples
    --------
    >>> allowed_momentary_peaks(2 * np.pi * 50, 0.2)
    500.0
    """
    speed = checked_number("input_speed", input_speed, unit="rad/s", above=0.0)
    turns = speed / (2 * np.pi) * checked_number("duration", duration, unit="s", above=0.0)
    return float(min(_MOMENTARY_PEAKS / (2 * turns), _MOMENTARY_PEAKS))


def average_load_torque(load: JointLoad, exponent: float = 3.0) -> float:
    """The same over a cycle, ``(integral |v| |tau|^p / integral |v|)^(1/p)``, N m; NaN where the joint never moves.

    Returns
    -------
    float
    """
    if not load.moves:
        return np.nan
    if not np.isnan(load.unbounded):
        return np.inf
    if exponent != _WHOLE:
        return _power_mean(load, exponent)
    # |v| |tau|^3 is |v tau| tau^2, and the power has one sign on each interval.
    power = (load.torque * load.velocity).by_interval(load.power_sign)
    weighted = float(power.inner(load.torque * load.torque)[0])
    return float((max(weighted, 0.0) / (load.mean_speed * load.duration)) ** (1 / _WHOLE))


@kept_by_load
def _power_mean(load: JointLoad, exponent: float) -> float:
    return weighted_power_mean(load.torque * load.torque, load.speed, exponent)


def expected_life(
    rated_life: float,
    *,
    rated_torque: float,
    rated_speed: float,
    average_torque: float,
    average_speed: float,
    exponent: float = 3.0,
) -> float:
    """Life in the unit of the rated one: ``rated_life (n_rated / n_average) (T_rated / T_average)^p``.

    Harmonic Drive, engineering data CSD-2A, p. 20, for the wave generator's bearing (p = 3). Infinite without load or
    motion.

    Returns
    -------
    float
    """
    # Ratios first: a power of a torque overflows long before it means anything.
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        lighter = np.power(np.divide(rated_torque, average_torque), exponent)
        return float(rated_life * np.divide(rated_speed, average_speed) * lighter)


def lives(gearbox: Gearbox, life: float) -> tuple[float, float]:
    """L10 and L50 of a life in the measure of the gearbox's rated one, h; NaN where its basis or maker does not tell.

    Returns
    -------
    tuple of float
    """
    many = RULES[gearbox.kind].median_life
    if gearbox.life_basis == "L50":
        return life / many, life
    return (life, life * many) if gearbox.life_basis == "L10" else (np.nan, np.nan)


def allowed_rare_peaks(gearbox: Gearbox, *, input_speed: float, duration: float) -> float:
    """How many momentary peaks a gearbox bears in its life; NaN: not known.

    Strain wave gears: `allowed_momentary_peaks`; planetary ones: 1000.

    Parameters
    ----------
    gearbox : Gearbox
    input_speed : float
        While a peak lasts, rad/s.
    duration : float
        Of one peak, s; NaN: not known.

    Returns
    -------
    float
    """
    rule = RULES[gearbox.kind]
    if gearbox.kind in ("", "strain wave"):
        is_known = not np.isnan(duration) and input_speed > 0
        return allowed_momentary_peaks(input_speed, duration) if is_known else np.nan
    return rule.rare_peaks
