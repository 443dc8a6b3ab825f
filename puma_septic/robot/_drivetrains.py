"""Drivetrains of a robot: its own, with its limits, and what a file adds to them."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from puma_septic.drives import Drive, Drivetrain, Gearbox, LinearStage, Motor
from puma_septic.errors import InputError, ModelError
from puma_septic.files import checked_path
from puma_septic.robot._model import Robot
from puma_septic.robot._names import data_folder
from puma_septic.robot._toml_text import read_toml, table
from puma_septic.validation import checked_kind

__all__ = ["load_drivetrains", "load_electronics", "own_drivetrains"]

_PARTS: Final[dict[str, Any]] = {"motor": Motor, "gearbox": Gearbox, "drive": Drive, "stage": LinearStage}
# What the robot itself may know: it must then not be told twice.
_FROM_ROBOT: Final[dict[str, tuple[str, ...]]] = {
    "motor": ("rotor_inertia", "viscous_friction", "coulomb_friction"),
    "gearbox": ("ratio", "efficiency", "backward_efficiency", "no_load_torque"),
    "drive": (),
    "stage": (),
}


def own_drivetrains(robot: Robot) -> tuple[Drivetrain, ...]:
    """The drivetrains that the robot carries, with what its limits tell of them.

    Where their own is not known, the effort limit is that of the whole actuator at the joint, and the velocity limit
    times the ratio the motor's speed limit. All else is as the robot has it.

    Returns
    -------
    tuple of Drivetrain

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
    checked_kind("robot", robot, Robot)
    return tuple(_limited(robot, j, train) for j, train in enumerate(robot.drivetrains))


def _limited(robot: Robot, j: int, train: Drivetrain) -> Drivetrain:
    """A drivetrain with the joint's limits, and a name, where it has none of its own."""
    joint = robot.joint_names[j]
    if np.isnan(train.ratio):
        raise InputError(
            f"joint {joint!r}: its gear ratio is not known, so its motor cannot be assessed; give it by"
            f" actuators=... or drivetrains=..., or in a drives file: [joints.{joint}.gearbox] ratio"
        )
    motor, gearbox, name = train.motor, train.gearbox, f"{robot.name} {joint}"
    reduction = 1.0 if train.stage is None else train.stage.reduction
    fastest = float(robot.limits.velocity[j]) * reduction * train.ratio
    return replace(
        train,
        motor=replace(motor, name=motor.name or name, max_speed=_first_known(motor.max_speed, fastest)),
        gearbox=replace(gearbox, name=gearbox.name or name),
        max_effort=_first_known(train.max_effort, float(robot.limits.effort[j])),
    )


def _first_known(value: float, other: float) -> float:
    return other if np.isnan(value) else value


def load_drivetrains(robot: Robot, path: str | Path | None = None) -> tuple[Drivetrain, ...]:
    """The robot's own drives, with the values that a file adds.

    Parameters
    ----------
    robot : Robot
    path : str or Path, optional
        TOML with tables ``[joints.NAME.motor]``, ``.gearbox``, ``.drive`` and, of a sliding joint, ``.stage``. Their
        keys are those of `Motor`, `Gearbox`, `Drive` and `LinearStage`, their values tables ``{ value = ..., source =
        "..." }``. What the robot knows itself, such as its gear ratios, is not told again; of a robot that is only a
        URDF the file tells it. By default the file that comes with a robot of this package; without one, what the robot
        itself tells.

    Returns
    -------
    tuple[Drivetrain, ...]

    Raises
    ------
    ModelError
        For a file that is missing or malformed, with the joint and key.
    InputError
        For a joint whose gear ratio is not known.

    Examples
    --------
    >>> import puma_septic as ps
    >>> load_drivetrains(ps.load_robot())[1].motor.torque_constant
    0.228
    """
    name = checked_kind("robot", robot, Robot).name
    file = data_folder() / f"{name}_drives.toml" if path is None else checked_path(path, "drives file")
    if path is None and not file.is_file():
        return own_drivetrains(robot)
    return tuple(_limited(robot, j, train) for j, train in enumerate(_told(robot, file)))


def load_electronics(robot: Robot, path: str | Path) -> tuple[Drivetrain, ...]:
    """What the joints have whatever the motors and gears: drive and stage tables of a file, see `load_drivetrains`.

    Returns
    -------
    tuple[Drivetrain, ...]
        One per joint, of no motor and no gears.

    Raises
    ------
    ModelError
        For a file that is missing or malformed, with the joint and key.
    """
    told = _told(robot, checked_path(path, "drives file"))
    return tuple(Drivetrain(gearbox=Gearbox(ratio=1.0), drive=train.drive, stage=train.stage) for train in told)


def _told(robot: Robot, file: Path) -> tuple[Drivetrain, ...]:
    """The robot's own drivetrains with what a file adds."""
    data = table(read_toml(file, "drives file"), str(file), ("schema", "robot", "joints"))
    schema = data.get("schema")
    if isinstance(schema, bool) or schema != 1 or data.get("robot") != robot.name:
        raise ModelError(
            f"{file}: expected schema = 1 and robot = {robot.name!r}, got {schema!r} and {data.get('robot')!r}"
        )
    joints = table(data.get("joints", {}), f"{file}, [joints]", robot.joint_names, kind="joint")
    return tuple(
        _completed(train, joints.get(name, {}), f"{file}, joint {name!r}")
        for name, train in zip(robot.joint_names, robot.drivetrains, strict=True)
    )


def _open_keys(train: Drivetrain, part: str) -> tuple[str, ...]:
    """What a file may tell of a part: all that the robot does not know."""
    own = getattr(train, part)
    names = [f.name for f in fields(_PARTS[part]) if f.name != "source"]
    losses = (
        () if train.measured_friction is None else tuple(k for ks in _FROM_ROBOT.values() for k in ks if k != "ratio")
    )
    told = [name for name in _FROM_ROBOT[part] if name in losses or not np.isnan(getattr(own, name))]
    return tuple(name for name in names if name not in told)


def _completed(train: Drivetrain, parts: object, where: str) -> Drivetrain:
    """The drivetrain with the values of a joint's table written over its own."""
    changed: dict[str, Any] = {}
    for part, entries in table(parts, where, tuple(_PARTS)).items():
        valid = _open_keys(train, part)
        own, values, sources = getattr(train, part), {}, []
        for key, entry in table(entries, f"{where}, {part}", valid).items():
            values[key], source = _sourced(entry, f"{where}, {part} {key}")
            sources.append(f"{key}: {source}")
        source = "; ".join(filter(None, ["" if own is None else own.source, *sources]))
        try:
            changed[part] = (
                _PARTS[part](**values, source=source) if own is None else replace(own, **values, source=source)
            )
        except (InputError, TypeError) as error:
            raise ModelError(f"{where}, {part}: {error}") from error
    return replace(train, **changed)


def _sourced(entry: object, where: str) -> tuple[Any, str]:
    """A value and where it comes from."""
    pair = table(entry, where, ("value", "source"))
    if set(pair) != {"value", "source"} or not isinstance(pair["source"], str):
        raise ModelError(f'{where}: expected {{ value = ..., source = "..." }}, got {entry!r}')
    return pair["value"], pair["source"]
