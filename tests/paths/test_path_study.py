"""Two hundred random lines and arcs of three arms: held to 1e-9 at 10^5 instants, or refused rightly."""

from __future__ import annotations

import numpy as np
import pytest
from helpers import arms
from helpers.path_search import fits, led

import puma_septic as ps
from puma_septic import paths
from puma_septic.errors import NoSolution
from puma_septic.validation import Array

SAMPLES = 100_000


def random_path(rng: np.random.Generator, robot: ps.Robot, k: int) -> tuple[Array, paths.Path]:
    """A start well within the limits, and a line or an arc of 5 to 30 cm from there, turned by up to 1 rad."""
    low, high = np.nan_to_num(robot.limits.position, nan=0.0).T
    q = low + (high - low) * rng.uniform(0.2, 0.8, robot.n_joints)
    start, axes = ps.forward_kinematics(robot, q), np.linalg.qr(rng.normal(size=(3, 3)))[0]
    away, angle = axes[0] * rng.uniform(0.05, 0.3), rng.uniform(0, 1)
    end = start.copy()
    end[:3, 3] += away
    c, s = np.cos(angle), np.sin(angle)
    end[:3, :3] = start[:3, :3] @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    via = start[:3, 3] + away / 2 + rng.uniform(0.02, 0.1) * axes[1]
    return q, paths.arc(start, via, end) if k % 2 else paths.line(start, end)


def off_path(robot: ps.Robot, way: paths.JointPath) -> float:
    """What the tool is off its pose at most, between the nodes of the series, m or rad."""
    path = way.path
    s = (np.arange(SAMPLES) + 0.5) / SAMPLES * path.length
    return float(np.abs(ps.forward_kinematics(robot, way.position(s)) - path.frames(s)).max())


def can_be_followed(robot: ps.Robot, path: paths.Path, q: Array) -> bool:
    """By small steps, from every posture that inverse kinematics knows at the start; of seven joints from `q`."""
    starts = [q] if robot.n_joints > 6 else ps.inverse_kinematics(robot, path.frames(0.0)).q
    ways = (led(robot, path, start) for start in starts)
    return any(way.reached == 1.0 and fits(robot, way) for way in ways)


@pytest.mark.study
@pytest.mark.parametrize(("arm", "count"), [("puma560", 80), ("ur5", 80), ("panda", 40)])
def test_random_paths_are_held_or_refused_rightly(arm: str, count: int) -> None:
    """No false refusal: where `follow` finds no branch, small steps of Newton's method find none either."""
    robot = ps.load_robot() if arm == "puma560" else getattr(arms, arm)()
    rng, worst, solved, refused, false = np.random.default_rng(16), 0.0, 0, 0, []
    for k in range(count):
        q, path = random_path(rng, robot, k)
        try:
            way = paths.follow(robot, path, start=q) if robot.n_joints > 6 else paths.follow(robot, path)
        except NoSolution as error:
            refused += 1
            if can_be_followed(robot, path, q):
                false.append((k, str(error)))
            continue
        solved += 1
        worst = max(worst, off_path(robot, way))
    assert worst < 1e-9
    assert false == []
    assert solved >= count / 4, f"{solved} solved, {refused} refused"
