"""A full disk, as a limit of a file's size and as a small file system: a clear error, and old files as they were."""

from __future__ import annotations

import resource
import shutil
import signal
import subprocess
from collections import Counter
from pathlib import Path
from typing import Final

import numpy as np

from campaign.outputs import OUTPUTS, Output, contents, ended, faults_of, in_a_child, inputs, left_in, timed
from campaign.rules import message_faults

_FILLED: Final = (
    "assess --out", "assess --write", "replay --html", "compare --out", "size --out", "limits --out", "execute --out",
    "optimise --write", "check --fix",
)  # fmt: skip
_LONG: Final = 10  # sizes, from which on small file systems are tried too


def run(count: int, seed: int) -> tuple[Counter[str], list[str]]:
    """So many sizes, geometric from 1 byte to 3 MB; each with every output, with and without an older result."""
    found: Counter[str] = Counter()
    offences = []
    rng = np.random.default_rng([seed, 2])
    sizes = np.geomspace(1, 3e6, count).astype(int)
    outputs = [one for one in OUTPUTS if one.name in _FILLED]
    inputs(outputs if count >= _LONG else [])
    for size in sizes:
        for k in rng.permutation(len(outputs))[: max(2, len(outputs) // 3)]:
            for has_old in (False, True):
                outcome, wrong = _filled(outputs[k], int(size), has_old=has_old)
                found[outcome] += 1
                offences += [f"{outputs[k].name}, {size} bytes: {text}" for text in wrong]
    if count >= _LONG:
        found.update(_small_file_systems(outputs, offences))
    return found, offences


def _filled(one: Output, size: int, *, has_old: bool) -> tuple[str, list[str]]:
    folder = Path("full")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    target = folder / f"result{one.suffix}"
    more = ()
    if has_old and one.name != "check --fix":
        timed(lambda: one.run(target))
        more = ("--force",)
    code = ended(in_a_child(lambda: one.run(target, *more), before=lambda: _limit(size)))
    return _judged(target, code, has_old=bool(more))


def _limit(size: int) -> None:
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # else the process ends where the limit is reached
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def _judged(target: Path, code: int, *, has_old: bool) -> tuple[str, list[str]]:
    wrong = faults_of(target)
    told = Path("stderr.txt").read_text(errors="replace")
    if left := left_in(target):
        wrong.append(f"left over: {left}")
    if code in (0, 1):
        return "written", wrong
    # The limit holds for the file of messages too.
    if code != 2 or (told and (message_faults(told) or "Traceback" in told)):
        wrong.append(f"ends with {code}: {told[-300:]}")
    if not has_old and contents(target):
        wrong.append(f"refused, but there is {sorted(contents(target))}")
    if has_old and not contents(target):
        wrong.append("the older result is lost")
    return "refused", wrong


def _small_file_systems(outputs: list[Output], offences: list[str]) -> Counter[str]:
    """The same on a tmpfs, where this process may mount one."""
    found: Counter[str] = Counter()
    folder = Path("tmpfs")
    folder.mkdir(exist_ok=True)
    for kilobytes in (8, 64, 300):
        for one in outputs:
            options = ["-t", "tmpfs", "-o", f"size={kilobytes}k", "none", str(folder)]
            if subprocess.run(["mount", *options], capture_output=True, check=False).returncode:
                return Counter({"no small file system may be mounted here": 1})
            try:
                target = folder / f"result{one.suffix}"
                code, _ = timed(lambda one=one, target=target: one.run(target))
                outcome, wrong = _judged(target, code, has_old=False)
            finally:
                subprocess.run(["umount", str(folder)], check=True)
            found[f"{outcome} on a tmpfs"] += 1
            offences += [f"{one.name}, tmpfs of {kilobytes} kB: {text}" for text in wrong]
    return found
