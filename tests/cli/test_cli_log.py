"""``puma-septic assess --csv``: motions that were logged or planned elsewhere."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from helpers.urdf_texts import ARM
from numpy.typing import NDArray

import puma_septic as ps
from puma_septic.cli import main

JOINTS = [f"joint{k}" for k in range(1, 7)]
START = [0.0, 0.5, -2.5, 0.0, 0.7, 0.0]
END = [0.3, 0.7, -2.4, -0.1, 0.9, 0.3]
MOVE = ps.profiles.classic_septic([START, END], [0.0, 2.0])


def rows(n: int = 41, noise: float = 0.0) -> NDArray[np.float64]:
    """Samples of a septic from rest to rest."""
    t = np.linspace(0.0, 2.0, n)
    q = MOVE(t) + noise * np.random.default_rng(0).standard_normal((n, 6))
    return np.column_stack([t, q])


def written(path: Path, table: Sequence[Sequence[object]], header: Sequence[str] = ("t", *JOINTS)) -> str:
    lines = [",".join(header), *(",".join(map(str, row)) for row in table)]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def test_a_log_is_assessed_as_the_motion_that_it_samples(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path / "log.csv", rows().tolist())
    assert main(["assess", "--csv", path, "--dwell", "1", "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "puma-septic/assess-log/1"
    assert document["rows"] == 41
    assert max(document["residual"]["max"]) < 1e-13  # interpolated
    expected = ps.assess(ps.load_robot(), MOVE, dwell=1.0)
    for j, joint in enumerate(document["assessment"]["joints"]):
        # A quintic spline through samples 0.05 s apart: its error goes with the sixth power of the step.
        assert joint["rms_torque"] == pytest.approx(expected.rms_torque[j], rel=1e-5)
        assert joint["peak_velocity"] == pytest.approx(expected.peak_velocity[j], rel=1e-5)


def test_the_text_tells_file_rows_and_residual(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path / "log.csv", rows(101, noise=1e-4).tolist())
    assert main(["assess", "--csv", path, "--smoothing", "1.2e-4"]) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert "101 rows from 0 s to 2 s, smoothed by the least-squares quintic spline" in words
    assert "Largest residual: 0.0004" in words  # four standard deviations in 606 samples
    assert "Verdict: feasible" in words


TURNTABLE = """<robot name="turntable"><link name="base"/><joint name="table" type="continuous"><parent link="base"/>
<child link="disc"/><axis xyz="0 0 1"/><limit effort="40" velocity="3"/></joint><link name="disc"><inertial>
<origin xyz="0.1 0 0"/><mass value="5"/><inertia ixx="0.05" iyy="0.05" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
</link></robot>"""


def test_an_encoder_that_wraps_is_no_motion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The jump by a turn of a joint that the robot knows as continuous took 1.7e6 N m and 7426 rad/s.

    By hand: 1.5 rad in 2 s by 10 s^3 - 15 s^4 + 6 s^5 peak at 15/8 * 0.75 rad/s and 10/sqrt 3 * 1.5/4 rad/s^2; the
    inertia about the axis is 0.1 + 5 * 0.1^2 kg m^2.
    """
    (tmp_path / "turntable.urdf").write_text(TURNTABLE)
    move, t = ps.quintic_segments([[2.5], [4.0]], [0, 2]), np.linspace(0, 2, 2001)
    wrapped = (move(t) + np.pi) % (2 * np.pi) - np.pi
    path = written(tmp_path / "log.csv", np.column_stack([t, wrapped]).tolist(), ["t", "table"])
    asked = ["assess", "--csv", path, "--robot", str(tmp_path / "turntable.urdf"), "--format", "json"]
    assert main(asked) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["undecided"] == []
    (joint,) = document["assessment"]["joints"]
    assert joint["peak_velocity"] == pytest.approx(15 / 8 * 0.75, rel=1e-6)
    assert joint["peak_torque"] == pytest.approx(0.15 * 10 / np.sqrt(3) * 1.5 / 4, rel=1e-6)  # 0.325 N m


def test_columns_may_come_in_any_order(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    order = [0, 3, 2, 1, 6, 5, 4]
    header = [("t", *JOINTS)[k] for k in order]
    straight = written(tmp_path / "log.csv", rows().tolist())
    mixed = written(tmp_path / "mixed.csv", rows()[:, order].tolist(), header)
    texts = []
    for path in (straight, mixed):
        assert main(["assess", "--csv", path, "--format", "csv"]) == 0
        texts.append(capsys.readouterr().out.replace(path, "FILE"))
    assert texts[0] == texts[1]


def test_any_robot_with_locked_joints_and_a_payload(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arm = tmp_path / "arm.urdf"
    arm.write_text(ARM)
    path = written(tmp_path / "log.csv", rows()[:, :2].tolist(), ["t", "shoulder"])
    arguments = ["assess", "--csv", path, "--robot", str(arm), "--lock", "elbow=0.5", "--payload", "2"]
    assert main([*arguments, "--format", "json"]) in (0, 1)
    document = json.loads(capsys.readouterr().out)
    assert document["joint_names"] == ["shoulder"]
    robot = ps.load_robot(arm, locked={"elbow": 0.5}).with_payload(ps.Payload(mass=2.0))
    times, points = rows()[:, 0], rows()[:, 1:2]
    expected = ps.assess(robot, ps.fit_trajectory(times, points, joint_names=["shoulder"]))
    assert document["assessment"] == expected.to_dict()


def test_a_margin_that_is_not_kept_is_told_and_ends_with_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path / "log.csv", rows().tolist())
    assert main(["assess", "--csv", path, "--margin", "0.5"]) == 1
    assert "not kept with 50 % to spare" in capsys.readouterr().out


@pytest.mark.slow
def test_the_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path / "log.csv", rows(201).tolist())
    out = tmp_path / "out"
    assert main(["assess", "--csv", path, "--format", "json", "--out", str(out)]) == 0
    assert json.loads((out / "assessment.json").read_text()) == json.loads(capsys.readouterr().out)
    report = (out / "report.html").read_text()
    assert "201 rows from 0 s to 2 s, interpolated by a quintic spline</li>" in report
    assert "<li>Ends: at rest at both</li>" in report
    names = {file.name for file in out.iterdir()}
    assert {"report.html", "metrics.csv", "samples.csv", "torque.svg", "torque.png"} <= names
    assert {name[:-4] for name in names if name.endswith("svg")} == {name[:-4] for name in names if name[-3:] == "png"}


def test_the_folder_without_png(tmp_path: Path) -> None:
    """``--no-png`` was accepted with ``--csv``, which never wrote PNG files."""
    path = written(tmp_path / "log.csv", rows(201).tolist())
    assert main(["assess", "--csv", path, "--no-png", "--out", str(tmp_path / "out")]) == 0
    names = {file.name for file in (tmp_path / "out").iterdir()}
    assert "torque.svg" in names
    assert not any(name.endswith("png") for name in names)


GAP = [*rows().tolist()[:10], *rows().tolist()[30:]]
TEXT = [[*row[:2], "x", *row[3:]] if k == 4 else row for k, row in enumerate(rows().tolist())]
EMPTY = [[*row[:2], "", *row[3:]] if k == 4 else row for k, row in enumerate(rows().tolist())]
TWICE = [*rows().tolist()[:5], [*rows().tolist()[4][:1], *rows().tolist()[5][1:]], *rows().tolist()[5:]]


@pytest.mark.parametrize(
    ("table", "header", "message"),
    [
        (GAP, JOINTS, r"nothing between t = 0.45 s and 1.5 s, where rows are mostly 0.05 s apart; --max-gap 1.07"),
        (TWICE, JOINTS, "row 7, column 't': 0.2 s does not come after 0.2 s in row 6"),
        (TEXT, JOINTS, "row 6, column 'joint2': 'x' is not a finite number"),
        (EMPTY, JOINTS, "row 6, column 'joint2': the value is missing"),
        (
            rows().tolist(),
            [*JOINTS[:5], "wrist"],
            "no column for joint 'joint6'; the columns are 't', 'joint1', 'joint2', 'joint3', 'joint4', 'joint5', 'wri",
        ),
        (rows()[:, :6].tolist(), JOINTS[:5], "no column for joint 'joint6'; the columns are"),
        (rows().tolist()[:1], JOINTS, "1 rows of samples; at least two are needed"),
    ],
)
def test_bad_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], table: list[list[object]], header: list[str], message: str
) -> None:
    path = written(tmp_path / "log.csv", table, ["t", *header])
    assert main(["assess", "--csv", path]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert message in err


def test_a_gap_that_is_meant_is_allowed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path / "log.csv", GAP)
    assert main(["assess", "--csv", path, "--max-gap", "1.07"]) == 3
    out = capsys.readouterr().out
    assert "21 rows" in out
    assert "undecided: samples: between them the acceleration of joint 'joint3' is known only to" in " ".join(
        out.split()
    )
    assert main(["assess", "--csv", path, "--max-gap", "1"]) == 2
    assert "a gap of 1.05 s since row 11 is longer than max_gap = 1 s" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["paper", "--csv", "FILE"], "TASK does not go with --csv"),
        (["--csv", "FILE", "--profile", "septic"], "--profile does not go with --csv"),
        (["--csv", "FILE", "--branch", "auto"], "--branch does not go with --csv"),
        (["--smoothing", "1e-3"], "--smoothing goes with --csv"),
        (["--max-gap", "1"], "--max-gap goes with --csv"),
        (["--units", "deg"], "--units goes with --csv"),
        (["--csv", "FILE", "--no-png"], "--no-png goes with --out"),
        (["--csv", "FILE", "--columns", "time"], "argument --columns: 'time' is not NAME=COLUMN,..."),
        (["--csv", "FILE", "--smoothing", "0"], "argument --smoothing: 0 is not positive"),
        (["--lock", "joint6"], "argument --lock: 'joint6' is not JOINT=POSITION"),
        (["--csv", "nowhere.csv"], "nowhere.csv: this CSV file does not exist"),
    ],
)
def test_arguments_that_do_not_fit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    path = written(tmp_path / "log.csv", rows().tolist())
    assert main(["assess", *(path if text == "FILE" else text for text in arguments)]) == 2
    assert message in capsys.readouterr().err


# ---- what a log leaves open, and other commands


def noisy(path: Path) -> str:
    return written(path, rows(401, noise=1e-5).tolist())


def test_noise_leaves_the_verdict_open_until_it_is_smoothed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It was answered with a verdict on torques up to 300 times too large, and a largest residual of 1e-15."""
    path = noisy(tmp_path / "log.csv")
    assert main(["assess", "--csv", path]) == 3
    out = " ".join(capsys.readouterr().out.split())
    assert "Verdict: undecided: noise: the peak torque of joint 'joint1' is between" in out
    assert "Noise of a sample: " in out
    assert ": feasible" not in out
    assert main(["assess", "--csv", path, "--smoothing", "auto"]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "smoothed by the quintic spline of greatest restricted likelihood, 200 intervals" in out
    assert "Peak torque within (95 %): joint1 " in out
    assert "Verdict: feasible" in out


def test_the_document_tells_what_was_decided(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = noisy(tmp_path / "log.csv")
    assert main(["assess", "--csv", path, "--smoothing", "auto", "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["noise"] == pytest.approx([1e-5] * 6, rel=0.15)
    assert document["undecided"] == document["assessment"]["undecided"] == []
    assert (document["rest_before"], document["rest_after"]) == (True, True)
    band, joints = document["band"]["peak_torque"], document["assessment"]["joints"]
    for least, joint, greatest in zip(band["least"], joints, band["greatest"], strict=True):
        assert least < joint["peak_torque"] < greatest
    assert document["measured"] == []


def test_columns_units_and_repeated_stamps(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = rows(41)
    table[:, 0] *= 1000
    table[:, 1:] = np.degrees(table[:, 1:])
    table = np.vstack([table[:1], table])
    path = written(tmp_path / "log.csv", table.tolist(), ["stamp", *(f"q{k}" for k in range(1, 7))])
    columns = ",".join(["time=stamp", *(f"joint{k}=q{k}" for k in range(1, 7))])
    asked = ["assess", "--csv", path, "--columns", columns, "--units", "ms,deg", "--repeated", "average"]
    assert main([*asked, "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    expected = ps.assess(ps.load_robot(), MOVE)
    assert document["assessment"]["duration"] == pytest.approx(2.0)
    assert document["assessment"]["joints"][1]["peak_torque"] == pytest.approx(expected.peak_torque[1], rel=1e-4)
    assert document["read"] == ["1 rows repeat a stamp: averaged"]


def test_degrees_are_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = rows(401)
    table[:, 1:] = np.degrees(table[:, 1:])
    assert main(["assess", "--csv", written(tmp_path / "log.csv", table.tolist())]) == 3
    assert "degrees? joint 'joint3' reaches 143.2" in " ".join(capsys.readouterr().out.split())


@pytest.mark.slow
def test_nine_decimals_at_1_khz_are_decided_by_their_band(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Their jerk is mostly noise, their torque right to 0.1 %: a limit beyond the band is kept or broken for sure."""
    table = rows(2001)
    table[:, 1:] = table[:, 1:].round(9)
    path = written(tmp_path / "log.csv", table.tolist())
    assert main(["assess", "--csv", path, "-v"]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "Peak torque within (95 %): joint1 " in out
    assert "noise: the jerk is mostly noise" in out  # beside the verdict
    assert main(["assess", "--csv", path, "--format", "json"]) == 0
    band = json.loads(capsys.readouterr().out)["band"]["peak_torque"]
    right = ps.assess(ps.load_robot(), MOVE).peak_torque
    assert all(low <= value <= high for low, value, high in zip(band["least"], right, band["greatest"], strict=True))


def test_an_excerpt_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path / "log.csv", rows(401).tolist()[100:300])
    assert main(["assess", "--csv", path]) == 0
    assert "Ends: moving at both: an excerpt" in capsys.readouterr().out
    assert main(["assess", "--csv", path, "--dwell", "1"]) == 2
    assert "the motion ends moving (rest_after=False), so no rest can follow it" in capsys.readouterr().err


def test_measured_torques_are_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot = ps.load_robot().with_payload(ps.Payload(mass=1.0))
    t = np.linspace(0.0, 2.0, 201)
    torque = ps.compute_motion(robot, MOVE).torque(t)
    header = ["t", *JOINTS, *(f"{name}_torque" for name in JOINTS)]
    path = written(tmp_path / "log.csv", np.column_stack([t, MOVE(t), torque]).tolist(), header)
    assert main(["assess", "--csv", path]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "Measured effort [N m], RMS of what is left as computed, and with the proposals: joint1 " in out
    assert "payload mass: " in out


@pytest.mark.parametrize("name", ["compare", "size"])
@pytest.mark.slow
def test_other_commands_take_a_log(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    path = written(tmp_path / "log.csv", rows(101).tolist())
    assert main([name, "--csv", path, *(["--profile", "quintic"] if name == "compare" else [])]) in (0, 1)
    out = " ".join(capsys.readouterr().out.split())
    assert "101 rows from 0 s to 2 s, interpolated by a quintic spline" in out
    assert ("recorded" if name == "compare" else "The cycle is the recorded motion alone: move 2 s") in out
    noise = noisy(tmp_path / "noisy.csv")
    assert main([name, "--csv", noise, *(["--profile", "quintic"] if name == "compare" else [])]) == 3
    assert "ndecided" in capsys.readouterr().out


@pytest.mark.slow
def test_a_log_is_replayed_into_a_small_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Every sample was a key frame and a marked point: 36 MB of report for 3.6 s."""
    path = written(tmp_path / "log.csv", rows(3001).tolist())
    page = tmp_path / "replay.html"
    assert main(["replay", "--csv", path, "--html", str(page)]) == 0
    capsys.readouterr()
    out = tmp_path / "out"
    assert main(["assess", "--csv", path, "--out", str(out), "--no-png"]) == 0
    assert page.stat().st_size < 4e6
    assert (out / "report.html").stat().st_size < 6e6
    assert (out / "samples.csv").stat().st_size < 1e6


@pytest.mark.slow
def test_samples_of_an_assessment_go_in_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["assess", "paper-turned", "--profile", "quintic_segments", "--out", str(out), "--no-png"]) == 0
    capsys.readouterr()
    samples = out / "paper-turned" / "samples-quintic_segments.csv"
    assert main(["assess", "--csv", str(samples), "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["undecided"] == []
