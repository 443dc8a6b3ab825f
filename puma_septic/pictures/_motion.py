"""Pictures of assessed motions: torque and its causes, torque vs. velocity, the tool, position to jerk."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from puma_septic.assessment import Assessment
from puma_septic.dynamics import TERMS
from puma_septic.kinematics import forward_kinematics, singularity_distances, singularity_names
from puma_septic.pictures._elements import (
    NEGLIGIBLE,
    UNKNOWN,
    Curve,
    Entry,
    Mark,
    Panel,
    Picture,
    Range,
    Rule,
    chart,
    saying,
)
from puma_septic.pictures._samples import Samples, Track, samples_of, together
from puma_septic.pictures._styles import INK, LIMIT, Dot, Line, cause_lines, profile_line
from puma_septic.pictures._utilisation import utilisation_picture
from puma_septic.quantities import MOTION, QUANTITIES, typeset
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = [
    "assessment_pictures",
    "derivative_picture",
    "motion_pictures",
    "profile_entries",
    "singularity_picture",
    "tool_picture",
    "torque_picture",
    "torque_speed_picture",
    "torque_split_picture",
    "via_places",
]

_NO_TORQUE: Final = "torque not known: the URDF has no usable inertia for what this joint moves"
VIA: Final = Dot(shape="via")
TOTAL: Final = Line(hue=INK, width=2.1)
# What the distance to a kind of singular posture is, see `singularity_distances`; of others it is a determinant.
_MEASURES: Final = {"shoulder": "distance [m]", "elbow": "sine [1]", "wrist": "sine [1]"}
_NOTES: Final = (
    "Circles are the points of the task; dashed: the limits.",
    "",
    "",
    "Steps are drawn as vertical lines; an arrowhead marks an impulse, where the value is unbounded.",
)


def motion_pictures(group: Sequence[Samples]) -> tuple[Picture, ...]:
    """Torque with its causes first, then where it leads, then the motion itself."""
    tracks = [one.track for one in group]
    robot = group[0].assessment.motion.robot
    return (
        torque_picture(group),
        *(torque_split_picture(one, k) for k, one in enumerate(group)),
        torque_speed_picture(group),
        tool_picture(group),
        singularity_picture(group),
        *(derivative_picture(tracks, order, robot) for order in range(4)),
    )


def assessment_pictures(assessments: Sequence[Assessment], labels: Sequence[str]) -> tuple[Picture, ...]:
    """All pictures of some motions of one arm: the use of the limits, then those of `motion_pictures`."""
    group = [samples_of(one, label) for one, label in zip(assessments, labels, strict=True)]
    return (utilisation_picture(assessments, labels), *motion_pictures(group))


def derivative_picture(tracks: Sequence[Track], order: int, robot: Robot | None = None) -> Picture:
    """Position (0) to jerk (3) of every joint, with rest before and after; steps are vertical lines.

    Without a robot all joints are revolute and no limit is known.

    Raises
    ------
    InputError
        For another order.
    """
    tracks[0].trajectory.derivative(order)  # refuses an unknown order
    name = MOTION[order]
    panels = tuple(
        chart(
            "time",
            [_derivative_curve(one, order, j, k) for k, one in enumerate(tracks)],
            title=joint,
            y_label=f"{name} [{typeset(QUANTITIES[name].unit(robot is not None and robot.is_prismatic[j]))}]",
            span=_span(tracks),
            marks=[mark for k, one in enumerate(tracks) for mark in _derivative_marks(one, order, j, k)],
            limits=UNKNOWN if robot is None else _bounds(robot, name, j),
        )
        for j, joint in enumerate(_joint_names(tracks[0]) if robot is None else robot.joint_names)
    )
    extra = [Entry("via point", VIA)] if order == 0 else []
    return Picture(
        name=name,
        title=name.capitalize(),
        panels=panels,
        legend=(*profile_entries(one.label for one in tracks), *extra, *_limit_entry(panels)),
        note=_NOTES[order],
    )


def torque_picture(group: Sequence[Samples]) -> Picture:
    """Torque of every joint over time with its limit; a diamond marks the peak."""
    robot, panels = group[0].assessment.motion.robot, []
    for j, joint in enumerate(robot.joint_names):
        if not robot.knows_torque[j]:
            panels.append(saying(joint, _NO_TORQUE))
            continue
        marks, unbounded = [], []
        for k, one in enumerate(group):
            peak, time = one.assessment.peak_torque[j], float(one.assessment.peak_torque_time[j])
            if np.isinf(peak):
                unbounded.append((one.label, time))
            else:
                signed = float(peak * one.assessment.peak_torque_sign[j])
                marks.append(Mark(x=time, y=signed, dot=Dot(shape="peak", hue=profile_line(k).hue)))
        panels.append(
            chart(
                "time",
                [_curve(one.t, one.torque[:, j], k, one.label) for k, one in enumerate(group)],
                title=joint,
                y_label=_effort_label(robot, j),
                span=_span(group),
                marks=marks,
                limits=_bounds(robot, "effort", j),
                limits_always=True,
                remark=_unbounded_text(unbounded),
            )
        )
    peak_entry = Entry("peak", Dot(shape="peak"))
    return Picture(
        name="torque",
        title="Torque",
        panels=tuple(panels),
        legend=(*profile_entries(one.label for one in group), peak_entry, *_limit_entry(panels)),
        note="Actuator torque at the joint over time; dashed: its limit; a diamond marks the peak.",
    )


def torque_split_picture(one: Samples, profile: int = 0) -> Picture:
    """Torque of every joint by cause, those that occur; the causes sum to the total."""
    motion = one.assessment.motion
    terms = motion.torque_terms
    t, values = together([getattr(terms, name) for name in TERMS], detail=one.detail)
    floor = NEGLIGIBLE * np.maximum(1.0, np.abs(one.torque).max(axis=0))
    seen = {name: np.abs(tau).max(axis=0) > floor for name, tau in zip(TERMS, values, strict=True)}
    lines = cause_lines(TERMS)
    panels = []
    for j, joint in enumerate(motion.robot.joint_names):
        if not motion.robot.knows_torque[j]:
            panels.append(saying(joint, _NO_TORQUE))
            continue
        causes = [
            Curve(x=t, y=tau[:, j], line=lines[name], profile=profile, label=name)
            for name, tau in zip(TERMS, values, strict=True)
            if seen[name][j]
        ]
        total = Curve(x=one.t, y=one.torque[:, j], line=TOTAL, profile=profile, label="total")
        label = _effort_label(motion.robot, j)
        panels.append(chart("time", [*causes, total], title=joint, y_label=label, span=_span([one])))
    return Picture(
        name=f"torque-split-{one.label}",
        title=f"Torque by cause: {one.label}",
        panels=tuple(panels),
        legend=(
            *(Entry(name, lines[name]) for name in TERMS if seen[name].any()),
            Entry("total", TOTAL),
        ),
        has_own_colours=True,
        is_folded=profile > 0,
    )


def torque_speed_picture(group: Sequence[Samples]) -> Picture:
    """Torque vs. velocity of every joint, within the rectangle of its limits."""
    robot = group[0].assessment.motion.robot
    panels = [
        chart(
            "plane",
            [_curve(one.track.signals[1][:, j], one.torque[:, j], k, one.label) for k, one in enumerate(group)],
            title=joint,
            y_label=_effort_label(robot, j),
            x_label=f"velocity [{QUANTITIES['velocity'].unit(robot.is_prismatic[j])}]",
            limits=_bounds(robot, "effort", j),
            x_limits=_bounds(robot, "velocity", j),
            limits_always=True,
        )
        if robot.knows_torque[j]
        else saying(joint, _NO_TORQUE)
        for j, joint in enumerate(robot.joint_names)
    ]
    return Picture(
        name="torque-speed",
        title="Torque-speed plane",
        panels=tuple(panels),
        legend=(*profile_entries(one.label for one in group), *_limit_entry(panels)),
        note="Torque vs. velocity; dashed: the limits of both.",
    )


def tool_picture(group: Sequence[Samples]) -> Picture:
    """The tool's path from above and from the side, its height and its speed over time."""
    tool = group[0].assessment.motion.robot.tool
    places = [via_places(one) for one in group]
    panels = [
        chart(
            "path",
            [_curve(one.place[:, a], one.place[:, b], k, one.label) for k, one in enumerate(group)],
            title=f"path {side}",
            y_label=f"{'xyz'[b]} [m]",
            x_label=f"{'xyz'[a]} [m]",
            marks=[Mark(x=float(place[a]), y=float(place[b]), dot=VIA) for place in np.concatenate(places)],
        )
        for side, (a, b) in (("from above", (0, 1)), ("from the side", (0, 2)))
    ]
    heights = [_curve(one.t, one.place[:, 2], k, one.label) for k, one in enumerate(group)]
    speeds = [_curve(one.t, one.speed, k, one.label) for k, one in enumerate(group)]
    vias = [
        Mark(x=float(time), y=float(place[2]), dot=VIA)
        for one, points in zip(group, places, strict=True)
        for time, place in zip(one.track.trajectory.marked[0], points, strict=True)
    ]
    panels += [
        chart("time", heights, title=f"height of {tool}", y_label="z [m]", span=_span(group), marks=vias),
        chart(
            "time",
            speeds,
            title=f"speed of {tool}",
            y_label="speed [m/s]",
            span=_span(group),
            limits=(np.nan, _speed_limit(group)),
            limits_always=True,
        ),
    ]
    return Picture(
        name="tool",
        title="Tool",
        panels=tuple(panels),
        columns=2,
        legend=(*profile_entries(one.label for one in group), Entry("via point", VIA), *_limit_entry(panels)),
        note="In the world; circles are the points that the task asks for.",
    )


def singularity_picture(group: Sequence[Samples]) -> Picture:
    """How far each motion is from each kind of singular posture, over time; zero is one."""
    robot = group[0].assessment.motion.robot
    measures = [singularity_distances(robot, one.track.signals[0]) for one in group]
    panels = [
        chart(
            "time",
            [
                _curve(one.t, values[:, kind], k, one.label)
                for k, (one, values) in enumerate(zip(group, measures, strict=True))
            ],
            title=name,
            y_label=_MEASURES.get(name, "measure [SI]"),
            span=_span(group),
            levels=[Rule(at=0.0)],
        )
        for kind, name in enumerate(singularity_names(robot))
    ]
    return Picture(
        name="singularity",
        title="Distance to singular postures",
        panels=tuple(panels),
        legend=(*profile_entries(one.label for one in group), Entry("singular", LIMIT)),
        note="Of each kind its measure, which is zero where the posture is singular (dashed).",
    )


def _speed_limit(group: Sequence[Samples]) -> float:
    """The lowest limit of the tool's speed that one of the motions has, m/s; NaN where none has one."""
    limits = [one.assessment.tool_limits for one in group]
    known = [one.speed for one in limits if one is not None and one.speed is not None]
    return min(known, default=np.nan)


def via_places(one: Samples) -> Array:
    """Where the tool is at the via points, shape (k, 3)."""
    motion = one.assessment.motion
    return np.asarray(forward_kinematics(motion.robot, motion.trajectory.marked[1])[:, :3, 3])


def profile_entries(labels: Iterable[str]) -> tuple[Entry, ...]:
    """The profiles' names and lines."""
    return tuple(Entry(label, profile_line(k)) for k, label in enumerate(labels))


def _curve(x: Array, y: Array, k: int, label: str) -> Curve:
    return Curve(x=x, y=y, line=profile_line(k), profile=k, label=label)


def _derivative_curve(one: Track, order: int, j: int, k: int) -> Curve:
    t, values = one.t, one.signals[order][:, j]
    if order:
        t, values = np.concatenate([t[:1], t, t[-1:]]), np.concatenate([[0.0], values, [0.0]])
    return _curve(t, values, k, one.label)


def _derivative_marks(one: Track, order: int, j: int, k: int) -> list[Mark]:
    """Via points of the position; an arrowhead where a lower derivative steps, so that this one is unbounded."""
    if order == 0:
        times, points = one.trajectory.marked
        vias = zip(times.tolist(), points[:, j].tolist(), strict=True)
        return [Mark(x=time, y=value, dot=VIA) for time, value in vias]
    hue = profile_line(k).hue
    return [
        Mark(x=time, y=0.0, dot=Dot(shape="up" if size > 0 else "down", hue=hue))
        for jumps in (one.trajectory.jumps(lower) for lower in range(1, order))
        for time, size in zip(jumps.times.tolist(), jumps.sizes[:, j].tolist(), strict=True)
        if size
    ]


def _bounds(robot: Robot, quantity: str, j: int) -> Range:
    if quantity == "position":
        low, high = robot.limits.position[j]
        return float(low), float(high)
    bound = float(getattr(robot.limits, quantity)[j])
    return -bound, bound


def _limit_entry(panels: Sequence[Panel]) -> tuple[Entry, ...]:
    """Only where a limit is drawn."""
    drawn = any(panel.levels or panel.uprights for panel in panels)
    return (Entry("limit", LIMIT),) if drawn else ()


def _unbounded_text(unbounded: Sequence[tuple[str, float]]) -> str:
    """One with its instant; of several, their names."""
    if len(unbounded) == 1:
        ((label, time),) = unbounded
        return f"{label} unbounded at {time:.3g} s"
    return f"unbounded: {', '.join(label for label, _ in unbounded)}" if unbounded else ""


def _span(group: Sequence[Samples] | Sequence[Track]) -> Range:
    return min(float(one.t[0]) for one in group), max(float(one.t[-1]) for one in group)


def _joint_names(one: Track) -> tuple[str, ...]:
    trajectory = one.trajectory
    return trajectory.joint_names or tuple(f"joint {j + 1}" for j in range(trajectory.n_joints))


def _effort_label(robot: Robot, j: int) -> str:
    return "force [N]" if robot.is_prismatic[j] else "torque [N m]"
