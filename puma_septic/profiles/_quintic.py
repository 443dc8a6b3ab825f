"""Quintic segments between points, at rest or with given velocities at the points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.piecewise import Piecewise
from puma_septic.profiles._info import BIAGIOTTI, ProfileInfo
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["QUINTIC", "QUINTIC_SEGMENTS", "quintic", "quintic_powers", "quintic_segments"]

QUINTIC = ProfileInfo(
    name="quintic",
    continuity="C2",
    inside="C2",
    needs="times, optionally via velocities and accelerations",
    at_vias="stops",
    overshoots=False,
    source=f"{BIAGIOTTI}, 2.1.4",
)
QUINTIC_SEGMENTS = ProfileInfo(
    name="quintic_segments",
    continuity="C2",
    inside="C2",
    needs="times; the same motion as quintic",
    at_vias="stops",
    overshoots=False,
    source=f"{BIAGIOTTI}, 2.1.4",
)


def quintic(
    points: ArrayLike,
    times: ArrayLike,
    *,
    velocities: ArrayLike | None = None,
    accelerations: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """One quintic per segment, from position, velocity and acceleration at both its ends.

    At rest ``q = q0 + h (10 s^3 - 15 s^4 + 6 s^5)``, the 3-4-5 polynomial: of all motions from rest to rest
    with continuous acceleration the one with the least integral of jerk^2, ``720 h^2/T^5`` (Flash and Hogan,
    The Coordination of Arm Movements, 1985; general boundary values: Biagiotti and
    Melchiorri). The jerk steps at every point. The same curve as `quintic_segments`.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    velocities, accelerations : array_like, shape (k, n_joints), optional
        At the points, rad/s and rad/s^2; zero where not given.
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
    >>> move = profiles.quintic([[0.0], [1.0]], [0.0, 1.0])
    >>> float(move.extrema(1).max[0])
    1.875
    """
    return _quintics(Vias.of("quintic", points, times, joint_names), velocities, accelerations)


def quintic_segments(
    points: ArrayLike,
    times: ArrayLike,
    *,
    velocities: ArrayLike | None = None,
    accelerations: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """One quintic per segment; each via has a given velocity and acceleration, zero where none is given.

    On a segment from (q0, v0, a0) to (q1, v1, a1) in T, with s = (t - t0)/T and h = q1 - q0:
    ``q = q0 + v0 T s + a0 T^2/2 s^2 + c3 s^3 + c4 s^4 + c5 s^5``,
    ``c3 = 10 h - (6 v0 + 4 v1) T - (3 a0 - a1) T^2/2``, ``c4 = -15 h + (8 v0 + 7 v1) T + (3 a0 - 2 a1) T^2/2``,
    ``c5 = 6 h - 3 (v0 + v1) T - (a0 - a1) T^2/2`` (Biagiotti and Melchiorri, Trajectory Planning for Automatic
    Machines and Robots). Position, velocity and acceleration are continuous; the jerk steps at every
    point. With zero velocities, the arm stops at each via.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    velocities, accelerations : array_like, shape (k, n_joints), optional
        At the points, rad/s and rad/s^2.
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
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0], [1.0], [0.0]], [0.0, 1.0, 2.0])
    >>> move(1.0, order=1).tolist()
    [0.0]
    """
    return _quintics(Vias.of("quintic_segments", points, times, joint_names), velocities, accelerations)


def _quintics(vias: Vias, velocities: ArrayLike | None, accelerations: ArrayLike | None) -> Trajectory:
    v, a = vias.at_points("velocities", velocities), vias.at_points("accelerations", accelerations)
    powers = quintic_powers(vias.q[:-1], vias.q[1:], np.diff(vias.t), v0=v[:-1], v1=v[1:], a0=a[:-1], a1=a[1:])
    return vias.trajectory(Piecewise.from_power(vias.t, powers), start=[v[0], a[0]], end=[v[-1], a[-1]])


def quintic_powers(
    q0: Array,
    q1: Array,
    durations: Array,
    *,
    v0: Array | float = 0.0,
    v1: Array | float = 0.0,
    a0: Array | float = 0.0,
    a1: Array | float = 0.0,
) -> Array:
    """Powers of the normalised time, shape (6, n, m), of n quintics; formula in `quintic_segments`."""
    T = durations[:, None]
    h = q1 - q0
    powers = np.empty((6, *h.shape))
    powers[0], powers[1], powers[2] = q0, v0 * T, a0 * T**2 / 2
    powers[3] = 10 * h - (6 * v0 + 4 * v1) * T - (3 * a0 - a1) * T**2 / 2
    powers[4] = -15 * h + (8 * v0 + 7 * v1) * T + (3 * a0 - 2 * a1) * T**2 / 2
    powers[5] = 6 * h - 3 * (v0 + v1) * T - (a0 - a1) * T**2 / 2
    return powers
