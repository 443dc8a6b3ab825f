"""What the terminal is like: how wide, whether it shows colours, and whether somebody is waiting in front of it."""

from __future__ import annotations

import os
import re
import shutil
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final, TextIO

__all__ = ["coloured", "has_colour", "terminal_width", "waiting"]

# Nothing is laid out for less or more; and what is written to a file or a pipe is as wide as a page.
_LEAST, _MOST, _PAGE = 60, 200, 100
_RED, _GREEN, _YELLOW, _BOLD, _FAINT, _PLAIN = (f"\x1b[{code}m" for code in ("31", "32", "33", "1", "2", "0"))
# What is coloured, the first that fits: verdicts, violated shares, rules and remarks about more.
_COLOURS: Final = tuple(
    (re.compile(pattern, re.MULTILINE), colour)
    for pattern, colour in (
        (r"^-+ .*-+$|^-+(?:  -+)*$", _FAINT),
        (r"^More: .*$", _FAINT),
        (r"^Report: .*$", _BOLD),
        (r"\binfeasible\b|\b[1-9]\d* limits? violated\b|\bimpossible\b|\btoo weak\b|(?i:\bdoes not hold\b)", _RED),
        (r"\b\d+ %!|\(!\)|\bunbounded\b", _RED),
        (r"(?i:\bundecided\b)|\bdoubtful\b|(?i:\bholds in part\b)", _YELLOW),
        (r"\bfeasible\b|^ok\b|\bstrong enough\b|\bholds\b|\bHOLDS\b", _GREEN),
    )
)
_HUES: Final = {f"c{k}": colour for k, (_, colour) in enumerate(_COLOURS)}
_ANY: Final = re.compile("|".join(f"(?P<c{k}>{pattern.pattern})" for k, (pattern, _) in enumerate(_COLOURS)), re.M)


def terminal_width() -> int:
    """Columns to lay text out in: the terminal's or COLUMNS, from 60 to 200; 100 where it goes elsewhere."""
    if "COLUMNS" not in os.environ and not _is_terminal(sys.stdout):
        return _PAGE
    return min(max(shutil.get_terminal_size((_PAGE, 24)).columns, _LEAST), _MOST)


def has_colour(stream: TextIO | None) -> bool:
    """Whether to colour: on a terminal, unless NO_COLOR is set or TERM is dumb; anywhere with FORCE_COLOR.

    The two variables are those of https://no-color.org and https://force-color.org.
    """
    if os.environ.get("NO_COLOR"):
        return False
    if os.environ.get("FORCE_COLOR"):
        return True
    return _is_terminal(stream) and os.environ.get("TERM") != "dumb"


def coloured(text: str) -> str:
    r"""The text with verdicts, violated limits and rules coloured by the codes of ECMA-48.

    Examples
    --------
    >>> coloured("septic  infeasible")
    'septic  \x1b[31minfeasible\x1b[0m'
    """
    return _ANY.sub(lambda match: f"{_HUES[match.lastgroup or '']}{match[0]}{_PLAIN}", text)


@contextmanager
def waiting(what: str, *, after: float = 1.0) -> Iterator[None]:
    """While it takes longer than a second, say so on a terminal; the line is taken back at the end."""
    stream = sys.stderr
    if not _is_terminal(stream):
        yield
        return
    ended = threading.Event()
    start = time.monotonic()

    def tick() -> None:
        pause = after
        while not ended.wait(pause):
            stream.write(f"\r\x1b[K{what}: {time.monotonic() - start:z.0f} s ...")
            stream.flush()
            pause = 0.5

    ticker = threading.Thread(target=tick, daemon=True)
    ticker.start()
    try:
        yield
    finally:
        ended.set()
        ticker.join()
        stream.write("\r\x1b[K")
        stream.flush()


def _is_terminal(stream: TextIO | None) -> bool:
    return stream is not None and stream.isatty()
