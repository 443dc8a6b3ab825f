"""What a study asks: a task, the axes along which it varies, and the columns that each case gives."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, prod
from pathlib import Path
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from puma_septic._version import __version__
from puma_septic.errors import InputError, did_you_mean
from puma_septic.files import checked_path, decoded, read_bytes, sha256_of, yaml_documents
from puma_septic.task import Task, load_task, make_task
from puma_septic.validation import Array, checked_choice, checked_kind, checked_whole

__all__ = ["COLUMNS", "SCALED", "Study", "load_study", "make_study"]

COLUMNS: Final = ("feasible", "certificate", "governing", "margins", "peaks", "rms")
"""What a case can be asked for; all by default."""

SCALED: Final = ("duration", "payload")
"""Axes whose cases share one pass of the dynamics: s, and kg at the task's centre of mass."""

_KEYS: Final = ("name", "task", "axes", "sampling", "cases", "columns", "chunk")
_MAX_BYTES: Final = 4_000_000
_MAX_DEPTH: Final = 16
_CHUNK: Final = 10_000
# Values of an axis, or drawn cases; they are all held in memory.
_MOST: Final = 10_000_000
_SAMPLINGS: Final = ("grid", "list", "latin_hypercube")
# A drawn value of an axis of names is its place, as a part of 1.
_RANGE: Final = ("from", "to", "count", "spacing")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Axis:
    """One thing that varies.

    Attributes
    ----------
    name : str
        "duration", "payload", "profile", or the place of a value in the task, "robot.limits", "points.1.position.0".
    values : tuple
        Numbers, names, or what the task's schema takes there.
    bounds : tuple of float or None
        Of a continuous axis of a Latin hypercube.
    """

    name: str
    values: tuple[Any, ...]
    bounds: tuple[float, float] | None = None


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Study:
    """A study, checked; made by `load_study` or `make_study`.

    Attributes
    ----------
    name : str
    task : Task
        What is varied.
    axes : tuple of Axis
        The scaled ones last, so that neighbouring cases share their shape.
    drawn : ndarray or None
        Of a Latin hypercube or a list, the place of each case on each axis, (n, axes); None for a grid.
    columns : tuple of str
    chunk : int
        Cases in one file.
    """

    name: str
    task: Task
    axes: tuple[Axis, ...]
    drawn: Array | None
    columns: tuple[str, ...]
    chunk: int

    @property
    def n_cases(self) -> int:
        """How many cases there are."""
        return len(self.drawn) if self.drawn is not None else prod(len(axis.values) for axis in self.axes)

    @property
    def n_chunks(self) -> int:
        """How many files they take."""
        return -(-self.n_cases // self.chunk)

    @property
    def digest(self) -> str:
        """Names the study: another task, axis, column or version has another one."""
        return hashlib.sha256(json.dumps(self.document(), sort_keys=True).encode()).hexdigest()

    def document(self) -> dict[str, Any]:
        """A JSON-ready document of all that decides the answer."""
        return {
            "version": __version__,
            "name": self.name,
            "task": self.task.document(),
            "axes": {axis.name: list(axis.values) if axis.bounds is None else list(axis.bounds) for axis in self.axes},
            "drawn": None if self.drawn is None else hashlib.sha256(self.drawn.tobytes()).hexdigest(),
            "files": {path: sha256_of(Path(path)) for path in self._files},
            "columns": list(self.columns),
            "chunk": self.chunk,
            "n_cases": self.n_cases,
        }

    @property
    def _files(self) -> list[str]:
        """Files that the task's robot is made of, meshes apart."""
        robot = self.task.document().get("robot", {})
        return [str(robot[key]) for key in ("source", "actuators") if Path(str(robot.get(key, ""))).is_file()]

    def places(self, cases: NDArray[np.int64]) -> Array:
        """The place of each case on each axis, (n, axes): an index, or of a continuous axis the value itself."""
        if self.drawn is not None:
            return self.drawn[cases]
        return np.stack(np.unravel_index(cases, [len(axis.values) for axis in self.axes]), axis=1).astype(float)

    def values(self, k: int, places: Array) -> list[Any]:
        """Values of axis k at some of its places."""
        axis = self.axes[k]
        return places.tolist() if axis.bounds is not None else [axis.values[int(place)] for place in places]


def load_study(path: str | Path) -> Study:
    """Read a study file (YAML); paths in it are relative to its folder.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        For a file that cannot be read, an unknown key, axis or column, an empty axis; with what would be valid.
    """
    file = checked_path(path, "study file")
    text = decoded(read_bytes(file, what="study file", at_most=_MAX_BYTES), file)
    documents = yaml_documents(text, str(file), max_depth=_MAX_DEPTH)
    if len(documents) != 1 or not isinstance(documents[0], Mapping):
        raise InputError(f"{file}: expected one mapping with the keys {', '.join(_KEYS)}")
    return make_study(documents[0], origin=str(file), folder=file.parent)


def make_study(data: Mapping[str, Any], *, origin: str = "study", folder: str | Path = ".") -> Study:
    """A study from a mapping with a study file's keys.

    Parameters
    ----------
    data : mapping
        ``task`` (a name, a path or a task), ``axes`` (name to a list of values, or ``{from, to, count, spacing}``),
        ``sampling`` ("grid", "list" or ``{latin_hypercube: count, seed: n}``), ``cases`` (of a list), ``columns``,
        ``chunk``, ``name``.
    origin : str
        What messages call it.
    folder : str or Path
        What paths are relative to.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        As `load_study`.

    Examples
    --------
    >>> axes = {"duration": [8, 9], "payload": {"from": 0, "to": 2, "count": 3}}
    >>> study = make_study({"task": "paper-turned", "axes": axes})
    >>> study.n_cases, [axis.name for axis in study.axes]
    (6, ['duration', 'payload'])
    """
    _known_keys(checked_kind(origin, data, Mapping), _KEYS, origin)
    task = _task(data.get("task"), origin, checked_path(folder, "folder"))
    sampling, seed, count = _sampling(data.get("sampling", "grid"), origin)
    given = _listed(data.get("cases"), origin) if sampling == "list" else data.get("axes")
    if not isinstance(given, Mapping) or not given:
        raise InputError(f"{origin}: axes: expected a mapping of at least one axis to its values")
    axes = [_axis(name, values, task, origin, is_drawn=sampling == "latin_hypercube") for name, values in given.items()]
    axes.sort(key=lambda axis: axis.name in SCALED)
    columns = tuple(data.get("columns", COLUMNS))
    _known_keys(dict.fromkeys(columns), COLUMNS, f"{origin}: columns")
    return Study(
        name=str(data.get("name", task.name)),
        task=task,
        axes=tuple(axes),
        drawn=_drawn(sampling, axes, given, count, seed),
        columns=columns,
        chunk=checked_whole(f"{origin}: chunk", data.get("chunk", _CHUNK), at_least=1),
    )


def _known_keys(data: Mapping[Any, Any], valid: Sequence[str], origin: str) -> None:
    unknown = [str(key) for key in data if key not in valid]
    if unknown:
        names = f"unknown {', '.join(map(repr, unknown))}; valid: {', '.join(valid)}"
        raise InputError(f"{origin}: {names}{did_you_mean(unknown, valid)}")


def _task(given: Any, origin: str, folder: Path) -> Task:
    if isinstance(given, Mapping):
        return make_task(given, origin=f"{origin}: task", folder=folder)
    if not isinstance(given, str):
        raise InputError(f"{origin}: task: expected the name of a task, a task file or a task, got {given!r}")
    path = folder / given
    return load_task(path if path.suffix in (".yaml", ".yml") else given)


def _sampling(given: Any, origin: str) -> tuple[str, int, int]:
    if isinstance(given, Mapping):
        _known_keys(given, ("latin_hypercube", "seed"), f"{origin}: sampling")
        count = checked_whole(f"{origin}: latin_hypercube", given.get("latin_hypercube"), at_least=1, at_most=_MOST)
        return "latin_hypercube", checked_whole(f"{origin}: seed", given.get("seed", 0), at_least=0), count
    return checked_choice(f"{origin}: sampling", given, _SAMPLINGS[:2]), 0, 0


def _listed(cases: Any, origin: str) -> Mapping[str, list[Any]]:
    """A list of cases, each a mapping of every axis to its value, as a value of each case on each axis."""
    if not isinstance(cases, list) or not cases or not all(isinstance(case, Mapping) for case in cases):
        raise InputError(f"{origin}: cases: expected a list of mappings of axes to values")
    names = list(cases[0])
    for k, case in enumerate(cases):
        if set(case) != set(names):
            raise InputError(f"{origin}: cases[{k}]: expected the axes {', '.join(names)}, got {', '.join(case)}")
    return {name: [case[name] for case in cases] for name in names}


def _axis(name: str, given: Any, task: Task, origin: str, *, is_drawn: bool) -> Axis:
    where = f"{origin}: axis {name!r}"
    if name not in (*SCALED, "profile"):
        placed(task.document(), name, None, where)
    if isinstance(given, Mapping):
        return _range(name, given, where, is_drawn=is_drawn)
    if not isinstance(given, list) or not given:
        raise InputError(f"{where}: expected a list of values, or from, to and count, got {given!r}")
    if name in SCALED:
        given = [_number(value, where) for value in given]
        _check_scaled(name, min(given), where)
    return Axis(name=name, values=tuple(given))


def _range(name: str, given: Mapping[str, Any], where: str, *, is_drawn: bool) -> Axis:
    _known_keys(given, _RANGE, where)
    low, high = (_number(given.get(key), f"{where}, {key}") for key in ("from", "to"))
    if name in SCALED:
        _check_scaled(name, low, where)
    if is_drawn:
        if not low < high:
            raise InputError(f"{where}: from = {low:g} is not below to = {high:g}")
        return Axis(name=name, values=(), bounds=(low, high))
    count = checked_whole(f"{where}, count", given.get("count"), at_least=1, at_most=_MOST)
    spacing = checked_choice(f"{where}, spacing", given.get("spacing", "even"), ("even", "geometric"))
    if spacing == "geometric" and not min(low, high) > 0:
        raise InputError(f"{where}: a geometric spacing needs positive ends, got {low:g} and {high:g}")
    make = np.geomspace if spacing == "geometric" else np.linspace
    return Axis(name=name, values=tuple(make(low, high, count).tolist()))


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise InputError(f"{where}: expected a finite number, got {value!r}")
    return float(value)


def _check_scaled(name: str, least: float, where: str) -> None:
    if least < 0 or (name == "duration" and least == 0):
        raise InputError(f"{where}: {least:g} must be {'above' if name == 'duration' else 'at least'} 0")


def _drawn(sampling: str, axes: Sequence[Axis], given: Mapping[str, Any], count: int, seed: int) -> Array | None:
    if sampling == "grid":
        return None
    if sampling == "list":
        n = len(next(iter(given.values())))
        return np.repeat(np.arange(float(n))[:, None], len(axes), axis=1)
    unit = qmc.LatinHypercube(len(axes), rng=np.random.default_rng(seed)).random(count)
    columns = [
        np.floor(unit[:, k] * len(axis.values)) if axis.bounds is None
        else axis.bounds[0] + unit[:, k] * (axis.bounds[1] - axis.bounds[0])
        for k, axis in enumerate(axes)
    ]  # fmt: skip
    # Cases of one shape side by side: they share its passes.
    drawn = np.stack(columns, axis=1)
    return drawn[np.lexsort(drawn.T[::-1])]


def placed(document: Any, place: str, value: Any, where: str) -> None:
    """Write a value (None: none) to a place of a task's document, such as "points.1.position.0".

    Raises
    ------
    InputError
        For a place that the task has not, with what is there.
    """
    parts = str(place).split(".")
    for part in parts[:-1]:
        document = _inside(document, part, place, where)
    if isinstance(document, list):
        k = _index(document, parts[-1], place, where)
        if value is not None:
            document[k] = value
    elif isinstance(document, dict):
        if value is not None:
            document[parts[-1]] = value
        elif len(parts) == 1 and parts[0] not in Task.model_fields:
            valid = (*SCALED, "profile", *Task.model_fields)
            raise InputError(f"{where}: unknown; valid: {', '.join(valid)}{did_you_mean([place], valid)}")
    else:
        raise InputError(f"{where}: the task has no place inside {'.'.join(parts[:-1])!r}")


def _inside(document: Any, part: str, place: str, where: str) -> Any:
    if isinstance(document, list):
        return document[_index(document, part, place, where)]
    if isinstance(document, dict):
        if part not in document and part not in Task.model_fields:
            near = did_you_mean([part], document)
            raise InputError(f"{where}: the task has no {part!r} there; it has {', '.join(document)}{near}")
        return document.setdefault(part, {})
    raise InputError(f"{where}: the task has no {part!r} there, in {place!r}")


def _index(items: Sequence[Any], part: str, place: str, where: str) -> int:
    names = [item.get("name") if isinstance(item, dict) else None for item in items]
    if part in names:
        return names.index(part)
    if part.isdecimal() and int(part) < len(items):
        return int(part)
    valid = " or ".join([f"0 to {len(items) - 1}", *(str(name) for name in names if name)])
    raise InputError(f"{where}: {part!r} of {place!r} is none of {valid}")
