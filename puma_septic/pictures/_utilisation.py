"""How much of each limit is used: bars, in per cent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from puma_septic.assessment import Assessment
from puma_septic.limit_check import LimitCheck
from puma_septic.pictures._elements import Bar, Entry, Panel, Picture, bars
from puma_septic.pictures._styles import LIMIT, Fill, profile_line
from puma_septic.quantities import COMMON, QUANTITIES

__all__ = ["percent_text", "utilisation_picture"]

# Bars end here, %; their texts tell what is beyond.
END: Final = 125.0


def utilisation_picture(assessments: Sequence[Assessment], labels: Sequence[str]) -> Picture:
    """One panel for each quantity with a known limit, in it a row for each joint with a bar for each profile.

    For positions, 100 % is the end of the range and 0 % its middle.
    """
    found = {(check.quantity, check.joint, k): check for k, one in enumerate(assessments) for check in one.checks}
    joints = assessments[0].motion.robot.joint_names
    panels = tuple(
        _panel(
            QUANTITIES[quantity].label,
            joints,
            [[found.get((quantity, joint, k)) for k in range(len(labels))] for joint in joints],
        )
        for quantity in QUANTITIES
        if any(key[0] == quantity for key in found)
    )
    missing = _unknown_limits(assessments)
    return Picture(
        name="utilisation",
        title="Limit utilisation",
        panels=(*panels, *_tool_panel(assessments)),
        legend=(
            *(Entry(label, Fill(hue=profile_line(k).hue)) for k, label in enumerate(labels)),
            Entry("limit", LIMIT),
        ),
        footnote=f"Not assessed, because no limit is given: {', '.join(missing)}." if missing else "",
    )


def _unknown_limits(assessments: Sequence[Assessment]) -> list[str]:
    """Quantities of which no joint's limit is known; an infinite demand exceeds a limit that is not known, too."""
    known = {check.quantity for one in assessments for check in one.checks if not np.isnan(check.limit)}
    return [QUANTITIES[quantity].label for quantity in COMMON if quantity not in known]


def percent_text(utilisation: float, *, is_violated: bool = False) -> str:
    """In per cent; a violated limit has an exclamation mark, so that colour is not all that tells.

    Examples
    --------
    >>> percent_text(0.52), percent_text(float("inf"), is_violated=True), percent_text(float("nan"))
    ('52 %', 'unbounded !', 'not known')
    """
    if np.isnan(utilisation):
        return "not known"
    size = "unbounded" if np.isinf(utilisation) else f"{100 * utilisation:z.0f} %"
    return f"{size} !" if is_violated else size


def _tool_panel(assessments: Sequence[Assessment]) -> tuple[Panel, ...]:
    """The tool's limits, a row for each; no panel where there are none."""
    found = {(check.quantity, k): check for k, one in enumerate(assessments) for check in one.tool_checks}
    rows = list(dict.fromkeys(quantity for quantity, _ in found))
    checks = [[found.get((quantity, k)) for k in range(len(assessments))] for quantity in rows]
    return (_panel("tool", rows, checks),) if rows else ()


def _panel(title: str, rows: Sequence[str], checks: Sequence[Sequence[LimitCheck | None]]) -> Panel:
    return bars(
        title,
        "limit utilisation [%]",
        rows=rows,
        bars=[_bar(row[k], j, k) for k in range(len(checks[0])) for j, row in enumerate(checks)],
        end=END,
        limit=100.0,
    )


def _bar(check: LimitCheck | None, row: int, k: int) -> Bar:
    used = np.nan if check is None else check.utilisation
    is_violated = check is not None and check.is_violated
    return Bar(
        row=row,
        slot=k,
        length=100 * used,
        fill=Fill(hue=profile_line(k).hue),
        text=percent_text(used, is_violated=is_violated),
        is_violated=is_violated,
    )
