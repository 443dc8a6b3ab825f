"""``puma-septic check``: verdicts, exit codes, the document, and the trajectory that it mends."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.places import ROOT
from helpers.ros_bags import record, state_message, states, trajectory_message
from helpers.ros_messages import message, small_move
from ruamel.yaml import YAML

import puma_septic as ps
from puma_septic.cli import main
from puma_septic.gate import ALLOWABLE, REASON_CODES
from puma_septic.limits import stretched
from puma_septic.ros import FAULT_CODES

KNOWN = ["--allow", "limit_unknown"]


@pytest.fixture
def good(puma: ps.Robot, tmp_path: Path) -> str:
    return str(ps.write_joint_trajectory(tmp_path / "good.yaml", small_move(puma)))


@pytest.fixture
def fast(puma: ps.Robot, tmp_path: Path) -> str:
    return str(ps.write_joint_trajectory(tmp_path / "fast.json", small_move(puma, 0.4)))


def check(*arguments: str) -> int:
    return main(["check", "--robot", "puma560", *arguments])


def document(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any]]:
    code = check(*arguments, "--format", "json")
    out, err = capsys.readouterr()
    assert err == ""
    return code, json.loads(out)


# ---- the cell


def test_floor_and_speed_of_the_tool_are_held(good: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, plain = document(capsys, good, *KNOWN)
    assert (code, plain["floor"], plain["tool_speed"]) == (0, None, None)
    assert plain["trajectories"][0]["cell_margins"] == []
    code, found = document(capsys, good, *KNOWN, "--floor", "-2", "--tool-speed", "0.001")
    assert (code, found["floor"], found["tool_speed"]) == (1, -2.0, 0.001)
    speed, height = found["trajectories"][0]["cell_margins"]
    assert (speed["joint"], speed["quantity"], speed["limit"]) == ("tool", "speed", 0.001)
    assert speed["source"] == "--tool-speed"
    assert height["quantity"] == "height"
    assert height["margin"] > 0
    (reason,) = [one for one in found["trajectories"][0]["reasons"] if not one["allowed"]]
    assert reason["code"] == "tool_limit"


def test_a_fix_keeps_the_tool_s_speed(good: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    speed = ["--tool-speed", "0.05"]
    slower = str(tmp_path / "slower.yaml")
    assert check(good, *KNOWN, *speed, "--fix", slower) == 1
    assert "tool speed" in capsys.readouterr().out
    assert check(slower, *KNOWN, *speed) == 0


@pytest.mark.parametrize(
    ("option", "told"),
    [
        (["--floor", "nan"], "--floor"),
        (["--tool-speed", "0"], "--tool-speed"),
        (["--tool-speed", "-1"], "--tool-speed"),
    ],
)
def test_rules_that_are_none_are_refused(
    good: str, option: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert check(good, *option) == 2
    assert told in capsys.readouterr().err


# ---- exit codes and verdicts


def test_the_four_verdicts(good: str, fast: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for expected, verdict, arguments in (
        (0, "ok", [good, *KNOWN]),
        (1, "violated", [fast, *KNOWN]),
        (2, "invalid", [str(tmp_path / "none.yaml"), *KNOWN]),
        (3, "undecided", [good]),
        (1, "violated", [fast]),
        (1, "violated", [good, fast, *KNOWN]),
        (2, "invalid", [fast, str(tmp_path / "none.yaml"), good]),
    ):
        code, told = document(capsys, *arguments)
        assert (code, told["verdict"], told["exit_code"]) == (expected, verdict, expected)
        assert check(*arguments) == expected
        assert verdict in capsys.readouterr().out.splitlines()[0]


def test_the_verdict_stands_first_then_reasons_then_margins(fast: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert check(fast, *KNOWN) == 1
    words = " ".join(capsys.readouterr().out.split())
    assert words.startswith(f"{fast}: violated, 3 reasons; the worst: joint1 torque 101.5 N m at t = 0.0878")
    order = ["effort_limit: joint1", "velocity_limit: joint2", "limit_unknown:jerk of joint1, joint2", "Worst margin"]
    places = [words.index(one) for one in order]
    assert places == sorted(places)
    assert "-81.2 % at 0.088 s !" in words


def test_the_document_holds_reasons_margins_and_digests(fast: str, capsys: pytest.CaptureFixture[str]) -> None:
    _, told = document(capsys, fast, "--allow", "limit_unknown:jerk")
    assert told["schema"] == "puma-septic/check/1"
    assert told["allow"] == ["limit_unknown:jerk"]
    [one] = told["trajectories"]
    assert one["sha256"] == hashlib.sha256(Path(fast).read_bytes()).hexdigest()
    assert {part["role"]: part["sha256"] for part in told["inputs"]} == {
        role: hashlib.sha256((ROOT / "urdf" / name).read_bytes()).hexdigest()
        for role, name in (("robot", "puma560.urdf"), ("actuators", "puma560_actuators.toml"))
    }
    first = one["reasons"][0]
    assert (first["code"], first["joint"], first["quantity"], first["unit"]) == (
        "effort_limit", "joint1", "effort", "N m",
    )  # fmt: skip
    assert first["demand"] == pytest.approx(101.5, abs=0.05)
    assert first["limit"] == 56
    assert {reason["allowed"] for reason in one["reasons"] if reason["quantity"] == "jerk"} == {True}
    assert {reason["allowed"] for reason in one["reasons"] if reason["quantity"] == "acceleration"} == {False}
    worst = next(m for m in one["margins"] if (m["joint"], m["quantity"]) == ("joint1", "effort"))
    assert worst["margin"] == pytest.approx(1 - first["demand"] / 56)
    assert len(one["margins"]) == 18  # position, velocity and effort of six joints


def test_a_file_that_is_no_trajectory_has_codes_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bad.json"
    bad = message([[0.0] * 6, [0.1] * 6], [1, 1])
    bad["joint_names"][2] = "elbow"
    path.write_text(json.dumps(bad))
    code, told = document(capsys, str(path))
    assert code == 2
    [one] = told["trajectories"]
    assert [(reason["code"], reason["joint"], reason["time"]) for reason in one["reasons"]] == [
        ("time_order", None, 1.0)
    ]
    assert one["margins"] == []
    assert one["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
    bad["points"][0]["time_from_start"] = 0.0
    path.write_text(json.dumps(bad))
    _, told = document(capsys, str(path))
    reasons = told["trajectories"][0]["reasons"]
    assert [(reason["code"], reason["joint"]) for reason in reasons] == [
        ("unknown_joint", "elbow"),
        ("missing_joint", "joint3"),
    ]


def test_a_robot_or_start_that_cannot_be_read_is_invalid_not_silent(
    good: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for arguments in (
        ["--robot", str(tmp_path / "none.urdf")],
        ["--start", str(tmp_path / "none.yaml")],
        ["--start", "0,0,0"],
        ["--limits", "unheard"],
    ):
        code, told = document(capsys, good, *arguments)
        assert code == 2
        assert told["trajectories"][0]["reasons"][0]["code"] == "setup_invalid"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--allow", "limit_unkown"], "unknown reason to allow 'limit_unkown'"),
        (["--effort"], "--effort goes with --fix"),
        (["--start-tolerance", "-1"], "--start-tolerance = -1 rad must be at least 0"),
    ],
)
def test_arguments_that_are_wrong_end_with_2(
    good: str, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert check(good, *arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert words in err


def test_a_robot_must_be_named(good: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", good]) == 2
    assert "--robot" in capsys.readouterr().err


# ---- the start state


def test_the_start_state_is_a_file_or_numbers(good: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    state = tmp_path / "state.yaml"
    state.write_text(
        "name: [finger, joint6, joint5, joint4, joint3, joint2, joint1]\nposition: [9, .02, 0, 0, 0, 0, 0]\n"
    )
    code, told = document(capsys, good, *KNOWN, "--start", str(state))
    assert code == 1
    reason = told["trajectories"][0]["reasons"][0]
    assert (reason["code"], reason["joint"], reason["limit"]) == ("start_mismatch", "joint6", 0.01)
    assert told["inputs"][-1]["role"] == "start"
    assert document(capsys, good, *KNOWN, "--start", str(state), "--start-tolerance", "0.03")[0] == 0
    assert document(capsys, good, *KNOWN, "--start", "0,0,0,0,0,0.009")[0] == 0
    assert document(capsys, good, *KNOWN, "--start", "-0.5,0,0,0,0,0")[0] == 1


# ---- mending


def test_fix_writes_the_least_stretch_that_holds(
    puma: ps.Robot, fast: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What is written is ok by the same gate, and a thousandth faster it is not; the exit code is that of FILE."""
    path = tmp_path / "fixed.yaml"
    code, told = document(capsys, fast, *KNOWN, "--fix", str(path))
    assert code == 1
    assert told["fix"]["factor"] == pytest.approx(1.60704, abs=1e-5)
    assert told["fix"]["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert told["fix"]["check"]["verdict"] == "ok"
    assert document(capsys, str(path), *KNOWN)[0] == 0
    slower = ps.read_joint_trajectory(path, puma)
    assert slower.duration == pytest.approx(0.4 * told["fix"]["factor"], abs=1e-9)
    assert ps.assess(puma, slower).is_feasible
    assert not ps.assess(puma, stretched(slower, 0.999)).is_feasible
    points = YAML(typ="safe", pure=True).load(path.read_text())["points"]
    assert [point["effort"] for point in points] == [[], []]


def test_fix_fills_efforts_on_request(
    puma: ps.Robot, fast: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "fixed.json"
    assert check(fast, *KNOWN, "--fix", str(path), "--effort") == 1
    assert f"fix: {path}, 1.6070" in " ".join(capsys.readouterr().out.split())
    points = json.loads(path.read_text())["points"]
    torque = ps.compute_motion(puma, ps.read_joint_trajectory(path, puma)).torque
    assert np.allclose([point["effort"] for point in points], torque(torque.breaks[[0, -1]]), rtol=1e-12)
    assert check(str(path), *KNOWN) == 0
    assert "effort fields are filled" in capsys.readouterr().out


def test_fix_leaves_alone_what_holds_and_says_where_nothing_helps(
    good: str, puma: ps.Robot, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    same = tmp_path / "same.yaml"
    code, told = document(capsys, good, *KNOWN, "--fix", str(same))
    assert code == 0
    assert told["fix"]["factor"] == 1
    assert told["fix"]["message"] == "unchanged: no known limit is violated"
    assert same.read_text() == Path(good).read_text()
    far = ps.quintic_segments([[0.0] * 6, [0, 0, 1.5, 0, 0, 0]], [0.0, 1.0], joint_names=puma.joint_names)
    path = ps.write_joint_trajectory(tmp_path / "far.yaml", far)
    code, told = document(capsys, str(path), *KNOWN, "--fix", str(tmp_path / "never.yaml"))
    assert code == 1
    assert told["fix"]["path"] is None
    assert "no stretch of time helps: joint3 position 1.5 rad" in told["fix"]["message"]
    assert not (tmp_path / "never.yaml").exists()


def test_fix_says_which_friction_it_does_not_know(
    fast: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Where gears lose a part of their load the torque is no polynomial of the speed: a verdict, but no stretch."""
    text = (ROOT / "urdf" / "puma560_actuators.toml").read_text()
    path = tmp_path / "loss.toml"
    path.write_text(text.replace("rotor_inertia = 200e-6", "load_share = 0.1\nrotor_inertia = 200e-6", 1))
    arguments = ["--actuators", str(path), "--fix", str(tmp_path / "x.yaml")]
    code, told = document(capsys, fast, *KNOWN, *arguments)
    assert code == 1
    assert told["fix"]["path"] is None
    assert "gears that lose a part of their load" in told["fix"]["message"]


def test_fix_of_several_or_onto_a_file_is_refused(good: str, fast: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert check(good, fast, *KNOWN, "--fix", "x.yaml") == 2
    assert "--fix goes with one trajectory that can be read; there are 2" in capsys.readouterr().err
    assert check(fast, *KNOWN, "--fix", good) == 2
    assert "exists; nothing is overwritten" in capsys.readouterr().err


def test_fix_keeps_the_way_from_the_start_state(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The first point is later than 0: the way there from the start state is stretched with the rest."""
    path, start = tmp_path / "late.json", "0,0,0,0,0,0"
    rest = [[0.0] * 6] * 2
    points = [[0.3, -0.3, 0.3, 0.3, 0.3, 0.3], [0.5, -0.5, 0.5, 0.5, 0.5, 0.5]]
    late = message(points, [0.2, 0.5], velocities=rest, accelerations=rest)
    path.write_text(json.dumps(late))
    fixed = tmp_path / "fixed.json"
    code, told = document(capsys, str(path), *KNOWN, "--start", start, "--fix", str(fixed))
    assert code == 1
    first = json.loads(fixed.read_text())["points"][0]["time_from_start"]
    assert first["sec"] + first["nanosec"] / 1e9 == pytest.approx(0.2 * told["fix"]["factor"], abs=1e-9)
    assert document(capsys, str(fixed), *KNOWN, "--start", start)[0] == 0


# ---- recordings


def test_recordings_of_trajectories_and_of_joint_states(
    puma: ps.Robot, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    move = small_move(puma)
    sent = trajectory_message(move, [0.0, 2.0])
    bag = record(tmp_path / "a", "mcap", {"/t": [(1, sent), (2, sent)], "/joint_states": states(move, 50)})
    code, told = document(capsys, str(bag), *KNOWN)
    assert code == 0
    assert [one["origin"] for one in told["trajectories"]] == [f"{bag}, trajectory 0", f"{bag}, trajectory 1"]
    code, told = document(capsys, str(bag), *KNOWN, "--topic", "/joint_states")
    [one] = told["trajectories"]
    assert one["notes"][0].startswith("joint states, interpolated by a quintic spline")
    torque = next(m for m in one["margins"] if (m["joint"], m["quantity"]) == ("joint2", "effort"))
    assert torque["demand"] == pytest.approx(ps.assess(puma, move).peak_torque[1], rel=1e-4)


def test_noise_of_a_recording_leaves_it_undecided(
    puma: ps.Robot, tmp_path: Path, rng: np.random.Generator, capsys: pytest.CaptureFixture[str]
) -> None:
    move, robot = small_move(puma, 4.0), puma.joint_names
    states = [
        (int(k * 1e7), state_message(robot, move(k / 100) + rng.normal(0, 1e-3, 6), int(k * 1e7) + 10**18))
        for k in range(401)
    ]
    bag = record(tmp_path / "a", "mcap", {"/joint_states": states})
    _, told = document(capsys, str(bag), *KNOWN)
    assert "doubtful" in {reason["code"] for reason in told["trajectories"][0]["reasons"]}
    assert told["verdict"] != "ok"


# ---- what is documented


def test_every_code_is_documented() -> None:
    text = (ROOT / "docs" / "json.md").read_text(encoding="utf-8")
    for code, meaning in {**REASON_CODES, **FAULT_CODES}.items():
        assert f"`{code}`" in text, code
        assert meaning.partition(",")[0].replace("`", "") in text.replace("`", ""), code
    for code in ALLOWABLE:
        row = next(line for line in text.splitlines() if line.startswith(f"| `{code}`"))
        assert row.rstrip().endswith("| yes |"), code


def test_the_pre_commit_hook_is_the_command() -> None:
    [hook] = YAML(typ="safe", pure=True).load((ROOT / ".pre-commit-hooks.yaml").read_text())
    assert (hook["id"], hook["entry"], hook["language"]) == ("puma-septic-check", "puma-septic check", "python")
    assert re.search(hook["files"], "cell/pick.trajectory.yaml")
    assert re.search(hook["files"], "pick.trajectory.json")
    assert not re.search(hook["files"], "task.yaml")
