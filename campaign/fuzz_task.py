"""Task files: the numbers of an accepted task are those of its text; one in ten is resolved and assessed."""

from __future__ import annotations

import zlib
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from ruamel.yaml import YAML

import puma_septic as ps
from campaign.moves import ROOT
from campaign.mutation import Rng, chosen, mangled_bytes, mutated_text
from campaign.plain import check_assessment, check_text, numbers_of
from campaign.rules import UnsoundError

_HEAD: Final = """name: shelf
robot: {source: puma560, parameters: rtb, limits: corke}
"""
_FOUR: Final = """points:
  - {name: a, joints: [0, 0.785, -3.14, 0, 0.785, 0]}
  - {name: b, joints_deg: [10, 50, -170, 10, 40, 5]}
  - {name: c, joints: {joint1: 0.5, joint2: 0.9, joint3: -2.6, joint4: 0.1, joint5: 0.5, joint6: 0}}
  - {name: d, joints: [0.8, 1.0, -2.5, 0.3, 0.4, 0.1]}
"""
_TWO: Final = """points:
  - {joints: [0, 0.785, -3.14, 0, 0.785, 0]}
  - {joints: [0.8, 1.0, -2.5, 0.3, 0.4, 0.1]}
"""
_BESIDE: Final = """payload: {mass: 2.0, com: [0, 0, 0.05], inertia: [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]}
wrench: {force: [1, 2, 3], torque: [0, 0, 0.1], axes: tool}
dwell: 1.0
floor: -0.5
limits: {jerk: 50, velocity: [1, 2, 3, 4, 5, 6], effort: 90}
tool_limits: {speed: 2.0, acceleration: 9.0, source: a rule}
"""
_PROFILES: Final = (
    "septic", "quintic_segments", "cubic_spline", "quintic_spline", "septic_spline", "single_polynomial", "poly_434",
    "{name: lspb, blend_time: 0.5}", "{name: trapezoidal, blend_time: 0.2}", "{name: bspline, degree: 5}",
    "classic_septic", "{name: bspline_control, degree: 3}", "{name: polynomial_blends, blend_time: 0.3, degree: 5}",
    "modified_sine", "bezier", "{name: septic, start_velocity: [0, 0, 0, 0, 0, 0], end_acceleration: 0}",
    "cubic_spline_free_knots", "linear",
    "{name: quintic, velocities: [[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]]}",
)  # fmt: skip
_NO_TIMES: Final = (
    "{name: double_s, max_velocity: 1.0, max_acceleration: 2, max_jerk: 30}",
    "{name: lspb, max_velocity: [1, 1, 1, 1, 1, 1], blend_time: 0.3}",
)
_OPTIONS: Final = (
    "degree: 3.0", "degree: 9", "max_velocity: fast", "blend_time: -1", "start_velocity: [[1]]", "end_velocity: {a: 1}",
    "degree: true", "blend_time: [0.1, 0.2]", "start_velocity: 1e300", "angle: 4", "joint_names: [a]",
    "order: 0xffffffff", "velocities: [1, [2, 3]]", "blend_time: 1:30", "max_jerk: .inf", "max_acceleration: null",
    "points: 3",
)  # fmt: skip
_LINES: Final = (
    "dwell: 1e308", "dwell: 0xfffffffffffffffffffffffffffffffff", "gravity: [0, 0, 9.81]",
    "description: \"\\e]0;x\\a\"", "branch: auto", "branch: right-up-noflip", "frame: shoulder_base", "repeat: false",
    "defaults: {speed: .nan}", "times: [0, 1e-300, 2e-300, 3e-300]", "durations: [1, 2, 3]",
    "load_cases: [{name: a, share: 0.5}]", "? [a, b]\n: 1", "conditions: {cycles_per_minute: 10, altitude: 1e9}",
    "rest_before: false", "description: \"\\u202Eevil\"", "a: &a [*a]", "robot: {source: ur5}",
    "robot: {source: panda, locked: others}", "robot: {source: ../up.urdf}", "floor: -1e308",
    "payload: {mass: 1e308}", "payload: {mass: 0.0}", "wrench: {force: [1e308, 0, 0]}", "x: " + "[" * 200 + "]" * 200,
    "limits: {position: [[1, -1], [1, -1], [1, -1], [1, -1], [1, -1], [1, -1]]}",
    "robot: {source: puma560, tool: nowhere}",
)  # fmt: skip


@cache
def _jobs() -> tuple[str, ...]:
    folder = ROOT / "puma_septic"
    return tuple(path.read_text(encoding="utf-8") for path in sorted([*folder.glob("tasks/*.yaml")]))


def make(rng: Rng) -> bytes:
    """A task of the package or one with a profile of any family, changed."""
    way = rng.random()
    if way < 0.3:
        text = chosen(rng, _jobs())
    elif way < 0.85:
        text = f"{_HEAD}{_FOUR}times: [0, 1, 2.5, 4]\nprofiles:\n  - {chosen(rng, _PROFILES)}\n"
    else:
        text = f"{_HEAD}{_TWO}profiles: [{chosen(rng, _NO_TIMES)}]\n"
    if rng.random() < 0.3 and way >= 0.3:
        text += _BESIDE
    if rng.random() < 0.12:
        return mangled_bytes(rng, text.encode())
    return mutated_text(rng, text, (_line, _option)).encode("utf-8", "surrogatepass")


def check(path: Path) -> None:
    """Read it, compare its numbers with the text's, and assess one in ten."""
    task = ps.load_task(path)
    _check_numbers(task, path.read_text(encoding="utf-8-sig"))
    if zlib.crc32(path.read_bytes()) % 10:
        return
    if "cycle" in task.document():
        answer = ps.assess_cycle(ps.resolve_cycle(task).cycle)
        check_text(str(answer))
        return
    for assessment in ps.assess_task(ps.resolve_task(task)):
        check_assessment(assessment)


def _check_numbers(task: ps.Task, text: str) -> None:
    said = dict(numbers_of(YAML(typ="safe", pure=True).load(text)))
    kept = dict(numbers_of(task.document()))
    for way, value in kept.items():
        if way in said and not np.isclose(value, said[way], rtol=1e-15, atol=0.0):
            raise UnsoundError(f"number: {'.'.join(map(str, way))} is {value!r}, the text has {said[way]!r}")


def _line(rng: Rng, text: str) -> str:
    """A line of its own at the top level, often in place of that key."""
    new: Any = chosen(rng, _LINES)
    lines = [line for line in text.split("\n") if rng.random() < 0.3 or line.split(":")[0] != new.split(":")[0]]
    return "\n".join([*lines, new, ""])


def _option(rng: Rng, text: str) -> str:
    name, found, rest = text.rpartition("name: ")
    return f"{name}{found}{rest.replace('}', f', {chosen(rng, _OPTIONS)}}}', 1)}" if found else text
