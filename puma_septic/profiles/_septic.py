"""The paper's septic: one polynomial of degree 7 through two via points."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.checks import Array, read_only
from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.piecewise.matrices import basis_at, end_derivatives, signs
from puma_septic.profiles._vias import boundary, checked_points, checked_via_times, named
from puma_septic.trajectory import Trajectory

__all__ = ["septic"]


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
    of t it is 9.2e6 for the paper's times. Infinitely smooth inside; the jerk steps at both ends.

    Parameters
    ----------
    points : array_like, shape (4, n_joints)
        rad (m for prismatic joints).
    times : array_like, shape (4,)
        Strictly increasing, s.
    start_velocity, end_velocity, start_acceleration, end_acceleration : array_like, optional
        Shape () or (n_joints,), rad/s and rad/s^2; zero where not given.
    joint_names : sequence of str, optional

    Raises
    ------
    InputError
        For other than four points, times that do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.septic([[0.0], [0.5], [1.0], [1.5]], [0.0, 1.0, 2.0, 3.0])
    >>> move([0.0, 1.0, 3.0]).round(12).ravel().tolist()
    [0.0, 0.5, 1.5]
    """
    vias = checked_points("septic", points, exactly=4)
    instants = checked_via_times(times, vias)
    ends = [
        boundary(name, value, vias.shape[1], unit)
        for name, value, unit in (
            ("start_velocity", start_velocity, "rad/s"),
            ("end_velocity", end_velocity, "rad/s"),
            ("start_acceleration", start_acceleration, "rad/s^2"),
            ("end_acceleration", end_acceleration, "rad/s^2"),
        )
    ]
    series = interpolating_series(vias, instants, ends)
    position = Piecewise(breaks=instants[[0, -1]], coefficients=series[:, None, :])
    return Trajectory(position=position, points=vias, times=instants, profile="septic", joint_names=named(joint_names))


def interpolating_series(points: Array, times: Array, ends: Sequence[Array]) -> Array:
    """Chebyshev coefficients (k + 4, n_joints) of the polynomial through k points with given end derivatives.

    `ends` are velocity at start and end, acceleration at start and end. Displacements from the first point are
    solved for, so that a joint that does not move gets coefficients that are exactly zero.
    """
    half = (times[-1] - times[0]) / 2
    x = (times - times[0]) / half - 1
    x[-1] = 1.0
    conditions = np.concatenate([basis_at(x, len(points) + 3).T, _end_conditions(len(points) + 3)])
    scale = half ** np.array([[1.0], [1.0], [2.0], [2.0]])
    try:
        series = np.linalg.solve(conditions, np.concatenate([points - points[0], scale * np.array(ends)]))
    except np.linalg.LinAlgError as error:
        raise InputError(f"times: {times.tolist()} s are too close to each other to be told apart") from error
    series[0] += points[0]
    return np.asarray(series)


@lru_cache(maxsize=16)
def _end_conditions(degree: int) -> Array:
    """First derivative of the basis at x = -1 and 1, then the second, shape (4, degree + 1)."""
    _, slope, curvature, _ = end_derivatives(degree)
    sign = signs(degree)
    return read_only([-sign * slope, slope, sign * curvature, curvature])
