"""Which gear ratio suits a load: the optimum, and the window in which a motor is warm enough but not too hot.

For one efficiency in both directions, rotor inertia J and ratio N, the mean square of the motor's torque is
``J^2 N^2 mean(a^2) + mean(tau^2) / (efficiency N)^2 + 2 J mean(a tau) / efficiency``. The identities below follow from
it; they are those of Giberti, Cinquemani and Legnani, "The Role of the Gearbox in an Automatic Machine", eq. 23-28.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from puma_septic.piecewise import Piecewise
from puma_septic.sizing._loads import JointLoad
from puma_septic.validation import checked_number

__all__ = ["LoadMoments", "RatioWindow", "accelerating_factor", "load_moments", "ratio_window"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoadMoments:
    """Means over a cycle of what a motor must turn; a braked stretch counts with no torque and no acceleration.

    Attributes
    ----------
    torque_square, acceleration_square, product : float
        ``mean(tau^2)``, ``mean(a^2)`` and ``mean(a tau)`` at the joint.
    peak_speed : float
        At the joint.
    """

    torque_square: float
    acceleration_square: float
    product: float
    peak_speed: float

    @property
    def load_factor(self) -> float:
        """``2 (rms(a) rms(tau) + mean(a tau))``, W/s: the least accelerating factor of an ideal drive."""
        return 2 * (float(np.sqrt(self.acceleration_square * self.torque_square)) + self.product)

    def optimal_ratio(self, inertia: float, *, efficiency: float = 1.0) -> float:
        """Ratio of the least RMS motor torque, ``sqrt(rms(tau) / (efficiency J rms(a)))``; infinite without motion."""
        inertia = checked_number("inertia", inertia, unit="kg m^2", above=0.0)
        efficiency = checked_number("efficiency", efficiency, above=0.0, at_most=1.0)
        if not self.acceleration_square > 0:
            return np.inf
        return float((self.torque_square / self.acceleration_square) ** 0.25 / np.sqrt(efficiency * inertia))


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RatioWindow:
    """Ratios for which the RMS torque of a motor and its speed stay within their limits.

    Attributes
    ----------
    least, most : float
        Both NaN where no ratio will do.
    optimal : float
        The one of least RMS torque, whether or not it is inside.
    """

    least: float
    most: float
    optimal: float

    @property
    def is_empty(self) -> bool:
        """Whether no ratio will do."""
        return not self.least <= self.most


def accelerating_factor(continuous_torque: float, inertia: float) -> float:
    """``T^2 / J`` of a motor, W/s: how much it can do with its own inertia to move."""
    torque = checked_number("continuous_torque", continuous_torque, unit="N m", above=0.0)
    return torque**2 / checked_number("inertia", inertia, unit="kg m^2", above=0.0)


def load_moments(load: JointLoad) -> LoadMoments:
    """Means over a cycle; see `LoadMoments`."""
    torque, acceleration = (f.by_interval(~load.braked) for f in (load.torque, load.acceleration))

    def mean(f: Piecewise, g: Piecewise) -> float:
        return float(f.inner(g)[0]) / load.duration

    return LoadMoments(
        torque_square=mean(torque, torque),
        acceleration_square=mean(acceleration, acceleration),
        product=mean(acceleration, torque),
        peak_speed=float(load.velocity.extrema().peak[0]),
    )


def ratio_window(
    moments: LoadMoments,
    *,
    inertia: float,
    continuous_torque: float,
    efficiency: float = 1.0,
    max_speed: float = np.inf,
) -> RatioWindow:
    """Ratios that keep the RMS torque below the continuous one and the speed below its limit.

    With ``alpha`` the motor's accelerating factor and ``beta`` the load factor, thermally
    ``(rms(tau) / (efficiency N sqrt(J)) - sqrt(J) N rms(a))^2 <= alpha - beta / efficiency``, which is solved for N.
    The motor's friction is left out.

    Parameters
    ----------
    moments : LoadMoments
    inertia : float
        Rotor and gear input, kg m^2.
    continuous_torque, max_speed : float
        Of the motor, N m and rad/s.
    """
    optimal = moments.optimal_ratio(inertia, efficiency=efficiency)
    reserve = accelerating_factor(continuous_torque, inertia) - moments.load_factor / efficiency
    if reserve < 0:
        return RatioWindow(least=np.nan, most=np.nan, optimal=optimal)
    torque, acceleration = np.sqrt(moments.torque_square), np.sqrt(moments.acceleration_square)
    root, spread = np.sqrt(inertia), np.sqrt(reserve)
    reach = spread + np.sqrt(reserve + 4 * acceleration * torque / efficiency)
    with np.errstate(divide="ignore", invalid="ignore"):
        least = float(np.divide(2 * torque / (efficiency * root), reach))
        most = float(np.divide(reach, 2 * root * acceleration))
        fastest = float(np.divide(max_speed, moments.peak_speed))
    most = min(most, fastest)
    if not least <= most:
        least = most = np.nan
    return RatioWindow(least=least, most=most, optimal=optimal)
