"""The eight closed-form branches of a PUMA: its geometry, its branches, its singularities.

Formulas: Paul & Zhang, "Computationally efficient kinematics for manipulators with spherical wrists", Int. J. Robotics
Research 5(2), 1986, as coded in Corke's Robotics Toolbox (``ikine6s.m``), here for many poses at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.checks import Array
from puma_septic.kinematics.chain import Chain

__all__ = ["CONFIGURATIONS", "SINGULARITIES", "PumaGeometry", "branch_values", "branches", "into_reach", "puma_geometry"]

ARMS: Final = ("right", "left")
ELBOWS: Final = ("up", "down")
WRISTS: Final = ("noflip", "flip")
CONFIGURATIONS: Final = tuple(f"{arm}-{elbow}-{wrist}" for arm in ARMS for elbow in ELBOWS for wrist in WRISTS)
SINGULARITIES: Final = ("shoulder", "elbow", "wrist")

# A model belongs to the PUMA pattern if its placements agree this well; what is left is polished away.
PATTERN_TOLERANCE = 1e-9
# Below this sin(q5), joint 6 is taken from the remaining rotation instead of from quotients of small numbers, which
# would carry rounding / sin(q5) into the pose.
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

    Joint frames after the first, each from the one before: (0, 0, d1) Rx(90 deg); (a2, 0, 0); (a3, 0, d3) Rx(-90 deg);
    (0, 0, d4) Rx(90 deg); Rx(-90 deg); every joint turns about its z. The first may stand anywhere.
    """
    if len(chain.placements) != 6 or any(chain.prismatic):
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
    """The reachable wrist centres nearest to the given ones, (3, n) from the shoulder, and the distances between.

    What the wrist centre reaches is a spherical shell about the shoulder less the cylinder of radius \\|d3\\| about
    joint 1's axis.
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


def branches(geometry: PumaGeometry, wrist: Array, q4_near: Array | float) -> tuple[list[Array], list[Array]]:
    """Joint angles, one array each that broadcasts to (arm, elbow, wrist, n), not yet wrapped to the limits.

    Parameters
    ----------
    wrist : ndarray, shape (4, 3, n)
        Frame of the last joint from the shoulder; its origin must be in reach.
    q4_near : float or ndarray, shape (n,)
        Joint 4 where the pose leaves it free.

    Returns
    -------
    angles : list of six ndarray
    distances : list of three ndarray
        Magnitudes of `branch_values`, which broadcast in the same way.
    """
    arm, (across, bent) = _arm_angles(geometry, wrist[3])
    (q4, q5, q6), sine = _wrist_angles(wrist[:3], arm[0], arm[1] + arm[2], q4_near)
    angles = [
        *(np.expand_dims(q, 2) for q in arm),
        np.stack((q4, q4 + np.pi), axis=2),
        np.stack((q5, -q5), axis=2),
        np.stack((q6, q6 + np.pi), axis=2),
    ]
    return angles, [across, bent, np.expand_dims(sine, 2)]


def _arm_angles(g: PumaGeometry, centre: Array) -> tuple[list[Array], list[Array]]:
    """Joints 1 (arm, 1, n), 2 and 3 (arm, elbow, n) that put the wrist centre there; distances to singularity (n,)."""
    x, y, z = centre
    across_squared = np.maximum(x * x + y * y - g.d3**2, 0.0)
    height_squared = across_squared + z * z
    across = np.sqrt(across_squared)
    # The triangle of upper arm and forearm: how far along and beside the line to the wrist the elbow's axis lies.
    along = (height_squared + (g.a2**2 - g.a3**2 - g.d4**2)) / (2.0 * g.a2)
    beside = np.sqrt(np.maximum(height_squared - along * along, 0.0))
    heading, offset = np.arctan2(y, x), np.arctan2(g.d3, across)
    rise, opening = np.arctan2(z, across), np.arctan2(beside, along)
    bend = np.arctan2(along - g.a2, beside)
    straight = np.arctan2(g.a3, g.d4)
    folded, opened = straight - np.pi + bend, straight - bend
    up, down = rise + opening, rise - opening
    q1 = np.stack((heading + offset, heading - offset + np.pi))[:, None]
    q2 = np.stack((up, down, np.pi - up, np.pi - down)).reshape(2, 2, -1)
    q3 = np.stack((folded, opened, opened, folded)).reshape(2, 2, -1)
    return [q1, q2, q3], [across, beside / g.forearm]


def _wrist_angles(
    rotation: Array, q1: Array, q23: Array, q4_near: Array | float
) -> tuple[tuple[Array, Array, Array], Array]:
    """Joints 4, 5 (sin >= 0) and 6: the Euler angles of what the arm leaves to the wrist; sin(q5); each (arm, elbow, n)."""
    c1, s1, c23, s23 = np.cos(q1), np.sin(q1), np.cos(q23), np.sin(q23)
    x, y, z = rotation
    # What is used of R03^T R06: its last row and its last column.
    ahead = [c1 * axis[0] + s1 * axis[1] for axis in (x, y, z)]
    m31, m32, m33 = (c23 * axis[2] - s23 * part for axis, part in zip((x, y, z), ahead, strict=True))
    m13, m23 = c23 * ahead[2] + s23 * z[2], c1 * z[1] - s1 * z[0]
    sine = np.sqrt(m13 * m13 + m23 * m23)
    q4, q5, q6 = np.arctan2(-m23, -m13), np.arctan2(sine, m33), np.arctan2(-m32, m31)
    small = sine < SMALL_SINE
    if small.any():
        arm, elbow, pose = np.nonzero(small)
        near = np.broadcast_to(q4_near, sine.shape)[small]
        chosen = q4[small] = np.where(sine[small] < FREE_SINE, near, q4[small])
        q5[small], q6[small] = _aligned_wrist(rotation[:, :, pose], q1[arm, 0, pose], q23[arm, elbow, pose], chosen)
    return (q4, q5, q6), sine


def _aligned_wrist(rotation: Array, q1: Array, q23: Array, q4: Array) -> tuple[Array, Array]:
    """Joints 5 and 6 from what remains after joint 4, for flat arrays: accurate however small sin(q5) is."""
    c1, s1, c23, s23, c4, s4 = (f(q) for q in (q1, q23, q4) for f in (np.cos, np.sin))
    in_plane = c23 * (c1 * rotation[:, 0] + s1 * rotation[:, 1]) + s23 * rotation[:, 2]
    across = c1 * rotation[:, 1] - s1 * rotation[:, 0]
    m33 = c23 * rotation[2, 2] - s23 * (c1 * rotation[2, 0] + s1 * rotation[2, 1])
    turned = c4 * across - s4 * in_plane
    return np.arctan2(-c4 * in_plane[2] - s4 * across[2], m33), np.arctan2(turned[0], turned[1])


def branch_values(geometry: PumaGeometry, q: Array) -> Array:
    """Signed distances to the three singularities, shape (3, ...), for joint angles of shape (6, ...).

    Shoulder: how far the wrist centre is in front of joint 1's axis, in m, positive for the right arm; elbow: sine of
    the angle between upper arm and forearm, its product with the first negative for the elbow up; wrist: sin(q5),
    positive for no flip. One is zero where two branches meet.
    """
    g = geometry
    bent = np.sin(q[2] + np.arctan2(g.d4, g.a3))
    front = g.a2 * np.cos(q[1]) + g.a3 * np.cos(q[1] + q[2]) - g.d4 * np.sin(q[1] + q[2])
    return np.stack((front, bent, np.sin(q[4])))
