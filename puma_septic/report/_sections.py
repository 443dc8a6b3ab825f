"""What a report is made of: assessments, and what is said before them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, final

from markupsafe import Markup

from puma_septic.assessment import Assessment, assess
from puma_septic.comparison import Comparison
from puma_septic.cycle import CycleAssessment, assess_cycle
from puma_septic.errors import InputError
from puma_septic.limits import MotionLimits
from puma_septic.optimisation import LeastTime, OptimisedTimes, ParetoFront
from puma_septic.paper import POINTS, PaperReport
from puma_septic.pictures import Picture
from puma_septic.pictures.comparison import comparison_picture, optimisation_picture
from puma_septic.pictures.execution import execution_pictures
from puma_septic.pictures.limits import payload_picture
from puma_septic.pictures.sizing import arm_front_picture, sizing_pictures
from puma_septic.report._documents import profile_labels
from puma_septic.robot import Robot
from puma_septic.simulation import Execution, Simulation
from puma_septic.sizing import LoadCase, Selection, Sizing
from puma_septic.task import ResolvedTask, Task
from puma_septic.trajectory import Trajectory
from puma_septic.validation import checked_list
from puma_septic.views import execution as execution_view
from puma_septic.views import limits as limits_view
from puma_septic.views import profiles as view
from puma_septic.views import selection as selection_view
from puma_septic.views.checks import percent
from puma_septic.views.cycle import steps_html
from puma_septic.views.sizing import governing_rows
from puma_septic.views.tables import html_table

__all__ = [
    "Case",
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


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DriveUse:
    """A joint's drive on the first screen: its parts where they were chosen, and the limit that it uses most."""

    joint: str
    parts: str
    limit: str
    use: str
    percent: float
    is_violated: bool


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Case:
    """One section of a report.

    Attributes
    ----------
    title : str
    assessments : tuple of Assessment
        What is drawn and tabled, at least one.
    labels : list of str
        Their names.
    is_feasible : bool
    sentence, reason : str
        The verdict, and why it cannot be otherwise, if that is known.
    preface : Markup
        What stands between the verdict and the rest.
    pictures : tuple of Picture
        Of a comparison or sizing, after the preface.
    resolved : ResolvedTask or None
        The task, where there is one.
    inputs : mapping or None
        Of a sizing: what repeats it.
    is_undecided : bool
        Whether too little is known of the parts.
    task : Task or None
        Of a cycle.
    point_names : tuple of str
        Of the points that a cycle stops at.
    no_replay : str
        Why there is no replay here; "" where there is one.
    drives : tuple of DriveUse
        Of a sizing: what the first screen shows in place of the motion's own limits.
    heading : str
        What stands above the sentence instead of "feasible" or "infeasible".
    """

    title: str
    assessments: tuple[Assessment, ...]
    labels: list[str]
    is_feasible: bool
    sentence: str
    reason: str = ""
    preface: Markup = Markup("")  # noqa: RUF009 - a constant text
    pictures: tuple[Picture, ...] = ()
    resolved: ResolvedTask | None = None
    inputs: Mapping[str, Any] | None = None
    is_undecided: bool = False
    task: Task | None = None
    point_names: tuple[str, ...] = ()
    no_replay: str = ""
    heading: str = ""
    drives: tuple[DriveUse, ...] = ()

    @property
    def word(self) -> str:
        """The verdict in a word, and that it rests on doubtful data if it does, or what stands in its place."""
        if self.heading:
            return self.heading
        if self.is_undecided or any(one.undecided for one in self.assessments):
            return "undecided"
        word = "feasible" if self.is_feasible else "infeasible"
        return f"{word}, on doubtful data" if self.doubts else word

    @property
    def doubts(self) -> tuple[str, ...]:
        """What the verdict rests on and should not be trusted."""
        return tuple(dict.fromkeys(doubt for one in self.assessments for doubt in one.doubts))

    @property
    def colour(self) -> str:
        """The style of the verdict: never the colour of what is good where the data are doubtful."""
        return "bad" if not self.is_feasible else "doubtful" if self.doubts else "good"


def limits_case(
    found: Sequence[MotionLimits],
    assessments: Sequence[Assessment],
    document: Mapping[str, Any],
    resolved: ResolvedTask,
) -> Case:
    """How fast and how heavy: the motions as they are given, with what they could do."""
    labels = profile_labels(assessments)
    return Case(
        title=f"{resolved.task.name}: how fast, how heavy",
        assessments=tuple(assessments),
        labels=labels,
        is_feasible=all(one.fastest is not None and not one.fastest.reason for one in found),
        sentence=limits_view.sentence(document),
        heading="How fast, how heavy",
        preface=_boxed(limits_view.html(document)),
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
        return _sizing_case(what, title, what.to_dict() if document is None else document, point_names)
    if isinstance(what, Selection):
        return _selection_case(what, title, what.to_dict() if document is None else document, point_names)
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
    named = title or (task.name if task is not None else _titled([whole], None))
    first = Case(
        title=named,
        assessments=(whole,),
        labels=["cycle"],
        is_feasible=assessed.is_feasible,
        sentence=_cycle_sentence(assessed),
        preface=_boxed(steps_html(assessed.to_dict())),
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
        title=_titled(group, title),
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
        title=_titled(every, title),
        assessments=tuple(row.assessment for row in drawn),
        labels=[row.name for row in drawn],
        is_feasible=any(one.is_feasible for one in every),
        sentence=comparison.advice,
        preface=_boxed(comparison._repr_html_() + note),
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
        title=_titled([one for _, one in pairs], title),
        assessments=tuple(one for _, one in pairs),
        labels=[label for label, _ in pairs],
        is_feasible=not execution.has_diverged,
        sentence=execution_view.sentence(execution.to_dict()),
        heading="Diverged" if execution.has_diverged else "Simulated",
        preface=_boxed(execution._repr_html_()),
        pictures=execution_pictures(execution),
    )


def _executed_and_planned(name: str, simulation: Simulation) -> list[tuple[str, Trajectory]]:
    planned = (f"{name}, planned", simulation.trajectory)
    return [planned] if simulation.has_diverged else [(f"{name}, executed", simulation.executed), planned]


def optimised_case(
    found: Optimised, robot: Robot, title: str | None, *, dwell: float = 0.0, point_names: Sequence[str] = ()
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
    group = tuple(assess(robot, one, dwell=dwell) for one in motions)
    is_feasible = all(one.is_feasible for one in group[-1 if len(labels) < 3 else 1 :])
    is_front = isinstance(found, ParetoFront)
    notes = Markup("").join(Markup("<p>{}</p>").format(note) for note in found.notes)
    return Case(
        title=_titled(group, title),
        assessments=group,
        labels=labels,
        is_feasible=is_feasible,
        heading="" if is_feasible or not is_front else "Not all points are feasible",
        sentence=f"{found.sentence}. {_sentence(group, labels)}",
        preface=_boxed(html_table(*found.table) + str(notes)),
        # Of one optimum the positions, which are among the charts of the motions below.
        pictures=(optimisation_picture(found),) if is_front else (),
        point_names=tuple(point_names),
    )


def _drives(document: Mapping[str, Any], chosen: Mapping[str, str]) -> tuple[DriveUse, ...]:
    """Of a sizing's document, with the chosen parts of each joint."""
    return tuple(
        DriveUse(
            joint=joint,
            parts=chosen.get(joint, ""),
            limit=check.quantity,
            use=percent(check.utilisation) + (" !" if check.is_violated else ""),
            percent=100 * check.utilisation,
            is_violated=check.is_violated,
        )
        for joint, check in governing_rows(document)
    )


def _chosen(document: Mapping[str, Any]) -> dict[str, str]:
    """Motor and gearbox of each joint."""
    first = {joint["name"]: joint["kept"][0] for joint in document["joints"] if joint["kept"]}
    return {name: " + ".join(filter(None, (pair["motor"], pair["gearbox"]))) for name, pair in first.items()}


def _sizing_case(
    sizing: Sizing, title: str | None, document: Mapping[str, Any], point_names: Sequence[str] = ()
) -> Case:
    group = _cycle(sizing.load_cases)
    return Case(
        title=_titled(group, title),
        assessments=group,
        labels=["cycle"],
        is_feasible=sizing.is_feasible,
        sentence=f"The drives are {sizing.verdict}.",
        drives=_drives(document, {}),
        point_names=tuple(point_names),
        preface=_boxed(sizing._repr_html_() + _BELOW),
        pictures=sizing_pictures(sizing),
        inputs=_repeating(document),
    )


def _selection_case(
    selection: Selection, title: str | None, document: Mapping[str, Any], point_names: Sequence[str] = ()
) -> Case:
    """What was chosen first, then how it fares."""
    group = _cycle(selection.load_cases)
    sizing = selection.sizing
    chosen = "" if sizing is None else f"<h3>The first pair of each joint</h3>{sizing._repr_html_()}{_BELOW}"
    front = (arm_front_picture(selection.front()),) if document.get("front") else ()
    return Case(
        title=_titled(group, title),
        assessments=group,
        labels=["cycle"],
        is_feasible=selection.is_feasible,
        sentence=selection_view.sentence(document),
        drives=() if sizing is None else _drives(document["sizing"], _chosen(document)),
        point_names=tuple(point_names),
        preface=_boxed(selection_view.html(document) + chosen),
        pictures=() if sizing is None else (*front, *sizing_pictures(sizing)),
        inputs=_repeating(document),
        is_undecided=not selection.can_be_decided,
    )


_BELOW: Final = (
    "<p>Below the charts of the drives is the cycle, of load cases the first, held against the robot's limits.</p>"
)
# Keys of a sizing's document that say what was asked.
_ASKED: Final = ("task", "file", "inputs", "rank", "conditions", "load_cases", "catalogue")


def _cycle(cases: Sequence[LoadCase]) -> tuple[Assessment, ...]:
    """The first load case as one motion, with what the arm carries at each time."""
    return (assess_cycle(cases[0].cycle).whole,)


def _repeating(document: Mapping[str, Any]) -> dict[str, Any]:
    return {key: document[key] for key in _ASKED if document.get(key)}


def _paper_case(report: PaperReport, title: str | None) -> Case:
    group = (report.evidence.septic, report.evidence.lspb, report.evidence.quintic)
    rows = [
        [f"{claim.number}", f"{claim.text} ({claim.source})", claim.verdict, claim.explanation]
        for claim in report.claims
    ]
    claims = html_table(["", "claim", "verdict", "why"], rows, caption="The paper's claims, judged")
    case = _plain_case(group, "The paper's claims" if title is None else title, _boxed(claims))
    return replace(case, sentence=f"{report.verdict}. {case.sentence}", heading="Claims judged")


def _boxed(html: str) -> Markup:
    """Each table that has no box yet scrolls in one of its own. What values show of themselves is escaped already."""
    if '<div class="scroll"' not in html:
        html = html.replace("<table>", '<div class="scroll"><table>').replace("</table>", "</table></div>")
    return Markup('<div class="preface">{}</div>').format(Markup(html))


def _titled(group: Sequence[Assessment], title: str | None) -> str:
    return group[0].motion.robot.name if title is None else title
