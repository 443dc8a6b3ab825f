"""The quantities that a joint has a limit of: one row each, read by every table, file and check."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal, final

__all__ = ["COMMON", "MAGNITUDES", "MOTION", "QUANTITIES", "Quantity", "typeset"]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """A quantity with one value per joint and instant, and a limit.

    Attributes
    ----------
    name : str
        Of its limit: the field of `Limits`, the key of task and actuator files.
    labels : tuple of str
        What tables and sentences call it, of a revolute and of a prismatic joint.
    signal : {"position", "torque"}
        The function of time that it is a derivative of.
    order : int
        Which derivative.
    units : tuple of str
        Of a revolute and of a prismatic joint.
    is_hard : bool
        Whether no arm can follow where it is infinite, whatever its limit; an infinite jerk it smooths.
    is_optional : bool
        Whether nothing is said of it where no joint has a limit of it, as it is not known of most arms.

    Examples
    --------
    >>> effort = QUANTITIES["effort"]
    >>> effort.label, effort.unit(is_prismatic=False)
    ('torque', 'N m')
    >>> effort.labels[1], effort.unit(is_prismatic=True)
    ('force', 'N')
    """

    name: str
    labels: tuple[str, str]
    signal: Literal["position", "torque"]
    order: int
    units: tuple[str, str]
    is_hard: bool = False
    is_optional: bool = False

    def unit(self, is_prismatic: object) -> str:
        """Unit of a prismatic or a revolute joint's value; a NumPy boolean will do.

        Returns
        -------
        str
        """
        return self.units[1 if is_prismatic else 0]

    @property
    def label(self) -> str:
        """What a table of all joints calls it."""
        return self.labels[0]

    @property
    def attribute(self) -> str:
        """How attributes call it: ``peak_torque``, ``rms_velocity``."""
        return self.label.replace(" ", "_")

    @property
    def is_range(self) -> bool:
        """Whether its limit is a lower and an upper bound, not a magnitude: so for positions."""
        return self.name == "position"

    @property
    def is_torque_derivative(self) -> bool:
        """Whether it is a derivative of the torque, of which Coulomb friction, that steps, is no part."""
        return self.signal == "torque" and self.order > 0


_ROWS: Final = (
    Quantity(name="position", labels=("position",) * 2, signal="position", order=0, units=("rad", "m")),
    Quantity(name="velocity", labels=("velocity",) * 2, signal="position", order=1, units=("rad/s", "m/s")),
    Quantity(
        name="acceleration",
        labels=("acceleration",) * 2,
        signal="position",
        order=2,
        units=("rad/s^2", "m/s^2"),
        is_hard=True,
    ),
    Quantity(name="jerk", labels=("jerk",) * 2, signal="position", order=3, units=("rad/s^3", "m/s^3")),
    Quantity(name="effort", labels=("torque", "force"), signal="torque", order=0, units=("N m", "N"), is_hard=True),
    Quantity(
        name="torque_rate",
        labels=("torque rate", "force rate"),
        signal="torque",
        order=1,
        units=("N m/s", "N/s"),
        is_optional=True,
    ),
)

QUANTITIES: Final[Mapping[str, Quantity]] = MappingProxyType({row.name: row for row in _ROWS})
"""Every quantity by name, in the order in which tables have them."""

MOTION: Final = tuple(row.name for row in _ROWS if row.signal == "position")
"""Position and its derivatives, by order."""

COMMON: Final = tuple(row.name for row in _ROWS if not row.is_optional)
"""The quantities that every arm is asked for."""

MAGNITUDES: Final = tuple(row.name for row in _ROWS if not row.is_range)
"""The quantities whose limit is a magnitude, one number per joint."""


def typeset(unit: str) -> str:
    """A unit as print has it.

    Returns
    -------
    str

    Examples
    --------
    >>> typeset("rad^2/s^5")
    'rad²/s⁵'
    """
    return unit.replace("^2", "²").replace("^3", "³").replace("^5", "⁵")
