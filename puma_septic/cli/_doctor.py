"""``puma-septic doctor``."""

from __future__ import annotations

import re
from argparse import ArgumentParser, Namespace

from puma_septic._version import __version__
from puma_septic.cli._arguments import add_robot, asked_robot
from puma_septic.cli._output_arguments import add_format
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "whether a robot's data can be trusted"

DESCRIPTION = """\
Examine a robot's data: placeholders, other units, inertias that no body has, effort limits below the arm's own weight;
and what is missing. A verdict for each kind of answer that rests on them.

Exit code: 0 nothing is impossible or doubtful, 1 something is, 2 bad input; what is missing is no fault."""

EXAMPLES = """doctor arm.urdf
doctor arm.urdf --lock finger=0.02 --format sarif"""


def add_arguments(parser: ArgumentParser) -> None:
    """The robot."""
    add_robot(parser, is_positional=True)
    add_format(parser, "text", "json", "csv", "sarif")


def run(arguments: Namespace) -> Answer:
    """Examine the robot; the exit code says whether anything is doubtful."""
    from puma_septic.doctor import CODES, examine
    from puma_septic.document import records_csv, to_json
    from puma_septic.robot import load_robot, robot_files
    from puma_septic.views.doctor import sarif

    section = asked_robot(arguments, {"source": "puma560"})
    source = section.pop("source")
    examination = examine(load_robot(source, **section))
    code = 0 if examination.is_sound else 1
    if arguments.format == "text":
        return Answer(str(examination), code)
    document = examination.to_dict()
    if arguments.format == "csv":
        return Answer(records_csv(document["findings"]), code)
    if arguments.format == "sarif":
        path = robot_files(source)["robot"]
        lines = _lines(path.read_text(encoding="utf-8-sig"))
        document = sarif(document, CODES, version=__version__, uri=path.as_uri(), lines=lines)
    return Answer(to_json(document), code)


def _lines(text: str) -> dict[str, int]:
    """Where links and joints begin in a URDF, by name; a joint comes before a link of the same name."""
    places: dict[str, int] = {}
    for kind in ("joint", "link"):
        for match in re.finditer(rf"<{kind}\b[^>]*?\bname\s*=\s*[\"']([^\"']*)[\"']", text):
            places.setdefault(match[1], text.count("\n", 0, match.start()) + 1)
    return places
