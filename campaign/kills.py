"""SIGKILL at random instants while files are written: nothing, the old, or the whole under the final name.

Every second kill is at a random instant of the command's time, every other one just before it gives the k-th name.
"""

from __future__ import annotations

import os
import shutil
import signal
import sys
import time
from collections import Counter
from itertools import count as numbered
from pathlib import Path
from typing import Final

import numpy as np

from campaign.outputs import OUTPUTS, Output, contents, ended, faults_of, in_a_child, inputs, left_in, timed

BEFORE: Final = ("nothing", "empty folder", "older result")
_IN_A_ROW: Final = 5  # kills of one command in one folder, before it is let run to its end
_NAMING: Final = ("os.rename", "os.link")  # what Python tells (sys.audit) of names that are given, replaced ones too


def run(count: int, seed: int) -> tuple[Counter[str], list[str]]:
    """So many kills, over all outputs in turn; what was found under the name, and every offence."""
    rng = np.random.default_rng([seed, 1])
    rows = -(-count // _IN_A_ROW)
    inputs(OUTPUTS[:rows])
    found: Counter[str] = Counter()
    offences: list[str] = []
    for k in range(rows):
        one = OUTPUTS[k % len(OUTPUTS)]
        before = BEFORE[(k + seed) % len(BEFORE)]
        shares = rng.random(min(_IN_A_ROW, count - k * _IN_A_ROW))
        offences += [f"{one.name}, before: {before}: {text}" for text in _row(one, before, shares, found)]
    return found, offences


def _row(one: Output, before: str, shares: np.ndarray, found: Counter[str]) -> list[str]:
    """Run it undisturbed once beside, kill it at shares of that time, and look at what lies there each time."""
    folder = Path("place")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    target, wrong = folder / f"result{one.suffix}", []
    undisturbed = Path(f"undisturbed{one.suffix}")
    shutil.rmtree(undisturbed, ignore_errors=True)
    undisturbed.unlink(missing_ok=True)
    code, seconds = timed(lambda: one.run(undisturbed))
    names = set(contents(undisturbed))
    if code not in (0, 1) or faults_of(undisturbed):
        return [f"ends with {code}, {faults_of(undisturbed)}"]
    if before == "empty folder" and not one.suffix:
        target.mkdir()
    elif before == "older result" and _force(one):
        shutil.copytree(undisturbed, target) if undisturbed.is_dir() else shutil.copy(undisturbed, target)
    for k, share in enumerate(shares):
        if k % 2:
            outcome = killed(one, target, names, number=int(share * (len(names) + 2)))
        else:
            outcome = killed(one, target, names, seconds=share * 1.1 * seconds)
        found[outcome] += 1
        wrong += [f"{outcome}: {text}" for text in faults_of(target)]
        if outcome == "killed: in part":
            wrong.append(f"{sorted(contents(target))} in place of {sorted(names)}")
    return wrong + _next_run(one, target, names)


def killed(one: Output, target: Path, names: set[str], *, seconds: float = 0.0, number: int | None = None) -> str:
    """What lies under the name after a run that was killed so many seconds after its start, or at a name."""
    more = _again(one, target)
    old = contents(target)
    child = in_a_child(lambda: one.run(target, *more), before=lambda: None if number is None else _kill_at(number))
    if number is None:
        time.sleep(seconds)
        if os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
            os.killpg(child, signal.SIGKILL)
    code, now = ended(child), contents(target)
    if code >= 0:
        return "ended before"
    if one.resumes:
        return "killed: to be resumed"
    if now == old:
        return "killed: as before"
    return "killed: whole" if set(now) == names else "killed: in part"


def _kill_at(number: int) -> None:
    """Kill this process and its children just before it gives a file or folder its name for the number-th time."""
    names = numbered()

    def hook(event: str, _: object) -> None:
        if event in _NAMING and next(names) == number:
            os.killpg(0, signal.SIGKILL)

    sys.addaudithook(hook)


def _next_run(one: Output, target: Path, names: set[str]) -> list[str]:
    """One more run is not disturbed by what the killed ones have left, and takes it away."""
    code, _ = timed(lambda: one.run(target, *_again(one, target)))
    wrong = faults_of(target)
    if code not in (0, 1) or (not one.resumes and set(contents(target)) != names):
        told = Path("stderr.txt").read_text(errors="replace")[:300]
        wrong.append(f"the next run ends with {code} and {sorted(contents(target))}: {told}")
    if left := left_in(target):
        wrong.append(f"left over after the next run: {left}")
    return wrong


def _again(one: Output, target: Path) -> tuple[str, ...]:
    """What a second run needs; of ``check --fix``, which overwrites nothing, the file must be gone."""
    if one.name == "check --fix":
        target.unlink(missing_ok=True)
    return _force(one) if contents(target) else ()


def _force(one: Output) -> tuple[str, ...]:
    return () if one.resumes or one.name == "check --fix" else ("--force",)
