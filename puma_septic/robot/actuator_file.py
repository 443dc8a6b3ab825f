"""The actuator file (TOML): named sets of drive parameters and of limits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, final

import numpy as np

from puma_septic.drives import Drivetrain
from puma_septic.errors import InputError, ModelError
from puma_septic.friction import Friction
from puma_septic.quantities import MAGNITUDES, QUANTITIES
from puma_septic.robot._actuator import FRICTION_KEYS, Actuator
from puma_septic.robot.toml_text import read_toml, table
from puma_septic.robot.values import Limits
from puma_septic.validation import Array, checked_array, checked_choice

__all__ = ["ActuatorFile", "ParameterSet", "read_actuator_file"]

DRIVE_KEYS = ("gear_ratio", "rotor_inertia", "armature", "viscous_friction", "coulomb_friction", *FRICTION_KEYS)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ParameterSet:
    """One named set of drive parameters, with what it changes in the URDF.

    Attributes
    ----------
    name : str
    notes : tuple of str
    drivetrains : dict of str to Drivetrain
        By joint name.
    link_coms : dict of str to ndarray, shape (3,)
        Centre of mass of a link in the link's frame, m, instead of the URDF's.
    joint_origins : dict of str to ndarray, shape (3,)
        Position of a joint in its parent link, m, instead of the URDF's.
    """

    name: str
    notes: tuple[str, ...]
    drivetrains: dict[str, Drivetrain]
    link_coms: dict[str, Array]
    joint_origins: dict[str, Array]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ActuatorFile:
    """A parsed actuator file; its sets are checked against the arm when they are taken from it."""

    path: Path
    tool: str | None
    default_parameters: str
    default_limits: str | None
    parameters: dict[str, Any]
    limits: dict[str, Any]

    def parameter_set(self, name: str | None, joint_names: Sequence[str], locked: Iterable[str] = ()) -> ParameterSet:
        """The named set (None: the file's default) for exactly these joints; it may have locked ones as well.

        Raises
        ------
        InputError
            For an unknown set, with the valid names.
        ModelError
            For a joint that the set lacks or that the arm does not have, or a value that is none.
        """
        chosen = checked_choice(f"parameters of {self.path.name}", name or self.default_parameters, self.parameters)
        where = f"{self.path}, [parameters.{chosen}]"
        data = table(self.parameters[chosen], where, ("source", "note", "joints", "links", "origins"))
        source = _text(data, "source", where)
        note = _text(data, "note", where)
        drives = table(data.get("joints", {}), f"{where} joints", [*joint_names, *locked], kind="joint")
        for joint in joint_names:
            if joint not in drives:
                raise ModelError(
                    f"{where}: joint {joint!r} of the URDF has no entry; given: {', '.join(drives) or 'none'}"
                )
        return ParameterSet(
            name=chosen,
            notes=(f"parameters {chosen!r}: {source}", *([note] if note else [])),
            drivetrains={
                joint: _drivetrain(drives[joint], f"{where} joint {joint!r}", source) for joint in joint_names
            },
            link_coms=_vectors(data.get("links", {}), "com", f"{where} links"),
            joint_origins=_vectors(data.get("origins", {}), "xyz", f"{where} origins"),
        )

    def limit_set(
        self, name: str | None, urdf: Limits, joint_names: Sequence[str], locked: Iterable[str] = ()
    ) -> Limits:
        """The named set (None: the file's default); positions are the URDF's unless the set has them.

        A quantity or joint that the set does not name is unknown (NaN).
        """
        if not self.limits and name is None:
            return urdf
        chosen = checked_choice(f"limits of {self.path.name}", name or self.default_limits or "", self.limits)
        where = f"{self.path}, [limits.{chosen}]"
        data = table(self.limits[chosen], where, ("source", "note", *QUANTITIES))
        values = {key: np.full(len(joint_names), np.nan) for key in MAGNITUDES}
        position = np.array(urdf.position)
        for key in QUANTITIES:
            given = table(data.get(key, {}), f"{where} {key}", [*joint_names, *locked], kind="joint")
            for joint, value in given.items():
                if joint not in joint_names:
                    continue
                if key == "position":
                    position[joint_names.index(joint)] = _numbers(value, f"{where} position of joint {joint!r}", (2,))
                else:
                    values[key][joint_names.index(joint)] = _numbers(value, f"{where} {key} of joint {joint!r}", ())
        try:
            return Limits(position=position, source=f"{chosen}: {_text(data, 'source', where)}", **values)
        except InputError as error:
            raise ModelError(f"{where}: {error}") from error


def read_actuator_file(path: Path, robot_name: str) -> ActuatorFile:
    """Read an actuator file (schema 1) written for the robot of this name.

    Raises
    ------
    ModelError
        For a missing, oversized or malformed file, an unknown key, or another robot's file.
    """
    data = read_toml(path, "actuator file")
    known = ("schema", "robot", "tool", "default_parameters", "default_limits", "parameters", "limits")
    table(data, str(path), known)
    if data.get("schema") != 1:
        raise ModelError(f"{path}: schema = {data.get('schema')!r}, expected schema = 1")
    if _text(data, "robot", str(path)) not in ("", robot_name):
        raise ModelError(f"{path}: written for robot {data['robot']!r}, but the URDF's is {robot_name!r}")
    parameters = table(data.get("parameters", {}), f"{path}, [parameters]")
    if not parameters:
        raise ModelError(f"{path}: no parameter set; expected a table [parameters.NAME.joints.JOINT]")
    limits = table(data.get("limits", {}), f"{path}, [limits]")
    return ActuatorFile(
        path=path,
        tool=_text(data, "tool", str(path)) or None,
        default_parameters=_default(data, "parameters", parameters, path),
        default_limits=_default(data, "limits", limits, path) if limits else None,
        parameters=parameters,
        limits=limits,
    )


def _default(data: Mapping[str, Any], kind: str, sets: Mapping[str, Any], path: Path) -> str:
    """The set that is taken when none is asked for: the named one, else the first."""
    name = _text(data, f"default_{kind}", str(path)) or next(iter(sets))
    if name not in sets:
        raise ModelError(f"{path}: default_{kind} = {name!r} is not among its sets: {', '.join(sets)}")
    return name


def _drivetrain(value: object, where: str, source: str) -> Drivetrain:
    data = table(value, where, DRIVE_KEYS)
    if "gear_ratio" not in data:
        raise ModelError(f"{where}: gear_ratio is missing")
    if ("rotor_inertia" in data) == ("armature" in data):
        raise ModelError(f"{where}: exactly one of rotor_inertia (motor side) and armature (joint side) must be given")
    ratio = float(_numbers(data["gear_ratio"], f"{where} gear_ratio", ()))
    if ratio == 0.0:
        raise ModelError(f"{where}: gear_ratio = 0: the ratio of motor speed to joint speed cannot be zero")
    inertia = float(_numbers(data.get("rotor_inertia", data.get("armature")), f"{where} rotor inertia", ()))
    try:
        actuator = Actuator(
            gear_ratio=ratio,
            rotor_inertia=inertia if "rotor_inertia" in data else inertia / ratio**2,
            viscous_friction=float(_numbers(data["viscous_friction"], f"{where} viscous_friction", ()))
            if "viscous_friction" in data
            else np.nan,
            coulomb_friction=_numbers(data["coulomb_friction"], f"{where} coulomb_friction", (2,))
            if "coulomb_friction" in data
            else np.full(2, np.nan),
            source=source,
        )
        return replace(actuator.drivetrain, measured_friction=_friction(data, actuator, where))
    except InputError as error:
        raise ModelError(f"{where}: {error}") from error


def _friction(data: Mapping[str, Any], actuator: Actuator, where: str) -> Friction:
    """The actuator's law with the optional terms that the joint's table has."""
    law = actuator.drivetrain.friction
    terms: dict[str, Any] = {
        name: _numbers(data[key], f"{where} {key}", np.shape(getattr(law, name)))
        for key, name in FRICTION_KEYS.items()
        if key in data
    }
    return replace(law, **terms)


def _vectors(value: object, key: str, where: str) -> dict[str, Array]:
    """Tables ``NAME = {key = [x, y, z]}`` as vectors by name."""
    result = {}
    for name, entry in table(value, where).items():
        if key not in table(entry, f"{where}.{name}", (key,)):
            raise ModelError(f"{where}.{name}: {key} is missing")
        result[name] = _numbers(entry[key], f"{where}.{name} {key}", (3,))
    return result


def _numbers(value: object, where: str, shape: tuple[int, ...]) -> Array:
    """Finite numbers of this shape; TOML also knows booleans, dates and text, which NumPy would convert."""
    items = value if isinstance(value, list) else [value]
    if not all(isinstance(item, (int, float)) and not isinstance(item, bool) for item in items):
        raise ModelError(f"{where}: expected {'numbers' if shape else 'a number'}, got {value!r}")
    try:
        return checked_array(where, value, shape)  # type: ignore[arg-type]
    except InputError as error:
        raise ModelError(str(error)) from error


def _text(data: Mapping[str, Any], key: str, where: str) -> str:
    value = data.get(key, "")
    if not isinstance(value, str):
        raise ModelError(f"{where}: {key} = {value!r} is not text")
    return value
