"""Assessments of many motions at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.assessment import Assessment, assess
from puma_septic.batch._metrics import Metrics, TorqueSpan, acceleration_steps, metrics_of, torque_span
from puma_septic.batch._stack import stacked
from puma_septic.document import card, one_line
from puma_septic.errors import InputError
from puma_septic.limit_check import AT_LIMIT, most_used_first
from puma_septic.quantities import QUANTITIES
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_kind, checked_list

__all__ = [
    "BLOCK",
    "MAGNITUDES",
    "Certificate",
    "ManyAssessments",
    "are_plain",
    "assess_many",
    "check_trajectories",
    "is_linear",
    "torque_spans",
]

Certificate = Literal["proved", "resolved", "undecided"]
# Motions that are computed together: what they need stays in the cache of a processor.
BLOCK: Final = 512
MAGNITUDES: Final = ("velocity", "acceleration", "jerk", "effort")
_ROWS: Final = ("velocity", "acceleration", "jerk", "torque")
# Points below this, rad (m), raise no doubt about their unit.
_NO_DOUBT: Final = 12.0
# Torque is resolved to 1e-11; a bound has to stay below a limit by this part to prove a verdict.
_RESOLVED: Final = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ManyAssessments:
    """What many motions of one robot demand, held against its limits; made by `assess_many`.

    Attributes
    ----------
    robot : Robot
    duration : ndarray, shape (n,)
        s.
    peak_velocity, peak_acceleration, peak_jerk, peak_torque : ndarray, shape (n, n_joints)
        As of `Assessment`, and so are those below.
    peak_velocity_time, peak_acceleration_time, peak_jerk_time, peak_torque_time : ndarray, shape (n, n_joints)
    rms_velocity, rms_acceleration, rms_jerk, rms_torque : ndarray, shape (n, n_joints)
    position_min, position_max : ndarray, shape (n, n_joints)
    utilisation : ndarray, shape (n,)
        The largest share of a known limit, positions apart; NaN where none is known.
    governing_joint : ndarray of int, shape (n,)
        Of that limit.
    governing_quantity : ndarray of str, shape (n,)
    is_feasible : ndarray of bool, shape (n,)
        Whether no known limit is violated and nothing is undecided.
    certificate : ndarray of str, shape (n,)
        "proved": the verdict follows from values at points and a bound between them (Ehlich and Zeller 1964), with
        room for what the series leaves out; "resolved": it rests on the search for extrema; "undecided": the motion
        itself is in doubt.
    n_alone : int
        How many were assessed one by one, because they rest, creep, step, or swing wildly.
    """

    robot: Robot
    duration: Array
    peak_velocity: Array
    peak_acceleration: Array
    peak_jerk: Array
    peak_torque: Array
    peak_velocity_time: Array
    peak_acceleration_time: Array
    peak_jerk_time: Array
    peak_torque_time: Array
    rms_velocity: Array
    rms_acceleration: Array
    rms_jerk: Array
    rms_torque: Array
    position_min: Array
    position_max: Array
    utilisation: Array
    governing_joint: NDArray[np.int64]
    governing_quantity: NDArray[np.str_]
    is_feasible: NDArray[np.bool_]
    certificate: NDArray[np.str_]
    n_alone: int

    def __len__(self) -> int:
        return len(self.duration)

    def __repr__(self) -> str:
        return one_line("ManyAssessments", self._facts())

    def _repr_html_(self) -> str:
        return card("ManyAssessments", self._facts())

    def _facts(self) -> dict[str, object]:
        return {"robot": self.robot.name, "motions": len(self), "feasible": int(np.sum(self.is_feasible))}


def assess_many(robot: Robot, trajectories: Iterable[Trajectory]) -> ManyAssessments:
    """Assess many motions of one robot: the numbers of `assess` for each, an array for all.

    One fit of the torque over the intervals of all motions, one call of the dynamics for each degree, one search for
    all peaks. What does not fit this (rest during the motion, steps, friction beyond viscous and Coulomb, a log) is
    assessed alone, with the same answer.

    Parameters
    ----------
    robot : Robot
    trajectories : iterable of Trajectory
        Each with as many joints as the robot has.

    Returns
    -------
    ManyAssessments

    Raises
    ------
    InputError
        For no trajectory at all, or one that is not the robot's, with its number.

    Examples
    --------
    >>> import puma_septic as ps
    >>> moves = [ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, t]) for t in (0.5, 1.0, 2.0)]
    >>> many = ps.assess_many(ps.load_robot(), moves)
    >>> many.is_feasible.tolist(), many.governing_quantity.tolist()
    ([False, True, True], ['velocity', 'effort', 'effort'])
    """
    given = checked_list("trajectories", trajectories)
    check_trajectories(robot, given)
    blocks = [_block(robot, given[k : k + BLOCK]) for k in range(0, len(given), BLOCK)]
    joined = {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}
    return ManyAssessments(robot=robot, n_alone=int(joined.pop("alone").sum()), **_frozen(joined))


def torque_spans(robot: Robot, trajectories: Sequence[Trajectory]) -> list[tuple[Array, Array] | None]:
    """(Least and greatest torque (2, n_joints), its root mean square) of each motion; None where it goes alone.

    Parameters
    ----------
    robot : Robot
    trajectories : sequence of Trajectory
        Of this robot's joints.

    Returns
    -------
    list
    """
    found: list[tuple[Array, Array] | None] = [None] * len(trajectories)
    some = np.flatnonzero(are_plain(trajectories) & is_linear(robot)).tolist() if trajectories else []
    if some:
        stack = stacked([trajectories[k] for k in some])
        velocity, acceleration = (np.abs(stack.state[:, :, k]).sum(axis=0) for k in (1, 2))
        whole = np.zeros((2, len(some), robot.n_joints))
        np.maximum.at(whole[0], stack.owner, velocity)
        np.maximum.at(whole[1], stack.owner, acceleration)
        span: TorqueSpan = torque_span(robot, stack, len(some))
        odd = span.odd | acceleration_steps(stack, len(some), whole[0], whole[1])[0]
        for i in np.flatnonzero(~odd).tolist():
            found[some[i]] = (span.ends[:, i], span.rms[i])
    return found


def _frozen(arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    for array in arrays.values():
        array.setflags(write=False)
    return dict(arrays)


def check_trajectories(robot: Robot, trajectories: Sequence[Trajectory]) -> None:
    checked_kind("robot", robot, Robot)
    if not trajectories:
        raise InputError("trajectories: at least one is needed")
    for k, one in enumerate(trajectories):
        if not isinstance(one, Trajectory):
            raise InputError(f"trajectories[{k}]: expected a Trajectory, got {one!r}")
        if one.n_joints != robot.n_joints or (one.joint_names and one.joint_names != robot.joint_names):
            raise InputError(
                f"trajectories[{k}] has the joints {', '.join(one.joint_names) or one.n_joints}, robot {robot.name!r}"
                f" has {', '.join(robot.joint_names)}"
            )


def _block(robot: Robot, trajectories: Sequence[Trajectory]) -> dict[str, NDArray[Any]]:
    plain = are_plain(trajectories) & is_linear(robot)
    columns = _empty(robot.n_joints, len(trajectories))
    some = np.flatnonzero(plain)
    if len(some):
        chosen = [trajectories[k] for k in some.tolist()]
        metrics = metrics_of(robot, stacked(chosen), len(chosen))
        plain[some[metrics.odd]] = False
        _store(columns, some, metrics, robot, np.array([one.breaks[0] for one in chosen]))
        _judge(columns, some, metrics, robot)
    for k in np.flatnonzero(~plain).tolist():
        _alone(columns, k, assess(robot, trajectories[k]))
    columns["alone"] = ~plain
    columns["duration"] = np.array([one.duration for one in trajectories])
    return columns


def is_linear(robot: Robot) -> bool:
    """Whether friction is viscous plus constant, gears lose nothing, and no derivative of the torque has a limit."""
    derivatives = any(QUANTITIES[name].is_torque_derivative for name in robot.limits.quantities)
    return not (robot.has_losses or derivatives or any(not law.is_linear for law in robot.friction))


def are_plain(trajectories: Sequence[Trajectory]) -> NDArray[np.bool_]:
    """Which are planned motions, as no log or excerpt is."""
    whole = np.array([one.rest_before and one.rest_after and not one.doubts for one in trajectories])
    exact = np.array([one.resolution for one in trajectories]).max(axis=1) == 0
    first = np.cumsum([0, *(len(one.points) for one in trajectories[:-1])])
    largest = np.abs(np.concatenate([one.points for one in trajectories])).max(axis=1)
    return np.asarray(whole & exact & (np.maximum.reduceat(largest, first) < _NO_DOUBT))


def _empty(m: int, n: int) -> dict[str, NDArray[Any]]:
    names = [f"{kind}_{row}{end}" for row in _ROWS for kind, end in (("peak", ""), ("peak", "_time"), ("rms", ""))]
    columns: dict[str, NDArray[Any]] = {
        name: np.full((n, m), np.nan) for name in (*names, "position_min", "position_max")
    }
    columns["utilisation"] = np.full(n, np.nan)
    columns["governing_joint"] = np.zeros(n, dtype=np.int64)
    columns["governing_quantity"] = np.full(n, "", dtype=f"<U{max(map(len, QUANTITIES))}")
    columns["is_feasible"] = np.zeros(n, dtype=np.bool_)
    columns["certificate"] = np.full(n, "resolved", dtype="<U9")
    return columns


def _store(
    columns: dict[str, NDArray[Any]], some: NDArray[np.int64], metrics: Metrics, robot: Robot, start: Array
) -> None:
    for name, row in zip(MAGNITUDES, _ROWS, strict=True):
        known = robot.knows_torque if name == "effort" else np.True_
        columns[f"peak_{row}"][some] = np.where(known, metrics.peaks[name], np.nan)
        columns[f"peak_{row}_time"][some] = np.where(known, metrics.times[name] + start[:, None], np.nan)
        columns[f"rms_{row}"][some] = np.where(known, metrics.rms[name], np.nan)
    columns["position_min"][some], columns["position_max"][some] = metrics.reach


def _judge(columns: dict[str, NDArray[Any]], some: NDArray[np.int64], metrics: Metrics, robot: Robot) -> None:
    """Verdicts, what governs, and how sure they are."""
    limits, m = robot.limits, robot.n_joints
    known = {name: getattr(limits, name) for name in MAGNITUDES}
    known["effort"] = np.where(robot.knows_torque, known["effort"], np.nan)
    used = np.concatenate([metrics.peaks[name] / known[name] for name in MAGNITUDES], axis=1)
    share = np.where(np.isnan(used), -1.0, used)
    best = share.argmax(axis=1)
    largest = share[np.arange(len(share)), best]
    lower, upper = limits.position.T
    excess = np.fmax(lower - metrics.reach[0], metrics.reach[1] - upper)
    inside = ~(excess > AT_LIMIT).any(axis=1)
    columns["utilisation"][some] = np.where(largest < 0, np.nan, largest)
    columns["governing_joint"][some], columns["governing_quantity"][some] = best % m, np.array(MAGNITUDES)[best // m]
    columns["is_feasible"][some] = inside & (largest <= 1 + AT_LIMIT)
    bound = np.concatenate([metrics.bounds[name] / known[name] for name in MAGNITUDES], axis=1)
    swing = metrics.bounds["position"]
    within = ~((swing[0] < lower) | (swing[1] > upper)).any(axis=1) & ~(bound > 1 - _RESOLVED).any(axis=1)
    # A value that is taken somewhere proves a violation by itself.
    beyond = (largest > 1 + _RESOLVED) | (excess > _RESOLVED).any(axis=1)
    columns["certificate"][some] = np.where(within | beyond, "proved", "resolved")


def _alone(columns: dict[str, NDArray[Any]], k: int, one: Assessment) -> None:
    for row in _ROWS:
        columns[f"peak_{row}"][k] = getattr(one, f"peak_{row}")
        columns[f"peak_{row}_time"][k] = getattr(one, f"peak_{row}_time")
        columns[f"rms_{row}"][k] = getattr(one, f"rms_{row}")
    columns["position_min"][k], columns["position_max"][k] = one.position.min, one.position.max
    moved = most_used_first(check for check in one.checks if check.quantity != "position")
    if moved:
        columns["utilisation"][k] = moved[0].utilisation
        columns["governing_joint"][k] = one.motion.robot.joint_index(moved[0].joint)
        columns["governing_quantity"][k] = moved[0].quantity
    columns["is_feasible"][k] = one.is_feasible
    columns["certificate"][k] = "undecided" if one.undecided else "resolved"
