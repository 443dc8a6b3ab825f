"""``puma-septic doctor`` and ``puma-septic accelerations``: exit codes and forms."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from helpers.urdf_texts import ARM

from puma_septic.cli import main


def test_doctor_names_the_line_of_what_is_doubtful(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """SARIF 2.1.0: a result for each joint, at the line where it begins in the file."""
    text = ARM.replace('effort="20"', 'effort="1000"')
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    assert main(["doctor", str(path), "--format", "sarif"]) == 1
    log = json.loads(capsys.readouterr().out)
    assert log["version"] == "2.1.0"
    results = {result["ruleId"]: result for result in log["runs"][0]["results"]}
    found = results["effort_placeholder"]
    assert (found["level"], found["message"]["text"]) == (
        "warning", "effort limit, a placeholder?: elbow 1000 N m",
    )  # fmt: skip
    place = found["locations"][0]["physicalLocation"]
    line = text.splitlines()[place["region"]["startLine"] - 1]
    assert 'joint name="elbow"' in line
    assert place["artifactLocation"]["uri"] == path.as_uri()
    assert {rule["id"] for rule in log["runs"][0]["tool"]["driver"]["rules"]} >= set(results)


def test_doctor_says_what_each_answer_may_be_trusted_with(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What is missing, drives and a joint's effort, is no fault: exit code 0."""
    path = tmp_path / "arm.urdf"
    path.write_text(ARM.replace('effort="20"', 'effort="0"'))
    assert main(["doctor", str(path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "arm: nothing doubtful"
    assert "torque: yes" in lines
    assert "effort limits: incomplete" in lines
    assert "  missing, no_effort: no effort limit (or 0): elbow" in lines


def test_accelerations_are_written_for_moveit(capsys: pytest.CaptureFixture[str]) -> None:
    small = [f"--joint=joint{k}=0:0.3" for k in range(1, 7)]
    assert main(["accelerations", "puma560", *small, "--equal", "--format", "moveit"]) == 0
    assert capsys.readouterr().out.startswith("joint_limits:\n  joint1:\n    has_velocity_limits: true\n")
    assert main(["accelerations", "puma560", *small, "--payload", "60"]) == 1
    assert "governing: joint" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--joint", "joint2"], "'joint2' is not NAME=LOW:HIGH"),
        (["--joint", "elbow=0:1"], "unknown joint 'elbow'"),
        (["--gap", "0"], "--gap 0 must be greater than 0"),
    ],
)
def test_bad_input_is_told(options: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["accelerations", "puma560", *options]) == 2
    assert message in capsys.readouterr().err
