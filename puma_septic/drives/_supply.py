"""What feeds the drives of a whole arm: one bus of direct current."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from puma_septic.document import card, known, one_line
from puma_septic.drives._part_checks import NOT_NEGATIVE, POSITIVE, check_texts
from puma_septic.validation import store_numbers

__all__ = ["Supply"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Supply:
    """A bus that all drives of an arm share: what one joint returns, another may draw.

    Parameters
    ----------
    name : str
    bus_voltage : float
        V.
    peak_power, continuous_power : float
        That the supply can deliver at most, and on average, W.
    max_current : float
        That it can deliver at the bus voltage, A.
    storable_energy : float
        J that the bus takes up before its voltage is too high, ``capacitance (V_max^2 - V_nominal^2) / 2``.
    brake_resistor_power, peak_brake_power : float
        W that its brake resistor bears continuously, and at most (chopper voltage squared over its resistance).
    standby_power : float
        Of control and drives whatever the motion, W.
    mass, cost : float
        kg, and any currency.
    source : str
        Where the numbers come from.

    Examples
    --------
    >>> Supply(bus_voltage=48.0, peak_power=500.0, storable_energy=5.0).bus_voltage
    48.0
    """

    name: str = ""
    bus_voltage: float = np.nan
    peak_power: float = np.nan
    continuous_power: float = np.nan
    max_current: float = np.nan
    storable_energy: float = np.nan
    brake_resistor_power: float = np.nan
    peak_brake_power: float = np.nan
    standby_power: float = np.nan
    mass: float = np.nan
    cost: float = np.nan
    source: str = ""

    def __post_init__(self) -> None:
        check_texts(self)
        positive = {
            "bus_voltage": "V", "peak_power": "W", "continuous_power": "W", "max_current": "A",
            "brake_resistor_power": "W", "peak_brake_power": "W",
        }  # fmt: skip
        store_numbers(self, positive, **POSITIVE)
        store_numbers(self, {"storable_energy": "J", "standby_power": "W", "mass": "kg", "cost": ""}, **NOT_NEGATIVE)

    def __repr__(self) -> str:
        return one_line("Supply", self._facts())

    def _repr_html_(self) -> str:
        return card("Supply", self._facts())

    def _facts(self) -> dict[str, object]:
        return known(
            self,
            {
                "name": "",
                "bus_voltage": "V",
                "peak_power": "W",
                "continuous_power": "W",
                "max_current": "A",
                "storable_energy": "J",
                "brake_resistor_power": "W",
                "mass": "kg",
                "cost": "",
                "source": "",
            },
        )
