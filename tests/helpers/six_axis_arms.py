"""Six-axis arms as URDF files, from published Denavit-Hartenberg tables, in m and rad."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import puma_septic as ps
from helpers.arms import joint, link, load

QUARTER = np.pi / 2
# Standard Denavit-Hartenberg rows (a, alpha, d).
# UR10e: Universal Robots, "Parameters for calculations of kinematics and dynamics" (article 45257).
UR10E = [
    (0, QUARTER, 0.1807),
    (-0.6127, 0, 0),
    (-0.57155, 0, 0),
    (0, QUARTER, 0.17415),
    (0, -QUARTER, 0.11985),
    (0, 0, 0.11655),
]
# KUKA KR 5 arc, its lengths as ROS-Industrial's kuka_kr5_support has them (kr5_arc_macro.xacro): 400, 180, 600, 120,
# 620 and 115 mm; axis 1 misses 2.
KR5 = [
    (0.18, QUARTER, 0.4),
    (0.6, 0, 0),
    (0.12, -QUARTER, 0),
    (0, QUARTER, 0.62),
    (0, -QUARTER, 0),
    (0, 0, 0.115),
]
# Modified (Craig's) rows (alpha before, a before, d).
# Staubli TX60, its lengths as ROS-Industrial's staubli_tx60_support has them (tx60_macro.xacro): 375, 290, 310 and 70
# mm, upper arm and forearm 20 mm apart.
TX60 = [
    (0, 0, 0.375),
    (-QUARTER, 0, 0.02),
    (0, 0.29, 0),
    (-QUARTER, 0, 0.31),
    (QUARTER, 0, 0),
    (-QUARTER, 0, 0.07),
]
# ABB IRB 1200-5/0.9, its lengths as ROS-Industrial's abb_irb1200_support has them (irb1200_5_90_macro.xacro): 399.1,
# 448, 42, 451 and 82 mm; axes 1 and 2 meet, the elbow is offset.
IRB1200 = [
    (0, 0, 0.3991),
    (QUARTER, 0, 0),
    (0, 0.448, 0),
    (-QUARTER, 0.042, 0.451),
    (QUARTER, 0, 0),
    (QUARTER, 0, 0.082),
]
# Doosan M1013 as its vendor's URDF has it (dsr_description2), joint origins xyz and rpy: right angles of 1.571 rad, so
# that the wrist's axes miss one point by 0.02 mm.
M1013 = [
    ((0, 0, 0.1525), (0, 0, 0)),
    ((0, 0.0345, 0), (0, -1.571, -1.571)),
    ((0.62, 0, 0), (0, 0, 1.571)),
    ((0, -0.559, 0), (1.571, 0, 0)),
    ((0, 0, 0), (-1.571, 0, 0)),
    ((0, -0.121, 0), (1.571, 0, 0)),
]


def standard(rows: list[tuple[float, float, float]]) -> list[tuple[list[float], list[float]]]:
    """Joint origins, the tool's last: a row stands behind its joint."""
    return [([0, 0, 0], [0, 0, 0]), *(([a, 0, d], [alpha, 0, 0]) for a, alpha, d in rows)]


def modified(rows: list[tuple[float, float, float]]) -> list[tuple[list[float], list[float]]]:
    """Joint origins, the tool's last: a row stands before its joint."""
    places = [([a, -np.sin(alpha) * d, np.cos(alpha) * d], [alpha, 0, 0]) for alpha, a, d in rows]
    return [*places, ([0, 0, 0], [0, 0, 0])]


def as_given(rows: list[tuple[tuple[float, ...], tuple[float, ...]]]) -> list[tuple[list[float], list[float]]]:
    return [*((list(xyz), list(rpy)) for xyz, rpy in rows), ([0, 0, 0], [0, 0, 0])]


ARMS = {
    "ur10e": standard(UR10E),
    "kr5": standard(KR5),
    "tx60": modified(TX60),
    "irb1200": modified(IRB1200),
    "m1013": as_given(M1013),
}


def arm(
    folder: Path,
    name: str,
    places: list[tuple[list[float], list[float]]] | None = None,
    *,
    signs: tuple[int, ...] = (1,) * 6,
    turn: float = 4.0,
) -> ps.Robot:
    """Load an arm of these joint origins, the tool's last; every link weighs 1 kg, axes are z or against it."""
    places = ARMS[name] if places is None else places
    count = len(places) - 1
    links = "".join(link(f"l{k}", 1.0, [0, 0, 0], 0.01 * np.eye(3)) for k in range(1, count + 1))
    body, parent = f'<link name="base"/>{links}<link name="tool"/>', "base"
    for k, ((xyz, rpy), sign) in enumerate(zip(places[:count], signs[:count], strict=True), start=1):
        body += joint(f"j{k}", "revolute", parent, f"l{k}", xyz, [0.0, 0.0, float(sign)], rpy)
        parent = f"l{k}"
    xyz, rpy = places[count]
    body += joint("mount", "fixed", parent, "tool", xyz, [0.0, 0.0, 1.0], rpy)
    limits = np.tile([-turn, turn], (count, 1))
    return load(folder, name, body, tool="tool").with_limits(position=limits)
