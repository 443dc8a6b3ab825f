"""What the command line takes. Standard library alone, so that ``--help`` answers at once."""

from __future__ import annotations

import math
import re
import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace, RawDescriptionHelpFormatter
from collections.abc import Sequence
from typing import NamedTuple, NoReturn

from puma_septic._version import __version__
from puma_septic.cli.choosing import COMPARE, OPTIMISE, PROFILES, add_compare, add_optimise, add_profiles
from puma_septic.cli.gate import CHECK, add_check
from puma_septic.cli.recording import add_recording
from puma_septic.cli.sizing import SIZE, add_size

__all__ = ["Answer", "parse"]


_NEGATIVE = re.compile(r"-[0-9.]+[eE][-+]?[0-9]+|-[0-9.].*,.*")


class Answer(NamedTuple):
    """What a command has to say, and the exit code."""

    text: str
    exit_code: int


class _Parser(ArgumentParser):
    """An argument parser that complains in one line."""

    def error(self, message: str) -> NoReturn:
        sys.stderr.write(f"{self.prog}: error: {message} ({self.prog} --help tells more)\n")
        sys.exit(2)


def parse(argv: Sequence[str] | None) -> Namespace:
    """Arguments of one command, its name in ``command``."""
    parser = _Parser(
        prog="puma-septic",
        description="Joint trajectories of robot arms, held against what the motors can do.",
        epilog="Exit code: 0 all shown profiles are feasible, 1 one of them violates a limit, 2 bad input, 3 undecided:"
        " the noise or the units of a recorded motion leave it open, 70 a fault of the program.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"puma-septic {__version__}")
    _add_debug(parser)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    _add_assess(_command(commands, "assess", "torque, jerk and limits of a task's profiles", _ASSESS))
    check = _command(commands, "check", "may a planned trajectory (ROS) go to the robot", CHECK)
    _add_robot(check, required=True)
    check.add_argument("--payload", type=_not_negative, metavar="KG", help="a point mass at the tool's origin")
    add_check(check)
    _add_ik(_command(commands, "ik", "branches of the inverse kinematics", _IK))
    _add_paper(_command(commands, "paper", "the paper's tables, figures and claims, reproduced and judged", _PAPER))
    _add_replay(_command(commands, "replay", "the arm in motion, in the browser or as one HTML file", _REPLAY))
    compare = _command(commands, "compare", "all suitable profiles on one task, measured exactly", COMPARE)
    optimise = _command(
        commands, "optimise", "via times chosen for one or more objectives, or the least time", OPTIMISE
    )
    add_recording(compare)
    for choosing, add in ((compare, add_compare), (optimise, add_optimise)):
        _add_task(choosing)
        add(choosing)
    add_profiles(_command(commands, "profiles", "what profiles there are", PROFILES))
    size = _command(commands, "size", "motors and gearboxes for a duty cycle: strong enough, or chosen", SIZE)
    _add_task(size)
    size.add_argument("--profile", action="append", metavar="NAME", help="this profile instead of the task's first one")
    size.add_argument("--payload", type=_not_negative, metavar="KG", help="a point mass at the tool's origin")
    size.add_argument("--dwell", type=_not_negative, metavar="S", help="rest after each motion")
    add_size(size)
    add_recording(size)
    # argparse takes -1e-3 (before Python 3.14) and -1,0 for options; after a space it is a value, and the same number.
    given = sys.argv[1:] if argv is None else argv
    return parser.parse_args([f" {text}" if _NEGATIVE.fullmatch(text) else text for text in given])


_ASSESS = """Assess the profiles of a task: what each joint does and needs, held against its limits.

Without TASK: the paper's pick-and-place with septic, LSPB and three-segment quintic side by side, why no
branch of the inverse kinematics keeps the limits, and then the same points with the tool turned, where
everything fits."""

_IK = """List the branches of the inverse kinematics for a pose, or for the poses of a task (the paper's by default).

Exit code: 0 each pose has a branch within the joint limits, 1 one has none, 2 bad input or out of reach."""

_PAPER = (
    """Reproduce the paper's tables, figures and computing times, and judge each of its claims by measured numbers."""
)

_REPLAY = """Show the profiles of a task as an arm that moves: the first one solid, further ones as ghosts.

Links are coloured by torque over limit, the tool's path by its speed; broken limits and singular postures are marked.
Without --html it is served to browsers on this machine until Ctrl-C. Exit code: 0 shown or written, 2 bad input."""


def _command(commands: object, name: str, summary: str, description: str) -> ArgumentParser:
    parser: ArgumentParser = commands.add_parser(  # type: ignore[attr-defined]
        name,
        help=summary,
        description=description,
        allow_abbrev=False,
        formatter_class=RawDescriptionHelpFormatter,
    )
    _add_debug(parser)
    return parser


def _add_debug(parser: ArgumentParser) -> None:
    """Before or after the command; `main` reads it from the arguments as they are, whatever becomes of them."""
    parser.add_argument("--debug", action="store_true", help="after an internal error: show the full traceback")


def _add_assess(parser: ArgumentParser) -> None:
    _add_task(parser)
    parser.add_argument(
        "--profile",
        action="append",
        metavar="NAME",
        help="only this profile, with the task's options if it has some (repeatable)",
    )
    parser.add_argument("--payload", type=_not_negative, metavar="KG", help="a point mass at the tool's origin")
    parser.add_argument("--dwell", type=_not_negative, metavar="S", help="rest after the motion, in the RMS values")
    parser.add_argument(
        "--margin",
        type=_share,
        default=0.0,
        metavar="SHARE",
        help="share of each velocity, acceleration, jerk and effort limit that must be left for exit code 0, 0 to 1",
    )
    parser.add_argument("--format", choices=("text", "json", "csv"), default="text", help="of what is printed")
    parser.add_argument(
        "--out",
        metavar="DIR",
        help="write report.html, JSON, CSV and SVG figures into a new folder; nothing is overwritten",
    )
    parser.add_argument(
        "--no-png", action="store_true", help="with --out: leave out the PNG figures, which take seconds"
    )
    add_recording(parser)


def _add_ik(parser: ArgumentParser) -> None:
    _add_task(parser)
    parser.add_argument(
        "--position", nargs=3, type=_finite, metavar=("X", "Y", "Z"), help="one pose of the tool instead, m"
    )
    parser.add_argument(
        "--rpy-deg",
        nargs=3,
        type=_finite,
        metavar=("R", "P", "Y"),
        help="its turns about the fixed axes x, y, z, in this order, degrees (0 0 0 by default)",
    )
    parser.add_argument(
        "--axis",
        nargs=3,
        type=_finite,
        metavar=("X", "Y", "Z"),
        help="where the tool's z axis points, instead of its turns: for arms with five axes",
    )
    parser.add_argument(
        "--position-only", action="store_true", help="any turn of the tool will do: for arms with fewer than six axes"
    )
    parser.add_argument("--frame", help="frame that it is given in, fixed to the world ('world' by default)")
    parser.add_argument("--format", choices=("text", "json"), default="text", help="of what is printed")


def _add_paper(parser: ArgumentParser) -> None:
    parser.add_argument("--format", choices=("text", "json"), default="text", help="of what is printed")
    parser.add_argument("--out", metavar="DIR", help="write JSON and figures into a new folder; nothing is overwritten")


def _add_replay(parser: ArgumentParser) -> None:
    _add_task(parser)
    parser.add_argument(
        "--profile",
        action="append",
        metavar="NAME",
        help="only this profile, with the task's options if it has some (repeatable; the first one is solid)",
    )
    parser.add_argument("--payload", type=_not_negative, metavar="KG", help="a point mass at the tool's origin")
    parser.add_argument("--html", metavar="FILE", help="write one HTML file, which works offline, instead of serving")
    parser.add_argument("--port", type=int, metavar="N", help="wanted; another is chosen where it is taken")
    parser.add_argument("--no-browser", action="store_true", help="print the address without opening a browser")
    add_recording(parser)


def _add_task(parser: ArgumentParser) -> None:
    """The task and what replaces parts of it, the same for every command that takes one."""
    parser.add_argument(
        "task",
        nargs="?",
        metavar="TASK",
        help="a task file (.yaml), or a built-in task such as 'paper' or 'paper-turned'",
    )
    _add_robot(parser)
    parser.add_argument("--branch", metavar="NAME", help="branch of the inverse kinematics, or 'auto'")


def _add_robot(parser: ArgumentParser, *, required: bool = False) -> None:
    """The robot and what it is made of."""
    which = "the robot" if required else "another robot"
    parser.add_argument("--robot", metavar="NAME", required=required, help=f"{which}: 'puma560' or a .urdf file")
    parser.add_argument("--actuators", metavar="FILE", help="its actuator file")
    parser.add_argument("--parameters", metavar="NAME", help="set of drive parameters, such as rtb or akb")
    parser.add_argument("--limits", metavar="NAME", help="set of limits, such as corke, akb or benchmark")
    parser.add_argument("--tool", metavar="FRAME", help="frame that is positioned and that carries the payload")
    parser.add_argument(
        "--lock",
        action="append",
        type=_locked,
        metavar="JOINT=RAD",
        help="fix a joint there, m if it slides (repeatable)",
    )


def _finite(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def _not_negative(text: str) -> float:
    value = _finite(text)
    if not value >= 0:
        raise ArgumentTypeError(f"{text} is negative")
    return value


def _positive(text: str) -> float:
    value = _finite(text)
    if not value > 0:
        raise ArgumentTypeError(f"{text} is not positive")
    return value


def _locked(text: str) -> tuple[str, float]:
    joint, equals, position = text.rpartition("=")
    if not (joint and equals):
        raise ArgumentTypeError(f"{text!r} is not JOINT=POSITION")
    return joint, _finite(position)


def _share(text: str) -> float:
    value = _finite(text)
    if not 0 <= value <= 1:
        raise ArgumentTypeError(f"{text} is not between 0 and 1")
    return value
