"""A claim of the paper and what becomes of it."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal, final

import numpy as np

from puma_septic.validation import Array, FrozenMap

__all__ = ["VERDICTS", "Claim", "Verdict", "times_text", "verdict_of"]

# Of a line of text, in characters.
_WIDTH: Final = 110
Verdict = Literal["holds", "does not hold", "holds in part", "not tested", "not stated"]
VERDICTS: Final[tuple[Verdict, ...]] = ("holds", "does not hold", "holds in part", "not tested", "not stated")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Claim:
    """One claim, measured.

    Attributes
    ----------
    number : int
    text : str
        What the paper says, in short; of what it does not mention, what it takes for granted.
    source : str
        Where it says so.
    measured : mapping of str
        The numbers that the verdict rests on; units in the names, SI and radians.
    verdict : str
        One of `VERDICTS`.
    explanation : str
        The verdict in words, with the measured numbers.
    """

    number: int
    text: str
    source: str
    measured: Mapping[str, Any]
    verdict: Verdict
    explanation: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "measured", FrozenMap(self.measured))

    def __str__(self) -> str:
        lines = (f"{self.number}. {self.text} [{self.source}]", f"{self.verdict.upper()}. {self.explanation}")
        return "\n".join(
            textwrap.fill(line, _WIDTH, initial_indent="    " * k, subsequent_indent="    ")
            for k, line in enumerate(lines)
        )


def verdict_of(*parts: bool) -> Verdict:
    """What becomes of a claim with these parts, each true or false."""
    if all(parts):
        return "holds"
    return "holds in part" if any(parts) else "does not hold"


def times_text(times: Array) -> str:
    """Instants in words: "2.47 s and 5.45 s"."""
    texts = [f"{time:z.2f} s" for time in np.ravel(times)]
    return " and ".join(filter(None, [", ".join(texts[:-1]), texts[-1]])) if texts else "never"
