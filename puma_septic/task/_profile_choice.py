"""A profile by its name, with the options of its function."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import signature
from typing import Any, Final, final

from pydantic import Field, model_serializer, model_validator

from puma_septic import profiles
from puma_septic.errors import did_you_mean
from puma_septic.task._fields import Section, Text, fault, shortened
from puma_septic.trajectory import Trajectory

__all__ = ["ProfileChoice"]

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
