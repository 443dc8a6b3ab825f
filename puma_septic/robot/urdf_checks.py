"""The door for URDFs: what is refused before Pinocchio sees it, and what is noted."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Collection
from dataclasses import dataclass
from typing import final

from puma_septic.errors import ModelError
from puma_septic.robot.urdf_physics import MOVING_KINDS, joint_notes, link_notes
from puma_septic.robot.urdf_schema import check_schema
from puma_septic.robot.urdf_text import UrdfText
from puma_septic.validation import checked_choice

__all__ = ["Urdf", "UrdfJoint", "checked_urdf"]

# Measured with pin 4.1.0: a chain of about 3,700 joints crashes the process, a star of 10,000 links takes
# 8 GB and 23 s, and the data of 300 joints 1.9 GB. The caps are far above any arm.
MAX_DEPTH = 100
MAX_LINKS = 200
MAX_MOVING = 64


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

    def xml(self, link_parts: Collection[str]) -> str:
        """Text for Pinocchio: joints, and these parts of the links; nothing that was not checked."""
        tree = ET.Element("robot", name=self.name)
        tree.extend(self.text.root.findall("material"))
        for name, link in self.links.items():
            ET.SubElement(tree, "link", name=name).extend(part for part in link if part.tag in link_parts)
        for joint in self.joints.values():
            element = ET.SubElement(tree, "joint", name=joint.name, type=joint.kind)
            element.extend(part for part in joint.element if part.tag in ("origin", "parent", "child", "axis", "limit"))
        return ET.tostring(tree, encoding="unicode")


def checked_urdf(text: UrdfText, locked: Collection[str] = ()) -> Urdf:
    """Check a parsed URDF; joints named in `locked` count as fixed.

    Raises
    ------
    InputError
        For a locked joint that does not exist, with the valid names.
    ModelError
        For anything that Pinocchio would refuse, drop, take for zero or crash on.
    """
    schema_notes = check_schema(text)
    links = _by_name(text, "link")
    elements = _by_name(text, "joint")
    notes = [*schema_notes]
    for link in links.values():
        notes.extend(link_notes(text, link))
    for element in elements.values():
        notes.extend(joint_notes(text, element))
    _by_name(text, "material")
    movable = [name for name, joint in elements.items() if joint.get("type") in MOVING_KINDS]
    for name in locked:
        checked_choice("joint to lock", name, movable)
    joints = {name: _joint(name, element, name in locked) for name, element in elements.items()}
    moving = tuple(name for name, joint in joints.items() if joint.kind != "fixed")
    urdf = Urdf(
        name=text.root.get("name", ""),
        text=text,
        links=links,
        joints=joints,
        moving=moving,
        notes=tuple(notes),
    )
    _check_sizes(urdf)
    _check_mimic(urdf)
    _check_tree(urdf)
    return urdf


def _by_name(text: UrdfText, tag: str) -> dict[str, ET.Element]:
    result: dict[str, ET.Element] = {}
    for element in text.root.findall(tag):
        name = element.get("name", "")
        if name in result:
            raise text.fault(element, f"this name is already taken by the {tag} in line {text.line(result[name])}")
        result[name] = element
    return result


def _joint(name: str, element: ET.Element, is_locked: bool) -> UrdfJoint:
    parent, child = element.find("parent"), element.find("child")
    assert parent is not None  # the schema requires both
    assert child is not None
    return UrdfJoint(
        name=name,
        kind="fixed" if is_locked else element.get("type", ""),
        parent=parent.get("link", ""),
        child=child.get("link", ""),
        element=element,
    )


def _check_sizes(urdf: Urdf) -> None:
    path = urdf.text.path
    if not urdf.links:
        raise ModelError(f"{path}: no <link> in this URDF")
    if not urdf.moving:
        raise ModelError(f"{path}: no joint moves (all are fixed or locked): there is nothing to assess")
    if len(urdf.links) > MAX_LINKS:
        raise ModelError(f"{path}: {len(urdf.links)} links; at most {MAX_LINKS} are allowed")
    if len(urdf.moving) > MAX_MOVING:
        raise ModelError(f"{path}: {len(urdf.moving)} moving joints; at most {MAX_MOVING} are allowed")


def _check_mimic(urdf: Urdf) -> None:
    """Pinocchio would take a joint that mimics another for an independent one."""
    for joint in urdf.joints.values():
        mimic = joint.element.find("mimic")
        if joint.kind != "fixed" and mimic is not None:
            raise urdf.text.fault(
                mimic,
                f"a joint that mimics {mimic.get('joint')!r} has no motor of its own and is not supported;"
                f" lock both, locked={{{joint.name!r}: ..., {mimic.get('joint')!r}: ...}}",
            )


def _check_tree(urdf: Urdf) -> None:
    """Each link must hang on exactly one joint, but for one root from which all are reached."""
    above: dict[str, UrdfJoint] = {}
    for joint in urdf.joints.values():
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in urdf.links:
                raise urdf.text.fault(joint.element, f"its {role} link {link!r} is not defined")
        if joint.child in above:
            other = above[joint.child]
            raise urdf.text.fault(
                joint.element,
                f"link {joint.child!r} is already the child of joint {other.name!r} in line"
                f" {urdf.text.line(other.element)}; closed loops are not supported",
            )
        above[joint.child] = joint
    roots = [link for link in urdf.links if link not in above]
    if len(roots) > 1:
        raise ModelError(
            f"{urdf.text.path}: {len(roots)} links are child of no joint ({', '.join(roots)}); expected one"
        )
    depth = dict.fromkeys(roots, 0)
    pending = list(roots)
    while pending:
        link = pending.pop()
        for joint in (joint for joint in urdf.joints.values() if joint.parent == link):
            depth[joint.child] = depth[link] + 1
            pending.append(joint.child)
    detached = [link for link in urdf.links if link not in depth]
    if detached:
        raise ModelError(f"{urdf.text.path}: links {', '.join(detached)} form a loop that is not connected to the base")
    if max(depth.values()) > MAX_DEPTH:
        raise ModelError(f"{urdf.text.path}: a chain of {max(depth.values())} joints; at most {MAX_DEPTH} are allowed")
