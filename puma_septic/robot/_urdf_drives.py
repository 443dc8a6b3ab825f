"""What a URDF tells of the drives: friction and rotors of <dynamics>, gears and rotors of <transmission>."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from math import isnan, nan
from typing import Final

import numpy as np

from puma_septic.drives import Drivetrain, Gearbox, Motor
from puma_septic.friction import Friction
from puma_septic.robot._urdf_checks import Urdf
from puma_septic.robot._urdf_schema import NUMBER

__all__ = ["urdf_drivetrains"]

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
