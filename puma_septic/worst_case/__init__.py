"""The worst case over a box of poses, certified: what holding takes, and what acceleration the torque limits allow."""

from puma_septic.worst_case._accelerations import QUANTILES, AccelerationLimits, acceleration_limits
from puma_septic.worst_case._holding import WorstHolding, holding_poses, worst_holding_torque
from puma_septic.worst_case._region import checked_region

__all__ = [
    "QUANTILES",
    "AccelerationLimits",
    "WorstHolding",
    "acceleration_limits",
    "checked_region",
    "holding_poses",
    "worst_holding_torque",
]
