"""Key frames, and what is marked on them: utilisation, violated limits, singular postures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, final

import numpy as np
import pinocchio as pin
from meshcat.animation import Animation, AnimationClip, AnimationTrack
from meshcat.path import Path

from puma_septic.assessment import Assessment, height_series
from puma_septic.kinematics import height_parts
from puma_septic.limit_check import HEIGHT, LimitCheck
from puma_septic.motion import Motion
from puma_septic.paths import tool_rates
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array
from puma_septic.viewer._colours import UTILISATION, colour_at

__all__ = [
    "ANGLE_ERROR",
    "Flag",
    "add_colours",
    "add_joints",
    "add_presence",
    "flags_of",
    "joint_paths",
    "key_times",
    "utilisation",
]


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
        return height_series(motion.robot, motion.trajectory)[height_parts(robot).index(check.joint)], (
            check.limit,
            np.nan,
        )
    j = robot.joint_index(check.joint)
    low, high = robot.limits.position[j].tolist() if check.is_range else (-check.limit, check.limit)
    return motion.signal(check.quantity)[j], (low, high)


# Between key frames the viewer turns each joint at a constant rate; that is off by at most a h^2 / 8. One
# ten-thousandth of a radian is 0.1 mm at 1 m, less than a pixel of any view of the whole arm.
ANGLE_ERROR: Final = 1e-4
# A picture is not drawn more often than 60 times a second, nor are colours smooth below 30; and a bound on the file.
_LONGEST_STEP: Final = 1 / 30
_MOST_KEYS: Final = 3000
# Below this a joint has not moved, in m and in components of a unit quaternion.
_STILL: Final = 1e-9


def key_times(motion: Motion) -> Array:
    """Instants of the key frames in s: the breaks of trajectory and torque, and between them as many as it takes.

    Of more breaks than key frames can be, as a recorded motion has, evenly spaced instants instead.
    """
    trajectory = motion.trajectory
    fastest = max(float(trajectory.extrema(2).peak.max()), np.finfo(float).tiny)
    step = min(_LONGEST_STEP, float(np.sqrt(8 * ANGLE_ERROR / fastest)))
    step = max(step, trajectory.duration / _MOST_KEYS)
    breaks = np.union1d(trajectory.breaks, motion.torque.breaks)
    if len(breaks) > _MOST_KEYS:  # of a recorded motion, in which nothing happens at most of them
        return np.linspace(breaks[0], breaks[-1], int(np.ceil(trajectory.duration / step)) + 1)
    counts = np.ceil(np.diff(breaks) / step).astype(int)
    spans = zip(breaks[:-1], breaks[1:], counts, strict=True)
    inner = [np.linspace(start, stop, count, endpoint=False) for start, stop, count in spans]
    return np.append(np.concatenate(inner), breaks[-1])


def utilisation(motion: Motion, times: Array) -> Array:
    """Magnitude of the torque over its limit, shape (n, n_joints); NaN where either is not known."""
    used = np.abs(motion.torque(times)) / motion.robot.limits.effort
    return np.where(motion.robot.knows_torque, used, np.nan)


def joint_paths(model: pin.Model, root: str) -> list[str]:
    """Where each joint of the model hangs in the scene's tree: on the joint that carries it."""
    paths = [root]
    for k in range(1, model.njoints):
        paths.append(f"{paths[model.parents[k]]}/joint{k}")
    return paths


def add_joints(animation: Animation, root: str, motion: Motion, times: Array, start: float) -> None:
    """Write each joint's motion relative to the joint that carries it, so that links never come apart.

    Parameters
    ----------
    start : float
        Time of the scene at its zero, s.
    """
    robot = motion.robot
    model, data = robot.model, robot.model.createData()
    paths = joint_paths(model, root)
    translation = np.empty((model.njoints, len(times), 3))
    quaternion = np.empty((model.njoints, len(times), 4))
    for n, q in enumerate(robot.configurations(motion.trajectory(times))):
        pin.forwardKinematics(model, data, q)
        for k in range(1, model.njoints):
            translation[k, n] = data.liMi[k].translation
            quaternion[k, n] = pin.Quaternion(data.liMi[k].rotation).coeffs()
    for k in range(1, model.njoints):
        tracks = [("position", "vector3", translation[k]), ("quaternion", "quaternion", quaternion[k])]
        _add(animation, paths[k], times - start, [track for track in tracks if np.ptp(track[2], axis=0).max() > _STILL])


def add_colours(animation: Animation, path: str, used: Array, times: Array, start: float) -> None:
    """Colour one shape by the utilisation of the joint that moves it, shape (n,); not at all where that is unknown."""
    if not np.isnan(used).any():
        track = ("material.color", "color", colour_at(UTILISATION, used))
        _add(animation, f"{path}/<object>", times - start, [track])


def add_presence(animation: Animation, path: str, parts: Sequence[Motion], there: Sequence[bool], begin: float) -> None:
    """Show an object during some parts of a motion alone, which begins so many seconds after the scene's zero."""
    if not all(there):
        starts = begin + np.cumsum([0.0, *(part.trajectory.duration for part in parts[:-1])])
        _add(animation, path, starts, [("visible", "bool", np.array(there))])


def _add(animation: Animation, path: str, seconds: Array, tracks: list[tuple[str, str, Array]]) -> None:
    """One clip for one object; at one frame a second its frame numbers are seconds."""
    made: dict[str, Any] = {
        name: AnimationTrack(name, kind, seconds.tolist(), values.tolist()) for name, kind, values in tracks
    }
    if made:
        animation.clips[Path().append(path)] = AnimationClip(tracks=made, fps=1)
