"""The report: one HTML page, to read, to send and to print, that asks nobody for anything."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, final

from markupsafe import Markup

from puma_septic._version import __version__
from puma_septic.assessment import Assessment
from puma_septic.cycle import CycleAssessment
from puma_septic.errors import InputError, ModelError
from puma_septic.limit_check import most_used_first
from puma_septic.limits import MotionLimits
from puma_septic.outputs import write_file
from puma_septic.paths import ToolLimits
from puma_septic.pictures import (
    Bar,
    Entry,
    Panel,
    Picture,
    in_units,
    motion_pictures,
    profile_entries,
    samples_of,
    torque_picture,
    utilisation_picture,
)
from puma_septic.report._case import Case, in_reserve
from puma_septic.report._rendering import render
from puma_septic.report._sections import (
    Optimised,
    Reported,
    case_of,
    cycle_cases,
    limits_case,
    optimised_case,
    task_case,
)
from puma_septic.robot import Robot
from puma_septic.task import ResolvedTask, Task
from puma_septic.validation import checked_kind, checked_texts
from puma_septic.viewer import replay_html
from puma_septic.views import assessment as assessment_view
from puma_septic.views import profiles as profiles_view
from puma_septic.views.units import SI, Units

__all__ = ["cycle_html", "limits_html", "optimised_html", "report_html", "tasks_html", "write_report"]

# Charts of what governs, side by side.
_GOVERNING: Final = 3
# Digits of instants: a microsecond is far below what a picture shows.
_DIGITS: Final = 6


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Section:
    """What the template shows of one case."""

    case: Case
    description: str
    head: str
    comparison: Markup
    profiles: tuple[Entry, ...]
    utilisation: Picture
    replay: str
    no_replay: str
    joints: tuple[str, ...]
    governing: tuple[Panel, ...]
    pictures: tuple[Picture, ...]
    tables: list[tuple[str, Markup]]
    not_assessed: list[str]
    remarks: list[str]
    robot: Markup
    repeat: str
    inputs: str
    span: tuple[float, float]
    times: list[list[float]]

    @property
    def matrix(self) -> tuple[Panel, ...]:
        """The panels of the limits' use that have a row for each joint; the tool's has rows of its own."""
        return tuple(panel for panel in self.utilisation.panels if set(self.joints) <= set(panel.rows))

    @staticmethod
    def worst(panel: Panel, joint: str) -> Bar:
        """The longest bar of a joint: the profile that uses most of the limit."""
        return max(panel.row_bars(panel.rows.index(joint)), key=lambda bar: (bar.is_violated, bar.length))


def report_html(
    what: Reported,
    *,
    title: str | None = None,
    notes: Sequence[str] = (),
    document: Mapping[str, Any] | None = None,
    point_names: Sequence[str] = (),
    margin: float = 0.0,
    made: Mapping[str, str] | None = None,
    units: Units = SI,
) -> str:
    """The report of a motion, or of several side by side, as one HTML page.

    The verdict comes first; then how much of each limit is used, the replay, torque with its causes, the torque-speed
    plane, the tool's path, position to jerk, the numbers, what is not known, and the inputs. One time cursor moves
    plots and replay. It works from disk, without network, and prints.

    Parameters
    ----------
    what : Assessment, sequence of Assessment, Comparison, CycleAssessment, Execution, Sizing, Selection or PaperReport
        Of one arm. Of a comparison the best profiles are drawn, and all are in its tables.
    title : str, optional
        Heading; the robot's name by default.
    notes : sequence of str
        What else a reader must know, such as how a log was read; it stands below the verdict.
    document : mapping, optional
        Of a sizing or selection: its document with what repeats it, which stands among the inputs.
    point_names : sequence of str
        Of the points that the motions go through, for the replay of a comparison or a sizing.
    margin : float
        Of motions: the share of each limit that has to be left, see `Assessment.keeps`.
    made : mapping, optional
        Where the report comes from, such as the date, the file and the command line; it stands below the title.
    units : Units
        Of angles and speeds in tables and charts.

    Returns
    -------
    str

    Raises
    ------
    InputError
        For no assessment, or arms with different joints.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> html = report_html(ps.assess(ps.load_robot(), move))
    >>> html[:15], "Feasible" in html
    ('<!DOCTYPE html>', True)
    """
    if title is not None:
        checked_kind("title", title, str)
    if isinstance(what, CycleAssessment):
        return cycle_html(what, title=title, margin=margin)
    case = in_reserve(case_of(what, title, document, point_names), margin)
    if notes := checked_texts("notes", notes):
        items = Markup("").join(Markup("<li>{}</li>").format(note) for note in notes)
        case = replace(case, preface=Markup("<ul>{}</ul>").format(items) + case.preface)
    return _page(case.title, [_section(case, units)], made)


def write_report(path: str | Path, what: Reported, *, title: str | None = None, overwrite: bool = False) -> Path:
    """Write the report as one HTML file, whole or not at all; see `report_html`.

    With `overwrite` it may replace a file.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        Where the file exists and may not be replaced, or cannot be written, with the reason; and as `report_html`.
    """
    return write_file(path, report_html(what, title=title), overwrite=overwrite)


def optimised_html(
    found: Optimised,
    robot: Robot,
    *,
    dwell: float = 0.0,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
    title: str | None = None,
    point_names: Sequence[str] = (),
    made: Mapping[str, str] | None = None,
    units: Units = SI,
) -> str:
    """The report of an optimisation: the given motion beside those that were found, assessed in full.

    Parameters
    ----------
    found : OptimisedTimes, ParetoFront or LeastTime
    robot : Robot
        That carries the motions out.
    dwell : float
        Rest after the motion, in the root mean squares, s.
    floor, tool_limits : optional
        Of the cell, as the optimisation took them.
    title, point_names, made, units
        As of `report_html`.

    Returns
    -------
    str
    """
    cell: dict[str, Any] = {"dwell": dwell, "floor": floor, "tool_limits": tool_limits}
    case = optimised_case(found, robot, title, cell=cell, point_names=point_names)
    return _page(case.title, [_section(case, units)], made)


def limits_html(
    found: Sequence[MotionLimits],
    assessments: Sequence[Assessment],
    document: Mapping[str, Any],
    resolved: ResolvedTask,
    *,
    made: Mapping[str, str] | None = None,
    units: Units = SI,
) -> str:
    """The report of how fast and how heavy the profiles of a task can be, with what their motions use as given.

    Parameters
    ----------
    found : sequence of MotionLimits
    assessments : sequence of Assessment
        Of the motions as they are given.
    document : mapping
        Of all limits, as ``limits --format json`` writes it.
    resolved : ResolvedTask
    made, units
        As of `report_html`.

    Returns
    -------
    str
    """
    case = limits_case(found, assessments, document, resolved)
    return _page(case.title, [_section(case, units)], made)


def tasks_html(
    tasks: Sequence[tuple[ResolvedTask, Sequence[Assessment]]],
    *,
    margin: float = 0.0,
    made: Mapping[str, str] | None = None,
    units: Units = SI,
) -> str:
    """The report of assessed tasks, with the inputs of each as a task file.

    Raises
    ------
    InputError
        For no task.
    """
    if not tasks:
        raise InputError("a report needs at least one task")
    cases = [in_reserve(task_case(resolved, assessments), margin) for resolved, assessments in tasks]
    sections = [_section(case, units) for case in cases]
    return _page(" and ".join(section.case.title for section in sections), sections, made)


def cycle_html(
    assessed: CycleAssessment,
    *,
    title: str | None = None,
    task: Task | None = None,
    point_names: Sequence[str] = (),
    margin: float = 0.0,
    made: Mapping[str, str] | None = None,
    units: Units = SI,
) -> str:
    """The report of a cycle: the whole first, then each of its motions, the governing one first."""
    cases = [in_reserve(case, margin) for case in cycle_cases(assessed, title, task, point_names)]
    sections = [_section(case, units) for case in cases]
    return _page(sections[0].case.title, sections, made)


def _page(title: str, sections: Sequence[Section], made: Mapping[str, str] | None) -> str:
    return render("page.html.j2", title=title, sections=sections, version=__version__, made=made or {})


def _section(case: Case, units: Units) -> Section:
    assessments, labels, resolved = case.assessments, case.labels, case.resolved
    task = case.task if resolved is None else resolved.task
    group = [samples_of(one, label) for one, label in zip(assessments, labels, strict=True)]
    documents = [one.to_dict() for one in assessments]
    replay, no_replay = _replay(case)
    repeat, inputs = _inputs(case)
    pictures = tuple(in_units(picture, units) for picture in motion_pictures(group))
    case = replace(case, sentence=units.prose(case.sentence), reason=units.prose(case.reason))
    return Section(
        case=case,
        description="" if task is None else " ".join(task.description.split()),
        head=_head(assessments, resolved),
        comparison=Markup(profiles_view.html(documents, labels, units)) if len(labels) > 1 else Markup(""),
        profiles=profile_entries(labels),
        utilisation=utilisation_picture(assessments, labels),
        replay=replay,
        no_replay=no_replay,
        joints=assessments[0].motion.robot.joint_names,
        governing=_governing(assessments, pictures),
        # Of a part of a cycle the torque alone: the rest is in the charts of the whole.
        pictures=(in_units(torque_picture(group), units),) if case.no_replay else pictures,
        tables=[
            (label, Markup(assessment_view.tables(one, units))) for label, one in zip(labels, documents, strict=True)
        ],
        not_assessed=_distinct(line for one in assessments for line in one.not_assessed),
        remarks=_distinct(line for one in assessments for line in one.remarks),
        robot=Markup(assessments[0].motion.robot._repr_html_()),
        repeat=repeat,
        inputs=inputs,
        span=(min(float(one.t[0]) for one in group), max(float(one.t[-1]) for one in group)),
        times=[[round(t, _DIGITS) for t in one.t.tolist()] for one in group],
    )


def _governing(assessments: Sequence[Assessment], pictures: Sequence[Picture]) -> tuple[Panel, ...]:
    """The charts of the three limits that are used most; of the first torques where no limit is known."""
    checks = [check for one in assessments for check in (*one.checks, *one.tool_checks)]
    worst = dict.fromkeys((one.quantity, one.joint) for one in most_used_first(checks))
    names = {picture.name: picture for picture in pictures}
    of_tool = ("tool", f"speed of {assessments[0].motion.robot.tool}")
    wanted = [
        of_tool if (quantity, joint) == ("speed", "tool") else ("torque" if quantity == "effort" else quantity, joint)
        for quantity, joint in worst
    ]
    found = [panel for name, joint in wanted if name in names for panel in names[name].panels if panel.title == joint]
    return tuple((found or names["torque"].panels)[:_GOVERNING])


def _replay(case: Case) -> tuple[str, str]:
    """The replay's page, or why there is none: a mesh that cannot be drawn does not take the numbers away."""
    if case.no_replay:
        return "", case.no_replay
    try:
        names = case.point_names if case.resolved is None else case.resolved.names
        if case.task is None and len(names) != len(case.assessments[0].motion.trajectory.marked[0]):
            names = ()  # of an executed motion its ends alone are marked
        html = replay_html(case.assessments, labels=case.labels, title=case.title, point_names=names, has_panel=False)
        return html, ""
    except ModelError as error:
        return "", str(error)


def _head(assessments: Sequence[Assessment], resolved: ResolvedTask | None) -> str:
    robot = assessments[0].motion.robot
    load = f", payload {robot.payload.mass:g} kg" if robot.payload is not None else ""
    parts = [f"Robot: {robot.name}, tool {robot.tool}{load}."]
    if resolved is not None:
        points = ", ".join(f"{name} {time:g} s" for name, time in zip(resolved.names, resolved.times, strict=True))
        parts.append(f"Points: {points}.")
        if resolved.has_poses:
            parts.append(f"Branch of the inverse kinematics: {resolved.branch.configuration}.")
        if resolved.lowest:
            parts.append(resolved.lowest)
    dwell = max(one.dwell for one in assessments)
    if dwell:
        parts.append(f"Then {dwell:g} s at rest, which count in the RMS values.")
    return " ".join(parts)


def _inputs(case: Case) -> tuple[str, str]:
    """How to repeat it, and the inputs with all their digits."""
    task = case.task if case.resolved is None else case.resolved.task
    if case.inputs:
        how = "The inputs are the task, the files and the options of puma-septic size, and what every part was held to."
        document: Any = case.inputs
    elif task is not None:
        how = "The inputs are a task file: save them as task.yaml and run puma-septic assess task.yaml."
        document = task.document()
    else:
        how = "The inputs are what the profiles were made from and what was assessed."
        document = [
            {
                "label": label,
                "profile": one.motion.trajectory.profile,
                "robot": one.motion.robot.name,
                "tool": one.motion.robot.tool,
                "points": one.motion.trajectory.marked[1].tolist(),
                "times": one.motion.trajectory.marked[0].tolist(),
                "samples": len(one.motion.trajectory.times),
                "dwell": one.dwell,
            }
            for label, one in zip(case.labels, case.assessments, strict=True)
        ]
    return how, json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)


def _distinct(lines: Any) -> list[str]:
    return list(dict.fromkeys(lines))
