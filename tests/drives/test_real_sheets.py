"""Catalogues as engineers have them: units of data sheets, decimal commas, gaps, typing errors, the MGDB."""

from __future__ import annotations

import re
from math import pi
from pathlib import Path

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.drives import Catalogue
from puma_septic.drives._units import si_size

OUNCE, INCH, STANDARD_GRAVITY = 0.45359237 / 16, 0.0254, 9.80665  # kg, m, m/s^2: by definition
TURN = 2 * pi


def load(folder: Path, motors: str, gears: str = "key,ratio,mass,inertia,efficiency\nG,100,1,0,0.8\n") -> Catalogue:
    (folder / "m.csv").write_text(motors, encoding="utf-8")
    (folder / "g.csv").write_text(gears, encoding="utf-8")
    return ps.load_catalogue(folder / "m.csv", folder / "g.csv")


@pytest.mark.parametrize(
    ("printed", "target", "size"),
    [
        ("min^-1", "rad/s", TURN / 60), ("min-1", "rad/s", TURN / 60), ("r/min", "rad/s", TURN / 60),
        ("U/min", "rad/s", TURN / 60), ("1/min", "rad/s", TURN / 60), ("krpm", "rad/s", 1000 * TURN / 60),
        ("rad/s", "rad/s", 1.0), ("N cm", "N m", 0.01), ("Ncm", "N m", 0.01), ("mNm", "N m", 1e-3),
        ("kgf cm", "N m", STANDARD_GRAVITY / 100), ("kgf m", "N m", STANDARD_GRAVITY),
        ("oz-in", "N m", OUNCE * STANDARD_GRAVITY * INCH), ("lb-in", "N m", 16 * OUNCE * STANDARD_GRAVITY * INCH),
        ("lb-ft", "N m", 192 * OUNCE * STANDARD_GRAVITY * INCH), ("A_rms", "A", 1.0), ("Arms", "A", 1.0),
        ("A rms", "A", 1.0), ("Nm/A_rms", "N m/A", 1.0), ("Nm/Arms", "N m/A", 1.0), ("uH", "H", 1e-6),
        ("µH", "H", 1e-6), ("C/W", "K/W", 1.0), ("°C/W", "K/W", 1.0), ("10^-4 kg m^2", "kg m^2", 1e-4),
        ("x10^-4 kg·m²", "kg m^2", 1e-4), ("gcm²", "kg m^2", 1e-7), ("oz-in-s2", "kg m^2", 0.00706155181),
        ("lb-in^2", "kg m^2", 16 * OUNCE * INCH**2), ("Nm/arcmin", "N m/rad", 60 * 180 / pi),
        ("10^4 Nm/rad", "N m/rad", 1e4), ("Nm/krpm", "N m s/rad", 60 / TURN / 1000), ("V DC", "V", 1.0),
        ("VDC", "V", 1.0), ("lb", "kg", 16 * OUNCE), ("Nms", "N m s/rad", 1.0), ("mNms", "N m s/rad", 1e-3),
        ("mΩ", "ohm", 1e-3), ("V/krpm", "V s/rad", 60 / TURN / 1000), ("%", "", 0.01), ("°C", "degC", 1.0),
        ("h", "h", 1.0), ("min", "s", 60.0), ("hp", "W", 745.69987),
    ],
)  # fmt: skip
def test_any_unit_that_is_printed(printed: str, target: str, size: float) -> None:
    """Section 3 of the audit: of these the reader knew about a third; kgf, oz, lb by their definitions."""
    assert si_size(printed, target) == pytest.approx(size, rel=1e-8)


@pytest.mark.parametrize(
    ("printed", "target"),
    [
        ("kg m/s^2", "N"), ("N m", "J"), ("J/s", "W"), ("W/A", "V"), ("V/A", "ohm"), ("V s/A", "H"), ("C", "K"),
        ("N m/A", "V s"), ("kg m^2/s^3", "W"), ("1000 g", "kg"), ("rad s/s", "rad"), ("100 %", ""),
    ],
)  # fmt: skip
def test_derived_units_are_products_of_the_others(printed: str, target: str) -> None:
    """SI brochure, 9th edition, table 4. A wrong power in the row of a unit is no fault among its own multiples."""
    assert si_size(printed, target) == pytest.approx(1.0, rel=1e-15)


@pytest.mark.parametrize(
    ("target", "sizes"),
    [
        ("kg", {"g": 1e-3, "lb": 0.45359237, "lbs": 0.45359237, "lbm": 0.45359237, "oz": 0.45359237 / 16, "mg": 1e-6}),
        ("m", {"in": 0.0254, "ft": 0.3048, "nm": 1e-9, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "km": 1e3}),
        ("s", {"sec": 1.0, "min": 60.0, "h": 3600.0, "ms": 1e-3}),
        ("N", {"kgf": 9.80665, "kp": 9.80665, "gf": 9.80665e-3, "lbf": 4.4482216152605, "ozf": 0.27801385095378125}),
        ("W", {"kW": 1e3, "MW": 1e6, "hp": 745.69987158}),
        ("rad", {"deg": pi / 180, "arcmin": pi / 10800, "arcsec": pi / 648000, "rev": TURN, "turn": TURN}),
        ("rad/s", {"rad/s": 1.0, "deg/s": pi / 180, "arcmin/s": pi / 10800, "arcsec/s": pi / 648000, "mrad/s": 1e-3}),
        ("rad/s", {"r/s": TURN, "U/s": TURN, "rev/s": TURN, "turn/s": TURN, "1/s": TURN, "rpm": TURN / 60}),
        ("A", {"mA": 1e-3, "kA": 1e3}),
        ("V", {"mV": 1e-3, "kV": 1e3}),
        ("H", {"mH": 1e-3, "nH": 1e-9}),
        ("J", {"kJ": 1e3, "mJ": 1e-3}),
    ],
)  # fmt: skip
def test_every_unit_by_its_definition(target: str, sizes: dict[str, float]) -> None:
    """NIST SP 811, appendix B; a horsepower is 550 foot-pounds of force a second."""
    assert {printed: si_size(printed, target) for printed in sizes} == pytest.approx(sizes, rel=1e-8)


@pytest.mark.parametrize(("printed", "target"), [("furlong", "m"), ("Nm", "N m/A"), ("K", "degC"), ("kg", "kg m^2")])
def test_a_unit_of_something_else_is_refused(printed: str, target: str) -> None:
    with pytest.raises(ValueError, match=f"unknown unit '{printed}'; expected one of {re.escape(target)}"):
        si_size(printed, target)


def test_a_spreadsheet_with_semicolons_and_decimal_commas(tmp_path: Path) -> None:
    motors = (
        "key;mass;inertia[kg cm^2];max_int_torque;max_int_speed[U/min]\nM;1,25;0,5;2,5 Nm;6 000\nN;1.250,5;-;N/A;k.A.\n"
    )
    first, second = load(tmp_path, motors).motors
    assert (first.mass, first.rotor_inertia, first.peak_torque) == pytest.approx((1.25, 5e-5, 2.5))
    assert first.max_speed == pytest.approx(6000 * TURN / 60)
    assert second.mass == 1250.5
    assert np.isnan([second.rotor_inertia, second.peak_torque, second.max_speed]).all()


def test_a_number_that_may_be_thousands_is_not_guessed(tmp_path: Path) -> None:
    catalogue = load(tmp_path, "key;mass;inertia;max_int_torque\nM;1,0;1e-4;1\nN;1.250;1e-4;1\n")
    assert [motor.name for motor in catalogue.motors] == ["M"]
    assert "row 3, column 'mass': '1.250' is not a number: thousands or thousandths?" in catalogue.refused[0]


def test_a_number_below_one_is_no_thousands(tmp_path: Path) -> None:
    """Bug: a table with tabs or semicolons lost the motor with 0.025 kg cm^2, three digits behind a point."""
    tabs = "key,mass,inertia[kg cm^2],max_int_torque\nM,0.125,0.025,1\n".replace(",", "\t")
    catalogue = load(tmp_path, tabs)
    assert catalogue.refused == ()
    assert (catalogue.motors[0].mass, catalogue.motors[0].rotor_inertia) == pytest.approx((0.125, 2.5e-6))


def test_cells_with_units_ratios_and_tolerances(tmp_path: Path) -> None:
    gears = "key,ratio,mass,inertia,efficiency\nG,100:1,800 g,0.3 kg cm^2,76 %\n"
    catalogue = load(tmp_path, "key,mass,inertia,max_int_torque,R\nM,2 lb,1e-4,1.2 ± 10 %,800 mohm\n", gears)
    gearbox, motor = catalogue.gearboxes[0], catalogue.motors[0]
    assert (gearbox.ratio, gearbox.mass, gearbox.inertia, gearbox.efficiency) == pytest.approx((100, 0.8, 3e-5, 0.76))
    assert (motor.mass, motor.peak_torque, motor.resistance) == pytest.approx((0.90718474, 1.2, 0.8))


def test_one_typing_error_does_not_lose_the_file(tmp_path: Path) -> None:
    """Row 148 of a public file has "0.85-3": all of its 600 motors were refused for it."""
    catalogue = load(tmp_path, "key,mass,inertia,max_int_torque\nM,1,1e-4,1\nN,1,0.85-3,1\nO,1,1e-4,2\n")
    assert [motor.name for motor in catalogue.motors] == ["M", "O"]
    assert len(catalogue.refused) == 1
    assert "row 3, column 'inertia': '0.85-3' is not a number" in catalogue.refused[0]


def test_unknown_columns_are_kept_and_listed(tmp_path: Path) -> None:
    """The public T-Motor file was refused for its k_e, diameter and length."""
    catalogue = load(tmp_path, "key,mass,inertia,max_int_torque,frame,max_cont_torqe\nM,1,1e-4,1,60 mm,0.5\n")
    assert catalogue.other["M"] == {"frame": "60 mm", "max_cont_torqe": "0.5"}
    assert "column 'frame' (unknown) of the motors" in catalogue.unused
    assert any("'max_cont_torqe' (unknown; did you mean 'max_cont_torque'?)" in line for line in catalogue.unused)


def test_a_cost_has_any_currency_but_is_no_share(tmp_path: Path) -> None:
    assert load(tmp_path, "key,mass,inertia,max_int_torque,cost[EUR]\nM,1,1e-4,1,240\n").motors[0].cost == 240
    with pytest.raises(ps.InputError, match="column 'cost': unknown unit '%'; expected a currency"):
        load(tmp_path, "key,mass,inertia,max_int_torque,cost[%]\nM,1,1e-4,1,50\n")


def test_the_compatibility_file_of_the_public_database(tmp_path: Path) -> None:
    """MGDB, github.com/ekrimsk/MGDB: a motor, then the gearboxes that fit it, without a header."""
    load(
        tmp_path,
        "key,mass,inertia,max_int_torque\nMM_1,1,1e-4,1\nMM_2,1,1e-4,1\n",
        "key,ratio,mass,inertia,efficiency\nMM_GP32A,10,1,0,0.8\nMM_GP32B,20,1,0,0.8\nMM_GP81,30,1,0,0.8\n",
    )
    (tmp_path / "p.csv").write_text("MM_1,MM_GP32*\nMM_2,MM_GP81,MM_GP99\nMM_7,MM_GP81\n", encoding="utf-8")
    catalogue = ps.load_catalogue(tmp_path / "m.csv", tmp_path / "g.csv", tmp_path / "p.csv")
    assert [(pair.motor, pair.gearbox) for pair in catalogue.pairs or ()] == [
        ("MM_1", "MM_GP32A"), ("MM_1", "MM_GP32B"), ("MM_2", "MM_GP81")
    ]  # fmt: skip
    assert [line.rpartition(": ")[2] for line in catalogue.refused] == [
        "no gearbox has the key 'MM_GP99'", "no motor has the key 'MM_7'"
    ]  # fmt: skip


def test_friction_from_the_no_load_current(tmp_path: Path) -> None:
    """The file has I_nl, and it was used by no check: maxon RE 65, 353297: 0.123 N m/A * 0.289 A = 0.0355 N m."""
    catalogue = load(tmp_path, "key,mass,inertia,max_int_torque,k_t,I_nl\nRE65,2.1,1.34e-4,inf,0.123,0.289\n")
    assert catalogue.motors[0].coulomb_friction == pytest.approx(0.0355, abs=5e-5)  # the digits printed


def test_three_public_data_sheets_as_they_are_printed(tmp_path: Path) -> None:
    """The example of docs/howto/catalogue.md, with its sources: each number in the unit of its sheet."""
    sheet = Path(__file__).parents[2] / "docs" / "howto" / "data_sheets.csv"
    catalogue = ps.load_catalogue(sheet, _gears(tmp_path))
    maxon, pittman, magmotor = catalogue.motors
    assert catalogue.refused == ()
    assert maxon.rotor_inertia == pytest.approx(1340e-7)
    assert maxon.continuous_torque_at(0.0) == 0.8
    assert maxon.thermal_time_constants.tolist() == [123.0, 1060.0]
    # Pittman prints both systems: 21 oz-in (1.5E-01 N m), 159 oz-in (1.1 N m), 4.63 oz-in/A (3.27E-02), 31 oz (885 g).
    printed = (0.15, 1.1, 3.27e-2, 0.885, 2.1e-5)
    found = (
        pittman.continuous_torque,
        pittman.peak_torque,
        pittman.torque_constant,
        pittman.mass,
        pittman.rotor_inertia,
    )
    for value, expected in zip(found, printed, strict=True):
        assert value == pytest.approx(expected, rel=0.03)  # they print two digits
    # Magmotor prints 25.4 oz-in/A and 0.18 N m/A.
    assert magmotor.torque_constant == pytest.approx(0.18, abs=0.005)


def _gears(folder: Path) -> Path:
    file = folder / "g.csv"
    file.write_text("key,ratio,mass,inertia,efficiency\nG,100,1,0,0.8\n", encoding="utf-8")
    return file
