"""``puma-septic compare``."""

from __future__ import annotations

from argparse import Namespace
from importlib import import_module

from puma_septic.cli.arguments import Answer
from puma_septic.cli.tasks import asked_task
from puma_septic.comparison import Comparison, compare
from puma_septic.report import new_folder, to_json
from puma_septic.task import ResolvedTask, resolve_task

__all__ = ["run"]


def run(arguments: Namespace) -> Answer:
    """All suitable profiles on one task; the answer is a comparison, not a verdict."""
    resolved = resolve_task(asked_task(arguments, "paper"))
    comparison = _compared(resolved, arguments)
    if arguments.out is not None:
        with new_folder(arguments.out) as folder:
            (folder / "comparison.json").write_text(to_json(comparison.to_dict()), encoding="utf-8")
            (folder / "comparison.csv").write_text(comparison.to_csv(), encoding="utf-8")
            # Templates, the replay and matplotlib take longer to load than everything else takes to compute.
            page = import_module("puma_septic.report.page")
            html = page.report_html(comparison, title=f"{resolved.task.name}: profiles compared")
            (folder / "report.html").write_text(html, encoding="utf-8")
            pictures = [import_module("puma_septic.pictures.comparison").comparison_picture(comparison)]
            import_module("puma_septic.report.svg").write_svg(folder, pictures)
            import_module("puma_septic.report.figures").write_png(folder, pictures)
    if arguments.format == "json":
        return Answer(to_json(comparison.to_dict()), 0)
    if arguments.format == "csv":
        return Answer(comparison.to_csv(), 0)
    return Answer(f"Task {resolved.task.name!r}, robot {resolved.robot.name!r}\n\n{comparison}", 0)


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
