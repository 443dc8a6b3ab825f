"""Figures of comparisons, of the paper, of fronts and of limits."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from puma_septic.comparison import Comparison
from puma_septic.limits import MotionLimits
from puma_septic.optimisation import ParetoFront
from puma_septic.paper import PaperReport
from puma_septic.pictures.comparison import comparison_picture, front_picture
from puma_septic.pictures.limits import payload_picture
from puma_septic.pictures.paper import computing_times_picture
from puma_septic.plots._drawing import OnAxes, draw
from puma_septic.plots._motion import (
    plot_joints,
    plot_torque,
    plot_torque_split,
    plot_trajectory,
    plot_utilisation,
    plot_workspace,
)

__all__ = ["paper_figures", "plot_comparison", "plot_pareto_front", "plot_payload"]


def paper_figures(report: PaperReport) -> dict[str, Figure]:
    """Draw the paper's Figures 3 to 7, and the comparisons that it promises or leaves out.

    Returns
    -------
    dict of str to matplotlib.figure.Figure
        "figure_3" workspace; "figure_4" position, velocity and acceleration of the septic; "figure_5" of LSPB (the
        paper has its position only); "figure_6_7" computing times; "jerk", "torque", "limits" of septic, LSPB and
        three-segment quintic; "torque_split" of the septic; "comparison" of all three with the limits.

    Examples
    --------
    >>> from puma_septic.paper import reproduce
    >>> sorted(paper_figures(reproduce(runs=1)))[:4]
    ['comparison', 'figure_3', 'figure_4', 'figure_5']
    """
    evidence = report.evidence
    both = [evidence.septic, evidence.lspb]
    three = [*both, evidence.quintic]
    return {
        "figure_3": plot_workspace(both),
        "figure_4": plot_joints(evidence.septic, orders=(0, 1, 2)),
        "figure_5": plot_joints(evidence.lspb, orders=(0, 1, 2)),
        "figure_6_7": draw(computing_times_picture(report)),
        "jerk": plot_trajectory(evidence.trajectories, 3),
        "torque": plot_torque(three),
        "torque_split": plot_torque_split(evidence.septic),
        "comparison": plot_joints(three),
        "limits": plot_utilisation(three),
    }


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
