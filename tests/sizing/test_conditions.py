"""What is asked of drives, and what is said of values that no sheet tells."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from helpers.duty import paper_motion

import puma_septic as ps
from puma_septic.drives import LinearStage
from puma_septic.limit_check import LimitCheck
from puma_septic.sizing import Conditions
from puma_septic.sizing._unknowns import unknowns
from puma_septic.task import make_task

SCREW = LinearStage(kind="screw", name="S", travel_per_turn=0.01, efficiency=0.9, inertia=0.0, friction_force=0.0)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"peak_power": 0.0}, "peak_power = 0 W must be greater than 0 W"),
        ({"altitude": [100.0, -1.0]}, r"altitude\[1\] = -1 m must be at least 0 m"),
        ({"supply": 48.0}, "supply: expected a Supply, got float"),
        ({"stages": {"joint1": 0.01}}, "stages: joint 'joint1': expected a LinearStage, got float"),
        ({"margins": {"torque": 0.1}}, "margins: unknown check 'torque'; valid: all, physics, "),
        ({"margins": {"inertia ratio": 0.1}}, "margins: unknown check 'inertia ratio'"),  # of a rule of thumb
        ({"margins": -0.1}, "margin of all = -0.1 must be at least 0"),
        ({"margins": {"physics": 1.0}}, "margin of physics = 1.0: must be less than 1"),
    ],
)
def test_what_cannot_be_asked_for(asked: dict[str, Any], message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        Conditions(**asked)


def test_places_have_what_is_asked_of_all_or_of_each() -> None:
    """It may be colder than 0 degrees; what is not asked leaves what a joint has."""
    own = ps.Drivetrain(drive=ps.Drive(bus_voltage=24.0, peak_current=5.0), momentary_torque=7.0)
    asked = Conditions(ambient_celsius=-10.0, bus_voltage=[48.0, np.nan], with_brake=True, stages={"slide": SCREW})
    turn, slide = asked.places(["turn", "slide"], [own, own])
    assert [one.ambient_celsius for one in (turn, slide)] == [-10.0, -10.0]
    assert [one.drive.bus_voltage for one in (turn, slide)] == [48.0, 24.0]
    assert [one.drive.peak_current for one in (turn, slide)] == [5.0, 5.0]
    assert [one.momentary_torque for one in (turn, slide)] == [7.0, 7.0]
    assert [one.stage for one in (turn, slide)] == [None, SCREW]
    assert [one.with_brake for one in (turn, slide)] == [True, True]
    assert Conditions().places(["turn"], [own]) == (own,)
    assert Conditions().places(["turn"], None)[0].gearbox.ratio == 1.0
    with pytest.raises(ps.InputError, match="bus_voltage: 2 values for 1 joints; give one for all or one for each"):
        Conditions(bus_voltage=[48.0, 24.0]).places(["turn"], [own])
    with pytest.raises(ps.InputError, match="unknown joint of stages 'slide'; valid: 'turn'"):
        asked.places(["turn"], [own])


def test_the_most_particular_margin_counts() -> None:
    asked = Conditions(margins={"all": 0.5, "physics": 0.2, "motor torque": 0.0})
    assert asked.margin("physics", "motor torque") == 0.0
    assert asked.margin("physics", "motor speed") == 0.2
    assert asked.margin("vendor procedure", "gearbox life") == 0.5
    assert Conditions().margin("physics", "motor speed") == 0.0
    check = LimitCheck.of_magnitude(
        joint="turn", quantity="motor speed", demand=80.0, limit=100.0, unit="rad/s", time=0.0, kind="physics"
    )
    assert asked.stress(check) == 1.0
    assert asked.is_kept(check)
    assert not Conditions(margins=0.201).is_kept(check)


def test_the_document_has_what_is_asked_for_alone() -> None:
    assert Conditions().to_dict() == {}
    asked = Conditions(bus_voltage=48.0, with_brake=True, stages={"slide": SCREW}, supply=ps.Supply(), margins=0.1)
    assert asked.to_dict() == {
        "bus_voltage": 48.0, "with_brake": True, "supply": "a shared bus", "margins": {"all": 0.1},
        "stages": {"slide": "screw, S, travel_per_turn 0.01, efficiency 0.9, inertia 0, friction_force 0"},
    }  # fmt: skip
    assert Conditions(supply=ps.Supply(name="PSU")).to_dict() == {"supply": "PSU"}


FULL: dict[str, dict[str, Any]] = {
    "motor": {
        "rotor_inertia": 1e-4, "viscous_friction": 0.0, "coulomb_friction": 0.0, "continuous_torque": 1.0,
        "rated_ambient_celsius": 40.0, "geared_share": 1.0, "torque_constant": 0.1, "resistance": 0.5,
        "pole_pairs": 4.0, "inductance": 1e-3, "max_winding_celsius": 150.0, "thermal_resistances": [1.0],
        "thermal_time_constants": [600.0], "max_field_current": 1.0,
    },
    "gearbox": {
        "ratio": 80.0, "kind": "planetary", "life_basis": "L10", "efficiency": 0.8, "backward_efficiency": 0.7,
        "inertia": 0.0, "no_load_torque": 0.0, "max_average_torque": 100.0, "rated_life_hours": 7000.0,
    },
    "drive": {"bus_voltage": 48.0},
}  # fmt: skip


def told(**changes: dict[str, Any]) -> tuple[str, ...]:
    """What is said of a full sheet with some values changed, of joint 1 of the paper's motion and back."""
    given = {part: values | changes.get(part, {}) for part, values in FULL.items()}
    train = ps.Drivetrain(
        motor=ps.Motor(**given["motor"]), gearbox=ps.Gearbox(**given["gearbox"]), drive=ps.Drive(**given["drive"]),
        required_life_hours=1e4,
    )  # fmt: skip
    load = ps.sizing.joint_load(ps.cycle.with_return(paper_motion(loaded=False)), 0)
    return unknowns(ps.sizing.Demands(load=load, train=train, motor=ps.sizing.motor_load(load, train)))


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"motor": {"rotor_inertia": np.nan}}, "unknown and left out of the torque: rotor inertia"),
        (
            {"motor": {"rated_ambient_celsius": np.nan}},
            "unknown and taken as 40 degrees Celsius: the ambient of the motor's continuous torque",
        ),
        (
            {"motor": {"geared_share": np.nan}},
            "unknown and left out of the continuous torque: what a gearbox at the flange takes off it",
        ),
        (
            {"motor": {"inductance": np.nan}},
            "unknown and left out of the voltage: the winding's reactance (pole pairs and inductance)",
        ),
        (
            {"motor": {"thermal_resistances": [], "thermal_time_constants": []}},
            "unknown and taken as its sheet's: the winding's temperature, in voltage and power",
        ),
        (
            {"drive": {"bus_voltage": np.nan}},
            "unknown and left out of the current: what weakens the field (at an unknown bus voltage)",
        ),
        (
            {"motor": {"max_winding_celsius": np.nan}},
            "unknown and taken as its sheet's: the winding's highest temperature, in the field's current",
        ),
        (
            {"gearbox": {"kind": ""}},
            "unknown and taken as strain wave: the kind of the gears, whose rules their limits follow",
        ),
        ({"gearbox": {"life_basis": ""}}, "unknown and taken as L10: the basis of the gears' rated life"),
    ],
)
def test_a_value_that_no_sheet_tells_has_its_line(changes: dict[str, Any], line: str) -> None:
    assert line in told(**changes)


def test_of_a_full_sheet_and_of_what_needs_no_value_nothing_is_said() -> None:
    assert told() == ()
    # Direct current has no reactance; what is not limited has no rule.
    direct = {"pole_pairs": np.nan, "inductance": np.nan, "max_field_current": np.nan}
    assert told(motor=direct) == ()
    unlimited = {"kind": "", "life_basis": "", "max_average_torque": np.nan, "rated_life_hours": np.nan}
    assert told(gearbox=unlimited) == ()
    no_torque = {"continuous_torque": np.nan, "rated_ambient_celsius": np.nan, "geared_share": np.nan}
    assert told(motor=no_torque) == ()


def test_sea_level_is_an_altitude() -> None:
    """0 m was refused, as if it were a mass."""
    assert float(np.asarray(Conditions(altitude=0.0).altitude)) == 0.0
    section = {"name": "sea", "points": [{"joints": [0.0] * 6}, {"joints": [0.5] * 6}], "times": [0, 1]}
    task = make_task({**section, "profiles": ["quintic"], "conditions": {"altitude": 0}})
    assert task.conditions is not None
    assert task.conditions.altitude == 0.0
