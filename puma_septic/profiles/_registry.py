"""Which profiles there are, and one call for all of them, by what each one's signature takes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from inspect import signature
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.profiles._info import ProfileInfo
from puma_septic.trajectory import Trajectory
from puma_septic.validation import checked_choice, checked_kind, checked_times

__all__ = ["Family", "Registry"]

# What a profile is given, and what it is told by options.
_GIVEN = ("points", "times", "joint_names")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Family:
    """A profile and what is said of it.

    Attributes
    ----------
    info : ProfileInfo
    function : callable
    """

    info: ProfileInfo
    function: Callable[..., Trajectory]

    @property
    def options(self) -> tuple[str, ...]:
        """What it takes beside points, times and joint names."""
        return tuple(self.defaults)

    @property
    def defaults(self) -> dict[str, Any]:
        """The options with their defaults; `inspect.Parameter.empty` for one that must be given."""
        parameters = signature(self.function).parameters
        return {name: parameter.default for name, parameter in parameters.items() if name not in _GIVEN}

    def takes_times(self, options: Mapping[str, Any]) -> bool:
        """Whether it is made for given times; with a limit of velocity instead, or none of them, it finds its own."""
        parameters = signature(self.function).parameters
        return "times" in parameters or ("durations" in parameters and "max_velocity" not in options)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Registry:
    """All profiles.

    Attributes
    ----------
    families : tuple of Family
        From the least to the most continuous.
    aliases : mapping
        Second names, and the first ones they stand for.
    """

    families: tuple[Family, ...]
    aliases: Mapping[str, str] = field(default_factory=dict)

    def available(self) -> tuple[ProfileInfo, ...]:
        """All profiles, from the least to the most continuous.

        Stated for default arguments; via velocities that are given make a profile pass the vias instead of
        stopping, and may make it overshoot.

        Returns
        -------
        tuple of ProfileInfo

        Examples
        --------
        >>> from puma_septic import profiles
        >>> [info.name for info in profiles.available() if info.at_vias == "passes" and info.continuity == "C3"]
        ['septic_spline', 'bspline']
        """
        return tuple(family.info for family in self.families)

    def names(self) -> tuple[str, ...]:
        """Every name that a profile answers to."""
        return (*(family.info.name for family in self.families), *self.aliases)

    def family(self, name: str) -> Family:
        """The profile of this name.

        Returns
        -------
        Family

        Raises
        ------
        InputError
            For an unknown name; the message lists the valid ones.
        """
        first = self.aliases.get(checked_choice("profile", name, self.names()), name)
        return next(family for family in self.families if family.info.name == first)

    def make(
        self,
        name: str,
        points: ArrayLike,
        times: ArrayLike,
        *,
        limits: Mapping[str, ArrayLike] | None = None,
        options: Mapping[str, Any] | None = None,
        joint_names: Sequence[str] | None = None,
    ) -> Trajectory:
        """A trajectory of the named profile, which is given what its signature takes.

        Parameters
        ----------
        name : str
        points : array_like, shape (k, n_joints)
            rad (m for prismatic joints).
        times : array_like, shape (k,)
            Strictly increasing, s. A profile that takes durations is given their differences, one that finds its own
            times is not given them.
        limits : mapping, optional
            ``max_velocity``, ``max_acceleration`` and ``max_jerk`` for a profile that finds its own times from them,
            where `options` do not say otherwise.
        options : mapping, optional
            Its further arguments by name.
        joint_names : sequence of str, optional

        Returns
        -------
        Trajectory

        Raises
        ------
        InputError
            For an unknown name or option, and what the profile itself refuses.

        Examples
        --------
        >>> from puma_septic import profiles
        >>> move = profiles.make("lspb", [[0.0], [1.0]], [0.0, 2.0], options={"blend_time": 0.5})
        >>> float(move.duration)
        2.0
        """
        family = self.family(name)
        options = {} if options is None else dict(checked_kind("options", options, Mapping))
        unknown = [key for key in options if key not in family.options]
        if unknown:
            valid = ", ".join(family.options) or "none"
            raise InputError(f"unknown option {unknown[0]!r} of profile {name!r}; valid: {valid}")
        parameters = signature(family.function).parameters
        given: dict[str, Any] = {}
        if "times" in parameters:
            given["times"] = times
        elif family.takes_times(options):
            given["durations"] = np.diff(checked_times("times", times))
        elif "durations" not in parameters:
            given |= {key: value for key, value in (limits or {}).items() if key in parameters}
        return family.function(points, **(given | options), joint_names=joint_names)
