"""What a picture is made of: frozen values in data coordinates, which know nothing of how they are drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from textwrap import fill
from typing import Final, Literal, NamedTuple, final

import numpy as np

from puma_septic.pictures._styles import LIMIT, Dot, Fill, Line, Style
from puma_septic.validation import Array

__all__ = [
    "ASPECT",
    "Bar",
    "Curve",
    "Entry",
    "Mark",
    "Panel",
    "Picture",
    "Rule",
    "bars",
    "chart",
    "saying",
]

# Width over height of the field of a path, which has the same scale on both axes.
ASPECT: Final = 302 / 142
# A limit this many times further out than the data would flatten the curves; it is written instead of drawn.
_FAR: Final = 2.2
_AIR: Final = 0.06
_WIDTH: Final = 34  # characters of a message's line
# A cause that stays below this part of the whole torque, or of 1 N m where that is less, is rounding.
NEGLIGIBLE: Final = 1e-9
# What varies less than this part of its size is a level line, not rounding blown up to the height of the picture.
_FLAT: Final = 1e-9

Kind = Literal["time", "plane", "path", "still", "bars"]
Range = tuple[float, float]
UNKNOWN: Final = (np.nan, np.nan)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Curve:
    """Points joined by straight lines, x and y of shape (k,); `profile` is the number of the motion it belongs to."""

    x: Array
    y: Array
    line: Line
    label: str = ""
    profile: int = 0


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Mark:
    """A point; of arrowheads at the edge, only x counts."""

    x: float
    y: float
    dot: Dot


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Rule:
    """A straight line across the panel, at a value of one axis."""

    at: float
    line: Line = LIMIT


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Bar:
    """A level bar from zero in a row of the panel; `slot` counts the bars of a row, `text` tells the exact value."""

    row: int
    length: float
    fill: Fill
    text: str
    slot: int = 0
    is_violated: bool = False


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Panel:
    """One field with its axes.

    Attributes
    ----------
    kind : {"time", "plane", "path", "still", "bars"}
        Over the motion's time; one quantity of the motion vs. another; a path, both axes to one scale; curves that
        have nothing to do with the motion's time; bars.
    title, x_label, y_label : str
        Labels with units.
    x_range, y_range : tuple of float
        Values at the edges of the field.
    curves, marks, levels, uprights, bars : tuple
        What is drawn; levels are at a value of y, uprights at one of x.
    rows : tuple of str
        Names of the rows of bars, from above.
    remark : str
        Stands beside the title: a limit too far off to be drawn, or an unbounded value.
    message : str
        Stands in the field, where there is nothing to draw.
    """

    kind: Kind
    title: str
    x_label: str
    y_label: str = ""
    x_range: Range
    y_range: Range
    curves: tuple[Curve, ...] = ()
    marks: tuple[Mark, ...] = ()
    levels: tuple[Rule, ...] = ()
    uprights: tuple[Rule, ...] = ()
    bars: tuple[Bar, ...] = ()
    rows: tuple[str, ...] = ()
    remark: str = ""
    message: str = ""

    @property
    def slots(self) -> int:
        """Bars in a row, at most."""
        return 1 + max((bar.slot for bar in self.bars), default=0)

    def row_bars(self, row: int) -> list[Bar]:
        """The bars of one row, from above."""
        return sorted((bar for bar in self.bars if bar.row == row), key=lambda bar: bar.slot)


class Entry(NamedTuple):
    """One entry of a legend."""

    label: str
    style: Style


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Picture:
    """Panels under one heading.

    Attributes
    ----------
    name : str
        Of its files, without suffix.
    title : str
    panels : tuple of Panel
        Row by row.
    columns : int
        Panels side by side, where there is room.
    legend : tuple of Entry
    note : str
        What the legend would say, in a sentence, where a page has one legend for all its pictures.
    footnote : str
        What is not drawn, and why.
    has_own_colours : bool
        Colours stand for something other than the profiles.
    is_folded : bool
        A detail, which a page opens when it is asked for.
    """

    name: str
    title: str
    panels: tuple[Panel, ...]
    columns: int = 3
    legend: tuple[Entry, ...] = ()
    note: str = ""
    footnote: str = ""
    has_own_colours: bool = False
    is_folded: bool = False


def saying(title: str, text: str) -> Panel:
    """A panel that only says why there is nothing to draw."""
    return Panel(
        kind="still", title=title, x_label="", x_range=(0.0, 1.0), y_range=(0.0, 1.0), message=fill(text, _WIDTH)
    )


def chart(
    kind: Kind,
    curves: Sequence[Curve],
    *,
    title: str,
    y_label: str,
    x_label: str = "time [s]",
    span: Range | None = None,
    marks: Sequence[Mark] = (),
    limits: Range = UNKNOWN,
    x_limits: Range = UNKNOWN,
    limits_always: bool = False,
    levels: Sequence[Rule] = (),
    remark: str = "",
) -> Panel:
    """A panel of curves, its axes wide enough for what is in it.

    Parameters
    ----------
    kind : {"time", "plane", "path", "still"}
    span : tuple of float, optional
        Of the horizontal axis; that of the curves by default.
    limits, x_limits : tuple of float
        Lower and upper bound, NaN where unknown: dashed where near or `limits_always`, else written as a remark.
    levels : sequence of Rule
        Further level lines, always drawn.
    remark : str
        Stands in the place of far limits.

    Examples
    --------
    >>> from puma_septic.pictures import profile_line
    >>> curve = Curve(x=np.array([0.0, 1.0]), y=np.array([-1.0, 1.0]), line=profile_line(0))
    >>> near = chart("time", [curve], title="j", y_label="v [rad/s]", limits=(-1.5, 1.5))
    >>> [rule.at for rule in near.levels], near.remark
    ([-1.5, 1.5], '')
    >>> far = chart("time", [curve], title="j", y_label="v [rad/s]", limits=(-9.0, 9.0))
    >>> far.levels, far.remark
    ((), 'limit ±9')
    """
    at = [mark for mark in marks if mark.dot.shape not in ("up", "down")]
    x = np.concatenate([*(curve.x for curve in curves), [mark.x for mark in at]])
    y = np.concatenate([*(curve.y for curve in curves), [mark.y for mark in at]])
    near, far = _near(y, limits, always=limits_always)
    uprights, _ = _near(x, x_limits, always=limits_always)
    rules = [*(Rule(at=bound) for bound in near), *levels]
    horizontal = span or _range(np.append(x, uprights))
    vertical = _range(np.append(y, [rule.at for rule in rules]))
    if kind == "path":
        horizontal, vertical = _to_one_scale(horizontal, vertical)
    return Panel(
        kind=kind,
        title=title,
        x_label=x_label,
        y_label=y_label,
        x_range=horizontal,
        y_range=vertical,
        curves=tuple(curves),
        marks=tuple(marks),
        levels=tuple(rules),
        uprights=tuple(Rule(at=bound) for bound in uprights),
        remark=remark or far,
    )


def bars(
    title: str, x_label: str, *, rows: Sequence[str], bars: Sequence[Bar], end: float, limit: float = np.nan
) -> Panel:
    """A panel of level bars, which end at `end` at the latest; their texts tell the values that are cut."""
    return Panel(
        kind="bars",
        title=title,
        x_label=x_label,
        x_range=(0.0, end),
        y_range=(len(rows) - 0.4, -0.6),
        bars=tuple(replace(bar, length=float(np.clip(np.nan_to_num(bar.length), 0.0, end))) for bar in bars),
        rows=tuple(rows),
        uprights=() if np.isnan(limit) else (Rule(at=limit),),
    )


def _near(values: Array, limits: Range, *, always: bool) -> tuple[list[float], str]:
    """Bounds to draw, and in words those that are too far off."""
    known = [bound for bound in limits if not np.isnan(bound)]
    reach = _FAR * max(np.abs(values).max(), np.ptp(values), 1e-12)
    near = [bound for bound in known if always or abs(bound) <= reach]
    far = [bound for bound in known if bound not in near]
    if not far:
        return near, ""
    if len(far) == 2 and far[0] == -far[1]:
        return near, f"limit ±{far[1]:.3g}"
    return near, "limit " + ", ".join(f"{bound:.3g}" for bound in far).replace("-", "−")


def _range(values: Array) -> Range:
    low, high = float(values.min()), float(values.max())
    if high - low <= _FLAT * max(1.0, abs(low), abs(high)):
        return low - 0.5, high + 0.5
    air = _AIR * (high - low)
    return low - air, high + air


def _to_one_scale(horizontal: Range, vertical: Range) -> tuple[Range, Range]:
    """Both ranges widened to the same metres per pixel."""
    height = max((horizontal[1] - horizontal[0]) / ASPECT, vertical[1] - vertical[0])
    middles = (sum(horizontal) / 2, sum(vertical) / 2)
    (left, right), (low, high) = (
        (middle - size / 2, middle + size / 2) for middle, size in zip(middles, (height * ASPECT, height), strict=True)
    )
    return (left, right), (low, high)
