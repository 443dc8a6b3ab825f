"""Joint states of a recording as a log: times and positions."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Final, final

import numpy as np

from puma_septic.errors import InputError
from puma_septic.robot import Robot
from puma_septic.ros._message import joint_state
from puma_septic.ros._reading import bags
from puma_septic.validation import Array

__all__ = ["JointStateLog", "read_joint_state_log"]

_NS: Final = 10**9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class JointStateLog:
    """What a robot's joints did, as a recording has it.

    Attributes
    ----------
    t : ndarray, shape (n,)
        s from the first message, by the messages' stamps; by the time of recording where they have none.
    q : ndarray, shape (n, n_joints)
        rad (m), in the robot's order.
    notes : tuple of str
        What was left out.
    sha256 : str
        Of the recording.
    """

    t: Array
    q: Array
    notes: tuple[str, ...]
    sha256: str


def read_joint_state_log(path: str | PathLike[str], robot: Robot, *, topic: str | None = None) -> JointStateLog:
    """Positions of a robot's joints over time, from the sensor_msgs/JointState of a rosbag2 folder or MCAP file.

    `fit_trajectory` makes a motion of them. Messages that do not have all joints of the robot, as a gripper's own,
    are left out and counted in the notes.

    Returns
    -------
    JointStateLog

    Raises
    ------
    InputError
        For a recording that cannot be read, where not exactly one topic fits and none is named, fewer than two
        messages with all joints, and stamps that do not increase.
    """
    module = bags()
    recording = module.read_recording(Path(path), (module.JOINT_STATE,), topic)
    stamps, rows = [], []
    for time, message in zip(recording.nanoseconds, recording.messages, strict=True):
        if set(robot.joint_names) <= set(message["name"]):
            state = joint_state(message, f"{path}, {recording.topic}")
            order = [state.joint_names.index(name) for name in robot.joint_names]
            rows.append(state.position[order])
            stamps.append((_stamp(message), int(time)))
    if len(rows) < 2:
        raise InputError(
            f"{path}: {len(rows)} of {len(recording.messages)} messages on {recording.topic} have all joints of robot"
            f" {robot.name!r}, {', '.join(robot.joint_names)}; two are needed"
        )
    left_out = len(recording.messages) - len(rows)
    notes = [f"{left_out} messages without all joints are left out"] if left_out else []
    both = np.array(stamps, dtype=np.int64)
    by_recorder = bool((both[:, 0] == 0).any())
    if by_recorder:
        notes.append("messages without a stamp: the times are those of the recorder")
    clock = both[:, int(by_recorder)]
    t = (clock - clock[0]) / _NS
    steps = np.diff(clock)
    if (steps <= 0).any():
        k = int(np.argmax(steps <= 0))
        raise InputError(
            f"{path}, {recording.topic}: message {k + 2} is stamped {t[k + 1]:.9g} s after the first, message {k + 1}"
            f" {t[k]:.9g} s; times must increase strictly"
        )
    return JointStateLog(t=t, q=np.array(rows), notes=tuple(notes), sha256=recording.sha256)


def _stamp(message: dict[str, Any]) -> int:
    stamp = message["header"]["stamp"]
    return int(stamp["sec"]) * _NS + int(stamp["nanosec"])
