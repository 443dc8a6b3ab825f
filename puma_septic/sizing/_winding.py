"""Voltage of a motor's winding, with inductance and a field that the drive weakens at high speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["Winding"]

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
