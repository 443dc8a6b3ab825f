"""Motors and gearboxes checked against a duty cycle: strong enough, and by how much."""

from puma_septic.sizing._bearing import BearingLoad, bearing_life, bearing_load, equivalent_load
from puma_septic.sizing._candidates import Candidate
from puma_septic.sizing._compliance import Compliance, compliance
from puma_septic.sizing._conditions import Conditions
from puma_septic.sizing._demands import Demands, Peak
from puma_septic.sizing._drive_masses import select_consistent, with_drive_masses
from puma_septic.sizing._front import ArmChoice, front_document
from puma_septic.sizing._gearbox import allowed_momentary_peaks, average_torque
from puma_septic.sizing._joint_selection import JointSelection
from puma_septic.sizing._load_cases import LoadCase
from puma_septic.sizing._load_profiles import LoadProfile, MotorLoadProfile
from puma_septic.sizing._loads import JointLoad, MotorLoad, gearbox_load, joint_load, motor_load
from puma_septic.sizing._ratios import LoadMoments, RatioWindow, accelerating_factor, load_moments, ratio_window
from puma_septic.sizing._reserves import Reserve, largest_payload, least_cycle_time
from puma_septic.sizing._result import Sizing
from puma_septic.sizing._selection import Selection
from puma_septic.sizing._size import size
from puma_septic.sizing._supply import SupplyLoad, supply_load
from puma_septic.sizing._task_cases import conditions_of, cycle_case, load_cases_of
from puma_septic.sizing._thermal import overload_time
from puma_septic.sizing._torque_speed import torque_at_speed

__all__ = [
    "ArmChoice",
    "BearingLoad",
    "Candidate",
    "Compliance",
    "Conditions",
    "Demands",
    "JointLoad",
    "JointSelection",
    "LoadCase",
    "LoadMoments",
    "LoadProfile",
    "MotorLoad",
    "MotorLoadProfile",
    "Peak",
    "RatioWindow",
    "Reserve",
    "Selection",
    "Sizing",
    "SupplyLoad",
    "accelerating_factor",
    "allowed_momentary_peaks",
    "average_torque",
    "bearing_life",
    "bearing_load",
    "compliance",
    "conditions_of",
    "cycle_case",
    "equivalent_load",
    "front_document",
    "gearbox_load",
    "joint_load",
    "largest_payload",
    "least_cycle_time",
    "load_cases_of",
    "load_moments",
    "motor_load",
    "overload_time",
    "ratio_window",
    "select_consistent",
    "size",
    "supply_load",
    "torque_at_speed",
    "with_drive_masses",
]
