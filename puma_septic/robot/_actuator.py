"""Actuator: the values of a drivetrain that move the joint, as actuator files have them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final, final

import numpy as np

from puma_septic.document import card, known, one_line
from puma_septic.drives import Drivetrain, Gearbox, Motor
from puma_septic.errors import InputError
from puma_septic.friction import Friction, checked_levels
from puma_septic.validation import Array, FrozenMap, store_numbers

__all__ = ["FRICTION_KEYS", "Actuator"]

FRICTION_KEYS: Final = {
    "static_friction": "static",
    "stribeck_velocity": "stribeck_velocity",
    "load_share": "load_share",
}
"""What files and documents call the optional terms of friction, and the law."""


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Actuator:
    """One joint's drivetrain as far as it moves the joint, in motor-side values; NaN means unknown.

    It is the short form of a `Drivetrain`: what is not known of that is unknown, or as in another drivetrain. Rotor
    inertia at the joint is ``rotor_inertia * gear_ratio**2``, and friction that of `Friction`, with the sign decided by
    the joint's way (Corke, Robotics Toolbox, ``Link.friction``).

    Parameters
    ----------
    gear_ratio : float
        Motor turns per joint turn, negative where the motor turns the other way; never 0; NaN where unknown.
    rotor_inertia : float
        kg m^2, motor side; NaN where unknown.
    viscous_friction : float
        N m s/rad, motor side; NaN where unknown.
    coulomb_friction : array_like, shape (2,)
        N m, motor side, for positive (>= 0) and negative (<= 0) joint velocity; NaN where unknown.
    source : str
        Where the numbers come from.
    others : Drivetrain, optional
        Where all other values come from, such as Stribeck friction and the motor's limits.

    Attributes
    ----------
    drivetrain : Drivetrain
        All of it.

    Raises
    ------
    InputError
        For a zero gear ratio, a negative inertia or friction of the wrong sign.

    Examples
    --------
    >>> actuator = Actuator(gear_ratio=-100.0, rotor_inertia=2e-4, viscous_friction=1e-3, coulomb_friction=[0.4, -0.5])
    >>> actuator.armature, actuator.drivetrain.joint_friction.coulomb.tolist()
    (2.0, [40.0, -50.0])
    """

    gear_ratio: float = np.nan
    rotor_inertia: float = np.nan
    viscous_friction: float = np.nan
    coulomb_friction: Array = field(default_factory=lambda: np.full(2, np.nan))
    source: str = ""
    others: Drivetrain | None = field(default=None, repr=False)
    drivetrain: Drivetrain = field(init=False, repr=False)

    def __post_init__(self) -> None:
        store_numbers(self, {"gear_ratio": ""})
        if self.gear_ratio == 0.0:
            raise InputError("gear_ratio = 0: the ratio of motor speed to joint speed cannot be zero")
        store_numbers(self, {"rotor_inertia": "kg m^2", "viscous_friction": "N m s/rad"}, at_least=0.0)
        object.__setattr__(self, "coulomb_friction", checked_levels("coulomb_friction", self.coulomb_friction))
        object.__setattr__(self, "drivetrain", self._completed())

    @classmethod
    def of(cls, train: Drivetrain) -> Actuator:
        """A drivetrain as an actuator.

        Returns
        -------
        Actuator
        """
        return cls(
            gear_ratio=train.gearbox.ratio,
            rotor_inertia=train.motor.rotor_inertia,
            viscous_friction=train.friction.viscous,
            coulomb_friction=train.friction.coulomb,
            source=train.motor.source,
            others=train,
        )

    @property
    def armature(self) -> float:
        """Rotor inertia at the joint in kg m^2, that of the gears' input with it; NaN where unknown."""
        return self.drivetrain.reflected_inertia if self.drivetrain.knows_inertia else np.nan

    @property
    def options(self) -> Mapping[str, Any]:
        """The optional terms of friction that are known, as `FRICTION_KEYS` calls them."""
        law = self.drivetrain.friction
        values = {key: getattr(law, name) for key, name in FRICTION_KEYS.items()}
        return FrozenMap({key: value for key, value in values.items() if not np.isnan(value).all()})

    def _completed(self) -> Drivetrain:
        """The five values written over all others; friction that has been replaced counts as measured."""
        if self.others is None:
            return Drivetrain(
                motor=Motor(rotor_inertia=self.rotor_inertia, source=self.source),
                gearbox=Gearbox(ratio=self.gear_ratio, source=self.source),
                measured_friction=Friction(viscous=self.viscous_friction, coulomb=self.coulomb_friction),
            )
        train = self.others
        law = replace(train.friction, viscous=self.viscous_friction, coulomb=self.coulomb_friction)
        return replace(
            train,
            motor=replace(train.motor, rotor_inertia=self.rotor_inertia, source=self.source),
            gearbox=replace(train.gearbox, ratio=self.gear_ratio),
            measured_friction=train.measured_friction if law.is_same(train.friction) else law,
        )

    def __repr__(self) -> str:
        return one_line("Actuator", self._facts())

    def _repr_html_(self) -> str:
        return card("Actuator", self._facts())

    def _facts(self) -> dict[str, object]:
        return known(
            self,
            {
                "gear_ratio": "",
                "rotor_inertia": "kg m^2",
                "viscous_friction": "N m s/rad",
                "coulomb_friction": "N m",
                "source": "",
            },
        )
