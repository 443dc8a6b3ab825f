"""Visual and collision shapes: mesh files confined to the robot's own folders, built when asked for."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import final
from urllib.parse import unquote
from xml.parsers import expat

import numpy as np
import pinocchio as pin

from puma_septic.errors import ModelError
from puma_septic.robot.urdf_checks import Urdf
from puma_septic.robot.urdf_text import UrdfText

__all__ = ["Geometry", "confined_geometry"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Geometry:
    """Shapes of a robot, not yet built: loading meshes can take seconds and torques need none.

    Attributes
    ----------
    urdf : str
        Text whose mesh names are absolute paths of files that exist, inside `roots`.
    roots : tuple of Path
        The robot's own folders.
    """

    urdf: str = field(repr=False)
    roots: tuple[Path, ...]

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Read the meshes and place the shapes on the model's joints.

        Raises
        ------
        ModelError
            For a mesh that cannot be read, that has a non-finite vertex, or that takes its texture
            from outside the robot's folders.
        """
        try:
            geometry = pin.buildGeomFromUrdfString(model, self.urdf, kind)
        except (ValueError, RuntimeError) as error:
            raise ModelError(f"the shapes cannot be built: {str(error).strip()}") from error
        for shape in geometry.geometryObjects:
            vertices = getattr(shape.geometry, "vertices", None)
            if vertices is not None and not np.isfinite(vertices()).all():
                raise ModelError(f"{shape.meshPath}: this mesh has a non-finite vertex")
            if shape.meshPath.lower().endswith(".dae"):
                _check_textures(Path(shape.meshPath), self.roots)
        return geometry


def confined_geometry(urdf: Urdf, package_dirs: Sequence[str | Path]) -> tuple[Geometry, tuple[str, ...]]:
    """Geometry of a checked URDF, and the meshes that were left out because their file is not there.

    Mesh names are replaced by the path that was checked, so that nothing else can be opened later; shapes
    whose mesh is missing are taken out of the tree.

    Raises
    ------
    ModelError
        For a mesh outside `package_dirs`, the URDF's folder and the package that the URDF lies in, or one
        that is not a file (``http://``).
    """
    text = urdf.text
    home = text.path.resolve().parent
    packages = [Path(folder).resolve() for folder in package_dirs]
    roots = tuple(dict.fromkeys([home, *packages, *_own_package(home)]))
    missing = []
    for name, link in urdf.links.items():
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            mesh = shape.find("geometry/mesh")
            if mesh is None:
                continue
            try:
                path = _mesh_path(text, mesh, packages, home)
                exists = path is not None and path.is_file()
            except (OSError, RuntimeError, ValueError) as error:  # too long a name, a loop of links
                raise text.fault(mesh, f"filename={mesh.get('filename')!r} is no usable path: {error}") from error
            if path is not None and not any(path.is_relative_to(root) for root in roots):
                folders = ", ".join(map(str, roots))
                raise text.fault(
                    mesh,
                    f"filename={mesh.get('filename')!r} is {path}, not in the robot's folders: {folders}",
                )
            if not exists:
                link.remove(shape)
                missing.append(f"link {name!r}: {mesh.get('filename')}")
            else:
                mesh.set("filename", str(path))
    geometry = Geometry(urdf=urdf.xml(("visual", "collision")), roots=roots)
    return geometry, tuple(dict.fromkeys(missing))


def _own_package(home: Path) -> list[Path]:
    """The ROS package that the URDF lies in, if any: its nearest folder upwards with a package.xml."""
    return [folder for folder in (home, *home.parents) if (folder / "package.xml").is_file()][:1]


def _mesh_path(text: UrdfText, mesh: ET.Element, packages: Sequence[Path], home: Path) -> Path | None:
    """The file that a mesh name means, links resolved; None for a package that is not found."""
    name = mesh.get("filename", "")
    scheme, separator, rest = name.partition("://")
    if not separator:
        return (home / name).resolve()
    if scheme == "file":
        return Path(unquote(rest)).resolve()
    if scheme != "package":
        raise text.fault(
            mesh, f"filename={name!r}: only package://, file:// and plain paths are opened, not {scheme}://"
        )
    package, _, inside = rest.partition("/")
    if package in ("", ".", ".."):
        raise text.fault(mesh, f"filename={name!r} leaves the robot's folders: {package!r} is no package name")
    own = [folder for folder in _own_package(home) if folder.name == package]
    found = [folder / package for folder in packages if (folder / package).is_dir()] + own
    return _inside_package(text, mesh, found[0].resolve(), inside) if found else None


def _inside_package(text: UrdfText, mesh: ET.Element, package: Path, inside: str) -> Path:
    path = (package / inside.lstrip("/")).resolve()
    if not path.is_relative_to(package):
        raise text.fault(mesh, f"filename={mesh.get('filename')!r} leads to {path}, outside its package {package}")
    return path


def _check_textures(path: Path, roots: Sequence[Path]) -> None:
    """Refuse a Collada file with an image outside the robot's folders: a viewer would copy it."""
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

    def refuse_doctype(*_: object) -> None:
        raise ModelError(f"{path}: a document type (DOCTYPE) is not allowed in a mesh file")

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler, parser.CharacterDataHandler = start, end, text
    parser.StartDoctypeDeclHandler = refuse_doctype
    try:
        parser.Parse(path.read_bytes(), True)
    except expat.ExpatError as error:
        raise ModelError(f"{path}: not well-formed XML: {error}") from error
    for image in filter(None, (name.strip() for name in images)):
        target = Path(unquote(image.removeprefix("file://")))
        if not any((path.parent / target).resolve().is_relative_to(root) for root in roots):
            raise ModelError(f"{path}: its texture {image!r} lies outside the robot's folders")
