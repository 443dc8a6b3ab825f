"""``puma-septic robot``."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from typing import TYPE_CHECKING, Any

from puma_septic.cli._arguments import add_robot, asked_robot, finite
from puma_septic.cli._output_arguments import add_format, add_verbose
from puma_septic.cli._parser import Answer

if TYPE_CHECKING:
    from puma_septic.robot import Robot
    from puma_septic.validation import Array

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "joints, limits, frames, masses and drives of a robot, and where its tool is"

DESCRIPTION = """\
Show what a robot description has: joints with their types and limits, frames, masses, drives, the pose of the tool, and
what is doubtful or missing.

Exit code: 0 shown, 2 bad input."""

EXAMPLES = """robot ur5
robot panda --lock-others --at panda_joint2=-0.8 panda_joint4=-2.4
robot arm.urdf --package-dir ~/ws/src --format json
robot --list"""


def add_arguments(parser: ArgumentParser) -> None:
    """A robot and where its joints are."""
    add_robot(parser, is_positional=True)
    parser.add_argument(
        "--at",
        nargs="+",
        type=_position,
        metavar="JOINT=POSITION",
        help="where the joints are (rad; m if prismatic), all others at 0; or one number for each joint",
    )
    parser.add_argument("--list", action="store_true", help="list the robots that can be named")
    add_verbose(parser, "drives, frames and notes as well")
    add_format(parser, "text", "json", "csv")


def run(arguments: Namespace) -> Answer:
    """Show one robot, or the names of all."""
    from puma_septic.document import records_csv, to_json
    from puma_septic.robot import load_robot, named_robots
    from puma_septic.views.robot import short_text, text

    if arguments.list and arguments.format == "json":
        return Answer(to_json({name: str(path) for name, path in named_robots().items()}), 0)
    if arguments.list:
        return Answer("\n".join(f"{name:28s} {path}" for name, path in named_robots().items()), 0)
    section = asked_robot(arguments, {})
    robot = load_robot(section.pop("source", "puma560"), **section)
    document = robot.to_dict() | {"pose": _pose(robot, _positions(robot, arguments.at or []))}
    if arguments.format == "csv":
        return Answer(records_csv(document["joints"]), 0)
    if arguments.format == "json":
        return Answer(to_json(document), 0)
    return Answer(text(document) if arguments.verbose else short_text(document), 0)


def _positions(robot: Robot, given: list[tuple[str, float]]) -> Array:
    """Joint positions, shape (n_joints,), of names and numbers, or of numbers in the robot's order."""
    import numpy as np

    from puma_septic.errors import InputError

    q = np.zeros(robot.n_joints)
    bare = [value for name, value in given if not name]
    if bare and len(bare) != robot.n_joints:
        joints = ", ".join(robot.joint_names)
        raise InputError(f"--at: {len(bare)} numbers for {robot.n_joints} joints: {joints}; or give JOINT=POSITION")
    if bare:
        return np.array(bare)
    for name, value in given:
        q[robot.joint_index(name)] = value
    return q


def _pose(robot: Robot, q: Array) -> dict[str, Any]:
    """Where the tool is, JSON-ready."""
    import numpy as np
    import pinocchio as pin

    from puma_septic.document import plain
    from puma_septic.kinematics import forward_kinematics

    T = forward_kinematics(robot, q)
    return {
        "joints": dict(zip(robot.joint_names, plain(q), strict=True)),
        "T_world_tool": plain(T),
        "position": plain(T[:3, 3]),
        "rpy_deg": plain(np.degrees(pin.rpy.matrixToRpy(T[:3, :3]))),
    }


def _position(text: str) -> tuple[str, float]:
    joint, equals, position = text.strip().rpartition("=")
    if equals and not joint:
        raise ArgumentTypeError(f"{text!r} is not JOINT=POSITION")
    return joint, finite(position)
