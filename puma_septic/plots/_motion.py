"""Figures of trajectories and of assessed motions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, TypeVar

import numpy as np
from matplotlib.figure import Figure

from puma_septic.assessment import Assessment
from puma_septic.errors import InputError
from puma_septic.pictures import (
    Dot,
    Picture,
    Samples,
    derivative_picture,
    profile_line,
    samples_of,
    tool_picture,
    torque_picture,
    torque_speed_picture,
    torque_split_picture,
    track_of,
    utilisation_picture,
    via_places,
)
from puma_septic.plots._drawing import OnAxes, dot_style, draw, line_style, new_figure, place_legend
from puma_septic.trajectory import Trajectory

__all__ = [
    "plot_joints",
    "plot_tool",
    "plot_torque",
    "plot_torque_split",
    "plot_torque_velocity",
    "plot_trajectory",
    "plot_utilisation",
    "plot_workspace",
]

# Figures may be enlarged: this many times the samples of a chart on a page.
_DETAIL: Final = 2.4
Drawn = TypeVar("Drawn")


def plot_trajectory(
    trajectory: Trajectory | Sequence[Trajectory],
    order: int = 0,
    *,
    labels: Sequence[str] | None = None,
    joints: str | Sequence[str] | None = None,
    ax: OnAxes | None = None,
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
    joints : str or sequence of str, optional
        Joints to draw, by name; all by default.
    ax : matplotlib Axes or sequence of them, optional
        Where to draw, one for each joint; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For an unknown order or joint, no trajectory, different numbers of joints, or another number of axes.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.septic([[0.0], [0.5], [1.0], [1.5]], [0.0, 1.0, 2.0, 3.0])
    >>> figure = plot_trajectory(move, order=3)
    >>> figure.axes[0].get_ylabel()
    'jerk [rad/s³]'
    """
    group = _group(trajectory, Trajectory, lambda one: one.n_joints)
    names = _labels([one.profile for one in group], labels)
    tracks = [track_of(one, name, detail=_DETAIL) for one, name in zip(group, names, strict=True)]
    return draw(derivative_picture(tracks, order), joints=joints, ax=ax)


def plot_joints(
    assessment: Assessment | Sequence[Assessment],
    *,
    orders: Sequence[int] = (0, 1, 2, 3),
    labels: Sequence[str] | None = None,
    joints: str | Sequence[str] | None = None,
    ax: OnAxes | None = None,
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
    joints : str or sequence of str, optional
        Joints to draw, by name; all by default.
    ax : matplotlib Axes or sequence of them, optional
        Where to draw, row by row; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For an unknown order or joint, no assessment, arms with different numbers of joints, or another number of axes.
    """
    group = _samples(assessment, labels)
    wanted = tuple(orders)
    if not wanted:
        raise InputError("orders: at least one of 0 (position), 1 (velocity), 2 (acceleration), 3 (jerk) is needed")
    robot, tracks = group[0].assessment.motion.robot, [one.track for one in group]
    pictures = [derivative_picture(tracks, order, robot) for order in wanted]
    rows = zip(*(picture.panels for picture in pictures), strict=True)
    entries = {entry.label: entry for picture in pictures for entry in picture.legend}
    picture = Picture(
        name="joints",
        title="Joints",
        panels=tuple(panel for row in rows for panel in row),
        columns=len(wanted),
        legend=tuple(entries.values()),
    )
    return draw(picture, joints=joints, ax=ax)


def plot_torque(
    assessment: Assessment | Sequence[Assessment],
    *,
    labels: Sequence[str] | None = None,
    joints: str | Sequence[str] | None = None,
    ax: OnAxes | None = None,
) -> Figure:
    """Draw the actuator torque of each joint with its effort limit; a diamond marks the peak.

    Steps, as Coulomb friction makes them where a joint reverses, are vertical lines. Where the torque is
    unbounded because a velocity steps, the panel says so.

    Parameters
    ----------
    assessment : Assessment or sequence of Assessment
        Of the same arm; the limits drawn are those of the first.
    labels : sequence of str, optional
        Legend entries; the profiles' names by default.
    joints : str or sequence of str, optional
        Joints to draw, by name; all by default.
    ax : matplotlib Axes or sequence of them, optional
        Where to draw, one for each joint; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For no assessment, an unknown joint, arms with different numbers of joints, or another number of axes.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> figure = plot_torque(ps.assess(ps.load_robot(), move), joints="joint2")
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['torque [N m]']
    """
    return draw(torque_picture(_samples(assessment, labels)), joints=joints, ax=ax)


def plot_torque_velocity(
    assessment: Assessment | Sequence[Assessment],
    *,
    labels: Sequence[str] | None = None,
    joints: str | Sequence[str] | None = None,
    ax: OnAxes | None = None,
) -> Figure:
    """Draw torque vs. velocity of each joint within the rectangle of its limits.

    Parameters, result and errors are those of `plot_torque`.
    """
    return draw(torque_speed_picture(_samples(assessment, labels)), joints=joints, ax=ax)


def plot_torque_split(
    assessment: Assessment, *, joints: str | Sequence[str] | None = None, ax: OnAxes | None = None
) -> Figure:
    """Draw the torque of each joint by cause: inertia, Coriolis, gravity, rotor, friction, payload, wrench.

    The causes sum to the dark line. One that a joint does not know is left out of its panel.

    Parameters
    ----------
    assessment : Assessment
    joints : str or sequence of str, optional
        Joints to draw, by name; all by default.
    ax : matplotlib Axes or sequence of them, optional
        Where to draw, one for each joint; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For anything other than one assessment, an unknown joint, or another number of axes.
    """
    (one,) = _samples((assessment,), None)
    return draw(torque_split_picture(one), joints=joints, ax=ax)


def plot_utilisation(
    assessment: Assessment | Sequence[Assessment],
    *,
    labels: Sequence[str] | None = None,
    ax: OnAxes | None = None,
) -> Figure:
    """Draw each demand as a bar in per cent of its limit; beyond the line at 100 % the limit is violated.

    For positions, 100 % is the end of the range and 0 % its middle. A limit that is not known says so.

    Parameters
    ----------
    assessment : Assessment or sequence of Assessment
        Of arms with the same number of joints.
    labels : sequence of str, optional
        Legend entries; the profiles' names by default.
    ax : matplotlib Axes or sequence of them, optional
        Where to draw, one for each quantity with a known limit; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For no assessment, arms with different numbers of joints, or another number of axes.
    """
    group = _group(assessment, Assessment, lambda one: one.motion.robot.n_joints)
    names = _labels([one.motion.trajectory.profile for one in group], labels)
    return draw(utilisation_picture(group, names), ax=ax)


def plot_tool(
    assessment: Assessment | Sequence[Assessment],
    *,
    labels: Sequence[str] | None = None,
    ax: OnAxes | None = None,
) -> Figure:
    """Draw the tool's path from above and from the side, its height and its speed over time.

    Parameters
    ----------
    assessment : Assessment or sequence of Assessment
        Of arms with the same number of joints.
    labels : sequence of str, optional
        Legend entries; the profiles' names by default.
    ax : sequence of matplotlib Axes, optional
        Where to draw, four; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For no assessment, arms with different numbers of joints, or another number of axes.
    """
    return draw(tool_picture(_samples(assessment, labels)), ax=ax)


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
    group = _samples(assessment, labels)
    picture = tool_picture(group)
    figure = new_figure(4.3)
    grid = figure.add_gridspec(1, 2, width_ratios=(1.35, 1.0))
    _draw_space(figure.add_subplot(grid[0], projection="3d"), group)
    (height,) = (panel for panel in picture.panels if panel.title.startswith("height"))
    draw(Picture(name="height", title="", panels=(height,)), ax=figure.add_subplot(grid[1]))
    place_legend(figure, picture.legend)
    return figure


def _draw_space(space: Any, group: Sequence[Samples]) -> None:
    """Paths in space: the same metres per inch on all axes, and a little air."""
    places = [via_places(one) for one in group]
    for k, (one, vias) in enumerate(zip(group, places, strict=True)):
        space.plot(*one.place.T, **line_style(profile_line(k)))
        space.plot(*vias.T, **dot_style(Dot(shape="via")))
    points = np.concatenate([*places, *(one.place for one in group)])
    low, high = points.min(axis=0), points.max(axis=0)
    middle, size = (low + high) / 2, np.maximum(high - low, 0.2 * max(0.1, float((high - low).max()))) * 1.08
    for axis, m, s in zip("xyz", middle, size, strict=True):
        getattr(space, f"set_{axis}lim")(m - s / 2, m + s / 2)
        getattr(space, f"set_{axis}label")(f"{axis} [m]", fontsize=8)
    space.set_box_aspect(size, zoom=0.92)
    space.tick_params(labelsize=7.5, pad=0)


def _samples(assessment: Assessment | Sequence[Assessment], labels: Sequence[str] | None) -> list[Samples]:
    group = _group(assessment, Assessment, lambda one: one.motion.robot.n_joints)
    names = _labels([one.motion.trajectory.profile for one in group], labels)
    return [samples_of(one, name, detail=_DETAIL) for one, name in zip(group, names, strict=True)]


def _group(what: Drawn | Sequence[Drawn], kind: type[Drawn], n_joints: Callable[[Drawn], int]) -> tuple[Drawn, ...]:
    """One value or a sequence of them as a tuple."""
    group = (what,) if isinstance(what, kind) else tuple(what) if isinstance(what, Sequence) else ()
    if not group or not all(isinstance(one, kind) for one in group):
        raise InputError(f"expected one {kind.__name__} or a sequence of them, got {what!r}")
    counts = {n_joints(one) for one in group}
    if len(counts) > 1:
        raise InputError(f"drawn together, all must have the same joints; got {sorted(counts)} joints")
    return group


def _labels(names: Sequence[str], given: Sequence[str] | None) -> list[str]:
    """Legend entries: those given, or the names, numbered where one occurs twice."""
    if given is not None:
        if len(given) != len(names) or isinstance(given, str):
            raise InputError(f"labels: {len(names)} texts are needed, one for each curve, got {given!r}")
        return list(given)
    return [name if names.count(name) == 1 else f"{name} {names[: k + 1].count(name)}" for k, name in enumerate(names)]
