"""What chosen drives could do more: the least cycle time, and the largest payload, with every check of the sizing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final, final

import numpy as np

from puma_septic.cycle import Cycle, Dwell
from puma_septic.errors import InputError, NoSolution
from puma_septic.limit_check import LimitCheck
from puma_septic.motion import Motion, compute_motion
from puma_septic.robot import Payload
from puma_septic.sizing._load_cases import LoadCase
from puma_septic.sizing._result import Sizing, sized
from puma_septic.validation import checked_number

__all__ = ["Reserve", "largest_payload", "least_cycle_time"]

# Farther than this from where it begins nothing is looked for: a factor of time, kg.
_SLOWEST: Final = 64.0
_HEAVIEST: Final = 4096.0
_LEAST_MASS: Final = 1e-3


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Reserve:
    """The end of what drives can do, found by halving; within `tolerance` beyond it a limit is not kept.

    Attributes
    ----------
    value : float
        Duration of the first load case's cycle, s, or mass, kg.
    tolerance : float
        Relative.
    sizing : Sizing
        There: every limit is kept.
    governing : LimitCheck or None
        The limit that is not kept just beyond.
    """

    value: float
    tolerance: float
    sizing: Sizing
    governing: LimitCheck | None

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready.

        Returns
        -------
        dict
        """
        governing = None if self.governing is None else self.governing.to_dict()
        return {"value": self.value, "tolerance": self.tolerance, "governing": governing}


def least_cycle_time(sizing: Sizing, *, tolerance: float = 1e-3) -> Reserve:
    """How fast the drives can do their load cases: all moves faster by one factor, the rests as they are.

    Every check counts with its margin, means and heat as well as peaks; an emergency stop becomes quicker with the
    moves. Between what was tried, and slower, there may be durations that are not possible: of peaks alone
    `minimum_duration` has them all.

    Parameters
    ----------
    sizing : Sizing
    tolerance : float
        Relative, of the time of the moves.

    Returns
    -------
    Reserve

    Raises
    ------
    InputError
        For a tolerance that is not positive, or where no known limit is ever reached.
    NoSolution
        Where even the slowest moves that are tried are too much.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> sizing = ps.size(ps.cycle.with_return(ps.compute_motion(ps.load_robot(), move), dwell=0.5))
    >>> fastest = ps.sizing.least_cycle_time(sizing, tolerance=0.01)
    >>> fastest.value < 2.5, fastest.governing.quantity
    (True, 'motor speed')
    """

    def at(factor: float) -> Sizing:
        cases = tuple(replace(case, cycle=_stretched(case.cycle, factor)) for case in sizing.load_cases)
        return _again(sizing, cases)

    good, bad = _bracket(at, start=1.0, towards_good=2.0, farthest=_SLOWEST, least=1 / _SLOWEST, what="slower moves")
    _, found, beyond = _halved(at, good, bad, tolerance)
    return Reserve(value=found.cycle.duration, tolerance=tolerance, sizing=found, governing=beyond.governing)


def largest_payload(sizing: Sizing, *, tolerance: float = 1e-3) -> Reserve:
    """How much the drives can carry: in all motions with a payload that of one mass, its centre where it is.

    The inertia about the centre grows with the mass. Where no motion carries anything, all carry a point mass at the
    tool's origin. Every check counts with its margin.

    Parameters
    ----------
    sizing : Sizing
    tolerance : float
        Relative.

    Returns
    -------
    Reserve

    Raises
    ------
    InputError
        For a tolerance that is not positive, or where no known limit is ever reached.
    NoSolution
        Where the drives do not even move the arm without a payload.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> sizing = ps.size(ps.cycle.with_return(ps.compute_motion(ps.load_robot(), move), dwell=0.5))
    >>> heaviest = ps.sizing.largest_payload(sizing, tolerance=0.01)
    >>> 3.0 < heaviest.value < 9.0, heaviest.governing.joint
    (True, 'joint2')
    """
    steps = [step for case in sizing.load_cases for step in case.cycle.steps if isinstance(step, Motion)]
    is_empty = not any(_mass(step) for step in steps)

    def at(mass: float) -> Sizing:
        cases = tuple(replace(case, cycle=_carrying(case.cycle, mass, is_empty)) for case in sizing.load_cases)
        return _again(sizing, cases)

    start = max((_mass(step) for step in steps), default=0.0) or 1.0
    good, bad = _bracket(at, start=start, towards_good=0.5, farthest=_LEAST_MASS, least=_HEAVIEST, what="lighter loads")
    mass, found, beyond = _halved(at, good, bad, tolerance)
    return Reserve(value=mass, tolerance=tolerance, sizing=found, governing=beyond.governing)


def _again(sizing: Sizing, cases: tuple[LoadCase, ...]) -> Sizing:
    return sized(cases, drivetrains=sizing.drivetrains, conditions=sizing.conditions)


def _bracket(
    at: Callable[[float], Sizing], *, start: float, towards_good: float, farthest: float, least: float, what: str
) -> tuple[float, float]:
    """Two neighbours of a geometric row, the first possible, the second not."""
    value, is_good = start, at(start).is_feasible
    step = 1 / towards_good if is_good else towards_good
    end = least if is_good else farthest
    while value != end:
        following = min(value * step, end) if step > 1 else max(value * step, end)
        if at(following).is_feasible != is_good:
            return (value, following) if is_good else (following, value)
        value = following
    if is_good:
        raise InputError(f"no known limit is reached up to {end:g}: nothing that is known ends it")
    worst = at(end).governing
    excess = np.inf if worst is None else worst.utilisation - 1
    raise NoSolution(f"even {what} are too much: {worst}", residual=excess, q=np.empty(0))


def _halved(at: Callable[[float], Sizing], good: float, bad: float, tolerance: float) -> tuple[float, Sizing, Sizing]:
    """The last that is possible within the tolerance, its sizing, and that of the first that is not."""
    tolerance = checked_number("tolerance", tolerance, above=0.0)
    found, beyond = at(good), at(bad)
    while abs(np.log(bad / good)) > np.log1p(tolerance):
        middle = float(np.sqrt(good * bad))
        one = at(middle)
        if one.is_feasible:
            good, found = middle, one
        else:
            bad, beyond = middle, one
    return good, found, beyond


def _stretched(cycle: Cycle, factor: float) -> Cycle:
    return Cycle(
        steps=tuple(
            step if isinstance(step, Dwell) else compute_motion(step.robot, step.trajectory.stretched(factor))
            for step in cycle.steps
        )
    )


def _mass(step: Motion) -> float:
    return 0.0 if step.robot.payload is None else float(step.robot.payload.mass)


def _carrying(cycle: Cycle, mass: float, is_empty: bool) -> Cycle:
    """The cycle with another mass where something is carried, or everywhere."""
    return Cycle(steps=tuple(_loaded(step, mass, is_empty) for step in cycle.steps))


def _loaded(step: Motion | Dwell, mass: float, is_empty: bool) -> Motion | Dwell:
    if isinstance(step, Dwell):
        held = step.payload
        return step if held is None or not held.mass else replace(step, payload=_heavier(held, mass))
    payload = step.robot.payload or Payload(mass=0.0)
    if not (payload.mass or is_empty):
        return step
    return compute_motion(step.robot.with_payload(_heavier(payload, mass)), step.trajectory)


def _heavier(payload: Payload, mass: float) -> Payload:
    scale = mass / payload.mass if payload.mass else 0.0
    return replace(payload, mass=mass, inertia=np.asarray(payload.inertia) * scale)
