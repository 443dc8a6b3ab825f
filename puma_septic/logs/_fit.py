"""From samples to a trajectory, with what the samples leave unknown.

SciPy does the arithmetic (`make_interp_spline`, `BSpline.design_matrix`, banded Cholesky factors) and its splines are
converted exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline

from puma_septic.errors import InputError
from puma_septic.logs._breaks import find_breaks
from puma_septic.logs._clock import even_stamps
from puma_septic.logs._file import JointLog
from puma_septic.logs._noise import encoder_step, sample_noise
from puma_septic.logs._rests import Ends, EndsRule, ends_of, find_rests
from puma_septic.logs._slopes import has_velocities, through_slopes
from puma_septic.logs._smoothing import Smoothed, even_knots, smooth_joint
from puma_septic.logs._spline import (
    DEGREE,
    as_piecewise,
    as_spline,
    constant_between,
    knots_on,
    least_squares,
    merged_columns,
)
from puma_septic.logs._spread import (
    Spread,
    noise_doubts,
    sample_doubts,
    sample_remarks,
    through,
    velocity_step_doubts,
)
from puma_septic.logs._suspicions import suspicions
from puma_septic.trajectory import Trajectory
from puma_septic.validation import (
    Array,
    checked_array,
    checked_choice,
    checked_each,
    checked_kind,
    checked_texts,
    checked_times,
)

__all__ = ["FitResidual", "LogFit", "fit_log", "fit_residual", "fit_samples", "fit_trajectory"]

# More intervals than this take seconds and a gigabyte to assess; longer logs get one for every few samples.
_MOST_INTERVALS: Final = 10_000
# Rounding to a step makes noise of step / sqrt(12) while a joint moves; less is seen where it is slow.
_OF_STEP: Final = 0.1
# Rows further apart than this, s, see no rest.
_LONG_STEP: Final = 1.0
# Part of a position that its arithmetic leaves.
_ROUNDING: Final = 1e-14
# A slope of squared residuals over squared speeds that is this many standard errors above zero is jitter of the stamps.
_CERTAIN: Final = 4.0
# Part of the residual that is left to noise where jitter explains nearly all of it.
_LEAST_PLAIN: Final = 0.01

Smoothing = ArrayLike | Literal["auto"] | None


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


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LogFit:
    """A trajectory through the samples of a log, and how well the samples determine it.

    Attributes
    ----------
    trajectory : Trajectory
        Its `doubts` tell what must be settled before a verdict, its `remarks` what else the samples leave unknown.
    spread : Spread
        The spline, the noise, and what the noise leaves unknown.
    questions : tuple of str
        Those of the trajectory's doubts that no band of torque answers.
    jitter : float
        Standard deviation of the stamps from the instants of sampling, s; 0 where none is seen (only smoothing by
        "auto" tells it from noise).
    encoder_step : ndarray, shape (n_joints,)
        Of which all changes are whole multiples, rad (m); 0 where there is none.
    wraps : ndarray of int, shape (n_joints,)
        Jumps by a turn that were taken out of continuous joints.
    """

    trajectory: Trajectory
    spread: Spread
    questions: tuple[str, ...]
    jitter: float
    encoder_step: Array
    wraps: NDArray[np.int64]

    @property
    def noise(self) -> Array:
        """Standard deviation of the noise of a sample, rad (m), shape (n_joints,)."""
        return self.spread.noise


def fit_trajectory(
    t: ArrayLike,
    q: ArrayLike,
    *,
    v: ArrayLike | None = None,
    a: ArrayLike | None = None,
    smoothing: Smoothing = None,
    joint_names: Sequence[str] | None = None,
    continuous: ArrayLike | None = None,
    resolution: ArrayLike | None = None,
    ends: EndsRule = "auto",
) -> Trajectory:
    """A quintic spline through, or near, the samples of a motion made elsewhere.

    - Positions alone: the interpolating quintic spline, continuous to the fourth derivative. More than 10,000 samples
      get a knot for every few of them, and the spline nearest to them in the least-squares sense.
    - With `smoothing`, for noisy samples: "auto" is the penalised quintic spline of greatest restricted likelihood; a
      number the least-squares spline on as few intervals as hold the RMS residual of every joint to that value,
      constant where the samples show no motion. What noise hides of a motion's first and last moments is rest there:
      RMS torques are 1 to 3 % low by it beside rests; those of "auto" are not.
    - With velocities, as planners give them: the spline of the positions alone where it has these velocities, which
      shows where the acceleration steps; else a quintic per step through q and v whose accelerations make the jerk
      continuous too, zero at both ends. With accelerations also: a quintic per step through all three.

    Whether the log begins and ends at rest is read off the samples: where a joint moves there, beyond noise, the log is
    an excerpt, its spline is free there, and nothing is assumed of what comes before or after
    (`Trajectory.rest_before`, `rest_after`). An acceleration there is kept too.

    Noise is estimated from the samples. Where it is most of the jerk, or where units are doubtful, the trajectory's
    `doubts` say so, and an assessment of it gives no verdict. Stamps may count from any instant; those that are even
    but for their last digit are taken as even.

    The trajectory keeps the samples as its `points` and `times`: `fit_residual` tells what is left.

    Parameters
    ----------
    t : array_like, shape (n,)
        At least two, strictly increasing, s.
    q : array_like, shape (n, n_joints)
        rad (m for prismatic joints).
    v, a : array_like, shape (n, n_joints), optional
        rad/s and rad/s^2; `a` only with `v`.
    smoothing : "auto", or array_like of shape () or (n_joints,), optional
        Greatest RMS residual, positive, rad: about the noise of the samples.
    joint_names : sequence of str, optional
    continuous : array_like of bool, shape (n_joints,), optional
        Joints that turn without bounds: jumps by a turn are taken out.
    resolution : array_like, shape () or (n_joints,), optional
        Travel below which a joint is at rest, rad; by default what the noise makes of a joint at rest.
    ends : {"auto", "rest", "moving"}
        Read off the samples, or take both ends for rest, or neither.

    Returns
    -------
    Trajectory

    Raises
    ------
    InputError
        For times that do not increase, bad arrays, `a` without `v`, `smoothing` together with `v`, and a
        `smoothing` that is out of reach (the message tells the residual that is left).

    Examples
    --------
    >>> import numpy as np
    >>> import puma_septic as ps
    >>> t = np.linspace(0.0, 2.0, 50)
    >>> move = ps.fit_trajectory(t, np.sin(np.pi * t / 4)[:, None] ** 4)
    >>> bool(ps.fit_residual(move).max[0] < 1e-14), move.rest_before, move.rest_after
    (True, True, True)
    """
    samples = checked_array("q", q, (None, None))
    times = checked_times("t", t, len(samples))
    if len(samples) < 2 or not samples.shape[1]:
        raise InputError(f"q: at least 2 samples of one joint are needed, got the shape {samples.shape}")
    if v is not None or a is not None:
        if smoothing is not None:
            raise InputError("smoothing fits positions alone; give either smoothing or v and a")
        if v is None:
            raise InputError("a is given without v; accelerations need the velocities too")
        v = checked_array("v", v, samples.shape)
    alone = fit_samples(
        times,
        samples,
        smoothing=smoothing,
        joint_names=joint_names,
        continuous=continuous,
        resolution=resolution,
        ends=ends,
    ).trajectory
    if v is None or (a is None and has_velocities(alone, v)):
        return alone
    return through_slopes(alone, v, a, ends)


def fit_samples(
    times: Array,
    samples: Array,
    *,
    smoothing: Smoothing = None,
    joint_names: Sequence[str] | None = None,
    continuous: ArrayLike | None = None,
    resolution: ArrayLike | None = None,
    ends: EndsRule = "auto",
    bounds: Array | None = None,
    units_stated: bool = False,
) -> LogFit:
    """`fit_trajectory` of checked positions, with what the samples leave unknown.

    Parameters
    ----------
    bounds : ndarray, shape (n_joints, 2), optional
        Of the positions, by which units are doubted.
    units_stated : bool
        Whether somebody has said what the units are; else they are doubted where the values look like others.
    """
    checked_choice("ends", ends, ("auto", "rest", "moving"))
    n = samples.shape[1]
    names = checked_texts("joint_names", joint_names)
    labels = [f"joint {name!r}" for name in names] or [f"joint {j + 1}" for j in range(n)]
    t = even_stamps(times - times[0], 2 * float(np.spacing(np.abs(times).max())))
    q, wraps = _unwrapped(samples, continuous)
    noise = sample_noise(t, q)
    # Rounding to a step would be seen as noise; the changes of a smooth motion may be whole multiples by themselves.
    whole = encoder_step(q)
    step = np.where(noise > _OF_STEP * whole, whole, 0.0)
    noise = np.maximum(noise, step / np.sqrt(12))
    found = ends_of(t, q, noise, step, ends)
    spread, jitter = _fitted(t, q, noise, step, smoothing, found, labels)
    questions = (
        *sample_doubts(spread, labels),
        *velocity_step_doubts(spread, labels),
        *suspicions(t, q, labels, bounds=bounds, units_stated=units_stated),
    )
    trajectory = Trajectory(
        position=as_piecewise(spread.spline, float(times[0]), np.ptp(q, axis=0) == 0),
        points=q,
        times=times,
        profile="fit_trajectory",
        joint_names=names,
        resolution=_resolution(t, spread) if resolution is None else checked_each("resolution", resolution, n),
        rest_before=found.rests[0],
        rest_after=found.rests[1],
        doubts=(*noise_doubts(spread, labels), *questions),
        remarks=sample_remarks(spread, labels),
    )
    return LogFit(
        trajectory=trajectory, spread=spread, questions=questions, jitter=jitter, encoder_step=step, wraps=wraps
    )


def fit_log(
    log: JointLog,
    *,
    smoothing: Smoothing = None,
    resolution: ArrayLike | None = None,
    ends: EndsRule = "auto",
    bounds: Array | None = None,
) -> LogFit:
    r"""`fit_trajectory` of a log that was read, with its joints and what is known of its units.

    Parameters
    ----------
    log : JointLog
    smoothing, resolution, ends
        As `fit_trajectory`.
    bounds : ndarray, shape (n_joints, 2), optional
        Of the positions, as ``robot.limits.position``: units are doubted where they leave it.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from puma_septic.logs import fit_log, read_log
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "log.csv")
    ...     _ = path.write_text("t,elbow\n" + "".join(f"{k / 50},{(k / 50) ** 2}\n" for k in range(50)))
    ...     fit = fit_log(read_log(path))
    >>> fit.trajectory.rest_before, fit.trajectory.rest_after, fit.trajectory.doubts
    (True, False, ())
    """
    return fit_samples(
        log.t,
        log.q,
        smoothing=smoothing,
        joint_names=log.joint_names,
        continuous=log.is_continuous,
        resolution=resolution,
        ends=ends,
        bounds=bounds,
        units_stated=log.units_stated,
    )


def fit_residual(trajectory: Trajectory) -> FitResidual:
    """How far a trajectory is from its points at their times: the residual of `fit_trajectory`.

    Returns
    -------
    FitResidual
    """
    difference = checked_kind("trajectory", trajectory, Trajectory).points - trajectory(trajectory.times)
    return FitResidual(max=np.abs(difference).max(axis=0), rms=np.sqrt((difference**2).mean(axis=0)))


def _resolution(t: Array, spread: Spread) -> Array:
    """Travel that counts as rest; none where rows are too far apart to tell a rest from a motion."""
    if np.median(np.diff(t)) > _LONG_STEP:
        return np.zeros(len(spread.noise))
    rounding = _ROUNDING * np.abs(spread.spline(t)).max(axis=0)
    return np.asarray(np.maximum(spread.travel_at_rest, rounding))


def _unwrapped(samples: Array, continuous: ArrayLike | None) -> tuple[Array, NDArray[np.int64]]:
    """Positions without jumps by a turn in continuous joints, and how many there were."""
    n = samples.shape[1]
    turning = np.asarray(False if continuous is None else continuous)
    if turning.dtype != np.bool_ or turning.shape not in ((), (n,)):
        raise InputError(f"continuous: expected True or False, or one of them for each of {n} joints")
    q = np.where(turning, np.unwrap(samples, axis=0), samples)
    return q, (np.abs(np.diff(q - samples, axis=0)) > np.pi).sum(axis=0)


def _fitted(
    t: Array, q: Array, noise: Array, step: Array, smoothing: Smoothing, ends: Ends, labels: Sequence[str]
) -> tuple[Spread, float]:
    """The spline as asked, with its spread, and the jitter of the stamps."""
    if isinstance(smoothing, str):
        checked_choice("smoothing", smoothing, ("auto",))
        return _smoothed(t, q, ends)
    if smoothing is not None:
        remedy = "; leave it out to interpolate"
        allowed = checked_each("smoothing", smoothing, q.shape[1], unit="rad", labels=labels, above=0.0, remedy=remedy)
        return _within(t, q, allowed, ends, find_rests(t, q, noise, step), labels), 0.0
    stride = -(-len(t) // _MOST_INTERVALS)
    if stride > 1 and noise.any():
        return _nearest(t, q, np.append(t[:-1:stride], t[-1]), ends, np.empty((0, 2), np.int64)), 0.0
    return through(t, q, noise, ends.slopes, find_breaks(t, q, noise, ends.slopes), stride), 0.0


def _smoothed(t: Array, q: Array, ends: Ends) -> tuple[Spread, float]:
    """The splines of greatest restricted likelihood; samples count for less where the arm is fast and stamps jitter."""
    knots, joints = even_knots(t), range(q.shape[1])
    weights = np.ones_like(q)

    def fits() -> tuple[Smoothed, ...]:
        return tuple(smooth_joint(t, q[:, j], knots, weights=weights[:, j], rest=ends.orders(j)) for j in joints)

    parts = fits()
    spline = as_spline(knots, [part.coefficients for part in parts])
    jitter, weights = _jitter(q - spline(t), spline(t, nu=1), np.array([part.noise for part in parts]))
    if jitter:
        parts = fits()
        spline = as_spline(knots, [part.coefficients for part in parts])
    noise = np.array([part.noise for part in parts])
    return Spread(spline=spline, times=t, noise=noise, parts=parts, is_regularised=True), jitter


def _jitter(residual: Array, v: Array, noise: Array) -> tuple[float, Array]:
    """Standard deviation of the stamps, s, and weights of the samples: squared residuals are sigma^2 + jitter^2 v^2.

    The slope is that of all joints together, each in units of its own noise; it counts where it is surely above zero.
    """
    some = noise > 0
    y, x = residual[:, some] ** 2 / noise[some] ** 2, v[:, some] ** 2 / noise[some] ** 2
    dx, dy = x - x.mean(axis=0), y - y.mean(axis=0)
    total = (dx**2).sum()
    slope = (dx * dy).sum() / total if total > 0 else 0.0
    if slope <= 0 or slope**2 * total <= _CERTAIN**2 * dy.var():
        return 0.0, np.ones_like(residual)
    plain = np.maximum(y.mean(axis=0) - slope * x.mean(axis=0), _LEAST_PLAIN)
    weights = np.ones_like(residual)
    weights[:, some] = plain / (plain + slope * x)
    return float(np.sqrt(slope)), weights


def _within(t: Array, q: Array, allowed: Array, ends: Ends, rests: NDArray[np.int64], labels: Sequence[str]) -> Spread:
    """The least-squares quintic spline on the fewest intervals, of a growing row, that holds the residual."""
    intervals, residual = 1, np.full(len(allowed), np.inf)
    # With fewer than two samples to an interval it would be interpolation, and the system might be singular.
    while 2 * intervals <= len(t):
        breaks = _moving_breaks(t, rests, intervals)
        spread = _nearest(t, q, breaks, ends, rests)
        residual = np.sqrt(((q - spread.spline(t)) ** 2).mean(axis=0))
        if (residual <= allowed).all():
            return spread
        intervals += max(1, intervals // 3)
    j = int(np.argmax(residual / allowed))
    raise InputError(
        f"{labels[j]}: smoothing = {allowed[j]:g} rad is out of reach: with {len(breaks) - 1} intervals for"
        f" {len(t)} samples an RMS residual of {residual[j]:g} rad is left; allow more, or leave it out to interpolate"
    )


def _inner(rests: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """Where rests begin and end, but for the ends of the log."""
    edges = np.unique(rests)
    return edges[(edges > 0) & (edges < n - 1)]


def _moving_breaks(t: Array, rests: NDArray[np.int64], intervals: int) -> Array:
    """Breaks evenly among the samples, none inside a rest: so many intervals on what moves, one at least on a part."""
    edges = np.concatenate([[0], _inner(rests, len(t)), [len(t) - 1]])
    still = np.isin(edges[:-1], rests[:, 0]) & np.isin(edges[1:], rests[:, 1])
    lengths = np.diff(edges)
    shares = np.maximum(1, np.rint(intervals * lengths / max(1, lengths[~still].sum()))).astype(int)
    parts = [
        np.linspace(first, last, 1 if rest else share, endpoint=False)
        for first, last, rest, share in zip(edges[:-1], edges[1:], still, shares, strict=True)
    ]
    return np.asarray(np.interp(np.concatenate([*parts, [len(t) - 1]]), np.arange(len(t)), t))


def _nearest(t: Array, q: Array, breaks: Array, ends: Ends, rests: NDArray[np.int64]) -> Spread:
    """The least-squares spline with knots at the breaks, constant in rests."""
    # Where a rest begins or ends the jerk may step.
    knots, parts = np.sort(np.concatenate([knots_on(breaks), np.repeat(t[_inner(rests, len(t))], 2)])), []
    for j, column in enumerate(q.T):
        merged = constant_between(merged_columns(len(knots) - DEGREE - 1, ends.orders(j)), knots, t[rests])
        c, factor = least_squares(t, column, knots, merged)
        left = column - BSpline(knots, c, DEGREE)(t)
        free = max(1, len(t) - factor.shape[1])
        noise = float(np.sqrt((left**2).sum() / free))
        parts.append(Smoothed(coefficients=c, noise=noise, factor=factor, merged=merged))
    spline = as_spline(knots, [part.coefficients for part in parts])
    return Spread(spline=spline, times=t, noise=np.array([part.noise for part in parts]), parts=tuple(parts))
