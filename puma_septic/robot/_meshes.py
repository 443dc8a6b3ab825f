"""Visual and collision shapes, built when asked for, from the robot's own folders; what cannot be drawn is told."""

from __future__ import annotations

import stat
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache
from os.path import normpath
from pathlib import Path
from typing import Any, Final, NoReturn, final
from urllib.parse import unquote
from xml.parsers import expat

import numpy as np
import pinocchio as pin

from puma_septic.errors import ModelError
from puma_septic.files import checked_path, kind_of
from puma_septic.robot._urdf_checks import Urdf
from puma_septic.validation import checked_list

__all__ = [
    "Geometry",
    "confined_geometry",
    "is_drawn",
]

# Where a vendor's URDF lies beside its meshes: then the folder of both is the robot's own.
_URDF_FOLDERS: Final = ("urdf", "urdfs", "robots", "xacro")
# Packages are looked for this far above the URDF, and below given folders, and no more folders than this are opened.
_UP, _DOWN, _MOST_FOLDERS = 4, 5, 5_000
_LFS: Final = b"version https://git-lfs"
_MANIFEST: Final = "package.xml"
_MAX_MANIFEST: Final = 100_000


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Folders:
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


_Finder = Callable[[str], tuple[Path, ...]]
"""The folders of a package of this name."""


def _own_folders(urdf: Path, package_dirs: Sequence[str | Path]) -> _Folders:
    """The folders of a robot whose URDF is this file."""
    home = urdf.resolve().parent
    package = [folder for folder in (home, *home.parents) if (folder / _MANIFEST).is_file()][:1]
    beside = [home.parent] if home.name.lower() in _URDF_FOLDERS else []
    folders = [checked_path(one, "package folder") for one in checked_list("package_dirs", package_dirs)]
    given = tuple(Path(normpath(folder.absolute())) for folder in folders)
    return _Folders(home=home, given=given, own=tuple(dict.fromkeys([home, *package, *beside])))


def _found_mesh(name: str, folders: _Folders, packages: _Finder) -> tuple[Path | None, str]:
    """The file that a mesh name means, and why it cannot be used; "" where it can.

    Returns
    -------
    tuple of Path or None and str
    """
    try:
        path, package, why = _named(name, folders, packages)
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


def _named(name: str, folders: _Folders, packages: _Finder) -> tuple[Path | None, list[Path], str]:
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
    roots = packages(package)
    if not roots:
        return None, [], f"package {package!r} was not found; package_dirs=[FOLDER] names the folder that holds it"
    paths = {root: Path(normpath(root / inside.lstrip("/"))) for root in roots}
    within = {root: path for root, path in paths.items() if path.is_relative_to(root)}
    if not within:
        return None, [], f"leads outside its package {roots[0]}"
    root = next((root for root, path in within.items() if path.is_file()), next(iter(within)))
    return within[root], [root.resolve()] if (root / _MANIFEST).is_file() else [], ""


def _packages(package: str, folders: _Folders) -> Iterator[Path]:
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
    kind = kind_of(path)
    if not stat.S_ISREG(kind):
        return "is not a file" if kind else _why_missing(path)
    with path.open("rb") as stream:
        head = stream.read(len(_LFS))
    if not head:
        return "is empty"
    if head == _LFS:
        return f"is a Git LFS pointer, not the mesh; run git lfs pull in {path.resolve().parent}"
    return ""


def _why_missing(path: Path) -> str:
    if "\\" in path.name:
        return "does not exist; a path in a URDF has / between folders"
    near = (
        [child.name for child in path.parent.iterdir() if child.name.lower() == path.name.lower()]
        if (path.parent.is_dir())
        else []
    )
    return f"does not exist; there is {near[0]}" if near else "does not exist"


# What a message calls a shape that is there for contact alone.
_CONTACT = "collision shape"

_PROBE = '<robot name="p"><link name="l"><visual><geometry>{mesh}</geometry></visual></link></robot>'
# Lines of coal's message beside the reason.
_NOT_THE_REASON = ("From file", "in function", "at line", "message: Could not load", "Hint")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Geometry:
    """Shapes of a robot, not yet built: loading meshes can take seconds and torques need none.

    Attributes
    ----------
    urdf : str
        Text whose mesh names are absolute paths of files that exist, inside `folders`.
    folders : _Folders
        The robot's own.
    """

    urdf: str = field(repr=False)
    folders: _Folders

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Read the meshes and place the shapes on the model's joints; those that cannot be read are left out."""
        return _built(self, model, kind)[0]

    def unreadable(self, model: pin.Model, kind: pin.GeometryType) -> tuple[str, ...]:
        """Link, mesh and reason of each shape that `build` leaves out."""
        return _built(self, model, kind)[1]


def confined_geometry(urdf: Urdf, package_dirs: Sequence[str | Path]) -> tuple[Geometry, tuple[str, ...]]:
    """Geometry of a checked URDF, and what was left out of it: link, mesh name and reason, once each.

    Mesh names are replaced by the path that was checked, so that nothing else can be opened later; shapes whose mesh is
    missing, or lies outside `package_dirs`, the URDF's folder and the package that the URDF lies in, are taken out of
    the tree.
    """
    folders = _own_folders(urdf.text.path, package_dirs)
    # Each package is looked for once: beside many folders one search takes as long as all the rest.
    packages = cache(lambda package: tuple(_packages(package, folders)))
    missing: dict[tuple[str, str], str] = {}
    for name, link in urdf.links.items():
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            mesh = shape.find("geometry/mesh")
            if mesh is None:
                continue
            path, why = _found_mesh(mesh.get("filename", ""), folders, packages)
            if path is None:
                link.remove(shape)
                owner = f"link {name!r}" if shape.tag == "visual" else f"{_CONTACT} of link {name!r}"
                missing.setdefault((name, mesh.get("filename", "")), f"{owner}: {mesh.get('filename')} {why}")
            else:
                mesh.set("filename", str(path))
    return Geometry(urdf=urdf.xml(("visual", "collision")), folders=folders), tuple(missing.values())


def is_drawn(left_out: str) -> bool:
    """Whether a shape that was left out would have been drawn; those for contact alone would not."""
    return not left_out.startswith(_CONTACT)


@lru_cache(maxsize=4)
def _built(geometry: Geometry, model: Any, kind: Any) -> tuple[Any, tuple[str, ...]]:
    """The shapes and what was left out; kept, as reading meshes takes seconds."""
    tree = ET.fromstring(geometry.urdf)
    files = {mesh.get("filename", "") for mesh in tree.iter("mesh")}
    left_out = _without(tree, {name: why for name in files if (why := _unfit_collada(Path(name), geometry.folders))})
    try:
        shapes = _shapes(tree, model, kind)
    except (ValueError, RuntimeError):  # which of them, Pinocchio does not say
        left_out += _without(tree, {name: why for name in files if (why := _why_unreadable(name))})
        shapes = _shapes(tree, model, kind)
    nowhere = {shape.meshPath for shape in shapes.geometryObjects if not _is_finite(shape)}
    if nowhere:
        left_out += _without(tree, dict.fromkeys(nowhere, "has a non-finite vertex"))
        shapes = _shapes(tree, model, kind)
    return shapes, tuple(dict.fromkeys(left_out))


def _shapes(tree: ET.Element, model: Any, kind: Any) -> Any:
    return pin.buildGeomFromUrdfString(model, ET.tostring(tree, encoding="unicode"), kind)


def _without(tree: ET.Element, reasons: Mapping[str, str]) -> list[str]:
    """Take the shapes with these meshes out of a URDF's tree; link, mesh and reason of each."""
    told = []
    for link in tree.findall("link"):
        for shape in list(link):
            mesh = shape.find("geometry/mesh")
            name = "" if mesh is None else mesh.get("filename", "")
            if name in reasons:
                link.remove(shape)
                told.append(f"link {link.get('name')!r}: {name} {reasons[name]}")
    return told


def _why_unreadable(name: str) -> str:
    """Why Pinocchio cannot read a mesh file; "" where it can."""
    probe = _PROBE.format(mesh=ET.tostring(ET.Element("mesh", filename=name), encoding="unicode"))
    try:
        pin.buildGeomFromUrdfString(pin.buildModelFromXML(probe), probe, pin.GeometryType.VISUAL)
    except (ValueError, RuntimeError) as error:
        lines = [line for line in str(error).strip().splitlines() if not line.startswith(_NOT_THE_REASON)]
        return f"cannot be read: {lines[-1].strip() if lines else 'no reason is given'}"
    return ""


def _is_finite(shape: Any) -> bool:
    vertices = getattr(shape.geometry, "vertices", None)
    return vertices is None or bool(np.isfinite(vertices()).all())


def _unfit_collada(path: Path, folders: _Folders) -> str:
    """Why a Collada file is not drawn: an image outside the robot's folders, which a viewer would copy."""
    if path.suffix.lower() != ".dae":
        return ""
    try:
        images = _collada_images(path)
    except (ModelError, expat.ExpatError) as error:
        return f"is not well-formed XML: {error}"
    for image in images:
        target = path.parent / unquote(image.removeprefix("file://"))
        if not folders.holds(target):
            return f"takes its texture {image!r} from outside the robot's folders"
    return ""


def _collada_images(path: Path) -> list[str]:
    """Files that a Collada file takes images from."""
    images: list[str] = []
    inside = 0

    def start(tag: str, _: dict[str, str]) -> None:
        nonlocal inside
        if inside or "init_from" in tag:
            inside += 1
            images.append("")

    def end(_: str) -> None:
        nonlocal inside
        inside = max(0, inside - 1)

    def text(data: str) -> None:
        if inside:
            images[-1] += data

    def refuse_doctype(*_: object) -> NoReturn:
        raise ModelError("a document type (DOCTYPE) is not allowed in a mesh file")

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler, parser.CharacterDataHandler = start, end, text
    parser.StartDoctypeDeclHandler = refuse_doctype
    parser.Parse(path.read_bytes().rstrip(b"\0\r\n\t "), True)  # zeros after the end: ros-industrial's iiwa 14
    return [name for name in (image.strip() for image in images) if name]
