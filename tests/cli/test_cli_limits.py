"""``puma-septic limits``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from puma_septic.cli import main

ARGUMENTS = ["limits", "paper-turned", "--profile", "septic"]


def test_the_answer_is_one_row_for_each_profile(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*ARGUMENTS, "--profile", "quintic_segments"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("paper-turned: how fast, how heavy\n")
    row = next(line for line in text.splitlines() if line.startswith("septic"))
    assert row.split()[1:3] == ["9.000", "7.7796"]
    assert "joint2 velocity at 1.788 s" in row
    assert "jerk limit: unknown for all joints" in text


@pytest.mark.slow
def test_json_csv_and_files_hold_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "out"
    assert main([*ARGUMENTS, "--com", "0,0,0.1", "--format", "json", "--out", str(folder)]) == 0
    document = json.loads(capsys.readouterr().out)
    assert json.loads((folder / "limits.json").read_text()) == document
    one = document["profiles"][0]
    assert one["com"] == [0.0, 0.0, 0.1]
    assert one["fastest"]["certificate"] == one["heaviest"]["certificate"] == "proved"
    rows = (folder / "limits.csv").read_text().splitlines()
    assert rows[0] == "profile,duration [s],least payload [kg],largest payload [kg]"
    assert len(rows) == 1 + len(one["durations"])
    assert "<svg" in (folder / "payload.svg").read_text()
    assert main([*ARGUMENTS, "--format", "csv", "--com", "0,0,0.1"]) == 0
    assert capsys.readouterr().out.splitlines() == rows


def test_a_task_that_no_duration_mends_says_why(capsys: pytest.CaptureFixture[str]) -> None:
    """The paper's own points leave the range of a joint: that is not a matter of time."""
    assert main(["limits", "paper", "--profile", "septic"]) == 1
    text = capsys.readouterr().out
    assert "septic: no stretch of time helps: joint" in text
    assert "is violated at any speed" in text
    assert "septic: no payload keeps the limits: joint" in text


def test_a_place_of_two_numbers_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*ARGUMENTS, "--com", "0,0"]) == 2
    assert "'0,0' is not X,Y,Z" in capsys.readouterr().err


def test_the_reference_says_what_a_profile_costs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*ARGUMENTS, "--reference", "--format", "json"]) == 0
    one = json.loads(capsys.readouterr().out)["profiles"][0]
    reference = one["reference"]
    assert reference["gap"] == one["fastest"]["duration"] / reference["certified_duration"]
    assert reference["gap"] > 1.3
    assert main([*ARGUMENTS, "--reference"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert f"septic: gap {reference['gap']:.3f}: along the same path the optimum takes" in text


def test_the_folder_has_a_report_like_the_others(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It had a figure alone: the verdict, what stops each profile, the motions and where all comes from."""
    folder = tmp_path / "out"
    assert main([*ARGUMENTS, "--out", str(folder), "--no-png"]) == 0
    assert capsys.readouterr().out.endswith(f"\n\nReport: {folder / 'report.html'}\n")
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "Quickest: septic in 7.780 s instead of 9.000 s; joint2 velocity at 1.788 s stops it." in page
    assert "command: puma-septic limits paper-turned --profile septic" in page
    assert "<h3>Payload over duration</h3>" in page
    assert page.index("Quickest") < page.index('class="matrix"') < page.index("what stops it") < page.index("Inputs")


POINTS = """points:
  - {joints: [0.0, 0.6, -2.2, 0.0, 0.3, 0.0]}
  - {joints: [1.2, 1.0, -2.4, 0.0, 0.6, 0.0]}
times: [0, 2.0]
profiles: [quintic]
"""


def test_what_a_task_says_of_its_drives_is_not_passed_over(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`size` held the drives to the task's conditions; the least duration was told without a word of them."""
    task = tmp_path / "cell.yaml"
    task.write_text(f"name: cell\nrobot: {{source: puma560}}\n{POINTS}conditions: {{peak_current: 0.1}}\n")
    assert main(["limits", str(task)]) == 0
    told = "the task's conditions (peak_current): size --reserves holds the drives to them"
    assert told in " ".join(capsys.readouterr().out.split())
    folder = tmp_path / "out"
    assert main(["limits", str(task), "--format", "json", "--no-png", "--out", str(folder)]) == 0
    assert json.loads(capsys.readouterr().out)["not_assessed"] == [told]
    assert "(peak_current)" in (folder / "report.html").read_text()


def test_a_payload_that_no_known_limit_bears_leaves_the_duration(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without effort limits "any mass will do" was an error, exit code 2, that took the least duration with it."""
    urdf = tmp_path / "p.urdf"
    urdf.write_text(
        '<robot name="p"><link name="a"/><link name="b"><inertial><mass value="1"/><origin xyz="0.1 0 0"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 -1 0"/>'
        '<limit effort="0" velocity="2" lower="-3" upper="3"/></joint></robot>'
    )
    task = tmp_path / "p.yaml"
    task.write_text(
        "name: p\nrobot: {source: p.urdf}\npoints: [{joints: [0]}, {joints: [1]}]\ntimes: [0, 2]\nprofiles: [quintic]\n"
    )
    assert main(["limits", str(task), "--out", str(tmp_path / "out"), "--no-png"]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "Quickest: quintic in 0.9375 s" in out
    assert "No known limit bears the payload." in out
    assert "j velocity at 0.4688 s any" in out
    assert "No payload keeps the limits" not in (tmp_path / "out" / "report.html").read_text()
