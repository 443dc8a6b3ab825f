"""Kinematics: where the tool is, how it moves, and which joint positions put it somewhere."""

from puma_septic.kinematics.forward import ToolMotion, forward_kinematics, jacobian, tool_motion

__all__ = ["ToolMotion", "forward_kinematics", "jacobian", "tool_motion"]
