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

__all__ = ["add_dwell", "add_payload", "add_profile", "add_robot", "add_task", "asked_robot", "asked_task"]


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


def add_robot(parser: ArgumentParser, *, required: bool = False) -> None:
    """The robot and what it is made of."""
    which = "the robot" if required else "another robot"
    parser.add_argument("--robot", metavar="NAME", required=required, help=f"{which}: 'puma560' or a .urdf file")
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
    if arguments.lock:
        robot["locked"] = {**robot.get("locked", {}), **dict(arguments.lock)}
    return robot


def _path(source: str) -> str:
    """A path is relative to the caller's folder, a name stays a name."""
    return str(Path(source).absolute()) if source.endswith(".urdf") or Path(source).name != source else source


def _locked(text: str) -> tuple[str, float]:
    joint, equals, position = text.rpartition("=")
    if not (joint and equals):
        raise ArgumentTypeError(f"{text!r} is not JOINT=POSITION")
    return joint, finite(position)
