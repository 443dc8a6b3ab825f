"""What is marked on path and time line: violated limits and singular postures, with their instants."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, final

import numpy as np

from puma_septic.assessment import Assessment, height_series
from puma_septic.kinematics import height_parts
from puma_septic.limit_check import HEIGHT, LimitCheck
from puma_septic.paths import tool_rates
from puma_septic.piecewise import Piecewise

__all__ = ["Flag", "flags_of"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Flag:
    """Something that a viewer must not miss.

    Attributes
    ----------
    kind : {"limit", "singular"}
    time : float
        Of the worst, or of the passage, s.
    text : str
    spans : tuple of (float, float)
        While a limit is violated, s; none for what only happens at an instant.
    """

    kind: Literal["limit", "singular"]
    time: float
    text: str
    spans: tuple[tuple[float, float], ...] = ()


def flags_of(assessment: Assessment) -> tuple[Flag, ...]:
    """Violated limits, the worst first, then passages through singular postures in order of time."""
    limits = [
        Flag(kind="limit", time=check.time, text=str(check), spans=_spans(assessment, check))
        for check in assessment.violations
    ]
    singular = [
        Flag(kind="singular", time=float(time), text=f"{report.kind} singularity")
        for report in assessment.tool.singularities
        for time in report.crossings
    ]
    return (*limits, *sorted(singular, key=lambda flag: flag.time))


def _spans(assessment: Assessment, check: LimitCheck) -> tuple[tuple[float, float], ...]:
    """While the joint's quantity is beyond its bounds: from the roots of their difference, not from a grid."""
    if check in assessment.tool_checks:
        motion = assessment.motion
        square = tool_rates(motion.robot, motion.trajectory).square(check.quantity)
        excess = square - Piecewise.constant([check.limit**2], square.duration, start=square.start)
        return tuple((float(start), float(end)) for start, end in zip(*excess.positive_spans(), strict=True))
    one, (low, high) = _bounded(assessment, check)
    excesses = [
        sign * (one - Piecewise.constant([bound], one.duration, start=one.start))
        for sign, bound in ((1, high), (-1, low))
        if np.isfinite(bound)
    ]
    spans = [zip(*excess.positive_spans(), strict=True) for excess in excesses]
    return tuple(sorted((float(start), float(end)) for found in spans for start, end in found))


def _bounded(assessment: Assessment, check: LimitCheck) -> tuple[Piecewise, tuple[float, float]]:
    """What was checked as a function of time, and its bounds; NaN or infinite where there is none."""
    motion = assessment.motion
    robot = motion.robot
    if check.quantity == HEIGHT:
        return height_series(motion)[height_parts(robot).index(check.joint)], (check.limit, np.nan)
    j = robot.joint_index(check.joint)
    low, high = robot.limits.position[j].tolist() if check.is_range else (-check.limit, check.limit)
    return motion.signal(check.quantity)[j], (low, high)
