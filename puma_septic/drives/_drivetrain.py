"""Drivetrain: what stands between the supply and one joint."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, final

import numpy as np

from puma_septic.document import card, known, one_line
from puma_septic.drives._drive import Drive
from puma_septic.drives._gearbox import Gearbox
from puma_septic.drives._motor import Motor
from puma_septic.drives._part_checks import ABSOLUTE_ZERO_CELSIUS
from puma_septic.drives._stage import LinearStage
from puma_septic.errors import InputError
from puma_septic.friction import Friction
from puma_septic.validation import Array, checked_flag, checked_kind, checked_number, frozen, store_numbers

__all__ = ["Drivetrain"]

_UNKNOWN_LOSSES: Final = "losses of the gears (neither efficiency nor measured friction)"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Drivetrain:
    """Motor, gearbox and drive of one joint, and where they stand.

    The motor's torque is, in the joint's direction and with ``n = abs(gearbox.ratio)``,

    ``inertia n a + transmission tau / n + friction(n v)``,

    where tau is the torque that the gearbox's output carries (links, payload, wrench: no rotor, no friction) and the
    transmission is 1/efficiency where the motor drives (``tau v > 0``), the backward efficiency where the load drives,
    and 1 at rest; with measured friction 1 plus, 1 minus its load share, and 1. It is affine in the inertia on each
    side of the sign of the power. What is not known is left out of it and listed in `left_out`: of ``Drivetrain()``
    that is everything.

    Parameters
    ----------
    motor : Motor, optional
    gearbox : Gearbox, optional
    drive : Drive, optional
    stage : LinearStage, optional
        Screw, rack or belt behind the gearbox, of a sliding joint; the gearbox then turns, and its ratio is turns per
        turn.
    measured_friction : Friction, optional
        Friction measured through the gears. It contains their losses and the motor's own, so it excludes the gearbox's
        efficiency and no-load torque and the motor's friction.
    ambient_celsius : float
        Degrees Celsius; 40 is the customary ambient of motor ratings.
    altitude : float
        m above sea level; up to 1000 motors have their rated torque.
    with_brake : bool
        The motor is taken with its holding brake, whose inertia then turns with the rotor.
    armature : float
        Inertia of rotor and gears at the joint, kg m^2, where it is known there (as URDFs have it); it then counts, not
        the rotor's with the ratio, which may be unknown.
    friction_at_joint : Friction, optional
        The same of friction, where no ratio is known to refer it to the motor.
    max_effort : float
        Limit of the whole actuator torque referred to the joint (``n`` times the motor's), N m (N); NaN: unknown.
    momentary_torque : float
        Torque at the gearbox's output in a collision or emergency stop, N m (N); NaN: unknown.
    emergency_stops, emergency_duration : float
        How many of those there are in the gearbox's life, and how long one lasts, s; NaN: not told.
    required_life_hours : float
        Operating hours that the gearbox is to last; NaN: none asked for.
    max_inertia_ratio : float
        Largest ratio of the load's inertia, gears included, to the rotor's that is accepted; NaN: any.

    Raises
    ------
    InputError
        If losses would be counted twice, or for a value out of its bounds.

    Examples
    --------
    >>> train = Drivetrain(motor=Motor(rotor_inertia=2e-4), gearbox=Gearbox(ratio=100.0, efficiency=0.8, inertia=1e-4))
    >>> train.reflected_inertia, train.transmission.tolist()
    (3.0, [0.8, 1.0, 1.25])
    """

    motor: Motor = field(default_factory=Motor)
    gearbox: Gearbox = field(default_factory=Gearbox)
    drive: Drive = field(default_factory=Drive)
    stage: LinearStage | None = None
    measured_friction: Friction | None = None
    armature: float = np.nan
    friction_at_joint: Friction | None = None
    ambient_celsius: float = 40.0
    altitude: float = 0.0
    with_brake: bool = False
    max_effort: float = np.nan
    momentary_torque: float = np.nan
    emergency_stops: float = np.nan
    emergency_duration: float = np.nan
    required_life_hours: float = np.nan
    max_inertia_ratio: float = np.nan

    def __post_init__(self) -> None:
        for name, kind in (("motor", Motor), ("gearbox", Gearbox), ("drive", Drive)):
            checked_kind(name, getattr(self, name), kind)
        around = {"ambient_celsius": "degrees Celsius", "altitude": "m"}
        for name, least in (("ambient_celsius", ABSOLUTE_ZERO_CELSIUS), ("altitude", None)):
            given = checked_number(name, getattr(self, name), unit=around[name], above=least)
            object.__setattr__(self, name, given)
        object.__setattr__(self, "with_brake", checked_flag("with_brake", self.with_brake))
        store_numbers(self, {"armature": "kg m^2"}, at_least=0.0)
        positive = {
            "max_effort": "N m", "momentary_torque": "N m", "emergency_stops": "", "emergency_duration": "s",
            "required_life_hours": "h", "max_inertia_ratio": "",
        }  # fmt: skip
        store_numbers(self, positive, above=0.0)
        if self.measured_friction is not None:
            self._refuse_double_losses()

    def _refuse_double_losses(self) -> None:
        losses = {
            "gearbox.efficiency": self.gearbox.efficiency,
            "gearbox.backward_efficiency": self.gearbox.backward_efficiency,
            "gearbox.no_load_torque": self.gearbox.no_load_torque,
            "motor.viscous_friction": self.motor.viscous_friction,
            "motor.coulomb_friction": self.motor.coulomb_friction,
        }
        twice = [f"{name} = {value:g}" for name, value in losses.items() if not np.isnan(value)]
        twice += ["gearbox.efficiency_map"] if len(self.gearbox.efficiency_map) else []
        if twice:
            raise InputError(
                f"measured_friction already contains the losses of motor and gears, but {', '.join(twice)} is given"
                " too; give either the measured friction or those"
            )

    @property
    def ratio(self) -> float:
        """Magnitude of the gear ratio."""
        return abs(self.gearbox.ratio)

    @property
    def inertia(self) -> float:
        """Rotor, brake and gear input inertia at the motor, kg m^2; unknown parts are left out."""
        return float(np.nansum([self.motor.rotor_inertia, self.brake_inertia, self.gearbox.inertia]))

    @property
    def brake_inertia(self) -> float:
        """What the holding brake adds to the rotor, kg m^2; 0 without one."""
        return self.motor.brake_inertia if self.with_brake else 0.0

    @property
    def continuous_share(self) -> float:
        """Share of the motor's continuous torque that is left at most.

        By ambient and altitude, see `Motor.continuous_share`, and by the gearbox at its flange. What is not known takes
        nothing off: the limit then rejects as far as it is known, and the least set lacks the derating.
        """
        known = self.motor.continuous_share(ambient_celsius=self.ambient_celsius, altitude=self.altitude)
        share = float(np.nan_to_num(known, nan=1.0))
        is_geared = self.ratio != 1 and not np.isnan(self.motor.geared_share)
        return share * (self.motor.geared_share if is_geared else 1.0)

    @property
    def peak_curve(self) -> Array:
        """The motor's torque over speed at the bus voltage of its drive, see `Motor.peak_curve_at`."""
        return self.motor.peak_curve_at(self.drive.bus_voltage)

    @property
    def continuous_curve(self) -> Array:
        """The motor's S1 curve likewise, see `Motor.continuous_curve_at`."""
        return self.motor.continuous_curve_at(self.drive.bus_voltage)

    def continuous_torque_at(self, speed: float) -> float:
        """That the motor gives at a speed in rad/s at the bus voltage, ambient and altitude, N m; NaN: unknown."""
        sheet = self.motor.continuous_torque_at(speed, bus_voltage=self.drive.bus_voltage)
        return sheet * self.continuous_share

    @property
    def reflected_inertia(self) -> float:
        """The same at the joint, ``inertia ratio^2``, or the armature; NaN where neither is known."""
        return self.inertia * self.ratio**2 if np.isnan(self.armature) else self.armature

    @property
    def knows_inertia(self) -> bool:
        """Whether the inertia of the rotor at the joint is known."""
        return not (np.isnan(self.armature) and np.isnan(self.motor.rotor_inertia * self.ratio))

    @property
    def transmission(self) -> Array:
        """Factors of the load torque where the load drives, at rest, and where the motor drives, shape (3,)."""
        if self.measured_friction is not None:
            return self.measured_friction.transmission
        efficiency, backward = self.gearbox.load_efficiency, self.gearbox.backward_efficiency
        if np.isnan(efficiency):
            return frozen(np.ones(3))
        return frozen(np.array([efficiency if np.isnan(backward) else backward, 1.0, 1 / efficiency]))

    @property
    def joint_friction(self) -> Friction:
        """`friction` at the joint."""
        return self.friction_at_joint or self.friction.reflected(self.ratio)

    @property
    def friction(self) -> Friction:
        """At the motor: what was measured through the gears, or the motor's own and the gears' no-load torque."""
        if self.measured_friction is not None:
            return self.measured_friction
        parts = np.array([self.motor.coulomb_friction, self.gearbox.no_load_torque])
        size = np.nan if np.isnan(parts).all() else np.nansum(parts)
        return Friction(viscous=self.motor.viscous_friction, coulomb=np.array([size, -size]))

    @property
    def left_out(self) -> tuple[str, ...]:
        """What the motor's torque lacks because it is not known."""
        motor, measured, stage = self.motor, self.measured_friction, self.stage
        unknown = {"rotor inertia": motor.rotor_inertia, "inertia of the holding brake": self.brake_inertia}
        if stage is not None:
            unknown[f"losses of the {stage.kind}"] = stage.efficiency
            unknown[f"inertia of the {stage.kind}"] = stage.inertia
            unknown[f"friction of the {stage.kind}"] = stage.friction_force
        if self.ratio != 1:
            unknown["input inertia of the gears"] = self.gearbox.inertia
        if measured is None:
            unknown |= self._losses
        elif not measured.is_known:
            unknown["measured friction (viscous or Coulomb part)"] = np.nan
        return tuple(name for name, value in unknown.items() if np.isnan(value))

    @property
    def _losses(self) -> dict[str, float]:
        """Of motor and gears, where they were not measured together."""
        motor, gearbox = self.motor, self.gearbox
        losses = {} if len(gearbox.efficiency_map) else {_UNKNOWN_LOSSES: gearbox.efficiency}
        losses |= {
            "viscous friction of the motor": motor.viscous_friction,
            "Coulomb friction of the motor": motor.coulomb_friction,
        }
        # A direct drive has no gears, and what was measured with all losses in it needs no more.
        has_more = self.ratio != 1 and not len(gearbox.efficiency_map)
        return losses | ({"no-load torque of the gears": gearbox.no_load_torque} if has_more else {})

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What was taken for a value that is not known."""
        losses: dict[str, Gearbox | LinearStage] = {}
        if self.measured_friction is None:
            losses["gears"] = self.gearbox
        if self.stage is not None:
            losses[self.stage.kind] = self.stage
        return tuple(
            f"backward efficiency of the {name} as forward: {part.efficiency:g}"
            for name, part in losses.items()
            if np.isnan(part.backward_efficiency) and not np.isnan(part.efficiency)
        )

    def __repr__(self) -> str:
        return one_line("Drivetrain", self._facts())

    def _repr_html_(self) -> str:
        return card("Drivetrain", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "motor": self.motor.name or "unnamed",
            "gearbox": self.gearbox.name or "unnamed",
            **known(self, {"ratio": "", "reflected_inertia": "kg m^2", "max_effort": "N m"}),
        }
