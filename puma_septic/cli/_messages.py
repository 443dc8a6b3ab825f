"""Messages spelt for the command line: which option is meant, which remedy, and what nobody foresaw."""

from __future__ import annotations

import platform
import re
import shlex
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from puma_septic._version import __version__

__all__ = ["blamed", "fault_text", "missing_library", "spelt"]

# Where a task would have had the value that an option replaced.
_PLACE: Final = re.compile(r"^(?:built-in task '[^']*'|[^:]*): (?:robot|branch|payload|profiles\[\d+\]): ")
_POSE: Final = re.compile(r"^command line: points\[0\] 'pose': ")
_WORD: Final = r"(?<![\w./-]){}(?![\w/-])"


def blamed(message: str, given: Sequence[str]) -> str:
    """A message with the option in front whose value it names; as it is where none or its option is named.

    Parameters
    ----------
    message : str
    given : sequence of str
        Arguments of the command line, without the program's name.

    Returns
    -------
    str

    Examples
    --------
    >>> blamed("cell.yaml: robot: unknown tool frame 'foo'; valid: 'flange'", ["assess", "cell.yaml", "--tool", "foo"])
    "--tool foo: unknown tool frame 'foo'; valid: 'flange'"
    >>> blamed("cell.yaml: times: must increase strictly", ["assess", "cell.yaml"])
    'cell.yaml: times: must increase strictly'
    """
    message = _POSE.sub("--position: ", message)
    for option, value in _pairs(given):
        if option in message:
            return message
        if re.search(_WORD.format(re.escape(value)), message) or f"/{value}:" in message:
            return f"{option} {value}: {_PLACE.sub('', message).removeprefix(f'{value}: ')}"
    return message


def _pairs(given: Sequence[str]) -> list[tuple[str, str]]:
    """Options with their values, and the names before an "="; numbers, which a message may have, are left out."""
    found = []
    option = ""
    for text in given:
        if text.startswith("--"):
            option, equals, value = text.partition("=")
            if equals:
                found.append((option, value))
        elif option:
            found.append((option, text))
    found += [(option, value.partition("=")[0]) for option, value in found if "=" in value]
    return [(option, value) for option, value in found if re.search("[A-Za-z]{2}", value)]


_RULES: Final = tuple(
    (re.compile(pattern), option)
    for pattern, option in (
        (r"locked=['\"]others['\"]", "--lock-others"),
        (r"\blocked=\{'([^']*)': ([^{}]*)\}", r"--lock \1=\2"),
        (r"locked\['([^']*)'\]", r"--lock \1"),
        (r"package_dirs=\['?([^]']*)'?\]", r"--package-dir \1"),
        (r"limits='(\w+)'", r"--limits \1"),
        (r"\btool=\.\.\.", "--tool FRAME"),
        (r"\bregion\['([^']*)'\] = ", r"--joint \1: "),
        (r"^gap = (\S+)", r"--gap \1"),
        (r" or drivetrains=\.\.\.", ""),
        (r"\bactuators=\.\.\.", "--actuators FILE"),
    )
)


def spelt(text: str) -> str:
    """A message whose remedies are spelt for Python, with the options that do the same.

    Examples
    --------
    >>> spelt("lock it: locked={'f': 0.0}, or locked='others'")
    'lock it: --lock f=0.0, or --lock-others'
    """
    for pattern, option in _RULES:
        text = pattern.sub(option, text)
    return text


_PACKAGE = Path(__file__).resolve().parents[1]


def fault_text(error: Exception, given: Sequence[str], *, debug: bool) -> str:
    """The lines for stderr.

    Parameters
    ----------
    error : Exception
    given : sequence of str
        Arguments of the command line, without the program's name.
    debug : bool
        Whether the full traceback goes first.
    """
    last_line = " ".join("".join(traceback.format_exception_only(error)).split())
    lines = [
        f"puma-septic: internal error: {last_line}",
        "This is a fault of puma-septic, not of its input, and no verdict. Please report it with the line above and",
        f"  command    {shlex.join(['puma-septic', *given])}",
        f"  version    puma-septic {__version__}, Python {platform.python_version()}, {platform.system()}",
        f"  raised in  {_place(error)}",
    ]
    if debug:
        return "".join(traceback.format_exception(error)) + "\n".join([*lines, ""])
    return "\n".join([*lines, "The option --debug shows the full traceback.", ""])


def missing_library(error: Exception) -> str:
    """The line for stderr where the system lacks a library that a package is linked to; "" for any other reason."""
    found = re.match(r"(?P<library>\S+): cannot open shared object file", str(error))
    if found is None or not isinstance(error, ImportError):
        return ""
    remedy = " (Debian, Ubuntu: apt-get install libgomp1)" if "libgomp" in found["library"] else ""
    return f"puma-septic: error: this system lacks the library {found['library']}; install it{remedy}\n"


def _place(error: Exception) -> str:
    """The innermost line of the package that was being executed, relative to it."""
    own = [frame for frame in traceback.extract_tb(error.__traceback__) if _PACKAGE in Path(frame.filename).parents]
    if not own:
        return "no line of the package"
    path = Path(own[-1].filename).relative_to(_PACKAGE.parent)
    return f"{path.as_posix()}, line {own[-1].lineno}, in {own[-1].name}"
