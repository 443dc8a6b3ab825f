"""Why an arm cannot follow a path: where, by how much, and what would help."""

from __future__ import annotations

import numpy as np

from puma_septic.errors import NoSolution
from puma_septic.kinematics import singularity_distances, singularity_names
from puma_septic.paths._path import Path
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["beyond_limit", "off_path", "out_of_reach", "place", "singular"]

# A pose that is nearer than this to one in reach, in m, is reached, by another branch.
_REACHED = 1e-9


def place(path: Path, s: float) -> str:
    """A place on the path in words."""
    s = min(max(s, 0.0), path.length)
    point = ", ".join(f"{x:.6g}" for x in path.frames(s)[:3, 3])
    return f"at s = {s:.6g} m of {path.length:.6g} m, tool at [{point}] m"


def out_of_reach(path: Path, s: float, q: Array, distance: float, held: str) -> NoSolution:
    """The branch ends: no branch reaches the pose, or others do."""
    ends = f"out of reach by {distance:.3g} m" if distance > _REACHED else "this branch ends"
    return NoSolution(
        f"{path.kind}{held}: {ends} {place(path, s)}; move the path nearer, or its ends",
        residual=distance,
        q=q,
    )


def singular(path: Path, s: float, q: Array, robot: Robot, held: str) -> NoSolution:
    """The path meets a singular posture: two branches, or all turns of a joint, are one there."""
    measures = singularity_distances(robot, q[None])[0]
    nearest = int(np.argmin(np.abs(measures)))
    name, measure = singularity_names(robot)[nearest], float(measures[nearest])
    return NoSolution(
        f"{path.kind}{held}: meets a singularity {place(path, s)} ({name} {measure:.3g}, zero where singular), where"
        " joints would have to move without bound; tilt the tool, shift the path aside, or pass there by a joint move",
        residual=abs(measure),
        q=q,
    )


def off_path(path: Path, s: float, q: Array, residual: float, held: str) -> NoSolution:
    """No joint positions hold the pose, though others before it are held."""
    return NoSolution(
        f"{path.kind}{held}: the arm leaves the path {place(path, s)} ({residual:.3g} m or rad off): that pose is out"
        " of its reach, or asks for more than its joints can do; constrain='position' leaves the orientation free",
        residual=residual,
        q=q,
    )


def beyond_limit(path: Path, robot: Robot, j: int, s: float, q: Array, held: str) -> NoSolution:
    """A joint leaves its range, with whatever whole turns."""
    low, high = robot.limits.position[j]
    unit = "m" if robot.is_prismatic[j] else "rad"
    excess = float(np.nanmax([low - q[j], q[j] - high]))
    return NoSolution(
        f"{path.kind}{held}: joint {robot.joint_names[j]!r}: {q[j]:.6g} {unit} is outside [{low:.6g}, {high:.6g}]"
        f" {unit} {place(path, s)}; take another branch, start or tool angle",
        residual=excess,
        q=q,
    )
