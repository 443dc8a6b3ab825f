"""Visual and collision shapes, built when asked for; what cannot be drawn is left out and told."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, NoReturn, final
from urllib.parse import unquote
from xml.parsers import expat

import numpy as np
import pinocchio as pin

from puma_septic.errors import ModelError
from puma_septic.robot._mesh_files import Folders, found_mesh, own_folders
from puma_septic.robot._urdf_checks import Urdf

__all__ = ["Geometry", "confined_geometry", "is_drawn"]

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
    folders : Folders
        The robot's own.
    """

    urdf: str = field(repr=False)
    folders: Folders

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
    folders = own_folders(urdf.text.path, package_dirs)
    missing: dict[tuple[str, str], str] = {}
    for name, link in urdf.links.items():
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            mesh = shape.find("geometry/mesh")
            if mesh is None:
                continue
            path, why = found_mesh(mesh.get("filename", ""), folders)
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


def _unfit_collada(path: Path, folders: Folders) -> str:
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
