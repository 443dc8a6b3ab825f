"""What gears lose by a map of their efficiency over speed and load, exactly between its points.

The map is turned into the loss at the input, ``tau/n (1/eta - 1)``, which is close to a straight line of the load.
There it is interpolated, and the line through the two lowest torques goes on to load 0, where it is the no-load torque.
The same torque is lost whichever side drives (as an efficiency of ``2 - 1/eta`` backwards).
"""

from __future__ import annotations

import numpy as np

from puma_septic.drives import Gearbox
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array

__all__ = ["gear_loss"]


def gear_loss(gearbox: Gearbox, torque: Piecewise, speed: Piecewise, direction: Array) -> Piecewise:
    """Torque at the input against the motion, N m, by the gearbox's efficiency map; signed as the motion.

    Beyond the map's largest torque its last lines go on; beyond its speeds the nearest one holds.

    Parameters
    ----------
    gearbox : Gearbox
    torque : Piecewise
        At the output, N m, of one sign on each interval.
    speed : Piecewise
        At the input, rad/s, on the same intervals.
    direction : ndarray, shape (n_intervals,)
        Sign of the motion on each, 0 at rest.

    Returns
    -------
    Piecewise
    """
    speeds, torques, losses = _grid(gearbox)
    load, pace = torque.by_interval(torque.signs()[:, 0]), speed.by_interval(direction)
    split = load.split(np.concatenate([*_crossings(load, torques[1:-1]), *_crossings(pace, speeds)]))
    load, pace = split, pace.aligned_with(split)
    way = direction[np.searchsorted(torque.breaks[1:-1], split.middles)]
    flat, by_load, by_pace, by_both = _cells(load, pace, speeds, torques, losses)
    loss = load.stepwise(flat[:, None]) + load.by_interval(by_load) + pace.by_interval(by_pace)
    return (loss + (load * pace).by_interval(by_both)).by_interval(way)


def _grid(gearbox: Gearbox) -> tuple[Array, Array, Array]:
    """Speeds, torques from 0, and the loss at each, shape (n_speeds, n_torques)."""
    rows = gearbox.efficiency_map
    speeds, torques = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    efficiency = rows[:, 2].reshape(len(speeds), len(torques))
    losses = torques / abs(gearbox.ratio) * (1 / efficiency - 1)
    slope = (losses[:, 1] - losses[:, 0]) / (torques[1] - torques[0])
    idle = np.maximum(losses[:, 0] - slope * torques[0], 0.0)
    return speeds, np.concatenate([[0.0], torques]), np.column_stack([idle, losses])


def _crossings(f: Piecewise, values: Array) -> list[Array]:
    """When a function passes each of the values."""
    levels = (Piecewise.constant([value], f.duration, start=f.start) for value in values.tolist())
    return [(f - level).roots()[0] for level in levels]


def _cells(
    load: Piecewise, pace: Piecewise, speeds: Array, torques: Array, losses: Array
) -> tuple[Array, Array, Array, Array]:
    """``a, b, c, d`` of ``a + b load + c pace + d load pace`` on each interval, bilinear in its cell of the grid."""
    at_load, at_pace = load(load.middles)[:, 0], pace(pace.middles)[:, 0]
    j = np.clip(np.searchsorted(torques, at_load, side="right") - 1, 0, len(torques) - 2)
    steps = np.diff(losses, axis=1) / np.diff(torques)
    # Along the torque, at each speed: value at load 0 of the cell's line, and its slope.
    slope, start = steps[:, j], losses[:, j] - steps[:, j] * torques[j]
    i = np.searchsorted(speeds, at_pace, side="right") - 1
    below, above = np.clip(i, 0, len(speeds) - 1), np.clip(i + 1, 0, len(speeds) - 1)
    k = np.arange(len(at_load))
    width = np.where(above > below, speeds[above] - speeds[below], 1.0)
    by_pace, by_both = (start[above, k] - start[below, k]) / width, (slope[above, k] - slope[below, k]) / width
    flat, by_load = start[below, k] - by_pace * speeds[below], slope[below, k] - by_both * speeds[below]
    return flat, by_load, by_pace, by_both
