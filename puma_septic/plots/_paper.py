"""The paper's figures, redrawn, and those that it leaves out."""

from __future__ import annotations

from matplotlib.figure import Figure

from puma_septic.paper import PaperReport
from puma_septic.pictures.paper import computing_times_picture
from puma_septic.plots._drawing import draw
from puma_septic.plots._motion import (
    plot_joints,
    plot_torque,
    plot_torque_split,
    plot_trajectory,
    plot_utilisation,
    plot_workspace,
)

__all__ = ["paper_figures"]


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
