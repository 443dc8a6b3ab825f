"""Actuator and drives files: what is accepted has the numbers that Python's own TOML reader finds in the text."""

from __future__ import annotations

import tomllib
import zlib
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np

import puma_septic as ps
from campaign.arms import PUMA
from campaign.moves import ROOT, cycle, puma
from campaign.mutation import NAMES, Rng, chosen, mangled_bytes, mutated_text
from campaign.plain import check_answer, check_text, same

_LINES: Final = (
    "[joint.joint2.motor]", "[joints.joint2.motors]", "[joints.joint7.motor]", "[a]", "schema = true", "schema = 2",
    "x = " + "[" * 300 + "]" * 300, ".".join("a" * 300) + " = 1", '"a b"."c=d"."[" = 1', "x = 9" + "9" * 5000,
    "gear_ratio = 0xffffffffffffffffffffffffffffffff", "rotor_inertia = nan", "viscous_friction = -inf",
    "t = 07:32:00", 'note = """\nmany\nlines"""', "armature = 0.3", "stribeck_velocity = 0.1",
    "coulomb_friction = [1, -1, 1]",
    "[parameters.rtb.links.link1]\nmass = 3.0\ncom = [0, 0, 0.1]\ninertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
    'peak_curve = { value = [[0.0, 1.5], [300.0]], source = "x" }', 'name = { value = nan, source = "x" }',
    'continuous_curve = { value = [[0.0, 0.6], [300.0, 0.4]], source = "x" }',
    'efficiency = { value = 1.2, source = 3 }',
)  # fmt: skip
# Beyond what is published of the PUMA's drives: one number of each kind, so that each is read.
_DRIVES: Final = """schema = 1
robot = "puma560"
[joints.joint1.motor]
name = { value = "M1", source = "x" }
peak_torque = { value = 1.5, source = "x" }
continuous_torque = { value = 0.6, source = "x" }
continuous_curve = { value = [[0.0, 0.6], [300.0, 0.4]], source = "x" }
peak_curve = { value = [[0.0, 1.5], [400.0, 0.9]], source = "x" }
thermal_resistances = { value = [1.5, 2.0], source = "x" }
thermal_time_constants = { value = [20.0, 600.0], source = "x" }
max_winding_celsius = { value = 130.0, source = "x" }
torque_constant = { value = 0.2, source = "x" }
resistance = { value = 1.6, source = "x" }
[joints.joint1.gearbox]
rated_torque = { value = 60.0, source = "x" }
rated_speed = { value = 200.0, source = "x" }
rated_life_hours = { value = 10000.0, source = "x" }
max_repeated_torque = { value = 120.0, source = "x" }
max_input_speed = { value = 700.0, source = "x" }
stiffness = { value = [3e4, 5e4], source = "x" }
stiffness_torques = { value = [20.0], source = "x" }
[joints.joint1.drive]
bus_voltage = { value = 40.0, source = "x" }
peak_current = { value = 20.0, source = "x" }
"""


@cache
def _texts(kind: str) -> tuple[str, ...]:
    shipped = (ROOT / "urdf" / f"puma560_{kind}.toml").read_text(encoding="utf-8")
    return (shipped,) if kind == "actuators" else (shipped, _DRIVES, _DRIVES)


def make_actuators(rng: Rng) -> bytes:
    return _made(rng, "actuators")


def make_drives(rng: Rng) -> bytes:
    return _made(rng, "drives")


def check_actuators(path: Path) -> None:
    """The PUMA with these drives: gear ratio, inertia and friction at the joint, and limits, as the text has them."""
    robot = ps.load_robot(PUMA, actuators=path)
    data = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    if parameters := data.get("parameters"):
        chosen_set = parameters[data.get("default_parameters") or next(iter(parameters))]
        for k, name in enumerate(robot.joint_names):
            _check_joint(robot, k, chosen_set.get("joints", {}).get(name, {}))
    if limits := data.get("limits"):
        chosen_set = limits[data.get("default_limits") or next(iter(limits))]
        for key in ("velocity", "acceleration", "jerk", "effort"):
            said = [chosen_set.get(key, {}).get(name, np.nan) for name in robot.joint_names]
            same(f"{key} limits", getattr(robot.limits, key), said)
    check_text(str(robot))


def check_drives(path: Path) -> None:
    """Every value of the file is that of the drivetrain; one in eight is held against the cycle."""
    trains = ps.load_drivetrains(puma(), path)
    data = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    for name, parts in data.get("joints", {}).items():
        train = trains[puma().joint_index(name)]
        for part, entries in parts.items():
            for key, entry in entries.items():
                is_unknown = isinstance(entry["value"], float) and np.isnan(entry["value"])
                if not (is_unknown or isinstance(entry["value"], str)):
                    same(f"{part} {key}", getattr(getattr(train, part), key), entry["value"])
    if zlib.crc32(path.read_bytes()) % 8 == 0:
        check_answer(ps.size(cycle(), drivetrains=trains))


def _made(rng: Rng, kind: str) -> bytes:
    text = chosen(rng, _texts(kind))
    if rng.random() < 0.12:
        return mangled_bytes(rng, text.encode())
    return mutated_text(rng, text, (_line, _quoted)).encode("utf-8", "surrogatepass")


def _line(rng: Rng, text: str) -> str:
    lines = text.split("\n")
    lines.insert(int(rng.integers(len(lines) + 1)), chosen(rng, _LINES))
    return "\n".join(lines)


def _quoted(rng: Rng, text: str) -> str:
    """A name or source in quotes, escapes as TOML writes them."""
    escapes = ("\\u001b[2J", "\\u202e", "\\u0007", "\\n", "\\U0001F916", "\\x41", "\\ud800")
    inside = chosen(rng, NAMES).replace('"', "").replace("\\", "") if rng.random() < 0.5 else chosen(rng, escapes)
    parts = text.split('"')
    if len(parts) > 2:
        parts[1 + 2 * int(rng.integers((len(parts) - 1) // 2))] = inside
    return '"'.join(parts)


def _check_joint(robot: ps.Robot, k: int, said: dict[str, Any]) -> None:
    ratio = said.get("gear_ratio", np.nan)
    square = 0.0 if np.isnan(ratio) else float(ratio) ** 2  # a rotor behind an unknown ratio is unknown
    same("gear ratio", robot.actuators[k].gear_ratio, ratio)
    at_joint = said.get("armature", said.get("rotor_inertia", 0.0) * square)
    same("armature", robot.armature[k], at_joint, tolerance=1e-12)
    if not np.isnan(ratio):
        same("viscous friction", robot.viscous_friction[k], said.get("viscous_friction", 0.0) * square, tolerance=1e-12)
        levels = np.abs(ratio) * np.array(said.get("coulomb_friction", [0.0, 0.0]), dtype=float)
        same("Coulomb friction", robot.coulomb_friction[k], levels, tolerance=1e-12)
