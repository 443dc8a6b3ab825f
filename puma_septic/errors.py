"""Every exception that the package raises on purpose, and what is fit to be read by a person.

A violated limit is not among them: it is the answer of an assessment.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from difflib import get_close_matches
from functools import partial
from typing import Any, Final

__all__ = ["InputError", "ModelError", "NoSolution", "PumaSepticError", "did_you_mean", "readable"]

# What moves the cursor, ends a line or turns the direction of writing: Unicode's categories Cc, Cs, Zl and Zp, and the
# bidirectional controls (Unicode Standard Annex 9, table 2). Line feeds and tabs are text.
_CONTROL: Final = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
# In a message: of one word, and of all; a path of 255 bytes stays whole.
_LONG_WORD: Final = re.compile(r"\S{401,}")
_LONGEST: Final = 2000


def readable(text: str) -> str:
    r"""A text with its control characters as JSON and Python write them, so that it cannot steer a terminal.

    Examples
    --------
    >>> print(readable("\x1b[31mred\u202e"))
    \u001b[31mred\u202e
    """
    return _CONTROL.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


class PumaSepticError(Exception):
    """Base of all errors of this package.

    A message is `readable`, and long values in it are shortened.
    """

    def __init__(self, message: str = "") -> None:
        super().__init__(_shortened(readable(message)))


class InputError(PumaSepticError, ValueError):
    """An argument, task file or data file is not valid; the message says what would be."""


class ModelError(PumaSepticError):
    """A robot description or actuator file is missing, malformed or physically unusable."""


class NoSolution(PumaSepticError):
    """A well-posed request has no answer, such as a pose out of reach.

    Attributes
    ----------
    residual : float
        What remains unmet at `q`, in the unit that the message names.
    q : ndarray, shape (n_joints,)
        The best attempt.
    """

    def __init__(self, message: str, *, residual: float, q: Any) -> None:
        super().__init__(message)
        self.residual = residual
        self.q = q

    def __reduce__(self) -> tuple[Any, ...]:
        # By default the message alone: a process pool waited for ever for what could not be unpickled.
        return partial(type(self), residual=self.residual, q=self.q), self.args


def _shortened(text: str) -> str:
    text = _LONG_WORD.sub(lambda match: f"{match[0][:200]}...{match[0][-40:]}", text)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 500]} ... {text[-400:]}"


def did_you_mean(unknown: Iterable[str], valid: Iterable[str]) -> str:
    """Return the end of a message about unknown names: the valid ones that are near; empty where there are none.

    Examples
    --------
    >>> did_you_mean(["septc"], ["lspb", "septic"]), did_you_mean(["x"], ["lspb", "septic"])
    ("; did you mean 'septic'?", '')
    """
    names = list(valid)
    near = [
        match for name in unknown for match in get_close_matches(name, names, n=1, cutoff=0.7) or _parts(name, names)
    ]
    return f"; did you mean {', '.join(map(repr, near))}?" if near else ""


def _parts(name: str, names: Iterable[str]) -> list[str]:
    """The names that a name is a part of, or that are a part of it, three letters at least."""
    return [one for one in names if min(len(one), len(name)) >= 3 and (name in one or one in name)][:3]
