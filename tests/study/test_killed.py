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
from puma_septic.study import _running

RUN = """
import sys
import puma_septic as ps
from puma_septic.study import _running
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


# Ends the process itself at a moment of the write of a chunk: with the first bytes, before they are on the disk, before
# and after the file has its name.
KILLED_WRITING = """
import os, signal, sys
from pathlib import Path
moment, count = sys.argv[4], int(sys.argv[5])
seen = 0


def at(name, wanted, before):
    def patched(*given, **named):
        global seen
        seen += wanted(*given)
        if before and seen >= count and wanted(*given):
            os.kill(os.getpid(), signal.SIGKILL)
        result = name(*given, **named)
        if not before and seen >= count and wanted(*given):
            os.kill(os.getpid(), signal.SIGKILL)
        return result

    return patched


if moment == "half":
    write = Path.write_bytes

    def half(path, data):
        global seen
        seen += data.startswith(b"PAR1")
        if seen < count:
            return write(path, data)
        write(path, data[:1000])
        os.kill(os.getpid(), signal.SIGKILL)

    Path.write_bytes = half
elif moment == "flushed":
    def chunk(file):
        place = Path(os.readlink(f"/proc/self/fd/{file}"))
        return place.parent.name == "chunks" and place.suffix == ".part"

    os.fsync = at(os.fsync, chunk, before=True)
else:
    Path.replace = at(Path.replace, lambda path, target: target.suffix == ".parquet", before=moment == "unnamed")
sys.argv = sys.argv[:4]
"""


@pytest.mark.slow
@pytest.mark.parametrize("moment", ["half", "flushed", "unnamed", "named"])
def test_sigkill_inside_a_write(tmp_path: Path, files: tuple[Path, Path], moment: str) -> None:
    """Killed at the third write, and by the run after it at its second: nothing half is taken for a chunk."""
    script, study = files
    study.write_text(STUDY.replace("count: 40", "count: 8").replace("count: 50", "count: 5").replace("100", "10"))
    ps.run_study(ps.load_study(study), tmp_path / "undisturbed", workers=1)
    deadly, folder = tmp_path / "deadly.py", tmp_path / "killed"
    deadly.write_text(KILLED_WRITING + RUN)
    # How many chunks are there after each: one more each time where the last one had its name already.
    for count, there in zip((3, 2), (3, 5) if moment == "named" else (2, 3), strict=True):
        before = finished(folder) if folder.exists() else {}
        killed = subprocess.run([sys.executable, str(deadly), str(study), str(folder), "1", moment, str(count)])
        assert killed.returncode == -signal.SIGKILL
        after = finished(folder)
        assert len(after) == there
        assert all(after[name] == when for name, when in before.items())
        assert len(list((folder / "chunks").glob(".*.part"))) == (moment != "named")
    subprocess.run([sys.executable, str(script), str(study), str(folder), "1"], check=True)
    assert rows(folder) == rows(tmp_path / "undisturbed")
    assert not list((folder / "chunks").glob(".*.part"))


class Cluster:
    """A Dask scheduler and workers, each a process of its own, on this machine alone."""

    def __init__(self, place: Path) -> None:
        with socket.socket() as one:
            one.bind(("127.0.0.1", 0))
            port = one.getsockname()[1]
        self.address, self.place = f"tcp://127.0.0.1:{port}", place
        local = ["--host", "127.0.0.1"]
        dashboard = ["--dashboard-address", "127.0.0.1:0"]
        self.processes = [self._start("scheduler", *local, "--port", str(port), *dashboard)]
        self.workers = [self.add_worker() for _ in range(2)]

    def _start(self, *arguments: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", "dask", *arguments]
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=self.place)

    def add_worker(self) -> subprocess.Popen[bytes]:
        # Without a nanny, which would start a killed worker again by itself: a kill is one of the worker itself.
        options = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1"]
        worker = self._start("worker", self.address, *options, "--local-directory", str(self.place))
        self.processes.append(worker)
        return worker

    def kill(self, k: int) -> None:
        """A worker; another one takes its place."""
        self.workers[k].kill()
        self.workers[k].wait()
        self.workers[k] = self.add_worker()


@contextmanager
def cluster(place: Path) -> Iterator[Cluster]:
    running = Cluster(place)
    try:
        yield running
    finally:
        # Workers hold nothing; asked to end, one may wait for its scheduler for ever.
        for process in running.processes:
            process.kill()
        for process in running.processes:
            process.wait(timeout=30)


def spread(files: tuple[Path, Path], folder: Path, running: Cluster, kills: int, rng: np.random.Generator) -> int:
    """A study on the cluster, whose workers are killed at random moments; how many were."""
    script, study = files
    run = subprocess.Popen([sys.executable, str(script), str(study), str(folder), "1", running.address])
    done, known = 0, 0
    while run.poll() is None:
        count = len(finished(folder)) if folder.exists() else 0
        # Where nothing was finished since the last kill the new worker may not even have begun.
        if done < kills and count > known:
            time.sleep(float(rng.uniform(0, 0.3)))
            running.kill(int(rng.integers(2)))
            done, known = done + 1, count
        time.sleep(0.02)
    assert run.returncode == 0
    return done


@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_table_though_a_worker_is_killed(
    tmp_path: Path, files: tuple[Path, Path], rng: np.random.Generator
) -> None:
    study = ps.load_study(files[1])
    ps.run_study(study, tmp_path / "alone", workers=1)
    with cluster(tmp_path) as running:
        assert spread(files, tmp_path / "spread", running, 1, rng) <= 1
    assert rows(tmp_path / "spread") == rows(tmp_path / "alone")


@pytest.mark.study
def test_dask_workers_are_killed_a_hundred_times(
    tmp_path: Path, files: tuple[Path, Path], rng: np.random.Generator
) -> None:
    """Studies one after the other, until so many workers were killed at work."""
    files[1].write_text(STUDY.replace("chunk: 100", "chunk: 4"))
    ps.run_study(ps.load_study(files[1]), tmp_path / "alone", workers=1)
    alone, done, round_ = rows(tmp_path / "alone"), 0, 0
    with cluster(tmp_path) as running:
        while done < 100:
            folder = tmp_path / f"spread {round_}"
            done, round_ = done + spread(files, folder, running, 100 - done, rng), round_ + 1
            assert rows(folder) == alone


class _Lost(Exception):
    """As distributed raises it where too many workers of a task were lost."""


class _Future:
    def __init__(self, key: str, answer: Any) -> None:
        self.key, self.answer = key, answer

    def exception(self) -> Exception | None:
        return self.answer if isinstance(self.answer, Exception) else None

    def result(self) -> Any:
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer

    def release(self) -> None:
        pass


class _Distributed:
    """What a study asks of distributed; the workers of one chunk are lost a number of times."""

    KilledWorker = _Lost

    def __init__(self, chunk: int, losses: float) -> None:
        self.chunk, self.losses, self.asked = chunk, losses, 0

    def Client(self, *_: Any, **__: Any) -> _Distributed:  # noqa: N802
        return self

    def __enter__(self) -> _Distributed:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def nthreads(self) -> dict[str, int]:
        return {"one": 2}

    def submit(self, function: Any, study: Any, k: int, n_joints: int, **_: Any) -> _Future:
        self.asked += 1
        if k == self.chunk and self.losses > 0:
            self.losses -= 1
            return _Future(f"{k}-{self.asked}", _Lost())
        return _Future(f"{k}-{self.asked}", function(study, k, n_joints))

    class as_completed:  # noqa: N801
        def __init__(self, futures: list[_Future]) -> None:
            self.futures = futures

        def add(self, future: _Future) -> None:
            self.futures.append(future)

        def __iter__(self) -> Iterator[_Future]:
            while self.futures:
                yield self.futures.pop(0)


def test_a_chunk_that_the_scheduler_gives_up_is_asked_for_again(
    tmp_path: Path, files: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """distributed gives a task up after four lost workers, however often it may be retried: a study ended by that."""
    files[1].write_text(STUDY.replace("chunk: 100", "chunk: 1000"))
    study = ps.load_study(files[1])
    ps.run_study(study, tmp_path / "alone", workers=1)
    monkeypatch.setattr(_running, "import_module", lambda _: _Distributed(2, 20))
    ps.run_study(study, tmp_path / "spread", scheduler="tcp://there:1")
    assert rows(tmp_path / "spread") == rows(tmp_path / "alone")
    monkeypatch.setattr(_running, "import_module", lambda _: _Distributed(2, np.inf))
    with pytest.raises(
        ps.InputError, match="chunk 2 of the study: every worker that computes it is lost, 25 times over"
    ):
        ps.run_study(study, tmp_path / "hopeless", scheduler="tcp://there:1")
    assert len(finished(tmp_path / "hopeless")) == 3
