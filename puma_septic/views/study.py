"""What a study found, as text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from puma_septic.views.tables import Cell, text_table

__all__ = ["text"]

Document = Mapping[str, Any]


def text(document: Document) -> str:
    """Shares and tables."""
    done, total = document["n_done"], document["n_cases"]
    lines = [
        f"{document['name']}: {done:,} of {total:,} cases, {document['n_feasible']:,} feasible"
        f" ({_share(document['n_feasible'], done)}), {document['n_failed']:,} failed"
    ]
    if document["governing"]:
        rows: list[list[Cell]] = [
            [one["joint"], one["quantity"], one["cases"], _share(one["cases"], done)] for one in document["governing"]
        ]
        lines += ["", "What governs:", text_table(["joint", "quantity", "cases", "share"], rows)]
    for axis in document["axes"]:
        rows = [[_value(one["value"]), one["cases"], _share(one["feasible"], one["cases"])] for one in axis["values"]]
        lines += ["", text_table([axis["name"], "cases", "feasible"], rows)]
    if document["best"]:
        names = list(document["best"][0])
        is_front = names == ["payload", "duration"]
        title = "Shortest feasible duration [s] by payload [kg]:" if is_front else "Least utilisation:"
        rows = [[_value(one[name]) for name in names] for one in document["best"]]
        lines += ["", title, text_table(names, rows)]
    lines += [f"failed, {one['cases']:,} cases: {one['error']}" for one in document["errors"]]
    return "\n".join(lines)


def _value(value: Any) -> Cell:
    return value if isinstance(value, str | int | float) else str(value)


def _share(part: int, whole: int) -> str:
    return f"{100 * part / whole:z.1f} %" if whole else "none"
