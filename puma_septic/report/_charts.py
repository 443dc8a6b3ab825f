"""Panels as SVG: numbers in the picture's own coordinates, which a template writes down.

Drawn in a few milliseconds, in colours that the page chooses; matplotlib takes seconds for as many panels.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.pictures import Bar, Curve, Mark, Panel

__all__ = ["BOX", "SIZE", "Chart", "ticks"]

# The picture, and in it the field of the curves: left, right, top, bottom. A unit is a pixel on a phone.
SIZE: Final = (360.0, 204.0)
BOX: Final = (50.0, 352.0, 24.0, 166.0)
# Below the field: the numbers of the axis, and its label.
_FOOT: Final = SIZE[1] - BOX[3]
# Of bars: the width of a letter of their names and the most that names take, the column of numbers, heights.
_LETTER, _NAMES, _NUMBERS, _BAR, _GAP = 6.1, 190.0, 66.0, 11.0, 4.0
# Letters that fit above the field: of the title, the vertical axis's label and the remark; the least of a title.
_TEXT, _LEAST_TITLE = 52, 12


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Chart:
    """A panel as the template draws it: its places are in the picture, as texts."""

    panel: Panel

    @property
    def box(self) -> tuple[float, float, float, float]:
        """The field: left, right, top, bottom; bars have their names at the left and their numbers at the right."""
        if not self.panel.rows:
            return BOX
        _, right, top, _ = BOX
        left = max(8.0, min(_NAMES, 8.0 + _LETTER * max(map(len, self.panel.rows))))
        return left, right - _NUMBERS, top, self._row(len(self.panel.rows))

    @property
    def height(self) -> float:
        """Of the whole picture."""
        return self.box[3] + _FOOT

    @property
    def short_title(self) -> str:
        """The title, cut where it would run into the remark."""
        taken = len(self.panel.y_label) + len(self.panel.remark)
        return _cut(self.panel.title, max(_LEAST_TITLE, _TEXT - taken))

    @property
    def short_remark(self) -> str:
        """The remark, cut where it would run into the title."""
        return _cut(self.panel.remark, _TEXT - len(self.panel.y_label) - len(self.short_title))

    @property
    def x_ticks(self) -> list[tuple[str, str]]:
        """Places and texts."""
        return [(self.x(value), text) for value, text in ticks(*self.panel.x_range)] if self.has_axes else []

    @property
    def y_ticks(self) -> list[tuple[str, str]]:
        """Places and texts; of bars, the names of their rows."""
        if self.panel.rows:
            return [(f"{self._row(row + 0.5):.2f}", name) for row, name in enumerate(self.panel.rows)]
        return [(self.y(value), text) for value, text in ticks(*self.panel.y_range)] if self.has_axes else []

    @property
    def has_axes(self) -> bool:
        """A panel that only says something has none."""
        return not self.panel.message

    @property
    def lines(self) -> list[tuple[Curve, str]]:
        """Curves and the places of their points."""
        return [(curve, self._points(curve)) for curve in self.panel.curves]

    @property
    def marks(self) -> list[tuple[Mark, str, str]]:
        """Marks and their places; arrowheads stand at the upper or lower edge."""
        edges = {"up": f"{self.box[2]:.2f}", "down": f"{self.box[3]:.2f}"}
        return [(mark, self.x(mark.x), edges.get(mark.dot.shape) or self.y(mark.y)) for mark in self.panel.marks]

    @property
    def bars(self) -> list[tuple[Bar, str, str, str]]:
        """Bars, their upper edges, widths and the level of their texts."""
        placed = []
        for bar in self.panel.bars:
            top = self._row(bar.row) + _GAP / 2 + bar.slot * _BAR
            width = float(self.x(bar.length)) - self.box[0]
            placed.append((bar, f"{top + 1:.2f}", f"{width:.2f}", f"{top + 0.85 * _BAR:.2f}"))
        return placed

    def x(self, value: float) -> str:
        """Place of a value of the horizontal axis."""
        return _place(value, self.panel.x_range, self.box[0], self.box[1])

    def y(self, value: float) -> str:
        """Place of a value of the vertical axis."""
        return _place(value, self.panel.y_range, self.box[3], self.box[2])

    def _row(self, row: float) -> float:
        """Upper edge of a row of bars; of a half more, its middle."""
        return BOX[2] + row * (self.panel.slots * _BAR + _GAP)

    def _points(self, curve: Curve) -> str:
        left, right, top, bottom = self.box
        (x0, x1), (y0, y1) = self.panel.x_range, self.panel.y_range
        x = left + (curve.x - x0) * ((right - left) / (x1 - x0))
        y = bottom - (curve.y - y0) * ((bottom - top) / (y1 - y0))
        return " ".join([f"{a:.2f},{b:.2f}" for a, b in zip(x.tolist(), y.tolist(), strict=True)])


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


def _cut(text: str, length: int) -> str:
    return text if len(text) <= length else f"{text[: length - 1]}…"


def _place(value: float, values: tuple[float, float], start: float, end: float) -> str:
    return f"{start + (value - values[0]) / (values[1] - values[0]) * (end - start):.2f}"
