"""The command line: ``puma-septic COMMAND``.

Each command is a module here, with the arguments that it takes and a function ``run``. Libraries are loaded when it
runs, so that ``--help`` answers at once.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from argparse import Namespace
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import replace
from typing import Final

from puma_septic.cli import (
    _accelerations,
    _assess,
    _check,
    _compare,
    _doctor,
    _execute,
    _ik,
    _init,
    _limits,
    _optimise,
    _paper,
    _profiles,
    _replay,
    _robot,
    _size,
    _study,
)
from puma_septic.cli._messages import blamed, fault_text, missing_library, spelt
from puma_septic.cli._output_arguments import asked_units, check_out
from puma_septic.cli._parser import Command, parse
from puma_septic.cli._terminal import coloured, has_colour, terminal_width, waiting
from puma_septic.errors import InputError, PumaSepticError, readable

__all__ = ["COMMANDS", "main"]

BAD_INPUT = 2
FAULT = 70  # EX_SOFTWARE of sysexits.h
INTERRUPTED = 128  # and the signal's number, as a shell reports it: 130 for Ctrl-C
_ENDING: Final = (signal.SIGTERM, signal.SIGHUP)
# Commands that have a bar of their own, or run until they are ended.
_TELL_THEMSELVES: Final = ("optimise", "replay")

# In the order of the help.
COMMANDS: Final[Mapping[str, Command]] = {
    "assess": _assess,
    "check": _check,
    "compare": _compare,
    "optimise": _optimise,
    "limits": _limits,
    "size": _size,
    "execute": _execute,
    "study": _study,
    "replay": _replay,
    "ik": _ik,
    "robot": _robot,
    "doctor": _doctor,
    "accelerations": _accelerations,
    "profiles": _profiles,
    "paper": _paper,
    "init": _init,
}


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
        1: one of them violates a limit. 2: bad input, told on stderr, one line for each fault; a pose out of reach is
        one, and so is a place that cannot be written to. 3: undecided; the noise or the units of a recorded motion
        leave open whether it keeps its limits. 70: a fault of the program itself, with what to report. 130, 143,
        129: interrupted (Ctrl-C), terminated, hung up; nothing half written is left.
    """
    given = list(sys.argv[1:] if argv is None else argv)
    try:
        with _ended_like_ctrl_c():
            return _answered(given)
    except _Ended as end:
        return INTERRUPTED + end.number
    except KeyboardInterrupt:
        _complain("puma-septic: interrupted\n")
        return INTERRUPTED + signal.SIGINT
    except Exception as error:  # the last resort: Python's own exit code would be 1, which is a verdict
        lacking = missing_library(error)
        _complain(lacking or fault_text(error, given, debug="--debug" in given))
        return BAD_INPUT if lacking else FAULT


class _Ended(KeyboardInterrupt):
    """A signal that ends the process, as Ctrl-C does: what is half written is removed on the way out."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


@contextmanager
def _ended_like_ctrl_c() -> Iterator[None]:
    """While inside, a signal to terminate raises an exception; one that is ignored (nohup) stays so."""

    def end(number: int, _: object) -> None:
        signal.signal(number, signal.SIG_IGN)  # a second one must not disturb the way out
        raise _Ended(number)

    is_main = threading.current_thread() is threading.main_thread()
    caught = [one for one in _ENDING if is_main and signal.getsignal(one) is signal.SIG_DFL]
    for one in caught:
        signal.signal(one, end)
    try:
        yield
    finally:
        for one in caught:
            signal.signal(one, signal.SIG_DFL)


def _answered(given: list[str]) -> int:
    """The exit code of a command that ends as foreseen."""
    try:
        arguments = parse(given, COMMANDS)
    except SystemExit as stop:  # argparse after --help, --version or a wrong argument
        return int(stop.code or 0)
    try:
        arguments.typed = given
        check_out(arguments)
        asked_units(arguments)  # a wrong unit ends it before the work begins
        with (
            waiting(f"puma-septic {arguments.command}") if arguments.command not in _TELL_THEMSELVES else nullcontext()
        ):
            answer = COMMANDS[arguments.command].run(arguments)
        is_text = getattr(arguments, "format", "text") == "text"
        _write(_for_a_person(answer.text, arguments) if is_text else answer.text)
    except PumaSepticError as error:
        _complain(f"puma-septic: error: {blamed(spelt(_told(error)), given)}\n")
        return BAD_INPUT
    return answer.exit_code


def _told(error: PumaSepticError) -> str:
    """In one line; where a list of faults is told, one line for each."""
    return "\n  ".join(" ".join(line.split()) for line in str(error).split("\n  "))


def _for_a_person(text: str, arguments: Namespace) -> str:
    """In the asked units, within the terminal's width, coloured where it shows colours."""
    # Text wrapping takes a while to load, which --help need not wait for.
    from puma_septic.views.layout import Table, laid_out

    units = asked_units(arguments)

    def change(table: Table) -> Table:
        head, rows = units.table(table.head, table.rows)
        same = tuple(head) == table.head
        return table if same else replace(table, head=tuple(head), rows=tuple(map(tuple, rows)))

    shown = laid_out(units.prose(spelt(readable(text))), terminal_width(), change=change)
    return coloured(shown) if has_colour(sys.stdout) else shown


def _write(text: str) -> None:
    """Write the result; a reader that has seen enough (``| head``) ends it without a complaint."""
    if sys.stdout is None:
        raise InputError("cannot write the result: the standard output is closed")
    with suppress(AttributeError):  # a terminal that lacks a character shows its number
        sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    try:
        sys.stdout.write(text if text.endswith("\n") else f"{text}\n")
        sys.stdout.flush()
    except OSError as error:
        # The interpreter flushes once more when it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            raise InputError(f"cannot write the result: {error.strerror or error}") from error


def _complain(text: str) -> None:
    """On stderr, unless it is closed."""
    if sys.stderr is not None:
        with suppress(OSError):
            sys.stderr.write(readable(text))
