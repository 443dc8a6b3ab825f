"""``puma-septic check``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from puma_septic.cli._arguments import add_payload, add_robot, finite, positive
from puma_septic.cli._output_arguments import add_format
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "whether a planned trajectory (ROS) may go to the robot"

DESCRIPTION = """\
May these planned trajectories go to the robot? Fails closed: what is not known is not ok.

FILE holds a ROS trajectory_msgs/JointTrajectory as YAML or JSON (a plan of MoveIt or an action's goal included),
or is a rosbag2 folder or MCAP file. Between its points the motion is the one that joint_trajectory_controller
makes, checked against every limit at every instant.

Exit code: 0 ok; 1 a limit is violated; 2 bad input; 3 it cannot be decided, as a limit is not known; of several
files the one of the worst, in the order 2, 1, 3, 0."""

EXAMPLES = """check plan.yaml --robot arm.urdf --actuators arm.toml
check plan.yaml --robot puma560 --start 0,0,0,0,0,0 --fix slower.yaml"""


def add_arguments(parser: ArgumentParser) -> None:
    """The robot, what it carries, the files and what counts."""
    add_robot(parser, required=True)
    add_payload(parser)
    parser.add_argument("files", nargs="+", metavar="FILE", help="files to check, all trajectories in each")
    parser.add_argument(
        "--start",
        metavar="STATE",
        help="where the arm stands: a file with a JointState (YAML, JSON), or positions in the robot's order,"
        " with commas, rad (m)",
    )
    parser.add_argument(
        "--start-tolerance",
        type=float,
        metavar="RAD",
        help="maximum distance of a joint from there at the start (default: 0.01)",
    )
    parser.add_argument(
        "--allow",
        action="append",
        default=[],
        metavar="REASON",
        help="a reason that is reported but does not count, such as limit_unknown:jerk, drive_unknown,"
        " unbounded_acceleration or moving_end (repeatable)",
    )
    parser.add_argument(
        "--floor", type=finite, metavar="M", help="height that no joint and not the tool may come below, from the base"
    )
    parser.add_argument(
        "--tool-speed",
        type=positive,
        metavar="M/S",
        help="maximum speed of the tool, such as 0.25 by hand (ISO 10218-1)",
    )
    parser.add_argument("--topic", metavar="NAME", help="topic of a recording: JointTrajectory, or JointState as a log")
    add_format(parser, "text", "json", "csv")
    parser.add_argument(
        "--fix",
        metavar="FILE",
        help="write the trajectory with the least uniform stretch of time that keeps the limits (.yaml, .json); nothing"
        " is overwritten",
    )
    parser.add_argument(
        "--effort", action="store_true", help="with --fix: fill the efforts, which many controllers reject"
    )


def run(arguments: Namespace) -> Answer:
    """Check every trajectory of every file; the exit code is that of the worst."""
    from puma_septic.cli._check_answer import answer

    return answer(arguments)
