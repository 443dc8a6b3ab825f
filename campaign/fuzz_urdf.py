"""URDFs: sound arms with changed numbers, words, elements and bytes; what is accepted is held against its text."""

from __future__ import annotations

import xml.etree.ElementTree as ET
import zlib
from copy import deepcopy
from pathlib import Path
from typing import Final

import puma_septic as ps
from campaign.arms import sound_arm
from campaign.mutation import NAMES, Rng, changed_number, chosen, mangled_bytes, misspelt, mutated_text
from campaign.urdf_oracle import check_robot

_TAGS: Final = (
    "link", "joint", "inertial", "origin", "mass", "inertia", "axis", "limit", "dynamics", "mimic", "parent", "child",
    "transmission", "gazebo", "xacro:macro", "visual", "safety_controller", "foo",
)  # fmt: skip
_KINDS: Final = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "screw", "Revolute", "")
# White space that ElementTree writes as a reference, so that it reaches the reader as it is.
_BLANKS: Final = (" ", "  ", "\t", "\n", "\r", "\u00a0", "\u2003", "\u3000", "\x0b", "\x1f")
_HEADS: Final = (
    '<?xml version="1.0" encoding="ISO-8859-1"?>', '<?xml version="1.0" encoding="utf-16"?>', '<?xml version="1.1"?>',
    '<!DOCTYPE robot [<!ENTITY a "1">]>', "<!-- a comment -->", '<?xml version="1.0" encoding="klingon"?>', "\ufeff",
    " ",
)  # fmt: skip


def make(rng: Rng) -> bytes:
    """A mutated arm: most of the time its elements, else its text or its bytes; seldom none."""
    data = sound_arm(rng)
    way = rng.random()
    if way < 0.7:
        return _changed_tree(rng, data)
    if way < 0.85:
        text = data.decode("utf-8")
        return mutated_text(rng, text).encode("utf-8", "surrogatepass")
    if way < 0.98:
        return mangled_bytes(rng, data)
    return rng.bytes(int(rng.integers(0, 200)))


def check(path: Path) -> ps.Robot:
    """Load it, one in eight with its last joint locked, and hold it against its text."""
    data = path.read_bytes()
    robot, held = ps.load_robot(path), {}
    if zlib.crc32(data) % 8 == 0 and robot.n_joints > 1:
        name, (lower, upper) = robot.joint_names[-1], robot.limits.position[-1]
        held = {name: float(0.3 * lower + 0.7 * upper) if upper > lower else 0.1}
        robot = ps.load_robot(path, locked=held)
    check_robot(robot, data, held)
    return robot


def _changed_tree(rng: Rng, data: bytes) -> bytes:
    root = ET.fromstring(data)
    steps = (_number, _number, _number, _number, _blank, _blank, _attribute, _element, _kind, _name, _moved, _dressed)
    for _ in range(int(rng.integers(1, 4))):
        steps[int(rng.integers(len(steps)))](rng, root)
    text = ET.tostring(root, encoding="unicode")
    return (chosen(rng, _HEADS) + text if rng.random() < 0.05 else text).encode("utf-8", "surrogatepass")


def _any(rng: Rng, root: ET.Element, *tags: str) -> ET.Element:
    found = [element for element in root.iter() if element.attrib and (not tags or element.tag in tags)]
    return found[int(rng.integers(len(found)))] if found else root


def _numeric(rng: Rng, root: ET.Element) -> tuple[ET.Element, str]:
    element = _any(rng, root, "origin", "mass", "inertia", "axis", "limit", "dynamics", "mimic", "box", "cylinder")
    return element, chosen(rng, [*element.attrib] or ["value"])


def _number(rng: Rng, root: ET.Element) -> None:
    element, key = _numeric(rng, root)
    words = element.get(key, "0").split() or ["0"]
    k = int(rng.integers(len(words)))
    words[k] = changed_number(rng, words[k])
    if rng.random() < 0.1:
        words.append("1")
    element.set(key, chosen(rng, (" ", " ", " ", "  ", "\t", ",")).join(words))


def _blank(rng: Rng, root: ET.Element) -> None:
    """White space about or between numbers: the words stay what they are."""
    element, key = _numeric(rng, root)
    blank, text = chosen(rng, _BLANKS), element.get(key, "")
    element.set(key, chosen(rng, (text + blank, blank + text, text.replace(" ", blank))))


def _attribute(rng: Rng, root: ET.Element) -> None:
    element = _any(rng, root)
    key = chosen(rng, [*element.attrib] or ["name"])
    value = element.attrib.pop(key, "1")
    if rng.random() < 0.6:
        element.set(
            misspelt(rng, key) if rng.random() < 0.7 else chosen(rng, ("drake:jerk", "foo", "xyz", "iyx")), value
        )


def _element(rng: Rng, root: ET.Element) -> None:
    """One out, twice, misspelt, elsewhere, or a new one."""
    parents = [parent for parent in root.iter() if len(parent)]
    if not parents:
        return
    parent = parents[int(rng.integers(len(parents)))]
    child = parent[int(rng.integers(len(parent)))]
    way = int(rng.integers(5))
    if way == 0:
        parent.remove(child)
    elif way == 1:
        parent.insert(int(rng.integers(len(parent) + 1)), deepcopy(child))
    elif way == 2:
        child.tag = misspelt(rng, child.tag.rpartition("}")[2]) or "x"
    elif way == 3:
        parent.remove(child)
        parents[int(rng.integers(len(parents)))].append(child)
    else:
        parent.append(ET.Element(chosen(rng, _TAGS), {"name": chosen(rng, ("a", "b", "joint0"))}))


def _kind(rng: Rng, root: ET.Element) -> None:
    _any(rng, root, "joint").set("type", chosen(rng, _KINDS))


def _name(rng: Rng, root: ET.Element) -> None:
    element = _any(rng, root, "link", "joint", "parent", "child", "mimic", "robot")
    known = [one.get("name", "") for one in root.iter() if "name" in one.attrib]
    key = chosen(rng, [*element.attrib] or ["name"])
    element.set(key, chosen(rng, NAMES if rng.random() < 0.4 else known or ["x"]))


def _moved(rng: Rng, root: ET.Element) -> None:
    """Another order of the file's parts, which changes nothing."""
    children = list(root)
    for child in children:
        root.remove(child)
    root.extend([children[int(k)] for k in rng.permutation(len(children))])


def _dressed(rng: Rng, root: ET.Element) -> None:
    """What a joint may have beside: friction, rotors, a leader, soft limits."""
    joint = _any(rng, root, "joint")
    names = [one.get("name", "") for one in root.iter("joint")]
    value = repr(float(10.0 ** rng.integers(-3, 3)))
    added = (
        ("dynamics", {"damping": value, "friction": value, "rotor_inertia": value}),
        ("mimic", {"joint": chosen(rng, names or [""])}),
        ("mimic", {"joint": chosen(rng, names or [""]), "multiplier": value, "offset": "-0.2"}),
        ("safety_controller", {"soft_lower_limit": "-1", "soft_upper_limit": value, "k_velocity": "1"}),
        ("calibration", {"rising": value}),
    )[int(rng.integers(5))]  # fmt: skip
    joint.append(ET.Element(*added))
