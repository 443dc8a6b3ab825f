"""The package as a whole: its public names, how fast it answers, and that its own papers agree."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from helpers.places import ROOT

import puma_septic as ps

_INIT = Path(ps.__file__)


def _in_a_fresh_interpreter(code: str) -> object:
    """What `code` leaves in `result`, run where nothing has been imported yet."""
    script = f"{code}\nimport json; print(json.dumps(result))"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return json.loads(run.stdout)


def test_importing_loads_nothing_that_takes_time() -> None:
    heavy = {"numpy", "scipy", "pinocchio", "matplotlib", "meshcat", "pydantic", "tabulate", "IPython"}
    loaded = _in_a_fresh_interpreter("import sys, puma_septic; result = sorted(sys.modules)")
    assert heavy.isdisjoint(loaded)


def test_the_core_loads_no_drawing_library() -> None:
    """A computation on a server should not pay for, nor need, a screen."""
    code = "import sys, puma_septic as ps; ps.load_robot, ps.septic; result = sorted(sys.modules)"
    assert {"matplotlib", "meshcat", "IPython"}.isdisjoint(_in_a_fresh_interpreter(code))


@pytest.mark.parametrize("name", ps.__all__)
def test_every_public_name_is_there(name: str) -> None:
    value = getattr(ps, name)
    assert value is not None
    assert name in dir(ps)
    assert getattr(value, "__doc__", None), f"{name} has no docstring"


@pytest.mark.slow
def test_each_public_name_resolves_first_in_a_fresh_interpreter() -> None:
    """`from puma_septic import *` must not depend on what has been imported before."""
    names = _in_a_fresh_interpreter("from puma_septic import *; result = sorted(globals())")
    assert set(ps.__all__) <= set(names)


def test_type_checker_and_interpreter_see_the_same_names() -> None:
    """A name needs a line in the table and one under TYPE_CHECKING, from the same module."""
    tree = ast.parse(_INIT.read_text(encoding="utf-8"))
    guarded = next(node for node in tree.body if isinstance(node, ast.If))
    seen = {
        alias.asname: node.module for node in guarded.body if isinstance(node, ast.ImportFrom) for alias in node.names
    }
    homes = {name: "puma_septic" if name == home else f"puma_septic.{home}" for name, home in ps._HOMES.items()}
    assert seen == homes


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="'puma_septic' has no attribute 'assses'"):
        _ = ps.assses


def test_the_cited_version_is_this_one() -> None:
    assert f"\nversion: {ps.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_package_says_that_it_is_typed() -> None:
    assert (_INIT.parent / "py.typed").is_file()


def test_no_minus_stands_before_a_rounded_zero() -> None:
    """A joint at rest to rounding was at "-0.000 .. 1.200": fixed places print the sign of what they round away, unless
    the format says `z`. Places in a picture (`report/_charts.py`) are no text."""
    package = _INIT.parent
    found = [
        f"{path.relative_to(package)}: {match}"
        for path in sorted(package.rglob("*.py"))
        if path.name != "_charts.py"
        for match in re.findall(r"\{[^{}]*:[+ ]?[0-9]*\.(?:\d|\{[^{}]*\})f\}", path.read_text(encoding="utf-8"))
    ]
    assert found == []


_WITHOUT_EXTRAS = """
import sys

EXTRAS = {"pyarrow", "duckdb", "dask", "distributed", "pandas", "rosbags", "toppra", "copp"}

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in EXTRAS:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Missing())
from puma_septic.cli import COMMANDS, main
assert all(main([name, "--help"]) == 0 for name in COMMANDS)
task = ["paper-turned", "--profile", "septic", "--no-png", "--out"]
for typed in (["assess"], ["limits"], ["compare"], ["size"], ["optimise", "--restarts", "0"], ["execute"]):
    assert main([typed[0], *task, typed[0], *typed[1:]]) == 0, typed
result = True
"""


@pytest.mark.slow
def test_every_report_is_written_without_the_extras(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a plain installation each `--out` ended with "a study needs the packages pyarrow and duckdb"."""
    monkeypatch.chdir(tmp_path)
    run = subprocess.run([sys.executable, "-c", _WITHOUT_EXTRAS], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert len(list(tmp_path.glob("*/report.html"))) == 6
