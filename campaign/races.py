"""Several writers of one name at the same instant: one result is there, whole, and no other writer thinks it his."""

from __future__ import annotations

import shutil
from collections import Counter
from pathlib import Path
from typing import Final

from campaign.outputs import OUTPUTS, contents, ended, faults_of, in_a_child, inputs, timed

WRITERS: Final = 4
_RACED: Final = ("assess --out", "assess --write", "replay --html", "compare --out", "limits --out", "check --fix")


def run(count: int, _seed: int) -> tuple[Counter[str], list[str]]:
    """So many races, over the outputs in turn, every second time with ``--force``."""
    found: Counter[str] = Counter()
    offences = []
    raced = [one for one in OUTPUTS if one.name in _RACED]
    inputs(raced[:count])
    for k in range(count):
        one = raced[k % len(raced)]
        more = ("--force",) if k // len(raced) % 2 and one.name != "check --fix" else ()
        folder = Path("race")
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        target = folder / f"result{one.suffix}"
        writers = [in_a_child(lambda one=one, more=more, target=target: one.run(target, *more)) for _ in range(WRITERS)]
        codes = [ended(child) for child in writers]
        winners = sum(code in (0, 1) for code in codes)
        found[f"{winners} of {WRITERS} wrote" + (" (--force)" if more else "")] += 1
        reference = folder / f"alone{one.suffix}"
        timed(lambda one=one, reference=reference: one.run(reference))
        wrong = faults_of(target)
        if any(code not in (0, 1, 2) for code in codes):
            wrong.append(f"exit codes {codes}")
        if winners < 1 or (not more and winners != 1):
            wrong.append(f"{winners} writers believe that the result is theirs")
        if set(contents(target)) != set(contents(reference)):
            wrong.append(f"there is {sorted(contents(target))} in place of {sorted(contents(reference))}")
        if left := sorted(path.name for path in folder.iterdir() if path not in (target, reference)):
            wrong.append(f"left over: {left}")
        offences += [f"{one.name} {' '.join(more)}: {text}" for text in wrong]
    return found, offences
