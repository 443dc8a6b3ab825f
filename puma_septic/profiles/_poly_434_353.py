"""Three segments of different degrees through two vias: 4-3-4 and 3-5-3."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.profiles._info import ProfileInfo
from puma_septic.profiles._segments import at_ends, solve_segments, through
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory

__all__ = ["POLY_353", "POLY_434", "poly_353", "poly_434"]

POLY_434 = ProfileInfo(
    name="poly_434",
    continuity="C2",
    inside="C2",
    needs="times, exactly 4 points",
    at_vias="passes",
    overshoots=True,
    source="Fu, Gonzalez and Lee, Robotics, 4.3.1",
)
POLY_353 = ProfileInfo(
    name="poly_353",
    continuity="C2",
    inside="C2",
    needs="times, exactly 4 points",
    at_vias="passes",
    overshoots=True,
    source="Fu, Gonzalez and Lee, Robotics, 4.3.1",
)


def poly_434(points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None) -> Trajectory:
    """A quartic, a cubic and a quartic: lift-off, transfer and set-down.

    14 coefficients from four positions (the two vias' on both sides), velocity and acceleration zero at both
    ends and continuous at both vias (Fu, Gonzalez and Lee, Robotics: Control, Sensing, Vision and
    Intelligence). The jerk steps at all four points.

    Parameters
    ----------
    points : array_like, shape (4, n_joints)
        rad (m for prismatic joints).
    times : array_like, shape (4,)
        Strictly increasing, s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points.

    Raises
    ------
    InputError
        For other than four points, times that do not increase or are too uneven, non-finite or misshapen
        arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.poly_434([[0.0], [0.5], [1.0], [1.5]], [0.0, 1.0, 2.0, 3.0])
    >>> move.jumps(3).times.tolist()
    [0.0, 1.0, 2.0, 3.0]
    """
    return _three_segments("poly_434", points, times, joint_names, degrees=(4, 3, 4))


def poly_353(points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None) -> Trajectory:
    """A cubic, a quintic and a cubic; conditions and continuity are those of `poly_434`.

    Parameters
    ----------
    points : array_like, shape (4, n_joints)
        rad (m for prismatic joints).
    times : array_like, shape (4,)
        Strictly increasing, s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points.

    Raises
    ------
    InputError
        For other than four points, times that do not increase or are too uneven, non-finite or misshapen
        arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.poly_353([[0.0], [0.5], [1.0], [1.5]], [0.0, 1.0, 2.0, 3.0])
    >>> move([0.0, 3.0], order=2).round(12).ravel().tolist()
    [0.0, 0.0]
    """
    return _three_segments("poly_353", points, times, joint_names, degrees=(3, 5, 3))


def _three_segments(
    profile: str,
    points: ArrayLike,
    times: ArrayLike,
    joint_names: Sequence[str] | None,
    *,
    degrees: tuple[int, int, int],
) -> Trajectory:
    vias = Vias.of(profile, points, times, joint_names, exactly=4)
    rest = np.zeros(vias.n_joints)
    conditions = through(vias.t, vias.q) + at_ends(vias.t, 1, rest, rest) + at_ends(vias.t, 2, rest, rest)
    return vias.trajectory(solve_segments(vias.t, degrees, 2, conditions))
