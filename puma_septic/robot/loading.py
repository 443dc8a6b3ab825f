"""load_robot: from a URDF and an actuator file to a Robot."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from puma_septic.drives import Drivetrain
from puma_septic.errors import InputError, ModelError, did_you_mean
from puma_septic.robot.actuator_file import ActuatorFile, ParameterSet, read_actuator_file
from puma_septic.robot.meshes import confined_geometry
from puma_septic.robot.model import Robot
from puma_septic.robot.model_checks import check_complete, check_inertia, massless_notes
from puma_septic.robot.urdf_checks import Urdf, checked_urdf
from puma_septic.robot.urdf_schema import vector
from puma_septic.robot.urdf_text import read_urdf
from puma_septic.robot.values import Limits
from puma_septic.validation import Array, checked_array, checked_choice, checked_number

__all__ = ["load_robot", "robot_files"]

BUILT_IN = ("puma560",)


def load_robot(
    source: str | Path = "puma560",
    *,
    parameters: str | None = None,
    limits: str | None = None,
    actuators: str | Path | None = None,
    tool: str | None = None,
    package_dirs: Sequence[str | Path] = (),
    locked: Mapping[str, float] | None = None,
    gravity: ArrayLike = (0.0, 0.0, -9.81),
) -> Robot:
    """Load the built-in PUMA 560, or any URDF with an optional actuator file.

    The URDF is checked before Pinocchio reads it, because Pinocchio drops an inertia with a misspelt number,
    loses a joint in a closed loop and takes a misspelt origin for zero without a word.

    Parameters
    ----------
    source : str or Path
        "puma560" or the path of a .urdf file.
    parameters, limits : str, optional
        Named sets of the actuator file; its defaults otherwise. PUMA: parameters "rtb" or "akb", limits
        "corke", "akb" or "benchmark".
    actuators : str or Path, optional
        Actuator file (TOML). Without it, rotor inertia and friction are unknown (NaN, not in the torques),
        the limits are the URDF's.
    tool : str, optional
        Frame that is positioned and that carries payload and wrench; the actuator file's otherwise ("flange"
        for the PUMA), else the end of the longest chain, which a note names.
    package_dirs : sequence of str or Path
        Folders that hold the packages of ``package://`` mesh names. Meshes are opened from these, from the
        URDF's folder and from the package that it lies in, from nowhere else.
    locked : mapping of str to float, optional
        Joints to fix, with their position in rad (m for prismatic joints), such as a gripper's fingers.
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
    down = checked_array("gravity", gravity, (3,), unit="m/s^2")
    positions = {name: checked_number(f"locked[{name!r}]", x) for name, x in (locked or {}).items()}
    urdf_path, actuator_path = _paths(source, actuators)
    urdf = checked_urdf(read_urdf(urdf_path), positions)
    file = None if actuator_path is None else read_actuator_file(actuator_path, urdf.name)
    drives = _parameter_set(file, parameters, urdf, positions)
    _apply(drives, urdf, actuator_path)
    for name, position in positions.items():
        _lock(urdf, name, position)
    model = _pinocchio_model(urdf, down)
    geometry, missing_meshes = confined_geometry(urdf, package_dirs)
    chosen_limits, limit_notes = _limits(file, limits, urdf, positions)
    chosen_tool, tool_notes = _tool(tool, file, urdf)
    robot = Robot(
        name=urdf.name,
        bare_model=model,
        joint_names=urdf.moving,
        tool=chosen_tool,
        drivetrains=tuple(drives.drivetrains[name] for name in urdf.moving),
        limits=chosen_limits,
        geometry=geometry,
        missing_meshes=missing_meshes,
        notes=(*drives.notes, *urdf.notes, *massless_notes(model, urdf), *limit_notes, *tool_notes),
    )
    return replace(robot, missing_inertia=check_inertia(model, robot.model.armature, urdf_path))


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


def _paths(source: str | Path, actuators: str | Path | None) -> tuple[Path, Path | None]:
    """Files of a robot; a plain name is a built-in one."""
    given = None if actuators is None else Path(actuators)
    if isinstance(source, str):
        if source.lstrip().startswith("<"):
            raise InputError("source: this is XML text; write it to a .urdf file and pass its path")
        if source in BUILT_IN:
            folder = _data_folder()
            return folder / f"{source}.urdf", given or folder / f"{source}_actuators.toml"
        if Path(source).name == source and not source.endswith(".urdf"):
            names = ", ".join(map(repr, BUILT_IN))
            meant = did_you_mean([source], BUILT_IN)
            raise InputError(f"unknown robot {source!r}; valid: {names}, or the path of a .urdf file{meant}")
    return Path(source), given


def _data_folder() -> Path:
    """`urdf` lies inside the installed package, or beside it in the source tree."""
    package = Path(__file__).resolve().parents[1]
    inside = package / "urdf"
    return inside if inside.is_dir() else package.parent / "urdf"


def _parameter_set(file: ActuatorFile | None, name: str | None, urdf: Urdf, locked: Iterable[str]) -> ParameterSet:
    if file is not None:
        return file.parameter_set(name, urdf.moving, locked)
    if name is not None:
        raise InputError(f"parameters {name!r}: there are no named sets without an actuator file (actuators=...)")
    note = "no actuator file: rotor inertia and friction are unknown, not in the torques; <dynamics> is not used"
    return ParameterSet(
        name="",
        notes=(note,),
        drivetrains={joint: Drivetrain() for joint in urdf.moving},
        link_coms={},
        joint_origins={},
    )


def _limits(
    file: ActuatorFile | None, name: str | None, urdf: Urdf, locked: Iterable[str]
) -> tuple[Limits, tuple[str, ...]]:
    """The named set, else the actuator file's default, else the URDF's own with what is unknown there."""
    own, notes = _urdf_limits(urdf)
    if file is None and name is not None:
        raise InputError(f"limits {name!r}: there are no named sets without an actuator file (actuators=...)")
    chosen = own if file is None else file.limit_set(name, own, urdf.moving, locked)
    return chosen, notes if chosen is own else ()


def _apply(drives: ParameterSet, urdf: Urdf, path: Path | None) -> None:
    """Write a parameter set's centres of mass and joint origins into the tree."""
    inertials = {name: part for name, link in urdf.links.items() for part in link.findall("inertial")}
    joints = {name: joint.element for name, joint in urdf.joints.items()}
    for kind, elements, positions in (
        ("link (with <inertial>)", inertials, drives.link_coms),
        ("joint", joints, drives.joint_origins),
    ):
        for name, xyz in positions.items():
            if name not in elements:
                raise ModelError(f"{path}: unknown {kind} {name!r}; valid: {', '.join(elements)}")
            _set_origin(elements[name], xyz=xyz)


def _lock(urdf: Urdf, name: str, position: float) -> None:
    """Turn a joint into a fixed one at this position."""
    element = urdf.joints[name].element
    limit = element.find("limit")
    if limit is not None and element.get("type") != "continuous":
        lower, upper = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
        if not lower <= position <= upper:
            raise InputError(f"locked[{name!r}] = {position:g} is outside the joint's limits [{lower:g}, {upper:g}]")
    axis = vector(element.find("axis"), "xyz", (1.0, 0.0, 0.0))
    axis = axis / np.linalg.norm(axis)
    origin = element.find("origin")
    rotation = pin.rpy.rpyToMatrix(vector(origin, "rpy", (0.0, 0.0, 0.0)))
    translation = vector(origin, "xyz", (0.0, 0.0, 0.0))
    if element.get("type") == "prismatic":
        translation = translation + rotation @ axis * position
    else:
        rotation = rotation @ pin.AngleAxis(position, axis).matrix()
    _set_origin(element, xyz=translation, rpy=pin.rpy.matrixToRpy(rotation))
    element.set("type", "fixed")


def _set_origin(element: ET.Element, **values: Array) -> None:
    origin = element.find("origin")
    if origin is None:
        origin = ET.SubElement(element, "origin")
    for name, value in values.items():
        origin.set(name, " ".join(repr(float(x)) for x in value))


def _pinocchio_model(urdf: Urdf, gravity: Array) -> pin.Model:
    try:
        model = pin.buildModelFromXML(urdf.xml(("inertial",)))
    except (ValueError, RuntimeError) as error:
        raise ModelError(f"{urdf.text.path}: Pinocchio refuses this URDF: {str(error).strip()}") from error
    check_complete(model, urdf)
    model.gravity.linear = np.array(gravity)
    return model


def _urdf_limits(urdf: Urdf) -> tuple[Limits, tuple[str, ...]]:
    """Limits as the URDF has them; an effort or velocity of 0 is a placeholder, so unknown."""
    n = len(urdf.moving)
    values = {name: np.full(n, np.nan) for name in ("lower", "upper", "velocity", "effort")}
    notes = []
    for k, name in enumerate(urdf.moving):
        joint = urdf.joints[name]
        limit = joint.element.find("limit")
        given = {} if limit is None else {key: float(limit.get(key, "0")) for key in values}
        if joint.kind != "continuous":
            values["lower"][k], values["upper"][k] = given["lower"], given["upper"]
        for key in ("velocity", "effort"):
            values[key][k] = given.get(key, 0.0) or np.nan
            if np.isnan(values[key][k]):
                notes.append(f"joint {name!r}: the URDF gives no {key} limit (or 0): unknown")
    unknown = np.full(n, np.nan)
    limits = Limits(
        position=np.column_stack([values["lower"], values["upper"]]),
        velocity=values["velocity"],
        acceleration=unknown,
        jerk=unknown,
        effort=values["effort"],
        source=f"{urdf.text.path.name}: no acceleration or jerk limits in a URDF",
    )
    return limits, tuple(notes)


def _tool(tool: str | None, file: ActuatorFile | None, urdf: Urdf) -> tuple[str, tuple[str, ...]]:
    """The caller's tool frame, else the actuator file's, else the end of the longest chain."""
    chosen = tool if tool is not None else file.tool if file is not None else None
    if chosen is not None:
        return checked_choice("tool frame", chosen, [*urdf.links, *urdf.joints]), ()
    above = {joint.child: joint for joint in urdf.joints.values()}

    def length(link: str) -> tuple[int, int]:
        moving = joints = 0
        while link in above:
            moving, joints = moving + (above[link].kind != "fixed"), joints + 1
            link = above[link].parent
        return moving, joints

    ends = [link for link in urdf.links if all(joint.parent != link for joint in urdf.joints.values())]
    longest = max(map(length, ends))
    candidates = [link for link in ends if length(link) == longest]
    others = f" (as long: {', '.join(candidates[:-1])})" if len(candidates) > 1 else ""
    note = f"tool frame {candidates[-1]!r}: the last link of the longest chain{others}; pass tool= for another"
    return candidates[-1], (note,)
