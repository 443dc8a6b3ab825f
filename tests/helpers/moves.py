"""The paper's move by several profiles, and other moves of any arm."""

from __future__ import annotations

from functools import cache

import numpy as np

import puma_septic as ps
from puma_septic.paper import PAPER
from puma_septic.validation import Array

# Table 1 and times of Raji, Asaolu, Akano, rad and s; tests/paper holds them against print.
POINTS, TIMES = PAPER.table_1, PAPER.times
PROFILES = ("septic", "lspb", "quintic_segments")


@cache
def paper_move(profile: str = "septic") -> ps.Trajectory:
    """The paper's move by one of PROFILES."""
    if profile == "septic":
        return ps.septic(POINTS, TIMES)
    if profile == "lspb":
        return ps.lspb(POINTS, durations=np.diff(TIMES), blend_time=1.0)
    return ps.quintic_segments(POINTS, TIMES)


def random_move(rng: np.random.Generator, n_joints: int) -> ps.Trajectory:
    """From rest to rest through two vias, by one of three profiles."""
    points = rng.uniform(-1.5, 1.5, (4, n_joints))
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 3, 3))])
    kind = rng.integers(3)
    if kind == 0:
        return ps.septic(points, times)
    if kind == 1:
        return ps.lspb(points, durations=np.diff(times), blend_time=float(rng.uniform(0.1, 0.5)))
    velocities = rng.uniform(-1, 1, points.shape)
    velocities[[0, -1]] = 0.0
    return ps.quintic_segments(points, times, velocities=velocities)


def parabolic_blends(times: Array, points: Array, tb: float) -> ps.Trajectory:
    """Straight line with parabolic blends from rest to rest: the acceleration steps four times."""
    h, end = points[1] - points[0], times[1]
    speed = h / (end - tb)
    s = np.zeros((3, 3, len(h)))
    s[0] = [points[0], points[0] + speed * tb / 2, points[1] - speed * tb / 2]
    s[1] = [0 * h, speed * (end - 2 * tb), speed * tb]
    s[2] = [speed * tb / 2, 0 * h, -speed * tb / 2]
    position = ps.Piecewise.from_power([0.0, tb, end - tb, end], s)
    return ps.Trajectory(position=position, points=points, times=times)
