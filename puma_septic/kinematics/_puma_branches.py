"""The eight closed-form branches of a PUMA: its geometry, its branches, its singularities.

Formulas: Paul & Zhang, "Computationally efficient kinematics for manipulators with spherical wrists", Int.
J. Robotics Research 5(2), 1986, as coded in Corke's Robotics Toolbox (``ikine6s.m``), here for many poses at
once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.kinematics._chain import Chain, cos_sin
from puma_septic.validation import Array

__all__ = [
    "CONFIGURATIONS",
    "SINGULARITIES",
    "PumaGeometry",
    "branch_values",
    "branches",
    "into_reach",
    "puma_geometry",
]

ARMS: Final = ("right", "left")
ELBOWS: Final = ("up", "down")
WRISTS: Final = ("noflip", "flip")
CONFIGURATIONS: Final = tuple(f"{arm}-{elbow}-{wrist}" for arm in ARMS for elbow in ELBOWS for wrist in WRISTS)
# Joint angles that branches share stand once: first and last row, for how many elbows and wrists.
ROWS: Final = ((0, 2, 1, 1), (2, 6, 2, 1), (6, 10, 2, 1), (10, 18, 2, 2), (18, 26, 2, 2), (26, 34, 2, 2))
JOINT_OF_ROW: Final = np.repeat(np.arange(6), [end - start for start, end, _, _ in ROWS])
SINGULARITIES: Final = ("shoulder", "elbow", "wrist")

# A model belongs to the PUMA pattern if its placements agree this well; what is left is polished away.
PATTERN_TOLERANCE = 1e-9
# Below this sin(q5), joint 6 is taken from the remaining rotation instead of from quotients of small
# numbers, which would carry rounding / sin(q5) into the pose.
SMALL_SINE = 1e-3
# Below this sin(q5), the pose says nothing about joint 4 that is more than rounding.
FREE_SINE = 1e-12


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PumaGeometry:
    """Lengths of an arm with a PUMA's joints, in m, in standard Denavit-Hartenberg names.

    Attributes
    ----------
    a2, a3, d3, d4 : float
        Upper arm, elbow offset, shoulder offset, forearm.
    base : ndarray, shape (4, 4)
        From the world to the shoulder, where the axes of joints 1 and 2 meet.
    end : ndarray, shape (4, 4)
        From the wrist centre to the tool.
    """

    a2: float
    a3: float
    d3: float
    d4: float
    base: Array
    end: Array

    @property
    def forearm(self) -> float:
        """Distance from the elbow's axis to the wrist centre, in m."""
        return float(np.hypot(self.a3, self.d4))

    @property
    def reach(self) -> float:
        """Largest distance from the shoulder to the wrist centre, in m."""
        return float(np.hypot(self.a2 + self.forearm, self.d3))


def puma_geometry(chain: Chain) -> PumaGeometry | None:
    """The lengths of a chain that has a PUMA's joints; None for any other arm.

    Joint frames after the first, each from the one before: (0, 0, d1) Rx(90 deg); (a2, 0, 0); (a3, 0, d3)
    Rx(-90 deg); (0, 0, d4) Rx(90 deg); Rx(-90 deg); every joint turns about its z. The first may stand
    anywhere.
    """
    if len(chain.placements) != 6 or any(chain.prismatic) or chain.is_coupled:
        return None
    shifts = chain.placements[1:, :3, 3]
    d1, a2, a3, d3, d4 = shifts[0, 2], shifts[1, 0], shifts[2, 0], shifts[2, 2], shifts[3, 2]
    pattern = [
        _placement((0, 0, d1), 1),
        _placement((a2, 0, 0), 0),
        _placement((a3, 0, d3), -1),
        _placement((0, 0, d4), 1),
        _placement((0, 0, 0), -1),
    ]
    matches = np.abs(chain.placements[1:] - pattern).max() <= PATTERN_TOLERANCE
    if not matches or min(a2, abs(d3), np.hypot(a3, d4)) <= PATTERN_TOLERANCE:
        return None
    base = chain.placements[0] @ _placement((0, 0, d1), 0)
    return PumaGeometry(a2=float(a2), a3=float(a3), d3=float(d3), d4=float(d4), base=base, end=chain.end)


def _placement(shift: tuple[float, float, float], quarter_turns: int) -> Array:
    """A shift followed by quarter turns about x."""
    c, s = (1.0, 0.0) if quarter_turns == 0 else (0.0, float(quarter_turns))
    x, y, z = shift
    return np.array([[1.0, 0.0, 0.0, x], [0.0, c, -s, y], [0.0, s, c, z], [0.0, 0.0, 0.0, 1.0]])


def into_reach(geometry: PumaGeometry, centre: Array) -> tuple[Array, Array]:
    """The reachable wrist centres nearest to the given ones, (3, n) from the shoulder, and the distances
    between.

    What the wrist centre reaches is a spherical shell about the shoulder less the cylinder of radius
    abs(d3) about joint 1's axis.
    """
    g = geometry
    inner, outer = abs(g.a2 - g.forearm), g.a2 + g.forearm
    squared = centre[0] ** 2 + centre[1] ** 2 - g.d3**2
    height = squared + centre[2] ** 2
    outside = (squared < 0.0) | (height < inner**2) | (height > outer**2)
    if not outside.any():
        return centre, np.zeros(centre.shape[1])
    nearest = centre.copy()
    p = centre[:, outside]
    length = np.maximum(np.linalg.norm(p, axis=0), 1e-300)
    scaled = p * (np.clip(length, np.hypot(inner, g.d3), np.hypot(outer, g.d3)) / length)
    radius = np.hypot(p[0], p[1])
    direction = np.where(radius > 0.0, p[:2], [[1.0], [0.0]]) / np.where(radius > 0.0, radius, 1.0)
    rim_height = np.copysign(np.clip(np.abs(p[2]), inner, outer), p[2])
    rim = np.concatenate((abs(g.d3) * direction, rim_height[None]))
    nearest[:, outside] = np.where(np.hypot(scaled[0], scaled[1]) < abs(g.d3), rim, scaled)
    return nearest, np.linalg.norm(nearest - centre, axis=0)


def branches(geometry: PumaGeometry, wrist: Array, q4_near: Array | float) -> tuple[Array, list[Array]]:
    """Joint angles of all branches, each distinct one once, not yet wrapped to the limits.

    Parameters
    ----------
    wrist : ndarray, shape (4, 3, n)
        Frame of the last joint from the shoulder; its origin must be in reach.
    q4_near : float or ndarray, shape (n,)
        Joint 4 where the pose leaves it free.

    Returns
    -------
    rows : ndarray, shape (34, n)
        To be taken apart by `by_joint`.
    distances : list of three ndarray
        Magnitudes of `branch_values`, which broadcast to (arm, elbow, wrist, n).
    """
    rows = np.empty((len(JOINT_OF_ROW), wrist.shape[2]))
    q1, q2, q3, q4, q5, q6 = by_joint(rows)
    across, bent = _set_arm(geometry, wrist[3], q1[:, 0, 0], q2[:, :, 0], q3[:, :, 0])
    q23 = q2[:, :, 0] + q3[:, :, 0]
    sine = _set_wrist(wrist[:3], (q1[:, :, 0], q23), (q4[:, :, 0], q5[:, :, 0], q6[:, :, 0]), q4_near)
    np.add(q4[:, :, 0], np.pi, out=q4[:, :, 1])
    np.negative(q5[:, :, 0], out=q5[:, :, 1])
    np.add(q6[:, :, 0], np.pi, out=q6[:, :, 1])
    return rows, [across, bent, sine[:, :, None]]


def by_joint(rows: Array) -> list[Array]:
    """Views of the rows, one per joint, that broadcast to (arm, elbow, wrist, n)."""
    n = rows.shape[1]
    return [rows[start:end].reshape(2, elbows, wrists, n) for start, end, elbows, wrists in ROWS]


def _set_arm(g: PumaGeometry, centre: Array, q1: Array, q2: Array, q3: Array) -> tuple[Array, Array]:
    """Fill in joint 1 (arm, n), 2 and 3 (arm, elbow, n) that put the wrist centre there.

    Returns the distances to the shoulder's and the elbow's singularity, shape (n,).
    """
    x, y, z = centre
    across_squared = np.maximum(x * x + y * y - g.d3**2, 0.0)
    height_squared = across_squared + z * z
    across = np.sqrt(across_squared)
    # The triangle of upper arm and forearm: how far along and beside the line to the wrist the elbow's axis
    # lies.
    along = (height_squared + (g.a2**2 - g.forearm**2)) / (2.0 * g.a2)
    beside = np.sqrt(np.maximum(height_squared - along * along, 0.0))
    heading, offset = np.arctan2(y, x), np.arctan2(g.d3, across)
    rise, opening = np.arctan2(z, across), np.arctan2(beside, along)
    bend = np.arctan2(along - g.a2, beside)
    straight = np.arctan2(g.a3, g.d4)
    q1[0], q1[1] = heading + offset, heading - offset + np.pi
    q2[0, 0], q2[0, 1] = rise + opening, rise - opening
    q3[0, 0], q3[0, 1] = bend + (straight - np.pi), straight - bend
    # The other arm reaches over its back: the same triangle seen from behind.
    q2[1], q3[1] = np.pi - q2[0], q3[0, ::-1]
    return across, beside / g.forearm


def _set_wrist(
    rotation: Array, arm: tuple[Array, Array], wrist: tuple[Array, Array, Array], q4_near: Array | float
) -> Array:
    """Fill in joints 4, 5 (sin >= 0) and 6, Euler angles of what the arm leaves to the wrist; return sin(q5).

    `arm` is q1 (arm, 1, n) and q2 + q3 (arm, elbow, n); the rest has that last shape.
    """
    (c1, s1), (c23, s23) = (cos_sin(angle) for angle in arm)
    x, y, z = rotation
    # What is used of R03^T R06: its last row and its last column.
    ahead = [c1 * axis[0] + s1 * axis[1] for axis in (x, y, z)]
    m31, m32, m33 = (c23 * axis[2] - s23 * part for axis, part in zip((x, y, z), ahead, strict=True))
    m13, m23 = c23 * ahead[2] + s23 * z[2], c1 * z[1] - s1 * z[0]
    sine = np.sqrt(m13 * m13 + m23 * m23)
    small = sine < SMALL_SINE
    length = np.maximum(sine, FREE_SINE)
    q4, q5, q6 = wrist
    q4[...], q5[...], q6[...] = _angle(-m23, -m13, length), _angle(sine, m33, 1.0), _angle(-m32, m31, length)
    if small.any():
        side, _, pose = np.nonzero(small)
        from_pose = np.arctan2(-m23[side, 0, pose], -m13[small])
        near = np.broadcast_to(q4_near, sine.shape)[small]
        q4[small] = np.where(sine[small] < FREE_SINE, near, from_pose)
        q1, q23 = arm[0][side, 0, pose], arm[1][small]
        q5[small], q6[small] = _aligned_wrist(rotation[:, :, pose], q1, q23, q4[small])
    return np.asarray(sine)


def _aligned_wrist(rotation: Array, q1: Array, q23: Array, q4: Array) -> tuple[Array, Array]:
    """Joints 5 and 6 from what remains after joint 4, for flat arrays: accurate however small sin(q5) is."""
    (c1, s1), (c23, s23), (c4, s4) = (cos_sin(angle) for angle in (q1, q23, q4))
    in_plane = c23 * (c1 * rotation[:, 0] + s1 * rotation[:, 1]) + s23 * rotation[:, 2]
    across = c1 * rotation[:, 1] - s1 * rotation[:, 0]
    m33 = c23 * rotation[2, 2] - s23 * (c1 * rotation[2, 0] + s1 * rotation[2, 1])
    turned = c4 * across - s4 * in_plane
    return np.arctan2(-c4 * in_plane[2] - s4 * across[2], m33), np.arctan2(turned[0], turned[1])


def _angle(sine: Array, cosine: Array, length: Array | float) -> Array:
    """``arctan2(sine, cosine)`` where their length is known: to 5e-16, in half the time."""
    half = np.arctan(sine / (length + np.abs(cosine)))
    return np.where(cosine < 0.0, np.copysign(np.pi, sine) - 2.0 * half, 2.0 * half)


def branch_values(geometry: PumaGeometry, q: Array) -> Array:
    """Signed distances to the three singularities, shape (3, ...), for joint angles of shape (6, ...).

    Shoulder: how far the wrist centre is in front of joint 1's axis, in m, positive for the right arm;
    elbow: sine of the angle between upper arm and forearm, its product with the first negative for the elbow
    up; wrist: sin(q5), positive for no flip. One is zero where two branches meet.
    """
    g = geometry
    bent = np.sin(q[2] + np.arctan2(g.d4, g.a3))
    front = g.a2 * np.cos(q[1]) + g.a3 * np.cos(q[1] + q[2]) - g.d4 * np.sin(q[1] + q[2])
    return np.stack((front, bent, np.sin(q[4])))
