"""Turns about an axis, and the angles that meet one condition: the Paden-Kahan subproblems 1 and 4, for many at once.

Sources: Murray, Li & Sastry, "A Mathematical Introduction to Robotic Manipulation" (1994), section 3.3.2; Elias & Wen,
"IK-Geo: Unified robot inverse kinematics using subproblem decomposition" (2022). An axis is a unit vector of shape
(3,); other vectors have shape (3, ...) and broadcast against angles of shape (...).
"""

from __future__ import annotations

import numpy as np

from puma_septic.kinematics._chain import cos_sin, cross
from puma_septic.validation import Array

__all__ = ["angle_from_to", "angles_at_height", "dot", "turned"]


def dot(a: Array, b: Array) -> Array:
    """Scalar product along the first axis."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def turned(axis: Array, angle: Array, vector: Array) -> Array:
    """The vector turned about the axis (Rodrigues): ``c v + s (k x v) + (1 - c) (k . v) k``."""
    vector = _fitted(vector, angle)
    c, s = cos_sin(angle)
    across = cross(_fitted(axis, angle), vector)
    return np.asarray(c * vector + s * across + (1.0 - c) * dot(axis, vector) * _fitted(axis, angle))


def angle_from_to(axis: Array, start: Array, end: Array) -> Array:
    """Subproblem 1: the angle about the axis from one vector to another, seen along the axis.

    Both are first taken across the axis: what remains of vectors close to it would drown in the digits of a difference.
    """
    across, beside = (cross(_fitted(axis, vector[0]), vector) for vector in (start, end))
    return np.asarray(np.arctan2(dot(across, end), dot(across, beside)))


def angles_at_height(
    axis: Array, direction: Array, start: Array, height: Array, doubt: float = 0.0
) -> tuple[Array, Array, Array]:
    r"""Subproblem 4: the angles at which the vector, turned about the axis, has this height along a direction.

    :math:`d \cdot R(k, \theta)\, p = h` has the answers ``centre + opening`` and ``centre - opening``. At the first
    one the height falls with the angle: :math:`d \cdot (k \times R p) \le 0`.

    Parameters
    ----------
    doubt : float
        Error of the room. An opening that it may close or open is given as wide as it may be, so that Newton steps
        from both answers end at two if there are two.

    Returns
    -------
    centre, opening : ndarray
        rad. For a height out of reach the opening is 0 or half a turn: the angle that comes nearest.
    room : ndarray
        ``(sin(opening) l)^2`` with l the length of the vector across the axis, times that of the direction; negative
        where there is no answer.
    """
    along = dot(direction, axis) * dot(axis, start)
    cosine = dot(direction, start) - along
    sine = dot(direction, cross(_fitted(axis, start[0]), start))
    length = np.hypot(cosine, sine)
    rest = height - along
    room = (length - rest) * (length + rest)
    opening = np.arctan2(np.sqrt(np.where(np.abs(room) < doubt, doubt, np.maximum(room, 0.0))), rest)
    return np.arctan2(sine, cosine), opening, np.asarray(room)


def _fitted(vector: Array, like: Array) -> Array:
    """A constant vector, shape (3,), with as many axes as what it meets."""
    return vector.reshape(3, *(1,) * np.ndim(like)) if vector.ndim == 1 else vector
