"""One process that assesses, sizes and reports ten thousand times does not grow."""

from __future__ import annotations

import gc
import os
from collections import Counter
from collections.abc import Callable
from typing import Final

import numpy as np

import puma_septic as ps
from campaign.moves import POINTS, cycle, puma

GROWTH: Final = 5_000_000  # bytes
_WARM: Final = 0.1  # part of the calls before the first look, in which caches fill, ...
_MOST_WARM: Final = 100  # ... and at most


def run(count: int, seed: int) -> tuple[Counter[str], list[str]]:
    """So many assessments, sizings and reports, each of a move of its own; they grow by less than `GROWTH` together."""
    rng = np.random.default_rng([seed, 5])
    found: Counter[str] = Counter()
    total = 0
    for work in (_assess, _size, _report):
        before, after = _grown(work, count, rng)
        total += after - before
        found[f"{work.__name__.strip('_')}: {count} calls, {(after - before) / 1e6:+.1f} MB"] += 1
    return found, [f"{3 * count} calls: {total / 1e6:.1f} MB more"] if total > GROWTH else []


def _grown(work: Callable[[np.random.Generator], object], times: int, rng: np.random.Generator) -> tuple[int, int]:
    """Resident bytes after the first calls, and after all."""
    warm = max(3, min(_MOST_WARM, int(_WARM * times)))
    for _ in range(warm):
        work(rng)
    before = _resident()
    for _ in range(times - warm):
        work(rng)
    return before, _resident()


def _resident() -> int:
    gc.collect()
    with open("/proc/self/statm", encoding="ascii") as stream:
        return int(stream.read().split()[1]) * os.sysconf("SC_PAGESIZE")


def _assess(rng: np.random.Generator) -> ps.Assessment:
    points = np.array(POINTS) + rng.normal(scale=0.05, size=(2, 6))
    return ps.assess(puma(), ps.quintic_segments(points, [0.0, float(rng.uniform(1.5, 3))]))


def _report(rng: np.random.Generator) -> str:
    return ps.report_html(_assess(rng))


def _size(rng: np.random.Generator) -> object:
    robot = puma().with_payload(ps.Payload(mass=float(rng.uniform(0, 2))))
    motion = ps.compute_motion(robot, cycle().steps[0].trajectory)
    return ps.size(ps.cycle.with_return(motion, dwell=0.5), drivetrains=ps.load_drivetrains(robot)).to_dict()
