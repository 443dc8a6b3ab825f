"""What a study found: the usual questions, asked of its Parquet files by DuckDB, which loads no more than they need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

import duckdb
import numpy as np

from puma_septic.document import SCHEMAS, plain
from puma_septic.errors import InputError
from puma_septic.study._folder import StudyFolder
from puma_septic.validation import Array, checked_choice
from puma_septic.views import study as view

__all__ = ["StudyMap", "StudySummary", "study_map", "summarise_study"]

_MOST_LISTED: Final = 10
_MEANINGS: Final = ("feasible", "utilisation")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class StudySummary:
    """The usual questions about a study, answered.

    Attributes
    ----------
    name : str
    n_cases, n_done, n_failed, n_feasible : int
    governing : tuple of (str, str, int)
        Joint, quantity and how often it governs, the most frequent first.
    errors : tuple of (str, int)
        The most frequent errors.
    best : tuple of mapping
        Of each value of the payload the shortest feasible duration, where both are axes; else the feasible cases with
        the least utilisation.
    axes : tuple of (str, tuple of (value, cases, feasible))
        The feasible share along each axis of at most `_MOST_LISTED` values.
    """

    name: str
    n_cases: int
    n_done: int
    n_failed: int
    n_feasible: int
    governing: tuple[tuple[str, str, int], ...]
    errors: tuple[tuple[str, int], ...]
    best: tuple[dict[str, Any], ...]
    axes: tuple[tuple[str, tuple[tuple[Any, int, int], ...]], ...]

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document.

        Returns
        -------
        dict
        """
        return {
            "schema": SCHEMAS["study-summary"],
            "name": self.name,
            "n_cases": self.n_cases,
            "n_done": self.n_done,
            "n_failed": self.n_failed,
            "n_feasible": self.n_feasible,
            "governing": [{"joint": joint, "quantity": quantity, "cases": n} for joint, quantity, n in self.governing],
            "errors": [{"error": error, "cases": n} for error, n in self.errors],
            "best": [plain(one) for one in self.best],
            "axes": [
                {"name": name, "values": [{"value": plain(v), "cases": n, "feasible": ok} for v, n, ok in rows]}
                for name, rows in self.axes
            ],
        }

    def __str__(self) -> str:
        return view.text(self.to_dict())


def summarise_study(folder: str | Path) -> StudySummary:
    """Feasible share, what governs, errors, the front of duration and payload, and the share along each axis.

    Parameters
    ----------
    folder : str or Path
        Of a study, complete or not.

    Returns
    -------
    StudySummary

    Raises
    ------
    InputError
        Where no study stands, or a chunk is damaged.
    """
    definition, query = _opened(folder)
    columns = {row[0] for row in query("describe select * from cases").fetchall()}
    has = {name: name in columns for name in ("feasible", "governing_joint", "utilisation")}
    feasible = "coalesce(sum(feasible::int), 0)" if has["feasible"] else "0"
    done, failed, ok = query(f"select count(*), coalesce(sum((error <> '')::int), 0), {feasible} from cases").fetchone()
    governing = query(
        "select governing_joint, governing_quantity, count(*) as n from cases where governing_joint <> ''"
        f" group by all order by n desc, 1, 2 limit {_MOST_LISTED}"
    ).fetchall() if has["governing_joint"] else []  # fmt: skip
    errors = query(
        "select error, count(*) as n from cases where error <> '' group by all"
        f" order by n desc, error limit {_MOST_LISTED}"
    ).fetchall()
    axes = tuple(
        (name, tuple(rows))
        for name in definition["axes"]
        if 0 < len(rows := _along(query, name, feasible)) <= _MOST_LISTED
    )
    return StudySummary(
        name=definition["name"],
        n_cases=definition["n_cases"],
        n_done=int(done),
        n_failed=int(failed),
        n_feasible=int(ok),
        governing=tuple((str(j), str(q), int(n)) for j, q, n in governing),
        errors=tuple((str(error), int(n)) for error, n in errors),
        best=tuple(_best(query, definition, has)),
        axes=axes,
    )


def _along(query: Any, name: str, feasible: str) -> list[tuple[Any, int, int]]:
    rows = query(
        f'select "axis:{name}", count(*), {feasible} from cases group by 1 order by 1 limit {_MOST_LISTED + 1}'
    ).fetchall()
    return [(value, int(n), int(ok)) for value, n, ok in rows]


def _best(query: Any, definition: dict[str, Any], has: dict[str, bool]) -> list[dict[str, Any]]:
    if not has["feasible"]:
        return []
    names = list(definition["axes"])
    if {"duration", "payload"} <= set(names):
        rows = query(
            'select "axis:payload", min("axis:duration") from cases where feasible group by 1 order by 1'
        ).fetchall()
        step = max(1, -(-len(rows) // _MOST_LISTED))
        return [{"payload": payload, "duration": duration} for payload, duration in rows[::step]]
    if not has["utilisation"]:
        return []
    chosen = ", ".join(f'"axis:{name}"' for name in names)
    rows = query(
        f'select {chosen}, utilisation from cases where feasible order by utilisation, "case" limit {_MOST_LISTED}'
    ).fetchall()
    return [dict(zip([*names, "utilisation"], row, strict=True)) for row in rows]


def _opened(folder: str | Path) -> tuple[dict[str, Any], Any]:
    """A study's definition, and what answers queries of the view "cases"."""
    place = StudyFolder(path=Path(folder))
    definition = place.definition()
    files = place.finished().values()
    if not files:
        raise InputError(f"{place.path}: no chunk is finished yet; run the study")
    connection = duckdb.connect()
    relation = connection.read_parquet([str(file) for file in files])
    relation.create_view("cases")
    return definition, connection.execute


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class StudyMap:
    """A column over two axes.

    Attributes
    ----------
    x_name, y_name, column : str
    x, y : ndarray, shapes (n,) and (m,)
    values : ndarray, shape (m, n)
        The feasible share, or the least utilisation, over all other axes; NaN where there is no case.
    """

    x_name: str
    y_name: str
    column: str
    x: Array
    y: Array
    values: Array


def study_map(folder: str | Path, x: str, y: str, *, column: str = "feasible") -> StudyMap:
    """The feasible share or the least utilisation over two axes of numbers.

    Returns
    -------
    StudyMap

    Raises
    ------
    InputError
        As `summarise_study`, and for an unknown axis or column, or an axis that is not of numbers.
    """
    definition, query = _opened(folder)
    names: Sequence[str] = list(definition["axes"])
    for name in (x, y):
        checked_choice("axis", name, names)
        kind = query(f'select typeof(any_value("axis:{name}")) from cases').fetchone()[0]
        if kind != "DOUBLE":
            raise InputError(f"axis {name!r} is not of numbers; a map needs two that are")
    checked_choice("column", column, _MEANINGS)
    found = {row[0] for row in query("describe select * from cases").fetchall()}
    if column not in found:
        raise InputError(f"the study has no column {column!r}; it has {', '.join(sorted(found))}")
    value = "avg(feasible::int)" if column == "feasible" else "min(utilisation)"
    rows = query(f'select "axis:{x}", "axis:{y}", {value} from cases group by 1, 2').fetchnumpy()
    xs, ys, values = (np.ma.filled(column_, np.nan) for column_ in rows.values())
    grid_x, at_x = np.unique(xs, return_inverse=True)
    grid_y, at_y = np.unique(ys, return_inverse=True)
    grid = np.full((len(grid_y), len(grid_x)), np.nan)
    grid[at_y, at_x] = values
    return StudyMap(x_name=x, y_name=y, column=column, x=grid_x, y=grid_y, values=grid)
