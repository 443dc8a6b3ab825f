"""Public functions and values, called rightly but for one argument: an error of our own, or a finite answer."""

from __future__ import annotations

import dataclasses
import inspect
import os
import shutil
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any, Final

import numpy as np

import puma_septic as ps
from campaign.api_calls import Calls, calls
from campaign.moves import ROOT, move
from campaign.outputs import inputs
from campaign.rules import message_faults

# In place of an argument, whatever it is.
_ANY: Final = (
    None, True, "x", "0.5", b"1", float("nan"), float("inf"), float("-inf"), -1, 0, 1, -0.5, 1e308, -1e308, 1e300,
    1e150, 1e-320, 10**400, 1 + 2j, [], (), {}, [[]], [[1.0], [2.0, 3.0]], ["a"], [None], object(), Decimal("0.1"),
    Fraction(1, 3), np.array(0.5), np.array([1.0, np.nan]), np.ma.masked_array([1.0, 2.0], mask=[True, False]),
    np.array(["1", "2"]), np.array([object()]), datetime(2026, 1, 1, tzinfo=UTC), timedelta(seconds=1), range(3),
    Path("x"), lambda: 1, set(), int, "\x1b[2J", "x" * 5000, "\u202e", {"a": 1}, np.zeros((0, 6)),
    np.zeros((2, 2, 2, 2)), slice(1), NotImplemented,
)  # fmt: skip

# In place of one number of an array.
_NUMBERS: Final = (
    float("nan"), float("inf"), -1e300, 1e150, 1e-300, 5e-324, -1.0, 0.0, 1e-12, True, "0.5", "\u0661", None, 10**400,
    1j, [1.0], Fraction(1, 3), Decimal("0.1"),
)  # fmt: skip

# Of these NaN is a number that is not known.
_MAY_BE_UNKNOWN: Final = (
    "Limits", "Actuator", "Friction", "Motor", "Gearbox", "Drive", "Supply", "LinearStage", "Conditions",
    "Robot.with_limits", "least_time", "sizing.bearing_life", "sizing.equivalent_load",
)  # fmt: skip
# Of these infinity, or NaN, is an answer that is documented: evaluated at every instant, not filtered, without load or
# motion, for ever, no mass or any mass.
_MAY_BE_INFINITE: Final = (
    "Controller(rate)", "Controller(velocity_filter)", "sizing.bearing_life(equivalent)",
    "sizing.bearing_life(mean_speed)", "sizing.overload_time(overload)", "payload_over_duration(durations)",
)  # fmt: skip


def run(count: int, seed: int) -> tuple[Counter[str], list[str]]:
    """So many calls with one bad argument, evenly over all arguments."""
    _files()
    table = _sound(calls())
    places = [(name, key) for name, (_, given) in table.items() for key in given]
    rng = np.random.default_rng([seed, 4])
    found: Counter[str] = Counter()
    kept = os.dup(1)
    examples: dict[str, str] = {}
    baseline = {name: _infinite(function(**given)) for name, (function, given) in table.items()}
    for k in range(count):
        name, key = places[k % len(places)]
        function, given = table[name]
        bad = _bad(rng, given[key], k // len(places))
        outcome, wrong = _called(function, {**given, key: bad}, baseline[name])
        is_meant = (name in _MAY_BE_UNKNOWN and _is_unknown(bad)) or f"{name}({key})" in _MAY_BE_INFINITE
        if outcome == "not finite" and is_meant:
            outcome, wrong = "answer", ""
        found[outcome] += 1
        if wrong := wrong or _closed(kept):
            examples.setdefault(f"{name}({key}): {wrong}", _short(bad))
    return found, [f"{told}, of {example}" for told, example in examples.items()]


def _files() -> None:
    """What the calls read, in the current folder."""
    inputs([])
    Path("plan.yaml").unlink(missing_ok=True)
    ps.write_joint_trajectory("plan.yaml", move())
    for name, kind in (("m.csv", "motors"), ("g.csv", "gearboxes")):
        shutil.copy(ROOT / "puma_septic" / "catalogues" / f"puma560_{kind}.csv", name)


def _sound(table: Calls) -> Calls:
    """The calls whose words the functions have; a function that changes its words must be changed here too."""
    for name, (function, given) in table.items():
        words = inspect.signature(function).parameters
        lacking = [
            key for key in given if key not in words and not any(p.kind is p.VAR_KEYWORD for p in words.values())
        ]
        if lacking:
            raise RuntimeError(f"{name} has no {', '.join(lacking)}, but {', '.join(words)}")
    return dict(table)


def _bad(rng: np.random.Generator, right: Any, turn: int) -> Any:
    """Another kind of value, or a right array with one number, its shape or its type changed."""
    try:
        array = np.array(right, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if not array.size or turn % 2:
        return _ANY[int(rng.integers(len(_ANY)))]
    if array.ndim and rng.integers(2):
        changed = array.astype(object)
        changed[tuple(int(rng.integers(n)) for n in array.shape)] = _NUMBERS[int(rng.integers(len(_NUMBERS)))]
        return changed.tolist()
    return (
        array[..., None], array[:1] if array.ndim else -array, np.concatenate([array.ravel()] * 2),
        array.astype(complex) + 1j, np.ma.masked_array(array, mask=True), array.astype(str), array.astype(object),
        -array, 0 * array, 1e-320 * array,
    )[int(rng.integers(10))]  # fmt: skip


def _called(function: Callable[..., Any], given: dict[str, Any], usual: set[str]) -> tuple[str, str]:
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("error", module="puma_septic")
            result = function(**given)
    except ps.PumaSepticError as error:
        return "own error", message_faults(str(error))
    except Exception as error:
        frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "puma_septic" in frame.filename]
        place = f"{Path(frames[-1].filename).name}:{frames[-1].name}" if frames else "outside"
        return "raw exception", f"{type(error).__name__} in {place}"
    strange = _infinite(result) - usual
    return ("not finite", f"not finite: {', '.join(sorted(strange))}") if strange else ("answer", "")


def _closed(kept: int) -> str:
    """Which of the process's own streams is closed, as a number in place of a path does; it is opened again."""
    closed = []
    for stream in (0, 1, 2):
        try:
            os.fstat(stream)
        except OSError:
            closed.append(str(stream))
            os.dup2(kept, stream)
    return f"closes stream {' and '.join(closed)}" if closed else ""


def _infinite(result: Any) -> set[str]:
    """Which arrays and numbers of an answer are not finite, one level deep; limits may be unknown."""
    if dataclasses.is_dataclass(result):
        parts = {field.name: getattr(result, field.name, None) for field in dataclasses.fields(result)}
    else:
        parts = {"result": result}
    return {
        name
        for name, value in parts.items()
        if isinstance(value, (float, np.ndarray))
        and np.asarray(value).dtype.kind in "fc"
        and not np.isfinite(value).all()
    }


def _is_unknown(value: Any) -> bool:
    """Whether NaN or None was given, which is what such values have for what is not known; nothing behind a mask."""
    items = np.array(np.ma.getdata(value) if isinstance(value, np.ndarray) else value, dtype=object).ravel()
    return any(item is None or (isinstance(item, float) and np.isnan(item)) for item in items)


def _short(value: Any) -> str:
    return " ".join(ascii(value).split())[:60]
