"""The command line: ``puma-septic COMMAND``.

Each command is a module here with a function ``run``, loaded when it is asked for, so that ``--help`` answers at once.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from typing import Any

from puma_septic.cli.arguments import Answer, parse

__all__ = ["main"]

BAD_INPUT = 2
INTERRUPTED = 130  # as a shell reports Ctrl-C


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the program's name; those of the process by default.

    Returns
    -------
    int
        0: all shown profiles of the task are feasible (`ik`: each pose has a branch within limits; `paper`: always).
        1: one of them violates a limit. 2: bad input, told in one line on stderr; a pose out of reach is one.
        130: interrupted.
    """
    try:
        arguments = parse(argv)
    except SystemExit as stop:  # argparse after --help, --version or a wrong argument
        return int(stop.code or 0)
    try:
        errors: Any = import_module("puma_septic.errors")
        try:
            answer: Answer = import_module(f"puma_septic.cli.{arguments.command}").run(arguments)
        except errors.PumaSepticError as error:
            sys.stderr.write(f"puma-septic: error: {' '.join(str(error).split())}\n")
            return BAD_INPUT
        _write(answer.text)
    except KeyboardInterrupt:
        sys.stderr.write("puma-septic: interrupted\n")
        return INTERRUPTED
    return answer.exit_code


def _write(text: str) -> None:
    """Write the result; a reader that has seen enough (``| head``) ends it without a complaint."""
    with suppress(AttributeError):  # a terminal that lacks a character shows its number
        sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    try:
        sys.stdout.write(text if text.endswith("\n") else f"{text}\n")
        sys.stdout.flush()
    except BrokenPipeError:
        # The interpreter flushes once more when it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
