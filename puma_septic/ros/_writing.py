"""A Trajectory as trajectory_msgs/JointTrajectory, so that the controller makes the same motion of it."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Final

import numpy as np

from puma_septic.errors import InputError
from puma_septic.files import checked_path
from puma_septic.outputs import write_file
from puma_septic.piecewise import Piecewise
from puma_septic.ros._interpolation import spline_powers
from puma_septic.ros._message import JointTrajectoryMessage
from puma_septic.ros._texts import SUFFIXES, text_of
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_kind, checked_number, checked_texts

__all__ = ["joint_trajectory_document", "message_of", "write_joint_trajectory", "write_message"]

_NS: Final = 10**9
# What the controller interpolates exactly: by degree of the motion, the fields that the points need.
_LINEAR, _CUBIC, _QUINTIC = 1, 3, 5
# What is below this part of a joint's largest value, or coefficient, is rounding.
_ROUNDING: Final = 1e-13
# Points that one interval is divided by at most, each time by two.
_MOST_HALVINGS: Final = 12
# Where the deviation of a part from the motion is looked for: nodes on each interval.
_PROBES: Final = np.linspace(0.0, 1.0, 33)[:-1]


def write_joint_trajectory(
    path: str | PathLike[str],
    trajectory: Trajectory,
    *,
    joint_names: Sequence[str] | None = None,
    effort: Piecewise | None = None,
    tolerance: float = 1e-6,
    overwrite: bool = False,
) -> Path:
    """Write a trajectory as a trajectory_msgs/JointTrajectory, YAML or JSON by the file's ending.

    There is a point at each break, with the fields by which joint_trajectory_controller interpolates the motion
    exactly: positions for straight lines, velocities too for cubics, accelerations too for quintics. A motion of
    a higher degree, or of none, gets points between, until quintics (cubics where its acceleration steps) stay
    within `tolerance` of it. Times are rounded to the nanosecond that the message has.

    Parameters
    ----------
    path : path_like
        Ending in .yaml, .yml or .json.
    trajectory : Trajectory
        Its first break becomes time_from_start 0.
    joint_names : sequence of str, optional
        Where the trajectory has none.
    effort : Piecewise, optional
        Torques to fill the effort fields with, such as ``motion.torque``, N m (N). Left empty by default: a
        controller without an effort interface rejects a trajectory with efforts (all controllers of Humble do,
        ros2_controllers#699).
    tolerance : float
        Greatest deviation of the controller's motion, rad (m).
    overwrite : bool
        Whether it may replace a file.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        For another ending, a file that exists, missing joint names, or a motion whose velocity steps without being
        straight lines, which no JointTrajectory says.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0], [0.5]], [0.0, 2.0], joint_names=["waist"])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = ps.write_joint_trajectory(pathlib.Path(folder, "move.yaml"), move)
    ...     path.read_text().splitlines()[:5]
    ['joint_names:', '- waist', 'points:', '- positions:', '  - 0.0']
    """
    message = message_of(trajectory, joint_names=joint_names, effort=effort, tolerance=tolerance)
    return write_message(path, message, overwrite=overwrite)


def write_message(path: str | PathLike[str], message: JointTrajectoryMessage, *, overwrite: bool = False) -> Path:
    """Write a message, YAML or JSON by the file's ending; with `overwrite` it may replace a file.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        For another ending, and a file that exists or cannot be written.
    """
    target = checked_path(path, "JointTrajectory file")
    if target.suffix not in SUFFIXES:
        raise InputError(f"{target}: the name must end in {', '.join(SUFFIXES)}")
    text = text_of(joint_trajectory_document(message), as_json=target.suffix == ".json")
    return write_file(target, text, overwrite=overwrite)


def joint_trajectory_document(message: JointTrajectoryMessage) -> dict[str, Any]:
    """The message as plain values, with the keys of trajectory_msgs/JointTrajectory."""

    def row(field: str, k: int) -> list[float]:
        values: Array = getattr(message, field)[k]
        return [] if np.isnan(values).any() else values.tolist()

    points = [
        {
            "positions": row("positions", k),
            "velocities": row("velocities", k),
            "accelerations": row("accelerations", k),
            "effort": row("effort", k),
            "time_from_start": {"sec": int(t) // _NS, "nanosec": int(t) % _NS},
        }
        for k, t in enumerate(message.nanoseconds)
    ]
    return {"joint_names": list(message.joint_names), "points": points}


def message_of(
    trajectory: Trajectory,
    *,
    joint_names: Sequence[str] | None = None,
    effort: Piecewise | None = None,
    tolerance: float = 1e-6,
) -> JointTrajectoryMessage:
    """The message that `write_joint_trajectory` writes."""
    allowed = checked_number("tolerance", tolerance, unit="rad", above=0.0)
    own = checked_kind("trajectory", trajectory, Trajectory).joint_names
    names = checked_texts("joint_names", joint_names) or own
    if effort is not None:
        checked_kind("effort", effort, Piecewise)
    if len(names) != trajectory.n_joints:
        raise InputError(f"joint_names: {len(names)} names for {trajectory.n_joints} joints; a message needs each")
    # On a clock that begins at 0, as the message's does: a late one rounds its times.
    begin = float(trajectory.breaks[0])
    trajectory = trajectory.shifted(-begin)
    fields, times = _fields(trajectory, begin), trajectory.breaks
    if _degree(trajectory) > 2 * fields - 1:
        times = _divided(trajectory, fields, allowed)
    nanoseconds = np.round(times * _NS).astype(np.int64)
    if (np.diff(nanoseconds) <= 0).any():
        k = int(np.argmin(np.diff(nanoseconds)))
        raise InputError(f"points at {times[k]:.12g} s and {times[k + 1]:.12g} s are one in the message's nanoseconds")
    positions, velocities, accelerations = _values(trajectory, times, fields)
    return JointTrajectoryMessage(
        joint_names=names,
        nanoseconds=nanoseconds,
        positions=positions,
        velocities=velocities,
        accelerations=accelerations,
        effort=np.full_like(positions, np.nan) if effort is None else effort(begin + times),
    )


def _values(trajectory: Trajectory, times: Array, fields: int) -> list[Array]:
    """Positions, velocities and accelerations at times, rounding as 0; NaN for those that are not wanted."""
    values = [np.full((len(times), trajectory.n_joints), np.nan) for _ in range(3)]
    for order in range(fields):
        # At the ends of the series: where an interval is short, the rounding of an instant in it is not.
        function = trajectory.derivative(order).split(times)
        left, right = function.ends()
        at = np.concatenate([left, right[-1:]])
        largest = function.bounds().max(axis=0)
        values[order] = np.where(np.abs(at) <= _ROUNDING * largest, 0.0, at)
    return values


def _degree(trajectory: Trajectory) -> int:
    """Highest degree that is more than rounding, over all intervals and joints."""
    return trajectory.position.trimmed(_ROUNDING).degree


def _fields(trajectory: Trajectory, begin: float) -> int:
    """How many of positions, velocities, accelerations the points of a motion that begins at 0 need: 1, 2 or 3.

    A point has one velocity and one acceleration, so what steps inside the motion is not given.
    """
    inside = [bool(np.isin(trajectory.jumps(order).times, trajectory.breaks[1:-1]).any()) for order in (1, 2)]
    degree = _degree(trajectory)
    if degree <= _LINEAR:
        return 1
    if inside[0]:
        steps = trajectory.jumps(1)
        raise InputError(
            f"the velocity steps at t = {begin + steps.times[0]:.9g} s and the motion is not made of straight lines:"
            " points with one velocity each do not say that"
        )
    return 2 if inside[1] or degree <= _CUBIC else 3


def _divided(trajectory: Trajectory, fields: int, tolerance: float) -> Array:
    """Breaks and times between, so that Hermite polynomials of `fields` values at both ends keep to the motion."""
    times = trajectory.breaks
    for _ in range(_MOST_HALVINGS):
        far = _deviation(trajectory, times, fields) > tolerance
        if not far.any():
            return times
        times = np.sort(np.concatenate([times, ((times[:-1] + times[1:]) / 2)[far]]))
    raise InputError(
        f"{len(times)} points do not bring the controller's motion within {tolerance:g} of this one; allow more"
    )


def _deviation(trajectory: Trajectory, times: Array, fields: int) -> Array:
    """Largest distance on each interval, over the joints, between the motion and the controller's, shape (n,)."""
    p, v, a = _values(trajectory, times, fields)
    powers = spline_powers(p, v, a, np.diff(times)[:, None])
    made = Piecewise.from_power(times, powers)
    t = (times[:-1, None] + np.diff(times)[:, None] * _PROBES).ravel()
    return np.asarray(np.abs(made(t) - trajectory(t)).reshape(len(times) - 1, -1).max(axis=1))
