"""Maps: what a motion can carry over its duration, and lines of equal value over two axes of a study."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from puma_septic.limits import MotionLimits
from puma_septic.pictures._elements import Curve, Entry, Mark, Picture, chart, saying
from puma_septic.pictures._styles import PROFILES, Dot, profile_line
from puma_septic.study import StudyMap

__all__ = ["map_picture", "payload_picture"]


def payload_picture(found: Sequence[MotionLimits], labels: Sequence[str]) -> Picture:
    """The largest payload over the duration, a line for each motion; a point where it is as given."""
    curves, marks, legend = [], [], []
    for k, (one, label) in enumerate(zip(found, labels, strict=True)):
        line = profile_line(k)
        known = np.isfinite(one.masses[:, 1])
        if known.any():
            curves.append(Curve(x=one.durations[known], y=one.masses[known, 1], line=line, label=label))
            legend.append(Entry(label, line))
        if one.heaviest is not None and one.motion.trajectory.duration <= one.durations[-1]:
            dot = Dot(shape="point", hue=PROFILES[k % len(PROFILES)])
            marks.append(Mark(x=one.motion.trajectory.duration, y=one.heaviest.mass, dot=dot))
    title = "largest payload"
    panel = saying(title, "No payload keeps the limits at any duration that is shown.")
    if curves:
        panel = chart("still", curves, title=title, x_label="duration [s]", y_label="payload [kg]", marks=marks)
    return Picture(name="payload", title="Payload over duration", panels=(panel,), columns=1, legend=tuple(legend))


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
