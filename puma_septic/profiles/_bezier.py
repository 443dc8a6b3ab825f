"""The Bezier curve of the points."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.piecewise import Piecewise, matrices
from puma_septic.profiles._info import BIAGIOTTI, SMOOTH, ProfileInfo
from puma_septic.profiles._integration import integrated
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["BEZIER", "bezier"]

BEZIER = ProfileInfo(
    name="bezier",
    continuity="C2",
    inside=SMOOTH,
    needs="times (only the first and last count)",
    at_vias="misses",
    overshoots=False,
    source=f"{BIAGIOTTI}, appendix B",
)

# Measured on 300 curves of up to 24 points: with 4 to 6 coefficients velocity and acceleration at the ends are zero to
# 3e-14 of their peaks, and no curve leaves the hull of its points.
_KEPT = 6
# Binomial coefficients beyond order 1029 are no doubles.
_MOST_POINTS = 1000


def bezier(points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None) -> Trajectory:
    """One Bezier curve with the points as control polygon, at rest at both ends.

    ``q = sum_i C(n, i) s^i (1 - s)^(n - i) P_i``, s = (t - t_0)/(t_end - t_0); the first and last point count
    three times, so velocity and acceleration are zero there, and the degree is n = k + 3. It misses the vias
    between, by more the more there are, and never leaves the hull of the points; infinitely smooth inside,
    the jerk steps at both ends. Two points give the quintic from rest to rest. For reference (Biagiotti and
    Melchiorri, Trajectory Planning for Automatic Machines and Robots, appendix B).

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s; only the first and the last determine the curve.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        One interval, of degree k + 3.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.bezier([[0.0], [1.0]], [0.0, 1.0])
    >>> round(float(move.extrema(1).max[0]), 12)
    1.875
    """
    vias = Vias.of("bezier", points, times, joint_names, at_most=_MOST_POINTS)
    control = np.concatenate([vias.q[:1], vias.q[:1], vias.q, vias.q[-1:], vias.q[-1:]]) - vias.q[0]
    degree = len(control) - 1
    # The jerk is a Bezier curve too, of the third differences.
    scale = degree * (degree - 1) * (degree - 2) / vias.t[-1] ** 3
    jerk = Piecewise(
        breaks=vias.t[[0, -1]],
        coefficients=_bernstein_series(scale * np.diff(control, n=3, axis=0))[:, None],
    )
    rest = np.zeros(vias.n_joints)
    series = integrated(jerk, rest, rest, rest).coefficients.copy()
    # The curve itself lends the coefficients in which rounding of the jerk, which is larger by the cube of the degree,
    # adds up; from the next on it is divided by the cube of the coefficient's number.
    series[:_KEPT, 0] = _bernstein_series(control)[:_KEPT]
    series[0] += vias.q[0]
    return vias.trajectory(Piecewise(breaks=vias.t[[0, -1]], coefficients=series))


def _bernstein_series(control: Array) -> Array:
    """Chebyshev coefficients of a Bezier curve, from its values at the nodes."""
    degree = len(control) - 1
    s = (matrices.nodes(degree)[:, None] + 1) / 2
    i = np.arange(degree + 1)
    basis = np.array([float(comb(degree, k)) for k in i]) * s**i * (1 - s) ** (degree - i)
    return np.asarray(matrices.coefficients_from_values(degree) @ basis @ control)
