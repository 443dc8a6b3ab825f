"""Torque over time: against the limits, and by cause."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from puma_septic.assessment import Assessment
from puma_septic.dynamics import TERMS
from puma_septic.plots.style import (
    LIMIT,
    add_legend,
    as_group,
    beside,
    colour_of,
    draw_curve,
    draw_limits,
    joint_panels,
    new_figure,
    sampled,
    tidy,
    unique_labels,
)
from puma_septic.robot import Robot

__all__ = ["plot_torque", "plot_torque_split"]

PEAK: Final[dict[str, Any]] = {"linestyle": "none", "marker": "D", "markersize": 4.5}
# The colours of the causes, in the order of TERMS; Okabe and Ito's palette and a grey.
_CAUSES: Final = ("#0072B2", "#56B4E9", "#009E73", "#CC79A7", "#E69F00", "#D55E00", "#7F7F7F", "#B8A000")
# A cause that stays below this part of the joint's torque is not drawn.
_NEGLIGIBLE: Final = 1e-9


def plot_torque(assessment: Assessment | Sequence[Assessment], *, labels: Sequence[str] | None = None) -> Figure:
    """Draw the actuator torque of each joint with its effort limit; a diamond marks the peak.

    Steps, as Coulomb friction makes them where a joint reverses, are vertical lines. Where the torque is
    unbounded because a velocity steps, the panel says so.

    Parameters
    ----------
    assessment : Assessment or sequence of Assessment
        Of the same arm; the limits drawn are those of the first.
    labels : sequence of str, optional
        Legend entries; the profiles' names by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For no assessment, or arms with different numbers of joints.
    """
    group = as_group(assessment, Assessment, lambda one: one.motion.robot.n_joints)
    names = unique_labels([one.motion.trajectory.profile for one in group], labels)
    robot = group[0].motion.robot
    figure = new_figure(0.6 + 2.3 * -(-robot.n_joints // 3))
    panels = joint_panels(figure, robot.joint_names)
    for k, (one, name) in enumerate(zip(group, names, strict=True)):
        t, tau = sampled(one.motion.torque)
        for j, panel in enumerate(panels):
            draw_curve(panel, t, tau[:, j], k, name)
    for j, panel in enumerate(panels):
        _mark_peaks(panel, group, names, j)
        tidy(panel, y=_torque_label(robot, j))
        draw_limits(panel, -robot.limits.effort[j], robot.limits.effort[j], always=True)
    marks = [
        Line2D([], [], color="0.3", label="peak", **PEAK),
        Line2D([], [], label="effort limit", **LIMIT),
    ]
    add_legend(figure, names, extra=marks)
    return figure


def plot_torque_split(assessment: Assessment) -> Figure:
    """Draw the torque of each joint by cause: inertia, Coriolis, gravity, rotor, friction, payload, wrench.

    The causes sum to the black line. One that a joint does not know is left out of its panel.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For anything other than one assessment.
    """
    (one,) = as_group((assessment,), Assessment, lambda given: given.motion.robot.n_joints)
    robot, terms = one.motion.robot, one.motion.torque_terms
    figure = new_figure(0.8 + 2.3 * -(-robot.n_joints // 3))
    panels = joint_panels(figure, robot.joint_names)
    t, total = sampled(one.motion.torque)
    for j, panel in enumerate(panels):
        panel.plot(t, total[:, j], color="black", linewidth=1.8)
    floor = _NEGLIGIBLE * np.maximum(1.0, np.abs(total).max(axis=0))
    handles = [Line2D([], [], color="black", linewidth=1.8, label="total")]
    for name, colour in zip(TERMS, _CAUSES, strict=True):
        t, tau = sampled(getattr(terms, name))
        seen = np.abs(tau).max(axis=0) > floor
        for j in np.flatnonzero(seen).tolist():
            panels[j].plot(t, tau[:, j], color=colour, linewidth=1.2)
        if seen.any():
            handles.append(Line2D([], [], color=colour, linewidth=1.6, label=name))
    for j, panel in enumerate(panels):
        tidy(panel, y=_torque_label(robot, j))
    add_legend(figure, [], extra=handles)
    return figure


def _mark_peaks(panel: Axes, group: Sequence[Assessment], names: Sequence[str], j: int) -> None:
    """A diamond at each peak; the names of those that have none because their torque is unbounded."""
    unbounded = []
    for k, (one, name) in enumerate(zip(group, names, strict=True)):
        peak, time = float(one.peak_torque[j] * one.peak_torque_sign[j]), one.peak_torque_time[j]
        if np.isinf(peak):
            unbounded.append(f"{name} unbounded at {time:.3g} s")
        else:
            panel.plot(time, peak, color=colour_of(k), zorder=3, **PEAK)
    if unbounded:
        beside(panel, ", ".join(unbounded))


def _torque_label(robot: Robot, j: int) -> str:
    return "force [N]" if robot.is_prismatic[j] else "torque [N m]"
