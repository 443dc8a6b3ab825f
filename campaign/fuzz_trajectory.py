"""JointTrajectory messages as YAML and JSON: the trajectory passes the text's points; one in ten is checked."""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np
from ruamel.yaml import YAML

import puma_septic as ps
from campaign.moves import move, puma
from campaign.mutation import NAMES, Rng, changed_number, chosen, mangled_bytes, misspelt, mutated_text
from campaign.plain import check_answer, numbers_of
from campaign.rules import UnsoundError

_CLOSE: Final = 1e-9  # of points that are met by polynomials
_PLAIN: Final = (float, int)


@cache
def _message(suffix: str) -> str:
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"plan{suffix}"
        ps.write_joint_trajectory(path, move())
        return path.read_text(encoding="utf-8")


def maker(suffix: str) -> Callable[[Rng], bytes]:
    def make(rng: Rng) -> bytes:
        text = _message(suffix)
        if rng.random() < 0.12:
            return mangled_bytes(rng, text.encode())
        if rng.random() < 0.5:
            return mutated_text(rng, text).encode("utf-8", "surrogatepass")
        data = YAML(typ="safe", pure=True).load(text)
        for _ in range(int(rng.integers(1, 3))):
            _changed(rng, data)
        return json.dumps(data).encode("utf-8", "surrogatepass")  # JSON is YAML

    return make


def check(path: Path) -> None:
    """Its points against a second reading, and one in ten held against limits."""
    trajectory = ps.read_joint_trajectory(path, puma())
    text = path.read_text(encoding="utf-8-sig")
    data = json.loads(text) if path.suffix == ".json" else next(iter(YAML(typ="safe", pure=True).load_all(text)))
    if isinstance(data, dict) and isinstance(data.get("points"), list):
        _check_points(trajectory, data)
    if zlib.crc32(path.read_bytes()) % 10 == 0:
        check_answer(ps.check_trajectory(puma(), trajectory))


def _check_points(trajectory: ps.Trajectory, data: dict[str, Any]) -> None:
    order = [data["joint_names"].index(name) for name in trajectory.joint_names]
    begin, size = None, _size(trajectory.duration, data["points"])
    for point in data["points"]:
        at = point.get("time_from_start", {})
        if not (isinstance(at, dict) and isinstance(at.get("sec", 0), int) and isinstance(at.get("nanosec", 0), int)):
            return
        t = at.get("sec", 0) + at.get("nanosec", 0) * 1e-9
        begin = t if begin is None else begin
        said = np.array(point["positions"], dtype=float)[order]
        found = trajectory(min(t - begin, trajectory.duration) if begin else t)
        if not np.abs(found - said).max() <= _CLOSE * size:
            raise UnsoundError(f"point: {found.tolist()} at {t} s, the text has {said.tolist()}")


def _size(duration: float, points: list[dict[str, Any]]) -> float:
    """How far positions, velocities and accelerations of these numbers lead, rad: what polynomials are rounded by."""
    keys = ("positions", "velocities", "accelerations")
    reach = [abs(x) * duration**k for k, key in enumerate(keys) for one in points for _, x in numbers_of(one.get(key))]
    return max(1.0, *reach)


def _changed(rng: Rng, data: Any) -> None:
    """One value, key or entry of a nested document."""
    ways = list(_places(data))
    holder, key = ways[int(rng.integers(len(ways)))]
    way = rng.random()
    if way < 0.5 and isinstance(holder[key], _PLAIN):
        text = changed_number(rng, repr(holder[key]))
        holder[key] = _value(text)
    elif way < 0.6:
        holder[key] = [chosen(rng, NAMES), None, True, [], {}, [[]], {"sec": 1}, 1e308, 2**70][int(rng.integers(9))]
    elif way < 0.75 and isinstance(holder, dict):
        holder[misspelt(rng, str(key)) or "x"] = holder.pop(key)
    elif way < 0.85 and isinstance(holder, list):
        holder.insert(int(rng.integers(len(holder) + 1)), holder[key])
    else:
        del holder[key]


def _value(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _places(value: Any) -> Any:
    keys = list(value) if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for key in keys:
        yield value, key
        yield from _places(value[key])
