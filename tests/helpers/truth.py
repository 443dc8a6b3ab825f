"""Torque whose friction has the sign of travel, by an own way: eigenvalue roots, dense samples, golden section, Gauss.

Of the package only the position's coefficients and the rigid-body torque at given samples are used. A place is a
piece of the position and a point x in [-1, 1] of it, so that no digit is lost on short pieces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

import puma_septic as ps
from puma_septic.piecewise.directions import STILL
from puma_septic.validation import Array

GOLDEN = (np.sqrt(5) - 1) / 2
SAMPLES = 97
# Sampled maxima this much below the best may be better between the samples.
CLOSE = 0.02
# Shorter than this, s, a joint rests only where it is constant to the last bit.
BRIEF = 1e-3
GAUSS = np.polynomial.legendre.leggauss(48)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Truth:
    """Peak magnitude, root mean square and net work of each joint's torque."""

    peak: Array
    rms: Array
    work: Array


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Stretches:
    """Parts (left, right) of pieces on which no joint reverses, and each joint's direction there, (k, n)."""

    piece: Array
    left: Array
    right: Array
    sign: Array


def truth(robot: ps.Robot, move: ps.Trajectory) -> Truth:
    """By samples of each stretch, refined where they are large."""
    some = stretches(move)
    positive, negative = robot.coulomb_friction.T
    coulomb = np.where(some.sign > 0, positive, np.where(some.sign < 0, negative, 0.0))

    def torque(k: Array, u: Array) -> tuple[Array, Array]:
        """Torque and velocity on stretches k at parts u of them, each (len(k), n)."""
        x = some.left[k] + (some.right[k] - some.left[k]) * u
        q, v, a = state(move, some.piece[k], x)
        return ps.inverse_dynamics(robot, q, v, a, friction=False) + robot.viscous_friction * v + coulomb[k], v

    count = len(some.piece)
    u = (1 - np.cos(np.linspace(0, np.pi, SAMPLES))) / 2
    values = np.abs(torque(np.repeat(np.arange(count), SAMPLES), np.tile(u, count))[0]).reshape(count, SAMPLES, -1)
    nodes, weights = GAUSS
    tau, v = torque(np.repeat(np.arange(count), len(nodes)), np.tile((nodes + 1) / 2, count))
    seconds = (some.right - some.left) / 2 * np.diff(move.position.offsets)[some.piece] / 2
    weight = np.multiply.outer(seconds, weights).ravel()
    return Truth(
        peak=_refined(lambda k, u: np.abs(torque(k, u)[0]), values, u),
        rms=np.sqrt(weight @ tau**2 / move.duration),
        work=weight @ (tau * v),
    )


def _refined(f, values: Array, u: Array) -> Array:  # type: ignore[no-untyped-def]
    """Best value of each joint after a golden section search around every sampled maximum that comes close to it."""
    best = values.max(axis=(0, 1))
    padded = np.pad(values, ((0, 0), (1, 1), (0, 0)), constant_values=-1.0)
    top = (values >= padded[:, :-2]) & (values >= padded[:, 2:]) & (values >= best * (1 - CLOSE)) & (best > 0)
    k, i, j = np.argwhere(top).T
    low, high = u[np.maximum(i - 1, 0)], u[np.minimum(i + 1, len(u) - 1)]
    rows = np.arange(len(k))
    for _ in range(40):
        inner, outer = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        rising = f(k, outer)[rows, j] > f(k, inner)[rows, j]
        low, high = np.where(rising, inner, low), np.where(rising, high, outer)
    np.maximum.at(best, j, f(k, (low + high) / 2)[rows, j])
    return best


def state(move: ps.Trajectory, piece: Array, x: Array) -> tuple[Array, Array, Array]:
    """Position, velocity and acceleration at places, by Clenshaw's recursion."""
    series = move.position.coefficients
    scale = 2 / np.diff(move.position.offsets)[piece][:, None]
    q, v, a = (
        chebyshev.chebval(x[:, None], chebyshev.chebder(series, order)[:, piece], tensor=False) for order in range(3)
    )
    return q, v * scale, a * scale**2


def stretches(move: ps.Trajectory) -> Stretches:
    """Pieces cut at every joint's reversals."""
    series = move.position.coefficients
    _, n, m = series.shape
    runs = [_runs(series[:, :, j]) for j in range(m)]
    places = np.unique(np.concatenate([np.column_stack([k, x]) for k in range(n) for x in ([-1.0], [1.0])]
                                      + [turns for turns, _ in runs]), axis=0)  # fmt: skip
    same = places[1:, 0] == places[:-1, 0]
    piece, left, right = places[:-1][same, 0].astype(int), places[:-1][same, 1], places[1:][same, 1]
    middle = piece + (left + right) / 4 + 0.5
    sign = np.zeros((len(piece), m))
    for j, (turns, signs) in enumerate(runs):
        where = np.searchsorted(turns[:, 0] + turns[:, 1] / 2 + 0.5, middle)
        size = np.abs(series[:, :, j])
        still = size[1:].sum(axis=0) <= 1e-14 * (1 + size[0]) * (np.diff(move.position.offsets) >= BRIEF)
        sign[:, j] = np.where(still[piece], 0.0, signs[where])
    return Stretches(piece=piece, left=left, right=right, sign=sign)


def _runs(series: Array) -> tuple[Array, Array]:
    """(piece, x) of each reversal of one joint, (k, 2), and the signs (k + 1,) between them.

    Alternating extremes of the position, of which the smallest excursions are taken out while they are below STILL.
    """
    places = [(i, x) for i in range(series.shape[1]) for x in (-1.0, *_critical(series[:, i]), 1.0)]
    value = np.array([chebyshev.chebval(x, series[:, i]) for i, x in places])
    # Of extremes that are equal but for rounding, the one at a break is the reversal.
    rounding = 1e-14 * (1 + np.abs(value).max())
    keep = [0]
    for k in range(1, len(places)):
        if abs(value[k] - value[keep[-1]]) > rounding:
            keep.append(k)
        elif abs(places[k][1]) == 1 and abs(places[keep[-1]][1]) != 1:
            keep[-1] = k
    while len(keep) > 1:
        steps = np.diff(value[keep])
        flat = [k for k in range(1, len(keep) - 1) if steps[k - 1] * steps[k] >= 0]
        if flat:
            del keep[flat[0]]
            continue
        smallest = int(np.argmin(np.abs(steps)))
        if abs(steps[smallest]) > STILL or len(keep) == 2:
            break
        # The first or last excursion loses its inner end, one inside both its ends.
        inner = [k for k in (smallest, smallest + 1) if 0 < k < len(keep) - 1]
        for k in reversed(inner):
            del keep[k]
    total = np.diff(value[keep])
    if len(keep) < 2 or np.abs(total).max() <= STILL:
        return np.empty((0, 2)), np.zeros(1)
    return np.array([places[k] for k in keep[1:-1]], dtype=float).reshape(-1, 2), np.sign(total)


def _critical(series: Array) -> list[float]:
    """Real zeros of the derivative inside [-1, 1]: eigenvalues, then Newton in extended precision."""
    slope = chebyshev.chebder(series)
    kept = np.flatnonzero(np.abs(slope) > 1e-15 * np.abs(slope).max())
    if not len(kept) or kept[-1] == 0:
        return []
    slope = slope[: kept[-1] + 1].astype(np.longdouble)
    bend = chebyshev.chebder(slope)
    found = chebyshev.chebroots(slope.astype(float))
    x = found[np.abs(found.imag) < 1e-5].real.astype(np.longdouble)
    for _ in range(4):
        step = chebyshev.chebval(x, slope) / np.where((b := chebyshev.chebval(x, bend)) == 0, 1, b)
        x = x - np.clip(step, -1e-4, 1e-4)
    return [float(root) for root in np.sort(x) if -1 < root < 1]
