"""Profiles side by side."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from puma_septic.comparison import ComparedProfile, Comparison
from puma_septic.pictures._elements import Bar, Entry, Panel, Picture, bars
from puma_septic.pictures._styles import FAINT, PROFILES, Fill
from puma_septic.validation import Array

__all__ = ["comparison_picture"]

_BEST, _OTHERS = Fill(hue=PROFILES[0]), Fill(hue=FAINT)
# One profile's value many times the others' would flatten all other bars; it is cut here and its number written.
_CUT: Final = 3.0


def _largest(name: str) -> Callable[[ComparedProfile], float]:
    return lambda row: float(getattr(row.assessment, name).max())


def _torque_use(row: ComparedProfile) -> float:
    checks = [check.utilisation for check in row.assessment.checks if check.quantity == "effort"]
    return 100.0 * max(checks, default=np.nan)


# Title, what it is, unit with {} for that of the position, value.
_PANELS: Final[tuple[tuple[str, str, Callable[[ComparedProfile], float]], ...]] = (
    ("velocity", "peak [{}/s]", _largest("peak_velocity")),
    ("acceleration", "peak [{}/s²]", _largest("peak_acceleration")),
    ("jerk", "peak [{}/s³]", _largest("peak_jerk")),
    ("integral of jerk²", "sum of joints [{}²/s⁵]", lambda row: float(row.integral_of_squared_jerk.sum())),
    ("overshoot", "largest [{}]", lambda row: float(row.trajectory.overshoot.max())),
    ("via miss", "largest [{}]", lambda row: float(row.trajectory.via_miss.max())),
    ("torque", "limit utilisation [%]", _torque_use),
    ("energy", "energy in [J]", lambda row: float(row.assessment.energy_in.sum())),
)


def comparison_picture(comparison: Comparison) -> Picture:
    """One panel per quantity, one bar per profile: the largest among the joints, sums for integral and energy."""
    unit = _position_unit(comparison)
    names = ", ".join(objective.name.replace("_", " ") for objective in comparison.objectives)
    return Picture(
        name="comparison",
        title="Profiles compared",
        panels=tuple(_panel(comparison, title, label.format(unit), value) for title, label, value in _PANELS),
        columns=4,
        legend=(Entry(f"Pareto-optimal in {names}", _BEST), Entry("dominated", _OTHERS)),
        has_own_colours=True,
    )


def _panel(comparison: Comparison, title: str, label: str, value: Callable[[ComparedProfile], float]) -> Panel:
    rows = comparison.profiles
    values = np.array([value(row) for row in rows])
    end = _end(values)
    return bars(
        title,
        label,
        rows=[row.name for row in rows],
        bars=[
            Bar(
                row=k,
                length=number,
                fill=_BEST if row.name in comparison.pareto_optimal else _OTHERS,
                text=_text(number, end),
            )
            for k, (row, number) in enumerate(zip(rows, values.tolist(), strict=True))
        ],
        end=1.04 * end,
    )


def _end(values: Array) -> float:
    """Where bars are cut: the three largest may stick out, what remains sets the scale."""
    finite = np.sort(values[np.isfinite(values)])
    if not len(finite) or finite[-1] <= 0.0:
        return 1.0
    ordinary = float(finite[-min(4, len(finite))])
    return min(float(finite[-1]), _CUT * ordinary) if ordinary > 0.0 else float(finite[-1])


def _text(value: float, end: float) -> str:
    if np.isinf(value):
        return "unbounded"
    if np.isnan(value):
        return "not known"
    size = f"{value:.3g}" if value < 1000 else f"{value:.0f}"
    return f"{size} ▸" if value > end else size


def _position_unit(comparison: Comparison) -> str:
    slides = comparison.profiles[0].assessment.motion.robot.is_prismatic
    return "m" if all(slides) else "(rad, m)" if any(slides) else "rad"
