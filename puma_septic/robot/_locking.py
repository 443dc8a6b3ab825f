"""Joints that are fixed when a robot is loaded: the named ones, those that follow them, and all that carry no tool."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np
import pinocchio as pin

from puma_septic.errors import InputError
from puma_septic.robot._urdf_checks import Urdf
from puma_septic.robot._urdf_drives import position_range
from puma_septic.robot._urdf_schema import vector
from puma_septic.validation import Array, checked_choice, checked_kind, checked_number

__all__ = [
    "OTHERS",
    "Locks",
    "check_followers",
    "check_moving",
    "named_locks",
    "set_origin",
    "with_locks",
    "without_others",
]

OTHERS: Final = "others"
"""What is written for all joints that do not carry the tool."""

MAX_MOVING: Final = 64  # measured with pin 4.1.0: the data of 300 joints takes 1.9 GB
# A locked follower may stand this far from where its master puts it, rad or m: digits that were rounded.
_SAME: Final = 1e-6

Locks = Mapping[str, float | None] | str | None


def named_locks(locked: Locks) -> tuple[dict[str, float], bool]:
    """Positions of the joints that are locked by name, and whether the others are locked that do not carry the tool.

    Raises
    ------
    InputError
        For a position that is no number, or a text other than "others".
    """
    if isinstance(locked, str):
        checked_choice("text for locked", locked, [OTHERS])
        return {}, True
    given = {} if locked is None else dict(checked_kind("locked", locked, Mapping))
    others = OTHERS in given and given.pop(OTHERS) is None
    return {name: checked_number(f"locked[{name!r}]", x) for name, x in given.items()}, others


def with_locks(urdf: Urdf, positions: Mapping[str, float]) -> Urdf:
    """The robot with these joints fixed, and with them all joints that follow them or a fixed one.

    Raises
    ------
    InputError
        For a joint that does not move, or a position outside its limits.
    """
    movable = [name for name, joint in urdf.joints.items() if joint.kind != "fixed"]
    for name, position in positions.items():
        checked_choice("joint to lock", name, movable)
        _check_within(urdf.joints[name].element, name, position)
    places = dict(positions)
    for name, mimic in urdf.mimics.items():
        if name not in places and mimic.master in positions:
            places[name] = mimic.multiplier * positions[mimic.master] + mimic.offset
        elif name not in places and urdf.joints[mimic.master].kind == "fixed":
            places[name] = mimic.offset
    for name, position in places.items():
        _fix(urdf.joints[name].element, position)
    joints = {name: replace(one, kind="fixed") if name in places else one for name, one in urdf.joints.items()}
    return replace(urdf, joints=joints, mimics={name: one for name, one in urdf.mimics.items() if name not in places})


def check_followers(urdf: Urdf, positions: Mapping[str, float], tool: str) -> None:
    """Refuse to lock a joint that follows another one and carries the tool: the tool would be somewhere else.

    Raises
    ------
    InputError
        With the joint to lock instead.
    """
    carriers = urdf.carriers(tool)
    for name, position in positions.items():
        mimic = urdf.mimics.get(name)
        if mimic is None or name not in carriers:
            continue
        if mimic.master not in positions:
            raise InputError(
                f"locked[{name!r}]: it carries the tool {tool!r} and follows {mimic.master!r}, so it cannot stand still"
                f" alone; lock that joint, which fixes both, or neither"
            )
        follows = mimic.multiplier * positions[mimic.master] + mimic.offset
        if abs(position - follows) > _SAME:
            raise InputError(
                f"locked[{name!r}] = {position:g}: it carries the tool {tool!r} and follows {mimic.master!r}, which"
                f" puts it at {follows:g}"
            )


def without_others(urdf: Urdf, tool: str) -> tuple[Urdf, tuple[str, ...]]:
    """The robot with every joint fixed that does not carry the tool, at zero or the limit nearest to it, and a note.

    A lever that follows a joint of the arm moves on.
    """
    carriers = urdf.carriers(tool)
    driving = {*carriers, *(urdf.mimics[name].master for name in carriers if name in urdf.mimics)}
    places = {}
    for name in urdf.moving:
        if name not in driving:
            low, high = np.nan_to_num(position_range(urdf.joints[name].element), nan=0.0)
            places[name] = float(np.clip(0.0, low, high))
    if not places:
        return urdf, ()
    told = ", ".join(f"{name} at {position:g}" for name, position in places.items())
    return with_locks(urdf, places), (f"locked, as they do not carry the tool {tool!r}: {told}",)


def check_moving(urdf: Urdf) -> None:
    """Raise a ModelError unless a sensible number of joints moves."""
    count = len(urdf.moving)
    if not count:
        raise urdf.text.complaint("no joint moves (all are fixed or locked): there is nothing to assess")
    if count > MAX_MOVING:
        raise urdf.text.complaint(f"{count} moving joints; at most {MAX_MOVING} are allowed")


def set_origin(element: ET.Element, **values: Array) -> None:
    """Write where a joint or an inertia is."""
    origin = element.find("origin")
    if origin is None:
        origin = ET.SubElement(element, "origin")
    for name, value in values.items():
        origin.set(name, " ".join(repr(float(x)) for x in value))


def _check_within(element: ET.Element, name: str, position: float) -> None:
    lower, upper = position_range(element)
    if not lower > upper and (position < lower or position > upper):
        raise InputError(f"locked[{name!r}] = {position:g} is outside the joint's limits [{lower:g}, {upper:g}]")


def _fix(element: ET.Element, position: float) -> None:
    """Put a joint's position into its origin."""
    axis = vector(element.find("axis"), "xyz", (1.0, 0.0, 0.0))
    axis = axis / np.linalg.norm(axis)
    origin = element.find("origin")
    rotation = pin.rpy.rpyToMatrix(vector(origin, "rpy", (0.0, 0.0, 0.0)))
    translation = vector(origin, "xyz", (0.0, 0.0, 0.0))
    if element.get("type") == "prismatic":
        translation = translation + rotation @ axis * position
    else:
        rotation = rotation @ pin.AngleAxis(position, axis).matrix()
    set_origin(element, xyz=translation, rpy=pin.rpy.matrixToRpy(rotation))
