"""What `compare`, `optimise` and `profiles` take. Standard library alone, so that ``--help`` answers at once."""

from __future__ import annotations

from argparse import ArgumentParser

__all__ = ["COMPARE", "OPTIMISE", "PROFILES", "add_compare", "add_optimise", "add_profiles"]

COMPARE = """Compare all suitable profiles on the points and times of a task (the paper's by default).

Each is measured exactly; those that no other beats in the named objectives are marked. Exit code: 0 compared,
2 bad input."""

OPTIMISE = """Choose the via times of a task (the paper's by default) for its total time.

One objective is made least; two or three are traded against each other, and the motions of which none beats another are
listed. The objective 'duration' asks for the least total time under the robot's limits of velocity, acceleration and
jerk. Exit code: 0 done, 2 bad input or no motion keeps the constraints."""

PROFILES = """List the profiles: what each needs, how smooth it is, what it does at the vias."""


def add_compare(parser: ArgumentParser) -> None:
    """Beside the task: which profiles, by which objectives, in which form."""
    parser.add_argument(
        "--profile", action="append", dest="compared", metavar="NAME", help="only this profile (repeatable)"
    )
    parser.add_argument(
        "--objective",
        action="append",
        metavar="NAME",
        help="mark those that none beats in these (repeatable; by default integral_of_squared_jerk, overshoot,"
        " via_miss)",
    )
    parser.add_argument("--dwell", type=float, metavar="S", help="rest after the motion, in the RMS values")
    parser.add_argument("--format", choices=("text", "json", "csv"), default="text", help="of what is printed")
    parser.add_argument(
        "--out", metavar="DIR", help="write JSON, CSV and a figure into a new folder; nothing is overwritten"
    )


def add_optimise(parser: ArgumentParser) -> None:
    """Beside the task: what is to be chosen, for what, within what."""
    parser.add_argument(
        "--profile", action="append", metavar="NAME", help="this profile instead of the task's first (once)"
    )
    parser.add_argument(
        "--objective",
        action="append",
        metavar="NAME",
        help="what is to be least (integral_of_squared_jerk by default); two or three for a front, 'duration' for the"
        " least time",
    )
    parser.add_argument(
        "--free",
        action="append",
        default=[],
        metavar="NAME",
        help="chosen as well, where the profile has them: velocities, accelerations (at the vias), free_knots"
        " (repeatable)",
    )
    parser.add_argument(
        "--max-overshoot", type=float, metavar="RAD", help="largest excess of any joint beyond the points"
    )
    parser.add_argument(
        "--keep",
        action="append",
        default=[],
        metavar="QUANTITY",
        help="limits of the robot to keep: position, velocity, acceleration, jerk, effort (repeatable)",
    )
    parser.add_argument("--dwell", type=float, metavar="S", help="rest after the motion, in the RMS values")
    parser.add_argument("--restarts", type=int, default=4, metavar="N", help="searches from random times (4)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of those (0)")
    parser.add_argument("--size", type=int, default=12, metavar="N", help="motions on a front (12)")
    parser.add_argument("--format", choices=("text", "json"), default="text", help="of what is printed")
    parser.add_argument("--out", metavar="DIR", help="write JSON and figures into a new folder; nothing is overwritten")


def add_profiles(parser: ArgumentParser) -> None:
    """Only the form."""
    parser.add_argument(
        "--normalised", action="store_true", help="also the coefficients of one unit of movement in one unit of time"
    )
    parser.add_argument("--format", choices=("text", "json"), default="text", help="of what is printed")
