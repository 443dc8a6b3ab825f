"""The paper's figures, redrawn, and those that it leaves out."""

from __future__ import annotations

from matplotlib.figure import Figure

from puma_septic.paper import PaperReport
from puma_septic.plots.joints import plot_joints, plot_trajectory
from puma_septic.plots.style import colour_of, new_figure, titled
from puma_septic.plots.torque import plot_torque, plot_torque_split
from puma_septic.plots.utilisation import plot_utilisation
from puma_septic.plots.workspace import plot_workspace

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
        "figure_6_7": _plot_computing_times(report),
        "jerk": plot_trajectory(evidence.trajectories, 3),
        "torque": plot_torque(three),
        "torque_split": plot_torque_split(evidence.septic),
        "comparison": plot_joints(three),
        "limits": plot_utilisation(three),
    }


def _plot_computing_times(report: PaperReport) -> Figure:
    """As measured here beside the paper's; they differ by three powers of ten, so each has its own scale."""
    inputs, computing = report.evidence.inputs, report.evidence.computing
    figure = new_figure(2.2)
    here, paper = figure.subplots(1, 2)
    bars = (
        (here, 1e6, "µs", computing.septic, computing.lspb, f"here, median of {computing.runs} runs"),
        (paper, 1.0, "s", inputs.septic_seconds, inputs.lspb_seconds, "paper, one run with printing and plotting"),
    )
    for panel, scale, unit, septic, lspb, title in bars:
        panel.barh(["septic", "lspb"], [scale * septic, scale * lspb], 0.6, color=[colour_of(0), colour_of(1)])
        titled(panel, title)
        panel.grid(True, axis="x", color="0.9", linewidth=0.6)
        panel.set_axisbelow(True)
        panel.invert_yaxis()
        panel.tick_params(labelsize=7.5)
        panel.set_xlabel(f"computing time [{unit}]", fontsize=8)
        panel.margins(x=0.1)
    return figure
