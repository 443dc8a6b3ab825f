"""How heavy: exact intervals of masses, sweeps and maps, and the payload diagram."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.limits import stretched

COM = [0.05, 0.0, 0.1]


def move() -> ps.Trajectory:
    return ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 1.0])


def carrying(robot: ps.Robot, mass: float, gyration: float = 0.0) -> ps.Robot:
    return robot.with_payload(ps.Payload(mass=mass, com=COM, inertia=np.eye(3) * gyration * mass))


def used(robot: ps.Robot, trajectory: ps.Trajectory) -> float:
    checks = ps.assess(robot, trajectory).checks
    return max(check.utilisation for check in checks if check.quantity in ("effort", "torque_rate"))


@pytest.mark.parametrize(("gyration", "rate"), [(0.0, np.nan), (0.01, np.nan), (0.0, 2000.0)])
def test_the_mass_is_that_of_bisection_on_assessments(puma: ps.Robot, gyration: float, rate: float) -> None:
    robot = puma.with_limits(torque_rate=np.full(6, rate))
    heaviest = ps.maximum_payload(ps.compute_motion(robot, move()), com=COM, gyration=np.eye(3) * gyration)
    low, high = 0.1, 100.0
    while high - low > 1e-12 * high:
        middle = (low + high) / 2
        low, high = (middle, high) if used(carrying(robot, middle, gyration), move()) <= 1 else (low, middle)
    assert heaviest.mass == pytest.approx(low, rel=1e-9)
    assert heaviest.certificate == "proved"
    assert heaviest.governing.utilisation == pytest.approx(1, abs=1e-9)
    assert heaviest.assessment.is_feasible
    assert heaviest.feasible[0].tolist() == [0.0, heaviest.mass]


def test_an_arm_may_need_a_load(puma: ps.Robot) -> None:
    """With the wrench of a pull upwards the arm needs a weight in its hand: the interval of masses excludes 0."""
    pulled = puma.with_wrench(ps.Wrench(force=[0, 0, 60.0], axes="world"))
    still = ps.compute_motion(puma, move())
    alone = ps.assess(ps.compute_motion(pulled, move())).peak_torque
    light = ps.assess(ps.compute_motion(carrying(pulled, 4.0), move())).peak_torque
    j = int(np.argmax(alone - light))
    limit = np.full(6, np.nan)
    limit[j] = (alone[j] + light[j]) / 2
    robot = pulled.with_limits(effort=limit)
    answer = ps.maximum_payload(ps.compute_motion(robot, move()), com=COM)
    least, most = answer.feasible[0]
    assert 0 < least < 4 < most
    assert used(carrying(robot, least), move()) == pytest.approx(1, abs=1e-9)
    assert used(carrying(robot, least * 0.999), move()) > 1
    assert still.robot.payload is None


def test_the_robots_own_payload_is_the_shape_by_default(puma: ps.Robot) -> None:
    robot = puma.with_payload(ps.Payload(mass=2.0, com=COM, inertia=np.diag([0.02, 0.02, 0.02])))
    own = ps.maximum_payload(ps.compute_motion(robot, move()))
    same = ps.maximum_payload(ps.compute_motion(puma, move()), com=COM, gyration=np.eye(3) * 0.01)
    assert own.mass == pytest.approx(same.mass, rel=1e-12)
    assert own.payload is not None
    assert own.payload.inertia == pytest.approx(np.eye(3) * 0.01 * own.mass)


def test_motors_limit_the_payload(puma: ps.Robot) -> None:
    trains = [
        replace(train, motor=replace(train.motor, peak_curve=[[0, 1.2], [60, 1.1], [200, 0.7], [500, 0.1]]))
        for train in puma.with_limits(effort=np.full(6, np.nan)).drivetrains
    ]
    robot = puma.with_limits(effort=np.full(6, np.nan)).with_drivetrains(trains)
    heaviest = ps.maximum_payload(ps.compute_motion(robot, move()), com=COM)
    assert heaviest.governing.quantity == "motor torque at speed"
    sizing = ps.size(ps.Cycle(steps=[ps.compute_motion(carrying(robot, heaviest.mass), move())]))
    shares = [check.utilisation for check in sizing.checks if check.quantity == "motor torque at speed"]
    assert max(shares) == pytest.approx(1, abs=1e-9)


def test_what_no_mass_keeps_is_said(puma: ps.Robot) -> None:
    outside = ps.quintic_segments([[0.0] * 6, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]], [0.0, 2.0])
    with pytest.raises(ps.NoSolution, match=r"joint3 position 1 rad .*, whatever is carried"):
        ps.maximum_payload(ps.compute_motion(puma, outside))
    with pytest.raises(ps.NoSolution, match="no payload keeps the limits: joint2 velocity"):
        ps.maximum_payload(ps.compute_motion(puma, stretched(move(), 0.5)))
    weak = puma.with_limits(effort=np.array([56, 20, 52, 10, 10, 10]))
    with pytest.raises(ps.NoSolution, match=r"no payload keeps the limits: without any, joint2 torque"):
        ps.maximum_payload(ps.compute_motion(weak, move()))
    free = puma.with_limits(effort=np.full(6, np.nan))
    with pytest.raises(ps.InputError, match="no joint with a known limit bears the payload"):
        ps.maximum_payload(ps.compute_motion(free, move()))
    with pytest.raises(ps.InputError, match="symmetric"):
        ps.maximum_payload(ps.compute_motion(puma, move()), gyration=np.arange(9.0).reshape(3, 3))


def test_sweeps_are_what_assessments_say(puma: ps.Robot, rng: np.random.Generator) -> None:
    """Two ways, torque rates included: peaks and root mean squares of 20 of 400 pairs, each assessed alone."""
    robot = puma.with_limits(torque_rate=np.full(6, 500.0))
    motion = ps.compute_motion(robot, move())
    sweep = ps.payload_duration_map(motion, np.linspace(0.4, 4, 20), np.linspace(0, 5, 20), com=COM)
    assert sweep.is_feasible.any()
    assert not sweep.is_feasible.all()
    for k in rng.integers(0, 20, (20, 2)).tolist():
        duration, mass = sweep.durations[*k], sweep.masses[*k]
        one = ps.assess(carrying(robot, mass) if mass else robot, stretched(move(), duration))
        assert sweep.peak_torque[*k] == pytest.approx(one.peak_torque, rel=1e-10)
        assert sweep.rms_torque[*k] == pytest.approx(one.rms_torque, rel=1e-10)
        assert sweep.peaks["torque_rate"][*k] == pytest.approx(one.peak("torque_rate")[0], rel=1e-7)
        assert sweep.peaks["jerk"][*k] == pytest.approx(one.peak_jerk, rel=1e-12)
        assert sweep.is_feasible[*k] == one.is_feasible
        worst = max((c for c in one.checks if c.quantity != "position"), key=lambda c: c.utilisation)
        assert sweep.utilisation[*k] == pytest.approx(worst.utilisation, rel=1e-7)
        assert robot.joint_names[sweep.governing_joint[*k]] == worst.joint
        assert sweep.governing_quantity[*k] == worst.quantity


def test_one_axis_at_a_time(puma: ps.Robot) -> None:
    robot = carrying(puma, 2.0)
    motion = ps.compute_motion(robot, move())
    whole = ps.payload_duration_map(motion, [1.0, 2.0], [0.0, 2.0])
    assert ps.duration_sweep(motion, [1.0, 2.0]).peak_torque == pytest.approx(whole.peak_torque[:, 1], rel=1e-12)
    assert ps.payload_sweep(motion, [0.0, 2.0]).peak_torque == pytest.approx(whole.peak_torque[0], rel=1e-12)
    rows = whole.to_csv().splitlines()
    assert rows[0].startswith("duration,mass,feasible,utilisation,joint,quantity,peak velocity joint1")
    assert len(rows) == 5
    assert whole.to_dict()["governing"][0].startswith("joint")
    with pytest.raises(ps.InputError, match="durations: at least one"):
        ps.duration_sweep(motion, [])
    with pytest.raises(ps.InputError, match="the least of durations = 0"):
        ps.duration_sweep(motion, [0.0, 1.0])
    with pytest.raises(ps.InputError, match="the least of masses = -1 kg"):
        ps.payload_sweep(motion, [-1.0, 1.0])


def test_the_polygon_holds_and_no_more(puma: ps.Robot, rng: np.random.Generator) -> None:
    """Law: at its masses the static torque reaches a limit in some pose, by `inverse_dynamics`."""
    poses = rng.uniform(-0.7, 0.7, (30, 6))
    polygon = ps.payload_polygon(puma, poses, direction=(0, 0, 2.0))
    offsets = np.linspace(0, 0.6, 7)
    rest = np.zeros_like(poses)
    for offset, mass in zip(offsets, polygon.mass(offsets), strict=True):
        loaded = puma.with_payload(ps.Payload(mass=mass, com=[0, 0, offset]))
        share = np.abs(ps.inverse_dynamics(loaded, poses, rest, rest)) / puma.limits.effort
        assert share.max() == pytest.approx(1, rel=1e-12)
    assert (np.diff(polygon.mass(offsets)) <= 0).all()
    assert polygon.governing[0] == (-1, "")
    with pytest.raises(ps.InputError, match=r"offset\[0\] = -1 m must be at least 0 m; turn the direction instead"):
        polygon.mass([-1.0])
    with pytest.raises(ps.InputError, match="direction: expected three numbers, not all 0"):
        ps.payload_polygon(puma, poses, direction=(0, 0, 0))
    with pytest.raises(ps.NoSolution, match="pose 0: joint2 needs"):
        ps.payload_polygon(puma.with_limits(effort=np.array([56, 1, 52, 10, 10, 10])), np.zeros((1, 6)))
    with pytest.raises(ps.InputError, match="no joint with a known torque limit bears the payload in these poses"):
        ps.payload_polygon(puma.with_limits(effort=np.full(6, np.nan)), poses)


def test_a_diagram_over_motions_is_the_least_of_their_payloads(puma: ps.Robot) -> None:
    motions = [ps.compute_motion(puma, stretched(move(), k)) for k in (1.0, 2.0)]
    masses = ps.payload_diagram(motions, [0.0, 0.2])
    each = [[ps.maximum_payload(motion, com=[0, 0, d]).mass for motion in motions] for d in (0.0, 0.2)]
    assert masses == pytest.approx(np.min(each, axis=1), rel=1e-12)
    slow = ps.payload_diagram(ps.compute_motion(puma, stretched(move(), 1e4)), [0.1])
    assert slow[0] > masses[0] > masses[1]


def test_payload_over_duration_is_the_payload_at_each(puma: ps.Robot) -> None:
    motion = ps.compute_motion(puma.with_limits(torque_rate=np.full(6, 500.0)), move())
    durations = [0.3, 0.8, 1.0, 3.0]
    masses = ps.payload_over_duration(motion, durations, com=COM)
    assert np.isnan(masses[0]).all()  # too fast for joint2, whatever is carried
    for duration, (least, most) in zip(durations[1:], masses[1:], strict=True):
        alone = ps.maximum_payload(ps.compute_motion(motion.robot, stretched(move(), duration)), com=COM)
        assert least == alone.feasible[0, 0]
        assert most == pytest.approx(alone.mass, rel=1e-9)


def test_a_dwell_bounds_the_payload(puma: ps.Robot) -> None:
    """Let down, the arm's own friction carries part of the load; at rest afterwards the motor holds all of it."""
    down = ps.quintic_segments([[0, 0.9, -2.2, 0, 0.3, 0], [0, 0.3, -2.2, 0, 0.3, 0]], [0.0, 4.0])
    motion = ps.compute_motion(puma, down)
    moved, held = ps.maximum_payload(motion, com=COM), ps.maximum_payload(motion, com=COM, dwell=0.5)
    assert held.mass < 0.95 * moved.mass
    assert not ps.assess(carrying(puma, moved.mass), down, dwell=0.5).is_feasible
    assert ps.assess(carrying(puma, held.mass * (1 - 1e-9)), down, dwell=0.5).is_feasible
    assert not ps.assess(carrying(puma, held.mass * (1 + 1e-6)), down, dwell=0.5).is_feasible
    assert held.governing.time == 4.0
    curve = ps.payload_over_duration(motion, [4.0, 8.0], com=COM, dwell=0.5)
    assert curve[:, 1] == pytest.approx(held.mass, rel=1e-9)
