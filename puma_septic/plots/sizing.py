"""Sizings as pictures: torque over speed, use of every limit, temperature, causes of torque, choice of the ratio."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from puma_septic.errors import InputError
from puma_septic.limit_check import LimitCheck
from puma_septic.plots.style import (
    LIMIT,
    PALETTE,
    beside,
    joint_panels,
    new_figure,
    place_legend,
    sampled,
    tidy,
)
from puma_septic.sizing import Demands, Sizing
from puma_septic.validation import Array

__all__ = [
    "plot_ratio_sweep",
    "plot_sizing_torque_split",
    "plot_sizing_utilisation",
    "plot_torque_speed",
    "plot_winding_temperature",
    "sizing_figures",
]

_RPM: Final = 60 / (2 * np.pi)
_CAUSES: Final = ("gravity", "motion", "rotor", "friction")
_MARK: Final[dict[str, Any]] = {"linestyle": "none", "marker": "o", "markersize": 6, "markeredgecolor": "black"}
_DOTTED: Final[dict[str, Any]] = {"color": "black", "linewidth": 0.9, "linestyle": (0, (1, 1.5))}
# Ratios drawn, from a fifth of the own one to five times it.
_RATIOS: Final = np.geomspace(0.2, 5.0, 121)
# Upper ends of the bands of utilisation, %, and their shades: Okabe and Ito's blue in three tints, orange, vermilion.
_BANDS: Final = (25.0, 50.0, 80.0, 100.0)
_SHADES: Final = ("#E3EFF6", "#B3D3E8", "#66A9CF", "#E69F00", "#D55E00")
_HATCHED: Final[dict[str, Any]] = {"facecolor": "white", "edgecolor": "#D55E00", "hatch": "////", "linewidth": 0.8}


def sizing_figures(sizing: Sizing) -> Iterator[tuple[str, Figure]]:
    """File name without suffix and figure, made when they are asked for; those with nothing to show are left out."""
    yield "torque-speed", plot_torque_speed(sizing)
    if sizing.checks:
        yield "utilisation", plot_sizing_utilisation(sizing)
    if any(demands.temperature_rise is not None for demands in sizing.demands):
        yield "winding-temperature", plot_winding_temperature(sizing)
    yield "torque-split", plot_sizing_torque_split(sizing)
    yield "ratio-sweep", plot_ratio_sweep(sizing)


def plot_torque_speed(sizing: Sizing) -> Figure:
    """Draw each motor's torque over its speed within what it can give; a dot marks RMS torque at mean speed.

    The dashed line is the limit for a short time, the dotted one (S1) the limit for the dot, each as far as it is
    known, in all four quadrants. What is not known is not drawn; a panel without limits says so.
    """
    figure = _figure(sizing)
    for panel, d in zip(joint_panels(figure, _names(sizing)), sizing.demands, strict=True):
        t, torque = sampled(d.motor.torque)
        # Where the torque steps there are two values for one speed.
        speed = d.motor.speed(np.clip(t, d.motor.speed.breaks[0], d.motor.speed.breaks[-1]))
        panel.plot(speed[:, 0] * _RPM, torque[:, 0], color=PALETTE[0], linewidth=1.3)
        shown = [*_draw_envelope(panel, d.train.motor.peak_curve, _peak_torque(d), d.train.motor.max_speed, LIMIT)]
        motor = d.train.motor
        shown += _draw_envelope(panel, motor.continuous_curve, motor.continuous_torque, np.nan, _DOTTED)
        if np.isfinite(d.rms_torque):
            panel.plot(d.mean_speed * _RPM, d.rms_torque, color=PALETTE[1], zorder=4, **_MARK)
        tidy(panel, x="motor speed [1/min]", y="motor torque [N m]")
        if not shown:
            beside(panel, "no torque limit known")
    curve = Line2D([], [], color=PALETTE[0], linewidth=1.6, label="cycle")
    dot = Line2D([], [], color=PALETTE[1], label="RMS torque at mean speed", **_MARK)
    limits = [Line2D([], [], label="for a short time", **LIMIT), Line2D([], [], label="continuous (S1)", **_DOTTED)]
    place_legend(figure, [curve, dot, *limits])
    return figure


def _peak_torque(d: Demands) -> float:
    """The lower one of the motor's limit and that of the whole actuator, at the motor; NaN: neither is known."""
    return float(np.fmin(d.train.motor.peak_torque, d.train.max_effort / d.train.ratio))


def _draw_envelope(panel: Axes, curve: Array, torque: float, speed: float, style: dict[str, Any]) -> list[bool]:
    """In four quadrants; a constant torque ends at the highest speed, where that is known."""
    if len(curve):
        right, up = curve[:, 0] * _RPM, curve[:, 1]
        right, up = np.append(right, right[-1]), np.append(up, 0.0)
        panel.plot(np.concatenate([right, right[::-1], -right, -right[::-1]]),
                   np.concatenate([up, -up[::-1], -up, up[::-1]]), **style)  # fmt: skip
        return [True]
    if np.isnan(torque):
        return []
    if np.isnan(speed):
        for sign in (1, -1):
            panel.axhline(sign * torque, **style)
    else:
        x, y = speed * _RPM, torque
        panel.plot([-x, x, x, -x, -x], [y, y, -y, -y, y], **style)
    return [True]


def plot_sizing_utilisation(sizing: Sizing) -> Figure:
    """Draw the use of every known limit at every joint: a bar in each cell, and its number; the frame is 100 %.

    Beyond 100 % the limit is broken and the bar fills its cell. Rules of thumb have a question mark, and are hatched.

    Raises
    ------
    InputError
        If no limit is known.
    """
    checks = sizing.checks
    if not checks:
        raise InputError("no limit of the drive trains is known: there is no use of limits to draw")
    names = list(dict.fromkeys(check.quantity for check in checks))
    joints = list(_names(sizing))
    figure = new_figure(1.1 + 0.27 * len(names))
    panel = figure.add_subplot()
    for check in checks:
        _draw_use(panel, joints.index(check.joint), names.index(check.quantity), check)
    thumb = {check.quantity for check in checks if check.kind == "rule of thumb"}
    panel.set_yticks(range(len(names)), [f"{name} (?)" if name in thumb else name for name in names], fontsize=8)
    panel.set_xticks(range(len(joints)), joints, fontsize=8)
    panel.tick_params(length=0)
    panel.set_xlim(-0.55, len(joints) - 0.45)
    panel.set_ylim(len(names) - 0.45, -0.55)
    panel.spines[:].set_visible(False)
    panel.set_xlabel("use of the limit [%]; a bar that fills its frame is at 100 %", fontsize=8)
    labels = ("to 25 %", "to 50 %", "to 80 %", "to 100 %", "broken")
    patches = [Patch(color=c, label=text) for c, text in zip(_SHADES, labels, strict=True)]
    place_legend(figure, [*patches, Patch(label="rule of thumb (?)", **_HATCHED)])
    return figure


def _draw_use(panel: Axes, x: int, y: int, check: LimitCheck) -> None:
    """One bar in its frame, with its number."""
    use = 100 * check.utilisation
    colour = _SHADES[int(np.searchsorted(_BANDS, 100.0 if not check.is_violated and use > 100 else use))]
    style = _HATCHED if check.is_violated and check.kind == "rule of thumb" else {"color": colour}
    panel.barh(y, 0.94 * min(use, 100.0) / 100, left=x - 0.47, height=0.78, **style)
    panel.barh(y, 0.94, left=x - 0.47, height=0.78, facecolor="none", edgecolor="0.75", linewidth=0.6)
    text = "unbounded" if np.isinf(use) else f"{use:.0f} %" if use < 1000 else f"{use / 100:.3g} x"
    panel.text(x, y, text, ha="center", va="center", fontsize=7.5, weight="bold" if check.is_violated else "normal")


def plot_winding_temperature(sizing: Sizing) -> Figure:
    """Draw each winding's temperature over the steady cycle, with its limit and the ambient temperature.

    A panel says why there is nothing to draw where that is so.
    """
    figure = _figure(sizing)
    for panel, d in zip(joint_panels(figure, _names(sizing)), sizing.demands, strict=True):
        rise, ambient = d.temperature_rise, d.train.ambient_celsius
        if rise is None:
            runs_away = np.isinf(d.peak_temperature_rise.size)
            _say(panel, "runs away: no steady temperature" if runs_away else d.why_no_temperature)
        else:
            t, values = sampled(rise)
            panel.plot(t, values[:, 0] + ambient, color=PALETTE[1], linewidth=1.5)
            if values.shape[1] > 1:
                panel.plot(t, values[:, 1] + ambient, color=PALETTE[5], linewidth=1.3)
            panel.axhline(ambient, **_DOTTED)
            if not np.isnan(d.train.motor.max_winding_celsius):
                panel.axhline(d.train.motor.max_winding_celsius, **LIMIT)
        tidy(panel, y="temperature [°C]")
        if rise is None:
            panel.set(xticks=[], yticks=[], xlabel="", ylabel="")
    handles = [
        Line2D([], [], color=PALETTE[1], linewidth=1.6, label="winding"),
        Line2D([], [], color=PALETTE[5], linewidth=1.6, label="housing"),
        Line2D([], [], label="limit of the winding", **LIMIT),
        Line2D([], [], label="ambient", **_DOTTED),
    ]
    place_legend(figure, handles)
    return figure


def plot_sizing_torque_split(sizing: Sizing | Sequence[Sizing], *, labels: Sequence[str] | None = None) -> Figure:
    """Draw the RMS torque at each joint by cause, in bars side by side: gravity, motion, rotor, friction.

    Each cause is a root mean square of its own; they do not add up to that of the sum.

    Parameters
    ----------
    sizing : Sizing or sequence of Sizing
        Of the same arm; one group of bars each.
    labels : sequence of str, optional
        Of the groups, where there are several.
    """
    group = (sizing,) if isinstance(sizing, Sizing) else tuple(sizing)
    if not group:
        raise InputError("expected one Sizing or a sequence of them, got none")
    texts = list(labels) if labels is not None else [f"cycle {k + 1}" for k in range(len(group))]
    if len(texts) != len(group):
        raise InputError(f"labels: {len(group)} texts are needed, one for each sizing, got {len(texts)}")
    figure = _figure(group[0])
    for j, panel in enumerate(joint_panels(figure, _names(group[0]))):
        for k, cause in enumerate(_CAUSES):
            heights = [one.demands[j].rms_by_cause[cause] for one in group]
            panel.bar(np.arange(len(group)) + (k - 1.5) * 0.2, heights, width=0.19, color=PALETTE[k])
        slides = group[0].demands[j].load.is_prismatic
        tidy(panel, x="", y="RMS force [N]" if slides else "RMS torque [N m]")
        panel.set_xticks(range(len(group)), texts if len(group) > 1 else [""], fontsize=7)
        panel.grid(visible=False, axis="x")
        panel.tick_params(axis="x", length=0)
    place_legend(figure, [Patch(color=PALETTE[k], label=cause) for k, cause in enumerate(_CAUSES)])
    return figure


def plot_ratio_sweep(sizing: Sizing) -> Figure:
    """Draw each motor's RMS torque over the gear ratio, all else as it is, with the ratio at hand and its limits.

    The RMS torque is exact: with the load's mean squares it is a function of the ratio. The curve ends where the motor
    would turn faster than it can.
    """
    figure = _figure(sizing)
    for panel, d in zip(joint_panels(figure, _names(sizing)), sizing.demands, strict=True):
        if not np.isfinite(d.rms_torque):
            _say(panel, "unbounded torque")
            continue
        ratios = _RATIOS * d.train.ratio
        speeds = ratios / d.train.ratio * d.peak_speed.size
        allowed = ~(speeds > np.fmin(d.train.motor.max_speed, d.train.gearbox.max_input_speed))
        rms = _rms_over_ratio(d)
        panel.plot(ratios[allowed], rms[allowed], color=PALETTE[0], linewidth=1.5)
        panel.plot(ratios[~allowed], rms[~allowed], color="0.75", linewidth=1.2)
        panel.plot(d.train.ratio, d.rms_torque, color=PALETTE[1], zorder=4, **_MARK)
        limits = [d.train.motor.continuous_torque_at(speed) for speed in _RATIOS * d.mean_speed]
        panel.plot(ratios, limits, **_DOTTED)
        tidy(panel, x="gear ratio [1]", y="RMS motor torque [N m]")
        panel.set_ylim(0.0, max(2.5 * d.rms_torque, 1.2 * np.nan_to_num(limits[len(limits) // 2])) or 1.0)
    handles = [
        Line2D([], [], color=PALETTE[0], linewidth=1.6, label="RMS torque"),
        Line2D([], [], color="0.75", linewidth=1.6, label="beyond the top speed"),
        Line2D([], [], color=PALETTE[1], label="ratio at hand", **_MARK),
        Line2D([], [], label="continuous torque", **_DOTTED),
    ]
    place_legend(figure, handles)
    return figure


def _rms_over_ratio(d: Demands) -> Array:
    """``n``: the load falls with it, the rotor and viscous friction grow, Coulomb friction stays."""
    parts, size = d.motor.parts, d.motor.duration
    steps = parts["friction"] - d.load.velocity * (d.train.friction.known.viscous * d.train.ratio)
    turning = parts["rotor"] + parts["friction"] - steps
    functions = [parts["load"], turning, steps]
    gram = np.array([[float(f.inner(g)[0]) / size for g in functions] for f in functions])
    c = np.column_stack([1 / _RATIOS, _RATIOS, np.ones_like(_RATIOS)])
    return np.asarray(np.sqrt(np.maximum(np.einsum("ni,ij,nj->n", c, gram, c), 0.0)))


def _figure(sizing: Sizing) -> Figure:
    return new_figure(0.8 + 2.3 * -(-len(sizing.demands) // 3))


def _names(sizing: Sizing) -> tuple[str, ...]:
    return sizing.cycle.joint_names


def _say(panel: Axes, text: str) -> None:
    panel.text(0.5, 0.5, text, ha="center", va="center", fontsize=8, wrap=True, transform=panel.transAxes)
