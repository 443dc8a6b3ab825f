"""``puma-septic optimise``."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from puma_septic import profiles as families
from puma_septic.cli.arguments import Answer
from puma_septic.cli.tasks import asked_task
from puma_septic.errors import InputError
from puma_septic.optimisation import (
    LeastTime,
    OptimisedTimes,
    ParetoFront,
    least_time,
    optimise_via_times,
    pareto_front,
)
from puma_septic.report import new_folder, to_json
from puma_septic.task import ResolvedTask, Task, resolve_task
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["run"]

Result = OptimisedTimes | ParetoFront | LeastTime


def run(arguments: Namespace) -> Answer:
    """The via times of one profile, by one, two or three objectives, or for the least time."""
    if arguments.profile and len(arguments.profile) > 1:
        raise InputError(f"--profile: one profile is optimised at a time, got {', '.join(arguments.profile)}")
    task = asked_task(arguments, "paper")
    resolved = resolve_task(task)
    with _progress() as progress:
        result = _optimised(resolved, arguments, progress)
    document = to_json(result.to_dict())
    if arguments.out is not None:
        with new_folder(arguments.out) as folder:
            (folder / "optimisation.json").write_text(document, encoding="utf-8")
            # Templates and matplotlib take longer to load than most optimisations take.
            pictures = [import_module("puma_septic.pictures.front").optimisation_picture(result)]
            import_module("puma_septic.report.svg").write_svg(folder, pictures)
            import_module("puma_septic.report.figures").write_png(folder, pictures)
    text = document if arguments.format == "json" else f"Task {task.name!r}\n{result}"
    return Answer(text, 0 if _is_feasible(result) else 1)


def _is_feasible(result: Result) -> bool:
    """Whether all motions found keep all known limits."""
    if isinstance(result, LeastTime):
        return result.is_feasible
    verdicts = result.verdicts if isinstance(result, ParetoFront) else (result.verdict,)
    return all(verdict is None or verdict.is_feasible for verdict in verdicts)


def _optimised(resolved: ResolvedTask, arguments: Namespace, progress: Any) -> Result:
    objectives = arguments.objective or ["integral_of_squared_jerk"]
    make = _make(resolved.task)
    common = {
        "robot": resolved.robot,
        "dwell": resolved.task.dwell,
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
        return pareto_front(make, resolved.points, resolved.times, objectives=objectives, size=arguments.size, **common)
    return optimise_via_times(
        make, resolved.points, resolved.times, objective=objectives[0], restarts=arguments.restarts, **common
    )


def _make(task: Task) -> Any:
    """The task's first profile as a function of points and times; without options the function itself."""
    choice = task.profiles[0]
    family = families.family(choice.name)
    if not family.takes_times(choice.options):
        raise InputError(f"profile {choice.name!r} finds its own times; there are no via times to choose")
    if not choice.options and "durations" not in family.options:
        return family.function

    def make(points: Array, times: Array, **free: Array) -> Trajectory:
        return families.make(choice.name, points, times, options=choice.options | free)

    return make


@contextmanager
def _progress() -> Iterator[Any]:
    """A bar on stderr, where that is a terminal."""
    bar = import_module("tqdm").tqdm(file=sys.stderr, disable=None, leave=False, unit="search")

    def progress(done: int, total: int) -> None:
        bar.total = total
        bar.update(done - bar.n)

    try:
        yield progress
    finally:
        bar.close()
