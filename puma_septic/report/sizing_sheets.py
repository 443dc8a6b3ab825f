"""Sizings as CSV: checks, pairs of a catalogue, and a motor's load as the tools of motor makers read it."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from typing import Any

from puma_septic.sizing import MotorLoadProfile, Selection, Sizing

__all__ = ["checks_csv", "load_profile_csv", "pairs_csv"]


def checks_csv(sizing: Sizing) -> str:
    """One row for each joint and check, the most used limit of a joint first, in SI units."""
    headers = ["joint", "check", "demand", "limit", "unit", "time [s]", "utilisation", "margin", "kind", "source"]
    keys = ["joint", "quantity", "demand", "limit", "unit", "time", "utilisation", "margin", "kind", "source"]
    joints = sizing.to_dict()["joints"]
    return _text([headers, *([check[key] for key in keys] for joint in joints for check in joint["checks"])])


def pairs_csv(selection: Selection) -> str:
    """One row for each joint and pair of the catalogue: accepted, or the check that it fails worst."""
    catalogue = selection.catalogue
    rows: list[list[Any]] = [["joint", "motor", "gearbox", "strong enough", "fails worst in", "utilisation at least"]]
    for one in selection.joints:
        pairs = zip(catalogue.motor_index.tolist(), catalogue.gearbox_index.tolist(), strict=True)
        for k, (i, j) in enumerate(pairs):
            verdict = "yes" if one.is_feasible[k] else "no"
            use = "unbounded" if one.utilisation[k] == float("inf") else repr(float(one.utilisation[k]))
            names = [catalogue.motors[i].name, catalogue.gearboxes[j].name]
            rows.append([one.joint, *names, verdict, one.reasons[k], use])
    return _text(rows)


def load_profile_csv(profile: MotorLoadProfile) -> str:
    """Time, speed and torque of a motor, sampled: the three columns that the tools of motor makers ask for."""
    columns = zip(profile.time.tolist(), profile.speed_rpm.tolist(), profile.torque.tolist(), strict=True)
    return _text([["time [s]", "speed [rpm]", "torque [N m]"], *([f"{value:.9g}" for value in row] for row in columns)])


def _text(rows: Iterable[Iterable[Any]]) -> str:
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows([_cell(value) for value in row] for row in rows)
    return stream.getvalue()


def _cell(value: Any) -> Any:
    """Text that a spreadsheet would take for a formula is marked as text; what is not known is left empty."""
    if isinstance(value, str) and value[:1] in ("=", "+", "-", "@") and not _is_number(value):
        return f"'{value}"
    return "" if value is None else value


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
