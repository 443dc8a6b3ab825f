"""What a report is made of: assessments, and what is said before them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from markupsafe import Markup

from puma_septic.assessment import Assessment, assess
from puma_septic.comparison import Comparison
from puma_septic.cycle import CycleAssessment
from puma_septic.errors import InputError
from puma_septic.limits import MotionLimits
from puma_septic.optimisation import LeastTime, OptimisedTimes, ParetoFront
from puma_septic.paper import POINTS, PaperReport
from puma_septic.pictures.comparison import comparison_picture, optimisation_picture
from puma_septic.pictures.execution import execution_pictures
from puma_septic.pictures.limits import payload_picture
from puma_septic.report._case import Case, boxed, titled
from puma_septic.report._documents import profile_labels
from puma_septic.report._drive_cases import selection_case, sizing_case
from puma_septic.robot import Robot
from puma_septic.simulation import Execution, Simulation
from puma_septic.sizing import Selection, Sizing
from puma_septic.task import ResolvedTask, Task
from puma_septic.trajectory import Trajectory
from puma_septic.validation import checked_list
from puma_septic.views import execution as execution_view
from puma_septic.views import limits as limits_view
from puma_septic.views import profiles as view
from puma_septic.views.cycle import steps_html
from puma_septic.views.tables import html_table

__all__ = [
    "Optimised",
    "Reported",
    "case_of",
    "cycle_cases",
    "limits_case",
    "optimised_case",
    "reason",
    "task_case",
]

Optimised = OptimisedTimes | ParetoFront | LeastTime
Reported = (
    Assessment | Sequence[Assessment] | Comparison | CycleAssessment | Execution | Sizing | Selection | PaperReport
)
# More curves than colours in one chart are told apart by nobody.
_MOST_DRAWN: Final = 6
# Each with its plan.
_MOST_EXECUTED: Final = 2


def limits_case(
    found: Sequence[MotionLimits],
    assessments: Sequence[Assessment],
    document: Mapping[str, Any],
    resolved: ResolvedTask,
) -> Case:
    """How fast and how heavy: the motions as they are given, with what they could do."""
    labels = profile_labels(assessments)
    return Case(
        title=f"{document['task']}: how fast, how heavy",
        assessments=tuple(assessments),
        labels=labels,
        is_feasible=all(one.fastest is not None and not one.fastest.reason for one in found),
        sentence=limits_view.sentence(document),
        heading="How fast, how heavy",
        preface=boxed(limits_view.html(document)),
        pictures=(payload_picture(found, labels),),
        resolved=resolved,
    )


def case_of(
    what: Reported,
    title: str | None,
    document: Mapping[str, Any] | None = None,
    point_names: Sequence[str] = (),
) -> Case:
    """The section of a value; its robot's name is the title where none is given.

    Raises
    ------
    InputError
        For anything else, and for assessments of different arms.
    """
    if isinstance(what, Comparison):
        return replace(_comparison_case(what, title), point_names=tuple(point_names))
    if isinstance(what, Execution):
        return _execution_case(what, title)
    if isinstance(what, Sizing):
        return sizing_case(what, title, what.to_dict() if document is None else document, point_names)
    if isinstance(what, Selection):
        return selection_case(what, title, what.to_dict() if document is None else document, point_names)
    if isinstance(what, PaperReport):
        return replace(_paper_case(what, title), point_names=POINTS)
    group = (
        (what,)
        if isinstance(what, Assessment)
        else ()
        if isinstance(what, CycleAssessment)
        else checked_list("report", what)
    )
    if not group or not all(isinstance(one, Assessment) for one in group):
        raise InputError(f"a report is made of one assessment or a sequence of them, got {what!r}")
    names = {one.motion.robot.joint_names for one in group}
    if len(names) > 1:
        raise InputError(f"a report is of one arm; got joints {' and '.join(', '.join(one) for one in sorted(names))}")
    return _plain_case(group, title)


def task_case(resolved: ResolvedTask, assessments: Sequence[Assessment]) -> Case:
    """The section of an assessed task."""
    labels = profile_labels(assessments)
    return Case(
        title=resolved.task.name,
        assessments=tuple(assessments),
        labels=labels,
        is_feasible=all(one.is_feasible for one in assessments),
        sentence=_sentence(assessments, labels),
        reason=reason(resolved),
        resolved=resolved,
    )


def cycle_cases(
    assessed: CycleAssessment, title: str | None, task: Task | None = None, point_names: Sequence[str] = ()
) -> list[Case]:
    """The whole cycle, then each motion alone, the governing one first."""
    whole = assessed.whole
    named = title or (task.name if task is not None else titled([whole], None))
    first = Case(
        title=named,
        assessments=(whole,),
        labels=["cycle"],
        is_feasible=assessed.is_feasible,
        sentence=_cycle_sentence(assessed),
        preface=boxed(steps_html(assessed.to_dict())),
        task=task,
        point_names=tuple(point_names),
    )
    return [first, *(_motion_case(assessed, k) for k in assessed.order)]


def _cycle_sentence(assessed: CycleAssessment) -> str:
    """The verdict on the whole, and the step in which its governing limit is reached."""
    sentence = _sentence([assessed.whole], ["The cycle"])
    if assessed.worst is None or assessed.whole.undecided:
        return sentence
    return f"{sentence} That is in {assessed.names[assessed.governing]!r}."


def _motion_case(assessed: CycleAssessment, k: int) -> Case:
    one, name = assessed.motions[k], assessed.motion_names[k]
    return Case(
        title=name,
        assessments=(one,),
        labels=profile_labels([one]),
        is_feasible=one.is_feasible,
        sentence=_sentence([one], [name]),
        no_replay="the replay of the whole cycle, above, shows this motion",
    )


def reason(resolved: ResolvedTask) -> str:
    """Why no profile is feasible, where the points themselves break limits in every branch; else empty."""
    always = resolved.broken_in_all_branches
    if not always:
        return ""
    points: dict[str, list[str]] = {}
    for joint, point in always:
        points.setdefault(joint, []).append(point)
    where = ", ".join(f"{joint} at {' and '.join(names)}" for joint, names in points.items())
    count = len(resolved.branches)
    if not resolved.is_complete:
        return f"Every way found ({resolved.extent}) violates the position limit of {where}; there may be others."
    branches = f"All {count} branches of the inverse kinematics violate" if count > 1 else "The points violate"
    return f"{branches} the position limit of {where}: no profile through these points can be feasible."


def _sentence(assessments: Sequence[Assessment], labels: Sequence[str]) -> str:
    return view.sentence([one.to_dict() for one in assessments], labels)


def _plain_case(group: tuple[Assessment, ...], title: str | None, preface: str = "") -> Case:
    labels = profile_labels(group)
    return Case(
        title=titled(group, title),
        assessments=group,
        labels=labels,
        is_feasible=all(one.is_feasible for one in group),
        sentence=_sentence(group, labels),
        preface=Markup(preface),
    )


def _comparison_case(comparison: Comparison, title: str | None) -> Case:
    """All profiles in the tables; as many as there are colours are drawn: those advised, the task's own, the best."""
    rows = comparison.profiles
    names = list(dict.fromkeys([*comparison.recommended, *comparison.own, *comparison.ranking]))
    kept = max(_MOST_DRAWN, len({*comparison.recommended, *comparison.own}))
    drawn = [comparison[name] for name in names[:kept]]
    note = ""
    if len(drawn) < len(rows):
        note = f"<p>Drawn, of {len(rows)}: those that are advised, those of the task, the best of the others.</p>"
    every = [row.assessment for row in rows]
    return Case(
        title=titled(every, title),
        assessments=tuple(row.assessment for row in drawn),
        labels=[row.name for row in drawn],
        is_feasible=any(one.is_feasible for one in every),
        sentence=comparison.advice,
        preface=boxed(comparison._repr_html_() + note),
        pictures=(comparison_picture(comparison),),
    )


def _execution_case(execution: Execution, title: str | None) -> Case:
    """All profiles in the table; of the ones that tracked best, the executed and the planned arm are drawn."""
    whole = {name: one for name, one in execution.simulations.items() if not one.has_diverged}
    best = sorted(whole, key=lambda name: whole[name].metrics.tool_rms_error)[:_MOST_EXECUTED]
    # Where every arm diverged, the plans are all there is to draw.
    drawn = best or list(execution.simulations)[:_MOST_EXECUTED]
    pairs = [
        (label, assess(execution.robot, move))
        for name in drawn
        for label, move in _executed_and_planned(name, execution.simulations[name])
    ]
    return Case(
        title=titled([one for _, one in pairs], title),
        assessments=tuple(one for _, one in pairs),
        labels=[label for label, _ in pairs],
        is_feasible=not execution.has_diverged,
        sentence=execution_view.sentence(execution.to_dict()),
        heading="Diverged" if execution.has_diverged else "Simulated",
        preface=boxed(execution._repr_html_()),
        pictures=execution_pictures(execution),
    )


def _executed_and_planned(name: str, simulation: Simulation) -> list[tuple[str, Trajectory]]:
    planned = (f"{name}, planned", simulation.trajectory)
    return [planned] if simulation.has_diverged else [(f"{name}, executed", simulation.executed), planned]


def optimised_case(
    found: Optimised,
    robot: Robot,
    title: str | None,
    *,
    cell: Mapping[str, Any],
    point_names: Sequence[str] = (),
) -> Case:
    """The motion that was given and those that were found, assessed; of a front as many as there are colours."""
    if isinstance(found, ParetoFront):
        count = len(found.trajectories)
        chosen = sorted({round(k * (count - 1) / max(1, _MOST_DRAWN - 2)) for k in range(_MOST_DRAWN - 1)})
        motions = [found.start, *(found.trajectories[k] for k in chosen)]
        labels = ["given", *(f"point {k + 1}" for k in chosen)]
    else:
        motions = [*([found.start] if found.start is not None else []), found.trajectory]
        labels = [*(["given"] if found.start is not None else []), "optimum"]
    group = tuple(assess(robot, one, **cell) for one in motions)
    # All points count, those that are not drawn too.
    verdicts = found.verdicts if isinstance(found, ParetoFront) else (found.verdict,)
    is_feasible = all(one.is_feasible for one in group[-1 if len(labels) < 3 else 1 :]) and all(
        one is None or one.is_feasible for one in verdicts
    )
    is_front = isinstance(found, ParetoFront)
    notes = Markup("").join(Markup("<p>{}</p>").format(note) for note in found.notes)
    return Case(
        title=titled(group, title),
        assessments=group,
        labels=labels,
        is_feasible=is_feasible,
        heading="" if is_feasible or not is_front else "Not all points are feasible",
        sentence=f"{found.sentence}. {_sentence(group, labels)}",
        preface=boxed(html_table(*found.table) + str(notes)),
        # Of one optimum the positions, which are among the charts of the motions below.
        pictures=(optimisation_picture(found),) if is_front else (),
        point_names=tuple(point_names),
    )


def _paper_case(report: PaperReport, title: str | None) -> Case:
    group = (report.evidence.septic, report.evidence.lspb, report.evidence.quintic)
    rows = [
        [f"{claim.number}", f"{claim.text} ({claim.source})", claim.verdict, claim.explanation]
        for claim in report.claims
    ]
    claims = html_table(["", "claim", "verdict", "why"], rows, caption="The paper's claims, judged")
    case = _plain_case(group, "The paper's claims" if title is None else title, boxed(claims))
    return replace(case, sentence=f"{report.verdict}. {case.sentence}", heading="Claims judged")
