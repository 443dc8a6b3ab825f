"""Whole selections of a small arm, quick enough to be repeated one pair at a time."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from helpers.urdf_texts import ARM, load

import puma_septic as ps
from puma_septic.sizing import LoadCase
from puma_septic.sizing._drive_masses import _from_the_tip

JOINTS = ("shoulder", "elbow")


@cache
def arm() -> ps.Robot:
    with TemporaryDirectory() as folder:
        return load(Path(folder), tool="tip")


def moved(robot: ps.Robot, duration: float) -> ps.Cycle:
    """From hanging to level and back."""
    out = ps.quintic_segments([[0.2, 0.1], [1.4, 0.3]], [0.0, duration], joint_names=JOINTS)
    return ps.cycle.with_return(ps.compute_motion(robot, out))


@cache
def cases() -> tuple[LoadCase, ...]:
    """One governs by its speed, one by its load; a stop is rare."""
    heavy = arm().with_payload(ps.Payload(mass=5.0))
    return (
        LoadCase(name="quick", cycle=moved(arm(), 1.0), share=0.8),
        LoadCase(name="heavy", cycle=moved(heavy, 2.0), share=0.2),
        LoadCase(name="stop", cycle=moved(heavy, 1.5), share=0.0, is_rare=True),
    )


@cache
def catalogue() -> ps.Catalogue:
    motors = [
        ps.Motor(
            name=f"M{k}", rotor_inertia=2e-5 * size**2, continuous_torque=0.15 * size, peak_torque=0.45 * size,
            max_speed=900.0 / size**0.5, mass=0.5 * size, cost=100.0 + size, max_inertia_ratio=20.0,
        )
        for k, size in enumerate((1.0, 3.0, 6.0, 12.0))
    ]  # fmt: skip
    gearboxes = [
        ps.Gearbox(
            name=f"G{ratio:g}", ratio=ratio, kind="strain wave", efficiency=0.8, inertia=1e-5, mass=0.01 * ratio,
            max_average_torque=torque, max_repeated_torque=2 * torque, max_momentary_torque=4 * torque, cost=ratio,
            rated_torque=torque, rated_speed=200.0, rated_life_hours=7000.0, life_basis="L10",
        )
        for ratio, torque in ((30.0, 60.0), (50.0, 90.0), (100.0, 45.0), (160.0, 80.0))
    ]  # fmt: skip
    return ps.Catalogue(motors=motors, gearboxes=gearboxes)


@cache
def selection() -> ps.Selection:
    return ps.size(cases(), catalogue=catalogue(), keep=None)


def test_of_several_load_cases_each_pair_is_judged_as_alone() -> None:
    """The verdict of every pair, the worst of its checks and the case that this is from."""
    verdicts = set()
    for k, (motor, gearbox) in enumerate(product(catalogue().motors, catalogue().gearboxes)):
        alone = ps.size(cases(), drivetrains=[ps.Drivetrain(motor=motor, gearbox=gearbox)] * 2)
        for name in JOINTS:
            joint = selection().joint(name)
            checks = [check for check in alone.checks if check.joint == name and check.kind != "rule of thumb"]
            broken = {check.quantity for check in checks if check.is_violated}
            verdicts.add(bool(broken))
            assert joint.is_feasible[k] == (not broken)
            found = [c for c in joint.kept if (c.motor, c.gearbox) == (motor.name, gearbox.name)]
            if broken:
                assert found == []
                assert any(joint.reasons[k].startswith(quantity) for quantity in broken)
                assert f"{motor.name} with {gearbox.name} is undersized; worst violation: " in joint.why(
                    motor.name, gearbox.name
                )
            else:
                (candidate,) = found
                worst = max(check.utilisation for check in checks)
                assert candidate.governing.utilisation == pytest.approx(worst, rel=1e-9)
                assert {(c.quantity, c.case) for c in candidate.checks} == {
                    (c.quantity, c.case) for c in alone.checks if c.joint == name
                }
    assert verdicts == {True, False}


def test_the_lightest_is_chosen_and_the_front_is_what_none_beats() -> None:
    for joint in selection().joints:
        masses = [c.mass for c in joint.kept]
        assert masses == sorted(masses)
        assert joint.best is joint.kept[0]
        points = np.array([[c.mass, c.cost, c.stress] for c in joint.kept])
        best = {
            (c.motor, c.gearbox)
            for c, point in zip(joint.kept, points, strict=True)
            if not ((points <= point).all(axis=1) & (points < point).any(axis=1)).any()
        }
        assert {(c.motor, c.gearbox) for c in joint.front()} == best


def test_the_front_of_the_arm_is_that_of_all_combinations() -> None:
    """Masses and costs add up, the largest use counts."""
    points = np.array(
        [
            (sum(c.mass for c in chosen), sum(c.cost for c in chosen), max(c.stress for c in chosen))
            for chosen in product(*(joint.kept for joint in selection().joints))
        ]
    )
    beaten = [((points <= one).all(axis=1) & (points < one).any(axis=1)).any() for one in points]
    front = selection().front()
    found = [(choice.mass, choice.cost, choice.stress) for choice in front]
    assert found == sorted(found)
    np.testing.assert_allclose(found, np.unique(points[~np.array(beaten)].round(9), axis=0), rtol=1e-8)
    for choice in front:
        tightest = max(choice.candidates, key=lambda candidate: candidate.stress)
        assert (choice.margin, choice.stress) == (tightest.margin, tightest.stress)
        for joint, candidate in zip(selection().joints, choice.candidates, strict=True):
            assert joint.why(candidate.motor, candidate.gearbox).endswith("is strong enough")


def test_how_many_pairs_lack_which_value_is_told() -> None:
    """Of six pairs all lack the highest speed, two the rotor's inertia, and three the average torque."""
    known = {"continuous_torque": 50.0, "peak_torque": 100.0}
    motors = [ps.Motor(name=f"M{k}", rotor_inertia=1e-4 if k else np.nan, **known) for k in range(3)]
    gears = [
        ps.Gearbox(
            name=f"G{k}", ratio=50.0, efficiency=0.8, max_repeated_torque=1e4, max_average_torque=1e4 if k else np.nan
        )
        for k in range(2)
    ]
    joint = ps.size(cases(), catalogue=ps.Catalogue(motors=motors, gearboxes=gears)).joint("elbow")
    assert list(joint.unknowns.items()) == [
        ("highest speed of the motor", 6), ("average torque of the gearbox", 3), ("rotor inertia of the motor", 2),
    ]  # fmt: skip
    assert joint.why("M0", "G1").startswith(
        "M0 with G1 is not decidable: rotor inertia of the motor, highest speed of the motor"
    )


def test_the_table_of_a_selection_has_a_row_for_each_pair_that_is_kept() -> None:
    table = selection().to_dataframe()
    pairs = [(joint.joint, c.motor, c.gearbox) for joint in selection().joints for c in joint.kept]
    assert list(zip(table["joint"], table["motor"], table["gearbox"], strict=True)) == pairs
    assert repr(selection()).startswith(
        "<Selection: robot arm, pairs 16, ranked by mass, verdict a pair that is strong"
    )


def test_what_cannot_be_chosen_from_is_refused() -> None:
    with pytest.raises(ps.InputError, match="catalogue: expected a Catalogue, as load_catalogue returns it, got 'x'"):
        ps.size(cases(), catalogue="x")  # type: ignore[call-overload]
    with pytest.raises(ps.InputError, match="unknown placement of masses 'behind'; valid: 'before', 'at'"):
        ps.size(cases(), catalogue=catalogue(), masses="behind")  # type: ignore[call-overload]
    with pytest.raises(ps.InputError, match=r"gear ratio of joint 'elbow' is not known; give gearbox\.ratio"):
        ps.size(cases(), drivetrains=[ps.Drivetrain(gearbox=catalogue().gearboxes[0]), ps.Drivetrain()])


@pytest.mark.parametrize("rank", ["mass", "cost", "margin"])
def test_one_size_for_both_joints_is_the_best_that_is_strong_enough_at_both(rank: str) -> None:
    chosen = ps.size(cases(), catalogue=catalogue(), same=[JOINTS], rank=rank)
    own = [{(c.motor, c.gearbox): c for c in joint.kept} for joint in selection().joints]
    both = [(own[0][pair], own[1][pair]) for pair in own[0] if pair in own[1]]
    values = {
        "mass": lambda pair: (pair[0].mass, max(one.stress for one in pair)),
        "cost": lambda pair: (pair[0].cost, max(one.stress for one in pair)),
        "margin": lambda pair: (max(one.stress for one in pair),),
    }
    first, _ = min(both, key=values[rank])
    assert [(one.best.motor, one.best.gearbox) for one in chosen.joints] == [(first.motor, first.gearbox)] * 2
    assert f"one size for shoulder, elbow: {first.motor} with {first.gearbox}" in chosen.notes


def test_where_no_pair_is_strong_enough_at_all_joints_each_has_its_own() -> None:
    small = ps.Catalogue(motors=catalogue().motors[:1], gearboxes=catalogue().gearboxes)
    chosen = ps.size(cases(), catalogue=small, same=[JOINTS])
    assert "no pair is strong enough at all of shoulder, elbow: each has its own" in chosen.notes
    with pytest.raises(ps.InputError, match="unknown joint 'wrist'; valid: 'shoulder', 'elbow'"):
        ps.size(cases(), catalogue=small, same=[["wrist", "elbow"]])


@pytest.mark.slow
@pytest.mark.parametrize(("placement", "told"), [("before", "before"), ("at", "moved by")])
def test_the_elbow_s_drive_loads_the_shoulder_with_its_mass(placement: str, told: str) -> None:
    """Its mass stands on the elbow's axis, 0.4 m from the shoulder's; nothing carries the shoulder's own."""
    found = ps.size(cases(), catalogue=catalogue(), masses=placement)
    elbow = found.joint("elbow").best
    assert elbow is not None
    level, rest = np.array([np.pi / 2, 0.3]), np.zeros(2)
    loaded = found.cycle.steps[0].robot
    more = ps.inverse_dynamics(loaded, level, rest, rest) - ps.inverse_dynamics(arm(), level, rest, rest)
    assert more == pytest.approx([-9.81 * 0.4 * elbow.mass, 0.0], abs=1e-12)
    shoulder = found.joint("shoulder").best
    assert shoulder is not None
    assert found.notes[0] == f"masses of the chosen drives on the link {told} each joint"
    assert found.notes[-1] == f"masses added: {shoulder.mass:g}, {elbow.mass:g} kg"
    # What the arm includes of its drives is taken off first.
    light = ps.size(cases(), catalogue=catalogue(), masses=placement, own_masses=[1.0, 1.0])
    added = [one.best.mass - 1.0 for one in light.joints]
    assert light.notes[-1] == f"masses added: {added[0]:g}, {added[1]:g} kg"


def test_a_joint_is_chosen_after_all_that_it_carries_whatever_the_text_says(tmp_path: Path) -> None:
    """Bug: drives were chosen from the last joint of the URDF's text to the first.

    Where the text has the elbow before the shoulder, the shoulder was chosen without the elbow's drive, and shown as
    strong enough although the sizing beside it was not.
    """
    places = [
        ARM.index(mark) for mark in ('  <joint name="shoulder"', '  <joint name="elbow"', '  <joint name="mount"')
    ]
    shoulder, elbow = ARM[places[0] : places[1]], ARM[places[1] : places[2]]
    swapped = load(tmp_path, ARM.replace(shoulder + elbow, elbow + shoulder), tool="tip")
    assert swapped.joint_names == ("elbow", "shoulder")
    assert (_from_the_tip(swapped), _from_the_tip(arm())) == ([0, 1], [1, 0])
    out = ps.quintic_segments([[0.1, 0.2], [0.3, 1.4]], [0.0, 1.0], joint_names=swapped.joint_names)
    back_and_forth = ps.cycle.with_return(ps.compute_motion(swapped, out))
    found = ps.size(back_and_forth, catalogue=catalogue(), masses="before")
    given = ps.size(moved(arm(), 1.0), catalogue=catalogue(), masses="before")
    for name in JOINTS:
        one, other = found.joint(name).best, given.joint(name).best
        assert one is not None
        assert other is not None
        assert (one.motor, one.gearbox) == (other.motor, other.gearbox)
        assert one.stress == pytest.approx(other.stress, rel=1e-9)


# ---- one sizing of several load cases


def test_of_several_load_cases_each_joint_shows_the_one_that_uses_most() -> None:
    """A rare case is none that a joint's means and its load profile are shown of."""
    train = ps.Drivetrain(motor=catalogue().motors[3], gearbox=catalogue().gearboxes[1])
    several = ps.size(cases(), drivetrains=[train] * 2)
    assert set(several.telling_cases) <= {"quick", "heavy"}
    for j, name in enumerate(JOINTS):
        used = [c for c in several.checks if c.joint == name and c.case != "stop" and c.kind != "rule of thumb"]
        case = max(used, key=lambda check: check.utilisation).case
        assert several.telling_cases[j] == case
        alone = ps.size(next(c.cycle for c in cases() if c.name == case), drivetrains=[train] * 2)
        assert several.demands[j].rms_torque == alone.demands[j].rms_torque
        profile = several.load_profile(name, step=0.1)
        assert profile.time[-1] == alone.cycle.duration
        assert profile.position == pytest.approx(alone.load_profile(name, step=0.1).position)
    assert ps.size(cases()[0].cycle, drivetrains=[train] * 2).telling_cases == ("", "")


def test_what_a_mix_draws_is_the_sum_by_shares() -> None:
    """0.8 of the time the quick cycle, 0.2 the heavy one."""
    motor = ps.Motor(rotor_inertia=1e-4, torque_constant=0.1, resistance=0.5, copper_coefficient=0.0)
    train = ps.Drivetrain(motor=motor, gearbox=ps.Gearbox(ratio=50.0, efficiency=0.8))
    quick, heavy = (
        sum(one.mean_drawn_power for one in ps.size(case.cycle, drivetrains=[train] * 2).demands)
        for case in cases()[:2]
    )
    several = ps.size(cases(), drivetrains=[train] * 2)
    assert several.mean_drawn_power == pytest.approx(0.8 * quick + 0.2 * heavy, rel=1e-9)


def test_without_time_constants_the_mean_rise_is_that_of_the_mean_loss() -> None:
    """``R_th R i^2`` with the resistance at the ambient: 2 ohm at 20 degrees are 2.4 at 70, with 0.004 per K."""
    motor = ps.Motor(
        rotor_inertia=1e-4, torque_constant=0.1, resistance=2.0, copper_coefficient=0.004, reference_celsius=20.0,
        thermal_resistances=[0.5, 1.0], max_winding_celsius=155.0,
    )  # fmt: skip
    train = ps.Drivetrain(motor=motor, gearbox=ps.Gearbox(ratio=50.0, efficiency=0.8), ambient_celsius=70.0)
    sizing = ps.size(cases()[0].cycle, drivetrains=[train] * 2)
    for name, demands in zip(JOINTS, sizing.demands, strict=True):
        rise = 1.5 * 2.4 * (demands.rms_torque / 0.1) ** 2
        assert demands.mean_temperature_rise == pytest.approx(rise, rel=1e-12)
        (check,) = [c for c in sizing.checks if c.joint == name and c.quantity == "mean winding temperature rise"]
        assert (check.demand, check.limit) == pytest.approx((rise, 155.0 - 70.0), rel=1e-12)


@pytest.mark.parametrize(("share", "is_kept"), [(0.99, True), (1.01, False)])
def test_a_selection_rejects_by_the_mean_rise_that_a_sizing_tells(share: float, is_kept: bool) -> None:
    """One per cent on either side of the resistance that takes the whole of what the winding may warm by."""
    known = {"torque_constant": 0.1, "resistance": 2.0, "max_winding_celsius": 155.0}
    motor = replace(catalogue().motors[3], **known, thermal_resistances=[1.0])
    gearbox = catalogue().gearboxes[1]
    alone = ps.size(cases()[1].cycle, drivetrains=[ps.Drivetrain(motor=motor, gearbox=gearbox)] * 2).demands[1]
    least = (155.0 - 40.0) / alone.mean_temperature_rise
    hot = replace(motor, thermal_resistances=[share * least])
    joint = ps.size(cases()[1].cycle, catalogue=ps.Catalogue(motors=[hot], gearboxes=[gearbox])).joint("elbow")
    assert joint.is_feasible.tolist() == [is_kept]
    assert joint.reasons == ("" if is_kept else "mean winding temperature rise",)


def test_the_document_of_a_supply_has_its_checks_alone() -> None:
    motor = ps.Motor(rotor_inertia=1e-4, torque_constant=0.1, resistance=0.5, max_speed=900.0)
    train = ps.Drivetrain(motor=motor, gearbox=ps.Gearbox(ratio=50.0, efficiency=0.8))
    conditions = ps.sizing.Conditions(supply=ps.Supply(peak_power=1e5))
    supply = ps.size(cases(), drivetrains=[train] * 2, conditions=conditions).to_dict()["supply"]
    assert {check["joint"] for check in supply["checks"]} == {"supply"}
    assert [check["limit"] for check in supply["checks"]] == [1e5]
    assert ps.size(cases(), drivetrains=[train] * 2).to_dict()["supply"] is None
