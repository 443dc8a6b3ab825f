"""``puma-septic accelerations``."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError, Namespace

from puma_septic.cli._arguments import add_payload, add_robot, asked_robot, finite, not_negative, share
from puma_septic.cli._output_arguments import add_format
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "acceleration limits that the torque limits allow, for MoveIt"

DESCRIPTION = """\
The largest joint accelerations that the torque limits allow at every pose of a joint box: guaranteed by a certified
bound, with the pose that governs, and what most poses allow.

Exit code: 0 some acceleration is guaranteed, 1 the arm cannot be held at every pose, 2 bad input."""

EXAMPLES = """accelerations arm.urdf --payload 5
accelerations arm.urdf --joint elbow=-1.5:1.5 --speed 0.5 --format moveit"""


def add_arguments(parser: ArgumentParser) -> None:
    """The robot, its load, where and how fast it moves."""
    add_robot(parser, is_positional=True)
    add_payload(parser)
    parser.add_argument(
        "--joint",
        action="append",
        type=_range,
        default=[],
        metavar="NAME=LOW:HIGH",
        help="positions of a joint that count, rad (m if prismatic; repeatable; default: its position limits)",
    )
    parser.add_argument(
        "--speed",
        type=share,
        default=0.0,
        metavar="SHARE",
        help="share of the velocity limits up to which all joints may move meanwhile (default: 0, at rest)",
    )
    parser.add_argument("--equal", action="store_true", help="the same acceleration for all joints")
    parser.add_argument(
        "--gap",
        type=not_negative,
        default=0.04,
        metavar="SHARE",
        help="how close the bound has to come (default: 0.04)",
    )
    add_format(parser, "text", "json", "csv", "moveit")


def run(arguments: Namespace) -> Answer:
    """Bound the accelerations; as text, JSON or MoveIt's joint_limits.yaml."""
    import numpy as np

    from puma_septic.document import records_csv, to_json
    from puma_septic.errors import InputError
    from puma_septic.robot import Payload, load_robot
    from puma_septic.worst_case import acceleration_limits

    robot = load_robot(**asked_robot(arguments, {"source": "puma560"}))
    speeds = arguments.speed * robot.limits.velocity if arguments.speed else np.zeros(robot.n_joints)
    if np.isnan(speeds).any():
        names = [name for name, speed in zip(robot.joint_names, speeds, strict=True) if np.isnan(speed)]
        raise InputError(f"--speed: no velocity limit for {', '.join(names)}")
    limits = acceleration_limits(
        robot,
        payload=None if arguments.payload is None else Payload(mass=arguments.payload),
        region=dict(arguments.joint),
        speeds=speeds,
        shares=dict.fromkeys(robot.joint_names, 1.0) if arguments.equal else None,
        gap=arguments.gap,
    )
    code = 0 if (limits.guaranteed > 0).all() else 1
    if arguments.format == "moveit":
        return Answer(limits.moveit_yaml(), code)
    if arguments.format == "csv":
        return Answer(records_csv(limits.to_dict()["joints"]), code)
    return Answer(to_json(limits.to_dict()) if arguments.format == "json" else str(limits), code)


def _range(text: str) -> tuple[str, tuple[float, float]]:
    joint, equals, bounds = text.rpartition("=")
    low, colon, high = bounds.partition(":")
    if not (joint and equals and colon):
        raise ArgumentTypeError(f"{text!r} is not NAME=LOW:HIGH")
    return joint, (finite(low), finite(high))
