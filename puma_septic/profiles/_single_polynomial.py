"""One polynomial through all points, at any number of them: the paper's septic is the one of four."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.piecewise import Piecewise
from puma_septic.piecewise.matrices import end_derivatives, signs
from puma_septic.profiles._info import PAPER, SMOOTH, ProfileInfo
from puma_septic.profiles._segments import ALLOWED_DOUBT, ill_conditioned, refined
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, read_only

__all__ = [
    "SEPTIC",
    "SINGLE_POLYNOMIAL",
    "septic",
    "single_polynomial",
]

SEPTIC = ProfileInfo(
    name="septic",
    continuity="C2",
    inside=SMOOTH,
    needs="times, exactly 4 points",
    at_vias="passes",
    overshoots=True,
    source=PAPER,
)
# Of higher degree than 203 no times were found that rounding leaves solvable; 403 takes 5 s to say so.
_MOST_POINTS = 200


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
    return _through_all(
        vias,
        start_velocity=start_velocity,
        end_velocity=end_velocity,
        start_acceleration=start_acceleration,
        end_acceleration=end_acceleration,
    )


SINGLE_POLYNOMIAL = ProfileInfo(
    name="single_polynomial",
    continuity="C2",
    inside=SMOOTH,
    needs="times, up to about 30 points",
    at_vias="passes",
    overshoots=True,
    source=PAPER,
)


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

    Returns
    -------
    Trajectory
        One interval, of degree k + 3.

    Raises
    ------
    InputError
        For fewer than two points, too many or too unevenly timed ones for double precision, times that
        do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.single_polynomial([[0.0], [1.0], [0.5], [2.0], [1.0]], [0.0, 1.0, 2.0, 3.0, 4.0])
    >>> move.position.degree
    8
    """
    vias = Vias.of("single_polynomial", points, times, joint_names, at_most=_MOST_POINTS)
    return _through_all(
        vias,
        start_velocity=start_velocity,
        end_velocity=end_velocity,
        start_acceleration=start_acceleration,
        end_acceleration=end_acceleration,
    )


# Of the derivatives in the last four conditions: velocity at start and end, acceleration at start and end.
_END_ORDERS = np.array([[1.0], [1.0], [2.0], [2.0]])


def _through_all(vias: Vias, **ends: ArrayLike | None) -> Trajectory:
    """The polynomial through the vias; `ends` are velocity at start and end, acceleration at start and end."""
    values = np.array([vias.boundary(name, value) for name, value in ends.items()])
    series, doubt = _interpolated(vias.q - vias.q[0], vias.t, values)
    if not doubt <= ALLOWED_DOUBT:
        raise ill_conditioned(len(series) - 1, vias.t, doubt)
    series[0] += vias.q[0]
    position = Piecewise(breaks=vias.t[[0, -1]], coefficients=series[:, None, :])
    return vias.trajectory(position, start=values[::2], end=values[1::2])


def _interpolated(points: Array, t: Array, ends: Array) -> tuple[Array, float]:
    """Chebyshev coefficients (k + 4, n_joints), and a bound of how far they are off, relative to the movement.

    Where rounding of all coefficients is harmless whatever the points are, the inverse in extended precision gives
    them to a rounding; else see `refined`. With points relative to the first, a joint that does not move gets
    coefficients that are exactly zero.
    """
    conditions = _conditions(tuple(t.tolist()))
    right = np.concatenate([points, (t[-1] / 2) ** _END_ORDERS * ends])
    if conditions.inverse is None:
        return np.zeros_like(right), np.inf
    if conditions.doubt <= ALLOWED_DOUBT:
        return (conditions.exact_inverse @ right).astype(np.float64), conditions.doubt
    return refined(conditions.inverse.__matmul__, conditions.matrix.__matmul__, right)


class _Conditions(NamedTuple):
    """Conditions on the coefficients at times since the first, which are all that they depend on.

    The rows; their inverse in double precision, if there is one, and corrected by a step of Newton's method; and by how
    much a solution of it may be off, relative to its right-hand side.
    """

    matrix: NDArray[np.longdouble]
    inverse: Array | None
    exact_inverse: NDArray[np.longdouble]
    doubt: float


@lru_cache(maxsize=4)  # each of 200 points has 1.6 MB
def _conditions(t: tuple[float, ...]) -> _Conditions:
    degree = len(t) + 3
    angle = np.arccos(np.array(t, dtype=np.longdouble) / (t[-1] / 2) - 1)
    matrix = np.concatenate([np.cos(angle[:, None] * np.arange(degree + 1)), _end_conditions(degree)])
    try:
        inverse = np.linalg.inv(matrix.astype(np.float64))
    except np.linalg.LinAlgError:  # two times are the same, to rounding
        return _Conditions(matrix, None, matrix, np.inf)
    identity = np.eye(degree + 1)
    exact = np.asarray(inverse + inverse @ (identity - matrix @ inverse), dtype=np.longdouble)
    # |x| <= |inverse| |right|: a rounding of all coefficients, and what the inverse lacks.
    lacks = float(np.abs(identity - matrix @ exact).sum())
    size = float(np.abs(exact).sum())
    return _Conditions(matrix, inverse, exact, (np.finfo(np.float64).eps + lacks) * size)


@lru_cache(maxsize=16)
def _end_conditions(degree: int) -> Array:
    """First derivative of the basis at x = -1 and 1, then the second, shape (4, degree + 1)."""
    _, slope, curvature, _ = end_derivatives(degree)
    sign = signs(degree)
    return read_only([-sign * slope, slope, sign * curvature, curvature])
