"""Every block of Python and every command that README.md and the documentation show is run, and ends as they say."""

from __future__ import annotations

import inspect
import shlex
import webbrowser
from collections.abc import Callable
from contextlib import chdir
from glob import glob
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.pages import PAGES, blocks, commands, example_files
from helpers.places import ROOT
from helpers.ros_messages import small_move
from helpers.urdf_texts import ARM

import puma_septic as ps
from puma_septic import testing
from puma_septic.cli import main

# What a command of ours ends with, where it is not 0: a verdict, never bad input (2) or a fault of the program (70).
VERDICTS = {
    # No branch of the paper's task keeps joint 5's limit.
    "puma-septic assess paper": 1,
    "puma-septic assess shelf.yaml --margin 0.2": 1,
    # Neither file has a limit of the jerk.
    "puma-septic check --robot arm.urdf --actuators arm.toml plan.yaml": 3,
    "puma-septic check --robot arm.urdf plan.yaml --fix slower.yaml": 3,
}
SHELF = "docs/howto/task.md"
# All of the arm's drives and limits but the jerk's.
KNOWN = """schema = 1
robot = "arm"
default_parameters = "new"
default_limits = "new"
[parameters.new]
source = "made up"
[parameters.new.joints.shoulder]
gear_ratio = 100.0
rotor_inertia = 1e-4
viscous_friction = 1e-3
coulomb_friction = [0.02, -0.02]
[parameters.new.joints.elbow]
gear_ratio = 50.0
rotor_inertia = 1e-4
viscous_friction = 1e-3
coulomb_friction = [0.02, -0.02]
[limits.new]
source = "made up"
velocity = { shoulder = 3.0, elbow = 4.0 }
acceleration = { shoulder = 20.0, elbow = 20.0 }
effort = { shoulder = 50.0, elbow = 20.0 }
"""


@pytest.fixture
def folder(tmp_path: Path, puma: ps.Robot, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder: an arm with a tool and drives, plans for it, a task, a log; no browser."""
    example_files(tmp_path, SHELF)
    shelf = (tmp_path / "shelf.yaml").read_text(encoding="utf-8")
    (tmp_path / "cell.yaml").write_text(shelf.replace("mass: 2.0", "mass: 0.5"), encoding="utf-8")
    # Strong enough for the 5 kg that a page gives it.
    strong = ARM.replace('effort="50"', 'effort="200"').replace('effort="20"', 'effort="100"')
    (tmp_path / "arm.urdf").write_text(strong.replace('"tip"', '"tool0"'), encoding="utf-8")
    (tmp_path / "arm.toml").write_text(KNOWN, encoding="utf-8")
    (tmp_path / "packages").mkdir()
    (tmp_path / "plans").mkdir()
    arm = ps.load_robot(tmp_path / "arm.urdf")
    for name in ("plan.yaml", "pick.yaml", "plans/one.yaml", "plans/two.yaml"):
        move = ps.quintic_segments([[0.0, 0.0], [0.3, -0.4]], [0.0, 2.0], joint_names=arm.joint_names)
        ps.write_joint_trajectory(tmp_path / name, move)
    log = small_move(puma)
    t = np.arange(0.0, log.duration, 0.01)
    rows = np.column_stack([t, log(t)])
    np.savetxt(tmp_path / "log.csv", rows, delimiter=",", comments="", header=",".join(["t", *puma.joint_names]))
    monkeypatch.setattr(webbrowser, "open", lambda *_args, **_options: True)
    monkeypatch.setattr(ps.Replay, "wait", lambda _replay: None)
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if any(b.language == "python" for b in blocks(page))])
def test_the_python_of_a_page_runs(page: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """In the order of the page, its pieces sharing their names; what it prints is the text block that follows."""
    example_files(folder, page)
    names: dict[str, Any] = {"__name__": "page"}
    shown = [*blocks(page)]
    with chdir(folder):
        for block, following in zip(shown, [*shown[1:], None], strict=True):
            if block.language != "python":
                continue
            exec(compile(block.text, page, "exec"), names)
            printed = capsys.readouterr().out
            if following is not None and following.language == "text":
                assert printed == following.text
        for name in [name for name in names if name.startswith("test_")]:
            _call_test(names.pop(name))


def _call_test(test: Callable[..., None]) -> None:
    """A test that a page shows; its arguments are fixtures of our plug-in."""
    test(*(getattr(testing, argument) for argument in inspect.signature(test).parameters))


def _pages_with_commands() -> list[Any]:
    """Those that write a folder are slow: matplotlib draws each figure."""
    found = [(page, [c for c in commands(page) if c.startswith("puma-septic")]) for page in PAGES]
    return [
        pytest.param(page, marks=pytest.mark.slow if any("--out" in line for line in lines) else [])
        for page, lines in found
        if lines
    ]


@pytest.mark.slow
@pytest.mark.parametrize("page", _pages_with_commands())
def test_the_commands_of_a_page_end_as_it_says(page: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    example_files(folder, page)
    with chdir(folder):
        for command in commands(page):
            if command.startswith("puma-septic"):
                assert _exit_code(command) == VERDICTS.get(command, 0), (command, capsys.readouterr())


def _exit_code(command: str) -> int:
    """As a shell runs it: patterns become files, what stands after > is not ours."""
    words = [glob(word) if "*" in word else [word] for word in shlex.split(command.partition(" > ")[0])[1:]]
    return main([word for found in words for word in found])


def test_other_commands_are_run_in_continuous_integration() -> None:
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    others = {command for page in PAGES for command in commands(page) if not command.startswith("puma-septic")}
    install = "python3 -m venv .venv && .venv/bin/python -m pip install -e"
    assert others == {
        f"{install} . && .venv/bin/puma-septic assess paper-turned",
        f'{install} ".[test]" && .venv/bin/python -m pytest',
    }
    for command in others:
        assert f" '{command}'" in script


def test_the_readme_shows_what_the_command_prints(capsys: pytest.CaptureFixture[str]) -> None:
    """Its text blocks are the beginning of both tasks' texts, as they are today."""
    texts = [b.text for b in blocks("README.md") if b.language == "text"]
    main(["assess", "paper-turned"])
    assert capsys.readouterr().out == texts[0]
    main(["assess", "paper"])
    assert texts[1] in capsys.readouterr().out


def test_no_page_has_a_block_that_nothing_looks_at() -> None:
    """A language that the tests do not know would be a block that is not run."""
    languages = {block.language for page in PAGES for block in blocks(page)}
    assert languages <= {"python", "sh", "text", "yaml", "toml", "csv"}


def test_the_command_line_has_a_page_of_its_own_that_is_true() -> None:
    """Written by ``python docs/make_cli.py`` from the parser."""
    spec = spec_from_file_location("make_cli", ROOT / "docs" / "make_cli.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.PAGE.read_text(encoding="utf-8") == module.page()
