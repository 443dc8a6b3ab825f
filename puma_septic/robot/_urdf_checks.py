"""The door for URDFs: what is refused before Pinocchio sees it, what is left out of it, and what is noted."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

from puma_septic.robot._mimic import Mimic, followed, visiting_order
from puma_septic.robot._urdf_physics import MOVING_KINDS, joint_findings, link_findings
from puma_septic.robot._urdf_schema import as_checked, check_schema, summarised
from puma_septic.robot._urdf_text import Finding, UrdfText

__all__ = ["Urdf", "UrdfJoint", "checked_urdf"]

# Measured with pin 4.1.0: a chain of about 3,700 joints crashes the process, a star of 10,000 links takes
# 8 GB and 23 s, and the data of 300 joints 1.9 GB. The caps are far above any arm.
MAX_DEPTH = 100
MAX_LINKS = 200
# Pinocchio wants limits of every joint; the robot has its own.
_ANY = {"lower": "-1", "upper": "1", "effort": "1", "velocity": "1"}


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class UrdfJoint:
    """One joint of a checked URDF; `kind` is "fixed" also where it is locked."""

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
    mimics : dict of str to Mimic
        Joints that follow another one, by name.
    unusable : dict of str to str
        Links whose inertia no body can have, and why.
    notes : tuple of str
    """

    name: str
    text: UrdfText
    links: dict[str, ET.Element]
    joints: dict[str, UrdfJoint]
    mimics: dict[str, Mimic]
    unusable: dict[str, str]
    notes: tuple[str, ...]

    @property
    def moving(self) -> tuple[str, ...]:
        """Joints with a coordinate of their own: neither fixed nor locked nor following another."""
        return tuple(name for name, joint in self.joints.items() if joint.kind != "fixed" and name not in self.mimics)

    @property
    def above(self) -> dict[str, UrdfJoint]:
        """The joint that each link hangs on; the base is absent."""
        return {joint.child: joint for joint in self.joints.values()}

    def carriers(self, link: str) -> list[str]:
        """Joints between the base and a link, from the link on, fixed ones too."""
        above, names = self.above, []
        while link in above:
            names.append(above[link].name)
            link = above[link].parent
        return names

    def xml(self, link_parts: Collection[str], names: Mapping[str, str] | None = None) -> str:
        """Text for Pinocchio: joints, under other names where given, and these parts of the links, as checked."""
        called = names or {}
        tree = ET.Element("robot", name=self.name)
        tree.extend(map(as_checked, self.text.root.findall("material")))
        for name, link in self.links.items():
            parts = (as_checked(part) for part in link if part.tag in link_parts)
            ET.SubElement(tree, "link", name=name).extend(parts)
        for joint in self.joints.values():
            kind = self._read_kind(joint)
            element = ET.SubElement(tree, "joint", name=called.get(joint.name, joint.name), type=kind)
            parts = (as_checked(part) for part in joint.element if part.tag in ("origin", "parent", "child", "axis"))
            element.extend(parts)
            if kind not in ("fixed", "continuous"):
                element.append(ET.Element("limit", _ANY))
            if joint.name in self.mimics:
                mimic = self.mimics[joint.name]
                numbers = {"multiplier": repr(mimic.multiplier), "offset": repr(mimic.offset)}
                ET.SubElement(element, "mimic", {"joint": called.get(mimic.master, mimic.master), **numbers})
        return ET.tostring(tree, encoding="unicode")

    def _read_kind(self, joint: UrdfJoint) -> str:
        """How Pinocchio reads a joint: one that turns with another it wants to be continuous where that is."""
        master = self.mimics.get(joint.name)
        rotates = ("revolute", "continuous")
        if master is None or joint.kind not in rotates or self.joints[master.master].kind not in rotates:
            return joint.kind
        return self.joints[master.master].kind

    def visited(self) -> list[str]:
        """Joints in an order in which Pinocchio can read them."""
        (root,) = [link for link in self.links if link not in self.above]
        children = {link: [joint.name for joint in found] for link, found in _children(self.joints).items()}
        moved = {name: joint.child for name, joint in self.joints.items()}
        order = visiting_order((children, moved), root, self.mimics)
        if order is None:
            raise self.text.error([_no_order(self)])
        return order


def checked_urdf(text: UrdfText) -> Urdf:
    """Check a parsed URDF; everything that is wrong with it is told at once.

    What is wrong in a part that can be left out, such as an inertia or a shape, is left out of the text's tree and
    noted, so that it stops only what depends on it.

    Raises
    ------
    ModelError
        For anything without which there is no robot, and for what may be a misspelt word of the format.
    """
    schema = check_schema(text)
    if text.root.tag != "robot":
        raise text.error(schema[text.root])
    links, elements, findings = _by_name(text)
    sound = [joint for joint in elements.values() if not any(one.stops for one in schema[joint])]
    joints = {joint.name: joint for joint in map(_joint, sound)}
    moved = _moved_links(joints)
    unusable: dict[str, str] = {}
    for element, found in schema.items():
        told = list(_checked(text, element, found, moved))
        findings += told
        bad = [one.text for one in told if one.part is not None and one.part.tag == "inertial"]
        if bad and element.tag == "link":
            unusable[element.get("name", "")] = bad[0]
    if len(joints) == len(elements):
        findings += _tree_faults(text, links, joints)
    mimics, faults = _mimics(text, joints)
    findings = summarised([*findings, *faults])
    if stopping := [one for one in findings if one.stops]:
        raise text.error(stopping)
    return Urdf(
        name=text.root.get("name", ""),
        text=text,
        links=links,
        joints=joints,
        mimics=mimics,
        unusable=unusable,
        notes=tuple(dict.fromkeys(one.text for one in findings)),
    )


def _checked(text: UrdfText, element: ET.Element, found: list[Finding], moved: Collection[str]) -> Iterator[Finding]:
    """The findings in one link or joint, form first; each part with a fault is taken out of the tree."""
    yield from found
    _leave_out(element, found)
    if any(one.part is element for one in found):  # a material of the whole robot
        text.root.remove(element)
    if any(one.stops for one in found):
        return
    more: list[Finding] = []
    if element.tag == "link":
        more = list(link_findings(text, element, moves=element.get("name", "") in moved))
    elif element.tag == "joint":
        more = list(joint_findings(text, element))
    yield from more
    _leave_out(element, more)


def _leave_out(element: ET.Element, findings: Iterable[Finding]) -> None:
    """Take faulty parts, or their faulty attributes, out of a link or joint."""
    holders = {child: parent for parent in element.iter() for child in parent}
    for one in findings:
        if one.kind != "fault" or one.part is None:
            continue
        if one.attribute:
            one.part.attrib.pop(one.attribute, None)
        elif one.part in holders and one.part in list(holders[one.part]):
            holders[one.part].remove(one.part)


def _by_name(text: UrdfText) -> tuple[dict[str, ET.Element], dict[str, ET.Element], list[Finding]]:
    """Links and joints by name, and the names that are there twice."""
    found: dict[str, dict[str, ET.Element]] = {"link": {}, "joint": {}, "material": {}}
    doubles = []
    for tag, named in found.items():
        for element in text.root.findall(tag):
            name = element.get("name", "")
            if name in named:
                message = f"this name is already taken by the {tag} in line {text.line(named[name])}"
                doubles.append(text.fault(element, message))
            named.setdefault(name, element)
    return found["link"], found["joint"], doubles


def _joint(element: ET.Element) -> UrdfJoint:
    parent, child = element.find("parent"), element.find("child")
    assert parent is not None  # the schema requires both
    assert child is not None
    return UrdfJoint(
        name=element.get("name", ""),
        kind=element.get("type", ""),
        parent=parent.get("link", ""),
        child=child.get("link", ""),
        element=element,
    )


def _children(joints: Mapping[str, UrdfJoint]) -> dict[str, list[UrdfJoint]]:
    children: dict[str, list[UrdfJoint]] = {}
    for joint in joints.values():
        children.setdefault(joint.parent, []).append(joint)
    return children


def _below(children: Mapping[str, Sequence[UrdfJoint]], starts: Iterable[str]) -> dict[str, int]:
    """Links that hang on these, with the number of joints between; each is visited once, also in a cycle."""
    depth = dict.fromkeys(starts, 0)
    pending = list(depth)
    while pending:
        link = pending.pop()
        for joint in children.get(link, ()):
            if joint.child not in depth:
                depth[joint.child] = depth[link] + 1
                pending.append(joint.child)
    return depth


def _moved_links(joints: Mapping[str, UrdfJoint]) -> set[str]:
    return set(_below(_children(joints), (joint.child for joint in joints.values() if joint.kind in MOVING_KINDS)))


def _tree_faults(text: UrdfText, links: Mapping[str, ET.Element], joints: Mapping[str, UrdfJoint]) -> list[Finding]:
    """Each link must hang on exactly one joint, but for one root from which all are reached."""
    if not links:
        return [Finding(text="no <link> in this URDF")]
    if len(links) > MAX_LINKS:
        return [Finding(text=f"{len(links)} links; at most {MAX_LINKS} are allowed")]
    faults: list[Finding] = []
    above: dict[str, UrdfJoint] = {}
    for joint in joints.values():
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in links:
                faults.append(text.fault(joint.element, f"its {role} link {link!r} is not defined"))
        if joint.child in above:
            other = above[joint.child]
            message = (
                f"link {joint.child!r} is already the child of joint {other.name!r} in line"
                f" {text.line(other.element)}; closed loops are not supported"
            )
            faults.append(text.fault(joint.element, message))
        above[joint.child] = joint
    roots = [link for link in links if link not in above]
    if len(roots) > 1:
        faults.append(Finding(text=f"{len(roots)} links are child of no joint ({', '.join(roots)}); expected one"))
    depth = _below(_children(joints), roots)
    if not faults and (detached := [link for link in links if link not in depth]):
        faults.append(Finding(text=f"links {', '.join(detached)} form a loop that is not connected to the base"))
    if max(depth.values(), default=0) > MAX_DEPTH:
        faults.append(Finding(text=f"a chain of {max(depth.values())} joints; at most {MAX_DEPTH} are allowed"))
    return faults


# Of a mimicking joint: no gear turns faster, no finger starts farther off, and products of two are still finite.
_FARTHEST: Final = 1e6


def _mimics(text: UrdfText, joints: Mapping[str, UrdfJoint]) -> tuple[dict[str, Mimic], list[Finding]]:
    """What each mimicking joint follows in the end, and those that cannot be followed."""
    elements = {
        name: element
        for name, joint in joints.items()
        if joint.kind in MOVING_KINDS and (element := joint.element.find("mimic")) is not None
    }
    given = {
        name: Mimic(
            master=element.get("joint", ""),
            multiplier=float(element.get("multiplier", "1")),
            offset=float(element.get("offset", "0")),
        )
        for name, element in elements.items()
    }
    known = {name: mimic for name, mimic in given.items() if mimic.master in joints}
    found, faults = {}, []
    for name, element in elements.items():
        mimic = followed(name, known)
        if name not in known:
            master = given[name].master
            message = f"it mimics {master!r}, which is no joint here; taken for a joint with a motor of its own"
            faults.append(Finding(text=text.at(element, message), kind="note"))
        elif mimic is None:
            faults.append(text.fault(element, f"joint {name!r} mimics itself in the end"))
        elif max(abs(mimic.multiplier), abs(mimic.offset)) > _FARTHEST:
            faults.append(
                text.fault(
                    element,
                    f"joint {name!r} follows {mimic.master!r} by a multiplier of {mimic.multiplier:g} and an offset of"
                    f" {mimic.offset:g}: at most {_FARTHEST:g} each",
                )
            )
        else:
            found[name] = mimic
    return found, faults


def _no_order(urdf: Urdf) -> Finding:
    names = ", ".join(map(repr, urdf.mimics))
    return Finding(
        text=f"of the mimicking joints {names} one carries the joint that it follows, or two branches follow each"
        f" other, which is not supported; lock them: locked={{{next(iter(urdf.mimics))!r}: 0.0}}"
    )
