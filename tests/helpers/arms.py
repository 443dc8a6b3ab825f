"""Arms for tests: a simple pendulum, branched trees, some with drives, and arms of example-robot-data."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

import puma_septic as ps
from helpers.places import KINOVA, PANDA, UR5
from puma_septic.validation import Array

# Written out in full: repr of a float is exact.
LINK = """  <link name="{name}"><inertial><origin xyz="{com}"/><mass value="{mass!r}"/>
    <inertia ixx="{i[0]!r}" ixy="{i[1]!r}" ixz="{i[2]!r}" iyy="{i[3]!r}" iyz="{i[4]!r}" izz="{i[5]!r}"/>
  </inertial></link>
"""
JOINT = """  <joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
    <origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>
    <limit lower="-4" upper="4" velocity="20" effort="500"/></joint>
"""
DRIVE = """[parameters.test.joints.{name}]
gear_ratio = {ratio!r}
rotor_inertia = {rotor!r}
viscous_friction = {viscous!r}
coulomb_friction = [{positive!r}, {negative!r}]
"""
EXAMPLES = {"ur5": UR5, "panda": PANDA, "kinova": KINOVA}
# Joints of every kind about and along skew axes, on two branches; the side branch does not carry the tool.
BRANCHED = """<robot name="branched">
<link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/>
<link name="side"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="a"/>
<origin xyz="0.1 -0.2 0.3" rpy="0.3 0.2 -0.5"/><axis xyz="0 0.6 0.8"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="slide" type="prismatic"><parent link="a"/><child link="b"/>
<origin xyz="0.4 0 0.1" rpy="0 0.7 0"/><axis xyz="0.48 0.6 0.64"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="aside" type="revolute"><parent link="b"/><child link="side"/>
<origin xyz="0 0.2 0" rpy="0 0 0"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="spin" type="continuous"><parent link="b"/><child link="c"/>
<origin xyz="0 0.3 0" rpy="0.1 0 1.2"/><axis xyz="1 0 0"/></joint>
<joint name="twist" type="continuous"><parent link="c"/><child link="d"/>
<origin xyz="0.2 0.1 0" rpy="0 0.4 0.2"/><axis xyz="0 -0.8 0.6"/></joint>
<joint name="tip" type="fixed"><parent link="d"/><child link="e"/>
<origin xyz="0.05 0.02 0.3" rpy="0.2 -0.3 0.9"/></joint>
</robot>"""


@cache
def ur5() -> ps.Robot:
    return ps.load_robot(UR5)


@cache
def panda() -> ps.Robot:
    """Seven joints: the fingers are locked."""
    return ps.load_robot(PANDA, locked={"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.02})


def numbers(values: Array | list[float]) -> str:
    return " ".join(repr(float(x)) for x in values)


def link(name: str, mass: float, com: Array | list[float], inertia: Array) -> str:
    """Inertia about the centre of mass, link axes."""
    return LINK.format(name=name, mass=float(mass), com=numbers(com), i=inertia[np.triu_indices(3)].tolist())


def joint(name: str, kind: str, parent: str, child: str, xyz: Array | list[float], axis: Array | list[float],
          rpy: Array | list[float] = (0.0, 0.0, 0.0)) -> str:  # fmt: skip
    return JOINT.format(
        name=name, kind=kind, parent=parent, child=child, xyz=numbers(xyz), rpy=numbers(rpy), axis=numbers(axis)
    )


def load(folder: Path, name: str, body: str, drives: str = "", **options: object) -> ps.Robot:
    """Write a URDF with these links and joints (and drives) to files and load them."""
    path = folder / f"{name}.urdf"
    path.write_text(f'<robot name="{name}">\n{body}</robot>\n')
    if drives:
        header = f'schema = 1\nrobot = "{name}"\ndefault_parameters = "test"\n[parameters.test]\nsource = "test"\n'
        actuators = folder / f"{name}.toml"
        actuators.write_text(header + drives)
        return ps.load_robot(path, actuators=actuators, **options)  # type: ignore[arg-type]
    return ps.load_robot(path, **options)  # type: ignore[arg-type]


def pendulum(folder: Path, *, kind: str = "revolute", drives: str = "", **options: object) -> ps.Robot:
    """A point mass of 2 kg, 0.5 m from a horizontal axis (y), hanging straight down at q = 0."""
    body = '  <link name="base"/>\n' + link("bob", 2.0, [0.0, 0.0, -0.5], np.zeros((3, 3)))
    return load(folder, "pendulum", body + joint("swing", kind, "base", "bob", [0, 0, 1], [0, 1, 0]), drives, **options)


def branched_arm(folder: Path, rng: np.random.Generator, n_joints: int) -> ps.Robot:
    """A random tree: link k hangs on one of the two before it; names in an order that is not the file's."""
    names = rng.permutation([f"j{k:02d}" for k in range(n_joints)]).tolist()
    body, drives = '  <link name="link0"/>\n', ""
    for k, name in enumerate(names):
        parent = f"link{max(0, k - int(rng.integers(2)))}"
        kind = rng.choice(["revolute", "continuous", "prismatic"], p=[0.7, 0.1, 0.2])
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        principal = rng.uniform(0.5, 1.0, 3) * 0.05
        axis = rng.normal(size=3)
        body += link(f"link{k + 1}", rng.uniform(0.5, 5), rng.uniform(-0.2, 0.2, 3), turn @ np.diag(principal) @ turn.T)
        body += joint(name, str(kind), parent, f"link{k + 1}", rng.uniform(-0.4, 0.4, 3), axis, rng.uniform(-3, 3, 3))
        drives += DRIVE.format(
            name=name,
            ratio=float(rng.choice([-1, 1]) * rng.uniform(20, 120)),
            rotor=float(rng.uniform(1e-5, 2e-4)),
            viscous=float(rng.uniform(1e-5, 1e-3)),
            positive=float(rng.uniform(0.0, 0.2)),
            negative=float(-rng.uniform(0.0, 0.2)),
        )
    return load(folder, "tree", body, drives)
