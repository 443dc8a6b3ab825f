"""Stops by category: power off and brakes (0), and along the path as fast as the torque limits allow (1)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from puma_septic.dynamics import mass_matrix, rigid_torque
from puma_septic.friction import friction_terms
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["Path", "brake", "path_of", "slow_down", "stopping_trajectory"]

_BRAKE_STEP: Final = 5e-4
"""Step of a braked stop, s."""

# An arm that moves longer than this is not held by its brakes.
_LONGEST: Final = 5.0
_SWEEPS: Final = 200
# Changes of velocity below this part of the largest are solved.
_SOLVED: Final = 1e-10


class _Braking(NamedTuple):
    """Samples of several rows, (n,), (n, n_rows, n_joints); durations (n_rows,), infinite where brakes do not hold."""

    t: Array
    q: Array
    v: Array
    durations: Array


def brake(robot: Robot, q: Array, v: Array, torque: Array, reaction_time: float) -> _Braking:
    """Let rows of arms, at q and v (n_rows, n_joints), come to rest under brakes of a torque (n_joints,)."""
    h = _BRAKE_STEP
    shape = (len(q), robot.n_joints)
    samples_q, samples_v, times = [q], [v], [0.0]
    durations = np.full(len(q), np.inf)
    impulse = np.zeros(shape)
    fastest = float(np.abs(v).max(initial=0.0))
    for k in range(1, round(_LONGEST / h) + 1):
        gripping = torque * ((k - 1) * h >= reaction_time * (1 - 1e-12))
        new, impulse = _step(robot, q, v, h, gripping, impulse)
        q, v = q + h / 2 * (v + new), new
        fastest = max(fastest, float(np.abs(v).max()))
        samples_q.append(q)
        samples_v.append(v)
        times.append(k * h)
        # Once at rest under gripping brakes an arm stays so.
        resting = (np.abs(v).max(axis=1) <= 1e-9 * max(fastest, 1e-9)) & bool((gripping == torque).all())
        durations = np.where(resting & np.isinf(durations), k * h, durations)
        if resting.all():
            break
    return _Braking(np.array(times), np.array(samples_q), np.array(samples_v), durations)


def _step(robot: Robot, q: Array, v: Array, h: float, torque: Array, impulse: Array) -> tuple[Array, Array]:
    """Velocities after a step, and the impulses of brakes and dry friction in it."""
    inertia = mass_matrix(robot, q)
    bias = rigid_torque(robot, q, v, np.zeros_like(q))
    mobility = np.linalg.inv(inertia + h * np.diag(robot.viscous_friction))
    free = np.einsum("rij,rj->ri", mobility, np.einsum("rij,rj->ri", inertia, v) - h * bias)
    high, low = h * (torque + robot.coulomb_friction[:, 0]), h * (-torque + robot.coulomb_friction[:, 1])
    impulse = np.clip(impulse, low, high)
    new = free - np.einsum("rij,rj->ri", mobility, impulse)
    scale = max(float(np.abs(free).max()), 1e-12)
    for _ in range(_SWEEPS):
        change = 0.0
        for j in range(q.shape[1]):
            own = mobility[:, j, j]
            wanted = np.clip(impulse[:, j] + new[:, j] / own, low[j], high[j])
            step = wanted - impulse[:, j]
            impulse[:, j] = wanted
            new = new - mobility[:, :, j] * step[:, None]
            change = max(change, float(np.abs(step * own).max()))
        if change <= _SOLVED * scale:
            break
    # A joint whose impulse is inside its bounds is held, to the rounding of the solver.
    held = (impulse > low) & (impulse < high) & (np.abs(new) <= 10 * _SOLVED * scale)
    return np.where(held, 0.0, new), impulse


_DROPS: Final = 128
"""Into how many drops of the speed a stop is divided."""

Path = Callable[[Array], tuple[Array, Array, Array]]
"""Position, and first and second derivative by s, of rows at their own s (n_rows,): (n_rows, n_joints) each."""

# No stop is taken to last less than this, s: where the arm hardly moves, any deceleration is allowed.
_LEAST: Final = 1e-4
# An inertia along the path below this part of the largest is rounding.
_NO_INERTIA: Final = 1e-12


class _Slowing(NamedTuple):
    """Stops of several rows: s at the ends of the drops (_DROPS + 1, n_rows), how long each takes (_DROPS, n_rows).

    ``is_possible`` (n_rows,) says whether the limits allow it all the way.
    """

    s: Array
    lengths: Array
    is_possible: NDArray[np.bool_]


def path_of(trajectory: Trajectory) -> Path:
    """A planned motion as a path, its time since its start as s; it stays where it ends."""
    n, duration = trajectory.n_joints, trajectory.duration

    def at(s: Array) -> tuple[Array, Array, Array]:
        values = trajectory.state.at_offsets(np.clip(s, 0.0, duration))
        return values[:, :n], values[:, n : 2 * n], values[:, 2 * n : 3 * n]

    return at


def slow_down(robot: Robot, path: Path, start: Array, limits: Array) -> _Slowing:
    """March all rows, which start at s (n_rows,), from r = 1 to rest."""
    levels = np.linspace(1.0, 0.0, _DROPS + 1)
    s, lengths = np.empty((_DROPS + 1, len(start))), np.empty((_DROPS, len(start)))
    s[0] = start
    possible = np.ones(len(start), dtype=bool)
    bound, fits = _hardest(robot, path, s[0], 1.0, limits)
    for k in range(_DROPS):
        drop, mean = levels[k] - levels[k + 1], (levels[k] + levels[k + 1]) / 2
        rate = bound
        fits_ahead = fits
        for _ in range(2):
            step = drop / -np.minimum(rate, -_LEAST)
            ahead, fits_ahead = _hardest(robot, path, s[k] + mean * step, float(levels[k + 1]), limits)
            rate = np.maximum(bound, ahead)
        possible &= (rate < 0) & fits & fits_ahead
        lengths[k] = drop / -np.minimum(rate, -_LEAST)
        s[k + 1] = s[k] + mean * lengths[k]
        bound, fits = ahead, fits_ahead
    return _Slowing(s, lengths, possible)


def _hardest(robot: Robot, path: Path, s: Array, r: float, limits: Array) -> tuple[Array, NDArray[np.bool_]]:
    """The most negative ``dr/dt`` that all torque limits allow, and whether any value of it keeps them, (n_rows,)."""
    q, first, second = path(s)
    v = first * r
    rest = np.zeros_like(q)
    stacked = np.concatenate([q, q, q]), np.concatenate([v, rest, rest]), np.concatenate([second * r**2, first, rest])
    moving, weighed, weight = np.split(rigid_torque(robot, *stacked), 3)
    inertia = weighed - weight
    terms = friction_terms(robot.friction, v, np.sign(first))
    load = moving + terms["viscous"] + terms["coulomb"]
    is_moved = np.abs(inertia) > _NO_INERTIA * np.abs(inertia).max(axis=1, keepdims=True, initial=0.0)
    divisor = np.where(is_moved, inertia, 1.0)
    ends = np.stack([(-limits - load) / divisor, (limits - load) / divisor])
    low = np.where(is_moved, ends.min(axis=0), -np.inf).max(axis=1)
    high = np.where(is_moved, ends.max(axis=0), np.inf).min(axis=1)
    fits = (low <= high) & (is_moved | (np.abs(load) <= limits)).all(axis=1)
    return np.maximum(low, -1 / _LEAST), fits


def stopping_trajectory(trajectory: Trajectory, slowing: _Slowing, row: int, start: float) -> Trajectory:
    """The motion from the beginning of the stop to rest, on its own clock from 0: ``q(s(t))``."""
    lengths, s = slowing.lengths[:, row], slowing.s[:, row]
    levels = np.linspace(1.0, 0.0, _DROPS + 1)
    times = np.concatenate([[0.0], np.cumsum(lengths)])
    powers = np.stack([s[:-1], levels[:-1] * lengths, np.diff(levels) * lengths / 2])[..., None]
    clock = Piecewise.from_power(times, powers)
    path = trajectory.position
    inside = [value for value in path.offsets.tolist() if s[0] < value < s[-1]]
    clock = clock.split(np.concatenate([(clock + -value).roots()[0] for value in inside]) if inside else [])
    position = clock.mapped(lambda at: path.at_offsets(np.clip(at[:, 0], 0.0, path.duration)), tolerance=1e-14)
    left, right = position.ends()
    return Trajectory(
        position=position,
        points=np.array([left[0], right[-1]]),
        times=position.breaks[[0, -1]],
        profile=f"stop of {trajectory.profile} at {start:.4g} s",
        joint_names=trajectory.joint_names,
        rest_before=False,
    )
