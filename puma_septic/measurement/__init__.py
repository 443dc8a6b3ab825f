"""What recorded motions tell of torque: how well they determine it, and how it compares with what was measured."""

from puma_septic.measurement._band import TorqueBand, limit_doubts, torque_band
from puma_septic.measurement._measured import MeasuredTorque, Proposal, compare_measured

__all__ = [
    "MeasuredTorque",
    "Proposal",
    "TorqueBand",
    "compare_measured",
    "limit_doubts",
    "torque_band",
]
