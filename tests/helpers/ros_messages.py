"""Messages of ROS as plain documents, for tests."""

from __future__ import annotations

from typing import Any

import numpy as np

import puma_septic as ps

NAMES = tuple(f"joint{k}" for k in range(1, 7))


def message(
    positions: Any,
    times: Any,
    *,
    velocities: Any = None,
    accelerations: Any = None,
    names: tuple[str, ...] = NAMES,
) -> dict[str, Any]:
    """A trajectory_msgs/JointTrajectory; a row of None, or none at all, is an absent field."""

    def row(values: Any, k: int) -> list[float]:
        return [] if values is None or values[k] is None else [float(x) for x in values[k]]

    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": list(names),
        "points": [
            {
                "positions": row(positions, k),
                "velocities": row(velocities, k),
                "accelerations": row(accelerations, k),
                "effort": [],
                "time_from_start": {"sec": int(t), "nanosec": round((t - int(t)) * 1e9)},
            }
            for k, t in enumerate(times)
        ],
    }


def small_move(robot: ps.Robot, duration: float = 2.0) -> ps.Trajectory:
    """From rest to rest within all limits of the PUMA."""
    return ps.quintic_segments(
        np.array([[0.0] * 6, [0.5, -0.5, 0.5, 0.5, 0.5, 0.5]]), [0.0, duration], joint_names=robot.joint_names
    )
