"""What every part of a task file is made of: numbers, texts, paths, profiles, and sections that know their keys."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from inspect import signature
from pathlib import Path
from typing import Annotated, Any, Final, Self, final

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    ValidationInfo,
    model_serializer,
    model_validator,
)
from pydantic.functional_validators import ModelWrapValidatorHandler
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from puma_septic import profiles
from puma_septic.errors import did_you_mean
from puma_septic.robot import is_robot_path
from puma_septic.trajectory import Trajectory

__all__ = [
    "DWELL",
    "GRIP",
    "LIST",
    "MARKS",
    "MOVE",
    "NAMED",
    "NUMBER",
    "OWN_WORDS",
    "WORD",
    "FilePath",
    "NotNegative",
    "Number",
    "PayloadSection",
    "PerJoint",
    "Positive",
    "ProfileChoice",
    "RobotSource",
    "Section",
    "Text",
    "Vector",
    "fault",
    "shortened",
]

# Marks in an error's location that a union leaves there and that are no keys of the file.
NUMBER, LIST, NAMED, WORD, MOVE, GRIP, DWELL = MARKS = (
    "<number>",
    "<list>",
    "<by name>",
    "<word>",
    "<move>",
    "<grip>",
    "<dwell>",
)
OWN_WORDS: Final = "task"


def shortened(value: object) -> str:
    """A value as a message shows it."""
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def fault(message: str, *, key: object = None) -> PydanticCustomError:
    """A fault told in our own words, which need no value behind them; `key` is where in its section it stands."""
    return PydanticCustomError(OWN_WORDS, "{message}", {"message": message, "key": key})


def _printable(text: str) -> str:
    """One line without control characters, which could rewrite a terminal's screen."""
    if not text.isprintable():
        raise fault(f"{text[:80]!r} must be one line without control characters")
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
RobotSource = Annotated[Text, AfterValidator(_robot_source)]
PerJoint = Annotated[
    Annotated[Positive, Tag(NUMBER)] | Annotated[tuple[Positive, ...], Tag(LIST)],
    Discriminator(lambda value: LIST if isinstance(value, (list, tuple)) else NUMBER),
]


class Section(BaseModel):
    """A mapping in the file: only the keys that are known, and never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="wrap")
    @classmethod
    def _only_known_keys(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Say of each unknown key which would be valid, beside what is wrong with the others."""
        valid = ", ".join(cls.model_fields)
        if isinstance(data, cls):
            return data
        if not isinstance(data, dict):
            raise fault(f"expected a mapping with keys among: {valid}; got {shortened(data)}")
        unknown = [key for key in data if key not in cls.model_fields]
        if not unknown:
            return handler(data)
        faults = [_unknown_key(key, cls.model_fields) for key in unknown]
        try:
            handler({key: value for key, value in data.items() if key not in unknown})
        except ValidationError as error:
            faults += [_again(one) for one in error.errors(include_url=False)]
        raise ValidationError.from_exception_data(cls.__name__, faults)


@final
class PayloadSection(Section):
    """The arguments of `Payload`."""

    mass: NotNegative
    com: Vector = (0.0, 0.0, 0.0)
    inertia: Annotated[tuple[Vector, ...], Field(min_length=3, max_length=3)] = ((0.0, 0.0, 0.0),) * 3


def _unknown_key(key: object, valid: Iterable[str]) -> InitErrorDetails:
    names = list(valid)
    message = f"unknown key {shortened(key)}; valid: {', '.join(names)}{did_you_mean([str(key)], names)}"
    return InitErrorDetails(type=fault(message, key=key), loc=(), input=key)


def _again(error: ErrorDetails) -> InitErrorDetails:
    """A fault that was found inside, to be told beside others."""
    context = error.get("ctx", {})
    known = error["type"] if error["type"] != OWN_WORDS else fault(**context)
    return InitErrorDetails(type=known, loc=error["loc"], input=error["input"], ctx=context)


# What a profile is given by the task itself; its other parameters are options.
_FROM_TASK: Final = ("points", "times", "durations", "joint_names")


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
            raise fault(f"expected a profile's name, or a mapping with the key name; got {shortened(data)}")
        name = data["name"]
        if name not in profiles.names():
            valid = sorted(profiles.names())
            raise fault(f"unknown profile {name!r}; valid: {', '.join(valid)}{did_you_mean([name], valid)}")
        options = {key: value for key, value in data.items() if key != "name"}
        _check_options(name, options, profiles.family(name).function)
        return {"name": name, "options": options}

    @property
    def finds_times(self) -> bool:
        """Whether it takes no times, but finds its own."""
        return not profiles.family(self.name).takes_times(self.options)

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
        raise fault(f"unknown option {shortened(unknown[0])} of profile {name!r}; valid: {valid}")
    if missing:
        key = missing[0]
        raise fault(f"profile {name!r} needs the option {key!r}: {{name: {name}, {key}: ...}}")
