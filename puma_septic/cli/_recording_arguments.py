"""Arguments of commands that take a motion recorded or planned elsewhere. Standard library alone."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError

from puma_septic.cli._numbers import positive

__all__ = ["RECORDING", "add_recording"]

# Options that mean nothing without --csv.
RECORDING = ("columns", "units", "repeated", "smoothing", "resolution", "ends", "max_gap")


def add_recording(parser: ArgumentParser) -> None:
    """A CSV file instead of TASK, and how it is to be read."""
    group = parser.add_argument_group("recorded motion, instead of TASK")
    group.add_argument(
        "--csv", metavar="FILE", help="CSV file: a header, then rows with the time (s) and each joint position (rad, m)"
    )
    group.add_argument(
        "--columns",
        action="append",
        type=_columns,
        metavar="NAME=COLUMN,...",
        help="column of time, JOINT, JOINT.velocity, JOINT.effort or JOINT.current, with its unit in brackets:"
        " time=stamp[ms],joint1=q1[deg] (repeatable)",
    )
    group.add_argument(
        "--units", type=_list, metavar="UNIT,...", help="units of columns that state none: deg, ms, us, ns, mm, ..."
    )
    group.add_argument(
        "--repeated", choices=("refuse", "average"), help="rows with equal time stamps (default: refuse)"
    )
    group.add_argument(
        "--smoothing",
        type=_smoothing,
        metavar="auto|RAD",
        help="auto: smoothing from the noise of the samples; RAD: maximum RMS residual of a smoothing spline; omit to"
        " interpolate",
    )
    group.add_argument(
        "--resolution",
        type=positive,
        metavar="RAD",
        help="travel below which a joint is at rest (default: from the noise)",
    )
    group.add_argument(
        "--ends",
        choices=("auto", "rest", "moving"),
        help="whether the motion starts and ends at rest (default: auto, from the samples)",
    )
    group.add_argument(
        "--max-gap", type=positive, metavar="S", help="maximum sampling gap (default: 10 times the median)"
    )


def _columns(text: str) -> dict[str, str]:
    pairs = [part.partition("=") for part in text.split(",")]
    if not all(name.strip() and equals and column.strip() for name, equals, column in pairs):
        raise ArgumentTypeError(f"{text!r} is not NAME=COLUMN,...")
    return {name.strip(): column.strip() for name, _, column in pairs}


def _list(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]


def _smoothing(text: str) -> str | float:
    return "auto" if text == "auto" else positive(text)
