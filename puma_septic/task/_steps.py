"""The steps of a cycle as a task file has them: moves, grips, rests, the way back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Final, Literal, final

from pydantic import Discriminator, Field, StrictBool, Tag, ValidationError, model_validator
from pydantic_core import InitErrorDetails

from puma_septic.errors import did_you_mean
from puma_septic.task._fields import (
    DWELL,
    GRIP,
    LIST,
    MOVE,
    WORD,
    PayloadSection,
    Positive,
    ProfileChoice,
    Section,
    Text,
    Vector,
    fault,
    shortened,
)

__all__ = ["DwellStep", "GripStep", "Move", "MoveDefaults", "Step", "check_steps"]

ToolAxis = Literal["x", "-x", "y", "-y", "z", "-z"]
Names = Annotated[
    Annotated[Text, Tag(WORD)] | Annotated[tuple[Text, ...], Field(min_length=1), Tag(LIST)],
    Discriminator(lambda value: LIST if isinstance(value, (list, tuple)) else WORD),
]
# What a straight stretch takes its time from.
_TIMED: Final = "a straight stretch needs speed and acceleration"
_ONLY: Final = {
    "zone": ("line",),
    "turn_axis": ("line",),
    "via": ("arc",),
    "orientation": ("arc",),
    "durations": ("joint",),
}
# Where a key counts.
_USES: Final = {
    **dict.fromkeys(("speed", "acceleration", "jerk"), "they time lines and arcs without a duration, and approaches"),
    "profile": "along lines and arcs it goes with a duration",
    "tool_axis": "it is that of approach and retreat",
    **dict.fromkeys(("duration", "durations"), "this profile finds its own time"),
}
_STEPS: Final = (
    "a step is a move with the key to, such as {move: line, to: place, speed: 0.25, acceleration: 1}, or grip, release,"
    " dwell or back"
)


class MoveDefaults(Section):
    """What every move of a cycle does unless it says otherwise."""

    speed: Positive | None = None
    acceleration: Positive | None = None
    jerk: Positive | None = None
    profile: ProfileChoice | None = None
    tool_axis: ToolAxis | None = None


@final
class Move(MoveDefaults):
    """A move of the arm from where it is to a point, or over several.

    Attributes
    ----------
    name : str
        What messages and tables call it.
    move : {"joint", "line", "arc"}
        Joints in step, or the tool straight or round.
    to : str or tuple of str
        Names of points.
    via : str
        The point that an arc passes.
    approach, retreat : float
        m: the last, or the first, stretch is straight along the tool's axis, from rest to rest.
    tool_axis : str
        Axis of the tool that an approach follows; "z" by default.
    orientation : {"geodesic", "held", "tangent"}
        Of an arc.
    turn_axis : tuple of float
        World axis of a line's turn, where its ends are half a turn apart.
    zone : float
        m: radius about each corner of a line over several points within which it is rounded; without one the tool
        stops there.
    duration, durations : float, tuple of float
        s: of the whole move; between the points of a joint move.
    profile : ProfileChoice
        Of a joint move, or of the law of time of a line or arc with a duration.
    speed, acceleration, jerk : float
        Of the tool along lines and arcs, m/s and so on.
    """

    name: Text | None = None
    move: Literal["joint", "line", "arc"] = "joint"
    to: Names
    via: Text | None = None
    approach: Positive | None = None
    retreat: Positive | None = None
    orientation: Literal["geodesic", "held", "tangent"] | None = None
    turn_axis: Vector | None = None
    zone: Positive | None = None
    duration: Positive | None = None
    durations: tuple[Positive, ...] | None = None

    @property
    def targets(self) -> tuple[str, ...]:
        """Names of the points it leads to, in order."""
        return (self.to,) if isinstance(self.to, str) else self.to

    @property
    def has_straights(self) -> bool:
        """Whether it begins or ends with a straight stretch of its own."""
        return self.approach is not None or self.retreat is not None

    def with_defaults(self, defaults: MoveDefaults) -> Move:
        """The move with what the defaults say and it does not."""
        missing = {key: value for key, value in defaults if value is not None and getattr(self, key) is None}
        return self.model_copy(update=missing)

    @model_validator(mode="after")
    def _fits_its_kind(self) -> Move:
        for key, kinds in _ONLY.items():
            if getattr(self, key) is not None and self.move not in kinds:
                raise fault(f"{key} belongs to a move of kind {' or '.join(kinds)}, not {self.move}", key=key)
        n = len(self.targets)
        if self.duration is not None and self.durations is not None:
            raise fault("needs duration or durations, not both", key="duration")
        if self.durations is not None and len(self.durations) != n:
            raise fault(f"durations: {len(self.durations)} durations for {n} points; one for each is needed")
        if self.move == "arc" and (self.via is None or n > 1):
            raise fault("an arc needs via, the point that it passes, and one point in to")
        if self.zone is not None and n + self.has_straights < 2:
            raise fault("zone: a line to one point has no corner; name several points in to", key="zone")
        if self.duration is not None and self.zone is None and self.move == "line" and n + self.has_straights > 1:
            raise fault(
                "duration: this line stops at its corners, so give speed and acceleration, or round them: zone",
                key="duration",
            )
        if self.duration is not None and self.move == "joint" and n > 1:
            raise fault(f"duration: {n} points need durations, one for each", key="duration")
        if idle := self._idle:
            raise fault(f"{', '.join(idle)}: of no effect here; {_USES[idle[0]]}", key=idle[0])
        return self

    @property
    def _by_speed(self) -> bool:
        """Whether some of it is timed by the tool's speed."""
        timed = self.move != "joint" and self.duration is not None
        rounded = timed and self.move == "line" and self.zone is not None
        return (self.move != "joint" and not timed) or (self.has_straights and not rounded)

    @property
    def _idle(self) -> list[str]:
        """What is written but would change nothing."""
        unused = {
            **dict.fromkeys(("speed", "acceleration", "jerk"), not self._by_speed),
            "profile": self.move != "joint" and self.duration is None,
            "tool_axis": not self.has_straights,
            "duration": self.move == "joint" and self._times_itself,
            "durations": self._times_itself,
        }
        return [key for key, is_idle in unused.items() if is_idle and getattr(self, key) is not None]

    @property
    def untimed(self) -> str:
        """What is missing to time it, defaults included; empty where nothing is."""
        if self._by_speed and (self.speed is None or self.acceleration is None):
            return _TIMED + ("" if self.has_straights else ", or the move a duration")
        timed = self.duration is not None or self.durations is not None or self._times_itself
        return "" if self.move != "joint" or timed else "a joint move needs duration, or durations for several points"

    @property
    def _times_itself(self) -> bool:
        return self.profile is not None and self.profile.finds_times


@final
class GripStep(Section):
    """The tool takes a body, beside what it carries all the time."""

    grip: PayloadSection


@final
class DwellStep(Section):
    """Rest where the arm is, s; with a brake the motors hold nothing."""

    dwell: Positive
    brake: StrictBool = False


def _kind(value: Any) -> str:
    """Which step a value is, by its keys."""
    for kind, model in ((MOVE, Move), (GRIP, GripStep), (DWELL, DwellStep), (WORD, str)):
        if isinstance(value, model):
            return kind
    for key, kind in (("grip", GRIP), ("dwell", DWELL)):
        if isinstance(value, dict) and key in value and "to" not in value:
            return kind
    return MOVE


Step = Annotated[
    Annotated[Move, Tag(MOVE)]
    | Annotated[GripStep, Tag(GRIP)]
    | Annotated[DwellStep, Tag(DWELL)]
    | Annotated[Literal["release", "back"], Tag(WORD)],
    Discriminator(_kind),
]


def check_steps(steps: Sequence[Any], defaults: MoveDefaults, points: Sequence[str | None]) -> None:
    """Raise a ValidationError with all that does not fit together in a cycle."""
    names = [name for name in points if name is not None]
    faults = [*_point_faults(points)]
    holds = moved = False
    for k, step in enumerate(steps):
        at = ("cycle", k)
        if isinstance(step, Move):
            faults += _move_faults(step.with_defaults(defaults), names, at)
            moved = True
        elif isinstance(step, GripStep):
            faults += [_told("grip: the tool holds something already; release it first", at)] if holds else []
            holds = True
        elif step == "release":
            faults += [] if holds else [_told("release: the tool holds nothing here", at)]
            holds = False
        elif step == "back" and not moved:
            faults.append(_told("back: nothing has been moved yet", at))
    if not moved:
        faults.append(_told(f"no move; {_STEPS}", ("cycle",)))
    if faults:
        raise ValidationError.from_exception_data("cycle", faults)


def _point_faults(points: Sequence[str | None]) -> list[InitErrorDetails]:
    found = []
    for k, name in enumerate(points):
        if name is None:
            found.append(_told("needs a name, which the steps of the cycle call it by", ("points", k)))
        elif name in points[:k]:
            found.append(_told(f"the name {name!r} stands for an earlier point already", ("points", k)))
    return found


def _move_faults(move: Move, names: Sequence[str], at: tuple[str, int]) -> list[InitErrorDetails]:
    given = [("to", name) for name in move.targets] + ([("via", move.via)] if move.via is not None else [])
    found = [
        _told(f"unknown point {shortened(name)}; valid: {', '.join(names)}{did_you_mean([name], names)}", (*at, key))
        for key, name in given
        if name not in names
    ]
    return found + ([_told(move.untimed, at)] if move.untimed else [])


def _told(message: str, location: tuple[int | str, ...]) -> InitErrorDetails:
    return InitErrorDetails(type=fault(message), loc=location, input=None)
