"""A law of time on a path, from rest to rest: the trajectory of the joints."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic import profiles
from puma_septic.errors import InputError, PumaSepticError
from puma_septic.paths._fitting import fit_state
from puma_septic.paths._joint_path import Constraint, JointPath, follow
from puma_septic.paths._path import Path
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_kind, checked_number

__all__ = ["at_speed", "in_time", "timed", "tool_move"]


def at_speed(path: Path, *, speed: float, acceleration: float, jerk: float | None = None) -> Trajectory:
    r"""The fastest law of time within limits of the tool's speed, acceleration and jerk along its path.

    Without a limit of jerk a trapezoid in speed: with the length L, ramps of :math:`v/a` and a cruise in
    :math:`L/v + v/a` if L is more than :math:`v^2/a`, else two ramps in :math:`2\sqrt{L/a}`. With one the double-S.
    Curves add their centripetal acceleration, :math:`\dot s^2` over the radius: see `tool_rates`.

    Parameters
    ----------
    path : Path
    speed : float
        Of the cruise, m/s, positive.
    acceleration : float
        Along the path, m/s^2, positive.
    jerk : float, optional
        m/s^3, positive.

    Returns
    -------
    Trajectory
        Of one joint, the distance covered in m.

    Raises
    ------
    InputError
        For a value that is not positive.

    Examples
    --------
    >>> import numpy as np
    >>> from puma_septic import paths
    >>> way = paths.line(np.eye(4), [1.0, 0.0, 0.0])
    >>> float(paths.at_speed(way, speed=0.5, acceleration=1.0).duration)
    2.5
    """
    v = checked_number("speed", speed, unit="m/s", above=0.0)
    a = checked_number("acceleration", acceleration, unit="m/s^2", above=0.0)
    points = [[0.0], [checked_kind("path", path, Path).length]]
    if jerk is not None:
        j = checked_number("jerk", jerk, unit="m/s^3", above=0.0)
        return profiles.double_s(points, max_velocity=v, max_acceleration=a, max_jerk=j)
    if path.length <= v * v / a:
        return profiles.bang_bang(points, [0.0, 2 * float(np.sqrt(path.length / a))])
    return profiles.trapezoidal(points, [0.0, path.length / v + v / a], blend_time=v / a)


def in_time(
    path: Path, duration: float, profile: str = "quintic_segments", *, options: Mapping[str, Any] | None = None
) -> Trajectory:
    """A law of time that covers the path in a given time, by a profile of the package from rest to rest.

    Parameters
    ----------
    path : Path
    duration : float
        s, positive.
    profile : str
        A name that `profiles.make` takes.
    options : mapping, optional
        Its further arguments by name.

    Returns
    -------
    Trajectory
        Of one joint, the distance covered in m.

    Raises
    ------
    InputError
        For a duration that is not positive, an unknown profile or option.

    Examples
    --------
    >>> import numpy as np
    >>> from puma_septic import paths
    >>> way = paths.line(np.eye(4), [1.0, 0.0, 0.0])
    >>> float(paths.in_time(way, 2.0, "cycloidal").extrema(1).max[0])
    1.0
    """
    time = checked_number("duration", duration, unit="s", above=0.0)
    length = checked_kind("path", path, Path).length
    return profiles.make(profile, [[0.0], [length]], [0.0, time], options=options)


# A law may miss the ends of its path by this part of the length.
_SAME_LENGTH = 1e-9


def tool_move(
    robot: Robot,
    path: Path,
    law: Trajectory | Piecewise,
    *,
    branch: str | None = None,
    start: ArrayLike | None = None,
    constrain: Constraint = "pose",
) -> Trajectory:
    """The motion of the joints that leads the tool along a path by a law of time.

    The tool is on the path to 1e-9 m and 1e-9 rad at every instant; velocity, acceleration and jerk come from the
    differential kinematics, and lose no digits to differentiation: see `follow` and `timed`.

    Parameters
    ----------
    robot : Robot
    path : Path
    law : Trajectory or Piecewise
        Distance covered over time, m over s, from 0 to the length of the path: `at_speed` and `in_time` make one.
    branch, start, constrain
        As of `follow`.

    Returns
    -------
    Trajectory

    Raises
    ------
    InputError, NoSolution
        As `follow` and `timed`.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> pose = ps.forward_kinematics(robot, [0, 0.5, -2.5, 0, 0.7, 0])
    >>> path = ps.paths.line(pose, pose[:3, 3] + [0, 0.2, 0.1])
    >>> move = ps.tool_move(robot, path, ps.paths.at_speed(path, speed=0.25, acceleration=1.0))
    >>> there = ps.forward_kinematics(robot, move(move.duration))
    >>> float(abs(there - path.frames(path.length)).max().round(9))
    0.0
    """
    return timed(follow(robot, path, branch=branch, start=start, constrain=constrain), law)


def timed(way: JointPath, law: Trajectory | Piecewise) -> Trajectory:
    r"""The motion along a path in joint space by a law of time.

    With the distance s(t),

    .. math:: \dot q = q'\dot s,\quad \ddot q = q''\dot s^2 + q'\ddot s,\quad
              \dddot q = q'''\dot s^3 + 3 q''\dot s\ddot s + q'\dddot s .

    Parameters
    ----------
    way : JointPath
    law : Trajectory or Piecewise
        Distance covered over time, m over s, from 0 to the length of the path.

    Returns
    -------
    Trajectory
        With breaks where the law or the path has them.

    Raises
    ------
    InputError
        For a law of more than one component, or one that does not lead from 0 to the length, or beyond.
    """
    distance = _checked_law(checked_kind("way", way, JointPath).path, law)
    places = way.position.breaks[1:-1]
    if len(places):
        distance = distance.split(np.concatenate((distance[[0] * len(places)] - places).roots()))
    position = fit_state(_composed(way.position, distance), distance.offsets, _not_smooth).shifted(distance.start)
    rests = (law.rest_before, law.rest_after) if isinstance(law, Trajectory) else (True, True)
    return Trajectory(
        position=position,
        points=position(position.breaks[[0, -1]]),
        times=position.breaks[[0, -1]],
        profile=f"{way.path.kind} by {law.profile}" if isinstance(law, Trajectory) else way.path.kind,
        joint_names=way.robot.joint_names,
        rest_before=rests[0],
        rest_after=rests[1],
    )


def _composed(way: Piecewise, distance: Piecewise) -> Callable[[NDArray[np.int64], Array], Array]:
    """Position and derivatives by time at points of the law's intervals."""
    law, state = distance.with_derivatives(3), way.with_derivatives(3)
    which = np.searchsorted(way.offsets[1:-1], distance(distance.middles)[:, 0])
    left, right = way.offsets[which], way.offsets[which + 1]

    def sample(piece: NDArray[np.int64], x: Array) -> Array:
        s, s1, s2, s3 = law.at(piece, x).T[:, :, None]
        place = (2 * s[:, 0] - left[piece] - right[piece]) / (right[piece] - left[piece])
        values = state.at(which[piece], np.clip(place, -1.0, 1.0)).reshape(len(x), 4, -1)
        q, q1, q2, q3 = values.transpose(1, 0, 2)
        return np.stack([q, q1 * s1, q2 * s1**2 + q1 * s2, q3 * s1**3 + 3 * q2 * s1 * s2 + q1 * s3])

    return sample


def _checked_law(path: Path, law: Trajectory | Piecewise) -> Piecewise:
    """The distance over time, from 0 to the length of the path."""
    distance = law.position if isinstance(law, Trajectory) else checked_kind("law", law, Piecewise)
    if distance.n_components != 1:
        raise InputError(f"law: {distance.n_components} components; a law of time has one, the distance covered in m")
    extrema, slack = distance.extrema(), _SAME_LENGTH * path.length
    ends = distance(distance.breaks[[0, -1]])[:, 0]
    if abs(ends[0]) > slack or abs(ends[1] - path.length) > slack:
        raise InputError(
            f"law: leads from {ends[0]:.9g} m to {ends[1]:.9g} m; the path needs 0 to {path.length:.9g} m, as"
            " at_speed and in_time make it"
        )
    if extrema.min[0] < -slack or extrema.max[0] > path.length + slack:
        raise InputError(
            f"law: leaves the path: it reaches from {extrema.min[0]:.9g} m to {extrema.max[0]:.9g} m of"
            f" [0, {path.length:.9g}] m"
        )
    return distance


def _not_smooth(t: float) -> PumaSepticError:
    return PumaSepticError(f"the law of time is not smooth at t = {t:.9g} s and needs a break there")
