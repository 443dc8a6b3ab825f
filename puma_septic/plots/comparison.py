"""Profiles side by side, and fronts of motions that do not beat each other."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from puma_septic.comparison import ComparedProfile, Comparison
from puma_septic.optimisation import ParetoFront
from puma_septic.plots.style import PALETTE, colour_of, new_figure, place_legend, tidy, titled

__all__ = ["plot_comparison", "plot_pareto_front"]

_OTHERS: Final = "0.72"
# One profile's value many times the next one's would flatten all other bars; it is cut here and its number written.
_CUT: Final = 3.0


def _largest(name: str) -> Callable[[ComparedProfile], float]:
    return lambda row: float(getattr(row.assessment, name).max())


def _torque_use(row: ComparedProfile) -> float:
    checks = [check.utilisation for check in row.assessment.checks if check.quantity == "effort"]
    return 100.0 * max(checks, default=np.nan)


_PANELS: Final[tuple[tuple[str, str, Callable[[ComparedProfile], float]], ...]] = (
    ("velocity", "peak [rad/s]", _largest("peak_velocity")),
    ("acceleration", "peak [rad/s²]", _largest("peak_acceleration")),
    ("jerk", "peak [rad/s³]", _largest("peak_jerk")),
    ("integral of jerk²", "[rad²/s⁵]", lambda row: float(row.integral_of_squared_jerk.sum())),
    ("overshoot", "[rad]", lambda row: float(row.trajectory.overshoot.max())),
    ("via miss", "[rad]", lambda row: float(row.trajectory.via_miss.max())),
    ("torque", "peak, of the limit [%]", _torque_use),
    ("energy", "put in [J]", lambda row: float(row.assessment.energy_in.sum())),
)


def plot_comparison(comparison: Comparison) -> Figure:
    """Draw one panel per quantity, one bar per profile; Pareto-optimal profiles are coloured.

    Bars are the largest value among the joints (sums for integral and energy). A bar that would flatten the others is
    cut; unbounded values say so.

    Parameters
    ----------
    comparison : Comparison

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.
    """
    rows = comparison.profiles
    columns = 4
    figure = new_figure(1.2 + 2 * (0.6 + 0.17 * len(rows)), 10.0)
    panels = figure.subplots(len(_PANELS) // columns, columns, sharey=True).ravel()
    best = [row.name in comparison.pareto_optimal for row in rows]
    for panel, (title, unit, value) in zip(panels, _PANELS, strict=True):
        _draw_bars(panel, np.array([value(row) for row in rows]), best)
        titled(panel, title)
        tidy(panel, x=unit, ticks=len(rows))
        panel.set_yticks(range(len(rows)), [row.name for row in rows], parse_math=False, fontsize=7)
        panel.set_ylim(len(rows) - 0.4, -0.6)
        panel.grid(False, axis="y")
    names = ", ".join(objective.name for objective in comparison.objectives)
    place_legend(
        figure,
        [Patch(color=colour_of(0), label=f"Pareto-optimal in {names}"), Patch(color=_OTHERS, label="beaten")],
    )
    return figure


def _draw_bars(panel: Axes, values: np.ndarray, best: list[bool]) -> None:
    finite = np.sort(values[np.isfinite(values)])
    # The three largest may stick out; what remains sets the scale.
    ordinary = finite[-min(4, len(finite))] if len(finite) else 0.0
    cut = _CUT * ordinary if ordinary > 0 else (finite[-1] if len(finite) else 1.0)
    ends = np.minimum(np.where(np.isfinite(values), values, 0.0), cut)
    colours = [colour_of(0) if good else _OTHERS for good in best]
    panel.barh(range(len(values)), ends, 0.75, color=colours)
    widest = max(float(ends.max()), 1e-12)
    for k, (value, end) in enumerate(zip(values, ends, strict=True)):
        text = "unbounded" if np.isinf(value) else "not known" if np.isnan(value) else f"{value:.3g}"
        if text != "0":
            cut_here = np.isfinite(value) and value > cut
            panel.annotate(
                f"{text} ▸" if cut_here else text, (end, k), (2, 0), textcoords="offset points", va="center", fontsize=6
            )
    panel.set_xlim(0.0, 1.45 * widest)


def plot_pareto_front(front: ParetoFront) -> Figure:
    """Draw the front, one panel for each pair of objectives, and the via times along it.

    Parameters
    ----------
    front : ParetoFront

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.
    """
    pairs = list(combinations(range(len(front.objectives)), 2))
    figure = new_figure(3.4, 9.0 if len(pairs) == 1 else 12.0)
    panels = figure.subplots(1, len(pairs) + 1)
    for panel, (i, j) in zip(panels, pairs, strict=False):
        style = "-o" if len(pairs) == 1 else "o"
        panel.plot(front.values[:, i], front.values[:, j], style, color=colour_of(0), markersize=4, linewidth=1.2)
        panel.plot(*front.start_values[[i, j]], "X", color=colour_of(1), markersize=8)
        x, y = front.objectives[i], front.objectives[j]
        titled(panel, f"{y.name} over {x.name}" if len(pairs) == 1 else "")
        tidy(panel, x=_label(x.name, x.unit), y=_label(y.name, y.unit))
        panel.margins(0.08)
    _draw_times(panels[-1], front)
    place_legend(
        figure,
        [
            Line2D([], [], marker="o", color=colour_of(0), markersize=4, label="not beaten by any other"),
            Line2D([], [], marker="X", color=colour_of(1), linestyle="", markersize=8, label="times as given"),
        ],
    )
    return figure


def _draw_times(panel: Axes, front: ParetoFront) -> None:
    """Via times along the front, by the first objective."""
    first = front.objectives[0]
    for k in range(1, front.times.shape[1] - 1):
        colour = PALETTE[(k + 1) % len(PALETTE)]
        panel.plot(front.values[:, 0], front.times[:, k], "-o", color=colour, markersize=3, linewidth=1.0)
        panel.plot(front.start_values[0], front.start.times[k], "X", color=colour_of(1), markersize=8)
        panel.annotate(
            f"via {k}", (front.values[-1, 0], front.times[-1, k]), (0, 5), textcoords="offset points", fontsize=7.5
        )
    titled(panel, "via times")
    tidy(panel, x=_label(first.name, first.unit), y="[s]")
    panel.margins(0.1)


def _label(name: str, unit: str) -> str:
    text = unit.replace("^2", "²").replace("^3", "³").replace("s^5", "s⁵")
    return f"{name.replace('_', ' ')} [{text}]" if unit != "1" else f"{name.replace('_', ' ')}, share of the limit"
