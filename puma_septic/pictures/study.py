"""Lines of equal value over two axes of a study; by itself, as studies need libraries of their own."""

from __future__ import annotations

from typing import Final

import numpy as np

from puma_septic.pictures._elements import Curve, Entry, Picture, chart, saying
from puma_septic.pictures._styles import profile_line
from puma_septic.study import StudyMap

__all__ = ["map_picture"]

_LEVELS: Final = {"feasible": (0.05, 0.5, 0.95), "utilisation": (0.5, 0.75, 1.0, 1.25)}
_UNITS: Final = {"duration": "duration [s]", "payload": "payload [kg]"}


def map_picture(found: StudyMap) -> Picture:
    """Where the feasible share, or the least utilisation, crosses some levels: for each x the y of each crossing."""
    curves, legend = [], []
    for k, level in enumerate(_LEVELS[found.column]):
        line = profile_line(k)
        x, y = _crossings(found, level)
        if len(x) > 1:
            words = f"{100 * level:g} % {'feasible' if found.column == 'feasible' else 'used'}"
            curves.append(Curve(x=x, y=y, line=line, label=words))
            legend.append(Entry(words, line))
    title = "feasible share" if found.column == "feasible" else "least utilisation"
    panel = saying(title, "It crosses none of the levels that are drawn.")
    if curves:
        x_label, y_label = (_UNITS.get(name, name) for name in (found.x_name, found.y_name))
        panel = chart("still", curves, title=title, x_label=x_label, y_label=y_label)
    return Picture(name="map", title=f"Study: {title}", panels=(panel,), columns=1, legend=tuple(legend))


def _crossings(found: StudyMap, level: float) -> tuple[np.ndarray, np.ndarray]:
    """The last y, from below, at which each column of values crosses a level."""
    xs, ys = [], []
    for x, column in zip(found.x.tolist(), found.values.T, strict=True):
        above = column >= level
        k = np.flatnonzero(above[1:] != above[:-1])
        if len(k) and np.isfinite(column[[k[-1], k[-1] + 1]]).all():
            low, high = column[k[-1]], column[k[-1] + 1]
            share = (level - low) / (high - low)
            xs.append(x)
            ys.append(found.y[k[-1]] + share * (found.y[k[-1] + 1] - found.y[k[-1]]))
    return np.array(xs), np.array(ys)
