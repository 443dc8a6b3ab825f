"""What a task file may say: keys, types and what must fit together, checked by pydantic."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import signature
from itertools import pairwise
from math import sqrt
from pathlib import Path
from typing import Annotated, Any, Final, Literal, final

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    StrictBool,
    Tag,
    ValidationInfo,
    field_validator,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from puma_septic import profiles
from puma_septic.errors import did_you_mean
from puma_septic.robot import is_robot_path
from puma_septic.task._conditions import ConditionsSection, LoadCaseSection
from puma_septic.trajectory import Trajectory

__all__ = ["Point", "ProfileChoice", "Task", "shortened"]

# A quaternion typed with four digits passes and is then normalised; one further off is a mistake.
_UNIT_NORM: Final = 1e-3
# What a profile is given by the task itself; its other parameters are options.
_FROM_TASK: Final = ("points", "times", "durations", "joint_names")
# Marks in an error's location that a union leaves there and that are no keys of the file.
NUMBER, LIST, NAMED, WORD = MARKS = ("<number>", "<list>", "<by name>", "<word>")
OWN_WORDS: Final = "task"


def shortened(value: object) -> str:
    """A value as a message shows it."""
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def _fault(message: str) -> PydanticCustomError:
    """A fault told in our own words, which need no value behind them."""
    return PydanticCustomError(OWN_WORDS, "{message}", {"message": message})


def _printable(text: str) -> str:
    """One line without control characters, which could rewrite a terminal's screen."""
    if not text.isprintable():
        raise _fault(f"{text[:80]!r} must be one line without control characters")
    return text


def _beside_the_file(path: str, info: ValidationInfo) -> str:
    """A path in a task file is relative to the folder that the file lies in."""
    return str(Path((info.context or {}).get("folder", "."), path))


def _robot_source(source: str, info: ValidationInfo) -> str:
    """A name stays; a path is relative to the task file."""
    return _beside_the_file(source, info) if is_robot_path(source) else source


Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0)]
Vector = Annotated[tuple[Number, ...], Field(min_length=3, max_length=3)]
Text = Annotated[str, Field(strict=True, min_length=1, max_length=200), AfterValidator(_printable)]
FilePath = Annotated[Text, AfterValidator(_beside_the_file)]
PerJoint = Annotated[
    Annotated[Positive, Tag(NUMBER)] | Annotated[tuple[Positive, ...], Tag(LIST)],
    Discriminator(lambda value: LIST if isinstance(value, (list, tuple)) else NUMBER),
]


class Section(BaseModel):
    """A mapping in the file: only the keys that are known, and never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _only_known_keys(cls, data: Any) -> Any:
        """Say which keys would be valid; pydantic alone says only that one is not."""
        valid = ", ".join(cls.model_fields)
        if isinstance(data, cls):
            return data
        if not isinstance(data, dict):
            raise _fault(f"expected a mapping with keys among: {valid}; got {shortened(data)}")
        for key in data:
            if key not in cls.model_fields:
                meant = did_you_mean([str(key)], cls.model_fields)
                raise _fault(f"unknown key {shortened(key)}; valid: {valid}{meant}")
        return data


@final
class BodySection(Section):
    """The arguments of `Payload`, of a link."""

    mass: NotNegative
    com: Vector
    inertia: Annotated[tuple[Vector, ...], Field(min_length=3, max_length=3)]


@final
class RobotSection(Section):
    """The arguments of `load_robot`."""

    source: Annotated[Text, AfterValidator(_robot_source)] = "puma560"
    parameters: Text | None = None
    limits: Text | None = None
    tool: Text | None = None
    actuators: FilePath | None = None
    package_dirs: tuple[FilePath, ...] = ()
    locked: Annotated[
        Annotated[Literal["others"], Tag(WORD)] | Annotated[dict[Text, Number | None], Tag(NAMED)],
        Discriminator(lambda value: WORD if isinstance(value, str) else NAMED),
    ] = Field(default_factory=dict)
    links: dict[Text, BodySection] = Field(default_factory=dict)
    gravity: Vector = (0.0, 0.0, -9.81)


@final
class Quaternion(Section):
    """A unit quaternion by component, since lists of both orders are in use."""

    w: Number
    x: Number
    y: Number
    z: Number

    @model_validator(mode="after")
    def _is_unit(self) -> Quaternion:
        norm = sqrt(self.w**2 + self.x**2 + self.y**2 + self.z**2)
        if not abs(norm - 1) <= _UNIT_NORM:
            raise _fault(f"its norm is {norm:.6g}; a rotation's is 1 (to {_UNIT_NORM})")
        return self


def _unit(axis: tuple[float, ...]) -> tuple[float, ...]:
    """A direction as a unit vector."""
    length = sqrt(sum(value**2 for value in axis))
    if not length > 0:
        raise _fault("0 0 0 is no direction")
    return tuple(value / length for value in axis)


@final
class Point(Section):
    """Joint positions, or a pose of the tool in the task's frame.

    For arms with fewer than six axes the position alone, or with the direction of the tool's z axis, is enough.
    """

    name: Text | None = None
    joints: (
        Annotated[
            Annotated[tuple[Number, ...], Tag(LIST)] | Annotated[dict[Text, Number], Tag(NAMED)],
            Discriminator(lambda value: NAMED if isinstance(value, dict) else LIST),
        ]
        | None
    ) = None
    position: Vector | None = None
    rpy_deg: Vector | None = None
    quaternion: Quaternion | None = None
    axis: Annotated[Vector, AfterValidator(_unit)] | None = None

    @property
    def constrain(self) -> str:
        """Which conditions of its pose count, as `inverse_kinematics` has it."""
        if self.rpy_deg is not None or self.quaternion is not None:
            return "pose"
        return "position" if self.axis is None else "axis"

    @model_validator(mode="after")
    def _is_one_of_both(self) -> Point:
        turned = sum(value is not None for value in (self.rpy_deg, self.quaternion, self.axis))
        is_pose = self.joints is None and self.position is not None and turned <= 1
        is_joints = self.joints is not None and self.position is None and turned == 0
        if not (is_pose or is_joints):
            given = ", ".join(self.model_dump(exclude_none=True)) or "nothing"
            raise _fault(
                f"needs either joints, or position with one of rpy_deg, quaternion and axis (or alone); given: {given}"
            )
        return self


@final
class ProfileChoice(Section):
    """A profile's name, alone or in a mapping with the options of its function."""

    name: Text
    options: dict[str, Any] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _only_known_keys(cls, data: Any) -> Any:
        """Take `septic` and `{name: lspb, blend_time: 1.0}` apart, against the profile's own signature."""
        if isinstance(data, (str, cls)):
            data = {"name": data} if isinstance(data, str) else data.model_dump()
        if not isinstance(data, dict) or not isinstance(data.get("name"), str):
            raise _fault(f"expected a profile's name, or a mapping with the key name; got {shortened(data)}")
        name = data["name"]
        if name not in profiles.names():
            valid = sorted(profiles.names())
            raise _fault(f"unknown profile {name!r}; valid: {', '.join(valid)}{did_you_mean([name], valid)}")
        options = {key: value for key, value in data.items() if key != "name"}
        _check_options(name, options, profiles.family(name).function)
        return {"name": name, "options": options}

    @model_serializer
    def _flat(self) -> dict[str, Any]:
        return {"name": self.name, **self.options}


def _check_options(name: str, options: Mapping[str, Any], profile: Callable[..., Trajectory]) -> None:
    """Hold options against the profile's signature; their values are the profile's own to check."""
    parameters = {key: p for key, p in signature(profile).parameters.items() if key not in _FROM_TASK}
    unknown = [key for key in options if key not in parameters]
    missing = [key for key, p in parameters.items() if p.default is p.empty and key not in options]
    if unknown:
        valid = ", ".join(parameters) or "none"
        raise _fault(f"unknown option {shortened(unknown[0])} of profile {name!r}; valid: {valid}")
    if missing:
        key = missing[0]
        raise _fault(f"profile {name!r} needs the option {key!r}: {{name: {name}, {key}: ...}}")


@final
class PayloadSection(Section):
    """The arguments of `Payload`."""

    mass: NotNegative
    com: Vector = (0.0, 0.0, 0.0)
    inertia: Annotated[tuple[Vector, ...], Field(min_length=3, max_length=3)] = ((0.0, 0.0, 0.0),) * 3


@final
class WrenchSection(Section):
    """The arguments of `Wrench`."""

    force: Vector = (0.0, 0.0, 0.0)
    torque: Vector = (0.0, 0.0, 0.0)
    axes: Literal["tool", "world"] = "tool"


@final
class LimitsSection(Section):
    """Limits that replace the robot's: a number for all joints, or one for each."""

    position: tuple[Annotated[tuple[Number, ...], Field(min_length=2, max_length=2)], ...] | None = None
    velocity: PerJoint | None = None
    acceleration: PerJoint | None = None
    jerk: PerJoint | None = None
    effort: PerJoint | None = None
    torque_rate: PerJoint | None = None


@final
class Task(Section):
    """A task as its file has it, paths made absolute; see docs/tasks.md for every key.

    Attributes
    ----------
    name, description : str
    robot : RobotSection
    frame : str
        Frame of the robot, fixed to the world, that poses are given in; "world" by default.
    points : tuple of Point
    branch : str
        Branch of the inverse kinematics that all poses are reached in, or "auto".
    floor : float or None
        Height, m: "auto" takes a branch that stays above it at all points before any other.
    times, durations : tuple of float
        One of both, s; times begin at 0.
    profiles : tuple of ProfileChoice
    payload, wrench, limits : section or None
    dwell : float
        s
    rest_before, rest_after : bool
        Whether the arm is at rest before and after the motion.
    conditions : ConditionsSection or None
        What a sizing holds drives to besides the motion.
    load_cases : tuple of LoadCaseSection
        What the same drives must do in a sizing; the task's own cycle where there are none.
    """

    name: Text
    description: Annotated[str, Field(strict=True, max_length=2000)] = ""
    robot: RobotSection = Field(default_factory=RobotSection)
    frame: Text = "world"
    points: Annotated[tuple[Point, ...], Field(min_length=1)]
    branch: Text = "auto"
    floor: Number | None = None
    times: tuple[Number, ...] | None = None
    durations: tuple[Positive, ...] | None = None
    profiles: Annotated[tuple[ProfileChoice, ...], Field(min_length=1)]
    payload: PayloadSection | None = None
    wrench: WrenchSection | None = None
    dwell: NotNegative = 0.0
    rest_before: StrictBool = True
    rest_after: StrictBool = True
    limits: LimitsSection | None = None
    conditions: ConditionsSection | None = None
    load_cases: tuple[LoadCaseSection, ...] = ()

    _origin: str = ""

    def model_post_init(self, context: Mapping[str, Any] | None, /) -> None:
        """Keep what messages call the file."""
        self._origin = (context or {}).get("origin", f"task {self.name!r}")

    @property
    def origin(self) -> str:
        """Where the task comes from, for messages."""
        return self._origin

    @field_validator("times")
    @classmethod
    def _times_increase(cls, times: tuple[float, ...] | None) -> tuple[float, ...] | None:
        if times and times[0] != 0:
            raise _fault(f"must begin at 0 s, not at {times[0]:g} s")
        for k, (before, after) in enumerate(pairwise(times or ())):
            if not after > before:
                raise _fault(f"must increase strictly, but times[{k}] = {before:g} s is followed by {after:g} s")
        return times

    @model_validator(mode="after")
    def _timed_once(self) -> Task:
        n = len(self.points)
        if (self.times is None) == (self.durations is None):
            given = "neither is given" if self.times is None else "both are given"
            raise _fault(f"needs either times or durations; {given}")
        if self.times is not None and len(self.times) != n:
            raise _fault(f"times: {len(self.times)} times for {n} points; one for each is needed")
        if self.durations is not None and len(self.durations) != n - 1:
            count = len(self.durations)
            raise _fault(f"durations: {count} durations for {n} points; one fewer than points is needed")
        return self

    def document(self) -> dict[str, Any]:
        """What the file said, JSON-ready; `parse_task` takes it back."""
        return self.model_dump(mode="json", exclude_unset=True)
