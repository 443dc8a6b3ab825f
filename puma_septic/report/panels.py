"""From assessments to the charts and bars of the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.assessment import Assessment
from puma_septic.dynamics import TERMS
from puma_septic.kinematics import forward_kinematics, tool_motion
from puma_septic.piecewise import Piecewise, sampled
from puma_septic.quantities import MOTION, QUANTITIES
from puma_septic.report.charts import Chart, Curve, Mark, chart
from puma_septic.validation import Array

__all__ = [
    "Bar",
    "Samples",
    "motion_charts",
    "plane_charts",
    "samples_of",
    "split_charts",
    "tool_charts",
    "torque_charts",
    "utilisation_bars",
]

# A line of so many points is smooth on any screen; and on each interval.
_SAMPLES: Final = 200
_LEAST: Final = 8
# A cause that stays below this part of the joint's torque is not drawn.
_NEGLIGIBLE: Final = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Samples:
    """One motion sampled for drawing: t (k,), q, v, a, jerk and torque (k, n_joints), tool place and speed."""

    assessment: Assessment
    label: str
    t: Array
    signals: tuple[Array, Array, Array, Array, Array]
    place: Array
    speed: Array


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Bar:
    """How much of a limit one profile uses: parts of the limit, NaN where that is not known."""

    joint: str
    quantity: str
    profile: int
    used: float
    is_broken: bool

    @property
    def text(self) -> str:
        """In per cent; a broken limit has an exclamation mark, so that colour is not all that tells."""
        if np.isnan(self.used):
            return "not known"
        size = "unbounded" if np.isinf(self.used) else f"{100 * self.used:.0f} %"
        return f"{size} !" if self.is_broken else size


def samples_of(assessment: Assessment, label: str) -> Samples:
    """Position to torque at common instants, both sides of each break."""
    motion, n = assessment.motion, assessment.motion.robot.n_joints
    t, values = sampled(_together([motion.trajectory.state, motion.torque]), samples=_SAMPLES, least=_LEAST)
    q, v, a, j, tau = (values[:, k * n : (k + 1) * n] for k in range(5))
    tool = tool_motion(motion.robot, q, v, a)
    speed = np.linalg.norm(tool.velocity, axis=1)
    return Samples(assessment=assessment, label=label, t=t, signals=(q, v, a, j, tau), place=tool.position, speed=speed)


def motion_charts(group: Sequence[Samples], order: int) -> list[Chart]:
    """Position (0) to jerk (3) of every joint, with rest before and after; steps are upright lines."""
    robot, charts = group[0].assessment.motion.robot, []
    for j, joint in enumerate(robot.joint_names):
        curves, marks = [], []
        for k, one in enumerate(group):
            t, values = one.t, one.signals[order][:, j]
            if order:
                t, values = np.concatenate([t[:1], t, t[-1:]]), np.concatenate([[0.0], values, [0.0]])
            curves.append(_curve(t, values, k, one.label))
            marks += _vias(one, j) if order == 0 else _impulses(one, order, j, k)
        bounds = (
            robot.limits.position[j] if order == 0 else getattr(robot.limits, MOTION[order])[j] * np.array([-1.0, 1.0])
        )
        unit = QUANTITIES[MOTION[order]].unit(robot.is_prismatic[j])
        charts.append(
            chart(
                "time",
                curves,
                title=joint,
                y_label=f"{MOTION[order]} [{_typeset(unit)}]",
                span=_span(group),
                marks=marks,
                limits=(float(bounds[0]), float(bounds[1])),
            )
        )
    return charts


def torque_charts(group: Sequence[Samples]) -> list[Chart]:
    """Torque of every joint over time with its limit; a diamond marks the peak."""
    robot, charts = group[0].assessment.motion.robot, []
    for j, joint in enumerate(robot.joint_names):
        limit = float(robot.limits.effort[j])
        marks, unbounded = [], []
        for k, one in enumerate(group):
            peak, time = one.assessment.peak_torque[j], float(one.assessment.peak_torque_time[j])
            if np.isinf(peak):
                unbounded.append(f"{one.label} unbounded at {time:.3g} s")
            else:
                signed = float(peak * one.assessment.peak_torque_sign[j])
                marks.append(Mark(x=time, y=signed, shape="peak", css=_css(k)))
        charts.append(
            chart(
                "time",
                [_curve(one.t, one.signals[4][:, j], k, one.label) for k, one in enumerate(group)],
                title=joint,
                y_label=_effort_label(robot.is_prismatic[j]),
                span=_span(group),
                marks=marks,
                limits=(-limit, limit),
                limits_always=True,
                remark=", ".join(unbounded),
            )
        )
    return charts


def plane_charts(group: Sequence[Samples]) -> list[Chart]:
    """Torque over speed of every joint, within the rectangle of its limits."""
    robot, charts = group[0].assessment.motion.robot, []
    for j, joint in enumerate(robot.joint_names):
        speed, effort = float(robot.limits.velocity[j]), float(robot.limits.effort[j])
        charts.append(
            chart(
                "plane",
                [_curve(one.signals[1][:, j], one.signals[4][:, j], k, one.label) for k, one in enumerate(group)],
                title=joint,
                y_label=_effort_label(robot.is_prismatic[j]),
                x_label=f"velocity [{QUANTITIES['velocity'].unit(robot.is_prismatic[j])}]",
                limits=(-effort, effort),
                x_limits=(-speed, speed),
                limits_always=True,
            )
        )
    return charts


def split_charts(one: Samples, profile: int) -> tuple[list[Chart], list[tuple[str, str]]]:
    """Torque of every joint by cause; and the key, colour class and name: each cause that occurs, and "total"."""
    motion = one.assessment.motion
    robot, terms, n = motion.robot, motion.torque_terms, motion.robot.n_joints
    t, values = sampled(_together([getattr(terms, name) for name in TERMS]), samples=_SAMPLES, least=_LEAST)
    floor = _NEGLIGIBLE * np.maximum(1.0, np.abs(one.signals[4]).max(axis=0))
    seen = np.abs(values).max(axis=0).reshape(len(TERMS), n) > floor
    charts = []
    for j, joint in enumerate(robot.joint_names):
        total = Curve(x=one.t, y=one.signals[4][:, j], css="total", profile=profile, label="total")
        causes = [
            Curve(x=t, y=values[:, k * n + j], css=f"cause{k}", profile=profile, label=name)
            for k, name in enumerate(TERMS)
            if seen[k, j]
        ]
        label = _effort_label(robot.is_prismatic[j])
        charts.append(chart("time", [*causes, total], title=joint, y_label=label, span=(one.t[0], one.t[-1])))
    return charts, [*((f"cause{k}", name) for k, name in enumerate(TERMS) if seen[k].any()), ("total", "total")]


def tool_charts(group: Sequence[Samples]) -> list[Chart]:
    """The tool's path from above and from the side, its height and its speed over time."""
    robot = group[0].assessment.motion.robot
    vias = [forward_kinematics(one.assessment.motion.robot, one.assessment.motion.trajectory.points) for one in group]
    places = np.concatenate([poses[:, :3, 3] for poses in vias])
    charts = []
    for name, (a, b) in (("from above", (0, 1)), ("from the side", (0, 2))):
        charts.append(
            chart(
                "path",
                [_curve(one.place[:, a], one.place[:, b], k, one.label) for k, one in enumerate(group)],
                title=f"path {name}",
                y_label=f"{'xyz'[b]} [m]",
                x_label=f"{'xyz'[a]} [m]",
                marks=[Mark(x=float(place[a]), y=float(place[b]), shape="via") for place in places],
            )
        )
    over_time = (
        (f"height of {robot.tool}", "z [m]", [one.place[:, 2] for one in group]),
        (f"speed of {robot.tool}", "speed [m/s]", [one.speed for one in group]),
    )
    for title, label, values in over_time:
        curves = [_curve(one.t, value, k, one.label) for k, (one, value) in enumerate(zip(group, values, strict=True))]
        charts.append(chart("time", curves, title=title, y_label=label, span=_span(group)))
    return charts


def utilisation_bars(group: Sequence[Samples]) -> dict[str, list[tuple[str, list[Bar]]]]:
    """By quantity whose limit is known, each joint with one bar per profile."""
    found = {(check.quantity, check.joint, k): check for k, one in enumerate(group) for check in one.assessment.checks}
    joints = group[0].assessment.motion.robot.joint_names
    bars: dict[str, list[tuple[str, list[Bar]]]] = {}
    for quantity in QUANTITIES:
        if not any(key[0] == quantity for key in found):
            continue
        rows = []
        for joint in joints:
            checks = [found.get((quantity, joint, k)) for k in range(len(group))]
            rows.append(
                (
                    joint,
                    [
                        Bar(
                            joint=joint,
                            quantity=quantity,
                            profile=k,
                            used=np.nan if check is None else check.utilisation,
                            is_broken=check is not None and check.is_violated,
                        )
                        for k, check in enumerate(checks)
                    ],
                )
            )
        bars[QUANTITIES[quantity].label] = rows
    return bars


def _together(functions: Sequence[Piecewise]) -> Piecewise:
    breaks = np.unique(np.concatenate([function.breaks for function in functions]))
    return Piecewise.concatenate([function.split(breaks) for function in functions])


def _curve(x: Array, y: Array, k: int, label: str) -> Curve:
    return Curve(x=x, y=y, css=_css(k), profile=k, label=label)


def _css(k: int) -> str:
    """Six colours and five dashes make thirty different lines."""
    return f"c{k % 6} d{k % 5}"


def _span(group: Sequence[Samples]) -> tuple[float, float]:
    return min(float(one.t[0]) for one in group), max(float(one.t[-1]) for one in group)


def _vias(one: Samples, j: int) -> list[Mark]:
    trajectory = one.assessment.motion.trajectory
    places = zip(trajectory.times.tolist(), trajectory.points[:, j].tolist(), strict=True)
    return [Mark(x=time, y=value, shape="via") for time, value in places]


def _impulses(one: Samples, order: int, j: int, k: int) -> list[Mark]:
    """An arrowhead where a lower derivative steps, so that this one is unbounded."""
    marks = []
    for lower in range(1, order):
        jumps = one.assessment.motion.trajectory.jumps(lower)
        for time, size in zip(jumps.times.tolist(), jumps.sizes[:, j].tolist(), strict=True):
            if size:
                marks.append(Mark(x=time, y=0.0, shape="up" if size > 0 else "down", css=_css(k)))
    return marks


def _effort_label(slides: bool) -> str:
    return "force [N]" if slides else "torque [N m]"


def _typeset(unit: str) -> str:
    return unit.replace("^2", "²").replace("^3", "³")
