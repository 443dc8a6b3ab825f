"""Task files: what a user writes down, and what it becomes."""

from puma_septic.task.branches import Branch, Posed
from puma_septic.task.reading import load_task, make_task, parse_task, task_names
from puma_septic.task.resolving import ResolvedTask, assess_task, resolve_task, solve_points
from puma_septic.task.schema import Task

__all__ = [
    "Branch",
    "Posed",
    "ResolvedTask",
    "Task",
    "assess_task",
    "load_task",
    "make_task",
    "parse_task",
    "resolve_task",
    "solve_points",
    "task_names",
]
