"""``puma-septic limits``."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError, Namespace

from puma_septic.cli._arguments import add_dwell, add_margin, add_payload, add_profile, add_task, finite
from puma_septic.cli._output_arguments import add_format, add_out
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "how fast, how heavy, and what stops it"

DESCRIPTION = """\
The least duration of a task's profiles with what the robot carries, the largest payload at their own duration, both
exact and each with the limit that stops it; and the payload over the duration.

Exit code: 0 each profile has a duration from which on every longer one is feasible, 1 one has none, 2 bad input,
3 undecided: the units of the points leave it open."""

EXAMPLES = """limits paper-turned --profile septic
limits task.yaml --com 0,0,0.1 --format csv
limits task.yaml --payload 2 --out how-fast
limits paper-turned --reference"""


def add_arguments(parser: ArgumentParser) -> None:
    """The task, its load, the form."""
    add_task(parser)
    add_profile(parser, "only this profile, with the task's options if it has some (repeatable)")
    add_payload(parser)
    add_dwell(parser)
    add_margin(parser)
    parser.add_argument(
        "--com",
        type=_place,
        metavar="X,Y,Z",
        help="centre of the payload that is asked for, m in the tool frame (default: the task's payload's, else 0,0,0)",
    )
    parser.add_argument(
        "--reference",
        action="store_true",
        help="beside each profile the time-optimal motion along its path, by toppra or copp-py, certified",
    )
    add_format(parser, "text", "json", "csv")
    add_out(parser, "report.html, JSON, CSV and a figure")


def run(arguments: Namespace) -> Answer:
    """How fast, how heavy."""
    from puma_septic.cli._limits_answer import answer

    return answer(arguments)


def _place(text: str) -> tuple[float, ...]:
    parts = text.split(",")
    if len(parts) != 3:
        raise ArgumentTypeError(f"{text!r} is not X,Y,Z")
    return tuple(finite(part) for part in parts)
