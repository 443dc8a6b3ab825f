"""Robots by name: the PUMA 560 of this package and those of example-robot-data."""

from __future__ import annotations

import re
from collections import Counter
from functools import cache
from pathlib import Path
from typing import Final

import pinocchio as pin

from puma_septic.errors import InputError, did_you_mean
from puma_septic.files import checked_path

__all__ = ["is_robot_path", "named_robots", "own_file", "robot_file"]

_SUFFIXES: Final = (".urdf", ".xml", ".xacro")


@cache
def named_robots() -> dict[str, Path]:
    """URDF of each robot that can be loaded by name: first those of this package, each ``urdf/NAME.urdf``.

    Those of example-robot-data are called by their file, without what all have (``ur5_robot.urdf``: ur5), or by their
    folder where files of several folders have one name. Of two files of one folder the larger has the name: the other
    is an empty one (``ur3.urdf``).

    Returns
    -------
    dict of str to Path
    """
    files: dict[tuple[Path, str], Path] = {}
    for path in sorted((path for root in _example_folders() for path in root.rglob("*.urdf")), key=_size):
        files[path.parent, _short(path.stem)] = path
    counts = Counter(name for _, name in files)
    called = {name if counts[name] == 1 else _short(path.parents[1].name): path for (_, name), path in files.items()}
    own = {path.stem: path for path in sorted(data_folder().glob("*.urdf"))}
    return {**own, **{name: path for name, path in sorted(called.items()) if name not in own}}


def robot_file(source: str | Path) -> Path:
    """The URDF of a name, or of a path.

    Raises
    ------
    InputError
        For XML text, and for what is neither a name nor a file that exists.
    """
    if isinstance(source, str) and source.lstrip().startswith("<"):
        raise InputError("source: this is XML text; write it to a .urdf file and pass its path")
    path = checked_path(source, "URDF")
    if isinstance(source, Path) or is_robot_path(source):
        return path
    if source in (names := named_robots()):
        return names[source]
    if _exists(path):
        return path
    valid = f"{', '.join(map(repr, names))}, or the path of a .urdf file"
    raise InputError(f"unknown robot {source!r}; valid: {valid}{did_you_mean([source], names)}")


def own_file(urdf: Path, kind: str) -> Path | None:
    """The file ``NAME_kind.toml`` that lies beside the URDF of a robot of this package, if it has one."""
    path = urdf.with_name(f"{urdf.stem}_{kind}.toml")
    return path if urdf.parent == data_folder() and path.is_file() else None


def is_robot_path(source: str) -> bool:
    """Whether a text is the path of a robot's file rather than its name."""
    path = Path(source)
    return path.name != source or path.suffix.lower() in _SUFFIXES


def data_folder() -> Path:
    """`urdf` lies inside the installed package, or beside it in the source tree."""
    package = Path(__file__).resolve().parents[1]
    inside = package / "urdf"
    return inside if inside.is_dir() else package.parent / "urdf"


def _exists(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name too long for the file system
        return False


def _example_folders() -> list[Path]:
    """Where example-robot-data 6 lies: files without a Python module, under the prefix that Pinocchio lies in."""
    folders = (parent / "share" / "example-robot-data" / "robots" for parent in Path(pin.__file__).parents)
    return [folder for folder in folders if folder.is_dir()][:1]


def _size(path: Path) -> tuple[int, Path]:
    return path.stat().st_size, path


def _short(name: str) -> str:
    return re.sub(r"(_simple)?(_description|_data|_robot)$", "", name.lower())
