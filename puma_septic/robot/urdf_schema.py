"""Which elements, attributes and numbers a URDF may hold; what Pinocchio would silently drop is refused."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from difflib import get_close_matches

import numpy as np

from puma_septic.robot.urdf_text import UrdfText
from puma_septic.validation import Array

__all__ = ["check_schema", "vector"]

# Attributes of each element and how many numbers each holds (0: text): the URDF specification
# (wiki.ros.org/urdf/XML) and, last in a row, what public robots add to it (panda: D, K, mu_*; pr2: type ...).
ATTRIBUTES: Mapping[str, Mapping[str, int]] = {
    "robot": {"name": 0, "version": 0},
    "link": {"name": 0, "type": 0},
    "joint": {"name": 0, "type": 0, "dont_collapse": 0},
    "inertial": {},
    "origin": {"xyz": 3, "rpy": 3},
    "mass": {"value": 1},
    "inertia": {"ixx": 1, "ixy": 1, "ixz": 1, "iyy": 1, "iyz": 1, "izz": 1},
    "parent": {"link": 0},
    "child": {"link": 0},
    "axis": {"xyz": 3},
    "limit": dict.fromkeys(("lower", "upper", "effort", "velocity", "command_effort", "current", "gear_velocity"), 1),
    "dynamics": {"damping": 1, "friction": 1, "D": 1, "K": 1, "mu_coulomb": 1, "mu_viscous": 1},
    "mimic": {"joint": 0, "multiplier": 1, "offset": 1},
    "safety_controller": {"soft_lower_limit": 1, "soft_upper_limit": 1, "k_position": 1, "k_velocity": 1},
    "calibration": {"rising": 1, "falling": 1, "reference_position": 1},
    "visual": {"name": 0},
    "collision": {"name": 0},
    "geometry": {"name": 0},
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "mesh": {"filename": 0, "scale": 3},
    "material": {"name": 0},
    "color": {"rgba": 4},
    "texture": {"filename": 0},
}
REQUIRED_ATTRIBUTES: Mapping[str, tuple[str, ...]] = {
    "robot": ("name",),
    "link": ("name",),
    "joint": ("name", "type"),
    "mass": ("value",),
    "inertia": tuple(ATTRIBUTES["inertia"]),
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
SHAPES = ("box", "cylinder", "sphere", "mesh")
# Elements below each element and how many of each there may be (0: any number).
CHILDREN: Mapping[str, Mapping[str, int]] = {
    "robot": {"link": 0, "joint": 0, "material": 0},
    "link": {"inertial": 1, "visual": 0, "collision": 0},
    "inertial": {"origin": 1, "mass": 1, "inertia": 1},
    "visual": {"origin": 1, "geometry": 1, "material": 1},
    "collision": {"origin": 1, "geometry": 1},
    "geometry": dict.fromkeys(SHAPES, 1),
    "material": {"color": 1, "texture": 1},
    "joint": dict.fromkeys(
        (
            "origin",
            "parent",
            "child",
            "axis",
            "limit",
            "dynamics",
            "mimic",
            "safety_controller",
            "calibration",
        ),
        1,
    ),
}
REQUIRED_CHILDREN: Mapping[str, tuple[str, ...]] = {
    "inertial": ("mass", "inertia"),
    "visual": ("geometry",),
    "collision": ("geometry",),
    "joint": ("parent", "child"),
}
# Neither float() nor the C library's strtod: those take 1_000, nan, inf, 0x10 or Arabic digits.
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
VERSIONS = ("1", "1.0", "1.1", "1.2")
MAX_NAME = 200


def check_schema(text: UrdfText) -> tuple[str, ...]:
    """Check every element that is read, and return what a reader must know: the elements that are not.

    Raises
    ------
    ModelError
        For an unknown, missing or repeated attribute or element and for a value that is no finite number.
    """
    root = text.root
    if root.tag != "robot":
        hint = "this is an SDF file, not a URDF" if root.tag == "sdf" else "the root of a URDF is <robot>"
        raise text.fault(root, hint)
    if root.get("version", "1.0") not in VERSIONS:
        raise text.fault(root, f"version={root.get('version')!r} is not supported; valid: {', '.join(VERSIONS)}")
    ignored = dict.fromkeys(_unknown_elements(text, root))
    return (f"URDF elements not used: {', '.join(f'<{tag}>' for tag in ignored)}",) if ignored else ()


def vector(element: ET.Element | None, name: str, default: tuple[float, ...]) -> Array:
    """Numbers of an attribute that `check_schema` has passed; the default where it is absent."""
    text = None if element is None else element.get(name)
    return np.array(default if text is None else [float(word) for word in text.split()])


def _unknown_elements(text: UrdfText, element: ET.Element) -> Iterator[str]:
    """Check an element and all known ones below it; yield the tags of unknown ones."""
    _check_attributes(text, element)
    _check_counts(text, element)
    known = CHILDREN.get(element.tag, {})
    for child in element:
        if child.tag in known:
            yield from _unknown_elements(text, child)
        else:
            _check_unknown(text, child, known)
            yield child.tag


def _check_attributes(text: UrdfText, element: ET.Element) -> None:
    known = ATTRIBUTES[element.tag]
    for name, value in element.attrib.items():
        if element.tag == "robot" and name.startswith("xmlns"):
            continue
        if name not in known:
            valid = f"valid: {', '.join(known)}" if known else "it has none"
            raise text.fault(element, f"unknown attribute {name}={value!r}; {valid}")
        if "${" in value or "$(" in value:
            raise text.fault(element, f"{name}={value!r} is a xacro expression; run xacro and pass its output")
        if known[name]:
            _check_numbers(text, element, name)
    for name in REQUIRED_ATTRIBUTES.get(element.tag, ()):
        if name not in element.attrib:
            raise text.fault(element, f"attribute {name!r} is missing")
    if element.tag in ("robot", "link", "joint"):
        _check_name(text, element)


def _check_counts(text: UrdfText, element: ET.Element) -> None:
    known = CHILDREN.get(element.tag, {})
    for tag, most in known.items():
        found = element.findall(tag)
        if most and len(found) > most:
            lines = f"lines {text.line(found[0])} and {text.line(found[1])}"
            raise text.fault(found[1], f"<{element.tag}> has <{tag}> twice ({lines}); which one holds is not defined")
    for tag in REQUIRED_CHILDREN.get(element.tag, ()):
        if element.find(tag) is None:
            raise text.fault(element, f"<{tag}> is missing")
    if element.tag == "geometry" and sum(child.tag in SHAPES for child in element) != 1:
        raise text.fault(element, f"expected exactly one of {', '.join(f'<{shape}>' for shape in SHAPES)}")


def _check_unknown(text: UrdfText, element: ET.Element, known: Mapping[str, int]) -> None:
    """An unknown element is ignored, unless it looks like a misspelt known one."""
    if element.tag.startswith("xacro:"):
        raise text.fault(element, "this is a xacro source; run xacro and pass its output")
    meant = [tag for tag in known if tag == element.tag.lower()]
    meant = meant or get_close_matches(element.tag, known, n=1, cutoff=0.8)
    if meant:
        raise text.fault(element, f"unknown element; did you mean <{meant[0]}>?")


def _check_numbers(text: UrdfText, element: ET.Element, name: str) -> None:
    count, value = ATTRIBUTES[element.tag][name], element.get(name, "")
    words = value.split()
    if len(words) != count:
        expected = "one number" if count == 1 else f"{count} numbers with spaces between"
        raise text.fault(element, f"{name}={value!r}: expected {expected}")
    for word in words:
        if not NUMBER.fullmatch(word) or not math.isfinite(float(word)):
            raise text.fault(element, f"{name}={value!r}: {word!r} is not a finite number such as 0.5 or 1e-3")


def _check_name(text: UrdfText, element: ET.Element) -> None:
    name = element.get("name", "")
    if not name.strip():
        raise text.fault(element, "name is empty")
    if len(name) > MAX_NAME or not name.isprintable():
        raise text.fault(element, f"name must have at most {MAX_NAME} printable characters")
    if name == "universe" and element.tag != "robot":
        raise text.fault(element, "the name 'universe' is Pinocchio's name of the world; choose another")
