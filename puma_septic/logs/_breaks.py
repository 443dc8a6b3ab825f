"""Where a sampled motion is less than smooth: steps of its acceleration, jerk or snap between two samples.

A clean log knows such an instant far better than its step of time. The polynomials through the samples on either side
differ by ``c (t - tau)^m`` where the m-th derivative steps at tau, whatever lies between the two samples; tau is the
root of the difference's derivative of order m - 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from puma_septic.validation import Array

__all__ = ["Break", "find_breaks"]

# Orders of the differences by which breaks are seen: a high one for what is smooth, a low one where breaks are close.
_ORDERS: Final = (7, 5, 4)
# Differences over a break are this many times those beside it.
_STANDS_OUT: Final = 20.0
# Windows on either side that are held against those over a gap.
_BESIDE: Final = 3
# A difference below this many roundings of the position is none.
_ROUNDINGS: Final = 64
# Lower derivatives of the difference vanish at the break but for this part of the step, in steps of time.
_VANISHING: Final = 0.02
# A root so far outside the gap, in steps of time, is at its border.
_OUTSIDE: Final = 0.02
# Breaks of two joints so close together, in steps of time, are one: by their order, as that is how well they are known.
_SAME: Final = {1: 1e-5, 2: 1e-5, 3: 1e-3, 4: 1e-2}
# Samples of the polynomial on either side, at most and at least.
_MOST, _FEWEST = 7, 4
# More breaks than this are no motion that somebody planned.
_MOST_BREAKS: Final = 200


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Break:
    """An instant, s, at which the derivative of this order steps, between the samples `gap` and ``gap + 1``."""

    time: float
    order: int
    gap: int


def find_breaks(t: Array, q: Array, noise: Array) -> tuple[tuple[Break, ...], ...]:
    """The breaks of each joint, in order.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Increasing, s.
    q : ndarray, shape (n, n_joints)
    noise : ndarray, shape (n_joints,)
        Standard deviation of a sample.
    """
    rounding = np.finfo(float).eps * np.abs(q).max(axis=0)
    found: list[list[Break]] = [[] for _ in q.T]
    for j, gaps in enumerate(_gaps(t, q, _ROUNDINGS * np.maximum(rounding, noise))):
        borders = np.concatenate([[-1], gaps, [len(t) - 1]])
        for gap, left, right in zip(gaps.tolist(), np.diff(borders)[:-1], np.diff(borders)[1:], strict=True):
            found[j] += _located(t, q[:, j], gap, min(_MOST, int(left)), min(_MOST, int(right)))
    return _united(t, found)


def _gaps(t: Array, q: Array, floor: Array) -> list[NDArray[np.int64]]:
    """Gaps between samples, by the first of them, over which a joint's differences stand out from those beside it."""
    best = np.zeros((len(t) - 1, q.shape[1]))
    for order in _ORDERS:
        if len(t) > order + 2 * _BESIDE:
            best = np.maximum(best, _prominence(t, q, order, floor))
    found = []
    for prominence in best.T:
        gaps: list[int] = []
        wanted = np.flatnonzero(prominence >= _STANDS_OUT)
        for gap in wanted[np.argsort(-prominence[wanted])].tolist() if len(wanted) < _MOST_BREAKS else ():
            if all(abs(gap - other) > 2 for other in gaps):
                gaps.append(gap)
        found.append(np.sort(np.array(gaps, dtype=np.int64)))
    return found


def _prominence(t: Array, q: Array, order: int, floor: Array) -> Array:
    """By how many times the differences over each gap are larger than those beside it, shape (n - 1, n_joints)."""
    times = sliding_window_view(t, order + 1)
    x = (times - times[:, :1]) / (times[:, -1:] - times[:, :1])
    weights = 1 / (x[:, :, None] - x[:, None, :] + np.eye(order + 1)).prod(axis=2)
    weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    values = sliding_window_view(q, order + 1, axis=0)
    size = np.abs(np.einsum("nk,njk->nj", weights, values - values[..., :1]))
    # Windows i - order + 1 to i go over the gap i; those before and after do not.
    padded = np.pad(size, ((order + _BESIDE, order + _BESIDE), (0, 0)))
    windows = sliding_window_view(padded, order + 2 * _BESIDE, axis=0)[1:-1]
    over = windows[..., _BESIDE : _BESIDE + order].max(axis=2)
    beside = np.maximum(windows[..., :_BESIDE].max(axis=2), windows[..., _BESIDE + order :].max(axis=2))
    prominence = over / np.maximum(np.maximum(beside, floor), np.finfo(float).tiny)
    # A gap near an end has no windows on one side to be held against.
    prominence[:order], prominence[len(prominence) - order :] = 0.0, 0.0
    return np.asarray(prominence)


def _located(t: Array, q: Array, gap: int, left: int, right: int) -> list[Break]:
    """The break in a gap, where the polynomials on both sides, through so many samples, agree on one."""
    if min(left, right) < _FEWEST:
        return []
    step = t[gap + 1] - t[gap]
    before, after = slice(gap + 1 - left, gap + 1), slice(gap + 1, gap + 1 + right)
    difference = np.zeros(_MOST)
    for part, sign in ((before, 1), (after, -1)):
        x = (t[part] - t[gap]) / step
        powers = np.linalg.solve(np.vander(x, increasing=True), q[part] - q[gap])
        difference[: len(powers)] += sign * powers
    for order in (4, 3, 2, 1):
        for x in _roots(difference, order):
            return [Break(time=float(t[gap] + min(max(x, 0.0), 1.0) * step), order=order, gap=gap)]
    return []


def _roots(difference: Array, order: int) -> list[float]:
    """Where in [0, 1] a difference, in powers of x, is like ``c (x - x0)^order``.

    Its lower derivatives vanish there; a step of velocity outweighs the next derivative instead.
    """
    derivatives = [np.polynomial.Polynomial(difference)]
    for _ in range(order + 1):
        derivatives.append(derivatives[-1].deriv())
    small = derivatives[: order - 1] if order > 1 else derivatives[2:]
    roots = derivatives[order - 1].roots()
    near = roots.real[(np.abs(roots.imag) < _OUTSIDE) & (np.abs(roots.real - 0.5) <= 0.5 + _OUTSIDE)]
    return [x for x in near.tolist() if all(abs(one(x)) <= _VANISHING * abs(derivatives[order](x)) for one in small)]


def _united(t: Array, found: Sequence[list[Break]]) -> tuple[tuple[Break, ...], ...]:
    """The breaks, those of several joints that are one at one instant: that of the lowest order is known best."""
    every = sorted((one for joint in found for one in joint), key=lambda one: one.time)
    known: dict[Break, float] = {}
    for k, one in enumerate(every):
        if one in known:
            continue
        step = float(t[one.gap + 1] - t[one.gap])
        group = [other for other in every[k:] if other.time - one.time <= _SAME[max(one.order, other.order)] * step]
        best = min(group, key=lambda other: other.order).time
        known |= {other: best for other in group if other not in known}
    return tuple(tuple(replace(one, time=known[one]) for one in joint) for joint in found)
