"""Random moves of every profile family: short and long, joints at rest, dwells, vias that reverse and that do not."""

from __future__ import annotations

import numpy as np

import puma_septic as ps
from puma_septic import profiles
from puma_septic.validation import Array

FAMILIES = tuple(info.name for info in profiles.available())
# The arm bent, well inside its position limits.
MIDDLE = np.array([0.0, 0.8, -2.2, 0.0, 0.4, 0.0])
_EXACTLY = {"septic": 4, "poly_434": 4, "poly_353": 4}
# These are for few points: a polynomial of high degree swings between many.
_AT_MOST = {"single_polynomial": 5, "bezier": 7}


def random_move(family: str, rng: np.random.Generator) -> ps.Trajectory:
    """One move of the PUMA 560 by a profile of this name."""
    points = random_points(rng, _EXACTLY.get(family) or int(rng.integers(3, _AT_MOST.get(family, 6) + 1)))
    # 20 ms to 20 s; neighbouring durations within a factor of 4.
    scale = 10 ** rng.uniform(-1.2, 1.0)
    return make(family, points, scale * rng.uniform(0.5, 2.0, len(points) - 1), rng)


def random_points(rng: np.random.Generator, count: int) -> Array:
    """All joints or one, towards one side or to and fro; some joints rest always, some between two points."""
    size = 10 ** rng.uniform(-2.0, 0.0)
    steps = rng.uniform(0.1, 1.0, (count - 1, 6)) * size
    if rng.random() < 0.5:
        steps *= rng.choice([-1, 1], steps.shape)
    else:
        steps *= rng.choice([-1, 1], 6)
    if rng.random() < 0.3:
        steps[:, np.arange(6) != rng.integers(6)] = 0.0
    steps[:, rng.random(6) < 0.15] = 0.0
    if rng.random() < 0.4:
        steps[rng.integers(count - 1)] = 0.0
    steps[rng.random(steps.shape) < 0.1] = 0.0
    points = MIDDLE + np.concatenate([np.zeros((1, 6)), np.cumsum(steps, axis=0)])
    return points.round(2) if rng.random() < 0.3 else points


def make(family: str, points: Array, durations: Array, rng: np.random.Generator) -> ps.Trajectory:
    """A profile that needs more than points and times gets it at random."""
    times = np.concatenate([[0.0], np.cumsum(durations)])
    blend = float(rng.uniform(0.1, 0.5) * durations.min())
    if family == "double_s":
        # Limits, not times: two equal points have no duration.
        points = points[np.append(True, np.diff(points, axis=0).any(axis=1))]
        if len(points) < 2:
            points = np.array([MIDDLE, MIDDLE + 0.1])
        v, a, j = rng.uniform(0.3, 3), rng.uniform(1, 20), 10 ** rng.uniform(1, 6)
        return profiles.double_s(points, max_velocity=v, max_acceleration=a, max_jerk=j)
    if family == "lspb":
        return profiles.lspb(points, durations=durations, blend_time=blend)
    if family in ("trapezoidal", "polynomial_blends"):
        return getattr(profiles, family)(points, times, blend_time=blend)  # type: ignore[no-any-return]
    return getattr(profiles, family)(points, times)  # type: ignore[no-any-return]
