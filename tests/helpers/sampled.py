"""What exact results are held to: dense samples refined locally, and Gauss quadrature, on plain NumPy.

Nothing here uses a series or a root finder of the package: only values of a function at given times.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

import puma_septic as ps
from puma_septic.validation import Array

Function = Callable[[Array], Array]
GOLDEN = (np.sqrt(5) - 1) / 2
# A sampled maximum this much below the best one may be the better one between the samples.
CLOSE = 1e-3


def between(breaks: Array, count: int) -> Array:
    """Times (n_intervals, count) that fill each interval, its last instant being the one before the break."""
    left, right = breaks[:-1, None], breaks[1:, None]
    times = left + (right - left) * np.linspace(0.0, 1.0, count)
    return np.clip(times, left, np.nextafter(right, left))


def refined_extrema(f: Function, breaks: Array, count: int = 2000) -> tuple[Array, Array]:
    """Least and greatest value of each component of f, smooth between breaks: each (m,)."""
    times = between(breaks, count)
    values = f(times.ravel()).reshape(*times.shape, -1)
    return -_refined_maxima(lambda t: -f(t), times, -values), _refined_maxima(f, times, values)


def refined_peak(f: Function, breaks: Array, count: int = 2000) -> Array:
    """Largest magnitude of each component, shape (m,)."""
    return np.abs(refined_extrema(f, breaks, count)).max(axis=0)


def _refined_maxima(f: Function, times: Array, values: Array) -> Array:
    """The best of all sampled local maxima after a golden section search between their neighbours."""
    best = values.max(axis=(0, 1))
    spread = best - values.min(axis=(0, 1))
    padded = np.pad(values, ((0, 0), (1, 1), (0, 0)), constant_values=-np.inf)
    top = (values >= padded[:, :-2]) & (values >= padded[:, 2:]) & (values >= best - CLOSE * spread) & (spread > 0)
    i, k, j = np.argwhere(top).T
    low, high = times[i, np.maximum(k - 1, 0)], times[i, np.minimum(k + 1, times.shape[1] - 1)]
    rows = np.arange(len(i))
    # 0.618^25 of a step of the samples: squared, far below rounding of the value.
    for _ in range(25):
        inner, outer = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        rising = f(outer)[rows, j] > f(inner)[rows, j]
        low, high = np.where(rising, inner, low), np.where(rising, high, outer)
    np.maximum.at(best, j, f((low + high) / 2)[rows, j])
    return best


def quadrature(f: Function, breaks: Array, panels: int = 40, order: int = 12) -> Array:
    """Integral of each component of f over the span by Gauss-Legendre panels, shape (m,)."""
    x, weights = np.polynomial.legendre.leggauss(order)
    edges = np.concatenate([np.linspace(a, b, panels + 1)[:-1] for a, b in pairwise(breaks)])
    edges = np.append(edges, breaks[-1])
    half = np.diff(edges)[:, None] / 2
    times = edges[:-1, None] + half * (x + 1)
    return (half * weights).ravel() @ f(times.ravel())


def reversals(f: Function, breaks: Array, count: int = 2000) -> Array:
    """Times at which a component of f changes sign inside an interval, found by samples and bisection."""
    times = between(breaks, count)
    values = f(times.ravel()).reshape(*times.shape, -1)
    noise = 1e-13 * np.abs(values).max(axis=(0, 1))
    found = []
    for i, j in np.ndindex(len(times), values.shape[2]):
        sure = np.flatnonzero(np.abs(values[i, :, j]) > noise[j])
        sign = np.sign(values[i, sure, j])
        for k in np.flatnonzero(sign[:-1] * sign[1:] < 0):
            low, high = times[i, sure[k]], times[i, sure[k + 1]]
            for _ in range(60):
                middle = (low + high) / 2
                low, high = (middle, high) if np.sign(f(np.array([middle]))[0, j]) == sign[k] else (low, middle)
            found.append((low + high) / 2)
    return np.unique(found)


def torque_with_friction(robot: ps.Robot, trajectory: ps.Trajectory) -> tuple[Function, Array]:
    """Joint torque as a plain function of time, and the breaks between which it is smooth."""
    moving = np.ptp(trajectory(np.linspace(*trajectory.breaks[[0, -1]], 500)), axis=0) > 1e-10
    breaks = np.union1d(trajectory.breaks, reversals(lambda t: trajectory(t, 1) * moving, trajectory.breaks))
    breaks = breaks[np.concatenate([[True], np.diff(breaks) > 1e-12])]
    middle = trajectory((breaks[:-1] + breaks[1:]) / 2, 1) * moving
    positive, negative = robot.coulomb_friction.T
    # A joint that rests over an interval, as on a level stretch of lspb, has no Coulomb term there.
    coulomb = np.where(middle > 1e-12, positive, np.where(middle < -1e-12, negative, 0.0))

    def torque(t: Array) -> Array:
        q, v, a = (trajectory(t, order) for order in range(3))
        rigid = ps.inverse_dynamics(robot, q, v, a, friction=False)
        piece = np.clip(np.searchsorted(breaks, t, side="right") - 1, 0, len(coulomb) - 1)
        return rigid + robot.viscous_friction * v + coulomb[piece]

    return torque, breaks
