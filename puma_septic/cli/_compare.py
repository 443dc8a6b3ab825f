"""``puma-septic compare``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING

from puma_septic.cli._arguments import (
    add_dwell,
    add_margin,
    add_payload,
    add_profile,
    add_recording,
    add_task,
    asked_task,
    in_reserve,
    left_by_margin,
    reserve,
    with_margin,
)
from puma_septic.cli._output_arguments import add_format, add_out, add_verbose, asked_units, origin, with_report
from puma_septic.cli._parser import UNDECIDED, Answer

if TYPE_CHECKING:
    from collections.abc import Callable

    from puma_septic.comparison import Comparison
    from puma_septic.motion import Motion
    from puma_septic.optimum import TimeOptimal
    from puma_septic.robot import Robot
    from puma_septic.task import ResolvedTask
    from puma_septic.trajectory import Trajectory

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "all suitable profiles on one task, measured exactly"

DESCRIPTION = """\
Compare all suitable profiles on the points and times of a task (the paper's by default).

Each is assessed exactly. The first sentence says which to take: of those that go through all points and keep all known
limits, the one with the least of the first objective. Pareto-optimal profiles in the named objectives are marked.

Exit code: 0 compared, 2 bad input, 3 a recorded motion's noise or units leave its verdict open."""

EXAMPLES = """compare paper-turned
compare task.yaml --profile quintic --profile septic --objective rms_torque --out comparison
compare paper-turned --profile septic --profile quintic --reference"""


def add_arguments(parser: ArgumentParser) -> None:
    """The task, its load, which profiles, by which objectives, in which form."""
    add_task(parser)
    add_profile(parser, "only this profile (repeatable)")
    add_payload(parser)
    add_dwell(parser)
    add_margin(parser)
    parser.add_argument(
        "--objective",
        action="append",
        metavar="NAME",
        help="mark the Pareto-optimal profiles in these objectives (repeatable; default: integral_of_squared_jerk,"
        " overshoot, via_miss)",
    )
    add_verbose(parser, "all profiles in all quantities, and those that do not suit")
    add_format(parser, "text", "json", "csv")
    parser.add_argument(
        "--reference",
        action="store_true",
        help="beside each profile its least duration, and the gap to the quickest motion along its path",
    )
    add_out(parser, "report.html, JSON, CSV and a figure")
    add_recording(parser)


def run(arguments: Namespace) -> Answer:
    """All suitable profiles on one task; the answer is a comparison, not a verdict."""
    from puma_septic.report import to_json
    from puma_septic.task import resolve_task

    if arguments.csv is not None:
        from puma_septic.cli._recorded import recorded, told

        what = recorded(arguments)
        robot, title, head = with_margin(what.robot, arguments), what.path, told(what)
        comparison = _beside(what.motion.trajectory, robot, arguments)
        names: Sequence[str] = ()
    else:
        resolved = left_by_margin(resolve_task(asked_task(arguments, "paper")), arguments)
        comparison, title, names = _compared(resolved, arguments), resolved.task.name, resolved.names
        head = f"Task {resolved.task.name!r}, robot {resolved.robot.name!r}, {resolved.times[-1]:g} s"
    code = UNDECIDED if any(row["undecided"] for row in comparison.to_dict()["profiles"]) else 0
    if arguments.out is not None:
        _write_folder(arguments, comparison, f"{title}: profiles compared{in_reserve(arguments)}", names)
    if arguments.format == "json":
        return Answer(to_json(comparison.to_dict() | reserve(arguments)), code)
    if arguments.format == "csv":
        return Answer(comparison.to_csv(), code)
    from puma_septic.views.comparison import short_text, text

    shown = text if arguments.verbose else short_text
    head = f"{head}{in_reserve(arguments)}"
    return Answer(with_report(f"{head}\n\n{shown(comparison.to_dict())}", arguments), code)


def _write_folder(arguments: Namespace, comparison: Comparison, title: str, names: Sequence[str]) -> None:
    """Report, document, table and figure."""
    # Templates and matplotlib take longer to load than everything else takes to compute.
    from puma_septic.pictures.comparison import comparison_picture
    from puma_septic.report import new_folder, to_json
    from puma_septic.report.figures import write_png
    from puma_septic.report.page import report_html
    from puma_septic.report.svg import write_svg

    with new_folder(arguments.out, overwrite=arguments.force) as folder:
        (folder / "comparison.json").write_text(to_json(comparison.to_dict() | reserve(arguments)), encoding="utf-8")
        (folder / "comparison.csv").write_text(comparison.to_csv(), encoding="utf-8")
        page = report_html(
            comparison, title=title, point_names=names, made=origin(arguments), units=asked_units(arguments)
        )
        (folder / "report.html").write_text(page, encoding="utf-8")
        pictures = [comparison_picture(comparison)]
        write_svg(folder, pictures)
        if not arguments.no_png:
            write_png(folder, pictures)


def _beside(recorded: Trajectory, robot: Robot, arguments: Namespace) -> Comparison:
    """A recorded motion beside the profiles through the points at which it stops."""
    from puma_septic.comparison import compare
    from puma_septic.logs import stops

    times, points = stops(recorded)
    objectives = {"objectives": arguments.objective} if arguments.objective else {}
    return compare(
        robot,
        points,
        times,
        profiles=arguments.profile,
        beside={"recorded": recorded},
        dwell=arguments.dwell or 0.0,
        reference=_reference(arguments),
        **objectives,
    )


def _reference(arguments: Namespace) -> Callable[[Motion], TimeOptimal] | None:
    if not arguments.reference:
        return None
    from puma_septic.optimum import time_optimal

    return time_optimal


def _compared(resolved: ResolvedTask, arguments: Namespace) -> Comparison:
    """With the task's options for the profiles that it names."""
    from puma_septic.comparison import compare

    wanted = arguments.profile
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
        floor=resolved.task.floor,
        tool_limits=resolved.tool_limits,
        rest_before=resolved.task.rest_before,
        rest_after=resolved.task.rest_after,
        reference=_reference(arguments),
        own=[choice.name for choice in resolved.task.profiles],
        **objectives,
    )
