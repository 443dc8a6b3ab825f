"""A small sound URDF, and what the tests put wrong in it."""

from __future__ import annotations

from pathlib import Path

import puma_septic as ps

INERTIA = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.05"/>'
INERTIAL = f'<inertial><origin xyz="0 0 0.2"/><mass value="3"/>{INERTIA}</inertial>'

ARM = f"""<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <link name="upper">{INERTIAL}</link>
  <link name="fore">{INERTIAL}</link>
  <link name="tip"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="50" velocity="3"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="fore"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
    <limit lower="-2.5" upper="2.5" effort="20" velocity="4"/>
  </joint>
  <joint name="mount" type="fixed"><parent link="fore"/><child link="tip"/><origin xyz="0 0 0.3"/></joint>
</robot>
"""

DRIVES = """schema = 1
robot = "arm"
tool = "tip"
default_parameters = "new"
default_limits = "amplifier"
[parameters.new]
source = "catalogue"
note = "bearings run in"
[parameters.new.joints.shoulder]
gear_ratio = -100.0
rotor_inertia = 1e-4
viscous_friction = 1e-3
coulomb_friction = [0.02, -0.03]
[parameters.new.joints.elbow]
gear_ratio = 50.0
armature = 0.5
[parameters.worn]
source = "measured"
[parameters.worn.joints.shoulder]
gear_ratio = -100.0
rotor_inertia = 1e-4
[parameters.worn.joints.elbow]
gear_ratio = 50.0
rotor_inertia = 2e-4
[parameters.worn.links.fore]
com = [0.0, 0.0, 0.25]
[parameters.worn.origins.elbow]
xyz = [0.0, 0.0, 0.45]
[limits.amplifier]
source = "amplifier"
effort = { shoulder = 40.0 }
position = { elbow = [-1.0, 1.0] }
"""


def replaced(old: str, new: str, text: str = ARM, count: int = 1) -> str:
    """The text with one fault; a fault that is not put in would test nothing."""
    assert old in text
    return text.replace(old, new, count)


def load(folder: Path, text: str | bytes = ARM, drives: str | None = None, **options: object) -> ps.Robot:
    """Load a URDF text (and an actuator file's) from a folder."""
    path = folder / "arm.urdf"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    if drives is not None:
        options["actuators"] = folder / "arm.toml"
        (folder / "arm.toml").write_text(drives)
    return ps.load_robot(path, **options)


def told(folder: Path, text: str) -> str:
    """What is said of a file, whether it is refused or not."""
    try:
        return "\n".join(load(folder, text).notes)
    except ps.ModelError as error:
        return str(error)


# A planar arm with two links of 1 m.
_PLANAR_LINK = """<link name="{name}"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
PLANAR = f"""<robot name="planar"><link name="base"/>{_PLANAR_LINK.format(name="a")}
{_PLANAR_LINK.format(name="b")}<link name="tip"/>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
<joint name="elbow" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="end" type="fixed"><parent link="b"/><child link="tip"/><origin xyz="1 0 0"/></joint></robot>"""
