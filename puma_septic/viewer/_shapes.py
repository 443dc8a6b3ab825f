"""From Pinocchio's shapes to Meshcat's, without opening a file: what is drawn is what was checked when loaded."""

from __future__ import annotations

from typing import Any, Final

import coal
import numpy as np
import pinocchio as pin
from meshcat import geometry as mc

from puma_septic.errors import ModelError
from puma_septic.validation import Array

__all__ = ["Placed", "octahedron", "placed_shapes", "rotated_y_to_z", "tube"]

# A Meshcat geometry and where it is in the frame of the shape, (4, 4).
Placed = tuple[Any, Array]

# Sides of the tube that draws a path; at its thickness nobody sees the edges.
_SIDES: Final = 8


def placed_shapes(shape: pin.GeometryObject) -> list[Placed]:
    """What to draw for one shape of a robot, in its own frame.

    Only the triangles of a mesh are taken, as coal holds them: no texture, no material file, no file at all.

    Raises
    ------
    ModelError
        For a kind of shape that cannot be drawn, such as an octree.
    """
    solid = shape.geometry
    if isinstance(solid, coal.Box):
        return [(mc.Box((2 * np.asarray(solid.halfSide)).tolist()), np.eye(4))]
    if isinstance(solid, coal.Sphere):
        return [(mc.Sphere(float(solid.radius)), np.eye(4))]
    if isinstance(solid, coal.Ellipsoid):
        return [(mc.Sphere(1.0), np.diag([*np.asarray(solid.radii).ravel(), 1.0]))]
    if isinstance(solid, coal.Cylinder):
        return [(mc.Cylinder(2 * float(solid.halfLength), float(solid.radius)), rotated_y_to_z())]
    if isinstance(solid, coal.Cone):
        cone = mc.Cylinder(2 * float(solid.halfLength), radiusTop=0.0, radiusBottom=float(solid.radius))
        return [(cone, rotated_y_to_z())]
    if isinstance(solid, coal.Capsule):
        return _capsule(float(solid.radius), float(solid.halfLength))
    if isinstance(solid, coal.BVHModelBase):
        return [(_mesh(solid), np.eye(4))]
    raise ModelError(f"shape {shape.name!r}: a {type(solid).__name__} cannot be drawn")


def rotated_y_to_z() -> Array:
    """Meshcat's cylinders stand on y, a URDF's on z."""
    return np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def octahedron(radius: float) -> Any:
    """A marker that nobody takes for a part of the arm."""
    corners = radius * np.vstack([np.eye(3), -np.eye(3)])
    upper = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2]])
    lower = np.where(upper == 2, 5, upper)[:, ::-1]
    return mc.TriangularMeshGeometry(corners, np.vstack([upper, lower]))


def tube(points: Array, radii: Array) -> Any | None:
    """A tube along points, shape (n, 3), with a radius at each, shape (n,); None where they are in one place."""
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-3 * radii[1:]
    keep = np.concatenate([[True], apart])
    points, radii = points[keep], radii[keep]
    if len(points) < 2:
        return None
    along = np.gradient(points, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), np.finfo(float).tiny)
    across = _carried_normals(along)
    angle = 2 * np.pi * np.arange(_SIDES) / _SIDES
    other = np.cross(along, across)
    rim = across[:, None] * np.cos(angle)[:, None] + other[:, None] * np.sin(angle)[:, None]
    vertices = (points[:, None] + radii[:, None, None] * rim).reshape(-1, 3)
    k, side = np.meshgrid(np.arange(len(points) - 1), np.arange(_SIDES), indexing="ij")
    a, b = (k * _SIDES + side).ravel(), (k * _SIDES + (side + 1) % _SIDES).ravel()
    faces = np.vstack([np.column_stack([a, b, b + _SIDES]), np.column_stack([a, b + _SIDES, a + _SIDES])])
    return mc.TriangularMeshGeometry(vertices, faces)


def _carried_normals(along: Array) -> Array:
    """Unit vectors across a path, each the one before with what points along the path taken out: no twist."""
    normals = np.empty_like(along)
    normal = np.eye(3)[np.argmin(np.abs(along[0]))]
    for k, tangent in enumerate(along):
        normal = normal - tangent * (normal @ tangent)
        size = np.linalg.norm(normal)
        if size < 1e-6:  # the path turned back on itself within one step
            normal = np.cross(tangent, np.eye(3)[np.argmin(np.abs(tangent))])
            size = np.linalg.norm(normal)
        normal = normal / size
        normals[k] = normal
    return normals


def _capsule(radius: float, half_length: float) -> list[Placed]:
    ends = []
    for z in (-half_length, half_length):
        place = np.eye(4)
        place[2, 3] = z
        ends.append((mc.Sphere(radius), place))
    return [(mc.Cylinder(2 * half_length, radius), rotated_y_to_z()), *ends]


def _mesh(solid: coal.BVHModelBase) -> Any:
    triangles = map(solid.tri_indices, range(solid.num_tris))
    # By index: iterating over one of coal's triangles runs past its third corner.
    faces = np.array([(one[0], one[1], one[2]) for one in triangles], dtype=np.uint32)
    return mc.TriangularMeshGeometry(np.asarray(solid.vertices()), faces.reshape(-1, 3))
