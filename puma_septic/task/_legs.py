"""The legs of a cycle: what each move is made of, from place to place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, final

import numpy as np

from puma_septic.task._schema import Task
from puma_septic.task._steps import Move
from puma_septic.validation import Array

__all__ = ["Leg", "Place", "legs_of", "places_of", "set_back", "visited"]

_AXES = {"x": 0, "y": 1, "z": 2}


class Place(NamedTuple):
    """A point of the task, or so many metres before it along an axis of the tool."""

    point: str
    before: float = 0.0
    axis: str = "z"

    def __str__(self) -> str:
        return f"{self.before:g} m before {self.point}" if self.before else self.point


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Leg:
    """One motion of a cycle: a move, or the straight stretch that begins or ends one.

    Attributes
    ----------
    step : int
        Index of its step in the file.
    name : str
    kind : {"joint", "line", "arc"}
    places : tuple of Place
        From the first to the last; of an arc with `via` between them.
    move : Move
        With its speeds, profile and so on.
    """

    step: int
    name: str
    kind: str
    places: tuple[Place, ...]
    move: Move


def legs_of(move: Move, step: int, here: Place) -> tuple[Leg, ...]:
    """The legs of a move from where the arm is."""
    axis = move.tool_axis or "z"
    start = here if move.retreat is None else here._replace(before=here.before + move.retreat, axis=axis)
    end = Place(move.targets[-1])
    before = end if move.approach is None else Place(end.point, move.approach, axis)
    between = tuple(Place(name) for name in move.targets[:-1])
    corners = (start, *between, before)
    name = move.name or f"{here} to {end}"

    def leg(name: str, kind: str, *places: Place) -> Leg:
        return Leg(step=step, name=name, kind=kind, places=places, move=move)

    if move.move == "line" and move.zone is not None:
        return (leg(name, "line", *([here] if start != here else []), *corners, *([end] if before != end else [])),)
    legs = [] if start == here else [leg(f"retreat from {here}", "line", here, start)]
    if move.move == "joint":
        legs.append(leg(name, "joint", *corners))
    elif move.move == "arc":
        legs.append(leg(name, "arc", start, Place(str(move.via)), before))
    else:
        pairs = list(pairwise(corners))
        legs += [leg(name if len(pairs) == 1 else f"{a} to {b}", "line", a, b) for a, b in pairs]
    return tuple(legs) if before == end else (*legs, leg(f"approach {end}", "line", before, end))


def places_of(task: Task) -> tuple[tuple[Leg, ...], ...]:
    """The legs of each step; of a step that is no move, none.

    A cycle begins at the first point, and is there again after a way back.
    """
    here = start = Place(str(task.points[0].name))
    found: list[tuple[Leg, ...]] = []
    for k, step in enumerate(task.cycle):
        legs: tuple[Leg, ...] = ()
        if isinstance(step, Move):
            legs = legs_of(step.with_defaults(task.defaults), k, here)
            here = legs[-1].places[-1]
        elif step == "back":
            here = start
        found.append(legs)
    return tuple(found)


def visited(task: Task, legs: Sequence[Sequence[Leg]]) -> tuple[Place, ...]:
    """All places that the arm stops at or passes by joint moves, each once, in order."""

    def every() -> Iterator[Place]:
        yield Place(str(task.points[0].name))
        for one in (leg for step in legs for leg in step):
            yield from one.places if one.kind != "arc" else (one.places[0], one.places[-1])

    return tuple(dict.fromkeys(every()))


def set_back(pose: Array, place: Place) -> Array:
    """The pose of a place, (4, 4), from that of its point."""
    if not place.before:
        return pose
    sign = -1.0 if place.axis.startswith("-") else 1.0
    moved = pose.copy()
    moved[:3, 3] -= sign * place.before * pose[:3, _AXES[place.axis[-1]]]
    return np.asarray(moved)
