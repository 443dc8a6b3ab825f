"""Servo motors as their makers print them: measures of current and voltage, derating, curves by bus voltage."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import puma_septic as ps

# Closed forms: what differs is rounding.
EXACT = 1e-14


def test_three_phases_heat_and_induce_as_the_equivalent_motor_does() -> None:
    """N m/A r.m.s. and ohm between lines, entered as direct current, gave 2/3 of the heat and 22.5 % too much voltage.

    Audited from outside; by hand: three phases of I heat by 3 (R/2) I^2, and the induced peak between two lines is
    sqrt(2) sqrt(3) k / 3 per rad/s, as the power k I of three phases of E = k / 3 demands.
    """
    k, r, torque, speed = 0.83, 2.6, 5.0, 200.0
    servo = ps.Motor(torque_constant=k, current="rms", resistance=r)
    entered = ps.Motor(torque_constant=k, resistance=r)
    current = torque / k

    def heat(motor: ps.Motor) -> float:
        return motor.dc_resistance * (torque / motor.dc_torque_constant) ** 2

    assert heat(servo) == pytest.approx(3 * (r / 2) * current**2, rel=EXACT)
    assert heat(servo) / heat(entered) == pytest.approx(1.500, rel=EXACT)
    assert servo.back_emf * speed == pytest.approx(np.sqrt(2) * np.sqrt(3) * k / 3 * speed, rel=EXACT)
    assert round(100 * (entered.back_emf / servo.back_emf - 1), 1) == 22.5


def test_the_same_motor_in_every_measure() -> None:
    """Effective or peak amperes, phase or line ohms, and each voltage constant: one heat, one voltage."""
    k, r = 0.83, 2.6
    rms = ps.Motor(torque_constant=k, current="rms", resistance=r)
    peak = ps.Motor(torque_constant=k / np.sqrt(2), current="peak", resistance=r / 2, winding="phase")
    assert peak.dc_torque_constant == pytest.approx(rms.dc_torque_constant, rel=EXACT)
    assert peak.dc_resistance == rms.dc_resistance
    for voltage, of_phase in (
        ("rms phase", 1.0), ("rms line-line", np.sqrt(3)), ("peak phase", np.sqrt(2)), ("peak line-line", np.sqrt(6))
    ):  # fmt: skip
        motor = ps.Motor(torque_constant=k, current="rms", voltage_constant=k / 3 * of_phase, voltage=voltage)
        assert motor.back_emf == pytest.approx(rms.back_emf, rel=1e-12)


def test_the_published_loss_of_continuous_torque_in_a_hot_place() -> None:
    """Machine Design, "Choose wisely": 24.8 N m at 40 degrees, 100 K of rise; at 65 degrees 13 % are lost."""
    motor = ps.Motor(max_winding_celsius=100.0 + 40.0)
    share = motor.continuous_share(ambient_celsius=65.0)
    assert share == pytest.approx(np.sqrt(75 / 100), rel=EXACT)
    assert round(100 * (1 - share)) == 13
    assert round(24.8 * share, 1) == 21.5


def test_a_current_rated_at_25_degrees_is_worth_6_per_cent_less_at_40() -> None:
    """Maxon rates at 25 degrees: sqrt((155 - 40) / (155 - 25)) = 0.94; it was taken whole at 40. Audited."""
    motor = ps.Motor(continuous_torque=0.2, max_winding_celsius=155.0, rated_ambient_celsius=25.0)
    train = ps.Drivetrain(motor=motor)
    assert round(train.continuous_share, 2) == 0.94
    assert motor.continuous_share(ambient_celsius=10.0) == 1.0  # a sheet vouches for no more than it prints


def test_a_share_per_kelvin_and_by_altitude_as_kollmorgen_prints_them() -> None:
    """AKM: 1 % per K above 40 degrees; 6, 17, 30 % up to 2000, 3000, 4000 m (kdn.kollmorgen.com, "Derating")."""
    motor = ps.Motor(ambient_derating=0.01, altitude_curve=[[1000, 1.0], [2000, 0.94], [3000, 0.83], [4000, 0.70]])
    assert motor.continuous_share(ambient_celsius=50.0) == pytest.approx(0.90, rel=EXACT)
    assert motor.continuous_share(ambient_celsius=40.0, altitude=3000.0) == pytest.approx(0.83, rel=EXACT)
    assert motor.continuous_share(ambient_celsius=50.0, altitude=500.0) == pytest.approx(0.90, rel=EXACT)


def test_what_is_lost_and_not_known_leaves_no_continuous_torque_to_trust() -> None:
    """A hotter or higher place than the sheet vouches for, without a word on what is lost there."""
    motor = ps.Motor(continuous_torque=0.2)
    assert np.isnan(motor.continuous_share(ambient_celsius=41.0))
    assert np.isnan(motor.continuous_share(ambient_celsius=20.0, altitude=1500.0))
    assert motor.continuous_share(ambient_celsius=40.0, altitude=1000.0) == 1.0
    assert np.isnan(
        ps.Motor(altitude_curve=[[1000, 1.0], [2000, 0.9]]).continuous_share(ambient_celsius=20.0, altitude=2100.0)
    )


def test_a_gearbox_at_the_flange_takes_its_share() -> None:
    """Beckhoff, AM8100 manual: up to 20 % less with a gearbox at the flange; a direct drive has none."""
    motor = ps.Motor(geared_share=0.8)
    assert ps.Drivetrain(motor=motor, gearbox=ps.Gearbox(ratio=50.0)).continuous_share == 0.8
    assert ps.Drivetrain(motor=motor, gearbox=ps.Gearbox(ratio=1.0)).continuous_share == 1.0


def test_the_curve_of_the_highest_voltage_that_the_bus_reaches() -> None:
    low, high = [[0, 3.0], [300, 3.0]], [[0, 3.0], [600, 3.0]]
    motor = ps.Motor(peak_curves=[(560.0, high), (320.0, low)])
    assert motor.peak_curve_at(320.0)[-1, 0] == 300
    assert motor.peak_curve_at(500.0)[-1, 0] == 300
    assert motor.peak_curve_at(560.0)[-1, 0] == 600
    # Below all of them a motor can do no more than the lowest says; what it can do is not known.
    assert motor.peak_curve_at(300.0)[-1, 0] == 300
    assert [motor.has_curves_at(volts) for volts in (np.nan, 300.0, 320.0)] == [False, False, True]
    assert not len(motor.peak_curve_at(np.nan))
    assert ps.Motor(peak_curve=low).peak_curve_at(np.nan)[-1, 0] == 300


def test_the_rotor_with_its_brake() -> None:
    motor = ps.Motor(rotor_inertia=1e-4, brake_inertia=2e-5)
    assert ps.Drivetrain(motor=motor, gearbox=ps.Gearbox(ratio=1.0)).inertia == 1e-4
    assert ps.Drivetrain(motor=motor, gearbox=ps.Gearbox(ratio=1.0), with_brake=True).inertia == pytest.approx(1.2e-4)
    unknown = ps.Drivetrain(motor=ps.Motor(rotor_inertia=1e-4), with_brake=True)
    assert "inertia of the holding brake" in unknown.left_out


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"current": "amps"}, "current.*'amps'.*dc.*rms.*peak"),
        ({"winding": "delta"}, "winding.*'delta'.*line-line.*phase"),
        ({"voltage": "rms"}, "voltage.*'rms'.*peak line-line"),
        ({"altitude_curve": [[1000, 1.2]]}, r"altitude_curve: shares \[1.2\] must be above 0 and at most 1"),
        ({"altitude_curve": [[2000, 0.9], [1000, 1.0]]}, "altitude_curve.*must increase strictly"),
        ({"geared_share": 1.5}, "geared_share = 1.5"),
        ({"peak_curve": [[0, 1], [1, 1]], "peak_curves": [(48.0, [[0, 1], [1, 1]])]}, "peak_curve .* or peak_curves"),
        ({"peak_curves": [(-48.0, [[0, 1], [1, 1]])]}, "bus voltage of peak_curves = -48 V"),
        ({"brake_torque": -1.0}, "brake_torque = -1 N m"),
    ],
)
def test_a_value_that_no_motor_has_is_refused(values: dict, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.Motor(**values)


# ---- in catalogues


def read(folder: Path, header: str, cells: str, gears: str = "key,ratio,mass,inertia,efficiency\nG,100,1,1e-5,0.8\n"):
    motors, gearboxes = folder / "motors.csv", folder / "gearboxes.csv"
    motors.write_text(f"key,mass,inertia,max_int_torque,{header}\nM,1,1e-4,5,{cells}\n", encoding="utf-8")
    gearboxes.write_text(gears, encoding="utf-8")
    return ps.load_catalogue(motors, gearboxes)


def test_columns_declare_in_which_measure_a_sheet_prints(tmp_path: Path) -> None:
    found = read(
        tmp_path, "k_t[Nm/A],current,R[ohm],winding,voltage_constant[V/krpm],voltage,L[mH],pole_pairs,brake_torque[Nm]",
        "0.83,rms,1.3,phase,50.2,rms line-line,4.1,5,4.5",
    ).motors[0]  # fmt: skip
    assert (found.current, found.winding, found.voltage) == ("rms", "phase", "rms line-line")
    assert found.dc_resistance == 2.6
    assert found.reactance_constant == pytest.approx(5 * 4.1e-3 * 2)
    # The two constants are one flux: 0.83 N m/A are 0.83 / sqrt(3) 2 pi 1000 / 60 = 50.2 V per 1000 1/min.
    assert found.back_emf == pytest.approx(np.sqrt(2 / 3) * 0.83, rel=1e-3)
    assert found.brake_torque == 4.5


@pytest.mark.parametrize(("unit", "current"), [("Nm/A_rms", "rms"), ("N m/Apk", "peak"), ("Nm/A", "dc")])
def test_the_unit_of_the_torque_constant_declares_it_too(tmp_path: Path, unit: str, current: str) -> None:
    """Kollmorgen, Beckhoff and Siemens print N m/A_rms: entered as printed, the heat was 2/3 of the true. Audited."""
    assert read(tmp_path, f"k_t[{unit}]", "0.83").motors[0].current == current


def test_a_unit_and_a_text_that_contradict_each_other_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match="column 'current': 'dc', but k_t is in 'Nm/A_rms'"):
        read(tmp_path, "k_t[Nm/A_rms],current", "0.83,dc")


def test_gearboxes_of_a_catalogue_have_kind_stiffness_and_bearing(tmp_path: Path) -> None:
    gears = (
        "key,type,ratio,mass,inertia,efficiency,K1[Nm/arcmin],K2[Nm/arcmin],K3[Nm/arcmin],T1,T2,life_basis,L_n,"
        "max_tilting_moment,bearing_diameter[mm],backlash[arcmin]\n"
        "H,strain wave,100,1,1e-5,0.8,19.5,32,35,29,108,L50,35000,290,112,0.5\n"
        "R,RV,120,2,1e-5,0.8,50,50,50,1,2,L10,6000,,,\n"
        "W,worm,60,1,1e-5,0.6,,,,,,,,,,\n"
    )
    strain, cycloidal, other = read(tmp_path, "cost", "1", gears).gearboxes
    assert (strain.kind, cycloidal.kind, other.kind) == ("strain wave", "cycloidal", "")
    assert strain.stiffness == pytest.approx(np.array([19.5, 32, 35]) * 10800 / np.pi)
    assert strain.stiffness_torques.tolist() == [29, 108]
    assert strain.bearing_diameter == pytest.approx(0.112)
    assert strain.backlash == pytest.approx(np.pi / 21600)
    assert (strain.life_basis, cycloidal.life_basis, other.life_basis) == ("L50", "L10", "")
