"""Results as CSV: metrics, checks and pairs, load profiles, and samples over time, which are for drawing only."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.assessment import Assessment
from puma_septic.document import csv_text
from puma_septic.piecewise import Piecewise
from puma_septic.quantities import MOTION, QUANTITIES
from puma_septic.report._documents import profile_labels
from puma_septic.robot import Robot
from puma_septic.sizing import LoadProfile, MotorLoadProfile, Selection, Sizing
from puma_septic.task import ResolvedTask
from puma_septic.validation import Array
from puma_septic.views import selection as selection_view
from puma_septic.views import sizing as sizing_view
from puma_septic.views.assessment import metrics_csv as metrics

__all__ = [
    "bill_csv",
    "checks_csv",
    "load_profile_csv",
    "metrics_csv",
    "motor_profile_csv",
    "named_metrics_csv",
    "pairs_csv",
    "samples_csv",
]

# A fine line on a wide screen; the instants of steps are added.
_SAMPLES: Final = 1001
# A recorded motion has a break at every sample, at most of which nothing steps.
_MOST_BREAKS: Final = 1000
_SIGNALS: Final = tuple(QUANTITIES[name] for name in (*MOTION, "effort"))


def metrics_csv(tasks: Sequence[tuple[ResolvedTask, Sequence[Assessment]]]) -> str:
    """One row for each task, profile and joint: the metrics of the JSON document, in SI units.

    "unbounded" stands for infinity; what is not known is left empty.
    """
    return named_metrics_csv([(resolved.task.name, assessments) for resolved, assessments in tasks])


def named_metrics_csv(groups: Sequence[tuple[str, Sequence[Assessment]]]) -> str:
    """`metrics_csv` of assessments under any name, which stands in the column "task"."""
    return metrics(
        [
            (group, label, assessment.to_dict())
            for group, assessments in groups
            for label, assessment in zip(profile_labels(assessments), assessments, strict=True)
        ]
    )


def samples_csv(assessment: Assessment) -> str:
    """Position, velocity, acceleration, jerk and torque of every joint, sampled over the motion.

    At a break of any of them there are two rows, whose side is "left" and "right": where a signal steps they differ. A
    motion with more than 1,000 breaks, as a recorded one has, has rows at even instants only. What is not known is left
    empty.
    """
    robot = assessment.motion.robot
    series = Piecewise.joined([assessment.motion.signal(signal.name) for signal in _SIGNALS])
    headers = [
        f"{signal.label} {name} [{signal.unit(slides)}]"
        for signal in _SIGNALS
        for name, slides in zip(robot.joint_names, robot.is_prismatic, strict=True)
    ]
    times, sides, values = _sampled(series)
    values = np.where(_is_known(robot), values, np.nan)
    rows = (
        [repr(float(t)), side, *map(_written, row)] for t, side, row in zip(times, sides, values.tolist(), strict=True)
    )
    return csv_text([["t [s]", "side", *headers], *rows])


def _is_known(robot: Robot) -> NDArray[np.bool_]:
    """Of each column of `samples_csv`: torques need inertia."""
    return np.concatenate([robot.knows_torque | (signal.signal == "position") for signal in _SIGNALS])


def _written(value: float) -> str | None:
    return None if value != value else repr(value)


def checks_csv(sizing: Sizing) -> str:
    """One row for each joint and check, the most used limit of a joint first, in SI units."""
    return sizing_view.checks_csv(sizing.to_dict())


def bill_csv(document: Mapping[str, Any]) -> str:
    """The bill of material of a selection's document: one row for each part, and what it is for."""
    return selection_view.bill_csv(document)


def pairs_csv(selection: Selection) -> str:
    """One row for each joint and pair of the catalogue: accepted, not decidable, or the check that it fails worst."""
    catalogue = selection.catalogue
    rows: list[list[Any]] = [["joint", "motor", "gearbox", "feasible", "worst violation", "utilisation at least"]]
    for one in selection.joints:
        reasons = one.reasons
        pairs = zip(catalogue.motor_index.tolist(), catalogue.gearbox_index.tolist(), strict=True)
        for k, (i, j) in enumerate(pairs):
            verdict = "yes" if one.is_feasible[k] else ("undecided" if one.is_undecided[k] else "no")
            use = "unbounded" if one.utilisation[k] == float("inf") else repr(float(one.utilisation[k]))
            names = [catalogue.motors[i].name, catalogue.gearboxes[j].name]
            rows.append([one.joint, *names, verdict, reasons[k], use])
    return csv_text(rows)


def motor_profile_csv(profile: MotorLoadProfile) -> str:
    """Time, speed and torque of a motor, with its own rotor and friction: what its drive must give."""
    columns = zip(profile.time.tolist(), profile.speed_rpm.tolist(), profile.torque.tolist(), strict=True)
    rows = ([f"{value:.9g}" for value in row] for row in columns)
    return csv_text([["time [s]", "motor speed [rpm]", "whole motor torque, rotor and friction included [N m]"], *rows])


def load_profile_csv(profile: LoadProfile) -> str:
    """The load of a joint at the gearbox's output, without motor and gears: what the tools of motor makers ask for.

    Where the torque steps there are two rows for one instant.
    """
    length, force = ("m", "N") if profile.is_prismatic else ("rad", "N m")
    inertia = "kg" if profile.is_prismatic else "kg m^2"
    headers = [
        "time [s]", f"position [{length}]", f"speed at the gearbox output [{length}/s]",
        f"load at the gearbox output, without rotor, gears and friction [{force}]", f"inertia of the load [{inertia}]",
    ]  # fmt: skip
    columns = [profile.time, profile.position, profile.speed, profile.torque, profile.inertia]
    rows = ([f"{value:.9g}" for value in row] for row in zip(*(c.tolist() for c in columns), strict=True))
    return csv_text([headers, *rows])


def _sampled(series: Piecewise) -> tuple[Array, list[str], Array]:
    """Evenly spaced instants, and each break with the values of both its sides."""
    left, right = series.ends()
    grid = np.linspace(series.breaks[0], series.breaks[-1], _SAMPLES)
    if len(left) > _MOST_BREAKS:
        return _without_breaks(grid, series)
    times, sides, values = [], [], []
    for i, (start, end) in enumerate(zip(series.breaks[:-1], series.breaks[1:], strict=True)):
        inside = grid[(grid > start) & (grid < end)]
        times.append(np.concatenate([[start], inside, [end]]))
        sides += ["right", *[""] * len(inside), "left"]
        values.append(np.vstack([left[i], series(inside), right[i]]))
    return np.concatenate(times), sides, np.concatenate(values)


def _without_breaks(grid: Array, series: Piecewise) -> tuple[Array, list[str], Array]:
    return grid, [""] * len(grid), series(grid)
