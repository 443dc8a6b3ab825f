"""How much of each limit is used."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MultipleLocator

from puma_septic.assessment import Assessment
from puma_septic.plots.style import (
    LIMIT,
    as_group,
    colour_of,
    new_figure,
    place_legend,
    tidy,
    titled,
    unique_labels,
)
from puma_septic.quantities import COMMON, QUANTITIES

__all__ = ["plot_utilisation"]

# Bars beyond this are cut and their number is written at the edge, %.
_CUT: Final = 200.0


def plot_utilisation(assessment: Assessment | Sequence[Assessment], *, labels: Sequence[str] | None = None) -> Figure:
    """Draw each demand as a bar in per cent of its limit; beyond the line at 100 % the limit is broken.

    For positions, 100 % is the end of the range and 0 % its middle. A limit that is not known says so.

    Parameters
    ----------
    assessment : Assessment or sequence of Assessment
        Of arms with the same number of joints.
    labels : sequence of str, optional
        Legend entries; the profiles' names by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For no assessment, or arms with different numbers of joints.
    """
    group = as_group(assessment, Assessment, lambda one: one.motion.robot.n_joints)
    names = unique_labels([one.motion.trajectory.profile for one in group], labels)
    checks = [check for one in group for check in one.checks]
    shown = [quantity for quantity in QUANTITIES if any(check.quantity == quantity for check in checks)]
    # An infinite acceleration or torque breaks a limit that is not known, too.
    known = {check.quantity for check in checks if not np.isnan(check.limit)}
    unknown = [quantity for quantity in COMMON if quantity not in known]
    joints = group[0].motion.robot.joint_names
    figure = new_figure(1.0 + 0.16 * len(joints) * (len(group) + 1))
    panels = figure.subplots(1, max(1, len(shown)), sharey=True, squeeze=False)[0]
    for panel, quantity in zip(panels, shown, strict=False):
        titled(panel, "torque" if quantity == "effort" else quantity)
        _draw_bars(panel, group, quantity)
    for panel in panels:
        tidy(panel, x="used of the limit [%]")
        panel.xaxis.set_major_locator(MultipleLocator(50.0))
        panel.set_yticks(range(len(joints)), joints, parse_math=False)
        panel.set_ylim(len(joints) - 0.4, -0.6)
        panel.axvline(100.0, **LIMIT)
    handles: list[Patch | Line2D] = [Patch(color=colour_of(k), label=name) for k, name in enumerate(names)]
    handles.append(Line2D([], [], label="limit", **LIMIT))
    place_legend(figure, handles)
    if unknown:
        figure.supxlabel(f"not assessed, for want of a known limit: {', '.join(unknown)}", fontsize=8, color="0.25")
    return figure


def _draw_bars(panel: Axes, group: Sequence[Assessment], quantity: str) -> None:
    thick = 0.8 / len(group)
    widest = 100.0
    for k, one in enumerate(group):
        joints = one.motion.robot.joint_names
        used, broken = np.full(len(joints), np.nan), np.zeros(len(joints), dtype=bool)
        for check in one.checks:
            if check.quantity == quantity:
                j = joints.index(check.joint)
                used[j], broken[j] = 100.0 * check.utilisation, check.is_violated
        where = np.arange(len(joints)) - 0.4 + (k + 0.5) * thick
        panel.barh(where, np.minimum(np.nan_to_num(used), _CUT), 0.9 * thick, color=colour_of(k))
        widest = max(widest, min(_CUT, np.nanmax(np.append(used, 0.0))))
        for y, percent, is_broken in zip(where, used, broken, strict=True):
            text = "not known" if np.isnan(percent) else "unbounded" if np.isinf(percent) else f"{percent:.0f}"
            panel.annotate(
                text + ("!" if is_broken else ""),
                (min(np.nan_to_num(percent), _CUT), y),
                (2, 0),
                textcoords="offset points",
                va="center",
                fontsize=6.5,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6},
            )
    panel.set_xlim(0.0, 1.35 * widest)
