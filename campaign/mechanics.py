"""Mechanics of a tree of rigid bodies in plain NumPy, in world axes: places, Jacobians, joint-space inertia, torque.

Kane's equations: each body's rate of momentum, weight included, times its partial velocities. Nothing of the package
nor of Pinocchio is used here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from campaign.urdf_text import Body, Joint, Text

GRAVITY: Final = np.array([0.0, 0.0, -9.81])  # m/s^2, what load_robot takes where nothing is said


@dataclass(frozen=True)
class Moving:
    """A link in motion: its place, twist and accelerations, and their derivatives by the joints' velocities."""

    place: np.ndarray
    omega: np.ndarray
    alpha: np.ndarray
    acceleration: np.ndarray
    turning: np.ndarray  # (3, n)
    moving: np.ndarray  # (3, n), of the link's origin


@dataclass(frozen=True)
class Arm:
    """A text with the coordinates of its joints: `own` in order; `held` are joints locked at a position."""

    text: Text
    own: tuple[str, ...]
    held: dict[str, float]

    def motion(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> dict[str, Moving]:
        """Every link's motion at joint positions, velocities and accelerations, shape (n,)."""
        n = len(self.own)
        children = {joint.child for joint in self.text.joints.values()}
        still = Moving(np.eye(4), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros((3, n)), np.zeros((3, n)))
        links = {link: still for link in self.text.bodies if link not in children}
        for name in self.text.order:
            joint = self.text.joints[name]
            links[joint.child] = self._moved(joint, links[joint.parent], (q, v, a))
        return links

    def coordinate(self, joint: Joint) -> tuple[str | None, float, float]:
        """Which own joint moves this one, by which factor, and its offset; None where nothing does."""
        if joint.kind == "fixed":
            return None, 0.0, 0.0
        name, factor, offset = joint.mimic or (joint.name, 1.0, 0.0)
        if joint.name in self.held:
            return None, 0.0, self.held[joint.name]
        if name in self.held:
            return None, 0.0, factor * self.held[name] + offset
        if self.text.joints[name].kind == "fixed":
            return None, 0.0, offset
        return name, factor, offset

    def _moved(self, joint: Joint, parent: Moving, at: tuple[np.ndarray, np.ndarray, np.ndarray]) -> Moving:
        name, factor, offset = self.coordinate(joint)
        row = np.zeros(len(self.own))
        if name is not None:
            row[self.own.index(name)] = factor
        position, speed, push = row @ at[0] + offset, row @ at[1], row @ at[2]
        place = parent.place @ joint.place
        axis = place[:3, :3] @ joint.axis
        slides = joint.kind == "prismatic"
        if slides:
            place[:3, 3] += axis * position
        else:
            place[:3, :3] = turn(axis, position) @ place[:3, :3]
        arm, omega = place[:3, 3] - parent.place[:3, 3], parent.omega
        acceleration = parent.acceleration + np.cross(parent.alpha, arm) + np.cross(omega, np.cross(omega, arm))
        moving = parent.moving + np.cross(parent.turning, arm, axisa=0).T
        if slides:
            acceleration = acceleration + 2 * np.cross(omega, axis * speed) + axis * push
            return Moving(
                place, omega, parent.alpha, acceleration, parent.turning, moving + np.outer(axis, row)
            )  # fmt: skip
        alpha = parent.alpha + np.cross(omega, axis * speed) + axis * push
        return Moving(place, omega + axis * speed, alpha, acceleration, parent.turning + np.outer(axis, row), moving)


def mass_matrix_and_torque(
    links: dict[str, Moving], bodies: dict[str, Body]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """``M`` (n, n), torque (n,), and the sums of the magnitudes of their terms, by which differences are judged."""
    n = next(iter(links.values())).turning.shape[1]
    matrix, torque, size, effort = np.zeros((n, n)), np.zeros(n), np.zeros((n, n)), np.zeros(n)
    far = max((np.linalg.norm(link.place[:3, 3]) for link in links.values()), default=0.0)
    for name, body in bodies.items():
        link = links[name]
        R = link.place[:3, :3]
        arm, tensor = R @ body.com, R @ body.inertia @ R.T
        moving = link.moving + np.cross(link.turning, arm, axisa=0).T
        swing = np.cross(link.omega, arm)
        force = body.mass * (link.acceleration + np.cross(link.alpha, arm) + np.cross(link.omega, swing) - GRAVITY)
        moment = tensor @ link.alpha + np.cross(link.omega, tensor @ link.omega)
        matrix += body.mass * moving.T @ moving + link.turning.T @ tensor @ link.turning
        torque += moving.T @ force + link.turning.T @ moment
        # Levers as long as the arm, for what cancels on the way through its joints.
        lever = np.linalg.norm(link.turning, axis=0) * (far + np.linalg.norm(arm)) + np.linalg.norm(moving, axis=0)
        spin, stiff = np.linalg.norm(link.turning, axis=0), np.linalg.norm(tensor)
        size += body.mass * np.outer(lever, lever) + stiff * np.outer(spin, spin)
        rates = np.linalg.norm(link.alpha) + np.linalg.norm(link.omega) ** 2
        pushes = np.linalg.norm(link.acceleration) + 9.81 + rates * (far + np.linalg.norm(arm))
        effort += lever * body.mass * pushes + spin * stiff * rates
    return matrix, torque, size, effort


def turn(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' rotation about a unit axis."""
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def joined(parts: list[tuple[np.ndarray, Body]]) -> tuple[float, np.ndarray, np.ndarray, float]:
    """Mass, first moment and tensor about the origin of bodies at places (4, 4), and the size of what is summed."""
    mass, first, tensor, size = 0.0, np.zeros(3), np.zeros((3, 3)), 0.0
    for place, body in parts:
        R = place[:3, :3]
        c = R @ body.com + place[:3, 3]
        mass += body.mass
        first += body.mass * c
        tensor += R @ body.inertia @ R.T + body.mass * (c @ c * np.eye(3) - np.outer(c, c))
        far = np.linalg.norm(body.com) + np.linalg.norm(place[:3, 3])
        size += np.linalg.norm(body.inertia) + body.mass * far**2
    return mass, first, tensor, size
