"""Kinematics: where the tool is, how it moves, and which joint positions put it somewhere."""

from puma_septic.kinematics.forward import ToolMotion, forward_kinematics, jacobian, tool_motion
from puma_septic.kinematics.inverse import (
    IkBatch,
    IkSolutions,
    inverse_kinematics,
    inverse_kinematics_batch,
    rtb_names,
)

__all__ = [
    "IkBatch",
    "IkSolutions",
    "ToolMotion",
    "forward_kinematics",
    "inverse_kinematics",
    "inverse_kinematics_batch",
    "jacobian",
    "rtb_names",
    "tool_motion",
]
