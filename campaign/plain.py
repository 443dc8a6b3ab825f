"""Plain values, numbers and answers compared: what a second parser says, and what an answer must be."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from typing import Any, Final

import numpy as np

import puma_septic as ps
from campaign.rules import MAX_MESSAGE, UNCLEAN, UnsoundError

_HUGE: Final = 10**308  # which no double is above


def numbers_of(value: Any, path: tuple[Any, ...] = ()) -> Iterable[tuple[tuple[Any, ...], float]]:
    """Every number in nested mappings and lists, with the way to it."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from numbers_of(part, (*path, key))
    elif isinstance(value, list):
        for key, part in enumerate(value):
            yield from numbers_of(part, (*path, key))
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, float(value) if abs(value) < _HUGE else math.inf * (1 if value > 0 else -1)


def same(what: str, value: Any, said: Any, *, tolerance: float = 0.0) -> None:
    """Hold what was made of a text against what it says; NaN is what is not known."""
    one, other = np.asarray(value, dtype=float), np.asarray(said, dtype=float)
    if one.shape != other.shape or not np.allclose(one, other, rtol=tolerance, atol=tolerance, equal_nan=True):
        raise UnsoundError(f"{what}: {one.tolist()}, the text has {other.tolist()}")


def check_answer(answer: Any) -> None:
    """An assessment, sizing or check: JSON with no NaN, and a text that can be shown."""
    try:
        json.dumps(answer.to_dict(), allow_nan=False)
    except ValueError as error:
        raise UnsoundError(f"document: not finite: {error}") from error
    check_text(str(answer))


def check_text(text: str) -> None:
    if found := UNCLEAN.search(text.replace("\n", " ")):
        raise UnsoundError(f"text: holds U+{ord(found[0]):04X}: {text[max(0, found.start() - 60) :][:200]!r}")
    if (longest := max(len(line) for line in text.split("\n"))) > 10 * MAX_MESSAGE:
        raise UnsoundError(f"text: a line of {longest} characters")


def check_assessment(assessment: ps.Assessment) -> None:
    """A verdict whose numbers are known: infinite is a step, NaN no number."""
    check_answer(assessment)
    known = assessment.motion.robot.knows_torque
    for name in ("peak_velocity", "peak_acceleration", "peak_jerk"):
        if np.isnan(getattr(assessment, name)).any():
            raise UnsoundError(f"{name}: NaN")
    for name in ("peak_torque", "rms_torque"):
        if np.isnan(getattr(assessment, name)[known]).any():
            raise UnsoundError(f"{name}: NaN")


def plain_number(text: str) -> float:
    """A decimal number, in whatever digits, else NaN."""
    try:
        value = float(text.strip()) if "_" not in text else math.nan
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan
