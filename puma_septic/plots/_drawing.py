"""Pictures drawn by matplotlib."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any, Final, final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from PIL import Image, ImageShow

from puma_septic.errors import InputError
from puma_septic.pictures import Dot, Entry, Hue, Line, Panel, Picture

__all__ = ["OnAxes", "dot_style", "draw", "line_style", "new_figure", "place_legend"]

OnAxes = Axes | Sequence[Axes] | NDArray[Any]
# 9 inches wide are then 900 pixels.
DPI: Final = 100
# Of the frame around a chart; bars need none.
_SPINES: Final = ("left", "bottom")
_WIDTH: Final = 9.0
# Pictures are described in pixels of a phone; a page of this width has 1.3 of them a point.
_POINTS: Final = 0.85
# Heights in inches: of a panel, of one among many rows, of a bar and of a panel's labels.
_TALL, _LOW, _MANY_ROWS, _BAR, _LABELS = 2.3, 1.55, 3, 0.155, 0.75
_AIR: Final = 0.02
# Numbers of an axis: multiples of these times a power of ten, as on the page.
_STEPS: Final = [1, 2, 5, 10]
# In characters of the legend's font: what fits above a figure, and what a line sample with its gaps takes.
_LEGEND_WIDTH, _HANDLE_WIDTH = 128, 8
_MARKERS: Final[dict[str, dict[str, Any]]] = {
    "via": {"marker": "o", "markersize": 4.5, "markerfacecolor": "white", "zorder": 3},
    "peak": {"marker": "D", "markersize": 4.5, "zorder": 3},
    "dot": {"marker": "o", "markersize": 6, "markeredgecolor": "black", "zorder": 4},
    "point": {"marker": "o", "markersize": 4},
    "cross": {"marker": "X", "markersize": 8, "zorder": 4},
    "up": {"marker": "^", "markersize": 6, "gid": "impulse"},
    "down": {"marker": "v", "markersize": 6, "gid": "impulse"},
}
# Where arrowheads stand, in heights of the panel.
_EDGES: Final = {"up": 0.97, "down": 0.03}


@final
class NotebookFigure(Figure):
    """A matplotlib figure that notebooks display, and scripts by `show`: without pyplot neither would."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png")
        return buffer.getvalue()

    def show(self, warn: bool = True) -> None:
        """Open the figure in the system's viewer of pictures, as the last line of a script; the script goes on.

        Raises
        ------
        InputError
            Where no program shows pictures; `savefig` writes a file anywhere.
        """
        with Image.open(io.BytesIO(self._repr_png_())) as picture:
            if not ImageShow.show(picture) and warn:
                raise InputError("no program here shows pictures; write a file instead: figure.savefig('figure.png')")


def draw(picture: Picture, *, ax: OnAxes | None = None, joints: str | Sequence[str] | None = None) -> Figure:
    """Draw a picture: as a figure of its own, or on axes that are given, one for each panel.

    Parameters
    ----------
    picture : Picture
    ax : Axes or sequence of Axes, optional
        Where to draw; the legend then stands in the first.
    joints : str or sequence of str, optional
        Titles of the panels to draw; all by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For a panel that there is not, or another number of axes than of panels.
    """
    panels = picture.panels if joints is None else _chosen(picture, joints)
    if ax is None:
        figure, axes = _laid_out(panels, picture.columns)
    else:
        axes = _given(ax, panels)
        figure = _root(axes[0])
    for one, panel in zip(axes, panels, strict=True):
        _draw_panel(one, panel)
    if ax is None:
        _label_outer_only(axes, panels, picture.columns)
        place_legend(figure, picture.legend)
        if picture.footnote:
            figure.supxlabel(picture.footnote, fontsize=8, color="0.25", parse_math=False)
    elif picture.legend:
        _plain(axes[0].legend(handles=[_handle(entry) for entry in picture.legend], fontsize=7))
    return figure


def new_figure(height: float) -> NotebookFigure:
    """An empty figure 9 inches wide, at 100 pixels each, in which labels and legends are given room."""
    return NotebookFigure(figsize=(_WIDTH, height), dpi=DPI, layout="constrained")


def place_legend(figure: Figure, entries: Sequence[Entry]) -> None:
    """A legend above all panels, outside of them, in as few rows as its texts need."""
    if not entries:
        return
    sizes = [len(entry.label) + _HANDLE_WIDTH for entry in entries]
    columns = len(entries) if sum(sizes) <= _LEGEND_WIDTH else max(1, _LEGEND_WIDTH // max(sizes))
    legend = figure.legend(
        handles=[_handle(entry) for entry in entries],
        loc="outside upper center",
        ncols=columns,
        fontsize=8,
        frameon=False,
    )
    _plain(legend)


def _tidy(ax: Axes, panel: Panel) -> None:
    """Title and remark as plain text (a name is never read as mathematics), labels, few ticks, a faint grid."""
    ax.set_title(panel.title, fontsize=9, loc="left", parse_math=False)
    ax.set_title(panel.remark, fontsize=7, loc="right", color="0.25", parse_math=False)
    ax.set_xlabel(panel.x_label, fontsize=8)
    ax.set_ylabel(panel.y_label, fontsize=8)
    ax.tick_params(labelsize=7.5)
    for axis, most in ((ax.xaxis, 4 if panel.rows else 6), (ax.yaxis, 6)):
        axis.set_major_locator(MaxNLocator(most, steps=_STEPS))
    ax.grid(True, color="0.9", linewidth=0.6)
    for side, spine in ax.spines.items():
        spine.set(visible=side in _SPINES and not panel.rows, color="0.6", linewidth=0.8)
    ax.tick_params(color="0.6")
    ax.set_axisbelow(True)


def _draw_curves(ax: Axes, panel: Panel) -> None:
    """Curves, marks and limits; two values at one instant are joined by a vertical line."""
    for curve in panel.curves:
        ax.plot(curve.x, curve.y, label=curve.label, **line_style(curve.line))
    for dot in dict.fromkeys(mark.dot for mark in panel.marks):
        x, y = zip(*((mark.x, mark.y) for mark in panel.marks if mark.dot == dot), strict=True)
        if dot.shape in _EDGES:
            ax.plot(x, [_EDGES[dot.shape]] * len(x), transform=ax.get_xaxis_transform(), **dot_style(dot))
        else:
            ax.plot(x, y, **dot_style(dot))
    for rule in panel.levels:
        ax.axhline(rule.at, **line_style(rule.line))
    for rule in panel.uprights:
        ax.axvline(rule.at, **line_style(rule.line))


def _draw_panel(ax: Axes, panel: Panel) -> None:
    _draw_curves(ax, panel)
    _tidy(ax, panel)
    if panel.rows:
        _draw_bars(ax, panel)
    if panel.kind == "path":
        ax.set_aspect("equal")
    if panel.message:
        ax.text(0.5, 0.5, panel.message, ha="center", va="center", fontsize=8, transform=ax.transAxes)
        ax.set(xticks=[], yticks=[])
    low, high = panel.x_range
    # What begins and ends at an edge would be hidden by the frame.
    air = _AIR * (high - low) if panel.kind == "time" else 0.0
    ax.set_xlim(low - air, high + air)
    ax.set_ylim(panel.y_range)


def _draw_bars(ax: Axes, panel: Panel) -> None:
    """Numbers stand in a column at the right, where no bar runs into them."""
    thick = 0.8 / panel.slots
    level = {bar: bar.row - 0.4 + (bar.slot + 0.5) * thick for bar in panel.bars}
    for key in dict.fromkeys((bar.slot, bar.fill.is_hatched) for bar in panel.bars):
        bars = [bar for bar in panel.bars if (bar.slot, bar.fill.is_hatched) == key]
        style = _fill_style([_colour(bar.fill.hue) for bar in bars], is_hatched=key[1])
        ax.barh([level[bar] for bar in bars], [bar.length for bar in bars], 0.8 * thick, **style)
    for bar in panel.bars:
        ax.annotate(
            bar.text,
            (1.0, level[bar]),
            (3, 0),
            xycoords=ax.get_yaxis_transform(),
            textcoords="offset points",
            va="center",
            fontsize=6.5,
            weight="bold" if bar.is_violated else "normal",
        )
    ax.set_yticks(range(len(panel.rows)), panel.rows, parse_math=False, fontsize=7)
    ax.tick_params(axis="y", length=0)
    ax.grid(visible=False, axis="y")


def _chosen(picture: Picture, joints: str | Sequence[str]) -> tuple[Panel, ...]:
    wanted = (joints,) if isinstance(joints, str) else tuple(joints)
    titles = list(dict.fromkeys(panel.title for panel in picture.panels))
    for name in wanted:
        if name not in titles:
            raise InputError(f"joints: {name!r} is not one of {', '.join(titles)}")
    if not wanted:
        raise InputError(f"joints: at least one of {', '.join(titles)} is needed")
    return tuple(panel for panel in picture.panels if panel.title in wanted)


def _given(ax: OnAxes, panels: Sequence[Panel]) -> list[Axes]:
    axes = [ax] if isinstance(ax, Axes) else list(np.ravel(np.asarray(ax, dtype=object)))
    if len(axes) != len(panels) or not all(isinstance(one, Axes) for one in axes):
        titles = ", ".join(panel.title for panel in panels)
        raise InputError(f"ax: {len(panels)} axes are needed, one for each of {titles}; got {len(axes)}")
    return axes


def _root(ax: Axes) -> Figure:
    figure: Figure | SubFigure | None = ax.figure
    while isinstance(figure, SubFigure):
        figure = figure.figure
    if figure is None:
        raise InputError("ax: these axes have been removed from their figure")
    return figure


def _laid_out(panels: Sequence[Panel], columns: int) -> tuple[Figure, list[Axes]]:
    """A figure with as many rows as the panels need; bars of one row share their names."""
    columns = min(columns, max(1, len(panels)))
    rows = max(1, -(-len(panels) // columns))
    bars = [panel for panel in panels if panel.rows]
    if bars:
        height = _LABELS + _BAR * max(len(panel.rows) * (panel.slots + 0.4) for panel in bars)
    else:
        height = _TALL if rows <= _MANY_ROWS else _LOW
    figure = new_figure(0.6 + rows * height)
    axes: list[Axes] = []
    for k in range(len(panels)):
        shares = axes[k - k % columns] if k % columns and panels[k].rows else None
        axes.append(figure.add_subplot(rows, columns, k + 1, sharey=shares))
    return figure, axes


def _label_outer_only(axes: Sequence[Axes], panels: Sequence[Panel], columns: int) -> None:
    """Where many rows stand close together, time is labelled below the lowest; rows of bars at the left."""
    is_dense = len(panels) > _MANY_ROWS * columns
    for k, (ax, panel) in enumerate(zip(axes, panels, strict=True)):
        if is_dense and k + columns < len(panels) and panels[k + columns].x_label == panel.x_label:
            ax.set_xlabel("")
            ax.tick_params(axis="x", labelbottom=False)
        if panel.rows and k % columns:
            ax.tick_params(axis="y", labelleft=False)


def _plain(legend: Any) -> None:
    for text in legend.get_texts():
        text.set_parse_math(False)


def _handle(entry: Entry) -> Artist:
    if isinstance(entry.style, Line):
        return Line2D([], [], label=entry.label, **line_style(entry.style))
    if isinstance(entry.style, Dot):
        return Line2D([], [], label=entry.label, **dot_style(entry.style))
    return Patch(label=entry.label, **_fill_style(_colour(entry.style.hue), is_hatched=entry.style.is_hatched))


def line_style(line: Line) -> dict[str, Any]:
    """A line as matplotlib takes it; its dashes are in widths of the line."""
    width = _POINTS * line.width
    dash = (0, tuple(_POINTS * size / width for size in line.dash)) if line.dash else "-"
    return {"color": _colour(line.hue), "linewidth": width, "linestyle": dash}


def dot_style(dot: Dot) -> dict[str, Any]:
    """A mark as matplotlib takes it."""
    return {"linestyle": "none", "color": _colour(dot.hue), **_MARKERS[dot.shape]}


def _fill_style(colours: Any, *, is_hatched: bool) -> dict[str, Any]:
    if is_hatched:
        return {"facecolor": "white", "edgecolor": colours, "hatch": "////", "linewidth": 0.8}
    return {"color": colours}


def _colour(hue: Hue) -> str:
    """On paper."""
    return hue.light
