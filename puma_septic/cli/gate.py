"""What ``check`` takes. Standard library alone, so that ``--help`` answers at once."""

from __future__ import annotations

from argparse import ArgumentParser
from typing import Final

__all__ = ["CHECK", "add_check"]

CHECK: Final = """May these planned trajectories go to the robot? Fails closed: what is not known is not ok.

FILE holds a ROS trajectory_msgs/JointTrajectory as YAML or JSON (a plan of MoveIt or an action's goal included),
or is a rosbag2 folder or MCAP file. Between its points the motion is the one that joint_trajectory_controller
makes, held against every limit at every instant.

Exit code: 0 ok; 1 a limit is violated; 2 bad input; 3 it cannot be decided, as a limit is not known; of several
files the one of the worst, in the order 2, 1, 3, 0."""


def add_check(parser: ArgumentParser) -> None:
    """Arguments beside those that name the robot."""
    parser.add_argument("files", nargs="+", metavar="FILE", help="what to check, all trajectories in each")
    parser.add_argument(
        "--start",
        metavar="STATE",
        help="where the arm stands: a file with a JointState (YAML, JSON), or positions in the robot's order,"
        " with commas, rad (m)",
    )
    parser.add_argument(
        "--start-tolerance", type=float, metavar="RAD", help="how far from there a joint may start (0.01 by default)"
    )
    parser.add_argument(
        "--allow",
        action="append",
        default=[],
        metavar="REASON",
        help="a reason that is told but does not count, such as limit_unknown:jerk, drive_unknown,"
        " unbounded_acceleration or moving_end (repeatable)",
    )
    parser.add_argument("--topic", metavar="NAME", help="of a recording: JointTrajectory, or JointState as a log")
    parser.add_argument("--format", choices=("text", "json"), default="text", help="of what is printed")
    parser.add_argument(
        "--fix",
        metavar="FILE",
        help="write the least uniform stretch of time that holds (.yaml, .json); nothing is overwritten",
    )
    parser.add_argument(
        "--effort", action="store_true", help="with --fix: fill the efforts, which many controllers reject"
    )
