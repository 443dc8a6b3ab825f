"""Pictures drawn by matplotlib and written to files."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Final

from matplotlib import rc_context
from matplotlib.figure import Figure

from puma_septic.pictures import Picture
from puma_septic.plots import draw

__all__ = ["save_figure", "write_png"]

# Of files, which are enlarged and printed: 1350 pixels wide.
_FILE_DPI: Final = 150


def write_png(folder: Path, pictures: Iterable[Picture]) -> None:
    """Each picture as NAME.png."""
    for picture in pictures:
        draw(picture).savefig(folder / f"{picture.name}.png", format="png", dpi=_FILE_DPI)


def save_figure(figure: Figure, path: Path) -> None:
    """Write a figure as PNG and SVG; the same figure gives the same bytes."""
    # matplotlib otherwise writes the date, and random names for the SVG's elements.
    with rc_context({"svg.hashsalt": "puma-septic"}):
        figure.savefig(path.with_name(f"{path.name}.png"), dpi=_FILE_DPI)
        # Laying out costs more than drawing, and the result is the same.
        figure.set_layout_engine("none")
        figure.savefig(path.with_name(f"{path.name}.svg"), metadata={"Date": None})
