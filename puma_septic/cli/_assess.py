"""``puma-septic assess``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from puma_septic.cli._arguments import add_dwell, add_margin, add_payload, add_profile, add_recording, add_task
from puma_septic.cli._output_arguments import add_format, add_out, add_verbose, add_write
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "torque, jerk and limits of a task's profiles"

DESCRIPTION = """\
Assess the profiles of a task, or the motions of its cycle: what each joint does and needs, checked against its limits.

Without TASK: the paper's pick-and-place with septic, LSPB and three-segment quintic side by side, why no
branch of the inverse kinematics keeps the limits, and then the same points with the tool turned, where
everything fits."""

EXAMPLES = """assess paper-turned --profile septic --payload 1
assess task.yaml --margin 0.1 --out results
assess --csv log.csv --units deg --smoothing auto"""


def add_arguments(parser: ArgumentParser) -> None:
    """The task, its load, the margin, the form."""
    add_task(parser)
    add_profile(parser, "only this profile, with the task's options if it has some (repeatable)")
    add_payload(parser)
    add_dwell(parser)
    add_margin(parser)
    add_verbose(parser)
    add_format(parser, "text", "json", "csv")
    add_out(parser, "report.html, JSON, CSV and figures")
    add_write(parser, "the motion of the first profile, or the whole cycle,")
    add_recording(parser)


def run(arguments: Namespace) -> Answer:
    """Assess the asked task or recorded motion."""
    if arguments.csv is not None:
        from puma_septic.cli._recorded import run_log

        return run_log(arguments)
    from puma_septic.cli._assess_answer import answer

    return answer(arguments)
