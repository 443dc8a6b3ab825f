"""All pairs of a catalogue at one joint as arrays: coefficients of the motor's torque, and limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from puma_septic.drives import Catalogue, Drivetrain, Gearbox, Motor
from puma_septic.validation import Array

__all__ = ["PairTable", "pair_table"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PairTable:
    """Pairs at one joint, one row each.

    Attributes
    ----------
    catalogue : Catalogue
    joint : int
    places : tuple of Drivetrain or None
    place : Drivetrain
        What the joint has whatever the parts.
    ratio : ndarray, shape (n,)
    coefficients : ndarray, shape (n, 7)
        Of the features of a load (see `LoadGrid`), at the motor.
    is_linear : ndarray of bool, shape (n,)
        Whether the motor's torque is the sum of the features: not with Stribeck friction.
    """

    catalogue: Catalogue
    joint: int
    places: tuple[Drivetrain, ...] | None
    place: Drivetrain
    ratio: Array
    coefficients: Array
    is_linear: NDArray[np.bool_]

    def motor(self, name: str) -> Array:
        """A value of each pair's motor."""
        values = np.array([getattr(motor, name) for motor in self.catalogue.motors])
        return np.asarray(values[self.catalogue.motor_index])

    def gearbox(self, name: str) -> Array:
        """A value of each pair's gearbox."""
        values = np.array([getattr(gearbox, name) for gearbox in self.catalogue.gearboxes])
        return np.asarray(values[self.catalogue.gearbox_index])

    def drive(self, name: str) -> Array:
        """A value of what feeds each pair."""
        place = None if self.places is None else self.place
        motors = range(len(self.catalogue.motors))
        return np.array([getattr(self.catalogue.drive(i, place), name) for i in motors])[self.catalogue.motor_index]

    @property
    def max_effort(self) -> Array:
        """Limit of the motor's torque times the ratio."""
        pairs = self.catalogue.pairs
        return np.full(len(self.ratio), np.nan) if pairs is None else np.array([pair.max_effort for pair in pairs])

    def by_motor(self) -> list[tuple[Motor, NDArray[np.int64]]]:
        """Each motor with the rows of its pairs."""
        order = np.argsort(self.catalogue.motor_index, kind="stable")
        ends = np.searchsorted(self.catalogue.motor_index[order], np.arange(len(self.catalogue.motors)), side="right")
        return list(zip(self.catalogue.motors, np.split(order, ends[:-1]), strict=True))

    def train(self, k: int) -> Drivetrain:
        """The drive train of the k-th pair."""
        return self.catalogue.drivetrain(k, self.joint, self.places)


def pair_table(catalogue: Catalogue, joint: int, places: Sequence[Drivetrain] | None) -> PairTable:
    """All pairs of a catalogue at a joint.

    Inertia and friction of a train without measured friction are those of its motor alone and of its gearbox alone,
    added; the transmission is the gearbox's.
    """
    bare = Gearbox(ratio=1.0)
    motors = [Drivetrain(motor=motor, gearbox=bare) for motor in catalogue.motors]
    gears = [Drivetrain(motor=Motor(), gearbox=gearbox) for gearbox in catalogue.gearboxes]
    first, second = (
        np.array([[t.inertia, law.viscous, law.coulomb[0]] for t in trains for law in (t.friction.known,)])
        for trains in (motors, gears)
    )
    sums = first[catalogue.motor_index] + second[catalogue.gearbox_index]
    ratio = np.array([t.ratio for t in gears])[catalogue.gearbox_index]
    passed = np.array([t.transmission[::-1] for t in gears])[catalogue.gearbox_index]
    coefficients = np.column_stack(
        [sums[:, 0] * ratio, passed / ratio[:, None], sums[:, 1] * ratio, sums[:, 2], sums[:, 2]]
    )
    is_linear = np.ones(len(ratio), dtype=bool)
    for k, pair in enumerate(catalogue.pairs or ()):
        if pair.friction is not None:
            is_linear[k] = pair.friction.is_linear
            t = catalogue.drivetrain(k, joint)
            law = t.friction.known
            friction = [law.viscous * t.ratio, law.coulomb[0], -law.coulomb[1]]
            coefficients[k] = [t.inertia * t.ratio, *t.transmission[::-1] / t.ratio, *friction]
    place = Drivetrain(motor=Motor(), gearbox=bare) if places is None else places[joint]
    return PairTable(
        catalogue=catalogue,
        joint=joint,
        places=None if places is None else tuple(places),
        place=place,
        ratio=ratio,
        coefficients=coefficients,
        is_linear=is_linear,
    )
