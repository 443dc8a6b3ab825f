"""Which file a URDF's mesh name means, found in the robot's own folders alone, and why one cannot be used."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from os.path import normpath
from pathlib import Path
from typing import Final, final
from urllib.parse import unquote

__all__ = ["Folders", "found_mesh", "own_folders"]

# Where a vendor's URDF lies beside its meshes: then the folder of both is the robot's own.
_URDF_FOLDERS: Final = ("urdf", "urdfs", "robots", "xacro")
# Packages are looked for this far above the URDF, and below given folders, and no more folders than this are opened.
_UP, _DOWN, _MOST_FOLDERS = 4, 5, 5_000
_LFS: Final = b"version https://git-lfs"
_MANIFEST: Final = "package.xml"
_MAX_MANIFEST: Final = 100_000


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Folders:
    """Where the meshes of a robot may lie.

    Attributes
    ----------
    home : Path
        Of the URDF.
    given : tuple of Path
        That the caller named; a link in them may lead out.
    own : tuple of Path
        Of the URDF and the package or folder that it lies in.
    """

    home: Path
    given: tuple[Path, ...]
    own: tuple[Path, ...]

    def holds(self, path: Path) -> bool:
        """Whether a file lies in one of them, as it is named in the given ones, with links resolved in the own."""
        named, resolved = Path(normpath(path)), path.resolve()
        if any(named.is_relative_to(root) or resolved.is_relative_to(root.resolve()) for root in self.given):
            return True
        return any(resolved.is_relative_to(root) for root in self.own)


def own_folders(urdf: Path, package_dirs: Sequence[str | Path]) -> Folders:
    """The folders of a robot whose URDF is this file."""
    home = urdf.resolve().parent
    package = [folder for folder in (home, *home.parents) if (folder / _MANIFEST).is_file()][:1]
    beside = [home.parent] if home.name.lower() in _URDF_FOLDERS else []
    given = tuple(Path(normpath(Path(folder).absolute())) for folder in package_dirs)
    return Folders(home=home, given=given, own=tuple(dict.fromkeys([home, *package, *beside])))


def found_mesh(name: str, folders: Folders) -> tuple[Path | None, str]:
    """The file that a mesh name means, and why it cannot be used; "" where it can.

    Returns
    -------
    tuple of Path or None and str
    """
    try:
        path, package, why = _named(name, folders)
        if path is None:
            return None, why
        resolved = path.resolve()
        is_own = any(resolved.is_relative_to(root) for root in (*folders.own, *package))
        if not (is_own or folders.holds(path)):
            adds = f"package_dirs=[{str(resolved.parent)!r}] adds it"
            return None, f"lies at {resolved}, outside the robot's folders; {adds}"
        why = _unusable(path)
        return (None, why) if why else (resolved if is_own else Path(normpath(path)), "")
    except (OSError, RuntimeError, ValueError) as error:  # too long a name, a loop of links
        return None, f"is no usable path: {error}"


def _named(name: str, folders: Folders) -> tuple[Path | None, list[Path], str]:
    """The file that is meant, the package that it lies in if that says so itself, and why there is none."""
    scheme, separator, rest = name.partition("://")
    if not separator:
        return folders.home / name, [], ""
    if scheme == "file":
        return Path(unquote(rest)), [], ""
    if scheme not in ("package", "model"):
        why = f"{scheme}:// is not opened, only package://, file:// and plain paths; save it and name its path"
        return None, [], why
    package, _, inside = rest.partition("/")
    if package in ("", ".", ".."):
        return None, [], f"{package!r} is no package name"
    roots = list(_packages(package, folders))
    if not roots:
        return None, [], f"package {package!r} was not found; package_dirs=[FOLDER] names the folder that holds it"
    paths = {root: Path(normpath(root / inside.lstrip("/"))) for root in roots}
    within = {root: path for root, path in paths.items() if path.is_relative_to(root)}
    if not within:
        return None, [], f"leads outside its package {roots[0]}"
    root = next((root for root, path in within.items() if path.is_file()), next(iter(within)))
    return within[root], [root.resolve()] if (root / _MANIFEST).is_file() else [], ""


def _packages(package: str, folders: Folders) -> Iterator[Path]:
    """Folders that are called like a package, or say so in their package.xml: given ones, own ones, neighbours."""
    for folder in folders.given:
        yield from _below(folder, package)
    above = [folders.home, *folders.home.parents][: _UP + 1]
    yield from (folder for folder in above if _is_called(folder, package))
    yield from (child for folder in above for child in _children(folder) if _is_called(child, package))


def _is_called(folder: Path, package: str) -> bool:
    return folder.name == package or _manifest_name(folder) == package


def _below(top: Path, package: str) -> Iterator[Path]:
    """The package in a folder: itself, or below it, the nearest first."""
    level, opened = [top], 0
    for _ in range(_DOWN):
        for folder in level:
            if _is_called(folder, package):
                yield folder
        opened += len(level)
        if opened > _MOST_FOLDERS:
            return
        level = [child for folder in level for child in _children(folder)]


def _children(folder: Path) -> list[Path]:
    try:
        found = sorted(child for child in folder.iterdir() if not child.name.startswith(".") and child.is_dir())
    except OSError:  # one that may not be read
        return []
    return found[:_MOST_FOLDERS]


def _manifest_name(folder: Path) -> str | None:
    """What a package's own package.xml calls it."""
    manifest = folder / _MANIFEST
    try:
        if not manifest.is_file() or manifest.stat().st_size > _MAX_MANIFEST:
            return None
        text = manifest.read_bytes()
        if b"<!DOCTYPE" in text or b"<!ENTITY" in text:  # entities may grow without bound
            return None
        return (ET.fromstring(text).findtext("name") or "").strip() or None
    except (OSError, ET.ParseError, ValueError):
        return None


def _unusable(path: Path) -> str:
    """Why a file is no mesh, as far as its name and its first bytes tell."""
    if not path.is_file():
        return _why_missing(path)
    with path.open("rb") as stream:
        head = stream.read(len(_LFS))
    if not head:
        return "is empty"
    if head == _LFS:
        return f"is a Git LFS pointer, not the mesh; run git lfs pull in {path.resolve().parent}"
    return ""


def _why_missing(path: Path) -> str:
    if path.exists():
        return "is not a file"
    if "\\" in path.name:
        return "does not exist; a path in a URDF has / between folders"
    near = (
        [child.name for child in path.parent.iterdir() if child.name.lower() == path.name.lower()]
        if (path.parent.is_dir())
        else []
    )
    return f"does not exist; there is {near[0]}" if near else "does not exist"
