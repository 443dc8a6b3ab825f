"""Voltage, current, heat and power of a motor with its winding as warm as it is, and with a weakened field."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from helpers.duty import paper_motion

import puma_septic as ps
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._winding import Winding

# A sum over samples against an integral of series.
SAMPLED = 1e-5


def demands(motor: ps.Motor, joint: int = 1, **train: object) -> ps.sizing.Demands:
    cycle = ps.cycle.with_return(paper_motion(loaded=True), dwell=1.0)
    gearbox = ps.Gearbox(ratio=80.0, efficiency=0.76, inertia=1.2e-4)
    load = ps.sizing.joint_load(cycle, joint)
    assembled = ps.Drivetrain(motor=motor, gearbox=gearbox, **train)  # type: ignore[arg-type]
    return ps.sizing.Demands(load=load, train=assembled, motor=ps.sizing.motor_load(load, assembled))


def warm_motor(**changes: object) -> ps.Motor:
    """The example catalogue's M200 with less cooling, so that it runs warm."""
    given = {
        "rotor_inertia": 3e-5, "torque_constant": 0.12, "resistance": 0.9, "max_winding_celsius": 130.0,
        "thermal_resistances": [0.68, 1.26], "thermal_time_constants": [26.0, 930.0],
    }  # fmt: skip
    return ps.Motor(**(given | changes))  # type: ignore[arg-type]


def test_voltage_power_and_energy_grow_with_the_winding_s_own_temperature() -> None:
    """The winding was 89 K warm by the product's own count and its voltage and energy were still those at 20 degrees.

    Audited: +11.6 % of voltage, +14 % of power, +20 % of energy on the unsafe side. Here the same is found by sums over
    a hundred thousand samples of the temperature, and each grows by as much.
    """
    warm = demands(warm_motor())
    cold = demands(warm_motor(thermal_resistances=[], thermal_time_constants=[]))
    assert warm.temperature_rise is not None
    t = (np.arange(100_000) + 0.5) * warm.load.duration / 100_000
    celsius = warm.temperature_rise(t)[:, 0] + 40.0
    resistance = 0.9 * (1 + 0.00393 * (celsius - 20.0))
    torque, speed = warm.motor.torque(t)[:, 0], warm.motor.speed(t)[:, 0]
    current = torque / 0.12
    power = torque * speed + resistance * current**2
    step = warm.load.duration / len(t)
    assert warm.peak_voltage.size == pytest.approx(np.abs(resistance * current + 0.12 * speed).max(), rel=SAMPLED)
    assert warm.peak_drawn_power.size == pytest.approx(power.max(), rel=SAMPLED)
    assert warm.electric_energy[0] == pytest.approx(np.maximum(power, 0).sum() * step, rel=SAMPLED)
    assert warm.electric_energy[1] == pytest.approx(-np.minimum(power, 0).sum() * step, rel=SAMPLED)
    assert 30 < warm.peak_temperature_rise.size < 90
    assert warm.peak_voltage.size > 1.05 * cold.peak_voltage.size
    assert warm.electric_energy[0] > 1.1 * cold.electric_energy[0]
    assert warm.electric_energy[1] < cold.electric_energy[1]


def test_where_the_winding_runs_away_no_voltage_is_enough() -> None:
    found = demands(warm_motor(resistance=5.0))
    assert found.peak_temperature_rise.size == np.inf
    assert found.peak_voltage.size == found.peak_drawn_power.size == found.mean_drawn_power == np.inf
    assert found.stored_energy == np.inf


def test_a_sheet_in_effective_amperes_gives_the_heat_and_current_of_three_phases() -> None:
    """The audited case: half as much heat again as when the same numbers were read as direct current."""
    no_copper = {"copper_coefficient": 0.0}
    servo, dc = demands(warm_motor(current="rms", **no_copper)), demands(warm_motor(**no_copper))
    assert servo.peak_temperature_rise.size / dc.peak_temperature_rise.size == pytest.approx(1.5, rel=1e-9)
    assert servo.rms_current == pytest.approx(dc.rms_current, rel=1e-9)
    assert servo.rms_current == pytest.approx(servo.rms_torque / 0.12, rel=1e-9)


def test_the_continuous_torque_is_derated_along_the_way_to_the_verdict() -> None:
    """At 20, 40 and 70 degrees of ambient the check gave one and the same percentage. Audited."""
    uses = []
    for ambient in (20.0, 40.0, 70.0):
        motor = warm_motor(continuous_torque=2.0)
        found = demands(motor, ambient_celsius=ambient)
        uses.append(found.rms_torque / found.continuous_torque)
    assert uses[0] == uses[1]
    assert uses[2] / uses[1] == pytest.approx(np.sqrt((130 - 40) / (130 - 70)), rel=1e-12)


SYNCHRONOUS = {"inductance": 2e-3, "pole_pairs": 5.0, "current": "rms"}


def test_inductance_adds_at_right_angles() -> None:
    motor = warm_motor(thermal_resistances=[], thermal_time_constants=[], **SYNCHRONOUS)
    found = demands(motor)
    t = np.linspace(0, found.load.duration, 200_001)
    current = found.motor.torque(t)[:, 0] / motor.dc_torque_constant
    speed = found.motor.speed(t)[:, 0]
    along, across = motor.dc_resistance * current + motor.back_emf * speed, 5 * 2e-3 * speed * current
    assert found.peak_voltage.size == pytest.approx(np.hypot(along, across).max(), rel=1e-7)
    plain = demands(replace(motor, inductance=np.nan))
    assert found.peak_voltage.size > plain.peak_voltage.size


def weakened() -> Winding:
    """A current that rises with the speed, up to where the voltage is far beyond 60 V."""
    breaks = [0.0, 1.0]
    return Winding(
        current=Piecewise.from_power(breaks, [[[4.0]], [[2.0]]]),
        speed=Piecewise.from_power(breaks, [[[0.0]], [[700.0]]]),
        resistance=Piecewise.constant([0.8], 1.0),
        back_emf=0.09,
        reactance=5 * 1.2e-3,
    )


def test_the_weakened_field_holds_the_voltage_at_the_bus_s() -> None:
    """Against a search over the field's current at each instant."""
    winding, bus = weakened(), 60.0
    t = np.linspace(0.001, 0.999, 37)
    i, w = winding.current(t)[:, 0], winding.speed(t)[:, 0]
    field = winding.field_current(bus, 50.0)(t)[:, 0]
    j = -np.linspace(0, 20, 400_001)

    def voltage(k: int, field: np.ndarray) -> np.ndarray:
        return np.hypot(0.8 * i[k] + w[k] * (0.09 + 5 * 1.2e-3 * field), 0.8 * field - w[k] * 5 * 1.2e-3 * i[k])

    for k in range(len(t)):
        volts = voltage(k, j)
        wanted = -j[np.argmax(volts <= bus)]
        assert field[k] == pytest.approx(wanted, abs=1e-4)
        least = winding.least_voltage_squared(3.0)(t[k])[0]
        assert least == pytest.approx((volts[-j <= 3.0] ** 2).min(), rel=1e-6)
    assert field.max() > 1
    assert field.min() == 0.0


def test_field_weakening_buys_voltage_for_current_and_heat() -> None:
    motor = warm_motor(**(SYNCHRONOUS | {"inductance": 2e-2, "resistance": 0.2}))
    plain = demands(motor)
    bus = 0.9 * plain.peak_voltage.size
    drive = ps.Drive(bus_voltage=bus)
    weak = demands(replace(motor, max_field_current=40.0), drive=drive)
    assert weak.peak_voltage.size < plain.peak_voltage.size
    assert weak.rms_current > plain.rms_current
    assert weak.peak_temperature_rise.size > plain.peak_temperature_rise.size
    assert demands(motor, drive=drive).rms_current == plain.rms_current


def test_a_field_that_cannot_be_weakened_enough_takes_all_that_it_may() -> None:
    assert weakened().field_current(5.0, 2.0).extrema().max[0] == 2.0
    assert weakened().field_current(500.0, 2.0).extrema().max[0] == 0.0
