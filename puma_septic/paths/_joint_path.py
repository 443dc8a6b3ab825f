"""JointPath: the joint positions that hold the tool on a path, as functions of the distance covered."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.errors import InputError, NoSolution
from puma_septic.kinematics import (
    chain_to,
    has_closed_form,
    inverse_kinematics,
    singularity_distances,
)
from puma_septic.paths._differential import Follower
from puma_septic.paths._fitting import fit_state
from puma_septic.paths._following import Branches, Guide, beyond_limit, off_path, singular, track
from puma_septic.paths._path import Path
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_array, checked_choice, checked_kind

__all__ = ["Constraint", "JointPath", "follow"]

Constraint = Literal["pose", "position"]
_TURN = 2 * np.pi
_CONDITIONS = {"pose": 6, "position": 3}
# What the tool may be off its pose at a node, in m and rad: a tenth of what is promised between them.
_ON_PATH = 1e-10
# A singular value of the Jacobian below this is no number to divide by: joints would turn 1e8 rad for a metre.
_SINGULAR = 1e-8
# Slack of a position on its limit, in rad or m, as inverse kinematics has it.
_SLACK = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class JointPath:
    """A path of the tool in joint space, without a time.

    Attributes
    ----------
    robot : Robot
    path : Path
    branch : str
        Name of the branch that is held; "" for an arm without a closed form, and for one with joints to spare, whose
        motion is the least-norm one from its start.
    position : Piecewise
        rad (m for prismatic joints) over m.
    """

    robot: Robot
    path: Path
    branch: str
    position: Piecewise

    def singularity(self, s: ArrayLike) -> Array:
        """Measures that are zero at singular postures, at distances s (n,): (n, k), as `singularity_names` calls
        them.
        """
        return singularity_distances(self.robot, self.position(np.atleast_1d(np.asarray(s, dtype=np.float64))))


def follow(
    robot: Robot,
    path: Path,
    *,
    branch: str | None = None,
    start: ArrayLike | None = None,
    constrain: Constraint = "pose",
) -> JointPath:
    r"""Joint positions that hold the tool on a path.

    An arm with a closed form keeps one of its named branches; at Chebyshev points of the path inverse kinematics gives
    q, and the differential kinematics :math:`q', q'', q'''`; the third is interpolated and integrated, on intervals
    that are bisected until all four agree. An arm without a closed form is tracked from its start instead, and then
    treated so. With joints to spare the motion is the least-norm one, :math:`q' = J^+ x'`, from the start posture.
    Continuous joints are unwound: no joint leaps by a turn. Whole turns of the start are chosen so that the path stays
    within the position limits.

    Parameters
    ----------
    robot : Robot
    path : Path
    branch : str, optional
        Such as "right-up-noflip"; else that of `start`, or the first branch that holds the whole path.
    start : array_like, shape (n_joints,), optional
        Posture near which the path begins. An arm without a closed form, or with joints to spare, needs it.
    constrain : {"pose", "position"}
        Whether the orientation counts.

    Returns
    -------
    JointPath

    Raises
    ------
    InputError
        For an unknown branch (the valid ones are listed), or a start that is missing.
    NoSolution
        Where the path meets a singular posture, a position limit or the end of reach: with the place, the measure,
        what would help, and which other branches reach all of it.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> pose = ps.forward_kinematics(robot, [0, 0.5, -2.5, 0, 0.7, 0])
    >>> way = ps.paths.follow(robot, ps.paths.line(pose, pose[:3, 3] + [0, 0.2, 0.1]))
    >>> way.branch
    'right-up-noflip'
    """
    conditions = _CONDITIONS[checked_choice("constrain", constrain, tuple(_CONDITIONS))]
    checked_kind("path", path, Path)
    n = checked_kind("robot", robot, Robot).n_joints
    near = None if start is None else checked_array("start", start, (n,))
    if conditions == 6 and has_closed_form(robot):  # which only arms of six joints and full rank have
        return _on_branch(Follower(robot=robot, conditions=6, rank=6), path, branch, near)
    follower = Follower.of(robot, conditions)
    if branch is not None:
        raise InputError(f"branch = {branch!r}: {robot.name} has no named branches here; give a start posture")
    if near is None:
        raise InputError(
            f"start: {robot.name} has no closed form here, so that a path needs the posture it begins near:"
            " give start, one position per joint"
        )
    first = _start_posture(follower, path, near, constrain)
    position = track(follower, path, first, "")
    if not follower.is_redundant:
        position = _fitted(follower, path, position, None, "")
    return JointPath(robot=robot, path=path, branch="", position=_within_limits(robot, path, position, ""))


def _start_posture(follower: Follower, path: Path, near: Array, constrain: Constraint) -> Array:
    """The posture on the path's start that is nearest to the one given."""
    found = inverse_kinematics(follower.robot, path.frames(0.0), constrain=constrain, q_near=near)
    q = found.q[int(np.argmin(np.abs(found.q - near).max(axis=1)))]
    polished, _ = follower.polished(q[None], path.frames(np.zeros(1)))
    return np.asarray(polished[0])


def _on_branch(follower: Follower, path: Path, branch: str | None, near: Array | None) -> JointPath:
    """The branch that is named, that the start is on, or the first that holds the path."""
    branches = Branches.along(follower.robot, path, near)
    if branch is None and near is not None:
        branch = branches.names[_nearest(branches, near)]
    if branch is not None:
        k = branches.names.index(checked_choice("branch", branch, branches.names))
        try:
            return _held(follower, branches, k, near)
        except NoSolution as refusal:
            others = [name for name in branches.names if name != branch and _holds(branches, name, near)]
            told = (
                f"; branches that reach all of it: {', '.join(others)}" if others else "; no branch reaches all of it"
            )
            raise NoSolution(f"{refusal}{told}", residual=refusal.residual, q=refusal.q) from refusal
    refusals = []
    for k in range(len(branches.names)):
        try:
            return _held(follower, branches, k, near)
        except NoSolution as refusal:
            refusals.append(refusal)
    best = min(refusals, key=lambda refusal: refusal.residual)
    raise NoSolution(f"{best}; no other branch reaches all of it", residual=best.residual, q=best.q)


def _nearest(branches: Branches, near: Array) -> int:
    """The branch whose first posture is nearest to the start."""
    gaps = branches.found.q[0] - near
    gaps = np.abs(gaps - _TURN * np.rint(gaps / _TURN)).max(axis=1)
    return int(np.argmin(np.where(branches.found.exists[0], gaps, np.inf)))


def _holds(branches: Branches, name: str, near: Array | None) -> bool:
    """Whether a branch goes all the way within the limits, by its guide."""
    try:
        return _turns(branches.robot, branches.guide(branches.names.index(name)).q, near) is not None
    except NoSolution:
        return False


def _held(follower: Follower, branches: Branches, k: int, near: Array | None) -> JointPath:
    robot, path, held = follower.robot, branches.path, f", branch {branches.names[k]!r}"
    guide = branches.guide(k)
    turns = _turns(robot, guide.q, near)
    if turns is None:
        raise _beyond(robot, path, guide, held)
    guide = Guide(guide.s, guide.q + turns)
    position = _fitted(follower, path, guide, (branches, k), held)
    position = _within_limits(robot, path, position, held)
    return JointPath(robot=robot, path=path, branch=branches.names[k], position=position)


def _fitted(
    follower: Follower,
    path: Path,
    guide: Guide | Piecewise,
    closed: tuple[Branches, int] | None,
    held: str,
) -> Piecewise:
    """Joint positions by distance, from q and its derivatives at points of the path."""
    ends = path.breaks

    def sample(piece: NDArray[np.int64], x: Array) -> Array:
        s = np.clip(ends[piece] + (x + 1) / 2 * (ends[piece + 1] - ends[piece]), ends[piece], ends[piece + 1])
        rates, near = path.rates(piece, s), guide(s)
        q, exists = (near, np.ones(len(s), dtype=np.bool_)) if closed is None else closed[0].at(closed[1], s, near)
        q, residual = follower.polished(q, rates.poses)
        lost = ~exists | ~(residual <= _ON_PATH)
        if lost.any():
            first = int(np.argmax(lost))
            raise off_path(path, float(s[first]), q[first], float(residual[first]), held)
        slopes, size = follower.rates(q, rates)
        if size.min() < _SINGULAR:
            first = int(np.argmin(size))
            raise singular(path, float(s[first]), q[first], follower, held)
        return np.concatenate([q[None], slopes])

    def refusal(s: float) -> NoSolution:
        return singular(path, s, guide(np.array([s]))[0], follower, held)

    return fit_state(sample, ends, refusal)


def _turns(robot: Robot, reach: Array, near: Array | None) -> Array | None:
    """Whole turns, rad (n_joints,), that bring all rows of `reach` within the limits; None where none do.

    Of several the ones nearest to `near`, else to where the joints are.
    """
    low, high = robot.limits.position.T
    least, greatest = reach.min(axis=0), reach.max(axis=0)
    first = np.nan_to_num(np.ceil((low - _SLACK - least) / _TURN), nan=-np.inf)
    last = np.nan_to_num(np.floor((high + _SLACK - greatest) / _TURN), nan=np.inf)
    wanted = np.zeros(len(low)) if near is None else np.rint((near - reach[0]) / _TURN)
    fixed = robot.is_prismatic | ~np.isin(np.arange(len(low)), chain_to(robot).driving)
    first, last = np.where(fixed & (first <= 0), 0.0, first), np.where(fixed & (last >= 0), 0.0, last)
    if (first > last).any():
        return None
    return np.asarray(_TURN * np.clip(wanted, first, last))


def _within_limits(robot: Robot, path: Path, position: Piecewise, held: str) -> Piecewise:
    """The position with the whole turns that keep all of it, extremes included, within the limits."""
    series = position.coefficients
    rest = np.abs(series[1:]).sum(axis=0)
    bounds = np.stack([(series[0] - rest).min(axis=0), (series[0] + rest).max(axis=0)])
    turns = _turns(robot, bounds, None)
    if turns is not None and not turns.any():  # then the extremes, which lie within these bounds, ask for none either
        return position
    extrema = position.extrema()
    turns = _turns(robot, np.stack([extrema.min, extrema.max]), None)
    if turns is None:
        s = np.union1d(np.linspace(0.0, path.length, 257), np.concatenate([extrema.t_min, extrema.t_max]))
        raise _beyond(robot, path, Guide(s, position(s)), held)
    return position + turns if turns.any() else position


def _beyond(robot: Robot, path: Path, guide: Guide, held: str) -> NoSolution:
    """The limit that the path leaves first."""
    low, high = robot.limits.position.T
    outside = (guide.q < low - _SLACK) | (guide.q > high + _SLACK)
    s, j = (int(x) for x in np.argwhere(outside)[0])
    return beyond_limit(path, robot, j, float(guide.s[s]), guide.q[s], held)
