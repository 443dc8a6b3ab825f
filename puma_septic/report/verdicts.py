"""Verdicts in one sentence, and profiles side by side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from puma_septic.assessment import Assessment
from puma_septic.assessment.checks import LimitCheck
from puma_septic.tables import Cell, html_table
from puma_septic.task import ResolvedTask

__all__ = ["comparison_table", "reason", "verdict_sentence"]


def verdict_sentence(assessments: Sequence[Assessment], labels: Sequence[str]) -> str:
    """Which profiles are feasible, and the joint, limit and instant that govern."""
    good = [label for label, one in zip(labels, assessments, strict=True) if one.is_feasible]
    pairs = [(check, label) for label, one in zip(labels, assessments, strict=True) for check in one.checks]
    if not pairs:
        return f"{_which(good, labels)}; no limit of this robot is known."
    # Of profiles that share the worst, such as a point's position, the first: rounding does not choose.
    check, label = max(pairs, key=lambda pair: float(f"{pair[0].utilisation:.9g}"))
    whose = f" ({label})" if len(labels) > 1 else ""
    return f"{_which(good, labels)}; what governs is {_governing(check)}{whose}."


def reason(resolved: ResolvedTask) -> str:
    """Why no profile can be feasible, where the points themselves break limits in every branch; else empty."""
    always = resolved.broken_in_all_branches
    if not always:
        return ""
    points: dict[str, list[str]] = {}
    for joint, point in always:
        points.setdefault(joint, []).append(point)
    where = ", ".join(f"{joint} at {' and '.join(names)}" for joint, names in points.items())
    count = len(resolved.branches)
    branches = f"All {count} branches of the inverse kinematics break" if count > 1 else "The points break"
    return f"{branches} the position limit of {where}: no profile through these points can be feasible."


def comparison_table(assessments: Sequence[Assessment], labels: Sequence[str]) -> str:
    """One row for each profile."""
    headers = ["profile", "verdict", "limit used most", "velocity", "torque", "jerk [rad/s³]", "overshoot [rad]"]
    rows: list[list[Cell]] = [
        [
            label,
            "feasible" if one.is_feasible else "infeasible",
            "none known" if one.worst is None else f"{one.worst.joint} {_name(one.worst)} {_percent(one.worst)}",
            _most(one, "velocity"),
            _most(one, "effort"),
            float(one.peak_jerk.max()),
            float(one.overshoot.max()),
        ]
        for label, one in zip(labels, assessments, strict=True)
    ]
    caption = "Profiles side by side: the largest among the joints, velocity and torque in per cent of their limits"
    return f'<div class="scroll">{html_table(headers, rows, caption=caption)}</div>'


def _which(good: Sequence[str], labels: Sequence[str]) -> str:
    if len(labels) == 1:
        return f"{labels[0]} {'keeps every known limit' if good else 'does not keep the limits'}"
    if len(good) == len(labels):
        return f"All {len(labels)} profiles keep every known limit"
    if not good:
        return f"None of the {len(labels)} profiles keeps the limits"
    others = [label for label in labels if label not in good]
    return f"{', '.join(good)} keep{'s' if len(good) == 1 else ''} every known limit, {', '.join(others)} not"


def _governing(check: LimitCheck) -> str:
    """The joint, its demand, its limit and the instant."""
    if np.isinf(check.demand):
        return f"{check.joint}: {_name(check)} unbounded at {check.time:.3g} s, {check.limit_text}"
    what = f"{check.joint}: {_name(check)} {check.demand:.4g} {check.unit} at {check.time:.3g} s"
    if check.quantity == "position":
        side = "beyond" if check.is_violated else "within"
        return f"{what}, {abs(check.margin):.3g} {check.unit} {side} its bound of {check.limit:.4g} {check.unit}"
    return f"{what}, {_percent(check)} of its limit {check.limit:.4g} {check.unit}"


def _name(check: LimitCheck) -> str:
    return "torque" if check.quantity == "effort" else check.quantity


def _most(assessment: Assessment, quantity: str) -> str:
    worst = max(
        (check for check in assessment.checks if check.quantity == quantity),
        key=lambda check: check.utilisation,
        default=None,
    )
    return "not known" if worst is None else _percent(worst)


def _percent(check: LimitCheck) -> str:
    return "unbounded" if np.isinf(check.utilisation) else f"{100 * check.utilisation:.0f} %"
