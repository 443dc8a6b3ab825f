"""Which elements, attributes and numbers a URDF may hold; what Pinocchio would silently drop is found."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from typing import Final

import numpy as np

from puma_septic.robot._urdf_text import Finding, UrdfText
from puma_septic.validation import Array

__all__ = ["as_checked", "check_schema", "summarised", "tensor", "vector"]

# Attributes of each element and how many numbers each holds (0: text): the URDF specification up to version 1.2
# (wiki.ros.org/urdf/XML; ros/urdfdom #212, #235, #238) and, last in a row, what public robots add to it (panda: D, K,
# mu_*; pr2: type ...; RaiSim: rotor_inertia).
ATTRIBUTES: Final[Mapping[str, Mapping[str, int]]] = {
    "robot": {"name": 0, "version": 0},
    "link": {"name": 0, "type": 0},
    "joint": {"name": 0, "type": 0, "dont_collapse": 0},
    "inertial": {},
    "origin": {"xyz": 3, "rpy": 3, "quat_xyzw": 4},
    "mass": {"value": 1},
    "inertia": dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz", "iyx", "izx", "izy"), 1),
    "parent": {"link": 0},
    "child": {"link": 0},
    "axis": {"xyz": 3, "rpy": 3},
    "limit": dict.fromkeys(
        ("lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk", "command_effort", "current",
         "gear_velocity"), 1
    ),
    "dynamics": dict.fromkeys(
        ("damping", "friction", "rotor_inertia", "armature", "D", "K", "mu_coulomb", "mu_viscous"), 1
    ),
    "mimic": {"joint": 0, "multiplier": 1, "offset": 1},
    "safety_controller": {"soft_lower_limit": 1, "soft_upper_limit": 1, "k_position": 1, "k_velocity": 1},
    "calibration": {"rising": 1, "falling": 1, "reference_position": 1},
    "visual": {"name": 0},
    "collision": {"name": 0},
    "geometry": {"name": 0},
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "mesh": {"filename": 0, "scale": 3},
    "material": {"name": 0},
    "color": {"rgba": 4},
    "texture": {"filename": 0},
}  # fmt: skip
REQUIRED_ATTRIBUTES: Final[Mapping[str, tuple[str, ...]]] = {
    "link": ("name",),
    "joint": ("name", "type"),
    "mass": ("value",),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "parent": ("link",),
    "child": ("link",),
    "axis": ("xyz",),
    "mimic": ("joint",),
    "material": ("name",),
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "sphere": ("radius",),
    "mesh": ("filename",),
    "color": ("rgba",),
}
SHAPES: Final = ("box", "cylinder", "sphere", "mesh")
# Elements below each element and how many of each there may be (0: any number).
CHILDREN: Final[Mapping[str, Mapping[str, int]]] = {
    "robot": {"link": 0, "joint": 0, "material": 0},
    "link": {"inertial": 1, "visual": 0, "collision": 0},
    "inertial": {"origin": 1, "mass": 1, "inertia": 1},
    "visual": {"origin": 1, "geometry": 1, "material": 1},
    "collision": {"origin": 1, "geometry": 1},
    "geometry": dict.fromkeys((*SHAPES, "capsule"), 1),
    "material": {"color": 1, "texture": 1},
    "joint": dict.fromkeys(
        ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "safety_controller", "calibration"), 1
    ),
}
REQUIRED_CHILDREN: Final[Mapping[str, tuple[str, ...]]] = {
    "inertial": ("mass", "inertia"),
    "visual": ("geometry",),
    "collision": ("geometry",),
    "joint": ("parent", "child"),
}
# What can be left out where something in it is wrong, and what is then not known.
PARTS: Final[Mapping[str, str]] = {
    "inertial": "this inertia is not used",
    "visual": "this shape is left out",
    "collision": "this shape is left out",
    "material": "this material is left out",
    "limit": "this limit is unknown",
    "dynamics": "this value is unknown",
    "safety_controller": "not used",
    "calibration": "not used",
}
# Of these parts the faulty attribute alone is left out.
BY_ATTRIBUTE: Final = ("limit", "dynamics", "safety_controller", "calibration")
# Neither float() nor the C library's strtod: those take 1_000, nan, inf, 0x10 or Arabic digits.
NUMBER: Final = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
VERSIONS: Final = ("1", "1.0", "1.1", "1.2")
MAX_NAME: Final = 200
# A vendor's attribute in a namespace of its own that means what the format's own one means (drake:acceleration).
NAMESPACED: Final = ("acceleration", "deceleration", "jerk")
EXPAND: Final = (
    "expand it first: ros2 run xacro xacro FILE > arm.urdf, or without ROS: pip install xacrodoc, then xacrodoc FILE -o"
    " arm.urdf"
)
# Elements that no number rests on: whatever is misspelt in them is left out and noted.
_NEEDED_BY_NONE: Final = ("safety_controller", "calibration")
SYMMETRIC: Final = {"iyx": "ixy", "izx": "ixz", "izy": "iyz"}


def check_schema(text: UrdfText) -> dict[ET.Element, list[Finding]]:
    """Everything that is odd or wrong in the form of the file, by the root's children; the root's own first."""
    root = text.root
    if root.tag != "robot":
        hint = "this is an SDF file, not a URDF" if root.tag == "sdf" else "the root of a URDF is <robot>"
        return {root: [text.fault(root, hint)]}
    own = [*_attributes(text, root, None)]
    if "name" not in root.attrib and not _is_misspelt(root, "name"):
        root.set("name", text.path.stem)
        own.append(Finding(text=text.at(root, f"attribute 'name' is missing; called {text.path.stem!r}"), kind="note"))
    if root.get("version", "1.0") not in VERSIONS:
        own.append(text.fault(root, f"version={root.get('version')!r} is not supported; valid: {', '.join(VERSIONS)}"))
    known = CHILDREN["robot"]
    own += [_unknown_element(text, child, known) for child in root if child.tag not in known]
    return {root: own, **{child: list(_element(text, child, None)) for child in root if child.tag in known}}


def summarised(findings: Iterable[Finding]) -> list[Finding]:
    """All findings, each once: what means nothing here in one note for elements and attributes, xacro's first alone."""
    found = list(findings)
    ignored = {
        kind: list(dict.fromkeys(one.attribute for one in found if one.kind == "ignored" and one.text == kind))
        for kind in ("elements", "attributes")
    }
    notes = [
        Finding(text=f"URDF {kind} not used: {', '.join(names)}", kind="note")
        for kind, names in ignored.items()
        if names
    ]
    xacro = [one for one in found if one.kind == "refusal" and EXPAND in one.text]
    kept = [one for one in found if one.kind != "ignored" and one not in xacro[1:]]
    return [*kept, *notes]


def vector(element: ET.Element | None, name: str, default: tuple[float, ...]) -> Array:
    """Numbers of an attribute that `check_schema` has passed; the default where it is absent."""
    text = None if element is None else element.get(name)
    return np.array(default if text is None else [float(word) for word in text.split()])


def tensor(element: ET.Element) -> Array:
    """The symmetric matrix of an <inertia> that `check_schema` has passed."""
    xx, xy, xz, yy, yz, zz = (vector(element, key, (0.0,))[0] for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def as_checked(element: ET.Element) -> ET.Element:
    """A copy of an element that `check_schema` has passed, with its numbers as they have been read.

    Pinocchio's reader knows other blanks and other numbers: one blank behind a number made all of an inertia zero.
    """
    counts = ATTRIBUTES.get(element.tag, {})
    attributes = {
        name: " ".join(map(repr, vector(element, name, ()).tolist())) if counts.get(name) else value
        for name, value in element.attrib.items()
    }
    copy = ET.Element(element.tag, attributes)
    copy.extend(map(as_checked, element))
    return copy


def _element(text: UrdfText, element: ET.Element, part: ET.Element | None) -> Iterator[Finding]:
    """An element and all known ones below it; `part` is what can be left out with it."""
    part = element if element.tag in PARTS and part is None else part
    yield from _attributes(text, element, part)
    yield from _counts(text, element, part)
    known = CHILDREN.get(element.tag, {})
    for child in list(element):
        if child.tag in known:
            yield from _element(text, child, part)
        else:
            yield _unknown_element(text, child, known)


def _wrong(text: UrdfText, element: ET.Element, message: str, part: ET.Element | None, attribute: str = "") -> Finding:
    """A fault, and what it costs where its part can be left out."""
    if part is None:
        return text.fault(element, message)
    name = attribute if part.tag in BY_ATTRIBUTE else ""
    return Finding(text=text.at(element, f"{message}; {PARTS[part.tag]}"), part=part, attribute=name)


def _attributes(text: UrdfText, element: ET.Element, part: ET.Element | None) -> Iterator[Finding]:
    known = ATTRIBUTES[element.tag]
    for name, value in list(element.attrib.items()):
        if "${" in value or "$(" in value:
            yield Finding(text=text.at(element, f"{name}={value!r} is a xacro expression; {EXPAND}"), kind="refusal")
        elif name not in known:
            yield from _unknown_attribute(text, element, name)
        elif known[name] and (why := _no_numbers(known[name], value)):
            yield _wrong(text, element, f"{name}={value!r}: {why}", part, name)
    for name in REQUIRED_ATTRIBUTES.get(element.tag, ()):
        if name not in element.attrib and not _is_misspelt(element, name):
            yield _wrong(text, element, f"attribute {name!r} is missing", part)
    yield from _asymmetric(text, element, part)
    if element.tag in ("robot", "link", "joint") and (why := _no_name(element)):
        yield text.fault(element, why)


def _asymmetric(text: UrdfText, element: ET.Element, part: ET.Element | None) -> Iterator[Finding]:
    """The lower triangle of a tensor that is written in full must be the upper one's."""
    if element.tag != "inertia":
        return
    for lower, upper in SYMMETRIC.items():
        if lower in element.attrib and upper not in element.attrib:
            yield Finding(
                text=text.at(element, f"unknown attribute {lower!r}; did you mean {upper!r}?"), kind="refusal"
            )
        elif lower in element.attrib and not _is_same_number(element.attrib[lower], element.attrib[upper]):
            message = f"{lower}={element.get(lower)!r} is not {upper}={element.get(upper)!r}; a tensor is symmetric"
            yield _wrong(text, element, message, part)


def _unknown_attribute(text: UrdfText, element: ET.Element, name: str) -> Iterator[Finding]:
    """Refused where it may be a misspelt one that is not there; else not used."""
    if name.startswith("xmlns"):
        return
    known = ATTRIBUTES[element.tag]
    local = name.rpartition(":")[2]
    if local != name and element.tag == "limit" and local in NAMESPACED and local not in element.attrib:
        element.set(local, element.attrib.pop(name))
        if why := _no_numbers(1, element.attrib[local]):
            yield _wrong(text, element, f"{name}={element.get(local)!r}: {why}", element, local)
        yield Finding(text=text.at(element, f"{name} is used as {local}"), kind="note")
        return
    meant = [one for one in known if one not in element.attrib and _resembles(name, one)]
    if meant and element.tag not in _NEEDED_BY_NONE:
        valid = f"valid: {', '.join(known)}"
        message = f"unknown attribute {name}={element.get(name)!r}; {valid}; did you mean {meant[0]!r}?"
        yield Finding(text=text.at(element, message), kind="refusal")
    else:
        yield Finding(text="attributes", kind="ignored", attribute=f"<{element.tag} {name}>")


def _is_misspelt(element: ET.Element, name: str) -> bool:
    """Whether an attribute that is missing stands there misspelt, which is told already."""
    return any(other not in ATTRIBUTES[element.tag] and _resembles(other, name) for other in element.attrib)


def _resembles(name: str, known: str) -> bool:
    """Whether a word may be a known one, misspelt: close to it, or its letters in another order."""
    small = name.lower()
    return small == known.lower() or sorted(small) == sorted(known) or bool(get_close_matches(small, [known], 1, 0.75))


def _unknown_element(text: UrdfText, element: ET.Element, known: Mapping[str, int]) -> Finding:
    """An unknown element is not used, unless it looks like a misspelt known one or is xacro's."""
    if element.tag.startswith("xacro:"):
        leftover = element.tag == "xacro:property" and not any("${" in value for value in element.attrib.values())
        if not leftover:
            return Finding(text=text.at(element, f"this is a xacro source; {EXPAND}"), kind="refusal")
    meant = [tag for tag in known if _resembles(element.tag, tag)]
    if meant:
        return Finding(text=text.at(element, f"unknown element; did you mean <{meant[0]}>?"), kind="refusal")
    return Finding(text="elements", kind="ignored", attribute=f"<{element.tag}>")


def _counts(text: UrdfText, element: ET.Element, part: ET.Element | None) -> Iterator[Finding]:
    known = CHILDREN.get(element.tag, {})
    for tag, most in known.items():
        found = element.findall(tag)
        if most and len(found) > most:
            lines = f"lines {text.line(found[0])} and {text.line(found[1])}"
            message = f"<{element.tag}> has <{tag}> twice ({lines}); which one holds is not defined"
            # Of two inertias neither is trusted; of two materials the first is as good as the other.
            doubted: Sequence[ET.Element | None] = {"inertial": found, "material": found[1:]}.get(tag, [])
            yield from (_wrong(text, found[1], message, one) for one in doubted or [part])
    tags = [child.tag for child in element]
    for tag in REQUIRED_CHILDREN.get(element.tag, ()):
        if tag not in tags and not any(one not in known and _resembles(one, tag) for one in tags):
            yield _wrong(text, element, f"<{tag}> is missing", part)
    if element.tag == "geometry":
        yield from _shapes(text, element, part)


def _shapes(text: UrdfText, element: ET.Element, part: ET.Element | None) -> Iterator[Finding]:
    count = sum(child.tag in SHAPES for child in element)
    if count == 0 and element.find("capsule") is not None:
        yield _wrong(text, element, "a <capsule> cannot be drawn", part)
    elif count != 1:
        yield _wrong(text, element, f"expected exactly one of {', '.join(f'<{shape}>' for shape in SHAPES)}", part)


def _no_numbers(count: int, value: str) -> str:
    """Why a value is not the expected count of finite numbers; "" where it is."""
    words = value.split()
    if len(words) != count:
        return f"expected {'one number' if count == 1 else f'{count} numbers with spaces between'}"
    for word in words:
        if not NUMBER.fullmatch(word) or not math.isfinite(float(word)):
            return f"{word!r} is not a finite number such as 0.5 or 1e-3"
    return ""


def _is_same_number(one: str, other: str) -> bool:
    """Whether two texts are one number, -0 being 0; what is no number is told elsewhere."""
    return bool(_no_numbers(1, one) or _no_numbers(1, other)) or float(one) == float(other)


def _no_name(element: ET.Element) -> str:
    """Why a name is no name; "" where it is one."""
    name = element.get("name")
    if name is None:
        return ""  # told as missing
    if not name.strip():
        return "name is empty"
    if len(name) > MAX_NAME or not name.isprintable():
        return f"name must have at most {MAX_NAME} printable characters"
    if name == "universe" and element.tag != "robot":
        return "the name 'universe' is Pinocchio's name of the world; choose another"
    return ""
