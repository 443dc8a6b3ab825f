"""Tasks with a cycle on the command line, the folder to begin with, and motions that are written and read back."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from helpers.pages import commands, example_files

from puma_septic.cli import main
from puma_septic.cli._init import FILES
from puma_septic.task import load_task

PALLET = "docs/howto/pallet.md"


@pytest.fixture
def cell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Path:
    """The folder that `init` writes, which becomes the working one."""
    monkeypatch.chdir(tmp_path)
    assert main(["init", "cell"]) == 0
    told = capsys.readouterr().out
    assert "puma-septic assess cell/cell.yaml" in told.replace("\\", "/")
    assert sorted(path.name for path in (tmp_path / "cell").iterdir()) == sorted(FILES)
    monkeypatch.chdir(tmp_path / "cell")
    return tmp_path / "cell"


@pytest.mark.usefixtures("cell")
def test_what_init_writes_runs_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assess", "cell.yaml"]) == 0
    text = capsys.readouterr().out
    assert "rest at pick" in text
    assert "approach place" in text
    assert "in 'pick to place'" in text


@pytest.mark.slow  # two sizings
@pytest.mark.usefixtures("cell")
def test_what_init_writes_sizes_its_own_drives_and_others() -> None:
    assert main(["size", "cell.yaml", "--drives", "drives.toml"]) == 0
    assert main(["size", "cell.yaml", "--catalogue", "motors.csv", "gearboxes.csv"]) == 0


def test_init_replaces_nothing_unless_told_so(cell: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (cell / "cell.yaml").write_text("mine", encoding="utf-8")
    assert main(["init", str(cell)]) == 2
    assert "is not empty; nothing in it is overwritten without --force" in capsys.readouterr().err
    assert (cell / "cell.yaml").read_text(encoding="utf-8") == "mine"
    assert main(["init", str(cell), "--force"]) == 0
    assert load_task(cell / "cell.yaml").cycle


@pytest.mark.slow  # the newcomer's job: a report, two sizings, a replay
def test_a_newcomers_job_is_four_commands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One task, two tables, four commands, no Python: a palletising cycle could not be written as a task."""
    monkeypatch.chdir(tmp_path)
    example_files(tmp_path, PALLET)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["gears.csv", "motors.csv", "pallet.yaml"]
    lines = commands(PALLET)
    assert len(lines) == 4
    for line in lines:
        assert main(line.split()[1:]) == 0
    written = {path.name for path in (tmp_path / "verdict").iterdir()}
    assert {"report.html", "cycle.json", "metrics.csv", "samples.csv", "trajectory.yaml"} <= written
    assert (tmp_path / "replay.html").stat().st_size > 1e5


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (["compare", "paper-straight"], "a cycle, which assess, size and replay take"),
        (["optimise", "paper-straight"], "this needs points with times and profiles"),
        (["assess", "paper-straight", "--profile", "septic"], "--profile does not go with a cycle: in built-in task"),
        (["assess", "paper-straight", "--dwell", "1"], "a rest is a step: - dwell: 0.5"),
        (["size", "paper-straight", "--one-way"], "--one-way does not go with a cycle"),
    ],
)
def test_what_a_command_cannot_do_with_a_cycle_it_says(
    command: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(command) == 2
    assert message in capsys.readouterr().err


def test_check_says_of_a_task_that_it_is_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["init", str(tmp_path / "cell")])
    assert main(["check", str(tmp_path / "cell" / "cell.yaml"), "--robot", "puma560"]) == 2
    assert "a task file, no JointTrajectory: puma-septic assess" in " ".join(capsys.readouterr().out.split())


@pytest.mark.slow
def test_a_cycle_is_written_and_checked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = tmp_path / "plan.yaml"
    assert main(["assess", "paper-straight", "--write", str(plan)]) == 0
    robot = ["--robot", "puma560", "--tool", "wrist_center", "--allow", "limit_unknown"]
    assert main(["check", str(plan), *robot]) == 0
    capsys.readouterr()
    assert main(["assess", "paper-straight", "--write", str(plan)]) == 2
    assert "plan.yaml exists; name another file, or --force replaces it" in capsys.readouterr().err
    assert main(["assess", "paper-straight", "--write", str(plan), "--force"]) == 0


def test_the_optimum_reads_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It printed the best times, which were copied by hand: as a task it goes on to every other command."""
    best = tmp_path / "best.yaml"
    search = ["optimise", "paper-turned", "--restarts", "0"]
    main([*search, "--write", str(best), "--format", "json"])
    found = json.loads(capsys.readouterr().out)
    assert load_task(best).times == tuple(found["optimum"]["times"])
    assert [one.name for one in load_task(best).profiles] == ["septic"]
    assert main([*search, "--write", str(best)]) == 2
    main([*search, "--write", str(tmp_path / "best.json")])
    robot = ["--robot", "puma560", "--tool", "wrist_center", "--allow", "limit_unknown"]
    assert main(["check", str(tmp_path / "best.json"), *robot]) in (0, 1)
    capsys.readouterr()
    assert main([*search, "--write", str(tmp_path / "best.txt")]) == 2
    assert "name a task, .yaml, or a JointTrajectory, .json" in capsys.readouterr().err
    objectives = ["--objective", "overshoot", "--objective", "rms_torque"]
    assert main([*search, *objectives, "--write", str(tmp_path / "front.yaml")]) == 2
    assert "a Pareto front has many optima" in capsys.readouterr().err


def test_the_json_and_csv_of_a_cycle(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assess", "paper-straight", "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["motions"][0]["name"] == document["governing_step"] == "lift"
    assert [step["payload_mass"] for step in document["steps"]] == [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]
    assert main(["assess", "paper-straight", "--format", "csv"]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert len(rows) == 1 + 6 * 6
    assert rows[1].startswith("paper-straight: lift,line,joint1,")


def test_size_takes_the_cycle_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    """It always did the same way back empty; now what the task says is what the drives are held against."""
    assert main(["size", "paper-straight"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert (
        "Task 'paper-straight': move 2 s with 1 kg, move 4 s with 1 kg, move 3 s with 1 kg, move 3 s with 0 kg" in told
    )
    assert "cycle of 6 steps, 18 s, repeats" in told


def test_what_a_doubtful_verdict_rests_on_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The first line said "on doubtful data, see the remarks", and there were none without -v."""
    assert main(["init", str(tmp_path / "cell")]) == 0
    capsys.readouterr()
    assert main(["assess", str(tmp_path / "cell" / "cell.yaml")]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "Doubtful data: doubtful torque: radius of gyration too large: wrist_1_link" in text


def test_a_floor_is_violated_not_unbounded(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A height below the floor is no share of it: the table of steps called it unbounded."""
    task = tmp_path / "cell.yaml"
    task.write_text(
        "name: cell\nrobot: {source: puma560}\nfloor: 0.7\nrepeat: false\npoints:\n"
        "  - {name: a, joints: [0.0, 0.6, -2.2, 0.0, 0.3, 0.0]}\n"
        "  - {name: b, joints: [1.2, 1.0, -2.4, 0.0, 0.6, 0.0]}\n"
        "cycle:\n  - {to: b, duration: 2.0, profile: quintic}\n"
    )
    assert main(["assess", str(task)]) == 1
    out = capsys.readouterr().out
    assert "joint2 height violated" in out
    assert "unbounded" not in out
