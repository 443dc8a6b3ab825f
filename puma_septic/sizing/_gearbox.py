"""What a gearbox is asked for at its output, by the procedure of its makers."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.sizing._loads import JointLoad
from puma_septic.validation import checked_array, checked_number

__all__ = ["allowed_momentary_peaks", "average_load_torque", "average_torque", "expected_life"]

# Harmonic Drive, engineering data HFUS-2A p. 19 and CSD-2A p. 20: wear grows with the cube of the torque.
_EXPONENT: Final = 3.0
_MOMENTARY_PEAKS: Final = 1e4  # the same data, p. 19


def average_torque(torques: ArrayLike, speeds: ArrayLike, durations: ArrayLike) -> float:
    """Cubic mean of the torque, weighted by speed: ``(sum |n T^3| t / sum |n| t)^(1/3)``.

    Parameters
    ----------
    torques, speeds, durations : array_like, shape (k,)
        Of the parts of a tabulated cycle, at the gearbox's output: N m, any unit of speed, s. A rest drops out.

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
    duration = checked_array("durations", durations, (len(torque),), unit="s")
    if (duration < 0).any():
        raise InputError(f"durations[{int(np.argmax(duration < 0))}] = {duration.min():g} s must be at least 0 s")
    travel = np.abs(speed) * duration
    if not travel.sum() > 0:
        raise InputError("nothing turns in this cycle: its average torque, weighted by speed, is not defined")
    mean = (travel * np.abs(torque) ** _EXPONENT).sum() / travel.sum()
    return float(mean ** (1 / _EXPONENT))


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


def average_load_torque(load: JointLoad) -> float:
    """The same over a cycle, ``(integral |v| |tau|^3 / integral |v|)^(1/3)``, N m; NaN where the joint never moves."""
    if not load.moves:
        return np.nan
    if not np.isnan(load.unbounded):
        return np.inf
    # |v| |tau|^3 is |v tau| tau^2, and the power has one sign on each interval.
    power = (load.torque * load.velocity).by_interval(load.power_sign)
    weighted = float(power.inner(load.torque * load.torque)[0])
    return float((max(weighted, 0.0) / (load.mean_speed * load.duration)) ** (1 / _EXPONENT))


def expected_life(
    rated_life: float, *, rated_torque: float, rated_speed: float, average_torque: float, average_speed: float
) -> float:
    """Life in the unit of the rated one: ``rated_life (n_rated / n_average) (T_rated / T_average)^3``.

    Harmonic Drive, engineering data CSD-2A, p. 20, for the wave generator's bearing. Infinite without load or motion.
    """
    # Ratios first: a cube of a torque overflows long before it means anything.
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        lighter = np.power(np.divide(rated_torque, average_torque), _EXPONENT)
        return float(rated_life * np.divide(rated_speed, average_speed) * lighter)
