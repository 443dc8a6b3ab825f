"""What the package writes is what it wrote: texts to the letter, numbers to 1e-9.

A change that is meant is made visible by ``python -m pytest tests/golden -m "slow or not slow" --update-golden``, which
rewrites the files: read their difference before you commit it.
"""

from __future__ import annotations

import csv
import io
import json
import re
from typing import Any

import pytest
from helpers.golden_cases import CASES
from helpers.places import GOLDEN, ROBOTS

import puma_septic as ps

# Two builds of the linear algebra differ by some thousand roundings; below the floor is what rounding makes of zero.
_RELATIVE, _FLOOR = 1e-9, 1e-12
# A peak is flat: its instant is known to the square root of a rounding, 1.5e-8, of the motion's scale of time.
_INSTANT = 1e-7
_NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")
_LONG = re.compile(r"-?\d+\.\d{11,}(?:e[+-]?\d+)?")
# The quick tier has a task in every form; the others differ from it by robot and points.
_QUICK = (
    "joints.txt", "joints.json", "joints.csv", "joints.html", "joints.robot.html", "paper.sizing.txt",
    "terminal.assess.80.txt",
)  # fmt: skip


@pytest.mark.parametrize("name", [
    pytest.param(name, marks=[] if name in _QUICK else pytest.mark.slow) for name in CASES
])  # fmt: skip
def test_what_is_written(name: str, request: pytest.FixtureRequest) -> None:
    written = _portable(CASES[name]())
    path = GOLDEN / name
    if request.config.getoption("--update-golden"):
        if not path.exists() or not _is_same(name, written, path.read_text(encoding="utf-8")):
            path.write_text(_kept(name, written), encoding="utf-8")
        return
    golden = path.read_text(encoding="utf-8")
    _compare_files(name, written, golden)


def test_each_file_is_of_a_case() -> None:
    assert {path.name for path in GOLDEN.iterdir()} == set(CASES)


def _portable(text: str) -> str:
    """Without the version and the folder of the other arms, which are this machine's."""
    for ours in (f"puma-septic {ps.__version__}", f'"version": "{ps.__version__}"'):
        text = text.replace(ours, ours.replace(ps.__version__, "VERSION"))
    return text.replace(str(ROBOTS), "ROBOTS")


def _kept(name: str, written: str) -> str:
    """The file's text: numbers to 12 digits, so that a change of rounding changes no line of it."""
    text = _folded(json.loads(written)) if name.endswith(".json") else written
    return _LONG.sub(lambda number: repr(float(f"{float(number[0]):.12g}")), text)


def _folded(value: Any, indent: str = "") -> str:
    """JSON with a line for each mapping or list that holds no other."""
    inner = list(value.values()) if isinstance(value, dict) else value
    if not isinstance(inner, list) or not any(isinstance(item, (dict, list)) for item in inner):
        return json.dumps(value, ensure_ascii=False)
    keys = [f"{json.dumps(key)}: " for key in value] if isinstance(value, dict) else [""] * len(value)
    lines = [f"{indent} {key}{_folded(item, indent + ' ')}" for key, item in zip(keys, inner, strict=True)]
    start, end = "{}" if isinstance(value, dict) else "[]"
    return f"{start}\n" + ",\n".join(lines) + f"\n{indent}{end}"


def _structure(text: str) -> str:
    """What stands between numbers, a sign for each."""
    return _NUMBER.sub("#", text)


def _rows(text: str) -> list[dict[str, Any]]:
    return [{key: _value(cell) for key, cell in row.items()} for row in csv.DictReader(io.StringIO(text))]


def _value(cell: str) -> float | str:
    return float(cell) if _NUMBER.fullmatch(cell) else cell


def _numbers(text: str) -> list[float]:
    return [float(number) for number in _NUMBER.findall(text)]


def _is_same(name: str, written: str, golden: str) -> bool:
    """Whether nothing but rounding has changed, for which no file is rewritten."""
    try:
        _compare_files(name, written, golden)
    except AssertionError:
        return False
    return True


def _compare_files(name: str, written: str, golden: str) -> None:
    if name.endswith(".json"):
        _compare(json.loads(written), json.loads(golden), name)
    elif name.endswith(".csv"):
        _compare(_rows(written), _rows(golden), name)
    elif name.endswith(".txt"):
        assert written == golden
    else:
        assert _structure(written) == _structure(golden)
        assert _numbers(written) == pytest.approx(_numbers(golden), rel=_RELATIVE, abs=_FLOOR)


def _compare(written: Any, golden: Any, where: str) -> None:
    """Keys, lengths and texts exactly, numbers to rounding; the message names the place."""
    if isinstance(golden, dict):
        assert list(written) == list(golden), where
        for key, value in golden.items():
            _compare(written[key], value, f"{where} {key}")
    elif isinstance(golden, list):
        assert len(written) == len(golden), where
        for k, value in enumerate(golden):
            _compare(written[k], value, f"{where}[{k}]")
    elif isinstance(golden, float) and isinstance(written, float):
        relative = _INSTANT if "time" in where.rpartition(" ")[2] or "crossings" in where else _RELATIVE
        assert written == pytest.approx(golden, rel=relative, abs=_FLOOR), where
    else:
        assert written == golden, where
