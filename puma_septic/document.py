"""What every result becomes: a document of plain values, as JSON and CSV have them."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Iterator, Mapping
from html import escape
from importlib import import_module
from math import inf, isinf, isnan, nan
from types import MappingProxyType
from typing import Any, Final

from puma_septic.errors import readable

__all__ = [
    "SCHEMAS",
    "card",
    "csv_text",
    "frame",
    "known",
    "numeric",
    "one_line",
    "plain",
    "records_csv",
    "to_json",
]

SCHEMAS: Final = MappingProxyType(
    {
        "accelerations": "puma-septic/accelerations/1",
        "assess": "puma-septic/assess/1",
        "assess-log": "puma-septic/assess-log/1",
        "assessment": "puma-septic/assessment/1",
        "check": "puma-septic/check/1",
        "comparison": "puma-septic/comparison/1",
        "cycle": "puma-septic/cycle/1",
        "doctor": "puma-septic/doctor/1",
        "execution": "puma-septic/execution/1",
        "ik": "puma-septic/ik/1",
        "least-time": "puma-septic/least-time/1",
        "limits": "puma-septic/limits/1",
        "maximum-payload": "puma-septic/maximum-payload/1",
        "minimum-duration": "puma-septic/minimum-duration/1",
        "optimisation": "puma-septic/optimisation/1",
        "paper": "puma-septic/paper/1",
        "pareto-front": "puma-septic/pareto-front/1",
        "profiles": "puma-septic/profiles/1",
        "robot": "puma-septic/robot/1",
        "selection": "puma-septic/selection/1",
        "simulation": "puma-septic/simulation/1",
        "sizing": "puma-septic/sizing/1",
        "stops": "puma-septic/stops/1",
        "study-summary": "puma-septic/study-summary/1",
        "sweep": "puma-septic/sweep/1",
    }
)
"""The schema of each kind of document, described in docs/json.md.

A key that is added keeps the number; one that is removed, renamed or means something else raises it.
"""

_UNBOUNDED: Final = "unbounded"
# Of one line: what a window shows without breaking it.
_LINE: Final = 160
# What a spreadsheet takes for the beginning of a formula, its full-width forms included: OWASP, "CSV Injection".
# A blank before it does not matter to all of them.
_FORMULA: Final = ("=", "+", "-", "@", "＝", "＋", "－", "＠")


def plain(value: Any) -> Any:
    """A number, an array or a mapping as JSON has it: infinity as "unbounded", what is not known as null.

    Returns
    -------
    float, str, None, list or dict
        Text is left as it is, keys too.

    Examples
    --------
    >>> plain({"peak": (1.5, float("inf")), "limit": float("nan")})
    {'peak': [1.5, 'unbounded'], 'limit': None}
    """
    if isinstance(value, str) or value is None:
        return value
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):  # an array, which this room need not load NumPy to know
        value = value.tolist()
    if isinstance(value, (tuple, list)):
        return [plain(item) for item in value]
    number = float(value)
    if isnan(number):
        return None
    if isinf(number):
        return _UNBOUNDED if number > 0 else f"-{_UNBOUNDED}"
    return number


def numeric(value: float | str | None) -> float:
    """The number that `plain` wrote.

    Returns
    -------
    float

    Examples
    --------
    >>> numeric(plain(float("-inf"))), numeric(plain(0.5)), numeric(None)
    (-inf, 0.5, nan)
    """
    if value is None:
        return nan
    if isinstance(value, str):
        return {_UNBOUNDED: inf, f"-{_UNBOUNDED}": -inf}[value]
    return float(value)


def to_json(document: Mapping[str, Any]) -> str:
    """JSON text with all digits of each number; NaN and Infinity, which JSON does not have, are a bug.

    Returns
    -------
    str
    """
    # What JSON may hold as it is and a terminal may not show: escaped, it is the same document.
    return readable(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)) + "\n"


def csv_text(rows: Iterable[Iterable[Any]]) -> str:
    r"""Rows as CSV; what is not known (None) is left empty.

    Text that a spreadsheet would take for a formula is marked as text by an apostrophe; a number written as text stays.

    Returns
    -------
    str

    Examples
    --------
    >>> csv_text([["joint", "margin"], ["=1+1", "-0.5"], ["elbow", None]])
    "joint,margin\n'=1+1,-0.5\nelbow,\n"
    """
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows([_cell(value) for value in row] for row in rows)
    return stream.getvalue()


def records_csv(records: Iterable[Mapping[str, Any]]) -> str:
    r"""Documents of one kind as CSV, one row each; what is nested has a column for each key or place.

    Returns
    -------
    str

    Examples
    --------
    >>> records_csv([{"name": "a", "q": [0.5, None], "limit": {"low": 1.0}}, {"name": "b", "q": [2.0, 3.0]}])
    'name,q 1,q 2,limit low\na,0.5,,1.0\nb,2.0,3.0,\n'
    """
    rows = [dict(_flat("", record)) for record in records]
    heads = list(dict.fromkeys(key for row in rows for key in row))
    return csv_text([heads, *([row.get(key) for key in heads] for row in rows)])


def _flat(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _flat(f"{name} {key}".strip(), item)
    elif isinstance(value, (list, tuple)) and all(isinstance(item, str) for item in value):
        yield name, "; ".join(value)
    elif isinstance(value, (list, tuple)):
        for k, item in enumerate(value):
            yield from _flat(f"{name} {k + 1}".strip(), item)
    else:
        yield name, value


def one_line(kind: str, facts: Mapping[str, object]) -> str:
    """A value in one line, for a terminal, a debugger, the message of a failed test.

    Returns
    -------
    str

    Examples
    --------
    >>> one_line("Motor", {"name": "F60", "peak torque": "3 N m"})
    '<Motor: name F60, peak torque 3 N m>'
    """
    said = ", ".join(f"{title} {text}" for title, text in facts.items())
    line = readable(" ".join(f"<{kind}: {said}>".split()))
    return line if len(line) <= _LINE else f"{line[: _LINE - 5]} ...>"


def card(kind: str, facts: Mapping[str, object]) -> str:
    """A value as a small table, for a notebook; every text is escaped.

    Returns
    -------
    str

    Examples
    --------
    >>> card("Motor", {"name": "<F60>"})
    '<table><caption>Motor</caption><tbody><tr><th>name</th><td>&lt;F60&gt;</td></tr></tbody></table>'
    """
    rows = "".join(
        f"<tr><th>{escape(str(title))}</th><td>{escape(str(text))}</td></tr>" for title, text in facts.items()
    )
    return f"<table><caption>{escape(kind)}</caption><tbody>{rows}</tbody></table>"


def known(value: object, units: Mapping[str, str]) -> dict[str, object]:
    """Those attributes of a value that are known, with their units, to four digits.

    Returns
    -------
    dict
    """
    facts: dict[str, object] = {}
    for name, unit in units.items():
        text = _written(getattr(value, name))
        if text:
            facts[name.replace("_", " ")] = f"{text} {unit}".strip()
    return facts


def frame(records: Iterable[Mapping[str, Any]], *, index: str | None = None) -> Any:
    """Documents of one kind as a pandas DataFrame, one row each; "unbounded" is infinity there.

    Raises
    ------
    ImportError
        Where pandas is not installed.
    """
    try:
        pandas = import_module("pandas")
    except ImportError as error:
        raise ImportError("to_dataframe needs pandas: python -m pip install 'puma-septic[pandas]'") from error
    rows = [{key: _floated(value) for key, value in _flat("", record)} for record in records]
    made = pandas.DataFrame(rows)
    return made if index is None else made.set_index(index)


def _floated(value: Any) -> Any:
    return numeric(value) if value in (_UNBOUNDED, f"-{_UNBOUNDED}") else value


def _written(value: Any) -> str:
    """A text, a number or numbers; empty where nothing is known."""
    if isinstance(value, str):
        return value
    numbers = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(numbers, list):
        texts = [_written(one) for one in numbers]
        return f"[{', '.join(text or '?' for text in texts)}]" if any(texts) else ""
    return "" if numbers is None or isnan(numbers) else f"{numbers:.4g}"


def _cell(value: Any) -> Any:
    if not isinstance(value, str):
        return "" if value is None else value
    # The writer puts quotes around a line feed, around a carriage return not: it would end the row.
    lines = value.replace("\r\n", "\n").replace("\r", "\n")
    is_formula = lines.startswith(("\t", "\n")) or lines.lstrip().startswith(_FORMULA)
    guard = "'" if is_formula and not _is_number(value) else ""
    return guard + readable(lines)


def _is_number(text: str) -> bool:
    if text == f"-{_UNBOUNDED}":
        return True
    try:
        float(text)
    except ValueError:
        return False
    return text == text.strip()
