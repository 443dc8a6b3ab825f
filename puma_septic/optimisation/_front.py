"""The Pareto front of two or three objectives over the via times."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.document import SCHEMAS, card, one_line, plain
from puma_septic.objectives import Candidate, Objective, checked_objectives, non_dominated
from puma_septic.optimisation._constraints import Verdict, told
from puma_septic.optimisation._problem import (
    Progress,
    Setting,
    best_kept,
    checked_setting,
    random_starts,
    refusable,
)
from puma_septic.optimisation._search import KEPT, Found, search
from puma_septic.optimisation._variables import MakeTrajectory
from puma_septic.paths import ToolLimits
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_whole, frozen, read_only
from puma_septic.views.tables import Cell

__all__ = ["ParetoFront", "pareto_front"]

# With up to two free via times the scan is a grid of this many shares a side, else so many random times.
_GRID: Final = 14
_RANDOM: Final = 150
# Each is a search of its own.
_MOST_POINTS: Final = 1_000
# Two motions whose objectives differ by less than this part of the front's reach are one.
_SAME_PLACE: Final = 1e-3


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ParetoFront:
    """Pareto-optimal motions, from the best in the first objective on.

    Attributes
    ----------
    objectives : tuple of Objective
    trajectories : tuple of Trajectory
    values : ndarray, shape (n, m)
        Objectives of each.
    start : Trajectory
        With the given times.
    start_values : ndarray, shape (m,)
    verdicts : tuple of Verdict
        Each motion assessed in full; empty without a robot.
    n_evaluations : int
    """

    objectives: tuple[Objective, ...]
    trajectories: tuple[Trajectory, ...]
    values: Array
    start: Trajectory
    start_values: Array
    verdicts: tuple[Verdict, ...]
    n_evaluations: int

    @property
    def times(self) -> Array:
        """Via times of each, shape (n, k), s."""
        return frozen(np.stack([trajectory.times for trajectory in self.trajectories]))

    @property
    def statement(self) -> str:
        """What was reached."""
        return (
            f"{len(self.trajectories)} Pareto-optimal motions; each a local optimum of the weighted worst"
            " objective (Chebyshev's scalarisation), begun at the best of a scan of the via times;"
            f" {self.n_evaluations} evaluations; no proof that none is missed"
        )

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document, SI units."""
        return {
            "schema": SCHEMAS["pareto-front"],
            "profile": self.start.profile,
            "objectives": [{"name": one.name, "unit": one.unit} for one in self.objectives],
            "start": {"times": plain(self.start.times), "values": plain(self.start_values)},
            "front": [
                {"times": plain(times), "values": plain(values)}
                for times, values in zip(self.times, self.values, strict=True)
            ],
            "limits": [verdict.to_dict() for verdict in self.verdicts] or None,
            "n_evaluations": self.n_evaluations,
            "statement": self.statement,
        }

    @property
    def sentence(self) -> str:
        """What was found, in one line."""
        kept = sum(one.is_feasible for one in self.verdicts)
        count = len(self.trajectories)
        limits = f"; {kept} of {count} points keep all known limits" if self.verdicts else ""
        return f"{self.start.profile}: Pareto front over the via times{limits}"

    @property
    def table(self) -> tuple[tuple[str, ...], tuple[tuple[Cell, ...], ...]]:
        """Heads and rows: the via times and the objectives of the given motion and of each point."""
        inner = range(1, len(self.start.times) - 1)
        headers = ["", *(f"t{k} [s]" for k in inner), *(f"{one.name} [{one.unit}]" for one in self.objectives)]
        motions = [("given", self.start, self.start_values)] + [
            (str(k + 1), trajectory, values)
            for k, (trajectory, values) in enumerate(zip(self.trajectories, self.values, strict=True))
        ]
        rows: list[list[Cell]] = [
            [label, *(f"{t:z.4f}" for t in motion.times[1:-1]), *map(float, values)]
            for label, motion, values in motions
        ]
        if self.verdicts:
            headers.append("limits not held")
            not_held = [", ".join(dict.fromkeys(check.quantity for check in one.violations)) for one in self.verdicts]
            rows = [[*row, text] for row, text in zip(rows, ["", *(text or "none" for text in not_held)], strict=True)]
        return tuple(headers), tuple(map(tuple, rows))

    @property
    def notes(self) -> tuple[str, ...]:
        """Which limits were respected, and how the front was reached."""
        limits = [f"Limits respected: {', '.join(self.verdicts[0].respected) or 'none'}."] if self.verdicts else []
        return (*limits, f"Reached: {self.statement}.")

    def __str__(self) -> str:
        return told(self.sentence, self.table, self.notes)

    def __repr__(self) -> str:
        return one_line("ParetoFront", self._facts())

    def _repr_html_(self) -> str:
        return card("ParetoFront", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "profile": self.start.profile,
            "objectives": ", ".join(one.name for one in self.objectives),
            "points": len(self.trajectories),
        }


def pareto_front(
    make: MakeTrajectory,
    points: ArrayLike,
    times: ArrayLike,
    *,
    objectives: Sequence[str],
    robot: Robot | None = None,
    free: Sequence[str] = (),
    max_overshoot: ArrayLike | None = None,
    keep: Sequence[str] = (),
    dwell: float = 0.0,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
    size: int = 12,
    seed: int = 0,
    progress: Progress | None = None,
) -> ParetoFront:
    """Trade two or three objectives against each other by the via times, for a given total time.

    The via times are scanned; from the best ones each objective alone is made least, and then, for rays r that cut
    the front evenly, ``max_i (f_i - best_i) / (r_i (worst_i - best_i))``, which reaches hollow parts of a front
    too (Chebyshev's scalarisation: Miettinen, Nonlinear Multiobjective Optimization, 3.4).

    Parameters
    ----------
    make, points, times, robot, free, max_overshoot, keep, dwell, floor, tool_limits, seed, progress
        As in `optimise_via_times`.
    objectives : sequence of str
        Two or three names in `puma_septic.objectives.OBJECTIVES`.
    size : int
        Number of searches along the front, at least 3; dominated ends are left out.

    Returns
    -------
    ParetoFront

    Raises
    ------
    InputError
        For arguments that are not valid, or an objective that is unbounded for this profile.
    NoSolution
        If no motion kept the constraints.

    Examples
    --------
    >>> import puma_septic as ps
    >>> points, times = [[0.0], [1.0], [3.0], [4.0]], [0.0, 2.0, 6.0, 9.0]
    >>> front = pareto_front(ps.septic, points, times, objectives=("peak_jerk", "peak_velocity"), size=4)
    >>> bool((np.diff(front.values[:, 0]) > 0).all() and (np.diff(front.values[:, 1]) < 0).all())
    True
    """
    setting = checked_setting(
        make,
        points,
        times,
        robot=robot,
        free=free,
        max_overshoot=max_overshoot,
        keep=keep,
        dwell=dwell,
        floor=floor,
        tool_limits=tool_limits,
    )
    goals = checked_objectives(objectives, at_least=2, at_most=3)
    rays = _rays(len(goals), checked_whole("size", size, at_least=3, at_most=_MOST_POINTS))
    start = make(setting.variables.points, setting.variables.start)
    start_values = np.array([setting.bounded_value(goal, start) for goal in goals])
    scan = _scanned(setting, goals, seed)
    n_scanned = len(scan[0])
    tried, values, found = _searched(setting, goals, rays, scan, progress)
    best_kept(setting, found)
    chosen = _chosen(values[n_scanned:])
    trajectories = tuple(setting.variables.trajectory(x) for x in tried[n_scanned:][chosen])
    verdicts = (setting.verdict(trajectory) for trajectory in trajectories)
    return ParetoFront(
        objectives=goals,
        trajectories=trajectories,
        values=read_only(values[n_scanned:][chosen]),
        start=start,
        start_values=read_only(start_values),
        verdicts=tuple(verdict for verdict in verdicts if verdict is not None),
        n_evaluations=n_scanned + sum(one.n_evaluations for one in found),
    )


def _searched(
    setting: Setting,
    goals: tuple[Objective, ...],
    rays: Array,
    scan: tuple[Array, Array],
    progress: Progress | None,
) -> tuple[Array, Array, list[Found]]:
    """Variables and objectives, those of the scan and of the end of each search, and what the searches found."""
    tried, values = scan
    found: list[Found] = []
    for k in range(len(goals) + len(rays)):
        # First each objective alone; they frame the front that the rays then cut.
        if k < len(goals):
            merits, parts = values[:, k], goals[k].parts
        else:
            best, spread = _frame(values)
            scale = rays[k - len(goals)] * spread
            merits, parts = ((values - best) / scale).max(axis=1), _scaled_parts(goals, best, scale)
        problem = setting.problem(
            parts, needs_robot=any(goal.needs_robot for goal in goals), is_of_torque=_are_of_torque(goals)
        )
        found.append(search(problem, tried[int(np.argmin(merits))]))
        tried = np.vstack([tried, found[-1].x])
        values = np.vstack([values, _values(setting, goals, refusable(setting.candidate, found[-1].x))])
        if progress is not None:
            progress(k + 1, len(goals) + len(rays))
    return tried, values, found


def _rays(m: int, size: int) -> Array:
    """Directions that cut the front evenly, from its best corner on; none along an edge, shape (n, m)."""
    sides = size - 1 if m == 2 else next(d for d in range(3, 100) if (d - 1) * (d - 2) // 2 >= size - 3)
    lattice = [row for row in product(range(1, sides), repeat=m) if sum(row) == sides]
    return np.array(lattice) / sides


def _scanned(setting: Setting, goals: Sequence[Objective], seed: int) -> tuple[Array, Array]:
    """Variables all over the via times, and their objectives; infinite where refused or not kept."""
    variables, first = setting.variables, setting.first()
    n = variables.n_times + 1
    if n <= 3:
        shares = np.array([row for row in product(range(1, _GRID), repeat=n) if sum(row) == _GRID]) / _GRID
        t = variables.start
        starts = [first]
        for row in shares:
            x = first.copy()
            times = t[0] + (t[-1] - t[0]) * np.concatenate([[0.0], np.cumsum(row)])
            x[: n - 1] = variables.encode(times)[: n - 1]
            starts.append(x)
    else:
        starts = random_starts(variables, first, _RANDOM, seed)
    if _are_of_torque(goals):
        candidates = setting.candidates(starts)
    else:
        candidates = [refusable(setting.candidate, x) for x in starts]
    return np.stack(starts), np.stack([_values(setting, goals, one) for one in candidates])


def _are_of_torque(goals: Sequence[Objective]) -> bool:
    """Whether one needs the torque, and none more of the motion than its ends and root mean square."""
    return any(goal.is_of_torque for goal in goals) and all(goal.is_of_torque or not goal.needs_robot for goal in goals)


def _values(setting: Setting, goals: Sequence[Objective], candidate: Candidate | None) -> Array:
    """Infinite where refused or not kept."""
    if candidate is None or setting.excess(candidate).max(initial=-np.inf) > KEPT:
        return np.full(len(goals), np.inf)
    return np.array([goal.value(candidate) for goal in goals])


def _frame(values: Array) -> tuple[Array, Array]:
    """Best value of each objective, and how far the front reaches from it."""
    front = values[_chosen(values)]
    spread = np.ptp(front, axis=0) if len(front) else np.zeros(values.shape[1])
    best = front.min(axis=0) if len(front) else np.zeros(values.shape[1])
    return best, np.where(spread > 0, spread, 1.0)


def _chosen(values: Array) -> NDArray[np.int64]:
    """Pareto-optimal rows, each once, by the first objective."""
    rows = np.flatnonzero(np.isfinite(values).all(axis=1))
    rows = rows[non_dominated(values[rows])]
    rows = rows[np.argsort(values[rows, 0], kind="stable")]
    reach = np.ptp(values[rows], axis=0) if len(rows) else 0.0
    kept: list[int] = []
    for row in rows:
        if all((np.abs(values[row] - values[other]) > _SAME_PLACE * reach).any() for other in kept):
            kept.append(int(row))
    return np.array(kept, dtype=np.int64)


def _scaled_parts(goals: Sequence[Objective], best: Array, scale: Array) -> Callable[[Candidate], Array]:
    """Parts of all objectives, as distances from the best corner along a ray."""

    def parts(candidate: Candidate) -> Array:
        each = zip(goals, best, scale, strict=True)
        return np.concatenate([(goal.parts(candidate) - low) / width for goal, low, width in each])

    return parts
