"""Many inputs of one format, each in a watched process; what offends is kept as a small file.

Case k of a format depends on the seed and on k alone, so a campaign can be run in parts, and on several cores.
"""

from __future__ import annotations

import multiprocessing
import os
import re
import resource
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

from campaign.mutation import Rng
from campaign.rules import MAX_BYTES, MAX_SECONDS, Verdict, verdict_of

RESULTS: Final = Path("campaign-results").absolute()
# A process that has said nothing for so long waits for ever; one that takes so much is stopped before the machine is.
HANGS_AFTER, ADDRESS_SPACE = 60.0, 6_000_000_000
CHUNK: Final = 500  # cases to a process
KEPT_OF_A_KIND: Final = 3
_TRIES: Final = 60  # at making an offender smaller


@dataclass(frozen=True)
class Format:
    """A kind of file: what it is called, its ending, how one is made and how it is read."""

    name: str
    suffix: str
    make: Callable[[Rng], bytes]
    check: Callable[[Path], object]


@dataclass
class Tally:
    """What came of the cases so far."""

    outcomes: Counter[str] = field(default_factory=Counter)
    offences: Counter[tuple[str, str]] = field(default_factory=Counter)
    slowest: float = 0.0
    largest: int = 0
    kept: list[Path] = field(default_factory=list)

    @property
    def cases(self) -> int:
        return self.outcomes.total()

    @property
    def n_offences(self) -> int:
        return sum(self.offences.values())


def run_cases(one: Format, cases: range, seed: int) -> Tally:
    """All cases of a format, in one process after the other."""
    tally, start = Tally(), cases.start
    while start < cases.stop:
        stop = min(start + CHUNK, cases.stop)
        for index, verdict, seconds, size in _in_a_process(one, range(start, stop), seed):
            start = index + 1
            tally.outcomes[verdict.outcome] += 1
            tally.slowest, tally.largest = max(tally.slowest, seconds), max(tally.largest, size)
            if verdict.is_offence:
                _keep(one, case_bytes(one, seed, index), index, verdict, tally, seed)
    return tally


def case_bytes(one: Format, seed: int, index: int) -> bytes:
    """The input of one case."""
    return one.make(np.random.default_rng([seed, index, *one.name.encode()]))


def replay(formats: list[Format], path: Path) -> Verdict:
    """Judge a kept file again, its format told by the first word of its name."""
    (one,) = [one for one in formats if path.name.startswith(f"{one.name}-")]
    found = list(_in_a_process(one, [path.read_bytes()]))
    return found[0][1]


def _in_a_process(one: Format, cases: range | list[bytes], seed: int = 0) -> Iterator[tuple[int, Verdict, float, int]]:
    """Index, verdict, seconds and bytes of each case, until all are done or one ends its process."""
    indices = cases if isinstance(cases, range) else range(len(cases))
    ours, theirs = multiprocessing.Pipe(duplex=False)
    process = multiprocessing.get_context("fork").Process(target=_work, args=(one, cases, seed, theirs))
    process.start()
    theirs.close()
    done = indices.start
    try:
        while done < indices.stop:
            if not ours.poll(HANGS_AFTER):
                yield done, Verdict("hang", "", f"no answer after {HANGS_AFTER:g} s"), HANGS_AFTER, 0
                return
            record = ours.recv()
            yield record
            done = record[0] + 1
            if record[3] > MAX_BYTES:  # a high-water mark, which stays
                return
    except EOFError:
        process.join()
        yield done, Verdict("crash", f"{process.exitcode}", f"the process ended with {process.exitcode}"), 0.0, 0
    finally:
        process.kill()
        process.join()
        ours.close()


def _work(one: Format, cases: range | list[bytes], seed: int, answers: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    null = os.open(os.devnull, os.O_RDWR)  # libraries that print to the streams of the process
    for stream in (0, 1, 2):
        os.dup2(null, stream)
    with TemporaryDirectory() as folder:
        # Deep enough that nobody looks for a robot's packages in a full folder of temporary files.
        home = Path(folder, *"abcdef")
        home.mkdir(parents=True)
        os.chdir(home)
        path = home / f"case{one.suffix}"
        begun = _peak()
        for index in cases if isinstance(cases, range) else range(len(cases)):
            data = case_bytes(one, seed, index) if isinstance(cases, range) else cases[index]
            path.write_bytes(data)
            answers.send((index, *_judged(one, path, begun)))


def _peak() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024  # Linux tells kibibytes


def _judged(one: Format, path: Path, begun: int) -> tuple[Verdict, float, int]:
    """The verdict on a file, seconds of the processor, and bytes beyond those that the process was begun with."""
    start = time.process_time()
    verdict = verdict_of(one.check, path)
    seconds = time.process_time() - start
    size = _peak() - begun
    if not verdict.is_offence and size > MAX_BYTES:
        verdict = Verdict("memory", "", f"{size / 1e6:.0f} MB")
    if not verdict.is_offence and seconds > MAX_SECONDS:
        verdict = Verdict("slow", "", f"{seconds:.1f} s")
    return verdict, seconds, size


def _keep(one: Format, data: bytes, index: int, verdict: Verdict, tally: Tally, seed: int) -> None:
    """Write an offender and what is wrong with it beside it: the first few of a kind, the very first made smaller."""
    kind = verdict.outcome, verdict.place
    tally.offences[kind] += 1
    if tally.offences[kind] > KEPT_OF_A_KIND:
        return
    RESULTS.mkdir(exist_ok=True)
    is_first = tally.offences[kind] == 1 and verdict.outcome in ("raw", "message", "unsound")
    small = smaller(one, data, verdict) if is_first else data
    told = re.sub(r"\W+", "_", f"{verdict.outcome}_{verdict.place}")[:50].strip("_")
    path = RESULTS / f"{one.name}-{seed}-{index}-{told}{one.suffix}"
    path.write_bytes(small)
    path.with_name(f"{path.name}.txt").write_text(f"{verdict.outcome}: {verdict.place}\n{verdict.detail}\n")
    tally.kept.append(path)


def smaller(one: Format, data: bytes, verdict: Verdict) -> bytes:
    """Leave out parts of a file, by halves, quarters ..., as long as it offends in the same way."""
    tries, parts = 0, 2
    while parts <= len(data) and tries < _TRIES:
        size, shorter = -(-len(data) // parts), []
        starts = range(0, len(data), size)
        for start in starts:
            shorter.append(data[:start] + data[start + size :])
        shorter = shorter[: _TRIES - tries]
        tries += len(shorter)
        found = _first_alike(one, shorter, verdict)
        if found is None:
            parts *= 2
        else:
            data, parts = found, max(2, parts - 1)
    return data


def _first_alike(one: Format, candidates: list[bytes], verdict: Verdict) -> bytes | None:
    for index, found, _, _ in _in_a_process(one, candidates):
        if (found.outcome, found.place) == (verdict.outcome, verdict.place):
            return candidates[index]
    return None
