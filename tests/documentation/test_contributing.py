"""CONTRIBUTING.md tells how to add things: each section is applied to a copy of the package, and its last block run."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest
from helpers.places import ROOT

_SECTION = re.compile(r"^## (Add [^\n]*?)(?: \((\d+) files?\))?\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
_BLOCK = re.compile(r"^```(?:python|toml|xml) ([^\n]+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_INFO = re.compile(r'file=(\S+)(?: after="(.*)")?$')
# The end of a file, where no line is named.
_END = "# the end"


class Section(NamedTuple):
    """How to add one thing."""

    title: str
    files: int
    text: str


SECTIONS = [
    Section(title, int(files or 0), text)
    for title, files, text in _SECTION.findall((ROOT / "CONTRIBUTING.md").read_text())
]


def test_there_is_a_section_for_each_thing_that_grows() -> None:
    titles = " ".join(section.title for section in SECTIONS)
    for thing in ("profile", "limit", "check", "picture", "robot", "friction", "command"):
        assert thing in titles
    assert sum(bool(_BLOCK.search(section.text)) for section in SECTIONS) >= 6


@pytest.mark.slow
@pytest.mark.parametrize(
    "section", [one for one in SECTIONS if _BLOCK.search(one.text)], ids=lambda section: section.title
)
def test_what_a_section_adds_works(section: Section, tmp_path: Path) -> None:
    """A guide goes stale in silence; and the number of files in its heading is a promise about the structure."""
    for name in ("puma_septic", "urdf"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    touched, run = set(), ""
    for info, text in _BLOCK.findall(section.text):
        if info == "run":
            run = text
            continue
        file, after = _INFO.fullmatch(info).groups()  # type: ignore[union-attr]
        touched.add(file)
        _insert(tmp_path / file, text, (after or "").replace('\\"', '"').replace("\\n", "\n"))
    assert run, "a section ends with a block that shows the new thing at work"
    assert len(touched) <= section.files
    done = subprocess.run([sys.executable, "-c", run], cwd=tmp_path, env={"PYTHONPATH": str(tmp_path), "PATH": ""},
                          capture_output=True, text=True, check=False)  # fmt: skip
    assert done.returncode == 0, done.stderr


def _insert(path: Path, text: str, after: str) -> None:
    """A new file, or a block behind a line that stands once in it."""
    if not after:
        assert not path.exists(), f"{path} exists"
        path.write_text(text)
        return
    old = path.read_text()
    if after == _END:
        path.write_text(old + text)
        return
    assert old.count(f"{after}\n") == 1, f"{after!r} stands {old.count(after)} times in {path.name}"
    path.write_text(old.replace(f"{after}\n", f"{after}\n{text}"))


def test_the_page_on_architecture_has_the_floors_of_the_contract() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    floors = next(contract["layers"] for contract in contracts if contract["type"] == "layers")
    drawn = [f"{len(floors) - k:2}  {floor}" for k, floor in enumerate(floors)]
    assert "\n".join(drawn) in (ROOT / "docs" / "architecture.md").read_text()
