"""Documents, CSV tables and folders."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import puma_septic as ps
from puma_septic.assessment import Assessment
from puma_septic.report import (
    assess_document,
    metrics_csv,
    new_folder,
    profile_labels,
    samples_csv,
    to_json,
)
from puma_septic.report.figures import save_figure
from puma_septic.task import ResolvedTask, assess_task, load_task, make_task, resolve_task

Assessed = tuple[ResolvedTask, tuple[Assessment, ...]]


def no_constant(name: str) -> float:
    raise AssertionError(f"{name} is not JSON")


# ---- the document


def test_the_document_is_json_with_all_digits(paper_task: Assessed) -> None:
    document = json.loads(to_json(assess_document([paper_task])), parse_constant=no_constant)
    assert document["schema"] == "puma-septic/assess/1"
    assert document["version"] == ps.__version__
    joints = document["tasks"][0]["assessments"][0]["joints"]
    assert [joint["peak_torque"] for joint in joints] == paper_task[1][0].peak_torque.tolist()
    assert document["tasks"][0]["points"] == paper_task[0].points.tolist()


def test_the_document_repeats_the_run(paper_task: Assessed) -> None:
    document = assess_document([paper_task])
    again = resolve_task(make_task(document["tasks"][0]["task"], origin=document["tasks"][0]["origin"]))
    assert assess_document([(again, assess_task(again))]) == document


def test_the_document_says_which_limits_every_branch_breaks(paper_task: Assessed) -> None:
    task = assess_document([paper_task])["tasks"][0]
    assert task["broken_in_all_branches"] == [
        {"joint": "joint5", "point": "take"},
        {"joint": "joint5", "point": "place"},
    ]
    assert [branch["is_within_limits"] for branch in task["branches"]] == [False] * 8


def test_an_unbounded_jerk_is_told_in_words() -> None:
    """Without blends the velocity steps, so that acceleration, jerk and torque are unbounded."""
    document = load_task("paper").document()
    task = make_task({**document, "profiles": [{"name": "lspb", "blend_time": 0.0}]})
    resolved = resolve_task(task)
    text = to_json(assess_document([(resolved, assess_task(resolved))]))
    joint = json.loads(text, parse_constant=no_constant)["tasks"][0]["assessments"][0]["joints"][0]
    assert joint["peak_jerk"] == "unbounded"


def test_a_profile_that_occurs_twice_is_numbered() -> None:
    document = load_task("paper").document()
    profiles = ["septic", {"name": "lspb", "blend_time": 1.0}, {"name": "lspb", "blend_time": 0.5}]
    assessments = assess_task(make_task({**document, "profiles": profiles}))
    assert profile_labels(assessments) == ["septic", "lspb-1", "lspb-2"]


# ---- CSV


def table(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_metrics_have_a_row_for_each_profile_and_joint(paper_task: Assessed) -> None:
    rows = table(metrics_csv([paper_task, paper_task]))
    assert len(rows) == 2 * 3 * 6
    assert rows[0]["task"] == "paper"
    assert [float(row["rms_torque"]) for row in rows[6:12]] == paper_task[1][1].rms_torque.tolist()
    assert float(rows[4]["margin position"]) == paper_task[1][0].margins["position"][4]
    assert rows[0]["margin jerk"] == ""  # no jerk limit is known


def test_samples_are_the_functions_values(paper_task: Assessed) -> None:
    assessment = paper_task[1][1]
    rows = table(samples_csv(assessment))
    times = np.array([float(row["t [s]"]) for row in rows])
    inside = np.array([row["side"] == "" for row in rows])
    for header, function in (
        ("position joint2 [rad]", assessment.motion.trajectory.derivative(0)),
        ("jerk joint2 [rad/s^3]", assessment.motion.trajectory.derivative(3)),
        ("torque joint2 [N m]", assessment.motion.torque),
    ):
        values = np.array([float(row[header]) for row in rows])
        largest = np.abs(values).max()
        # Split at more breaks, a series is the same but for rounding.
        np.testing.assert_allclose(values[inside], function(times[inside])[:, 1], atol=1e-11 * largest)


def test_samples_show_both_sides_of_a_step(paper_task: Assessed) -> None:
    """mstraj's jerk steps by 6 dv / tacc^2 where a blend begins (here at 1.5 s; joint 2 goes on at 0 after 2.5 s)."""
    assessment = paper_task[1][1]
    rows = table(samples_csv(assessment))
    at = [row for row in rows if row["t [s]"] == "1.5"]
    assert [row["side"] for row in at] == ["left", "right"]
    before, after = (float(row["jerk joint2 [rad/s^3]"]) for row in at)
    first, second = (paper_task[0].points[k + 1, 1] - paper_task[0].points[k, 1] for k in range(2))
    step = 6 * (second / 4.0 - first / 2.0) / 1.0**2
    assert before == pytest.approx(0.0, abs=1e-9)
    assert after == pytest.approx(step, rel=1e-9)


def test_samples_begin_and_end_with_the_motion(paper_task: Assessed) -> None:
    rows = table(samples_csv(paper_task[1][0]))
    assert (rows[0]["t [s]"], rows[0]["side"]) == ("0.0", "right")
    assert (rows[-1]["t [s]"], rows[-1]["side"]) == ("9.0", "left")


def test_a_name_does_not_become_a_formula() -> None:
    """Spreadsheets run a cell that begins with = as a formula."""
    document = {**load_task("paper").document(), "name": '=HYPERLINK("x")', "profiles": ["septic"]}
    resolved = resolve_task(make_task(document))
    assert table(metrics_csv([(resolved, assess_task(resolved))]))[0]["task"] == '\'=HYPERLINK("x")'


# ---- folders


def test_a_folder_appears_when_all_is_written(tmp_path: Path) -> None:
    with new_folder(tmp_path / "results") as folder:
        (folder / "a.txt").write_text("a")
        assert not (tmp_path / "results").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["results"]
    assert (tmp_path / "results" / "a.txt").read_text() == "a"


def test_an_empty_folder_may_be_filled(tmp_path: Path) -> None:
    (tmp_path / "results").mkdir()
    with new_folder(tmp_path / "results") as folder:
        (folder / "a.txt").write_text("a")
    assert (tmp_path / "results" / "a.txt").is_file()


@pytest.mark.parametrize("error", [ValueError("bad"), KeyboardInterrupt()])
def test_nothing_is_left_after_an_exception(tmp_path: Path, error: BaseException) -> None:
    with pytest.raises(type(error)):
        _fail_inside(tmp_path / "results", error)
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_told(tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match=r"cannot write the folder .*results: No space left on device"):
        _fail_inside(tmp_path / "results", OSError(28, "No space left on device"))
    assert list(tmp_path.iterdir()) == []


def _fail_inside(path: Path, error: BaseException) -> None:
    with new_folder(path) as folder:
        (folder / "a.txt").write_text("a")
        raise error


def test_what_is_there_is_never_overwritten(tmp_path: Path) -> None:
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "mine.txt").write_text("mine")
    with pytest.raises(ps.InputError, match="results is not empty; nothing in it is overwritten"):
        new_folder(tmp_path / "results").__enter__()
    assert (tmp_path / "results" / "mine.txt").read_text() == "mine"


def test_a_folder_that_is_filled_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    folder = new_folder(tmp_path / "results")
    (folder.__enter__() / "a.txt").write_text("a")
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "mine.txt").write_text("mine")
    with pytest.raises(ps.InputError, match="cannot write the folder"):
        folder.__exit__(None, None, None)
    assert [path.name for path in tmp_path.rglob("*")] == ["results", "mine.txt"]


def test_a_folder_that_cannot_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(ps.InputError, match=r"cannot write the folder .*: Permission denied"):
        new_folder(tmp_path / "results").__enter__()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("file", "file is a file; name a folder that does not exist yet"),
        ("file/results", "cannot write the folder"),
        ("missing/results", "missing is not a folder"),
        ("x" * 300, "cannot write the folder"),
        ("a\0b", "cannot write the folder"),
    ],
)
def test_a_path_that_is_no_folder(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ps.InputError, match=message):
        new_folder(tmp_path / name).__enter__()


# ---- figures


def test_the_same_figure_is_the_same_bytes(tmp_path: Path) -> None:
    """matplotlib writes the date and random names unless told not to."""
    written = []
    for name in ("a", "b"):
        figure = Figure(layout="constrained")
        figure.add_subplot(title="x").plot([0, 1], [0, 1])
        (tmp_path / name).mkdir()
        save_figure(figure, tmp_path / name / "f")
        written.append([(tmp_path / name / f"f.{kind}").read_bytes() for kind in ("png", "svg")])
    assert written[0] == written[1]
