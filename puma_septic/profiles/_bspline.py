"""B-splines of degree 3 and 5: through the points, and with the points as control polygon."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise, matrices
from puma_septic.profiles._info import BIAGIOTTI, ProfileInfo
from puma_septic.profiles._segments import at_ends, solve_segments, through
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["BSPLINE", "BSPLINE_CONTROL", "bspline", "bspline_control"]

BSPLINE = ProfileInfo(
    name="bspline",
    continuity="C3",
    inside="C4",
    needs="times; degree 5 (C2 with degree 3)",
    at_vias="passes",
    overshoots=True,
    source="Gasparetto and Zanotto 2007",
)
BSPLINE_CONTROL = ProfileInfo(
    name="bspline_control",
    continuity="C4",
    inside="C4",
    needs="times; degree 5 (C2 with degree 3)",
    at_vias="misses",
    overshoots=False,
    source=f"{BIAGIOTTI}, 4.5",
)

_DEGREES = (3, 5)


def bspline(
    points: ArrayLike,
    times: ArrayLike,
    *,
    degree: int = 5,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """The B-spline of degree 3 or 5 through the points, at knots that are averages of the via times.

    Knot i is the mean of `degree` successive times, those at the ends counted once for each condition there
    (de Boor, A Practical Guide to Splines; uniform where the times are). So there are two knots
    more than vias, which leaves room for rest at both ends: velocity and acceleration zero with degree 3, the
    jerk too with degree 5 (Gasparetto and Zanotto, A New Method for Smooth Trajectory Planning of Robot
    Manipulators, 2007). Continuous to the second or fourth derivative; the cubic's jerk is a staircase.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    degree : int
        3 or 5.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the knots.

    Raises
    ------
    InputError
        For another degree, fewer than two points, times that do not increase or are too uneven, bad arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.bspline([[0.0], [1.0], [0.5]], [0.0, 1.0, 2.0])
    >>> move([0.0, 1.0, 2.0]).round(12).ravel().tolist(), len(move.jumps(3).times)
    ([0.0, 1.0, 0.5], 0)
    """
    vias = Vias.of("bspline", points, times, joint_names)
    _check_degree(degree)
    rest = np.zeros(vias.n_joints)
    orders = range(1, 3 if degree == 3 else 4)
    conditions = through(vias.t, vias.q)
    for order in orders:
        conditions += at_ends(vias.t, order, rest, rest)
    breaks = _breaks(_with_ends_repeated(vias.t, len(orders)), degree)
    return vias.trajectory(solve_segments(breaks, [degree] * (len(breaks) - 1), degree - 1, conditions))


def bspline_control(
    points: ArrayLike,
    times: ArrayLike,
    *,
    degree: int = 5,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """The B-spline of degree 3 or 5 that has the points as its control polygon.

    ``q(t) = sum_i N_i(t) P_i``; the first and last point count `degree` times, so that the curve starts and
    ends there at rest, with all its continuous derivatives zero; knots are averages of the times as in
    `bspline` (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots,
    appendix B). It misses the vias between, smooths the corners there and never leaves the hull of the
    points. Continuous to the second or fourth derivative.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s; the vias' times place the knots.
    degree : int
        3 or 5.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the knots.

    Raises
    ------
    InputError
        For another degree, fewer than two points, times that do not increase, bad arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.bspline_control([[0.0], [1.0], [0.0]], [0.0, 1.0, 2.0], degree=3)
    >>> float(move.extrema(0).max[0]) < 1.0, float(move.overshoot[0])
    (True, 0.0)
    """
    vias = Vias.of("bspline_control", points, times, joint_names)
    _check_degree(degree)
    breaks = _breaks(_with_ends_repeated(vias.t, degree - 1), degree)
    return vias.trajectory(_from_control_points(_with_ends_repeated(vias.q, degree - 1), breaks, degree))


def _check_degree(degree: int) -> None:
    if not isinstance(degree, int) or degree not in _DEGREES:
        raise InputError(f"degree = {degree!r} is not one of {', '.join(map(str, _DEGREES))}")


def _with_ends_repeated(rows: Array, further: int) -> Array:
    """The first and last row that many times more."""
    return np.concatenate([np.repeat(rows[:1], further, axis=0), rows, np.repeat(rows[-1:], further, axis=0)])


def _breaks(sites: Array, degree: int) -> Array:
    """The ends and the distinct knots between them, averages of `degree` successive sites."""
    inner = sliding_window_view(sites, degree)[1:-1].mean(axis=1)
    return np.concatenate([sites[:1], inner, sites[-1:]])


def _from_control_points(control: Array, breaks: Array, degree: int) -> Piecewise:
    """The B-spline on simple inner knots and full end knots, by de Boor's recursion at each interval's nodes.

    Relative to the first control point, so that a joint that does not move has coefficients that are exactly
    zero.
    """
    knots = np.concatenate([np.repeat(breaks[0], degree), breaks, np.repeat(breaks[-1], degree)])
    interval = np.arange(len(breaks) - 1)
    x = matrices.nodes(degree)[:, None]
    t = (breaks[:-1] * (1 - x) + breaks[1:] * (1 + x)) / 2
    d = [np.broadcast_to((control - control[0])[interval + j], (*t.shape, control.shape[1])) for j in range(degree + 1)]
    for r in range(1, degree + 1):
        for j in range(degree, r - 1, -1):
            left, right = knots[interval + j], knots[interval + j + 1 + degree - r]
            part = ((t - left) / (right - left))[..., None]
            d[j] = (1 - part) * d[j - 1] + part * d[j]
    series = np.tensordot(matrices.coefficients_from_values(degree), d[degree], 1)
    series[0] += control[0]
    return Piecewise(breaks=breaks, coefficients=series)
