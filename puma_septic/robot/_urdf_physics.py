"""Masses, inertias, axes, limits and sizes of a URDF: what is impossible, and what is odd but usable."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from typing import Final

import numpy as np
import pinocchio as pin

from puma_septic.robot._urdf_schema import PARTS, tensor, vector
from puma_septic.robot._urdf_text import Finding, UrdfText
from puma_septic.validation import Array

__all__ = ["MOVING_KINDS", "joint_findings", "link_findings"]

MOVING_KINDS: Final = ("revolute", "continuous", "prismatic")
NO_MOMENT = 1e-12  # kg m^2, below any body's: what is left of zeros that a tool has rotated
MAX_MASS = 1e6  # kg
MAX_DISTANCE = 1e3  # m: no arm is longer, and 1e308 overflows in the dynamics
ROUNDING = 1e-6  # of printed digits, relative, so that a thin plate with A + B = C passes
# A negative moment below this part of the largest is one of printed digits: -4e-9 of 2.4e-4 kg m^2 (six decimals).
PRINTED = 1e-3
AXIS_ROUNDING = 1e-3  # 0.707 for the half of sqrt(2) is still meant as a unit axis
MAX_ANGLE = 4 * np.pi  # rad; a cable bears two turns to each side
UNIT_NORM = 1e-3  # of a quaternion with four digits


def link_findings(text: UrdfText, link: ET.Element, *, moves: bool) -> Iterator[Finding]:
    """What is odd or wrong in a link's inertia and shapes; the inertia of a link that never moves is not used."""
    name = f"link {link.get('name')!r}"
    inertial = link.find("inertial")
    if inertial is not None:
        yield from _inertial(text, inertial, name, moves=moves)
    for part in link:
        for origin in part.iterfind("origin"):
            yield from _origin(text, origin, name, part)
        for shape in part.iterfind("geometry/*"):
            yield from _size(text, shape, part)


def joint_findings(text: UrdfText, joint: ET.Element) -> Iterator[Finding]:
    """What is odd or wrong in a joint's kind, axis, origin, limits and friction."""
    kind, name = joint.get("type", ""), f"joint {joint.get('name')!r}"
    if kind in ("floating", "planar"):
        yield text.fault(
            joint,
            f"a {kind} joint has several coordinates and no motor: only arms on a fixed base are assessed;"
            " fix the base in the URDF (type='fixed')",
        )
    elif kind not in (*MOVING_KINDS, "fixed"):
        yield text.fault(joint, f"type={kind!r} is unknown; valid: {', '.join((*MOVING_KINDS, 'fixed'))}")
    for origin in joint.iterfind("origin"):
        yield from _origin(text, origin, name, None)
    if kind in MOVING_KINDS:
        yield from _axis(text, joint, name)
        yield from _limit(text, joint, name)
        yield from _not_negative(text, joint.find("dynamics"))


def _inertial(text: UrdfText, inertial: ET.Element, name: str, *, moves: bool) -> Iterator[Finding]:
    mass_element, tensor_element = inertial.find("mass"), inertial.find("inertia")
    assert mass_element is not None  # the schema requires both
    assert tensor_element is not None
    mass = float(vector(mass_element, "value", ())[0])
    given = f"value={mass_element.get('value')!r}"
    if mass > MAX_MASS or mass < 0:
        why = "a mass cannot be negative" if mass < 0 else f"more than {MAX_MASS:g} kg"
        yield _unusable(text, mass_element, f"{given}: {why}", inertial, moves=moves)
    moments = np.asarray(np.linalg.eigvalsh(tensor(tensor_element)), dtype=np.float64)
    if moments[2] > MAX_MASS * MAX_DISTANCE**2:
        message = f"principal moment {moments[2]:g} kg m^2: larger than any arm's"
        yield _unusable(text, tensor_element, message, inertial, moves=moves)
    else:
        yield from _moments(text, tensor_element, moments, inertial, name, mass=mass, moves=moves)


def _moments(
    text: UrdfText, tensor: ET.Element, moments: Array, inertial: ET.Element, name: str, *, mass: float, moves: bool
) -> Iterator[Finding]:
    a, b, c = moments
    told = f"principal moments {a:g}, {b:g}, {c:g} kg m^2"
    largest = max(abs(c), NO_MOMENT)
    if not a >= -PRINTED * largest:
        yield _unusable(text, tensor, f"{told}: none may be negative", inertial, moves=moves)
    elif not a >= -ROUNDING * largest:
        yield _note(f"{name}: {told}, the least below 0 by rounding; used as they are")
    elif mass == 0 and c > 0:
        yield _note(f"{name}: mass 0 with an inertia, used as it is")
    elif a + b < c * (1 - ROUNDING) - NO_MOMENT:
        yield _note(f"{name}: principal moments {a:g} + {b:g} < {c:g} kg m^2, as no body has; used as they are")


def _unusable(text: UrdfText, element: ET.Element, message: str, inertial: ET.Element, *, moves: bool) -> Finding:
    """An inertia that no body has: a fault, but where the link never moves no more than a note."""
    if moves:
        return Finding(text=text.at(element, f"{message}; {PARTS['inertial']}"), part=inertial)
    return _note(text.at(element, f"{message}; the link never moves, so it does not matter"))


def _note(text: str) -> Finding:
    return Finding(text=text, kind="note")


def _size(text: UrdfText, shape: ET.Element, part: ET.Element) -> Iterator[Finding]:
    for name in ("size", "radius", "length"):
        if name in shape.attrib and not (vector(shape, name, ()) > 0).all():
            message = f"{name}={shape.get(name)!r} m must be positive; {PARTS[part.tag]}"
            yield Finding(text=text.at(shape, message), part=part)


def _origin(text: UrdfText, origin: ET.Element, name: str, part: ET.Element | None) -> Iterator[Finding]:
    """Also turns a quaternion into the angles that Pinocchio reads."""
    if "quat_xyzw" in origin.attrib:
        quaternion = vector(origin, "quat_xyzw", ())
        norm = float(np.linalg.norm(quaternion))
        if not abs(norm - 1) <= UNIT_NORM:
            yield Finding(text=text.at(origin, f"quat_xyzw={origin.get('quat_xyzw')!r}: its norm is {norm:g}, not 1"))
            return
        angles = pin.rpy.matrixToRpy(pin.Quaternion(quaternion / norm).toRotationMatrix())
        origin.set("rpy", " ".join(repr(float(x)) for x in angles))
        yield _note(f"{name}: quat_xyzw={origin.get('quat_xyzw')!r} is used")
    if not (np.abs(vector(origin, "xyz", (0.0, 0.0, 0.0))) <= MAX_DISTANCE).all():
        message = f"xyz={origin.get('xyz')!r}: farther than {MAX_DISTANCE:g} m"
        cost = f"; {PARTS[part.tag]}" if part is not None else ""
        yield Finding(text=text.at(origin, message + cost), part=part)
    if (np.abs(vector(origin, "rpy", (0.0, 0.0, 0.0))) > 2 * np.pi).any():
        yield _note(f"{name}: rpy={origin.get('rpy')!r} is beyond 2 pi rad; degrees?")


def _axis(text: UrdfText, joint: ET.Element, name: str) -> Iterator[Finding]:
    axis = joint.find("axis")
    if axis is None:
        yield _note(f"{name}: no <axis>, so the URDF's default (1 0 0)")
        return
    norm = float(np.linalg.norm(vector(axis, "xyz", ())))
    if not 1e-6 < norm < 1e6:
        message = f"xyz={axis.get('xyz')!r} has no direction; expected a unit vector such as '0 0 1'"
        yield text.fault(axis, message)
    elif abs(norm - 1) > AXIS_ROUNDING:
        yield _note(f"{name}: axis {axis.get('xyz')!r} has length {norm:g}; its direction is used")
    if vector(axis, "rpy", (0.0, 0.0, 0.0)).any():
        yield text.fault(axis, f"rpy={axis.get('rpy')!r}: an axis is turned by its xyz alone; turn <origin> instead")
    elif "rpy" in axis.attrib:
        yield _note(f"{name}: rpy='0 0 0' of its axis is not used")


def _limit(text: UrdfText, joint: ET.Element, name: str) -> Iterator[Finding]:
    limit, kind = joint.find("limit"), joint.get("type")
    if limit is None:
        return
    for key in ("effort", "velocity", "acceleration", "deceleration", "jerk"):
        if float(limit.get(key, "0")) < 0:
            message = f"{key}={limit.get(key)!r} cannot be negative; {PARTS['limit']}"
            yield Finding(text=text.at(limit, message), part=limit, attribute=key)
    if kind == "continuous":
        if "lower" in limit.attrib or "upper" in limit.attrib:
            yield _note(f"{name}: continuous, so its lower and upper limits are not used")
        return
    lower, upper = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
    if kind == "revolute" and max(abs(lower), abs(upper)) > MAX_ANGLE:
        yield _note(f"{name}: limits {lower:g} to {upper:g} rad are beyond 4 pi rad; degrees?")


def _not_negative(text: UrdfText, dynamics: ET.Element | None) -> Iterator[Finding]:
    if dynamics is None:
        return
    for name in ("damping", "friction", "rotor_inertia", "armature"):
        if float(dynamics.get(name, "0")) < 0:
            message = f"{name}={dynamics.get(name)!r} cannot be negative; {PARTS['dynamics']}"
            yield Finding(text=text.at(dynamics, message), part=dynamics, attribute=name)
