"""Joint positions and their derivatives over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from puma_septic.assessment import Assessment
from puma_septic.errors import InputError
from puma_septic.plots.style import (
    LIMIT,
    add_legend,
    as_group,
    colour_of,
    draw_curve,
    draw_limits,
    joint_panels,
    new_figure,
    sampled,
    tidy,
    titled,
    unique_labels,
)
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["plot_joints", "plot_trajectory"]

QUANTITIES: Final = ("position", "velocity", "acceleration", "jerk")
_PER_TIME: Final = ("", "/s", "/s²", "/s³")
VIA: Final[dict[str, Any]] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 4.5,
    "color": "black",
    "markerfacecolor": "white",
}


def plot_trajectory(
    trajectory: Trajectory | Sequence[Trajectory], order: int = 0, *, labels: Sequence[str] | None = None
) -> Figure:
    """Draw one derivative of one trajectory, or of several, one panel per joint.

    Steps are drawn as vertical lines, those from and to rest at the ends included. Where a lower derivative
    steps, the curve's impulse is marked by an arrowhead at the panel's edge.

    Parameters
    ----------
    trajectory : Trajectory or sequence of Trajectory
        With the same number of joints.
    order : int
        Position (0), velocity (1), acceleration (2) or jerk (3).
    labels : sequence of str, optional
        Legend entries; the profiles' names by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For an unknown order, no trajectory, or different numbers of joints.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.septic([[0.0], [0.5], [1.0], [1.5]], [0.0, 1.0, 2.0, 3.0])
    >>> figure = plot_trajectory(move, order=3)
    >>> figure.axes[0].get_ylabel()
    'jerk [rad/s³]'
    """
    group = as_group(trajectory, Trajectory, lambda one: one.n_joints)
    names = unique_labels([one.profile for one in group], labels)
    titles = [_title(group[0], j) for j in range(group[0].n_joints)]
    figure = new_figure(0.6 + 2.3 * -(-len(titles) // 3))
    panels = joint_panels(figure, titles)
    draw_order(panels, group, order, names)
    for panel in panels:
        tidy(panel, y=_axis_label(order, "rad"))
    add_legend(figure, names, extra=[via_handle()] if order == 0 else [])
    return figure


def plot_joints(
    assessment: Assessment | Sequence[Assessment],
    *,
    orders: Sequence[int] = (0, 1, 2, 3),
    labels: Sequence[str] | None = None,
) -> Figure:
    """Draw position, velocity, acceleration and jerk side by side, one row per joint, with the limits.

    A limit far beyond the curves is written above the panel instead of drawn; one not known is left out.

    Parameters
    ----------
    assessment : Assessment or sequence of Assessment
        Of the same arm; the limits drawn are those of the first.
    orders : sequence of int
        Which derivatives, 0 to 3.
    labels : sequence of str, optional
        Legend entries; the profiles' names by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For an unknown order, no assessment, or arms with different numbers of joints.
    """
    group = as_group(assessment, Assessment, lambda one: one.motion.robot.n_joints)
    trajectories = [one.motion.trajectory for one in group]
    names = unique_labels([one.profile for one in trajectories], labels)
    robot = group[0].motion.robot
    wanted = tuple(orders)
    if not wanted:
        raise InputError("orders: at least one of 0 (position), 1 (velocity), 2 (acceleration), 3 (jerk) is needed")
    figure = new_figure(0.7 + 1.55 * robot.n_joints)
    grid = figure.subplots(robot.n_joints, len(wanted), sharex=True, squeeze=False)
    for column, order in enumerate(wanted):
        panels = list(grid[:, column])
        draw_order(panels, trajectories, order, names)
        for j, panel in enumerate(panels):
            titled(panel, robot.joint_names[j])
            label = _axis_label(order, "m" if robot.is_prismatic[j] else "rad")
            tidy(panel, x="time [s]" if j == robot.n_joints - 1 else "", y=label, ticks=4)
            draw_limits(panel, *_bounds(group[0], j, order))
    extra = [via_handle()] if 0 in wanted else []
    add_legend(figure, names, extra=[*extra, Line2D([], [], label="limit", **LIMIT)])
    return figure


def draw_order(panels: Sequence[Axes], group: Sequence[Trajectory], order: int, names: Sequence[str]) -> None:
    """One derivative of each trajectory into one panel per joint."""
    for k, (one, name) in enumerate(zip(group, names, strict=True)):
        t, values = sampled(one.derivative(order))
        if order:
            t, values = _from_rest_to_rest(t, values)
        for j, panel in enumerate(panels):
            draw_curve(panel, t, values[:, j], k, name)
            if order == 0:
                panel.plot(one.times, one.points[:, j], zorder=3, **VIA)
        _mark_impulses(panels, one, order, k)
    for j, panel in enumerate(panels):
        _widen_flat(panel, max(float(np.abs(one.position.coefficients[:, :, j]).max()) for one in group))


def via_handle() -> Line2D:
    """Legend entry of the via points."""
    return Line2D([], [], label="via point", **VIA)


def _from_rest_to_rest(t: Array, values: Array) -> tuple[Array, Array]:
    rest = np.zeros((1, values.shape[1]))
    return np.concatenate([t[:1], t, t[-1:]]), np.concatenate([rest, values, rest])


def _mark_impulses(panels: Sequence[Axes], trajectory: Trajectory, order: int, k: int) -> None:
    """An arrowhead at the panel's edge where a lower derivative steps, so that this one is unbounded."""
    for lower in range(1, order):
        jumps = trajectory.jumps(lower)
        for j, panel in enumerate(panels):
            for time, size in zip(jumps.times, jumps.sizes[:, j], strict=True):
                if size:
                    panel.plot(
                        time,
                        0.97 if size > 0 else 0.03,
                        marker="^" if size > 0 else "v",
                        color=colour_of(k),
                        markersize=6,
                        transform=panel.get_xaxis_transform(),
                        gid="impulse",
                    )


def _widen_flat(panel: Axes, size: float) -> None:
    """A joint that keeps still is a line in the middle, not rounding blown up to the panel's height."""
    low, high = panel.dataLim.y0, panel.dataLim.y1
    if high - low <= 1e-9 * max(1.0, size):
        middle = (low + high) / 2
        panel.set_ylim(middle - 0.5, middle + 0.5)


def _bounds(assessment: Assessment, j: int, order: int) -> tuple[float, float]:
    limits = assessment.motion.robot.limits
    if order == 0:
        return float(limits.position[j, 0]), float(limits.position[j, 1])
    bound = float(getattr(limits, QUANTITIES[order])[j])
    return -bound, bound


def _axis_label(order: int, unit: str) -> str:
    return f"{QUANTITIES[order]} [{unit}{_PER_TIME[order]}]"


def _title(trajectory: Trajectory, j: int) -> str:
    return trajectory.joint_names[j] if trajectory.joint_names else f"joint {j + 1}"
