"""Checks of limits in words and tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite, isinf
from typing import Any

from puma_septic.limit_check import LimitCheck
from puma_septic.views.tables import Cell, number, text_table

__all__ = ["percent", "read_checks", "unmet_text", "verdict"]


def read_checks(documents: Iterable[Mapping[str, Any]]) -> tuple[LimitCheck, ...]:
    """The checks of a document's list."""
    return tuple(LimitCheck.from_dict(document) for document in documents)


def percent(utilisation: float, digits: int = 0) -> str:
    """A utilisation as text."""
    return "unbounded" if isinf(utilisation) else f"{100 * utilisation:z.{digits}f} %"


def verdict(words: tuple[str, str], violations: Sequence[LimitCheck], governing: LimitCheck | None) -> str:
    """One sentence: the word for kept or for violated, and the governing limit."""
    kept, violated = words
    if not violations:
        return kept if governing is None else f"{kept}; governing limit: {governing}"
    count = len(violations)
    return f"{violated}, {count} limit{'s' if count > 1 else ''} violated; the worst: {violations[0]}"


def unmet_text(checks: Sequence[LimitCheck], not_assessed: Sequence[str], margin: float) -> str:
    """A table of the limits that are not kept with this margin, and what is not known."""
    spare = f" with {100 * margin:g} % to spare" if margin else ""
    subject = "1 limit is" if len(checks) == 1 else f"{len(checks)} limits are"
    headers = ["joint", "quantity", "demand", "limit", "unit", "t [s]", "margin"]
    rows: list[list[Cell]] = [
        [check.joint, check.quantity, check.demand, check.limit, check.unit, check.time, _margin(check)]
        for check in checks
    ]
    lines = [f"{subject} not kept{spare}:", text_table(headers, rows)]
    lines += [f"not assessed: {line}" for line in not_assessed]
    return "\n".join(lines)


def _margin(check: LimitCheck) -> str:
    if check.is_range:
        return f"{number(check.margin)} {check.unit}"
    return f"{100 * check.margin:z.1f} %" if isfinite(check.margin) else "none"
