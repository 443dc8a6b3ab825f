"""One polynomial per segment from its values at both ends: cubic and classic septic; `quintic` has its own module."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import perm

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.piecewise import Piecewise
from puma_septic.piecewise.matrices import from_power_matrix
from puma_septic.profiles._info import BIAGIOTTI, ProfileInfo
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["CLASSIC_SEPTIC", "CUBIC", "classic_septic", "cubic", "from_boundary_values"]

CUBIC = ProfileInfo(
    name="cubic",
    continuity="C1",
    inside="C1",
    needs="times, optionally via velocities",
    at_vias="stops",
    overshoots=False,
    source=f"{BIAGIOTTI}, 2.1.3",
)
CLASSIC_SEPTIC = ProfileInfo(
    name="classic_septic",
    continuity="C3",
    inside="C3",
    needs="times, optionally via velocities, accelerations and jerks",
    at_vias="stops",
    overshoots=False,
    source=f"{BIAGIOTTI}, 2.1.5",
)


def cubic(
    points: ArrayLike,
    times: ArrayLike,
    *,
    velocities: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """One cubic per segment, from position and velocity at both its ends.

    With s = (t - t0)/T and h = q1 - q0:
    ``q = q0 + v0 T s + (3 h - (2 v0 + v1) T) s^2 + (-2 h + (v0 + v1) T) s^3`` (Biagiotti and Melchiorri,
    Trajectory Planning for Automatic Machines and Robots). The velocity is continuous, the
    acceleration steps at every point, both ends included. At rest it peaks at ``6 h/T^2``.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    velocities : array_like, shape (k, n_joints), optional
        At the points, rad/s; without them the arm stops at each point.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.cubic([[0.0], [1.0], [2.0]], [0.0, 1.0, 2.0], velocities=[[0.0], [1.0], [0.0]])
    >>> float(move(1.0, order=1)[0])
    1.0
    """
    return from_boundary_values("cubic", points, times, [velocities], _polynomials(1), joint_names)


def classic_septic(
    points: ArrayLike,
    times: ArrayLike,
    *,
    velocities: ArrayLike | None = None,
    accelerations: ArrayLike | None = None,
    jerks: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """One septic per segment, from position, velocity, acceleration and jerk at both its ends.

    At rest ``q = q0 + h (35 s^4 - 84 s^5 + 70 s^6 - 20 s^7)``, the 4-5-6-7 polynomial; the jerk is
    continuous, at rest too (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots).

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    velocities, accelerations, jerks : array_like, shape (k, n_joints), optional
        At the points, rad/s, rad/s^2 and rad/s^3; zero where not given.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.classic_septic([[0.0], [1.0]], [0.0, 1.0])
    >>> float(move.extrema(1).max[0])
    2.1875
    """
    derivatives = [velocities, accelerations, jerks]
    return from_boundary_values("classic_septic", points, times, derivatives, _polynomials(3), joint_names)


def from_boundary_values(
    profile: str,
    points: ArrayLike,
    times: ArrayLike,
    derivatives: Sequence[ArrayLike | None],
    laws: Array,
    joint_names: Sequence[str] | None,
) -> Trajectory:
    """Segments that position and the given derivatives at both ends determine.

    `laws` (degree + 1, 2 (r + 1)) holds the Chebyshev coefficients of one motion for each boundary value, in
    s: position to derivative r at s = 0, then at s = 1.
    """
    vias = Vias.of(profile, points, times, joint_names)
    names = ("velocities", "accelerations", "jerks")
    known = [vias.at_points(name, given) for name, given in zip(names, derivatives, strict=False)]
    moving = known[:2]  # a jerk alone does not contradict rest
    T = np.diff(vias.t)[:, None]
    # Relative to each segment's start, so that a joint that does not move has coefficients that are exactly
    # zero.
    start = [np.zeros_like(vias.q[1:]), *(x[:-1] * T ** (k + 1) for k, x in enumerate(known))]
    end = [np.diff(vias.q, axis=0), *(x[1:] * T ** (k + 1) for k, x in enumerate(known))]
    series = np.tensordot(laws, np.stack(start + end), 1)
    series[0] += vias.q[:-1]
    position = Piecewise(breaks=vias.t, coefficients=series)
    return vias.trajectory(position, start=[x[0] for x in moving], end=[x[-1] for x in moving])


@lru_cache(maxsize=4)
def _polynomials(order: int) -> Array:
    """One polynomial for each boundary value, see `from_boundary_values`."""
    size = 2 * (order + 1)
    conditions = np.array([[perm(k, r) * (s or k == r) for k in range(size)] for s in (0, 1) for r in range(order + 1)])
    # The inverse consists of multiples of 1/6 up to degree 7: rounding to them makes it exact.
    inverse = np.round(6 * np.linalg.inv(conditions)) / 6
    return np.asarray(from_power_matrix(size - 1) @ inverse)
