"""The friction law of a drive: the torque against the motion, of a velocity and of the way that the joint travels."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array, checked_array, checked_number

__all__ = ["Friction"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Friction:
    """Viscous and Coulomb friction on one side of the gears, ``viscous v + coulomb[0 if it moves forward else 1]``.

    The way a joint moves is that of its travel, not the sign of a velocity at an instant, which may be rounding. At
    rest there is no Coulomb part: static friction can have any value within its band.

    Parameters
    ----------
    viscous : float
        N m s/rad; NaN: unknown.
    coulomb : array_like, shape (2,)
        N m, for motion in the positive (>= 0) and the negative (<= 0) direction; NaN: unknown.

    Raises
    ------
    InputError
        For friction that would drive.

    Examples
    --------
    >>> friction = Friction(viscous=1e-3, coulomb=[0.4, -0.5])
    >>> friction.torque([10.0, -10.0, 0.0], [1, -1, 0]).tolist()
    [0.41000000000000003, -0.51, 0.0]
    >>> friction.reflected(-100.0).coulomb.tolist()
    [40.0, -50.0]
    """

    viscous: float = np.nan
    coulomb: Array = field(default_factory=lambda: np.full(2, np.nan))

    def __post_init__(self) -> None:
        if not (isinstance(self.viscous, (float, np.floating)) and np.isnan(self.viscous)):
            viscous = checked_number("viscous", self.viscous, unit="N m s/rad", at_least=0.0)
            object.__setattr__(self, "viscous", viscous)
        coulomb = checked_array("coulomb", self.coulomb, (2,), unit="N m", allow_nan=True)
        if coulomb[0] < 0 or coulomb[1] > 0:
            raise InputError(
                f"coulomb = [{coulomb[0]:g}, {coulomb[1]:g}] N m: the first (positive velocity) must be >= 0 and the"
                " second (negative velocity) <= 0"
            )
        object.__setattr__(self, "coulomb", coulomb)

    @property
    def is_known(self) -> bool:
        """Whether every part is."""
        return not (np.isnan(self.viscous) or np.isnan(self.coulomb).any())

    @property
    def known(self) -> Friction:
        """The same law with what is unknown left out."""
        return replace(self, viscous=float(np.nan_to_num(self.viscous)), coulomb=np.nan_to_num(self.coulomb))

    def reflected(self, ratio: float) -> Friction:
        """The same friction on the slower side of gears with this ratio, N m s/rad and N m there.

        The direction is the joint's on both sides, so that the sign of the ratio does not exchange the Coulomb parts.
        """
        return replace(self, viscous=self.viscous * ratio**2, coulomb=self.coulomb * abs(ratio))

    def torque(self, velocity: ArrayLike, moving: ArrayLike) -> Array:
        """Torque that overcomes the friction, N m; what is unknown is left out.

        Parameters
        ----------
        velocity, moving : array_like
            rad/s, and the sign of travel, 0 at rest; of one shape.
        """
        law, way = self.known, np.asarray(moving)
        steps = np.where(way > 0, law.coulomb[0], np.where(way < 0, law.coulomb[1], 0.0))
        return np.asarray(law.viscous * np.asarray(velocity) + steps)

    def along(self, velocity: Piecewise, moving: Array) -> Piecewise:
        """The same along a motion.

        Parameters
        ----------
        velocity : Piecewise
            Of one component.
        moving : ndarray, shape (n_intervals,)
            Sign of travel on each of its intervals.
        """
        return velocity * self.known.viscous + velocity.stepwise(self.torque(np.zeros_like(moving), moving)[:, None])
