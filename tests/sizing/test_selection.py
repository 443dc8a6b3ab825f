"""Selection from a catalogue: the same answer as assessing each pair anew, and what is said of it."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from helpers.duty import LOAD, paper_motion
from hypothesis import given, settings
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.drives import Pair, lacking
from puma_septic.limit_check import LimitCheck
from puma_septic.sizing._checks import assess_joint, utilisation_bounds
from puma_septic.sizing._joint_selection import RANKS, select_joint
from puma_septic.sizing._load_cases import JointCase
from puma_septic.sizing._load_features import load_grid
from puma_septic.sizing._pair_features import pair_table

# What sums in another order may differ by.
ROUNDING = 1e-12


@cache
def cycle(*, periodic: bool = True, loaded: bool = False) -> ps.Cycle:
    motion = paper_motion(loaded=loaded)
    if periodic:
        return ps.cycle.with_return(motion, dwell=0.5, robot_back=motion.robot.with_payload(None))
    return ps.Cycle(steps=[ps.Dwell(duration=1.0, holding_brake=True), motion])


@cache
def load(j: int, periodic: bool) -> ps.sizing.JointLoad:
    return ps.sizing.joint_load(cycle(periodic=periodic, loaded=True), j)


def alone(one: ps.sizing.JointLoad) -> list[JointCase]:
    """The only load case."""
    return [JointCase(name="", share=1.0, load=one)]


def around(value: float) -> st.SearchStrategy[float]:
    """From a fifth of a value to five times it, or unknown."""
    return st.one_of(st.floats(-0.7, 0.7).map(lambda x: float(value * 10**x)), st.just(float("nan")))


@st.composite
def motors(draw: st.DrawFn, name: str) -> ps.Motor:
    """About the size that the arm needs, so that every check passes now and fails then."""
    peak, speed = draw(st.floats(0.1, 3.0)), draw(st.floats(50.0, 500.0))
    has_curves, nodes = draw(st.booleans()), draw(st.integers(0, 2))
    return ps.Motor(
        name=name,
        rotor_inertia=draw(around(1e-4)),
        viscous_friction=draw(around(1e-4)),
        coulomb_friction=draw(around(0.01)),
        torque_constant=draw(around(0.1)),
        resistance=draw(around(1.0)),
        peak_torque=draw(around(0.8)),
        peak_curve=[[0.0, peak], [0.6 * speed, peak], [speed, 0.3 * peak]] if has_curves else [],
        continuous_torque=np.nan if has_curves else draw(around(0.3)),
        continuous_curve=[[0.0, 0.5 * peak], [speed, 0.2 * peak]] if has_curves else [],
        max_speed=draw(around(200.0)),
        peak_power=draw(around(60.0)),
        max_winding_celsius=draw(st.sampled_from([60.0, 90.0, 155.0])),
        thermal_resistances=[1.5, 3.0][:nodes],
        thermal_time_constants=[20.0, 600.0][:nodes],
        mass=draw(around(1.0)),
        cost=draw(around(100.0)),
    )


@st.composite
def gearboxes(draw: st.DrawFn, name: str) -> ps.Gearbox:
    return ps.Gearbox(
        name=name,
        ratio=draw(st.sampled_from([-1.0, 1.0])) * draw(st.floats(30.0, 160.0)),
        efficiency=draw(st.one_of(st.floats(0.5, 1.0), st.just(float("nan")))),
        backward_efficiency=draw(st.one_of(st.floats(0.0, 1.0), st.just(float("nan")))),
        inertia=draw(around(2e-5)),
        no_load_torque=draw(around(0.01)),
        rated_torque=draw(around(40.0)),
        rated_speed=200.0,
        rated_life_hours=draw(around(7000.0)),
        max_average_torque=draw(around(60.0)),
        max_repeated_torque=draw(around(80.0)),
        max_momentary_torque=draw(around(200.0)),
        max_average_input_speed=draw(around(60.0)),
        max_input_speed=draw(around(200.0)),
        mass=draw(around(1.0)),
        cost=draw(around(100.0)),
    )


@st.composite
def places(draw: st.DrawFn) -> ps.Drivetrain:
    """What a joint has whatever the parts; a generous drive in half the cases."""
    known = {
        "bus_voltage": 24.0, "continuous_current": 5.0, "peak_current": 10.0, "continuous_power": 60.0,
        "peak_power": 150.0, "peak_regenerated_power": 40.0, "storable_energy": 20.0, "brake_resistor_power": 3.0,
    }  # fmt: skip
    drive = {name: draw(around(value)) for name, value in known.items()} if draw(st.booleans()) else {}
    return ps.Drivetrain(
        motor=ps.Motor(),
        gearbox=ps.Gearbox(ratio=1.0),
        drive=ps.Drive(**drive),
        ambient_celsius=draw(st.sampled_from([20.0, 40.0])),
        momentary_torque=draw(around(150.0)),
        required_life_hours=draw(around(6000.0)),
    )


@st.composite
def catalogues(draw: st.DrawFn) -> ps.Catalogue:
    return ps.Catalogue(
        motors=[draw(motors(f"M{k}")) for k in range(2)], gearboxes=[draw(gearboxes(f"G{k}")) for k in range(2)]
    )


def in_full(one: ps.sizing.JointLoad, train: ps.Drivetrain) -> list[LimitCheck]:
    """The checks that can reject, by the code that sizes any drive train."""
    demands = ps.sizing.Demands(load=one, train=train, motor=ps.sizing.motor_load(one, train))
    outcomes = assess_joint(demands)
    return [o for o in outcomes if isinstance(o, LimitCheck) and o.kind != "rule of thumb"]


@st.composite
def measured(draw: st.DrawFn) -> ps.Catalogue:
    """Pairs whose friction was measured through the gears, with the optional terms or without."""
    losses = {"viscous_friction": np.nan, "coulomb_friction": np.nan}
    motor = replace(draw(motors("M")), **losses)
    lossless = {"efficiency": np.nan, "backward_efficiency": np.nan, "no_load_torque": np.nan}
    gears = [replace(draw(gearboxes(f"G{k}")), **lossless) for k in range(2)]
    coulomb = [draw(st.floats(0, 0.05)), draw(st.floats(-0.05, 0))]
    laws = [
        ps.Friction(
            viscous=draw(around(1e-4)),
            coulomb=coulomb,
            static=[2 * coulomb[0] + 0.01, 2 * coulomb[1] - 0.01],
            stribeck_velocity=draw(around(3.0)),
            load_share=draw(st.one_of(st.floats(0, 1), st.just(float("nan")))),
        )
        for _ in gears
    ]
    pairs = [Pair(motor="M", gearbox=gear.name, friction=law) for gear, law in zip(gears, laws, strict=True)]
    return ps.Catalogue(motors=[motor], gearboxes=gears, pairs=pairs)


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@given(catalogue=catalogues(), place=places(), j=st.sampled_from([0, 1, 4]), periodic=st.booleans())
def test_selection_is_that_of_assessing_each_pair(
    catalogue: ps.Catalogue, place: ps.Drivetrain, j: int, periodic: bool
) -> None:
    assert_each_pair_is_judged_as_alone(catalogue, place, j, periodic)


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
@given(catalogue=measured(), place=places(), j=st.sampled_from([0, 1, 4]), periodic=st.booleans())
def test_selection_of_measured_pairs_is_that_of_assessing_each(
    catalogue: ps.Catalogue, place: ps.Drivetrain, j: int, periodic: bool
) -> None:
    """Load-dependent friction is within the bounds; Stribeck friction is not, and leaves them open."""
    assert_each_pair_is_judged_as_alone(catalogue, place, j, periodic)


def test_a_winding_of_unknown_temperature_is_as_cold_as_printed() -> None:
    """The loss was bounded by that at the ambient, 40 degrees, where the full assessment takes the sheet's 20."""
    motor = ps.Motor(
        name="M", torque_constant=0.04, resistance=0.8, rotor_inertia=2e-4, coulomb_friction=0.03, peak_torque=3.0
    )
    place = ps.Drivetrain(motor=ps.Motor(), gearbox=ps.Gearbox(ratio=1.0), drive=ps.Drive(continuous_power=60.0))
    catalogue = ps.Catalogue(motors=[motor], gearboxes=[ps.Gearbox(name="G", ratio=60.0)])
    assert_each_pair_is_judged_as_alone(catalogue, replace(place, ambient_celsius=40.0), 0, periodic=False)


def test_a_winding_that_runs_away_has_no_bound() -> None:
    """Its current is told as infinite, which was above the bound that the torque gives."""
    motor = ps.Motor(
        name="M",
        torque_constant=0.1,
        resistance=1.0,
        peak_torque=3.0,
        max_winding_celsius=60.0,
        thermal_resistances=[1.5, 3.0],
        thermal_time_constants=[20.0, 600.0],
    )
    drive = ps.Drive(peak_current=10.0, continuous_current=5.0, storable_energy=20.0, peak_regenerated_power=40.0)
    place = ps.Drivetrain(motor=ps.Motor(), gearbox=ps.Gearbox(ratio=1.0), drive=drive, ambient_celsius=20.0)
    catalogue = ps.Catalogue(motors=[motor], gearboxes=[ps.Gearbox(name="G", ratio=30.0)])
    assert any(check.demand == np.inf for check in in_full(load(1, True), catalogue.drivetrain(0, 0, [place])))
    assert_each_pair_is_judged_as_alone(catalogue, place, 1, periodic=True)


@pytest.mark.parametrize(
    ("j", "periodic", "resistor"), [(0, True, 3.0), (1, True, 3.0), (1, True, np.nan), (1, False, np.nan)]
)
def test_bounds_hold_for_slow_windings_and_low_ratios(j: int, periodic: bool, resistor: float) -> None:
    """A winding whose heat capacity is that of a large motor, and power that is large beside the ratio.

    Without a brake resistor what comes back must be stored, for as long as the whole cycle takes.
    """
    drive = ps.Drive(
        bus_voltage=48.0, continuous_current=9.0, peak_current=90.0, continuous_power=60.0, peak_power=900.0,
        peak_regenerated_power=90.0, storable_energy=20.0, brake_resistor_power=resistor,
    )  # fmt: skip
    place = ps.Drivetrain(
        motor=ps.Motor(), gearbox=ps.Gearbox(ratio=1.0), drive=drive, ambient_celsius=20.0, max_inertia_ratio=50.0
    )
    motor = ps.Motor(
        name="M", torque_constant=0.5, resistance=0.001, rotor_inertia=1e-4, viscous_friction=1e-4,
        coulomb_friction=0.01, peak_torque=30.0, continuous_torque=9.0, max_speed=500.0, max_winding_celsius=155.0,
        thermal_resistances=[0.5, 1.0], thermal_time_constants=[200.0, 3000.0],
    )  # fmt: skip
    gears = [ps.Gearbox(name=f"G{n}", ratio=n, efficiency=0.8, inertia=1e-6) for n in (3.0, 10.0, 60.0)]
    assert_each_pair_is_judged_as_alone(ps.Catalogue(motors=[motor], gearboxes=gears), place, j, periodic)


def assert_each_pair_is_judged_as_alone(catalogue: ps.Catalogue, place: ps.Drivetrain, j: int, periodic: bool) -> None:
    """The same verdict for every pair, the same numbers for every pair kept, and a reason that is one."""
    selection = select_joint(alone(load(j, periodic)), catalogue, 0, rank="mass", keep=None, places=[place])
    bounds = utilisation_bounds(load_grid(load(j, periodic)), pair_table(catalogue, 0, [place]))
    kept = {(c.motor, c.gearbox): c for c in (*selection.kept, *selection.undecided)}
    assert len(selection.kept) == selection.is_feasible.sum()
    assert len(selection.undecided) == selection.is_undecided.sum()
    for k in range(catalogue.n_pairs):
        train = catalogue.drivetrain(k, 0, [place])
        checks = in_full(load(j, periodic), train)
        broken = {c.quantity for c in checks if c.is_violated}
        assert (selection.is_feasible[k] or selection.is_undecided[k]) == (not broken)
        assert selection.is_undecided[k] == (not broken and bool(lacking(train)))
        for check in checks:
            low, high = (float(bound[k]) for bound in bounds[check.quantity])
            assert low <= check.utilisation * (1 + ROUNDING)
            assert check.utilisation <= high * (1 + ROUNDING)
        assert {name for name, bound in bounds.items() if not np.isnan(bound[0][k])} == {c.quantity for c in checks}
        if broken:
            assert selection.reasons[k] in broken
        else:
            candidate = kept[train.motor.name, train.gearbox.name]
            own = {c.quantity: c.utilisation for c in candidate.checks}
            for check in checks:
                assert own[check.quantity] == pytest.approx(check.utilisation, rel=1e-9, abs=0)


def test_bounds_of_torque_are_within_half_a_per_cent() -> None:
    """Verdicts need a full assessment only this close to a limit."""
    catalogue = ps.built_in_catalogue()
    for j in (0, 1, 4):
        low, high = utilisation_bounds(load_grid(load(j, True)), pair_table(catalogue, 0, None))["motor torque"]
        assert (high / low).max() < 1.0049


def test_the_reason_is_the_check_that_fails_worst() -> None:
    """To the width of the bounds; every pair of the example at joint 2."""
    one = load(1, True)
    selection = select_joint(alone(one), ps.built_in_catalogue(), 0, rank="mass", keep=1, places=None)
    rejected = np.flatnonzero(~selection.is_feasible)
    assert len(rejected) > 20
    for k in rejected[::4].tolist():
        uses = {c.quantity: c.utilisation for c in in_full(one, selection.catalogue.drivetrain(k, 0))}
        # Bounds from below: the mean of the winding's rise, a cold winding's voltage, torque over speed at instants.
        assert uses[selection.reasons[k]] > 1
        bounded = ("winding temperature rise", "motor torque at speed", "voltage at torque and speed")
        known = [use for name, use in uses.items() if name not in bounded]
        assert selection.utilisation[k] > 0.995 * max(known)


@pytest.mark.parametrize("rank", RANKS)
@pytest.mark.slow
def test_ranks(rank: str) -> None:
    """Three ways to order the same pairs; the first few are those of the whole list."""
    one, catalogue = load(1, True), ps.built_in_catalogue()
    everything = select_joint(alone(one), catalogue, 0, rank=rank, keep=None, places=None).kept  # type: ignore[arg-type]
    first = select_joint(alone(one), catalogue, 0, rank=rank, keep=4, places=None).kept  # type: ignore[arg-type]
    keys = [-c.margin if rank == "margin" else getattr(c, rank) for c in everything]
    assert keys == sorted(keys)
    assert [(c.motor, c.gearbox) for c in first] == [(c.motor, c.gearbox) for c in everything[:4]]


def test_measured_friction_of_a_pair_is_used() -> None:
    """The arm's own six drives, each at its own joint: as `load_drivetrains` has them; what they bear is not known."""
    own = ps.size(cycle(), drivetrains=ps.load_drivetrains(ps.load_robot()))
    chosen = ps.size(cycle(), catalogue=ps.built_in_catalogue("puma560"), keep=None)
    for j, name in enumerate(cycle().joint_names):
        (candidate,) = [c for c in chosen.joint(name).undecided if c.motor == f"puma560-motor{j + 1}"]
        assert chosen.joint(name).kept == ()
        assert candidate.demands.rms_torque == pytest.approx(own.demands[j].rms_torque, rel=ROUNDING)
        assert candidate.demands.peak_torque.size == pytest.approx(own.demands[j].peak_torque.size, rel=ROUNDING)


def test_the_chosen_drives_are_strong_enough() -> None:
    selection = ps.size(cycle(), catalogue=ps.built_in_catalogue(), keep=1)
    assert selection.is_feasible
    assert selection.sizing is not None
    assert selection.sizing.is_feasible
    assert [t.motor.name for t in selection.sizing.drivetrains] == [one.best.motor for one in selection.joints]
    document = json.loads(json.dumps(selection.to_dict(), allow_nan=False))
    assert document["joints"][1]["kept"][0]["motor"] == selection.joint("joint2").best.motor
    assert "joint2" in str(selection)


def test_an_empty_result_says_which_check_rejects_most() -> None:
    weak = ps.Catalogue(
        motors=[ps.Motor(name="weak", peak_torque=0.01), ps.Motor(name="slow", max_speed=0.1)],
        gearboxes=[ps.Gearbox(name=f"G{n}", ratio=float(n)) for n in (60, 80)],
    )
    selection = ps.size(cycle(), catalogue=weak)
    assert not selection.is_feasible
    assert selection.sizing is None
    assert selection.to_dict()["sizing"] is None
    joint = selection.joint("joint2")
    assert joint.best is None
    assert joint.rejections == {"motor torque": 2, "motor speed": 2}
    assert "none of 4 pairs is strong enough; reasons, most frequent first:" in joint.explanation
    assert "joint2 (most frequent reason: motor torque)" in selection.verdict
    assert "no pair is strong enough for joint1" in str(selection)
    assert joint.why("weak", "G60").startswith("weak with G60 is undersized; worst violation: motor torque: at least ")


def test_why_of_each_kind_of_pair() -> None:
    catalogue = ps.Catalogue(
        motors=[ps.Motor(name="M"), ps.Motor(name="N")],
        gearboxes=[ps.Gearbox(name="G", ratio=50.0)],
        pairs=[Pair(motor="M", gearbox="G")],
    )
    joint = ps.size(cycle(), catalogue=catalogue).joint("joint1")
    assert joint.why("M", "G").startswith("M with G is not decidable: rotor inertia of the motor, continuous torque")
    assert joint.why("N", "G") == "N and G do not fit together"
    with pytest.raises(ps.InputError, match="unknown motor 'X'; valid: 'M', 'N'"):
        joint.why("X", "G")


def test_a_step_in_velocity_rejects_all() -> None:
    """Nothing turns a rotor at once."""
    stepping = [[0.0] * 6, [0.1] * 6]
    motion = ps.compute_motion(ps.load_robot(), ps.profiles.linear(stepping, [0.0, 1.0]))
    selection = ps.size(ps.Cycle(steps=[motion]), catalogue=ps.built_in_catalogue())
    assert not selection.is_feasible
    assert selection.joint("joint1").rejections == {"unbounded torque (a velocity steps)": 140}


def test_the_ratio_window_holds_what_is_chosen() -> None:
    """Without friction its two ends are where RMS torque meets the continuous torque: seen by another pair."""
    motor = ps.Motor(name="M", rotor_inertia=1e-4, continuous_torque=0.6, peak_torque=1e3, max_speed=1e4)
    losses = {
        "efficiency": 0.7, "backward_efficiency": 0.4, "max_average_torque": 1e4, "max_repeated_torque": 1e4,
    }  # fmt: skip
    catalogue = ps.Catalogue(motors=[motor], gearboxes=[ps.Gearbox(name="G", ratio=150.0, **losses)])
    window = select_joint(alone(load(1, True)), catalogue, 0, rank="mass", keep=1, places=None).best.window
    assert window.least < 150 < window.most
    for ratio, fits in ((0.999, False), (1.001, True)):
        gear = ps.Gearbox(name="G", ratio=window.least * ratio, **losses)
        again = ps.Catalogue(motors=[motor], gearboxes=[gear])
        assert bool(select_joint(alone(load(1, True)), again, 0, rank="mass", keep=1, places=None).kept) == fits


@pytest.mark.slow
def test_masses_load_the_joints_before() -> None:
    """One pass from the wrist: each joint's load is that of the arm with all drives chosen beyond it."""
    catalogue = ps.built_in_catalogue()
    light, heavy = (ps.size(cycle(), catalogue=catalogue, keep=1, masses=m) for m in (None, "before"))
    masses = np.array([one.best.mass for one in heavy.joints])
    robot = ps.sizing.with_drive_masses(cycle().robot, masses)
    assert heavy.cycle.robot.model.inertias[3].mass == pytest.approx(robot.model.inertias[3].mass)
    again = ps.size(heavy.cycle, drivetrains=[one.best.drivetrain for one in heavy.joints])
    for one, demands in zip(heavy.joints, again.demands, strict=True):
        assert one.best.demands.rms_torque == pytest.approx(demands.rms_torque, rel=1e-9)  # of a refitted load
    assert heavy.joint("joint2").best.demands.rms_torque * heavy.joint("joint2").best.drivetrain.ratio > (
        light.joint("joint2").best.demands.rms_torque * light.joint("joint2").best.drivetrain.ratio
    )
    assert heavy.notes[-1].startswith("masses added: 0.55, ")


@pytest.mark.slow
def test_a_joint_that_carries_its_own_drive_settles() -> None:
    selection = ps.size(cycle(), catalogue=ps.built_in_catalogue(), keep=1, masses="at")
    again = ps.size(selection.cycle, catalogue=ps.built_in_catalogue(), keep=1)
    assert [one.best.motor for one in again.joints] == [one.best.motor for one in selection.joints]
    assert not any("did not settle" in note for note in selection.notes)


def test_masses_of_the_arms_own_drives_are_taken_off() -> None:
    """A mass that is put on and taken off leaves the arm as it was, and gravity grows by its lever."""
    robot = ps.load_robot()
    masses = [0.0, 0.0, 2.0, 0.0, 0.0, 0.0]
    loaded = ps.sizing.with_drive_masses(robot, masses)
    back = ps.sizing.with_drive_masses(loaded, [-m for m in masses])
    q, rest = np.zeros((1, 6)), np.zeros((1, 6))
    torques = [ps.inverse_dynamics(one, q, rest, rest)[0] for one in (robot, loaded, back)]
    assert torques[2] == pytest.approx(torques[0], abs=1e-12)
    # 2 kg at the elbow, 0.4318 m from the shoulder (length of the upper arm), stretched out.
    assert torques[1][1] - torques[0][1] == pytest.approx(2.0 * 9.81 * 0.4318, rel=1e-3)
    assert robot.bare_model.inertias[2].mass == pytest.approx(back.bare_model.inertias[2].mass)
    with pytest.raises(ps.InputError, match=r"joint 'joint6': taking 50 kg off leaves its link with -4"):
        ps.sizing.with_drive_masses(robot, [0.0] * 5 + [-50.0])


def test_messages() -> None:
    catalogue = ps.built_in_catalogue()
    with pytest.raises(ps.InputError, match="unknown rank 'price'; valid: 'mass', 'cost', 'margin'"):
        ps.size(cycle(), catalogue=catalogue, rank="price")  # type: ignore[call-overload]
    with pytest.raises(ps.InputError, match="keep = 0: expected a whole number from 1"):
        ps.size(cycle(), catalogue=catalogue, keep=0)
    with pytest.raises(ps.InputError, match="1 drivetrains for 6 joints"):
        ps.size(cycle(), catalogue=catalogue, drivetrains=[catalogue.drivetrain(0, 0)])
    with pytest.raises(ps.InputError, match="expected a Catalogue"):
        ps.size(cycle(), catalogue="motors.csv")  # type: ignore[call-overload]
    with pytest.raises(ps.InputError, match="unknown placement of masses 'behind'; valid: 'before', 'at'"):
        ps.size(cycle(), catalogue=catalogue, masses="behind")  # type: ignore[call-overload]
    assert LOAD.mass == 2.5
