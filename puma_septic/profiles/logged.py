"""Motions made elsewhere: logged or planned samples, and CSV files of them, as trajectories.

SciPy does the arithmetic (`make_interp_spline`, `solve_banded`, sparse normal equations of
`BSpline.design_matrix`) and its splines are converted exactly. This module is not loaded with the other
profiles, because SciPy takes its time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline, make_interp_spline
from scipy.linalg import solve_banded
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve

from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.profiles._quintic import quintic
from puma_septic.profiles._vias import Vias
from puma_septic.profiles.log_files import JointLog, read_csv_trajectory
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array

__all__ = ["FitResidual", "JointLog", "fit_residual", "fit_trajectory", "read_csv_trajectory"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class FitResidual:
    """How far a trajectory is from the samples that it was made from.

    Attributes
    ----------
    max, rms : ndarray, shape (n_joints,)
        Of the differences at the sample times, rad.
    """

    max: Array
    rms: Array


def fit_trajectory(
    t: ArrayLike,
    q: ArrayLike,
    *,
    v: ArrayLike | None = None,
    a: ArrayLike | None = None,
    smoothing: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """A quintic spline through, or near, the samples of a motion made elsewhere.

    - Positions alone: the interpolating quintic spline, continuous to the fourth derivative, at rest at both ends
      (velocity and acceleration zero), as a recorded motion from stop to stop is.
    - With velocities, as planners give them: a quintic per step through q and v whose accelerations make the jerk
      continuous too; zero acceleration at both ends. With accelerations also: a quintic per step through all three.
    - With `smoothing`, for noisy samples: the least-squares quintic spline from rest to rest on as few intervals as
      hold the RMS residual of every joint to that value; the knots divide the samples evenly.

    The trajectory keeps the samples as its `points` and `times`: `fit_residual` tells what is left, and
    `via_miss` its largest value.

    Parameters
    ----------
    t : array_like, shape (n,)
        At least two, strictly increasing, s.
    q : array_like, shape (n, n_joints)
        rad (m for prismatic joints).
    v, a : array_like, shape (n, n_joints), optional
        rad/s and rad/s^2; `a` only with `v`.
    smoothing : array_like, shape () or (n_joints,), optional
        Greatest RMS residual, positive, rad: about the noise of the samples.
    joint_names : sequence of str, optional

    Raises
    ------
    InputError
        For times that do not increase, bad arrays, `a` without `v`, `smoothing` together with `v`, and a
        `smoothing` that is out of reach (the message tells the residual that is left).

    Examples
    --------
    >>> import numpy as np
    >>> from puma_septic.profiles.logged import fit_residual, fit_trajectory
    >>> t = np.linspace(0.0, 2.0, 50)
    >>> move = fit_trajectory(t, np.sin(np.pi * t / 4)[:, None] ** 4)
    >>> bool(fit_residual(move).max[0] < 1e-14)
    True
    """
    vias = Vias.of("fit_trajectory", q, t, joint_names)
    samples, times = vias.q, vias.times
    known = [
        None if given is None else checked_array(name, given, samples.shape, unit=unit)
        for name, given, unit in (("v", v, "rad/s"), ("a", a, "rad/s^2"))
    ]
    if smoothing is not None and (v is not None or a is not None):
        raise InputError("smoothing fits positions alone; give either smoothing or v and a")
    if a is not None and v is None:
        raise InputError("a is given without v; accelerations need the velocities too")
    if smoothing is not None:
        allowed = vias.boundary("smoothing", smoothing)
        position = _smoothed(times, samples, allowed, vias.labels)
    elif known[0] is not None:
        accelerations = _smooth_jerk(times, samples, known[0]) if known[1] is None else known[1]
        position = quintic(samples, times, velocities=known[0], accelerations=accelerations).position
    else:
        rest = [(order, np.zeros(samples.shape[1])) for order in (1, 2)]
        spline = make_interp_spline(times - times[0], samples - samples[0], k=5, bc_type=(rest, rest))
        position = _exactly(spline, times, samples[0])
    return Trajectory(
        position=position,
        points=samples,
        times=times,
        profile="fit_trajectory",
        joint_names=vias.joint_names,
    )


def fit_residual(trajectory: Trajectory) -> FitResidual:
    """How far a trajectory is from its points at their times: the residual of `fit_trajectory`."""
    difference = trajectory.points - trajectory(trajectory.times)
    return FitResidual(max=np.abs(difference).max(axis=0), rms=np.sqrt((difference**2).mean(axis=0)))


def _exactly(spline: BSpline, breaks: Array, origin: Array) -> Piecewise:
    """A SciPy spline, relative to the first break and to a position, as it is."""
    # The Taylor series at the start of each interval is the whole polynomial.
    lengths = np.diff(breaks)[:, None]
    starts = breaks[:-1] - breaks[0]
    powers = np.stack([spline(starts, nu=k) * lengths**k / math.factorial(k) for k in range(spline.k + 1)])
    powers[0] += origin
    return Piecewise.from_power(breaks, powers)


def _smooth_jerk(t: Array, q: Array, v: Array) -> Array:
    """The accelerations that make the jerk of quintics through q and v continuous; zero at both ends.

    On a step of T with slope m = (q1 - q0)/T, the quintic's jerk at its start is
    ``(60 m - 36 v0 - 24 v1)/T^2 - (9 a0 - 3 a1)/T`` and at its end
    ``(60 m - 24 v0 - 36 v1)/T^2 - (3 a0 - 9 a1)/T``: a tridiagonal system.
    """
    if len(t) == 2:
        return np.zeros_like(q)
    T = np.diff(t)[:, None]
    slope = np.diff(q, axis=0) / T
    start = (60 * slope - 36 * v[:-1] - 24 * v[1:]) / T**2
    end = (60 * slope - 24 * v[:-1] - 36 * v[1:]) / T**2
    bands = np.zeros((3, len(t) - 2))
    bands[1] = 9 * (1 / T[:-1] + 1 / T[1:])[:, 0]
    bands[0, 1:] = bands[2, :-1] = -3 / T[1:-1, 0]
    rest = np.zeros((1, q.shape[1]))
    return np.concatenate([rest, solve_banded((1, 1), bands, start[1:] - end[:-1]), rest])


def _smoothed(t: Array, q: Array, allowed: Array, labels: Sequence[str]) -> Piecewise:
    """The least-squares quintic spline on the fewest intervals, of a growing row, that holds the residual."""
    if not (allowed > 0).all():
        j = int(np.argmin(allowed))
        raise InputError(f"{labels[j]}: smoothing = {allowed[j]:g} rad must be positive; leave it out to interpolate")
    intervals, residual = 1, np.full(len(allowed), np.inf)
    # With fewer than two samples to an interval it would be interpolation, and the system might be singular.
    while 2 * intervals <= len(t):
        breaks, position, residual = _least_squares(t, q, intervals)
        if (residual <= allowed).all():
            return position
        intervals += max(1, intervals // 3)
    j = int(np.argmax(residual / allowed))
    raise InputError(
        f"{labels[j]}: smoothing = {allowed[j]:g} rad is out of reach: with {len(breaks) - 1} intervals for"
        f" {len(t)} samples an RMS residual of {residual[j]:g} rad is left; allow more, or leave it out to interpolate"
    )


def _least_squares(t: Array, q: Array, intervals: int) -> tuple[Array, Piecewise, Array]:
    """Breaks, spline and RMS residual; three equal coefficients at each end are rest there."""
    breaks = np.interp(np.linspace(0, len(t) - 1, intervals + 1), np.arange(len(t)), t)
    knots = np.concatenate([np.repeat(breaks[0], 5), breaks, np.repeat(breaks[-1], 5)]) - t[0]
    basis = BSpline.design_matrix(t - t[0], knots, 5)
    merged = np.clip(np.arange(intervals + 5) - 2, 0, intervals)
    basis = basis @ csr_array((np.ones(len(merged)), (np.arange(len(merged)), merged)))
    # The normal equations of B-splines are banded and well conditioned.
    solution = spsolve((basis.T @ basis).tocsc(), basis.T @ (q - q[0]))
    coefficients = solution.reshape(intervals + 1, -1)[merged]
    position = _exactly(BSpline(knots, coefficients, 5), breaks, q[0])
    return breaks, position, np.sqrt(((q - position(t)) ** 2).mean(axis=0))
