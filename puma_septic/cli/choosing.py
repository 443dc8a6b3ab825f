"""What `compare`, `optimise` and `profiles` take. Standard library alone, so that ``--help`` answers at once."""

from __future__ import annotations

from argparse import ArgumentParser

__all__ = ["COMPARE", "OPTIMISE", "PROFILES", "add_compare", "add_optimise", "add_profiles"]

COMPARE = """Compare all suitable profiles on the points and times of a task (the paper's by default).

Each is assessed exactly; Pareto-optimal profiles in the named objectives are marked. Exit code: 0 compared,
2 bad input."""

OPTIMISE = """Choose the via times of a task (the paper's by default) for its total time.

Minimises one objective, or computes the Pareto front of two or three. The objective 'duration' chooses the total time
as well: the least within all known limits of the robot, or within those named by --respect. What is found is assessed
in full, and limits that are not held are named. Exit code: 0 every motion shown keeps all known limits, 1 one of them
violates a limit, 2 bad input or no motion keeps the limits to respect."""

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
        help="mark the Pareto-optimal profiles in these objectives (repeatable; default: integral_of_squared_jerk,"
        " overshoot, via_miss)",
    )
    parser.add_argument("--dwell", type=float, metavar="S", help="rest after the motion, included in RMS values")
    parser.add_argument("--format", choices=("text", "json", "csv"), default="text", help="output format")
    parser.add_argument(
        "--out", metavar="DIR", help="write JSON, CSV and a figure into a new folder; nothing is overwritten"
    )


def add_optimise(parser: ArgumentParser) -> None:
    """Beside the task: what is to be chosen, for what, within what."""
    parser.add_argument(
        "--profile", action="append", metavar="NAME", help="use this profile instead of the task's first"
    )
    parser.add_argument(
        "--objective",
        action="append",
        metavar="NAME",
        help="objective to minimise (default: integral_of_squared_jerk); two or three for a Pareto front, 'duration'"
        " for the least time",
    )
    parser.add_argument(
        "--free",
        action="append",
        default=[],
        metavar="NAME",
        help="optimise these parameters of the profile too: velocities, accelerations (at the vias), free_knots"
        " (repeatable)",
    )
    parser.add_argument(
        "--max-overshoot",
        type=float,
        metavar="RAD",
        help="maximum excess of any joint beyond the points (m if prismatic)",
    )
    parser.add_argument(
        "--respect",
        action="append",
        default=[],
        metavar="QUANTITY",
        help="robot limits that the motion must keep: position, velocity, acceleration, jerk, effort (repeatable;"
        " default: none, for 'duration' all that are known)",
    )
    parser.add_argument("--dwell", type=float, metavar="S", help="rest after the motion, included in RMS values")
    parser.add_argument("--restarts", type=int, default=4, metavar="N", help="random restarts (default: 4)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="random seed (default: 0)")
    parser.add_argument("--size", type=int, default=12, metavar="N", help="number of Pareto-front points (default: 12)")
    parser.add_argument("--format", choices=("text", "json"), default="text", help="output format")
    parser.add_argument("--out", metavar="DIR", help="write JSON and figures into a new folder; nothing is overwritten")


def add_profiles(parser: ArgumentParser) -> None:
    """Only the form."""
    parser.add_argument(
        "--normalised", action="store_true", help="also the coefficients of one unit of movement in one unit of time"
    )
    parser.add_argument("--format", choices=("text", "json"), default="text", help="output format")
