"""Figures of sizings."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from puma_septic.errors import InputError
from puma_septic.pictures.sizing import (
    arm_front_picture,
    ratio_sweep_picture,
    sizing_torque_split_picture,
    sizing_utilisation_picture,
    torque_speed_picture,
    winding_temperature_picture,
)
from puma_septic.plots._drawing import OnAxes, draw
from puma_septic.sizing import ArmChoice, Sizing

__all__ = [
    "plot_arm_front",
    "plot_ratio_sweep",
    "plot_sizing_torque_split",
    "plot_sizing_utilisation",
    "plot_torque_speed",
    "plot_winding_temperature",
]


def plot_torque_speed(sizing: Sizing, *, joints: str | Sequence[str] | None = None, ax: OnAxes | None = None) -> Figure:
    """Draw each motor's torque vs. its speed within what it can give; a dot marks RMS torque at mean speed.

    The dashed line is the limit for a short time, the dotted one (S1) the limit for the dot, each as far as it is
    known, in all four quadrants. What is not known is not drawn; a panel without limits says so.

    Parameters
    ----------
    sizing : Sizing
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
        For an unknown joint, or another number of axes than of joints.
    """
    return draw(torque_speed_picture(sizing), joints=joints, ax=ax)


def plot_sizing_utilisation(
    sizing: Sizing, *, joints: str | Sequence[str] | None = None, ax: OnAxes | None = None
) -> Figure:
    """Draw the utilisation of every known limit at every joint, in per cent; beyond 100 % the limit is violated.

    Bars end at 125 %, their texts tell what is beyond. Rules of thumb have a question mark, and are hatched where they
    are exceeded.

    Parameters, result and errors are those of `plot_torque_speed`.

    Raises
    ------
    InputError
        Also if no limit is known.
    """
    if not sizing.checks:
        raise InputError("no limit of the drive trains is known: there is no utilisation to draw")
    return draw(sizing_utilisation_picture(sizing), joints=joints, ax=ax)


def plot_winding_temperature(
    sizing: Sizing, *, joints: str | Sequence[str] | None = None, ax: OnAxes | None = None
) -> Figure:
    """Draw each winding's temperature over the steady cycle, with its limit and the ambient temperature.

    A panel says why there is nothing to draw where that is so.

    Parameters, result and errors are those of `plot_torque_speed`.
    """
    return draw(winding_temperature_picture(sizing), joints=joints, ax=ax)


def plot_sizing_torque_split(
    sizing: Sizing | Sequence[Sizing],
    *,
    labels: Sequence[str] | None = None,
    joints: str | Sequence[str] | None = None,
    ax: OnAxes | None = None,
) -> Figure:
    """Draw the RMS torque at each joint by cause, as bars: gravity, motion, losses of the gears, rotor, friction.

    Each cause is a root mean square of its own; they do not add up to that of the sum.

    Parameters
    ----------
    sizing : Sizing or sequence of Sizing
        Of the same arm; one group of bars each.
    labels : sequence of str, optional
        Of the groups, where there are several.
    joints, ax : optional
        As for `plot_torque_speed`.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.

    Raises
    ------
    InputError
        For no sizing, another number of labels than of sizings, an unknown joint, or another number of axes.
    """
    group = (sizing,) if isinstance(sizing, Sizing) else tuple(sizing)
    if not group:
        raise InputError("expected one Sizing or a sequence of them, got none")
    if labels is None:
        labels = [""] if len(group) == 1 else [f"cycle {k + 1}" for k in range(len(group))]
    if len(labels) != len(group):
        raise InputError(f"labels: {len(group)} texts are needed, one for each sizing, got {len(labels)}")
    return draw(sizing_torque_split_picture(group, labels), joints=joints, ax=ax)


def plot_ratio_sweep(sizing: Sizing, *, joints: str | Sequence[str] | None = None, ax: OnAxes | None = None) -> Figure:
    """Draw each motor's RMS torque vs. the gear ratio, all else as it is, with the ratio at hand and its limits.

    The RMS torque is exact: with the load's mean squares it is a function of the ratio. The curve is faint where the
    motor would turn faster than it can.

    Parameters, result and errors are those of `plot_torque_speed`.
    """
    return draw(ratio_sweep_picture(sizing), joints=joints, ax=ax)


def plot_arm_front(front: Sequence[ArmChoice], *, ax: OnAxes | None = None) -> Figure:
    """Draw mass and cost of each choice for the whole arm vs. the margin that it leaves.

    Parameters
    ----------
    front : sequence of ArmChoice
        As `Selection.front` returns it.
    ax : sequence of matplotlib Axes, optional
        Where to draw, one for mass and one for cost; a figure of its own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Neither shown nor saved.
    """
    return draw(arm_front_picture(front), ax=ax)
