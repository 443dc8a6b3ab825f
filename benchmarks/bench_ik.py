"""Inverse kinematics of the PUMA 560: 1,000 poses, all eight branches, against EAIK called in a loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.util import find_spec
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

import puma_septic as ps

Array = NDArray[np.float64]

POSES = 1000
ROUNDS = 40


def run() -> list[tuple[str, ...]]:
    """Time both in turn, round by round, so that a busy machine slows both alike."""
    poses = reachable_poses()
    contenders: dict[str, Callable[[], Sequence[Array] | Array]] = {"puma_septic: one call": in_one_call(poses)}
    if find_spec("eaik") is not None:
        contenders["EAIK 1.2 in a loop"] = eaik_in_a_loop(poses)
    answers = {name: contender() for name, contender in contenders.items()}
    seconds: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(ROUNDS):
        for name, contender in contenders.items():
            start = perf_counter()
            contender()
            seconds[name].append(perf_counter() - start)
    first = next(iter(contenders))
    rows = [(f"{POSES} poses, 8 branches", "median", "best", "times slower", "worst pose error")]
    for name, values in seconds.items():
        slower = np.median(np.array(values) / seconds[first])
        error = f"{worst_error(poses, np.array(answers[name])):.1e}"
        rows.append((name, _per_pose(np.median(values)), _per_pose(min(values)), f"{slower:.2f}", error))
    if "EAIK 1.2 in a loop" not in contenders:
        rows.append(("EAIK is not installed (extra: bench)", "", "", "", ""))
    return rows


def reachable_poses() -> Array:
    """Poses of random configurations within the joint limits."""
    robot = ps.load_robot(tool="wrist_center")
    low, high = robot.limits.position.T
    return ps.forward_kinematics(robot, np.random.default_rng(560).uniform(low, high, (POSES, 6)))


def in_one_call(poses: Array) -> Callable[[], Array]:
    """Solved, wrapped to the joint limits and verified."""
    robot = ps.load_robot(tool="wrist_center")
    return lambda: ps.inverse_kinematics_batch(robot, poses).q


def eaik_in_a_loop(poses: Array) -> Callable[[], Sequence[Array]]:
    """Solved alone."""
    from eaik.IK_DH import DhRobot

    # Standard Denavit-Hartenberg parameters: roboticstoolbox-python 1.4.4, models/DH/Puma560.py
    quarter = np.pi / 2
    alpha = np.array([quarter, 0.0, -quarter, quarter, -quarter, 0.0])
    a = np.array([0.0, 0.4318, 0.0203, 0.0, 0.0, 0.0])
    d = np.array([0.67183, 0.0, 0.15005, 0.4318, 0.0, 0.0])
    robot = DhRobot(alpha, a, d)
    matrices = list(poses)
    return lambda: [robot.IK(pose).Q for pose in matrices]


def worst_error(poses: Array, q: Array) -> float:
    """Largest entry of the difference between the poses reached and the poses asked for."""
    robot = ps.load_robot(tool="wrist_center")
    reached = ps.forward_kinematics(robot, q.reshape(-1, 6)).reshape(*q.shape[:2], 4, 4)
    return float(np.abs(reached - poses[:, None]).max())


def _per_pose(seconds: float) -> str:
    return f"{seconds / POSES * 1e6:.2f} us/pose"


if __name__ == "__main__":
    for row in run():
        print("  ".join(f"{cell:24}" for cell in row))
