"""From a Task to joint positions, trajectories and assessments."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from puma_septic import profiles
from puma_septic.assessment import Assessment, assess
from puma_septic.errors import InputError, ModelError, NoSolution
from puma_septic.kinematics import chain_to, forward_kinematics, inverse_kinematics
from puma_septic.robot import Payload, Robot, Wrench, load_robot
from puma_septic.task._branches import Branch, Posed, Waypoint, are_all_branches, best_branch, branches_through
from puma_septic.task._schema import BodySection, Point, Task
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array, checked_choice, read_only

__all__ = ["ResolvedTask", "assess_task", "resolve_task", "solve_points"]

_WORLD = "world"
# Joints that carry the tool of an arm that meets all conditions of a pose.
_FULL = 6


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

    def __post_init__(self) -> None:
        object.__setattr__(self, "times", read_only(self.times))

    @property
    def points(self) -> Array:
        """Joint positions at the points, shape (k, n_joints), rad (m)."""
        return self.branch.q

    @property
    def has_poses(self) -> bool:
        """Whether any point is a pose, so that there was a branch to choose."""
        return any(point.joints is None for point in self.task.points)

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


def resolve_task(task: Task) -> ResolvedTask:
    """Load the robot, solve the poses, choose the branch and make the trajectories.

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
    robot, waypoints = solve_points(task)
    names = tuple(point.name or f"points[{k}]" for k, point in enumerate(task.points))
    branches = branches_through(robot, waypoints)
    with _named(task, "branch"):
        branch = best_branch(branches, task.branch, task.floor)
    times = np.array(task.times if task.times is not None else [0.0, *np.cumsum(task.durations or ())])
    trajectories = []
    for k, choice in enumerate(task.profiles):
        with _named(task, f"profiles[{k}] ({choice.name})"):
            made = profiles.make(choice.name, branch.q, times, options=choice.options, joint_names=robot.joint_names)
            before, after = made.rest_before and task.rest_before, made.rest_after and task.rest_after
            trajectories.append(replace(made, rest_before=before, rest_after=after))
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
    )


def solve_points(task: Task) -> tuple[Robot, tuple[Waypoint, ...]]:
    """The task's robot, and each of its points: joint positions as given, a pose with all its solutions.

    Raises what `resolve_task` raises, but for branch and profiles.
    """
    robot = _robot(task)
    with _named(task, "frame"):
        frame = _world_frame(robot, task.frame)
    return robot, tuple(_waypoint(robot, frame, task, k) for k in range(len(task.points)))


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
        assess(resolved.robot, trajectory, dwell=resolved.task.dwell, floor=resolved.task.floor)
        for trajectory in resolved.trajectories
    )


def _robot(task: Task) -> Robot:
    section = task.robot
    with _named(task, "robot"):
        robot = load_robot(
            section.source,
            parameters=section.parameters,
            limits=section.limits,
            actuators=section.actuators,
            tool=section.tool,
            package_dirs=section.package_dirs,
            locked=section.locked,
            links={name: _body(link) for name, link in section.links.items()},
            gravity=section.gravity,
        )
    if task.payload is not None:
        with _named(task, "payload"):
            load = task.payload
            robot = robot.with_payload(Payload(mass=load.mass, com=np.array(load.com), inertia=np.array(load.inertia)))
    if task.wrench is not None:
        with _named(task, "wrench"):
            pull = task.wrench
            robot = robot.with_wrench(Wrench(force=np.array(pull.force), torque=np.array(pull.torque), axes=pull.axes))
    if task.limits is not None:
        with _named(task, "limits"):
            robot = robot.with_limits(**task.limits.model_dump(exclude_none=True))
    return robot


def _world_frame(robot: Robot, name: str) -> Array:
    """Where a frame is that does not move with the arm, shape (4, 4); "world" is the URDF's root link.

    Raises
    ------
    InputError
        For an unknown frame, or one that moves, with those that do not.
    """
    frames = {frame.name: frame.parentJoint for frame in robot.model.frames if frame.name != "universe"}
    if name == _WORLD and name not in frames:  # a URDF may have a link of this name, which is then meant
        return np.eye(4)
    fixed = list(dict.fromkeys([_WORLD, *(frame for frame, parent in frames.items() if parent == 0)]))
    if name in frames and name not in fixed:
        raise InputError(f"{name!r} moves with the arm; poses can be given in: {', '.join(map(repr, fixed))}")
    checked_choice("frame", name, fixed)
    return forward_kinematics(robot, np.zeros(robot.n_joints), frame=name)


def _waypoint(robot: Robot, frame: Array, task: Task, k: int) -> Waypoint:
    """Point k: its joint positions, or its pose with all solutions."""
    point = task.points[k]
    label = f"points[{k}]" + (f" {point.name!r}" if point.name else "")
    if point.joints is not None:
        with _named(task, label):
            return _joint_positions(robot, point.joints)
    T_world_tool = frame @ _pose(point)
    with _named(task, label):
        free = "which way the tool is turned" if point.axis is None else "how far the tool is turned about its axis"
        if point.constrain != "pose" and (joints := len(chain_to(robot).driving)) >= _FULL:
            raise InputError(
                f"needs rpy_deg or quaternion: {joints} joints carry the tool, and {free} would be left to chance"
            )
        solutions = inverse_kinematics(robot, T_world_tool, constrain=point.constrain)
        return Posed(T_world_tool=T_world_tool, solutions=solutions, constrain=point.constrain)


def _joint_positions(robot: Robot, given: tuple[float, ...] | dict[str, float]) -> Array:
    """Joint positions, shape (n_joints,), given in the robot's order or by joint name."""
    if isinstance(given, dict):
        for name in given:
            checked_choice("joint", name, robot.joint_names)
        given = tuple(given[name] for name in robot.joint_names if name in given)
    if len(given) != robot.n_joints:
        raise InputError(
            f"joints: {len(given)} numbers for {robot.n_joints} joints: {', '.join(robot.joint_names)}; give one for"
            " each, in this order or by name; locked='others' locks those that do not carry the tool"
        )
    return checked_array("joints", given, (robot.n_joints,), unit="rad")


def _body(section: BodySection) -> Payload:
    return Payload(mass=section.mass, com=np.array(section.com), inertia=np.array(section.inertia))


@contextmanager
def _named(task: Task, field: str) -> Iterator[None]:
    """Put the file and the field before the message of what goes wrong inside."""
    where = f"{task.origin}: {field}: "
    try:
        yield
    except NoSolution as error:
        raise NoSolution(f"{where}{error}", residual=error.residual, q=error.q) from error
    except InputError as error:
        raise InputError(f"{where}{error}") from error
    except ModelError as error:
        raise ModelError(f"{where}{error}") from error


def _pose(point: Point) -> Array:
    """The point's pose in its frame, shape (4, 4)."""
    transform = np.eye(4)
    transform[:3, 3] = point.position or ()
    if point.rpy_deg is not None:
        transform[:3, :3] = _from_rpy(*np.deg2rad(point.rpy_deg))
    if point.axis is not None:
        transform[:3, :3] = _from_axis(np.array(point.axis))
    if point.quaternion is not None:
        turn = point.quaternion
        transform[:3, :3] = _from_quaternion(np.array([turn.w, turn.x, turn.y, turn.z]))
    return transform


def _from_axis(z: Array) -> Array:
    """Some rotation whose z axis this is."""
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    return np.column_stack((x, np.cross(z, x), z))


def _from_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """``Rz(yaw) Ry(pitch) Rx(roll)``: turns about fixed axes x, y, z, as in a URDF."""
    (cr, cp, cy), (sr, sp, sy) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    return np.array([
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ])  # fmt: skip


def _from_quaternion(quaternion: Array) -> Array:
    """Rotation of a quaternion (w, x, y, z), which is normalised."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
