"""What the bearing at a gearbox's output carries: the whole wrench at the joint, not its torque alone.

By the procedure of Harmonic Drive for crossed roller bearings (FHA manual, "Verifying loads", p. 20 to 22; CHA manual
1018854, p. 70). Its mean loads over a table of steps are integrals here, and its tilting moment from lever arms is the
one that the exact inverse dynamics leave to the bearing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final, final

import numpy as np

from puma_septic.drives import Gearbox
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._gearbox import weighted_power_mean
from puma_septic.sizing._loads import JointLoad, kept_by_load
from puma_septic.validation import LARGEST, checked_array

__all__ = ["BearingLoad", "bearing_life", "bearing_load", "equivalent_load"]

_EXPONENT: Final = 10 / 3  # roller bearings; the manuals above, equations (2), (3) and (7)
# The same, for normal operation: load factor 1.2 to 1.5.
_LOAD_FACTOR: Final = 1.5
# The same, table of X and Y, and the ratio of axial to radial load that tells which.
_AXIAL_RATIO: Final = 1.5
_LOW_AXIAL: Final = (1.0, 0.45)
_HIGH_AXIAL: Final = (0.67, 0.67)
# Static equivalent load P0 = Fr + 2 M / dp + 0.44 Fa and C0 / P0 of at least 1.5 in normal operation: FHA-C series,
# p. 23, equations (9) and (10).
_STATIC_AXIAL: Final = 0.44
_STATIC_SAFETY: Final = 1.5
_MILLION: Final = 1e6
_HOUR: Final = 3600.0


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class BearingLoad:
    """Forces and moment on the bearing at one joint over a cycle.

    Computed when first asked for and kept (the cache needs a ``__dict__``, hence no slots).

    Attributes
    ----------
    axial : Piecewise
        Along the joint's axis, N.
    radial_squared : Piecewise
        At right angles to it, N^2.
    tilting_squared : Piecewise
        Moment at right angles to it about the bearing, N^2 m^2.
    speed : Piecewise
        Of the joint, rad/s, not negative.
    """

    axial: Piecewise
    radial_squared: Piecewise
    tilting_squared: Piecewise
    speed: Piecewise

    @cached_property
    def peak_axial(self) -> tuple[float, float]:
        """N, and its instant, s."""
        found = self.axial.extrema()
        return float(found.peak[0]), float(found.t_peak[0])

    @cached_property
    def peak_radial(self) -> tuple[float, float]:
        """N, and its instant, s."""
        return _root(self.radial_squared)

    @cached_property
    def peak_tilting(self) -> tuple[float, float]:
        """N m, and its instant, s."""
        return _root(self.tilting_squared)

    @cached_property
    def mean_loads(self) -> tuple[float, float, float]:
        """Axial and radial force, N, and tilting moment, N m, each the mean that wears; NaN where the joint rests."""
        squares = (self.axial * self.axial, self.radial_squared, self.tilting_squared)
        axial, radial, tilting = (weighted_power_mean(square, self.speed, _EXPONENT) for square in squares)
        return axial, radial, tilting

    def life_hours(self, gearbox: Gearbox) -> float:
        """L10, h: `bearing_life` of the mean loads; NaN where rating or diameter is not known.

        Returns
        -------
        float
        """
        if np.isnan(gearbox.bearing_dynamic_load * gearbox.bearing_diameter):
            return np.nan
        axial, radial, tilting = self.mean_loads
        if np.isnan(axial):
            return np.inf  # at rest there is no wear
        mean_speed = float(self.speed.integral()(self.speed.breaks[-1])[0]) / self.speed.duration
        equivalent = equivalent_load(axial, radial, tilting, diameter=gearbox.bearing_diameter)
        return bearing_life(gearbox.bearing_dynamic_load, equivalent=equivalent, mean_speed=mean_speed)

    def safe_static_load(self, gearbox: Gearbox) -> float:
        """``1.5 (Fr + 2 M / dp + 0.44 Fa)`` of the largest loads, N, whenever each occurs; NaN: diameter unknown.

        Returns
        -------
        float
        """
        across = self.peak_radial[0] + 2 * self.peak_tilting[0] / gearbox.bearing_diameter
        return float(_STATIC_SAFETY * (across + _STATIC_AXIAL * self.peak_axial[0]))


def _root(square: Piecewise) -> tuple[float, float]:
    found = square.extrema()
    return float(np.sqrt(max(found.max[0], 0.0))), float(found.t_max[0])


def equivalent_load(axial: float, radial: float, tilting: float, *, diameter: float) -> float:
    """Dynamic equivalent radial load of a crossed roller bearing, N: ``X (Fr + 2 M / dp) + Y Fa``.

    X = 1 and Y = 0.45 where ``Fa / (Fr + 2 M / dp)`` is at most 1.5, 0.67 and 0.67 beyond.

    Returns
    -------
    float
    """
    axial, moment = _magnitude("axial", axial, "N"), _magnitude("tilting", tilting, "N m")
    across = _magnitude("radial", radial, "N") + 2 * moment / _magnitude("diameter", diameter, "m", above=0.0)
    x, y = _LOW_AXIAL if axial <= _AXIAL_RATIO * across else _HIGH_AXIAL
    return float(x * across + y * axial)


def bearing_life(dynamic_load: float, *, equivalent: float, mean_speed: float) -> float:
    """L10 of a crossed roller bearing, h: ``10^6 / (60 n) (C / (f_w P))^(10/3)`` with f_w = 1.5.

    Parameters
    ----------
    dynamic_load : float
        Its load rating C, N.
    equivalent : float
        P, N.
    mean_speed : float
        Of the output over the whole cycle, rad/s; swaying counts by the turns that it adds up to.

    Returns
    -------
    float
        Infinite without load or motion.
    """
    rating = _magnitude("dynamic_load", dynamic_load, "N", above=0.0)
    load, speed = _magnitude("equivalent", equivalent, "N"), _magnitude("mean_speed", mean_speed, "rad/s")
    with np.errstate(divide="ignore", over="ignore"):
        hours = np.divide(_MILLION * 2 * np.pi, speed) / _HOUR
        return float(hours * np.divide(rating, _LOAD_FACTOR * load) ** _EXPONENT)


def _magnitude(name: str, value: float, unit: str, *, above: float | None = None) -> float:
    """A number of at least 0; NaN where it is not known."""
    bounds = {"above": above, "at_least": 0.0, "at_most": LARGEST}
    return float(checked_array(name, value, (), unit=unit, allow_nan=True, **bounds))  # type: ignore[arg-type]


def bearing_load(load: JointLoad, gearbox: Gearbox) -> BearingLoad | None:
    """What a gearbox's bearing carries; None for a joint that slides, and where the cycle is not known.

    Returns
    -------
    BearingLoad or None
    """
    return _about(load, gearbox.bearing_offset)


@kept_by_load
def _about(load: JointLoad, offset: float) -> BearingLoad | None:
    """About a point on the axis."""
    if load.cycle is None or load.is_prismatic or load.slide is not None:
        return None
    first = 6 * load.number
    wrench = load.cycle.joint_wrench[first : first + 6]
    across = (wrench[0], wrench[1])
    moments = wrench[3] + across[1] * offset, wrench[4] - across[0] * offset
    return BearingLoad(
        axial=wrench[2],
        radial_squared=across[0] * across[0] + across[1] * across[1],
        tilting_squared=moments[0] * moments[0] + moments[1] * moments[1],
        speed=load.speed,
    )
