"""What ``puma-septic limits`` does."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from typing import Any

from puma_septic._version import __version__
from puma_septic.assessment import Assessment, assess
from puma_septic.cli._arguments import asked_task, in_reserve, left_by_margin, reserve
from puma_septic.cli._output_arguments import asked_units, origin, with_report
from puma_septic.cli._parser import UNDECIDED, Answer
from puma_septic.document import SCHEMAS, to_json
from puma_septic.errors import InputError, NoSolution
from puma_septic.limits import MotionLimits, motion_limits
from puma_septic.motion import compute_motion
from puma_septic.paths import ToolLimits
from puma_septic.pictures.limits import payload_picture
from puma_septic.report import new_folder, profile_labels
from puma_septic.task import ResolvedTask, resolve_task
from puma_septic.views import limits as view

__all__ = ["answer"]


def answer(arguments: Namespace) -> Answer:
    """Limits of each profile of the asked task."""
    resolved = left_by_margin(
        resolve_task(asked_task(arguments, "paper-turned", profiles=arguments.profile)), arguments
    )
    motions = [compute_motion(resolved.robot, trajectory) for trajectory in resolved.trajectories]
    cell: dict[str, Any] = {
        "dwell": resolved.task.dwell,
        "floor": resolved.task.floor,
        "tool_limits": resolved.tool_limits,
    }
    assessments = [assess(motion, **cell) for motion in motions]
    labels = profile_labels(assessments)
    found = [motion_limits(motion, com=arguments.com, **cell) for motion in motions]
    document: dict[str, Any] = {
        "schema": SCHEMAS["limits"],
        "version": __version__,
        "task": f"{resolved.task.name}{in_reserve(arguments)}",
        "origin": resolved.task.origin,
        "robot": resolved.robot.name,
        "joint_names": list(resolved.robot.joint_names),
        "profiles": [{"label": label, **one.to_dict()} for label, one in zip(labels, found, strict=True)],
        **reserve(arguments),
        **_left_to_sizing(resolved),
    }
    if arguments.reference:
        for limits, one in zip(found, document["profiles"], strict=True):
            one["reference"] = _reference(limits, resolved.tool_limits)
    texts = {"text": view.text, "json": to_json, "csv": view.csv}
    text = texts[arguments.format](document)
    if arguments.out is not None:
        _write_folder(arguments, found, assessments, document, resolved)
    text = with_report(text, arguments)
    if any(one.undecided for one in assessments):
        return Answer(text, UNDECIDED)
    return Answer(text, 0 if all(one.fastest and not one.fastest.reason for one in found) else 1)


def _left_to_sizing(resolved: ResolvedTask) -> dict[str, list[str]]:
    """What the task says of its drives, which is held by a sizing alone."""
    conditions = resolved.task.conditions
    named = [] if conditions is None else sorted(conditions.model_fields_set)
    if not named:
        return {}
    return {"not_assessed": [f"the task's conditions ({', '.join(named)}): size --reserves holds the drives to them"]}


def _write_folder(
    arguments: Namespace,
    found: Sequence[MotionLimits],
    assessments: Sequence[Assessment],
    document: dict[str, Any],
    resolved: ResolvedTask,
) -> None:
    """Report, document, table and figure."""
    # Templates, the replay and matplotlib take longer to load than everything else takes to compute.
    from puma_septic.report.figures import write_png
    from puma_septic.report.page import limits_html
    from puma_septic.report.svg import write_svg

    labels = [one["label"] for one in document["profiles"]]
    with new_folder(arguments.out, overwrite=arguments.force) as folder:
        (folder / "limits.json").write_text(to_json(document), encoding="utf-8")
        (folder / "limits.csv").write_text(view.csv(document), encoding="utf-8")
        page = limits_html(found, assessments, document, resolved, made=origin(arguments), units=asked_units(arguments))
        (folder / "report.html").write_text(page, encoding="utf-8")
        pictures = [payload_picture(found, labels)]
        write_svg(folder, pictures)
        if not arguments.no_png:
            write_png(folder, pictures)


def _reference(limits: MotionLimits, tool_limits: ToolLimits | None) -> dict[str, Any]:
    """The time-optimal motion along the same path, or why there is none."""
    from puma_septic.optimum import time_optimal

    if tool_limits is not None:
        return {"reason": "the reference knows no limits of the tool"}
    if limits.why_not_fastest:  # the floor or a dwell, too, which the reference does not know either
        return {"reason": limits.why_not_fastest}
    try:
        return {"reason": "", **time_optimal(limits.motion).to_dict()}
    except (InputError, NoSolution) as error:
        return {"reason": str(error)}
