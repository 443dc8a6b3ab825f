"""CSV files as loggers write them: columns, units, separators, clocks, repeated stamps."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from helpers.urdf_texts import ARM

import puma_septic as ps
from puma_septic.errors import InputError
from puma_septic.logs import JointLog, read_log
from puma_septic.report import samples_csv

JOINTS = ("shoulder", "elbow")
ROWS = [[0.0, 0.0, 1.0], [0.01, 0.25, 0.75], [0.02, 0.5, 0.5], [0.03, 1.0, 0.25]]


@pytest.fixture
def arm(tmp_path: Path) -> ps.Robot:
    """Two joints, `shoulder` and `elbow`."""
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    return ps.load_robot(path)


def plain(separator: str = ",", header: str = "t,shoulder,elbow") -> str:
    lines = [separator.join(header.split(",")), *(separator.join(f"{x:g}" for x in row) for row in ROWS)]
    return "\n".join(lines) + "\n"


def turned(change: Callable[[str], str], header: str = "t,shoulder,elbow", separator: str = ",") -> str:
    head, *rows = plain(separator, header).splitlines()
    return "\n".join([head, *map(change, rows)]) + "\n"


@pytest.fixture
def read(tmp_path: Path, arm: ps.Robot) -> Callable[..., JointLog]:
    def reading(text: str | bytes, **options: object) -> JointLog:
        path = tmp_path / "log.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_log(path, arm, **options)  # type: ignore[arg-type]

    return reading


@pytest.mark.parametrize(
    "text",
    [
        plain(),
        plain(";"),
        plain("\t"),
        plain(" "),
        plain(header="time,shoulder,elbow"),
        plain(header="timestamp,shoulder_pos,elbow_pos"),
        plain(header="t [s],position shoulder [rad],position elbow [rad]"),
        plain(header="stamp_s,shoulder (rad),elbow (rad)"),
        turned(lambda row: row.replace(".", ","), separator=";"),
        turned(lambda row: f"{row},", header="t,shoulder,elbow,"),
        turned(lambda row: f"{row},"),
        turned(lambda row: f"{row},2,idle", header="t,shoulder,elbow,mode,state"),
        turned(lambda row: f"7,{row}", header=",t,shoulder,elbow"),  # the index that pandas writes
        "# recorded\n" + plain() + "% end\n",
        plain().replace("\n0.02", "\n\n0.02"),
        plain().replace("elbow\n", "elbow\ns,rad,rad\n"),
        plain().replace(",", ", "),
        plain().replace("\n", "\r\n"),
        plain().replace("\n", "\r"),
        b"\xef\xbb\xbf" + plain().encode(),
    ],
)
def test_what_loggers_write_is_read(read: Callable[..., JointLog], text: str | bytes) -> None:
    """Other time names, separators, decimal commas, comments, unit rows, extra columns, empty lines were refused."""
    log = read(text)
    assert log.joint_names == JOINTS
    assert np.allclose(np.column_stack([log.t, log.q]), ROWS, rtol=0, atol=1e-15)


def test_what_was_decided_is_told(read: Callable[..., JointLog]) -> None:
    text = "# a\n# b\nt;shoulder;elbow;mode\n0;0,5;1;2\n\n1;1,5;1;2\n"
    assert read(text).notes == (
        "separator ';', decimal comma, 2 comment lines, 1 empty line",
        "columns not read: 'mode'",
    )


def test_columns_are_mapped_with_their_units(read: Callable[..., JointLog]) -> None:
    text = "n,stamp,q1,q2\n" + "".join(f"{k},{10 * k},{90 * k},{k}\n" for k in range(4))
    log = read(text, columns={"time": "stamp[ms]", "shoulder": "q1[deg]", "elbow": "q2"})
    assert log.t.tolist() == [0.0, 0.01, 0.02, 0.03]
    assert np.allclose(log.q[:, 0], np.arange(4) * np.pi / 2, rtol=1e-15)
    assert log.q[:, 1].tolist() == [0, 1, 2, 3]
    assert not log.units_stated  # nobody has said what q2 is in
    both = read(text, columns={"time": "stamp", "shoulder": "q1", "elbow": "q2"}, units=["ms", "deg"])
    assert both.units_stated
    assert np.allclose(both.q[:, 1], np.radians([0, 1, 2, 3]), rtol=1e-15)


def test_velocities_efforts_and_currents_are_read_where_named(read: Callable[..., JointLog]) -> None:
    header = "t,shoulder,elbow,shoulder_vel [deg/s],elbow_vel [deg/s],torque elbow,shoulder.current"
    log = read(header + "\n0,0,0,180,90,5,1\n1,1,1,180,90,6,2\n")
    assert log.velocity is not None
    assert np.allclose(log.velocity, [[np.pi, np.pi / 2]] * 2)
    assert log.effort is not None
    assert np.isnan(log.effort[:, 0]).all()
    assert log.effort[:, 1].tolist() == [5, 6]
    assert log.current is not None
    assert log.current[:, 0].tolist() == [1, 2]


def test_stamps_since_1970_keep_all_their_digits(read: Callable[..., JointLog]) -> None:
    """A float holds such stamps to 2e-7 s, 2e-4 of a step at 1 kHz."""
    start = 1_700_000_000
    seconds = "".join(f"{start}.{k:03d}456789,{k},0\n" for k in range(12))
    assert np.diff(read("t,shoulder,elbow\n" + seconds).t).tolist() == pytest.approx([1e-3] * 11, abs=1e-18)
    nanoseconds = "".join(f"{start * 10**9 + k * 10**6 + 7},{k},0\n" for k in range(12))
    log = read("t_ns,shoulder,elbow\n" + nanoseconds)
    assert np.abs(log.t - np.arange(12) * 1e-3).max() < 1e-17
    assert log.origin == "1700000000000000007"


def test_stamps_that_are_even_but_for_their_last_digit_are_even(read: Callable[..., JointLog]) -> None:
    rows = "".join(f"{k / 300:.3f},{k},0\n" for k in range(60))
    log = read("t,shoulder,elbow\n" + rows)
    assert np.ptp(np.diff(log.t)) < 1e-15
    assert log.t[1] == pytest.approx(1 / 300, rel=1e-3)
    assert log.notes[0].startswith("stamps are even but for their last digit: taken every 0.0033")


def test_a_clock_that_is_near_is_kept_and_a_far_one_counts_from_the_first_stamp(read: Callable[..., JointLog]) -> None:
    def from_start(start: str) -> JointLog:
        return read(f"t,shoulder,elbow\n{start}.0,0,0\n{start}.5,1,1\n")

    assert from_start("100").t.tolist() == [100.0, 100.5]
    assert from_start("618085129").t.tolist() == [0.0, 0.5]


def test_repeated_stamps_are_refused_or_averaged(read: Callable[..., JointLog]) -> None:
    text = "t,shoulder,elbow\n0,0,0\n0.1,1,0\n0.1,2,0\n0.2,3,0\n"
    with pytest.raises(InputError, match=r"row 4, column 't': 0.1 s does not come after 0.1 s in row 3; .* averaged"):
        read(text)
    log = read(text, repeated="average")
    assert log.t.tolist() == [0.0, 0.1, 0.2]
    assert log.q[:, 0].tolist() == [0.0, 1.5, 3.0]
    assert "1 rows repeat a stamp: averaged" in log.notes
    equal = read(text.replace("0.1,2", "0.1,1"))
    assert equal.q[:, 0].tolist() == [0.0, 1.0, 3.0]


def test_our_own_samples_read_back(tmp_path: Path) -> None:
    """`samples.csv` has two rows at each break, units in its header, and more columns than a log."""
    robot = ps.load_robot()
    move = ps.quintic_segments([[0.0] * 6, [0.5] * 6, [0.2] * 6], [0.0, 1.0, 2.0])
    assessment = ps.assess(robot, move)
    path = tmp_path / "samples.csv"
    path.write_text(samples_csv(assessment))
    log = read_log(path, robot)
    assert np.abs(log.q - move(log.t)).max() < 1e-15
    assert log.units_stated
    assert log.effort is not None
    again = ps.assess(robot, ps.fit_trajectory(log.t, log.q))
    assert again.peak_torque == pytest.approx(assessment.peak_torque, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (
            plain(header="t,shoulder,knee"),
            {},
            "row 1: no column for joint 'elbow'; the columns are",
        ),
        (plain(header="x,shoulder,elbow"), {}, r"row 1: the header must name a time \(t, time, timestamp, stamp\)"),
        (plain(header="t,shoulder,elbow [m]"), {}, "joint 'elbow' turns; its unit is rad or deg, not 'm'"),
        (plain(), {"columns": {"elbow": "q9"}}, "no column 'q9' for 'elbow'; the columns are 't', 'shoulder', 'elbow'"),
        (plain(), {"columns": {"knee": "elbow"}}, "'knee' names no joint; valid: time, shoulder, elbow"),
        (plain(), {"columns": {"elbow": "elbow[ms]"}}, "'ms' is no unit of position; valid: rad, deg, m, mm"),
        (plain(), {"repeated": "drop"}, "unknown repeated 'drop'; valid: 'refuse', 'average'"),
        (plain().replace("0.75", "1,75"), {}, "row 3 has 4 cells, the header 3"),
    ],
)
def test_faults(read: Callable[..., JointLog], text: str, options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(text, **options)
