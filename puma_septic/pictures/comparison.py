"""Profiles side by side; fronts of motions of which none beats another, and an optimum beside its start."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import combinations
from typing import Final

import numpy as np

from puma_septic.comparison import ComparedProfile, Comparison
from puma_septic.objectives import Objective
from puma_septic.optimisation import LeastTime, OptimisedTimes, ParetoFront
from puma_septic.pictures._elements import Bar, Curve, Entry, Mark, Panel, Picture, bars, chart
from puma_septic.pictures._motion import derivative_picture
from puma_septic.pictures._samples import track_of
from puma_septic.pictures._styles import DASHES, FAINT, GREEN, ORANGE, PROFILES, PURPLE, SKY, Dot, Fill, Line
from puma_septic.quantities import typeset
from puma_septic.validation import Array

__all__ = ["comparison_picture", "front_picture", "optimisation_picture"]

_OPTIMAL, _GIVEN = Dot(shape="point", hue=PROFILES[0]), Dot(shape="cross", hue=PROFILES[1])
_VIAS = (GREEN, PURPLE, ORANGE, SKY)


def optimisation_picture(result: OptimisedTimes | LeastTime | ParetoFront) -> Picture:
    """The front; or the positions of the optimum beside those of the start, where there is one."""
    if isinstance(result, ParetoFront):
        return front_picture(result)
    tracks = [track_of(result.trajectory, "optimum")]
    if result.start is not None:
        tracks.insert(0, track_of(result.start, "start"))
    return replace(derivative_picture(tracks, 0), name="optimum", title=f"Optimum of {result.trajectory.profile}")


def front_picture(front: ParetoFront) -> Picture:
    """The front, one panel for each pair of objectives, and the via times along it."""
    pairs = list(combinations(range(len(front.objectives)), 2))
    panels = [_pair_panel(front, i, j, joined=len(pairs) == 1) for i, j in pairs]
    vias = {
        k: Line(hue=_VIAS[(k - 1) % len(_VIAS)], dash=DASHES[(k - 1) // len(_VIAS) % len(DASHES)])
        for k in range(1, front.times.shape[1] - 1)
    }
    return Picture(
        name="front",
        title=f"Pareto front of {front.start.profile}",
        panels=(*panels, _times_panel(front, vias)),
        columns=2,
        legend=(
            Entry("Pareto-optimal", _OPTIMAL),
            Entry("times as given", _GIVEN),
            *(Entry(f"via {k}", line) for k, line in vias.items()),
        ),
        has_own_colours=True,
    )


def _pair_panel(front: ParetoFront, i: int, j: int, *, joined: bool) -> Panel:
    """Two objectives; of two alone, the front is a line."""
    x, y = front.values[:, i], front.values[:, j]
    first, second = front.objectives[i], front.objectives[j]
    return chart(
        "still",
        [Curve(x=x, y=y, line=Line(hue=PROFILES[0], width=1.3))] if joined else [],
        title=f"{_words(second)} vs. {_words(first)}",
        x_label=_label(first),
        y_label=_label(second),
        marks=[
            *(Mark(x=a, y=b, dot=_OPTIMAL) for a, b in zip(x.tolist(), y.tolist(), strict=True)),
            Mark(x=float(front.start_values[i]), y=float(front.start_values[j]), dot=_GIVEN),
        ],
    )


def _times_panel(front: ParetoFront, vias: Mapping[int, Line]) -> Panel:
    """Via times along the front, by the first objective."""
    x, start = front.values[:, 0], float(front.start_values[0])
    curves, marks = [], []
    for k, line in vias.items():
        curves.append(Curve(x=x, y=front.times[:, k], line=line, label=f"via {k}"))
        points = zip(x.tolist(), front.times[:, k].tolist(), strict=True)
        marks += [Mark(x=a, y=b, dot=Dot(shape="point", hue=line.hue)) for a, b in points]
        marks.append(Mark(x=start, y=float(front.start.times[k]), dot=_GIVEN))
    x_label = _label(front.objectives[0])
    return chart("still", curves, title="via times", x_label=x_label, y_label="time [s]", marks=marks)


def _words(objective: Objective) -> str:
    return objective.name.replace("_", " ")


def _label(objective: Objective) -> str:
    unit = "share of the limit" if objective.unit == "1" else typeset(objective.unit)
    return f"{_words(objective)} [{unit}]"


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
    size = f"{value:.3g}" if value < 1000 else f"{value:z.0f}"
    return f"{size} ▸" if value > end else size


def _position_unit(comparison: Comparison) -> str:
    slides = comparison.profiles[0].assessment.motion.robot.is_prismatic
    return "m" if all(slides) else "(rad, m)" if any(slides) else "rad"
