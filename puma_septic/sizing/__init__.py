"""Motors and gearboxes checked against a duty cycle: strong enough, and by how much."""

from puma_septic.sizing.asking import size
from puma_septic.sizing.choosing import Selection
from puma_septic.sizing.coupling import select_consistent, with_drive_masses
from puma_septic.sizing.demands import Demands, Peak
from puma_septic.sizing.gearbox import allowed_momentary_peaks, average_torque
from puma_septic.sizing.loads import JointLoad, MotorLoad, joint_load, motor_load
from puma_septic.sizing.ratios import LoadMoments, RatioWindow, accelerating_factor, load_moments, ratio_window
from puma_septic.sizing.result import MotorLoadProfile, Sizing
from puma_septic.sizing.selection import Candidate, JointSelection
from puma_septic.sizing.thermal import overload_time

__all__ = [
    "Candidate",
    "Demands",
    "JointLoad",
    "JointSelection",
    "LoadMoments",
    "MotorLoad",
    "MotorLoadProfile",
    "Peak",
    "RatioWindow",
    "Selection",
    "Sizing",
    "accelerating_factor",
    "allowed_momentary_peaks",
    "average_torque",
    "joint_load",
    "load_moments",
    "motor_load",
    "overload_time",
    "ratio_window",
    "select_consistent",
    "size",
    "with_drive_masses",
]
