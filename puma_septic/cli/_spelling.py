"""Remedies that messages spell for Python, as the options of the command line."""

from __future__ import annotations

import re
from typing import Final

__all__ = ["spelt"]

_RULES: Final = tuple(
    (re.compile(pattern), option)
    for pattern, option in (
        (r"locked=['\"]others['\"]", "--lock-others"),
        (r"\blocked=\{'([^']*)': ([^{}]*)\}", r"--lock \1=\2"),
        (r"locked\['([^']*)'\]", r"--lock \1"),
        (r"package_dirs=\['?([^]']*)'?\]", r"--package-dir \1"),
        (r"limits='(\w+)'", r"--limits \1"),
        (r"\btool=\.\.\.", "--tool FRAME"),
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
