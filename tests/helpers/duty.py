"""The paper's move on the PUMA, with and without a payload: what duty cycles in tests are made of."""

from __future__ import annotations

from functools import cache

import puma_septic as ps
from helpers.moves import paper_move

LOAD = ps.Payload(mass=2.5, com=(0.0, 0.0, 0.1))


@cache
def paper_motion(*, loaded: bool = False) -> ps.Motion:
    robot = ps.load_robot()
    return ps.compute_motion(robot.with_payload(LOAD) if loaded else robot, paper_move())
