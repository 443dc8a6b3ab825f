"""Splines through the points: cubic, quintic and septic, at knots that are the via times."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.profiles._info import BIAGIOTTI, ProfileInfo
from puma_septic.profiles._segments import at_ends, solve_segments, through
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array

__all__ = [
    "CUBIC_SPLINE",
    "CUBIC_SPLINE_FREE_KNOTS",
    "QUINTIC_SPLINE",
    "SEPTIC_SPLINE",
    "cubic_spline",
    "cubic_spline_free_knots",
    "quintic_spline",
    "septic_spline",
]

CUBIC_SPLINE = ProfileInfo(
    name="cubic_spline",
    continuity="C1",
    inside="C2",
    needs="times",
    at_vias="passes",
    overshoots=True,
    source=f"{BIAGIOTTI}, 4.4.1",
)
CUBIC_SPLINE_FREE_KNOTS = ProfileInfo(
    name="cubic_spline_free_knots",
    continuity="C2",
    inside="C2",
    needs="times, at least 3 points",
    at_vias="passes",
    overshoots=True,
    source="Lin, Chang and Luh 1983",
)
QUINTIC_SPLINE = ProfileInfo(
    name="quintic_spline",
    continuity="C2",
    inside="C4",
    needs="times",
    at_vias="passes",
    overshoots=True,
    source="Flash and Hogan 1985",
)
SEPTIC_SPLINE = ProfileInfo(
    name="septic_spline",
    continuity="C3",
    inside="C6",
    needs="times",
    at_vias="passes",
    overshoots=True,
    source="Mellinger and Kumar 2011",
)


def cubic_spline(
    points: ArrayLike,
    times: ArrayLike,
    *,
    start_velocity: ArrayLike | None = None,
    end_velocity: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """The clamped cubic spline: velocity and acceleration continuous at the vias, velocity given at both
    ends.

    Among all curves through the points with these end velocities it has the least integral of acceleration^2.
    At the ends the acceleration steps from rest, so the jerk is unbounded there (Biagiotti and Melchiorri,
    Trajectory Planning for Automatic Machines and Robots).

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    start_velocity, end_velocity : array_like, optional
        Shape () or (n_joints,), rad/s; zero where not given.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase or are too uneven, non-finite or misshapen
        arrays.

    Examples
    --------
    Two cubics that meet at 45 deg/s (Williams 2013):

    >>> from puma_septic import profiles
    >>> move = profiles.cubic_spline([[30.0], [180.0], [120.0]], [0.0, 1.5, 3.0])
    >>> float(move(1.5, order=1)[0])
    45.0
    """
    vias = Vias.of("cubic_spline", points, times, joint_names)
    start = vias.boundary("start_velocity", start_velocity)
    end = vias.boundary("end_velocity", end_velocity)
    conditions = through(vias.t, vias.q) + at_ends(vias.t, 1, start, end)
    position = solve_segments(vias.t, [3] * (len(vias.q) - 1), 2, conditions)
    return vias.trajectory(position, start=start, end=end)


def cubic_spline_free_knots(
    points: ArrayLike,
    times: ArrayLike,
    *,
    free_knots: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """The cubic spline with velocity and acceleration zero at both ends, made possible by two further knots.

    One knot in the first and one in the last segment, through no given point: there as at the vias, velocity
    and acceleration are continuous; the jerk is a staircase (Lin, Chang and Luh, Formulation and Optimization
    of Cubic Polynomial Joint Trajectories for Industrial Robots, 1983; Biagiotti and Melchiorri, section
    4.4.4).

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least three, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    free_knots : array_like, shape (2,), optional
        One time strictly inside the first and one strictly inside the last segment, s; their middles where
        not given.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points and the free knots.

    Raises
    ------
    InputError
        For fewer than three points, a free knot outside its segment, times that do not increase or are too
        uneven, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.cubic_spline_free_knots([[0.0], [1.0], [0.5]], [0.0, 1.0, 2.0])
    >>> move.breaks.tolist(), move([0.0, 2.0], order=2).round(12).ravel().tolist()
    ([0.0, 0.5, 1.0, 1.5, 2.0], [0.0, 0.0])
    """
    vias = Vias.of("cubic_spline_free_knots", points, times, joint_names, at_least=3)
    knots = _free_knots(vias, free_knots)
    breaks = np.sort(np.concatenate([vias.t, knots]))
    rest = np.zeros(vias.n_joints)
    conditions = through(vias.t, vias.q) + at_ends(vias.t, 1, rest, rest) + at_ends(vias.t, 2, rest, rest)
    return vias.trajectory(solve_segments(breaks, [3] * (len(breaks) - 1), 2, conditions))


def _free_knots(vias: Vias, given: ArrayLike | None) -> Array:
    """The two free knots, each inside its segment, since the first point."""
    if given is None:
        return np.asarray(0.5 * (vias.t[[0, -2]] + vias.t[[1, -1]]))
    knots = checked_array("free_knots", given, (2,), unit="s")
    for i, (left, right) in enumerate((vias.times[:2], vias.times[-2:])):
        if not left < knots[i] < right:
            which = "last" if i else "first"
            raise InputError(
                f"free_knots[{i}] = {knots[i]:g} s must lie inside the {which} segment,"
                f" between {left:g} and {right:g} s"
            )
    return np.asarray(knots - vias.times[0])


def quintic_spline(points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None) -> Trajectory:
    """The quintic spline from rest to rest: continuous to the fourth derivative at the vias.

    Of all curves through the points with velocity and acceleration zero at both ends, the one with the least
    integral of jerk^2 (the minimum-jerk principle of Flash and Hogan, The Coordination of Arm Movements,
    1985, with via points at given times). The jerk steps at both ends only.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase or are too uneven, non-finite or misshapen
        arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.quintic_spline([[0.0], [1.0], [0.5]], [0.0, 1.0, 2.0])
    >>> move.jumps(3).times.tolist()
    [0.0, 2.0]
    """
    return _rest_spline("quintic_spline", points, times, joint_names, order=2)


def septic_spline(points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None) -> Trajectory:
    """The septic spline from rest to rest: continuous to the sixth derivative at the vias.

    Of all curves through the points with velocity, acceleration and jerk zero at both ends, the one with the
    least integral of snap^2 (Mellinger and Kumar, Minimum Snap Trajectory Generation and Control for
    Quadrotors, 2011). The jerk is continuous, at rest too.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase or are too uneven, non-finite or misshapen
        arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.septic_spline([[0.0], [1.0], [0.5]], [0.0, 1.0, 2.0])
    >>> len(move.jumps(3).times)
    0
    """
    return _rest_spline("septic_spline", points, times, joint_names, order=3)


def _rest_spline(
    profile: str, points: ArrayLike, times: ArrayLike, joint_names: Sequence[str] | None, *, order: int
) -> Trajectory:
    """The spline of degree 2 order + 1 whose derivatives up to `order` vanish at both ends."""
    vias = Vias.of(profile, points, times, joint_names)
    rest = np.zeros(vias.n_joints)
    conditions = through(vias.t, vias.q)
    for k in range(1, order + 1):
        conditions += at_ends(vias.t, k, rest, rest)
    return vias.trajectory(solve_segments(vias.t, [2 * order + 1] * (len(vias.q) - 1), 2 * order, conditions))
