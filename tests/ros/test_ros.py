"""JointTrajectory: what the controller makes of it, what is refused, and back again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.ros_messages import NAMES, message, small_move
from hypothesis import example, given
from hypothesis import strategies as st
from ruamel.yaml import YAML

import puma_septic as ps
from puma_septic.ros import JointState, JointTrajectoryError, interpolated, read_joint_state, read_joint_trajectories
from puma_septic.ros._message import joint_trajectory_message
from puma_septic.ros._texts import documents_of, text_of
from puma_septic.ros._writing import message_of


def written(folder: Path, document: Any, name: str = "move.json") -> Path:
    path = folder / name
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def faults(path: Path, robot: ps.Robot, **options: Any) -> list[tuple[str, str]]:
    with pytest.raises(JointTrajectoryError) as caught:
        ps.read_joint_trajectory(path, robot, **options)
    return [(fault.code, fault.message) for fault in caught.value.faults]


# ---- the interpolation of the controller


def controller(a: dict[str, Any], b: dict[str, Any], j: int, t: float, T: float) -> tuple[float, float, float]:
    """Position, velocity and acceleration of one joint, t after point a, as joint_trajectory_controller samples them.

    Written from the formulas of ros2_controllers, joint_trajectory_controller/src/trajectory.cpp,
    ``interpolate_between_points`` (Humble, Jazzy and 6.9 agree), in powers of t and with plain numbers.
    """
    p0, p1 = a["positions"][j], b["positions"][j]
    if a["velocities"] and b["velocities"]:
        v0, v1 = a["velocities"][j], b["velocities"][j]
        if a["accelerations"] and b["accelerations"]:
            a0, a1 = a["accelerations"][j], b["accelerations"][j]
            c = [
                p0,
                v0,
                0.5 * a0,
                (-20 * p0 + 20 * p1 - 3 * a0 * T**2 + a1 * T**2 - 12 * v0 * T - 8 * v1 * T) / (2 * T**3),
                (30 * p0 - 30 * p1 + 3 * a0 * T**2 - 2 * a1 * T**2 + 16 * v0 * T + 14 * v1 * T) / (2 * T**4),
                (-12 * p0 + 12 * p1 - a0 * T**2 + a1 * T**2 - 6 * v0 * T - 6 * v1 * T) / (2 * T**5),
            ]
        else:
            c = [
                p0,
                v0,
                (-3 * p0 + 3 * p1 - 2 * v0 * T - v1 * T) / T**2,
                (2 * p0 - 2 * p1 + v0 * T + v1 * T) / T**3,
            ]
    else:
        c = [p0, (p1 - p0) / T]
    return (
        sum(ck * t**k for k, ck in enumerate(c)),
        sum(k * ck * t ** (k - 1) for k, ck in enumerate(c) if k > 0),
        sum(k * (k - 1) * ck * t ** (k - 2) for k, ck in enumerate(c) if k > 1),
    )


@pytest.mark.parametrize("fields", ["linear", "cubic", "quintic", "mixed"])
def test_between_points_it_is_what_the_controller_samples(
    puma: ps.Robot, rng: np.random.Generator, tmp_path: Path, fields: str
) -> None:
    """20 messages of 6 points: position, velocity and acceleration equal the controller's formulas to 1e-12."""
    for round_ in range(20):
        n = 6
        times = np.cumsum(rng.uniform(0.5, 1.5, n)).round(9) - 0.5
        times = (times - times[0]).round(9)
        rows = rng.uniform(-1, 1, (3, n, 6))
        has_v = rng.random(n) < 0.7 if fields == "mixed" else np.full(n, fields != "linear")
        has_a = has_v & (rng.random(n) < 0.7) if fields == "mixed" else np.full(n, fields == "quintic")
        document = message(
            rows[0],
            times,
            velocities=[row if has else None for row, has in zip(rows[1], has_v, strict=True)],
            accelerations=[row if has else None for row, has in zip(rows[2], has_a, strict=True)],
        )
        trajectory = ps.read_joint_trajectory(written(tmp_path, document, f"{round_}.json"), puma)
        points = document["points"]
        for k in range(n - 1):
            T = times[k + 1] - times[k]
            for s in (0.0, 0.13, 0.5, 0.77):
                t = times[k] + s * T
                got = [trajectory(t, order) for order in range(3)]
                for j in range(6):
                    want = controller(points[k], points[k + 1], j, t - times[k], T)
                    # A dozen terms of up to 60, the coefficients of an acceleration of 1 over 0.5 s.
                    assert np.allclose([x[j] for x in got], want, rtol=0, atol=1e-12 * 60)
                    assert abs(got[0][j] - want[0]) < 1e-12


def test_the_spline_of_one_segment_by_hand(puma: ps.Robot, tmp_path: Path) -> None:
    """From 0 to 1 rad in 1 s: the line at its middle 0.5, the cubic's 1.5 h/T, the quintic's 15/8 h/T (textbook)."""
    ends, rest = [[0.0] * 6, [1.0, 0, 0, 0, 0, 0]], [[0.0] * 6] * 2
    for speed, options in (
        (1.0, {}),
        (1.5, {"velocities": rest}),
        (1.875, {"velocities": rest, "accelerations": rest}),
    ):
        path = written(tmp_path, message(ends, [0, 1], **options), f"{speed}.json")
        move = ps.read_joint_trajectory(path, puma)
        assert move(0.5)[0] == pytest.approx(0.5, abs=1e-15)
        assert move(0.5, 1)[0] == pytest.approx(speed, abs=1e-14)
        assert move.profile == "joint_trajectory"
        assert move.joint_names == puma.joint_names


# ---- where the motion begins


def test_a_first_point_later_than_zero_is_reached_from_the_start_state(puma: ps.Robot, tmp_path: Path) -> None:
    """The controller interpolates from the state that it measures, with the spline that the first point asks for."""
    document = message([[0.2] * 6, [0.3] * 6], [0.5, 1.0], velocities=[[0.1] * 6, [0.0] * 6])
    path = written(tmp_path, document)
    alone = read_joint_trajectories(path, puma)[0]
    assert alone.trajectory.breaks.tolist() == [0.5, 1.0]
    assert "no start state: the motion is taken to begin at the first point, at 0.5 s" in alone.notes[0]
    for start in ([0.1] * 6, dict.fromkeys(puma.joint_names, 0.1)):
        move = ps.read_joint_trajectory(path, puma, start=start)
        assert move.breaks.tolist() == [0.0, 0.5, 1.0]
        want = controller(
            {"positions": [0.1], "velocities": [0.0], "accelerations": []},
            {"positions": [0.2], "velocities": [0.1], "accelerations": []},
            0,
            0.2,
            0.5,
        )
        assert [move(0.2, order)[3] for order in range(3)] == pytest.approx(want, abs=1e-14)
        assert move.rest_before


def test_a_start_state_that_moves_is_no_step(puma: ps.Robot, tmp_path: Path) -> None:
    path = written(tmp_path, message([[0.2] * 6], [0.5], velocities=[[0.0] * 6]))
    start = JointState(joint_names=NAMES[::-1], position=np.arange(6.0)[::-1] / 10, velocity=np.full(6, 0.3))
    move = ps.read_joint_trajectory(path, puma, start=start)
    assert move(0.0).tolist() == pytest.approx([0, 0.1, 0.2, 0.3, 0.4, 0.5])
    assert move(0.0, 1).tolist() == pytest.approx([0.3] * 6)
    assert not move.rest_before


def test_a_continuous_joint_is_reached_the_short_way(tmp_path: Path) -> None:
    """A wheel at 6.2 rad goes to 0.1 rad by +0.183, as with the controller's wraparound, not back by a turn."""
    urdf = tmp_path / "wheel.urdf"
    urdf.write_text(
        '<robot name="w"><link name="a"/><link name="b"><inertial><mass value="1"/><origin xyz="0 0 0.1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j"'
        ' type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit effort="1" velocity="9"/>'
        "</joint></robot>"
    )
    robot = ps.load_robot(urdf)
    path = written(tmp_path, message([[0.1]], [1.0], names=("j",)))
    move = ps.read_joint_trajectory(path, robot, start=[6.2])
    assert float(move(0.0)[0]) == pytest.approx(6.2 - 2 * np.pi)


def test_one_point_needs_a_start(puma: ps.Robot, tmp_path: Path) -> None:
    [(code, text)] = faults(written(tmp_path, message([[0.1] * 6], [1.0])), puma)
    assert code == "start_unknown"
    assert "a single point" in text


def test_a_start_that_does_not_fit_is_refused(puma: ps.Robot, tmp_path: Path) -> None:
    path = written(tmp_path, message([[0.1] * 6, [0.2] * 6], [1.0, 2.0]))
    with pytest.raises(ps.InputError, match="start: no position for joint 'joint2', 'joint3'"):
        ps.read_joint_trajectory(path, puma, start={name: 0.0 for name in NAMES if name not in ("joint2", "joint3")})
    with pytest.raises(ps.InputError, match=r"start: shape \(3,\)"):
        ps.read_joint_trajectory(path, puma, start=[0.0, 0.0, 0.0])


# ---- joints


def test_joints_are_found_by_name_in_any_order(puma: ps.Robot, tmp_path: Path) -> None:
    order = [3, 0, 5, 1, 4, 2]
    values = np.arange(12.0).reshape(2, 6) / 20
    document = message(values[:, order], [0, 1], names=tuple(NAMES[k] for k in order))
    move = ps.read_joint_trajectory(written(tmp_path, document), puma)
    assert move(0.0).tolist() == pytest.approx(values[0])
    assert move(1.0).tolist() == pytest.approx(values[1])


def test_missing_and_unknown_joints_are_all_named(puma: ps.Robot, tmp_path: Path) -> None:
    names = ("joint1", "joint2", "joint3", "joint5", "finger", "joint1")
    found = faults(written(tmp_path, message([[0.0] * 6] * 2, [0, 1], names=names)), puma)
    assert found == [("unknown_joint", "joint_names: 'joint1' is listed twice")]
    found = faults(written(tmp_path, message([[0.0] * 5] * 2, [0, 1], names=names[:5]), "b.json"), puma)
    assert [code for code, _ in found] == ["unknown_joint", "missing_joint", "missing_joint"]
    assert "robot 'puma560' has no joint 'finger'; it has joint1" in found[0][1]
    assert "joint 'joint4' of robot 'puma560' is missing" in found[1][1]
    assert "'joint6'" in found[2][1]


def test_a_locked_joint_may_be_there_as_long_as_it_stands_still(tmp_path: Path) -> None:
    robot = ps.load_robot(locked={"joint6": 0.3})
    still = written(tmp_path, message([[0, 0, 0, 0, 0, 0.3], [0.1, 0, 0, 0, 0, 0.3]], [0, 1]), "still.json")
    [planned] = read_joint_trajectories(still, robot)
    assert planned.trajectory.joint_names == robot.joint_names == NAMES[:5]
    assert planned.notes == ("joint 'joint6' is fixed in the robot; its column, 0.3 throughout, is not used",)
    moving = written(tmp_path, message([[0.0] * 6, [0.1] * 6], [0, 1]), "moving.json")
    [(code, text)] = faults(moving, robot)
    assert code == "unknown_joint"
    assert "joint 'joint6' is fixed in robot 'puma560', but moves by 0.1 here" in text


# ---- formats

ECHO = """header:
  stamp:
    sec: 0
    nanosec: 0
  frame_id: ''
joint_names:
- joint1
- joint2
- joint3
- joint4
- joint5
- joint6
points:
- positions:
  - 0.0
  - 0.0
  - 0.0
  - 0.0
  - 0.0
  - 0.0
  velocities: []
  accelerations: []
  effort: []
  time_from_start:
    sec: 0
    nanosec: 0
- positions:
  - 0.1
  - 0.1
  - 0.1
  - 0.1
  - 0.1
  - 1.0e-05
  velocities: []
  accelerations: []
  effort: []
  time_from_start:
    sec: 1
    nanosec: 500000000
---
"""


def test_what_topic_echo_prints_is_read(puma: ps.Robot, tmp_path: Path) -> None:
    path = tmp_path / "echo.yaml"
    path.write_text(ECHO)
    move = ps.read_joint_trajectory(path, puma)
    assert move.breaks.tolist() == [0.0, 1.5]
    assert move(1.5)[5] == 1e-5
    path.write_text(ECHO + ECHO)
    with pytest.raises(ps.InputError, match="2 trajectories in it; index=0 to 1"):
        ps.read_joint_trajectory(path, puma)
    assert ps.read_joint_trajectory(path, puma, index=1).duration == 1.5
    with pytest.raises(
        ps.InputError, match=r"index of a trajectory in .*echo.yaml = 2: expected a whole number from 0 to 1"
    ):
        ps.read_joint_trajectory(path, puma, index=2)
    assert [planned.origin for planned in read_joint_trajectories(path, puma)] == [
        f"{path}, trajectory 0",
        f"{path}, trajectory 1",
    ]


def test_yaml_on_one_line_as_topic_pub_takes_it(puma: ps.Robot, tmp_path: Path) -> None:
    path = tmp_path / "pub.yaml"
    points = "{positions: [0, 0, 0, 0, 0, 0], time_from_start: 0}, {positions: [1, 0, 0, 0, 0, 0], time_from_start: 2}"
    path.write_text(f"{{joint_names: [{', '.join(NAMES)}], points: [{points}]}}")
    assert ps.read_joint_trajectory(path, puma)(1.0)[0] == 0.5


@pytest.mark.parametrize(
    "stamp",
    [{"sec": 1, "nanosec": 500_000_000}, {"secs": 1, "nsecs": 500_000_000}, 1.5, {"sec": 1, "nanosec": 5 * 10**8}],
)
def test_times_of_ros_1_and_2_and_plain_seconds(puma: ps.Robot, tmp_path: Path, stamp: Any) -> None:
    document = message([[0.0] * 6, [0.1] * 6], [0, 1])
    document["points"][1]["time_from_start"] = stamp
    assert ps.read_joint_trajectory(written(tmp_path, document), puma).breaks[-1] == 1.5


PLAIN = message([[0.0] * 6, [0.1] * 6], [0, 1])
MULTI = {"header": {}, "joint_names": [], "points": []}
ROBOT_TRAJECTORY = {"joint_trajectory": PLAIN, "multi_dof_joint_trajectory": MULTI}
START = {"joint_state": {"header": {}, "name": list(NAMES), "position": [0.25] * 6, "velocity": [], "effort": []}}


@pytest.mark.parametrize(
    "document",
    [
        PLAIN,
        ROBOT_TRAJECTORY,
        {"model_id": "puma", "trajectory": [ROBOT_TRAJECTORY], "trajectory_start": START},
        {"trajectory_start": START, "group_name": "arm", "trajectory": ROBOT_TRAJECTORY, "planning_time": 0.1,
         "error_code": {"val": 1}},
        {"motion_plan_response": {"trajectory": ROBOT_TRAJECTORY, "error_code": {"val": 1}}},
        {"trajectory": PLAIN, "multi_dof_trajectory": MULTI, "path_tolerance": [], "component_path_tolerance": [],
         "goal_tolerance": [], "component_goal_tolerance": [], "goal_time_tolerance": {"sec": 0, "nanosec": 0}},
        {"goal_id": {"uuid": [0] * 16}, "goal": {"trajectory": PLAIN}},
        {"header": {}, "goal_id": {}, "goal": {"trajectory": PLAIN, "goal_time_tolerance": {}}},
        {"trajectory": ROBOT_TRAJECTORY, "controller_names": []},
        [PLAIN],
    ],
    ids=["plain", "RobotTrajectory", "DisplayTrajectory", "MotionPlanResponse", "GetMotionPlan", "goal", "send_goal",
         "ros1_action_goal", "ExecuteTrajectory", "list"],
)  # fmt: skip
def test_plans_of_moveit_and_goals_of_actions(puma: ps.Robot, tmp_path: Path, document: Any) -> None:
    """The same motion in each of the messages that carry a JointTrajectory, as JSON and as YAML."""
    yaml = tmp_path / "move.yaml"
    with yaml.open("w") as stream:
        YAML(typ="safe", pure=True).dump(document, stream)
    for path in (written(tmp_path, document), yaml):
        assert ps.read_joint_trajectory(path, puma)(0.5).tolist() == pytest.approx([0.05] * 6)


def test_a_plan_says_where_it_starts(puma: ps.Robot, tmp_path: Path) -> None:
    plan = {"trajectory": [ROBOT_TRAJECTORY, ROBOT_TRAJECTORY], "trajectory_start": START}
    first, second = read_joint_trajectories(written(tmp_path, plan), puma)
    assert first.start is not None
    assert first.start.position.tolist() == [0.25] * 6
    assert "the start state is the one in the plan" in first.notes
    assert second.start is None
    given = read_joint_trajectories(tmp_path / "move.json", puma, start=[0.0] * 6)[0]
    assert given.start is not None
    assert given.start.position.tolist() == [0.0] * 6
    empty = {"trajectory": [ROBOT_TRAJECTORY], "trajectory_start": {"joint_state": {"name": [], "position": []}}}
    [planned] = read_joint_trajectories(written(tmp_path, empty, "empty.json"), puma)
    assert planned.start is None
    assert planned.notes == ("the plan has no start state for all joints of the robot",)


def test_a_joint_state_file(tmp_path: Path) -> None:
    path = tmp_path / "state.yaml"
    path.write_text("header: {}\nname: [b, a]\nposition: [1.0, 2]\nvelocity: []\neffort: []\n---\n")
    state = read_joint_state(path)
    assert state.joint_names == ("b", "a")
    assert state.position.tolist() == [1, 2]
    assert state.velocity.tolist() == [0, 0]
    path.write_text("name: [a, b]\nposition: [1.0]\n")
    with pytest.raises(ps.InputError, match="position has 1 values for 2 joints"):
        read_joint_state(path)
    path.write_text("positions: [1.0]\n")
    with pytest.raises(ps.InputError, match=r"no JointState \(name, position\)"):
        read_joint_state(path)


# ---- what is refused


def change(**changes: Any) -> dict[str, Any]:
    return {**message([[0.0] * 6, [0.1] * 6], [0, 1]), **changes}


def change_point(**changes: Any) -> dict[str, Any]:
    document = message([[0.0] * 6, [0.1] * 6], [0, 1])
    document["points"][1].update(changes)
    return document


@pytest.mark.parametrize(
    ("document", "code", "words"),
    [
        (change(points=[]), "no_trajectory", "points: at least one is needed"),
        (change(joint_names=[]), "no_trajectory", "joint_names: a list of names is needed"),
        (change(joint_names="joint1"), "no_trajectory", "joint_names: a list of names is needed"),
        (change(joint_name=[]), "unknown_key", "joint_name is no field of a JointTrajectory; valid: header"),
        ({"plan": PLAIN}, "no_trajectory", "no JointTrajectory (joint_names, points) in the document, which has plan"),
        ({"trajectory": PLAIN, "speed": 2}, "unknown_key", "speed is no field of a message around a JointTrajectory"),
        ([], "no_trajectory", "no JointTrajectory in it"),
        ([3], "no_trajectory", "[0] is no message but 3"),
        (change_point(velocity=[]), "unknown_key", "points[1].velocity is no field of a JointTrajectoryPoint"),
        (change_point(positions=[0.0] * 5), "bad_value", "points[1].positions has 5 values for 6 joints"),
        (change_point(velocities=[0.0] * 7), "bad_value", "points[1].velocities has 7 values for 6 joints"),
        (change_point(positions=["1"] * 6), "bad_value", "numbers up to 1e12 are expected, got '1'"),
        (change_point(positions=[True] * 6), "bad_value", "numbers up to 1e12 are expected, got True"),
        (change_point(positions=[10**400] + [0] * 5), "bad_value", "numbers up to 1e12 are expected, got 1000"),
        (change_point(positions=[1e13] + [0] * 5), "bad_value", "numbers up to 1e12 are expected, got 1000000000"),
        (change_point(positions={"a": 1}), "bad_value", "numbers up to 1e12 are expected, got {'a': 1}"),
        (change_point(time_from_start=None), "bad_value", "time_from_start: seconds, or whole {sec, nanosec}"),
        (change_point(time_from_start={"sec": 1, "nsec": 2}), "bad_value", "got {'sec': 1, 'nsec': 2}"),
        (change_point(time_from_start={"sec": 0.5}), "bad_value", "got {'sec': 0.5}"),
        (change_point(time_from_start={"sec": 1, "nanosec": 10**9}), "bad_value", "with nanosec below 1e9"),
        (change_point(time_from_start=1e300), "bad_value", "got 1e+300"),
        (change_point(time_from_start={"sec": 0, "nanosec": 0}), "time_order", "points[1] at 0 s does not come after"),
        (message([[0.0] * 6], [-1]), "time_order", "points[0].time_from_start is negative"),
        (change_point(time_from_start=-1.0), "time_order", "points[1] at -1 s does not come after points[0] at 0 s"),
        (change_point(positions=[]), "unsupported", "points[1] has no positions: the controller refuses it"),
        (change_point(accelerations=[0.0] * 6), "unsupported", "points[1] has accelerations without velocities"),
        (change(points=[*PLAIN["points"], 7]), "bad_value", "points[2]: a JointTrajectoryPoint is expected"),
        (change(points=[*PLAIN["points"], "..."]), "truncated", "points ends in '...': `ros2 topic echo` has cut it"),
        (change_point(positions=[0.0, "..."]), "truncated", "record it with --full-length"),
        ({"joint_trajectory": PLAIN, "multi_dof_joint_trajectory": {"points": [1]}}, "unsupported",
         "multi_dof_joint_trajectory moves joints of several degrees of freedom"),
    ],
)  # fmt: skip
def test_what_is_wrong_has_a_code_a_place_and_a_remedy(
    puma: ps.Robot, tmp_path: Path, document: Any, code: str, words: str
) -> None:
    found = faults(written(tmp_path, document), puma)
    assert code in [one for one, _ in found]
    assert any(words in text for _, text in found)


def test_everything_that_is_wrong_is_told_at_once(puma: ps.Robot, tmp_path: Path) -> None:
    document = change_point(positions=[0.0] * 5, time_from_start={"sec": -1}, speed=1)
    document["points"][0]["velocities"] = ["fast"] * 6
    found = faults(written(tmp_path, document), puma)
    assert [code for code, _ in found] == ["bad_value", "unknown_key", "bad_value"]
    with pytest.raises(JointTrajectoryError, match=r"move\.json: points\[0\]\.velocities: .*; points\[1\]\.speed"):
        ps.read_joint_trajectory(tmp_path / "move.json", puma)


def test_faults_say_in_which_trajectory_they_are(puma: ps.Robot, tmp_path: Path) -> None:
    late = {"joint_trajectory": change_point(time_from_start=0.0)}
    plan = written(tmp_path, {"trajectory": [ROBOT_TRAJECTORY, late]})
    [(code, text)] = faults(plan, puma)
    assert code == "time_order"
    assert text.startswith("trajectory 1, trajectory[1].joint_trajectory: points[1] at 0 s does not come after")


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.yaml", "points: [", "not valid YAML"),
        ("a.yaml", "points: &a [1]\nb: *a", "anchors and aliases"),
        ("a.yaml", "a: " + "[" * 5000, "nested more than 24 levels deep"),
        ("a.yaml", "a: 1\na: 2", "duplicate key"),
        ("a.yaml", "#" * 2_000_001, "larger than the 2,000,000 bytes that a trajectory file may have"),
        ("a.json", "[" * 200_000, "not valid JSON"),
        ("a.json", '{"a": 1, "a": 2}', "the key 'a' is given twice"),
        ("a.json", '{"a": NaN}', "NaN is no number of JSON"),
        ("a.json", '{"a": 1e999, "points": [1]}', "a is no field"),
        ("a.json", '{"a": 1,}', "not valid JSON"),
        ("a.json", '{"a": ' + "9" * 5000 + "}", "not valid JSON"),
        ("a.yaml", "", "no JointTrajectory in it"),
        ("a.yaml", "just text", "the document is no message but 'just text'"),
    ],
)
def test_files_that_are_not_what_they_should_be(
    puma: ps.Robot, tmp_path: Path, name: str, content: str, words: str
) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(JointTrajectoryError, match=r"a\.(yaml|json)") as caught:
        ps.read_joint_trajectory(tmp_path / name, puma)
    assert words in str(caught.value)


def test_a_file_that_is_not_there_and_one_that_is_no_text(puma: ps.Robot, tmp_path: Path) -> None:
    assert faults(tmp_path / "none.yaml", puma) == [("unreadable", "this trajectory file does not exist")]
    for name in (f"{300 * 'x'}.mcap", f"{300 * 'x'}.yaml", 300 * "x"):
        ((code, told),) = faults(tmp_path / name, puma)
        assert (code, "File name too long" in told) == ("unreadable", True)
    (tmp_path / "b.yaml").write_bytes(b"points: \xff")
    assert faults(tmp_path / "b.yaml", puma)[0][0] == "unreadable"


# ---- writing


@pytest.mark.parametrize("suffix", [".yaml", ".yml", ".json"])
def test_a_quintic_survives_the_file_exactly(puma: ps.Robot, tmp_path: Path, suffix: str) -> None:
    move = small_move(puma)
    same = ps.read_joint_trajectory(ps.write_joint_trajectory(tmp_path / f"m{suffix}", move), puma)
    t = np.linspace(0, 2, 37)
    for order in range(3):
        # Sums of a few terms of up to 6 rad/s^2.
        assert np.abs(same(t, order) - move(t, order)).max() < 1e-14 * 10 ** (order + 1)


@pytest.mark.parametrize(
    ("make", "fields"),
    [
        (lambda p, t: ps.profiles.linear(p, t), ["positions"]),
        (lambda p, t: ps.profiles.cubic(p, t), ["positions", "velocities"]),
        (lambda p, t: ps.profiles.cubic_spline(p, t), ["positions", "velocities"]),
        (lambda p, t: ps.profiles.bang_bang(p, t), ["positions", "velocities"]),
        (lambda p, t: ps.profiles.quintic(p, t), ["positions", "velocities", "accelerations"]),
    ],
)
def test_the_fields_are_those_by_which_the_controller_repeats_the_motion(
    puma: ps.Robot, tmp_path: Path, make: Any, fields: list[str]
) -> None:
    points = np.array([[0.0] * 6, [0.2] * 6, [0.5] * 6, [0.3] * 6])
    move = make(points, [0.0, 1.0, 2.0, 3.5])
    path = ps.write_joint_trajectory(tmp_path / "move.json", move, joint_names=puma.joint_names)
    first = json.loads(path.read_text())["points"][1]
    assert [name for name in ("positions", "velocities", "accelerations", "effort") if first[name]] == fields
    same = ps.read_joint_trajectory(path, puma)
    t = np.linspace(0, 3.5, 211)
    # Times are whole nanoseconds: at 1 rad/s positions differ by half of one.
    assert np.abs(same(t) - move(t)).max() < 1e-9


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_a_motion_of_a_higher_degree_gets_points_between(puma: ps.Robot, tmp_path: Path, tolerance: float) -> None:
    points = np.array([[0.0] * 6, [0.2] * 6, [0.3] * 6, [0.5] * 6])
    for k, move in enumerate((ps.septic(points, [0, 2, 6, 9]), ps.profiles.cycloidal(points, [0, 2, 6, 9]))):
        path = tmp_path / f"{k}.json"
        ps.write_joint_trajectory(path, move, joint_names=puma.joint_names, tolerance=tolerance)
        same = ps.read_joint_trajectory(path, puma)
        t = np.linspace(0, 9, 4001)
        assert np.abs(same(t) - move(t)).max() < 1.001 * tolerance


@pytest.mark.parametrize("late", [-7.0, 1e4, 1.7e9])
def test_a_motion_on_a_late_clock_is_written_as_at_zero(puma: ps.Robot, late: float) -> None:
    """Bug: of a motion that began at 1e4 s the points had the positions and velocities of other points."""
    points = [[0.0] * 6, [0.4] * 6, [0.1] * 6, [0.5] * 6]
    for profile in (ps.profiles.quintic_spline, ps.profiles.cubic_spline, ps.septic):
        move = profile(points, [0.0, 0.7, 1.6, 2.4], joint_names=puma.joint_names)
        torque = ps.compute_motion(puma, move).torque
        given, moved = message_of(move, effort=torque), message_of(move.shifted(late), effort=torque.shifted(late))
        for field in ("nanoseconds", "positions", "velocities", "accelerations"):
            np.testing.assert_array_equal(getattr(moved, field), getattr(given, field))
        # Which side of a step an instant of a late clock is on is lost in its rounding, 2e-7 s in this century.
        np.testing.assert_allclose(moved.effort[1:-1], given.effort[1:-1], atol=1e-4)


def test_what_no_message_says_is_refused(puma: ps.Robot, tmp_path: Path) -> None:
    move = small_move(puma)
    with pytest.raises(ps.InputError, match=r"must end in \.yaml, \.yml, \.json"):
        ps.write_joint_trajectory(tmp_path / "move.txt", move)
    path = ps.write_joint_trajectory(tmp_path / "move.yaml", move)
    with pytest.raises(ps.InputError, match="exists; nothing is overwritten"):
        ps.write_joint_trajectory(path, move)
    nameless = ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0])
    with pytest.raises(ps.InputError, match="0 names for 1 joints"):
        ps.write_joint_trajectory(tmp_path / "b.yaml", nameless)
    powers = [[[0.0], [1.0]], [[0.0], [0.0]], [[1.0], [0.0]]]  # s^2, then rest: the velocity falls from 2 to 0
    bent = ps.Piecewise.from_power([0.0, 1.0, 2.0], powers)
    stepped = ps.Trajectory(position=bent, points=[[0.0], [1.0], [1.0]], times=[0.0, 1.0, 2.0])
    with pytest.raises(ps.InputError, match=r"the velocity steps at t = 1 s"):
        ps.write_joint_trajectory(tmp_path / "c.yaml", stepped, joint_names=["j"])


def test_efforts_are_filled_on_request(puma: ps.Robot, tmp_path: Path) -> None:
    move = small_move(puma)
    motion = ps.compute_motion(puma, move)
    path = ps.write_joint_trajectory(tmp_path / "move.json", move, effort=motion.torque)
    points = json.loads(path.read_text())["points"]
    assert points[-1]["effort"] == pytest.approx(motion.torque(2.0), rel=1e-12)
    [planned] = read_joint_trajectories(path, puma)
    assert planned.message.has("effort").all()


def test_yaml_numbers_are_numbers_for_yaml_1_1_too() -> None:
    """`ros2 topic pub` reads YAML 1.1, in which 1e-05 without a point is a text."""
    numbers = [1e-5, -1e300, 0.1, -0.0, 5e-324]
    text = text_of({"a": numbers}, as_json=False)
    assert text == "a:\n- 1.0e-05\n- -1.0e+300\n- 0.1\n- -0.0\n- 5.0e-324\n"
    assert documents_of(text, "a") == [{"a": numbers}]


@given(st.lists(st.floats(1e-3, 1.0), min_size=1, max_size=5), st.integers(0, 2**32 - 1))
@example([1.0, 0.0010000000185077544], 27704)
def test_reading_back_what_was_written_is_the_same_motion(steps: list[float], seed: int) -> None:
    """Law: message -> trajectory -> message keeps points, times and fields."""
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(steps)]).round(9)
    n = len(times)
    values = rng.uniform(-1, 1, (3, n, 2))
    document = message(values[0], times, velocities=values[1], accelerations=values[2], names=("a", "b"))
    first = joint_trajectory_message(document, [])
    assert first is not None
    again = message_of(interpolated(first, None, np.zeros(2, dtype=bool)), joint_names=("a", "b"))
    assert again.nanoseconds.tolist() == first.nanoseconds.tolist()
    assert np.allclose(again.positions, first.positions, rtol=0, atol=1e-13)
    # A few roundings of a position times T_5''(1) = 200 over the square of half the shortest step, 1 ms: 1.8e-7 each.
    assert np.allclose(again.accelerations, first.accelerations, rtol=0, atol=1e-6)
