"""The command line: what it prints, what it writes, how it ends."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from helpers.arms import EXAMPLES
from helpers.six_axis_arms import KR5, arm, standard

import puma_septic as ps
from puma_septic.cli import COMMANDS, _assess, _assess_answer, main
from puma_septic.cli._parser import parse
from puma_septic.cli._task_text import branches_text
from puma_septic.task import load_task, make_task, resolve_task

FIGURES = (
    "utilisation", "torque", "torque-split-quintic_segments", "torque-speed", "tool", "singularity", "position",
    "velocity", "acceleration", "jerk",
)  # fmt: skip
COMMAND = [sys.executable, "-m", "puma_septic.cli"]

JOINTS = """
name: {name}
points:
  - {{name: a, joints: [0, 0.5, -2.5, 0, 0.7, 0]}}
  - {{name: b, joints: [0.3, 0.8, -2.5, 0, 0.7, 0]}}
times: [0, 1.5]
profiles: [quintic_segments]
"""

FAR = "position: [9, 0, 0], rpy_deg: [0, 0, 0]"


@pytest.fixture
def joints(tmp_path: Path) -> str:
    """A small feasible task of one profile."""
    path = tmp_path / "task.yaml"
    path.write_text(JOINTS.format(name="small"))
    return str(path)


# ---- assess


def test_an_answer_is_short_unless_more_is_asked_for(
    joints: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The default answers on one screen; -v has tables and each remark once, -vv all of each profile."""

    def lines(*options: str) -> list[str]:
        main(["assess", *options])
        return capsys.readouterr().out.splitlines()

    short, tables, everything = lines("paper"), lines("paper", "-v"), lines("paper", "-vv")
    assert 15 <= len(short) <= 25
    assert short[-1] == "More: -v shows 5 remarks and the tables of the joints, -vv all."
    assert len(short) < len(tables) < len(everything)
    static = "static friction may carry any torque"
    remark = "  link 'link1': mass 0 with an inertia, used as it is"
    assert (short.count(remark), tables.count(remark), everything.count(remark)) == (0, 1, 3)
    assert not any(static in line for line in short)
    assert lines("--verbose", joints, "--no-png", "--out", str(tmp_path / "out"))[-1] == (
        f"Report: {tmp_path / 'out' / 'report.html'}"
    )


def test_assess_shows_the_papers_task_and_why_it_is_infeasible(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assess", "-vv"]) == 1
    out, err = capsys.readouterr()
    assert err == ""
    assert "all 8 branches of the inverse kinematics violate the position limit of joint5 at 'take'" in out
    words = " ".join(out.split())
    for profile in ("septic", "lspb", "quintic_segments"):
        assert f"{profile} infeasible joint5 position 114 %" in words
        assert f"puma560, {profile}, 9 s: infeasible" in words
    turned = words.partition("Compare: paper-turned")[2]
    for profile in ("septic", "lspb", "quintic_segments"):
        assert f"{profile} feasible" in turned


def test_the_reason_is_computed() -> None:
    """With joint 5 free to turn further, other joints are what the branches break."""
    wide = ps.load_robot().limits.position.copy()
    wide[4] = -3, 3
    document = {**load_task("paper").document(), "limits": {"position": wide.tolist()}}
    text = " ".join(branches_text(resolve_task(make_task(document))).split())
    assert "joint5" not in text
    assert "Branches that keep the position limits at all points: right-up-noflip, left-up-flip." in text


def test_text_keeps_to_100_columns(capsys: pytest.CaptureFixture[str]) -> None:
    main(["assess"])
    main(["ik"])
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 100


def test_assess_of_a_feasible_task_is_0(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assess", "paper-turned", "--profile", "septic"]) == 0
    out = capsys.readouterr().out
    assert "feasible" in out
    assert "lspb" not in out


def test_margin_decides_the_exit_code(joints: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assess", joints, "--margin", "0.1"]) == 0
    assert "quintic_segments: every known limit is kept with 10 % to spare" in capsys.readouterr().out
    assert main(["assess", joints, "--margin", "0.9"]) == 1
    assert "with 90 % to spare" in capsys.readouterr().out


def test_options_replace_parts_of_the_task(joints: str, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--payload", "2.5", "--dwell", "3", "--limits", "akb", "--parameters", "akb", "--tool", "wrist_center"]
    main(["assess", joints, "--format", "json", *options])
    task = json.loads(capsys.readouterr().out)["tasks"][0]
    assert task["task"]["payload"] == {"mass": 2.5}
    assert task["task"]["robot"] == {"limits": "akb", "parameters": "akb", "tool": "wrist_center"}
    assert task["assessments"][0]["dwell"] == 3.0


def test_the_robot_option_takes_a_path_from_here(
    joints: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["assess", joints, "--robot", "missing.urdf"]) == 2
    assert str(tmp_path / "missing.urdf") in capsys.readouterr().err


def test_json_is_one_document(capsys: pytest.CaptureFixture[str]) -> None:
    main(["assess", "--format", "json"])
    document = json.loads(capsys.readouterr().out)
    assert [task["task"]["name"] for task in document["tasks"]] == ["paper", "paper-turned"]
    assert document["is_feasible"] is False


def test_csv_is_one_table(capsys: pytest.CaptureFixture[str]) -> None:
    main(["assess", "--format", "csv"])
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert len(rows) == 2 * 3 * 6


def test_a_name_that_looks_like_markup_is_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = "<script>alert(1)</script>"
    path = tmp_path / "task.yaml"
    path.write_text(JOINTS.format(name=name))
    assert main(["assess", str(path), "--no-png", "--out", str(tmp_path / "out")]) == 0
    assert f"Task '{name}'" in capsys.readouterr().out
    assert json.loads((tmp_path / "out" / "assessment.json").read_text())["tasks"][0]["task"]["name"] == name
    assert (tmp_path / "out" / "_script_alert_1___script_").is_dir()
    report = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in report
    assert name not in report


def test_auto_says_when_no_branch_is_within_limits(capsys: pytest.CaptureFixture[str]) -> None:
    main(["assess", "paper", "--branch", "auto", "--profile", "septic"])
    assert "least beyond its limits: none is within them" in " ".join(capsys.readouterr().out.split())


# ---- --out


def test_out_has_report_json_samples_and_figures(
    joints: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["assess", joints, "--format", "json", "--no-png", "--out", str(tmp_path / "out")])
    assert (tmp_path / "out" / "assessment.json").read_text() == capsys.readouterr().out
    assert (tmp_path / "out" / "report.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    names = {path.name for path in (tmp_path / "out" / "small").iterdir()}
    assert names == {"samples-quintic_segments.csv", *(f"{name}.svg" for name in FIGURES)}
    assert "<svg" in (tmp_path / "out" / "small" / "jerk.svg").read_text(encoding="utf-8")


@pytest.mark.slow
def test_each_figure_is_there_as_png_and_svg(joints: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The PNG files were `joints`, `workspace`, ... where the SVG files were `position`, `tool`, ..."""
    assert main(["assess", joints, "--out", str(tmp_path / "out")]) == 0
    assert capsys.readouterr().err == ""
    found = {path.name: path.read_bytes() for path in (tmp_path / "out" / "small").iterdir()}
    for name in FIGURES:
        assert found[f"{name}.png"].startswith(b"\x89PNG")
        assert f"{name}.svg" in found
    assert len(found) == 1 + 2 * len(FIGURES)


def test_out_leaves_nothing_behind_when_a_figure_fails(
    joints: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object) -> str:
        raise RuntimeError("no samples today")

    monkeypatch.setattr(_assess_answer, "samples_csv", fail)
    assert main(["assess", joints, "--out", str(tmp_path / "out")]) == 70
    assert "RuntimeError: no samples today" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["task.yaml"]


def test_out_overwrites_nothing(joints: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assess", joints, "--out", str(tmp_path)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "is not empty; nothing in it is overwritten without --force" in err
    assert [path.name for path in tmp_path.iterdir()] == ["task.yaml"]


# ---- ik


def test_ik_lists_all_branches_of_a_pose(capsys: pytest.CaptureFixture[str]) -> None:
    robot = ps.load_robot()
    q = np.array([0.3, 0.8, -2.9, 0.0, 0.7, 0.0])
    T = ps.forward_kinematics(robot, q)
    pitch, yaw = np.arctan2(-T[2, 0], np.hypot(T[0, 0], T[1, 0])), np.arctan2(T[1, 0], T[0, 0])
    roll = np.arctan2(T[2, 1], T[2, 2])
    position, turns = T[:3, 3], np.rad2deg([roll, pitch, yaw])
    numbers = ["--position", *map(repr, position.tolist()), "--rpy-deg", *map(repr, turns.tolist())]
    assert main(["ik", *numbers, "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "puma-septic/ik/1"
    branches = document["poses"][0]["branches"]
    assert len(branches) == 8
    # The pose goes through degrees; the arm is not near a singularity.
    np.testing.assert_allclose(branches[0]["q"], q, atol=1e-9)
    assert (branches[0]["configuration"], branches[0]["rtb_python"], branches[0]["rtb_matlab"]) == (
        "right-up-noflip",
        "ruf",
        "run",
    )


def test_ik_of_the_papers_poses_finds_no_branch_within_limits(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ik", "-v"]) == 1
    out = capsys.readouterr().out
    assert [line for line in out.splitlines() if line in ("take", "lift", "unload", "place")] == [
        "take",
        "lift",
        "unload",
        "place",
    ]
    assert re.search(r"right-down-flip .*  joint2\n +joint4\n +joint5\n", out)


def test_a_negative_power_of_ten_is_a_number(capsys: pytest.CaptureFixture[str]) -> None:
    """argparse took -1e-15, as a computed angle often is, for an option, and asked for three numbers."""
    assert main(["ik", "--position", "0.5", "-1e-1", "0.7", "--rpy-deg", "-1e-15", "90", "0", "--format", "json"]) == 0
    pose = json.loads(capsys.readouterr().out)["poses"][0]["T_world_tool"]
    assert pose[1][3] == -0.1


def test_ik_names_the_singularity(capsys: pytest.CaptureFixture[str]) -> None:
    """With q5 = 0 two wrist branches meet."""
    T = ps.forward_kinematics(ps.load_robot(), [0.0, 0.8, -2.5, 0.0, 0.0, 0.0])
    pitch = np.rad2deg(np.arctan2(-T[2, 0], T[0, 0]))
    main(["ik", "--position", *map(repr, T[:3, 3].tolist()), "--rpy-deg", "0", repr(float(pitch)), "0"])
    assert "right-up-noflip is singular (wrist)" in capsys.readouterr().out


def test_ik_says_how_many_branches_there_are_and_how_low_they_hang(capsys: pytest.CaptureFixture[str]) -> None:
    """A UR5's branches were numbered, some were missing, and an elbow below the table was not told."""
    pose = ["ik", "--robot", str(EXAMPLES["ur5"]), "--position", "0.5", "-0.15", "0.1", "--rpy-deg", "0", "180", "0"]
    assert main(pose) == 0
    out = capsys.readouterr().out
    assert "right-up-noflip" in out
    assert "All 8 branches." in out
    said = r"Lowest point \(below the base where negative\): -0\.\d+ m \(elbow_joint\) in \w+-down-\w+"
    assert re.search(said, " ".join(out.split()))
    main([*pose, "--format", "json"])
    found = json.loads(capsys.readouterr().out)["poses"][0]
    assert (found["is_complete"], found["starts"], found["constrain"]) == (True, 0, "pose")
    assert "rtb_python" not in found["branches"][0]
    lowest = min(found["branches"], key=lambda branch: branch["lowest"]["height"])["lowest"]
    assert lowest["part"] == "elbow_joint"
    assert lowest["height"] < 0


def test_ik_of_an_arm_with_fewer_axes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Position alone for three joints; what was merely found is not called all."""
    arm(tmp_path, "three", [*standard(KR5)[:3], ([0.62, 0, 0], [0, 0, 0])])
    robot = ["ik", "--robot", str(tmp_path / "three.urdf"), "--tool", "tool", "--position", "0.8", "0.1", "0.6"]
    assert main([*robot, "--position-only"]) == 0
    assert "solutions found from 32 starts; there may be others." in " ".join(capsys.readouterr().out.lower().split())
    assert main(robot) == 2
    assert "3 joints cannot meet 6 conditions but by chance" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["ik", "--position-only"], "--position-only goes with --position"),
        (["ik", "--axis", "0", "0", "1"], "--axis goes with --position"),
        (
            ["ik", "--position", "1", "0", "0", "--axis", "0", "0", "1", "--position-only"],
            "give one of --axis and --position-only",
        ),
        (["ik", "--position", "0.5", "0", "0.5", "--position-only"], "6 joints carry the tool, and which way"),
        (["ik", "--position", "5", "0", "0"], "--position: .*out of reach"),
        (["ik", "--rpy-deg", "0", "0", "0"], "--rpy-deg goes with --position"),
        (["ik", "paper", "--position", "0.5", "0", "0"], "give either TASK or --position, not both"),
        (["ik", "--position", "0.5", "0", "0", "--frame", "table"], "unknown frame 'table'; valid: 'world'"),
        (["ik", "--position", "nan", "0", "0"], "'nan' is not a finite number"),
    ],
)
def test_ik_refuses(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert_bad_input(arguments, message.replace("[", r"\[").replace("]", r"\]"), capsys)


def test_ik_needs_a_pose(joints: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert_bad_input(["ik", joints], "no point is a pose", capsys)


# ---- paper


@pytest.mark.slow
def test_paper_prints_and_writes_its_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """--out once ended in exit code 70: what it loads late had moved, and no type checker saw it."""
    assert main(["paper", "--format", "json", "--out", str(tmp_path / "out")]) == 0
    assert json.loads(capsys.readouterr().out)["schema"] == "puma-septic/paper/1"
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"paper.json", "paper.txt", "report.html"} < names
    assert any(name.endswith(".svg") for name in names)
    assert any(name.endswith(".png") for name in names)


# ---- what exists, and what was meant


def test_what_exists_is_replaced_by_force_alone(
    joints: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An empty folder is taken; in one with content, files of the same names are replaced and all others stay."""
    out = tmp_path / "out"
    out.mkdir()
    write = ["assess", joints, "--no-png", "--out", str(out)]
    assert main(write) == 0
    (out / "metrics.csv").write_text("old")
    (out / "mine.txt").write_text("mine")
    capsys.readouterr()
    assert_bad_input(write, "is not empty; nothing in it is overwritten without --force", capsys)
    assert main([*write, "--force"]) == 0
    assert (out / "metrics.csv").read_text() != "old"
    assert (out / "mine.txt").read_text() == "mine"
    capsys.readouterr()
    page = tmp_path / "replay.html"
    page.write_text("old")
    assert_bad_input(["replay", joints, "--html", str(page)], "replay.html exists; .* --force replaces it", capsys)
    assert main(["replay", joints, "--html", str(page), "--force"]) == 0
    assert len(page.read_text()) > 100_000


def test_without_a_command_the_help_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert capsys.readouterr().out.startswith("usage: puma-septic")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["asess"], r"unknown command 'asess'; valid: assess, .*; did you mean 'assess'\?"),
        (["assess", "--proflie", "septic"], r"unrecognized arguments: --proflie; did you mean '--profile'\?"),
        (["assess", "papr"], r"unknown task 'papr'; valid: .*; did you mean 'paper'\?"),
        (["assess", "--robot", "puma56"], r"unknown robot 'puma56'; valid: .*; did you mean 'puma560'\?"),
        (["assess", "--profile", "septc"], r"unknown profile 'septc'; valid: .*; did you mean 'septic'\?"),
        (["assess", "--limits", "corkee"], r"unknown limits of .* 'corkee'; valid: .*; did you mean 'corke'\?"),
    ],
)
def test_a_slip_of_the_finger_is_told_what_was_meant(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert_bad_input(arguments, message, capsys)


# ---- bad input and endings


def assert_bad_input(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2, nothing on stdout, one line on stderr."""
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    with pytest.raises(ValueError, match=message):
        raise ValueError(err)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["asses"], "unknown command 'asses'; valid: assess"),
        (["assess", "--profil", "septic"], "unrecognized arguments"),
        (["assess", "papre"], "'paper', 'paper-straight', 'paper-turned', 'williams', or the path of a .yaml file"),
        (["assess", "none.yaml"], "none.yaml: this task file does not exist"),
        (["assess", "--profile", "spline"], "--profile spline: unknown profile 'spline'; valid: "),
        (["assess", "--robot", "kuka"], "unknown robot 'kuka'; valid: 'puma560'"),
        (["assess", "--limits", "kuka"], "unknown limits .*'kuka'; valid: 'corke'"),
        (["assess", "--branch", "left"], "--branch left: unknown branch 'left'; valid: 'right-up-noflip'"),
        (["assess", "--tool", "hand"], "unknown tool frame 'hand'; valid: "),
        (["assess", "--payload", "-1"], "--payload: -1 is negative"),
        (["assess", "--dwell", "inf"], "--dwell: 'inf' is not a finite number"),
        (["assess", "--margin", "20"], "--margin: 20 is not between 0 and 1"),
        (["assess", "--csv", "log.csv", "--no-png"], "--no-png goes with --out: name the folder to write into"),
        (["assess", "--no-png"], "--no-png goes with --out: name the folder to write into"),
        (["assess", "--format", "xml"], "--format: invalid choice: 'xml'"),
    ],
)
def test_bad_input_is_one_line_on_stderr(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert_bad_input(arguments, message, capsys)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("points: [", "not valid YAML"),
        (JOINTS.format(name="x").replace("times", "time"), "unknown key 'time'; valid: "),
        (JOINTS.format(name="x").replace("0.3", ".nan"), r"points\[1\].joints\[0\]: expected a finite number, got nan"),
        (
            JOINTS.format(name="x").replace("joints: [0.3, 0.8, -2.5, 0, 0.7, 0]", FAR),
            r"points\[1\] 'b': .*out of reach",
        ),
        ("#" * 70_000, "larger than the 64,000 bytes"),
    ],
)
def test_a_bad_task_file_is_named(text: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "t.yaml"
    path.write_text(text)
    assert_bad_input(["assess", str(path)], rf"t\.yaml.*{message}", capsys)


def test_help_and_version_end_well(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"puma-septic {ps.__version__}\n"
    assert main(["--help"]) == 0
    shown = capsys.readouterr().out
    assert all(re.search(rf"\n    {command}\s", shown) for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_of_a_command_has_examples_that_parse(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, "--help"]) == 0
    lines = capsys.readouterr().out.partition("\nexamples:\n")[2].splitlines()
    assert lines
    for line in lines:
        program, *arguments = line.split()
        assert program == "puma-septic"
        assert parse(arguments, COMMANDS).command == command


def test_help_loads_the_standard_library_alone() -> None:
    code = (
        "import sys, puma_septic.cli as c; c.main(['--help']);"
        " [c.main([name, '--help']) for name in c.COMMANDS]; print(*sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    heavy = {"numpy", "pinocchio", "pydantic", "ruamel.yaml", "scipy", "matplotlib", "tabulate"}
    assert heavy.isdisjoint(run.stdout.split())


@pytest.mark.slow
def test_assess_loads_no_drawing_library() -> None:
    code = "import sys, puma_septic.cli as c; c.main(['assess']); print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert {"matplotlib", "meshcat", "IPython", "scipy"}.isdisjoint(run.stdout.split())


def test_as_a_process() -> None:
    run = subprocess.run([*COMMAND, "assess", "paper-turned", "--profile", "lspb"], capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, "")
    assert "lspb" in run.stdout


@pytest.mark.slow
def test_a_reader_that_leaves_early_is_no_failure() -> None:
    """As in ``puma-septic assess | head``: the exit code is still the verdict, and nobody complains."""
    read, write = os.pipe()
    os.close(read)
    run = subprocess.run([*COMMAND, "assess"], stdout=write, stderr=subprocess.PIPE, text=True)
    os.close(write)
    assert (run.returncode, run.stderr) == (1, "")


def test_an_interrupt_ends_in_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(_assess, "run", interrupt)
    assert main(["assess"]) == 130
    assert capsys.readouterr() == ("", "puma-septic: interrupted\n")


@pytest.mark.parametrize("where", [["--debug", "assess"], ["assess", "--debug"]])
def test_an_unforeseen_exception_is_70_with_what_to_report(
    where: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A ZeroDivisionError once left with Python's own exit code, 1, which a script reads as a broken limit."""

    def fail(*_: object) -> None:
        raise ZeroDivisionError("float division\nby zero")

    monkeypatch.setattr(_assess, "run", fail)
    assert main(["assess", "my task.yaml"]) == 70
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines()[0] == "puma-septic: internal error: ZeroDivisionError: float division by zero"
    assert "a fault of puma-septic, not of its input" in err
    assert "command    puma-septic assess 'my task.yaml'\n" in err
    assert f"version    puma-septic {ps.__version__}, Python " in err
    assert "raised in  puma_septic/cli/__init__.py, line " in err
    assert "--debug shows" in err
    assert "Traceback" not in err
    assert main(where) == 70
    assert capsys.readouterr().err.startswith("Traceback (most recent call last):")


def test_a_library_that_the_system_lacks_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In a slim container, where it was told as a fault of the program; any other failed import still is."""

    def fail(*_: object) -> None:
        raise ImportError(message)

    monkeypatch.setattr(_assess, "run", fail)
    message = "libgomp.so.1: cannot open shared object file: No such file or directory"
    assert main(["assess"]) == 2
    assert capsys.readouterr().err == (
        "puma-septic: error: this system lacks the library libgomp.so.1; install it (Debian, Ubuntu: apt-get install"
        " libgomp1)\n"
    )
    message = "libexpat.so.1: cannot open shared object file: No such file or directory"
    assert main(["assess"]) == 2
    assert capsys.readouterr().err.endswith("the library libexpat.so.1; install it\n")
    message = "cannot import name 'x'"
    assert main(["assess"]) == 70


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_takes_debug(command: str) -> None:
    needed = {"check": ["--robot", "puma560", "plan.yaml"], "study": ["reach.yaml"], "init": ["task"]}
    assert parse([command, *needed.get(command, []), "--debug"], COMMANDS).debug


def test_debug_changes_nothing_of_bad_input(capsys: pytest.CaptureFixture[str]) -> None:
    assert_bad_input(["assess", "none.yaml", "--debug"], "this task file does not exist", capsys)


@pytest.mark.slow
def test_a_result_that_cannot_be_written_is_no_verdict() -> None:
    """A full disk and a closed output once were tracebacks with exit code 1; a closed stderr hides only the reason."""
    shell = f"{sys.executable} -m puma_septic.cli assess"
    if Path("/dev/full").exists():  # of Linux
        full = subprocess.run(["sh", "-c", f"{shell} > /dev/full"], stderr=subprocess.PIPE, text=True)
        assert full.returncode == 2
        assert full.stderr == "puma-septic: error: cannot write the result: No space left on device\n"
    closed = subprocess.run(["sh", "-c", f"{shell} >&-"], stderr=subprocess.PIPE, text=True)
    assert closed.returncode == 2
    assert closed.stderr == "puma-septic: error: cannot write the result: the standard output is closed\n"
    assert subprocess.run(["sh", "-c", f"{shell} none.yaml 2>&-"], stdout=subprocess.PIPE).returncode == 2


@pytest.mark.slow
def test_a_terminal_without_the_characters_shows_their_numbers(joints: str) -> None:
    Path(joints).write_text(JOINTS.format(name="Größe"), encoding="utf-8")
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    run = subprocess.run([*COMMAND, "assess", joints], capture_output=True, text=True, env=environment)
    assert (run.returncode, run.stderr) == (0, "")
    assert r"Gr\xf6\xdfe" in run.stdout


@pytest.mark.parametrize("kind", ["task", "cycle"])
def test_a_margin_is_told_alike_by_exit_code_document_and_report(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With exit code 1 for a margin that is not left, the JSON had `is_feasible` alone and the report said Feasible."""
    moves = {
        "task": "times: [0, 2.0]\nprofiles: [quintic]\n",
        "cycle": "repeat: false\ncycle:\n  - {to: b, duration: 2.0, profile: quintic}\n",
    }
    task = tmp_path / "cell.yaml"
    task.write_text(
        "name: cell\nrobot: {source: puma560}\npoints:\n  - {name: a, joints: [0.0, 0.6, -2.2, 0.0, 0.3, 0.0]}\n"
        f"  - {{name: b, joints: [1.2, 1.0, -2.4, 0.0, 0.6, 0.0]}}\n{moves[kind]}"
    )
    for margin, kept in (("0.1", True), ("0.5", False)):
        folder = tmp_path / margin
        arguments = ["assess", str(task), "--margin", margin, "--format", "json", "--no-png", "--out", str(folder)]
        assert main(arguments) == (0 if kept else 1)
        document = json.loads(capsys.readouterr().out)
        assert (document["margin"], document["keeps_margin"]) == (float(margin), kept)
        unmet = document["not_kept"] if kind == "cycle" else document["tasks"][0]["assessments"][0]["not_kept"]
        assert bool(unmet) != kept
        assert document == json.loads(next(folder.glob("*.json")).read_text())
        word = f"{'Feasible' if kept else 'Not kept'} with {100 * float(margin):g} % to spare"
        assert f'<p class="word">{word}</p>' in (folder / "report.html").read_text()
