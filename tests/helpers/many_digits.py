"""Fifty digits: joint positions on a path and their derivatives by time, by Newton's method and differences."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np

import puma_septic as ps
from puma_septic.kinematics import chain_to
from puma_septic.validation import Array

# A difference over 1e-12 s leaves 50 - 3 * 12 = 14 digits of the third derivative, its error is of the order 1e-24.
_DIGITS, _STEP = 60, mp.mpf(10) ** -12


def derivatives(
    robot: ps.Robot, start: Array, direction: Array, law: Callable[[Any], Any], t: float, q: Array
) -> Array:
    """q, v, a and jerk, (4, n_joints), where the tool moves from the pose `start` along `direction` without turning."""
    with mp.workdps(_DIGITS):
        inverse = mp.matrix(np.linalg.inv(ps.jacobian(robot, q)).tolist())

        def position(instant: Any) -> Any:
            target = [mp.mpf(p) + law(instant) * mp.mpf(d) for p, d in zip(start[:3, 3], direction, strict=True)]
            return _solved(robot, inverse, start[:3, :3], target, q)

        here, h = mp.mpf(t), _STEP
        back2, back, middle, on, on2 = (position(here + k * h) for k in (-2, -1, 0, 1, 2))
        rows = (middle, (on - back) / (2 * h), (on - 2 * middle + back) / h**2,
                (on2 - 2 * on + 2 * back - back2) / (2 * h**3))  # fmt: skip
        return np.array([[float(x) for x in row] for row in rows])


def _solved(robot: ps.Robot, inverse: Any, rotation: Array, target: list[Any], q: Array) -> Any:
    """Newton with the Jacobian of sixteen digits: each step gains about ten."""
    values = mp.matrix([mp.mpf(x) for x in q])
    turn = mp.matrix(rotation.tolist())
    for _ in range(12):
        pose = _forward(robot, values)
        off = turn * pose[:3, :3].T
        error = mp.matrix(
            [target[k] - pose[k, 3] for k in range(3)]
            + [(off[2, 1] - off[1, 2]) / 2, (off[0, 2] - off[2, 0]) / 2, (off[1, 0] - off[0, 1]) / 2]
        )
        values += inverse * error
    return values


def _forward(robot: ps.Robot, q: Any) -> Any:
    chain = chain_to(robot)
    pose = mp.eye(4)
    for placement, column in zip(chain.placements, chain.columns, strict=True):
        c, s = mp.cos(q[int(column)]), mp.sin(q[int(column)])
        pose = (
            pose * mp.matrix(placement.tolist()) * mp.matrix([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        )
    return pose * mp.matrix(chain.end.tolist())
