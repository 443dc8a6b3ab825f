"""May this planned trajectory go to the robot: a verdict with reasons, and the least stretch that makes it hold."""

from puma_septic.gate._checking import START_TOLERANCE, TrajectoryCheck, check_trajectory
from puma_septic.gate._reasons import ALLOWABLE, REASON_CODES, VERDICTS, Reason, checked_allowances
from puma_septic.gate._stretching import Fixed, Stretch, fixed, least_stretch

__all__ = [
    "ALLOWABLE",
    "REASON_CODES",
    "START_TOLERANCE",
    "VERDICTS",
    "Fixed",
    "Reason",
    "Stretch",
    "TrajectoryCheck",
    "check_trajectory",
    "checked_allowances",
    "fixed",
    "least_stretch",
]
