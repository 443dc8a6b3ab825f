"""Straight lines joined by symmetric blends: parabolic (trapezoidal velocity) and of higher degree."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.profiles._asynchronous import Phases, side_by_side
from puma_septic.profiles._info import BIAGIOTTI, ProfileInfo
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_each

__all__ = ["POLYNOMIAL_BLENDS", "TRAPEZOIDAL", "polynomial_blends", "trapezoidal"]

TRAPEZOIDAL = ProfileInfo(
    name="trapezoidal",
    continuity="C1",
    inside="C1",
    needs="times, blend time or (2 points) cruise velocity",
    at_vias="misses",
    overshoots=False,
    source="Craig, Introduction to Robotics, 7.3",
)
POLYNOMIAL_BLENDS = ProfileInfo(
    name="polynomial_blends",
    continuity="C2",
    inside="C2",
    needs="times, blend time; class by degree",
    at_vias="misses",
    overshoots=False,
    source=f"{BIAGIOTTI}, 3.3",
)

_DEGREES = (3, 5, 7, 9)


def trapezoidal(
    points: ArrayLike,
    times: ArrayLike,
    *,
    blend_time: ArrayLike | None = None,
    cruise_velocity: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """Linear segments with parabolic blends (LSPB): the velocity of each joint is a trapezoid, or a row of
    them.

    Between two points, with blends of length Ta at both ends, the cruise velocity is ``v_c = h / (T - Ta)``,
    in [h/T, 2h/T], and the acceleration ``v_c / Ta`` (Biagiotti and Melchiorri). Through several
    points, blends of length b are centred on the vias, and the first and last lie inside their segments
    (Craig, Introduction to Robotics): a via is missed by ``b dv / 8``, dv the change of velocity
    across it. The acceleration steps at both ends of each blend. `lspb` is the smoother motion that Corke's
    toolbox makes of the same idea.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    blend_time : array_like, shape () or (k,), optional
        Total length of the blend at each point, positive, s. Either this or `cruise_velocity`.
    cruise_velocity : array_like, shape () or (n_joints,), optional
        For two points only: speed of each joint, more than abs(h)/T and at most 2 abs(h)/T, rad/s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks where blends begin and end.

    Raises
    ------
    InputError
        For blends that overlap, a cruise velocity out of range (the message tells the range), both or neither
        of `blend_time` and `cruise_velocity`, fewer than two points, times that do not increase, bad arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.trapezoidal([[0.0], [1.0]], [0.0, 3.0], blend_time=1.0)
    >>> float(move.extrema(1).max[0]), float(move.extrema(2).max[0])
    (0.5, 0.5)
    """
    vias = Vias.of("trapezoidal", points, times, joint_names)
    if (blend_time is None) == (cruise_velocity is None):
        given = "neither is" if blend_time is None else "both are"
        raise InputError(f"trapezoidal takes either blend_time or cruise_velocity; {given} given")
    blends = _blends_for_cruise(vias, cruise_velocity) if blend_time is None else _blend_times(vias, blend_time)
    return vias.trajectory(_blended(vias, blends, 3))


def polynomial_blends(
    points: ArrayLike,
    times: ArrayLike,
    *,
    blend_time: ArrayLike,
    degree: int = 5,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """Linear segments with polynomial blends of degree n.

    A blend of length b leads from one line to the next with all derivatives from the second to the (n -
    1)/2-th zero at both its ends; so the motion is of class C1, C2, C3, C4 for n = 3, 5, 7, 9. The lines meet
    at the via, so the leading coefficient vanishes: the cubic is the parabola of `trapezoidal`, the quintic a
    quartic with acceleration up to ``1.5 dv/b``, and so on. The first line passes through ``(t0 + b/2, q0)``,
    the last through ``(t1 - b/2, q1)``. A via is missed by ``c b dv``, c = 1/8, 3/32, 5/64, 35/512 (Biagiotti
    and Melchiorri, Trajectory Planning for Automatic Machines and Robots and, with the blends
    centred on the vias, Craig, Introduction to Robotics).

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    blend_time : array_like, shape () or (k,)
        Total length of the blend at each point, positive, s.
    degree : int
        3, 5, 7 or 9.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks where blends begin and end.

    Raises
    ------
    InputError
        For another degree, blends that overlap, fewer than two points, times that do not increase, bad
        arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.polynomial_blends([[0.0], [1.0]], [0.0, 3.0], blend_time=1.0)
    >>> float(move.extrema(1).max[0]), float(move.extrema(2).max[0])
    (0.5, 0.75)
    """
    vias = Vias.of("polynomial_blends", points, times, joint_names)
    if not isinstance(degree, int) or degree not in _DEGREES:
        raise InputError(f"degree = {degree!r} is not one of {', '.join(map(str, _DEGREES))}")
    return vias.trajectory(_blended(vias, _blend_times(vias, blend_time), degree))


def _blend_times(vias: Vias, given: ArrayLike) -> Array:
    """Of each point and joint, shape (k, n_joints)."""
    remedy = "; without blends, take profile linear"
    blends = checked_each("blend_time", given, len(vias.q), unit="s", above=0.0, remedy=remedy)
    return np.repeat(blends[:, None], vias.n_joints, axis=1)


def _blends_for_cruise(vias: Vias, cruise_velocity: ArrayLike | None) -> Array:
    """``Ta = T - abs(h) / v_c`` at both ends, shape (2, n_joints)."""
    if len(vias.q) != 2:
        raise InputError(
            f"cruise_velocity needs exactly 2 points, got {len(vias.q)}: between several, the velocities"
            " follow from times and blend_time"
        )
    speed = vias.boundary("cruise_velocity", cruise_velocity)
    T, h = vias.t[1], np.abs(vias.q[1] - vias.q[0])
    moves = h > 0
    bad = moves & ~((speed > h / T) & (speed <= 2 * h / T * (1 + 1e-12)))
    if bad.any():
        j = int(np.argmax(bad))
        raise InputError(
            f"{vias.labels[j]}: cruise_velocity = {speed[j]:g} must be more than h/T = {h[j] / T:g} and at most 2 h/T ="
            f" {2 * h[j] / T:g} to cover h = {h[j]:g} in T = {T:g} s (rad and rad/s; m and m/s if prismatic)"
        )
    blend = np.full(len(h), T / 2)
    blend[moves] = np.minimum(T - h[moves] / speed[moves], T / 2)
    if moves.any():
        blend[~moves] = blend[moves][0]
    return np.stack([blend, blend])


def _blended(vias: Vias, blends: Array, degree: int) -> Piecewise:
    """Blends and lines in turn, for each joint."""
    # The first and the last blend lie inside their segments, the others around their vias.
    middle = np.repeat(vias.t[:, None], vias.n_joints, axis=1)
    middle[0] += blends[0] / 2
    middle[-1] -= blends[-1] / 2
    starts = np.stack([middle - blends / 2, middle + blends / 2], axis=1).reshape(-1, vias.n_joints)
    starts[0], starts[-1] = vias.t[0], vias.t[-1]
    _check_overlap(starts, blends)
    phases = Phases.from_starts(starts)
    v = np.diff(vias.q, axis=0) / np.diff(middle, axis=0)
    rest = np.zeros((1, vias.n_joints))
    v_in, v_out = np.concatenate([rest, v]), np.concatenate([v, rest])
    shape = _velocity_step_integral((degree - 1) // 2)
    powers = np.zeros((len(shape), 2 * len(vias.q) - 1, vias.n_joints))
    lengths, since = phases.lengths, phases.starts[:-1] - np.repeat(middle, 2, axis=0)[:-1]
    powers[:, ::2] = shape[:, None, None] * (lengths[::2] * (v_out - v_in))
    powers[0, ::2] += vias.q + v_in * since[::2]
    powers[1, ::2] += v_in * lengths[::2]
    powers[0, 1::2] = vias.q[:-1] + v * since[1::2]
    powers[1, 1::2] = v * lengths[1::2]
    return side_by_side(phases, powers)


def _check_overlap(starts: Array, blends: Array) -> None:
    """Refuse lines of negative length; one of length zero is left out."""
    line = np.diff(starts, axis=0)[1::2]
    room = -1e-12 * starts[-1].max()
    if (line < room).any():
        k = int(np.argmin(line.min(axis=1)))
        raise InputError(
            f"blend_time: the blends at points {k} and {k + 1}, of {blends[k].max():g} s and"
            f" {blends[k + 1].max():g} s, overlap by {-line[k].min():g} s"
        )
    starts[2::2] = np.maximum(starts[2::2], starts[1:-1:2])


def _velocity_step_integral(m: int) -> Array:
    """Powers of s of the integral of the smooth step from 0 to 1 with m - 1 derivatives zero at both ends.

    The step is ``sum_{k<m} (-1)^k C(m-1+k, k) C(2m-1, m-1-k) s^(m+k)``; m = 1 is a ramp, 2 the cubic 3 s^2 -
    2 s^3.
    """
    powers = np.zeros(2 * m + 1)
    for k in range(m):
        powers[m + k + 1] = (-1) ** k * comb(m - 1 + k, k) * comb(2 * m - 1, m - 1 - k) / (m + k + 1)
    return powers
