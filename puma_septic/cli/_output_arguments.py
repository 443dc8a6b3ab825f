"""Arguments that say in which form a command answers, and where it writes. Standard library alone."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

__all__ = ["add_force", "add_format", "add_out", "add_verbose", "add_write", "with_report"]


def add_format(parser: ArgumentParser, *formats: str) -> None:
    """``--format``, the first one by default."""
    parser.add_argument("--format", choices=formats, default=formats[0], help=f"output format (default: {formats[0]})")


def add_out(parser: ArgumentParser, files: str) -> None:
    """``--out``, the folder that the named files go to, and ``--force``."""
    parser.add_argument("--out", metavar="DIR", help=f"write {files} into a new or empty folder")
    add_force(parser, "--out")


def add_verbose(parser: ArgumentParser) -> None:
    """``-v``, counted."""
    parser.add_argument(
        "-v", "--verbose", action="count", default=0, help="tables of the joints and remarks; -vv: all of each profile"
    )


def with_report(text: str, arguments: Namespace) -> str:
    """The text for a person and, as its last line, where the report was written."""
    if arguments.out is None or arguments.format != "text":
        return text
    return f"{text}\n\nReport: {Path(arguments.out) / 'report.html'}"


def add_force(parser: ArgumentParser, option: str) -> None:
    """``--force``, without which nothing is overwritten."""
    parser.add_argument("--force", action="store_true", help=f"with {option}: replace files that exist")


def add_write(parser: ArgumentParser, what: str) -> None:
    """``--write``, the file that a motion goes to."""
    parser.add_argument(
        "--write",
        metavar="FILE",
        help=f"write {what} as a ROS JointTrajectory (.yaml, .json), which check reads; --force replaces a file",
    )
