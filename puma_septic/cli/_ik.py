"""``puma-septic ik``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from puma_septic.cli._arguments import add_task, finite
from puma_septic.cli._output_arguments import add_format, add_verbose
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "branches of the inverse kinematics"

DESCRIPTION = """\
List the branches of the inverse kinematics for a pose, or for the poses of a task (the paper's by default).

Exit code: 0 each pose has a branch within the joint limits, 1 one has none, 2 bad input or out of reach."""

EXAMPLES = """ik paper-turned
ik --position 0.4 0.1 0.3 --rpy-deg 0 180 0"""


def add_arguments(parser: ArgumentParser) -> None:
    """A task, or one pose."""
    add_task(parser)
    parser.add_argument(
        "--position", nargs=3, type=finite, metavar=("X", "Y", "Z"), help="one pose of the tool instead, m"
    )
    parser.add_argument(
        "--rpy-deg",
        nargs=3,
        type=finite,
        metavar=("R", "P", "Y"),
        help="its rotations about the fixed axes x, y, z, in this order, degrees (default: 0 0 0)",
    )
    parser.add_argument(
        "--axis",
        nargs=3,
        type=finite,
        metavar=("X", "Y", "Z"),
        help="direction of the tool's z axis, instead of its rotations: for arms with five axes",
    )
    parser.add_argument(
        "--position-only",
        action="store_true",
        help="any rotation of the tool will do: for arms with fewer than six axes",
    )
    parser.add_argument("--frame", help="frame that it is given in, fixed to the world (default: world)")
    parser.add_argument(
        "--sort",
        choices=("branch", "manipulability", "height"),
        default="branch",
        help="order of each pose's branches: by name, the most manipulable or the highest lowest point first (default:"
        " branch)",
    )
    add_verbose(parser, "of several poses: the joint positions of each branch")
    add_format(parser, "text", "json", "csv")


def run(arguments: Namespace) -> Answer:
    """List the branches for one pose, or for each pose of a task."""
    from puma_septic.cli._ik_answer import answer

    return answer(arguments)
