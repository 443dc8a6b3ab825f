"""What a person reads: assessed tasks within 100 columns."""

from __future__ import annotations

import re
from collections.abc import Sequence
from textwrap import wrap
from typing import Final

from puma_septic.assessment import Assessment
from puma_septic.report import profile_labels
from puma_septic.task import Branch, ResolvedTask
from puma_septic.views import assessment as view
from puma_septic.views import profiles
from puma_septic.views.checks import unmet_text

__all__ = ["assessed_text", "branches_text", "details", "margin_text", "turned_text", "wrapped"]

WIDTH: Final = 100
_COLUMNS: Final = re.compile(r"\S  +\S")


def wrapped(text: str) -> str:
    """Prose broken at its words, the rest of a line indented; a table's rows stay as they are."""
    lines: list[str] = []
    for line in text.split("\n"):
        words = line.strip()
        if len(line) <= WIDTH or _COLUMNS.search(words):
            lines.append(line)
        else:
            start = line[: len(line) - len(line.lstrip())]
            lines += wrap(words, WIDTH, initial_indent=start, subsequent_indent=f"{start}  ")
    return "\n".join(lines)


def assessed_text(
    resolved: ResolvedTask, assessments: Sequence[Assessment], margin: float = 0.0, *, verbosity: int = 0
) -> str:
    """The task, its profiles side by side, and why its points violate limits if they do.

    From verbosity 1 on with the tables of each assessment, and with each remark once; from 2 on with all of each.
    """
    parts = [_head(resolved, assessments), side_by_side(assessments)]
    if resolved.has_poses and not resolved.branch.is_within_limits:
        parts.append(branches_text(resolved) if verbosity else wrapped(_reason(resolved)))
    if margin:
        parts.append(margin_text(assessments, margin))
    return "\n\n".join([*parts, *details(assessments, verbosity, margin)])


def details(assessments: Sequence[Assessment], verbosity: int, margin: float = 0.0) -> list[str]:
    """What each assessment has to say beside the table of profiles."""
    labels = profile_labels(assessments)
    if verbosity > 1:
        pairs = zip(labels, assessments, strict=True)
        return [part for label, one in pairs for part in (_rule(label), wrapped(str(one)))]
    documents = [one.to_dict() for one in assessments]
    common: dict[str, list[str]] = {
        title: list(dict.fromkeys(line for document in documents for line in document[key]))
        for title, key in (("Not assessed", "not_assessed"), ("Remarks", "remarks"))
    }
    if not verbosity:
        unknown = [f"Not assessed: {'; '.join(common['Not assessed'])}"] if common["Not assessed"] else []
        count = len(common["Remarks"])
        remarks = f"{count} remark{'s' if count > 1 else ''} and the tables of the joints" if count else "the tables"
        apart = ", the margin apart" if margin else ""
        verdicts = [f"Verdict{apart}: {documents[0]['verdict']}"] if len(documents) == 1 else []
        return ["\n".join(wrapped(line) for line in [*verdicts, *unknown, f"More: -v shows {remarks}, -vv all."])]
    parts = []
    for label, document in zip(labels, documents, strict=True):
        violated = view.listed({"Violated limits": view.lists(document).get("Violated limits", [])})
        parts += [_rule(label), *map(wrapped, [view.joints_text(document), *violated])]
    return [*parts, _rule("of all profiles"), *map(wrapped, view.listed(common))]


def turned_text(resolved: ResolvedTask, assessments: Sequence[Assessment]) -> str:
    """A second task, shorter."""
    name = resolved.task.name
    table = profiles.text([one.to_dict() for one in assessments], profile_labels(assessments))
    doubts = [wrapped(text)] if (text := profiles.doubts_text([one.to_dict() for one in assessments])) else []
    return "\n".join([_rule(f"Compare: {name}"), table, *doubts, f"Full report: puma-septic assess {name}"])


def side_by_side(assessments: Sequence[Assessment]) -> str:
    """The profiles side by side, one row each."""
    documents = [one.to_dict() for one in assessments]
    table = profiles.text(documents, profile_labels(assessments))
    note = "The largest among the joints; velocity and torque in per cent of their limits, overshoot beyond the points."
    return "\n".join([table, *(wrapped(text) for text in (note, profiles.doubts_text(documents)) if text)])


def branches_text(resolved: ResolvedTask) -> str:
    """Why the points violate position limits: what each branch of the inverse kinematics violates."""
    branches = resolved.branches
    width = 4 + max(len(branch.configuration) for branch in branches)
    lines = [wrapped(f"{_reason(resolved)} How far beyond its limits each joint is at most:")]
    for branch in branches:
        start = f"  {branch.configuration}".ljust(width)
        lines += wrap(_excess(resolved, branch), WIDTH, initial_indent=start, subsequent_indent=" " * width)
    return "\n".join(lines)


def _reason(resolved: ResolvedTask) -> str:
    """One sentence: the branches that would fit, or the limits that all of them violate."""
    branches, always = resolved.branches, resolved.broken_in_all_branches
    fitting = [branch.configuration for branch in branches if branch.is_within_limits]
    if fitting:
        return f"Branches that keep the position limits at all points: {', '.join(fitting)}."
    if always:
        pairs = " and ".join(f"{joint} at {_points(resolved, joint)}" for joint in dict.fromkeys(j for j, _ in always))
        return (
            f"Why: all {len(branches)} branches of the inverse kinematics violate the position limit of {pairs},"
            " so no profile through these poses can be feasible."
            if resolved.is_complete
            else f"Why: every way found through these poses violates the position limit of {pairs}; there may be others"
            f" ({resolved.extent})."
        )
    which = f"the {len(branches)} branches of the inverse kinematics" if resolved.is_complete else "the ways found"
    return f"Why: each of {which} violates a position limit."


def _points(resolved: ResolvedTask, joint: str) -> str:
    return " and ".join(repr(point) for name, point in resolved.broken_in_all_branches if name == joint)


def _excess(resolved: ResolvedTask, branch: Branch) -> str:
    """Each joint beyond its limits, by how much at most, and at which points."""
    texts = []
    robot = resolved.robot
    for joint, excess, slides in zip(robot.joint_names, branch.excess.T, robot.is_prismatic, strict=True):
        if excess.any():
            unit = "m" if slides else "rad"
            at = [name for name, size in zip(resolved.names, excess, strict=True) if size]
            places = "all points" if len(at) == len(excess) else ", ".join(at)
            texts.append(f"{joint} {excess.max():.2g} {unit} ({places})")
    return "; ".join(texts) or "none"


def _head(resolved: ResolvedTask, assessments: Sequence[Assessment]) -> str:
    task, robot = resolved.task, resolved.robot
    section = task.robot
    sets = [
        f"{key} {value!r}" for key, value in (("parameters", section.parameters), ("limits", section.limits)) if value
    ]
    chosen = " (chosen; --tool FRAME for another)" if robot.tool_is_chosen else ""
    load = f", payload {robot.payload.mass:g} kg" if robot.payload is not None else ""
    stops = ", ".join(f"{name} {time:g} s" for name, time in zip(resolved.names, resolved.times, strict=True))
    lines = [
        f"Task {task.name!r}" + (f": {' '.join(task.description.split())}" if task.description else ""),
        f"Robot: {robot.name}" + (f" ({', '.join(sets)})" if sets else "") + f", tool {robot.tool!r}{chosen}{load}",
        f"Points: {stops}" + (f", poses in {task.frame!r}" if resolved.has_poses else ""),
    ]
    if resolved.has_poses:
        lines.append(f"Branch: {resolved.branch.configuration}{_choice(resolved)}")
    lowest = min((one.lowest for one in assessments), key=lambda one: round(one.height, 9))
    lines.append(f"Lowest point: {view.lowest_text(lowest.to_dict())}. {resolved.lowest}".rstrip())
    return "\n".join(wrapped(line) for line in lines)


def _choice(resolved: ResolvedTask) -> str:
    """How the branch came about, where the task left it open."""
    if resolved.task.branch != "auto":
        return ""
    scope = "" if resolved.is_complete else f" ({resolved.extent})"
    if resolved.branch.is_within_limits:
        above = "" if resolved.task.floor is None or resolved.lowest else " and above the floor"
        return f", chosen for the least travel of the joints among those within limits{above}{scope}"
    return f", chosen because it is the least beyond its limits: none is within them{scope}"


def margin_text(assessments: Sequence[Assessment], margin: float) -> str:
    """What is not kept with the margin that was asked for."""
    parts = []
    for label, assessment in zip(profile_labels(assessments), assessments, strict=True):
        unmet = assessment.keeps(margin)
        kept = f"every known limit is kept with {100 * margin:g} % to spare"
        parts.append(f"{label}: {unmet_text(unmet, assessment.not_assessed, margin) if unmet else kept}")
    return wrapped("\n\n".join(parts))


def _rule(title: str) -> str:
    return f"---- {title} ".ljust(WIDTH, "-")
