"""Where a sampled motion is less than smooth: steps of its acceleration, jerk or snap between two samples.

A clean log knows such an instant far better than its step of time. The polynomials through the samples on either side
differ by ``c (t - tau)^m`` where the m-th derivative steps at tau, whatever lies between the two samples: tau is the
root of the difference's derivative of order m - 1. Where the jerk steps twice between them, as it does while an
acceleration rises, they differ by ``c1 (t - tau1)^3 + c2 (t - tau2)^3``, which four coefficients determine (Prony's
method: the instants are the roots of ``t^2 - s t + p`` with ``mu[k+2] = s mu[k+1] - p mu[k]`` for the moments
``mu[k] = c1 tau1^k + c2 tau2^k``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple, final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike
from scipy.ndimage import maximum_filter1d

from puma_septic.validation import Array

__all__ = ["Break", "find_breaks"]

# Orders of the differences by which breaks are seen: a high one for what is smooth, a low one where breaks are close.
_ORDERS: Final = (7, 5, 4)
# Samples between two breaks that are seen as one place.
_SPANS: Final = range(7)
# Differences over a place are this many times those beside it.
_STANDS_OUT: Final = 20.0
# And this many times, where the polynomials beside it must be exact.
_CLEARLY: Final = 1e3
# Windows on either side that are held against those over a place.
_BESIDE: Final = 3
# A difference below this many roundings of the position, or deviations of its noise, is none.
_ROUNDINGS: Final = 64
# Lower derivatives of the difference vanish at a break but for this part of the step, in steps of time; nearly, where
# nothing better is found.
_VANISHING, _NEARLY = 1e-7, 0.02
# What is left of a difference beyond its cubic part, where pieces are cubic.
_CUBIC: Final = 1e-5
# The difference of the polynomials, and its slopes, are known to so many roundings of the position, or deviations of
# its noise: through seven samples and one step beyond them, 127 for its value. A step is this many times larger.
_EXTRAPOLATED: Final = 1000
_CERTAIN: Final = 50
# Roundings of a stamp by which even ones differ.
_EVEN: Final = 8.0
# A root so far outside its place, in steps of time, is at the border.
_OUTSIDE: Final = 0.02
# Breaks of two joints so close together, in steps of time, are one: by their order, as that is how well they are known.
_SAME: Final = {1: 1e-4, 2: 1e-4, 3: 1e-3, 4: 1e-2}
# A break this near to an end, in steps of time, is that of the end itself: what is between no sample sees.
_AT_END: Final = 0.02
# A rise of the acceleration within this part of a step of time at an end is a step of it.
_BESIDE_END: Final = 0.5
# Samples of the polynomial on either side: within those that stand out beside a place.
_SIDE: Final = 7
# More places than this that may be breaks are no motion that somebody planned.
_MOST_PLACES: Final = 2000


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Break:
    """An instant, s, at which the derivative of this order steps, after the sample `gap`.

    By `doubt`, a part of the step of time, rounding or noise may have moved it.
    """

    time: float
    order: int
    gap: int
    doubt: float = 0.0


class Found(NamedTuple):
    """The order of a break, where it is, and by how much it may be elsewhere, in steps of time."""

    order: int
    at: float
    doubt: float


class Place(NamedTuple):
    """Breaks are after the sample `first` and before the sample `last`."""

    first: int
    last: int
    is_clear: bool


def find_breaks(t: Array, q: Array, noise: Array, ends: Array) -> tuple[tuple[Break, ...], ...]:
    """The breaks of each joint, in order; a break at the start or the end itself is none.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Increasing, s.
    q : ndarray, shape (n, n_joints)
    noise : ndarray, shape (n_joints,)
        Standard deviation of a sample.
    ends : ndarray, shape (2, 2, n_joints)
        Velocity and acceleration at the start, and at the end. A joint without a velocity is where it was before; one
        with an acceleration has its step there.
    """
    rests, steps = ends[:, 0] == 0, ends[:, 1] != 0
    before = t[0] + (t[1] - t[0]) * np.arange(-_SIDE, 0)
    after = t[-1] + (t[-1] - t[-2]) * np.arange(1, _SIDE + 1)
    times, padded = np.concatenate([before, t, after]), np.pad(q, ((_SIDE, _SIDE), (0, 0)), mode="edge")
    rounding = np.maximum(np.finfo(float).eps * np.abs(q).max(axis=0), noise)
    found = []
    for j, places in enumerate(_places(times, padded, _ROUNDINGS * rounding)):
        # Where a joint does not rest at an end, nothing is known of what was beyond.
        span = slice(0 if rests[0, j] else _SIDE, len(times) - (0 if rests[1, j] else _SIDE))
        found.append(
            _inside(t, steps[:, j], _of_joint(times, padded[:, j], places, span, _EXTRAPOLATED * float(rounding[j])))
        )
    return _united(t, found)


def _inside(t: Array, steps: Array, breaks: Sequence[Found]) -> list[Break]:
    """Breaks that are not at the very start or end, nor beside a step of the acceleration there."""
    found = []
    for order, time, doubt in sorted(breaks, key=lambda one: one.at):
        gap = int(np.clip(np.searchsorted(t, time, side="right") - 1, 0, len(t) - 2))
        low, high = (t[gap + 1] - t[gap]) * np.where(steps, _BESIDE_END, _AT_END)
        if t[0] + low < time < t[-1] - high:
            found.append(Break(time=time, order=order, gap=gap, doubt=doubt))
    return found


def _places(t: Array, q: Array, floor: Array) -> list[list[Place]]:
    """Where a joint's differences stand out from those beside: the shortest places first, then the clearest."""
    best = np.zeros((len(_SPANS), len(t), q.shape[1]))
    for order in _ORDERS:
        size = _differences(t, q, order)
        for span in _SPANS:
            over = _prominence(size, order, span, floor)
            best[span, : len(over)] = np.maximum(best[span, : len(over)], over)
    places = []
    for prominence in best.transpose(2, 0, 1):
        spans, firsts = np.nonzero(prominence >= _STANDS_OUT)
        sizes = prominence[spans, firsts]
        order_of = np.lexsort([-sizes, spans])[: 0 if len(spans) > _MOST_PLACES else None]
        lasts, clear = firsts + spans + 1, sizes >= _CLEARLY
        places.append([Place(int(firsts[k]), int(lasts[k]), bool(clear[k])) for k in order_of])
    return places


def _differences(t: Array, q: Array, order: int) -> Array:
    """Divided differences of the samples from each on, times a factor that makes their weights a unit vector."""
    times = sliding_window_view(t, order + 1)
    if np.ptp(np.diff(t)) <= _EVEN * np.spacing(np.abs(t).max()):
        times = times[:1]  # stamps that are even but for rounding have one row of weights
    x = (times - times[:, :1]) / (times[:, -1:] - times[:, :1])
    weights = 1 / (x[:, :, None] - x[:, None, :] + np.eye(order + 1)).prod(axis=2)
    weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    values = sliding_window_view(q, order + 1, axis=0)
    # The values are in the last axis; a single row of weights is that of all.
    return np.asarray(np.abs(((values - values[..., :1]) * weights[:, None]).sum(axis=2)))


def _prominence(size: Array, order: int, span: int, floor: Array) -> Array:
    """By how many times the differences over each place of so many samples are larger than those beside it.

    Row g is of the place from sample g to sample g + span + 1; differences from g - order + 1 to g + span go over it.
    """
    edge = order + _BESIDE
    padded = np.pad(size, ((edge, edge), (0, 0)))
    count = len(size) + order - 1 - span
    side, over = _running(padded, _BESIDE)[1:], _running(padded, order + span)[1 + _BESIDE :][:count]
    beside = np.maximum(side[:count], side[order + span + _BESIDE :][:count])
    prominence = over / np.maximum(np.maximum(beside, floor), np.finfo(float).tiny)
    # A place near an end has no differences on one side to be held against.
    prominence[:order], prominence[len(prominence) - order :] = 0.0, 0.0
    return np.asarray(prominence)


def _running(values: Array, count: int) -> Array:
    """The largest of so many values from each on."""
    return np.asarray(maximum_filter1d(values, count, axis=0, origin=-(count // 2)))


def _of_joint(t: Array, q: Array, places: Sequence[Place], span: slice, uncertain: float) -> list[Found]:
    """The breaks of a joint, at times in s: exact ones first, then those that come near to one."""
    free, found = np.zeros(len(t), np.bool_), list[Found]()
    free[span] = True
    for allowed in (_VANISHING, _NEARLY):
        for place in places:
            # Breaks may be at the samples that bound the place, and a little beyond.
            for before, after in ((0, 0), (1, 0), (0, 1)):
                first, last = place.first - before, place.last + after

                if first - _SIDE + 1 < span.start or last + _SIDE > span.stop or not free[first : last + 1].all():
                    continue
                if breaks := _steps(t, q, place._replace(first=first, last=last), allowed, uncertain):
                    found += breaks
                    free[first : last + 1] = False
                    break
    return found


def _steps(t: Array, q: Array, place: Place, allowed: float, uncertain: float) -> list[Found]:
    """The steps that make the polynomials on both sides of a place differ: one, or two of jerk."""
    start, step = t[place.first], t[place.first + 1] - t[place.first]
    x, y = (t - start) / step, q - q[place.first]
    sides = slice(place.first + 1 - _SIDE, place.first + 1), slice(place.last, place.last + _SIDE)
    left, right = (Polynomial(np.linalg.solve(np.vander(x[side], increasing=True), y[side])) for side in sides)
    inner, end = slice(place.first + 1, place.last), float(x[place.last])
    found = _single(left - right, end, allowed, uncertain) if place.last == place.first + 1 else []
    if not found and place.is_clear:
        found = _two_of_jerk(left - right, end, x[inner], left(x[inner]) - y[inner], uncertain)
    return [one._replace(at=float(start + min(max(one.at, 0.0), end) * step)) for one in found]


def _single(difference: Polynomial, end: float, allowed: float, uncertain: float) -> list[Found]:
    """Where a difference is like ``c (x - x0)^m``, for the highest order m of 4, 3, 2 and 1.

    Its lower derivatives vanish there; a step of velocity outweighs the next derivatives instead.
    """
    derivatives = [difference]
    for _ in range(5):
        derivatives.append(derivatives[-1].deriv())
    for order in (4, 3, 2, 1):
        small = derivatives[: order - 1] if order > 1 else derivatives[2:4]
        for x in _within(derivatives[order - 1].roots(), end, _OUTSIDE):
            size = abs(derivatives[order](x))
            least = max((_NEARLY if order == 1 else allowed) * size, uncertain)
            if size >= _CERTAIN * uncertain and all(abs(one(x)) <= least for one in small):
                return [Found(order, x, uncertain / size)]
    return []


def _two_of_jerk(difference: Polynomial, end: float, x: Array, passed: Array, uncertain: float) -> list[Found]:
    """Where a difference is ``c1 (x - x1)^3 + c2 (x - x2)^3``, by Prony's method about the middle.

    At the samples x between, only what was `passed` already makes a difference: four numbers fit any cubic.
    """
    middle = end / 2
    series = np.asarray(difference(Polynomial([middle, 1.0])).coef, dtype=float)
    series = np.pad(series, (0, max(0, 5 - len(series))))
    size = np.abs(series[:4]).max()
    if size < _CERTAIN * uncertain or np.abs(series[4:]).max() > max(_CUBIC * size, uncertain):
        return []
    moments = np.array([series[3], -series[2] / 3, series[1] / 3, -series[0]])
    system = np.array([[moments[1], -moments[0]], [moments[2], -moments[1]]])
    if abs(np.linalg.det(system)) <= 1e-12 * np.abs(moments).max() ** 2:
        return []
    total, product = np.linalg.solve(system, moments[2:])
    both = sorted(_within(np.roots([1.0, -total, product]) + middle, end, _VANISHING))
    if len(both) < 2 or both[1] - both[0] < _VANISHING:
        return []
    factors = np.linalg.solve(np.vander(np.array(both) - middle, increasing=True).T, moments[:2])
    made = sum(factor * np.maximum(0.0, x - at) ** 3 for factor, at in zip(factors, both, strict=True))
    if (np.abs(made - passed) > max(_CUBIC * size, uncertain)).any():
        return []
    return [Found(3, at, 0.0) for at in both]


def _within(roots: ArrayLike, end: float, margin: float) -> list[float]:
    """The real ones of some roots that are in [0, end], but for a margin."""
    found = np.asarray(roots, dtype=complex)
    return [float(x) for x in found.real[np.abs(found.imag) <= margin] if -margin <= x <= end + margin]


def _united(t: Array, found: Sequence[list[Break]]) -> tuple[tuple[Break, ...], ...]:
    """The breaks, those of several joints that are one at one instant: that of the lowest order is known best.

    Left apart, two instants that only rounding tells apart make an interval so short that its acceleration is rounding.
    """
    every = sorted((one for joint in found for one in joint), key=lambda one: one.time)
    known: dict[Break, float] = {}
    for k, one in enumerate(every):
        if one in known:
            continue
        step = float(t[one.gap + 1] - t[one.gap])
        group = [
            other
            for other in every[k:]
            if other.time - one.time <= step * max(_SAME[max(one.order, other.order)], one.doubt, other.doubt)
        ]
        best = min(group, key=lambda other: (other.order, other.doubt)).time
        known |= {other: best for other in group if other not in known}
    return tuple(tuple(replace(one, time=known[one]) for one in joint) for joint in found)
