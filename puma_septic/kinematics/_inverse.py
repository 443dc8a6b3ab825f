"""Inverse kinematics: every branch of a PUMA in closed form, damped least squares for other arms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.errors import InputError, ModelError, NoSolution
from puma_septic.kinematics._chain import chain_to, checked_joint_values, end_frame
from puma_septic.kinematics._least_squares import SOLVED, distinct, end_errors, is_singular, solve_from_starts
from puma_septic.kinematics._poses import checked_poses
from puma_septic.kinematics._puma_branches import CONFIGURATIONS, SINGULARITIES, PumaGeometry, puma_geometry
from puma_septic.kinematics._puma_ik import (
    REACH_TOLERANCE,
    Branches,
    solve_branches,
    solve_in_blocks,
    why_out_of_reach,
)
from puma_septic.kinematics._wrapping import within
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_array, checked_choice, checked_number, read_only
from puma_septic.views.tables import html_table

__all__ = ["IkBatch", "IkSolutions", "inverse_kinematics", "inverse_kinematics_batch", "rtb_names"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class IkSolutions:
    """Joint positions that put the tool on one pose.

    Attributes
    ----------
    q : ndarray, shape (k, n_joints)
        rad (m for prismatic joints).
    configurations : tuple of str, length k
        PUMA: arm, elbow and wrist, such as "right-up-noflip"; other arms: "solution-1" and so on, the ones
        within their limits first.
    within_limits : ndarray of bool, shape (k,)
        Whether every joint is within its position limits; an unknown limit is not violated.
    singular : tuple of tuple of str, length k
        Which singularities the branch stands at ("shoulder", "elbow", "wrist"; other arms: "jacobian").
        There two branches meet; at the PUMA's wrist only q4 + q6 (q4 - q6 where q5 is half a turn) is given
        by the pose.
    residual : ndarray, shape (k,)
        Largest entry of ``|T(q) - T|``: m, and rad as long as it is small.
    """

    q: Array
    configurations: tuple[str, ...]
    within_limits: NDArray[np.bool_]
    singular: tuple[tuple[str, ...], ...]
    residual: Array

    def select(self, configuration: str) -> Array:
        """Joint positions of a named branch, shape (n_joints,); an unknown name lists the valid ones."""
        name = checked_choice("configuration", configuration, self.configurations)
        return np.asarray(self.q[self.configurations.index(name)])

    def _repr_html_(self) -> str:
        joints = [f"q{j + 1}" for j in range(self.q.shape[1])]
        rows = zip(self.configurations, self.q.tolist(), self.within_limits, self.singular, self.residual, strict=True)
        return html_table(
            ["branch", *joints, "within limits", "singular", "residual"],
            [
                [
                    name,
                    *(f"{round(value, 4) + 0.0:.4f}" for value in q),
                    "yes" if fits else "no",
                    ", ".join(at),
                    f"{left:.1e}",
                ]
                for name, q, fits, at, left in rows
            ],
            caption="Inverse kinematics: joint positions in rad (sliding joints: m)",
        )


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class IkBatch:
    """All eight branches of a PUMA for n poses.

    Attributes
    ----------
    q : ndarray, shape (n, 8, 6)
        rad. For a pose out of reach: of the same orientation, with the wrist centre at the nearest point in
        reach.
    configurations : tuple of str, length 8
        Names of the branches.
    reachable : ndarray of bool, shape (n,)
    out_of_reach : ndarray, shape (n,)
        How far the wrist centre is from the nearest point in reach, in m; 0 or rounding where reachable.
    within_limits : ndarray of bool, shape (n, 8)
    singular : ndarray of bool, shape (n, 8, 3)
        At the shoulder's, the elbow's, the wrist's singularity.
    residual : ndarray, shape (n, 8)
        Largest entry of ``|T(q) - T|``: m, and rad as long as it is small.
    """

    q: Array
    configurations: tuple[str, ...]
    reachable: NDArray[np.bool_]
    out_of_reach: Array
    within_limits: NDArray[np.bool_]
    singular: NDArray[np.bool_]
    residual: Array


def inverse_kinematics(
    robot: Robot,
    T_world_tool: ArrayLike,
    *,
    q_near: ArrayLike | None = None,
    rng: np.random.Generator | None = None,
    starts: int = 32,
) -> IkSolutions:
    """Find the joint positions that put the tool on a pose.

    An arm with a PUMA's joints is solved in closed form (Paul & Zhang 1986): always all eight branches,
    right arm before left, elbow up before down, no flip before flip. The arm is right if the wrist centre is
    in front of joint 1's axis, ``V = a2 c2 + a3 c23 - d4 s23 > 0``; the elbow is up if ``V sin(q3 +
    atan2(d4, a3)) < 0``; the wrist is not flipped if ``sin(q5) >= 0``. `rtb_names` translates. Each angle
    comes with the whole turns that bring it within its limits; where none does, with those that bring it
    nearest to their middle (of two equally near, either). Where a pose leaves q4 free (q5 = 0), it is that
    of `q_near`, else 0.

    Any other arm is solved by damped least squares (Levenberg-Marquardt) from `starts` starts; distinct
    answers are returned, at least one. Steps stay within the position limits; only if that fails from every
    start, they don't.

    Parameters
    ----------
    robot : Robot
    T_world_tool : array_like, shape (4, 4)
        Pose of the robot's tool: maps tool coordinates into world, lengths in m.
    q_near : array_like, shape (n_joints,), optional
        Turns and free joints are chosen near it, and damped least squares starts from it.
    rng : numpy.random.Generator, optional
        For the random starts of damped least squares; a new ``default_rng(0)`` otherwise, so that equal
        calls give equal answers.
    starts : int
        Number of starts of damped least squares.

    Returns
    -------
    IkSolutions
        A branch outside the joint limits is an answer as well, and flagged.

    Raises
    ------
    InputError
        For a pose that is not a rigid transform (to 1e-9).
    NoSolution
        Out of reach; with the nearest `q`, what it leaves over, and for a PUMA how far out of reach the pose
        is.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> pose = ps.forward_kinematics(robot, [0, 0.5, -2.5, 0, 0.7, 0])
    >>> solutions = ps.inverse_kinematics(robot, pose)
    >>> solutions.configurations[0], solutions.q[0].round(6).tolist(), bool(solutions.within_limits[0])
    ('right-up-noflip', [0.0, 0.5, -2.5, 0.0, 0.7, 0.0], True)
    """
    checked_array("T_world_tool", T_world_tool, (4, 4))
    target = checked_poses("T_world_tool", np.asarray(T_world_tool, dtype=float)[None])
    near = None if q_near is None else checked_array("q_near", q_near, (robot.n_joints,))
    geometry = puma_geometry(chain_to(robot))
    if geometry is None:
        count = int(checked_number("starts", starts, at_least=1))
        return _numeric(robot, target, near, count, np.random.default_rng(0) if rng is None else rng)
    found = solve_branches(robot, geometry, target, None if near is None else near[None])
    if found.distance[0] > REACH_TOLERANCE:
        raise _out_of_reach(robot, geometry, target, found, near)
    return IkSolutions(
        q=read_only(found.q[0]),
        configurations=CONFIGURATIONS,
        within_limits=within(robot, found.q[0]),
        singular=tuple(
            tuple(name for name, at in zip(SINGULARITIES, row, strict=True) if at) for row in found.singular[0]
        ),
        residual=read_only(found.residual[0]),
    )


def inverse_kinematics_batch(robot: Robot, T_world_tool: ArrayLike, *, q_near: ArrayLike | None = None) -> IkBatch:
    """Find all eight branches of a PUMA for many poses at once, as `inverse_kinematics` does for one.

    Parameters
    ----------
    robot : Robot
        An arm with a PUMA's joints.
    T_world_tool : array_like, shape (n, 4, 4)
        Poses of the robot's tool, lengths in m.
    q_near : array_like, shape (6,) or (n, 6), optional
        Turns, and q4 where a pose leaves it free, are chosen near it.

    Returns
    -------
    IkBatch
        A pose out of reach is no error here: it is marked.

    Raises
    ------
    InputError
        For a pose that is not a rigid transform (to 1e-9); the message has its index.
    ModelError
        For any other arm.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> poses = ps.forward_kinematics(robot, [[0, 0.5, -2.5, 0, 0.7, 0], [1, 0, 0, 0, 0.5, 0]])
    >>> ps.inverse_kinematics_batch(robot, poses).q.shape
    (2, 8, 6)
    """
    geometry = puma_geometry(chain_to(robot))
    if geometry is None:
        raise ModelError(
            f"robot {robot.name!r} does not have a PUMA's joints, so that there is no closed form: call"
            " inverse_kinematics for each pose"
        )
    target = checked_poses("T_world_tool", T_world_tool)
    near = None if q_near is None else checked_joint_values(robot, "q_near", q_near)
    if near is not None and len(near) not in (1, target.shape[2]):
        raise InputError(f"q_near: {len(near)} rows for {target.shape[2]} poses; give one row, or one each")
    found = solve_in_blocks(robot, geometry, target, near)
    for array in (found.q, found.distance, found.singular, found.residual):
        array.setflags(write=False)
    return IkBatch(
        q=found.q,
        configurations=CONFIGURATIONS,
        reachable=found.distance <= REACH_TOLERANCE,
        out_of_reach=found.distance,
        within_limits=within(robot, found.q),
        singular=found.singular,
        residual=found.residual,
    )


def rtb_names(configuration: str) -> tuple[str, str]:
    """Names of a PUMA's branch in Corke's Robotics Toolbox: for Python, for MATLAB 10.x.

    Both have r/l for the arm and u/d for the elbow as here. Their n/f are opposite: MATLAB's n is sin(q5) >=
    0, as "noflip" here (``ikine6s.m`` since November 2014), Python's n is sin(q5) < 0 (``Puma560.ikine_a``).

    Examples
    --------
    >>> rtb_names("left-down-flip")
    ('ldn', 'ldf')
    """
    arm, elbow, wrist = checked_choice("configuration", configuration, CONFIGURATIONS).split("-")
    matlab = wrist[0]
    return f"{arm[0]}{elbow[0]}{'f' if matlab == 'n' else 'n'}", f"{arm[0]}{elbow[0]}{matlab}"


def _out_of_reach(
    robot: Robot, geometry: PumaGeometry, target: Array, found: Branches, near: Array | None
) -> NoSolution:
    """The error for a wrist centre out of reach, with the best branch: within limits, then near `q_near`."""
    fits = within(robot, found.q[0])
    away = np.zeros(len(fits)) if near is None else np.linalg.norm(found.q[0] - near, axis=1)
    q = read_only(found.q[0, np.lexsort((away, ~fits))[0]])
    left = end_errors(chain_to(robot), target, q[None])[0]
    distance = float(found.distance[0])
    return NoSolution(
        f"T_world_tool is out of reach by {distance:.6g} m: {why_out_of_reach(geometry, target)}; {_left(q, left)}",
        residual=distance,
        q=q,
    )


def _numeric(robot: Robot, target: Array, near: Array | None, starts: int, rng: np.random.Generator) -> IkSolutions:
    """The distinct answers of damped least squares, those within the limits first."""
    q, errors = solve_from_starts(robot, target, near, starts=starts, rng=rng)
    size = np.abs(errors).max(axis=1)
    if not (size <= SOLVED).any():
        best = int(np.argmin(np.linalg.norm(errors, axis=1)))
        position, angle = np.linalg.norm(errors[best].reshape(2, 3), axis=1)
        raise NoSolution(
            f"no joint positions found for T_world_tool in {len(q)} attempts; {_left(q[best], errors[best])}",
            residual=float(max(position, angle)),
            q=read_only(q[best]),
        )
    q = q[size <= SOLVED]
    q = q[distinct(robot, q)]
    q = q[np.argsort(~within(robot, q), kind="stable")]
    off = end_frame(chain_to(robot), q.T) - target
    return IkSolutions(
        q=read_only(q),
        configurations=tuple(f"solution-{k + 1}" for k in range(len(q))),
        within_limits=within(robot, q),
        singular=tuple(("jacobian",) if at else () for at in is_singular(robot, q)),
        residual=read_only(np.abs(off).reshape(12, -1).max(axis=0)),
    )


def _left(q: Array, errors: Array) -> str:
    """The nearest q and what it leaves over, in words."""
    position, angle = np.linalg.norm(errors.reshape(2, 3), axis=1)
    return f"the nearest q = {np.round(q, 6).tolist()} leaves {position:.6g} m and {angle:.3g} rad"
