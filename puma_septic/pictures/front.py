"""Pictures of optimisations: fronts of motions of which none beats another, and the optimum beside its start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations

from puma_septic.objectives import Objective
from puma_septic.optimisation import LeastTime, OptimisedTimes, ParetoFront
from puma_septic.pictures._elements import Curve, Entry, Mark, Panel, Picture, chart
from puma_septic.pictures._motion import derivative_picture
from puma_septic.pictures._samples import track_of
from puma_septic.pictures._styles import DASHES, GREEN, ORANGE, PROFILES, PURPLE, SKY, Dot, Line
from puma_septic.quantities import typeset

__all__ = ["front_picture", "optimisation_picture"]

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
