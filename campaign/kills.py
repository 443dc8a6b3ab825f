"""SIGKILL at random instants while files are written: nothing, the old, or the whole under the final name."""

from __future__ import annotations

import os
import shutil
import signal
import time
from collections import Counter
from pathlib import Path
from typing import Final

import numpy as np

from campaign.outputs import OUTPUTS, Output, contents, ended, faults_of, in_a_child, inputs, left_in, timed

BEFORE: Final = ("nothing", "empty folder", "older result")
_IN_A_ROW: Final = 5  # kills of one command in one folder, before it is let run to its end


def run(count: int, seed: int) -> tuple[Counter[str], list[str]]:
    """So many kills, over all outputs in turn; what was found under the name, and every offence."""
    rng = np.random.default_rng([seed, 1])
    inputs()
    found: Counter[str] = Counter()
    offences: list[str] = []
    for k in range(-(-count // _IN_A_ROW)):
        one = OUTPUTS[k % len(OUTPUTS)]
        before = BEFORE[k // len(OUTPUTS) % len(BEFORE)]
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
    for share in shares:
        outcome = _killed(one, target, share * 1.1 * seconds, names)
        found[outcome] += 1
        wrong += [f"{outcome}: {text}" for text in faults_of(target)]
        if outcome == "killed: in part":
            wrong.append(f"{sorted(contents(target))} in place of {sorted(names)}")
    return wrong + _next_run(one, target, names)


def _killed(one: Output, target: Path, seconds: float, names: set[str]) -> str:
    """What lies under the name after a run that was killed so many seconds after its start."""
    more = _again(one, target)
    old = contents(target)
    child = in_a_child(lambda: one.run(target, *more))
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
