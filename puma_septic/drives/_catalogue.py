"""Catalogue: motors and gearboxes to choose from, and which of them go together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from puma_septic.document import card, one_line
from puma_septic.drives._drive import Drive
from puma_septic.drives._drivetrain import Drivetrain
from puma_septic.drives._gearbox import Gearbox
from puma_septic.drives._motor import Motor
from puma_septic.errors import InputError
from puma_septic.friction import Friction
from puma_septic.validation import Array, FrozenMap, checked_array, checked_kind, checked_list, checked_texts, frozen

__all__ = ["Catalogue", "Pair"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Pair:
    """A motor and a gearbox that fit together, by name, and what is known of the two only as a whole.

    Attributes
    ----------
    motor, gearbox : str
    friction : Friction or None
        Measured at the motor through the gears; then neither part may have losses of its own.
    max_effort : float
        Limit of the motor's torque times the ratio, N m (N).
    """

    motor: str
    gearbox: str
    friction: Friction | None = None
    max_effort: float = np.nan


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Catalogue:
    """Parts to choose from; each has a name of its own. Read one from files with `load_catalogue`.

    Parameters
    ----------
    motors : sequence of Motor
    gearboxes : sequence of Gearbox
    pairs : sequence of Pair, optional
        Which of them fit together; None: every motor with every gearbox.
    drives : sequence of Drive, optional
        What feeds each motor where the joint has no drive of its own: its nominal voltage, as a rule.
    unused : sequence of str
        Columns that no check uses, for the remarks.
    refused : sequence of str
        Rows of its files that could not be read, and why.
    other : mapping of str to mapping of str to str
        By part, what its file says in columns that are not known.

    Raises
    ------
    InputError
        For an empty list, a name that is missing or occurs twice, or a pair of unknown or contradictory parts.

    Examples
    --------
    >>> catalogue = Catalogue(motors=[Motor(name="M")], gearboxes=[Gearbox(name="G", ratio=50.0, efficiency=0.8)])
    >>> catalogue.drivetrain(0, 0).ratio
    50.0
    """

    motors: tuple[Motor, ...]
    gearboxes: tuple[Gearbox, ...]
    pairs: tuple[Pair, ...] | None = None
    drives: tuple[Drive, ...] = ()
    unused: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()
    other: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    motor_index: NDArray[np.int64] = field(init=False, repr=False)
    gearbox_index: NDArray[np.int64] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for name, kind in (("motors", Motor), ("gearboxes", Gearbox), ("drives", Drive)):
            parts = checked_list(name, getattr(self, name))
            object.__setattr__(self, name, tuple(checked_kind(name, part, kind) for part in parts))
        for name in ("unused", "refused"):
            object.__setattr__(self, name, checked_texts(name, getattr(self, name)))
        places = {"motor": _places("motor", self.motors), "gearbox": _places("gearbox", self.gearboxes)}
        if self.drives and len(self.drives) != len(self.motors):
            raise InputError(f"{len(self.drives)} drives for {len(self.motors)} motors: expected one of each")
        if self.pairs is None:
            first, second = (grid.ravel() for grid in np.indices((len(self.motors), len(self.gearboxes))))
        else:
            pairs = tuple(checked_kind("pairs", pair, Pair) for pair in checked_list("pairs", self.pairs))
            object.__setattr__(self, "pairs", pairs)
            found = [(_found("motor", p.motor, places), _found("gearbox", p.gearbox, places)) for p in self.pairs]
            if len(set(found)) < len(found):
                twice = next(pair for k, pair in enumerate(found) if pair in found[:k])
                raise InputError(f"the pair {self.motors[twice[0]].name}, {self.gearboxes[twice[1]].name} occurs twice")
            first, second = np.array(found, dtype=np.int64).reshape(-1, 2).T
        object.__setattr__(self, "motor_index", frozen(first))
        object.__setattr__(self, "gearbox_index", frozen(second))
        object.__setattr__(self, "other", FrozenMap({part: FrozenMap(said) for part, said in self.other.items()}))
        for k, pair in enumerate(self.pairs or ()):
            if pair.friction is not None:
                self.drivetrain(k, 0)

    @property
    def n_pairs(self) -> int:
        """Number of pairs that fit together."""
        return len(self.motor_index)

    def drivetrain(self, k: int, joint: int, places: Sequence[Drivetrain] | None = None) -> Drivetrain:
        """The drive train of the k-th pair at a joint.

        Parameters
        ----------
        k, joint : int
        places : sequence of Drivetrain, optional
            What the joints have whatever the parts: drive, ambient temperature, momentary torque and required life.
        """
        i = int(self.motor_index[k])
        motor, gearbox = self.motors[i], self.gearboxes[int(self.gearbox_index[k])]
        pair = None if self.pairs is None else self.pairs[k]
        parts = {
            "motor": motor,
            "gearbox": gearbox,
            "drive": self.drive(i, None if places is None else places[joint]),
            "measured_friction": None if pair is None else pair.friction,
            "max_effort": np.nan if pair is None else pair.max_effort,
        }
        return Drivetrain(**parts) if places is None else replace(places[joint], **parts)  # type: ignore[arg-type]

    def drive(self, i: int, place: Drivetrain | None = None) -> Drive:
        """What feeds the i-th motor: the joint's drive, with the voltage of the motor's where it has none."""
        own = self.drives[i] if self.drives else Drive()
        if place is None:
            return own
        if np.isnan(place.drive.bus_voltage) and not np.isnan(own.bus_voltage):
            return replace(place.drive, bus_voltage=own.bus_voltage)
        return place.drive

    def masses(self) -> Array:
        """Of motor and gearbox together, kg, shape (n_pairs,); NaN where either is unknown."""
        return self._sums("mass")

    def costs(self) -> Array:
        """Of motor and gearbox together, shape (n_pairs,); NaN where either is unknown."""
        return self._sums("cost")

    def _sums(self, name: str) -> Array:
        motors, gearboxes = (np.array([getattr(part, name) for part in kind]) for kind in (self.motors, self.gearboxes))
        return checked_array(name, motors[self.motor_index] + gearboxes[self.gearbox_index], (None,), allow_nan=True)

    def __repr__(self) -> str:
        return one_line("Catalogue", self._facts())

    def _repr_html_(self) -> str:
        return card("Catalogue", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "motors": len(self.motors),
            "gearboxes": len(self.gearboxes),
            "pairs": self.n_pairs,
            "drives": len(self.drives),
        }


def _places(kind: str, parts: Sequence[Motor | Gearbox]) -> dict[str, int]:
    if not parts:
        raise InputError(f"a catalogue needs at least one {kind}")
    places: dict[str, int] = {}
    for k, part in enumerate(parts):
        if not part.name:
            raise InputError(f"{kind} {k + 1} of the catalogue has no name")
        if isinstance(part, Gearbox) and np.isnan(part.ratio):
            raise InputError(f"gearbox {part.name!r}: its ratio is required")
        if part.name in places:
            raise InputError(f"{kind} {part.name!r} occurs twice in the catalogue")
        places[part.name] = k
    return places


def _found(kind: str, name: str, places: dict[str, dict[str, int]]) -> int:
    if name not in places[kind]:
        raise InputError(f"a pair names {kind} {name!r}, which the catalogue does not have")
    return places[kind][name]
