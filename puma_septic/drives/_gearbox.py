"""A gearbox as a data sheet has it; NaN means unknown."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, final

import numpy as np

from puma_septic.document import card, known, one_line
from puma_septic.drives._part_checks import (
    BACKWARD_SHARE,
    NOT_NEGATIVE,
    POSITIVE,
    SHARE,
    check_texts,
    checked_impacts,
    checked_map,
    no_curve,
)
from puma_septic.errors import InputError
from puma_septic.validation import Array, checked_array, checked_choice, checked_number, store_numbers

__all__ = ["GEARBOX_UNITS", "KINDS", "LIFE_BASES", "Gearbox"]

KINDS: Final = ("", "strain wave", "cycloidal", "planetary")
"""Types of gear whose makers have a rule of their own; "": not told, and the strain wave gear's rule is taken."""
LIFE_BASES: Final = ("", "L10", "L50")
"""How many of a hundred gears may have failed at the life that is stated: "", not told, or 10, or 50."""

_POSITIVE_UNITS: Final = {
    "rated_torque": "N m", "rated_speed": "rad/s", "rated_life_hours": "h", "max_average_torque": "N m",
    "max_repeated_torque": "N m", "max_momentary_torque": "N m", "max_average_input_speed": "rad/s",
    "max_input_speed": "rad/s", "efficiency_torque": "N m", "max_tilting_moment": "N m", "max_axial_force": "N",
    "max_radial_force": "N", "bearing_dynamic_load": "N", "bearing_static_load": "N", "bearing_diameter": "m",
}  # fmt: skip
_NOT_NEGATIVE_UNITS: Final = {"inertia": "kg m^2", "no_load_torque": "N m", "mass": "kg", "cost": "", "backlash": "rad"}
_LOSSES: Final = ("efficiency", "backward_efficiency", "no_load_torque")
GEARBOX_UNITS: Final = _POSITIVE_UNITS | _NOT_NEGATIVE_UNITS


_HOUR: Final = 3600.0
# Beckhoff, AG2400 operating instructions (infosys.beckhoff.com): T_2B at "maximum 1000 cycles per hour".
_PLANETARY_CYCLES: Final = 1e3


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Gearbox:
    """A gearbox; torques at its output, speeds and inertia at its input.

    Parameters
    ----------
    ratio : float
        Motor turns per joint turn (rad/m for a prismatic joint), negative where the motor turns the other way; 1 for a
        direct drive; NaN: unknown. Motor quantities are counted in the joint's direction, so only its magnitude enters
        them.
    name : str
    kind : {"", "strain wave", "cycloidal", "planetary"}
        Whose maker's rule its average torque, life and rare peaks follow.
    efficiency : float
        Output power over input power where the motor drives, above 0 and up to 1.
    efficiency_torque : float
        Torque at the output at which `efficiency` was measured with the no-load torque in it, N m, as makers of strain
        wave gears print it; NaN: the efficiency is of the load alone, and the no-load torque comes on top. It excludes
        the same loss counted twice, see `load_efficiency`.
    efficiency_map : array_like, shape (k, 3)
        Rows (input speed in rad/s, output torque in N m, efficiency) on a grid of at least two torques, all losses in
        it; instead of `efficiency`, `backward_efficiency` and `no_load_torque`.
    backward_efficiency : float
        Input power over output power where the load drives, 0 (self-locking) to 1; as `efficiency` where unknown.
    inertia : float
        At the input, kg m^2.
    no_load_torque : float
        At the input, N m, against the motion at any speed.
    rated_torque, rated_speed, rated_life_hours : float
        Torque (N m) and input speed (rad/s) at which the life (h) is stated.
    life_basis : {"", "L10", "L50"}
        What the rated life is: that of 90 or of 50 of a hundred gears.
    max_average_torque : float
        Limit of the average torque, N m (planetary: T_2N).
    max_repeated_torque, max_momentary_torque : float
        Limits of the peaks of each cycle (planetary: T_2B) and of rare ones (collision, emergency stop; T_2Not), N m.
    impact_curve : array_like, shape (k, 2)
        Of planetary gears: rows (cycles per hour, factor of at least 1 that the peaks of each cycle count by), straight
        between them. Empty: 1 up to 1000 cycles per hour and unknown beyond.
    max_average_input_speed, max_input_speed : float
        rad/s.
    max_tilting_moment, max_axial_force, max_radial_force : float
        What the bearing at the output bears, N m and N.
    bearing_dynamic_load, bearing_static_load, bearing_diameter : float
        Load ratings of a crossed roller bearing at the output, N, and the pitch circle of its rollers, m.
    bearing_offset : float
        Where it sits along the joint's axis, from the joint's origin, m; moments are about this point.
    stiffness : array_like, shape (1,) or (3,)
        Of the gears in torsion at the output, N m/rad: one, or K1, K2, K3 for the ranges that `stiffness_torques`
        divides. Empty: unknown.
    stiffness_torques : array_like, shape (0,) or (2,)
        T1 and T2, N m.
    backlash : float
        Lost motion at the output between both directions, rad.
    mass, cost : float
        kg, and any currency.
    source : str
        Where the numbers come from.

    Examples
    --------
    Harmonic Drive, engineering data CSD-2A, p. 24: an HFUC-20-80 of 78 % at 34 N m has 73 % at 19.6 N m.

    >>> gearbox = Gearbox(ratio=80.0, efficiency=0.78, efficiency_torque=34.0, no_load_torque=0.0507)
    >>> round(gearbox.load_efficiency, 2)
    0.86
    >>> round(19.6 / (19.6 / gearbox.load_efficiency + 80 * 0.0507), 2)
    0.73
    """

    ratio: float = np.nan
    name: str = ""
    kind: str = ""
    efficiency: float = np.nan
    efficiency_torque: float = np.nan
    efficiency_map: Array = field(default_factory=lambda: np.empty((0, 3)))
    backward_efficiency: float = np.nan
    inertia: float = np.nan
    no_load_torque: float = np.nan
    rated_torque: float = np.nan
    rated_speed: float = np.nan
    rated_life_hours: float = np.nan
    life_basis: str = ""
    max_average_torque: float = np.nan
    max_repeated_torque: float = np.nan
    max_momentary_torque: float = np.nan
    impact_curve: Array = field(default_factory=no_curve)
    max_average_input_speed: float = np.nan
    max_input_speed: float = np.nan
    max_tilting_moment: float = np.nan
    max_axial_force: float = np.nan
    max_radial_force: float = np.nan
    bearing_dynamic_load: float = np.nan
    bearing_static_load: float = np.nan
    bearing_diameter: float = np.nan
    bearing_offset: float = 0.0
    stiffness: Array = field(default_factory=lambda: np.empty(0))
    stiffness_torques: Array = field(default_factory=lambda: np.empty(0))
    backlash: float = np.nan
    mass: float = np.nan
    cost: float = np.nan
    source: str = ""

    def __post_init__(self) -> None:
        check_texts(self)
        for name, valid in (("kind", KINDS), ("life_basis", LIFE_BASES)):
            checked_choice(name, getattr(self, name), valid)
        store_numbers(self, {"ratio": ""})
        if self.ratio == 0:
            raise InputError("gear ratio = 0: the ratio of motor speed to joint speed cannot be zero")
        store_numbers(self, _POSITIVE_UNITS, **POSITIVE)
        store_numbers(self, _NOT_NEGATIVE_UNITS, **NOT_NEGATIVE)
        store_numbers(self, {"efficiency": ""}, **SHARE)
        store_numbers(self, {"backward_efficiency": ""}, **BACKWARD_SHARE)
        object.__setattr__(self, "bearing_offset", checked_number("bearing_offset", self.bearing_offset, unit="m"))
        self._check_stiffness()
        object.__setattr__(self, "impact_curve", checked_impacts(self.impact_curve))
        self._check_losses()

    def _check_losses(self) -> None:
        """What is measured with all losses in it must leave some for the load, and nothing else may be given."""
        object.__setattr__(self, "efficiency_map", checked_map(self.efficiency_map))
        if len(self.efficiency_map):
            twice = [name for name in _LOSSES if not np.isnan(getattr(self, name))]
            if twice:
                raise InputError(f"efficiency_map has all losses in it, but {', '.join(twice)} is given too")
        if not np.isnan(self.efficiency_torque):
            if np.isnan(self.efficiency * self.no_load_torque * self.ratio):
                raise InputError(
                    "efficiency_torque tells efficiency and no_load_torque apart: it needs both, and the ratio"
                )
            if not 0 < self.load_efficiency <= 1:
                raise InputError(
                    f"no_load_torque = {self.no_load_torque:g} N m is more than all that an efficiency of"
                    f" {self.efficiency:g} at {self.efficiency_torque:g} N m loses"
                )

    def _check_stiffness(self) -> None:
        for name, unit in (("stiffness", "N m/rad"), ("stiffness_torques", "N m")):
            object.__setattr__(self, name, checked_array(name, getattr(self, name), (None,), unit=unit, above=0.0))
        stiffness, torques = self.stiffness, self.stiffness_torques
        if (len(stiffness), len(torques)) not in ((0, 0), (1, 0), (3, 2)) or (np.diff(torques) <= 0).any():
            raise InputError(
                f"stiffness = {stiffness.tolist()} N m/rad with stiffness_torques = {torques.tolist()} N m: expected"
                " one stiffness, or K1, K2, K3 with rising torques T1, T2"
            )

    @property
    def load_efficiency(self) -> float:
        """Of the load alone, without the no-load torque: what multiplies a load's torque.

        From ``1/efficiency = 1/load_efficiency + ratio no_load_torque / efficiency_torque`` where the efficiency was
        measured with both; else the efficiency itself.
        """
        if np.isnan(self.efficiency_torque):
            return self.efficiency
        lost = abs(self.ratio) * self.no_load_torque / self.efficiency_torque
        return float(1 / (1 / self.efficiency - lost))

    def torsion(self, torque: float) -> float:
        """Wind-up of the gears under a torque at the output, rad; NaN where their stiffness is not known.

        ``T/K1`` up to T1, then ``T1/K1 + (T - T1)/K2`` up to T2, then ``T1/K1 + (T2 - T1)/K2 + (T - T2)/K3``.

        Parameters
        ----------
        torque : float
            N m.

        Returns
        -------
        float

        Notes
        -----
        Harmonic Drive, engineering data CSD-2A, p. 23; their example, an HFUC-32-100 under 60 N m, is printed as
        7.15e-4 rad:

        Examples
        --------
        >>> gearbox = Gearbox(stiffness=[6.7e4, 1.1e5, 1.2e5], stiffness_torques=[29.0, 108.0])
        >>> round(gearbox.torsion(60.0), 6)
        0.000715
        """
        if not len(self.stiffness):
            return np.nan
        ends = np.concatenate([[0.0], self.stiffness_torques, [np.inf]])
        parts = np.clip(abs(torque), ends[:-1], ends[1:]) - ends[:-1]
        return float(np.sign(torque) * (parts / self.stiffness).sum())

    def impact_factor(self, cycle: float) -> float:
        """What the peaks of each cycle count by, more than once, where many come in an hour; NaN: not known.

        Of planetary gears alone: their peak torque is stated for at most 1000 cycles per hour, beyond which "the impact
        factor must be taken into account" (WITTENSTEIN, engineering glossary, T2B).

        Parameters
        ----------
        cycle : float
            Duration of a cycle, s.

        Returns
        -------
        float
        """
        if self.kind != "planetary":
            return 1.0
        rate = _HOUR / cycle
        if len(self.impact_curve):
            rates, factors = self.impact_curve.T
            return float(np.interp(rate, rates, factors, left=factors[0], right=np.nan))
        return 1.0 if rate <= _PLANETARY_CYCLES else np.nan

    def __repr__(self) -> str:
        return one_line("Gearbox", self._facts())

    def _repr_html_(self) -> str:
        return card("Gearbox", self._facts())

    def _facts(self) -> dict[str, object]:
        return known(
            self,
            {
                "name": "",
                "ratio": "",
                "efficiency": "",
                "inertia": "kg m^2",
                "rated_torque": "N m",
                "max_repeated_torque": "N m",
                "max_input_speed": "rad/s",
                "mass": "kg",
                "cost": "",
                "source": "",
            },
        )
