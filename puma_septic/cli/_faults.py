"""What is said of an exception that nobody foresaw: what happened, whose fault it is, what to report."""

from __future__ import annotations

import platform
import shlex
import traceback
from collections.abc import Sequence
from pathlib import Path

from puma_septic._version import __version__

__all__ = ["fault_text"]

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


def _place(error: Exception) -> str:
    """The innermost line of the package that was being executed, relative to it."""
    own = [frame for frame in traceback.extract_tb(error.__traceback__) if _PACKAGE in Path(frame.filename).parents]
    if not own:
        return "no line of the package"
    path = Path(own[-1].filename).relative_to(_PACKAGE.parent)
    return f"{path.as_posix()}, line {own[-1].lineno}, in {own[-1].name}"
