"""Paths of the tool: lines, arcs and rounded polylines, and the joint motion that follows them."""

from puma_septic.paths._curves import arc, circle, line
from puma_septic.paths._joint_path import JointPath, follow
from puma_septic.paths._move import at_speed, in_time, timed, tool_move
from puma_septic.paths._path import Path
from puma_septic.paths._polyline import polyline
from puma_septic.paths._tool import TOOL, TOOL_QUANTITIES, ToolLimits, ToolRates, tool_rates

__all__ = [
    "TOOL",
    "TOOL_QUANTITIES",
    "JointPath",
    "Path",
    "ToolLimits",
    "ToolRates",
    "arc",
    "at_speed",
    "circle",
    "follow",
    "in_time",
    "line",
    "polyline",
    "timed",
    "tool_move",
    "tool_rates",
]
