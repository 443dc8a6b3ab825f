"""``puma-septic size``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from puma_septic.cli._arguments import (
    add_conditions,
    add_dwell,
    add_payload,
    add_profile,
    add_recording,
    add_task,
    count,
)
from puma_septic.cli._output_arguments import add_format, add_out, add_verbose
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "check or select motors and gearboxes for a duty cycle"

DESCRIPTION = """\
Check or select motors and gearboxes for a duty cycle: the task's own, or its first profile, rest, then back along the
same path unloaded, rest; or for the load cases that the task lists.

Without --catalogue the arm's own drives are checked; with it, every pair of motor and gearbox at every joint.
Exit code: 0 every known limit is kept (or there is a pair for every joint), 1 one is violated, 2 bad input, 3 nothing
can be decided because too little is known of the parts, 70 a fault of the program."""

EXAMPLES = """size paper-turned --payload 1 --dwell 0.5
size task.yaml --catalogue motors.csv gearboxes.csv --rank mass --out sizing
size task.yaml --catalogue motors.csv gearboxes.csv --cycles-per-minute 12 --bus-voltage 48 --margin 0.2"""


def add_arguments(parser: ArgumentParser) -> None:
    """The task, its load, the drives or the parts to choose from."""
    add_task(parser)
    add_profile(parser, "this profile instead of the task's first one")
    add_payload(parser)
    add_dwell(parser)
    parser.add_argument(
        "--drives",
        metavar="FILE",
        help="TOML file of additional data on the arm's own drives; with --catalogue its drive tables alone",
    )
    _add_choice(parser)
    parser.add_argument(
        "--one-way", action="store_true", help="the task's motion alone: no return, no steady winding temperature"
    )
    parser.add_argument(
        "--reserves",
        action="store_true",
        help="also the least cycle time and the largest payload of the drives (some seconds)",
    )
    add_conditions(parser)
    add_verbose(parser, "loads, checks and, with --catalogue, the best pairs; -vv: every check of those chosen")
    add_format(parser, "text", "json", "csv")
    add_out(parser, "report, JSON, CSV, load profiles and figures")
    add_recording(parser)


def _add_choice(parser: ArgumentParser) -> None:
    parser.add_argument(
        "--catalogue",
        nargs="+",
        metavar="FILE",
        help="CSV files of motors, gearboxes and, if not all fit together, pairs; or 'example' (invented) or 'puma560'",
    )
    parser.add_argument(
        "--rank",
        choices=("mass", "cost", "margin"),
        help="with --catalogue, the ranking criterion: lowest mass, lowest cost or highest margin (default: mass)",
    )
    parser.add_argument(
        "--keep", type=count, metavar="N", help="with --catalogue: number of pairs shown per joint (default: 3)"
    )
    parser.add_argument(
        "--masses",
        choices=("before", "at"),
        help="with --catalogue: place drives on the link before their joint or the one that it moves, and choose again"
        " (the same for revolute joints: the drive is on the joint's axis)",
    )
    parser.add_argument(
        "--front",
        action="store_true",
        help="with --catalogue: also the choices for the whole arm that no other beats in mass, cost and margin",
    )
    parser.add_argument(
        "--same",
        action="append",
        type=_names,
        metavar="JOINT,JOINT",
        help="with --catalogue: one size for these joints, where a pair fits all of them (repeatable)",
    )


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def run(arguments: Namespace) -> Answer:
    """Check the arm's own drives, or choose from a catalogue."""
    from puma_septic.cli._size_answer import answer

    return answer(arguments)
