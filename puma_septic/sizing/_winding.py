"""A motor's winding: its voltage, with inductance and a weakened field, its electric power, and what comes back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["Regeneration", "Winding", "both_signs", "electric_power", "energies", "regeneration"]

# Of the field's current, which is no better known than the inductance.
_FIELD: Final = 1e-8


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Winding:
    """The equivalent direct-current motor of a synchronous motor, with the peak voltage between two lines as its own.

    With the torque's current i along q, the field's j along d (0 or less) and ``X = pole pairs inductance``,

    ``v_q = R i + (k_e + X j) speed`` and ``v_d = R j - X speed i``.

    Attributes
    ----------
    current : Piecewise
        i, A.
    speed : Piecewise
        rad/s.
    resistance : Piecewise
        ohm.
    back_emf : float
        k_e, V s/rad.
    reactance : float
        X, V s/(rad A); 0 for a motor with direct current.
    """

    current: Piecewise
    speed: Piecewise
    resistance: Piecewise
    back_emf: float
    reactance: float

    @property
    def voltage(self) -> Piecewise:
        """v_q without field weakening, V, signed.

        Holding it below the supply's is the torque-speed line ``torque <= k (V - k speed) / R`` where the motor drives,
        and its wider counterpart where it brakes.
        """
        return self.current * self.resistance + self.speed * self.back_emf

    @property
    def voltage_squared(self) -> Piecewise:
        """``v_q^2 + v_d^2`` without field weakening, V^2."""
        along, across = self.voltage, self.current * self.speed * self.reactance
        return along * along + across * across

    @property
    def _lift(self) -> Piecewise:
        """What each ampere of j takes off the voltage squared, twice: ``k_e X speed^2``, V^2/A."""
        return self.speed * self.speed * (self.back_emf * self.reactance)

    @property
    def _impedance_squared(self) -> Piecewise:
        reactance = self.speed * self.reactance
        return self.resistance * self.resistance + reactance * reactance

    def least_voltage_squared(self, most: float) -> Piecewise:
        """The same with the field weakened as far as up to `most` amperes of ``-j`` help, V^2.

        ``v^2 + Z^2 j^2 + 2 k_e X speed^2 j`` is least at ``j = -k_e X speed^2 / Z^2``; ``Z^2 = R^2 + (X speed)^2``.

        Returns
        -------
        Piecewise
        """
        plain, lift, square = self.voltage_squared, self._lift, self._impedance_squared
        reach = (lift - square * most).split_at_roots()
        is_bound = reach.signs()[:, 0] >= 0
        bound = (plain - lift * (2 * most) + square * most**2).aligned_with(reach)
        functions = Piecewise.concatenate([f.aligned_with(bound) for f in (plain, lift, square)])
        # What is least at no bound is rational in the speed: fitted, and smooth, as the resistance is above 0.
        free = functions.mapped(lambda rows: (rows[:, 0] - rows[:, 1] ** 2 / rows[:, 2])[:, None])
        bound = bound.aligned_with(free)
        is_bound = is_bound[np.searchsorted(reach.breaks[1:-1], bound.middles)]
        return bound.by_interval(is_bound) + free.by_interval(~is_bound)

    def field_current(self, bus_voltage: float, most: float) -> Piecewise:
        """The current ``-j`` that holds the voltage at the bus's where it would be beyond it, A; 0 elsewhere.

        Where no current up to `most` does, it is `most`.

        Returns
        -------
        Piecewise
        """
        square, lift = self._impedance_squared, self._lift
        squared = self.voltage_squared
        excess = squared - Piecewise.constant([bus_voltage**2], squared.duration, start=squared.start)
        excess = excess.split_at_roots()
        is_beyond = excess.signs()[:, 0] > 0
        plain = excess * 0.0
        if not is_beyond.any():
            return plain
        functions = Piecewise.concatenate([f.aligned_with(excess) for f in (lift, square, excess)])
        discriminant = functions[0] * functions[0] - functions[1] * functions[2]
        if discriminant.extrema().min[0] > 0:
            weak = functions.mapped(_root, tolerance=_FIELD)
            weak = weak.by_interval(is_beyond[np.searchsorted(excess.breaks[1:-1], weak.middles)])
            if weak.extrema().max[0] <= most:
                return weak
        return plain + plain.stepwise(np.where(is_beyond, most, 0.0)[:, None])


def _root(rows: Array) -> Array:
    """The smaller root j of ``square j^2 - 2 lift j + excess = 0``, by rows of lift, square and excess."""
    lift, square, excess = rows.T
    return np.asarray(((lift - np.sqrt(np.maximum(lift**2 - square * excess, 0.0))) / square)[:, None])


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


def both_signs(flows: Array) -> tuple[float, float]:
    """What is drawn and what is returned of energies in order, J.

    Returns
    -------
    tuple of float
    """
    return float(np.maximum(flows, 0.0).sum()), float(np.maximum(-flows, 0.0).sum())


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
