"""How fast and how heavy, of one motion: both answers, and the payload over the duration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.assessment import assess
from puma_septic.document import plain
from puma_septic.errors import InputError, NoSolution
from puma_septic.limits._drives import highest_motor_rate
from puma_septic.limits._duration import MinimumDuration, kinematic_rate, minimum_duration
from puma_septic.limits._dwell import dwell_demands
from puma_septic.limits._feasible import feasible_values
from puma_septic.limits._payload import Load, MaximumPayload, checked_load, mass_demands_at, maximum_payload
from puma_septic.limits._stretching import load_torque, rate_torque
from puma_septic.motion import Motion, compute_motion
from puma_septic.paths import ToolLimits
from puma_septic.validation import Array, checked_array, checked_kind, read_only

__all__ = ["MotionLimits", "motion_limits", "payload_over_duration"]

# The curve of payload over duration: so many durations, from the least to so many times it.
_COUNT: Final = 25
_SLOWEST: Final = 4.0


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MotionLimits:
    """How fast a motion can go and how much it can carry; made by `motion_limits`.

    Attributes
    ----------
    motion : Motion
    load : Load
        The shape of what is carried.
    fastest : MinimumDuration or None
        With what the robot carries; None where there is none, see `why_not_fastest`.
    why_not_fastest : str
    heaviest : MaximumPayload or None
        At the motion's own duration.
    why_not_heaviest : str
    durations : ndarray, shape (n,)
        s, from the least feasible one.
    masses : ndarray, shape (n, 2)
        The least and the largest mass at each of them, kg; NaN where there is none.
    """

    motion: Motion
    load: Load
    fastest: MinimumDuration | None
    why_not_fastest: str
    heaviest: MaximumPayload | None
    why_not_heaviest: str
    durations: Array
    masses: Array

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document.

        Returns
        -------
        dict
        """
        return {
            "profile": self.motion.trajectory.profile,
            "duration": self.motion.trajectory.duration,
            "com": plain(self.load.com),
            "fastest": None if self.fastest is None else self.fastest.to_dict(),
            "why_not_fastest": self.why_not_fastest,
            "heaviest": None if self.heaviest is None else self.heaviest.to_dict(),
            "why_not_heaviest": self.why_not_heaviest,
            "durations": plain(self.durations),
            "masses": plain(self.masses),
        }


def motion_limits(
    motion: Motion,
    *,
    com: ArrayLike | None = None,
    dwell: float = 0.0,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
) -> MotionLimits:
    """How fast a motion can go with what it carries, how much it can carry, and both together.

    Parameters
    ----------
    motion : Motion
    com : array_like, shape (3,), optional
        As `maximum_payload` takes it.
    dwell, floor, tool_limits : optional
        As `minimum_duration` takes them.

    Returns
    -------
    MotionLimits
        With a reason in place of what does not exist.
    """
    load = checked_load(motion.robot, com, None)
    fastest: MinimumDuration | None = None
    heaviest: MaximumPayload | None = None
    why_not_fastest = why_not_heaviest = ""
    try:
        fastest = minimum_duration(motion, dwell=dwell, floor=floor, tool_limits=tool_limits)
    except NoSolution as error:
        why_not_fastest = str(error)
    try:
        heaviest = maximum_payload(
            motion, com=load.com, gyration=load.gyration, dwell=dwell, floor=floor, tool_limits=tool_limits
        )
    except (NoSolution, InputError) as error:  # where no known limit bears it; what else is refused, the curve refuses
        why_not_heaviest = str(error)
    least = motion.trajectory.duration if fastest is None else float(fastest.feasible[0, 0])
    durations = np.geomspace(1, _SLOWEST, _COUNT) * least
    masses = payload_over_duration(
        motion, durations, com=load.com, gyration=load.gyration, dwell=dwell, floor=floor, tool_limits=tool_limits
    )
    return MotionLimits(
        motion=motion,
        load=load,
        fastest=fastest,
        why_not_fastest=why_not_fastest,
        heaviest=heaviest,
        why_not_heaviest=why_not_heaviest,
        durations=read_only(durations),
        masses=read_only(masses),
    )


def payload_over_duration(
    motion: Motion,
    durations: ArrayLike,
    *,
    com: ArrayLike | None = None,
    gyration: ArrayLike | None = None,
    dwell: float = 0.0,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
) -> Array:
    """The least and the largest mass that a motion can carry, stretched to each of some durations.

    Parameters
    ----------
    motion : Motion
        What its robot carries is replaced.
    durations : array_like, shape (n,)
        s.
    com, gyration, dwell, floor, tool_limits : optional
        As `maximum_payload` takes them.

    Returns
    -------
    ndarray, shape (n, 2)
        kg, exact; NaN where no mass keeps the limits, or a position is beyond its bounds; infinite where none bears it.

    Raises
    ------
    InputError
        For friction that is not viscous plus constant.
    """
    robot = checked_kind("motion", motion, Motion).robot
    times = checked_array("durations", durations, (None,), unit="s", above=0.0)
    load = checked_load(robot, com, gyration)
    bare = motion if robot.payload is None else compute_motion(robot.with_payload(None), motion.trajectory)
    first = assess(bare, dwell=dwell, floor=floor, tool_limits=tool_limits)
    torque, added = rate_torque(bare), load_torque(bare.robot, bare.trajectory, load.per_kg)
    in_place = not any(check.is_range and check.is_violated for check in first.all_checks)
    highest = min(kinematic_rate(first), highest_motor_rate(robot, first.peak_velocity)) if in_place else 0.0
    held = dwell_demands(bare, dwell, per_kg=load.per_kg)
    masses = np.full((len(times), 2), np.nan)
    for k, rate in enumerate((bare.trajectory.duration / times).tolist()):
        if rate > highest * (1 + 1e-12):
            continue
        parts = (torque.at(rate), torque.coulomb, added.at(rate))
        intervals = feasible_values([*mass_demands_at(bare.robot, bare.trajectory, parts, rate), *held]).intervals
        if len(intervals):
            masses[k] = intervals[0]
    return masses
