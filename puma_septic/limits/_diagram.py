"""The payload diagram of a data sheet: mass against the distance of its centre from the flange."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.document import card, one_line
from puma_septic.dynamics import check_inertia, payload_torque, rigid_torque
from puma_septic.errors import InputError, NoSolution
from puma_septic.kinematics import checked_joint_values
from puma_septic.limits._payload import maximum_payload
from puma_septic.motion import Motion
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_array, checked_direction, checked_list, read_only

__all__ = ["PayloadPolygon", "payload_diagram", "payload_polygon"]

# A corner is cut off only where it lies outside by more than this part of the polygon.
_ROUNDING: Final = 1e-13


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PayloadPolygon:
    """Point masses that an arm can hold in each of some poses; made by `payload_polygon`.

    Attributes
    ----------
    corners : ndarray, shape (k, 2)
        Of the polygon of (mass, mass times offset) in kg and kg m, counter-clockwise.
    governing : tuple of (int, str)
        Pose and joint of the edge that leaves each corner; (-1, "") of an axis.
    """

    corners: Array
    governing: tuple[tuple[int, str], ...]

    def mass(self, offset: ArrayLike) -> Array:
        """The most that can be held with its centre at each of some distances, kg.

        Parameters
        ----------
        offset : array_like, shape (n,)
            m, at least 0.

        Returns
        -------
        ndarray, shape (n,)

        Raises
        ------
        InputError
            For a negative offset.
        """
        d = checked_array("offset", offset, (None,), unit="m", at_least=0.0, remedy="; turn the direction instead")
        x, y = self.corners.T
        following = np.roll(self.corners, -1, axis=0)
        # Where the ray y = d x crosses each edge.
        side = y[:, None] - x[:, None] * d
        other = following[:, 1:] - following[:, :1] * d
        with np.errstate(divide="ignore", invalid="ignore"):
            share = side / (side - other)
        crossing = np.where((share >= 0) & (share <= 1), x[:, None] + share * (following[:, :1] - x[:, None]), 0.0)
        return np.asarray(np.fmax(crossing, np.where(np.abs(side) <= 0, x[:, None], 0.0)).max(axis=0))

    def __repr__(self) -> str:
        return one_line("PayloadPolygon", self._facts())

    def _repr_html_(self) -> str:
        return card("PayloadPolygon", self._facts())

    def _facts(self) -> dict[str, object]:
        return {"corners": len(self.corners), "governing": ", ".join(dict.fromkeys(map(str, self.governing)))}


def payload_polygon(robot: Robot, q: ArrayLike, *, direction: ArrayLike = (0.0, 0.0, 1.0)) -> PayloadPolygon:
    """The point masses that an arm can hold at rest in all of some poses, without the help of static friction.

    With its centre at the distance d from the tool's origin a mass m adds ``m a_j(q) + m d b_j(q)`` to the torque of
    joint j: in the plane of m and ``m d`` each torque limit of each pose is a half-plane, and what is left a convex
    polygon, exactly.

    Parameters
    ----------
    robot : Robot
        What it carries is left out.
    q : array_like, shape (n, n_joints)
        Poses, rad (m).
    direction : array_like, shape (3,)
        Of the offset, in the tool frame.

    Returns
    -------
    PayloadPolygon

    Raises
    ------
    InputError
        For a direction of no length, or where no known limit bears the payload.
    NoSolution
        Where the arm does not even hold itself.

    Examples
    --------
    >>> import puma_septic as ps
    >>> polygon = ps.payload_polygon(ps.load_robot(), [[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]], direction=(1, 0, 0))
    >>> polygon.mass([0.0, 0.2]).round(3).tolist()
    [13.419, 5.097]
    """
    poses = checked_joint_values(robot, "q", q)
    axis = checked_direction("direction", direction)
    check_inertia(robot)
    rest = np.zeros_like(poses)
    own = rigid_torque(robot.with_payload(None), poses, rest, rest)
    weight = payload_torque(robot, np.array([1.0, *np.zeros(9)]))(poses, rest, rest)
    moment = payload_torque(robot, np.array([1.0, *axis, *np.zeros(6)]))(poses, rest, rest) - weight
    known = ~np.isnan(robot.limits.effort)
    limit = np.broadcast_to(robot.limits.effort, own.shape)
    if not (np.abs(own) <= limit)[:, known].all():
        k, j = np.argwhere(~(np.abs(own) <= limit) & known)[0]
        raise NoSolution(
            f"pose {k}: {robot.joint_names[j]} needs {abs(own[k, j]):.4g} N m to hold the arm alone, its limit is"
            f" {limit[k, j]:.4g} N m",
            residual=float(abs(own[k, j]) - limit[k, j]),
            q=poses[k],
        )
    planes = np.stack([weight, moment, own], axis=-1)[:, known] / limit[:, known, None]
    return _polygon(planes, [name for name, is_known in zip(robot.joint_names, known, strict=True) if is_known])


def _polygon(planes: Array, names: Sequence[str]) -> PayloadPolygon:
    """What ``abs(a m + b s + c) <= 1`` leaves of the quadrant, planes (n, joints, 3)."""
    n_joints = planes.shape[1]
    rows = planes.reshape(-1, 3)
    sides = [(sign * a, sign * b, 1 - sign * c, k) for sign in (1, -1) for k, (a, b, c) in enumerate(rows.tolist())]
    largest = 1e9
    corners = [(0.0, 0.0), (largest, 0.0), (largest, largest), (0.0, largest)]
    edges = [-1, -1, -1, -1]
    for a, b, c, k in sides:
        corners, edges = _clipped(corners, edges, (a, b, c), k)
    if max(max(corner) for corner in corners) >= largest:
        raise InputError("no joint with a known torque limit bears the payload in these poses: any mass will do")
    governing = tuple((k // n_joints, names[k % n_joints]) if k >= 0 else (-1, "") for k in edges)
    return PayloadPolygon(corners=read_only(corners), governing=governing)


def _clipped(
    corners: list[tuple[float, float]], edges: list[int], plane: tuple[float, float, float], k: int
) -> tuple[list[tuple[float, float]], list[int]]:
    """The part of a convex polygon with ``a x + b y <= c`` (Sutherland and Hodgman 1974); its new edge is called k."""
    a, b, c = plane
    excess = [a * x + b * y - c for x, y in corners]
    if max(excess) <= _ROUNDING * abs(c):
        return corners, edges
    kept: list[tuple[float, float]] = []
    names: list[int] = []
    for i, (x, y) in enumerate(corners):
        following = (i + 1) % len(corners)
        here, there = excess[i], excess[following]
        if here <= 0:
            kept.append((x, y))
            names.append(edges[i] if there <= 0 or here < 0 else k)
        if (here < 0 < there) or (there < 0 < here):
            share = here / (here - there)
            (u, v) = corners[following]
            kept.append((x + share * (u - x), y + share * (v - y)))
            names.append(k if here < 0 else edges[i])
    return kept, names


def payload_diagram(
    motions: Motion | Sequence[Motion], offsets: ArrayLike, *, direction: ArrayLike = (0.0, 0.0, 1.0)
) -> Array:
    """The heaviest point mass that all of some motions can carry, for each distance of its centre from the tool.

    Parameters
    ----------
    motions : Motion or sequence of Motion
    offsets : array_like, shape (n,)
        m.
    direction : array_like, shape (3,)
        Of the offset, in the tool frame.

    Returns
    -------
    ndarray, shape (n,)
        kg, exact; 0 where there is none.

    Raises
    ------
    InputError
        As `maximum_payload`, and for no motion at all.
    """
    some = (motions,) if isinstance(motions, Motion) else checked_list("motions", motions)
    if not some:
        raise InputError("motions: at least one is needed")
    distances = checked_array("offsets", offsets, (None,), unit="m")
    axis = checked_direction("direction", direction)
    return np.array([min(_heaviest(motion, axis * distance) for motion in some) for distance in distances])


def _heaviest(motion: Motion, com: Array) -> float:
    try:
        return maximum_payload(motion, com=com, gyration=np.zeros((3, 3))).mass
    except NoSolution:
        return 0.0
