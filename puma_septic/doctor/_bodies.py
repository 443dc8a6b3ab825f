"""What moves: masses, centres of mass, inertias and distances that no arm has, or hardly any; masses against meshes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
import pinocchio as pin

from puma_septic.doctor._finding import Finding, Severity
from puma_septic.errors import ModelError
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["body_findings", "mesh_findings"]

# Relative; below it a sum of two moments that misses the third is rounding of printed digits (issue 10).
_TRIANGLE: Final = 1e-3
# Of the link's size, known by its joints and frames alone. A body within its length has a radius of gyration of half of
# it at most; bodies overhang their joints, and of the sound arms in tests/doctor the Panda comes to 0.75.
_LARGE, _SMALL = 0.85, 0.01
# A link whose joints coincide, as in a wrist, is taken to be this part of the arm's reach in size.
_LEAST_SIZE: Final = 0.2
# Of both neighbours' masses. Of example-robot-data's arms the largest step is 9 (UR10, wrist 2 to 3 is 1 of 6).
_OUTLIER: Final = 25.0
# kg per metre of reach; the lightest arms made of plastic and hobby servos have some 1.5.
_LEAST_MASS: Final = 0.5
# m, and times the median of the arm: the largest arms reach 4 to 5 m.
_FAR, _FAR_RATIO = 5.0, 50.0


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Body:
    """All that one joint moves alone.

    Attributes
    ----------
    joint, link : str
        The joint, and the first link that it carries.
    mass : float
        kg.
    com : ndarray, shape (3,)
        From the joint's origin, m.
    moments : ndarray, shape (3,)
        Principal moments about the centre of mass, in rising order, kg m^2.
    tensor : ndarray, shape (3, 3)
    distance : float
        From the parent joint's origin to this one's, m.
    size : float
        From its joint's origin to the farthest frame that is fixed to it, m.
    is_bare : bool
        Whether nothing is behind it, no joint and no frame, that says how large it is: a wheel, a finger.
    is_first : bool
        Whether nothing that moves carries it: of its tensor only the moment about its axis then counts, and no
        identification finds the others (Gautier, Khalil, "Direct calculation of minimum set of inertial parameters of
        serial robots", IEEE Trans. Robotics and Automation 6 (3), 1990, pp. 368-373).
    axial_moment : float
        About the joint's axis through the centre of mass, kg m^2; 0 for one that slides.
    """

    joint: str
    link: str
    mass: float
    com: Array
    moments: Array
    tensor: Array
    distance: float
    size: float
    is_bare: bool
    is_first: bool
    axial_moment: float

    @property
    def largest_moment(self) -> float:
        """The largest that counts, kg m^2."""
        return self.axial_moment if self.is_first else float(self.moments[2])


def _bodies(robot: Robot) -> tuple[_Body, ...]:
    """The moving bodies in the order of the model, without payload."""
    model = robot.bare_model
    return tuple(_body(model, k) for k in range(1, model.njoints))


def _body(model: Any, k: int) -> _Body:
    inertia = model.inertias[k]
    children = [model.jointPlacements[c].translation for c in range(1, model.njoints) if model.parents[c] == k]
    frames = [f for f in model.frames if f.parentJoint == k and f.type != pin.FrameType.JOINT]
    places = [*children, *(frame.placement.translation for frame in frames)]
    links = [frame.name for frame in frames if frame.type == pin.FrameType.BODY]
    tensor = np.array(inertia.inertia)
    data = model.joints[k].createData()
    model.joints[k].calc(data, pin.neutral(model))
    axis = np.ravel(data.S)[3:]
    size = max((float(np.linalg.norm(place)) for place in places), default=0.0)
    return _Body(
        joint=model.names[k],
        link=links[0] if links else model.names[k],
        mass=float(inertia.mass),
        com=np.array(inertia.lever),
        moments=np.linalg.eigvalsh(tensor),
        tensor=tensor,
        distance=float(np.linalg.norm(model.jointPlacements[k].translation)),
        size=size,
        is_bare=not children and size == 0.0,
        is_first=int(model.parents[k]) == 0,
        axial_moment=float(axis @ tensor @ axis),
    )


def body_findings(robot: Robot) -> Iterator[Finding]:
    """What is odd in the masses, inertias and distances of the moving bodies."""
    parts = _bodies(robot)
    heavy = [body for body in parts if body.mass > 0]
    yield from _missing(robot, parts)
    yield from _impossible(robot, heavy)
    yield from _gyration(parts, heavy)
    yield from _alike(heavy)
    yield from _outliers(robot, heavy)
    yield from _distances(parts, heavy)


def _missing(robot: Robot, parts: Sequence[_Body]) -> Iterator[Finding]:
    empty = [body.link for body in parts if body.mass == 0 and not body.tensor.any()]
    if empty:
        joints = f"; no torque beyond joint {', '.join(robot.missing_inertia)}" if robot.missing_inertia else ""
        yield Finding(
            code="no_inertia",
            severity="missing",
            parts=tuple(empty),
            message=f"no mass or inertia: {', '.join(empty)}{joints}",
        )


def _impossible(robot: Robot, heavy: Sequence[_Body]) -> Iterator[Finding]:
    """Negative moments, and moments above the sum of the other two; of the first body only what counts.

    An inertia that is not used at all is known by the reason alone.
    """
    wrong = [(link, f"({why})") for link, why in robot.unusable_inertia.items()]
    for body in heavy:
        a, b, c = body.moments
        largest = max(abs(a), abs(c))
        if a < -_TRIANGLE * largest or (not body.is_first and a + b < c * (1 - _TRIANGLE)):
            wrong.append((body.link, f"{a:.3g}, {b:.3g}, {c:.3g} kg m^2"))
    yield from _each("inertia_impossible", "impossible", "principal moments that no body has", wrong)


def _gyration(parts: Sequence[_Body], heavy: Sequence[_Body]) -> Iterator[Finding]:
    reach = _reach(parts)
    large, small = [], []
    for body in heavy:
        # What ends a branch without a frame, such as a wheel or a finger, may be of any size.
        least = reach if body.is_bare else _LEAST_SIZE * reach
        size = max(body.size, float(np.linalg.norm(body.com)), least)
        radius = float(np.sqrt(max(0.0, body.largest_moment) / body.mass))
        text = f"{radius:.3g} m in a link of some {size:.2g} m"
        if radius > _LARGE * size:
            large.append((body.link, text))
        elif radius < _SMALL * size and not body.is_first and not body.is_bare:
            small.append((body.link, text))
    yield from _each("inertia_large", "doubtful", "radius of gyration too large", large)
    yield from _each("inertia_small", "doubtful", "radius of gyration too small, as of a point mass", small)


def _alike(heavy: Sequence[_Body]) -> Iterator[Finding]:
    """Three bodies or more, and all but two, with one mass, or one tensor, to all digits.

    What is fixed to a link, such as a hand to the last one, is a part of its body: so all but two.
    """
    for code, what, values in (
        ("masses_equal", "the same mass", [(body.mass,) for body in heavy]),
        ("inertias_equal", "the same moments of inertia", [tuple(body.moments) for body in heavy]),
    ):
        texts = [", ".join(f"{value:.9g}" for value in row) for row in values]
        common = max(texts, key=texts.count, default="")
        links = tuple(body.link for body, text in zip(heavy, texts, strict=True) if text == common)
        if len(links) >= max(3, len(heavy) - 2):
            unit = "kg" if code == "masses_equal" else "kg m^2"
            message = f"{len(links)} of {len(heavy)} moving links have {what}, {common} {unit}: a placeholder?"
            yield Finding(code=code, severity="doubtful", parts=links, message=message)


def _outliers(robot: Robot, heavy: Sequence[_Body]) -> Iterator[Finding]:
    model = robot.bare_model
    found, by_joint = [], {body.joint: body for body in heavy}
    for body in heavy:
        k = model.getJointId(body.joint)
        around = [model.parents[k], *(c for c in range(1, model.njoints) if model.parents[c] == k)]
        masses = [by_joint[model.names[n]].mass for n in around if model.names[n] in by_joint]
        carries = len(around) > 1  # the last of a chain, a finger or a flange, may well be light
        if masses and (body.mass > _OUTLIER * max(masses) or (carries and body.mass * _OUTLIER < min(masses))):
            found.append((body.link, f"{body.mass:.4g} kg beside {', '.join(f'{mass:.4g}' for mass in masses)} kg"))
    yield from _each("mass_outlier", "doubtful", "mass unlike its neighbours'", found)


def _distances(parts: Sequence[_Body], heavy: Sequence[_Body]) -> Iterator[Finding]:
    reach = _reach(parts)
    mass = sum(body.mass for body in heavy)
    if heavy and mass < _LEAST_MASS * reach:
        links = tuple(body.link for body in heavy)
        message = f"moving mass {mass:.3g} kg of an arm that reaches {reach:.2g} m"
        yield Finding(code="moving_mass_small", severity="doubtful", parts=links, message=message)
    far = [
        (body.link, f"{np.linalg.norm(body.com):.3g} m from its joint")
        for body in heavy
        if np.linalg.norm(body.com) > max(reach, 2 * body.size)
    ]
    yield from _each("com_far", "doubtful", "centre of mass far outside the link (millimetres?)", far)
    usual = float(np.median([body.distance for body in parts]))
    wide = [
        (body.joint, f"{body.distance:.4g} m")
        for body in parts
        if body.distance > _FAR or (body.distance > 1 and body.distance > _FAR_RATIO * usual > 0)
    ]
    yield from _each("distance_large", "doubtful", "distance from the joint before (millimetres?)", wide)


def _reach(parts: Sequence[_Body]) -> float:
    """Sum of the distances that are not out of all proportion, m: a size for what has none."""
    distances = np.array([*(body.distance for body in parts), *(body.size for body in parts if body.size)])
    return float(distances[distances <= _FAR].sum()) / 2 if len(distances) else 0.0


def _each(code: str, severity: Severity, what: str, found: Sequence[tuple[str, str]]) -> Iterator[Finding]:
    """One finding for all parts, each with its numbers; none where there is no part."""
    if found:
        yield Finding(
            code=code,
            severity=severity,
            parts=tuple(part for part, _ in found),
            message=f"{what}: {'; '.join(f'{part} {text}' for part, text in found)}",
        )


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
    for body in _bodies(robot):
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
