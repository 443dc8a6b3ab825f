"""What a simulation is judged by: errors, settling, saturation, chattering, vibration, energy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.document import plain
from puma_septic.validation import Array

__all__ = ["METRICS", "SETTLED", "Metrics", "peak_rms_end", "settling_time", "travel"]

SETTLED: Final = 1e-4
"""Tool error of a settled arm, m: the PUMA 560's repeatability (Unimation, Descriptive Bulletin 22-523)."""

METRICS: Final = {
    "peak_error": "largest deviation of a joint from its plan, rad (m)",
    "rms_error": "its root mean square during the motion, rad (m)",
    "end_error": "its magnitude at the end of the motion, rad (m)",
    "saturation_time": "how long a joint's torque was at its limit, s",
    "chattering": "travel of a joint's torque per second beyond that of the planned torque, N m/s (N/s)",
    "residual_vibration": "half the range of a joint after the end (of its deflection, if elastic), rad (m)",
    "energy_in": "positive work of a joint's actuator, J",
    "tool_peak_error": "largest distance of the tool from its plan, m",
    "tool_rms_error": "its root mean square during the motion, m",
    "tool_end_error": "at the end of the motion, m",
    "tool_residual_vibration": "half the largest extent of the tool's path after the end, m",
    "settling_time": f"from the end of the motion until the tool stays within {1e3 * SETTLED:g} mm, s",
}
"""The metrics by name and what they mean, those of the joints first."""


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Metrics:
    """See `METRICS`; of each joint an array of shape (n_joints,), of the tool a number.

    `settling_time` is infinite where the tool has not settled when the simulation ends.
    """

    peak_error: Array
    rms_error: Array
    end_error: Array
    saturation_time: Array
    chattering: Array
    residual_vibration: Array
    energy_in: Array
    tool_peak_error: float
    tool_rms_error: float
    tool_end_error: float
    tool_residual_vibration: float
    settling_time: float

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready mapping.

        Returns
        -------
        dict
        """
        return {name: plain(getattr(self, name)) for name in METRICS}


def peak_rms_end(t: Array, error: Array, duration: float) -> tuple[Array, Array, Array]:
    """Of error magnitudes (n, m) at samples (n,): over all, over the motion, and at its end."""
    moving = t <= duration * (1 + 1e-12)
    square = error[moving] ** 2
    mean = np.trapezoid(square, t[moving], axis=0) / max(t[moving][-1], 1e-300) if moving.sum() > 1 else square[0]
    return np.abs(error).max(axis=0), np.sqrt(mean), np.abs(error[moving][-1])


def settling_time(t: Array, error: Array, duration: float) -> float:
    """From the end of the motion until an error (n,) stays within `SETTLED`, between samples by a straight line."""
    after: NDArray[np.int64] = np.flatnonzero(t >= duration * (1 - 1e-12))
    beyond = after[error[after] > SETTLED]
    if not len(beyond):
        return 0.0
    k = int(beyond[-1])
    if k + 1 >= len(t):
        return float("inf")
    share = (error[k] - SETTLED) / (error[k] - error[k + 1])
    return float(t[k] + share * (t[k + 1] - t[k]) - duration)


def travel(values: Array) -> Array:
    """How far samples (n, m) go up and down in all."""
    return np.asarray(np.abs(np.diff(values, axis=0)).sum(axis=0))
