"""What commands take of motions that were recorded or planned elsewhere. Standard library alone."""

from __future__ import annotations

import math
from argparse import ArgumentParser, ArgumentTypeError

__all__ = ["RECORDING", "add_recording"]

# Options that mean nothing without --csv.
RECORDING = ("columns", "units", "repeated", "smoothing", "resolution", "ends", "max_gap")


def add_recording(parser: ArgumentParser) -> None:
    """A CSV file instead of TASK, and how it is to be read."""
    group = parser.add_argument_group("a motion from elsewhere, instead of TASK")
    group.add_argument("--csv", metavar="FILE", help="a header, then rows with a time (s) and each joint (rad, m)")
    group.add_argument(
        "--columns",
        action="append",
        type=_columns,
        metavar="NAME=COLUMN,...",
        help="which column is what: time, JOINT, JOINT.velocity, JOINT.effort, JOINT.current; a unit in brackets:"
        " time=stamp[ms],joint1=q1[deg] (repeatable)",
    )
    group.add_argument(
        "--units", type=_list, metavar="UNIT,...", help="of columns without one: deg, ms, us, ns, mm, ..."
    )
    group.add_argument("--repeated", choices=("refuse", "average"), help="rows with one stamp (refuse)")
    group.add_argument(
        "--smoothing",
        type=_smoothing,
        metavar="auto|RAD",
        help="auto: as smooth as the samples ask for; or the RMS residual that may be left; else interpolated",
    )
    group.add_argument(
        "--resolution", type=_positive, metavar="RAD", help="travel below which a joint rests (from the noise)"
    )
    group.add_argument(
        "--ends", choices=("auto", "rest", "moving"), help="whether it starts and ends at rest (read off the samples)"
    )
    group.add_argument(
        "--max-gap", type=_positive, metavar="S", help="longest step of time (10 times the usual one by default)"
    )


def _columns(text: str) -> dict[str, str]:
    pairs = [part.partition("=") for part in text.split(",")]
    if not all(name.strip() and equals and column.strip() for name, equals, column in pairs):
        raise ArgumentTypeError(f"{text!r} is not NAME=COLUMN,...")
    return {name.strip(): column.strip() for name, _, column in pairs}


def _list(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]


def _smoothing(text: str) -> str | float:
    return "auto" if text == "auto" else _positive(text)


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ArgumentTypeError(f"{text!r} is not a finite number")
    if not value > 0:
        raise ArgumentTypeError(f"{text} is not positive")
    return value
