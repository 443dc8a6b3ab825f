"""Assessed tasks as one JSON document; docs/json.md describes it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from puma_septic._version import __version__
from puma_septic.assessment import Assessment
from puma_septic.document import SCHEMAS
from puma_septic.task import ResolvedTask

__all__ = ["assess_document", "numbered", "profile_labels", "reserve_document", "unmet_document"]


def assess_document(
    tasks: Sequence[tuple[ResolvedTask, Sequence[Assessment]]], *, margin: float = 0.0
) -> dict[str, Any]:
    """The document of assessed tasks: what was asked, so that it can be repeated, and what came out."""
    every = [one for _, assessments in tasks for one in assessments]
    return {
        "schema": SCHEMAS["assess"],
        "version": __version__,
        "is_feasible": all(one.is_feasible for one in every),
        **reserve_document(every, margin),
        "tasks": [_task_document(resolved, assessments, margin) for resolved, assessments in tasks],
    }


def reserve_document(assessments: Sequence[Assessment], margin: float) -> dict[str, Any]:
    """What a document says of the share of each limit that has to be left: nothing where none was asked for."""
    if not margin:
        return {}
    kept = not any(one.keeps(margin) or one.undecided for one in assessments)
    return {"margin": margin, "keeps_margin": kept}


def unmet_document(assessment: Assessment, margin: float) -> dict[str, Any]:
    """The limits that do not leave this share, where one was asked for."""
    return {"not_kept": [check.to_dict() for check in assessment.keeps(margin)]} if margin else {}


def profile_labels(assessments: Sequence[Assessment]) -> list[str]:
    """The profiles' names, numbered where one occurs more than once."""
    return numbered([one.motion.trajectory.profile for one in assessments])


def numbered(names: Sequence[str]) -> list[str]:
    """Names, numbered where one occurs more than once."""
    return [name if names.count(name) == 1 else f"{name}-{names[: k + 1].count(name)}" for k, name in enumerate(names)]


def _task_document(resolved: ResolvedTask, assessments: Sequence[Assessment], margin: float) -> dict[str, Any]:
    labels = profile_labels(assessments)
    return {
        "task": resolved.task.document(),
        "origin": resolved.task.origin,
        "joint_names": list(resolved.robot.joint_names),
        "point_names": list(resolved.names),
        "points": resolved.points.tolist(),
        "times": resolved.times.tolist(),
        "branch": resolved.branch.configuration,
        "branches": [
            {
                "configuration": branch.configuration,
                "points": branch.q.tolist(),
                "excess": branch.excess.tolist(),
                "is_within_limits": branch.is_within_limits,
            }
            for branch in resolved.branches
        ],
        "are_all_branches": resolved.is_complete,
        "broken_in_all_branches": [
            {"joint": joint, "point": point} for joint, point in resolved.broken_in_all_branches
        ],
        "assessments": [
            {"label": label, **assessment.to_dict(), **unmet_document(assessment, margin)}
            for label, assessment in zip(labels, assessments, strict=True)
        ],
    }
