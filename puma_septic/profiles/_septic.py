"""The paper's septic: one polynomial of degree 7 through two via points."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from puma_septic.profiles._info import PAPER, SMOOTH, ProfileInfo
from puma_septic.profiles._single_polynomial import through_all
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory

__all__ = ["SEPTIC", "septic"]

SEPTIC = ProfileInfo(
    name="septic",
    continuity="C2",
    inside=SMOOTH,
    needs="times, exactly 4 points",
    at_vias="passes",
    overshoots=True,
    source=PAPER,
)


def septic(
    points: ArrayLike,
    times: ArrayLike,
    *,
    start_velocity: ArrayLike | None = None,
    end_velocity: ArrayLike | None = None,
    start_acceleration: ArrayLike | None = None,
    end_acceleration: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """One polynomial of degree 7 per joint through four points.

    Eight conditions fix eight coefficients: position at all four times, velocity and acceleration at both ends
    (equation 14 of Raji, Asaolu, Akano, Joint Space Robot Arm Trajectory Planning Using Septic Function). They are
    solved in Chebyshev polynomials of the normalised time, where the system's condition number is small; in powers
    of t it is 9.2e6 for the paper's times. Infinitely smooth inside; the jerk steps at both ends. The same motion as
    `single_polynomial`, and refused like it where times are so uneven that the polynomial swings far beyond its points
    and rounding moves it by more than 1e-9 of the movement.

    Parameters
    ----------
    points : array_like, shape (4, n_joints)
        rad (m for prismatic joints).
    times : array_like, shape (4,)
        Strictly increasing, s.
    start_velocity, end_velocity, start_acceleration, end_acceleration : array_like, optional
        Shape () or (n_joints,), rad/s and rad/s^2; zero where not given.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        One interval, of degree 7.

    Raises
    ------
    InputError
        For other than four points, times that do not increase or are too uneven, non-finite or misshapen arrays.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.septic([[0.0], [0.5], [1.0], [1.5]], [0.0, 1.0, 2.0, 3.0])
    >>> move([0.0, 1.0, 3.0]).round(12).ravel().tolist()
    [0.0, 0.5, 1.5]
    """
    vias = Vias.of("septic", points, times, joint_names, exactly=4)
    return through_all(
        vias,
        start_velocity=start_velocity,
        end_velocity=end_velocity,
        start_acceleration=start_acceleration,
        end_acceleration=end_acceleration,
    )
