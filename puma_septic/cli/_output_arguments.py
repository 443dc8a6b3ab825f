"""Arguments that say in which form a command answers, and where it writes. Standard library alone."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

__all__ = [
    "add_force",
    "add_format",
    "add_out",
    "add_verbose",
    "add_write",
    "asked_units",
    "check_out",
    "origin",
    "with_report",
]

if TYPE_CHECKING:
    from puma_septic.views.units import Units


def add_format(parser: ArgumentParser, *formats: str) -> None:
    """``--format``, the first one by default, and ``--show-in``."""
    parser.add_argument("--format", choices=formats, default=formats[0], help=f"output format (default: {formats[0]})")
    parser.add_argument(
        "--show-in",
        type=_names,
        default=(),
        metavar="UNIT,...",
        help="deg: angles in degrees; rpm: joint speeds in revolutions per minute; in text, tables and charts (JSON and"
        " CSV stay in SI units)",
    )


def add_out(parser: ArgumentParser, files: str) -> None:
    """``--out``, the folder that the named files go to, and ``--force``."""
    parser.add_argument("--out", metavar="DIR", help=f"write {files} into a new or empty folder")
    add_force(parser, "--out")
    parser.add_argument("--no-png", action="store_true", help="with --out: no PNG figures, which take seconds")


def add_verbose(
    parser: ArgumentParser, more: str = "tables of the joints and remarks; -vv: all of each profile"
) -> None:
    """``-v``, counted."""
    parser.add_argument("-v", "--verbose", action="count", default=0, help=more)


def check_out(arguments: Namespace) -> None:
    """Refuse what goes with ``--out`` without it."""
    from puma_septic.errors import InputError

    if getattr(arguments, "no_png", False) and arguments.out is None:
        raise InputError("--no-png goes with --out: name the folder to write into")


def with_report(text: str, arguments: Namespace) -> str:
    """The text for a person and, as its last line, where the report was written."""
    if arguments.out is None or arguments.format != "text":
        return text
    return f"{text}\n\nReport: {Path(arguments.out) / 'report.html'}"


def add_force(parser: ArgumentParser, option: str) -> None:
    """``--force``, without which nothing is overwritten."""
    parser.add_argument("--force", action="store_true", help=f"with {option}: replace files that exist")


def add_write(parser: ArgumentParser, what: str) -> None:
    """``--write``, the file that a motion goes to."""
    parser.add_argument(
        "--write",
        metavar="FILE",
        help=f"write {what} as a ROS JointTrajectory (.yaml, .json), which check reads; --force replaces a file",
    )


def asked_units(arguments: Namespace) -> Units:
    """Of ``--show-in``."""
    from puma_septic.errors import InputError
    from puma_septic.views.units import Units

    try:
        return Units.named(getattr(arguments, "show_in", ()))
    except InputError as error:
        raise InputError(f"--show-in: {error}") from error


def origin(arguments: Namespace) -> dict[str, str]:
    """Where a report comes from: date, command line, file and versions, with their revisions where Git knows them."""
    import platform
    import shlex
    from datetime import datetime
    from importlib.metadata import version

    from puma_septic._version import __version__

    file = getattr(arguments, "csv", None) or getattr(arguments, "task", None)
    folder = Path(file).absolute().parent if file and Path(file).is_file() else None
    libraries = ", ".join(f"{name} {version(name)}" for name in ("pin", "numpy", "scipy"))
    own = f"puma-septic {__version__}{_revision(Path(__file__).parent)}"
    return {
        "made": datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        "command": shlex.join(["puma-septic", *getattr(arguments, "typed", ())]),
        **({"file" if folder else "task": f"{file}{_revision(folder)}"} if file else {}),
        "with": f"{own}, Python {platform.python_version()}, {libraries}",
    }


def _revision(folder: Path | None) -> str:
    """The commit that a folder of a Git repository is at, and whether its files were changed since; else nothing."""
    import subprocess

    if folder is None or not any((parent / ".git").exists() for parent in (folder, *folder.parents)):
        return ""
    # A repository's own settings run no program of theirs here.
    command = ["git", "-c", "core.fsmonitor=false", "describe", "--always", "--dirty", "--exclude=*"]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=5, check=True)
    except (OSError, subprocess.SubprocessError):  # no Git, a repository of somebody else, or one without a commit
        return ""
    return f" (git {done.stdout.strip()})"


def _names(text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.split(",") if part.strip())
