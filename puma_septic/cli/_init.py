"""``puma-septic init``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Final

from puma_septic.cli._output_arguments import add_force
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "a job to begin with: task, actuators, drives and catalogues"

DESCRIPTION = """\
Write a folder with a commented job of an arm, which runs at once: NAME/cell.yaml with robot, points and cycle,
actuators.toml and drives.toml with the arm's own drives, motors.csv and gearboxes.csv to choose others from. All
numbers of the drives are invented: put yours in their place. Exit code: 0 written, 2 bad input."""

EXAMPLES = """init my-cell"""

STARTER: Final = Path(__file__).resolve().parents[1] / "starter"
# In the order in which a reader needs them.
FILES: Final = ("cell.yaml", "actuators.toml", "drives.toml", "motors.csv", "gearboxes.csv")


def add_arguments(parser: ArgumentParser) -> None:
    """The folder."""
    parser.add_argument("name", metavar="NAME", help="the folder to write, new or empty")
    add_force(parser, "NAME")


def run(arguments: Namespace) -> Answer:
    """Write the files, all or none."""
    from puma_septic.report import new_folder

    with new_folder(arguments.name, overwrite=arguments.force) as folder:
        for name in FILES:
            (folder / name).write_bytes((STARTER / name).read_bytes())
    task = Path(arguments.name) / "cell.yaml"
    drives, motors, gearboxes = (task.with_name(name) for name in FILES[2:])
    lines = [
        f"{arguments.name}: {', '.join(FILES)}. Begin with:",
        f"  puma-septic assess {task}",
        f"  puma-septic size {task} --drives {drives}",
        f"  puma-septic size {task} --catalogue {motors} {gearboxes}",
        f"  puma-septic replay {task}",
    ]
    return Answer("\n".join(lines), 0)
