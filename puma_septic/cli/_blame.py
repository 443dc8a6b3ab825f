"""Which option a message is about, where the value that it complains of was given on the command line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

__all__ = ["blamed"]

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
            return f"{option} {value}: {_PLACE.sub('', message)}"
    return message


def _pairs(given: Sequence[str]) -> list[tuple[str, str]]:
    """Options with their values; numbers, which a message may have of its own, are left out."""
    found = []
    option = ""
    for text in given:
        if text.startswith("--"):
            option, equals, value = text.partition("=")
            if equals:
                found.append((option, value))
        elif option:
            found.append((option, text))
    return [(option, value) for option, value in found if re.search("[A-Za-z]{2}", value)]
