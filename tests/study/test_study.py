"""Studies: every case as an assessment has it; folders that keep what is finished."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

import puma_septic as ps
from puma_septic.cli import main
from puma_septic.limits import stretched
from puma_septic.study import Study, _running
from puma_septic.study._evaluation import evaluated
from puma_septic.task import _scene

AXES: dict[str, Any] = {
    "profile": ["septic", "quintic_segments"],
    "duration": {"from": 6, "to": 12, "count": 4},
    "payload": [0, 1.5, 3],
}


def study_of(**changes: Any) -> Study:
    return ps.make_study({"task": "paper-turned", "axes": AXES, "chunk": 10, **changes})


def _rows(folder: Path) -> list[dict[str, Any]]:
    files = sorted((folder / "chunks").glob("*.parquet"))
    return [row for file in files for row in pq.read_table(file).to_pylist()]


def test_every_case_is_what_its_assessment_says(tmp_path: Path) -> None:
    run = ps.run_study(study_of(), tmp_path / "s", workers=1)
    rows = _rows(tmp_path / "s")
    assert (run.n_cases, run.n_computed, len(rows)) == (24, 24, 24)
    assert [row["case"] for row in rows] == list(range(24))
    document = ps.load_task("paper-turned").document()
    for row in rows[::5]:
        task = ps.Task.model_validate({**document, "profiles": [{"name": row["axis:profile"]}]})
        resolved = ps.resolve_task(task)
        move = resolved.trajectories[0]
        mass = row["axis:payload"]
        robot = resolved.robot.with_payload(ps.Payload(mass=mass) if mass else None)
        one = ps.assess(robot, stretched(move, row["axis:duration"] / move.duration))
        assert row["feasible"] == one.is_feasible
        assert [row[f"peak_torque_{j + 1}"] for j in range(6)] == pytest.approx(one.peak_torque.tolist(), rel=1e-9)
        assert [row[f"rms_torque_{j + 1}"] for j in range(6)] == pytest.approx(one.rms_torque.tolist(), rel=1e-9)
        assert row["margin_velocity"] == pytest.approx(one.margins["velocity"].min(), rel=1e-9)
        assert row["margin_jerk"] is None  # not known
        worst = max((c for c in one.checks if c.quantity != "position"), key=lambda c: c.utilisation)
        assert (row["governing_joint"], row["governing_quantity"]) == (worst.joint, worst.quantity)
        assert row["certificate"] == "resolved"
        assert row["error"] == ""


def test_a_dwell_counts_in_every_row(tmp_path: Path) -> None:
    """The rows left out the rest that the task asks for: its RMS torque, and what holds the arm."""
    axes = {"dwell": [0.0, 2.0], "duration": [8.0, 12.0], "payload": [0.0, 3.0]}
    ps.run_study(study_of(axes=axes), tmp_path / "s", workers=1)
    resolved = ps.resolve_task(ps.load_task("paper-turned"))
    move = resolved.trajectories[0]
    for row in _rows(tmp_path / "s"):
        mass = row["axis:payload"]
        robot = resolved.robot.with_payload(ps.Payload(mass=mass) if mass else None)
        one = ps.assess(robot, stretched(move, row["axis:duration"] / move.duration), dwell=row["axis:dwell"])
        assert [row[f"rms_torque_{j + 1}"] for j in range(6)] == pytest.approx(one.rms_torque.tolist(), rel=1e-9)
        assert [row[f"peak_torque_{j + 1}"] for j in range(6)] == pytest.approx(one.peak_torque.tolist(), rel=1e-9)


def test_what_is_finished_is_neither_computed_nor_written_again(tmp_path: Path) -> None:
    folder = tmp_path / "s"
    ps.run_study(study_of(), folder, workers=1)
    whole = _rows(folder)
    kept = {file: file.stat().st_mtime_ns for file in (folder / "chunks").iterdir()}
    (missing,) = (folder / "chunks").glob("00000001-*.parquet")
    missing.unlink()
    (folder / "chunks" / ".puma-septic-01234567.part").write_bytes(b"half")  # as a killed run leaves it
    told: list[tuple[int, int]] = []
    run = ps.run_study(study_of(), folder, workers=1, progress=lambda done, total: told.append((done, total)))
    assert run.n_computed == 10
    assert told == [(14, 24), (24, 24)]
    assert _rows(folder) == whole
    assert sorted((folder / "chunks").iterdir()) == sorted(kept)
    for file, when in kept.items():
        assert (file.stat().st_mtime_ns == when) == (file != missing)
    assert ps.run_study(study_of(), folder, workers=1).n_computed == 0


@pytest.mark.slow
def test_processes_give_the_same_table(tmp_path: Path) -> None:
    ps.run_study(study_of(), tmp_path / "one", workers=1)
    ps.run_study(study_of(), tmp_path / "two", workers=2)
    assert _rows(tmp_path / "one") == _rows(tmp_path / "two")


def test_a_robot_is_loaded_once_for_all_shapes_that_share_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """It took half of the time of a shape; another set of parameters or a payload in the task is another robot."""
    loads: list[str] = []

    def counted(source: str, **options: Any) -> ps.Robot:
        loads.append(str(options["parameters"]))
        return ps.load_robot(source, **options)

    axes = {"points.place.position.0": [0.45, 0.5], "robot.parameters": ["rtb", "akb"], "payload": [0, 2]}
    study = study_of(axes=axes)
    alone = [evaluated(study, np.array([k]), 6) for k in range(study.n_cases)]
    monkeypatch.setattr(_scene, "load_robot", counted)
    together = evaluated(study, np.arange(study.n_cases), 6)
    assert loads == ["rtb", "akb"]
    assert len(set(together["peak_torque_2"].round(6))) == study.n_cases
    for name, values in together.items():
        np.testing.assert_array_equal(values, np.concatenate([one[name] for one in alone]), err_msg=name)


def test_a_failing_case_is_a_row_with_its_error(tmp_path: Path) -> None:
    axes = {"points.place.position.0": [0.5, 5.0], "duration": [9, 10]}
    ps.run_study(study_of(axes=axes), tmp_path / "s", workers=1)
    rows = _rows(tmp_path / "s")
    assert [row["error"] == "" for row in rows] == [True, True, False, False]
    assert "out of reach" in rows[2]["error"]
    assert rows[2]["feasible"] is None
    assert rows[2]["peak_torque_1"] is None
    summary = ps.summarise_study(tmp_path / "s")
    assert (summary.n_done, summary.n_failed, summary.n_feasible) == (4, 2, 2)
    assert summary.errors[0][1] == 2
    assert "failed, 2 cases: " in str(summary)


def test_a_hypercube_has_each_stratum_once_and_a_list_its_cases(tmp_path: Path) -> None:
    """Law of the Latin hypercube: of n cases each of n equal parts of an axis holds one."""
    axes = {"duration": {"from": 6.0, "to": 12.0}, "payload": {"from": 0.0, "to": 2.0}, "profile": ["septic", "lspb"]}
    drawn = study_of(axes=axes, sampling={"latin_hypercube": 20, "seed": 3})
    ps.run_study(drawn, tmp_path / "s", workers=1)
    rows = _rows(tmp_path / "s")
    assert sorted(math.floor((row["axis:duration"] - 6) / 6 * 20) for row in rows) == list(range(20))
    assert sorted(row["axis:profile"] for row in rows) == ["lspb"] * 10 + ["septic"] * 10
    again = study_of(axes=axes, sampling={"latin_hypercube": 20, "seed": 3})
    assert again.digest == drawn.digest
    assert study_of(axes=axes, sampling={"latin_hypercube": 20, "seed": 4}).digest != drawn.digest
    listed = study_of(sampling="list", cases=[{"duration": 8, "payload": 1}, {"duration": 9, "payload": 0}])
    ps.run_study(listed, tmp_path / "l", workers=1)
    assert [(row["axis:duration"], row["axis:payload"]) for row in _rows(tmp_path / "l")] == [(8, 1), (9, 0)]


def test_another_study_and_another_run_are_refused(tmp_path: Path) -> None:
    folder = tmp_path / "s"
    ps.run_study(study_of(), folder, workers=1)
    with pytest.raises(ps.InputError, match=r"holds another study \(axes, n_cases differ\)"):
        ps.run_study(study_of(axes={"duration": [8, 9]}), folder, workers=1)
    tried: list[str] = []

    def meanwhile(_done: int, _total: int) -> None:
        with pytest.raises(ps.InputError, match="another run is at work on this study") as error:
            ps.run_study(study_of(), folder, workers=1)
        tried.append(str(error.value))

    ps.run_study(study_of(), folder, workers=1, progress=meanwhile)
    assert tried


def test_a_flipped_bit_is_found_and_the_rest_is_kept(tmp_path: Path) -> None:
    """Parquet's checksums are of its pages: of 404 flips in a footer 14 went unseen, and a column had another name."""
    folder = tmp_path / "s"
    ps.run_study(study_of(), folder, workers=1)
    whole = _rows(folder)
    damaged = next((folder / "chunks").glob("00000000-*.parquet"))
    data = damaged.read_bytes()
    places = {"page": len(data) // 3, "name of a column": data.rindex(b"peak_torque_3"), "end": len(data) - 1}
    for place in places.values():
        damaged.write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :])
        for asked in (lambda: ps.run_study(study_of(), folder, workers=1), lambda: ps.summarise_study(folder)):
            with pytest.raises(
                ps.InputError,
                match=r"00000000-\w{8}\.parquet: this chunk is damaged \(its .* name\); delete .* others are kept",
            ):
                asked()
    damaged.unlink()
    assert ps.run_study(study_of(), folder, workers=1).n_computed == 10
    assert _rows(folder) == whole


def test_the_definition_is_on_the_disk_before_it_has_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """After a loss of power an empty definition would stand there, and the study could neither go on nor begin."""
    seen, real = list[str](), os.fsync

    def fsync(handle: int) -> None:
        seen.append("named" if (tmp_path / "s" / "study.json").exists() else "hidden")
        real(handle)

    monkeypatch.setattr(os, "fsync", fsync)
    ps.run_study(study_of(), tmp_path / "s", workers=1)
    assert seen[0] == "hidden"


def test_a_place_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ps.InputError, match="cannot write the study's folder"):
        ps.run_study(study_of(), tmp_path / "file" / "s", workers=1)


FULL = """
import resource, sys
import puma_septic as ps
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]),) * 2)
axes = {"duration": [8, 9], "payload": {"from": 0, "to": 1, "count": 400}}
study = ps.make_study({"task": "paper-turned", "axes": axes, "columns": ["peaks"]})
try:
    ps.run_study(study, sys.argv[1], workers=1)
except ps.InputError as error:
    print(error)
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "told"), [(500, "study.json': cannot be written: "), (20000, ".parquet': cannot be written: ")]
)
def test_a_full_disk_is_an_error_and_leaves_nothing_half(tmp_path: Path, size: int, told: str) -> None:
    """A limit on the size of files stands for the disk: the system refuses the bytes beyond it in the same way."""
    command = [sys.executable, "-c", FULL, str(tmp_path / "s"), str(size)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=os.environ)
    assert told in done.stdout
    assert "File too large" in done.stdout
    assert list((tmp_path / "s" / "chunks").iterdir()) == []


def test_maps_and_summaries_answer_the_usual_questions(tmp_path: Path) -> None:
    folder = tmp_path / "s"
    ps.run_study(study_of(), folder, workers=1)
    rows = _rows(folder)
    found = ps.study_map(folder, "duration", "payload")
    for i, mass in enumerate(found.y):
        for k, duration in enumerate(found.x):
            cases = [r["feasible"] for r in rows if (r["axis:payload"], r["axis:duration"]) == (mass, duration)]
            assert found.values[i, k] == pytest.approx(np.mean(cases))
    least = ps.study_map(folder, "payload", "duration", column="utilisation")
    assert least.values.min() == min(row["utilisation"] for row in rows)
    summary = ps.summarise_study(folder)
    assert summary.n_feasible == sum(row["feasible"] for row in rows)
    for one in summary.best:
        good = [row["axis:duration"] for row in rows if row["feasible"] and row["axis:payload"] == one["payload"]]
        assert one["duration"] == min(good)
    with pytest.raises(ps.InputError, match="axis 'profile' is not of numbers"):
        ps.study_map(folder, "profile", "payload")
    with pytest.raises(ps.InputError, match="unknown axis 'mass'"):
        ps.study_map(folder, "mass", "payload")
    with pytest.raises(ps.InputError, match="no study is there"):
        ps.summarise_study(tmp_path)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"axes": {"duration": []}}, "axis 'duration': expected a list of values"),
        ({"axes": {}}, "axes: expected a mapping of at least one axis"),
        ({"axes": {"duratoin": [1]}}, "axis 'duratoin': unknown; valid: duration, payload, .* did you mean 'duration'"),
        ({"axes": {"points.9.position.0": [1]}}, "'9' of 'points.9.position.0' is none of 0 to 3 or take or lift"),
        ({"axes": {"robot.limit.x": [1]}}, "the task has no 'limit' there; it has source, .* did you mean 'limits'"),
        ({"axes": {"duration": [0, 1]}}, "axis 'duration': 0 must be above 0"),
        ({"axes": {"payload": [-1]}}, "axis 'payload': -1 must be at least 0"),
        ({"axes": {"payload": ["heavy"]}}, "axis 'payload': expected a finite number, got 'heavy'"),
        ({"axes": {"payload": {"from": 0, "to": 1, "steps": 3}}}, "unknown 'steps'; valid: from, to, count, spacing"),
        ({"axes": {"name.x": [1]}}, "axis 'name.x': the task has no place inside 'name'"),
        ({"axes": {"name.x.y": [1]}}, "axis 'name.x.y': the task has no 'x' there, in 'name.x.y'"),
        (
            {"axes": {"payload": {"from": 2, "to": 1}}, "sampling": {"latin_hypercube": 3}},
            "axis 'payload': from = 2 is not below to = 1",
        ),
        ({"axes": {"payload": {"from": 0, "to": 1, "count": 0}}}, "count = 0: expected a whole number from 1"),
        ({"axes": {"payload": {"from": 0, "to": 1, "count": 2, "spacing": "geometric"}}}, "needs positive ends"),
        ({"columns": ["feasable"]}, "columns: unknown 'feasable'; valid: feasible, .* did you mean 'feasible'"),
        ({"sampling": "random"}, "sampling"),
        ({"sampling": {"latin_hypercube": 0}}, "latin_hypercube = 0: expected a whole number from 1"),
        ({"sampling": "list"}, "cases: expected a list of mappings"),
        ({"sampling": "list", "cases": [{"duration": 1}, {"payload": 1}]}, r"cases\[1\]: expected the axes duration"),
        ({"task": 3}, "task: expected the name of a task"),
        ({"chunks": 3}, "unknown 'chunks'; valid: name, task"),
    ],
)
def test_what_a_study_cannot_be_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        study_of(**changes)


def test_a_study_folder_that_is_not_whole(tmp_path: Path) -> None:
    folder = tmp_path / "s"
    ps.run_study(study_of(columns=["feasible"]), folder, workers=1)
    with pytest.raises(
        ps.InputError, match="the study has no column 'utilisation'; it has axis:duration, axis:payload"
    ):
        ps.study_map(folder, "duration", "payload", column="utilisation")
    chunk = next((folder / "chunks").glob("00000001-*.parquet"))
    chunk.unlink()
    chunk.mkdir()
    with pytest.raises(ps.InputError, match=r"00000001-\w{8}\.parquet: this chunk is damaged \(Is a directory\)"):
        ps.run_study(study_of(columns=["feasible"]), folder, workers=1)
    chunk.rmdir()
    (folder / "study.json").unlink()
    with pytest.raises(ps.InputError, match=r"has chunks but no study\.json; name another folder"):
        ps.run_study(study_of(), folder, workers=1)
    (folder / "study.json").write_text("{")
    with pytest.raises(ps.InputError, match=r"study\.json: cannot be read: Expecting property name"):
        ps.summarise_study(folder)
    (folder / "study.json").write_text("{}")
    for one in (folder / "chunks").iterdir():
        one.unlink()
    with pytest.raises(ps.InputError, match="s: no chunk is finished yet; run the study"):
        ps.summarise_study(folder)


def test_a_process_that_is_ended_and_a_package_that_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Ended(ThreadPoolExecutor):
        """A pool of processes, one of which the system has ended."""

        def __init__(self, count: int, *_: object) -> None:
            super().__init__(count)

        def submit(self, *_: object) -> Any:
            raise BrokenProcessPool

    monkeypatch.setattr(_running, "ProcessPoolExecutor", Ended)
    with pytest.raises(ps.InputError, match="a process of the study was ended; run it again: what is finished is kept"):
        ps.run_study(study_of(), tmp_path / "s", workers=2)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ps.InputError, match=r"needs the package distributed: .* 'puma-septic\[cluster\]'"):
        ps.run_study(study_of(), tmp_path / "s", scheduler="tcp://127.0.0.1:1")


def test_too_many_cases_have_to_be_confirmed(tmp_path: Path) -> None:
    axes = {name: {"from": 1, "to": 2, "count": 2000} for name in ("duration", "payload")}
    with pytest.raises(ps.InputError, match=r"4,000,000 cases are more than 2,000,000; confirm .*--yes"):
        ps.run_study(study_of(axes=axes), tmp_path / "s")
    with pytest.raises(ps.InputError, match="workers = 0"):
        ps.run_study(study_of(), tmp_path / "s", workers=0)


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer_is_an_error(tmp_path: Path) -> None:
    """Dask waits ten seconds for one."""
    with pytest.raises(ps.InputError, match="no Dask scheduler answers there"):
        ps.run_study(study_of(), tmp_path / "s", scheduler="tcp://127.0.0.1:1")


STUDY = """
task: paper-turned
axes:
  duration: {from: 6, to: 12, count: 4}
  payload: [0, 1.5, 3]
"""


def test_the_command_line_runs_goes_on_summarises_and_plots(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "reach.yaml"
    file.write_text(STUDY)
    assert main(["study", str(file), "--workers", "1"]) == 0
    output = capsys.readouterr()
    assert f"paper-turned: 12 cases in {tmp_path / 'reach'}, 12 of them now" in " ".join(output.out.split())
    assert output.err == ""  # quiet off a terminal
    assert main(["study", str(file)]) == 0
    assert "0 of them now" in " ".join(capsys.readouterr().out.split())
    assert main(["study", "summarise", str(tmp_path / "reach")]) == 0
    assert "12 of 12 cases" in capsys.readouterr().out
    assert main(["study", "summarise", str(tmp_path / "reach"), "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["n_cases"] == 12
    assert main(["study", "plot", str(tmp_path / "reach")]) == 0
    assert "<svg" in (tmp_path / "reach" / "map.svg").read_text()
    assert main(["study", "plot"]) == 2
    assert "study plot: expected one folder" in capsys.readouterr().err
    assert main(["study", "a", "b"]) == 2
    assert main(["study", str(tmp_path / "missing.yaml")]) == 2
