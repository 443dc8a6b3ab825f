"""What ``puma-septic ik`` does: the branches of one or several poses, as a table or a document."""

from __future__ import annotations

from argparse import Namespace
from textwrap import wrap
from typing import Any

import numpy as np

from puma_septic._version import __version__
from puma_septic.cli._arguments import asked_robot, asked_task
from puma_septic.cli._parser import Answer
from puma_septic.cli._task_text import WIDTH, wrapped
from puma_septic.document import SCHEMAS, records_csv
from puma_septic.errors import InputError
from puma_septic.kinematics import IkSolutions, is_puma, lowest_points, manipulability, rtb_names
from puma_septic.report import to_json
from puma_septic.robot import Robot
from puma_septic.task import Posed, Task, make_task, solve_points
from puma_septic.views.tables import Cell, text_table

__all__ = ["answer"]

# Decimals to which branches are alike: mirrored ones are, but for rounding.
_SAME = 9


def answer(arguments: Namespace) -> Answer:
    """List the branches for one pose, or for each pose of a task."""
    task = _asked(arguments)
    robot, waypoints = solve_points(task)
    labels = [point.name or f"points[{k}]" for k, point in enumerate(task.points)]
    posed = [(label, point) for label, point in zip(labels, waypoints, strict=True) if isinstance(point, Posed)]
    if not posed:
        raise InputError(f"{task.origin}: no point is a pose; there is nothing to solve")
    if arguments.format == "json":
        text = to_json(_document(task, robot, posed, arguments.sort))
    elif arguments.format == "csv":
        text = records_csv(_records(_document(task, robot, posed, arguments.sort)))
    else:
        is_short = len(posed) > 1 and not arguments.verbose
        text = _short_text(task, robot, posed) if is_short else _text(task, robot, posed, arguments.sort)
    reachable = all(point.solutions.within_limits.any() for _, point in posed)
    return Answer(text, 0 if reachable else 1)


def _asked(arguments: Namespace) -> Task:
    """The task, or one made of the single pose on the command line."""
    if arguments.position is None:
        for name in ("rpy_deg", "axis", "position_only", "frame"):
            if getattr(arguments, name) not in (None, False):
                raise InputError(f"--{name.replace('_', '-')} goes with --position")
        return asked_task(arguments, "paper")
    if arguments.task is not None:
        raise InputError("give either TASK or --position, not both")
    return make_task(
        {
            "name": "pose",
            "robot": asked_robot(arguments, {}),
            "frame": arguments.frame or "world",
            "points": [{"name": "pose", "position": arguments.position, **_turned(arguments)}],
            "durations": [],
            "profiles": ["quintic_segments"],
        },
        origin="command line",
    )


def _turned(arguments: Namespace) -> dict[str, list[float]]:
    """What the command line says about the tool's turn, as a point of a task has it."""
    given = [name for name in ("rpy_deg", "axis", "position_only") if getattr(arguments, name) not in (None, False)]
    if len(given) > 1:
        raise InputError(f"give one of {' and '.join(f'--{name}'.replace('_', '-') for name in given)}")
    if arguments.position_only:
        return {}
    return {"axis": arguments.axis} if arguments.axis else {"rpy_deg": arguments.rpy_deg or [0.0] * 3}


def _text(task: Task, robot: Robot, posed: list[tuple[str, Posed]], by: str) -> str:
    head = f"Robot: {robot.name}, tool {robot.tool!r}, poses in {task.frame!r}"
    return "\n\n".join([wrapped(head), *(f"{label}\n\n{_table(robot, point.solutions, by)}" for label, point in posed)])


def _short_text(task: Task, robot: Robot, posed: list[tuple[str, Posed]]) -> str:
    """Of several poses: which branches there are, and which joints are beyond their limits where."""
    names = dict.fromkeys(name for _, point in posed for name in point.solutions.configurations)
    rows: list[list[Cell]] = []
    fitting = []
    for name in names:
        cells = [_place_of(robot, point.solutions, name) for _, point in posed]
        rows.append([name, *cells])
        if all(cell == "ok" for cell in cells):
            fitting.append(name)
    verdict = (
        f"Within the limits at all {len(posed)} poses: {', '.join(fitting)}."
        if fitting
        else f"No branch is within the limits at all {len(posed)} poses."
    )
    head = f"Robot: {robot.name}, tool {robot.tool!r}, poses in {task.frame!r}"
    note = "ok: within the limits; else the joints that are beyond them; -: there is no such branch"
    return "\n".join([
        wrapped(head), wrapped(verdict), "", text_table(["branch", *(label for label, _ in posed)], rows), note, "",
        "More: -v shows the joint positions of each branch and how low the arm hangs.",
    ])  # fmt: skip


def _place_of(robot: Robot, solutions: IkSolutions, name: str) -> str:
    if name not in solutions.configurations:
        return "-"
    return _beyond(robot, solutions, solutions.configurations.index(name)).replace("none", "ok")


def _records(document: dict[str, Any]) -> list[dict[str, Any]]:
    """One for each pose and branch."""
    joints = document["joint_names"]
    return [
        {"pose": pose["name"], **branch, "q": dict(zip(joints, branch["q"], strict=True))}
        for pose in document["poses"]
        for branch in pose["branches"]
    ]


def _order(robot: Robot, solutions: IkSolutions, by: str) -> list[int]:
    """The branches in the asked order."""
    if by == "branch":
        return list(range(len(solutions.q)))
    key = manipulability(robot, solutions.q) if by == "manipulability" else lowest_points(robot, solutions.q).height
    return [int(k) for k in np.argsort(-key.round(_SAME), kind="stable")]


def _table(robot: Robot, solutions: IkSolutions, by: str) -> str:
    ease = manipulability(robot, solutions.q)
    rows: list[list[Cell]] = [
        [
            solutions.configurations[k],
            *(f"{angle:z.4f}" for angle in solutions.q[k]),
            f"{ease[k]:z.3g}" if round(ease[k], _SAME) else "0",
            _beyond(robot, solutions, k),
        ]
        for k in _order(robot, solutions, by)
    ]
    singular = [
        f"{name} is singular ({', '.join(kinds)})"
        for name, kinds in zip(solutions.configurations, solutions.singular, strict=True)
        if kinds
    ]
    extent = f"{solutions.extent[0].upper()}{solutions.extent[1:]}"
    remark = f"{extent}." if solutions.is_complete else f"{extent}; there may be others."
    table = text_table(["branch", *_headed(robot), "manipulability", "beyond limits"], rows)
    return "\n".join([table, "", *singular, remark, _lowest(robot, solutions)])


def _headed(robot: Robot) -> list[str]:
    """The joints with the units of their positions."""
    pairs = zip(robot.joint_names, robot.is_prismatic, strict=True)
    return [f"{name} [{'m' if slides else 'rad'}]" for name, slides in pairs]


def _lowest(robot: Robot, solutions: IkSolutions) -> str:
    """How low the arm hangs, the lowest branches first; those alike together."""
    lowest = lowest_points(robot, solutions.q)
    alike: dict[tuple[float, str], list[str]] = {}
    for k in np.argsort(lowest.height, kind="stable"):
        place = (round(float(lowest.height[k]), 3) + 0.0, lowest.parts[k])
        alike.setdefault(place, []).append(solutions.configurations[k])
    parts = [
        f"{height:z.3f} m ({part}) in {', '.join(names) if len(alike) > 1 else 'each'}"
        for (height, part), names in alike.items()
    ]
    text = f"Lowest point (below the base where negative): {'; '.join(parts)}."
    return "\n".join(wrap(text, WIDTH, subsequent_indent="  ", break_on_hyphens=False))


def _beyond(robot: Robot, solutions: IkSolutions, k: int) -> str:
    """Joints of branch k that are beyond their limits."""
    if solutions.within_limits[k]:
        return "none"
    low, high = robot.limits.position.T
    outside = (solutions.q[k] < low) | (solutions.q[k] > high)
    return " ".join(name for name, out in zip(robot.joint_names, outside, strict=True) if out)


def _rtb(robot: Robot, configuration: str) -> dict[str, str]:
    """Names in Corke's Robotics Toolbox, where it has some."""
    if not is_puma(robot):
        return {}
    python, matlab = rtb_names(configuration)
    return {"rtb_python": python, "rtb_matlab": matlab}


def _document(task: Task, robot: Robot, posed: list[tuple[str, Posed]], by: str) -> dict[str, Any]:
    return {
        "schema": SCHEMAS["ik"],
        "version": __version__,
        "robot": robot.name,
        "tool_frame": robot.tool,
        "frame": task.frame,
        "joint_names": list(robot.joint_names),
        "poses": [
            {
                "name": label,
                "T_world_tool": point.T_world_tool.tolist(),
                "constrain": point.constrain,
                "is_complete": solutions.is_complete,
                "starts": solutions.starts,
                "branches": [
                    {
                        "configuration": name,
                        **_rtb(robot, name),
                        "q": solutions.q[k].tolist(),
                        "within_limits": bool(solutions.within_limits[k]),
                        "singular": list(solutions.singular[k]),
                        "residual": float(solutions.residual[k]),
                        "manipulability": float(ease[k]),
                        "lowest": {"height": float(lowest.height[k]), "part": lowest.parts[k]},
                    }
                    for k in _order(robot, solutions, by)
                    for name in [solutions.configurations[k]]
                ],
            }
            for label, point in posed
            for solutions in [point.solutions]
            for ease in [manipulability(robot, point.solutions.q)]
            for lowest in [lowest_points(robot, point.solutions.q)]
        ],
    }
