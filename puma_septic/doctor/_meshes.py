"""Masses against the volumes of meshes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from puma_septic.doctor._bodies import bodies
from puma_septic.doctor._finding import Finding
from puma_septic.errors import ModelError
from puma_septic.robot import Robot

__all__ = ["mesh_findings"]

# kg per m^3 of the convex hull, which is no smaller than the body: lead has 11,340, and a hollow cover some 50.
_DENSEST, _LIGHTEST = 11_340.0, 30.0


def mesh_findings(robot: Robot) -> Iterator[Finding]:
    """Mean densities that no link has, and meshes that are not there; reads the meshes."""
    if robot.missing_meshes:
        yield Finding(
            code="no_mesh",
            severity="missing",
            parts=tuple(text.partition("'")[2].partition("'")[0] for text in robot.missing_meshes),
            message=f"not found, so not drawn: {'; '.join(robot.missing_meshes)}",
        )
    volumes = _hull_volumes(robot)
    found = []
    for body in bodies(robot):
        volume = volumes.get(body.joint, 0.0)
        if body.mass > 0 and volume > 0 and not _LIGHTEST <= body.mass / volume <= _DENSEST:
            text = f"{body.mass:.4g} kg in {1e3 * volume:.3g} l, {body.mass / volume:.3g} kg/m^3"
            found.append((body.link, text))
    if found:
        yield Finding(
            code="density",
            severity="doubtful",
            parts=tuple(link for link, _ in found),
            message="mass against the hull of the link's meshes: "
            + "; ".join(f"{link} {text}" for link, text in found),
        )


def _hull_volumes(robot: Robot) -> dict[str, float]:
    """m^3 of the convex hulls of all drawn meshes by joint; empty where the meshes cannot be read."""
    try:
        shapes = robot.visual_model.geometryObjects
    except ModelError:
        return {}
    volumes: dict[str, float] = {}
    for shape in shapes:
        vertices = getattr(shape.geometry, "vertices", None)
        if vertices is not None and shape.parentJoint:
            name = robot.bare_model.names[shape.parentJoint]
            volumes[name] = volumes.get(name, 0.0) + _hull_volume(vertices())  # scaled already
    return volumes


def _hull_volume(points: Any) -> float:
    from scipy.spatial import ConvexHull, QhullError  # takes a fifth of a second, which no assessment needs

    try:
        return float(ConvexHull(np.asarray(points)).volume)
    except QhullError:  # flat, or fewer than four points
        return 0.0
