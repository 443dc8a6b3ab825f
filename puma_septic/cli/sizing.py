"""Arguments of ``puma-septic size``. Standard library alone, so that ``--help`` answers at once."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError

__all__ = ["SIZE", "add_size"]

SIZE = """Hold motors and gearboxes against a duty cycle: the task's first profile, rest, the same way back empty, rest.

Without --catalogue the arm's own drives are assessed; with it, every pair of motor and gearbox at every joint.
Exit code: 0 every known limit is kept (or there is a pair for every joint), 1 one is broken, 2 bad input, 70 a fault of
the program."""


def add_size(parser: ArgumentParser) -> None:
    """What is sized, beside the task, its profile and its load."""
    parser.add_argument(
        "--drives",
        metavar="FILE",
        help="TOML file of what more is known of the arm's own drives; with --catalogue its drive tables alone",
    )
    parser.add_argument(
        "--catalogue",
        nargs="+",
        metavar="FILE",
        help="CSV files of motors, gearboxes and, if not all fit together, pairs; or 'example' (invented) or 'puma560'",
    )
    parser.add_argument(
        "--rank",
        choices=("mass", "cost", "margin"),
        help="with --catalogue: what the first pair has least (margin: most); mass by default",
    )
    parser.add_argument(
        "--keep", type=_count, metavar="N", help="with --catalogue: pairs that are shown per joint (3 by default)"
    )
    parser.add_argument(
        "--masses",
        choices=("before", "at"),
        help="with --catalogue: place drives on the link before their joint or the one that it moves, and choose again",
    )
    parser.add_argument(
        "--one-way", action="store_true", help="the task's motion alone: no return, no steady winding temperature"
    )
    parser.add_argument("--format", choices=("text", "json", "csv"), default="text", help="of what is printed")
    parser.add_argument(
        "--out", metavar="DIR", help="write JSON, CSV, motor load profiles and figures into a new folder"
    )


def _count(text: str) -> int:
    if not (text.isdecimal() and int(text) > 0):
        raise ArgumentTypeError(f"{text!r} is not a whole number from 1")
    return int(text)
