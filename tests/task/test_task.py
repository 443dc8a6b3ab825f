"""Task files: what they become, and how wrong ones are refused."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.arms import EXAMPLES
from helpers.moves import POINTS
from helpers.six_axis_arms import KR5, arm, standard
from hypothesis import given, settings
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.cli._task_text import branches_text
from puma_septic.kinematics import inverse_kinematics
from puma_septic.report._sections import reason
from puma_septic.task import ResolvedTask, assess_task, load_task, make_task, parse_task, resolve_task, task_names
from puma_septic.task._branches import Posed, branches_through

TURN = 2 * np.pi

SMALL = """
name: small
points:
  - {name: a, joints: [0, 0, 0, 0, 0, 0]}
  - {name: b, joints: [0.5, 0.5, 0, 0, 0, 0]}
times: [0, 1]
profiles: [quintic_segments]
"""


def posed(**changes: Any) -> dict[str, Any]:
    """Two poses 10 cm apart that every arm branch of the PUMA reaches, as a task file's mapping."""
    points = [
        {"name": name, "position": [x, -0.15, 0.6], "rpy_deg": [0, 90, 0]} for name, x in (("a", 0.5), ("b", 0.6))
    ]
    task = {"name": "posed", "points": points, "durations": [1.0], "profiles": ["quintic_segments"]}
    return {**task, **changes}


# ---- the built-in tasks


def test_paper_reproduces_its_table_1() -> None:
    """To half a unit of the printed digits; joint 4 is half a turn, which has two names."""
    difference = resolve_task(load_task("paper")).points - POINTS
    assert np.abs((difference + np.pi) % TURN - np.pi).max() < 5e-5


def test_paper_is_infeasible_because_every_branch_breaks_joint_5_at_take_and_place() -> None:
    resolved = resolve_task(load_task("paper"))
    assert len(resolved.branches) == 8
    assert resolved.broken_in_all_branches == (("joint5", "take"), ("joint5", "place"))
    assert [assessment.is_feasible for assessment in assess_task(resolved)] == [False] * 3


def test_paper_turned_keeps_every_known_limit_with_each_of_its_profiles() -> None:
    resolved = resolve_task(load_task("paper-turned"))
    assessments = assess_task(resolved)
    assert [a.motion.trajectory.profile for a in assessments] == ["septic", "lspb", "quintic_segments"]
    for assessment in assessments:
        assert assessment.is_feasible
        assert {check.quantity for check in assessment.checks} == {"position", "velocity", "effort"}


def test_paper_turned_visits_the_papers_points() -> None:
    """Only the orientation differs: same positions of the wrist centre, same times."""
    paper, turned = (resolve_task(load_task(name)) for name in ("paper", "paper-turned"))
    there = [ps.forward_kinematics(resolved.robot, resolved.points)[:, :3, 3] for resolved in (paper, turned)]
    # The rounding of forward kinematics.
    np.testing.assert_allclose(there[0], there[1], atol=1e-12)
    np.testing.assert_array_equal(paper.times, turned.times)


# ---- poses and branches


def test_poses_are_given_in_the_tasks_frame() -> None:
    """The shoulder stands 0.67183 m above the floor (Corke, Robotics Toolbox, puma560.py: 26.45 inch)."""
    low = [{**point, "position": [point["position"][0], -0.15, 0.6 - 0.67183]} for point in posed()["points"]]
    world = resolve_task(make_task(posed()))
    shoulder = resolve_task(make_task(posed(points=low, frame="shoulder_base")))
    np.testing.assert_allclose(world.points, shoulder.points, atol=1e-9)  # rounding of 0.6 - 0.67183, near a stretch


@pytest.mark.parametrize(
    ("rpy_deg", "quaternion"),
    [
        # Half angles: cos 45 deg = sin 45 deg = 0.7071067811865476.
        ([90, 0, 0], {"w": 0.7071067811865476, "x": 0.7071067811865476, "y": 0, "z": 0}),
        ([0, 90, 0], {"w": 0.7071067811865476, "x": 0, "y": 0.7071067811865476, "z": 0}),
        ([0, 0, 90], {"w": 0.7071067811865476, "x": 0, "y": 0, "z": 0.7071067811865476}),
        # About fixed axes, x first: x goes to y, y to z, z to x, a third of a turn about (1, 1, 1).
        ([90, 0, 90], {"w": 0.5, "x": 0.5, "y": 0.5, "z": 0.5}),
    ],
)
def test_rpy_and_quaternion_are_the_same_rotation(rpy_deg: list[float], quaternion: dict[str, float]) -> None:
    position = {"name": "a", "position": [0.4, 0.1, 0.8]}
    ways = [
        resolve_task(make_task(posed(points=[{**position, **turn}, {**position, **turn}])))
        for turn in ({"rpy_deg": rpy_deg}, {"quaternion": quaternion})
    ]
    np.testing.assert_allclose(ways[0].points, ways[1].points, atol=1e-12)


def test_auto_takes_the_branch_within_limits_that_travels_least() -> None:
    resolved = resolve_task(make_task(posed()))
    fitting = [branch for branch in resolved.branches if branch.is_within_limits]
    assert fitting
    assert resolved.branch.travel == min(branch.travel for branch in fitting)


def test_auto_takes_the_branch_least_beyond_its_limits_where_none_is_within() -> None:
    """The paper's poses: elbow down without flip leaves only joints 2 and 5 outside."""
    document = load_task("paper").document()
    resolved = resolve_task(make_task({**document, "branch": "auto"}))
    assert resolved.branch.configuration == "right-down-noflip"
    assert resolved.branch.excess.sum() == min(branch.excess.sum() for branch in resolved.branches)
    assert not resolved.branch.is_within_limits


def test_joint_points_are_taken_as_they_are() -> None:
    """A whole turn more or less is a different motion of the cables: only poses are free to choose."""
    task = parse_task(SMALL.replace("[0.5, 0.5, 0, 0, 0, 0]", "[0, 0, 0, 0, 0, 6.5]"))
    assert resolve_task(task).points[1].tolist() == [0, 0, 0, 0, 0, 6.5]


@settings(max_examples=25)
@given(st.lists(st.floats(-4.6, 4.6), min_size=2, max_size=5))
@pytest.mark.slow
def test_poses_are_wrapped_the_short_way(angles: list[float]) -> None:
    """Joint 6 turns by up to 266 deg each way, so that the solver's angle at one pose can be a turn away from the
    shortest way; every other choice of turns within limits is tried here."""
    robot = ps.load_robot()
    q = np.tile([0.3, 0.5, -2.5, 0.4, 0.7, 0.0], (len(angles), 1))
    q[:, 5] = angles
    poses = ps.forward_kinematics(robot, q)
    points = [{"position": T[:3, 3].tolist(), "quaternion": _quaternion(T[:3, :3])} for T in poses]
    way = resolve_task(
        make_task(posed(points=points, durations=[1.0] * (len(q) - 1), branch="right-up-noflip"))
    ).points[:, 5]
    low, high = robot.limits.position[5]
    choices = [[a + k * TURN for k in (-1, 0, 1) if low <= a + k * TURN <= high] for a in angles]
    assert np.abs(np.diff(way)).sum() == pytest.approx(_shortest(choices), abs=1e-9)
    assert (low - 1e-9 <= way).all()
    assert (way <= high + 1e-9).all()


@pytest.mark.parametrize("start", [0.3, 20.0, -31.0])
def test_poses_follow_a_joint_over_any_number_of_turns(start: float) -> None:
    """A continuous joint that stands turns away, or goes on turning, once jumped back by whole turns: only one turn
    more or less than the solver's angle was tried."""
    unlimited = np.full((6, 2), np.nan)
    robot = ps.load_robot().with_limits(position=unlimited)
    angles = start + 2.0 * np.arange(12)
    q = np.tile([0.3, 0.5, -2.5, 0.4, 0.7, 0.0], (len(angles), 1))
    q[:, 5] = angles
    waypoints = [q[0], *(_posed(robot, row) for row in q[1:-1]), q[-1]]
    ways = branches_through(robot, waypoints)
    assert min(np.abs(way.q - q).max() for way in ways) < 1e-9


def test_a_limited_joint_of_several_turns_turns_back_in_time() -> None:
    """With a range of three turns the way on is blocked at the last pose: the whole way is chosen with it in view."""
    limits = ps.load_robot().limits.position.copy()
    limits[5] = [-9.5, 9.5]
    robot = ps.load_robot().with_limits(position=limits)
    angles = np.array([0.0, 3.0, 6.0, 9.0, 12.0, 15.0])
    q = np.tile([0.3, 0.5, -2.5, 0.4, 0.7, 0.0], (len(angles), 1))
    q[:, 5] = angles
    way = min(branches_through(robot, [q[0], *(_posed(robot, row) for row in q[1:])]), key=_away_from(q)).q[:, 5]
    choices = [[0.0], *([a + k * TURN for k in range(-5, 5) if abs(a + k * TURN) <= 9.5] for a in angles[1:])]
    assert np.abs(way).max() <= 9.5
    assert np.abs(np.diff(way)).sum() == pytest.approx(_shortest(choices), abs=1e-9)


def _away_from(q: np.ndarray) -> Callable[[Any], float]:
    return lambda way: float(np.abs(way.q[:, :5] - q[:, :5]).max())


def _posed(robot: ps.Robot, q: np.ndarray) -> Posed:
    pose = ps.forward_kinematics(robot, q)
    return Posed(T_world_tool=pose, solutions=inverse_kinematics(robot, pose))


def _shortest(choices: list[list[float]]) -> float:
    """Least travel over all combinations."""
    ways = [(0.0, a) for a in choices[0]]
    for options in choices[1:]:
        ways = [(travel + abs(b - a), b) for travel, a in ways for b in options]
    return min(travel for travel, _ in ways)


def _quaternion(R: np.ndarray[Any, Any]) -> dict[str, float]:
    """Of a rotation matrix; the largest of the four roots first (Shepperd 1978)."""
    t = np.array([1 + R.trace(), *(1 + 2 * R.diagonal() - R.trace())])
    k = int(t.argmax())
    skew = [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    full = np.array([
        [t[0], *skew],
        [skew[0], t[1], R[0, 1] + R[1, 0], R[0, 2] + R[2, 0]],
        [skew[1], R[0, 1] + R[1, 0], t[2], R[1, 2] + R[2, 1]],
        [skew[2], R[0, 2] + R[2, 0], R[1, 2] + R[2, 1], t[3]],
    ])  # fmt: skip
    values = full[k] / np.sqrt(t[k]) / 2
    return dict(zip("wxyz", values.tolist(), strict=True))


def test_another_arm_follows_the_solution_nearest_to_the_point_before(tmp_path: Path) -> None:
    """Three revolute joints in a plane and a wrist: no named branches, two elbows."""
    (tmp_path / "arm.urdf").write_text(_planar_arm())
    q = np.array([[0.3, 0.8, 0.2], [0.5, 0.9, 0.1], [0.7, 1.0, 0.0]])
    robot = ps.load_robot(tmp_path / "arm.urdf", tool="tool")
    points = [
        {"position": T[:3, 3].tolist(), "rpy_deg": [0, 0, float(np.rad2deg(sum(row)))]}
        for T, row in zip(ps.forward_kinematics(robot, q), q, strict=True)
    ]
    path = tmp_path / "task.yaml"
    path.write_text(
        f"name: planar\nrobot: {{source: arm.urdf, tool: tool}}\npoints: {points}\n"
        "durations: [1, 1]\nprofiles: [quintic_segments]\n"
    )
    resolved = resolve_task(load_task(path))
    assert len(resolved.branches) == 2
    ways = [branch.q for branch in resolved.branches]
    # The solver's residual is at most 1e-12; posture and its derivative are of order one.
    assert min(np.abs(way - q).max() for way in ways) < 1e-9
    # The other elbow bends the other way at every point.
    assert sorted(np.sign(way[:, 1]).sum() for way in ways) == [-3, 3]


def test_ways_that_were_merely_found_are_not_called_all(tmp_path: Path) -> None:
    """ "all N branches ... break, so no profile can be feasible" was said of what 32 starts had happened to find."""
    (tmp_path / "arm.urdf").write_text(_planar_arm())
    task = {
        "name": "planar",
        "robot": {"source": str(tmp_path / "arm.urdf"), "tool": "tool"},
        "points": [{"name": "there", "position": [0.5, 0.4, 0], "rpy_deg": [0, 0, 90]}, {"joints": [0, 0.1, 0]}],
        "durations": [1],
        "profiles": ["quintic_segments"],
        "limits": {"position": [[-3, 3], [-0.1, 0.1], [-3, 3]]},
    }
    resolved = resolve_task(make_task(task))
    assert not resolved.is_complete
    assert resolved.broken_in_all_branches == (("j1", "there"),)
    assert re.fullmatch(r"2 solutions found from \d+ starts", resolved.extent)
    said = (
        "found through these poses violates the position limit of j1 at 'there'; there may be others (2 solutions found"
    )
    assert said in " ".join(branches_text(resolved).split())
    assert "Every way found (2 solutions found from" in reason(resolved)
    assert "no profile" not in branches_text(resolved) + reason(resolved)


# ---- other arms with a closed form, and with fewer axes


def _ur5(q: np.ndarray[Any, Any], **changes: Any) -> ResolvedTask:
    """A task of a UR5 through the poses of these joint positions."""
    robot = ps.load_robot(EXAMPLES["ur5"])
    points = [
        {"position": T[:3, 3].tolist(), "quaternion": _quaternion(T[:3, :3])} for T in ps.forward_kinematics(robot, q)
    ]
    task = {
        "name": "ur5",
        "robot": {"source": str(EXAMPLES["ur5"])},
        "points": points,
        "durations": [1.0] * (len(q) - 1),
        "profiles": ["quintic_segments"],
    }
    return resolve_task(make_task({**task, **changes}))


# Elbow up and low in front; the elbow down is below the table.
_LOW = np.array(
    [[0.2, -1.0, 1.7, -2.2, -1.5, 0.1], [0.5, -1.1, 1.8, -2.3, -1.4, 0.3], [0.8, -1.0, 1.7, -2.2, -1.5, 0.0]]
)


def test_a_named_branch_is_kept_by_any_arm_with_a_closed_form() -> None:
    """A UR5's ways were numbered, and the nearest solution was taken from pose to pose."""
    resolved = _ur5(_LOW)
    assert resolved.is_complete
    assert resolved.extent == "all 8 branches"
    names = [branch.configuration for branch in resolved.branches]
    own = min(resolved.branches, key=_away_from(_LOW))
    np.testing.assert_allclose((own.q - _LOW + np.pi) % (2 * np.pi), np.pi, rtol=0, atol=1e-9)
    again = _ur5(_LOW, branch=own.configuration)
    assert again.branch.configuration == own.configuration
    with pytest.raises(ps.InputError, match=f"branch: unknown branch 'lefty'; valid: '{names[0]}', "):
        _ur5(_LOW, branch="lefty")


def test_a_branch_below_the_floor_comes_last() -> None:
    """The branch of least travel put the elbow into the table, without a word."""
    below = min((branch for branch in _ur5(_LOW).branches), key=lambda branch: branch.lowest.height.min())
    assert below.lowest.height.min() < -0.1
    plain = _ur5(_LOW, branch=below.configuration)
    said = r"At 'points\[\d\]' \w+ is 0\.\d+ m below its base \(floor in the task ranks such branches last\)\."
    assert re.fullmatch(said, plain.lowest)
    floor = float(np.sort([branch.lowest.height.min() for branch in plain.branches])[-2])
    chosen = _ur5(_LOW, floor=floor)
    assert not chosen.lowest
    assert chosen.branch.depth(floor) == 0.0
    fitting = [branch for branch in chosen.branches if branch.depth(floor) == 0.0]
    assert len(fitting) < len(chosen.branches)
    assert chosen.branch.travel == min(branch.travel for branch in fitting)
    assert _ur5(_LOW, floor=1.0).lowest.endswith("below the floor at 1 m; so it is in every other branch.")


def test_an_arm_of_three_joints_is_given_positions(tmp_path: Path) -> None:
    """An ordinary pose had no answer for four and five axes, and nothing said what to give instead."""
    robot = arm(tmp_path, "three", [*standard(KR5)[:3], ([0.62, 0, 0], [0, 0, 0])])
    q = np.array([[0.3, 0.8, 0.7], [0.5, 0.9, 0.9], [0.7, 1.0, 0.6]])
    task = {
        "name": "three",
        "robot": {"source": str(tmp_path / "three.urdf"), "tool": "tool"},
        "points": [{"position": T[:3, 3].tolist()} for T in ps.forward_kinematics(robot, q)],
        "durations": [1, 1],
        "profiles": ["quintic_segments"],
    }
    resolved = resolve_task(make_task(task))
    assert min(float(np.abs(branch.q - q).max()) for branch in resolved.branches) < 1e-8
    task["points"] = [{"position": [0.9, 0, 0.5], "axis": [1, 0, 0]}] * 3
    with pytest.raises(ps.NoSolution, match=r"points\[0\]: .*3 joints cannot meet 5 conditions but by chance"):
        resolve_task(make_task(task))


def test_an_arm_of_six_joints_needs_an_orientation() -> None:
    """A forgotten orientation must not be left to chance."""
    with pytest.raises(
        ps.InputError, match=r"points\[0\]: needs rpy_deg or quaternion: 6 joints carry the tool, and which"
    ):
        resolve_task(make_task(posed(points=[{"position": [0.5, 0, 0.5]}], durations=[])))
    with pytest.raises(ps.InputError, match=r"how far the tool is turned about its axis would be left to chance"):
        resolve_task(make_task(posed(points=[{"position": [0.5, 0, 0.5], "axis": [0, 0, -1]}], durations=[])))


def _planar_arm() -> str:
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    links = "".join(f'<link name="{name}">{body}</link>' for name in ("l1", "l2", "tool"))
    joints = "".join(
        f'<joint name="j{k}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{x} 0 0" rpy="0 0 0"/><axis xyz="0 0 1"/>'
        '<limit lower="-3" upper="3" effort="100" velocity="3"/></joint>'
        for k, (parent, child, x) in enumerate((("base", "l1", 0), ("l1", "l2", 0.5), ("l2", "tool", 0.4)))
    )
    return f'<robot name="planar"><link name="base"/>{links}{joints}</robot>'


# ---- what a file may say


def test_every_section_arrives_at_the_robot() -> None:
    task = make_task(
        posed(
            robot={"parameters": "akb", "limits": "akb", "tool": "wrist_center", "gravity": [0, 0, 9.81]},
            payload={"mass": 2.5, "com": [0, 0, 0.1]},
            wrench={"force": [1, 2, 3], "axes": "world"},
            limits={"velocity": 2.0, "jerk": [1, 2, 3, 4, 5, 6]},
            dwell=3,
        )
    )
    resolved = resolve_task(task)
    robot = resolved.robot
    assert robot.tool == "wrist_center"
    assert robot.model.gravity.linear[2] == 9.81
    assert robot.payload is not None
    assert robot.payload.mass == 2.5
    assert robot.wrench is not None
    assert robot.wrench.axes == "world"
    assert robot.limits.velocity.tolist() == [2.0] * 6
    assert robot.limits.jerk.tolist() == [1, 2, 3, 4, 5, 6]
    # Armstrong, Khatib, Burdick 1986, table 7.
    assert robot.limits.effort[0] == 97.6
    assert assess_task(resolved)[0].dwell == 3.0


def test_yaml_1_2_reads_powers_of_ten_as_numbers_and_yes_as_text() -> None:
    """YAML 1.1, which many parsers still speak, has it the other way round."""
    text = SMALL.replace("times: [0, 1]", "times: [0, 1e1]").replace("name: small", "name: yes")
    task = parse_task(text)
    assert task.times == (0.0, 10.0)
    assert task.name == "yes"


def test_durations_are_times() -> None:
    by_times = resolve_task(parse_task(SMALL.replace("times: [0, 1]", "times: [0, 2.5]")))
    by_durations = resolve_task(parse_task(SMALL.replace("times: [0, 1]", "durations: [2.5]")))
    assert by_times.times.tolist() == by_durations.times.tolist()


def test_a_speed_limit_sets_lspbs_own_durations() -> None:
    profiles = "profiles: [{name: lspb, blend_time: 0.5, max_velocity: 0.25}]"
    task = parse_task(SMALL.replace("profiles: [quintic_segments]", profiles))
    # mstraj: half a blend and the time at full speed, 0.25 + 0.5 / 0.25.
    assert resolve_task(task).trajectories[0].duration == pytest.approx(2.25, rel=1e-12)


def test_paths_are_relative_to_the_file(tmp_path: Path) -> None:
    task = make_task(posed(robot={"source": "robots/a.urdf", "actuators": "a.toml"}), folder=tmp_path)
    assert task.robot.source == str(tmp_path / "robots/a.urdf")
    assert task.robot.actuators == str(tmp_path / "a.toml")


def test_a_document_is_the_task_again() -> None:
    for name in task_names():
        task = load_task(name)
        again = make_task(task.document())
        assert again.document() == task.document()
        if task.cycle:
            continue
        np.testing.assert_array_equal(resolve_task(again).points, resolve_task(task).points)


def test_names_survive_verbatim() -> None:
    task = parse_task(SMALL.replace("name: small", "name: <script>alert(1)</script> Größe"))
    assert task.name == "<script>alert(1)</script> Größe"


# ---- what is refused


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("points: [", r"f\.yaml, line 1, column 10: not valid YAML: "),
        ("name: a\nname: b", r"f\.yaml, line 2, column 1: not valid YAML: found duplicate key \"name\""),
        ("a: &x [1]\nb: *x", r"f\.yaml, line 1, column 4: anchors and aliases"),
        ("a: *x", r"f\.yaml, line 1, column 4: anchors and aliases"),
        ("a: " + "[" * 40 + "]" * 40, r"nested more than 16 levels deep"),
        ("a: " + "[" * 20_000, r"nested more than 16 levels deep"),
        ("a: 2001-99-99", r"f\.yaml: not valid YAML: "),
        ("a: " + "9" * 5000, r"f\.yaml: not valid YAML: "),
        ("? [1, 2]\n: 3", r"unknown key \(1, 2\)"),
        ("a: 1\n---\nb: 2", r"not valid YAML: "),
        ("!!python/object:os.system x", r"not valid YAML: "),
        ("a: \x07", r"not valid YAML: "),
        ("", r"f\.yaml: expected a mapping with keys among: name, description, robot, .*; got None"),
        ("just words", r"expected a mapping .*; got 'just words'"),
    ],
)
def test_not_a_task_file(text: str, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        parse_task(text, origin="f.yaml")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("name: small", "nam: small", "unknown key 'nam'; valid: name, description, robot, frame, points, branch"),
        ("name: small", "name: 5", "name: expected text, got 5"),
        ("name: small", 'name: "a\\e[2Jb"', "name: .* must be one line without control characters"),
        ("name: small\n", "\n", "name is missing"),
        (
            "name: a, joints",
            "name: a, joint",
            r"points\[0\]: unknown key 'joint'; valid: name, joints, joints_deg, position",
        ),
        ("[0.5, 0.5", "[.nan, 0.5", r"points\[1\].joints\[0\]: expected a finite number, got nan"),
        ("[0.5, 0.5", "[.inf, 0.5", r"points\[1\].joints\[0\]: expected a finite number, got inf"),
        ("[0.5, 0.5", "[yes, 0.5", r"points\[1\].joints\[0\]: expected a number, got 'yes'"),
        ("[0.5, 0.5", "[true, 0.5", r"points\[1\].joints\[0\]: expected a number, got True"),
        ("[0.5, 0.5", "['0.5', 0.5", r"points\[1\].joints\[0\]: expected a number, got '0.5'"),
        ("[0.5, 0.5", "[1e400, 0.5", r"points\[1\].joints\[0\]: expected a finite number, got inf"),
        ("[0.5, 0.5, 0, 0, 0, 0]", "5", r"points\[1\].joints: expected a list, got 5"),
        (
            "joints: [0.5, 0.5, 0, 0, 0, 0]",
            "position: [1, 2]",
            r"points\[1\].position: .*at least 3 entries.*got \[1, 2",
        ),
        (
            "joints: [0.5, 0.5, 0, 0, 0, 0]",
            "position: [1, 2, 3], rpy_deg: [0, 0, 0], axis: [0, 0, 1]",
            r"points\[1\]: needs either joints .*or position with one of rpy_deg, quaternion and axis \(or alone\); gi",
        ),
        (
            "joints: [0.5, 0.5, 0, 0, 0, 0]",
            "axis: [0, 0, 1]",
            r"points\[1\]: needs either joints .*or position with one",
        ),
        (
            "joints: [0.5, 0.5, 0, 0, 0, 0]",
            "position: [1, 2, 3], axis: [0, 0, 0]",
            r"points\[1\]\.axis: 0 0 0 is no direction",
        ),
        ("times:", "floor: low\ntimes:", "floor: expected a number, got 'low'"),
        (
            "}\n  - {name: b",
            ", position: [0, 0, 0]}\n  - {name: b",
            r"points\[0\]: needs either .*given: name, joints, pos",
        ),
        (
            "joints: [0.5, 0.5, 0, 0, 0, 0]",
            "position: [0, 0, 0], quaternion: {w: 1, x: 1, y: 0, z: 0}",
            r"points\[1\].quaternion: its norm is 1.41421; a rotation's is 1",
        ),
        ("  - {name: b, joints: [0.5, 0.5, 0, 0, 0, 0]}\n", "", "times: 2 times for 1 points"),
        ("times: [0, 1]", "times: [0, 0]", r"times: must increase strictly, but times\[0\] = 0 s is followed by 0 s"),
        ("times: [0, 1]", "times: [1, 2]", "times: must begin at 0 s, not at 1 s"),
        ("times: [0, 1]", "times: [0, 1, 2]", "times: 3 times for 2 points; one for each is needed"),
        ("times: [0, 1]", "durations: [0]", r"durations\[0\]: .*greater than 0, got 0"),
        ("times: [0, 1]", "durations: [1, 1]", "durations: 2 durations for 2 points; one fewer than points"),
        ("times: [0, 1]\n", "", "needs either times or durations; neither is given"),
        ("times: [0, 1]", "times: [0, 1]\ndurations: [1]", "needs either times or durations; both are given"),
        ("[quintic_segments]", "[]", "profiles: .*at least 1 entries"),
        ("[quintic_segments]", "[spline]", r"profiles\[0\]: unknown profile 'spline'; valid: .*lspb.*septic"),
        ("[quintic_segments]", "[3]", r"profiles\[0\]: expected a profile's name, or a mapping .*got 3"),
        ("[quintic_segments]", "[lspb]", r"profiles\[0\]: profile 'lspb' needs the option 'blend_time'"),
        (
            "[quintic_segments]",
            "[{name: lspb, blendtime: 1}]",
            r"profiles\[0\]: unknown option 'blendtime' of profile 'lspb'; valid: max_velocity, blend_time",
        ),
        ("times:", "dwell: -1\ntimes:", "dwell: .*at least 0, got -1"),
        ("times:", "payload: {mass: -1}\ntimes:", r"payload\.mass: .*at least 0, got -1"),
        ("times:", "payload: {com: [0, 0, 0]}\ntimes:", r"payload\.mass is missing"),
        ("times:", "limits: {velocity: fast}\ntimes:", "limits.velocity: expected a number, got 'fast'"),
        ("times:", "limits: {velocity: [1, fast]}\ntimes:", r"limits.velocity\[1\]: expected a number, got 'fast'"),
        ("times:", "limits: {speed: 1}\ntimes:", "limits: unknown key 'speed'; valid: position, velocity"),
        ("times:", "robot: {sorce: x}\ntimes:", "robot: unknown key 'sorce'; valid: source, parameters, limits"),
        ("times:", "wrench: {axes: base}\ntimes:", r"wrench\.axes: .*'tool' or 'world', got 'base'"),
        ("times:", "frame: 7\ntimes:", "frame: expected text, got 7"),
    ],
)
def test_wrong_content_is_named_with_its_field(old: str, new: str, message: str) -> None:
    assert old in SMALL
    with pytest.raises(ps.InputError, match=rf"(?s)^f\.yaml(, line \d+|: \d faults:\n  line \d+): .*{message}"):
        parse_task(SMALL.replace(old, new), origin="f.yaml")


def test_all_faults_are_told_at_once_with_their_lines() -> None:
    """A person mends a file once, not fault by fault: of several the first alone used to be told, and how many more.

    An unknown key no longer hides what is wrong beside it.
    """
    text = (
        SMALL.replace("name: small", "name: 5\ncolour: red")
        .replace("[0.5, 0.5", "[0.5, x")
        .replace("b, joints", "b, joint")
    )
    with pytest.raises(ps.InputError) as caught:
        parse_task(text.replace("times: [0, 1]", "times: [0, 0]"), origin="f.yaml")
    first, *lines = str(caught.value).split("\n")
    assert first == "f.yaml: 4 faults:"
    assert [re.match(r"  line (\d+): ", line)[1] for line in lines] == ["2", "3", "6", "7"]
    assert lines[1].startswith("  line 3: unknown key 'colour'; valid: name")
    assert lines[2].endswith("did you mean 'joints'?")
    with pytest.raises(
        ps.InputError, match=r"^task: 2 faults:\n  name: expected text, got 5\n  dwell: expected a number"
    ):
        make_task({**parse_task(SMALL).document(), "name": 5, "dwell": "x"})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"robot": {"source": "puma"}}, "posed.yaml: robot: unknown robot 'puma'; valid: 'puma560'"),
        ({"robot": {"limits": "fanuc"}}, "posed.yaml: robot: unknown limits .*'fanuc'; valid: 'corke'"),
        ({"robot": {"tool": "hand"}}, "posed.yaml: robot: unknown tool frame 'hand'; valid: .*'flange'"),
        ({"robot": {"locked": {"elbow": 0.0}}}, "posed.yaml: robot: .*'elbow'.*joint1"),
        ({"frame": "table"}, "posed.yaml: frame: unknown frame 'table'; valid: 'world', .*'shoulder_base'"),
        (
            {"frame": "flange"},
            "posed.yaml: frame: 'flange' moves with the arm; poses can be given in: 'world'",
        ),
        ({"branch": "ldf"}, "posed.yaml: branch: unknown branch 'ldf'; valid: 'right-up-noflip', .*, 'auto'"),
        (
            {"profiles": ["septic"]},
            r"posed.yaml: profiles\[0\] \(septic\): septic needs exactly 4 points, got 2",
        ),
        (
            {"profiles": [{"name": "lspb", "blend_time": 5}]},
            r"posed.yaml: profiles\[0\] \(lspb\): blend_time = 5 s is longer than segment 1",
        ),
        (
            {"profiles": [{"name": "lspb", "blend_time": "long"}]},
            r"posed.yaml: profiles\[0\] \(lspb\): blend_time: expected a number in s, got 'long'",
        ),
        ({"limits": {"velocity": [1.0, 2.0]}}, r"posed.yaml: limits: velocity: shape \(2,\) is not \(6,\)"),
        (
            {"limits": {"position": [[1.0, -1.0]] * 6}},
            "posed.yaml: limits: .*lower bound 1 is not below upper -1",
        ),
        (
            {"payload": {"mass": 1.0, "inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 9]]}},
            "posed.yaml: payload: inertia: principal moments",
        ),
        (
            {"points": [{"joints": [0.0] * 5}, {"joints": [0.0] * 6}]},
            r"posed.yaml: points\[0\]: joints: 5 numbers for 6 joints: joint1, .*by name",
        ),
    ],
)
def test_what_does_not_fit_the_robot_is_named_with_its_field(changes: dict[str, Any], message: str) -> None:
    task = make_task(posed(**changes), origin="posed.yaml")
    with pytest.raises(ps.InputError, match=message):
        resolve_task(task)


def test_a_pose_out_of_reach_names_its_point() -> None:
    points = posed()["points"]
    points[1]["position"] = [5.0, 0.0, 0.0]
    task = make_task(posed(points=points), origin="posed.yaml")
    with pytest.raises(ps.NoSolution, match=r"posed\.yaml: points\[1\] 'b': .*") as caught:
        resolve_task(task)
    assert caught.value.residual > 1.0
    assert caught.value.q.shape == (6,)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda _: None, "this task file does not exist"),
        (lambda path: path.mkdir(), "this task file is not a file"),
        (lambda path: path.write_bytes(b"name: \xff"), "not UTF-8 text: invalid start byte at byte 6"),
        (lambda path: path.write_text("#" * 64_001), "larger than the 64,000 bytes"),
    ],
)
def test_a_file_that_cannot_be_read(tmp_path: Path, make: Callable[[Path], object], message: str) -> None:
    path = tmp_path / "t.yaml"
    make(path)
    with pytest.raises(ps.InputError, match=message):
        load_task(path)


def test_an_unknown_built_in_task_lists_the_known_ones() -> None:
    valid = "'paper', 'paper-straight', 'paper-turned', 'williams', or the path"
    with pytest.raises(ps.InputError, match=f"unknown task 'papre'; valid: .*{valid}"):
        load_task("papre")


def test_a_singular_pose_is_answered() -> None:
    """Arm stretched: the wrist's branches meet at the elbow, and every one of them is an answer."""
    robot = ps.load_robot()
    # The elbow is straight at q3 = -atan2(d4, a3) = -87.308 deg (puma560.urdf's lengths 0.4318, 0.0203 m).
    q = [0.2, 0.3, -float(np.arctan2(0.4318, 0.0203)), 0.4, 0.5, 0.6]
    T = ps.forward_kinematics(robot, q)
    assert any("elbow" in names for names in inverse_kinematics(robot, T).singular)
    point = {"position": T[:3, 3].tolist(), "quaternion": _quaternion(T[:3, :3])}
    resolved = resolve_task(make_task(posed(points=[point, point])))
    there = ps.forward_kinematics(resolved.robot, resolved.points)
    # Next to the singularity an error of 1e-16 in the pose is one of 1e-8 in q, and of 1e-16 in the pose again.
    np.testing.assert_allclose(there, [T, T], atol=1e-9)


def test_a_name_is_no_task() -> None:
    with pytest.raises(ps.InputError, match="expected a task from load_task, got 'paper'"):
        ps.assess_task("paper")  # type: ignore[arg-type]
