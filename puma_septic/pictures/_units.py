"""Pictures in the units that a reader wants."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

from puma_septic.pictures._elements import Panel, Picture
from puma_septic.views.units import SI, Units

__all__ = ["in_units"]

_UNIT: Final = re.compile(r"\[(rad(?:/s(?:\^[23]|²|³)?)?)\]")
_LIMIT: Final = re.compile(r"[−-]?\d+\.?\d*(?:e[+-]?\d+)?")


def in_units(picture: Picture, units: Units) -> Picture:
    """The picture with every axis of angles or speeds in these units.

    Examples
    --------
    >>> import numpy as np
    >>> from puma_septic.pictures import Curve, chart, profile_line
    >>> curve = Curve(x=np.array([0.0, 1.0]), y=np.array([0.0, np.pi]), line=profile_line(0))
    >>> picture = Picture(name="p", title="p", panels=(chart("time", [curve], title="j", y_label="q [rad]"),))
    >>> (panel,) = in_units(picture, Units(angle="deg")).panels
    >>> panel.y_label, float(panel.curves[0].y[1])
    ('q [deg]', 180.0)
    """
    if units == SI:
        return picture
    return replace(picture, panels=tuple(_panel(panel, units) for panel in picture.panels))


def _panel(panel: Panel, units: Units) -> Panel:
    a, x_label = _label(panel.x_label, units)
    b, y_label = _label(panel.y_label, units)
    if a == b == 1.0 or panel.rows:
        return panel
    return replace(
        panel,
        x_label=x_label,
        y_label=y_label,
        x_range=(a * panel.x_range[0], a * panel.x_range[1]),
        y_range=(b * panel.y_range[0], b * panel.y_range[1]),
        curves=tuple(replace(one, x=a * one.x, y=b * one.y) for one in panel.curves),
        marks=tuple(replace(one, x=a * one.x, y=b * one.y) for one in panel.marks),
        levels=tuple(replace(one, at=b * one.at) for one in panel.levels),
        uprights=tuple(replace(one, at=a * one.at) for one in panel.uprights),
        remark=_LIMIT.sub(lambda one: f"{b * float(one[0].replace('−', '-')):.3g}", panel.remark)
        if panel.remark.startswith("limit")
        else panel.remark,
    )


def _label(label: str, units: Units) -> tuple[float, str]:
    found = _UNIT.search(label)
    if found is None:
        return 1.0, label
    factor, unit = units.of(found[1].replace("²", "^2").replace("³", "^3"))
    return factor, label.replace(found[0], f"[{unit.replace('^2', '²').replace('^3', '³')}]")
