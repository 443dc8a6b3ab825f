"""The electronics that feed a motor; NaN means unknown."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from puma_septic.document import card, known, one_line
from puma_septic.drives._part_checks import NOT_NEGATIVE, POSITIVE, check_texts
from puma_septic.validation import store_numbers

__all__ = ["Drive"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Drive:
    """The electronics that feed one motor.

    Parameters
    ----------
    name : str
    bus_voltage : float
        V that reach the motor's terminals at most.
    continuous_current, peak_current : float
        A, in the measure of the motor's torque constant.
    continuous_power, peak_power : float
        Electric power that it can deliver to the motor, on average and at most, W.
    peak_regenerated_power : float
        Electric power that it can take back at most, W; with a brake resistor ``chopper voltage^2 / resistance``.
    storable_energy : float
        J that its bus takes up before the voltage is too high, ``capacitance (V_max^2 - V_nominal^2) / 2``. Each
        joint's bus stands alone: energy that joints could share is not counted.
    brake_resistor_power : float
        W that its brake resistor bears continuously; unknown also where there is none.
    mass, cost : float
        kg, and any currency.
    source : str
        Where the numbers come from.
    """

    name: str = ""
    bus_voltage: float = np.nan
    continuous_current: float = np.nan
    peak_current: float = np.nan
    continuous_power: float = np.nan
    peak_power: float = np.nan
    peak_regenerated_power: float = np.nan
    storable_energy: float = np.nan
    brake_resistor_power: float = np.nan
    mass: float = np.nan
    cost: float = np.nan
    source: str = ""

    def __post_init__(self) -> None:
        check_texts(self)
        positive = {
            "bus_voltage": "V", "continuous_current": "A", "peak_current": "A", "continuous_power": "W",
            "peak_power": "W", "peak_regenerated_power": "W", "brake_resistor_power": "W",
        }  # fmt: skip
        store_numbers(self, positive, **POSITIVE)
        store_numbers(self, {"storable_energy": "J", "mass": "kg", "cost": ""}, **NOT_NEGATIVE)

    def __repr__(self) -> str:
        return one_line("Drive", self._facts())

    def _repr_html_(self) -> str:
        return card("Drive", self._facts())

    def _facts(self) -> dict[str, object]:
        return known(
            self,
            {
                "name": "",
                "bus_voltage": "V",
                "continuous_current": "A",
                "peak_current": "A",
                "continuous_power": "W",
                "peak_power": "W",
                "mass": "kg",
                "cost": "",
                "source": "",
            },
        )
