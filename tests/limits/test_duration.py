"""How fast: exact intervals of feasible durations, against closed forms and a scan with bisection on assessments."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.limits import stretched

PENDULUM = """<robot name="p"><link name="a"/><link name="b"><inertial><mass value="1"/><origin xyz="1 0 0"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 -1 0"/>
<limit effort="{effort}" velocity="1000" lower="-4" upper="4"/></joint></robot>"""
# Two answers that are both right to 1e-11 of their torques.
SAME = 1e-9
NO_VELOCITY = {"velocity": np.full(6, np.nan)}


def septic() -> ps.Trajectory:
    points = [
        [0.0] * 6,
        [0.3, -0.4, 0.5, 0.2, 0.1, 0.3],
        [0.6, -0.5, 0.2, 0.5, 0.3, 0.1],
        [0.2, -0.1, 0.7, 0.1, 0.6, 0],
    ]
    return ps.septic(points, [0.0, 3.0, 6.0, 9.0])


def is_kept(robot: ps.Robot, move: ps.Trajectory) -> Callable[[float], bool]:
    """Whether an assessment at a duration has no margin below 0 (positions apart): without the slack of a verdict."""

    def kept(duration: float) -> bool:
        checks = ps.assess(robot, stretched(move, duration / move.duration)).checks
        return all(check.margin >= 0 for check in checks if check.quantity != "position")

    return kept


def bisected(kept: Callable[[float], bool], low: float, high: float) -> float:
    """Where `kept` changes between two durations."""
    first = kept(low)
    while high - low > 1e-12 * high:
        middle = (low + high) / 2
        low, high = (middle, high) if kept(middle) == first else (low, middle)
    return (low + high) / 2


def scanned(kept: Callable[[float], bool], durations: np.ndarray) -> list[list[float]]:
    """Intervals by a dense scan, each end refined by bisection; the last is open."""
    flags = [kept(t) for t in durations]
    ends = [bisected(kept, durations[k], durations[k + 1]) for k in range(len(flags) - 1) if flags[k] != flags[k + 1]]
    if flags[0]:
        ends.insert(0, durations[0])
    return [ends[k : k + 2] if k + 1 < len(ends) else [ends[k], np.inf] for k in range(0, len(ends), 2)]


@pytest.mark.parametrize(("quantity", "power"), [("velocity", 1), ("acceleration", 2), ("jerk", 3)])
def test_kinematic_limits_give_their_roots(puma: ps.Robot, quantity: str, power: int) -> None:
    """Known answer: at k times the duration the demand is k^-power of it."""
    move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    demand = getattr(ps.assess(puma, move), f"peak_{quantity}")
    limits = {"velocity": np.full(6, np.nan), "effort": np.full(6, np.nan), quantity: demand * 8}
    fastest = ps.minimum_duration(ps.compute_motion(puma.with_limits(**limits), move))
    assert fastest.duration == pytest.approx(2 * 8 ** (-1 / power), rel=1e-13)
    assert fastest.governing.quantity == quantity
    assert fastest.feasible.tolist() == [[fastest.duration, np.inf]]
    assert fastest.certificate == "proved"
    assert fastest.assessment.is_feasible


@pytest.mark.parametrize(
    "limits",
    [{}, {"torque_rate": np.full(6, 300.0)}, {"jerk": np.full(6, 4.0)}, {"effort": np.full(6, 60.0)}],
    ids=["torque", "torque rate", "jerk", "one torque"],
)
def test_the_least_duration_is_that_of_bisection_on_assessments(puma: ps.Robot, limits: dict[str, Any]) -> None:
    robot, move = puma.with_limits(**(NO_VELOCITY | limits)), septic()
    fastest = ps.minimum_duration(ps.compute_motion(robot, move))
    assert fastest.duration == pytest.approx(bisected(is_kept(robot, move), 0.1, 20.0), rel=SAME)
    assert fastest.certificate == "proved"
    assert fastest.governing.utilisation == pytest.approx(1, abs=SAME)
    assert not ps.assess(robot, stretched(move, 0.9999 * fastest.factor)).is_feasible


@pytest.mark.parametrize("share", [0.967, 0.975, 0.985])
@pytest.mark.slow
def test_feasibility_is_not_monotone_and_every_interval_is_found(tmp_path: Path, share: float) -> None:
    """From hanging to 60 degrees above the horizontal: past the horizontal the pendulum brakes, which carries it.

    Standing still in the horizontal needs m g l = 9.81 N m, more than the limit, so no duration holds from which on all
    longer ones do; a fast swing needs as much to accelerate; between them is an interval. Its torque by hand is
    I a + m g l cos q, with I = 1.01 kg m^2.
    """
    path = tmp_path / "p.urdf"
    path.write_text(PENDULUM.format(effort=share * 9.81))
    robot, move = ps.load_robot(path), ps.quintic_segments([[-np.pi / 2], [np.pi / 3]], [0.0, 0.5])
    fastest = ps.minimum_duration(ps.compute_motion(robot, move))
    assert fastest.duration == np.inf
    assert "j needs 9.81 N m" in fastest.reason
    assert "gravity and friction alone" in fastest.reason
    expected = scanned(is_kept(robot, move), np.geomspace(0.2, 8, 400))
    assert fastest.feasible.shape == (len(expected), 2)
    assert fastest.feasible == pytest.approx(np.array(expected), rel=SAME)
    assert fastest.assessment.is_feasible
    assert "No duration from which every longer one is feasible" in str(fastest)


def test_two_intervals_and_the_least_of_which_all_longer_ones_hold(tmp_path: Path) -> None:
    """The same swing with a limit just above m g l: between a fast interval and the slow ones some are not feasible."""
    path, move = tmp_path / "p.urdf", ps.quintic_segments([[-np.pi / 2], [np.pi / 3]], [0.0, 0.5])
    path.write_text(PENDULUM.format(effort=9.82))
    robot = ps.load_robot(path)
    fastest = ps.minimum_duration(ps.compute_motion(robot, move))
    expected = np.array(scanned(is_kept(robot, move), np.geomspace(0.2, 20, 400)))
    assert fastest.feasible == pytest.approx(expected, rel=SAME)
    assert fastest.duration == fastest.feasible[-1, 0]
    assert fastest.feasible[-1, 1] == np.inf


def test_any_start_gives_the_same_answer(puma: ps.Robot) -> None:
    """Law: the duration of what is asked about does not matter."""
    robot, move = puma.with_limits(**NO_VELOCITY), septic()
    least = [ps.minimum_duration(ps.compute_motion(robot, stretched(move, k))).duration for k in (0.03, 1.0, 20.0)]
    assert least == pytest.approx([least[1]] * 3, rel=1e-10)


MOTORS: dict[str, dict[str, Any]] = {
    "motor torque": {"motor": {"peak_torque": 0.6}},
    "motor speed": {"motor": {"max_speed": 120.0}},
    "motor power": {"motor": {"peak_power": 40.0}},
    "motor torque at speed": {"motor": {"peak_curve": [[0, 1.0], [60, 0.9], [130, 0.2], [400, 0.1]]}},
    "voltage at torque and speed": {
        "motor": {"torque_constant": 0.2, "resistance": 2.0},
        "drive": {"bus_voltage": 24.0},
    },
    "peak current": {"motor": {"torque_constant": 0.2}, "drive": {"peak_current": 3.0}},
}


@pytest.mark.slow
@pytest.mark.parametrize("quantity", MOTORS)
def test_motors_are_held_to_what_sizing_holds_them_to(puma: ps.Robot, quantity: str) -> None:
    """Two ways: the utilisation that `size` gives at the answer, and beyond it."""
    robot = puma.with_limits(**NO_VELOCITY, effort=np.full(6, np.nan))
    trains = [
        replace(train, **{part: replace(getattr(train, part), **values) for part, values in MOTORS[quantity].items()})
        for train in robot.drivetrains
    ]
    robot, move = robot.with_drivetrains(trains), septic()
    fastest = ps.minimum_duration(ps.compute_motion(robot, move))
    assert fastest.governing.quantity == quantity

    def used(factor: float) -> float:
        sizing = ps.size(ps.Cycle(steps=[ps.compute_motion(robot, stretched(move, factor))]))
        return max(check.utilisation for check in sizing.checks if check.quantity == quantity)

    assert used(fastest.factor) == pytest.approx(1, abs=SAME)
    assert used(0.999 * fastest.factor) > 1
    assert fastest.certificate == ("resolved" if quantity == "motor torque at speed" else "proved")


def test_what_no_duration_keeps_is_said_with_its_reason(puma: ps.Robot) -> None:
    move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    weak = puma.with_limits(effort=np.array([56, 20, 52, 10, 10, 10]))
    with pytest.raises(
        ps.NoSolution, match=r"joint2 needs .* N m at t = .* at any speed, its limit is 20 N m"
    ) as error:
        ps.minimum_duration(ps.compute_motion(weak, move))
    assert error.value.q.shape == (6,)
    outside = ps.quintic_segments([[0.0] * 6, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]], [0.0, 2.0])
    with pytest.raises(ps.NoSolution, match=r"joint3 position 1 rad .* is violated at any speed"):
        ps.minimum_duration(ps.compute_motion(puma, outside))
    with pytest.raises(ps.NoSolution, match="starts or ends; give one from rest to rest"):
        ps.minimum_duration(ps.compute_motion(puma, ps.profiles.linear([[0.0] * 6, [0.2] * 6], [0, 2.0])))


def test_bad_questions_are_refused(puma: ps.Robot) -> None:
    still = ps.quintic_segments([[0.0] * 6, [0.0] * 6], [0.0, 2.0])
    with pytest.raises(ps.InputError, match="moves no joint that has a known limit"):
        ps.minimum_duration(ps.compute_motion(puma, still))
    sticky = ps.Friction(viscous=1e-3, coulomb=[0.4, -0.4], static=[0.6, -0.6], stribeck_velocity=1.0)
    trains = [replace(train, measured_friction=sticky) for train in puma.drivetrains]
    move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    with pytest.raises(ps.InputError, match="Stribeck friction"):
        ps.minimum_duration(ps.compute_motion(puma.with_drivetrains(trains), move))


def test_the_document_says_what_the_text_says(puma: ps.Robot) -> None:
    fastest = ps.minimum_duration(ps.compute_motion(puma, ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])))
    document = fastest.to_dict()
    assert document["duration"] == fastest.duration
    assert document["feasible"] == [[fastest.duration, "unbounded"]]
    assert "Least duration 0.620861 s (quintic_segments)" in str(fastest)
    assert "joint2 velocity 1.51 rad/s" in str(fastest)


def lowered() -> tuple[ps.Robot, ps.Trajectory]:
    """An arm that is let down while its dry friction holds part of it, and its motor holds all of it afterwards."""
    down = ps.quintic_segments([[0, 0.9, -2.2, 0, 0.3, 0], [0, 0.3, -2.2, 0, 0.3, 0]], [0.0, 4.0])
    robot = ps.load_robot().with_payload(ps.Payload(mass=3.0, com=(0, 0, 0.1)))
    assert ps.assess(robot, down).peak_torque[1] < 66 < ps.assess(robot, down, dwell=1.0).peak_torque[1]
    return robot.with_limits(effort=[np.nan, 66.0, *[np.nan] * 4]), down


def test_a_dwell_holds_at_any_duration() -> None:
    """A task's dwell bound `assess` alone: the least duration was called feasible, and broke the limit at rest."""
    robot, down = lowered()
    motion = ps.compute_motion(robot, down)
    free = ps.minimum_duration(motion)
    assert not ps.assess(robot, free.trajectory, dwell=1.0).is_feasible
    with pytest.raises(ps.NoSolution, match=r"joint2 needs 72\.06 N m at t = 4 s at any speed, its limit is 66 N m"):
        ps.minimum_duration(motion, dwell=1.0)
    enough = ps.compute_motion(robot.with_limits(effort=[np.nan, 73.0, *[np.nan] * 4]), down)
    held = ps.minimum_duration(enough, dwell=1.0)
    assert held.assessment.dwell == 1.0
    assert held.assessment.is_feasible


def test_a_dwell_bounds_the_motors_too() -> None:
    """What holds the arm goes through its motors: here no current that their drive can give."""
    robot, down = lowered()
    trains = list(robot.drivetrains)
    train = trains[1]
    motor = replace(train.motor, torque_constant=0.1, peak_torque=np.nan, resistance=np.nan)
    current = 70.0 / train.ratio / 0.1
    trains[1] = replace(train, motor=motor, drive=replace(train.drive, peak_current=current))
    strong = robot.with_limits(effort=np.full(6, np.nan)).with_drivetrains(trains)
    motion = ps.compute_motion(strong, down)
    assert ps.minimum_duration(motion).duration < 4
    with pytest.raises(ps.NoSolution, match=r"joint2 needs 102\.\d+ % of its limit of peak current at t = 4 s"):
        ps.minimum_duration(motion, dwell=1.0)
