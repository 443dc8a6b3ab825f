"""Trajectory: what is true of any joint-space motion, whatever profile made it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.document import card, one_line
from puma_septic.errors import InputError
from puma_septic.piecewise import Extrema, Jumps, Piecewise
from puma_septic.piecewise.directions import STILL, find_directions
from puma_septic.piecewise.matrices import end_derivatives
from puma_septic.quantities import MOTION
from puma_septic.validation import (
    Array,
    checked_array,
    checked_each,
    checked_flag,
    checked_kind,
    checked_texts,
    checked_times,
    frozen,
    read_only,
)

__all__ = ["Trajectory"]

_ORDERS = np.arange(4.0)[:, None, None]
# A step below this part of the largest value of its kind is rounding: of position, velocity, acceleration and jerk. The
# acceleration of a series that was fitted to 1e-11 has lost four digits, and its steps make the jerk infinite.
_JUMP_TOLERANCE = np.array([1e-9, 1e-9, 1e-7, 1e-9])
# More points than this are the samples of a recorded motion, and their marks a broad line.
_MOST_MARKED = 100
# Positions that differ by less than this part are one.
_SAME = 1e-13
# What a profile's arithmetic makes of one rounding of a coefficient or a time: the worst measured is 14, over all
# profiles. Resampling adds up to 5 roundings of the position to each coefficient, measured to degree 64.
_ROUNDING = 64 * np.finfo(np.float64).eps
_RESAMPLED = 8 * np.finfo(np.float64).eps


def _per_joint_resolution(value: ArrayLike | float, n: int) -> Array:
    if isinstance(value, float) and value == 0.0:  # of every planned motion
        return read_only(np.zeros(n))
    return read_only(checked_each("resolution", value, n, at_least=0.0))


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Trajectory:
    """Joint positions over time and their derivatives, exactly.

    Derivatives and extrema are computed when first asked for and kept; the value itself never changes (the cache needs
    a ``__dict__``, hence no slots).

    Parameters
    ----------
    position : Piecewise
        rad (m for prismatic joints) over s, continuous.
    points : array_like, shape (k, n_joints)
        The points that the trajectory was asked to visit.
    times : array_like, shape (k,)
        When, in s.
    profile : str
        Name of the family that made it.
    joint_names : tuple of str
        Empty where the profile was made without a robot.
    rest_before, rest_after : bool
        Whether the arm is at rest before the start and after the end, so that a velocity there is a step. False for an
        excerpt that starts or ends moving.
    resolution : array_like, shape () or (n_joints,)
        Travel in rad (m) that does not count as motion, such as the dead band of a recorded signal: reversals within it
        do not count, and a joint that stays within it for `REST_TIME` or longer is at rest. At least `STILL` counts as
        nothing in any motion.
    doubts : tuple of str
        What must be settled before a verdict, such as the noise or the units of a log; none of a planned motion.
    remarks : tuple of str
        What else is to be known of it beside every verdict, such as what the samples of a log leave unknown.

    Raises
    ------
    InputError
        If the position jumps: no arm can follow it.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0], [1.0]], [0.0, 2.0])
    >>> float(move(1.0, order=1)[0])  # 1.875 h / T at the middle
    0.9375
    """

    position: Piecewise
    points: Array
    times: Array
    profile: str = "trajectory"
    joint_names: tuple[str, ...] = ()
    rest_before: bool = True
    rest_after: bool = True
    resolution: ArrayLike = 0.0
    doubts: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        times = checked_times("times", self.times)
        n = checked_kind("position", self.position, Piecewise).n_components
        checked_kind("profile", self.profile, str)
        for name in ("joint_names", "doubts", "remarks"):
            object.__setattr__(self, name, checked_texts(name, getattr(self, name)))
        for name in ("rest_before", "rest_after"):
            object.__setattr__(self, name, checked_flag(name, getattr(self, name)))
        object.__setattr__(self, "resolution", _per_joint_resolution(self.resolution, n))
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "points", checked_array("points", self.points, (len(times), n), unit="rad"))
        if self.joint_names and len(self.joint_names) != n:
            raise InputError(f"joint_names: {len(self.joint_names)} names for {n} joints")
        if len(self.position.breaks) > 2:
            self._refuse_position_jumps()

    def _refuse_position_jumps(self) -> None:
        jumps = self.position.jumps()
        allowed = np.maximum(_JUMP_TOLERANCE[0] * self.position.bounds().max(axis=0), STILL)
        bad = np.abs(jumps.sizes) > allowed
        if bad.any():
            k, j = np.argwhere(bad)[0]
            raise InputError(
                f"{self.joint_label(int(j))}: position jumps by {jumps.sizes[k, j]:g} rad at t = {jumps.times[k]:g} s;"
                " a trajectory must be continuous"
            )

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return self.position.n_components

    @property
    def breaks(self) -> Array:
        """Times at which the function may be less than smooth, both ends included, s."""
        return self.position.breaks

    @property
    def duration(self) -> float:
        """Length of the span, s."""
        return self.position.duration

    @cached_property
    def _velocity(self) -> Piecewise:
        return self.position.derivative()

    @cached_property
    def _acceleration(self) -> Piecewise:
        return self._velocity.derivative()

    @cached_property
    def _jerk(self) -> Piecewise:
        return self._acceleration.derivative()

    @cached_property
    def state(self) -> Piecewise:
        """Position, velocity, acceleration and jerk side by side, 4 n_joints components: searched as one."""
        return self.position.with_derivatives(3)

    @cached_property
    def _searched(self) -> tuple[Extrema, tuple[Array, ...]]:
        """Extrema of `state`, and the turning points of the position."""
        return self.state.extrema_and_turns(self.n_joints)

    @cached_property
    def _state_jumps(self) -> Jumps:
        """Steps of `state` that are larger than rounding, the ends held against rest."""
        left, right = self.state.ends()
        before = np.where(self.rest_before, 0.0, left[:1])
        after = np.where(self.rest_after, 0.0, right[-1:])
        sizes = np.concatenate([left, after]) - np.concatenate([before, right])
        return Jumps(times=self.breaks, sizes=np.where(np.abs(sizes) > self._jump_tolerance(), sizes, 0.0))

    @cached_property
    def direction(self) -> Piecewise:
        """Which way each joint travels: +1, -1, or 0 while it rests, constant between breaks of its own.

        It is the sign of the travel between two reversals, never that of a velocity at a point, so that rounding
        decides nothing; see `find_directions`.
        """
        return find_directions(self.position, self._searched[1], np.asarray(self.resolution))

    @property
    def marked(self) -> tuple[Array, Array]:
        """Times (k,) and points (k, n_joints) that a picture marks: all, or both ends of a recorded motion's many."""
        some = slice(None) if len(self.times) <= _MOST_MARKED else slice(None, None, len(self.times) - 1)
        return self.times[some], self.points[some]

    @property
    def excerpt(self) -> Trajectory:
        """The same motion as part of a longer one: the arm need not be at rest before it and after it."""
        return replace(self, rest_before=False, rest_after=False)

    def resting(self, *, before: bool = True, after: bool = True) -> Trajectory:
        """The same motion where the arm is at rest before it, and after it, only if both this and that say so.

        Returns
        -------
        Trajectory

        Raises
        ------
        InputError
            For what is neither true nor false.
        """
        at_rest = checked_flag("before", before), checked_flag("after", after)
        return replace(self, rest_before=self.rest_before and at_rest[0], rest_after=self.rest_after and at_rest[1])

    def shifted(self, seconds: float) -> Trajectory:
        """The same motion, later by a number of seconds: ``q(t - seconds)``.

        Returns
        -------
        Trajectory

        Raises
        ------
        InputError
            For what is no finite number.
        """
        position = self.position.shifted(seconds)
        return replace(self, position=position, times=self._times_on(position, self.times))

    def stretched(self, factor: float) -> Trajectory:
        """The same motion, `factor` times as long, from the same instant; what is searched already is taken along.

        Returns
        -------
        Trajectory
        """
        position = self.position.stretched(factor)
        slower = replace(self, position=position, times=self._times_on(position, self.times, factor))
        if "_searched" in self.__dict__:
            extrema, turns = self._searched
            scale = np.repeat(float(factor) ** -_ORDERS.ravel(), self.n_joints)
            moved = Extrema(
                min=extrema.min * scale,
                max=extrema.max * scale,
                t_min=self._times_on(position, extrema.t_min, factor),
                t_max=self._times_on(position, extrema.t_max, factor),
            )
            # Turns are times since the start.
            slower.__dict__["_searched"] = moved, tuple(turn * factor for turn in turns)
            # Travel decides the way of a planned motion; that of a recorded one depends on how long it rests, too.
            if "direction" in self.__dict__ and not np.any(self.resolution):
                slower.__dict__["direction"] = self.direction.stretched(factor)
        return slower

    def _times_on(self, moved: Piecewise, times: Array, factor: float = 1.0) -> Array:
        """Instants on the clock of the moved position: those at a break stay at it, whatever a late clock rounds."""
        breaks = moved.breaks
        k = self.breaks.searchsorted(times).clip(0, len(breaks) - 1)
        between = (breaks[0] + (times - self.breaks[0]) * float(factor)).clip(breaks[0], breaks[-1])
        return np.asarray(np.where(self.breaks[k] == times, breaks[k], between))

    def _part(self, order: int) -> slice:
        """Where `state` holds the derivative of this order."""
        if not isinstance(order, (int, np.integer)) or order not in (0, 1, 2, 3):
            valid = ", ".join(f"{k} ({name})" for k, name in enumerate(MOTION))
            raise InputError(f"order = {order!r} is not one of {valid}")
        return slice(order * self.n_joints, (order + 1) * self.n_joints)

    def joint_label(self, j: int) -> str:
        """How messages call joint j."""
        return f"joint {self.joint_names[j]!r}" if self.joint_names else f"joint {j + 1}"

    def derivative(self, order: int) -> Piecewise:
        """Position (0), velocity (1), acceleration (2) or jerk (3) as a function of time."""
        self._part(order)
        function: Piecewise = getattr(self, ("position", "_velocity", "_acceleration", "_jerk")[order])
        return function

    def __call__(self, t: ArrayLike, order: int = 0) -> Array:
        """Values at times t, shape () or (n,), as (n_joints,) or (n, n_joints).

        At a step the right-hand value, at the end the left-hand one. Times outside the span are an InputError.
        """
        return self.derivative(order)(t)

    def power_coefficients(self) -> Array:
        """Coefficients of powers of ``t - breaks[i]``, shape (n_intervals, degree + 1, n_joints), ascending."""
        return self.position.power_coefficients()

    def extrema(self, order: int = 0) -> Extrema:
        """Least and greatest finite values and their instants; see `jumps` for what is unbounded."""
        part, extrema = self._part(order), self._searched[0]
        return Extrema(
            min=extrema.min[part], max=extrema.max[part], t_min=extrema.t_min[part], t_max=extrema.t_max[part]
        )

    def jumps(self, order: int) -> Jumps:
        """Steps of velocity (1), acceleration (2) or jerk (3), larger than rounding, at breaks and ends.

        Where the arm is at rest before the first and after the last instant, a value other than zero there is a step.
        """
        part = self._part(order)
        if order == 0:
            raise InputError("order = 0: the position of a trajectory never jumps; valid: 1, 2, 3")
        sizes = self._state_jumps.sizes[:, part]
        some = sizes.any(axis=1)
        return Jumps(times=self.breaks[some], sizes=sizes[some])

    @cached_property
    def _first_unbounded(self) -> Array:
        """`unbounded` of all orders, shape (4, n_joints)."""
        steps = (self._state_jumps.sizes != 0).reshape(-1, 4, self.n_joints)[:, :3]
        steps[:, 0] = False  # positions do not jump
        steps = np.logical_or.accumulate(steps, axis=1)
        first = np.where(steps.any(axis=0), self.breaks[steps.argmax(axis=0)], np.nan)
        return read_only(first[[0, 0, 1, 2]])

    def unbounded(self, order: int) -> Array:
        """When each joint's derivative of this order is first unbounded, because a lower one steps; NaN where never.

        Shape (n_joints,), s.
        """
        self._part(order)
        return np.asarray(self._first_unbounded[order])

    @cached_property
    def _peaks(self) -> tuple[Array, Array]:
        """`peak` of all orders, each of shape (4, n_joints)."""
        extrema, unbounded = self._searched[0], self._first_unbounded
        never = np.isnan(unbounded)
        size, time = extrema.peak.reshape(4, -1), extrema.t_peak.reshape(4, -1)
        return read_only(np.where(never, size, np.inf)), read_only(np.where(never, time, unbounded))

    def peak(self, order: int) -> tuple[Array, Array]:
        """Largest magnitude of a derivative and its instant, each of shape (n_joints,).

        It is infinite where the derivative is unbounded, at the first instant at which it is.
        """
        self._part(order)
        size, time = self._peaks
        return size[order], time[order]

    def _jump_tolerance(self) -> Array:
        """Per break and component of `state`: a part of the largest value of its kind, or what rounding makes of zero.

        What would move a joint by no more than `STILL` over the whole motion does not count either. The largest over
        all joints: what is rounding of the whole motion is no step of one joint. A coefficient that is off by d moves
        derivative r at an end by ``d T_n^(r)(1) (2/h)^r``. It is off by roundings of itself, as many more as the
        interval is shorter than the time is late, and by those of the position where the series has been resampled; one
        that is exactly zero is not off.
        """
        by_kind = self.state.bounds().max(axis=0).reshape(4, -1)
        none = STILL / self.duration ** np.arange(4.0)
        least = np.repeat(np.maximum(_JUMP_TOLERANCE * by_kind.max(axis=1), none), self.n_joints)
        size = np.abs(self.position.coefficients)
        lengths = self.position.lengths[:, None]
        late = 1 + self.duration / lengths
        off = _ROUNDING * late * size + _RESAMPLED * (size > 0) * size.sum(axis=0)
        noise = (end_derivatives(self.position.degree) @ off.reshape(len(off), -1)).reshape(4, *off.shape[1:])
        noise = noise * (2 / lengths) ** _ORDERS
        noise = np.maximum(least, noise.transpose(1, 0, 2).reshape(len(lengths), -1))
        return np.asarray(np.maximum(np.concatenate([noise[:1], noise]), np.concatenate([noise, noise[-1:]])))

    @property
    def overshoot(self) -> Array:
        """Largest excess of each joint beyond the hull of the via points, rad, shape (n_joints,)."""
        reach = self.extrema(0)
        above, below = reach.max - self.points.max(axis=0), self.points.min(axis=0) - reach.min
        excess = np.maximum(above, below)
        # Visiting the outermost via itself, to rounding, is no overshoot.
        return frozen(np.where(excess > self._position_rounding, excess, 0.0))

    @property
    def via_miss(self) -> Array:
        """Largest distance of each joint from a via point at its time, rad, shape (n_joints,)."""
        miss = np.abs(self(self.times) - self.points).max(axis=0)
        return frozen(np.where(miss > _SAME + self._position_rounding, miss, 0.0))

    @property
    def _position_rounding(self) -> Array:
        """What rounding of the series and of a time makes of a position, rad, shape (n_joints,).

        A polynomial that swings far beyond its points is rounded as large as it swings; an instant is rounded to a part
        of the whole duration, in which the joint moves on.
        """
        size, speed = (self.derivative(order).bounds().max(axis=0) for order in (0, 1))
        return np.asarray(_SAME * size + 4 * np.spacing(self.duration) * speed)

    def __repr__(self) -> str:
        return one_line("Trajectory", self._facts())

    def _repr_html_(self) -> str:
        return card("Trajectory", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "profile": self.profile,
            "joints": self.n_joints,
            "points": len(self.points),
            "from": f"{self.breaks[0]:g} s",
            "to": f"{self.breaks[-1]:g} s",
            "intervals": len(self.breaks) - 1,
        }
