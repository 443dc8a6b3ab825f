"""A finding: what is odd in a robot's data, where, and which answers rest on it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal, final

__all__ = ["ANSWERS", "CODES", "Finding", "Severity"]

Severity = Literal["impossible", "doubtful", "missing"]

ANSWERS: Final = ("torque", "effort limits", "velocity limits", "position limits", "tool pose", "drives", "drawing")
"""Kinds of answer that a robot's data carry."""

CODES: Final[Mapping[str, tuple[str, str]]] = MappingProxyType(
    {
        "inertia_impossible": ("torque", "principal moments that no body has: negative, or one above the others' sum"),
        "inertia_large": ("torque", "a radius of gyration that the link has no room for"),
        "inertia_small": ("torque", "a mass without an inertia of its size"),
        "inertias_equal": ("torque", "the same inertia tensor on all moving links"),
        "masses_equal": ("torque", "the same mass on all moving links"),
        "mass_outlier": ("torque", "a mass far above or below those of both neighbours"),
        "moving_mass_small": ("torque", "a moving mass that no arm of this reach has"),
        "com_far": ("torque", "a centre of mass far outside the link: millimetres?"),
        "density": ("torque", "a mass that does not go with the volume of the link's mesh"),
        "no_inertia": ("torque", "moving links without mass or inertia"),
        "effort_placeholder": ("effort limits", "a torque limit of exactly 1, or a power of ten from 1000"),
        "effort_equal": ("effort limits", "the same effort limit on all joints, five or more behind each other"),
        "effort_below_weight": ("effort limits", "an effort limit below what holds the arm's own weight"),
        "no_effort": ("effort limits", "joints without an effort limit, or 0"),
        "velocity_placeholder": (
            "velocity limits",
            "a velocity limit of exactly 1 for half of the joints, or a power of ten for all",
        ),
        "velocity_high": ("velocity limits", "a velocity that no drive reaches: degrees per second?"),
        "velocity_low": ("velocity limits", "a velocity limit that is next to standstill"),
        "no_velocity": ("velocity limits", "joints without a velocity limit, or 0"),
        "position_degrees": ("position limits", "position limits beyond two turns: degrees, or a placeholder?"),
        "position_narrow": ("position limits", "a range that is next to nothing"),
        "no_position": ("position limits", "joints that are not continuous, without position limits"),
        "distance_large": ("tool pose", "a distance between joints that stands out: millimetres?"),
        "no_drive": ("drives", "rotor inertia or friction not known"),
        "no_mesh": ("drawing", "meshes that were not found"),
    }
)
"""Each kind of finding: the answer that it touches, and what it means."""


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Finding:
    """One kind of oddity in a robot's data.

    Attributes
    ----------
    code : str
        A key of `CODES`.
    severity : {"impossible", "doubtful", "missing"}
        No body or drive is so; hardly any is; not known, so not assessed.
    parts : tuple of str
        Names of the joints or links concerned.
    message : str
        With the numbers.
    """

    code: str
    severity: Severity
    parts: tuple[str, ...]
    message: str

    @property
    def answer(self) -> str:
        """The kind of answer that rests on it, one of `ANSWERS`."""
        return CODES[self.code][0]
