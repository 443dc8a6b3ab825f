"""Limits as a URDF has them: what it gives is used, zeros of exporters and what is missing are unknown."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Collection, Sequence
from typing import Final

import numpy as np

from puma_septic.robot._components import Limits
from puma_septic.robot._urdf_checks import Urdf
from puma_septic.robot._urdf_text import Finding
from puma_septic.validation import Array

__all__ = ["SOFT", "position_range", "urdf_limits"]

SOFT: Final = "soft"
"""The set of limits that takes positions from the safety controllers."""

_GIVEN: Final = ("velocity", "effort", "acceleration", "jerk")
# Quantities that the format asks for, so that their absence is told joint by joint.
_ASKED: Final = ("velocity", "effort")


def position_range(joint: ET.Element) -> tuple[float, float]:
    """Lower and upper bound, NaN where not known.

    Both zero, or the same, is what exporters write for a joint without limits (SolidWorks: all zero), and of a
    continuous joint none is used.
    """
    limit = joint.find("limit")
    if limit is None or joint.get("type") == "continuous":
        return np.nan, np.nan
    lower, upper = (float(limit.get(name, "nan")) for name in ("lower", "upper"))
    return (np.nan, np.nan) if lower == upper else (lower, upper)


def urdf_limits(urdf: Urdf, moving: Sequence[str], known_ranges: Collection[str]) -> tuple[Limits, tuple[str, ...]]:
    """Limits of the moving joints and what must be said of them.

    Raises
    ------
    ModelError
        For bounds that are swapped, unless the position limits of that joint are known from elsewhere.
    """
    joints = [urdf.joints[name].element for name in moving]
    swapped = [
        _swapped(urdf, joint)
        for name, joint in zip(moving, joints, strict=True)
        if np.subtract(*position_range(joint)) > 0 and name not in known_ranges
    ]
    if swapped:
        raise urdf.text.error(swapped)
    position = np.array([position_range(joint) for joint in joints])
    position[position[:, 0] > position[:, 1]] = np.nan
    values = {name: np.array([_magnitude(joint, name) for joint in joints]) for name in _GIVEN}
    notes = [
        note
        for name, joint, bounds in zip(moving, joints, position, strict=True)
        for note in _joint_notes(name, joint, bounds)
    ]
    lacking = [name for name in ("acceleration", "jerk") if np.isnan(values[name]).all()]
    source = urdf.text.path.name + (f": no {' or '.join(lacking)} limits in it" if lacking else "")
    return Limits(position=position, source=source, **values), tuple(notes)


def soft_positions(urdf: Urdf, moving: Sequence[str], position: Array) -> Array:
    """The position limits with those of the safety controllers, shape (n_joints, 2)."""
    result = np.array(position)
    for j, name in enumerate(moving):
        soft = _soft_range(urdf.joints[name].element)
        result[j] = np.where(np.isnan(soft), result[j], soft)
    return result


def _magnitude(joint: ET.Element, name: str) -> float:
    """A limit of velocity, effort ...; 0 is a placeholder, so unknown; of two accelerations the smaller."""
    limit = joint.find("limit")
    given = [name] if name != "acceleration" else [name, "deceleration"]
    values = [float(limit.get(key, "0")) for key in given] if limit is not None else []
    known = [value for value in values if value > 0]
    return min(known) if known and values[0] > 0 else np.nan


def _joint_notes(name: str, joint: ET.Element, bounds: Array) -> list[str]:
    limit, notes = joint.find("limit"), []
    given = limit.attrib if limit is not None else {}
    if joint.get("type") != "continuous" and np.isnan(bounds).any():
        which = (
            "no position limits"
            if not ("lower" in given and "upper" in given)
            else (f"lower = {given['lower']} and upper = {given['upper']}")
        )
        notes.append(
            f"joint {name!r}: the URDF gives {which}: position limit unknown; give it in the task or actuator file"
        )
    for key in _ASKED:
        if np.isnan(_magnitude(joint, key)):
            notes.append(f"joint {name!r}: the URDF gives no {key} limit (or 0): unknown")
    if "deceleration" in given and given.get("acceleration") != given["deceleration"]:
        used = _magnitude(joint, "acceleration")
        notes.append(f"joint {name!r}: of acceleration and deceleration the smaller is its limit, {used:g}")
    soft = _soft_range(joint)
    if (soft[0] > bounds[0]) or (soft[1] < bounds[1]):
        notes.append(
            f"joint {name!r}: its safety controller has soft limits {soft[0]:g} to {soft[1]:g} within its position"
            f" limits; not used here: limits={SOFT!r} takes them"
        )
    return notes


def _soft_range(joint: ET.Element) -> Array:
    """Soft bounds of the safety controller, NaN where it has none; both 0 are the format's defaults."""
    controller = joint.find("safety_controller")
    if controller is None:
        return np.full(2, np.nan)
    soft = np.array([float(controller.get(f"soft_{side}_limit", "nan")) for side in ("lower", "upper")])
    return soft if soft[0] < soft[1] else np.full(2, np.nan)


def _swapped(urdf: Urdf, joint: ET.Element) -> Finding:
    limit = joint.find("limit")
    assert limit is not None  # else there is nothing to be swapped
    message = (
        f"lower={limit.get('lower')} must be less than upper={limit.get('upper')}; are they swapped? Mend the URDF, or"
        " give this joint's position limits in an actuator file (actuators=...)"
    )
    return urdf.text.fault(limit, message)
