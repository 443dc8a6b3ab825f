"""A study that is killed at any moment goes on, loses no finished chunk and ends as if nothing had happened."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

import puma_septic as ps

RUN = """
import sys
import puma_septic as ps
if __name__ == "__main__":
    study = ps.load_study(sys.argv[1])
    ps.run_study(study, sys.argv[2], workers=int(sys.argv[3]), scheduler=sys.argv[4] if len(sys.argv) > 4 else None)
"""
STUDY = """
task: paper-turned
axes:
  profile: [septic, quintic_segments]
  duration: {from: 6, to: 12, count: 40}
  payload: {from: 0, to: 3, count: 50}
chunk: 100
"""


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    """The script and the study."""
    script, study = tmp_path / "run.py", tmp_path / "study.yaml"
    script.write_text(RUN)
    study.write_text(STUDY)
    return script, study


def rows(folder: Path) -> Any:
    return [row for file in sorted((folder / "chunks").glob("*.parquet")) for row in pq.read_table(file).to_pylist()]


def finished(folder: Path) -> dict[str, int]:
    return {file.name: file.stat().st_mtime_ns for file in (folder / "chunks").glob("*.parquet")}


def killed_until_done(command: list[str], folder: Path, kills: int, rng: np.random.Generator) -> int:
    """Start again and again, killing at random moments; how often it was killed at work."""
    done = 0
    for _ in range(kills):
        before = finished(folder) if folder.exists() else {}
        process = subprocess.Popen(command, start_new_session=True)
        start = time.monotonic()
        # From the first chunk of this start on: the moments that matter are those of writing.
        while process.poll() is None and time.monotonic() - start < 60:
            if folder.exists() and len(finished(folder)) > len(before):
                break
            time.sleep(0.002)
        time.sleep(float(rng.uniform(0, 0.05)))
        if process.poll() is None:
            os.kill(process.pid, signal.SIGKILL)
            done += 1
        process.wait()
        after = finished(folder)
        assert all(after.get(name) == when for name, when in before.items()), "a finished chunk was lost or rewritten"
    subprocess.run(command, check=True)
    return done


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_sigkill_at_random_moments(
    tmp_path: Path, files: tuple[Path, Path], rng: np.random.Generator, workers: int
) -> None:
    script, study = files
    ps.run_study(ps.load_study(study), tmp_path / "undisturbed", workers=1)
    command = [sys.executable, str(script), str(study), str(tmp_path / "killed"), str(workers)]
    assert killed_until_done(command, tmp_path / "killed", 4, rng) > 0
    assert rows(tmp_path / "killed") == rows(tmp_path / "undisturbed")


@pytest.mark.study
def test_sigkill_a_hundred_times(tmp_path: Path, files: tuple[Path, Path], rng: np.random.Generator) -> None:
    script, study = files
    study.write_text(STUDY.replace("chunk: 100", "chunk: 10"))
    ps.run_study(ps.load_study(study), tmp_path / "undisturbed", workers=1)
    command = [sys.executable, str(script), str(study), str(tmp_path / "killed"), "1"]
    assert killed_until_done(command, tmp_path / "killed", 100, rng) > 50
    assert rows(tmp_path / "killed") == rows(tmp_path / "undisturbed")


@contextmanager
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A Dask scheduler and two workers, each a process of its own, on this machine alone."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    dask = [sys.executable, "-m", "dask"]
    common = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": tmp_path}
    processes = [
        subprocess.Popen(
            [*dask, "scheduler", "--host", "127.0.0.1", "--port", str(port), "--dashboard-address", "127.0.0.1:0"],
            **common,
        )
    ]
    worker = [*dask, "worker", address, "--nthreads", "1", "--no-dashboard", "--local-directory", str(tmp_path)]
    processes += [subprocess.Popen([*worker, "--host", "127.0.0.1"], **common) for _ in range(2)]
    try:
        yield address, processes
    finally:
        for process in processes:
            process.terminate()
        for process in processes:
            process.wait(timeout=30)


@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_table_though_a_worker_is_killed(
    tmp_path: Path, files: tuple[Path, Path]
) -> None:
    script, study = files
    ps.run_study(ps.load_study(study), tmp_path / "alone", workers=1)
    with cluster(tmp_path) as (address, processes):
        folder = tmp_path / "spread"
        command = [sys.executable, str(script), str(study), str(folder), "1", address]
        run = subprocess.Popen(command)
        start = time.monotonic()
        while run.poll() is None and time.monotonic() - start < 120 and not (folder.exists() and finished(folder)):
            time.sleep(0.05)
        processes[1].kill()
        assert run.wait(timeout=300) == 0
    assert rows(folder) == rows(tmp_path / "alone")
