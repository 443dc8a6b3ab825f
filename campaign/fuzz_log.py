"""Logs: the rows that are used are rows of the file; one in twelve is fitted and assessed."""

from __future__ import annotations

import csv
import zlib
from pathlib import Path
from typing import Final

import numpy as np

import puma_septic as ps
from campaign.moves import move, puma
from campaign.mutation import Rng, chosen, mangled_bytes, mutated_text
from campaign.plain import check_assessment, plain_number
from campaign.rules import UnsoundError

_HEADS: Final = (
    "t,{}", "time,{}", "stamp[ms],{}", "t;{}", "t\t{}", "# a remark\nt,{}", "t,{},joint1_vel", "t,{},note",
    "\ufefft,{}",
)  # fmt: skip
_CELLS: Final = (
    "nan", "inf", "", "1e308", "1e-300", "1e17", "1.7e9", "1700000000.123", "0.0", "-", "1,5", "\x1b[2J", "0x10",
    "1_0", "٣", "\x00", "9" * 400, "1:30", "true",
)  # fmt: skip


def make(rng: Rng) -> bytes:
    """Samples of one move, with another clock, noise or separators, and then changed."""
    count = int(rng.integers(3, 120))
    t = np.linspace(0.0, 2.0, count)
    q = move()(t) + rng.normal(scale=10.0 ** rng.integers(-9, -2), size=(count, 6)) * (rng.random() < 0.5)
    start, scale = (
        float(rng.choice([0, 0, 5, 1e5, 1.7e9, 1e17, -3])),
        float(rng.choice([1, 1, 1, 1e-3, 1e3, 1e-160, 1e-300])),
    )
    head = chosen(rng, _HEADS).format(",".join(puma().joint_names))
    separator = ";" if "t;" in head else "\t" if "t\t" in head else ","
    factor = 1e3 if "[ms]" in head else 1.0
    rows = [
        separator.join(f"{value:.{int(rng.choice([6, 9, 17]))}g}" for value in (factor * (start + scale * at), *row))
        for at, row in zip(t, q, strict=True)
    ]
    text = "\n".join([head.replace(",", separator), *rows, ""])
    if rng.random() < 0.3:
        return text.encode()
    if rng.random() < 0.12:
        return mangled_bytes(rng, text.encode())
    return mutated_text(rng, text, (_cell, _rows)).encode("utf-8", "surrogatepass")


def check(path: Path) -> None:
    """Read it with the PUMA's joints, find its rows in the text, and assess one in twelve."""
    log = ps.read_log(path, puma())
    if not (np.isfinite(log.q).all() and np.isfinite(log.t).all() and (np.diff(log.t) > 0).all()):
        raise UnsoundError("samples: not finite, or not in order")
    _check_rows(path.read_text(encoding="utf-8-sig", errors="replace"), log.q)
    if zlib.crc32(path.read_bytes()) % 12:
        return
    trajectory = ps.fit_trajectory(log.t, log.q, joint_names=log.joint_names)
    check_assessment(ps.assess(puma(), trajectory))


def _check_rows(text: str, q: np.ndarray) -> None:
    """Where the header is the plain one, every sample must be one of the text's rows."""
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if not lines or lines[0].split(",")[1:] != list(puma().joint_names):
        return
    said = {tuple(map(plain_number, row[1:7])) for row in csv.reader(lines[1:])}
    for sample in q:
        if tuple(sample.tolist()) not in said:
            raise UnsoundError(f"sample: {sample.tolist()} is no row of the text")


def _cell(rng: Rng, text: str) -> str:
    lines = text.split("\n")
    k = int(rng.integers(len(lines)))
    cells = lines[k].split(",")
    cells[int(rng.integers(len(cells)))] = chosen(rng, _CELLS)
    lines[k] = ",".join(cells)
    return "\n".join(lines)


def _rows(rng: Rng, text: str) -> str:
    """The rows' own order turned, doubled or thinned."""
    head, *rows = text.split("\n")
    way = int(rng.integers(4))
    return "\n".join([head, *(rows[::-1], rows * 2, rows[:: int(rng.integers(2, 9))], rows[:2])[way]])
