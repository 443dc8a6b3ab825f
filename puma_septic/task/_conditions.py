"""Conditions and load cases of a sizing as a task file has them."""

from __future__ import annotations

from typing import Annotated, Literal, final

from pydantic import Discriminator, Field, StrictBool, Tag, model_validator

from puma_septic.task._fields import (
    NAMED,
    NUMBER,
    FilePath,
    NotNegative,
    Number,
    PayloadSection,
    PerJoint,
    Positive,
    Section,
    Text,
    fault,
)

__all__ = ["ConditionsSection", "LoadCaseSection"]

Share = Annotated[float, Field(strict=True, ge=0, lt=1)]
Margins = Annotated[
    Annotated[Share, Tag(NUMBER)] | Annotated[dict[Text, Share], Tag(NAMED)],
    Discriminator(lambda value: NAMED if isinstance(value, dict) else NUMBER),
]


@final
class SupplySection(Section):
    """The bus that all drives share; see `puma_septic.drives.Supply`."""

    name: Text = ""
    bus_voltage: Positive | None = None
    peak_power: Positive | None = None
    continuous_power: Positive | None = None
    max_current: Positive | None = None
    storable_energy: NotNegative | None = None
    brake_resistor_power: Positive | None = None
    peak_brake_power: Positive | None = None
    standby_power: NotNegative | None = None


@final
class StageSection(Section):
    """Screw, rack or belt of a sliding joint; see `puma_septic.drives.LinearStage`."""

    kind: Literal["screw", "rack", "belt"]
    travel_per_turn: Positive
    name: Text = ""
    efficiency: Positive | None = None
    backward_efficiency: NotNegative | None = None
    inertia: NotNegative | None = None
    friction_force: NotNegative | None = None
    max_force: Positive | None = None
    max_speed: Positive | None = None


@final
class ConditionsSection(Section):
    """What drives are held to besides the motion; see `puma_septic.sizing.Conditions`.

    Attributes
    ----------
    cycles_per_minute : float
        The rest of the time after the moves is rest, in equal parts after each.
    brake_at_rest : bool
        Whether brakes hold the arm while it rests.
    with_brake : bool
        Whether motors are taken with their holding brakes, also where none holds the arm at rest.
    stages : dict of str to StageSection
        By sliding joint.
    own_masses : tuple of float
        kg, of the drives that the robot's model includes already; they are taken off where drives are placed on it.
    """

    cycles_per_minute: Positive | None = None
    brake_at_rest: StrictBool = False
    ambient_celsius: Number | None = None
    altitude: NotNegative | None = None
    supply: SupplySection | None = None
    bus_voltage: PerJoint | None = None
    continuous_current: PerJoint | None = None
    peak_current: PerJoint | None = None
    continuous_power: PerJoint | None = None
    peak_power: PerJoint | None = None
    peak_regenerated_power: PerJoint | None = None
    brake_resistor_power: PerJoint | None = None
    momentary_torque: PerJoint | None = None
    required_life_hours: PerJoint | None = None
    max_inertia_ratio: PerJoint | None = None
    emergency_stops: PerJoint | None = None
    emergency_duration: PerJoint | None = None
    with_brake: StrictBool = False
    stages: dict[Text, StageSection] | None = None
    margins: Margins | None = None
    own_masses: tuple[NotNegative, ...] | None = None


@final
class LoadCaseSection(Section):
    """A load case: the task's cycle with another payload, another task, or one that is generated.

    Attributes
    ----------
    name : str
    kind : str
        "cycle"; "payload range": two cycles, with the least and the largest mass; "worst pose": each joint holds where
        it holds most; "emergency stop": along the path from each joint's worst instant.
    share : float
        Of the operating time, relative to the others; 0 for what only has to be kept.
    task : str
        Another task file of the same arm, in place of this one's motion; where it has a cycle, with its own loads.
    payload : PayloadSection
        In place of the task's.
    way : {"return", "one way"}
        Back along the same path with an empty hand, or not.
    idle : float
        s, more rest.
    masses : tuple of float
        Of a payload range, kg.
    category : {0, 1}
        Of an emergency stop (IEC 60204-1, 9.2.2): 0 by the brakes, 1 by the motors.
    time : float
        Of an emergency stop from full speed to rest, s.
    """

    name: Text
    kind: Literal["cycle", "payload range", "worst pose", "emergency stop"] = "cycle"
    share: NotNegative | None = None
    task: FilePath | None = None
    payload: PayloadSection | None = None
    way: Literal["return", "one way"] = "return"
    idle: Positive | None = None
    masses: Annotated[tuple[NotNegative, ...], Field(min_length=2, max_length=2)] | None = None
    category: Literal[0, 1] = 1
    time: Positive | None = None

    @model_validator(mode="after")
    def _has_what_its_kind_needs(self) -> LoadCaseSection:
        needed = {"payload range": "masses", "emergency stop": "time"}
        for kind, key in needed.items():
            if (self.kind == kind) != (getattr(self, key) is not None):
                raise fault(f"load case {self.name!r}: {key} goes with the kind {kind!r}, and is needed there")
        return self
