"""What a motion does at the tool, how low the arm comes, and how near to singular postures."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Final, final

import numpy as np

from puma_septic.document import plain
from puma_septic.kinematics import (
    height_parts,
    heights,
    singularity_distances,
    singularity_names,
    singularity_zeros,
    tool_motion,
)
from puma_septic.limit_check import LimitCheck
from puma_septic.motion import Motion
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, read_only

__all__ = [
    "LowestPoint",
    "SingularityReport",
    "ToolMetrics",
    "height_series",
    "lowest_point",
    "tool_metrics",
]

# m; parts that come this near to the lowest come as low.
_SAME: Final = 1e-9


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class LowestPoint:
    """Where an arm is lowest along a motion.

    What counts are the origins of the joints that carry the tool, but for the first, and the tool frame; links are
    thicker.

    Attributes
    ----------
    height : float
        Above the world's origin, where the arm stands, against gravity (along z without gravity), m.
    time : float
        When, s.
    part : str
        The joint, or the tool frame.
    """

    height: float
    time: float
    part: str

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready.

        Returns
        -------
        dict
        """
        return {field.name: plain(getattr(self, field.name)) for field in fields(self)}

    def check(self, floor: float) -> LimitCheck:
        """The height checked against a floor.

        Returns
        -------
        LimitCheck
        """
        return LimitCheck.of_height(part=self.part, height=self.height, floor=floor, time=self.time)


def height_series(robot: Robot, trajectory: Trajectory) -> Piecewise:
    """Heights of `height_parts` as functions of time, m: to rounding, as each is smooth in the joint positions."""
    return trajectory.derivative(0).mapped(lambda q: heights(robot, q))


def lowest_point(robot: Robot, trajectory: Trajectory) -> LowestPoint:
    """The least of the minima of all parts' series; of parts that come as low, the first one."""
    extrema = height_series(robot, trajectory).extrema()
    k = int(np.argmax(extrema.min <= extrema.min.min() + _SAME))
    return LowestPoint(height=float(extrema.min[k]), time=float(extrema.t_min[k]), part=height_parts(robot)[k])


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SingularityReport:
    """How near a motion comes to one kind of singular posture.

    Attributes
    ----------
    kind : str
        "shoulder", "elbow", "wrist" for a PUMA; "determinant" or "manipulability" otherwise.
    least_distance : float
        Least magnitude of the measure (see `puma_septic.kinematics.singularity_distances`), 0 where it is crossed.
    time : float
        When, s.
    crossings : ndarray, shape (k,)
        Instants at which the arm passes through the singularity or touches it, s; where it stays, the first one.
    """

    kind: str
    least_distance: float
    time: float
    crossings: Array


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ToolMetrics:
    """The tool's motion in the world.

    Attributes
    ----------
    peak_speed, peak_speed_time : float
        m/s and s.
    peak_acceleration, peak_acceleration_time : float
        m/s^2 and s; infinite where a joint velocity steps.
    height_range : tuple of float
        Least and greatest height above the world's origin, against gravity, m.
    height_times : tuple of float
        When, s.
    singularities : tuple of SingularityReport
    """

    peak_speed: float
    peak_speed_time: float
    peak_acceleration: float
    peak_acceleration_time: float
    height_range: tuple[float, float]
    height_times: tuple[float, float]
    singularities: tuple[SingularityReport, ...]


def tool_metrics(motion: Motion) -> ToolMetrics:
    """Fit height, squared speed, squared acceleration and the singularity measures; take their extrema."""
    robot, trajectory = motion.robot, motion.trajectory

    n = robot.n_joints

    def measures(state: Array) -> Array:
        q, v, a = (state[:, k * n : (k + 1) * n] for k in range(3))
        tool = tool_motion(robot, q, v, a)
        squares = [(vector**2).sum(axis=1) for vector in (tool.velocity, tool.acceleration)]
        return np.column_stack([heights(robot, q)[:, -1], *squares, singularity_distances(robot, q)])

    series = trajectory.state.mapped(measures)
    extrema = series.extrema()
    step = trajectory.unbounded(2)
    bounded = bool(np.isnan(step).all())
    return ToolMetrics(
        peak_speed=float(np.sqrt(max(0.0, extrema.max[1]))),
        peak_speed_time=float(extrema.t_max[1]),
        peak_acceleration=float(np.sqrt(max(0.0, extrema.max[2]))) if bounded else np.inf,
        peak_acceleration_time=float(extrema.t_max[2] if bounded else np.nanmin(step)),
        height_range=(float(extrema.min[0]), float(extrema.max[0])),
        height_times=(float(extrema.t_min[0]), float(extrema.t_max[0])),
        singularities=_singularities(robot, trajectory, series),
    )


def _singularities(robot: Robot, trajectory: Trajectory, series: Piecewise) -> tuple[SingularityReport, ...]:
    kinds = singularity_names(robot)
    first = series.n_components - len(kinds)
    distances = series[first:]
    extrema = distances.extrema()
    zero = singularity_zeros(robot, trajectory(trajectory.breaks))
    candidates = zip(distances.roots(), distances.derivative().roots(), strict=True)
    reports = []
    for k, (kind, times) in enumerate(zip(kinds, candidates, strict=True)):
        crossings = _zeros(distances, k, np.concatenate(times), zero[k])
        low, high = extrema.min[k], extrema.max[k]
        at_low = abs(low) <= abs(high)
        least, time = (abs(low), extrema.t_min[k]) if at_low else (abs(high), extrema.t_max[k])
        if len(crossings):
            least, time = 0.0, crossings[0]
        reports.append(SingularityReport(kind=kind, least_distance=float(least), time=float(time), crossings=crossings))
    return tuple(reports)


def _zeros(distances: Piecewise, k: int, inside: Array, zero: float) -> Array:
    """Instants at which component k is zero: among sign changes, extrema and breaks; the first of each stretch."""
    times: Array = np.sort(np.concatenate([distances.breaks, inside]))
    times = times[np.abs(distances(times)[:, k]) <= zero]
    between = distances((times[:-1] + times[1:]) / 2)[:, k]
    first = np.concatenate([[True], np.abs(between) > zero])
    return read_only(times[first[: len(times)]])
