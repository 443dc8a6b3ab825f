"""Whole processes, start to end: the assessment of the paper's move against the import of a toolbox."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

ROUNDS = 7
COMMAND = str(Path(sys.executable).with_name("puma-septic"))
PROCESSES = {
    'python -c "import roboticstoolbox"': [sys.executable, "-c", "import roboticstoolbox"],
    "puma-septic assess": [COMMAND, "assess"],
    "puma-septic --help": [COMMAND, "--help"],
    "puma-septic assess paper --no-png --out DIR": [COMMAND, "assess", "paper", "--no-png", "--out", "DIR"],
}


def run() -> list[tuple[str, ...]]:
    """Time all in turn, round by round; ratios are to the toolbox's import where it is installed."""
    seconds = {name: [_timed(command) for command in [PROCESSES[name]]] for name in _present()}
    for _ in range(ROUNDS - 1):
        for name, values in seconds.items():
            values.append(_timed(PROCESSES[name]))
    first = next(iter(PROCESSES))
    rows = [("whole process", "median", "best", "share of the import")]
    for name, values in seconds.items():
        share = f"{np.median(np.array(values) / seconds[first]):.2f}" if first in seconds else "-"
        rows.append((name, f"{np.median(values):.2f} s", f"{min(values):.2f} s", share))
    if first not in seconds:
        rows.append(("Robotics Toolbox is not installed (extra: bench)", "", "", ""))
    return rows


def _present() -> list[str]:
    return [name for name in PROCESSES if "roboticstoolbox" not in name or find_spec("roboticstoolbox") is not None]


def _timed(command: list[str]) -> float:
    """Seconds; 0 and 1 are the exit codes of a verdict, any other is a failure."""
    with TemporaryDirectory() as folder:
        words = [f"{folder}/results" if word == "DIR" else word for word in command]
        start = perf_counter()
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        seconds = perf_counter() - start
    if done.returncode not in (0, 1) or "Traceback" in done.stderr:
        raise RuntimeError(f"{' '.join(command)} ended with {done.returncode}:\n{done.stderr}")
    return seconds
