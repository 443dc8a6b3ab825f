"""The small values that a robot is made of: limits, payload, wrench."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, final

import numpy as np

from puma_septic.document import card, known, one_line
from puma_septic.errors import InputError
from puma_septic.quantities import MAGNITUDES, QUANTITIES
from puma_septic.validation import Array, checked_array, checked_choice, checked_kind, checked_number

__all__ = ["Limits", "Payload", "Wrench"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Limits:
    """What the joints may do, at the joint side; NaN means unknown, never unlimited.

    Parameters
    ----------
    position : array_like, shape (n_joints, 2)
        Lower and upper bound in rad (m for prismatic joints); NaN for a continuous joint's.
    velocity, acceleration, jerk, effort : array_like, shape (n_joints,)
        Magnitudes in rad/s, rad/s^2, rad/s^3 and N m (m/s ... and N for prismatic joints).
    source : str
        Where the numbers come from.
    torque_rate : array_like, shape (n_joints,), optional
        Magnitude of the torque's derivative, N m/s (N/s), such as 1000 N m/s of a Franka arm (libfranka,
        ``kMaxTorqueRate``); Coulomb friction apart.
    """

    position: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    effort: Array
    source: str = ""
    torque_rate: Array = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        checked_kind("source", self.source, str)
        position = checked_array("position", self.position, (None, 2), allow_nan=True)
        if (position[:, 0] >= position[:, 1]).any():
            k = int(np.argmax(position[:, 0] >= position[:, 1]))
            raise InputError(f"position[{k}]: lower bound {position[k, 0]:g} is not below upper {position[k, 1]:g}")
        object.__setattr__(self, "position", position)
        for name in MAGNITUDES:
            given = getattr(self, name)
            if QUANTITIES[name].is_optional and isinstance(given, np.ndarray) and not given.size:
                given = np.full(len(position), np.nan)
            shape, remedy = (len(position),), " (NaN where unknown)"
            values = checked_array(f"{name} limit", given, shape, allow_nan=True, above=0.0, remedy=remedy)
            object.__setattr__(self, name, values)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Those to speak of: all, but of the optional ones only those with a limit that is known for some joint."""
        return tuple(
            name for name, row in QUANTITIES.items() if not (row.is_optional and np.isnan(getattr(self, name)).all())
        )

    def __repr__(self) -> str:
        return one_line("Limits", self._facts())

    def _repr_html_(self) -> str:
        return card("Limits", self._facts())

    def _facts(self) -> dict[str, object]:
        return known(
            self,
            {
                "position": "rad",
                "velocity": "rad/s",
                "acceleration": "rad/s^2",
                "jerk": "rad/s^3",
                "effort": "N m",
                "source": "",
            },
        )


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Payload:
    """A rigid body held at the tool.

    Parameters
    ----------
    mass : float
        kg.
    com : array_like, shape (3,)
        Centre of mass in the tool frame, m.
    inertia : array_like, shape (3, 3)
        About the centre of mass, tool axes, kg m^2; zero (a point mass) by default.
    """

    mass: float = field(kw_only=False)
    com: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))

    def __post_init__(self) -> None:
        object.__setattr__(self, "mass", checked_number("mass", self.mass, unit="kg", at_least=0.0))
        object.__setattr__(self, "com", checked_array("com", self.com, (3,), unit="m"))
        inertia = checked_array("inertia", self.inertia, (3, 3), unit="kg m^2")
        moments = np.linalg.eigvalsh(inertia)
        slack = 1e-12 * float(np.abs(moments).max())
        if (np.abs(inertia - inertia.T) > slack).any():
            raise InputError("inertia: a payload's inertia matrix must be symmetric")
        if moments[0] < -slack or moments[0] + moments[1] < moments[2] - slack:
            raise InputError(
                f"inertia: principal moments {moments.tolist()} kg m^2 are not those of a body"
                " (each must be >= 0 and none larger than the sum of the other two)"
            )
        object.__setattr__(self, "inertia", inertia)

    def __repr__(self) -> str:
        return one_line("Payload", self._facts())

    def _repr_html_(self) -> str:
        return card("Payload", self._facts())

    def _facts(self) -> dict[str, object]:
        return known(self, {"mass": "kg", "com": "m", "inertia": "kg m^2"})


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Wrench:
    """A constant force and torque that the tool exerts on the world, at the tool's origin.

    It adds ``J^T [force, torque]`` to the joint torques.

    Parameters
    ----------
    force, torque : array_like, shape (3,)
        N and N m.
    axes : {"tool", "world"}
        Whether the components turn with the tool (a drill) or stay in world axes (a pull on a rope).
    """

    force: Array = field(default_factory=lambda: np.zeros(3))
    torque: Array = field(default_factory=lambda: np.zeros(3))
    axes: Literal["tool", "world"] = "tool"

    def __post_init__(self) -> None:
        object.__setattr__(self, "force", checked_array("force", self.force, (3,), unit="N"))
        object.__setattr__(self, "torque", checked_array("torque", self.torque, (3,), unit="N m"))
        checked_choice("wrench axes", self.axes, ("tool", "world"))

    def __repr__(self) -> str:
        return one_line("Wrench", self._facts())

    def _repr_html_(self) -> str:
        return card("Wrench", self._facts())

    def _facts(self) -> dict[str, object]:
        return known(self, {"force": "N", "torque": "N m", "axes": ""})
