"""Kinematics: where the tool is, how it moves, and which joint positions put it somewhere."""

from puma_septic.kinematics._chain import chain_to, checked_joint_values
from puma_septic.kinematics._closed_form import has_closed_form, is_puma
from puma_septic.kinematics._forward import (
    LowestPoints,
    ToolMotion,
    forward_kinematics,
    height_parts,
    heights,
    jacobian,
    lowest_points,
    tool_derivatives,
    tool_motion,
)
from puma_septic.kinematics._inverse import (
    IkBatch,
    IkSolutions,
    inverse_kinematics,
    inverse_kinematics_batch,
    rtb_names,
)
from puma_septic.kinematics._poses import checked_poses, pose_errors
from puma_septic.kinematics._puma_branches import CONFIGURATIONS
from puma_septic.kinematics._singularity import (
    manipulability,
    singularity_distances,
    singularity_names,
    singularity_zeros,
)

__all__ = [
    "CONFIGURATIONS",
    "IkBatch",
    "IkSolutions",
    "LowestPoints",
    "ToolMotion",
    "chain_to",
    "checked_joint_values",
    "checked_poses",
    "forward_kinematics",
    "has_closed_form",
    "height_parts",
    "heights",
    "inverse_kinematics",
    "inverse_kinematics_batch",
    "is_puma",
    "jacobian",
    "lowest_points",
    "manipulability",
    "pose_errors",
    "rtb_names",
    "singularity_distances",
    "singularity_names",
    "singularity_zeros",
    "tool_derivatives",
    "tool_motion",
]
