"""The same work in 8 threads, in 4 processes and alone gives the same bytes; with another BLAS, the same digits."""

from __future__ import annotations

import json
import multiprocessing
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from typing import Any, Final

import numpy as np

import puma_septic as ps
from campaign.moves import POINTS, cycle, puma
from campaign.plain import numbers_of

_DIGITS: Final = 9  # what a document's numbers have in common whatever the number of BLAS threads and the processor
# What OpenBLAS is told, beside one thread and the kernels of this processor.
_OTHERWISE: Final = {
    "2 BLAS threads": {"OPENBLAS_NUM_THREADS": "2", "OMP_NUM_THREADS": "2"},
    "the BLAS kernels of an old processor": {"OPENBLAS_CORETYPE": "Prescott"},
}


def document(index: int) -> str:
    """JSON of one assessment and, of every eighth, of a sizing; of moves that depend on the index alone."""
    rng = np.random.default_rng(index)
    points = np.array(POINTS) + rng.normal(scale=0.1, size=(2, 6))
    texts = [json.dumps(ps.assess(puma(), ps.quintic_segments(points, [0.0, 2.0])).to_dict())]
    if index % 8 == 0:
        texts.append(json.dumps(ps.size(cycle(), catalogue=ps.built_in_catalogue("puma560"), keep=2).to_dict()))
    return "\n".join(texts)


def run(count: int, _seed: int) -> tuple[Counter[str], list[str]]:
    """So many documents, each five ways."""
    indices = list(range(count))
    alone = [document(k) for k in indices]
    with ThreadPoolExecutor(8) as pool:
        threads = list(pool.map(document, indices))
    with ProcessPoolExecutor(4, mp_context=multiprocessing.get_context("spawn")) as pool:
        processes = list(pool.map(document, indices, chunksize=max(1, count // 8)))
    offences = [
        f"{name}: document {k} differs"
        for name, others in (("8 threads", threads), ("4 processes", processes))
        for k, (one, other) in enumerate(zip(alone, others, strict=True))
        if one != other
    ]
    found = Counter({"documents, identical in 8 threads and 4 processes": count - len(offences)})
    usual = _documents(min(count, 16), {})
    for name, told in _OTHERWISE.items():
        others = _documents(min(count, 16), told)
        digits, same = _digits(usual, others), sum(map(str.__eq__, usual, others))
        found[f"numbers alike to {digits} digits with {name}; {same} of {len(usual)} documents identical"] += 1
        if digits < _DIGITS:
            offences.append(f"{name}: {digits} digits agree only")
    return found, offences


def _digits(usual: list[str], others: list[str]) -> int:
    """In common of all numbers, each relative to the largest of its kind."""
    worst = max(
        (difference for pair in zip(usual, others, strict=True) for difference in _differences(*pair)), default=0
    )
    return 16 if worst == 0 else int(-np.log10(worst))


def _documents(count: int, told: dict[str, str]) -> list[str]:
    """The first documents of a process whose OpenBLAS is told this."""
    program = f"from campaign.threads import document\nfor k in range({count}): print(document(k))"
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", **told}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def _differences(one: str, other: str) -> Iterator[float]:
    """Of two documents, relative to the largest number of the same key; a number that only one has counts whole."""
    a, b = (dict(numbers_of(json.loads(text))) for text in (one, other))
    scale: dict[Any, float] = {}
    for way, value in a.items():
        key = next((part for part in reversed(way) if isinstance(part, str)), "")
        scale[key] = max(scale.get(key, 0.0), abs(value))
    for way in a.keys() | b.keys():
        key = next((part for part in reversed(way) if isinstance(part, str)), "")
        if way not in a or way not in b:
            yield 1.0
        elif a[way] != b[way]:
            # A peak is flat: of its instant two digits fewer are known.
            yield (1e-2 if "time" in key else 1.0) * abs(a[way] - b[way]) / max(scale[key], 1e-300)
