"""Figures for notebooks and reports: matplotlib figures, returned, never shown or saved.

Each draws a picture that `puma_septic.pictures` describes, or several on axes of yours (`ax=`). Colours are Okabe and
Ito's, told apart by colour-blind readers, one a profile. Every axis has its unit; steps stay steps.
"""

from puma_septic.plots._comparison import paper_figures, plot_comparison, plot_pareto_front, plot_payload
from puma_septic.plots._drawing import draw
from puma_septic.plots._execution import plot_residual_vibration, plot_stops, plot_tracking
from puma_septic.plots._motion import (
    plot_joints,
    plot_tool,
    plot_torque,
    plot_torque_split,
    plot_torque_velocity,
    plot_trajectory,
    plot_utilisation,
    plot_workspace,
)
from puma_septic.plots._sizing import (
    plot_arm_front,
    plot_ratio_sweep,
    plot_sizing_torque_split,
    plot_sizing_utilisation,
    plot_torque_speed,
    plot_winding_temperature,
)

__all__ = [
    "draw",
    "paper_figures",
    "plot_arm_front",
    "plot_comparison",
    "plot_joints",
    "plot_pareto_front",
    "plot_payload",
    "plot_ratio_sweep",
    "plot_residual_vibration",
    "plot_sizing_torque_split",
    "plot_sizing_utilisation",
    "plot_stops",
    "plot_tool",
    "plot_torque",
    "plot_torque_speed",
    "plot_torque_split",
    "plot_torque_velocity",
    "plot_tracking",
    "plot_trajectory",
    "plot_utilisation",
    "plot_winding_temperature",
    "plot_workspace",
]
