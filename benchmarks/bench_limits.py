"""How fast, how heavy, which of many: exact answers against loops over inverse dynamics, as ratios in one run."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from importlib.util import find_spec
from time import process_time

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import puma_septic as ps

Array = NDArray[np.float64]
RATE = 1000.0
COM = np.array([0.0, 0.0, 0.1])
SEED = 13
# Small enough for minutes; the numbers by their count.
SEPTICS, SINGLE, LOOPED = 2000, 40, 10
ROUNDS = 3
_REST = 1e-9


def _least(work: Callable[[], object], rounds: int = ROUNDS) -> float:
    """The least processor time, s: on a shared machine the clock on the wall counts what others do."""
    times = []
    for _ in range(rounds):
        start = process_time()
        work()
        times.append(process_time() - start)
    return min(times)


def _looped(robot: ps.Robot, q: Array, v: Array, a: Array) -> Array:
    """pin.rnea in a loop, with rotors and friction, (n, n_joints)."""
    model, data = robot.model, robot.model.createData()
    torque = np.array([pin.rnea(model, data, *state).copy() for state in zip(q, v, a, strict=True)])
    # A sampled velocity of 1e-16 rad/s has no sign, and would bring in the whole of Coulomb friction.
    way = np.where(np.abs(v) > _REST, np.sign(v), 0.0)
    coulomb = np.maximum(way, 0) * robot.coulomb_friction[:, 0] + np.maximum(-way, 0) * robot.coulomb_friction[:, 1]
    return torque + robot.viscous_friction * v + coulomb


def _samples(move: ps.Trajectory, factor: float = 1.0) -> tuple[Array, Array, Array]:
    # Both ends are rest, where friction neither helps nor hinders: no part of the motion.
    t = np.arange(1 / RATE, move.duration * factor - 0.5 / RATE, 1 / RATE)
    inside = np.minimum(t / factor, move.duration) + move.breaks[0]
    return tuple(move(inside, order) / factor**order for order in range(3))  # type: ignore[return-value]


def _peak(robot: ps.Robot, move: ps.Trajectory, factor: float = 1.0) -> Array:
    return np.abs(_looped(robot, *_samples(move, factor))).max(axis=0)


def _bisected(is_kept: Callable[[float], bool], low: float, high: float) -> float:
    """Between one value that is kept (high) and one that is not, to 1e-9, as bisection on samples would."""
    while abs(high - low) > 1e-9 * abs(high):
        middle = (low + high) / 2
        low, high = (low, middle) if is_kept(middle) else (middle, high)
    return high


def run() -> list[tuple[str, ...]]:
    """All rows."""
    head = ("limits", "puma_septic", "other", "times faster", "agreement")
    return [head, *_many(), *_fast_and_heavy(), *_map(), *_study()]


def _many() -> list[tuple[str, ...]]:
    rng, robot = np.random.default_rng(SEED), ps.load_robot()
    moves = [ps.septic(points, [0.0, 3.0, 6.0, 9.0]) for points in rng.uniform(-1.2, 1.2, (SEPTICS, 4, 6))]
    many = ps.assess_many(robot, moves)
    ours = _least(lambda: ps.assess_many(robot, moves)) / SEPTICS

    def fresh() -> list[ps.Trajectory]:
        return [ps.septic(move.points, move.times) for move in moves[:SINGLE]]

    alone = [ps.assess(robot, move) for move in fresh()]
    singles = [fresh() for _ in range(ROUNDS)]
    single = _least(lambda: [ps.assess(robot, move) for move in singles.pop()]) / SINGLE
    error = max(np.abs(many.peak_torque[k] / one.peak_torque - 1).max() for k, one in enumerate(alone))
    looped = _least(lambda: [_peak(robot, move) for move in moves[:LOOPED]]) / LOOPED
    peaks = np.array([_peak(robot, move) for move in moves[:LOOPED]])
    low = np.abs(peaks / many.peak_torque[:LOOPED] - 1).max()
    rows = [
        _row(f"{SEPTICS} septics, single calls", ours, single, f"{error:.0e}"),
        _row(f"{SEPTICS} septics, pin.rnea loop at 1 kHz", ours, looped, f"{low:.0e}"),
    ]
    if find_spec("roboticstoolbox") is not None:
        rows.append(_toolbox(moves, many, ours))
    return [*rows, *_verdicts(robot, many)]


def _verdicts(robot: ps.Robot, many: ps.ManyAssessments) -> list[tuple[str, ...]]:
    """Verdicts alone, of motions of which few and of which nearly all are feasible."""
    proved = float((many.certificate == "proved").mean())
    rows = [("of them proved by bounds", f"{100 * proved:.1f} %", "", "", "")]
    for reach in (0.4, 0.7, 1.2):
        points = np.random.default_rng(SEED).uniform(-reach, reach, (SEPTICS, 4, robot.n_joints))
        moves = [ps.septic(some, [0.0, 3.0, 6.0, 9.0]) for some in points]
        verdicts, whole = ps.judge_many(robot, moves), ps.assess_many(robot, moves)
        wrong = int((verdicts.is_feasible != whole.is_feasible).sum())
        name = f"verdicts alone, {100 * whole.is_feasible.mean():.0f} % feasible, of assess_many"
        alone = _least(lambda moves=moves: ps.judge_many(robot, moves)) / SEPTICS  # type: ignore[misc]
        other = _least(lambda moves=moves: ps.assess_many(robot, moves)) / SEPTICS  # type: ignore[misc]
        rows.append(_row(name, alone, other, f"{wrong} differ, {verdicts.n_searched} searched"))
    return rows


def _toolbox(moves: list[ps.Trajectory], many: ps.ManyAssessments, ours: float) -> tuple[str, ...]:
    """The Robotics Toolbox's rne on 200 samples of each, its arm with friction."""
    from roboticstoolbox.models.DH import Puma560

    arm = Puma560()

    def peaks(move: ps.Trajectory) -> Array:
        t = np.linspace(0.0, move.duration, 200)
        return np.abs(arm.rne(*(move(t, order) for order in range(3)))).max(axis=0)

    seconds = _least(lambda: [peaks(move) for move in moves[:LOOPED]]) / LOOPED
    error = max(np.abs(peaks(move) / many.peak_torque[k] - 1)[:3].max() for k, move in enumerate(moves[:LOOPED]))
    return _row(f"{SEPTICS} septics, Robotics Toolbox rne at 200 samples", ours, seconds, f"{error:.0e}")


def _move() -> tuple[ps.Robot, ps.Trajectory]:
    vias = [[0.3, -0.4, 0.5, 0.2, 0.1, 0.3], [0.6, -0.5, 0.2, 0.5, 0.3, 0.1]]
    points = [[0.0] * 6, *vias, [0.2, -0.1, 0.7, 0.1, 0.6, 0.0]]
    robot = ps.load_robot().with_limits(velocity=np.full(6, np.nan))
    return robot, ps.septic(points, [0.0, 3.0, 6.0, 9.0])


def _fast_and_heavy() -> list[tuple[str, ...]]:
    robot, move = _move()
    limit, motion = robot.limits.effort, ps.compute_motion(robot, move)
    fastest, heaviest = ps.minimum_duration(motion), ps.maximum_payload(motion, com=COM)

    def holds(duration: float) -> bool:
        return bool((_peak(robot, move, duration / move.duration) <= limit).all())

    def carries(mass: float) -> bool:
        return bool((_peak(robot.with_payload(ps.Payload(mass=mass, com=COM)), move) <= limit).all())

    looped_time, looped_mass = _bisected(holds, 0.5, 9.0), _bisected(carries, 60.0, 0.0)
    return [
        _row(
            "least duration, bisection with a pin.rnea loop",
            _least(lambda: ps.minimum_duration(motion)),
            _least(lambda: _bisected(holds, 0.5, 9.0), 1),
            f"{abs(looped_time / fastest.duration - 1):.0e}",
        ),
        _row(
            "largest payload, bisection with a pin.rnea loop",
            _least(lambda: ps.maximum_payload(motion, com=COM)),
            _least(lambda: _bisected(carries, 60.0, 0.0), 1),
            f"{abs(looped_mass / heaviest.mass - 1):.0e}",
        ),
    ]


def _map() -> list[tuple[str, ...]]:
    """100 durations by 100 payloads; the loop's time from 20 cases."""
    robot, move = _move()
    motion, rng = ps.compute_motion(robot, move), np.random.default_rng(SEED)
    durations, masses = np.linspace(9.0, 18.0, 100), np.linspace(0.0, 5.0, 100)
    swept = ps.payload_duration_map(motion, durations, masses, com=COM)
    cases = rng.integers(0, 100, (20, 2)).tolist()

    def looped(i: int, k: int) -> Array:
        loaded = robot.with_payload(ps.Payload(mass=masses[k], com=COM))
        return _peak(loaded, move, durations[i] / move.duration)

    ours = _least(lambda: ps.payload_duration_map(motion, durations, masses, com=COM))
    other = _least(lambda: [looped(i, k) for i, k in cases], 1) / len(cases) * 10_000
    shares = np.array([looped(i, k) / swept.peak_torque[i, k] for i, k in cases])
    below = "never above" if (shares <= 1 + 1e-12).all() else f"above by {shares.max() - 1:.0e}"
    return [_row("100 durations x 100 payloads, pin.rnea loop", ours, other, f"{1 - shares.min():.0e}, {below}")]


def _study() -> list[tuple[str, ...]]:
    """Cases a second with the default columns, in one process."""
    axes = {
        "points.place.position.0": {"from": 0.42, "to": 0.5, "count": 4},
        "duration": {"from": 8, "to": 20, "count": 100},
        "payload": {"from": 0, "to": 4, "count": 100},
    }
    task = ps.load_task("paper-turned").document() | {"profiles": [{"name": "septic"}]}
    study = ps.make_study({"task": task, "axes": axes})
    with tempfile.TemporaryDirectory() as folder:
        start = process_time()
        done = ps.run_study(study, folder, workers=1)
        seconds = process_time() - start
    return [(f"study of {done.n_cases:,} cases, all columns", f"{done.n_cases / seconds:,.0f} cases/s", "", "", "")]


def _row(what: str, ours: float, other: float, agreement: str) -> tuple[str, ...]:
    return (what, f"{1e3 * ours:.3g} ms", f"{1e3 * other:.4g} ms", f"{other / ours:.1f}", agreement)


if __name__ == "__main__":
    for row in run():
        sys.stdout.write("  ".join(row) + "\n")
