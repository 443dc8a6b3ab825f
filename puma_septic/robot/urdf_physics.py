"""Masses, inertias, axes, limits and sizes of a URDF: the impossible is refused, the odd is noted."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator

import numpy as np

from puma_septic.robot.urdf_schema import vector
from puma_septic.robot.urdf_text import UrdfText

__all__ = ["MOVING_KINDS", "joint_notes", "link_notes"]

MOVING_KINDS = ("revolute", "continuous", "prismatic")
NO_MOMENT = 1e-12  # kg m^2, below any body's: what is left of zeros that a tool has rotated
MAX_MASS = 1e6  # kg
MAX_DISTANCE = 1e3  # m: no arm is longer, and 1e308 overflows in the dynamics
ROUNDING = 1e-6  # of printed digits, relative, so that a thin plate with A + B = C passes
AXIS_ROUNDING = 1e-3  # 0.707 for the half of sqrt(2) is still meant as a unit axis


def link_notes(text: UrdfText, link: ET.Element) -> Iterator[str]:
    """Check a link's inertia and shapes; yield what is odd but usable.

    Raises
    ------
    ModelError
        For a negative mass or principal moment, a far origin, or a shape without size.
    """
    inertial = link.find("inertial")
    if inertial is not None:
        yield from _inertial_notes(text, inertial, f"link {link.get('name')!r}")
    for origin in link.iterfind("*/origin"):
        yield from _origin_notes(text, origin, f"link {link.get('name')!r}")
    for shape in link.iterfind("*/geometry/*"):
        for name in ("size", "radius", "length"):
            if name in shape.attrib and not (vector(shape, name, ()) > 0).all():
                raise text.fault(shape, f"{name}={shape.get(name)!r} m must be positive")


def joint_notes(text: UrdfText, joint: ET.Element) -> Iterator[str]:
    """Check a joint's kind, axis, origin, limits and friction; yield what is odd but usable.

    Raises
    ------
    ModelError
        For a joint with several coordinates (floating base) or no direction, and for limits that are
        incomplete or contradict each other.
    """
    kind, name = joint.get("type", ""), f"joint {joint.get('name')!r}"
    if kind in ("floating", "planar"):
        raise text.fault(
            joint,
            f"a {kind} joint has several coordinates and no motor: only arms on a fixed base are assessed;"
            " fix the base in the URDF (type='fixed')",
        )
    if kind not in (*MOVING_KINDS, "fixed"):
        raise text.fault(joint, f"type={kind!r} is unknown; valid: {', '.join((*MOVING_KINDS, 'fixed'))}")
    for origin in joint.iterfind("origin"):
        yield from _origin_notes(text, origin, name)
    if kind != "fixed":
        yield from _axis_notes(text, joint, name)
        yield from _limit_notes(text, joint, name)
        _check_not_negative(text, joint.find("dynamics"), ("damping", "friction"))


def _inertial_notes(text: UrdfText, inertial: ET.Element, name: str) -> Iterator[str]:
    mass_element, tensor_element = inertial.find("mass"), inertial.find("inertia")
    assert mass_element is not None  # the schema requires both
    assert tensor_element is not None
    mass = float(vector(mass_element, "value", ())[0])
    if mass > MAX_MASS:
        raise text.fault(mass_element, f"value={mass_element.get('value')!r}: more than {MAX_MASS:g} kg")
    if mass < 0:
        raise text.fault(mass_element, f"value={mass_element.get('value')!r}: a mass cannot be negative")
    xx, xy, xz, yy, yz, zz = (float(tensor_element.get(key, "0")) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    a, b, c = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not a >= -ROUNDING * max(abs(c), NO_MOMENT):
        raise text.fault(tensor_element, f"principal moments {a:g}, {b:g}, {c:g} kg m^2: none may be negative")
    if c > MAX_MASS * MAX_DISTANCE**2:
        raise text.fault(tensor_element, f"principal moment {c:g} kg m^2: larger than any arm's")
    if mass == 0 and c > 0:
        yield f"{name}: mass 0 with an inertia, used as it is"
    elif a + b < c * (1 - ROUNDING) - NO_MOMENT:
        yield f"{name}: principal moments {a:g} + {b:g} < {c:g} kg m^2, as no body has; used as they are"


def _origin_notes(text: UrdfText, origin: ET.Element, name: str) -> Iterator[str]:
    if not (np.abs(vector(origin, "xyz", (0.0, 0.0, 0.0))) <= MAX_DISTANCE).all():
        raise text.fault(origin, f"xyz={origin.get('xyz')!r}: farther than {MAX_DISTANCE:g} m")
    if (np.abs(vector(origin, "rpy", (0.0, 0.0, 0.0))) > 2 * np.pi).any():
        yield f"{name}: rpy={origin.get('rpy')!r} is beyond 2 pi rad; degrees?"


def _axis_notes(text: UrdfText, joint: ET.Element, name: str) -> Iterator[str]:
    axis = joint.find("axis")
    if axis is None:
        yield f"{name}: no <axis>, so the URDF's default (1 0 0)"
        return
    norm = float(np.linalg.norm(vector(axis, "xyz", ())))
    if not 1e-6 < norm < 1e6:
        raise text.fault(axis, f"xyz={axis.get('xyz')!r} has no direction; expected a unit vector such as '0 0 1'")
    if abs(norm - 1) > AXIS_ROUNDING:
        yield f"{name}: axis {axis.get('xyz')!r} has length {norm:g}; its direction is used"


def _limit_notes(text: UrdfText, joint: ET.Element, name: str) -> Iterator[str]:
    limit, kind = joint.find("limit"), joint.get("type")
    _check_not_negative(text, limit, ("effort", "velocity"))
    if kind == "continuous":
        if limit is not None and ("lower" in limit.attrib or "upper" in limit.attrib):
            yield f"{name}: continuous, so its lower and upper limits are not used"
        return
    if limit is None:
        raise text.fault(joint, f"a {kind} joint needs <limit lower= upper= effort= velocity=>")
    for key in ("lower", "upper", "effort", "velocity"):
        if key not in limit.attrib:
            raise text.fault(limit, f"attribute {key!r} is missing; a {kind} joint needs it")
    lower, upper = float(limit.attrib["lower"]), float(limit.attrib["upper"])
    if not lower < upper:
        raise text.fault(limit, f"lower={lower:g} must be less than upper={upper:g}")
    if kind == "revolute" and max(abs(lower), abs(upper)) > 4 * np.pi:
        yield f"{name}: limits {lower:g} to {upper:g} rad are beyond 4 pi rad; degrees?"


def _check_not_negative(text: UrdfText, element: ET.Element | None, names: tuple[str, ...]) -> None:
    for name in names:
        if element is not None and float(element.get(name, "0")) < 0:
            raise text.fault(element, f"{name}={element.get(name)!r} cannot be negative")
