"""Electric power of a motor over a cycle, and what becomes of the power that comes back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["Regeneration", "electric_power", "energies", "regeneration"]

# Each energy is a difference of the integral from the start.
_ROUNDING: Final = 1e-13
# A cycle that returns more than it draws by no more than this part of what flows does not: some hundred times what a
# torque's tolerance leaves in an energy.
_BALANCED: Final = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Regeneration:
    """What a bus that takes up energy E at most does with what comes back over a steady cycle.

    Attributes
    ----------
    stored : float
        The most that its capacitor would take up if it had no bound, J; infinite where a cycle returns more than it
        draws.
    braked : float
        Energy per cycle that does not fit and goes into the brake resistor, J.
    """

    stored: float
    braked: float


def electric_power(power: Piecewise, current_squared: Piecewise, resistance: Piecewise) -> Piecewise:
    """Power at the motor's terminals, ``torque speed + R i^2``, W; iron losses are left out.

    Parameters
    ----------
    power : Piecewise
        Mechanical, W.
    current_squared : Piecewise
        Of the equivalent direct-current motor, A^2.
    resistance : Piecewise
        Of its winding as warm as it is, ohm.
    """
    return power + current_squared * resistance


def energies(power: Piecewise) -> Array:
    """Energy of each stretch of one sign, J, in order; their sum is that of the whole cycle.

    What is rounding beside the sum of all magnitudes is 0.
    """
    power = power.split_at_roots()
    flows = np.diff(power.integral()(power.breaks)[:, 0])
    return np.where(np.abs(flows) > _ROUNDING * np.abs(flows).sum(), flows, 0.0)


def regeneration(flows: Array, *, storable: float, periodic: bool) -> Regeneration:
    """Of the energies drawn (positive) and returned (negative) in order, what is stored and what must be braked.

    Within a stretch of one sign the capacitor only fills, or only empties, so that clipping at its end is exact. A
    steady cycle begins full where it returns more than it draws, with what the one before leaves otherwise; one that is
    not periodic begins empty.
    """
    returns_more = -float(flows.sum()) > _BALANCED * float(np.abs(flows).sum())
    if periodic:
        start = storable if returns_more else 0.0
        start = _through(flows, start, storable)[0]
        stored = np.inf if returns_more else _through(flows, _through(flows, 0.0, np.inf)[0], np.inf)[1]
    else:
        start, stored = 0.0, _through(flows, 0.0, np.inf)[1]
    return Regeneration(stored=stored, braked=_through(flows, start, storable)[2])


def _through(flows: Array, start: float, storable: float) -> tuple[float, float, float]:
    """Charge at the end, highest charge, and energy braked, of one cycle."""
    charge, highest, braked = start, start, 0.0
    for flow in flows.tolist():
        charge = max(charge - flow, 0.0)
        braked += max(charge - storable, 0.0)
        charge = min(charge, storable)
        highest = max(highest, charge)
    return charge, highest, braked
