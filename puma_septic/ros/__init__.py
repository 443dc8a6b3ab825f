"""Motions planned with ROS become trajectories, and trajectories become messages."""

from puma_septic.ros._faults import FAULT_CODES, Fault, JointTrajectoryError
from puma_septic.ros._interpolation import interpolated
from puma_septic.ros._logs import JointStateLog, read_joint_state_log
from puma_septic.ros._message import JointState, JointTrajectoryMessage
from puma_septic.ros._reading import (
    PlannedTrajectory,
    is_bag,
    read_joint_state,
    read_joint_trajectories,
    read_joint_trajectory,
    recorded_topics,
)
from puma_septic.ros._writing import write_joint_trajectory, write_message

__all__ = [
    "FAULT_CODES",
    "Fault",
    "JointState",
    "JointStateLog",
    "JointTrajectoryError",
    "JointTrajectoryMessage",
    "PlannedTrajectory",
    "interpolated",
    "is_bag",
    "read_joint_state",
    "read_joint_state_log",
    "read_joint_trajectories",
    "read_joint_trajectory",
    "recorded_topics",
    "write_joint_trajectory",
    "write_message",
]
