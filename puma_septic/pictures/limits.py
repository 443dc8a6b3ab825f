"""What a motion can carry over its duration."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from puma_septic.limits import MotionLimits
from puma_septic.pictures._elements import Curve, Entry, Mark, Picture, chart, saying
from puma_septic.pictures._styles import PROFILES, Dot, profile_line

__all__ = ["payload_picture"]


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
    is_any = any(np.isinf(one.masses[:, 1]).any() for one in found)
    none = "No payload keeps the limits at any duration that is shown."
    panel = saying(title, "No known limit bears the payload." if is_any else none)
    if curves:
        panel = chart("still", curves, title=title, x_label="duration [s]", y_label="payload [kg]", marks=marks)
    return Picture(name="payload", title="Payload over duration", panels=(panel,), columns=1, legend=tuple(legend))
