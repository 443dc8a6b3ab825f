"""From numbers of size one to via times and free via values, and back."""

from __future__ import annotations

import reprlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from inspect import signature
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array, checked_choice, checked_list, checked_times, n_dimensions

__all__ = ["FREE", "MakeTrajectory", "Variables", "checked_variables"]

MakeTrajectory = Callable[..., Trajectory]

# Keyword arguments that can be left to the optimiser, and their power of time.
_DERIVATIVES: Final = {"velocities": 1, "accelerations": 2}
FREE: Final = (*_DERIVATIVES, "free_knots")
# No segment becomes shorter than this share of the total time (or than half the shortest at the start).
_LEAST_SHARE: Final = 0.01
# Logits beyond this change a share by less than 1e-3 of it.
_LOGIT: Final = 8.0
# Via velocities of this many hull widths per total time are wild already.
_WILD: Final = 50.0


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Variables:
    """What the optimiser may change.

    Segment k of n takes the share ``least + (1 - n least) softmax(0, x)_k`` of the total time, so that any x is
    valid. Free via velocities are in units of the joint's hull width per total time (accelerations per its square);
    free knots divide the first and the last segment by the logistic function of x.

    Attributes
    ----------
    make : callable
        ``make(points, times, **free_values)`` returns a Trajectory.
    points : ndarray, shape (k, n_joints)
    start : ndarray, shape (k,)
        The times to begin with, s.
    free : tuple of str
    least : float
    """

    make: MakeTrajectory
    points: Array
    start: Array
    free: tuple[str, ...] = ()
    least: float

    @property
    def n_times(self) -> int:
        """Number of variables that determine the times."""
        return len(self.start) - 2

    @property
    def moving(self) -> Array:
        """Hull width of each joint that moves, with the others' left out."""
        width = np.ptp(self.points, axis=0)
        return np.asarray(width[width > 0])

    @property
    def size(self) -> int:
        """Number of variables."""
        return self.n_times + sum(self._length(name) for name in self.free)

    def _length(self, name: str) -> int:
        return 2 if name == "free_knots" else self.n_times * len(self.moving)

    def bounds(self) -> tuple[Array, Array]:
        """Of the variables."""
        upper = np.full(self.size, _LOGIT)
        position = self.n_times
        for name in self.free:
            if name in _DERIVATIVES:
                upper[position : position + self._length(name)] = _WILD ** _DERIVATIVES[name]
            position += self._length(name)
        return -upper, upper

    def encode(self, times: Array, values: Mapping[str, Array] | None = None) -> Array:
        """Variables of given times and free values (zero velocities, knots in the middle where not given)."""
        shares = np.diff(times) / (times[-1] - times[0])
        n = len(shares)
        weights = np.maximum((shares - self.least) / (1 - n * self.least), 1e-12)
        x = np.zeros(self.size)
        x[: n - 1] = np.clip(np.log(weights[1:] / weights[0]), -_LOGIT, _LOGIT)
        position = self.n_times
        for name in self.free:
            length = self._length(name)
            if values is not None and name in _DERIVATIVES:
                unit = self._unit(name, times)
                x[position : position + length] = (values[name][1:-1, self._moves()] / unit).ravel()
            position += length
        return x

    def times(self, x: Array) -> Array:
        """Via times, s; the first and the last are the start's."""
        times = self.start[0] + (self.start[-1] - self.start[0]) * np.concatenate([[0.0], np.cumsum(self._shares(x))])
        times[-1] = self.start[-1]
        return np.asarray(times)

    def values(self, x: Array, times: Array) -> dict[str, Array]:
        """Free values by name."""
        values, position = {}, self.n_times
        for name in self.free:
            part = x[position : position + self._length(name)]
            position += self._length(name)
            if name == "free_knots":
                ahead = 1 / (1 + np.exp(-part))
                values[name] = times[[0, -2]] + ahead * (times[[1, -1]] - times[[0, -2]])
            else:
                array = np.zeros_like(self.points)
                array[1:-1, self._moves()] = part.reshape(self.n_times, -1) * self._unit(name, times)
                values[name] = array
        return values

    def trajectory(self, x: Array) -> Trajectory:
        """The motion."""
        times = self.times(x)
        return self.make(self.points, times, **self.values(x, times))

    def chained(self, by_times: Array, x: Array) -> Array:
        """A gradient by the inner via times as one by x."""
        total, n = self.start[-1] - self.start[0], self.n_times + 1
        s = (self._shares(x) - self.least) / (1 - n * self.least)
        by_logits = (np.diag(s) - np.outer(s, s))[:, 1:] * (1 - n * self.least) * total
        return np.asarray(by_times @ np.cumsum(by_logits, axis=0)[:-1])

    def _moves(self) -> Any:
        return np.ptp(self.points, axis=0) > 0

    def _unit(self, name: str, times: Array) -> Array:
        return np.asarray(self.moving / (times[-1] - times[0]) ** _DERIVATIVES[name])

    def _shares(self, x: Array) -> Array:
        logits = np.concatenate([[0.0], x[: self.n_times]])
        weights = np.exp(logits - logits.max())
        n = len(weights)
        return np.asarray(self.least + (1 - n * self.least) * weights / weights.sum())


def checked_variables(
    make: MakeTrajectory, points: ArrayLike, times: ArrayLike, free: Sequence[str], *, least: int = 3
) -> Variables:
    """The variables of a task; a single time is the total one, and segments then take what their longest way needs.

    Raises
    ------
    InputError
        For fewer than the least number of points, times that do not increase, a profile that is not made from points
        and times alone, or a free quantity that it does not have.
    """
    vias = checked_array("points", points, (None, None), unit="rad")
    if len(vias) < least:
        reason = (
            "without a via between start and end there are no via times" if least == 3 else "a motion needs two points"
        )
        raise InputError(f"{reason}: got {len(vias)} points")
    start = checked_times("times", _default_times(vias, times) if n_dimensions(times) == 0 else times, len(vias))
    names = (free,) if isinstance(free, str) else checked_list("free", free)
    label = getattr(make, "__name__", reprlib.repr(make))
    try:
        parameters = signature(make).parameters
        signature(make).bind(vias, start)
    except (TypeError, ValueError) as error:  # the latter for what is built in, and does not tell its arguments
        raise InputError(
            f"{label} cannot be made from points and times alone, so its times cannot be chosen"
        ) from error
    for name in names:
        checked_choice("free quantity", name, FREE)
        if name not in parameters:
            have = [one for one in FREE if one in parameters]
            raise InputError(f"{label} has no free {name}; it has: {', '.join(have) or 'none'}")
    shortest = float(np.diff(start).min() / (start[-1] - start[0]))
    return Variables(make=make, points=vias, start=start, free=names, least=min(_LEAST_SHARE, shortest / 2))


def _default_times(points: Array, total: ArrayLike) -> Array:
    """Segments in proportion to the square root of their longest way, as at a given acceleration."""
    duration = float(checked_array("times", total, (), unit="s"))
    if not duration > 0:
        raise InputError(f"times = {duration:g} s: a total time must be positive")
    way = np.sqrt(np.abs(np.diff(points, axis=0)).max(axis=1))
    way = np.maximum(way, 0.1 * way.max()) if way.any() else np.ones(len(way))
    return np.concatenate([[0.0], np.cumsum(way / way.sum())]) * duration
