"""What the tolerances of a robot's data leave open of its torque, and which datum decides a verdict."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
import pinocchio as pin

from puma_septic.assessment import assess
from puma_septic.dynamics import check_inertia, check_plain_friction, check_uncoupled, rigid_torque
from puma_septic.errors import InputError
from puma_septic.limit_check import AT_LIMIT
from puma_septic.limits._demands import values_beside
from puma_septic.motion import Motion
from puma_septic.piecewise import Piecewise
from puma_septic.piecewise.combinations import Combinations
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_kind, checked_number, checked_rng, checked_whole, read_only

__all__ = ["TorqueUncertainty", "torque_uncertainty"]

# Of a body, as Pinocchio's regressor has them, about the joint's origin; see `pinocchio.Inertia.toDynamicParameters`.
_INERTIAL: Final = ("m", "m c_x", "m c_y", "m c_z", "I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz")
_DIAGONAL: Final = {(0, 0): 4, (0, 1): 5, (1, 1): 6, (0, 2): 7, (1, 2): 8, (2, 2): 9}
_MOST_SAMPLES: Final = 100_000  # 5 s, and 80 MB
_LEVELS: Final = (0.5, 0.95, 0.99)
_MOST_ROUNDS: Final = 30
_STARTS: Final = 8


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class TorqueUncertainty:
    """The peak torque of a motion by a robot whose data have tolerances; made by `torque_uncertainty`.

    Attributes
    ----------
    motion : Motion
    parameters : tuple of str
        "joint2 m", "joint2 m c_x", "joint2 rotor", "joint2 viscous" ...
    nominal : ndarray, shape (n_joints,)
        Peaks with the data as they are, N m (N); infinite, as the others, where a velocity steps.
    greatest, least : ndarray, shape (n_joints,)
        The greatest peak with every parameter within its tolerance, exact and attained; and a bound of the least one:
        at the instant of the nominal peak no parameters make the torque smaller.
    time : ndarray, shape (n_joints,)
        When the greatest is reached, s.
    levels : tuple of float
    quantiles : ndarray, shape (levels, n_joints)
        Of the peak, by Monte Carlo, each tolerance uniform and independent.
    shares : ndarray, shape (n_joints, n_parameters)
        What each parameter adds to the torque at `time`, N m (N).
    """

    motion: Motion
    parameters: tuple[str, ...]
    nominal: Array
    greatest: Array
    least: Array
    time: Array
    levels: tuple[float, ...]
    quantiles: Array
    shares: Array

    @property
    def verdicts(self) -> tuple[str, ...]:
        """Of each joint: "feasible" or "infeasible" whatever the data within their tolerances, "open", "unknown"."""
        words = []
        for low, high, limit in zip(self.least, self.greatest, self.motion.robot.limits.effort, strict=True):
            unknown, most = bool(np.isnan(limit)) and np.isfinite(low), limit * (1 + AT_LIMIT)
            words.append(
                "unknown" if unknown else "feasible" if high <= most else "open" if low <= most else "infeasible"
            )
        return tuple(words)

    @property
    def deciding(self) -> tuple[str, ...]:
        """The data that decide the open verdicts: of each such joint those that, the largest first, span its margin."""
        names: dict[str, None] = {}
        for j, verdict in enumerate(self.verdicts):
            if verdict != "open":
                continue
            order = np.argsort(-self.shares[j])
            margin = abs(float(self.motion.robot.limits.effort[j] - self.nominal[j]))
            count = int(np.searchsorted(np.cumsum(self.shares[j][order]), margin)) + 1
            names |= dict.fromkeys(self.parameters[k] for k in order[:count] if self.shares[j][k] > 0)
        return tuple(names)


def torque_uncertainty(
    motion: Motion,
    *,
    mass: float = 0.0,
    com: float = 0.0,
    inertia: float = 0.0,
    rotor: float = 0.0,
    friction: float = 0.0,
    samples: int = 1000,
    rng: np.random.Generator | None = None,
) -> TorqueUncertainty:
    """The range of the peak torque within tolerances of a robot's data.

    The torque is linear in each body's mass, mass times centre of mass, inertia about its joint, in the rotors' inertia
    and in viscous and Coulomb friction: ``tau_j(t) = sum_p Y_jp(t) pi_p``. Within a box of half widths d the largest at
    an instant is ``|tau_j| + sum_p |Y_jp| d_p``, and the greatest peak is that of one corner of the box. All follow
    from one pass of the regressor.

    Parameters
    ----------
    motion : Motion
    mass : float
        Relative tolerance of each mass, 0.02 for 2 %.
    com : float
        Tolerance of each coordinate of a centre of mass, m: of m c, ``m com``.
    inertia : float
        Relative tolerance of each inertia about its joint; products of inertia by the diagonal of both axes.
    rotor, friction : float
        Relative tolerances of the rotors' inertia, and of viscous and Coulomb friction.
    samples : int
        Of the Monte Carlo, at most 100,000.
    rng : numpy.random.Generator, optional
        By default one with the seed 0.

    Returns
    -------
    TorqueUncertainty

    Raises
    ------
    InputError
        For a negative tolerance, none at all, joints that mimic others, or friction that is not viscous plus Coulomb.
    ModelError
        If the robot description has no inertia for a moving part.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 1.0])
    >>> doubt = ps.torque_uncertainty(ps.compute_motion(ps.load_robot(), move), mass=0.05, friction=0.3)
    >>> doubt.verdicts[1], bool(doubt.greatest[1] > doubt.nominal[1])
    ('feasible', True)
    """
    robot = checked_kind("motion", motion, Motion).robot
    check_inertia(robot)
    check_uncoupled(robot, "the regressor")
    check_plain_friction(robot, "the regressor")
    given = {"mass": mass, "com": com, "inertia": inertia, "rotor": rotor, "friction": friction}
    sizes = {name: checked_number(name, value, at_least=0.0) for name, value in given.items()}
    if not any(sizes.values()):
        raise InputError("torque_uncertainty: give at least one tolerance above 0")
    samples = checked_whole("samples", samples, at_least=1, at_most=_MOST_SAMPLES)
    names, nominal, width = _parameters(robot, sizes)
    parts = _parts(motion)
    whole = Combinations(parts=parts)
    peak = np.array(whole.peaks(nominal[None]))[:, 0]
    greatest, time, shares = _greatest(parts, whole, nominal, width)
    draws = checked_rng(rng)
    drawn = nominal + draws.uniform(-1, 1, (samples, len(width))) * width
    quantiles = np.quantile(whole.peaks(drawn)[0], _LEVELS, axis=0)
    at_peak = np.array([_row(parts, j, t, nominal) for j, t in enumerate(peak[1].tolist())])
    least = np.maximum(np.abs(at_peak @ nominal) - np.abs(at_peak) @ width, 0.0)
    # A step of velocity takes an infinite torque whatever the data: the parts are what lies beside it.
    assessed = assess(motion)
    unbounded = np.isinf(assessed.peak_torque)
    time = np.where(unbounded, assessed.peak_torque_time, time)
    peak[0], greatest, least, quantiles = (
        np.where(unbounded, np.inf, size) for size in (peak[0], greatest, least, quantiles)
    )
    return TorqueUncertainty(
        motion=motion,
        parameters=names,
        nominal=read_only(peak[0]),
        greatest=read_only(greatest),
        least=read_only(least),
        time=read_only(time),
        levels=_LEVELS,
        quantiles=read_only(quantiles),
        shares=read_only(shares),
    )


def _parameters(robot: Robot, sizes: dict[str, float]) -> tuple[tuple[str, ...], Array, Array]:
    """Names, values and half widths of the box; the weight of what is not varied, a wrench, last."""
    names, values, widths = [], [], []
    for k in range(1, robot.model.njoints):
        body = robot.model.inertias[k]
        own = np.asarray(body.toDynamicParameters())
        spread = np.zeros(10)
        spread[0] = sizes["mass"] * own[0]
        spread[1:4] = sizes["com"] * own[0]
        diagonal = np.abs(own[[4, 6, 9]])
        for (row, column), place in _DIAGONAL.items():
            spread[place] = sizes["inertia"] * np.sqrt(diagonal[row] * diagonal[column])
        names += [f"{robot.model.names[k]} {name}" for name in _INERTIAL]
        values.append(own)
        widths.append(spread)
    for name in ("rotor", "viscous", "coulomb"):
        names += [f"{joint} {name}" for joint in robot.joint_names]
        values.append(np.ones(robot.n_joints))
        widths.append(np.full(robot.n_joints, sizes["rotor" if name == "rotor" else "friction"]))
    return (*names, "wrench"), np.append(np.concatenate(values), 1.0), np.append(np.concatenate(widths), 0.0)


def _parts(motion: Motion) -> list[Piecewise]:
    """The torque of 1 of each parameter, of all joints; of rotor and friction, of all that there is of it."""
    robot, trajectory, n = motion.robot, motion.trajectory, motion.robot.n_joints
    fitted = trajectory.state.mapped(_regressor(robot))
    count = 10 * (robot.model.njoints - 1)
    parts = [fitted[k * n : (k + 1) * n] for k in range(count)]
    unit = np.eye(n)
    alone = [
        *(trajectory.derivative(2) * (robot.armature * row) for row in unit),
        *(trajectory.derivative(1) * (robot.viscous_friction * row) for row in unit),
        *(motion.coulomb * row for row in unit),
        fitted[count * n :],
    ]
    together = motion.coulomb.aligned_with(fitted)
    return [part.aligned_with(together) for part in (*parts, *alone)]


def _regressor(robot: Robot) -> Callable[[Array], Array]:
    """Columns of all bodies' parameters, then the wrench's torque, side by side (k, (10 bodies + 1) n_joints)."""
    n, model, data = robot.n_joints, robot.model, robot.model.createData()

    def columns(state: Array) -> Array:
        q, v, a = (state[:, k * n : (k + 1) * n] for k in range(3))
        full = zip(robot.configurations(q), robot.tangents(v), robot.tangents(a), strict=True)
        # Pinocchio's bindings hand out the regressor of an arm with one joint as a vector.
        matrices = np.array([pin.computeJointTorqueRegressor(model, data, *one).reshape(model.nv, -1) for one in full])
        by_joint = robot.from_tangents(np.swapaxes(matrices, 1, 2).reshape(-1, model.nv))
        rest = np.zeros_like(q)
        wrench = rigid_torque(robot, q, rest, rest) - rigid_torque(robot.with_wrench(None), q, rest, rest)
        return np.concatenate([by_joint.reshape(len(state), -1), wrench], axis=1)

    return columns


def _greatest(
    parts: Sequence[Piecewise], whole: Combinations, nominal: Array, width: Array
) -> tuple[Array, Array, Array]:
    """The greatest peak of each joint over the box, its instant, and what each parameter adds there.

    From the instants at which the bound is highest: the corner of the box that attains it there, then the instant of
    that corner's own peak, until both agree; no step lowers the value.
    """
    n = parts[0].n_components
    times = _instants(parts[0])
    values = np.stack([part(times) for part in parts], axis=2)  # (times, joints, parameters)
    high = np.abs(values @ nominal) + np.abs(values) @ width
    best, when, shares = np.zeros(n), np.zeros(n), np.zeros((n, len(width)))
    for j in range(n):
        starts = np.argsort(-high[:, j])[:_STARTS]
        for t in times[starts].tolist():
            size, instant, added = _climbed(parts, whole, nominal, width, j, t)
            if size > best[j]:
                best[j], when[j], shares[j] = size, instant, added
    return best, when, shares


def _climbed(
    parts: Sequence[Piecewise], whole: Combinations, nominal: Array, width: Array, j: int, t: float
) -> tuple[float, float, Array]:
    size, row = 0.0, _row(parts, j, t, nominal)
    for _ in range(_MOST_ROUNDS):
        corner = nominal + np.where(row >= 0, 1.0, -1.0) * width * np.sign(row @ nominal or 1.0)
        peaks, times = whole.peaks(corner[None])
        if not peaks[0, j] > size * (1 + 1e-13):
            break
        size, t = float(peaks[0, j]), float(times[0, j])
        row = _row(parts, j, t, corner)
    return size, t, np.abs(row) * width


def _row(parts: Sequence[Piecewise], j: int, t: float, weights: Array) -> Array:
    """What 1 of each parameter adds to the torque of joint j at an instant, where it steps on the side of the peak."""
    sides = np.stack([values_beside(part, np.array([t]))[:, j] for part in parts], axis=1)
    return np.asarray(sides[np.abs(sides @ weights).argmax()])


def _instants(function: Piecewise) -> Array:
    """Points all over the intervals, their ends apart."""
    x = np.sin(np.pi * (np.arange(64) + 0.5 - 32) / 64)
    left, right = function.breaks[:-1, None], function.breaks[1:, None]
    return np.asarray(((left * (1 - x) + right * (1 + x)) / 2).ravel())
