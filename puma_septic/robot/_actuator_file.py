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
from puma_septic.robot._components import Limits, Payload
from puma_septic.robot._toml_text import read_toml, table
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
    links : dict of str to dict
        By link name what its inertia is instead of the URDF's, any of "mass" (kg), "com" (in the link's frame, m) and
        "inertia" (3 by 3, about the centre of mass, link axes, kg m^2).
    joint_origins : dict of str to ndarray, shape (3,)
        Position of a joint in its parent link, m, instead of the URDF's.
    """

    name: str
    notes: tuple[str, ...]
    drivetrains: dict[str, Drivetrain]
    links: dict[str, dict[str, Any]]
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

    def parameter_set(self, name: str | None, joint_names: Sequence[str]) -> ParameterSet:
        """The named set (None: the file's default) for some of these joints; what it does not tell is unknown.

        Raises
        ------
        InputError
            For an unknown set, with the valid names.
        ModelError
            For a joint that the arm does not have, or a value that is not a valid one.
        """
        if not self.parameters and name is None:
            return ParameterSet(name="", notes=(), drivetrains={}, links={}, joint_origins={})
        chosen = checked_choice(f"parameters of {self.path.name}", name or self.default_parameters, self.parameters)
        where = f"{self.path}, [parameters.{chosen}]"
        data = table(self.parameters[chosen], where, ("source", "note", "joints", "links", "origins"))
        source = _text(data, "source", where)
        note = _text(data, "note", where)
        drives = table(data.get("joints", {}), f"{where} joints", joint_names, kind="joint")
        return ParameterSet(
            name=chosen,
            notes=(f"parameters {chosen!r}: {source}", *([note] if note else [])),
            drivetrains={
                joint: _drivetrain(drive, f"{where} joint {joint!r}", source) for joint, drive in drives.items()
            },
            links=_links(data.get("links", {}), f"{where} links"),
            joint_origins=_vectors(data.get("origins", {}), "xyz", f"{where} origins"),
        )

    def known_ranges(self, name: str | None) -> list[str]:
        """Joints of which the named set of limits (None: the file's default) has the positions."""
        given = self.limits.get(name or self.default_limits or "", {})
        positions = given.get("position", {}) if isinstance(given, dict) else {}
        return list(positions) if isinstance(positions, dict) else []

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
    limits = table(data.get("limits", {}), f"{path}, [limits]")
    if not parameters and not limits:
        raise ModelError(
            f"{path}: neither drives nor limits; expected a table [parameters.NAME.joints.JOINT] or [limits.NAME]"
        )
    return ActuatorFile(
        path=path,
        tool=_text(data, "tool", str(path)) or None,
        default_parameters=_default(data, "parameters", parameters, path) if parameters else "",
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
    if "rotor_inertia" in data and "armature" in data:
        raise ModelError(
            f"{where}: rotor_inertia (motor side) and armature (joint side) are given; one of them is meant"
        )
    ratio, rotor, armature, viscous = (
        float(_numbers(data[key], f"{where} {key}", ())) if key in data else np.nan
        for key in ("gear_ratio", "rotor_inertia", "armature", "viscous_friction")
    )
    if ratio == 0.0:
        raise ModelError(f"{where}: gear_ratio = 0: the ratio of motor speed to joint speed cannot be zero")
    try:
        actuator = Actuator(
            gear_ratio=ratio,
            rotor_inertia=armature / ratio**2 if np.isnan(rotor) else rotor,
            viscous_friction=viscous,
            coulomb_friction=_numbers(data["coulomb_friction"], f"{where} coulomb_friction", (2,))
            if "coulomb_friction" in data
            else np.full(2, np.nan),
            source=source,
        )
        at_joint = armature if np.isnan(ratio) else np.nan
        return replace(actuator.drivetrain, measured_friction=_friction(data, actuator, where), armature=at_joint)
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


def _links(value: object, where: str) -> dict[str, dict[str, Any]]:
    """Tables ``NAME = {mass = ..., com = [x, y, z], inertia = [[...], [...], [...]]}``, checked as a body's."""
    shapes: dict[str, tuple[int, ...]] = {"mass": (), "com": (3,), "inertia": (3, 3)}
    result = {}
    for name, entry in table(value, where).items():
        given = table(entry, f"{where}.{name}", tuple(shapes))
        values = {key: _numbers(item, f"{where}.{name} {key}", shapes[key]) for key, item in given.items()}
        try:
            Payload(**({"mass": 0.0} | {key: float(v) if v.ndim == 0 else v for key, v in values.items()}))  # type: ignore[arg-type]
        except InputError as error:
            raise ModelError(f"{where}.{name}: {error}") from error
        result[name] = values
    return result


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
    items = _flat(value)
    if not all(isinstance(item, (int, float)) and not isinstance(item, bool) for item in items):
        raise ModelError(f"{where}: expected {'numbers' if shape else 'a number'}, got {value!r}")
    try:
        return checked_array(where, value, shape)  # type: ignore[arg-type]
    except InputError as error:
        raise ModelError(str(error)) from error


def _flat(value: object) -> list[object]:
    return [item for part in value for item in _flat(part)] if isinstance(value, list) else [value]


def _text(data: Mapping[str, Any], key: str, where: str) -> str:
    value = data.get(key, "")
    if not isinstance(value, str):
        raise ModelError(f"{where}: {key} = {value!r} is not text")
    return value
