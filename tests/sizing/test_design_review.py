"""The audit of version 0.1.0, case by case: what unknown data mean, what a selection is told and tells."""

from __future__ import annotations

import csv
import io
import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.arms import pendulum
from helpers.duty import paper_motion

import puma_septic as ps
from puma_septic.cli import main
from puma_septic.drives import LEAST_SET
from puma_septic.report.csv import load_profile_csv, motor_profile_csv
from puma_septic.sizing import Conditions, LoadCase
from puma_septic.sizing._brake import worst_stops
from puma_septic.task import make_task, resolve_task

MOTOR: dict[str, Any] = {
    "name": "M", "rotor_inertia": 1e-4, "continuous_torque": 0.6, "peak_torque": 2.0, "max_speed": 500.0,
    "torque_constant": 0.1, "resistance": 0.5, "mass": 1.0,
}  # fmt: skip
GEARBOX: dict[str, Any] = {
    "name": "G", "ratio": 100.0, "efficiency": 0.76, "inertia": 1e-5, "max_average_torque": 120.0,
    "max_repeated_torque": 200.0, "max_momentary_torque": 400.0, "mass": 1.0,
}  # fmt: skip


@cache
def cycle() -> ps.Cycle:
    return ps.cycle.with_return(paper_motion(), dwell=0.5)


def catalogue(**changes: Any) -> ps.Catalogue:
    """One pair with full data, but for what is changed."""
    motor = {key: value for key, value in changes.items() if key in ps.Motor.__dataclass_fields__ and key != "mass"}
    gearbox = {key: value for key, value in changes.items() if key not in motor}
    return ps.Catalogue(motors=[ps.Motor(**MOTOR | motor)], gearboxes=[ps.Gearbox(**GEARBOX | gearbox)])


# ---- W1, W7, W10: unknown never wins


@pytest.mark.slow
def test_a_bare_part_does_not_win() -> None:
    """A motor of which nothing but 0.01 kg was known was strong enough everywhere, first by mass, cost and margin."""
    bare = ps.Motor(name="bare", mass=0.01)
    found = ps.Catalogue(
        motors=[bare, ps.Motor(**MOTOR)],
        gearboxes=[ps.Gearbox(name="bare gears", ratio=100.0, mass=0.01), ps.Gearbox(**GEARBOX)],
    )
    for rank in ("mass", "cost", "margin"):
        selection = ps.size(cycle(), catalogue=found, rank=rank)  # type: ignore[call-overload]
        assert {(one.best.motor, one.best.gearbox) for one in selection.joints} == {("M", "G")}
        assert all("bare" in f"{c.motor} {c.gearbox}" for one in selection.joints for c in one.undecided)
    assert selection.verdict.endswith("18 pairs not decidable")
    alone = ps.size(cycle(), catalogue=ps.Catalogue(motors=[bare], gearboxes=found.gearboxes[:1]))
    assert (alone.is_feasible, alone.can_be_decided) == (False, False)
    assert "not decidable for joint1 (1 pair left, most often unknown: rotor inertia of the motor)" in alone.verdict


@pytest.mark.parametrize(
    ("name", "missing"),
    [
        ("rotor_inertia", "rotor inertia of the motor"), ("continuous_torque", "continuous torque of the motor"),
        ("peak_torque", "peak torque of the motor"), ("max_speed", "highest speed of the motor"),
        ("max_average_torque", "average torque of the gearbox"),
        ("max_repeated_torque", "repeated peak torque of the gearbox"),
        ("efficiency", "efficiency or measured friction of the gearbox"),
    ],
)  # fmt: skip
@pytest.mark.slow
def test_each_of_the_least_set_decides(name: str, missing: str) -> None:
    assert missing in LEAST_SET
    joint = ps.size(cycle(), catalogue=catalogue(**{name: np.nan})).joint("joint1")
    assert joint.best is None
    assert joint.undecided[0].lacking == (missing,)
    assert joint.unknowns == {missing: 1}
    assert joint.why("M", "G") == f"M with G is not decidable: {missing} unknown; every known limit is kept"


@pytest.mark.parametrize("name", ["rated_life_hours", "rated_torque", "rated_speed"])
def test_a_life_that_is_asked_for_and_not_told_does_not_win(name: str) -> None:
    """Gears of unknown life once won whatever life was asked for; where none is, it decides nothing."""
    untold, asked = catalogue(**{name: np.nan}), Conditions(required_life_hours=1.0)
    joint = ps.size(cycle(), catalogue=untold, conditions=asked).joint("joint1")
    assert joint.best is None
    assert joint.undecided[0].lacking == ("rated life, torque and speed of the gearbox",)
    assert ps.size(cycle(), catalogue=untold).joint("joint1").best is not None
    told = catalogue(rated_life_hours=1e6, rated_torque=1e3, rated_speed=1e3)
    assert ps.size(cycle(), catalogue=told, conditions=asked).joint("joint1").best is not None


@pytest.mark.parametrize("asked", [Conditions(ambient_celsius=55.0), Conditions(altitude=3000.0)])
def test_an_unknown_derating_does_not_lift_the_continuous_torque(asked: Conditions) -> None:
    """In the heat or up high, a motor whose sheet has no derating was held to no continuous torque, and won."""
    missing = "continuous torque at this ambient and altitude of the motor"
    unsaid = catalogue(max_winding_celsius=np.nan)
    joint = ps.size(cycle(), catalogue=unsaid, conditions=asked).joint("joint1")
    assert joint.undecided[0].lacking == (missing,)
    assert joint.best is None
    weak = catalogue(max_winding_celsius=np.nan, continuous_torque=0.001)
    joint = ps.size(cycle(), catalogue=weak, conditions=asked).joint("joint1")
    assert joint.rejections == {"RMS motor torque at mean speed": 1}
    assert ps.size(cycle(), catalogue=unsaid).joint("joint1").best is not None


def test_a_known_limit_rejects_whatever_else_is_unknown() -> None:
    joint = ps.size(cycle(), catalogue=catalogue(continuous_torque=np.nan, max_speed=1.0)).joint("joint2")
    assert not joint.is_undecided.any()
    assert joint.can_be_decided
    assert joint.rejections == {"motor speed": 1}


def test_nothing_that_can_be_decided_is_exit_code_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It was 0, and the headline "a pair that is strong enough for every joint"."""
    motors, gears = tmp_path / "m.csv", tmp_path / "g.csv"
    motors.write_text("key,mass,inertia,max_int_torque\nM,0.01,,\n", encoding="utf-8")
    gears.write_text("key,ratio,mass,inertia,efficiency\nG,100,0.01,,\n", encoding="utf-8")
    assert main(["size", "--catalogue", str(motors), str(gears)]) == 3
    assert "not decidable for joint1" in capsys.readouterr().out


def test_a_direct_drive_needs_no_data_of_gears() -> None:
    direct = ps.Catalogue(
        motors=[ps.Motor(**MOTOR | {"peak_torque": 200.0, "continuous_torque": 150.0})],
        gearboxes=[ps.Gearbox(name="none", ratio=1.0)],
    )
    assert ps.size(cycle(), catalogue=direct).is_feasible


@pytest.mark.slow
def test_thermal_resistances_alone_reject() -> None:
    """640 public motors have no time constants: (R1 + R2) P was thrown away, and is the mean rise at least."""
    heat = {"thermal_resistances": [1.0, 2.0], "max_winding_celsius": 120.0}
    joint = ps.size(cycle(), catalogue=catalogue(**heat)).joint("joint2")
    (check,) = [c for c in joint.best.checks if c.quantity == "mean winding temperature rise"]
    current = joint.best.demands.rms_torque / MOTOR["torque_constant"]
    copper = 1 + 0.00393 * (40.0 - 20.0)  # at the ambient temperature, from the sheet's 20 degrees
    assert check.demand == pytest.approx(3.0 * MOTOR["resistance"] * copper * current**2, rel=1e-12)
    hot = ps.size(cycle(), catalogue=catalogue(**heat | {"max_winding_celsius": 40.0 + 0.99 * check.demand}))
    assert hot.joint("joint2").rejections == {"mean winding temperature rise": 1}
    # With time constants the steady cycle has this mean and more: the copper grows with its own heat.
    known = catalogue(**heat | {"thermal_time_constants": [20.0, 600.0]})
    full = ps.size(cycle(), catalogue=known).joint("joint2").best.demands
    mean = full.temperature_rise.integral()(full.temperature_rise.breaks[-1])[0] / full.temperature_rise.duration
    assert 1.0 < mean / check.demand < 1.2


# ---- W3: conditions


@pytest.mark.slow
def test_conditions_hold_for_a_catalogue() -> None:
    """A drives file with 1 mA was ignored beside a catalogue, and no option gave a life, a voltage or a margin."""
    pair = catalogue(rated_life_hours=1.0, rated_torque=10.0, rated_speed=100.0)
    for condition, check in (
        ({"peak_current": 0.001}, "peak current"),
        ({"bus_voltage": 1.0}, "voltage at torque and speed"),
        ({"required_life_hours": 1e9}, "gearbox life"),
        ({"momentary_torque": 500.0}, "gearbox momentary peak torque"),
        ({"max_inertia_ratio": 1e-6}, "load inertia over rotor inertia"),
        ({"continuous_current": 1e-6}, "RMS current"),
    ):
        joint = ps.size(cycle(), catalogue=pair, conditions=Conditions(**condition)).joint("joint2")
        assert joint.rejections == {check: 1}


@pytest.mark.slow
def test_a_margin_rejects_and_is_named_per_check() -> None:
    governing = ps.size(cycle(), catalogue=catalogue()).joint("joint2").best.governing
    left = governing.margin
    for margins, fits in (
        ({"all": left - 0.01}, True), ({"all": left + 0.01}, False), ({governing.quantity: left + 0.01}, False),
        ({governing.kind: left + 0.01}, False), ({"all": left + 0.01, governing.quantity: 0.0}, True),
    ):  # fmt: skip
        found = ps.size(cycle(), catalogue=catalogue(), conditions=Conditions(margins=margins)).joint("joint2")
        assert bool(found.kept) == fits
        if not fits:
            assert found.rejections == {governing.quantity: 1}


def test_an_unknown_brake_does_not_lift_the_limit_of_the_inertia_ratio() -> None:
    """With brakes at rest and sheets that leave out their inertia, no pair was held to the ratio that was asked for."""
    asked = Conditions(max_inertia_ratio=1e-6)
    train = ps.Drivetrain(motor=ps.Motor(rotor_inertia=1e-4), gearbox=ps.Gearbox(ratio=100.0), with_brake=True)
    sized = ps.size(cycle(), drivetrains=[train] * 6, conditions=asked)
    ratios = {check.joint: check for check in sized.violations if check.quantity == "load inertia over rotor inertia"}
    assert len(ratios) == 6
    largest = float(ps.sizing.joint_load(cycle(), 0).inertia.extrema().max[0])
    assert ratios["joint1"].demand == pytest.approx(largest / 100.0**2 / 1e-4)


def test_the_inertia_ratio_is_counted_as_motor_makers_do() -> None:
    """Yaskawa's example: (1.58 + 0.71) kg cm^2 over a rotor of 0.26 kg cm^2 is 8.8; with the gears at the motor 1.6."""
    train = ps.Drivetrain(
        motor=ps.Motor(rotor_inertia=0.26e-4), gearbox=ps.Gearbox(ratio=1.0, inertia=0.71e-4), max_inertia_ratio=8.0
    )
    load = ps.sizing.joint_load(cycle(), 0)
    demands = ps.sizing.Demands(load=load, train=train, motor=ps.sizing.motor_load(load, train))
    largest = float(load.inertia.extrema().max[0])
    assert demands.load_inertia_ratio.size == pytest.approx((largest + 0.71e-4) / 0.26e-4)
    assert pytest.approx(8.8, abs=0.05) == (1.58e-4 + 0.71e-4) / 0.26e-4


def test_cycle_rate_and_brake_shape_the_cycle() -> None:
    """Times and rests were to be worked out by hand."""
    text = {
        "name": "rate", "points": [{"joints": [0.0] * 6}, {"joints": [0.5] * 6}], "times": [0, 1],
        "profiles": ["quintic"], "conditions": {"cycles_per_minute": 12, "brake_at_rest": True},
    }  # fmt: skip
    (case,) = ps.sizing.load_cases_of(resolve_task(make_task(text)))
    assert case.cycle.duration == pytest.approx(5.0)
    assert [step.holding_brake for step in case.cycle.steps if isinstance(step, ps.Dwell)] == [True, True]
    fast = make_task({**text, "conditions": {"cycles_per_minute": 40}})
    with pytest.raises(
        ps.InputError, match=r"a cycle has 1\.5 s, but its 2 moves take 2 s; at most 30 cycles a minute"
    ):
        ps.sizing.load_cases_of(resolve_task(fast))


def test_altitude_and_the_shared_supply_are_conditions_of_a_task() -> None:
    section = {"altitude": 2000, "supply": {"bus_voltage": 48, "max_current": 0.001}, "cycles_per_minute": 3}
    text = {
        "name": "high", "points": [{"joints": [0.0] * 6}, {"joints": [0.5] * 6}], "times": [0, 1],
        "profiles": ["quintic"], "conditions": section,
    }  # fmt: skip
    resolved = resolve_task(make_task(text))
    asked = ps.sizing.conditions_of(resolved.task.conditions)
    assert float(np.asarray(asked.altitude)) == 2000.0
    derated = catalogue(altitude_curve=[[1000.0, 1.0], [3000.0, 0.8]])
    found = ps.size(ps.sizing.load_cases_of(resolved), catalogue=derated, conditions=asked)
    assert all(one.best is not None for one in found.joints)
    assert not found.is_feasible
    assert found.verdict.startswith("a pair that is strong enough for every joint, but together: supply ")


def test_one_way_is_said_by_each_load_case() -> None:
    text = {
        "name": "ways", "points": [{"joints": [0.0] * 6}, {"joints": [0.5] * 6}], "times": [0, 1],
        "profiles": ["quintic"], "load_cases": [{"name": "there", "way": "one way", "idle": 2}, {"name": "both"}],
    }  # fmt: skip
    resolved = resolve_task(make_task(text))
    assert [case.cycle.duration for case in ps.sizing.load_cases_of(resolved)] == [3.0, 2.0]
    with pytest.raises(ps.InputError, match="it lists load_cases; give those that do not return way: one way there"):
        ps.sizing.load_cases_of(resolved, one_way=True)
    for fault, message in (
        ({"name": "r", "kind": "payload range"}, "masses goes with the kind 'payload range', and is needed there"),
        ({"name": "s", "kind": "emergency stop"}, "time goes with the kind 'emergency stop', and is needed there"),
        ({"name": "c", "masses": [1, 2]}, "masses goes with the kind 'payload range'"),
    ):
        with pytest.raises(ps.InputError, match=message):
            make_task({**text, "load_cases": [fault]})
    for case, message in (
        ({"name": "s", "kind": "emergency stop", "time": 0.5}, "load_cases: one of them must be of the kind 'cycle'"),
        ({"name": "c", "task": "paper-turned"}, "load case 'c': paper-turned is a task of another arm"),
    ):
        with pytest.raises(ps.InputError, match=message):
            ps.sizing.load_cases_of(resolve_task(make_task({**text, "robot": {"source": "ur5"}, "load_cases": [case]})))


def test_a_load_case_is_another_task_s_cycle_with_its_own_loads(tmp_path: Path) -> None:
    """There with 3 kg and back empty, a rest of 1 s and 2 s more of the load case: 1 + 1 + 1 + 2 = 5 s."""
    points = [{"name": "a", "joints": [0.0] * 6}, {"name": "b", "joints": [0.5] * 6}]
    other = {
        "name": "pallet", "points": points, "cycle": [
            {"grip": {"mass": 3.0}}, {"to": "b", "duration": 1.0}, "release", {"to": "a", "duration": 1.0},
            {"dwell": 1.0},
        ],
    }  # fmt: skip
    (tmp_path / "pallet.yaml").write_text(json.dumps(other))
    case = {"name": "pallet", "task": str(tmp_path / "pallet.yaml"), "idle": 2.0, "share": 0.25}
    text = {"name": "own", "points": points, "times": [0, 1], "profiles": ["quintic"]}
    own, found = ps.sizing.load_cases_of(resolve_task(make_task({**text, "load_cases": [{"name": "own"}, case]})))
    assert (own.cycle.duration, found.cycle.duration, found.share) == (2.0, 5.0, 0.25)
    there, back = (step.robot.payload for step in found.cycle.steps if isinstance(step, ps.Motion))
    assert there is not None
    assert there.mass == 3.0
    assert back is None
    for key, value in (("payload", {"mass": 1.0}), ("way", "one way")):
        with pytest.raises(ps.InputError, match=rf"load case 'pallet': {key}: .* is a cycle, which says that itself"):
            ps.sizing.load_cases_of(resolve_task(make_task({**text, "load_cases": [{**case, key: value}]})))


# ---- load cases


def cases_of_masses(*masses: float, shares: tuple[float, ...] = (1.0, 1.0)) -> list[LoadCase]:
    robot, move = ps.load_robot(), paper_motion().trajectory
    return [
        LoadCase(
            name=f"{mass:g} kg",
            cycle=ps.cycle.with_return(ps.compute_motion(robot.with_payload(ps.Payload(mass=mass)), move)),
            share=share,
        )
        for mass, share in zip(masses, shares, strict=True)
    ]


@pytest.mark.slow
def test_the_chosen_parts_hold_in_every_case_and_the_case_is_named() -> None:
    """By hand it was the intersection of two selections; the parts for the task broke limits when it was stretched."""
    light, heavy = cases_of_masses(0.0, 6.0)
    both = ps.size([light, heavy], catalogue=ps.built_in_catalogue(), keep=None)
    for name in both.cycle.joint_names:
        alone = [ps.size(case.cycle, catalogue=ps.built_in_catalogue(), keep=1).joint(name) for case in (light, heavy)]
        assert both.joint(name).is_feasible.tolist() == (alone[0].is_feasible & alone[1].is_feasible).tolist()
    governing = both.joint("joint2").best.governing
    assert governing.case == "6 kg"
    assert "of '6 kg' is" in str(governing)
    assert any(reason.endswith("(6 kg)") for reason in both.joint("joint2").rejections)


@pytest.mark.slow
def test_life_is_that_of_the_mix() -> None:
    """Palmgren and Miner: 1 / (0.9 / L1 + 0.1 / L2)."""
    life = {"rated_life_hours": 1e4, "rated_torque": 50.0, "rated_speed": 200.0}
    strong = {"max_average_torque": 900.0, "max_repeated_torque": 900.0, "peak_torque": 9.0, "continuous_torque": 9.0}
    pair = catalogue(**life, **strong)
    cases = cases_of_masses(0.0, 5.0, shares=(9.0, 1.0))
    lives = [ps.size(case.cycle, catalogue=pair).joint("joint2").best.life_hours for case in cases]
    mixed = ps.size(cases, catalogue=pair).joint("joint2").best.life_hours
    assert mixed == pytest.approx(1 / (0.9 / lives[0] + 0.1 / lives[1]), rel=1e-12)
    for hours, fits in ((0.999 * mixed, True), (1.001 * mixed, False)):
        found = ps.size(cases, catalogue=pair, conditions=Conditions(required_life_hours=hours)).joint("joint2")
        assert bool(found.kept) == fits


def test_an_emergency_stop_asks_for_what_inertia_does(tmp_path: Path) -> None:
    """A pendulum of 2 kg at 0.5 m from 1 rad/s within 0.1 s about a vertical axis would ask for m r^2 v / T = 5 N m."""
    arm = pendulum(tmp_path, gravity=(0.0, 0.0, 0.0))
    move = ps.profiles.linear([[0.0], [2.0]], [0.0, 2.0], joint_names=arm.joint_names)
    ((joint, _, stop),) = worst_stops(ps.compute_motion(arm, move), 0.1)
    assert joint == "swing"
    assert np.abs(stop.load_torque.extrema().peak[0]) == pytest.approx(2.0 * 0.5**2 * 1.0 / 0.1, rel=1e-9)
    assert stop.duration == pytest.approx(0.1)
    assert stop.trajectory(0.1, order=1)[0] == pytest.approx(0.0, abs=1e-12)
    # It turns v T / 2 further.
    assert stop.trajectory(0.1)[0] - stop.trajectory(0.0)[0] == pytest.approx(0.05)


def test_an_emergency_stop_begins_where_it_asks_for_most() -> None:
    """Of 2,000 instants none has a larger torque of the links as the arm begins to slow down, ``tau - M q' / T``."""
    robot = ps.load_robot().with_actuators((ps.Actuator(),) * 6)
    points = [[0.0, 0.6, -2.2, 0.0, 0.3, 0.0], [0.6, 0.9, -2.4, 0.3, 0.45, 0.25]]
    move = ps.quintic_segments(points, [0.0, 1.2], joint_names=robot.joint_names)
    t = np.linspace(0.0, 1.2, 2000)
    q, v, a = (move(t, order=order) for order in range(3))
    torque = np.abs(ps.inverse_dynamics(robot, q, v, a - v / 0.3, friction=False))
    for joint, instant, _ in worst_stops(ps.compute_motion(robot, move), 0.3):
        j = robot.joint_index(joint)
        q, v, a = (move(np.array([instant]), order=order) for order in range(3))
        found = abs(ps.inverse_dynamics(robot, q, v, a - v / 0.3, friction=False)[0, j])
        assert torque[:, j].max() * (1 - 1e-12) <= found <= torque[:, j].max() * (1 + 1e-4)


def test_the_worst_pose_holds_what_the_certified_bound_says() -> None:
    """2.5 kg more at the stretched PUMA's wrist: `worst_holding_torque` has the torque and the pose."""
    from puma_septic.sizing._load_cases import worst_poses

    robot = ps.load_robot().with_payload(ps.Payload(mass=2.5))
    worst = ps.worst_holding_torque(robot, gap=0.05)
    found = dict(worst_poses(robot, 1.0))
    assert set(found) == {"joint2", "joint3", "joint4", "joint5"}
    held = found["joint2"].load_torque.extrema().peak[1]
    assert abs(held) == pytest.approx(worst.attained[1], rel=1e-9)


@pytest.mark.slow
def test_one_size_for_several_joints() -> None:
    wrist = ["joint4", "joint5", "joint6"]
    chosen = ps.size(cycle(), catalogue=ps.built_in_catalogue(), same=[wrist], rank="mass")
    assert len({(chosen.joint(name).best.motor, chosen.joint(name).best.gearbox) for name in wrist}) == 1
    assert any(note.startswith("one size for joint4, joint5, joint6: ") for note in chosen.notes)


# ---- W2, W12: what is handed out


@pytest.mark.slow
def test_the_document_names_the_choice() -> None:
    document = json.loads(json.dumps(ps.size(cycle(), catalogue=catalogue()).to_dict()))
    assert [(line["kind"], line["name"], line["count"]) for line in document["bill_of_material"]] == [
        ("motor", "M", 6), ("gearbox", "G", 6)
    ]  # fmt: skip
    assert document["totals"]["mass"] == pytest.approx(12.0)
    html = ps.size(cycle(), catalogue=catalogue())._repr_html_()
    assert html.index("Chosen, with the governing limit of each joint") < html.index("Bill of material")


def test_the_load_profile_is_that_of_the_load() -> None:
    """The file held the whole motor torque, rotor included: fed to a tool that adds the rotor, it counted twice."""
    train = ps.size(cycle(), catalogue=catalogue()).sizing
    load, motor = train.load_profile("joint1"), train.motor_load_profile("joint1")
    own = ps.sizing.joint_load(cycle(), 0)
    assert load.torque == pytest.approx(own.torque(load.time)[:, 0], abs=1e-9)
    assert load.inertia == pytest.approx(own.inertia(load.time)[:, 0])
    assert np.abs(np.interp(motor.time, load.time, load.torque) / 76 - motor.torque).max() > 0.005  # the rotor's part
    heads = [next(csv.reader(io.StringIO(text))) for text in (load_profile_csv(load), motor_profile_csv(motor))]
    assert heads[0][3] == "load at the gearbox output, without rotor, gears and friction [N m]"
    assert heads[1][2] == "whole motor torque, rotor and friction included [N m]"


def test_a_torque_that_steps_has_both_values() -> None:
    """Where a payload is dropped the value before the step was missing."""
    there = paper_motion(loaded=True)
    train = ps.size(
        ps.cycle.with_return(there, robot_back=there.robot.with_payload(None)), catalogue=catalogue(peak_torque=9.0)
    ).sizing
    profile = train.load_profile("joint2")
    (twice,) = np.flatnonzero(np.diff(profile.time) == 0)
    assert profile.time[twice] == pytest.approx(9.0)
    assert abs(profile.torque[twice + 1] - profile.torque[twice]) > 1.0


def test_a_cycle_that_advances_by_a_turn_repeats(tmp_path: Path) -> None:
    """One way, over and over: an index table. It has a steady winding temperature."""
    arm = pendulum(tmp_path, kind="continuous", gravity=(0.0, 0.0, 0.0))
    turn = ps.quintic_segments([[0.0], [2 * np.pi]], [0.0, 1.0], joint_names=arm.joint_names)
    heat = {"max_winding_celsius": 120.0, "thermal_resistances": [1.0], "thermal_time_constants": [100.0]}
    table = ps.Cycle(steps=(ps.compute_motion(arm, turn), ps.Dwell(duration=0.5)))
    found = ps.size([LoadCase(name="index", cycle=table)], catalogue=catalogue(max_speed=2000.0, **heat)).joint("swing")
    assert table.is_periodic
    assert "winding temperature rise" in {check.quantity for check in found.best.checks}


def test_an_unpowered_stop_asks_nothing_of_the_motor(tmp_path: Path) -> None:
    """Category 0 is done by the brakes; the gearbox carries it either way, by its momentary limit alone."""
    arm = pendulum(tmp_path, gravity=(0.0, 0.0, 0.0))
    move = ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0], joint_names=arm.joint_names)
    usual = LoadCase(name="work", cycle=ps.cycle.with_return(ps.compute_motion(arm, move)))
    quick = ps.quintic_segments([[0.0], [1.0]], [0.0, 0.05], joint_names=arm.joint_names)
    stop = ps.Cycle(steps=(ps.compute_motion(arm, quick),))
    peak = float(stop.load_torque.extrema().peak[0])
    for powered, changes, reasons in (
        (True, {}, {"motor torque (stop)": 1}),
        (False, {}, {}),
        (False, {"max_momentary_torque": 0.99 * peak}, {"gearbox momentary peak torque (stop)": 1}),
        (False, {"max_momentary_torque": 1.01 * peak}, {}),
    ):
        cases = [usual, LoadCase(name="stop", cycle=stop, share=0.0, is_rare=True, is_powered=powered)]
        pair = catalogue(
            **{"max_momentary_torque": 1e4, "max_repeated_torque": 10.0, "max_average_torque": 10.0} | changes
        )
        assert ps.size(cases, catalogue=pair).joint("swing").rejections == reasons


def test_load_cases_that_are_none_are_refused(tmp_path: Path) -> None:
    light, heavy = cases_of_masses(0.0, 1.0)
    swing = ps.compute_motion(pendulum(tmp_path), ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0]))
    for cases, message in (
        ([light, light], "load case '0 kg' occurs twice; each needs a name of its own"),
        ([], "size takes a Cycle or a sequence of LoadCase, got list"),
        ([LoadCase(name="a", cycle=light.cycle, share=0.0)], "no load case has a share of the operating time"),
        ([LoadCase(name="a", cycle=light.cycle, is_rare=True), heavy], "the first one must concern all joints"),
        (
            [light, LoadCase(name="b", cycle=ps.cycle.with_return(swing))],
            "load cases of one arm; got joints joint1, .* and swing",
        ),
    ):
        with pytest.raises(ps.InputError, match=message):
            ps.size(cases)
    with pytest.raises(ps.InputError, match="load case 'a': expected a Cycle, got Motion"):
        LoadCase(name="a", cycle=light.cycle.motion)  # type: ignore[arg-type]
    with pytest.raises(ps.InputError, match="load case 'a': unknown joint 'elbow'; valid: joint1"):
        LoadCase(name="a", cycle=light.cycle, joints=("elbow",))
    with pytest.raises(ps.InputError, match="bus_voltage: 2 values for 6 joints; give one for all or one for each"):
        ps.size(light.cycle, catalogue=catalogue(), conditions=Conditions(bus_voltage=[24.0, 48.0]))
