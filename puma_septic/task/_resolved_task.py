"""From a Task to joint positions, trajectories and assessments."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from puma_septic import profiles
from puma_septic.assessment import Assessment, assess
from puma_septic.document import card, one_line
from puma_septic.errors import InputError
from puma_septic.paths import ToolLimits
from puma_septic.robot import Robot
from puma_septic.task._branches import Branch, Posed, are_all_branches, best_branch, branches_through
from puma_septic.task._scene import named, solve_points, tool_limits
from puma_septic.task._schema import Task
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, read_only

__all__ = ["ResolvedTask", "assess_task", "resolve_task"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ResolvedTask:
    """A task with its robot loaded, its poses solved and its trajectories made; see `resolve_task`.

    Attributes
    ----------
    task : Task
    robot : Robot
        With the task's tool, limits, payload and wrench.
    names : tuple of str
        Of the points, as messages call them.
    branches : tuple of Branch
        All ways through the points that were found; one where no point is a pose.
    is_complete : bool
        Whether these are all: every branch of every pose is among them.
    extent : str
        How many solutions the first pose has, of how many: "5 solutions found from 44 starts"; empty without poses.
    branch : Branch
        The way that is taken.
    times : ndarray, shape (k,)
        s
    trajectories : tuple of Trajectory
        One for each profile of the task.
    tool_limits : ToolLimits or None
        What the task allows its tool to do.
    """

    task: Task
    robot: Robot
    names: tuple[str, ...]
    branches: tuple[Branch, ...]
    is_complete: bool
    extent: str
    branch: Branch
    times: Array
    trajectories: tuple[Trajectory, ...]
    tool_limits: ToolLimits | None

    def __post_init__(self) -> None:
        object.__setattr__(self, "times", read_only(self.times))

    @property
    def points(self) -> Array:
        """Joint positions at the points, shape (k, n_joints), rad (m)."""
        return self.branch.q

    @property
    def has_poses(self) -> bool:
        """Whether any point is a pose, so that there was a branch to choose."""
        return any(point.is_posed for point in self.task.points)

    @property
    def broken_in_all_branches(self) -> tuple[tuple[str, str], ...]:
        """Joint and point of each position limit that every one of `branches` breaks."""
        always = np.all([branch.excess > 0 for branch in self.branches], axis=0)
        return tuple((self.robot.joint_names[j], self.names[k]) for j, k in np.argwhere(always.T))

    @property
    def lowest(self) -> str:
        """A remark where the arm is below its base, or below the task's floor, at a point; else empty.

        Without poses and without a floor nobody asked.
        """
        floor = self.task.floor
        if (floor is None and not self.has_poses) or not (depth := self.branch.depth(floor or 0.0)):
            return ""
        k = int(np.argmin(self.branch.lowest.height))
        ground = "its base" if floor is None else f"the floor at {floor:g} m"
        others = any(not branch.depth(floor or 0.0) for branch in self.branches)
        remedy = " (floor in the task ranks such branches last)" if floor is None and others else ""
        alone = "" if others or floor is None else "; so it is in every other branch"
        part = self.branch.lowest.parts[k]
        return f"At {self.names[k]!r} {part} is {depth:.3g} m below {ground}{alone}{remedy}."

    def __repr__(self) -> str:
        return one_line("ResolvedTask", self._facts())

    def _repr_html_(self) -> str:
        return card("ResolvedTask", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "task": self.task.name,
            "robot": self.robot.name,
            "points": ", ".join(self.names),
            "branch": self.branch.configuration,
            "profiles": ", ".join(one.profile for one in self.trajectories),
        }


def resolve_task(task: Task, *, robot: Robot | None = None) -> ResolvedTask:
    """Load the robot, solve the poses, choose the branch and make the trajectories.

    Parameters
    ----------
    task : Task
    robot : Robot, optional
        As a task with the same robot, payload, wrench and limits gave it: it is not loaded again.

    Returns
    -------
    ResolvedTask

    Raises
    ------
    InputError
        Naming file and field: an unknown robot, set, frame, branch or joint, a number of points that a
        profile cannot take, and so on.
    NoSolution
        For a pose out of reach, naming the point, with the residual and the nearest joint positions.
    ModelError
        For a robot description that cannot be used.

    Examples
    --------
    >>> from puma_septic.task import load_task
    >>> resolved = resolve_task(load_task("paper"))
    >>> resolved.branch.configuration, resolved.broken_in_all_branches
    ('right-down-flip', (('joint5', 'take'), ('joint5', 'place')))
    """
    if not isinstance(task, Task):
        raise InputError(f"expected a task from load_task, got {task!r}")
    if task.cycle:
        raise InputError(
            f"{task.origin}: a cycle, which assess, size and replay take (in Python resolve_cycle); this needs points"
            " with times and profiles"
        )
    robot, waypoints = solve_points(task, robot)
    names = tuple(point.name or f"points[{k}]" for k, point in enumerate(task.points))
    branches = branches_through(robot, waypoints)
    with named(task, "branch"):
        branch = best_branch(branches, task.branch, task.floor)
    times = np.array(task.times if task.times is not None else [0.0, *np.cumsum(task.durations or ())])
    trajectories = []
    for k, choice in enumerate(task.profiles):
        with named(task, f"profiles[{k}] ({choice.name})"):
            made = profiles.make(choice.name, branch.q, times, options=choice.options, joint_names=robot.joint_names)
            trajectories.append(made.resting(before=task.rest_before, after=task.rest_after))
    return ResolvedTask(
        task=task,
        robot=robot,
        names=names,
        branches=branches,
        is_complete=are_all_branches(waypoints),
        extent=next((point.solutions.extent for point in waypoints if isinstance(point, Posed)), ""),
        branch=branch,
        times=times,
        trajectories=tuple(trajectories),
        tool_limits=tool_limits(task),
    )


def assess_task(task: Task | ResolvedTask) -> tuple[Assessment, ...]:
    """Assess each profile of a task, in the task's order.

    Returns
    -------
    tuple[Assessment, ...]

    Examples
    --------
    >>> from puma_septic.task import load_task
    >>> [assessment.is_feasible for assessment in assess_task(load_task("paper"))]
    [False, False, False]
    """
    resolved = task if isinstance(task, ResolvedTask) else resolve_task(task)
    return tuple(
        assess(
            resolved.robot,
            trajectory,
            dwell=resolved.task.dwell,
            floor=resolved.task.floor,
            tool_limits=resolved.tool_limits,
        )
        for trajectory in resolved.trajectories
    )
