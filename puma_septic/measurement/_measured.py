"""Measured torques or currents against computed ones, and the friction and payload that explain them best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.dynamics import inverse_dynamics
from puma_septic.errors import InputError
from puma_septic.motion import Motion
from puma_septic.robot import Payload, Robot
from puma_septic.validation import Array, checked_array, read_only

__all__ = ["MeasuredTorque", "Proposal", "compare_measured"]

# Unit payloads for the first moments: any arm would do, as their difference is exactly linear.
_ARM: Final = 0.1
# Columns whose part of the whole is below this tell nothing of their parameter.
_RANK: Final = 1e-6
# Two standard deviations hold 95 %.
_SIGMAS: Final = 2.0
_SWEEPS: Final = 3
# So near to a reversal or a rest, in s, its recorded instant may be wrong: of a slow start 40 to 80 ms are within what
# noisy samples resolve.
_NEAR: Final = 0.06
_LAGS: Final = 50


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Proposal:
    """A parameter that explains the measured torques best, with what the samples leave unknown (95 %).

    Attributes
    ----------
    name : str
        Such as "viscous friction of joint1" or "payload mass".
    unit : str
    value, uncertainty : float
        NaN where the motion does not determine it.
    known : float
        What the robot has now.
    """

    name: str
    unit: str
    value: float
    uncertainty: float
    known: float

    def __str__(self) -> str:
        now = "" if np.isnan(self.known) else f" (now {self.known:.4g})"
        if np.isnan(self.value):
            return f"{self.name}: not determined by this motion{now}"
        return f"{self.name}: {self.value:.4g} +- {self.uncertainty:.2g} {self.unit}{now}"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MeasuredTorque:
    """Measured against computed torque, and what would bring them closer; a proposal, nothing is changed.

    Attributes
    ----------
    quantity : {"effort", "current"}
        What was measured. Of a current, the constants in N m/A (N/A) at the joint are among the proposals.
    residual : ndarray, shape (n_joints,)
        RMS of measured minus computed torque, N m (N); of a current NaN. NaN for joints without a measurement.
    explained : ndarray, shape (n_joints,)
        RMS of what the proposals leave, N m (N), of a current A.
    proposals : tuple of Proposal
    """

    quantity: str
    joint_names: tuple[str, ...]
    residual: Array
    explained: Array
    proposals: tuple[Proposal, ...]

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document; null for what is not known."""
        keys = ("name", "unit", "value", "uncertainty", "known")
        return {
            "quantity": self.quantity,
            "joints": list(self.joint_names),
            "residual_rms": [None if np.isnan(x) else float(x) for x in self.residual],
            "explained_rms": [None if np.isnan(x) else float(x) for x in self.explained],
            "proposals": [
                {key: None if value != value else value for key in keys for value in [getattr(one, key)]}
                for one in self.proposals
            ],
        }

    def __str__(self) -> str:
        unit = "N m" if self.quantity == "effort" else "A"
        parts = [
            f"{name} {'' if np.isnan(left) else f'{left:.3g}, '}{best:.3g}"
            for name, left, best in zip(self.joint_names, self.residual, self.explained, strict=True)
            if not np.isnan(best)
        ]
        left = "" if self.quantity == "current" else "as computed, and "
        head = f"Measured {self.quantity} [{unit}], RMS of what is left {left}with the proposals: {'; '.join(parts)}"
        return "\n".join([head, "Proposals (least squares, 95 %):", *(f"  {one}" for one in self.proposals)])


def compare_measured(
    motion: Motion, times: Array, *, effort: Array | None = None, current: Array | None = None
) -> MeasuredTorque:
    r"""Hold measured joint torques, or motor currents, against the computed ones.

    The torque is linear in what is proposed: ``tau = rigid body + payload (m, m c) + viscous v + coulomb(sign v)``. It
    is fitted by least squares over all samples in motion, joints weighted by what they leave; standard errors count
    samples that follow each other closely for as much less as their residuals are alike. A payload's inertia is that of
    a point mass. Of a current, ``i = (tau + friction) / k`` gives the constant k of each joint and its friction.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Within the motion, s.
    effort : ndarray, shape (n, n_joints)
        N m (N) at the joint; NaN for joints without.
    current : ndarray, shape (n, n_joints)
        A. One of the two.

    Raises
    ------
    InputError
        For both or neither, misshapen arrays, and no joint that was measured.
    """
    if (effort is None) == (current is None):
        raise InputError("compare_measured takes either effort or current")
    robot, quantity = motion.robot, "current" if effort is None else "effort"
    shape = (len(times), robot.n_joints)
    measured = checked_array(quantity, effort if current is None else current, shape, allow_nan=True)  # type: ignore[arg-type]
    joints = np.flatnonzero(np.isfinite(measured).all(axis=0))
    if not len(joints):
        raise InputError(f"{quantity}: no joint has measured values at all instants")
    state = [motion.trajectory(times, order) for order in range(3)]
    direction = _steady_direction(motion, times)
    known = inverse_dynamics(robot, *state, friction=False)
    if quantity == "current":
        return _currents(robot, measured, joints, known, state[1], direction)
    return _efforts(motion, times, measured, joints, state, direction)


def _efforts(
    motion: Motion, times: Array, measured: Array, joints: NDArray[np.intp], state: list[Array], direction: Array
) -> MeasuredTorque:
    """Friction of each measured joint, and one payload for all."""
    robot = motion.robot
    bare = robot.with_payload(None)
    target = measured - inverse_dynamics(bare, *state, friction=False)
    payload = _payload_columns(bare, state)
    moving = direction != 0
    correction = np.zeros_like(target)
    for _ in range(_SWEEPS):
        solution = _solved([
            (np.column_stack([payload[moving[:, j], j], *_friction_columns(state[1], direction, j)]),
             (target - correction)[moving[:, j], j])
            for j in joints
        ], shared=payload.shape[2])  # fmt: skip
        correction = _of_point(bare, state, solution.values[:4]) - payload @ np.nan_to_num(solution.values[:4])
    left = measured - motion.torque(times)
    explained = _by_joint(robot.n_joints, joints, solution.left)
    proposals = [*_payload_proposals(robot, solution), *_friction_proposals(robot, joints, solution)]
    return MeasuredTorque(
        quantity="effort",
        joint_names=robot.joint_names,
        residual=read_only(np.sqrt((left**2).mean(axis=0))),
        explained=read_only(explained),
        proposals=tuple(proposals),
    )


def _currents(
    robot: Robot, measured: Array, joints: NDArray[np.intp], known: Array, v: Array, direction: Array
) -> MeasuredTorque:
    """The constant and the friction of each joint: ``i = tau / k + viscous v / k + coulomb / k``."""
    proposals, explained = [], []
    for j in joints:
        moving = direction[:, j] != 0
        columns = np.column_stack([known[moving, j], *_friction_columns(v, direction, int(j))])
        solution = _solved([(columns, measured[moving, j])], shared=0)
        scale, spread = solution.values[0], solution.errors[0]
        effort, name = ("N" if robot.is_prismatic[j] else "N m"), robot.joint_names[j]
        k = 1 / scale if abs(scale) > spread else np.nan
        proposals.append(Proposal(name=f"torque constant of {name} at the joint", unit=f"{effort}/A", value=float(k),
                                  uncertainty=float(abs(k) * spread / abs(scale)), known=np.nan))  # fmt: skip
        friction = _Solution(values=solution.values[1:] * k, errors=solution.errors[1:] * abs(k), left=solution.left)
        proposals += _friction_proposals(robot, np.array([j]), friction, shared=0)
        explained.append(solution.left[0])
    return MeasuredTorque(
        quantity="current",
        joint_names=robot.joint_names,
        residual=read_only(np.full(robot.n_joints, np.nan)),
        explained=read_only(_by_joint(robot.n_joints, joints, np.array(explained))),
        proposals=tuple(proposals),
    )


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Solution:
    """Values and their 95 % uncertainties, (p,) each, NaN where not determined; and each block's RMS residual."""

    values: Array
    errors: Array
    left: Array


def _solved(blocks: Sequence[tuple[Array, Array]], *, shared: int) -> _Solution:
    """Weighted least squares of blocks (columns, target) that share their first columns and own the others."""
    own = [columns.shape[1] - shared for columns, _ in blocks]
    starts = shared + np.cumsum([0, *own])
    matrices = []
    for (columns, _), start, count in zip(blocks, starts, own, strict=False):
        matrix = np.zeros((len(columns), starts[-1]))
        matrix[:, :shared], matrix[:, start : start + count] = columns[:, :shared], columns[:, shared:]
        matrices.append(matrix)
    spreads = np.ones(len(blocks))
    for _ in range(2):
        stacked = np.vstack([matrix / s for matrix, s in zip(matrices, spreads, strict=True)])
        target = np.concatenate([y / s for (_, y), s in zip(blocks, spreads, strict=True)])
        values, covariance = _least_squares(stacked, target)
        residuals = [y - matrix @ np.nan_to_num(values) for (_, y), matrix in zip(blocks, matrices, strict=True)]
        spreads = np.array([_spread(r) for r in residuals])
    left = np.array([np.sqrt((r**2).mean()) if len(r) else np.nan for r in residuals])
    return _Solution(values=values, errors=_SIGMAS * np.sqrt(covariance), left=left)


def _least_squares(matrix: Array, target: Array) -> tuple[Array, Array]:
    """Values and variances; NaN for what no combination of columns determines."""
    sizes = np.linalg.norm(matrix, axis=0)
    scaled = matrix / np.where(sizes > 0, sizes, 1.0)
    _, singular, vt = np.linalg.svd(scaled, full_matrices=False)
    good = singular > _RANK * singular[0]
    inverse = (vt[good].T / singular[good] ** 2) @ vt[good]
    values = inverse @ (scaled.T @ target)
    # A parameter with a share in what is not determined is not determined.
    lost = (vt[~good] ** 2).sum(axis=0) > _RANK
    lost |= sizes == 0
    unit = np.where(sizes > 0, sizes, 1.0)
    return np.where(lost, np.nan, values / unit), np.where(lost, np.nan, np.diag(inverse) / unit**2)


def _spread(residual: Array) -> float:
    """Standard deviation, larger by the root of how many samples count for one because they are alike."""
    size = float(np.sqrt((residual**2).mean())) if len(residual) else 1.0
    if size == 0 or len(residual) <= _LAGS:
        return max(size, np.finfo(float).tiny)
    alike = 1.0
    for lag in range(1, _LAGS):
        correlation = float((residual[lag:] * residual[:-lag]).mean()) / size**2
        if correlation <= 0:
            break
        alike += 2 * correlation
    return size * float(np.sqrt(alike))


def _payload_columns(bare: Robot, state: list[Array]) -> Array:
    """Torque of a unit mass at the tool and of unit first moments, shape (n, n_joints, 4): exactly linear."""

    def torque(com: Array) -> Array:
        return inverse_dynamics(bare.with_payload(Payload(mass=1.0, com=com)), *state, friction=False)

    mass = torque(np.zeros(3)) - inverse_dynamics(bare, *state, friction=False)
    # The inertia of the point mass is the same on both sides.
    moments = [(torque(_ARM * axis) - torque(-_ARM * axis)) / (2 * _ARM) for axis in np.eye(3)]
    return np.stack([mass, *moments], axis=2)


def _of_point(bare: Robot, state: list[Array], values: Array) -> Array:
    """Torque of the point mass with this mass and these first moments, its inertia included; 0 where there is none."""
    mass = values[0]
    if not np.isfinite(values).all() or mass <= 0:
        return np.zeros_like(state[0])
    loaded = bare.with_payload(Payload(mass=float(mass), com=values[1:4] / mass))
    return inverse_dynamics(loaded, *state, friction=False) - inverse_dynamics(bare, *state, friction=False)


def _steady_direction(motion: Motion, times: Array) -> Array:
    """The direction where it is the same shortly before and after, else 0: at a reversal friction may be either."""
    trajectory = motion.trajectory
    start, end = trajectory.breaks[[0, -1]]
    ways = [trajectory.direction(np.clip(times + shift, start, end)) for shift in (-_NEAR, 0.0, _NEAR)]
    return np.where((ways[0] == ways[1]) & (ways[1] == ways[2]), ways[1], 0.0)


def _friction_columns(v: Array, direction: Array, j: int) -> list[Array]:
    """Viscous, and Coulomb forwards and backwards, of the rows in which a joint moves."""
    way = direction[:, j]
    moving = way != 0
    return [v[moving, j], (way > 0)[moving].astype(float), (way < 0)[moving].astype(float)]


def _payload_proposals(robot: Robot, solution: _Solution) -> list[Proposal]:
    mass, error = float(solution.values[0]), float(solution.errors[0])
    load = robot.payload
    found = [Proposal(name="payload mass", unit="kg", value=mass, uncertainty=error, known=load.mass if load else 0.0)]
    # The place of a mass that may as well be zero is not known.
    sure = mass > error
    for k, axis in enumerate("xyz", start=1):
        centre = float(solution.values[k]) / mass if sure else np.nan
        spread = float(np.hypot(solution.errors[k], centre * error)) / mass if sure else np.nan
        known = float(load.com[k - 1]) if load else 0.0
        found.append(
            Proposal(name=f"payload centre of mass {axis}", unit="m", value=centre, uncertainty=spread, known=known)
        )
    return found


def _friction_proposals(
    robot: Robot, joints: NDArray[np.intp], solution: _Solution, *, shared: int = 4
) -> list[Proposal]:
    found = []
    for place, j in enumerate(joints):
        effort, speed = ("N", "m/s") if robot.is_prismatic[j] else ("N m", "rad/s")
        kinds = (
            ("viscous friction", f"{effort}/({speed})", robot.viscous_friction[j]),
            ("Coulomb friction forwards", effort, robot.coulomb_friction[j, 0]),
            ("Coulomb friction backwards", effort, robot.coulomb_friction[j, 1]),
        )
        for k, (name, unit, known) in enumerate(kinds):
            at = shared + 3 * place + k
            found.append(
                Proposal(name=f"{name} of {robot.joint_names[j]}", unit=unit, value=float(solution.values[at]),
                         uncertainty=float(solution.errors[at]), known=float(known))
            )  # fmt: skip
    return found


def _by_joint(n: int, joints: NDArray[np.intp], values: Array) -> Array:
    """Values of some joints at their places, NaN for the others."""
    full = np.full(n, np.nan)
    full[joints] = values
    return full
