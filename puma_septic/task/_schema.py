"""What a task file may say: keys, types and what must fit together, checked by pydantic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import sqrt
from typing import Annotated, Any, Final, Literal, final

from pydantic import AfterValidator, Discriminator, Field, StrictBool, Tag, field_validator, model_validator

from puma_septic.document import card, one_line
from puma_septic.errors import readable
from puma_septic.task._conditions import ConditionsSection, LoadCaseSection
from puma_septic.task._fields import (
    LIST,
    NAMED,
    WORD,
    FilePath,
    NotNegative,
    Number,
    PayloadSection,
    PerJoint,
    Positive,
    ProfileChoice,
    RobotSource,
    Section,
    Text,
    Vector,
    fault,
)
from puma_septic.task._steps import MoveDefaults, Step, check_steps

__all__ = ["BodySection", "Point", "Task"]

# A quaternion typed with four digits passes and is then normalised; one further off is a mistake.
_UNIT_NORM: Final = 1e-3
# What belongs to a task of one motion, and where a cycle has it.
_OF_ONE_MOTION: Final[tuple[str, ...]] = (
    "times",
    "durations",
    "profiles",
    "dwell",
    "rest_before",
    "rest_after",
    "load_cases",
)
_IN_A_CYCLE: Final = "there each move has its duration or speed and its profile, and a rest is a step: - dwell: 0.5"


@final
class BodySection(Section):
    """The arguments of `Payload`, of a link."""

    mass: NotNegative
    com: Vector
    inertia: Annotated[tuple[Vector, ...], Field(min_length=3, max_length=3)]


@final
class RobotSection(Section):
    """The arguments of `load_robot`."""

    source: RobotSource = "puma560"
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
            raise fault(f"its norm is {norm:.6g}; a rotation's is 1 (to {_UNIT_NORM})")
        return self


def _unit(axis: tuple[float, ...]) -> tuple[float, ...]:
    """A direction as a unit vector."""
    length = sqrt(sum(value**2 for value in axis))
    if not length > 0:
        raise fault("0 0 0 is no direction")
    return tuple(value / length for value in axis)


JointValues = Annotated[
    Annotated[tuple[Number, ...], Tag(LIST)] | Annotated[dict[Text, Number], Tag(NAMED)],
    Discriminator(lambda value: NAMED if isinstance(value, dict) else LIST),
]


@final
class Point(Section):
    """Joint positions, in rad or in degrees, or a pose of the tool in the task's frame.

    For arms with fewer than six axes the position alone, or with the direction of the tool's z axis, is enough.
    """

    name: Text | None = None
    joints: JointValues | None = None
    joints_deg: JointValues | None = None
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

    @property
    def is_posed(self) -> bool:
        """Whether it is a pose, not joint positions."""
        return self.position is not None

    @model_validator(mode="after")
    def _is_one_of_both(self) -> Point:
        turned = sum(value is not None for value in (self.rpy_deg, self.quaternion, self.axis))
        given = sum(value is not None for value in (self.joints, self.joints_deg))
        is_pose = not given and self.is_posed and turned <= 1
        is_joints = given == 1 and not self.is_posed and turned == 0
        if not (is_pose or is_joints):
            told = ", ".join(self.model_dump(exclude_none=True)) or "nothing"
            raise fault(
                "needs either joints (or joints_deg), or position with one of rpy_deg, quaternion and axis (or alone);"
                f" given: {told}"
            )
        return self


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
class ToolLimitsSection(Section):
    """The arguments of `ToolLimits`."""

    speed: Positive | None = None
    acceleration: Positive | None = None
    jerk: Positive | None = None
    angular_speed: Positive | None = None
    source: Text | None = None

    @model_validator(mode="after")
    def _has_one(self) -> ToolLimitsSection:
        if all(value is None for value in (self.speed, self.acceleration, self.jerk, self.angular_speed)):
            raise fault("needs one of speed, acceleration, jerk and angular_speed")
        return self


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
    cycle : tuple of steps
        In place of times and profiles: moves from point to point, grips, rests.
    defaults : MoveDefaults
        What the moves of a cycle do unless they say otherwise.
    repeat : bool
        Whether a cycle begins again where it ends, all day.
    payload, wrench, limits, tool_limits : section or None
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
    description: Annotated[str, Field(strict=True, max_length=2000), AfterValidator(readable)] = ""
    robot: RobotSection = Field(default_factory=RobotSection)
    frame: Text = "world"
    points: Annotated[tuple[Point, ...], Field(min_length=1)]
    branch: Text = "auto"
    floor: Number | None = None
    times: tuple[Number, ...] | None = None
    durations: tuple[Positive, ...] | None = None
    profiles: Annotated[tuple[ProfileChoice, ...], Field(min_length=1)] = ()
    cycle: Annotated[tuple[Step, ...], Field(min_length=1)] = ()
    defaults: MoveDefaults = Field(default_factory=MoveDefaults)
    repeat: StrictBool = True
    payload: PayloadSection | None = None
    wrench: WrenchSection | None = None
    dwell: NotNegative = 0.0
    rest_before: StrictBool = True
    rest_after: StrictBool = True
    limits: LimitsSection | None = None
    conditions: ConditionsSection | None = None
    load_cases: tuple[LoadCaseSection, ...] = ()
    tool_limits: ToolLimitsSection | None = None

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
            raise fault(f"must begin at 0 s, not at {times[0]:g} s")
        for k, (before, after) in enumerate(pairwise(times or ())):
            if not after > before:
                raise fault(f"must increase strictly, but times[{k}] = {before:g} s is followed by {after:g} s")
        return times

    @model_validator(mode="after")
    def _is_one_of_both(self) -> Task:
        """Either points with times and profiles, or points that a cycle leads to."""
        if self.cycle:
            if mixed := self._given(_OF_ONE_MOTION):
                raise fault(f"{', '.join(mixed)}: not beside a cycle; {_IN_A_CYCLE}", key=mixed[0])
            check_steps(self.cycle, self.defaults, [point.name for point in self.points])
            return self
        if mixed := self._given(("defaults", "repeat")):
            raise fault(f"{', '.join(mixed)}: only beside a cycle", key=mixed[0])
        if not self.profiles:
            raise fault("profiles is missing")
        self._check_times()
        return self

    def _given(self, keys: Sequence[str]) -> list[str]:
        return [key for key in keys if key in self.model_fields_set]

    def _check_times(self) -> None:
        n = len(self.points)
        if (self.times is None) == (self.durations is None):
            given = "neither is given" if self.times is None else "both are given"
            raise fault(f"needs either times or durations; {given}")
        if self.times is not None and len(self.times) != n:
            raise fault(f"times: {len(self.times)} times for {n} points; one for each is needed")
        if self.durations is not None and len(self.durations) != n - 1:
            count = len(self.durations)
            raise fault(f"durations: {count} durations for {n} points; one fewer than points is needed")

    def document(self) -> dict[str, Any]:
        """What the file said, JSON-ready; `parse_task` takes it back."""
        return self.model_dump(mode="json", exclude_unset=True)

    def __repr__(self) -> str:
        return one_line("Task", self._facts())

    def _repr_html_(self) -> str:
        return card("Task", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "name": self.name,
            "robot": self.robot.source,
            "points": len(self.points),
            "profiles": ", ".join(one.name for one in self.profiles),
        }
