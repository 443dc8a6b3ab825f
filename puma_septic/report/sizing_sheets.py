"""Sizings as CSV: checks, pairs of a catalogue, and a motor's load as the tools of motor makers read it."""

from __future__ import annotations

from typing import Any

from puma_septic.document import csv_text
from puma_septic.sizing import MotorLoadProfile, Selection, Sizing
from puma_septic.views import sizing as view

__all__ = ["checks_csv", "load_profile_csv", "pairs_csv"]


def checks_csv(sizing: Sizing) -> str:
    """One row for each joint and check, the most used limit of a joint first, in SI units."""
    return view.checks_csv(sizing.to_dict())


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
    return csv_text(rows)


def load_profile_csv(profile: MotorLoadProfile) -> str:
    """Time, speed and torque of a motor, sampled: the three columns that the tools of motor makers ask for."""
    columns = zip(profile.time.tolist(), profile.speed_rpm.tolist(), profile.torque.tolist(), strict=True)
    rows = ([f"{value:.9g}" for value in row] for row in columns)
    return csv_text([["time [s]", "speed [rpm]", "torque [N m]"], *rows])
