"""Simulated executions: errors over time, the spectrum of what a motion leaves behind, and tables of stops."""

from __future__ import annotations

from typing import Final

import numpy as np

from puma_septic.pictures._elements import Bar, Curve, Entry, Panel, Picture, Rule, bars, chart
from puma_septic.pictures._styles import PROFILES, Fill, profile_line
from puma_septic.simulation import SETTLED, Execution, Simulation, StopTable
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array
from puma_septic.vibration import residual_vibration

__all__ = ["execution_pictures", "spectrum_picture", "stops_picture", "tracking_picture"]

# Points of a drawn curve.
_POINTS: Final = 800
# Frequencies of a spectrum, from a fraction of the motion's own to what no arm's structure reaches, Hz.
_LOWEST, _HIGHEST = 0.2, 40.0
_FREQUENCIES: Final = 400
# Deflections below this, of the largest, are off the picture.
_DEEPEST: Final = 1e-7


def execution_pictures(execution: Execution) -> tuple[Picture, ...]:
    """Tool and joint errors over time, and the vibration that the planned motions leave in a joint's spring."""
    moves = {name: one.trajectory for name, one in execution.simulations.items()}
    return (tracking_picture(execution), spectrum_picture(moves))


def tracking_picture(execution: Execution) -> Picture:
    """Errors of the tool and of all joints over time.

    Returns
    -------
    Picture
    """
    simulations = {name: one for name, one in execution.simulations.items() if len(one.t) > 1}
    unit = "rad, m" if execution.robot.is_prismatic.any() else "rad"
    tool = [_curve(k, name, one, 1e3 * one.tool_error) for k, (name, one) in enumerate(simulations.items())]
    panels = [
        chart("still", tool, title="tool", y_label="error [mm]", levels=[Rule(at=1e3 * SETTLED)]),
        *(
            chart(
                "still",
                [_curve(k, name, one, one.error[:, j]) for k, (name, one) in enumerate(simulations.items())],
                title=joint,
                y_label=f"error [{unit}]",
            )
            for j, joint in enumerate(execution.robot.joint_names)
        ),
    ]
    return Picture(
        name="tracking",
        title="Tracking error of the simulated arm",
        panels=tuple(panels),
        columns=4,
        legend=tuple(Entry(name, profile_line(k)) for k, name in enumerate(simulations)),
        footnote="Samples of a simulation. Dashed: 0.1 mm, within which the arm has settled.",
    )


def _curve(k: int, name: str, simulation: Simulation, values: Array) -> Curve:
    some = np.unique(np.linspace(0, len(values) - 1, min(len(values), _POINTS)).astype(int))
    return Curve(x=simulation.t[some], y=values[some], line=profile_line(k), label=name)


def spectrum_picture(trajectories: dict[str, Trajectory]) -> Picture:
    """Amplitude that each motion leaves in a spring-mass on the joint that it excites most, by natural frequency.

    Returns
    -------
    Picture
    """
    frequencies = np.geomspace(_LOWEST, _HIGHEST, _FREQUENCIES)
    spectra = {name: residual_vibration(one, frequencies).max(axis=1) for name, one in trajectories.items()}
    floor = _DEEPEST * max(float(values.max()) for values in spectra.values())
    curves = [
        Curve(x=np.log10(frequencies), y=np.log10(np.maximum(values, floor)), line=profile_line(k), label=name)
        for k, (name, values) in enumerate(spectra.items())
    ]
    panel = chart(
        "still",
        curves,
        title="largest of the joints",
        x_label="log10 of the natural frequency [Hz]",
        y_label="log10 of the amplitude [rad]",
    )
    return Picture(
        name="spectrum",
        title="Residual vibration of an undamped spring-mass",
        panels=(panel,),
        columns=1,
        legend=tuple(Entry(name, profile_line(k)) for k, name in enumerate(spectra)),
        footnote="Exact, from the planned acceleration; nulls are drawn as deep as the grid of frequencies meets them.",
    )


def stops_picture(table: StopTable) -> Picture:
    """The stopping angle of each joint by speed, a panel for each joint and load, a colour for each extension.

    Returns
    -------
    Picture
    """
    extensions = sorted({row.extension for row in table.rows})
    fills = {value: Fill(hue=PROFILES[k % len(PROFILES)]) for k, value in enumerate(extensions)}
    loads = sorted({row.load for row in table.rows})
    panels = [_stops_panel(table, joint, load, fills) for joint in table.joints for load in loads]
    return Picture(
        name="stops",
        title=f"Stops of category {table.category}: angle from the command to rest",
        panels=tuple(panels),
        columns=len(loads),
        legend=tuple(Entry(f"{100 * value:z.0f} % of the reach", fill) for value, fill in fills.items()),
        footnote="A prediction from a model, not a safety function.",
        has_own_colours=True,
    )


def _stops_panel(table: StopTable, joint: str, load: float, fills: dict[float, Fill]) -> Panel:
    rows = [row for row in table.rows if row.joint == joint and row.load == load]
    speeds = sorted({row.speed for row in rows})
    of_joint = [row.angle for row in table.rows if row.joint == joint and np.isfinite(row.angle)]
    end = 1.25 * max(of_joint, default=1.0)
    return bars(
        f"{joint}, {100 * load:z.0f} % of {table.full_load:g} kg",
        "angle [rad]",
        rows=[f"{100 * speed:z.0f} % speed" for speed in speeds],
        bars=[
            Bar(
                row=speeds.index(row.speed),
                slot=list(fills).index(row.extension),
                length=row.angle,
                fill=fills[row.extension],
                text="none" if np.isnan(row.angle) else "not held" if np.isinf(row.angle) else f"{row.angle:z.3f}",
            )
            for row in rows
        ],
        end=max(end, 1e-9),
    )
