"""A law of time on a path: the trajectory of the joints."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.errors import InputError, PumaSepticError
from puma_septic.paths._fitting import fit_state
from puma_septic.paths._joint_path import Constraint, JointPath, follow
from puma_septic.paths._path import Path
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["timed", "tool_move"]

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
    distance = _checked_law(way.path, law)
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
    distance = law.position if isinstance(law, Trajectory) else law
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
