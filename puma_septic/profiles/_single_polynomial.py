"""The paper's septic for any number of points: one polynomial whose degree grows with them."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from puma_septic.profiles._segments import at_ends, solve_segments, through
from puma_septic.profiles._vias import boundary, checked_points, checked_via_times, named
from puma_septic.trajectory import Trajectory

__all__ = ["single_polynomial"]


def single_polynomial(
    points: ArrayLike,
    times: ArrayLike,
    *,
    start_velocity: ArrayLike | None = None,
    end_velocity: ArrayLike | None = None,
    start_acceleration: ArrayLike | None = None,
    end_acceleration: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """One polynomial of degree k + 3 per joint through k points; for four points, the paper's septic.

    Position at all times, velocity and acceleration at both ends (equation 14 of Raji, Asaolu, Akano, Joint
    Space Robot Arm Trajectory Planning Using Septic Function, generalised). Infinitely smooth inside; the
    jerk steps at both ends. The overshoot between the points grows fast with their number (Runge's
    phenomenon), and so does the sensitivity to rounding: it is measured, and refused where positions would be
    uncertain by more than 1e-9 of the movement. With evenly timed points that happens at about 30 of them,
    with Chebyshev-like times later; the overshoot makes the motion useless well before.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    start_velocity, end_velocity, start_acceleration, end_acceleration : array_like, optional
        Shape () or (n_joints,), rad/s and rad/s^2; zero where not given.
    joint_names : sequence of str, optional

    Raises
    ------
    InputError
        For fewer than two points, so many that rounding spoils the digits, times that do not increase,
        non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.single_polynomial([[0.0], [1.0], [0.5], [2.0], [1.0]], [0.0, 1.0, 2.0, 3.0, 4.0])
    >>> move.position.degree
    8
    """
    vias = checked_points("single_polynomial", points)
    instants = checked_via_times(times, vias)
    v0, v1 = (
        boundary(name, value, vias.shape[1], "rad/s")
        for name, value in (("start_velocity", start_velocity), ("end_velocity", end_velocity))
    )
    a0, a1 = (
        boundary(name, value, vias.shape[1], "rad/s^2")
        for name, value in (
            ("start_acceleration", start_acceleration),
            ("end_acceleration", end_acceleration),
        )
    )
    conditions = through(instants, vias) + at_ends(instants, 1, v0, v1) + at_ends(instants, 2, a0, a1)
    return Trajectory(
        position=solve_segments(instants[[0, -1]], [len(vias) + 3], -1, conditions),
        points=vias,
        times=instants,
        profile="single_polynomial",
        joint_names=named(joint_names),
    )
