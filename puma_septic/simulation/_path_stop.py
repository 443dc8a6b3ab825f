"""Controlled stops (category 1): along the path, as fast as the torque limits allow.

On a path ``q(s)`` with the speed ``r = ds/dt``, which is 1 as planned, each torque is linear in ``dr/dt``:
``tau = A dr/dt + B`` with ``A = M q'`` and B the torque of ``q' r`` and ``q'' r^2``. The hardest deceleration that all
limits allow, from the state at the stop's command on, gives the lowest speed at every place of the path, and so the
shortest stop. It is marched from r = 1 to 0 by equal drops of the speed, over each of which the deceleration is
constant and no harder than allowed at both of its ends.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from puma_septic.dynamics import rigid_torque
from puma_septic.friction import friction_terms
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["DROPS", "Path", "Slowing", "path_of", "slow_down", "stopping_trajectory"]

DROPS: Final = 128
"""Into how many drops of the speed a stop is divided."""

Path = Callable[[Array], tuple[Array, Array, Array]]
"""Position, and first and second derivative by s, of rows at their own s (n_rows,): (n_rows, n_joints) each."""

# No stop is taken to last less than this, s: where the arm hardly moves, any deceleration is allowed.
_LEAST: Final = 1e-4
# An inertia along the path below this part of the largest is rounding.
_NO_INERTIA: Final = 1e-12


class Slowing(NamedTuple):
    """Stops of several rows: s at the ends of the drops (DROPS + 1, n_rows), how long each takes (DROPS, n_rows).

    ``is_possible`` (n_rows,) says whether the limits allow it all the way.
    """

    s: Array
    lengths: Array
    is_possible: NDArray[np.bool_]


def path_of(trajectory: Trajectory) -> Path:
    """A planned motion as a path, its time as s; it stays where it ends."""
    n, duration = trajectory.n_joints, trajectory.duration

    def at(s: Array) -> tuple[Array, Array, Array]:
        values = trajectory.state.at_offsets(np.clip(s - trajectory.breaks[0], 0.0, duration))
        return values[:, :n], values[:, n : 2 * n], values[:, 2 * n : 3 * n]

    return at


def slow_down(robot: Robot, path: Path, start: Array, limits: Array) -> Slowing:
    """March all rows, which start at s (n_rows,), from r = 1 to rest."""
    levels = np.linspace(1.0, 0.0, DROPS + 1)
    s, lengths = np.empty((DROPS + 1, len(start))), np.empty((DROPS, len(start)))
    s[0] = start
    possible = np.ones(len(start), dtype=bool)
    bound, fits = _hardest(robot, path, s[0], 1.0, limits)
    for k in range(DROPS):
        drop, mean = levels[k] - levels[k + 1], (levels[k] + levels[k + 1]) / 2
        rate = bound
        fits_ahead = fits
        for _ in range(2):
            step = drop / -np.minimum(rate, -_LEAST)
            ahead, fits_ahead = _hardest(robot, path, s[k] + mean * step, float(levels[k + 1]), limits)
            rate = np.maximum(bound, ahead)
        possible &= (rate < 0) & fits & fits_ahead
        lengths[k] = drop / -np.minimum(rate, -_LEAST)
        s[k + 1] = s[k] + mean * lengths[k]
        bound, fits = ahead, fits_ahead
    return Slowing(s, lengths, possible)


def _hardest(robot: Robot, path: Path, s: Array, r: float, limits: Array) -> tuple[Array, NDArray[np.bool_]]:
    """The most negative ``dr/dt`` that all torque limits allow, and whether any value of it keeps them, (n_rows,)."""
    q, first, second = path(s)
    v = first * r
    rest = np.zeros_like(q)
    stacked = np.concatenate([q, q, q]), np.concatenate([v, rest, rest]), np.concatenate([second * r**2, first, rest])
    moving, weighed, weight = np.split(rigid_torque(robot, *stacked), 3)
    inertia = weighed - weight
    terms = friction_terms(robot.friction, v, np.sign(first))
    load = moving + terms["viscous"] + terms["coulomb"]
    is_moved = np.abs(inertia) > _NO_INERTIA * np.abs(inertia).max(axis=1, keepdims=True, initial=0.0)
    divisor = np.where(is_moved, inertia, 1.0)
    ends = np.stack([(-limits - load) / divisor, (limits - load) / divisor])
    low = np.where(is_moved, ends.min(axis=0), -np.inf).max(axis=1)
    high = np.where(is_moved, ends.max(axis=0), np.inf).min(axis=1)
    fits = (low <= high) & (is_moved | (np.abs(load) <= limits)).all(axis=1)
    return np.maximum(low, -1 / _LEAST), fits


def stopping_trajectory(trajectory: Trajectory, slowing: Slowing, row: int, start: float) -> Trajectory:
    """The motion from the beginning of the stop to rest, on its own clock from 0: ``q(s(t))``."""
    lengths, s = slowing.lengths[:, row], slowing.s[:, row]
    levels = np.linspace(1.0, 0.0, DROPS + 1)
    times = np.concatenate([[0.0], np.cumsum(lengths)])
    powers = np.stack([s[:-1], levels[:-1] * lengths, np.diff(levels) * lengths / 2])[..., None]
    clock = Piecewise.from_power(times, powers)
    inside = [value for value in trajectory.breaks if s[0] < value < s[-1]]
    clock = clock.split(np.concatenate([(clock + -value).roots()[0] for value in inside]) if inside else [])
    first, last = trajectory.breaks[[0, -1]]
    position = clock.mapped(lambda values: trajectory.position(np.clip(values[:, 0], first, last)), tolerance=1e-14)
    left, right = position.ends()
    return Trajectory(
        position=position,
        points=np.array([left[0], right[-1]]),
        times=position.breaks[[0, -1]],
        profile=f"stop of {trajectory.profile} at {start:.4g} s",
        joint_names=trajectory.joint_names,
        rest_before=False,
    )
