"""Charts as numbers that a template turns into SVG: curves, ticks and marks in the picture's own coordinates.

Drawn from samples in a few milliseconds, in colours that the page chooses; matplotlib takes seconds for as many panels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, final

import numpy as np

from puma_septic.validation import Array

__all__ = ["BOX", "SIZE", "Chart", "Curve", "Mark", "chart", "ticks"]

# The picture, and in it the field of the curves: left, right, top, bottom. A unit is a pixel on a phone.
SIZE: Final = (360.0, 204.0)
BOX: Final = (50.0, 352.0, 24.0, 166.0)
# A limit this many times further out than the data would flatten the curves; it is written instead of drawn.
_FAR: Final = 2.2
_AIR: Final = 0.06
# What varies less than this part of its size is a level line, not rounding blown up to the height of the picture.
_FLAT: Final = 1e-9
_TEXT: Final = 26  # characters of a title that fit beside a remark

Kind = Literal["time", "plane", "path"]
Shape = Literal["via", "peak", "up", "down"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Curve:
    """A curve in data coordinates; `css` names its colour and dashes, `profile` the motion it belongs to."""

    x: Array
    y: Array
    css: str
    profile: int
    label: str


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Mark:
    """A point in data coordinates; arrowheads stand at the upper or lower edge, at x."""

    x: float
    y: float
    shape: Shape
    css: str = ""


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Chart:
    """What the template draws; places are in the picture, `low` and `high` are the values at its field's edges."""

    kind: Kind
    title: str
    y_label: str
    x_label: str
    remark: str
    low: float
    high: float
    x_ticks: tuple[tuple[str, str], ...]
    y_ticks: tuple[tuple[str, str], ...]
    lines: tuple[tuple[Curve, str], ...]
    marks: tuple[tuple[Mark, str, str], ...]
    level_limits: tuple[str, ...]
    upright_limits: tuple[str, ...]

    @property
    def short_title(self) -> str:
        """The title, cut where it would run into the remark."""
        return self.title if len(self.title) <= _TEXT else f"{self.title[: _TEXT - 1]}…"


def chart(
    kind: Kind,
    curves: Sequence[Curve],
    *,
    title: str,
    y_label: str,
    x_label: str = "time [s]",
    span: tuple[float, float] | None = None,
    marks: Sequence[Mark] = (),
    limits: tuple[float, float] = (np.nan, np.nan),
    x_limits: tuple[float, float] = (np.nan, np.nan),
    limits_always: bool = False,
    remark: str = "",
) -> Chart:
    """Lay out one chart.

    Parameters
    ----------
    kind : {"time", "plane", "path"}
        Over time; one quantity over another; or a path, both axes to one scale.
    span : tuple of float, optional
        Of the horizontal axis; that of the curves by default.
    limits, x_limits : tuple of float
        Lower and upper bound, NaN where unknown: dashed where near or `limits_always`, else written as a remark.
    """
    at = [mark for mark in marks if mark.shape in ("via", "peak")]
    x = np.concatenate([*(curve.x for curve in curves), [mark.x for mark in at]])
    y = np.concatenate([*(curve.y for curve in curves), [mark.y for mark in at]])
    level, far = _near(y, limits, always=limits_always)
    upright, _ = _near(x, x_limits, always=limits_always)
    horizontal = span or _range(np.concatenate([x, upright]))
    vertical = _range(np.concatenate([y, level]))
    if kind == "path":
        horizontal, vertical = _to_one_scale(horizontal, vertical)
    left, right, top, bottom = BOX
    return Chart(
        kind=kind,
        title=title,
        y_label=y_label,
        x_label=x_label,
        remark=remark or far,
        low=vertical[0],
        high=vertical[1],
        x_ticks=tuple((_place(t, horizontal, left, right), text) for t, text in ticks(*horizontal)),
        y_ticks=tuple((_place(t, vertical, bottom, top), text) for t, text in ticks(*vertical)),
        lines=tuple((curve, _points(curve, horizontal, vertical)) for curve in curves),
        marks=tuple(_placed(mark, horizontal, vertical) for mark in marks),
        level_limits=tuple(_place(bound, vertical, bottom, top) for bound in level),
        upright_limits=tuple(_place(bound, horizontal, left, right) for bound in upright),
    )


def ticks(low: float, high: float, about: int = 5) -> list[tuple[float, str]]:
    """Round numbers between two values, and their texts.

    Examples
    --------
    >>> ticks(-0.3, 1.1)
    [(0.0, '0'), (0.5, '0.5'), (1.0, '1')]
    >>> [text for _, text in ticks(0, 9)]
    ['0', '2', '4', '6', '8']
    """
    rough = (high - low) / about
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * next(factor for factor in (1, 2, 5, 10) if factor * power >= rough)
    counts = np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1)
    # Rounded to the step's own digits; adding 0 turns -0 into 0.
    values = np.round(counts * step, max(0, 2 - int(np.floor(np.log10(step))))) + 0.0
    return [(float(value), f"{value:.6g}".replace("-", "−")) for value in values]


def _near(values: Array, limits: tuple[float, float], *, always: bool) -> tuple[list[float], str]:
    """Bounds to draw, and in words those that are too far off."""
    reach = _FAR * max(np.abs(values).max(), np.ptp(values), 1e-12)
    known = [bound for bound in limits if not np.isnan(bound)]
    near = [bound for bound in known if always or abs(bound) <= reach]
    far = [bound for bound in known if bound not in near]
    if not far:
        return near, ""
    if len(far) == 2 and far[0] == -far[1]:
        return near, f"limit ±{far[1]:.3g}"
    return near, "limit " + ", ".join(f"{bound:.3g}" for bound in far).replace("-", "−")


def _range(values: Array) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    if high - low <= _FLAT * max(1.0, abs(low), abs(high)):
        return low - 0.5, high + 0.5
    air = _AIR * (high - low)
    return low - air, high + air


def _to_one_scale(
    horizontal: tuple[float, float], vertical: tuple[float, float]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Both ranges widened to the same metres per pixel."""
    left, right, top, bottom = BOX
    scale = max((horizontal[1] - horizontal[0]) / (right - left), (vertical[1] - vertical[0]) / (bottom - top))
    ranges = []
    for (low, high), pixels in ((horizontal, right - left), (vertical, bottom - top)):
        middle, half = (low + high) / 2, scale * pixels / 2
        ranges.append((middle - half, middle + half))
    return ranges[0], ranges[1]


def _place(value: float, values: tuple[float, float], start: float, end: float) -> str:
    return f"{start + (value - values[0]) / (values[1] - values[0]) * (end - start):.2f}"


def _points(curve: Curve, horizontal: tuple[float, float], vertical: tuple[float, float]) -> str:
    left, right, top, bottom = BOX
    x = left + (curve.x - horizontal[0]) * ((right - left) / (horizontal[1] - horizontal[0]))
    y = bottom - (curve.y - vertical[0]) * ((bottom - top) / (vertical[1] - vertical[0]))
    return " ".join([f"{a:.2f},{b:.2f}" for a, b in zip(x.tolist(), y.tolist(), strict=True)])


def _placed(mark: Mark, horizontal: tuple[float, float], vertical: tuple[float, float]) -> tuple[Mark, str, str]:
    left, right, top, bottom = BOX
    edge = {"up": f"{top:.2f}", "down": f"{bottom:.2f}"}
    y = edge[mark.shape] if mark.shape in edge else _place(mark.y, vertical, bottom, top)
    return mark, _place(mark.x, horizontal, left, right), y
