"""What every input is held to: an error is one of our own and can be shown; an answer is sound; neither takes long."""

from __future__ import annotations

import re
import traceback
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import puma_septic as ps

MAX_MESSAGE: Final = 2_000  # characters: some twenty lines, what a reader still looks through
MAX_SECONDS: Final = 2.0  # of the processor, so that a busy machine changes nothing
MAX_BYTES: Final = 500_000_000  # resident, the interpreter and its libraries included
# Control characters but line feed and tab, what turns the direction of text, and other line ends.
UNCLEAN: Final = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


class UnsoundError(Exception):
    """An input was accepted, and what was made of it is not what it says."""


@dataclass(frozen=True)
class Verdict:
    """What came of one input: `outcome` is "accepted", "refused" or the kind of offence.

    `place` tells one cause of an offence from another; `detail` is for a reader.
    """

    outcome: str
    place: str = ""
    detail: str = ""

    @property
    def is_offence(self) -> bool:
        return self.outcome not in ("accepted", "refused")


def verdict_of(check: Callable[[Path], object], path: Path) -> Verdict:
    """Hold one file to the rules, apart from time and memory, which its process is watched for."""
    try:
        with warnings.catch_warnings():
            # NumPy's warnings about NaN and overflow in our own code would stand on the user's stderr.
            warnings.filterwarnings("error", module="puma_septic")
            check(path)
    except UnsoundError as error:
        return Verdict("unsound", str(error).split(":")[0], str(error))
    except ps.PumaSepticError as error:
        return _told(str(error))
    except Exception as error:
        frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "puma_septic" in frame.filename]
        place = f"{Path(frames[-1].filename).name}:{frames[-1].name}" if frames else "?"
        last = "".join(traceback.format_exception(error)[-6:])
        return Verdict("raw", f"{type(error).__name__} in {place}", last)
    return Verdict("accepted")


def message_faults(message: str) -> str:
    """Why a message cannot be shown; "" where it can."""
    if not message.strip():
        return "empty"
    if found := UNCLEAN.search(message):
        return f"holds U+{ord(found[0]):04X}"
    return f"{len(message):,} characters" if len(message) > MAX_MESSAGE else ""


def _told(message: str) -> Verdict:
    if fault := message_faults(message):
        words = re.sub(r"'[^']*'|\"[^\"]*\"|\S*/\S*|[^a-z ]", "", message).split()
        kind = "long:" if fault.endswith("characters") else "unclean:"
        return Verdict("message", " ".join([kind, *words[:8]]), f"{fault}: {message[:600]!r}")
    return Verdict("refused")
