"""The largest joint accelerations that the torque limits allow at every pose of a box."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.document import SCHEMAS, card, one_line, plain
from puma_septic.dynamics import check_inertia, check_plain_friction, check_uncoupled
from puma_septic.errors import InputError
from puma_septic.robot import Payload, Robot
from puma_septic.validation import (
    Array,
    checked_each,
    checked_kind,
    checked_number,
    read_only,
)
from puma_septic.views import accelerations as view
from puma_septic.worst_case._demand import Demand
from puma_septic.worst_case._polynomials import fitted
from puma_septic.worst_case._region import Region, acting_joints, certified_minimum, checked_region, random_poses

__all__ = ["QUANTILES", "AccelerationLimits", "acceleration_limits"]

_ROUNDS: Final = 8


def _fair_shares(demand: Demand, poses: Array) -> Array:
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


QUANTILES: Final = (0.01, 0.05, 0.5)
"""Shares of random poses that do not allow the accelerations called typical."""

_POSES: Final = 2000
_MOST_BOXES: Final = 60_000
_KEYS: Final = ("guaranteed", "attained", "speeds", "pose")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class AccelerationLimits:
    """Accelerations, in one proportion, that the torque limits allow; made by `acceleration_limits`.

    Attributes
    ----------
    robot : Robot
    region : ndarray, shape (n_joints, 2)
        rad (m).
    speeds : ndarray, shape (n_joints,)
        Magnitudes up to which they hold, rad/s (m/s).
    guaranteed : ndarray, shape (n_joints,)
        Magnitudes allowed at every pose of the region, in every combination of signs, rad/s^2 (m/s^2): certified.
        0 where the arm cannot even be held at some pose.
    attained : ndarray, shape (n_joints,)
        Magnitudes beyond which the governing joint's limit is broken at `pose`: no larger ones can be guaranteed.
    joint : str
        The governing joint, whose torque limit is reached.
    pose : ndarray, shape (n_joints,)
        Where it is, rad (m).
    typical : ndarray, shape (3, n_joints)
        Magnitudes that 99, 95 and 50 % of random poses of the region allow: see `QUANTILES`.
    not_assessed : tuple of str
        Joints whose torque limit is not known: whether they can follow is not known either.
    """

    robot: Robot
    region: Array
    speeds: Array
    guaranteed: Array
    attained: Array
    joint: str
    pose: Array
    typical: Array
    not_assessed: tuple[str, ...]

    def __post_init__(self) -> None:
        for name in ("region", "speeds", "guaranteed", "attained", "pose", "typical"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    @property
    def gap(self) -> float:
        """What a better bound could still gain: ``attained / guaranteed - 1``; infinite where nothing is guaranteed."""
        k = int(np.argmax(self.attained))
        if not self.attained[k] > 0:
            return 0.0
        return float(self.attained[k] / self.guaranteed[k] - 1) if self.guaranteed[k] > 0 else np.inf

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document.

        Returns
        -------
        dict
        """
        robot = self.robot
        return {
            "schema": SCHEMAS["accelerations"],
            "robot": robot.name,
            "governing_joint": self.joint,
            "gap": plain(self.gap),
            "quantiles": list(QUANTILES),
            "joints": [
                {
                    "name": name,
                    "is_prismatic": bool(robot.is_prismatic[j]),
                    "region": plain(self.region[j]),
                    "effort": plain(robot.limits.effort[j]),
                    **{key: plain(getattr(self, key)[j]) for key in _KEYS},
                    "typical": plain(self.typical[:, j]),
                }
                for j, name in enumerate(robot.joint_names)
            ],
            "not_assessed": list(self.not_assessed),
        }

    def moveit_yaml(self) -> str:
        """The guaranteed accelerations as MoveIt's ``joint_limits.yaml``, with the robot's velocity limits.

        Numbers are rounded down to six digits. MoveIt: "Planning with joint limits", ``joint_limits.yaml``.

        Returns
        -------
        str

        Raises
        ------
        InputError
            Where nothing is guaranteed: MoveIt needs a positive number.
        """
        if not (self.guaranteed > 0).all():
            raise InputError(
                f"nothing to write: joint {self.joint!r} cannot hold the arm at every pose of the region, so no"
                " acceleration is guaranteed"
            )
        return view.moveit(self.to_dict(), self.robot.limits.velocity.tolist())

    def __str__(self) -> str:
        return view.text(self.to_dict())

    def __repr__(self) -> str:
        return one_line("AccelerationLimits", self._facts())

    def _repr_html_(self) -> str:
        return card("AccelerationLimits", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "robot": self.robot.name,
            "guaranteed": [float(f"{value:.4g}") for value in self.guaranteed],
            "governing joint": self.joint,
            "certified to": f"{100 * self.gap:.2g} %",
        }


def acceleration_limits(
    robot: Robot,
    *,
    payload: Payload | None = None,
    region: Region | None = None,
    speeds: ArrayLike | None = None,
    shares: Mapping[str, float] | None = None,
    gap: float = 0.04,
) -> AccelerationLimits:
    """The largest joint accelerations that the torque limits allow at every pose of a box.

    Accelerations up to ``a`` are allowed at a pose if for each joint i, whatever their signs,

    ``sum_j abs(M_ij(q)) a_j + abs(g_i(q)) + sum_jk abs(c_ijk(q)) v_j v_k + friction_i <= effort_i``.

    All of ``M``, ``g`` and ``c`` are polynomials in the cosines and sines of the joints, whose values over a box lie
    in the hull of control values: a convex demand is largest at one of these. Boxes are halved, the worst first.

    Parameters
    ----------
    robot : Robot
        Its effort limits count; a joint without one is not assessed.
    payload : Payload, optional
        Instead of the robot's own.
    region : mapping of str to (float, float), optional
        Bounds of some joints, rad (m); the position limits of the others.
    speeds : array_like, shape () or (n_joints,), optional
        Magnitudes up to which all joints may move meanwhile, rad/s (m/s); at rest by default.
    shares : mapping of str to float, optional
        Proportion of the joints' accelerations. By default the one whose product of accelerations, over random poses,
        is largest.
    gap : float
        Relative difference of bound and worst pose found to stop at; a smaller one takes longer.

    Returns
    -------
    AccelerationLimits

    Raises
    ------
    InputError
        For a robot without effort limits, with friction that depends on the load, and invalid bounds.
    ModelError
        If a moving part has no inertia, or more joints act together than can be bounded.

    Examples
    --------
    >>> import puma_septic as ps
    >>> small = {name: (0.0, 0.2) for name in ps.load_robot().joint_names}
    >>> limits = ps.acceleration_limits(ps.load_robot(), region=small)
    >>> limits.joint, bool((limits.guaranteed > 0).all()), limits.gap < 0.042
    ('joint3', True, True)
    """
    checked_number("gap", gap, above=0.0, at_most=1.0)
    checked_kind("robot", robot, Robot)
    carrying = robot if payload is None else robot.with_payload(payload)
    check_inertia(carrying)
    check_uncoupled(carrying, "the certified bound of accelerations")
    check_plain_friction(carrying, "acceleration_limits")
    assessed = [j for j, effort in enumerate(carrying.limits.effort) if np.isfinite(effort)]
    if not assessed:
        raise InputError(f"robot {carrying.name!r} has no effort limits, which acceleration limits are made of")
    bounds = checked_region(carrying, region)
    moving = Demand(robot=carrying, speeds=_checked_speeds(carrying, speeds), accelerations=np.ones(carrying.n_joints))
    poses = random_poses(bounds, _POSES)
    demand = moving.scaled(_shares(moving, poses, shares))
    pose, row, factor = _worst_pose(demand, bounds, poses)
    certified = _certified(demand, bounds, assessed, factor * (1 - gap)) if factor > 0 else 0.0
    usual = np.quantile(np.maximum(0.0, demand.factors(poses).min(axis=1)), QUANTILES, method="lower")
    return AccelerationLimits(
        robot=carrying,
        region=bounds,
        speeds=demand.speeds,
        guaranteed=certified * demand.accelerations,
        attained=max(0.0, factor) * demand.accelerations,
        joint=carrying.joint_names[row],
        pose=pose,
        typical=np.outer(usual, demand.accelerations),
        not_assessed=tuple(name for j, name in enumerate(carrying.joint_names) if j not in assessed),
    )


def _checked_speeds(robot: Robot, speeds: ArrayLike | None) -> Array:
    return checked_each("speeds", 0.0 if speeds is None else speeds, robot.n_joints, at_least=0.0)


def _shares(demand: Demand, poses: Array, shares: Mapping[str, float] | None) -> Array:
    """Accelerations in the proportion that is asked for, else in the fairest one."""
    if shares is None:
        return _fair_shares(demand, poses)
    names = demand.robot.joint_names
    for name in shares:
        demand.robot.joint_index(name)
    if set(names) - set(shares):
        raise InputError(f"shares: no number for {', '.join(sorted(set(names) - set(shares)))}; every joint needs one")
    return np.array([checked_number(f"shares[{name!r}]", shares[name], above=0.0) for name in names])


def _worst_pose(demand: Demand, bounds: Array, poses: Array) -> tuple[Array, int, float]:
    """The pose found that allows least, its governing joint and the factor that it allows.

    From the worst random poses, one joint after the other is put where least is allowed, on ever finer grids.
    """
    factors = demand.factors(poses).min(axis=1)
    best = poses[np.argsort(factors)[:12]]
    width = bounds[:, 1] - bounds[:, 0]
    for fineness in (1.0, 1.0, 0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4):
        for k in range(len(bounds)):
            steps = np.linspace(-0.5, 0.5, 17) * width[k] * fineness
            trial = np.repeat(best[:, None], len(steps) + 2, axis=1)
            trial[:, :-2, k] = np.clip(best[:, k : k + 1] + steps, *bounds[k])
            trial[:, -2:, k] = bounds[k]
            values = demand.factors(trial.reshape(-1, len(bounds))).min(axis=1).reshape(len(best), -1)
            best = trial[np.arange(len(best)), values.argmin(axis=1)]
    factors = demand.factors(best)
    k, row = divmod(int(np.argmin(factors)), factors.shape[1])
    return best[k], row, float(factors[k, row])


def _certified(demand: Demand, bounds: Array, rows: Sequence[int], goal: float) -> float:
    """A factor, no larger than the goal, that every pose allows in each of these rows."""
    robot = demand.robot
    least = goal
    for row in rows:
        polynomial = fitted(
            partial(demand.parts, row=row),
            bounds,
            tuple(robot.is_prismatic),
            degrees=_degrees(demand, row),
            scale=float(robot.limits.effort[row]),
        )
        bound = partial(demand.least_factor, row, polynomial)
        least = min(least, certified_minimum(polynomial, bounds, bound, goal=goal, at_most=_MOST_BOXES))
    return max(0.0, least)


def _degrees(demand: Demand, row: int) -> list[int]:
    """Inertia about a joint is quadratic in those that it carries, affine in the others; Coriolis torque quadratic."""
    robot = demand.robot
    model = robot.model
    carried = {model.names[k] for k in model.subtrees[model.getJointId(robot.joint_names[row])]}
    acting = acting_joints(robot, row)
    moving = bool(demand.speeds.any())
    return [
        0 if j not in acting else 2 if moving or (j != row and name in carried) else 1
        for j, name in enumerate(robot.joint_names)
    ]
