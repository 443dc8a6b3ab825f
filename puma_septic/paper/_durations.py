"""How short a motion may become, and how long its computation takes."""

from __future__ import annotations

import statistics
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

from puma_septic.assessment import LimitCheck, assess
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory

__all__ = ["LeastDuration", "least_duration", "median_seconds", "stretched"]

# The search ends at this relative width of the duration, and gives up where this many doublings do not help.
_PRECISION: Final = 1e-7
_DOUBLINGS: Final = 12


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LeastDuration:
    """The shortest duration of a motion that is only stretched in time.

    Attributes
    ----------
    duration : float
        s; infinite where no stretch helps, 0 where every one does.
    governing : LimitCheck or None
        The limit that is reached at it.
    """

    duration: float
    governing: LimitCheck | None


def stretched(trajectory: Trajectory, factor: float) -> Trajectory:
    """The same path in `factor` times the time; v, a and jerk are divided by its powers 1, 2 and 3."""
    position = trajectory.position
    return Trajectory(
        position=Piecewise(breaks=position.breaks * factor, coefficients=position.coefficients),
        points=trajectory.points,
        times=trajectory.times * factor,
        profile=trajectory.profile,
        joint_names=trajectory.joint_names,
    )


def least_duration(robot: Robot, trajectory: Trajectory) -> LeastDuration:
    """Shorten (or lengthen) a motion until its limits on velocity, acceleration, jerk and torque are just kept.

    Positions do not change. Inertial torque goes with 1/T^2 and viscous friction with 1/T, but gravity and
    Coulomb friction do not depend on the time, so the motion is assessed anew at each duration. Found by
    bisection, from the given duration downwards (upwards where that is too short already).
    """

    def governing(factor: float) -> LimitCheck | None:
        checks = assess(robot, stretched(trajectory, factor)).checks
        return max((c for c in checks if c.quantity != "position"), key=lambda c: c.utilisation, default=None)

    def is_kept(factor: float) -> bool:
        check = governing(factor)
        return check is None or not check.is_violated

    step = 0.5 if is_kept(1.0) else 2.0
    factor = 1.0
    for _ in range(_DOUBLINGS):
        if is_kept(factor * step) != (step < 1):
            break
        factor *= step
    else:
        return LeastDuration(duration=0.0 if step < 1 else float("inf"), governing=None)
    broken, kept = sorted((factor, factor * step))
    while kept - broken > _PRECISION * kept:
        middle = (broken + kept) / 2
        broken, kept = (broken, middle) if is_kept(middle) else (middle, kept)
    return LeastDuration(duration=trajectory.duration * kept, governing=governing(kept))


def median_seconds(compute: Callable[[], object], runs: int, clock: Callable[[], float]) -> float:
    """The median time of the runs, after one that does not count."""
    compute()
    times = []
    for _ in range(runs):
        start = clock()
        compute()
        times.append(clock() - start)
    return statistics.median(times)
