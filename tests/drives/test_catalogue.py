"""Catalogues: what is read, in which units, and which file, row and column a complaint names."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.drives import Catalogue, Pair

MOTORS = "key,mass,inertia[kg cm^2],max_int_torque[mN m],max_int_speed[rpm]\nM1,0.5,2,1500,3000\nM2,0.9,,2500,\n"
GEARS = "key,ratio,mass,inertia,efficiency[%]\nG1,50,1.0,1e-5,80\nG2,100,1.5,2e-5,75\n"
PAIRS = "motor,gearbox,viscous_friction,coulomb_positive,coulomb_negative,max_effort\nM1,G1,,,,60\nM2,G2,,,,\n"
# Conversion of units is one product.
ROUNDING = 1e-15


def read(folder: Path, motors: str = MOTORS, gears: str = GEARS, pairs: str | None = None) -> Catalogue:
    (folder / "m.csv").write_text(motors, encoding="utf-8")
    (folder / "g.csv").write_text(gears, encoding="utf-8")
    if pairs is None:
        return ps.load_catalogue(folder / "m.csv", folder / "g.csv")
    (folder / "p.csv").write_text(pairs, encoding="utf-8")
    return ps.load_catalogue(folder / "m.csv", folder / "g.csv", folder / "p.csv")


def test_units_are_converted(tmp_path: Path) -> None:
    motor = read(tmp_path).motors[0]
    assert motor.rotor_inertia == pytest.approx(2e-4, rel=ROUNDING)
    assert motor.peak_torque == pytest.approx(1.5, rel=ROUNDING)
    assert motor.max_speed == pytest.approx(100 * np.pi, rel=ROUNDING)
    assert read(tmp_path).gearboxes[1].efficiency == pytest.approx(0.75, rel=ROUNDING)


def test_an_empty_cell_is_unknown(tmp_path: Path) -> None:
    motor = read(tmp_path).motors[1]
    assert np.isnan(motor.rotor_inertia)
    assert np.isnan(motor.max_speed)
    assert np.isnan(motor.continuous_torque)


def test_every_motor_fits_every_gearbox_unless_pairs_say_otherwise(tmp_path: Path) -> None:
    assert read(tmp_path).n_pairs == 4
    fitting = read(tmp_path, pairs=PAIRS)
    assert fitting.n_pairs == 2
    assert fitting.drivetrain(0, 0).max_effort == 60.0
    assert np.isnan(fitting.drivetrain(1, 0).max_effort)
    assert fitting.masses().tolist() == [1.5, 2.4]


def test_columns_of_the_public_database_and_remarks(tmp_path: Path) -> None:
    motors = (
        "\ufeff# a remark\n\nkey,manufacturer,ID,type,V,k_t[Nm/A],R[Ω],L[H],mass,inertia,omega_nl,I_nl,I_nom,"
        "max_int_torque,max_int_speed,max_cont_speed,max_cont_power,coulomb_friction,viscous_friction,Rth1,Rth2\n"
        "M,Nobody,7,BLDC,48,0.1,0.5,1e-3,1,1e-4,480,0.3,5,2,400,350,100,inf,nan,1.5,3\n"
    )
    catalogue = read(tmp_path, motors=motors)
    motor = catalogue.motors[0]
    assert motor.continuous_torque_at(300.0) == pytest.approx(0.5)  # k_t I_nom
    assert motor.continuous_torque_at(351.0) == 0.0
    assert motor.coulomb_friction == pytest.approx(0.03, rel=ROUNDING)  # k_t I_nl
    assert motor.source.startswith("Nobody 7")
    assert catalogue.drivetrain(0, 0).drive.bus_voltage == 48.0
    assert "column max_cont_power of the motors" in catalogue.unused


def complaint(tmp_path: Path, **files: str) -> str:
    """What is said of files: the error, or the rows that were left out."""
    try:
        return "\n".join(read(tmp_path, **files).refused)
    except ps.InputError as error:
        return str(error)


def test_curves_and_thermal_nodes(tmp_path: Path) -> None:
    motors = (
        "key,mass,inertia,max_int_torque,S1[rpm:Nm],peak,Rth1,tau_w[min],Rth2,tau_h\n"
        "M,1,1e-4,2,0:0.5;3000:0.4,0:2;400:1,1.5,0.5,3,900\nN,1,1e-4,2,,,1.5,0.5,,\nO,1,1e-4,2,,,1.5,0.5,3,\n"
    )
    two, one, unknown = read(tmp_path, motors=motors).motors
    assert two.continuous_curve[1] == pytest.approx([100 * np.pi, 0.4])
    assert two.peak_curve.tolist() == [[0.0, 2.0], [400.0, 1.0]]
    assert two.thermal_time_constants.tolist() == [30.0, 900.0]
    assert one.thermal_resistances.tolist() == [1.5]
    assert len(unknown.thermal_time_constants) == 0
    assert unknown.thermal_resistances.tolist() == [1.5, 3.0]  # what they tell alone is used


def test_curves_of_several_bus_voltages(tmp_path: Path) -> None:
    """Only one curve of a motor could be entered, whatever the bus."""
    motors = (
        "key,mass,inertia,max_int_torque,S1@24 V[rpm:Nm],S1@48V[rpm:Nm],peak@48 V DC,peak@24 V\n"
        "M,1,1e-4,2,0:0.5;1500:0.4,0:0.5;3000:0.4,0:2;400:1,0:2|200:1\nN,1,1e-4,2,,0:0.5;3000:0.4,,\n"
    )
    both, one = read(tmp_path, motors=motors).motors
    assert [volts for volts, _ in both.peak_curves] == [volts for volts, _ in both.continuous_curves] == [24.0, 48.0]
    assert both.peak_curve_at(30.0)[-1].tolist() == [200.0, 1.0]
    assert both.continuous_torque_at(75 * np.pi, bus_voltage=48.0) == pytest.approx(0.425)
    assert both.continuous_torque_at(75 * np.pi, bus_voltage=30.0) == 0.0
    assert [volts for volts, _ in one.continuous_curves] == [48.0]
    assert one.peak_curves == ()
    twice = motors.replace("max_int_torque", "max_cont_torque")
    assert "column 'max_int_torque' is missing" in complaint(tmp_path, motors=twice)
    twice = motors.replace("max_int_torque", "max_int_torque,max_cont_torque").replace(",2,", ",2,0.3,")
    assert "column 'S1': the row has max_cont_torque as well" in complaint(tmp_path, motors=twice)


def test_what_is_derated_and_maps(tmp_path: Path) -> None:
    """Ambient, altitude, a gearbox at the flange, impact and maps of efficiency were values of Python alone."""
    motors = (
        "key,mass,inertia,max_int_torque,rated_ambient_celsius[°C],geared_share[%],altitude_curve[m:%],"
        "copper_coefficient[1/K],reference_celsius\nM,1,1e-4,2,25,85,1000:100;3000:80,0.0039,25\n"
    )
    gears = (
        "key,type,ratio,mass,inertia,efficiency,impact_curve,efficiency_map[rpm:Nm:%],bearing_offset[mm]\n"
        "G,planetary,10,1,1e-5,,1000:1;3000:1.5,1000:10:80;1000:20:90,18\n"
    )
    catalogue = read(tmp_path, motors=motors, gears=gears)
    assert catalogue.refused == catalogue.unused == ()
    (motor,), (gear,) = catalogue.motors, catalogue.gearboxes
    assert (motor.rated_ambient_celsius, motor.reference_celsius, motor.copper_coefficient) == (25.0, 25.0, 0.0039)
    assert motor.geared_share == pytest.approx(0.85)
    assert motor.altitude_curve == pytest.approx(np.array([[1000.0, 1.0], [3000.0, 0.8]]))
    assert gear.impact_factor(1.8) == pytest.approx(1.25)  # 2000 an hour
    assert gear.efficiency_map == pytest.approx(np.array([[100 * np.pi / 3, 10, 0.8], [100 * np.pi / 3, 20, 0.9]]))
    assert gear.bearing_offset == pytest.approx(0.018)
    wrong = complaint(tmp_path, gears=gears.replace("[rpm:Nm:%]", "[rpm:Nm]"))
    assert "column 'efficiency_map': unknown unit 'rpm:Nm'; expected those of rad/s:N m:" in wrong


@pytest.mark.parametrize(
    ("motors", "message"),
    [
        (MOTORS.replace(",inertia[kg cm^2]", ""), r"m\.csv, row 1: column 'inertia' is missing"),
        (MOTORS.replace("0.5,2,", "0.5,heavy,"), r"m\.csv, row 2, column 'inertia': 'heavy' is not a number"),
        (MOTORS.replace("0.5,2,", "0.5,1_0,"), r"m\.csv, row 2, column 'inertia': '1_0' is not a number"),
        (MOTORS.replace("0.5,2,", "0.5,-2,"), r"m\.csv, row 2, column 'inertia': rotor_inertia = -0\.0002 kg m\^2"),
        (MOTORS.replace("M2", "M1"), r"m\.csv, row 3, column 'key': 'M1' occurs twice, first in .*row 2"),
        (
            MOTORS.replace("kg cm^2", "kg cm"),
            r"m\.csv, row 1: column 'inertia': unknown unit 'kg cm'; expected one of kg m",
        ),
        (MOTORS.replace("mass", "weight"), r"m\.csv, row 1: column 'mass' is missing; the header has key, weight"),
        (MOTORS.replace("mass", "key"), r"m\.csv, row 1: column 'key' occurs twice"),
        (MOTORS.replace("M1", ""), r"m\.csv, row 2, column 'key': the cell is empty"),
        (MOTORS.replace("3000", "3000,9"), r"m\.csv, row 2: 6 cells, but the header has 5"),
        ("key,mass,inertia,max_int_torque\n", r"m\.csv: no rows below the header"),
        ("", r"m\.csv: no header; expected columns key"),
        (MOTORS + 140_000 * "a", r"m\.csv, row 4: not a CSV file: field larger than field limit \(131072\)"),
        (
            MOTORS.replace("0.5,2,", '"0,5",2,'),
            r"row 2, column 'mass': '0,5' is not a number: a comma in a file with comm",
        ),
        (MOTORS.replace("key", "key[mm]"), r"m\.csv, row 1: column 'key': unknown unit 'mm'; it is text and has none"),
        (MOTORS.replace("max_int_speed[rpm]", "S1").replace("3000", "1"), r"row 2, column 'S1': '1' is not a curve"),
    ],
)
def test_faults_of_a_motor_file(tmp_path: Path, motors: str, message: str) -> None:
    assert re.search(message, complaint(tmp_path, motors=motors))


@pytest.mark.parametrize(
    ("gears", "message"),
    [
        (GEARS.replace("G1,50", "G1,"), r"g\.csv, row 2, column 'ratio': the cell is empty"),
        (GEARS.replace("G1,50", "G1,0"), r"g\.csv, row 2, column 'ratio': gear ratio = 0"),
        (
            GEARS.replace("efficiency[%]", "efficiency[%],efficiency_map").replace("80", "80,100:10:0.8;100:20:0.9"),
            r"g\.csv, row 2: efficiency_map has all losses in it, but efficiency is given too",
        ),
        (GEARS.replace("80", "180"), r"g\.csv, row 2, column 'efficiency': efficiency = 1\.8 must be at most 1"),
        (GEARS.replace("inertia", "direction,inertia").replace("1.0,", "1.0,2,"), r"row 2, column 'direction': 2 is"),
    ],
)
def test_faults_of_a_gearbox_file(tmp_path: Path, gears: str, message: str) -> None:
    assert re.search(message, complaint(tmp_path, gears=gears))


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        (PAIRS.replace("M1", "M7"), r"p\.csv, row 2, column 'motor': no motor has the key 'M7'"),
        (PAIRS.replace("60", "-60"), r"p\.csv, row 2, column 'max_effort': -60 N m must be greater"),
        (PAIRS.replace("M2,G2", "M1,G1"), r"p\.csv: the pair M1, G1 occurs twice"),
        (PAIRS.replace("G1,,,", "G1,0.1,1,-1"), r"p\.csv: measured_friction already contains the losses"),
        ("M1,G9\n", r"p\.csv, row 1: no gearbox has the key 'G9'"),
        (PAIRS.replace("G1,,,", "G1,0.1,-1,-1"), r"p\.csv, row 2, column 'coulomb_positive': coulomb"),
    ],
)
def test_faults_of_a_pair_file(tmp_path: Path, pairs: str, message: str) -> None:
    assert re.search(message, complaint(tmp_path, pairs=pairs))


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match=r"none\.csv: this catalogue does not exist"):
        ps.load_catalogue(tmp_path / "none.csv", tmp_path / "none.csv")


def test_the_example_says_that_it_is_invented() -> None:
    catalogue = ps.built_in_catalogue()
    assert catalogue.n_pairs == len(catalogue.motors) * len(catalogue.gearboxes)
    for part in (*catalogue.motors, *catalogue.gearboxes):
        assert part.name.startswith("INVENTED-")
        assert "no such company" in part.source


def test_the_arms_own_drives_are_those_of_its_files() -> None:
    """Two ways to the same six drives: the actuator file with the drives file, and the catalogue."""
    catalogue = ps.built_in_catalogue("puma560")
    for k, own in enumerate(ps.load_drivetrains(ps.load_robot())):
        train = catalogue.drivetrain(k, k)
        assert train.gearbox.ratio == own.gearbox.ratio
        assert train.inertia == own.inertia
        assert train.friction.viscous == own.friction.viscous
        assert train.friction.coulomb.tolist() == own.friction.coulomb.tolist()
        assert train.max_effort == own.max_effort
        assert train.motor.max_speed == own.motor.max_speed
        assert np.array_equal(train.motor.torque_constant, own.motor.torque_constant, equal_nan=True)


def test_a_drive_of_the_joints_keeps_its_own_voltage(tmp_path: Path) -> None:
    motors = MOTORS.replace("key,", "key,V,").replace("M1,", "M1,48,").replace("M2,", "M2,24,")
    catalogue = read(tmp_path, motors=motors)
    part = ps.Drivetrain(motor=ps.Motor(), gearbox=ps.Gearbox(ratio=1.0), drive=ps.Drive(bus_voltage=60.0))
    bare = ps.Drivetrain(motor=ps.Motor(), gearbox=ps.Gearbox(ratio=1.0), ambient_celsius=25.0)
    assert catalogue.drivetrain(0, 0, [part]).drive.bus_voltage == 60.0
    assert catalogue.drivetrain(3, 0, [bare]).drive.bus_voltage == 24.0
    assert catalogue.drivetrain(3, 0, [bare]).ambient_celsius == 25.0


def test_parts_need_names_of_their_own() -> None:
    gears = [ps.Gearbox(name="G", ratio=2.0)]
    with pytest.raises(ps.InputError, match="motor 'M' occurs twice"):
        ps.Catalogue(motors=[ps.Motor(name="M")] * 2, gearboxes=gears)
    with pytest.raises(ps.InputError, match="motor 1 of the catalogue has no name"):
        ps.Catalogue(motors=[ps.Motor()], gearboxes=gears)
    with pytest.raises(ps.InputError, match="at least one motor"):
        ps.Catalogue(motors=[], gearboxes=gears)
    with pytest.raises(ps.InputError, match="a pair names gearbox 'H'"):
        ps.Catalogue(motors=[ps.Motor(name="M")], gearboxes=gears, pairs=[Pair(motor="M", gearbox="H")])


def test_pairs_may_have_the_optional_terms_of_friction(tmp_path: Path) -> None:
    header = "motor,gearbox,coulomb_positive,coulomb_negative,static_positive,static_negative,stribeck_velocity[rpm],"
    row = "M1,G1,0.4,-0.5,{static},-0.6,60,{share}\n"
    gears = GEARS.replace("80", "")
    (pair,) = (
        read(tmp_path, gears=gears, pairs=header + "load_share[%]\n" + row.format(static=0.7, share=10)).pairs or ()
    )
    law = ps.Friction(coulomb=[0.4, -0.5], static=[0.7, -0.6], stribeck_velocity=2 * np.pi, load_share=0.1)
    assert pair.friction is not None
    assert pair.friction.is_same(law)
    for static, share, column in ((0.3, 10, "static_positive"), (0.7, 110, "load_share")):
        text = header + "load_share[%]\n" + row.format(static=static, share=share)
        assert re.search(rf"p\.csv, row 2, column '{column}': ", complaint(tmp_path, gears=gears, pairs=text))
