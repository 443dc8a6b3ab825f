"""The quickest motion of a family from limits alone, no times given."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.limits._stretching import stretched
from puma_septic.piecewise import Piecewise
from puma_septic.profiles import double_s, make
from puma_septic.profiles import names as profile_names
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array, checked_choice, checked_each

__all__ = ["within_limits"]

# A cruise that takes less than this part of its segment is rounding of one that takes no time.
_NO_PHASE = 1e-12
_UNITS = ("rad/s", "rad/s^2", "rad/s^3")
_STILL = "; two neighbouring points are the same, so give proportions"


def within_limits(
    family: str,
    points: ArrayLike,
    *,
    max_velocity: ArrayLike | None = None,
    max_acceleration: ArrayLike | None = None,
    max_jerk: ArrayLike | None = None,
    proportions: ArrayLike | None = None,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """The quickest motion of a family whose velocity, acceleration and jerk keep their limits.

    ``"trapezoidal"``: all joints in step on straight lines of joint space, with a stop at each point. With y from 0 to
    1 on a segment, ``V = min v_j / |h_j|`` and ``A = min a_j / |h_j|`` it takes ``1/V + V/A``, or ``2 / sqrt(A)`` where
    V is not reached (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, 3.2).
    ``"double_s"``: see `puma_septic.profiles.double_s`. Any other family whose times are given: made in some
    proportions of them, and then as long as the largest of ``(peak / limit)^(1/order)`` asks for, exactly.

    Parameters
    ----------
    family : str
        One of `names`.
    points : array_like, shape (k, n_joints)
        rad (m for prismatic joints).
    max_velocity, max_acceleration, max_jerk : array_like, shape () or (n_joints,), optional
        rad/s, rad/s^2, rad/s^3. Trapezoidal needs the first two, double_s all, the others at least one.
    proportions : array_like, shape (k - 1,), optional
        Of the durations of the segments, for families whose times are given; by default those of the largest joint
        movement.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        From time 0.

    Raises
    ------
    InputError
        For limits that are missing or not positive, or that the family cannot keep at any duration: a jerk limit of one
        whose acceleration steps; for points that do not move.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.within_limits("trapezoidal", [[0.0], [1.0]], max_velocity=1.0, max_acceleration=2.0)
    >>> move.duration, move.extrema(1).max.tolist()
    (1.5, [1.0])
    >>> points = [[0.0], [0.5], [1.0], [1.5]]
    >>> move = ps.within_limits("septic", points, max_velocity=1.0, max_jerk=20.0)
    >>> move.peak(3)[0].round(9).tolist(), bool(move.peak(1)[0][0] < 1)
    ([20.0], True)
    """
    checked_choice("family", family, profile_names())
    q, names = checked_array("points", points, (None, None)), tuple(joint_names or ())
    if len(q) < 2:
        raise InputError(f"{family} needs at least 2 points, got {len(q)}")
    given = {"max_velocity": max_velocity, "max_acceleration": max_acceleration, "max_jerk": max_jerk}
    limits = _limits(family, given, q.shape[1])
    if not np.ptp(q, axis=0).any():
        raise InputError(f"{family}: all points are the same, so that any duration is long enough")
    if family == "double_s":
        return double_s(q, **given, joint_names=names or None)
    if family == "trapezoidal":
        return _trapezoidal(q, limits[0], limits[1], names)
    return _scaled(family, q, limits, proportions, names)


def _limits(family: str, given: dict[str, ArrayLike | None], n: int) -> Array:
    """Limits by order, shape (3, n_joints); infinite where none is given."""
    rows = []
    for (name, value), unit in zip(given.items(), _UNITS, strict=True):
        rows.append(np.full(n, np.inf) if value is None else checked_each(name, value, n, unit=unit, above=0.0))
    needed = {"trapezoidal": 2, "double_s": 3}.get(family, 0)
    missing = [name for name in list(given)[:needed] if given[name] is None]
    if missing:
        raise InputError(f"{family} from limits alone needs {' and '.join(missing)}")
    if family == "trapezoidal" and given["max_jerk"] is not None:
        raise InputError("trapezoidal: its acceleration steps, so that no duration keeps max_jerk; double_s does")
    limits = np.array(rows)
    if np.isinf(limits).all():
        raise InputError(f"{family} from limits alone needs max_velocity, max_acceleration or max_jerk")
    return limits


def _trapezoidal(q: Array, velocity: Array, acceleration: Array, names: tuple[str, ...]) -> Trajectory:
    times, powers, breaks = [0.0], [], [0.0]
    for k, h in enumerate(np.diff(q, axis=0)):
        moved = np.abs(h)
        if not moved.any():
            raise InputError(f"trapezoidal: points {k} and {k + 1} are the same, so that any duration is long enough")
        with np.errstate(divide="ignore"):
            v, a = float((velocity / moved).min()), float((acceleration / moved).min())
        v = min(v, float(np.sqrt(a)))
        blend, cruise = v / a, max(1 / v - v / a, 0.0)
        phases = [(blend, 0.0, 0.0, a), (cruise, a * blend**2 / 2, v, 0.0), (blend, 1 - a * blend**2 / 2, v, -a)]
        for length, y, rate, bend in phases:
            if length > _NO_PHASE * (2 * blend + cruise):
                powers.append(np.array([q[k] + h * y, h * rate * length, h * bend * length**2 / 2]))
                breaks.append(breaks[-1] + length)
        times.append(breaks[-1])
    position = Piecewise.from_power(breaks, np.stack(powers, axis=1))
    return Trajectory(position=position, points=q, times=np.array(times), profile="trapezoidal", joint_names=names)


def _scaled(family: str, q: Array, limits: Array, proportions: ArrayLike | None, names: tuple[str, ...]) -> Trajectory:
    lengths = np.abs(np.diff(q, axis=0)).max(axis=1)
    given, why = (lengths, _STILL) if proportions is None else (proportions, "")
    parts = checked_array("proportions", given, (len(q) - 1,), above=0.0, remedy=why)
    times = np.concatenate([[0.0], np.cumsum(parts / parts.sum())])
    move = make(family, q, times, joint_names=names or None)
    demands = np.array([move.peak(order)[0] for order in (1, 2, 3)])
    if (np.isinf(demands) & np.isfinite(limits)).any():
        order = int(np.argwhere(np.isinf(demands) & np.isfinite(limits))[0, 0])
        what = ("velocity", "acceleration", "jerk")[order]
        raise InputError(f"{family}: its {what} is unbounded, so that no duration keeps max_{what}")
    shares = np.divide(demands, limits, out=np.zeros_like(demands), where=np.isfinite(limits))
    factors = shares ** (1 / np.arange(1.0, 4.0))[:, None]
    return stretched(move, float(factors.max()))
