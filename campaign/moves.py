"""What the inputs are tried on: the PUMA, one move and its cycle, made once in each process."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Final

import puma_septic as ps

ROOT: Final = Path(__file__).parents[1]
POINTS: Final = ((0.0, 0.6, -2.2, 0.0, 0.3, 0.0), (1.0, 1.2, -2.6, 0.2, 0.6, 0.1))


@cache
def puma() -> ps.Robot:
    return ps.load_robot()


@cache
def move() -> ps.Trajectory:
    """Two seconds between two points, at rest at both."""
    return ps.quintic_segments(POINTS, [0.0, 2.0], joint_names=puma().joint_names)


@cache
def cycle() -> ps.Cycle:
    """There and back, with a rest of half a second."""
    return ps.cycle.with_return(ps.compute_motion(puma(), move()), dwell=0.5)
