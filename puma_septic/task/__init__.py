"""Task files: what a user writes down, and what it becomes."""

from puma_septic.task._branches import Branch, Posed
from puma_septic.task._conditions import ConditionsSection, LoadCaseSection
from puma_septic.task._resolved_cycle import ResolvedCycle, resolve_cycle
from puma_septic.task._resolved_task import ResolvedTask, assess_task, resolve_task
from puma_septic.task._scene import solve_points
from puma_septic.task._schema import Task
from puma_septic.task._task_file import load_task, make_task, parse_task, task_names, task_text

__all__ = [
    "Branch",
    "ConditionsSection",
    "LoadCaseSection",
    "Posed",
    "ResolvedCycle",
    "ResolvedTask",
    "Task",
    "assess_task",
    "load_task",
    "make_task",
    "parse_task",
    "resolve_cycle",
    "resolve_task",
    "solve_points",
    "task_names",
    "task_text",
]
