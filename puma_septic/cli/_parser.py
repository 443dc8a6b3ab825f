"""The parser of all commands, made from their modules. Standard library alone, so that ``--help`` answers at once."""

from __future__ import annotations

import re
import sys
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import Final, NamedTuple, NoReturn, Protocol

from puma_septic._version import __version__
from puma_septic.errors import did_you_mean, readable

__all__ = ["UNDECIDED", "Answer", "Command", "parse"]

# Exit code of a motion whose units or noise leave the verdict open.
UNDECIDED: Final = 3

_NEGATIVE = re.compile(r"-[0-9.]+[eE][-+]?[0-9]+|-[0-9.].*,.*")


class Answer(NamedTuple):
    """What a command has to say, and the exit code."""

    text: str
    exit_code: int


class Command(Protocol):
    """What the module of a command has; importing it loads the standard library alone."""

    SUMMARY: str  # one line for the list of commands
    DESCRIPTION: str  # what it does, and its exit codes
    EXAMPLES: str  # command lines, without the program's name

    def add_arguments(self, parser: ArgumentParser) -> None:
        """Declare what it takes."""

    def run(self, arguments: Namespace) -> Answer:
        """Answer; libraries are loaded here."""


class _Formatter(RawDescriptionHelpFormatter):
    """Paragraphs as wide as the terminal; examples as they are."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        parts = [
            part if part.startswith("examples:") else fill(part, width, initial_indent=indent, subsequent_indent=indent)
            for part in text.split("\n\n")
        ]
        return "\n\n".join(parts)


class _Parser(ArgumentParser):
    """An argument parser that complains in one line."""

    def error(self, message: str) -> NoReturn:
        if sys.stderr is not None:
            sys.stderr.write(readable(f"{self.prog}: error: {message} (see {self.prog} --help)\n"))
        sys.exit(2)


def parse(given: Sequence[str], commands: Mapping[str, Command]) -> Namespace:
    """Arguments of one command, its name in ``command``; without any, the help is printed and the program ends."""
    parser = _Parser(
        prog="puma-septic",
        description="Joint trajectories of robot arms, checked against what the motors can do.",
        epilog="Exit code: 0 all shown profiles are feasible, 1 one of them violates a limit, 2 bad input, 3 undecided:"
        " the units of a motion, or the noise of a recorded one, leave it open, 70 a fault of the program.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"puma-septic {__version__}")
    _add_debug(parser)
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    own: dict[str, _Parser] = {}
    for name, command in commands.items():
        own[name] = one = subparsers.add_parser(
            name,
            help=command.SUMMARY,
            description=command.DESCRIPTION,
            epilog="\n".join(["examples:", *(f"  puma-septic {line}" for line in command.EXAMPLES.splitlines())]),
            allow_abbrev=False,
            formatter_class=_Formatter,
        )
        _add_debug(one)
        command.add_arguments(one)
    if not given:
        parser.print_help()
        parser.exit()
    _check_command(parser, given, commands)
    # argparse takes -1e-3 (before Python 3.14) and -1,0 for options; after a space it is a value, and the same number.
    arguments, unknown = parser.parse_known_args([f" {text}" if _NEGATIVE.fullmatch(text) else text for text in given])
    if unknown:
        one = own[arguments.command]
        meant = did_you_mean(
            [text.partition("=")[0] for text in unknown],
            re.findall("--[a-z-]+", one.format_usage()),
        )
        one.error(f"unrecognized arguments: {' '.join(unknown)}{meant}")
    return arguments


def _check_command(parser: ArgumentParser, given: Sequence[str], commands: Mapping[str, Command]) -> None:
    """Refuse an unknown command by a message with the nearest; argparse would list all without it."""
    name = next((text for text in given if not text.startswith("-")), None)
    if name is not None and name not in commands:
        parser.error(f"unknown command {name!r}; valid: {', '.join(commands)}{did_you_mean([name], commands)}")


def _add_debug(parser: ArgumentParser) -> None:
    """Before or after the command; `main` reads it from the arguments as they are, whatever becomes of them."""
    parser.add_argument("--debug", action="store_true", help="after an internal error: show the full traceback")
