"""``puma-septic execute``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from puma_septic.cli._arguments import add_payload, add_profile, add_task, not_negative, positive
from puma_septic.cli._output_arguments import add_format, add_out, add_verbose
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "track a task's profiles with the simulated arm"

DESCRIPTION = """\
Track the profiles of a task with the simulated arm, side by side under the same controller, and measure tracking
error, settling, saturation, vibration and energy.

Results are samples of a simulation. Exit code: 0 simulated, 1 a profile's arm diverged, 2 bad input."""

EXAMPLES = """execute paper-turned
execute task.yaml --controller pd_gravity --out execution
execute paper-turned --joint-frequency 12 --profile septic"""

# As puma_septic.simulation.LAWS has them, which is not loaded for --help; a test holds both together.
_LAWS = ("pd", "pid", "pd_gravity", "feedforward", "computed_torque")


def add_arguments(parser: ArgumentParser) -> None:
    """The task, the controller, the gears, the form."""
    add_task(parser)
    add_profile(parser, "only this profile, with the task's options if it has some (repeatable)")
    add_payload(parser)
    parser.add_argument(
        "--controller",
        choices=_LAWS,
        default="computed_torque",
        metavar="LAW",
        help=f"{', '.join(_LAWS[:-1])} or {_LAWS[-1]} (default)",
    )
    parser.add_argument("--bandwidth", type=positive, default=5.0, metavar="HZ", help="of the gains (default: 5)")
    parser.add_argument(
        "--rate",
        type=positive,
        metavar="HZ",
        help="of the controller; it must divide the motions (default: about 1000)",
    )
    parser.add_argument("--delay", type=not_negative, default=0.0, metavar="S", help="of the torque (default: 0)")
    parser.add_argument(
        "--encoder", type=not_negative, default=0.0, metavar="RAD", help="step of the measured positions (default: 0)"
    )
    parser.add_argument(
        "--unknown-payload", action="store_true", help="the controller does not know the payload that the arm carries"
    )
    parser.add_argument(
        "--joint-frequency",
        type=positive,
        metavar="HZ",
        help="elastic gears: each joint's links alone swing at this frequency at the first point (an assumption)",
    )
    parser.add_argument(
        "--settle",
        type=not_negative,
        default=0.5,
        metavar="S",
        help="simulated time after the motion (default: 0.5)",
    )
    add_verbose(parser)
    add_format(parser, "text", "json", "csv")
    add_out(parser, "report.html, JSON, CSV, samples and figures")


def run(arguments: Namespace) -> Answer:
    """Simulate the asked task's profiles."""
    from puma_septic.cli._execute_answer import answer

    return answer(arguments)
