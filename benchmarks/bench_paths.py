"""A straight line of the PUMA 560's tool, made and assessed, against the Robotics Toolbox at 1 kHz."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from time import perf_counter

import numpy as np

import puma_septic as ps

ROUNDS = 10
DURATION = 1.0
START = (0, 0.5, -2.5, 0, 0.7, 0)


def run() -> list[tuple[str, ...]]:
    """Time both in turn, round by round, so that a busy machine slows both alike."""
    contenders: dict[str, Callable[[], object]] = {"puma_septic: tool_move, assess": exact()}
    if find_spec("roboticstoolbox") is not None:
        contenders["Robotics Toolbox: ctraj, ikine_a, rne at 1 kHz"] = sampled()
    for contender in contenders.values():
        contender()
    seconds: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(ROUNDS):
        for name, contender in contenders.items():
            start = perf_counter()
            contender()
            seconds[name].append(perf_counter() - start)
    first = next(iter(contenders))
    rows = [("one line, made and assessed", "median", "best", "times slower")]
    for name, values in seconds.items():
        slower = np.median(np.array(values) / seconds[first])
        rows.append((name, f"{1e3 * np.median(values):.1f} ms", f"{1e3 * min(values):.1f} ms", f"{slower:.1f}"))
    if len(contenders) == 1:
        rows.append(("the Robotics Toolbox is not installed (extra: bench)", "", "", ""))
    return rows


def exact() -> Callable[[], object]:
    """Followed on its branch, with peaks and torque."""
    robot = ps.load_robot()
    pose = ps.forward_kinematics(robot, START)

    def made() -> object:
        path = ps.paths.line(pose, pose[:3, 3] + [0, 0.2, 0.1])
        move = ps.tool_move(robot, path, ps.paths.in_time(path, DURATION), branch="right-up-noflip")
        return ps.assess(robot, move).peak_torque

    return made


def sampled() -> Callable[[], object]:
    """Interpolated, solved and differenced at 1 kHz, as its manual shows."""
    import roboticstoolbox as rtb
    from spatialmath import SE3

    arm = rtb.models.DH.Puma560()
    start = arm.fkine(arm.qn)
    end = SE3(0, 0.2, 0.1) * start
    n = int(1000 * DURATION) + 1

    def made() -> object:
        poses = rtb.ctraj(start, end, n)
        q = np.array([arm.ikine_a(pose, "run").q for pose in poses])
        v = np.gradient(q, 1e-3, axis=0)
        return np.abs(arm.rne(q, v, np.gradient(v, 1e-3, axis=0))).max(axis=0)

    return made
