"""Arguments that say in which form a command answers, and where it writes. Standard library alone."""

from __future__ import annotations

from argparse import ArgumentParser

__all__ = ["add_force", "add_format", "add_out"]


def add_format(parser: ArgumentParser, *formats: str) -> None:
    """``--format``, the first one by default."""
    parser.add_argument("--format", choices=formats, default=formats[0], help=f"output format (default: {formats[0]})")


def add_out(parser: ArgumentParser, files: str) -> None:
    """``--out``, the folder that the named files go to, and ``--force``."""
    parser.add_argument("--out", metavar="DIR", help=f"write {files} into a new or empty folder")
    add_force(parser, "--out")


def add_force(parser: ArgumentParser, option: str) -> None:
    """``--force``, without which nothing is overwritten."""
    parser.add_argument("--force", action="store_true", help=f"with {option}: replace files that exist")
