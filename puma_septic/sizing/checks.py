"""Every limit of a drive train held against what the cycle asks for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.limit_check import Kind, LimitCheck
from puma_septic.sizing.curves import torque_at_speed
from puma_septic.sizing.demands import Demands, Peak

__all__ = ["NotAssessed", "Outcome", "assess_joint"]

_SIEMENS: Final = "Siemens: SIMOVERT MASTERDRIVES MC compendium, p. 11-15"
_HARMONIC: Final = "Harmonic Drive: engineering data HFUS-2A, p. 19"
_HARMONIC_LIFE: Final = "Harmonic Drive: engineering data CSD-2A, p. 20"
_SHEET: Final = "data sheet"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class NotAssessed:
    """A check that could not be made, and why."""

    joint: str
    quantity: str
    reason: str


Outcome = LimitCheck | NotAssessed


def assess_joint(demands: Demands) -> tuple[Outcome, ...]:
    """All checks of one joint, made or not."""
    return tuple(outcome for check in _CHECKS if (outcome := check(demands)) is not None)


def _held(
    demands: Demands, quantity: str, peak: Peak, limit: float, *, unit: str, kind: Kind, source: str, needs: str
) -> Outcome:
    """A check, unless demand or limit is unknown."""
    if np.isnan(limit) or np.isnan(peak.size):
        return NotAssessed(joint=demands.load.joint, quantity=quantity, reason=f"needs {needs}")
    return LimitCheck.of_magnitude(
        joint=demands.load.joint,
        quantity=quantity,
        demand=peak.size,
        limit=limit,
        unit=unit,
        time=peak.time,
        kind=kind,
        source=source,
    )


def _mean(size: float) -> Peak:
    return Peak(size, np.nan)


def _joint_unit(demands: Demands) -> str:
    return "N" if demands.load.is_prismatic else "N m"


# ---- motor


def _effort(d: Demands) -> Outcome:
    peak = Peak(d.train.ratio * d.peak_torque.size, d.peak_torque.time)
    return _held(
        d, "actuator effort at the joint", peak, d.train.max_effort, unit=_joint_unit(d), kind="physics", source=_SHEET,
        needs="the effort limit of the whole actuator",
    )  # fmt: skip


def _motor_torque(d: Demands) -> Outcome:
    return _held(
        d, "motor torque", d.peak_torque, d.train.motor.peak_torque, unit="N m", kind="physics", source=_SHEET,
        needs="the motor's peak torque",
    )  # fmt: skip


def _rms_torque(d: Demands) -> Outcome:
    limit = d.train.motor.continuous_torque_at(d.mean_speed)
    return _held(
        d, "RMS motor torque at mean speed", _mean(d.rms_torque), limit, unit="N m", kind="vendor procedure",
        source=_SIEMENS, needs="the motor's continuous torque or S1 curve",
    )  # fmt: skip


def _torque_at_speed(d: Demands) -> Outcome:
    quantity, curve = "motor torque at speed", d.train.motor.peak_curve
    peak, limit = Peak(np.nan, np.nan), np.nan
    if len(curve) and not np.isnan(d.load.unbounded):
        peak, limit = d.peak_torque, float(curve[0, 1])
    elif len(curve):
        _, size, limit, time = torque_at_speed(d.motor, curve)
        peak = Peak(size, time)
    return _held(
        d, quantity, peak, limit, unit="N m", kind="vendor procedure", source=_SIEMENS,
        needs="the motor's peak torque over speed",
    )  # fmt: skip


def _voltage(d: Demands) -> Outcome:
    return _held(
        d, "voltage at torque and speed", d.peak_voltage, d.train.drive.bus_voltage, unit="V", kind="physics",
        source="equivalent direct-current motor", needs="torque constant, resistance and bus voltage",
    )  # fmt: skip


def _motor_speed(d: Demands) -> Outcome:
    return _held(
        d, "motor speed", d.peak_speed, d.train.motor.max_speed, unit="rad/s", kind="physics", source=_SHEET,
        needs="the motor's speed limit",
    )  # fmt: skip


def _motor_power(d: Demands) -> Outcome:
    return _held(
        d, "motor power", d.peak_power, d.train.motor.peak_power, unit="W", kind="physics", source=_SHEET,
        needs="the motor's peak power",
    )  # fmt: skip


def _inertia_ratio(d: Demands) -> Outcome:
    return _held(
        d, "inertia ratio", d.inertia_ratio, d.train.motor.max_inertia_ratio, unit="", kind="rule of thumb",
        source="recommendation of motor makers", needs="the motor's rotor inertia and recommended inertia ratio",
    )  # fmt: skip


def _winding(d: Demands) -> Outcome:
    """The rise over ambient, so that the utilisation does not depend on where the scale begins."""
    motor, quantity = d.train.motor, "winding temperature rise"
    if d.why_no_temperature:
        return NotAssessed(joint=d.load.joint, quantity=quantity, reason=d.why_no_temperature)
    limit = float(np.maximum(motor.max_winding_celsius - d.train.ambient_celsius, 0.0))
    nodes = "one node" if len(motor.thermal_resistances) == 1 else "two nodes"
    return _held(
        d, quantity, d.peak_temperature_rise, limit, unit="K", kind="physics", source=f"heat balance of {nodes}",
        needs="the winding's highest temperature",
    )  # fmt: skip


# ---- drive


def _peak_current(d: Demands) -> Outcome:
    return _held(
        d, "peak current", d.peak_current, d.train.drive.peak_current, unit="A", kind="physics", source=_SHEET,
        needs="torque constant and the drive's peak current",
    )  # fmt: skip


def _rms_current(d: Demands) -> Outcome:
    return _held(
        d, "RMS current", _mean(d.rms_current), d.train.drive.continuous_current, unit="A", kind="vendor procedure",
        source=_SIEMENS, needs="torque constant and the drive's continuous current",
    )  # fmt: skip


def _drawn_power(d: Demands) -> Outcome:
    return _held(
        d, "drawn electric power", d.peak_drawn_power, d.train.drive.peak_power, unit="W", kind="physics",
        source=_SHEET, needs="torque constant, resistance and the drive's peak power",
    )  # fmt: skip


def _mean_power(d: Demands) -> Outcome:
    mean = d.electric_energy[0] / d.load.duration if np.isnan(d.load.unbounded) else np.inf
    return _held(
        d, "mean drawn electric power", _mean(mean), d.train.drive.continuous_power, unit="W", kind="vendor procedure",
        source=_SHEET, needs="torque constant, resistance and the drive's continuous power",
    )  # fmt: skip


def _returned_power(d: Demands) -> Outcome:
    return _held(
        d, "returned electric power", d.peak_returned_power, d.train.drive.peak_regenerated_power, unit="W",
        kind="physics", source=_SHEET, needs="torque constant, resistance and the power that the drive can take back",
    )  # fmt: skip


def _stored_energy(d: Demands) -> Outcome | None:
    """Without a brake resistor all that comes back must find room on the bus."""
    if not np.isnan(d.train.drive.brake_resistor_power):
        return None
    return _held(
        d, "returned energy on the bus", _mean(d.regeneration.stored), d.train.drive.storable_energy, unit="J",
        kind="physics", source="energy balance of the bus",
        needs="torque constant, resistance and the energy that the bus can store",
    )  # fmt: skip


def _brake_resistor(d: Demands) -> Outcome:
    return _held(
        d, "mean brake-resistor power", _mean(d.regeneration.braked / d.load.duration),
        d.train.drive.brake_resistor_power, unit="W", kind="physics", source="energy balance of the bus",
        needs="torque constant, resistance and the brake resistor's power",
    )  # fmt: skip


# ---- gearbox


def _average_torque(d: Demands) -> Outcome:
    quantity, limit = "gearbox average torque", d.train.gearbox.max_average_torque
    if np.isnan(d.average_load_torque):
        return NotAssessed(joint=d.load.joint, quantity=quantity, reason="the joint never moves")
    return _held(
        d, quantity, _mean(d.average_load_torque), limit, unit=_joint_unit(d), kind="vendor procedure",
        source=_HARMONIC, needs="the gearbox's limit of the average torque",
    )  # fmt: skip


def _repeated_peak(d: Demands) -> Outcome:
    return _held(
        d, "gearbox repeated peak torque", d.peak_load_torque, d.train.gearbox.max_repeated_torque,
        unit=_joint_unit(d), kind="vendor procedure", source=_HARMONIC, needs="the gearbox's limit of repeated peaks",
    )  # fmt: skip


def _momentary_peak(d: Demands) -> Outcome:
    return _held(
        d, "gearbox momentary peak torque", _mean(d.train.momentary_torque), d.train.gearbox.max_momentary_torque,
        unit=_joint_unit(d), kind="vendor procedure", source=_HARMONIC,
        needs="the torque of a collision or emergency stop, and the gearbox's limit of momentary peaks",
    )  # fmt: skip


def _average_input_speed(d: Demands) -> Outcome:
    return _held(
        d, "gearbox average input speed", _mean(d.mean_speed), d.train.gearbox.max_average_input_speed, unit="rad/s",
        kind="vendor procedure", source=_HARMONIC, needs="the gearbox's limit of the average input speed",
    )  # fmt: skip


def _input_speed(d: Demands) -> Outcome:
    return _held(
        d, "gearbox input speed", d.peak_speed, d.train.gearbox.max_input_speed, unit="rad/s",
        kind="vendor procedure", source=_HARMONIC, needs="the gearbox's limit of the input speed",
    )  # fmt: skip


def _life(d: Demands) -> Outcome:
    """The life that is asked for is the demand, the expected one the limit."""
    return _held(
        d, "gearbox life", _mean(d.train.required_life_hours), d.expected_life_hours, unit="h", kind="vendor procedure",
        source=_HARMONIC_LIFE, needs="a required life, and the gearbox's rated life, torque and speed",
    )  # fmt: skip


_CHECKS: Final[tuple[Callable[[Demands], Outcome | None], ...]] = (
    _effort, _motor_torque, _rms_torque, _torque_at_speed, _voltage, _motor_speed, _motor_power, _winding,
    _inertia_ratio, _peak_current, _rms_current, _drawn_power, _mean_power, _returned_power, _stored_energy,
    _brake_resistor, _average_torque, _repeated_peak, _momentary_peak, _average_input_speed, _input_speed, _life,
)  # fmt: skip
