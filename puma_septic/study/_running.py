"""A study carried out: chunk by chunk, by processes of this machine or the workers of a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import Any, Final, final

import numpy as np

from puma_septic.errors import InputError
from puma_septic.study._definition import Study
from puma_septic.study._evaluation import evaluated, joint_count
from puma_septic.study._folder import StudyFolder, table_from_bytes, table_of, table_to_bytes
from puma_septic.validation import checked_flag, checked_whole

__all__ = ["LARGE", "StudyRun", "run_study"]

LARGE: Final = 2_000_000
"""Above so many cases a study has to be confirmed."""

Progress = Callable[[int, int], None]
# Chunks that are asked for ahead of each worker: what is held at once does not grow with the study.
_AHEAD: Final = 2
_CONNECT_SECONDS: Final = 10
# How often a chunk is asked for again after the scheduler gave it up, each time after four lost workers (its setting
# distributed.scheduler.allowed-failures).
_MOST_LOST: Final = 25


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class StudyRun:
    """A study that is complete.

    Attributes
    ----------
    folder : Path
        With ``study.json`` and the Parquet files of ``chunks/``.
    n_cases : int
    n_computed : int
        How many of them by this run; the others were there.
    """

    folder: Path
    n_cases: int
    n_computed: int


def run_study(
    study: Study,
    folder: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    confirmed: bool = False,
    progress: Progress | None = None,
) -> StudyRun:
    """Compute what a study asks, into a folder of Parquet files.

    Cases that differ in duration and payload alone share one pass of the dynamics, exactly. A case that fails is a row
    with its error. A run that was ended, however, goes on where it was: no chunk that is there is computed or written
    again.

    Parameters
    ----------
    study : Study
    folder : str or Path
        New, or that of the same study.
    workers : int, optional
        Processes; by default one for each processor. 1: this process alone.
    scheduler : str, optional
        Address of a Dask scheduler, "tcp://HOST:PORT", whose workers compute instead; they need this package, and no
        access to the folder.
    confirmed : bool
        Whether more than `LARGE` cases are meant.
    progress : callable, optional
        Called with the cases that are done, and all.

    Returns
    -------
    StudyRun

    Raises
    ------
    InputError
        For a task that cannot be resolved, a folder of another study or under work, a place that cannot be written, a
        damaged chunk, a cluster that does not answer, or too many cases.

    Examples
    --------
    >>> import puma_septic as ps, tempfile
    >>> study = ps.make_study({"task": "paper-turned", "axes": {"duration": [8, 9, 10]}, "columns": ["feasible"]})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run_study(study, folder, workers=1).n_computed
    3
    """
    if study.n_cases > LARGE and not checked_flag("confirmed", confirmed):
        raise InputError(f"{study.n_cases:,} cases are more than {LARGE:,}; confirm that they are meant (--yes)")
    if workers is not None:
        checked_whole("workers", workers, at_least=1)
    place = StudyFolder(path=Path(folder))
    n_joints = joint_count(study)
    with place.opened(study):
        done = place.finished()
        missing = [k for k in range(study.n_chunks) if k not in done]
        count = sum(_size(study, k) for k in done)
        before = count
        if progress is not None:
            progress(count, study.n_cases)
        for k, data in _computed(study, missing, n_joints, workers, scheduler):
            place.write(k, table_from_bytes(data))
            count += _size(study, k)
            if progress is not None:
                progress(count, study.n_cases)
    return StudyRun(folder=place.path, n_cases=study.n_cases, n_computed=count - before)


def _size(study: Study, k: int) -> int:
    return min(study.chunk, study.n_cases - k * study.chunk)


def chunk_bytes(study: Study, k: int, n_joints: int) -> tuple[int, bytes]:
    """Chunk k computed, with its number."""
    first = k * study.chunk
    cases = np.arange(first, first + _size(study, k))
    return k, table_to_bytes(table_of(evaluated(study, cases, n_joints)))


def _computed(
    study: Study, chunks: list[int], n_joints: int, workers: int | None, scheduler: str | None
) -> Iterator[tuple[int, bytes]]:
    if scheduler is not None:
        yield from _by_cluster(study, chunks, n_joints, scheduler)
        return
    count = min(workers or os.cpu_count() or 1, len(chunks))
    if count <= 1:
        for k in chunks:
            yield chunk_bytes(study, k, n_joints)
        return
    with ProcessPoolExecutor(count, multiprocessing.get_context("spawn"), _end_with_parent) as pool:
        submit = [lambda k=k: pool.submit(chunk_bytes, study, k, n_joints) for k in chunks]
        try:
            yield from _in_flight(submit, _AHEAD * count)
        except BrokenProcessPool as error:
            raise InputError("a process of the study was ended; run it again: what is finished is kept") from error
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _in_flight(submit: Iterable[Callable[[], Future[Any]]], most: int) -> Iterator[Any]:
    """Results as they come, never more than so many asked for at once."""
    waiting = iter(submit)
    pending = {one() for one in islice(waiting, most)}
    while pending:
        done, pending = wait(pending, return_when=FIRST_COMPLETED)
        pending |= {one() for one in islice(waiting, len(done))}
        for future in done:
            yield future.result()


def _end_with_parent() -> None:
    """In a worker: end when the process that started it does, however that came to its end."""
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _by_cluster(study: Study, chunks: list[int], n_joints: int, scheduler: str) -> Iterator[tuple[int, bytes]]:
    try:
        distributed = import_module("distributed")
    except ImportError as error:
        raise InputError(
            "a Dask cluster needs the package distributed: python -m pip install 'puma-septic[cluster]'"
        ) from error
    try:
        client = distributed.Client(scheduler, timeout=_CONNECT_SECONDS)
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(f"scheduler {scheduler!r}: no Dask scheduler answers there: {error}") from error
    with client:
        threads = max(1, sum(client.nthreads().values()))
        waiting, asked, lost = iter(chunks), dict[str, int](), Counter[int]()

        def ask(k: int) -> Any:
            future = client.submit(chunk_bytes, study, k, n_joints, pure=False)
            asked[future.key] = k
            return future

        results = distributed.as_completed([ask(k) for k in islice(waiting, _AHEAD * threads)])
        for future in results:
            k = asked.pop(future.key)
            # The scheduler gives up a task whose workers were lost a few times; no chunk is to blame for it.
            if isinstance(future.exception(), distributed.KilledWorker) and lost[k] < _MOST_LOST:
                lost[k] += 1
                results.add(ask(k))
                continue
            yield _from_worker(future, k, distributed.KilledWorker)
            future.release()
            for following in islice(waiting, 1):
                results.add(ask(following))


def _from_worker(future: Any, k: int, lost: type[Exception]) -> tuple[int, bytes]:
    try:
        chunk: tuple[int, bytes] = future.result()
    except lost as error:
        raise InputError(
            f"chunk {k} of the study: every worker that computes it is lost, {_MOST_LOST} times over; has it the memory"
            " that a chunk needs?"
        ) from error
    return chunk
