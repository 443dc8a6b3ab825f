"""What a motion does at the tool, and how near it comes to singular postures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from puma_septic.checks import Array
from puma_septic.kinematics import tool_motion
from puma_septic.kinematics.singularity import singularity_distances, singularity_names
from puma_septic.motion import Motion
from puma_septic.piecewise import Piecewise

__all__ = ["SingularityReport", "ToolMetrics", "tool_metrics"]

# A measure that touches zero without changing sign is taken to be zero below this part of its largest value.
_ZERO = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SingularityReport:
    """How near a motion comes to one kind of singular posture.

    Attributes
    ----------
    kind : str
        "shoulder", "elbow", "wrist" for a PUMA; "determinant" or "manipulability" otherwise.
    least_distance : float
        Least magnitude of the measure (see `puma_septic.kinematics.singularity`), 0 where it is crossed.
    time : float
        When, s.
    crossings : ndarray, shape (k,)
        Instants at which the arm passes through the singularity, s.
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
        m/s and s; infinite where the velocity is not defined because a position steps.
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

    def measures(t: Array) -> Array:
        q, v, a = (trajectory(t, order) for order in range(3))
        tool = tool_motion(robot, q, v, a)
        squares = [(vector**2).sum(axis=1) for vector in (tool.velocity, tool.acceleration)]
        return np.column_stack([tool.position[:, 2], *squares, singularity_distances(robot, q)])

    series = Piecewise.fit(measures, trajectory.breaks)
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
        singularities=_singularities(singularity_names(robot), series),
    )


def _singularities(kinds: tuple[str, ...], series: Piecewise) -> tuple[SingularityReport, ...]:
    first = series.n_components - len(kinds)
    distances = Piecewise(breaks=series.breaks, coefficients=series.coefficients[:, :, first:])
    extrema = distances.extrema()
    pieces = distances.split(np.concatenate(distances.roots()))
    sign = pieces.signs()
    reports = []
    for k, kind in enumerate(kinds):
        low, high = extrema.min[k], extrema.max[k]
        at_low = abs(low) <= abs(high)
        least, time = (abs(low), extrema.t_min[k]) if at_low else (abs(high), extrema.t_max[k])
        crossings = pieces.breaks[1:-1][sign[:-1, k] * sign[1:, k] < 0]
        if len(crossings):
            least, time = 0.0, crossings[0]
        elif least <= _ZERO * extrema.peak[k]:
            crossings = np.array([time])
        reports.append(SingularityReport(kind=kind, least_distance=float(least), time=float(time), crossings=crossings))
    return tuple(reports)
