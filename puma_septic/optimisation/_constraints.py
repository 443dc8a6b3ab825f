"""By how much a motion exceeds what it must keep."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.objectives import Candidate
from puma_septic.piecewise import Extrema
from puma_septic.quantities import QUANTITIES
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_array, checked_choice

__all__ = ["Excess", "checked_quantities", "excess_function"]

Excess = Callable[[Candidate], Array]


def excess_function(
    robot: Robot | None, n_joints: int, *, max_overshoot: ArrayLike | None, keep: Sequence[str]
) -> Excess:
    """A function of a candidate: excess of each constraint, wanted at most 0; in rad, or as a share of the limit.

    Raises
    ------
    InputError
        For an unknown quantity, a limit that is known for no joint, or limits without a robot.
    """
    checks: list[Excess] = []
    if max_overshoot is not None:
        shape = () if np.ndim(max_overshoot) == 0 else (n_joints,)
        bound = checked_array("max_overshoot", max_overshoot, shape, unit="rad")
        if not (bound >= 0).all():
            raise InputError("max_overshoot must not be negative, in rad")
        checks.append(lambda candidate: _beyond_hull(candidate, bound))
    checks += [_limit_check(robot, quantity) for quantity in keep]
    return lambda candidate: np.concatenate([np.zeros(0), *(check(candidate) for check in checks)])


def checked_quantities(keep: Sequence[str]) -> tuple[str, ...]:
    """Names of limits; one name alone is meant as such."""
    names = (keep,) if isinstance(keep, str) else tuple(keep)
    return tuple(checked_choice("limit", name, QUANTITIES) for name in names)


def _beyond_hull(candidate: Candidate, bound: Array) -> Array:
    trajectory = candidate.trajectory
    reach = trajectory.extrema(0)
    above, below = reach.max - trajectory.points.max(axis=0), trajectory.points.min(axis=0) - reach.min
    return np.concatenate([above - bound, below - bound])


def _limit_check(robot: Robot | None, quantity: str) -> Excess:
    if robot is None:
        raise InputError(f"to keep the limits of {quantity}, the robot is needed: give robot=...")
    limit = getattr(robot.limits, quantity)
    if np.isnan(limit).all():
        raise InputError(
            f"no {quantity} limit of robot {robot.name!r} is known; give them by robot.with_limits({quantity}=...)"
        )
    row = QUANTITIES[quantity]
    if row.is_range:
        return lambda candidate: _beyond_positions(candidate, limit)
    if row.signal == "position":
        return lambda candidate: _beyond(candidate.trajectory.extrema(row.order), limit)
    return lambda candidate: _beyond(candidate.motion.signal(quantity).extrema(), limit)


def _beyond_positions(candidate: Candidate, limit: Array) -> Array:
    reach = candidate.trajectory.extrema(0)
    return _known(np.concatenate([limit[:, 0] - reach.min, reach.max - limit[:, 1]]))


def _beyond(reach: Extrema, limit: Array) -> Array:
    return _known(np.concatenate([reach.max / limit, -reach.min / limit]) - 1)


def _known(excess: Array) -> Array:
    """An unknown limit is never exceeded."""
    return np.where(np.isnan(excess), -1.0, excess)
