"""Figures of comparisons, of fronts and of limits."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from puma_septic.comparison import Comparison
from puma_septic.limits import MotionLimits
from puma_septic.optimisation import ParetoFront
from puma_septic.pictures.comparison import comparison_picture
from puma_septic.pictures.front import front_picture
from puma_septic.pictures.limits import payload_picture
from puma_septic.plots._drawing import OnAxes, draw

__all__ = ["plot_comparison", "plot_pareto_front", "plot_payload"]


def plot_comparison(comparison: Comparison, *, ax: OnAxes | None = None) -> Figure:
    """Draw one panel per quantity, one bar per profile; Pareto-optimal profiles are coloured.

    Bars are the largest value among the joints (sums for integral and energy). A bar that would flatten the others is
    cut; unbounded values say so.

    Parameters
    ----------
    comparison : Comparison
    ax : sequence of matplotlib Axes, optional
        Where to draw, eight; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For another number of axes.
    """
    return draw(comparison_picture(comparison), ax=ax)


def plot_pareto_front(front: ParetoFront, *, ax: OnAxes | None = None) -> Figure:
    """Draw the front, one panel for each pair of objectives, and the via times along it.

    Parameters
    ----------
    front : ParetoFront
    ax : sequence of matplotlib Axes, optional
        Where to draw: one for each pair, and one for the times; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For another number of axes.
    """
    return draw(front_picture(front), ax=ax)


def plot_payload(found: Sequence[MotionLimits], *, ax: OnAxes | None = None) -> Figure:
    """Draw the largest payload of some motions over their duration.

    Parameters
    ----------
    found : sequence of MotionLimits
        From `motion_limits`.
    ax : sequence of matplotlib Axes, optional
        Where to draw, one; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For another number of axes.
    """
    return draw(payload_picture(found, [one.motion.trajectory.profile for one in found]), ax=ax)
