"""``puma-septic size``: what it prints, what it writes, what it refuses."""

from __future__ import annotations

import csv
import io
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from helpers.arms import pendulum

from puma_septic.cli import main


def ask(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(["size", *arguments])
    said = capsys.readouterr()
    return code, said.out, said.err


def test_the_arms_own_drives(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = ask(capsys, "--payload", "2.5", "--dwell", "1", "-v")
    assert code == 0
    assert "move 9 s with 2.5 kg, rest 1 s, move 9 s with 0 kg, rest 1 s" in out
    assert "strong enough as far as is known; governing limit: joint2 actuator effort" in " ".join(out.split())
    assert "winding temperature rise: needs" in out


def test_a_load_that_is_too_heavy(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = ask(capsys, "--payload", "9")
    assert code == 1
    assert "undersized" in out
    assert "the worst: joint2 actuator effort at the joint" in " ".join(out.split())


@pytest.mark.slow
def test_reserves_of_the_arms_own_drives(capsys: pytest.CaptureFixture[str]) -> None:
    """The question after the verdict: how much faster, how much heavier."""
    code, out, _ = ask(capsys, "paper-turned", "--dwell", "0.5", "--reserves")
    text = " ".join(out.split())
    assert code == 0
    assert "Least cycle time " in text
    assert " s, to 1 %; beyond it joint" in text
    assert "Largest payload " in text
    _, document, _ = ask(capsys, "paper-turned", "--dwell", "0.5", "--reserves", "--format", "json")
    reserves = json.loads(document)["reserves"]
    assert reserves["cycle_time"]["value"] < 19.0
    assert reserves["payload"]["governing"]["utilisation"] > 1


@pytest.mark.slow
def test_json_of_both_kinds(capsys: pytest.CaptureFixture[str]) -> None:
    _, own, _ = ask(capsys, "--format", "json")
    _, chosen, _ = ask(capsys, "--catalogue", "example", "--format", "json", "--keep", "1")
    assert json.loads(own)["schema"] == "puma-septic/sizing/1"
    document = json.loads(chosen)
    assert document["schema"] == "puma-septic/selection/1"
    assert len(document["joints"][1]["kept"]) == 1
    assert document["task"]["name"] == "paper"


def test_csv_of_both_kinds(capsys: pytest.CaptureFixture[str]) -> None:
    _, own, _ = ask(capsys, "--format", "csv", "--one-way")
    _, chosen, _ = ask(capsys, "--catalogue", "puma560", "--format", "csv", "--keep", "1")
    checks, pairs = (list(csv.DictReader(io.StringIO(text))) for text in (own, chosen))
    assert {row["check"] for row in checks} == {"actuator effort at the joint", "motor speed"}
    assert float(checks[0]["margin"]) == pytest.approx(1 - float(checks[0]["utilisation"]))
    assert len(pairs) == 36
    wrong = [row for row in pairs if row["joint"] == "joint2" and row["motor"] == "puma560-motor6"]
    assert wrong[0]["feasible"] == "no"
    assert wrong[0]["worst violation"] == "actuator effort at the joint"


def test_a_catalogue_ends_with_the_chosen_drives(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = ask(capsys, "--catalogue", "example", "--rank", "cost", "--keep", "1", "--masses", "before", "-vv")
    assert code == 0
    assert "by cost: a pair that is strong enough for every joint" in out
    assert "The first pair of each joint:" in out
    assert "Note: masses added: " in out


@pytest.mark.slow
def test_the_folder(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    folder = tmp_path / "sized"
    code, _, _ = ask(capsys, "--catalogue", "example", "--keep", "1", "--out", str(folder))
    assert code == 0
    names = {path.name for path in folder.iterdir()}
    figures = {"torque-speed", "utilisation", "winding-temperature", "torque-split", "ratio-sweep"}
    assert names == {
        "report.html", "sizing.json", "checks.csv", "pairs.csv", "bill-of-material.csv",
        *(f"{side}-profile-joint{k}.csv" for k in range(1, 7) for side in ("load", "motor")),
        *(f"{name}.{kind}" for name in figures for kind in ("png", "svg")),
    }  # fmt: skip
    rows = list(csv.reader((folder / "motor-profile-joint2.csv").open(encoding="utf-8")))
    assert rows[0] == ["time [s]", "motor speed [rpm]", "whole motor torque, rotor and friction included [N m]"]
    values = np.array(rows[1:], dtype=float)
    assert (np.diff(values[:, 0]) > 0).all()
    assert values[-1, 0] == 18.0
    # The cycle returns: what the motor turns forth it turns back, up to the trapezoids of 10 ms.
    assert abs(np.trapezoid(values[:, 1], values[:, 0])) < 1e-3 * np.abs(values[:, 1]).max()


def test_a_catalogue_without_a_fit(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    motors, gears = tmp_path / "m.csv", tmp_path / "g.csv"
    motors.write_text("key,mass,inertia,max_int_torque\nM,1,1e-4,0.001\n", encoding="utf-8")
    gears.write_text("key,ratio,mass,inertia,efficiency\nG,100,1,1e-5,0.8\n", encoding="utf-8")
    folder = tmp_path / "out"
    code, out, _ = ask(capsys, "--catalogue", str(motors), str(gears), "--out", str(folder))
    assert code == 1
    assert "joint2 (most frequent reason: motor torque)" in out
    assert {path.name for path in folder.iterdir()} == {
        "report.html", "sizing.json", "pairs.csv", "bill-of-material.csv"
    }  # fmt: skip


def test_the_electronics_of_a_drives_file_hold_for_a_catalogue(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """The file was once left unread beside a catalogue, without a word: 1 mA was enough for any motor."""
    file = tmp_path / "drives.toml"
    current = '{ value = 0.001, source = "test" }'
    file.write_text(f'schema = 1\nrobot = "puma560"\n[joints.joint2.drive]\npeak_current = {current}\n')
    code, out, _ = ask(capsys, "--catalogue", "example", "--keep", "1", "--drives", str(file))
    assert code == 1
    assert "no pair is strong enough for joint2 (most frequent reason: peak current)" in " ".join(out.split())


def test_a_robot_without_gear_ratios_is_told_the_options(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    task = tmp_path / "task.yaml"
    urdf = pendulum(tmp_path).name
    task.write_text(
        f"name: swing\nrobot: {{source: {tmp_path / urdf}.urdf}}\npoints: [{{joints: [0]}}, {{joints: [1]}}]\n"
        "times: [0, 1]\nprofiles: [quintic]\n"
    )
    code, _, err = ask(capsys, str(task))
    assert code == 2
    assert "joint 'swing': its gear ratio is not known" in err
    assert "or in a drives file: [joints.swing.gearbox] ratio, or choose drives: --catalogue FILE" in err


def test_a_robot_that_is_only_a_urdf_takes_its_drives_from_one_file(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Its gear ratios could be told in an actuator file alone, whose form is the robot's maker's."""
    urdf = tmp_path / f"{pendulum(tmp_path).name}.urdf"
    values = {
        "motor": {"rotor_inertia": 1e-4, "peak_torque": 1.0, "continuous_torque": 0.4, "max_speed": 300.0},
        "gearbox": {"ratio": 50.0, "efficiency": 0.8, "max_average_torque": 30.0, "max_repeated_torque": 60.0},
    }
    lines = ["schema = 1", 'robot = "pendulum"']
    for part, entries in values.items():
        lines += [f"[joints.swing.{part}]", *(f'{k} = {{ value = {v}, source = "test" }}' for k, v in entries.items())]
    drives, task = tmp_path / "drives.toml", tmp_path / "task.yaml"
    drives.write_text("\n".join(lines), encoding="utf-8")
    task.write_text(
        f"name: swing\nrobot: {{source: {urdf}}}\npoints: [{{joints: [0]}}, {{joints: [1]}}]\n"
        "times: [0, 1]\nprofiles: [quintic]\n"
    )
    code, out, _ = ask(capsys, str(task), "--drives", str(drives))
    assert code == 0
    # 2 kg at 0.5 m held at 1 rad: 2 * 9.81 * 0.5 * sin(1) = 8.25 N m, and its inertia on the way.
    assert "strong enough; governing limit: swing" in " ".join(out.split())
    assert "Not known of the least that decides a drive" not in out


def lift(folder: Path) -> str:
    """A sliding joint, and a task that lifts 2 kg by it."""
    pendulum(folder, kind="prismatic")
    task = folder / "lift.yaml"
    task.write_text(
        "name: lift\nrobot: {source: pendulum.urdf}\npoints:\n"
        "  - {name: a, joints: [0.0]}\n  - {name: b, joints: [0.3]}\ntimes: [0, 1]\nprofiles: [quintic]\n",
        encoding="utf-8",
    )
    return str(task)


def test_the_stage_of_a_sliding_joint_and_brakes_are_options(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Without Python nothing could be chosen for a sliding joint."""
    task = lift(tmp_path)
    code, _, err = ask(capsys, task, "--catalogue", "example")
    assert code == 2
    assert "joint 'swing' slides" in err
    stage = "swing:kind=screw,travel_per_turn=0.5,efficiency=0.9,max_force=500"
    more = ["--with-brake", "--emergency-stops", "50", "--peak-regenerated-power", "90", "--format", "json"]
    code, out, _ = ask(capsys, task, "--catalogue", "example", "--stage", stage, *more)
    assert code == 0
    document = json.loads(out)
    assert document["conditions"]["stages"] == {"swing": "screw, travel_per_turn 0.5, efficiency 0.9, max_force 500"}
    assert document["conditions"]["with_brake"] is True
    checks = {check["quantity"]: check for check in document["sizing"]["joints"][0]["checks"]}
    assert checks["stage force"]["limit"] == 500
    assert "holding brake wear: needs" in " ".join(document["sizing"]["not_assessed"])
    drives = tmp_path / "drives.toml"
    drives.write_text(
        'schema = 1\nrobot = "pendulum"\n[joints.swing.stage]\nkind = {value = "screw", source = "sheet"}\n'
        'travel_per_turn = {value = 0.5, source = "sheet"}\n',
        encoding="utf-8",
    )
    assert ask(capsys, task, "--catalogue", "example", "--drives", str(drives))[0] == 0
    for faulty, message in (
        ("swing:kind=cam,travel_per_turn=1", "stages.swing.kind: expected 'screw', 'rack' or 'belt', got 'cam'"),
        ("arm:kind=screw,travel_per_turn=1", "joint of stages"),
        ("swing", "'swing' is not JOINT:KEY=VALUE,..."),
    ):
        code, _, err = ask(capsys, task, "--catalogue", "example", "--stage", faulty)
        assert code == 2
        assert message in err


def test_a_shared_supply_beside_a_catalogue(capsys: pytest.CaptureFixture[str]) -> None:
    """The table of conditions took the supply's name for a number: exit code 70."""
    code, out, _ = ask(capsys, "--catalogue", "example", "--keep", "1", "--supply-power", "1000", "-v")
    assert code == 0
    assert "supply " in out
    assert "a shared bus" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["--catalogue", "a.csv"],
            "--catalogue a.csv: this file does not exist; expected one of example, puma560, or two or three CSV files",
        ),
        (["--catalogue", "none.csv", "none.csv"], "none.csv: this catalogue does not exist"),
        (["--catalogue", "example", "--keep", "0"], "--keep: '0' is not a whole number from 1"),
        (["--keep", "2", "--masses", "at"], "--keep, --masses goes with --catalogue: name the parts to choose from"),
        (["--catalogue", "example", "--drives", "none.toml"], "none.toml: this drives file does not exist"),
        (["--drives", "none.toml"], "none.toml: this drives file does not exist"),
        (["--rank", "price"], "invalid choice: 'price'"),
    ],
)
def test_refused(capsys: pytest.CaptureFixture[str], arguments: list[str], message: str) -> None:
    code, out, err = ask(capsys, *arguments)
    assert code == 2
    assert out == ""
    assert message in err
    assert err.count("\n") == 1


def test_help_loads_no_library() -> None:
    """The help of this command, too, is there at once."""
    script = "import sys; from puma_septic.cli import main; main(['size', '--help']); print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.endswith("False\n")
    assert "--catalogue" in done.stdout


@pytest.mark.parametrize("command", [["assess"], ["compare", "--profile", "quintic"], ["size"]])
def test_a_task_in_degrees_is_questioned_by_every_command(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Points of 90 "rad" were assessed, compared and sized for, and the unit was not questioned."""
    task = tmp_path / "degrees.yaml"
    task.write_text(
        "name: degrees\npoints:\n"
        "  - {name: a, joints: [0, 45, -90, 0, 10, 0]}\n  - {name: b, joints: [90, 30, -80, 10, 20, 0]}\n"
        "times: [0, 2]\nprofiles: [quintic]\n",
        encoding="utf-8",
    )
    assert main([command[0], str(task), *command[1:]]) == 3
    assert "points in degrees? joint1 reaches 90 rad" in " ".join(capsys.readouterr().out.split())


def test_an_open_question_is_no_verdict_of_a_sizing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With exit code 3 for points in degrees, the document said `is_feasible` and "strong enough"."""
    task = tmp_path / "degrees.yaml"
    task.write_text(
        "name: degrees\nrobot: {source: puma560}\npoints:\n  - {joints: [0, 40, -130, 0, 10, 0]}\n"
        "  - {joints: [20, 40, -130, 0, 10, 0]}\ntimes: [0, 400]\nprofiles: [quintic]\n"
    )
    code, out, _ = ask(capsys, str(task), "--format", "json")
    document = json.loads(out)
    assert (code, document["is_feasible"]) == (3, False)
    assert document["verdict"].startswith("undecided; else strong enough as far as is known")
    assert document["undecided"][0].startswith("points in degrees? joint3 reaches 130 rad")
