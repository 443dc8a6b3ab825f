"""What ``puma-septic size`` does: the cycle, the drives or the catalogue, and the folder."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

from puma_septic._version import __version__
from puma_septic.assessment import assess
from puma_septic.cli._arguments import CONDITIONS, asked_task
from puma_septic.cli._output_arguments import asked_units, origin, with_report
from puma_septic.cli._parser import UNDECIDED, Answer
from puma_septic.cli._task_text import wrapped
from puma_septic.cycle import Cycle, Dwell
from puma_septic.drives import (
    BUILT_IN,
    Catalogue,
    built_in_catalogue,
    load_catalogue,
)
from puma_septic.errors import InputError, NoSolution, did_you_mean
from puma_septic.motion import Motion
from puma_septic.outputs import file_names
from puma_septic.report import new_folder, to_json
from puma_septic.report.csv import bill_csv, checks_csv, load_profile_csv, motor_profile_csv, pairs_csv
from puma_septic.robot import load_drivetrains, load_electronics
from puma_septic.sizing import (
    LoadCase,
    Selection,
    Sizing,
    conditions_of,
    cycle_case,
    front_document,
    largest_payload,
    least_cycle_time,
    load_cases_of,
    size,
)
from puma_septic.task import ConditionsSection, Task, make_task, resolve_cycle, resolve_task
from puma_septic.views import selection as selection_view
from puma_septic.views import sizing as sizing_view

__all__ = ["answer"]

# Pairs that are shown per joint unless --keep tells another number.
_KEPT: Final = 3
# Of reserves, relative.
_TOLERANCE: Final = 0.01


def answer(arguments: Namespace) -> Answer:
    """Size the arm's own drives, or choose from a catalogue."""
    asked = _asked(arguments)
    found = _own_sizing(arguments, asked) if arguments.catalogue is None else _selection(arguments, asked)
    own = found.to_dict()
    conditions = {**_of_the_cycle(asked.conditions), **own["conditions"]}
    reserves = _reserves(found) if arguments.reserves else {}
    front = {"front": front_document(found.front())} if arguments.front and isinstance(found, Selection) else {}
    document = {**asked.document, **own, "conditions": conditions, **reserves, **front, "inputs": _inputs(arguments)}
    if asked.code:
        document |= {"is_feasible": False, "verdict": f"undecided; else {own['verdict']}"}
    if arguments.out is not None:
        _write_folder(arguments, found, document, asked)
    text = with_report(_text(arguments, asked, found, document), arguments)
    return Answer(text, asked.code or _code(found))


def _reserves(found: Sizing | Selection) -> dict[str, Any]:
    """How much faster, and how much heavier, the drives could go; nothing where a joint has none."""
    sizing = found if isinstance(found, Sizing) else found.sizing
    if sizing is None:
        return {}
    ends: dict[str, Any] = {}
    for name, search in (("cycle_time", least_cycle_time), ("payload", largest_payload)):
        try:
            ends[name] = search(sizing, tolerance=_TOLERANCE).to_dict()
        except (InputError, NoSolution) as error:
            ends[name] = {"why_not": str(error)}
    return {"reserves": ends}


def _of_the_cycle(section: ConditionsSection | None) -> dict[str, Any]:
    """The conditions that shape cycle and arm."""
    if section is None:
        return {}
    return section.model_dump(
        mode="json", exclude_unset=True, include={"cycles_per_minute", "brake_at_rest", "own_masses"}
    )


def _code(found: Sizing | Selection) -> int:
    if found.is_feasible:
        return 0
    return UNDECIDED if isinstance(found, Selection) and not found.can_be_decided else 1


def _inputs(arguments: Namespace) -> dict[str, Any]:
    """What repeats the answer beside the task: files and options."""
    options = {
        name: getattr(arguments, name)
        for name in ("catalogue", "drives", "rank", "keep", "masses", "same", "csv")
        if getattr(arguments, name) is not None
    }
    return {"version": __version__, **options, **({"one_way": True} if arguments.one_way else {})}


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Asked:
    """Load cases and where they come from; `code` is an exit code that stands whatever the drives can do, or 0."""

    name: str
    cases: tuple[LoadCase, ...]
    conditions: ConditionsSection | None
    head: str
    document: dict[str, Any]
    code: int = 0
    point_names: tuple[str, ...] = ()


def _questions(doubts: Sequence[str]) -> str:
    return "".join(f"\nUndecided: {doubt}" for doubt in doubts)


def _asked(arguments: Namespace) -> _Asked:
    """The cycle of a task, or of a recorded motion as it is, with the asked rest."""
    if arguments.csv is None:
        task = asked_task(arguments, "paper", profiles=arguments.profile)
        task = _under_conditions(task, arguments)
        if task.cycle:
            return _asked_cycle(task, arguments)
        resolved = resolve_task(task)
        doubts = list(assess(resolved.robot, resolved.trajectories[0]).undecided)
        cases = load_cases_of(resolved, one_way=arguments.one_way)
        return _Asked(
            name=resolved.task.name,
            cases=cases,
            conditions=resolved.task.conditions,
            head=f"Task {resolved.task.name!r}, profile {resolved.trajectories[0].profile}{_questions(doubts)}",
            document={"task": resolved.task.document(), **({"undecided": doubts} if doubts else {})},
            code=UNDECIDED if doubts else 0,
            point_names=_stops(cases[0].cycle, resolved.names),
        )
    if arguments.profile is not None:
        raise InputError("--profile does not go with --csv: the file has the points")
    from puma_septic.cli._recorded import recorded, told  # SciPy, which fits it, takes a while to load

    what = recorded(arguments)
    doubts = list(what.motion.trajectory.doubts)
    rest = (Dwell(duration=arguments.dwell),) if arguments.dwell else ()
    return _Asked(
        name=what.path,
        cases=(LoadCase(name="", cycle=Cycle(steps=(what.motion, *rest))),),
        conditions=_conditions(arguments, {}),
        head=f"{told(what)}{_questions(doubts)}\nThe cycle is the recorded motion alone",
        document={"file": what.path, "undecided": doubts},
        code=UNDECIDED if doubts else 0,
    )


def _under_conditions(task: Task, arguments: Namespace) -> Task:
    """The task with the options' conditions in place of its own."""
    document = task.document()
    asked = _asked_conditions(arguments)
    if not asked:
        return task
    return make_task({**document, "conditions": {**document.get("conditions", {}), **asked}}, origin=task.origin)


def _asked_cycle(task: Task, arguments: Namespace) -> _Asked:
    """The cycle that a task has written down."""
    if arguments.one_way:
        raise InputError("--one-way does not go with a cycle, which says itself how the arm comes back")
    resolved = resolve_cycle(task)
    doubts = list(resolved.assess().whole.undecided)
    return _Asked(
        name=task.name,
        cases=(cycle_case(resolved),),
        conditions=task.conditions,
        head=f"Task {task.name!r}{_questions(doubts)}",
        document={"task": task.document(), **({"undecided": doubts} if doubts else {})},
        code=UNDECIDED if doubts else 0,
        point_names=tuple(resolved.stops),
    )


def _stops(cycle: Cycle, names: Sequence[str]) -> tuple[str, ...]:
    """Where a way there and back begins and ends each of its steps."""
    ends = [names[0]]
    for step in cycle.steps:
        turns = isinstance(step, Motion)
        ends.append((names[-1] if ends[-1] == names[0] else names[0]) if turns else ends[-1])
    return tuple(ends)


def _asked_conditions(arguments: Namespace) -> dict[str, Any]:
    asked = {name: getattr(arguments, name) for name in CONDITIONS if getattr(arguments, name) is not None}
    asked |= {name: dict(asked[name]) for name in ("margins", "stages") if name in asked}
    supply = {
        "max_current": arguments.supply_current, "peak_power": arguments.supply_power,
        "bus_voltage": arguments.bus_voltage,
    }  # fmt: skip
    if arguments.supply_current or arguments.supply_power:
        asked["supply"] = {key: value for key, value in supply.items() if value is not None}
    return asked


def _conditions(arguments: Namespace, own: dict[str, Any]) -> ConditionsSection:
    return ConditionsSection(**{**own, **_asked_conditions(arguments)})


def _own_sizing(arguments: Namespace, asked: _Asked) -> Sizing:
    """The arm's own drives, as far as a file, the built-in one, or its actuators alone tell."""
    named = ("rank", "keep", "masses", "same", "front")
    idle = [f"--{name}" for name in named if getattr(arguments, name) not in (None, False)]
    if idle:
        raise InputError(f"{', '.join(idle)} goes with --catalogue: name the parts to choose from")
    try:
        trains = load_drivetrains(asked.cases[0].cycle.robot, arguments.drives)
    except InputError as error:
        raise InputError(f"{error}, or choose drives: --catalogue FILE") from error
    return size(asked.cases, drivetrains=trains, conditions=conditions_of(asked.conditions))


def _selection(arguments: Namespace, asked: _Asked) -> Selection:
    """From a catalogue, with the electronics of a drives file where one is given."""
    robot = asked.cases[0].cycle.robot
    places = None if arguments.drives is None else load_electronics(robot, arguments.drives)
    own = None if asked.conditions is None else asked.conditions.own_masses
    if own is not None and arguments.masses is None:
        raise InputError("own masses are taken off where drives are placed on the arm: they go with --masses")
    return size(
        asked.cases,
        catalogue=_catalogue(arguments.catalogue),
        drivetrains=places,
        conditions=conditions_of(asked.conditions),
        rank=arguments.rank or "mass",
        keep=arguments.keep or _KEPT,
        masses=arguments.masses,
        own_masses=own,
        same=arguments.same or (),
    )


def _catalogue(files: list[str]) -> Catalogue:
    if len(files) == 1 and files[0] in BUILT_IN:
        return built_in_catalogue(files[0])
    if len(files) not in (2, 3):
        lost = "this file does not exist; " if len(files) == 1 and not Path(files[0]).exists() else ""
        raise InputError(
            f"--catalogue {' '.join(files)}: {lost}expected one of {', '.join(BUILT_IN)}, or two or three CSV files:"
            f" motors, gearboxes and, if not all fit together, pairs{did_you_mean(files[:1], BUILT_IN)}"
        )
    return load_catalogue(*files)


def _text(arguments: Namespace, asked: _Asked, found: Sizing | Selection, document: dict[str, Any]) -> str:
    if arguments.format == "json":
        return to_json(document)
    if arguments.format == "csv":
        return checks_csv(found) if isinstance(found, Sizing) else pairs_csv(found)
    steps = [_step(step) for step in found.load_cases[0].cycle.steps]
    case = f" of {found.load_cases[0].name!r}" if found.load_cases[0].name else ""
    head = f"{asked.head}{case}: {', '.join(steps)}"
    view = sizing_view if isinstance(found, Sizing) else selection_view
    if not arguments.verbose:
        return "\n\n".join([wrapped(head), wrapped(view.short_text(document))])
    return "\n\n".join([wrapped(head), wrapped(view.text(document)), *(_more(found) if arguments.verbose > 1 else [])])


def _step(step: Motion | Dwell) -> str:
    if isinstance(step, Dwell):
        return f"rest {step.duration:g} s" + (" under brakes" if step.holding_brake else "")
    payload = step.robot.payload
    return f"move {step.trajectory.duration:g} s with {0 if payload is None else payload.mass:g} kg"


def _more(found: Sizing | Selection) -> list[str]:
    """The chosen drives in full."""
    if isinstance(found, Sizing) or found.sizing is None:
        return []
    return ["The first pair of each joint:", wrapped(str(found.sizing))]


def _write_folder(arguments: Namespace, found: Sizing | Selection, document: dict[str, Any], asked: _Asked) -> None:
    """Report, document, tables of parts, checks and pairs, load profiles, and figures."""
    sizing = found if isinstance(found, Sizing) else found.sizing
    with new_folder(arguments.out, overwrite=arguments.force) as folder:
        (folder / "sizing.json").write_text(to_json(document), encoding="utf-8")
        # Templates, the replay and matplotlib take longer to load than everything else takes to compute.
        from puma_septic.pictures.sizing import arm_front_picture, sizing_pictures
        from puma_septic.report.figures import write_png
        from puma_septic.report.page import report_html
        from puma_septic.report.svg import write_svg

        page = report_html(
            found,
            title=f"{asked.name}: sizing",
            document=document,
            point_names=asked.point_names,
            made=origin(arguments),
            units=asked_units(arguments),
        )
        (folder / "report.html").write_text(page, encoding="utf-8")
        if isinstance(found, Selection):
            (folder / "pairs.csv").write_text(pairs_csv(found), encoding="utf-8")
            (folder / "bill-of-material.csv").write_text(bill_csv(document), encoding="utf-8")
        if sizing is None:
            return
        (folder / "checks.csv").write_text(checks_csv(sizing), encoding="utf-8")
        joints = sizing.cycle.joint_names
        for name, part in zip(joints, file_names(joints), strict=True):
            motor, load = sizing.motor_load_profile(name), sizing.load_profile(name)
            (folder / f"motor-profile-{part}.csv").write_text(motor_profile_csv(motor), encoding="utf-8")
            (folder / f"load-profile-{part}.csv").write_text(load_profile_csv(load), encoding="utf-8")
        pictures = sizing_pictures(sizing)
        if "front" in document and isinstance(found, Selection):
            pictures = (arm_front_picture(found.front()), *pictures)
        write_svg(folder, pictures)
        if not arguments.no_png:
            write_png(folder, pictures)
