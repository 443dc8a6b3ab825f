"""The gate: a verdict with reasons, closed where something is not known; and the least stretch that holds."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.ros_messages import message, small_move

import puma_septic as ps
from puma_septic.gate import ALLOWABLE, REASON_CODES, TrajectoryCheck, _stretching, fixed
from puma_septic.limits import assessed_at, stretched
from puma_septic.ros import FAULT_CODES, PlannedTrajectory, interpolated
from puma_septic.ros._message import joint_trajectory_message

WIDE = {"velocity": 1e3, "acceleration": 1e5, "jerk": 1e8, "effort": 1e6}
UNKNOWN = ["limit_unknown"]


def limited(robot: ps.Robot, **limits: Any) -> ps.Robot:
    """The arm with limits that nothing breaks, but for the given ones."""
    wide = np.column_stack([np.full(6, -50.0), np.full(6, 50.0)])
    return robot.with_limits(position=limits.pop("position", wide), **{**WIDE, **limits})


def counting(check: TrajectoryCheck) -> list[tuple[str, str | None]]:
    return [(reason.code, reason.joint) for reason in check.reasons if not reason.allowed]


# ---- the verdict


def test_a_motion_within_all_limits_is_ok(puma: ps.Robot) -> None:
    check = ps.check_trajectory(limited(puma), small_move(puma))
    assert check.verdict == "ok"
    assert check.is_ok
    assert check.reasons == ()
    assert len(check.margins) == 30
    assert str(check).startswith("ok; governing limit: joint1 position 0.5 rad at t = 2 s is 49.5 rad from its")


def test_what_is_not_known_leaves_it_undecided_until_it_is_allowed(puma: ps.Robot) -> None:
    """The PUMA's own limits have no acceleration and jerk: closed, not open."""
    move = small_move(puma)
    check = ps.check_trajectory(puma, move)
    assert check.verdict == "undecided"
    assert {(reason.code, reason.quantity) for reason in check.reasons} == {
        ("limit_unknown", "acceleration"),
        ("limit_unknown", "jerk"),
    }
    assert ps.check_trajectory(puma, move, allow=["limit_unknown:jerk"]).verdict == "undecided"
    assert ps.check_trajectory(puma, move, allow=["limit_unknown:jerk", "limit_unknown:acceleration"]).is_ok
    allowed = ps.check_trajectory(puma, move, allow=UNKNOWN)
    assert allowed.is_ok
    assert len(allowed.reasons) == 12
    assert all(reason.allowed for reason in allowed.reasons)


def test_a_drive_that_is_not_known_leaves_the_torque_undecided(puma: ps.Robot) -> None:
    """Without rotor inertia and friction the torque is more than what is computed."""
    robot = limited(puma.with_actuators((ps.Actuator(),) * 6))
    check = ps.check_trajectory(robot, small_move(puma))
    assert check.verdict == "undecided"
    assert {reason.quantity for reason in check.reasons} == {"rotor_inertia", "viscous_friction", "coulomb_friction"}
    assert ps.check_trajectory(robot, small_move(puma), allow=["drive_unknown"]).is_ok
    partly = ps.check_trajectory(robot, small_move(puma), allow=["drive_unknown:rotor_inertia"])
    assert partly.verdict == "undecided"


def test_an_unknown_limit_hides_no_broken_one(puma: ps.Robot) -> None:
    check = ps.check_trajectory(puma, small_move(puma, 0.4))
    assert check.verdict == "violated"
    first = check.reasons[0]
    assert (first.code, first.joint, first.quantity) == ("effort_limit", "joint1", "effort")
    assert first.demand / first.limit == pytest.approx(1.812, abs=1e-3)
    assert 0 < first.time < 0.4
    assert "joint1 torque 101.5 N m" in str(first)


def test_the_start_is_held_against_the_first_point(puma: ps.Robot) -> None:
    robot, move = limited(puma), small_move(puma)
    near = ps.check_trajectory(robot, move, start=[0.009] * 6)
    assert near.is_ok
    far = ps.check_trajectory(robot, move, start=[0, 0, 0, 0, 0, 0.011])
    assert counting(far) == [("start_mismatch", "joint6")]
    assert far.reasons[0].demand == pytest.approx(0.011)
    assert far.reasons[0].limit == 0.01
    assert ps.check_trajectory(robot, move, start=[0.2] * 6, start_tolerance=0.25).is_ok


def test_a_turn_of_a_continuous_joint_is_no_mismatch(puma: ps.Robot) -> None:
    robot = limited(puma)
    turning = np.array([True] + [False] * 5)
    robot = robot.with_limits()
    object.__setattr__(robot, "is_continuous", turning)
    assert ps.check_trajectory(robot, small_move(puma), start=[math.tau, 0, 0, 0, 0, 0]).is_ok


def test_straight_lines_need_an_infinite_torque_and_say_what_is_finite(puma: ps.Robot) -> None:
    """Positions alone: the velocity steps at each point. A controller tracks that; no arm does it exactly."""
    lines = ps.profiles.linear(np.array([[0.0] * 6, [0.2] * 6, [0.3] * 6]), [0, 2, 6.0], joint_names=puma.joint_names)
    check = ps.check_trajectory(limited(puma), lines)
    codes = {code for code, _ in counting(check)}
    assert codes == {
        "moving_start", "moving_end", "unbounded_acceleration", "unbounded_jerk", "unbounded_effort",
    }  # fmt: skip
    velocity = next(one for one in check.margins if (one.joint, one.quantity) == ("joint1", "velocity"))
    assert velocity.demand == pytest.approx(0.1)
    acceleration = next(one for one in check.margins if one.quantity == "acceleration")
    assert acceleration.demand == pytest.approx(0.0, abs=1e-12)
    allow = sorted(codes)
    assert ps.check_trajectory(limited(puma), lines, allow=allow).is_ok
    # What is finite between the steps still counts.
    tight = limited(puma, velocity=0.09)
    assert {code for code, _ in counting(ps.check_trajectory(tight, lines, allow=allow))} == {"velocity_limit"}
    gravity = limited(puma, effort=[1e3, 40.0, 1e3, 1e3, 1e3, 1e3])
    assert counting(ps.check_trajectory(gravity, lines, allow=allow)) == [("effort_limit", "joint2")]


def test_a_velocity_at_an_end_is_told_as_that(puma: ps.Robot) -> None:
    values = np.array([[0.0] * 6, [0.3] * 6])
    move = ps.profiles.cubic(values, [0.0, 2.0], velocities=np.array([[0.0] * 6, [0, 0, 0.1, 0, 0, 0]]))
    move = replace(move, rest_before=True, rest_after=True)  # as a trajectory that is sent to a controller is read
    robot = limited(puma)
    check = ps.check_trajectory(robot, move, allow=["unbounded_jerk"])
    moving = check.reasons[0]
    assert next(code for code, _ in counting(check)) == "moving_end"
    assert (moving.joint, moving.demand, moving.time) == ("joint3", pytest.approx(0.1), 2.0)
    assert "unbounded_effort" in {code for code, _ in counting(check)}
    assert ps.check_trajectory(robot, move, allow=["unbounded_jerk", "moving_end"]).is_ok
    assert ps.check_trajectory(robot, replace(move, rest_after=False), allow=["unbounded_jerk"]).is_ok


@pytest.mark.parametrize("speed", [1e-8, 1.1e-7])
def test_an_end_velocity_that_the_controller_takes_for_rest_is_no_step(puma: ps.Robot, speed: float) -> None:
    """validate_trajectory_msg accepts up to the epsilon of a float, 1.19e-7 rad/s; planners end with 1e-8."""
    values = np.array([[0.0] * 6, [0.3] * 6])
    move = ps.profiles.quintic(values, [0.0, 2.0], velocities=np.array([[0.0] * 6, [0, 0, speed, 0, 0, 0]]))
    move = replace(move, rest_before=True, rest_after=True)
    check = ps.check_trajectory(limited(puma), move)
    assert check.is_ok
    assert check.notes == (f"velocities up to {speed:.2g} at the end are taken for rest, as the controller does",)


def test_an_arm_without_inertia_has_no_torque_to_judge(puma: ps.Robot) -> None:
    """Its kinematic limits are judged all the same."""
    robot = replace(limited(puma), missing_inertia=("joint6",))
    check = ps.check_trajectory(robot, small_move(puma))
    assert check.verdict == "undecided"
    assert counting(check) == [("torque_unknown", "joint6")]
    assert {one.quantity for one in check.margins if one.joint == "joint6"} == {
        "position",
        "velocity",
        "acceleration",
        "jerk",
    }
    assert "effort" in {one.quantity for one in check.margins if one.joint == "joint5"}
    assert ps.check_trajectory(robot, small_move(puma), allow=["torque_unknown"]).is_ok
    slow = robot.with_limits(velocity=0.2)
    assert ps.check_trajectory(slow, small_move(puma)).verdict == "violated"


def test_a_motion_in_doubt_is_undecided(puma: ps.Robot) -> None:
    """What a recording leaves unknown is no verdict; a broken limit is told all the same."""
    move = replace(small_move(puma), doubts=("most of the jerk is noise",))
    check = ps.check_trajectory(limited(puma), move)
    assert check.verdict == "undecided"
    assert [str(reason) for reason in check.reasons] == ["doubtful: most of the jerk is noise"]
    assert ps.check_trajectory(limited(puma), move, allow=["doubtful"]).is_ok
    assert ps.check_trajectory(limited(puma, velocity=0.1), move).verdict == "violated"
    assert ps.least_stretch(limited(puma, velocity=0.1), move).factor > 4


def test_misspelt_reasons_are_refused(puma: ps.Robot) -> None:
    move = small_move(puma)
    with pytest.raises(ps.InputError, match="unknown reason to allow 'limit_unkown'; valid: 'limit_unknown'"):
        ps.check_trajectory(puma, move, allow=["limit_unkown"])
    with pytest.raises(ps.InputError, match="limit_unknown has no 'torque'; valid: limit_unknown:position"):
        ps.check_trajectory(puma, move, allow=["limit_unknown:torque"])
    with pytest.raises(ps.InputError, match="moving_end has no 'joint1', without a colon"):
        ps.check_trajectory(puma, move, allow=["moving_end:joint1"])
    with pytest.raises(ps.InputError, match="got the text 'limit_unknown'"):
        ps.check_trajectory(puma, move, allow="limit_unknown")
    with pytest.raises(ps.InputError, match="'velocity_limit'"):
        ps.check_trajectory(puma, move, allow=["velocity_limit"])


def test_codes_are_distinct_and_described() -> None:
    assert not set(REASON_CODES) & set(FAULT_CODES)
    assert set(ALLOWABLE) < set(REASON_CODES)
    assert all(text and not text.endswith(".") for text in {**REASON_CODES, **FAULT_CODES}.values())


# ---- between the points


def random_move(rng: np.random.Generator) -> ps.Trajectory:
    """What the controller makes of 2 to 5 random points with velocities and, mostly, accelerations."""
    n = int(rng.integers(2, 6))
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(0.3, 1.5, n - 1))])
    velocities, accelerations = rng.uniform(-1, 1, (n, 6)), rng.uniform(-3, 3, (n, 6))
    velocities[[0, -1]] = 0
    accelerations[[0, -1]] = 0
    document = message(
        rng.uniform(-1, 1, (n, 6)),
        times,
        velocities=velocities,
        accelerations=accelerations if rng.random() < 0.7 else None,
    )
    made = joint_trajectory_message(document, [])
    assert made is not None
    return interpolated(made, None, np.zeros(6, dtype=bool))


def sampled_values(robot: ps.Robot, move: ps.Trajectory, quantity: str, t: np.ndarray) -> np.ndarray:
    if quantity == "effort":
        return ps.inverse_dynamics(robot, *(move(t, order) for order in range(3)))
    return move(t, ("position", "velocity", "acceleration", "jerk").index(quantity))


QUANTITIES = ("position", "velocity", "acceleration", "jerk", "effort")


def seeded(robot: ps.Robot, rng: np.random.Generator) -> tuple[ps.Robot, ps.Trajectory, dict[tuple[str, str], float]]:
    """An arm with limits that hold at every point of a motion and are broken by 1e-7 to 1e-2 between two.

    Of every joint and quantity that is larger between the points than at them; with the peaks, by (code, joint).
    The true peak is read off 400 samples between each two points, which can only miss some of it.
    """
    move = random_move(rng)
    inside = np.concatenate([np.linspace(a, b, 402)[1:-1] for a, b in zip(move.times, move.times[1:], strict=False)])
    points = np.clip((move.times[:, None] + np.array([-1e-9, 0.0, 1e-9])).ravel(), 0, move.times[-1])
    limits, broken = {}, {}
    for quantity in QUANTITIES:
        values = np.abs(sampled_values(robot, move, quantity, inside))
        limit = values.max(axis=0) * (1 - 10 ** rng.uniform(-7, -2, 6))
        hidden = limit > np.abs(sampled_values(robot, move, quantity, points)).max(axis=0) * (1 + 1e-6)
        limits[quantity] = np.where(hidden, limit, WIDE.get(quantity, 50.0))
        for j in np.flatnonzero(hidden):
            broken[f"{quantity}_limit", robot.joint_names[j]] = float(values[:, j].max())
    limits["position"] = np.column_stack([-limits["position"], limits["position"]])
    return limited(robot, **limits), move, broken


def test_a_thousand_violations_between_the_points_are_all_found(puma: ps.Robot, rng: np.random.Generator) -> None:
    """Each limit holds at every point and is broken by 1e-7 to 1e-2 between: found by joint, quantity and instant."""
    found = 0
    while found < 1000:
        robot, move, broken = seeded(puma, rng)
        check = ps.check_trajectory(robot, move, allow=["unbounded_jerk"])
        assert set(counting(check)) == set(broken)
        for reason in [reason for reason in check.reasons if not reason.allowed]:
            assert abs(reason.demand) >= (1 - 1e-12) * broken[reason.code, str(reason.joint)]
            # The instant is that of the demand, on one side of it where the torque or the jerk steps there.
            near = np.clip(reason.time + np.array([-1e-9, 0.0, 1e-9]), 0, move.times[-1])
            there = np.abs(sampled_values(robot, move, str(reason.quantity), near))
            j = puma.joint_names.index(str(reason.joint))
            assert there[:, j].max() == pytest.approx(abs(reason.demand), rel=1e-6)
        found += len(broken)


# ---- the least stretch


def test_a_stretch_keeps_the_limits_and_a_thousandth_less_does_not(puma: ps.Robot, rng: np.random.Generator) -> None:
    """60 random motions with the PUMA's own limits, full assessments on both sides of the factor."""
    low, high = (puma.limits.position / 2).T.clip(-1, 1)
    stretches = 0
    for _ in range(60):
        n = int(rng.integers(2, 5))
        times = np.concatenate([[0.0], np.cumsum(rng.uniform(0.1, 0.6, n - 1))])
        move = ps.quintic_segments(rng.uniform(low, high, (n, 6)), times)
        stretch = ps.least_stretch(puma, move)
        assert stretch.assessment.is_feasible
        assert stretch.trajectory.duration == pytest.approx(stretch.factor * move.duration, rel=1e-12)
        if stretch.factor > 1:
            stretches += 1
            assert not ps.assess(puma, stretched(move, 0.999 * stretch.factor)).is_feasible
            assert stretch.governing is not None
            assert stretch.governing.utilisation == pytest.approx(1, abs=1e-8)
    assert stretches > 50


@pytest.mark.parametrize(("quantity", "power"), [("velocity", 1), ("acceleration", 2), ("jerk", 3)])
def test_the_factor_of_a_kinematic_limit_is_its_root(puma: ps.Robot, quantity: str, power: int) -> None:
    """Known answer: at 1/8 of the demand of a limit a motion takes 8, sqrt 8 or 2 times as long."""
    move = small_move(puma)
    demand = getattr(ps.assess(puma, move), f"peak_{quantity}")
    stretch = ps.least_stretch(limited(puma, **{quantity: demand / 8}), move)
    assert stretch.factor == pytest.approx(8 ** (1 / power), rel=1e-8)


def test_torque_gives_the_least_factor(puma: ps.Robot) -> None:
    """Independent of the search: every factor from 1 to 6 on a grid of 200, assessed in full."""
    robot = limited(puma).with_payload(ps.Payload(mass=2.0))
    move = ps.quintic_segments(np.array([[0, 0.6, -1.2, 0, 0.3, 0], [0.4, 0.1, -0.4, 0.3, 0.1, 0]]), [0.0, 0.45])
    peaks = {k: ps.assess(robot, stretched(move, k)).peak_torque for k in np.geomspace(1, 6, 200)}
    for j in range(3):
        limit = np.full(6, 1e6)
        limit[j] = 0.5 * (peaks[1.0][j] + min(peak[j] for peak in peaks.values()))
        first = min(k for k, peak in peaks.items() if peak[j] <= limit[j])
        before = max((k for k in peaks if k < first), default=1.0)
        stretch = ps.least_stretch(robot.with_limits(effort=limit), move)
        assert before <= stretch.factor <= first


PENDULUM = """<robot name="p"><link name="a"/><link name="b"><inertial><mass value="1"/><origin xyz="1 0 0"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 -1 0"/>
<limit effort="{effort}" velocity="1000" lower="-4" upper="4"/></joint></robot>"""


@pytest.mark.parametrize("share", [0.967, 0.975, 0.985])
@pytest.mark.slow
def test_a_swing_that_only_holds_at_some_speeds(tmp_path: Path, share: float) -> None:
    """From hanging to 60 degrees above the horizontal: past the horizontal the pendulum brakes, which carries it.

    The torque is I a + m g l cos q, with I = 1.01 kg m^2, m l = 1 kg m (by hand). A slow swing needs m g l = 9.81 N m,
    a fast one as much to accelerate; between them is an interval of factors that keep less than m g l, though standing
    still in the horizontal does not. The least of them, against a scan of the formula.
    """
    limit = share * 9.81
    path = tmp_path / "p.urdf"
    path.write_text(PENDULUM.format(effort=limit))
    robot = ps.load_robot(path)
    move = ps.quintic_segments([[-np.pi / 2], [np.pi / 3]], [0.0, 0.5])
    t = np.linspace(0, 0.5, 4001)
    q, a = move(t)[:, 0], move(t, 2)[:, 0]
    factors = np.linspace(1, 12, 11001)
    peaks = np.array([np.abs(1.01 * a / k**2 + 9.81 * np.cos(q)).max() for k in factors])
    holds = peaks <= limit
    assert holds.any()
    assert not holds[-1]  # standing still does not hold
    stretch = ps.least_stretch(robot, move)
    least = factors[holds][0]
    assert least - 0.001 <= stretch.factor <= least + 1e-5
    assert not ps.assess(robot, stretched(move, 0.999 * stretch.factor)).is_feasible


def test_where_no_stretch_helps_it_is_said_why(puma: ps.Robot) -> None:
    move = small_move(puma)
    still = ps.assess(puma, stretched(move, 1e4)).peak_torque
    weak = limited(puma, effort=np.where(np.arange(6) == 1, 0.9 * still, 1e3))
    with pytest.raises(
        ps.NoSolution, match=r"joint2 needs .* at any speed, its limit is .* gravity and friction"
    ) as error:
        ps.least_stretch(weak, move)
    assert error.value.q.shape == (6,)
    assert error.value.residual == pytest.approx(0.1 * still[1], rel=1e-3)
    bounds = np.column_stack([np.full(6, -50.0), np.full(6, 50.0)])
    bounds[3, 1] = 0.4
    with pytest.raises(ps.NoSolution, match=r"joint4 position 0\.5 rad .* is violated at any speed"):
        ps.least_stretch(limited(puma, position=bounds), move)
    lines = ps.profiles.linear(np.array([[0.0] * 6, [0.2] * 6]), [0, 2.0])
    with pytest.raises(ps.NoSolution, match="no stretch keeps the velocity with which the motion starts or ends"):
        ps.least_stretch(limited(puma), lines)
    cubic = ps.profiles.cubic(np.array([[0.0] * 6, [0.2] * 6]), [0, 2.0])
    with pytest.raises(ps.NoSolution, match="a step remains a step"):
        ps.least_stretch(limited(puma), cubic)


def test_a_torque_that_gravity_takes_to_its_limit_forbids_no_stretch(tmp_path: Path) -> None:
    """From the horizontal, held by m g l = 9.81 N m, the limit itself, to hanging: only braking there breaks it.

    A spare of 1e-9 that the search once kept took the horizontal, where the torque is at its limit at any speed, for a
    reason that no stretch helps.
    """
    path = tmp_path / "p.urdf"
    path.write_text(PENDULUM.format(effort=9.81))
    move = ps.quintic_segments([[0.0], [-np.pi / 2]], [0.0, 0.3])
    stretch = ps.least_stretch(ps.load_robot(path), move)
    assert stretch.factor > 1.5
    assert stretch.assessment.is_feasible
    assert stretch.assessment.motion.torque(0.0)[0] == pytest.approx(9.81, rel=1e-14)


def test_what_holds_is_left_alone(puma: ps.Robot) -> None:
    move = small_move(puma)
    stretch = ps.least_stretch(limited(puma), move)
    assert stretch.factor == 1
    assert stretch.trajectory is move
    assert stretch.governing is None


def planned_of(move: ps.Trajectory) -> PlannedTrajectory:
    document = message(
        move.points,
        move.times,
        velocities=move(move.times, 1),
        accelerations=move(move.times, 2),
    )
    made = joint_trajectory_message(document, [])
    assert made is not None
    trajectory = interpolated(made, None, np.zeros(6, dtype=bool))
    return PlannedTrajectory(origin="x", trajectory=trajectory, message=made, start=None, notes=(), sha256="")


def test_a_stretch_that_does_not_hold_is_not_given(puma: ps.Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    """The search and the check agree; were it otherwise, a motion beyond a limit must not pass for a sound one."""
    arm, quick = limited(puma, velocity=0.2), small_move(puma)
    monkeypatch.setattr(_stretching, "_MORE", (-0.5,))
    with pytest.raises(ps.NoSolution, match="rounded to the message's nanoseconds, does not hold: joint"):
        fixed(arm, planned_of(quick))
    as_it_is = assessed_at(ps.compute_motion(arm, quick), 1.0)
    monkeypatch.setattr(_stretching, "assessed_at", lambda *_, **__: as_it_is)
    with pytest.raises(ps.NoSolution, match=r"no stretch of time helps: joint\d velocity .* at t = "):
        ps.least_stretch(arm, quick)


@pytest.mark.parametrize("short", [0.001, 0.4])
def test_the_fixed_message_holds_as_it_will_be_read(puma: ps.Robot, rng: np.random.Generator, short: float) -> None:
    """Whole nanoseconds are 1e-6 of a step of a millisecond: what they break gets a little more time, below 0.1 %."""
    for _ in range(10):
        points = np.cumsum(rng.uniform(-short, short, (4, 6)), axis=0).clip(-0.7, 0.7)
        move = ps.quintic_segments(points, np.arange(4) * short / 2)
        made = fixed(puma, planned_of(move), allow=UNKNOWN)
        assert made.check.is_ok
        assert made.factor >= 1
        if made.factor > 1:
            again = interpolated(made.message, None, np.zeros(6, dtype=bool))
            assert ps.assess(puma, again).is_feasible
            assert not ps.assess(puma, stretched(again, 0.999)).is_feasible
