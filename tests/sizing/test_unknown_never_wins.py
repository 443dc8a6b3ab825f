"""Every value that a sheet may leave out: without it a drive is never strong enough unseen.

Found case by case, four times: an unknown derating, an unknown brake, an unknown impact factor and unknown curves
lifted the limits that they belong to. Here each optional value of every part rejects a drive that has all else; without
it the drive must still be rejected, or not be decidable, or its unknown value must be told.
"""

from __future__ import annotations

from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from helpers.arms import pendulum

import puma_septic as ps
from puma_septic.drives import LinearStage, Supply

UNKNOWN = float("nan")
NONE: list[list[float]] = []


def flat(torque: float) -> list[list[float]]:
    """A curve over the speed."""
    return [[0.0, torque], [1e4, torque]]


# All that a sheet may tell, and everything kept. Torques and speeds fit the pendulum below.
PARTS: dict[str, dict[str, Any]] = {
    "motor": {
        "rotor_inertia": 1e-5, "viscous_friction": 1e-6, "coulomb_friction": 1e-3, "torque_constant": 0.1,
        "current": "rms", "resistance": 0.1, "voltage_constant": 0.1, "inductance": 1e-4, "pole_pairs": 4.0,
        "max_field_current": 1.0, "peak_torque": 10.0, "continuous_torque": 0.6, "max_speed": 1e4, "peak_power": 1e5,
        "rated_ambient_celsius": 35.0, "ambient_derating": 0.0, "altitude_curve": [[0, 1], [5000, 1]],
        "geared_share": 1.0, "standstill_torque": 10.0, "brake_torque": 10.0, "brake_inertia": 1e-6,
        "brake_stop_energy": 1e6, "brake_total_energy": 1e12, "max_winding_celsius": 155.0,
        "thermal_resistances": [1.0], "thermal_time_constants": [500.0], "max_inertia_ratio": 1e9,
    },
    "gearbox": {
        "ratio": 50.0, "kind": "strain wave", "efficiency": 0.9, "backward_efficiency": 0.9, "inertia": 1e-6,
        "no_load_torque": 1e-3, "rated_torque": 1e3, "rated_speed": 200.0, "rated_life_hours": 1e4, "life_basis": "L10",
        "max_average_torque": 1e3, "max_repeated_torque": 1e3, "max_momentary_torque": 1e3,
        "max_average_input_speed": 1e4, "max_input_speed": 1e4, "max_tilting_moment": 1e4, "max_axial_force": 1e4,
        "max_radial_force": 1e4, "bearing_dynamic_load": 1e6, "bearing_static_load": 1e6, "bearing_diameter": 0.1,
    },
    "drive": {
        "bus_voltage": 1e3, "continuous_current": 1e3, "peak_current": 1e3, "continuous_power": 1e5,
        "peak_power": 1e5, "peak_regenerated_power": 1e5, "storable_energy": 1e3, "brake_resistor_power": 1e5,
    },
    "stage": {
        "efficiency": 0.9, "backward_efficiency": 0.9, "inertia": 1e-6, "friction_force": 1.0, "max_force": 1e5,
        "max_speed": 1e4,
    },
    "supply": {
        "bus_voltage": 300.0, "peak_power": 1e5, "continuous_power": 1e5, "max_current": 1e3, "storable_energy": 1e3,
        "brake_resistor_power": 1e5, "peak_brake_power": 1e5, "standby_power": 1.0,
    },
    "train": {
        "max_effort": 1e4, "momentary_torque": 1.0, "emergency_stops": 10.0, "emergency_duration": 0.1,
        "required_life_hours": 5e3, "max_inertia_ratio": 1e9, "ambient_celsius": 35.0, "with_brake": True,
    },
}  # fmt: skip

# (part, value) -> what rejects the drive, what else the case needs. Unknown then means that value alone (or `unknown`).
REJECTS: dict[tuple[str, str], dict[str, Any]] = {
    ("motor", "rotor_inertia"): {"harsh": 10.0},
    ("motor", "viscous_friction"): {"harsh": 10.0},
    ("motor", "coulomb_friction"): {"harsh": 20.0},
    ("motor", "torque_constant"): {"harsh": 1e-5},
    ("motor", "resistance"): {"harsh": 1e4},
    ("motor", "inductance"): {"harsh": 100.0},
    ("motor", "pole_pairs"): {"harsh": 1e7},
    ("motor", "max_field_current"): {
        "harsh": 1e-9,
        "with": {"motor": {"inductance": 2e-3, "max_field_current": 20.0}, "drive": {"bus_voltage": 40.0}},
    },
    ("motor", "peak_torque"): {"harsh": 1e-3},
    ("motor", "peak_curve"): {"harsh": flat(1e-3), "unknown": NONE},
    ("motor", "peak_curves"): {"harsh": [(48.0, flat(1e-3))], "unknown": ()},
    ("motor", "continuous_torque"): {"harsh": 1e-3},
    ("motor", "continuous_curve"): {
        "harsh": flat(1e-3), "unknown": NONE, "with": {"motor": {"continuous_torque": UNKNOWN}}
    },
    ("motor", "continuous_curves"): {
        "harsh": [(48.0, flat(1e-3))], "unknown": (), "with": {"motor": {"continuous_torque": UNKNOWN}}
    },
    ("motor", "rated_ambient_celsius"): {"harsh": 0.0, "with": {"motor": {"ambient_derating": 0.02}}},
    # From the winding's highest temperature, which is not known either.
    ("motor", "ambient_derating"): {
        "harsh": 0.02,
        "with": {"motor": {"max_winding_celsius": UNKNOWN}, "train": {"ambient_celsius": 60.0}},
    },
    ("motor", "altitude_curve"): {
        "harsh": [[0, 1], [1000, 1], [3000, 0.3]], "unknown": NONE, "with": {"train": {"altitude": 3000.0}}
    },
    ("motor", "geared_share"): {"harsh": 0.3},
    ("motor", "standstill_torque"): {"harsh": 1e-3},
    ("motor", "brake_torque"): {"harsh": 1e-3},
    ("motor", "brake_inertia"): {"harsh": 10.0},
    ("motor", "brake_stop_energy"): {"harsh": 1e-9},
    ("motor", "brake_total_energy"): {"harsh": 1e-9},
    ("motor", "max_speed"): {"harsh": 1e-2},
    ("motor", "peak_power"): {"harsh": 1e-3},
    ("motor", "max_winding_celsius"): {"harsh": 35.01},
    ("motor", "thermal_resistances"): {
        "harsh": [1e4], "unknown": NONE, "with": {"motor": {"thermal_time_constants": NONE}},
        "told": "winding temperature rise: needs its thermal resistances",
    },
    ("motor", "thermal_time_constants"): {
        "harsh": [0.05], "unknown": NONE,
        "with": {"motor": {"thermal_resistances": [20.0], "max_winding_celsius": 200.0}},
    },
    ("motor", "max_inertia_ratio"): {"harsh": 1e-9},
    ("gearbox", "kind"): {
        "harsh": "planetary", "unknown": "", "with": {"gearbox": {"impact_curve": [[0, 200.0], [9000, 200.0]]}}
    },
    ("gearbox", "efficiency"): {"harsh": 1e-3},
    ("gearbox", "efficiency_map"): {
        "harsh": [[0, 1, 1e-3], [0, 100, 1e-3]], "unknown": NONE,
        "with": {"gearbox": {"efficiency": UNKNOWN, "backward_efficiency": UNKNOWN, "no_load_torque": UNKNOWN}},
    },
    ("gearbox", "backward_efficiency"): {"harsh": 1.0, "with": {"motor": {"continuous_torque": 0.56}}},
    ("gearbox", "inertia"): {"harsh": 10.0},
    ("gearbox", "no_load_torque"): {"harsh": 20.0},
    ("gearbox", "rated_torque"): {"harsh": 1e-3},
    ("gearbox", "rated_speed"): {"harsh": 1e-9},
    ("gearbox", "rated_life_hours"): {"harsh": 1e-9},
    ("gearbox", "life_basis"): {"harsh": "L50", "unknown": "", "with": {"train": {"required_life_hours": 2e8}}},
    ("gearbox", "max_average_torque"): {"harsh": 1e-3},
    ("gearbox", "max_repeated_torque"): {"harsh": 1e-3},
    ("gearbox", "max_momentary_torque"): {"harsh": 1e-3},
    ("gearbox", "impact_curve"): {
        "harsh": [[0, 200.0], [9000, 200.0]], "unknown": NONE, "with": {"gearbox": {"kind": "planetary"}}
    },
    ("gearbox", "max_average_input_speed"): {"harsh": 1e-3},
    ("gearbox", "max_input_speed"): {"harsh": 1e-3},
    ("gearbox", "max_tilting_moment"): {"harsh": 1e-3},
    ("gearbox", "max_axial_force"): {"harsh": 1e-3},
    ("gearbox", "max_radial_force"): {"harsh": 1e-3},
    ("gearbox", "bearing_dynamic_load"): {"harsh": 1e-3},
    ("gearbox", "bearing_static_load"): {"harsh": 1e-3},
    ("gearbox", "bearing_diameter"): {"harsh": 1e-9},
    ("drive", "bus_voltage"): {"harsh": 1.0},
    ("drive", "continuous_current"): {"harsh": 1e-3},
    ("drive", "peak_current"): {"harsh": 1e-3},
    ("drive", "continuous_power"): {"harsh": 1e-3},
    ("drive", "peak_power"): {"harsh": 1e-3},
    ("drive", "peak_regenerated_power"): {"harsh": 1e-3},
    ("drive", "storable_energy"): {"harsh": 1e-6, "with": {"drive": {"brake_resistor_power": UNKNOWN}}},
    ("drive", "brake_resistor_power"): {"harsh": 1e-6, "with": {"drive": {"storable_energy": 0.0}}},
    ("stage", "efficiency"): {"harsh": 1e-6},
    ("stage", "backward_efficiency"): {"harsh": 1.0, "with": {"motor": {"continuous_torque": 0.585}}},
    ("stage", "inertia"): {"harsh": 100.0},
    ("stage", "friction_force"): {"harsh": 1e6},
    ("stage", "max_force"): {"harsh": 1e-3},
    ("stage", "max_speed"): {"harsh": 1e-3},
    ("supply", "bus_voltage"): {"harsh": 1e-3},
    ("supply", "peak_power"): {"harsh": 1e-3},
    ("supply", "continuous_power"): {"harsh": 1e-3},
    ("supply", "max_current"): {"harsh": 1e-3},
    ("supply", "storable_energy"): {"harsh": 1e-6, "with": {"supply": {"brake_resistor_power": UNKNOWN}}},
    ("supply", "brake_resistor_power"): {"harsh": 1e-6, "with": {"supply": {"storable_energy": 0.0}}},
    ("supply", "peak_brake_power"): {"harsh": 1e-6},
    ("supply", "standby_power"): {"harsh": 1e6},
    ("train", "max_effort"): {"harsh": 1e-3},
    ("train", "momentary_torque"): {"harsh": 1e9},
    ("train", "emergency_duration"): {"harsh": 1e9},
    ("train", "measured_friction"): {
        "harsh": ps.Friction(viscous=0.0, coulomb=[20.0, -20.0]),
        "unknown": ps.Friction(),
        "with": {
            "motor": {"viscous_friction": UNKNOWN, "coulomb_friction": UNKNOWN},
            "gearbox": {"efficiency": UNKNOWN, "backward_efficiency": UNKNOWN, "no_load_torque": UNKNOWN},
        },
    },
}  # fmt: skip

# No value of these is unknown, or none rejects anything.
OTHERS = {
    "what it is called, and who says so": {"name", "source"},
    "ranked after those that are known": {"mass", "cost"},
    "what a sheet states by leaving it out, as the documentation of the part says": {
        "current", "winding", "voltage", "copper_coefficient", "reference_celsius", "bearing_offset", "altitude",
        "with_brake", "ambient_celsius",
    },
    "follows from the torque constant, as power demands": {"voltage_constant"},
    "what the joint asks for, not what a part can do": {"emergency_stops", "required_life_hours", "max_inertia_ratio"},
    "the parts themselves": {"motor", "gearbox", "drive", "stage"},
    "no drive train, or no stage, without it": {"ratio", "kind", "travel_per_turn"},
    "without it the no-load torque counts on top, which is more": {"efficiency_torque"},
    "held against no limit, and listed as unknown by `Compliance`": {"stiffness", "stiffness_torques", "backlash"},
    "of the joint, in place of the parts that are chosen here": {"armature", "friction_at_joint"},
}  # fmt: skip
KINDS = {
    "motor": ps.Motor, "gearbox": ps.Gearbox, "drive": ps.Drive, "stage": LinearStage, "supply": Supply,
    "train": ps.Drivetrain,
}  # fmt: skip


def test_every_value_of_every_part_is_here() -> None:
    """A new value of a part must say here how it rejects, or why it cannot."""
    none = set[str]().union(*OTHERS.values())
    for part, kind in KINDS.items():
        own = {one.name for one in fields(kind)}
        assert own - none == {name for of, name in REJECTS if of == part} - none, part


@cache
def cycle(kind: str, folder: Path) -> ps.Cycle:
    """A leaning pendulum swung up, held, and let down; or a mass pushed to and fro. 0.9 s: 4000 cycles an hour."""
    arm = pendulum(folder, kind=kind, gravity=(0.0, 4.0, -8.9))
    move = ps.quintic_segments([[0.2], [2.0]], [0.0, 0.35], joint_names=arm.joint_names)
    return ps.cycle.with_return(ps.compute_motion(arm, move), dwell=0.1)


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("unknown")


def train(part: str, changes: dict[str, dict[str, Any]]) -> tuple[ps.Drivetrain, ps.sizing.Conditions]:
    """With all that is known but for what is changed, by part; and the supply that is shared."""
    own = {name: values | changes.get(name, {}) for name, values in PARTS.items()}
    one = ps.Drivetrain(
        motor=ps.Motor(name="M", **own["motor"]),
        gearbox=ps.Gearbox(name="G", **own["gearbox"]),
        drive=ps.Drive(**own["drive"]),
        stage=LinearStage(kind="screw", travel_per_turn=0.5, **own["stage"]) if part == "stage" else None,
        **own["train"],
    )
    return one, ps.sizing.Conditions(supply=Supply(**own["supply"]))


def sizing(folder: Path, part: str, **changes: dict[str, Any]) -> ps.Sizing:
    """Of the drive train, which a selection from a catalogue of it alone must judge likewise."""
    one, asked = train(part, changes)
    work = cycle("prismatic" if part == "stage" else "revolute", folder)
    found = ps.size(work, drivetrains=[one], conditions=asked)
    pair = ps.drives.Pair(motor="M", gearbox="G", friction=one.measured_friction, max_effort=one.max_effort)
    catalogue = ps.Catalogue(motors=[one.motor], gearboxes=[one.gearbox], pairs=[pair])
    (joint,) = ps.size(work, catalogue=catalogue, drivetrains=[one], conditions=asked).joints
    rejected = any(check.joint == "swing" for check in found.violations)
    assert bool(joint.rejections) == rejected
    assert bool(joint.kept) == (not rejected and not found.lacking)
    assert set(joint.unknowns) == (set() if rejected else set(found.lacking.get("swing", ())))
    return found


def context(case: dict[str, Any], part: str, changes: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """What the case needs, and the changes of one part."""
    given = case.get("with", {})
    return {**given, part: {**given.get(part, {}), **changes}}


@pytest.mark.parametrize("part", ["motor", "stage"])
def test_all_that_is_known_is_kept(part: str, folder: Path) -> None:
    found = sizing(folder, part)
    assert (found.is_feasible, found.lacking, found.warnings) == (True, {}, ())


@pytest.mark.slow
@pytest.mark.parametrize(("part", "name"), REJECTS, ids=[f"{part}-{name}" for part, name in REJECTS])
def test_what_is_left_out_does_not_win(part: str, name: str, folder: Path) -> None:
    case = REJECTS[part, name]
    harsh, open_ = (
        sizing(folder, part, **context(case, part, {name: value}))
        for value in (case["harsh"], case.get("unknown", UNKNOWN))
    )
    assert harsh.violations or harsh.warnings
    if name in PARTS[part]:
        usual = sizing(folder, part, **context(case, part, {}))
        assert (usual.violations, usual.warnings) == ((), ())
    lines = {*open_.not_assessed, *open_.remarks}
    told = lines - {*harsh.not_assessed, *harsh.remarks} | {
        line for line in lines if line.startswith(case.get("told", "?"))
    }
    assert open_.violations or open_.lacking or told
