"""Drivetrains of a robot: its own, from its actuators and limits, and what a file adds to them."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from puma_septic.drives._friction import Friction
from puma_septic.drives.drivetrain import Drivetrain
from puma_septic.drives.values import Drive, Gearbox, Motor
from puma_septic.errors import InputError, ModelError
from puma_septic.robot import Robot
from puma_septic.robot.toml_text import read_toml, table

__all__ = ["load_drivetrains", "own_drivetrains"]

_PARTS: Final[dict[str, Any]] = {"motor": Motor, "gearbox": Gearbox, "drive": Drive}
# What the robot itself knows: it must not be told twice.
_FROM_ROBOT: Final[dict[str, tuple[str, ...]]] = {
    "motor": ("rotor_inertia", "viscous_friction", "coulomb_friction"),
    "gearbox": ("ratio", "efficiency", "backward_efficiency", "no_load_torque"),
    "drive": (),
}


def own_drivetrains(robot: Robot) -> tuple[Drivetrain, ...]:
    """The drives that the robot has, as far as its actuators and limits tell.

    Gear ratio, rotor inertia and friction are the actuator's, the friction taken as measured through the gears; the
    effort limit is that of the whole actuator at the joint, and the velocity limit times the ratio the motor's speed
    limit. All else is unknown.

    Raises
    ------
    InputError
        For a joint whose gear ratio is not known.

    Examples
    --------
    >>> import puma_septic as ps
    >>> own_drivetrains(ps.load_robot())[1].max_effort
    97.0
    """
    trains = []
    for name, actuator, effort, velocity in zip(
        robot.joint_names, robot.actuators, robot.limits.effort, robot.limits.velocity, strict=True
    ):
        if np.isnan(actuator.gear_ratio):
            raise InputError(
                f"joint {name!r}: its gear ratio is not known, so nothing can be said of its motor; give the robot an"
                " actuator file, or drivetrains"
            )
        trains.append(
            Drivetrain(
                motor=Motor(
                    name=f"{robot.name} {name}",
                    rotor_inertia=actuator.rotor_inertia,
                    max_speed=float(velocity) * abs(actuator.gear_ratio),
                    source=actuator.source,
                ),
                gearbox=Gearbox(ratio=actuator.gear_ratio, name=f"{robot.name} {name}", source=actuator.source),
                measured_friction=Friction(viscous=actuator.viscous_friction, coulomb=actuator.coulomb_friction),
                max_effort=float(effort),
            )
        )
    return tuple(trains)


def load_drivetrains(robot: Robot, path: str | Path | None = None) -> tuple[Drivetrain, ...]:
    """The robot's own drives, with the values that a file adds.

    Parameters
    ----------
    robot : Robot
    path : str or Path, optional
        TOML with tables ``[joints.NAME.motor]``, ``.gearbox`` and ``.drive``, whose keys are those of `Motor`,
        `Gearbox` and `Drive` and whose values are tables ``{ value = ..., source = "..." }``. The built-in file of the
        PUMA 560 by default.

    Raises
    ------
    ModelError
        For a file that is missing or malformed, with the joint and key.
    InputError
        For a joint whose gear ratio is not known, or a robot that has no built-in file.

    Examples
    --------
    >>> import puma_septic as ps
    >>> load_drivetrains(ps.load_robot())[1].motor.torque_constant
    0.228
    """
    file = _built_in(robot) if path is None else Path(path)
    data = table(read_toml(file, "drives file"), str(file), ("schema", "robot", "joints"))
    schema = data.get("schema")
    if isinstance(schema, bool) or schema != 1 or data.get("robot") != robot.name:
        raise ModelError(
            f"{file}: expected schema = 1 and robot = {robot.name!r}, got {schema!r} and {data.get('robot')!r}"
        )
    joints = table(data.get("joints", {}), f"{file}, [joints]", robot.joint_names, kind="joint")
    return tuple(
        _completed(train, joints.get(name, {}), f"{file}, joint {name!r}")
        for name, train in zip(robot.joint_names, own_drivetrains(robot), strict=True)
    )


def _built_in(robot: Robot) -> Path:
    """`urdf` lies inside the installed package, or beside it in the source tree."""
    package = Path(__file__).resolve().parents[1]
    folder = package / "urdf" if (package / "urdf").is_dir() else package.parent / "urdf"
    file = folder / f"{robot.name}_drives.toml"
    if not file.is_file():
        raise InputError(f"robot {robot.name!r} has no built-in drives file; give a path, or use own_drivetrains")
    return file


def _completed(train: Drivetrain, parts: object, where: str) -> Drivetrain:
    """The drivetrain with the values of a joint's table written over its own."""
    changed: dict[str, Any] = {}
    for part, entries in table(parts, where, tuple(_PARTS)).items():
        valid = tuple(f.name for f in fields(_PARTS[part]) if f.name not in (*_FROM_ROBOT[part], "source"))
        own, values, sources = getattr(train, part), {}, []
        for key, entry in table(entries, f"{where}, {part}", valid).items():
            values[key], source = _sourced(entry, f"{where}, {part} {key}")
            sources.append(f"{key}: {source}")
        try:
            changed[part] = replace(own, **values, source="; ".join(filter(None, [own.source, *sources])))
        except InputError as error:
            raise ModelError(f"{where}, {part}: {error}") from error
    return replace(train, **changed)


def _sourced(entry: object, where: str) -> tuple[Any, str]:
    """A value and where it comes from."""
    pair = table(entry, where, ("value", "source"))
    if set(pair) != {"value", "source"} or not isinstance(pair["source"], str):
        raise ModelError(f'{where}: expected {{ value = ..., source = "..." }}, got {entry!r}')
    return pair["value"], pair["source"]
