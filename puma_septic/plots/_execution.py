"""Figures of simulated executions, of residual vibration and of stops."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from puma_septic.pictures.execution import spectrum_picture, stops_picture, tracking_picture
from puma_septic.plots._drawing import OnAxes, draw
from puma_septic.simulation import Execution, StopTable
from puma_septic.trajectory import Trajectory

__all__ = ["plot_residual_vibration", "plot_stops", "plot_tracking"]


def plot_tracking(execution: Execution, *, ax: OnAxes | None = None) -> Figure:
    """Draw the errors of the tool and of all joints over time, a line for each trajectory; samples of a simulation.

    Parameters
    ----------
    execution : Execution
    ax : sequence of matplotlib Axes, optional
        Where to draw, one for the tool and one for each joint; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For another number of axes.
    """
    return draw(tracking_picture(execution), ax=ax)


def plot_residual_vibration(trajectories: Mapping[str, Trajectory], *, ax: OnAxes | None = None) -> Figure:
    """Draw what each motion leaves in a spring-mass on the joint that it excites most, by natural frequency.

    Parameters
    ----------
    trajectories : mapping of str to Trajectory
        By their names in the legend.
    ax : matplotlib Axes, optional
        Where to draw; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For another number of axes.
    """
    return draw(spectrum_picture(dict(trajectories)), ax=ax)


def plot_stops(table: StopTable, *, ax: OnAxes | None = None) -> Figure:
    """Draw stopping angles by speed and extension, a panel for each joint and load.

    Parameters
    ----------
    table : StopTable
        From `puma_septic.simulation.stop_table`.
    ax : sequence of matplotlib Axes, optional
        Where to draw, one for each joint and load; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For another number of axes.
    """
    return draw(stops_picture(table), ax=ax)
