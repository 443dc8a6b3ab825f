"""Every check by hand on one trapezoid: what is asked for, and one limit on either side of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.limit_check import LimitCheck
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._checks import DRIVE_LIMITS, DriveLimit, NotAssessed, assess_joint

# One second each of a = 2 rad/s^2, of v = 2 rad/s, of a = -2 rad/s^2, and of rest. The load moves 3 kg m^2 against
# 4 N m (10, 4, -2, 0 N m at the joint), so the motor drives, drives, brakes and rests. Ratio 10, forward 0.8, backward
# 0.6, rotor 0.01 kg m^2 (0.2, 0, -0.2, 0 N m), Coulomb 0.05 N m: 1.5, 0.55, -0.27, 0 N m at the motor.
BREAKS = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
TORQUES = np.array([1.5, 0.55, -0.27, 0.0])
# 0.5 N m/A and 2 ohm: copper loss 2 (3, 1.1, -0.54, 0)^2.
LOSSES = np.array([18.0, 2.42, 0.5832, 0.0])
# Braking gives -0.27 * 20 (1 - s) + 0.5832 W, negative until 1 - s = 0.108.
RETURNED = 2.7 * (1 - 0.108**2) - 0.5832 * (1 - 0.108)
DRAWN = (15.0 + 18.0) + (11.0 + 2.42) + (0.5832 * 0.108 - 2.7 * 0.108**2)
# (|v| |tau|^3: 1000 over 1 rad, 64 over 2 rad, 8 over 1 rad) / 4 rad.
AVERAGE = (1136 / 4) ** (1 / 3)
THERMAL = (1.7, 2.5)  # K/W, s
# Hand sums: what differs is rounding.
EXACT = 1e-12


def steps(values: list[float]) -> Piecewise:
    return Piecewise(breaks=BREAKS, coefficients=np.array(values)[None, :, None])


def load(**changes: object) -> ps.sizing.JointLoad:
    velocity = Piecewise.from_power(BREAKS, [[[0.0], [2.0], [2.0], [0.0]], [[2.0], [0.0], [-2.0], [0.0]]])
    given = {
        "joint": "elbow",
        "is_prismatic": False,
        "torque": steps([10.0, 4.0, -2.0, 0.0]),
        "gravity": steps([0.0, 0.0, 0.0, 0.0]),
        "velocity": velocity,
        "acceleration": steps([2.0, 0.0, -2.0, 0.0]),
        "velocity_sign": np.array([1.0, 1.0, 1.0, 0.0]),
        "power_sign": np.array([1.0, 1.0, -1.0, 0.0]),
        "braked": np.zeros(4, dtype=bool),
        "inertia": steps([3.0, 3.0, 3.0, 3.0]),
        "unbounded": np.nan,
        "why_not_periodic": "",
    }
    return ps.sizing.JointLoad(**(given | changes))  # type: ignore[arg-type]


MOTOR = ps.Motor(
    rotor_inertia=0.008,
    coulomb_friction=0.03,
    viscous_friction=0.0,
    torque_constant=0.5,
    resistance=2.0,
    copper_coefficient=0.0,
    thermal_resistances=THERMAL[:1],
    thermal_time_constants=THERMAL[1:],
)
GEARBOX = ps.Gearbox(
    ratio=-10.0, efficiency=0.8, backward_efficiency=0.6, inertia=0.002, no_load_torque=0.02, rated_torque=20.0,
    rated_speed=100.0, rated_life_hours=7000.0,
)  # fmt: skip


def demands_of(
    *, motor: dict | None = None, gearbox: dict | None = None, drive: dict | None = None, **train: object
) -> ps.sizing.Demands:
    changes = train.pop("load", {})
    assembled = ps.Drivetrain(
        motor=replace(MOTOR, **(motor or {})),
        gearbox=replace(GEARBOX, **(gearbox or {})),
        drive=ps.Drive(**(drive or {})),
        **train,  # type: ignore[arg-type]
    )
    joint = load(**changes)  # type: ignore[arg-type]
    return ps.sizing.Demands(load=joint, train=assembled, motor=ps.sizing.motor_load(joint, assembled))


def outcome(quantity: str, demands: ps.sizing.Demands) -> LimitCheck | NotAssessed:
    (found,) = [each for each in assess_joint(demands) if each.quantity == quantity]
    return found


def winding_rise() -> float:
    """First-order winding, interval by interval: ``theta' = (R P - theta) / tau``; the peak is at t = 1 s."""
    resistance, constant = THERMAL
    kept, state = np.exp(-1 / constant), 0.0
    for loss in [*LOSSES] * 60:  # 240 s are 96 time constants
        state = kept * state + (1 - kept) * resistance * loss
    return float(kept * state + (1 - kept) * resistance * LOSSES[0])


# quantity, demand by hand, unit, critical instant, kind, and the limit as arguments of `demands_of`.
CHECKS = [
    ("actuator effort at the joint", 15.0, "N m", 0.0, "physics", lambda x: {"max_effort": x}),
    ("motor torque", 1.5, "N m", 0.0, "physics", lambda x: {"motor": {"peak_torque": x}}),
    (
        "RMS motor torque at mean speed", np.sqrt((TORQUES**2).sum() / 4), "N m", None, "vendor procedure",
        # The mean speed is 10 (1 + 2 + 1) / 4 = 10 rad/s, half way down.
        lambda x: {"motor": {"continuous_curve": [[0, 1.5 * x], [20, 0.5 * x]]}},
    ),
    ("motor torque at speed", 1.5, "N m", 1.0, "vendor procedure",
     lambda x: {"motor": {"peak_curve": [[0, 2 * x], [20, x], [30, 0]]}}),
    ("voltage at torque and speed", 3 * 2 + 0.5 * 20, "V", 1.0, "physics", lambda x: {"drive": {"bus_voltage": x}}),
    ("motor speed", 20.0, "rad/s", 1.0, "physics", lambda x: {"motor": {"max_speed": x}}),
    ("motor power", 30.0, "W", 1.0, "physics", lambda x: {"motor": {"peak_power": x}}),
    ("winding temperature rise", winding_rise(), "K", 1.0, "physics",
     lambda x: {"motor": {"max_winding_celsius": 25.0 + x}, "ambient_celsius": 25.0}),
    # Load and gear, 3 / 10^2 + 0.002, over the rotor alone.
    ("inertia ratio", 0.032 / 0.008, "", 0.0, "rule of thumb", lambda x: {"motor": {"max_inertia_ratio": x}}),
    ("peak current", 3.0, "A", 0.0, "physics", lambda x: {"drive": {"peak_current": x}}),
    ("RMS current", np.sqrt((TORQUES**2).sum() / 4) / 0.5, "A", None, "vendor procedure",
     lambda x: {"drive": {"continuous_current": x}}),
    ("drawn electric power", 1.5 * 20 + 18, "W", 1.0, "physics", lambda x: {"drive": {"peak_power": x}}),
    ("mean drawn electric power", DRAWN / 4, "W", None, "vendor procedure",
     lambda x: {"drive": {"continuous_power": x}}),
    ("returned electric power", 0.27 * 20 - 0.5832, "W", 2.0, "physics",
     lambda x: {"drive": {"peak_regenerated_power": x}}),
    ("returned energy on the bus", RETURNED, "J", None, "physics", lambda x: {"drive": {"storable_energy": x}}),
    ("mean brake-resistor power", (RETURNED - 0.5) / 4, "W", None, "physics",
     lambda x: {"drive": {"brake_resistor_power": x, "storable_energy": 0.5}}),
    ("gearbox average torque", AVERAGE, "N m", None, "vendor procedure",
     lambda x: {"gearbox": {"max_average_torque": x}}),
    ("gearbox repeated peak torque", 10.0, "N m", 0.0, "vendor procedure",
     lambda x: {"gearbox": {"max_repeated_torque": x}}),
    ("gearbox momentary peak torque", 50.0, "N m", None, "vendor procedure",
     lambda x: {"gearbox": {"max_momentary_torque": x}, "momentary_torque": 50.0}),
    ("gearbox momentary peaks", 1000.0, "", None, "vendor procedure",
     # 10^4 / (2 turns): 20 rad/s for pi/2 s are 5 turns; half as long, twice as many.
     lambda x: {"emergency_stops": 1000.0, "emergency_duration": np.pi / 2 * 1000.0 / x}),
    ("gearbox average input speed", 10.0, "rad/s", None, "vendor procedure",
     lambda x: {"gearbox": {"max_average_input_speed": x}}),
    ("gearbox input speed", 20.0, "rad/s", 1.0, "vendor procedure", lambda x: {"gearbox": {"max_input_speed": x}}),
]  # fmt: skip


# What nobody asks for is not listed either.
ASKED = {"gearbox momentary peaks"}
BEARING = ("tilting moment", "axial force", "radial force", "static load", "life")


@pytest.mark.parametrize(
    ("quantity", "demand", "unit", "time", "kind", "limit"), CHECKS, ids=[check[0] for check in CHECKS]
)
def test_each_check_fails_above_its_limit_and_passes_below(
    quantity: str, demand: float, unit: str, time: float | None, kind: str, limit: object
) -> None:
    tight, loose = (outcome(quantity, demands_of(**limit(demand * part))) for part in (0.8, 1.25))  # type: ignore[operator]
    for check, part in ((tight, 0.8), (loose, 1.25)):
        assert isinstance(check, LimitCheck)
        assert (check.joint, check.unit, check.kind) == ("elbow", unit, kind)
        assert check.demand == pytest.approx(demand, rel=EXACT)
        assert check.limit == pytest.approx(demand * part, rel=EXACT)
        assert check.utilisation == pytest.approx(1 / part, rel=EXACT)
        assert check.margin == pytest.approx(1 - 1 / part, rel=EXACT)
        assert np.isnan(check.time) if time is None else check.time == pytest.approx(time, abs=1e-9)
        assert check.source
    assert tight.is_violated
    assert not loose.is_violated


def test_life_is_asked_for_and_held_against_what_is_expected() -> None:
    """7000 h (100 / 10) (20^3 / 284): the wear is |v| |tau|^3 again."""
    expected = 7000 * 10 * 8000 / 284
    for part in (0.8, 1.25):
        check = outcome("gearbox life", demands_of(required_life_hours=expected * part))
        assert check.limit == pytest.approx(expected, rel=EXACT)
        assert check.utilisation == pytest.approx(part, rel=EXACT)
        assert check.is_violated == (part > 1)


def test_at_its_limit_a_demand_is_within_it() -> None:
    assert not outcome("motor torque", demands_of(motor={"peak_torque": 1.5})).is_violated


def test_all_that_is_unknown_is_not_assessed_with_what_it_needs() -> None:
    bare = ps.Drivetrain(motor=ps.Motor(), gearbox=ps.Gearbox(ratio=10.0))
    joint = load()
    demands = ps.sizing.Demands(load=joint, train=bare, motor=ps.sizing.motor_load(joint, bare))
    outcomes = assess_joint(demands)
    assert all(isinstance(each, NotAssessed) for each in outcomes)
    of_bearing = {f"output bearing {name}" for name in BEARING}
    assert {each.quantity for each in outcomes} == {"gearbox life"} | of_bearing | {
        check[0] for check in CHECKS
    } - ASKED
    assert outcome("motor torque", demands).reason == "needs the motor's peak torque"


# ---- the equation of the motor's torque


def test_the_motor_s_torque_by_hand() -> None:
    motor = demands_of().motor
    middles = (BREAKS[:-1] + BREAKS[1:]) / 2
    np.testing.assert_allclose(motor.torque(middles)[:, 0], TORQUES, rtol=EXACT)
    np.testing.assert_allclose(motor.parts["load"](middles)[:, 0], [1.25, 0.5, -0.12, 0.0], rtol=EXACT)
    np.testing.assert_allclose(motor.parts["rotor"](middles)[:, 0], [0.2, 0.0, -0.2, 0.0], rtol=EXACT)
    np.testing.assert_allclose(motor.parts["friction"](middles)[:, 0], [0.05, 0.05, 0.05, 0.0], rtol=EXACT)


def test_a_self_locking_gear_takes_no_torque_back() -> None:
    motor = demands_of(gearbox={"backward_efficiency": 0.0}).motor
    assert motor.torque(2.5)[0] == pytest.approx(-0.2 + 0.05, rel=EXACT)


def test_rotor_and_motor_friction_do_not_load_the_gears() -> None:
    heavy = demands_of(motor={"rotor_inertia": 0.5, "coulomb_friction": 3.0})
    assert heavy.peak_load_torque.size == pytest.approx(10.0, rel=EXACT)
    assert heavy.average_load_torque == pytest.approx(AVERAGE, rel=EXACT)
    assert heavy.peak_torque.size > 10.0


def test_a_brake_relieves_the_motor_and_not_the_gears() -> None:
    held = {"torque": steps([10.0, 4.0, -2.0, 30.0]), "braked": np.array([False, False, False, True])}
    free = demands_of(load=held | {"braked": np.zeros(4, dtype=bool)})
    braked = demands_of(load=held)
    # At rest the gears pass the torque as it is: 30 / 10.
    assert free.peak_torque.size == pytest.approx(3.0, rel=EXACT)
    assert braked.peak_torque.size == pytest.approx(1.5, rel=EXACT)
    assert braked.peak_load_torque.size == pytest.approx(30.0, rel=EXACT)
    assert braked.average_load_torque == pytest.approx(AVERAGE, rel=EXACT)


# ---- what has no number


def test_a_cycle_that_does_not_repeat_has_no_steady_temperature() -> None:
    once = demands_of(motor={"max_winding_celsius": 155.0}, load={"why_not_periodic": "the cycle does not return"})
    refused = outcome("winding temperature rise", once)
    assert refused.reason == "no steady temperature: the cycle does not return"
    assert once.rms_torque == pytest.approx(np.sqrt((TORQUES**2).sum() / 4), rel=EXACT)


def test_a_winding_that_runs_away_is_unbounded() -> None:
    """Mean loss at the reference 5.25 W, 1.7 K/W: a growth of 0.2 per K is beyond 1 / (5.25 * 1.7) = 0.112."""
    hot = demands_of(motor={"copper_coefficient": 0.2, "max_winding_celsius": 155.0})
    check = outcome("winding temperature rise", hot)
    assert check.demand == np.inf
    assert check.is_violated


def test_a_velocity_that_steps_asks_for_unbounded_torque() -> None:
    known = {"peak_torque": 100.0, "peak_curve": [[0, 100], [100, 50]], "continuous_torque": 50.0, "peak_power": 1e6}
    struck = demands_of(motor=known, drive={"continuous_power": 1e6, "storable_energy": 1e6}, load={"unbounded": 1.0})
    for quantity in (
        "motor torque", "motor torque at speed", "RMS motor torque at mean speed", "motor power",
        "mean drawn electric power", "returned energy on the bus",
    ):  # fmt: skip
        check = outcome(quantity, struck)
        assert check.demand == np.inf
        assert check.is_violated
    assert outcome("motor torque", struck).time == 1.0
    assert "unbounded at t = 1 s" in str(outcome("motor torque", struck))


def test_a_joint_that_never_moves_wears_nothing() -> None:
    still = steps([0.0, 0.0, 0.0, 0.0])
    rest = demands_of(
        load={"velocity": still, "acceleration": still, "velocity_sign": np.zeros(4), "power_sign": np.zeros(4)},
        gearbox={"max_average_torque": 5.0},
        required_life_hours=1e4,
    )
    assert outcome("gearbox average torque", rest).reason == "the joint never moves"
    assert outcome("gearbox life", rest).utilisation == 0.0


def test_a_speed_beyond_the_curve_s_end_leaves_no_torque() -> None:
    check = outcome("motor torque at speed", demands_of(motor={"peak_curve": [[0, 9], [19, 9]]}))
    assert check.limit == 0.0
    assert check.utilisation == np.inf
    assert check.time == pytest.approx(1.0)


def test_sliding_joints_speak_of_newtons() -> None:
    assert outcome("gearbox repeated peak torque", demands_of(
        gearbox={"max_repeated_torque": 9.0}, load={"is_prismatic": True}
    )).unit == "N"  # fmt: skip


# ---- declaring one


def declared(**changes: str) -> DriveLimit:
    row = {"quantity": "motor jerk", "demand": "peak_speed", "limit": "motor.max_speed", "unit": "rad/s", "needs": "it"}
    return DriveLimit(**{**row, "kind": "physics", **changes})  # type: ignore[arg-type]


def test_a_limit_cannot_be_declared_without_its_bounds() -> None:
    """Once the selection accepted in silence what a new check rejected: bounds stood in another file, by its text."""
    assert declared().quantity == "motor jerk"
    with pytest.raises(TypeError, match="check 'motor jerk': PairDemands has no 'inertia_ratio'"):
        declared(demand="inertia_ratio")
    with pytest.raises(TypeError, match="check 'motor jerk': Motor has no 'max_jerk'"):
        declared(limit="motor.max_jerk")
    with pytest.raises(TypeError, match="check 'motor jerk': Demands has no 'peak_jerk'"):
        declared(demand="peak_jerk")


def test_a_rule_of_thumb_rejects_nothing_and_needs_no_bounds() -> None:
    assert declared(demand="inertia_ratio", kind="rule of thumb").demand == "inertia_ratio"
    assert len({limit.quantity for limit in DRIVE_LIMITS}) == len(DRIVE_LIMITS)
