"""What a terminal shows: short answers within its width, colours, the wanted units, a line while it works."""

from __future__ import annotations

import csv
import io
import re
import time
from argparse import Namespace
from pathlib import Path

import pytest
from helpers.golden_cases import WIDTHS, terminal

from puma_septic import cli
from puma_septic.cli import COMMANDS, _terminal, main

CODE = re.compile(r"\x1b\[[0-9]+m")


@pytest.fixture(scope="module")
def printed() -> dict[str, dict[int, str]]:
    """Each command's answer at each width, computed once."""
    return {name: {width: terminal(name, width) for width in WIDTHS} for name in ("assess", "compare", "ik", "paper")}


@pytest.mark.slow
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", ["assess", "compare", "ik", "paper"])
def test_no_line_is_longer_than_the_terminal(name: str, width: int, printed: dict[str, dict[int, str]]) -> None:
    """At 40, 60, 80, 120 and 200 columns the widest line used to be 100 to 150 wide, whatever the terminal."""
    assert max(map(len, printed[name][width].splitlines())) <= width


@pytest.mark.slow
@pytest.mark.parametrize("name", ["assess", "compare", "ik", "paper"])
def test_an_answer_is_short(name: str, printed: dict[str, dict[int, str]]) -> None:
    """They were 179, 73, 61 and 104 lines; all of it comes with -v."""
    assert 12 <= len(printed[name][120].splitlines()) <= 30
    assert "More: -v" in printed[name][120]


STUDY = """name: reach
task: paper-turned
axes: {profile: [septic], duration: [8, 12], payload: [0, 1]}
"""
SOON: dict[str, list[str]] = {
    "init": ["init", "cell"],
    "doctor": ["doctor", "ur5"],
    "robot": ["robot", "ur5", "-v"],
    "profiles": ["profiles", "-v"],
    "one profile": ["profiles", "lspb"],
    "accelerations": ["accelerations", "--gap", "0.5"],
    "limits": ["limits", "paper-turned"],
    "size": ["size", "paper-turned"],
    "size -v": ["size", "paper-turned", "-v"],
    "ik": ["ik", "paper-turned", "-v"],
    "check": ["check", "plan.yaml", "--robot", "puma560"],
    "assess": ["assess", "paper-turned", "-v"],
    "optimise": ["optimise", "paper-turned", "--restarts", "1"],
}
LATE: dict[str, list[str]] = {
    "chosen": ["size", "cell/cell.yaml", "--catalogue", "cell/motors.csv", "cell/gearboxes.csv", "-vv"],
    "cycle": ["assess", "cell/cell.yaml", "-v"],
    "compare": ["compare", "paper-turned", "-v"],
    "front": ["optimise", "paper-turned", "--objective", "rms_torque", "--objective", "peak_jerk", "--points", "3"],
    "least time": ["optimise", "paper-turned", "--objective", "duration", "--restarts", "0"],
    "execute": ["execute", "paper-turned", "--profile", "septic", "-v"],
    "replay": ["replay", "paper-turned", "--html", "replay.html"],
    "study": ["study", "reach.yaml"],
    "summary": ["study", "summarise", "reach"],
    "paper": ["paper", "-v"],
}


@pytest.mark.parametrize(
    "typed", [*SOON.values(), *(pytest.param(one, marks=pytest.mark.slow) for one in LATE.values())], ids=[*SOON, *LATE]
)
def test_every_command_keeps_within_every_width(
    typed: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The tables of `size` and the drives of `robot` were as wide as they pleased; -v has the widest of all."""
    monkeypatch.chdir(tmp_path)
    Path("reach.yaml").write_text(STUDY)
    if "plan.yaml" in typed:
        main(["assess", "paper-turned", "--profile", "septic", "--write", "plan.yaml"])
    if any(word.startswith("cell/") for word in typed):
        main(["init", "cell"])
    if "summarise" in typed:
        main(["study", "reach.yaml"])
    answered: list[tuple[str, Namespace]] = []
    show = cli._for_a_person
    monkeypatch.setattr(cli, "_for_a_person", lambda *answer: (answered.append(answer), show(*answer))[1])
    assert main(typed) in (0, 1, 3)
    for width in WIDTHS:
        monkeypatch.setenv("COLUMNS", str(width))
        lines = show(*answered[-1]).splitlines()
        # A word that is longer than a line, such as a path or a checksum, stays whole.
        assert [line for line in lines if len(line) > width and max(map(len, line.split())) <= width - 4] == []
    assert re.search(r"-0(\.0*)?(?![\d.e])", answered[-1][0]) is None  # no minus before a zero


def test_every_command_is_among_them() -> None:
    assert {typed[0] for typed in (*SOON.values(), *LATE.values())} == set(COMMANDS)


@pytest.mark.slow
@pytest.mark.parametrize("typed", [["size", "paper-turned"], ["size", "paper-turned", "--catalogue", "example"]])
def test_the_answer_of_size_is_short(typed: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """It was 100 lines of the arm's own drives and 256 of chosen ones, whose end was to be found between them."""
    assert main(typed) == 0
    short = capsys.readouterr().out.splitlines()
    assert len(short) <= 30
    assert short[-1].startswith("More: -v") or short[-2].startswith("More: -v")
    assert main([*typed, "-v"]) == 0
    assert len(capsys.readouterr().out.splitlines()) > 2 * len(short)


def test_a_terminal_is_taken_between_60_and_200_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _terminal.terminal_width() == 100  # a pipe, a file
    for columns, width in (("40", 60), ("80", 80), ("500", 200)):
        monkeypatch.setenv("COLUMNS", columns)
        assert _terminal.terminal_width() == width


def test_colours_are_for_terminals_unless_asked_otherwise(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """https://no-color.org: NO_COLOR, when not empty, prevents colours; FORCE_COLOR asks for them in a pipe."""
    main(["assess", "paper"])
    plain = capsys.readouterr().out
    monkeypatch.setenv("FORCE_COLOR", "1")
    main(["assess", "paper"])
    coloured = capsys.readouterr().out
    assert "\x1b[31minfeasible\x1b[0m" in coloured
    assert CODE.sub("", coloured) == plain
    monkeypatch.setenv("NO_COLOR", "1")
    main(["assess", "paper"])
    assert capsys.readouterr().out == plain


def test_degrees_and_revolutions_per_minute(capsys: pytest.CaptureFixture[str]) -> None:
    """Joint 1 of the turned task turns at 1.079 rad/s at most, 61.8 deg/s or 10.3 rpm; JSON stays in SI units."""
    task = ["assess", "paper-turned", "--profile", "septic", "-v"]
    main([*task, "--show-in", "deg,rpm"])
    text = capsys.readouterr().out
    assert "[deg]" in text
    assert "[rpm]" in text
    assert "rad" not in text.replace("rad^2", "")
    row = next(line for line in text.splitlines() if line.startswith("joint1"))
    assert "10.3" in row
    main([*task, "--show-in", "deg", "--format", "json"])
    shown = capsys.readouterr().out
    main([*task, "--format", "json"])
    assert capsys.readouterr().out == shown


@pytest.mark.parametrize("command", ["ik", "robot", "profiles", "accelerations", "doctor"])
def test_every_command_has_csv(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    main([command, *(["--gap", "0.5"] if command == "accelerations" else []), "--format", "csv"])
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert rows
    assert all(None not in row for row in rows)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example_and_fits(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert main([command, "--help"]) == 0
    text = capsys.readouterr().out
    described, _, examples = text.partition("examples:\n")
    assert f"puma-septic {command}" in examples
    assert max(map(len, described.splitlines())) <= 80


def test_whoever_waits_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Writing a report took 50 to 130 s on a busy machine without a word."""

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    stream = Terminal()
    monkeypatch.setattr(_terminal.sys, "stderr", stream)
    with _terminal.waiting("puma-septic paper", after=0.01):
        time.sleep(0.1)
    assert "puma-septic paper: 0 s ..." in stream.getvalue()
    assert stream.getvalue().endswith("\r\x1b[K")
