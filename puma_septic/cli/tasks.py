"""The task that a command is about: a file or a built-in one, with what the command line replaces."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import Any

from puma_septic.cli.recording import RECORDING
from puma_septic.errors import InputError
from puma_septic.task import Task, load_task, make_task

__all__ = ["asked_robot", "asked_task"]


def asked_task(arguments: Namespace, default: str) -> Task:
    """The named task, else the default one, with the options' replacements.

    Another robot replaces the whole section ``robot``; its parameters, limits and tool would not fit.
    """
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
    if getattr(arguments, "profile", None):
        given = document["profiles"]
        changes["profiles"] = [
            choice
            for name in arguments.profile
            for choice in [one for one in given if one["name"] == name] or [{"name": name}]
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
