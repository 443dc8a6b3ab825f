"""What a task is about: its robot, and where its points are."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from puma_septic.errors import InputError, ModelError, NoSolution
from puma_septic.kinematics import chain_to, forward_kinematics, inverse_kinematics
from puma_septic.paths import ToolLimits
from puma_septic.robot import Payload, Robot, Wrench, load_robot
from puma_septic.task._branches import Posed, Waypoint
from puma_septic.task._fields import PayloadSection
from puma_septic.task._schema import BodySection, Point, Task
from puma_septic.validation import Array, checked_array, checked_choice

__all__ = ["body", "named", "point_label", "solve_points", "tool_limits"]

_WORLD = "world"
# Joints that carry the tool of an arm that meets all conditions of a pose.
_FULL = 6


def solve_points(task: Task, robot: Robot | None = None) -> tuple[Robot, tuple[Waypoint, ...]]:
    """The task's robot, and each of its points: joint positions as given, a pose with all its solutions.

    Raises what `resolve_task` raises, but for branch and profiles.
    """
    robot = _robot(task) if robot is None else robot
    with named(task, "frame"):
        frame = _world_frame(robot, task.frame)
    return robot, tuple(_waypoint(robot, frame, task, k) for k in range(len(task.points)))


def tool_limits(task: Task) -> ToolLimits | None:
    """What the task allows its tool to do."""
    given = task.tool_limits
    return None if given is None else ToolLimits(**given.model_dump(exclude_none=True))


def _robot(task: Task) -> Robot:
    section = task.robot
    with named(task, "robot"):
        robot = load_robot(
            section.source,
            parameters=section.parameters,
            limits=section.limits,
            actuators=section.actuators,
            tool=section.tool,
            package_dirs=section.package_dirs,
            locked=section.locked,
            links={name: body(link) for name, link in section.links.items()},
            gravity=section.gravity,
        )
    if task.payload is not None:
        with named(task, "payload"):
            robot = robot.with_payload(body(task.payload))
    if task.wrench is not None:
        with named(task, "wrench"):
            pull = task.wrench
            robot = robot.with_wrench(Wrench(force=np.array(pull.force), torque=np.array(pull.torque), axes=pull.axes))
    if task.limits is not None:
        with named(task, "limits"):
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
    label = point_label(task, k)
    if point.joints is not None:
        with named(task, label):
            return _joint_positions(robot, point.joints, "joints")
    if point.joints_deg is not None:
        with named(task, label):
            given = _joint_positions(robot, point.joints_deg, "joints_deg")
            return np.where(robot.is_prismatic, given, np.radians(given))
    T_world_tool = frame @ _pose(point)
    with named(task, label):
        free = "which way the tool is turned" if point.axis is None else "how far the tool is turned about its axis"
        if point.constrain != "pose" and (joints := len(chain_to(robot).driving)) >= _FULL:
            raise InputError(
                f"needs rpy_deg or quaternion: {joints} joints carry the tool, and {free} would be left to chance"
            )
        solutions = inverse_kinematics(robot, T_world_tool, constrain=point.constrain)
        return Posed(T_world_tool=T_world_tool, solutions=solutions, constrain=point.constrain)


def point_label(task: Task, k: int) -> str:
    """How messages call point k."""
    name = task.points[k].name
    return f"points[{k}]" + (f" {name!r}" if name else "")


def _joint_positions(robot: Robot, given: tuple[float, ...] | dict[str, float], key: str) -> Array:
    """Joint positions, shape (n_joints,), given in the robot's order or by joint name."""
    if isinstance(given, dict):
        for name in given:
            checked_choice("joint", name, robot.joint_names)
        given = tuple(given[name] for name in robot.joint_names if name in given)
    if len(given) != robot.n_joints:
        raise InputError(
            f"{key}: {len(given)} numbers for {robot.n_joints} joints: {', '.join(robot.joint_names)}; give one for"
            " each, in this order or by name; locked='others' locks those that do not carry the tool"
        )
    return checked_array(key, given, (robot.n_joints,), unit="rad" if key == "joints" else "deg")


def body(section: BodySection | PayloadSection) -> Payload:
    """The rigid body that a section describes."""
    return Payload(mass=section.mass, com=np.array(section.com), inertia=np.array(section.inertia))


@contextmanager
def named(task: Task, field: str) -> Iterator[None]:
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
