"""Tasks for whole jobs: joint moves, lines and arcs in sequence, grips, rests, the way back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.pages import blocks
from helpers.places import PANDA
from helpers.urdf_texts import PLANAR

import puma_septic as ps
from puma_septic.kinematics import singularity_distances
from puma_septic.pictures import assessment_pictures, utilisation_picture
from puma_septic.task import load_task, make_task, parse_task, resolve_cycle, resolve_task
from puma_septic.task._resolved_cycle import together
from puma_septic.validation import Array
from puma_septic.viewer._animation import flags_of
from puma_septic.viewer._page import _motion_data
from puma_septic.viewer._scene import shown

TURNED = [90, 0, -30]
JOB: dict[str, Any] = {
    "name": "job",
    "robot": {"source": "puma560", "parameters": "rtb", "limits": "corke", "tool": "wrist_center"},
    "frame": "shoulder_base",
    "points": [
        {"name": "home", "position": [-0.5, 0.5, 0.3], "rpy_deg": TURNED},
        {"name": "pick", "position": [-0.5, 0.5, 0.0], "rpy_deg": TURNED},
        {"name": "side", "position": [-0.55, 0.4, 0.0], "rpy_deg": TURNED},
        {"name": "far", "position": [-0.3, 0.6, 0.2], "rpy_deg": TURNED},
    ],
    "branch": "right-up-noflip",
    "defaults": {"speed": 0.4, "acceleration": 2.0},
}


def job(*steps: Any, **changes: Any) -> ps.ResolvedCycle:
    return resolve_cycle(make_task({**JOB, "cycle": list(steps), **changes}))


def tool_along(robot: ps.Robot, trajectory: ps.Trajectory, n: int = 2001) -> Array:
    t = np.linspace(trajectory.breaks[0], trajectory.breaks[-1], n)
    return np.asarray(ps.forward_kinematics(robot, trajectory(t))[:, :3, 3])


def off_the_line(places: Array) -> float:
    """How far places are from the straight line between the first and the last, m."""
    way = places - places[0]
    along = way[-1] / np.linalg.norm(way[-1])
    return float(np.linalg.norm(way - np.outer(way @ along, along), axis=1).max())


def test_lifting_and_lowering_are_straight_where_the_septic_swings() -> None:
    """The septic through the same points swings the wrist 13 cm aside while it lifts and 18 cm while it lowers."""
    septic = resolve_task(load_task("paper-turned"))
    robot, trajectory = septic.robot, septic.trajectories[0]
    swings = []
    for first, last in ((0.0, 2.0), (6.0, 9.0)):
        places = ps.forward_kinematics(robot, trajectory(np.linspace(first, last, 4001)))[:, :3, 3]
        swings.append(off_the_line(places))
    # Measured; 0.1 mm is their last digit.
    np.testing.assert_allclose(swings, [0.1325, 0.1774], atol=1e-4)
    straight = resolve_cycle(load_task("paper-straight"))
    assert straight.names[:3] == ("lift", "unload", "place")
    for k in (0, 2, 3, 5):
        assert off_the_line(tool_along(straight.robot, straight.cycle.steps[k].trajectory)) < 1e-9
    assert straight.assess().is_feasible


def test_a_load_is_carried_from_grip_to_release_and_back_is_the_same_way_in_reversed_time() -> None:
    found = job(
        {"to": "pick", "move": "line"},
        {"grip": {"mass": 2.0}},
        {"dwell": 0.5},
        {"to": "side", "duration": 1.0},
        "release",
        {"dwell": 0.25, "brake": True},
        "back",
        payload={"mass": 0.5, "com": [0, 0, 0.1]},
    )
    assert found.names == (
        "home to pick", "rest at pick", "pick to side", "rest at side", "back: pick to side", "back: home to pick"
    )  # fmt: skip
    assert found.stops == ("home", "pick", "pick", "side", "side", "pick", "home")
    masses = [(one.payload or one.robot.payload).mass if isinstance(one, ps.Dwell) else one.robot.payload.mass
              for one in found.cycle.steps]  # fmt: skip
    assert masses == [0.5, 2.5, 2.5, 0.5, 0.5, 0.5]
    assert found.cycle.is_periodic
    there, back = found.cycle.steps[0].trajectory, found.cycle.steps[5].trajectory
    np.testing.assert_allclose(there(0.3), back(back.duration - 0.3), atol=1e-12)


def test_the_whole_cycle_is_one_motion_with_the_torque_of_its_parts() -> None:
    found = job(
        {"grip": {"mass": 2.0}},
        {"to": "pick", "duration": 0.5},
        {"dwell": 1.0},
        "release",
        {"to": "home", "duration": 1.0},
    )
    assessed = found.assess()
    motion, starts = assessed.whole.motion, found.cycle.starts
    for k, start in ((0, starts[0]), (2, starts[2])):
        alone = found.cycle.steps[k]
        np.testing.assert_allclose(motion.torque(start + 0.2), alone.torque(0.2), rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(
            motion.torque_terms.payload(start + 0.2), alone.torque_terms.payload(0.2), rtol=1e-9, atol=1e-9
        )
    q = found.trajectory(1.0)
    held = ps.inverse_dynamics(found.robot.with_payload(ps.Payload(mass=2.0)), q, 0 * q, 0 * q, friction=False)
    np.testing.assert_allclose(motion.torque(1.0), held, atol=1e-9)
    peaks = np.max([one.peak_torque for one in assessed.motions], axis=0)
    assert (assessed.whole.peak_torque >= peaks * (1 - 1e-12)).all()
    np.testing.assert_allclose(assessed.whole.rms_torque, found.cycle.rms_torque, rtol=1e-9)
    assert assessed.motion_names[assessed.order[0]] == "home to pick"
    assert assessed.names[assessed.governing] == "home to pick"
    assert "in 'home to pick'" in assessed.verdict
    table = assessed.to_dataframe()
    assert list(table.index) == list(found.names)
    assert table["payload_mass"].tolist() == [2.0, 2.0, 0.0]


def test_approach_and_retreat_go_straight_along_the_tool() -> None:
    found = job(
        {"to": "side", "retreat": 0.1, "approach": 0.05, "tool_axis": "y", "duration": 1.0},
        {"to": "home", "duration": 1.0},
    )
    assert found.names == (
        "retreat from home",
        "home to side",
        "approach side",
        "side to home",
    )
    assert found.places == ("home", "0.1 m before home", "0.05 m before side", "side")
    for k, length in ((0, 0.1), (2, 0.05)):
        trajectory = found.cycle.steps[k].trajectory
        frames = ps.forward_kinematics(found.robot, trajectory(np.linspace(0, trajectory.duration, 501)))
        assert off_the_line(frames[:, :3, 3]) < 1e-9
        moved = frames[-1, :3, 3] - frames[0, :3, 3]
        np.testing.assert_allclose(moved, (-1 if k == 0 else 1) * length * frames[0, :3, 1], atol=1e-9)
        np.testing.assert_allclose(frames[:, :3, :3], np.broadcast_to(frames[0, :3, :3], (501, 3, 3)), atol=1e-9)


def test_a_zone_rounds_the_corners_of_a_line_without_a_stop() -> None:
    rounded = job({"to": ["pick", "side"], "move": "line", "zone": 0.03}, "back")
    stopping = job({"to": ["pick", "side"], "move": "line"}, "back")
    assert rounded.names == ("home to side", "back: home to side")
    assert stopping.names[:2] == ("home to pick", "pick to side")
    rates = ps.paths.tool_rates(rounded.robot, rounded.cycle.steps[0].trajectory)
    middle = rounded.cycle.steps[0].trajectory.duration / 2
    assert rates.square("speed")(middle)[0] == pytest.approx(0.4**2, abs=1e-9)
    places = tool_along(rounded.robot, rounded.cycle.steps[0].trajectory)
    corner = ps.forward_kinematics(stopping.robot, stopping.cycle.steps[0].trajectory.points[-1])[:3, 3]
    nearest = np.linalg.norm(places - corner, axis=1).min()
    assert 0.001 < nearest < 0.03


def test_an_arc_passes_its_via() -> None:
    found = job({"to": "side", "move": "arc", "via": "pick"}, "back", branch="auto")
    places = tool_along(found.robot, found.cycle.steps[0].trajectory, 20001)
    pick = next(pose for name, pose in zip(("home", "pick"), _poses(found), strict=False) if name == "pick")
    assert np.linalg.norm(places - pick, axis=1).min() < 1e-4
    assert found.cycle.steps[0].trajectory.profile == "arc"


def _poses(found: ps.ResolvedCycle) -> list[Array]:
    shoulder = np.array([0.0, 0.0, 0.67183])  # puma560.urdf, frame shoulder_base
    return [np.array(point.position) + shoulder for point in found.task.points]


def test_joint_points_in_degrees_are_those_in_radians() -> None:
    posture = [10.0, 45.0, -130.0, 5.0, 40.0, 0.0]
    points = [{"name": "a", "joints": np.radians(posture).tolist()}, {"name": "b", "joints_deg": posture}]
    more = [{"to": "b", "duration": 1.0}]
    found = job(*more, points=points, branch="auto")
    np.testing.assert_allclose(found.trajectory(0.0), found.trajectory(1.0), atol=1e-15)
    points[1] = {"name": "b", "joints_deg": [12.0, *posture[1:]]}
    moved = job({"to": "b", "move": "line"}, points=points, branch="auto", repeat=False)
    np.testing.assert_allclose(np.degrees(moved.trajectory(moved.cycle.duration))[0], 12.0, atol=1e-9)


def test_limits_of_the_tool_are_in_the_verdict() -> None:
    step = {"to": "pick", "move": "line"}
    fast = job(step, "back", tool_limits={"speed": 0.25, "source": "hand-guided cell"}).assess()
    assert not fast.is_feasible
    assert fast.worst is not None
    assert (fast.worst.joint, fast.worst.quantity, fast.worst.source) == ("tool", "speed", "hand-guided cell")
    assert fast.worst.demand == pytest.approx(0.4, abs=1e-9)
    assert "tool speed 0.4 m/s" in fast.verdict
    assert "Limits of the tool: speed 0.4000 (160 %!) of 0.25 m/s (hand-guided cell)" in str(fast)
    slow = job({**step, "speed": 0.25}, "back", tool_limits={"speed": 0.25}).assess()
    assert slow.is_feasible


def test_a_task_of_one_motion_has_tool_limits_too() -> None:
    task = make_task({**load_task("paper-turned").document(), "tool_limits": {"speed": 0.5}})
    septic = ps.assess_task(task)[0]
    assert septic.violations[0].joint == "tool"
    assert "checks" not in ps.assess_task(load_task("paper-turned"))[0].to_dict()["tool"]


def test_two_bodies_in_one_hand_are_one() -> None:
    """Weight and inertia of both, about any axis: here about the flange's, by the sums over both."""
    one = ps.Payload(mass=0.5, com=np.array([0.0, 0.02, 0.1]), inertia=np.diag([1e-3, 2e-3, 2e-3]))
    other = ps.Payload(mass=2.0, com=np.array([0.1, 0.0, 0.2]))
    both = together(one, other)

    def about_origin(body: ps.Payload) -> Array:
        c = body.com
        return np.asarray(body.inertia + body.mass * ((c @ c) * np.eye(3) - np.outer(c, c)))

    assert both.mass == 2.5
    np.testing.assert_allclose(both.mass * both.com, one.mass * one.com + other.mass * other.com, atol=1e-15)
    np.testing.assert_allclose(about_origin(both), about_origin(one) + about_origin(other), atol=1e-15)


def test_the_whole_cycle_reads_back_as_a_joint_trajectory(tmp_path: Path) -> None:
    found = job({"to": "pick", "move": "line"}, {"dwell": 0.2}, "back")
    ps.write_joint_trajectory(tmp_path / "cycle.yaml", found.trajectory, joint_names=found.robot.joint_names)
    again = ps.read_joint_trajectory(tmp_path / "cycle.yaml", found.robot)
    t = np.linspace(0, found.cycle.duration, 401)
    np.testing.assert_allclose(again(t), found.trajectory(t), atol=2e-6)  # the tolerance of the writing


FAULTS = [
    (
        [{"to": "pikc", "duration": 1}],
        r"cycle\[0\]\.to: unknown point 'pikc'; valid: home, pick, side, far; did you mean",
    ),
    ([{"to": "pick"}], r"cycle\[0\]: a joint move needs duration, or durations"),
    ([{"to": "pick", "approach": 0.1}], r"cycle\[0\]: a joint move needs duration, or durations"),
    ([{"to": "pick", "duration": 1, "zone": 0.1}], r"cycle\[0\]: zone belongs to a move of kind line, not joint"),
    ([{"to": "pick", "move": "arc"}], r"cycle\[0\]: an arc needs via"),
    ([{"to": "pick", "move": "line", "zone": 0.1}], r"cycle\[0\]: zone: a line to one point has no corner"),
    ([{"to": ["pick", "side"], "duration": 1}], r"cycle\[0\]: duration: 2 points need durations"),
    ([{"to": ["pick", "side"], "durations": [1]}], r"cycle\[0\]: durations: 1 durations for 2 points"),
    ([{"to": "pick", "duration": 1, "durations": [1]}], r"cycle\[0\].*: needs duration or durations, not both"),
    (
        [{"to": ["pick", "side"], "move": "line", "duration": 1}],
        r"cycle\[0\].*: duration: this line stops at its corners, so give speed and acceleration, or round them: zone",
    ),
    ([{"to": "pick", "move": "line", "duration": 1, "speed": 1}], r"cycle\[0\].*: speed: of no effect here; "),
    (
        [{"to": "pick", "move": "spline", "duration": 1}],
        r"cycle\[0\]\.move: expected 'joint', 'line' or 'arc', got 'spline'",
    ),
    ([{"to": "pick", "move": "line", "sped": 1}], r"cycle\[0\]: unknown key 'sped'; .*did you mean 'speed'\?"),
    (["release", {"to": "pick", "duration": 1}], r"cycle\[0\]: release: the tool holds nothing here"),
    ([{"grip": {"mass": 1}}, {"grip": {"mass": 1}}, "back"], r"cycle\[1\]: grip: the tool holds something already"),
    ([{"dwell": 1}], r"cycle: no move; a step is a move with the key to"),
    (["back"], r"cycle\[0\]: back: nothing has been moved yet"),
    (["home"], r"cycle\[0\]: expected 'release' or 'back', got 'home'"),
    ([{"dwell": 0}], r"cycle\[0\]\.dwell: must be greater than 0"),
    ([{"to": "pick", "move": "line", "speed": -1}], r"cycle\[0\]\.speed: must be greater than 0, got -1"),
]


@pytest.mark.parametrize(("steps", "message"), FAULTS)
def test_faults_of_a_cycle(steps: list[Any], message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        make_task({**JOB, "cycle": steps})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"times": [0, 1]}, "times: not beside a cycle; there each move has its duration or speed"),
        ({"dwell": 1.0}, "dwell: not beside a cycle; .* a rest is a step: - dwell: 0.5"),
        ({"defaults": {}}, r"cycle\[0\]: a straight stretch needs speed and acceleration, or the move a duration"),
        ({"points": [{"joints": [0] * 6}, {"name": "pick", "joints": [0] * 6}]}, r"points\[0\]: needs a name, which"),
        ({"points": [{"name": "pick", "joints": [0] * 6}] * 2}, r"points\[1\]: the name 'pick' stands for an earlier"),
        ({"tool_limits": {"source": "x"}}, "tool_limits: needs one of speed, acceleration, jerk and angular_speed"),
    ],
)
def test_what_does_not_go_with_a_cycle(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        make_task({**JOB, "cycle": [{"to": "pick", "move": "line"}, "back"], **changes})


def test_what_a_task_without_a_cycle_needs() -> None:
    with pytest.raises(ps.InputError, match="defaults, repeat: only beside a cycle"):
        make_task({**JOB, "repeat": False})
    with pytest.raises(ps.InputError, match="profiles is missing"):
        make_task({key: value for key, value in JOB.items() if key != "defaults"})


def test_all_faults_of_a_cycle_are_told_with_their_lines() -> None:
    text = """name: x
points:
  - {name: a, joints: [0, 0, 0, 0, 0, 0]}
cycle:
  - {to: b, move: line}
  - release
"""
    with pytest.raises(ps.InputError) as caught:
        parse_task(text, origin="x.yaml")
    lines = str(caught.value).split("\n")
    assert lines[0] == "x.yaml: 3 faults:"
    assert [line[:9] for line in lines[1:]] == ["  line 5:", "  line 5:", "  line 6:"]


def test_a_cycle_that_is_repeated_ends_where_it_begins() -> None:
    step = {"to": "pick", "move": "line"}
    with pytest.raises(ps.InputError, match=r"does not return to its start.*add the way back .*or repeat: false"):
        job(step)
    assert not job(step, repeat=False).cycle.is_periodic


def test_a_line_that_cannot_be_followed_names_its_step() -> None:
    points = [*JOB["points"], {"name": "out", "position": [0.5, -0.5, 0.0], "rpy_deg": TURNED}]
    with pytest.raises(ps.NoSolution, match=r"cycle\[0\] \(home to out\): line, branch 'right-up-noflip': .* at s = "):
        job({"to": "out", "move": "line"}, points=points, repeat=False)


def test_each_command_takes_a_task_or_says_why_not() -> None:
    straight = load_task("paper-straight")
    with pytest.raises(ps.InputError, match=r"a cycle, which assess, size and replay take \(in Python resolve_cycle\)"):
        resolve_task(straight)
    with pytest.raises(
        ps.InputError, match="resolve_cycle takes a task with a cycle; resolve_task takes one with times"
    ):
        resolve_cycle(load_task("paper"))


def test_charts_and_replay_show_the_tools_limit_and_the_distance_to_singular_postures() -> None:
    assessed = job({"to": "pick", "move": "line"}, "back", tool_limits={"speed": 0.25}).assess()
    whole = assessed.whole
    tool = next(one for one in assessment_pictures([whole], ["cycle"]) if one.name == "tool")
    assert [rule.at for rule in tool.panels[3].levels] == [0.25]
    distances = next(one for one in assessment_pictures([whole], ["cycle"]) if one.name == "singularity")
    assert [panel.title for panel in distances.panels] == ["shoulder", "elbow", "wrist"]
    used = utilisation_picture([whole], ["cycle"]).panels[-1]
    assert (used.title, used.rows, used.row_bars(0)[0].text) == ("tool", ("speed",), "160 % !")
    flag = flags_of(whole)[0]
    assert flag.text.startswith("tool speed 0.4 m/s")
    # From 0 to 0.4 m/s at 2 m/s^2 the limit is passed after 0.125 s; the way back is the mirror image.
    np.testing.assert_allclose(flag.spans[0][0], 0.125, atol=1e-9)


def test_the_replay_tells_what_is_carried_and_how_far_singular_postures_are() -> None:
    """Zero of a measure is a singular posture; at rest at the start it is that of the inverse kinematics there."""
    found = job({"to": "pick", "move": "line"}, {"grip": {"mass": 1.0}}, {"dwell": 0.2}, "back")
    data = _motion_data(shown(found.assess().whole, "cycle"), 0)
    assert data["payload"] == "0 to 1 kg"
    assert [one["kind"] for one in data["singular"]] == ["shoulder", "elbow", "wrist"]
    exact = singularity_distances(found.robot, found.trajectory(0.0)[None])[0]
    np.testing.assert_allclose([one["apart"][0] for one in data["singular"]], exact, atol=1e-4)


@pytest.mark.slow  # a page with a replay
def test_the_report_has_the_whole_cycle_first_then_its_motions() -> None:
    page = ps.report_html(job({"to": "pick", "move": "line"}, "back").assess())
    assert page.index("cycle") < page.index("Distance to singular postures")
    assert page.count("the replay of the whole cycle, above") == 2


@pytest.mark.parametrize("page", ["docs/tasks.md", "docs/howto/pallet.md"])
def test_the_job_that_a_page_shows_is_feasible(page: str) -> None:
    shown = next(block.text for block in blocks(page) if block.language == "yaml" and "cycle:" in block.text)
    assert resolve_cycle(parse_task(shown)).assess().is_feasible


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ({}, "give one of speed, acceleration, jerk or angular_speed"),
        ({"speed": 0.0}, "speed = 0 m/s must be greater than 0"),
        ({"angular_speed": -1.0}, "angular_speed = -1 rad/s must be greater than 0"),
    ],
)
def test_limits_of_a_tool_are_positive(limits: dict[str, float], message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.paths.ToolLimits(**limits)


def test_a_branch_in_which_a_line_cannot_be_followed_is_passed_over() -> None:
    """Of the branches that reach all places the one with the least travel may lead a line through a limit."""
    arc = {"to": "side", "move": "arc", "via": "pick"}
    with pytest.raises(ps.NoSolution, match="joint 'joint5'"):
        job(arc, "back")
    assert job(arc, "back", branch="auto").branch.configuration != "right-up-noflip"


def test_a_redundant_arm_does_a_job_too() -> None:
    """Seven joints have no branches: a line begins in the posture that the arm has, and the way back is the same."""
    points = [
        {"name": "home", "joints": [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8]},
        {"name": "pick", "joints": [0.3, 0.1, 0.0, -1.9, 0.0, 2.0, 0.8]},
    ]
    robot = {"source": str(PANDA), "tool": "panda_hand_tcp", "locked": "others"}
    changes = {"robot": robot, "frame": "world", "branch": "auto", "points": points}
    found = job({"to": "pick", "approach": 0.1, "duration": 1.0}, {"grip": {"mass": 0.5}}, "back", **changes)
    assert found.names[:2] == ("home to pick", "approach pick")
    assert found.cycle.is_periodic
    assert off_the_line(tool_along(found.robot, found.cycle.steps[1].trajectory)) < 1e-9


def test_the_textbooks_line_is_a_task_of_four_lines(tmp_path: Path) -> None:
    """An arm with two joints: its points are positions, and the orientation is what it may be.

    From (0, 0.5) to (1, -0.5) in 2 s at a cruise of 1 m/s (Siciliano et al., Robotics, 4.3), on links of 1 m.
    """
    (tmp_path / "planar.urdf").write_text(PLANAR, encoding="utf-8")
    line = {"name": "line", "move": "line", "to": "b", "duration": 2.0}
    task = {
        "name": "textbook",
        "robot": {"source": str(tmp_path / "planar.urdf"), "tool": "tip", "gravity": [0, -9.81, 0]},
        "points": [{"name": "a", "position": [0.0, 0.5, 0.0]}, {"name": "b", "position": [1.0, -0.5, 0.0]}],
        "cycle": [{**line, "profile": {"name": "trapezoidal", "cruise_velocity": 1.0}}],
        "repeat": False,
    }
    found = resolve_cycle(make_task(task))
    t = np.linspace(0, 2, 401)
    places = ps.forward_kinematics(found.robot, found.trajectory(t))[:, :2, 3]
    np.testing.assert_allclose(places[:, 0] + places[:, 1], 0.5, atol=1e-12)
    speed = ps.paths.tool_rates(found.robot, found.trajectory).peak("speed")[0]
    assert speed == pytest.approx(1.0, abs=1e-12)


@pytest.mark.slow  # a page with a replay
def test_the_report_of_a_motion_that_its_tool_governs() -> None:
    """The tool's limits stand among the bars, its speed among the charts that govern; a joint's row has none of them.

    The page looked for each joint in the panel of the tool, and ended with an internal error.
    """
    fast = job({"to": "pick", "move": "line"}, "back", tool_limits={"speed": 0.25}).assess()
    page = ps.report_html(fast)
    assert "tool speed 0.4 m/s" in page
    first_screen = page[: page.index("Limit utilisation")]
    assert "speed of wrist_center" in first_screen
