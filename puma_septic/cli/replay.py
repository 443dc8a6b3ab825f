"""``puma-septic replay``."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Sequence
from importlib import import_module

from puma_septic.assessment import Assessment, assess
from puma_septic.cli.arguments import Answer
from puma_septic.cli.tasks import asked_task
from puma_septic.errors import InputError
from puma_septic.task import assess_task, resolve_task
from puma_septic.viewer import replay, write_replay

__all__ = ["run"]


def run(arguments: Namespace) -> Answer:
    """Write the replay to a file, or serve it until Ctrl-C."""
    assessments, title = _shown(arguments)
    if arguments.html is not None:
        path = write_replay(arguments.html, assessments, title=title)
        return Answer(f"{path}: {path.stat().st_size / 1e6:.1f} MB, works offline; open it in a browser", 0)
    wanted = False if arguments.no_browser else None
    with replay(assessments, title=title, open_browser=wanted, port=arguments.port) as page:
        where = "in the browser" if page.browser_opened else "open it in a browser on this machine"
        taken = f"port {arguments.port} is taken: " if arguments.port and f":{arguments.port}/" not in page.url else ""
        # Told before the wait: it is needed while the command runs.
        sys.stdout.write(f"{taken}{page.url} ({where}; Ctrl-C ends)\n")
        sys.stdout.flush()
        page.wait()
    return Answer("replay ended", 0)


def _shown(arguments: Namespace) -> tuple[Sequence[Assessment], str]:
    """The profiles of a task, or the motion of a file, and their title."""
    if arguments.csv is not None:  # SciPy, which fits it, takes a while to load
        if arguments.profile is not None:
            raise InputError("--profile does not go with --csv: the file has the points")
        what = import_module("puma_septic.cli.log").recorded(arguments)
        return [assess(what.motion)], f"{what.path}, {what.robot.name}"
    resolved = resolve_task(asked_task(arguments, "paper"))
    return assess_task(resolved), f"{resolved.task.name}, {resolved.robot.name}"
