"""The file that ``--write`` names: a motion as a ROS JointTrajectory."""

from __future__ import annotations

import os
from argparse import Namespace

from puma_septic.errors import InputError
from puma_septic.robot import Robot
from puma_septic.ros import write_joint_trajectory
from puma_septic.trajectory import Trajectory

__all__ = ["check_place", "write_motion"]


def check_place(arguments: Namespace) -> None:
    """Refuse a file that exists before anything is computed, unless it may be replaced."""
    if arguments.write is not None and os.path.lexists(arguments.write) and not arguments.force:
        raise InputError(f"{arguments.write} exists; name another file, or --force replaces it")


def write_motion(arguments: Namespace, trajectory: Trajectory, robot: Robot) -> None:
    """Write it, in place of a file that may be replaced."""
    check_place(arguments)
    write_joint_trajectory(arguments.write, trajectory, joint_names=robot.joint_names, overwrite=arguments.force)
