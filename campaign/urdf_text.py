"""A URDF read a second time, by other means: ElementTree and a grammar of numbers; nothing of the loader is used."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from typing import Final

import numpy as np

MOVING: Final = ("revolute", "continuous", "prismatic")
_PLAIN: Final = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")
_TENSOR: Final = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_LOWER: Final = {"iyx": "ixy", "izx": "ixz", "izy": "iyz"}
# What the documentation of load_robot refuses as no arm's: kg, m.
_HEAVIEST, _FARTHEST = 1e6, 1e3


class UnreadableError(Exception):
    """The text does not say clearly what it means; nothing may be made of it."""


@dataclass(frozen=True)
class Body:
    """What an <inertial> says, in the link's frame. `is_sound` tells a body's numbers from those that none can have."""

    mass: float
    com: np.ndarray
    inertia: np.ndarray
    is_sound: bool


@dataclass(frozen=True)
class Joint:
    name: str
    kind: str
    parent: str
    child: str
    place: np.ndarray  # (4, 4) of the child in the parent, at zero
    axis: np.ndarray
    element: ET.Element
    mimic: tuple[str, float, float] | None


@dataclass(frozen=True)
class Text:
    """Links and joints; of each link its body, a reason (text) why it has none that is usable, or None."""

    bodies: dict[str, Body | str | None]
    joints: dict[str, Joint]
    order: list[str] = field(default_factory=list)  # joints, each after the one that it hangs on

    @property
    def own(self) -> list[str]:
        """Joints with a coordinate of their own."""
        return [name for name, joint in self.joints.items() if joint.kind in MOVING and joint.mimic is None]


def read(data: bytes) -> Text:
    """The arm of a text.

    Raises
    ------
    UnreadableError
        Where a number that positions a body is none, or names do not make one tree.
    xml.etree.ElementTree.ParseError
        Where it is no XML.
    """
    root = ET.fromstring(data)
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2] if root.tag.startswith("{") else element.tag
    if root.tag != "robot":
        raise UnreadableError("no <robot>")
    names = [link.get("name", "") for link in root.findall("link")]
    if len(set(names)) != len(names):
        raise UnreadableError("two links of one name")
    joints = {}
    for element in root.findall("joint"):
        joint = _joint(element)
        if joint.name in joints:
            raise UnreadableError("two joints of one name")
        joints[joint.name] = joint
    joints = {name: _followed(joint, joints) for name, joint in joints.items()}
    bodies = {link.get("name", ""): _body(link) for link in root.findall("link")}
    return Text(bodies, joints, _order(joints, bodies))


def numbers(text: str | None, count: int, default: tuple[float, ...] | None = None) -> np.ndarray:
    """Plain decimal numbers with white space between."""
    if text is None:
        if default is None:
            raise UnreadableError("a number is missing")
        return np.array(default)
    words = text.split()
    if len(words) != count or not all(_PLAIN.fullmatch(word) for word in words):
        raise UnreadableError(f"{text!r} is not {count} numbers")
    values = np.array([float(word) for word in words])
    if not np.isfinite(values).all():
        raise UnreadableError(f"{text!r} overflows")
    return values


def limit(joint: Joint, name: str) -> float:
    """One number of a joint's <limit>, NaN where it is missing or none."""
    element = joint.element.find("limit")
    try:
        return float(numbers(element.get(name) if element is not None else None, 1)[0])
    except UnreadableError:
        return np.nan


def rotation(rpy: np.ndarray) -> np.ndarray:
    """Turns about the fixed axes x, y and z, in this order."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return z @ y @ x


def _only(element: ET.Element, tag: str) -> ET.Element | None:
    found = element.findall(tag)
    if len(found) > 1:
        raise UnreadableError(f"<{tag}> twice")
    return found[0] if found else None


def _place(element: ET.Element) -> np.ndarray:
    origin = _only(element, "origin")
    place = np.eye(4)
    if origin is None:
        return place
    if "quat_xyzw" in origin.attrib:
        x, y, z, w = numbers(origin.get("quat_xyzw"), 4) / np.linalg.norm(numbers(origin.get("quat_xyzw"), 4))
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        place[:3, :3] = np.eye(3) + 2 * w * cross + 2 * cross @ cross
    else:
        place[:3, :3] = rotation(numbers(origin.get("rpy"), 3, (0.0, 0.0, 0.0)))
    place[:3, 3] = numbers(origin.get("xyz"), 3, (0.0, 0.0, 0.0))
    return place


def _joint(element: ET.Element) -> Joint:
    parent, child = _only(element, "parent"), _only(element, "child")
    if parent is None or child is None:
        raise UnreadableError("a joint without its links")
    kind = element.get("type", "")
    if kind not in (*MOVING, "fixed"):
        raise UnreadableError(f"joint type {kind!r}")
    axis = np.array([1.0, 0.0, 0.0])
    if kind != "fixed":
        found = _only(element, "axis")
        axis = numbers(found.get("xyz"), 3) if found is not None else axis
        if not np.linalg.norm(axis) > 0:
            raise UnreadableError("an axis without direction")
        axis = axis / np.linalg.norm(axis)
    mimic = element.find("mimic") if kind != "fixed" else None
    follows = None
    if mimic is not None:
        factor, offset = (numbers(mimic.get(key), 1, (x,))[0] for key, x in (("multiplier", 1.0), ("offset", 0.0)))
        follows = (mimic.get("joint", ""), float(factor), float(offset))
    return Joint(
        name=element.get("name", ""), kind=kind, parent=parent.get("link", ""), child=child.get("link", ""),
        place=_place(element), axis=axis, element=element, mimic=follows,
    )  # fmt: skip


def _followed(joint: Joint, joints: dict[str, Joint]) -> Joint:
    """What it follows in the end, as one factor and one offset; of an unknown joint it follows nothing."""
    factor, offset, name, seen = 1.0, 0.0, joint.name, set()
    while (mimic := joints[name].mimic) is not None and mimic[0] in joints:
        offset += factor * mimic[2]
        factor *= mimic[1]
        name = mimic[0]
        if name in seen:
            raise UnreadableError("joints that follow each other")
        seen.add(name)
    follows = None if name == joint.name else (name, factor, offset)
    return Joint(**{**{key: getattr(joint, key) for key in joint.__dataclass_fields__}, "mimic": follows})


def _body(link: ET.Element) -> Body | str | None:
    if link.find("inertial") is None:
        return None
    try:
        inertial = _only(link, "inertial")
        mass, tensor = _only(inertial, "mass"), _only(inertial, "inertia")
        if mass is None or tensor is None:
            return "no mass or no inertia"
        place = _place(inertial)
        m = float(numbers(mass.get("value"), 1)[0])
        xx, xy, xz, yy, yz, zz = (float(numbers(tensor.get(key), 1)[0]) for key in _TENSOR)
        for lower, upper in _LOWER.items():
            if lower in tensor.attrib and numbers(tensor.get(lower), 1) != numbers(tensor.get(upper), 1):
                return "not symmetric"
    except UnreadableError as error:
        return str(error)
    own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    a, b, c = np.linalg.eigvalsh(own)
    if m < 0 or m > _HEAVIEST or np.abs(place[:3, 3]).max() > _FARTHEST or a < -2e-3 * max(abs(c), 1e-12):
        return "no body's"
    is_sound = (m > 0 or c == 0) and a >= 0 and a + b >= c * (1 - 1e-9) and c <= _HEAVIEST
    return Body(m, place[:3, 3], place[:3, :3] @ own @ place[:3, :3].T, bool(is_sound))


def _order(joints: dict[str, Joint], bodies: dict[str, Body | str | None]) -> list[str]:
    """Joints from the base on; every link but one must hang on one joint."""
    children = [joint.child for joint in joints.values()]
    if any(joint.child not in bodies or joint.parent not in bodies for joint in joints.values()):
        raise UnreadableError("a link that is not there")
    if len(set(children)) != len(children) or len(bodies) != len(joints) + 1:
        raise UnreadableError("not one tree")
    reached, order = set(bodies) - set(children), []
    while left := [name for name, joint in joints.items() if name not in order and joint.parent in reached]:
        order += left
        reached |= {joints[name].child for name in left}
    if len(order) != len(joints):
        raise UnreadableError("not one tree")
    return order
