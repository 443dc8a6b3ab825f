"""``puma-septic replay``."""

from __future__ import annotations

import sys
from argparse import Namespace

from puma_septic.cli.arguments import Answer
from puma_septic.cli.tasks import asked_task
from puma_septic.task import assess_task, resolve_task
from puma_septic.viewer import replay, write_replay

__all__ = ["run"]


def run(arguments: Namespace) -> Answer:
    """Write the replay to a file, or serve it until Ctrl-C."""
    resolved = resolve_task(asked_task(arguments, "paper"))
    assessments = assess_task(resolved)
    title = f"{resolved.task.name}, {resolved.robot.name}"
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
