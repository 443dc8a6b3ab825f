"""Errors say what is wrong in a few readable lines, whatever stands in a file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from helpers.urdf_texts import ARM, DRIVES, load, replaced

import puma_septic as ps
from puma_septic.cli import main
from puma_septic.document import csv_text, one_line, to_json
from puma_septic.errors import readable
from puma_septic.task import make_task

# Sets the title of a terminal, clears it, colours it; C1's own introducer; turns writing round; ends a line.
HOSTILE = "\x1b]0;title\x07\x1b[2J\x9b31m\u202e\u2028\x00"
HARMLESS = "Ω·m 12\u00a0N 関節 🤖\u200d💻 \u00ad\t two\nlines"


def controls(text: str) -> list[str]:
    """Control characters (C0 but for tabs and line feeds, C1), separators, bidirectional ones, surrogates."""
    bidirectional = "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069\u2028\u2029"
    return [one for one in text if (ord(one) < 32 and one not in "\n\t") or 0x7F <= ord(one) < 0xA0
            or one in bidirectional or 0xD800 <= ord(one) < 0xE000]  # fmt: skip


def test_text_that_steers_a_terminal_is_written_out() -> None:
    assert readable(HOSTILE) == r"\u001b]0;title\u0007\u001b[2J\u009b31m\u202e\u2028\u0000"
    assert readable("".join(map(chr, range(0x11000)))).isascii() is False
    assert controls(readable("".join(map(chr, range(0x11000))))) == []
    assert readable(HARMLESS) == HARMLESS


def test_a_message_is_readable_and_of_bounded_length() -> None:
    """A name of 5,000 letters, a YAML tag of 60,000, made messages as long."""
    for text in (HOSTILE, 70_000 * "x", 20_000 * "ab ", 5000 * HOSTILE):
        for error in (ps.InputError(text), ps.ModelError(text), ps.NoSolution(text, residual=1.0, q=())):
            assert len(str(error)) <= 2000
            assert controls(str(error)) == []
            assert str(type(error)(str(error), **vars(error))) == str(error)
    assert str(ps.InputError(f"name {5000 * 'x'}: too long")) == f"name {200 * 'x'}...{39 * 'x'}:: too long".replace(
        "::", ":"
    )
    path = "/".join(["folder"] * 36)  # of 251 bytes
    assert str(ps.ModelError(f"{path}: not valid")) == f"{path}: not valid"


def test_a_document_is_the_same_json_without_controls() -> None:
    document = {"note": HOSTILE + HARMLESS, "value": 1.5}
    text = to_json(document)
    assert controls(text) == []
    assert json.loads(text) == document


@pytest.mark.parametrize("text", ["=1+1", " =1+1", "\u00a0@x", "\t=1", "\n=1", "＝1", "  ＋1", "-2+3", "+a", "\r\n=1"])
def test_a_cell_is_no_formula(text: str) -> None:
    """A blank in front and full-width forms were let through; some spreadsheets take both for formulas."""
    cell = csv_text([[text]])
    assert cell.lstrip('"').startswith("'")


@pytest.mark.parametrize("text", ["-0.5", "1e-3", "+2", "-unbounded", "a=b", "joint-1"])
def test_a_number_or_a_plain_text_stays(text: str) -> None:
    assert csv_text([[text]]) == f"{text}\n"


def test_a_cell_and_a_line_of_a_value_hold_no_controls() -> None:
    assert controls(csv_text([[HOSTILE]])) == []
    assert controls(one_line("Motor", {"name": HOSTILE})) == []


# ---- through every door


def escaped(text: str) -> str:
    """As TOML, YAML and JSON write it."""
    return json.dumps(text)[1:-1]


def test_an_actuator_file(tmp_path: Path) -> None:
    """Notes, sources and the names of sets went to the terminal as they are."""
    drives = replaced('"bearings run in"', f'"{escaped(HOSTILE)}"', DRIVES)
    drives = replaced('source = "catalogue"', f'source = "{escaped(HOSTILE)}"', drives)
    robot = load(tmp_path, ARM, drives)
    assert any(r"\u001b[2J" in note for note in robot.notes)
    assert [controls(note) for note in robot.notes] == [[]] * len(robot.notes)
    renamed = drives.replace("parameters.worn", f'parameters."{escaped(HOSTILE)}"')
    with pytest.raises(ps.InputError, match="unknown parameters") as caught:
        load(tmp_path, ARM, renamed, parameters="none")
    assert controls(str(caught.value)) == []


def test_a_task(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    points = "[{joints: [0, 0, 0, 0, 0, 0]}, {joints: [0.1, 0, 0, 0, 0, 0]}]"
    text = f'name: a\ndescription: "{escaped(HOSTILE)}"\npoints: {points}\ndurations: [1]\nprofiles: [quintic]\n'
    (tmp_path / "a.yaml").write_text(text)
    assert controls(ps.load_task(tmp_path / "a.yaml").description) == []
    for options in ([], ["--format", "json"], ["--format", "csv"], ["-vv"]):
        main(["assess", str(tmp_path / "a.yaml"), *options])
        assert controls(capsys.readouterr().out) == []
    (tmp_path / "a.yaml").write_text(f'{text}description: "{escaped(HOSTILE)}"\n')
    assert main(["assess", str(tmp_path / "a.yaml")]) == 2
    assert controls(capsys.readouterr().err) == []
    points = [{"joints": [0.0] * 6}, {"joints": [0.1] * 6}]
    plain = {"name": "a", "points": points, "durations": [1.0], "profiles": ["quintic"]}
    assert make_task(plain | {"description": HARMLESS}).description == HARMLESS


def test_a_catalogue(tmp_path: Path) -> None:
    motors = "key,mass,inertia,max_int_torque,max_int_speed,colour\n{},1,1e-4,3,400,{}\n"
    (tmp_path / "m.csv").write_text(motors.format(HOSTILE.replace("\u2028", "").replace("\x00", ""), HOSTILE[:-1]))
    (tmp_path / "g.csv").write_text("key,ratio,mass,inertia,efficiency\nG,100,1,1e-5,0.8\n")
    catalogue = ps.load_catalogue(tmp_path / "m.csv", tmp_path / "g.csv")
    assert controls(catalogue.motors[0].name + str(catalogue.other)) == []


def test_a_log(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("t,\x1b[31mjoint1\x07\n0,0\n1,0\n")
    log = ps.read_log(tmp_path / "a.csv")
    assert controls("".join((*log.joint_names, *log.notes))) == []


def test_what_was_typed(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (
        ["assess", f"{HOSTILE[:-1]}.yaml"],
        ["assess", f"--{HOSTILE}"],
        [HOSTILE],
        ["ik", "--q", HOSTILE],
    ):
        assert main(arguments) == 2
        assert controls(capsys.readouterr().err) == []


def test_an_error_that_nobody_foresaw(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError(HOSTILE)

    monkeypatch.setattr("puma_septic.cli._profiles.run", fail)
    assert main(["profiles", "--debug"]) == 70
    assert controls(capsys.readouterr().err) == []
