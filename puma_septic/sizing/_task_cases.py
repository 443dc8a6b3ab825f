"""The load cases and conditions that a task asks for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from puma_septic.cycle import Cycle, Dwell, with_return
from puma_septic.drives import LinearStage, Supply
from puma_septic.errors import InputError
from puma_septic.motion import Motion, compute_motion
from puma_septic.robot import Payload, Robot
from puma_septic.sizing._brake import worst_stops
from puma_septic.sizing._conditions import Conditions
from puma_septic.sizing._load_cases import LoadCase, worst_poses
from puma_septic.task import (
    ConditionsSection,
    LoadCaseSection,
    ResolvedCycle,
    ResolvedTask,
    load_task,
    resolve_cycle,
    resolve_task,
)
from puma_septic.validation import checked_flag, checked_kind

__all__ = ["conditions_of", "cycle_case", "load_cases_of"]

_MINUTE: Final = 60.0
# Keys of the section that shape the cycle and the arm, not the limits.
_OF_THE_CYCLE: Final = ("cycles_per_minute", "brake_at_rest", "own_masses")


def conditions_of(section: ConditionsSection | None) -> Conditions:
    """The conditions of a task file.

    Returns
    -------
    Conditions
    """
    if section is None:
        return Conditions()
    supply = None if section.supply is None else Supply(**section.supply.model_dump(exclude_none=True))
    given = (section.stages or {}).items()
    stages = {joint: LinearStage(**stage.model_dump(exclude_none=True)) for joint, stage in given}
    others = section.model_dump(exclude_none=True, exclude={*_OF_THE_CYCLE, "supply", "stages"})
    return Conditions(**others, stages=stages, supply=supply)


def load_cases_of(resolved: ResolvedTask, *, one_way: bool = False) -> tuple[LoadCase, ...]:
    """The load cases of a task: those that it lists, or its cycle as the only one.

    A cycle is the first profile of the task with its payload, rest, the same path back with an empty hand, rest. The
    cycle rate of the conditions sets the rests; without one each is the task's dwell.

    Parameters
    ----------
    resolved : ResolvedTask
    one_way : bool
        No cycle returns.

    Returns
    -------
    tuple of LoadCase

    Raises
    ------
    InputError
        For a cycle rate that leaves no time for the moves, or a task of another arm.

    Examples
    --------
    >>> from puma_septic.task import load_task, resolve_task
    >>> (case,) = load_cases_of(resolve_task(load_task("paper-turned")))
    >>> case.cycle.duration
    18.0
    """
    sections = checked_kind("resolved", resolved, ResolvedTask).task.load_cases
    checked_flag("one_way", one_way)
    if not sections:
        own = LoadCaseSection(name="cycle", way="one way" if one_way else "return")
        return (LoadCase(name="", cycle=_cycle(resolved, resolved.robot, own)),)
    if one_way:
        raise InputError(
            f"{resolved.task.origin}: it lists load_cases; give those that do not return way: one way there"
        )
    found = [case for section in sections for case in _MAKERS[section.kind](resolved, section)]
    # The first case is the one that is drawn; it must be an ordinary one.
    ordinary = [case for case in found if not (case.is_rare or case.joints)]
    if not ordinary:
        raise InputError(f"{resolved.task.origin}: load_cases: one of them must be of the kind 'cycle'")
    return (*ordinary, *(case for case in found if case.is_rare or case.joints))


def cycle_case(resolved: ResolvedCycle) -> LoadCase:
    """The cycle that a task has written down as the only load case.

    The cycle rate of the conditions leaves the rest of the time for a rest at its end.

    Returns
    -------
    LoadCase

    Raises
    ------
    InputError
        For a cycle rate that leaves no time for the cycle.
    """
    conditions, cycle = resolved.task.conditions or ConditionsSection(), resolved.cycle
    rate = conditions.cycles_per_minute
    if rate is None:
        return LoadCase(name="", cycle=cycle)
    left = _MINUTE / rate - cycle.duration
    if left < 0:
        raise InputError(
            f"{resolved.task.origin}: conditions.cycles_per_minute = {rate:g}: a cycle has {_MINUTE / rate:.4g} s, but"
            f" this one takes {cycle.duration:.4g} s; at most {_MINUTE / cycle.duration:.4g} cycles a minute"
        )
    rest = (Dwell(duration=left, holding_brake=conditions.brake_at_rest),) if left else ()
    return LoadCase(name="", cycle=Cycle(steps=(*cycle.steps, *rest)))


def _of_cycle(resolved: ResolvedTask, section: LoadCaseSection) -> Iterator[LoadCase]:
    other = None if section.task is None else load_task(section.task)
    moved = resolved if other is None else resolve_cycle(other) if other.cycle else resolve_task(other)
    if moved.robot.joint_names != resolved.robot.joint_names:
        raise InputError(f"load case {section.name!r}: {section.task} is a task of another arm")
    if isinstance(moved, ResolvedCycle):
        cycle = _written_cycle(moved, section)
    else:
        cycle = _cycle(moved, _loaded(moved, section), section)
    yield LoadCase(name=section.name, cycle=cycle, share=_share(section, 1.0))


def _written_cycle(resolved: ResolvedCycle, section: LoadCaseSection) -> Cycle:
    """Another task's cycle, which says itself what it carries and how it comes back."""
    if told := sorted({"payload", "way"} & section.model_fields_set):
        raise InputError(
            f"load case {section.name!r}: {' and '.join(told)}: {section.task} is a cycle, which says that itself"
        )
    cycle = cycle_case(resolved).cycle
    brake = (resolved.task.conditions or ConditionsSection()).brake_at_rest
    idle = () if section.idle is None else (Dwell(duration=section.idle, holding_brake=brake),)
    return Cycle(steps=(*cycle.steps, *idle)) if idle else cycle


def _of_payload_range(resolved: ResolvedTask, section: LoadCaseSection) -> Iterator[LoadCase]:
    """The two ends govern: torque is affine in the mass, so that its magnitude and its mean square are convex in it."""
    for mass in section.masses or ():
        robot = resolved.robot.with_payload(replace(_payload(resolved, section), mass=mass))
        name = f"{section.name}, {mass:g} kg"
        yield LoadCase(name=name, cycle=_cycle(resolved, robot, section), share=_share(section, 1.0))


def _of_worst_pose(resolved: ResolvedTask, section: LoadCaseSection) -> Iterator[LoadCase]:
    duration = _cycle(resolved, resolved.robot, section).duration
    for joint, cycle in worst_poses(_loaded(resolved, section), duration):
        yield LoadCase(name=section.name, cycle=cycle, share=_share(section, 0.0), joints=(joint,))


def _of_emergency_stop(resolved: ResolvedTask, section: LoadCaseSection) -> Iterator[LoadCase]:
    motion = compute_motion(_loaded(resolved, section), resolved.trajectories[0])
    for joint, instant, cycle in worst_stops(motion, section.time or 0.0):
        yield LoadCase(
            name=section.name,
            cycle=cycle,
            share=0.0,
            joints=(joint,),
            is_rare=True,
            is_powered=section.category == 1,
            note=f"from t = {instant:.4g} s, category {section.category}",
        )


_MAKERS: Final[dict[str, Callable[[ResolvedTask, LoadCaseSection], Iterator[LoadCase]]]] = {
    "cycle": _of_cycle,
    "payload range": _of_payload_range,
    "worst pose": _of_worst_pose,
    "emergency stop": _of_emergency_stop,
}


def _share(section: LoadCaseSection, default: float) -> float:
    return default if section.share is None else section.share


def _payload(resolved: ResolvedTask, section: LoadCaseSection) -> Payload:
    given = section.payload
    if given is not None:
        return Payload(mass=given.mass, com=np.array(given.com), inertia=np.array(given.inertia))
    return resolved.robot.payload or Payload(mass=0.0)


def _loaded(resolved: ResolvedTask, section: LoadCaseSection) -> Robot:
    return resolved.robot if section.payload is None else resolved.robot.with_payload(_payload(resolved, section))


def _cycle(resolved: ResolvedTask, robot: Robot, section: LoadCaseSection) -> Cycle:
    """The task's first profile and, unless one way, the way back with an empty hand, each with its rest."""
    motion = compute_motion(robot, resolved.trajectories[0])
    steps: tuple[Motion | Dwell, ...] = (motion,)
    if section.way == "return":
        steps = with_return(motion, robot_back=robot.with_payload(None)).steps
    conditions = resolved.task.conditions or ConditionsSection()
    rest = _rest(resolved, conditions, len(steps) * motion.trajectory.duration, len(steps))
    if not rest and section.idle is None:
        return Cycle(steps=steps)
    dwell = [Dwell(duration=rest, holding_brake=conditions.brake_at_rest)] if rest else []
    idle = [] if section.idle is None else [Dwell(duration=section.idle, holding_brake=conditions.brake_at_rest)]
    return Cycle(steps=(*(part for step in steps for part in (step, *dwell)), *idle))


def _rest(resolved: ResolvedTask, conditions: ConditionsSection, moving: float, count: int) -> float:
    """After each move, s."""
    rate = conditions.cycles_per_minute
    if rate is None:
        return resolved.task.dwell
    left = _MINUTE / rate - moving
    if left < 0:
        raise InputError(
            f"{resolved.task.origin}: conditions.cycles_per_minute = {rate:g}: a cycle has {_MINUTE / rate:.4g} s, but"
            f" its {count} moves take {moving:.4g} s; at most {_MINUTE / moving:.4g} cycles a minute"
        )
    return left / count
