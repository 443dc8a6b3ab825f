"""A step of one joint's velocity strikes every joint that is coupled to it, however weakly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.arms import joint, link, load

import puma_septic as ps
from puma_septic.dynamics import mass_matrix


@pytest.mark.parametrize(("product", "is_struck"), [(1e-5, True), (1e-9, True), (0.0, False)])
def test_a_weakly_coupled_joint_is_struck(product: float, is_struck: bool, tmp_path: Path) -> None:
    """Axes z and x through the body's centre, coupled by its product of inertia alone: 7e-4 of the geometric mean.

    A threshold of 1e-2 for what is coupled would have left the first joint's torque finite.
    """
    body = np.diag([0.02, 0.02, 0.01])
    body[0, 2] = body[2, 0] = product
    text = (
        '  <link name="base"/>\n'
        + link("l1", 1.0, [0.0, 0.0, 0.0], np.zeros((3, 3)))
        + link("l2", 2.0, [0.0, 0.0, 0.0], body)
        + joint("a", "revolute", "base", "l1", [0, 0, 0.3], [0, 0, 1])
        + joint("b", "revolute", "l1", "l2", [0, 0, 0], [1, 0, 0])
    )
    robot = load(tmp_path, "cross", text)
    matrix = mass_matrix(robot, np.zeros((1, 2)))[0]
    assert abs(matrix[0, 1]) == pytest.approx(product, abs=1e-18)
    move = ps.profiles.linear([[0.0, 0.0], [0.0, 0.5]], [0.0, 1.0])
    peaks = ps.assess(robot, move).peak_torque
    assert peaks[1] == np.inf
    assert bool(np.isinf(peaks[0])) is is_struck
