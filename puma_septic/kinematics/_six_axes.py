"""Six axes that have a closed form, recognised by where they lie: a spherical wrist, or three parallel axes.

Both kinds have a plane that axis 1 turns: axes 2 and 3 are at right angles to it, so that joints 2 and 3 move the wrist
in it. Axes 4, 5 and 6 meet in one point (most industrial arms), or axis 4 is parallel to 2 and 3 and axis 6 meets
axis 5 (Universal Robots and their like). Whether axes are at right angles elsewhere does not matter.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Literal, final

import numpy as np

from puma_septic.kinematics._chain import Chain
from puma_septic.validation import Array, read_only

__all__ = ["BRANCHES", "SixAxes", "six_axes"]

BRANCHES: Final = (2, 2, 2)
# Axes as far as this from meeting or from being parallel are taken for it (m, rad), and the answers are polished on the
# model: files have right angles of 1.571 rad, and calibrated arms differ from their drawing by some 1e-4 m.
NEARLY: Final = 3e-3
# Sine of the least angle between axes that must not be parallel, and the shortest link, m.
_LEAST_ANGLE: Final = 0.1
_SHORTEST: Final = 1e-3
# An offset below this, m, tells nothing about left and right.
_NO_OFFSET: Final = 1e-6


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SixAxes:
    """An arm whose branches have a closed form, all in world coordinates with every joint at zero.

    Attributes
    ----------
    kind : str
    axes : ndarray, shape (6, 3)
        Directions; axes that count as parallel have the same direction, or the opposite one.
    shoulder : ndarray, shape (3,)
        Of the points where axis 2 crosses the arm's plane, from `base`.
    base : ndarray, shape (3,)
        A point on axis 1.
    upper, fore : ndarray, shape (3,)
        In the arm's plane: from axis 2 to axis 3, and on to the wrist centre (to axis 4 where three are parallel), m.
    hand : ndarray, shape (3,)
        In the arm's plane: from axis 4 to the wrist centre where three are parallel, m.
    centre : ndarray, shape (3,)
        Where the last axes meet.
    undo : ndarray, shape (4, 4)
        From the tool to the world, at zero.
    offset : float
        From axis 1 to the arm's plane, along axis 2, m.
    forward : int
        The sign of a wrist centre's way along ``axis 1 x axis 2`` in the first of the two arms.
    elbow : int
        The sign of the elbow's turn about axis 2 that is called up in the first of the two arms.
    arms : tuple of str
        How the two are called.
    deviation : float
        How far the model is from this pattern, m or rad.
    """

    kind: Literal["spherical wrist", "three parallel axes"]
    axes: Array
    base: Array
    shoulder: Array
    upper: Array
    fore: Array
    hand: Array
    centre: Array
    undo: Array
    offset: float
    forward: int
    elbow: int
    arms: tuple[str, str]
    deviation: float

    @property
    def configurations(self) -> tuple[str, ...]:
        """Names of the eight branches."""
        return tuple(f"{a}-{e}-{w}" for a in self.arms for e in ("up", "down") for w in ("noflip", "flip"))

    @property
    def doubt(self) -> Array:
        """Room at shoulder, elbow and wrist that the model's deviation may add or take away, with a factor of ten."""
        upper, fore = float(np.linalg.norm(self.upper)), float(np.linalg.norm(self.fore))
        scale = np.array([abs(self.offset) + self.deviation, (upper + fore) / (upper * fore), 1.0])
        return np.asarray(20.0 * self.deviation * scale)


def six_axes(chain: Chain) -> SixAxes | None:
    """Recognise a chain of six revolute joints; None where it has no closed form of these kinds."""
    if len(chain.placements) != 6 or any(chain.prismatic) or chain.is_coupled:
        return None
    axes, points, tool = _axes_at_zero(chain)
    if min(_sine(axes[k], axes[k + 1]) for k in (0, 3, 4)) < _LEAST_ANGLE:
        return None
    for kind, parallel, meeting in (("spherical wrist", (1, 2), (3, 4, 5)), ("three parallel axes", (1, 2, 3), (4, 5))):
        centre, apart = _meeting_point(axes[list(meeting)], points[list(meeting)])
        deviation = max(apart, *(_sine(axes[1], axes[k]) for k in parallel[1:]))
        if deviation <= NEARLY:
            arm = _arm(kind, axes, points, centre, tool, deviation)  # type: ignore[arg-type]
            return arm if min(np.linalg.norm(arm.upper), np.linalg.norm(arm.fore)) > _SHORTEST else None
    return None


def _arm(
    kind: Literal["spherical wrist", "three parallel axes"],
    axes: Array,
    points: Array,
    centre: Array,
    tool: Array,
    deviation: float,
) -> SixAxes:
    """Lengths and names of an arm whose axes lie as its kind says."""
    axes, count = axes.copy(), 3 if kind == "spherical wrist" else 4
    normal = axes[1]
    for k in range(2, count):
        axes[k] = np.copysign(1.0, axes[k] @ normal) * normal
    # Where axes 2, 3 (and 4) cross the plane at right angles to them in which the wrist centre lies.
    crossings = [points[k] + axes[k] * ((centre - points[k]) @ normal / (axes[k] @ normal)) for k in range(1, count)]
    joints = [*crossings, centre]
    links = [_across(normal, end - start) for start, end in pairwise(joints)]
    base = points[0] + axes[0] * ((joints[0] - points[0]) @ axes[0])
    shoulder, offset = joints[0] - base, float((centre - base) @ normal)
    # Up is away from the foot of the arm, however axis 1 points; forward is then to the right of axis 2, seen from it.
    up = -1 if base @ axes[0] < -_NO_OFFSET else 1
    ahead = up * float(shoulder @ np.cross(axes[0], normal))
    arms, side = _sides(offset, ahead)
    return SixAxes(
        kind=kind,
        axes=read_only(axes),
        base=read_only(base),
        shoulder=read_only(shoulder),
        upper=read_only(links[0]),
        fore=read_only(links[1]),
        hand=read_only(links[2] if count == 4 else np.zeros(3)),
        centre=read_only(centre),
        undo=read_only(np.linalg.inv(tool)),
        offset=offset,
        forward=up * side,
        elbow=-side,
        arms=arms,
        deviation=deviation,
    )


def _sides(offset: float, ahead: float) -> tuple[tuple[str, str], int]:
    """Names of the two arms, and the sign of the first one's way forward.

    A right arm passes axis 1 on the right, seen from the axis towards the wrist centre. Without an offset the front
    arm has the wrist on the side where axis 2 lies, or, where that meets axis 1, to which joint 2 leans the arm.
    """
    if abs(offset) > _NO_OFFSET:
        return ("right", "left"), 1 if offset > 0 else -1
    return ("front", "back"), 1 if ahead > _NO_OFFSET else -1


def _axes_at_zero(chain: Chain) -> tuple[Array, Array, Array]:
    """Directions and points of the axes, each (6, 3), and the tool's pose, with every joint at zero."""
    frame, axes, points = np.eye(4), [], []
    for placement in chain.placements:
        frame = frame @ placement
        axes.append(frame[:3, 2])
        points.append(frame[:3, 3])
    return np.array(axes), np.array(points), frame @ chain.end


def _meeting_point(axes: Array, points: Array) -> tuple[Array, float]:
    """The point that comes nearest to all axes, and how far it is from the farthest of them."""
    across = np.eye(3) - axes[:, :, None] * axes[:, None, :]
    point = np.linalg.lstsq(across.reshape(-1, 3), np.einsum("kij,kj->ki", across, points).ravel(), rcond=None)[0]
    return point, float(np.linalg.norm(np.einsum("kij,kj->ki", across, point - points), axis=1).max())


def _across(normal: Array, vector: Array) -> Array:
    """The part of a vector at right angles to the normal."""
    return np.asarray(vector - (vector @ normal) * normal)


def _sine(a: Array, b: Array) -> float:
    return float(np.linalg.norm(np.cross(a, b)))
