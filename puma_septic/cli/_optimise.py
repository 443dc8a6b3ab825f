"""``puma-septic optimise``."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from puma_septic.cli._arguments import (
    add_dwell,
    add_margin,
    add_payload,
    add_profile,
    add_task,
    asked_task,
    count,
    in_reserve,
    left_by_margin,
    reserve,
)
from puma_septic.cli._output_arguments import add_format, add_out, asked_units, origin, with_report
from puma_septic.cli._parser import UNDECIDED, Answer

if TYPE_CHECKING:
    from puma_septic.optimisation import LeastTime, OptimisedTimes, ParetoFront
    from puma_septic.task import ResolvedTask, Task
    from puma_septic.trajectory import Trajectory
    from puma_septic.validation import Array

    Result = OptimisedTimes | ParetoFront | LeastTime

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "via times for one or more objectives, or the least time"

DESCRIPTION = """\
Choose the via times of a task (the paper's by default) for its total time.

Minimises one objective, or computes the Pareto front of two or three. The objective 'duration' chooses the total time
as well: the least within all known limits of the robot, or within those named by --respect. What is found is assessed
in full, and violated limits are named. Exit code: 0 every motion shown keeps all known limits, 1 one of them
violates a limit, 2 bad input or no motion keeps the limits to respect, 3 undecided: the units of the points leave it
open."""

EXAMPLES = """optimise task.yaml --objective duration
optimise task.yaml --objective rms_torque --write best.yaml
optimise task.yaml --objective rms_torque --objective integral_of_squared_jerk --points 20"""


def add_arguments(parser: ArgumentParser) -> None:
    """The task, its load, the objectives, the constraints and the effort of the search."""
    add_task(parser)
    add_profile(parser, "use this profile instead of the task's first")
    add_payload(parser)
    add_dwell(parser)
    add_margin(parser)
    parser.add_argument(
        "--objective",
        action="append",
        metavar="NAME",
        help="objective to minimise (default: integral_of_squared_jerk); two or three for a Pareto front, 'duration'"
        " for the least time",
    )
    parser.add_argument(
        "--free",
        action="append",
        default=[],
        metavar="NAME",
        help="optimise these parameters of the profile too: velocities, accelerations (at the vias), free_knots"
        " (repeatable)",
    )
    parser.add_argument(
        "--max-overshoot",
        type=float,
        metavar="RAD",
        help="maximum excess of any joint beyond the points (m if prismatic)",
    )
    parser.add_argument(
        "--respect",
        action="append",
        default=[],
        metavar="QUANTITY",
        help="robot limits that the motion must keep: position, velocity, acceleration, jerk, effort (repeatable;"
        " default: none, for 'duration' all that are known)",
    )
    parser.add_argument("--restarts", type=int, default=4, metavar="N", help="random restarts (default: 4)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="random seed (default: 0)")
    parser.add_argument(
        "--points", type=count, default=12, metavar="N", help="number of points on the Pareto front (default: 12)"
    )
    add_format(parser, "text", "json", "csv")
    add_out(parser, "report.html, JSON and figures")
    parser.add_argument(
        "--write",
        metavar="FILE",
        help="write the optimum as a task with its times (.yaml), which every command reads, or as a ROS"
        " JointTrajectory (.json), which check reads; --force replaces a file",
    )


def run(arguments: Namespace) -> Answer:
    """The via times of one profile, by one, two or three objectives, or for the least time."""
    from puma_septic.assessment import assess
    from puma_septic.document import records_csv
    from puma_septic.errors import InputError
    from puma_septic.report import to_json
    from puma_septic.task import resolve_task

    if arguments.profile and len(arguments.profile) > 1:
        raise InputError(f"--profile: one profile is optimised at a time, got {', '.join(arguments.profile)}")
    _check_write(arguments)
    task = asked_task(arguments, "paper", profiles=arguments.profile)
    resolved = left_by_margin(resolve_task(task), arguments)
    with _progress() as progress:
        result = _optimised(resolved, arguments, progress)
    doubts = assess(resolved.robot, resolved.trajectories[0]).undecided
    found = result.to_dict() | reserve(arguments)
    if doubts:
        found |= {"undecided": list(doubts)} | ({"is_feasible": False} if "is_feasible" in found else {})
    document = to_json(found)
    code = UNDECIDED if doubts else 0 if _is_feasible(result) else 1
    if arguments.out is not None:
        _write_folder(arguments, result, document, resolved)
    if arguments.write is not None:
        _write_optimum(arguments, resolved, result)
    if arguments.format == "csv":
        return Answer(records_csv(_records(result.to_dict())), code)
    head = "".join([f"Task {task.name!r}{in_reserve(arguments)}", *(f"\nUndecided: {doubt}" for doubt in doubts)])
    text = document if arguments.format == "json" else f"{head}\n{result}"
    return Answer(with_report(text, arguments), code)


def _check_write(arguments: Namespace) -> None:
    """Refuse what cannot be written before the search."""
    from puma_septic.cli._motion_file import check_place
    from puma_septic.errors import InputError

    if arguments.write is None:
        return
    check_place(arguments)
    if len(arguments.objective or ()) > 1:
        raise InputError("--write: a Pareto front has many optima; choose one objective")
    if not arguments.write.endswith((".yaml", ".yml", ".json")):
        raise InputError(f"--write {arguments.write}: name a task, .yaml, or a JointTrajectory, .json")


def _write_optimum(arguments: Namespace, resolved: ResolvedTask, result: Result) -> None:
    """The task with the optimum's times, or the motion itself."""
    from puma_septic.cli._motion_file import write_motion
    from puma_septic.errors import InputError
    from puma_septic.optimisation import ParetoFront
    from puma_septic.outputs import write_file
    from puma_septic.task import make_task, resolve_task, task_text

    if isinstance(result, ParetoFront):
        return
    found = result.trajectory
    if arguments.write.endswith(".json"):
        write_motion(arguments, found, resolved.robot)
        return
    document = resolved.task.document()
    document.pop("durations", None)
    free = {key: value.tolist() for key, value in getattr(result, "free_values", {}).items()}
    choice = {"name": resolved.task.profiles[0].name, **resolved.task.profiles[0].options, **free}
    best = make_task({**document, "times": found.times.tolist(), "profiles": [choice]}, origin=resolved.task.origin)
    if not _is_same(resolve_task(best).trajectories[0], found):
        raise InputError(
            f"--write {arguments.write}: no task says this optimum, of which more than times was free; .json"
        )
    text = task_text(best, comment="Found by puma-septic optimise.")
    write_file(arguments.write, text, overwrite=arguments.force)


def _is_same(one: Trajectory, other: Trajectory) -> bool:
    """Whether two motions are one, to the digits that a file keeps."""
    import numpy as np

    t = np.linspace(0.0, min(one.duration, other.duration), 201)
    near = np.allclose(one(t), other(t), rtol=0.0, atol=1e-9)
    return bool(near and abs(one.duration - other.duration) <= 1e-9 * other.duration)


def _records(document: dict[str, Any]) -> list[dict[str, Any]]:
    """One for each motion that was found, the start first."""
    if "front" in document:
        names = [one["name"] for one in document["objectives"]]
        points = [("start", document["start"]), *((f"{k + 1}", one) for k, one in enumerate(document["front"]))]
        return [
            {"motion": name, "t": one["times"], **dict(zip(names, one["values"], strict=True))} for name, one in points
        ]
    if "duration" in document:
        found = [("start", document["start"]), ("optimum", document)]
        return [{"motion": name, "t": one["times"], "duration": one["duration"]} for name, one in found if one]
    value = document["objective"]["name"]
    return [
        {"motion": name, "t": document[name]["times"], value: document[name]["value"]} for name in ("start", "optimum")
    ]


def _write_folder(arguments: Namespace, result: Result, document: str, resolved: ResolvedTask) -> None:
    """Report, document and figure."""
    # matplotlib takes longer to load than most optimisations take.
    from puma_septic.pictures.comparison import optimisation_picture
    from puma_septic.report import new_folder
    from puma_septic.report.figures import write_png
    from puma_septic.report.page import optimised_html
    from puma_septic.report.svg import write_svg

    with new_folder(arguments.out, overwrite=arguments.force) as folder:
        (folder / "optimisation.json").write_text(document, encoding="utf-8")
        page = optimised_html(
            result,
            resolved.robot,
            dwell=resolved.task.dwell,
            floor=resolved.task.floor,
            tool_limits=resolved.tool_limits,
            title=f"{resolved.task.name}: optimised{in_reserve(arguments)}",
            point_names=resolved.names,
            made=origin(arguments),
            units=asked_units(arguments),
        )
        (folder / "report.html").write_text(page, encoding="utf-8")
        pictures = [optimisation_picture(result)]
        write_svg(folder, pictures)
        if not arguments.no_png:
            write_png(folder, pictures)


def _is_feasible(result: Result) -> bool:
    """Whether all motions found keep all known limits."""
    from puma_septic.optimisation import LeastTime, ParetoFront

    if isinstance(result, LeastTime):
        return result.is_feasible
    verdicts = result.verdicts if isinstance(result, ParetoFront) else (result.verdict,)
    return all(verdict is None or verdict.is_feasible for verdict in verdicts)


def _optimised(resolved: ResolvedTask, arguments: Namespace, progress: Any) -> Result:
    from puma_septic.optimisation import least_time, optimise_via_times, pareto_front

    objectives = arguments.objective or ["integral_of_squared_jerk"]
    make = _make(resolved.task)
    common = {
        "robot": resolved.robot,
        "dwell": resolved.task.dwell,
        "floor": resolved.task.floor,
        "tool_limits": resolved.tool_limits,
        "max_overshoot": arguments.max_overshoot,
        "free": arguments.free,
        "seed": arguments.seed,
        "progress": progress,
    }
    if objectives == ["duration"]:
        keep = arguments.respect or None
        return least_time(make, resolved.points, resolved.times, keep=keep, restarts=arguments.restarts, **common)
    common |= {"keep": arguments.respect}
    if len(objectives) > 1:
        return pareto_front(
            make, resolved.points, resolved.times, objectives=objectives, size=arguments.points, **common
        )
    return optimise_via_times(
        make, resolved.points, resolved.times, objective=objectives[0], restarts=arguments.restarts, **common
    )


def _make(task: Task) -> Any:
    """The task's first profile as a function of points and times; without options the function itself."""
    from puma_septic import profiles as families
    from puma_septic.errors import InputError

    choice = task.profiles[0]
    family = families.family(choice.name)
    if not family.takes_times(choice.options):
        raise InputError(f"profile {choice.name!r} finds its own times; there are no via times to choose")
    rests = task.rest_before and task.rest_after
    if rests and not choice.options and "durations" not in family.options:
        return family.function

    def make(points: Array, times: Array, **free: Array) -> Trajectory:
        made = families.make(choice.name, points, times, options=choice.options | free)
        return made.resting(before=task.rest_before, after=task.rest_after)

    return make


@contextmanager
def _progress() -> Iterator[Any]:
    """A bar on stderr, where that is a terminal."""
    from tqdm import tqdm

    bar = tqdm(file=sys.stderr, disable=None, leave=False, unit="search")

    def progress(done: int, total: int) -> None:
        bar.total = total
        bar.update(done - bar.n)

    try:
        yield progress
    finally:
        bar.close()
