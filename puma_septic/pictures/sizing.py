"""Pictures of sizings: torque vs. speed, use of the limits, temperature, causes of torque, choice of the ratio."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from puma_septic.limit_check import LimitCheck
from puma_septic.pictures._elements import (
    NEGLIGIBLE,
    Bar,
    Curve,
    Entry,
    Mark,
    Panel,
    Picture,
    Rule,
    bars,
    chart,
    saying,
)
from puma_septic.pictures._styles import DOTTED, FAINT, LIMIT, PROFILES, Dot, Fill, Line, Style, cause_lines
from puma_septic.pictures._utilisation import END, percent_text
from puma_septic.piecewise import sampled
from puma_septic.sizing import ArmChoice, Demands, Sizing
from puma_septic.validation import Array

__all__ = [
    "arm_front_picture",
    "ratio_sweep_picture",
    "sizing_pictures",
    "sizing_torque_split_picture",
    "sizing_utilisation_picture",
    "torque_speed_picture",
    "winding_temperature_picture",
]

_RPM: Final = 60 / (2 * np.pi)
_SOLID, _SECOND = Line(hue=PROFILES[0], width=1.5), Line(hue=PROFILES[1], width=1.5)
_HOUSING, _BEYOND = Line(hue=PROFILES[5], width=1.5), Line(hue=FAINT, width=1.5)
_DOT: Final = Dot(shape="dot", hue=PROFILES[1])
_VOLTAGE, _CURRENT = Line(hue=PROFILES[4], width=1.2), Line(hue=PROFILES[3], dash=(2.4, 2.0), width=1.2)
_CHOICE: Final = Dot(shape="dot", hue=PROFILES[0])
# Speeds at which the line of the voltage is computed; and how far above all else it, and that of the current, is drawn.
_SPEEDS: Final = 201
_ABOVE: Final = 1.6
# Ratios drawn, from a fifth of the own one to five times it.
_RATIOS: Final = np.geomspace(0.2, 5.0, 121)
_KEPT, _CLOSE, _VIOLATED = Fill(hue=PROFILES[0]), Fill(hue=PROFILES[4]), Fill(hue=PROFILES[1])
_UNUSUAL: Final = Fill(hue=PROFILES[1], is_hatched=True)
# Utilisation from which a bar is drawn as close to its limit, %; a matter of colour alone.
_CLOSE_FROM: Final = 80.0


def sizing_pictures(sizing: Sizing) -> tuple[Picture, ...]:
    """All that have something to show."""
    has_temperature = any(demands.temperature_rise is not None for demands in sizing.demands)
    return (
        torque_speed_picture(sizing),
        *([sizing_utilisation_picture(sizing)] if sizing.checks else []),
        *([winding_temperature_picture(sizing)] if has_temperature else []),
        sizing_torque_split_picture([sizing], [""]),
        ratio_sweep_picture(sizing),
    )


def torque_speed_picture(sizing: Sizing) -> Picture:
    """Each motor's torque vs. its speed within what it can give, in all four quadrants."""
    legend: dict[str, Style] = {
        "cycle": _SOLID,
        "RMS torque at mean speed": _DOT,
        "for a short time": LIMIT,
        "continuous (S1)": DOTTED,
        "bus voltage, winding at its warmest": _VOLTAGE,
        "peak current of the drive": _CURRENT,
    }
    panels = [_torque_speed_panel(name, d) for name, d in _joints(sizing)]
    drawn = {curve.line for panel in panels for curve in panel.curves}
    drawn |= {rule.line for panel in panels for rule in panel.levels}
    legend = {label: style for label, style in legend.items() if style not in (_VOLTAGE, _CURRENT) or style in drawn}
    return _picture("torque-speed", "Motor torque vs. speed", panels, legend)


def _torque_speed_panel(joint: str, d: Demands) -> Panel:
    motor = d.train.motor
    t, torque = sampled(d.motor.torque)
    # Where the torque steps there are two values for one speed.
    speed = d.motor.speed(np.clip(t, d.motor.speed.breaks[0], d.motor.speed.breaks[-1]))
    cycle = Curve(x=speed[:, 0] * _RPM, y=torque[:, 0], line=_SOLID, label="cycle")
    # The lower one of the motor's limit and that of the whole actuator, at the motor; NaN: neither is known.
    peak = float(np.fmin(motor.peak_torque, d.train.max_effort / d.train.ratio))
    envelopes, rules = [], []
    for curve, torque_limit, top, line in (
        (d.train.peak_curve, peak, motor.max_speed, LIMIT),
        (d.train.continuous_curve, motor.continuous_torque, np.nan, DOTTED),
    ):
        corners = _corners(curve, torque_limit, top)
        if corners is not None:
            envelopes.append(Curve(x=corners[0], y=corners[1], line=line))
        elif not np.isnan(torque_limit):
            rules += [Rule(at=sign * torque_limit, line=line) for sign in (1, -1)]
    is_known = np.isfinite(d.rms_torque)
    top = _ABOVE * max(float(np.abs(curve.y).max()) for curve in (cycle, *envelopes))
    end = max(float(np.abs(curve.x).max()) for curve in (cycle, *envelopes))
    rules += _current_rules(d, top)
    return chart(
        "still",
        [cycle, *envelopes, *_voltage_lines(d, end, top)],
        title=joint,
        x_label="motor speed [1/min]",
        y_label="motor torque [N m]",
        marks=[Mark(x=d.mean_speed * _RPM, y=d.rms_torque, dot=_DOT)] if is_known else [],
        levels=rules,
        remark="" if envelopes or rules else "no torque limit known",
    )


def _voltage_lines(d: Demands, end: float, top: float) -> list[Curve]:
    """Torques at which the terminals have the bus voltage, up to a speed in 1/min and a torque in N m.

    ``(R i + k_e w)^2 + (X w i)^2 = V^2``, as `Winding` has it; a drive that weakens the field has no such line.
    """
    motor, volts = d.train.motor, d.train.drive.bus_voltage
    if not d.electric.is_known or np.isnan(volts) or d.electric.weakens_field:
        return []
    warmest = float(d.electric.resistance.extrema().max[0])
    w = np.linspace(-end, end, _SPEEDS) / _RPM
    impedance = warmest**2 + (motor.reactance_constant * w) ** 2
    across = warmest * motor.back_emf * w
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(across**2 - impedance * ((motor.back_emf * w) ** 2 - volts**2))
        torques = [motor.dc_torque_constant * (sign * root - across) / impedance for sign in (1, -1)]
    within = [np.abs(torque) <= top for torque in torques]
    return [Curve(x=w[k] * _RPM, y=t[k], line=_VOLTAGE) for k, t in zip(within, torques, strict=True) if k.any()]


def _current_rules(d: Demands, top: float) -> list[Rule]:
    torque = d.train.drive.peak_current * d.train.motor.torque_constant
    return [Rule(at=sign * torque, line=_CURRENT) for sign in (1, -1)] if torque <= top else []


def _corners(curve: Array, torque: float, top: float) -> tuple[Array, Array] | None:
    """The envelope in four quadrants, closed; a constant torque has one where the highest speed is known."""
    if len(curve):
        right, up = np.append(curve[:, 0], curve[-1, 0]) * _RPM, np.append(curve[:, 1], 0.0)
    elif np.isnan(torque) or np.isnan(top):
        return None
    else:
        right, up = np.array([0.0, top, top]) * _RPM, np.array([torque, torque, 0.0])
    x = np.concatenate([right, right[::-1], -right, -right[::-1]])
    return x, np.concatenate([up, -up[::-1], -up, up[::-1]])


def sizing_utilisation_picture(sizing: Sizing) -> Picture:
    """The use of every known limit: a panel for each joint, a row for each limit; (?) is a rule of thumb."""
    names = list(dict.fromkeys(check.quantity for check in sizing.checks))
    thumb = {check.quantity for check in sizing.checks if check.kind == "rule of thumb"}
    rows = [f"{name} (?)" if name in thumb else name for name in names]
    found = {(check.joint, check.quantity): check for check in sizing.checks}
    panels = [
        bars(
            joint,
            "limit utilisation [%]",
            rows=rows,
            bars=[_use_bar(found.get((joint, name)), row) for row, name in enumerate(names)],
            end=END,
            limit=100.0,
        )
        for joint, _ in _joints(sizing)
    ]
    legend: dict[str, Style] = {
        f"to {_CLOSE_FROM:z.0f} %": _KEPT,
        "to 100 %": _CLOSE,
        "violated": _VIOLATED,
        "rule of thumb (?) exceeded": _UNUSUAL,
        "limit": LIMIT,
    }
    return _picture("utilisation", "Limit utilisation of the drives", panels, legend)


def _use_bar(check: LimitCheck | None, row: int) -> Bar:
    if check is None:
        return Bar(row=row, length=np.nan, fill=_KEPT, text="not assessed")
    percent = 100 * check.utilisation
    if check.is_violated:
        style = _UNUSUAL if check.kind == "rule of thumb" else _VIOLATED
    else:
        style = _CLOSE if percent > _CLOSE_FROM else _KEPT
    text = percent_text(check.utilisation, is_violated=check.is_violated)
    return Bar(row=row, length=percent, fill=style, text=text, is_violated=check.is_violated)


def winding_temperature_picture(sizing: Sizing) -> Picture:
    """Each winding's temperature over the steady cycle, with its limit and the ambient temperature."""
    legend: dict[str, Style] = {
        "winding": _SECOND,
        "housing": _HOUSING,
        "limit of the winding": LIMIT,
        "ambient": DOTTED,
    }
    panels = [_temperature_panel(name, d) for name, d in _joints(sizing)]
    return _picture("winding-temperature", "Winding temperature", panels, legend)


def _temperature_panel(joint: str, d: Demands) -> Panel:
    rise, ambient, limit = d.temperature_rise, d.train.ambient_celsius, d.train.motor.max_winding_celsius
    if rise is None:
        runs_away = np.isinf(d.peak_temperature_rise.size)
        return saying(joint, "runs away: no steady temperature" if runs_away else d.why_no_temperature)
    t, values = sampled(rise)
    nodes = zip(values.T[:2], (_SECOND, _HOUSING), ("winding", "housing"), strict=False)
    rules = [Rule(at=ambient, line=DOTTED), *([] if np.isnan(limit) else [Rule(at=limit)])]
    return chart(
        "still",
        [Curve(x=t, y=node + ambient, line=line, label=name) for node, line, name in nodes],
        title=joint,
        y_label="temperature [°C]",
        span=(float(t[0]), float(t[-1])),
        levels=rules,
    )


def sizing_torque_split_picture(group: Sequence[Sizing], labels: Sequence[str]) -> Picture:
    """The RMS torque at each joint by cause, a row for each sizing; the causes' own RMS values do not add up."""
    causes = list(group[0].demands[0].rms_by_cause)
    fills = {cause: Fill(hue=line.hue) for cause, line in cause_lines(causes).items()}
    panels = []
    for j, (joint, d) in enumerate(_joints(group[0])):
        rms = [one.demands[j].rms_by_cause for one in group]
        largest = max((x for row in rms for x in row.values() if np.isfinite(x)), default=0.0)
        panels.append(
            bars(
                joint,
                "RMS force [N]" if d.load.is_prismatic else "RMS torque [N m]",
                rows=labels,
                bars=[
                    Bar(row=k, slot=n, length=row[cause], fill=fills[cause], text=_size(row[cause], largest))
                    for k, row in enumerate(rms)
                    for n, cause in enumerate(causes)
                ],
                end=1.04 * largest or 1.0,
            )
        )
    return _picture("torque-split", "RMS torque by cause", panels, fills)


def ratio_sweep_picture(sizing: Sizing) -> Picture:
    """Each motor's RMS torque vs. the gear ratio, all else as it is, with the ratio at hand and its limits.

    The RMS torque is exact: with the load's mean squares it is a function of the ratio.
    """
    legend: dict[str, Style] = {
        "RMS torque": _SOLID,
        "beyond the top speed": _BEYOND,
        "ratio at hand": _DOT,
        "continuous torque": DOTTED,
    }
    panels = [_ratio_panel(name, d) for name, d in _joints(sizing)]
    return _picture("ratio-sweep", "RMS torque vs. gear ratio", panels, legend)


def _ratio_panel(joint: str, d: Demands) -> Panel:
    if not np.isfinite(d.rms_torque):
        return saying(joint, "unbounded torque")
    ratios = _RATIOS * d.train.ratio
    allowed = ~(_RATIOS * d.peak_speed.size > np.fmin(d.train.motor.max_speed, d.train.gearbox.max_input_speed))
    rms = _rms_over_ratio(d)
    limits = np.array([d.train.continuous_torque_at(speed) for speed in _RATIOS * d.mean_speed])
    # What is far above the ratio at hand would flatten what is near it.
    top = max(2.5 * d.rms_torque, 1.2 * float(np.nan_to_num(limits[len(limits) // 2]))) or 1.0
    shown = rms <= top
    parts = ((allowed & shown, rms, _SOLID), (~allowed & shown, rms, _BEYOND), (limits <= top, limits, DOTTED))
    panel = chart(
        "still",
        [Curve(x=ratios[where], y=values[where], line=line) for where, values, line in parts if where.any()],
        title=joint,
        x_label="gear ratio [1]",
        y_label="RMS motor torque [N m]",
        marks=[Mark(x=d.train.ratio, y=d.rms_torque, dot=_DOT)],
    )
    return replace(panel, y_range=(-0.04 * top, top))


def _rms_over_ratio(d: Demands) -> Array:
    """``n``: the load falls with it, the rotor and viscous friction grow, Coulomb friction stays."""
    parts, size = d.motor.parts, d.motor.duration
    steps = parts["friction"] - d.load.velocity * (d.train.friction.known.viscous * d.train.ratio)
    turning = parts["rotor"] + parts["friction"] - steps
    functions = [parts["load"], turning, steps]
    gram = np.array([[float(f.inner(g)[0]) / size for g in functions] for f in functions])
    c = np.column_stack([1 / _RATIOS, _RATIOS, np.ones_like(_RATIOS)])
    return np.asarray(np.sqrt(np.maximum(np.einsum("ni,ij,nj->n", c, gram, c), 0.0)))


def arm_front_picture(front: Sequence[ArmChoice]) -> Picture:
    """Mass and cost of each choice for the whole arm vs. the margin that it leaves; unknown ones are left out."""
    panels = []
    for name, label in (("mass", "mass of motors and gearboxes [kg]"), ("cost", "cost of motors and gearboxes")):
        points = np.array([[getattr(choice, name), 100 * choice.margin] for choice in front]).reshape(-1, 2)
        points = points[np.isfinite(points).all(axis=1)]
        marks = [Mark(x=x, y=y, dot=_CHOICE) for x, y in points.tolist()]
        if not marks:
            panels.append(saying(name, f"no {name} is known"))
            continue
        panels.append(chart("still", [], title=name, x_label=label, y_label="least margin [%]", marks=marks))
    return _picture("arm-front", "Choices for the whole arm that no other beats", panels, {"a choice": _CHOICE})


def _picture(name: str, title: str, panels: Sequence[Panel], legend: Mapping[str, Style]) -> Picture:
    entries = tuple(Entry(label, style) for label, style in legend.items())
    return Picture(name=name, title=title, panels=tuple(panels), legend=entries, has_own_colours=True)


def _joints(sizing: Sizing) -> list[tuple[str, Demands]]:
    return list(zip(sizing.cycle.joint_names, sizing.demands, strict=True))


def _size(value: float, largest: float) -> str:
    if np.isinf(value):
        return "unbounded"
    return "0" if value <= NEGLIGIBLE * max(1.0, largest) else f"{value:.3g}"
