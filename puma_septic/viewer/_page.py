"""The page: viewer, scene and data in one HTML file that asks nobody for anything."""

from __future__ import annotations

import base64
import gzip
import json
import re
import struct
from collections.abc import Sequence
from functools import cache
from html import escape
from importlib.resources import files
from typing import Any, Final

import numpy as np

from puma_septic.kinematics import singularity_names
from puma_septic.motion import Motion
from puma_septic.pictures import profile_line
from puma_septic.validation import Array
from puma_septic.viewer._animation import Flag
from puma_septic.viewer._colours import UTILISATION, as_hex
from puma_septic.viewer._scene import Shown, scene_commands

__all__ = ["page_html"]

# Digits behind the point of what the page only writes or draws: s and m to a tenth of a millimetre, parts of a limit.
_DIGITS: Final = 4
# The camera sees 20 degrees to each side: a ball fits in from 1 / sin(20 deg) = 2.92 radii; and it looks down a little.
_EYE_DISTANCE: Final = 2.95
_EYE_HEIGHT: Final = 0.4


def page_html(group: Sequence[Shown], title: str, *, point_names: Sequence[str] = (), has_panel: bool = True) -> str:
    """One page that shows the motions; it opens from disk, and its policy forbids it any request.

    Without its panel it is for a frame in a page that has numbers, legend and time line of its own.
    """
    parts = {
        "TITLE": escape(title),
        "CSS": _text("page.css"),
        "JS": _text("page.js"),
        "SHAPE": "" if has_panel else ' data-shape="bare"',
        "STAGE": _text("stage.js"),
        "DATA": _script_json(_page_data(group, title, point_names)),
        "VIEWER": _viewer(),
        "SCENE": _packed(b"".join(struct.pack("<I", len(one)) + one for one in scene_commands(group))),
    }
    return re.sub("@([A-Z]+)@", lambda match: parts[match[1]], _text("page.html"))


def _text(name: str) -> str:
    return files("puma_septic.viewer").joinpath(name).read_text(encoding="utf-8")


@cache
def _viewer() -> str:
    """Meshcat's viewer as its package brings it, with three.js inside."""
    return _packed(files("meshcat").joinpath("viewer/dist/main.min.js").read_bytes())


def _packed(content: bytes) -> str:
    return base64.b64encode(gzip.compress(content, 9, mtime=0)).decode("ascii")


def _script_json(value: Any) -> str:
    """JSON that cannot end the script element that holds it, whatever a joint is called."""
    text = json.dumps(value, allow_nan=False, separators=(",", ":"), ensure_ascii=True)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _page_data(group: Sequence[Shown], title: str, point_names: Sequence[str]) -> dict[str, Any]:
    places = np.vstack([part for one in group for part in (one.path, one.elbows)])
    middle = (places.min(axis=0) + places.max(axis=0)) / 2
    radius = max(0.15, float(np.linalg.norm(places - middle, axis=1).max()))
    return {
        "title": title,
        "start": min(float(one.times[0]) for one in group),
        "end": max(float(one.times[-1]) for one in group),
        "target": middle.tolist(),
        "eye": (middle + _EYE_DISTANCE * radius * _eye_direction(group[0].path)).tolist(),
        "utilisation_colours": [as_hex(stop) for stop in UTILISATION],
        "base": group[0].elbows[0, :2].tolist(),
        "ground": min(0.0, float(group[0].elbows[0, 2])),
        "point_names": [str(name) for name in point_names],
        "fastest": max(float(one.speed.max()) for one in group),
        "motions": [_motion_data(one, k) for k, one in enumerate(group)],
    }


def _eye_direction(path: Array) -> Array:
    """Across the direction in which the tool goes furthest, from the side of the base on which it is."""
    level = path[:, :2] - path[:, :2].mean(axis=0)
    across = np.linalg.eigh(level.T @ level)[1][:, 0]
    across = across if across @ path[:, :2].mean(axis=0) >= 0 else -across
    # Turned a little, so that nothing is seen exactly edge on.
    turn = np.array([[np.cos(0.35), -np.sin(0.35)], [np.sin(0.35), np.cos(0.35)]])
    direction = np.append(turn @ across, _EYE_HEIGHT)
    return np.asarray(direction / np.linalg.norm(direction))


def _motion_data(one: Shown, k: int) -> dict[str, Any]:
    motion = one.assessment.motion
    robot, trajectory = motion.robot, motion.trajectory
    return {
        "label": one.label,
        "robot": robot.name,
        "tool": robot.tool,
        "verdict": one.assessment.verdict,
        "feasible": one.assessment.is_feasible,
        "doubtful": bool(one.assessment.doubts),
        "colours": [profile_line(k).hue.light, profile_line(k).hue.dark],
        "joints": list(robot.joint_names),
        "times": _rounded(one.times),
        "used": [_rounded(column) if np.isfinite(column).all() else None for column in one.used.T],
        "speed": _rounded(one.speed),
        "singular": [
            {"kind": kind, "apart": _rounded(values)}
            for kind, values in zip(singularity_names(robot), one.apart.T, strict=True)
        ],
        "vias": [[float(time), *place] for time, place in zip(trajectory.marked[0], one.vias.tolist(), strict=True)],
        "flags": [_flag_data(flag) for flag in one.flags],
        "payload": _carried(motion),
        "missing": list(robot.undrawn),
    }


def _carried(motion: Motion) -> str:
    """What the arm carries, of a cycle from the least to the most; empty for an empty hand."""
    payloads = [part.robot.payload for part in motion.parts or (motion,)]
    masses = [0.0 if payload is None else payload.mass for payload in payloads]
    if max(masses) == 0:
        return ""
    return f"{min(masses):g} to {max(masses):g} kg" if min(masses) < max(masses) else f"{masses[0]:g} kg"


def _flag_data(flag: Flag) -> dict[str, Any]:
    return {"kind": flag.kind, "time": flag.time, "text": flag.text, "spans": [list(span) for span in flag.spans]}


def _rounded(values: Array) -> list[float]:
    return [round(value, _DIGITS) for value in values.tolist()]
