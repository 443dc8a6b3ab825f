"""What the checks of a drive train leave out, or take for granted, because no sheet tells it."""

from __future__ import annotations

import numpy as np

from puma_septic.sizing._demands import Demands

__all__ = ["unknowns"]


def unknowns(demands: Demands) -> tuple[str, ...]:
    """A line for each value that is not known and whose check is made all the same, as it must not win unseen.

    Returns
    -------
    tuple of str
    """
    lines = [f"unknown and left out of the torque: {what}" for what in demands.train.left_out]
    return (*lines, *_of_continuous_torque(demands), *_of_winding(demands), *_of_gears(demands))


def _of_continuous_torque(demands: Demands) -> list[str]:
    train, motor = demands.train, demands.train.motor
    if np.isnan(demands.continuous_torque):
        return []
    lines = []
    if np.isnan(motor.rated_ambient_celsius):
        lines.append("unknown and taken as 40 degrees Celsius: the ambient of the motor's continuous torque")
    if np.isnan(motor.geared_share) and train.ratio != 1:
        lines.append("unknown and left out of the continuous torque: what a gearbox at the flange takes off it")
    return lines


def _of_winding(demands: Demands) -> list[str]:
    motor, drive = demands.train.motor, demands.train.drive
    if not demands.electric.is_known:
        return []
    lines = []
    is_synchronous = motor.current != "dc" or not np.isnan([motor.pole_pairs, motor.inductance]).all()
    if is_synchronous and np.isnan(motor.pole_pairs * motor.inductance):
        lines.append("unknown and left out of the voltage: the winding's reactance (pole pairs and inductance)")
    if demands.why_no_temperature:
        lines.append("unknown and taken as its sheet's: the winding's temperature, in voltage and power")
    weakens = demands.electric.weakens_field
    if weakens and np.isnan(drive.bus_voltage):
        lines.append("unknown and left out of the current: what weakens the field (at an unknown bus voltage)")
    elif weakens and np.isnan(motor.max_winding_celsius):
        lines.append("unknown and taken as its sheet's: the winding's highest temperature, in the field's current")
    return lines


def _of_gears(demands: Demands) -> list[str]:
    train, gearbox = demands.train, demands.train.gearbox
    limits = (gearbox.max_average_torque, gearbox.max_repeated_torque, gearbox.rated_life_hours)
    lines = []
    if not gearbox.kind and train.ratio != 1 and not np.isnan(limits).all():
        lines.append("unknown and taken as strain wave: the kind of the gears, whose rules their limits follow")
    if not gearbox.life_basis and not np.isnan(train.required_life_hours * gearbox.rated_life_hours):
        lines.append("unknown and taken as L10: the basis of the gears' rated life")
    return lines
