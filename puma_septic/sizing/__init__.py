"""Motors and gearboxes held against a duty cycle: strong enough, and by how much."""

from puma_septic.sizing.demands import Demands, Peak
from puma_septic.sizing.gearbox import allowed_momentary_peaks, average_torque
from puma_septic.sizing.loads import JointLoad, MotorLoad, joint_load, motor_load
from puma_septic.sizing.outcome import SizingCheck
from puma_septic.sizing.ratios import LoadMoments, RatioWindow, accelerating_factor, load_moments, ratio_window
from puma_septic.sizing.result import MotorLoadProfile, Sizing, size
from puma_septic.sizing.thermal import overload_time

__all__ = [
    "Demands",
    "JointLoad",
    "LoadMoments",
    "MotorLoad",
    "MotorLoadProfile",
    "Peak",
    "RatioWindow",
    "Sizing",
    "SizingCheck",
    "accelerating_factor",
    "allowed_momentary_peaks",
    "average_torque",
    "joint_load",
    "load_moments",
    "motor_load",
    "overload_time",
    "ratio_window",
    "size",
]
