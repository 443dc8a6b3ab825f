"""Arguments that commands share: numbers, tasks, robots, recordings, conditions. Standard library alone."""

from __future__ import annotations

import math
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

__all__ = [
    "CONDITIONS",
    "add_conditions",
    "add_dwell",
    "add_margin",
    "add_payload",
    "add_profile",
    "add_recording",
    "add_robot",
    "add_task",
    "asked_robot",
    "asked_task",
    "count",
    "finite",
    "in_reserve",
    "not_negative",
    "positive",
    "share",
    "with_margin",
]


def finite(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def not_negative(text: str) -> float:
    """A finite number from 0."""
    value = finite(text)
    if not value >= 0:
        raise ArgumentTypeError(f"{text} is negative")
    return value


def positive(text: str) -> float:
    """A finite number above 0."""
    value = finite(text)
    if not value > 0:
        raise ArgumentTypeError(f"{text} is not positive")
    return value


def share(text: str) -> float:
    """A number from 0 to 1."""
    value = finite(text)
    if not 0 <= value <= 1:
        raise ArgumentTypeError(f"{text} is not between 0 and 1")
    return value


def count(text: str) -> int:
    """A whole number from 1."""
    if not (text.isdecimal() and int(text) > 0):
        raise ArgumentTypeError(f"{text!r} is not a whole number from 1")
    return int(text)


# Options that mean nothing without --csv.
_RECORDING = ("columns", "units", "repeated", "smoothing", "resolution", "ends", "max_gap")


def add_recording(parser: ArgumentParser) -> None:
    """A CSV file instead of TASK, and how it is to be read."""
    group = parser.add_argument_group("recorded motion, instead of TASK")
    group.add_argument(
        "--csv", metavar="FILE", help="CSV file: a header, then rows with the time (s) and each joint position (rad, m)"
    )
    group.add_argument(
        "--columns",
        action="append",
        type=_columns,
        metavar="NAME=COLUMN,...",
        help="column of time, JOINT, JOINT.velocity, JOINT.effort or JOINT.current, with its unit in brackets:"
        " time=stamp[ms],joint1=q1[deg] (repeatable)",
    )
    group.add_argument(
        "--units", type=_list, metavar="UNIT,...", help="units of columns that state none: deg, ms, us, ns, mm, ..."
    )
    group.add_argument(
        "--repeated", choices=("refuse", "average"), help="rows with equal time stamps (default: refuse)"
    )
    group.add_argument(
        "--smoothing",
        type=_smoothing,
        metavar="auto|RAD",
        help="auto: smoothing from the noise of the samples; RAD: maximum RMS residual of a smoothing spline; omit to"
        " interpolate",
    )
    group.add_argument(
        "--resolution",
        type=positive,
        metavar="RAD",
        help="travel below which a joint is at rest (default: from the noise)",
    )
    group.add_argument(
        "--ends",
        choices=("auto", "rest", "moving"),
        help="whether the motion starts and ends at rest (default: auto, from the samples)",
    )
    group.add_argument(
        "--max-gap", type=positive, metavar="S", help="maximum sampling gap (default: 10 times the median)"
    )


def _columns(text: str) -> dict[str, str]:
    pairs = [part.partition("=") for part in text.split(",")]
    if not all(name.strip() and equals and column.strip() for name, equals, column in pairs):
        raise ArgumentTypeError(f"{text!r} is not NAME=COLUMN,...")
    return {name.strip(): column.strip() for name, _, column in pairs}


def _list(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]


def _smoothing(text: str) -> str | float:
    return "auto" if text == "auto" else positive(text)


# Keys of a task's section of conditions that are one number, and what they are.
_NUMBERS = {
    "cycles_per_minute": (positive, "N", "cycle rate: what the moves leave of the time is rest"),
    "ambient_celsius": (finite, "C", "temperature of the surroundings (default: 40)"),
    "altitude": (not_negative, "M", "above sea level"),
    "bus_voltage": (positive, "V", "that reaches the motors"),
    "continuous_current": (positive, "A", "of each drive, in the measure of the torque constants"),
    "peak_current": (positive, "A", "of each drive, for a short time"),
    "continuous_power": (positive, "W", "that each drive can deliver, on average"),
    "peak_power": (positive, "W", "that each drive can deliver for a short time"),
    "peak_regenerated_power": (positive, "W", "that each drive can take back at most"),
    "brake_resistor_power": (positive, "W", "that each brake resistor bears"),
    "momentary_torque": (positive, "NM", "of a collision, at the gearboxes' outputs"),
    "emergency_stops": (positive, "N", "collisions or emergency stops in the life of gearboxes and brakes"),
    "emergency_duration": (positive, "S", "how long one of them lasts"),
    "required_life_hours": (positive, "H", "that the gearboxes are to last"),
    "max_inertia_ratio": (positive, "X", "largest ratio of load to rotor inertia that is accepted"),
}
CONDITIONS = (*_NUMBERS, "brake_at_rest", "with_brake", "stages", "margins", "own_masses")
"""The options that replace what a task's section `conditions` says."""


def add_conditions(parser: ArgumentParser) -> None:
    """An option for each condition."""
    group = parser.add_argument_group("conditions", "in place of those of the task")
    for name, (kind, metavar, meaning) in _NUMBERS.items():
        group.add_argument(f"--{name.replace('_', '-')}", type=kind, metavar=metavar, help=meaning)
    group.add_argument(
        "--brake-at-rest", action="store_true", default=None, help="brakes hold the arm while it rests, not the motors"
    )
    group.add_argument(
        "--with-brake", action="store_true", default=None, help="motors with their holding brakes, used at rest or not"
    )
    group.add_argument(
        "--stage",
        dest="stages",
        action="append",
        type=_stage,
        metavar="JOINT:KEY=VALUE,...",
        help="screw, rack or belt of a sliding joint, in SI units: lift:kind=screw,travel_per_turn=0.02,efficiency=0.9"
        " (repeatable)",
    )
    group.add_argument(
        "--margin",
        dest="margins",
        action="append",
        type=_margin,
        metavar="SHARE",
        help="what must be left of each limit, such as 0.2; or of one check, 'gearbox life=0.1' (repeatable)",
    )
    group.add_argument(
        "--supply-current",
        type=positive,
        metavar="A",
        help="that the bus of the whole arm can deliver, at --bus-voltage",
    )
    group.add_argument("--supply-power", type=positive, metavar="W", help="that the bus of the whole arm can deliver")
    group.add_argument(
        "--own-masses", nargs="+", type=not_negative, metavar="KG",
        help="with --masses: of the drives that the robot's model includes already, one for each joint",
    )  # fmt: skip


def _stage(text: str) -> tuple[str, dict[str, str | float]]:
    joint, colon, rest = text.partition(":")
    values: dict[str, str | float] = {}
    for part in rest.split(","):
        key, equals, value = (one.strip() for one in part.partition("="))
        if not (joint.strip() and colon and key and equals and value):
            raise ArgumentTypeError(f"{text!r} is not JOINT:KEY=VALUE,...")
        values[key] = value if key in ("kind", "name") else finite(value)
    return joint.strip(), values


def _margin(text: str) -> tuple[str, float]:
    name, equals, value = text.rpartition("=")
    if equals and not name.strip():
        raise ArgumentTypeError(f"{text!r} is not SHARE or CHECK=SHARE")
    return (name.strip() or "all", share(value))


if TYPE_CHECKING:
    from puma_septic.robot import Robot
    from puma_septic.task import ResolvedTask, Task


def add_task(parser: ArgumentParser) -> None:
    """The task and what replaces parts of it, the same for every command that takes one."""
    parser.add_argument(
        "task",
        nargs="?",
        metavar="TASK",
        help="a task file (.yaml), or a built-in task such as 'paper' or 'paper-turned'",
    )
    add_robot(parser)
    parser.add_argument("--branch", metavar="NAME", help="branch of the inverse kinematics, or 'auto'")


def add_robot(parser: ArgumentParser, *, required: bool = False, is_positional: bool = False) -> None:
    """The robot and what it is made of."""
    which = "the robot" if required or is_positional else "another robot"
    meaning = f"{which}: a .urdf file, or a name such as 'ur5' (puma-septic robot --list)"
    if is_positional:
        parser.add_argument("robot", nargs="?", metavar="ROBOT", help=meaning)
    else:
        parser.add_argument("--robot", metavar="ROBOT", required=required, help=meaning)
    parser.add_argument("--actuators", metavar="FILE", help="its actuator file")
    parser.add_argument("--parameters", metavar="NAME", help="set of drive parameters, such as rtb or akb")
    parser.add_argument("--limits", metavar="NAME", help="set of limits, such as corke, akb or benchmark")
    parser.add_argument("--tool", metavar="FRAME", help="frame that is positioned and that carries the payload")
    parser.add_argument(
        "--lock",
        action="append",
        type=_locked,
        metavar="JOINT=POSITION",
        help="lock a joint at this position (rad; m if prismatic; repeatable)",
    )
    parser.add_argument("--lock-others", action="store_true", help="lock every joint that does not carry the tool")
    parser.add_argument(
        "--package-dir",
        action="append",
        metavar="DIR",
        help="folder of ROS packages, a package or a workspace, to find meshes in (repeatable)",
    )


def add_payload(parser: ArgumentParser) -> None:
    """``--payload``."""
    parser.add_argument("--payload", type=not_negative, metavar="KG", help="a point mass at the tool's origin")


def add_dwell(parser: ArgumentParser) -> None:
    """``--dwell``."""
    parser.add_argument(
        "--dwell", type=not_negative, metavar="S", help="rest after each motion, included in RMS values"
    )


def add_margin(parser: ArgumentParser) -> None:
    """``--margin``: what must be left of every limit but that of the position."""
    parser.add_argument(
        "--margin",
        type=share,
        default=0.0,
        metavar="SHARE",
        help="what must be left of each velocity, acceleration, jerk and effort limit, and of the tool's, 0 to 1",
    )


def in_reserve(arguments: Namespace) -> str:
    """What ``--margin`` keeps, behind the head of an answer that is found within the rest."""
    return f"; {_reserve_text(arguments)}" if arguments.margin else ""


def _reserve_text(arguments: Namespace) -> str:
    return f"{100 * arguments.margin:g} % of the limits of joints and tool kept in reserve"


def reserve(arguments: Namespace) -> dict[str, float]:
    """What a document says of ``--margin``: the share of the limits that its answers leave; nothing where none is."""
    return {"margin": arguments.margin} if arguments.margin else {}


def left_by_margin(resolved: ResolvedTask, arguments: Namespace) -> ResolvedTask:
    """The task with what ``--margin`` leaves of its limits, for answers that are found within them."""
    if not arguments.margin:
        return resolved
    tool = resolved.tool_limits
    return replace(
        resolved,
        robot=with_margin(resolved.robot, arguments),
        tool_limits=tool and tool.within(1.0 - arguments.margin, source=_reserve_text(arguments)),
    )


def with_margin(robot: Robot, arguments: Namespace) -> Robot:
    """The robot with what ``--margin`` leaves of its limits."""
    from puma_septic.errors import InputError
    from puma_septic.quantities import MAGNITUDES

    if not arguments.margin:
        return robot
    if arguments.margin == 1.0:
        raise InputError("--margin 1 leaves nothing of the limits; a fifth in reserve is 0.2")
    limits = robot.limits
    source = "; ".join(filter(None, (limits.source, _reserve_text(arguments))))
    left = {name: (1.0 - arguments.margin) * getattr(limits, name) for name in MAGNITUDES}
    return robot.with_limits(replace(limits, source=source, **left))


def add_profile(parser: ArgumentParser, meaning: str) -> None:
    """``--profile``, given once or several times."""
    parser.add_argument("--profile", action="append", metavar="NAME", help=meaning)


def asked_task(arguments: Namespace, default: str, *, profiles: Sequence[str] | None = None) -> Task:
    """The named task, else the default one, with the options' replacements.

    Another robot replaces the whole section ``robot``; its parameters, limits and tool would not fit.
    """
    from puma_septic.errors import InputError
    from puma_septic.task import load_task, make_task

    for name in _RECORDING:
        if getattr(arguments, name, None) is not None:
            raise InputError(f"--{name.replace('_', '-')} goes with --csv")
    task = load_task(arguments.task if arguments.task is not None else default)
    document = task.document()
    changes: dict[str, Any] = {"robot": asked_robot(arguments, document.get("robot", {}))}
    if arguments.branch is not None:
        changes["branch"] = arguments.branch
    if getattr(arguments, "payload", None) is not None:
        changes["payload"] = {"mass": arguments.payload}
    if getattr(arguments, "dwell", None) is not None:
        changes["dwell"] = arguments.dwell
    if profiles and task.cycle:
        raise InputError(f"--profile does not go with a cycle: in {task.origin} each move has its own")
    if profiles:
        given = document["profiles"]
        changes["profiles"] = [
            choice for name in profiles for choice in [one for one in given if one["name"] == name] or [{"name": name}]
        ]
    return make_task({**document, **changes}, origin=task.origin)


def asked_robot(arguments: Namespace, given: dict[str, Any]) -> dict[str, Any]:
    """The section ``robot`` with the options' replacements."""
    robot: dict[str, Any] = {"source": _path(arguments.robot)} if arguments.robot else dict(given)
    if arguments.actuators:
        robot["actuators"] = str(Path(arguments.actuators).absolute())
    for key in ("parameters", "limits", "tool"):
        if getattr(arguments, key) is not None:
            robot[key] = getattr(arguments, key)
    if arguments.lock or arguments.lock_others:
        before = robot.get("locked", {})
        others = {"others": None} if arguments.lock_others or before == "others" else {}
        robot["locked"] = {**({} if before == "others" else before), **dict(arguments.lock or ()), **others}
    if arguments.package_dir:
        folders = [str(Path(folder).absolute()) for folder in arguments.package_dir]
        robot["package_dirs"] = [*robot.get("package_dirs", []), *folders]
    return robot


def _path(source: str) -> str:
    """A path is relative to the caller's folder, a name stays a name."""
    from puma_septic.robot import is_robot_path

    return str(Path(source).absolute()) if is_robot_path(source) else source


def _locked(text: str) -> tuple[str, float]:
    joint, equals, position = text.rpartition("=")
    if not (joint and equals):
        raise ArgumentTypeError(f"{text!r} is not JOINT=POSITION")
    return joint, finite(position)
