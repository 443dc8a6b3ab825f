"""Write docs/cli.md, the reference of the command line, from its parser: ``python docs/make_cli.py``.

A test holds the page against the parser.
"""

from __future__ import annotations

import re
from argparse import ArgumentParser
from pathlib import Path

from puma_septic.cli import COMMANDS

PAGE = Path(__file__).parent / "cli.md"
HEAD = """# Command line

`puma-septic COMMAND --help` says the same on the terminal. Text is laid out for the terminal's width (60 to 200
columns; 100 where it goes into a file), in colour unless `NO_COLOR` is set (`FORCE_COLOR` colours a pipe, too).
`--format json` and `--format csv` are for programs: their numbers are in SI units with all digits, described in
[the documents](json.md).

| exit code | meaning |
|---|---|
| 0 | all shown profiles keep every known limit |
| 1 | one of them violates a limit |
| 2 | bad input |
| 3 | undecided: the units of a motion, or the noise of a recorded one, leave it open |
| 70 | a fault of the program, never a verdict |
| 130, 143, 129 | interrupted (Ctrl-C), terminated, hung up: nothing half written is left |
"""


def page() -> str:
    """The whole page."""
    return "\n".join([HEAD, *map(_command, COMMANDS)])


def _command(name: str) -> str:
    command = COMMANDS[name]
    parser = ArgumentParser(prog=f"puma-septic {name}", add_help=False)
    command.add_arguments(parser)
    rows = ["| | |", "|---|---|"]
    for action in parser._actions:
        if action.option_strings:
            value = "" if action.nargs == 0 else f" {_value(action)}"
            shown = ", ".join(f"`{option}{value}`" for option in action.option_strings)
        else:
            shown = f"`{_value(action)}`"
        meaning = re.sub(r"(?<![\w-])(--?[a-z][a-z-]*)", r"`\1`", (action.help or "").replace("|", r"\|"))
        rows.append(f"| {shown} | {meaning} |")
    examples = "\n".join(f"puma-septic {line}" for line in command.EXAMPLES.splitlines())
    return "\n".join([f"## {name}", "", command.DESCRIPTION, "", *rows, "", "```text", examples, "```", ""])


def _value(action: object) -> str:
    choices, metavar = getattr(action, "choices", None), getattr(action, "metavar", None)
    if choices:
        return "{" + ",".join(choices) + "}"
    return " ".join(metavar) if isinstance(metavar, tuple) else metavar or getattr(action, "dest", "").upper()


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
