"""Try to break the package, part by part: ``python -m campaign``.

Every part is seeded. Inputs that offend are kept, made smaller, in ``campaign-results``; ``--replay`` judges them
again. Exit code: 0 nothing found, 1 something found.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("MPLBACKEND", "Agg")

from campaign import (
    api,
    disk,
    fuzz_catalogue,
    fuzz_log,
    fuzz_task,
    fuzz_toml,
    fuzz_trajectory,
    fuzz_urdf,
    kills,
    memory,
    races,
    server,
    threads,
    xss,
)
from campaign.runner import Format, Tally, replay, run_cases
from puma_septic.views.tables import text_table


class Part(NamedTuple):
    """A part of the campaign: how much of it is the long form, how much the short one, and what is run."""

    long: int
    short: int
    what: Any
    unit: str


FORMATS = {
    "urdf": [Format("urdf", ".urdf", fuzz_urdf.make, fuzz_urdf.check)],
    "toml": [
        Format("actuators", ".toml", fuzz_toml.make_actuators, fuzz_toml.check_actuators),
        Format("drives", ".toml", fuzz_toml.make_drives, fuzz_toml.check_drives),
    ],
    "yaml": [Format("task", ".yaml", fuzz_task.make, fuzz_task.check)],
    "catalogue": [
        Format(kind, ".csv", fuzz_catalogue.maker(kind), fuzz_catalogue.checker(kind))
        for kind in ("motors", "gearboxes", "pairs")
    ],
    "log": [Format("log", ".csv", fuzz_log.make, fuzz_log.check)],
    "trajectory": [
        Format(f"plan_{suffix[1:]}", suffix, fuzz_trajectory.maker(suffix), fuzz_trajectory.check)
        for suffix in (".yaml", ".json")
    ],
}
PARTS = {
    "urdf": Part(40_000, 250, FORMATS["urdf"], "files"),
    "toml": Part(12_000, 60, FORMATS["toml"], "files"),
    "yaml": Part(12_000, 60, FORMATS["yaml"], "files"),
    "catalogue": Part(12_000, 45, FORMATS["catalogue"], "files"),
    "log": Part(12_000, 60, FORMATS["log"], "files"),
    "trajectory": Part(12_000, 60, FORMATS["trajectory"], "files"),
    "api": Part(10_000, 520, api.run, "calls"),
    "kills": Part(300, 5, kills.run, "kills"),
    "races": Part(50, 2, races.run, "races"),
    "disk": Part(20, 1, disk.run, "sizes"),
    "server": Part(2_000, 40, server.run, "random requests"),
    "xss": Part(len(xss.PAYLOADS), 1, xss.run, "payloads"),
    "memory": Part(10_000, 15, memory.run, "assessments, sizings and reports each"),
    "threads": Part(200, 4, threads.run, "moves"),
}


def main(argv: list[str] | None = None) -> int:
    """Run the named parts, or all."""
    given = _arguments(argv)
    if given.replay:
        return _replayed(given.replay)
    rows, bad = [("part", "tried", "found", "seconds")], 0
    for name in given.parts or PARTS:
        part = PARTS[name]
        count = given.cases if given.cases is not None else part.short if given.short else part.long
        start = time.monotonic()
        outcomes, offences = _run(part, given.first, count, given.seed)
        rows.append((name, f"{count:,} {part.unit}", f"{len(offences)}", f"{time.monotonic() - start:.0f}"))
        print(f"{name}: {count:,} {part.unit} with seed {given.seed}: {outcomes}", flush=True)
        print("".join(f"  FOUND {text}\n" for text in offences), end="", flush=True)
        bad += len(offences)
    print(text_table(rows[0], rows[1:]))
    return int(bad > 0)


def _arguments(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m campaign", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"all by default: {', '.join(PARTS)}")
    parser.add_argument("--seed", type=int, default=560, help="of all that is random (default: 560)")
    parser.add_argument("--cases", type=int, metavar="N", help="so many of each part, instead of its own number")
    parser.add_argument("--first", type=int, default=0, metavar="K", help="the file to begin with")
    parser.add_argument("--short", action="store_true", help="a small number of each, in less than a minute")
    parser.add_argument("--replay", nargs="+", type=Path, default=[], metavar="FILE", help="judge kept files again")
    given = parser.parse_args(argv)
    if unknown := set(given.parts) - set(PARTS):
        parser.error(f"unknown part {', '.join(sorted(unknown))}; valid: {', '.join(PARTS)}")
    return given


def _run(part: Part, first: int, count: int, seed: int) -> tuple[str, list[str]]:
    """What came of a part, in words, and every offence."""
    if not isinstance(part.what, list):
        with TemporaryDirectory() as folder:
            home = Path.cwd()
            os.chdir(folder)
            try:
                found, offences = part.what(count, seed)
            finally:
                os.chdir(home)
        return _counted(found), offences
    share, tallies = -(-count // len(part.what)), {}
    for one in part.what:
        tallies[one.name] = run_cases(one, range(first, first + share), seed)
    return "; ".join(_told(name, tally) for name, tally in tallies.items()), [
        f"{name}: {times} x {outcome}: {place}"
        for name, tally in tallies.items()
        for (outcome, place), times in tally.offences.most_common()
    ]


def _told(name: str, tally: Tally) -> str:
    size = f"slowest {tally.slowest:.2f} s, largest {tally.largest / 1e6:.0f} MB"
    return f"{name}: {_counted(tally.outcomes)}, {size}"


def _counted(counts: Counter[str]) -> str:
    return ", ".join(f"{count:,} {name}" for name, count in counts.most_common())


def _replayed(paths: list[Path]) -> int:
    formats = [one for group in FORMATS.values() for one in group]
    verdicts = [replay(formats, path) for path in paths]
    for path, verdict in zip(paths, verdicts, strict=True):
        print(f"{path}: {verdict.outcome} {verdict.place}\n{verdict.detail}".rstrip())
    return int(any(verdict.is_offence for verdict in verdicts))


if __name__ == "__main__":
    sys.exit(main())
