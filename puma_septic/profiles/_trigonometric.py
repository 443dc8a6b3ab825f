"""The trigonometric spline of order 4."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.profiles._hermite import from_boundary_values
from puma_septic.profiles._info import ProfileInfo
from puma_septic.profiles._integration import integrated, smooth_series
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_number

__all__ = ["TRIGONOMETRIC_SPLINE", "trigonometric_spline"]

TRIGONOMETRIC_SPLINE = ProfileInfo(
    name="trigonometric_spline",
    continuity="C3",
    inside="C3",
    needs="times, an angle up to pi",
    at_vias="stops",
    overshoots=False,
    source="Simon and Isik 1993",
)


def trigonometric_spline(
    points: ArrayLike,
    times: ArrayLike,
    *,
    angle: float = np.pi / 4,
    velocities: ArrayLike | None = None,
    accelerations: ArrayLike | None = None,
    jerks: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """One trigonometric polynomial per segment, from position, velocity, acceleration and jerk at both its
    ends.

    With the segment mapped to an angle theta of 0 ... `angle`,
    ``q = a0 + sum_{k=1..3} (a_k cos k theta + b_k sin k theta) + a_4 sin 4 (theta - angle/2)``: eight
    coefficients for eight conditions (Simon and Isik, A Trigonometric Trajectory Generator for Robotic Arms,
    1993, after Schoenberg). The jerk is continuous, at rest too. Towards angle 0 it becomes `classic_septic`;
    beyond pi it overshoots wildly and is refused.

    The coefficients themselves grow like ``angle**-7``. So the same functions are written as
    ``E(w) + sigma O(w)``, E and O of degree 3, ``w = sin^2(phi/2) / sin^2(angle/4)``,
    ``sigma = sin(phi) / sin(angle/2)``, ``phi = theta - angle/2``, which is well conditioned for every angle;
    the jerk is turned into a Chebyshev series and integrated.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    angle : float
        Given to each segment, more than 0 and at most pi, rad.
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
        For an angle out of range, fewer than two points, times that do not increase, non-finite or misshapen
        arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.trigonometric_spline([[0.0], [1.0]], [0.0, 1.0])
    >>> round(float(move.extrema(1).max[0]), 4)
    2.2076
    """
    theta = checked_number("angle", angle, unit="rad")
    if not 0 < theta <= np.pi:
        raise InputError(
            f"angle = {theta:g} rad is outside ]0, pi] rad: beyond pi the trigonometric spline overshoots"
            " wildly, and at 0 it is classic_septic"
        )
    derivatives = [velocities, accelerations, jerks]
    return from_boundary_values("trigonometric_spline", points, times, derivatives, _laws(theta), joint_names)


@lru_cache(maxsize=64)
def _laws(angle: float) -> Array:
    """One motion for each boundary value, see `from_boundary_values`."""
    by_s = _derivative(angle)
    powers = [np.linalg.matrix_power(by_s, k) for k in range(4)]
    # w = 1 and sigma = -1 at s = 0, 1 at s = 1; the fifth even function only occurs in derivatives.
    conditions = np.array([np.repeat([1.0, end], [5, 4]) @ power for end in (-1, 1) for power in powers])
    conditions = np.delete(conditions, 4, axis=1)
    coefficients = np.insert(np.linalg.inv(conditions), 4, 0.0, axis=0)
    jerk = powers[3] @ coefficients
    series = smooth_series(lambda s: _functions(s, angle) @ jerk, 0.0, 1.0)
    starts = np.eye(8)[:3]
    return integrated(Piecewise(breaks=np.array([0.0, 1.0]), coefficients=series[:, None]), *starts[::-1]).coefficients[
        :, 0
    ]


def _functions(s: Array, angle: float) -> Array:
    """``1, w ... w^4, sigma, sigma w ... sigma w^3`` at s, shape (len(s), 9)."""
    phi = angle * (s - 0.5)
    w = (np.sin(phi / 2) / np.sin(angle / 4)) ** 2
    sigma = np.sin(phi) / np.sin(angle / 2)
    powers = np.vander(w, 5, increasing=True)
    return np.hstack([powers, sigma[:, None] * powers[:, :4]])


def _derivative(angle: float) -> Array:
    """The derivative by s of the coefficients of `_functions`, shape (9, 9).

    ``dw/ds = kappa sigma``, ``dsigma/ds = lambda (1 - mu w)`` and ``sigma^2 = w (2 - mu w) / (2 - mu)``, so
    ``(E + sigma O)' = lambda (1 - mu w) O + kappa sigma^2 O' + sigma kappa E'``. For an angle towards 0,
    kappa = 4, lambda = 2 and mu = 0: ordinary polynomials in ``2 s - 1``.
    """
    kappa, lam, mu = angle / np.tan(angle / 4), angle / np.sin(angle / 2), 2 * np.sin(angle / 4) ** 2
    matrix = np.zeros((9, 9))
    for k in range(4):
        even, odd = k, 5 + k
        matrix[5 + k, even + 1] = kappa * (k + 1)
        matrix[k, odd] = lam + 2 * kappa * k / (2 - mu)
        matrix[k + 1, odd] = -mu * (lam + kappa * k / (2 - mu))
    return matrix
