"""Numbers of the command line: types for argparse, whose message names the option. Standard library alone."""

from __future__ import annotations

import math
from argparse import ArgumentTypeError

__all__ = ["count", "finite", "not_negative", "positive", "share"]


def finite(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def not_negative(text: str) -> float:
    """A finite number from 0."""
    value = finite(text)
    if not value >= 0:
        raise ArgumentTypeError(f"{text} is negative")
    return value


def positive(text: str) -> float:
    """A finite number above 0."""
    value = finite(text)
    if not value > 0:
        raise ArgumentTypeError(f"{text} is not positive")
    return value


def share(text: str) -> float:
    """A number from 0 to 1."""
    value = finite(text)
    if not 0 <= value <= 1:
        raise ArgumentTypeError(f"{text} is not between 0 and 1")
    return value


def count(text: str) -> int:
    """A whole number from 1."""
    if not (text.isdecimal() and int(text) > 0):
        raise ArgumentTypeError(f"{text!r} is not a whole number from 1")
    return int(text)
