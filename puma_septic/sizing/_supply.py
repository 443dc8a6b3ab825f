"""What the drives of an arm ask of the bus that they share."""

from __future__ import annotations

import functools
import operator
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, NamedTuple, final

import numpy as np

from puma_septic.document import plain
from puma_septic.drives import Supply
from puma_septic.limit_check import Kind, LimitCheck
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._checks import NotAssessed, Outcome
from puma_septic.sizing._demands import Demands, Peak
from puma_septic.sizing._winding import Regeneration, both_signs, energies, regeneration
from puma_septic.validation import Array, checked_number, frozen

__all__ = ["SUPPLY", "SupplyLoad", "supply_load"]

SUPPLY: Final = "supply"
"""What checks of the shared supply call their joint."""

_HOUR: Final = 3600.0
_KILOWATT_HOUR: Final = 3.6e6
_UNKNOWN: Final = Peak(np.nan, np.nan)


class _Limit(NamedTuple):
    """A limit of the supply: what readers call it, the demand and the limit by name, and what must be known."""

    quantity: str
    demand: str
    limit: str
    unit: str
    kind: Kind
    needs: str


_LIMITS: Final = (
    _Limit("drawn power", "peak_drawn_power", "peak_power", "W", "physics", "the supply's peak power"),
    _Limit("mean drawn power", "mean_drawn_power", "continuous_power", "W", "physics", "its continuous power"),
    _Limit("current", "peak_current", "max_current", "A", "physics", "its bus voltage and largest current"),
    _Limit("returned energy on the bus", "stored_energy", "storable_energy", "J", "physics", "its storable energy"),
    _Limit("brake-resistor power", "peak_returned_power", "peak_brake_power", "W", "physics", "its peak power"),
    _Limit("mean brake-resistor power", "mean_braked_power", "brake_resistor_power", "W", "physics", "its power"),
)
_SOURCE: Final = "energy balance of the shared bus"


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class SupplyLoad:
    """The power of all joints together over a cycle, and what becomes of what comes back.

    The peak is that of the sum, instant by instant, not the sum of the joints' peaks; what one joint returns while
    another draws never reaches bus or resistor. Computed when first asked for and kept (the cache needs a
    ``__dict__``, hence no slots).

    Attributes
    ----------
    supply : Supply
    joints : tuple of str
    powers : tuple of Piecewise or None
        At each joint's motor terminals, W; None: unknown.
    is_periodic : bool
    is_unbounded : bool
        Whether a torque, or a winding, is.
    """

    supply: Supply
    joints: tuple[str, ...]
    powers: tuple[Piecewise | None, ...]
    is_periodic: bool
    is_unbounded: bool

    @property
    def unknown(self) -> tuple[str, ...]:
        """Joints whose electric power is not known, and without which there is no sum."""
        return tuple(joint for joint, power in zip(self.joints, self.powers, strict=True) if power is None)

    @cached_property
    def power(self) -> Piecewise | None:
        """Of all joints and the standby, W; None where a joint's is not known."""
        known = [power for power in self.powers if power is not None]
        if len(known) < len(self.powers):
            return None
        total = functools.reduce(operator.add, known)
        standby = float(np.nan_to_num(self.supply.standby_power))
        return total + Piecewise.constant([standby], total.duration, start=total.start)

    @cached_property
    def peak_drawn_power(self) -> Peak:
        """W."""
        return self._peak(1.0)

    @cached_property
    def peak_returned_power(self) -> Peak:
        """W, as a magnitude."""
        return self._peak(-1.0)

    def _peak(self, sign: float) -> Peak:
        if self.is_unbounded:
            return Peak(np.inf, np.nan)
        if self.power is None:
            return _UNKNOWN
        found = (self.power * sign).extrema()
        return Peak(max(float(found.max[0]), 0.0), float(found.t_max[0]))

    @property
    def peak_current(self) -> Peak:
        """At the bus voltage, A."""
        return Peak(self.peak_drawn_power.size / self.supply.bus_voltage, self.peak_drawn_power.time)

    @cached_property
    def flows(self) -> Array | None:
        """Energy of each stretch in which it is drawn (positive) or returned, J; None where unknown or unbounded."""
        return None if self.power is None or self.is_unbounded else frozen(energies(self.power))

    @property
    def energy(self) -> tuple[float, float]:
        """Drawn and returned over the cycle, J."""
        return _both_signs(self.flows, np.inf if self.is_unbounded else np.nan)

    @property
    def exchanged_energy(self) -> float:
        """What joints return and others draw at the same time, J per cycle."""
        if self.flows is None:
            return np.nan
        alone = sum(_both_signs(energies(power), np.nan)[1] for power in self.powers if power is not None)
        return float(max(alone - self.energy[1], 0.0))

    @cached_property
    def regeneration(self) -> Regeneration:
        """What the bus must take up or burn; a bus of unknown capacity is taken to have none."""
        if self.flows is None:
            lost = np.inf if self.is_unbounded else np.nan
            return Regeneration(stored=lost, braked=lost)
        storable = float(np.nan_to_num(self.supply.storable_energy))
        return regeneration(self.flows, storable=storable, periodic=self.is_periodic)

    @property
    def stored_energy(self) -> float:
        """That the bus would take up if it had no bound, J."""
        return self.regeneration.stored

    @property
    def duration(self) -> float:
        """Of the cycle, s; NaN where no joint's power is known."""
        return next((power.duration for power in self.powers if power is not None), np.nan)

    @property
    def mean_braked_power(self) -> float:
        """What the brake resistor burns, on average, W."""
        return self.regeneration.braked / self.duration

    @property
    def consumed_energy(self) -> float:
        """That the supply delivers per cycle: what is drawn less what the bus keeps from what was returned, J."""
        drawn, returned = self.energy
        return drawn - (returned - self.regeneration.braked)

    @property
    def mean_drawn_power(self) -> float:
        """That the supply delivers, on average, W."""
        return self.consumed_energy / self.duration

    def yearly_energy(self, hours: float) -> float:
        """In kWh, of so many hours of operation a year.

        Returns
        -------
        float
        """
        hours = checked_number("hours", hours, unit="h", at_least=0.0)
        return self.mean_drawn_power * hours * _HOUR / _KILOWATT_HOUR

    def yearly_cost(self, hours: float, price: float) -> float:
        """The same times a price per kWh.

        Returns
        -------
        float
        """
        return self.yearly_energy(hours) * checked_number("price", price, at_least=0.0)

    @cached_property
    def outcomes(self) -> tuple[Outcome, ...]:
        """Every limit of the supply, checked or not."""
        found = [outcome for limit in _LIMITS if (outcome := self._outcome(limit)) is not None]
        if np.isnan(self.supply.standby_power):
            reason = "unknown and left out of what the supply gives"
            found.append(NotAssessed(joint=SUPPLY, quantity="standby power", reason=reason))
        return tuple(found)

    @property
    def checks(self) -> tuple[LimitCheck, ...]:
        """Those that could be made."""
        return tuple(outcome for outcome in self.outcomes if isinstance(outcome, LimitCheck))

    def _outcome(self, limit: _Limit) -> Outcome | None:
        if limit.limit == "storable_energy" and not np.isnan(self.supply.brake_resistor_power):
            return None  # what finds no room on the bus goes into the resistor
        bound, demand = getattr(self.supply, limit.limit), getattr(self, limit.demand)
        peak = demand if isinstance(demand, Peak) else Peak(demand, np.nan)
        if self.unknown and not self.is_unbounded:
            reason = f"needs the electric power of {', '.join(self.unknown)}"
            return NotAssessed(joint=SUPPLY, quantity=limit.quantity, reason=reason)
        if np.isnan(bound) or np.isnan(peak.size):
            return NotAssessed(joint=SUPPLY, quantity=limit.quantity, reason=f"needs {limit.needs}")
        return LimitCheck.of_magnitude(
            joint=SUPPLY,
            quantity=limit.quantity,
            demand=peak.size,
            limit=bound,
            unit=limit.unit,
            time=peak.time,
            kind=limit.kind,
            source=_SOURCE,
        )

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: powers in W, energies in J per cycle.

        Returns
        -------
        dict
        """
        drawn, returned = self.energy
        numbers = {
            "peak_drawn_power": self.peak_drawn_power.size,
            "peak_drawn_power_time": self.peak_drawn_power.time,
            "peak_returned_power": self.peak_returned_power.size,
            "mean_drawn_power": self.mean_drawn_power,
            "peak_current": self.peak_current.size,
            "energy_drawn": drawn,
            "energy_returned": returned,
            "energy_exchanged": self.exchanged_energy,
            "energy_braked": self.regeneration.braked,
            "energy_consumed": self.consumed_energy,
        }
        return {"name": self.supply.name, **plain(numbers), "checks": [check.to_dict() for check in self.checks]}


def _both_signs(flows: Array | None, unknown: float) -> tuple[float, float]:
    if flows is None:
        return unknown, unknown
    return both_signs(flows)


def supply_load(demands: Sequence[Demands], supply: Supply) -> SupplyLoad:
    """What the drives of an arm ask of a supply that they share.

    Parameters
    ----------
    demands : sequence of Demands
        Of all joints over one cycle, as a `Sizing` has them.
    supply : Supply

    Returns
    -------
    SupplyLoad

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> there = ps.compute_motion(robot, ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0]))
    >>> motor = ps.Motor(rotor_inertia=1e-4, torque_constant=0.2, resistance=0.5)
    >>> trains = [ps.Drivetrain(motor=motor, gearbox=ps.Gearbox(ratio=60.0, efficiency=0.8))] * 6
    >>> sizing = ps.size(ps.cycle.with_return(there, dwell=1.0), drivetrains=trains)
    >>> load = supply_load(sizing.demands, ps.Supply(bus_voltage=40.0, peak_power=400.0))
    >>> load.peak_drawn_power.size < sum(one.peak_drawn_power.size for one in sizing.demands)
    True
    """
    return SupplyLoad(
        supply=supply,
        joints=tuple(one.load.joint for one in demands),
        powers=tuple(one.electric_power for one in demands),
        is_periodic=all(not one.load.why_not_periodic for one in demands),
        is_unbounded=any(one.electric.is_known and one.electric.is_unbounded for one in demands),
    )
