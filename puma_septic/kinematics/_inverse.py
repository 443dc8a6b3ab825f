"""Inverse kinematics: every branch in closed form where there is one, damped least squares for other arms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.document import one_line
from puma_septic.errors import InputError, ModelError, NoSolution
from puma_septic.kinematics._chain import chain_to, checked_joint_values, end_frame
from puma_septic.kinematics._closed_form import (
    Branches,
    ClosedForm,
    closed_form,
    configurations,
    solve_branches,
    solve_in_blocks,
    why_out_of_reach,
)
from puma_septic.kinematics._least_squares import end_errors, is_singular, is_solved, solve_from_starts
from puma_septic.kinematics._poses import CONDITIONS, RIGIDITY, Conditions, checked_conditions, checked_poses, told
from puma_septic.kinematics._puma_branches import CONFIGURATIONS, SINGULARITIES, PumaGeometry
from puma_septic.kinematics._wrapping import within
from puma_septic.robot import Robot
from puma_septic.validation import (
    Array,
    checked_array,
    checked_choice,
    checked_kind,
    checked_number,
    checked_rng,
    checked_whole,
    freeze_fields,
    read_only,
)
from puma_septic.views.tables import html_table

__all__ = [
    "IkBatch",
    "IkSolutions",
    "inverse_kinematics",
    "inverse_kinematics_batch",
    "rtb_names",
]

# Of damped least squares: each takes some 0.1 ms.
_MOST_STARTS: Final = 10_000


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class IkSolutions:
    """Joint positions that put the tool on one pose.

    Attributes
    ----------
    q : ndarray, shape (k, n_joints)
        rad (m for prismatic joints).
    configurations : tuple of str, length k
        With a closed form: arm, elbow and wrist, such as "right-up-noflip"; else "solution-1" and so on, the ones
        within their limits first, which mean nothing from pose to pose.
    within_limits : ndarray of bool, shape (k,)
        Whether every joint is within its position limits; an unknown limit is not violated.
    singular : tuple of tuple of str, length k
        Which singularities the branch stands at ("shoulder", "elbow", "wrist"; without a closed form: "jacobian").
        There two branches meet; at the PUMA's wrist only q4 + q6 (q4 - q6 where q5 is half a turn) is given
        by the pose.
    residual : ndarray, shape (k,)
        Largest entry of ``|T(q) - T|``, or of what is left of the conditions: m, and rad as long as it is small.
    is_complete : bool
        Whether these are all branches, which only a closed form can tell; angles that differ by whole turns count once.
    starts : int
        How many starts of damped least squares they come from; 0 for a closed form.
    """

    q: Array
    configurations: tuple[str, ...]
    within_limits: NDArray[np.bool_]
    singular: tuple[tuple[str, ...], ...]
    residual: Array
    is_complete: bool
    starts: int

    def __post_init__(self) -> None:
        freeze_fields(self)

    @property
    def extent(self) -> str:
        """How many they are, of how many: "all 8 branches", "5 solutions found from 32 starts"."""
        count = len(self.q)
        if self.is_complete:
            return f"all {count} branches" if count > 1 else "the only branch"
        if not self.starts:
            return f"{_counted(count, 'branch', 'branches')} found close to a singularity"
        return f"{_counted(count, 'solution', 'solutions')} found from {_counted(self.starts, 'start', 'starts')}"

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
                    *(f"{value:z.4f}" for value in q),
                    "yes" if fits else "no",
                    ", ".join(at),
                    f"{left:.1e}",
                ]
                for name, q, fits, at, left in rows
            ],
            caption=f"Inverse kinematics, {self.extent}: joint positions in rad (prismatic joints: m)",
        )

    def __repr__(self) -> str:
        return one_line("IkSolutions", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "branches": ", ".join(self.configurations),
            "within limits": int(self.within_limits.sum()),
            "extent": self.extent,
        }


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class IkBatch:
    """The eight branches of an arm that has a closed form, for n poses.

    Attributes
    ----------
    q : ndarray, shape (n, 8, n_joints)
        rad. For a branch that the pose does not have: the joint positions that come nearest in the closed form; for a
        PUMA of the same orientation, with the wrist centre at the nearest point in reach.
    configurations : tuple of str, length 8
        Names of the branches.
    reachable : ndarray of bool, shape (n,)
        Whether any branch exists.
    out_of_reach : ndarray, shape (n,)
        How far the wrist centre of a PUMA is from the nearest point in reach, in m; 0 or rounding where reachable. For
        other arms how far the tool is from the pose in the nearest of these branches.
    within_limits : ndarray of bool, shape (n, 8)
    singular : ndarray of bool, shape (n, 8, 3)
        At the shoulder's, the elbow's, the wrist's singularity.
    residual : ndarray, shape (n, 8)
        Largest entry of ``|T(q) - T|``: m, and rad as long as it is small.
    exists : ndarray of bool, shape (n, 8)
        Whether the pose has the branch. A PUMA has all eight or none.
    is_complete : ndarray of bool, shape (n,)
        Whether those that exist are certainly all; see `inverse_kinematics`.
    """

    q: Array
    configurations: tuple[str, ...]
    reachable: NDArray[np.bool_]
    out_of_reach: Array
    within_limits: NDArray[np.bool_]
    singular: NDArray[np.bool_]
    residual: Array
    exists: NDArray[np.bool_]
    is_complete: NDArray[np.bool_]


def inverse_kinematics(
    robot: Robot,
    T_world_tool: ArrayLike,
    *,
    constrain: str | Sequence[bool] = "pose",
    tolerance: float = RIGIDITY,
    q_near: ArrayLike | None = None,
    rng: np.random.Generator | None = None,
    starts: int = 32,
) -> IkSolutions:
    """Find the joint positions that put the tool on a pose.

    Six revolute axes are solved in closed form where axis 3 is parallel to 2 and the wrist is spherical (axes 4 to 6
    meet in a point) or axis 4 is parallel to 2 and 3 and axis 6 meets 5 (Paul & Zhang 1986; Hawkins 2013; Elias & Wen
    2022): all branches, at most eight. What counts is where the model's axes lie, to 3 mm and 3e-3 rad; answers are
    polished on the model to 1e-10. An arm off the pattern may have two branches more or fewer close to a singularity:
    there `is_complete` is False.

    The names hold from pose to pose; a branch changes its name only at a singularity.

    - Arm: right (before left) if the plane in which joints 2 and 3 move passes axis 1 on the right, seen from axis 1
      towards the wrist centre. Where axis 1 lies in that plane: front (before back) if the wrist centre is on the side
      of axis 2, or, where axes 1 and 2 meet, on the side to which joint 2 leans the arm.
    - Elbow: up (before down) if it lies above the line from shoulder to wrist while the wrist centre is ahead of axis
      1, up being away from the foot of the arm. For a PUMA: ``V sin(q3 + atan2(d4, a3)) < 0`` with the wrist centre's
      way ahead ``V = a2 c2 + a3 c23 - d4 s23 > 0`` for the right arm. `rtb_names` translates.
    - Wrist: noflip (before flip) if ``(h4 x h6) . h5 >= 0`` for the directions of axes 4 to 6; PUMA: ``sin(q5) >= 0``.

    Each angle comes with the whole turns that bring it within its limits; where none does, with those that bring it
    nearest to their middle (of two equally near, either). Where a pose leaves a joint of the wrist free, it is that
    of `q_near`, else 0.

    Any other arm is solved by damped least squares (Levenberg-Marquardt) from `starts` starts and, for six revolute
    joints, from the mirror images of what they find; distinct answers are returned, at least one. Steps stay within the
    position limits; only if that fails from every start, they don't. There may be more answers: `is_complete` is False.

    Parameters
    ----------
    robot : Robot
    T_world_tool : array_like, shape (4, 4)
        Pose of the robot's tool: maps tool coordinates into world, lengths in m.
    constrain : str or sequence of six bool
        Which conditions count: "pose" all six, "position" the tool's origin alone, "axis" the origin and where the
        tool's z axis points, or six truth values for the position along and the turn about the target's axes x, y, z.
        Anything but "pose" is for arms with fewer axes, or leaves the others free; damped least squares answers it.
    tolerance : float
        How far ``R^T R`` may be from the identity: the nearest rotation is taken then. A rotation copied with four
        decimals needs 2e-4.
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
        For a pose that is not a rigid transform to the tolerance, or unknown conditions.
    NoSolution
        Out of reach; with the nearest `q`, what it leaves over, and for a PUMA how far out of reach the pose
        is. For fewer joints than conditions the message says so, and what to give instead.
    ModelError
        Where no joint carries the tool.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> pose = ps.forward_kinematics(robot, [0, 0.5, -2.5, 0, 0.7, 0])
    >>> solutions = ps.inverse_kinematics(robot, pose)
    >>> solutions.configurations[0], solutions.q[0].round(6).tolist(), bool(solutions.within_limits[0])
    ('right-up-noflip', [0.0, 0.5, -2.5, 0.0, 0.7, 0.0], True)
    >>> solutions.extent
    'all 8 branches'
    """
    if not len(chain_to(checked_kind("robot", robot, Robot)).columns):
        raise ModelError(
            f"no joint of {robot.name!r} carries the tool {robot.tool!r}: choose another frame as the tool"
        )
    pose = checked_array("T_world_tool", T_world_tool, (4, 4))
    allowed = checked_number("tolerance", tolerance, at_least=0.0)
    target = checked_poses("T_world_tool", pose[None], tolerance=allowed)
    near = None if q_near is None else checked_array("q_near", q_near, (robot.n_joints,))
    count, conditions = checked_whole("starts", starts, at_least=1, at_most=_MOST_STARTS), checked_conditions(constrain)
    draws = checked_rng(rng)
    form = closed_form(robot) if all(conditions) else None
    if form is not None:
        found = solve_branches(robot, form, target, None if near is None else near[None])
        if found.exists.any():
            return _closed(robot, form, found)
        if isinstance(form, PumaGeometry):
            raise _out_of_reach(robot, form, target, found, near)
    return _numeric(robot, target, near, count, draws, conditions)


def inverse_kinematics_batch(
    robot: Robot, T_world_tool: ArrayLike, *, tolerance: float = RIGIDITY, q_near: ArrayLike | None = None
) -> IkBatch:
    """Find all branches for many poses at once, as `inverse_kinematics` does for one, of an arm with a closed form.

    Parameters
    ----------
    robot : Robot
    T_world_tool : array_like, shape (n, 4, 4)
        Poses of the robot's tool, lengths in m.
    tolerance : float
        How far ``R^T R`` may be from the identity: the nearest rotation is taken then.
    q_near : array_like, shape (n_joints,) or (n, n_joints), optional
        Turns, and a joint of the wrist where a pose leaves it free, are chosen near it.

    Returns
    -------
    IkBatch
        A pose out of reach is no error here: it is marked.

    Raises
    ------
    InputError
        For a pose that is not a rigid transform to the tolerance; the message has its index.
    ModelError
        For an arm without a closed form.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> poses = ps.forward_kinematics(robot, [[0, 0.5, -2.5, 0, 0.7, 0], [1, 0, 0, 0, 0.5, 0]])
    >>> ps.inverse_kinematics_batch(robot, poses).q.shape
    (2, 8, 6)
    """
    checked_kind("robot", robot, Robot)
    form = closed_form(robot)
    if form is None:
        raise ModelError(
            f"robot {robot.name!r} has neither a spherical wrist nor three parallel axes, so that there is no closed"
            " form: call inverse_kinematics for each pose"
        )
    target = checked_poses("T_world_tool", T_world_tool, tolerance=checked_number("tolerance", tolerance, at_least=0.0))
    near = None if q_near is None else checked_joint_values(robot, "q_near", q_near)
    if near is not None and len(near) not in (1, target.shape[2]):
        raise InputError(f"q_near: {len(near)} rows for {target.shape[2]} poses; give one row, or one each")
    found = solve_in_blocks(robot, form, target, near)
    for array in (found.q, found.distance, found.singular, found.residual, found.exists, found.is_complete):
        array.setflags(write=False)
    return IkBatch(
        q=found.q,
        configurations=configurations(form),
        reachable=np.asarray(found.exists.any(axis=1)),
        out_of_reach=found.distance,
        within_limits=within(robot, found.q),
        singular=found.singular,
        residual=found.residual,
        exists=found.exists,
        is_complete=found.is_complete,
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


def _closed(robot: Robot, form: ClosedForm, found: Branches) -> IkSolutions:
    """The branches that exist for one pose."""
    exists = found.exists[0]
    q = found.q[0, exists]
    return IkSolutions(
        q=read_only(q),
        configurations=tuple(name for name, there in zip(configurations(form), exists, strict=True) if there),
        within_limits=within(robot, q),
        singular=tuple(
            tuple(name for name, at in zip(SINGULARITIES, row, strict=True) if at) for row in found.singular[0, exists]
        ),
        residual=read_only(found.residual[0, exists]),
        is_complete=bool(found.is_complete[0]),
        starts=0,
    )


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


def _numeric(
    robot: Robot, target: Array, near: Array | None, starts: int, rng: np.random.Generator, conditions: Conditions
) -> IkSolutions:
    """The distinct answers of damped least squares, those within the limits first."""
    q, errors, tried = solve_from_starts(robot, target, near, starts=starts, rng=rng, conditions=conditions)
    if not is_solved(errors).any():
        raise _not_found(robot, target, q, errors, conditions)
    order = np.argsort(~within(robot, q), kind="stable")
    q, errors = q[order], errors[order]
    if all(conditions):
        errors = (end_frame(chain_to(robot), q.T) - target).reshape(12, -1).T
    return IkSolutions(
        q=read_only(q),
        configurations=tuple(f"solution-{k + 1}" for k in range(len(q))),
        within_limits=within(robot, q),
        singular=tuple(("jacobian",) if at else () for at in is_singular(robot, target, q, conditions)),
        residual=read_only(np.abs(errors).max(axis=1)),
        is_complete=False,
        starts=tried,
    )


def _not_found(robot: Robot, target: Array, q: Array, errors: Array, conditions: Conditions) -> NoSolution:
    """The error for a pose that no start led to, with the nearest joint positions."""
    best = int(np.argmin(np.linalg.norm(errors, axis=1)))
    left = end_errors(chain_to(robot), target, q[best : best + 1])[0]
    where = "T_world_tool" if all(conditions) else f"the {told(conditions)} of T_world_tool"
    parts = [f"no joint positions found for {where} in {len(q)} attempts"]
    joints, asked = len(chain_to(robot).driving), sum(conditions)
    if joints < asked:
        fitting = [f"constrain={name!r}" for name, some in CONDITIONS.items() if sum(some) <= joints]
        parts.append(
            f"{joints} joints cannot meet {asked} conditions but by chance: give fewer"
            f" ({', '.join([*fitting, 'or six truth values'])}; in a task, position alone or with axis)"
        )
    parts.append(_left(q[best], left))
    position, angle = np.linalg.norm(left.reshape(2, 3), axis=1)
    residual = max(position, angle) if all(conditions) else np.abs(errors[best]).max()
    return NoSolution("; ".join(parts), residual=float(residual), q=read_only(q[best]))


def _left(q: Array, errors: Array) -> str:
    """The nearest q and what it leaves over, in words."""
    position, angle = np.linalg.norm(errors.reshape(2, 3), axis=1)
    return f"the nearest q = {np.round(q, 6).tolist()} leaves {position:.6g} m and {round(float(angle), 9):z.3g} rad"


def _counted(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"
