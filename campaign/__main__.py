"""Try to break the package, part by part: ``python -m campaign``; ``python -m campaign --help`` tells how."""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("MPLBACKEND", "Agg")

from campaign import fuzz_catalogue, fuzz_log, fuzz_task, fuzz_toml, fuzz_trajectory, fuzz_urdf
from campaign.runner import Format, replay, run_cases
from puma_septic.views.tables import text_table

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


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m campaign", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"all by default: {', '.join(FORMATS)}")
    parser.add_argument("--seed", type=int, default=560)
    parser.add_argument("--cases", type=int, default=10_000, metavar="N", help="inputs of each format")
    parser.add_argument("--first", type=int, default=0, metavar="K", help="the case to begin with")
    parser.add_argument("--replay", nargs="+", type=Path, default=[], metavar="FILE", help="judge kept files again")
    given = parser.parse_args(argv)
    if given.replay:
        return _replayed(given.replay)
    bad = 0
    rows = []
    for part in given.parts or FORMATS:
        for one in FORMATS[part]:
            start = time.monotonic()
            tally = run_cases(one, range(given.first, given.first + given.cases), given.seed)
            counts = ", ".join(f"{count} {name}" for name, count in tally.outcomes.most_common())
            rows.append((one.name, f"{tally.cases}", counts, f"{tally.slowest:.2f} s", f"{tally.largest / 1e6:.0f} MB"))
            print(f"{one.name}: {tally.cases} in {time.monotonic() - start:.0f} s: {counts}", flush=True)
            for (outcome, place), count in tally.offences.most_common():
                print(f"  {count} x {outcome}: {place}", flush=True)
            bad += tally.n_offences
    print(text_table(("input", "cases", "outcome", "slowest", "largest"), rows))
    return int(bad > 0)


def _replayed(paths: list[Path]) -> int:
    formats = [one for group in FORMATS.values() for one in group]
    verdicts = [replay(formats, path) for path in paths]
    for path, verdict in zip(paths, verdicts, strict=True):
        print(f"{path}: {verdict.outcome} {verdict.place}\n{verdict.detail}".rstrip())
    return int(any(verdict.is_offence for verdict in verdicts))


if __name__ == "__main__":
    sys.exit(main())
