"""What ``puma-septic assess`` does with tasks; recorded motions stand in `_recorded`."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence

from puma_septic.assessment import Assessment
from puma_septic.cli._arguments import asked_task
from puma_septic.cli._assess_cycle import cycle_answer
from puma_septic.cli._motion_file import check_place, write_motion
from puma_septic.cli._output_arguments import asked_units, origin, with_report
from puma_septic.cli._parser import UNDECIDED, Answer
from puma_septic.cli._task_text import assessed_text, turned_text
from puma_septic.outputs import file_names
from puma_septic.pictures import assessment_pictures, in_units
from puma_septic.report import assess_document, metrics_csv, new_folder, profile_labels, samples_csv, to_json
from puma_septic.task import ResolvedTask, Task, assess_task, resolve_task

__all__ = ["answer"]

PAPER, TURNED = "paper", "paper-turned"
Assessed = tuple[ResolvedTask, tuple[Assessment, ...]]


def answer(arguments: Namespace) -> Answer:
    """Assess the asked task; without one, the paper's task and then the one with the tool turned."""
    task = asked_task(arguments, PAPER, profiles=arguments.profile)
    if task.cycle:
        return cycle_answer(arguments, task)
    check_place(arguments)
    asked = [_assessed(task)]
    shown = (
        asked
        if arguments.task is not None
        else [*asked, _assessed(asked_task(arguments, TURNED, profiles=arguments.profile))]
    )
    if arguments.format == "json":
        text = to_json(assess_document(shown, margin=arguments.margin))
    elif arguments.format == "csv":
        text = metrics_csv(shown)
    else:
        first = assessed_text(*asked[0], arguments.margin, verbosity=arguments.verbose)
        parts = [first, *(turned_text(*one) for one in shown[1:])]
        text = "\n\n".join(parts)
    if arguments.out is not None:
        _write_folder(arguments, shown)
    if arguments.write is not None:
        write_motion(arguments, asked[0][0].trajectories[0], asked[0][0].robot)
    if any(one.undecided for one in asked[0][1]):
        return Answer(with_report(text, arguments), UNDECIDED)
    is_feasible = not any(one.keeps(arguments.margin) for one in asked[0][1])
    return Answer(with_report(text, arguments), 0 if is_feasible else 1)


def _assessed(task: Task) -> Assessed:
    resolved = resolve_task(task)
    return resolved, assess_task(resolved)


def _write_folder(arguments: Namespace, shown: Sequence[Assessed]) -> None:
    """Report, document and table of all, and for each task samples and figures in a folder of its own."""
    # Templates and the replay's libraries take longer to load than an assessment takes; matplotlib far longer.
    from puma_septic.report.page import tasks_html
    from puma_septic.report.svg import write_svg

    with new_folder(arguments.out, overwrite=arguments.force) as folder:
        (folder / "report.html").write_text(
            tasks_html(shown, margin=arguments.margin, made=origin(arguments), units=asked_units(arguments)),
            encoding="utf-8",
        )
        (folder / "assessment.json").write_text(
            to_json(assess_document(shown, margin=arguments.margin)), encoding="utf-8"
        )
        (folder / "metrics.csv").write_text(metrics_csv(shown), encoding="utf-8")
        places = file_names([resolved.task.name for resolved, _ in shown])
        for place, (_, assessments) in zip(places, shown, strict=True):
            inner = folder / place
            inner.mkdir()
            labels = profile_labels(assessments)
            for label, assessment in zip(labels, assessments, strict=True):
                (inner / f"samples-{label}.csv").write_text(samples_csv(assessment), encoding="utf-8")
            pictures = [in_units(one, asked_units(arguments)) for one in assessment_pictures(assessments, labels)]
            write_svg(inner, pictures)
            if not arguments.no_png:
                from puma_septic.report.figures import write_png

                write_png(inner, pictures)
