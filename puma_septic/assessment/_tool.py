"""What a motion does at the tool, and how near it comes to singular postures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from puma_septic.kinematics import singularity_distances, singularity_names, singularity_zeros, tool_motion
from puma_septic.motion import Motion
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, read_only

__all__ = ["SingularityReport", "ToolMetrics", "tool_metrics"]


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
        Least and greatest z, m.
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
        return np.column_stack([tool.position[:, 2], *squares, singularity_distances(robot, q)])

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
