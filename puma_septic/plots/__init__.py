"""Figures for notebooks and reports: matplotlib figures, returned, never shown or saved.

Colours are Okabe and Ito's, told apart by colour-blind readers. Every axis has its unit; steps stay steps.
"""

from puma_septic.plots.comparison import plot_comparison, plot_pareto_front
from puma_septic.plots.joints import plot_joints, plot_trajectory
from puma_septic.plots.paper import paper_figures
from puma_septic.plots.sizing import (
    plot_ratio_sweep,
    plot_sizing_torque_split,
    plot_sizing_utilisation,
    plot_torque_speed,
    plot_winding_temperature,
)
from puma_septic.plots.torque import plot_torque, plot_torque_split
from puma_septic.plots.utilisation import plot_utilisation
from puma_septic.plots.workspace import plot_workspace

__all__ = [
    "paper_figures",
    "plot_comparison",
    "plot_joints",
    "plot_pareto_front",
    "plot_ratio_sweep",
    "plot_sizing_torque_split",
    "plot_sizing_utilisation",
    "plot_torque",
    "plot_torque_speed",
    "plot_torque_split",
    "plot_trajectory",
    "plot_utilisation",
    "plot_winding_temperature",
    "plot_workspace",
]
