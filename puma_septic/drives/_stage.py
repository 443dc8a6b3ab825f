"""A stage that turns the gearbox's rotation into a straight motion: screw, rack or belt."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Final, final

import numpy as np

from puma_septic.document import card, known, one_line
from puma_septic.drives._part_checks import (
    BACKWARD_SHARE,
    NOT_NEGATIVE,
    POSITIVE,
    SHARE,
    check_texts,
)
from puma_septic.validation import Array, checked_choice, checked_number, frozen, store_numbers

__all__ = ["LinearStage"]

_KINDS: Final = ("screw", "rack", "belt")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LinearStage:
    """What stands between a gearbox, or a motor, and a sliding joint.

    A force F at the joint is a torque ``F travel / 2 pi`` at the stage's input, over the efficiency where the motor
    drives, times the backward efficiency where the load drives; the friction and the stage's own inertia come on top.

    Parameters
    ----------
    kind : {"screw", "rack", "belt"}
    travel_per_turn : float
        m: the lead of a screw; pi times the diameter of a pinion or pulley.
    name : str
    efficiency : float
        Above 0 and up to 1; NaN: unknown, and taken as lossless.
    backward_efficiency : float
        0 (self-locking) to 1; as `efficiency` where unknown.
    inertia : float
        Of screw, pinion or pulleys with coupling, at the input, kg m^2.
    friction_force : float
        Of guides and seals against the motion, N.
    max_force : float
        N.
    max_speed : float
        Of the input, rad/s, as a long screw has.
    mass, cost : float
        kg, and any currency.
    source : str
        Where the numbers come from.

    Examples
    --------
    Yaskawa's ball screw, lead 10 mm:

    >>> LinearStage(kind="screw", travel_per_turn=0.01, efficiency=0.9).reduction
    628.318...
    """

    kind: str
    travel_per_turn: float
    name: str = ""
    efficiency: float = np.nan
    backward_efficiency: float = np.nan
    inertia: float = np.nan
    friction_force: float = np.nan
    max_force: float = np.nan
    max_speed: float = np.nan
    mass: float = np.nan
    cost: float = np.nan
    source: str = ""

    def __post_init__(self) -> None:
        check_texts(self)
        checked_choice("kind", self.kind, _KINDS)
        travel = checked_number("travel_per_turn", self.travel_per_turn, unit="m", above=0.0)
        object.__setattr__(self, "travel_per_turn", travel)
        store_numbers(self, {"max_force": "N", "max_speed": "rad/s"}, **POSITIVE)
        store_numbers(self, {"inertia": "kg m^2", "friction_force": "N", "mass": "kg", "cost": ""}, **NOT_NEGATIVE)
        store_numbers(self, {"efficiency": ""}, **SHARE)
        store_numbers(self, {"backward_efficiency": ""}, **BACKWARD_SHARE)

    @property
    def reduction(self) -> float:
        """Turn of the input per travel, rad/m."""
        return 2 * pi / self.travel_per_turn

    @property
    def transmission(self) -> Array:
        """Factors of the load where the load drives, at rest, and where the motor drives, shape (3,)."""
        if np.isnan(self.efficiency):
            return frozen(np.ones(3))
        backward = self.efficiency if np.isnan(self.backward_efficiency) else self.backward_efficiency
        return frozen(np.array([backward, 1.0, 1 / self.efficiency]))

    def __repr__(self) -> str:
        return one_line("LinearStage", self._facts())

    def _repr_html_(self) -> str:
        return card("LinearStage", self._facts())

    def _facts(self) -> dict[str, object]:
        return known(
            self,
            {
                "kind": "",
                "name": "",
                "travel_per_turn": "m",
                "efficiency": "",
                "inertia": "kg m^2",
                "max_force": "N",
                "max_speed": "m/s",
                "mass": "kg",
                "cost": "",
                "source": "",
            },
        )
