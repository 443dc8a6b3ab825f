"""Colours, lines and marks of all pictures: one colour a profile and one a cause, in charts, report and replay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, final

__all__ = [
    "HUES",
    "LIMIT",
    "PROFILES",
    "Dot",
    "Fill",
    "Hue",
    "Line",
    "Style",
    "cause_lines",
    "profile_line",
]

Shape = Literal["via", "peak", "up", "down", "dot", "point", "cross"]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Hue:
    """A colour with a name, on light paper and on a dark screen, as ``#rrggbb``."""

    name: str
    light: str
    dark: str


# Okabe and Ito, "Color Universal Design", 2008: told apart by people with any common colour blindness. Their yellow is
# left out, too faint for lines on white. On a dark screen the same hues, lighter.
BLUE: Final = Hue(name="blue", light="#0072b2", dark="#3fa7e6")
VERMILION: Final = Hue(name="vermilion", light="#d55e00", dark="#f58a45")
GREEN: Final = Hue(name="green", light="#009e73", dark="#2cc79c")
PURPLE: Final = Hue(name="purple", light="#cc79a7", dark="#e6a3c8")
ORANGE: Final = Hue(name="orange", light="#e69f00", dark="#f5c04f")
SKY: Final = Hue(name="sky", light="#56b4e9", dark="#a5d8f7")
GREY: Final = Hue(name="grey", light="#7f7f7f", dark="#a5a5a5")
OLIVE: Final = Hue(name="olive", light="#b8a000", dark="#d8c33c")
# What is not the subject; and what is neither profile nor cause: limits, totals, outlines.
FAINT: Final = Hue(name="faint", light="#b8b8b8", dark="#5c656f")
INK: Final = Hue(name="ink", light="#1c2128", dark="#e8ebef")
HUES: Final = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, GREY, OLIVE, FAINT, INK)

# Six colours and five dashes make thirty different lines; dashes tell profiles apart in print. Lengths in pixels.
PROFILES: Final = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
DASHES: Final = ((), (7.0, 2.5), (2.4, 2.0), (8.0, 2.5, 2.5, 2.5), (4.0, 2.0, 2.0, 2.0, 2.0, 2.0))
# Of the terms of the torque, and of those that a sizing takes together ("motion", "friction").
_CAUSES: Final = {
    "inertia": BLUE,
    "motion": BLUE,
    "coriolis": SKY,
    "gravity": GREEN,
    "gears": ORANGE,
    "rotor": PURPLE,
    "viscous": ORANGE,
    "coulomb": VERMILION,
    "friction": VERMILION,
    "payload": GREY,
    "wrench": OLIVE,
}


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """How a curve is drawn: dashes as lengths of stroke and gap, and the width, in pixels."""

    hue: Hue
    dash: tuple[float, ...] = ()
    width: float = 1.7


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Dot:
    """How a point is drawn; "up" and "down" are arrowheads at the edge of the panel."""

    shape: Shape
    hue: Hue = INK


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Fill:
    """How a bar is filled."""

    hue: Hue
    is_hatched: bool = False


Style = Line | Dot | Fill
LIMIT: Final = Line(hue=INK, dash=(5.0, 3.0), width=1.2)
DOTTED: Final = Line(hue=INK, dash=(1.3, 1.9), width=1.2)


def profile_line(k: int) -> Line:
    """The line of the k-th profile.

    Examples
    --------
    >>> profile_line(0).hue.name, profile_line(7).hue.name, profile_line(1).dash
    ('blue', 'vermilion', (7.0, 2.5))
    """
    return Line(hue=PROFILES[k % len(PROFILES)], dash=DASHES[k % len(DASHES)])


def cause_lines(causes: Sequence[str]) -> dict[str, Line]:
    """A line for each cause of torque; those without a colour of their own take the profiles' colours, dashed.

    Examples
    --------
    >>> lines = cause_lines(["gravity", "stribeck"])
    >>> lines["gravity"].hue.name, lines["gravity"].dash
    ('green', ())
    >>> lines["stribeck"].hue.name, lines["stribeck"].dash
    ('blue', (7.0, 2.5))
    """
    others = [name for name in causes if name not in _CAUSES]
    lines = {name: Line(hue=_CAUSES[name]) for name in causes if name in _CAUSES}
    dashes = DASHES[1:]
    for k, name in enumerate(others):
        lines[name] = Line(hue=PROFILES[k % len(PROFILES)], dash=dashes[k // len(PROFILES) % len(dashes)])
    return {name: lines[name] for name in causes}
