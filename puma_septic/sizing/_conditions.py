"""Conditions: what drives are held to besides the motion, the same for every pair that is tried."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.document import plain
from puma_septic.drives import Drivetrain, Gearbox, LinearStage, Motor, Supply
from puma_septic.errors import InputError
from puma_septic.limit_check import AT_LIMIT, LimitCheck
from puma_septic.sizing._checks import DRIVE_LIMITS
from puma_septic.validation import (
    Array,
    FrozenMap,
    checked_array,
    checked_choice,
    checked_flag,
    checked_kind,
    checked_number,
    n_dimensions,
)

__all__ = ["Conditions"]

_ALL: Final = "all"
# Values of each joint, by where a drive train has them.
_OF_PLACE: Final = {
    "altitude": "m", "momentary_torque": "N m", "emergency_stops": "", "emergency_duration": "s",
    "required_life_hours": "h", "max_inertia_ratio": "",
}  # fmt: skip
_NO_NUMBERS: Final = ("margins", "supply", "stages", "with_brake")
# All others are positive.
_LEAST: Final[Mapping[str, Any]] = {"ambient_celsius": {}, "altitude": {"at_least": 0.0}}
_OF_DRIVE: Final = {
    "bus_voltage": "V", "continuous_current": "A", "peak_current": "A", "continuous_power": "W", "peak_power": "W",
    "peak_regenerated_power": "W", "brake_resistor_power": "W",
}  # fmt: skip


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Conditions:
    """What drives are held to besides the motion; NaN: not asked for, or as the joint's drive train has it.

    Each is one number for all joints, or one for each in the robot's order.

    Parameters
    ----------
    ambient_celsius : array_like
        Degrees Celsius.
    bus_voltage, continuous_current, peak_current : array_like
        Of the drive, V and A (in the measure of the motors' torque constant).
    continuous_power, peak_power, peak_regenerated_power, brake_resistor_power : array_like
        Of the drive, W.
    altitude : array_like
        m above sea level.
    momentary_torque : array_like
        At the gearbox's output in a collision or emergency stop, N m (N).
    emergency_stops, emergency_duration : array_like
        How many of them there are in the life of gearboxes and brakes, and how long one lasts, s.
    required_life_hours : array_like
        Operating hours that the gearboxes are to last.
    max_inertia_ratio : array_like
        Largest accepted ratio of the load's inertia, gears included, to the rotor's.
    with_brake : bool
        Motors are taken with their holding brakes, also where no brake holds the arm at rest.
    stages : mapping of str to LinearStage
        Screw, rack or belt between the gearbox and a sliding joint, by joint.
    supply : Supply, optional
        That all drives share.
    margins : float or mapping of str to float
        What must be left of each limit, as a share of it: one for all, or by the kind of the check ("physics", "vendor
        procedure") or its quantity ("gearbox life"); the most particular one counts, "all" where none does.

    Raises
    ------
    InputError
        For a value that is none, a margin outside 0 to 1, or a margin of an unknown check.

    Examples
    --------
    >>> conditions = Conditions(bus_voltage=48.0, margins={"all": 0.2, "gearbox life": 0.0})
    >>> conditions.margin("physics", "motor torque"), conditions.margin("vendor procedure", "gearbox life")
    (0.2, 0.0)
    """

    ambient_celsius: ArrayLike = np.nan
    bus_voltage: ArrayLike = np.nan
    continuous_current: ArrayLike = np.nan
    peak_current: ArrayLike = np.nan
    continuous_power: ArrayLike = np.nan
    peak_power: ArrayLike = np.nan
    peak_regenerated_power: ArrayLike = np.nan
    brake_resistor_power: ArrayLike = np.nan
    altitude: ArrayLike = np.nan
    momentary_torque: ArrayLike = np.nan
    emergency_stops: ArrayLike = np.nan
    emergency_duration: ArrayLike = np.nan
    required_life_hours: ArrayLike = np.nan
    max_inertia_ratio: ArrayLike = np.nan
    with_brake: bool = False
    stages: Mapping[str, LinearStage] = field(default_factory=dict)
    supply: Supply | None = None
    margins: Mapping[str, float] | float = field(default_factory=dict)

    def __post_init__(self) -> None:
        for one in fields(self):
            if one.name not in _NO_NUMBERS:
                value = getattr(self, one.name)
                shape: tuple[int | None, ...] = () if n_dimensions(value) == 0 else (None,)
                least = _LEAST.get(one.name, {"above": 0.0})
                array = checked_array(one.name, value, shape, unit=_unit(one.name), allow_nan=True, **least)
                object.__setattr__(self, one.name, array)
        object.__setattr__(self, "with_brake", checked_flag("with_brake", self.with_brake))
        if self.supply is not None and not isinstance(self.supply, Supply):
            raise InputError(f"supply: expected a Supply, got {type(self.supply).__name__}")
        for joint, stage in checked_kind("stages", self.stages, Mapping).items():
            if not isinstance(stage, LinearStage):
                raise InputError(f"stages: joint {joint!r}: expected a LinearStage, got {type(stage).__name__}")
        object.__setattr__(self, "stages", FrozenMap(self.stages))
        object.__setattr__(self, "margins", _checked_margins(self.margins))

    def margin(self, kind: str, quantity: str) -> float:
        """What must be left of a limit, as a share of it; a rule of thumb asks for nothing."""
        margins: Any = self.margins
        return float(next((margins[key] for key in (quantity, kind, _ALL) if key in margins), 0.0))

    def stress(self, check: LimitCheck) -> float:
        """Utilisation over what may be used, ``utilisation / (1 - margin)``: above 1 the check is not kept."""
        return check.utilisation / (1 - self.margin(check.kind, check.quantity))

    def is_kept(self, check: LimitCheck) -> bool:
        """Whether a limit is kept with its margin."""
        return self.stress(check) <= 1 + AT_LIMIT

    def places(self, names: Sequence[str], given: Sequence[Drivetrain] | None) -> tuple[Drivetrain, ...]:
        """What each joint has whatever the parts: the drive trains given, with these conditions."""
        trains = [Drivetrain(motor=Motor(), gearbox=Gearbox(ratio=1.0)) for _ in names] if given is None else given
        for joint in self.stages:
            checked_choice("joint of stages", joint, names)
        staged = [
            replace(train, stage=self.stages[name]) if name in self.stages else train
            for name, train in zip(names, trains, strict=True)
        ]
        if self.with_brake:
            staged = [replace(train, with_brake=True) for train in staged]
        return tuple(self.applied(train, j, len(names)) for j, train in enumerate(staged))

    def applied(self, train: Drivetrain, j: int, n_joints: int) -> Drivetrain:
        """A joint's drive train under these conditions."""
        drive = {name: value for name in _OF_DRIVE if not np.isnan(value := self._at(name, j, n_joints))}
        place = {
            name: value
            for name in ("ambient_celsius", *_OF_PLACE)
            if not np.isnan(value := self._at(name, j, n_joints))
        }
        if not (drive or place):
            return train
        return replace(train, drive=replace(train.drive, **drive), **place)  # type: ignore[arg-type]

    def _at(self, name: str, j: int, n_joints: int) -> float:
        values = np.asarray(getattr(self, name))
        if values.ndim and len(values) != n_joints:
            raise InputError(f"{name}: {len(values)} values for {n_joints} joints; give one for all or one for each")
        return float(values[j] if values.ndim else values)

    def to_dict(self) -> dict[str, Any]:
        """What is asked for, JSON-ready; what is not is left out."""
        values = {one.name: getattr(self, one.name) for one in fields(self)}
        numbers = {
            name: plain(value)
            for name, value in values.items()
            if name not in ("supply", "stages", "with_brake") and not _is_unasked(value)
        }
        others: dict[str, Any] = {
            "with_brake": self.with_brake,
            "stages": {joint: _told(stage) for joint, stage in self.stages.items()},
            "supply": "" if self.supply is None else self.supply.name or "a shared bus",
        }
        return {**numbers, **{name: value for name, value in others.items() if value}}


def _told(stage: LinearStage) -> str:
    """A stage in a document: its kind, and what is known of it in SI units."""
    values = {one.name: getattr(stage, one.name) for one in fields(stage) if one.name != "source"}
    known = [f"{name} {value:g}" for name, value in values.items() if isinstance(value, float) and not np.isnan(value)]
    return ", ".join([*filter(None, (stage.kind, stage.name)), *known])


def _unit(name: str) -> str:
    return {"ambient_celsius": "degrees Celsius", **_OF_PLACE, **_OF_DRIVE}[name]


def _is_unasked(value: Array | Mapping[str, float]) -> bool:
    return not value if isinstance(value, Mapping) else bool(np.isnan(value).all())


def _checked_margins(given: object) -> Mapping[str, float]:
    margins: dict[str, Any] = dict(given) if isinstance(given, Mapping) else {_ALL: given}
    binding = [limit for limit in DRIVE_LIMITS if limit.kind != "rule of thumb"]
    valid = [_ALL, *dict.fromkeys(limit.kind for limit in binding), *(limit.quantity for limit in binding)]
    for name, value in margins.items():
        if name not in valid:
            raise InputError(f"margins: unknown check {name!r}; valid: {', '.join(valid)}")
        margins[name] = checked_number(f"margin of {name}", value, at_least=0.0)
        if not margins[name] < 1:
            raise InputError(f"margin of {name} = {value}: must be less than 1")
    return FrozenMap(margins)
