"""What the families' structure gives without a search: gradients by the via times, the best free via values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Final

import numpy as np

from puma_septic import profiles
from puma_septic.optimisation._variables import MakeTrajectory
from puma_septic.piecewise import Piecewise
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["SQUARES", "best_free_values", "gradient_by_times"]

# Objectives that are the integral of the square of a derivative, and its order.
SQUARES: Final = MappingProxyType({"integral_of_squared_acceleration": 2, "integral_of_squared_jerk": 3})


def gradient_by_times(make: MakeTrajectory, objective: str) -> Callable[[Trajectory], Array] | None:
    """The gradient of an integral of squares by the inner via times, where the family's structure gives it.

    One polynomial through the points (`septic`, `single_polynomial`): moving via k by dt changes the motion by
    ``-v(t_k) dt l_k(t)``, l_k the motion through 1 at via k and 0 at the others, since the polynomial must now be at
    the old place at the new time. Hence ``dJ/dt_k = -2 sum_j v_j(t_k) <d_j, l_k'>`` with the derivatives d and l' of
    the objective's order. For a spline that minimises the integral itself, everything but the multiplier of via k
    drops out by parts: ``dJ/dt_k = 2 sum_j v_j(t_k) D_j``, D the jump of the fifth derivative for `quintic_spline`
    and jerk^2, and ``-2 sum_j v_j(t_k) D_j`` with the jump of the jerk for `cubic_spline` and acceleration^2.
    """
    if objective not in SQUARES:
        return None
    order = SQUARES[objective]
    if make in (profiles.septic, profiles.single_polynomial):
        return lambda trajectory: _of_one_polynomial(make, trajectory, order)
    if (make, order) == (profiles.quintic_spline, 3):
        return lambda trajectory: _of_natural_spline(
            trajectory, trajectory.derivative(3).derivative().derivative(), 2.0
        )
    if (make, order) == (profiles.cubic_spline, 2):
        return lambda trajectory: _of_natural_spline(trajectory, trajectory.derivative(3), -2.0)
    return None


def _of_one_polynomial(make: MakeTrajectory, trajectory: Trajectory, order: int) -> Array:
    units = make(np.eye(len(trajectory.times))[:, 1:-1], trajectory.times)
    products = _inner_matrix(trajectory.derivative(order), units.derivative(order))
    velocity = trajectory(trajectory.times[1:-1], order=1)
    return np.asarray(-2 * np.einsum("kj,jk->k", velocity, products))


def _of_natural_spline(trajectory: Trajectory, multiplier: Piecewise, factor: float) -> Array:
    velocity = trajectory(trajectory.times[1:-1], order=1)
    return np.asarray(factor * (velocity * multiplier.jumps().sizes).sum(axis=1))


def best_free_values(
    make: MakeTrajectory, points: Array, times: Array, *, free: Sequence[str], order: int
) -> Mapping[str, Array]:
    """Via velocities and accelerations with the least integral of the squared derivative of this order, exactly.

    The motion is linear in them: ``d = d_0 + sum_i c_i b_i``, b_i the motion with all points zero and the i-th value
    one. So the best c solves ``<b_i, b_k> c_k = -<b_i, d_0>``, for each joint.
    """
    k = len(points)
    inner = np.arange(1, k - 1)
    units = len(inner) * len(free)
    values = {name: np.zeros((k, units)) for name in free}
    for i, name in enumerate(free):
        values[name][inner, i * len(inner) + np.arange(len(inner))] = 1.0
    basis = make(np.zeros((k, units)), times, **values).derivative(order)
    fixed = make(points, times).derivative(order)
    solution = np.linalg.solve(_inner_matrix(basis, basis), -_inner_matrix(basis, fixed))
    best = {}
    for i, name in enumerate(free):
        best[name] = np.zeros_like(points)
        best[name][inner] = solution[i * len(inner) : (i + 1) * len(inner)]
    return best


def _inner_matrix(f: Piecewise, g: Piecewise) -> Array:
    """Integrals of all products, shape (m_f, m_g)."""
    m, n = f.n_components, g.n_components
    return f[np.repeat(np.arange(m), n)].inner(g[np.tile(np.arange(n), m)]).reshape(m, n)
