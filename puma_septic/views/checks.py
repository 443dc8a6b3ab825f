"""Checks of limits in words and tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite, isinf
from typing import Any, Final

from puma_septic.limit_check import LimitCheck
from puma_septic.views.tables import Cell, html_table, number, text_table

__all__ = ["percent", "read_checks", "to_spare", "unmet_html", "unmet_text", "used", "verdict"]

_UNMET: Final = ("joint", "quantity", "demand", "limit", "unit", "t [s]", "margin")


def read_checks(documents: Iterable[Mapping[str, Any]]) -> tuple[LimitCheck, ...]:
    """The checks of a document's list."""
    return tuple(LimitCheck.from_dict(document) for document in documents)


def percent(utilisation: float, digits: int = 0) -> str:
    """A utilisation as text."""
    return "unbounded" if isinf(utilisation) else f"{100 * utilisation:z.{digits}f} %"


def used(check: LimitCheck) -> str:
    """What is used of a limit; "violated" where that is no share, as of a height below the floor."""
    return "violated" if isfinite(check.demand) and isinf(check.utilisation) else percent(check.utilisation)


def verdict(words: tuple[str, str], violations: Sequence[LimitCheck], governing: LimitCheck | None) -> str:
    """One sentence: the word for kept or for violated, and the governing limit."""
    kept, violated = words
    if not violations:
        return kept if governing is None else f"{kept}; governing limit: {governing}"
    count = len(violations)
    return f"{violated}, {count} limit{'s' if count > 1 else ''} violated; the worst: {violations[0]}"


def unmet_text(checks: Sequence[LimitCheck], not_assessed: Sequence[str], margin: float) -> str:
    """A table of the limits that are not kept with this margin, and what is not known."""
    lines = [f"{_unmet(checks, margin)}:", text_table(_UNMET, _unmet_rows(checks))]
    lines += [f"not assessed: {line}" for line in not_assessed]
    return "\n".join(lines)


def unmet_html(name: str, checks: Sequence[LimitCheck], margin: float) -> str:
    """The same table of one motion, without what is not known."""
    return html_table(_UNMET, _unmet_rows(checks), caption=f"{name}: {_unmet(checks, margin)}")


def to_spare(margin: float) -> str:
    """The share of the limits that has to be left, in words; nothing of none."""
    return f" with {100 * margin:g} % to spare" if margin else ""


def _unmet(checks: Sequence[LimitCheck], margin: float) -> str:
    subject = "1 limit is" if len(checks) == 1 else f"{len(checks)} limits are"
    return f"{subject} not kept{to_spare(margin)}"


def _unmet_rows(checks: Sequence[LimitCheck]) -> list[list[Cell]]:
    return [
        [check.joint, check.quantity, check.demand, check.limit, check.unit, check.time, _margin(check)]
        for check in checks
    ]


def _margin(check: LimitCheck) -> str:
    if check.is_range:
        return f"{number(check.margin)} {check.unit}"
    return f"{100 * check.margin:z.1f} %" if isfinite(check.margin) else "none"
