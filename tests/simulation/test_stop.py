"""Stops: closed forms of one joint, the full assessment, an own integration, published figures, and what is refused."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from helpers.arms import joint, link, load
from helpers.moves import POINTS, TIMES
from helpers.places import UR5
from scipy.integrate import solve_ivp

import puma_septic as ps
from puma_septic.simulation import NOT_A_SAFETY_FUNCTION, stop_table, worst_stop

Array = np.ndarray


@cache
def quick_motion() -> ps.Motion:
    """The paper's septic in 4 s instead of 9, within the torque limits of `roomy`."""
    return ps.compute_motion(roomy(), ps.septic(POINTS, TIMES * 4 / 9))


@cache
def roomy() -> ps.Robot:
    return ps.load_robot(limits="akb")


def wheel(folder: Path, *, tilt: str = "0 0 1") -> ps.Robot:
    """One joint about the vertical: inertia 0.5 + 2 0.3^2 = 0.68 kg m^2."""
    text = link("base", 1.0, [0, 0, 0], np.eye(3)) + link("arm", 2.0, [0.3, 0, 0], np.diag([0.1, 0.1, 0.5]))
    axis = [float(value) for value in tilt.split()]
    return load(folder, "wheel", text + joint("turn", "revolute", "base", "arm", [0, 0, 0], axis)).with_limits(
        effort=20.0
    )


def constant_speed(speed: float, duration: float = 2.0) -> ps.Trajectory:
    line = ps.Piecewise.from_power([0.0, duration], [[[0.0]], [[speed * duration]]])
    return ps.Trajectory(position=line, points=[[0.0], [speed * duration]], times=[0.0, duration]).excerpt


def test_one_joint_without_gravity(tmp_path: Path) -> None:
    """Category 1: ``t = w J / T``, ``w^2 J / (2 T)``; category 0 with a reaction time: ``w r`` more."""
    motion = ps.compute_motion(wheel(tmp_path), constant_speed(3.0))
    controlled = ps.stop(motion, 0.5)
    assert controlled.duration == pytest.approx(3.0 * 0.68 / 20, rel=2e-3)
    assert controlled.distance[0] == pytest.approx(9.0 * 0.68 / 40, rel=2e-3)
    late = ps.stop(motion, 0.5, reaction_time=0.1)
    assert late.duration == pytest.approx(0.1 + controlled.duration, rel=1e-9)
    assert late.distance[0] == pytest.approx(0.3 + controlled.distance[0], rel=1e-9)
    braked = ps.stop(motion, 0.5, category=0, brake_torque=10.0, reaction_time=0.05)
    assert braked.duration == pytest.approx(0.05 + 3.0 * 0.68 / 10, abs=1e-3)  # the step is 0.5 ms
    assert braked.distance[0] == pytest.approx(0.15 + 9.0 * 0.68 / 20, rel=2e-3)
    assert NOT_A_SAFETY_FUNCTION in str(braked)


@pytest.mark.parametrize("t", [0.6, 1.5, 2.4])
def test_a_controlled_stop_holds_the_torque_limits_by_the_full_assessment(t: float) -> None:
    halt = ps.stop(quick_motion(), t)
    assert halt.stopping is not None
    assessment = ps.assess(halt.stopping)
    assert not [check for check in assessment.violations if check.quantity == "effort"]
    assert (assessment.peak_torque / roomy().limits.effort).max() > 0.99  # a joint is at its limit
    path = halt.stopping.trajectory
    original = quick_motion().trajectory
    assert path(0.0) == pytest.approx(original(t), abs=1e-12)
    assert path(0.0, 1) == pytest.approx(original(t, 1), abs=1e-8)
    assert path(path.duration, 1) == pytest.approx(np.zeros(6), abs=1e-8)


@pytest.mark.parametrize("t", [0.6, 1.5, 2.4])
def test_a_controlled_stop_cannot_be_shorter_by_1_percent(t: float) -> None:
    """The hardest deceleration at each state, integrated by an adaptive method with torques of `inverse_dynamics`."""
    robot, limits, move = roomy(), roomy().limits.effort, quick_motion().trajectory

    def hardest(s: float, r: float) -> float:
        q, first, second = (move(s, order) for order in range(3))
        rest = np.zeros(6)
        inertia = ps.inverse_dynamics(robot, q, rest, first) - ps.inverse_dynamics(robot, q, rest, rest)
        load = ps.inverse_dynamics(robot, q, first * max(r, 1e-9), second * r * r)
        return float(np.max(np.minimum((limits - load) / inertia, (-limits - load) / inertia)))

    def slope(_: float, y: Array) -> list[float]:
        return [y[1], hardest(y[0], y[1])]

    def at_rest(_: float, y: Array) -> float:
        return float(y[1])

    at_rest.terminal = True  # type: ignore[attr-defined]
    least = solve_ivp(slope, (0.0, 2.0), [t, 1.0], events=at_rest, rtol=1e-8, atol=1e-10).t_events[0][0]
    halt = ps.stop(quick_motion(), t)
    assert least <= halt.duration * (1 + 1e-6)
    assert halt.duration < 1.01 * least


def test_the_worst_of_many_stops_is_the_stop_at_its_instant() -> None:
    worst = worst_stop(quick_motion(), instants=41)
    t, duration = worst.longest
    assert ps.stop(quick_motion(), t).duration == pytest.approx(duration, rel=1e-3)
    where, distance = worst.farthest
    assert ps.stop(quick_motion(), float(where[0])).distance[0] == pytest.approx(distance[0], rel=1e-3)
    assert worst.durations[[0, -1]] == pytest.approx([0, 0], abs=2e-4)
    braked = worst_stop(quick_motion(), category=0, brake_torque=80.0, reaction_time=0.01, instants=5)
    assert braked.durations[2] == pytest.approx(
        ps.stop(quick_motion(), float(braked.times[2]), category=0, brake_torque=80.0, reaction_time=0.01).duration
    )


@pytest.mark.slow
def test_brakes_that_do_not_hold_the_weight(tmp_path: Path) -> None:
    """A pendulum without a brake or friction swings on."""
    arm = wheel(tmp_path, tilt="0 1 0")
    motion = ps.compute_motion(arm, constant_speed(1.0))
    halt = ps.stop(motion, 0.5, category=0, brake_torque=0.0, reaction_time=0.0)
    assert np.isinf(halt.duration)
    assert "does not hold" in str(halt)


def test_a_stop_at_the_end_of_the_motion_is_the_end() -> None:
    assert ps.stop(quick_motion(), quick_motion().trajectory.duration).duration == 0
    near = ps.stop(quick_motion(), 3.999)
    assert near.duration <= 0.001 + 1e-9
    assert ps.stop(quick_motion(), 3.9, reaction_time=0.5).duration == pytest.approx(0.1)


def test_a_motion_beyond_its_torque_limits_has_no_stop_on_its_path(puma: ps.Robot) -> None:
    motion = ps.compute_motion(puma.with_payload(ps.Payload(mass=30.0)), ps.septic(POINTS, TIMES))
    with pytest.raises(
        ps.NoSolution, match=r"no stop along the path at t = 3 s keeps .* 'joint3' is at \d+\.?\d* % of"
    ):
        ps.stop(motion, 3.0)
    assert np.isnan(worst_stop(motion, instants=3).durations[1])


def test_a_ur5_beside_its_makers_figures() -> None:
    """UR5 user manual, CB3, category 0 at 183 deg/s, full extension, 5 kg: base, shoulder, elbow 0.31, 0.70, 0.22 rad.

    Each joint on its own torque limit and gravity: 0.27, 0.74 and 0.07 with the wrist along the forearm. The elbow's
    own limit is not what stops it: on the path the shoulder must carry its reaction beside the weight, which takes
    0.45 rad; under brakes of the same torque the shoulder slips, and the elbow stops after 0.015 rad. The maker's brake
    curve is between.
    """
    robot = ps.load_robot(UR5)
    speed = np.deg2rad(183.0)
    table = stop_table(robot, load=5.0, speed=speed, fractions=(1.0,))
    base, shoulder, elbow = (row.angle for row in table.rows)
    assert base == pytest.approx(0.30, abs=0.01)
    assert shoulder == pytest.approx(0.78, abs=0.02)
    assert elbow == pytest.approx(0.45, abs=0.02)
    alone = {
        name: stop_table(
            robot.with_limits(effort=np.where(np.arange(6) == j, robot.limits.effort, 1e6)),
            load=5.0, speed=speed, joints=[name], fractions=(1.0,),
        ).rows[0].angle
        for j, name in enumerate(robot.joint_names[:3])
    }  # fmt: skip
    assert alone["shoulder_pan_joint"] == pytest.approx(0.27, abs=0.03)
    assert alone["shoulder_lift_joint"] == pytest.approx(0.74, abs=0.05)
    assert alone["elbow_joint"] == pytest.approx(0.10, abs=0.03)  # the wrist is 5 cm farther out


def test_the_table_of_annex_b(puma: ps.Robot) -> None:
    table = stop_table(puma, load=2.5)
    assert len(table.rows) == 3 * 27
    assert table.joints == puma.joint_names[:3]
    by_load = [row.angle for row in table.rows if (row.joint, row.speed, row.extension) == ("joint1", 1.0, 1.0)]
    assert by_load == sorted(by_load)
    assert table.worst("joint1").speed == 1.0
    reach = [float(np.hypot(*ps.forward_kinematics(puma, q)[:2, 3])) / table.reach for q in table.postures]
    assert reach == pytest.approx([0.33, 0.66, 1.0], abs=2e-3)
    text = str(table)
    assert "Stops of category 1" in text
    assert NOT_A_SAFETY_FUNCTION.split(":")[0] in " ".join(text.split())
    assert table.to_csv().splitlines()[0] == "joint,speed,extension,load,duration,angle,others"


def three_joints(folder: Path, name: str, *, place: str = "0 0 0", tip_first: bool = False) -> ps.Robot:
    """A turning base, a shoulder and an elbow 1 m apart, somewhere."""
    size = 0.1 * np.eye(3)
    joints = [
        joint("turn", "revolute", "base", "column", [0, 0, 0.5], [0, 0, 1]),
        joint("shoulder", "revolute", "column", "upper", [0, 0, 0], [0, 1, 0]),
        joint("elbow", "revolute", "upper", "fore", [1, 0, 0], [0, 1, 0]),
    ]
    links = [link(one, 5.0, [0.5, 0, 0], size) for one in ("column", "upper", "fore")]
    stands = f'''<link name="world"/><link name="base"/><link name="tip"/>
    <joint name="stand" type="fixed"><parent link="world"/><child link="base"/><origin xyz="{place}"/></joint>
    <joint name="end" type="fixed"><parent link="fore"/><child link="tip"/><origin xyz="0.8 0 0"/></joint>'''
    return load(folder, name, "".join([*links, *(joints[::-1] if tip_first else joints), stands]), tool="tip")


def test_a_table_knows_the_arm_from_its_base_wherever_it_stands_in_world_and_text(tmp_path: Path) -> None:
    """Bug: reach was measured from the world's z axis, and the joints counted in the order of the URDF's text.

    On a stand 2 m beside that axis a reach of 1.8 m became 3.8 m, with other postures for a share of it; where the text
    has the wrist first, that was bent, and the table was one of its stops.
    """
    one = stop_table(three_joints(tmp_path, "one"), load=1.0)
    assert one.reach == pytest.approx(1.8, rel=1e-6)
    beside = stop_table(three_joints(tmp_path, "beside", place="0 2 0"), load=1.0)
    other = stop_table(three_joints(tmp_path, "other", tip_first=True), load=1.0)
    assert other.robot.joint_names == ("elbow", "shoulder", "turn")
    for table in (beside, other):
        assert table.reach == pytest.approx(one.reach, rel=1e-6)
        assert table.joints == ("turn", "shoulder", "elbow")
    bends = [np.abs(np.sin(table.postures[:, k])) for table, k in ((one, 2), (beside, 2), (other, 0))]
    np.testing.assert_allclose(bends[1:], [bends[0]] * 2, atol=1e-3)
    # Without gravity's help or hindrance: a joint about the vertical, whichever way the elbow is bent.
    base = [[row.angle for row in table.rows if row.joint == "turn"] for table in (one, beside, other)]
    np.testing.assert_allclose(base[1:], [base[0]] * 2, rtol=1e-3)


def test_bad_input(puma: ps.Robot, tmp_path: Path) -> None:
    motion = quick_motion()
    nobody = puma.with_limits(effort=[np.nan, 97.0, 52.0, 10.0, 10.0, 10.0])
    for wrong, message in (
        (
            lambda: ps.stop(motion, 1.0, category=0),
            r"a stop of category 0 needs brake_torque and reaction_time: the torque of each joint's brake",
        ),
        (lambda: ps.stop(motion, 1.0, category=0, brake_torque=10.0), r"category 0 needs reaction_time"),
        (
            lambda: ps.stop(motion, 1.0, category=0, brake_torque=[9.0] * 5 + [-1.0], reaction_time=0.0),
            r"joint 'joint6': brake_torque = -1 N m must be at least 0",
        ),
        (lambda: ps.stop(motion, 1.0, category=2), r"category = 2: unknown; 0: power off at once"),
        (lambda: ps.stop(motion, 4.5), r"t = 4.5 s must be at most 4 s"),
        (lambda: ps.stop(motion, 1.0, brake_torque=5.0), r"brake_torque goes with category=0"),
        (
            lambda: ps.stop(ps.compute_motion(nobody, motion.trajectory), 1.0),
            r"needs the torque limit of every joint; not known of joint1",
        ),
        (lambda: stop_table(puma, load=-1.0), r"load = -1 kg must be at least 0"),
        (lambda: stop_table(puma, load=1.0, fractions=(0.0,)), r"fractions\[0\] = 0 must be greater than 0"),
        (lambda: stop_table(puma, load=1.0, speed=0.0), r"speed = 0 rad/s must be greater than 0"),
        (
            lambda: stop_table(puma.with_limits(velocity=np.nan), load=1.0),
            r"needs the speed limit of each joint, or speed=; not known of joint1, joint2, joint3",
        ),
        (lambda: stop_table(puma, load=1.0, joints=["elbow"]), r"unknown joint 'elbow'"),
        (
            lambda: stop_table(wheel(tmp_path), load=1.0, brake_torque=50.0),
            r"a table of extensions needs a tool that at least 3 joints carry; '.*' of robot 'wheel' is carried by 1",
        ),
    ):
        with pytest.raises(ps.InputError, match=message):
            wrong()
