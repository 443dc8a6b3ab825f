"""Commands that write files: each kind of output, what it writes to, and whether what lies there is whole."""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

import puma_septic as ps
from campaign.moves import move, puma
from puma_septic.cli import main

_STUDY: Final = """name: reach
task: paper-turned
axes: {profile: [septic], duration: {from: 7, to: 14, count: 8}, payload: {from: 0, to: 4, count: 6}}
columns: [feasible, peaks]
"""


@dataclass(frozen=True)
class Output:
    """A command line whose word TARGET is the file or folder that it writes."""

    name: str
    words: tuple[str, ...]
    suffix: str = ""  # of a file; a folder has none
    resumes: bool = False  # goes on in its folder where it was ended

    def run(self, target: Path, *more: str) -> int:
        """The exit code, in this process."""
        return main([str(target) if word == "TARGET" else word for word in (*self.words, *more)])


_OPTIMISE: Final = ("optimise", "williams", "--profile", "quintic", "--restarts", "1")
_EXECUTE: Final = ("execute", "paper-turned", "--profile", "septic", "--settle", "0.1")
OUTPUTS: Final = (
    Output("assess --out", ("assess", "paper-turned", "--profile", "septic", "--no-png", "--out", "TARGET")),
    Output("assess --out with PNG", ("assess", "williams", "--out", "TARGET")),
    Output("assess --write", ("assess", "paper-turned", "--profile", "septic", "--write", "TARGET"), ".yaml"),
    Output("assess --csv --out", ("assess", "--csv", "log.csv", "--no-png", "--out", "TARGET")),
    Output("replay --html", ("replay", "paper-turned", "--profile", "septic", "--html", "TARGET"), ".html"),
    Output("compare --out", ("compare", "williams", "--no-png", "--out", "TARGET")),
    Output("size --out", ("size", "paper-turned", "--no-png", "--out", "TARGET")),
    Output("optimise --out", (*_OPTIMISE, "--no-png", "--out", "TARGET")),
    Output("optimise --write", (*_OPTIMISE, "--write", "TARGET"), ".yaml"),
    Output("limits --out", ("limits", "paper-turned", "--profile", "septic", "--no-png", "--out", "TARGET")),
    Output("execute --out", (*_EXECUTE, "--no-png", "--out", "TARGET")),
    Output("study --out", ("study", "study.yaml", "--workers", "1", "--out", "TARGET"), resumes=True),
    Output("paper --out", ("paper", "--no-png", "--out", "TARGET")),
    Output("check --fix", ("check", "quick.yaml", "--robot", "puma560", "--fix", "TARGET"), ".yaml"),
)  # fmt: skip


def inputs(outputs: Sequence[Output]) -> None:
    """Files that the commands read, in the current folder; and in this process what many runs of these load."""
    t = np.linspace(0.0, 2.0, 101)
    rows = "\n".join(",".join(map(repr, map(float, (at, *q)))) for at, q in zip(t, move()(t), strict=True))
    Path("log.csv").write_text(f"t,{','.join(puma().joint_names)}\n{rows}\n", encoding="utf-8")
    Path("study.yaml").write_text(_STUDY, encoding="utf-8")
    points = np.array([[0.0, 0.6, -2.2, 0, 0.3, 0], [0.9, 1.2, -2.6, 0, 0.6, 0]])
    quick = ps.quintic_segments(points, [0, 0.2], joint_names=puma().joint_names)  # five times too quick
    Path("quick.yaml").unlink(missing_ok=True)
    ps.write_joint_trajectory("quick.yaml", quick)
    _load(outputs)


def _load(outputs: Sequence[Output]) -> None:
    """Run each once here, but for a study, which starts threads: forked from here, they take a third of the time."""
    with TemporaryDirectory() as folder, redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        for k, one in enumerate(outputs):
            if not one.resumes:
                one.run(Path(folder, f"{k}{one.suffix}"))


def fault_of(path: Path) -> str:
    """Why a file is not whole, by its kind; "" where it is."""
    data = path.read_bytes()
    if not data:
        return f"{path.name} is empty"
    ends = {".html": b"</html>", ".png": b"IEND\xaeB`\x82", ".svg": b"</svg>", ".parquet": b"PAR1"}
    if path.suffix in ends and not data.rstrip(b"\n").endswith(ends[path.suffix]):
        return f"{path.name} is cut after {len(data)} bytes"
    if path.suffix in (".csv", ".yaml", ".txt", ".toml") and not data.endswith(b"\n"):
        return f"{path.name} ends within a line"
    if path.suffix == ".json":
        try:
            json.loads(data)
        except ValueError as error:
            return f"{path.name}: {error}"
    return ""


def _is_shown(path: Path, target: Path) -> bool:
    """A study's lock is empty, and what is hidden is not finished."""
    name = str(path.relative_to(target))
    return name != "lock" and not name.startswith(".")


def contents(target: Path) -> dict[str, bytes]:
    """Names and bytes of what lies under a name; hidden folders are left out, see `left_in`."""
    if target.is_file():
        return {"": target.read_bytes()}
    found = sorted(target.rglob("*")) if target.is_dir() else []
    names = {path: str(path.relative_to(target)) for path in found if path.is_file()}
    return {name: path.read_bytes() for path, name in names.items() if not name.startswith(".")}


def left_in(target: Path) -> list[str]:
    """Hidden names beside a result and in it, which are a killed run's until the next run."""
    beside = [path.name for path in target.parent.iterdir() if path.name not in (target.name, "lost+found")]
    return sorted([*beside, *(path.name for path in target.glob(".*"))])


def faults_of(target: Path) -> list[str]:
    inside = [path for path in target.rglob("*") if path.is_file() and _is_shown(path, target)]
    files = [target] if target.is_file() else inside
    return [fault for path in files if (fault := fault_of(path))]


def in_a_child(work: Callable[[], int], *, before: Callable[[], object] | None = None) -> int:
    """Start work in a forked process of its own group, without its streams; its process number."""
    sys.stdout.flush()
    child = os.fork()
    if child:
        with suppress(OSError):  # it has done so, or has ended
            os.setpgid(child, child)
        return child
    status = 99
    try:
        os.setpgid(0, 0)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_DFL if number != signal.SIGINT else signal.default_int_handler)
        null = os.open("stderr.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        for stream in (1, 2):
            os.dup2(null, stream)
        if before is not None:
            before()
        status = work()
        sys.stderr.flush()
    finally:
        os._exit(status)


def ended(child: int) -> int:
    """Wait for a child; its exit code, or minus the signal that ended it."""
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def timed(work: Callable[[], int]) -> tuple[int, float]:
    start = time.monotonic()
    return ended(in_a_child(work)), time.monotonic() - start
