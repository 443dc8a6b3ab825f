"""What ``puma-septic assess`` does with a task that has a cycle."""

from __future__ import annotations

from argparse import Namespace

from puma_septic._version import __version__
from puma_septic.cli._motion_file import check_place, write_motion
from puma_septic.cli._output_arguments import asked_units, origin, with_report
from puma_septic.cli._parser import UNDECIDED, Answer
from puma_septic.cli._task_text import wrapped
from puma_septic.cycle import CycleAssessment
from puma_septic.report import named_metrics_csv, new_folder, reserve_document, samples_csv, to_json, unmet_document
from puma_septic.ros import write_joint_trajectory
from puma_septic.task import ResolvedCycle, Task, resolve_cycle
from puma_septic.views import cycle as view
from puma_septic.views.checks import unmet_text

__all__ = ["cycle_answer"]


def cycle_answer(arguments: Namespace, task: Task) -> Answer:
    """Assess every motion of the cycle with what it carries."""
    check_place(arguments)
    resolved = resolve_cycle(task)
    assessed = resolved.assess()
    if arguments.out is not None:
        _write_folder(arguments, resolved, assessed)
    if arguments.write is not None:
        write_motion(arguments, resolved.trajectory, resolved.robot)
    text = _text(arguments, resolved, assessed)
    if assessed.whole.undecided:
        return Answer(with_report(text, arguments), UNDECIDED)
    return Answer(with_report(text, arguments), 1 if assessed.whole.keeps(arguments.margin) else 0)


def _text(arguments: Namespace, resolved: ResolvedCycle, assessed: CycleAssessment) -> str:
    if arguments.format == "json":
        return to_json(_document(resolved, assessed, arguments.margin))
    if arguments.format == "csv":
        return _metrics(resolved, assessed)
    document = assessed.to_dict()
    parts = [_head(resolved), wrapped(view.head(document)), view.steps_text(document)]
    if arguments.margin:
        parts.append(_margin(assessed, arguments.margin))
    if not arguments.verbose:
        unknown = document["whole"]["not_assessed"]
        doubts = document["whole"]["doubts"]
        told = [f"Doubtful data: {'; '.join(doubts)}."] if doubts else []
        told += [f"Not assessed: {'; '.join(unknown)}"] if unknown else []
        more = "More: -v shows the motion that governs in full, -vv all motions."
        return "\n\n".join([*parts, "\n".join(map(wrapped, [*told, more]))])
    for k in assessed.order if arguments.verbose > 1 else assessed.order[:1]:
        parts += [f"---- {assessed.motion_names[k]} ".ljust(100, "-"), wrapped(str(assessed.motions[k]))]
    return "\n\n".join(parts)


def _head(resolved: ResolvedCycle) -> str:
    task, robot = resolved.task, resolved.robot
    load = f", always carrying {robot.payload.mass:g} kg" if robot.payload is not None else ""
    lines = [
        f"Task {task.name!r}" + (f": {' '.join(task.description.split())}" if task.description else ""),
        f"Robot: {robot.name}, tool {robot.tool!r}{load}",
    ]
    if resolved.branch.configuration != "only":
        lines.append(f"Branch: {resolved.branch.configuration}{' (chosen)' if task.branch == 'auto' else ''}")
    return "\n".join(wrapped(line) for line in lines)


def _margin(assessed: CycleAssessment, margin: float) -> str:
    unmet = assessed.whole.keeps(margin)
    kept = f"every known limit is kept with {100 * margin:g} % to spare"
    return wrapped(unmet_text(unmet, assessed.whole.not_assessed, margin) if unmet else kept)


def _document(resolved: ResolvedCycle, assessed: CycleAssessment, margin: float) -> dict[str, object]:
    task = {"task": resolved.task.document(), "origin": resolved.task.origin, "branch": resolved.branch.configuration}
    reserve = reserve_document([assessed.whole], margin) | unmet_document(assessed.whole, margin)
    return {**assessed.to_dict(), "version": __version__, **task, **reserve}


def _metrics(resolved: ResolvedCycle, assessed: CycleAssessment) -> str:
    named = zip(assessed.motion_names, assessed.motions, strict=True)
    return named_metrics_csv([(f"{resolved.task.name}: {name}", [one]) for name, one in named])


def _write_folder(arguments: Namespace, resolved: ResolvedCycle, assessed: CycleAssessment) -> None:
    """Report, document, table, and the whole cycle as samples, pictures and JointTrajectory."""
    # Templates and the replay's libraries take longer to load than an assessment takes; matplotlib far longer.
    from puma_septic.pictures import assessment_pictures, in_units
    from puma_septic.report.page import cycle_html
    from puma_septic.report.svg import write_svg

    with new_folder(arguments.out, overwrite=arguments.force) as folder:
        page = cycle_html(
            assessed,
            task=resolved.task,
            point_names=resolved.stops,
            margin=arguments.margin,
            made=origin(arguments),
            units=asked_units(arguments),
        )
        (folder / "report.html").write_text(page, encoding="utf-8")
        (folder / "cycle.json").write_text(to_json(_document(resolved, assessed, arguments.margin)), encoding="utf-8")
        (folder / "metrics.csv").write_text(_metrics(resolved, assessed), encoding="utf-8")
        (folder / "samples.csv").write_text(samples_csv(assessed.whole), encoding="utf-8")
        write_joint_trajectory(folder / "trajectory.yaml", resolved.trajectory, joint_names=resolved.robot.joint_names)
        pictures = [in_units(one, asked_units(arguments)) for one in assessment_pictures([assessed.whole], ["cycle"])]
        write_svg(folder, pictures)
        if not arguments.no_png:
            from puma_septic.report.figures import write_png

            write_png(folder, pictures)
