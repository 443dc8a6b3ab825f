"""The least time through given points under limits of velocity, acceleration and jerk."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.assessment.texts import plain
from puma_septic.checks import Array, checked_array
from puma_septic.errors import InputError
from puma_septic.objectives import Candidate, interval_extremes
from puma_septic.optimisation.problems import Progress, checked_count, checked_setting, random_starts, search_from
from puma_septic.optimisation.searching import FINE
from puma_septic.optimisation.variables import MakeTrajectory, Variables
from puma_septic.tables import Cell, text_table
from puma_septic.trajectory import ORDERS, Trajectory

__all__ = ["LeastTime", "least_time"]

# A part of the needed time far below the largest one never governs; below this share of it, its root is cut off, which
# has an infinite slope at zero.
_IDLE: Final = 0.1
# What is at its limit to rounding keeps it.
_ROUNDING: Final = 1e-12
# A profile whose peaks, made anew at the scaled times, are this far off does not obey the law of scaling.
_UNSCALED: Final = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LeastTime:
    """What `least_time` reached.

    Attributes
    ----------
    trajectory : Trajectory
        The quickest motion found that keeps all limits.
    start : Trajectory
        The segments in the proportions begun with, as quick as the limits allow.
    limits : ndarray, shape (3, n_joints)
        Of velocity, acceleration, jerk; NaN where there is none.
    ends : tuple of float
        Least time at the end of each search, s.
    n_evaluations : int
    """

    trajectory: Trajectory
    start: Trajectory
    limits: Array
    ends: tuple[float, ...]
    n_evaluations: int

    @property
    def duration(self) -> float:
        """Least time found, s."""
        return self.trajectory.duration

    @property
    def utilisation(self) -> Array:
        """Exact peaks as shares of the limits, shape (3, n_joints); NaN where there is no limit."""
        return np.stack([self.trajectory.peak(order)[0] for order in (1, 2, 3)]) / self.limits

    @property
    def is_feasible(self) -> bool:
        """Whether every exact peak keeps its limit, to rounding."""
        used = self.utilisation
        return bool(np.all((used <= 1 + _ROUNDING) | np.isnan(self.limits)))

    @property
    def statement(self) -> str:
        """What was reached, and how sure it is."""
        same = sum(end <= self.duration * (1 + 1e-3) for end in self.ends)
        return (
            f"a local optimum, the best of {len(self.ends)} searches, {same} of which ended within 0.1 % of it; no"
            f" proof that none is quicker; feasible by exact extrema: {'yes' if self.is_feasible else 'no'}; SLSQP with"
            f" central differences, relative tolerance {FINE:g}, {self.n_evaluations} evaluations"
        )

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document, SI units."""
        return {
            "schema": "puma-septic/least-time/1",
            "profile": self.trajectory.profile,
            "duration": self.duration,
            "times": plain(self.trajectory.times),
            "breaks": plain(self.trajectory.breaks),
            "start": {"duration": self.start.duration, "times": plain(self.start.times)},
            "is_feasible": self.is_feasible,
            "utilisation": {name: plain(row) for name, row in zip(ORDERS[1:], self.utilisation, strict=True)},
            "ends": plain(self.ends),
            "n_evaluations": self.n_evaluations,
            "statement": self.statement,
        }

    def __str__(self) -> str:
        names = self.trajectory.joint_names or [f"joint {j + 1}" for j in range(self.trajectory.n_joints)]
        rows: list[list[Cell]] = [
            [name, *("-" if np.isnan(share) else f"{100 * share:.1f} %" for share in column)]
            for name, column in zip(names, self.utilisation.T, strict=True)
        ]
        times = ", ".join(f"{t:.4f}" for t in self.trajectory.times)
        head = (
            f"{self.trajectory.profile}: least time {self.duration:.4f} s ({self.start.duration:.4f} s with the"
            f" segments in the given proportions); points at {times} s"
        )
        table = text_table(["used of the limit", *ORDERS[1:]], rows)
        return "\n".join([*wrap(head, 100), "", table, "", *wrap(f"Reached: {self.statement}.", 100)])


def least_time(
    make: MakeTrajectory,
    points: ArrayLike,
    times: ArrayLike,
    *,
    max_velocity: ArrayLike | None = None,
    max_acceleration: ArrayLike | None = None,
    max_jerk: ArrayLike | None = None,
    free: Sequence[str] = (),
    restarts: int = 4,
    seed: int = 0,
    progress: Progress | None = None,
) -> LeastTime:
    """Choose the segments' durations so that the whole takes the least time within the limits.

    For given proportions of the segments the least time is known exactly: stretching time by k divides velocity,
    acceleration and jerk by k, k^2 and k^3, so with the exact peaks V, A, J of the motion that takes 1 s it is the
    largest of ``V/v_max``, ``(A/a_max)^(1/2)``, ``(J/j_max)^(1/3)`` over the joints. The proportions are searched.

    Parameters
    ----------
    make : callable
        A profile whose motion is determined by points and times, such as `cubic_spline_free_knots`.
    points : array_like, shape (k, n_joints)
        At least three, rad (m for prismatic joints); any unit that the limits share will do.
    times : array_like, shape (k,) or ()
        Proportions to begin with, or 1.
    max_velocity, max_acceleration, max_jerk : array_like, shape () or (n_joints,), optional
        At least one; NaN where there is no limit. rad/s, rad/s^2, rad/s^3.
    free : sequence of str
        Arguments of `make` to be chosen as well: "free_knots", or "velocities", "accelerations" at the vias.
    restarts, seed, progress
        As in `optimise_via_times`.

    Raises
    ------
    InputError
        For arguments that are not valid, an acceleration or jerk that is unbounded although it is limited, or a
        profile that does not scale with its times.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> points = [[0.0], [1.0], [2.0]]
    >>> result = least_time(profiles.quintic_spline, points, 1.0, max_jerk=60.0, restarts=0)
    >>> round(result.duration, 4), result.is_feasible  # (60 h / j)^(1/3), h = 2
    (1.2599, True)
    """
    total = 1.0 if np.ndim(times) == 0 else np.asarray(times) / float(np.ptp(np.asarray(times, dtype=np.float64)))
    setting = checked_setting(make, points, total, robot=None, free=free, max_overshoot=None, keep=(), dwell=0.0)
    variables = setting.variables
    limits = _checked_limits(variables.points.shape[1], (max_velocity, max_acceleration, max_jerk))
    first = setting.first()
    unit = variables.trajectory(first)
    shortest = _needed_time(unit, limits)
    if not np.isfinite(shortest):
        raise InputError(f"profile {unit.profile} has unbounded derivatives that are limited, whatever the via times")
    if shortest == 0:
        raise InputError("no joint with a limit moves: any time is long enough")
    problem = setting.problem(_times_needed(limits, _IDLE * shortest))
    starts = random_starts(variables, first, checked_count("restarts", restarts), seed)
    found = search_from(problem, starts, progress)
    best = min(found, key=lambda one: one.rank)
    return LeastTime(
        trajectory=_scaled(variables, best.x, limits),
        start=_scaled(variables, first, limits),
        limits=limits,
        ends=tuple(one.value for one in found),
        n_evaluations=sum(one.n_evaluations for one in found),
    )


def _checked_limits(n_joints: int, given: Sequence[ArrayLike | None]) -> Array:
    """Shape (3, n_joints), NaN where there is none."""
    limits = np.full((3, n_joints), np.nan)
    for row, name, value in zip(limits, ("max_velocity", "max_acceleration", "max_jerk"), given, strict=True):
        if value is not None:
            shape = () if np.ndim(value) == 0 else (n_joints,)
            row[:] = checked_array(name, value, shape, allow_nan=True)
            if (row <= 0).any():
                raise InputError(f"{name}[{int(np.argmax(row <= 0))}] = {row[row <= 0][0]:g} must be positive")
    if np.isnan(limits).all():
        raise InputError("without a limit there is no least time; give max_velocity, max_acceleration or max_jerk")
    limits.setflags(write=False)
    return limits


def _times_needed(limits: Array, idle: float) -> Callable[[Candidate], Array]:
    """For each limit, joint and interval, the time that the motion of 1 s would need; idle ones cut off."""
    known = ~np.isnan(limits)

    def parts(candidate: Candidate) -> Array:
        needed = []
        for order in (1, 2, 3):
            extremes = interval_extremes(candidate.trajectory.derivative(order)).reshape(-1, limits.shape[1])
            shares = (extremes / limits[order - 1])[:, known[order - 1]].ravel()
            needed.append(np.maximum(shares, idle**order) ** (1 / order))
        return np.concatenate(needed)

    return parts


def _needed_time(unit: Trajectory, limits: Array) -> float:
    """Least time of the proportions of a motion that takes 1 s, exactly; infinite where unbounded."""
    peaks = np.stack([unit.peak(order)[0] for order in (1, 2, 3)])
    return float(np.nanmax((peaks / limits) ** (1 / np.array([[1.0], [2.0], [3.0]]))))


def _scaled(variables: Variables, x: Array, limits: Array) -> Trajectory:
    """The motion of these proportions in its least time, made anew at that time and measured again.

    Rounding may leave a peak a few units in the last place above its limit; the second pass takes it back.
    """
    times = variables.times(x)
    values = variables.values(x, times)
    duration = 1.0
    for _ in range(3):
        scaled = {name: value * duration ** _POWERS[name] for name, value in values.items()}
        trajectory = variables.make(variables.points, times * duration, **scaled)
        excess = _needed_time(trajectory, limits)
        if duration != 1.0 and abs(excess - 1) <= _UNSCALED and excess <= 1 + _ROUNDING / 3:
            return trajectory
        duration *= excess * (1 + _ROUNDING / 10)
    raise InputError(
        f"profile {trajectory.profile} does not scale with its times: at the time that it should need, its peaks are"
        f" {excess:.6g} of what the limits allow"
    )


# How free values scale with time: knots are times, velocities and accelerations go down.
_POWERS: Final = {"free_knots": 1, "velocities": -1, "accelerations": -2}
