"""What a URDF tells of drives and limits; zeros of exporters and what is missing are unknown."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Collection, Iterator, Sequence
from math import isnan, nan
from typing import Final

import numpy as np

from puma_septic.drives import Drivetrain, Gearbox, Motor
from puma_septic.friction import Friction
from puma_septic.robot._components import Limits
from puma_septic.robot._mimic import Mimic
from puma_septic.robot._urdf_checks import Urdf
from puma_septic.robot._urdf_schema import NUMBER
from puma_septic.robot._urdf_text import Finding
from puma_septic.validation import Array

__all__ = ["SOFT", "position_range", "urdf_drivetrains", "urdf_limits"]

# A reduction of 1 is what files have that do not tell it.
_NO_REDUCTION: Final = 1.0
_DRAKE: Final = "drake:"


def urdf_drivetrains(urdf: Urdf, moving: Sequence[str]) -> tuple[dict[str, Drivetrain], tuple[str, ...]]:
    """What is known of the drives of the moving joints, and a note of what is used.

    ``damping`` and ``friction`` of ``<dynamics>`` are viscous and Coulomb friction at the joint (URDF specification),
    ``rotor_inertia`` (RaiSim) and ``armature`` inertia there; of a ``<transmission>``, ``mechanicalReduction`` or
    Drake's ``gear_ratio`` is the gear ratio and Drake's ``rotor_inertia`` that of the motor. Zeros are unknown, as is a
    reduction of 1.
    """
    trains, used = {}, {"friction": list[str](), "rotor inertia": list[str](), "gear ratio": list[str]()}
    gears = {name: element for element in urdf.text.root.findall("transmission") for name in _driven(element)}
    for name in moving:
        train = _train(urdf.joints[name].element.find("dynamics"), gears.get(name), urdf.text.path.name)
        trains[name] = train
        if train.friction_at_joint is not None or train.measured_friction is not None:
            used["friction"].append(name)
        if train.knows_inertia:
            used["rotor inertia"].append(name)
        if not isnan(train.ratio):
            used["gear ratio"].append(name)
    notes = tuple(
        f"{what} from the URDF, often a simulator's rather than the drive's: {_who(names, moving)}"
        for what, names in used.items()
        if names
    )
    return trains, notes


def _train(dynamics: ET.Element | None, gears: ET.Element | None, source: str) -> Drivetrain:
    damping, friction, rotor, armature = (
        _positive(dynamics.get(name)) if dynamics is not None else nan
        for name in ("damping", "friction", "rotor_inertia", "armature")
    )
    ratio, motor_side = (nan, nan) if gears is None else (_ratio(gears), _drake(gears, "rotor_inertia"))
    at_joint = armature if isnan(rotor) else rotor
    law = Friction(viscous=damping, coulomb=np.array([friction, -friction]))
    law_known = not (isnan(damping) and isnan(friction))
    if isnan(ratio):
        motor = Motor(rotor_inertia=motor_side, source=source if law_known or not isnan(motor_side) else "")
        return Drivetrain(motor=motor, armature=at_joint, friction_at_joint=law if law_known else None)
    # With a ratio all of it is the motor's, which sizing asks.
    return Drivetrain(
        motor=Motor(rotor_inertia=at_joint / ratio**2 if isnan(motor_side) else motor_side, source=source),
        gearbox=Gearbox(ratio=ratio, source=source),
        measured_friction=law.reflected(1 / ratio) if law_known else None,
    )


def _driven(transmission: ET.Element) -> list[str]:
    """Joints of a transmission that drives one joint; a coupled one's numbers mean no single joint."""
    names = [element.get("name", "") for element in transmission.findall("joint")]
    return names if len(names) == 1 else []


def _ratio(transmission: ET.Element) -> float:
    texts = [element.text for element in transmission.iter("mechanicalReduction")]
    given = [value for value in map(_number, texts) if not isnan(value) and value not in (0.0, _NO_REDUCTION)]
    return given[0] if given else _drake(transmission, "gear_ratio")


def _drake(transmission: ET.Element, name: str) -> float:
    tags = [element for element in transmission.iterfind("actuator/*") if element.tag == f"{_DRAKE}{name}"]
    return _positive(tags[0].get("value")) if tags else nan


def _positive(text: str | None) -> float:
    value = _number(text)
    return value if value > 0 else nan


def _number(text: str | None) -> float:
    word = (text or "").strip()
    return float(word) if NUMBER.fullmatch(word) and np.isfinite(float(word)) else nan


def _who(names: Sequence[str], moving: Sequence[str]) -> str:
    return "all joints" if len(names) == len(moving) else ", ".join(names)


SOFT: Final = "soft"
"""The set of limits that takes positions from the safety controllers."""

_GIVEN: Final = ("velocity", "effort", "acceleration", "jerk")
# Those that a joint shares with the joints that mimic it; the effort of all is its own motor's.
_FOLLOWED: Final = ("velocity", "acceleration", "jerk")
# Limits that differ by less than this part are one.
_SAME: Final = 1e-9
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
    followers = [
        *_followed_ranges(urdf, moving, position),
        *(note for name in _FOLLOWED for note in _followed_magnitudes(urdf, moving, name, values[name])),
    ]
    notes = [
        note
        for name, joint, bounds in zip(moving, joints, position, strict=True)
        for note in _joint_notes(name, joint, bounds)
    ]
    lacking = [name for name in ("acceleration", "jerk") if np.isnan(values[name]).all()]
    source = urdf.text.path.name + (f": no {' or '.join(lacking)} limits in it" if lacking else "")
    return Limits(position=position, source=source, **values), (*notes, *followers)


def soft_positions(urdf: Urdf, moving: Sequence[str], position: Array) -> Array:
    """The position limits with those of the safety controllers, shape (n_joints, 2)."""
    result = np.array(position)
    for j, name in enumerate(moving):
        soft = _soft_range(urdf.joints[name].element)
        result[j] = np.where(np.isnan(soft), result[j], soft)
    _followed_ranges(urdf, moving, result)
    return result


def _followers(urdf: Urdf, moving: Sequence[str]) -> Iterator[tuple[int, str, Mimic]]:
    """Index of the joint that is followed, and each joint that mimics it and moves."""
    for name, mimic in urdf.mimics.items():
        if mimic.master in moving and mimic.multiplier:
            yield moving.index(mimic.master), name, mimic


def _followed_ranges(urdf: Urdf, moving: Sequence[str], position: Array) -> list[str]:
    """Narrow the position limits of joints to those within which all that mimic them keep their own, and say so.

    Limits that leave nothing are a slip of the exporter, such as those of the other finger with the wrong sign.
    """
    notes = []
    for j, name, mimic in _followers(urdf, moving):
        own = (np.array(position_range(urdf.joints[name].element)) - mimic.offset) / mimic.multiplier
        low, high = (own if mimic.multiplier > 0 else own[::-1]).tolist()
        lower, upper = position[j].tolist()
        slack = _SAME * max(abs(lower), abs(upper))
        is_new = isnan(lower) and not isnan(low) and urdf.joints[mimic.master].kind != "continuous"
        if is_new or low > lower + slack or high < upper - slack:
            bounds = np.fmax(low, lower), np.fmin(high, upper)
            if bounds[0] < bounds[1]:
                position[j] = bounds
                told = f"its range is {bounds[0]:.6g} to {bounds[1]:.6g}, in which that joint keeps its own"
            else:
                told = "the position limits of that joint leave it no range and are not used"
            notes.append(f"joint {mimic.master!r} is followed by {name!r}: {told}")
    return notes


def _followed_magnitudes(urdf: Urdf, moving: Sequence[str], quantity: str, limit: Array) -> list[str]:
    """Lower a limit of joints to that at which all that mimic them keep their own, and say so."""
    notes = []
    for j, name, mimic in _followers(urdf, moving):
        own = _magnitude(urdf.joints[name].element, quantity) / abs(mimic.multiplier)
        if own < limit[j] * (1 - _SAME) or (isnan(limit[j]) and not isnan(own)):
            limit[j] = own
            notes.append(
                f"joint {mimic.master!r} is followed by {name!r}: its {quantity} limit is {own:.6g}, at which that"
                " joint keeps its own"
            )
    return notes


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
