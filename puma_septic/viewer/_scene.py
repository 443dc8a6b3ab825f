"""The scene: arms with their payload, paths and markers, as the commands that Meshcat's viewer reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
import pinocchio as pin
import umsgpack
from meshcat import geometry as mc
from meshcat.animation import Animation
from meshcat.commands import SetAnimation, SetObject, SetProperty, SetTransform
from meshcat.path import Path

from puma_septic.assessment import Assessment
from puma_septic.kinematics import forward_kinematics, singularity_distances, tool_motion
from puma_septic.motion import Motion
from puma_septic.robot import Payload, Robot
from puma_septic.validation import Array
from puma_septic.viewer._animation import (
    Flag,
    add_colours,
    add_joints,
    add_presence,
    flags_of,
    joint_paths,
    key_times,
    utilisation,
)
from puma_septic.viewer._colours import UTILISATION, colour_at, profile_colour
from puma_septic.viewer._shapes import Placed, octahedron, placed_shapes, rotated_y_to_z, tube

__all__ = ["Shown", "scene_commands", "shown"]

_ROOT: Final = "/meshcat"
_GHOST_OPACITY: Final = 0.32
# Where nothing but the mass of a payload is known it is drawn as a ball of aluminium, kg/m^3.
_ALUMINIUM: Final = 2700.0
_PAYLOAD, _VIA, _LIMIT, _SINGULAR = (0.33, 0.36, 0.41), (0.10, 0.11, 0.13), (0.84, 0.10, 0.11), (0.52, 0.20, 0.62)
# Sizes as parts of the arm's reach: path, markers, and the sticks of an arm without shapes.
_TUBE, _MARKER, _STICK = 0.0065, 0.011, 0.025
# A path at rest, as a part of its thickness at the highest speed.
_THIN: Final = 0.28


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Shown:
    """One motion, sampled for drawing.

    Attributes
    ----------
    assessment : Assessment
    label : str
    times : ndarray, shape (n,)
        Of the key frames, s.
    path : ndarray, shape (n, 3)
        The tool in the world, m.
    speed : ndarray, shape (n,)
        Of the tool, m/s.
    apart : ndarray, shape (n, k)
        Measures that are zero at singular postures, one for each kind that `singularity_names` tells.
    used : ndarray, shape (n, n_joints)
        Torque over its limit; NaN where that is not known.
    elbows : ndarray, shape (k, 3)
        Where the joints come to, now and then: what must fit into the picture beside the path.
    vias, flag_places : ndarray, shape (k, 3)
        Where the tool is at the via points and at the instants of `flags`.
    flags : tuple of Flag
    """

    assessment: Assessment
    label: str
    times: Array
    path: Array
    speed: Array
    apart: Array
    used: Array
    elbows: Array
    vias: Array
    flags: tuple[Flag, ...]
    flag_places: Array


def shown(assessment: Assessment, label: str) -> Shown:
    """Sample a motion at its key frames."""
    motion = assessment.motion
    robot, trajectory = motion.robot, motion.trajectory
    times = key_times(motion)
    q, v, a = (trajectory(times, order) for order in range(3))
    tool = tool_motion(robot, q, v, a)
    flags = flags_of(assessment)
    at_flags = trajectory(np.array([flag.time for flag in flags]))
    return Shown(
        assessment=assessment,
        label=label,
        times=times,
        path=tool.position,
        speed=np.linalg.norm(tool.velocity, axis=1),
        apart=singularity_distances(robot, q),
        used=utilisation(motion, times),
        elbows=_joint_places(robot, trajectory(times[:: max(1, len(times) // 50)])),
        vias=_places(robot, trajectory.marked[1]),
        flags=flags,
        flag_places=_places(robot, at_flags),
    )


def scene_commands(group: Sequence[Shown]) -> tuple[bytes, ...]:
    """Everything that is drawn, in the order in which the viewer must read it; the first motion's arm is solid."""
    start = min(float(one.times[0]) for one in group)
    fastest = max(float(one.speed.max()) for one in group)
    animation = Animation()
    commands = _surroundings()
    for k, one in enumerate(group):
        root, ghost = f"{_ROOT}/motion{k}", None if k == 0 else profile_colour(k)
        # A ghost stands on the solid arm's base.
        shared = k > 0 and one.assessment.motion.robot.geometry is group[0].assessment.motion.robot.geometry
        commands += _arm(one, f"{root}/arm", ghost, animation, start, draw_base=not shared)
        commands += _markers(one, root, profile_colour(k), fastest)
    # The page has a clock of its own, which the time lines of a report share.
    commands.append(SetAnimation(animation, play=False))
    # Half the size; the viewer holds key frames in single precision anyhow.
    return tuple(umsgpack.packb(command.lower(), force_float_precision="single") for command in commands)


def _places(robot: Robot, q: Array) -> Array:
    return np.asarray(forward_kinematics(robot, q)[:, :3, 3]) if len(q) else np.empty((0, 3))


def _joint_places(robot: Robot, q: Array) -> Array:
    """Origins of all joints, the base included, in the world, shape (k, 3)."""
    data = robot.model.createData()
    places = []
    for row in robot.configurations(q):
        pin.forwardKinematics(robot.model, data, row)
        places += [placement.translation.copy() for placement in data.oMi]
    return np.array(places)


def _surroundings() -> list[Any]:
    """Nothing of Meshcat's: floor, light and axes are the page's own."""
    return [SetProperty("visible", False, Path().append(f"/{name}")) for name in ("Axes", "Grid", "Background")]


def _arm(
    one: Shown, root: str, ghost: Sequence[float] | None, animation: Animation, start: float, *, draw_base: bool
) -> list[Any]:
    """Links, sticks where there are none, payload; all of it hanging on the joints that the animation moves."""
    motion = one.assessment.motion
    robot = motion.robot
    model, paths = robot.model, joint_paths(robot.model, root)
    data = model.createData()
    pin.forwardKinematics(model, data, robot.configurations(motion.trajectory(one.times[:1]))[0])
    commands: list[Any] = [
        SetTransform(data.liMi[k].homogeneous, Path().append(paths[k])) for k in range(1, model.njoints)
    ]
    add_joints(animation, root, motion, one.times, start)
    columns = {model.getJointId(name): j for j, name in enumerate(robot.joint_names)}
    for n, (joint, place, (solid, inner), smooth) in enumerate(_solids(robot, one.path)):
        if joint == 0 and not draw_base:
            continue
        path = f"{paths[joint]}/shape{n}"
        used = one.used[:, columns[joint]] if joint in columns else np.full(len(one.times), np.nan)
        colour = colour_at(UTILISATION, used[:1])[0] if ghost is None else ghost
        commands += _object(path, solid, place @ inner, _surface(colour, flat=not smooth, ghost=ghost is not None))
        if ghost is None:
            add_colours(animation, path, used, one.times, start)
    frame = model.frames[robot.tool_id]
    tool = f"{paths[frame.parentJoint]}/tool"
    commands.append(SetTransform(frame.placement.homogeneous, Path().append(tool)))
    colour = _PAYLOAD if ghost is None else ghost
    for k, (payload, there) in enumerate(_payloads(motion)):
        commands += _object(f"{tool}/payload{k}", *_payload_body(payload), _surface(colour, ghost=ghost is not None))
        add_presence(animation, f"{tool}/payload{k}", motion.parts, there, float(one.times[0]) - start)
    return commands


def _payloads(motion: Motion) -> list[tuple[Payload, list[bool]]]:
    """Everything that the arm carries along a motion, each with whether it does so in each of the motion's parts."""
    carried = [part.robot.payload for part in motion.parts or (motion,)]
    every = {_facts(payload): payload for payload in carried if payload is not None and payload.mass > 0}
    there = {key: [other is not None and _facts(other) == key for other in carried] for key in every}
    return [(payload, there[key]) for key, payload in every.items()]


def _facts(payload: Payload) -> tuple[float, ...]:
    return (payload.mass, *payload.com, *np.ravel(payload.inertia))


def _solids(robot: Robot, path: Array) -> list[tuple[int, Array, Placed, bool]]:
    """Joint, placement, geometry and whether it is smooth, for each part of the arm."""
    parts = [
        (int(shape.parentJoint), shape.placement.homogeneous, placed, not hasattr(shape.geometry, "num_tris"))
        for shape in robot.visual_model.geometryObjects
        for placed in placed_shapes(shape)
    ]
    return parts or _sticks(robot, _STICK * _reach(path))


def _sticks(robot: Robot, radius: float) -> list[tuple[int, Array, Placed, bool]]:
    """A body for an arm without shapes: from each joint to the next one and to the tool."""
    model = robot.model
    frame = model.frames[robot.tool_id]
    ends = [(int(model.parents[k]), model.jointPlacements[k].translation) for k in range(1, model.njoints)]
    parts = []
    for joint, end in [*ends, (int(frame.parentJoint), frame.placement.translation)]:
        length = float(np.linalg.norm(end))
        parts.append((joint, np.eye(4), (mc.Sphere(1.3 * radius), np.eye(4)), True))
        if length > radius:
            place = np.eye(4)
            place[:3, :3] = pin.Quaternion.FromTwoVectors(np.array([0.0, 0, 1]), end / length).toRotationMatrix()
            place[:3, 3] = end / 2
            parts.append((joint, place, (mc.Cylinder(length, radius), rotated_y_to_z()), True))
    return parts


def _payload_body(payload: Payload) -> Placed:
    """The box of even density that has the payload's inertia; a ball where only the mass is known."""
    place = np.eye(4)
    place[:3, 3] = payload.com
    moments, axes = np.linalg.eigh(payload.inertia)
    squares = 6.0 * (moments.sum() - 2.0 * moments) / payload.mass
    if moments[-1] <= 0.0:
        return mc.Sphere(float((payload.mass / _ALUMINIUM * 0.75 / np.pi) ** (1 / 3))), place
    place[:3, :3] = axes * np.sign(np.linalg.det(axes))
    return mc.Box(np.sqrt(np.maximum(squares, 1e-6)).tolist()), place


def _markers(one: Shown, root: str, colour: Sequence[float], fastest: float) -> list[Any]:
    """The path in the colour of its motion, thicker where it is faster; its via points and its flags."""
    reach = _reach(one.path)
    share = one.speed / fastest if fastest > 0 else one.speed
    line = tube(one.path, (_THIN + (1.0 - _THIN) * share) * _TUBE * reach)
    commands: list[Any] = []
    if line is not None:
        # Unlit, so that the colour is that of the curves in all charts.
        commands += _object(f"{root}/path", line, np.eye(4), mc.MeshBasicMaterial(color=_number(colour)))
    for k, place in enumerate(one.vias):
        commands += _object(f"{root}/vias/{k}", mc.Sphere(0.7 * _MARKER * reach), _at(place), _surface(_VIA))
    for k, (flag, place) in enumerate(zip(one.flags, one.flag_places, strict=True)):
        if flag.kind == "limit":
            solid, hue = octahedron(1.5 * _MARKER * reach), _LIMIT
        else:
            solid, hue = mc.Box([1.7 * _MARKER * reach] * 3), _SINGULAR
        commands += _object(f"{root}/flags/{k}", solid, _at(place), _surface(hue, flat=True))
    return commands


def _reach(path: Array) -> float:
    """A length to size markers by: how far from the base the tool goes, at least 0.1 m."""
    return max(0.1, float(np.linalg.norm(path, axis=1).max()))


def _at(place: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, 3] = place
    return matrix


def _surface(colour: Sequence[float], *, flat: bool = False, ghost: bool = False) -> Any:
    """Without gloss, so that a colour keeps its hue in the light; `flat` keeps the edges of a mesh.

    A ghost is drawn behind what stands in the same place: neither flickers, and the solid arm keeps its colour.
    """
    return mc.MeshPhongMaterial(
        color=_number(colour),
        opacity=_GHOST_OPACITY if ghost else 1.0,
        depthWrite=not ghost,
        polygonOffset=ghost,
        polygonOffsetFactor=2,
        polygonOffsetUnits=2,
        specular=0,
        flatShading=flat,
    )


def _number(colour: Sequence[float]) -> int:
    red, green, blue = (round(255 * channel) for channel in colour)
    return red << 16 | green << 8 | blue


def _object(path: str, solid: Any, place: Array, material: Any) -> list[Any]:
    """Commands for one thing; its identifiers come from its path, so that the same scene is the same file."""
    thing = mc.Mesh(solid, material)
    thing.uuid, solid.uuid, material.uuid = path, f"{path}/geometry", f"{path}/material"
    where = Path().append(path)
    return [SetObject(thing, path=where), SetTransform(place, where)]
