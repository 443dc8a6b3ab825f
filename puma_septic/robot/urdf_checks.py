"""The door for URDFs: what is refused before Pinocchio sees it, and what is noted."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Collection
from dataclasses import dataclass
from typing import final

from puma_septic.robot.urdf_text import UrdfText

__all__ = ["Urdf", "UrdfJoint", "checked_urdf"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class UrdfJoint:
    """One joint of a checked URDF; `kind` is "fixed" also where the caller locks it."""

    name: str
    kind: str
    parent: str
    child: str
    element: ET.Element


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Urdf:
    """A checked URDF: links and joints by name, in file order.

    Attributes
    ----------
    name : str
    text : UrdfText
    links : dict of str to Element
    joints : dict of str to UrdfJoint
    moving : tuple of str
        Names of the joints that move: neither fixed nor locked.
    notes : tuple of str
    """

    name: str
    text: UrdfText
    links: dict[str, ET.Element]
    joints: dict[str, UrdfJoint]
    moving: tuple[str, ...]
    notes: tuple[str, ...]


def checked_urdf(text: UrdfText, locked: Collection[str] = ()) -> Urdf:
    links = {e.get("name", ""): e for e in text.root.findall("link")}
    joints = {}
    for e in text.root.findall("joint"):
        name = e.get("name", "")
        kind = "fixed" if name in locked else e.get("type", "")
        joints[name] = UrdfJoint(
            name=name, kind=kind, element=e, parent=e.find("parent").get("link"), child=e.find("child").get("link")
        )
    moving = tuple(name for name, j in joints.items() if j.kind != "fixed")
    return Urdf(name=text.root.get("name"), text=text, links=links, joints=joints, moving=moving, notes=())
