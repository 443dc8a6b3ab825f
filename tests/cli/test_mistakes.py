"""Some sixty things that people get wrong: each message has the option or the line, the value and the remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from puma_septic.cli import COMMANDS, main

TASK = """name: cell
points:
  - {name: a, joints: [0, 0.5, -2.5, 0, 0.7, 0]}
  - {name: b, joints: [0.3, 0.8, -2.5, 0, 0.7, 0]}
times: [0, 1.5]
profiles: [quintic_segments]
"""
FILES = {
    "cell.yaml": TASK,
    "profile.yaml": TASK.replace("quintic_segments", "quintc"),
    "times.yaml": TASK.replace("1.5]", "-1.5]"),
    "key.yaml": TASK.replace("profiles:", "profile:"),
    "broken.yaml": "name: [\n",
    "few.yaml": TASK.replace("0, 0.7, 0]}\ntimes", "0.7, 0]}\ntimes"),
    "log.csv": "a,b\n1,2\n",
    "own.yaml": TASK + "conditions: {own_masses: [1, 1, 1, 1, 1, 1]}\n",
    "list.yaml": "- 1\n",
    "axis.yaml": "name: s\ntask: paper-turned\naxes: {profil: [septic]}\n",
}

# What was typed, what is blamed, its value, and the remedy.
MISTAKES = [
    (["asses"], "command", "asses", "did you mean 'assess'?"),
    (["assess", "nosuch.yaml"], "nosuch.yaml", "task file", "does not exist"),
    (["assess", "paper-turnd"], "task", "paper-turnd", "did you mean 'paper-turned'?"),
    (["assess", "cell.yaml", "--profile", "sptic"], "--profile", "sptic", "did you mean 'septic'?"),
    (["assess", "cell.yaml", "--tool", "flnge"], "--tool", "flnge", "did you mean 'flange'?"),
    (["assess", "cell.yaml", "--robot", "ur55"], "--robot", "ur55", "did you mean 'ur5'?"),
    (["assess", "cell.yaml", "--robot", "arm.urdf"], "--robot", "arm.urdf", "does not exist"),
    (["assess", "cell.yaml", "--actuators", "arm.toml"], "--actuators", "arm.toml", "does not exist"),
    (["assess", "cell.yaml", "--limits", "corkee"], "--limits", "corkee", "did you mean 'corke'?"),
    (["assess", "cell.yaml", "--payload", "two"], "--payload", "two", "not a finite number"),
    (["assess", "cell.yaml", "--payload", "-1"], "--payload", "-1", "negative"),
    (["assess", "cell.yaml", "--margin", "20"], "--margin", "20", "not between 0 and 1"),
    (["assess", "cell.yaml", "--dwel", "1"], "--dwel", "1", "did you mean '--dwell'?"),
    (["assess", "cell.yaml", "--lock", "joint2"], "--lock", "joint2", "JOINT=POSITION"),
    (["assess", "cell.yaml", "--units", "deg"], "--units", "", "goes with --csv"),
    (["assess", "cell.yaml", "--show-in", "degree"], "--show-in", "degree", "did you mean 'deg'?"),
    (["assess", "cell.yaml", "--show-in", "rad,deg"], "--show-in", "rad or in deg", "not in both"),
    (["assess", "cell.yaml", "--no-png"], "--no-png", "", "goes with --out"),
    (["assess", "cell.yaml", "--out", "full"], "full", "not empty", "--force"),
    (["assess", "--csv", "nosuch.csv"], "nosuch.csv", "CSV file", "does not exist"),
    (["assess", "--csv", "log.csv"], "log.csv, row 1", "'a', 'b'", "time=COLUMN"),
    (["assess", "profile.yaml"], "profile.yaml, line 6: profiles[0]", "quintc", "did you mean 'quintic'?"),
    (["assess", "times.yaml"], "times.yaml, line 5: times", "-1.5 s", "must increase strictly"),
    (["assess", "key.yaml"], "key.yaml", "profile", "did you mean 'profiles'?"),
    (["assess", "broken.yaml"], "broken.yaml, line 2", "stream end", "not valid YAML"),
    (["assess", "few.yaml"], "few.yaml: points[1] 'b'", "5 numbers", "for 6 joints"),
    (["compare", "cell.yaml", "--objective", "jerk"], "--objective", "jerk", "did you mean"),
    (["optimise", "paper-turned", "--points", "0"], "--points", "0", "whole number from 1"),
    (["ik", "--position", "5", "0.1", "0.6"], "--position", "out of reach", "the nearest q"),
    (["ik", "--rpy-deg", "0", "0", "0"], "--rpy-deg", "", "goes with --position"),
    (["replay", "cell.yaml", "--port", "99999"], "port", "99999", "from 0 to 65535"),
    (["study", "nosuch.yaml"], "nosuch.yaml", "study file", "does not exist"),
    (["study", "axis.yaml"], "axis.yaml", "axis 'profil'", "did you mean 'profile'?"),
    (["study", "cell.yaml"], "cell.yaml", "unknown 'points'", "valid: name, task, axes"),
    (["study", "list.yaml"], "list.yaml", "expected one mapping", "name, task, axes"),
    (
        ["study", "list.yaml", "axis.yaml"],
        "study",
        "list.yaml axis.yaml",
        "expected one study file, summarise FOLDER or",
    ),
    (["study", "summarise", "full"], "full", "no study is there", "study.json"),
    (["execute", "cell.yaml", "--controller", "pdi"], "--controller", "'pdi'", "computed_torque"),
    (["execute", "cell.yaml", "--rate", "7.7"], "rate", "7.7 Hz", "divide it"),
    (["execute", "cell.yaml", "--bandwidth", "0"], "--bandwidth", "0", "not positive"),
    (["limits", "cell.yaml", "--com", "1,2"], "--com", "'1,2'", "X,Y,Z"),
    (["limits", "cell.yaml", "--profile", "sptic"], "--profile", "sptic", "did you mean 'septic'?"),
    (["limits", "cell.yaml", "--margin", "2"], "--margin", "2", "not between 0 and 1"),
    (["check", "cell.yaml"], "check", "--robot", "required"),
    (
        ["check", "cell.yaml", "--robot", "puma560", "--allow", "limit_unkown"],
        "--allow",
        "limit_unkown",
        "did you mean",
    ),
    (["accelerations", "--joint", "joint7=1:2"], "--joint", "joint7", "did you mean 'joint6'"),
    (["accelerations", "--joint", "joint1=2:1"], "--joint joint1", "[2, 1]", "the lower bound comes first"),
    (["accelerations", "--gap", "0"], "--gap", "0", "greater than 0"),
    (["robot", "ur55"], "robot", "ur55", "did you mean 'ur5'?"),
    (["robot", "ur5", "--at", "elbow=1"], "--at", "elbow", "did you mean 'elbow_joint'?"),
    (["robot", "puma560", "--at", "=1"], "--at", "'=1'", "JOINT=POSITION"),
    (["robot", "puma560", "--at", "1", "2"], "--at", "2 numbers", "JOINT=POSITION"),
    (["doctor", "nosuch.urdf"], "nosuch.urdf", "URDF", "does not exist"),
    (["profiles", "septc"], "profile", "septc", "did you mean 'septic'?"),
    (["size", "cell.yaml", "--catalogue", "nosuch.csv"], "--catalogue", "nosuch.csv", "does not exist"),
    (["size", "cell.yaml", "--catalogue", "exampel"], "--catalogue", "exampel", "did you mean 'example'?"),
    (
        ["size", "cell.yaml", "--catalogue", "log.csv", "log.csv"],
        "log.csv, row 1",
        "'key' is missing",
        "the header has",
    ),
    (["size", "own.yaml", "--catalogue", "example"], "own masses", "placed on the arm", "they go with --masses"),
    (["size", "cell.yaml", "--margin", "=0.2"], "--margin", "'=0.2'", "SHARE or CHECK=SHARE"),
    (["size", "cell.yaml", "--rank", "mass"], "--rank", "", "goes with --catalogue"),
    (["size", "cell.yaml", "--drives", "nosuch.toml"], "--drives", "nosuch.toml", "does not exist"),
    (["init", "full"], "full", "not empty", "--force"),
    (["paper", "--no-png"], "--no-png", "", "goes with --out"),
    (["ik", "--sort", "up"], "--sort", "'up'", "manipulability"),
]


@pytest.mark.parametrize(
    ("arguments", "blamed", "value", "remedy"), MISTAKES, ids=[" ".join(typed) for typed, *_ in MISTAKES]
)
def test_a_mistake_is_named_with_its_remedy(
    arguments: list[str],
    blamed: str,
    value: str,
    remedy: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """`assess --profile sptic` complained of the built-in task's profiles[0], `--tool foo` of its robot."""
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "kept").touch()
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    for part in (blamed, value, remedy):
        assert part in err, err


def test_no_command_is_without_a_mistake() -> None:
    assert {typed[0] for typed, *_ in MISTAKES} >= set(COMMANDS)


def test_a_file_is_named_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It was "--csv nosuch.csv: nosuch.csv: this CSV file does not exist", and an angle of 4e-17 rad was left over."""
    assert main(["assess", "--csv", str(tmp_path / "nosuch.csv")]) == 2
    assert capsys.readouterr().err.count("nosuch.csv") == 1
    assert main(["ik", "--position", "5", "0.1", "0.6"]) == 2
    assert capsys.readouterr().err.endswith(" m and 0 rad\n")


def test_nothing_typed_is_answered_by_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert "usage: puma-septic" in capsys.readouterr().out


def test_points_in_degrees_are_suspected(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Joint positions of 45 and -90 gave "joint3 position 7573 %" and no question."""
    monkeypatch.chdir(tmp_path)
    text = TASK.replace("[0, 0.5, -2.5, 0, 0.7, 0]", "[0, 45, -90, 0, 30, 0]")
    Path("degrees.yaml").write_text(text)
    assert main(["assess", "degrees.yaml"]) == 3
    assert "points in degrees?" in capsys.readouterr().out
