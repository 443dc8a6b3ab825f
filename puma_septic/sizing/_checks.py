"""The limits of a drive train, a row each: what holds one drive train to it, and many at once within bounds."""

from __future__ import annotations

from collections.abc import Callable, Container
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.drives import Drive, Drivetrain, Gearbox, LinearStage, Motor
from puma_septic.limit_check import Kind, LimitCheck
from puma_septic.sizing._bounds import Bounds, utilisation
from puma_septic.sizing._demands import Demands, Peak
from puma_septic.sizing._load_features import LoadGrid
from puma_septic.sizing._pair_demands import PairDemands, PeakBounds
from puma_septic.sizing._pair_features import PairTable
from puma_septic.validation import Array

__all__ = [
    "DRIVE_LIMITS",
    "DriveLimit",
    "NotAssessed",
    "Outcome",
    "assess_joint",
    "utilisation_bounds",
]

_SIEMENS: Final = "Siemens: SIMOVERT MASTERDRIVES MC compendium, p. 11-15"
_HARMONIC: Final = "Harmonic Drive: engineering data HFUS-2A, p. 19"
_BEARING: Final = "Harmonic Drive: FHA manual, Verifying loads; CHA manual 1018854, p. 70"
_BRAKE: Final = "NORD: project planning, braking work W_B"
_SHEET: Final = "data sheet"
_PARTS: Final = {"train": Drivetrain, "motor": Motor, "gearbox": Gearbox, "drive": Drive, "stage": LinearStage}
# The unit of a torque at the joint: N where that slides.
_JOINT: Final = "N m at the joint"
# The same at the gearbox's output.
_OUTPUT: Final = "N m at the gearbox"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class NotAssessed:
    """A check that could not be made, and why."""

    joint: str
    quantity: str
    reason: str


Outcome = LimitCheck | NotAssessed


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DriveLimit:
    """A limit of a drive train, with what is checked against it.

    Attributes
    ----------
    quantity : str
        What readers call the check, and its key.
    demand : str
        A property of `Demands`, and of `PairDemands` its bounds.
    limit : str
        A value of a part, "motor.max_speed", or a property of both.
    unit : str
    kind : {"physics", "vendor procedure", "rule of thumb"}
        A rule of thumb rejects nothing, and so needs no bounds.
    source : str or callable
        Where the limit or its rule comes from, of `Demands` where that depends on them.
    needs : str
        What must be known.
    why : str
        A property of `Demands` that tells why there is no demand.
    unless : str
        A value of a part; where it is known the limit does not apply.
    asked : str
        A value of a part, or a property of both; where it is not known the limit is not asked for, and not listed.

    Raises
    ------
    TypeError
        For a demand or a limit that does not exist both for one drive train and for many.
    """

    quantity: str
    demand: str
    limit: str
    unit: str
    kind: Kind
    source: str | Callable[[Demands], str] = _SHEET
    needs: str
    why: str = ""
    unless: str = ""
    asked: str = ""

    def __post_init__(self) -> None:
        homes = [Demands] if self.kind == "rule of thumb" else [Demands, PairDemands]
        for name in (self.demand, self.limit, *filter(None, [self.unless, self.asked])):
            part, _, field = name.rpartition(".")
            for home in [_PARTS[part]] if part else homes:
                if not hasattr(home, field):
                    raise TypeError(f"check {self.quantity!r}: {home.__name__} has no {field!r}")

    def outcome(self, demands: Demands) -> Outcome | None:
        """One drive train held to it; None where it does not apply.

        Returns
        -------
        LimitCheck, NotAssessed or None
        """
        joint = demands.load.joint
        if self.unless and not np.isnan(_value(demands, self.unless)):
            return None
        if self.asked and np.isnan(_value(demands, self.asked)):
            return None
        if self.why and (reason := getattr(demands, self.why)):
            return NotAssessed(joint=joint, quantity=self.quantity, reason=reason)
        limit = _value(demands, self.limit)
        demand = Peak(np.nan, np.nan) if np.isnan(limit) else getattr(demands, self.demand)
        peak = demand if isinstance(demand, Peak) else Peak(demand, np.nan)
        if np.isnan(peak.size):
            return NotAssessed(joint=joint, quantity=self.quantity, reason=f"needs {self.needs}")
        unit = self._unit(demands)
        return LimitCheck.of_magnitude(
            joint=joint,
            quantity=self.quantity,
            demand=peak.size,
            limit=limit,
            unit=unit,
            time=peak.time,
            kind=self.kind,
            source=self.source if isinstance(self.source, str) else self.source(demands),
        )

    def _unit(self, demands: Demands) -> str:
        slides = demands.load.is_prismatic or (self.unit == _JOINT and demands.load.slide is not None)
        return ("N" if slides else "N m") if self.unit in (_JOINT, _OUTPUT) else self.unit

    def bounds(self, demands: PairDemands) -> Bounds:
        """Utilisation by many drive trains at once; NaN where it is not assessed.

        Returns
        -------
        Bounds
        """
        asked = _values(demands, self.asked) if self.asked else np.zeros(len(demands.table.ratio))
        if np.isnan(asked).all():
            return asked, asked
        limit = np.where(np.isnan(asked), np.nan, _values(demands, self.limit))
        if np.isnan(limit).all():
            return limit, limit
        if self.unless:
            limit = np.where(np.isnan(_values(demands, self.unless)), limit, np.nan)
        return utilisation(getattr(demands, self.demand), limit, demands.table)


def _value(demands: Demands, name: str) -> float:
    part, _, field = name.rpartition(".")
    home = demands if not part else demands.train if part == "train" else getattr(demands.train, part)
    return np.nan if home is None else float(getattr(home, field))


def _values(demands: PairDemands, name: str) -> Array:
    part, _, field = name.rpartition(".")
    if part == "train":
        return np.full(len(demands.table.ratio), getattr(demands.table.place, field))
    return demands.limit(part, field) if part else np.asarray(getattr(demands, field))


def _heat_balance(demands: Demands) -> str:
    return f"heat balance of {'one node' if len(demands.train.motor.thermal_resistances) == 1 else 'two nodes'}"


DRIVE_LIMITS: Final = (
    DriveLimit(
        quantity="actuator effort at the joint", demand="peak_effort", limit="max_effort", unit=_JOINT, kind="physics",
        needs="the effort limit of the whole actuator",
    ),
    DriveLimit(
        quantity="motor torque", demand="peak_torque", limit="motor.peak_torque", unit="N m", kind="physics",
        needs="the motor's peak torque",
    ),
    DriveLimit(
        quantity="RMS motor torque at mean speed", demand="rms_torque", limit="continuous_torque", unit="N m",
        kind="vendor procedure", source=_SIEMENS, needs="the motor's continuous torque or S1 curve",
    ),
    DriveLimit(
        quantity="motor torque at speed", demand="torque_at_speed", limit="torque_at_speed_limit", unit="N m",
        kind="vendor procedure", source=_SIEMENS, needs="the motor's peak torque over speed",
    ),
    DriveLimit(
        quantity="voltage at torque and speed", demand="peak_voltage", limit="drive.bus_voltage", unit="V",
        kind="physics", source="equivalent direct-current motor", needs="torque constant, resistance and bus voltage",
    ),
    DriveLimit(
        quantity="motor speed", demand="peak_speed", limit="motor.max_speed", unit="rad/s", kind="physics",
        needs="the motor's speed limit",
    ),
    DriveLimit(
        quantity="motor power", demand="peak_power", limit="motor.peak_power", unit="W", kind="physics",
        needs="the motor's peak power",
    ),
    DriveLimit(
        quantity="winding temperature rise", demand="peak_temperature_rise", limit="max_temperature_rise", unit="K",
        kind="physics", source=_heat_balance, needs="the winding's highest temperature", why="why_no_temperature",
    ),
    # Without time constants the resistances still tell a lower bound, which can reject.
    DriveLimit(
        quantity="mean winding temperature rise", demand="mean_temperature_rise", limit="max_temperature_rise",
        unit="K", kind="physics", source="heat balance, at least", asked="bare_thermal_resistance",
        needs="torque constant, resistance and the winding's highest temperature",
    ),
    DriveLimit(
        quantity="inertia ratio", demand="inertia_ratio", limit="motor.max_inertia_ratio", unit="",
        kind="rule of thumb", source="recommendation of motor makers",
        needs="the motor's rotor inertia and recommended inertia ratio",
    ),
    DriveLimit(
        quantity="load inertia over rotor inertia", demand="load_inertia_ratio", limit="max_inertia_ratio", unit="",
        kind="vendor procedure", source="condition; counted as Yaskawa, Sigma-V manual E-V-MD, p. 2-5",
        needs="the motor's rotor inertia and a limit that rejects", asked="max_inertia_ratio",
    ),
    DriveLimit(
        quantity="peak current", demand="peak_current", limit="drive.peak_current", unit="A", kind="physics",
        needs="torque constant and the drive's peak current",
    ),
    DriveLimit(
        quantity="RMS current", demand="rms_current", limit="drive.continuous_current", unit="A",
        kind="vendor procedure", source=_SIEMENS, needs="torque constant and the drive's continuous current",
    ),
    DriveLimit(
        quantity="drawn electric power", demand="peak_drawn_power", limit="drive.peak_power", unit="W", kind="physics",
        needs="torque constant, resistance and the drive's peak power",
    ),
    DriveLimit(
        quantity="mean drawn electric power", demand="mean_drawn_power", limit="drive.continuous_power", unit="W",
        kind="vendor procedure", needs="torque constant, resistance and the drive's continuous power",
    ),
    DriveLimit(
        quantity="returned electric power", demand="peak_returned_power", limit="drive.peak_regenerated_power",
        unit="W", kind="physics", needs="torque constant, resistance and the power that the drive can take back",
    ),
    # Without a brake resistor all that comes back must find room on the bus.
    DriveLimit(
        quantity="returned energy on the bus", demand="stored_energy", limit="drive.storable_energy", unit="J",
        kind="physics", source="energy balance of the bus", unless="drive.brake_resistor_power",
        needs="torque constant, resistance and the energy that the bus can store",
    ),
    DriveLimit(
        quantity="mean brake-resistor power", demand="mean_braked_power", limit="drive.brake_resistor_power", unit="W",
        kind="physics", source="energy balance of the bus",
        needs="torque constant, resistance and the brake resistor's power",
    ),
    DriveLimit(
        quantity="stage force", demand="peak_force", limit="stage.max_force", unit="N", kind="physics",
        needs="the stage's largest force", asked="stage.travel_per_turn",
    ),
    DriveLimit(
        quantity="stage speed", demand="peak_stage_speed", limit="stage.max_speed", unit="rad/s", kind="physics",
        needs="the stage's highest speed", asked="stage.travel_per_turn",
    ),
    DriveLimit(
        quantity="gearbox average torque", demand="average_load_torque", limit="gearbox.max_average_torque",
        unit=_OUTPUT, kind="vendor procedure", source=lambda d: d.gear_rule.average, why="why_no_average",
        needs="the gearbox's limit of the average torque",
    ),
    DriveLimit(
        quantity="gearbox repeated peak torque", demand="repeated_torque", limit="gearbox.max_repeated_torque",
        unit=_OUTPUT, kind="vendor procedure", source=lambda d: d.gear_rule.peaks,
        needs="the gearbox's limit of repeated peaks", why="why_no_repeated_torque",
    ),
    DriveLimit(
        quantity="gearbox momentary peak torque", demand="momentary_torque", limit="gearbox.max_momentary_torque",
        unit=_OUTPUT, kind="vendor procedure", source=lambda d: d.gear_rule.peaks,
        needs="the torque of a collision or emergency stop, and the gearbox's limit of momentary peaks",
    ),
    DriveLimit(
        quantity="gearbox momentary peaks", demand="emergency_stops", limit="allowed_emergency_stops", unit="",
        kind="vendor procedure", source=lambda d: d.gear_rule.peaks, asked="train.emergency_stops",
        needs="how many momentary peaks the gearbox bears: its kind, or how long one lasts",
    ),
    DriveLimit(
        quantity="gearbox average input speed", demand="mean_speed", limit="gearbox.max_average_input_speed",
        unit="rad/s", kind="vendor procedure", source=_HARMONIC,
        needs="the gearbox's limit of the average input speed",
    ),
    DriveLimit(
        quantity="gearbox input speed", demand="peak_speed", limit="gearbox.max_input_speed", unit="rad/s",
        kind="vendor procedure", source=_HARMONIC, needs="the gearbox's limit of the input speed",
    ),
    # The life that is asked for is the demand, the expected one the limit.
    DriveLimit(
        quantity="gearbox life", demand="required_life_hours", limit="assured_life_hours", unit="h",
        kind="vendor procedure", source=lambda d: d.gear_rule.life,
        needs="a required life, and the gearbox's rated life, torque and speed",
    ),
    DriveLimit(
        quantity="output bearing tilting moment", demand="peak_tilting_moment", limit="gearbox.max_tilting_moment",
        unit="N m", kind="vendor procedure", source=_BEARING, needs="the gearbox's limit of the tilting moment",
        why="why_no_bearing",
    ),
    DriveLimit(
        quantity="output bearing axial force", demand="peak_axial_force", limit="gearbox.max_axial_force", unit="N",
        kind="vendor procedure", source=_BEARING, needs="the gearbox's limit of the axial force", why="why_no_bearing",
    ),
    DriveLimit(
        quantity="output bearing radial force", demand="peak_radial_force", limit="gearbox.max_radial_force", unit="N",
        kind="vendor procedure", source=_BEARING, needs="the gearbox's limit of the radial force", why="why_no_bearing",
    ),
    DriveLimit(
        quantity="output bearing static load", demand="safe_static_load", limit="gearbox.bearing_static_load", unit="N",
        kind="vendor procedure", source=_BEARING, needs="the bearing's static load rating and diameter",
        why="why_no_bearing",
    ),
    DriveLimit(
        quantity="output bearing life", demand="required_life_hours", limit="bearing_life_hours", unit="h",
        kind="vendor procedure", source=_BEARING, needs="a required life, and the bearing's load rating and diameter",
        why="why_no_bearing",
    ),
    DriveLimit(
        quantity="motor torque at standstill", demand="standing_torque", limit="max_standing_torque", unit="N m",
        kind="vendor procedure", needs="the motor's torque at standstill, and what ambient and altitude leave of it",
        asked="stands_loaded",
    ),
    DriveLimit(
        quantity="holding brake torque", demand="holding_torque", limit="motor.brake_torque", unit="N m",
        kind="physics", needs="the holding brake's torque", asked="braked",
    ),
    DriveLimit(
        quantity="holding brake energy of a stop", demand="brake_stop_energy", limit="motor.brake_stop_energy",
        unit="J", kind="vendor procedure", source=_BRAKE, asked="braked",
        needs="the holding brake's torque and the energy that it bears in one stop",
    ),
    DriveLimit(
        quantity="holding brake wear", demand="brake_wear", limit="motor.brake_total_energy", unit="J",
        kind="vendor procedure", source=_BRAKE, asked="train.emergency_stops", unless="unbraked",
        needs="the holding brake's torque and the energy that it bears in its life",
    ),
)  # fmt: skip
"""Every check of a drive train, in the order of its documents."""


def assess_joint(demands: Demands) -> tuple[Outcome, ...]:
    """All checks of one joint, made or not.

    Returns
    -------
    tuple of LimitCheck or NotAssessed
    """
    return tuple(outcome for limit in DRIVE_LIMITS if (outcome := limit.outcome(demands)) is not None)


def utilisation_bounds(
    grid: LoadGrid,
    table: PairTable,
    *,
    momentary_torque: float = np.nan,
    only: Container[str] | None = None,
    shared: PeakBounds | None = None,
) -> dict[str, Bounds]:
    """Utilisation of each limit that can reject by all pairs at a joint.

    Parameters
    ----------
    grid : LoadGrid
    table : PairTable
    momentary_torque : float
        At the gearbox's output; the joint's own where it is not known.
    only : container of str, optional
        The checks that count.
    shared : PeakBounds, optional
        Peaks in all load cases at once.

    Returns
    -------
    dict of str to Bounds
        By the quantities of `assess_joint`.
    """
    momentary = float(np.fmax(momentary_torque, table.place.momentary_torque))
    demands = PairDemands(grid=grid, table=table, momentary_torque_at_joint=momentary, shared=shared)
    return {
        limit.quantity: limit.bounds(demands)
        for limit in DRIVE_LIMITS
        if limit.kind != "rule of thumb" and (only is None or limit.quantity in only)
    }
