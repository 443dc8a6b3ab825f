"""``puma-septic replay``."""

from __future__ import annotations

import os
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from puma_septic.cli._arguments import add_payload, add_profile, add_recording, add_task, asked_task
from puma_septic.cli._output_arguments import add_force
from puma_septic.cli._parser import Answer

if TYPE_CHECKING:
    from puma_septic.assessment import Assessment

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "the arm in motion, in the browser or as one HTML file"

DESCRIPTION = """\
Show the profiles of a task as an arm that moves: the first one solid, further ones as ghosts.

Links are coloured by torque utilisation, paths by profile; violated limits and singular postures are
marked. Without --html it is served to browsers on this machine until Ctrl-C. Exit code: 0 shown or written, 2 bad
input."""

EXAMPLES = """replay paper-turned
replay task.yaml --html replay.html"""


def add_arguments(parser: ArgumentParser) -> None:
    """The task, and where it is shown."""
    add_task(parser)
    add_profile(
        parser, "only this profile, with the task's options if it has some (repeatable; the first one is solid)"
    )
    add_payload(parser)
    parser.add_argument("--html", metavar="FILE", help="write one HTML file, which works offline, instead of serving")
    add_force(parser, "--html")
    parser.add_argument("--port", type=int, metavar="N", help="preferred port; if taken, a free one is used")
    parser.add_argument("--no-browser", action="store_true", help="print the address without opening a browser")
    add_recording(parser)


def run(arguments: Namespace) -> Answer:
    """Write the replay to a file, or serve it until Ctrl-C."""
    from puma_septic.errors import InputError
    from puma_septic.viewer import replay, write_replay

    assessments, title, names = _shown(arguments)
    if arguments.html is not None:
        if os.path.lexists(arguments.html) and not arguments.force:
            raise InputError(f"{arguments.html} exists; name another file, or --force replaces it")
        path = write_replay(arguments.html, assessments, title=title, point_names=names, overwrite=arguments.force)
        return Answer(f"{path}: {path.stat().st_size / 1e6:z.1f} MB, works offline; open it in a browser", 0)
    wanted = False if arguments.no_browser else None
    with replay(assessments, title=title, point_names=names, open_browser=wanted, port=arguments.port) as page:
        where = "in the browser" if page.browser_opened else "open it in a browser on this machine"
        taken = f"port {arguments.port} is taken: " if arguments.port and f":{arguments.port}/" not in page.url else ""
        with suppress(KeyboardInterrupt):  # at any moment after the address is out
            sys.stdout.write(f"{taken}{page.url} ({where}; Ctrl-C ends)\n")
            sys.stdout.flush()
            page.wait()
    return Answer("replay ended", 0)


def _shown(arguments: Namespace) -> tuple[Sequence[Assessment], str, Sequence[str]]:
    """The profiles of a task, or the motion of a file, their title and the names of the points."""
    from puma_septic.assessment import assess
    from puma_septic.errors import InputError
    from puma_septic.task import assess_task, resolve_cycle, resolve_task

    if arguments.csv is not None:
        if arguments.profile is not None:
            raise InputError("--profile does not go with --csv: the file has the points")
        from puma_septic.cli._recorded import recorded

        what = recorded(arguments)
        return [assess(what.motion)], f"{what.path}, {what.robot.name}", ()
    task = asked_task(arguments, "paper", profiles=arguments.profile)
    if task.cycle:
        cycle = resolve_cycle(task)
        return [cycle.assess().whole], f"{task.name}, {cycle.robot.name}", cycle.stops
    resolved = resolve_task(task)
    return assess_task(resolved), f"{resolved.task.name}, {resolved.robot.name}", resolved.names
