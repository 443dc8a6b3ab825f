"""The proportion of joint accelerations that serves all joints best."""

from __future__ import annotations

from typing import Final

import numpy as np

from puma_septic.validation import Array
from puma_septic.worst_case._demand import Demand

__all__ = ["fair_shares"]

_ROUNDS: Final = 8


def fair_shares(demand: Demand, poses: Array) -> Array:
    """Accelerations whose product is largest among those that all of these poses allow, shape (n_joints,).

    Convex in their logarithms: ``max sum_j log a_j`` under ``sum_j abs(M_ij) a_j <= what is left of effort_i``. The
    product is largest in the same proportion whatever the joints' units. Poses that cannot be held do not count.
    """
    n = demand.robot.n_joints
    parts = np.abs(demand.parts(poses))
    effort = demand.robot.limits.effort - demand.friction
    left = effort - parts[..., 0] - parts[..., 1 + n :].sum(axis=-1)
    known = left > 0  # False for NaN
    rows = parts[..., 1 : 1 + n][known] / left[known][:, None]
    if not len(rows):
        return np.ones(n)
    # Where no limit of a joint is known that its acceleration asks for, it shares what the others have.
    rows = np.maximum(rows, 1e-9 * rows.max(axis=1, keepdims=True))
    log_a = -np.log(n * rows.max(axis=0))
    active = np.unique(rows.argmax(axis=0))
    for _ in range(_ROUNDS):
        log_a = _largest_product(rows[active], log_a)
        demands = rows @ np.exp(log_a)
        log_a = log_a - np.log(demands.max())
        worst = np.argsort(-demands)[:20]
        if demands.max() <= 1 + 1e-3:
            break
        active = np.union1d(active, worst)
    return np.asarray(np.exp(log_a))


def _largest_product(rows: Array, start: Array) -> Array:
    from scipy.optimize import minimize  # takes a fifth of a second, which no assessment needs

    found = minimize(
        lambda y: -float(y.sum()),
        start,
        jac=lambda y: -np.ones_like(y),
        constraints={
            "type": "ineq",
            "fun": lambda y: 1 - rows @ np.exp(y),
            "jac": lambda y: -rows * np.exp(y),
        },
        method="SLSQP",
    )
    return np.asarray(found.x if np.isfinite(found.x).all() else start)
