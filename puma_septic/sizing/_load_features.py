"""What one joint's load asks of any drive train: moments, and the few instants at which torque or power can peak.

The motor's torque is ``features @ coefficients`` with features that are the load's and coefficients that are the
drive train's: acceleration, torque where the motor drives, rests or is driven, velocity, and its two signs. So the mean
square is a quadratic form in the features' mean products. Where the load is sampled at N + 1 Chebyshev points of
an interval, a polynomial p of degree d is nowhere larger than its largest sample over ``cos(d pi / 2N)``: near a peak
p stays above a cosine of d times the angle (M. Riesz), and the next sample is at most ``pi / 2N`` away. What higher
terms of the torque's series can add is kept as a remainder. And as no coefficient is negative, a sample that another
one exceeds in acceleration, torque and velocity at once cannot be the largest for any drive train.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.piecewise import Piecewise
from puma_septic.sizing._gearbox import average_load_torque
from puma_septic.sizing._loads import JointLoad
from puma_septic.sizing._ratios import LoadMoments, load_moments
from puma_septic.sizing._winding import energies
from puma_septic.validation import Array, freeze_fields

__all__ = ["LoadGrid", "load_grid", "merged_peaks"]

# Chebyshev points per degree: samples are within 0.5 % of the peak.
_DENSITY: Final = 16
_EXCESS: Final = float(1 / np.cos(np.pi / (2 * _DENSITY)) * (1 + 1e-12))
# Higher terms of the torque's series, relative to its largest, that are left to the remainder.
_REMAINDER: Final = 1e-6
_FEATURES: Final = 7
_VELOCITY: Final = 4


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoadGrid:
    """One joint's load, prepared for many drive trains.

    Attributes
    ----------
    load : JointLoad
    moments : LoadMoments
    gram : ndarray, shape (7, 7)
        Mean products of the features over the cycle.
    torque_rows, power_rows : ndarray, shape (k, 7)
        Features at the instants among which the largest torque, and mechanical power, of any drive train lies.
    power_speeds : ndarray, shape (k,)
        Velocity at the instants of `power_rows`.
    excess : float
        How many times larger than its largest sample a torque or power can be, the remainder apart.
    remainder : float
        What the torque at the joint can have more, N m, twice: at the sample and at the peak.
    mean_speed, peak_torque, average_torque, inertia : float
        Mean magnitude of the velocity; peak and average (gearbox) of the torque at the joint; largest inertia there.
    driving, driven : ndarray, shape (2,)
        Mean positive and mean negative part of ``a v`` and of ``tau v``.
    """

    load: JointLoad
    moments: LoadMoments
    gram: Array
    torque_rows: Array
    power_rows: Array
    power_speeds: Array
    excess: float
    remainder: float
    mean_speed: float
    peak_torque: float
    average_torque: float
    inertia: float
    driving: Array
    driven: Array

    def __post_init__(self) -> None:
        freeze_fields(self)

    @property
    def with_velocity(self) -> Array:
        """Mean products of the features with the velocity, shape (7,)."""
        return self.gram[:, _VELOCITY]


def load_grid(load: JointLoad) -> LoadGrid:
    """Prepare a load; see `LoadGrid`."""
    torque, velocity = load.torque.by_interval(~load.braked), load.velocity
    i, x, remainder = _instants(torque, velocity.degree + load.acceleration.degree)
    a, tau, v = (_values(f, i, x) for f in (load.acceleration, torque, velocity))
    kind = (load.power_sign * 3 + load.velocity_sign)[i]
    rows = _features(a, tau, v, load.power_sign[i], load.velocity_sign[i])
    return LoadGrid(
        load=load,
        moments=load_moments(load),
        gram=_gram(load, torque),
        torque_rows=rows[_both_fronts(np.stack([a, tau, v], axis=-1), kind)],
        power_rows=rows[power := _both_fronts(np.stack([a * v, tau * v, np.abs(v)], axis=-1), kind)],
        power_speeds=v[power],
        excess=_EXCESS,
        remainder=2 * _EXCESS * remainder,
        mean_speed=load.mean_speed,
        peak_torque=float(load.torque.extrema().peak[0]),
        average_torque=average_load_torque(load),
        inertia=float(load.inertia.extrema().max[0]),
        driving=_one_sign(load, torque, 1.0),
        driven=_one_sign(load, torque, -1.0),
    )


def merged_peaks(grids: Sequence[LoadGrid]) -> LoadGrid:
    """The instants of several loads among which the largest torque, and power, of any drive train lies.

    Only what peaks need is of all: rows, remainder and highest speed; the rest is that of the first.

    Returns
    -------
    LoadGrid
    """
    torque, power = (np.vstack([getattr(grid, name) for grid in grids]) for name in ("torque_rows", "power_rows"))
    speeds = np.concatenate([grid.power_speeds for grid in grids])
    rows = _both_fronts(_coordinates(torque), _kinds(torque))
    power_rows = _both_fronts(_coordinates(power) * np.column_stack([speeds, speeds, np.sign(speeds)]), _kinds(power))
    fastest = max(grid.moments.peak_speed for grid in grids)
    return replace(
        grids[0],
        moments=replace(grids[0].moments, peak_speed=fastest),
        torque_rows=torque[rows],
        power_rows=power[power_rows],
        power_speeds=speeds[power_rows],
        remainder=max(grid.remainder for grid in grids),
    )


def _coordinates(features: Array) -> Array:
    """Acceleration, torque and velocity."""
    return np.column_stack([features[:, 0], features[:, 1:4].sum(axis=1), features[:, _VELOCITY]])


def _kinds(features: Array) -> Array:
    """By the signs of power and velocity."""
    power = np.sign(np.abs(features[:, 1])) - np.sign(np.abs(features[:, 3]))
    return np.asarray(power * 3 + features[:, 5] + features[:, 6])


def _instants(torque: Piecewise, more: int) -> tuple[NDArray[np.int64], Array, float]:
    """Interval and place in it, -1 to 1, of each sample, and the largest sum of the torque's terms left out.

    On each interval as many as the terms of the torque that count need, and `more` degrees.
    """
    size = np.abs(torque.coefficients[:, :, 0])
    tails = np.cumsum(size[::-1], axis=0)[::-1]
    counts = tails > _REMAINDER * tails[0].max()
    degrees = np.where(counts.any(axis=0), len(size) - 1 - counts[::-1].argmax(axis=0), 0)
    numbers = _DENSITY * np.maximum(1, degrees + more)
    left_out = np.vstack([tails, np.zeros((1, size.shape[1]))])[degrees + 1, np.arange(size.shape[1])]
    intervals = np.repeat(np.arange(len(numbers)), numbers + 1)
    places = np.concatenate([np.cos(np.pi * np.arange(number + 1) / number) for number in numbers])
    return intervals, places, float(left_out.max())


def _values(f: Piecewise, intervals: NDArray[np.int64], places: Array) -> Array:
    """At places of intervals, without the rounding of an instant in between."""
    basis = np.cos(np.outer(np.arccos(places), np.arange(f.degree + 1)))
    return np.asarray(np.einsum("sd,ds->s", basis, f.coefficients[:, intervals, 0]))


def _features(a: Array, tau: Array, v: Array, power_sign: Array, velocity_sign: Array) -> Array:
    """Shape (instants, 7)."""
    parts = [tau * (power_sign > 0), tau * (power_sign == 0), tau * (power_sign < 0)]
    return np.column_stack([a, *parts, v, *(np.where(velocity_sign == s, s, 0.0) for s in (1.0, -1.0))])


def _gram(load: JointLoad, torque: Piecewise) -> Array:
    """Mean products of the features."""
    steps = [torque.stepwise(np.where(load.velocity_sign == s, s, 0.0)[:, None]) for s in (1.0, -1.0)]
    parts = [torque.by_interval(load.power_sign == s) for s in (1.0, 0.0, -1.0)]
    features = [load.acceleration, *parts, load.velocity, *steps]
    gram = np.zeros((_FEATURES, _FEATURES))
    for i, f in enumerate(features):
        for k in range(i + 1):
            gram[i, k] = gram[k, i] = f.inner(features[k])[0] / load.duration
    return gram


def _one_sign(load: JointLoad, torque: Piecewise, sign: float) -> Array:
    """Mean part of one sign of ``a v`` and ``tau v``."""
    flows = (energies(f * load.velocity * sign) for f in (load.acceleration, torque))
    return np.array([np.maximum(flow, 0.0).sum() for flow in flows]) / load.duration


def _both_fronts(points: Array, kind: Array) -> NDArray[np.int64]:
    """Indices of the instants that can be largest or least for some coefficients that are not negative."""
    kept = []
    for one in np.unique(kind):
        own = np.flatnonzero(kind == one)
        kept += [own[_front(points[own])], own[_front(-points[own])]]
    return np.unique(np.concatenate(kept))


def _front(points: Array) -> NDArray[np.int64]:
    """Indices of the rows that no other row equals or exceeds in every column.

    In falling order of the first column a row is kept where none before it is as large in the other two: those form a
    staircase, rising in the second column and falling in the third, in which one place decides.
    """
    kept: list[int] = []
    second: list[float] = []
    third: list[float] = []
    order = np.lexsort(-points.T[::-1])
    for k, y, z in zip(order.tolist(), *points[order, 1:].T.tolist(), strict=True):
        at = bisect_left(second, y)
        if at < len(second) and third[at] >= z:
            continue
        first = at
        while first and third[first - 1] <= z:
            first -= 1
        last = at + 1 if at < len(second) and second[at] == y else at
        second[first:last], third[first:last] = [y], [z]
        kept.append(k)
    return np.array(kept)
