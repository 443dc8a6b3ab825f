"""What the golden files hold: the same motions in every form that the package writes."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import redirect_stdout
from functools import cache, partial
from io import StringIO
from typing import Any

import pytest

import puma_septic as ps
from helpers.places import PANDA, UR5
from helpers.report_text import report_text
from puma_septic.cli import main
from puma_septic.cli._task_text import assessed_text
from puma_septic.comparison import Comparison
from puma_septic.report import assess_document, metrics_csv, to_json
from puma_septic.report.csv import checks_csv
from puma_septic.report.page import tasks_html
from puma_septic.sizing import Sizing
from puma_septic.task import ResolvedTask, assess_task, load_task, make_task, resolve_task

_JOINTS: dict[str, Any] = {
    "name": "joints",
    "description": "Smooth, with steps of velocity, and with steps of acceleration.",
    "robot": {"source": "puma560", "parameters": "rtb", "limits": "corke"},
    "points": [
        {"name": "home", "joints": [0.0, 0.8, -0.3, 0.1, 0.4, 0.0]},
        {"name": "lift", "joints": [0.5, 0.3, 0.2, 0.4, -0.2, 0.6]},
        {"name": "place", "joints": [1.2, 0.9, -0.4, 0.0, 0.5, 1.0]},
    ],
    "times": [0.0, 0.6, 1.5],
    "profiles": ["quintic_spline", "linear", {"name": "lspb", "blend_time": 0.2}],
}
_UR5: dict[str, Any] = {
    "name": "ur5",
    "robot": {"source": str(UR5)},
    "points": [{"joints": [0.0, -1.2, 1.0, -0.5, 0.3, 0.0]}, {"joints": [0.9, -0.7, 1.4, -1.0, 0.8, 0.7]}],
    "durations": [1.2],
    "profiles": ["quintic_segments"],
}
_PANDA: dict[str, Any] = {
    "name": "panda",
    "robot": {
        "source": str(PANDA),
        "tool": "panda_hand_tcp",
        "locked": {"panda_finger_joint1": 0.04, "panda_finger_joint2": 0.04},
    },
    "points": [
        {"joints": [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8]},
        {"joints": [0.5, 0.1, -0.3, -1.6, 0.2, 1.9, 0.4]},
        {"joints": [1.0, 0.3, -0.1, -1.9, 0.4, 2.2, 0.0]},
    ],
    "times": [0.0, 0.8, 1.6],
    "profiles": ["quintic_spline", "cubic_spline"],
}
_WRITTEN = {
    "joints": _JOINTS,
    "carrying": {**_JOINTS, "name": "carrying", "payload": {"mass": 1.5, "com": [0, 0, 0.05]}, "dwell": 0.7,
                 "profiles": ["quintic"]},
    "ur5": _UR5,
    "panda": _PANDA,
}  # fmt: skip
_COMMANDS = {
    "assess": ["assess", "paper-turned"],
    "compare": ["compare", "paper-turned"],
    "ik": ["ik", "paper-turned"],
    "robot": ["robot", "puma560"],
    "paper": ["paper"],
}
WIDTHS = (60, 80, 120, 200)
TASKS = ("paper", "paper-turned", "williams", "lin-chang-luh", *_WRITTEN)


def terminal(name: str, width: int) -> str:
    """What a command prints on a terminal of this width."""
    out = StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out):
        patch.setenv("COLUMNS", str(width))
        main(_COMMANDS[name])
    return out.getvalue()


@cache
def task(name: str) -> tuple[ResolvedTask, tuple[ps.Assessment, ...]]:
    resolved = resolve_task(make_task(_WRITTEN[name]) if name in _WRITTEN else load_task(name))
    return resolved, assess_task(resolved)


@cache
def compared(name: str) -> Comparison:
    resolved, _ = task(name)
    few = ("linear", "cubic_spline", "quintic")
    return ps.compare(resolved.robot, resolved.points, resolved.times, profiles=few if name == "ur5" else None)


@cache
def sized(name: str) -> Sizing:
    resolved, assessments = task(name)
    cycle = ps.cycle.with_return(assessments[0].motion, dwell=0.5)
    robot = resolved.robot
    return ps.size(cycle, drivetrains=ps.load_drivetrains(robot) if robot.name == "puma560" else None)


# What is written of a task, by the ending of its golden file.
OF_TASK: dict[str, Callable[[str], str]] = {
    "txt": lambda name: assessed_text(*task(name), 0.1, verbosity=2),
    "json": lambda name: to_json(assess_document([task(name)])),
    "csv": lambda name: metrics_csv([task(name)]),
    "html": lambda name: "\n".join(one._repr_html_() for one in task(name)[1]),
    "robot.html": lambda name: task(name)[0].robot._repr_html_(),
    "report.html": lambda name: report_text(tasks_html([task(name)])),
}
OF_COMPARISON: dict[str, Callable[[str], str]] = {
    "comparison.txt": lambda name: f"{compared(name)}\n",
    "comparison.json": lambda name: to_json(compared(name).to_dict()),
    "comparison.csv": lambda name: compared(name).to_csv(),
    "comparison.html": lambda name: compared(name)._repr_html_(),
}
OF_SIZING: dict[str, Callable[[str], str]] = {
    "sizing.txt": lambda name: f"{sized(name)}\n",
    "sizing.json": lambda name: to_json(sized(name).to_dict()),
    "sizing.csv": lambda name: checks_csv(sized(name)),
    "sizing.html": lambda name: sized(name)._repr_html_(),
}
CASES: dict[str, Callable[[], str]] = {
    f"{name}.{ending}": (lambda write=write, name=name: write(name))
    for names, forms in ((TASKS, OF_TASK), (("joints", "ur5"), OF_COMPARISON), (("paper", "carrying"), OF_SIZING))
    for name in names
    for ending, write in forms.items()
}
CASES |= {
    f"terminal.{name}.{width}.txt": partial(terminal, name, width)
    for name in _COMMANDS
    if name != "paper"  # its verdicts rest on computing times
    for width in WIDTHS
}
