"""The paper's move on the PUMA, with and without a payload: what duty cycles in tests are made of."""

from __future__ import annotations

from functools import cache

import numpy as np

import puma_septic as ps

# Table 1 and times of Raji, Asaolu, Akano, rad and s.
POINTS = np.array(
    [
        [2.57, -0.7873, -1.2022, -3.1416, -1.9895, 0.5716],
        [2.57, -0.1026, -0.5, -3.1416, -0.6026, 0.5716],
        [-0.5716, -0.1026, -0.5, -3.1416, -0.6026, -2.57],
        [-0.5716, -0.7873, -1.2022, -3.1416, -1.9895, -2.57],
    ]
)
TIMES = np.array([0.0, 2.0, 6.0, 9.0])
LOAD = ps.Payload(mass=2.5, com=(0.0, 0.0, 0.1))


@cache
def paper_motion(*, loaded: bool = False) -> ps.Motion:
    robot = ps.load_robot()
    return ps.compute_motion(robot.with_payload(LOAD) if loaded else robot, ps.septic(POINTS, TIMES))
