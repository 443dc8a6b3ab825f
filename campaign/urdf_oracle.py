"""Is a robot what its text says? Every link's place, every body, inertia, torque and limit against a second reading."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
import pinocchio as pin

import puma_septic as ps
from campaign.mechanics import Arm, joined, mass_matrix_and_torque
from campaign.rules import UnsoundError
from campaign.urdf_text import MOVING, Body, Joint, Text, UnreadableError, limit, read

POSES: Final = 5
# Relative to the sum of the magnitudes of all terms: some hundred operations' rounding, and what two ways of reading
# angles of four digits cost; an inertia that is lost is larger by many powers of ten.
CLOSE: Final = 1e-9
TINY: Final = 1e-300  # kg m: numbers below it lose their digits
CLEARLY: Final = 1e-6  # of a matrix with unit diagonal, and kg m^2: well above what is taken for no inertia


def check_robot(robot: ps.Robot, data: bytes, held: Mapping[str, float]) -> None:
    """Hold a robot that was loaded without an actuator file against the bytes of its URDF.

    Parameters
    ----------
    held : mapping of str to float
        Joints that it was loaded with locked, and where.
    """
    try:
        text = read(data)
    except ET.ParseError as error:
        if "unbound prefix" in str(error):  # a namespace that is not declared; nothing that is read stands in one
            return
        raise UnsoundError(f"no XML: accepted, though {error}") from error
    except UnreadableError as error:
        raise UnsoundError(f"unclear: accepted, though {error}") from error
    arm = Arm(text, tuple(name for name in text.own if name not in held), dict(held))
    if tuple(robot.joint_names) != arm.own:
        raise UnsoundError(f"joints: {robot.joint_names}, the text has {arm.own}")
    bodies = _used_bodies(robot, text, arm)
    _check_bodies(robot, arm, bodies)
    _check_limits(robot, arm)
    rng = np.random.default_rng(len(data))
    for _ in range(POSES):
        _check_pose(robot, arm, bodies, rng)


def _used_bodies(robot: ps.Robot, text: Text, arm: Arm) -> dict[str, Body]:
    """The bodies that must be in the model: those that are sound, and those that the robot does not call unusable."""
    used = {}
    for link, body in text.bodies.items():
        is_left_out = link in robot.unusable_inertia
        if isinstance(body, str) and not is_left_out and _moves(link, arm):
            raise UnsoundError(f"inertia that is none: used of link {link!r}, though {body}")
        if isinstance(body, Body) and body.is_sound and is_left_out:
            raise UnsoundError(f"inertia left out: of link {link!r}, a body's")
        if isinstance(body, Body) and not is_left_out:
            used[link] = body
    return used


def _moves(link: str, arm: Arm) -> bool:
    above = {joint.child: joint for joint in arm.text.joints.values()}
    while link in above:
        if above[link].kind != "fixed":
            return True
        link = above[link].parent
    return False


def _check_bodies(robot: ps.Robot, arm: Arm, bodies: dict[str, Body]) -> None:
    """Mass, centre and tensor of every body of the model, with all that is fixed to it, against the text's numbers."""
    rest = np.zeros(len(arm.own))
    places = {link: moving.place for link, moving in arm.motion(rest, rest, rest).items()}
    carried = _carriers(arm)
    for joint in arm.text.joints.values():
        if joint.kind == "fixed" or arm.coordinate(joint)[0] is None:
            continue
        back = np.linalg.inv(places[joint.child])
        parts = [(back @ places[link], body) for link, body in bodies.items() if carried[link] == joint.name]
        _compare_body(robot.bare_model.inertias[robot.bare_model.getJointId(joint.name)], joined(parts), joint.child)


def _carriers(arm: Arm) -> dict[str, str]:
    """The moving joint that each link is fixed to, "" for the base."""
    carried = dict.fromkeys(arm.text.bodies, "")
    for name in arm.text.order:
        joint = arm.text.joints[name]
        carried[joint.child] = carried[joint.parent] if arm.coordinate(joint)[0] is None else name
    return carried


def _compare_body(read_in: pin.Inertia, said: tuple[float, np.ndarray, np.ndarray, float], link: str) -> None:
    mass, first, tensor, size = said
    c = np.array(read_in.lever)
    about_origin = np.array(read_in.inertia) + read_in.mass * (c @ c * np.eye(3) - np.outer(c, c))
    if abs(read_in.mass - mass) > CLOSE * mass:
        raise UnsoundError(f"mass: of link {link!r} {read_in.mass!r} kg, the text has {mass!r}")
    if np.abs(about_origin - tensor).max() > CLOSE * size:
        raise UnsoundError(f"inertia: of link {link!r} {about_origin.tolist()} kg m^2, the text has {tensor.tolist()}")
    if np.abs(read_in.mass * c - first).max() > CLOSE * (np.sqrt(mass * size) + np.abs(first).max()) + TINY:
        raise UnsoundError(
            f"centre: of link {link!r} {(read_in.mass * c).tolist()} kg m, the text has {first.tolist()}"
        )


def _check_limits(robot: ps.Robot, arm: Arm) -> None:
    for k, name in enumerate(arm.own):
        joint = arm.text.joints[name]
        lower, upper = limit(joint, "lower"), limit(joint, "upper")
        if joint.kind == "continuous" or lower == upper:
            lower = upper = np.nan
        if lower > upper:
            raise UnsoundError(f"limits: of joint {name!r} are swapped, {lower!r} to {upper!r}")
        speed, effort = (value if value > 0 else np.nan for value in (limit(joint, "velocity"), limit(joint, "effort")))
        _same(f"position limit of {name!r}", robot.limits.position[k], _range_with_followers(arm, joint, lower, upper))
        followers = [(limit(one, "velocity"), factor) for one, factor, _ in _followers(arm, name)]
        speed = np.fmin.reduce([speed, *(own / abs(factor) for own, factor in followers if own > 0)])
        _same(f"velocity limit of {name!r}", robot.limits.velocity[k], speed)
        _same(f"effort limit of {name!r}", robot.limits.effort[k], effort)


def _followers(arm: Arm, name: str) -> Iterator[tuple[Joint, float, float]]:
    """Joints that mimic one, each with its multiplier and offset."""
    for joint in arm.text.joints.values():
        if joint.mimic is not None and joint.mimic[0] == name and joint.mimic[1] and joint.kind in MOVING:
            yield joint, joint.mimic[1], joint.mimic[2]


def _range_with_followers(arm: Arm, joint: Joint, lower: float, upper: float) -> tuple[float, float]:
    """The positions at which all that mimic a joint are in their own limits; one that leaves none is left out."""
    for one, factor, offset in _followers(arm, joint.name):
        ends = limit(one, "lower"), limit(one, "upper")
        if one.kind == "continuous" or ends[0] == ends[1] or (joint.kind == "continuous"):
            continue
        low, high = sorted((end - offset) / factor for end in ends)
        narrowed = float(np.fmax(low, lower)), float(np.fmin(high, upper))
        lower, upper = narrowed if narrowed[0] < narrowed[1] else (lower, upper)
    return lower, upper


def _same(what: str, value: object, said: object) -> None:
    # A follower's limit is told to 1e-9 of the range.
    if not np.allclose(
        np.asarray(value, dtype=float), np.asarray(said, dtype=float), rtol=2e-9, atol=1e-12, equal_nan=True
    ):
        raise UnsoundError(f"limits: {what} is {value}, the text has {said}")


def _check_pose(robot: ps.Robot, arm: Arm, bodies: dict[str, Body], rng: np.random.Generator) -> None:
    n = len(arm.own)
    low, high = np.clip(np.where(np.isnan(robot.limits.position), [-3.0, 3.0], robot.limits.position), -3, 3).T
    q = rng.uniform(low, np.maximum(low, high))
    v, a = rng.normal(size=n), rng.normal(size=n)
    links = arm.motion(q, v, a)
    model = robot.model
    data, place = model.createData(), robot.configurations(q[None, :])[0]
    pin.framesForwardKinematics(model, data, place)
    far = max(1.0, *(float(np.abs(link.place[:3, 3]).max()) for link in links.values()))
    for link, moving in links.items():
        T = data.oMf[model.getFrameId(link, pin.FrameType.BODY)].homogeneous
        if not np.abs(T - moving.place).max() <= CLOSE * far:
            raise UnsoundError(
                f"place: of link {link!r} at q = {q.tolist()} {T.tolist()}, the text has {moving.place.tolist()}"
            )
    matrix, torque, _, effort = mass_matrix_and_torque(links, bodies)
    if robot.missing_inertia:
        if _least(matrix) > CLEARLY and (np.diag(matrix) > CLEARLY).all() and not robot.unusable_inertia:
            raise UnsoundError(f"torque withheld: of {robot.missing_inertia}, though all bodies are sound")
        return
    matrix, torque = matrix + np.diag(robot.armature), torque + robot.armature * a
    effort, least = effort + robot.armature * np.abs(a), _least(matrix)
    if not least > 0:
        raise UnsoundError(f"joint-space inertia: not positive definite at q = {q.tolist()}")
    tau = ps.inverse_dynamics(robot, q, v, a, friction=False)
    if not (np.abs(tau - torque) <= CLOSE * effort).all():
        raise UnsoundError(f"torque: at q = {q.tolist()} {tau.tolist()}, the text has {torque.tolist()}")
    gained = ps.forward_dynamics(robot, q, v, torque, friction=False)
    if not (np.abs(matrix @ (gained - a)) <= CLOSE * effort / least).all():
        raise UnsoundError(f"acceleration: at q = {q.tolist()} {gained.tolist()}, the text has {a.tolist()}")


def _least(matrix: np.ndarray) -> float:
    """The smallest eigenvalue of the matrix scaled to a unit diagonal."""
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    return float(np.linalg.eigvalsh(matrix / np.outer(scale, scale))[0])
