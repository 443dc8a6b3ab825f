"""What ``puma-septic size`` does: the cycle, the drives or the catalogue, and the folder."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, final

from puma_septic.assessment import assess
from puma_septic.cli._output_arguments import with_report
from puma_septic.cli._parser import UNDECIDED, Answer
from puma_septic.cli._task_arguments import asked_task
from puma_septic.cli._task_text import wrapped
from puma_septic.cycle import Cycle, Dwell, with_return
from puma_septic.drives import (
    BUILT_IN,
    Catalogue,
    built_in_catalogue,
    load_catalogue,
)
from puma_septic.errors import InputError
from puma_septic.motion import Motion, compute_motion
from puma_septic.report import new_folder, to_json
from puma_septic.report.csv import checks_csv, load_profile_csv, pairs_csv
from puma_septic.report.folder import file_names
from puma_septic.robot import load_drivetrains
from puma_septic.sizing import Selection, Sizing, size
from puma_septic.task import ResolvedTask, resolve_task

__all__ = ["answer"]

# Pairs that are shown per joint unless --keep tells another number.
_KEPT: Final = 3


def answer(arguments: Namespace) -> Answer:
    """Size the arm's own drives, or choose from a catalogue."""
    asked = _asked(arguments)
    cycle = asked.cycle
    found = _own_sizing(arguments, cycle) if arguments.catalogue is None else _selection(arguments, cycle)
    if arguments.out is not None:
        _write_folder(arguments, found, f"{asked.name}: sizing")
    text = _text(arguments, asked, found)
    if isinstance(found, Sizing) or found.sizing is not None:  # without drives there is no report
        text = with_report(text, arguments)
    return Answer(text, asked.code or (0 if found.is_feasible else 1))


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Asked:
    """A cycle and where it comes from; `code` is an exit code that stands whatever the drives can do, or 0."""

    name: str
    cycle: Cycle
    head: str
    document: dict[str, Any]
    code: int = 0


def _questions(doubts: Sequence[str]) -> str:
    return "".join(f"\nUndecided: {doubt}" for doubt in doubts)


def _asked(arguments: Namespace) -> _Asked:
    """The cycle of a task, or of a recorded motion as it is, with the asked rest."""
    if arguments.csv is None:
        resolved = resolve_task(asked_task(arguments, "paper", profiles=arguments.profile))
        doubts = list(assess(resolved.robot, resolved.trajectories[0]).undecided)
        return _Asked(
            name=resolved.task.name,
            cycle=_cycle(resolved, one_way=arguments.one_way),
            head=f"Task {resolved.task.name!r}, profile {resolved.trajectories[0].profile}{_questions(doubts)}",
            document={"task": resolved.task.document(), **({"undecided": doubts} if doubts else {})},
            code=UNDECIDED if doubts else 0,
        )
    if arguments.profile is not None:
        raise InputError("--profile does not go with --csv: the file has the points")
    from puma_septic.cli._recorded import recorded, told  # SciPy, which fits it, takes a while to load

    what = recorded(arguments)
    doubts = list(what.motion.trajectory.doubts)
    rest = (Dwell(duration=arguments.dwell),) if arguments.dwell else ()
    return _Asked(
        name=what.path,
        cycle=Cycle(steps=(what.motion, *rest)),
        head=f"{told(what)}{_questions(doubts)}\nThe cycle is the recorded motion alone",
        document={"file": what.path, "undecided": doubts},
        code=UNDECIDED if doubts else 0,
    )


def _cycle(resolved: ResolvedTask, *, one_way: bool) -> Cycle:
    """The task's first profile and, unless one way, the way back with an empty hand, each with the task's rest."""
    motion = compute_motion(resolved.robot, resolved.trajectories[0])
    dwell = resolved.task.dwell
    if one_way:
        return Cycle(steps=(motion, Dwell(duration=dwell)) if dwell else (motion,))
    return with_return(motion, dwell=dwell, robot_back=resolved.robot.with_payload(None))


def _own_sizing(arguments: Namespace, cycle: Cycle) -> Sizing:
    """The arm's own drives, as far as a file, the built-in one, or its actuators alone tell."""
    idle = [f"--{name}" for name in ("rank", "keep", "masses") if getattr(arguments, name) is not None]
    if idle:
        raise InputError(f"{', '.join(idle)} goes with --catalogue: name the parts to choose from")
    robot = cycle.robot
    try:
        trains = load_drivetrains(robot, arguments.drives)
    except InputError as error:
        raise InputError(f"{error}, or choose drives: --catalogue FILE") from error
    return size(cycle, drivetrains=trains)


def _selection(arguments: Namespace, cycle: Cycle) -> Selection:
    """From a catalogue, with the electronics of a drives file where one is given."""
    places = None if arguments.drives is None else load_drivetrains(cycle.robot, arguments.drives)
    return size(
        cycle,
        catalogue=_catalogue(arguments.catalogue),
        drivetrains=places,
        rank=arguments.rank or "mass",
        keep=arguments.keep or _KEPT,
        masses=arguments.masses,
    )


def _catalogue(files: list[str]) -> Catalogue:
    if len(files) == 1 and files[0] in BUILT_IN:
        return built_in_catalogue(files[0])
    if len(files) not in (2, 3):
        raise InputError(
            f"--catalogue {' '.join(files)}: expected one of {', '.join(BUILT_IN)}, or two or three CSV files: motors,"
            " gearboxes and, if not all fit together, pairs"
        )
    return load_catalogue(*files)


def _text(arguments: Namespace, asked: _Asked, found: Sizing | Selection) -> str:
    if arguments.format == "json":
        return to_json({**asked.document, **found.to_dict()})
    if arguments.format == "csv":
        return checks_csv(found) if isinstance(found, Sizing) else pairs_csv(found)
    steps = [_step(step) for step in found.cycle.steps]
    head = f"{asked.head}: {', '.join(steps)}"
    return "\n\n".join([wrapped(head), wrapped(str(found)), *_more(found)])


def _step(step: Motion | Dwell) -> str:
    if isinstance(step, Dwell):
        return f"rest {step.duration:g} s"
    payload = step.robot.payload
    return f"move {step.trajectory.duration:g} s with {0 if payload is None else payload.mass:g} kg"


def _more(found: Sizing | Selection) -> list[str]:
    """The chosen drives in full."""
    if isinstance(found, Sizing) or found.sizing is None:
        return []
    return ["The first pair of each joint:", wrapped(str(found.sizing))]


def _write_folder(arguments: Namespace, found: Sizing | Selection, title: str) -> None:
    """Report, document, one table of checks, one of pairs, a load profile per motor, and figures."""
    sizing = found if isinstance(found, Sizing) else found.sizing
    with new_folder(arguments.out, overwrite=arguments.force) as folder:
        (folder / "sizing.json").write_text(to_json(found.to_dict()), encoding="utf-8")
        if isinstance(found, Selection):
            (folder / "pairs.csv").write_text(pairs_csv(found), encoding="utf-8")
        if sizing is None:
            return
        (folder / "checks.csv").write_text(checks_csv(sizing), encoding="utf-8")
        joints = sizing.cycle.joint_names
        for name, part in zip(joints, file_names(joints), strict=True):
            profile = load_profile_csv(sizing.motor_load_profile(name))
            (folder / f"load-profile-{part}.csv").write_text(profile, encoding="utf-8")
        # Templates, the replay and matplotlib take longer to load than everything else takes to compute.
        from puma_septic.pictures.sizing import sizing_pictures
        from puma_septic.report.figures import write_png
        from puma_septic.report.page import report_html
        from puma_septic.report.svg import write_svg

        (folder / "report.html").write_text(report_html(sizing, title=title), encoding="utf-8")
        pictures = sizing_pictures(sizing)
        write_svg(folder, pictures)
        write_png(folder, pictures)
