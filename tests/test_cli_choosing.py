"""compare, optimise, profiles: what they print, write and refuse."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from puma_septic.cli import main
from puma_septic.profiles import available


def printed(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    assert main(arguments) == 0
    out, err = capsys.readouterr()
    assert err == ""
    return out


def test_profiles_lists_all_of_them(capsys: pytest.CaptureFixture[str]) -> None:
    text = printed(["profiles", "--normalised"], capsys)
    assert max(map(len, text.splitlines())) <= 100
    for info in available():
        assert f"\n{info.name} " in text
    assert "classic septic 4-5-6-7" in text
    document = json.loads(printed(["profiles", "--format", "json", "--normalised"], capsys))
    assert [row["name"] for row in document["profiles"]] == [info.name for info in available()]
    assert document["normalised"][0]["jerk"] == "unbounded"


def test_compare_takes_the_tasks_options(capsys: pytest.CaptureFixture[str]) -> None:
    text = printed(["compare", "paper-turned", "--profile", "septic", "--profile", "lspb"], capsys)
    assert "Task 'paper-turned', robot 'puma560'" in text
    assert max(map(len, text.splitlines())) <= 100
    assert "misses by" in text
    assert "trapezoidal" not in text


def test_compare_writes_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "out"
    arguments = ["compare", "--profile", "septic", "--profile", "quintic", "--objective", "peak_jerk"]
    csv = printed([*arguments, "--format", "csv", "--out", str(target)], capsys)
    assert sorted(path.name for path in target.iterdir()) == [
        "comparison.csv", "comparison.json", "comparison.png", "comparison.svg", "report.html",
    ]  # fmt: skip
    assert (target / "comparison.csv").read_text() == csv
    document = json.loads((target / "comparison.json").read_text())
    assert document["pareto_optimal"] == ["septic"]


def test_optimise_finds_the_papers_via_times(capsys: pytest.CaptureFixture[str]) -> None:
    text = printed(["optimise", "--objective", "peak_jerk", "--restarts", "0"], capsys)
    assert "septic, peak_jerk: 60.8 % lower" in text


def test_optimise_takes_another_profile_with_what_it_leaves_free(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = [
        "optimise",
        "--profile",
        "quintic",
        "--free",
        "velocities",
        "--free",
        "accelerations",
        "--restarts",
        "0",
    ]
    document = json.loads(printed([*arguments, "--format", "json"], capsys))
    assert len(document["free_values"]["velocities"]) == 4
    assert document["improvement"] > 0.9


def test_optimise_two_objectives_gives_a_front(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "out"
    arguments = [
        "optimise",
        "--objective",
        "peak_jerk",
        "--objective",
        "overshoot",
        "--size",
        "4",
        "--out",
        str(target),
    ]
    assert "Pareto front over the via times" in printed(arguments, capsys)
    assert sorted(path.name for path in target.iterdir()) == ["front.png", "front.svg", "optimisation.json"]


def test_optimise_duration_gives_the_least_time(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["optimise", "gasparetto-zanotto", "--objective", "duration", "--free", "free_knots", "--restarts", "0"]
    text = printed(arguments, capsys)
    assert "least time 8.5310 s" in text
    assert "feasible by exact extrema: yes" in " ".join(text.split())


def test_optimise_lspb_passes_durations(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["optimise", "--profile", "lspb", "--objective", "peak_acceleration", "--restarts", "0"]
    assert "lspb, peak_acceleration" in printed(arguments, capsys)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["compare", "--profile", "septik"], "unknown profile 'septik'; valid:"),
        (["compare", "--objective", "jerk"], "unknown objective 'jerk'; valid:"),
        (["compare", "papre"], "unknown task 'papre'"),
        (["optimise", "--objective", "jerk"], "unknown objective 'jerk'; valid:"),
        (["optimise", "--profile", "septic", "--profile", "lspb"], "one profile is optimised at a time"),
        (["optimise", "--profile", "cubic", "--objective", "peak_jerk"], "unbounded for profile cubic"),
        (["optimise", "--objective", "duration", "--keep", "velocity"], "do not go with --objective duration"),
        (["optimise", "--keep", "position", "--restarts", "0"], "no via times were found that keep the constraints"),
        (["optimise", "--free", "velocities"], "septic has no free velocities"),
        (["optimise", "--max-overshoot", "nan"], "max_overshoot = nan rad is not a finite number"),
        (["profiles", "--format", "csv"], "invalid choice: 'csv'"),
    ],
)
def test_bad_input_is_one_line_on_stderr(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert message in err
