"""From a file to trajectories of a robot's joints."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.files import checked_path, decoded, read_bytes
from puma_septic.robot import Robot
from puma_septic.ros._faults import Fault, JointTrajectoryError
from puma_septic.ros._interpolation import in_robot_order, interpolated
from puma_septic.ros._message import (
    Found,
    JointState,
    JointTrajectoryMessage,
    found_messages,
    joint_state,
    joint_trajectory_message,
)
from puma_septic.ros._texts import MAX_YAML, documents_of, read_documents
from puma_septic.trajectory import Trajectory
from puma_septic.validation import checked_array, checked_whole

__all__ = [
    "PlannedTrajectory",
    "bags",
    "is_bag",
    "read_joint_state",
    "read_joint_trajectories",
    "read_joint_trajectory",
    "recorded_topics",
]

Start = JointState | Mapping[str, float] | ArrayLike


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PlannedTrajectory:
    """One JointTrajectory of a file, on a robot.

    Attributes
    ----------
    origin : str
        The file and the place in it.
    trajectory : Trajectory
        What joint_trajectory_controller makes of it.
    message : JointTrajectoryMessage
        Its points, joints in the robot's order.
    start : JointState or None
        Where the arm stands before it, joints in the robot's order: as given, else as the plan says.
    notes : tuple of str
        What has been taken for granted.
    sha256 : str
        Of the file's bytes, hexadecimal; of a bag, of all its files in order.
    """

    origin: str
    trajectory: Trajectory
    message: JointTrajectoryMessage
    start: JointState | None
    notes: tuple[str, ...]
    sha256: str


def read_joint_trajectory(
    path: str | PathLike[str], robot: Robot, *, start: Start | None = None, index: int | None = None
) -> Trajectory:
    """Read a ROS trajectory_msgs/JointTrajectory as the motion that joint_trajectory_controller makes of it.

    YAML (as ``ros2 topic echo`` prints it, several documents included), JSON, and with ``pip install
    "puma-septic[ros]"`` a rosbag2 folder or an MCAP file. The trajectory may lie in a plan of MoveIt
    (DisplayTrajectory, RobotTrajectory, ...) or in a goal of the action FollowJointTrajectory.

    Between two points the controller interpolates each joint with ``s = t/T``: by a straight line; by the cubic
    through positions and velocities where both points have velocities; by the quintic through accelerations too where
    both have those (ros2_controllers, trajectory.cpp). That is a piecewise polynomial, held exactly.

    Parameters
    ----------
    path : path_like
    robot : Robot
        Its joints are found by name, in any order; all must be there.
    start : JointState, mapping of joint to rad (m), or array_like of shape (n_joints,), optional
        Where the arm stands. Where the first point is later than 0, the motion begins there at t = 0, with the spline
        that the first point asks for. Without it (and without a state in the plan) the motion begins at the first
        point, at its time.
    index : int, optional
        Which trajectory, from 0, of a file with several.

    Returns
    -------
    Trajectory
        Joints in the robot's order, rad over s.

    Raises
    ------
    JointTrajectoryError
        An InputError with a list of faults, each with a stable code: for a file that cannot be read, joints that are
        missing or not the robot's, times that do not increase, points that the controller does not interpolate.
    InputError
        Where the file has several trajectories and `index` is not given, or out of range; for a start that does not
        fit the robot.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0], joint_names=robot.joint_names)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = ps.write_joint_trajectory(pathlib.Path(folder, "move.json"), move)
    ...     same = ps.read_joint_trajectory(path, robot)
    >>> round(float(same(1.0, order=1)[0]), 12)
    0.46875
    """
    planned = read_joint_trajectories(path, robot, start=start)
    if index is None and len(planned) > 1:
        raise InputError(f"{path}: {len(planned)} trajectories in it; index=0 to {len(planned) - 1} takes one of them")
    chosen = (
        0
        if index is None
        else checked_whole(f"index of a trajectory in {path}", index, at_least=0, at_most=len(planned) - 1)
    )
    return planned[chosen].trajectory


def read_joint_trajectories(
    path: str | PathLike[str], robot: Robot, *, start: Start | None = None, topic: str | None = None
) -> tuple[PlannedTrajectory, ...]:
    """Every JointTrajectory of a file, with what was taken for granted; see `read_joint_trajectory`.

    Parameters
    ----------
    topic : str, optional
        Of a bag; needed where several topics have trajectories.

    Returns
    -------
    tuple of PlannedTrajectory
        In the file's order, at least one.

    Raises
    ------
    JointTrajectoryError, InputError
        As `read_joint_trajectory`; any fault of one trajectory is a fault of the file.
    """
    given = None if start is None else _as_state(start, robot)
    faults: list[Fault] = []
    source = checked_path(path, "trajectory file")
    try:
        documents, digest = _documents(source, topic)
    except InputError as error:
        raise JointTrajectoryError(str(path), [_unreadable(str(error).removeprefix(f"{path}: "))]) from error
    found = [one for document in documents for one in found_messages(document, faults)]
    if not found and not faults:
        faults.append(Fault(code="no_trajectory", message="no JointTrajectory in it"))
    several = len(found) > 1
    planned = []
    for k, one in enumerate(found):
        own: list[Fault] = []
        made = _planned(one, robot, given if k == 0 else None, own)
        which = f"trajectory {k}" if several else ""
        faults += _placed(own, ", ".join(filter(None, [which, one.where])))
        if made is not None:
            origin = f"{path}, {which}" if several else str(path)
            planned.append(PlannedTrajectory(origin=origin, sha256=digest, **made))
    if faults:
        raise JointTrajectoryError(str(path), faults)
    return tuple(planned)


def read_joint_state(path: str | PathLike[str]) -> JointState:
    """Read a sensor_msgs/JointState, as ``ros2 topic echo --once /joint_states`` prints it; YAML or JSON.

    Returns
    -------
    JointState
        All joints of the file.

    Raises
    ------
    InputError
        For what cannot be read, or is no single JointState.
    """
    source = checked_path(path, "trajectory file")
    text = decoded(read_bytes(source, what="joint state file", at_most=MAX_YAML), source)
    documents = documents_of(text, str(source))
    if len(documents) != 1:
        raise InputError(f"{path}: one JointState is expected, it has {len(documents)} documents")
    return joint_state(documents[0], str(path))


def is_bag(path: Path) -> bool:
    """Whether a path names a recording: a folder of rosbag2, or an MCAP file.

    Returns
    -------
    bool
    """
    return os.path.isdir(path) or path.suffix == ".mcap"  # where Path raises, as for a name too long, it is none


def recorded_topics(path: str | PathLike[str]) -> dict[str, str]:
    """Message type of each topic of a recording, a rosbag2 folder or an MCAP file.

    Returns
    -------
    dict of str to str

    Raises
    ------
    InputError
        For a recording that cannot be read.
    """
    topics: dict[str, str] = bags().recorded_topics(Path(path))
    return topics


def bags() -> Any:
    """The module that reads bags, which needs a library that is not always there."""
    try:
        return import_module("puma_septic.ros._bags")
    except ModuleNotFoundError as error:
        if error.name != "rosbags":
            raise
        raise InputError('a bag is read with the package rosbags: pip install "puma-septic[ros]"') from error


def _unreadable(text: str) -> Fault:
    return Fault(code="unreadable", message=text)


def _documents(path: Path, topic: str | None) -> tuple[Sequence[Any], str]:
    if is_bag(path):
        module = bags()
        recording = module.read_recording(path, module.TRAJECTORY_TYPES, topic)
        return recording.messages, recording.sha256
    if topic is not None:
        raise InputError(f"{path}: topic {topic!r} is asked for, but only bags have topics")
    documents, data = read_documents(path)
    return documents, hashlib.sha256(data).hexdigest()


def _planned(found: Found, robot: Robot, given: JointState | None, faults: list[Fault]) -> dict[str, Any] | None:
    """The fields of a PlannedTrajectory but for its origin; None where it has faults, which are added."""
    raw = joint_trajectory_message(found.message, faults)
    if raw is None:
        return None
    message, notes = in_robot_order(raw, robot, faults)
    if faults:
        return None
    start, told = _start(found, robot, given)
    notes += told
    if message.nanoseconds[0] > 0 and start is None:
        notes += (
            f"no start state: the motion is taken to begin at the first point, at {message.times[0]:g} s; how the arm"
            " gets there is not assessed",
        )
    if len(message.times) == 1 and (start is None or message.nanoseconds[0] == 0):
        text = "a single point, and no state to come from: a start state, and a time later than 0, are needed"
        faults.append(Fault(code="start_unknown", message=text))
        return None
    trajectory = interpolated(message, start, robot.is_continuous)
    return {"trajectory": trajectory, "message": message, "start": start, "notes": notes}


def _placed(faults: Sequence[Fault], where: str) -> list[Fault]:
    if not where:
        return list(faults)
    return [Fault(code=one.code, message=f"{where}: {one.message}", joint=one.joint, time=one.time) for one in faults]


def _start(found: Found, robot: Robot, given: JointState | None) -> tuple[JointState | None, tuple[str, ...]]:
    """The start that is given, else the one that the plan says for all joints of the robot."""
    if given is not None or found.start is None:
        return given, ()
    try:
        state = _ordered(joint_state(found.start, found.where), robot)
    except InputError:  # MoveIt leaves it empty, or names some joints, where it means the current state
        return None, ("the plan has no start state for all joints of the robot",)
    return state, ("the start state is the one in the plan",)


def _as_state(start: Start, robot: Robot) -> JointState:
    """A start in the robot's order."""
    if isinstance(start, JointState):
        return _ordered(start, robot)
    if isinstance(start, Mapping):
        values = checked_array("start", list(start.values()), (len(start),), unit="rad")
        return _ordered(JointState(joint_names=tuple(start), position=values, velocity=np.zeros(len(start))), robot)
    position = checked_array("start", start, (robot.n_joints,), unit="rad")
    return JointState(joint_names=robot.joint_names, position=position, velocity=np.zeros(robot.n_joints))


def _ordered(state: JointState, robot: Robot) -> JointState:
    missing = [name for name in robot.joint_names if name not in state.joint_names]
    if missing:
        raise InputError(
            f"start: no position for joint {', '.join(map(repr, missing))}; it has {', '.join(state.joint_names)}"
        )
    order = [state.joint_names.index(name) for name in robot.joint_names]
    return JointState(joint_names=robot.joint_names, position=state.position[order], velocity=state.velocity[order])
