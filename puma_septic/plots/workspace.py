"""Where the tool goes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from puma_septic.assessment import Assessment
from puma_septic.kinematics import forward_kinematics
from puma_septic.plots.joints import VIA, via_handle
from puma_septic.plots.style import (
    add_legend,
    as_group,
    draw_curve,
    new_figure,
    sampled,
    tidy,
    titled,
    unique_labels,
)
from puma_septic.validation import Array

__all__ = ["plot_workspace"]


def plot_workspace(assessment: Assessment | Sequence[Assessment], *, labels: Sequence[str] | None = None) -> Figure:
    """Draw the tool's path in space and its height over time, with the via points.

    The axes are the robot's world, all three to one scale.

    Parameters
    ----------
    assessment : Assessment or sequence of Assessment
        Of arms with the same number of joints.
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
    figure = new_figure(4.3)
    grid = figure.add_gridspec(1, 2, width_ratios=(1.35, 1.0))
    space: Any = figure.add_subplot(grid[0], projection="3d")
    height = figure.add_subplot(grid[1])
    everything = []
    for k, (one, name) in enumerate(zip(group, names, strict=True)):
        trajectory = one.motion.trajectory
        t, q = sampled(trajectory.position)
        path, vias = (forward_kinematics(one.motion.robot, rows)[:, :3, 3] for rows in (q, trajectory.points))
        draw_curve(space, path[:, 0], path[:, 1], k, name)
        space.lines[-1].set_3d_properties(path[:, 2])
        space.plot(*vias.T, **VIA)
        draw_curve(height, t, path[:, 2], k, name)
        height.plot(trajectory.times, vias[:, 2], zorder=3, **VIA)
        everything += [path, vias]
    _to_one_scale(space, np.concatenate(everything))
    titled(height, f"height of {group[0].motion.robot.tool!r}")
    tidy(height, y="z [m]")
    add_legend(figure, names, extra=[via_handle()])
    return figure


def _to_one_scale(space: Any, points: Array) -> None:
    """The same metres per inch on all axes, and a little air."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, size = (low + high) / 2, np.maximum(high - low, 0.2 * max(0.1, float((high - low).max()))) * 1.08
    for axis, m, s in zip("xyz", middle, size, strict=True):
        getattr(space, f"set_{axis}lim")(m - s / 2, m + s / 2)
        getattr(space, f"set_{axis}label")(f"{axis} [m]", fontsize=8)
    space.set_box_aspect(size, zoom=0.92)
    space.tick_params(labelsize=7.5, pad=0)
