"""The charts of some motions under their headings, in the page and as SVG files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

from puma_septic.assessment import Assessment
from puma_septic.quantities import MOTION
from puma_septic.report.charts import SIZE, Chart
from puma_septic.report.documents import profile_labels
from puma_septic.report.panels import (
    Samples,
    motion_charts,
    plane_charts,
    samples_of,
    split_charts,
    tool_charts,
    torque_charts,
)
from puma_septic.report.rendering import render

__all__ = ["Group", "groups_of", "svg_figures"]

_COLUMNS = 3


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Group:
    """Charts under one heading; `causes` (class, name) is the key of their colours where that is their own."""

    name: str
    title: str
    charts: list[Chart]
    note: str = ""
    causes: Sequence[tuple[str, str]] = ()
    folded: bool = False


def groups_of(group: Sequence[Samples]) -> list[Group]:
    """Torque with its causes first, then where it leads, then the motion itself."""
    torque_note = "Actuator torque at the joint over time; dashed: its limit; a diamond marks the peak."
    groups = [Group(name="torque", title="Torque", charts=torque_charts(group), note=torque_note)]
    for k, one in enumerate(group):
        charts, causes = split_charts(one, k)
        title = f"Torque by cause: {one.label}"
        groups.append(Group(name=f"torque-split-{one.label}", title=title, charts=charts, causes=causes, folded=k > 0))
    plane_note = "Torque over velocity; dashed: the limits of both."
    tool_note = "In the world; circles are the points that the task asks for."
    groups += [
        Group(name="torque-speed", title="Torque-speed plane", charts=plane_charts(group), note=plane_note),
        Group(name="tool", title="Tool", charts=tool_charts(group), note=tool_note),
    ]
    jerk_note = "Steps are upright lines; an arrowhead marks an impulse, where the value is unbounded."
    notes = ("Circles are the points of the task; dashed: the limits.", "", "", jerk_note)
    for order, note in enumerate(notes):
        name = MOTION[order]
        groups.append(Group(name=name, title=name.capitalize(), charts=motion_charts(group, order), note=note))
    return groups


def svg_figures(assessments: Sequence[Assessment]) -> dict[str, str]:
    """The report's charts as SVG pictures of their own, by file name without suffix."""
    labels = profile_labels(assessments)
    group = [samples_of(one, label) for one, label in zip(assessments, labels, strict=True)]
    profiles = [(f"c{k % 6} d{k % 5}", label) for k, label in enumerate(labels)]
    return {one.name: _picture(one, profiles) for one in groups_of(group)}


def _picture(group: Group, profiles: Sequence[tuple[str, str]]) -> str:
    """All charts of a group in rows of three, the key above them."""
    rows = -(-len(group.charts) // _COLUMNS)
    return render(
        "figure.svg.j2",
        group=group,
        key=group.causes or profiles,
        columns=_COLUMNS,
        width=_COLUMNS * SIZE[0],
        rows=rows,
    )
