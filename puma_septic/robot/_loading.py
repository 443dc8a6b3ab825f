"""load_robot: from a URDF and an actuator file to a Robot."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from puma_septic.drives import Drivetrain
from puma_septic.errors import InputError, ModelError
from puma_septic.files import checked_path
from puma_septic.robot._actuator_file import ActuatorFile, ParameterSet, read_actuator_file
from puma_septic.robot._components import Limits, Payload
from puma_septic.robot._locking import (
    Locks,
    check_followers,
    check_moving,
    named_locks,
    set_origin,
    with_locks,
    without_others,
)
from puma_septic.robot._meshes import confined_geometry
from puma_septic.robot._model import Robot
from puma_septic.robot._model_checks import check_complete, massless_notes, unknown_torques
from puma_septic.robot._names import own_file, robot_file
from puma_septic.robot._tool import chosen_tool
from puma_septic.robot._urdf_checks import Urdf, checked_urdf
from puma_septic.robot._urdf_drives import SOFT, position_range, soft_positions, urdf_drivetrains, urdf_limits
from puma_septic.robot._urdf_text import read_urdf
from puma_septic.validation import Array, checked_array, checked_choice, checked_kind

__all__ = ["load_robot", "robot_files"]

_TENSOR: Final = {(0, 0): "ixx", (0, 1): "ixy", (0, 2): "ixz", (1, 1): "iyy", (1, 2): "iyz", (2, 2): "izz"}


def load_robot(
    source: str | Path = "puma560",
    *,
    parameters: str | None = None,
    limits: str | None = None,
    actuators: str | Path | None = None,
    tool: str | None = None,
    package_dirs: Sequence[str | Path] = (),
    locked: Locks = None,
    links: Mapping[str, Payload] | None = None,
    gravity: ArrayLike = (0.0, 0.0, -9.81),
) -> Robot:
    """Load a robot by its name, or any URDF, with an optional actuator file.

    The URDF is checked before Pinocchio reads it, because Pinocchio drops an inertia with a misspelt number,
    loses a joint in a closed loop and takes a misspelt origin for zero without a word. What is wrong or missing stops
    only the answers that depend on it, and is named in the robot's notes.

    Parameters
    ----------
    source : str or Path
        "puma560", the name of a robot of example-robot-data such as "ur5" or "panda", or the path of a .urdf file.
    parameters, limits : str, optional
        Named sets of the actuator file; its defaults otherwise. PUMA: parameters "rtb" or "akb", limits
        "corke", "akb" or "benchmark". Of any URDF the limits "soft": positions of its safety controllers.
    actuators : str or Path, optional
        Actuator file (TOML). Of joints that it does not have the drives are as the URDF's <dynamics> and
        <transmission> tell, else unknown (NaN, not in the torques); without limits in it they are the URDF's.
    tool : str, optional
        Frame that is positioned and that carries payload and wrench; the actuator file's otherwise ("flange"
        for the PUMA), else one is chosen: tool0, tcp, end effector or flange by name, else the end of the longest
        chain, fingers left out; a note names it.
    package_dirs : sequence of str or Path
        Folders that hold the packages of ``package://`` mesh names, that are such packages, or that are a workspace of
        them. Meshes are opened from these, from the URDF's folder and from the package that it lies in, from nowhere
        else; what cannot be opened is not drawn.
    locked : mapping of str to float, or "others", optional
        Joints to fix, with their position in rad (m for prismatic joints), such as a gripper's fingers; joints that
        mimic them are fixed with them. "others", or that key with the value None, fixes every joint that does not carry
        the tool, at zero or the limit nearest to it.
    links : mapping of str to Payload, optional
        Mass, centre of mass (in the link's frame) and inertia of links by name, instead of the URDF's.
    gravity : array_like, shape (3,)
        m/s^2 in the URDF's base frame; (0, 0, 9.81) for an arm that hangs from the ceiling.

    Returns
    -------
    Robot
        Joints in the order of the URDF's text. What a reader of results must know is in its notes.

    Raises
    ------
    InputError
        For an unknown robot, set, frame or joint (the valid ones are listed), or a locked position outside
        its limits.
    ModelError
        For a file that is missing, malformed or describes no arm, with file, line and element.

    Examples
    --------
    >>> robot = load_robot()
    >>> robot.joint_names
    ('joint1', 'joint2', 'joint3', 'joint4', 'joint5', 'joint6')
    >>> robot.limits.effort.tolist()
    [56.0, 97.0, 52.0, 10.0, 10.0, 10.0]
    """
    _check_pinocchio()
    down = checked_array("gravity", gravity, (3,), unit="m/s^2")
    for name, chosen_set in (("parameters", parameters), ("limits", limits)):
        if chosen_set is not None:
            checked_kind(name, chosen_set, str)
    positions, lock_others = named_locks(locked)
    urdf_path, actuator_path = _paths(source, actuators)
    text = read_urdf(urdf_path)
    file = None if actuator_path is None else read_actuator_file(actuator_path, text.root.get("name", ""))
    whole = checked_urdf(text)
    given = _parameter_set(file, parameters, whole)
    whole = _repaired(whole, given, {} if links is None else checked_kind("links", links, Mapping), actuator_path)
    urdf, (frame, chosen) = _arranged(whole, positions, _wanted_tool(tool, file, whole), lock_others=lock_others)
    model = _pinocchio_model(urdf, down)
    geometry, missing_meshes = confined_geometry(urdf, package_dirs)
    own_limits, limit_notes = _limits(file, limits, urdf, whole)
    trains, drive_notes = _drivetrains(given, urdf, has_file=file is not None)
    robot = Robot(
        name=urdf.name,
        bare_model=model,
        joint_names=urdf.moving,
        tool=frame,
        tool_is_chosen=bool(chosen),
        drivetrains=trains,
        limits=own_limits,
        geometry=geometry,
        mimics=urdf.mimics,
        unusable_inertia=urdf.unusable,
        missing_meshes=missing_meshes,
        notes=(*given.notes, *drive_notes, *urdf.notes, *massless_notes(model, urdf), *limit_notes, *chosen),
    )
    missing, why = unknown_torques(model, robot.model.armature, urdf)
    return replace(robot, missing_inertia=missing, notes=(*robot.notes, *why))


def robot_files(source: str | Path = "puma560", *, actuators: str | Path | None = None) -> dict[str, Path]:
    """The files that `load_robot` reads for a robot, meshes apart.

    Returns
    -------
    dict of str to Path
        "robot" and, where there is one, "actuators".

    Raises
    ------
    InputError
        For an unknown robot; the valid ones are listed.
    """
    urdf, actuator_file = _paths(source, actuators)
    return {"robot": urdf} if actuator_file is None else {"robot": urdf, "actuators": actuator_file}


def _check_pinocchio() -> None:
    if not hasattr(pin, "buildModelFromXML"):
        raise ModelError(
            f"{pin.__file__} is another package called pinocchio; Pinocchio is the package pin: python -m pip uninstall"
            " pinocchio, then python -m pip install --force-reinstall pin"
        )


def _paths(source: str | Path, actuators: str | Path | None) -> tuple[Path, Path | None]:
    """Files of a robot; one of this package may have an actuator file of its own."""
    path = robot_file(source)
    if actuators is not None:
        return path, checked_path(actuators, "actuator file")
    return path, own_file(path, "actuators")


def _parameter_set(file: ActuatorFile | None, name: str | None, urdf: Urdf) -> ParameterSet:
    if file is not None:
        return file.parameter_set(name, [joint for joint, one in urdf.joints.items() if one.kind != "fixed"])
    if name is not None:
        raise InputError(f"parameters {name!r}: there are no named sets without an actuator file (actuators=...)")
    return ParameterSet(name="", notes=(), drivetrains={}, links={}, joint_origins={})


def _drivetrains(given: ParameterSet, urdf: Urdf, *, has_file: bool) -> tuple[tuple[Drivetrain, ...], tuple[str, ...]]:
    """Each joint's drive as the file has it, else what the URDF tells of it."""
    own, notes = urdf_drivetrains(urdf, [name for name in urdf.moving if name not in given.drivetrains])
    trains = {**own, **given.drivetrains}
    if not has_file and not notes:
        notes = ("no actuator file: rotor inertia and friction are unknown, not in the torques",)
    return tuple(trains[name] for name in urdf.moving), notes


def _limits(file: ActuatorFile | None, name: str | None, urdf: Urdf, whole: Urdf) -> tuple[Limits, tuple[str, ...]]:
    """The named set, else the actuator file's default, else the URDF's own with what is unknown there."""
    moving = urdf.moving
    own, notes = urdf_limits(urdf, moving, file.known_ranges(name) if file is not None else ())
    if name == SOFT and (file is None or SOFT not in file.limits):
        position = soft_positions(urdf, moving, own.position)
        return replace(own, position=position, source=f"{own.source}; positions: soft limits"), notes
    if file is None and name is not None:
        raise InputError(
            f"limits {name!r}: there are no named sets without an actuator file (actuators=...) but {SOFT!r}"
        )
    if file is None:
        return own, notes
    chosen = file.limit_set(name, own, moving, [one for one in whole.joints if one not in moving])
    return chosen, notes if chosen is own else ()


def _repaired(urdf: Urdf, given: ParameterSet, links: Mapping[str, Payload], path: Path | None) -> Urdf:
    """The robot with the inertias and joint origins of a parameter set, and of the caller, written into its tree."""
    joints = {name: joint.element for name, joint in urdf.joints.items()}
    for name, xyz in given.joint_origins.items():
        if name not in joints:
            raise ModelError(f"{path}: unknown joint {name!r}; valid: {', '.join(joints)}")
        set_origin(joints[name], xyz=xyz)
    bodies = {name: {"mass": one.mass, "com": one.com, "inertia": one.inertia} for name, one in links.items()}
    for where, parts in ((f"{path}", given.links), ("links", bodies)):
        for name, values in parts.items():
            if name not in urdf.links:
                raise ModelError(f"{where}: unknown link {name!r}; valid: {', '.join(urdf.links)}")
            _set_inertial(urdf.links[name], values, where)
    known = {name: why for name, why in urdf.unusable.items() if urdf.links[name].find("inertial") is None}
    return replace(urdf, unusable=known)


def _set_inertial(link: ET.Element, values: Mapping[str, Any], where: str) -> None:
    """Write what is given of a body into a link; what is not stays the URDF's."""
    inertial = link.find("inertial")
    if inertial is None:
        if lacking := [key for key in ("mass", "com", "inertia") if key not in values]:
            raise ModelError(
                f"{where}: link {link.get('name')!r} has no usable <inertial> in the URDF, so {', '.join(lacking)} is"
                " needed too"
            )
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "mass")
        ET.SubElement(inertial, "inertia")
    for element in inertial:
        if element.tag == "mass" and "mass" in values:
            element.set("value", repr(float(values["mass"])))
        if element.tag == "inertia" and "inertia" in values:
            for (i, j), name in _TENSOR.items():
                element.set(name, repr(float(values["inertia"][i][j])))
    if "com" in values:
        set_origin(inertial, xyz=values["com"])
    if "inertia" in values:  # which is in the link's axes
        set_origin(inertial, rpy=np.zeros(3))


def _arranged(
    urdf: Urdf, positions: Mapping[str, float], wanted: str | None, *, lock_others: bool
) -> tuple[Urdf, tuple[str, tuple[str, ...]]]:
    """The robot with its joints locked; the tool, and a note where it was chosen."""
    whole, urdf = urdf, with_locks(urdf, positions)
    tool, notes = (wanted, ()) if wanted is not None else _chosen(whole, positions)
    link = urdf.joints[tool].child if tool not in urdf.links else tool
    check_followers(whole, positions, link)
    if lock_others:
        urdf, told = without_others(urdf, link)
        urdf = replace(urdf, notes=(*urdf.notes, *told))
    check_moving(urdf)
    return urdf, (tool, notes)


def _chosen(urdf: Urdf, locked: Collection[str]) -> tuple[str, tuple[str, ...]]:
    tool, note = chosen_tool(urdf, locked)
    return tool, (note,)


def _wanted_tool(tool: str | None, file: ActuatorFile | None, urdf: Urdf) -> str | None:
    """The caller's tool frame, else the actuator file's."""
    wanted = tool if tool is not None else file.tool if file is not None else None
    return None if wanted is None else checked_choice("tool frame", wanted, [*urdf.links, *urdf.joints])


def _pinocchio_model(urdf: Urdf, gravity: Array) -> pin.Model:
    """Pinocchio's model; joints are renamed for it where one mimics another, to be visited in the right order."""
    names = {name: f"{k:04d}" for k, name in enumerate(urdf.visited())} if urdf.mimics else {}
    try:
        model = pin.buildModelFromXML(urdf.xml(("inertial",), names), mimic=bool(names))
    except (ValueError, RuntimeError) as error:
        raise urdf.text.complaint(f"Pinocchio refuses this URDF: {str(error).strip()}") from error
    original = {short: name for name, short in names.items()}
    for k, name in enumerate(list(model.names)):
        model.names[k] = original.get(name, name)
    for frame in model.frames:
        if frame.type in (pin.FrameType.JOINT, pin.FrameType.FIXED_JOINT):
            frame.name = original.get(frame.name, frame.name)
    check_complete(model, urdf)
    _write_ranges(model, urdf)
    model.gravity.linear = np.array(gravity)
    return model


def _write_ranges(model: pin.Model, urdf: Urdf) -> None:
    """The URDF's position limits, infinite where they are not known."""
    lower, upper = np.array(model.lowerPositionLimit), np.array(model.upperPositionLimit)
    for name in urdf.moving:
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 1:
            low, high = position_range(urdf.joints[name].element)
            low, high = (np.nan, np.nan) if low > high else (low, high)  # swapped, and known from elsewhere
            lower[joint.idx_q], upper[joint.idx_q] = np.nan_to_num(low, nan=-np.inf), np.nan_to_num(high, nan=np.inf)
    model.lowerPositionLimit, model.upperPositionLimit = lower, upper
