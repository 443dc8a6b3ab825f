"""Robots on the command line: what a file has, joints that are locked, meshes that are found, and no inertia."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from helpers.meshes import arm as meshed
from helpers.meshes import stl
from helpers.schemas import assert_documented
from helpers.urdf_texts import ARM, INERTIAL

from puma_septic.cli import main
from puma_septic.cli._messages import spelt
from puma_septic.outputs import file_names

TASK = """name: move
robot: {source: arm.urdf}
points:
  - joints: {elbow: 0.2, shoulder: 0.0}
  - joints: [0.6, -0.4]
times: [0.0, 1.0]
profiles: [quintic]
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.urdf").write_text(ARM)
    (tmp_path / "bare.urdf").write_text(ARM.replace(INERTIAL, ""))
    (tmp_path / "move.yaml").write_text(TASK)
    return tmp_path


@pytest.mark.usefixtures("here")
def test_a_robot_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    """No command listed joints, frames, limits or the tool's pose, which every foreign robot needs."""
    assert main(["robot", "arm.urdf", "-v", "--at", "shoulder=1.5707963267948966"]) == 0
    text = capsys.readouterr().out
    assert "arm: 2 joints, tool 'tip' (chosen; --tool FRAME for another)" in text
    row = next(line for line in text.splitlines() if line.startswith("shoulder"))
    assert row.split() == ["shoulder", "revolute", "±2", "3", "unknown", "unknown", "50", "6"]
    assert "base, upper, fore, tip" in text
    assert "position 0.7, 0, 0.5 m" in text  # 0.4 + 0.3 along x, at the shoulder's height


@pytest.mark.usefixtures("here")
def test_its_document_has_the_pose(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robot", "arm.urdf", "--format", "json", "--at", "0.0", "0.0"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert_documented(document)
    assert document["pose"]["position"] == pytest.approx([0.0, 0.0, 1.2])
    assert [joint["mass"] for joint in document["joints"]] == [6.0, 3.0]
    assert document["frames"] == ["base", "upper", "fore", "tip"]


@pytest.mark.usefixtures("here")
def test_names_and_wrong_positions(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robot", "--list"]) == 0
    assert {"puma560", "ur5", "panda"} <= {line.split()[0] for line in capsys.readouterr().out.splitlines()}
    assert main(["robot", "arm.urdf", "--at", "0.1"]) == 2
    assert "--at: 1 numbers for 2 joints: shoulder, elbow" in capsys.readouterr().err
    assert main(["robot", "arm.urdf", "--at", "wrist=1"]) == 2
    assert "unknown joint 'wrist'; valid: 'shoulder', 'elbow'" in capsys.readouterr().err


def test_points_by_joint_name(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assess", "move.yaml"]) == 0
    assert "tool 'tip' (chosen; --tool FRAME for another)" in capsys.readouterr().out
    (here / "move.yaml").write_text(TASK.replace("shoulder: 0.0", "wrist: 0.0"))
    assert main(["assess", "move.yaml"]) == 2
    assert "points[0]: unknown joint 'wrist'; valid: 'shoulder', 'elbow'" in capsys.readouterr().err
    (here / "move.yaml").write_text(TASK.replace(", shoulder: 0.0", ""))
    assert main(["assess", "move.yaml"]) == 2
    err = capsys.readouterr().err
    assert "points[0]: joints: 1 numbers for 2 joints: shoulder, elbow" in err
    assert "--lock-others locks those that do not carry the tool" in err


def test_an_arm_without_inertia_is_answered(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """196 of 666 public arm files: assess, compare and replay ended with exit code 2."""
    assert main(["assess", "move.yaml", "--robot", "bare.urdf"]) == 0
    assert "torque (the URDF has no usable inertia for what the joint moves): unknown for all" in " ".join(
        capsys.readouterr().out.split()
    )
    assert main(["compare", "move.yaml", "--robot", "bare.urdf"]) == 0
    assert main(["replay", "move.yaml", "--robot", "bare.urdf", "--html", "arm.html"]) == 0
    assert (here / "arm.html").stat().st_size > 100_000
    assert main(["size", "move.yaml", "--robot", "bare.urdf", "--catalogue", "example"]) == 2
    assert "no mass or inertia beyond joint 'shoulder', 'elbow'" in capsys.readouterr().err


def test_a_task_repairs_the_urdf(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    body = "{mass: 3.0, com: [0, 0, 0.2], inertia: [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.05]]}"
    source = f"{{source: bare.urdf, locked: others, links: {{upper: {body}, fore: {body}}}}}"
    (here / "repaired.yaml").write_text(TASK.replace("{source: arm.urdf}", source))
    answers = []
    for task in ("move.yaml", "repaired.yaml"):
        assert main(["assess", task, "--format", "json"]) == 0
        (case,) = json.loads(capsys.readouterr().out)["tasks"][0]["assessments"]
        answers.append([joint["peak_torque"] for joint in case["joints"]])
    assert answers[0] == pytest.approx(answers[1], rel=1e-14)


def test_package_dirs_go_with_another_robot(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`--robot` threw the task's folders away, and there was no option for them."""
    (here / "elsewhere" / "parts").mkdir(parents=True)
    stl(here / "elsewhere" / "parts" / "fore.stl")
    (here / "meshed.urdf").write_text(meshed("package://parts/fore.stl"))
    assert main(["robot", "meshed.urdf"]) == 0
    assert "--package-dir FOLDER names the folder that holds it" in " ".join(capsys.readouterr().out.split())
    assert main(["robot", "meshed.urdf", "--package-dir", "elsewhere"]) == 0
    assert "Not drawn" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "option"),
    [
        ("locked='others' fixes", "--lock-others fixes"),
        ("lock it: locked={'f': 0.0}", "lock it: --lock f=0.0"),
        ("locked['elbow'] = 3 is outside", "--lock elbow = 3 is outside"),
        ("package_dirs=['/a/b'] adds it", "--package-dir /a/b adds it"),
        ("limits='soft' takes them", "--limits soft takes them"),
        ("an actuator file (actuators=...)", "an actuator file (--actuators FILE)"),
        ("unlocked={'a': 1} is no remedy", "unlocked={'a': 1} is no remedy"),
    ],
)
def test_remedies_are_spelt_for_the_command_line(text: str, option: str) -> None:
    assert spelt(text) == option


def test_joints_with_a_slash_have_files_of_their_own() -> None:
    """Of four joints two load profiles were written: left/joint_1 and right/joint_1 have one file name."""
    names = ["left/joint_1", "left/joint_2", "right/joint_1", "right/joint_2"]
    assert file_names(names) == ["left_joint_1", "left_joint_2", "right_joint_1", "right_joint_2"]
    assert file_names(["a/b", "a_b", "A_b"]) == ["a_b", "a_b-2", "A_b-3"]
    assert file_names(["..", "../x"]) == ["_", "_x"]
