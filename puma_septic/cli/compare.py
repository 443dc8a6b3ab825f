"""``puma-septic compare``."""

from __future__ import annotations

from argparse import Namespace
from importlib import import_module

from puma_septic.cli.arguments import Answer
from puma_septic.cli.tasks import asked_task
from puma_septic.comparison import Comparison, compare
from puma_septic.report import new_folder, to_json
from puma_septic.robot import Robot
from puma_septic.task import ResolvedTask, resolve_task
from puma_septic.trajectory import Trajectory

__all__ = ["run"]


def run(arguments: Namespace) -> Answer:
    """All suitable profiles on one task; the answer is a comparison, not a verdict."""
    if arguments.csv is not None:  # SciPy, which fits it, takes a while to load
        log = import_module("puma_septic.cli.log")
        what = log.recorded(arguments)
        comparison, title, head = _beside(what.motion.trajectory, what.robot, arguments), what.path, log.told(what)
        code = log.UNDECIDED if what.motion.trajectory.doubts else 0
    else:
        resolved = resolve_task(asked_task(arguments, "paper"))
        comparison, title, code = _compared(resolved, arguments), resolved.task.name, 0
        head = f"Task {resolved.task.name!r}, robot {resolved.robot.name!r}"
    if arguments.out is not None:
        with new_folder(arguments.out) as folder:
            (folder / "comparison.json").write_text(to_json(comparison.to_dict()), encoding="utf-8")
            (folder / "comparison.csv").write_text(comparison.to_csv(), encoding="utf-8")
            # Templates, the replay and matplotlib take longer to load than everything else takes to compute.
            page = import_module("puma_septic.report.page")
            html = page.report_html(comparison, title=f"{title}: profiles compared")
            (folder / "report.html").write_text(html, encoding="utf-8")
            pictures = [import_module("puma_septic.pictures.comparison").comparison_picture(comparison)]
            import_module("puma_septic.report.svg").write_svg(folder, pictures)
            import_module("puma_septic.report.figures").write_png(folder, pictures)
    if arguments.format == "json":
        return Answer(to_json(comparison.to_dict()), code)
    if arguments.format == "csv":
        return Answer(comparison.to_csv(), code)
    return Answer(f"{head}\n\n{comparison}", code)


def _beside(recorded: Trajectory, robot: Robot, arguments: Namespace) -> Comparison:
    """A recorded motion beside the profiles through the points at which it stops."""
    times, points = import_module("puma_septic.logs").stops(recorded)
    objectives = {"objectives": arguments.objective} if arguments.objective else {}
    return compare(
        robot,
        points,
        times,
        profiles=arguments.compared,
        beside={"recorded": recorded},
        dwell=arguments.dwell or 0.0,
        **objectives,
    )


def _compared(resolved: ResolvedTask, arguments: Namespace) -> Comparison:
    """With the task's options for the profiles that it names."""
    wanted = arguments.compared
    options = {
        choice.name: choice.options
        for choice in resolved.task.profiles
        if choice.options and (wanted is None or choice.name in wanted)
    }
    objectives = {"objectives": arguments.objective} if arguments.objective else {}
    return compare(
        resolved.robot,
        resolved.points,
        resolved.times,
        profiles=wanted,
        options=options,
        dwell=resolved.task.dwell,
        **objectives,
    )
