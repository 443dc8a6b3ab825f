"""What ``puma-septic limits`` does."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import Any

from puma_septic._version import __version__
from puma_septic.assessment import assess
from puma_septic.cli._arguments import asked_task
from puma_septic.cli._parser import UNDECIDED, Answer
from puma_septic.document import SCHEMAS, to_json
from puma_septic.errors import InputError, NoSolution
from puma_septic.limits import motion_limits
from puma_septic.motion import Motion, compute_motion
from puma_septic.pictures.limits import payload_picture
from puma_septic.report import new_folder, profile_labels
from puma_septic.report.svg import write_svg
from puma_septic.task import resolve_task
from puma_septic.views import limits as view

__all__ = ["answer"]


def answer(arguments: Namespace) -> Answer:
    """Limits of each profile of the asked task."""
    resolved = resolve_task(asked_task(arguments, "paper-turned", profiles=arguments.profile))
    motions = [compute_motion(resolved.robot, trajectory) for trajectory in resolved.trajectories]
    floor, tool_limits = resolved.task.floor, resolved.tool_limits
    assessments = [assess(motion, floor=floor, tool_limits=tool_limits) for motion in motions]
    labels = profile_labels(assessments)
    found = [motion_limits(motion, com=arguments.com, floor=floor, tool_limits=tool_limits) for motion in motions]
    document: dict[str, Any] = {
        "schema": SCHEMAS["limits"],
        "version": __version__,
        "task": resolved.task.name,
        "origin": resolved.task.origin,
        "robot": resolved.robot.name,
        "joint_names": list(resolved.robot.joint_names),
        "profiles": [{"label": label, **one.to_dict()} for label, one in zip(labels, found, strict=True)],
    }
    if arguments.reference:
        for motion, one in zip(motions, document["profiles"], strict=True):
            one["reference"] = _reference(motion)
    texts = {"text": view.text, "json": to_json, "csv": view.csv}
    text = texts[arguments.format](document)
    if arguments.out is not None:
        with new_folder(arguments.out, overwrite=arguments.force) as folder:
            (folder / "limits.json").write_text(to_json(document), encoding="utf-8")
            (folder / "limits.csv").write_text(view.csv(document), encoding="utf-8")
            write_svg(folder, [payload_picture(found, labels)])
        if arguments.format == "text":
            text += f"\n\nFigure: {Path(arguments.out) / 'payload.svg'}"
    if any(one.undecided for one in assessments):
        return Answer(text, UNDECIDED)
    return Answer(text, 0 if all(one.fastest and not one.fastest.reason for one in found) else 1)


def _reference(motion: Motion) -> dict[str, Any]:
    """The time-optimal motion along the same path, or why there is none."""
    from puma_septic.optimum import time_optimal

    try:
        return {"reason": "", **time_optimal(motion).to_dict()}
    except (InputError, NoSolution) as error:
        return {"reason": str(error)}
