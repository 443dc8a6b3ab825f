"""The task and the robot that a command is about: its arguments, and what they replace of a task file.

Standard library alone until a task is asked for, so that ``--help`` answers at once.
"""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from puma_septic.cli._numbers import finite, not_negative
from puma_septic.cli._recording_arguments import RECORDING

if TYPE_CHECKING:
    from puma_septic.task import Task

__all__ = [
    "add_dwell",
    "add_payload",
    "add_profile",
    "add_robot",
    "add_task",
    "asked_robot",
    "asked_task",
]


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


def add_profile(parser: ArgumentParser, meaning: str) -> None:
    """``--profile``, given once or several times."""
    parser.add_argument("--profile", action="append", metavar="NAME", help=meaning)


def asked_task(arguments: Namespace, default: str, *, profiles: Sequence[str] | None = None) -> Task:
    """The named task, else the default one, with the options' replacements.

    Another robot replaces the whole section ``robot``; its parameters, limits and tool would not fit.
    """
    from puma_septic.errors import InputError
    from puma_septic.task import load_task, make_task

    for name in RECORDING:
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
