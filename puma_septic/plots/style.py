"""What all figures share: colours, panels, legends, and curves that show steps as steps."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from typing import Any, Final, TypeVar, final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from puma_septic.errors import InputError
from puma_septic.piecewise import sampled
from puma_septic.validation import Array

__all__ = [
    "DPI",
    "LIMIT",
    "PALETTE",
    "Picture",
    "add_legend",
    "as_group",
    "beside",
    "colour_of",
    "draw_curve",
    "draw_limits",
    "joint_panels",
    "new_figure",
    "place_legend",
    "sampled",
    "tidy",
    "titled",
    "unique_labels",
]

Drawn = TypeVar("Drawn")

# Okabe and Ito, "Color Universal Design", 2008: told apart by people with any common colour blindness. Their
# yellow is left out (too faint for lines on white) and black is kept for limits and via points.
PALETTE: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
# The dashes tell profiles apart in print; five of them and six colours make thirty different lines.
_DASHES: Final = ("-", (0, (5, 1.5)), (0, (1.5, 1.2)), (0, (6, 1.5, 1.5, 1.5)), (0, (3, 1, 1, 1, 1, 1)))
LIMIT: Final[dict[str, Any]] = {"color": "black", "linewidth": 0.9, "linestyle": (0, (4, 2))}
# 9 inches wide are then 900 pixels.
DPI: Final = 100
# A limit this many times further out than the data would flatten the curves; it is written instead of drawn.
_FAR: Final = 2.2
# In characters of the legend's font: what fits above a figure, and what a line sample with its gaps takes.
_LEGEND_WIDTH, _HANDLE_WIDTH = 150, 8


@final
class Picture(Figure):
    """A matplotlib figure that notebooks display: without pyplot, IPython would only print its name."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png")
        return buffer.getvalue()


def new_figure(height: float, width: float = 9.0) -> Picture:
    """An empty figure, sizes in inches at 100 pixels each, in which labels and legends are given room."""
    return Picture(figsize=(width, height), dpi=DPI, layout="constrained")


def as_group(what: Drawn | Sequence[Drawn], kind: type[Drawn], n_joints: Callable[[Drawn], int]) -> tuple[Drawn, ...]:
    """One value or a sequence of them as a tuple.

    Raises
    ------
    InputError
        If it is empty, of another kind, or not all have the same number of joints.
    """
    group = (what,) if isinstance(what, kind) else tuple(what) if isinstance(what, Sequence) else ()
    if not group or not all(isinstance(one, kind) for one in group):
        raise InputError(f"expected one {kind.__name__} or a sequence of them, got {what!r}")
    counts = {n_joints(one) for one in group}
    if len(counts) > 1:
        raise InputError(f"drawn together, all must have the same joints; got {sorted(counts)} joints")
    return group


def unique_labels(names: Sequence[str], given: Sequence[str] | None) -> list[str]:
    """Legend entries: those given, or the names, numbered where one occurs twice."""
    if given is not None:
        if len(given) != len(names) or isinstance(given, str):
            raise InputError(f"labels: {len(names)} texts are needed, one for each curve, got {given!r}")
        return list(given)
    return [name if names.count(name) == 1 else f"{name} {names[: k + 1].count(name)}" for k, name in enumerate(names)]


def colour_of(k: int) -> str:
    """The colour of the k-th profile."""
    return PALETTE[k % len(PALETTE)]


def joint_panels(figure: Figure, titles: Sequence[str]) -> list[Axes]:
    """One panel per joint, at most three side by side."""
    columns = min(3, len(titles))
    rows = math.ceil(len(titles) / columns)
    panels = [figure.add_subplot(rows, columns, k + 1) for k in range(len(titles))]
    for panel, title in zip(panels, titles, strict=True):
        titled(panel, title)
    return panels


def titled(panel: Axes, title: str) -> None:
    """A small title at the left, as plain text: a name is never read as mathematics."""
    panel.set_title(title, fontsize=9, loc="left", parse_math=False)


def tidy(panel: Axes, *, x: str = "time [s]", y: str = "", ticks: int = 5) -> None:
    """Labels with units, few ticks, a faint grid."""
    panel.set_xlabel(x, fontsize=8)
    panel.set_ylabel(y, fontsize=8)
    panel.tick_params(labelsize=7.5)
    panel.xaxis.set_major_locator(MaxNLocator(6))
    panel.yaxis.set_major_locator(MaxNLocator(ticks))
    panel.grid(True, color="0.9", linewidth=0.6)
    panel.set_axisbelow(True)
    panel.margins(x=0.02)


def draw_curve(panel: Axes, t: Array, values: Array, k: int, label: str) -> None:
    """The k-th profile's curve; two values at one instant are joined by a vertical line."""
    panel.plot(t, values, color=colour_of(k), linestyle=_DASHES[k % len(_DASHES)], linewidth=1.5, label=label)


def draw_limits(panel: Axes, low: float, high: float, *, always: bool = False) -> None:
    """Bounds as dashed lines where they are near the curves, as words above the panel where they are far off.

    NaN is a bound that is not known. Call it after the curves: the panel's range is widened to what is drawn.
    """
    least, most = panel.get_ylim()
    reach = _FAR * max(abs(least), abs(most), most - least)
    known = [bound for bound in (low, high) if not np.isnan(bound)]
    near = known if always else [bound for bound in known if abs(bound) <= reach]
    far = [f"{bound:.3g}" for bound in known if bound not in near]
    for bound in near:
        panel.axhline(bound, **LIMIT)
    if near:
        air = 0.05 * (max(most, *near) - min(least, *near))
        panel.set_ylim(min(least, min(near) - air), max(most, max(near) + air))
    if far:
        both = len(far) == 2 and low == -high
        beside(panel, f"limit ±{far[-1]}" if both else f"limit {', '.join(far)}")


def beside(panel: Axes, text: str) -> None:
    """A remark above the panel, at the right, where no curve can run through it."""
    panel.set_title(text, fontsize=7, loc="right", color="0.25", parse_math=False)


def add_legend(figure: Figure, labels: Sequence[str], *, extra: Sequence[Line2D] = ()) -> None:
    """One legend above all panels, outside of them."""
    handles = [
        Line2D([], [], color=colour_of(k), linestyle=_DASHES[k % len(_DASHES)], linewidth=1.8, label=label)
        for k, label in enumerate(labels)
    ]
    place_legend(figure, [*handles, *extra])


def place_legend(figure: Figure, handles: Sequence[Artist]) -> None:
    """A legend above all panels, in as few rows as its texts need."""
    texts = [str(handle.get_label()) for handle in handles]
    columns = max(1, int(_LEGEND_WIDTH // (max(map(len, texts)) + _HANDLE_WIDTH)))
    legend = figure.legend(
        handles=handles, loc="outside upper center", ncols=min(columns, len(texts)), fontsize=8, frameon=False
    )
    for text in legend.get_texts():
        text.set_parse_math(False)
