"""Pictures as SVG files, which stand alone: panels in rows, the legend above them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

from puma_septic.pictures import Entry, Picture
from puma_septic.report._charts import SIZE, Chart
from puma_septic.report._rendering import render

__all__ = ["picture_svg", "write_svg"]

# Of the legend: a row's height, what the sample and gaps of an entry take, and about the width of a letter.
_ROW, _SAMPLE, _LETTER = 18.0, 54.0, 6.2
_AIR: Final = 14.0  # between rows of panels


def picture_svg(picture: Picture) -> str:
    """The picture as SVG, in the colours of the light page, without variables, which drawing programs do not know."""
    columns = min(picture.columns, max(1, len(picture.panels)))
    width = max(columns * SIZE[0], _LETTER * len(picture.footnote))
    legend, top = _legend(picture.legend, width)
    placed = []
    for k in range(0, len(picture.panels), columns):
        row = [Chart(panel=panel) for panel in picture.panels[k : k + columns]]
        placed += [(chart, n * SIZE[0], top) for n, chart in enumerate(row)]
        top += max(chart.height for chart in row) + _AIR
    height = top - _AIR + (_ROW if picture.footnote else 0.0)
    return render("figure.svg.j2", picture=picture, legend=legend, charts=placed, width=width, height=height)


def write_svg(folder: Path, pictures: Iterable[Picture]) -> None:
    """Each picture as NAME.svg."""
    for picture in pictures:
        (folder / f"{picture.name}.svg").write_text(picture_svg(picture), encoding="utf-8")


def _legend(entries: Sequence[Entry], width: float) -> tuple[list[tuple[Entry, float, float]], float]:
    """Entries with their places, in as few rows as they need, and the height of all."""
    x, y, placed = 2.0, 6.0, []
    for entry in entries:
        size = _SAMPLE + _LETTER * len(entry.label)
        if x > 2.0 and x + size > width:
            x, y = 2.0, y + _ROW
        placed.append((entry, x, y))
        x += size
    return placed, y + _ROW + 2.0 if placed else 0.0
