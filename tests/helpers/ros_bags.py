"""Recordings made for tests: messages of ROS 2, written by the library that reads them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from rosbags import rosbag2
from rosbags.typesys import Stores, get_typestore

import puma_septic as ps
from helpers.ros_messages import NAMES

TYPES = get_typestore(Stores.ROS2_HUMBLE)


def make(kind: str, /, **fields: Any) -> Any:
    return TYPES.types[kind](**fields)


def header(stamp: int) -> Any:
    time = make("builtin_interfaces/msg/Time", sec=stamp // 10**9, nanosec=stamp % 10**9)
    return make("std_msgs/msg/Header", stamp=time, frame_id="")


def trajectory_message(move: ps.Trajectory, times: list[float]) -> Any:
    points = [
        make(
            "trajectory_msgs/msg/JointTrajectoryPoint",
            positions=move(t),
            velocities=move(t, 1),
            accelerations=move(t, 2),
            effort=np.zeros(0),
            time_from_start=make("builtin_interfaces/msg/Duration", sec=int(t), nanosec=round(t % 1 * 1e9)),
        )
        for t in times
    ]
    return make("trajectory_msgs/msg/JointTrajectory", header=header(0), joint_names=list(NAMES), points=points)


def state_message(names: tuple[str, ...], position: Any, stamp: int) -> Any:
    return make(
        "sensor_msgs/msg/JointState",
        header=header(stamp),
        name=list(names),
        position=np.array(position, dtype=np.float64),
        velocity=np.zeros(0),
        effort=np.zeros(0),
    )


def record(folder: Path, storage: str, topics: dict[str, list[tuple[int, Any]]]) -> Path:
    """A rosbag2 folder with messages (nanoseconds, message) by topic; of MCAP its one file."""
    plugin = rosbag2.StoragePlugin[storage.upper()]
    with rosbag2.Writer(folder, version=9, storage_plugin=plugin) as writer:
        for topic, messages in topics.items():
            kind = messages[0][1].__msgtype__
            connection = writer.add_connection(topic, kind, typestore=TYPES)
            for time, message in messages:
                writer.write(connection, time, TYPES.serialize_cdr(message, kind))
    return folder


def states(move: ps.Trajectory, rate: int) -> list[tuple[int, Any]]:
    times = np.arange(0, 2 * rate + 1) * (10**9 // rate)
    return [(int(t) + 5_000, state_message(NAMES[::-1], move(t / 1e9)[::-1], int(t) + 10**18)) for t in times]
