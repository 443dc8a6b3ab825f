"""Sound arms whose text is then mutated: the PUMA, arms of example-robot-data, and random trees."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
import pinocchio as pin

from campaign.mutation import Rng

PUMA: Final = Path(__file__).parents[1] / "urdf" / "puma560.urdf"
_PUBLIC: Final = (
    "ur_description/urdf/ur5_robot.urdf", "panda_description/urdf/panda.urdf",
    "kinova_description/robots/kinova.urdf", "xarm_description/urdf/xarm7.urdf", "z1_description/urdf/z1.urdf",
    "so_arm_description/urdf/so100.urdf", "double_pendulum_description/urdf/double_pendulum_continuous.urdf",
    "ur_description/urdf/ur3_gripper.urdf",
)  # fmt: skip
_INERTIA: Final = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@cache
def published_arms() -> tuple[bytes, ...]:
    """The PUMA, and those of example-robot-data that are there."""
    folders = [parent / "share" / "example-robot-data" / "robots" for parent in Path(pin.__file__).parents]
    paths = [folder / name for folder in folders for name in _PUBLIC]
    return tuple(path.read_bytes() for path in (PUMA, *paths) if path.is_file())


def sound_arm(rng: Rng) -> bytes:
    """The text of one arm, every second time a random tree."""
    known = published_arms()
    if rng.random() < 0.5:
        return known[int(rng.integers(len(known))) if rng.random() < 0.7 else 0]
    return random_tree(rng)


def random_tree(rng: Rng) -> bytes:
    """Two to eight joints on a chain with side branches; some bodies massless, some joints following another."""
    root = ET.Element("robot", name="tree")
    _link(root, "base", rng)
    count = int(rng.integers(2, 9))
    kinds = [str(rng.choice(["revolute", "revolute", "continuous", "prismatic", "fixed"])) for _ in range(count)]
    kinds[0] = "revolute"
    for k, kind in enumerate(kinds):
        parent = f"link{k - 1}" if k and rng.random() < 0.8 else "base" if k < 2 else f"link{int(rng.integers(k - 1))}"
        joint = ET.SubElement(root, "joint", name=f"joint{k}", type=kind)
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=f"link{k}")
        ET.SubElement(joint, "origin", xyz=_numbers(rng.uniform(-0.5, 0.5, 3)), rpy=_numbers(rng.uniform(-3, 3, 3)))
        if kind != "fixed":
            axis = rng.normal(size=3)
            ET.SubElement(joint, "axis", xyz=_numbers(axis / np.linalg.norm(axis)))
            limits = {"lower": "-2.5", "upper": "2", "velocity": "3.5", "effort": "80"}
            ET.SubElement(joint, "limit", limits)
            if rng.random() < 0.2:
                ET.SubElement(joint, "dynamics", damping=repr(float(rng.uniform(0, 2))), friction="0.5")
            if k and kind == kinds[0] and rng.random() < 0.1:
                ET.SubElement(joint, "mimic", joint="joint0", multiplier="-0.5", offset="0.1")
        _link(root, f"link{k}", rng)
    return ET.tostring(root)


def _link(root: ET.Element, name: str, rng: Rng) -> None:
    """A box of random edges, so that its inertia is one of a body, about turned axes."""
    link = ET.SubElement(root, "link", name=name)
    if rng.random() < 0.1:
        return
    mass, edges = float(rng.uniform(0.05, 20)), rng.uniform(0.02, 0.6, 3)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    tensor = turn @ np.diag(mass / 12 * ((edges**2).sum() - edges**2)) @ turn.T
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "origin", xyz=_numbers(rng.uniform(-0.3, 0.3, 3)), rpy=_numbers(rng.uniform(-3, 3, 3)))
    ET.SubElement(inertial, "mass", value=repr(mass))
    upper = tensor[np.triu_indices(3)]
    ET.SubElement(inertial, "inertia", {key: repr(float(x)) for key, x in zip(_INERTIA, upper, strict=True)})


def _numbers(values: np.ndarray) -> str:
    return " ".join(repr(float(x)) for x in values)
