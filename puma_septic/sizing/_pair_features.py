"""Pairs of a catalogue at one joint as arrays: coefficients of the motor's torque, and limits; some pairs at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.drives import Catalogue, Drivetrain, Gearbox, Motor
from puma_septic.validation import Array

__all__ = ["PairParts", "PairTable", "pair_parts", "pair_table"]

# Pairs at a time: what is computed of them stays within some ten megabytes.
_BLOCK: Final = 32768
_BARE: Final = Gearbox(ratio=1.0)
Rows = NDArray[np.int64]


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PairParts:
    """The parts of a catalogue at one joint, each read once (the caches need a ``__dict__``, hence no slots)."""

    catalogue: Catalogue
    joint: int
    places: tuple[Drivetrain, ...] | None
    place: Drivetrain
    columns: dict[tuple[str, str], Array] = field(default_factory=dict, repr=False)

    def column(self, kind: str, name: str) -> Array:
        """A value of every motor, gearbox or drive."""
        if (kind, name) not in self.columns:
            parts: Sequence[object] = self.catalogue.motors if kind == "motor" else self.catalogue.gearboxes
            if kind == "drive":
                place = None if self.places is None else self.place
                parts = [self.catalogue.drive(i, place) for i in range(len(self.catalogue.motors))]
            self.columns[kind, name] = np.array([getattr(part, name) for part in parts], dtype=float)
        return self.columns[kind, name]

    @cached_property
    def motor_terms(self) -> Array:
        """Inertia, viscous and Coulomb friction of each motor alone, shape (n_motors, 3)."""
        brake = self.place.with_brake
        return _terms([Drivetrain(motor=motor, gearbox=_BARE, with_brake=brake) for motor in self.catalogue.motors])

    @cached_property
    def gearbox_terms(self) -> Array:
        """The same of each gearbox, shape (n_gearboxes, 3)."""
        return _terms(self._geared)

    @cached_property
    def passed(self) -> Array:
        """Factors of the load's torque through each gearbox, shape (n_gearboxes, 3)."""
        return np.array([train.transmission[::-1] for train in self._geared])

    @cached_property
    def _geared(self) -> list[Drivetrain]:
        return [Drivetrain(motor=Motor(), gearbox=gearbox) for gearbox in self.catalogue.gearboxes]

    @cached_property
    def measured(self) -> dict[int, Array]:
        """Coefficients of the pairs whose friction was measured through the gears, by number."""
        pairs = enumerate(self.catalogue.pairs or ())
        return {
            k: _measured(self.catalogue.drivetrain(k, self.joint, self.places))
            for k, pair in pairs
            if pair.friction is not None
        }

    @cached_property
    def stribeck(self) -> frozenset[int]:
        """Numbers of the pairs whose torque is no sum of the features."""
        pairs = enumerate(self.catalogue.pairs or ())
        return frozenset(k for k, pair in pairs if pair.friction is not None and not pair.friction.is_linear)

    @cached_property
    def is_mapped(self) -> NDArray[np.bool_]:
        """Whether each gearbox has a map of its efficiency, whose losses are no factor of the load."""
        return np.array([len(gearbox.efficiency_map) > 0 for gearbox in self.catalogue.gearboxes])

    @cached_property
    def continuous_share(self) -> Array:
        """Share of each motor's continuous torque that ambient and altitude leave, see `Motor.continuous_share`."""
        place = {"ambient_celsius": self.place.ambient_celsius, "altitude": self.place.altitude}
        return np.array([motor.continuous_share(**place) for motor in self.catalogue.motors])

    @cached_property
    def max_effort(self) -> Array | None:
        """Limit of the motor's torque times the ratio of each pair; None where none is known."""
        pairs = self.catalogue.pairs
        return None if pairs is None else np.array([pair.max_effort for pair in pairs])

    def blocks(self) -> Iterator[PairTable]:
        """All pairs, some at a time, those of one motor together."""
        order = np.argsort(self.catalogue.motor_index, kind="stable")
        for start in range(0, len(order), _BLOCK):
            yield self.table(order[start : start + _BLOCK])

    def table(self, rows: Rows) -> PairTable:
        """Some of the catalogue's pairs.

        Inertia and friction of a train without measured friction are those of its motor alone and of its gearbox alone,
        added; the transmission is the gearbox's.
        """
        gears = self.catalogue.gearbox_index[rows]
        sums = self.motor_terms[self.catalogue.motor_index[rows]] + self.gearbox_terms[gears]
        ratio = np.abs(self.column("gearbox", "ratio"))[gears]
        coefficients = np.column_stack(
            [sums[:, 0] * ratio, self.passed[gears] / ratio[:, None], sums[:, 1] * ratio, sums[:, 2], sums[:, 2]]
        )
        is_linear = ~self.is_mapped[gears]
        if self.measured:
            for k, row in enumerate(rows.tolist()):
                coefficients[k] = self.measured.get(row, coefficients[k])
                is_linear[k] &= row not in self.stribeck
        return PairTable(parts=self, rows=rows, ratio=ratio, coefficients=coefficients, is_linear=is_linear)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PairTable:
    """Pairs at one joint, one row each.

    Attributes
    ----------
    parts : PairParts
    rows : ndarray of int, shape (n,)
        Which pairs of the catalogue these are.
    ratio : ndarray, shape (n,)
    coefficients : ndarray, shape (n, 7)
        Of the features of a load (see `LoadGrid`), at the motor.
    is_linear : ndarray of bool, shape (n,)
        Whether the motor's torque is the sum of the features: not with Stribeck friction or a map of efficiency.
    """

    parts: PairParts
    rows: Rows
    ratio: Array
    coefficients: Array
    is_linear: NDArray[np.bool_]

    @property
    def catalogue(self) -> Catalogue:
        """Where the pairs are from."""
        return self.parts.catalogue

    @property
    def place(self) -> Drivetrain:
        """What the joint has whatever the parts."""
        return self.parts.place

    def at(self, places: NDArray[np.bool_] | Rows) -> PairTable:
        """Some of the rows."""
        return PairTable(
            parts=self.parts,
            rows=self.rows[places],
            ratio=self.ratio[places],
            coefficients=self.coefficients[places],
            is_linear=self.is_linear[places],
        )

    @property
    def gearbox_index(self) -> Rows:
        """Which gearbox each pair has."""
        return self.catalogue.gearbox_index[self.rows]

    def motor(self, name: str) -> Array:
        """A value of each pair's motor."""
        return np.asarray(self.parts.column("motor", name)[self.catalogue.motor_index[self.rows]])

    def gearbox(self, name: str) -> Array:
        """A value of each pair's gearbox."""
        return np.asarray(self.parts.column("gearbox", name)[self.gearbox_index])

    def stage(self, name: str) -> Array:
        """A value of the joint's stage, the same for all pairs; NaN without one."""
        return np.full(len(self.ratio), np.nan if self.place.stage is None else getattr(self.place.stage, name))

    @property
    def stage_reduction(self) -> float:
        """Turn of the gearbox's output per travel of the joint; 1 without a stage."""
        return 1.0 if self.place.stage is None else self.place.stage.reduction

    def drive(self, name: str) -> Array:
        """A value of what feeds each pair."""
        return np.asarray(self.parts.column("drive", name)[self.catalogue.motor_index[self.rows]])

    def bus_voltage(self, rows: NDArray[np.int64]) -> float:
        """Of what feeds the motor of these pairs, V."""
        if not len(rows):
            return np.nan
        motor = int(self.catalogue.motor_index[self.rows[rows[0]]])
        return float(self.parts.column("drive", "bus_voltage")[motor])

    @property
    def weakens_field(self) -> NDArray[np.bool_]:
        """Whether the drive of each pair may weaken the motor's field."""
        return np.nan_to_num(self.motor("max_field_current")) * self.motor("reactance_constant") > 0

    @property
    def continuous_share(self) -> Array:
        """Share of each pair's continuous torque that is left at most, see `Drivetrain.continuous_share`."""
        shares = np.nan_to_num(self.parts.continuous_share[self.catalogue.motor_index[self.rows]], nan=1.0)
        geared = self.motor("geared_share")
        return shares * np.where((self.ratio != 1) & ~np.isnan(geared), geared, 1.0)

    @property
    def max_effort(self) -> Array:
        """Limit of the motor's torque times the ratio."""
        known = self.parts.max_effort
        return np.full(len(self.rows), np.nan) if known is None else np.asarray(known[self.rows])

    def by_motor(self) -> list[tuple[Motor, Rows]]:
        """Each motor with the places of its pairs among the rows."""
        index = self.catalogue.motor_index[self.rows]
        order = np.argsort(index, kind="stable")
        present, starts = np.unique(index[order], return_index=True)
        places = np.split(order, starts[1:])
        return [(self.catalogue.motors[i], own) for i, own in zip(present.tolist(), places, strict=False)]

    def train(self, k: int) -> Drivetrain:
        """The drive train of the k-th row."""
        return self.catalogue.drivetrain(int(self.rows[k]), self.parts.joint, self.parts.places)


def pair_table(catalogue: Catalogue, joint: int, places: Sequence[Drivetrain] | None) -> PairTable:
    """All pairs of a catalogue at a joint."""
    return pair_parts(catalogue, joint, places).table(np.arange(catalogue.n_pairs))


def pair_parts(catalogue: Catalogue, joint: int, places: Sequence[Drivetrain] | None) -> PairParts:
    """The parts of a catalogue at a joint, of which tables of pairs are made."""
    place = Drivetrain(motor=Motor(), gearbox=_BARE) if places is None else places[joint]
    return PairParts(catalogue=catalogue, joint=joint, places=None if places is None else tuple(places), place=place)


def _terms(trains: Sequence[Drivetrain]) -> Array:
    return np.array([[t.inertia, law.viscous, law.coulomb[0]] for t in trains for law in (t.friction.known,)])


def _measured(train: Drivetrain) -> Array:
    law, n = train.friction.known, train.ratio
    friction = [law.viscous * n, law.coulomb[0], -law.coulomb[1]]
    return np.array([train.inertia * n, *train.transmission[::-1] / n, *friction])
